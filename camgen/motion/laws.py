"""Laws of motion: one frozen record a law, with its claims beside its formula.

    law         displacement of a rise of 1 over the position u = 0..1 in a segment, with derivatives to u
    C_v C_a C_j largest |first|, |second| and |third| derivative inside the segment; inf where a lower one jumps inside
    C_a*        largest deceleration, -f''; C_a of a law with an inflection is the largest acceleration before it
    C_M         largest |f' f''|: what an inertia asks of the drive
    smoothness  highest derivative that is continuous where the law joins what it is made to join, mostly a dwell
    break       place inside the segment where a derivative of order 0..3 jumps

Laws without a parameter stand in LAWS; `modified_sine`, `fourier`, `polynomial_law` and `table_law` make the others.
[VDI 2143: names and constants]
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from fractions import Fraction
from functools import cached_property, lru_cache, partial
from typing import Any, Protocol

import numpy as np

from camgen.errors import Fault, SpecError, counted
from camgen.motion.halves import MODIFIED_SINE, PARABOLA, TRAPEZOID, Halves
from camgen.numerics import Floats as Floats
from camgen.numerics import greatest, magnitude
from camgen.tolerances import LAW_CLOSES

Ends = tuple[tuple[float, ...], tuple[float, ...]]


class Formula(Protocol):
    """u (n,) and the order of a derivative, 0..3, to its values (n,)."""

    def __call__(self, u: Floats, order: int) -> Floats:
        """Values of the derivative."""


DWELLS: Ends = ((0.0,), (1.0,))
_BESIDE = 1e-12  # of a segment, from a break to the law on either side of it


@dataclass(frozen=True)
class Law:
    """A normalised law of motion; ValueError where the formula does not end as smoothly as declared."""

    name: str
    # formula(u, order): u in 0..1, (n,), to the derivative of order 0..3, (n,); at a break the later side counts
    formula: Formula
    smoothness: int  # highest order up to which every derivative continues the ends
    c_v: float  # greatest sizes of the first, second and third derivative
    c_a: float
    c_j: float
    source: str
    breaks: tuple[float, ...] = ()
    ends: Ends = (
        DWELLS  # displacement and derivatives of what it joins, before and after; the rest 0
    )
    smooth: bool = (
        False  # whether at the breaks only the third derivative jumps: one curve runs through all
    )
    rounding: float = 0.0  # of a table: share of C_a that the rounding of its rows can make

    def __post_init__(self) -> None:
        order = smoothness(self.formula, self.ends, (1.0, self.c_v, self.c_a, self.c_j))
        if order < self.smoothness:
            raise ValueError(
                f"law {self.name}: smooth to order {order}, {self.smoothness} is declared"
            )

    def __call__(self, u: Any, order: int = 0) -> Floats:
        """Displacement (order 0) or its derivative to u, (n,)."""
        return self.formula(np.asarray(u, float), order)

    # looked for once, for all segments of all programs with this law

    @cached_property
    def accelerations(self) -> tuple[float, float]:
        """C_a and C_a*: greatest acceleration and greatest deceleration."""
        forwards = greatest_between(lambda u: self(u, 2), self.breaks)
        return forwards, greatest_between(lambda u: -self(u, 2), self.breaks)

    @cached_property
    def c_m(self) -> float:
        """C_M, the largest |f' f''|."""
        return largest(lambda u: self(u, 1) * self(u, 2), self.breaks)

    @cached_property
    def end_values(self) -> Sequence[tuple[float, float]]:
        """Displacement and derivatives of order 1..3 at u = 0 and u = 1, (4,)."""
        return [(float(self(0.0, order)), float(self(1.0, order))) for order in range(4)]

    @cached_property
    def steps(self) -> Sequence[Sequence[float]]:
        """By how much displacement and derivatives of order 1..3 jump at the breaks, (4, m)."""
        u = np.array(self.breaks)
        return [
            (self(u + _BESIDE, order) - self(u - _BESIDE, order)).tolist() for order in range(4)
        ]

    @cached_property
    def extremes(self) -> tuple[float, float]:
        """Least and greatest displacement."""
        return -greatest(lambda u: -self(u), 0.0, 1.0, self.breaks)[1], greatest(
            self, 0.0, 1.0, self.breaks
        )[1]


