"""Programs: the uniform swing, matched segments, jumps, Norton's double dwell."""

from __future__ import annotations

import math
import tomllib
from itertools import pairwise
from pathlib import Path

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgen.motion.laws import LAWS, UNIFORM, Law, modified_sine
from camgen.motion.program import Program, Segment, matched, uniform_swing

NORTON = tomllib.loads(
    (Path(__file__).resolve().parents[1] / "reference" / "motion_laws.toml").read_text()
)["norton"]
SWING = math.radians(30)
BLENDS = [0.0, math.radians(0.01), 0.1, 0.3, 1.0, 3.0, math.radians(179.99), math.pi]


def reference(theta: mpmath.mpf, swing: mpmath.mpf, blend: mpmath.mpf) -> mpmath.mpf:
    """The swing again: speed is a trapezoid of 3-4-5 flanks, integrated once by hand."""
    speed = swing / (mpmath.pi - blend * (1 - 2 * mpmath.mpf(11) / 32))
    theta = mpmath.fmod(theta, 2 * mpmath.pi)
    mirrored = (
        2 * mpmath.pi - theta if theta > mpmath.pi else theta
    )  # the return is the rise run backwards
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
            assert float(program(side[0], 1)) == pytest.approx(
                sign * SWING / (math.pi - blend * 5 / 16), rel=1e-12
            )
    assert float(np.max(np.abs(program(np.linspace(0, 7, 9001), 1)))) <= SWING / (
        math.pi - blend * 5 / 16
    ) * (1 + 1e-12)


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
            truth = (
                mpmath.diff(f, mpmath.mpf(theta), order, h=mpmath.mpf(10) ** -10)
                if order
                else f(mpmath.mpf(theta))
            )
            assert float(program(theta, order)) == pytest.approx(
                float(truth), abs=2e-12 * (1 + abs(float(truth)))
            )


@given(st.floats(1e-4, 3.1), st.one_of(st.just(0.0), st.floats(2e-4, math.pi)), st.floats(-50, 50))
def test_symmetry_and_period(swing: float, blend: float, theta: float) -> None:
    program = uniform_swing(swing, blend)
    here = float(program(theta))
    assert float(program(-theta)) == pytest.approx(here, abs=1e-13)
    assert float(program(theta + math.pi)) == pytest.approx(-here, abs=1e-13)
    assert float(program(theta + 2 * math.pi)) == pytest.approx(here, abs=1e-13)


# ---- double dwell ----------------------------------------------------------------------------------------------------

QUARTER = math.pi / 2


def double_dwell(law: Law, lift: float = 1.0) -> Program:
    dwells = [Segment("dwell", QUARTER, level, 0.0, UNIFORM) for level in (0.0, lift)]
    return Program(
        (
            dwells[0],
            Segment("rise", QUARTER, 0, lift, law),
            dwells[1],
            Segment("return", QUARTER, lift, -lift, law),
        )
    )


@pytest.mark.parametrize("name", NORTON["peaks"])
def test_norton_running_example(name: str) -> None:
    """Peaks of v, a, j in inches and seconds at one turn a second, as printed."""
    program = double_dwell(LAWS[name])
    theta = np.unique(
        np.concatenate(
            (np.linspace(0, 2 * math.pi, 40_001), program.breaks, program.breaks - 1e-12)
        )
    )
    for order, printed in enumerate(NORTON["peaks"][name], start=1):
        peak = float(np.max(np.abs(program(theta, order)))) * NORTON["speed"] ** order
        unit = 10.0 ** -len(printed.partition(".")[2])
        assert abs(peak - float(printed)) <= 0.5001 * unit
        assert abs(peak * (1 + 2 * unit / peak) - float(printed)) > unit


# ---- jumps -----------------------------------------------------------------------------------------------------------


def test_jumps_are_found_with_order_place_and_size() -> None:
    harmonic = double_dwell(LAWS["simple-harmonic"], 3.0).discontinuities()
    step = 3 * math.pi**2 / 2 / QUARTER**2
    expected = [(2, k * QUARTER, sign * step) for k, sign in ((0, -1), (1, 1), (2, 1), (3, -1))]
    assert sorted((j.order, j.theta, j.size) for j in harmonic) == [
        (o, pytest.approx(th), pytest.approx(size)) for o, th, size in sorted(expected)
    ]
    uniform = double_dwell(UNIFORM, 3.0).discontinuities()
    assert [(j.order, j.size) for j in uniform] == [
        (1, pytest.approx(s * 3 / QUARTER)) for s in (1, 1, -1, -1)
    ]
    assert double_dwell(LAWS["cycloidal"]).discontinuities() == []
    assert [j.order for j in double_dwell(LAWS["cycloidal"]).discontinuities(3)] == [3] * 4
    assert double_dwell(LAWS["4-5-6-7"]).discontinuities(3) == []


def test_jumps_inside_a_law_are_found() -> None:
    found = [(j.order, j.theta) for j in double_dwell(LAWS["parabolic"]).discontinuities()]
    assert (
        (2, pytest.approx(1.5 * QUARTER)) in found
        and (2, pytest.approx(3.5 * QUARTER)) in found
        and len(found) == 6
    )
    law = modified_sine(0.2)
    jerks = [j.theta for j in double_dwell(law).discontinuities(3)]
    assert len(jerks) == 8 and min(abs(t - 1.4 * QUARTER) for t in jerks) < 1e-12


