"""The judge of machines: features measured, machines closed on them, each damage told at the output."""

from __future__ import annotations

import cmath
import math
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from camgen import tolerances
from camgen.findings import Where
from camgen.geometry.rings import Ring, Shape
from camgen.judge.joints import Nominal
from camgen.judge.measured import Files, measure, measure_faces
from camgen.judge.motion import Verdict, _nominal, judge_machine
from camgen.machine.features import (
    CamOutline,
    Demand,
    Eye,
    Faces,
    Feature,
    Mount,
    OwnTip,
    PinEyes,
    SlideFaces,
)
from camgen.machine.model import (
    GROUND,
    Along,
    Angle,
    Body,
    Cam,
    Clutch,
    Drive,
    Gear,
    Machine,
    Output,
    Path,
    Pin,
    Place,
    Pose,
    Slide,
)

THETA = np.linspace(0.1, 6.3, 97)


# ---- what is measured ------------------------------------------------------------------------------------------------


def disc(centre: complex, radius: float, n: int = 200) -> Ring:
    return Ring(centre + radius * np.exp(2j * np.pi * np.arange(n) / n), np.zeros(n))


def bar(x: float, y0: float, y1: float, lean: float = 0.0) -> Shape:
    corners = np.array(
        [complex(0, y0), complex(x, y0), complex(x, y1), complex(0, y1)]
    ) * cmath.exp(1j * lean)
    return Shape(Ring(corners, np.zeros(4)), ())


def test_an_eye_is_found_at_every_height() -> None:
    plate = disc(0, 20)
    holes = [disc(5 + 0.01j * k, 1.5 + 0.02 * k) for k in range(3)]
    found = measure(
        Eye("x", 5 + 0j, 3.0), [[Shape(plate, (hole, disc(-5, 1.5)))] for hole in holes]
    )
    assert found is not None
    assert found.centre == pytest.approx(5 + 0.01j, abs=1e-9)
    assert found.diameter == pytest.approx(
        3.0 * math.cos(math.pi / 200), abs=1e-9
    )  # the narrowest, between its flats
    assert found.spread == pytest.approx(0.02, abs=1e-9)
    shaft = measure(Eye("x", 0j, 40.0, shaft=True), [[Shape(plate, ())]])
    assert shaft is not None and shaft.diameter == pytest.approx(40, abs=1e-9)
    assert measure(Eye("x", 9j, 3.0), [[Shape(plate, (holes[0],))]]) is None
    assert measure(Eye("x", 5 + 0j, 6.0), [[Shape(plate, (holes[0],))]]) is None


def test_faces_are_found_with_their_lean() -> None:
    faces = measure_faces(0j, 0.0, 8.0, [[bar(20, 4.1, 9), bar(20, -9, -4.0)]])
    assert faces is not None and (faces.offset, faces.lean, faces.width) == pytest.approx(
        (0.05, 0.0, 8.1), abs=1e-12
    )
    leaning = measure_faces(0j, 0.0, 8.0, [[bar(20, -4, 4, 0.002)]])
    assert leaning is not None
    assert (leaning.offset, leaning.lean) == pytest.approx((0.0, 0.002), abs=1e-9)
    assert measure_faces(0j, 0.0, 8.0, [[bar(20, 4, 9)]]) is None
    across = [
        [bar(20, 4, 9), bar(20, -9, -7)]
    ]  # edges square to the line begin 4 mm from it, and are no faces
    assert measure_faces(-5j, 0.0, 8.0, across) is None


# ---- findings --------------------------------------------------------------------------------------------------------

LINKS = (
    Mount("crank", "crank"),
    Mount("rod", "rod"),
    Mount("slider", "slider"),
    Mount("body", GROUND),
)
FEATURES: tuple[Feature, ...] = (
    PinEyes("O", Eye("crank", 0j, 2), Eye(None, 0j, 2, True)),
    PinEyes(
        "E", Eye("rod", 0j, 8.2), Eye("crank", 1.5 + 0j, 8, True)
    ),  # in the other order than the joint's places
    PinEyes("P", Eye("rod", 48 + 0j, 3.2), Eye("slider", 0j, 3), Eye(None, 0j, 3, True)),
    SlideFaces("guide", Faces("body", 0j, 0.0, 8.2), Faces("slider", 0j, 0.0, 8)),
)


