"""Levels of an assembly: which link lies on which level, so that nothing meets over the whole motion.

    band     a link's outline: all points within `radius` of the convex hull of its hubs; it lies on one level, 1 or more;
             what must lie beside each other, such as a cam and its roller, are bands of one level
    axis     a pin through its links: it takes all levels from its lowest link, or from the ground plate under level 1, to its
             highest, and one more for its head
    far      an axis of the ground between two plates goes through from one to the other, or leaves out the levels between two
             of its links, where others pass: then it is two stubs, one on each plate, or one stub on either
    opening  a slot of the ground, in which the pin of an axis runs: in the plate on which that pin ends, which is one of them;
             or another wide hole
    wall     stands beside a link that slides, on the link or plate that guides it, as high as the link, or its cover over it
    rules    bands that meet lie on different levels; a band that meets an axis lies under or over it; axes that meet take no
             level together
    wanted   the fewest levels, then the shortest pins: depth first, or an integer program

Distances are those at samples of the motion, less half of the way to the next sample at either body: what lies between two
samples is bounded by the ways, which 1.1 times the chords bound while a step turns a body by less than half a radian.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import combinations

import numpy as np

from camgen.errors import DesignError
from camgen.geometry.convex import distance
from camgen.geometry.outlines import Floats, Points

_ONE_LINE = 1e-6  # mm, by which slots that are one may lie beside each other
_WAY = 1.1  # of a chord: the way between two samples
_LEVEL, _LOW, _BROKEN = 100.0, 0.01, 1e5  # what a level, a high link, a broken rule cost; a level of a pin costs 1
_NODES = 20_000  # of the search, some 0.5 s; then the integer program, which takes that to load


@dataclass(frozen=True)
class Band:
    """A link: corners of its hull over the motion, (k, n) complex mm on the ground, and the radius of band and hubs.

    on: name of its level, where several bands share one; below: how many levels under it are taken too; slim, move: which keys
    do so, for messages. Equal, as axes, walls and rules are, to what takes the same levels wherever it lies.
    """

    name: str
    corners: Points = field(compare=False)
    radius: float = field(compare=False)
    on: str = ""
    below: int = 0
    slim: str = field(default="", compare=False)
    move: str = field(default="", compare=False)

    @property
    def level(self) -> str:
        """Name of its level."""
        return self.on or self.name


@dataclass(frozen=True)
class Axis:
    """A pin through links (two or more, the ground's plate one of them where `ground`): its place, (n,) complex mm.

    links: names of their levels; radius: of its head and spacers, mm; over: how many levels its head takes over its highest
    link; under: the same of what is under its lowest; far: whether there is a second plate over all, low, high: links that
    must be on the lower, on the upper one of two stubs; runs: whether it is a pin that runs in a slot of one plate.
    """

    name: str
    links: tuple[str, ...]
    place: Points = field(compare=False)
    radius: float = field(compare=False)
    ground: bool = False
    over: int = 1
    under: int = 0
    slim: str = field(default="", compare=False)
    move: str = field(default="", compare=False)
    far: bool = False
    low: tuple[str, ...] = ()
    high: tuple[str, ...] = ()
    runs: bool = False


@dataclass(frozen=True)
class Opening:
    """A hole of a plate of the ground that is wider than what its axis takes of it: a slot in which a pin runs, a motor's boss.

    corners: both ends of its middle line, (2, n) complex mm, or its centre, (1, n); radius: half of what it takes of the plate
    across, half of a wall included, mm; axis: the name of that axis. Two slots on one line are one.
    """

    name: str
    corners: Points = field(compare=False)
    radius: float = field(compare=False)
    axis: str
    slim: str = field(default="", compare=False)
    move: str = field(default="", compare=False)


@dataclass(frozen=True)
class Wall:
    """A wall as high as a link that it guides, on the ground plate or the link `on`: corners of its hull, (k, n) complex mm.

    over: how many levels it takes over that link too.
    """

    name: str
    corners: Points = field(compare=False)
    radius: float = field(compare=False)
    link: str
    on: str = ""
    over: int = 0
    slim: str = field(default="", compare=False)
    move: str = field(default="", compare=False)


Thing = Band | Axis | Wall | Opening


class Unlaid(DesignError):
    """No levels are free of collisions."""


class Crowded(Unlaid):
    """What cannot pass on any level: two things, how far their middle lines come to each other (mm, at theta, rad), what they
    need, and how many more such pairs there are. The remedy names keys that make them slimmer, where half as thick would do, or
    move them."""

    def __init__(self, a: Thing, b: Thing, distance: float, needed: float, theta: float, more: int) -> None:
        self.a, self.b, self.distance, self.needed, self.theta, self.more = a, b, distance, needed, theta, more
        others = f", and {more} more such pair{'s' if more > 1 else ''}" if more else ""
        said = f"{a.name} and {b.name}, {math.degrees(theta):.1f} deg{others}"
        keys = [*(each.slim for each in (a, b) if distance >= needed / 2), *(each.move for each in (a, b))]
        mends = list(dict.fromkeys(filter(None, keys)))
        super().__init__(
            "distance of what cannot pass on any level", distance, needed, "mm", said,
            f"make room for {needed - distance:.3g} mm: {', or '.join(mends) or 'use slimmer or longer links'}",
        )  # fmt: skip


@dataclass(frozen=True)
class _Rule:
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


def _meets(one: _Way, other: _Way, gap: float) -> _Rule | None:
    """The rule of two things that come nearer than `gap`, mm; None where they stay apart."""
    a, b = one.thing, other.thing
    if isinstance(a, Opening) and isinstance(b, Opening):
        if a.axis == b.axis or (min(len(a.corners), len(b.corners)) > 1 and in_line(a.corners[:, 0], b.corners[:, 0])):
            return None
    elif isinstance(a, Opening) or isinstance(b, Opening):
        return None  # its axis passes by whatever else stands on the ground, or moves
    elif isinstance(a, Band) and (isinstance(b, Axis) and a.level in b.links or isinstance(b, Band) and a.level == b.level):
        return None
    elif isinstance(b, Wall) and (isinstance(a, Wall) or {b.link, b.on} & set(a.links if isinstance(a, Axis) else (a.level,))):
        return None
    needed, steps = a.radius + b.radius + gap, one.step + other.step
    if float((np.abs(other.centre - one.centre) - one.reach - other.reach - steps).min()) >= needed:
        return None  # not even their discs, as of most links of a long chain
    between = distance(one.corners, other.corners) - steps
    k = int(np.argmin(between))
    if between[k] >= needed:
        return None
    return _Rule(a, b, max(0.0, float(between[k])), needed, k)


def in_line(one: Points, other: Points) -> bool:
    """Whether two slots, both ends of their middle lines, (2,) complex mm, lie on one line."""
    way = one[1] - one[0]
    return bool(np.all(np.abs(((other - one[0]) * way.conjugate()).imag) <= _ONE_LINE * abs(way)))


def levels(
    bands: Sequence[Band], axes: Sequence[Axis], theta: Floats, gap: float, given: Mapping[str, int] | None = None,
    walls: Sequence[Wall] = (), over: Sequence[tuple[str, str]] = (), explain: bool = True, searched: bool = False,
    openings: Sequence[Opening] = (),
) -> dict[str, int] | None:  # fmt: skip
    """Levels by name, 1 the lowest; None where they are not found soon, or to `explain` a longer search and DesignError.

    theta: (n,) rad, of the samples, for messages; gap: mm, least air of what passes by on one level; given: levels that are
    to be kept; over: pairs of levels, the first of which must lie over the second; searched: soon was not soon enough.
    """
    given = given or {}
    rules = _rules([*bands, *axes, *walls, *openings], gap)
    crossed = any(isinstance(rule.a, Opening) for rule in rules)
    found: dict[str, int] | None = None
    if any(axis.far for axis in axes):
        found = integer_program(bands, axes, rules, given, over, strict=True)
    elif not searched and not crossed:
        soon = search(tuple(bands), tuple(axes), tuple(rules), tuple(given.items()), tuple(over))
        found = None if soon is None else dict(soon)
    if found is not None or not explain:
        return found
    found = integer_program(bands, axes, rules, given, over)  # it says what cannot be, too
    assert found is not None, "rules may be broken"
    ends = _ends(bands, axes, rules, found)
    broken = [rule for rule in rules if not _kept(rule, found, ends)]
    if broken:
        rule = min(broken, key=lambda each: each.distance - each.needed)
        raise Crowded(rule.a, rule.b, rule.distance, rule.needed, float(theta[rule.k]), len(broken) - 1)
    return found


def span(thing: Thing, level: Mapping[str, int]) -> tuple[int, int]:
    """Lowest and highest level that a thing takes."""
    if isinstance(thing, Band):
        return level[thing.level] - thing.below, level[thing.level]
    if isinstance(thing, Wall):
        return level.get(thing.on, 0) + 1, level[thing.link] + thing.over
    if isinstance(thing, Opening):
        return 0, 0
    held = [level[link] for link in thing.links]
    return 0 if thing.ground else min(held) - thing.under, max(held) + thing.over


def cuts(
    bands: Sequence[Band], axes: Sequence[Axis], walls: Sequence[Wall], gap: float, level: Mapping[str, int],
    openings: Sequence[Opening] = (),
) -> dict[str, int]:  # fmt: skip
    """Of each axis between two plates that does not go through, by its name, the highest level of its lower stub: 0 where all
    of its links are on the upper plate's, that of its highest link where all are on the lower plate's."""
    rules = _rules([*bands, *axes, *walls, *openings], gap)
    return {name: at for name, at in _ends(bands, axes, rules, level).items() if at is not None}


def _rules(things: Sequence[Thing], gap: float) -> list[_Rule]:
    """Those of all pairs that meet."""
    ways = [_way(thing) for thing in things]
    return [rule for a, b in combinations(ways, 2) if (rule := _meets(a, b, gap))]


def _ends(
    bands: Sequence[Band], axes: Sequence[Axis], rules: Sequence[_Rule], level: Mapping[str, int]
) -> dict[str, int | None]:
    """The cut of each axis between two plates. What two such axes leave to each other decides the integer program: on which
    plate a link of theirs is held; that of any other axis lets most of what meets it pass."""
    far, bound = {axis.name: axis for axis in axes if axis.far}, _bound(axes, rules)
    found = {name: cut(axis, rules, level) for name, axis in far.items() if name not in bound}
    if bound:
        solution = _program(bands, axes, rules, level)
        assert solution is not None, "rules may be broken"
        upper = solution.upper
        found |= {name: max([level[link] for link in far[name].links if (name, link) not in upper], default=0) for name in bound}
    return found


def _bound(axes: Sequence[Axis], rules: Sequence[_Rule]) -> set[str]:
    """Names of axes between two plates that may not be on whichever plate they like: they run in a slot of one, or meet what
    stands on the ground too."""
    met = {thing.name for rule in rules for thing in (rule.a, rule.b)
           if all(isinstance(each, Axis) and (each.far or each.ground) for each in (rule.a, rule.b))}  # fmt: skip
    return {axis.name for axis in axes if axis.far and (axis.runs or axis.name in met)}


def cut(axis: Axis, rules: Sequence[_Rule], level: Mapping[str, int]) -> int | None:
    """Highest level of the lower stub of an axis between two plates, such that most of its rules hold; None: it goes through."""
    spans = [span(other, level) for rule in rules for other in _others(rule, axis)]
    if not spans and not axis.high:
        return None
    held = [level[link] for link in axis.links]
    least = max((level[link] for link in axis.low), default=0)
    most = min((level[link] for link in axis.high), default=max(held) + 1)
    ways = sorted(at for at in {0, *held} if least <= at < most)

    def passing(at: int) -> int:
        low, high = _gap(axis, at, level)
        return sum(low < one and other < high for one, other in spans)

    return max(ways, key=passing)


def _others(rule: _Rule, axis: Axis) -> list[Thing]:
    return [other for one, other in ((rule.a, rule.b), (rule.b, rule.a)) if one is axis]


def _gap(axis: Axis, at: int, level: Mapping[str, int]) -> tuple[float, float]:
    """Between which levels an axis lets others pass, both taken, whose lower stub ends so high."""
    higher = [value for link in axis.links if (value := level[link]) > at]
    none = 0 if axis.low else -1
    return at + axis.over if at else none, min(higher) - axis.over if higher else math.inf


def _plates(axis: Axis, at: int, level: Mapping[str, int]) -> tuple[bool, bool]:
    """Whether the lower plate holds an axis whose lower stub ends so high, and whether the upper one does."""
    held = [level[link] for link in axis.links]
    return bool(axis.low) or any(value <= at for value in held), any(value > at for value in held)


def _kept(rule: _Rule, level: Mapping[str, int], ends: Mapping[str, int | None]) -> bool:
    """Whether two things share no level; ends: the cuts of axes between two plates."""
    a, b = rule.a, rule.b
    if isinstance(a, Opening) and isinstance(b, Opening):
        return bool(ends.get(a.axis, 1)) != bool(ends.get(b.axis, 1))
    if isinstance(a, Axis) and isinstance(b, Axis) and a.far and b.far:
        cut_a, cut_b = ends[a.name], ends[b.name]
        if cut_a is None or cut_b is None:
            return False
        (low_a, high_a), (low_b, high_b) = _gap(a, cut_a, level), _gap(b, cut_b, level)
        apart = not any(one and other for one, other in zip(_plates(a, cut_a, level), _plates(b, cut_b, level), strict=True))
        return apart and low_a < high_b and low_b < high_a
    for axis in (thing for thing in (a, b) if isinstance(thing, Axis) and thing.far):
        at, (one, other) = ends[axis.name], span(_others(rule, axis)[0], level)
        low, high = (math.inf, 0) if at is None else _gap(axis, at, level)
        return low < one and other < high
    (a0, a1), (b0, b1) = span(a, level), span(b, level)
    return a1 < b0 or b1 < a0


def _no_levels(given: Mapping[str, int]) -> Unlaid:
    if not given:
        return Unlaid("levels found", 0, 1, "", "", "", "no order of levels has all that must lie over others over them")
    remedy = "set what the shaft drives highest on its pivot, and a slot over the link with its pin"
    return Unlaid("levels found", 0, 1, "", "[layers]", remedy, "no order of levels with those of [layers] is free of collisions")


def _least(bands: Sequence[Band], axes: Sequence[Axis]) -> dict[str, int]:
    """Lowest level that each name may have."""
    least = {band.level: 1 + max(each.below for each in bands if each.level == band.level) for band in bands}
    for axis in (axis for axis in axes if not axis.ground):
        least |= {link: max(least[link], 1 + axis.under) for link in axis.links}
    return least


@lru_cache(maxsize=8)  # variants of a machine mostly meet in the same places
def search(
    bands: tuple[Band, ...], axes: tuple[Axis, ...], rules: tuple[_Rule, ...], kept: tuple[tuple[str, int], ...],
    over: tuple[tuple[str, str], ...],
) -> Mapping[str, int] | None:  # fmt: skip
    """The best levels that keep all rules, by depth first on ever more levels; None where _NODES nodes do not find them."""
    given = dict(kept)
    least = _least(bands, axes)
    about = Counter(name for rule in rules for thing in (rule.a, rule.b) for name in _on(thing))
    names = sorted(least, key=lambda name: (name not in given, -about[name]))
    touching = {name: [rule for rule in rules if name in _on(rule.a) or name in _on(rule.b)] for name in names}
    ordered = {name: [pair for pair in over if name in pair] for name in names}
    pins = {name: [axis for axis in axes if name in axis.links] for name in names}
    level: dict[str, int] = {}
    best: dict[str, int] | None = None
    cheapest, left = math.inf, _NODES

    def sound(name: str) -> bool:
        for rule in touching[name]:
            a, b = _so_far(rule.a, level), _so_far(rule.b, level)
            if a and b and not (a[1] < b[0] or b[1] < a[0]):
                return False
        return all(level.get(upper, math.inf) > level.get(lower, 0) for upper, lower in ordered[name])

    def lay(k: int, highest: int, cost: float) -> None:
        nonlocal best, cheapest, left
        if k == len(names):
            best, cheapest = dict(level), cost
            return
        name = names[k]
        for value in [given[name]] if name in given else range(least[name], highest + 1):
            left -= 1
            if left < 0:
                return
            before = sum(_length(axis, level) for axis in pins[name])
            level[name] = value
            more = cost + _LOW * value + sum(_length(axis, level) for axis in pins[name]) - before
            if more < cheapest and sound(name):
                lay(k + 1, highest, more)
            del level[name]

    for highest in range(max([1, *least.values(), *given.values()]), 2 * len(names) + 2):
        lay(0, highest, 0.0)
        if best is not None or left < 0:
            break
    return {name: best[name] for name in least} if best is not None else None


def _on(thing: Thing) -> tuple[str, ...]:
    """Names of the levels that say which levels a thing takes."""
    if isinstance(thing, Axis):
        return thing.links
    if isinstance(thing, Opening):
        return ()
    return (thing.level,) if isinstance(thing, Band) else (thing.link, *([thing.on] if thing.on else []))


def _so_far(thing: Thing, level: Mapping[str, int]) -> tuple[int, int] | None:
    """Levels that a thing takes at least, some of its names being laid; None where nothing is known."""
    if isinstance(thing, Axis):
        held = [level[link] for link in thing.links if link in level]
        return (0 if thing.ground else min(held) - thing.under, max(held) + thing.over) if held else None
    known = all(name in level for name in _on(thing))
    return span(thing, level) if known else None


def _length(axis: Axis, level: Mapping[str, int]) -> int:
    """Levels from an axis's lowest to its highest so far."""
    ends = _so_far(axis, level)
    return ends[1] - ends[0] if ends else 0


def integer_program(
    bands: Sequence[Band], axes: Sequence[Axis], rules: Sequence[_Rule], given: Mapping[str, int],
    over: Sequence[tuple[str, str]] = (), strict: bool = False,
) -> dict[str, int] | None:  # fmt: skip
    """The same by branch and bound; rules that cannot be kept are broken at a price, or `strict`: None where one cannot be."""
    found = _program(bands, axes, rules, given, over, strict)
    return None if found is None else found.level


@dataclass(frozen=True)
class _Solution:
    """Levels by name; upper: axis and link, of each link that an axis between two plates holds on its upper stub."""

    level: dict[str, int]
    upper: set[tuple[str, str]]


def _program(
    bands: Sequence[Band], axes: Sequence[Axis], rules: Sequence[_Rule], given: Mapping[str, int],
    over: Sequence[tuple[str, str]] = (), strict: bool = False,
) -> _Solution | None:  # fmt: skip
    """Its solution; None only where `strict`."""
    from scipy.optimize import Bounds, LinearConstraint, milp

    least = _least(bands, axes)
    most = max([2 * len(least) + 1, *given.values()])
    cost, bounds = [_LEVEL], [(0.0, float(most))]  # the first column is the highest level
    rows: list[tuple[dict[int, float], float]] = []  # sum >= right

    def column(price: float, low: float, high: float) -> int:
        cost.append(price)
        bounds.append((low, high))
        return len(cost) - 1

    level = {name: column(_LOW, given.get(name, low), given.get(name, most)) for name, low in least.items()}
    rows += [({0: 1, k: -1}, 0) for k in level.values()]
    rows += [({level[upper]: 1, level[lower]: -1}, 1) for upper, lower in over]
    axis_ends: dict[str, tuple[int, int]] = {}
    uppers: dict[tuple[str, str], int] = {}
    held: dict[str, tuple[int, int]] = {}  # whether the lower plate holds an axis, and whether the upper one does
    big, plate, bound = 2.0 * most + 4, column(0, 0, 0), _bound(axes, rules)
    for axis in (axis for axis in axes if axis.far):  # top of the lower stub, bottom of the upper one: others pass between
        none = -1 if axis.name in bound and not axis.low else 0
        low, high = axis_ends[axis.name] = column(0, none, most + 1), column(0, 0, most + 2)
        rows.append(({high: 1, low: -1}, 0))
        for link in axis.links:
            upper = column(_LOW * (axis.name in bound), float(link in axis.high), float(link not in axis.low))
            uppers[axis.name, link] = upper
            rows.append(({low: 1, level[link]: -1, upper: big}, axis.over))
            rows.append(({high: -1, level[link]: 1, upper: -big}, axis.over - big))
        if axis.name in bound:
            below, above = held[axis.name] = column(0, 0, 1), column(0, 0, 1)
            rows += [({below: 1, uppers[axis.name, link]: 1}, 1) for link in axis.links]
            rows += [({above: 1, uppers[axis.name, link]: -1}, 0) for link in axis.links]
            rows += [({below: -1, above: -1}, -1)] if axis.runs else []
    for axis in (axis for axis in axes if not axis.far):
        low, high = axis_ends[axis.name] = column(-1, 0, 0 if axis.ground else most), column(1, 0, most + 1)
        for link in axis.links:
            rows.append(({high: 1, level[link]: -1}, axis.over))
            rows.append(({level[link]: 1, low: -1}, axis.under))

    def ends(thing: Thing) -> tuple[int, int, int, int]:
        """Column of the lowest level and what is added to it, and the same of the highest."""
        if isinstance(thing, Wall):
            return level.get(thing.on, plate), 1, level[thing.link], thing.over
        if isinstance(thing, Opening):
            return plate, 0, plate, 0
        if isinstance(thing, Band):
            return level[thing.level], -thing.below, level[thing.level], 0
        return axis_ends[thing.name][0], 0, axis_ends[thing.name][1], 0

    for rule in rules:
        (a0, a, a1, a_over), (b0, b, b1, b_over) = ends(rule.a), ends(rule.b)
        short = (rule.needed - rule.distance) / rule.needed
        broken = column(_BROKEN * (1 + max(0.0, short)), 0, 0 if strict else 1)
        far = [axis for axis in (rule.a, rule.b) if isinstance(axis, Axis) and axis.far]
        slotted = [thing.axis for thing in (rule.a, rule.b) if isinstance(thing, Opening)]
        if len(far) == 2 or (slotted and held.keys() & set(slotted)):  # on no plate both of them
            both = [held.get(name) for name in slotted or [axis.name for axis in far]]
            sides = zip(*(each or (plate, plate) for each in both), strict=True)
            there = sum(each is None for each in both)  # those that end on the lower plate in any case
            for (one, other), fixed in zip(sides, (there, 0), strict=True):
                rows.append(({one: -1.0, broken: 1} | ({other: -1.0} if other != one else {}), fixed - 1))
            if far:
                rows.append(({b1: 1, a0: -1, broken: big}, 1))
                rows.append(({a1: 1, b0: -1, broken: big}, 1))
            continue
        if far:
            if far[0] is rule.a:
                (a0, a, a1, a_over), (b0, b, b1, b_over) = (b0, b, b1, b_over), (a0, a, a1, a_over)
            rows.append(({a0: 1, b0: -1, broken: big}, 1 - a))  # over the lower stub, and under the upper one
            rows.append(({b1: 1, a1: -1, broken: big}, 1 + a_over))
            continue
        upper = column(0, 0, 1)
        rows.append(({a0: 1, b1: -1, upper: big, broken: big}, 1 - a + b_over))  # a over b where `upper` is 0
        rows.append(({b0: 1, a1: -1, upper: -big, broken: big}, 1 - b + a_over - big))
    table = np.zeros((len(rows), len(cost)))
    for k, (row, _) in enumerate(rows):
        table[k, list(row)] = list(row.values())
    found = milp(
        cost, integrality=np.ones(len(cost)), bounds=Bounds(*np.array(bounds).T),
        constraints=LinearConstraint(table, np.array([right for _, right in rows]), np.inf), options={"time_limit": 10.0},
    )  # fmt: skip
    if found.x is None and strict:
        return None
    if found.x is None:
        raise _no_levels(given)
    chosen = {name: round(found.x[k]) for name, k in level.items()}
    return _Solution(chosen, {pair for pair, k in uppers.items() if round(found.x[k])})
