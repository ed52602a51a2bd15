"""Spur gears: outlines against the law of gearing, worked out from the facets of both wheels without involutes."""

from __future__ import annotations

import math

import numpy as np
import pytest

from camgen.geometry.facets import facet_contour
from camgen.geometry.outlines import Region
from camgen.parts.gears import Spur, pair


def test_sizes_are_those_of_the_standard() -> None:
    """Norton, table 9-1: addendum 1, dedendum 1.25 of the module; half the circular pitch is a tooth."""
    wheel = Spur(20, 2.0, 0.0)
    rim = np.abs(facet_contour(wheel.outline(), 1e-3))
    assert (rim.min(), rim.max()) == (pytest.approx(17.5, abs=1e-3), pytest.approx(22.0, abs=1e-3))
    assert wheel.thickness == pytest.approx(math.pi)
    assert 0.98 < Region(wheel.outline()).area / (math.pi * 19.9**2) < 1.0


@pytest.mark.parametrize("ratio", [-1.0, -0.5, -3.0])
def test_flanks_stay_in_touch_at_the_ratio(ratio: float) -> None:
    """Turned at the ratio two wheels without backlash neither overlap nor part: by polygons of their outlines."""
    import shapely
    from shapely.affinity import rotate, translate

    a, b = pair(60.0, ratio, 0.0, 0.5, None, "gear")
    first, second = (
        shapely.Polygon([(z.real, z.imag) for z in facet_contour(w.outline(), 1e-4)])
        for w in (a, b)
    )
    second = translate(rotate(second, 180 + 180 / b.teeth, origin=(0, 0)), 60, 0)
    for turn in np.linspace(0, 360 / a.teeth, 7):
        one = rotate(first, turn, origin=(0, 0))
        for nudge, touching in ((0.0, False), (0.05, True), (-0.05, True)):
            other = rotate(second, ratio * turn + nudge, origin=(60, 0))
            overlap = one.intersection(other).buffer(-3e-4)
            assert overlap.is_empty is not touching


def test_backlash_is_the_free_way_along_the_pitch_circle() -> None:
    a, b = pair(60.0, -2.0, 0.2, 0.5, None, "gear")
    assert a.thickness + b.thickness == pytest.approx(math.pi * a.module - 0.2)
    assert (a.teeth, b.pitch + a.pitch) == (2 * b.teeth, pytest.approx(60.0))
