"""The written assembly of every machine, swept: free as designed, and a part 1 mm out of its place is named."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from camgen.files.threemf import PartCopy, read_3mf, write_3mf
from camgen.findings import Finding
from camgen.geometry.mesh import Mesh, placing
from camgen.geometry.rings import Floats
from camgen.judge.assembly import _slabs, _touching, sweep
from camgen.machine.features import (
    CamOutline,
    Eye,
    Faces,
    Feature,
    GearTeeth,
    OwnTip,
    Passing,
    PinEyes,
    SlideFaces,
    StandIn,
    Steady,
    SweptMachine,
    Teeth,
)
from camgen.machine.features import Ring as FeatureRing
from camgen.machine.model import Pose
from camgen.machines.mechanism import Mechanism
from camgen.parts.assembly import bodies_in_motion, heads_in_motion
from camgen.parts.solids import solid
from camgen.pipeline import build as pipeline

# The stitch whose needles slide along the spreaders.
SLIDING = (
    "geometry.plate_to_spreader=7",
    "geometry.velocity_ratio=0.9142857",
    "geometry.blade_length=34",
    "geometry.p6_setback=0",
    "limits.clearance=0",
)
SPECS = Path(__file__).resolve().parents[2] / "specs"


@cache
def machine(name: str, *settings: str) -> Mechanism:
    return pipeline.read_mechanism(
        SPECS / f"{name}.toml", ["accuracy.chord_tolerance=0.005", *settings]
    )


@cache
def solids(name: str, *settings: str) -> Mapping[str, Mesh]:
    found = machine(name, *settings)
    return {part.name: solid(part, found.accuracy.chord_tolerance) for part in found.assembly.parts}


def swept(path: Path, name: str, *settings: str, **shifts: complex) -> list[Finding]:
    """Findings of a machine's assembly in which copies are shifted, mm."""
    found, items = machine(name, *settings), []
    start = found.assembly.poses(np.zeros(1))
    for part in found.assembly.parts:
        for k, pose in enumerate(start[part.name]):
            copy = f"{part.name}-{k + 1}"
            at = complex(pose.place[0]) + shifts.get(copy.replace("-", "_"), 0j)
            items.append(
                PartCopy(
                    part.name,
                    copy,
                    placing(float(pose.angle[0]), at, pose.z, part.thickness, pose.flipped),
                )
            )
    write_3mf(path, dict(solids(name, *settings)), items, "key")
    return sweep(path, bodies_in_motion(found.assembly))[0]


@pytest.mark.long
@pytest.mark.parametrize(
    "name",
    sorted(
        {path.stem for path in SPECS.glob("*.toml")}
        - {
            "uniform-swing",
            "four-leg-walker",
            "cylinder-cam",
            "linear-cam",
        }  # the last two are one body
    ),
)
def test_free_as_designed(tmp_path: Path, name: str) -> None:
    coarse = (
        ("accuracy.chord_tolerance=0.02",) if name == "stitch-head" else ()
    )  # a tenth of its joints' air
    findings = swept(tmp_path / "x.3mf", name, *coarse)
    assert [f"{f.code} {f.where}" for f in findings if not f.ok] == []
    assert "INTERFERENCE" in {f.code for f in findings}


@pytest.mark.long
@pytest.mark.parametrize(
    "name, shifted, by, pair",
    [
        ("thread-take-up", "thread_post_1_1", -1, "coupler-1 and thread-post-1-1"),
        ("thread-take-up", "output_1", 1j, "output-1 and pivot-C-1"),
        (
            "thread-take-up",
            "dowel_2",
            1,
            "ground-1 and dowel-2",
        ),  # fixed: it never moves as the plate sees it
        ("eccentric-drive", "rod_1", 1, "disc-1 and rod-1"),
        ("eccentric-drive", "slider_1", 1j, "ground-1 and slider-1"),
        ("chain-stitch-looper", "lower_spreader_1", 1j, "lower-spreader-1 and upper-spreader-1"),
        ("chain-stitch-looper", "upper_spreader_1", -1, "upper-spreader-1 and needle-2-1"),
        ("chain-stitch-looper", "needle_1_1", 1, "needle-1-1 and needle-plate-1"),
        ("disc-cam", "cam_1", -1, "cam-1 and tip on cam-1"),
        ("indexing-cam", "return_cam_1", 1, "return-cam-1 and tip on return-cam-1"),
    ],
)
def test_a_part_out_of_its_place_is_named(
    tmp_path: Path, name: str, shifted: str, by: complex, pair: str
) -> None:
    close = SLIDING if name == "chain-stitch-looper" else ()
    failed = [f for f in swept(tmp_path / "x.3mf", name, *close, **{shifted: by}) if not f.ok]
    assert {f.code for f in failed} == {"INTERFERENCE"}
    angle = "cam angle" if "cam" in name else "crank angle"
    assert any(str(f.where).startswith(f"{pair}: ") and angle in str(f.where) for f in failed), [
        str(f.where) for f in failed
    ]


