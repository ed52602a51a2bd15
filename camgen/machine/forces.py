"""Forces in a machine that runs: reactions of all joints, contact forces of cams, the torque that drives.

Kinetostatics by the judge's Jacobian J: with poses q of all bodies, masses M and what acts on the bodies Q,

    J^T multipliers = M q'' - Q

and each multiplier is the force, or torque, that keeps its condition. Friction is left out. A gear's and a cam's contact
are taken along their own motion: the torque or force along s is exact, and so are the drives; the part of the contact
force across s, which loads only the bearings of the two bodies, is not known here (it needs the pressure angle).

Units: mm, kg, N, N m, J, W, s. A force on a body is positive along the ground's axes.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from camgen.machine.closure import System, solved
from camgen.machine.model import (
    Cam,
    Floats,
    Force,
    Gear,
    Gravity,
    Pin,
    Points,
    Slide,
    Slot,
    Spring,
    Torque,
    TorsionSpring,
)

MM = 1e-3


@dataclass(frozen=True)
class Forces:
    """What a running machine bears, (n,) each; nan where it does not close or stands at a dead point.

    reactions: of each pin, complex N, the force of b on a.
    normals: of each slide and slot, N, on the runner, to the left of the line.
    moments: of each slide, N m, on the runner.
    gears: torque on b, N m.
    contacts: of each cam along s, on the follower: N m where it swings, N where it slides.
    drives: torque N m (or force N on a driven slide); power_in: what all drives give, W.
    loads: what all loads give, W, springs and gravity too.
    energy: kinetic, J; power: its rate of change, W; power = power_in + loads.
    shaking: the inertia force of all bodies on the ground, complex N.
    """

    reactions: Mapping[str, Points]
    normals: Mapping[str, Floats]
    moments: Mapping[str, Floats]
    gears: Mapping[str, Floats]
    contacts: Mapping[str, Floats]
    drives: Mapping[str, Floats]
    power_in: Floats
    loads: Floats
    energy: Floats
    power: Floats
    shaking: Points

    def lifts_off(self, cam: Cam) -> Floats:
        """Where the contact of a force-closed cam would have to pull, (n,): True, nan never."""
        return np.asarray(self.contacts[cam.name] * cam.push < 0)


def kinetostatics(system: System, theta: Floats, q: Floats, first: Floats, second: Floats, speed: float) -> Forces:
    """Forces at poses q and their derivatives to theta, (n, 3 bodies), theta growing steadily at `speed` rad/s."""
    n = len(q)
    with np.errstate(all="ignore"):
        slopes = system.evaluate(q, theta)[1]
        wanted, energy, power, shaking = _inertia(system, q, first * speed, second * speed**2)
        acting = _acting(system, q)
        given = np.sum(acting * first, axis=1) * speed * MM
        multipliers = solved(np.swapaxes(slopes, 1, 2), wanted - acting)

    def of(name: str, k: int = 0) -> Floats:
        rows = system.rows[name]
        return multipliers[:, rows.start + k] if rows.start + k < rows.stop else np.zeros(n)

    joints = system.machine.joints
    power_in = np.zeros(n)
    drives = {}
    for drive in system.machine.drives:
        drives[drive.name] = of(drive.name) * (1.0 if drive.slide else MM)
        power_in += of(drive.name) * drive.law(theta, 1) * speed * MM
    lost = ~np.isfinite(multipliers).all(axis=1)
    for values in (given, energy, power, shaking):
        values[lost] = np.nan
    return Forces(
        {j.name: of(j.name) + 1j * of(j.name, 1) for j in joints if isinstance(j, Pin)},
        {j.name: of(j.name) for j in joints if isinstance(j, Slide | Slot)},
        {j.name: of(j.name, 1) * MM for j in joints if isinstance(j, Slide)},
        {j.name: of(j.name) * MM for j in joints if isinstance(j, Gear)},
        {j.name: of(j.name) * (1.0 if j.slide else MM) for j in joints if isinstance(j, Cam)},
        drives, power_in, given, energy, power, shaking,
    )  # fmt: skip


def _inertia(system: System, q: Floats, v: Floats, a: Floats) -> tuple[Floats, Floats, Floats, Points]:
    """M q'' with what the turning of centres adds, N and N mm; kinetic energy J, its rate W, the shaking force N."""
    n = len(q)
    wanted = np.zeros(q.shape)
    energy, power, shaking = np.zeros(n), np.zeros(n), np.zeros(n, complex)
    for body in system.machine.moving:
        k = system.column[body.name]
        arm = body.centre * np.exp(1j * q[:, k + 2])
        w, alpha = v[:, k + 2], a[:, k + 2]
        speed = v[:, k] + 1j * v[:, k + 1] + 1j * w * arm
        pull = body.mass * (a[:, k] + 1j * a[:, k + 1] + (1j * alpha - w * w) * arm) * MM
        turn = body.inertia * alpha
        wanted[:, k], wanted[:, k + 1] = pull.real, pull.imag
        wanted[:, k + 2] = (np.conj(arm) * pull).imag + turn / MM
        energy += 0.5 * (body.mass * np.abs(speed * MM) ** 2 + body.inertia * w * w)
        power += (np.conj(speed) * pull).real * MM + turn * w
        shaking -= pull
    return wanted, energy, power, shaking


def _acting(system: System, q: Floats) -> Floats:
    """What all loads do on the bodies, (n, 3 bodies): N and N mm about each body's origin."""
    acting = np.zeros(q.shape)
    for load in system.machine.loads:
        if isinstance(load, Force):
            system.press(acting, load.on, q, np.full(len(q), complex(load.force)))
        elif isinstance(load, Gravity):
            for body in system.machine.moving:
                k = system.column[body.name]
                weight = body.mass * load.acceleration
                arm = body.centre * np.exp(1j * q[:, k + 2])
                acting[:, k] += weight.real
                acting[:, k + 1] += weight.imag
                acting[:, k + 2] += (np.conj(arm) * weight).imag
        elif isinstance(load, Spring):
            way = system.place(load.b, q).where - system.place(load.a, q).where
            length = np.abs(way)
            pull = load.rate * (length - load.free) * way / length
            system.press(acting, load.a, q, pull)
            system.press(acting, load.b, q, -pull)
        else:
            a, b = (load.on, load.by) if isinstance(load, Torque) else (load.a, load.b)
            torque = _torque(load, system, q) / MM
            for name, sign in ((a, 1.0), (b, -1.0)):
                if system.column[name] >= 0:
                    acting[:, system.column[name] + 2] += sign * torque
    return acting


def _torque(load: Torque | TorsionSpring, system: System, q: Floats) -> Floats:
    """Torque on the first body, (n,) N m."""
    if isinstance(load, Torque):
        return np.full(len(q), load.torque)
    wound = system.angle(load.a, q) - system.angle(load.b, q) - load.free
    return np.asarray(-load.rate * wound + np.zeros(len(q)))
