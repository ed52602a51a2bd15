"""What stands out on a turn: zeros, extremes, double points, cusps and near stops.

A function is called with (theta, order), theta (n,) rad, and returns its order-th derivative, (n,); a curve is the same
with complex values, mm. Both have period 2 pi.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from camgen.machine.jets import thread_length
from camgen.machine.model import Law
from camgen.numerics import Floats, Points, sign_changes

Curve = Callable[[Floats, int], Points]
TURN = 2 * math.pi
# Angles closer than this are one angle, rad.
SAME_ANGLE = 1e-12
_ALONG = 1e-9  # sine of the angle between pieces of a curve that run along each other


def zeros(f: Law, n: int = 720) -> Floats:
    """Angles of a turn at which f changes sign, (k,) rad in [0, 2 pi), sorted.

    f(theta, order): real values (order 0) and slopes (1), (n,), of period 2 pi; nan where not assembled. Two changes
    within one n-th of a turn go unseen.
    """
    # Off the round angles, where symmetry likes to put zeros.
    grid = np.linspace(0.0, TURN, n + 1) + 0.381966 * (TURN / n)
    theta = sign_changes(lambda t: f(t, 0), grid, lambda t: f(t, 1))
    return np.sort((theta + SAME_ANGLE) % TURN - SAME_ANGLE)


def extremes(f: Law, n: int = 720) -> tuple[Floats, Floats]:
    """Angles at which f turns back, (k,) rad, and its values there; f as in zeros, order 0..2.

    The extremes of an output's angle or way are the dead points at which it could not drive the crank.
    """
    theta = zeros(lambda angles, order: f(angles, order + 1), n)
    return theta, f(theta, 0)


def double_points(point: Curve, n: int = 3600) -> tuple[Floats, Points]:
    """Where a closed curve crosses itself: pairs of angles, (k, 2) rad, and the points, (k,) complex mm.

    Segments of n-ths of a turn that cross, then Newton's method on point(t1) = point(t2). A loop shorter than two
    segments goes unseen, and so does a curve that is run twice.
    """
    theta = np.linspace(0.0, TURN, n + 1)
    p = point(theta, 0)
    a = p[:-1]
    b = p[1:]
    low = np.minimum(a.real, b.real)
    high = np.maximum(a.real, b.real)
    by_x = np.argsort(low)
    overlaps = np.searchsorted(low[by_x], high[by_x], side="right") - np.arange(
        1, n + 1
    )  # later ones that start within
    overlaps = np.maximum(overlaps, 0)
    first = np.repeat(np.arange(n), overlaps)
    second = (
        first + 1 + np.arange(overlaps.sum()) - np.repeat(np.cumsum(overlaps) - overlaps, overlaps)
    )
    i = by_x[first]
    j = by_x[second]

    def side(of: NDArray[np.intp], end: Points) -> Floats:
        return (np.conj(b[of] - a[of]) * (end - a[of])).imag

    cross = (side(i, a[j]) * side(i, b[j]) < 0) & (side(j, a[i]) * side(j, b[i]) < 0)
    cross &= np.abs(side(i, a[i] + b[j] - a[j])) > _ALONG * np.abs(
        (b[i] - a[i]) * (b[j] - a[j])
    )  # not on one line
    apart = np.abs(i - j)
    i, j = np.sort(np.stack([i, j])[:, cross & (apart > 1) & (apart < n - 1)], axis=0)
    t1 = theta[i] + math.pi / n
    t2 = theta[j] + math.pi / n
    for _ in range(30 if i.size else 0):
        miss = point(t1, 0) - point(t2, 0)
        d1 = point(t1, 1)
        d2 = point(t2, 1)
        area = (np.conj(d1) * d2).imag
        step1 = (np.conj(d2) * miss).imag / area
        step2 = (np.conj(d1) * miss).imag / area
        t1 = t1 + step1
        t2 = t2 + step2
        if max(np.abs(step1).max(), np.abs(step2).max()) < SAME_ANGLE:
            break
    pairs = np.stack([t1, t2], axis=1)
    return pairs, point(t1, 0)


def smallest_loop(point: Curve, n: int = 3600) -> tuple[float, float, complex, int] | None:
    """Of a closed curve's loops the one that takes the least angle: where it begins and ends, rad, its double point, complex mm,
    and how many there are; None where the curve does not cross itself. n as in `double_points`."""
    pairs, points = double_points(point, n)
    if not len(pairs):
        return None
    spans = (pairs[:, 1] - pairs[:, 0]) % TURN
    inner = np.minimum(spans, TURN - spans)
    k = int(np.argmin(inner))
    begins = float(pairs[k, 0] if spans[k] <= math.pi else pairs[k, 1])
    return begins, begins + float(inner[k]), complex(points[k]), len(pairs)


def moving_centrode(a: Points, b: Points) -> Points:
    """The place on the link a-b that stands still, as its share of the way from a to b, (order, n) with derivatives.

    a, b: jets of two points, (order + 1, n) complex mm.

    A point of the link has a cusp exactly where this curve passes through it. nan where the link only shifts.
    """
    with np.errstate(all="ignore"):
        turn = b - a
        rows = np.empty((len(a) - 1, a.shape[1]), complex)
        rows[0] = -a[1] / turn[1]
        if len(rows) > 1:
            rows[1] = -(a[2] + rows[0] * turn[2]) / turn[1]
    return rows


def near_stops(point: Curve, centre: complex, radius: float) -> Floats:
    """Spans of theta, (k, 2) rad, over which a point stays within the circle; each ends after it begins.

    Empty where it is always inside or always outside.
    """

    def outside(theta: Floats, order: int) -> Floats:
        away = thread_length(
            np.stack([point(theta, 0), point(theta, 1)]), np.array([[centre], [0]])
        )
        values: Floats = away[1] if order else away[0] - radius
        return values

    edges = zeros(outside)
    enters = edges[outside(edges, 1) < 0]
    leaves = edges[outside(edges, 1) > 0]
    return np.array(
        [(t, np.min(np.where(leaves > t, leaves, leaves + TURN))) for t in enters]
    ).reshape(-1, 2)
