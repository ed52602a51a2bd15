"""The judge of motion: followers rolled on the shapes that were read, against the wanted motion.

It knows nothing of the formulas that made the curve. The part turns about the centre of the bore that is in the file, since
that is where the shaft will be.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from camgen import tolerances
from camgen.findings import Finding, at_most
from camgen.geometry.rings import Shape, bore_circle, fit_circle
from camgen.judge.contact import RollingContact, contact
from camgen.judge.contact_faces import ArmFace, SlideFace
from camgen.judge.contact_tips import ArmTip, Form, SlideTip
from camgen.machine.contacts import Rolling

Floats = NDArray[np.float64]
Motion = Callable[[Floats], Floats]


def judged_angles() -> Floats:
    """Cam angles at which motion is judged, rad: one at random in each of JUDGED_ANGLES equal steps, always the same ones."""
    n = tolerances.JUDGED_ANGLES
    return (np.arange(n) + np.random.default_rng(20181).random(n)) * (2 * math.pi / n)


def mounted(shape: Shape, rolling: Rolling) -> RollingContact:
    """The follower of `rolling` in contact with a recovered shape, mounted as in assembly.

    ValueError where the shape has no such outline, or the follower does not fit it.
    """
    ring = shape.outer
    if rolling.inside:
        if not shape.holes:
            raise ValueError("there is no hole for the follower to run in")
        ring = max(shape.holes, key=lambda hole: abs(hole.area)).counter_clockwise().reversed()
    if rolling.flipped:
        ring = ring.moved(-1, mirror=True)
    if rolling.turned:
        ring = ring.moved(complex(math.cos(rolling.turned), math.sin(rolling.turned)))
    return contact(ring, _form(rolling))


def _form(r: Rolling) -> Form:
    if r.face is None:
        tip = SlideTip if r.slides else ArmTip
        return tip(r.pivot, r.arm, r.tip_radius, r.leaves, r.inside)
    if r.slides:
        return SlideFace(r.pivot, r.arm, r.leaves)
    return ArmFace(r.pivot, r.face, (complex(r.face).conjugate() * r.arm).real, r.leaves)


def motion_limit(rolling: Rolling, chord_tolerance: float, kind: str) -> float:
    """Largest motion error, in units of s, that an outline within the tolerance can give, 5 % spare; plus float32 for meshes."""
    lever = rolling.lever or abs(rolling.arm) * math.cos(rolling.pressure_angle)
    limit = chord_tolerance / lever * (1 + tolerances.BOUND_SPARE)
    if kind == "dxf":
        return limit
    rounding = tolerances.FLOAT32_ROUNDING * math.sqrt(2) * (abs(rolling.pivot) + abs(rolling.arm)) / lever
    least = tolerances.FLOAT32_MOTION_MM if rolling.slides else math.radians(tolerances.FLOAT32_MOTION_DEG)
    return limit + max(least, rounding)


def judge_motion(
    kind: str,
    where: str,
    shape: Shape,
    rollings: Sequence[Rolling],
    wanted: Motion,
    reachable: Motion,
    chord_tolerance: float,
) -> tuple[list[Finding], dict[str, float]]:
    """Roll the followers on a recovered shape; compare with the reachable motion: the wanted one less the spec's undercut.

    Returns findings and the recovered figures. What follows from the motion is only judged where the motion is right.
    """
    drive, theta = rollings[0], judged_angles()
    limit, (unit, scale) = motion_limit(drive, chord_tolerance, kind), drive.unit
    reachable = drive.reachable or reachable
    try:
        rolled = mounted(shape, drive)
    except ValueError as fault:
        return [at_most("MOTION_ERROR", math.nan, scale * limit, unit, where, str(fault))], {}
    meant, touch = reachable(theta), rolled.touch(theta)
    corners = rolled.changes
    every = np.concatenate([theta, corners])
    off = np.abs(np.concatenate([touch.angle - meant, rolled.angle(corners) - reachable(corners)]))
    lost = np.isnan(off)
    error = np.where(lost, np.inf, off)
    worst = int(np.argmax(error))
    did = "tip rolled" if drive.face is None else "face slid"
    remark = f"{did} on the file at {len(theta)} cam angles, and at each corner of the outline"
    if lost.any():
        remark += f"; it misses the outline at {np.count_nonzero(lost)} of them"
    if not error[worst] <= limit:
        remark += "; what follows from a wrong motion is not judged"
    findings = [
        at_most(
            "MOTION_ERROR",
            scale * error[worst],
            scale * limit,
            unit,
            _place(where, every[worst]),
            remark,
        )
    ]
    numbers = {
        f"{'stroke' if drive.slides else 'swing'}_recovered_{kind}_{unit}": scale * float(np.ptp(touch.angle)),
        f"motion_error_{kind}_{unit}": scale * float(error[worst]),
        f"pressure_angle_{kind}_deg": math.degrees(float(np.max(np.abs(touch.pressure_angle)))),
    }
    if not findings[0].ok:
        return findings, numbers
    asked = wanted(theta)
    if np.any(asked != meant):
        loss = np.where(asked != meant, np.abs(touch.angle - asked), 0.0)
        worst = int(np.argmax(loss))
        numbers[f"undercut_{kind}_{unit}"] = scale * float(loss[worst])
        findings.append(
            at_most(
                "UNDERCUT",
                scale * loss[worst],
                scale * (drive.undercut + limit),
                unit,
                _place(where, theta[worst]),
                "motion that the file loses where it is undercut; the limit is the spec's and the outline tolerance",
            )
        )
    if drive.reach is not None:
        findings.append(_on_face(where, theta, touch.place, drive.reach))
    findings.append(_ripple(rolled, where, theta, reachable, drive.speed_ripple))
    for other in rollings[1:]:
        play = drive.leaves * (mounted(shape, other).angle(theta) - touch.angle)
        findings += _free_play(where, theta, play, drive, 2 * limit)
        numbers[f"lash_{kind}_{unit}"] = scale * float(np.max(play))
    return findings, numbers


def judge_pair(
    kind: str, where: str, shapes: tuple[Shape, Shape], rollings: tuple[Rolling, Rolling], chord_tolerance: float
) -> tuple[list[Finding], dict[str, float]]:
    """LASH and INTERFERENCE of a follower between two parts, each with its own contact: a pair of cams, or a groove's walls.

    In a groove both walls touch the one tip that drives. Only for parts whose own motion holds.
    """
    drive, other = rollings
    if other.inside:
        other = replace(other, tip_radius=drive.tip_radius)
    theta, (unit, scale) = judged_angles(), drive.unit
    play = drive.leaves * (mounted(shapes[1], other).angle(theta) - mounted(shapes[0], drive).angle(theta))
    overlap = sum(motion_limit(rolling, chord_tolerance, kind) for rolling in rollings)
    return _free_play(where, theta, play, drive, overlap), {f"lash_{kind}_{unit}": scale * float(np.max(play))}


def judge_tip(
    kind: str, where: str, frame: Shape, cam: Shape, rolling: Rolling, reachable: Motion, chord_tolerance: float
) -> tuple[list[Finding], dict[str, float]]:
    """Roll the tip that is in the frame's file on the cam that is in its file: TIP_MOTION of the two together.

    frame: with its pivot's hole at the origin. A roller on a pin counts with its nominal radius about the hole in the file.
    The limit is that of the outline tolerance at both.
    """
    ring = frame.outer.facetted(chord_tolerance / 4)
    away = np.abs(ring - rolling.arm)
    if rolling.seat:
        hole = min(frame.holes, key=lambda hole: abs(hole.centroid - rolling.arm)) if frame.holes else frame.outer
        arm, radius = bore_circle(hole, rolling.seat).centre, rolling.tip_radius
    elif rolling.tip_radius:
        near = ring[np.abs(away - rolling.tip_radius) < 0.02 * rolling.tip_radius + 4 * chord_tolerance]
        arm, radius, _ = fit_circle(near) if len(near) > 2 else (complex(math.nan), math.nan, 0.0)
    else:
        arm, radius = complex(ring[np.argmin(away)]), 0.0
    limit = 2 * motion_limit(rolling, chord_tolerance, kind)
    theta = judged_angles()[::4]
    worst, error = 0, np.array([math.inf])
    if math.isfinite(radius) and abs(arm - rolling.arm) < abs(rolling.arm) / 2:
        tip = replace(rolling, arm=arm, tip_radius=radius)
        # the wanted angle is counted from the nominal arm
        turned = float(np.angle(rolling.arm / arm))
        error = np.abs(mounted(cam, tip).angle(theta) - turned - reachable(theta))
        error = np.where(np.isnan(error), np.inf, error)
        worst = int(np.argmax(error))
    own = "roller on the frame's pin" if rolling.seat else "frame's own tip"
    remark = f"the {own}, radius {radius:.4f} mm, on the cam, both from the files"
    finding = at_most(
        "TIP_MOTION", math.degrees(error[worst]), math.degrees(limit), "deg", _place(where, theta[worst]), remark
    )
    return [finding], {f"tip_motion_error_{kind}_deg": math.degrees(error[worst]), f"tip_radius_{kind}_mm": radius}


def _place(where: str, theta: float) -> str:
    return f"{where}, cam angle {math.degrees(theta):.3f} deg"


def _on_face(where: str, theta: Floats, place: Floats, reach: tuple[float, float]) -> Finding:
    """How far contact runs off a face."""
    beyond = np.maximum(place - reach[1], reach[0] - place)
    worst = int(np.argmax(np.where(np.isnan(beyond), np.inf, beyond)))
    return at_most(
        "FACE_WIDTH", float(beyond[worst]), 0.0, "mm", _place(where, theta[worst]),
        f"contact beyond the face's end (below 0: short of it); it runs from {np.min(place):.3f} to {np.max(place):.3f} mm",
    )  # fmt: skip


def _free_play(where: str, theta: Floats, play: Floats, drive: Rolling, overlap: float) -> list[Finding]:
    """Free play of the follower between two tips: not too much, and nowhere less than nothing."""
    most, least = int(np.argmax(play)), int(np.argmin(play))
    unit, scale = drive.unit
    return [
        at_most(
            "LASH",
            scale * play[most],
            scale * drive.lash,
            unit,
            _place(where, theta[most]),
            "largest free play of the follower between both tips",
        ),
        at_most(
            "INTERFERENCE",
            scale * max(0.0, -play[least]),
            scale * overlap,
            unit,
            _place(where, theta[least]),
            "largest overlap of both tips with the pair; the limit is the outline tolerance at both tips",
        ),
    ]


def _ripple(rolled: RollingContact, where: str, theta: Floats, reachable: Motion, limit: float) -> Finding:
    """Speed averaged over a window of cam angle, against the same average of the reachable motion."""
    half = math.radians(tolerances.SPEED_WINDOW_DEG) / 2
    made = rolled.angle(theta + half) - rolled.angle(theta - half)
    meant = reachable(theta + half) - reachable(theta - half)
    off = np.abs(made - meant)
    worst = int(np.argmax(np.where(np.isnan(off), np.inf, off)))
    return at_most(
        "SPEED_RIPPLE", float(off[worst]) / float(np.max(np.abs(meant))), limit, "share",
        f"{where}, cam angle {math.degrees(theta[worst]):.3f} deg",
        f"of the greatest speed, averaged over {tolerances.SPEED_WINDOW_DEG:g} deg of cam angle; "
        "facets make raw speed ripple as 1/N, and a smaller chord_tolerance lowers it",
    )  # fmt: skip
