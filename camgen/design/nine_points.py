"""All four-bars whose coupler point passes nine points: a homotopy from other nine points, whose four-bars are known.

    d_j     points from the first one, j = 1..8            a, b    pivots, from the first point
    x, y    from the coupler point to both joints, there   g_j     exp(i turn of the coupler) - 1
    (conj(a) - conj(d)) x g + (a - d) conj(x) conj(g) + (conj(a) - conj(x)) d + (a - x) conj(d) - d conj(d) = 0,  with b, y too
    g conj(g) + g + conj(g) = 0

The first two are linear in g and conj(g). Cramer's rule gives g = n1 / D and conj(g) = n2 / D, and the last one becomes
n1 n2 + D (n1 + n2) = 0: eight equations in x, a, y, b and their conjugates, which are taken as numbers of their own. Labels
and Roberts' cognates aside they have 1,442 solutions. Those for one set of complex d and conj(d) are at hand; they are
followed while d and conj(d) go straight to the wanted ones, in steps of Runge and Kutta, each corrected by two of Newton.
Where some are lost all are followed by a second way, bent aside through complex multiples of the straight one.
[Wampler, Morgan, Sommese, J. Mech. Design 114 (1992) 153]
"""

from __future__ import annotations

import io
from dataclasses import dataclass
from importlib.resources import files

import numpy as np

from camgen.design.fourbars import Flags, FourBars
from camgen.numerics import Floats, Points

COUNT = 9  # points
STARTS = (
    "nine_points.npy"  # d, conj(d), then the solutions; tests/bench/nine_point_starts.py makes it
)
_UNKNOWNS = 8  # x, a, y, b, each followed by its conjugate
_FIRST_STEP = 0.02  # of the way
_LEAST_STEP = 1e-9
_ERROR = 1e-3  # of a solution's size, that a step is to be off before it is corrected
_FINER = 1e-5  # likewise, for those that get lost or come to one end
_CORRECTED = 0.05  # of that, at most what the second correction is
_ROUNDING = 1e-9
_ASIDE = 1j  # of the way's length, by which the second way is bent: others get lost on it
_NOTHING = 1e-9  # of a solution's size: an unknown that is less is 0
_ROUNDS = 2000
_FARTHEST = 1e5  # sizes of the points: what goes beyond goes to infinity
_ONE_END = 1e-8  # of its size: classes that are nearer are one; nearly symmetrical points have some that are 1e-6 apart
_REAL = 1e-6  # of its size: by how much a solution differs from its conjugate at most
_NEWTON = 3
_SHAM = 1e-6  # of their size: two dyads that are nearer are one
_LENGTH = 1e-6  # of the points' size, by which a link changes at most


def nine_point_four_bars(points: Points) -> FourBars:
    """All four-bars for nine points, (9,) complex, each cognate by either of its cranks, as far as solutions are not lost.

    Defects are not looked at. Where a point comes twice there are none: their equations have no single solutions.
    """
    d = points[1:] - points[0]
    size = float(np.sqrt(np.mean(np.abs(d) ** 2)))
    d = d / size
    end = np.stack([d, np.conj(d)])
    begin, known = starts()
    z, arrived = followed(known, begin, end)
    ends = newton(z[arrived], end)
    shared = doubles(ends) | doubles(ends[::-1])[::-1]  # either of two may have jumped
    again = ~arrived
    again[np.flatnonzero(arrived)[shared | _shams(ends)]] = True
    z[again], arrived[again] = followed(known[again], begin, end, _FINER)
    z = _distinct(z[arrived], end)
    if len(z) < len(known):
        aside, arrived = followed(known, begin, end, aside=_ASIDE)
        z = _distinct(np.concatenate([z, aside[arrived]]), end)
    back = np.max(np.abs(z[:, 1::2] - np.conj(z[:, ::2])), axis=1)
    return _four_bars(points, size, size * z[back < _REAL * _sizes(z), ::2])


def starts() -> tuple[Points, Points]:
    """d and conj(d), (2, 8), and the 1,442 solutions for these, (1442, 8)."""
    table = np.load(io.BytesIO(files("camgen.design").joinpath(STARTS).read_bytes()))
    table = table.astype(complex)
    return table[:2], newton(table[2:], table[:2])


def newton(z: Points, at: Points) -> Points:
    """Solutions, (m, 8), made better; at: d and conj(d), (2, 8)."""
    for _ in range(_NEWTON):
        z = z - _solved(*equations(z, at))
    return z


