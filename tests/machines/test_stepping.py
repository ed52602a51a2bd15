"""A link that turns on behind a freewheel: its steps and torques by hand, its parts, what is told, and damage that is found."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from camgen.errors import DesignError, SpecError
from camgen.files.threemf import PartCopy, write_3mf
from camgen.findings import Where
from camgen.geometry.mesh import placing
from camgen.judge.assembly import sweep
from camgen.machine.closing import close
from camgen.machine.constraints import Constraints
from camgen.machine.features import GearTeeth, PinEyes
from camgen.machine.joining import Module
from camgen.machine.model import Clutch
from camgen.machine.run import solve
from camgen.machine.targets import Advance, Course, advance
from camgen.machines.indexing_cam.mechanism import IndexingCam
from camgen.parts.assembly import Cycle, bodies_in_motion, order_of_assembly
from camgen.parts.solids import solid
from camgen.pipeline.build import build
from camgen.pipeline.curves import Curves
from camgen.pipeline.shown import animation
from camgen.reading import read
from camgen.spec import validate

SPECS = Path(__file__).resolve().parents[2] / "specs"
SETTINGS = {
    "freewheel": {"lost_deg": 1.0},
    "unloader": {"lead_deg": 10.0, "stiffness_n_mm": 0.45},
    "load": {"inertia_kg_m2": 0.03, "friction_n_m": 0.45},
    "limits": {"residual": 0.8},
}


def design(make: str = "cams", **tables: Any) -> IndexingCam:
    data = read(SPECS / "indexing-cam.toml")
    data["parts"]["make"] = make
    for more in (SETTINGS, tables):
        for name, table in more.items():
            data[name] = {**data.get(name, {}), **table}
    return validate(IndexingCam, data)


@pytest.fixture(scope="module")
def made() -> IndexingCam:
    return design("printed")


def verdicts(spec: IndexingCam, code: str) -> list[tuple[bool, float]]:
    return [(f.ok, f.measured) for f in spec.limits() if f.code == code]


# ---- motion -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("sense", [1, -1])
def test_the_link_turns_on_by_half_a_turn_and_stands(sense: int) -> None:
    """The follower swings 181 / 6 deg, the wheel 181; the link goes with it but for the first degree, and comes 180 a turn."""
    spec = design(motor={"speed_rpm": 30.0 * sense})
    assert math.degrees(spec.swing) == pytest.approx(181 / 6)
    times = np.array([0.0, 60.0, 120.0, 240.0, 359.0, 360.0, 420.0, 480.0, 719.0])
    run = spec.solve(np.radians(sense * times), 0)
    turned = np.degrees(np.abs(run["link"]))
    assert turned == pytest.approx([0, 89.5, 180, 180, 180, 180, 269.5, 360, 360])
    assert np.all(
        np.diff(sense * -run["link"]) * sense >= -1e-12
    )  # the same way whichever way the cam turns
    wheel = run["wheel"] - run["wheel"][0]
    assert np.degrees(np.abs(wheel[:5])) == pytest.approx([0, 90.5, 181, 90.5, 0], abs=1e-9)


@pytest.mark.parametrize("sense", [1, -1])
def test_the_linkage_that_it_is_moves_by_its_closed_forms(sense: int) -> None:
    """Program of the cam and steps of the link, by the tables of a linkage alone."""
    spec = design(motor={"speed_rpm": 30.0 * sense})
    theta = np.radians(np.arange(0.5, 720.0, 1.0))
    run = spec.linkage.run(theta)
    assert spec.stepping is not None
    for order in range(3):
        assert run.derivatives("swing")[order] == pytest.approx(
            spec.program(theta, order), abs=1e-9
        )
        link = spec.stepping(theta, order)
        assert run.derivatives("link")[order] == pytest.approx(link, abs=1e-9)


def test_the_judges_route_and_the_makers_agree(made: IndexingCam) -> None:
    """All joints closed at once, from the drawn position, against the chain of closed forms; and rates by differences."""
    theta = np.radians(np.arange(0.5, 360.0, 3.0))
    closed = close(Constraints(made.model), theta)
    run = made.solve(theta, 1)
    assert closed.q == pytest.approx(run.poses(), abs=1e-8)
    rate = run.derivatives("link")[1]
    near = (made.solve(theta + 1e-6, 0)["link"] - made.solve(theta - 1e-6, 0)["link"]) / 2e-6
    assert rate == pytest.approx(near, abs=1e-6)


def test_the_speed_of_what_turns_on_has_no_step_where_the_turn_ends(made: IndexingCam) -> None:
    """The curve is the model's own derivative, and 0 where the link stands; it says in which sense the link turns."""
    assert made.stepping is not None
    theta = np.linspace(0.0, math.tau, 1441)
    link = next(output for output in made.model.outputs if output.name == "link")
    curves = Curves(link, theta, Cycle(), False, cams=True)
    curves.want(made.stepping(theta), None)
    course, speed = curves.plots()
    exact = np.degrees(made.stepping(theta, 1))
    assert (
        np.abs(speed.series[0][2] - exact).max() < 0.1 * np.abs(exact).max()
    )  # a mean rounds the corner of the lock
    assert np.abs(speed.series[0][2][-100:-20]).max() == 0
    assert course.y_label == "deg, −180 from end to end: clockwise" and speed.y_label.startswith(
        "deg/rad, mean"
    )


