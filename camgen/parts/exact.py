"""From a part to its exact solid: one body of planes and cylinders, however many layers it is made of.

All outlines of all layers are laid on one plane and divide each other there into strokes. Of each stroke and each layer it
is known whether there is material to its left and to its right, and so, between any two heights, whether it carries a wall;
what one height has and the next one has not is a level face. Edges are shared by construction.

    stroke   a piece of outline, a line or an arc of less than half a turn, which no other outline crosses or ends on
    slab     what lies between two neighbouring heights of the layers
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from camgen.errors import DesignError
from camgen.geometry.arcs import bulges, fit_arcs
from camgen.geometry.brep import Brep, Edge, Face, Loop, Step
from camgen.geometry.outlines import Points
from camgen.parts.drum_exact import drum_solid
from camgen.parts.part import Layer, Part

Bools = NDArray[np.bool_]

# Points nearer than this are one, and outlines that run so near beside each other are one outline, mm: layers of one part
# whose equal outlines were worked out by different routes differ by up to 6e-7. STEP files tell it as their uncertainty.
SAME = 2e-6


@dataclass
class _Points:
    """Points in the order in which they were first met, each standing for all within SAME of it."""

    at: list[complex] = field(default_factory=list)
    cells: dict[tuple[int, int], list[int]] = field(default_factory=lambda: defaultdict(list))

    def number(self, z: complex) -> int:
        """Index of the point."""
        column = math.floor(z.real / SAME)
        row = math.floor(z.imag / SAME)
        for cell in ((column + i, row + j) for i in (0, -1, 1) for j in (0, -1, 1)):
            for k in self.cells.get(cell, ()):
                if abs(self.at[k] - z) <= SAME:
                    return k
        self.at.append(z)
        self.cells[column, row].append(len(self.at) - 1)
        return len(self.at) - 1


@dataclass(frozen=True)
class _Stroke:
    """From a to b, mm, with its bulge."""

    a: complex
    b: complex
    bulge: float

    @property
    def sweep(self) -> float:
        return 4 * math.atan(self.bulge)

    @property
    def centre(self) -> complex:
        t = self.bulge
        return (self.a + self.b) / 2 + 0.5j * (self.b - self.a) * (1 - t * t) / (2 * t)

    def point(self, fraction: float) -> complex:
        """Point at a share of its length."""
        if not self.bulge:
            return self.a + fraction * (self.b - self.a)
        return self.centre + (self.a - self.centre) * complex(np.exp(1j * fraction * self.sweep))

    def share(self, z: complex) -> float:
        """The share of its length at which it passes nearest to a point near it."""
        if not self.bulge:
            return ((z - self.a) / (self.b - self.a)).real
        turn = float(np.angle((z - self.centre) / (self.a - self.centre)))
        return (
            0.5 + (turn - self.sweep / 2 + math.pi) % math.tau / self.sweep - math.pi / self.sweep
        )

    def off(self, z: complex) -> float:
        """Distance of a point from its line or circle."""
        if not self.bulge:
            return abs(((z - self.a) / (self.b - self.a)).imag) * abs(self.b - self.a)
        return abs(abs(z - self.centre) - abs(self.a - self.centre))

    def part(self, low: complex, high: complex) -> _Stroke:
        """The piece between two points on it."""
        sweep = self.sweep * (self.share(high) - self.share(low)) if self.bulge else 0.0
        return _Stroke(low, high, math.tan(sweep / 4))

    def leaves(self) -> complex:
        """Direction at its beginning."""
        return (self.b - self.a) * complex(np.exp(-0.5j * self.sweep))


def exact(part: Part, tolerance: float) -> Brep:
    """The part as one closed body, in its frame: lines and arcs within tolerance, mm, of its outlines, extruded.

    A drum's walls are splines, see `drum_exact`. DesignError, with what to do, for a crossed part, and for layers that meet in a
    line or do not make exactly one body.
    """
    if part.drum is not None:
        key = None if part.key is None else (part.key.region.outer, part.key.z1)
        return drum_solid(part.drum, part.layers[0].region.holes, tolerance, key)
    if not part.prismatic:
        message = f"{part.name} is where two outlines that are extruded crosswise overlap; no exact solid of it can be written"
        raise DesignError("exact solid", 1, 0, "", "", "take its STL or 3MF").saying(message)
    layers = [*part.layers, *part.engraved]
    points, strokes, runs = _divided([_outlines(layer, tolerance) for layer in layers])
    left, right = _sides(strokes, runs)
    heights = sorted({z for layer in layers for z in (layer.z0, layer.z1)})
    body = _Stack(
        points,
        strokes,
        heights,
        *(_filled(side, layers, len(part.layers), heights) for side in (left, right)),
    )
    solid = body.brep()
    if solid.faults or solid.bodies != 1:
        value, what = (
            (solid.faults, "edges with more than two faces")
            if solid.faults
            else (solid.bodies, "bodies and cavities")
        )
        raise DesignError(
            f"{what} of {part.name}",
            value,
            int(not solid.faults),
            "",
            "",
            "let the layers overlap, or part them",
        )
    return solid


def _outlines(layer: Layer, tolerance: float) -> list[list[_Stroke]]:
    """A layer's contours as strokes, material on their left."""
    outlines = []
    for k, contour in enumerate((layer.region.outer, *layer.region.holes)):
        contour = contour.counter_clockwise()
        z, bulge = bulges(fit_arcs(contour, tolerance))
        strokes = [
            _Stroke(a, b, t)
            for a, b, t in zip(z.tolist(), np.roll(z, -1).tolist(), bulge.tolist(), strict=True)
        ]
        outlines.append([_Stroke(s.b, s.a, -s.bulge) for s in reversed(strokes)] if k else strokes)
    return outlines


