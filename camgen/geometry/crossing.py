"""Bodies that are two extrusions crossed: a region of the plane (x, y) along z, and one of the plane (x, z) along y.

At every x both have a chord, the length of what lies inside them across x. All there is to know follows from chords:

    volume        integral of (chord of the one) * (chord of the other) dx
    section at z  the first region where the second one's chord at height z runs

A chord is the sum of the contour's crossings with the line, each counted with its direction, so nothing is sorted.
Lines and arcs only: their crossings have a closed form.

    edge          a long edge that neither region shows: from station to station straight, in every plane across x
                  the corner of two sides along y and z, there rounded by an arc that is tangent to both
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from camgen.geometry.outlines import Arc, Contour, Floats, Line, Region, end_point, start_point
from camgen.geometry.rings import Ring, Shape
from camgen.numerics import gauss_legendre

_NODES, _WEIGHTS = gauss_legendre(24)
_OUTSIDE = 0.3  # of the radius, by which the cutter of an edge stands off the corner


@dataclass(frozen=True)
class Edge:
    """A long edge, rounded; straight between its stations."""

    stations: tuple[tuple[float, float, float, float], ...]  # x, growing, y, z, radius > 0, mm
    up: int  # +1 or -1, the side of y on which there is no material
    out: int  # +1 or -1, that of z

    @property
    def mirrored(self) -> Edge:
        """Its image under x -> -x."""
        return Edge(
            tuple((-x, y, z, r) for x, y, z, r in reversed(self.stations)), self.up, self.out
        )

    @property
    def volume(self) -> float:
        """What the rounding takes away, mm^3: across x a square of the radius less a quarter of the disc."""
        spans = pairwise(self.stations)
        return (1 - math.pi / 4) * sum(
            (b[0] - a[0]) * (a[3] ** 2 + a[3] * b[3] + b[3] ** 2) / 3 for a, b in spans
        )

    def cutter(self, tolerance: float) -> tuple[Floats, NDArray[np.int64]]:
        """Closed body that takes the edge off: vertices (n, 3) mm, faces (m, 3) anticlockwise seen from outside.

        tolerance: of chords in the arc, mm; what is left is inscribed. Between stations sections differ in size alone, so
        that all faces are flat.
        """
        radius = max(station[3] for station in self.stations)
        step = 2 * math.acos(max(1 - tolerance / radius, 0.0))
        turn = np.linspace(0, math.pi / 2, max(2, math.ceil(math.pi / 2 / step)) + 1)
        # from the corner inwards: along the arc from the one side to the other, and back outside the body; both ends of the
        # arc stand off a little too, for a cutter that only touches the sides would leave slivers
        flat = np.append((np.cos(turn) - 1) + 1j * (np.sin(turn) - 1), _OUTSIDE * (1 + 1j))
        flat[[0, -2]] += np.array([1, 1j]) * tolerance / (4 * radius)
        n = len(flat)
        count = len(self.stations)
        vertices = np.array(
            [
                (x, y + self.up * r * p.real, z + self.out * r * p.imag)
                for x, y, z, r in self.stations
                for p in flat
            ]
        )
        k = np.arange(n)
        following = (k + 1) % n
        rows = [n * row for row in range(count - 1)]
        walls = [np.column_stack([i + k, i + following, i + n + following]) for i in rows]
        walls += [np.column_stack([i + k, i + n + following, i + n + k]) for i in rows]
        fan = np.column_stack([np.full(n - 2, n - 1), np.arange(n - 2), np.arange(1, n - 1)])
        faces = np.concatenate([*walls, fan[:, ::-1], fan + n * (count - 1)])
        return vertices, faces if self.up * self.out < 0 else faces[:, ::-1]


def _runs(contour: Contour) -> Iterator[tuple[float, float, Line | Arc, float]]:
    """Pieces of a contour, run counter-clockwise, as (x at the begin, x at the end, piece, side of an arc): x is monotone."""
    for piece in contour.counter_clockwise().pieces:
        if isinstance(piece, Line):
            yield piece.a.real, piece.b.real, piece, 0.0
        elif isinstance(piece, Arc):
            low, high = sorted((piece.t0, piece.t1))
            inner = [
                math.pi * k for k in range(math.ceil(low / math.pi), math.floor(high / math.pi) + 1)
            ]
            cuts = sorted({low, *inner, high})
            for t0, t1 in pairwise(cuts if piece.sweep > 0 else cuts[::-1]):
                xs = [piece.centre.real + piece.radius * math.cos(t) for t in (t0, t1)]
                yield xs[0], xs[1], piece, math.copysign(1.0, math.sin((t0 + t1) / 2))
        else:
            raise TypeError("only lines and arcs can be crossed")


def chord(region: Region, x: Floats, low: float = -math.inf, high: float = math.inf) -> Floats:
    """Length of the region between y = low and y = high on the upright lines at x, (n,) mm."""
    total = np.zeros(x.shape)
    for contour, sign in ((region.outer, 1.0), *((hole, -1.0) for hole in region.holes)):
        for begin, end, piece, side in _runs(contour):
            mine = (x >= min(begin, end)) & (x < max(begin, end))
            if isinstance(piece, Line):
                parameter = (x[mine] - begin) / (end - begin) if begin != end else x[mine]
                y = piece.a.imag + parameter * (piece.b.imag - piece.a.imag)
            else:
                y = piece.centre.imag + side * np.sqrt(
                    np.maximum(piece.radius**2 - (x[mine] - piece.centre.real) ** 2, 0.0)
                )
            total[mine] -= sign * math.copysign(1.0, end - begin) * np.clip(y, low, high)
    return total


def _marks(region: Region, levels: Iterable[float] = ()) -> set[float]:
    """All x at which a chord of the region bends, those where a contour crosses the given heights included."""
    marks: set[float] = set()
    levels = [y for y in levels if math.isfinite(y)]
    for contour in (region.outer, *region.holes):
        marks |= {x for begin, end, _, _ in _runs(contour) for x in (begin, end)}
        marks |= {x for y in levels for x in _at_height(contour, y)}
    return marks


def _at_height(contour: Contour, y: float) -> list[float]:
    """All x at which a contour crosses the height y."""
    places = []
    for piece in contour.pieces:
        a = start_point(piece)
        b = end_point(piece)
        if isinstance(piece, Line) and (a.imag <= y) != (b.imag <= y):
            places.append(a.real + (y - a.imag) / (b.imag - a.imag) * (b.real - a.real))
        elif isinstance(piece, Arc) and abs(y - piece.centre.imag) < piece.radius:
            up = math.asin((y - piece.centre.imag) / piece.radius)
            low = min(piece.t0, piece.t1)
            on = [t for t in (up, math.pi - up) if (t - low) % math.tau < abs(piece.sweep)]
            places += [piece.centre.real + piece.radius * math.cos(t) for t in on]
    return places


def _integral(marks: Iterable[float], *factors: tuple[Region, float, float]) -> float:
    """Integral over x of the product of chords between their heights.

    Gauss-Legendre between marks, in x = a + (b - a) sin^2 s: smooth also where a chord begins as a square root.
    """
    total = 0.0
    for a, b in pairwise(sorted(marks)):
        s = math.pi / 4 * (1 + _NODES)
        x = a + (b - a) * np.sin(s) ** 2
        product = np.sin(2 * s)
        for region, low, high in factors:
            product = product * chord(region, x, low, high)
        total += (b - a) * math.pi / 4 * float(np.sum(_WEIGHTS * product))
    return total


def volume(region: Region, crossed: Region, z0: float, z1: float) -> float:
    """Volume of the region extruded from z0 to z1 as far as it lies in `crossed` (x + iz), mm^3."""
    every = (crossed, z0, z1)
    return _integral(
        _marks(region) | _marks(crossed, (z0, z1)), (region, -math.inf, math.inf), every
    )


def crossed_at(
    shape: Shape, crossed: Shape, z: float, rounding: Sequence[Ring] = ()
) -> list[Shape]:
    """What a cut at height z leaves of a shape that is extruded and crossed with another one of the plane x + iz, by x.

    rounding: what the rounding of edges takes besides, rings at that height.
    """
    import shapely

    def area(flat: Shape) -> shapely.Polygon:
        rings = [
            np.column_stack([ring.points.real, ring.points.imag])
            for ring in (flat.outer, *flat.holes)
        ]
        return shapely.Polygon(rings[0], rings[1:])

    def ring(line: shapely.LinearRing) -> Ring:
        points = shapely.get_coordinates(line)[:-1] @ np.array([1, 1j])
        return Ring.straight(points).counter_clockwise()

    _, low, _, high = shape.outer.box
    face = area(crossed)
    level = shapely.LineString([(face.bounds[0] - 1, z), (face.bounds[2] + 1, z)])
    ways = [way for way in shapely.get_parts(face.intersection(level)) if way.length > 0]
    strips = [shapely.box(way.bounds[0], low - 1, way.bounds[2], high + 1) for way in ways]
    body = area(shape).difference(shapely.union_all([area(Shape(each, ())) for each in rounding]))
    left_over = [
        piece
        for strip in strips
        for piece in shapely.get_parts(body.intersection(strip))
        if piece.area > 0
    ]
    left_over.sort(key=lambda piece: piece.bounds[0])
    return [
        Shape(ring(piece.exterior), tuple(ring(hole) for hole in piece.interiors))
        for piece in left_over
    ]


def spread(region: Region) -> tuple[float, float]:
    """Least and greatest y of a region, mm."""
    heights = [
        y
        for _, _, piece, _ in _runs(region.outer)
        for y in (start_point(piece).imag, end_point(piece).imag)
    ]
    tops = [
        piece.centre.imag + side * piece.radius
        for piece in region.outer.pieces
        if isinstance(piece, Arc)
        for side in (1, -1)
        if (side * math.pi / 2 - min(piece.t0, piece.t1)) % math.tau <= abs(piece.sweep)
    ]
    return min(heights + tops), max(heights + tops)


def rounded(points: Sequence[complex], radii: Sequence[float]) -> Contour:
    """Polygon whose corners are arcs of these radii (0: sharp), each tangent to both its edges.

    ValueError, with the corner's number and the share of the radii that would fit, where an arc meets the next one.
    """
    corners: list[tuple[complex, complex, Arc | None]] = []
    n = len(points)
    for k, (corner, radius) in enumerate(zip(points, radii, strict=True)):
        into = points[k] - points[k - 1]
        out = points[(k + 1) % n] - points[k]
        into = into / abs(into)
        out = out / abs(out)
        turn = math.atan2((into.conjugate() * out).imag, (into.conjugate() * out).real)
        if radius == 0 or turn == 0:
            corners.append((corner, corner, None))
            continue
        back = radius * math.tan(abs(turn) / 2)
        side = 1j * math.copysign(1.0, turn)
        start = corner - back * into
        centre = start + radius * side * into
        spoke = -side * into
        corners.append(
            (
                start,
                corner + back * out,
                Arc(centre, radius, math.atan2(spoke.imag, spoke.real), turn),
            )
        )
    pieces: list[Line | Arc] = []
    for k, (_, leave, arc) in enumerate(corners):
        arrive = corners[(k + 1) % n][0]
        way = points[(k + 1) % n] - points[k]
        gap = ((arrive - leave) * way.conjugate()).real / abs(way)
        if gap < 0:
            raise ValueError(k, abs(way) / (abs(way) - gap))
        pieces += [arc] if arc is not None else []
        pieces += [Line(leave, arrive)] if gap > 0 else []
    return Contour(tuple(pieces))
