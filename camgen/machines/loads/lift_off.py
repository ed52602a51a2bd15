"""Whether cams that are closed by force keep their followers: LIFT_OFF from the weights, springs and loads of the machine."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from camgen.findings import NotJudged, Where
from camgen.machine.cams.machine import keeps_contact
from camgen.machine.model import Cam, Machine
from camgen.machine.run import solve
from camgen.machines.loads.bearing import LoadCheck
from camgen.machines.loads.pins import STILL
from camgen.numerics import Floats

_SLOW = 1e-6  # of the speed, at which inertia does nothing
_NEEDS = "[cam.spring], [[spring]], or [load] with gravity_deg or [[load.on]]: what presses the follower on its cam"


def by_force(machine: Machine) -> list[Cam]:
    """The cams that only a force keeps closed."""
    return [
        joint for joint in machine.joints if isinstance(joint, Cam) and joint.closure == "force"
    ]


def slow(machine: Machine) -> Machine:
    """A machine that turns so slowly that inertia does nothing."""
    return replace(machine, speed=_SLOW * machine.speed)


def lift_off(
    machine: Machine, cams: Sequence[Cam], kicks: Collection[str], theta: Floats, angle: str
) -> LoadCheck:
    """LIFT_OFF of some of its cams, not judged where no spring, weight or load acts on the follower.

    machine: with its masses and loads, without friction in its pins; kicks: joints whose follower's speed jumps; theta: (n,)
    rad; angle: what theta is called.
    """
    check = LoadCheck()
    if not cams:
        return check
    forces = solve(machine, theta).forces()
    still = solve(slow(machine), theta).forces()
    for cam in cams:
        effort = cam.leaves * forces.contacts[cam.name]
        force = forces.pressing.get(cam.name, effort)
        if not np.any(np.abs(still.contacts[cam.name]) > STILL):
            why = f"no spring, weight or load acts on the follower of {cam.name}"
            check.not_judged.append(NotJudged("LIFT_OFF", why, _NEEDS))
            continue
        unit = "N" if cam.slide else "N m"
        least = max(0.0, -float(np.nanmin(effort)))
        jumps = cam.name in kicks
        remedy = (
            f"press {cam.follower} on the cam with {least:.4g} {unit} more at all angles: by a spring ([cam.spring], "
            "[[spring]], or its preload), a weight or a load ([load]); less mass or speed needs less"
        )
        if jumps:
            remedy = "its speed jumps, and no spring holds it then: use a law that ends smoothly"
        where = Where(joint=cam.name, angle=angle)
        check.findings.append(keeps_contact(theta, force, jumps, where, remedy))
    return check