@dataclass
class _Strokes:
    """Strokes, each once, between points that are theirs alone."""

    ends: _Points
    middles: _Points = field(default_factory=_Points)
    strokes: list[_Stroke] = field(default_factory=list)
    index: dict[tuple[int, int, int], int] = field(default_factory=dict)  # by ends and middle

    def number(self, stroke: _Stroke) -> int:
        """Number of a stroke, -1 - k where the k-th is this one run backwards."""
        a = self.ends.number(stroke.a)
        b = self.ends.number(stroke.b)
        middle = self.middles.number(stroke.point(0.5))
        if (b, a, middle) in self.index:
            return -1 - self.index[b, a, middle]
        if (a, b, middle) not in self.index:
            self.index[a, b, middle] = len(self.strokes)
            self.strokes.append(_Stroke(self.ends.at[a], self.ends.at[b], stroke.bulge))
        return self.index[a, b, middle]


def _divided(
    regions: Sequence[list[list[_Stroke]]],
) -> tuple[list[complex], list[_Stroke], list[list[Step]]]:
    """All outlines, divided by each other: the points where they end, the strokes between them, each once, and of each region
    the strokes that bound it, with whether they are run forwards."""
    ends = _Points()
    pieces = _Strokes(ends)
    owners: dict[int, set[tuple[int, int]]] = defaultdict(set)  # contours that a piece belongs to
    outlines: list[list[int]] = []  # of each region its pieces; -1 - k: run backwards
    for k, region in enumerate(regions):
        outline = []
        for number, contour in enumerate(region):
            for stroke in contour:
                if ends.number(stroke.a) != ends.number(stroke.b):
                    outline.append(pieces.number(stroke))
                    owners[max(outline[-1], -1 - outline[-1])].add((k, number))
        outlines.append(outline)
    divided = _Strokes(ends, pieces.middles)
    parts: list[list[int]] = []
    for piece, cuts in zip(pieces.strokes, _cuts(pieces.strokes, owners, ends), strict=True):
        places = [piece.a, *(ends.at[k] for k in cuts), piece.b]
        parts.append([divided.number(piece.part(a, b)) for a, b in pairwise(places)])
    runs = []
    for outline in outlines:
        run = []
        for number in outline:
            run += parts[number] if number >= 0 else [-1 - part for part in parts[-1 - number]]
        runs.append([(part, True) if part >= 0 else (-1 - part, False) for part in run])
    return ends.at, divided.strokes, runs


