"""Rows of a binary STL, for tests that damage one."""

from __future__ import annotations

import numpy as np

TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def with_own_normals(triangles: np.ndarray) -> np.ndarray:
    """The triangles with the normals of their corners, (m,) rows: what a program writes that changed the corners."""
    a, b, c = np.moveaxis(triangles["corners"].astype(float), 1, 0)
    normal = np.cross(b - a, c - a)
    size = np.linalg.norm(normal, axis=1, keepdims=True)
    triangles["normal"] = normal / np.where(size == 0, 1, size)
    return triangles
