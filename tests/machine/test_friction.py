"""Friction of joints against closed forms: journal, incline, rod between two friction circles, wedge; where it locks."""

from __future__ import annotations

import cmath
import math
from dataclasses import replace

import numpy as np
import pytest
from chains import CHAINS, slider_crank

from camgen.machine import (
    GROUND,
    Body,
    Drive,
    Force,
    Gravity,
    Machine,
    Pin,
    Place,
    Pose,
    Slide,
    Slot,
    Spring,
    Turning,
    solve,
)
from camgen.machine.flywheel import spring_on_shaft
from camgen.machine.friction import circle, smooth

FEW = np.linspace(0.1, math.tau + 0.1, 73)
SLOW = 1e-6


@pytest.mark.parametrize("speed", [SLOW, -SLOW])
def test_weight_on_a_journal(speed: float) -> None:
    """Torque = m g (e cos theta + r sin phi, against the turning)."""
    bodies = (Body(GROUND), Body("arm", {}, 2.0, 30 + 0j, 0.0))
    pin = Pin("O", Place("arm"), Place(GROUND), friction=circle(5.0, 0.3))
    machine = Machine(
        bodies,
        (pin,),
        (Drive("motor", "arm"),),
        {"arm": Pose(0j, 0.0)},
        (Gravity(-10j),),
        speed=speed,
    )
    forces = solve(machine, FEW).forces()
    friction = 5e-3 * math.sin(math.atan(0.3)) * 20.0
    np.testing.assert_allclose(
        forces.drives["motor"], 20 * 0.03 * np.cos(FEW) + math.copysign(friction, speed), atol=1e-12
    )
    np.testing.assert_allclose(forces.smooth["motor"], 20 * 0.03 * np.cos(FEW), atol=1e-12)
    np.testing.assert_allclose(forces.rubs, friction * abs(speed), rtol=1e-9)


def incline(mu: float, speed: float = SLOW, angle: float = 0.5) -> Machine:
    bodies = (Body(GROUND), Body("block", {}, 3.0))
    slide = Slide("plane", Place(GROUND), Place("block"), angle=angle, turn=0.0, friction=mu)
    drive = Drive("pull", "block", Turning(10.0), slide="plane")
    return Machine(
        bodies, (slide,), (drive,), {"block": Pose(0j, 0.0)}, (Gravity(-10j),), speed=speed
    )


@pytest.mark.parametrize("mu", [0.0, 0.2, 0.8])
@pytest.mark.parametrize("way", [1, -1])
def test_block_on_an_incline(mu: float, way: int) -> None:
    """Pulled up W (sin a + mu cos a), let down W (sin a - mu cos a)."""
    force = solve(incline(mu, way * SLOW), np.array([0.2, 1.0])).forces().drives["pull"]
    np.testing.assert_allclose(force, 30 * (math.sin(0.5) + way * mu * math.cos(0.5)), rtol=1e-12)


def rod(radii: tuple[float, float], force: float) -> Machine:
    """A slider-crank whose rod turns in two journals; a force on its slider."""
    machine = slider_crank(10.0, 40.0, 0.0, speed=SLOW)
    joints = [
        replace(j, friction=dict(zip("AB", radii, strict=True)).get(j.name, 0.0))
        if isinstance(j, Pin)
        else j
        for j in machine.joints
    ]
    ram = machine.body("ram")
    return replace(
        machine,
        joints=tuple(joints),
        loads=(Force("load", Place("ram", 0j), complex(force)),),
        bodies=tuple(
            replace(body, mass=0.0) if body is not ram else body for body in machine.bodies
        ),
    )


@pytest.mark.parametrize("force", [-7.0, 7.0])
def test_a_rod_pulls_along_the_tangent_of_both_friction_circles(force: float) -> None:
    machine = rod((1.5, 1.0), force)
    theta = np.linspace(0.2, 6.1, 60)
    run = solve(machine, theta)
    forces, (a, b) = run.forces(), (machine.joint(name) for name in "AB")
    on_rod = {
        pin.name: forces.reactions[pin.name] * (1 if pin.a.body == "rod" else -1) for pin in (a, b)
    }
    np.testing.assert_allclose(on_rod["A"], -on_rod["B"], rtol=1e-9)  # the rod has no mass
    along = run.point("rod", "B")[0] - run.point("rod", "A")[0]
    turns = 1.5 * np.sign(run.angle("rod")[1] - run.angle("crank")[1]) + 1.0 * np.sign(
        run.angle("rod")[1]
    )
    lean = np.angle(on_rod["B"] / along * np.sign(np.real(on_rod["B"] / along)))
    np.testing.assert_allclose(np.abs(lean), np.abs(np.arcsin(turns / 40.0)), atol=1e-9)
    assert np.max(np.abs(lean)) > 0.05