def test_torque_in_the_freewheel_by_hand(made: IndexingCam) -> None:
    """J w' + friction - spring, by the law's derivatives and a pin on a circle about the crank's axis; what the machine's own
    forces say of the clutch; the cam bears no more than the follower's and the wheel's parts while that goes back."""
    theta = np.radians(np.arange(20.0, 120.0, 5.0))
    spec = design()
    kappa = theta / math.radians(120)
    a = (181 * spec.law(kappa) - 1) / 180
    phi = np.radians(-10 + 360 * a)
    cord = np.sqrt(30**2 + 120**2 + 2 * 30 * 120 * np.cos(phi))
    spring = 0.45 * (6 + cord - 90) * 30 * 120 * np.sin(phi) / cord * 2e-3
    period = 120 / 360 / 30 * 60
    wanted = 0.03 * math.radians(181) / period**2 * spec.law(kappa, 2) + 0.45 - spring
    assert -solve(spec.model, theta).forces().gears["freewheels"] == pytest.approx(wanted, abs=1e-6)
    back = solve(spec.model, np.radians(np.arange(190.0, 300.0, 10.0))).forces()
    assert np.abs(back.gears["gears"]).max() < 1e-9
    held = 0.45 * (6 + abs(30 * np.exp(1j * math.radians(10)) + 120) - 90)
    held *= (
        30 * 120 * math.sin(math.radians(10)) / abs(30 * np.exp(1j * math.radians(10)) + 120) * 2e-3
    )
    assert np.abs(back.gears["freewheels"]) == pytest.approx(held, rel=1e-6)


def test_what_is_left_for_the_freewheels_is_judged() -> None:
    """The friction that is called for is just enough, without the unloader four times as much; a link that a process turns on,
    torque beyond the clutch's, are found."""
    spec = design()
    numbers = spec.study().numbers
    needed = numbers["brake_needed_n_m"]
    assert numbers["brake_needed_without_unloader_n_m"] > 3 * needed
    assert all(
        ok for ok, _ in verdicts(design(load={"friction_n_m": 1.001 * needed}), "FORCE_CLOSURE")
    )
    assert [
        ok for ok, _ in verdicts(design(load={"friction_n_m": 0.999 * needed}), "FORCE_CLOSURE")
    ] == [False, True]
    (_, hold) = verdicts(spec, "FORCE_CLOSURE")[1]
    for share, fine in ((0.999, True), (1.001, False)):
        assert (
            verdicts(design(load={"dwell_torque_n_m": share * hold}), "FORCE_CLOSURE")[1][0] == fine
        )
    assert (
        verdicts(spec, "CLUTCH_TORQUE")[0][0]
        and not verdicts(design(load={"inertia_kg_m2": 0.06}), "CLUTCH_TORQUE")[0][0]
    )
    kappa = np.linspace(0, 0.2, 20_001)
    locks = np.interp(1 / 181, spec.law(kappa), kappa)  # one degree of 181
    assert numbers["locking_speed_deg_s"] == pytest.approx(
        181 * float(spec.law(locks, 1)) / (2 / 3), rel=1e-3
    )
    assert numbers["dwell_share_ratio"] == pytest.approx(1 - 120 / 360, abs=0.03)


# ---- advance ----------------------------------------------------------------------------------------------------------


