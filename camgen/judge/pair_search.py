"""Which features of two bodies can touch, and how far apart they have to be so that they do not until the next pose.

    block      poses that follow each other; what cannot touch in any of them is left out at once
    window     by how much the driven body may be off its guess, rad or mm, in a block
    growth     by which any feature of the driver comes nearer to the driven body until the next pose, mm at most

Seen from the driven body as it moves by the guess, a driver's feature moves little: between meshing teeth it only slides. Features
that follow each other along an outline are put in groups, two in each, and these again (`Features.tree`). Of both bodies the groups
are gone down together, from a few to the features: where the discs of two groups stay apart in all poses of a block, or their
normals are never opposite, none of their features can touch there, and they are looked at no further. In a wide window normals
tell nothing, and distance from the pivot takes their place.

Whether two features may touch on the way to the next pose is asked along the normal between them: a flank that slides along another
one comes no nearer.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camgen.geometry.rings import Floats, Ints, Points
from camgen.judge.pair_events import SAME_FOOT, Couples, Freedom, Meetings, Slide, in_range
from camgen.judge.pair_features import Features, Groups

Triples = tuple[Ints, Ints, Ints]  # block, group of the driver, group of the driven body

_WIDE = 0.5  # rad, window beyond which normals are no sieve
_TURN = 2 * np.pi
_ROUNDING = 1e-6  # mm and rad, added to each sieve


@dataclass(frozen=True)
class Bodies:
    """What can touch: features of the driver and of the driven body, and how the latter moves."""

    a: Features
    b: Features
    freedom: Freedom

    def wide(self, poses: Poses) -> np.ndarray:
        """Where the window is so wide that normals tell nothing, (n,)."""
        widest = _WIDE * (1.0 if self.freedom.period < np.inf else self.a.far)
        return np.asarray(~(poses.below + poses.above < 2 * widest))


@dataclass(frozen=True)
class Poses:
    """Driver, seen from the driven body's pivot, and a guess of the driven body's freedom, each (n,).

    place, e: where the driver's origin is, mm, and how it is turned, unit complex; velocity, spin: their derivatives to theta,
    mm and 1, and bend: bound of the second one of any of its points seen from the driven body, mm.
    slope: of the guess until the next pose; step: of theta until then, 0 where nothing is asked of it.
    below, above: window, how far from the guess bounds are looked for; inf: everywhere.
    """

    place: Points
    e: Points
    velocity: Points
    spin: Floats
    bend: Floats
    guess: Floats
    slope: Floats
    step: Floats
    below: Floats
    above: Floats

    def take(self, index: Ints) -> Poses:
        """Those with the given places in the list."""
        return Poses(*(each[index] for each in vars(self).values()))

    def padded(self, count: int) -> Poses:
        """With the last one so many times more."""
        if not count:
            return self
        return Poses(
            *(np.concatenate([each, np.repeat(each[-1:], count)]) for each in vars(self).values())
        )


class _Blocks:
    """The driver as the driven body sees it at the middle of the window, in blocks of `size` poses, each (n,).

    turn, shift: of the driver half way through each block, place = shift + turn * own place. pole: the driver's own place that
    moves little in the block; drift: mm, by which that is off at most, and swing: rad, by which places turn about it.
    angle: of the turn, rad, the middle of its range in the block. half: of the window, and lean: by how much normals may be off
    being opposite, rad.
    """

    def __init__(self, bodies: Bodies, poses: Poses, size: int) -> None:
        freedom = bodies.freedom
        self.bodies = bodies
        self.wide = bool(bodies.wide(poses)[0])
        self.rotates = freedom.period < np.inf
        middle = 0.0 if self.wide else (poses.above - poses.below) / 2
        phi = poses.guess + middle
        turned = np.conj(freedom.turned(phi))
        self.turns = (poses.e * turned).reshape(-1, size)
        self.shifts = ((poses.place - freedom.moved(phi)) * turned).reshape(-1, size)
        self.turn = self.turns[:, size // 2]
        self.shift = self.shifts[:, size // 2]
        turning = self.turns - self.turn[:, None]
        shifting = self.shifts - self.shift[:, None]
        by = turning[:, -1] - turning[:, 0]
        turns_much = np.abs(by) > _ROUNDING
        by = np.where(turns_much, by, 1.0)
        self.pole = np.where(turns_much, -(shifting[:, -1] - shifting[:, 0]) / by, 0.0)
        self.drift = np.max(np.abs(turning * self.pole[:, None] + shifting), axis=1)
        self.swing = np.max(np.abs(turning), axis=1)
        off = np.angle(self.turns * np.conj(self.turn)[:, None])
        least = off.min(axis=1)
        most = off.max(axis=1)
        half = (poses.below + poses.above) / 2
        self.half = half.reshape(-1, size).max(axis=1)
        self.angle = np.angle(self.turn) + (least + most) / 2
        self.lean = (most - least) / 2 + (self.half if self.rotates else 0.0) + _ROUNDING

    def __len__(self) -> int:
        return len(self.turn)

    def close(self, a: Groups, b: Groups, triples: Triples, growth: float) -> np.ndarray:
        """Which of some blocks, groups of the driver and groups of the driven body may touch, places in the list.

        growth: by how much the driver may come nearer to them, mm.
        """
        if self.wide:
            return self._across(a, b, triples, growth)
        block, i, j = triples
        hub = a.hub[i]
        apart = self.shift[block] + self.turn[block] * hub - b.hub[j]
        room = self.swing[block] * np.abs(hub - self.pole[block]) + a.reach[i] + b.reach[j]
        room += self.half[block] * b.far[j] if self.rotates else self.half[block]
        room += self.drift[block] + growth
        near = np.flatnonzero(_squared(apart) <= room**2)
        block = block[near]
        i = i[near]
        j = j[near]
        off = (a.angle[i] + self.angle[block] - b.angle[j]) / _TURN + 0.5
        off = np.abs(off - np.rint(off)) * _TURN
        opposite = off <= a.half[i] + b.half[j] + self.lean[block]
        return np.asarray(near[opposite])

    def _across(self, a: Groups, b: Groups, triples: Triples, growth: float) -> np.ndarray:
        """The same in a wide window, in which the driven body goes everywhere: by the rings about the pivot, or strips along the
        slide, in which both lie."""
        block, i, j = triples
        across = self.bodies.freedom.across
        place = across(self.shifts[:, None] + self.turns[:, None] * a.hub[:, None])
        least = place.min(axis=2) - a.reach - growth
        most = place.max(axis=2) + a.reach + growth
        own = across(b.hub)
        above = own[j] + b.reach[j] >= least[block, i]
        return np.flatnonzero(above & (own[j] - b.reach[j] <= most[block, i]))


def partners(bodies: Bodies, poses: Poses, size: int, growth: float, gap: float) -> Couples:
    """Pairs that may touch; poses are in blocks of `size`, all of them wide or none.

    growth: by how much features may come nearer, mm, the gap included. Both trees of groups are gone down together: where two
    groups cannot touch, none of their features can.
    """
    a = bodies.a
    b = bodies.b
    blocks = _Blocks(bodies, poses, size)
    level_a = len(a.tree) - 1
    level_b = len(b.tree) - 1
    every = np.indices((len(blocks), len(a.tree[-1]), len(b.tree[-1])))
    block, i, j = (each.ravel() for each in every)
    while True:
        triples = block, i, j
        close = blocks.close(a.tree[level_a], b.tree[level_b], triples, growth + _ROUNDING)
        block, i, j = (each[close] for each in triples)
        if level_a == level_b == 0:
            break
        deeper = max(level_a, level_b)
        if level_a == deeper:
            level_a -= 1
            i, (block, j) = _divided(i, len(a.tree[level_a]), block, j)
        if level_b == deeper:
            level_b -= 1
            j, (block, i) = _divided(j, len(b.tree[level_b]), block, i)
    line = a.straight[i].astype(int) + b.straight[j]
    hollow = (a.radius[i] < 0).astype(int) + (b.radius[j] < 0)
    meet = (line + hollow <= 1) & (a.low[i] < b.high[j]) & (b.low[j] < a.high[i])
    place = poses.place.reshape(-1, size)
    e = poses.e.reshape(-1, size)
    return Couples(a, b, i[meet], j[meet], block[meet], place, e, gap)


def _divided(groups: Ints, count: int, *others: Ints) -> tuple[Ints, list[Ints]]:
    """Groups in place of which the two that each holds come, of `count` there are, and what goes along with them."""
    halves = (2 * groups[:, None] + np.arange(2)).ravel()
    kept = np.flatnonzero(halves < count)
    return halves[kept], [np.repeat(each, 2)[kept] for each in others]


def _squared(z: Points) -> Floats:
    """The square of |z|, without the root that `abs` takes."""
    return np.asarray(z.real**2 + z.imag**2)


def nearing(c: Couples, poses: Poses, freedom: Freedom, growth: float) -> Ints:
    """Poses in which pairs may come to touch on the way to the next pose, while the driven body moves with the guess.

    What is apart by more than it comes nearer along the normal does not touch; nor does what stays out of the ranges of normals,
    or beside a line, by more than both turn and move. growth: by how much anything comes nearer, mm, at most.
    """
    row, column = np.nonzero(_within(c, poses, freedom, growth))
    pose = c.pose(row, column)
    m = c.met(row, column)
    line_a = m.a.straight[m.i]
    line_b = m.b.straight[m.j]
    found = []
    for mask, test in (
        (~line_a & ~line_b, _rounds_nearing),
        (line_a, _driver_lines_nearing),
        (line_b, _driven_lines_nearing),
    ):
        chosen = np.flatnonzero(mask)
        if len(chosen):
            near = test(_Way(m.take(chosen), pose[chosen], poses, freedom))
            found.append(pose[chosen[near]])
    return np.concatenate(found) if found else np.zeros(0, np.int64)


def _within(c: Couples, poses: Poses, freedom: Freedom, growth: float) -> np.ndarray:
    """Where discs of features are no farther apart than so much at the guess, (m, size)."""
    shape = c.e.shape
    turned = np.conj(freedom.turned(poses.guess)).reshape(shape)
    moved = freedom.moved(poses.guess).reshape(shape)
    apart = (c.e * turned)[c.block]
    apart *= c.a.hub[c.i][:, None]
    apart += ((c.place - moved) * turned)[c.block]
    apart -= c.b.hub[c.j][:, None]
    reach = c.a.reach[c.i] + c.b.reach[c.j] + growth + _ROUNDING
    return np.asarray(_squared(apart) <= reach[:, None] ** 2)


class _Way:
    """How meetings change until the next pose, seen from the driven body, each (m,).

    x: the driven body's feature on the ground; turned: how that body is; way: of the driver's anchor, mm; turn: of the driver, rad,
    and rest: what acceleration adds to the way, mm, at most.
    """

    def __init__(self, m: Meetings, pose: Ints, poses: Poses, freedom: Freedom) -> None:
        step = poses.step[pose]
        slope = poses.slope[pose]
        phi = poses.guess[pose]
        arm = m.e * m.a.anchor[m.i]
        spin = poses.spin[pose]
        velocity = poses.velocity[pose] + 1j * spin * arm
        self.m = m
        self.turned = freedom.turned(phi)
        self.x = freedom.moved(phi) + self.turned * m.b.centre[m.j]
        self.way = (velocity - slope * freedom.velocity(poses.place[pose] + arm)) * step
        self.turn = (spin - slope if freedom.period < np.inf else spin) * step
        self.rest = poses.bend[pose] * step**2 / 2

    def faces(self, normal: Points, spare: Floats) -> np.ndarray:
        """Whether the driven body's outward normals on the ground lie in both ranges, but for so many rad."""
        m = self.m
        own = in_range(m.b, m.j, normal * np.conj(self.turned), spare)
        return np.asarray(own & in_range(m.a, m.i, -normal * np.conj(m.e), spare))


