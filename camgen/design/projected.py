"""Four-bars whose coupler point passes wanted points: exact for five with crank angles, else least squares.

    frame from 0 to 1, crank a at phi_j, coupler b, rocker c; e_j = direction of the coupler
    P_j = o + s a exp(i phi_j) + z e_j        linear in o, s and z: place, turn and size of the whole, and the point on the coupler

For given lengths and angles the best o, s and z are those of a linear least squares; what is left is searched: log a, log b,
log c and the first angle, and without crank angles the steps between them.   [variable projection, Golub and Pereyra 1973]
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from camgen.design.descent import least_squares
from camgen.design.dyads import Poses, five_pose_dyads
from camgen.design.fourbars import Flags, FourBars, Room, closed, joined
from camgen.numerics import Floats, Indices, Points

_DRAWN = 20_000  # four-bars at random
_KEPT = 48  # of them are polished; four times as many of four unknowns
_APART = 20  # of drawn ones in the order of their error: every such one is polished, too
_ROUNDS = 120
_LENGTHS = (-2.3, 1.1)  # logarithms of a link's length in frames: 1/10 to 3
_STIFF = 10.0  # times as much as what is out of bounds counts a flat transmission angle
_SAME = 1e-6  # of a dyad's length: the crank itself among the dyads of its coupler
_LEAST_STEP = 0.02  # rad, between two positions of a crank
_WHOLE = 0.97  # of a turn, that positions without angles take at most


@dataclass(frozen=True)
class Passing:
    """Points to be passed, (n,) complex mm, in their order, and the crank's angles there, (n,) rad, where they are given."""

    points: Points
    angles: Floats | None

    @property
    def unknowns(self) -> int:
        """Of one four-bar."""
        return 4 if self.angles is not None else 3 + len(self.points)

    def crank(self, x: Floats, sense: Floats) -> Floats:
        """Crank angles from the frame, (n, m) rad, of unknowns (m, unknowns); sense: 1 or -1, where no angles are given."""
        first = x[:, 3]
        if self.angles is not None:
            return np.asarray(first + (self.angles - self.angles[0])[:, None])
        steps = np.exp(np.clip(x[:, 4:], -20, 3)).T
        after = np.concatenate([np.zeros((1, len(x))), np.cumsum(steps, axis=0)])
        return np.asarray(first + sense * after)


def exact_five(passing: Passing) -> FourBars:
    """All real four-bars that pass five points at five crank angles, twelve at most.

    |P_j - O - W exp(i phi_j)| is one length: seen from the crank five poses, whose dyads give O and W. Then the coupler's
    poses are known, and their other dyads are rockers.
    """
    assert passing.angles is not None
    z = passing.points
    every = _none(len(z))
    for k, o in _each(Poses(z, passing.angles)):
        a = o + (z[0] - k) * np.exp(1j * (passing.angles - passing.angles[0]))
        coupler = Poses(z, np.angle(z - a))
        rockers = five_pose_dyads(coupler)
        b = coupler.carried(rockers.points)
        other = np.abs(b[0] - a[0]) > _SAME * (1 + rockers.lengths)
        count = len(rockers)
        ends = (np.full(count, o), rockers.centres)
        spread = np.ones(count)
        bars = FourBars(*ends, a[:, None] * spread, b, z[:, None] * spread)
        every = joined(every, bars.those(other))
    return every


def near(
    passing: Passing, room: Room, allowance: float, rng: np.random.Generator, effort: int = 1
) -> FourBars:
    """Four-bars that pass the points as near as can be within bounds; allowance: mm, of an error."""
    count = _DRAWN * effort
    x = np.empty((count, passing.unknowns))
    x[:, :3] = rng.uniform(*_LENGTHS, (count, 3))
    x[:, 3] = rng.uniform(0, math.tau, count)
    if passing.angles is None:
        x[:, 4:] = _steps(passing.points, rng, count)
    kept = _KEPT * effort * (4 if passing.angles is not None else 1)
    return polished(passing, room, allowance, _Drawn.at_random(x, rng), kept)


@dataclass(frozen=True)
class _Drawn:
    """Unknowns (m, unknowns), and the branch and the sense of each, 1 or -1."""

    x: Floats
    sides: Floats
    sense: Floats

    @classmethod
    def at_random(cls, x: Floats, rng: np.random.Generator) -> _Drawn:
        """Either branch and sense."""
        sides, sense = rng.choice([-1.0, 1.0], (2, len(x)))
        return cls(x, sides, sense)

    def those(self, which: Indices) -> _Drawn:
        """Some of them."""
        return _Drawn(self.x[which], self.sides[which], self.sense[which])


