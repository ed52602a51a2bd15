"""Where each step of assembly puts its part, against what the spec says of joints and heights; and of every machine that comes
with camgen: what a step names is there by then, what is fixed is fixed on something that is there, no hole is left empty."""

from __future__ import annotations

import cmath
import itertools
import math
import re
import sys
import tomllib
from collections import Counter, defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

from camgen import load, starters
from camgen.geometry.facets import facet_contour
from camgen.geometry.outlines import Contour, Region, circle
from camgen.machine.features import Mark, Mount, PartPose, heights
from camgen.machines.mechanism import Mechanism
from camgen.machines.sources import read_mechanism
from camgen.numerics import coordinates
from camgen.parts.assembly import order_of_assembly
from camgen.parts.catalogue import SCREWS
from camgen.parts.fixing import Fixing
from camgen.parts.generator import bodies as body_parts
from camgen.parts.generator import plates as plate_parts
from camgen.parts.part import Layer, Part, SizeNote
from camgen.parts.reaming import running_size
from camgen.parts.standing import standing_copies
from camgen.parts.step_words import between, thickness_gauge
from camgen.parts.steps import order
from camgen.parts.tools import SUPPLIES
from camgen.pipeline.making import parts_table
from camgen.pipeline.shopping import bought_things, steps_of_assembly, stock, supplies, tools
from camgen.starters import in_metal
from camgen.study import Mate

PLAY = Fixing(0.1)
MODULE = sys.modules[__name__]


@pytest.fixture(scope="module")
def leg() -> Mechanism:
    spec = Path(__file__).parents[2] / "specs" / "walking-leg.toml"
    return read_mechanism(spec, ["parts.pin=printed"])


def where(mechanism: Mechanism) -> dict[str, str]:
    return {str(row[1]): str(row[3]) for row in order_of_assembly(mechanism.assembly).rows}


def test_each_link_is_said_to_go_over_those_that_it_is_jointed_to(leg: Mechanism) -> None:
    """Joints of the spec: A crank and both rods, B and D shoulder, E and F foot, C the ground's pin."""
    said = where(leg)
    assert (
        said["upper_rod"] == "A over crank, B over shoulder"
        and said["link"] == "D over shoulder, F over foot"
    )
    assert said["lower_rod"] == "A over upper_rod, E over hanger"
    assert (
        said["hanger"] == "C glued on pin-1, flush with its upper end, E over foot"
    )  # its head is under the plate
    fixed = "through {} of {}, glued into {}"  # of a pin the lowest link
    fixed += ", flush below, 0.1 mm left under its head with all pushed down (one sheet of paper between, then pull it out)"
    assert leg.print.slide_clearance == 0.05
    rows = [("B", "upper_rod", "shoulder"), ("D", "link", "shoulder"), ("F", "link", "foot")]
    assert said["pin-3"] == "; ".join(fixed.format(*row) for row in rows)
    rows = [("A", "lower_rod and upper_rod", "crank"), ("E", "lower_rod and hanger", "foot")]
    three = fixed.replace("0.1 mm", "0.15 mm").replace(
        "(one sheet of paper between, then pull it out)",
        "(one sheet of paper and a strip of a plastic bag between, then pull them out)",
    )  # two links and the crank, 0.05 between each two of them and under the head
    assert said["pin-2"] == "; ".join(three.format(*row) for row in rows)


@pytest.mark.parametrize("plates", [1, 2])
def test_what_stands_over_a_slot_and_what_is_screwed_from_below_is_said(plates: int) -> None:
    """The yoke's ends run in slots of the plate, on spacers; the beam's pins do too. A second plate stands on posts."""
    gallery = Path(__file__).parents[2] / "specs" / "gallery"
    yoke, trammel = (
        read_mechanism(gallery / f"{name}.toml", [f"parts.plates={plates}"])
        for name in ("scotch-yoke", "elliptic-trammel")
    )
    assert where(yoke)["spacer-1"] == "over the slot of ground"
    assert where(trammel)["beam"] == "B over the slot of ground, A over the slot of ground"
    said = [str(row[2]) for row in order_of_assembly(yoke.assembly).rows if row[1] == "post"]
    assert said == ["Post: screw each on from below, through the plate"] * (plates - 1)


def test_how_high_a_shaft_holds_each(leg: Mechanism) -> None:
    """By the undersides of the table: the plate's at 0, the collar's at -3.05 mm; the crank ends where the shaft does. The
    collar is loose until the crank holds the shaft, and is glued under the plate then."""
    table = order_of_assembly(leg.assembly)
    said = where(leg)
    z = {str(row[1]): float(str(row[5])) for row in table.rows}
    gap = z["ground"] - z["collar"] - leg.assembly.by_name["collar"].thickness
    collar = [(row[0], row[3]) for row in table.rows if row[1] == "collar"]
    crank = max(int(str(row[0])) for row in table.rows if row[1] == "crank")
    assert collar == [
        (2, "loose on shaft"),
        (crank + 1, f"glued on shaft, {gap:.2g} mm under ground"),
    ]
    first, last = (step for step in table.steps if "collar-1" in step.copies)
    assert {mate.how for mate in first.mates} == {"free"} and first.way == -1
    assert {mate.how for mate in last.mates if mate.height} >= {"glue"} and last.way == 1
    assert said["ground"].startswith("O on shaft, C on pin-1"), "what is loose has no height"
    shaft, crank = leg.assembly.by_name["shaft"], leg.assembly.by_name["crank"]
    assert z["shaft"] + shaft.thickness == pytest.approx(z["crank"] + crank.thickness)
    assert said["crank"] == "O glued on shaft, flush with its upper end"


def test_of_pins_that_are_alike_a_step_says_the_joint_and_the_link() -> None:
    """A link over the left one of two pins by its point P, another over the right one by Q; then a cap on each."""
    pin = Part("pin", "Pin", (Layer(Region(circle(0, 2)), 0, 20),), count=2)
    hole = (Layer(Region(circle(0, 6), (circle(0, 2.1),)), 0, 4),)
    left = Part("left", "Left", hole, points=(("P", 0j),))
    right = Part("right", "Right", hole, points=(("Q", 0j),))
    cap = Part("cap", "Cap", (Layer(Region(circle(0, 4), (circle(0, 2),)), 0, 3),), count=2)
    stands = {
        "pin": [(0j, 0.0), (30 + 0j, 0.0)],
        "left": [(0j, 0.0)],
        "right": [(30 + 0j, 0.0)],
        "cap": [(0j, 17.0), (30 + 0j, 17.0)],
    }
    for count, at in ((2, (" at P of left", " at Q of right")), (1, ("", ""))):
        poses = {
            name: [PartPose(np.array([place]), np.zeros(1), False, z) for place, z in each]
            for name, each in stands.items()
        }
        mounts = [
            Mount(name, name, place, z=z) for name, each in stands.items() for place, z in each
        ]
        parts = (replace(pin, count=count), left, right, cap)
        said = str(order(standing_copies(parts, mounts, poses), (), PLAY).rows[-1][3])
        ends = (f"pressed and glued on pin{each}, flush with its upper end" for each in at)
        assert said == "; ".join(dict.fromkeys(ends)), (
            "where a pin is the only one, its name says all"
        )


def test_a_height_over_what_lies_there_is_said_by_the_gap() -> None:
    """A long shaft, a loose plate up to 5 mm, a ring that is fixed 0.2 mm over it, and one that lies on that ring."""
    shaft = Part("shaft", "Shaft", (Layer(Region(circle(0, 3)), 0, 60),))
    plate = Part("plate", "Plate", (Layer(Region(circle(0, 9), (circle(0, 3.2),)), 0, 5),))
    ring = Part("ring", "Ring", (Layer(Region(circle(0, 9), (circle(0, 3),)), 0, 4),))
    high = {"shaft": [0.0], "plate": [0.0], "ring": [5.2, 9.2, 40.0]}
    poses = {
        name: [PartPose(np.zeros(1, complex), np.zeros(1), False, z) for z in heights]
        for name, heights in high.items()
    }
    mounts = [Mount(name, "crank", z=z) for name, heights in high.items() for z in heights]
    rows = order(standing_copies((shaft, plate, ring), mounts, poses), (), PLAY).rows
    said = ["0.2 mm over plate", "down on ring", "underside 40 mm from its lower end"]
    assert [row[3] for row in rows[2:]] == [f"pressed and glued on shaft, {each}" for each in said]


def test_a_gap_is_set_by_what_is_at_hand() -> None:
    """Paper of 0.1 mm, up to six sheets, a strip of a bag of 0.05 mm, or a feeler gauge where no few of them are as thick."""
    assert between(0.2) == " (two sheets of paper between, then pull them out)"
    assert between(0.1) == " (one sheet of paper between, then pull it out)"
    assert between(0.05) == " (a strip of a plastic bag between, then pull it out)"
    both = "one sheet of paper and a strip of a plastic bag"
    assert between(0.15) == f" ({both} between, then pull them out)"
    assert thickness_gauge(0.6) == "six sheets of paper"
    assert {thickness_gauge(gap) for gap in (0.0, 0.02, 0.12, 0.7, 0.99)} == {"a feeler gauge"}


@pytest.mark.parametrize(
    ("name", "play", "loose"),
    [
        ("geneva-table", 0.1, ("spacer-1", "spacer-2", "roller-crank_to_table", "knob")),
        ("linkage", 0.2, ("knob",)),
    ],
)
def test_what_is_glued_over_a_loose_part_stands_as_drawn(
    name: str, play: float, loose: tuple[str, ...]
) -> None:
    """Drawn with a play under it and over it, a loose part lies down at the bench: the gauge over it is as thick as both."""
    machine = read_mechanism(tomllib.loads(in_metal(name)))
    steps = " ".join(step.title for step in steps_of_assembly(machine).steps)
    for part in loose:
        assert f"{2 * play:g} mm over {part} (a feeler gauge" in steps
    if name == "geneva-table":
        assert f"{play:g} mm over ground (a feeler gauge" in steps


@pytest.mark.parametrize("name", ["geneva-table", "linkage"])
def test_how_long_compound_cures_is_said_once(name: str) -> None:
    machine = read_mechanism(tomllib.loads(in_metal(name)))
    steps = [step.title for step in steps_of_assembly(machine).steps]
    (said,) = (each for each in steps if "hour" in each)
    assert "hard, at least half an hour; only after 24 hours" in said


@pytest.mark.parametrize("name", ["geneva-table", "linkage"])
def test_what_is_loose_in_metal_is_so_on_what_is_there_and_until_a_later_step(name: str) -> None:
    machine = read_mechanism(tomllib.loads(in_metal(name)))
    steps = [step.title for step in steps_of_assembly(machine).steps]
    assert not any("until this step" in each for each in steps)
    bench = "\n".join(f"({k}) {title}" for k, title in enumerate(steps, 1) if k > 3)
    waits = [*re.finditer(r"loosely on (\S+); it stays loose until step (\d+)", bench)]
    assert waits
    for each in waits:
        before = bench[: each.start()]
        shaft = each[1].replace("-", " of ")  # as its step calls it
        assert re.search(rf"\b{shaft}\b", before), "what it is on is there"
        assert int(each[2]) > int(re.findall(r"^\((\d+)\)", before, re.MULTILINE)[-1])
    if name == "linkage":
        (crank,) = (each for each in steps if "the hand crank on shaft" in each)
        assert "with the lower end of shaft (longer keyway, 6 mm)" in crank


