"""What must lie over what, by the rules alone: bounds of the levels, before any search for them.

Two things that meet lie one over the other, either way round. Where one way contradicts what is known already, the other
one holds, and from it more follows; where both do, there are no levels. Differences of levels are known in a table `apart`:
level[i] - level[j] >= apart[i, j], the plate at level 0 among them; it always holds all that follows from its entries.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from camgen.geometry.outlines import Floats
from camgen.parts.level_rules import Axis, Band, Opening, Rule, Thing, Wall

_PLATE = ""


class Contradiction(Exception):
    """What is known of the levels allows none."""


def lowest_levels(
    least: Mapping[str, int],
    rules: Sequence[Rule],
    over: Sequence[tuple[str, str]],
    given: Mapping[str, int],
    stacked: Sequence[tuple[str, str]] = (),
) -> dict[str, int] | None:
    """A level of each name that is under none by which all rules hold; None where it is seen that there are none.

    least: bounds that are known; over: levels, the first of which lies over the second; given: levels that are fixed; stacked: levels, the first of which is the next over the second.
    """
    known = _Order([_PLATE, *least])
    try:
        for name, low in least.items():
            known.add([(name, _PLATE, low)])
        for name in sorted(given.keys() & least.keys()):
            known.add([(name, _PLATE, given[name]), (_PLATE, name, -given[name])])
        for upper, lower in over:
            known.add([(upper, lower, 1)])
        for upper, lower in stacked:
            known.add([(upper, lower, 1), (lower, upper, -1)])
        _follow(known, rules)
    except Contradiction:
        return None
    return {name: round(known.apart[known.number[name], 0]) for name in least}


Steps = list[tuple[str, str, int]]  # the first lies over the second, by so many levels at least


class _Order:
    """Differences of levels, of which everything that follows is known."""

    def __init__(self, names: Sequence[str]) -> None:
        self.number = {name: k for k, name in enumerate(names)}
        self.apart: Floats = np.full((len(names), len(names)), -np.inf)
        np.fill_diagonal(self.apart, 0.0)

    def allows(self, steps: Steps) -> bool:
        """Whether nothing known is against each of them."""
        return all(
            self.apart[self.number[lower], self.number[upper]] + by <= 0
            for upper, lower, by in steps
        )

    def add(self, steps: Steps) -> None:
        """Know these too; Contradiction."""
        for upper, lower, by in steps:
            through = self.apart[:, self.number[upper], None] + by
            self.apart = np.maximum(self.apart, through + self.apart[self.number[lower]])
        if np.any(np.diagonal(self.apart) > 0):
            raise Contradiction


def _follow(known: _Order, rules: Sequence[Rule]) -> None:
    """Know all that follows from rules of which one way round alone is left; Contradiction."""
    open_rules = [(_over(rule.a, rule.b), _over(rule.b, rule.a)) for rule in rules]
    before = len(open_rules) + 1
    while len(open_rules) < before:
        before = len(open_rules)
        undecided = []
        for ways in open_rules:
            left = [way for way in ways if known.allows(way)]
            if len(left) > 1:
                undecided.append(ways)
            elif left:
                known.add(left[0])
            else:
                raise Contradiction
        open_rules = undecided


def _over(one: Thing, other: Thing) -> Steps:
    """The levels that lift one over the other."""
    lows, low = _bottom(one)
    highs, high = _top(other)
    return [(upper, lower, high - low + 1) for upper in lows for lower in highs]


def _top(thing: Thing) -> tuple[Sequence[str], int]:
    """The levels whose highest its top is, and how much over that one."""
    if isinstance(thing, Band):
        return (thing.level,), 0
    if isinstance(thing, Opening):
        return (_PLATE,), 0
    return (thing.links if isinstance(thing, Axis) else (thing.link,)), thing.over


def _bottom(thing: Thing) -> tuple[Sequence[str], int]:
    """The levels whose lowest its bottom is, and how much over that one, below 0 where it is under it."""
    if isinstance(thing, Band):
        return (thing.level,), -thing.below
    if isinstance(thing, Wall):
        return (thing.on or _PLATE,), 1
    if isinstance(thing, Opening) or thing.ground:
        return (_PLATE,), 0
    return thing.links, -thing.under
