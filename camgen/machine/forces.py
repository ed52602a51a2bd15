"""Forces in a machine that runs: reactions of all joints, contact forces of cams, the torque that drives.

Kinetostatics by the Jacobian J of all joints' conditions, that of `constraints`: with poses q of all bodies, masses M and what
acts on the bodies Q,

    J^T multipliers = M q'' - Q

and each multiplier is the force, or torque, that keeps its condition. A gear's and a cam's contact are taken along their
own motion: the torque or force along s is exact, and so are the drives; the part of the contact force across s loads only
the bearings of the two bodies. A cam that says how it is touched has that part too: the force there is the effort along s
over the way that the follower gives, along the force, for a unit of s with the cam held; and friction's part with it.
Friction of joints that have it is in all reactions (`friction`).

Units: mm, kg, N, N m, J, W, s. A force on a body is positive along the ground's axes.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from camgen.machine import friction
from camgen.machine.constraints import Constraints
from camgen.machine.model import (
    MM,
    Angle,
    Cam,
    Clutch,
    Effort,
    Force,
    Gear,
    Gravity,
    Path,
    Pin,
    Resistance,
    Slide,
    Slot,
    Spring,
    Torque,
    TorsionSpring,
)
from camgen.numerics import Floats, Points, solve


@dataclass(frozen=True)
class Forces:
    """What a running machine bears, (n,) each; nan where it does not close or stands at a dead point.

    power = power_in + loads - rubs
    """

    reactions: Mapping[str, Points]  # of each pin, complex N, the force of b on a
    normals: Mapping[str, Floats]  # of each slide and slot, N, on the runner, to the line's left
    moments: Mapping[str, Floats]  # of each slide, N m, on the runner
    gears: Mapping[str, Floats]  # torque on b, N m; of a clutch that by which it turns or holds b
    contacts: Mapping[
        str, Floats
    ]  # of each cam on the follower along s, N m if it swings, N if it slides
    pressing: Mapping[str, Floats]  # between cam and follower, N: < 0 it would pull, inf it jams
    drives: Mapping[str, Floats]  # torque, N m, or on a slide force, N
    power_in: Floats  # what all drives give, W
    loads: Floats  # what all loads give, W, springs and gravity too
    energy: Floats  # kinetic, J
    power: Floats  # its rate of change, W
    shaking: Points  # inertia force of all bodies on the ground, complex N
    rubs: Floats = field(default_factory=lambda: np.zeros(0))  # what friction of joints takes, W
    smooth: Mapping[str, Floats] = field(default_factory=dict)  # drives without friction of joints
    locks: NDArray[np.bool_] = field(
        default_factory=lambda: np.zeros(0, bool)
    )  # where that friction locks the machine; all else is nan there

    def __repr__(self) -> str:
        """The peaks alone."""
        reactions = peaks(self.reactions)
        drives = peaks(self.drives)
        return f"Forces at {len(self.energy)} angles; reactions to {reactions} N; drives to {drives} N m or N"


def peaks(values: Mapping[str, Points] | Mapping[str, Floats]) -> str:
    """The greatest size of each, (n,), by its name, as text."""
    sizes = {
        name: round(float(np.max(np.nan_to_num(np.abs(rows)), initial=0.0)), 12)
        for name, rows in values.items()
    }
    return ", ".join(f"{name} {peak:.4g}" for name, peak in sizes.items()) or "none"


def kinetostatics(
    system: Constraints, theta: Floats, q: Floats, first: Floats, second: Floats, speed: float
) -> Forces:
    """Forces at poses q and their derivatives to theta, (n, 3 bodies), theta growing steadily at `speed` rad/s."""
    n = len(q)
    joints = system.machine.joints
    rubs = np.zeros(n)
    locks = np.zeros(n, bool)
    with np.errstate(all="ignore"):
        slopes = system.evaluate(q, theta)[1]
        rates = first * speed
        transposed = np.swapaxes(slopes, 1, 2)
        inertial, energy, power, shaking = _inertia(system, q, rates, second * speed**2)
        acting = _acting(system, theta, q, rates)
        given = np.sum(acting * rates, axis=1) * MM
        multipliers = solve(transposed, inertial - acting)
        rows_of_cams = {
            joint.name: (
                system.rows[joint.name].start,
                *_contact(joint, system, q, rates, slopes, multipliers),
            )
            for joint in joints
            if isinstance(joint, Cam) and joint.touches
        }
        efforts = {name: multipliers[:, row] for name, (row, _, _) in rows_of_cams.items()}
        for row, _, acts in rows_of_cams.values():
            multipliers = multipliers - multipliers[:, row, None] * solve(transposed, acts)
        smooth = multipliers
        if rubbing := friction.rubbing(system, q, rates):
            units = solve(transposed, -np.stack([each.acts for each in rubbing], axis=2))
            for row, _, acts in rows_of_cams.values():
                units = units - units[:, row, None, :] * solve(transposed, acts)[:, :, None]
            loads, locks = friction.loads(rubbing, multipliers, units)
            multipliers = multipliers + np.sum(units * loads[:, None, :], axis=2)
            multipliers[locks] = np.nan
            efforts = {name: multipliers[:, row] for name, (row, _, _) in rows_of_cams.items()}
            rubs = -MM * sum(
                loads[:, k] * np.sum(each.acts * rates, axis=1) for k, each in enumerate(rubbing)
            )
        pressing = {
            name: np.where(efforts[name] == 0, 0.0, efforts[name] * per)
            for name, (_, per, _) in rows_of_cams.items()
        }

    def of(name: str, k: int = 0) -> Floats:
        rows = system.rows[name]
        return multipliers[:, rows.start + k] if rows.start + k < rows.stop else np.zeros(n)

    power_in = np.zeros(n)
    drives = {}
    for drive in system.machine.drives:
        drives[drive.name] = of(drive.name) * (1.0 if drive.slide else MM)
        power_in += of(drive.name) * drive.law(theta, 1) * speed * MM
    drives_smooth = {
        drive.name: smooth[:, system.rows[drive.name].start] * (1.0 if drive.slide else MM)
        for drive in system.machine.drives
    }
    singular = ~np.isfinite(multipliers).all(axis=1)
    for values in (given, energy, power, shaking, rubs):
        values[singular] = np.nan
    return Forces(
        {j.name: of(j.name) + 1j * of(j.name, 1) for j in joints if isinstance(j, Pin)},
        {j.name: of(j.name) for j in joints if isinstance(j, Slide | Slot)},
        {j.name: of(j.name, 1) * MM for j in joints if isinstance(j, Slide)},
        {j.name: of(j.name) * MM for j in joints if isinstance(j, Gear | Clutch)},
        {j.name: of(j.name) * (1.0 if j.slide else MM) for j in joints if isinstance(j, Cam)},
        pressing,
        drives,
        power_in,
        given,
        energy,
        power,
        shaking,
        rubs,
        drives_smooth,
        locks,
    )


def _contact(
    cam: Cam, system: Constraints, q: Floats, rates: Floats, slopes: Floats, multipliers: Floats
) -> tuple[Floats, Floats]:
    """By a unit of effort along s: force between cam and follower, (n,), inf where friction jams it, and what it does on the
    bodies besides that effort, (n, 3 bodies)."""
    row = system.rows[cam.name].start
    effort = multipliers[:, row]
    unit = np.zeros(multipliers.shape)
    unit[:, row] = 1.0
    per_s = solve(slopes, unit)  # how all bodies move for a unit of s, the drives held
    column = system.column[cam.cam]
    angle = system.angle(cam.cam, q) + np.zeros(len(q))
    argument = system.argument(cam, q)
    force = np.full(len(q), np.nan)
    wrenches = np.zeros(q.shape)
    for k, touch in enumerate(cam.touches[:2]):
        side = cam.leaves * (1 - 2 * k)  # the sense of s in which this one pushes
        active = (
            np.ones(len(q), bool)
            if len(cam.touches) == 1
            else (effort * cam.leaves >= 0) == (k == 0)
        )
        place, normal = touch(argument)
        turn = np.exp(1j * angle)
        point = q[:, column] + 1j * q[:, column + 1] + place * turn
        push = normal * turn
        if cam.friction:
            across = 1j * push
            sliding_speed = _speed(system, cam.cam, point, q, rates) - _speed(
                system, cam.follower, point, q, rates
            )
            slides = np.real(np.conj(across) * sliding_speed)
            push = push + cam.friction * np.sign(slides) * across
        wrench = system.wrench(cam, q, point, push)
        lever = np.sum(wrench * per_s, axis=1)
        size = np.where(lever * side > 0, 1 / lever, np.inf * np.sign(effort))
        force = np.where(active, size, force)
        wrenches += np.where(
            (active & (effort != 0))[:, None], size[:, None] * wrench - slopes[:, row], 0.0
        )
    return force, wrenches


def _speed(system: Constraints, body: str, point: Points, q: Floats, rates: Floats) -> Points:
    """Of the body's point that is at a place of the ground, (n,) complex."""
    c = system.column[body]
    arm = point - q[:, c] - 1j * q[:, c + 1]
    return np.asarray(rates[:, c] + 1j * rates[:, c + 1] + 1j * rates[:, c + 2] * arm)


