"""Distances between polygons: rings of complex points, mm, closed implicitly; measured by shapely (GEOS)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from camgen.numerics import Floats, Points, coordinates

if TYPE_CHECKING:
    import shapely

_FEW = 200  # edges of a ring that are gone through one by one in less time than a tree takes


def _polygon(ring: Points) -> shapely.Polygon:
    import shapely

    return shapely.Polygon(coordinates(ring))


def _edges(rings: Sequence[Points]) -> shapely.STRtree:
    """All edges of rings."""
    import shapely

    start = np.concatenate(rings)
    end = np.concatenate([np.roll(ring, -1) for ring in rings])
    corners = np.stack([start, end], axis=1)
    return shapely.STRtree(shapely.linestrings(np.stack([corners.real, corners.imag], axis=2)))


def point_to_ring(points: Points, ring: Points) -> Floats:
    """Distance of each point from the nearest edge of the ring, (n,) mm, 0 on it and positive on both sides."""
    import shapely

    places = shapely.points(points.real, points.imag)
    if 2 < len(ring) <= _FEW:
        return np.asarray(shapely.distance(places, _polygon(ring).exterior))
    _, distances = _edges([ring]).query_nearest(places, return_distance=True, all_matches=False)
    return np.asarray(distances)


def thinnest_wall(outer: Points, holes: Sequence[Points]) -> float:
    """Smallest wall between the outer ring and its holes and among the holes, mm.

    0 where they cross each other or themselves, or where a hole lies outside.
    """
    import shapely

    edge = _polygon(outer)
    discs = [_polygon(hole) for hole in holes]
    if not all(shapely.is_valid([edge, *discs])):
        return 0.0
    rim = edge.exterior
    shapely.prepare([edge, rim, *discs])
    walls = [float(rim.distance(disc)) if edge.contains(disc) else 0.0 for disc in discs]
    walls += [
        float(disc.distance(other)) for k, disc in enumerate(discs) for other in discs[k + 1 :]
    ]
    return min(walls, default=float("inf"))


def inside(points: Points, ring: Points) -> NDArray[np.bool_]:
    """Whether each point lies inside the ring, (n,) bool; not where it lies on an edge."""
    import shapely

    return np.asarray(shapely.contains_xy(_polygon(ring), points.real, points.imag))


def segments_to_sections(a: Points, b: Points, sections: Sequence[Sequence[Points]]) -> Floats:
    """Distance of each straight way from a to b, (n,), from the nearest of sections, which are what rings enclose (even-odd),
    (n,) mm, 0 within one; inf where there is none."""
    import shapely

    if not sections:
        return np.full(len(a), np.inf)
    ways = shapely.linestrings(np.stack([coordinates(a), coordinates(b)], axis=1))
    _, least = _edges([ring for rings in sections for ring in rings]).query_nearest(
        ways, return_distance=True, all_matches=False
    )
    for rings in sections:
        within = [shapely.contains_xy(_polygon(ring), a.real, a.imag) for ring in rings]
        least = np.where(np.sum(within, axis=0) % 2 == 1, 0.0, least)
    return np.asarray(least)
