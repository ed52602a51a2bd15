"""What a cam joint is held to, by whatever spec it comes: one set of checks on its exact profile, one set of defaults.

    PRESSURE_ANGLE, UNDERCUT, CURVATURE   of each of the joint's cams
    MOTION_JUMP                           of the follower's program
    TABLE_ROUNDING                        of a program with a table
    FACE_WIDTH                            of a flat face whose width is given
    INTERFERENCE                          of cams alone, with the axle of a follower that swings

[Norton, Cam Design and Manufacturing Handbook, ch. 7]
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from camgen.findings import Finding, Where, at_least, at_most
from camgen.geometry.facets import facet_contour
from camgen.machine.cams.followers import SwingingArm, SwingingFace
from camgen.machine.cams.linear import LinearCam
from camgen.machine.cams.profile import DiscCam
from camgen.machine.cams.shoes import SwingingShoe
from camgen.motion.program import Program
from camgen.numerics import magnitude
from camgen.study import Figure, Figures

# deg, that a pressure angle may reach by usual advice
SLIDE_PRESSURE = 30.0
ARM_PRESSURE = 45.0
_ORDERS = ("displacement", "velocity", "acceleration", "jerk")
_MOST_JUMPS = 6  # that a message lists


# Least share of a spring's force that presses a follower on its cam: it is 1.2 to 2 times what would lift the follower off
# [co-design.co.uk, SEED Unit Design, Cam mechanisms, section 15: Force closure]
RESERVE = 0.17


@dataclass(frozen=True)
class CamLimits:
    """What a designer accepts of a cam joint."""

    pressure_angle: float | None = None  # deg; None: the usual one of its follower
    undercut: float = 0.0  # loss of s, mm or rad
    least_radius: float = (
        0.0  # mm, of the convex profile; below 0 an undercut one is accepted, down to that radius
    )
    ripple: float = 0.01  # of the speed, as a share of the greatest
    rounding: float = 0.1  # of a table's rows, as a share of its greatest acceleration
    continuous: int = 2  # highest derivative of s that must not jump; -1: no check

    def steepest(self, cam: DiscCam[Any] | LinearCam) -> float:
        """The pressure angle that this cam may reach, deg."""
        if self.pressure_angle is not None:
            return self.pressure_angle
        return ARM_PRESSURE if swings(cam) else SLIDE_PRESSURE


@dataclass(frozen=True)
class Advice:
    """What a person can change, by the keys of the spec that the joint comes from."""

    flatter: str  # lowers the pressure angle
    wider: str  # lowers the undercut
    smoother: str = "a law that ends smoother, or 'matched', joins them"


@dataclass(frozen=True)
class MotionLimits:
    """What a cam's follower may do at the machine's speed, in mm or deg and s; None where nothing is said."""

    velocity: float | None = None
    acceleration: float | None = None
    jerk: float | None = None
    frequency_ratio: float | None = None  # least, of its own frequency to that of its cam's turns

    @property
    def orders(self) -> tuple[float | None, float | None, float | None]:
        """Of the first, second and third derivative to time."""
        return self.velocity, self.acceleration, self.jerk


@dataclass(frozen=True)
class ExactCam:
    """One cam of a joint before it is made."""

    where: str  # its name in findings
    cam: DiscCam[Any]
    advice: Advice


def swings(cam: DiscCam[Any] | LinearCam) -> bool:
    """Whether its follower turns about a pivot."""
    return isinstance(cam.follower, SwingingArm | SwingingFace | SwingingShoe)


def unit_of(cam: DiscCam[Any] | LinearCam) -> tuple[str, float]:
    """What people read s in, and how many of it one unit of s is."""
    return ("deg", math.degrees(1)) if swings(cam) else ("mm", 1.0)


def undercut_numbers(cams: Sequence[DiscCam[Any]]) -> Figures:
    """What undercuts take: undercut_mm along the contact's path, and undercut_deg where the followers swing."""
    cuts = [cut for cam in cams for cut in cam.undercuts]
    depth = max((cut.depth for cut in cuts), default=0.0)
    unit, scale = unit_of(cams[0])
    shortfall = scale * max((cut.shortfall for cut in cuts), default=0.0)
    return Figures([Figure("undercut", shortfall, unit), Figure("undercut", depth, "mm")])


def cam_findings(
    cams: Sequence[ExactCam],
    limits: CamLimits,
    program: str = "program",
    face_width: float | None = None,
    chord_tolerance: float | None = None,
) -> list[Finding]:
    """All findings of one joint, as the head of this file lists them.

    cams: the one that drives first; program: its name in findings; face_width: of a flat follower, mm, None where it has
    no end; chord_tolerance: mm, of the facets that must clear the axle, None where the axle is a body like all others.
    """
    findings = [finding for each in cams for finding in _profile(each, limits, chord_tolerance)]
    if face_width is not None:
        findings.append(_face_width(cams, face_width))
    first = cams[0]
    smoother = first.advice.smoother
    return [
        *findings,
        *program_findings(first.cam.program, unit_of(first.cam), limits, smoother, program),
    ]


