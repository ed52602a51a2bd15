"""DXF documents: millimetres, every contour one closed entity, the same bytes on every day; what is read is held to that.

Format R2010: the oldest that LibreCAD, GDAL and the laser shops' programs all read and that carries units.
"""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from camgen.bounds import read_bytes
from camgen.errors import FileError, counted
from camgen.files.dxf_edges import add_edges, add_spline, ring_of_spline, rings_of_edges
from camgen.files.formats import FORMATS, Curves, Drawing, DrawingFault, Job
from camgen.geometry.arcs import as_circle, bulges, fit_arcs
from camgen.geometry.distances import point_to_ring
from camgen.geometry.facets import facet_contour
from camgen.geometry.outlines import Contour, Points, Region, extent, polygon
from camgen.geometry.rings import Ring
from camgen.tolerances import SAME_POINT

# What a laser takes, and what it leaves: name -> (colour index, line weight in 1/100 mm).
CUT_LAYER = "CUT"
MARK_LAYER = "CENTER"
ENGRAVE_LAYER = "ENGRAVE"
_CUT = {CUT_LAYER: (7, 25)}
_MARKS = {MARK_LAYER: (1, 13)}
_ENGRAVE = {ENGRAVE_LAYER: (5, 13)}
MILLIMETRES = 4  # $INSUNITS
# Half length of the strokes of a centre mark, mm; at most this share of the way to the nearest contour, so that a whole
# stroke is shorter than the hole's radius; a mark of less than the smallest half length is left out.
_MARK = 1.0
_MARK_SHARE = 0.4
_SMALLEST_MARK = 0.1
_NEAR = 1e-3  # mm, chord tolerance of the contours to which that way is measured
# What an entity says of its place and shape; all else (visibility, width, colour, line type) is to be as nobody set it.
_SHAPE = {
    "handle",
    "owner",
    "layer",
    "count",
    "flags",
    "center",
    "radius",
    "start",
    "end",
    "elevation",
    "extrusion",
    "start_angle",
    "end_angle",
    "degree",
    "n_knots",
    "n_control_points",
}


@contextmanager
def document(
    path: Path, layers: Mapping[str, tuple[int, int]], box: tuple[complex, complex]
) -> Iterator[Any]:
    """An empty modelspace (ezdxf) to fill; saved to `path` on leaving.

    layers: name -> (colour index, line weight in 1/100 mm); box: lower left and upper right corner of the content, mm.
    """
    import ezdxf.filemanagement
    from ezdxf import units
    from ezdxf._options import options

    # No clock and no chance in the file; ezdxf offers this as a global option only.
    setting = options.write_fixed_meta_data_for_testing
    options.write_fixed_meta_data_for_testing = True
    try:
        doc = ezdxf.filemanagement.new("R2010", setup=False)
        doc.units = units.MM
        doc.header["$MEASUREMENT"] = 1
        doc.linetypes.add(
            "CENTER2", [12.0, 8.0, -1.5, 1.0, -1.5], description="Center ____ _ ____ _"
        )
        for name, (colour, weight) in layers.items():
            doc.layers.add(name, color=colour, lineweight=weight)
        space = doc.modelspace()
        space.reset_extents((box[0].real, box[0].imag, 0), (box[1].real, box[1].imag, 0))
        yield space
        # Left alone, ezdxf lists classes in the order of a set of strings, which differs from run to run.
        for name in sorted(doc.entitydb.dxf_types_in_use()):
            doc.classes.add_class(name)
        text = io.StringIO()
        doc.write(text)
    finally:
        options.write_fixed_meta_data_for_testing = setting
    path.write_bytes(text.getvalue().replace("\n-0.0\n", "\n0.0\n").encode("utf-8"))


def add_contour(space: Any, contour: Contour, layer: str, curves: Curves = "bulge") -> None:
    """Add a contour of lines and arcs as ONE entity: a CIRCLE, or a closed LWPOLYLINE with every |bulge| < 1, or a SPLINE.

    With curves = "arcs" a LINE or ARC for each edge in place of a polyline.
    """
    circle = as_circle(contour)
    if circle:
        centre, radius = circle
        space.add_circle((centre.real, centre.imag), radius, dxfattribs={"layer": layer})
        return
    points, bulge = bulges(contour)
    if curves in ("arcs", "spline"):
        (add_edges if curves == "arcs" else add_spline)(space, points, bulge, layer)
        return
    line = space.add_lwpolyline([], close=True, dxfattribs={"layer": layer})
    # `add_lwpolyline` takes a time that grows with the square of the number of points, this does not.
    corners = zip(points.tolist(), bulge.tolist(), strict=True)
    line.lwpoints.set([(z.real, z.imag, 0.0, 0.0, b) for z, b in corners])