def _inertia(
    system: Constraints, q: Floats, v: Floats, a: Floats
) -> tuple[Floats, Floats, Floats, Points]:
    """M q'' with what the turning of centres adds, N and N mm; kinetic energy J, its rate W, the shaking force N."""
    n = len(q)
    generalised = np.zeros(q.shape)
    energy = np.zeros(n)
    power = np.zeros(n)
    shaking = np.zeros(n, complex)
    for body in system.machine.moving:
        k = system.column[body.name]
        arm = body.centre * np.exp(1j * q[:, k + 2])
        w = v[:, k + 2]
        alpha = a[:, k + 2]
        speed = v[:, k] + 1j * v[:, k + 1] + 1j * w * arm
        pull = body.mass * (a[:, k] + 1j * a[:, k + 1] + (1j * alpha - w * w) * arm) * MM
        turn = body.inertia * alpha
        generalised[:, k] = pull.real
        generalised[:, k + 1] = pull.imag
        generalised[:, k + 2] = (np.conj(arm) * pull).imag + turn / MM
        energy += 0.5 * (body.mass * np.abs(speed * MM) ** 2 + body.inertia * w * w)
        power += (np.conj(speed) * pull).real * MM + turn * w
        shaking -= pull
    return generalised, energy, power, shaking


def _acting(system: Constraints, theta: Floats, q: Floats, rates: Floats) -> Floats:
    """What all loads do on the bodies, (n, 3 bodies): N and N mm about each body's origin."""
    acting = np.zeros(q.shape)
    for load in system.machine.loads:
        if isinstance(load, Force):
            system.add_force(acting, load.on, q, np.full(len(q), complex(load.force)))
        elif isinstance(load, Gravity):
            for body in system.machine.moving:
                k = system.column[body.name]
                weight = body.mass * load.acceleration
                arm = body.centre * np.exp(1j * q[:, k + 2])
                acting[:, k] += weight.real
                acting[:, k + 1] += weight.imag
                acting[:, k + 2] += (np.conj(arm) * weight).imag
        elif isinstance(load, Spring):
            way = system.place(load.b, q).position - system.place(load.a, q).position
            length = np.abs(way)
            pull = load.rate * (length - load.free) * way / length
            system.add_force(acting, load.a, q, pull)
            system.add_force(acting, load.b, q, -pull)
        elif isinstance(load, Resistance):
            value, gradient = system.measure(load.of, q)
            speed = np.sum(gradient[:, 0] * rates, axis=1)
            force = (
                load.force
                - load.rate * value
                - load.damping * speed
                - load.friction * np.sign(speed)
            )
            if load.law is not None:
                force = force + load.law(value)
            acting += (force / (MM if isinstance(load.of, Angle) else 1.0))[:, None] * gradient[
                :, 0
            ]
        elif isinstance(load, Effort):
            acting += _effort(load, system, theta, q, rates)
        else:
            a, b = (load.on, load.by) if isinstance(load, Torque) else (load.a, load.b)
            torque = _torque(load, system, q) / MM
            for name, sign in ((a, 1.0), (b, -1.0)):
                if system.column[name] >= 0:
                    acting[:, system.column[name] + 2] += sign * torque
    return acting


