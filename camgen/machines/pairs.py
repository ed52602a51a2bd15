"""A conjugate pair's air or preload, on purpose: both cams are cut for a tip that is larger by it, or smaller.

The follower moves as wanted in the middle between both cams; from there it has the same way to either, or presses on both. Of a
tip on an arm of length l at pressure angles a and b the play is air (1 / cos a + 1 / cos b) / l, rad; on a slide without the l.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Annotated, Any

import numpy as np

from camgen.errors import Fault, Key
from camgen.findings import NotJudged
from camgen.machine.features import CamOutline
from camgen.machine.forces import Forces
from camgen.machine.model import Cam, Machine
from camgen.spec import quantity

Air = Annotated[  # nothing stiff gives way by more
    float,
    quantity(
        "mm",
        "clearance at each tip of a conjugate pair, in the middle of its play; below 0: preload",
        ge=-0.5,
        le=10,
    ),
]


def still_faults(path: Key, kinds: Sequence[str | None]) -> list[Fault]:
    """What is wrong with the kinds of a cam's segments: all dwells move nothing."""
    if any(kind != "dwell" for kind in kinds):
        return []
    return [Fault(path, f"{len(kinds)} of them, all dwells", "at least one rise and one return")]


def air_faults(path: Key, air: float, closure: str, radius: float | None) -> list[Fault]:
    """What is wrong with the air at the tips, mm; radius: of a round tip, 0 of a knife, None of a face."""
    if air and closure != "conjugate":
        return [Fault(path, f"{air:g}", 'no value here: only closure "conjugate" has two tips')]
    if radius is not None and air < -radius:
        right = f"at least {0.0 - radius:g}: a preload that the tip's radius can give way by"
        return [Fault(path, f"{air:g}", right)]
    return []


def remarks(
    forces: Forces,
    machine: Machine,
    outlines: Mapping[str, CamOutline],
    stiffness: float | None = None,
) -> tuple[list[str], list[NotJudged]]:
    """What to know of pairs with air or preload, and what of them is not judged.

    Which cam of a pair leads for how much of the turn by the forces, or that it is pressed. outlines: by joint, the first;
    stiffness: of a follower's arm, N m/rad, where it is known.
    """
    notes = []
    not_judged = []
    for joint in machine.joints:
        outline = outlines.get(joint.name)
        if not isinstance(joint, Cam) or outline is None or not outline.free:
            continue
        if outline.free < 0:
            why = f"how hard the preload at {joint.name} presses follows from the stiffness of its parts, which is not known"
            most = _most(joint, -outline.free, stiffness or 0.0)
            if most:
                why += f" ({most:.3g} N at a tip at most: so much if arms alone gave way, not tips, cams and pins)"
            why += ": it is in no force here"
            not_judged.append(NotJudged("HERTZ", why, "a torque measured on the machine"))
            continue
        effort = forces.contacts[joint.name] * joint.leaves
        leads = "on which is not known: it bears no load"
        if np.any(effort):
            leads = f"by its forces on the first one for {100 * float(np.mean(effort > 0)):.0f} % of the turn, else on the second"
        middle = "MOTION_ERROR is that of the middle between both cams"
        notes.append(f"{joint.name}: {middle}; the follower lies half of LASH beside it, {leads}.")
    return notes, not_judged


def _most(joint: Cam, preload: float, stiffness: float) -> float:
    """Largest force at a tip of a pair, N, where only its two arms give way by the preload, mm; 0 where that is not known.

    Both arms turn until what they give is what both tips overlap: the same moment is in both. stiffness: of each, N m/rad.
    """
    cams: list[Any] = [touch.cam for touch in joint.touches[:2]]  # type: ignore[attr-defined]
    if joint.slide or len(cams) < 2 or not all(hasattr(cam.follower, "arm") for cam in cams):
        return 0.0
    theta = np.linspace(0, math.tau, 721)
    levers = [abs(cam.follower.arm) * np.cos(cam.pressure_angle_untrimmed(theta)) for cam in cams]
    moment = 1e3 * stiffness * sum(preload / lever for lever in levers) / 2
    return float(max(np.nanmax(moment / lever) for lever in levers))
