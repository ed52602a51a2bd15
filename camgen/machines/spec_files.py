"""Files beside a spec, read into its tables: laws, loads, outlines of links."""

from __future__ import annotations

import copy
import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from camgen.bounds import Bound, read_bytes
from camgen.errors import Fault, FileError, Key, SpecError, counted
from camgen.geometry import dxf_curves, svg_curves
from camgen.geometry.chains import Chain, joined, nearest_gap
from camgen.geometry.distances import inside
from camgen.geometry.rings import Floats, Points, Ring
from camgen.motion.tables import load_table, read_points, read_table
from camgen.numerics import coordinates
from camgen.reading import Data, Reference, references, too_large

_READ = ("law", "load", "outline", "line")
_DRAWING = Bound("a drawing of a link's outline", 10_000_000)
_CHORDS = 2e-3  # mm, of curves of an outline that are no arcs: far below what a printer or a laser resolves
_SIZES = (1.0, 1e4)  # mm across: what is smaller or larger has another unit
_MOST_CORNERS = 20_000
_FARTHEST = 1e5  # mm, of a place of a line
_FINE = 1e-3  # mm, chords on which contours are looked at


def with_tables(data: Data, folder: Path, source: str = "spec") -> Data:
    """A spec's tables, in which each law's and each load's `file` is replaced by its points and its name, each link's `outline`
    by its contours and its name, and the `line` of a pen by its places.

    Files are seen from the folder. So the resolved spec needs no other file. SpecError with all that name no file so, and where
    they hold more than a spec may.
    """
    if not any(each.kind in _READ for each in references(data)):
        return data
    data = copy.deepcopy(data)
    faults = list[Fault]()
    values = 0
    for each in [each for each in references(data) if each.kind in _READ]:
        try:
            values += _filled(each, folder)
        except SpecError as error:
            faults += error.faults
            continue
        except FileError as error:
            raise error.named_by(each.path) from None
        if large := too_large(0, values):
            raise SpecError([*faults, *large], source)
    if faults:
        raise SpecError(faults, source)
    return data


def _filled(reference: Reference, folder: Path) -> int:
    """Put what a file holds in its key's place; how many values that is, at least."""
    file = reference.file(folder)
    table = reference.table
    if reference.kind == "outline":
        contours = contours_of(file, reference.path)
        table["drawn_in"] = table.pop("outline")
        table["contours"] = contours
        return 4 * sum(map(len, contours))
    if reference.kind == "line":
        places = line_of(file)
        table["drawn_in"] = table["line"]
        table["line"] = [[round(z.real, 9), round(z.imag, 9)] for z in places.tolist()]
        return 3 * len(table["line"])
    name = table.pop(str(reference.path[-1]))
    if reference.kind == "law":
        table["points"] = [list(point) for point in read_points(file)]
    else:
        table["points"], unit = load_table(file)
        if unit is not None:
            table.setdefault("unit", unit)
    table.setdefault("source", name)
    return 3 * len(table["points"])  # the pair, and its two numbers


def contours_of(path: Path, key: Key) -> list[list[list[float]]]:
    """Contours of a link's outline in an SVG or DXF, the outer one first, then its holes: rows of x, y, mm, and the bulge of the
    edge that begins there, 0 where it is straight.

    FileError where it cannot be read; SpecError where it is no outline of one plate.
    """
    if path.suffix.lower() not in (".svg", ".dxf"):
        raise SpecError([Fault(key, repr(path.name), "a file that ends in .svg or .dxf")])
    rings, loose, others = _lines(path)
    if loose:
        gap = nearest_gap(loose)
        many = counted(len(loose), "open line")
        raise FileError(path, f"has {many}: {gap}; close it, or leave it out")
    if not rings:
        left = f" ({others} cannot be read: make paths of it)" if others else ""
        raise FileError(path, f"holds no closed contour{left}")
    ordered = _nested(path, [ring.counter_clockwise() for ring in rings])
    return [
        [
            [round(z.real, 9), round(z.imag, 9), round(bulge, 12)]
            for z, bulge in zip(ring.points.tolist(), ring.bulges.tolist(), strict=True)
        ]
        for ring in ordered
    ]


def rows_of(path: Path) -> Sequence[tuple[float, float]]:
    """Rows x, y of a file, mm, see `read_table`."""
    rows = read_table(path, "x and y, mm")[1]
    for x, y in rows:
        if not (abs(x) <= _FARTHEST and abs(y) <= _FARTHEST):
            raise FileError(
                path, f"has a point at {x:g}, {y:g}: x and y within +-100000 mm were expected"
            )
    if len(rows) > _MOST_CORNERS:
        raise FileError(path, f"holds {len(rows)} points; at most {_MOST_CORNERS} are taken")
    return rows


