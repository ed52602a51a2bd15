"""Polydyne programs: the mass behind the spring by another route, an integrator, does what was asked, at its speed alone."""

from __future__ import annotations

import math

import numpy as np
import pytest

from camgen import starters
from camgen.errors import SpecError
from camgen.machine.cams.dynamics import Elastic, Excitation
from camgen.machines.disc_cam.mechanism import DiscCamDrive
from camgen.machines.loads.assess import assess
from camgen.machines.sources import read_mechanism
from camgen.motion.laws import LAWS, Polynomial, polynomial_law
from camgen.motion.polydyne import Lag, polydyne, rough
from camgen.motion.program import Program, Segment

ENDS = [(u, order, float(u == 1 and order == 0)) for u in (0.0, 1.0) for order in range(5)]
SMOOTHER = polynomial_law(ENDS)  # 5-6-7-8-9


def program(law: str = "4-5-6-7") -> Program:
    """Rise of 10 in 90 deg, rest, return, rest."""
    made = LAWS[law] if law in LAWS else SMOOTHER
    spans = (
        ("rise", math.pi / 2, 0.0, 10.0),
        ("dwell", math.pi / 2, 10.0, 0.0),
        ("return", math.pi / 2, 10.0, -10.0),
        ("dwell", math.pi / 2, 0.0, 0.0),
    )
    return Program(
        tuple(Segment(kind, span, start, scale, made) for kind, span, start, scale in spans)
    )


def integrated(cam: Program, frequency: float, speed: float) -> tuple[np.ndarray, np.ndarray]:
    """The mass over a turn from rest, y'' + w^2 y = w^2 s, by Runge and Kutta, (angles, y)."""
    from scipy.integrate import solve_ivp

    def rate(theta: float, state: np.ndarray) -> tuple[float, float]:
        return state[1], (frequency / speed) ** 2 * (float(cam(np.array([theta]))[0]) - state[0])

    theta = np.linspace(0, 1.3 * math.pi, 100)
    found = solve_ivp(
        rate, (0, 1.3 * math.pi), (0.0, 0.0), t_eval=theta, rtol=1e-7, atol=1e-8, max_step=0.1
    )
    return theta, found.y[0]


def test_the_mass_does_what_was_asked_at_its_speed_alone() -> None:
    wanted, frequency, speed = program(), 80.0, 12.0
    cam = polydyne(wanted, Lag((speed / frequency) ** 2))
    theta, mass = integrated(cam, frequency, speed)
    np.testing.assert_allclose(mass, wanted(theta), atol=2e-5)
    _, plain = integrated(wanted, frequency, speed)
    assert np.max(np.abs(plain - wanted(theta))) > 0.3  # uncorrected it lags and swings
    _, faster = integrated(cam, frequency, 1.3 * speed)
    assert np.max(np.abs(faster - wanted(theta))) > 0.1


def test_the_harmonics_of_the_follower_say_the_same() -> None:
    wanted, frequency, speed = program("smoother"), 80.0, 12.0
    cam, theta = (
        polydyne(wanted, Lag((speed / frequency) ** 2)),
        np.linspace(0, math.tau, 4096, endpoint=False),
    )
    found = Elastic(1.0, frequency**2, 0.0).response(Excitation(cam(theta), cam(theta, 2)), speed)
    np.testing.assert_allclose(cam(theta) + found.behind, wanted(theta), atol=3e-5)


def test_speed_of_the_cam_is_continuous_and_with_five_conditions_its_acceleration() -> None:
    for law, order in (("4-5-6-7", 1), ("smoother", 2)):
        cam = polydyne(program(law), Lag(0.02, 0.01, 0.1))
        assert not cam.discontinuities(order) and (cam.discontinuities(2) == []) == (order == 2)


def test_a_clockwise_cam_is_corrected_alike() -> None:
    cam, theta = polydyne(program(), Lag(0.02, 0.01, 0.1)), np.linspace(0.1, 6.0, 50)
    for order in (0, 1, 2):
        np.testing.assert_allclose(
            cam.backwards()(-theta, order), (-1) ** order * cam(theta, order), atol=1e-12
        )
    np.testing.assert_allclose(cam.backwards().wanted(-theta), cam.wanted(theta), atol=1e-12)


@pytest.mark.parametrize("law", sorted(LAWS))
def test_which_laws_are_smooth_enough(law: str) -> None:
    assert rough(program(law).segments) == ([] if law == "4-5-6-7" else [0, 2])
    if law != "4-5-6-7":
        with pytest.raises(ValueError, match="4-5-6-7"):
            polydyne(program(law), Lag(0.01))


def test_polynomials_have_all_derivatives() -> None:
    made, u = Polynomial((1.0, 2.0, 3.0, 4.0)), np.array([0.0, 0.5, 2.0])
    for order, values in enumerate(
        ((1, 3.25, 49), (2, 8, 62), (6, 18, 54), (24, 24, 24), (0, 0, 0), (0, 0, 0))
    ):
        np.testing.assert_allclose(made(u, order), values)


SMOOTH = (
    "segment.0.law=4-5-6-7",
    "segment.2.law=4-5-6-7",
    "load.mass_kg=0.5",
    "load.stiffness=200",
    "motor.speed_rpm=600",
    "spring.preload=200",
    "spring.rate=10",
    "load.damping_ratio=0",
)