def _effort(load: Effort, system: Constraints, theta: Floats, q: Floats, rates: Floats) -> Floats:
    """What an effort does on the bodies, (n, 3 bodies)."""
    gradient = system.measure(load.of, q)[1]
    speed = np.sum(gradient * rates[:, None, :], axis=2)
    force = np.asarray(load.law(theta, 0))[:, None] / (MM if isinstance(load.of, Angle) else 1.0)
    if load.moving:
        size = np.sqrt(np.sum(speed**2, axis=1, keepdims=True))
        force = np.where(size > 0, force * speed / np.where(size > 0, size, 1.0), 0.0)
    elif isinstance(load.of, Path):
        way = (
            load.way
            * np.exp(1j * (system.angle(load.of.of.body, q) if load.turns else 0.0))
            * np.ones(len(q))
        )
        force = force * np.stack([way.real, way.imag], axis=1)
    return np.asarray(np.sum(force[:, :, None] * gradient, axis=1))


def _torque(load: Torque | TorsionSpring, system: Constraints, q: Floats) -> Floats:
    """Torque on the first body, (n,) N m."""
    if isinstance(load, Torque):
        return np.full(len(q), load.torque)
    twist = system.angle(load.a, q) - system.angle(load.b, q) - load.free
    return np.asarray(-load.rate * twist + np.zeros(len(q)))
