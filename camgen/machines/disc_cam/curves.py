"""Curves of a disc cam over its turn, and the segments of its program, for the report."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from camgen.machine.cams.followers import Follower, SlidingFace, SlidingTip, SwingingFace
from camgen.machine.cams.profile import DiscCam, SwingingArm
from camgen.motion.program import Program
from camgen.numerics import Floats
from camgen.study import Figure, Plot, Sketch, Table

_BANDS = (0.0, 10.0, 20.0, 30.0, 45.0, 90.0)  # deg, of the pressure angle along the profile


def _angles(program: Program) -> Floats:
    """Cam angles of the curves, just before each break too, (n,) rad."""
    return np.union1d(np.linspace(0, math.tau, 1441), [b - 1e-9 for b in program.breaks if b > 0])


def motion_plots(program: Program, of: tuple[str, float], speed: float) -> list[Plot]:
    """The wanted motion with three derivatives to time; of: its unit, and how many of it make a mm or rad; speed: rad/s."""
    unit, scale = of
    theta = _angles(program)
    degrees = np.degrees(theta)
    label = "cam angle, deg"
    names = ("Displacement", "Velocity", "Acceleration", "Jerk")
    units = (unit, f"{unit}/s", f"{unit}/s^2", f"{unit}/s^3")
    marks = [
        (s.kind, math.degrees(at)) for s, at in zip(program.segments, program.joints, strict=False)
    ]
    return [
        Plot(name, label, text, [("wanted", degrees, scale * speed**k * program(theta, k))], marks)
        for k, (name, text) in enumerate(zip(names, units, strict=True))
    ]


def plots(
    program: Program,
    cams: Sequence[DiscCam[Follower]],
    who: Sequence[str],
    of: tuple[str, float],
    speed: float,
    base: float,
) -> tuple[Plot, ...]:
    """The wanted motion with three derivatives to time, pressure angle and curvature, and the profile coloured by the former.

    who: names of the cams; of: the output's unit, and how many of it make a mm or rad; speed: rad/s; base: radius, mm.
    """
    theta = _angles(program)
    degrees = np.degrees(theta)
    label = "cam angle, deg"
    steep = [np.degrees(cam.pressure_angle(theta)) for cam in cams]
    pressure = Plot(
        "Pressure angle",
        label,
        "deg",
        [(name, degrees, y) for name, y in zip(who, steep, strict=True)],
    )
    radius = np.clip(cams[0].radius(theta), -10 * base, 10 * base)
    curvature = Plot(
        "Radius of curvature", label, "mm", [("profile, cut off at 10 base radii", degrees, radius)]
    )
    z = np.where(
        cams[0].reachable(theta) == program(theta), cams[0].profile(theta), np.nan
    )  # less what is cut off
    coloured = [
        (f"{a:g} to {b:g} deg", z.real, np.where((steep[0] >= a) & (steep[0] <= b), z.imag, np.nan))
        for a, b in pairwise(_BANDS)
        if np.any((steep[0] >= a) & (steep[0] <= b))
    ]
    return (
        *motion_plots(program, of, speed),
        pressure,
        curvature,
        Plot("Profile, by pressure angle", "x, mm", "y, mm", coloured, equal=True),
    )


def segments_table(program: Program, of: tuple[str, float]) -> Table:
    """Segments with their ends in the output's unit, and their laws."""
    unit, scale = of
    columns = (
        "segment",
        "from, deg",
        "to, deg",
        f"from, {unit}",
        f"to, {unit}",
        "law",
        "C_v",
        "C_a",
        "C_j",
    )
    rows: list[list[object]] = []
    for s, begin in zip(program.segments, program.joints, strict=False):
        law = [s.law.name, s.law.c_v, s.law.c_a, s.law.c_j] if s.scale else ["", "", "", ""]
        ends = [math.degrees(begin), math.degrees(begin + s.span), scale * s.start, scale * s.end]
        rows.append([s.kind, *ends, *law])
    return Table("Program", columns, rows)


def sketch(
    cams: Sequence[DiscCam[Follower]], base_radius: float, face_width: float | None
) -> Sketch:
    """The follower at s = 0, in the frame that its pose moves: the ground's, or one at the pivot."""
    strokes = []
    circles = []
    for cam in cams:
        match cam.follower:
            case SlidingTip(start, along, radius, leaves):
                strokes.append(np.array([start, start + leaves * along * base_radius]))
                circles.append((start, radius))
            case SwingingArm(_, arm, radius, _):
                strokes.append(np.array([0, arm]))
                circles.append((arm, radius))
            case SlidingFace(start, along, leaves):
                half = (face_width or 2 * max(map(abs, cam.face_contact))) / 2
                strokes += [
                    np.array([start - half, start + half]),
                    np.array([start, start + leaves * along * base_radius]),
                ]
            case SwingingFace(_, facing, ahead):
                low, high = cam.face_contact
                strokes.append(facing * (ahead + 1j * np.array([low, 0, high])))
    return Sketch("follower", strokes, [(z, r) for z, r in circles if r], "follower")


def peak_figures(program: Program, of: tuple[str, float], speed: float) -> list[Figure]:
    """Greatest speed and acceleration of a follower; of: its unit and scale, speed: of the drive, rad/s."""
    unit, scale = of
    speeds = (("peak speed", 1, "s"), ("peak acceleration", 2, "s²"))
    return [
        Figure(name, scale * abs(speed) ** k * program.peak(k), f"{unit}/{per}")
        for name, k, per in speeds
    ]
