"""Spur gears: outlines against the law of gearing, worked out from the facets of both wheels without involutes."""

from __future__ import annotations

import math

import numpy as np
import pytest

from camgen.errors import DesignError
from camgen.geometry.facets import facet_contour
from camgen.geometry.outlines import Region
from camgen.parts.gears import GearWish, pair, table, windows
from camgen.parts.wheels.involute import BasicRack, Ring, Wheel
from camgen.parts.wheels.mesh import Sizes


def test_sizes_are_those_of_the_standard() -> None:
    """Norton, table 9-1: addendum 1, dedendum 1.25 of the module; half the circular pitch is a tooth."""
    wheel = Wheel(20, BasicRack(2.0))
    rim = np.abs(facet_contour(wheel.outline(), 1e-3))
    assert (rim.min(), rim.max()) == (pytest.approx(17.5, abs=1e-3), pytest.approx(22.0, abs=1e-3))
    assert 2 * wheel.half_angle(20.0) * 20 == pytest.approx(math.pi)
    assert 0.97 < Region(wheel.outline()).area / (math.pi * 19.9**2) < 1.0


@pytest.mark.parametrize("ratio", [-1.0, -0.5, -3.0])
def test_flanks_stay_in_touch_at_the_ratio(ratio: float) -> None:
    """Turned at the ratio two wheels without backlash neither overlap nor part: by polygons of their outlines."""
    import shapely
    from shapely.affinity import rotate, translate

    mesh = pair(60.0, ratio, 0.0, 0.5, GearWish(), "gear")
    a, b = mesh.a, mesh.b
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
    mesh = pair(60.0, -2.0, 0.2, 0.5, GearWish(), "gear")
    a, b = mesh.a, mesh.b
    teeth = (2 * each.half_angle(each.reference) * each.reference for each in (a, b))
    assert sum(teeth) == pytest.approx(math.pi * a.module - 0.2)
    assert (a.teeth, b.reference + a.reference) == (2 * b.teeth, pytest.approx(60.0))


@pytest.mark.parametrize(
    "wish",
    [
        GearWish(12, (0.4, 0.2)),
        GearWish(12, None),
        GearWish(12, (0.3, -0.3), relief=0.02),
        GearWish(None, (0.5, 0.0)),
    ],
)
def test_any_shifts_go_with_any_distance(wish: GearWish) -> None:
    """The module follows: the wheels' own involutes mesh at the distance that was asked for."""
    mesh = pair(60.0, -12 / 30, 0.1, 0.5, wish, "gear")
    assert mesh.distance == pytest.approx(60.0)
    assert mesh.contact_ratio > 1.05
    if wish.shifts is None:
        assert mesh.sliding[0] == pytest.approx(mesh.sliding[1], rel=0.01)
        assert mesh.a.shift + mesh.b.shift == 0
    assert (mesh.a.relief is None) is (wish.relief == 0)


def test_span_over_teeth_is_what_a_caliper_shows() -> None:
    """Parallel jaws about k teeth touch where their flanks are widest apart; 20 teeth: cos 20 deg (2.5 pi + 20 inv 20 deg)."""
    count, span = Wheel(20, BasicRack(1.0)).span
    assert (count, span) == (3, pytest.approx(7.6604, abs=5e-5))
    wheel = Wheel(25, BasicRack(2.0), 0.3, 0.05)
    count, span = wheel.span
    half = (count - 1) / 2
    points = facet_contour(wheel.outline(), 1e-4)
    turned = points * np.exp(-1j * half * wheel.pitch)
    angle = np.angle(turned)
    within = (np.abs(angle) < (half + 0.5) * wheel.pitch) & (np.abs(points) > wheel.form)
    assert np.ptp(turned[within].imag) == pytest.approx(span, abs=1e-3)


def test_windows_leave_spokes_rim_and_hub() -> None:
    wheel = Wheel(40, BasicRack(1.5))
    openings = windows(wheel, 5, 24.0, 4.0)
    assert len(openings) == 5
    rim = np.concatenate([facet_contour(each, 1e-3) for each in openings])
    assert np.abs(rim).min() == pytest.approx(12.0, abs=1e-2)
    assert np.abs(rim).max() == pytest.approx(wheel.root - 4.0, abs=1e-2)
    first, second = (facet_contour(each, 1e-3) for each in openings[:2])
    gap = np.abs(first[:, None] - second[None, :]).min()
    assert gap == pytest.approx(4.0, abs=0.1)
    pointed = windows(wheel, 8, 8.0, 4.0)[0]
    assert pointed.area > 0 and np.abs(facet_contour(pointed, 1e-3)).min() > 4.0
    assert windows(Wheel(12, BasicRack(1.0)), 5, 9.0, 4.0) == []