def slider_crank(e: float = 1.5, rod: float = 48) -> Machine:
    """Crank, rod and slider; its output is the slider's place."""
    return Machine(
        (Body("crank"), Body("rod"), Body("slider")),
        (
            Pin("O", Place("crank"), Place(GROUND)),
            Pin("E", Place("crank", complex(e)), Place("rod"), 0.2),
            Pin("P", Place("rod", complex(rod)), Place("slider"), 0.2),
            Slide("guide", Place(GROUND), Place("slider"), clearance=0.2),
        ),
        (Drive("motor", "crank"),),
        {"crank": Pose(0j, 0.0), "rod": Pose(e, 0.0), "slider": Pose(e + rod, 0.0)},
        outputs=(Output("way", Along("guide")),),
    )


def place(theta: np.ndarray, order: int = 0, e: float = 1.5, rod: float = 48) -> np.ndarray:
    root = np.sqrt(rod**2 - (e * np.sin(theta)) ** 2)
    return (
        e * np.cos(theta) + root
        if order == 0
        else -e * np.sin(theta) * (1 + e * np.cos(theta) / root)
    )


def files(**changed: object) -> dict[str, list[list[Shape]]]:
    at = {
        "bore": 0j,
        "strap": 0j,
        "eye": 48 + 0j,
        "block": 0j,
        "strap_r": 4.1,
        "eye_r": 1.6,
    } | changed
    rim = disc(1.5, 4)
    return {
        "crank": [[Shape(rim, (disc(at["bore"], 1),))]],
        "rod": [
            [Shape(disc(24, 40), (disc(at["strap"], at["strap_r"]), disc(at["eye"], at["eye_r"])))]
        ],
        "slider": [
            [
                Shape(
                    Ring(np.array([-4 - 4j, 9 - 4j, 9 + 4j, -4 + 4j]), np.zeros(4)),
                    (disc(at["block"], 1.5),),
                )
            ]
        ],
        "body": [[bar(90, 4.1, 9), bar(90, -9, -4.1)]],
    }


def judged(mounts: tuple[Mount, ...] = LINKS, **changed: object) -> Verdict:
    asked = [Demand("way", place, stroke=True)]
    return judge_machine(
        Nominal(slider_crank(), FEATURES, mounts, asked),
        Files("dxf", Where(file="file"), files(**changed)),
        THETA,
        0.002,
    )


def verdict(**changed: object) -> set[str]:
    return {f.code for f in judged(**changed).findings if not f.ok}


@pytest.mark.parametrize(
    ("changed", "codes"),
    [
        ({}, set()),
        ({"eye": 48.02 + 0j}, {"MOTION_ERROR"}),
        ({"bore": 0.02 + 0j}, {"MOTION_ERROR", "STROKE_ERROR"}),
        ({"bore": 0.0015 + 0j}, {"STROKE_ERROR"}),
        ({"eye_r": 1.62}, {"PIN_GAP"}),
        ({"strap_r": 4.08}, {"PIN_GAP"}),
        ({"block": 0.02 + 0j}, {"MOTION_ERROR"}),
        ({"block": 0.2j}, {"MOTION_ERROR"}),
        ({"eye": 20 + 0j}, {"PIN_GAP"}),  # not found at all
        ({"strap": 0.5j, "eye": 48.5 + 0.5j}, {"MOTION_ERROR"}),
    ],
)
def test_each_damage_trips_its_finding(changed: dict[str, object], codes: set[str]) -> None:
    assert verdict(**changed) == codes