# ---- a part to cut -------------------------------------------------------------------------------------------------------


def write_part(path: Path, job: Job) -> None:
    """Write the part's drawing."""
    write_dxf(path, job.region, job.centres, job.tolerance, job.curves, job.engraved)


def write_dxf(
    path: Path,
    region: Region,
    centres: Sequence[complex],
    tolerance: float,
    curves: Curves = "bulge",
    engraved: Sequence[Contour] = (),
) -> None:
    """Write a region's contours on layer CUT, a mark at each centre on layer CENTER, engraved ones on ENGRAVE, nothing else.

    Full circles are CIRCLEs; the others are polylines of arcs within tolerance ("bulge"), mm, or for readers without
    bulges chords ("lines"), LINEs and ARCs ("arcs") or a SPLINE each. Outer contour first, counter-clockwise like the holes.
    """

    def flat(contour: Contour) -> Contour:
        contour = contour.counter_clockwise()
        if curves == "lines" and not as_circle(contour):
            ring: Points = facet_contour(contour, tolerance)
            return polygon(ring.tolist())
        return fit_arcs(contour, tolerance)

    contours, engravings = (
        [flat(contour) for contour in each] for each in ((region.outer, *region.holes), engraved)
    )
    marks = center_marks(region, centres)
    box = extent([*contours, *(polygon(stroke) for stroke in marks.tolist())])
    layers = _CUT | (_MARKS if len(marks) else {}) | (_ENGRAVE if engravings else {})
    with document(path, layers, box) as space:
        for layer, contour in [
            *((CUT_LAYER, each) for each in contours),
            *((ENGRAVE_LAYER, each) for each in engravings),
        ]:
            add_contour(space, contour, layer, curves)
        for a, b in marks.tolist():
            space.add_line((a.real, a.imag), (b.real, b.imag), dxfattribs={"layer": MARK_LAYER})


def center_marks(region: Region, centres: Sequence[complex]) -> Points:
    """Strokes of crosses at the centres, (n, 2) complex mm: they end in the open, never on a contour of the region."""
    if not centres:
        return np.empty((0, 2), complex)
    rings = [facet_contour(contour, _NEAR) for contour in (region.outer, *region.holes)]
    middles = np.array(centres, complex)
    near = np.min([point_to_ring(middles, ring) for ring in rings], axis=0)
    reach = np.minimum(_MARK, _MARK_SHARE * near)
    strokes = [
        (z - r * way, z + r * way)
        for z, r in zip(middles, reach, strict=True)
        if r >= _SMALLEST_MARK
        for way in (1, 1j)
    ]
    return np.array(strokes, complex).reshape(-1, 2)


# ---- read back ---------------------------------------------------------------------------------------------------------


def _ring_of(entity: Any) -> tuple[Ring | None, list[DrawingFault]]:
    """Ring of a DXF entity (None when it does not bound anything) and what is wrong with the entity."""
    kind = entity.dxftype()
    name = f"{kind} #{entity.dxf.handle}"
    faults = []
    if kind == "CIRCLE":
        centre = complex(*entity.dxf.center.vec2)
        radius = float(entity.dxf.radius)
        if not 0 < radius < 1e9:
            return None, [DrawingFault("number", 1, f"{name} has the radius {radius:g}")]
        points = centre + radius * np.array([1 + 0j, -1])
        bulges = np.ones(2)
        raised = entity.dxf.center.z
    elif kind == "LWPOLYLINE":
        rows = np.array(entity.get_points("xybse"), float).reshape(-1, 5)
        points = rows[:, 0] + 1j * rows[:, 1]
        bulges = rows[:, 2]
        raised = entity.dxf.elevation
        if rows[:, 3:].any():
            faults.append(DrawingFault("look", 1, f"{name} has a width"))
    else:
        return None, [DrawingFault("entity", 1, f"{name} is not a closed polyline or a circle")]
    if not (np.isfinite(points).all() and np.isfinite(bulges).all()):
        return None, [DrawingFault("number", 1, f"{name} has a coordinate that is not finite")]
    if raised != 0 or tuple(entity.dxf.extrusion) != (0, 0, 1):
        faults.append(DrawingFault("plane", 1, f"{name} is mirrored or raised off the plane z = 0"))
    if kind == "LWPOLYLINE" and not entity.closed:
        gap = float(abs(points[-1] - points[0])) if len(points) else 0.0
        return None, [
            *faults,
            DrawingFault("open", gap, f"{name} is open, with a gap of {gap:.6g} mm"),
        ]
    solid = np.abs(np.roll(points, -1) - points) > SAME_POINT
    if not solid.all():
        empty = int(np.count_nonzero(~solid))
        faults.append(
            DrawingFault(
                "zero_length", empty, f"{name} has {counted(empty, 'segment')} of no length"
            )
        )
    ring = Ring(points[solid], bulges[solid])
    if len(ring.points) < 2 or (len(ring.points) == 2 and not ring.bulges.any()):
        return None, [*faults, DrawingFault("entity", 1, f"{name} bounds no area")]
    return ring, faults


