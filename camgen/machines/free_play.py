"""LASH before there are files: how far the air of pins, or of a cam's two contacts, lets an output move, and its limit.

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
from camgen.machine.model import Cam, Machine, unit_of
from camgen.machine.run import Run
from camgen.machine.targets import (
    Course,
    Dwell,
    Function,
    Lines,
    Straight,
    Through,
    Trace,
    breadth,
    rectangle,
    stroke,
)
from camgen.numerics import Floats

_STILL = 1e-9  # mm or rad, of an output that does not move
_LASH = 0.25  # of an output's stroke, or of a path's smaller side: the play that is accepted unless the spec says otherwise
_KEYS = ("limits.lash", "limits.lash_deg")
_LINE = 0.05  # of a path's length, below which its ways there and back are one
ANGLES = 721  # at which it is looked at: the play turns so slowly that half a degree loses less than a file's facets add


def pins_alone(machine: Machine) -> bool:
    """Whether the clearances of its joints are all its play.

    A cam between two contacts adds its own, which only the files tell.
    """
    formed = any(isinstance(each, Cam) and each.closure == "form" for each in machine.joints)
    return not formed and any(each.clearance for each in machine.joints)


def of_pins(run: Run, demands: Sequence[Demand]) -> list[Finding]:
    """LASH of each output that the machine's joints with clearance let move; run: at ANGLES over the motion."""
    findings = []
    for demand in demands:
        if not demand.judged:
            continue
        name = demand.output
        play = 2 * float(np.nanmax(run.play(name).total))
        limit, reason = limit_of(demand.lash, np.asarray(run[name]), demand.lash_of)
        if play > 0 and math.isfinite(limit):
            unit, scale = unit_of(run.machine.output(name))
            remark = f"by the clearance of its joints; {reason}"
            where = Where(output=name)
            findings.append(at_most("LASH", scale * play, scale * limit, unit, where, remark))
    return findings


def accepted(course: Course, lash: float | None, lash_deg: float | None) -> tuple[float, str]:
    """The play of an output that its limits accept, mm or rad, and what sets it.

    Unless the spec gives it, by the output's stroke, or of a path by its smaller side, so that its shape is left. A path whose
    ways there and back are nearer than a twentieth of its length is a line, straight or an arc, which has one side.
    """
    given = lash
    key, key_deg = _KEYS
    scale = 1.0
    if course.unit == "deg":
        given = lash_deg
        key = key_deg
        scale = math.radians(1)
    if given is not None:
        return scale * given, key
    size = stroke(course)
    of = "stroke"
    if np.iscomplexobj(course.value):
        size, width = rectangle(course.value)
        of = "path's length"
        if breadth(course.value) >= _LINE * size:
            size = width
            of = "path's smaller side"
    if size <= _STILL:
        return math.inf, f"not known, it stands still: give {key}"
    return scale * _LASH * size, f"a quarter of the {of} ({key} sets another)"


def limit_of(lash: float, value: Any, key: str = "limits.lash") -> tuple[float, str]:
    """The play that is accepted of an output with these values over the motion, (n,), and why no more."""
    half = float(max(np.ptp(np.real(value)), np.ptp(np.imag(value)))) / 2
    if lash < half or half <= _STILL:  # an output that stands still has no stroke that bounds it
        return lash, f"the limit is {key}"
    return half, "the limit is half of the stroke"


def beyond_targets(findings: Sequence[Finding], demands: Sequence[Demand]) -> list[str]:
    """Sentences on outputs whose play alone takes them farther than their targets allow, where the spec sets no limit of play.

    Targets are judged in the middle of the play; half of it is on either side.
    """
    sentences = []
    for demand in demands:
        own = (demand.output, "")  # a single output is not named
        plays = [each for each in findings if each.code == "LASH" and each.where.output in own]
        worst = max(plays, key=lambda each: each.measured, default=None)
        asked = [
            (2 * each.tolerance, each.tolerance, each.code)
            for each in demand.targets
            if isinstance(each, Through | Trace | Lines | Function | Straight)
        ]
        asked += [
            (each.band, each.band, each.code) for each in demand.targets if isinstance(each, Dwell)
        ]
        if worst is None or not asked or demand.lash_of in _KEYS:
            continue
        most, written, code = min(asked)
        if worst.measured > most:
            sentences.append(
                f"{demand.output}: {code} is judged in the middle of the free play, which "
                f"lets it move {worst.measured / 2:.3g} {worst.unit} either way, more than the {written:g} asked for. "
                f"Set {_KEYS[worst.unit == 'deg']} to the play that you accept, or lower print.slide_clearance"
            )
    return sentences


def between(cams: Sequence[DiscCam[Any]], air: float, lash: float) -> list[Finding]:
    """LASH of a follower between two contacts of a disc cam, with so much air at each of the cams, mm; none without air.

    Its way to a contact is the air over the speed at which it leaves it, for 1 of its motion along the contact's normal.
    """
    if air <= 0:
        return []
    theta = np.linspace(0, math.tau, ANGLES)
    play: Floats = sum((air / _normal_speed(cam, theta) for cam in cams), np.zeros(theta.size))
    worst = int(np.argmax(play))
    unit, scale = unit_of_lift(cams[0])
    limit, reason = limit_of(lash, cams[0].program(theta))
    where = Where("follower", theta=float(theta[worst]), digits=1)
    remark = f"by {air:g} mm of clearance at each contact; {reason}"
    return [at_most("LASH", scale * float(play[worst]), scale * limit, unit, where, remark)]


def _normal_speed(cam: DiscCam[Any], theta: Floats) -> Floats:
    """How fast the follower leaves the cam along the normal of their contact, for 1 of its motion, (n,)."""
    turn = np.exp(1j * theta)
    s = cam.program(theta)
    velocity = cam.cutter.leaves * cam.cutter.velocity(s, cam.profile(theta) * turn)
    return np.asarray(np.abs(velocity) * np.cos(cam.pressure_angle_untrimmed(theta)))
