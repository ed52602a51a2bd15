"""What the further views of a drawing show of a part, mm of the part, before it is laid on paper.

    side      from the left, heights to the right: z + iy
    above     along y, heights downwards on paper: x + iz
    section   a cut along x, seen from above as well: x + iz

Hidden edges are those of holes and bores behind material, as the boxes that they fill.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from camgen.files.dimensions import hole_of, turns
from camgen.geometry.arcs import as_circle, fit_arcs
from camgen.geometry.facets import facet_contour, reach
from camgen.geometry.outlines import Contour, Floats, Region, extent, polygon, rectangle
from camgen.numerics import coordinates, distinct
from camgen.parts.part import Layer, Part
from camgen.tolerances import SAME_POINT

_FINE = 1e-5  # mm, chord tolerance of radii in a cam's table
# Of what is drawn and of these radii the least chord tolerance, by the outline's size: a sheet does not show more, and the points
# of a large outline stay few.
_SEEN = 1e-6
_WRITTEN = 1e-8
_MOST = 40  # layers of a part that gets a section
_STEP = 0.02  # mm, between two faces seen behind a section, from which on there is an edge
_BESIDE = 1e-7  # mm, to either side of a corner
_SHARP = 0.05  # rad, by which an outline turns where faces of it meet in an edge


def corners(contour: Contour, tolerance: float) -> Floats:
    """Corners of a contour as a polygon, (n, 2) mm."""
    return coordinates(facet_contour(contour, max(tolerance, _SEEN * reach(contour))))


def area(region: Region, tolerance: float) -> Any:
    """A region as a polygon of shapely."""
    import shapely

    return shapely.Polygon(
        corners(region.outer, tolerance), [corners(hole, tolerance) for hole in region.holes]
    )


def contours_of(shape: Any) -> Iterator[Contour]:
    """Outlines and holes of what shapely gives."""
    import shapely

    for piece in shapely.get_parts(shape):
        rings = (piece.exterior, *piece.interiors) if piece.geom_type == "Polygon" else ()
        yield from (
            polygon((shapely.get_coordinates(ring)[:-1] @ np.array([1, 1j])).tolist())
            for ring in rings
        )


def from_above(part: Part, profile: Region, tolerance: float) -> list[Contour]:
    """What the view along y shows of a crossed part: of each layer the second outline, as far as the layer goes."""
    import shapely

    whole = area(profile, tolerance)
    contours = list[Contour]()
    for layer in part.layers:
        low, high = extent([layer.region.outer])
        contours += contours_of(
            whole.intersection(shapely.box(low.real, layer.z0, high.real, layer.z1))
        )
    return contours


# ---- hidden edges ----------------------------------------------------------------------------------------------------


def behind(part: Part, layer: Layer, contour: Contour, tolerance: float) -> bool:
    """Whether the view along z shows nothing of a layer's contour: it lies in the material over it, or the part is crossed and its
    drawn layer is over it."""
    if part.side_profile is not None:
        return layer.z1 <= part.drawn.z0
    import shapely

    over = [area(each.region, tolerance) for each in part.layers if each.z0 >= layer.z1]
    material = shapely.union_all(over).buffer(-2 * tolerance)  # an edge of both is seen
    return bool(material.contains(shapely.LinearRing(corners(contour, tolerance))))


def _span(region: Region, x: float, tolerance: float) -> tuple[float, float]:
    """From where to where a region reaches on the upright line at x."""
    import shapely

    shape = area(region, tolerance)
    _, low, _, high = shape.bounds
    chord = shape.intersection(shapely.LineString([(x, low - 1), (x, high + 1)]))
    return (low, high) if chord.is_empty else (chord.bounds[1], chord.bounds[3])


def side_bores(part: Part, tolerance: float) -> list[Contour]:
    """Boxes of the bores in the view from the left: z + iy, those of one width joined where layers lie on each other."""
    boxes = [
        rectangle(complex(a, y0), complex(b, y1)) for y0, y1, a, b in _boxes(part, tolerance, 1)
    ]
    across = _across(part, tolerance)
    return boxes + [
        rectangle(complex(low.imag, y0), complex(high.imag, y1)) for low, high, y0, y1 in across
    ]


def plan_bores(part: Part, tolerance: float) -> list[Contour]:
    """Boxes of bores along y in the view along z: x + iy."""
    across = _across(part, tolerance)
    return [
        rectangle(complex(low.real, y0), complex(high.real, y1)) for low, high, y0, y1 in across
    ]


def above_bores(part: Part, tolerance: float) -> list[Contour]:
    """Boxes of a crossed part's bores along z in the view from above: x + iz."""
    boxes = _boxes(part, tolerance, 0) if part.side_profile is not None else []
    return [rectangle(complex(x0, a), complex(x1, b)) for x0, x1, a, b in boxes]


