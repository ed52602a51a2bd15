"""Edges of any shape as their files have them, one body driving another: where the driven one is, and what play it has.

A driven body between two edges is anywhere in what is free. Here it counts as where it is wanted, as far as the air that is
meant is left on either side; where less is left, as in the middle of what is. So it is off as far as the edges push it off, and
where it is loose on purpose, as a wheel is while one edge hands it over to another, nothing is said that is not so: an edge
that leaves it as much way as where it is held pushes nothing off.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from camgen.findings import Finding, Where, at_least
from camgen.geometry.rings import Floats, Ints, Ring
from camgen.judge.pair_features import features
from camgen.judge.pairs import Body, Bounds, OutlinePair, PairMotion, pivots_apart
from camgen.machine.features import Edge, EngagedPair
from camgen.machine.model import Law
from camgen.numerics import ASKED, latest
from camgen.study import Figure

_STEP = math.radians(0.5)  # of driver and carrier, from sample to sample
_COARSE = 30  # such steps for each angle at which overlaps are looked for before
_UNEVEN = (
    math.sqrt(5) - 1
) / 2  # of the period, from each of these to the next: no pitch of teeth fits
# Share of the air that is filled where levers are measured: what is left keeps pins off their dead points, where they have none.
_FILLED = 0.75
_NARROW = 1e-3  # rad, in which bounds are looked for at least
# Sides, the way from each to the middle, and which of two places is nearer to the edge.
_SIDES: tuple[tuple[Literal["low", "high"], float, np.ufunc], ...] = (
    ("low", 1.0, np.fmin),
    ("high", -1.0, np.fmax),
)


@dataclass(frozen=True)
class _Place:
    """The driven body over the joint's angle, (n,) each, rad: where it counts as, and both ways off the edges."""

    value: Floats  # nan where nothing is free
    slope: Floats
    play: Floats
    lever: Floats  # mm that both edges must be off by, square to them, for 1 rad of the middle between them
    gap: Floats  # air on both sides together, square to the edges, mm
    behind: Floats  # twice the air on the side from which it is moved, mm


@dataclass(frozen=True)
class _Side:
    """What holds the driven body on one side, (n,) each."""

    bound: Floats  # where it touches, rad
    end: Floats  # where the air that is meant is left, rad; nan of a side that is open
    free: Floats  # air that is meant to be left at the bound, mm
    lever: Floats  # mm for 1 rad
    slope: Floats
    air: Floats  # where the follower is wanted, mm: of both ways to tell it to first order the nearer to what is meant


def _lever(low: _Side, high: _Side) -> Floats:
    """Of the middle between both sides, or of the one that is there, mm for 1 rad, (n,)."""
    both = 2 / (1 / low.lever + 1 / high.lever)
    return np.where(np.isnan(both), np.fmax(low.lever, high.lever), both)


