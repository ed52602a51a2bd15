"""Levels by an integer program: the best that keep all rules, or the least that is broken; see `levels`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from camgen.parts.level_rules import Axis, Band, NoLevels, Opening, Rule, Thing, Things, Wall

# what a level, a high link, a broken rule cost; a level of a pin costs 1
LEVEL = 100.0
LOW = 0.01
BROKEN = 1e5


@dataclass(frozen=True)
class Solution:
    """What the program finds."""

    level: dict[str, int]  # by name
    upper: set[tuple[str, str]]  # axis and link, where an axis between two plates has it on top


@dataclass(frozen=True)
class _Span:
    """Levels that a thing takes, from the value of column `low` + `below` to that of column `high` + `above`."""

    low: int
    below: int
    high: int
    above: int


class _Program:
    """Columns, each with its cost and bounds, and rows: sums of columns that are at least so much.

    Columns: the highest level, the level of each name, the ends of each axis, and choices of 0 or 1.
    """

    def __init__(self, things: Things, given: Mapping[str, int], strict: bool) -> None:
        least = least_levels(things)
        self.strict = strict
        self.most = max([2 * len(least) + 1, *given.values()])
        self.big = 2.0 * self.most + 4  # relaxes a row whose choice is not made
        self.cost: list[float] = []
        self.bounds: list[tuple[float, float]] = []
        self.rows: list[tuple[dict[int, float], float]] = []
        highest = self.column(LEVEL, 0, self.most)
        self.level = {
            name: self.column(LOW, given.get(name, low), given.get(name, self.most))
            for name, low in least.items()
        }
        self.rows += [({highest: 1, k: -1}, 0) for k in self.level.values()]
        self.rows += [
            ({self.level[upper]: 1, self.level[lower]: -1}, 1) for upper, lower in things.over
        ]
        self.plate = self.column(0, 0, 0)
        for upper, lower in things.stacked:
            below = self.level.get(lower, self.plate)
            self.rows.append(({self.level[upper]: 1, below: -1}, 1))
            self.rows.append(({self.level[upper]: -1, below: 1}, -1))
        self.bound = bound_axes(things)
        # by axis: its lowest and highest level; between two plates the top of its lower stub and the bottom of its upper one
        self.ends: dict[str, tuple[int, int]] = {}
        self.uppers: dict[tuple[str, str], int] = {}  # whether a link is on an axis's upper stub
        self.held: dict[str, tuple[int, int]] = {}  # whether the lower, the upper plate holds it
        for axis in things.axes:
            if axis.far:
                self._add_stubs(axis)
        for axis in things.axes:
            if not axis.far:
                self._add_pin(axis)
        for rule in things.rules:
            self._add_rule(rule)

    def column(self, cost: float, low: float, high: float) -> int:
        """Number of a new column."""
        self.cost.append(cost)
        self.bounds.append((low, high))
        return len(self.cost) - 1

    def _add_stubs(self, axis: Axis) -> None:
        """An axis between two plates: others pass between its stubs."""
        bound = axis.name in self.bound
        low = self.column(0, -1 if bound and not axis.low else 0, self.most + 1)
        high = self.column(0, 0, self.most + 2)
        self.ends[axis.name] = (low, high)
        self.rows.append(({high: 1, low: -1}, 0))
        uppers = []
        for link in axis.links:
            upper = self.column(LOW * bound, float(link in axis.high), float(link not in axis.low))
            uppers.append(upper)
            self.uppers[axis.name, link] = upper
            self.rows.append(({low: 1, self.level[link]: -1, upper: self.big}, axis.over))
            self.rows.append(
                ({high: -1, self.level[link]: 1, upper: -self.big}, axis.over - self.big)
            )
        if bound:
            below = self.column(0, 0, 1)
            above = self.column(0, 0, 1)
            self.held[axis.name] = (below, above)
            self.rows += [({below: 1, upper: 1}, 1) for upper in uppers]
            self.rows += [({above: 1, upper: -1}, 0) for upper in uppers]
            self.rows += [({below: -1, above: -1}, -1)] if axis.runs else []

    def _add_pin(self, axis: Axis) -> None:
        """An axis from its lowest link, or the plate, to its highest."""
        through = axis.over > self.most  # all levels over its links
        low = self.column(-1, 0, 0 if axis.ground else self.most)
        high = self.column(1, self.most + 1 if through else 0, self.most + 1)
        self.ends[axis.name] = (low, high)
        for link in axis.links:
            if not through:
                self.rows.append(({high: 1, self.level[link]: -1}, axis.over))
            self.rows.append(({self.level[link]: 1, low: -1}, axis.under))

    def _span(self, thing: Thing) -> _Span:
        if isinstance(thing, Wall):
            return _Span(
                self.level.get(thing.on, self.plate), 1, self.level[thing.link], thing.over
            )
        if isinstance(thing, Opening):
            return _Span(self.plate, 0, self.plate, 0)
        if isinstance(thing, Band):
            level = self.level[thing.level]
            return _Span(level, -thing.below, level, 0)
        low, high = self.ends[thing.name]
        return _Span(low, 0, high, 0)

    def _add_rule(self, rule: Rule) -> None:
        """Two things that share no level: one lies over the other, or both pass between stubs."""
        short = (rule.needed - rule.distance) / rule.needed
        broken = self.column(BROKEN * (1 + max(0.0, short)), 0, 0 if self.strict else 1)
        a = self._span(rule.a)
        b = self._span(rule.b)
        far = [axis for axis in (rule.a, rule.b) if isinstance(axis, Axis) and axis.far]
        slotted = [thing.axis for thing in (rule.a, rule.b) if isinstance(thing, Opening)]
        if len(far) == 2 or (slotted and self.held.keys() & set(slotted)):
            self._part_plates(slotted or [axis.name for axis in far], broken)
            if far:
                self.rows.append(({b.high: 1, a.low: -1, broken: self.big}, 1))
                self.rows.append(({a.high: 1, b.low: -1, broken: self.big}, 1))
        elif far:  # over the lower stub, and under the upper one
            stubs, other = (a, b) if far[0] is rule.a else (b, a)
            self.rows.append(({other.low: 1, stubs.low: -1, broken: self.big}, 1 - other.below))
            self.rows.append(({stubs.high: 1, other.high: -1, broken: self.big}, 1 + other.above))
        else:  # a over b where `under` is 0
            under = self.column(0, 0, 1)
            self.rows.append(
                (
                    {a.low: 1, b.high: -1, under: self.big, broken: self.big},
                    1 - a.below + b.above,
                )
            )
            self.rows.append(
                (
                    {b.low: 1, a.high: -1, under: -self.big, broken: self.big},
                    1 - b.below + a.above - self.big,
                )
            )

    def _part_plates(self, axes: Sequence[str], broken: int) -> None:
        """No plate holds both axes."""
        both = [self.held.get(name) for name in axes]
        fixed = sum(each is None for each in both)  # end on the lower plate in any case
        sides = zip(*(each or (self.plate, self.plate) for each in both), strict=True)
        for (one, other), count in zip(sides, (fixed, 0), strict=True):
            row = {one: -1.0, broken: 1} | ({other: -1.0} if other != one else {})
            self.rows.append((row, count - 1))

    def solution(self) -> Solution | None:
        """The cheapest; None where the solver finds none."""
        from scipy.optimize import Bounds, LinearConstraint, milp

        table = np.zeros((len(self.rows), len(self.cost)))
        for k, (row, _) in enumerate(self.rows):
            table[k, list(row)] = list(row.values())
        optimum = milp(
            self.cost,
            integrality=np.ones(len(self.cost)),
            bounds=Bounds(*np.array(self.bounds, float).T),
            constraints=LinearConstraint(
                table, np.array([least for _, least in self.rows]), np.inf
            ),
            options={"time_limit": 10.0},
        )
        if optimum.x is None:
            return None
        return Solution(
            {name: round(optimum.x[k]) for name, k in self.level.items()},
            {pair for pair, k in self.uppers.items() if round(optimum.x[k])},
        )


def program(things: Things, given: Mapping[str, int], strict: bool = False) -> Solution | None:
    """The best levels, those given kept; rules that cannot be kept are broken at a price, or `strict`: None then.

    Raises NoLevels where no order has all that must lie over others over them.
    """
    solution = _Program(things, given, strict).solution()
    if solution is None and not strict:
        raise _no_levels(given)
    return solution


def least_levels(things: Things) -> dict[str, int]:
    """Lowest level that each name may have."""
    least = {
        band.level: 1 + max(each.below for each in things.bands if each.level == band.level)
        for band in things.bands
    }
    for axis in (axis for axis in things.axes if not axis.ground):
        least |= {link: max(least[link], 1 + axis.under) for link in axis.links}
    return least


def bound_axes(things: Things) -> set[str]:
    """Names of axes between two plates that may not be on whichever plate they like: they run in a slot of one, or meet what
    stands on the ground too."""
    blocked = {
        thing.name
        for rule in things.rules
        for thing in (rule.a, rule.b)
        if all(isinstance(each, Axis) and (each.far or each.ground) for each in (rule.a, rule.b))
    }
    return {axis.name for axis in things.axes if axis.far and (axis.runs or axis.name in blocked)}


def _no_levels(given: Mapping[str, int]) -> NoLevels:
    if not given:
        return NoLevels("levels found", 0, 1, "").saying(
            "no order of levels has all that must lie over others over them"
        )
    remedy = "set what the shaft drives highest on its pivot, and a slot over the link with its pin"
    return NoLevels("levels found", 0, 1, "", "[layers]", remedy).saying(
        "no order of levels with those of [layers] is free of collisions"
    )
