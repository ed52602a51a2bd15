"""Where two features of outlines touch: closed forms, for a body that turns or slides while the other one stands.

    y, e      driver's feature: its centre, or a line's first point, as seen from the driven one's pivot; and how it is turned
    x         the same of the driven one's feature, in its own frame
    phi       freedom of the driven one, rad, or mm along a slide
    gap       by how much both stand apart as they touch, mm; 0 of a contact, more of a driver that is grown
    closing   as phi grows both come to overlap: the touch may end what is free upwards; else it may end it downwards

A first touch has a round on one side at least, and opposite outward normals.

    round, round or hollow    the centres are D = ra + rb + gap apart, radii of hollows counting as negative; seen from the
                              pivot, X and Y away, they form a triangle:  X Y cos o = (X^2 + Y^2 - D^2) / 2
    line of the driver        the round's centre is h = rb + gap + n y from the pivot along its normal n:  X cos o = h
    line of the driven one    X, rb, n y become Y, ra, n p, p the line's first point
    on a slide                the same as a square root, and of a line as a quotient

Of both roots the sign tells which one is closing. A root counts where the normals lie in both ranges, and the foot on the line.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol

import numpy as np

from camgen.geometry.rings import Floats, Ints, Points
from camgen.judge.pair_features import SAME_NORMAL, Features

SAME_FOOT = 1e-9  # mm
_ROUNDING = (
    1e-5  # mm and mm2, added to each sieve: near a dead point a root loses half of its digits
)


@dataclass(frozen=True)
class Meetings:
    """Pairs of features at given poses, each (m,): places i in the features a and j in b, and the pose of a's.

    gap: mm, one for all.
    """

    a: Features
    b: Features
    i: Ints
    j: Ints
    y: Points
    e: Points
    gap: float

    def take(self, index: Ints) -> Meetings:
        """Those with the given places."""
        return replace(self, i=self.i[index], j=self.j[index], y=self.y[index], e=self.e[index])


@dataclass(frozen=True)
class Couples:
    """Pairs of features in blocks of poses, each (m,): places i in the features a and j in b, and a block.

    place, e: of the driver in all poses, (blocks, size), as in `Poses`. gap: mm, one for all.
    """

    a: Features
    b: Features
    i: Ints
    j: Ints
    block: Ints
    place: Points
    e: Points
    gap: float

    def take(self, index: Ints) -> Couples:
        """Those with the given places."""
        return replace(self, i=self.i[index], j=self.j[index], block=self.block[index])

    def met(self, row: Ints, column: Ints) -> Meetings:
        """Pairs of these rows in the poses of these columns of their block."""
        i = self.i[row]
        block = self.block[row]
        e = self.e[block, column]
        y = self.place[block, column] + e * self.a.centre[i]
        return Meetings(self.a, self.b, i, self.j[row], y, e, self.gap)

    def pose(self, row: Ints, column: Ints) -> Ints:
        """Places in the list of poses."""
        return np.asarray(self.block[row] * self.e.shape[1] + column)

    @cached_property
    def driver_centre(self) -> Points:
        """The driver's centres from the pivot in its own frame, (m, size) mm."""
        pivot = np.conj(self.e) * self.place
        return pivot[self.block] + self.a.centre[self.i][:, None]

    @cached_property
    def driver_radius(self) -> Floats:
        """Their distance from the pivot, squared, (m, size) mm2."""
        z = self.driver_centre
        return np.asarray(z.real**2 + z.imag**2)


@dataclass(frozen=True)
class Events:
    """Touches: place in the list of meetings, closing or opening, freedom, outward normal of the driven body on the ground."""

    index: Ints
    closing: np.ndarray
    phi: Floats
    normal: Points

    def take(self, index: Ints | np.ndarray) -> Events:
        """Those with the given places, or for which a mask holds."""
        return Events(self.index[index], self.closing[index], self.phi[index], self.normal[index])

    @classmethod
    def joined(cls, events: Sequence[Events]) -> Events:
        """All of some."""
        return cls(
            np.concatenate([np.zeros(0, np.int64), *(each.index for each in events)]),
            np.concatenate([np.zeros(0, bool), *(each.closing for each in events)]),
            np.concatenate([np.zeros(0), *(each.phi for each in events)]),
            np.concatenate([np.zeros(0, complex), *(each.normal for each in events)]),
        )