@dataclass(frozen=True, eq=False)
class Engagement:
    """The law of a Cam as its edges give it: the follower's angle less its rest over the cam's angle less the phase, rad.

    a, b: rings of driver and follower at those angles 0, about its axis, mm, in the order of the feature's edges; line: from the
    axis of the driver to the follower's there, mm; wanted: the law that is meant.
    """

    feature: EngagedPair
    a: tuple[Ring, ...]
    b: tuple[Ring, ...]
    line: complex
    wanted: Law

    @cached_property
    def pair(self) -> OutlinePair:
        """Both bodies."""
        return OutlinePair(Body(self.a), Body(self.b), pivots_apart(self.line, self.feature.rates))

    @cached_property
    def motion(self) -> PairMotion:
        """Where the follower is free over its period; nothing is followed where the edges overlap as they are meant to stand."""
        period = self.feature.period
        fastest = max(1.0, *map(abs, self.feature.rates))
        count = math.ceil(period * fastest / _STEP / _COARSE)
        coarse = period * np.sort(np.arange(count) * _UNEVEN % 1.0)
        wanted = self.wanted(coarse, 0)
        free = ~np.array([*map(self.pair.overlaps, coarse.tolist(), wanted.tolist())])
        if free.all():
            angles = np.linspace(0.0, period, count * _COARSE + 1)
            return self.pair.follow(angles, float(self.wanted(np.zeros(1), 0)[0]))
        unknown = np.full(count, np.nan)
        nothing = np.full((count, 2), -1)
        bounds = Bounds(coarse, unknown, unknown, free, free, nothing, nothing)
        return PairMotion(self.pair, bounds, coarse, unknown)

    @cached_property
    def _sample_sides(self) -> list[_Side]:
        return self._sides(self.motion.samples)

    @cached_property
    def _samples(self) -> _Place:
        return self._placed(self.motion.samples, self._sample_sides)

    def __call__(self, theta: Floats, order: int = 0) -> Floats:
        """The follower at the joint's angle, (n,) rad, or its derivative; of order 2 none."""
        if order > 1:
            return np.zeros(np.shape(theta))
        place = self.place(theta)
        return place.slope if order else place.value

    def lever(self, theta: Floats) -> Floats:
        """How far the edges must be off for 1 rad of the follower, mm, (n,).

        Not less than where it is held: an edge that lets go pushes nothing off.
        """
        return np.fmax(self.place(theta).lever, self._least_lever)

    def play(self, theta: Floats) -> Floats:
        """What is free, rad, (n,); 0 where nothing is."""
        return np.nan_to_num(self.place(theta).play)

    @cached_property
    def place(self) -> Callable[[ArrayLike], _Place]:
        """The follower over the joint's angle, (n,) rad."""
        return latest(self._at, ASKED)

    def _at(self, theta: Floats) -> _Place:
        period = self.feature.period
        whole = np.floor(theta.ravel() / period)
        own, back = np.unique(theta.ravel() - period * whole, return_inverse=True)
        bounds = self.motion.bounds(own)
        place = self._placed(bounds, self._sides(bounds))
        ends = self.wanted(np.array([0.0, period]), 0)
        value = place.value[back] + whole * (ends[1] - ends[0])
        others = place.slope, place.play, place.lever, place.gap, place.behind
        found = (value, *(each[back] for each in others))
        return _Place(*(each.reshape(theta.shape) for each in found))

    def _placed(self, bounds: Bounds, sides: Sequence[_Side]) -> _Place:
        """The follower between bounds and what holds it there."""
        low, high = sides
        wanted = self.wanted(bounds.theta, 0)
        # of a side that is open nan: nothing is there; one that leaves as much way as where it is held pushes nothing off
        way = self.feature.free / self._least_lever if len(self._held) else np.inf
        least = np.where(np.isnan(low.end), -np.inf, np.fmin(low.end, bounds.low + way))
        most = np.where(np.isnan(high.end), np.inf, np.fmax(high.end, bounds.high - way))
        between = least > most
        below = ~between & (wanted < least)
        above = ~between & (wanted > most)
        cases = [~bounds.free, between, below, above]
        lost = np.full(wanted.shape, np.nan)
        with np.errstate(invalid="ignore"):  # of two that are open
            middle = (least + most) / 2
        value: Floats = np.select(cases, [lost, middle, least, most], wanted)
        slopes = [lost, (low.slope + high.slope) / 2, low.slope, high.slope]
        slope: Floats = np.select(cases, slopes, self.wanted(bounds.theta, 1))
        lever = _lever(low, high)
        gap = (high.bound - low.bound) * lever + 2 * (self.feature.free - low.free)
        behind = np.where(self.wanted(bounds.theta, 1) > 0, low.air, high.air)
        return _Place(value, slope, bounds.play, lever, gap, 2 * behind)

    def _sides(self, bounds: Bounds) -> list[_Side]:
        """What holds the follower below and above: the driver grown by most of the air, so that levers are those of where the
        follower is wanted and not of where it touches; the driver as it is where there is less air.

        Where the air that is meant is left follows from either to first order; the one that holds the follower less counts, so
        that a corner, where one of both levers is of another edge, pushes nothing off.
        """
        free = self.feature.free
        grown = replace(self.pair, overlap=-_FILLED * free)
        middle = (bounds.low + bounds.high) / 2
        middle = np.where(np.isnan(middle), 0.0, middle)
        # one side may leave much more than the air
        wanted = self.wanted(bounds.theta, 0)
        guess = np.where((wanted > bounds.low) & (wanted < bounds.high), wanted, middle)
        # a larger driver leaves less: what it holds the follower by lies within
        below = np.where(np.isnan(bounds.low), _NARROW, guess - bounds.low + _NARROW)
        above = np.where(np.isnan(bounds.high), _NARROW, bounds.high - guess + _NARROW)
        near, _, _ = grown.measured(bounds.theta, guess, (below, above), False)
        within = (near.low >= bounds.low) & (near.high <= bounds.high)
        sides = []
        for side, inwards, freer in _SIDES:
            touch = self.pair.touch(bounds, side)
            close = grown.touch(near, side)
            touching = getattr(bounds, side)
            bound = np.where(within, getattr(near, side), touching)
            left = np.where(within, (1 - _FILLED) * free, free)
            lever = np.where(within, close.lever, touch.lever)
            end = freer(bound + inwards * left / lever, touching + inwards * free / touch.lever)
            slope = np.where(within, close.slope, touch.slope)
            near_air = free - left + inwards * (wanted - bound) * lever
            touch_air = inwards * (wanted - touching) * touch.lever
            nearer = np.abs(near_air - free) <= np.abs(touch_air - free)
            air = np.where(nearer, near_air, touch_air)
            sides.append(_Side(bound, end, left, lever, slope, air))
        return sides

    def figures(self, kind: str) -> list[Figure]:
        """Least and greatest play of the follower over its period."""
        play = np.degrees(self.motion.samples.play)
        play = play[np.isfinite(play)]
        ends = {"least": play.min(initial=math.inf), "greatest": play.max(initial=0.0)}
        of = self.feature.joint
        return [
            Figure(f"{end} play {{of}}", float(value), "deg", of, kind=kind)
            for end, value in ends.items()
            if len(play)
        ]

    # ---- where it is held -------------------------------------------------------------------------------------------

    @cached_property
    def _held(self) -> Ints:
        """Samples at which it is to be held on both sides."""
        return self._within(self.feature.held)

    def _within(self, ranges: Sequence[tuple[float, float]]) -> Ints:
        """Samples in some ranges of the joint's angle, rad."""
        theta = self.motion.samples.theta
        within = [(theta - begin) % math.tau <= end - begin for begin, end in ranges]
        return np.flatnonzero(np.any(within, axis=0)) if within else np.empty(0, int)

    @cached_property
    def _least_lever(self) -> float:
        return float(np.fmin.reduce(_lever(*self._sample_sides)[self._held], initial=np.inf))

    @cached_property
    def worst_gap(self) -> Gap:
        """Where it is held, or moved, by least or most compared to what is meant."""
        samples = self.motion.samples
        meant = 2 * self.feature.free
        gaps = np.where(samples.free, self._samples.gap, 0.0)
        gaps = np.nan_to_num(gaps, nan=0.0)[self._held]
        pushed = self._within(self.feature.pushed)
        behind = np.where(samples.free, self._samples.behind, 0.0)[pushed]
        gaps = np.concatenate([gaps, np.nan_to_num(behind, nan=math.inf)])
        worst = int(np.argmax(np.abs(gaps - meant)))
        k = int(np.concatenate([self._held, pushed])[worst])
        gap = float(gaps[worst])
        sides = (samples.low_pair[k], samples.high_pair[k])
        drivers = [_owner(self.a, self.feature.a, int(pair[0])) for pair in sides]
        driven = [_owner(self.b, self.feature.b, int(pair[1])) for pair in sides]
        return Gap(gap, meant, drivers[0] or drivers[1], driven[0] or driven[1])

    def overlapping(self, theta: float) -> list[str]:
        """Parts that overlap where the follower is wanted."""
        phi = float(self.wanted(np.array([theta]), 0)[0])
        return [
            name
            for first, a in _by_part(self.feature.a, self.a).items()
            for second, b in _by_part(self.feature.b, self.b).items()
            if replace(self.pair, driver=Body(a), driven=Body(b)).overlaps(theta, phi)
            for name in (first, second)
        ]


