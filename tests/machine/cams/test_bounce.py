"""A follower that leaves its cam: against an independent prototype, a stiff contact in small steps and an integrator."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from camgen import starters
from camgen.machine.cams.bounce import Bounce, Hop, Spring, fitted_spring, hops, lift_off_speed
from camgen.machines.sources import read_mechanism

REFERENCE = tomllib.loads(
    (Path(__file__).parents[2] / "reference" / "bounce.toml").read_text(encoding="utf-8")
)
SPRING = Spring(0.3e-3, 0.0, 0.5, 5.0)
RPM = math.tau / 60
THETA = np.linspace(0, math.tau, 3601)


def spec(rpm: float, **load: float) -> dict[str, Any]:
    tables = tomllib.loads(starters.text("disc-cam"))
    tables["geometry"]["closure"] = "force"
    return tables | {
        "motor": {"speed_rpm": rpm},
        "load": {"mass_kg": 0.3, **load},
        "spring": {"rate": 0.5, "preload": 5},
    }


PROGRAM = read_mechanism(spec(60)).program  # type: ignore[attr-defined]


def lift(angle: np.ndarray, order: int) -> np.ndarray:
    return np.asarray(PROGRAM(np.mod(angle, math.tau), order))


def as_printed(value: float, text: str) -> bool:
    """Whether a value is the printed one, to half of its last digit and a hair of the prototype's own steps."""
    last = 10.0 ** -len(text.partition(".")[2])
    return abs(value - float(text)) <= 0.51 * last


def test_lift_off_is_where_nothing_presses_any_more() -> None:
    speed = lift_off_speed(lift, SPRING, THETA)
    assert as_printed(speed / RPM, REFERENCE["lift_off_rpm"])
    least = [float(np.min(SPRING.push(lift, THETA, share * speed))) for share in (0.999, 1.001)]
    assert least == pytest.approx([0.022, -0.022], abs=5e-4)
    assert not hops(lift, SPRING, 0.999 * speed, 0.3)
    assert lift_off_speed(lift, Spring(0.3e-3, 0, 0.5, 0.0), THETA) == 0
    assert lift_off_speed(lift, Spring(0.0, 0, 0.5, 5.0), THETA) == math.inf


@pytest.mark.parametrize("run", REFERENCE["run"], ids=lambda run: str(run["times"]))
def test_hops_are_those_of_the_prototype(run: dict[str, Any]) -> None:
    found = hops(lift, SPRING, run["times"] * lift_off_speed(lift, SPRING, THETA), 0.3)
    large = [hop for hop in found if hop.height > 0.07 and hop.leaves < math.tau + 0.1]
    assert as_printed(max(hop.knock for hop in found) / 1000, run["knock_m_s"])
    lands = [math.degrees(hop.lands) for hop in large]
    assert all(map(as_printed, lands[: len(run["lands_deg"])], run["lands_deg"]))
    if "highest_mm" in run:
        assert as_printed(max(hop.height for hop in found), run["highest_mm"])
        return
    own = [hop for hop in found if any(as_printed(hop.height, each) for each in run["height_mm"])]
    for hop, leaves, height in zip(own, run["leaves_deg"], run["height_mm"], strict=False):
        assert as_printed(math.degrees(hop.leaves), leaves) and as_printed(hop.height, height)


def test_the_first_hop_is_that_of_a_stiff_contact_in_small_steps() -> None:
    """A contact of 2e4 N/mm pushes wherever the follower is below its cam, from rest in the dwell on; within 10 um, as the prototype."""
    speed = 1.2 * lift_off_speed(lift, SPRING, THETA)
    first = hops(lift, SPRING, speed, 0.3)[0]
    step = 2e-6
    angle = np.arange(math.radians(-5), math.radians(121), speed * step)
    cam = lift(angle, 0)
    place = -SPRING.preload / 2e4
    velocity = 0.0
    highest = 0.0
    for low in cam.tolist():
        below = max(0.0, low - place)
        velocity += step * (2e4 * below - SPRING.rate * place - SPRING.preload) / SPRING.mass
        place += step * velocity
        highest = max(highest, place - low)
    assert highest == pytest.approx(first.height, abs=0.01)


@settings(max_examples=40, deadline=None)
@given(
    st.floats(1e-4, 1.0),
    st.sampled_from([0.0, 1e-6, 1e-3, 0.1]),
    st.sampled_from([0.0, 1e-9, 0.01, 2.0]),
    st.floats(0.1, 20.0),
    st.floats(-200.0, 200.0),
)
def test_a_flight_obeys_its_equation(
    mass: float, damping: float, rate: float, preload: float, velocity: float
) -> None:
    """Without spring or damper, weakly and strongly damped: against an integrator, to its tolerance."""
    spring = Spring(mass, damping, rate, preload)
    time = np.linspace(0, 0.02, 5)

    def rates(_: float, state: np.ndarray) -> list[float]:
        y, v = state
        return [v, -(damping * v + rate * y + preload) / mass]

    truth = solve_ivp(rates, (0, 0.02), [3.0, velocity], "LSODA", time, rtol=1e-10, atol=1e-10).y
    place, speed = spring.flight(3.0, velocity, time)
    scale = 1 + float(np.max(np.abs(truth)))
    assert np.abs(place - truth[0]).max() < 1e-6 * scale
    assert np.abs(speed - truth[1]).max() < 1e-6 * scale