class Freedom(Protocol):
    """How the driven body moves."""

    @property
    def period(self) -> float:
        """After which it stands as before: a turn, or inf."""

    def turned(self, phi: Floats) -> Points:
        """How it is turned, unit complex."""

    def moved(self, phi: Floats) -> Points:
        """Where its origin is, mm."""

    def velocity(self, place: Points) -> Points:
        """Velocity per unit of phi of its material at a place, mm."""

    def across(self, place: Points) -> Floats:
        """What of a place it keeps as phi changes: its distance from the pivot, or from the slide; mm."""

    def rounds_reach(self, c: Couples) -> np.ndarray:
        """Where two rounds may be as far apart as for a touch, (m, size): a sieve before the formula."""

    def driver_lines_reach(self, c: Couples) -> np.ndarray:
        """Where the foot may be on a line of the driver."""

    def driven_lines_reach(self, c: Couples) -> np.ndarray:
        """Where the foot may be on a line of the driven body."""

    def rounds(self, m: Meetings) -> Events:
        """Touches of two rounds, or of a round in a hollow."""

    def driver_lines(self, m: Meetings) -> Events:
        """Touches of lines of the driver with rounds."""

    def driven_lines(self, m: Meetings) -> Events:
        """Touches of rounds with lines of the driven body."""


def touches(c: Couples, freedom: Freedom) -> tuple[Meetings, Ints, Events]:
    """All touches of the pairs in the poses of their blocks: the meetings, the pose of each, and the touches.

    Of two lines and of two hollows there are none.
    """
    line_a = c.a.straight[c.i]
    line_b = c.b.straight[c.j]
    kinds = (
        (~line_a & ~line_b, freedom.rounds_reach, freedom.rounds),
        (
            line_a & ~line_b & (c.b.radius[c.j] >= 0),
            freedom.driver_lines_reach,
            freedom.driver_lines,
        ),
        (
            ~line_a & line_b & (c.a.radius[c.i] >= 0),
            freedom.driven_lines_reach,
            freedom.driven_lines,
        ),
    )
    pairs = []
    columns = []
    found = []
    count = 0
    for mask, reach, formula in kinds:
        chosen = np.flatnonzero(mask)
        if not len(chosen):
            continue
        row, column = np.nonzero(reach(c.take(chosen)))
        row = chosen[row]
        events = formula(c.met(row, column))
        pairs.append(row)
        columns.append(column)
        found.append(Events(events.index + count, events.closing, events.phi, events.normal))
        count += len(row)
    none = np.zeros(0, np.int64)
    row = np.concatenate([none, *pairs])
    column = np.concatenate([none, *columns])
    return c.met(row, column), c.pose(row, column), Events.joined(found)


def in_range(
    features: Features, place: Ints, normal: Points, spare: Floats | float = 0.0
) -> np.ndarray:
    """Whether unit normals lie in the ranges of the features at those places: by the chord between them, which keeps its digits at small angles."""
    chord = np.abs(normal - features.middle[place])
    if np.ndim(spare) == 0 and spare == 0.0:
        return np.asarray(chord <= features.chord[place])
    limit = np.minimum(features.half[place] + SAME_NORMAL + spare, np.pi)
    return np.asarray(chord <= 2 * np.sin(limit / 2))


def _reach(m: Meetings | Couples) -> tuple[Floats, np.ndarray]:
    """Sum of the radii and the gap, negative in a hollow; and whether such two can touch."""
    total = m.a.radius[m.i] + m.b.radius[m.j] + m.gap
    hollow = (m.a.radius[m.i] < 0) | (m.b.radius[m.j] < 0)
    both = (m.a.radius[m.i] < 0) & (m.b.radius[m.j] < 0)
    return total, np.where(hollow, total < 0, total > 0) & ~both


