"""The parts of a machine drawn apart, in isometric projection: each is moved back the way it comes in the steps of assembly until it is
clear of all that is there before it. [ISO 5456-3]

    paper    to the right (x + y) cos 30 deg, upwards (y - x) sin 30 deg + z

It is seen from above, so that nothing hides what is wholly over it; of what is as high, what is nearer hides what is farther. An axis
joins round parts and the holes that they belong in, or shows the way of a rod that comes from aside.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, reduce
from typing import Any

import numpy as np

from camgen.geometry.mesh import Mesh
from camgen.numerics import Floats, coordinates

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
_MEET = 0.5  # mm, up to which parts touch
_FAR = 4.0  # times the gap, of what others would hide
_LEVEL = 0.5  # least share of a way that is upright, of what comes from above or from below
_EYE = np.array([1.0, -1.0, 1.0])  # towards the eye
_PAPER = np.array([[_COS, _COS, 0.0], [-0.5, 0.5, 1.0]])  # to the right on it, and upwards
_BEHIND = 1e-3  # mm, by which a facet has to be before an edge to hide it


@dataclass(frozen=True)
class Piece:
    """A prism as it is drawn: what it covers on paper, its edges as far as it does not hide them itself, and its holes at the top."""

    number: int
    prism: Prism
    face: Any
    edges: Any
    holes: Any
    solid: bool = False  # whether it is no prism, and its prism is what it covers from above

    def moved(self, by: Floats) -> Piece:
        """The same moved, by mm."""
        from shapely.affinity import translate

        shape, low, high = self.prism
        prism = translate(shape, by[0], by[1]), low + by[2], high + by[2]
        face, edges, holes = (
            translate(each, *_PAPER @ by) for each in (self.face, self.edges, self.holes)
        )
        return Piece(self.number, prism, face, edges, holes, self.solid)

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
        if self.solid or other.solid:
            return self.face if self._ahead(other) else None
        if _held(b, a):
            return self.face.difference(self.holes)
        if _held(a, b):
            return self.face.intersection(other.holes).buffer(-2 * _MITE)
        return self.face if self._nearer(other) else None

    def _ahead(self, other: Piece) -> bool:
        """Whether its box is nearer to the eye than that of another piece as high: to the right or in front of it, else by their
        middles."""
        x0, y0, x1, y1 = self.prism[0].bounds
        left, front, right, back = other.prism[0].bounds
        if x0 > right - _MITE or y1 < front + _MITE:
            return True
        if left > x1 - _MITE or back < y0 + _MITE:
            return False
        middles = [
            (bounds[0] + bounds[2] - bounds[1] - bounds[3] + sum(ends)) / 2
            for bounds, ends in ((each.prism[0].bounds, each.prism[1:]) for each in (self, other))
        ]
        return bool(middles[0] > middles[1])

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
class Coming:
    """When a copy comes in the steps of assembly, and how."""

    order: float = 0.0
    way: tuple[float, float, float] = (0.0, 0.0, -1.0)  # in which it moves, as from above
    apart: str = ""  # what is built by itself, and has it

    @property
    def aside(self) -> bool:
        """Whether it comes neither from above nor from below."""
        return abs(self.way[2]) < _LEVEL


@dataclass(frozen=True)
class Body:
    """A copy of a part where it stands: its number, its prisms, when it comes, and of what these do not show well its solid."""

    number: int
    prisms: Sequence[Prism]
    coming: Coming = Coming()
    solid: Mesh | None = None

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
    def ahead(self) -> float:
        """How far it reaches in the way in which it comes from aside."""
        import shapely

        way = complex(*self.coming.way[:2])
        return float(np.max((shapely.get_coordinates(self.plan) @ np.array([1, 1j]) / way).real))

    @property
    def lies(self) -> bool:
        """Whether it is as high as it is wide, square to the way in which it comes, such as a roller of a drum."""
        import shapely

        z = shapely.get_coordinates(self.plan) @ np.array([1, 1j]) / complex(*self.coming.way[:2])
        return bool(abs(np.ptp(z.imag) - (self.high - self.low)) < _SAME_AXIS)

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
        """Its prisms as they are drawn, without edges where one goes on flush with another; or its solid."""
        import shapely

        if self.solid is not None:
            face, edges = _drawn(self.solid)
            prism = self.plan, self.low, self.high
            return [Piece(self.number, prism, face, edges, shapely.Polygon(), True)]
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

    def meets(self, other: Body) -> bool:
        """Whether it touches another one, or nearly."""
        return (
            self.low < other.high + _MEET
            and other.low < self.high + _MEET
            and bool(self.plan.distance(other.plan) < _MEET)
        )


def apart(bodies: Sequence[Body], gap: float, far: Collection[int] = ()) -> list[Floats]:
    """By how much each body is moved, (3,) mm, so that it is clear by a gap of all that is there before it; those of one step at one
    level stay at one. What stands on nothing else rises to what comes over it. far: numbers that have a gap several times as wide."""

    def wide(*which: int) -> float:
        return (_FAR if any(bodies[k].number in far for k in which) else 1.0) * gap

    moves = [np.zeros(3) for _ in bodies]
    levels = [*_coming(bodies)]
    upright = [level for level in levels if not bodies[level[0]].coming.aside]
    placed: list[int] = []
    hanging = list[int]()
    for level in upright:
        pairs = [(k, n) for k in level for n in placed if _over(bodies[k], bodies[n])]
        _lift(bodies, moves, level, pairs, wide)
        if placed and bodies[level[0]].coming.way[2] < 0:
            hanging += _hanging(level, pairs, hanging)
        placed += level
    for k in reversed(hanging):
        after = (n for n in placed[placed.index(k) + 1 :] if _over(bodies[k], bodies[n]))
        rises = [bodies[n].low + moves[n][2] - wide(k, n) - bodies[k].high for n in after]
        moves[k][2] = max(moves[k][2], min(rises, default=moves[k][2]))
    asides = [k for level in levels for k in level if bodies[k].coming.aside]
    for k in sorted(asides, key=lambda k: -bodies[k].ahead):  # what is farther in goes in first
        order = bodies[k].coming.order
        there = [n for n in placed if n in asides or bodies[n].coming.order <= order]
        touched = (n for n in there if bodies[k].meets(bodies[n]))
        moves[k][2] = moves[next(touched, placed[0])][2] if placed else 0.0
        clear = _clear(bodies[k], [(bodies[n], moves[n]) for n in there], wide(k))
        moves[k] -= np.array(bodies[k].coming.way) * clear
        placed.append(k)
    return moves


def _lift(
    bodies: Sequence[Body],
    moves: Sequence[Floats],
    level: Sequence[int],
    pairs: Sequence[tuple[int, int]],
    gap: Callable[[int, int], float],
) -> None:
    """Lift bodies of a level clear of those that are there, or lower them where they come from below; pairs: which cover which;
    gap: of a pair."""
    if bodies[level[0]].coming.way[2] > 0:
        ends = [bodies[n].low + moves[n][2] - gap(k, n) - bodies[k].high for k, n in pairs]
        end = min(ends, default=0.0)
    else:
        ends = [bodies[n].high + moves[n][2] + gap(k, n) - bodies[k].low for k, n in pairs]
        end = max(ends, default=0.0)
    for k in level:
        moves[k][2] = end


def _hanging(
    level: Sequence[int], pairs: Sequence[tuple[int, int]], hanging: Sequence[int]
) -> list[int]:
    """Which of a level stand on nothing but what does so itself."""
    return [k for k in level if {n for own, n in pairs if own == k} <= {*hanging}]


def _clear(body: Body, others: Sequence[tuple[Body, Floats]], gap: float) -> float:
    """How far a body goes back the way it comes from aside until it is clear of what is as high; each of the others with how it is moved."""
    way = complex(*body.coming.way[:2])

    def extent(each: Body, by: Floats) -> tuple[Any, Any]:
        """Along the way, and to its left."""
        import shapely

        z = (shapely.get_coordinates(each.plan) + by[:2]) @ np.array([1, 1j]) / way
        return z.real, z.imag

    along, left = extent(body, np.zeros(3))
    ends = [
        float(own.min())
        for own, side in (extent(each, by) for each, by in others if _as_high(each, body))
        if side.min() < left.max() and side.max() > left.min()
    ]
    return max([gap, *(float(along.max()) - end + gap for end in ends)])


def _as_high(a: Body, b: Body) -> bool:
    """Whether two bodies have heights in common."""
    return a.low < b.high and b.low < a.high


def _coming(bodies: Sequence[Body]) -> Iterator[list[int]]:
    """Bodies as they come: step by step, of each step those from above level by level, then those from below, then those from aside."""
    steps: dict[tuple[float, bool, bool, tuple[float, float, float]], list[int]] = {}
    for k, body in enumerate(bodies):
        coming = body.coming
        key = coming.order, coming.aside, coming.way[2] > 0, coming.way
        steps.setdefault(key, []).append(k)
    for (_, _, beneath, _), which in sorted(steps.items()):
        levels = _levels(bodies, which)
        yield from reversed(levels) if beneath else levels


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


def axes(bodies: Sequence[Body], moves: Sequence[Floats]) -> list[tuple[Floats, Floats]]:
    """Where parts that belong on one axis stand apart: from where to where, (3,) mm; of what comes from aside its way."""
    lifts = [float(by[2]) for by in moves]
    upright = [k for k in range(len(bodies)) if not bodies[k].coming.aside]
    ends = [(body.low + by, body.high + by) for body, by in zip(bodies, lifts, strict=True)]
    places: list[tuple[complex, list[int]]] = []
    for k in sorted(upright, key=lambda k: ends[k]):
        for at in bodies[k].centres:
            column = next((column for z, column in places if abs(z - at) < _SAME_AXIS), None)
            if column is None:
                places.append((at, [k]))
            elif k != column[-1]:
                column.append(k)
    lines = [
        (np.array([at.real, at.imag, ends[below][1]]), np.array([at.real, at.imag, ends[above][0]]))
        for at, column in places
        for below, above in zip(column, column[1:], strict=False)
        if ends[above][0] > ends[below][1]
    ]
    for body, by in zip(bodies, moves, strict=True):
        if body.coming.aside and body.lies:
            middle = body.plan.centroid
            end = np.array([middle.x, middle.y, (body.low + body.high) / 2 + by[2]])
            lines.append((end + [by[0], by[1], 0.0], end))
    return lines


@dataclass(frozen=True)
class Seen:
    """What is seen of a prism, on paper, mm of the machine."""

    number: int
    face: Any  # polygon
    edges: Any
    whole: Any  # what it would cover alone


def isometric(bodies: Sequence[Body], moves: Sequence[Floats]) -> tuple[list[Seen], list[Any]]:
    """What is seen of each prism or solid of bodies that are moved so much, and of the axes that join them."""
    import shapely

    pieces = [
        piece.moved(by) for body, by in zip(bodies, moves, strict=True) for piece in body.pieces
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
        seen.append(Seen(piece.number, piece.face.difference(over), edges, piece.face))
    lines = []
    for begin, end in axes(bodies, moves):
        line = shapely.LineString([_PAPER @ begin, _PAPER @ end])
        foot = shapely.LineString([begin[:2], end[:2]]).buffer(_FINE)
        prism = foot, min(begin[2], end[2]), max(begin[2], end[2])
        lines.append(line.difference(hidden(line, Piece(0, prism, line, line, line))))
    return seen, lines


def _drawn(solid: Mesh) -> tuple[Any, Any]:
    """What a solid covers on paper, and those of its edges and outlines that it does not hide itself."""
    import shapely

    space = np.vstack([_PAPER, _EYE])
    body = solid.manifold.transform(np.column_stack([space, np.zeros(3)]))
    rings = (shapely.make_valid(shapely.Polygon(ring)) for ring in body.project().to_polygons())
    face = reduce(shapely.symmetric_difference, rings, shapely.Polygon())
    places = solid.vertices @ space.T  # to the right, upwards, towards the eye
    corners = places[solid.faces]
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    ahead = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0] > _MITE  # facets that the eye sees
    ends = places[_outlines(solid, ahead)]
    lines = shapely.linestrings(ends[:, :, :2])
    facets = corners[ahead]
    shapes = shapely.polygons(facets[:, :, :2])
    which, facet = shapely.STRtree(shapes).query(lines, predicate="intersects")
    covered = shapely.intersection(lines[which], shapes[facet])
    long = shapely.length(covered) > _MITE
    which, facet, covered = which[long], facet[long], covered[long]
    middles = shapely.line_interpolate_point(covered, 0.5, normalized=True)
    at = shapely.get_coordinates(middles)
    start, end = ends[which, 0], ends[which, 1]
    flat = end[:, :2] - start[:, :2]
    share = np.sum((at - start[:, :2]) * flat, axis=1) / np.sum(flat**2, axis=1)
    own = start[:, 2] + share * (end[:, 2] - start[:, 2])
    behind = _depth(facets[facet], at) > own + _BEHIND
    left = lines.copy()
    for k in np.unique(which[behind]):
        over = shapely.union_all(covered[behind & (which == k)])
        left[k] = lines[k].difference(over.buffer(_MITE))
    return face, shapely.union_all(left)


def _outlines(solid: Mesh, ahead: Any) -> Any:
    """Ends of a solid's edges that may be seen, (n, 2) numbers of vertices: those that turn sharply, and those where what the eye sees
    ends."""
    a, b, c = solid.vertices[solid.faces].transpose(1, 0, 2)
    normals = np.cross(b - a, c - a)
    normals /= np.maximum(np.linalg.norm(normals, axis=1), _MITE**2)[:, None]
    edges = np.concatenate([solid.faces[:, [0, 1]], solid.faces[:, [1, 2]], solid.faces[:, [2, 0]]])
    owners = np.tile(np.arange(len(solid.faces)), 3)
    edges = np.sort(edges, axis=1)
    order = np.lexsort(edges.T)
    edges, owners = edges[order], owners[order]
    twins = np.flatnonzero((edges[1:] == edges[:-1]).all(axis=1))
    one, other = owners[twins], owners[twins + 1]
    sharp = np.sum(normals[one] * normals[other], axis=1) < math.cos(_SHARP)
    seen = (sharp & (ahead[one] | ahead[other])) | (ahead[one] != ahead[other])
    return edges[twins[seen]]


def _depth(facets: Floats, at: Floats) -> Floats:
    """How near to the eye facets, (n, 3, 3), are at places on paper, (n, 2)."""
    a, b, c = facets.transpose(1, 0, 2)
    normal = np.cross(b - a, c - a)
    rise = np.sum((at - a[:, :2]) * normal[:, :2], axis=1) / normal[:, 2]
    return np.asarray(a[:, 2] - rise)


def paper(at: complex) -> complex:
    """A point at z = 0 as it is drawn."""
    x, y = _PAPER @ [at.real, at.imag, 0.0]
    return complex(x, y)


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
