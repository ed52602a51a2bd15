"""Distances of points from rings, by each way to find them: against a regular polygon's closed form."""

from __future__ import annotations

import math

import numpy as np
import pytest

from camgen.geometry.distances import point_to_ring, segments_to_sections


@pytest.mark.parametrize("corners", [3, 12, 200, 201, 720])
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


def test_ways_beside_through_and_within_sections() -> None:
    """A square of 4 by 4 mm with a square hole of 2 by 2, and at another height one that stands 10 mm to the right."""
    square = np.array([-2 - 2j, 2 - 2j, 2 + 2j, -2 + 2j])
    sections = [[square, square / 2], [square + 10]]
    a = np.array([-5 - 9j, -9 + 0j, -0.5 + 0j, 15 + 6j])
    b = np.array([-5 + 9j, 9 + 0j, 0.5 + 0j, 15 + 5j])
    distances = [3, 0, 0.5, math.hypot(3, 3)]  # beside, through, in the hole, over a corner
    assert segments_to_sections(a, b, sections) == pytest.approx(distances)
    inside = np.array([1.5 + 0j, 10 + 0j, 9.5 + 1j])
    assert not segments_to_sections(inside, inside + 0.1, sections).any()
    assert np.isinf(segments_to_sections(a, b, [])).all()
