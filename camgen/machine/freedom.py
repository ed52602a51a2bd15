"""How many freedoms a machine has, by counting and by rank, and what to say where it is loose or locked.

    count    3 n - 2 j1 - j2: n moving bodies, j1 pins and slides, j2 slots, gears and cams   [Gruebler]
    rank     of the conditions' Jacobian at a general position, the drives' among them: special lengths (parallelograms, two
             equal cranks, rings of slides) move or lock against the count, and only the rank tells
    loose    bodies that still move with every drive held: they lie in the Jacobian's null space
    bound    joints and drives that repeat or contradict each other: they lie in the null space of its transpose

`drawn` closes a rough drawing: lengths stay exact, poses change as little as they can.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from camgen.errors import DesignError
from camgen.machine.closure import System
from camgen.machine.model import Drive, Floats, Machine, Pin, Pose, Slide

# A singular value below this share of the largest is none.
NO_VALUE = 1e-8
# What a body or joint takes part with in a null space, of the largest, that counts.
TAKES_PART = 1e-6
# How far a machine is moved from the drawn position to a general one, of its size.
AWAY = 0.05
# A drawing closes when its gaps are below this share of its size.
CLOSED = 1e-12
# Bodies that a message names.
NAMED = 10
# Steps of Newton's method on a rough drawing, and the longest of them: share of the size, rad.
STEPS, LONGEST = 200, 0.3


@dataclass(frozen=True)
class Freedom:
    """A machine's freedoms: count by Gruebler without the drives; moves: freedoms by rank with all drives held.

    spare: conditions that repeat or contradict others. loose: bodies that move. bound: joints and drives of the spare ones.
    """

    bodies: int
    pairs: int
    half_pairs: int
    drives: int
    count: int
    moves: int
    spare: int
    loose: tuple[str, ...]
    bound: tuple[str, ...]


def freedoms(machine: Machine) -> Freedom:
    """Count and rank; the machine must be closed as drawn (see `drawn`)."""
    system = System(machine)
    pairs = sum(isinstance(joint, Pin | Slide) for joint in machine.joints)
    half = len(machine.joints) - pairs
    best = _values(system, system.start)
    for q in _elsewhere(system):
        other = _values(system, q)
        if other[1] > best[1]:
            best = other
    (left, _, right), rank = best
    names = [body.name for body in machine.moving]
    loose = np.abs(right[rank:]).max(axis=0, initial=0).reshape(-1, 3).max(axis=1, initial=0)
    bound = np.abs(left[:, rank:]).max(axis=1, initial=0)
    within = [each.name for each in system.conditions if bound[system.rows[each.name]].max(initial=0) > TAKES_PART]
    return Freedom(
        len(names), pairs, half, len(machine.drives),
        3 * len(names) - 2 * pairs - half, system.width - rank, system.height - rank,
        tuple(name for name, part in zip(names, loose, strict=True) if part > TAKES_PART), tuple(within),
    )  # fmt: skip


def refuse_unsound(machine: Machine) -> Freedom:
    """The freedoms of a sound machine; raises DesignError that names what is loose, driven twice or locked."""
    found = freedoms(machine)
    tally = f"3 x {found.bodies} - 2 x {found.pairs} - {found.half_pairs} = {found.count} freedoms, {found.drives} driven"
    if found.spare:
        second = [drive.name for drive in machine.drives if drive.name in found.bound and _needless(machine, drive)]
        where = f"joints {', '.join(found.bound)} ({tally})"
        if second and found.drives > 1:
            raise DesignError("number of drives", found.drives, found.drives - found.spare, "", where,
                              f"take away one of the drives {', '.join(second)}")  # fmt: skip
        if second:
            raise DesignError("freedoms to drive", 0, 1, "", where, "this chain is rigid: take away a joint or a link")
        raise DesignError("conditions too many", found.spare, 0, "", where,
                          "this loop is over-constrained: take away a link, or make one of its pins a slot")  # fmt: skip
    if found.moves:
        remedy = "join it to another body, or drive it" if len(found.loose) == 1 else "drive one of them, or join them"
        more = f" and {len(found.loose) - NAMED} more" if len(found.loose) > NAMED else ""
        raise DesignError("freedoms left", found.moves, 0, "", f"{', '.join(found.loose[:NAMED])}{more} ({tally})", remedy)
    return found


def _needless(machine: Machine, drive: Drive) -> bool:
    """Whether a drive decides nothing that the rest does not decide already."""
    without = replace(machine, drives=tuple(each for each in machine.drives if each is not drive))
    return freedoms(without).moves == freedoms(machine).moves


def _values(system: System, q: Floats) -> tuple[tuple[Floats, Floats, Floats], int]:
    """Singular values of the Jacobian, its columns and rows brought to one size, and its rank."""
    slope = system.evaluate(q[None], np.zeros(1))[1][0] * system.unit
    size = np.linalg.norm(slope, axis=1, keepdims=True)
    left, values, right = np.linalg.svd(slope / np.where(size > 0, size, 1.0))
    return (left, values, right), int(np.count_nonzero(values > NO_VALUE * values.max(initial=1e-300)))


def _elsewhere(system: System) -> list[Floats]:
    """Poses a little way from the drawn ones, the drives let go."""
    still = System(replace(system.machine, drives=()))
    found = []
    for share in (AWAY, -0.7 * AWAY):
        (_, _, right), rank = _values(still, still.start)
        if rank == still.width:
            continue
        ways = right[rank:] * np.sqrt(np.arange(1, still.width - rank + 1))[:, None]
        q, gap = _closest(still, still.start + share * still.unit * ways.sum(axis=0))
        if gap <= 1e3 * CLOSED * still.size:
            found.append(q)
    return found


def _closest(system: System, q: Floats) -> tuple[Floats, float]:
    """Poses that close the conditions at theta = 0 with the least change, and the gap that is left."""
    theta = np.zeros(1)
    best = (q, np.inf)
    for _ in range(STEPS):
        misfit, slopes, _ = system.evaluate(q[None], theta)
        gap = float(np.abs(misfit).max(initial=0))
        if gap < best[1]:
            best = (q, gap)
        elif best[1] <= CLOSED * system.size:
            break
        step = np.linalg.pinv(slopes[0] * system.unit, rcond=1e-10) @ misfit[0]
        q = q - system.unit * step * min(1.0, LONGEST / max(float(np.abs(step).max(initial=0)), 1e-300))
    return best


def drawn(machine: Machine) -> Machine:
    """The machine with start poses that close it at theta = 0, as near to the given ones as may be.

    Raises DesignError where the lengths contradict each other: by how much the joints stay open, and which.
    """
    system = System(machine)
    q, gap = _closest(system, system.start)
    if gap > CLOSED * system.size:
        misfit = np.abs(system.evaluate(q[None], np.zeros(1))[0][0])
        open_ = [each.name for each in system.conditions if misfit[system.rows[each.name]].max() > 0.01 * misfit.max()]
        raise DesignError(
            "gap of the joints as drawn", gap, 0, "mm", f"joints {', '.join(open_)}",
            "change the lengths of the links in this loop, or draw their points nearer to where they meet",
        )  # fmt: skip
    rows = q.reshape(-1, 3)
    start = {body: Pose(complex(x, y), float(angle)) for body, (x, y, angle) in zip(system.bodies, rows, strict=True)}
    return replace(machine, start=start)
