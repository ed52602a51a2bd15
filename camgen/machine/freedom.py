"""How many freedoms a machine has, by counting and by rank, and what to say where it is loose or locked.

    count    3 n - 2 j1 - j2: n moving bodies, j1 pins and slides, j2 slots, gears and cams   [Gruebler]
    rank     of the conditions' Jacobian at a general position, the drives' among them: special lengths (parallelograms, two
             equal cranks, rings of slides) move or lock against the count, and only the rank tells
    loose    bodies that still move with every drive held: they lie in the Jacobian's null space
    bound    joints and drives that repeat or contradict each other: they lie in the null space of its transpose

`drawn` closes a rough drawing: lengths stay exact, poses change as little as they can.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from camgen.errors import DesignError, counted, listed
from camgen.machine.constraints import Constraints
from camgen.machine.grashof import crank_limits
from camgen.machine.model import GROUND, Drive, Joint, Machine, Pin, Place, Pose, Slide, bodies_of
from camgen.numerics import Floats

# A singular value below this share of the largest is none.
NO_VALUE = 1e-8
# What a body or joint takes part with in a null space, of the largest, that counts.
TAKES_PART = 1e-6
# How far a machine is moved from the drawn position to a general one, of its size.
AWAY = 0.05
# A drawing closes when its gaps are below this share of its size.
CLOSED = 1e-12
# Sine of the angle between two links of a locked chain below which they lie in line: a position that leaves nothing to spare
# closes to the root of the gap that is left.
IN_LINE = 1e-3
# Bodies that a message names.
NAMED = 10
# Steps of Newton's method on a rough drawing, and the longest of them: share of the size, rad.
STEPS = 200
LONGEST = 0.3


@dataclass(frozen=True)
class Freedom:
    """A machine's freedoms."""

    bodies: int  # that move
    pairs: int  # pins and slides
    half_pairs: int  # slots, gears, cams
    drives: int
    count: int  # freedoms by Gruebler, without the drives
    moves: int  # freedoms by rank, with all drives held
    spare: int  # conditions that repeat or contradict others
    loose: tuple[str, ...]  # bodies that move with all drives held
    bound: tuple[str, ...]  # joints and drives of the spare conditions


def freedoms(machine: Machine) -> Freedom:
    """Count and rank; the machine must be closed as drawn (see `drawn`)."""
    system = Constraints(machine)
    by_count = _by_count(machine)
    best = _values(system, system.start)
    full = best[1] == min(system.width, system.height)
    for q in () if full else _elsewhere(system):  # no rank is higher
        other = _values(system, q)
        if other[1] > best[1]:
            best = other
    (null_rows, _, right), rank = best
    names = [body.name for body in machine.moving]
    loose = np.abs(right[rank:]).max(axis=0, initial=0).reshape(-1, 3).max(axis=1, initial=0)
    dependent = np.abs(null_rows[:, rank:]).max(axis=1, initial=0)
    within = [
        each.name
        for each in system.conditions
        if dependent[system.rows[each.name]].max(initial=0) > TAKES_PART
    ]
    loose_names = tuple(name for name, part in zip(names, loose, strict=True) if part > TAKES_PART)
    return replace(
        by_count,
        moves=system.width - rank,
        spare=system.height - rank,
        loose=loose_names,
        bound=tuple(within),
    )


def _by_count(machine: Machine, names: Collection[str] | None = None) -> Freedom:
    """By Gruebler alone; names: of bodies, of which the chain on the ground is counted in place of the whole."""
    bodies = len(machine.moving) if names is None else len(names)
    joints = [each for each in machine.joints if names is None or _among(each, names)]
    pairs = sum(isinstance(joint, Pin | Slide) for joint in joints)
    half = len(joints) - pairs
    drives = sum(names is None or _among(each, names) for each in machine.drives)
    return Freedom(bodies, pairs, half, drives, 3 * bodies - 2 * pairs - half, 0, 0, (), ())


def _among(each: Joint | Drive, names: Collection[str]) -> bool:
    """Whether a joint or a drive is between bodies of these names and the ground."""
    bodies = bodies_of(each)
    return bool(bodies) and {*bodies} - {GROUND} <= {*names}


def refuse_unsound(machine: Machine) -> Freedom:
    """The freedoms of a sound machine; raises DesignError that names what is loose, driven twice or locked."""
    freedom = freedoms(machine)
    if freedom.spare:
        second = [
            drive.name
            for drive in machine.drives
            if drive.name in freedom.bound and _needless(machine, drive)
        ]
        if second and freedom.drives > 1:
            raise _drives_error(freedom, second)
        if second:
            raise _rigid_error(freedom)
        raise _dead_point(machine, freedom) or _locked_error(freedom)
    if freedom.moves:
        remedy = (
            "join it to another link, or drive it"
            if len(freedom.loose) == 1
            else "drive one of them, or join them"
        )
        message = (
            f"{_degrees(freedom.moves)} left over: {listed('link', freedom.loose, NAMED)} still "
        )
        message += f"{'moves' if len(freedom.loose) == 1 else 'move'} with the drive held ({_tally(freedom)})"
        raise DesignError(
            "degrees of freedom left",
            freedom.moves,
            0,
            "",
            listed("link", freedom.loose, NAMED),
            remedy,
        ).saying(message)
    return freedom