@lru_cache(maxsize=256)
def reversed_law(law: Law) -> Law:
    """The law passed backwards: law(1) - law(1 - u), again from 0."""
    top = float(law(1.0))
    breaks = tuple(1 - b for b in reversed(law.breaks))

    def formula(u: Floats, order: int) -> Floats:
        back = 1 - u
        back = np.where(
            np.isin(u, breaks), np.nextafter(back, 0.0), back
        )  # the later side is the earlier one there
        value = law.formula(back, order)
        return np.asarray(top - value if order == 0 else -((-1) ** order) * value)

    before, after = (
        [top - end[0], *(-((-1) ** k) * v for k, v in enumerate(end[1:], 1))]
        for end in reversed(law.ends)
    )
    return replace(law, formula=formula, breaks=breaks, ends=(tuple(before), tuple(after)))


def smoothness(formula: Formula, ends: Ends, peaks: Sequence[float]) -> int:
    """Highest order 0..3 up to which every derivative continues the ends; -1 where the displacement does not.

    peaks: largest value of each order; a step counts from LAW_CLOSES of it.
    """
    for order in range(4):
        slack = LAW_CLOSES * max(1.0, peaks[order] if math.isfinite(peaks[order]) else 1.0)
        for u, side in zip((0.0, 1.0), ends, strict=True):
            beside = side[order] if order < len(side) else 0.0
            if not abs(float(formula(np.asarray(u), order)) - beside) <= slack:
                return order - 1
    return 3


def largest(f: Callable[[Floats], Floats], breaks: Sequence[float] = ()) -> float:
    """Largest |f(u)| on 0..1 for f smooth between the breaks."""
    return max(0.0, greatest_between(lambda u: np.abs(f(u)), breaks))