@dataclass(frozen=True)
class Turn:
    """The driven body turns about its origin, the pivot; phi in rad."""

    period: float = 2 * np.pi

    def turned(self, phi: Floats) -> Points:
        """Of the body."""
        return np.asarray(np.exp(1j * phi))

    def moved(self, phi: Floats) -> Points:
        """Nowhere."""
        return np.zeros(np.shape(phi), complex)

    def velocity(self, place: Points) -> Points:
        """Square to the line from the pivot."""
        return 1j * place

    def across(self, place: Points) -> Floats:
        """Distance from the pivot."""
        return np.abs(place)

    def rounds_reach(self, c: Couples) -> np.ndarray:
        """Each centre may be as far from the pivot as what lies D out from the other one along its normals."""
        total, possible = _reach(c)
        driven, spread = _out(c.b.take(c.j), c.b.centre[c.j], total)
        near = np.abs(c.driver_radius - driven[:, None]) <= spread[:, None]
        near[~possible] = False
        row = np.flatnonzero(near.any(axis=1))
        few = c.take(row)
        driver, spread = _out(c.a.take(few.i), few.driver_centre.T, total[row])
        near[row] &= (np.abs(c.b.away[few.j] ** 2 - driver) <= spread).T
        return near

    def driver_lines_reach(self, c: Couples) -> np.ndarray:
        """One of both feet is on the line."""
        place = np.conj(c.a.middle[c.i])[:, None] * c.driver_centre
        h = (c.b.radius[c.j] + c.gap)[:, None] + place.real
        return _foot_reach(c.b.away[c.j][:, None] ** 2 - h**2, place.imag, c.a.length[c.i])

    def driven_lines_reach(self, c: Couples) -> np.ndarray:
        """One of both feet is on the line."""
        place = np.conj(c.b.middle[c.j]) * c.b.centre[c.j]
        h = c.a.radius[c.i] + c.gap + place.real
        squared = c.driver_radius - h[:, None] ** 2
        return _foot_reach(squared, place.imag[:, None], c.b.length[c.j])

    def rounds(self, m: Meetings) -> Events:
        """Both places of the centre x on its circle."""
        total, possible = _reach(m)
        d = np.abs(total)
        x = m.b.away[m.j]
        y = np.abs(m.y)
        kept = np.flatnonzero(possible & (np.abs(x - y) < d) & (d < x + y))
        m = m.take(kept)
        d = d[kept]
        x = x[kept]
        y = y[kept]
        total = total[kept]
        sine = np.sqrt((d - x + y) * (d + x - y) * (x + y - d) * (x + y + d))
        cosine = (x - d) * (x + d) + y * y
        events = []
        for sign in (1, -1):
            centre = m.y * (cosine - 1j * sign * np.sign(total) * sine) / (2 * y * y)
            normal = (m.y - centre) / total
            turn = centre / m.b.centre[m.j]
            local = normal * np.conj(turn) / np.abs(turn)
            valid = in_range(m.b, m.j, local) & in_range(m.a, m.i, -normal * np.conj(m.e))
            events.append(_of_turn(kept, valid, sign > 0, turn, normal))
        return Events.joined(events)

    def driver_lines(self, m: Meetings) -> Events:
        """The round's centre comes to the line, moved out by the radius, from either side."""
        n = m.e * m.a.middle[m.i]
        local_y = np.conj(n) * m.y
        h = m.b.radius[m.j] + m.gap + local_y.real
        x = m.b.away[m.j]
        kept = np.flatnonzero(np.abs(h) < x)
        m = m.take(kept)
        n = n[kept]
        local_y = local_y[kept]
        h = h[kept]
        x = x[kept]
        w = np.sqrt((x - h) * (x + h))
        events = []
        for sign in (1, -1):
            foot = sign * w - local_y.imag
            turn = n * (h + 1j * sign * w) / m.b.centre[m.j]
            local = -n * np.conj(turn) / np.abs(turn)
            valid = _on_line(foot, m.a.length[m.i]) & in_range(m.b, m.j, local)
            events.append(_of_turn(kept, valid, sign > 0, turn, -n))
        return Events.joined(events)

    def driven_lines(self, m: Meetings) -> Events:
        """The same, seen from the driven body."""
        n = m.b.middle[m.j]
        local_p = np.conj(n) * m.b.centre[m.j]
        h = m.a.radius[m.i] + m.gap + local_p.real
        y = np.abs(m.y)
        kept = np.flatnonzero(np.abs(h) < y)
        m = m.take(kept)
        n = n[kept]
        local_p = local_p[kept]
        h = h[kept]
        y = y[kept]
        w = np.sqrt((y - h) * (y + h))
        events = []
        for sign in (1, -1):
            foot = -sign * w - local_p.imag
            turn = m.y / (n * (h - 1j * sign * w))
            normal = n * turn / np.abs(turn)
            on = _on_line(foot, m.b.length[m.j])
            valid = on & in_range(m.a, m.i, -normal * np.conj(m.e))
            events.append(_of_turn(kept, valid, sign > 0, turn, normal))
        return Events.joined(events)


def _out(features: Features, centre: Points, distance: Floats) -> tuple[Floats, Floats]:
    """What lies a distance out from centres along all normals: its own distance from the pivot, squared, and by how much that
    differs at most, mm2, each (..., n).

    centre: (..., n) mm; distance: (n,) mm. Along the normal at t from the middle one it is |z|^2 + D^2 + 2 D (p cos t - q sin t).
    """
    half = np.minimum(features.half, np.pi)
    cosine = np.cos(half)
    sine = np.sin(np.minimum(half, np.pi / 2))
    along = np.conj(centre) * (features.middle * distance)
    square = centre.real**2 + centre.imag**2 + distance**2 + along.real * (1 + cosine)
    spread = np.abs(along.real) * (1 - cosine) + 2 * np.abs(along.imag) * sine
    return square, spread + _ROUNDING


