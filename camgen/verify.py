"""The judge of files: what they hold, against the plain numbers and points of the parts.

It knows nothing of the formulas that made the curve; the shape on which a follower rolls is judged by its motion alone.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from camgen import tolerances
from camgen.distances import point_to_ring, thinnest_wall
from camgen.findings import Finding, at_least, at_most
from camgen.numerics import product
from camgen.readback import Mesh, Package, mesh_faults, read_3mf, read_dxf, read_stl, slice_mesh
from camgen.rings import Circle, Floats, Points, Ring, Shape, bore_circle, shape_of
from camgen.undoing import printed

MILLIMETRES = 4  # $INSUNITS of DXF
_WALL_FACETS = 0.001  # mm, chord tolerance at which walls between arcs are measured


@dataclass(frozen=True)
class Section:
    """What cuts through some heights (mm) should show: these separate pieces, facetted within the chord tolerance."""

    heights: tuple[float, ...]
    shapes: tuple[Shape, ...]


@dataclass(frozen=True)
class Expected:
    """What a part's files should hold, as plain numbers and points.

    sections: of its stack of layers, from the bottom; cut: the one that its drawing shows; volume: mm^3; levels: heights
    of its flat faces, mm, the underside first; bore: diameter of the hole on whose centre the part turns, where the motion
    tells its place. Judged elsewhere, by how parts move, are the outer contour of a part that is `rolled` upon, joints at
    the `eyes`, and what lies in the discs `tips` (centre, radius); rolled is the section that a drawing shows, or the first
    of a mesh.
    undo: how a mesh was changed for the printer, None where it was not.
    """

    part: str
    sections: tuple[Section, ...]
    cut: int
    volume: float
    levels: tuple[float, ...]
    facets: float
    min_wall: float
    chord_tolerance: float
    bore: float | None = None
    rolled: bool = False
    eyes: tuple[complex, ...] = ()
    tips: tuple[tuple[complex, float], ...] = ()
    undo: Undo | None = None


@dataclass(frozen=True)
class Undo:
    """What the printer does to a mesh that was sent to it, see `undoing.printed`; files are judged as they print, mm."""

    hole: float
    profile: float
    shrinkage: float

    @property
    def slack(self) -> float:
        """How far contours may be off for having been changed and changed back, mm."""
        return tolerances.WAY_BACK * max(abs(self.hole), abs(self.profile))

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
    """Watertightness, volume, sections and walls of the one solid in an STL or 3MF file."""
    where = path.name
    if path.suffix != ".3mf":
        return judge_solid(read_stl(path), expected, where)
    package = read_3mf(path)
    remarks = _remarks(package)
    remarks += [] if len(package.items) == 1 else [f"{len(package.items)} objects instead of 1"]
    if remarks:
        return Judged((at_most("ROUND_TRIP", len(remarks), 0, "warnings", where, "; ".join(remarks)),), None)
    (item,) = package.items
    return judge_solid(package.meshes[item.name].moved(item.transform), expected, where)


def _remarks(package: Package) -> list[str]:
    """What is wrong with a package as such."""
    return [*package.warnings, *([] if package.unit.lower() == "millimeter" else [f"unit is {package.unit}"])]


def judge_solid(mesh: Mesh, expected: Expected, where: str) -> Judged:
    """Watertightness, volume, sections and walls of a solid."""
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
    rounding = float(np.max(np.abs(mesh.vertices))) * tolerances.FLOAT32_ROUNDING
    lifted = _lifted(mesh.vertices[:, 2], expected.levels)
    try:
        sections = [(section, slice_mesh(mesh, z)) for section in expected.sections for z in section.heights]
    except ValueError as error:
        findings.append(at_most("ROUND_TRIP", math.nan, 0, "mm", where, str(error)))
        return Judged(tuple(findings), None)
    return _judge_sections(sections, expected, where, rounding, findings, lifted)


def _lifted(heights: Floats, levels: Sequence[float]) -> float:
    """How far flat faces are from where they belong, mm; all of a stack's corners lie on such a face."""
    there, wanted = np.unique(heights), np.array(levels)
    if len(levels) == 1:
        return float(abs(there[0] - wanted[0]))
    apart = np.abs(there[:, None] - wanted)
    return float(max(np.max(np.min(apart, axis=0)), np.max(np.min(apart, axis=1))))


def judge_copies(path: Path, originals: Mapping[str, Mesh], places: Sequence[tuple[str, Floats]] | None = None) -> Finding:
    """ROUND_TRIP of a package that holds copies of parts: its solids are the originals, moved as bodies are and not deformed.

    places: the wanted name and (3, 4) transform of each copy, in any order; None where they may lie anywhere.
    """
    package, where = read_3mf(path), path.name
    remarks = _remarks(package)
    strange = sorted(set(package.meshes) - set(originals))
    remarks += [f"there is no part {name}" for name in strange]
    found, wanted = Counter(item.name for item in package.items), Counter(name for name, _ in places or ())
    if places is not None and found != wanted:
        remarks.append(f"{found.total()} copies instead of {wanted.total()}")
    if remarks:
        return at_most("ROUND_TRIP", len(remarks), 0, "warnings", where, "; ".join(remarks))
    off = max((_unlike(mesh, originals[name]) for name, mesh in package.meshes.items()), default=0.0)
    reach = max(float(np.max(np.abs(mesh.vertices), initial=0.0)) for mesh in originals.values())
    far = max((float(np.max(np.abs(item.transform))) for item in package.items), default=0.0)
    for item in package.items:
        turn = item.transform[:, :3]
        bent = float(np.max(np.abs(product(turn, turn.T) - np.eye(3)))) if np.linalg.det(turn) > 0 else math.inf
        off = max(off, bent * reach)
    laid = [(item.name, item.transform) for item in package.items]
    for one, other in ((laid, places), (places, laid)) if places is not None else ():  # no copy astray, no place empty
        off = max(off, max((_astray(copy, other) for copy in one), default=0.0))
    limit = tolerances.TRANSFORM_ROUNDING * (reach + far)
    remark = f"{len(package.items)} copies of {len(package.meshes)} parts, each as its own file has it"
    return at_most("ROUND_TRIP", off, limit, "mm", where, remark)