def test_the_head_of_a_screw_is_in_the_way_of_what_passes_over_it(tmp_path: Path) -> None:
    """A motor's screws on a square of 31 mm [NEMA ICS 16]: a crank of 20 mm passes 0.4 mm over their heads, and hits one that stands out
    by 0.5 mm."""
    path = tmp_path / "x.3mf"
    settings = "parts.motor=nema-17", "motor.model=17HS19-2004S1", "parts.hand_crank=0"
    assert all(finding.ok for finding in swept(path, "linkage", *settings))
    whole = heads_in_motion(machine("linkage", *settings).assembly)
    heads = [each for each in whole.stand_ins if each.name.startswith("screw-head")]
    assert {
        complex(round(z.real, 9), round(z.imag, 9)) for each in heads for z, *_ in each.discs
    } == {complex(x, y) for x in (-15.5, 15.5) for y in (-15.5, 15.5)}
    assert all(finding.ok for finding in sweep(path, whole)[0])

    def raised(thing: StandIn) -> StandIn:
        ((at, radius, low, high),) = thing.discs
        return replace(thing, discs=((at, radius, low + 0.5, high + 0.5),))

    proud = [raised(each) if each in heads else each for each in whole.stand_ins]
    failed = [f for f in sweep(path, replace(whole, stand_ins=proud))[0] if not f.ok]
    assert {f.code for f in failed} == {"INTERFERENCE"}
    named = {str(f.where).partition(":")[0] for f in failed}
    assert named == {
        f"{part} and screw-head-{k}" for part in ("crank-1", "pin-2-1") for k in range(1, 5)
    }, "with the pin in the crank, which ends flush with its underside"


def test_a_body_that_is_flat_is_named(tmp_path: Path) -> None:
    """It meets nothing, so that it would count as clear of all."""
    path, whole = tmp_path / "x.3mf", machine("eccentric-drive")
    swept(path, "eccentric-drive")
    package = read_3mf(path)
    items = [
        PartCopy(item.name, f"{item.name}-{k}", item.transform)
        for k, item in enumerate(package.items)
    ]
    meshes = {
        name: mesh.moved(np.diag([1.0, 1, name != "rod", 0])[:3])
        for name, mesh in package.meshes.items()
    }
    write_3mf(path, meshes, items, "key")
    failed = [f for f in sweep(path, bodies_in_motion(whole.assembly))[0] if not f.ok]
    assert [(f.code, f.message) for f in failed] == [
        ("INTERFERENCE", "cannot be judged: rod-1 has no volume")
    ]


@pytest.mark.long
def test_fits_without_air_may_touch(tmp_path: Path) -> None:
    """With hardly any clearance in the spec, joints touch; a part 1 mm off is still found."""
    tight = "print.slide_clearance=0.02"
    assert machine("eccentric-drive", tight).assembly.process.gap == 0
    assert all(f.ok for f in swept(tmp_path / "x.3mf", "eccentric-drive", tight))
    assert not all(f.ok for f in swept(tmp_path / "x.3mf", "eccentric-drive", tight, slider_1=1j))


@pytest.mark.parametrize("jump, said", [(0.0, ""), (1.0, "faster than its course")])
def test_a_motion_that_jumps_is_told(tmp_path: Path, jump: float, said: str) -> None:
    """A body that is elsewhere wherever it is looked at between the angles of the grid."""
    whole, step = bodies_in_motion(machine("eccentric-drive").assembly), np.pi / 1800

    def jumpy(theta: Floats) -> Mapping[str, Pose]:
        off = 40 * jump * np.sin(5 * theta) * (np.abs(theta / step - np.round(theta / step)) > 1e-6)
        found = dict(whole.courses(theta))
        return found | {"slider": replace(found["slider"], place=found["slider"].place + off)}

    swept(tmp_path / "x.3mf", "eccentric-drive")
    failed = [f for f in sweep(tmp_path / "x.3mf", replace(whole, courses=jumpy))[0] if not f.ok]
    assert [(f.code, said in f.message) for f in failed] == (
        [("INTERFERENCE", True)] if jump else []
    )