def _boxes(
    part: Part, tolerance: float, axis: Literal[0, 1]
) -> list[tuple[float, float, float, float]]:
    """Of bores along z their least and greatest x (axis 0) or y, and from where to where they go: z."""
    spans: dict[tuple[float, float], list[tuple[float, float]]] = {}
    for layer, low, high in _holes(part, tolerance):
        z0 = layer.z0
        z1 = layer.z1
        if part.side_profile is not None:
            bottom, top = _span(part.side_profile, (low.real + high.real) / 2, tolerance)
            z0 = max(z0, bottom)
            z1 = min(z1, top)
        ends = (low.imag, high.imag) if axis else (low.real, high.real)
        spans.setdefault((round(ends[0], 6), round(ends[1], 6)), []).append((z0, z1))
    return [(*ends, a, b) for ends, each in spans.items() for a, b in _joined(each)]


def _holes(part: Part, tolerance: float) -> Iterator[tuple[Layer, complex, complex]]:
    """Every hole of every layer: the layer, and the corners of its box."""
    for layer in part.layers:
        for hole in layer.region.holes:
            low, high = extent([fit_arcs(hole, tolerance)])
            yield layer, low, high


def _across(part: Part, tolerance: float) -> list[tuple[complex, complex, float, float]]:
    """Of bores along y the corners of their boxes, x + iz, and from where to where they go: y."""
    boxes = (
        [extent([fit_arcs(hole, tolerance)]) for hole in part.side_profile.holes]
        if part.side_profile is not None
        else []
    )
    return [
        (low, high, *_span(part.region, (low.real + high.real) / 2, tolerance))
        for low, high in boxes
    ]


def _joined(spans: Iterable[tuple[float, float]]) -> list[tuple[float, float]]:
    """Spans in order, those that meet as one."""
    joined: list[tuple[float, float]] = []
    for low, high in sorted(set(spans)):
        if joined and low <= joined[-1][1] + SAME_POINT:
            joined[-1] = (joined[-1][0], max(high, joined[-1][1]))
        else:
            joined.append((low, high))
    return joined


# ---- section ---------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Section:
    """A cut along the line y: what of the material it meets, and the edges that are seen behind it, as x + iz, mm."""

    y: float
    faces: Any
    beyond: Sequence[tuple[complex, complex]]


