"""Pins in slots, of the ground and of links that move: where the slots lie, on which plate; and that no small machine of slots
and slides ends in anything but parts or words."""

from __future__ import annotations

import copy
import re
import tomllib
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
import tomli_w
from hypothesis import given, settings
from hypothesis import strategies as st
from judged import wrong

from camgen import load, starters
from camgen.errors import DesignError, SpecError
from camgen.geometry.facets import facet_contour
from camgen.machine.features import SlotFaces
from camgen.machines.linkage.mechanism import Linkage
from camgen.parts.assembly import order_of_assembly
from camgen.pipeline.build import build
from camgen.spec import validate

CROSSED = {  # two rods on one crank, whose other pins run in slots that cross at (60, 0), never there at one time
    "mechanism": "linkage",
    "name": "own",
    "drive": {"link": "crank"},
    "points": {
        "O": [0, 0],
        "A": [15, 0],
        "P": [75, 0],
        "Q": [70, 5.77],
        "U": [40, 0],
        "V": [80, 0],
        "W": [34, -15],
        "Z": [86, 15],
    },
    "links": {
        "ground": ["O", "U", "V", "W", "Z"],
        "crank": ["O", "A"],
        "rod": ["A", "P"],
        "other": ["A", "Q"],
    },
    "slot": [
        {"pin": "P", "link": "ground", "along": ["U", "V"]},
        {"pin": "Q", "link": "ground", "along": ["W", "Z"]},
    ],
    "output": [{"name": "out", "point": "P"}],
}
SLIDER = {  # a slider-crank whose slider is a pin in the ground
    "mechanism": "linkage",
    "name": "own",
    "drive": {"link": "crank"},
    "points": {"O": [0, 0], "A": [15, 0], "P": [75, 0], "U": [40, 0], "V": [80, 0]},
    "links": {"ground": ["O", "U", "V"], "crank": ["O", "A"], "rod": ["A", "P"]},
    "slot": [{"pin": "P", "link": "ground", "along": ["U", "V"]}],
    "output": [{"name": "out", "point": "P"}],
}


def linkage(tables: dict[str, Any], **parts: Any) -> Linkage:
    return validate(Linkage, {**tables, "parts": {**tables.get("parts", {}), **parts}})


def slots_of(machine: Linkage, part: str) -> list[tuple[float, float, complex]]:
    """Length and width along x and y, and the middle, of the holes of a part that are not round."""
    holes = (
        next(each for each in machine.assembly.parts if each.name == part).layers[-1].region.holes
    )
    rings = [facet_contour(hole, 1e-6) for hole in holes]
    boxes = [
        (
            float(np.ptp(z.real)),
            float(np.ptp(z.imag)),
            complex(z.real.min() + z.real.max(), z.imag.min() + z.imag.max()) / 2,
        )
        for z in rings
    ]
    return [box for box in boxes if abs(box[0] - box[1]) > 0.1]


def test_a_slot_in_the_ground_is_as_long_as_its_pins_way() -> None:
    """P goes from 60 - 15 to 60 + 15; half a millimetre of room at both ends, the pin 5 and its play 0.2."""
    ((long, wide, middle),) = slots_of(linkage(SLIDER), "ground")
    assert (long, wide) == (
        pytest.approx(30 + 2 * 0.5 + 5.2, abs=1e-3),
        pytest.approx(5.2, abs=1e-4),
    )
    assert middle == pytest.approx(60, abs=1e-3)


def test_its_pin_ends_inside_the_plate_and_is_fixed_in_what_lies_next_to_it() -> None:
    """On one plate in the lowest link, so that nothing rubs under it; in the second plate in the highest."""
    for parts, plate, sign in (({}, "ground", 1), ({"plates": 2}, "second-plate", -1)):
        machine = linkage(SLIDER if not parts else CROSSED, **parts)
        heights = {part.name: part.thickness for part in machine.assembly.parts}
        faces = next(
            each
            for each in machine.assembly.features
            if isinstance(each, SlotFaces) and each.walls.part == plate
        )
        runner = machine.model.joint(faces.joint).runner  # type: ignore[union-attr]
        (pin,) = (
            mount
            for mount in machine.assembly.mounts
            if mount.part == faces.pin.part  # type: ignore[union-attr]
            and mount.body == runner.body
            and abs(mount.at - runner.at) < 1e-9
        )
        (board,) = (mount for mount in machine.assembly.mounts if mount.part == plate)
        low, high = pin.z, pin.z + heights[pin.part]
        outer = board.z if sign > 0 else board.z + heights[plate]
        inner = board.z + heights[plate] if sign > 0 else board.z
        end = low if sign > 0 else high
        assert sign * (end - outer) == pytest.approx(0.2) and sign * (inner - end) > 0