def test_a_workshop_reads_the_wheels_data() -> None:
    mesh = pair(43.099985989, -12 / 30, 0.08, 0.5, GearWish(12, (0.4, 0.2)), "gear")
    rows = table(mesh, mesh.b)
    assert rows[0] == "30 teeth, module 2, pressure angle 20 deg"
    assert "shift x +0.200, tip circle 64.600" in rows[1]
    assert (
        "mate 12 teeth at 43.100, working pressure angle 23.693 deg, contact ratio 1.33" in rows[3]
    )


@pytest.mark.parametrize("ratio", [12 / 30, 0.7, 20 / 29])
def test_a_pinion_in_its_ring_is_found_by_its_distance(ratio: float) -> None:
    """Whole teeth, the distance that was asked for, tips that pass each other, and roots that no tip reaches."""
    mesh = pair(20.0, ratio, 0.1, 0.5, GearWish(inner=True), "gear")
    assert isinstance(mesh.b, Ring)
    assert mesh.distance == pytest.approx(20.0)
    assert mesh.ratio == pytest.approx(ratio)
    assert mesh.contact_ratio >= 1.2 and mesh.inner_margin > 0 and mesh.tip_clearance > 0
    assert table(mesh, mesh.b)[0].startswith(f"{mesh.b.teeth} teeth inside, module")


def test_both_flanks_slide_alike_in_a_ring() -> None:
    mesh = pair(20.0, 14 / 35, 0.1, 0.5, GearWish(14, None, inner=True), "gear")
    assert mesh.a.shift == mesh.b.shift > 0
    assert mesh.sliding[0] == pytest.approx(mesh.sliding[1], rel=0.01)


@pytest.mark.parametrize(
    ("ratio", "wish", "words"),
    [
        (0.4, GearWish(12), "inner = true makes b a ring"),
        (2.5, GearWish(30, inner=True), "make a the pinion and b the ring"),
        (20 / 24, GearWish(20, inner=True), "leaves its gaps .* more than 4 teeth more"),
        (-0.5, GearWish(20, (0.0, -0.9)), "at least shift_a = 0.53, or at least shift_b = -0.53"),
    ],
)
def test_wheels_that_foul_are_refused_by_what_to_change(
    ratio: float, wish: GearWish, words: str
) -> None:
    with pytest.raises(DesignError, match=words):
        pair(60.0, ratio, 0.1, 0.5, wish, "gear")


def test_a_shift_that_is_advised_serves() -> None:
    """The least shift that the refusal of -0.9 names: made, and by polygons no tip cuts into a root."""
    mesh = pair(60.0, -0.5, 0.1, 0.5, GearWish(20, (0.0, -0.53)), "gear")
    assert max(mesh.fillet_overlaps) <= 1e-3


@pytest.mark.parametrize(("shifts", "cuts"), [((0.0, -0.9), True), ((0.53, -0.9), False)])
def test_tips_in_roots_are_seen_by_polygons_too(shifts: tuple[float, float], cuts: bool) -> None:
    """In the middle of their play, over a tooth: an area of overlap, or none."""
    import shapely
    from shapely.affinity import rotate, translate

    mesh = Sizes(BasicRack(2.0), 20, 40).mesh(*shifts)
    first, second = (
        shapely.Polygon([(z.real, z.imag) for z in facet_contour(w.outline(), 1e-4)])
        for w in (mesh.a, mesh.b)
    )
    second = translate(rotate(second, 180 + 180 / 40, origin=(0, 0)), mesh.distance, 0)
    areas = []
    for turn in np.linspace(0, 360 / 20, 13):
        one = rotate(first, turn, origin=(0, 0))
        other = rotate(second, -turn / 2, origin=(mesh.distance, 0))
        areas.append(one.intersection(other).buffer(-3e-4).area)
    assert (max(areas) > 1e-3) is cuts
    assert (max(mesh.fillet_overlaps) > 1e-3) is cuts
