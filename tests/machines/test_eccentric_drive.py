"""The eccentric drive: the paper's numbers and its errata, parts that fit, designs that do not exist, faulty specs."""

from __future__ import annotations

import math
import pickle
from itertools import combinations
from pathlib import Path
from typing import Any

import manifold3d
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgen.cli import main
from camgen.errors import DesignError, SpecError
from camgen.machines.eccentric_drive.mechanism import EccentricDrive
from camgen.machines.loads.assess import assess
from camgen.parts.solids import solid
from camgen.pipeline import build as pipeline
from camgen.pipeline.making import assembly_copies
from camgen.spec import validate

SPEC = Path(__file__).resolve().parents[2] / "specs" / "eccentric-drive.toml"
BASE: dict[str, Any] = {
    "mechanism": "eccentric-drive",
    "name": "drive",
    "geometry": {
        "eccentricity": 1.5,
        "rod": 48.0,
        "eccentric_diameter": 9.0,
        "shaft_diameter": 2.0,
    },
    "motor": {"speed_rpm": 13000.0},
}


def design(**keys: Any) -> EccentricDrive:
    """Default machine with changed keys, given as table__key."""
    spec = {key: dict(value) if isinstance(value, dict) else value for key, value in BASE.items()}
    for path, value in keys.items():
        table, key = path.split("__")
        spec.setdefault(table, {})[key] = value
    return validate(EccentricDrive, spec)


# ---- the paper, /reference: values re-computed there from its lengths ------------------------------------------------

RADIANS = np.radians([30, 60, 90, 120, 150, 180, 210, 240, 270, 300, 330, 360])
EXACT_SPEED = np.array(
    [17.4087788378, 29.8171521010, 33.9, 28.8993702756, 16.4912211622, 0]
)  # mm/s at 22.6 rad/s
EXACT_TRAVEL = np.array([0.206821627, 0.767581345, 1.523443225, 2.267581340, 2.804897840])


def test_travel_and_speed_of_the_paper() -> None:
    m = design()
    np.testing.assert_allclose(m.motion(RADIANS[:5]), EXACT_TRAVEL, atol=5e-10)
    np.testing.assert_allclose(m.motion(RADIANS[:6], 1) * 22.6, EXACT_SPEED, atol=6e-11)
    np.testing.assert_allclose(
        m.motion(RADIANS[6:], 1) * 22.6, np.append(-EXACT_SPEED[4::-1], 0), atol=6e-11
    )
    np.testing.assert_allclose(m.motion(np.array([0, math.pi])), [0, 3], atol=1e-12)
    ends = m.motion(np.array([0, math.pi]), 2)
    assert ends[0] / ends[1] == pytest.approx(-33 / 31, rel=1e-12)


def test_numbers_of_the_report() -> None:
    numbers = design().study().numbers
    assert numbers["stroke_mm"] == pytest.approx(3, abs=1e-12)
    assert numbers["peak_speed_angle_deg"] == pytest.approx(88.2118328149848, abs=1e-11)
    assert numbers["peak_speed_ratio"] == pytest.approx(1.00048816256341, abs=1e-13)
    assert numbers["paper_peak_speed_mm_s"] == pytest.approx(33.916549, abs=5e-7)
    assert numbers["motor_speed_rad_s"] == pytest.approx(1361.357, abs=5e-4)
    assert numbers["strokes_per_s"] == pytest.approx(216.67, abs=5e-3)
    assert numbers["second_harmonic_share"] == pytest.approx(
        1 / 64, rel=1e-3
    )  # Lambda / 2 to the first order


def test_peak_angle_solves_the_cubic() -> None:
    """x = sin^2 p solves L^4 x^3 - L^2 x^2 - x + 1 = 0."""
    for rod in (10.0, 20.0, 200.0):
        ratio = 1.5 / rod
        x = (
            math.sin(
                math.radians(
                    design(
                        geometry__rod=rod,
                        geometry__eccentric_diameter=6.6,
                        parts__strap_wall=0.8,
                        parts__pin_diameter=1.0,
                        parts__slider_width=3.0,
                        parts__wire_diameter=0.5,
                    )
                    .study()
                    .numbers["peak_speed_angle_deg"]
                )
            )
            ** 2
        )
        assert ratio**4 * x**3 - ratio**2 * x**2 - x + 1 == pytest.approx(0, abs=1e-13)


