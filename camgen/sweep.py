"""The assembly as written, moved through a whole turn: which bodies come how near to each other, proven between samples."""

from __future__ import annotations

import math
from collections import Counter
from pathlib import Path

import numpy as np

from camgen.findings import Finding, at_most
from camgen.interference import Body, Course, Slab, interference, sampled_rate, slabs_of, swept
from camgen.mechanism import Assembly, Drive, StandIn
from camgen.readback import read_3mf
from camgen.rings import Floats, Points, Ring

_SHOWN = 24  # rows of the list: pairs that move past each other, the nearest first
COLUMNS = ("pair", "meant to", "least gap seen, mm", "proven, mm", "at, deg")

Row = tuple[str, str, float, float, float]
_SHARE = 0.05  # of the gap to be kept, to which gaps are found
_ENDS: Points = np.array([1.0 + 0j, -1.0])  # of a disc's two half circles


def sweep(path: Path, assembly: Assembly) -> tuple[list[Finding], list[Row]]:
    """Read an assembly file, set it in motion: INTERFERENCE findings, and rows (COLUMNS) of moving pairs that come nearest.

    The file shows theta = 0. A file that does not hold just the copies of the assembly is a ROUND_TRIP that fails.
    """
    package, where = read_3mf(path), path.name
    wanted = Counter(mount.part for mount in assembly.mounts)
    found = Counter(item.name for item in package.items)
    missing = sum(((wanted - found) + (found - wanted)).values())
    copies = at_most("ROUND_TRIP", missing, 0, "copies", where, f"{sum(wanted.values())} copies of {len(wanted)} parts in place")
    if missing:
        return [copies], []
    courses: dict[str, Course] = {}
    for drive in [*(mount.drive for mount in assembly.mounts), *(thing.drive for thing in assembly.stand_ins)]:
        if drive.name not in courses:
            courses[drive.name] = _course(drive)
    bodies, numbers = [], Counter[str]()
    queues = {part: [mount for mount in assembly.mounts if mount.part == part] for part in wanted}
    for item in package.items:
        mount = queues[item.name][numbers[item.name]]
        numbers[item.name] += 1
        bodies.append(
            Body(f"{item.name}-{numbers[item.name]}", slabs_of(item.placed), courses[mount.drive.name], at=-mount.drive.centre)
        )
    bodies += [Body(s.name, _slabs(s), courses[s.drive.name]) for s in assembly.stand_ins]
    present = {body.name for body in bodies}
    touching = {pair: overlap for pair, overlap in assembly.touching.items() if pair <= present}
    clearances = swept(bodies, touching, assembly.gap, resolution=_SHARE * assembly.gap)
    findings = [copies, *interference(clearances, assembly.gap)]
    course = {body.name: body.course for body in bodies}
    ordered = sorted((c for c in clearances if course[c.a] is not course[c.b]), key=lambda c: c.gap)
    rows = [
        (f"{c.a}, {c.b}", "touch" if c.allowed is not None else "apart", c.gap, c.proven, math.degrees(c.theta))
        for c in ordered[:_SHOWN]
    ]
    return findings, rows


def _course(drive: Drive) -> Course:
    """The drive's motion from its place at theta = 0, where the file shows it."""
    start, centre = float(drive.angle(np.zeros(1))[0]), drive.centre

    def angle(theta: Floats) -> Floats:
        return drive.angle(theta) - start

    def position(theta: Floats) -> Points:
        return np.full(theta.shape, centre)

    return Course(angle, position, sampled_rate(angle), 0.0)


def _slabs(thing: StandIn) -> tuple[Slab, ...]:
    """Discs as slabs, on the drive's own frame turned to theta = 0."""
    turn = complex(np.exp(1j * thing.drive.angle(np.zeros(1))[0]))
    spans = dict.fromkeys((z0, z1) for _, _, z0, z1 in thing.discs)
    return tuple(
        Slab(z0, z1, tuple(Ring(np.asarray(turn * at + radius * _ENDS, complex), np.ones(2)) for at, radius, *span in thing.discs
                           if tuple(span) == (z0, z1)))
        for z0, z1 in spans
    )  # fmt: skip