def wedge(slope: float, mu: float, guide: float) -> Machine:
    """A wedge driven along x lifts a weight that slides along y, by a pin of it in a slot of the wedge."""
    bodies = (Body(GROUND), Body("wedge"), Body("weight", {}, 5.0))
    joints = (
        Slide("floor", Place(GROUND), Place("wedge"), angle=0.0),
        Slide("guide", Place(GROUND, 0j), Place("weight"), angle=math.pi / 2, friction=guide),
        Slot("face", Place("wedge"), Place("weight"), angle=math.pi - slope, friction=mu),
    )
    start = {"wedge": Pose(0j, 0.0), "weight": Pose(0j, 0.0)}
    return Machine(
        bodies,
        joints,
        (Drive("push", "wedge", Turning(10.0), slide="floor"),),
        start,
        (Gravity(-10j),),
        speed=SLOW,
    )


@pytest.mark.parametrize(
    ("mu", "guide"), [(0.0, 0.0), (0.3, 0.0), (0.0, 0.4), (0.3, 0.4), (0.6, 0.5)]
)
def test_wedge(mu: float, guide: float) -> None:
    """Push = W tan(a + phi) / (1 - mu_guide tan(a + phi))."""
    slope = 0.4
    lean = math.tan(slope + math.atan(mu))
    forces = solve(wedge(slope, mu, guide), np.array([0.3])).forces()
    assert not forces.locks[0]
    assert forces.drives["push"][0] == pytest.approx(50 * lean / (1 - guide * lean), rel=1e-9)


@pytest.mark.parametrize(
    ("guide", "locks"), [(0.69, False), (0.70, True), (0.79, True), (0.81, True), (1.5, True)]
)
def test_a_wedge_locks_where_its_closed_form_has_no_force(guide: float, locks: bool) -> None:
    """No force from 0.8 on; the face bears 1.3 / (1 - 1.25 guide) of its load without friction, tenfold from 0.696 on."""
    slope, mu = math.atan(0.5), 0.4615384615  # tan(a + phi) = 1.25
    forces = solve(wedge(slope, mu, guide), np.array([0.3])).forces()
    assert bool(forces.locks[0]) is locks and np.isfinite(forces.drives["push"][0]) != locks


@pytest.mark.parametrize("name", CHAINS)
def test_power_in_is_power_out_and_heat(name: str) -> None:
    machine = CHAINS[name]()
    joints = [
        replace(j, friction={Pin: 0.3, Slide: 0.1, Slot: 0.1}[type(j)])
        if isinstance(j, Pin | Slide | Slot)
        else j
        for j in machine.joints
    ]
    masses = tuple(replace(b, mass=0.05, centre=5 + 2j, inertia=1e-5) for b in machine.bodies)
    rough = replace(
        machine, bodies=masses, joints=tuple(joints), loads=(*machine.loads, Gravity()), speed=2.0
    )
    theta = np.linspace(0.2, 3.8, 50)
    forces, without = solve(rough, theta).forces(), solve(smooth(rough), theta).forces()
    fine = ~forces.locks
    assert np.mean(fine) > 0.8 and np.all(forces.rubs[fine] >= 0) and np.max(forces.rubs[fine]) > 0
    size = np.nanmax(np.abs(forces.power)) + np.nanmax(np.abs(forces.loads))
    np.testing.assert_allclose(
        (forces.power_in + forces.loads - forces.rubs)[fine],
        forces.power[fine],
        atol=1e-9 * max(size, 1),
    )
    for drive in forces.smooth:
        np.testing.assert_allclose(
            forces.smooth[drive], without.drives[drive], rtol=1e-9, atol=1e-9
        )
    for (
        name_,
        reaction,
    ) in (
        forces.reactions.items()
    ):  # each pin's friction is that of its reaction with friction in it
        assert np.all(np.isfinite(reaction[fine])), name_


def test_a_spring_of_no_free_length_balances_a_weight_on_an_arm() -> None:
    """What `spring_on_shaft` says, as a spring of the model: the drive's torque is then even."""
    bodies = (Body(GROUND), Body("arm", {}, 2.0, cmath.rect(30, 0.4), 0.01))
    pin = Pin("O", Place("arm"), Place(GROUND))
    machine = Machine(
        bodies,
        (pin,),
        (Drive("motor", "arm"),),
        {"arm": Pose(0j, 0.0)},
        (Gravity(-10j),),
        speed=3.0,
    )
    turn = np.linspace(0, math.tau, 361)
    torque = solve(machine, turn).forces().drives["motor"] + 0.1
    size, place, left = spring_on_shaft(turn, torque)
    assert size == pytest.approx(2 * 10 * 0.03) and left == pytest.approx(0.1)
    pinned, held = 20.0, 50.0  # mm, of the spring's ends from the axis
    spring = Spring(
        "balance",
        Place("arm", pinned),
        Place(GROUND, cmath.rect(held, place)),
        size / (pinned * held * 1e-3),
    )
    even = (
        solve(replace(machine, loads=(*machine.loads, spring)), turn).forces().drives["motor"] + 0.1
    )
    np.testing.assert_allclose(even, 0.1, atol=1e-12)