def section(part: Part, tolerance: float, y: float | None = None) -> Section | None:
    """A cut along the line y, unless given that which meets the most holes in their middle.

    None of a part whose layers are alike unless y is given, or all discs without holes.
    """
    layers = part.layers
    plain = not any(layer.region.holes for layer in layers) and all(
        as_circle(layer.region.outer) for layer in layers
    )
    if (
        part.side_profile is not None
        or plain
        or len(layers) > _MOST
        or (y is None and len({layer.region for layer in layers}) < 2)
    ):
        return None
    import shapely

    low, high = extent([fit_arcs(layer.region.outer, tolerance) for layer in layers])
    y = _most_holes(layers, low.imag, high.imag) if y is None else y
    line = shapely.LineString([(low.real - 1, y), (high.real + 1, y)])
    shapes = {layer.region: area(layer.region, tolerance) for layer in (*layers, *part.engraved)}

    def filled(layers: Sequence[Layer]) -> Any:
        """What the plane meets of layers."""
        pieces = [
            (layer, each.bounds)
            for layer in layers
            for each in shapely.get_parts(shapes[layer.region].intersection(line))
        ]
        return shapely.union_all(
            [shapely.box(x0, layer.z0, x1, layer.z1) for layer, (x0, _, x1, _) in pieces if x1 > x0]
        )

    cut = filled(layers).difference(filled(part.engraved))
    heights = sorted({z for layer in layers for z in (layer.z0, layer.z1)})
    levels = [
        shapely.union_all([shapes[each.region] for each in layers if each.z0 <= z < each.z1])
        for z in heights
    ]
    step = max(_STEP, 10 * tolerance)
    edges = _seen_edges(levels, heights, y, step)
    for k, (z0, z1) in enumerate(itertools.pairwise(heights)):
        regions = [each.region for each in layers if each.z0 <= z0 < each.z1]
        edges += [[(x, z0), (x, z1)] for x in _creases(regions, levels[k], y, step)]
    visible = shapely.union_all(shapely.linestrings(edges)).difference(cut.buffer(SAME_POINT))
    lines = [
        shapely.get_coordinates(edge) @ np.array([1, 1j])
        for edge in shapely.get_parts(shapely.line_merge(visible))
    ]
    return Section(
        y,
        cut.simplify(1e-9),
        [(complex(a), complex(b)) for z in lines for a, b in zip(z, z[1:], strict=False)],
    )


def _most_holes(layers: Sequence[Layer], low: float, high: float) -> float:
    """The line y that meets the most holes in their middle, of these the nearest to the datum; low, high: of the layers, mm."""
    middles = [
        hole_of(hole).place.imag for layer in layers for hole in layer.region.holes
    ]  # their axes
    datum = 0.0 if low < 0 < high else (low + high) / 2
    return max(
        [datum, *middles],
        key=lambda y: (sum(abs(y - each) < SAME_POINT for each in middles), -abs(y - datum)),
    )


def _seen_edges(
    levels: Sequence[Any], heights: Sequence[float], y: float, step: float
) -> list[list[tuple[float, float]]]:
    """Edges of what is seen behind the line y, towards smaller y: (x, z) pairs, mm.

    levels: the material from each height to the next; an edge is where what is seen first lies deeper on one side than on the
    other by more than the step: beside it along x within a level, or above and below it between two levels.
    """
    import shapely

    points = [shapely.get_coordinates(level) for level in levels]
    places = distinct(np.zeros(0), *(each[each[:, 1] <= y + SAME_POINT, 0] for each in points))
    if len(places) < 2:
        return []
    strips = (places[1:] + places[:-1]) / 2
    nothing = np.full(len(strips), math.inf)
    depths = [_depth(level, strips, y) for level in levels]
    edges = []
    for z, top, below, here in zip(
        heights, [*heights[1:], heights[-1]], [nothing, *depths], depths, strict=False
    ):
        with np.errstate(invalid="ignore"):
            differs = ~((here == below) | (np.abs(here - below) <= step))
        starts, ends = _runs(differs)
        edges += [
            [(places[a], z), (places[b], z)]
            for a, b in zip(starts, ends, strict=True)
            if places[b] - places[a] > step
        ]
        if top > z:
            beside = [
                _depth(level, places + side * _BESIDE, y)
                for level in [levels[heights.index(z)]]
                for side in (-1, 1)
            ]
            with np.errstate(invalid="ignore"):
                jumps = ~((beside[0] == beside[1]) | (np.abs(beside[0] - beside[1]) <= step))
            edges += [[(x, z), (x, top)] for x in places[jumps]]
    return edges


