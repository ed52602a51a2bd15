"""The judge of files: what they hold, against the plain numbers and points of the parts.

Every contour of every section is compared with the one that was meant, by its points, along its edges and by its area. It
knows nothing of the formulas that made the curve; what a follower does on it is judged by `cams`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from camgen import tolerances
from camgen.errors import counted
from camgen.files.dxf import read_contours
from camgen.files.formats import FORMATS, read_drawing, read_exact, read_solid
from camgen.findings import Finding, Where, at_least, at_most, in_file
from camgen.geometry.distances import thinnest_wall
from camgen.geometry.mesh import Mesh, mesh_faults, slice_mesh
from camgen.geometry.rings import Floats, Points, Ring, Shape, shape_of
from camgen.judge.as_printed import printed
from camgen.judge.contours import contour_error
from camgen.numerics import distinct, magnitude

MILLIMETRES = 4  # $INSUNITS of DXF
_REMARKS = 3  # of a file that are told, at most
# By these, in a part's drawing, a laser's program takes its tool: colour index and line weight, 1/100 mm, of a layer.
PART_LAYERS = {"CUT": (7, 25), "CENTER": (1, 13), "ENGRAVE": (5, 13)}


@dataclass(frozen=True)
class Section:
    """What cuts through some heights (mm) should show: these separate pieces, facetted within the chord tolerance.

    sent: as it is in a file for the printer, such as the chamfer of its foot; otherwise as it prints. pocket: through an
    engraving, between whose strokes no wall is asked for.
    """

    heights: tuple[float, ...]
    shapes: tuple[Shape, ...]
    sent: bool = False
    pocket: bool = False


@dataclass(frozen=True)
class NominalPart:
    """What a part's files should hold, as plain numbers and points.

    Where eyes lie to each other is judged elsewhere, by how parts move; so is where they lie to an outline that a follower
    runs on.
    """

    part: str
    # of its layers, from the bottom, then of what lies below or above them
    sections: tuple[Section, ...]
    drawn_section: int  # the one that its drawing shows
    volume: float  # mm^3
    levels: tuple[float, ...]  # heights of its flat faces, mm, the underside first
    facets: float  # volume that facets may take, mm^3
    min_wall: float  # mm
    chord_tolerance: float  # mm
    # diameter of the hole on whose centre it turns, where the motion tells its place
    bore: float | None = None
    eyes: tuple[tuple[complex, float], ...] = ()  # of joints: centre and diameter, mm
    rolls: bool = False  # whether a follower runs on its outline
    # whether `levels` are all of them; of another part the lowest and the highest place
    levels_complete: bool = True
    print_change: PrintChange | None = None  # how a mesh was changed for the printer
    marks: Points = field(
        default_factory=lambda: np.empty((0, 2), complex)
    )  # (n, 2), ends of strokes
    engraved: tuple[Ring, ...] = ()
    curves: str = "bulge"  # as what its drawing shows contours


@dataclass(frozen=True)
class PrintChange:
    """What the printer does to a mesh that was sent to it, see `as_printed.printed`; files are judged as they print."""

    hole: float  # by which holes become smaller, mm
    profile: float  # by which outlines become larger, mm
    shrinkage: float  # as a share

    @property
    def slack(self) -> float:
        """How far contours may be off for having been changed and changed back, mm."""
        return tolerances.WAY_BACK * max(abs(self.hole), abs(self.profile))

    def __call__(self, shape: Shape) -> Shape:
        """A recovered shape as it is in print; ValueError where a ring vanishes."""
        return printed(shape, self.hole, self.profile, self.shrinkage)


@dataclass(frozen=True)
class PartVerdict:
    """What one file of a part comes to."""

    findings: tuple[Finding, ...]
    sections: tuple[
        tuple[Shape, ...], ...
    ] = ()  # pieces at each height, none where it could not be recovered


def judge_drawing(path: Path, expected: NominalPart) -> PartVerdict:
    """Units, closed contours, holes and walls of a drawing that is to be cut."""
    form = FORMATS[path.suffix[1:]]
    where = in_file(path)
    drawing = read_drawing(path, expected.part)
    units = drawing.units or 0
    faults = [fault.message for fault in drawing.faults] + drawing.repainted(PART_LAYERS)
    if drawing.curves not in ("bulge", expected.curves):
        faults.append(
            f'contours are drawn as files.curves = "{drawing.curves}", not as "{expected.curves}"'
        )
    faults += _misplaced(drawing.marks, expected.marks)
    faults += _misdrawn(drawing.engraved, expected.engraved, expected.chord_tolerance)
    closed = at_most(
        "DXF_CLOSED",
        len(faults),
        0,
        "contours",
        where,
        "; ".join(faults)
        or f"{counted(len(drawing.cut), 'contour')}, each "
        + ("closed, of lines and arcs" if drawing.curves == "arcs" else "one closed entity"),
    )
    findings = [
        at_most(
            "DXF_UNITS",
            units != MILLIMETRES,
            0,
            "faults",
            where,
            "drawn in millimetres"
            if units == MILLIMETRES
            else f"$INSUNITS of the header is {units}, millimetres are {MILLIMETRES}",
        ),
        closed,
    ]
    if not closed.ok:
        return PartVerdict(tuple(findings))
    return _judge_sections(
        [(expected.sections[expected.drawn_section], drawing.cut)],
        expected,
        where,
        form.rounding,
        findings,
    )


def _misplaced(marks: Points, nominal: Points) -> list[str]:
    """What is wrong with the strokes of centre marks, in the order in which they are meant."""
    if len(marks) != len(nominal):
        return [
            f"{len(marks)} strokes of centre marks instead of {len(nominal)} (files.center_marks)"
        ]
    off = float(np.max(np.abs(marks - nominal), initial=0.0))
    return [] if off <= tolerances.SAME_POINT else [f"a centre mark is {off:.4g} mm off"]


def _misdrawn(engraved: Sequence[Ring], nominal: Sequence[Ring], tolerance: float) -> list[str]:
    """What is wrong with engraved contours, in the order in which they are meant."""
    if len(engraved) != len(nominal):
        return [
            f"{counted(len(engraved), 'engraved contour')} instead of {len(nominal)} (files.engrave)"
        ]
    pairs = zip(engraved, nominal, strict=True)
    off = max(
        (contour_error(ring, nominal_ring, tolerance / 2) for ring, nominal_ring in pairs),
        default=0.0,
    )
    return [] if off <= 2 * tolerance else [f"an engraved contour is {off:.4g} mm off"]


def judge_dimensioned(path: Path, expected: NominalPart) -> Finding:
    """ROUND_TRIP of the contours that a dimensioned drawing shows at the part's own size."""
    rings, faults = read_contours(path)
    if faults:
        return strange(path, faults)
    findings = judge_cut(rings, expected, in_file(path)).findings
    return next(finding for finding in findings if finding.code == "ROUND_TRIP")


