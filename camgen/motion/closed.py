"""Tables over the whole turn: rows of angle, deg, and displacement that end where they begin, as a motion that closes smoothly.

    spline      the periodic quintic through all rows, continuous up to the fourth derivative
    harmonics   the least number of harmonics that stays within a tolerance of all rows: it leaves the rounding of the rows out

Rounding is what spoils a table: a step of d in the rows, at a spacing of h, makes up to about 4 d / h^2 of acceleration.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from camgen.errors import Fault, SpecError, counted
from camgen.motion.laws import Formula, Law, last_digit, rounding_share
from camgen.motion.program import Program, Segment
from camgen.numerics import Floats, least_squares, peak

KIND = "table"  # of the segment that is the whole turn
_LEAST_ROWS = 8
_WIDEST = 30.0  # deg, between two rows
_SLACK = 1e-6  # deg, of a turn
_ROUNDED = 1e-12  # of a table's stroke: what arithmetic leaves between its ends
_PLACES = 16  # between two rows, at which the peaks are looked for
_EVEN = 1e-9  # of a turn, by which even rows may be off

Points = Sequence[tuple[float, float]]


@dataclass(frozen=True)
class Harmonics:
    """Formula of the sum of c_k exp(2 pi i k u), its real part, k from 0."""

    terms: tuple[complex, ...]

    def __call__(self, u: Floats, order: int) -> Floats:
        """Values of the derivative, by Horner's scheme."""
        k = np.arange(len(self.terms))
        rates = np.asarray(self.terms) * (2j * math.pi * k) ** order
        turn = np.exp(2j * math.pi * np.asarray(u, float))
        result = np.zeros(np.shape(u), complex)
        for rate in rates[::-1].tolist():
            result = result * turn + rate
        return np.asarray(result.real)


def closed_program(
    points: Points, source: str, unit: float = 1.0, tolerance: float | None = None
) -> Program:
    """The program of one segment over the turn, from the first row's angle; SpecError with all that is wrong.

    unit: what one of the rows' displacement is in s; tolerance: of a fit by harmonics, in the rows' unit, None for the spline.
    """
    table = _whole(points, tolerance or 0.0)
    start = float(table[0, 1])
    scale = float(np.ptp(table[:, 1]))
    u = (table[:, 0] - table[0, 0]) / 360
    s = (table[:, 1] - start) / scale
    step = 0.0
    name = "table"
    if tolerance is None:
        formula = _spline(u, s)
        step = last_digit(points) / scale
    else:
        formula, off = _fit(u[:-1], s[:-1], tolerance / scale)
        name = f"table by {len(formula.terms) - 1} harmonics, off by at most {scale * off:.3g}"
    begin = math.radians(float(table[0, 0]))
    law = _law(name, formula, source, u, step)
    return Program((Segment(KIND, math.tau, unit * start, unit * scale, law),), begin)


def _whole(points: Points, tolerance: float) -> Floats:
    """The rows with the last one at 360 deg after the first; SpecError with all that is wrong.

    The ends may differ by the tolerance, the rows' last digit or what arithmetic leaves.
    """
    table = np.array(points, float).reshape(-1, 2)
    if len(table) < _LEAST_ROWS:
        raise SpecError(
            [Fault(("points",), counted(len(table), "row"), f"at least {_LEAST_ROWS} rows")]
        )
    faults = [
        Fault(("points", int(k)), f"{table[k, 0]:g}", f"an angle greater than {table[k - 1, 0]:g}")
        for k in np.flatnonzero(~(np.diff(table[:, 0]) > 0)) + 1
    ]
    turn = float(table[-1, 0] - table[0, 0])
    last = ("points", len(table) - 1)
    if turn > 360 + _SLACK:
        right = f"at most {table[0, 0] + 360:g} deg: one turn"
        faults.append(Fault(last, f"{table[-1, 0]:g}", right))
    elif turn < 360 - _SLACK:
        table = np.vstack([table, (table[0, 0] + 360, table[0, 1])])
    elif abs(table[-1, 1] - table[0, 1]) > max(
        tolerance, last_digit(points), _ROUNDED * float(np.ptp(table[:, 1]))
    ):
        right = f"{table[0, 1]:g}, where the table begins: over 360 deg it closes"
        faults.append(Fault(last, f"{table[-1, 1]:g}", right))
    gaps = np.diff(table[:, 0])
    widest = int(np.argmax(gaps))
    if not faults and gaps[widest] > _WIDEST:
        right = f"rows at most {_WIDEST:g} deg apart"
        faults.append(Fault(("points", widest), f"{gaps[widest]:g} deg to the next row", right))
    if not faults and not np.ptp(table[:, 1]):
        faults.append(Fault(("points",), f"all {table[0, 1]:g}", "a table that moves"))
    if faults:
        raise SpecError(faults)
    table[-1] = (table[0, 0] + 360, table[0, 1])
    return table


def _spline(u: Floats, s: Floats) -> Formula:
    """The periodic quintic through the rows."""
    from scipy.interpolate import make_interp_spline

    spline = make_interp_spline(u, s, k=5, bc_type="periodic")

    def formula(u: Floats, order: int) -> Floats:
        return np.asarray(spline(np.asarray(u, float), order))

    return formula


def _fit(u: Floats, s: Floats, tolerance: float) -> tuple[Harmonics, float]:
    """The least number of harmonics within the tolerance, and how far it is off; SpecError where none is."""
    most = (len(u) - 1) // 2
    low = 0
    high = most
    best = _harmonics(u, s, most)
    if best[1] > tolerance:
        right = f"a tolerance of at least {best[1] / tolerance:.3g} times that: {most} harmonics, all that the rows tell apart"
        raise SpecError([Fault(("tolerance",), "", right)])
    while high - low > 1:
        middle = (low + high) // 2
        found = _harmonics(u, s, middle)
        if found[1] <= tolerance:
            high = middle
            best = found
        else:
            low = middle
    return best


def _harmonics(u: Floats, s: Floats, count: int) -> tuple[Harmonics, float]:
    """The harmonics up to this count nearest to the rows, and the greatest distance from one."""
    n = len(u)
    if peak(u - np.arange(n) / n) <= _EVEN:
        terms = np.fft.rfft(s)[: count + 1] / n
        terms[1:] *= 2
    else:
        angles = 2 * math.pi * np.outer(u, np.arange(1, count + 1))
        factors = least_squares(np.hstack([np.ones((n, 1)), np.cos(angles), np.sin(angles)]), s)
        terms = np.concatenate([factors[:1], factors[1 : count + 1] - 1j * factors[count + 1 :]])
    made = Harmonics(tuple(terms.tolist()))
    return made, peak(made(u, 0) - s)


def _law(name: str, formula: Formula, source: str, u: Floats, step: float) -> Law:
    """Its record; step: of the displacement's last digit."""
    places = np.concatenate(
        [np.linspace(a, b, _PLACES, endpoint=False) for a, b in zip(u, u[1:], strict=False)]
    )
    v, a, j = (peak(formula(places, order)) for order in (1, 2, 3))
    ends = tuple(float(formula(np.asarray(0.0), order)) for order in range(4))
    rounding = rounding_share(u, step, a)
    return Law(name, formula, 3, v, a, j, source, ends=(ends, ends), rounding=rounding)
