"""How far one line strays from another: closed forms, and every place of lines made by chance."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from camgen.geometry.hausdorff import Edges, stray

COORDINATES = st.builds(complex, st.integers(-50, 50), st.integers(-50, 50)) | st.complex_numbers(
    max_magnitude=50
)


def line(corners: list[complex]) -> shapely.LineString:
    z = np.round(np.array(corners), 12)  # GEOS loses ways whose square has no digits
    return shapely.linestrings(z.real, z.imag)


@pytest.mark.parametrize("corners", [3, 5, 12])
def test_between_the_corners_of_a_polygon_its_circle_strays_by_the_height_of_an_arc(
    corners: int,
) -> None:
    polygon = 50 * np.exp(2j * math.pi * np.arange(corners + 1) / corners)
    circle = 50 * np.exp(2j * math.pi * np.arange(3601) / 3600)
    found = stray(Edges.of_line(circle), Edges.of_line(polygon), 1e-4)
    height = 50 * (1 - math.cos(math.pi / corners))
    assert (
        found.farthest == pytest.approx(height, abs=1e-3)
        and height - 1e-3 <= found.proven <= found.farthest + 1e-4
    )


def test_a_spike_is_seen_from_its_own_line_alone() -> None:
    flat, spiked = np.array([0, 100 + 0j]), np.array([0, 49, 50 + 7j, 51, 100])
    assert stray(Edges.of_line(spiked), Edges.of_line(flat), 1e-6).proven == pytest.approx(
        7, abs=1e-6
    )
    back = stray(Edges.of_line(flat), Edges.of_line(spiked), 1e-6)
    assert back.proven == pytest.approx(
        np.sin(np.angle(1 + 7j)), abs=1e-6
    )  # of the foot's middle, 1 mm from both flanks' ends


def test_places_by_themselves_and_a_line_that_is_a_place() -> None:
    places, way = np.array([0, 10 + 2j, 20 + 0j]), np.array([0, 20 + 0j])
    assert stray(Edges.of_places(places), Edges.of_line(way), 1e-6).proven == 2
    between = stray(
        Edges.of_line(way), Edges.of_places(places), 1e-6
    )  # where 0 is as far as 10 + 2j: x = 5.2
    assert between.proven == pytest.approx(5.2, abs=1e-6)
    assert (
        stray(
            Edges.of_line(np.array([3 + 4j, 3 + 4j])), Edges.of_places(np.array([0j])), 1e-6
        ).proven
        == 5
    )


@pytest.mark.long
@settings(max_examples=150, deadline=None)
@given(
    st.lists(COORDINATES, min_size=2, max_size=9),
    st.lists(COORDINATES, min_size=2, max_size=9),
    st.floats(1e-4, 1),
)
def test_no_place_of_a_line_is_farther_than_what_is_proven(
    a: list[complex], b: list[complex], resolution: float
) -> None:
    found = stray(Edges.of_line(np.array(a)), Edges.of_line(np.array(b)), resolution)
    places = np.concatenate(
        [p + (q - p) * np.linspace(0, 1, 200) for p, q in zip(a, a[1:], strict=False)]
    )
    away = shapely.distance(shapely.points(places.real, places.imag), line(b))
    step = max(abs(q - p) for p, q in zip(a, a[1:], strict=False)) / 199
    assert away.max() <= found.proven + 1e-9 <= away.max() + step / 2 + resolution + 2e-9
    assert found.farthest == pytest.approx(
        float(line(b).distance(shapely.Point(found.place.real, found.place.imag))), abs=1e-9
    )
    assert (
        line(a).distance(shapely.Point(found.place.real, found.place.imag)) < 1e-9
        and found.proven <= found.farthest + resolution
    )