def line_of(path: Path) -> Points:
    """Places of the one line of an SVG or DXF, or of a table, in order, (n,) complex mm; of a closed one the first again at its end."""
    if path.suffix.lower() not in (".svg", ".dxf"):
        return np.array([complex(*place) for place in rows_of(path)], complex)
    z, closed = stroke_of(path)
    return np.append(z, z[0]) if closed else z


def stroke_of(path: Path) -> tuple[Points, bool]:
    """The one line of an SVG or DXF: its corners in order, mm, arcs as chords, and whether it closes; FileError where it is not one."""
    rings, loose, others = _lines(path)
    many = len(rings) + len(loose)
    if many != 1:
        left = f" ({others} cannot be read: make paths of it)" if others else ""
        raise FileError(path, f"holds {counted(many, 'line')} apart{left}: a pen draws one line")
    return (_ring(rings[0])[:-1], True) if rings else (_chain(loose[0]), False)


def strokes_of(path: Path) -> list[Points]:
    """The lines of an SVG or DXF, the closed ones first, or the one of a table: as of `line_of`; FileError where there is none."""
    if path.suffix.lower() not in (".svg", ".dxf"):
        return [line_of(path)]
    rings, loose, others = _lines(path)
    if not rings and not loose:
        left = f": {others} cannot be read, make paths of it" if others else ""
        raise FileError(path, f"holds no line{left}")
    return [*map(_ring, rings), *map(_chain, loose)]


def _ring(ring: Ring) -> Points:
    """Its corners, the first again at the end."""
    return _corners(np.append(ring.points, ring.points[0]), ring.bulges)


def _chain(chain: Chain) -> Points:
    """Its corners."""
    return _corners(chain.points, chain.bulges)


def _corners(points: Points, bulges: Floats) -> Points:
    """Corners of edges, each arc as chords."""
    corners = [points[:1]]
    for a, b, bulge in zip(points[:-1], points[1:], bulges, strict=True):
        if not bulge:
            corners.append(np.array([b]))
            continue
        half = 2 * math.atan(bulge)
        radius = abs(b - a) / (2 * abs(math.sin(half)))
        count = max(1, math.ceil(abs(half) / math.acos(max(0.0, 1 - _CHORDS / radius))))
        share = np.arange(1, count + 1) / count
        corners.append(
            a + (b - a) * np.sin(share * half) / math.sin(half) * np.exp(1j * half * (share - 1))
        )
    return np.concatenate(corners)


def _lines(path: Path) -> tuple[list[Ring], list[Chain], str]:
    """The lines of an SVG or DXF, closed and open ones, mm, and what it does not read."""
    content = read_bytes(path, _DRAWING)
    if path.suffix.lower() == ".svg":
        chains, others = svg_curves.curves(path, content, _CHORDS)
    else:
        chains, others = _dxf_chains(path, content)
    return *joined(chains), others


def _dxf_chains(path: Path, content: bytes) -> tuple[list[Chain], str]:
    """The curves of a DXF, mm, and what else it shows; one without a unit is in millimetres, as all lengths of a spec."""
    drawing = dxf_curves.drawing(path, content)
    _, scale = dxf_curves.unit_of(path, drawing, content)
    try:
        shown = dxf_curves.entities(path, drawing, None)
        return dxf_curves.chains(path, shown, scale, _CHORDS)
    except OverflowError as error:
        raise FileError(path, f"takes {error}") from None


def _nested(path: Path, rings: list[Ring]) -> list[Ring]:
    """The largest ring and those within it; FileError where they do not bound one plate."""
    import shapely

    outer, *holes = sorted(rings, key=lambda ring: -ring.area)
    left, low, right, high = outer.box
    size = max(right - left, high - low)
    if not _SIZES[0] <= size <= _SIZES[1]:
        least, most = _SIZES
        raise FileError(
            path, f"is {size:.4g} mm across, not {least:g} to {most:g}: is its unit wrong?"
        )
    corners = sum(len(ring.points) for ring in rings)
    if corners > _MOST_CORNERS:
        raise FileError(
            path, f"has {corners:,} corners; at most {_MOST_CORNERS:,} are read: simplify it"
        )
    edges: list[Points] = [ring.facetted(_FINE) for ring in (outer, *holes)]
    for edge in edges:
        reason = shapely.is_valid_reason(shapely.Polygon(coordinates(edge)))
        if reason != "Valid Geometry":
            place = reason.replace("[", " at (").replace("]", ") mm")
            raise FileError(path, f"has a contour that meets itself: {place}")
    apart = [edge for edge in edges[1:] if not inside(edge, edges[0]).all()]
    if apart:
        raise FileError(
            path,
            f"has {counted(len(apart), 'contour')} not within the largest one: a link is one plate",
        )
    return [outer, *holes]
