"""Motion tasks: published and independently computed laws between any ends, and what must hold for all of them."""

from __future__ import annotations

import math
import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from camgen.errors import SpecError
from camgen.motion.halves import (
    MODIFIED_SINE,
    QUARTER_COSINE,
    TRAPEZOID,
    Halves,
    Shape,
    inflection_for,
    reversal_trapezoid,
    sine_line,
)
from camgen.motion.laws import LAWS, Law, smoothness
from camgen.motion.tasks import (
    CHOICES,
    FAMILIES,
    REST,
    SYNONYMS,
    TASKS,
    End,
    Form,
    PolynomialFamily,
    law_for,
    least,
    shifted,
)

REFERENCE = tomllib.loads(
    (Path(__file__).resolve().parents[1] / "reference" / "motion_tasks.toml").read_text()
)
Row = dict[str, Any]


def ends_of(row: Row) -> tuple[End, End]:
    found = []
    for letter, values in zip(row["task"], (row.get("start"), row.get("end")), strict=True):
        v, a, j = (*(values or ()), *(None,) * 3)[:3]
        open_ = None if letter == "U" else 0.0
        found.append(End(letter, v or 0.0, open_ if a is None else a, j or 0.0))
    return found[0], found[1]


def law_of(row: Row) -> Law:
    start, end = ends_of(row)
    return law_for(
        row["name"], start, end, Form(row.get("lambda"), row.get("line"), row.get("ramp"))
    )


def title(row: Row) -> str:
    return " ".join(str(value) for key, value in row.items() if key != "values")


def near(value: float, printed: str) -> bool:
    """To nine digits."""
    return abs(value - float(printed)) <= 2e-8 * max(1.0, abs(float(printed)))


@pytest.mark.parametrize("row", REFERENCE["law"], ids=title)
def test_reference(row: Row) -> None:
    law = law_of(row)
    c_a, c_a_star = law.accelerations
    formula = law.formula
    if isinstance(formula, Halves):
        c_a, c_a_star = formula.acceleration, formula.deceleration
    assert abs(c_a) <= law.c_a + 1e-12 and abs(c_a_star) <= law.c_a + 1e-12
    values = (law.c_v, c_a, c_a_star, law.c_j, law.c_m, law(0.25), law(0.5), law(0.25, 1))
    for value, printed in zip(values, row["values"], strict=True):
        if math.isinf(float(value)):
            assert printed == "0.0", "between the parabola's jumps there is no jerk"
            continue
        assert near(float(value), printed), (float(value), printed)


@pytest.mark.parametrize("row", REFERENCE["law"][:5], ids=title)
def test_wrong_values_are_found(row: Row) -> None:
    assert not near(law_of(row).c_m * 1.001, row["values"][4])


def test_inflections_from_accelerations() -> None:
    wanted = REFERENCE["inflection"]
    harmonic = Halves(MODIFIED_SINE, QUARTER_COSINE)
    for deceleration, printed in wanted["harmonic_combination"]:
        assert near(inflection_for(harmonic, deceleration), printed)
        law = law_for("harmonic-combination", REST, End("U", a=-deceleration))
        assert float(law(1.0, 2)) == pytest.approx(-deceleration, rel=1e-12)
        back = law_for("harmonic-combination", End("U", a=deceleration), REST)
        assert float(back(0.0, 2)) == pytest.approx(deceleration, rel=1e-12)
    v0, v1, most, printed = wanted["modified_sine"]
    sine = Halves(MODIFIED_SINE, MODIFIED_SINE, v0=v0, v1=v1)
    assert near(inflection_for(sine, most), printed)
    law = law_for("modified-sine", End("G", v0), End("G", v1), Form(deceleration=most))
    assert law.accelerations[1] == pytest.approx(most, rel=1e-9)
    v0, v1, most = wanted["none"]
    assert math.isnan(inflection_for(replace(sine, v0=v0, v1=v1), most))
    with pytest.raises(SpecError, match="lambda between 0 and 1"):
        law_for("modified-sine", End("G", v0), End("G", v1), Form(deceleration=most))
    a0, a1, inflection, moving = wanted["sine_line"]
    found = sine_line(a0, a1)
    assert near(found[0], inflection) and near(1 - found[1], moving)
    law = law_for("sine-line", End("U", a=a0), End("U", a=a1))
    assert (float(law(0.0, 2)), float(law(1.0, 2))) == (pytest.approx(a0), pytest.approx(a1))
    with pytest.raises(SpecError, match="pi\\^2 / 4"):
        law_for("sine-line", End("U", a=2.0), End("U", a=-2.0))


# ---- what holds for all ----------------------------------------------------------------------------------------------

SPEEDS = st.floats(0.05, 1.6)
ACCELERATIONS = st.floats(-6, 6)
INFLECTIONS = st.floats(0.15, 0.85)


def an_end(letter: str, rates: tuple[float, float, float], free: bool) -> End:
    v, a, j = rates
    return {
        "R": REST,
        "G": End("G", v),
        "U": End("U", 0.0, None if free else a),
        "B": End("B", v, a, j),
    }[letter]


