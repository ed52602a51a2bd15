"""The parts of a machine drawn apart, in isometric projection: what lies over another is lifted clear of it, and a screw or a pin
whose head is below goes down. [ISO 5456-3]

    paper    to the right (x + y) cos 30 deg, upwards (y - x) sin 30 deg + z

It is seen from above, so that nothing hides what is wholly over it; of what is as high, what is nearer hides what is farther. An axis
joins round parts and the holes that they belong in.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from camgen.numerics import coordinates

Prism = tuple[Any, float, float]  # an upright one: its polygon, from where to where it reaches, mm

_ALIKE = 0.3  # mm, by which what lies at one level may differ in height
_TOUCH = 1e-3  # mm^2, up to which outlines do not lie over each other
_COS = math.cos(math.pi / 6)
_MITE = 1e-4  # mm: what is left of an edge that is hidden
_SHARP = math.radians(25)  # turn of an outline from which on its corner has an edge
_ROUND = 0.82  # of a circle's area by its length, at least, of what is round
_SAME_AXIS = 1.0  # mm, within which centres are on one axis: a keyway moves that of its bore
_TIGHT = 0.3  # mm, by which what is pressed into a hole may be larger
_FLUSH = 0.05  # mm, by which outlines of prisms on each other may differ
_HEAD = 1.2  # times, that a head is broader than the other end
_FINE = 0.02  # mm, by which outlines are straightened


@dataclass(frozen=True)
class Piece:
    """A prism as it is drawn: what it covers on paper, its edges as far as it does not hide them itself, and its holes at the top."""

    number: int
    prism: Prism
    face: Any
    edges: Any
    holes: Any

    def lifted(self, by: float) -> Piece:
        """The same so much higher."""
        from shapely.affinity import translate

        shape, low, high = self.prism
        drawn = (translate(each, 0, by) for each in (self.face, self.edges, self.holes))
        return Piece(self.number, (shape, low + by, high + by), *drawn)

    @cached_property
    def turned(self) -> Any:
        """Its polygon as the eye has it: to the right, and towards it."""
        import shapely

        return shapely.transform(self.prism[0], _turned)

    def before(self, other: Piece) -> Any:
        """What of its face is before another piece for the eye: all where it is over it, or, of two that are as high, where it is
        nearer; of what holds the other one in a hole what is beside that; of what stands in such a hole what is in it."""
        a, low, high = self.prism
        b, floor, top = other.prism
        if low > top - _MITE:
            return self.face
        if floor > high - _MITE:
            return None
        if _held(b, a):
            return self.face.difference(self.holes)
        if _held(a, b):
            return self.face.intersection(other.holes).buffer(-2 * _MITE)
        return self.face if self._nearer(other) else None

    def _nearer(self, other: Piece) -> bool:
        """Whether it is nearer to the eye where both are beside each other."""
        import shapely

        bounds = [each.turned.bounds for each in (self, other)]
        left = max(each[0] for each in bounds)
        right = min(each[2] for each in bounds)
        foot = min(each[1] for each in bounds)
        top = max(each[3] for each in bounds)
        if left >= right:
            return False
        clipped = [
            shapely.clip_by_rect(each.turned, left, foot, right, top) for each in (self, other)
        ]
        near, far = (each.centroid for each in clipped)
        return bool(not near.is_empty and not far.is_empty and near.y > far.y)


@dataclass(frozen=True)
class Body:
    """A copy of a part where it stands: its number, and its prisms."""

    number: int
    prisms: Sequence[Prism]

    @cached_property
    def low(self) -> float:
        """Its lowest point."""
        return min(low for _, low, _ in self.prisms)

    @cached_property
    def high(self) -> float:
        """Its highest point."""
        return max(high for *_, high in self.prisms)

    @cached_property
    def plan(self) -> Any:
        """What it covers as seen from above, its holes too."""
        return filled([shape for shape, *_ in self.prisms])

    @cached_property
    def centres(self) -> list[complex]:
        """Of its round outlines and of its holes."""
        rings = [ring for shape, *_ in self.prisms for ring in (shape.exterior, *shape.interiors)]
        return [complex(ring.centroid.x, ring.centroid.y) for ring in rings if _round(ring)]

    @property
    def headed_below(self) -> bool:
        """Whether it is slender and its lower end is the broader one, so that it comes from below."""
        x0, y0, x1, y1 = self.plan.bounds
        if self.high - self.low < min(x1 - x0, y1 - y0):
            return False
        low, high = (
            sum(shape.area for shape, *ends in self.prisms if z in ends)
            for z in (self.low, self.high)
        )
        return bool(low > _HEAD * high)

    @cached_property
    def middle(self) -> float:
        """Height of its centre of gravity."""
        volumes = [shape.area * (high - low) for shape, low, high in self.prisms]
        moments = (
            volume * (low + high) / 2
            for volume, (_, low, high) in zip(volumes, self.prisms, strict=True)
        )
        return float(sum(moments) / sum(volumes))

    @cached_property
    def pieces(self) -> list[Piece]:
        """Its prisms as they are drawn, without edges where one goes on flush with another."""
        import shapely

        pieces = []
        for prism in self.prisms:
            face, rims, walls, holes = _sweep(*prism)
            _, floor, top = prism
            ends = [
                _on_paper(shape, top) for shape, low, _ in self.prisms if abs(low - top) < _MITE
            ]
            ends += [
                _on_paper(shape, floor)
                for shape, _, high in self.prisms
                if abs(high - floor) < _MITE
            ]
            if ends:
                seams = shapely.union_all([end.boundary for end in ends]).buffer(_FLUSH)
                rims = rims.difference(seams)
            edges = shapely.union_all([rims, walls])
            pieces.append(Piece(self.number, prism, face, edges, holes))
        return pieces

    def inside(self, other: Body) -> bool:
        """Whether it goes into or through a hole of another one."""
        return self.plan.area < other.plan.area and any(
            low < high and floor < top and _held(own, shape)
            for own, floor, high in self.prisms
            for shape, low, top in other.prisms
        )


def apart(bodies: Sequence[Body], gap: float) -> list[float]:
    """By how much each body is lifted, mm, so that it is clear of what it covers by a gap; those at one level stay at one."""
    lifts = [0.0] * len(bodies)
    placed: list[int] = []
    below = [body.headed_below for body in bodies]
    for level in _levels(bodies, [k for k in range(len(bodies)) if not below[k]]):
        pairs = [(k, n) for k in level for n in placed if _over(bodies[k], bodies[n])]
        rises = [bodies[n].high + lifts[n] + gap - bodies[k].low for k, n in pairs]
        for k in level:
            lifts[k] = max(rises, default=0.0)
        placed += level
    for level in reversed(_levels(bodies, [k for k in range(len(bodies)) if below[k]])):
        pairs = [(k, n) for k in level for n in placed if _over(bodies[k], bodies[n])]
        falls = [bodies[n].low + lifts[n] - gap - bodies[k].high for k, n in pairs]
        for k in level:
            lifts[k] = min(falls, default=0.0)
        placed += level
    return lifts


def _levels(bodies: Sequence[Body], which: Sequence[int]) -> list[list[int]]:
    """Some bodies level by level, by the heights of their centres; what stands in another one, or overlaps it, comes after it."""
    places: dict[int, tuple[int, int]] = {}
    for k in sorted(which, key=lambda k: -bodies[k].plan.area):
        own = round(bodies[k].middle / _ALIKE), 0
        holders = (places[n] for n in places if bodies[k].inside(bodies[n]))
        places[k] = max([own, *((height, after + 1) for height, after in holders)])
    levels: list[list[int]] = []
    for place in sorted(set(places.values())):
        own_place = [k for k, own in places.items() if own == place]
        beside: list[list[int]] = []  # of what would overlap, the longer after the shorter
        for k in sorted(own_place, key=lambda k: bodies[k].high - bodies[k].low):
            clear = (
                level for level in beside if not any(_over(bodies[k], bodies[n]) for n in level)
            )
            level = next(clear, None)
            if level is None:
                beside.append([k])
            else:
                level.append(k)
        levels += beside
    return levels


def _over(a: Body, b: Body) -> bool:
    """Whether one body covers a piece of another as seen from above."""
    return bool(a.plan.intersects(b.plan)) and a.plan.intersection(b.plan).area > _TOUCH


def axes(bodies: Sequence[Body], lifts: Sequence[float]) -> list[tuple[complex, float, float]]:
    """Where parts that belong on one axis stand apart: its place, from where to where, mm."""
    ends = [(body.low + by, body.high + by) for body, by in zip(bodies, lifts, strict=True)]
    places: list[tuple[complex, list[int]]] = []
    for k in sorted(range(len(bodies)), key=lambda k: ends[k]):
        for at in bodies[k].centres:
            column = next((column for z, column in places if abs(z - at) < _SAME_AXIS), None)
            if column is None:
                places.append((at, [k]))
            elif k != column[-1]:
                column.append(k)
    return [
        (at, ends[below][1], ends[above][0])
        for at, column in places
        for below, above in zip(column, column[1:], strict=False)
        if ends[above][0] > ends[below][1]
    ]


@dataclass(frozen=True)
class Seen:
    """What is seen of a prism, on paper, mm of the machine."""

    number: int
    face: Any  # polygon
    edges: Any


def isometric(bodies: Sequence[Body], lifts: Sequence[float]) -> tuple[list[Seen], list[Any]]:
    """What is seen of each prism of bodies that are lifted so much, and of the axes that join them."""
    import shapely

    pieces = [
        piece.lifted(by) for body, by in zip(bodies, lifts, strict=True) for piece in body.pieces
    ]
    tree = shapely.STRtree([piece.face for piece in pieces])

    def hidden(shape: Any, piece: Piece) -> Any:
        """What of paper the pieces cover that are before one."""
        others = (pieces[n] for n in tree.query(shape, predicate="intersects"))
        covers = (other.before(piece) for other in others if other is not piece)
        return shapely.union_all([shapely.Polygon(), *(each for each in covers if each)])

    seen = []
    for piece in pieces:
        over = hidden(piece.face, piece)
        edges = piece.edges.difference(over.buffer(_MITE))
        seen.append(Seen(piece.number, piece.face.difference(over), edges))
    lines = []
    for at, low, high in axes(bodies, lifts):
        foot = shapely.Point(at.real, at.imag)
        line = shapely.LineString([_on_paper(foot, low), _on_paper(foot, high)])
        prism = foot.buffer(_FINE), low, high
        lines.append(line.difference(hidden(line, Piece(0, prism, line, line, line))))
    return seen, lines


def _held(a: Any, b: Any) -> bool:
    """Whether one polygon lies in a hole of another one."""
    import shapely

    return any(shapely.Polygon(ring).buffer(_TIGHT).covers(a) for ring in b.interiors)


def _turned(points: Any) -> Any:
    """Places as the eye has them, (n, 2): to the right, and towards it."""
    x, y = points.T
    return coordinates(x + y + 1j * (x - y))


def _round(ring: Any) -> bool:
    """Whether a closed line encloses nearly what a circle as long does, with a flat or a keyway too; a square does not."""
    import shapely

    return bool(4 * math.pi * shapely.Polygon(ring).area > _ROUND * ring.length**2)


def _on_paper(shape: Any, z: float) -> Any:
    """A polygon at a height."""
    import shapely

    def placed(points: Any) -> Any:
        x, y = points.T
        return coordinates((x + y) * _COS + 1j * ((y - x) / 2 + z))

    return shapely.transform(shape, placed)


def _sweep(shape: Any, low: float, high: float) -> tuple[Any, Any, Any, Any]:
    """What an upright prism covers on paper, as far as it does not hide them itself its edges at its ends and those of its walls, and
    its holes at the top."""
    import shapely
    from shapely.geometry.polygon import orient

    shape = shapely.simplify(shape, _FINE)
    top = _on_paper(shape, high)
    bottom = _on_paper(shape, low)
    rise = 1j * (high - low)
    z = shapely.get_coordinates(orient(bottom).exterior) @ np.array([1, 1j])
    quads = np.stack([z[:-1], z[1:], z[1:] + rise, z[:-1] + rise], axis=1)
    walls = shapely.polygons(np.stack([quads.real, quads.imag], axis=-1))
    ways = np.diff(z)
    turns = np.angle(np.roll(ways, -1) / ways)
    front = (ways.real > _MITE) | (np.roll(ways, -1).real > _MITE)  # walls that face the eye
    corners = [
        shapely.LineString(coordinates(np.array([corner, corner + rise])))
        for corner in z[1:][front & (abs(turns) > _SHARP)]
    ]
    behind = filled([top])
    through = [
        shapely.Polygon(upper).intersection(shapely.Polygon(lower))
        for upper, lower in zip(top.interiors, bottom.interiors, strict=True)
    ]
    whole = filled([top, bottom, *walls])
    face = whole.difference(shapely.union_all([shapely.Polygon(), *through]))
    outline = whole.boundary.difference(behind.buffer(-_MITE))
    sides = outline.difference(bottom.boundary.buffer(_MITE))
    floors = [each.boundary for each in through if not each.is_empty]
    rims = shapely.union_all([top.boundary, outline.difference(sides.buffer(_MITE)), *floors])
    upright = shapely.union_all([sides, *corners]).difference(behind.buffer(-_MITE))
    return face, rims, upright, behind.difference(top)


def filled(shapes: Sequence[Any]) -> Any:
    """All that lies inside of some polygons, their holes too."""
    import shapely

    rings = shapely.get_exterior_ring(shapely.get_parts(shapely.union_all(shapes)))
    return shapely.union_all(shapely.polygons(rings))
