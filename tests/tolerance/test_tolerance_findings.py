"""Findings of printed copies against closed forms: lengths that are off, an outline that stands out, a bore beside its centre."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from test_tolerance import SPECS, spread

from camgen.machine.model import Pin
from camgen.tolerance.findings import CopiesFinding, _of_model, copies_findings
from camgen.tolerance.report import PrintRun, _lost, tolerance, wilson
from camgen.tolerance.spread import Spread, drawn_again

SPRUNG = ("load.mass_kg=0.3", "spring={rate=1,preload=0.1}")


def errors(found: Spread, **sizes: float) -> Any:
    """Of one copy, (1, modes): by kind the size of the first mode of it."""
    made = np.zeros(len(found.modes))
    for kind, size in sizes.items():
        made[next(k for k, mode in enumerate(found.modes) if mode.kind == kind)] = size
    return made[None]


def only(found: list[CopiesFinding], code: str) -> CopiesFinding:
    (each,) = [each for each in found if each.code == code]
    return each


def test_transmission_angle_of_a_copy_is_that_of_its_lengths() -> None:
    """cos mu = (b^2 + c^2 - d^2) / (2 b c), d = frame -+ crank, of the four-bar whose pin A is 2 mm off in its crank."""
    found = spread("linkage")
    k = next(k for k, mode in enumerate(found.modes) if mode.where == "A, crank")
    made = np.zeros((1, len(found.modes)))
    made[0, k] = 2.0
    pins = {
        joint.name: {side.body: side.at for side in (joint.a, joint.b)}
        for joint in found.mechanism.model.joints
        if isinstance(joint, Pin)
    }
    pins["A"]["crank"] += 2.0 * found.modes[k].along
    links = (("O", "C", "ground"), ("O", "A", "crank"), ("A", "B", "coupler"), ("B", "C", "rocker"))
    frame, crank, coupler, rocker = (abs(pins[a][body] - pins[b][body]) for a, b, body in links)
    corners = [
        math.degrees(math.acos((coupler**2 + rocker**2 - d**2) / (2 * coupler * rocker)))
        for d in (frame - crank, frame + crank)
    ]
    angle = only(copies_findings(found, made), "TRANSMISSION_ANGLE")
    assert angle.values[0] == pytest.approx(min(min(mu, 180 - mu) for mu in corners), abs=1e-4)
    assert abs(angle.values[0] - angle.designed) > 1 and angle.holds[0]


def test_an_outline_that_stands_out_presses_its_spring() -> None:
    """In the low dwell it lifts the follower by as much: force = preload + rate x 0.1 mm; 0.2 mm too small, it is let go."""
    found = spread("disc-cam", *SPRUNG)
    for off, left, holds in ((0.05, 0.15, True), (-0.2, -0.1, False)):
        lift_off = only(copies_findings(found, errors(found, offset=off)), "LIFT_OFF")
        assert lift_off.designed == pytest.approx(0.1, abs=1e-3) and lift_off.values[
            0
        ] == pytest.approx(left, abs=2e-3)
        assert bool(lift_off.holds[0]) is holds
    (own,) = [each for each in found.mechanism.limits() if each.code == "LIFT_OFF"]
    assert own.measured == pytest.approx(lift_off.designed, abs=1e-6)


@pytest.mark.long
def test_a_copy_that_nothing_presses_is_not_held() -> None:
    """By hand: without preload the spring pulls with 0 N through the low dwell, with 0.1 N of it by so much."""
    for preload, holds in ((0.0, False), (0.1, True)):
        found = spread(
            "disc-cam", "load.mass_kg=0.3", f"spring={{rate=1,preload={preload}}}"
        ).mechanism
        (pressed,) = [
            each
            for each in _of_model(found, found.model, found.limits())
            if each.code == "LIFT_OFF"
        ]
        assert pressed.measured == pytest.approx(preload, abs=1e-3) and pressed.ok is holds


def test_a_bore_beside_its_centre_ripples_the_speed() -> None:
    """It moves the follower by a sine of 0.1 mm over the turn, more where the pressure angle changes: 0.1 mm/rad of the greatest
    speed of the modified sine, 1.76 x 12 mm in 100 deg."""
    found = spread("disc-cam")
    ripple = only(copies_findings(found, errors(found, bore=0.1)), "SPEED_RIPPLE")
    share = 0.1 / (1.7596 * 12 / math.radians(100))
    assert share < ripple.values[0] < 1.6 * share and ripple.holds[0] == (ripple.values[0] <= 0.01)


@pytest.mark.parametrize("off", [0.5, -0.5])
def test_pressure_angle_of_a_copy_is_that_of_its_curve(off: float) -> None:
    """The normal at radius R misses the shaft by R sin alpha, and goes on to do so where it meets a pitch curve that is off by so
    much along it, at |R e^(i alpha) + off|. The facets of 1 um tilt it by 0.4 deg."""
    found = spread("disc-cam")
    theta = np.linspace(0, 2 * np.pi, 7201)
    radius, slope = 30 + found.mechanism.motion(theta), found.mechanism.motion(theta, 1)
    pitch = radius * np.exp(1j * np.arctan(slope / radius))
    exact, moved = (
        math.degrees(np.max(np.arcsin(pitch.imag / abs(pitch + each)))) for each in (0.0, off)
    )
    angle = only(copies_findings(found, errors(found, offset=off)), "PRESSURE_ANGLE")
    assert angle.designed == pytest.approx(exact, abs=2e-3)
    assert angle.values[0] - angle.designed == pytest.approx(moved - exact, abs=0.02)


@pytest.mark.long
def test_yield_does_not_hang_on_the_facets() -> None:
    """The mean of copies is the exact design's within their spread, and so are means with facets of 1 and 0.1 um."""
    means = []
    for chord in (1e-3, 1e-4):
        found = spread("disc-cam", f"accuracy.chord_tolerance={chord}")
        angle = only(copies_findings(found, drawn_again(found, 0, range(8))), "PRESSURE_ANGLE")
        assert abs(angle.values.mean() - angle.designed) < angle.values.std()
        means.append(angle.values.mean())
    assert means[0] == pytest.approx(means[1], abs=0.2 * angle.values.std())


