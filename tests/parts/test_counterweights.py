"""Counterweights: moments in closed form against those of the areas that are made, and pins that do not fit."""

from __future__ import annotations

import cmath
import math
from dataclasses import replace

import pytest

from camgen.errors import DesignError
from camgen.geometry.outlines import circle
from camgen.parts.counterweights import Sector, counterweight
from camgen.parts.inertia import centre_of
from camgen.parts.part import Layer, Part, Region

# g/mm^3
PLA = 1.24e-3
STEEL = 7.85e-3
HUB = Sector(hub=8.0, thickness=4.0, half=math.pi / 2, heavy=PLA)
PINNED = replace(HUB, pins=3, pin=5.0, steel=STEEL, wall=1.0)


def moment(part: Part, heavy: float) -> complex:
    """First moment about the origin by polygons along the outline, complex g mm."""
    return heavy * part.volume * centre_of(part)


@pytest.mark.parametrize("wanted", [143.8 * cmath.exp(-0.8j), 3.0j, 0.0])
@pytest.mark.parametrize(
    "asked", [HUB, replace(HUB, half=math.radians(35)), replace(HUB, half=math.radians(130))]
)
def test_the_body_has_the_moment_that_is_asked(asked: Sector, wanted: complex) -> None:
    part, pins, rim = counterweight(asked, circle(0j, 3.0), wanted, "printed", 0.8, "")
    assert not pins and moment(part, PLA) == pytest.approx(wanted, abs=2e-3 * abs(wanted) + 1e-9)
    assert (
        rim >= asked.hub + 1 or not wanted
    )  # what stands out by less is not printed well: narrower instead


def test_a_half_disc_has_its_centroid_where_the_tables_say() -> None:
    """4 R / (3 pi) from the middle of its straight side [Beer, Johnston: Vector Mechanics, centroids of common shapes]."""
    sector = replace(HUB, hub=0.0)
    assert sector.moment(20.0) == pytest.approx(
        PLA * 4 * (math.pi * 20**2 / 2) * (4 * 20 / (3 * math.pi))
    )
    assert sector.rim(sector.moment(20.0)) == pytest.approx(20.0)


def test_pins_count_as_steel_in_their_holes() -> None:
    part, pins, rim = counterweight(PINNED, circle(0j, 3.0), 200.0 + 0j, "printed", 0.8, "")
    assert len(pins) == 3 and rim < HUB.rim(200.0)
    found = moment(part, PLA) + sum(STEEL * pin.volume * place for pin, place in pins)
    assert found == pytest.approx(200.0, rel=2e-3)
    edge = max(abs(place) for _, place in pins) + 2.5
    assert rim - edge == pytest.approx(1.0)
    apart = [abs(a - b) for (_, a), (_, b) in zip(pins, pins[1:], strict=False)]
    assert apart == pytest.approx([6.0, 6.0])


def test_pins_that_weigh_too_much_are_refused() -> None:
    with pytest.raises(DesignError, match="fewer or thinner pins"):
        counterweight(replace(PINNED, pins=8), circle(0j, 3.0), 20.0 + 0j, "printed", 0.8, "")


def test_a_hub_alone_is_a_disc() -> None:
    part, _, _ = counterweight(HUB, circle(0j, 3.0), 0j, "printed", 0.8, "")
    disc = Part("disc", "", (Layer(Region(circle(0j, 8.0), (circle(0j, 3.0),)), 0.0, 4.0),))
    assert part.volume == pytest.approx(disc.volume)
