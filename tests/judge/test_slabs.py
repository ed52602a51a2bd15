"""Sections of bodies as areas, and how one body moves as another sees it: against closed forms and dense samples."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapes import polygon

from camgen.geometry.mesh import Mesh, slice_mesh
from camgen.geometry.outlines import Region, circle
from camgen.geometry.outlines import polygon as contour
from camgen.geometry.rings import Floats, Points, Ring
from camgen.judge.relative_motion import Motion
from camgen.judge.slabs import (
    Body,
    Course,
    Section,
    Slab,
    area_of,
    covered,
    disc_about,
    plan_of,
    sections_of,
    shadow_of,
    shrunk,
    slabs_of,
)
from camgen.parts.part import Layer, Part
from camgen.parts.solids import solid

# ---- areas -------------------------------------------------------------------------------------------------------------


def facets(centre: complex, radius: float, count: int) -> Ring:
    return polygon(centre + radius * np.exp(2j * np.pi * np.arange(count) / count))


@pytest.mark.parametrize("centre, radius", [(3 - 40j, 5.0), (0j, 0.8)])
def test_a_disc_is_told_by_its_facets(centre: complex, radius: float) -> None:
    """Their sagitta r (1 - cos(pi / n)) is at most 0.002 mm; a hole, a flat, a second area make it none."""
    count = math.ceil(math.pi / math.acos(1 - 0.002 / radius))
    found = disc_about(area_of([facets(centre, radius, count)]))
    assert found is not None and found == (
        pytest.approx(centre, abs=1e-12),
        pytest.approx(radius, abs=1e-12),
    )
    disc = area_of([facets(centre, radius, 2 * count)])
    for other in (
        area_of([facets(centre, radius, count - 3)]),
        disc.difference(shapely.Point(centre.real, centre.imag).buffer(0.1)),
        disc.difference(shapely.box(centre.real + radius * 0.99, -99, 99, 99)),
        shapely.union(disc, shapely.Point(99, 0).buffer(1)),
        shapely.Polygon(),
    ):
        assert disc_about(other) is None


def test_sections_stand_where_their_body_does() -> None:
    """Raised by z, shifted by `at`; a ring in a ring is a hole; arcs are off by what their facets are, straight edges not."""
    plate = Slab(
        1.0,
        3.0,
        (
            polygon(np.array([0, 8, 8 + 6j, 6j])),
            polygon(np.array([2 + 2j, 4 + 2j, 4 + 4j, 2 + 4j])),
        ),
    )
    round_bar = Slab(3.0, 7.0, (Ring(np.array([2, -2 + 0j]), np.ones(2)),))
    flat, disc = sections_of(Body("x", (plate, round_bar), z=10.0, at=100 + 50j))
    assert (flat.z0, flat.z1, disc.z0, disc.z1) == (11.0, 13.0, 13.0, 17.0)
    assert flat.area.bounds == (100, 50, 108, 56) and flat.area.area == pytest.approx(8 * 6 - 4)
    assert (flat.disc, flat.facets) == (None, 0.0)
    assert (
        disc.disc is not None
        and disc.disc[0] == pytest.approx(100 + 50j, abs=1e-9)
        and disc.facets == 0.001
    )
    assert 0 < 4 * math.pi - disc.area.area < 4 * math.pi * disc.facets
    assert shrunk(flat, 0.5).area == pytest.approx(
        7 * 5 - 9 + (1 - math.pi / 4), rel=1e-3
    )  # round about the hole's corners
    assert shrunk(flat, 0.0) is flat.area
    whole = shadow_of((flat, disc))
    assert whole.facets == 0.001 and whole.area.area == pytest.approx(
        8 * 6 - 4 + 0.75 * disc.area.area, rel=1e-3
    )


@pytest.mark.parametrize("corner", [(4.0, 0.0), (3.0, 1.0), (1.0, 1.0), (9.0, 9.0)])
def test_the_plan_of_boxes_is_the_area_that_they_cover(corner: tuple[float, float]) -> None:
    """Beside each other, overlapping, one over the other, apart; each 4 by 4 mm."""
    x, y = corner
    inner = 2.0 if x < 3 else 4.0
    regions = [
        Region(contour([0, 4, 4 + 4j, 4j])),
        Region(contour([x + w * inner + y * 1j for w in (0, 1, 1 + 1j, 1j)])),
    ]
    boxes = [
        solid(Part("box", "Box", (Layer(region, z, z + 1.0),)), 0.01)
        for region, z in zip(regions, (0.0, 3.0), strict=True)
    ]
    count = len(boxes[0].vertices)
    both = Mesh(
        np.concatenate([box.vertices for box in boxes]),
        np.concatenate([boxes[0].faces, boxes[1].faces + count]),
    )
    plan = plan_of(both)
    common = max(0.0, min(4, x + inner) - x) * max(0.0, min(4, y + inner) - y)
    assert plan.is_valid and plan.area == pytest.approx(16 + inner**2 - common, rel=1e-12)
    assert plan.covers(shapely.box(x, y, x + inner, y + inner))


def test_a_section_is_covered_by_one_that_is_no_coarser() -> None:
    def box(size: float, facets: float) -> Section:
        return Section(0.0, 1.0, shapely.box(-size, -size, size, size), None, facets)

    small, large = box(2, 0.001), box(3, 0.001)
    assert covered(small, large) and not covered(large, small) and covered(small, small)
    assert covered(box(2, 0.0), large) and not covered(small, box(3, 0.0))


def test_what_slants_counts_with_its_shadow_between_two_heights() -> None:
    """A pyramid on a foot of 6 x 6 mm, 3 mm high, beside a block of 1 mm, which parts it in two: its sections at 0 and at 1 mm,
    whether it stands upright or on its head."""
    foot = np.array([[0, 0, 0], [6, 0, 0], [6, 6, 0], [0, 6, 0], [3, 3, 3]], float)
    faces = np.array([[0, 2, 1], [0, 3, 2], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
    block = solid(Part("b", "", (Layer(Region(contour([20, 22, 22 + 2j, 20 + 2j])), 0, 1),)), 0.01)
    over = np.array([0, 0, 3]) + foot * [1, 1, -1]
    for vertices, turned, sizes in ((foot, faces, (6, 4)), (over, faces[:, ::-1], (2, 6))):
        mesh = Mesh(
            np.concatenate([vertices, block.vertices]), np.concatenate([turned, block.faces + 5])
        )
        low, high = slabs_of(mesh)
        assert (low.z0, low.z1, high.z0, high.z1) == (0, 1, 1, 3)
        areas = area_of(low.rings).area - 4, area_of(high.rings).area
        assert areas == pytest.approx((sizes[0] ** 2, sizes[1] ** 2))
        assert area_of(high.rings).bounds == pytest.approx(
            (3 - sizes[1] / 2,) * 2 + (3 + sizes[1] / 2,) * 2
        )


def test_heights_that_differ_by_rounding_are_one() -> None:
    """Of a cylinder whose rim of float32 goes up and down by its last digits."""
    mesh = solid(Part("c", "", (Layer(Region(circle(0j, 5)), 0, 8),)), 0.01)
    noise = np.where(np.arange(len(mesh.vertices)) % 2, 0.0, 8 * 2.0**-24) * (
        mesh.vertices[:, 2] > 0
    )
    (found,) = slabs_of(Mesh(mesh.vertices - np.outer(noise, [0, 0, 1]), mesh.faces))
    assert found.z0 == 0 and found.z1 == pytest.approx(8, abs=1e-6)


@pytest.mark.parametrize("far", [0.0, 900.0])
def test_walls_that_rounding_leans_are_upright(far: float) -> None:
    """A prism of 48 corners whose coordinates are float32, far from the origin too: its section is the slice half way up."""
    z = far * (1 + 0.7j) + 5 * np.exp(2j * np.pi * (np.arange(48) + 0.3) / 48)
    mesh = solid(Part("p", "", (Layer(Region(contour(z.tolist())), 0, 7),)), 0.01)
    top = mesh.vertices[:, 2] > 0
    noise = (np.random.default_rng(1).uniform(-1, 1, mesh.vertices.shape) * [1, 1, 0]) * top[
        :, None
    ]
    leaning = mesh.vertices + noise * 2.0**-24 * (abs(far) + 5)
    read = Mesh(leaning.astype(np.float32).astype(float), mesh.faces)
    (found,) = slabs_of(read)
    np.testing.assert_array_equal(
        [ring.points for ring in found.rings], [ring.points for ring in slice_mesh(read, 3.5)]
    )


# ---- as one sees the other -----------------------------------------------------------------------------------------------

THETA = np.linspace(0, math.tau, 721)


def course(angle: tuple[float, float, float], place: tuple[complex, complex, complex]) -> Course:
    """Turns evenly and sways, on an ellipse about a place."""

    def moved(t: Floats) -> tuple[Floats, Points]:
        z = place[0] + place[1] * np.cos(t) + place[2] * np.sin(t)
        return angle[0] + angle[1] * t + angle[2] * np.sin(2 * t), np.asarray(z, complex)

    return moved


NUMBER, PLACE = st.floats(-2, 2), st.complex_numbers(max_magnitude=30)
COURSE = st.builds(
    course,
    st.tuples(NUMBER, st.sampled_from([0.0, 1.0, -2.0]), NUMBER),
    st.tuples(PLACE, PLACE, PLACE),
)


@settings(max_examples=25)
@given(home=COURSE, guest=COURSE, point=PLACE, reach=st.floats(0, 20))
def test_no_point_of_a_guest_goes_further_than_its_path(
    home: Course, guest: Course, point: complex, reach: float
) -> None:
    """Points at `reach` from a centre, through the ground: between any two angles their way is shorter, seen in steps ten times
    as fine; and it is longer by no more than the bends of the steps tell."""
    motion = Motion(home, guest, THETA)
    fine = np.linspace(0, math.tau, 7201)
    (alpha, p), (beta, q) = home(fine), guest(fine)

    def seen(z: complex) -> Points:
        return np.asarray((q + np.exp(1j * beta) * z - p) * np.exp(-1j * alpha))

    turns, shifts = motion.at(fine)
    np.testing.assert_allclose(shifts + turns * point, seen(point), atol=1e-9)
    path = motion.path(point, reach)
    for spoke in (1, 1j, -1, -1j):
        gone = np.append(0.0, np.cumsum(np.abs(np.diff(seen(point + reach * spoke)))))
        assert np.all(np.diff(gone[::10]) <= np.diff(path) + 1e-9)
    way, turned = (float(np.abs(np.diff(z)).sum()) for z in (seen(point), turns))
    bends, turning = (
        4 * float(np.abs(np.diff(z[::10], 2)).sum()) for z in (seen(point), turns)
    )  # four lie beside a step
    assert (
        way + reach * turned - 1e-9
        <= path[-1]
        <= 1.0001 * (way + bends + reach * (turned + turning)) + 1e-3
    )


@settings(max_examples=40)
@given(home=COURSE, at=PLACE, own=PLACE)
def test_the_calmest_point_of_what_turns_on_a_pin_is_the_pin(
    home: Course, at: complex, own: complex
) -> None:
    """A guest that turns three times as fast about a pin of the home: the pin in the guest's frame stands still."""

    def guest(t: Floats) -> tuple[Floats, Points]:
        alpha, p = home(t)
        return alpha + 3 * t, p + np.exp(1j * alpha) * at - np.exp(1j * (alpha + 3 * t)) * own

    motion = Motion(home, guest, THETA)
    assert motion.calmest == pytest.approx(own, abs=1e-9)
    assert (
        motion.path(motion.calmest, 0.0)[-1] < 1e-8
        and not motion.at_rest
        and motion.straight is None
    )
    fixed = Motion(
        home, lambda t: (home(t)[0] + 0.3, home(t)[1] + np.exp(1j * home(t)[0]) * at), THETA
    )
    assert fixed.at_rest and fixed.straight is None and fixed.path(own, 7.0)[-1] < 1e-8