def judge_mesh(path: Path, expected: NominalPart) -> PartVerdict:
    """Watertightness, volume, sections and walls of the one solid in a file."""
    mesh, remarks = read_solid(path, expected.part)
    if remarks:
        return PartVerdict((strange(path, remarks),))
    return judge_solid(mesh, expected, in_file(path), FORMATS[path.suffix[1:]].rounding)


def judge_exact(path: Path, expected: NominalPart) -> PartVerdict:
    """Closed shell, volume, sections and walls of the one exact solid in a file."""
    body, remarks = read_exact(path, expected.part)
    where = in_file(path)
    if remarks:
        return PartVerdict((strange(path, remarks),))
    bodies = counted(body.bodies, "body", "bodies")
    remark = f"{body.faults} edges without their two faces, {bodies} of {counted(len(body.faces), 'face')}"
    findings = [
        at_most("WATERTIGHT", body.faults + abs(body.bodies - 1), 0, "faults", where, remark)
    ]
    if not findings[0].ok:
        return PartVerdict(tuple(findings))
    findings.append(_volume(body.volume, expected, where))
    try:
        sections = [
            (section, body.section(z)) for section in expected.sections for z in section.heights
        ]
    except ValueError as error:
        return _unread(findings, where, error)
    levels = body.heights if expected.levels_complete else body.reach
    return _judge_sections(sections, expected, where, 0.0, findings, _level_error(levels, expected))


