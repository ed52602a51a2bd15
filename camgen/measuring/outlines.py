"""Closed outlines from files of any maker: a DXF of lines, arcs, polylines, circles, ellipses and splines, a mesh,
a scan or measured points.

The outline is the largest closed contour, all lengths in mm, in the file's own frame. Unlike `read_dxf`, which is strict with
our own files, this reads what others write and says what it made of it.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from graphlib import CycleError, TopologicalSorter
from pathlib import Path
from typing import Any

import numpy as np

from camgen.bounds import bounded
from camgen.errors import FileError, counted
from camgen.files.formats import READABLE
from camgen.files.shelves import located
from camgen.findings import Finding, at_least, at_most, in_file
from camgen.geometry.chains import Chain, joined, nearest_gap
from camgen.geometry.distances import inside
from camgen.geometry.mesh import mesh_faults, slice_mesh
from camgen.geometry.rings import Floats, Ints, Points, Ring
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
from camgen.study import Figure, Figures
from camgen.tolerances import CURVE_CHORDS, SAME_POINT

_SIZES = {f".{kind}": READABLE[kind].size for kind in ("dxf", "gcode")}
_SIZES |= {**MESH_SIZES, ".csv": POINTS_SIZE, **dict.fromkeys(PICTURES, PICTURE_SIZE)}
ENDINGS = tuple(_SIZES)
_HEAD = 4096  # bytes that tell what a file is
_MOST_POINTS = 500_000
# of a drawing: those that blocks stand for, those that curves become
_MOST_ENTITIES = 50_000
_MOST_CHORDS = 2_000_000
# of a spline
_MOST_FIT_POINTS = 5_000
_MOST_DEGREE = 24
# mm across: beyond it the unit is wrong, or float64 does not resolve SAME_POINT
_LEAST_SIZE = 0.1
_MOST_SIZE = 1e5
_RIVAL = 0.25  # of the outline's area: a contour within it that is larger is no bore
_BEYOND = 1e12  # mm, and bulge: what no drawing means
_NESTED = 16  # blocks within blocks
_MILLIMETRES = 4
_UNITLESS = 0
# $INSUNITS of a DXF: name and mm.
_DXF_UNITS = {
    1: ("inches", 25.4),
    2: ("feet", 304.8),
    3: ("miles", 1_609_344.0),
    4: ("millimetres", 1.0),
    5: ("centimetres", 10.0),
    6: ("metres", 1e3),
    7: ("kilometres", 1e6),
    8: ("microinches", 25.4e-6),
    9: ("mils", 0.0254),
    10: ("yards", 914.4),
    13: ("micrometres", 1e-3),
    14: ("decimetres", 100.0),
}


@dataclass(frozen=True)
class Outline:
    """What a file holds."""

    ring: Ring | None  # counter-clockwise, mm; None where a finding says why
    findings: tuple[Finding, ...]
    remark: str  # a sentence on the reading
    numbers: Figures = field(default_factory=Figures)  # of what measured it


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
    path = located(path)
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


def _picked(path: Path, rings: Sequence[Ring], contour: int | None) -> tuple[Ring, Finding]:
    """The contour of that rank by size, and CONTOUR: how many others could be meant where no rank is asked for.

    A bore or keyway within a cam is small and holds no contour itself; a frame or a sheet's border holds a cam with its bore.
    """
    rank = contour or 1
    if rank > len(rings):
        raise FileError(
            path, f"holds {counted(len(rings), 'closed contour')}: there is no contour={rank}"
        )
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
            path, f"has an outline of {len(ring.points)} points; {_MOST_POINTS} at most are taken"
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
    polygon = shapely.Polygon(np.column_stack([z.real, z.imag]))
    return "" if shapely.is_valid(polygon) else str(shapely.is_valid_reason(polygon))


def _from_gcode(path: Path, hints: Hints, contour: int | None) -> Outline:
    from camgen.files.gcode import printed_outlines

    rings, remark = printed_outlines(path, hints.height, hints.line_width)
    ring, finding = _picked(path, rings, contour)
    return Outline(ring, (finding,), f"{finding.message}; {remark}")


def _from_scan(path: Path, contour: int | None, scanning: Scanning) -> Outline:
    scan = scanned(path, scanning)
    ring, finding = _picked(path, scan.rings, contour)
    remark = "the least grey levels, of 255, by which the part stands off its ground"
    contrast = at_least("CONTRAST", scan.contrast, LEAST_CONTRAST, "levels", in_file(path), remark)
    return Outline(ring, (finding, contrast), f"{finding.message}; {scan.remark}", scan.numbers)


# ---- DXF -------------------------------------------------------------------------------------------------------------


def _from_dxf(path: Path, content: bytes, layer: str | None, contour: int | None) -> Outline:
    drawing = _drawing(path, content)
    # the library makes up metres where the header says nothing
    code = int(drawing.header.get("$INSUNITS", _UNITLESS)) if b"$INSUNITS" in content else _UNITLESS
    unit, scale = _DXF_UNITS.get(
        code, ("no unit", 1.0) if code == _UNITLESS else (f"unit number {code}", math.nan)
    )
    if math.isnan(scale):
        raise FileError(path, f"is drawn in {unit} of $INSUNITS; millimetres (4) were expected")
    entities = _entities(path, drawing, layer)
    chains, others = _chains(path, entities, scale)
    if not chains:
        raise FileError(path, f"holds no outline: {others or 'it is empty'}")
    units = at_most(
        "DXF_UNITS",
        code not in (_MILLIMETRES, _UNITLESS),
        0,
        "faults",
        in_file(path),
        "drawn in millimetres"
        if code == _MILLIMETRES
        else "the drawing names no unit: taken as millimetres"
        if code == _UNITLESS
        else f"drawn in {unit}: multiplied by {scale:g}; save it in millimetres if that is wrong",
    )
    rings, loose = joined(chains)
    if not rings and not loose:
        raise FileError(path, "holds no outline: all that is drawn has no size")
    biggest = max(rings, key=lambda ring: abs(ring.area), default=None)
    size = max(np.ptp(biggest.points.real), np.ptp(biggest.points.imag)) if biggest else 0.0
    wide = [chain for chain in loose if chain.size >= size and not (biggest and chain.straight)]
    gap, remark = nearest_gap(wide)
    closed = at_most(
        "DXF_CLOSED",
        gap,
        0,
        "mm",
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


def _drawing(path: Path, content: bytes) -> Any:
    """The drawing as ezdxf reads it."""
    from ezdxf.filemanagement import readfile
    from ezdxf.lldxf.const import DXFError

    if not content.rstrip(b"\x00\x1a \t\r\n").endswith(b"EOF"):
        raise FileError(path, "not a DXF file, or cut short: it does not end in EOF")
    try:
        return readfile(str(path))
    except (
        DXFError,
        OSError,
        UnicodeDecodeError,
        ValueError,
        TypeError,
        IndexError,
        KeyError,
        AttributeError,
    ) as error:
        raise FileError(path, f"not a valid DXF file: {error}") from None


def _entities(path: Path, drawing: Any, layer: str | None) -> list[Any]:
    """What the modelspace shows on a layer, or on all that are on."""
    from ezdxf.lldxf.const import DXFError

    try:
        _refuse_bomb(path, drawing)
        hidden = {
            str(each.dxf.name).lower()
            for each in drawing.layers
            if each.is_off() or each.is_frozen()
        }
        entities = []
        for entity in _exploded(drawing.modelspace()):
            name = str(entity.dxf.layer).lower()
            if name not in hidden if layer is None else name == layer.lower():
                entities.append(entity)
    except DXFError as error:
        raise FileError(path, f"not a valid DXF file: {error}") from None
    if layer is not None and not entities:
        layers = sorted({str(entity.dxf.layer) for entity in drawing.modelspace()})
        raise FileError(
            path, f"has nothing on layer {layer!r}; its layers are {', '.join(layers) or 'empty'}"
        )
    return entities


def _chains(path: Path, entities: Sequence[Any], scale: float) -> tuple[list[Chain], str]:
    """The curves among the entities, mm, and what the others are."""
    chains = []
    others = Counter[str]()
    chords = 0
    for entity in entities:
        chain = _chain(entity, CURVE_CHORDS / scale)
        chords += len(chain.bulges) if chain else 0
        if chords > _MOST_CHORDS:
            raise FileError(
                path, f"has curves of more than {_MOST_CHORDS} chords within {CURVE_CHORDS:g} mm"
            )
        if chain is None:
            others[entity.dxftype()] += 1
        elif not (
            np.all(np.abs(chain.points) * scale < _BEYOND)
            and np.all(np.abs(chain.bulges) < _BEYOND)
        ):
            what = "a coordinate that is not finite, or as good as infinite"
            raise FileError(path, f"{entity.dxftype()} #{entity.dxf.handle} has {what}")
        else:
            chains.append(Chain(chain.points * scale, chain.bulges, chain.closed))
    return chains, ", ".join(f"{count} {kind}" for kind, count in sorted(others.items()))


def _refuse_bomb(path: Path, drawing: Any) -> None:
    """FileError where blocks within blocks stand for more than _MOST_ENTITIES, or one holds itself."""
    inside: dict[str, list[tuple[str, int]]] = {}
    counts: dict[str, int] = {}
    for block in drawing.blocks:  # the modelspace is one of them
        references = [
            (str(e.dxf.name).lower(), max(e.mcount, 1)) for e in block if e.dxftype() == "INSERT"
        ]
        inside[block.name.lower()] = references
        counts[block.name.lower()] = len(block)
    try:
        for name in TopologicalSorter(
            {
                name: {other for other, _ in references_held}
                for name, references_held in inside.items()
            }
        ).static_order():
            counts[name] = counts.get(name, 0) + sum(
                times * counts[other] for other, times in inside.get(name, ())
            )
    except CycleError as error:
        raise FileError(path, f"has a block that holds itself: {error.args[1][0]}") from None
    most = max(
        counts[block.name.lower()] - len(block) for block in drawing.blocks if block.is_modelspace
    )
    if most > _MOST_ENTITIES:
        number = str(most) if most < 1e9 else f"about 1e{len(str(most)) - 1}"
        raise FileError(
            path,
            f"holds blocks that stand for {number} entities; {_MOST_ENTITIES} at most are read",
        )


def _exploded(entities: Iterable[Any], depth: int = 0) -> Iterator[Any]:
    """The entities, with block references replaced by what they show."""
    for entity in entities:
        if entity.dxftype() == "INSERT" and depth < _NESTED:
            for single in entity.multi_insert() if entity.mcount > 1 else (entity,):
                yield from _exploded(single.virtual_entities(), depth + 1)
        else:
            yield entity


def _chain(entity: Any, tolerance: float) -> Chain | None:
    """The curve of an entity in the world's xy plane, drawing units; None for what is no curve, or not in that plane."""
    kind = entity.dxftype()
    dxf = entity.dxf
    if kind == "LINE":
        return Chain(_plane([dxf.start, dxf.end]), np.zeros(1))
    if kind in ("SPLINE", "ELLIPSE"):
        try:
            points = _spline(entity, tolerance) if kind == "SPLINE" else _ellipse(entity, tolerance)
        except (ValueError, ZeroDivisionError, IndexError):
            return None
        return _open_or_closed(points, np.zeros(len(points) - 1)) if len(points) > 1 else None
    if (
        kind not in ("ARC", "CIRCLE", "LWPOLYLINE", "POLYLINE")
        or abs(abs(dxf.extrusion.z) - 1) > 1e-9
    ):
        return None
    if kind in ("ARC", "CIRCLE"):
        centre = complex(dxf.center.x, dxf.center.y)
        radius = float(dxf.radius)
        start = 0.0
        sweep = math.tau
        if kind == "ARC":
            start = math.radians(dxf.start_angle)
            sweep = math.radians((dxf.end_angle - dxf.start_angle) % 360) or math.tau
        angles = start + np.linspace(0, sweep, 3)
        points = centre + radius * np.exp(1j * angles)
        bulges = np.full(2, math.tan(sweep / 8))
    elif kind == "LWPOLYLINE":
        rows = np.array(entity.get_points("xyb"), float).reshape(-1, 3)
        points, bulges = _round(rows, entity.closed)
    else:
        if not (entity.is_2d_polyline or entity.is_3d_polyline):
            return None
        rows = np.array(
            [
                (v.dxf.location.x, v.dxf.location.y, v.dxf.get("bulge", 0.0))
                for v in entity.vertices
            ],
            float,
        )
        points, bulges = _round(rows.reshape(-1, 3), entity.is_closed)
    if len(points) < 2:
        return None
    if dxf.extrusion.z < 0:  # drawn from below: mirrored in the y axis
        points = -np.conj(points)
        bulges = -bulges
    return _open_or_closed(points, bulges)


