"""Limits of a cam's exact profile: pressure angle, undercut, curvature, and room at the follower's axle.

[Norton, Cam Design and Manufacturing Handbook, ch. 7]
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from camgen.findings import Finding, at_least, at_most
from camgen.geometry.facets import facet_contour
from camgen.machine.cams.followers import SwingingArm, SwingingFace
from camgen.machine.cams.profile import DiscCam
from camgen.numerics import greatest

_BESIDE = 1e-9  # rad, to either side of where the pressure angle jumps


@dataclass(frozen=True)
class Allowed:
    """What the designer accepts: pressure angle, deg; loss of s by undercut, deg or mm; least radius of the convex profile, mm,
    None where any is; and what lowers the first two, for people."""

    pressure_angle: float
    undercut: float
    least_radius: float | None
    flatter: str
    wider: str


def steepest(cam: DiscCam[Any], low: float | None = None, high: float | None = None, riding: bool = True) -> float:
    """Largest pressure angle between two cam angles, deg, or over the turn; riding: on the corners of undercuts too.

    It jumps where the speed does and at an undercut's ends: they are looked at from either side.
    """
    corners = [float(b) for b in cam.program.corners]
    low, high = corners[0] if low is None else low, corners[-1] if high is None else high
    ends = [low + (end - low) % math.tau for cut in cam.undercuts for end in (cut.begin, cut.end)]
    marks = sorted({low, high, *(mark for mark in (*corners, *ends) if low < mark < high)})
    found = [
        greatest(cam.pressure_angle, a + _BESIDE, b - _BESIDE, cam.program.knots(a, b))[1]
        for a, b in pairwise(marks) if riding or not cam.riding((a + b) / 2)
    ]  # fmt: skip
    return math.degrees(max(found, default=0.0))


def lost(cams: Sequence[DiscCam[Any]]) -> dict[str, float]:
    """Numbers of what undercuts take: undercut_mm along the contact's path, and undercut_deg where the followers swing."""
    cuts = [cut for cam in cams for cut in cam.undercuts]
    numbers = {"undercut_mm": max((cut.depth for cut in cuts), default=0.0)}
    unit, scale = unit_of(cams[0])
    return {f"undercut_{unit}": scale * max((cut.shortfall for cut in cuts), default=0.0)} | numbers


def unit_of(cam: DiscCam[Any]) -> tuple[str, float]:
    """What people read s in, and how many of it one unit of s is."""
    swings = isinstance(cam.follower, SwingingArm | SwingingFace)
    return ("deg", math.degrees(1)) if swings else ("mm", 1.0)


def cam_limits(
    where: str, cam: DiscCam[Any], pressure_angle: float, allowed: Allowed, chord_tolerance: float | None = None
) -> list[Finding]:
    """PRESSURE_ANGLE (the given one, deg), UNDERCUT, CURVATURE, and INTERFERENCE with the axle of a follower that swings.

    chord_tolerance: mm, of the facets that must clear the axle; None where that is a body like all others, or on another level.
    """
    unit, scale = unit_of(cam)
    findings = [at_most("PRESSURE_ANGLE", pressure_angle, allowed.pressure_angle, "deg", where, f"{allowed.flatter} lowers it")]
    shortfall = scale * max((cut.shortfall for cut in cam.undercuts), default=0.0)
    depth = max((cut.depth for cut in cam.undercuts), default=0.0)
    spans = "; ".join(f"cam angle {math.degrees(c.begin):.3f} to {math.degrees(c.end):.3f} deg" for c in cam.undercuts)
    findings.append(
        at_most("UNDERCUT", shortfall, allowed.undercut, unit, f"{where}, {spans}" if spans else where,
                f"the follower falls short there by {shortfall:.4g} {unit} ({depth:.4g} mm on the contact's path), as the spec "
                f"implies; {allowed.wider} lowers it" if shortfall else "the follower makes the whole motion")
    )  # fmt: skip
    if allowed.least_radius is not None:
        findings.append(
            at_least("CURVATURE", cam.least_radius, allowed.least_radius, "mm", where,
                     "least radius of curvature of the convex profile; below 0 it is undercut, "
                     "which a limits.least_radius below 0 accepts")
        )  # fmt: skip
    if chord_tolerance is not None and isinstance(cam.follower, SwingingArm | SwingingFace):
        axle = abs(cam.follower.pivot)
        reach = float(np.max(np.abs(facet_contour(cam.outline, chord_tolerance))))
        findings.append(
            at_least("INTERFERENCE", axle - reach, 0.0, "mm", f"{where} and the follower's axle",
                     f"the cam reaches {reach:.2f} mm from its shaft, the axle stands at {axle:g} mm")
        )  # fmt: skip
    return findings
