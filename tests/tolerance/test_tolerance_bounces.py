"""Lift-off of printed copies against closed forms: a cam that is too large, a spring that is too strong, joints without friction."""

from __future__ import annotations

import math

import numpy as np
import pytest
from test_tolerance import SPECS, spread

from camgen.machine.cams.bounce import Contact, Spring, lift_off_speed
from camgen.machines.loads.lift_off import by_force
from camgen.tolerance.bounces import _rubbing, _wound, bounces
from camgen.tolerance.report import PrintRun, tolerance
from camgen.tolerance.spread import Spread

HELD = (
    "geometry.closure=force",
    "load.mass_kg=0.3",
    "spring={rate=0.5,preload=5}",
    "motor.speed_rpm=380",
)
THETA = np.linspace(0, math.tau, 3601)


@pytest.fixture(scope="module")
def found() -> Spread:
    return spread("disc-cam", *HELD, "load.friction=0")


def speed(found: Spread, preload: float) -> float:
    """rad/s, of a spring with another preload."""
    lift = found.mechanism.motion
    return lift_off_speed(lift, Spring(0.3e-3, 0.0, 0.5, preload), THETA)


def test_a_cam_that_is_too_large_presses_its_spring(found: Spread) -> None:
    """Everywhere by about 0.1 mm, as much as 0.05 N more preload; the bend's own second derivative does the rest."""
    errors = np.zeros((2, len(found.modes)))
    errors[1, next(k for k, mode in enumerate(found.modes) if mode.kind == "offset")] = 0.1
    (copies,) = bounces(found, errors, 1)
    exact = speed(found, 5.0)
    assert copies.designed == pytest.approx(exact, rel=1e-5)
    assert copies.print_alone[0] == pytest.approx(exact, rel=1e-5)
    gained = copies.print_alone[1] / exact - 1
    assert 0.5 < gained / (speed(found, 5.05) / exact - 1) < 2
    assert copies.rubbing == pytest.approx(exact, rel=2e-4)


def test_a_speed_that_is_not_found_is_none(found: Spread) -> None:
    """Without friction it leaves at its own speed: looked for below half of that there is none."""
    exact = speed(found, 5.0)
    machine = found.mechanism.model
    (cam,) = by_force(machine)
    assert _rubbing(found.mechanism, machine, cam, THETA, exact) == pytest.approx(exact, rel=2e-4)
    assert _rubbing(found.mechanism, machine, cam, THETA, 0.49 * exact) == math.inf


@pytest.mark.long
def test_springs_scatter_the_speed_by_half_as_much(found: Spread) -> None:
    """w^2 goes with the force: 5 % of all of it are 2.5 % of w; of rate and preload, each by itself, less."""
    errors = np.zeros((200, len(found.modes)))
    (copies,) = bounces(found, errors, 1)
    share = float(np.std(copies.springs_alone)) / copies.designed
    assert 0.025 / math.sqrt(2) - 4e-3 < share < 0.027
    np.testing.assert_array_equal(copies.springs_alone, copies.all)
    left = float(np.mean(copies.all < 380 * math.tau / 60))
    assert len(copies.leaving) == round(left * 200) > 0


def test_a_spring_that_is_stronger_all_through_holds_by_its_root(found: Spread) -> None:
    lift = found.mechanism.motion
    contact = Contact(lift, Spring(0.3e-3, 0.0, 0.5, 5.0), 1.0, 0.0, 1.0)
    more = 0.21 * 0.5, 0.21 * 5.0
    assert _wound(contact, *more).lift_off == pytest.approx(1.1 * contact.lift_off, rel=1e-12)


@pytest.mark.long
@pytest.mark.parametrize(
    ("pressed", "share"),
    [
        (("load.resistance=5", "spring.rate=0", "spring.preload=0"), 0.0),
        (("load.gravity_deg=-90", "spring.rate=0", "spring.preload=0"), 0.0),
        (("load.resistance=2", "spring.rate=0", "spring.preload=2"), 0.5),
    ],
)
def test_what_is_no_spring_presses_as_it_is(pressed: tuple[str, ...], share: float) -> None:
    """An error of a spring's preload moves the speed by half of what that is of all that presses."""
    found = spread("disc-cam", *HELD, "load.friction=0", "motor.speed_rpm=100", *pressed)
    (copies,) = bounces(found, np.zeros((100, len(found.modes))), 1)
    scatter = float(np.std(copies.springs_alone)) / copies.designed
    assert scatter == pytest.approx(0.05 * share / 2, rel=0.2, abs=1e-12)


def test_the_report_says_from_which_speed_copies_leave() -> None:
    report = tolerance(SPECS / "disc-cam.toml", HELD, PrintRun(50, 1, 0))
    titles = [each.title for each in report.tables]
    assert "At 380 rpm, of those copies" in titles
    assert 330 < report.numbers["lift_off_speed_1_percent_contact_rpm"] < 389