def _on_line(foot: Floats, length: Floats) -> np.ndarray:
    """Whether the foot on a line from its first point is on it, (m,) mm each."""
    return np.asarray((foot >= -SAME_FOOT) & (foot <= length + SAME_FOOT))


def _foot_reach(squared: Floats, begin: Floats, length: Floats) -> np.ndarray:
    """Whether w or -w is on a line, but for rounding, (m, size); squared: w^2, mm2; begin: of the line, mm, and length, (m,) mm."""
    w = np.sqrt(np.maximum(squared, 0.0))
    least = begin - _ROUNDING
    most = begin + (length + _ROUNDING)[:, None]
    on = ((w >= least) & (w <= most)) | ((w <= -least) & (w >= -most))
    return np.asarray(on & (squared >= -_ROUNDING))


def _of_turn(kept: Ints, valid: np.ndarray, closing: bool, turn: Points, normal: Points) -> Events:
    chosen = np.flatnonzero(valid)
    phi = np.angle(turn[chosen])
    return Events(kept[chosen], np.full(len(chosen), closing), phi, normal[chosen])


@dataclass(frozen=True)
class Slide:
    """The driven body slides along a unit vector; phi in mm."""

    along: complex
    period: float = np.inf

    def turned(self, phi: Floats) -> Points:
        """Never."""
        return np.ones(np.shape(phi), complex)

    def moved(self, phi: Floats) -> Points:
        """Along the slide."""
        return self.along * np.asarray(phi, complex)

    def velocity(self, place: Points) -> Points:
        """Along the slide, everywhere."""
        return np.full(np.shape(place), self.along)

    def across(self, place: Points) -> Floats:
        """Signed distance from the slide through the origin."""
        return np.imag(place * np.conj(self.along))

    def rounds_reach(self, c: Couples) -> np.ndarray:
        """Everywhere."""
        return np.ones((len(c.i), c.e.shape[1]), bool)

    driver_lines_reach = rounds_reach
    driven_lines_reach = rounds_reach

    def rounds(self, m: Meetings) -> Events:
        """Both places of the centre on its line."""
        total, possible = _reach(m)
        d = np.abs(total)
        z = (m.y - m.b.centre[m.j]) * np.conj(self.along)
        kept = np.flatnonzero(possible & (np.abs(z.imag) < d))
        m = m.take(kept)
        d = d[kept]
        z = z[kept]
        total = total[kept]
        w = np.sqrt((d - z.imag) * (d + z.imag)) * np.sign(total)
        events = []
        for sign in (1, -1):
            phi = z.real - sign * w
            normal = self.along * (sign * w + 1j * z.imag) / total
            valid = in_range(m.b, m.j, normal) & in_range(m.a, m.i, -normal * np.conj(m.e))
            chosen = np.flatnonzero(valid)
            sense = np.full(len(chosen), sign > 0)
            events.append(Events(kept[chosen], sense, phi[chosen], normal[chosen]))
        return Events.joined(events)

    def driver_lines(self, m: Meetings) -> Events:
        """One place, unless the line runs along the slide."""
        n = m.e * m.a.middle[m.i]
        rate = np.real(np.conj(n) * self.along)
        kept = np.flatnonzero(np.abs(rate) > SAME_NORMAL)
        m = m.take(kept)
        n = n[kept]
        rate = rate[kept]
        off = np.conj(n) * (m.b.centre[m.j] - m.y)
        phi = (m.b.radius[m.j] + m.gap - off.real) / rate
        foot = off.imag + phi * np.imag(np.conj(n) * self.along)
        valid = _on_line(foot, m.a.length[m.i]) & in_range(m.b, m.j, -n)
        chosen = np.flatnonzero(valid)
        return Events(kept[chosen], rate[chosen] < 0, phi[chosen], -n[chosen])

    def driven_lines(self, m: Meetings) -> Events:
        """The same, seen from the driven body."""
        n = m.b.middle[m.j]
        rate = np.real(np.conj(n) * self.along)
        kept = np.flatnonzero(np.abs(rate) > SAME_NORMAL)
        m = m.take(kept)
        n = n[kept]
        rate = rate[kept]
        off = np.conj(n) * (m.y - m.b.centre[m.j])
        phi = (off.real - m.a.radius[m.i] - m.gap) / rate
        foot = off.imag - phi * np.imag(np.conj(n) * self.along)
        valid = _on_line(foot, m.b.length[m.j]) & in_range(m.a, m.i, -n * np.conj(m.e))
        chosen = np.flatnonzero(valid)
        return Events(kept[chosen], rate[chosen] > 0, phi[chosen], n[chosen])