def test_holes_of_a_metal_geneva_table_come_made_as_its_sheets_say() -> None:
    """The crank by hand has two bores, one keyed and one for the knob's pin, m6; the locking disc is put on its dowel by hand, and
    what it lies on says how high."""
    machine = read_mechanism(tomllib.loads(in_metal("geneva-table")))
    steps = [step.title for step in steps_of_assembly(machine).steps]
    (ready,) = (each for each in steps if "These have keyways" in each)
    _, by_hand = ready.split("What these hold goes in by hand")
    by_hand, keyed = by_hand.split("These have keyways")
    keyed, pressed = keyed.split("What these hold is pressed in")
    # who makes a part reads its sheet, not the steps
    assert not any(word in each.lower() for each in steps for word in ("ream", "broach", "saw "))
    assert "the hole beside the bore of lock-crank_to_table" in by_hand
    assert "the wider bore of hand-crank" in keyed
    assert "the hole beside the bore of hand-crank" in pressed and "lock-" not in pressed
    assert "ball bearing" not in ready
    (wheel,) = (each for each in steps if "the geneva wheel" in each)
    assert "turn it until a hollow lies round the locking disc, or a slot round the roller" in wheel
    # keyways of 6 and 13 on the shaft that drives
    assert any("glue what has no key with anaerobic retaining compound" in each for each in steps)
    end = "flush with the lower end of shaft (shorter keyway, 6 mm)"
    assert sum(end in each for each in steps) == 1
    (lock,) = (each for each in steps if "all at once" in each)
    away = " When the glue is hard, take the block out from under shaft."
    assert lock.endswith(f"all at once, down on crank.{away}")
    # its plate is what one measures from, not the bush that is flush with it
    assert any("0.1 mm over ground (a feeler gauge" in each for each in steps)
    assert not any("over bush" in each for each in steps)


def test_walls_of_a_groove_lie_on_their_back_plate_and_gaps_are_set_by_paper() -> None:
    """Both walls begin where the back plate ends, and the inner one ends where the shaft does: by their heights."""
    spec = Path(__file__).parents[2] / "specs" / "gallery" / "groove.toml"
    machine = read_mechanism(spec, ["parts.make=printed"])
    made = machine.assembly
    low = {mount.part: mount.z for mount in made.mounts}
    top = {name: z + made.by_name[name].thickness for name, z in low.items()}
    for wall in ("cam-contact-inner", "cam-contact-outer"):
        assert low[wall] == pytest.approx(top["cam-contact-back"])
    assert top["cam-contact-inner"] == pytest.approx(top["shaft"])
    titles = [step.title for step in steps_of_assembly(machine).steps]
    (inner,) = (title for title in titles if "the inner wall of" in title)
    assert (
        "all at once, down on cam-contact-back, flat on flat, with two-part glue, flush with shaft's upper end."
        in inner
    )
    (outer,) = (title for title in titles if "the outer wall of" in title)
    assert outer.endswith("all at once, down on cam-contact-back.")
    sheets = " (two sheets of paper between, then pull them out)."
    assert any(f"0.2 mm over ground{sheets}" in title for title in titles)
    below = " The glue goes on shaft under it, none over it."
    assert any(title.endswith(f"0.2 mm under ground{sheets}{below}") for title in titles)


def test_a_cap_on_a_short_pin_has_its_height_where_it_would_lock_the_joint() -> None:
    """A pin no longer than it is wide, a link on it, and a cap 0.2 mm over the link, which the pin stands out of by 0.6 mm."""
    pin = Part("pin", "Pin", (Layer(Region(circle(0, 4)), 0, 7.8),))
    link = Part("link", "Link", (Layer(Region(circle(0, 9), (circle(0, 4.1),)), 0, 4),))
    cap = Part("cap", "Cap", (Layer(Region(circle(0, 6), (circle(0, 4),)), 0, 3),))
    high = {"pin": 0.0, "link": 0.0, "cap": 4.2}
    poses = {
        name: [PartPose(np.zeros(1, complex), np.zeros(1), False, z)] for name, z in high.items()
    }
    mounts = [Mount(name, "crank", z=z) for name, z in high.items()]
    rows = order(standing_copies((pin, link, cap), mounts, poses), (), PLAY).rows
    assert rows[-1][3] == "pressed and glued on pin, 0.2 mm over link"


def test_what_is_turned_over_goes_where_its_mirror_image_stands() -> None:
    """A plate with a hole at x = 5, turned over about Oy and moved by 20: over a pin at x = 15, and over none at x = 25."""
    plate = Part(
        "plate",
        "Plate",
        (Layer(Region(circle(0, 9), (circle(5, 1.1),)), 0, 2),),
        points=(("P", 5 + 0j),),
    )
    pin = Part("pin", "Pin", (Layer(Region(circle(0, 1)), 0, 30),))
    for x, expected in ((15.0, "P on pin"), (25.0, "")):
        poses = {
            "pin": [PartPose(np.array([x + 0j]), np.zeros(1), False, 0.0)],
            "plate": [PartPose(np.array([20 + 0j]), np.zeros(1), True, 10.0)],
        }

        mounts = (Mount("pin", "ground", x), Mount("plate", "ground", 20, 0.0, True, 10.0))
        rows = order(standing_copies((pin, plate), mounts, poses), (), PLAY).rows
        assert rows[1][3] == expected
    wide = replace(plate, layers=(Layer(Region(circle(0, 9), (circle(5, 4),)), 0, 2),))
    poses["pin"] = [PartPose(np.array([15 + 0j]), np.zeros(1), False, 0.0)]
    assert (
        order(standing_copies((pin, wide), mounts, poses), (), PLAY).rows[1][3] == ""
    )  # far too wide to be held by it


# ---- of every machine ------------------------------------------------------------------------------------------------

BAR = {  # a drag link: both cranks turn over each other's pivot, so one hangs from the second plate
    "mechanism": "linkage",
    "name": "drag",
    "drive": {"link": "crank"},
    "points": {"O": [0, 0], "C": [10, 0], "A": [20, 0], "B": [20, 34]},
    "links": {
        "ground": ["O", "C"],
        "crank": ["O", "A"],
        "coupler": ["A", "B"],
        "rocker": ["C", "B"],
    },
    "output": [{"name": "out", "link": "rocker"}],
    "parts": {"plates": 2},
}
FAR = {  # a drag link as large as its frame lets posts stand only beyond all that turns
    **BAR,
    "points": {"O": [0, 0], "C": [15, 0], "A": [40, 0], "B": [30, 48]},
    "lengths": {"O-A": 40, "A-B": 45, "C-B": 50},
}
WHITWORTH = {
    "mechanism": "linkage",
    "name": "whitworth",
    "drive": {"link": "crank"},
    "points": {"O": [0, 0], "C": [15, 0], "A": [40, 0], "D": [-45, 0], "E": [65, 0]},
    "links": {"ground": ["O", "C"], "crank": ["O", "A"], "arm": ["C", "D", "E"]},
    "slot": [{"pin": "A", "link": "arm", "along": ["C", "E"]}],
    "output": [{"name": "out", "link": "arm"}],
    "parts": {"plates": 2},
}


def test_pins_of_one_link_are_said_once_with_the_letters_of_their_holes() -> None:
    leg = read_mechanism(Path(__file__).parents[2] / "specs" / "walking-leg.toml")
    titles = [step.title for step in steps_of_assembly(leg).steps]
    into = (
        "Press and glue 2 × pin-3 into B and D of shoulder, from above, flush with its underside."
    )
    assert f"{into} Then set shoulder with C on pin-1." in titles


def started(name: str, **parts: Any) -> dict[str, Any]:
    """The tables of a starter with some keys of [parts]."""
    tables = tomllib.loads(starters.text(name))
    tables["parts"] = {**tables.get("parts", {}), **parts}
    return tables


MORE = {
    "drag link": BAR,
    "drag link, far posts": FAR,
    "drag link, dowels": {**BAR, "parts": {"plates": 2, "pin": "dowel"}},
    "whitworth": WHITWORTH,
    "whitworth, interrupted shaft": {
        **WHITWORTH,
        "points": {**WHITWORTH["points"], "C": [60, 0], "E": [-40, 0], "D": [70, 0]},
        "parts": {"plates": 2, "shaft": "interrupted"},
    },
    "scotch yoke, two plates": started("scotch-yoke", plates=2),
    "dowels": started("linkage", pin="dowel"),
    "shoulder screws": started("linkage", pin="shoulder"),
    "ball bearings": started("linkage", pin="bearing"),
    "two plates": started("linkage", plates=2),
    "interrupted": started("linkage", plates=2, shaft="interrupted"),
    "hand crank": started("linkage", hand_crank=40),
    "steel": started("walking-leg", shaft_made="steel"),
    "motor": started("linkage", motor="nema-17", base_thickness=6),
    "two plates on a quick return": started("quick-return", plates=2),
    "laser": {**started("four-bar", make="laser"), "laser": {"thickness": 3}},
    "cam on a bench": started("disc-cam", make="machine"),
    "groove on a bench": started("groove", make="machine"),
}
BOUGHT = {  # of these only what is bought is looked at
    "set screw on a motor": started("linkage", motor="nema-17", base_thickness=6, set_screw="M3"),
    "two sides": {
        **WHITWORTH,
        "points": {**WHITWORTH["points"], "C": [60, 0], "E": [-40, 0], "D": [70, 0]},
        "parts": {"plates": 2, "shaft": "interrupted", "sides": 2, "side_gap": 20},
    },
    "steel disc cam": {
        **started("disc-cam", bore=20, bore_shape="keyway", hub_height=0),
        "material": {"name": "C45"},
        "load": {"cam_follower": "KR16", "mass_kg": 1},
        "geometry": {
            "base_radius": 40,
            "follower": {"motion": "translating", "shape": "roller", "radius": 8},
        },
    },
    "indexing cams on a bench": started("indexing-cam", make="machine"),
}
SPECS = sorted(
    path
    for part in (".", "gallery")
    for path in (starters.folder() / part).glob("*.toml")
    if path.stem != "coupon"
)
MACHINES = [*(path.stem for path in SPECS), *MORE]


@cache
def built(name: str) -> Mechanism:
    path = next((path for path in SPECS if path.stem == name), None)
    return load((MORE | BOUGHT)[name]) if path is None else read_mechanism(path, [])


@dataclass(frozen=True)
class Ring:
    """An edge of a copy that is round, wholly or but for a flat: axis, diameter, heights."""

    copy: str
    at: complex
    diameter: float
    low: float
    high: float

    def goes_through(self, hole: Ring, play: float) -> bool:
        common = min(self.high, hole.high) - max(self.low, hole.low)
        fits = self.copy != hole.copy and -0.05 < hole.diameter - self.diameter < play
        return fits and common > 1e-6 and abs(self.at - hole.at) < 0.3