def _same(a: Ring, b: Ring) -> bool:
    """Whether two rings bound the same area, wherever they begin and whichever way they run."""
    first, second = (np.array([*ring.box, abs(ring.area), ring.length]) for ring in (a, b))
    return bool(np.allclose(first, second, rtol=1e-9, atol=1e-6))


def _repeated(ring: Ring, earlier: Sequence[Ring], name: str) -> Iterator[DrawingFault]:
    """A fault where a ring is the same as an earlier one: it would be cut twice."""
    if any(_same(ring, other) for other in earlier):
        yield DrawingFault("duplicate", 1, f"{name} repeats an earlier contour")


def read_part(path: Path, name: str) -> Drawing:
    """The drawing of a part; the file does not name it."""
    return read_dxf(path, engraving=True, any_curves=True)


def read_dxf(path: str | Path, engraving: bool = False, any_curves: bool = False) -> Drawing:
    """Read a DXF file; FileError when it cannot be read, is no DXF or is cut short.

    Closed LWPOLYLINE (with bulges) and CIRCLE (as two half-circles from its rightmost point) on CUT become rings, LINEs on
    CENTER marks, and where engraving may be there rings on ENGRAVE as well; any_curves: so do LINEs and ARCs end on end, and
    SPLINEs that are made of such. Whatever else there is, or looks otherwise than drawn plainly, is a fault: somebody's laser
    will cut it, or leave it out.
    """
    drawing = _opened(path)
    taken = _Taken(engraving, any_curves, [*_hidden_layers(drawing), *_elsewhere(drawing)])
    for entity in drawing.modelspace():
        taken.entity(entity)
    taken.close(path)
    layers = {
        layer.dxf.name.upper(): (layer.dxf.color, layer.dxf.lineweight) for layer in drawing.layers
    }
    ours = {
        name: look
        for name, look in layers.items()
        if name in (CUT_LAYER, MARK_LAYER, ENGRAVE_LAYER)
    }
    return Drawing(
        drawing.header.get("$INSUNITS"),
        tuple(taken.rings),
        np.array(taken.marks, complex).reshape(-1, 2),
        tuple(taken.faults),
        tuple(taken.engraved),
        ours,
        taken.curves,
    )


@dataclass
class _Taken:
    """What is taken of a drawing, entity by entity; engraving, any_curves: as in `read_dxf`."""

    engraving: bool
    any_curves: bool
    faults: list[DrawingFault]
    rings: list[Ring] = field(default_factory=list)
    engraved: list[Ring] = field(default_factory=list)
    marks: list[tuple[complex, complex]] = field(default_factory=list)
    edges: dict[str, list[Any]] = field(default_factory=dict)  # lines and arcs of each layer
    curves: Curves = "bulge"

    def entity(self, entity: Any) -> None:
        """Take an entity by its layer and kind."""
        layer = str(entity.dxf.layer).upper() if entity.dxf.is_supported("layer") else "?"
        kind = entity.dxftype()
        if (layer, kind) == (MARK_LAYER, "LINE"):
            self._mark(entity)
        elif layer != CUT_LAYER and not (self.engraving and layer == ENGRAVE_LAYER):
            message = f"{kind} #{entity.dxf.handle} on layer {layer} is no part of a cut"
            self.faults.append(DrawingFault("entity", 1, message))
            return
        elif self.any_curves and kind in ("LINE", "ARC"):
            self._edge(entity, layer, kind)
        else:
            self._contour(entity, layer, kind)
        self.faults += _looks(entity)

    def _mark(self, line: Any) -> None:
        start = line.dxf.start
        end = line.dxf.end
        self.marks.append((complex(*start.vec2), complex(*end.vec2)))
        if start.z or end.z:
            message = f"LINE #{line.dxf.handle} is raised off the plane z = 0"
            self.faults.append(DrawingFault("plane", 1, message))

    def _edge(self, entity: Any, layer: str, kind: str) -> None:
        self.curves = "arcs"
        self.edges.setdefault(layer, []).append(entity)
        places = ("center",) if kind == "ARC" else ("start", "end")
        raised = any(entity.dxf.get(place).z for place in places)
        if raised or tuple(entity.dxf.extrusion) != (0, 0, 1):
            message = f"{kind} #{entity.dxf.handle} is mirrored or raised off the plane z = 0"
            self.faults.append(DrawingFault("plane", 1, message))

    def _contour(self, entity: Any, layer: str, kind: str) -> None:
        spline = ring_of_spline(entity) if self.any_curves and kind == "SPLINE" else None
        if spline is not None:
            self.curves = "spline"
        ring, faults = _ring_of(entity) if spline is None else (spline, [])
        self.faults += faults
        if ring is not None:
            self._ring(ring, layer, f"#{entity.dxf.handle}")

    def _ring(self, ring: Ring, layer: str, what: str) -> None:
        self.faults += _repeated(ring, self.rings, what)
        (self.rings if layer == CUT_LAYER else self.engraved).append(ring)

    def close(self, path: str | Path) -> None:
        """Make rings of lines and arcs end on end."""
        for layer, pieces in self.edges.items():
            closed, gaps = rings_of_edges(path, pieces)
            for ring in closed:
                self._ring(ring, layer, "a ring of lines and arcs")
            for gap in gaps:
                message = f"lines and arcs on {layer} are open, with a gap of {gap:.6g} mm"
                self.faults.append(DrawingFault("open", gap, message))


