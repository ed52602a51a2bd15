"""The judge: what the written files themselves say, against the wanted motion and the plain numbers of the parts.

It reads files, rolls tips on what it read, and knows nothing of the formulas that made the curve. The part turns about the
centre of the bore that is in the file, since that is where the shaft will be.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from camgen import tolerances
from camgen.contact import RollingContact, contact
from camgen.contact_faces import ArmFace, SlideFace
from camgen.contact_tips import ArmTip, Form, SlideTip
from camgen.distances import thinnest_wall
from camgen.findings import Finding, at_least, at_most
from camgen.mechanism import Rolling
from camgen.readback import (
    Circle,
    Ring,
    Shape,
    bore_circle,
    mesh_faults,
    read_3mf,
    read_dxf,
    read_stl,
    shape_of,
    slice_mesh,
)
from camgen.rings import fit_circle
from camgen.undoing import printed

Floats = NDArray[np.float64]
Motion = Callable[[Floats], Floats]

MILLIMETRES = 4  # $INSUNITS of DXF
MOTION_KINDS = ("dxf", "stl", "3mf")
_WALL_FACETS = 0.001  # mm, chord tolerance at which walls between arcs are measured


@dataclass(frozen=True)
class Section:
    """What a cut through some heights should show: as many separate pieces, of this area together (mm^2), with these holes.

    heights: where meshes are sliced, mm; holes: centre (complex, mm) and area (mm^2) of each; length: of all edges, mm.
    """

    heights: tuple[float, ...]
    pieces: int
    holes: tuple[tuple[complex, float], ...]
    area: float
    length: float


@dataclass(frozen=True)
class Expected:
    """What a part's files should hold, as plain numbers.

    sections: of its stack of layers, from the bottom; cut: the one that its drawing shows; volume: mm^3; bore: diameter of
    the hole on whose centre the part turns; eyes: centres of holes whose place and size the judge of linkages sees to;
    undo: how a mesh was changed for the printer, None where it was not.
    """

    part: str
    sections: tuple[Section, ...]
    cut: int
    volume: float
    facets: float
    bore: float | None
    eyes: tuple[complex, ...]
    min_wall: float
    chord_tolerance: float
    undo: Undo | None = None


@dataclass(frozen=True)
class Undo:
    """What the printer does to a mesh that was sent to it, see `undoing.printed`; files are judged as they print, mm."""

    hole: float
    profile: float
    shrinkage: float

    def __call__(self, shape: Shape) -> Shape:
        """A recovered shape as it is in print; ValueError where a ring vanishes."""
        return printed(shape, self.hole, self.profile, self.shrinkage)


@dataclass(frozen=True)
class Judged:
    """Findings on one file, and what was read from it; nothing where it could not be recovered.

    shape: the piece that a tip rolls on, its bore at the origin; sections: the pieces at each height, as in the file.
    """

    findings: tuple[Finding, ...]
    shape: Shape | None
    bore: Circle | None = None
    sections: tuple[tuple[Shape, ...], ...] = ()


def judge_dxf(path: Path, expected: Expected) -> Judged:
    """Units, closed contours, holes and walls of a drawing that is to be cut."""
    drawing, where = read_dxf(path), path.name
    units = drawing.units or 0
    closed = at_most(
        "DXF_CLOSED", len(drawing.faults), 0, "contours", where,
        "; ".join(f.message for f in drawing.faults) or f"{len(drawing.cut)} contours, each one closed entity",
    )  # fmt: skip
    findings = [
        Finding("DXF_UNITS", units == MILLIMETRES, units, MILLIMETRES, "$INSUNITS", where,
                "drawn in millimetres" if units == MILLIMETRES else "the header does not say millimetres (4)"),
        closed,
    ]  # fmt: skip
    if not closed.ok:
        return Judged(tuple(findings), None)
    return _judge_sections([(expected.sections[expected.cut], drawing.cut)], expected, where, 0.0, findings)


def judge_mesh(path: Path, expected: Expected) -> Judged:
    """Watertightness, volume, sections and walls of a solid in an STL or 3MF file."""
    where = path.name
    if path.suffix == ".3mf":
        package = read_3mf(path)
        meshes = [package.meshes[item.name].moved(item.transform) for item in package.items]
        remarks = [*package.warnings, *([] if package.unit.lower() == "millimeter" else [f"unit is {package.unit}"])]
        remarks += [] if len(meshes) == 1 else [f"{len(meshes)} objects instead of 1"]
        if remarks:
            return Judged((at_most("ROUND_TRIP", len(remarks), 0, "warnings", where, "; ".join(remarks)),), None)
        mesh = meshes[0]
    else:
        mesh = read_stl(path)
    faults = mesh_faults(mesh)
    count = faults.count + abs(faults.bodies - 1)
    findings = [
        at_most(
            "WATERTIGHT", count, 0, "faults", where,
            f"{faults.open_edges} open, {faults.flipped_edges} flipped, {faults.crowded_edges} crowded edges, "
            f"{faults.degenerate} degenerate triangles, {faults.bodies} body(ies) of {len(mesh.faces)} triangles",
        )
    ]  # fmt: skip
    if count:
        return Judged(tuple(findings), None)
    findings.append(_volume(faults.volume, expected, where))
    size = float(np.max(np.abs(mesh.vertices[:, :2])))
    try:
        sections = [(section, slice_mesh(mesh, z)) for section in expected.sections for z in section.heights]
    except ValueError as error:
        findings.append(at_most("ROUND_TRIP", math.nan, 0, "mm", where, str(error)))
        return Judged(tuple(findings), None)
    return _judge_sections(sections, expected, where, size * tolerances.FLOAT32_ROUNDING, findings, expected.undo)


def _volume(volume: float, expected: Expected, where: str) -> Finding:
    limit = tolerances.VOLUME_SHARE * expected.volume + expected.facets
    return at_most(
        "VOLUME", abs(volume - expected.volume), limit, "mm^3", where,
        f"{volume:.3f} mm^3 in the file, {expected.volume:.3f} mm^3 by Green's theorem on the exact outline",
    )  # fmt: skip


def _judge_sections(
    read: Sequence[tuple[Section, Sequence[Ring]]], expected: Expected, where: str, rounding: float,
    findings: list[Finding], undo: Undo | None = None,
) -> Judged:
    """Whether every section holds the contours that were meant, and how thin its walls are."""
    try:
        sections = [(meant, _pieces(rings) if meant.pieces > 1 else (shape_of(rings),)) for meant, rings in read]
        if undo is not None:
            sections = [(meant, tuple(undo(shape) for shape in shapes)) for meant, shapes in sections]
    except ValueError as error:
        findings.append(at_most("ROUND_TRIP", math.nan, 0, "mm", where, str(error)))
        return Judged(tuple(findings), None)
    limit = 2 * expected.chord_tolerance + 4 * rounding
    off, remark = 0.0, ""
    for meant, shapes in sections:
        here, said = _misplaced(shapes, meant, expected, limit)
        if not remark or not here <= off:
            off, remark = here, said
        if math.isnan(off):
            break
    if off > limit:
        remark = f"{remark}, but a hole is {off:.4g} mm off in place or size"
    findings.append(at_most("ROUND_TRIP", off, limit, "mm", where, remark))
    wall = min(_wall(shape) for shapes in _distinct(sections) for shape in shapes)
    if math.isfinite(wall):  # a part without holes has no wall between contours
        facets = 2 * max(_WALL_FACETS, expected.chord_tolerance)  # what facets on both sides may take of a wall
        findings.append(at_least("MIN_WALL", wall, expected.min_wall - facets, "mm", where, "smallest wall between contours"))
    shape = sections[0][1][0]
    bore = _bore(shape, expected.bore)
    if bore is not None:
        shape = shape.moved(shift=-bore.centre)
    return Judged(tuple(findings), shape, bore, tuple(shapes for _, shapes in sections))


def _pieces(rings: Sequence[Ring]) -> tuple[Shape, ...]:
    """Separate flat parts: each ring that lies in no other one, with the rings inside it."""
    ordered = sorted(rings, key=lambda ring: -abs(ring.area))
    groups: list[list[Ring]] = []
    for ring in ordered:
        home = next((group for group in groups if group[0].encloses(complex(ring.points[0]))), None)
        if home is None:
            groups.append([ring])
        else:
            home.append(ring)
    return tuple(shape_of(group) for group in groups)


def _distinct(sections: Sequence[tuple[Section, tuple[Shape, ...]]]) -> list[tuple[Shape, ...]]:
    """One height of each section: walls are upright."""
    return list({id(meant): shapes for meant, shapes in reversed(sections)}.values())


def _wall(shape: Shape) -> float:
    facets = [ring.facetted(min(_WALL_FACETS, 0.01 * math.sqrt(abs(ring.area)))) for ring in (shape.outer, *shape.holes)]
    return thinnest_wall(facets[0], facets[1:])


def _bore(shape: Shape, diameter: float | None) -> Circle | None:
    """The circle of the hole nearest the datum."""
    if diameter is None or not shape.holes:
        return None
    nearest = min(shape.holes, key=lambda ring: float(np.min(np.abs(ring.points))))
    return bore_circle(nearest, diameter)


def _misplaced(shapes: Sequence[Shape], meant: Section, expected: Expected, limit: float) -> tuple[float, str]:
    """How far holes are from where and how large they were meant to be, mm; nan when contours are lost or areas differ.

    Size counts as the radius of the circle of the same area. The bore's place is judged by the motion about it, eyes of
    joints by the linkage that is closed on them.
    """
    found = [(ring.centroid, abs(ring.area)) for shape in shapes for ring in shape.holes]
    count, wanted = len(shapes) + len(found), meant.pieces + len(meant.holes)
    if count != wanted or len(shapes) != meant.pieces:
        return math.nan, f"{count} contours instead of {wanted}"
    area = sum(shape.area for shape in shapes)
    if abs(area - meant.area) > tolerances.AREA_SHARE * meant.area + limit * meant.length:
        return math.nan, f"section of {area:.3f} mm^2 instead of {meant.area:.3f} mm^2"
    off = 0.0
    for centre, size_meant in meant.holes:
        if any(abs(centre - eye) <= limit for eye in expected.eyes):
            continue
        place, size = min(found, key=lambda hole: abs(hole[0] - centre))
        off = max(off, abs(math.sqrt(size / math.pi) - math.sqrt(abs(size_meant) / math.pi)))
        if expected.bore is None or abs(centre) > expected.bore / 2:
            off = max(off, abs(place - centre))
    return off, f"{count} contours read back"


# ---- motion ----------------------------------------------------------------------------------------------------------


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
    try:
        rolled = mounted(shape, drive)
    except ValueError as fault:
        return [at_most("MOTION_ERROR", math.nan, scale * limit, unit, where, str(fault))], {}
    meant, touch = reachable(theta), rolled.touch(theta)
    lost = np.isnan(touch.angle)
    error = np.where(lost, np.inf, np.abs(touch.angle - meant))
    worst = int(np.argmax(error))
    remark = f"{'tip rolled' if drive.face is None else 'face slid'} on the file at {len(theta)} cam angles"
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
            _place(where, theta[worst]),
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


def judge_tip(
    kind: str, where: str, frame: Shape, cam: Shape, rolling: Rolling, reachable: Motion, chord_tolerance: float
) -> tuple[list[Finding], dict[str, float]]:
    """Roll the tip that is in the frame's file on the cam that is in its file: TIP_MOTION of the two together.

    frame: with its pivot's hole at the origin. The limit is that of the outline tolerance at both.
    """
    ring = frame.outer.facetted(chord_tolerance / 4)
    away = np.abs(ring - rolling.arm)
    if rolling.tip_radius:
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
    remark = f"the frame's own tip, radius {radius:.4f} mm, on the cam, both from the files"
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