def test_two_pins_on_one_line_whose_ways_meet_run_in_one_slot() -> None:
    tables = tomllib.loads(starters.text("scotch-yoke"))
    tables["points"] |= {"P": [30, 0], "Q": [60, 0], "L1": [-1, 0], "L2": [31, 0]}
    tables["links"]["yoke"] = ["E", "P", "Q", "F"]
    tables["points"] |= {"O": [-40, 0], "A": [-25, 0], "E": [-25, -18], "F": [-25, 18]}
    tables["output"] = [{"name": "end", "point": "Q"}]
    ((long, wide, middle),) = slots_of(linkage(tables), "ground")
    assert long == pytest.approx(30 + 30 + 2 * 0.5 + 5.2, abs=1e-3) and wide == pytest.approx(
        5.2, abs=1e-4
    )
    assert middle == pytest.approx(
        complex((0 + 60) / 2), abs=1e-3
    )  # P from 0 to 30, Q from 30 to 60


def test_slots_that_cross_lie_in_two_plates() -> None:
    """In one plate no wall would guide a pin at the crossing: refused, and what is told mends."""
    with pytest.raises(
        DesignError, match="slot of pin P and slot of pin Q.*mended by parts.plates = 2"
    ):
        _ = linkage(CROSSED).assembly
    machine = linkage(CROSSED, plates=2)
    assert len(slots_of(machine, "ground")) == len(slots_of(machine, "second-plate")) == 1


def test_a_slot_through_the_hole_of_a_motor_is_refused_or_in_the_other_plate() -> None:
    """Its boss is 22 mm, the slot begins 15 mm less 1 less half its width from the shaft's axis."""
    near = {**SLIDER, "points": {**SLIDER["points"], "P": [45, 0], "U": [10, 0], "V": [50, 0]}}
    motor = {"motor": "nema-17", "base_thickness": 6}
    with pytest.raises(DesignError, match="slot of pin P and hole for the motor"):
        _ = linkage(near, **motor).assembly
    far = linkage(near, **motor, plates=2)
    assert not slots_of(far, "ground") and slots_of(far, "second-plate")


@pytest.mark.long
def test_a_slot_of_the_ground_that_lies_aside_is_found(tmp_path: Path) -> None:
    """In the drawing, by 0.05 mm across: P does so too."""
    (tmp_path / "own.toml").write_text(tomli_w.dumps(SLIDER), encoding="utf-8")
    assert build(tmp_path / "own.toml", tmp_path, frozenset({"dxf"})).ok
    path = tmp_path / "own" / "own-ground.dxf"
    drawing = ezdxf.readfile(path)
    (slot,) = (
        each
        for each in drawing.modelspace().query("LWPOLYLINE")
        if 34 < np.ptp([x for x, *_ in each.get_points()]) < 38
    )
    slot.set_points([(x, y + 0.05, *rest) for x, y, *rest in slot.get_points()])
    drawing.saveas(path)
    found = {finding.code: finding for finding in wrong(tmp_path / "own", "dxf")}
    assert "ROUND_TRIP" in found and found["MOTION_ERROR"].measured == pytest.approx(0.05, rel=0.1)


# ---- any small machine of slots and slides ---------------------------------------------------------------------------

PARTS = st.fixed_dictionaries(
    {},
    optional={
        "plates": st.just(2),
        "shaft": st.just("interrupted"),
        "pin": st.sampled_from(["dowel", "shoulder"]),
        "cover": st.just(False),
        "hand_crank": st.just(20.0),
    },
)


