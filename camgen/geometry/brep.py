"""Bodies bounded by level planes and upright walls, exactly: what a stack of plates is, without facets.

corner   a point where edges end
edge     from one corner to another: upright, straight and level, or a level arc, counter-clockwise seen from above
face     level (looking up or down), or a wall: a plane or a cylinder between two heights
loop     the edges round a face, run so that the face lies on their left as seen from outside
"""

from __future__ import annotations

import cmath
import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from camgen.geometry.mesh import components
from camgen.geometry.rings import Floats, Ring, Shape, shape_of


@dataclass(frozen=True)
class Edge:
    """From corner a to corner b (indices); centre and radius, mm, of an arc that runs counter-clockwise, radius 0: straight."""

    a: int
    b: int
    centre: complex = 0j
    radius: float = 0.0


Loop = tuple[tuple[int, bool], ...]  # edges, and whether each is run from a to b


@dataclass(frozen=True)
class Face:
    """A level face or a wall."""

    looks: int  # +1 up, -1 down, 0 aside (a wall)
    loops: tuple[Loop, ...]  # the outer one first


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

    @property
    def volume(self) -> float:
        """Volume, mm^3: of level faces each is its height times its area, and walls are upright."""
        volume = 0.0
        for face in self.faces:
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
                if self.corners[a, 2] == self.corners[b, 2]
            ]
            if len(start) != 1 or len(end) != 1 or not level or start[0] in steps:
                raise ValueError(f"the section at z = {z:.6g} mm does not close")
            lowest = min(level, key=lambda step: self.corners[self.first(step), 2])
            steps[start[0]] = end[0], self.bulge(lowest)
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

    def outlines(self, looks: int, height: float) -> list[Shape]:
        """The level faces at a height that look up (+1) or down (-1), each as a flat shape."""
        return [
            shape_of([self.ring(loop) for loop in face.loops])
            for face in self.faces
            if face.looks == looks and self.corners[self.first(face.loops[0][0]), 2] == height
        ]
