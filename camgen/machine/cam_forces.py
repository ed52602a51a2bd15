"""Forces between a cam and its follower: effort, contact force, torque on the motor, and the spring that keeps contact.

    lift     how far the follower is from its place nearest to the cam, with two derivatives to theta, (3, n): rad on an
             arm, m on a straight guide; it grows away from the cam
    effort   what the cam must exert on the follower in the sense of the lift: N m on an arm, N on a guide; where it is
             negative nothing that the cam does keeps contact
    load     what makes up the effort: inertia, damping, and a spring that presses the follower on the cam

Units are SI (kg, m, N, s) but for the cam's own geometry, mm; speed is that of the cam, rad/s. The cam turns evenly;
play, elasticity and gravity are left out. [Norton, Cam Design and Manufacturing Handbook, ch. 9, rigid follower]
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from camgen.findings import Finding, at_least
from camgen.machine.cams import DiscCam
from camgen.motion.laws import Floats
from camgen.motion.program import Program

MM = 1e-3


@dataclass(frozen=True)
class Load:
    """Inertia (kg m^2 or kg), damping (N m s/rad or N s/m), spring rate (N m/rad or N/m), preload at lift 0 (N m or N)."""

    inertia: float
    damping: float = 0.0
    rate: float = 0.0
    preload: float = 0.0

    def effort(self, lift: Floats, speed: float) -> Floats:
        """What the cam must exert in the sense of the lift, (n,)."""
        moved = self.inertia * lift[2] * speed**2 + self.damping * lift[1] * speed
        return np.asarray(moved + self.rate * lift[0] + self.preload)

    def preload_needed(self, lift: Floats, speed: float, least: float = 0.0) -> float:
        """Smallest preload, not below 0, with which the effort nowhere falls under `least`, this spring rate given."""
        return max(0.0, least - float(np.min(replace(self, preload=0.0).effort(lift, speed))))

    def rate_needed(self, lift: Floats, speed: float, least: float = 0.0) -> float:
        """Smallest spring rate, not below 0, for the same, this preload given; inf where it fails at no lift."""
        missing = least - replace(self, rate=0.0).effort(lift, speed)
        short = missing > 0
        if not np.any(short):
            return 0.0
        low = lift[0][short]
        return float(np.max(missing[short] / low)) if np.all(low > 0) else math.inf


def lift_of(program: Program, theta: Floats, leaves: int = 1) -> Floats:
    """Lift over the angles theta, which must reach the lowest place, (3, n); leaves: sense of s that takes off the cam."""
    lift = leaves * np.array([program(theta, order) for order in range(3)])
    lift[0] -= np.min(lift[0])
    return np.asarray(lift)


def kicks(program: Program, inertia: float, speed: float) -> Floats:
    """Impulse on the follower at each joint of the program, (n,), N m s or N s: not 0 where its speed jumps."""
    return np.asarray(inertia * speed * program.jumps(1))


@dataclass(frozen=True)
class Contact:
    """Between cam and tip, each (n,): force, N, negative where contact is lost; torque that drives the cam, N m.

    Both are inf where friction jams the follower.
    """

    force: Floats
    torque: Floats


def arm_contact(cam: DiscCam, theta: Floats, effort: Floats, friction: float = 0.0, sense: int = 1) -> Contact:
    """Contact of a tip on an arm that bears the effort, (n,) N m, at cam angles theta, (n,) rad.

    The tip follows the program exactly: angles at which it rides on an undercut's corner are not meant. friction: between
    tip and cam, 0 for a roller. sense: -1 where the cam turns clockwise.
    """
    arm = cam.follower
    turn = np.exp(1j * theta)
    centre = arm.trace(cam.program(theta))
    normal = 1j * cam.tangent(theta) * turn  # from the cam into the tip
    touch = centre - arm.tip_radius * normal
    spoke = touch - arm.pivot
    along = 1j * normal
    sliding = sense * np.real(np.conj(along) * 1j * (touch - cam.program(theta, 1) * spoke))
    push = normal + friction * np.sign(sliding) * along
    lever = arm.leaves * np.imag(np.conj(spoke) * push) * MM
    with np.errstate(divide="ignore", invalid="ignore"):
        force = np.where(lever > 0, effort / lever, np.where(effort == 0, 0.0, math.inf))
        torque = np.where(force == 0, 0.0, force * np.imag(np.conj(touch) * push) * MM)
    return Contact(force, np.where(np.isinf(force), math.inf, torque))


def pair_contact(cam: DiscCam, theta: Floats, effort: Floats, friction: float = 0.0, sense: int = 1) -> Contact:
    """Contact of a conjugate pair: the second tip on the turned cam bears what the first cannot; force is 0 or more.

    Mirrored in the line of centres, the second pair at theta is the first at pi - theta, turning the other way; the
    program must have s(pi - theta) = -s(theta), as a uniform swing has.
    """
    first = arm_contact(cam, theta, np.maximum(effort, 0), friction, sense)
    second = arm_contact(cam, math.pi - theta, np.maximum(-effort, 0), friction, -sense)
    pushes = effort >= 0
    return Contact(np.where(pushes, first.force, second.force), np.where(pushes, first.torque, -second.torque))


def lift_off(force: Floats, theta: Floats, remedy: str) -> Finding:
    """Finding LIFT_OFF: whether the least contact force, N, stays at 0 or more; nan fails, -inf is a kick off the cam."""
    k = int(np.argmin(np.where(np.isnan(force), -np.inf, force)))
    where = f"cam angle {math.degrees(float(theta[k])):.1f} deg"
    message = "the follower stays on the cam" if force[k] >= 0 else f"the follower leaves the cam: {remedy}"
    return at_least("LIFT_OFF", float(force[k]), 0.0, "N", where, message)