def _depth(level: Any, places: Floats, y: float) -> Floats:
    """How far behind the line y material is met first at each x, (n,) mm: 0 where the line lies in it, inf where none is."""
    import shapely

    depth = np.full(len(places), math.inf)
    shapely.prepare(level)
    depth[shapely.contains_xy(level, places, np.full(len(places), y))] = 0.0
    for ring in (
        ring for piece in shapely.get_parts(level) for ring in (piece.exterior, *piece.interiors)
    ):
        z = shapely.get_coordinates(ring)
        a, b = z[:-1].T
        c, d = z[1:].T
        first = np.searchsorted(places, np.minimum(a, c))
        count = np.searchsorted(places, np.maximum(a, c)) - first
        # each side with each place along it: which side, which place
        side = np.repeat(np.arange(len(count)), count)
        place = np.arange(len(side)) + np.repeat(first - (np.cumsum(count) - count), count)
        along = (places[place] - a[side]) / (c - a)[side]
        met = y - (b[side] + along * (d - b)[side])
        np.minimum.at(depth, place[met >= 0], met[met >= 0])
    return depth


def _creases(regions: Iterable[Region], level: Any, y: float, step: float) -> list[float]:
    """Where corners of regions are seen behind the line y as edges along z: x, mm; level: the material of all of them."""
    contours = [c for region in regions for c in (region.outer, *region.holes)]
    corners = [z for contour in contours for z, turn in turns(contour) if abs(turn) > _SHARP]
    behind = sorted((z for z in corners if z.imag < y), key=lambda z: z.real)
    if not behind:
        return []
    places = np.array([z.real for z in behind])
    depth = y - np.array([z.imag for z in behind])
    seen = [np.abs(_depth(level, places + side * _BESIDE, y) - depth) < step for side in (-1, 1)]
    return sorted({float(x) for x in places[seen[0] | seen[1]]})


def _runs(mask: Any) -> tuple[Any, Any]:
    """Where stretches of a mask begin, and where they end, as places between its items."""
    change = np.diff(np.concatenate([[False], mask, [False]]).astype(int))
    return np.flatnonzero(change == 1), np.flatnonzero(change == -1)


def hatching(faces: Any, step: float) -> list[tuple[complex, complex]]:
    """Lines at 45 deg that fill the faces, so far apart."""
    import shapely

    x0, y0, x1, y1 = faces.bounds
    starts = np.arange(x0 - (y1 - y0) + step / 2, x1, step * math.sqrt(2))
    lines = (
        shapely.linestrings([[(x, y0), (x + y1 - y0, y1)] for x in starts]) if len(starts) else []
    )
    pieces = [
        piece
        for line in lines
        for piece in shapely.get_parts(faces.intersection(line))
        if piece.length > step / 10
    ]
    ends = [shapely.get_coordinates(piece) @ np.array([1, 1j]) for piece in pieces]
    return [(complex(z[0]), complex(z[-1])) for z in ends]


# ---- a cam's table ---------------------------------------------------------------------------------------------------


def polar_table(contour: Contour, step_deg: float) -> list[tuple[float, float]]:
    """Angle, deg from the x axis, and distance from the origin of a contour, mm; nothing where a ray meets it more than once."""
    tolerance = max(_FINE, _WRITTEN * reach(contour))
    z = facet_contour(contour.counter_clockwise(), tolerance)
    z = np.append(z, z[0])
    angle = np.unwrap(np.angle(z))
    if not (np.all(np.diff(angle) > 0) and math.isclose(angle[-1] - angle[0], math.tau)):
        return []
    degrees = np.arange(0, 360, step_deg)
    along = np.radians(degrees)
    k = np.searchsorted(angle, angle[0] + (along - angle[0]) % math.tau, side="right") - 1
    k = np.minimum(k, len(z) - 2)
    edge = z[k + 1] - z[k]
    radius = (z[k].conj() * edge).imag / (np.exp(-1j * along) * edge).imag
    return list(zip(degrees.tolist(), radius.tolist(), strict=True))
