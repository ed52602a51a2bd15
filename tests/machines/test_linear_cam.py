"""Linear cams: edges against the reference's numbers and a roller of the test's own, files against damages."""

from __future__ import annotations

import math
import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest

from camgen.errors import DesignError, SpecError
from camgen.files.stl import write_stl
from camgen.geometry.mesh import Mesh
from camgen.geometry.rings import Ring
from camgen.judge.edge_runs import Tip, pressure_angle, run
from camgen.machine.cams.linear import WAY
from camgen.machine.constraints import Constraints
from camgen.machine.model import Along, Resistance
from camgen.machine.run import solve
from camgen.machines.follower_motions import table_motions
from camgen.machines.linear_cam.mechanism import LinearCamDrive
from camgen.machines.loads.assess import assess
from camgen.parts.solids import solid
from camgen.pipeline.case import Case
from camgen.pipeline.plate_edges import judge_plate_edge
from camgen.spec import validate

TOP = Path(__file__).parents[2]
REFERENCE = tomllib.loads(
    (TOP / "tests" / "reference" / "linear-cams.toml").read_text(encoding="utf-8")
)
ARM = {"motion": "oscillating", "shape": "roller", "radius": 5.0, "arm": 50.0, "start_deg": -8.0}
KNIFE = {"motion": "oscillating", "shape": "knife", "arm": 50.0}
RISE = [{"kind": "rise", "span": 60.0, "lift": 15.0, "law": "cycloidal"}]
UNEVEN = [
    {"kind": "rise", "span": 60.0, "lift": 12.0, "law": "3-4-5"},
    {"kind": "return", "span": 45.0, "to": 4.0, "law": "cycloidal"},
]


def linear(**tables: Any) -> LinearCamDrive:
    """The starter, with other keys in its tables."""
    data = tomllib.loads((TOP / "specs" / "linear-cam.toml").read_text(encoding="utf-8"))
    for name, keys in tables.items():
        data[name] = {**data.get(name, {}), **keys} if isinstance(keys, dict) else keys
    return validate(LinearCamDrive, data)


def test_a_rise_has_the_references_angle_and_curvature() -> None:
    machine = linear()
    assert machine.cam.steepest == pytest.approx(REFERENCE["pressure_angle_deg"], abs=1e-3)
    pitch = machine.cam.least_radius + 5
    assert pitch == pytest.approx(REFERENCE["pitch_radius"], abs=1e-3)


@pytest.mark.parametrize("follower", [{"shape": "roller", "radius": 5.0}, ARM])
def test_the_roller_touches_the_edge_and_never_enters_it(follower: dict[str, Any]) -> None:
    """Its centre by hand: the way, and the slide or the arm's triangle; a dense polygon of the edge is R away from it."""
    machine = linear(geometry={"follower": follower, "height": 20.0}, segment=UNEVEN)
    edge = np.concatenate(
        [piece.at(np.linspace(piece.t0, piece.t1, 4001)) for piece in machine.cam.edge]
    )
    theta = np.linspace(*machine.cam.range, 41)[1:-1]
    s = machine.motion(theta)
    if "arm" in follower:
        turn = np.exp(1j * (math.radians(-8) + s))
        centre = 25j - 50 * np.exp(1j * math.radians(-8)) + 50 * turn
    else:
        centre = 1j * (25 + s)
    away = np.abs(edge[None] - (WAY * theta + centre)[:, None]).min(axis=1)
    assert away == pytest.approx(np.full(39, 5.0), abs=2e-5)


def test_a_way_ends_where_it_will() -> None:
    machine = linear(segment=UNEVEN)
    low, high = machine.cam.range
    assert WAY * (high - low) == pytest.approx(105)
    assert machine.motion(np.array([low, high, high + 1])) == pytest.approx([0, 4, 4])
    assert machine.program.discontinuities(2) == []
    # half a 3-4-5 rise at half its span
    assert machine.motion(np.array([30 / WAY]))[0] == pytest.approx(6)


