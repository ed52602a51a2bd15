"""The assembly as written, moved through a whole turn: which bodies come how near to each other, proven between samples.

What may touch follows from how the machine is made: bodies that do not move as they see each other are fixed together; a
joint's parts have their fit; a tip rolls on its cam; parts that pass by each other may graze.
"""

from __future__ import annotations

import cmath
import itertools
import math
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from camgen.errors import counted
from camgen.files.threemf import Item, Package, read_3mf
from camgen.findings import Finding, at_least, at_most, in_file
from camgen.geometry.rings import Floats, Points, Ring
from camgen.judge.interference import Pair, interference, swept
from camgen.judge.slabs import Body, Course, Slab, slabs_of
from camgen.machine.features import (
    CamOutline,
    Courses,
    GearTeeth,
    Passing,
    PinEyes,
    SlideFaces,
    StandIn,
    Steady,
    SweptMachine,
)
from camgen.machine.model import Pose

_SHOWN = 24  # rows of the list: pairs that move past each other, the nearest first
COLUMNS = ("pair", "meant to", "least gap seen, mm", "proven, mm", "at, deg")

Row = tuple[str, str, float, float, float]
_PRESSED = 0.01  # mm, overlap of bodies that are fixed together which still counts as touching
_ROLLING = 0.08  # mm, the same of tip and cam, or of teeth, on the way round; how they touch is judged far more finely
_NOTHING = 1e-6  # mm^3, less than any part has
_SHARE = 0.05  # of the gap to be kept, to which gaps are found
_FINEST = 0.001  # mm, and no finer than this
_ENDS: Points = np.array([1.0 + 0j, -1.0])  # of a disc's two half circles
_BAR = np.array([0.0, 1.0, 0.0, 1.0])  # bulges of a bar's sides and ends


def standing(package: Package, machine: SweptMachine) -> Iterator[tuple[str, Item, str]]:
    """Of an assembly's file each copy, with its name and the body that it stands on; one too many is left out."""
    stands, number = defaultdict[str, list[str]](list), Counter[str]()
    for mount in machine.mounts:
        stands[mount.part].append(mount.body)
    for item in package.items:
        number[item.name] += 1
        if number[item.name] <= len(stands[item.name]):
            yield f"{item.name}-{number[item.name]}", item, stands[item.name][number[item.name] - 1]


def sweep(path: Path, machine: SweptMachine) -> tuple[list[Finding], list[Row]]:
    """Read an assembly file, set it in motion: INTERFERENCE findings, and rows (COLUMNS) of moving pairs that come nearest.

    The file shows theta = 0. A file that does not hold just the copies of the machine is a ROUND_TRIP that fails.
    """
    package, where = read_3mf(path), in_file(path)
    wanted = Counter(mount.part for mount in machine.mounts)
    found = Counter(item.name for item in package.items)
    missing = sum(((wanted - found) + (found - wanted)).values())
    said = f"{counted(sum(wanted.values()), 'copy', 'copies')} of {counted(len(wanted), 'part')} in place"
    copies = at_most("ROUND_TRIP", missing, 0, "copies", where, said)
    if missing:
        return [copies], []
    bodies, spare = [], 4 * machine.tolerance
    parts: dict[str, str] = {}  # of each body; of a stand-in itself
    poses, start = _remembered(machine.courses), machine.courses(np.zeros(1))
    courses = {name: _course(poses, name, float(pose.angle[0])) for name, pose in start.items()}
    home = {name: -complex(pose.place[0]) for name, pose in start.items()}
    try:
        for name, item, on in standing(package, machine):
            bodies.append(Body(name, slabs_of(item.placed), courses[on], at=home[on]))
            parts[name] = item.name
            if not abs(item.mesh.volume) > _NOTHING:
                raise ValueError(f"{name} has no volume")
        for thing in machine.stand_ins:
            parts[thing.name] = thing.name
            bodies.append(
                Body(
                    thing.name,
                    _slabs(thing, float(start[thing.body].angle[0])),
                    courses[thing.body],
                )
            )
        clearances = swept(
            bodies,
            _touching(machine, parts, spare),
            machine.gap,
            resolution=max(_SHARE * machine.gap, _FINEST),
            mounted=_PRESSED + spare,
        )
        ends = _wholes(machine)
        clearances = [c for c in clearances if {c.a, c.b} not in ends]
    except ValueError as error:  # a section that does not close, a motion that jumps
        return [
            copies,
            at_least(
                "INTERFERENCE", math.nan, machine.gap, "mm", where, f"cannot be judged: {error}"
            ),
        ], []
    findings = [copies, *interference(clearances, machine.gap, machine.angle)]
    ordered = sorted((c for c in clearances if not c.at_rest), key=lambda c: c.gap)
    rows = [
        (
            f"{c.a}, {c.b}",
            "touch" if c.allowed is not None else "apart",
            c.gap,
            c.proven,
            math.degrees(c.theta),
        )
        for c in ordered[:_SHOWN]
    ]
    return findings, rows


