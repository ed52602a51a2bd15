"""The program of a uniform swing: peaks, uniform stretch, joints, derivatives."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgen.program import Program, uniform_swing

SWING = math.radians(30)
BLENDS = [0.0, math.radians(0.01), 0.1, 0.3, 1.0, 3.0, math.radians(179.99), math.pi]


def reference(theta: mpmath.mpf, swing: mpmath.mpf, blend: mpmath.mpf) -> mpmath.mpf:
    """The swing again: speed is a trapezoid of 3-4-5 flanks, integrated once by hand."""
    speed = swing / (mpmath.pi - blend * (1 - 2 * mpmath.mpf(11) / 32))
    theta = mpmath.fmod(theta, 2 * mpmath.pi)
    mirrored = 2 * mpmath.pi - theta if theta > mpmath.pi else theta  # the return is the rise run backwards
    from_middle = mirrored - mpmath.pi / 2
    side, x = mpmath.sign(from_middle), abs(from_middle)
    straight = (mpmath.pi - blend) / 2
    if x <= straight:
        return side * speed * x
    u = (x - straight) / blend
    return side * speed * (straight + blend * (u - 5 * u**4 + 6 * u**5 - 2 * u**6))


@pytest.mark.parametrize("blend", BLENDS)
def test_peaks_are_half_the_swing(blend: float) -> None:
    program = uniform_swing(SWING, blend)
    assert float(program(0.0)) == pytest.approx(-SWING / 2, abs=1e-15)
    assert float(program(math.pi)) == pytest.approx(SWING / 2, abs=1e-15)
    assert np.max(np.abs(program(np.linspace(-7, 7, 20_001)))) <= SWING / 2 + 1e-15


@pytest.mark.parametrize("blend", BLENDS)
def test_uniform_stretch_is_exactly_uniform(blend: float) -> None:
    program = uniform_swing(SWING, blend)
    inside = np.linspace(blend / 2, math.pi - blend / 2, 999)[1:-1]
    if blend < math.pi:
        for side, sign in ((inside, 1), (inside + math.pi, -1)):
            assert np.ptp(program(side, 1)) == 0
            assert not np.any(program(side, 2)) and not np.any(program(side, 3))
            assert float(program(side[0], 1)) == pytest.approx(sign * SWING / (math.pi - blend * 5 / 16), rel=1e-12)
    assert float(np.max(np.abs(program(np.linspace(0, 7, 9001), 1)))) <= SWING / (math.pi - blend * 5 / 16) * (
        1 + 1e-12
    )


def smooth_up_to(program: Program) -> int:
    order = -1
    while order < 3 and np.max(np.abs(program.jumps(order + 1))) <= 1e-12 * max(
        float(np.max(np.abs(s.scale / s.span ** (order + 1)))) for s in program.segments
    ):
        order += 1
    return order


@pytest.mark.parametrize("blend", BLENDS)
def test_joints(blend: float) -> None:
    """Sharp: only s continues. Blended: s, v, a and j do. Two turns alone (blend = pi): the same."""
    program = uniform_swing(SWING, blend)
    assert smooth_up_to(program) == (0 if blend == 0 else 3)
    assert len(program.segments) == (2 if blend in (0, math.pi) else 4)
    assert program.joints[-1] - program.joints[0] == pytest.approx(2 * math.pi, abs=1e-14)
    if blend == 0:
        assert np.abs(program.jumps(1)) == pytest.approx([2 * SWING / math.pi] * 2, rel=1e-14)


@pytest.mark.parametrize("blend", [0.0, 0.3, 1.0, math.pi])
def test_derivatives(blend: float) -> None:
    mpmath.mp.dps = 40
    program = uniform_swing(SWING, blend)
    exact = (mpmath.mpf(SWING), mpmath.mpf(blend) if blend < math.pi else mpmath.pi)
    for theta in (0.011, 0.4, 1.7, 2.9, 3.3, 4.1, 6.2, 6.27):
        for order in range(4):
            f = lambda x: reference(x, *exact)  # noqa: E731
            truth = mpmath.diff(f, mpmath.mpf(theta), order, h=mpmath.mpf(10) ** -10) if order else f(mpmath.mpf(theta))
            assert float(program(theta, order)) == pytest.approx(float(truth), abs=2e-12 * (1 + abs(float(truth))))


@given(st.floats(1e-4, 3.1), st.one_of(st.just(0.0), st.floats(2e-4, math.pi)), st.floats(-50, 50))
def test_symmetry_and_period(swing: float, blend: float, theta: float) -> None:
    program = uniform_swing(swing, blend)
    here = float(program(theta))
    assert float(program(-theta)) == pytest.approx(here, abs=1e-13)
    assert float(program(theta + math.pi)) == pytest.approx(-here, abs=1e-13)
    assert float(program(theta + 2 * math.pi)) == pytest.approx(here, abs=1e-13)