SERVED = [
    (name, task) for name, family in FAMILIES.items() for task in TASKS if family.serves(*task)
]


@given(
    st.sampled_from(SERVED),
    st.tuples(SPEEDS, ACCELERATIONS, ACCELERATIONS),
    st.tuples(SPEEDS, ACCELERATIONS, ACCELERATIONS),
    st.one_of(st.none(), INFLECTIONS),
)
def test_ends_are_met(
    which: tuple[str, str],
    first: tuple[float, float, float],
    last: tuple[float, float, float],
    inflection: float | None,
) -> None:
    """s, v and, where the law can, a at both ends, to rounding; with every lambda."""
    name, task = which
    family = FAMILIES[name]
    polynomial = isinstance(family, PolynomialFamily)
    start = an_end(task[0], first, not polynomial)
    end = an_end(task[1], last, not polynomial)
    try:
        law = law_for(name, start, end, Form(inflection))
    except SpecError as error:
        singular = getattr(family, "inflected", False)
        assert singular or (inflection is not None and polynomial and task != "RR"), error
        return
    size = max(1.0, *(abs(x) for x in (*first, *last)))
    if polynomial:
        size *= max(1.0, *(abs(c) for c in getattr(law.formula, "coefficients", (1.0,))))
    for u, side, s in ((0.0, start, 0.0), (1.0, end, 1.0)):
        assert float(law(u)) == pytest.approx(s, abs=1e-14 * size)
        assert float(law(u, 1)) == pytest.approx(side.v, abs=1e-13 * size)
        if law.smoothness >= 2 and side.a is not None:
            assert float(law(u, 2)) == pytest.approx(side.a, abs=1e-12 * size)
    assert law.smoothness >= (2 if name not in ("parabolic", "cubic") else 1)


def by_quadrature(halves: Halves, u: float) -> float:
    """Displacement by integrating the acceleration twice, its sizes from a system of two equations, with mpmath."""
    mpmath.mp.dps = 20
    h1, h2, w = mpmath.mpf(halves.h1), mpmath.mpf(halves.h2), mpmath.mpf(halves.line)

    def shape(each: Shape, t: Any) -> Any:
        for piece in each.pieces:
            if t <= piece.width or piece is each.pieces[-1]:
                k = mpmath.mpf(piece.rate)
                return (
                    piece.constant
                    + piece.sine * mpmath.sin(k * t)
                    + piece.cosine * mpmath.cos(k * t)
                )
            t -= piece.width
        raise AssertionError

    def marks(each: Shape) -> list[Any]:
        return [mpmath.mpf(x) for x in np.cumsum([0.0, *(p.width for p in each.pieces)])]

    def integral(each: Shape, weight: Any) -> Any:
        return mpmath.quad(lambda t: weight(t) * shape(each, t), marks(each))

    alpha = [integral(each, lambda t: 1) for each in (halves.first, halves.second)]
    mu = [integral(each, lambda t: 1 - t) for each in (halves.first, halves.second)]
    # speeds agree on the line; the three ways make 1
    system = mpmath.matrix(
        [[alpha[0] * h1, -alpha[1] * h2], [mu[0] * h1**2 + alpha[0] * h1 * w, mu[1] * h2**2]]
    )
    v0, v1 = halves.v0, halves.v1
    # the second half covers v1 h2 plus what its deceleration adds, less alpha h2^2 times (1 - share)
    right = mpmath.matrix([v1 - v0, 1 - v0 * (h1 + w) - v1 * h2])
    a, b = mpmath.lu_solve(system, right)

    def acceleration(x: Any) -> Any:
        if x < h1:
            return a * shape(halves.first, x / h1)
        return mpmath.mpf(0) if x < h1 + w else -b * shape(halves.second, (1 - x) / h2)

    places = [h1 * m for m in marks(halves.first)] + [1 - h2 * m for m in marks(halves.second)]
    inside = sorted({mpmath.mpf(0), *(p for p in places if 0 < p < u), mpmath.mpf(u)})
    return float(v0 * u + mpmath.quad(lambda x: (u - x) * acceleration(x), inside))


@pytest.mark.parametrize(
    "halves",
    [
        Halves(MODIFIED_SINE, QUARTER_COSINE, 0.4, v0=0.5),
        Halves(TRAPEZOID, reversal_trapezoid(0.25), 0.6, 0.2),
        Halves(QUARTER_COSINE, QUARTER_COSINE, 0.3, 0.7),
        Halves(MODIFIED_SINE, MODIFIED_SINE, 0.7, 0.1, 0.5, 1.5),
    ],
    ids=["harmonic", "trapezoid", "sine-line", "modified-sine"],
)
def test_halves_by_quadrature(halves: Halves) -> None:
    for u in (0.05, 0.31, 0.5, 0.64, 0.93):
        assert float(halves(np.array(u), 0)) == pytest.approx(by_quadrature(halves, u), abs=2e-14)


