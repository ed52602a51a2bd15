"""Distances between polygons: rings of complex points, mm, closed implicitly."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.complex128]
Flags = NDArray[np.bool_]

_BLOCK = 2_000_000  # pairs held at once: about 100 MB of temporaries


def point_to_ring(points: Points, ring: Points) -> NDArray[np.float64]:
    """Distance of each point from the nearest edge of the ring, (n,) mm, 0 on it and positive on both sides."""
    a, along = ring, np.roll(ring, -1) - ring
    square = np.maximum(np.abs(along) ** 2, np.finfo(float).tiny)
    nearest = np.empty(len(points))
    step = max(1, _BLOCK // len(ring))
    for k in range(0, len(points), step):
        rest = points[k : k + step, None] - a
        u = np.clip(np.real(rest * np.conj(along)) / square, 0, 1)
        nearest[k : k + step] = np.min(np.abs(rest - u * along), axis=1)
    return nearest


def inside(points: Points, ring: Points) -> Flags:
    """Whether each point lies inside the ring (even-odd rule), (n,) bool; points on an edge may go either way."""
    a, b = ring, np.roll(ring, -1)
    result = np.empty(len(points), bool)
    step = max(1, _BLOCK // len(ring))
    for k in range(0, len(points), step):
        z = points[k : k + step, None]
        spans = (a.imag > z.imag) != (b.imag > z.imag)
        rise = np.where(spans, b.imag - a.imag, 1.0)
        crossing = a.real + (z.imag - a.imag) * (b.real - a.real) / rise
        result[k : k + step] = np.sum(spans & (z.real < crossing), axis=1) % 2 == 1
    return result


def gap(first: Points, second: Points) -> float:
    """Smallest distance between two rings, mm; 0 where they cross."""
    near = min(float(np.min(point_to_ring(first, second))), float(np.min(point_to_ring(second, first))))
    one, other = inside(first, second), inside(second, first)
    crossed = bool(np.any(one) and not np.all(one)) or bool(np.any(other) and not np.all(other))
    return 0.0 if crossed else near


def thinnest_wall(outer: Points, holes: Any) -> float:
    """Smallest wall between the outer ring and its holes and among the holes, mm; 0 or less where they cross or lie apart."""
    walls = []
    for k, hole in enumerate(holes):
        walls.append(gap(outer, hole) if np.all(inside(hole, outer)) else -gap(outer, hole))
        for other in holes[k + 1 :]:
            nested = inside(hole[:1], other)[0] or inside(other[:1], hole)[0]
            walls.append(0.0 if nested else gap(hole, other))
    return min(walls, default=float("inf"))
