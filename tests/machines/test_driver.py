"""The two-crank chain before the indexing cam: its geometry, the same motion of the link by other cams, what is gained."""

from __future__ import annotations

import math
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from judged import wrong

from camgen.errors import DesignError, SpecError
from camgen.files.threemf import PartCopy, write_3mf
from camgen.geometry.mesh import placing
from camgen.judge.assembly import sweep
from camgen.machine.run import solve
from camgen.machines.indexing_cam.driver import TwoCranks
from camgen.machines.indexing_cam.mechanism import IndexingCam
from camgen.parts.assembly import bodies_in_motion
from camgen.parts.solids import solid
from camgen.pipeline.build import build
from camgen.reading import read
from camgen.spec import validate

SPECS = Path(__file__).resolve().parents[2] / "specs"
THETA = np.radians(np.arange(0.5, 360.0, 1.0))


def design(**tables: Any) -> IndexingCam:
    data = read(SPECS / "indexing-cam.toml")
    for name, table in tables.items():
        data[name] = {**data.get(name, {}), **table}
    return validate(IndexingCam, data)


def test_angles_of_crank_and_arm_by_the_pins_place() -> None:
    """The pin, 20 from P at the crank's angle, is seen from Q, 8 beside P, under the arm's; slopes against differences."""
    chain = TwoCranks(20.0, 8.0, math.radians(120), 1, 0j)
    psi = np.linspace(-3.0, 3.0, 61)
    tau = chain.tau(psi)
    seen = 20 * np.exp(1j * tau[0]) - 8
    assert np.max(np.abs(np.imag(seen * np.exp(-1j * psi)))) < 1e-12 and np.all(
        np.real(seen * np.exp(-1j * psi)) > 0
    )
    for order in (1, 2, 3):
        slope = (chain.tau(psi + 1e-5)[order - 1] - chain.tau(psi - 1e-5)[order - 1]) / 2e-5
        assert tau[order] == pytest.approx(slope, abs=1e-8)
    assert 1 / chain.tau(np.zeros(1))[1][0] == pytest.approx(
        20 / 12
    )  # d psi / d tau where the pin is nearest to Q
    assert 1 / chain.tau(np.full(1, math.pi))[1][0] == pytest.approx(20 / 28)


@pytest.mark.parametrize("rpm", [30.0, -30.0])
def test_the_link_moves_as_by_the_even_drive(rpm: float) -> None:
    even, uneven = (
        design(motor={"speed_rpm": rpm}),
        design(motor={"speed_rpm": rpm}, driver={"offset": 8.0}),
    )
    a, b = even.solve(THETA), uneven.solve(THETA)
    for order in range(3):
        assert b.derivatives("link")[order] == pytest.approx(
            a.derivatives("link")[order], abs=1e-10
        )
    # by its own route, the fastest in the middle of each turn: 20 / (20 - 8) of the mean
    cam = b.angle("cam")
    middle = np.radians([60.0, 240.0] if rpm > 0 else [300.0, 120.0])
    assert uneven.solve(middle).angle("cam")[1] == pytest.approx([5 / 3, 5 / 3])
    assert cam[0] - cam[0][0] == pytest.approx(
        uneven.two_cranks.cam(THETA) - uneven.two_cranks.cam(THETA)[0]
    )  # type: ignore[union-attr]
    swings = [solve(each.assembly.exact, THETA, 0)["swing"] for each in (uneven, even)]
    assert swings[0] == pytest.approx(swings[1])


