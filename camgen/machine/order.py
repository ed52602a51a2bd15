"""In which order a machine's equations are solved: who turns with whom, what each equation holds, blocks one by one.

    group       bodies that slides hold to one angle; one unknown angle, the ground's is none
    unknown     ("angle", group), ("length", slide), ("x", body), ("y", body)
    equation    ("x", joint), ("y", joint): two places coincide; ("s", joint or drive): a relation of scalars
    block       the least set of equations that must be solved together, with as many unknowns: a strong component of the
                matched equations; blocks come in an order in which each needs only earlier ones

Only who meets whom counts here, and lengths that are 0; special lengths (parallelograms) are the business of the rank.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from graphlib import TopologicalSorter

import numpy as np

from camgen.machine.model import GROUND, Cam, Drive, Gear, Joint, Law, Machine, Pin, Place, Slide, Slot

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


def joined_bodies(joint: Joint | Drive) -> tuple[str, ...]:
    """The bodies that a joint holds."""
    if isinstance(joint, Drive):
        return (joint.body,)
    if isinstance(joint, Gear):
        return (joint.a, joint.b, joint.carrier)
    if isinstance(joint, Cam):
        return (joint.cam, joint.follower)
    both = places(joint)
    assert both is not None
    return both[0].body, both[1].body


def group_bodies(machine: Machine) -> Groups:
    """Bodies that slides hold to one angle."""
    of = {body: body for body in (GROUND, *(body.name for body in machine.moving))}
    excess = dict.fromkeys(of, 0.0)
    for joint in machine.joints:
        if not isinstance(joint, Slide):
            continue
        a, b = joint.guide.body, joint.runner.body
        # angle of b = angle of a + turn: the later group is taken into the earlier one.
        here, there, shift = of[a], of[b], excess[a] + joint.turn - excess[b]
        if there == GROUND:
            here, there, shift = there, here, -shift
        if here != there:
            for body in [body for body in of if of[body] == there]:
                of[body], excess[body] = here, excess[body] + shift
    return Groups(of, excess)


def relations(machine: Machine, groups: Groups) -> list[Relation]:
    """The scalar equations of gears, cams and drives."""
    found = []
    for each in (*machine.joints, *machine.drives):
        shares: dict[Key, float] = {}
        constant = 0.0

        def add(body: str, share: float, shares: dict[Key, float] = shares) -> float:
            """Enter a body's angle; what its excess adds."""
            key = ("angle", groups.of[body])
            if groups.of[body] != GROUND:
                shares[key] = shares.get(key, 0.0) + share
            return share * groups.excess[body]

        if isinstance(each, Gear):
            constant = add(each.b, 1.0) + add(each.a, -each.ratio) + add(each.carrier, each.ratio - 1.0) - each.phase
            found.append(Relation(each.name, {k: v for k, v in shares.items() if v}, constant))
        elif isinstance(each, Cam | Drive):
            if each.slide is not None:
                shares["length", each.slide] = 1.0
            else:
                constant += add(each.follower if isinstance(each, Cam) else each.body, 1.0)
            if isinstance(each, Drive):
                found.append(Relation(each.name, shares, constant, each.law))
                continue
            constant -= each.rest
            turns = groups.of[each.cam]
            argument = None if turns == GROUND else ("angle", turns)
            found.append(
                Relation(each.name, shares, constant, each.law, argument, groups.excess[each.cam] - each.phase)
            )
    return found


@dataclass(frozen=True)
class Block:
    """Equations and as many unknowns that are solved together."""

    equations: tuple[Key, ...]
    unknowns: tuple[Key, ...]

    def joints(self) -> tuple[str, ...]:
        """Names of the joints and drives whose equations it holds."""
        return tuple(dict.fromkeys(name for _, name in self.equations))


