"""Teeth of an outline of any maker compared with each other: what differs from its own kind shows without knowing what was meant.

count     how often the outline repeats about its pivot
off       of a place of the outline: median of its distances from the outline turned by some teeth, mm; one tooth that is odd
          moves no median of another one
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from camgen.geometry.rings import Ring
from camgen.numerics import coordinates

_LEAST = 5  # teeth
_AROUND = 4096  # directions in which the radius is seen
_EACH = 48  # places of a tooth
_TURNS = (1, 2, 3, -1, -2)  # teeth by which the outline is turned
_FINE = 1e-4  # mm, of facets
_ALIKE = (
    0.02  # of the height of the teeth: what repeats is nearer to itself than that, nearly all round
)


@dataclass(frozen=True)
class UnlikeTooth:
    """The tooth, of so many, that differs most from its neighbours: where it is, rad about the pivot, and by how much, mm."""

    count: int
    direction: float
    off: float


def unlike_tooth(ring: Ring) -> UnlikeTooth | None:
    """Of an outline about its pivot; None of one that does not repeat as teeth do."""
    import shapely

    z = ring.facetted(_FINE)
    angle = np.angle(z)
    order = np.argsort(angle)
    around = math.tau * np.arange(_AROUND) / _AROUND - math.pi
    radius = np.interp(around, angle[order], np.abs(z)[order], period=math.tau)
    strength = np.abs(np.fft.rfft(radius))
    strength[:_LEAST] = 0.0
    count = int(np.argmax(strength))
    if count < _LEAST:
        return None
    line = shapely.LinearRing(coordinates(z))
    ends = np.append(z, z[:1])
    corners = np.stack([ends[:-1], ends[1:]], axis=1)
    edges = shapely.STRtree(shapely.linestrings(np.stack([corners.real, corners.imag], axis=2)))
    ways = np.linspace(0.0, line.length, _EACH * count, endpoint=False)
    places = shapely.get_coordinates(shapely.line_interpolate_point(line, ways)) @ [1, 1j]
    turned = places * np.exp(1j * math.tau / count * np.array(_TURNS))[:, None]
    points = shapely.points(turned.ravel().real, turned.ravel().imag)
    _, apart = edges.query_nearest(points, return_distance=True, all_matches=False)
    off = np.median(apart.reshape(turned.shape), axis=0)
    height = float(np.ptp(np.abs(z)))
    if not np.quantile(off, 0.9) < _ALIKE * height:
        return None
    k = int(np.argmax(off))
    return UnlikeTooth(count, float(np.angle(places[k])), float(off[k]))