def judge_cut(rings: Sequence[Ring], expected: NominalPart, where: Where) -> PartVerdict:
    """Contours and walls of a part as it is cut of a sheet, in the part's frame."""
    return _judge_sections(
        [(expected.sections[expected.drawn_section], rings)], expected, where, 0.0, []
    )


def judge_solid(mesh: Mesh, expected: NominalPart, where: Where, rounding: float) -> PartVerdict:
    """Watertightness, volume, sections and walls of a solid; rounding: of a length in its file, as a share."""
    faults = mesh_faults(mesh)
    count = faults.count + abs(faults.bodies - 1)
    findings = [
        at_most(
            "WATERTIGHT",
            count + faults.turned_normals,
            0,
            "faults",
            where,
            f"{faults.defects or 'no fault'} in {counted(faults.bodies, 'body', 'bodies')} of {len(mesh.faces)} triangles",
        )
    ]
    if count:
        return PartVerdict(tuple(findings))
    findings.append(_volume(faults.volume, expected, where))
    rounding *= magnitude(mesh.vertices)
    level_error = _level_error(mesh.vertices[:, 2], expected)
    try:
        sections = _cut(mesh, expected.sections)
    except ValueError as error:
        return _unread(findings, where, error)
    return _judge_sections(sections, expected, where, rounding, findings, level_error)


def _cut(mesh: Mesh, sections: Sequence[Section]) -> list[tuple[Section, list[Ring]]]:
    """The rings at all heights; walls are upright, so that most are the same at several: these are one object."""
    known: dict[bytes, Ring] = {}
    return [
        (
            section,
            [known.setdefault(ring.points.tobytes(), ring) for ring in slice_mesh(mesh, z)],
        )
        for section in sections
        for z in section.heights
    ]


def _level_error(heights: Floats, expected: NominalPart) -> tuple[float, float]:
    """How far flat faces are from where they belong, and the height of the one that is farthest off, mm; all of a stack's corners lie
    on such a face."""
    levels = distinct(heights)
    nominal = np.array(expected.levels)
    if not expected.levels_complete:
        levels = levels[[0, -1]]
    distances = np.abs(levels[:, None] - nominal)
    off = np.concatenate([np.min(distances, axis=0), np.min(distances, axis=1)])
    worst = int(np.argmax(off))
    return float(off[worst]), float(np.concatenate([nominal, levels])[worst])


def _unread(findings: Sequence[Finding], where: Where, error: ValueError) -> PartVerdict:
    """What was found until nothing more could be read, and why it could not."""
    return PartVerdict((*findings, at_most("ROUND_TRIP", math.nan, 0, "mm", where, str(error))))


def strange(path: Path, remarks: Sequence[str]) -> Finding:
    """ROUND_TRIP of a file that is not as it was written; the first remarks say how."""
    more = len(remarks) - _REMARKS
    said = "; ".join([*remarks[:_REMARKS], *([f"and {more} more"] if more > 0 else [])])
    return at_most("ROUND_TRIP", math.nan, 0, "mm", in_file(path), said)


def _volume(volume: float, expected: NominalPart, where: Where) -> Finding:
    limit = tolerances.VOLUME_SHARE * expected.volume + expected.facets
    return at_most(
        "VOLUME",
        abs(volume - expected.volume),
        limit,
        "mm^3",
        where,
        f"{volume:.3f} mm^3 in the file, {expected.volume:.3f} mm^3 by Green's theorem on the exact outline",
    )