@dataclass(frozen=True)
class Gap:
    """How the follower is held: air of both sides together, mm, as it is and as it is meant, and the parts that hold it."""

    gap: float
    meant: float
    driver: str
    driven: str


def _by_part(edges: Sequence[Edge], rings: Sequence[Ring]) -> dict[str, list[Ring]]:
    """Rings of each part."""
    found: dict[str, list[Ring]] = {}
    for edge, ring in zip(edges, rings, strict=True):
        found.setdefault(edge.part, []).append(ring)
    return found


def _owner(rings: Sequence[Ring], edges: Sequence[Edge], feature: int) -> str:
    """Whose feature it is; "" for none."""
    if feature < 0:
        return ""
    counts = np.cumsum([len(features([ring])) for ring in rings])
    return edges[int(np.searchsorted(counts, feature, side="right"))].part


def judge_edges(engagement: Engagement, where: Where) -> Finding:
    """CONTACT: at how many of the driver's angles the follower is free, percent, proven from each to the next.

    where: the files of all edges.
    """
    samples = engagement.motion.samples
    proven = samples.proven.copy()
    proven[0] = True
    sound = samples.free & proven
    share = 100 * float(np.mean(sound))
    spin, carried = engagement.feature.rates
    rate = abs(carried or spin)
    turns = engagement.feature.period * rate / math.tau
    remark = f"the pair is followed at {len(sound)} angles over {turns:g} turns"
    if sound.all():
        play = np.degrees(samples.play)
        most = int(np.argmax(play))
        theta = float(samples.theta[most])
        remark += (
            "; it overlaps at none of them, nor from one to the next; "
            f"play {play.min():.3f} to {play[most]:.3f} deg, most where the finding says"
        )
    else:
        first = int(np.argmin(sound))
        theta = float(samples.theta[first])
        parts = engagement.overlapping(theta)
        unproven = (
            "there it is free, but with too little play to prove its way from the angle before"
            if samples.free[first]
            else "there no place is free for what is driven"
        )
        remark += f"; there {' and '.join(parts)} overlap" if parts else f"; {unproven}"
    theta = theta * (carried or spin) % math.tau
    place = replace(where, joint=engagement.feature.joint, theta=theta, angle="crank at")
    return at_least("CONTACT", share, 100, "percent", place, remark)
