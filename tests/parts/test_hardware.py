"""Machine parts: exact areas, walls that are named when they vanish, and fits between parts that belong together."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from camgen.errors import DesignError
from camgen.geometry.facets import facet_contour
from camgen.geometry.outlines import Contour, circle, polygon
from camgen.parts.catalogue import (
    BEARINGS,
    MOTOR_FACES,
    SCREW_LENGTHS,
    SCREWS,
    Bought,
    dowel,
    fastener,
    flange,
)
from camgen.parts.hardware import Collet, headed, plate, rounded, spacer
from camgen.parts.part import hull, root, with_bar
from camgen.parts.solids import solid

CORNER = 1 - math.pi / 4  # area that rounding a right angle with radius 1 takes


def shape(contour: Contour) -> shapely.Polygon:
    ring = facet_contour(contour, 1e-4)
    return shapely.Polygon(np.column_stack([ring.real, ring.imag]))


COLLET = Collet(8.0, 0.2, 2.4, 8.0, 3.0, 24.0, ((8.5 + 0j, 3.0), (-8.5 + 0j, 3.0)))


# ---- outlines --------------------------------------------------------------------------------------------------------


@given(st.floats(0.1, 4), st.floats(0.1, 4), st.floats(20, 40), st.floats(20, 40))
def test_rounded_corners_and_fillet_of_an_angle(r: float, f: float, a: float, b: float) -> None:
    # an L of two bars 9 wide: five round corners take area, the fillet adds some
    corners = [(0, 0), (a, 0), (a, 9), (9, 9), (9, b), (0, b)]
    lean = [(1, 1), (-1, 1), (-1, -1), (1, 1), (-1, -1), (1, -1)]
    radii = [r, r, r, -f, r, r]
    discs = [
        (complex(x + dx * abs(q), y + dy * abs(q)), q)
        for (x, y), (dx, dy), q in zip(corners, lean, radii, strict=True)
    ]
    made = rounded(discs)
    assert made.area == pytest.approx(9 * a + 9 * (b - 9) - CORNER * (5 * r * r - f * f), rel=1e-12)
    assert made.length == pytest.approx(2 * a + 2 * b - (2 - math.pi / 2) * (5 * r + f), rel=1e-12)


def test_rounded_with_sharp_corners_is_the_polygon() -> None:
    places = [0j, 5 + 0j, 5 + 2j, 1 + 3j]
    assert rounded([(z, 0.0) for z in places]).area == pytest.approx(
        polygon(places).area, rel=1e-14
    )
    with pytest.raises(ValueError, match="no tangent"):
        rounded([(0j, 5.0), (1 + 0j, 1.0), (20 + 0j, 1.0)])


def test_plate_with_an_edge_that_crosses_itself() -> None:
    with pytest.raises(DesignError, match="the edge of the cam crosses itself"):
        plate("cam", polygon([0j, 10 + 10j, 10 + 0j, 12j]), {}, 1.0)


def test_plate_names_what_meets_what() -> None:
    rim = circle(0j, 20)
    holes = {"bore": circle(0j, 5), "pin": circle(10 + 0j, 2), "slot": circle(-14 + 0j, 4)}
    assert plate("cam", rim, holes, 1.9).area == pytest.approx(
        math.pi * (400 - 25 - 4 - 16), rel=1e-12
    )
    for changed, names in (
        ({"pin": circle(6 + 0j, 2)}, "between bore and pin"),
        ({"slot": circle(-18 + 0j, 4)}, "between edge and slot"),
        ({"slot": circle(-14 + 0j, 4.5)}, "between edge and slot"),
        ({"slot": circle(-40 + 0j, 4)}, "between edge and slot"),
    ):
        with pytest.raises(DesignError, match="wall of the cam") as caught:
            plate("cam", rim, holes | changed, 1.9)
        assert caught.value.where == names
        assert caught.value.value < caught.value.limit == 1.9


# ---- shaft -----------------------------------------------------------------------------------------------------------


@pytest.mark.long
def test_collet_and_ring_belong_together() -> None:
    sleeve, ring = COLLET.sleeve(0.8), COLLET.ring()
    radii = [
        np.max(np.abs(facet_contour(layer.region.outer, 1e-4))) for layer in sleeve.layers[1::4]
    ]
    bores = [math.sqrt(layer.region.holes[0].area / math.pi) for layer in ring.layers]
    assert np.allclose(-np.diff(radii), 0.05) and np.allclose(-np.diff(bores), 0.05)
    first = round(COLLET.travel / (COLLET.length / COLLET.steps))
    assert bores == pytest.approx(radii[first:])  # touches all round with the travel left to go
    closing = 2 * (radii[0] - bores[0])
    assert closing == pytest.approx(COLLET.travel / 10) and closing >= 1.5 * COLLET.fit - 1e-12
    assert radii[-1] == pytest.approx(4.1 + 2.4)
    for part in (sleeve, ring):
        assert solid(part, 0.001).volume == pytest.approx(part.volume, rel=1e-3)


def test_collet_fingers_are_the_ring_less_the_slits() -> None:
    sleeve = COLLET.sleeve(0.8)
    fingers = [shape(layer.region.outer) for layer in sleeve.layers[1:5]]
    cross = shapely.box(-20, -0.5, 20, 0.5) | shapely.box(-0.5, -20, 0.5, 20)
    outer, inner = shape(circle(0j, 6.85)), shape(circle(0j, 4.1))
    assert shapely.union_all(fingers).symmetric_difference(outer - inner - cross).area < 0.01
    assert all(a.distance(b) > 0.99 for a, b in pairwise(fingers))


@pytest.mark.parametrize(
    "changes, said",
    [
        ({"flange_diameter": 15.0, "pins": ()}, "flange of the collet"),
        ({"pins": ((7.5 + 0j, 3.0),)}, "gap beside the collet's sleeve"),
        ({"pins": ((11.5 + 0j, 3.0),)}, "wall of the collet's flange"),
        ({"slits": 24}, "finger of the collet"),
        ({"wall": 0.5}, "wall of the collet"),
    ],
)
def test_collet_refuses(changes: dict[str, float], said: str) -> None:
    with pytest.raises(DesignError, match=said):
        replace(COLLET, **changes).sleeve(0.8)  # type: ignore[arg-type]


def test_ring_that_would_pass_over_the_sleeve() -> None:
    with pytest.raises(DesignError, match="travel of the clamp ring"):
        replace(COLLET, fit=0.6).ring()


def test_headed_pin_and_spacer() -> None:
    made = headed("axle", "Axle", 6.0, 19.0, 12.0, 2.0)
    assert made.volume == pytest.approx(math.pi * (36 * 2 + 9 * 19)) and made.thickness == 21
    with pytest.raises(DesignError, match="head of axle"):
        headed("axle", "Axle", 6.0, 19.0, 6.0, 2.0)
    washer = spacer("spacer", "Spacer", 8.0, 24.0, 0.4, 0.8)
    assert washer.volume == pytest.approx(0.4 * math.pi * (144 - 16))
    with pytest.raises(DesignError, match="between edge and bore"):
        spacer("spacer", "Spacer", 8.0, 9.5, 0.4, 0.8)


# ---- standards -------------------------------------------------------------------------------------------------------

# Bolt circle, mm (in where marked): piclist.com/techref/io/stepper/nemasizes.htm, a column of its own there.
BOLT_CIRCLES = {
    "nema-8": 22.6,
    "nema-11": 32.5,
    "nema-14": 36.8,
    "nema-17": 1.725 * 25.4,
    "nema-23": 2.625 * 25.4,
}


def test_motor_faces_agree_with_their_bolt_circles() -> None:
    assert {*BOLT_CIRCLES, "28byj-48"} == set(MOTOR_FACES)  # which has two ears: see test_bought
    for name, face in ((each, MOTOR_FACES[each]) for each in BOLT_CIRCLES):
        assert 2 * abs(face.screws[0]) == pytest.approx(BOLT_CIRCLES[name], abs=0.05)
        assert abs(sum(face.screws)) < 1e-12
        assert (
            face.boss / 2 + face.screw.clearance / 2
            < abs(face.screws[0])
            < face.half * math.sqrt(2)
        )
        assert face.shaft < face.boss


def test_screws_and_bearings_are_plausible() -> None:
    for thread, screw in SCREWS.items():
        nominal = float(thread[1:])
        assert 1.09 * nominal <= screw.clearance <= 1.21 * nominal
        assert (
            screw.clearance + 1 < screw.head <= 2 * nominal
            and 0.5 * nominal <= screw.height <= nominal
        )
    for name, bearing in BEARINGS.items():
        # the last figure of 6xx is the bore; MRxyz: outside xy (or x), bore z
        series = bearing.bore == float(name[-1]) and (
            name[:2] != "MR" or bearing.outside == float(name[2:-1])
        )
        assert series and bearing.bore < bearing.outside and bearing.width < bearing.outside


def test_lengths_that_are_sold() -> None:
    assert SCREWS["M3"].length(2.15) == 6  # 3.85 of the 4.5 mm that a NEMA 17 motor has
    assert SCREWS["M2"].length(0.5) == 0
    for through in np.linspace(1, 97, 200):  # one table of lengths, whoever asks
        assert fastener("screw", "M3", through, 1).size == f"M3 x {SCREWS['M3'].through(through):g}"
    assert fastener("screw", "M3", 99, 2) == Bought(
        "screw", "DIN 976-1", "M3 x 104", 2
    ) and 99 + 2.4 > max(SCREW_LENGTHS)
    assert (
        dowel(6.0, 12.2) == 12
        and dowel(6.0, 11.9) == 0
        and dowel(3.0, 13.9) == 12
        and dowel(3.3, 50) == 0
    )
    for thread, screw in SCREWS.items():
        assert (
            1.5 * screw.nominal < screw.flats <= 2 * screw.nominal
            and 0.75 * screw.nominal < screw.nut < screw.nominal
        ), thread


def test_plain_flange() -> None:
    plain = flange(30.0, 50.0, 3, "M4")
    assert np.allclose(np.abs(plain.screws), 25) and abs(sum(plain.screws)) < 1e-12


@pytest.mark.parametrize(("pointed", "end"), [(False, math.pi / 2), (True, 0.0)])
def test_a_bar_out_of_a_band(pointed: bool, end: float) -> None:
    """Areas by hand: the band, and what of the bar lies outside of it; its end half a disc, or a triangle of the same length."""
    band = hull([(-10 + 0j, 5), (10 + 0j, 5)])
    both = with_bar(band, 0j, 1j, 2.0, 20.0, pointed)
    more = 4 * (15 - 4) + 4 * 4 / 2 if pointed else 4 * 15 + 4 * end
    assert both.area == pytest.approx(band.area + more, rel=1e-12)
    turned = with_bar(band.moved(1j), 0j, -1, 2.0, 20.0, pointed)
    assert turned.area == pytest.approx(both.area, rel=1e-12)


@pytest.mark.parametrize("way", [1, 1j, -1, np.exp(0.3j)])
def test_a_bar_out_of_a_disc(way: complex) -> None:
    """Its one arc begins within the bar or beside it: areas by hand, a disc of 5 and what a bar of 6 adds to it."""
    segment = 25 * math.asin(3 / 5) - 3 * 4
    made = with_bar(circle(0j, 5), 0j, way, 3.0, 20.0)
    beyond = 6 * (20 - 4) + 9 * math.pi / 2 - segment
    assert made.area == pytest.approx(25 * math.pi + beyond, rel=1e-12) and shape(made).is_valid


@pytest.mark.parametrize("lean", [0.1, 0.2, 0.7, 1.5])
def test_a_bar_out_of_a_slanting_band(lean: float) -> None:
    """It comes out of a thin band before its middle at one side: by hand, where the side meets the band's lower tangent."""
    way = np.exp(1j * lean)
    band, half = hull([(-100 * way, 3), (100 * way, 3)]), 4.0
    before = (3 / math.cos(lean) - half) / math.tan(lean)
    assert root(band, 0j, 1 + 0j, half) == pytest.approx(before, rel=1e-12)
    made = shape(with_bar(band, 0j, 1 + 0j, half, 150.0))
    bar = shapely.box(before, -half, 150.0, half).union(shapely.Point(150, 0).buffer(half, 256))
    beside = shape(polygon([0j, -100 * way, -100 - 100j, 300 - 100j, 300 + 0j, 100 * way]))
    meant = shape(band).union(bar.intersection(beside))
    assert made.is_valid and made.symmetric_difference(meant).area < 0.1


@pytest.mark.parametrize(
    ("half", "length", "told"), [(6, 30.0, "no edge as wide"), (2, 4.0, "reaches further")]
)
def test_a_bar_wider_or_shorter_than_its_band_is_none(
    half: float, length: float, told: str
) -> None:
    with pytest.raises(ValueError, match=told):
        with_bar(hull([(-10 + 0j, 5), (10 + 0j, 5)]), 0j, 1 + 0j, half, length)