@pytest.mark.parametrize("good, count", [(0, 50), (35, 50), (50, 50), (999, 1000), (1, 1)])
def test_how_sure_a_yield_is(good: int, count: int) -> None:
    """Wilson's interval as SciPy has it."""
    from scipy.stats import binomtest

    low, high = binomtest(good, count).proportion_ci(0.95, "wilson")
    assert wilson(np.arange(count) < good) == pytest.approx((100 * low, 100 * high), abs=1e-4)


@pytest.mark.long
def test_yields_are_in_the_report() -> None:
    report = tolerance(SPECS / "disc-cam.toml", SPRUNG, PrintRun(200, 1, 0, judged=4))
    (table,) = [
        each for each in report.tables if each.title.startswith("Findings of the first 4 copies")
    ]
    assert {"SPEED_RIPPLE", "LIFT_OFF", "HERTZ", "PRESSURE_ANGLE"} <= {
        str(row[0]) for row in table.rows
    }
    assert report.numbers["lift_off_yield_percent"] in (0, 25, 50, 75, 100)


@pytest.mark.long
def test_a_finding_that_holds_as_designed_and_few_copies_hold_is_explained() -> None:
    values = np.linspace(0.0, 0.02, 101)
    ripple = CopiesFinding(
        "SPEED_RIPPLE", "contact", "share", 0.01, "<=", 0.0, values, values <= 0.01
    )
    (said,) = _lost([ripple])
    assert "SPEED_RIPPLE of contact holds as designed" in said and "in 50.5 % of copies" in said
    assert "95 % of copies keep to <= 0.019 share" in said  # of values evenly from 0 to 0.02
    angles = np.linspace(20.0, 40.0, 101)
    least = CopiesFinding(
        "TRANSMISSION_ANGLE", "joints", "deg", 30.0, ">=", 35.0, angles, angles >= 30
    )
    (said,) = _lost([least])
    assert "95 % of copies keep to >= 21 deg" in said
    assert not [*_lost([replace(ripple, designed=0.02), replace(ripple, holds=values >= 0)])]
    notes = tolerance(SPECS / "disc-cam.toml", (), PrintRun(2_000, worst=0, judged=20)).notes
    assert any(each.startswith("SPEED_RIPPLE of contact holds as designed") for each in notes)
