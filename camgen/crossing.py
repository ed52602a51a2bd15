"""Bodies that are two extrusions crossed: a region of the plane (x, y) along z, and one of the plane (x, z) along y.

At every x both have a chord, the length of what lies inside them across x. All there is to know follows from chords:

    volume        integral of (chord of the one) * (chord of the other) dx
    section at z  the first region between the x at which the second one, seen along its own chord at z, begins and ends

A chord is the sum of the contour's crossings with the line, each counted with its direction, so nothing is sorted.
Lines and arcs only: their crossings have a closed form.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise

import numpy as np

from camgen.outlines import Arc, Contour, Floats, Line, Region, end_point, start_point

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(24)


def _runs(contour: Contour) -> Iterator[tuple[float, float, Line | Arc, float]]:
    """Pieces of a contour, run counter-clockwise, as (x at the begin, x at the end, piece, side of an arc): x is monotone."""
    for piece in contour.counter_clockwise().pieces:
        if isinstance(piece, Line):
            yield piece.a.real, piece.b.real, piece, 0.0
        elif isinstance(piece, Arc):
            low, high = sorted((piece.t0, piece.t1))
            inner = [math.pi * k for k in range(math.ceil(low / math.pi), math.floor(high / math.pi) + 1)]
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
                share = (x[mine] - begin) / (end - begin) if begin != end else x[mine]
                y = piece.a.imag + share * (piece.b.imag - piece.a.imag)
            else:
                y = piece.centre.imag + side * np.sqrt(np.maximum(piece.radius**2 - (x[mine] - piece.centre.real) ** 2, 0.0))
            total[mine] -= sign * math.copysign(1.0, end - begin) * np.clip(y, low, high)
    return total


def _marks(region: Region, levels: Iterable[float] = ()) -> set[float]:
    """All x at which a chord of the region bends, those where a contour crosses the given heights included."""
    found: set[float] = set()
    levels = [y for y in levels if math.isfinite(y)]
    for contour in (region.outer, *region.holes):
        found |= {x for begin, end, _, _ in _runs(contour) for x in (begin, end)}
        found |= {x for y in levels for x in _at_height(contour, y)}
    return found


def _at_height(contour: Contour, y: float) -> list[float]:
    """All x at which a contour crosses the height y."""
    found = []
    for piece in contour.pieces:
        a, b = start_point(piece), end_point(piece)
        if isinstance(piece, Line) and (a.imag <= y) != (b.imag <= y):
            found.append(a.real + (y - a.imag) / (b.imag - a.imag) * (b.real - a.real))
        elif isinstance(piece, Arc) and abs(y - piece.centre.imag) < piece.radius:
            up = math.asin((y - piece.centre.imag) / piece.radius)
            low = min(piece.t0, piece.t1)
            on = [t for t in (up, math.pi - up) if (t - low) % math.tau < abs(piece.sweep)]
            found += [piece.centre.real + piece.radius * math.cos(t) for t in on]
    return found


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
        total += (b - a) * math.pi / 4 * float(_WEIGHTS @ product)
    return total


def volume(region: Region, crossed: Region, z0: float, z1: float) -> float:
    """Volume of the region extruded from z0 to z1 as far as it lies in `crossed` (x + iz), mm^3."""
    every = (crossed, z0, z1)
    return _integral(_marks(region) | _marks(crossed, (z0, z1)), (region, -math.inf, math.inf), every)


def spans(crossed: Region, z: float) -> list[tuple[float, float]]:
    """Where a line of height z runs inside the crossed region: from x to x, left to right."""
    cuts = sorted(x for contour in (crossed.outer, *crossed.holes) for x in _at_height(contour, z))
    return list(zip(cuts[::2], cuts[1::2], strict=True))


def cut(region: Region, crossed: Region, z: float) -> tuple[list[float], list[Contour]]:
    """What a cut at height z leaves of the region: the areas of its pieces, mm^2, left to right, and the holes that are whole."""
    marks, areas, holes = _marks(region), [], []
    for left, right in spans(crossed, z):
        inside = {left, right, *(x for x in marks if left < x < right)}
        area = _integral(inside, (region, -math.inf, math.inf))
        if area > 0:
            areas.append(area)
            holes += [hole for hole in region.holes if all(left < x < right for x in _marks(Region(hole)))]
    return areas, holes


def spread(region: Region) -> tuple[float, float]:
    """Least and greatest y of a region, mm."""
    heights = [y for _, _, piece, _ in _runs(region.outer) for y in (start_point(piece).imag, end_point(piece).imag)]
    tops = [
        piece.centre.imag + side * piece.radius
        for piece in region.outer.pieces if isinstance(piece, Arc)
        for side in (1, -1) if (side * math.pi / 2 - min(piece.t0, piece.t1)) % math.tau <= abs(piece.sweep)
    ]  # fmt: skip
    return min(heights + tops), max(heights + tops)


def rounded(points: Sequence[complex], radii: Sequence[float]) -> Contour:
    """Polygon whose corners are arcs of these radii (0: sharp), each tangent to both its edges.

    ValueError, with the corner's number, where an arc does not fit between its neighbours.
    """
    corners: list[tuple[complex, complex, Arc | None]] = []
    n = len(points)
    for k, (corner, radius) in enumerate(zip(points, radii, strict=True)):
        into, out = (points[k] - points[k - 1]), (points[(k + 1) % n] - points[k])
        into, out = into / abs(into), out / abs(out)
        turn = math.atan2((into.conjugate() * out).imag, (into.conjugate() * out).real)
        if radius == 0 or turn == 0:
            corners.append((corner, corner, None))
            continue
        back = radius * math.tan(abs(turn) / 2)
        side = 1j * math.copysign(1.0, turn)
        start = corner - back * into
        centre = start + radius * side * into
        spoke = -side * into
        corners.append((start, corner + back * out, Arc(centre, radius, math.atan2(spoke.imag, spoke.real), turn)))
    made: list[Line | Arc] = []
    for k, (_, leave, arc) in enumerate(corners):
        arrive = corners[(k + 1) % n][0]
        way = points[(k + 1) % n] - points[k]
        gap = ((arrive - leave) * way.conjugate()).real / abs(way)
        if gap < 0:
            raise ValueError(str(k))
        made += [arc] if arc is not None else []
        made += [Line(leave, arrive)] if gap > 0 else []
    return Contour(tuple(made))
