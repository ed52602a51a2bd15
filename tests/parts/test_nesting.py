"""Nesting: the gap is kept, nothing leaves the sheet, sheets are filled well, and the same each time."""

import numpy as np
import pytest
import shapely

from camgen.geometry.facets import facet_circle
from camgen.parts.nesting import nest


def placed(ring, spot):
    z = ring * np.exp(1j * spot.angle) + spot.place
    return shapely.Polygon(np.column_stack([z.real, z.imag]))


def bars(count):
    """Flat bars and angles, of sizes that are the same each time."""
    rings = []
    for k in range(count):
        a, b = 20 + 7 * (k % 5), 5 + 3 * (k % 3)
        angle = [0, a, a + 1j * b, b + 1j * b, b + 1j * a, 1j * a]
        rings.append(np.array(angle if k % 2 else [0, a, a + 1j * b, 1j * b], complex) - (3 + 2j))
    return rings


@pytest.mark.long
def test_gap_edge_and_density():
    rings, sheet, gap = bars(40), (150.0, 120.0), 2.0
    spots = nest(rings, sheet, gap)
    assert None not in spots
    area = used = 0.0
    for number in range(1 + max(spot.sheet for spot in spots)):
        here = [
            placed(ring, spot)
            for ring, spot in zip(rings, spots, strict=True)
            if spot.sheet == number
        ]
        apart = shapely.STRtree(here).query_nearest(
            here, exclusive=True, all_matches=False, return_distance=True
        )[1]
        boxes = shapely.bounds(here)
        assert apart.min() >= gap and boxes[:, :2].min() >= gap / 2
        assert boxes[:, 2].max() <= sheet[0] - gap / 2 and boxes[:, 3].max() <= sheet[1] - gap / 2
        area += sum(polygon.area for polygon in here)
        used += sheet[1] * (
            boxes[:, 2].max() if number == max(spot.sheet for spot in spots) else sheet[0]
        )
    boxes = sum((np.ptp(ring.real) + gap) * (np.ptp(ring.imag) + gap) for ring in rings)
    assert area < used < boxes  # better than boxes could lie without any loss
    assert spots == nest(rings, sheet, gap)


def test_a_triangle_lies_in_the_angle_of_another():
    """Two right triangles make a square: so turned, they need not much more than one's box."""
    triangle = np.array([0, 60, 60j], complex)
    spots = nest([triangle, triangle], (200.0, 70.0), 1.0)
    ends = [placed(triangle, spot).bounds[2] for spot in spots]
    assert max(ends) < 75 and spots[0].angle != spots[1].angle


@pytest.mark.parametrize("sheet", [(30.0, 200.0), (200.0, 30.0)])
def test_what_fits_on_no_sheet_is_told_and_the_rest_lies(sheet):
    disc, bar = facet_circle(0j, 20, 0.01), np.array([0, 100, 100 + 10j, 10j])
    spots = nest([disc, bar, bar], sheet, 1.0)
    assert spots[0] is None and spots[1] is not None and spots[1].sheet == spots[2].sheet == 0


def test_one_sheet_more_where_one_is_full():
    disc = facet_circle(0j, 20, 0.01)
    assert [spot.sheet for spot in nest([disc] * 5, (100.0, 50.0), 2.0)] == [0, 0, 1, 1, 2]