def _judge_sections(
    rings_by_section: Sequence[tuple[Section, Sequence[Ring]]],
    expected: NominalPart,
    where: Where,
    rounding: float,
    findings: list[Finding],
    level: tuple[float, float] = (0.0, 0.0),
) -> PartVerdict:
    """Whether every section holds the contours that were meant, and how thin its walls are."""
    undo = expected.print_change
    try:
        sections = _shapes(rings_by_section, undo)
    except ValueError as error:
        return _unread(findings, where, error)
    steps = 4.0
    if not expected.levels_complete:  # corners near each other are one
        steps += math.sqrt(2) * tolerances.MERGED_STEPS
    limit = 2 * expected.chord_tolerance + steps * rounding + (undo.slack if undo else 0.0)
    off = level[0]
    remark = f"the flat face at z {level[1]:.4g} is {off:.4g} mm off its height"
    place = _bore_shift(sections[0][1], sections[0][0].shapes, expected)
    eyes: list[tuple[complex, complex]] = []
    compared: dict[int, tuple[float, list[tuple[complex, complex]]]] = {}
    for k, (section, shapes) in enumerate(sections):
        count = sum(1 + len(shape.holes) for shape in section.shapes)
        contours = sum(1 + len(shape.holes) for shape in shapes)
        if contours != count or len(shapes) != len(section.shapes):
            off = math.nan
            remark = f"{contours} contours instead of {count}"
            break
        if id(shapes) not in compared:
            compared[id(shapes)] = _section_error(shapes, section.shapes, expected, place)
        section_error, section_eyes = compared[id(shapes)]
        eyes += section_eyes
        if math.isinf(section_error):
            off = math.nan
            remark = "a piece has the holes of another one"
            break
        if section_error >= off or (k == 0 and off <= limit):
            off = max(off, section_error)
            remark = f"{counted(contours, 'contour')} read back and compared point by point"
    if not expected.rolls and (aside := _aside(eyes, sections, expected)) > max(off, limit):
        off = aside
        remark = (
            "its joints' eyes lie elsewhere in its outline, all of them moved or turned together"
        )
    findings.append(at_most("ROUND_TRIP", off, limit, "mm", where, remark))
    printed_sections = [
        (section, shapes) for section, shapes in sections if not section.sent and not section.pocket
    ]
    wall = min(_wall(shape) for shapes in _distinct(printed_sections) for shape in shapes)
    if math.isfinite(wall):  # a part without holes has no wall between contours
        facets = 2 * max(
            tolerances.WALL_FACETS, expected.chord_tolerance
        )  # what facets on both sides may take of a wall
        remark = f"smallest wall between contours; a wall {facets:g} mm thinner also holds, to allow for the facets on both sides"
        findings.append(
            at_least(
                "MIN_WALL",
                wall,
                expected.min_wall,
                "mm",
                where,
                remark,
            ).within(facets)
        )
    return PartVerdict(tuple(findings), tuple(shapes for _, shapes in printed_sections))


def _shapes(
    rings_by_section: Sequence[tuple[Section, Sequence[Ring]]], undo: PrintChange | None
) -> list[tuple[Section, tuple[Shape, ...]]]:
    """The pieces at each height, as they print; those of the same rings are the same object. ValueError where there are none."""
    known: dict[tuple[int, ...], tuple[Shape, ...]] = {}
    sections = []
    for section, rings in rings_by_section:
        key = (id(section), *map(id, rings))
        if key not in known:
            shapes = pieces_of(rings) if len(section.shapes) > 1 else (shape_of(rings),)
            if undo is not None and not section.sent:
                shapes = tuple(map(undo, shapes))
            known[key] = shapes
        sections.append((section, known[key]))
    return sections


def pieces_of(rings: Sequence[Ring]) -> tuple[Shape, ...]:
    """Separate flat parts: each ring that lies in no other one, or in a hole of one, with its holes."""
    ordered = sorted(rings, key=lambda ring: -abs(ring.area))
    groups: list[list[Ring]] = []
    for ring in ordered:
        round_it = [group for group in groups if _lies_in(ring, group[0])]
        if not round_it or any(_lies_in(ring, hole) for hole in round_it[-1][1:]):
            groups.append([ring])
        else:
            round_it[-1].append(ring)
    return tuple(shape_of(group) for group in groups)


def _lies_in(ring: Ring, other: Ring) -> bool:
    """Whether a ring lies in a larger one; not where it stands out over its box, as one of two that overlap does."""
    box = np.asarray(ring.box)
    room = np.asarray(other.box)
    nested = np.all(box[:2] >= room[:2]) and np.all(box[2:] <= room[2:])
    return bool(nested) and other.encloses(complex(ring.points[0]))


