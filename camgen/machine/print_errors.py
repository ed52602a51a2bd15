"""What errors of making do to a machine's outputs, to first order: modes, each an error of unit size somewhere in a part.

    cam       its outline is off along its normal by o + e . n + waves of some orders round the bore; the tip by its radius; mm
    centre    the centre of a hole or pin of a Pin, Slot or Slide, or of a pen's hole, is off by so much along x or y of its
              body, mm

With conditions c(q) = 0 of all joints and their slopes A, an error that shifts them by r moves the bodies by -A^-1 r. What that,
or an outline that stands out, opens or closes at a cam's first contact the follower takes up by its s: the way of the contact
along its normal for a unit of s is the lever. What is then left at the second contact is play. Where an output's place is a hole
that is off, the output goes with it.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from camgen.machine.constraints import Constraints
from camgen.machine.model import Cam, Machine, Pin, Place, Slide, Slot, centres_of
from camgen.machine.run import Run
from camgen.numerics import Floats, Points, solve
from camgen.tolerances import SAME_POINT

ORDERS = 2, 4  # waves a turn of an outline's form, unless a spec says others
AXES = 1 + 0j, 1j  # of a body's frame, along which a centre is off
_STILL = 1e-9  # of an output, for a unit of a cam's s, that the cam does not move


@dataclass(frozen=True)
class Mode:
    """An error of making."""

    where: str  # a cam and its side ("contact, 1"), or a joint and its body
    kind: str
    size: float  # standard deviation, mm
    along: complex = 0j  # of a centre, the axis of its body along which it is off


@dataclass(frozen=True)
class Sizes:
    """Standard deviations of a printer, mm."""

    offset: float  # of a wall along its normal
    form: float  # of an outline's waves, all together
    place: float  # of a centre along an axis
    hole: float  # of the diameter of a hole
    orders: tuple[int, int] = (
        ORDERS  # waves a turn of an outline's form, least and greatest; one would be a bore off its centre
    )

    @property
    def waves(self) -> range:
        """Orders of the waves."""
        return range(self.orders[0], self.orders[1] + 1)


def waviness(place: Points, normal: Points, waves: Sequence[int]) -> Floats:
    """Displacement along the normal by each outline mode of unit size, (modes, n): offset, x, y, then cosine and sine of each
    wave. place: complex mm about the bore, normal: unit, outwards, both (n,)."""
    angle = np.angle(place)
    share = 1 / np.sqrt(len(waves))  # so that all waves together have the size that each is given
    shapes = [share * wave(k * angle) for k in waves for wave in (np.cos, np.sin)]
    return np.stack([np.ones(len(place)), normal.real, normal.imag, *shapes])


def outline_modes(sizes: Sizes) -> list[tuple[str, float]]:
    """Kind and standard deviation, mm, of each of the same modes."""
    return [
        ("offset", sizes.offset),
        *[("bore", sizes.place)] * 2,
        *[("form", sizes.form)] * (2 * len(sizes.waves)),
    ]


@dataclass(frozen=True)
class Sensitivity:
    """What errors do to one output over theta."""

    modes: Any  # how far 1 mm of each mode moves it, (modes, n), complex for a path
    reach: Mapping[str, Floats]  # by joint with play, the most that 1 mm there moves it, (n,)
    # by cam that is touched on both sides, how much more play 1 mm of each mode gives the output,
    # (modes, n), and 1 mm of air at both tips, (n,)
    held: Mapping[str, tuple[Floats, Floats]]


@dataclass(frozen=True)
class _Contact:
    """One side of a cam at the poses."""

    cam: Cam
    side: int  # 0 or 1
    slopes: Floats  # of the way along its normal to the poses, (n, 3 bodies)
    outline: Floats  # what each outline mode displaces there, (modes, n) mm


def hole_at(machine: Machine, place: Place, holes: Mapping[str, Place]) -> str | None:
    """Where the modes of the hole or pin that is at a place are, of its first joint; None where nothing is made there."""
    holes_of_joints = [
        (f"{joint.name}, {side.body}", side)
        for joint in machine.joints
        for side in centres_of(joint)
    ] + [*holes.items()]
    return next(
        (
            where
            for where, centre in holes_of_joints
            if centre.body == place.body and abs(centre.at - place.at) < SAME_POINT
        ),
        None,
    )


def sensitivities(
    run: Run,
    outputs: Sequence[str],
    sizes: Sizes,
    exact: Collection[str] = (),
    holes: Mapping[str, Place] | None = None,
) -> tuple[list[Mode], dict[str, Sensitivity]]:
    """All modes of a machine at the run's angles, and what they do to each output; exact: cams whose tip is no print; holes:
    what is made beside the joints, such as a pen's, by where its modes are."""
    machine = run.machine
    holes = holes or {}
    system = Constraints(machine)
    q = run.poses()
    contacts = [
        _contact(cam, side, system, q, sizes.waves)
        for cam in machine.joints
        if isinstance(cam, Cam)
        for side in range(min(2, len(cam.touches)))
    ]
    errors = _Errors((len(contacts), len(q)), (len(q), system.height))
    _enter_outlines(errors, contacts, sizes, exact)
    _enter_centres(errors, system, q, {contact.cam.cam for contact in contacts}, sizes.place)
    for where in holes:
        for axis in AXES:
            errors.add(Mode(where, "centre", sizes.place, axis))
    moves = _moves(errors, contacts, system, q, run.theta)
    sensitivity_of = {}
    for name, reach in zip(outputs, system.shares(outputs, q, run.theta), strict=True):
        gradient = system.output(name, q)[1]
        parts = np.moveaxis(gradient @ moves.bodies, 0, -1)  # (1 or 2, modes, n)
        shifts: Any = parts[0] + 1j * parts[1] if len(parts) == 2 else parts[0]
        for place, x, y in system.by_place(name, q):
            hole = hole_at(machine, place, holes)
            for k, mode in enumerate(errors.modes):
                if (mode.where, mode.kind) == (hole, "centre"):
                    shifts[k] += x if mode.along == 1 else y
        plays = {joint.name: reach[joint.name] for joint in machine.joints if joint.clearance > 0}
        sensitivity_of[name] = Sensitivity(shifts, plays, _held(gradient, moves, contacts))
    return errors.modes, sensitivity_of


