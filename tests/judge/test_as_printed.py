"""Rings moved as print moves them: against shapely's mitred buffers, discs about polygons and circles of facets."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapes import polygon, rounded

from camgen.geometry.rings import Ring, Shape
from camgen.judge.as_printed import grown, printed

SQUARE = np.array([0, 10, 10 + 10j, 10j])
CONVEX = st.lists(st.floats(0.7, 1.6), min_size=3, max_size=6).filter(
    lambda steps: sum(steps) < 5.5
)


def area(points: np.ndarray) -> shapely.Polygon:
    return shapely.Polygon(np.column_stack([points.real, points.imag]))


def on_a_circle(steps: list[float], radius: float = 20.0) -> np.ndarray:
    """A convex polygon whose corners follow each other by these angles."""
    return radius * np.exp(1j * np.cumsum([0.0, *steps]))


@settings(max_examples=50)
@given(
    steps=CONVEX,
    dent=st.floats(0.3, 0.8),
    distance=st.floats(-1.5, 1.5).filter(lambda d: abs(d) > 1e-3),
)
def test_corners_stay_sharp(steps: list[float], dent: float, distance: float) -> None:
    """Polygons whose corners all turn by more than facets do, one of them hollow: the mitred buffer."""
    corners = on_a_circle(steps)
    hollow = np.insert(
        corners, 1, dent * abs(corners[0] + corners[1]) / 2 * np.exp(0.5j * steps[0])
    )
    for points in (corners, hollow):
        turns = np.angle((np.roll(points, -1) - points) / (points - np.roll(points, 1)))
        if np.min(np.abs(turns)) < 0.65 or np.max(np.abs(turns)) > 2.6:
            continue
        moved = area(grown(polygon(points), distance).points)
        wanted = area(points).buffer(distance, join_style="mitre", mitre_limit=50)
        assert shapely.hausdorff_distance(moved, wanted) < 1e-9


@settings(max_examples=50)
@given(steps=CONVEX, radius=st.floats(0.5, 6), distance=st.floats(-5, 5))
def test_arcs_stay_arcs_about_their_centres(
    steps: list[float], radius: float, distance: float
) -> None:
    """What a disc covers that goes round a polygon, moved, is what a smaller or a larger disc covers."""
    corners = on_a_circle(steps)
    larger = max(radius + distance, 0.01)
    made, wanted = grown(rounded(corners, radius), larger - radius), rounded(corners, larger)
    np.testing.assert_allclose(made.points, wanted.points, atol=1e-9)
    np.testing.assert_allclose(made.bulges, wanted.bulges, atol=1e-9)


@pytest.mark.parametrize("count", [12, 60, 400])
@pytest.mark.parametrize("distance", [-0.3, 0.3])
@pytest.mark.parametrize("hollow", [False, True])
def test_facets_of_a_circle_follow_it(count: int, distance: float, hollow: bool) -> None:
    """Moved to the side on which their corners close, vertices go along the circle's normal; on the other, where edges meet."""
    points = 8 * np.exp(2j * np.pi * np.arange(count) / count)
    if not hollow:
        made, towards = grown(polygon(points), distance).points, distance
    else:  # a wide frame about the same circle, run so that the material is on the left
        made, towards = grown(polygon(points[::-1]), distance).points[::-1], -distance
    radius = 8 + towards if distance < 0 else 8 + towards / math.cos(math.pi / count)
    if hollow:
        radius = 8 + towards if distance > 0 else 8 + towards / math.cos(math.pi / count)
    np.testing.assert_allclose(made, points * radius / 8, atol=1e-9)


@pytest.mark.parametrize("distance", [-0.3, 0.3])
@pytest.mark.parametrize("start", range(5))
def test_facets_that_end_in_an_arc_go_on_in_it(distance: float, start: int) -> None:
    """A disc whose one half is an arc, the other facets: moved, all of its vertices lie on the larger or smaller circle, but for
    what the corners of facets stand out; the arc is an arc of it."""
    half = np.exp(1j * np.linspace(0, math.pi, 30))
    ring = Ring(np.roll(8 * half, start), np.roll(np.append(np.zeros(29), 1.0), start))
    made = grown(ring, distance)
    away = np.abs(made.points) - 8 - distance
    stands_out = abs(distance) * (1 / math.cos(math.pi / 58) - 1)
    assert -1e-3 * abs(distance) <= np.min(away) and np.max(away) <= stands_out + 1e-3 * abs(
        distance
    )
    (arc,) = np.flatnonzero(made.bulges)
    ends = made.points[[arc, (arc + 1) % 30]]
    assert (
        np.max(np.abs(np.sort(ends.real) - [-8 - distance, 8 + distance])) < 2e-3
        and np.max(np.abs(ends.imag)) < 0.02
    )


