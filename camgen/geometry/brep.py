"""Bodies bounded by level planes and upright walls, exactly: what a stack of plates is, without facets; and by splines.

corner   a point where edges end
edge     from one corner to another: upright, straight and level, a level arc, counter-clockwise seen from above, or a spline
face     level (looking up or down), or a wall: a plane or a cylinder between two heights, a piece of a cylinder about z, a spline
loop     the edges round a face, run so that the face lies on their left as seen from outside
"""

from __future__ import annotations

import cmath
import math
from collections import Counter, defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from camgen.errors import DesignError
from camgen.geometry.mesh import Mesh, components, weld
from camgen.geometry.rings import Floats, Ring
from camgen.geometry.splines import Patch, Spline
from camgen.numerics import magnitude

_ALONG = 1025  # points of a spline, of which the highest is looked for
_FEWEST = 4  # cells of a patch each way
_ASLANT = 0.8  # square roots of tolerance over radius, of a cell of a cylinder across
_DIGITS = 9  # of points, mm, that are one where patches meet


@dataclass(frozen=True)
class Edge:
    """From corner a to corner b (indices); centre and radius, mm, of an arc that runs counter-clockwise, radius 0: straight, or
    along a spline."""

    a: int
    b: int
    centre: complex = 0j
    radius: float = 0.0
    spline: Spline | None = None


Step = tuple[int, bool]  # an edge, and whether it is run from a to b
Loop = tuple[Step, ...]


@dataclass(frozen=True)
class Face:
    """A level face or a wall.

    radius: of a piece of a cylinder about z, whose edges need not be level, below 0 where it is seen from the axis; patch: of a wall that is a
    spline, whose four sides are its loop, from its v = 0, u growing.
    """

    looks: int  # +1 up, -1 down, 0 aside (a wall)
    loops: tuple[Loop, ...]  # the outer one first
    radius: float = 0.0
    patch: Patch | None = None


@dataclass(frozen=True, eq=False)
class Brep:
    """Corners (n, 3) mm, edges between them and faces round the material."""

    corners: Floats
    edges: Sequence[Edge]
    faces: Sequence[Face]

    @cached_property
    def plan(self) -> list[complex]:
        """The corners seen from above."""
        return [complex(x, y) for x, y in self.corners[:, :2].tolist()]

    @cached_property
    def heights(self) -> Floats:
        """Distinct heights of level faces, mm, from below."""
        return np.unique(
            [self.corners[self.first(face.loops[0][0]), 2] for face in self.faces if face.looks]
        )

    @cached_property
    def reach(self) -> Floats:
        """Its lowest and its highest place, mm, of splines at many points."""
        share = np.linspace(0, 1, _ALONG)
        splines = [each.spline(share)[:, 2] for each in self.edges if each.spline is not None]
        z = np.concatenate([self.corners[:, 2], *splines])
        return np.array([np.min(z), np.max(z)])

    def first(self, step: tuple[int, bool]) -> int:
        """The corner where a step of a loop begins."""
        edge, forward = step
        return self.edges[edge].a if forward else self.edges[edge].b

    def last(self, step: tuple[int, bool]) -> int:
        """The corner where a step of a loop ends."""
        return self.first((step[0], not step[1]))

    def bulge(self, step: tuple[int, bool]) -> float:
        """Bulge of a step of a loop, seen from above."""
        edge = self.edges[step[0]]
        if not edge.radius:
            return 0.0
        sweep = (
            cmath.phase((self.plan[edge.b] - edge.centre) / (self.plan[edge.a] - edge.centre))
            % math.tau
        )
        return math.tan(sweep / 4) * (1 if step[1] else -1)

    def ring(self, loop: Loop) -> Ring:
        """A level loop seen from above, as it runs."""
        return Ring(
            np.array([self.plan[self.first(step)] for step in loop]),
            np.array([self.bulge(step) for step in loop]),
        )

    def along(self, step: Step, share: Floats) -> Floats:
        """Points of a step of a loop at shares of it as it runs, (n, 3) mm."""
        edge = self.edges[step[0]]
        share = share if step[1] else 1 - share
        if edge.spline is not None:
            return edge.spline(share)
        a = self.corners[edge.a]
        b = self.corners[edge.b]
        if not edge.radius:
            return np.asarray(a + share[:, None] * (b - a))
        spoke = self.plan[edge.a] - edge.centre
        sweep = cmath.phase((self.plan[edge.b] - edge.centre) / spoke) % math.tau
        arc = edge.centre + spoke * np.exp(1j * sweep * share)
        return np.column_stack([arc.real, arc.imag, np.full(len(share), a[2])])

    def facets(self, tolerance: float) -> Mesh:
        """Its splines and the pieces of cylinders between them as triangles, mm: what a roller in a track meets.

        DesignError where it has no spline.
        """
        patches = [face.patch for face in self.faces if face.patch is not None]
        if not patches:
            raise DesignError(
                "walls that are splines", 0, 1, "", "the solid", "make the file again"
            )
        rows = columns = _FEWEST
        while True:
            off = np.max([each.bulge(columns, rows) for each in patches], axis=0)
            if off.max() <= tolerance / 2:
                break
            columns *= 1 + int(off[0] >= off[1])
            rows *= 1 + int(off[1] > off[0])
        u, v = (np.linspace(0, 1, count + 1) for count in (columns, rows))
        grids = [patch(u, v) for patch in patches]
        bands: dict[float, list[_Band]] = defaultdict(list)
        for face in self.faces:
            if face.radius:
                (loop,) = face.loops
                low = self.along(loop[0], u)
                high = self.along(loop[2], u)[::-1]
                bands[abs(face.radius)].append(_Band(low, high))
        for radius, pieces in bands.items():
            steps = max(piece.steps(radius, tolerance) for piece in pieces)
            grids += [piece.grid(radius, steps) for piece in pieces]
        return weld(np.round(np.concatenate([_triangles(grid) for grid in grids]), _DIGITS))

    @property
    def volume(self) -> float:
        """Volume, mm^3: of level faces each is its height times its area, and walls are upright but for splines."""
        volume = 0.0
        for face in self.faces:
            if face.patch is not None:
                volume += face.patch.flux
            if face.looks:
                height = float(self.corners[self.first(face.loops[0][0]), 2])
                volume += height * sum(self.ring(loop).area for loop in face.loops)
        return volume

    @property
    def faults(self) -> int:
        """Edges that do not bound two faces, run once each way, and loops that do not close."""
        uses = Counter(step for face in self.faces for loop in face.loops for step in loop)
        count = sum(
            uses[edge, True] != 1 or uses[edge, False] != 1 for edge in range(len(self.edges))
        )
        for face in self.faces:
            for loop in face.loops:
                count += any(
                    self.last(step) != self.first(after)
                    for step, after in zip(loop, (*loop[1:], loop[0]), strict=True)
                )
        return count

    @property
    def bodies(self) -> int:
        """Number of bodies and cavities: faces that edges join, counted together."""
        owner: dict[int, int] = {}  # the first face on each edge
        steps = (
            (edge, k)
            for k, face in enumerate(self.faces)
            for loop in face.loops
            for edge, _ in loop
        )
        links = np.array([(owner.setdefault(edge, k), k) for edge, k in steps]).reshape(-1, 2)
        return len(np.unique(components(len(self.faces), *links.T)))

    def section(self, z: float) -> list[Ring]:
        """Rings at a height between those of level faces, material on their left: each wall gives one edge.

        ValueError where they do not close.
        """
        steps: dict[complex, tuple[complex, float]] = {}
        for face in self.faces:
            if face.looks:
                continue
            (loop,) = face.loops
            ends = [(self.first(step), self.last(step)) for step in loop]
            upright = [
                (a, b) for a, b in ends if (self.corners[a, 2] < z) != (self.corners[b, 2] < z)
            ]
            if not upright:
                continue
            start = [self.plan[a] for a, b in upright if self.corners[a, 2] > z]
            end = [self.plan[a] for a, b in upright if self.corners[a, 2] < z]
            level = [
                step
                for step, (a, b) in zip(loop, ends, strict=True)
                if self.corners[a, 2] == self.corners[b, 2] and self.edges[step[0]].spline is None
            ]
            if len(start) != 1 or len(end) != 1 or not level or start[0] in steps:
                raise ValueError(f"the section at z = {z:.6g} mm does not close")
            lowest = min(level, key=lambda step: self.corners[self.first(step), 2])
            above = self.corners[self.first(lowest), 2] > z
            steps[start[0]] = end[0], self.bulge(lowest) * (-1 if above else 1)
        rings = []
        while steps:
            point = first = next(iter(steps))
            points = []
            bulges = []
            while point in steps:
                after, bulge = steps.pop(point)
                points.append(point)
                bulges.append(bulge)
                point = after
            if point != first:
                raise ValueError(f"the section at z = {z:.6g} mm does not close")
            rings.append(Ring(np.array(points), np.array(bulges)))
        return rings


