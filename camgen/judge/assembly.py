"""The assembly as written, moved through a whole turn: which bodies come how near to each other, proven between samples.

What may touch follows from how the machine is made: bodies that do not move as they see each other are fixed together; a
joint's parts have their fit; a tip rolls on its cam; parts that pass by each other may graze.
"""

from __future__ import annotations

import cmath
import itertools
import math
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from camgen.errors import counted
from camgen.files.threemf import Item, Package, read_3mf
from camgen.findings import Finding, at_least, at_most, in_file
from camgen.geometry.rings import Floats, Points, Ring
from camgen.judge.interference import GRID, Clearance, Pair, interference, sweep_clearances
from camgen.judge.slabs import Body, Course, Slab, slabs_of
from camgen.machine.features import (
    CamOutline,
    Courses,
    EdgePair,
    GearTeeth,
    Passing,
    PinEyes,
    SlideFaces,
    StandIn,
    Steady,
    SweptMachine,
)
from camgen.machine.model import Pose

_SHOWN = 24  # rows of the list
COLUMNS = ("pair", "intended", "least gap seen, mm", "proven, mm", "at")

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
    stands = defaultdict[str, list[str]](list)
    number = Counter[str]()
    for mount in machine.mounts:
        stands[mount.part].append(mount.body)
    for item in package.items:
        number[item.name] += 1
        if number[item.name] <= len(stands[item.name]):
            yield f"{item.name}-{number[item.name]}", item, stands[item.name][number[item.name] - 1]


def complete(path: Path, package: Package, machine: SweptMachine) -> Finding:
    """COPIES: how many copies of the machine an assembly's file lacks or has too many."""
    mounts = Counter(mount.part for mount in machine.mounts)
    there = Counter(item.name for item in package.items)
    missing = sum(((mounts - there) + (there - mounts)).values())
    remark = f"{counted(sum(mounts.values()), 'copy', 'copies')} of {counted(len(mounts), 'part')} in place"
    return at_most("COPIES", missing, 0, "copies", in_file(path), remark)


def sweep(path: Path, machine: SweptMachine) -> tuple[list[Finding], list[Row]]:
    """Read an assembly file, set it in motion: INTERFERENCE findings, and rows (COLUMNS) of moving pairs that come nearest.

    The file shows theta = 0. A file that does not hold just the copies of the machine fails COPIES.
    """
    package = read_3mf(path)
    where = in_file(path)
    finding = complete(path, package, machine)
    if not finding.ok:
        return [finding], []
    bodies = []
    spare = 4 * machine.tolerance
    parts: dict[str, str] = {}  # of each body; of a stand-in itself
    poses = _remembered(machine.courses)
    start = machine.courses(np.zeros(1))
    courses = {name: _course(poses, name, float(pose.angle[0])) for name, pose in start.items()}
    home = {name: -complex(pose.place[0]) for name, pose in start.items()}
    try:
        for name, item, on in standing(package, machine):
            bodies.append(Body(name, slabs_of(item.placed), courses[on], at=home[on]))
            parts[name] = item.name
            if not abs(item.mesh.volume) > _NOTHING:
                raise ValueError(f"{name} has no volume")
        for stand_in in machine.stand_ins:
            parts[stand_in.name] = stand_in.name
            bodies.append(
                Body(
                    stand_in.name,
                    _slabs(stand_in, float(start[stand_in.body].angle[0])),
                    courses[stand_in.body],
                )
            )
        clearances = sweep_clearances(
            bodies,
            _touching(machine, parts, spare),
            machine.gap,
            turn=(0.0, math.tau * machine.turns),
            resolution=max(_SHARE * machine.gap, _FINEST),
            mounted=_PRESSED + spare,
        )
        pieces = [{a.name, b.name} for a, b in _pieces(machine)]
        clearances = [
            replace(c, theta=float(machine.drive(np.array([c.theta]))[0]))
            for c in clearances
            if {c.a, c.b} not in pieces
        ]
    except ValueError as error:  # a section that does not close, a motion that jumps
        return [
            finding,
            at_least(
                "INTERFERENCE", math.nan, machine.gap, "mm", where, f"cannot be judged: {error}"
            ),
        ], []
    findings = [finding, *interference(clearances, machine.gap, machine.angle, machine.turns)]
    return findings, nearest(clearances)


def nearest(clearances: Sequence[Clearance]) -> list[Row]:
    """Pairs that move past each other, the nearest first."""
    ordered = sorted((c for c in clearances if not c.at_rest), key=lambda c: c.gap)
    return [
        (
            f"{c.a}, {c.b}",
            "touch" if c.allowed is not None else "apart",
            c.gap,
            c.proven,
            math.degrees(c.theta),
        )
        for c in ordered[:_SHOWN]
    ]


def _pieces(machine: SweptMachine) -> list[tuple[StandIn, StandIn]]:
    """Pairs of stand-ins that are two pieces of one thing, as of a spring: they always overlap, which says nothing."""
    things = [each for each in machine.stand_ins if each.whole]
    return [(a, b) for a, b in itertools.combinations(things, 2) if a.whole == b.whole]


