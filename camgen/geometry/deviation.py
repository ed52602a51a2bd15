"""How far an exact contour is from the outline in a file: the largest distance, found by optimisation along the curve.

    place     parameter of a whole contour: the number of the piece plus the share of its way, so 2.25 is a quarter of the third
    stretch   a run of places that belongs to one edge of the file's outline and to one piece of the contour

Each vertex of the outline is dropped on to the curve; between two of them the curve belongs to the edge that joins them.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from camgen.geometry.outlines import Contour, Floats, Points
from camgen.geometry.rings import Ring
from camgen.numerics import crests

_SEEDS = 4  # samples of the curve for each vertex, among which its foot is sought
_LEAST_SEEDS = 2048
_NEWTON = 12  # steps towards the foot; four are enough from so near
_SAMPLES = 9  # of a stretch, its ends among them, between which the largest distance is bracketed
_STEPS = (
    40  # of the golden section: 0.618^40 of a bracket is 4e-9 of it, the distance there being flat
)
_NEAR_WORST = 0.5  # of the worst sample; stretches below it cannot hold the largest distance


def outline_error(contour: Contour, ring: Ring) -> float:
    """Largest distance (mm) of the points of a contour from the edges of a ring of straight edges and arcs.

    Both are closed and run the same way; a point is measured against the edge between whose vertices' feet it lies.
    """
    count = len(contour.pieces)
    feet = _feet(contour, ring.points)
    first = int(np.argmin(feet))
    edges = np.roll(np.arange(feet.size), -first)
    feet = np.roll(feet, -first)
    joints = np.arange(np.ceil(feet[0]), feet[0] + count)
    marks = np.unique(np.concatenate([feet, joints, [feet[0] + count]]))
    begin = marks[:-1]
    end = marks[1:]
    edge = edges[np.clip(np.searchsorted(feet, (begin + end) / 2, "right") - 1, 0, feet.size - 1)]

    parameter = np.linspace(0, 1, _SAMPLES)
    places = begin[:, None] + (end - begin)[:, None] * parameter
    piece = np.floor((begin + end) / 2).astype(int)
    off = _distance(ring, edge[:, None], _points(contour, places, piece[:, None]))
    worst = np.argmax(off, axis=1)
    near = np.flatnonzero(off.max(axis=1) >= _NEAR_WORST * off.max())
    low = places[near, np.maximum(worst[near] - 1, 0)]
    high = places[near, np.minimum(worst[near] + 1, _SAMPLES - 1)]
    edge = edge[near]
    piece = piece[near]

    def away(place: Floats) -> Floats:
        return _distance(ring, edge, _points(contour, place, piece))

    return max(float(off.max()), float(np.max(away(crests(away, low, high, _STEPS)))))


def _points(contour: Contour, places: Floats, piece: NDArray[np.int64], order: int = 0) -> Points:
    """Points at places (or derivatives to them), each on its own piece so that a joint may belong to either side."""
    points = np.empty(places.shape, complex)
    piece = np.broadcast_to(piece, places.shape)
    for k, curve in enumerate(contour.pieces):
        mine = piece % len(contour.pieces) == k
        if mine.any():
            length = curve.t1 - curve.t0
            points[mine] = length**order * curve.at(
                curve.t0 + length * (places[mine] - piece[mine]), order
            )
    return points


def _feet(contour: Contour, points: Points) -> Floats:
    """Places of a contour's points that are nearest to the given ones, (n,): the nearest sample, then Newton's method."""
    import shapely

    count = len(contour.pieces)
    n = max(_LEAST_SEEDS, _SEEDS * points.size) // count + 2
    piece = np.repeat(np.arange(count), n)
    seeds = np.tile(np.linspace(0, 1, n), count) + piece
    samples = _points(contour, seeds, piece)
    nearest = shapely.STRtree(shapely.points(samples.real, samples.imag)).nearest(
        shapely.points(points.real, points.imag)
    )
    piece = piece[nearest]
    place = np.asarray(seeds[nearest])
    for _ in range(_NEWTON):
        away = _points(contour, place, piece) - points
        d1 = _points(contour, place, piece, 1)
        d2 = _points(contour, place, piece, 2)
        slope = np.abs(d1) ** 2 + np.real(np.conj(away) * d2)
        step = np.real(np.conj(away) * d1) / np.where(slope > 0, slope, np.abs(d1) ** 2)
        place = np.asarray(np.clip(place - step, piece, piece + 1))
    return place


def _distance(ring: Ring, edge: NDArray[np.int64], z: Points) -> Floats:
    """Distance of points from edges of the ring, mm, each from its own.

    Off an arc of curvature kappa by d: f = d - kappa d^2 / 2 loses no digits on one that is nearly straight.
    """
    a = ring.points[edge]
    b = ring.ends[edge]
    half = 2 * np.arctan(ring.bulges[edge])
    chord = b - a
    kappa = 2 * np.sin(half) / np.abs(chord)
    leaving = chord * np.exp(-1j * half)
    arriving = chord * np.exp(1j * half)
    w = z - a
    f = np.imag(np.conj(leaving) * w) / np.abs(chord) - kappa * np.abs(w) ** 2 / 2
    off = np.abs(2 * f / (1 + np.sqrt(np.maximum(1 - 2 * kappa * f, 0))))
    beside = (np.real(np.conj(leaving) * w) >= 0) & (np.real(np.conj(arriving) * (z - b)) <= 0)
    return np.asarray(np.where(beside, off, np.minimum(np.abs(w), np.abs(z - b))))