def _rigid_error(freedom: Freedom, links: Sequence[str] = ()) -> DesignError:
    """A chain that nothing can drive; links: those that are rigid, where others are not."""
    what = f"{listed('link', links)} cannot move" if links else "the chain is rigid"
    return DesignError(
        "degrees of freedom to drive",
        0,
        1,
        "",
        _joints(freedom.bound),
        "take away a joint or a link",
    ).saying(
        f"{what}: {_joints(freedom.bound)} leave no degree of freedom to drive ({_tally(freedom)})"
    )


def _drives_error(freedom: Freedom, second: Sequence[str]) -> DesignError:
    """More drives than degrees of freedom; second: those of which one decides nothing."""
    degrees = freedom.drives - freedom.spare
    return DesignError(
        "number of drives",
        freedom.drives,
        degrees,
        "",
        _joints(freedom.bound),
        f"take away {'one of the' if len(second) > 1 else 'the'} {listed('drive', second)}",
    ).saying(f"{freedom.drives} drives for {_degrees(degrees)} ({_tally(freedom)})")


def _locked_error(freedom: Freedom) -> DesignError:
    message = f"over-constrained: {_joints(freedom.bound)} hold the same links {counted(freedom.spare, 'time')} too often"
    return DesignError(
        "excess conditions",
        freedom.spare,
        0,
        "",
        _joints(freedom.bound),
        "take away a link, or make one of its pins a slot",
    ).saying(f"{message} ({_tally(freedom)})")


def _dead_point(machine: Machine, freedom: Freedom) -> DesignError | None:
    """The error of a chain with as many degrees of freedom as drives that two links in one line hold, for the way between their
    ends is the longest or shortest that they have; None where no such two are."""
    if freedom.count != freedom.drives:
        return None
    pins = [each for each in machine.joints if isinstance(each, Pin) and each.name in freedom.bound]
    for middle in pins:
        if not {middle.a.body, middle.b.body} <= {*freedom.loose}:
            continue
        first, last = (
            [
                (pin, _placed(machine, place))
                for pin in pins
                for place in (pin.a, pin.b)
                if place.body == body and pin is not middle
            ]
            for body in (middle.a.body, middle.b.body)
        )
        at = _placed(machine, middle.a)
        for (one, start), (other, end) in product(first, last):
            arm = at - start
            rest = end - at
            if abs((arm.conjugate() * rest).imag) <= IN_LINE * abs(arm) * abs(rest):
                return _in_line(
                    (one.name, middle, other.name), abs(arm), abs(rest), abs(end - start)
                )
    return None


def _placed(machine: Machine, place: Place) -> complex:
    """Where a place of a body is as drawn, mm."""
    pose = machine.start_of(place.body)
    return complex(pose.place + place.at * np.exp(1j * pose.angle))


def _in_line(pins: tuple[str, Pin, str], arm: float, rest: float, way: float) -> DesignError:
    """The error of two links, arm and rest mm long, that are in line over the whole way between their ends."""
    one, middle, other = pins
    lengths = [f"lengths.{one}-{middle.name}", f"lengths.{other}-{middle.name}"]
    if way > max(arm, rest):
        verb = "reach"
        bound = "more"
        remedy = f"a longer {' or '.join(lengths)}"
    else:
        verb = "come down to"
        bound = "less"
        shorter, longer = lengths if arm < rest else lengths[::-1]
        remedy = f"a longer {shorter} or a shorter {longer}"
    line = f"at theta = 0 {one}, {middle.name} and {other} lie in one line"
    reach = f"{middle.a.body} and {middle.b.body} {verb} the {way:.6g} mm from {one} to {other} and no {bound}"
    return DesignError("length to spare", 0.0, 0.0, "mm", f"{one} and {other}", remedy).saying(
        f"no link can move: {line}; {reach}"
    )


def _tally(freedom: Freedom) -> str:
    balance = f"3 x {freedom.bodies} - 2 x {freedom.pairs} - {freedom.half_pairs} = {freedom.count}"
    return (
        f"{balance} degree{'' if freedom.count == 1 else 's'} of freedom, {freedom.drives} driven"
    )


def _degrees(count: int) -> str:
    return counted(count, "degree of freedom", "degrees of freedom")