def test_a_tube_beside_its_needle_is_struck(tmp_path: Path) -> None:
    findings = swept(tmp_path / "x.3mf", "eccentric-drive", needle_tube_1=0.15j)
    assert any(
        not f.ok and "needle-tube-1" in str(f.where) and "needle" in str(f.where) for f in findings
    )


# ---- what may touch ----------------------------------------------------------------------------------------------------

# mm: of the machine, and what facets may show of an overlap; sums of them are exact
GAP = 0.1875
SPARE = 0.03125
ARM, PLATE, PIN = Eye("arm", 5j, 4.1), Eye("plate", 0j, 4.3), Eye("pin", 0j, 4.0, shaft=True)
TIP = Eye("arm", 30 + 0j, 6.0, shaft=True)
CAM = CamOutline("lift", "cam", "shaft", "pivot", TIP)
OWN = OwnTip("arm", TIP, PLATE)


def touching(
    *contacts: Passing | Feature, gap: float = GAP, stand_ins: Sequence[StandIn] = ()
) -> dict[str, float]:
    """What may overlap, of one copy of each part and two of the arm."""
    machine = SweptMachine((), lambda theta: {}, contacts, stand_ins, gap, SPARE / 4)
    parts = {f"{name}-1": name for name in ("plate", "arm", "pin", "cam", "roller", "ring")}
    parts |= {"arm-2": "arm", **{thing.name: thing.name for thing in stand_ins}}
    fits = _touching(machine, parts, SPARE)
    return {" ".join(sorted(pair)): round(overlap, 9) for pair, overlap in fits.items()}


def test_a_copy_is_of_its_part_whatever_both_are_called() -> None:
    """The first copy of a pin has the name of another part: only copies of that one may touch."""
    machine = SweptMachine(
        (), lambda theta: {}, (Passing("x", "pin-1", "plate"),), (), GAP, SPARE / 4
    )
    parts = {"pin-1": "pin", "pin-1-1": "pin-1", "plate-1": "plate"}
    assert list(_touching(machine, parts, SPARE)) == [frozenset(("pin-1-1", "plate-1"))]


def arms(other: str, overlap: float) -> dict[str, float]:
    """Both copies of the arm with another body."""
    return {" ".join(sorted((copy, other))): overlap for copy in ("arm-1", "arm-2")}


@pytest.mark.parametrize(
    "air, overlap",
    [(0.0, 0.0), (0.125, 0.0), (GAP, 0.0), (GAP + SPARE / 2, 0.0), (-0.03125, 0.0625)],
)
def test_fits_with_no_more_air_than_the_gap_may_touch(air: float, overlap: float) -> None:
    """air: mm, on either side of what is in the other; overlap: of the diameters where it is pressed in."""
    hole = replace(PIN, part="plate", diameter=4 + 2 * air, shaft=False)
    expected = {"pin-1 plate-1": overlap + SPARE}
    assert touching(PinEyes("P", hole, PIN)) == pytest.approx(expected)
    assert touching(PinEyes("P", PIN, hole)) == pytest.approx(expected)
    assert touching(PinEyes("P", hole, Eye(None, 0j, 4.0), PIN)) == pytest.approx(expected)
    assert touching(Steady("P", Eye("cam", 0j, 9), hole, PIN)) == pytest.approx(expected)
    rails = SlideFaces("guide", Faces("plate", 0j, 0.0, 8 + 2 * air), Faces("arm", 0j, 0.0, 8))
    assert touching(rails) == arms("plate-1", SPARE)
    assert touching(Passing("x", "arm", "plate", gap=air)) == arms("plate-1", SPARE)


def test_fits_with_more_air_must_keep_their_distance() -> None:
    hole = replace(PIN, part="plate", diameter=4 + 2 * 0.21, shaft=False)
    rails = SlideFaces("guide", Faces("plate", 0j, 0.0, 8 + 2 * 0.21), Faces("arm", 0j, 0.0, 8))
    for wide in (
        PinEyes("P", hole, PIN),
        Steady("P", PLATE, hole, PIN),
        rails,
        Passing("x", "arm", "plate", gap=0.21),
    ):
        assert touching(wide) == {}
    assert (
        touching(PinEyes("P", ARM, replace(hole, part="cam"))) == {}
    )  # holes do not hold each other
    assert (
        touching(PinEyes("P", hole, replace(PIN, part=None))) == {}
    )  # what no part has, nobody sees


