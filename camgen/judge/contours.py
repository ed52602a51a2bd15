"""How far a contour in a file is from the one that was meant."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from camgen.geometry.distances import point_to_ring
from camgen.geometry.rings import Points, Ring
from camgen.numerics import magnitude
from camgen.tolerances import SAME_POINT

_ALONG = 0.25  # mm, between points of a straight edge that are compared: less than any wall, so no slit leaps over them
_MOST_ALONG = (
    20_000  # such points on a contour; on one that is longer than 5 m they lie further apart
)


def contour_error(contour: Ring, nominal: Ring, tolerance: float) -> float:
    """How far a contour is from the one meant, mm: the largest distance either way of points along their edges, and the
    difference of their areas over the length. Arcs are facetted within the tolerance, mm.
    """
    area = abs(abs(contour.area) - abs(nominal.area)) / nominal.length
    return max(
        area,
        _deviation(contour.facetted(tolerance).tobytes(), nominal.facetted(tolerance).tobytes()),
    )


@lru_cache(maxsize=128)  # one contour stands at several heights, in STL and 3MF alike
def _deviation(first: bytes, second: bytes) -> float:
    """The largest distance either way of points along the edges of two polygons, given as their vertices' bytes, mm."""
    a, b = (np.frombuffer(vertices, complex) for vertices in (first, second))
    if len(a) == len(b) and (off := magnitude(a - b)) <= SAME_POINT:
        return off
    return max(
        float(np.max(point_to_ring(_along(a), b))), float(np.max(point_to_ring(_along(b), a)))
    )


def _along(ring: Points) -> Points:
    """A polygon's vertices, and points on its edges that are at most _ALONG apart, or so many as a long one may have."""
    way = np.roll(ring, -1) - ring
    length = np.abs(way)
    count = np.maximum(np.ceil(length / max(_ALONG, float(length.sum()) / _MOST_ALONG)), 1).astype(
        int
    )
    edge = np.repeat(np.arange(len(ring)), count)
    step = np.arange(len(edge)) - np.repeat(np.cumsum(count) - count, count)
    return np.asarray(ring[edge] + way[edge] * step / count[edge])
