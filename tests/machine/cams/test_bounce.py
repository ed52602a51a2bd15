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
from camgen.machine.cams.bounce import Spring, hops, lift_off_speed, spring_of
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
    assert not hops(lift, SPRING, 0.999 * speed)
    assert lift_off_speed(lift, Spring(0.3e-3, 0, 0.5, 0.0), THETA) == 0
    assert lift_off_speed(lift, Spring(0.0, 0, 0.5, 5.0), THETA) == math.inf


@pytest.mark.parametrize("run", REFERENCE["run"], ids=lambda run: str(run["times"]))
def test_hops_are_those_of_the_prototype(run: dict[str, Any]) -> None:
    found = hops(lift, SPRING, run["times"] * lift_off_speed(lift, SPRING, THETA))
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
    first = hops(lift, SPRING, speed)[0]
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


def test_what_pulls_differently_at_each_angle_is_not_taken_for_a_spring() -> None:
    speed = 40.0
    effort = SPRING.push(lift, THETA, speed) + 2.5
    found = spring_of(lift, effort, THETA, speed, SPRING)
    assert found is not None and found.preload == pytest.approx(7.5)
    assert spring_of(lift, effort + 0.1 * np.sin(THETA), THETA, speed, SPRING) is None


@pytest.mark.parametrize(
    ("rpm", "leaves", "lands"), [(467.165, 65.7, 122.0), (-467.165, 294.3, 238.0)]
)
def test_a_cam_tells_its_hop(rpm: float, leaves: float, lands: float) -> None:
    """Either way round; at a speed that its spring holds nothing is told."""
    machine = read_mechanism(spec(rpm))
    (finding,) = (each for each in machine.limits() if each.code == "LIFT_OFF")
    assert not finding.ok and "contact is lost from 389.3 rpm" in finding.message
    assert f"leaves at {leaves} deg" in finding.message
    assert f"comes back at {lands} deg" in finding.message
    numbers = machine.figures().numbers  # type: ignore[attr-defined]
    assert numbers["hop_mm"] == pytest.approx(0.713, abs=6e-4)
    assert numbers["knock_m_s"] == pytest.approx(0.231, abs=6e-4)
    held = read_mechanism(spec(380))
    assert all(each.ok for each in held.limits() if each.code == "LIFT_OFF")
    assert "hop_mm" not in held.figures().numbers  # type: ignore[attr-defined]