@dataclass
class _Errors:
    """Modes as they are entered, with what each does while no body moves."""

    contacts: tuple[int, int]  # contacts, n
    conditions: tuple[int, int]  # n, conditions
    modes: list[Mode] = field(default_factory=list)
    bumps: list[Floats] = field(default_factory=list)  # material at each contact, (contacts, n) mm
    shifts: list[Floats] = field(default_factory=list)  # of the conditions, (n, conditions)

    def add(self, mode: Mode, shift: Floats | None = None) -> None:
        """Enter one that stands out at no contact."""
        self.modes.append(mode)
        self.bumps.append(np.zeros(self.contacts))
        self.shifts.append(np.zeros(self.conditions) if shift is None else shift)


def _enter_outlines(
    errors: _Errors, contacts: Sequence[_Contact], sizes: Sizes, exact: Collection[str]
) -> None:
    """The modes of each cam's outlines and tips."""
    for c, contact in enumerate(contacts):
        kinds = outline_modes(sizes)
        kinds += [] if contact.cam.name in exact else [("tip", sizes.offset)]
        tip = np.ones(contact.outline.shape[1])
        for (kind, size), bump in zip(kinds, [*contact.outline, tip], strict=False):
            errors.add(Mode(f"{contact.cam.name}, {contact.side + 1}", kind, size))
            errors.bumps[-1][c] = bump


def _enter_centres(
    errors: _Errors, system: Constraints, q: Floats, cams: Collection[str], size: float
) -> None:
    """The modes of the centres of all joints; cams: bodies whose bores are modes of their outlines."""
    for joint in system.machine.joints:
        if isinstance(joint, Pin | Slot | Slide):
            for body, axis, shift in _centres(joint, system, q):
                if not (isinstance(joint, Pin) and body in cams):
                    errors.add(Mode(f"{joint.name}, {body}", "centre", size, axis), shift)