@given(
    st.sampled_from([row for row in SERVED if row[0] != "cubic"]),
    st.floats(0.02, 0.98),
    INFLECTIONS,
)
def test_derivatives_are_those_of_the_displacement(
    which: tuple[str, str], u: float, inflection: float
) -> None:
    """Between the pieces, by central differences of 30 digits' step: independent of how the pieces are joined."""
    name, task = which
    ends = [an_end(letter, (0.4, 1.0, 1.0), True) for letter in task]
    polynomial = isinstance(FAMILIES[name], PolynomialFamily)
    if polynomial:
        ends = [an_end(letter, (0.4, 1.0, 1.0), False) for letter in task]
    try:
        law = law_for(name, ends[0], ends[1], Form(None if polynomial else inflection))
    except SpecError:
        assume(False)
    assume(min((abs(u - b) for b in (*law.breaks, *kinks(law))), default=1.0) > 2e-3)
    h = 1e-4
    for order in range(3):
        slope = float(law(u + h, order) - law(u - h, order)) / (2 * h)
        scale = max(law.c_j, 100.0) if math.isfinite(law.c_j) else 100.0
        assert slope == pytest.approx(float(law(u, order + 1)), abs=2e-5 * scale)


def kinks(law: Law) -> list[float]:
    """Where pieces of halves meet: the fourth derivative jumps there."""
    halves = law.formula
    if not isinstance(halves, Halves):
        return []
    first = np.cumsum([p.width for p in halves.first.pieces]) * halves.h1
    second = 1 - np.cumsum([p.width for p in halves.second.pieces]) * halves.h2
    return [*first.tolist(), *second.tolist()]


@pytest.mark.long
@given(st.sampled_from(["modified-sine", "cycloidal", "modified-trapezoid"]), INFLECTIONS)
def test_two_routes_to_a_shifted_inflection(name: str, inflection: float) -> None:
    """The symmetric law moved along the straight line is the law of two unequal halves."""
    u = np.linspace(0, 1, 301)
    halves = law_for(name, form=Form(inflection))
    moved = shifted(LAWS[name], inflection)
    for order in range(3):
        np.testing.assert_allclose(moved(u, order), halves(u, order), atol=1e-11)
    assert moved.c_v == pytest.approx(LAWS[name].c_v)
    assert float(moved(inflection)) == pytest.approx(inflection, abs=1e-14)


def test_shifted_laws_declare_their_break() -> None:
    law = shifted(LAWS["3-4-5"], 0.4)
    assert law.breaks == (0.4,) and law.smoothness == 2
    assert law.c_a == pytest.approx(LAWS["3-4-5"].c_a / 0.8)
    assert law.c_j == pytest.approx(60 / 0.64)
    assert shifted(LAWS["3-4-5"], 0.5) is LAWS["3-4-5"]
    with pytest.raises(SpecError, match="not symmetric"):
        shifted(LAWS["double-harmonic"], 0.4)


def test_claims_of_halves_are_those_of_their_formula() -> None:
    """Speed, acceleration and jerk by sampling, and the smoothness that is declared."""
    u = np.linspace(0, 1, 200_001)
    for row in REFERENCE["law"]:
        law = law_of(row)
        if not isinstance(law.formula, Halves):
            continue
        peaks = (law.c_v, law.c_a, law.c_j)
        for order, claim in enumerate(peaks, start=1):
            if math.isfinite(claim):
                sampled = float(np.max(np.abs(law(u, order))))
                assert sampled == pytest.approx(claim, rel=1e-3) and sampled <= claim * (1 + 1e-12)
        assert smoothness(law.formula, law.ends, (1.0, *peaks)) == law.smoothness


# ---- the choice ------------------------------------------------------------------------------------------------------


def test_least_of_the_laws_between_dwells() -> None:
    names = [least(choice, REST, REST, Form()) for choice in CHOICES]
    assert names == ["modified-trapezoid", "cycloidal", "modified-sine"]
    assert least("least-acceleration", REST, End("U", a=None), Form()) == "modified-trapezoid"
    assert least("least-torque", REST, End("U", a=None), Form()) == "harmonic-combination"
    assert least("least-jerk", End("B", 0.5, 2.0), End("B", 1.0, -3.0), Form()) in (
        "3-4-5",
        "4-5-6-7",
    )


def test_every_task_has_a_law() -> None:
    for task in TASKS:
        ends = [an_end(letter, (0.5, 1.0, 0.0), False) for letter in task]
        assert FAMILIES["3-4-5"].serves(*task)
        assert law_for("3-4-5", ends[0], ends[1]).smoothness >= 2


def test_a_law_without_the_task_says_which_it_has() -> None:
    with pytest.raises(SpecError, match="RU, GU, UR, UG"):
        law_for("harmonic-combination")
    with pytest.raises(SpecError, match="a polynomial: it alone can leave"):
        law_for("modified-sine", End("G", 1.0), End("G", 1.0), lift=0.0)


def test_synonyms_are_of_laws() -> None:
    assert set(SYNONYMS.values()) <= {*LAWS, *FAMILIES}
    assert not set(SYNONYMS) & {*LAWS, *FAMILIES}
