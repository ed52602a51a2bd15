"""What is laid on levels, what of it meets, and which rules a choice of levels keeps: see `levels`."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from camgen.errors import DesignError
from camgen.geometry.convex import distance
from camgen.geometry.outlines import Floats, Points

_ONE_LINE = 1e-6  # mm, by which slots that are one may lie beside each other
_STRIDES = (64, 16, 4, 1)  # samples of a motion of which one is looked at, first to last
_WAY = 1.1  # of a chord: the way between two samples


@dataclass(frozen=True)
class Band:
    """A link. Equal, as axes, walls and rules are, to what takes the same levels wherever it lies."""

    name: str
    # of its hull over the motion, (k, n) complex mm on the ground
    corners: Points = field(compare=False)
    radius: float = field(compare=False)  # of band and hubs, mm
    on: str = ""  # name of its level, where several bands share one
    below: int = 0  # how many levels under it are taken too
    slim: str = field(default="", compare=False)  # key that makes it slimmer, for messages
    move: str = field(default="", compare=False)  # key that moves it
    link: str = field(default="", compare=False)  # that it is; "" of what is none

    @property
    def level(self) -> str:
        """Name of its level."""
        return self.on or self.name


@dataclass(frozen=True)
class Axis:
    """A pin through two links or more."""

    name: str
    links: tuple[str, ...]  # names of their levels
    place: Points = field(compare=False)  # (n,) complex mm
    radius: float = field(compare=False)  # of its head and spacers, mm
    ground: bool = False  # whether the ground's plate is one of the links
    over: int = 1  # how many levels its head takes over its highest link
    under: int = 0  # the same of what is under its lowest
    slim: str = field(default="", compare=False)  # as of a Band
    move: str = field(default="", compare=False)
    far: bool = False  # whether there is a second plate over all
    low: tuple[str, ...] = ()  # links that must be on the lower one of two stubs
    high: tuple[str, ...] = ()  # on the upper one
    runs: bool = False  # whether it is a pin that runs in a slot of one plate
    about: str = ""  # name of the axis that goes through it, where it is a disc
    point: str = field(default="", compare=False)  # of the spec
    shaft: bool = field(default=False, compare=False)  # that a link is fixed on


@dataclass(frozen=True)
class Opening:
    """A hole of a plate of the ground that is wider than what its axis takes of it: a slot in which a pin runs, a motor's boss.

    Two slots on one line are one.
    """

    name: str
    # both ends of its middle line, (2, n) complex mm, or its centre, (1, n)
    corners: Points = field(compare=False)
    # half of what it takes of the plate across, half of a wall included, mm
    radius: float = field(compare=False)
    axis: str  # name of its axis
    slim: str = field(default="", compare=False)  # as of a Band
    move: str = field(default="", compare=False)


@dataclass(frozen=True)
class Wall:
    """A wall as high as a link that it guides."""

    name: str
    corners: Points = field(compare=False)  # of its hull, (k, n) complex mm
    radius: float = field(compare=False)  # mm
    link: str  # that it guides
    on: str = ""  # link on which it stands; "" of the ground plate
    over: int = 0  # how many levels it takes over the link that it guides
    slim: str = field(default="", compare=False)  # as of a Band
    move: str = field(default="", compare=False)


Thing = Band | Axis | Wall | Opening


@dataclass(frozen=True)
class Things:
    """What is to be laid."""

    bands: Sequence[Band]
    axes: Sequence[Axis]
    gap: float = 0.0  # least air of what passes by on one level, mm
    walls: Sequence[Wall] = ()
    over: Sequence[tuple[str, str]] = ()  # levels, the first of which must lie over the second
    openings: Sequence[Opening] = ()
    # levels, the first of which is the next one over the second; "" is the plate's
    stacked: Sequence[tuple[str, str]] = ()

    @property
    def every(self) -> list[Thing]:
        """All of them."""
        return [*self.bands, *self.axes, *self.walls, *self.openings]

    @cached_property
    def rules(self) -> list[Rule]:
        """Those of all pairs that meet."""
        ways = [_way(thing) for thing in self.every]
        return [rule for a, b in combinations(ways, 2) if (rule := _meets(a, b, self.gap))]


class NoLevels(DesignError):
    """No levels are free of collisions."""


class NoPassage(NoLevels):
    """What cannot pass on any level: two things, how far their middle lines come to each other (mm, at theta, rad), what they
    need, and how many more such pairs there are. The remedy names keys that make them slimmer, where half as thick would do, or
    move them."""

    def __init__(
        self, a: Thing, b: Thing, distance: float, needed: float, theta: float, more: int
    ) -> None:
        self.a = a
        self.b = b
        self.distance = distance
        self.needed = needed
        self.theta = theta
        self.more = more
        others = f", and {more} more such pair{'s' if more > 1 else ''}" if more else ""
        names = f"{a.name} and {b.name}, {math.degrees(theta):.1f} deg{others}"
        super().__init__(
            "distance of what cannot pass on any level",
            distance,
            needed,
            "mm",
            names,
            self.room(slimmer=distance >= needed / 2),
        )
        self.sentence = (
            f"{a.name} and {b.name} cannot pass on any level{others}: they are {distance:.3g} mm apart at "
            f"{math.degrees(theta):.1f} deg, and need {needed:.3g} mm"
        )
        self.args = (f"{self.sentence}; {self.remedy}",)

    def room(self, slimmer: bool) -> str:
        """In words what makes room for both: by keys that move them, and with slimmer those that make them so."""
        keys = [each.slim for each in (self.a, self.b) if slimmer]
        if self._crank_pin:
            keys.append(f"parts.discs.{self._crank_pin}, an eccentric in place of the pin")
        keys += [each.move for each in (self.a, self.b)]
        other = "slimmer or longer links" if slimmer else "longer links"
        mends = ", or ".join(dict.fromkeys(filter(None, keys)))
        return f"make {self.needed - self.distance:.3g} mm more room: {mends or other}"

    @property
    def _crank_pin(self) -> str:
        """Point of a pin that is too near the shaft on which its own link is fixed; "" where that is not what meets."""
        if not (isinstance(self.a, Axis) and isinstance(self.b, Axis)):
            return ""
        if self.a.shaft == self.b.shaft or not set(self.a.links) & set(self.b.links):
            return ""
        return self.b.point if self.a.shaft else self.a.point


@dataclass(frozen=True)
class Rule:
    """Two things that meet, so that they share no level: the distance of their middles at least (mm, at sample k), the needed."""

    a: Thing
    b: Thing
    distance: float = field(compare=False)
    needed: float = field(compare=False)
    k: int = field(compare=False)


def ways(corners: Points) -> Floats:
    """Half of how far a body may come from each sample towards the next or the last one, (n,) mm."""
    steps = np.abs(np.diff(corners, axis=1, append=corners[:, :1])).max(axis=0)
    return np.asarray(_WAY / 2 * np.maximum(steps, np.roll(steps, 1)))


@dataclass(frozen=True)
class _Way:
    """A thing over the motion: its corners, (k, n) complex mm, the disc about their mean, and half of its steps, (n,) mm."""

    thing: Thing
    corners: Points
    centre: Points
    reach: Floats
    step: Floats


def _way(thing: Thing) -> _Way:
    corners = thing.place[None] if isinstance(thing, Axis) else thing.corners
    centre = corners.mean(axis=0)
    return _Way(thing, corners, centre, np.abs(corners - centre).max(axis=0), ways(corners))


def _meets(one: _Way, other: _Way, gap: float) -> Rule | None:
    """The rule of two things that come nearer than `gap`, mm; None where they stay apart."""
    a = one.thing
    b = other.thing
    if isinstance(a, Opening) and isinstance(b, Opening):
        if a.axis == b.axis or (
            min(len(a.corners), len(b.corners)) > 1 and in_line(a.corners[:, 0], b.corners[:, 0])
        ):
            return None
    elif isinstance(a, Axis) and isinstance(b, Axis) and (a.about == b.name or b.about == a.name):
        return None
    elif isinstance(a, Opening) or isinstance(b, Opening):
        return None  # its axis passes by whatever else stands on the ground, or moves
    elif isinstance(a, Band) and (
        isinstance(b, Axis) and a.level in b.links or isinstance(b, Band) and a.level == b.level
    ):
        return None
    elif isinstance(b, Wall) and (
        isinstance(a, Wall) or {b.link, b.on} & set(a.links if isinstance(a, Axis) else (a.level,))
    ):
        return None
    needed = a.radius + b.radius + gap
    steps = one.step + other.step
    discs = np.abs(other.centre - one.centre) - one.reach - other.reach - steps
    near = np.flatnonzero(discs < needed)
    if not len(near):
        return None  # as of most links of a long chain
    between, k = _nearest(one, other, steps, near)
    if between >= needed:
        return None
    return Rule(a, b, max(0.0, between), needed, k)


def _nearest(one: _Way, other: _Way, steps: Floats, near: NDArray[np.intp]) -> tuple[float, int]:
    """Least distance of two things at the samples `near`, mm, steps taken off, and at which of them, the first where several are.

    Few samples are looked at first, then those between that may be nearer: from sample to sample the distance changes by two
    steps at most.
    """
    way = np.cumsum(2 * steps)
    below = np.full(len(steps), -np.inf)  # what the distance at a sample is at least
    least = math.inf
    where = -1
    left = near
    for stride in _STRIDES:
        chosen = left[::stride]
        if not len(chosen):
            break
        apart = distance(one.corners[:, chosen], other.corners[:, chosen])
        between = apart - steps[chosen]
        nearest = float(between.min())
        first = int(chosen[int(np.argmin(between))])
        if nearest < least or (nearest == least and first < where):
            least = nearest
            where = first
        left = np.setdiff1d(left, chosen, assume_unique=True)
        for side in ("right", "left"):
            at = np.searchsorted(chosen, left, side) - (side == "right")
            known = np.clip(at, 0, len(chosen) - 1)
            bound = apart[known] - np.abs(way[chosen[known]] - way[left]) - 2 * steps[left]
            below[left] = np.maximum(below[left], bound)
        left = left[below[left] - steps[left] <= least]
    return least, where


def in_line(one: Points, other: Points) -> bool:
    """Whether two slots, both ends of their middle lines, (2,) complex mm, lie on one line."""
    way = one[1] - one[0]
    return bool(np.all(np.abs(((other - one[0]) * way.conjugate()).imag) <= _ONE_LINE * abs(way)))


def span(thing: Thing, level: Mapping[str, int]) -> tuple[int, int]:
    """Lowest and highest level that a thing takes."""
    if isinstance(thing, Band):
        return level[thing.level] - thing.below, level[thing.level]
    if isinstance(thing, Wall):
        return level.get(thing.on, 0) + 1, level[thing.link] + thing.over
    if isinstance(thing, Opening):
        return 0, 0
    levels = [level[link] for link in thing.links]
    return 0 if thing.ground else min(levels) - thing.under, max(levels) + thing.over


def split_level(axis: Axis, rules: Sequence[Rule], level: Mapping[str, int]) -> int | None:
    """Highest level of the lower stub of an axis between two plates, such that most of its rules hold; None: it goes through."""
    spans = [span(other, level) for rule in rules for other in _others(rule, axis)]
    if not spans and not axis.high:
        return None
    levels = [level[link] for link in axis.links]
    least = max((level[link] for link in axis.low), default=0)
    most = min((level[link] for link in axis.high), default=max(levels) + 1)
    ways = sorted(at for at in {0, *levels} if least <= at < most)

    def passing(at: int) -> int:
        low, high = _gap(axis, at, level)
        return sum(low < one and other < high for one, other in spans)

    return max(ways, key=passing)


def _others(rule: Rule, axis: Axis) -> list[Thing]:
    return [other for one, other in ((rule.a, rule.b), (rule.b, rule.a)) if one is axis]


def _gap(axis: Axis, at: int, level: Mapping[str, int]) -> tuple[float, float]:
    """Between which levels an axis lets others pass, both taken, whose lower stub ends so high."""
    higher = [value for link in axis.links if (value := level[link]) > at]
    none = 0 if axis.low else -1
    return at + axis.over if at else none, min(higher) - axis.over if higher else math.inf


def plates_of(axis: Axis, at: int, level: Mapping[str, int]) -> tuple[bool, bool]:
    """Whether the lower plate holds an axis whose lower stub ends so high, and whether the upper one does."""
    levels = [level[link] for link in axis.links]
    return bool(axis.low) or any(value <= at for value in levels), any(
        value > at for value in levels
    )


def holds(rule: Rule, level: Mapping[str, int], ends: Mapping[str, int | None]) -> bool:
    """Whether two things share no level; ends: the cuts of axes between two plates."""
    a = rule.a
    b = rule.b
    if isinstance(a, Opening) and isinstance(b, Opening):
        return bool(ends.get(a.axis, 1)) != bool(ends.get(b.axis, 1))
    if isinstance(a, Axis) and isinstance(b, Axis) and a.far and b.far:
        cut_a = ends[a.name]
        cut_b = ends[b.name]
        if cut_a is None or cut_b is None:
            return False
        low_a, high_a = _gap(a, cut_a, level)
        low_b, high_b = _gap(b, cut_b, level)
        apart = not any(
            one and other
            for one, other in zip(
                plates_of(a, cut_a, level), plates_of(b, cut_b, level), strict=True
            )
        )
        return apart and low_a < high_b and low_b < high_a
    for axis in (thing for thing in (a, b) if isinstance(thing, Axis) and thing.far):
        at = ends[axis.name]
        one, other = span(_others(rule, axis)[0], level)
        low, high = (math.inf, 0) if at is None else _gap(axis, at, level)
        return low < one and other < high
    a0, a1 = span(a, level)
    b0, b1 = span(b, level)
    return a1 < b0 or b1 < a0