@dataclass(frozen=True, eq=False)
class _Band:
    """A piece of a cylinder about z between two rows of points, (n, 3) mm, which need not lie over each other."""

    low: Floats
    high: Floats

    @cached_property
    def _turn(self) -> tuple[Floats, Floats]:
        """Angle of each lower point, and from it to the upper one, rad."""
        first, last = (np.arctan2(row[:, 1], row[:, 0]) for row in (self.low, self.high))
        return first, np.remainder(last - first + math.pi, math.tau) - math.pi

    def steps(self, radius: float, tolerance: float) -> int:
        """Number of cells between both rows.

        A chord over the angle a lies radius a^2 / 8 inside the cylinder. Along the rows a is at most 2 sqrt(tolerance / radius), and a
        diagonal goes over that and one cell across: (2 + 0.8)^2 / 8 < 1.
        """
        widest = magnitude(self._turn[1])
        return max(1, math.ceil(widest / (_ASLANT * math.sqrt(tolerance / radius))))

    def grid(self, radius: float, steps: int) -> Floats:
        """Points on the cylinder from row to row, (n, steps + 1, 3) mm."""
        share = np.linspace(0, 1, steps + 1)
        first, turn = self._turn
        angle = first[:, None] + turn[:, None] * share
        height = self.low[:, 2:] + (self.high[:, 2:] - self.low[:, 2:]) * share
        points = np.stack([radius * np.cos(angle), radius * np.sin(angle), height], axis=-1)
        points[:, 0] = self.low
        points[:, -1] = self.high
        return points


def _triangles(grid: Floats) -> Floats:
    """Of a grid of points (n, m, 3), which run along and across it, (k, 3, 3)."""
    a = grid[:-1, :-1]
    b = grid[1:, :-1]
    c = grid[1:, 1:]
    d = grid[:-1, 1:]
    halves = [np.stack(corners, axis=2).reshape(-1, 3, 3) for corners in ((a, b, c), (a, c, d))]
    return np.concatenate(halves)