def _joints(names: Sequence[str]) -> str:
    return listed("joint", names)


def _needless(machine: Machine, drive: Drive) -> bool:
    """Whether a drive decides nothing that the rest does not decide already."""
    without = replace(machine, drives=tuple(each for each in machine.drives if each is not drive))
    return freedoms(without).moves == freedoms(machine).moves


def _values(system: Constraints, q: Floats) -> tuple[tuple[Floats, Floats, Floats], int]:
    """Singular values of the Jacobian, its columns and rows brought to one size, and its rank."""
    slope = system.evaluate(q[None], np.zeros(1))[1][0] * system.unit
    size = np.linalg.norm(slope, axis=1, keepdims=True)
    left, values, right = np.linalg.svd(slope / np.where(size > 0, size, 1.0))
    return (left, values, right), int(
        np.count_nonzero(values > NO_VALUE * values.max(initial=1e-300))
    )


def _elsewhere(system: Constraints) -> list[Floats]:
    """Poses a little way from the drawn ones, the drives let go."""
    still = Constraints(replace(system.machine, drives=()))
    poses = []
    for share in (AWAY, -0.7 * AWAY):
        (_, _, right), rank = _values(still, still.start)
        if rank == still.width:
            continue
        ways = right[rank:] * np.sqrt(np.arange(1, still.width - rank + 1))[:, None]
        q, gap = _closest(still, still.start + share * still.unit * ways.sum(axis=0))
        if gap <= 1e3 * CLOSED * still.size:
            poses.append(q)
    return poses


def _loop(machine: Machine, joints: Sequence[str]) -> str:
    """The links that open joints hold, with the distances of their places, in brackets; nothing where they are too many."""
    pins = [joint for joint in machine.joints if isinstance(joint, Pin)]
    bodies = dict.fromkeys(
        place.body for pin in pins if pin.name in joints for place in (pin.a, pin.b)
    )
    lengths = []
    for body in bodies:
        points = [
            (pin.name, place.at) for pin in pins for place in (pin.a, pin.b) if place.body == body
        ]
        lengths += [
            f"{body} {a}-{b} {abs(z - w):.6g}"
            for k, (a, z) in enumerate(points)
            for b, w in points[k + 1 :]
        ]
    return f" ({', '.join(lengths)})" if 0 < len(lengths) <= NAMED else ""


def _closest(system: Constraints, q: Floats) -> tuple[Floats, float]:
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
        q = q - system.unit * step * min(
            1.0, LONGEST / max(float(np.abs(step).max(initial=0)), 1e-300)
        )
    return best


def close_drawing(machine: Machine) -> Machine:
    """The machine with start poses that close it at theta = 0, as near to the given ones as may be.

    Raises DesignError where the lengths contradict each other: by how much the joints stay open, which, and how long the crank
    of a four-bar among them may be.
    """
    system = Constraints(machine)
    q, gap = _closest(system, system.start)
    if gap > CLOSED * system.size:
        misfit = np.abs(system.evaluate(q[None], np.zeros(1))[0][0])
        open_ = [
            each.name
            for each in system.conditions
            if misfit[system.rows[each.name]].max() > 0.01 * misfit.max()
        ]
        freedom = _by_count(machine)
        if freedom.count < freedom.drives:  # no lengths will do
            found = replace(freedom, spare=freedom.drives - freedom.count, bound=tuple(open_))
            motors = [drive.name for drive in machine.drives if drive.motor]
            raise _drives_error(found, motors) if motors else _locked_error(found)
        open_ = [name for name in open_ if name in {joint.name for joint in machine.joints}]
        joints = [machine.joint(name) for name in open_]
        links = [
            *dict.fromkeys(body for each in joints for body in bodies_of(each) if body != GROUND)
        ]
        part = _by_count(machine, links)
        if part.count < part.drives:
            raise _rigid_error(replace(part, bound=tuple(open_)), links)
        cranks = [drive.body for drive in machine.drives if drive.slide is None][:1]
        limits = "".join(crank_limits(machine, [(name,) for name in open_], it) for it in cranks)
        message = f"the lengths contradict each other: {_joints(open_)} {'stays' if len(open_) == 1 else 'stay'} open"
        raise DesignError(
            "gap of the joints as drawn",
            gap,
            0,
            "mm",
            _joints(open_),
            "change the lengths of the links in this loop, or draw their points nearer to where the links meet"
            + limits,
        ).saying(f"{message} by {gap:.6g} mm{_loop(machine, open_)}")
    rows = q.reshape(-1, 3)
    start = {
        body: Pose(complex(x, y), float(angle))
        for body, (x, y, angle) in zip(system.bodies, rows, strict=True)
    }
    return replace(machine, start=start)
