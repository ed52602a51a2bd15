"""Convex polygons: the hull of points, and how near two come to each other over a motion."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from camgen.geometry.outlines import Floats, Points


def hull_corners(points: Sequence[complex]) -> list[int]:
    """Indices of the corners of the convex hull of points, counter-clockwise; two of points on one line."""
    order = sorted(range(len(points)), key=lambda k: (points[k].real, points[k].imag))
    order = [k for j, k in enumerate(order) if j == 0 or points[k] != points[order[j - 1]]]
    if len(order) < 3:
        return order
    size = max(abs(points[k] - points[order[0]]) for k in order)

    def half(indices: Sequence[int]) -> list[int]:
        chain: list[int] = []
        for k in indices:
            while len(chain) > 1:
                a = points[chain[-1]] - points[chain[-2]]
                b = points[k] - points[chain[-2]]
                if (a.conjugate() * b).imag > 1e-9 * size * size:
                    break
                chain.pop()
            chain.append(k)
        return chain

    corners = half(order)[:-1] + half(order[::-1])[:-1]
    if len(corners) > 2:
        return corners
    ends = [
        max(order, key=lambda k: abs(points[k] - points[order[0]]))
    ]  # of one line: rounding may have ordered them across it
    ends.append(max(order, key=lambda k: abs(points[k] - points[ends[0]])))
    return sorted(ends, key=lambda k: (points[k].real, points[k].imag))


def distance(a: Points, b: Points) -> Floats:
    """Distance of two convex polygons over a motion, (n,) mm, 0 where they meet; corners (k, n) complex, k >= 1."""
    both = ((a, b), (b, a))
    towards = [(one, other) for one, other in both if len(other) > 1] or both[:1]
    least: Floats = np.minimum.reduce(
        [_to_side(one[:, None], *_sides(other)).min(axis=(0, 1)) for one, other in towards]
    )
    if len(towards) > 1:
        p0, p1 = (ends[:, None] for ends in _sides(a))
        q0, q1 = _sides(b)
        cross = _side(p0, p1, q0) * _side(p0, p1, q1) < 0
        cross &= _side(q0, q1, p0) * _side(q0, q1, p1) < 0
        least[cross.any(axis=(0, 1))] = 0.0
    for one, other in both:
        if len(one) > 2:
            inside = np.all(_side(*_sides(one), other[0]) >= 0, axis=0)
            least[inside] = 0.0
    return least


def _sides(corners: Points) -> tuple[Points, Points]:
    """Where each side begins and ends, (sides, n) each; of a point one without length."""
    if len(corners) < 3:
        return corners[:1], corners[-1:]
    return np.concatenate([corners[-1:], corners[:-1]]), corners


def _side(a: Points, b: Points, z: Points) -> Floats:
    return np.asarray(((b - a).conj() * (z - a)).imag)


def _to_side(z: Points, a: Points, b: Points) -> Floats:
    way = b - a
    offset = z - a
    square = np.abs(way) ** 2
    parameter = np.clip((way.conj() * offset).real / np.where(square > 0, square, 1.0), 0, 1)
    return np.asarray(np.abs(offset - parameter * way))