def test_a_ring_in_a_hole_holds_the_pin() -> None:
    pin = replace(PIN, diameter=3.0)
    found = touching(
        PinEyes("P", ARM, Eye(None, 0j, 4.1), pin, rings=(FeatureRing("ring", 3.0, 4.0),))
    )
    assert found == {"pin-1 ring-1": SPARE}


@pytest.mark.parametrize("free, beyond", [(0.0, 0.0), (0.3, 0.0), (-0.04, 0.04)])
def test_tips_and_teeth_touch_as_they_roll(free: float, beyond: float) -> None:
    """The tip that runs on a cam: a part's own, its roller, what the eye is on; else the stand-ins that roll. 0.08 mm and what
    the pair is meant to be pressed."""
    rolling = 0.08 + SPARE + beyond
    disc = ((30 + 0j, 3.0, 0.0, 5.0),)
    things = [StandIn("tip on cam", "arm", disc, rolls=True), StandIn("motor", "ground", disc)]
    cam = replace(CAM, free=free)
    seat = replace(cam, tip=replace(TIP, part=None))
    assert touching(cam) == pytest.approx(arms("cam-1", rolling))
    assert touching(replace(seat, own=OWN)) == pytest.approx(arms("cam-1", rolling))
    assert touching(replace(cam, roller="roller")) == pytest.approx({"cam-1 roller-1": rolling})
    assert touching(replace(seat, own=replace(OWN, radius=3.0)), stand_ins=things) == pytest.approx(
        {"cam-1 tip on cam": rolling}
    )
    teeth = Teeth("plate", 9, 9.0, 3.0), Teeth("cam", 9, 9.0, 3.0)
    assert touching(GearTeeth("mesh", *teeth, ("O", "P"))) == {"cam-1 plate-1": 0.08 + SPARE}


def test_without_a_gap_all_may_graze() -> None:
    """All pairs, and what is pressed by as much more."""
    hole = replace(PIN, part="plate", diameter=3.9, shaft=False)
    found = touching(PinEyes("P", hole, PIN), gap=0.0)
    assert len(found) == 7 * 6 / 2
    assert {pair: overlap for pair, overlap in found.items() if overlap != SPARE} == {
        "pin-1 plate-1": pytest.approx(0.1 + SPARE)
    }


def test_pieces_of_one_thing_overlap_by_their_width() -> None:
    """Ends of one spring, 3 mm and 4 mm wide; another spring must keep its distance."""
    bar = (0j, 10 + 0j)
    things = [
        StandIn("spring, one end", "arm", (), bars=((*bar, 1.5, 0.0, 3.0),), whole="spring"),
        StandIn(
            "spring, other end",
            "plate",
            (),
            bars=((*bar, 2.0, 0.0, 3.0), (*bar, 0.5, 3.0, 4.0)),
            whole="spring",
        ),
        StandIn("belt", "plate", (), bars=((*bar, 9.0, 0.0, 3.0),), whole="belt"),
    ]
    assert touching(stand_ins=things) == {"spring, one end spring, other end": 4.0 + SPARE}


def test_stand_ins_as_slabs_stand_as_they_are_turned() -> None:
    """A disc and a bar with round ends: their areas and where they lie, turned with their body about its origin."""
    thing = StandIn(
        "x", "arm", ((20 + 0j, 3.0, 0.0, 2.0),), bars=((5 + 0j, 5 + 8j, 2.0, 2.0, 6.0),)
    )
    disc, bar = _slabs(thing, math.pi / 2)
    assert [(slab.z0, slab.z1, len(slab.rings)) for slab in (disc, bar)] == [
        (0.0, 2.0, 1),
        (2.0, 6.0, 1),
    ]
    assert disc.rings[0].area == pytest.approx(9 * math.pi)
    assert disc.rings[0].centroid == pytest.approx(20j)
    assert bar.rings[0].area == pytest.approx(8 * 4 + 4 * math.pi)
    assert bar.rings[0].box == pytest.approx((-10, 3, 2, 7))
    flat = _slabs(StandIn("x", "arm", ((0j, 3.0, 0.0, 2.0), (9 + 0j, 1.0, 0.0, 2.0))), 0.0)
    assert [len(slab.rings) for slab in flat] == [2]