def _wholes(machine: SweptMachine) -> list[set[str]]:
    """Pairs of stand-ins that are two ends of one thing, as of a spring: they always overlap, which says nothing."""
    things = [thing for thing in machine.stand_ins if thing.whole]
    return [{a.name, b.name} for a, b in itertools.combinations(things, 2) if a.whole == b.whole]


def _touching(machine: SweptMachine, parts: Mapping[str, str], spare: float) -> dict[Pair, float]:
    """Pairs of bodies that touch by intent as they move, and the overlap that this may show, mm; parts: that they are."""
    if not machine.gap > 0:  # no air is asked for: all may graze
        fits = {frozenset(pair): spare for pair in itertools.combinations(parts, 2)}
    else:
        fits = {}
    for a, b, overlap in _fits(machine, spare):
        ones, others = ([name for name, part in parts.items() if part == each] for each in (a, b))
        for one, other in itertools.product(ones, others):
            fits[frozenset((one, other))] = overlap
    return fits


def _fits(machine: SweptMachine, spare: float) -> Iterator[tuple[str, str, float]]:
    """Parts and stand-ins that touch by intent, with the overlap that may show: fits that leave less air than `gap`, tips."""
    tips = [thing.name for thing in machine.stand_ins if thing.rolls]
    for piece, rest in itertools.combinations(
        [thing for thing in machine.stand_ins if thing.whole], 2
    ):
        if piece.whole == rest.whole:
            yield (
                piece.name,
                rest.name,
                2 * max(radius for *_, radius, _, _ in (*piece.bars, *rest.bars)) + spare,
            )
    for contact in machine.contacts:
        match contact:
            case CamOutline(part=part, own=own, free=air):
                made = contact.roller or contact.tip.part
                rolling = (
                    [own.part]
                    if own is not None and own.radius is None
                    else [made]
                    if made
                    else tips
                )
                yield from ((tip, part, _ROLLING + spare + max(0.0, -air)) for tip in rolling)
            case GearTeeth(
                a=wheel, b=mate
            ):  # their play is measured far more finely at the pitch circle
                yield wheel.part, mate.part, _ROLLING + spare
            case PinEyes(a=a, b=b, pin=pin, rings=rings):
                yield from (
                    (ring.part, pin.part, spare) for ring in rings if pin is not None and pin.part
                )
                for one, other in itertools.combinations(
                    [eye for eye in (a, b, pin) if eye is not None], 2
                ):
                    air = (one.diameter - other.diameter) / 2 * (-1 if one.shaft else 1)
                    if (
                        one.part
                        and other.part
                        and one.shaft is not other.shaft
                        and air <= machine.gap + spare / 2
                    ):
                        yield one.part, other.part, max(0.0, -2 * air) + spare
            case Steady(far=far, pin=pin) if far.part and pin is not None and pin.part:
                if (far.diameter - pin.diameter) / 2 <= machine.gap + spare / 2:
                    yield pin.part, far.part, max(0.0, pin.diameter - far.diameter) + spare
            case SlideFaces(rails=rails, runner=runner) if (
                rails.width - runner.width
            ) / 2 <= machine.gap + spare / 2:
                yield runner.part, rails.part, spare
            case Passing(a=a, b=b) if contact.gap <= machine.gap + spare / 2:
                yield a, b, spare


def _remembered(courses: Courses) -> Courses:
    """The same, without asking again for angles that were the last ones."""
    last: dict[bytes, Mapping[str, Pose]] = {}

    def remembered(theta: Floats) -> Mapping[str, Pose]:
        key = theta.tobytes()
        if key not in last:
            if len(last) > 1:
                del last[next(reversed(last))]  # the grid, which came first, stays
            last[key] = courses(theta)
        return last[key]

    return remembered


def _course(courses: Courses, body: str, start: float) -> Course:
    """The motion of a body from where it is turned at theta = 0, rad, as the file shows it."""

    def course(theta: Floats) -> tuple[Floats, Points]:
        pose = courses(theta)[body]
        return pose.angle - start, pose.place

    return course


def _slabs(thing: StandIn, turned: float) -> tuple[Slab, ...]:
    """Discs and bars as slabs, on a body that is turned by so much at theta = 0, rad."""
    turn, slabs = cmath.exp(1j * turned), dict[tuple[float, float], list[Ring]]()
    for at, radius, z0, z1 in thing.discs:
        slabs.setdefault((z0, z1), []).append(
            Ring(np.asarray(turn * (at + radius * _ENDS), complex), np.ones(2))
        )
    for a, b, radius, z0, z1 in thing.bars:
        side = 1j * radius * (b - a) / abs(b - a)
        slabs.setdefault((z0, z1), []).append(
            Ring(turn * np.array([a - side, b - side, b + side, a + side]), _BAR)
        )
    return tuple(Slab(z0, z1, tuple(rings)) for (z0, z1), rings in slabs.items())