def test_mr_13_joins_a_dwell_in_speed_to_its_printed_decimals() -> None:
    orders = {j.order for j in double_dwell(LAWS["mr-13"]).discontinuities()}
    assert orders == {2}


def test_a_program_that_jumps_or_does_not_close_shows_it() -> None:
    broken = Program(
        (
            Segment("rise", math.pi, 0, 1, LAWS["3-4-5"]),
            Segment("return", math.pi, 1.5, -1, LAWS["3-4-5"]),
        )
    )
    assert [(j.order, j.theta, j.size) for j in broken.discontinuities()] == [
        (0, 0.0, pytest.approx(-0.5)),
        (0, pytest.approx(math.pi), pytest.approx(0.5)),
    ]


def test_breaks_are_joints_and_breaks_of_laws() -> None:
    program = double_dwell(LAWS["parabolic"])
    np.testing.assert_allclose(program.breaks, QUARTER * np.array([0, 1, 1.5, 2, 3, 3.5, 4]))


# ---- matched segments ------------------------------------------------------------------------------------------------


def test_matched_between_dwells_is_the_345() -> None:
    (segment,) = matched([2.0], [1.0, 4.0], (0.0, 0.0), (0.0, 0.0))
    u = np.linspace(0, 1, 101)
    for order in range(4):
        np.testing.assert_allclose(
            segment.at(2 * u, order),
            3 / 2**order * LAWS["3-4-5"](u, order) + (order == 0),
            atol=1e-12,
        )


def test_matched_runs_into_a_uniform_stretch() -> None:
    """Dwell, quintic run-up, uniform, quintic run-down, dwell ... joins in s, v and a everywhere."""
    q = [0.4, 0.8, 0.5, 1.2]
    speed = 3 / q[1]
    up = matched([q[0]], [0.0, 1.0], (0, 0), (speed, 0))
    down = matched([q[2]], [4.0, 5.0], (speed, 0), (0, 0))
    back = 2 * math.pi - sum(q)
    program = Program(
        (
            *up,
            Segment("rise", q[1], 1, 3, UNIFORM),
            *down,
            Segment("dwell", q[3], 5, 0.0, UNIFORM),
            Segment("return", back, 5, -5, LAWS["3-4-5"]),
        )
    )
    assert program.discontinuities() == []
    assert program.discontinuities(3) != []


def test_matched_chain_continues_jerk_and_the_fourth_derivative() -> None:
    spans, levels = [0.7, 0.4, 0.9], [0.0, 1.0, 2.5, 3.0]
    chain = matched(spans, levels, (0.1, -0.2), (0.3, 0.4))
    ends = [(s.at(0.0, k), s.at(s.span, k)) for k in range(4) for s in chain]
    assert ends[0][0] == 0 and ends[2][1] == pytest.approx(3)
    assert (float(chain[0].at(0, 1)), float(chain[0].at(0, 2))) == (
        pytest.approx(0.1),
        pytest.approx(-0.2),
    )
    assert (float(chain[2].at(0.9, 1)), float(chain[2].at(0.9, 2))) == (
        pytest.approx(0.3),
        pytest.approx(0.4),
    )
    for left, right in pairwise(chain):
        for order in range(4):
            assert float(left.at(left.span, order)) == pytest.approx(
                float(right.at(0, order)), rel=1e-9, abs=1e-9
            )
        h = 1e-4  # of the jerk, which is a parabola: one-sided differences with three points are exact
        slopes = [
            float(3 * s.at(x, 3) - 4 * s.at(x - d, 3) + s.at(x - 2 * d, 3)) / (2 * d)
            for s, x, d in ((left, left.span, h), (right, 0.0, -h))
        ]
        assert slopes[0] == pytest.approx(slopes[1], rel=1e-6, abs=1e-4)


@given(
    st.lists(st.tuples(st.floats(0.2, 2), st.floats(-5, 5)), min_size=2, max_size=6).filter(
        lambda rows: all(
            abs(a[1] - b[1]) > 0.05 for a, b in zip(rows, rows[1:] + rows[:1], strict=True)
        )
    )
)
def test_a_whole_turn_of_matched_segments_joins_itself(rows: list[tuple[float, float]]) -> None:
    spans = [2 * math.pi * r[0] / sum(x[0] for x in rows) for r in rows]
    levels = [r[1] for r in rows]
    program = Program(tuple(matched(spans, [*levels, levels[0]])))
    assert program.discontinuities(3) == []
    np.testing.assert_allclose(program(program.joints[:-1]), levels, atol=1e-9)
    turning = [
        k
        for k in range(len(rows))
        if (levels[k] - levels[k - 1]) * (levels[(k + 1) % len(rows)] - levels[k]) < 0
    ]
    assert np.max(np.abs(program(program.joints[turning], 1))) < 1e-8 * (
        1 + np.max(np.abs(program(program.joints[:-1], 1)))
    )