class Sketch:
    """A crank, and what is hung on it one by one; `ends`: points on which more can be hung."""

    def __init__(self, radius: float) -> None:
        self.points: dict[str, list[float]] = {"O": [0, 0], "A": [radius, 0]}
        self.links: dict[str, list[str]] = {"ground": ["O"], "crank": ["O", "A"]}
        self.slots: list[dict[str, Any]] = []
        self.slides: list[dict[str, Any]] = []
        self.ends = ["A"]

    def point(self, name: str, x: float, y: float, *links: str) -> str:
        name += str(len(self.points))
        self.points[name] = [round(x, 1), round(y, 1)]
        for link in links:
            self.links.setdefault(link, []).append(name)
        return name

    def link(self, *points: str) -> str:
        name = f"l{len(self.links)}"
        self.links[name] = list(points)
        return name

    def hang(self, kind: str, end: str, far: float, aside: float) -> None:
        x, y = self.points[end]
        match kind:
            case "pin in the ground":
                pin = self.point("P", x + far, y + aside / 3)
                self.link(end, pin)
                low, high = (
                    self.point("U", x + far + side * 40, y + aside / 3, "ground")
                    for side in (-1, 1)
                )
                line = low, high
                self.slots.append({"pin": pin, "link": "ground", "along": line})
                self.ends.append(pin)
            case "slotted arm" | "block on an arm":
                hinge, tip = (
                    self.point("D", x + aside, y - far, "ground"),
                    self.point("F", x - aside + 0.5, y + far),
                )
                arm, line = self.link(hinge, tip), (hinge, tip)
                if kind == "slotted arm":
                    self.slots.append({"pin": end, "link": arm, "along": line})
                else:
                    self.slides.append({"link": self.link(end), "on": arm, "along": line})
                self.ends.append(tip)
            case "slotted coupler":
                pin, tip = (
                    self.point("D", x + far, y + aside, "ground"),
                    self.point("F", x + 2 * far + 0.5, y + 2 * aside),
                )
                self.slots.append({"pin": pin, "link": self.link(end, tip), "along": (end, tip)})
                self.ends.append(tip)
            case "slotted crank":
                tip, hinge = (
                    self.point("H", 0, -far, "crank"),
                    self.point("D", aside / 5, aside / 5 + 2, "ground"),
                )
                pin = self.point("Q", 0, -far / 2)
                self.link(hinge, pin)
                self.slots.append({"pin": pin, "link": "crank", "along": ("O", tip)})
            case "yoke":
                low, high, out = (
                    self.point("E", x, y - 30),
                    self.point("E", x, y + 30),
                    self.point("P", x + far, y),
                )
                back = self.point("P", x - far - aside, y)
                yoke = self.link(low, out, high, back)
                line = self.point("U", x - 90, y, "ground"), self.point("V", x + 90, y, "ground")
                self.slots.append({"pin": end, "link": yoke, "along": (low, high)})
                self.slots += [{"pin": pin, "link": "ground", "along": line} for pin in (out, back)]
                self.ends.append(out)
            case _:
                pin = self.point("P", x + far, y + aside / 3)
                self.link(end, pin)
                line = (
                    self.point("U", x + far, y + aside / 3, "ground"),
                    self.point("V", x + far + 30, y + aside / 3, "ground"),
                )
                self.slides.append({"link": self.link(pin), "along": line})
                self.ends.append(pin)

    def tables(self, parts: dict[str, Any], swing: tuple[float, float] | None) -> dict[str, Any]:
        drive = {"link": "crank"} if swing is None else {"link": "crank", "range_deg": swing}
        return {
            "mechanism": "linkage",
            "name": "own",
            "points": self.points,
            "links": self.links,
            "slot": self.slots,
            "slide": self.slides,
            "drive": drive,
            "parts": parts,
            "output": [{"name": "out", "point": self.ends[-1]}],
            "limits": {"transmission_angle_deg": 1},
        }


@st.composite
def small_machines(draw: st.DrawFn) -> dict[str, Any]:
    sketch = Sketch(draw(st.sampled_from([8.0, 15.0, 25.0])))
    kinds = [
        "pin in the ground",
        "slotted arm",
        "block on an arm",
        "slotted coupler",
        "slotted crank",
        "yoke",
        "slide",
    ]
    for kind in draw(st.lists(st.sampled_from(kinds), min_size=1, max_size=2)):
        sketch.hang(
            kind,
            draw(st.sampled_from(sketch.ends)),
            draw(st.sampled_from([35.0, 50.0, 70.0])),
            draw(st.sampled_from([-25.0, 0.0, 10.0])),
        )
    return sketch.tables(draw(PARTS), draw(st.sampled_from([None, (-10.0, 12.0)])))


def with_change(tables: dict[str, Any], words: str) -> dict[str, Any]:
    """The tables with what a refusal says in the words that a person types: keys of [parts] and their values."""
    found = copy.deepcopy(tables)
    if "leaving [layers] out" in words:
        found.pop("layers", None)
    for path, value in re.findall(r"parts\.([\w.]+) = ([^ ,;]+)", words):
        *tables_of, last = path.split(".")
        table = found.setdefault("parts", {})
        for name in tables_of:
            table = table.setdefault(name, {})
        table[last] = tomllib.loads(f"value = {value}")["value"]
    return found


def mends(error: DesignError) -> list[str]:
    """What a refusal says to mend it, each in words."""
    said = re.match(r"mended by (.*?)(?:; else .*)?$", error.remedy)
    return [] if said is None else said[1].split(", or by ")


