"""Dyads that carry a body through poses: a bar from a point k of the body to a centre m at rest, of one length at all poses.

    pose j against pose 0    x -> R_j x + d_j,    R_j = exp(i turn),    x, k and m counted from the place of pose 0
    |R_j k + d_j - m| = |k - m|
    |d_j|^2 / 2 + Re(conj(d_j) R_j k) - Re(conj(m) ((R_j - 1) k + d_j)) = 0        bilinear in k and m

3 poses: two equations, linear in k for a given m.  4 poses: curves of k and m.  5 poses: four dyads at most.
k and m stand in the ground's frame, k as it is at pose 0; lengths in mm.  [Burmester's theory]
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from camgen.numerics import Floats, Points, magnitude, solve

_REAL = 1e-6  # imaginary part of an eigenvalue, of the poses' size, that counts as rounding
_FARTHEST = 1e6  # of the poses' size: what is farther away is at infinity
_CLOSES = 1e-9  # residual of an equation, of the size squared, within which a dyad is one
_SAME = 1e-6  # of the poses' size: distance of two dyads that are the same one
_NEWTON = 4  # steps on the eigenproblem's solutions


@dataclass(frozen=True)
class Poses:
    """Places of a body, (n,) complex mm, and its angles there, (n,) rad."""

    places: Points
    angles: Floats

    @cached_property
    def turns(self) -> Points:
        """R_j of the poses after the first, (n - 1,)."""
        return np.asarray(np.exp(1j * (self.angles[1:] - self.angles[0])))

    @cached_property
    def shifts(self) -> Points:
        """d_j of the poses after the first, (n - 1,)."""
        return np.asarray(self.places[1:] - self.places[0])

    @cached_property
    def size(self) -> float:
        """Largest shift, mm; 1 of a body that turns on the spot."""
        return magnitude(self.shifts) or 1.0

    def carried(self, points: Points) -> Points:
        """Where points of the body, (m,) as at the first pose, are at all poses: (n, m)."""
        turns = np.exp(1j * (self.angles - self.angles[0]))[:, None]
        return np.asarray(self.places[:, None] + turns * (points - self.places[0]))

    def chosen(self, which: list[int]) -> Poses:
        """Some of the poses; the first of them is their pose 0."""
        return Poses(self.places[which], self.angles[which])


@dataclass(frozen=True)
class Dyads:
    """Bars from points of the body, at pose 0, to centres at rest: both (m,) complex mm."""

    points: Points
    centres: Points

    def __len__(self) -> int:
        """How many."""
        return len(self.points)

    @property
    def lengths(self) -> Floats:
        """Of the bars, (m,) mm."""
        return np.asarray(np.abs(self.points - self.centres))

    def those(self, which: np.ndarray) -> Dyads:
        """Some of them, by numbers or by flags."""
        return Dyads(self.points[which], self.centres[which])


def three_pose_dyads(poses: Poses, centres: Points) -> Dyads:
    """The dyad of three poses about each centre, (m,); nan where there is none."""
    m = (centres - poses.places[0])[:, None]
    slope = _point_slope(poses, m)
    right = (np.conj(m) * poses.shifts).real - np.abs(poses.shifts) ** 2 / 2
    matrices = np.stack([slope.real, -slope.imag], axis=-1)
    x, y = solve(matrices, right).T
    return Dyads(poses.places[0] + x + 1j * y, centres)


def four_pose_dyads(poses: Poses, count: int) -> Dyads:
    """Dyads of four poses, two at most for each of `count` even turns of the bar from the first pose to the second.

    With the bar W = k - m, turned by b_j, and Z from k to the place: W (exp(i b_j) - 1) + Z (R_j - 1) = d_j. The three
    equations in W and Z go together where D1 + D2 exp(i b_2) + D3 exp(i b_3) + D4 exp(i b_4) = 0, which closes as a two-bar.
    """
    e = poses.turns - 1
    s = poses.shifts
    d2 = e[1] * s[2] - e[2] * s[1]
    d3 = e[2] * s[0] - e[0] * s[2]
    d4 = e[0] * s[1] - e[1] * s[0]
    b2 = np.exp(2j * np.pi * np.arange(1, count) / count)
    way = d2 + d3 + d4 - d2 * b2
    with np.errstate(all="ignore"):
        far = np.abs(way)
        cosine = (far**2 + abs(d3) ** 2 - abs(d4) ** 2) / (2 * far * abs(d3))
        corner = np.arccos(np.where(np.abs(cosine) <= 1, cosine, np.nan))
        b3 = np.concatenate([np.exp(sign * 1j * corner) for sign in (1, -1)])
        way = np.tile(way, 2)
        b3 *= (way / d3) / np.abs(way / d3)
        b4 = (way - d3 * b3) / d4
        bars = np.stack([np.tile(b2, 2), b3, b4 / np.abs(b4)]) - 1
        # least squares of three equations in W and Z: they go together, so no matter how they are weighed
        ww = np.sum(np.abs(bars) ** 2, axis=0)
        wz = np.sum(np.conj(bars) * e[:, None], axis=0)
        zz = np.sum(np.abs(e) ** 2)
        ws = np.sum(np.conj(bars) * s[:, None], axis=0)
        zs = np.sum(np.conj(e) * s)
        determinant = ww * zz - np.abs(wz) ** 2
        bar = (zz * ws - wz * zs) / determinant
        arm = (ww * zs - np.conj(wz) * ws) / determinant
        points = poses.places[0] - arm
        return _sound(poses, Dyads(points, points - bar))


def five_pose_dyads(poses: Poses) -> Dyads:
    """All real dyads of five poses, four at most.

    The equations are M(x, y) v = 0, k = x + i y, v = (m_x, m_y, 1). Multiplied by 1, y and y^2 they are twelve in
    (v, y v, y^2 v, y^3 v), linear in x: a generalised eigenproblem. Newton steps follow on the four equations.
    """
    from scipy.linalg import eig

    unit = Poses((poses.places - poses.places[0]) / poses.size, poses.angles)
    d = unit.shifts
    zero, x, y = (_rows(unit, k) for k in (0j, 1 + 0j, 1j))
    x = x - zero
    y = y - zero
    a = np.zeros((12, 12))
    b = np.zeros((12, 12))
    for k in range(3):
        rows = slice(4 * k, 4 * k + 4)
        a[rows, 3 * k : 3 * k + 3] = zero
        a[rows, 3 * k + 3 : 3 * k + 6] = y
        b[rows, 3 * k : 3 * k + 3] = -x
    with np.errstate(all="ignore"):
        values, vectors = eig(a, b)
        v = vectors[:3]
        ordinate = np.sum(vectors[3:6] * np.conj(v), axis=0) / np.sum(np.abs(v) ** 2, axis=0)
        centre = v[:2] / v[2]
        numbers = np.stack([values, ordinate, *centre])
        real = np.max(np.abs(numbers.imag), axis=0) < _REAL * (1 + np.abs(numbers).max(axis=0))
    numbers = numbers.real[:, real & (np.abs(numbers).max(axis=0) < _FARTHEST)]
    k = numbers[0] + 1j * numbers[1]
    m = numbers[2] + 1j * numbers[3]
    for _ in range(_NEWTON if k.size else 0):
        slope = _point_slope(unit, m[:, None])
        path = (unit.turns - 1) * k[:, None] + d
        jacobian = np.stack([slope.real, -slope.imag, -path.real, -path.imag], axis=-1)
        dx, dy, du, dv = solve(jacobian, _residuals(unit, k, m)).T
        k = k - (dx + 1j * dy)
        m = m - (du + 1j * dv)
    found = _sound(unit, Dyads(k, m))
    order = np.lexsort([found.points.imag, found.points.real, np.round(found.lengths, 6)])
    apart: list[int] = []
    for j in order.tolist():
        if all(
            abs(found.points[j] - found.points[i]) + abs(found.centres[j] - found.centres[i])
            > _SAME * (1 + found.lengths[j])
            for i in apart
        ):
            apart.append(j)
    return Dyads(
        poses.places[0] + poses.size * found.points[apart],
        poses.places[0] + poses.size * found.centres[apart],
    )


def _point_slope(poses: Poses, m: Points) -> Points:
    """g, (m, n - 1), of the equations' slope Re(g dk) to a point of the body; m: centres (m, 1) from the place of pose 0."""
    return np.asarray(np.conj(poses.shifts) * poses.turns - np.conj(m) * (poses.turns - 1))


def _rows(poses: Poses, k: complex) -> Floats:
    """M(x, y), (n - 1, 3), for one point of the body."""
    path = (poses.turns - 1) * k + poses.shifts
    last = np.abs(poses.shifts) ** 2 / 2 + (np.conj(poses.shifts) * poses.turns * k).real
    return np.stack([-path.real, -path.imag, last], axis=-1)


def _residuals(poses: Poses, k: Points, m: Points) -> Floats:
    """What the equations lack, (m, n - 1) mm^2; k, m: (m,) from the place of pose 0."""
    end = poses.turns * k[:, None] + poses.shifts - m[:, None]
    return np.asarray((np.abs(end) ** 2 - np.abs(k - m)[:, None] ** 2) / 2)


def _sound(poses: Poses, dyads: Dyads) -> Dyads:
    """Those that close, and whose centre is not at infinity."""
    with np.errstate(all="ignore"):
        k = dyads.points - poses.places[0]
        m = dyads.centres - poses.places[0]
        reach = np.abs(k) + np.abs(m) + poses.size
        lack = np.max(np.abs(_residuals(poses, k, m)), axis=1) / reach**2
    return dyads.those((lack < _CLOSES) & (reach < _FARTHEST * poses.size))