def _astray(copy: tuple[str, Floats], others: Sequence[tuple[str, Floats]]) -> float:
    """How far the nearest copy of the same part lies from this one, as the largest difference of their transforms."""
    return min((float(np.max(np.abs(copy[1] - place))) for name, place in others if name == copy[0]), default=math.inf)


def _unlike(mesh: Mesh, original: Mesh) -> float:
    """Largest distance between the corners of two meshes that should be one, mm; inf where they are not of the same triangles."""
    if mesh.faces.shape != original.faces.shape or not np.array_equal(mesh.faces, original.faces):
        return math.inf
    return float(np.max(np.abs(mesh.vertices - original.vertices)))


def _volume(volume: float, expected: Expected, where: str) -> Finding:
    limit = tolerances.VOLUME_SHARE * expected.volume + expected.facets
    return at_most(
        "VOLUME", abs(volume - expected.volume), limit, "mm^3", where,
        f"{volume:.3f} mm^3 in the file, {expected.volume:.3f} mm^3 by Green's theorem on the exact outline",
    )  # fmt: skip


def _judge_sections(
    read: Sequence[tuple[Section, Sequence[Ring]]], expected: Expected, where: str, rounding: float,
    findings: list[Finding], lifted: float = 0.0,
) -> Judged:
    """Whether every section holds the contours that were meant, and how thin its walls are."""
    try:
        sections = [(meant, _pieces(rings) if len(meant.shapes) > 1 else (shape_of(rings),)) for meant, rings in read]
        if expected.undo is not None:
            sections = [(meant, tuple(expected.undo(shape) for shape in shapes)) for meant, shapes in sections]
    except ValueError as error:
        findings.append(at_most("ROUND_TRIP", math.nan, 0, "mm", where, str(error)))
        return Judged(tuple(findings), None)
    steps = 4.0
    if len(expected.levels) == 1:  # a crossed body, of which one flat face is known; corners near each other are one
        steps += math.sqrt(2) * tolerances.MERGED_STEPS
    limit = 2 * expected.chord_tolerance + steps * rounding + (expected.undo.slack if expected.undo else 0.0)
    off, remark = lifted, f"a flat face is {lifted:.4g} mm off its height"
    for k, (meant, shapes) in enumerate(sections):
        count = sum(1 + len(shape.holes) for shape in meant.shapes)
        found = sum(1 + len(shape.holes) for shape in shapes)
        if found != count or len(shapes) != len(meant.shapes):
            off, remark = math.nan, f"{found} contours instead of {count}"
            break
        same = meant.shapes[0].outer is sections[0][0].shapes[0].outer
        rolled = sections[0][1][0].outer if expected.rolled and same else None
        here = _strayed(shapes, meant.shapes, expected, rolled)
        if here >= off or (k == 0 and off <= limit):
            off, remark = max(off, here), f"{found} contours read back and compared point by point"
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


def _strayed(shapes: Sequence[Shape], meant: Sequence[Shape], expected: Expected, rolled: Ring | None) -> float:
    """How far the contours of a section are from those meant, mm; as many of them, and what is judged elsewhere left out.

    rolled: the outer contour at the height where followers roll on it, with which the other heights are compared.
    """
    off = 0.0
    for wanted in meant:
        shape = min(shapes, key=lambda one: _apart(one.outer, wanted.outer))
        if len(shape.holes) != len(wanted.holes):  # the holes of another piece
            return math.inf
        if not _is_eye(wanted.outer, expected):
            off = max(off, _distance(shape.outer, rolled or wanted.outer, expected))
        for hole in wanted.holes:
            if _is_eye(hole, expected):
                continue
            found = min(shape.holes, key=lambda one: _apart(one, hole))
            if expected.bore is not None and abs(hole.centroid) < expected.bore / 2:
                found = found.moved(shift=hole.centroid - found.centroid)
            off = max(off, _distance(found, hole, expected))
    return off


def _apart(a: Ring, b: Ring) -> float:
    return abs(a.centroid - b.centroid) + abs(math.sqrt(abs(a.area)) - math.sqrt(abs(b.area)))


def _is_eye(ring: Ring, expected: Expected) -> bool:
    return any(abs(ring.centroid - eye) <= 2 * expected.chord_tolerance for eye in expected.eyes)


def _distance(a: Ring, b: Ring, expected: Expected) -> float:
    """Largest distance of either contour's vertices from the other one, mm, those in the discs of tips left out."""
    one, other = (ring.facetted(expected.chord_tolerance) for ring in (a, b))
    return max(_beyond(one, other, expected), _beyond(other, one, expected))


def _beyond(points: Points, ring: Points, expected: Expected) -> float:
    for centre, radius in expected.tips:
        points = points[np.abs(points - centre) > radius]
    return float(np.max(point_to_ring(points, ring), initial=0.0))