def round_edge(contour: Contour) -> tuple[complex, float] | None:
    """Centre and diameter of what is round by three quarters of its facets' corners."""
    ring = facet_contour(contour, 1e-4)
    off = np.abs(ring - ring.mean())
    for _ in range(20):  # a flat moves the mean: the circle through most corners
        on = np.abs(off - np.median(off)) < 0.02
        rows = np.column_stack([2 * ring[on].real, 2 * ring[on].imag, np.ones(on.sum())])
        x, y, _ = (
            np.linalg.lstsq(rows, np.abs(ring[on]) ** 2, rcond=None)[0]
            if on.sum() > 2
            else (0, 0, 0)
        )
        off = np.abs(ring - complex(x, y))
    return (
        (complex(x, y), 2 * float(np.median(off)))
        if np.mean(np.abs(off - np.median(off)) < 1e-3) > 0.75
        else None
    )


def edges(machine: Mechanism) -> tuple[list[Ring], list[Ring]]:
    """Holes and outlines of all copies of a machine at theta = 0."""
    parts, poses, number = (
        {part.name: part for part in machine.assembly.parts},
        machine.assembly.poses(np.zeros(1)),
        Counter[str](),
    )
    found: tuple[list[Ring], list[Ring]] = [], []
    for mount in machine.assembly.mounts:
        part, number[mount.part] = parts[mount.part], number[mount.part] + 1
        pose, copy = poses[part.name][number[part.name] - 1], f"{part.name}-{number[part.name]}"
        for layer in part.layers:
            for kind, contours in zip(
                found, (layer.region.holes, [layer.region.outer]), strict=True
            ):
                for edge in filter(None, map(round_edge, contours)):
                    own = -edge[0].conjugate() if pose.flipped else edge[0]
                    at = complex(pose.place[0]) + cmath.exp(1j * float(pose.angle[0])) * own
                    kind.append(
                        Ring(copy, at, edge[1], *heights(pose, part.thickness, layer.z0, layer.z1))
                    )
    return found


def part_of(copy: str) -> str:
    return copy.rpartition("-")[0]


def steps(machine: Mechanism) -> Iterator[tuple[int, str, set[str], set[str]]]:
    """Number, where it goes, the copies that come, and those that are there: of what is built by itself its own."""
    table = order_of_assembly(machine.assembly)
    built, bench = defaultdict[str, set[str]](set), set[str]()
    last = {step.joins: k for k, step in enumerate(table.steps)}  # before it what joins is tried
    for k, (row, step) in enumerate(zip(table.rows, table.steps, strict=True)):
        laid, there = set(step.copies), built[step.apart]
        laid |= built.pop(step.joins) if step.joins and last[step.joins] == k else set()
        if step.group and laid:
            yield int(str(row[0])), str(row[3]), laid, set(bench)
            bench |= laid
        else:
            laid = bench if step.group else laid
            yield int(str(row[0])), str(row[3]), laid, set(there)
            there |= laid
            bench = bench if not step.group else set()
    assert not bench, "what is built is put in"


def misnamed(machine: Mechanism) -> list[str]:
    """Steps that name a part which is neither there by then nor comes, or one that holds it later and does not come later."""
    every, found = {part.name for part in machine.assembly.parts}, list[str]()
    all_steps = [*steps(machine)]
    for count, where, coming, there in all_steps:
        where, _, until = where.partition("loose until ")
        afterwards = set(map(part_of, set().union(*(each[2] for each in all_steps[count:]))))
        held = set(re.findall(r"[\w-]+", until)) & every
        found += [f"step {count}: {part}" for part in held - afterwards]
        said = set(re.findall(r"[\w-]+", where)) & every
        known = set(map(part_of, (*there, *coming)))
        found += [f"step {count}: {part}" for part in said if part not in known]
    return found


def unfixed(machine: Mechanism) -> list[str]:
    """What is tight and not said to be fixed when the later of both comes, and what is said to be and is not."""
    holes, outlines = edges(machine)
    press, slide = machine.print.press_clearance, machine.print.slide_clearance
    made = {part.name: part.process for part in machine.assembly.parts}
    rings = {ring.part for each in machine.assembly.features for ring in getattr(each, "rings", ())}
    tight: set[frozenset[str]] = set()
    for hole in holes:
        for outline in (each for each in outlines if each.goes_through(hole, (press + slide) / 2)):
            bought = made[part_of(hole.copy)] == made[part_of(outline.copy)] == "bought"
            if not bought and part_of(hole.copy) not in rings:
                tight.add(frozenset((hole.copy, outline.copy)))
    found = list[str]()
    named = [set(step.copies) for step in order_of_assembly(machine.assembly).steps]
    for count, where, coming, there in steps(machine):
        again = set[str]().union(*named[count:])
        laid = coming - (named[count - 1] & again)  # what comes again is loose until then
        said = {
            part
            for clause in re.findall(r"(?:press|glued|keyed)[a-z ]* (?:on|into) ([^,;]*)", where)
            for part in re.findall(r"[\w-]+", clause.partition(" at ")[0])
            if part in made
        }
        wanted = {
            part_of(other)
            for pair in tight
            for copy in pair & laid
            for other in pair - {copy}
            if other in there - coming
        }
        found += [f"step {count}: {sorted(said)} for {sorted(wanted)}"] if said != wanted else []
    return found


def empty(machine: Mechanism) -> list[Ring]:
    """Holes for a pin or a shaft of the machine, by their size, through which none goes. Left out are pens, what a motor that is
    bought reaches into and the spacers on its shaft, and pockets over a screw's hole, which are as wide by chance."""
    holes, outlines = edges(machine)
    slide = max(machine.print.slide_clearance, machine.print.press_clearance) + 1e-3
    slender = [each for each in outlines if re.search(r"pin|shaft|dowel|axle", part_of(each.copy))]
    sizes = {round(each.diameter, 6) for each in slender}
    meant = [
        hole for hole in holes if any(0 <= hole.diameter - size + 1e-6 <= slide for size in sizes)
    ]
    screws = [
        hole
        for hole in holes
        if any(abs(hole.diameter - screw.clearance) < 1e-3 for screw in SCREWS.values())
    ]
    meant = [
        hole
        for hole in meant
        if not any(each.copy == hole.copy and abs(each.at - hole.at) < 1e-3 for each in screws)
    ]
    poses, left = machine.assembly.poses(np.zeros(1)), list[tuple[str, complex]]()
    for feature in machine.assembly.features:
        pin = getattr(feature, "pin", None)
        eyes = (
            [feature.eye]
            if isinstance(feature, Mark)
            else [feature.a, feature.b]
            if pin and pin.part is None
            else []
        )
        left += [
            (eye.part, complex(pose.place[0] + cmath.exp(1j * float(pose.angle[0])) * eye.at))
            for eye in eyes
            for pose in poses[eye.part]
        ]
    meant = [
        hole
        for hole in meant
        if not any(
            (part_of(hole.copy) == part or hole.copy.startswith("spacer"))
            and abs(hole.at - at) < 1e-3
            for part, at in left
        )
    ]
    return [hole for hole in meant if not any(each.goes_through(hole, 1.0) for each in outlines)]


OWN_WORDS = {"uniform-swing", "drum-feeder", "end-cam"}  # steps in words of their own


@pytest.mark.long
@pytest.mark.parametrize("name", [name for name in MACHINES if name != "uniform-swing"])
def test_what_a_step_names_is_there(name: str) -> None:
    assert not misnamed(built(name))


@pytest.mark.long
@pytest.mark.parametrize("name", [name for name in MACHINES if name not in OWN_WORDS])
def test_what_a_step_fixes_is_held(name: str) -> None:
    assert not unfixed(built(name))


@pytest.mark.long
@pytest.mark.parametrize("name", MACHINES)
def test_no_hole_for_a_pin_is_left_empty(name: str) -> None:
    assert not empty(built(name))


def body_of(machine: Mechanism) -> dict[str, str]:
    """The body of each copy."""
    number, found = Counter[str](), {}
    for mount in machine.assembly.mounts:
        number[mount.part] += 1
        found[f"{mount.part}-{number[mount.part]}"] = mount.body
    return found


def misglued(machine: Mechanism) -> list[str]:
    """Round fits that are said to be glued and belong to two bodies, or to be free and belong to one."""
    holes, outlines = edges(machine)
    bodies, found = body_of(machine), list[str]()
    all_steps = order_of_assembly(machine.assembly).steps
    for number, step in enumerate(all_steps):
        if any(set(step.copies) & set(later.copies) for later in all_steps[number + 1 :]):
            fits = (mate for mate in step.mates if mate not in step.glued)  # else flat on flat
            found += [f"{step.title}: {mate}" for mate in fits if mate.how != "free"]
            continue
        for mate in (each for each in step.mates if each.height and not step.dry):
            at, z = complex(*mate.place[:2]), mate.place[2]
            through = [
                ring
                for ring in outlines
                if abs(ring.at - at) < 1e-3 and abs(ring.diameter - mate.diameter) < 1e-3
            ]
            # one shaft turns the cranks of both sides, but nothing of theirs is loose on the other's
            side = "far_" if mate.how == "glue" else ""
            pairs = {
                bodies[hole.copy].removeprefix(side) == bodies[ring.copy].removeprefix(side)
                for ring in through
                for hole in holes
                if ring.low < z < ring.high and hole.low < z < hole.high
                if ring.goes_through(hole, 1.0)
            }
            if pairs and (mate.how != "free") not in pairs:
                found.append(f"{step.title}: {mate}")
    return found


@pytest.mark.long
@pytest.mark.parametrize("name", MACHINES)
def test_glue_is_said_between_parts_of_one_body_and_none_where_two_bodies_move(name: str) -> None:
    assert not misglued(built(name))


