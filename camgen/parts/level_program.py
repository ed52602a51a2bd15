"""Levels by an integer program: the best that keep all rules, or the least that is broken; see `levels`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from camgen.parts.level_rules import Axis, Band, Opening, Rule, Thing, Unlaid, Wall

# what a level, a high link, a broken rule cost; a level of a pin costs 1
LEVEL = 100.0
LOW = 0.01
BROKEN = 1e5


@dataclass(frozen=True)
class Solution:
    """Levels by name; upper: axis and link, of each link that an axis between two plates holds on its upper stub."""

    level: dict[str, int]
    upper: set[tuple[str, str]]


def integer_program(
    bands: Sequence[Band],
    axes: Sequence[Axis],
    rules: Sequence[Rule],
    given: Mapping[str, int],
    over: Sequence[tuple[str, str]] = (),
    strict: bool = False,
) -> dict[str, int] | None:
    """The same by branch and bound; rules that cannot be kept are broken at a price, or `strict`: None where one cannot be."""
    found = program(bands, axes, rules, given, over, strict)
    return None if found is None else found.level


def program(
    bands: Sequence[Band],
    axes: Sequence[Axis],
    rules: Sequence[Rule],
    given: Mapping[str, int],
    over: Sequence[tuple[str, str]] = (),
    strict: bool = False,
) -> Solution | None:
    """Its solution; None only where `strict`."""
    from scipy.optimize import Bounds, LinearConstraint, milp

    least = least_levels(bands, axes)
    most = max([2 * len(least) + 1, *given.values()])
    cost, bounds = [LEVEL], [(0.0, float(most))]  # the first column is the highest level
    rows: list[tuple[dict[int, float], float]] = []  # sum >= right

    def column(price: float, low: float, high: float) -> int:
        cost.append(price)
        bounds.append((low, high))
        return len(cost) - 1

    level = {
        name: column(LOW, given.get(name, low), given.get(name, most))
        for name, low in least.items()
    }
    rows += [({0: 1, k: -1}, 0) for k in level.values()]
    rows += [({level[upper]: 1, level[lower]: -1}, 1) for upper, lower in over]
    axis_ends: dict[str, tuple[int, int]] = {}
    uppers: dict[tuple[str, str], int] = {}
    held: dict[
        str, tuple[int, int]
    ] = {}  # whether the lower plate holds an axis, and whether the upper one does
    big, plate, bound = 2.0 * most + 4, column(0, 0, 0), bound_axes(axes, rules)
    for axis in (
        axis for axis in axes if axis.far
    ):  # top of the lower stub, bottom of the upper one: others pass between
        none = -1 if axis.name in bound and not axis.low else 0
        low, high = axis_ends[axis.name] = column(0, none, most + 1), column(0, 0, most + 2)
        rows.append(({high: 1, low: -1}, 0))
        for link in axis.links:
            upper = column(
                LOW * (axis.name in bound), float(link in axis.high), float(link not in axis.low)
            )
            uppers[axis.name, link] = upper
            rows.append(({low: 1, level[link]: -1, upper: big}, axis.over))
            rows.append(({high: -1, level[link]: 1, upper: -big}, axis.over - big))
        if axis.name in bound:
            below, above = held[axis.name] = column(0, 0, 1), column(0, 0, 1)
            rows += [({below: 1, uppers[axis.name, link]: 1}, 1) for link in axis.links]
            rows += [({above: 1, uppers[axis.name, link]: -1}, 0) for link in axis.links]
            rows += [({below: -1, above: -1}, -1)] if axis.runs else []
    for axis in (axis for axis in axes if not axis.far):
        through = axis.over > most  # all levels over its links
        low, high = axis_ends[axis.name] = (
            column(-1, 0, 0 if axis.ground else most),
            column(1, most + 1 if through else 0, most + 1),
        )
        for link in axis.links:
            rows += [] if through else [({high: 1, level[link]: -1}, axis.over)]
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
        broken = column(BROKEN * (1 + max(0.0, short)), 0, 0 if strict else 1)
        far = [axis for axis in (rule.a, rule.b) if isinstance(axis, Axis) and axis.far]
        slotted = [thing.axis for thing in (rule.a, rule.b) if isinstance(thing, Opening)]
        if len(far) == 2 or (slotted and held.keys() & set(slotted)):  # on no plate both of them
            both = [held.get(name) for name in slotted or [axis.name for axis in far]]
            sides = zip(*(each or (plate, plate) for each in both), strict=True)
            there = sum(
                each is None for each in both
            )  # those that end on the lower plate in any case
            for (one, other), fixed in zip(sides, (there, 0), strict=True):
                rows.append(
                    ({one: -1.0, broken: 1} | ({other: -1.0} if other != one else {}), fixed - 1)
                )
            if far:
                rows.append(({b1: 1, a0: -1, broken: big}, 1))
                rows.append(({a1: 1, b0: -1, broken: big}, 1))
            continue
        if far:
            if far[0] is rule.a:
                (a0, a, a1, a_over), (b0, b, b1, b_over) = (b0, b, b1, b_over), (a0, a, a1, a_over)
            rows.append(
                ({a0: 1, b0: -1, broken: big}, 1 - a)
            )  # over the lower stub, and under the upper one
            rows.append(({b1: 1, a1: -1, broken: big}, 1 + a_over))
            continue
        upper = column(0, 0, 1)
        rows.append(
            ({a0: 1, b1: -1, upper: big, broken: big}, 1 - a + b_over)
        )  # a over b where `upper` is 0
        rows.append(({b0: 1, a1: -1, upper: -big, broken: big}, 1 - b + a_over - big))
    table = np.zeros((len(rows), len(cost)))
    for k, (row, _) in enumerate(rows):
        table[k, list(row)] = list(row.values())
    found = milp(
        cost,
        integrality=np.ones(len(cost)),
        bounds=Bounds(*np.array(bounds).T),
        constraints=LinearConstraint(table, np.array([right for _, right in rows]), np.inf),
        options={"time_limit": 10.0},
    )
    if found.x is None and strict:
        return None
    if found.x is None:
        raise _no_levels(given)
    chosen = {name: round(found.x[k]) for name, k in level.items()}
    return Solution(chosen, {pair for pair, k in uppers.items() if round(found.x[k])})


def least_levels(bands: Sequence[Band], axes: Sequence[Axis]) -> dict[str, int]:
    """Lowest level that each name may have."""
    least = {
        band.level: 1 + max(each.below for each in bands if each.level == band.level)
        for band in bands
    }
    for axis in (axis for axis in axes if not axis.ground):
        least |= {link: max(least[link], 1 + axis.under) for link in axis.links}
    return least


def bound_axes(axes: Sequence[Axis], rules: Sequence[Rule]) -> set[str]:
    """Names of axes between two plates that may not be on whichever plate they like: they run in a slot of one, or meet what
    stands on the ground too."""
    met = {
        thing.name
        for rule in rules
        for thing in (rule.a, rule.b)
        if all(isinstance(each, Axis) and (each.far or each.ground) for each in (rule.a, rule.b))
    }
    return {axis.name for axis in axes if axis.far and (axis.runs or axis.name in met)}


def _no_levels(given: Mapping[str, int]) -> Unlaid:
    if not given:
        return Unlaid(
            "levels found",
            0,
            1,
            "",
            "",
            "",
            "no order of levels has all that must lie over others over them",
        )
    remedy = "set what the shaft drives highest on its pivot, and a slot over the link with its pin"
    return Unlaid(
        "levels found",
        0,
        1,
        "",
        "[layers]",
        remedy,
        "no order of levels with those of [layers] is free of collisions",
    )
