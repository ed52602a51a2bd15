"""Bodies of slides for hubs that lie anyhow: a plate with stems that holds together, within the bands held apart from others."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from camgen.geometry.facets import facet_contour
from camgen.geometry.outlines import Contour
from camgen.machine.model import GROUND, Place, Slide
from camgen.machines.linkage.mechanism import Linkage
from camgen.parts.generator.guides import STEMS, Rails, Runner, Way, guide
from camgen.parts.part import hull
from camgen.reading import read
from camgen.spec import validate

PLACES = st.builds(complex, st.floats(-90, 90), st.floats(-90, 90))
HUBS = st.lists(st.tuples(PLACES, st.sampled_from([0.0, 3.0, 4.2, 9.0])), min_size=2, max_size=4)


def shape(contour: Contour) -> shapely.Polygon:
    ring = facet_contour(contour, 1e-3)
    return shapely.Polygon(np.column_stack([ring.real, ring.imag]))


@given(hubs=HUBS, stem=st.sampled_from(STEMS), angle=st.floats(-math.pi, math.pi))
def test_a_wing_with_stems_lies_within_its_bands(
    hubs: list[tuple[complex, float]], stem: str, angle: float
) -> None:
    """A knife's disc has no radius; others lie on either side of it. Each stem is as wide as the bar to its end."""
    hubs = [(0j, 4.2), *hubs]
    joint = Slide("bar", Place(GROUND, 1 + 2j), Place("bar", 0j), angle, 0.0)
    runner, way = Runner(hubs, False, 4.2), Way((-5.0, 20.0), (0.0, 0.0))
    made = guide(joint, runner, way, Rails(5.0, 0.3), stem)
    if not made.wing:
        return
    edge, bands = shape(made.outline), [shape(hull(band)) for band in made.bands]
    assert edge.is_valid and edge.buffer(0.02).covers(shape(hull(hubs)))
    assert shapely.union_all(bands).buffer(0.02).covers(edge)
    for _, end in made.stems:
        assert edge.buffer(0.02).covers(shapely.Point(end.real, end.imag).buffer(made.half))


@pytest.mark.parametrize("height", [1e-300, 10, 60])
def test_a_bar_that_slides_aslant_of_its_points_is_made(root: Any, height: float) -> None:
    """The line of its slide leans by 12 deg against the line of its own points, 121 mm apart."""
    data = read(root / "specs" / "stitch-head.toml")
    data["points"]["G2"] = [96.4, height]
    del data["include"]
    found = validate(Linkage, data).bodies.layout.guides["upper_bar"]
    assert found.wing and shape(found.outline).is_valid