def test_the_published_table_stands_beside_the_exact_one() -> None:
    study = design().study()
    (table,) = (table for table in study.tables if "Published" in table.title)
    rows = np.array(table.rows, float)
    np.testing.assert_allclose(
        rows[:, 2], np.concatenate([EXACT_SPEED, -EXACT_SPEED[4::-1], [0]]), atol=6e-11
    )
    off = dict(zip(rows[:, 0], rows[:, 3], strict=True))
    assert [off[30], off[330]] == pytest.approx([-5.28] * 2, abs=6e-3)
    assert [off[60], off[300]] == pytest.approx([-3.08] * 2, abs=6e-3)
    assert abs(off[150]) < 0.01 and abs(off[120]) < 0.01
    np.testing.assert_allclose(rows[:, 4], -rows[:, 5], atol=0.01)  # phi2 without its minus sign
    np.testing.assert_allclose(np.abs(rows[:, 6]), np.abs(rows[:, 7]), atol=0.01)
    assert sum(note.startswith("Erratum") for note in study.notes) == 6
    other = design(geometry__rod=50.0).study()
    assert not any("Published" in table.title for table in other.tables) and not other.notes


@settings(max_examples=30)
@given(st.floats(0.2, 4), st.floats(60, 120), st.floats(-15, 15))
def test_motion_is_the_plain_formula(eccentricity: float, rod: float, offset: float) -> None:
    m = design(geometry__eccentricity=eccentricity, geometry__rod=rod, geometry__offset=offset)
    theta = np.linspace(0, 7, 50)
    x = eccentricity * np.cos(theta) + np.sqrt(
        rod**2 - (eccentricity * np.sin(theta) - offset) ** 2
    )
    np.testing.assert_allclose(
        m.motion(theta), math.sqrt((rod + eccentricity) ** 2 - offset**2) - x, atol=1e-12 * rod
    )
    assert m.motion(np.linspace(0, math.tau, 2001)).min() > -1e-12 * rod


# ---- parts and assembly ----------------------------------------------------------------------------------------------

MACHINES: list[dict[str, Any]] = [
    {},
    {"geometry__offset": 4.0},
    {"geometry__offset": -6.0, "geometry__eccentricity": 2.5, "geometry__eccentric_diameter": 12.0},
    {
        "geometry__rod": 30.0,
        "geometry__eccentricity": 4.0,
        "geometry__eccentric_diameter": 14.0,
        "print__slide_clearance": 0.3,
    },
    {"geometry__rod": 14.0, "parts__tube_length": 12.0},  # the disc lies over the slider
    {
        "parts__pin_diameter": 2.0,
        "parts__slider_width": 12.0,
        "parts__rail_width": 4.0,
        "print__press_clearance": 0.05,
    },
]


@pytest.mark.long
@pytest.mark.parametrize("keys", MACHINES)
def test_nothing_overlaps_on_the_turn(keys: dict[str, Any]) -> None:
    """Every pair of bodies in the assembly, cut with each other as solids."""
    m = design(**keys)
    meshes = {part.name: solid(part, 0.01) for part in m.assembly.parts}
    poses = m.assembly.poses
    for angle in np.radians([0, 75, 180, 270]):
        object.__setattr__(m, "poses", lambda theta, angle=angle: poses(np.asarray(theta) + angle))
        bodies = []
        for placed in assembly_copies(m):
            mesh = meshes[placed.object]
            raw = manifold3d.Mesh64(
                np.ascontiguousarray(mesh.vertices), mesh.faces.astype(np.uint64)
            )
            bodies.append(
                (
                    placed.object,
                    manifold3d.Manifold(raw).transform(np.asarray(placed.transform)[:3, :4]),
                )
            )
        for (a, first), (b, second) in combinations(bodies, 2):
            assert (first ^ second).volume() < 1e-3, (a, b, math.degrees(angle))