def test_the_drive_bears_the_load_times_the_slope() -> None:
    """15 N on the slide take 15 ds/dx of the drive, by virtual work; both routes to the poses agree."""
    machine = linear().model
    pressed = replace(machine, loads=(Resistance("load", Along("guide"), -15.0),))
    theta = np.linspace(0.1, 2.0, 7)
    forces = solve(pressed, theta).forces()
    slope = linear().motion(theta, 1) / WAY
    assert forces.drives["motor"] == pytest.approx(15 * slope, abs=1e-9)
    ran = solve(machine, theta)
    system = Constraints(machine)
    poses = [ran.pose(body) for body in system.bodies]
    q = np.column_stack(
        [
            part
            for pose in poses
            for part in (pose.place.real, pose.place.imag, pose.angle + 0 * theta)
        ]
    )
    rates = np.zeros_like(q)
    rates[:, 3 * system.bodies.index("cam")] = -WAY
    rates[:, 3 * system.bodies.index("follower") + 1] = linear().motion(theta, 1)
    misfits, slopes, bends = system.evaluate(q, theta, rates)
    assert np.abs(misfits).max() < 1e-12
    # along the motion a condition changes with theta by the drive's rate alone, and bends as the lift does
    row = system.rows["contact"].start
    assert np.einsum("nc,nc->n", slopes[:, row], rates) == pytest.approx(0, abs=1e-9)
    assert bends[:, row] == pytest.approx(-linear().motion(theta, 2), abs=1e-6)


def test_a_plate_has_no_table_over_a_turn() -> None:
    """A servo's cam table is over 360 deg of a master, and a way in mm is none."""
    assert list(table_motions(linear())) == []


def test_the_followers_rates_are_those_of_the_cycloid() -> None:
    """15 mm in 60 mm at 20 mm/s, so in 3 s: 2 h/T, 2 pi h/T^2 and 4 pi^2 h/T^3."""
    rates = 15 * np.array([2 / 3, 2 * math.pi / 9, 4 * math.pi**2 / 27])
    keys = ("velocity", "acceleration", "jerk")
    for share, holds in ((1.001, True), (0.999, False)):
        machine = linear(limits=dict(zip(keys, (share * rates).tolist(), strict=True)))
        judged = [each for each in assess(machine).findings if each.code.startswith("FOLLOWER_")]
        assert [each.measured for each in judged] == pytest.approx(rates)
        assert [each.ok for each in judged] == [holds] * 3


def test_what_pushes_the_plate_is_a_force() -> None:
    """15 N on the slide take 15 ds/dx of the plate, at most a half; over a rise of 15 mm in 3 s that is 75 mW."""
    machine = linear(load={"friction": 0.0, "contact_friction": 0.0}, segment=RISE)
    pressed = replace(machine.model, loads=(Resistance("load", Along("guide"), -15.0),))
    numbers = assess(machine, pressed).study.numbers
    assert numbers["drive_force_n"] == pytest.approx(7.5, rel=1e-4)
    assert numbers["drive_power_w"] == pytest.approx(0.075, rel=1e-3)
    assert not {"drive_torque_n_m", "energy_swing_j"} & numbers.keys()
    assert "drive_force_n" not in assess(machine).study.numbers


@pytest.mark.parametrize("follower", [{"shape": "roller", "radius": 5.0}, ARM])
def test_a_spring_presses_the_follower_on_the_plate(follower: dict[str, Any]) -> None:
    """At 20 mm/s inertia does nothing to thousandths: preload and rate alone, over the lever and the cosine of the pressure angle."""
    swings = "arm" in follower
    spring = {"rate": 0.5, "preload": 3.0}
    load = {"inertia_kg_m2": 1e-9} if swings else {"mass_kg": 1e-6}
    machine = linear(geometry={"follower": follower}, segment=UNEVEN, load=load, spring=spring)
    theta = np.linspace(*machine.cam.range, 4001)
    lift = machine.motion(theta)
    steep = machine.cam.pressure_angle(theta)
    force = (3.0 + 0.5 * lift) / np.cos(steep) / (0.05 if swings else 1.0)
    numbers = machine.study().numbers
    assert numbers["peak_contact_force_n"] == pytest.approx(np.max(force), rel=1e-4)
    assert numbers["least_contact_force_n"] == pytest.approx(np.min(force), rel=1e-4)
    kept = next(each for each in machine.limits() if each.code == "LIFT_OFF")
    assert kept.ok and kept.measured == pytest.approx(np.min(force), rel=1e-4)


