"""Outlines of known geometry, for tests of what the judge measures."""

from __future__ import annotations

import numpy as np

from camgen.geometry.rings import Ring


def polygon(points: np.ndarray) -> Ring:
    """Straight ring through the points."""
    return Ring(np.asarray(points, complex), np.zeros(len(points)))


def rounded(corners: np.ndarray, radius: float) -> Ring:
    """What a disc covers whose centre goes round a convex polygon: edges, and an arc about each corner."""
    outward = -1j * (np.roll(corners, -1) - corners)
    outward = radius * outward / np.abs(outward)
    before = np.roll(outward, 1)
    turn = np.angle(outward / before)
    points = np.column_stack([corners + before, corners + outward]).ravel()
    return Ring(points, np.column_stack([np.tan(turn / 4), np.zeros(len(turn))]).ravel())
