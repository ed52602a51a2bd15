"""The judge of cams: what a follower does on each measured outline, beside what comes out at the machine's outputs.

It knows nothing of the formulas that made the curve. s is the follower's displacement, rad, or mm where it slides.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from camgen import tolerances
from camgen.findings import Finding, Where, at_most
from camgen.geometry.rings import Ring, Shape
from camgen.judge.contact_faces import ArmFace, SlideFace
from camgen.judge.contact_tips import ArmTip, SlideTip
from camgen.judge.joints import Outline, PlateLaw, RollingLaw, measured_machine
from camgen.judge.measured import Files, Sections, read
from camgen.machine.features import CamOutline, Edge, Flat, Mount, OwnTip
from camgen.machine.model import Cam, Law, Machine
from camgen.numerics import Floats, magnitude
from camgen.study import Figure

_PLATE_WINDOW = 1.0  # mm of a plate's way, over which a speed is a mean


def judged_angles() -> Floats:
    """Cam angles at which motion is judged, rad: one at random in each of JUDGED_ANGLES equal steps, always the same ones."""
    n = tolerances.JUDGED_ANGLES
    return (np.arange(n) + np.random.default_rng(20181).random(n)) * (2 * math.pi / n)


def judged_places(law: RollingLaw | PlateLaw) -> Floats:
    """Angles of a cam, rad, or places of a plate, mm, at which a follower is judged."""
    return judged_angles() if isinstance(law, RollingLaw) else judged_way(law.span)


def judged_way(span: tuple[float, float]) -> Floats:
    """Places of a plate, (n,) mm, within its way."""
    low, high = span
    return np.asarray(low + (high - low) * judged_angles()[::4] / math.tau)


def s_unit(joint: Cam) -> tuple[str, float]:
    """What people read s in, and how many of it one unit of s is."""
    return ("deg", math.degrees(1)) if joint.slide is None else ("mm", 1.0)


def outline_law(joint: Cam, outline: Outline) -> Law:
    """s as the exact outline gives it, by the joint as it is meant."""
    return outline.feature.nominal.law or joint.law


def outline_and_law(
    machine: Machine,
    outline: CamOutline,
    mounts: Sequence[Mount],
    sections: Sections,
    shoe: Ring | None = None,
) -> tuple[Ring, RollingLaw | PlateLaw]:
    """The outline in a part's sections, about its bore in the part's frame, and what the follower rolls to on it; ValueError
    where it does not fit. A tip on another part counts as meant; shoe: the outline of one that is an edge, as meant."""
    tip = outline.tip
    files = {outline.part: sections}
    if isinstance(tip, Edge):
        files |= {tip.part: [[Shape(shoe, ())]]} if shoe is not None else {}
    elif tip.part not in (None, outline.part):
        mount = next(mount for mount in mounts if mount.part == tip.part)
        tip_on_body = replace(tip, part=None, at=mount.place(tip.at))
        outline = replace(
            outline,
            tip=replace(tip_on_body, facing=mount.direction(tip_on_body.facing))
            if isinstance(tip_on_body, Flat)
            else tip_on_body,
        )
    features = read([outline], files, False)
    law = measured_machine(machine, [outline], mounts, features).outlines[outline.joint][0].law
    away = 0j if outline.bore is None else features.eyes[outline.bore].centre
    return features.rings[outline].moved(shift=-away), law


def limit(law: RollingLaw | PlateLaw, off: float) -> float:
    """Largest error of s that an outline gives which is off by so much, mm, with spare for the second order."""
    return off * (1 + tolerances.BOUND_SPARE) / float(np.min(law.lever(judged_places(law))))


class FollowerOnOutline:
    """A follower on one outline over the turn, against what the exact one gives; off: mm, of outlines within the tolerance."""

    def __init__(self, joint: Cam, outline: Outline, where: Where, off: float) -> None:
        self.joint = joint
        self.outline = outline
        self.where = where
        self.theta = judged_places(outline.law)
        self.nominal = outline.feature.nominal
        self.touch = outline.law.contact.touch(self.theta)
        self.limit = limit(outline.law, off)
        self.unit, self.scale = s_unit(joint)
        self._law = outline_law(joint, outline)

    def place(self, k: int) -> Where:
        """The file, and the judged angle k."""
        if isinstance(self.outline.law, PlateLaw):
            return replace(self.where, theta=math.radians(float(self.theta[k])))
        return replace(self.where, theta=float(self.theta[k] + self.joint.phase))

    @property
    def pressure_angle(self) -> float:
        """The largest, deg; nan where the follower misses the outline."""
        return math.degrees(magnitude(self.touch.pressure_angle))

    def undercut(self) -> Finding | None:
        """UNDERCUT: what is lost of the wanted motion; None where the exact outline loses nothing."""
        wanted = self.joint.law(self.theta, 0)
        reachable = self._law(self.theta, 0)
        if not np.any(wanted != reachable):
            return None
        loss = np.where(wanted != reachable, np.abs(self.touch.angle - wanted), 0.0)
        worst = int(np.argmax(loss))
        return at_most(
            "UNDERCUT",
            self.scale * loss[worst],
            self.scale * (self.nominal.undercut + self.limit),
            self.unit,
            self.place(worst),
            "motion that undercut takes away in the file; the limit is that of the spec plus the outline tolerance",
        )

    def on_face(self) -> Finding | None:
        """FACE_WIDTH: how far contact runs off a face; None for a tip, or a face without an end."""
        face = self.outline.feature.tip
        if not isinstance(face, Flat) or math.isinf(face.width):
            return None
        place = self.touch.place
        overrun = np.abs(place - self.outline.law.middle) - face.width / 2
        worst = int(np.argmax(overrun))
        return at_most(
            "FACE_WIDTH",
            float(overrun[worst]),
            0.0,
            "mm",
            self.place(worst),
            f"contact beyond the face's end (below 0: short of it); it runs from {np.min(place):z.3f} to {np.max(place):z.3f} mm",
        )

    def ripple(self) -> Finding | None:
        """SPEED_RIPPLE: speed averaged over a window of cam angle, against the same average of what is reachable."""
        if math.isinf(self.nominal.ripple):
            return None
        theta = self.theta
        half = math.radians(tolerances.SPEED_WINDOW_DEG) / 2
        window = f"{tolerances.SPEED_WINDOW_DEG:g} deg of cam angle"
        if isinstance(self.outline.law, PlateLaw):
            low, high = self.outline.law.span
            half = min(_PLATE_WINDOW, high - low) / 2
            window = f"{2 * half:g} mm of the plate's way"
            theta = np.clip(theta, low + half, high - half)
        outline_and_law = self.outline.law.contact
        turn = outline_and_law.angle(theta + half) - outline_and_law.angle(theta - half)
        wanted_turn = self._law(theta + half, 0) - self._law(theta - half, 0)
        off = np.abs(turn - wanted_turn)
        worst = int(np.argmax(off))
        return at_most(
            "SPEED_RIPPLE",
            float(off[worst]) / magnitude(wanted_turn),
            self.nominal.ripple,
            "share",
            self.place(worst),
            f"share of the greatest speed, averaged over {window}; "
            "a smaller accuracy.chord_tolerance lowers it",
        )

    def findings(self) -> list[Finding]:
        """All of them, for an outline whose motion is right."""
        return [
            finding
            for finding in (self.undercut(), self.on_face(), self.ripple())
            if finding is not None
        ]


def _overlap(
    joint: Cam, drive: Outline, other: Outline, where: Where, off: float
) -> tuple[Finding, float]:
    """INTERFERENCE of a follower that two outlines hold, mm at its tips, and its largest play, rad or mm; the limit is what outlines
    that are off by so much, mm, may overlap. Of a pair with preload it is the overlap of tips that are smaller by that."""
    theta = judged_angles()
    play = drive.play(other, theta)
    largest = float(np.max(play))
    air_text = ""
    air = drive.feature.free
    if air > 0:
        air_text = f", each {air:g} mm off its tip in the wanted motion"
    elif air < 0:
        play = drive.feature.leaves * (other.law(theta) - drive.law(theta))
        air_text = f" beyond the preload, {-air:g} mm at each tip"
    least = int(np.argmin(play))
    there = theta[least : least + 1]
    # mm of both tips together for a mm or rad of the follower
    lever = 2 / sum(1 / float(law.lever(there)[0]) for law in (drive.tight, other.tight))
    finding = at_most(
        "INTERFERENCE",
        lever * max(0.0, -float(play[least])),
        2 * off * (1 + tolerances.BOUND_SPARE),
        "mm",
        replace(where, theta=float(theta[least] + joint.phase)),
        f"largest overlap of the follower with both outlines{air_text}; the limit is the tolerance of both outlines",
    )
    return finding, largest


@dataclass(frozen=True)
class CamVerdict:
    """Findings and figures of cams; sound: whether the motion that each outline gives by itself is right."""

    findings: Sequence[Finding]
    figures: Sequence[Figure]
    sound: bool


def named(where: Where, parts: Collection[str]) -> Where:
    """The files of one or two parts by their names, of more of them with the star."""
    names = [where.file.replace("*", part) for part in sorted(parts)]
    if "*" not in where.file or not 0 < len(names) < 3:
        return where
    return replace(where, file=" with ".join(names))


def judge_cams(
    files: Files,
    machine: Machine,
    measured: Mapping[str, Sequence[Outline]],
    off: float,
    sound: bool,
    motion: Callable[[Mapping[str, Outline], bool, Where], Finding],
) -> CamVerdict:
    """What followers do on each outline; what follows from a motion is only judged where that is right.

    measured: outlines by cam, the one that drives first; sound: whether the motion by these is right. motion: MOTION_ERROR of
    the machine on other outlines, with the tips that parts have or the nominal ones, and where it is said. off: mm, of
    outlines within the tolerance.
    """
    kind = files.kind
    where = files.where
    first = {cam: outlines[0] for cam, outlines in measured.items()}
    findings: list[Finding] = []
    figures: list[Figure] = []
    all_right = sound
    for cam, outlines in measured.items():
        joint = machine.cam(cam)
        name = "" if len(first) == 1 else cam
        (unit, scale) = s_unit(joint)
        right = dict[str, bool]()
        for outline in outlines:
            part = outline.feature.part
            if part in right:  # of a copy that is turned over, and of a second face, the play tells
                continue
            driven = first | {cam: outline}
            file = named(where, {part})
            drives = outline is first[cam]
            followed = FollowerOnOutline(joint, outline, file, off)
            if not drives:
                findings.append(motion(driven, False, file))
            right[part] = sound if drives else findings[-1].ok
            outline_findings = followed.findings() if right[part] else []
            findings += outline_findings
            if drives:
                steepest = followed.pressure_angle
                figures.append(Figure("pressure angle {of}", steepest, "deg", name, kind=kind))
                figures += [
                    Figure("undercut {of}", each.measured, unit, name, kind=kind)
                    for each in outline_findings
                    if each.code == "UNDERCUT"
                ]
            if outline.feature.own is not None:
                finding, own = _own_tip(
                    outline, outline.feature.own, where, motion(driven, True, file)
                )
                findings.append(finding)
                figures += [replace(each, of=name, kind=kind) for each in own]
        all_right &= all(right.values())
        figures += _tips(outlines)
        for other in outlines[1:] if right[first[cam].feature.part] else ():
            if right[other.feature.part]:
                parts = {first[cam].feature.part, other.feature.part}
                finding, play = _overlap(joint, first[cam], other, named(where, parts), off)
                findings.append(finding)
                quantity = "lash {of}" if play >= 0 else "preload {of}"
                figures.append(Figure(quantity, scale * abs(play), unit, name, kind=kind))
    return CamVerdict(findings, figures, all_right)


def _tips(outlines: Sequence[Outline]) -> list[Figure]:
    """Where a follower of several parts has its tips at s = 0, mm."""
    laws = ((each.feature.part, each.law) for each in outlines)
    rides = {part: law.contact.form for part, law in laws if isinstance(law, RollingLaw)}
    figures: list[Figure] = []
    for part, form in rides.items() if len(rides) > 1 else ():
        if isinstance(form, ArmTip | ArmFace):
            place = form.pivot + (
                form.arm if isinstance(form, ArmTip) else form.ahead * form.facing
            )
        elif isinstance(form, SlideTip | SlideFace):
            place = form.start
        if not getattr(form, "inside", False):
            name = part.replace("-", "_")
            figures.append(Figure("tip on {of} x", place.real, "mm", name))
            figures.append(Figure("tip on {of} y", place.imag, "mm", name))
    return figures


def _own_tip(
    outline: Outline, own: OwnTip, where: Where, motion: Finding
) -> tuple[Finding, list[Figure]]:
    """TIP_MOTION: the motion with the tip that a part has, which may be off by the tolerance as well."""
    file = named(where, {own.part})
    if outline.own is None:
        reason = "the part has no such tip, or it does not fit the cam"
        return at_most("TIP_MOTION", math.nan, 2 * motion.limit, motion.unit, file, reason), []
    form = None if isinstance(outline.own, PlateLaw) else outline.own.contact.form
    radius = getattr(form, "tip_radius", 0.0) - outline.feature.free
    what = "roller on the frame's pin" if own.radius is not None else "frame's own tip"
    remark = f"the {what}, radius {radius:z.4f} mm, on the cam, both from the files"
    finding = at_most(
        "TIP_MOTION",
        motion.measured,
        2 * motion.limit,
        motion.unit,
        replace(motion.where, file=file.file),
        remark,
    )
    return finding, [
        Figure("tip motion error {of}", motion.measured, motion.unit),
        Figure("tip radius {of}", radius, "mm"),
    ]