def test_the_sound_machine_closes_on_its_files() -> None:
    proof = judged().proof
    assert proof is not None
    moved = proof.moved("way", THETA)
    np.testing.assert_allclose(moved.value, place(THETA), atol=1e-11)
    np.testing.assert_allclose(moved.slope, place(THETA, 1), atol=1e-11)
    # half of 0.2 mm in strap and pin and guide; along the rod a displacement shifts the slider by 1 / cos(tilt)
    tilt = np.arcsin(1.5 * np.sin(THETA) / 48)
    np.testing.assert_allclose(moved.reach["P"], 1 / np.cos(tilt), rtol=1e-9)
    np.testing.assert_allclose(moved.reach["guide"], np.abs(np.tan(tilt)), atol=1e-9)
    flats = 1 - math.cos(
        math.pi / 200
    )  # what a hole of 200 facets is narrower than its corners, of its diameter
    pins = (0.2 - 8.2 * flats) / 2 + (0.2 - 6.2 * flats) / 2
    np.testing.assert_allclose(
        moved.play, pins / np.cos(tilt) + 0.1 * np.abs(np.tan(tilt)), rtol=1e-9
    )


def test_the_wanted_motion_is_the_machines_own_where_none_is_given() -> None:
    found = judge_machine(
        Nominal(slider_crank(), FEATURES, LINKS),
        Files("dxf", Where(file="file"), files()),
        THETA,
        0.002,
    )
    assert [f.code for f in found.findings] == ["PIN_GAP", "MOTION_ERROR", "LASH"] and all(
        f.ok for f in found.findings
    )
    assert "crank angle" in str(found.findings[1].where)  # it has no cam


def test_a_link_that_is_turned_over_has_its_holes_mirrored() -> None:
    """The rod's file is its mirror image, and it is put in turned over: about Oy, then by half a turn."""
    changed = {"strap": 0j, "eye": 48 + 0j}
    sections = files(**changed)
    rod = replace(
        sections["rod"][0][0],
        holes=tuple(hole.moved(-1, mirror=True) for hole in sections["rod"][0][0].holes),
    )
    eyes = (
        replace(FEATURES[1], a=Eye("rod", 0j, 8.2)),
        replace(FEATURES[2], a=Eye("rod", -48 + 0j, 3.2)),
    )
    features = (FEATURES[0], *eyes, FEATURES[3])
    for mount, fine in (
        (Mount("rod", "rod", flipped=True), True),
        (Mount("rod", "rod", angle=math.pi), True),
    ):
        mounts = (LINKS[0], mount, *LINKS[2:])
        asked = [Demand("way", partial(place))]
        found = judge_machine(
            Nominal(slider_crank(), features, mounts, asked),
            Files("dxf", Where(file="file"), sections | {"rod": [[rod]]}),
            THETA,
            0.002,
        )
        assert all(f.ok for f in found.findings) is fine


def test_a_part_on_no_body_of_its_joint_is_told() -> None:
    found = judged((Mount("crank", "rod"), *LINKS[1:]))
    (finding,) = found.findings
    assert (
        finding.code == "MOTION_ERROR"
        and not finding.ok
        and "crank is not mounted on" in finding.message
    )


def test_a_point_that_is_a_pin_s_hole_goes_with_that_hole() -> None:
    """The path of the rod's end: with its hole 0.1 mm further out the slider is further on by the same, and so is the point."""
    machine = replace(slider_crank(), outputs=(Output("pen", Path(Place("rod", 48 + 0j))),))
    found = judge_machine(
        Nominal(machine, FEATURES, LINKS),
        Files("dxf", Where(file="file"), files(eye=48.1 + 0j)),
        THETA,
        0.002,
    )
    assert found.proof is not None
    np.testing.assert_allclose(
        found.proof.moved("pen", THETA).value, place(THETA, rod=48.1), atol=1e-11
    )


@pytest.mark.parametrize("kind, rounding", [("dxf", 0.0), ("stl", 2.0**-24)])
def test_the_limit_of_the_motion_is_what_one_joint_and_all_roundings_do(
    kind: str, rounding: float
) -> None:
    """One joint's centre off by the chord tolerance; of a format that rounds, all of them by two steps of the largest place.
    Along the rod 1 mm is 1 / cos of its tilt at the slider, across the guide its tangent."""
    found = judge_machine(
        Nominal(slider_crank(), FEATURES, LINKS),
        Files(kind, Where(file="file"), files()),
        THETA,
        0.002,
    )
    tilt = np.max(np.abs(np.arcsin(1.5 * np.sin(THETA) / 48)))
    pin, guide = 1 / math.cos(tilt), math.tan(tilt)
    limit = next(f.limit for f in found.findings if f.code == "MOTION_ERROR")
    wanted = 0.002 * (1 + tolerances.BOUND_SPARE) * pin + 2 * rounding * 90 * abs(1 + 0.1j) * (
        3 * pin + guide
    )
    assert limit == pytest.approx(wanted, rel=1e-4)
    gap = next(f.limit for f in found.findings if f.code == "PIN_GAP")
    assert gap == pytest.approx(2 * 0.002 + 4 * rounding * 90 * abs(1 + 0.1j), rel=1e-4)