def _cuts(
    pieces: Sequence[_Stroke], owners: Mapping[int, set[tuple[int, int]]], ends: _Points
) -> list[list[int]]:
    """Numbers of the points at which each piece is divided, in their order along it."""
    boxes = np.array([_box(piece) for piece in pieces])
    apart = (boxes[:, None, :2] > boxes[None, :, 2:]).any(axis=2)
    for i, j in zip(*np.nonzero(np.triu(~(apart | apart.T), 1)), strict=True):
        if owners[i] & owners[j]:
            continue  # of one contour, which does not cross itself
        for z in _meetings(pieces[i], pieces[j]):
            if all(
                -SAME
                <= (each.share(z) - 0.5) * _length(each) + _length(each) / 2
                <= _length(each) + SAME
                for each in (pieces[i], pieces[j])
            ):
                ends.number(z)
    places = np.array(ends.at)
    cuts = []
    for piece, (west, south, east, north) in zip(pieces, boxes, strict=True):
        near = (
            (places.real >= west)
            & (places.real <= east)
            & (places.imag >= south)
            & (places.imag <= north)
        )
        on = [
            (piece.share(z), k)
            for k in np.flatnonzero(near).tolist()
            if piece.off(z := ends.at[k]) <= SAME
        ]
        spare = SAME / _length(piece)
        cuts.append([k for share, k in sorted(on) if spare < share < 1 - spare])
    return cuts


def _length(stroke: _Stroke) -> float:
    return abs(stroke.b - stroke.a) / float(np.sinc(stroke.sweep / 2 / math.pi))


def _box(stroke: _Stroke) -> tuple[float, float, float, float]:
    """Least x and y, greatest x and y, and a little more."""
    rise = abs(stroke.bulge) * abs(stroke.b - stroke.a) / 2 + SAME
    a = stroke.a
    b = stroke.b
    return (
        min(a.real, b.real) - rise,
        min(a.imag, b.imag) - rise,
        max(a.real, b.real) + rise,
        max(a.imag, b.imag) + rise,
    )


def _meetings(one: _Stroke, other: _Stroke) -> list[complex]:
    """Where the lines or circles of two strokes meet; where they all but touch, once; none where they are the same."""
    if one.bulge == 0 == other.bulge:
        way = one.b - one.a
        across = other.b - other.a
        turn = (np.conj(way) * across).imag
        if abs(turn) <= 1e-9 * abs(way) * abs(across):
            return []
        return [one.a + way * float((np.conj(other.a - one.a) * across).imag / turn)]
    if one.bulge and not other.bulge:
        one, other = other, one
    centre = other.centre
    radius = abs(other.a - other.centre)
    if one.bulge:
        first = one.centre
        reach = abs(one.a - one.centre)
        apart = abs(centre - first)
        if apart <= SAME and abs(radius - reach) <= SAME:
            return []
        if apart <= SAME:
            return []
        along = (centre - first) / apart
        foot = (apart * apart + reach * reach - radius * radius) / (2 * apart)
        half = reach * reach - foot * foot
        touch = min(abs(apart - radius - reach), abs(apart - abs(radius - reach))) <= SAME
        base = first + along * (math.copysign(reach, foot) if touch else foot)
        along *= 1j
    else:
        along = (one.b - one.a) / abs(one.b - one.a)
        offset = ((centre - one.a) / along).imag
        base = one.a + along * ((centre - one.a) / along).real
        half = radius * radius - offset * offset
        touch = abs(abs(offset) - radius) <= SAME
    if touch:
        return [base]
    return [base + along * math.sqrt(half), base - along * math.sqrt(half)] if half > 0 else []


def _sides(strokes: Sequence[_Stroke], runs: Sequence[Sequence[Step]]) -> tuple[Bools, Bools]:
    """Whether each region, (m, n), is to the left and to the right of each stroke."""
    middles = np.array([stroke.point(0.5) for stroke in strokes])
    left = np.zeros((len(runs), len(strokes)), bool)
    right = left.copy()
    for k, run in enumerate(runs):
        boundary = [strokes[stroke] for stroke, _ in run]
        left[k] = right[k] = _inside(middles, boundary)
        for stroke, forward in run:
            left[k, stroke] = forward
            right[k, stroke] = not forward
    return left, right