@pytest.mark.long
def test_cams_become_smaller_and_the_range_wider_at_the_same_acceleration() -> None:
    """What the source says of the uneven drive. The peak acceleration is the law's, 6.1501 by the corrected card, in each row:
    6.1501 * 180 deg / (2/3 s)^2. Sizes and ratios found are those at which specs made of them reach the 45 deg."""
    even, *uneven = [table for table in design().study().tables if "two-crank" in table.title][
        0
    ].rows
    assert even[0] == 0 and [row[0] for row in uneven] == [0.2, 0.3, 0.4]
    for row in (even, *uneven):
        assert row[6] == pytest.approx(6.1501 * 180 * 2.25, rel=2e-5)
        assert row[1] == pytest.approx(1 / (1 - row[0]))
        driver = {"driver": {"crank": 20.0, "offset": 20.0 * row[0]}} if row[0] else {}
        rise = 180 * row[5] / (1 + row[5])
        fast = design(geometry={"rise_deg": rise, "dwell_deg": 180 - rise}, **driver)
        assert fast.cams["cam"].steepest == pytest.approx(45.0, abs=0.05)
        assert design(geometry={"base_radius": row[4]}, **driver).cams[
            "cam"
        ].steepest == pytest.approx(45.0, abs=0.05)
        assert design(**driver).cams["cam"].steepest == pytest.approx(row[3], abs=0.01)
    for row in uneven:
        assert all(row[k] < even[k] for k in (3, 4, 5, 7, 8))


@pytest.mark.long
def test_torque_on_the_cams_shaft_is_that_of_the_machine() -> None:
    """Power: what the drive of the model gives at its crank, which turns twice as fast, is what the cam's shaft takes."""
    made = design(driver={"offset": 8.0})
    own = next(
        row
        for table in made.study().tables
        if "two-crank" in table.title
        for row in table.rows
        if row[0] == 0.4
    )
    theta = np.linspace(0, math.tau, 1441)[1:-1]
    run = solve(made.model, theta)
    taken = 2 * run.forces().drives["drive"] / run.angle("cam")[1]
    turning = np.abs(run.derivatives("swing")[1]) > 1e-6
    assert np.max(np.abs(taken[turning])) == pytest.approx(own[8], rel=1e-3)


@pytest.mark.long
def test_files_of_a_cam_that_turns_unevenly(built: Callable[..., Path], tmp_path: Path) -> None:
    """Green as made; with the even drive's outline in place of its own the motion is wrong."""
    report = build(SPECS / "indexing-cam.toml", tmp_path, frozenset({"dxf"}), ["driver.offset=8"])
    assert report.ok, [finding for finding in report.findings if not finding.ok]
    folder = tmp_path / "indexing-cam"
    shutil.copy(built("indexing-cam") / "indexing-cam-cam.dxf", folder)
    assert "MOTION_ERROR" in {finding.code for finding in wrong(folder, "dxf")}


@pytest.mark.parametrize(
    ("tables", "said"),
    [
        (
            {"driver": {"offset": 16.5}},
            r"driver.offset: 16.5 - expected at most 0.8 of the crank, 20 mm",
        ),
        (
            {"driver": {"offset": 8.0}, "geometry": {"dwell_deg": 50.0}},
            r"geometry.dwell_deg: 50 - expected 180 less rise_deg",
        ),
        (
            {"driver": {"offset": 8.0}, "geometry": {"return_deg": 100.0}},
            "geometry.return_deg: 100 - expected rise_deg, 120",
        ),
        (
            {"driver": {"offset": 12.0}, "parts": {"make": "printed"}},
            "driver.offset: 12 - expected at most 11.* wall of 2 mm",
        ),
    ],
)
def test_what_does_not_go_with_the_chain_is_told(tables: dict[str, Any], said: str) -> None:
    with pytest.raises(SpecError, match=said):
        design(**tables)


def test_a_program_that_is_not_the_same_there_and_back_has_no_comparison() -> None:
    titles = [table.title for table in design(geometry={"dwell_deg": 50.0}).study().tables]
    assert not any("two-crank" in title for title in titles)


# ---- made -------------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def made() -> IndexingCam:
    return design(driver={"offset": 8.0}, parts={"make": "printed"})