def test_a_disc_cam_is_corrected_where_it_is_asked_for() -> None:
    spec = starters.folder() / "disc-cam.toml"
    plain, made = (
        read_mechanism(spec, (*SMOOTH, f"load.polydyne={on}")) for on in ("false", "true")
    )
    found = assess(made).study.numbers
    assert (
        found["off_wanted_contact_mm"]
        < 2e-4
        < 0.15
        < assess(plain).study.numbers["vibration_contact_mm"]
    )
    theta = np.array([0.5, 1.0])
    c = 0.5e-3 * (600 * math.tau / 60) ** 2 / 200
    corrected = (1 + 10 / 200) * plain.motion(theta) + c * plain.motion(theta, 2)
    np.testing.assert_allclose(made.motion(theta), corrected, rtol=1e-12)


def settled(made: DiscCamDrive, turns: int) -> dict[str, np.ndarray]:
    """The mass behind the stiffness of a spec over a whole turn, after so many: all of its equation, by Runge and Kutta.

    m y'' + c y' + K y = k (s - y) + d (s' - y'), s over time in the sense in which the cam turns.
    """
    from scipy.integrate import solve_ivp

    load, spring, speed = made.load, made.spring, made.model.speed
    assert load is not None and load.stiffness is not None and spring is not None
    m, k = load.mass_kg * 1e-3, load.stiffness
    d = 2 * load.damping_ratio * math.sqrt(k * m)

    def rate(time: float, state: np.ndarray) -> tuple[float, float]:
        theta = np.array([speed * time])
        s, fast = float(made.motion(theta)[0]), speed * float(made.motion(theta, 1)[0])
        force = (
            k * (s - state[0])
            + d * (fast - state[1])
            - load.damping * state[1]
            - spring.rate * state[0]
        )
        return state[1], force / m

    turn = math.tau / abs(speed)
    time = (turns + np.linspace(0, 1, 721)) * turn
    found = solve_ivp(
        rate, (0, time[-1]), (0.0, 0.0), t_eval=time, rtol=1e-7, atol=1e-9, max_step=turn / 90
    )
    theta = speed * time
    s, fast = made.motion(theta), speed * made.motion(theta, 1)
    y, v = found.y
    return {
        "theta": np.mod(theta, math.tau),
        "s": s,
        "y": y,
        "push": k * (s - y) + d * (fast - v) + spring.preload,
    }


@pytest.mark.long
@pytest.mark.parametrize("rate", [0.0, 8.0, 80.0])
def test_the_mass_does_what_was_asked_whatever_presses_and_brakes_it(rate: float) -> None:
    """Without the spring's term it would be off by rate / stiffness of the lift: 0.48 of 12 mm at 8 N/mm, 4.8 at 80."""
    spec = starters.folder() / "disc-cam.toml"
    settings = (*SMOOTH, f"spring.rate={rate}", "load.damping=0.02", "load.polydyne=true")
    made, plain = (
        read_mechanism(spec, settings),
        read_mechanism(spec, (*settings, "load.polydyne=false")),
    )
    assert isinstance(made, DiscCamDrive)
    found = settled(made, 12)
    np.testing.assert_allclose(found["y"], plain.motion(found["theta"]), atol=2e-4)
    assert assess(made).study.numbers["off_wanted_contact_mm"] < 2e-4


@pytest.mark.long
@pytest.mark.parametrize("rpm", [600, -600])
@pytest.mark.parametrize("on", ["false", "true"])
def test_figures_of_vibration_are_those_of_an_integrator(on: str, rpm: int) -> None:
    """In the dwells alone, 100 to 160 and 280 to 360 deg in the sense of turning; the rise beside them swings more."""
    settings = (
        *SMOOTH,
        "spring.rate=30",
        "load.damping=0.02",
        "load.damping_ratio=0.03",
        f"load.polydyne={on}",
        f"motor.speed_rpm={rpm}",
        "segment.0.law=4-5-6-7",
    )
    made = read_mechanism(starters.folder() / "disc-cam.toml", settings)
    assert isinstance(made, DiscCamDrive)
    found, numbers = settled(made, 12), assess(made).study.numbers
    vibration = found["y"] - 200 / 230 * found["s"]
    degrees = np.degrees(found["theta"] if rpm > 0 else math.tau - found["theta"])
    resting = ((degrees >= 100) & (degrees <= 160)) | (degrees >= 280)
    assert numbers["vibration_contact_mm"] == pytest.approx(np.max(np.abs(vibration)), rel=2e-3)
    assert numbers["vibration_in_dwells_contact_mm"] == pytest.approx(
        np.max(np.abs(vibration[resting])), rel=2e-2, abs=2e-4
    )
    assert numbers["vibration_bent_by_spring_contact_mm"] == pytest.approx(
        30 / 230 * np.max(found["s"]), rel=1e-9
    )
    (pressed,) = [each for each in assess(made).findings if each.code == "LIFT_OFF"]
    assert pressed.measured == pytest.approx(np.min(found["push"]), rel=5e-3)


def test_a_machine_is_corrected_for_the_spring_that_it_has() -> None:
    """On a bench the spring pulls in line with the slide, so its rate there is the spec's; and the figure is there as well."""
    spec = starters.folder() / "disc-cam.toml"
    slow = (
        *SMOOTH[:4],
        "load.damping_ratio=0",
        "motor.speed_rpm=120",
        "parts.make='printed'",
        "load.polydyne=true",
    )
    made = read_mechanism(spec, (*slow, "spring.preload=6", "spring.rate=0.4"))
    assert assess(made).study.numbers["off_wanted_contact_mm"] < 2e-3
    with pytest.raises(SpecError, match="spring.rate"):
        read_mechanism(spec, slow)


def test_what_it_lacks_is_told_at_once() -> None:
    with pytest.raises(SpecError) as caught:
        read_mechanism(starters.folder() / "disc-cam.toml", ("load.polydyne=true",))
    assert {fault.key for fault in caught.value.faults} == {
        "load.stiffness",
        "load.mass_kg",
        "segment.0.law",
        "segment.2.law",
    }