def _touching(machine: SweptMachine, parts: Mapping[str, str], spare: float) -> dict[Pair, float]:
    """Pairs of bodies that touch by intent as they move, and the overlap that this may show, mm; parts: that they are."""
    if not machine.gap > 0:  # no air is asked for: all may graze
        fits = {frozenset(pair): spare for pair in itertools.combinations(parts, 2)}
    else:
        fits = {}
    for a, b, overlap in _fits(machine, spare):
        ones, others = ([name for name, part in parts.items() if part == each] for each in (a, b))
        for first, second in itertools.product(ones, others):
            fits[frozenset((first, second))] = overlap
    return fits


def _fits(machine: SweptMachine, spare: float) -> Iterator[tuple[str, str, float]]:
    """Parts and stand-ins that touch by intent, with the overlap that may show: fits that leave less air than `gap`, tips."""
    tips = [each.name for each in machine.stand_ins if each.rolls]
    for piece, rest in _pieces(machine):
        overlap = 2 * max(bar[2] for bar in (*piece.bars, *rest.bars))
        yield piece.name, rest.name, overlap + spare
    for contact in machine.contacts:
        match contact:
            case CamOutline():
                yield from _tip_fits(contact, tips, spare)
            case GearTeeth(
                a=wheel, b=mate
            ):  # their play is measured far more finely at the pitch circle
                yield wheel.part, mate.part, _ROLLING + spare
            case EdgePair(a=drivers, b=driven):
                pairs = itertools.product(drivers, driven)
                yield from ((one.part, other.part, _ROLLING + spare) for one, other in pairs)
            case PinEyes():
                yield from _pin_fits(contact, machine.gap, spare)
            case Steady(far=far, pin=pin) if far.part and pin is not None and pin.part:
                if (far.diameter - pin.diameter) / 2 <= machine.gap + spare / 2:
                    yield pin.part, far.part, max(0.0, pin.diameter - far.diameter) + spare
            case SlideFaces(rails=rails, runner=runner) if (
                rails.width - runner.width
            ) / 2 <= machine.gap + spare / 2:
                yield runner.part, rails.part, spare
            case Passing(a=a, b=b) if contact.gap <= machine.gap + spare / 2:
                yield a, b, spare


def _tip_fits(
    feature: CamOutline, tips: Sequence[str], spare: float
) -> Iterator[tuple[str, str, float]]:
    """What rolls on a cam, and the cam; tips: stand-ins, where no part does."""
    own = feature.own
    roller = feature.roller or feature.tip.part
    if own is not None and own.radius is None:
        roller = own.part
    for tip in [roller] if roller else tips:
        yield tip, feature.part, _ROLLING + spare + max(0.0, -feature.free)


def _pin_fits(feature: PinEyes, gap: float, spare: float) -> Iterator[tuple[str, str, float]]:
    """Parts that touch in a pin joint, with the overlap that may show; spare: of facets, mm."""
    pin = feature.pin
    if pin is not None and pin.part:
        for ring in feature.rings:
            yield ring.part, pin.part, spare
    shown = [eye for eye in (feature.a, feature.b, pin) if eye is not None and eye.part]
    for eye, mate in itertools.combinations(shown, 2):
        air = (eye.diameter - mate.diameter) / 2 * (-1 if eye.shaft else 1)
        if eye.shaft is not mate.shaft and air <= gap + spare / 2:
            yield eye.part or "", mate.part or "", max(0.0, -2 * air) + spare


def _remembered(courses: Courses) -> Courses:
    """The same, without asking again for the angles of a grid and those between them, or for the last ones."""
    grids: dict[bytes, Mapping[str, Pose]] = {}
    last: dict[bytes, Mapping[str, Pose]] = {}

    def remembered(theta: Floats) -> Mapping[str, Pose]:
        key = theta.tobytes()
        kept = grids if len(theta) >= GRID else last
        if key not in kept:
            last.clear()
            kept[key] = courses(theta)
        return kept[key]

    return remembered


def _course(courses: Courses, body: str, start: float) -> Course:
    """The motion of a body from where it is turned at theta = 0, rad, as the file shows it."""

    def course(theta: Floats) -> tuple[Floats, Points]:
        pose = courses(theta)[body]
        return pose.angle - start, pose.place

    return course


def _slabs(stand_in: StandIn, angle: float) -> tuple[Slab, ...]:
    """Discs and bars as slabs, on a body that is turned by so much at theta = 0, rad."""
    turn = cmath.exp(1j * angle)
    slabs = dict[tuple[float, float], list[Ring]]()
    for at, radius, z0, z1 in stand_in.discs:
        slabs.setdefault((z0, z1), []).append(
            Ring(np.asarray(turn * (at + radius * _ENDS), complex), np.ones(2))
        )
    for a, b, radius, z0, z1 in stand_in.bars:
        side = 1j * radius * (b - a) / abs(b - a)
        slabs.setdefault((z0, z1), []).append(
            Ring(turn * np.array([a - side, b - side, b + side, a + side]), _BAR)
        )
    return tuple(Slab(z0, z1, tuple(rings)) for (z0, z1), rings in slabs.items())