@pytest.mark.long
@settings(max_examples=12)
@given(small_machines())
def test_every_small_machine_of_slots_and_slides_has_parts_or_is_refused_in_words(
    tables: dict[str, Any],
) -> None:
    """Nothing else is raised; and what is said to mend it does."""
    try:
        machine = load(tables)
        assert isinstance(machine, Linkage)
        assert (
            machine.assembly.parts
            and machine.assembly.mounts
            and machine.assembly.features
            and order_of_assembly(machine.assembly).rows
        )
        machine.forecast()
        machine.study()
    except SpecError as error:
        assert error.faults
    except DesignError as error:
        for words in mends(error):
            assert load(with_change(tables, words)).assembly.parts, words


@pytest.mark.parametrize("kind", ["slotted arm", "slotted coupler"])
def test_a_slot_on_a_crank_pin_lies_between_webs(kind: str) -> None:
    """Of a shaft that is interrupted: what runs on a throw lies over its lower web."""
    sketch = Sketch(15.0)
    sketch.hang(kind, "A", 50.0, 10.0)
    level = linkage(sketch.tables({"shaft": "interrupted"}, (-10.0, 12.0))).bodies.layout.level
    assert level["l2"] > level["crank"]


def test_a_slot_in_a_web_lies_over_the_link_of_its_pin() -> None:
    """Q runs in the crank, whose shaft is interrupted and whose crank pin carries a rod: with play, and no flat."""
    tables = copy.deepcopy(SLIDER)
    tables["points"] |= {"H": [0, -32.5], "D": [-9.6, 4.3], "Q": [0, -19.5]}
    tables["links"] |= {"ground": ["O", "U", "V", "D"], "crank": ["O", "A", "H"], "arm": ["D", "Q"]}
    tables["slot"] = [*tables["slot"], {"pin": "Q", "link": "crank", "along": ["O", "H"]}]
    machine = linkage(
        {**tables, "drive": {"link": "crank", "range_deg": [-10, 2]}}, shaft="interrupted"
    )
    level = machine.bodies.layout.level
    assert level["crank"] > level["arm"] and level["rod"] > level["crank"]
    assert machine.bodies.layout.hole("Q", "crank") == pytest.approx(5.2)


DISC = {  # a disc with two slots square to each other on two pins of the ground; K decides how far it goes
    "mechanism": "linkage",
    "name": "own",
    "points": {
        "G": [-100, 0],
        "K": [-90, 0],
        "A": [20, 0],
        "B": [0, 15],
        "C": [40, 0],
        "X1": [-35, 0],
        "X2": [35, 0],
        "Y1": [0, -30],
        "Y2": [0, 30],
    },
    "links": {
        "ground": ["G", "A", "B"],
        "crank": ["G", "K"],
        "rod": ["K", "C"],
        "disc": ["C", "X1", "X2", "Y1", "Y2"],
    },
    "drive": {"link": "crank"},
    "slot": [
        {"pin": "A", "link": "disc", "along": ["X1", "X2"]},
        {"pin": "B", "link": "disc", "along": ["Y1", "Y2"]},
    ],
    "output": [{"name": "out", "point": "C"}],
    "limits": {"transmission_angle_deg": 1},
}


def test_slots_of_a_link_may_cross_in_line_but_not_where_their_pins_go() -> None:
    """The points of `along` lie on lines that cross in both machines; the pins of the second one go further."""
    assert len(slots_of(linkage(DISC), "disc")) == 2
    further = {**DISC, "points": {**DISC["points"], "K": [-70, 0]}}
    with pytest.raises(DesignError, match="wall of the link disc.*between slot A and slot B"):
        assert linkage(further).assembly.parts


@pytest.mark.parametrize("apart", [0.0, 1e-300, 1e-13, 9e-10])
@pytest.mark.parametrize("kind", ["slot", "slide"])
def test_two_points_at_one_place_are_no_line(kind: str, apart: float) -> None:
    """Nearer than points of a drawing can be told apart; a slot along them stood upright, whichever way it was drawn."""
    slider = {"link": "slider", "along": ["U", "V"]}
    tables: dict[str, Any] = copy.deepcopy(SLIDER)
    if kind == "slide":
        del tables["slot"]
        tables |= {"slide": [slider], "links": tables["links"] | {"slider": ["P"]}}
    tables["points"] |= {"V": [tables["points"]["U"][0], tables["points"]["U"][1] + apart]}
    with pytest.raises(SpecError) as caught:
        validate(Linkage, tables)
    (said,) = map(str, caught.value.faults)
    expected = f"two points that lie apart: its length is {apart:.3g} mm"
    assert said.endswith(f"expected {expected}") and said.startswith(f"{kind}.0.along: U, V")


def test_points_of_a_link_at_one_place_but_for_rounding_are_told() -> None:
    tables = copy.deepcopy(SLIDER) | {"lengths": {"O-A": 15}}
    tables["points"]["A"] = [0, 1e-13]
    with pytest.raises(SpecError, match="O and A are drawn at one place"):
        validate(Linkage, tables)