@dataclass(frozen=True)
class _Moves:
    """What modes of unit size do, each cam's first contact closed again by its s."""

    bodies: Floats  # (n, 3 bodies, modes)
    air: Floats  # at each contact, (n, contacts, modes) mm
    levers: Floats  # way of each contact along its normal for a unit of s, (n, contacts, cams)
    per_s: Floats  # (n, 3 bodies, cams)


def _moves(
    errors: _Errors, contacts: Sequence[_Contact], system: Constraints, q: Floats, theta: Floats
) -> _Moves:
    slopes = system.written(q, theta).slopes
    first = [c for c, contact in enumerate(contacts) if contact.side == 0]
    bodies = -system.moved(slopes, np.stack(errors.shifts, axis=2))  # the cams' s held
    units = np.zeros((len(q), system.height, len(first)))
    for k, c in enumerate(first):
        units[:, system.rows[contacts[c].cam.name].start, k] = 1.0
    per_s = system.moved(slopes, units)
    ways = np.zeros((len(q), 0, system.width))
    if contacts:
        ways = np.stack([contact.slopes for contact in contacts], axis=1)
    air = ways @ bodies - np.transpose(np.array(errors.bumps), (2, 1, 0))
    levers = ways @ per_s
    if first:
        s = -solve(levers[:, first], air[:, first])
        bodies = bodies + per_s @ s
        air = air + levers @ s
    return _Moves(bodies, air, levers, per_s)


def _held(
    gradient: Floats, moves: _Moves, contacts: Sequence[_Contact]
) -> dict[str, tuple[Floats, Floats]]:
    """`Sensitivity.held` of an output with this gradient."""
    steep = np.linalg.norm(gradient @ moves.per_s, axis=1)  # (n, cams): for a unit of s
    first = [c for c, contact in enumerate(contacts) if contact.side == 0]
    held = {}
    for k, contact in enumerate(contacts):
        c = sum(each <= k for each in first) - 1  # number of its cam
        if contact.side and np.any(steep[:, c] > _STILL):
            one = np.abs(moves.levers[:, first[c], c])
            two = np.abs(moves.levers[:, k, c])
            held[contact.cam.name] = (
                (moves.air[:, k] * (steep[:, c] / two)[:, None]).T,
                (1 / one + 1 / two) * steep[:, c],
            )
    return held


def _centres(
    joint: Pin | Slot | Slide, system: Constraints, q: Floats
) -> Iterator[tuple[str, complex, Floats]]:
    """Of each body of a joint and each axis of its frame, by what 1 mm there shifts the conditions, (n, conditions)."""
    row = system.rows[joint.name].start
    sides = (
        ((joint.a, 1.0), (joint.b, -1.0))
        if isinstance(joint, Pin)
        else ((joint.runner, 1.0), (joint.guide, -1.0))
    )
    for side, sign in sides:
        turn = sign * np.exp(1j * (system.angle(side.body, q) + np.zeros(len(q))))
        for axis in AXES:
            shift = np.zeros((len(q), system.height))
            if isinstance(joint, Pin):
                shift[:, row] = (axis * turn).real
                shift[:, row + 1] = (axis * turn).imag
            else:  # across the guide alone
                along = np.exp(1j * (system.angle(joint.guide.body, q) + joint.angle))
                shift[:, row] = np.imag(axis * turn / along)
            if np.any(np.abs(shift) > 1e-9):
                yield side.body, axis, shift


def _contact(cam: Cam, side: int, system: Constraints, q: Floats, waves: Sequence[int]) -> _Contact:
    """One side of a cam at the poses."""
    column = system.column[cam.cam]
    angle = system.angle(cam.cam, q) + np.zeros(len(q))
    place, normal = cam.touches[side](system.argument(cam, q))
    turn = np.exp(1j * angle)
    way = system.wrench(cam, q, q[:, column] + 1j * q[:, column + 1] + place * turn, normal * turn)
    return _Contact(cam, side, way, waviness(place, normal, waves))