def _distinct(z: Points, at: Points) -> Points:
    """Solutions made better, one of each class, without shams."""
    z = newton(z, at)
    z = z[~_shams(z)]
    return z[~doubles(z)]


def _shams(z: Points) -> Flags:
    """Which are no four-bars, (m,): an unknown is 0, so the coupler point is a joint; or they are not finite."""
    return np.asarray(~(np.min(np.abs(z), axis=1) > _NOTHING * _sizes(z)))


def classes(z: Points) -> Points:
    """The sum of the three cognates' pivots of each solution, (m, 2) with its conjugate: of labels and cognates it knows nothing."""
    x, a, y, b = (z[:, k : k + 2] for k in range(0, _UNKNOWNS, 2))
    return np.asarray(a + b + (b * x - a * y) / (x - y))


def doubles(z: Points) -> Flags:
    """Which solutions are of the class of an earlier one, (m,)."""
    kinds = classes(z)
    order = np.argsort(kinds[:, 0].real, kind="stable")
    again = np.zeros(len(z), bool)
    for k in range(1, len(z)):  # of all that are as far along the real axis
        one = kinds[order[k]]
        reach = _ONE_END * (1 + np.max(np.abs(one)))
        j = k - 1
        while j >= 0 and one[0].real - kinds[order[j], 0].real <= reach:
            if np.max(np.abs(kinds[order[j]] - one)) <= reach:
                again[max(order[j], order[k])] = True
            j -= 1
    return again


@dataclass(frozen=True)
class _Way:
    """d and conj(d), (2, 8), from one set to another one: straight, or bent aside."""

    begin: Points
    straight: Points
    aside: Points

    def place(self, at: Floats) -> Points:
        """Where they are, (2, m, 8), at shares of the way, (m,)."""
        t = at[:, None]
        return np.asarray(
            self.begin[:, None] + t * self.straight[:, None] + t * (1 - t) * self.aside[:, None]
        )

    def slope(self, at: Floats) -> Points:
        """How they change there, (2, m, 8)."""
        t = at[:, None]
        return np.asarray(self.straight[:, None] + (1 - 2 * t) * self.aside[:, None])


def followed(
    known: Points,
    begin: Points,
    end: Points,
    error: float = _ERROR,
    aside: complex = 0.0,
) -> tuple[Points, Flags]:
    """Solutions, (m, 8), while d and conj(d), (2, 8), go from one set to the other, and which of them came there, (m,).

    error: of a solution's size, that a step is to be off before it is corrected; aside: by which the way is bent, of its length.
    """
    z = known.copy()
    way = _Way(begin, end - begin, aside * (end - begin))
    at = np.zeros(len(z))
    step = np.full(len(z), _FIRST_STEP)
    lost = np.zeros(len(z), bool)
    for _ in range(_ROUNDS):
        going = np.flatnonzero(~lost & (at < 1))
        if not going.size:
            break
        then = np.minimum(at[going] + step[going], 1.0)
        with np.errstate(all="ignore"):
            guess = _predicted(z[going], way, at[going], then)
            better, first, second = _corrected(guess, way.place(then))
            good = (first < 3 * error) & (second < _CORRECTED * first + _ROUNDING)
            growth = 0.9 * (error / np.maximum(first, _ROUNDING)) ** 0.2
        growth = np.clip(np.nan_to_num(growth, nan=0.2), 0.2, np.where(good, 2.0, 0.5))
        step[going] = (then - at[going]) * growth
        z[going[good]] = better[good]
        at[going[good]] = then[good]
        lost[going] = np.where(good, _sizes(better) > _FARTHEST, step[going] < _LEAST_STEP)
    return z, ~lost & (at == 1)


def _predicted(z: Points, way: _Way, at: Floats, then: Floats) -> Points:
    """Where solutions are at the end of a step, (m, 8): Runge and Kutta's formula of the fourth order."""
    step = (then - at)[:, None]
    middle = (at + then) / 2
    one = _slope(z, way, at)
    two = _slope(z + step / 2 * one, way, middle)
    three = _slope(z + step / 2 * two, way, middle)
    four = _slope(z + step * three, way, then)
    return np.asarray(z + step / 6 * (one + 2 * two + 2 * three + four))


def _corrected(z: Points, at: Points) -> tuple[Points, Floats, Floats]:
    """After two of Newton's steps, and how long both were, shares of the solution's size."""
    first = _solved(*equations(z, at))
    second = _solved(*equations(z - first, at))
    better = z - first - second
    size = _sizes(better)
    return better, _sizes(first) / size, _sizes(second) / size