def _reached(apart: Floats, change: Floats, spare: Floats) -> np.ndarray:
    """Whether a distance comes to zero, while it changes by so much, give or take."""
    return np.asarray(
        (apart + np.minimum(change, 0.0) <= spare) & (apart + np.maximum(change, 0.0) >= -spare)
    )


def _rounds_nearing(w: _Way) -> np.ndarray:
    m = w.m
    total = m.a.radius[m.i] + m.b.radius[m.j] + m.gap
    sign = np.where((m.a.radius[m.i] < 0) | (m.b.radius[m.j] < 0), -1.0, 1.0)
    between = m.y - w.x
    distance = np.abs(between)
    long = np.abs(w.way) + w.rest
    with np.errstate(divide="ignore", invalid="ignore"):
        out = np.where(distance > 0, between / distance, 1.0)
        bent = np.where(sign < 0, np.minimum(long**2 / (2 * distance), long), 0.0)
        swing = np.where(distance > 2 * long, long / (distance - long), np.pi)
    change = sign * np.real(np.conj(out) * w.way)
    near = _reached(sign * (distance - np.abs(total)), change, w.rest + bent)
    return np.asarray(near & w.faces(sign * out, np.abs(w.turn) + swing))


def _driver_lines_nearing(w: _Way) -> np.ndarray:
    m = w.m
    normal = m.e * m.a.middle[m.i]
    off = np.conj(normal) * (w.x - m.y)
    length = m.a.length[m.i]
    turn = np.abs(w.turn)
    long = np.abs(w.way) + turn * length + w.rest
    at_foot = w.way - w.turn * (off.imag - length / 2) * normal
    near = _reached(
        off.real - m.b.radius[m.j] - m.gap,
        -np.real(np.conj(normal) * at_foot),
        w.rest + turn * long,
    )
    beside = (off.imag >= -long - SAME_FOOT) & (off.imag <= length + long + SAME_FOOT)
    return np.asarray(near & beside & w.faces(-normal, turn))


def _driven_lines_nearing(w: _Way) -> np.ndarray:
    m = w.m
    normal = w.turned * m.b.middle[m.j]
    off = np.conj(normal) * (m.y - w.x)
    long = np.abs(w.way) + w.rest
    near = _reached(off.real - m.a.radius[m.i] - m.gap, np.real(np.conj(normal) * w.way), w.rest)
    beside = (off.imag >= -long - SAME_FOOT) & (off.imag <= m.b.length[m.j] + long + SAME_FOOT)
    return np.asarray(near & beside & w.faces(normal, np.abs(w.turn)))


def greatest_way(bodies: Bodies, poses: Poses) -> float:
    """The longest way of any point of the driver until the next pose, seen from the driven body; mm, at most."""
    a = bodies.a
    reach = a.far + np.abs(poses.place)
    slope = np.abs(poses.slope)
    speed = np.abs(poses.velocity) + np.abs(poses.spin) * a.far
    speed = speed + slope * (1.0 if isinstance(bodies.freedom, Slide) else reach)
    return float(np.max(speed * poses.step + poses.bend * poses.step**2 / 2))
