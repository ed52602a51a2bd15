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
from typing import Literal

import numpy as np

from camgen.geometry.rings import Floats, Ints, Points, Ring

_FLAT = 1e-7  # mm, sagitta below which an arc is a line
# rad, turn below which two edges meet without a corner; and arcs with one tangent leave gaps of 1e-10 between their ranges
SAME_NORMAL = 1e-9
_LONGEST_ARC = 0.35  # rad
_LONGEST_SHARE = 0.01  # of the outline's length

Heights = tuple[float, float]
EVERYWHERE: Heights = (-math.inf, math.inf)  # of an outline that has no thickness


@dataclass(frozen=True)
class Features:
    """Features of one body, each (n,).

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
    def normal_angle(self) -> Floats:
        """Direction of the first normal, rad."""
        return np.angle(self.middle) - self.half

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
    edges = _edges(start, end, bulge, first, ring.length)
    both = [
        np.concatenate([getattr(edges, field.name), getattr(corners, field.name)])
        for field in fields(Features)[:-2]
    ]
    count = len(both[0])
    both += [np.full(count, height) for height in heights]
    return Features(*both)


def _edges(start: Points, end: Points, bulge: Floats, first: Points, whole: float) -> Features:
    """Arcs and lines, divided; whole: length of the outline, mm."""
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
    return Features(
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


def overlapping(
    first: tuple[Floats, Floats], second: tuple[Floats, Floats], block: tuple[Ints, Ints]
) -> tuple[Ints, Ints]:
    """Pairs of intervals, one of each list, that are of one block and share a value; places in both lists.

    first, second: starts and widths >= 0, (n,) and (m,); block: of each, (n,) and (m,) from 0.
    Of each pair one interval starts within the other: both searches together give all pairs, once, in n log n and their number.
    """
    if not len(first[0]) or not len(second[0]):
        none = np.zeros(0, np.int64)
        return none, none
    low = min(float(first[0].min()), float(second[0].min()))
    high = max(float((each[0] + each[1]).max()) for each in (first, second))
    span = high - low + 1.0
    key_first = block[0] * span + (first[0] - low)
    key_second = block[1] * span + (second[0] - low)
    i, j = _starting_within(key_first, first[1], key_second, "left")
    n, m = _starting_within(key_second, second[1], key_first, "right")
    return np.concatenate([i, m]), np.concatenate([j, n])


def _starting_within(
    low: Floats, width: Floats, others: Floats, side: Literal["left", "right"]
) -> tuple[Ints, Ints]:
    """Of each interval those others that start within it, at its own start only where side is "left"."""
    order = np.argsort(others, kind="stable")
    ranked = others[order]
    begin = np.searchsorted(ranked, low, side)
    end = np.maximum(np.searchsorted(ranked, low + width, "right"), begin)
    count = end - begin
    which = np.repeat(np.arange(len(low)), count)
    place = np.arange(len(which)) - np.repeat(np.cumsum(count) - count, count)
    return which, order[begin[which] + place]