@pytest.mark.parametrize("distance", [-0.3, 0.3])
@pytest.mark.parametrize("turned_over", [False, True])
def test_a_curve_of_an_arc_and_three_facets_keeps_its_corner(
    distance: float, turned_over: bool
) -> None:
    """A disc less a segment, whose circle goes on in facets of 6 deg beside one of its corners: the corner goes to where the
    larger circle meets the moved chord, as it does at its other end, an arc's."""
    angles = np.radians([-50, 212, 218, 224, 230])  # both ends 50 deg beside the lowest place
    points, bulges = (
        10 * np.exp(1j * angles),
        np.append(math.tan(math.radians(262) / 4), np.zeros(4)),
    )
    ring = Ring(points, bulges).moved(-1, mirror=True) if turned_over else Ring(points, bulges)
    low, wide = (
        points[0].imag - distance,
        math.sqrt((10 + distance) ** 2 - (points[0].imag - distance) ** 2),
    )
    made = grown(ring, distance).points
    for corner in (complex(wide, low), complex(-wide, low)):
        assert np.min(np.abs(made - corner)) < 0.015 * abs(distance)


@pytest.mark.parametrize("distance", [-0.3, 0.3])
def test_edges_between_arcs_are_no_facets(distance: float) -> None:
    """A D of edges and small arcs that follow each other, with two sharp corners: each moved square to itself, exactly."""
    corners = 12 * np.exp(1j * np.linspace(0.6, math.tau - 0.6, 15))

    def shape(radius: float) -> Ring:
        whole = rounded(corners, radius)
        before, after = whole.points[::2] - corners, whole.points[1::2] - corners
        mitres = corners + (before + after) / (1 + np.real(np.conj(before) * after) / radius**2)
        ends = np.append(mitres[0], np.append(whole.points[2:-2], mitres[-1]))
        return Ring(ends, np.append(0.0, np.append(whole.bulges[2:-2], 0.0)))

    made, wanted = grown(shape(2.0), distance), shape(2.0 + distance)
    np.testing.assert_allclose(made.points, wanted.points, atol=1e-9)
    np.testing.assert_allclose(made.bulges, wanted.bulges, atol=1e-9)


@pytest.mark.parametrize("facets", [1, 2, 7])
@pytest.mark.parametrize("start", range(4))
def test_the_arc_round_a_corner_becomes_the_corner_again(facets: int, start: int) -> None:
    """A disc round a polygon, as arcs or as facets about them, moved in by its radius, wherever its ring begins."""
    corners, radius = on_a_circle([1.1, 1.4, 1.6]), 0.4
    arcs = rounded(corners, radius)
    if facets > 1:
        sweep = 4 * np.arctan(arcs.bulges[::2])[:, None]
        begins = arcs.points[::2][:, None] - corners[:, None]
        steps = np.arange(facets + 1) / facets
        arcs = polygon((corners[:, None] + begins * np.exp(1j * sweep * steps)).ravel())
    ring = Ring(np.roll(arcs.points, start), np.roll(arcs.bulges, start))
    made = grown(ring, -radius)
    assert not made.bulges.any()
    near = np.abs(made.points[:, None] - corners)
    # facets lie within the arc by the sagitta of a chord, and so do the corners
    sharpest = float(np.max(4 * np.arctan(rounded(corners, radius).bulges)))
    limit = 1e-9 if facets == 1 else 2 * radius * (1 - math.cos(sharpest / facets / 2))
    assert max(np.max(np.min(near, axis=0)), np.max(np.min(near, axis=1))) < limit


