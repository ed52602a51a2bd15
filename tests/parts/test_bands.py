"""Bands of links with two hubs: their edge and the chords of their middle line against shapely."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from camgen.errors import DesignError
from camgen.geometry.facets import facet_contour
from camgen.parts.bands import ArmBand

# 50 mm apart
A = 10 + 5j
B = 40 + 45j


def flat(points: list[complex] | np.ndarray) -> np.ndarray:
    return np.column_stack([np.real(points), np.imag(points)])


def by_buffers(band: ArmBand) -> shapely.Geometry:
    """Hubs, and the arc through both centres and the bow's point as a line of 4,000 corners, buffered."""
    middle = np.array([A, B])
    if band.bow:
        top = (A + B) / 2 + band.bow * 1j * (B - A) / abs(B - A)
        line = np.array([[(top - A).real, (top - A).imag], [(B - A).real, (B - A).imag]])
        right = (np.abs([top, B]) ** 2 - abs(A) ** 2) / 2
        centre = complex(*np.linalg.solve(line, right))
        sweep = np.angle((top - centre) / (A - centre)) + np.angle((B - centre) / (top - centre))
        middle = centre + (A - centre) * np.exp(1j * sweep * np.linspace(0, 1, 4000))
    hubs = [
        shapely.Point(z.real, z.imag).buffer(r, quad_segs=1000)
        for z, r in zip((A, B), band.radii, strict=True)
    ]
    return shapely.union_all(
        [shapely.LineString(flat(middle)).buffer(band.width / 2, cap_style="flat"), *hubs]
    )


@pytest.mark.parametrize("bow", [0.0, 6.0, -6.0, 24.0, -25.0])
@pytest.mark.parametrize(
    ("width", "radii"), [(10.0, (5.0, 5.0)), (6.0, (5.0, 5.0)), (6.0, (4.0, 7.0))]
)
def test_edge_is_that_of_buffers(bow: float, width: float, radii: tuple[float, float]) -> None:
    band = ArmBand("arm", A, B, radii, width, bow)
    edge = shapely.Polygon(flat(facet_contour(band.outline(), 1e-4)))
    assert edge.is_valid and band.outline().area > 0
    assert shapely.symmetric_difference(edge, by_buffers(band)).area < 5e-4 * edge.length


@pytest.mark.parametrize("bow", [0.0, 3.0, -20.0])
def test_chords_with_their_sagitta_cover_the_band(bow: float) -> None:
    band = ArmBand("arm", A, B, (5.0, 5.0), 6.0, bow)
    chords = shapely.LineString(flat(band.middle())).buffer(
        band.width / 2 + band.sagitta, quad_segs=200
    )
    hubs = [shapely.Point(z.real, z.imag).buffer(5, quad_segs=200) for z in (A, B)]
    assert by_buffers(band).difference(shapely.union_all([chords, *hubs])).area < 0.01
    if bow:  # without the sagitta it is more than is covered
        bare = shapely.LineString(flat(band.middle())).buffer(band.width / 2, quad_segs=200)
        assert by_buffers(band).difference(shapely.union_all([bare, *hubs])).area > 0.1


@pytest.mark.parametrize(
    ("width", "bow", "said"),
    [
        (10.2, 0.0, "arm.width.*limit: at most 10 mm.*smaller hub"),
        (6.0, 26.0, "arm.bow.*limit: at most 25 mm.*half the distance"),
    ],
)
def test_what_is_no_band_is_told(width: float, bow: float, said: str) -> None:
    with pytest.raises(DesignError, match=said):
        ArmBand("arm", A, B, (5.0, 5.0), width, bow).outline()