@pytest.mark.long
@pytest.mark.parametrize("keys", MACHINES[1:])
def test_other_machines_build_and_move_as_asked(keys: dict[str, Any], tmp_path: Path) -> None:
    overrides = [f"{path.replace('__', '.')}={value}" for path, value in keys.items()]
    # their heavier rods ask for more than oil at this speed
    more = ["limits.stroke=[1, 10]", "limits.pv_mpa_m_s=10"]
    report = pipeline.build(SPEC, tmp_path, frozenset({"stl"}), [*overrides, *more])
    assert [f for f in report.findings if not f.ok] == []


def test_forces_of_a_slider_alone_are_its_mass_times_acceleration() -> None:
    masses = {"rod_g": 1e-9, "rod_centre": 0.0, "rod_inertia_g_mm2": 0.0, "slider_g": 1.5}
    numbers = design(**{f"masses__{key}": value for key, value in masses.items()}).study().numbers
    speed = 13000 * math.tau / 60
    # at theta = 0, where rod and guide are in line and the acceleration is greatest: m e w^2 (1 + Lambda)
    assert numbers["peak_force_p_n"] == pytest.approx(
        1.5e-3 * 1.5e-3 * speed**2 * (1 + 1 / 32), rel=1e-6
    )
    assert numbers["peak_torque_n_m"] > 0 and not any(
        key.endswith(("_N", "_N_m")) for key in numbers
    )
    assert "peak_force_p_n" not in design().study().numbers


# ---- designs that do not exist ---------------------------------------------------------------------------------------


def test_the_papers_disc_has_no_wall() -> None:
    with pytest.raises(DesignError) as caught:
        _ = design(geometry__eccentric_diameter=5.0).assembly
    assert (caught.value.value, caught.value.limit) == (pytest.approx(0, abs=1e-12), 0.8)
    assert "MIN_WALL" in str(caught.value) and "eccentric_diameter of 6.6 mm or more works" in str(
        caught.value
    )
    assert design(geometry__eccentric_diameter=6.6).assembly.parts


@pytest.mark.long
@settings(max_examples=30)
@given(st.floats(0.1, 5), st.floats(0.5, 8), st.floats(0.4, 3))
def test_the_diameter_that_is_said_to_work_works(
    eccentricity: float, shaft: float, wall: float
) -> None:
    keys = {
        "geometry__eccentricity": eccentricity,
        "geometry__shaft_diameter": shaft,
        "limits__min_wall": wall,
    }
    # room for such a shaft and such walls in the other parts
    keys |= {
        "motor__boss_diameter": 9.0,
        "parts__rail_width": 12.0,
        "parts__cover_length": 12.0,
        "parts__slider_width": 12.0,
    }
    keys |= {"parts__strap_wall": 3.0}
    with pytest.raises(DesignError) as caught:
        _ = design(**keys, geometry__eccentric_diameter=0.5).assembly
    works = float(caught.value.remedy.split("eccentric_diameter of ")[1].split(" mm")[0])
    assert design(
        **keys, geometry__eccentric_diameter=works * (1 + 1e-5), geometry__rod=120.0
    ).assembly.parts


