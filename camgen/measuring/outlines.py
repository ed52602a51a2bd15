"""Closed outlines from files of any maker: a DXF of lines, arcs, polylines, circles, ellipses and splines, a mesh,
a scan or measured points.

The outline is the largest closed contour, all lengths in mm, in the file's own frame. Unlike `read_dxf`, which is strict with
our own files, this reads what others write and says what it made of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from camgen.bounds import bounded
from camgen.errors import FileError, counted
from camgen.files.formats import READABLE
from camgen.files.shelves import located
from camgen.findings import Finding, at_least, at_most, in_file
from camgen.geometry import dxf_curves as dxf
from camgen.geometry.chains import joined, nearest_gap
from camgen.geometry.distances import inside
from camgen.geometry.mesh import mesh_faults, slice_mesh
from camgen.geometry.rings import Ints, Points, Ring
from camgen.measuring.meshes import MESH_SIZES, read_mesh
from camgen.measuring.points import POINTS_SIZE, read_points
from camgen.measuring.scan import (
    LEAST_CONTRAST,
    PICTURE_SIZE,
    PICTURES,
    WALL_OFF,
    Scanning,
    scanned,
)
from camgen.numerics import coordinates
from camgen.study import Figure, Figures
from camgen.tolerances import CURVE_CHORDS

_SIZES = {f".{kind}": READABLE[kind].size for kind in ("dxf", "gcode")}
_SIZES |= {**MESH_SIZES, ".csv": POINTS_SIZE, **dict.fromkeys(PICTURES, PICTURE_SIZE)}
ENDINGS = tuple(_SIZES)
_HEAD = 4096  # bytes that tell what a file is
_MOST_POINTS = 500_000
# mm across: beyond it the unit is wrong, or float64 does not resolve SAME_POINT
_LEAST_SIZE = 0.1
_MOST_SIZE = 1e5
_RIVAL = 0.25  # of the outline's area: a contour within it that is larger is no bore


@dataclass(frozen=True)
class Outline:
    """What a file holds."""

    ring: Ring | None  # counter-clockwise, mm; None where a finding says why
    findings: tuple[Finding, ...]
    remark: str  # a sentence on the reading
    numbers: Figures = field(default_factory=Figures)  # of what measured it

    def about(self, pivot: complex) -> Outline:
        """The same, seen from a place in its file, mm."""
        if self.ring is None or not pivot:
            return self
        return replace(self, ring=self.ring.moved(shift=-pivot))


@dataclass(frozen=True)
class Hints:
    """What a person says of a file beside its content."""

    height: float | None = None  # of a mesh's section or of G-code's layer, mm; None: half way up
    layer: str | None = None  # of a DXF; None: all
    line_width: float | None = None  # of G-code that does not say it, mm
    scanning: Scanning = Scanning()
    probe: float = 0.0  # radius of the ball whose centres measured points are, mm


AS_IT_IS = Hints()  # of a file of which nothing is said


def read_outline(path: Path, hints: Hints = AS_IT_IS, contour: int | None = None) -> Outline:
    """The largest closed contour of a drawing, of a mesh's section, of a layer of G-code or of a scan, or through measured points.

    contour: 1 for the largest, 2 for the second largest, and so on; where none is asked for, a finding tells whether another
    contour could be meant. What a drawing's switched-off or frozen layers hold does not count. Other units than millimetres
    are turned into them, with a finding. A file of a build is found on its shelf, too.
    FileError where the file cannot be read, is empty, too large, or not what its ending says.
    """
    path = path if path.exists() else located(path)
    kind = {".bgcode": ".gcode", **PICTURES}.get(path.suffix.lower(), path.suffix.lower())
    if kind not in ENDINGS:
        raise FileError(
            path, f"ends in '{path.suffix}': a file that ends in {', '.join(ENDINGS)} was expected"
        )
    try:
        size = bounded(path, _SIZES[kind])
        content = (
            path.read_bytes() if kind in (".dxf", ".csv") else b""
        )  # the others are read line by line or by parts
        with open(path, "rb") as file:
            head = content or file.read(_HEAD)
    except OSError as error:
        raise FileError(path, f"cannot be read: {error.strerror or error}") from None
    if not head or head.isspace():
        raise FileError(path, "is empty")
    likely = _looks_like(head[:_HEAD], size)
    if likely not in (kind, ""):
        raise FileError(path, f"is not what its ending says: it looks like {likely[1:].upper()}")
    try:
        if kind == ".gcode":
            outline = _from_gcode(path, hints, contour)
        elif kind == ".csv":
            _refuse_rank(path, 1, contour)
            ring, off, remark = read_points(path, content, hints.probe)
            figures = Figures([Figure(WALL_OFF, off, "mm", "points")])
            outline = Outline(ring, (), remark, figures)
        elif kind in PICTURES:
            outline = _from_scan(path, contour, hints.scanning)
        elif kind == ".dxf":
            outline = _from_dxf(path, content, hints.layer, contour)
        else:
            outline = _from_mesh(path, hints.height, contour)
        return _judged(path, outline)
    except OverflowError as error:
        raise FileError(path, f"takes {error}") from None


def _refuse_rank(path: Path, count: int, contour: int | None) -> None:
    """FileError where a file of so many closed contours has none of that rank by size."""
    if contour is not None and contour > count:
        found = counted(count, "closed contour")
        raise FileError(path, f"holds {found}: there is no contour={contour}")


def _picked(path: Path, rings: Sequence[Ring], contour: int | None) -> tuple[Ring, Finding]:
    """The contour of that rank by size, and CONTOUR: how many others could be meant where no rank is asked for.

    A bore or keyway within a cam is small and holds no contour itself; a frame or a sheet's border holds a cam with its bore.
    """
    rank = contour or 1
    _refuse_rank(path, len(rings), rank)
    ordered = sorted(rings, key=lambda ring: -abs(ring.area))
    outline = ordered[rank - 1]
    which = "the largest" if rank == 1 else f"number {rank} by size"
    left, low, right, high = outline.box
    size = max(right - left, high - low)
    if not _LEAST_SIZE <= size <= _MOST_SIZE:
        sizes = f"from {_LEAST_SIZE:g} to {_MOST_SIZE:g} mm are taken: is the unit wrong?"
        raise FileError(path, f"has an outline {size:.4g} mm across; {sizes}")
    remark = f"{which} of {counted(len(rings), 'closed contour')} is the outline"
    rivals = []
    if contour is None:
        starts = np.array([ring.points[0] for ring in ordered])
        inner = 1 + _enclosed(outline, starts[1:])
        rivals = [
            k
            for i, k in enumerate(inner.tolist())
            if abs(ordered[k].area) > _RIVAL * abs(outline.area)
            or len(_enclosed(ordered[k], starts[inner[i + 1 :]]))
        ]
    if rivals:
        ranks = ", ".join(str(k + 1) for k in rivals[:5])
        remark += f"; number {ranks} by size within it may be the cam: say contour=1 or another in the follower's table, or a layer"
    return outline, at_most("CONTOUR", len(rivals), 0, "contours", in_file(path), remark)


def _enclosed(ring: Ring, points: Points) -> Ints:
    """Which of the points lie inside a ring, their places in the list; those outside its box cost little."""
    left, low, right, high = ring.box
    near = np.flatnonzero(
        (points.real > left) & (points.real < right) & (points.imag > low) & (points.imag < high)
    )
    if not len(near):
        return near
    facets = ring.facetted(min(1e-3 * max(right - left, high - low), 0.01))
    return near[inside(points[near], facets)]


def _looks_like(first: bytes, size: int) -> str:
    """Ending that the first bytes of a file, and how many it has, speak for; empty where they do not tell."""
    head = first.lstrip()
    if head.startswith(b"PK\x03\x04"):
        return ".3mf"
    if size == 84 + 50 * int.from_bytes(first[80:84], "little") and size > 84:
        return ".stl"
    if head.startswith(b"solid") and b"facet" in head:
        return ".stl"
    if head.startswith(b"AutoCAD Binary DXF") or (
        b"SECTION" in head and b"\n" in head and head[:1].isdigit()
    ):
        return ".dxf"
    for magic, name in (
        (b"%PDF", ".pdf"),
        (b"<svg", ".svg"),
        (b"\x89PNG", ".png"),
        (b"AC10", ".dwg"),
        (b"ISO-10303", ".step"),
    ):
        if magic in head[:400]:
            return name
    starts = (
        (b"\xff\xd8\xff", ".jpg"),
        (b"II*\x00", ".tif"),
        (b"MM\x00*", ".tif"),
        (b"glTF\x02", ".glb"),
        (b"ply\n", ".ply"),
        (b"ply\r\n", ".ply"),
    )
    return next((name for magic, name in starts if head.startswith(magic)), "")


def _judged(path: Path, outline: Outline) -> Outline:
    """The outline with a finding on its crossing itself; FileError where it has too many points."""
    ring = outline.ring
    if ring is None:
        return outline
    if len(ring.points) > _MOST_POINTS:
        raise FileError(
            path, f"has an outline of {len(ring.points)} points; at most {_MOST_POINTS} are taken"
        )
    crossing = _crossing(ring)
    finding = at_most(
        "SELF_CROSSING",
        1 if crossing else 0,
        0,
        "crossings",
        in_file(path),
        f"the outline meets itself: {crossing}" if crossing else "the outline does not meet itself",
    )
    sound_ring = None if crossing else ring.counter_clockwise()
    return replace(outline, ring=sound_ring, findings=(*outline.findings, finding))


def _crossing(ring: Ring) -> str:
    """Where a ring meets itself; empty where it does not."""
    import shapely

    z = ring.facetted(CURVE_CHORDS)
    polygon = shapely.Polygon(coordinates(z))
    return "" if shapely.is_valid(polygon) else str(shapely.is_valid_reason(polygon))


def _from_gcode(path: Path, hints: Hints, contour: int | None) -> Outline:
    from camgen.files.gcode import printed_outlines

    rings, remark = printed_outlines(path, hints.height, hints.line_width)
    ring, finding = _picked(path, rings, contour)
    return Outline(ring, (finding,), f"{finding.message}; {remark}")


def _from_scan(path: Path, contour: int | None, scanning: Scanning) -> Outline:
    scan = scanned(path, scanning)
    ring, finding = _picked(path, scan.rings, contour)
    remark = "the least grey levels, of 255, by which the part differs from its background"
    contrast = at_least("CONTRAST", scan.contrast, LEAST_CONTRAST, "levels", in_file(path), remark)
    return Outline(ring, (finding, contrast), f"{finding.message}; {scan.remark}", scan.numbers)


# ---- DXF -------------------------------------------------------------------------------------------------------------


def _from_dxf(path: Path, content: bytes, layer: str | None, contour: int | None) -> Outline:
    drawing = dxf.drawing(path, content)
    unit, scale = dxf.unit_of(path, drawing, content)
    entities = dxf.entities(path, drawing, layer)
    chains, others = dxf.chains(path, entities, scale)
    if not chains:
        raise FileError(path, f"holds no outline: {others or 'it is empty'}")
    units = at_most(
        "DXF_UNITS",
        scale != 1,
        0,
        "faults",
        in_file(path),
        "drawn in millimetres"
        if unit == "millimetres"
        else "the drawing names no unit: taken as millimetres"
        if unit == dxf.NO_UNIT
        else f"drawn in {unit}: multiplied by {scale:g}; save it in millimetres if that is wrong",
    )
    rings, loose = joined(chains)
    if not rings and not loose:
        raise FileError(path, "holds no outline: all that is drawn has no size")
    biggest = max(rings, key=lambda ring: abs(ring.area), default=None)
    size = max(np.ptp(biggest.points.real), np.ptp(biggest.points.imag)) if biggest else 0.0
    wide = [chain for chain in loose if chain.size >= size and not (biggest and chain.straight)]
    remark = nearest_gap(wide)
    closed = at_most(
        "DXF_CLOSED",
        len(wide),
        0,
        "contours",
        in_file(path),
        remark
        or counted(len(rings), "closed contour")
        + (f"; {counted(len(loose), 'open line')} within it left out" if loose else "")
        + (f"; {others} passed over" if others else ""),
    )
    if wide:
        return Outline(None, (units, closed), "")
    ring, rank = _picked(path, rings, contour)
    curves = any(entity.dxftype() in ("SPLINE", "ELLIPSE") for entity in entities)
    form = (
        f"splines and ellipses as chords within {CURVE_CHORDS:g} mm"
        if curves
        else "lines and arcs as they are"
    )
    return Outline(ring, (units, closed, rank), f"{len(ring.points)} edges, {form}")


# ---- meshes ----------------------------------------------------------------------------------------------------------


def _from_mesh(path: Path, height: float | None, contour: int | None) -> Outline:
    content = read_mesh(path)
    mesh = content.mesh
    findings = list(content.findings)
    faults = mesh_faults(mesh)
    findings.append(
        at_most(
            "WATERTIGHT", faults.count, 0, "faults", in_file(path), f"{len(mesh.faces)} triangles"
        )
    )
    low = float(mesh.vertices[:, 2].min())
    high = float(mesh.vertices[:, 2].max())
    z = (low + high) / 2 if height is None else height
    if not low < z < high:
        raise FileError(
            path, f"reaches from z = {low:g} to {high:g} mm; it has no section at {z:g} mm"
        )
    try:
        rings = slice_mesh(mesh, z)
    except ValueError as error:
        return Outline(
            None, (*findings, at_most("CLOSED", 1, 0, "gaps", in_file(path), str(error))), ""
        )
    if not rings:
        raise FileError(path, f"has no section at z = {z:g} mm")
    ring, finding = _picked(path, rings, contour)
    remark = f"section at z = {z:g} mm, {len(ring.points)} edges{'; ' * bool(content.unit)}{content.unit}"
    return Outline(ring, (*findings, finding), remark)