def test_a_fit_may_be_off_by_what_the_way_back_costs() -> None:
    found = judge_machine(
        Nominal(slider_crank(), FEATURES, LINKS),
        Files("dxf", Where(file="file"), files()),
        THETA,
        0.002,
        slack=0.01,
    )
    limit = next(f.limit for f in found.findings if f.code == "PIN_GAP")
    assert limit == pytest.approx(2 * 0.002 + 0.01)


def test_of_several_outputs_the_one_most_over_its_own_limit_is_told() -> None:
    """The block's hole 0.2 mm aside: it leans the rod by 0.2 / 48, of which an outline may do 0.002 / 48 or so; along the guide it
    does no more than the rod leans."""
    outputs = (Output("way", Along("guide")), Output("lean", Angle("rod")))
    machine = replace(slider_crank(), outputs=outputs)
    found = judge_machine(
        Nominal(machine, FEATURES, LINKS),
        Files("dxf", Where(file="file"), files(block=0.2j)),
        THETA,
        0.002,
    )
    motion = next(f for f in found.findings if f.code == "MOTION_ERROR")
    assert ", lean, crank angle" in str(motion.where) and motion.unit == "deg"
    assert motion.measured == pytest.approx(math.degrees(0.2 / 48), rel=0.01)


def test_what_no_file_shows_counts_as_meant() -> None:
    """Joints of parts that are made, no clutches; the bore of a cam shows its shaft, a tip of its own the axle."""
    turning = Machine(
        (Body("cam"), Body("arm"), Body("wheel"), Body("bare"), Body("other")),
        (
            Pin("shaft", Place(GROUND), Place("cam")),
            Pin("axle", Place(GROUND, 9j), Place("arm")),
            Cam("lift", "cam", "arm", lambda theta, order=0: theta, closure="force"),
            Gear("mesh", "cam", "wheel", -1.0),
            Pin("hub", Place(GROUND, 5), Place("wheel")),
            Pin("loose", Place(GROUND, 6), Place("bare")),
            Clutch("clutch", "wheel", "other", lambda theta, order=0: theta, lambda theta: theta),
        ),
        (),
        {name: Pose(0j, 0.0) for name in ("cam", "arm", "wheel", "bare", "other")},
    )
    tip, bore = Eye(None, 5j, 4.0), Eye("cam", 0j, 5.0)
    plain = CamOutline("lift", "cam", "shaft", "axle", tip)
    mounts = [Mount(name, name) for name in ("cam", "arm", "wheel")]
    for cam, shown in (
        (plain, {"axle", "shaft"}),
        (replace(plain, bore=bore), {"axle"}),
        (replace(plain, own=OwnTip("arm", tip, bore)), {"shaft"}),
    ):
        left = _nominal(Nominal(turning, [cam], mounts))
        assert {each.why.partition(" counts")[0] for each in left} == shown | {"mesh", "hub"}
    eyes = [PinEyes(name, tip, tip) for name in ("shaft", "axle", "hub")]
    assert [
        each.why.partition(" counts")[0]
        for each in _nominal(Nominal(turning, [plain, *eyes], mounts))
    ] == ["mesh"]


def test_the_table_gives_each_joints_share() -> None:
    table = judged(eye=48.001 + 0j).table
    assert table is not None
    rows = {row[0]: dict(zip(table.columns, row, strict=True)) for row in table.rows}
    assert rows["P"]["centres off, mm"] == pytest.approx(0.001, abs=1e-9)
    assert rows["P"]["error of way from the shift, mm"] == pytest.approx(
        0.001 / math.cos(math.asin(1.5 / 48)), rel=1e-3
    )
    assert rows["E"]["error of way from its play, mm"] == pytest.approx(0.1, abs=1e-3)