def test_a_follower_leaves_a_plate_that_is_too_fast() -> None:
    """2 kg on the cycloid of 15 mm in 60 mm: at least a = 2 pi h v^2 / l^2 downwards at the top of the rise."""
    speed = 300.0
    needed = 2 * 2 * math.pi * 15e-3 * (speed / 60) ** 2
    machine = linear(load={"mass_kg": 2.0}, drive={"speed": speed}, spring={"preload": 1.0})
    lost = next(each for each in machine.limits() if each.code == "LIFT_OFF")
    assert not lost.ok and "mm" in str(lost.where)
    assert machine.study().numbers["spring_preload_needed_n"] == pytest.approx(needed, rel=1e-3)
    held = machine.replace({"spring.preload": 1.001 * needed})
    assert next(each for each in held.limits() if each.code == "LIFT_OFF").ok


def test_the_roller_presses_as_two_cylinders_do() -> None:
    """On the level top a cylinder of 5 mm on a plane, by Hertz: p = sqrt(F E* / (pi L R)); the plate is 5 mm thick."""
    machine = linear(
        segment=[{"kind": "dwell", "span": 50.0}],
        load={"resistance": 20.0},
        material={"name": "C45"},
        limits={"hertz_mpa": 50.0, "least_radius": 0.0},
    )
    steel = 206e3 / (2 * (1 - 0.3**2))
    pressure = math.sqrt(20.0 * steel / (math.pi * 5.0 * 5.0))
    (judged,) = (each for each in machine.limits() if each.code == "HERTZ")
    assert judged.measured == pytest.approx(pressure, rel=0.02)  # E of steels is 206 to 210 GPa
    assert not judged.ok
    blade = linear(geometry={"follower": {"shape": "knife", "radius": None}}, load={"mass_kg": 1.0})
    assert {each.code for each in blade.assembly.unjudged} == {"HERTZ"}


def test_the_plate_has_the_name_that_slides() -> None:
    machine = linear(drive={"slide": "plate"})
    assert [part.name for part in machine.assembly.parts] == ["plate"]


# ---- the judge -------------------------------------------------------------------------------------------------------


def hill(radius: float) -> Ring:
    """A half disc on its flat side, of one arc."""
    return Ring(np.array([radius, -radius], complex), np.array([1.0, 0.0]))


def test_a_tip_over_a_half_disc_runs_on_a_larger_one() -> None:
    x = np.linspace(-25, 25, 41)
    s = run(hill(30.0), Tip(5.0, 40j), x, 1e-7)
    assert s == pytest.approx(np.sqrt(35.0**2 - x**2) - 40, abs=1e-6)
    steep = pressure_angle(Tip(5.0, 40j), s, -x / np.sqrt(35.0**2 - x**2))
    assert steep == pytest.approx(np.abs(np.arcsin(x / 35)))


def test_an_arm_over_a_half_disc_makes_a_triangle() -> None:
    """Axle, the disc's middle and the tip's centre: all three sides are known."""
    x = np.linspace(-10, 10, 21)
    pivot = -50 + 36j
    s = run(hill(30.0), Tip(5.0, 50 + 0j, pivot), x, 1e-7)
    axle = x + pivot
    far = np.abs(axle)
    cosine = (far**2 + 50**2 - 35**2) / (2 * far * 50)
    assert s == pytest.approx(np.angle(-axle) + np.arccos(cosine), abs=1e-6)


def test_nothing_stops_a_tip_beside_the_plate() -> None:
    s = run(hill(30.0), Tip(5.0, 40j), np.array([34.0, 36.0]), 1e-4)
    assert np.isnan(s).tolist() == [False, True]


