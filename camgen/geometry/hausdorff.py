"""How far one line strays from another, by a bound: the directed Hausdorff distance of lines made of straight edges.

The bound. The distance of a place from a set changes by no more than the place moves (it is 1-Lipschitz), and the distance
from one edge of the set is convex along a straight way. So of a stretch with middle m and half length l no place is farther
from the set than

    d(m) + l        nor than the farther one of both ends from the edge that is nearest to m.

Stretches are halved until the lesser of the two is no more than the farthest place seen, and a resolution. What is left out
is proven, however far apart the corners of both lines are.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camgen.numerics import Floats, Indices, Points

_PLACE = 1e-12  # mm, up to which a way is a place: the square of its length would have no digits


@dataclass(frozen=True)
class Edges:
    """Straight ways from a to b, (n,) complex mm; a place by itself is a way of no length."""

    a: Points
    b: Points

    @classmethod
    def of_line(cls, corners: Points) -> Edges:
        """Those of a line through corners, (n,), n > 1."""
        return cls.between(corners[:-1], corners[1:])

    @classmethod
    def between(cls, a: Points, b: Points) -> Edges:
        """Those from each place to another, both (n,)."""
        return cls(a, np.where(np.abs(b - a) > _PLACE, b, a))

    @classmethod
    def of_places(cls, places: Points) -> Edges:
        """Places by themselves, (n,)."""
        return cls(places, places)

    @property
    def length(self) -> float:
        """Of all together, mm."""
        return float(np.sum(np.abs(self.b - self.a)))

    def foot(self, places: Points) -> Points:
        """Of each place the nearest one of its own edge, (n,)."""
        way = self.b - self.a
        square = np.abs(way) ** 2
        parameter = np.real((places - self.a) * np.conj(way)) / np.where(square > 0, square, 1.0)
        return np.asarray(self.a + np.clip(parameter, 0.0, 1.0) * way)

    def away(self, places: Points) -> Floats:
        """Distance of each place from its own edge, (n,) mm."""
        return np.abs(places - self.foot(places))

    def some(self, which: Indices) -> Edges:
        """Those with these numbers."""
        return Edges(self.a[which], self.b[which])


@dataclass(frozen=True)
class Stray:
    """How far a line strays from another one."""

    place: complex  # the farthest one of the line that was seen, mm
    foot: complex  # the nearest one to it of the other line, mm
    proven: float  # mm, no place of the line is farther

    @property
    def farthest(self) -> float:
        """Distance of the farthest place that was seen, mm."""
        return abs(self.place - self.foot)


def stray(line: Edges, other: Edges, resolution: float) -> Stray:
    """How far a line strays from another one; resolution: mm > 0, by which `proven` may be more than `farthest`."""
    import shapely

    ways = np.stack([other.a, other.b], axis=1)
    tree = shapely.STRtree(shapely.linestrings(np.stack([ways.real, ways.imag], axis=-1)))

    def facing(places: Points) -> Edges:
        """Of each place the nearest edge of the other line."""
        return other.some(
            tree.query_nearest(shapely.points(places.real, places.imag), all_matches=False)[1]
        )

    def farthest(places: Points, edges: Edges) -> Stray:
        feet = edges.foot(places)
        away = np.abs(places - feet)
        worst = int(np.argmax(away))
        return Stray(complex(places[worst]), complex(feet[worst]), float(away[worst]))

    ends = np.unique(np.concatenate([line.a, line.b]))
    best = farthest(ends, facing(ends))
    proven = best.proven
    pieces = line.some(np.flatnonzero(line.a != line.b))
    while len(pieces.a):
        middle = (pieces.a + pieces.b) / 2
        edges = facing(middle)
        best = max(best, farthest(middle, edges), key=lambda each: each.proven)
        by_way = edges.away(middle) + np.abs(pieces.b - pieces.a) / 2
        by_ends = np.maximum(edges.away(pieces.a), edges.away(pieces.b))
        distance = np.minimum(by_way, by_ends)
        in_question = distance > best.farthest + resolution
        proven = max(proven, best.farthest, float(np.max(distance[~in_question], initial=0.0)))
        begins = np.concatenate([pieces.a[in_question], middle[in_question]])
        pieces = Edges(begins, np.concatenate([middle[in_question], pieces.b[in_question]]))
    return Stray(best.place, best.foot, proven)