def test_advance_of_a_freewheel() -> None:
    """It locks `lost` past the lowest; small waves, less than that, do not turn it on; what swings less than that never locks."""
    t = np.linspace(0, math.tau, 2001)
    swing = 10 * (1 - np.cos(t))
    assert advance(swing, 0.0) == pytest.approx(20.0, abs=1e-4)
    assert advance(swing, 3.0) == pytest.approx(17.0, abs=1e-4)
    assert advance(-swing, 3.0) == pytest.approx(17.0, abs=1e-4)
    still = np.where(np.abs(t - math.pi) < 1.5, 20.0, 0.0)
    assert advance(still + 0.4 * np.sin(200 * t), 1.0) == pytest.approx(19.8, abs=0.05)
    assert advance(0.4 * np.sin(5 * t), 1.0) == 0.0


def test_a_wheel_that_swings_too_far_or_too_little_is_found() -> None:
    wanted, t = (
        Advance(value=180, tolerance=0.05, lost=1, forwards=-1, time=1),
        np.linspace(0, math.tau, 1441),
    )

    def found(far: float) -> bool:
        value = -far / 2 * (1 - np.cos(t))
        return wanted.finding(Course(t, value, -far / 2 * np.sin(t), "deg", True), Where("x")).ok

    assert found(181.0) and found(181.04) and not found(181.06) and not found(180.9)


# ---- parts ------------------------------------------------------------------------------------------------------------


def test_shaft_and_wheel_run_in_clutches(made: IndexingCam) -> None:
    """Two of one kind, in the plate and the wheel, as thick as they are; a round steel rod through both, its flat above them."""
    parts = {part.name: part for part in made.assembly.parts}
    clutch = parts["bearing-hfl0615"]
    assert (clutch.count, clutch.process, clutch.thickness) == (2, "bought", 15.0)
    assert parts["ground"].thickness == parts["gear-gears-drive_wheel"].thickness == 15.0
    rod, flat = parts["shaft-driven_link"].layers
    assert len(rod.region.outer.pieces) < len(flat.region.outer.pieces)
    assert (
        parts["shaft-driven_link"].process == "bought"
        and parts["collar-driven_link"].bore == parts["collar"].bore
    )
    ways = {mount.part: mount for mount in made.assembly.mounts}
    top = ways["shaft-driven_link"].z + flat.z0
    assert (
        top >= ways["gear-gears-drive_wheel"].z + 15
        and ways["gear-unloader_gears-driven_link"].z >= top
    )
    pin = next(
        f
        for f in made.assembly.features
        if isinstance(f, PinEyes) and f.joint == "axle of drive_wheel"
    )
    assert len(pin.rings) == 2 and pin.pin is not None and pin.pin.part == "shaft-driven_link"
    assert len(parts["driven_link"].layers[0].region.holes) == 2  # shaft and mark
    gear = next(
        f for f in made.assembly.features if isinstance(f, GearTeeth) and f.joint == "gears"
    )
    assert "axle of drive_wheel" in gear.turns
    rows = [row[1] for row in order_of_assembly(made.assembly).rows]
    assert rows.index("bearing-hfl0615") < rows.index("gear-gears-drive_wheel")


@pytest.mark.parametrize(
    ("part", "turned", "raised", "pair"),
    [
        ("", 0.0, 0.0, None),
        (
            "gear-gears-drive_wheel",
            math.pi / 22,
            0.0,
            {"gear-gears-follower-1", "gear-gears-drive_wheel-1"},
        ),
    ],
)
def test_a_wheel_out_of_place_is_found(
    tmp_path: Path,
    made: IndexingCam,
    part: str,
    turned: float,
    raised: float,
    pair: set[str] | None,
) -> None:
    items, poses = [], made.assembly.poses(np.zeros(1))
    kept = [
        each
        for each in made.assembly.parts
        if each.name.startswith(("ground", "gear-gears", "shaft-driven", "bearing"))
    ]
    for each in kept:
        for k, pose in enumerate(poses[each.name]):
            angle, z = (
                float(pose.angle[0]) + turned * (each.name == part),
                pose.z + raised * (each.name == part),
            )
            where = placing(angle, complex(pose.place[0]), z, each.thickness, pose.flipped)
            items.append(PartCopy(each.name, f"{each.name}-{k + 1}", where))
    write_3mf(tmp_path / "x.3mf", {each.name: solid(each, 0.02) for each in kept}, items, "key")
    moved, names = bodies_in_motion(made.assembly), {each.name for each in kept}
    moved = replace(
        moved,
        mounts=[each for each in moved.mounts if each.part in names],
        stand_ins=[],
        tolerance=0.02,
    )
    failed = [
        set(str(f.where).partition(":")[0].split(" and "))
        for f in sweep(tmp_path / "x.3mf", moved)[0]
        if not f.ok
    ]
    assert (pair in failed) if pair else not failed


