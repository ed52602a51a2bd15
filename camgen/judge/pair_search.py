"""Which features of two bodies can touch, and how far apart they have to be so that they do not until the next pose.

    block      poses that follow each other; what cannot touch in any of them is left out at once
    window     by how much the driven body may be off its guess, rad or mm, in a block
    growth     by which any feature of the driver comes nearer to the driven body until the next pose, mm at most

Seen from the driven body as it moves by the guess, a driver's feature moves little: between meshing teeth it only slides. Three
sieves follow each other: rings about the pivot in which both bodies lie, normals that are opposite at some pose, distance.
Normals are intervals, and pairs of those that overlap are found in n log n and their number. In a wide window normals tell
nothing, and distance from the pivot takes their place.

Whether two features may touch on the way to the next pose is asked along the normal between them: a flank that slides along another
one comes no nearer.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camgen.geometry.rings import Floats, Ints, Points
from camgen.judge.pair_events import SAME_FOOT, Couples, Freedom, Meetings, Slide, in_range
from camgen.judge.pair_features import Features, overlapping

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
    """The driver as the driven body sees it at the middle of the window, in blocks of `size` poses.

    turn, shift: of the driver half way through each block, place = shift + turn * own place, (n,). pole: its own place that moves
    little in the block; drift: mm, by which that is off at most, and swing: rad, by which places turn about it. half: of the window.
    """

    def __init__(self, freedom: Freedom, poses: Poses, size: int, wide: bool) -> None:
        middle = 0.0 if wide else (poses.above - poses.below) / 2
        phi = poses.guess + middle
        turned = np.conj(freedom.turned(phi))
        turns = (poses.e * turned).reshape(-1, size)
        shifts = ((poses.place - freedom.moved(phi)) * turned).reshape(-1, size)
        self.turn = turns[:, size // 2]
        self.shift = shifts[:, size // 2]
        turning = turns - self.turn[:, None]
        shifting = shifts - self.shift[:, None]
        by = turning[:, -1] - turning[:, 0]
        turns_much = np.abs(by) > _ROUNDING
        by = np.where(turns_much, by, 1.0)
        self.pole = np.where(turns_much, -(shifting[:, -1] - shifting[:, 0]) / by, 0.0)
        self.drift = np.max(np.abs(turning * self.pole[:, None] + shifting), axis=1)
        self.swing = np.max(np.abs(turning), axis=1)
        off = np.angle(turns * np.conj(self.turn)[:, None])
        self.turns = turns
        self.shifts = shifts
        self.least_turn = off.min(axis=1)
        self.most_turn = off.max(axis=1)
        half = (poses.below + poses.above) / 2
        self.half = np.full(len(turns), np.inf) if wide else half.reshape(-1, size).max(axis=1)

    def seen(self, place: Points) -> tuple[Points, Floats]:
        """Own places of the driver, (m,): where they are half way, and by how much they are off that in the block, (n, m) mm."""
        away = np.abs(place - self.pole[:, None])
        spread = self.drift[:, None] + self.swing[:, None] * away
        return self.shift[:, None] + self.turn[:, None] * place, spread


def partners(bodies: Bodies, poses: Poses, size: int, growth: float, gap: float) -> Couples:
    """Pairs that may touch; poses are in blocks of `size`, all of them wide or none.

    growth: by how much features may come nearer, mm, the gap included.
    """
    a = bodies.a
    b = bodies.b
    freedom = bodies.freedom
    wide = bool(bodies.wide(poses)[0])
    shaped = poses.place.reshape(-1, size), poses.e.reshape(-1, size)
    blocks = _Blocks(freedom, poses, size, wide)
    growth = growth + _ROUNDING
    # rings about the pivot, or strips along the slide, that both can reach
    place, spread = blocks.seen(a.hub)
    reach = spread + (a.reach + growth)
    across = freedom.across(place)
    own = freedom.across(b.hub)
    low = float(np.min(own - b.reach))
    high = float(np.max(own + b.reach))
    block_a, i = np.nonzero((across - reach <= high) & (across + reach >= low))
    turns = freedom.period < np.inf
    move = np.outer(blocks.half, np.abs(b.hub) + b.reach if turns else np.ones(len(b)))
    if wide:
        block_b, j = (each.ravel() for each in np.indices((len(blocks.turn), len(b))))
    else:
        origin, astray = blocks.seen(np.zeros(1, complex))
        away = np.abs(b.hub - origin)
        spare = b.reach + move + astray + growth
        least = float(np.min(np.abs(a.hub) - a.reach))
        block_b, j = np.nonzero((away - spare <= a.far) & (away + spare >= least))
    if not len(i) or not len(j):
        none = np.zeros(0, np.int64)
        return Couples(a, b, none, none, none, shaped[0], shaped[1], gap)
    if wide:
        across = freedom.across(blocks.shifts[block_a] + blocks.turns[block_a] * a.hub[i][:, None])
        room = a.reach[i] + growth
        least_across = across.min(axis=1) - room
        first = (least_across, across.max(axis=1) + room - least_across)
        second = (own[j] - b.reach[j], 2 * b.reach[j])
        m, n = overlapping(first, second, (block_a, block_b))
    else:
        place = place[block_a, i]
        reach = reach[block_a, i]
        m, n = _opposite(bodies, blocks, (block_a, i), (block_b, j))
        room = b.reach[j] + move[block_b, j]
        close = _squared(place[m] - b.hub[j[n]]) <= (reach[m] + room[n]) ** 2
        m = m[close]
        n = n[close]
    block = block_a[m]
    i = i[m]
    j = j[n]
    line = a.straight[i].astype(int) + b.straight[j]
    hollow = (a.radius[i] < 0).astype(int) + (b.radius[j] < 0)
    meet = (line + hollow <= 1) & (a.low[i] < b.high[j]) & (b.low[j] < a.high[i])
    return Couples(a, b, i[meet], j[meet], block[meet], *shaped, gap)


def _squared(z: Points) -> Floats:
    """The square of |z|, without the root that `abs` takes."""
    return np.asarray(z.real**2 + z.imag**2)


def _opposite(
    bodies: Bodies, blocks: _Blocks, driver: tuple[Ints, Ints], driven: tuple[Ints, Ints]
) -> tuple[Ints, Ints]:
    """Pairs whose normals are opposite at some pose of their block; places in both lists."""
    a = bodies.a
    b = bodies.b
    block_a, i = driver
    block_b, j = driven
    spare = _ROUNDING + (blocks.half if bodies.freedom.period < np.inf else 0.0)
    low = np.angle(blocks.turn) + blocks.least_turn - spare
    span = blocks.most_turn - blocks.least_turn + 2 * spare
    start = (a.normal_angle[i] + np.pi + low[block_a]) % _TURN
    own = b.normal_angle[j] % _TURN
    width = 2 * b.half[j]
    reach = 2 * a.half[i] + span[block_a]
    # a turn before or after, where intervals run past a whole one
    before = np.flatnonzero(own + width >= _TURN)
    after = np.flatnonzero(own <= max(float((start + reach).max()) - _TURN, -1.0))
    place = np.concatenate([np.arange(len(j)), before, after])
    own = np.concatenate([own, own[before] - _TURN, own[after] + _TURN])
    m, n = overlapping((start, reach), (own, width[place]), (block_a, block_b[place]))
    return m, place[n]


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

    def reached(self, apart: Floats, change: Floats, spare: Floats) -> np.ndarray:
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
    near = w.reached(sign * (distance - np.abs(total)), change, w.rest + bent)
    return np.asarray(near & w.faces(sign * out, np.abs(w.turn) + swing))


def _driver_lines_nearing(w: _Way) -> np.ndarray:
    m = w.m
    normal = m.e * m.a.middle[m.i]
    off = np.conj(normal) * (w.x - m.y)
    length = m.a.length[m.i]
    turn = np.abs(w.turn)
    long = np.abs(w.way) + turn * length + w.rest
    at_foot = w.way - w.turn * (off.imag - length / 2) * normal
    near = w.reached(
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
    near = w.reached(off.real - m.a.radius[m.i] - m.gap, np.real(np.conj(normal) * w.way), w.rest)
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
