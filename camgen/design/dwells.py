"""Six-bars whose output rests while the crank turns on: a coupler point runs along an arc, and a rod of its radius holds still.

frame from O = 0 to C = 1, crank a, coupler b, rocker c; P = A + z (B - A) / b
rod from P to D, output from E to D: while P runs on a circle about D with the rod's radius, D and the output rest

arcs      random four-bars, whose arc of P is made round by least squares
pivots    of the output round the arc's centre, by the output's swing and the transmission angles
six-bars  all lengths together: the output's angle over the arc, its swing, and what is out of bounds
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from camgen.design.descent import least_squares
from camgen.design.fourbars import Flags, Room, closed
from camgen.numerics import Floats, Indices, Points

_DRAWN = 6000  # four-bars at random
_ARCS = 160  # of them are made round
_ROUNDS = 40
_LENGTHS = ((-1.9, -0.3), (-0.7, 1.0), (-0.7, 1.0))  # logarithms of crank, coupler and rocker
_PLACES = 31  # of an arc
_TURN = 72  # crank angles of a turn
_FINE = 720
_ARMS = np.geomspace(0.15, 1.5, 8)  # of the output, in frames
_AROUND = 24  # directions of it
_STARTS = 40
_POLISHED = 60  # rounds
_LEAST_ARC = 0.4  # length of an arc, in frames
_WIDEST = 3.0  # radius of one
_LEAST_CRANK = 0.12
_STIFF = 20.0  # hinges, in allowances a frame
_SPARE = math.radians(0.3)  # by which a transmission angle is more than the least
_MORE = math.radians(0.3)  # by which an arc is longer than the rest that is wanted


@dataclass(frozen=True)
class SixBars:
    """m of them: logarithms of crank, coupler and rocker, z, crank angle where the rest begins, E, logarithms of output and rod.

    In frames and rad.  sides: (2, m), on which side of the way from A to C, and from P to E, the dyads lie: 1 or -1.
    """

    x: Floats  # (m, 10)
    sides: Floats

    def those(self, which: Indices | Flags) -> SixBars:
        """Some of them."""
        return SixBars(self.x[which], self.sides[:, which])

    @property
    def pivot(self) -> Points:
        """E, (m,)."""
        return np.asarray(self.x[:, 6] + 1j * self.x[:, 7], complex)

    @property
    def lengths(self) -> Floats:
        """Frame, crank, coupler, rocker, output and rod, (6, m)."""
        numbers = np.exp(np.clip(self.x[:, [0, 1, 2, 8, 9]], -8, 8)).T
        return np.concatenate([np.ones((1, len(self.x))), numbers])

    @property
    def arm(self) -> Points:
        """z, (m,)."""
        return np.asarray(self.x[:, 3] + 1j * self.x[:, 4], complex)

    def at(self, turned: Floats) -> tuple[Points, Points, Points, Points]:
        """A, B, P and D at crank angles from where the rest begins, (k,) rad: (k, m) each."""
        _, crank, coupler, rocker, output, rod = self.lengths
        a = crank * np.exp(1j * (self.x[:, 5] + turned[:, None]))
        b = closed(a, np.ones(len(self.x), complex), coupler, rocker, self.sides[0])
        p = a + self.arm * (b - a) / coupler
        d = closed(p, self.pivot, rod, output, self.sides[1])
        return a, b, p, d

    def cosines(self, a: Points, p: Points) -> Floats:
        """Of the angles between coupler and rocker, and between rod and output, (2 k, m); beyond 1 where they do not close."""
        _, _, coupler, rocker, output, rod = self.lengths
        first = (coupler**2 + rocker**2 - np.abs(1 - a) ** 2) / (2 * coupler * rocker)
        second = (rod**2 + output**2 - np.abs(self.pivot - p) ** 2) / (2 * rod * output)
        return np.concatenate([first, second])

    def angle(self, d: Points) -> Floats:
        """Of the output, (k, m) rad, followed from the first place."""
        return np.asarray(np.unwrap(np.angle(d - self.pivot), axis=0))

    def transmission(self) -> Floats:
        """Least angle over a turn, (m,) rad; -1 where the chain opens."""
        a, _, p, _ = self.at(_turn(_FINE))
        flattest = np.max(np.abs(self.cosines(a, p)), axis=0)
        return np.where(flattest <= 1, np.arccos(np.minimum(flattest, 1)), -1.0)

    def rest(self, span: float) -> Floats:
        """How far the output moves over the rest, (m,) rad."""
        return np.asarray(np.ptp(self.angle(self.at(_arc(span, _FINE))[3]), axis=0))

    def swing(self) -> Floats:
        """How far the output goes over a turn, (m,) rad."""
        return np.asarray(np.ptp(self.angle(self.at(_turn(_FINE))[3]), axis=0))

    def bars(self) -> Floats:
        """Lengths of all bars together, (m,) frames."""
        arms = np.abs(self.arm) + np.abs(self.arm - self.lengths[2])
        return np.asarray(np.sum(self.lengths[1:], axis=0) + arms)

    def gaps(self) -> Floats:
        """What must be of a length that can be made, (rows, m) frames: links, arms of P, distances of the pivots."""
        beside = [self.arm, self.arm - self.lengths[2], self.pivot, self.pivot - 1]
        return np.concatenate([self.lengths, np.abs(np.stack(beside))])


@dataclass(frozen=True)
class Rest:
    """What is wanted: span and swing, rad, and what is borne of the output while it rests, rad."""

    span: float
    swing: float
    band: float


def six_bars(rest: Rest, room: Room, rng: np.random.Generator, effort: int = 1) -> SixBars:
    """Six-bars near what is wanted; room: in frames."""
    arcs = _arcs(rest, room, rng, effort)
    starts = _with_outputs(arcs, rest, room, _STARTS * effort)
    flattest = math.cos(room.transmission + _SPARE)
    arc = _arc(rest.span, _PLACES)
    turn = _turn(_TURN)

    def residuals(x: Floats, which: Indices) -> Floats:
        bars = SixBars(x, starts.sides[:, which])
        over_arc = bars.angle(bars.at(arc)[3])
        a, _, p, d = bars.at(turn)
        still = (over_arc - over_arc.mean(axis=0)) / rest.band
        swing = (np.ptp(bars.angle(d), axis=0, keepdims=True) - rest.swing) / rest.band
        flat = np.clip(np.abs(bars.cosines(a, p)) - flattest, 0.0, 9.0)
        out = room.excess(bars.gaps())
        return np.concatenate([still, swing, _STIFF * flat, _STIFF * out]).T

    x, _ = least_squares(residuals, starts.x, _POLISHED)
    return SixBars(x, starts.sides)


def _arcs(rest: Rest, room: Room, rng: np.random.Generator, effort: int) -> SixBars:
    """Four-bars with a round arc, its centre as E and its radius as the rod."""
    count = _DRAWN * effort
    x = np.zeros((count, 10))
    for k, (low, high) in enumerate(_LENGTHS):
        x[:, k] = rng.uniform(low, high, count)
    x[:, 3:5] = rng.uniform(-2, 2, (count, 2))
    x[:, 5] = rng.uniform(0, math.tau, count)
    drawn = SixBars(x, rng.choice([-1.0, 1.0], (2, count)))
    flattest = math.cos(room.transmission)
    arc = _arc(rest.span, _PLACES)

    def residuals(x: Floats, which: Indices) -> Floats:
        bars = SixBars(np.concatenate([x, drawn.x[which, 6:]], axis=1), drawn.sides[:, which])
        frame, crank, coupler, rocker, _, _ = bars.lengths
        p = bars.at(arc)[2]
        off, _, radius = _circle(p)
        way = np.sum(np.abs(np.diff(p, axis=0)), axis=0)
        ends = np.stack([frame - crank, frame + crank])
        flat = np.abs((coupler**2 + rocker**2 - ends**2) / (2 * coupler * rocker)) - flattest
        hinges = [_LEAST_ARC - way, radius - _WIDEST, _LEAST_CRANK - crank, crank - 0.9, *flat]
        return np.concatenate([off, np.clip(hinges, 0.0, 9.0)]).T

    glance = np.sum(residuals(drawn.x[:, :6], np.arange(count)) ** 2, axis=1)
    best = np.argsort(np.where(np.isfinite(glance), glance, np.inf), kind="stable")
    best = best[: _ARCS * effort]
    found, _ = least_squares(lambda x, which: residuals(x, best[which]), drawn.x[best, :6], _ROUNDS)
    numbers = np.concatenate([found, np.zeros((len(found), 4))], axis=1)
    bars = SixBars(numbers, drawn.sides[:, best])
    _, centre, radius = _circle(bars.at(arc)[2])
    sound = np.isfinite(radius) & (radius > 0.05) & (radius < 2 * _WIDEST)
    numbers[:, 6] = centre.real
    numbers[:, 7] = centre.imag
    numbers[:, 9] = np.log(np.where(sound, radius, 1.0))
    return SixBars(numbers, bars.sides).those(sound)


def _with_outputs(arcs: SixBars, rest: Rest, room: Room, most: int) -> SixBars:
    """Six-bars with a pivot of the output round each centre, those first whose swing and transmission are nearest."""
    angle, length = (each.ravel() for each in np.meshgrid(_directions(), np.log(_ARMS)))
    each = len(angle)
    x = np.repeat(arcs.x, each, axis=0)
    side = np.repeat(arcs.sides[:1], each, axis=1)
    centre = x[:, 6] + 1j * x[:, 7]
    arm = np.tile(np.exp(length + 1j * angle), len(arcs.x))
    x[:, 6] = (centre + arm).real
    x[:, 7] = (centre + arm).imag
    x[:, 8] = np.tile(length, len(arcs.x))
    flat_side = SixBars(x, np.concatenate([side, side]))
    p = flat_side.at(_arc(rest.span, 2))[2][0]
    beside = np.sign(np.imag(np.conj(centre - p) * (flat_side.pivot - centre)))
    bars = SixBars(x, np.stack([side[0], np.where(beside == 0, 1.0, beside)]))
    a, _, p, d = bars.at(_turn(_TURN // 2))
    flattest = np.max(np.abs(bars.cosines(a, p)), axis=0)
    swing = np.ptp(bars.angle(d), axis=0)
    out = np.max(room.excess(bars.gaps()), axis=0)
    worth = np.abs(swing - rest.swing) / rest.swing + out
    worth += 2 * np.maximum(flattest - math.cos(room.transmission), 0.0)
    order = np.argsort(np.where(np.isfinite(worth), worth, np.inf), kind="stable")
    # of each arc a few pivots at most
    taken = np.zeros(len(arcs.x), int)
    chosen: list[int] = []
    for k in order.tolist():
        if taken[k // each] < 3:
            taken[k // each] += 1
            chosen.append(k)
        if len(chosen) == most:
            break
    return bars.those(np.array(chosen, int))


def _circle(p: Points) -> tuple[Floats, Points, Floats]:
    """The best circle of places, (k, m), by a linear fit: how far each is off it, its centre and its radius."""
    middle = p.mean(axis=0)
    q = p - middle
    square = np.abs(q) ** 2
    xx = np.sum(q.real**2, axis=0)
    yy = np.sum(q.imag**2, axis=0)
    xy = np.sum(q.real * q.imag, axis=0)
    xs = np.sum(q.real * square, axis=0) / 2
    ys = np.sum(q.imag * square, axis=0) / 2
    determinant = np.maximum(xx * yy - xy**2, 1e-300)
    u = (yy * xs - xy * ys) / determinant
    v = (xx * ys - xy * xs) / determinant
    radius = np.sqrt(u**2 + v**2 + square.mean(axis=0))
    centre = u + 1j * v
    return np.abs(q - centre) - radius, middle + centre, radius


def _arc(span: float, count: int) -> Floats:
    return np.linspace(-_MORE / 2, span + _MORE / 2, count)


def _turn(count: int) -> Floats:
    return math.tau * np.arange(count + 1) / count


def _directions() -> Floats:
    return math.tau * np.arange(_AROUND) / _AROUND