def greatest_between(f: Callable[[Floats], Floats], breaks: Sequence[float] = ()) -> float:
    """Greatest f(u) on 0..1 for f smooth between the breaks: even samples, zoomed in on the best of each stretch."""
    marks = [0.0, *breaks, 1.0]
    peaks = []
    for begin, end in zip(marks, marks[1:], strict=False):
        last = end if end == 1 else math.nextafter(end, begin)
        peaks.append(greatest(f, begin, last, count=max(33, 4097 // len(marks)))[1])
    return max(peaks)


def measured(
    name: str, formula: Formula, source: str, breaks: tuple[float, ...] = (), ends: Ends = DWELLS
) -> Law:
    """A law whose constants and smoothness are found from its formula, for the laws that come with parameters."""
    v, a, j = (largest(partial(formula, order=order), breaks) for order in (1, 2, 3))
    return Law(
        name, formula, smoothness(formula, ends, (1.0, v, a, j)), v, a, j, source, breaks, ends
    )


# ---- polynomials -----------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Polynomial:
    """Formula of a polynomial law, its coefficients from u^0 upwards; of any order."""

    coefficients: tuple[float, ...]

    def __call__(self, u: Floats, order: int) -> Floats:
        """Values of the derivative, by Horner's scheme."""
        *rest, value = [math.perm(k, order) * c for k, c in enumerate(self.coefficients)][
            order:
        ] or [0.0]
        result = np.full(np.shape(u), float(value))
        for c in reversed(rest):
            result = result * u + c
        return result


def polynomial(*coefficients: float) -> Polynomial:
    """The same of coefficients one by one."""
    return Polynomial(coefficients)


Condition = tuple[float, int, float]


def coefficients_from(conditions: Sequence[Condition]) -> tuple[Fraction, ...]:
    """Coefficients, from u^0 upwards, of the polynomial with these (u, order, value); solved in exact fractions.

    SpecError where the conditions repeat or contradict each other, or do not fix the polynomial.
    """
    n = len(conditions)
    rows = []
    for at, order, value in conditions:
        u = Fraction(at)
        row = [
            Fraction(math.perm(k, order)) * u ** (k - order) if k >= order else Fraction(0)
            for k in range(n)
        ]
        rows.append([*row, Fraction(value)])
    for k in range(n):
        pivot = next((r for r in range(k, n) if rows[r][k]), None)
        if pivot is None:
            raise SpecError(
                [
                    Fault(
                        ("conditions",),
                        f"{n} of them",
                        "conditions that fix one polynomial, none twice",
                    )
                ]
            )
        rows[k], rows[pivot] = rows[pivot], rows[k]
        rows[k] = [x / rows[k][k] for x in rows[k]]
        for r in range(n):
            if r != k and rows[r][k]:
                rows[r] = [x - rows[r][k] * y for x, y in zip(rows[r], rows[k], strict=True)]
    return tuple(row[n] for row in rows)


def polynomial_law(conditions: Sequence[Condition]) -> Law:
    """The polynomial law with these (u, order, value); SpecError where there is none or it does not run from 0 to 1.

    (0, 0, 0), (0, 1, 0), (0, 2, 0), (1, 0, 1), (1, 1, 0), (1, 2, 0) is the 3-4-5.
    """
    try:
        formula = polynomial(*map(float, coefficients_from(conditions)))
    except OverflowError:
        raise SpecError(
            [
                Fault(
                    ("conditions",),
                    "too far apart in size",
                    "a polynomial with coefficients under 1e308",
                )
            ]
        ) from None
    ends = [float(formula(np.asarray(u), 0)) for u in (0.0, 1.0)]
    if not max(abs(ends[0]), abs(ends[1] - 1)) <= LAW_CLOSES:
        raise SpecError(
            [
                Fault(
                    ("conditions",),
                    f"runs from {ends[0]:.6g} to {ends[1]:.6g}",
                    "a law that runs from 0 to 1",
                )
            ]
        )
    return measured("polynomial", formula, f"polynomial from {len(conditions)} boundary conditions")


# ---- two halves and a line -------------------------------------------------------------------------------------------


def halves_law(name: str, halves: Halves, source: str, ends: Ends = DWELLS) -> Law:
    """The law of two halves and a line; its constants are closed forms."""
    peaks = halves.peaks
    order = smoothness(halves, ends, (1.0, *peaks))
    return Law(name, halves, order, *peaks, source, halves.breaks, ends)


def modified_sine(constant_velocity: float = 0.0) -> Law:
    """The modified sine with a share 0 <= x < 1 of the segment at constant velocity in its middle.

    SpecError for another share.   [VDI 2143: modifizierte Sinuslinie; kombiniert mit gerader Linie]
    """
    if not 0 <= constant_velocity < 1:
        raise SpecError(
            [Fault(("constant_velocity",), f"{constant_velocity:g}", "a share >= 0 and < 1")]
        )
    share = f"-{100 * constant_velocity:g}" if constant_velocity else ""
    line = ", Gerade in der Mitte" if constant_velocity else ""
    halves = Halves(MODIFIED_SINE, MODIFIED_SINE, line=constant_velocity)
    return halves_law(f"modified-sine{share}", halves, f"VDI 2143: modifizierte Sinuslinie{line}")


def slider_crank(share: float) -> Law:
    """Rise of a slider from its place nearest to the crank's side of the rod, crank over rod = share, 0 <= share < 1.

    s = (1 - cos x + (1 - q) / share) / 2 with x = pi u, q = sqrt(1 - share^2 sin^2 x); 0 is the simple harmonic. The source
    of the flat chain stitch calls the share a coefficient of distortion.
    """
    if not 0 <= share < 1:
        raise SpecError([Fault(("distortion",), f"{share:g}", "crank over rod: >= 0 and < 1")])

    def formula(u: Floats, order: int) -> Floats:
        x = math.pi * np.asarray(u, float)
        sine = np.sin(x)
        cosine = np.cos(x)
        q = np.sqrt(1 - share**2 * sine**2)
        both = sine * cosine
        if order == 0:
            tilt = share * sine**2 / (1 + q)
            plain = 2 * np.sin(x / 2) ** 2
        elif order == 1:
            tilt = share * both / q
            plain = sine
        elif order == 2:
            tilt = share * ((cosine**2 - sine**2) / q + share**2 * both**2 / q**3)
            plain = cosine
        else:
            turn = (
                3 * share**2 * both * (cosine**2 - sine**2) / q**3 + 3 * share**4 * both**3 / q**5
            )
            tilt = share * (turn - 4 * both / q)
            plain = -sine
        return np.asarray(math.pi**order * (plain + tilt) / 2)

    return measured(f"slider-crank-{share:g}", formula, "closed loop of crank and rod")


# ---- Fourier laws ----------------------------------------------------------------------------------------------------


def harmonics(sines: int, cosines: int) -> tuple[Floats, Floats]:
    """Angular rates of the acceleration's sines (2 pi, 4 pi, ...) and cosines (pi, 3 pi, ...)."""
    return 2 * math.pi * np.arange(1.0, sines + 1), math.pi * np.arange(1.0, 2 * cosines, 2)


def end_speed(sines: Sequence[float], cosines: Sequence[float]) -> float:
    """Speed with which a Fourier law leaves its ends; the law closes where it is 0."""
    w, z = harmonics(len(sines), len(cosines))
    return float(1 - 2 * np.sum(cosines / z**2) - np.sum(sines / w))


def fourier_formula(sines: Sequence[float], cosines: Sequence[float] = ()) -> Formula:
    """Formula of the law whose acceleration is the sum of A_n sin(2 pi n u) and B_m cos((2 m - 1) pi u).

    Both ways symmetric: s(1 - u) = 1 - s(u). It runs from 0 to 1 whatever the coefficients; see `end_speed`.
    """
    z = harmonics(len(sines), len(cosines))[1]
    rest = float(np.sum(cosines / z**2))
    # All terms are the imaginary part of c_k exp(i pi k u); each derivative multiplies them by i pi k.
    k = np.arange(max(2 * len(sines), 2 * len(cosines) - 1) + 1)
    terms = np.zeros(len(k), complex)
    terms[2 : 2 * len(sines) + 1 : 2] = sines
    terms[1 : 2 * len(cosines) : 2] = 1j * np.asarray(cosines, float)
    orders = [terms[1:] * (1j * math.pi * k[1:]) ** (order - 2) for order in range(4)]

    def formula(u: Floats, order: int) -> Floats:
        turn = np.exp(1j * math.pi * u)
        result = np.zeros(u.shape, complex)
        for c in orders[order][::-1]:
            result = (result + c) * turn
        straight = ((1 - 2 * rest) * u + rest, 1 - 2 * rest, 0.0, 0.0)[order]
        return np.asarray(result.imag + straight)

    return formula


def closed(sines: Sequence[float], cosines: Sequence[float]) -> tuple[float, ...]:
    """The sines, the first of them changed so that the law closes to rounding; c stays as it is at both ends.

    Printed coefficients of six decimals leave a speed of some 1e-8, which a cam would show as a corner at each dwell.
    """
    return (
        (sines[0] + 2 * math.pi * end_speed(sines, cosines), *sines[1:])
        if len(sines)
        else tuple(sines)
    )


def fourier(sines: Sequence[float], cosines: Sequence[float] = (), source: str = "") -> Law:
    """The Fourier law with these coefficients; SpecError where it does not start and end at rest."""
    leaves = end_speed(sines, cosines)
    if not abs(leaves) <= LAW_CLOSES:
        limit = "coefficients that close: sum A_n/(2 pi n) + 2 sum B_m/((2m - 1) pi)^2 = 1"
        raise SpecError([Fault(("sines",), f"speed {leaves:.6g} at both ends", limit)])
    formula = fourier_formula(closed(sines, cosines), cosines)
    return measured(
        "fourier", formula, source or f"Fourier series of {len(sines) + len(cosines)} terms"
    )


# ---- tables ----------------------------------------------------------------------------------------------------------


_FEWEST_ROWS = 16  # of a table whose digits are judged: a shorter one is typed by hand, and exact
_SAME_ANGLE = 1e-9  # of a table's range; rows nearer than this give speeds that are rounding


def last_digit(points: Sequence[tuple[float, float]]) -> float:
    """The unit of the last decimal with which the displacements are written."""
    return 10.0 ** min(
        int(Decimal(repr(float(row[1]))).normalize().as_tuple().exponent) for row in points
    )


def rounding_share(u: Floats, step: float, peak: float) -> float:
    """Acceleration that rounding to a step can make of rows at u, as a share of the peak: 4 step / h^2 of the narrowest h."""
    if len(u) < _FEWEST_ROWS or not peak:
        return 0.0
    return float(4 * step / np.min(np.diff(u)) ** 2 / peak)


def table_law(points: Sequence[tuple[float, float]], source: str, rest: bool = True) -> Law:
    """The law through (angle, displacement) points of any unit, made to run from 0 to 1: a C2 cubic spline.

    rest: it starts and ends with speed 0; otherwise its first and last two pieces are one cubic each. At least four points.
    SpecError, with all that is wrong, where the angles do not grow or the last displacement is the first.
    """
    from scipy.interpolate import CubicSpline

    table = np.array(points, float).reshape(-1, 2)
    if len(table) < 4:
        raise SpecError([Fault(("points",), counted(len(table), "row"), "at least 4 rows")])
    faults = []
    if table[-1, 1] == table[0, 1]:
        faults.append(
            Fault(
                ("points",),
                f"start and end at {table[0, 1]:g}",
                "a last displacement that differs from the first",
            )
        )
    for k in np.flatnonzero(~(np.diff(table[:, 0]) > _SAME_ANGLE * np.ptp(table[:, 0]))) + 1:
        faults.append(
            Fault(
                ("points", int(k)),
                f"{table[k, 0]:g}",
                f"an angle greater than the one before, {table[k - 1, 0]:g}",
            )
        )
    if not faults and not np.ptp(table[:, 1]) < 1e6 * abs(table[-1, 1] - table[0, 1]):
        faults.append(
            Fault(
                ("points",),
                f"vary by {np.ptp(table[:, 1]):g}",
                "a table that varies by under 1e6 times its lift",
            )
        )
    if faults:
        raise SpecError(faults)
    u, s = ((column - column[0]) / (column[-1] - column[0]) for column in table.T)
    spline = CubicSpline(u, s, bc_type="clamped" if rest else "not-a-knot")
    bend = spline(u, 2)
    with np.errstate(divide="ignore", invalid="ignore"):
        turns = u[:-1] + np.diff(u) * bend[:-1] / (
            bend[:-1] - bend[1:]
        )  # where the acceleration passes 0 the speed is extreme
    at = np.concatenate((u, turns[(turns > 0) & (turns < 1)]))
    v, a, j = (magnitude(spline(at, order)) for order in (1, 2, 3))

    def formula(u: Floats, order: int) -> Floats:
        return np.asarray(spline(u, order))

    knots = tuple(float(x) for x in u[1:-1])
    step = last_digit(points) / abs(float(table[-1, 1] - table[0, 1]))
    return Law(
        "table",
        formula,
        smoothness(formula, DWELLS, (1.0, v, a, j)),
        v,
        a,
        j,
        source,
        knots,
        smooth=True,
        rounding=rounding_share(u, step, a),
    )


# ---- the laws by name ------------------------------------------------------------------------------------------------

_PI = math.pi
_ROOT3 = math.sqrt(3)

UNIFORM = Law("uniform", polynomial(0, 1), 0, 1.0, 0.0, 0.0, "VDI 2143: gerade Linie")
_DOUBLE_COSINE = (
    (1 + math.sqrt(129)) / 16,
    (1 - math.sqrt(129)) / 16,
)  # cosines of pi u where its jerk is extreme


def _double_harmonic(u: Floats, order: int) -> Floats:
    phase = _PI * u + order * _PI / 2  # each derivative turns a cosine by a quarter
    if order == 0:
        return np.asarray(np.sin(_PI * u / 2) ** 2 - np.sin(_PI * u) ** 2 / 4)
    return np.asarray(_PI**order * (2**order * np.cos(phase + _PI * u) / 8 - np.cos(phase) / 2))


# The printed coefficients with the sign of A6 corrected; with the printed one the law leaves its ends with speed 1.6e-3.
MR_13_SINES = (3.587020, -0.871476, -0.566845, 0.316224, -0.025629)
MR_13_COSINES = (2.550126,)

LAWS = {
    law.name: law
    for law in (
        UNIFORM,
        halves_law("parabolic", Halves(PARABOLA, PARABOLA), "VDI 2143: quadratische Parabel"),
        Law("cubic", polynomial(0, 0, 3, -2), 1, 1.5, 6.0, 12.0, "polynomial 2-3"),
        Law(
            "simple-harmonic",
            fourier_formula((), (_PI**2 / 2,)),
            1,
            _PI / 2,
            _PI**2 / 2,
            _PI**3 / 2,
            "VDI 2143: einfache Sinuslinie",
        ),
        Law(
            "double-harmonic",
            _double_harmonic,
            1,
            3 * _ROOT3 * _PI / 8,
            _PI**2,
            max(_PI**3 / 2 * math.sqrt(1 - c * c) * abs(4 * c - 1) for c in _DOUBLE_COSINE),
            "two sines; its mirrored return continues its acceleration of -pi^2",
        ),
        Law(
            "cycloidal",
            fourier_formula((2 * _PI,)),
            2,
            2.0,
            2 * _PI,
            4 * _PI**2,
            "VDI 2143: geneigte Sinuslinie",
        ),
        halves_law(
            "modified-trapezoid",
            Halves(TRAPEZOID, TRAPEZOID),
            "VDI 2143: modifiziertes Beschleunigungstrapez",
        ),
        modified_sine(),
        Law(
            "3-4-5",
            polynomial(0, 0, 0, 10, -15, 6),
            2,
            15 / 8,
            10 / _ROOT3,
            60.0,
            "VDI 2143: Polynom 5. Grades",
        ),
        Law(
            "4-5-6-7",
            polynomial(0, 0, 0, 0, 35, -84, 70, -20),
            3,
            35 / 16,
            84 * math.sqrt(5) / 25,
            52.5,
            "polynomial 4-5-6-7",
        ),
        Law(
            "mr-13",
            fourier_formula(closed(MR_13_SINES, MR_13_COSINES), MR_13_COSINES),
            1,
            1.8917385846097312,
            6.150072767977438,
            40.26235849974344,
            "choice of cam mechanisms for pad-printing machines (in Ukrainian), law MR-13, A6 < 0",
        ),
    )
}

# Speed goes from +1 to -1 by the 3-4-5 law, so displacement is u - 2 * integral of 3-4-5: it starts and ends at 0.
# Acceleration and jerk vanish at both ends, so it joins uniform motion up to the third derivative.
TURN = Law(
    "turn",
    polynomial(0, 1, 0, 0, -5, 6, -2),
    3,
    1.0,
    15 / 4,
    20 / _ROOT3,
    "integral of 1 - 2 * (3-4-5)",
    ends=((0.0, 1.0), (0.0, -1.0)),
)
TURN_PEAK = 11 / 32  # displacement of TURN at u = 1/2