@pytest.mark.long
def test_files_of_cams_alone(tmp_path: Path) -> None:
    """What the outlines give, as figures; a cam for another swing is found."""
    path = SPECS / "indexing-cam.toml"
    keys = [
        "freewheel.lost_deg=1",
        "unloader.lead_deg=10",
        "unloader.stiffness_n_mm=0.45",
        "load.inertia_kg_m2=0.03",
        "load.friction_n_m=0.45",
        "limits.residual=0.8",
    ]
    report = build(path, tmp_path, frozenset({"dxf"}), keys)
    assert report.ok, [finding for finding in report.findings if not finding.ok]
    assert report.numbers["index_recovered_dxf_deg"] == pytest.approx(180, abs=0.01)
    assert any("behind its freewheel" in table.title for table in report.tables)


# ---- refusals ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("tables", "said"),
    [
        (
            {
                "unloader": {
                    "torque": "law",
                    "crank": None,
                    "guide": None,
                    "stretch": None,
                    "lead_deg": None,
                    "stiffness_n_mm": None,
                }
            },
            'unloader.torque.*"crank" or "none" with',
        ),
        (
            {"parts": {"shaft_diameter": 7.0}},
            "parts.shaft_diameter: 7 - expected a bore of freewheels, 6, 8, 10 mm",
        ),
        ({"freewheel": {"lost_deg": 50.0}}, "freewheel.lost_deg"),
    ],
)
def test_what_cannot_turn_on_is_told(tables: dict[str, Any], said: str) -> None:
    given = {
        name: {k: v for k, v in table.items() if v is not None} for name, table in tables.items()
    }
    data = read(SPECS / "indexing-cam.toml")
    for more in (SETTINGS, given):
        for name, table in more.items():
            data[name] = {**data.get(name, {}), **table}
    for name, table in tables.items():
        for key in [key for key, value in table.items() if value is None]:
            data[name].pop(key, None)
    with pytest.raises(SpecError, match=said):
        validate(IndexingCam, data)


def test_a_plate_thinner_than_its_clutch_is_told_with_the_benchs_key() -> None:
    with pytest.raises(DesignError, match="parts.base_thickness is 8 mm.*limit: at least 15 mm"):
        _ = design("printed", parts={"base_thickness": 8.0}).assembly


def test_the_clutch_is_a_joint_of_two_bodies(made: IndexingCam) -> None:
    (clutch,) = [joint for joint in made.model.joints if isinstance(joint, Clutch)]
    apart = clutch.apart(np.radians([1.0, 60.0, 200.0, 420.0]))
    assert list(np.isnan(apart)) == [True, False, True, False]
    assert math.degrees(apart[3] - apart[1]) == pytest.approx(-180)


def test_the_picture_goes_on_over_two_turns(made: IndexingCam) -> None:
    """Frames of two turns, after which the table is where it was; of a link that goes to and fro those of one."""
    shown = animation(made, ())
    assert (len(shown.theta), shown.turns) == (240, 2)
    table = next(body for body in shown.bodies if body.name == "driven_link").poses[0]
    assert np.degrees(table.angle)[[0, 60, 119, 180, 239]] == pytest.approx(
        [0, -180, -180, -360, -360]
    )
    assert (
        made.assembly.cycle.turns == 2
        and validate(IndexingCam, read(SPECS / "indexing-cam.toml")).assembly.cycle.turns == 1
    )


def test_as_a_module_it_is_so_far_ahead(made: IndexingCam) -> None:
    """A quarter of a turn ahead on another shaft: all joints close, and the table is where it is at that angle."""
    machine = Module("m", 0j, math.radians(90)).machine(made.model)
    theta = np.radians(np.arange(0.5, 720.0, 31.0))
    run = solve(machine, theta, 0)
    assert np.abs(Constraints(machine).evaluate(run.poses(), theta)[0]).max() < 1e-9
    table = next(body.name for body in machine.bodies if body.name.endswith("driven_link"))
    assert run.angle(table)[0] == pytest.approx(made.solve(theta + math.radians(90), 0)["link"])