def _slope(z: Points, way: _Way, at: Floats) -> Points:
    parts = _Parts(z, way.place(at))
    return -_solved(parts.along(way.slope(at)), parts.slope())


def equations(z: Points, at: Points) -> tuple[Points, Points]:
    """What n1 n2 + D (n1 + n2) is, (m, 8), and its slope, (m, 8, 8); z: (m, 8), at: d and conj(d), (2, 8) or (2, m, 8)."""
    parts = _Parts(z, at)
    return parts.value, parts.slope()


class _Parts:
    """A g + B conj(g) + C = 0 of both dyads, (m, 8) each, and the equations that they make."""

    def __init__(self, z: Points, at: Points) -> None:
        self.at = at
        self.dyads = (z[:, None, :4], z[:, None, 4:])
        (a1, b1, c1), (a2, b2, c2) = (self._coefficients(dyad) for dyad in self.dyads)
        n1 = b1 * c2 - b2 * c1
        n2 = c1 * a2 - c2 * a1
        both = n1 + n2
        determinant = a1 * b2 - a2 * b1
        self.value = n1 * n2 + determinant * both
        self.g = (n1, determinant)
        p = n1 + determinant
        q = n2 + determinant
        self.by = (
            (b2 * both - c2 * p, c2 * q - a2 * both, a2 * p - b2 * q),
            (c1 * p - b1 * both, a1 * both - c1 * q, b1 * q - a1 * p),
        )  # slopes of the value by A, B, C of each dyad

    def _coefficients(self, dyad: Points) -> tuple[Points, ...]:
        d, e = self.at
        x, u, a, v = np.moveaxis(dyad, -1, 0)
        return (v - e) * x, (a - d) * u, (v - u) * d + (a - x) * e - d * e

    def slope(self) -> Points:
        """By the unknowns, (m, 8, 8)."""
        d, e = self.at
        columns = []
        for dyad, (by_a, by_b, by_c) in zip(self.dyads, self.by, strict=True):
            x, u, a, v = np.moveaxis(dyad, -1, 0)
            columns += [by_a * (v - e) - by_c * e, by_b * (a - d) - by_c * d]
            columns += [by_b * u + by_c * e, by_a * x + by_c * d]
        return np.stack(columns, axis=-1)

    def along(self, way: Points) -> Points:
        """By d and conj(d) along their way, (2, m, 8): (m, 8)."""
        d, e = self.at
        total = np.zeros(self.value.shape, complex)
        for dyad, (by_a, by_b, by_c) in zip(self.dyads, self.by, strict=True):
            x, u, a, v = np.moveaxis(dyad, -1, 0)
            total += way[0] * (by_c * (v - u - e) - by_b * u)
            total += way[1] * (by_c * (a - x - d) - by_a * x)
        return total


def _solved(value: Points, slope: Points) -> Points:
    """Newton's step, (m, 8); nan of a solution whose slope is singular to the last bit: another step is tried."""
    try:
        return np.asarray(np.linalg.solve(slope, value[:, :, None])[:, :, 0])
    except np.linalg.LinAlgError:
        if len(value) == 1:
            return np.full(value.shape, np.nan, complex)
        half = len(value) // 2
        parts = (slice(half), slice(half, None))
        return np.concatenate([_solved(value[part], slope[part]) for part in parts])


def _sizes(z: Points) -> Floats:
    return np.asarray(np.max(np.abs(z), axis=1))


def _four_bars(points: Points, size: float, z: Points) -> FourBars:
    """Of real solutions x, a, y, b, (m, 4) mm: with their cognates, by either crank; size: of the points, mm."""
    x, a, y, b = z.T
    sound = np.maximum(np.abs(x - y), np.abs(a - b)) > _SHAM * _sizes(z)
    turns = _turns(points[1:] - points[0], z)
    p = np.repeat(points[:, None], len(z), axis=1)
    bars = FourBars(points[0] + a, points[0] + b, p + turns * x, p + turns * y, p)
    links = np.stack([bars.a - bars.o, bars.b - bars.c])
    kept = np.max(np.ptp(np.abs(links), axis=1), axis=0) < _LENGTH * size
    return bars.those(sound & kept).with_cognates()


def _turns(d: Points, z: Points) -> Points:
    """exp(i turn of the coupler) at all points, (9, m), the first one's 1."""
    full = np.stack([z, np.conj(z)], axis=-1).reshape(len(z), _UNKNOWNS)
    numerator, determinant = _Parts(full, np.stack([d, np.conj(d)])).g
    turns = 1 + (numerator / determinant).T
    return np.concatenate([np.ones((1, len(z))), turns / np.abs(turns)])
