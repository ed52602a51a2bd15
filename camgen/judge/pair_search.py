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
from camgen.judge.pair_events import SAME_FOOT, Freedom, Meetings, Slide, in_range
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


@dataclass(frozen=True)
class Poses:
    """Driver, seen from the driven body's pivot, and a guess of the driven body's freedom, each (n,).

    place, e: where the driver's origin is, mm, and how it is turned, unit complex; velocity, spin: their derivatives to theta,
    mm and 1, and bend: bound of the second one of any of its points seen from the driven body, mm.
    slope: of the guess until the next pose; step: of theta until then, 0 where nothing is asked of it.
    """

    place: Points
    e: Points
    velocity: Points
    spin: Floats
    bend: Floats
    guess: Floats
    slope: Floats
    step: Floats

    def part(self, low: int, high: int) -> Poses:
        """Those from one place in the list to before another."""
        return Poses(*(each[low:high] for each in vars(self).values()))

    def padded(self, count: int) -> Poses:
        """With the last one so many times more."""
        if not count:
            return self
        return Poses(
            *(np.concatenate([each, np.repeat(each[-1:], count)]) for each in vars(self).values())
        )


def partners(
    bodies: Bodies, poses: Poses, size: int, window: tuple[float, float], growth: float
) -> tuple[Ints, Ints, Ints]:
    """Pairs that may touch: block, feature of a, feature of b; poses are in blocks of `size`.

    window: from guess less the first to guess and the second, at most; growth: the greatest, mm.
    """
    a = bodies.a
    b = bodies.b
    freedom = bodies.freedom
    shape = (-1, size)
    below, above = window
    half = (below + above) / 2
    wide = not half < _WIDE * (1.0 if freedom.period < np.inf else a.far)
    phi = poses.guess.reshape(shape) + (0.0 if wide else (above - below) / 2)
    place = poses.place.reshape(shape)
    e = poses.e.reshape(shape)
    half = np.inf if wide else half
    block_a, i = _near_driver(bodies, place, e, growth)
    block_b, j = _near_driven(bodies, place, phi, half, growth)
    if not len(i) or not len(j):
        none = np.zeros(0, np.int64)
        return none, none, none
    # driver's discs seen from the driven body
    turned = np.conj(freedom.turned(phi))
    shift = (place - freedom.moved(phi)) * turned
    hub = (e * turned)[block_a]
    hub *= a.hub[i][:, None]
    hub += shift[block_a]
    middle = hub.mean(axis=1)
    spread = np.sqrt(np.max(_squared(hub - middle[:, None]), axis=1))
    reach = spread + a.reach[i] + growth + _ROUNDING
    if wide:
        first, second = _across(b, freedom, hub, a.reach[i] + growth + _ROUNDING, j)
        m, n = overlapping(first, second, (block_a, block_b))
    else:
        m, n = _opposite(bodies, (e, phi), half, (block_a, i), (block_b, j))
        hub_b = b.hub[j]
        reach_b = b.reach[j]
        move = half * (np.abs(hub_b) + reach_b if freedom.period < np.inf else 1.0)
        close = _squared(middle[m] - hub_b[n]) <= (reach[m] + (reach_b + move)[n]) ** 2
        m = m[close]
        n = n[close]
        apart = np.abs(freedom.across(middle)[m] - freedom.across(hub_b)[n])
        close = apart <= reach[m] + reach_b[n]
        m = m[close]
        n = n[close]
    block = block_a[m]
    i = i[m]
    j = j[n]
    line = a.straight[i].astype(int) + b.straight[j]
    hollow = (a.radius[i] < 0).astype(int) + (b.radius[j] < 0)
    meet = (line + hollow <= 1) & (a.low[i] < b.high[j]) & (b.low[j] < a.high[i])
    return block[meet], i[meet], j[meet]


def _squared(z: Points) -> Floats:
    """The square of |z|, without the root that `abs` takes."""
    return np.asarray(z.real**2 + z.imag**2)