def edge_findings(cam: LinearCam, limits: CamLimits, where: str, flatter: str) -> list[Finding]:
    """PRESSURE_ANGLE and CURVATURE of a plate's edge; flatter: what lowers the angle and widens the edge, by the keys of the spec."""
    steep = limits.steepest(cam)
    curved = f"least radius of the convex edge; {flatter} makes it larger"
    return [
        at_most("PRESSURE_ANGLE", cam.steepest, steep, "deg", Where(where), f"{flatter} lowers it"),
        at_least("CURVATURE", cam.least_radius, limits.least_radius, "mm", Where(where), curved),
    ]


def program_findings(
    program: Program,
    of: tuple[str, float],
    limits: CamLimits,
    smoother: str,
    where: str = "program",
) -> list[Finding]:
    """TABLE_ROUNDING and MOTION_JUMP of a follower's program; of: what people read s in, and how many of it one unit of s is."""
    findings = _rounding(program, limits.rounding, where)
    if limits.continuous >= 0:
        findings.append(_jumps(program, of, limits.continuous, smoother, where))
    return findings


def _profile(exact: ExactCam, limits: CamLimits, chord_tolerance: float | None) -> list[Finding]:
    """What is judged of each cam by itself."""
    cam = exact.cam
    where = exact.where
    advice = exact.advice
    unit, scale = unit_of(cam)
    shortfall = scale * max((cut.shortfall for cut in cam.undercuts), default=0.0)
    depth = max((cut.depth for cut in cam.undercuts), default=0.0)
    spans = "; ".join(
        f"cam angle {math.degrees(cut.begin):.3f} to {math.degrees(cut.end):.3f} deg"
        for cut in cam.undercuts
    )
    short = (
        f"the follower falls short there by {shortfall:.4g} {unit} ({depth:.4g} mm on the contact's path), as the spec "
        f"implies; {advice.wider} lowers it"
    )
    curved = f"{advice.wider} makes it larger"
    if -math.inf < cam.least_radius < 0:
        curved = f"the profile is undercut; {advice.wider} helps"
    findings = [
        at_most(
            "PRESSURE_ANGLE",
            cam.steepest,
            limits.steepest(cam),
            "deg",
            Where(where, theta=cam.steepest_at if cam.steepest else None),
            f"{advice.flatter} lowers it",
        ),
        at_most(
            "UNDERCUT",
            shortfall,
            scale * limits.undercut,
            unit,
            Where(f"{where}, {spans}" if spans else where),
            short if shortfall else "the follower makes the whole motion",
        ),
        at_least(
            "CURVATURE",
            cam.least_radius,
            limits.least_radius,
            "mm",
            Where(where),
            f"least radius of curvature of the convex profile; {curved}",
        ),
    ]
    if chord_tolerance is not None and swings(cam):
        axle = abs(cam.follower.pivot)
        reach = magnitude(facet_contour(cam.outline, chord_tolerance))
        message = (
            f"the cam reaches {reach:.2f} mm from its shaft, the follower's pivot is at {axle:g} mm"
        )
        findings.append(
            at_least(
                "INTERFERENCE",
                axle - reach,
                0.0,
                "mm",
                Where(f"{where} and the follower's pivot"),
                message,
            )
        )
    return findings


def _face_width(cams: Sequence[ExactCam], width: float) -> Finding:
    """FACE_WIDTH: a face that slides reaches as far to either side of its stem, one on an arm lies about what is touched."""
    necessary = 0.0
    for each in cams:
        low, high = each.cam.face_contact
        necessary = max(necessary, high - low if swings(each.cam) else 2 * max(-low, high))
    return at_most(
        "FACE_WIDTH",
        necessary,
        width,
        "mm",
        Where(cams[0].where),
        "width of the face that the cam touches",
    )


def _rounding(program: Program, most: float, where: str) -> list[Finding]:
    """TABLE_ROUNDING: what the last digit of a table's rows makes of its acceleration; nothing without a table."""
    tables = [s.law for s in program.segments if s.scale and s.law.rounding]
    if not tables:
        return []
    message = (
        "error of the acceleration that the last digit of the table's rows can cause, as a share of the greatest; more digits, fewer rows or, "
        "over 360 deg, law.tolerance lowers it"
    )
    share = max(law.rounding for law in tables)
    return [at_most("TABLE_ROUNDING", share, most, "1", Where(where), message)]


def _jumps(
    program: Program, of: tuple[str, float], highest: int, smoother: str, where: str
) -> Finding:
    """MOTION_JUMP: how many jumps there are, up to a derivative of the displacement."""
    unit, scale = of
    units = (unit, f"{unit}/rad", f"{unit}/rad^2", f"{unit}/rad^3")
    jumps = program.discontinuities(highest)
    places = "; ".join(
        f"{_ORDERS[jump.order]} at {math.degrees(jump.theta):.3f} deg by {jump.size * scale:.4g} {units[jump.order]}"
        for jump in jumps[:_MOST_JUMPS]
    )
    more = f"; and {len(jumps) - _MOST_JUMPS} more" if len(jumps) > _MOST_JUMPS else ""
    lower = ", ".join(_ORDERS[:highest])
    orders = f"{lower} and {_ORDERS[highest]}" if lower else _ORDERS[highest]
    message = f"{places}{more}; {smoother}" if jumps else f"no jump of {orders}"
    return at_most("MOTION_JUMP", len(jumps), 0, "jumps", Where(where), message)
