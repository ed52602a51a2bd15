"""What of an outline another one can touch first: rounds, hollows and lines, each with its outward normals.

    round     convex arc, or convex corner with radius 0
    hollow    concave arc; its outward normals point to its centre
    line      straight edge; all its normals are one

Concave corners are never touched first. Points are complex, mm, in the body's own frame, material on the left of each outline.
Long features are divided: a root that is looked for near a place then has few partners. Their formulas stay exact.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np

from camgen.geometry.rings import Floats, Ints, Points, Ring

_FLAT = 1e-7  # mm, sagitta below which an arc is a line
# rad, turn below which two edges meet without a corner; and arcs with one tangent leave gaps of 1e-10 between their ranges
SAME_NORMAL = 1e-9
_FEW = 8  # groups at the top of the tree
_SPARE = 1e-9  # mm, added to each disc against rounding
_LONGEST_ARC = 0.35  # rad
_LONGEST_SHARE = 0.01  # of the outline's length

Heights = tuple[float, float]
EVERYWHERE: Heights = (-math.inf, math.inf)  # of an outline that has no thickness


@dataclass(frozen=True)
class Features:
    """Features of one body, each (n,), along one outline after the other.

    centre: of a round or hollow, of a line its first point, mm. radius: mm, negative of a hollow, 0 of a corner or line.
    middle: unit, the outward normal half way, and half: rad, by which the others differ from it. length: of a line, mm, else 0.
    hub, reach: disc in which the feature lies. low, high: heights between which it is there.
    """

    centre: Points
    radius: Floats
    middle: Points
    half: Floats
    length: Floats
    hub: Points
    reach: Floats
    low: Floats
    high: Floats

    def __len__(self) -> int:
        return len(self.centre)

    def take(self, index: Ints) -> Features:
        """Those with the given places in the list."""
        return Features(*(getattr(self, each.name)[index] for each in fields(self)))

    @cached_property
    def straight(self) -> np.ndarray:
        """Which are lines, (n,) bool."""
        return self.length > 0

    @cached_property
    def anchor(self) -> Points:
        """The point whose motion tells how the feature moves: a centre, or the middle of a line."""
        return self.centre + 0.5j * self.middle * self.length

    @cached_property
    def chord(self) -> Floats:
        """Longest chord from the middle normal to another one, of unit circle."""
        return 2 * np.sin(np.minimum(self.half + SAME_NORMAL, np.pi) / 2)

    @cached_property
    def away(self) -> Floats:
        """Distance of each centre from the body's origin, mm."""
        return np.abs(self.centre)

    @cached_property
    def far(self) -> float:
        """Greatest distance from the body's origin, mm."""
        return float(np.max(np.abs(self.hub) + self.reach))

    @cached_property
    def tree(self) -> list[Groups]:
        """The features themselves, then groups of two, of four and so on, down to a few."""
        levels = [Groups(self.hub, self.reach, np.angle(self.middle), self.half)]
        while len(levels[-1]) > _FEW:
            levels.append(levels[-1].halved())
        return levels


@dataclass(frozen=True)
class Groups:
    """Features that follow each other, in groups, each (n,).

    hub, reach: disc in which a group lies, mm. angle, half: range of its outward normals, from angle - half to angle + half, rad.
    """

    hub: Points
    reach: Floats
    angle: Floats
    half: Floats

    def __len__(self) -> int:
        return len(self.hub)

    @cached_property
    def far(self) -> Floats:
        """Greatest distance of each from the body's origin, mm."""
        return np.abs(self.hub) + self.reach

    def halved(self) -> Groups:
        """Half as many, each of two: group k holds the groups 2 k and 2 k + 1, where there is such a one."""
        first = np.arange(0, len(self), 2)
        second = np.minimum(first + 1, len(self) - 1)
        way = self.hub[second] - self.hub[first]
        long = np.abs(way)
        reach = np.maximum(self.reach[first], self.reach[second])
        reach = np.maximum(reach, (long + self.reach[first] + self.reach[second]) / 2)
        share = np.clip((reach - self.reach[first]) / np.where(long > 0, long, 1.0), 0.0, 1.0)
        off = np.angle(np.exp(1j * (self.angle[second] - self.angle[first])))
        low = np.minimum(-self.half[first], off - self.half[second])
        high = np.maximum(self.half[first], off + self.half[second])
        return Groups(
            self.hub[first] + share * way,
            reach + _SPARE,
            self.angle[first] + (low + high) / 2,
            (high - low) / 2,
        )


