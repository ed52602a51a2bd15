"""Polydyne programs: the mass behind the spring by another route, an integrator, does what was asked, at its speed alone."""

from __future__ import annotations

import math

import numpy as np
import pytest

from camgen import starters
from camgen.errors import SpecError
from camgen.machine.cams.dynamics import Elastic
from camgen.machines.loads.assess import assess
from camgen.motion.laws import LAWS, Polynomial, polynomial_law
from camgen.motion.polydyne import polydyne, rough
from camgen.motion.program import Program, Segment
from camgen.pipeline.jobs import read_mechanism

ENDS = [(u, order, float(u == 1 and order == 0)) for u in (0.0, 1.0) for order in range(5)]
SMOOTHER = polynomial_law(ENDS)  # 5-6-7-8-9


def program(law: str = "4-5-6-7") -> Program:
    """Rise of 10 in 90 deg, rest, return, rest."""
    made = LAWS[law] if law in LAWS else SMOOTHER
    spans = (("rise", math.pi / 2, 0.0, 10.0), ("dwell", math.pi / 2, 10.0, 0.0), ("return", math.pi / 2, 10.0, -10.0),
             ("dwell", math.pi / 2, 0.0, 0.0))  # fmt: skip
    return Program(tuple(Segment(kind, span, start, scale, made) for kind, span, start, scale in spans))


def integrated(cam: Program, frequency: float, speed: float) -> tuple[np.ndarray, np.ndarray]:
    """The mass over a turn from rest, y'' + w^2 y = w^2 s, by Runge and Kutta, (angles, y)."""
    from scipy.integrate import solve_ivp

    def rate(theta: float, state: np.ndarray) -> tuple[float, float]:
        return state[1], (frequency / speed) ** 2 * (float(cam(np.array([theta]))[0]) - state[0])

    theta = np.linspace(0, 1.3 * math.pi, 100)
    found = solve_ivp(rate, (0, 1.3 * math.pi), (0.0, 0.0), t_eval=theta, rtol=1e-7, atol=1e-8, max_step=0.1)
    return theta, found.y[0]


def test_the_mass_does_what_was_asked_at_its_speed_alone() -> None:
    wanted, frequency, speed = program(), 80.0, 12.0
    cam = polydyne(wanted, (speed / frequency) ** 2)
    theta, mass = integrated(cam, frequency, speed)
    np.testing.assert_allclose(mass, wanted(theta), atol=2e-5)
    _, plain = integrated(wanted, frequency, speed)
    assert np.max(np.abs(plain - wanted(theta))) > 0.3  # uncorrected it lags and swings
    _, faster = integrated(cam, frequency, 1.3 * speed)
    assert np.max(np.abs(faster - wanted(theta))) > 0.1


def test_the_harmonics_of_the_follower_say_the_same() -> None:
    wanted, frequency, speed = program("smoother"), 80.0, 12.0
    cam, theta = polydyne(wanted, (speed / frequency) ** 2), np.linspace(0, math.tau, 4096, endpoint=False)
    x, _ = Elastic(frequency, 0.0).vibration(cam(theta, 2), speed)
    np.testing.assert_allclose(cam(theta) + x, wanted(theta), atol=3e-5)


def test_speed_of_the_cam_is_continuous_and_with_five_conditions_its_acceleration() -> None:
    for law, order in (("4-5-6-7", 1), ("smoother", 2)):
        cam = polydyne(program(law), 0.02)
        assert not cam.discontinuities(order) and (cam.discontinuities(2) == []) == (order == 2)


def test_a_clockwise_cam_is_corrected_alike() -> None:
    cam, theta = polydyne(program(), 0.02), np.linspace(0.1, 6.0, 50)
    for order in (0, 1, 2):
        np.testing.assert_allclose(cam.backwards()(-theta, order), (-1) ** order * cam(theta, order), atol=1e-12)
    np.testing.assert_allclose(cam.backwards().wanted(-theta), cam.wanted(theta), atol=1e-12)


@pytest.mark.parametrize("law", sorted(LAWS))
def test_which_laws_are_smooth_enough(law: str) -> None:
    assert rough(program(law).segments) == ([] if law == "4-5-6-7" else [0, 2])
    if law != "4-5-6-7":
        with pytest.raises(ValueError, match="4-5-6-7"):
            polydyne(program(law), 0.01)


def test_polynomials_have_all_derivatives() -> None:
    made, u = Polynomial((1.0, 2.0, 3.0, 4.0)), np.array([0.0, 0.5, 2.0])
    for order, values in enumerate(((1, 3.25, 49), (2, 8, 62), (6, 18, 54), (24, 24, 24), (0, 0, 0), (0, 0, 0))):
        np.testing.assert_allclose(made(u, order), values)


SMOOTH = ("segment.0.law=4-5-6-7", "segment.2.law=4-5-6-7", "load.mass_kg=0.5", "load.stiffness=200", "motor.speed_rpm=600",
          "spring.preload=200", "spring.rate=10", "load.damping_ratio=0")  # fmt: skip


def test_a_disc_cam_is_corrected_where_it_is_asked_for() -> None:
    spec = starters.folder() / "disc-cam.toml"
    plain, made = (read_mechanism(spec, (*SMOOTH, f"load.polydyne={on}")) for on in ("false", "true"))
    found = assess(made).study.numbers
    assert found["off_wanted_contact_mm"] < 0.015 < 0.15 < assess(plain).study.numbers["vibration_contact_mm"]
    theta = np.array([0.5, 1.0])
    c = 0.5e-3 * (600 * math.tau / 60) ** 2 / 200
    np.testing.assert_allclose(made.motion(theta), plain.motion(theta) + c * plain.motion(theta, 2), rtol=1e-12)


def test_what_it_lacks_is_told_at_once() -> None:
    with pytest.raises(SpecError) as caught:
        read_mechanism(starters.folder() / "disc-cam.toml", ("load.polydyne=true",))
    assert {fault.path for fault in caught.value.faults} == {"load.stiffness", "load.mass_kg", "segment.0.law", "segment.2.law"}
