"""The judge's way back: what a compensated file becomes in print, so that its motion can be judged.

It moves the points that are in the file along the normals that are in the file; it knows nothing of the curves.
"""

from __future__ import annotations

import numpy as np

from camgen.geometry.rings import Floats, Points, Ring, Shape

_FACET = 0.6  # rad, a vertex that turns by more is a corner
_STEPS = 3  # of Newton's method, which starts off by the square of the distance over the radius
_ROUNDS = 64  # edges that turn over are taken out again and again; each round leaves fewer points


def printed(shape: Shape, hole: float, profile: float, shrinkage: float) -> Shape:
    """A recovered shape as it is in print: shrunk about the origin, holes smaller by `hole`, outline larger by `profile` (mm).

    ValueError where a ring vanishes.
    """
    small = shape.moved(1 - shrinkage)
    holes = tuple(grown(ring.counter_clockwise(), -hole) for ring in small.holes)
    return Shape(grown(small.outer, profile), holes)


def grown(ring: Ring, distance: float) -> Ring:
    """A counter-clockwise ring moved outwards by `distance` mm (< 0: inwards); arcs stay arcs about their centres.

    Each vertex goes to where its two moved edges meet; one of a curve that closes, along the curve's normal, so that the arc
    which a compensation put round a corner becomes that corner again. An edge that has turned over shrank to nothing: it is
    one point.
    ValueError where fewer than three points are left of a ring of straight edges, or less than two of one with arcs.
    """
    points = ring.points
    bulges = ring.bulges
    if distance == 0:
        return ring
    vertices = points + _ways(points, bulges, distance)
    for _ in range(_ROUNDS):
        over = _turned_over(points, vertices)
        if not over.any():
            least = 2 if bulges.any() else 3
            if len(vertices) < least:
                break
            return Ring(vertices, bulges)
        points, vertices, bulges = _merged(points, vertices, bulges, over)
        if len(vertices) < 2:
            break
    raise ValueError(f"nothing is left of a ring moved by {distance:g} mm")


def _ways(points: Points, bulges: Floats, distance: float) -> Points:
    """How far each vertex goes, mm.

    No corner closes where a compensation is undone, for there it opened and was filled by an arc: a small turn on that side
    is a curve's. Facets within one tolerance turn the less the longer they are, which parts the turn between both.
    """
    sides = _normals(points, bulges)
    (before, _), (after, _) = sides
    ways = distance * (before + after) / (1 + np.real(np.conj(before) * after))
    at = np.flatnonzero((sides[0][1] != 0) | (sides[1][1] != 0))
    curves = [
        (normal[at], bend[at] / np.maximum(1 + distance * bend[at], 0.5)) for normal, bend in sides
    ]
    for _ in range(_STEPS):  # of Newton's method, to where two moved circles of curvature meet
        offsets = [ways[at] - distance * normal for normal, _ in curves]
        off = [
            np.real(np.conj(n) * v) + k * np.abs(v) ** 2 / 2
            for (n, k), v in zip(curves, offsets, strict=True)
        ]
        a, b = (n + k * v for (n, k), v in zip(curves, offsets, strict=True))
        ways[at] += 1j * (off[0] * b - off[1] * a) / np.imag(np.conj(a) * b)
    straight = bulges == 0
    length = np.abs(np.roll(points, -1) - points)
    turn = np.angle(after / before)
    closes = straight & np.roll(straight, 1) & (np.abs(turn) < _FACET) & (turn * distance < 0)
    fraction = length / (length + np.roll(length, 1))
    return np.asarray(np.where(closes, distance * before * np.exp(1j * turn * fraction), ways))


def _normals(points: Points, bulges: Floats) -> tuple[tuple[Points, Floats], tuple[Points, Floats]]:
    """At each vertex, of the edge that ends there and of the one that begins there: the outward unit normal, and the
    curvature of the curve of which it is a facet that ends in a corner, 1/mm, 0 where it is none."""
    chord = np.roll(points, -1) - points
    length = np.abs(chord)
    across = -1j * chord / length
    half_turn = (1 + 1j * bulges) ** 2 / (1 + bulges**2)
    begins = across / half_turn
    ends = across * half_turn
    # Facets of a curve that ends in a corner: there the curve leaves its last chord by half the chord's own turning.
    turn = np.angle(across / np.roll(across, 1))  # at each vertex
    spacing = (length + np.roll(length, 1)) / 2
    bend = turn / spacing
    facet = (bulges == 0) & (np.roll(bulges, 1) == 0)
    smooth = facet & (np.abs(turn) < _FACET)

    def lean(sign: int) -> Floats:
        """Turning of the chord that leaves (sign 1) or reaches (-1) a corner, 0 where it is no facet of a curve."""
        near = np.roll(bend, -sign)
        far = np.roll(bend, -2 * sign)
        curved = np.roll(smooth, -sign) & np.roll(smooth, -2 * sign) & (near * far > 0)
        curved &= (np.abs(near) < 2 * np.abs(far)) & (np.abs(far) < 2 * np.abs(near))
        curved &= facet & (np.abs(turn) > 2 * np.abs(np.roll(turn, -sign)))
        return np.where(curved, near, 0.0)

    leaves = lean(1)
    reaches = lean(-1)
    begins = begins * np.exp(-0.5j * leaves * length)
    arrives = np.roll(ends, 1) * np.exp(0.5j * reaches * np.roll(length, 1))
    return (arrives, reaches), (begins, leaves)


def _turned_over(points: Points, vertices: Points) -> np.ndarray:
    """Edges that run backwards after the move, or have no length."""
    chord = np.roll(points, -1) - points
    after = np.roll(vertices, -1) - vertices
    return np.asarray(np.real(np.conj(chord) * after) <= 1e-12 * np.abs(chord) ** 2)


def _merged(
    points: Points, vertices: Points, bulges: Floats, over: np.ndarray
) -> tuple[Points, Points, Floats]:
    """Each run of turned-over edges as one point, in the middle of those that it joins."""
    start = int(np.flatnonzero(~over)[0]) + 1 if not over.all() else 0
    points = np.roll(points, -start)
    vertices = np.roll(vertices, -start)
    bulges = np.roll(bulges, -start)
    over = np.roll(over, -start)
    group = np.cumsum(np.append(True, ~over[:-1])) - 1
    count = np.bincount(group)
    place = (np.bincount(group, vertices.real) + 1j * np.bincount(group, vertices.imag)) / count
    source = (np.bincount(group, points.real) + 1j * np.bincount(group, points.imag)) / count
    last = np.cumsum(count) - 1
    return np.asarray(source, complex), np.asarray(place, complex), bulges[last]