@settings(max_examples=40)
@given(
    home=COURSE, at=PLACE, bearing=st.floats(-3, 3), size=st.floats(0.5, 30), late=st.floats(0, 6)
)
def test_a_guest_that_slides_has_a_straight_way(
    home: Course, at: complex, bearing: float, size: float, late: float
) -> None:
    """From end to end and hardly further; bent, or turned on its way, it has none."""
    along = np.exp(1j * bearing)

    def sliding(bend: float, turn: float) -> Course:
        def guest(t: Floats) -> tuple[Floats, Points]:
            alpha, p = home(t)
            way = at + along * (size * np.sin(t + late) + 1j * bend * np.cos(2 * t))
            return alpha + 0.4 + turn * np.cos(t), p + np.exp(1j * alpha) * way

        return guest

    ends = Motion(home, sliding(0.0, 0.0), THETA).straight
    assert ends is not None
    out = sorted((float(((end - at) / along).real) for end in ends), key=abs)
    assert np.abs(((np.array(ends) - at) / along).imag).max() < 1e-6
    assert np.prod(out) < 0 and all(size * (1 - 1e-9) <= abs(x) <= size * 1.001 for x in out)
    assert Motion(home, sliding(0.01, 0.0), THETA).straight is None
    assert Motion(home, sliding(0.0, 1e-3), THETA).straight is None
