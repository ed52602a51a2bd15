"""In which order a machine's equations are solved: who turns with whom, what each equation holds, what goes together.

    group       bodies that slides hold to one angle; one unknown angle, the ground's is none
    unknown     ("angle", group), ("length", slide), ("x", body), ("y", body)
    equation    ("x", joint), ("y", joint): two places coincide; ("s", joint or drive): a relation of scalars
    component   the least set of equations that must be solved together, with as many unknowns: a strong component of the
                matched equations; they come in an order in which each needs only earlier ones

Only who meets whom counts here, and lengths that are 0; special lengths (parallelograms) are the business of the rank.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from graphlib import TopologicalSorter

import numpy as np

from camgen.machine.matching import matching
from camgen.machine.model import (
    GROUND,
    Cam,
    Clutch,
    Drive,
    Gear,
    Joint,
    Law,
    Machine,
    Pin,
    Place,
    Slide,
    Slot,
)

Key = tuple[str, str]
# A lever shorter than this is none, mm.
NO_LEVER = 1e-9


@dataclass(frozen=True)
class Relation:
    """A scalar equation: sum of share * unknown + constant = law(argument + shift); the argument None is theta."""

    name: str
    shares: dict[Key, float]
    constant: float = 0.0
    law: Law | None = None
    argument: Key | None = None
    shift: float = 0.0

    @property
    def unknowns(self) -> set[Key]:
        """All that it relates."""
        return set(self.shares) | ({self.argument} if self.argument else set())


@dataclass(frozen=True)
class Groups:
    """Bodies by their group (named by its first body), and each body's angle in excess of its group's, rad."""

    of: dict[str, str]
    excess: dict[str, float]

    def turned(self, place: Place) -> complex:
        """A place in the axes of its body's group, about the body's origin."""
        excess = self.excess[place.body]
        return place.at * complex(np.exp(1j * excess)) if excess else complex(place.at)


def places(joint: Joint) -> tuple[Place, Place] | None:
    """The two places that a joint brings together: a, b of a pin; guide, runner of a slide or slot."""
    if isinstance(joint, Pin):
        return joint.a, joint.b
    return (joint.guide, joint.runner) if isinstance(joint, Slide | Slot) else None


def group_bodies(machine: Machine) -> Groups:
    """Bodies that slides hold to one angle."""
    of = {body: body for body in (GROUND, *(body.name for body in machine.moving))}
    excess = dict.fromkeys(of, 0.0)
    for joint in machine.joints:
        if not isinstance(joint, Slide):
            continue
        a = joint.guide.body
        b = joint.runner.body
        # angle of b = angle of a + turn: the later group is taken into the earlier one.
        group = of[a]
        other = of[b]
        shift = excess[a] + joint.turn - excess[b]
        if other == GROUND:
            group, other, shift = other, group, -shift
        if group != other:
            for body in [body for body in of if of[body] == other]:
                of[body] = group
                excess[body] = excess[body] + shift
    return Groups(of, excess)


def relations(machine: Machine, groups: Groups) -> list[Relation]:
    """The scalar equations of gears, cams and drives."""
    equations = []
    for each in (*machine.joints, *machine.drives):
        shares: dict[Key, float] = {}
        constant = 0.0

        def add(body: str, factor: float, shares: dict[Key, float] = shares) -> float:
            """Enter a body's angle; what its excess adds."""
            key = ("angle", groups.of[body])
            if groups.of[body] != GROUND:
                shares[key] = shares.get(key, 0.0) + factor
            return factor * groups.excess[body]

        if isinstance(each, Gear):
            constant = (
                add(each.b, 1.0)
                + add(each.a, -each.ratio)
                + add(each.carrier, each.ratio - 1.0)
                - each.phase
            )
            equations.append(Relation(each.name, {k: v for k, v in shares.items() if v}, constant))
        elif isinstance(each, Clutch):
            constant = add(each.b, 1.0)
            equations.append(Relation(each.name, shares, constant, each.law))
        elif isinstance(each, Cam | Drive):
            if each.slide is not None:
                shares["length", each.slide] = 1.0
            else:
                constant += add(each.follower if isinstance(each, Cam) else each.body, 1.0)
            if isinstance(each, Drive):
                equations.append(Relation(each.name, shares, constant, each.law))
                continue
            constant -= each.rest
            turns = groups.of[each.cam]
            argument = None if turns == GROUND else ("angle", turns)
            excess = groups.excess[each.cam]
            if each.over is not None:
                argument = ("length", each.over)
                excess = 0.0
            equations.append(
                Relation(each.name, shares, constant, each.law, argument, excess - each.phase)
            )
    return equations


