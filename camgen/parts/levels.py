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
from functools import lru_cache

from camgen.geometry.outlines import Floats
from camgen.parts.level_order import lowest_levels
from camgen.parts.level_program import LOW, bound_axes, least_levels, program
from camgen.parts.level_rules import (
    Axis,
    Band,
    NoPassage,
    Opening,
    Rule,
    Thing,
    Things,
    holds,
    span,
    split_level,
)

_NODES = 20_000  # of the search, some 0.5 s; then the integer program, which takes that to load


def quick_levels(things: Things, given: Mapping[str, int] | None = None) -> dict[str, int] | None:
    """Levels by name, 1 the lowest, those given kept; None where they are not found soon."""
    given = given or {}
    if any(axis.far for axis in things.axes):
        solution = program(things, given, strict=True)
        return None if solution is None else solution.level
    if any(isinstance(rule.a, Opening) for rule in things.rules):
        return None
    level = search(
        tuple(things.bands),
        tuple(things.axes),
        tuple(things.rules),
        tuple(given.items()),
        (tuple(things.over), tuple(things.stacked)),
    )
    return None if level is None else dict(level)


def levels(things: Things, theta: Floats, given: Mapping[str, int] | None = None) -> dict[str, int]:
    """Levels by name, as `quick_levels`, by a longer search; NoPassage, with what meets and at which theta, where there are none.

    theta: (n,) rad, of the samples.
    """
    given = given or {}
    solution = None
    if any(axis.far for axis in things.axes):
        solution = program(things, given, strict=True)
    solution = solution or program(things, given)
    assert solution is not None, "rules may be broken"
    ends = _ends(things, solution.level)
    broken = [rule for rule in things.rules if not holds(rule, solution.level, ends)]
    if broken:
        rule = min(broken, key=lambda each: each.distance - each.needed)
        raise NoPassage(
            rule.a, rule.b, rule.distance, rule.needed, float(theta[rule.k]), len(broken) - 1
        )
    return solution.level


def cuts(things: Things, level: Mapping[str, int]) -> dict[str, int]:
    """Of each axis between two plates that does not go through, by its name, the highest level of its lower stub: 0 where all
    of its links are on the upper plate's, that of its highest link where all are on the lower plate's."""
    return {name: end for name, end in _ends(things, level).items() if end is not None}


def _ends(things: Things, level: Mapping[str, int]) -> dict[str, int | None]:
    """The cut of each axis between two plates. What two such axes leave to each other decides the integer program: on which
    plate a link of theirs is held; that of any other axis lets most of what meets it pass."""
    far = {axis.name: axis for axis in things.axes if axis.far}
    bound = bound_axes(things)
    ends = {
        name: split_level(axis, things.rules, level)
        for name, axis in far.items()
        if name not in bound
    }
    if bound:
        solution = program(things, level)
        assert solution is not None, "rules may be broken"
        for name in bound:
            lower = [link for link in far[name].links if (name, link) not in solution.upper]
            ends[name] = max([level[link] for link in lower], default=0)
    return ends


@lru_cache(maxsize=8)  # variants of a machine mostly meet in the same places
def search(
    bands: tuple[Band, ...],
    axes: tuple[Axis, ...],
    rules: tuple[Rule, ...],
    fixed: tuple[tuple[str, int], ...],
    orders: tuple[tuple[tuple[str, str], ...], ...],
) -> Mapping[str, int] | None:
    """The best levels that keep all rules, by depth first on ever more levels; None where _NODES nodes do not find them.

    orders: what must lie over what, and what is stacked on what.
    """
    given = dict(fixed)
    over, stacked = orders
    least = lowest_levels(least_levels(Things(bands, axes)), rules, over, given, stacked)
    if least is None:
        return None
    about = Counter(name for rule in rules for thing in (rule.a, rule.b) for name in _on(thing))
    names = sorted(least, key=lambda name: (name not in given, -about[name]))
    touching = {
        name: [rule for rule in rules if name in _on(rule.a) or name in _on(rule.b)]
        for name in names
    }
    above = {name: [pair for pair in over if name in pair] for name in names}
    next_to = {name: [pair for pair in stacked if name in pair] for name in names}
    pins = {name: [axis for axis in axes if name in axis.links] for name in names}
    level: dict[str, int] = {"": 0}
    best: dict[str, int] | None = None
    cheapest = math.inf
    nodes = _NODES

    def sound(name: str) -> bool:
        for rule in touching[name]:
            a = _so_far(rule.a, level)
            b = _so_far(rule.b, level)
            if a and b and not (a[1] < b[0] or b[1] < a[0]):
                return False
        return _stacked(next_to[name], level) and all(
            level.get(upper, math.inf) > level.get(lower, 0) for upper, lower in above[name]
        )

    def lay(k: int, highest: int, cost: float) -> None:
        nonlocal best, cheapest, nodes
        if k == len(names):
            best = dict(level)
            cheapest = cost
            return
        name = names[k]
        for value in [given[name]] if name in given else range(least[name], highest + 1):
            nodes -= 1
            if nodes < 0:
                return
            before = sum(_length(axis, level) for axis in pins[name])
            level[name] = value
            more = cost + LOW * value + sum(_length(axis, level) for axis in pins[name]) - before
            if more < cheapest and sound(name):
                lay(k + 1, highest, more)
            del level[name]

    for highest in range(max([1, *least.values(), *given.values()]), 2 * len(names) + 2):
        lay(0, highest, 0.0)
        if best is not None or nodes < 0:
            break
    return {name: best[name] for name in least} if best is not None else None


def _stacked(pairs: Sequence[tuple[str, str]], level: Mapping[str, int]) -> bool:
    """Whether the first of each pair is the next over the second, as far as both are laid."""
    return all(
        level[upper] == level[lower] + 1
        for upper, lower in pairs
        if upper in level and lower in level
    )


def _on(thing: Thing) -> tuple[str, ...]:
    """Names of the levels that say which levels a thing takes."""
    if isinstance(thing, Axis):
        return thing.links
    if isinstance(thing, Opening):
        return ()
    return (
        (thing.level,)
        if isinstance(thing, Band)
        else (thing.link, *([thing.on] if thing.on else []))
    )


def _so_far(thing: Thing, level: Mapping[str, int]) -> tuple[int, int] | None:
    """Levels that a thing takes at least, some of its names being laid; None where nothing is known."""
    if isinstance(thing, Axis):
        levels = [level[link] for link in thing.links if link in level]
        return (
            (0 if thing.ground else min(levels) - thing.under, max(levels) + thing.over)
            if levels
            else None
        )
    complete = all(name in level for name in _on(thing))
    return span(thing, level) if complete else None


def _length(axis: Axis, level: Mapping[str, int]) -> int:
    """Levels from an axis's lowest to its highest so far."""
    ends = _so_far(axis, level)
    return ends[1] - ends[0] if ends else 0