def _open_or_closed(points: Points, bulges: Floats) -> Chain:
    return Chain(points, bulges, abs(points[0] - points[-1]) <= SAME_POINT)


def _ellipse(entity: Any, tolerance: float) -> Points:
    """Chords of an ellipse in even steps of its parameter t, of which c + a cos t + b sin t is at most |a| step^2 / 8 off."""
    dxf = entity.dxf
    centre, a, b = (complex(p.x, p.y) for p in (dxf.center, dxf.major_axis, entity.minor_axis))
    sweep = (dxf.end_param - dxf.start_param) % math.tau or math.tau
    count = max(math.ceil(sweep / math.sqrt(8 * tolerance / dxf.major_axis.magnitude)), 6)
    if count > _MOST_POINTS:
        raise OverflowError(
            f"{count} chords for ELLIPSE #{dxf.handle}; {_MOST_POINTS} at most are made"
        )
    t = dxf.start_param + np.linspace(0, sweep, count + 1)
    points = centre + a * np.cos(t) + b * np.sin(t)
    return np.append(points[:-1], points[:1]) if sweep == math.tau else points


def _spline(entity: Any, tolerance: float) -> Points:
    """Chords of a spline, which is drawn from knot p to knot n, p its degree and n the number of its control points.

    Between them lies all of a clamped one, and of a closed one whose knots are not clamped what is meant.
    """
    if not len(entity.control_points) and len(entity.fit_points) > _MOST_FIT_POINTS:
        many = len(entity.fit_points)
        raise OverflowError(
            f"{many} points to fit SPLINE #{entity.dxf.handle} to; {_MOST_FIT_POINTS} at most do"
        )
    if entity.dxf.degree > _MOST_DEGREE:
        raise OverflowError(
            f"a degree of {entity.dxf.degree} for SPLINE #{entity.dxf.handle}; {_MOST_DEGREE} at most is read"
        )
    tool = entity.construction_tool()
    knots = np.array(tool.knots(), float)
    degree = int(tool.degree)
    points = np.array([p.xyz for p in tool.control_points], float)
    weights = np.array(tool.weights(), float)
    if len(knots) != len(points) + degree + 1 or np.any(np.diff(knots) < 0):
        raise ValueError("a knot vector that does not fit")
    begin = knots[degree]
    end = knots[-1 - degree]
    if not end > begin:
        raise ValueError("a knot vector of no length")
    from scipy.interpolate import BSpline

    weights = weights if len(weights) else np.ones(len(points))
    curve = BSpline(knots, np.column_stack([points[:, :2] * weights[:, None], weights]), degree)

    def at(t: Floats) -> Points:
        x, y, w = curve(t).T
        return np.asarray((x + 1j * y) / w)

    t = np.unique(np.clip(knots, begin, end))
    t = np.unique(
        np.concatenate(
            [t[:-1] + fraction * np.diff(t) for fraction in (0, 0.25, 0.5, 0.75)] + [t[-1:]]
        )
    )
    while len(t) < _MOST_POINTS:
        z = at(t)
        step = np.diff(t)
        off = [
            np.abs(at(t[:-1] + fraction * step) - z[:-1] - fraction * np.diff(z))
            for fraction in (0.25, 0.5, 0.75)
        ]
        far = np.flatnonzero(~(np.max(off, axis=0) <= tolerance))
        if not len(far):
            return at(t)
        t = np.sort(np.concatenate([t, t[far] + step[far] / 2]))
    raise OverflowError(f"more than {_MOST_POINTS} chords for SPLINE #{entity.dxf.handle}")


def _plane(points: Iterable[Any]) -> Points:
    return np.array([complex(p.x, p.y) for p in points])


def _round(rows: Floats, closed: bool) -> tuple[Points, Floats]:
    """Points and bulges of (n, 3) rows x, y, bulge; a closed polyline ends at its first point."""
    points = rows[:, 0] + 1j * rows[:, 1]
    bulges = rows[:, 2]
    return (np.append(points, points[:1]), bulges) if closed else (points, bulges[:-1])


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