def test_an_arm_comes_down_on_its_right() -> None:
    """A hill behind the axle, an arm's length away and higher than it, stops nothing."""
    corners = np.array([0, 200, 200 + 20j, 60 + 20j, 40 + 45j, 20 + 20j, 20j], complex)
    s = run(Ring(corners, np.zeros(7)), Tip(5.0, 50 + 0j, 25j), np.array([91.0, 150.0]), 1e-4)
    assert s == pytest.approx([0, 0], abs=1e-12)


def verdicts(tmp_path: Path, machine: LinearCamDrive, mesh: Mesh) -> set[str]:
    """Codes that fail of an STL in place of the machine's own."""
    case = Case(machine, tmp_path)
    write_stl(case.file("cam", "stl"), mesh, "cam")
    return {each.code for each in judge_plate_edge(case, ["stl"]).findings if not each.ok}


@pytest.mark.parametrize("follower", [{"shape": "roller", "radius": 5.0}, ARM])
def test_damages_are_refused(tmp_path: Path, follower: dict[str, Any]) -> None:
    machine = linear(geometry={"follower": follower}, segment=UNEVEN)
    (part,) = machine.assembly.parts
    sound = solid(part, machine.accuracy.chord_tolerance)
    assert verdicts(tmp_path, machine, sound) == set()

    def moved(shift: list[float]) -> Mesh:
        return Mesh(sound.vertices + np.array(shift), sound.faces)

    assert "MOTION_ERROR" in verdicts(tmp_path, machine, moved([0, 0.01, 0]))
    assert "MOTION_ERROR" in verdicts(tmp_path, machine, moved([0.05, 0, 0]))
    assert "CONTACT" in verdicts(tmp_path, machine, moved([60, 0, 0]))
    turned = Mesh(
        sound.vertices * np.array([-1.0, 1.0, 1.0]) + np.array([105.0, 0, 0]), sound.faces[:, ::-1]
    )
    assert {"MOTION_ERROR", "SPEED_RIPPLE"} <= verdicts(tmp_path, machine, turned)
    steep = machine.replace({"limits.pressure_angle_deg": machine.cam.steepest - 0.5})
    assert verdicts(tmp_path, steep, sound) == {"PRESSURE_ANGLE"}


def test_a_drawing_of_arcs_that_no_chords_follow_is_told(tmp_path: Path) -> None:
    """Larger by 1e12: chords within the tolerance of its arcs cannot be counted."""
    machine = linear()
    case = Case(machine, tmp_path)
    drawing = ezdxf.new()  # type: ignore[attr-defined]
    drawing.header["$INSUNITS"] = 4
    corners = [(0, 0, 0), (1e14, 0, 1), (1e14, 1e13, 0), (0, 1e13, 0)]
    space = drawing.modelspace()
    space.add_lwpolyline(corners, format="xyb", close=True, dxfattribs={"layer": "CUT"})
    drawing.saveas(case.file("cam", "dxf"))
    (contact,) = judge_plate_edge(case, ["dxf"]).findings
    assert (contact.code, contact.ok, contact.measured) == ("CONTACT", False, 0.0)
    assert "more than 5000000 chords" in contact.message


def test_a_way_shorter_than_its_means_is_judged(tmp_path: Path) -> None:
    machine = linear(segment=[{"kind": "dwell", "span": 0.5}], parts={"hole": 0.0})
    (part,) = machine.assembly.parts
    sound = solid(part, machine.accuracy.chord_tolerance)
    assert verdicts(tmp_path, machine, sound) == set()
    leant = Mesh(sound.vertices @ np.array([[1, 0.1, 0], [0, 1, 0], [0, 0, 1]]), sound.faces)
    assert verdicts(tmp_path, machine, leant) == {"MOTION_ERROR"}


# ---- what is refused -------------------------------------------------------------------------------------------------