def read_contours(path: Path) -> tuple[list[Ring], list[str]]:
    """What a dimensioned drawing shows of the part's contours, those on CUT, and what is wrong with one of them, or its unit;
    FileError as for `read_dxf`."""
    drawing = _opened(path)
    rings = [_ring_of(entity) for entity in drawing.modelspace().query(f"*[layer=='{CUT_LAYER}']")]
    messages = [fault.message for _, faults in rings for fault in faults]
    units = drawing.header.get("$INSUNITS")
    messages += (
        [] if units == MILLIMETRES else [f"$INSUNITS is {units}, millimetres are {MILLIMETRES}"]
    )
    return [ring for ring, _ in rings if ring is not None], messages


def _opened(path: str | Path) -> Any:
    """The document (ezdxf) of a file; FileError where it cannot be read, is no DXF or is cut short."""
    from ezdxf.filemanagement import readfile
    from ezdxf.lldxf.const import DXFError

    try:
        text = read_bytes(Path(path), FORMATS["dxf"].size)
        if not text.rstrip().endswith(b"EOF"):
            raise FileError(path, "not a DXF file, or cut short: it does not end in EOF")
        return readfile(str(path))
    except OSError as error:
        raise FileError(path, error.strerror or str(error)) from None
    except (DXFError, UnicodeDecodeError, ValueError, TypeError, IndexError) as error:
        raise FileError(path, f"not a valid DXF file: {error}") from None


def _looks(entity: Any) -> Iterator[DrawingFault]:
    """What is set of an entity that could hide it, thicken it or send it to another tool."""
    for key, value in entity.dxfattribs().items():
        if key not in _SHAPE and value != entity.dxf.dxf_default_value(key):
            yield DrawingFault(
                "look", 1, f"{entity.dxftype()} #{entity.dxf.handle} has {key} {value}"
            )


def _hidden_layers(drawing: Any) -> Iterator[DrawingFault]:
    """Layers of what is cut or marked that some program would not show, plot or send to the machine."""
    for layer in drawing.layers:
        states = {
            "off": layer.is_off(),
            "frozen": layer.is_frozen(),
            "locked": layer.is_locked(),
            "not plotted": not layer.dxf.plot,
            "transparent": layer.transparency > 0,
            "dashed": layer.dxf.linetype.upper() != "CONTINUOUS",
            "in a true colour": layer.dxf.hasattr("true_color"),
        }
        words = ", ".join(name for name in states if states[name])
        if words and layer.dxf.name.upper() in (CUT_LAYER, MARK_LAYER, ENGRAVE_LAYER):
            yield DrawingFault("layer", 1, f"layer {layer.dxf.name} is {words}")


def _elsewhere(drawing: Any) -> Iterator[DrawingFault]:
    """What is drawn outside the modelspace: on paper, or in blocks."""
    for block in drawing.blocks:
        if len(block) and not block.is_modelspace:
            yield DrawingFault(
                "entity",
                len(block),
                f"{block.name} holds {len(block)} entities, only the modelspace is cut",
            )