def _inside(points: Points, boundary: Sequence[_Stroke]) -> Bools:
    """Whether points, (n,), lie inside what strokes boundary: by the chords, and the caps between chord and arc."""
    inside = np.zeros(len(points), bool)
    for stroke in boundary:
        a = stroke.a - points
        b = stroke.b - points
        turn = (np.conj(a) * b).imag
        inside ^= ((a.imag > 0) != (b.imag > 0)) & ((turn > 0) == (b.imag > a.imag))
        if stroke.bulge:
            cap = (np.abs(points - stroke.centre) < abs(stroke.a - stroke.centre)) & (
                turn * stroke.bulge < 0
            )
            inside ^= cap
    return inside


def _filled(side: Bools, layers: Sequence[Layer], count: int, heights: Sequence[float]) -> Bools:
    """Whether there is material in each slab, (m, n), to one side of each stroke, and none under and over them all; the first
    `count` layers are material, the others are taken away."""
    material = np.zeros((len(heights) + 1, side.shape[1]), bool)
    for k, (low, high) in enumerate(zip(heights, heights[1:], strict=False), 1):
        middle = (low + high) / 2
        present = [j for j, layer in enumerate(layers) if layer.z0 < middle < layer.z1]
        solid = np.any(side[[j for j in present if j < count]], axis=0)
        material[k] = solid & ~np.any(side[[j for j in present if j >= count]], axis=0)
    return material


@dataclass
class _Stack:
    """Faces, edges and corners of a stack, shared."""

    points: list[complex]
    strokes: list[_Stroke]
    heights: list[float]
    left: Bools  # whether there is material to the left of each stroke, (slabs + 2, strokes)
    right: Bools

    @cached_property
    def ends(self) -> list[tuple[int, int]]:
        """Points where each stroke begins and ends."""
        index = {(z.real, z.imag): k for k, z in enumerate(self.points)}
        return [(index[s.a.real, s.a.imag], index[s.b.real, s.b.imag]) for s in self.strokes]

    def brep(self) -> Brep:
        """The body, its parts in an order that depends on the outlines alone."""
        flats = []  # facing, level, loops
        for level in range(len(self.heights)):
            for facing, (has, lacks) in ((1, (level, level + 1)), (-1, (level + 1, level))):
                sides = [side[has] & ~side[lacks] for side in (self.left, self.right)]
                flats += [(facing, level, loops) for loops in self._loops(*sides)]
        walls = self._walls()
        used = {(s, level) for _, level, loops in flats for loop in loops for s, _ in loop}
        used |= {(s, level) for s, _, low, high in walls for level in (low, high)}
        edges = _Edges(self, used)
        faces = []
        for facing, level, loops in flats:
            rings: list[Loop] = []
            for loop in loops:
                ring = [edges.along(s, level, forward) for s, forward in loop]
                if facing < 0:
                    ring = [(edge, not forward) for edge, forward in reversed(ring)]
                rings.append(tuple(ring))
            faces.append(Face(facing, tuple(rings)))
        for s, forward, low, high in walls:
            start, end = self.ends[s] if forward else self.ends[s][::-1]
            down = [(edge, False) for edge, _ in reversed(edges.upright(start, low, high))]
            ring = [
                edges.along(s, low, forward),
                *edges.upright(end, low, high),
                edges.along(s, high, not forward),
                *down,
            ]
            faces.append(Face(0, (tuple(ring),)))
        places = [
            (self.points[p].real + 0.0, self.points[p].imag + 0.0, self.heights[level] + 0.0)
            for p, level in edges.corners
        ]
        return Brep(np.array(places), edges.edges, faces)

    def _walls(self) -> list[tuple[int, bool, int, int]]:
        """Stroke, whether its left side is the material's, and the levels between which it is a wall."""
        walls = []
        for s in range(len(self.strokes)):
            open_wall: tuple[bool, int] | None = None
            for slab in range(1, len(self.heights) + 1):
                wall = None
                if self.left[slab, s] != self.right[slab, s]:
                    wall = bool(self.left[slab, s])
                if open_wall is not None and open_wall[0] != wall:
                    walls.append((s, open_wall[0], open_wall[1], slab - 1))
                    open_wall = None
                if open_wall is None and wall is not None:
                    open_wall = wall, slab - 1
        return walls

    def _loops(self, left: Bools, right: Bools) -> list[list[list[Step]]]:
        """The level faces that lie to these sides of the strokes, each as its loops with the face on their left, the outer one
        first."""
        leaving: dict[int, list[Step]] = defaultdict(list)
        for s in np.flatnonzero(left != right).tolist():
            leaving[self.ends[s][0 if left[s] else 1]].append((s, bool(left[s])))
        outer: list[tuple[float, list[list[Step]]]] = []
        holes: list[tuple[float, list[Step]]] = []
        for first in [step for steps in list(leaving.values()) for step in steps]:
            if first not in leaving[self.ends[first[0]][0 if first[1] else 1]]:
                continue  # run already
            loop = []
            step = first
            while step in leaving[start := self.ends[step[0]][0 if step[1] else 1]]:
                leaving[start].remove(step)
                loop.append(step)
                step = self._next(step, leaving[self.ends[step[0]][1 if step[1] else 0]]) or first
            area = self._area(loop)
            if area > 0:
                outer.append((area, [loop]))
            else:
                holes.append((area, loop))
        for _, loop in holes:
            middle = np.array([self.strokes[loop[0][0]].point(0.5)])
            around = [
                each
                for each in outer
                if _inside(middle, [self.strokes[s] for s, _ in each[1][0]])[0]
            ]
            if around:
                min(around, key=lambda each: each[0])[1].append(loop)
        return [loops for _, loops in outer]

    def _run(self, step: Step) -> _Stroke:
        stroke = self.strokes[step[0]]
        return stroke if step[1] else _Stroke(stroke.b, stroke.a, -stroke.bulge)

    def _next(self, step: Step, leaving: Sequence[Step]) -> Step | None:
        """Of the steps that leave where one ends, the one that turns most to the left: so faces that meet in a point are two."""
        stroke = self._run(step)
        back = _Stroke(stroke.b, stroke.a, -stroke.bulge).leaves()
        return min(
            leaving,
            key=lambda other: float(np.angle(back / self._run(other).leaves())) % math.tau,
            default=None,
        )

    def _area(self, loop: Sequence[Step]) -> float:
        """Signed area of a loop, mm^2."""
        area = 0.0
        origin = self._run(loop[0]).a
        for stroke in map(self._run, loop):
            a = stroke.a - origin
            b = stroke.b - origin
            area += (a.conjugate() * b).imag / 2
            if stroke.bulge:
                radius = abs(stroke.a - stroke.centre)
                area += radius * radius * (stroke.sweep - math.sin(stroke.sweep)) / 2
        return area