def test_no_wall_exits_with_3_and_writes_nothing(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as done:
        main(
            [
                "build",
                str(SPEC),
                "--set",
                "geometry.eccentric_diameter=5",
                "-o",
                str(tmp_path / "out"),
            ]
        )
    assert done.value.code == 3
    assert "6.6 mm or more works" in "".join(capfd.readouterr())
    assert not (tmp_path / "out" / "eccentric-drive").exists()


@pytest.mark.parametrize(
    ("keys", "gap", "said"),
    [
        ({"geometry__rod": 1.0}, 0.5, "closes or opens at"),
        ({"geometry__rod": 48.0, "geometry__offset": 47.0}, 0.5, "closes or opens at"),
        ({"geometry__offset": 60.0}, 13.5, "never closes"),
    ],
)
def test_a_rod_that_does_not_reach_says_where_and_by_how_much(
    keys: dict[str, Any], gap: float, said: str
) -> None:
    with pytest.raises(DesignError) as caught:
        _ = design(**keys).assembly
    assert caught.value.value == pytest.approx(gap, abs=1e-9)
    assert said in str(caught.value) and "crank angle" in str(caught.value)
    if keys == {"geometry__rod": 1.0}:  # |sin p| <= 1 / Lambda: asin(2/3) = 41.8103 deg
        assert all(edge in str(caught.value) for edge in ("41.8103", "138.19", "221.81", "318.19"))


@pytest.mark.parametrize(
    "keys", [{"geometry__rod": 1.5}, {"geometry__offset": 46.5}, {"geometry__offset": -46.5}]
)
def test_a_change_point_is_told(keys: dict[str, Any]) -> None:
    with pytest.raises(DesignError, match="change point"):
        _ = design(**keys).assembly


def test_a_poor_transmission_angle_fails() -> None:
    (finding,) = design(geometry__rod=60.0, geometry__offset=50.0).limits()
    assert (finding.code, finding.ok) == ("TRANSMISSION_ANGLE", False)
    assert finding.measured == pytest.approx(math.degrees(math.acos(51.5 / 60)), rel=1e-12)


# ---- faulty specs ----------------------------------------------------------------------------------------------------

MASSES = {"rod_g": 1.0, "rod_centre": 1.0, "rod_inertia_g_mm2": 1.0, "slider_g": 1.0}


def faults(**keys: Any) -> list[str]:
    with pytest.raises(SpecError) as caught:
        design(**keys)
    return [fault.key for fault in caught.value.faults]


@pytest.mark.parametrize("key", MASSES)
def test_each_mass_says_what_is_wrong_with_it(key: str) -> None:
    given_ = {f"masses__{name}": value for name, value in MASSES.items()}
    assert faults(**given_ | {f"masses__{key}": "heavy"}) == [f"masses.{key}"]
    del given_[f"masses__{key}"]
    assert faults(**given_) == [f"masses.{key}"]


@pytest.mark.parametrize(
    ("keys", "path"),
    [
        ({"limits__min_wall": 0.3}, "limits.min_wall"),
        ({"parts__strap_wall": 0.3}, "parts.strap_wall"),
        ({"parts__flange": 4.3}, "parts.flange"),
        ({"parts__wire_diameter": 4.0}, "parts.wire_diameter"),
        ({"parts__pin_diameter": 8.0}, "parts.pin_diameter"),
        ({"parts__shaft_diameter": 3.0}, "parts.shaft_diameter"),
        ({"parts__rail_width": 0.3}, "parts.rail_width"),
        ({"parts__flange": 0.3}, "parts.flange"),
        ({"parts__body_thickness": 0.001}, "parts.body_thickness"),
        ({"parts__rod_thickness": 0.001}, "parts.head parts.rod_thickness"),
        ({"parts__slider_thickness": 1.8}, "parts.wire_diameter"),
        ({"motor__boss_diameter": 2.0}, "motor.boss_diameter"),
        ({"motor__diameter": 6.0}, "motor.diameter"),
    ],
)
def test_keys_that_do_not_go_together(keys: dict[str, Any], path: str) -> None:
    assert faults(**keys) == path.split()


def test_old_words_are_taken_and_noted() -> None:
    """As a spec of 2025 had them: the same machine, and a note on each."""
    old = {"strap_wall": 2.5, "rod_thickness": 3.5, "flange": 1.2, "body_thickness": 6.0}
    new = {"wall": 2.5, "thickness": 3.5, "head": 1.2, "base_thickness": 6.0, "pin": "dowel"}
    before = design(**{f"parts__{key}": value for key, value in old.items()}, parts__pins="steel")
    assert before.making == design(**{f"parts__{key}": value for key, value in new.items()}).making
    assert before.hints == tuple(
        f"parts.{word} is read as parts.{key}"
        for word, key in zip([*old, "pins"], new, strict=True)
    )
    pins = [part for part in before.assembly.parts if part.name.startswith("pin-")]
    assert [pin.process for pin in pins] == ["bought"] and "ISO 2338" in pins[0].notes[0]
    both = design(
        parts__strap_wall=2.5, parts__wall=3.0
    )  # such as --set over a spec that was filled in
    assert both.making.wall == 2.5 and "in place of parts.wall" in both.hints[0]
    assert faults(parts__strap_wall="wide") == ["parts.strap_wall"]


def test_a_collar_that_would_swallow_the_guide_is_refused() -> None:
    with pytest.raises(DesignError, match="motor's seat and the guide"):
        _ = design(motor__boss_diameter=110.0, motor__diameter=120.0).assembly
    assert faults(motor__boss_diameter=1.5) == ["motor.boss_diameter"]


def test_the_motor_shaft_is_told_and_judged() -> None:
    """5 of the body, 4 of the slider, 3 of the rod, 1 of the washer, three plays of 0.2."""
    m = design(motor__shaft_length=13.5, limits__pv_mpa_m_s=2.0)
    assert m.study().numbers["motor_shaft_length_mm"] == pytest.approx(13.6, abs=1e-12)
    assert m.assembly.motor.reach == pytest.approx(13.6, abs=1e-12)
    assert {f.code for f in assess(m).findings if not f.ok} == {"SHAFT_REACH"}
    assert all(
        f.ok for f in assess(design(motor__shaft_length=13.7, limits__pv_mpa_m_s=2.0)).findings
    )
    lines = {line.name: line for line in m.assembly.bought}
    assert "round shaft of 2, at least 13.6 long from its face" in lines["drive"].size
    # 5 less a head of 2 sunk by 0.2, 25 of the can, 5 of the bar, and a nut of 1.6; 4 + 3 and a nut
    sizes = [lines[f"screw of the {what}"].size for what in ("motor", "wire clamp")]
    assert sizes == ["M2 x 35, with a nut", "M2 x 10"] and lines["nut"].count == 2  # without a tube


def test_the_clamp_presses_on_the_wire_and_stays_outside_the_guide() -> None:
    m = design()
    parts = {part.name: part for part in m.assembly.parts}
    head, top = parts["slider"].layers[1], parts["slider"].thickness
    assert head.z1 == pytest.approx(top - 1.5 / 4) and head.z0 == pytest.approx(
        top - 1.5
    )  # the wire stands out by a quarter
    poses = m.assembly.poses(np.array([math.pi]))
    edge = poses["clamp"][0].place[0].real - 3.2
    cover = poses["cover-1"][0].place[0].real + max(
        z.real
        for piece in parts["cover-1"].region.outer.pieces
        for z in np.atleast_1d(piece.at(np.linspace(piece.t0, piece.t1, 9)))
    )
    assert edge > cover and poses["clamp"][0].z == pytest.approx(poses["slider"][0].z + top)


@pytest.mark.long
@pytest.mark.parametrize("limit", [1.0, 0.4, 5.0])
def test_play_is_judged_by_the_designers_limit(limit: float, tmp_path: Path) -> None:
    """0.2 mm of play in strap and pin each; no limit bears more than half of the stroke of 3 mm."""
    settings = [] if limit == 1 else [f"limits.lash={limit}"]
    (lash,) = [
        f
        for f in pipeline.build(SPEC, tmp_path, frozenset({"dxf"}), settings).findings
        if f.code == "LASH"
    ]
    assert lash.measured == pytest.approx(0.4, rel=0.02) and lash.ok is (lash.measured <= limit)
    assert lash.limit == pytest.approx(min(limit, 1.5), abs=1e-6)


@pytest.mark.long
def test_play_as_large_as_the_stroke_fails(tmp_path: Path) -> None:
    report = pipeline.build(
        SPEC,
        tmp_path,
        frozenset({"dxf"}),
        ["print.slide_clearance=0.8", "geometry.eccentricity=0.4"],
    )
    lash = next(f for f in report.findings if f.code == "LASH")
    # by hand: strap and pin 0.4 each way, the guide's share under 1 %; half of the stroke of 0.8
    assert (
        not lash.ok
        and lash.measured == pytest.approx(1.6, rel=0.01)
        and lash.limit == pytest.approx(0.4, abs=1e-6)
    )


@pytest.mark.parametrize(
    "settings, fails",
    [
        (["limits.stroke=[2, 3]"], []),  # twice 1.5 mm is just 3
        (["limits.stroke=[2, 2.9]"], ["STROKE", "NEEDLE_REACH"]),
        (["limits.stroke=[3.1, 4]"], ["STROKE", "NEEDLE_REACH"]),
        (["limits.strokes_per_s=[3, 4]"], ["STROKE_RATE"]),  # 13000 rpm is 216.7 a second
        (["limits.strokes_per_s=[3, 4]", "motor.speed_rpm=-217"], []),
    ],
)
def test_what_the_task_asks_for_is_judged(settings: list[str], fails: list[str]) -> None:
    made = pipeline.read_mechanism(SPEC, settings)
    assert [f.code for f in made.limits() if not f.ok] == fails


def test_a_band_upside_down_is_a_fault() -> None:
    with pytest.raises(SpecError, match="limits.stroke"):
        pipeline.read_mechanism(SPEC, ["limits.stroke=[3, 2]"])


# ---- the needle's tube -----------------------------------------------------------------------------------------------


def of_tube(found: EccentricDrive) -> dict[tuple[str, bool], bool]:
    return {(f.code, f.floor): f.ok for f in found.limits() if f.code.startswith("NEEDLE")}


def test_the_needle_is_guided_and_reaches_as_deep_as_it_should() -> None:
    m = design(parts__tube_length=12.0, limits__stroke=(2.0, 3.0))
    assert m.needle is not None and m.needle.out == pytest.approx(
        (0.0, 3.0)
    )  # the paper: 2 to 3 mm out of the tube
    assert set(of_tube(m).values()) == {True} and len(of_tube(m)) == 3
    tip = (
        m.assembly.poses(np.array([0.0, math.pi]))["slider"][0].place.real
        + m.needle.hook
        + m.needle.wire
    )
    face = m.assembly.poses(np.zeros(1))["needle-tube"][0].place[0].real + 6.0
    assert tip - face == pytest.approx([3.0, 0.0], abs=1e-9)  # innermost at 180 deg
    longer, shorter = (
        design(
            parts__tube_length=12.0, limits__stroke=(2.0, 3.0), parts__wire_length=m.needle.wire + d
        )
        for d in (0.1, -1.1)
    )
    assert (
        of_tube(longer)["NEEDLE_REACH", False] is False
        and of_tube(shorter)["NEEDLE_REACH", True] is False
    )
    blunt = design(parts__tube_length=12.0, parts__wire_length=m.needle.wire - 9.5)
    assert of_tube(blunt) == {("NEEDLE_GUIDED", True): False}
    assert of_tube(design()) == {}
    assert [each.name for each in design().assembly.stand_ins] == ["motor"]


def test_the_bore_of_the_tube_holds_the_wire_with_the_fit_of_what_slides() -> None:
    m = design(parts__tube_length=12.0, print__slide_clearance=0.3)
    part = next(part for part in m.assembly.parts if part.name == "needle-tube")
    assert m.needle is not None
    beside = [layer for layer in part.layers if layer.z0 == part.layers[1].z0]
    edges = sorted(
        z.imag
        for layer in beside
        for piece in layer.region.outer.pieces
        for z in (piece.a, piece.b)
    )
    inner = [y for y in edges if abs(y) < 2]
    assert max(inner) - min(inner) == pytest.approx(1.8) == beside[0].z1 - beside[0].z0
    assert {line.name: line for line in m.assembly.bought}["nut"].count == 4


@pytest.mark.parametrize(
    "keys",
    [
        {"parts__wire_length": 40.0},
        {"parts__tube_length": 3.0},
        {"parts__tube_length": 12.0, "parts__wire_diameter": 3.55},
    ],
)
def test_a_tube_that_cannot_be_is_told(keys: dict[str, float]) -> None:
    with pytest.raises(SpecError, match="parts.w|parts.t"):
        design(**keys)


def test_a_counterweight_lies_across_from_the_eccentric_and_spares_the_shaft() -> None:
    m = design(counterweight__made="steel")
    sent = pickle.loads(pickle.dumps(m.study()))  # as another process gets it
    assert sent.numbers == m.study().numbers and len(sent.plots) == len(m.study().plots)
    numbers = assess(m).study.numbers
    assert (
        numbers["counterweight_bearing_after_n"] < 0.75 * numbers["counterweight_bearing_before_n"]
    )
    # rod and slider shift along the guide: half to all of their moment at the eccentric, and the disc's own, across from it
    assert (
        abs(numbers["counterweight_at_deg"]) == pytest.approx(180, abs=1)
        and m.assembly.motor.reach
        == pytest.approx(18.8)  # plate 5; levels of 4, 3, 3, 3, a play each
    )