def test_glue_in_a_turning_joint_and_none_in_a_fixed_one_are_found(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    whole = MODULE.order_of_assembly(built("drag link").assembly)
    for how, wrong in (("free", "glue"), ("glue", "free")):
        steps = [
            replace(
                step,
                mates=[
                    replace(mate, how=wrong) if mate.how == how else mate for mate in step.mates
                ],
            )
            for step in whole.steps
        ]
        monkeypatch.setattr(MODULE, "order_of_assembly", lambda _: replace(whole, steps=steps))  # noqa: B023
        assert misglued(built("drag link"))
        monkeypatch.undo()


def test_glue_and_none_of_the_leg(leg: Mechanism) -> None:
    """By the spec's joints: the crank is fixed on its shaft, which turns in the plate; A, B, D, E and F turn on printed pins."""
    mates = {
        row[1]: {(mate.how, mate.label) for mate in step.mates}
        for row, step in zip(
            order_of_assembly(leg.assembly).rows,
            order_of_assembly(leg.assembly).steps,
            strict=True,
        )
    }
    assert mates["ground"] == {("free", "O"), ("free", "C")}
    assert mates["crank"] == {("glue", "O")}
    assert mates["hanger"] == {("glue", "C")}, "it is held by the pin that turns in the plate"
    pins = {("free", letter) for letter in "AE"} | {("glue", letter) for letter in "AE"}
    assert mates["pin-2"] == pins


def test_a_mate_is_where_both_meet() -> None:
    """A pin of 2 from z = 0 to 30 in a plate of 2 at z = 10, about x = 15."""
    plate = Part(
        "plate",
        "Plate",
        (Layer(Region(circle(0, 9), (circle(5, 1.2),)), 0, 2),),
        points=(("P", 5 + 0j),),
    )
    pin = Part("pin", "Pin", (Layer(Region(circle(0, 1)), 0, 30),))
    poses = {
        "pin": [PartPose(np.array([15 + 0j]), np.zeros(1), False, 0.0)],
        "plate": [PartPose(np.array([10 + 0j]), np.zeros(1), False, 10.0)],
    }
    mounts = (Mount("pin", "ground", 15), Mount("plate", "link", 10, z=10.0))
    free = Mate("free", "P", (15.0, 0.0, 11.0), 2.0, 2.0)
    assert list(order(standing_copies((pin, plate), mounts, poses), (), PLAY).steps[1].mates) == [
        free
    ]
    loose = (mounts[0], replace(mounts[1], body="ground"))
    assert not order(standing_copies((pin, plate), loose, poses), (), PLAY).steps[1].mates, (
        "glue locks nothing"
    )


def test_what_is_fixed_together_at_one_height_is_built_by_itself_and_put_in() -> None:
    """Dowels stand in crank and coupler; each with its link is a sub-assembly, and no step is between its own."""
    steps = order_of_assembly(built("dowels").assembly).steps
    groups = list(dict.fromkeys(step.group for step in steps if step.group))
    assert groups
    for group in groups:
        at = [k for k, step in enumerate(steps) if step.group == group]
        assert at == list(range(at[0], at[-1] + 1)) and len(at) >= 3
        assert [bool(steps[k].copies) for k in at] == [True] * (len(at) - 1) + [False]
        bodies = body_of(built("dowels"))
        assert len({bodies[copy] for k in at for copy in steps[k].copies}) == 1


def test_damaged_steps_are_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """The second plate's row first, the last two rows swapped, and a pin said to be pressed into what it only goes through."""
    machine, table = load(BAR), order_of_assembly(load(BAR).assembly)
    rows, laid = list(table.rows), list(table.steps)
    plate = next(k for k, row in enumerate(rows) if row[1] == "second-plate")
    damaged = replace(
        table,
        rows=[rows[plate], *rows[:plate], *rows[plate + 1 :]],
        steps=[laid[plate], *laid[:plate], *laid[plate + 1 :]],
    )
    loose = [
        (
            *row[:3],
            str(row[3]).replace("through A of coupler", "pressed into A of coupler"),
            *row[4:],
        )
        for row in rows
    ]
    assert loose != rows
    for wrong, check in (
        (damaged, misnamed),
        (damaged, unfixed),
        (replace(table, rows=loose), unfixed),
    ):
        monkeypatch.setitem(vars(machine), "assembly", replace(machine.assembly, work=[wrong]))
        assert check(machine)


def test_a_hole_without_its_pin_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """The pin of C hangs from the second plate: a hole for it in the ground plate stays empty."""
    machine = load(BAR)
    assert "hole C" not in str(machine.assembly.parts[0].notes)
    for module in (body_parts, plate_parts):
        monkeypatch.setattr(module, "in_first", lambda *_: True)
    assert {
        (hole.copy, round(hole.at.real, 6), round(hole.at.imag, 6)) for hole in empty(load(BAR))
    } == {("ground-1", 10, 0)}


def test_a_pin_that_hangs_is_fixed_when_its_plate_comes() -> None:
    rows = {
        str(row[1]): (k, str(row[2]), str(row[3]))
        for k, row in enumerate(order_of_assembly(load(BAR).assembly).rows)
    }
    (pin,) = (
        name
        for name, (_, _, where) in rows.items()
        if name.startswith("pin") and where.startswith("loose")
    )
    assert (
        rows[pin][0] < rows["rocker"][0] < rows["second-plate"][0]
        and "C on " + pin in rows["rocker"][2]
    )
    assert f"C glued on {pin}" in rows["second-plate"][2]


@pytest.mark.long
@pytest.mark.parametrize(
    ("spec", "changes", "driven", "motors"),
    [
        ("disc-cam.toml", {"parts.make": "printed", "parts.motor": "nema-17"}, {"cam-contact"}, 1),
        ("gallery/five-bar.toml", {}, {"left", "right"}, 2),
        ("gallery/walker.toml", {}, {"crank"}, 1),
    ],
)
def test_what_a_motor_turns_is_put_on_its_shaft(
    spec: str, changes: dict[str, object], driven: set[str], motors: int
) -> None:
    """A part whose hole is as wide as the shaft, and no other one; how many motors the table has."""
    machine = load(Path(__file__).parents[2] / "specs" / spec)
    if changes:
        machine = machine.replace({"parts.hub_height": None, **changes})
    rows = order_of_assembly(machine.assembly).rows
    assert {row[1] for row in rows if "on the motor's shaft" in str(row[3])} == driven
    assert [row[4] for row in rows if row[1] == "motor"] == [motors]
    first = next(row for row in rows if row[1] in ("ground", "motor-bar"))
    assert "loose" not in str(first[3]), "what comes first lies as it is"


@pytest.mark.long
def test_only_what_a_later_part_holds_is_fixed_by_it() -> None:
    """A rod that a pin joins is not held by that; a pin over which a cap is glued is."""
    rod = [
        row[3] for row in order_of_assembly(built("quick-return").assembly).rows if row[1] == "rod"
    ]
    assert rod == ["loose until pin-2 joins it"]
    leg = load(Path(__file__).parents[2] / "specs/gallery/walker.toml")
    rows = [row for row in order_of_assembly(leg.assembly).rows if row[1] == "pin-2"]
    own = [str(row[3]) for row in rows if row[2] == "Pin 2"]
    assert own and not any("loose" in where for where in own)
    hung = {str(row[3]) for row in rows if row[2] == "Pin 2 with cap-1"}
    assert hung == {"loose until low3 joins it by B and second-plate is glued on it by B"}
    (leg4, _) = (
        row[3] for row in order_of_assembly(leg.assembly).rows if "Leg4 with" in str(row[2])
    )
    assert leg4 == "loose until conn4 joins it by D4 and cap-2 is glued on it"


def test_a_walker_says_how_its_sides_are_joined_and_on_what_they_lie() -> None:
    """Hole O of the far web takes the shaft of both sides; under the near plate hangs the motor, under the far one the batteries."""
    walker = built("walker")
    table = steps_of_assembly(walker)
    titles = [step.title for step in table.steps]
    (web,) = (part for part in walker.assembly.parts if part.name == "crank_web3")
    assert "O" in dict(web.points)
    (trial,) = (
        k for k, title in enumerate(titles) if title.startswith("Lower the far side on the spacers")
    )
    assert "Shaft-crank_web3 goes into O of the far crank_web3; turn the far crank" in titles[trial]
    join = trial + 1
    last = titles[join]
    assert "Put two-part glue into O of the far crank_web3 through O of its second plate" in last
    glued = {mate.label for mate in table.steps[join].mates if mate.how == "glue"}
    assert glued == {"O"}, "as it says"
    dry = table.steps[trial]
    assert dry.joins == table.steps[join].joins == "far side", "its picture has the far side too"
    assert {mate.how for mate in dry.mates} == {"free"} and "O" in {m.label for m in dry.mates}
    (slips,) = (title for title in titles if "spacer-1 over O of crank_web3" in title)
    assert (
        "spacer-1 over O of crank_web3, stuck there with a dot of grease on its rim, none in its bore."
        in slips
    )
    deep = {each.name: each for each in walker.assembly.stand_ins}["motor"]
    (plate,) = (title for title in titles if title.startswith("Lay the ground plate on the bench"))
    blocks = math.ceil(5 - min(disc[2] for disc in deep.discs))  # with room for its wires
    assert f"two blocks at least {blocks} mm" in plate
    numbers = {str(row[1]): row[0] for row in table.rows}
    assert numbers["far-battery-frame"] < numbers["far-shaft"], "no loose shaft is in the way"
    batteries = next(k for k, title in enumerate(titles) if "Stick the battery holder" in title)
    assert titles[batteries].endswith("on the plate in the frame with double-sided tape.")
    assert batteries == trial - 1, "it runs on them in the next step"
    led = "Lead the wires of the batteries past both plates and along a spacer, taped to it"
    assert "double-sided tape" in table.steps[trial].doings[2].needs
    spaced = next(title for title in titles if "Tilt the machine and screw each on" in title)
    assert "4 × spacer between both sides" in spaced
    run = titles[trial].index("join them to the motor's and let it run")
    assert titles[trial].index(led) < run
    assert "swap the motor's two wires" in titles[trial]
    assert titles[trial].index("without screws or glue yet") < run
    assert last.index("Lift the far side off") < last.index("and screw it on the spacers")
    assert "as soon as all moved freely in that trial" in last
    assert last.index("Use 4 × screw of a spacer") < last.index("Let nothing turn until the glue")
    (motor,) = (title for title in titles if "Hold the motor under the plate" in title)
    assert "Hold its wires to the batteries and let it run before you go on" in motor
    assert "its nuts below the motor bar" in motor and "goes into O, 4 mm wide: scrape" in motor
    over = {mount.part: mount.z for mount in walker.assembly.mounts}
    for leg in ("leg3", "leg4"):
        near, far = (title for title in titles if f"Lay {leg} as the picture shows" in title)
        height = next(each.z for each in walker.assembly.mounts if each.part == leg)
        height -= over["ground"]
        said = f"Prop it on a block {height + blocks:.4g} mm high, where those under ground are {blocks} mm high"
        assert said in near and said.replace("ground", "far-ground") in far
    (on, far) = (title for title in titles if "far-ground" in title and "two blocks" in title)
    assert "far-battery-frame) on it. One of its inner corners" in on
    assert f"two blocks at least {blocks} mm" in far, "for steps that are done again"
    assert "a block under far-shaft" in far, "as soon as it stands there"
    over = "Set the ground plate (far-ground) with O on far-shaft."
    assert far.endswith(over) and far.index("two blocks") < far.index("a block under far-shaft")
    (free,) = (title for title in titles if "O of crank on far-shaft" in title)
    throw = -21.44 * 1j  # M, a quarter of a turn ahead of the near side
    near, far_off = (abs(throw - at) for at in (-47.2 - 14.08j, 18.64 + 49.28j))  # B and B2, A2
    assert near < far_off and abs(throw - (47.2 - 14.08j)) == pytest.approx(near)
    stands = f"M {near:.1f} mm from the middle of B and {near:.1f} mm from that of B2"
    assert f"Turn crank until it stands as the pictures show, {stands}." in free
    parts = walker.assembly.by_name
    pressed = max(parts[name].thickness for name in ("pin-1", "pin-2", "pin-3"))
    out = pressed - parts["far-ground"].thickness
    assert f"underside up, on two blocks at least {out + 1:g} mm high: its pins stick out" in on
    supply = {each.name: each.size for each in bought_things(walker)}["battery holder"]
    assert "for 4 AAA cells side by side, 6 V" in supply, "as the comments of its spec say"
    has = {each.name: each for each in tools(walker)}
    assert has["block"].count == 2 and has["block"].size.startswith(f"at least {blocks} mm")
    assert "with a thin stick" in last and "thin stick" in has
    props = "7.35, 12.55, 14.55, 30, 2 × 36, 55.3 and 58.35 mm high"
    assert props in has["prop"].size and has["prop"].count == 8, "as steps name them"
    for prop, end in (
        ("14.55", "pin-3"),
        ("12.55", "the lower pin-2"),
    ):  # which end at 10 and at 14
        assert any(f"block {prop} mm high on the end of {end};" in title for title in titles)
    used = {each.name for each in supplies(walker)}
    assert "two-part glue" in used, "on the motor's shaft"
    (filed,) = (title for title in titles if title.startswith("Cut and file"))
    aside = 42.88 * math.radians(1)  # from throw to throw
    assert f"would put the next web {aside:.1f} mm aside at its other end" in filed
    assert filed.count("Clamp each crank pin along the vice, 0.67 mm of it over the jaws") == 1
    assert "its flat against the right jaw and the upper half, towards you" in filed


def test_a_walker_s_motor_and_batteries_come_from_where_they_go_and_are_seen() -> None:
    """The motor from below, with the bar that holds it, the frame likewise, the holder into it; sizes and places as in its spec."""
    walker = built("walker")
    steps = steps_of_assembly(walker).steps
    (bar,) = (step for step in steps if "motor-bar-1" in step.copies)
    assert bar.way == 1 and bar.title.startswith("Measure the motor's shaft")
    assert (
        "Keep the chips out of the motor. Press the motor bar on the motor's gearbox" in bar.title
    )
    assert "flush with its front, with two-part glue on the edges of the front alone" in bar.title
    motor = bar  # one picture shows both
    assert "its shaft up through O" in motor.title
    (crank,) = (step for step in steps if "Push crank on the motor's shaft" in step.title)
    (on_flat,) = (mate for mate in crank.mates if mate.label == "O")
    assert (on_flat.how, on_flat.diameter, on_flat.height) == (
        "glue",
        pytest.approx(3, abs=0.2),
        pytest.approx(3),
    )
    down = walker.assembly.feet.down
    assert steps[-1].up == tuple(-each for each in down) != (0, 0, 1), "as it stands"
    last = steps[-1].title
    assert last.startswith("When the glue is hard, set the machine on its feet. Switch it on")
    (hole,) = (mate for mate in motor.mates if mate.label)
    assert (hole.label, hole.how, hole.diameter) == ("O", "free", 3), "its letter is in the picture"
    assert 0 < hole.place[2] < walker.assembly.by_name["ground"].thickness
    (body, low, high), (shaft, foot, end) = motor.shapes
    can = walker.making.can
    assert can is not None
    assert low == -can.length and max(abs(z) for z in body) == pytest.approx(can.diameter / 2)
    assert max(abs(z) for z in shaft) == pytest.approx(1.5) and foot == high < 0 < end
    plate = next(k for k, step in enumerate(steps) if "ground-1" in step.copies)
    assert steps[plate + 1] is bar
    frame, on_shaft = (step for step in steps if "far-battery-frame-1" in step.copies)
    assert frame.way == 1 and frame.up == (0.0, 0.0, -1.0)
    assert "far-ground-1" in on_shaft.copies, "it comes with the plate, on which it is glued"
    foot = next(each for each in walker.assembly.mounts if each.part == "far-battery-frame")
    rim = walker.assembly.by_name[foot.part].region
    places = [complex(*mate.place[:2]) - foot.at for mate in frame.mates if mate.how == "glue"]
    assert {mate.place[2] for mate in frame.mates} == {foot.z}, "between plate and frame"
    sides = sorted((round(z.real, 3), round(z.imag, 3)) for z in places)
    x, y = (
        26 + 0.025 + 0.8,
        24 + 0.025 + 0.8,
    )  # half of 52 x 48, half the play of 0.05, half of a wall of 1.6
    assert sides == [(-x, 0), (0, -y), (0, y), (x, 0)] and len(rim.holes) == 1
    play = walker.print.slide_clearance + walker.print.press_clearance
    half = complex(52 + play, 48 + play) / 2
    points = dict(walker.assembly.by_name["ground"].points)
    told = re.findall(r"([\d.]+) mm from (?:the middle|that) of (\w+)", frame.title)
    assert len(told) == 4
    for away, hole in told:
        corners = [59j + complex(x * half.real, y * half.imag) for x in (-1, 1) for y in (-1, 1)]
        assert min(abs(abs(z - points[hole]) - float(away)) for z in corners) < 0.06
    holder = steps[-4]
    assert holder.title.startswith(
        "Far side: turn it over: the frame is up. Stick the battery holder"
    )
    assert holder.up == (0.0, 0.0, 1.0) and not steps[-1].apart
    ((ring, below, above),) = holder.shapes
    stands = next(each for each in walker.assembly.mounts if each.part == "far-battery-frame")
    assert (below, above - below) == (stands.z, walker.assembly.by_name[stands.part].thickness)
    assert np.ptp([z.real for z in ring]) == pytest.approx(52 + play)


def test_nothing_is_tried_while_a_link_lies_loose() -> None:
    """Legs of a walker that their rods join later lie on a block: these rods come next that are not on the same level."""
    walker = built("walker")
    steps = order_of_assembly(walker.assembly).steps
    heights = {mount.part: mount.z for mount in reversed(walker.assembly.mounts)}
    for leg, rod in (("leg4", "conn4"), ("leg3", "conn3")):
        laid = next(k for k, step in enumerate(steps) if f"ay {leg} as the picture" in step.title)
        joined = next(k for k, step in enumerate(steps) if f"et {rod} with" in step.title)
        between = steps[laid + 1 : joined]
        assert laid < joined and not any("ove leg" in step.title for step in between)
        names = {copy.rpartition("-")[0] for step in between for copy in step.copies}
        assert all(heights[name] > heights[leg] for name in names if name in ("conn4", "high4"))
        assert not any(name.startswith("cap-") for name in names), "these are of its level"


def test_posts_that_are_glued_on_a_plate_show_where() -> None:
    """Round the holes of their screws, on the face of the plate, of the far side too, whose plate is 5 thick and turned over."""
    walker = built("walker")
    steps = [
        step for step in steps_of_assembly(walker).steps if "Glue each on the plate" in step.title
    ]
    plates = {mount.part: mount.z for mount in walker.assembly.mounts if "ground" in mount.part}
    faces = [plates["ground"] + 5, plates["far-ground"]]
    for step, face in zip(steps, faces, strict=True):
        marks = [mate for mate in step.mates if mate.how == "glue"]
        assert [mate.place[2] for mate in marks] == pytest.approx([face] * 4)
        assert {(round(x, 6), round(y, 6)) for x, y, _ in (mate.place for mate in marks)} == {
            (-4, -30.4),
            (-24, 29.6),
            (4, -46.4),
            (24, 29.6),
        }


def test_a_walker_s_steps_say_what_the_hands_do() -> None:
    """Pins that hang by their heads are held, flats go on flats, a gap that posts leave is not set, the crank's height is."""
    walker = built("walker")
    titles = [step.title for step in steps_of_assembly(walker).steps]
    (lid,) = (
        title
        for title in titles
        if "Lower the second plate over all ends" in title and "Far" not in title
    )
    assert "Keep pin-2 and pin-4 where they stand: a rod or block in the gap" in lid
    parts = walker.assembly.by_name
    low = {each.part: each.z for each in reversed(walker.assembly.mounts)}  # of the near side
    top = low["second-plate"] + parts["second-plate"].thickness
    # where it is assembled B2 is 3.7 mm from the line D2 F2 of leg2, by the points of its spec, and B likewise from D3 F3
    d, f, b = 59.2 + 8.4j, 15.87 - 50.5j, 47.2 - 14.08j
    beside = abs(((f - d).conjugate() * (b - d)).imag) / abs(f - d)
    assert beside < 4, "half of the leg's width is more"
    gaps = [
        top - parts[pin].thickness - low[leg] - parts[leg].thickness
        for pin, leg in (("pin-2", "leg3"), ("pin-4", "leg2"))
    ]
    assert gaps[0] == pytest.approx(0.2), "two sheets of paper"
    paper = "two sheets of paper under pin-2 stay until the glue is hard"
    assert f"gap of {gaps[1]:.4g} mm under pin-4 and {paper}; then push them out" in lid
    stands = (
        "over B of low1, cap-1 down, on two sheets of paper on leg3",
        f"over B2 of low2, cap-3 down, on a rod or block {gaps[1]:.4g} mm high on leg2",
    )
    for where in stands:
        propped = f"upright {where}, which must not move; it stays loose until"
        (near,) = (k for k, title in enumerate(titles) if propped in title)
        after = titles[near].partition(propped)[2]
        assert "Move " not in after, "a leg under it"
    assert lid.count("Move ") == 1 and "Move conn3, high3, low4 and low3 by hand" in lid
    dry = next(k for k, title in enumerate(titles) if "Lay second-plate on the pins, dry" in title)
    assert "pin-2 upright" in titles[dry + 1], "on which the plate would tip"
    assert lid.startswith(
        "Try the second plate on dry first: all ends go in, and it clamps no spacer. Put two-part glue "
        "into A, B, A2 and B2: superglue would set before all ends"
    )
    stood = [title for title in titles if "tand pin-2 upright" in title]
    putty = "Adhesive putty beside its foot holds it upright"
    assert [each.count(putty) for each in stood] == [1, 1]
    assert "Leave two sheets of paper there" in stood[0] and "sheets" not in stood[1]
    assert "It lies on 4 posts, over all other parts." in lid and "Lay it on" not in lid
    assert "down on post: spacer-3 must keep some play, or is sanded shorter first" in lid
    assert "B on pin-2, with a strip of a plastic bag between cap-1 and low3" in lid, "by no end"
    web = next(title for title in titles if title.startswith("Glue M of crank_web2"))
    assert "on crank-pin-1, flat on flat" in web
    faces = (
        "☐ as parts go on, letters face up; on the far side they face down, except on far-ground"
    )
    assert faces in titles[0], (
        "links are turned over as they are, the plate has an image of its own"
    )
    benches = [title for title in titles if title.startswith("Put these together on the bench")]
    assert len(benches) == 2 and max(each.count("☐") for each in benches) == 8, "two pictures"
    pressed = " ".join(benches)
    assert benches[0].count("Glue:") == 1 and "\nGlue:" not in benches[1]
    assert "☐ crank-pin-1 into N of crank_web2, flat on flat, with two-part glue" in pressed
    assert "lay the link with its letters down" in benches[0]
    of_both = [line for line in pressed.split("\n") if "(make 2" in line]
    links = {line for line in of_both if re.search(r" into [A-Z]\d? ", line)}
    assert {line for line in of_both if "(make 2, 1 of them mirrored: F)" in line} == links
    assert len(of_both) - len(links) == 2, "a cap on a dowel has no hand"
    assert benches[-1].endswith("\nLet all this get hard before you use it.")
    (upright,) = (title for title in titles if "it keeps the shaft upright" in title)
    assert "Lay second-plate on the pins, dry, with O over shaft-crank_web3." in upright
    off = (
        abs(-47.2 - 14.08j + 21.44),
        abs(-18.64 + 49.28j + 21.44),
    )  # of B and A from M, which is left of O
    (crank,) = (title for title in titles if "on the motor's shaft" in title)
    assert crank == (
        "Put crank on the motor's shaft, dry, and run the motor until it stands as the picture shows, "
        f"M {off[0]:.1f} mm from the middle of B and {off[1]:.1f} mm from that of A. Take it off again. Push crank on "
        "the motor's shaft, flat on flat, with two-part glue all round in its bore and none on the motor, 0.05 mm over ground (a strip "
        "of a plastic bag between, then pull it out). Whenever the motor has moved the links, stop it there again."
    )


@pytest.mark.parametrize(
    ("name", "through", "cut"),
    [
        (
            "walker",
            [
                "2.4 mm, for M2: 2 holes of ground and 2 holes of motor-bar",
                "3.4 mm, for M3: 4 holes of ground, 4 holes of second-plate (2 ×), the hole of post (8 ×) and 4 holes of far-ground",
            ],
            ["2.5 mm, for M3: the hole of side-spacer (4 ×)"],
        ),
        (
            "flapping-bird",
            ["3.4 mm, for M3: 2 holes of stand-panel"],
            ["2.5 mm, for M3: 2 holes of ground"],
        ),
    ],
)
def test_holes_of_screws_are_tried_before_anything_is_put_together(
    name: str, through: list[str], cut: list[str]
) -> None:
    """Clearance holes [ISO 273, medium], and those in which a thread is cut [ISO 2306]."""
    titles = [step.title for step in steps_of_assembly(built(name)).steps]
    (lists,) = (title for title in titles if "Open these until" in title)
    tried = lists.partition("Try a screw in each of these.")[2]
    lines, _, rest = tried.partition("Screws cut their own threads in these.")
    assert re.findall("☐ (.*)", lines) == through
    assert re.findall("☐ (.*)", rest.removesuffix(".")) == cut
    drills = {each.name for each in tools(built(name))}
    assert {f"drill {line.partition(' mm')[0]}" for line in (*through, *cut)} <= drills


def test_a_pin_from_above_comes_before_what_its_links_would_throw_off() -> None:
    """Wings get their pins, and are moved, before rods and a spacer lie loose on them."""
    rows = order_of_assembly(built("flapping-bird").assembly).rows
    names = [str(row[1]) for row in rows]
    first, second, third = (names.index(name) for name in ("left_wing", "right_wing", "left_rod"))
    assert names[first : third + 1] == ["left_wing", "right_wing", "pin-1", "left_rod"]
    assert rows[second + 1][4] == 2, "one through each wing"
    fourth = names.index("right_rod")
    assert names[third + 1 : fourth] == ["spacer-1", "pin-1"] and names[fourth + 1] == "pin-2"


@pytest.mark.parametrize("name", ["walker", "flapping-bird", "four-leg-walker", "dial-table"])
def test_what_goes_in_by_hand_is_not_pressed(name: str) -> None:
    """Holes of the list of those that are opened until the part slides in by hand are in no sentence that begins with "press"."""
    titles = [step.title for step in steps_of_assembly(built(name)).steps]
    (lists,) = (title for title in titles if "Open these until" in title)
    loose = lists.partition("Open these until")[2].partition("These holes stay tight")[0]
    fits = set[tuple[str, str]]()
    for line in loose.splitlines():
        for letters, part in re.findall(
            r"((?:[\w ]+, )*[\w ]+) of ([\w-]+)", line.partition(":")[2]
        ):
            fits |= {(letter, part) for letter in re.findall(r"\w+", letters)}
    assert len(fits) > 3
    pressed = [
        said
        for title in titles
        if title is not lists
        for said in re.findall(r"[Pp]ress and glue ([^.\n]*)", title)
    ]
    for said in pressed:
        holes = set(re.findall(r"(\w+) of ([\w-]+)", said.partition(" on ")[0]))
        into = re.search(r"into (\w+) of ([\w-]+)", said)
        holes |= {into.groups()} if into else set()
        assert not holes & fits, said
        assert ("bore", said.split(" on ")[0].split(" ")[-1]) not in fits, said
    assert any(re.search(r"\b[Gg]lue (?!hard)", title) for title in titles)


def test_steps_set_gaps_whatever_the_length_of_dowels() -> None:
    """Dowels are sold some tenths too long: no cap on one is set by its end, and those that are too long are filed first."""
    walker = built("walker")
    titles = [step.title for step in steps_of_assembly(walker).steps]
    dowels = {
        part.name
        for part in walker.assembly.parts
        if part.process == "bought" and part.role == "pin"
    }
    assert dowels
    capped = [
        said
        for title in titles
        for said in re.findall(r"cap-\d on (pin-\d)\b[^.]*", title)
        if said in dowels
    ]
    assert len(capped) > 10
    for said in (
        each for title in titles for each in re.findall(r"[Gg]lue cap-\d on [^.]*", title)
    ):
        assert "a strip of a plastic bag under it" in said and "flush" not in said
    (cut,) = (title for title in titles if "Measure the dowels" in title)
    assert titles.index(cut) < 4
    leg = [step.title for step in steps_of_assembly(built("walking-leg")).steps]
    assert any("Measure the dowels" in title for title in leg)
    bird = [step.title for step in steps_of_assembly(built("flapping-bird")).steps]
    assert not any("dowels" in title for title in bird), "its pins are printed"


def test_the_web_of_the_far_side_is_held_on_its_axis_by_a_gauge() -> None:
    """Its shaft comes last: a piece of the same rod, with the same flat, which is cut and bought too."""
    walker = built("walker")
    steps = steps_of_assembly(walker).steps
    (web,) = (step for step in steps if step.gauges)
    assert web.apart == "far side" and "Glue N on crank-pin-1" in web.title
    assert "push the gauge through its O into O of crank_web3" in web.title
    assert web.title.endswith("Take both off again."), "parts come between"
    (gauge,) = web.gauges
    (listed,) = (each for each in tools(walker) if each.name == "gauge")
    assert listed.size == f"{gauge}, cut of the same rod" and listed.count == 1
    sizes = walker.making
    assert (
        gauge == f"rod {sizes.shaft_diameter:g} h9 x 30, a flat {sizes.shaft_flat:g} deep all along"
    )
    levels = {each.part: each.z for each in walker.assembly.mounts}
    deep = levels["second-plate"] + walker.assembly.by_name["second-plate"].thickness
    assert deep - levels["crank_web3"] < 20, "10 mm are left to hold it by"
    (cut,) = (step.title for step in steps if step.title.startswith("Cut and file"))
    assert f"☐ 1 × gauge: {gauge}" in cut
    (rod,) = (each for each in stock(walker) if each.name == "steel rod 3 h9")
    lengths = [
        note.length * part.count
        for part in walker.assembly.parts
        for note in part.notes
        if isinstance(note, SizeNote) and note.stock == "rod 3 h9"
    ]
    assert f"{len(lengths) + 1} pieces" in rod.size and rod.size.startswith("125.3 mm")
    assert sum(lengths) + 30 == pytest.approx(125.25), "rounded up"


def test_a_pin_from_above_says_how_deep_it_goes() -> None:
    """By the solids of a four-bar and a trammel: a shank as long as what it goes through, and one that ends in a slot below."""
    for name, part, through, end in [
        ("four-bar", "pin-1", ("rocker", "ground"), "flush below"),
        ("elliptic-trammel", "pin-3", ("beam",), "till 5 mm of it stand out below"),
    ]:
        machine = built(name)
        made = machine.assembly.by_name
        play = machine.print.slide_clearance
        titles = [step.title for step in steps_of_assembly(machine).steps]
        (said,) = (title for title in titles if re.search(rf"\b{part} from above", title))
        # of the play between each two of them and under the head, all that is left when they are pushed together
        left = len(through) * play
        assert f", {end}, {left:g} mm left under its head with all pushed down" in said
        shank = max(made[part].layers, key=lambda layer: layer.z1 - layer.z0)
        stack = sum(made[each].thickness for each in through) + len(through) * play
        out = 5 if "5 mm" in end else 0
        assert shank.z1 - shank.z0 == pytest.approx(stack + out)


def test_a_step_says_which_end_is_down_and_counts_what_has_no_letter() -> None:
    """The clutches of a dial table run on the round end of their shaft; its plate has a hole whose name is that of the shaft."""
    machine = built("dial-table")
    round_below = machine.assembly.by_name["shaft-driven_link"].layers[0].region.outer
    assert len(round_below.pieces) == 1, "no flat at its lower end"
    titles = [step.title for step in steps_of_assembly(machine).steps]
    (shaft,) = (title for title in titles if "Stand the shaft of driven link" in title)
    assert "upright, its flat end up; it stays loose" in shaft
    (plain,) = (title for title in titles if "Stand the shaft of follower" in title)
    assert "upright; it stays loose" in plain, "both ends are alike"
    (plate,) = (
        title for title in titles if "Lower the ground plate over all ends at once" in title
    )
    assert ": one on shaft, pivot on shaft-follower and crank on shaft-unloader." in plate


def test_holes_in_which_something_turns_are_opened_first() -> None:
    """A four-bar as its spec has it: of each link the holes by which it turns, of the plate that of its shaft, and the knob's bore."""
    spec = Path(__file__).parents[2] / "specs" / "gallery" / "four-bar.toml"
    machine = read_mechanism(spec)
    sorting, first, glue, *_ = steps_of_assembly(machine).steps
    assert sorting.title == "Sort what looks alike.\n☐ pin-2 9.7 and pin-1 10.7 mm long."
    head, *lines = first.title.split("\n")
    play = machine.print.slide_clearance
    assert play == 0.1 and machine.making.pin_diameter == 5 and machine.making.shaft_diameter == 6
    assert (
        head.startswith("Open all 5 holes in which something turns or slides") and not first.copies
    )
    starts = (
        "Open these until",
        "These holes stay tight",
        "Try a screw in each of these",
    )
    assert "in steps of 0.5 mm, turn the next narrower one in it, then fine sandpaper" in head
    by_hand, tight, screws = (
        next(k for k, line in enumerate(lines) if line.startswith(start)) for start in starts
    )
    assert lines[:by_hand] == [
        "☐ 5.1 mm: A and B of coupler, C of rocker and the bore of knob",
        "☐ 6.1 mm: O of ground",
    ]
    assert lines[by_hand + 1 : tight] == [
        "☐ 5 mm: C of ground, A of crank and B of rocker",
        "☐ 6 mm: O of crank and the bore of collar",
    ], "no vice gets in where the plate is"
    assert lines[tight + 1 : screws] == [
        "☐ 5 mm: the narrower bore of hand-crank",
        "☐ 6 mm: the wider bore of hand-crank",
    ], "each of its holes once, that for the pin of 5 and that on the shaft of 6"
    begins, *rules = glue.title.split("\n")
    assert begins == "In all steps glue with superglue gel or two-part glue, a trace only."
    assert any("the link must swing by its own weight" in rule for rule in rules)
    assert any(rule.startswith("Where a step names two-part glue, use that") for rule in rules)
    assert all(rule.endswith(".") for rule in rules)
    assert rules[-2].startswith("Slit each strip to its middle"), "it goes round a pin"
    assert "unless the step says to leave them there" in rules[-3], (
        "strips under a pin from above stay"
    )
    assert rules[-1].startswith("A block under one part alone goes as soon as the glue is hard")
    names = {"ut a block under shaft", "ut a block under B of rocker"}
    said = " ".join(step.title for step in steps_of_assembly(machine).steps)
    assert all(name in said for name in names)
    feeder = read_mechanism(spec.with_name("drum-feeder.toml"))
    said = " ".join(step.title for step in steps_of_assembly(feeder).steps)
    assert "glue" in said and "lock under" not in said, "nor is one taken away"
    walker = steps_of_assembly(built("walker")).steps[1]
    _, _, said = walker.title.partition("Open these until")
    loose, _, stays = said.partition("These holes stay tight")
    stays = stays.partition("Try a screw")[0]
    assert "☐ 3 mm: O of crank_web3 (2 ×), O of crank (2 ×) and the bore of far-collar" in loose, (
        "the far web goes on its shaft with both sides there, the near crank on that of a motor which is there"
    )
    assert "N of crank_web3 (2 ×)" in loose and "the bore of cap-2 (22 ×)" in loose
    assert "of second-plate" in loose and "of second-plate" not in stays
    assert "crank_web3" not in stays and "C2 of conn2" not in stays and "C2 of low2 (2 ×)" in stays
    opened = "☐ 4.05 mm, with a reamer or a drill of 4.1: M and C1 of conn1 (2 ×), "
    assert opened in walker.title, "a dowel of 4 m6 drops through no hole of 4"
    spacers = {part.name: part.count for part in built("walker").assembly.parts}
    for name in ("spacer-1", "spacer-2", "spacer-3", "spacer-4"):
        assert f"the bore of {name} ({spacers[name]} ×)" in walker.title.partition("Open these")[0]
    cam = read_mechanism(spec.with_name("groove.toml"))
    assert not steps_of_assembly(cam).steps[0].title.startswith("Open"), "nothing turns in it"
    feeder = steps_of_assembly(read_mechanism(spec.with_name("drum-feeder.toml"))).steps
    (ring,) = (step for step in feeder if "ring-1" in step.copies)
    assert {mate.how for mate in ring.mates} == {"glue"} and ring.apart == "drum beside the machine"
    knob, _, said = feeder[0].title.partition("Open these until")
    assert knob.startswith("Open the hole ") and knob.endswith("\n☐ 5.2 mm: the bore of knob\n"), (
        "the ring, wider over the shoulder, is glued on the core"
    )
    loose, _, stays = said.partition("These holes stay tight")
    on_shaft = "4 narrower bores of end-plate (2 ×), the bore of drum, the bore of spacer-below"
    assert on_shaft in loose, "all that goes on by hand"
    assert "bore of ring" in stays and "bore of carriage" in stays and "end-plate" not in stays
    assert "turn the crank once round" in feeder[-1].title
    assert [running_size(4.0, play) for play in (0.05, 0.1, 0.17, 0.2)] == [4.05, 4.1, 4.1, 4.2]


def test_what_is_cut_of_steel_is_a_step_of_its_own_before_all_others() -> None:
    """A walker's crank pins: round between their webs, a flat as long as each web is thick; a drum's rods; no print has one."""
    gallery = Path(__file__).parents[2] / "specs" / "gallery"
    walker, feeder, bar = (
        [step for step in steps_of_assembly(machine).steps if step.title.startswith("Cut and file")]
        for machine in (
            built("walker"),
            *(read_mechanism(gallery / f"{name}.toml") for name in ("drum-feeder", "four-bar")),
        )
    )
    webs = {built("walker").assembly.by_name[name].thickness for name in ("crank", "crank_web2")}
    assert webs == {3.0} and not bar
    (cut,) = walker
    assert "☐ 4 × crank-pin-1: rod 4 h9 x 15.2, a flat 0.667 deep and 3 long at either end" in (
        cut.title
    )
    assert [line.partition(":")[0] for line in feeder[0].title.splitlines()[1:]] == [
        "☐ 4 × rod",
        "☐ 1 × shaft",
        "☐ 1 × roller-pin",
    ]


def test_a_block_under_a_shaft_is_taken_away_after_the_last_that_is_glued_on_it() -> None:
    """Of a Geneva table that is the highest on each shaft: the locking disc, and the table."""
    spec = Path(__file__).parents[2] / "specs" / "gallery" / "geneva-table.toml"
    machine = read_mechanism(spec)
    steps = steps_of_assembly(machine).steps
    heights = {mount.part: mount.z for mount in machine.assembly.mounts}
    for shaft, parts in {
        "shaft": ("crank", "lock-crank_to_table"),
        "shaft-table": ("geneva-crank_to_table", "table"),
    }.items():
        (under,) = (step for step in steps if f"ut a block under {shaft}, " in step.title)
        (away,) = (
            step
            for step in steps
            if step.title.endswith(f"When the glue is hard, take the block out from under {shaft}.")
        )
        assert away.copies == [f"{max(parts, key=lambda part: heights[part])}-1"]
        assert steps.index(under) < steps.index(away)


def test_blocks_under_a_plate_are_as_high_as_what_hangs_below_it(leg: Mechanism) -> None:
    """The lowest underside of all its parts, under that of the plate. They lie there before the plate comes down, over its shaft."""
    made = leg.assembly
    low = min(mount.z for mount in made.mounts)
    (plate,) = (mount.z for mount in made.mounts if mount.part == "ground")
    blocks = f"Put two blocks at least {math.ceil(plate - low)} mm high on the bench for the plate"
    titles = [step.title for step in steps_of_assembly(leg).steps]
    (title,) = (title for title in titles if blocks in title)
    assert title.index(blocks) < title.index("Set the ground plate with O on shaft")


@pytest.mark.long
def test_a_cap_is_marked_by_its_joint() -> None:
    """A cap's own hole has no name; the letter at its glue is that of the joint, as engraved on the link next to it."""
    walker = load(Path(__file__).parents[2] / "specs/gallery/walker.toml")
    named = {name for part in walker.assembly.parts for name, _ in part.points}
    table = order_of_assembly(walker.assembly)
    caps = [
        (str(row[3]), mate)
        for row, step in zip(table.rows, table.steps, strict=True)
        for mate in step.mates
        if str(row[1]).startswith("cap-")
    ]
    assert len(caps) > 20
    for where, mate in caps:
        assert mate.label in named
        if " at " in where:
            assert f" at {mate.label} of " in where


def left_out(machine: Mechanism) -> list[str]:
    """Lines of what is bought in the list of parts, of which the steps put in another number than the list has."""
    table = steps_of_assembly(machine)
    cells = [" ".join(map(str, row)) for row in table.rows]
    coming = Counter(part_of(copy) for copy in {each for s in table.steps for each in s.copies})
    found = []
    for how, name, what, count, *_ in parts_table(machine).rows:
        if how != "bought" or name in SUPPLIES:
            continue
        size = re.split(", (?:ISO|DIN|EN|NEMA ICS) ", str(what))[0]
        put = coming[str(name)] if str(name) in machine.assembly.by_name else 0
        if not put and name == "glue":
            put = int(any(re.search(r"\bglued?\b", each) for each in cells))
        if not put:
            # with a part, or in its own step
            text = re.escape(f" × {name} ({size}")
            put = sum(int(n) for each in cells for n in re.findall(rf"(\d+){text}", each))
            own = [row for row in table.rows if row[1] == {"drive": "motor"}.get(name, name)]
            put = put or sum(int(row[-3]) if len(row) > 3 else 1 for row in own)
        if not put and str(name).startswith("extension spring"):
            put = sum(row[1] == "extension spring" for row in table.rows)
        if put != count:
            found.append(f"{name}: {put} of {count}")
    return found


@pytest.mark.long
@pytest.mark.parametrize("name", [*MACHINES, *BOUGHT])
def test_all_that_is_bought_is_put_in_by_some_step(name: str) -> None:
    assert not left_out(built(name))


def test_what_own_steps_put_in_comes_once() -> None:
    """The nozzle's screws are put in with the nozzle; what bears a drum of two pieces has steps after them."""
    titles = [step.title for step in steps_of_assembly(built("uniform-swing")).steps]
    assert sum("screw of the nozzle" in title for title in titles) == 1
    drum = [step.title for step in steps_of_assembly(built("cylinder-cam")).steps]
    assert [title.partition(", ")[0] for title in drum[-4:]] == [
        "Shaft",
        "4 × retaining ring of a bearing",
        "2 × bearing of the shaft",
        "Roller",
    ]


def test_a_step_that_forgets_what_is_bought_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a walker's sides one step without its screws, one without the motor, one with a pin less."""
    walker = built("walker")
    whole = steps_of_assembly(walker)
    (holder,) = (k for k, row in enumerate(whole.rows) if row[1] == "battery holder")
    (spacer,) = (k for k, row in enumerate(whole.rows) if row[1] == "side-spacer")
    (motor,) = (k for k, row in enumerate(whole.rows) if row[1] == "motor")
    damaged = {
        holder: ["battery holder: 0 of 1"],
        spacer: ["screw of a spacer: 4 of 8"],
        motor: ["drive: 0 of 1", "screw of the motor: 0 of 2", "nut of the motor: 0 of 2"],
    }
    for missing, said in damaged.items():
        rows = [row for k, row in enumerate(whole.rows) if k != missing]
        short = replace(whole, rows=rows)
        monkeypatch.setattr(MODULE, "steps_of_assembly", lambda _: short)  # noqa: B023
        assert left_out(walker) == said
    pin = next(copy for step in whole.steps for copy in step.copies if part_of(copy) == "pin-5")
    steps = [
        replace(step, copies=[copy for copy in step.copies if copy != pin]) for step in whole.steps
    ]
    monkeypatch.setattr(MODULE, "steps_of_assembly", lambda _: replace(whole, steps=steps))
    assert left_out(walker) == ["pin-5: 19 of 20"]


@pytest.mark.long
@pytest.mark.parametrize("name", MACHINES)
def test_a_step_says_what_is_done_and_none_says_what_the_last_one_did(name: str) -> None:
    titles = [step.title for step in steps_of_assembly(built(name)).steps]
    assert not vague(titles)


def vague(titles: list[str]) -> list[str]:
    """Steps that leave something loose without what it is on or the number of a later step that holds it, that repeat the last
    one, or that are no sentences."""
    found = [title for last, title in itertools.pairwise(titles) if last == title]
    for number, title in enumerate(titles, 1):
        until = re.findall(r"\bloose until ([^.]*)", title)
        steps = [[int(each) for each in re.findall(r"step (\d+)", said)] for said in until]
        later = all(each and number < min(each) and max(each) <= len(titles) for each in steps)
        bare = re.search(r"\bloose(ly)?\b(?! until \S| on \S)", title)
        whole = re.fullmatch(r"[^a-z].*\.", title, re.DOTALL) and not re.search("[{}]", title)
        found += [title] if bare or not later or not whole else []
    return found


def test_a_vague_step_is_found() -> None:
    good = [
        "Stand pin upright; loose until cap is glued on it in step 2.",
        "Put cap loosely on pin.",
    ]
    assert not vague(good)
    bad = [
        "Put pin in place; loose; a later step fixes it.",
        "Put the ring loosely.",
        "Stand pin upright; loose until cap is glued on it.",
        "Stand pin upright; loose until cap is glued on it in step 1.",
        "Stand pin upright; loose until cap is glued on it in step 3.",
        "put the ring on pin.",
        "Put {what} on pin.",
    ]
    for title in bad:
        assert vague([good[0], title]) == [title]
    assert vague([good[0], good[0]])[0] == good[0]


def test_screws_are_where_their_posts_and_plates_are() -> None:
    """Of a walker on the axes of its posts, heads in the outer plate of either side, ends in the spacers; of a bird from behind."""
    walker = built("walker")
    steps = steps_of_assembly(walker).steps
    feet = {complex(each.at) for each in walker.assembly.mounts if each.part == "post"}
    levels = {each.part: each.z for each in walker.assembly.mounts}
    spacer = levels["side-spacer"] + walker.assembly.by_name["side-spacer"].thickness / 2
    (near,) = (each for each in steps if "side-spacer-1" in each.copies)
    for step, part in ((near, "ground"), (steps[-2], "far-ground")):
        middles = [sum(corners) / len(corners) for corners, *_ in step.screws]
        assert len(step.screws) == 8, "a shank and a head each"
        assert all(min(abs(foot - at) for foot in feet) < 1e-6 for at in middles)
        shanks = [prism for prism in step.screws if prism[2] - prism[1] > 40]
        low = levels[part]
        assert len(shanks) == 4
        tall = [end - foot for _, foot, end in step.screws if end - foot < 40]
        assert tall == pytest.approx([3.0] * 4), "a head of ISO 4762 is as high as its thread"
        for _, foot, end in shanks:
            head, point = sorted((foot, end), key=lambda z: abs(z - spacer))[::-1]
            assert low < head < low + walker.assembly.by_name[part].thickness
            assert abs(point - spacer) < walker.assembly.by_name["side-spacer"].thickness / 2
    (motor,) = (each for each in steps if "screw it on now" in each.title)
    assert len(motor.screws) == 4 and motor.threads == [("M2", 10.0)]
    bird = steps_of_assembly(built("flapping-bird")).steps
    (screwed,) = (each for each in bird if each.screws)
    assert "Screw in 2 ×" in screwed.title and len(screwed.screws) == 4
    assert "from below, through the panel into the 2.5 mm holes of the plate" in screwed.title


def test_a_machine_on_a_stand_lies_on_its_panel_and_is_screwed_on_before_its_pins() -> None:
    """Blocks come with the panel, as high as the hand crank's knob reaches under it, the screws with the plate; links are borne."""
    bird = built("flapping-bird")
    titles = [step.title for step in steps_of_assembly(bird).steps]
    levels = {each.part: each.z for each in bird.assembly.mounts}
    low = min(z for part, z in levels.items() if not part.startswith("stand"))
    deep = math.ceil(levels["stand-panel"] - low)
    blocks = f"put two blocks at least {deep} mm high on the bench for the panel of the stand, outside of the circle of the hand crank"
    (panel,) = (k for k, title in enumerate(titles) if blocks in title)
    assert "two blocks" not in "".join(titles[:panel] + titles[panel + 1 :])
    (screwed,) = (k for k, title in enumerate(titles) if "screw of the plate" in title)
    both = titles[screwed]
    assert screwed == panel, "no one screws from below where the shaft falls out"
    assert both.startswith("Set the ground plate on the panel of the stand, hole over hole. Screw")
    assert (
        both.index("Screw in")
        < both.index(blocks)
        < both.index("Put both over shaft, the panel below")
    ), "the panel comes down on them"
    step = steps_of_assembly(bird).steps[screwed]
    assert {*step.copies} == {"stand-panel-1", "ground-1"} and len(step.screws) == 4
    assert any(mate.label == "O" and not mate.within for mate in step.mates), "on the shaft"
    pressed = [title for title in titles if "from above" in title]
    assert len(pressed) == 3 and all("it must not bend" in each for each in pressed)
    assert "Put a block under stand-panel below W and V of ground" in pressed[0], "as it lies there"
    assert all(each.startswith("Put a block under") for each in pressed), "before it is glued"
    assert pressed[-1].startswith("Put a block under stand-panel below R of right_wing, "), (
        "the hand crank sweeps A"
    )
    upright = [title for title in titles if "Check with a square that shaft is square" in title]
    assert len(upright) == 1 and not any(" dry, with" in title for title in titles)


def test_blocks_reach_from_the_bench_to_what_they_bear() -> None:
    """By the heights of the mounts: the blocks under the panel are as high as what hangs below it, and shaft and links stand as much
    higher than the panel's underside. What lies on the plate is borne by a block under that."""
    bird = built("flapping-bird")
    levels = {each.part: each.z for each in bird.assembly.mounts}
    panel = levels["stand-panel"]
    deep = math.ceil(panel - min(z for part, z in levels.items() if not part.startswith("stand")))
    titles = [step.title for step in steps_of_assembly(bird).steps]
    under = f"where those under stand-panel are {deep} mm high"
    high = levels["shaft"] - panel + deep
    assert any(f"a block under shaft, {high:g} mm high, {under}: it must not" in t for t in titles)
    (borne,) = (k for k, t in enumerate(titles) if "a block under shaft" in t)
    assert "put two blocks" in titles[borne], "from then on nothing else bears it"
    over = max(
        levels[part] + each.thickness
        for part, each in bird.assembly.by_name.items()
        if not part.startswith("stand")
    )
    over = max(over, 16.38)  # the front of the foot, by its drawing
    front = math.ceil(over - panel - bird.assembly.by_name["stand-panel"].thickness)
    (gussets,) = (t for t in titles if "gusset" in t and "Glue 2" in t)
    assert (
        gussets.startswith("Turn the machine over, its back up")
        and f"least {front} mm" in gussets
        and gussets.index("Try each tab in its slot, dry") < gussets.index("Glue 2")
    )
    (layer,) = bird.assembly.by_name["stand-panel"].layers
    outer, *inner = (
        coordinates(facet_contour(each, 0.1)) for each in (layer.region.outer, *layer.region.holes)
    )
    sheet = shapely.Polygon(outer, inner)
    shoulders = bird.assembly.by_name["ground"].points
    for at in (z for name, z in shoulders if name in ("W", "V")):
        around = shapely.Point(at.real, at.imag).buffer(5 / 2 + 1)
        assert not sheet.disjoint(around), "a block as high as the ground plate stands in the panel"
        assert not sheet.contains(around), "as its window would let through in part"
    flush = "as high as those under stand-panel: it must not bend"
    for each in ("W and V of ground", "L of left_wing", "R of right_wing"):
        assert any(f"under stand-panel below {each}, {flush}" in title for title in titles)
    leg = built("walking-leg")
    titles = [step.title for step in steps_of_assembly(leg).steps]
    assert any("stand shaft on the bench, where blocks under ground are 15" in t for t in titles)
    take_up = built("thread-take-up")
    levels = {each.part: each.z for each in take_up.assembly.mounts}
    (lifted,) = (
        t for t in (s.title for s in steps_of_assembly(take_up).steps) if "B of output," in t
    )
    assert f"a block under B of output, {levels['output'] + 12:g} mm high" in lifted
    assert "where those under ground are 12 mm high" in lifted


def test_a_gauge_lies_where_it_comes_out_again() -> None:
    """The bird's collar is in the panel's hole: paper goes under the crank instead, as thick as all play of the shaft."""
    bird = built("flapping-bird")
    made = bird.assembly
    levels = {each.part: each.z for each in made.mounts}
    top = {part: z + made.by_name[part].thickness for part, z in levels.items()}
    assert levels["stand-panel"] < top["collar"] < levels["ground"] == top["stand-panel"]
    play = levels["crank"] - top["ground"] + levels["ground"] - top["collar"]
    (said,) = (step.title for step in steps_of_assembly(bird).steps if "it on shaft" in step.title)
    gauge = thickness_gauge(play)
    assert gauge == "four sheets of paper" and gauge in said and "under ground" not in said
    assert said.startswith("When the glue of crank is hard, lift crank and lay")
    panel = made.by_name["stand-panel"]
    proud = levels["stand-panel"] - levels["collar"]
    assert panel.thickness == 3 and proud == pytest.approx(0.2), "nothing to grip"
    taped = said.index("Stick a strip of adhesive tape under the shaft collar, beside shaft")
    lifted = said.index("Push it up to ground with a thin stick, and hold it there")
    assert taped < lifted and "down over the drop by its tape" in said
    assert "glued into crank, the hand crank and the collar" in made.by_name["shaft"].notes
    glued = "Put a drop of superglue gel on shaft just under it, none over it: "
    assert lifted < said.index(glued) < said.index("Push the shaft collar up again"), (
        "it has dropped on the hand crank, and what is over it goes to the ground plate as it is pushed up"
    )
    assert "glue it on shaft alone, and hold it there until the glue is hard" in said
    assert f"Pull {gauge} out from under crank" in said
    assert f"{play:.2g} mm of play" in said
    leg = built("walking-leg")  # nothing is round its collar
    (said,) = (step.title for step in steps_of_assembly(leg).steps if "it on shaft" in step.title)
    assert (
        said.startswith("When the glue of crank is hard, push the shaft collar up")
        and "mm under ground (a strip" in said
    )


def test_a_stand_s_parts_come_from_where_they_go_and_show_their_glue() -> None:
    """Gussets from behind the panel, the foot from below, which is the machine's own down; each mark lies in a slot of the panel or at its tab."""
    bird = built("flapping-bird")
    support = bird.assembly.support
    assert support is not None
    gussets, foot = (
        next(each for each in steps_of_assembly(bird).steps if f"{name}-1" in each.copies)
        for name in ("stand-gusset", "stand-foot")
    )
    assert gussets.along == (0.0, 0.0, 1.0) and foot.along is not None
    assert np.allclose(foot.along, np.negative(support.down))
    panel = bird.assembly.by_name["stand-panel"]
    (mount,) = (each for each in bird.assembly.mounts if each.part == "stand-panel")
    rings = [facet_contour(hole, 0.05) for hole in panel.region.holes]
    slots = [shapely.Polygon(np.c_[ring.real, ring.imag]) for ring in rings]
    assert [mate.how for mate in (*gussets.mates, *foot.mates)] == ["glue"] * 6
    for mate in gussets.mates:
        own = (complex(*mate.place[:2]) - mount.at) * cmath.exp(-1j * mount.angle)
        assert any(slot.contains(shapely.Point(own.real, own.imag)) for slot in slots)
        assert mount.z < mate.place[2] < mount.z + panel.thickness
    solid_foot = next(each for each in bird.assembly.mounts if each.part == "stand-foot")
    down = complex(*support.down[:2])
    depths = [(complex(*mate.place[:2]) - solid_foot.at) * down.conjugate() for mate in foot.mates]
    assert all(0 < depth.real < panel.thickness for depth in depths)
