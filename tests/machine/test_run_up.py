"""A shaft in time: against closed forms, and against an integrator over time."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from camgen.machine.flywheel import energy_swing
from camgen.machine.run_up import NEAR, MotorLine, ShaftLoad, mean_speed, swing_of

N = 360
PHI = np.arange(N) * math.tau / N
NONE = np.zeros(N)
MOTOR = MotorLine(0.02, 36 * math.tau / 60)


def load(inertia: float, swing: float, torque: float, amplitude: float) -> ShaftLoad:
    """J = inertia (1 + swing cos 2 phi), T = torque + amplitude sin phi."""
    shape = inertia * (1 + swing * np.cos(2 * PHI))
    return ShaftLoad(math.tau, shape, torque + amplitude * np.sin(PHI), NONE, NONE)


def over_time(each: tuple[float, float, float, float], time: float) -> tuple[float, float]:
    """Angle and speed after a time from rest, by J w' = M(w) - T - J' w^2 / 2."""
    inertia, swing, torque, amplitude = each

    def rates(_: float, state: np.ndarray) -> list[float]:
        phi, speed = state
        shape = inertia * (1 + swing * math.cos(2 * phi))
        bend = -2 * inertia * swing * math.sin(2 * phi)
        taken = torque + amplitude * math.sin(phi) + bend * speed**2 / 2
        return [speed, (MOTOR.torque(speed) - taken) / shape]

    found = solve_ivp(rates, (0, time), [0.0, 0.0], method="LSODA", rtol=1e-10, atol=1e-12)
    return float(found.y[0, -1]), float(found.y[1, -1])


def test_an_even_load_runs_up_as_an_exponential() -> None:
    """w = w1 (1 - exp(-t / tau)), tau = J / slope."""
    even = load(2e-3, 0.0, 0.004, 0.0)
    settled = even.settled(MOTOR)
    assert settled is not None
    top = MOTOR.no_load * (1 - 0.004 / 0.02)
    assert np.max(np.abs(settled / top - 1)) < 1e-7
    course = even.run_up(MOTOR, settled)
    tau = 2e-3 / MOTOR.slope
    # the cell in which it has run up is cut by a straight line
    assert course.time[-1] == pytest.approx(-tau * math.log(1 - NEAR), rel=2e-5)
    assert np.max(np.abs(course.speed - top * (1 - np.exp(-course.time / tau)))) < 1e-5 * top
    damped = ShaftLoad(math.tau, NONE + 2e-3, NONE, NONE + MOTOR.slope, NONE)
    slower = damped.settled(MOTOR)
    assert slower is not None and slower[0] == pytest.approx(MOTOR.no_load / 2, rel=1e-7)


@pytest.mark.parametrize("inertia", [2e-3, 2e-4, 2e-6])
def test_an_uneven_machine_runs_up_as_over_time(inertia: float) -> None:
    """The lightest follows its motor's line within a degree or two."""
    each = (inertia, 0.5, 0.004, 0.01)
    course = load(*each).run_up(MOTOR)
    angle, speed = over_time(each, float(course.time[-1]))
    assert not course.stalls
    assert angle == pytest.approx(course.angle[-1], abs=1e-4)
    assert speed == pytest.approx(course.speed[-1], rel=1e-4)


def test_the_settled_turn_is_that_of_a_long_run_over_time() -> None:
    each = (2e-4, 0.5, 0.004, 0.01)
    settled = load(*each).settled(MOTOR)
    assert settled is not None
    turns = [over_time(each, time) for time in (12.0, 12.4, 12.9)]
    for angle, speed in turns:
        place = angle / math.tau * N % N
        assert speed == pytest.approx(
            np.interp(place, range(N + 1), [*settled, settled[0]]), rel=1e-3
        )


def test_it_stalls_where_the_energy_is_spent() -> None:
    """Under one torque, far from its speed without load, where M phi = the work of T."""
    strong = MotorLine(0.004, 1e6)
    heavy = load(1e-3, 0.0, 0.0, 0.01)
    course = heavy.run_up(strong)
    stop = float(course.angle[-1])
    assert course.stalls and 0.1 < stop < math.pi
    assert 0.004 * stop == pytest.approx(0.01 * (1 - math.cos(stop)), rel=1e-4)
    assert heavy.settled(strong) is None
    still = heavy.run_up(MotorLine(-0.001, 1.0))
    assert still.stalls and still.angle[-1] == 0


def test_an_even_torque_in_closed_form() -> None:
    """J w^2 / 2 = E + A cos phi: the textbook's U / (J w^2) is exact, with the mean of both extremes for w."""
    heavy = load(2e-3, 0.0, 0.004, 0.002)
    speeds = heavy.even_torque(3.0)
    assert mean_speed(speeds) == pytest.approx(3.0, rel=1e-7)
    middle = (np.max(speeds) + np.min(speeds)) / 2
    assert swing_of(speeds) == pytest.approx(0.004 / (2e-3 * middle**2), rel=1e-6)
    theta = np.append(PHI, math.tau)
    torque = np.append(heavy.still, heavy.still[0])
    assert energy_swing(theta, torque) == pytest.approx(0.004, rel=1e-3)


@pytest.mark.parametrize(
    ("energy", "swing", "speed", "inertia"),
    [(3531, 0.1, 250, 0.565), (890.7, 0.025, 481.7, 0.154)],
    ids=["Shigley, example 16-6", "Shigley and Uicker, problem 18.1"],
)
def test_flywheels_of_textbooks(energy: float, swing: float, speed: float, inertia: float) -> None:
    """Their speed is the middle of both extremes, ours the mean over time: less by swing^2 / 16."""
    machine = load(1e-5, 0.0, energy, energy / 2)
    mean = speed * (1 - swing**2 / 16)
    assert machine.flywheel_for(swing, mean) == pytest.approx(inertia, abs=5e-4)


def test_a_light_machine_swings_less_than_the_textbook_says() -> None:
    """U / (J w^2) is 2.8 there, which no speed that stays above 0 can be."""
    light = load(2e-4, 0.0, 0.004, 0.0025)
    assert 0.005 / (2e-4 * 3.0**2) > 2.7
    assert swing_of(light.even_torque(3.0)) < 1.99
    settled = light.settled(MOTOR)
    assert settled is not None  # without inertia it would be that of the line: 0.25 / 0.8
    assert 0.3 < swing_of(settled) < 0.25 / 0.8


@settings(max_examples=15, deadline=None)
@given(st.floats(1e-5, 1e-2), st.floats(0, 0.6), st.floats(1e-4, 2e-2), st.floats(0.005, 0.3))
def test_the_flywheel_keeps_to_the_swing(
    inertia: float, swing: float, amplitude: float, share: float
) -> None:
    machine = load(inertia, swing, 0.004, amplitude)
    more = machine.flywheel_for(share, 3.0)
    kept = swing_of(machine.with_flywheel(more).even_torque(3.0))
    assert kept == pytest.approx(share, rel=1e-4) if more else kept <= share