@pytest.mark.long
def test_the_made_chain_moves_the_link_as_the_drawn_one(made: IndexingCam) -> None:
    """With two wheels in place of a belt the arm turns against the cam; crank and arm by the pin's place on the ground."""
    run, drawn = made.solve(THETA, 1), design(driver={"offset": 8.0}).solve(THETA, 1)
    for order in (0, 1):
        assert run.derivatives("link")[order] == pytest.approx(
            drawn.derivatives("link")[order], abs=1e-9
        )
    assert np.mean(run.angle("crank")[1]) == pytest.approx(-2) and np.mean(
        run.angle("arm")[1]
    ) == pytest.approx(-2, abs=1e-4)
    assert run.angle("cam")[0] - run.angle("cam")[0][0] == pytest.approx(
        (run.angle("arm")[0] - run.angle("arm")[0][0]) / -2
    )
    pin = (
        run.point("crank", "pin")[0] - 60
    )  # the arm's axle is half way to the follower's, 120 from the cam's
    assert np.abs(pin * np.exp(-1j * run.angle("arm")[0])) == pytest.approx(
        np.real(pin * np.exp(-1j * run.angle("arm")[0]))
    )


@pytest.mark.long
def test_crank_and_arm_hang_under_the_plate(made: IndexingCam) -> None:
    """From above: plate, arm at the end of its shaft, 15 under it, crank, bracket; posts between, a screw through each."""
    parts, ways = (
        {part.name: part for part in made.assembly.parts},
        {mount.part: mount for mount in made.assembly.mounts},
    )
    low, high = ({name: ways[name].z + k * parts[name].thickness for name in ways} for k in (0, 1))
    assert (
        low["driver-arm"] == pytest.approx(-15)
        and high["driver-arm"] == pytest.approx(-11)
        and high["driver-crank"] <= -15
    )
    assert high["post"] == pytest.approx(0) and low["post"] == pytest.approx(high["bracket"])
    assert high["bracket"] < low["driver-crank"]
    assert parts["post"].count == 4 and parts["driver-crank"].process == "printed"
    bought = {each.name: each for each in made.assembly.bought}
    assert bought["screw of a post"].count == 4 and "60" in bought["drive"].size
    assert {"motor", "block", "arm", "two_to_one"} <= {
        getattr(each, "joint", "") for each in made.assembly.features
    }
    total = sum(mount.body == "arm" for mount in made.assembly.mounts)
    assert total == 4 and made.model.body("arm").mass > 0  # wheel, shaft, collar, arm
    assert any("bracket below" in note for note in made.study().notes)


@pytest.mark.long
def test_a_motor_turns_the_crank_under_its_bracket() -> None:
    spec = design(
        driver={"offset": 8.0},
        parts={"make": "printed", "motor": "nema-17", "shaft_diameter": 5.0},
        motor={"model": "17HS19-2004S1"},
    )
    assert (
        len(next(part for part in spec.assembly.parts if part.name == "bracket").layers) == 2
    )  # pockets of its screws
    assert not any(part.name == "driver-shaft" for part in spec.assembly.parts) and any(
        part.name == "shaft" for part in spec.assembly.parts
    )
    (motor,) = spec.assembly.stand_ins
    assert motor.discs[0][3] == pytest.approx(
        min(mount.z for mount in spec.assembly.mounts if mount.part == "bracket")
    )


@pytest.mark.long
def test_a_shaft_too_short_for_what_lies_under_the_plate_is_told() -> None:
    short = design(driver={"offset": 8.0}, parts={"make": "printed", "shaft_length": 9.0})
    with pytest.raises(DesignError, match="parts.shaft_length.*make it longer"):
        _ = short.assembly


@pytest.mark.long
@pytest.mark.parametrize(("part", "raised"), [("", 0.0), ("driver-crank", 2.0)])
def test_a_crank_that_meets_its_arm_is_found(
    tmp_path: Path, made: IndexingCam, part: str, raised: float
) -> None:
    items, poses = [], made.assembly.poses(np.zeros(1))
    kept = [
        each for each in made.assembly.parts if each.name.startswith(("driver", "bracket", "post"))
    ]
    for each in kept:
        for k, pose in enumerate(poses[each.name]):
            z = pose.z + raised * (each.name == part)
            where = placing(
                float(pose.angle[0]), complex(pose.place[0]), z, each.thickness, pose.flipped
            )
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
    assert ({"driver-arm-1", "driver-crank-1"} in failed) if part else not failed
