"""LASH before there are files: how far the air of pins, or of a cam's two contacts, lets an output move, and what is borne.

What files of facets add, two chord tolerances at most, is not in it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from camgen.findings import Finding, Where, at_most
from camgen.machine.cams.limits import unit_of as unit_of_lift
from camgen.machine.cams.profile import DiscCam
from camgen.machine.features import Demand
from camgen.machine.model import Cam, Machine, Output, unit_of
from camgen.machine.run import Run
from camgen.machine.targets import Course, rectangle, stroke
from camgen.numerics import Floats

_LASH = 0.25  # of an output's stroke, or of a path's smaller side: the play that is borne unless the spec says otherwise
_LINE = 0.05  # of a path's length, below which its width is none
ANGLES = 721  # at which it is looked at: the play turns so slowly that half a degree loses less than a file's facets add


def pins_alone(machine: Machine) -> bool:
    """Whether the clearances of its joints are all its play: a cam between two contacts adds its own, which only the files
    tell."""
    formed = any(isinstance(each, Cam) and each.closure == "form" for each in machine.joints)
    return not formed and any(each.clearance for each in machine.joints)


def of_pins(run: Run, wanted: Sequence[Demand]) -> list[Finding]:
    """LASH of each output that the machine's joints with clearance let move; run: at ANGLES over the motion."""
    outputs: dict[str, Output] = {each.name: each for each in run.machine.outputs}
    found = []
    for asked in (each for each in wanted if each.judged):
        play = 2 * float(np.nanmax(run.play(asked.output).total))
        unit, scale = unit_of(outputs[asked.output])
        if play > 0:
            limit, said = borne(asked.lash, np.asarray(run[asked.output]), asked.lash_of)
            said = f"by the clearance of its joints; {said}"
            found.append(
                at_most("LASH", scale * play, scale * limit, unit, Where(output=asked.output), said)
            )
    return found


def accepted(course: Course, lash: float | None, lash_deg: float | None) -> tuple[float, str]:
    """The play of an output that its limits bear, mm or rad, and what sets it; unless given by its stroke, or of a path by its
    smaller side, so that its shape is left. A path narrower than a twentieth of its length is a line, which has one side."""
    if course.unit == "deg":
        given = lash_deg
        key = "limits.lash_deg"
        scale = math.radians(1)
    else:
        given = lash
        key = "limits.lash"
        scale = 1.0
    if given is not None:
        return scale * given, key
    size = stroke(course)
    of = "stroke"
    if np.iscomplexobj(course.value):
        length, width = rectangle(course.value)
        size, of = (
            (width, "path's smaller side") if width >= _LINE * length else (length, "path's length")
        )
    return scale * _LASH * size, f"a quarter of the {of} ({key} sets another)"


def borne(lash: float, value: Any, lash_of: str = "limits.lash") -> tuple[float, str]:
    """The play that is accepted of an output with these values over the motion, (n,), and why no more."""
    box = max(np.ptp(value.real), np.ptp(value.imag)) if np.iscomplexobj(value) else np.ptp(value)
    half = float(box) / 2
    return (
        (lash, f"the limit is {lash_of}")
        if lash < half
        else (half, "the limit is half of the stroke")
    )


def between(cams: Sequence[DiscCam[Any]], air: float, lash: float) -> list[Finding]:
    """LASH of a follower between two contacts of a disc cam, with so much air at each of the cams, mm; none without air.

    Its way to a contact is the air over the speed at which it leaves it, for 1 of its motion along the contact's normal.
    """
    if air <= 0:
        return []
    theta = np.linspace(0, math.tau, ANGLES)
    play: Floats = sum((air / _leaving(cam, theta) for cam in cams), np.zeros(theta.size))
    worst = int(np.argmax(play))
    unit, scale = unit_of_lift(cams[0])
    limit, said = borne(lash, cams[0].program(theta))
    where = Where("follower", theta=float(theta[worst]), digits=1)
    remark = f"by {air:g} mm of air at each contact; {said}"
    return [at_most("LASH", scale * float(play[worst]), scale * limit, unit, where, remark)]


def _leaving(cam: DiscCam[Any], theta: Floats) -> Floats:
    """How fast the follower leaves the cam along the normal of their contact, for 1 of its motion, (n,)."""
    turn = np.exp(1j * theta)
    s = cam.program(theta)
    velocity = cam.cutter.leaves * cam.cutter.velocity(s, cam.profile(theta) * turn)
    return np.asarray(np.abs(velocity) * np.cos(cam.steepness(theta)))