def test_the_spring_is_that_of_what_presses() -> None:
    """Mass, damper and spring come back from the forces that they make; what one mass on one spring does not take is none."""
    speed = 40.0
    spring = Spring(0.3e-3, 1e-3, 0.5, 7.5)
    rows = [lift(THETA, order) for order in range(3)]
    still = spring.rate * rows[0] + spring.preload
    effort = spring.push(lift, THETA, speed)
    found = fitted_spring(rows, speed, still, effort)
    assert found is not None
    for name in ("mass", "damping", "rate", "preload"):
        assert getattr(found, name) == pytest.approx(getattr(spring, name), rel=1e-9)
    pull = 0.1 * np.max(effort) * np.sin(THETA)
    assert fitted_spring(rows, speed, still + pull, effort + pull) is None
    assert fitted_spring(rows, speed, still, still) is None
    free = Spring(0.3e-3, 0.0, 0.0, 7.5)
    found = fitted_spring(rows, speed, 0 * still + 7.5, free.push(lift, THETA, speed))
    assert found is not None and found.rate == 0 and found.damping == 0


def test_a_flight_is_at_most_all_of_the_motion() -> None:
    assert Bounce(1.0, [Hop(0.0, math.pi, 1.0, 1.0)], math.tau).lost == pytest.approx(1 / 4)
    assert Bounce(1.0, [Hop(0.0, math.inf, math.inf, 0.0)], math.tau).lost == 1


def test_a_restitution_of_nothing_keeps_a_follower_down() -> None:
    """After its first knock it stays on, until the cam leaves it again; the first hop is the same."""
    speed = 1.5 * lift_off_speed(lift, SPRING, THETA)
    dead = hops(lift, SPRING, speed, 0.0)
    lively = hops(lift, SPRING, speed, 0.6)
    assert dead[0] == lively[0] and len(dead) < len(lively)


@pytest.mark.parametrize(
    ("rpm", "leaves", "lands"), [(467.165, 65.7, 122.0), (-467.165, 294.3, 238.0)]
)
def test_a_cam_tells_its_hop(rpm: float, leaves: float, lands: float) -> None:
    """Either way round; at a speed that its spring holds nothing is told."""
    machine = read_mechanism(spec(rpm))
    (finding,) = (each for each in machine.limits() if each.code == "LIFT_OFF")
    assert not finding.ok and "It loses contact from 389.3 rpm" in finding.message
    assert f"leaves the cam at {leaves} deg" in finding.message
    assert f"comes back at {lands} deg" in finding.message
    numbers = machine.figures().numbers  # type: ignore[attr-defined]
    assert numbers["hop_mm"] == pytest.approx(0.713, abs=6e-4)
    assert numbers["knock_m_s"] == pytest.approx(0.231, abs=6e-4)
    held = read_mechanism(spec(380))
    assert all(each.ok for each in held.limits() if each.code == "LIFT_OFF")
    assert "hop_mm" not in held.figures().numbers  # type: ignore[attr-defined]


MACHINE = """
mechanism = "linkage"
name = "follower"
[points]
O = [0, 0]
P = [0, 50]
R = [30, 40]
S = [30, 80]
[links]
ground = ["O", "R", "S"]
disc = ["O"]
ram = ["P"]
[drive]
link = "disc"
speed_rpm = 467.165
[[slide]]
link = "ram"
on = "ground"
along = ["R", "S"]
[[cam]]
cam = "disc"
follower = "ram"
at = "P"
radius = 8
[cam.spring]
rate = 0.5
preload = 5
[masses.ram]
mass_g = 300
centre = [0, 0]
[[output]]
name = "lift"
link = "ram"
"""


GEARED = """
[[gear]]
a = "crank"
b = "disc"
ratio = -0.5
"""


@pytest.mark.parametrize("geared", [False, True])
def test_a_cam_in_a_machine_bounces_as_one_alone(geared: bool) -> None:
    """The same mass on the same spring and cam, from a drawing: the hop of the prototype; by gears too, which turn it backwards."""
    tables = tomllib.loads(MACHINE + geared * GEARED)
    tables["cam"][0]["segment"] = tomllib.loads(starters.text("disc-cam"))["segment"]
    if geared:
        tables["points"] |= {"G": [0, -90]}
        tables["links"] |= {"crank": ["G"], "ground": ["O", "G", "R", "S"]}
        tables["drive"] = {"link": "crank", "speed_rpm": 2 * 467.165}
        tables["parts"] = {"plates": 2}
    machine = read_mechanism(tables)
    (finding,) = (each for each in machine.limits() if each.code == "LIFT_OFF")
    lost = "778.6" if geared else "389.3"
    assert not finding.ok and f"It loses contact from {lost} rpm" in finding.message
    numbers = machine.study().numbers
    assert numbers["hop_disc_on_ram_mm"] == pytest.approx(0.713, abs=6e-4)


def test_a_follower_that_creeps_back_is_told_without_overflow() -> None:
    """Heavily damped: its two rates are 1e-3 and 1e6 per s; after a while only the slow one is left."""
    fast, slow = 1e6, 1e-3
    spring = Spring(mass=1.0, damping=fast + slow, rate=fast * slow, preload=0.0)
    time = np.array([0.0, 1e-6, 1.0, 1e3])
    moved, velocity = spring.flight(2.0, 0.0, time)
    exact = 2 * (fast * np.exp(-slow * time) - slow * np.exp(-fast * time)) / (fast - slow)
    assert np.allclose(moved, exact, rtol=1e-9)
    assert np.allclose(velocity[2:], -slow * exact[2:], rtol=1e-3)
