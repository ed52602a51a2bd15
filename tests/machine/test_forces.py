"""Forces by the Jacobian: the take-up's cited peaks, today's kinetostatics, power in and out, springs, lift-off by hand."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from chains import CHAINS, Wave, four_bar, ram_machine, scotch_yoke, slider_crank, take_up

from camgen.machine import (
    GROUND,
    Body,
    Cam,
    Drive,
    Force,
    Gravity,
    Machine,
    Pin,
    Place,
    Pose,
    Slide,
    Spring,
    Torque,
    TorsionSpring,
    Turning,
    solve,
)

THETA = np.arange(7200) * math.tau / 7200
FEW = THETA[::100]


@pytest.mark.parametrize(
    ("low", "peaks"), [(True, (80.202, 82.988, 122.607)), (False, (97.430, 92.695, 117.992))]
)
def test_peak_reactions_of_the_take_up(low: bool, peaks: tuple[float, ...]) -> None:
    reactions = solve(take_up(low=low), THETA).forces().reactions
    for name, value in zip("ABC", peaks, strict=True):
        assert np.abs(reactions[name]).max() == pytest.approx(value, abs=6e-4)


def test_balances_of_the_take_up_from_its_points_alone() -> None:
    """F_A + F_C = m2 a2 + m3 a3, accelerations by Fourier; the output crank's moments about C."""
    machine = take_up()
    run = solve(machine, THETA)
    forces, speed = run.forces(), machine.speed
    joints = {joint.name: joint for joint in machine.joints if isinstance(joint, Pin)}
    pull = 0
    for name in ("coupler", "rocker"):
        body = machine.body(name)
        way = np.fft.fft(run.point(name, body.centre)[0] * 1e-3)
        k = np.fft.fftfreq(way.size, 1 / way.size)
        pull = (
            pull + body.mass * np.fft.ifft(np.where(np.abs(k) < 400, -(k**2) * way, 0)) * speed**2
        )
    on = {
        name: forces.reactions[name] * (1 if joints[name].a.body in bodies else -1)
        for name, bodies in {"A": ["coupler"], "C": ["rocker"], "B": ["rocker"]}.items()
    }
    np.testing.assert_allclose(on["A"] + on["C"], pull, atol=1e-8 * np.abs(pull).max())
    np.testing.assert_allclose(forces.shaking, -pull, atol=1e-8 * np.abs(pull).max())
    body = machine.body("rocker")
    arm = (run.point("rocker", "B")[0] - run.point("rocker", "C")[0]) * 1e-3
    alpha = run.angle("rocker")[2] * speed**2
    about_c = (np.conj(arm) * on["B"]).imag
    np.testing.assert_allclose(
        about_c, (body.inertia + body.mass * (abs(body.centre) * 1e-3) ** 2) * alpha, atol=1e-10
    )


@pytest.mark.parametrize("offset", [0.0, 7.0])
def test_slider_crank_against_newton(offset: float) -> None:
    masses = {
        "crank": {"mass": 2e-3, "centre": 0.7 + 0.2j, "inertia": 1e-8},
        "rod": {"mass": 3e-3, "centre": 20 + 1j, "inertia": 2e-7},
        "ram": {"mass": 4e-3, "centre": 3j},
    }
    machine = slider_crank(1.5, 48, offset, masses=masses, speed=1361.357)
    run = solve(machine, FEW)
    forces, pull = run.forces(), 4e-3 * run.derivatives("way")[2] * 1e-3 * machine.speed**2
    sign = 1 if machine.joint("B").a.body == "ram" else -1  # type: ignore[union-attr]
    pin = sign * forces.reactions["B"]
    np.testing.assert_allclose(pin.real, pull, atol=1e-9 * np.abs(pull).max())
    np.testing.assert_allclose(forces.normals["guide"], -pin.imag, atol=1e-9)
    # the inertia acts 3 mm to the left of the pin, both forces on the slider act at the pin
    np.testing.assert_allclose(forces.moments["guide"], -3e-3 * pull, atol=1e-10)


@pytest.mark.parametrize("name", CHAINS)
def test_power_in_is_power_out(name: str) -> None:
    machine = CHAINS[name]()
    masses = tuple(replace(b, mass=0.05, centre=5 + 2j, inertia=1e-5) for b in machine.bodies)
    base = Machine(
        masses,
        machine.joints,
        machine.drives,
        machine.start,
        (*machine.loads, Gravity()),
        machine.outputs,
        12.0,
    )
    theta = np.linspace(0.2, 3.8, 50)
    forces = solve(base, theta).forces()
    size = np.abs(forces.power).max() + np.abs(forces.loads).max()
    assert size > 1e-6
    np.testing.assert_allclose(
        forces.power_in + forces.loads, forces.power, atol=1e-12 * max(size, 1)
    )
    h = 1e-4  # the rate from the energy itself
    ahead, behind = (solve(base, theta + s * h).forces().energy for s in (1, -1))
    np.testing.assert_allclose((ahead - behind) / (2 * h) * 12.0, forces.power, atol=1e-5 * size)


def test_ram_machine_balances_to_rounding() -> None:
    forces = solve(ram_machine(), FEW).forces()
    np.testing.assert_allclose(forces.power_in + forces.loads, forces.power, atol=1e-12)
    assert np.abs(forces.power_in).max() > 0.05