def features(rings: Sequence[Ring], heights: Sequence[Heights] = ()) -> Features:
    """Features of outlines that are one body: rings with their material on the left.

    heights: of each ring, mm; where none are given, all reach everywhere.
    """
    spans = heights or [EVERYWHERE] * len(rings)
    several = [_of_ring(ring, span) for ring, span in zip(rings, spans, strict=True)]
    return Features(
        *(
            np.concatenate([getattr(each, field.name) for each in several])
            for field in fields(Features)
        )
    )


def _of_ring(ring: Ring, heights: Heights) -> Features:
    """Edges, and between them the convex corners, of one outline."""
    kept = ring.points != ring.ends
    start = ring.points[kept]
    end = ring.ends[kept]
    bulge = ring.bulges[kept]
    chord = end - start
    bulge = np.where(np.abs(bulge * chord) < 2 * _FLAT, 0.0, bulge)
    sweep = 4 * np.arctan(bulge)
    half_turn = np.exp(0.5j * sweep)
    across = -1j * chord / np.abs(chord)
    first = across / half_turn
    last = across * half_turn
    turn = np.angle(np.roll(first, -1) * np.conj(last))
    corner = np.flatnonzero(turn > SAME_NORMAL)
    zero = np.zeros(len(corner))
    corners = Features(
        end[corner],
        zero,
        last[corner] * np.exp(0.5j * turn[corner]),
        turn[corner] / 2,
        zero,
        end[corner],
        zero,
        zero,
        zero,
    )
    edges, edge = _edges(start, end, bulge, first, ring.length)
    along = np.argsort(np.concatenate([edge, corner + 0.5]), kind="stable")
    both = [
        np.concatenate([getattr(edges, field.name), getattr(corners, field.name)])[along]
        for field in fields(Features)[:-2]
    ]
    count = len(both[0])
    both += [np.full(count, height) for height in heights]
    return Features(*both)


def _edges(
    start: Points, end: Points, bulge: Floats, first: Points, whole: float
) -> tuple[Features, Ints]:
    """Arcs and lines, divided, and the edge of which each is a part; whole: length of the outline, mm."""
    sweep = 4 * np.arctan(bulge)
    arc = bulge != 0
    chord = np.abs(end - start)
    radius = np.where(arc, chord / (2 * np.sin(np.where(arc, sweep, 1.0) / 2)), 0.0)
    length = np.where(arc, radius * sweep, chord)
    parts = np.maximum(
        np.ceil(np.abs(sweep) / _LONGEST_ARC), np.ceil(length / (_LONGEST_SHARE * whole))
    )
    parts = np.maximum(parts, 1).astype(np.int64)
    edge = np.repeat(np.arange(len(parts)), parts)
    place = np.arange(len(edge)) - np.repeat(np.cumsum(parts) - parts, parts)
    share = (place + 0.5) / parts[edge]
    arc = arc[edge]
    step = sweep[edge] / parts[edge]
    middle = first[edge] * np.exp(1j * share * sweep[edge])
    radius = radius[edge]
    centre = start[edge] - radius * first[edge]
    piece = length[edge] / parts[edge]
    begin = start[edge] + (end - start)[edge] * (place / parts[edge])
    hub = np.where(arc, centre + radius * middle, begin + 0.5j * middle * piece)
    zero = np.zeros(len(edge))
    parts_of_edges = Features(
        np.where(arc, centre, begin),
        radius,
        middle,
        np.abs(step) / 2,
        np.where(arc, 0.0, piece),
        hub,
        np.where(arc, 2 * np.abs(radius * np.sin(step / 4)), piece / 2),
        zero,
        zero,
    )
    return parts_of_edges, edge