def test_what_is_wrong_is_told_by_its_keys() -> None:
    with pytest.raises(SpecError) as caught:
        linear(
            geometry={"follower": {"shape": "knife", "radius": 3.0, "start_deg": 5.0}},
            segment=[{"kind": "rise", "span": 20.0}, {"kind": "return", "span": 20.0, "to": 30.0}],
            print={"profile_compensation": 0.05, "shrinkage": 0.003},
            files={"cutter_radius": 4.0, "profile_step_deg": 5.0},
            load={"stiffness": 200.0, "restitution": 0.5, "polydyne": True, "cam_follower": "KR16"},
            limits={"frequency_ratio": 10.0, "bearing_life_h": 100.0, "least_radius": 1.0},
        )
    keys = {fault.key for fault in caught.value.faults}
    assert keys >= {
        "geometry.follower.radius",
        "geometry.follower.start_deg",
        "segment.0.lift",
        "print.profile_compensation",
        "print.shrinkage",
        "load.stiffness",
        "load.restitution",
        "load.polydyne",
        "load.cam_follower",
        "limits.frequency_ratio",
        "limits.bearing_life_h",
        "files.cutter_radius",
        "files.profile_step_deg",
    }
    with pytest.raises(SpecError) as caught:
        linear(geometry={"follower": {"shape": "roller", "motion": "oscillating"}})
    assert {fault.key for fault in caught.value.faults} == {
        "geometry.follower.radius",
        "geometry.follower.arm",
    }


@pytest.mark.parametrize(
    ("tables", "said"),
    [
        ({"geometry": {"follower": {"shape": "roller", "radius": 60.0}}}, "undercut"),
        (
            {
                "segment": [
                    {"kind": "rise", "span": 30.0, "lift": 9.0, "law": "uniform"},
                    {"kind": "dwell", "span": 10.0},
                ]
            },
            "jump of the speed",
        ),
        (
            {
                "geometry": {"follower": {**KNIFE, "start_deg": -70.0}},
                "segment": [{"kind": "return", "span": 8.0, "to": -18.0, "law": "cycloidal"}],
            },
            "carries its tip along",
        ),
    ],
)
def test_no_plate_is_told_as_such(tables: dict[str, Any], said: str) -> None:
    with pytest.raises(DesignError, match=said):
        linear(**tables).limits()


def test_segments_holes_and_edges_that_leave_no_plate_are_told() -> None:
    tiny = [{"kind": "rise", "span": 1e5, "lift": 10.0}, {"kind": "dwell", "span": 1e-3}]
    with pytest.raises(SpecError, match=r"segment\.1\.span: 0\.001 - expected at least 0\.4 mm"):
        linear(segment=tiny)
    # a wall of 0.8 mm beside the hole: 20 - 1.6 under the edge, 16 - 1.6 at the end
    with pytest.raises(SpecError, match=r"parts\.hole: 18 - expected at most 14\.4"):
        linear(parts={"hole": 18.0})
    deep = [{"kind": "return", "span": 60.0, "to": -10.0, "law": "cycloidal"}]
    with pytest.raises(DesignError, match=r"height of the edge is -5 mm") as caught:
        linear(geometry={"height": 5.0}, parts={"hole": 0.0}, segment=deep).limits()
    assert caught.value.value == pytest.approx(-5)


def test_a_hole_that_a_low_edge_leaves_no_wall_is_told() -> None:
    """At the end of the way the edge is 5 mm high, below a hole about 10 mm; 6 mm are high enough for a hole of 4 mm about 3.5 mm."""
    deep = [{"kind": "return", "span": 60.0, "to": -15.0, "law": "cycloidal"}]
    with pytest.raises(DesignError, match=r"wall of the plate .* parts\.hole") as caught:
        linear(geometry={"height": 20.0}, parts={"hole": 5.2}, segment=deep).limits()
    assert caught.value.limit == pytest.approx(0.8)
    low = [{"kind": "return", "span": 60.0, "to": -1.0, "law": "cycloidal"}]
    linear(geometry={"height": 7.0}, parts={"hole": 4.0}, segment=low).limits()


def test_a_steep_plate_fails_by_its_angle_and_radius() -> None:
    tables = {"pressure_angle_deg": 20.0, "least_radius": 40.0}
    failing = {each.code: str(each.where) for each in linear(limits=tables).limits() if not each.ok}
    assert set(failing) == {"PRESSURE_ANGLE", "CURVATURE"}