@dataclass(frozen=True)
class Order:
    """All blocks in their order; what is left over where equations and unknowns do not match.

    loose: unknowns that nothing decides; over: joints and drives whose equations say more than there is to decide.
    """

    blocks: tuple[Block, ...]
    loose: tuple[Key, ...]
    over: tuple[str, ...]


def holds(machine: Machine, groups: Groups) -> dict[Key, set[Key]]:
    """What each equation holds."""
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
    for relation in relations(machine, groups):
        table["s", relation.name] = relation.unknowns
    return table


def order(machine: Machine, groups: Groups) -> Order:
    """The machine's equations in blocks."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components, maximum_bipartite_matching

    table = holds(machine, groups)
    equations = list(table)
    unknowns = list(dict.fromkeys(key for row in table.values() for key in sorted(row)))
    for body in machine.moving:  # what no equation names is loose
        for key in (("x", body.name), ("y", body.name), ("angle", groups.of[body.name])):
            if key not in unknowns and key[1] != GROUND:
                unknowns.append(key)
    number = {key: k for k, key in enumerate(unknowns)}
    pairs = [(i, number[key]) for i, equation in enumerate(equations) for key in table[equation]]
    rows, columns = np.array(pairs, int).reshape(-1, 2).T
    graph = csr_array((np.ones(len(pairs)), (rows, columns)), shape=(len(equations), len(unknowns)))
    matched = maximum_bipartite_matching(graph, perm_type="column")  # unknown of each equation, -1 for none
    owner = {int(k): i for i, k in enumerate(matched) if k >= 0}

    free = [k for k in range(len(unknowns)) if k not in owner]
    spare = [i for i in range(len(equations)) if matched[i] < 0]
    if free or spare:
        return Order((), _loose(free, graph, matched, unknowns), _over(spare, graph, owner, equations))
    needs = [(i, owner[k]) for i, k in pairs if owner[k] != i]
    r, c = np.array(needs, int).reshape(-1, 2).T
    web = csr_array((np.ones(len(needs)), (r, c)), shape=(len(equations),) * 2)
    _, label = connected_components(web, directed=True, connection="strong")
    sorter: TopologicalSorter[int] = TopologicalSorter({int(k): set() for k in label})
    for i, j in needs:
        if label[i] != label[j]:
            sorter.add(int(label[i]), int(label[j]))
    blocks = []
    for which in sorter.static_order():
        inside = [i for i in range(len(equations)) if label[i] == which]
        blocks.append(Block(tuple(equations[i] for i in inside), tuple(unknowns[matched[i]] for i in inside)))
    return Order(tuple(blocks), (), ())


def _reached(start: Iterable[int], step: Callable[[int], Iterable[int]]) -> list[int]:
    """All that can be reached, the start included, in order."""
    found = list(start)
    for here in found:
        found += [there for there in dict.fromkeys(step(here)) if there not in found]
    return found


def _loose(free: list[int], graph: object, matched: object, unknowns: list[Key]) -> tuple[Key, ...]:
    """Unknowns that can move: those left over, and those whose equations need them instead."""
    by_unknown = graph.tocsc()  # type: ignore[attr-defined]

    def step(k: int) -> list[int]:
        rows = by_unknown.indices[by_unknown.indptr[k] : by_unknown.indptr[k + 1]]
        return [int(matched[i]) for i in rows if matched[i] >= 0]  # type: ignore[index]

    return tuple(unknowns[k] for k in _reached(free, step))


def _over(spare: list[int], graph: object, owner: dict[int, int], equations: list[Key]) -> tuple[str, ...]:
    """Joints and drives that contradict or repeat each other: those left over, and those that hold the same unknowns."""

    def step(i: int) -> list[int]:
        columns = graph.indices[graph.indptr[i] : graph.indptr[i + 1]]  # type: ignore[attr-defined]
        return [owner[int(k)] for k in columns if int(k) in owner]

    return tuple(dict.fromkeys(equations[i][1] for i in _reached(spare, step)))
