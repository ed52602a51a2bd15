"""Fourier laws from a spring's characteristic: closed forms, another solver, and MR-13 as one point of the family."""

from __future__ import annotations

import math
import tomllib
from functools import cache
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import linprog

from camgen.errors import DesignError, SpecError
from camgen.motion.laws import LAWS, MR_13_COSINES, MR_13_SINES, end_speed, harmonics
from camgen.motion.spring_law import (
    Characteristic,
    Synthesis,
    characteristic,
    judged,
    synthesise,
    trade_off,
)

MR_13 = tomllib.loads(
    (Path(__file__).resolve().parents[1] / "reference" / "motion_laws.toml").read_text()
)["mr_13"]
WEIGHTS = (0.0, 0.1, 1.0, 3.0, 10.0, 30.0, 100.0, 1e3, 1e4)


@cache
def own() -> Characteristic:
    """The characteristic that MR-13 itself defines: G = c / Y over a, with the card's Y."""
    kappa = np.linspace(0, 0.5, 4001)
    law = LAWS["mr-13"]
    a, g = law(kappa), law(kappa, 2) / MR_13["factor"]
    a[-1] = 0.5
    return characteristic(list(zip(a, g, strict=True)))


@cache
def family() -> tuple[Synthesis, ...]:
    return tuple(trade_off(own(), WEIGHTS))


def test_mr_13_leaves_nothing_for_the_characteristic_that_it_defines() -> None:
    law = judged(own(), MR_13_SINES, MR_13_COSINES, 1.0)
    assert law.rest < 1e-6 and law.factor == pytest.approx(MR_13["factor"], abs=1e-6)
    assert law.peak == pytest.approx(LAWS["mr-13"].c_a, rel=1e-12)


@pytest.mark.parametrize("weight, near", [(1e3, 0.014), (1e4, 1.4e-3), (1e6, 2e-5)])
def test_mr_13_is_close_to_optimal_where_the_rest_counts(weight: float, near: float) -> None:
    """The optimum nears MR-13's coefficients as 1/q, and its objective is hardly lower than MR-13's own."""
    best, own_law = synthesise(own(), weight), judged(own(), MR_13_SINES, MR_13_COSINES, weight)
    assert (
        np.max(np.abs(np.subtract(best.sines + best.cosines, MR_13_SINES + MR_13_COSINES))) < near
    )
    assert 0.996 * own_law.objective < best.objective < (1 + 1e-6) * own_law.objective
    assert best.factor == pytest.approx(MR_13["factor"], abs=near)


def test_the_misprinted_law_is_far_from_optimal() -> None:
    """With the printed sign of A6, closed by the cosine, the cam has 0.1 to do that the spring could."""
    sines = (*MR_13_SINES[:-1], -MR_13_SINES[-1])
    cosine = MR_13_COSINES[0] + end_speed(sines, MR_13_COSINES) * math.pi**2 / 2
    assert judged(own(), sines, (cosine,), 1.0).rest > 0.03


def test_trade_off_is_a_trade() -> None:
    """A larger weight never lowers the peak nor raises the rest; the curve is convex in C^2 and Y^2."""
    peaks, rests = ([getattr(s, name) ** 2 for s in family()[1:]] for name in ("peak", "rest"))
    assert all(a < b for a, b in pairwise(peaks)) and all(a > b for a, b in pairwise(rests))
    slopes = [
        (p - q) / (s - r) for (p, q), (r, s) in zip(pairwise(peaks), pairwise(rests), strict=True)
    ]
    assert all(a < b for a, b in pairwise([abs(x) for x in slopes]))
    assert [s.weight for s in family()] == list(WEIGHTS)


@pytest.mark.long
@pytest.mark.parametrize("index", [1, 3, 4, 6])
def test_nothing_near_by_is_better(index: int) -> None:
    """Random laws round the best, closed again, at their best factor: none beats it by more than the positions' spacing."""
    best, rng = family()[index], np.random.default_rng(5)
    w, z = harmonics(5, 1)
    closes = np.concatenate((1 / w, 2 / z**2))
    for size in (1e-3, 1e-2, 0.1):
        for _ in range(4):
            x = np.array(best.sines + best.cosines) + size * rng.standard_normal(6)
            x /= closes @ x
            assert judged(
                own(), tuple(x[:5]), tuple(x[5:]), best.weight
            ).objective > best.objective * (1 - 3e-4)


def test_the_lowest_peak_by_linear_programming() -> None:
    """Weight 0 is a linear program: least t with |c| <= t; its optimum by another solver on a finer grid."""
    kappa = np.linspace(0, 0.5, 1001)
    w, z = harmonics(5, 1)
    c = np.hstack(
        (
            np.sin(np.multiply.outer(kappa, w)),
            np.cos(np.multiply.outer(kappa, z)),
            -np.ones((1001, 1)),
        )
    )
    d = c * ([-1] * 6 + [1])
    found = linprog(
        [0] * 6 + [1],
        np.vstack((c, d)),
        np.zeros(2002),
        [[*(1 / w), *(2 / z**2), 0]],
        [1],
        bounds=(None, None),
    )
    assert family()[0].peak == pytest.approx(found.fun, rel=3e-4)


def test_the_way_to_the_optimum_does_not_matter() -> None:
    for s in family()[1:7:2]:
        assert synthesise(own(), s.weight).objective == pytest.approx(s.objective, rel=1e-6)
    again = synthesise(own(), 10.0)
    assert again.sines == synthesise(own(), 10.0).sines


@pytest.mark.parametrize("scale", [1.0, 250.0])
def test_a_straight_characteristic_gives_simple_harmonic_motion(scale: float) -> None:
    """G = 1 - 2 a: a free oscillation, a = (1 - cos pi kappa) / 2, B1 = f = pi^2/2; by formula and by table."""
    table = characteristic([(a, scale * (1 - 2 * a)) for a in (0, 0.1, 0.35, 0.5)])
    for torque in (lambda a: scale * (1 - 2 * a), table):
        best = synthesise(torque, 1e6)
        assert (
            best.cosines[0] == pytest.approx(math.pi**2 / 2, abs=1e-3)
            and max(map(abs, best.sines)) < 1e-3
        )
        assert best.factor * scale == pytest.approx(math.pi**2 / 2, abs=2e-3) and best.rest < 2e-3
        u = np.linspace(0, 1, 99)
        np.testing.assert_allclose(best.law(u), LAWS["simple-harmonic"](u), atol=1e-3)


@pytest.mark.parametrize(
    "points, paths",
    [
        ([(0, 1), (0.5, 0)], ["points"]),
        ([(0, 1), (0.2, 1), (0.4, 0)], ["points"]),
        ([(0, 1), (0.3, 1), (0.2, 1), (0.5, 0)], ["points.2"]),
    ],
)
def test_tables_that_are_no_characteristic(
    points: list[tuple[float, float]], paths: list[str]
) -> None:
    with pytest.raises(SpecError) as error:
        characteristic(points)
    assert [fault.key for fault in error.value.faults] == paths


def test_what_cannot_be_synthesised() -> None:
    for weight in (-1.0, math.nan, math.inf):
        with pytest.raises(SpecError, match="weight"):
            synthesise(own(), weight)
    with pytest.raises(SpecError, match="two terms"):
        synthesise(own(), 1.0, 1, 0)
    for torque in (lambda a: 0 * a, lambda a: a * math.nan):
        with pytest.raises(DesignError, match="spring torque"):
            synthesise(torque, 1.0)