def _distinct(sections: Sequence[tuple[Section, tuple[Shape, ...]]]) -> list[tuple[Shape, ...]]:
    """One height of each section: walls are upright."""
    return list({id(section): shapes for section, shapes in reversed(sections)}.values())


def _wall(shape: Shape) -> float:
    rings = (shape.outer, *shape.holes)
    outer, *holes = (
        ring.facetted(min(tolerances.WALL_FACETS, 0.01 * math.sqrt(abs(ring.area))))
        for ring in rings
    )
    return thinnest_wall(outer, holes)


def _is_bore(ring: Ring, expected: NominalPart) -> bool:
    return expected.bore is not None and abs(ring.centroid) < expected.bore / 2


def _bore_shift(
    shapes: Sequence[Shape], nominal: Sequence[Shape], expected: NominalPart
) -> complex:
    """How far the bore in a section is from its place, mm: motion tells that, and at all heights it is the same."""
    holes = [hole for shape in shapes for hole in shape.holes]
    bores = [
        hole
        for nominal_shape in nominal
        for hole in nominal_shape.holes
        if _is_bore(hole, expected)
    ]
    return (
        min((hole.centroid - bores[0].centroid for hole in holes), key=abs)
        if holes and bores
        else 0j
    )


def _section_error(
    shapes: Sequence[Shape],
    nominal: Sequence[Shape],
    expected: NominalPart,
    bore_shift: complex,
) -> tuple[float, list[tuple[complex, complex]]]:
    """How far the contours of a section are from those meant, mm, each piece and each hole from one of its own; and centres of
    eyes, as meant and as found."""
    off = 0.0
    eyes: list[tuple[complex, complex]] = []
    rest = list(shapes)
    for nominal_shape in nominal:
        shape, *rest = sorted(rest, key=lambda each: _apart(each.outer, nominal_shape.outer))
        if len(shape.holes) != len(nominal_shape.holes):  # the holes of another piece
            return math.inf, eyes
        pairs = [(shape.outer, nominal_shape.outer)]
        holes = list(shape.holes)
        for hole in nominal_shape.holes:
            contour, *holes = sorted(holes, key=lambda each: _apart(each, hole))
            pairs.append((contour, hole))
        for contour, ring in pairs:
            shift = 0j
            if _is_eye(ring, expected):
                shift = contour.centroid - ring.centroid
                eyes.append((ring.centroid, contour.centroid))
            if ring is not nominal_shape.outer and _is_bore(ring, expected):
                shift = bore_shift
            off = max(
                off, contour_error(contour.moved(shift=-shift), ring, expected.chord_tolerance / 2)
            )
    return off, eyes


def _aside(
    eyes: Sequence[tuple[complex, complex]],
    sections: Sequence[tuple[Section, Sequence[Shape]]],
    expected: NominalPart,
) -> float:
    """How far a part's eyes (meant, found) lie together from their places in its outline, mm: what a rigid motion of them all
    explains, where it leaves less than half of that unexplained. 0 where all outlines are eyes themselves.
    """
    fixed = any(
        not _is_eye(shape.outer, expected) for section, _ in sections for shape in section.shapes
    )
    if not eyes or not fixed:
        return 0.0
    nominal, measured = np.array(eyes).T
    arms = nominal - nominal.mean()
    rigid = (
        np.exp(1j * np.angle(np.vdot(arms, measured - measured.mean()))) * arms + measured.mean()
    )
    common, rest = (magnitude(off) for off in (rigid - nominal, measured - rigid))
    return common if common > 2 * rest else 0.0


def _apart(a: Ring, b: Ring) -> float:
    return abs(a.centroid - b.centroid) + abs(math.sqrt(abs(a.area)) - math.sqrt(abs(b.area)))


def _is_eye(ring: Ring, expected: NominalPart) -> bool:
    """Whether a contour that is meant is that of a joint, by its place and its size."""
    near = 2 * expected.chord_tolerance
    size = 2 * math.sqrt(abs(ring.area) / math.pi)
    return any(
        abs(ring.centroid - at) <= near and abs(size - diameter) <= near
        for at, diameter in expected.eyes
    )