def test_where_a_ring_begins_says_nothing() -> None:
    """Corners rounded by more or less than what is taken off, of facets and of arcs: the same points, from any start."""
    corners = on_a_circle([1.1, 1.4, 1.6])
    facetted, chipped = (
        rounded(corners, 0.4).facetted(0.002),
        np.append(SQUARE, [0.2j, 0.05 + 0.05j]),
    )
    for ring in (rounded(corners, 0.3), polygon(facetted), polygon(chipped)):
        wanted = grown(ring, -0.45)
        for start in range(1, len(ring.points)):
            made = grown(Ring(np.roll(ring.points, start), np.roll(ring.bulges, start)), -0.45)
            assert len(made.points) == len(wanted.points)
            shift = int(np.argmin(np.abs(made.points - wanted.points[0])))
            np.testing.assert_allclose(np.roll(made.points, -shift), wanted.points, atol=1e-12)


@pytest.mark.parametrize("step", [1e-1, 1e-4])
@pytest.mark.parametrize("distance", [-0.3, 0.3])
def test_a_step_between_two_walls_keeps_its_height(step: float, distance: float) -> None:
    """One of its corners is hollow, so that what either gains the other loses, however small it is."""
    walls = np.array([0, 10, 10 + 10j, 5 + 10j, 5 + 1j * (10 + step), 1j * (10 + step)])
    made = grown(polygon(walls), distance).points
    outward = np.array([-1 - 1j, 1 - 1j, 1 + 1j, 1 + 1j, 1 + 1j, -1 + 1j])
    np.testing.assert_allclose(made, walls + distance * outward, atol=1e-12)


@pytest.mark.parametrize("distance", [0.1, 0.8])
def test_a_lens_of_facets_keeps_its_tips(distance: float) -> None:
    """Two arcs of radius 4 that meet at right angles: the tips go to where circles larger by the distance meet."""
    half = 4 * math.sqrt(0.5)
    right = -half + 4 * np.exp(1j * np.linspace(-math.pi / 4, math.pi / 4, 401))
    made = grown(polygon(np.append(right[:-1], -right[:-1])), distance).points
    tip = math.sqrt((4 + distance) ** 2 - half**2)
    for wanted in (tip * 1j, -tip * 1j):
        assert np.min(np.abs(made - wanted)) < 1e-6 * distance


@pytest.mark.parametrize("turns", [(0.1, 0.04), (0.04, 0.1)])
@pytest.mark.parametrize("before", [True, False])
@pytest.mark.parametrize("distance", [-0.3, 0.3])
def test_edges_whose_bends_differ_are_no_curve(
    turns: tuple[float, float], before: bool, distance: float
) -> None:
    """Of three edges of 10 mm from a square corner on, the second turns by two and a half times what the third does, or it by the
    second: the corner stays square."""
    ways = np.append(0, np.cumsum(turns))
    walls = np.append(0, np.cumsum(10 * np.exp(1j * ways)))
    ring = np.append(walls, [30 + 30j, 30j])
    if before:  # the same, seen in a mirror
        ring = np.roll((1j * np.conj(ring))[::-1], 1)
    corner = grown(polygon(ring), distance).points[0]
    assert corner == pytest.approx(distance * (-1 - 1j), abs=1e-12)


def test_what_print_closes_is_refused() -> None:
    """A strip 1 mm wide from either side of which 0.6 mm are lost; a disc smaller than what it loses."""
    strip = polygon(np.array([0, 9, 9 + 1j, 1j]))
    assert grown(strip, -0.4).area == pytest.approx(8.2 * 0.2)
    for ring in (strip, Ring(np.array([0.5, -0.5 + 0j]), np.ones(2))):
        with pytest.raises(ValueError, match=r"nothing is left of a ring moved by -0\.6 mm"):
            grown(ring, -0.6)


def test_a_part_prints_smaller_with_smaller_holes() -> None:
    """Shrunk about its origin first, then each outline moved by its own."""
    square, hole = polygon(SQUARE + 20), polygon((SQUARE * 0.2 + 24 + 4j)[::-1])
    made = printed(Shape(square, (hole,)), hole=0.1, profile=0.25, shrinkage=0.01)
    assert made.outer.box == pytest.approx((19.8 - 0.25, -0.25, 29.7 + 0.25, 9.9 + 0.25))
    (left,) = made.holes
    assert left.box == pytest.approx(
        (24 * 0.99 + 0.1, 4 * 0.99 + 0.1, 26 * 0.99 - 0.1, 6 * 0.99 - 0.1)
    )
    assert grown(square, 0.0) is square