def polished(passing: Passing, room: Room, allowance: float, drawn: _Drawn, most: int) -> FourBars:
    """The best of some four-bars, made better."""
    turning = _turning(drawn.x, room)

    def residuals(x: Floats, which: Indices) -> Floats:
        those = _Drawn(x, drawn.sides[which], drawn.sense[which])
        bars, off = fitted(passing, those)
        out, flat = room.lack(bars, turning[which], allowance)
        off = off / allowance
        rows = [off.real, off.imag, out, _STIFF * flat, _STIFF * _crowded(passing, those)]
        return np.concatenate(rows).T

    glance = np.sum(residuals(drawn.x, np.arange(len(drawn.x))) ** 2, axis=1)
    order = np.argsort(np.where(np.isfinite(glance), glance, np.inf), kind="stable")
    half = most // 2
    best = np.concatenate([order[:half], order[half::_APART][:half]])
    kept = drawn.those(best)
    x, _ = least_squares(lambda x, which: residuals(x, best[which]), kept.x, _ROUNDS)
    bars, off = fitted(passing, _Drawn(x, kept.sides, kept.sense))
    return bars.those(np.flatnonzero(np.isfinite(off).all(axis=0)))


def fitted(passing: Passing, drawn: _Drawn) -> tuple[FourBars, Points]:
    """The best place, turn, size and point of each, and what is left, (n, m) complex mm."""
    a, b, c = np.exp(np.clip(drawn.x[:, :3], -8, 8)).T
    at = a * np.exp(1j * passing.crank(drawn.x, drawn.sense))
    end = closed(at, np.ones(len(a), complex), b, c, drawn.sides)
    way = end - at
    coupler = way / np.maximum(np.abs(way), 1e-300)
    # two columns beside the constant one, made orthogonal by hand
    middle_at = at.mean(axis=0)
    middle_coupler = coupler.mean(axis=0)
    u = at - middle_at
    v = coupler - middle_coupler
    p = passing.points[:, None] - passing.points.mean()
    u2 = np.maximum(np.sum(np.abs(u) ** 2, axis=0), 1e-300)
    v_on_u = np.sum(np.conj(u) * v, axis=0) / u2
    w = v - u * v_on_u
    z = np.sum(np.conj(w) * p, axis=0) / np.maximum(np.sum(np.abs(w) ** 2, axis=0), 1e-300)
    s = np.sum(np.conj(u) * p, axis=0) / u2 - z * v_on_u
    o = passing.points.mean() - s * middle_at - z * middle_coupler
    off = u * s + v * z - p
    bars = FourBars(o, o + s, o + s * at, o + s * end, passing.points[:, None] + off)
    return bars, off


def _turning(x: Floats, room: Room) -> Flags:
    """Those whose crank is to turn all round: it turns as drawn, and the room lets it."""
    lengths = np.concatenate([np.exp(x[:, :3]), np.ones((len(x), 1))], axis=1)
    order = np.sort(lengths, axis=1)
    grashof = order[:, 0] + order[:, 3] < order[:, 1] + order[:, 2]
    turns = np.asarray(grashof & np.isin(np.argmin(lengths, axis=1), (0, 3)))
    return turns if room.turns is None else np.full(len(x), room.turns)


def _crowded(passing: Passing, drawn: _Drawn) -> Floats:
    """How much positions without angles are too near to each other, or go too far, (rows, m) rad."""
    if passing.angles is not None:
        return np.zeros((0, len(drawn.x)))
    steps = np.exp(np.clip(drawn.x[:, 4:], -20, 3)).T
    whole = np.sum(steps, axis=0, keepdims=True) - _WHOLE * math.tau
    return np.asarray(np.maximum(np.concatenate([_LEAST_STEP - steps, whole]), 0.0))


def _steps(points: Points, rng: np.random.Generator, count: int) -> Floats:
    """Logarithms of steps of the crank from point to point, (count, n - 1): between even ones and those of the ways."""
    ways = np.maximum(np.abs(np.diff(points)), 1e-3 * np.max(np.abs(np.diff(points))))
    share = rng.uniform(0, 1, (count, 1))
    steps = (ways / ways.sum()) ** share
    steps /= steps.sum(axis=1, keepdims=True)
    total = rng.uniform(0.2, _WHOLE, (count, 1)) * math.tau
    return np.asarray(np.log(steps * total) + rng.normal(0, 0.1, steps.shape))


def _each(poses: Poses) -> list[tuple[complex, complex]]:
    dyads = five_pose_dyads(poses)
    return list(zip(dyads.points.tolist(), dyads.centres.tolist(), strict=True))


def _none(positions: int) -> FourBars:
    ends = np.zeros(0, complex)
    joints = np.zeros((positions, 0), complex)
    return FourBars(ends, ends, joints, joints, joints)
