"""Cubic splines in space, as STEP has them: knots with their multiplicity, and poles.

A curve runs over 0 to 1; a patch over 0 to 1 in both directions, its sides are its outer rows of poles.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from camgen.numerics import Floats

DEGREE = 3
_NODES = 5  # of Gauss in each span: exact for the products of cubics in a volume


@dataclass(frozen=True, eq=False)
class Spline:
    """A curve: knots (n + 4,), four alike at either end, and poles (n, 3) mm."""

    knots: Floats
    poles: Floats

    def __eq__(self, other: object) -> bool:
        return (
            isinstance(other, Spline)
            and np.array_equal(self.knots, other.knots)
            and np.array_equal(self.poles, other.poles)
        )

    def __call__(self, share: Floats) -> Floats:
        """Points, (k, 3) mm."""
        from scipy.interpolate import BSpline

        return np.asarray(BSpline(self.knots, self.poles, DEGREE)(share))


@dataclass(frozen=True, eq=False)
class Patch:
    """A surface: knots along u and v, poles (n, m, 3) mm; its normal is that of the u direction across the v direction."""

    along: Floats
    across: Floats
    poles: Floats

    def __eq__(self, other: object) -> bool:
        return (
            isinstance(other, Patch)
            and np.array_equal(self.along, other.along)
            and np.array_equal(self.across, other.across)
            and np.array_equal(self.poles, other.poles)
        )

    def __call__(self, u: Floats, v: Floats, order: tuple[int, int] = (0, 0)) -> Floats:
        """Points on the grid of u and v, (k, l, 3) mm, or their derivatives of an order in both directions."""
        from scipy.interpolate import BSpline

        rows = BSpline(self.along, self.poles, DEGREE)(u, nu=order[0])
        return np.asarray(BSpline(self.across, rows, DEGREE, axis=1)(v, nu=order[1]))

    @property
    def turned(self) -> Patch:
        """The same with v the other way, and so its normal."""
        return Patch(self.along, 1 - self.across[::-1], self.poles[:, ::-1])

    @property
    def sides(self) -> tuple[Spline, Spline, Spline, Spline]:
        """At v = 0, u = 1, v = 1 and u = 0, each as u or v grows."""
        return (
            Spline(self.along, self.poles[:, 0]),
            Spline(self.across, self.poles[-1]),
            Spline(self.along, self.poles[:, -1]),
            Spline(self.across, self.poles[0]),
        )

    def bulge(self, columns: int, rows: int) -> tuple[float, float]:
        """By how much it leaves the chords of so many even steps, along u and along v, mm."""
        u, v = (np.linspace(0, 1, 2 * count + 1) for count in (columns, rows))
        found = self(u, v)
        along = found[1::2] - (found[:-1:2] + found[2::2]) / 2
        across = found[:, 1::2] - (found[:, :-1:2] + found[:, 2::2]) / 2
        return _longest(along), _longest(across)

    @cached_property
    def flux(self) -> float:
        """Of z upwards through it, mm^3: its share in the volume of the body that it bounds."""
        u, weights = _gauss(self.along)
        v, others = _gauss(self.across)
        places = self(u, v)
        a = self(u, v, (1, 0))
        b = self(u, v, (0, 1))
        upward = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
        return float(np.sum(weights[:, None] * others * places[..., 2] * upward))


def _longest(vectors: Floats) -> float:
    return float(np.max(np.linalg.norm(vectors, axis=-1)))


def _gauss(knots: Floats) -> tuple[Floats, Floats]:
    """Places and weights in all spans."""
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    ends = np.unique(knots)
    half = np.diff(ends)[:, None] / 2
    return (ends[:-1, None] + half * (nodes + 1)).ravel(), (half * weights).ravel()


def through(share: Floats, points: Floats) -> Spline:
    """The curve through points (n, 3) at shares (n,) from 0 to 1, without a knot at the second and the last but one."""
    from scipy.interpolate import make_interp_spline

    found = make_interp_spline(share, points, DEGREE)
    return Spline(np.asarray(found.t), np.asarray(found.c))


def patch(u: Floats, v: Floats, points: Floats) -> Patch:
    """The surface through points (n, m, 3) at u (n,) and v (m,)."""
    rows = through(u, points)
    columns = through(v, np.moveaxis(rows.poles, 1, 0))
    return Patch(rows.knots, columns.knots, np.moveaxis(columns.poles, 0, 1))