class _Edges:
    """Corners and edges of a stack, each made where it is first needed; used: strokes and the levels at which they are edges."""

    def __init__(self, stack: _Stack, used: set[tuple[int, int]]) -> None:
        self.stack = stack
        self.levels: dict[int, set[int]] = defaultdict(set)  # at which a point is a corner
        for s, level in used:
            for point in stack.ends[s]:
                self.levels[point].add(level)
        self.corners: dict[tuple[int, int], int] = {}  # by point and level
        self.edges: list[Edge] = []
        self.index: dict[tuple[str, int, int], int] = {}  # by kind, stroke or point, and level

    def _corner(self, point: int, level: int) -> int:
        return self.corners.setdefault((point, level), len(self.corners))

    def along(self, s: int, level: int, forward: bool) -> Step:
        """The edge of a stroke at a level, run as the stroke or backwards."""
        a, b = (self._corner(point, level) for point in self.stack.ends[s])
        stroke = self.stack.strokes[s]
        if ("level", s, level) not in self.index:
            self.index["level", s, level] = len(self.edges)
            arc = (stroke.centre, abs(stroke.a - stroke.centre)) if stroke.bulge else (0j, 0.0)
            self.edges.append(Edge(*((a, b) if stroke.bulge >= 0 else (b, a)), *arc))
        return self.index["level", s, level], forward == (stroke.bulge >= 0)

    def upright(self, point: int, low: int, high: int) -> list[Step]:
        """The edges over a point, from below."""
        levels = sorted(level for level in self.levels[point] if low <= level <= high)
        for a, b in pairwise(levels):
            if ("upright", point, a) not in self.index:
                self.index["upright", point, a] = len(self.edges)
                self.edges.append(Edge(self._corner(point, a), self._corner(point, b)))
        return [(self.index["upright", point, level], True) for level in levels[:-1]]