def test_scotch_yoke_torque_and_pin_by_hand() -> None:
    forces = solve(scotch_yoke(10.0), FEW).forces()
    push = -0.2 * 0.010 * 49.0 * np.cos(FEW)  # m a of the yoke, N
    torque = push * -0.010 * np.sin(FEW)
    np.testing.assert_allclose(forces.drives["motor"], torque, atol=1e-15)
    np.testing.assert_allclose(np.abs(forces.normals["slot"]), np.abs(push), atol=1e-13)
    np.testing.assert_allclose(forces.normals["guide"], 0, atol=1e-13)


def test_torque_torsion_spring_and_weight_on_one_arm() -> None:
    bodies = (Body(GROUND), Body("arm", {}, 2.0, 100 + 0j, 0.01))
    loads = (
        Torque("brake", "arm", -0.7),
        TorsionSpring("coil", "arm", GROUND, 0.5, 0.2),
        Gravity(-10j),
    )
    machine = Machine(
        bodies,
        (Pin("O", Place("arm"), Place(GROUND)),),
        (Drive("motor", "arm"),),
        {"arm": Pose(0j, 0.0)},
        loads,
        speed=3.0,
    )
    forces = solve(machine, FEW).forces()
    np.testing.assert_allclose(
        forces.drives["motor"], 0.7 + 0.5 * (FEW - 0.2) + 2 * 10 * 0.1 * np.cos(FEW), atol=1e-13
    )
    wanted = 20j - 2 * 0.1 * 9 * np.exp(1j * FEW)
    np.testing.assert_allclose(forces.reactions["O"], wanted, atol=1e-13)
    np.testing.assert_allclose(forces.energy, 0.5 * (0.01 + 2 * 0.01) * 9, atol=1e-15)


def follower(spring: float, preload: float) -> Machine:
    """A cam lifts a sliding mass by 5 - 5 cos; a spring presses it back."""
    bodies = (Body(GROUND), Body("cam"), Body("tappet", {}, 0.5))
    joints = (
        Pin("O", Place("cam"), Place(GROUND)),
        Slide("guide", Place(GROUND), Place("tappet"), angle=math.pi / 2, turn=0.0),
        Cam(
            "contact",
            "cam",
            "tappet",
            Wave(5.0, -5.0),
            "guide",
            rest=30.0,
            closure="force",
            leaves=1,
        ),
    )
    start = {"cam": Pose(0j, 0.0), "tappet": Pose(30j, 0.0)}
    free = 70 + preload / spring
    loads = (Spring("spring", Place("tappet"), Place(GROUND, 100j), spring, free),)
    return Machine(bodies, joints, (Drive("motor", "cam", Turning()),), start, loads, speed=40.0)


def test_contact_force_and_lift_off_of_a_cam_by_hand() -> None:
    machine = follower(0.2, 1.0)
    force = solve(machine, FEW).forces()
    way, pull = 5 - 5 * np.cos(FEW), 5 * np.cos(FEW)
    wanted = 0.5 * pull * 1e-3 * 1600 + 1.0 + 0.2 * way
    np.testing.assert_allclose(force.contacts["contact"], wanted, atol=1e-12)
    # 4 cos + 2 - cos = 0: where it lifts off
    edges = np.array([1, -1]) * math.acos(-2 / 3)
    np.testing.assert_allclose(solve(machine, edges).forces().contacts["contact"], 0, atol=1e-12)
    # The torque on the shaft is the contact's work.
    np.testing.assert_allclose(force.drives["motor"], wanted * 5e-3 * np.sin(FEW), atol=1e-14)


def test_a_constant_force_reaches_the_motor_by_virtual_work() -> None:
    machine = replace(slider_crank(10, 40), loads=(Force("work", Place("ram"), -25 + 3j),))
    run = solve(machine, FEW)
    forces = run.forces()
    np.testing.assert_allclose(
        forces.drives["motor"], 25e-3 * run.derivatives("way")[1], atol=1e-13
    )
    np.testing.assert_allclose(forces.normals["guide"] + forces.reactions["O"].imag, -3, atol=1e-11)


def test_reactions_scale_with_the_square_of_the_speed_and_a_wrong_mass_is_seen() -> None:
    slow, fast = (
        solve(replace(take_up(), speed=s), FEW).forces().reactions for s in (100.0, -300.0)
    )
    for point in "OABC":
        np.testing.assert_allclose(fast[point], 9 * slow[point], rtol=1e-9, atol=1e-12)
    machine = take_up()
    heavy = tuple(replace(b, mass=0.0084) if b.name == "rocker" else b for b in machine.bodies)
    peak = np.abs(solve(replace(machine, bodies=heavy), THETA).forces().reactions["C"]).max()
    assert peak != pytest.approx(122.607, abs=6e-4)


def test_no_forces_at_a_dead_point() -> None:
    machine = four_bar(40, 25, 30, 32)  # opens on the way round
    forces = solve(machine, THETA[::50]).forces()
    lost = np.isnan(solve(machine, THETA[::50])["rocker"])
    assert (
        lost.any()
        and (np.isnan(forces.power_in) == lost).all()
        and (np.isnan(forces.energy) == lost).all()
    )