def _near_driver(bodies: Bodies, place: Points, e: Points, growth: float) -> tuple[Ints, Ints]:
    """Driver's features in the ring, or strip, that the driven body can sweep: block and feature."""
    a = bodies.a
    b = bodies.b
    freedom = bodies.freedom
    k = place.shape[1] // 2
    across = freedom.across(place[:, k, None] + e[:, k, None] * a.hub)
    drift = np.max(np.abs(place - place[:, k, None]), axis=1)
    swing = np.max(np.abs(e - e[:, k, None]), axis=1)
    spare = a.reach + drift[:, None] + swing[:, None] * np.abs(a.hub) + growth + _ROUNDING
    own = freedom.across(b.hub)
    low = float(np.min(own - b.reach))
    high = float(np.max(own + b.reach))
    block, i = np.nonzero((across - spare <= high) & (across + spare >= low))
    return block, i


def _near_driven(
    bodies: Bodies, place: Points, phi: Floats, half: float, growth: float
) -> tuple[Ints, Ints]:
    """Driven body's features that come as near to the driver's origin as its own: block and feature."""
    a = bodies.a
    b = bodies.b
    freedom = bodies.freedom
    if half == np.inf:
        return tuple(each.ravel() for each in np.indices((len(place), len(b))))  # type: ignore[return-value]
    k = place.shape[1] // 2
    middle = freedom.turned(phi[:, k, None]) * b.hub + freedom.moved(phi[:, k, None])
    away = np.abs(middle - place[:, k, None])
    change = np.max(np.abs(phi - phi[:, k, None]), axis=1)[:, None] + half
    move = change * (np.abs(b.hub) if freedom.period < np.inf else 1.0)
    drift = np.max(np.abs(place - place[:, k, None]), axis=1)[:, None]
    spare = b.reach + move + drift + growth + _ROUNDING
    low = float(np.min(np.abs(a.hub) - a.reach))
    return np.nonzero((away - spare <= a.far) & (away + spare >= low))  # type: ignore[return-value]


def _across(
    b: Features, freedom: Freedom, hub: Points, reach: Floats, j: Ints
) -> tuple[tuple[Floats, Floats], tuple[Floats, Floats]]:
    """Intervals of what a place keeps as the driven body moves, of the driver's discs and of the driven one's."""
    across = freedom.across(hub)
    low = across.min(axis=1) - reach
    width = across.max(axis=1) + reach - low
    own = freedom.across(b.hub[j]) - b.reach[j]
    return (low, width), (own, 2 * b.reach[j])


def _opposite(
    bodies: Bodies,
    turns: tuple[Points, Floats],
    half: float,
    driver: tuple[Ints, Ints],
    driven: tuple[Ints, Ints],
) -> tuple[Ints, Ints]:
    """Pairs whose normals are opposite at some pose of their block; places in both lists."""
    a = bodies.a
    b = bodies.b
    freedom = bodies.freedom
    e, phi = turns
    block_a, i = driver
    block_b, j = driven
    relative = e * np.conj(freedom.turned(phi))
    middle = relative.shape[1] // 2
    off = np.angle(relative * np.conj(relative[:, middle, None]))
    spare = _ROUNDING + (half if freedom.period < np.inf else 0.0)
    low = np.angle(relative[:, middle]) + off.min(axis=1) - spare
    span = off.max(axis=1) - off.min(axis=1) + 2 * spare
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


def meetings(
    bodies: Bodies,
    pairs: tuple[Ints, Ints, Ints],
    poses: Poses,
    size: int,
    gap: float,
) -> tuple[Meetings, Ints]:
    """All pairs at all poses of their blocks, and the pose of each."""
    a = bodies.a
    block, i, j = pairs
    pose = (block[:, None] * size + np.arange(size)).ravel()
    i = np.repeat(i, size)
    j = np.repeat(j, size)
    y = poses.place[pose] + poses.e[pose] * a.centre[i]
    return Meetings(a, bodies.b, i, j, y, poses.e[pose], gap), pose


def nearing(m: Meetings, pose: Ints, poses: Poses, freedom: Freedom) -> Ints:
    """Meetings that may become a touch on the way to the next pose, while the driven body moves with the guess.

    What is apart by more than it comes nearer along the normal does not touch; nor does what stays out of the ranges of normals,
    or beside a line, by more than both turn and move.
    """
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
            found.append(chosen[near])
    return np.concatenate(found) if found else np.zeros(0, np.int64)


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