@dataclass(frozen=True)
class Component:
    """Equations and as many unknowns that are solved together."""

    equations: tuple[Key, ...]
    unknowns: tuple[Key, ...]

    def joints(self) -> tuple[str, ...]:
        """Names of the joints and drives whose equations it holds."""
        return tuple(dict.fromkeys(name for _, name in self.equations))


@dataclass(frozen=True)
class Order:
    """All components in their order; none where equations and unknowns do not match."""

    components: tuple[Component, ...]
    loose: tuple[Key, ...]  # unknowns that nothing decides
    over: tuple[str, ...]  # joints and drives whose equations say more than there is to decide


def holds(machine: Machine, groups: Groups, scalar: Sequence[Relation]) -> dict[Key, set[Key]]:
    """What each equation holds; scalar: those of gears, cams and drives."""
    table: dict[Key, set[Key]] = {}
    for joint in machine.joints:
        both = places(joint)
        if both is None:
            continue
        for axis in ("x", "y"):
            row: set[Key] = set()
            for place in both:
                if place.body == GROUND:
                    continue
                row.add((axis, place.body))
                if abs(place.at) > NO_LEVER and groups.of[place.body] != GROUND:
                    row.add(("angle", groups.of[place.body]))
            if isinstance(joint, Slide | Slot):
                row.add(("length", joint.name))
                if groups.of[joint.guide.body] != GROUND:
                    row.add(("angle", groups.of[joint.guide.body]))
            table[axis, joint.name] = row
    for relation in scalar:
        table["s", relation.name] = relation.unknowns
    return table


def components(machine: Machine, groups: Groups, scalar: Sequence[Relation]) -> Order:
    """The machine's equations, parted into those that are solved together; scalar: those of gears, cams and drives."""
    rows = tuple(
        (equation, tuple(sorted(row))) for equation, row in holds(machine, groups, scalar).items()
    )
    bodies = (
        key
        for body in machine.moving  # what no equation names is loose
        for key in (("x", body.name), ("y", body.name), ("angle", groups.of[body.name]))
        if key[1] != GROUND
    )
    return _ordered(rows, tuple(bodies))


@lru_cache(maxsize=64)  # variants of a machine differ in lengths alone
def _ordered(rows: tuple[tuple[Key, tuple[Key, ...]], ...], bodies: tuple[Key, ...]) -> Order:
    """Equations by what each holds, and the unknowns of bodies, parted."""
    table = dict(rows)
    unknowns = dict.fromkeys(key for row in table.values() for key in row)
    unknowns |= dict.fromkeys(bodies)
    owner = matching(table)  # the equation that each unknown is solved from
    unknown_of = {equation: key for key, equation in owner.items()}
    free = [key for key in unknowns if key not in owner]
    spare = [equation for equation in table if equation not in unknown_of]
    if free or spare:
        holders: dict[Key, list[Key]] = {key: [] for key in unknowns}
        for equation, row in table.items():
            for key in row:
                holders[key].append(equation)
        # loose: unknowns that can move, those left over and those whose equations need them instead; over: likewise
        loose = _reach(
            free,
            lambda key: [
                unknown_of[equation] for equation in holders[key] if equation in unknown_of
            ],
        )
        over = _reach(
            spare, lambda equation: [owner[key] for key in table[equation] if key in owner]
        )
        return Order((), tuple(loose), tuple(dict.fromkeys(name for _, name in over)))
    needs = {equation: [owner[key] for key in row] for equation, row in table.items()}
    reach = {equation: set(_reach([equation], needs.__getitem__)) for equation in table}
    first: dict[Key, Key] = {}  # of the equations that need each other
    for equation in table:
        first.setdefault(equation, equation)
        for other in reach[equation]:
            if equation in reach[other]:
                first.setdefault(other, first[equation])
    sorter: TopologicalSorter[Key] = TopologicalSorter(
        {equation: () for equation in table if first[equation] == equation}
    )
    for equation, others in needs.items():
        for other in others:
            if first[other] != first[equation]:
                sorter.add(first[equation], first[other])
    inside: dict[Key, list[Key]] = {}
    for equation in table:
        inside.setdefault(first[equation], []).append(equation)
    blocks = [inside[which] for which in sorter.static_order()]
    return Order(
        tuple(
            Component(tuple(block), tuple(unknown_of[equation] for equation in block))
            for block in blocks
        ),
        (),
        (),
    )


def _reach(start: Iterable[Key], step: Callable[[Key], Iterable[Key]]) -> list[Key]:
    """All that can be reached, the start included, in order."""
    reached = dict.fromkeys(start)
    queue = list(reached)
    for node in queue:
        for neighbour in step(node):
            if neighbour not in reached:
                reached[neighbour] = None
                queue.append(neighbour)
    return queue
