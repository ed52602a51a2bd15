"""Canvas: the time that a jet spends at each place, against closed forms and against brute force."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgen.machine.cams.profile import DiscCam, SwingingArm
from camgen.machines.uniform_swing.web_thickness import (
    BlendChoice,
    blend_choice,
    canvas,
    time_below,
)
from camgen.motion.laws import Floats
from camgen.motion.program import uniform_swing

THETA = np.linspace(0, 2 * math.pi, 14401)
SWING = math.radians(30)
ARM = SwingingArm(60 + 0j, complex(-60, -30), 3.0, 1)


def brute(levels: Floats, theta: Floats, s: Floats) -> Floats:
    """Share of the turn below each level, stretch by stretch."""
    low, high, spans = np.minimum(s[:-1], s[1:]), np.maximum(s[:-1], s[1:]), np.diff(theta)
    shares = []
    for level in levels:
        part = [
            span * (float(level >= a) if a == b else min(max((level - a) / (b - a), 0.0), 1.0))
            for a, b, span in zip(low, high, spans, strict=True)
        ]
        shares.append(math.fsum(part) / (theta[-1] - theta[0]))
    return np.array(shares)


@given(
    st.lists(
        st.tuples(st.floats(0.01, 1), st.floats(-2, 2).map(lambda x: round(x, 3))),
        min_size=2,
        max_size=30,
    )
)
def test_time_below_as_stretch_by_stretch(stretches: list[tuple[float, float]]) -> None:
    theta = np.cumsum([span for span, _ in stretches])
    s = np.array([place for _, place in stretches])
    levels = np.linspace(-2.1, 2.1, 23) + 1e-4  # never on a rounded place: a rest jumps there
    share = time_below(levels, theta, s)
    assert np.allclose(share, brute(levels, theta, s), atol=1e-9)
    assert share[0] == pytest.approx(0, abs=1e-12) and share[-1] == pytest.approx(1)


def test_stretches_that_rest_but_for_rounding_do_no_harm() -> None:
    s = np.concatenate([np.linspace(-1, 0, 50), 1e-16 * np.arange(20), np.linspace(1e-14, 1, 50)])
    theta = np.arange(len(s), dtype=float)
    levels = np.linspace(-0.9, 0.9, 10) + 0.01
    assert np.allclose(time_below(levels, theta, s), brute(levels, theta, s), atol=1e-9)


def test_sine_lays_the_arcsine_law() -> None:
    levels = np.linspace(-0.99, 0.99, 41)
    assert np.allclose(
        time_below(levels, THETA, np.sin(THETA)), 0.5 + np.arcsin(levels) / math.pi, atol=1e-6
    )


def test_uniform_swing_lays_an_even_canvas() -> None:
    s = uniform_swing(SWING)(THETA)
    even = canvas(THETA, s)
    assert np.allclose(even.thickness, 1, atol=1e-9) and even.share == 1 and even.spread() < 1e-9
    # flat collector: cos^2 of the angle, -6.7 % at 15 deg  [uniform-swing cam, thickness of the canvas]
    flat = canvas(THETA, s, flat=True, strips=1001)
    angle = np.arctan(flat.place * math.tan(SWING / 2))
    assert np.allclose(flat.thickness / flat.thickness[500], np.cos(angle) ** 2, atol=1e-6)
    assert flat.thickness[0] / flat.thickness[500] - 1 == pytest.approx(-0.067, abs=3e-4)
    assert flat.spread() > flat.spread(0.5) > 0


def test_a_rest_shows_as_a_ridge() -> None:
    theta = np.array([0.0, 1.0, 2.0, 4.0])
    ridge = canvas(theta, np.array([-1.0, 0.0, 0.0, 1.0]), strips=11)
    assert int(np.argmax(ridge.thickness)) == 5 and ridge.share < 1
    assert ridge.thickness[-1] == pytest.approx(2 * ridge.thickness[0])
    assert time_below(
        np.array([-1e-6, 0.0]), theta, np.array([-1.0, 0.0, 0.0, 1.0])
    ) == pytest.approx([0.25, 0.5], abs=1e-5)


def test_right_angle_on_a_flat_collector_is_refused() -> None:
    with pytest.raises(ValueError, match="flat collector"):
        canvas(THETA, np.radians(90) * np.sin(THETA), flat=True)


def test_share_and_acceleration_of_a_blend_by_another_route() -> None:
    blends = np.radians([30.0, 60.0, 90.0])
    made = BlendChoice(
        *np.transpose([blend_choice(SWING, ARM, blend, strips=4000) for blend in blends])
    )
    # thickness is 1 / speed; speed falls below 1 / 1.1 at u, from where the edge of the swing is too thick
    u = mpmath.findroot(
        lambda x: 1 - 2 * (10 * x**3 - 15 * x**4 + 6 * x**5) - 1 / mpmath.mpf("1.1"), 0.2
    )
    left = float(mpmath.quad(lambda x: 1 - 2 * (10 * x**3 - 15 * x**4 + 6 * x**5), [u, 0.5]))
    for blend, share, peak in zip(blends, made.share_round, made.acceleration, strict=True):
        program = uniform_swing(SWING, blend)
        speed = program(np.array([math.pi / 2]), 1)[0]
        assert share == pytest.approx(1 - 2 * left * blend * speed / SWING, abs=2 / 4000)
        assert peak == pytest.approx(np.max(np.abs(program(THETA, 2))), rel=1e-5)
    assert np.all(made.undercut == 0)


def test_undercut_falls_with_the_blend_and_the_share_too() -> None:
    blends = np.radians([0.0, 1.0, 2.0, 3.0, 5.0, 20.0, 180.0]).tolist()
    made = BlendChoice(*np.transpose([blend_choice(SWING, ARM, blend) for blend in blends]))
    assert math.degrees(made.undercut[0]) == pytest.approx(0.0728, abs=1e-4)
    assert np.all(np.diff(made.undercut[:5]) < 0) and np.all(made.undercut[4:] == 0)
    assert math.isinf(made.acceleration[0]) and np.all(np.diff(made.acceleration[1:]) < 0)
    assert made.share_round[0] > 0.99 and np.all(np.diff(made.share_round) <= 0)
    # where no undercut is said to be without making the profile, making it finds none
    assert DiscCam(uniform_swing(SWING, math.radians(5)), ARM).undercuts == ()
