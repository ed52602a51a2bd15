"""Distances of points from rings, by each way to find them: against a regular polygon's closed form."""

from __future__ import annotations

import math

import numpy as np
import pytest

from camgen.geometry.distances import point_to_ring


@pytest.mark.parametrize("corners", [3, 12, 100, 101, 720])
def test_points_on_the_spokes_of_a_regular_polygon(corners: int) -> None:
    """Over an edge's middle the distance is that from its line, over a corner that from the corner."""
    radius = 10.0
    half = math.pi / corners
    ring = radius * np.exp(2j * half * np.arange(corners))
    reach = np.linspace(radius, 20, 50)
    over_corners = reach * np.exp(2j * half * (np.arange(50) % corners))
    assert np.allclose(point_to_ring(over_corners, ring), reach - radius, rtol=0, atol=1e-12)
    over_edges = reach * np.exp(1j * half * (2 * (np.arange(50) % corners) - 1))
    apothem = radius * math.cos(half)
    assert np.allclose(point_to_ring(over_edges, ring), reach - apothem, rtol=0, atol=1e-12)
    assert point_to_ring(np.zeros(1), ring)[0] == pytest.approx(apothem, abs=1e-12)
