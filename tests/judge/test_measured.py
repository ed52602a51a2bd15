"""What is measured of the sections of files: against the numbers from which outlines were drawn."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapes import polygon

from camgen.geometry.rings import Ring, Shape
from camgen.judge.measured import (
    MeasuredEye,
    MeasuredFaces,
    measure,
    measure_bore,
    measure_end,
    measure_faces,
    of_layer,
    read,
)
from camgen.machine.features import (
    CamOutline,
    Eye,
    Faces,
    Flat,
    GearTeeth,
    OwnTip,
    SharedFlat,
    SlideFaces,
    SlotFaces,
    Teeth,
)

# ---- teeth -----------------------------------------------------------------------------------------------------------


def wheel(
    radius: float, flanks: Sequence[tuple[float, float]], slant: complex, start: int = 0
) -> Ring:
    """A wheel whose teeth cross its pitch circle at the angles (begin, end) of each, by straight flanks that lean as they like.

    slant: from a flank's foot to its tip, of a tooth that stands on Ox; its other flank is the mirror image. start: the vertex
    with which the ring begins.
    """
    points = []
    for begin, end in flanks:
        up, down = slant * cmath.exp(1j * begin), slant.conjugate() * cmath.exp(1j * end)
        one, other = radius * cmath.exp(1j * begin), radius * cmath.exp(1j * end)
        points += [one - 0.4 * up, one + 0.6 * up, other + 0.6 * down, other - 0.4 * down]
    z = np.roll(np.array(points), -start)
    return Ring(z, np.zeros(len(z)))


def evenly(count: int, turned: float = 0.0) -> Ring:
    """Equal teeth."""
    middles = turned + np.arange(count) * math.tau / count
    return wheel(20.0, np.column_stack([middles - 0.15, middles + 0.15]).tolist(), 2 + 0.3j)


def test_a_wheel_is_what_any_height_shows_of_it() -> None:
    """Equal heights count once, to the last digit; of two that differ the wider teeth count at every place; a hub does not."""
    teeth = Teeth("wheel", 10, 20.0, 6.0)
    mate = Teeth("mate", 10, 20.0, 6.0)
    hub = Shape(Ring(5 * np.exp(1j * np.arange(7)), np.zeros(7)), ())
    one, other = Shape(evenly(10), ()), Shape(evenly(10, 0.02), ())
    files = {"wheel": [[hub, one], [one]], "mate": [[one], [], [other]]}
    found = read([GearTeeth("mesh", teeth, mate, ("O", "P"))], files, drawing=False).wheels
    assert np.array_equal(found[teeth].points, one.outer.points)
    both = found[mate].points
    first, low, high = (
        np.angle(z)[np.abs(np.angle(z)) < 0.3] for z in (both, one.outer.points, other.outer.points)
    )
    assert (first.min(), first.max()) == pytest.approx((low.min(), high.max()), abs=1e-12)


# ---- flats of holes ----------------------------------------------------------------------------------------------------


def hole_with_flat(
    centre: complex, radius: float, facing: float, depth: float, onward: bool
) -> Ring:
    """A round hole whose flat lies `depth` from the centre; facing: the direction from the centre to it, or from it."""
    half = math.acos(depth / radius)
    corners = centre + radius * np.exp(1j * (facing + np.array([half, -half])))
    ring = Ring(corners, np.array([math.tan((math.tau - 2 * half) / 4), 0.0]))
    return ring if onward else ring.reversed()


@settings(max_examples=40)
@given(
    at=st.complex_numbers(max_magnitude=30),
    facing=st.floats(-3, 3),
    off=st.tuples(st.floats(-0.4, 0.4), st.floats(-0.4, 0.4)),
    depth=st.floats(1.0, 2.2),
    onward=st.booleans(),
)
def test_a_flat_is_told_by_the_direction_in_which_it_faces(
    at: complex, facing: float, off: tuple[float, float], depth: float, onward: bool
) -> None:
    """At two heights, in two parts: the mean of all heights, on whichever side of the hole the flat is."""
    a, b = Eye("a", at, 5.0), Eye("b", 0j, 5.0)
    rim = Ring(60 * np.exp(1j * np.arange(0, 6.2, 0.1)), np.zeros(62))
    other = Ring(
        at + 12 * np.array([1, 1j, -1, -1j]), np.zeros(4)
    )  # beside it, with straight sides
    heights = [
        [Shape(rim, (hole_with_flat(at, 2.5, facing + by, depth, onward), other.moved(shift=20)))]
        for by in off
    ]
    opposite = [[Shape(rim, (hole_with_flat(0.1j, 2.5, facing + math.pi, depth, onward),))]]
    found = read([SharedFlat(a, b, facing)], {"a": heights, "b": opposite}, drawing=False)
    (seen,) = found.facing.values()
    assert seen == pytest.approx((facing + sum(off) / 2, facing), abs=1e-9)


@pytest.mark.parametrize("lost, wide", [("a", 0.34), ("b", 0.34), ("a", 0.1), ("", 0.36)])
def test_a_hole_without_its_flat_is_lost(lost: str, wide: float) -> None:
    """A flat is wider than 0.35 of the diameter; the part without one is named, and where its hole is."""
    rim = Ring(60 * np.exp(1j * np.arange(0, 6.2, 0.1)), np.zeros(62))
    eyes = Eye("a", 3 + 0j, 5.0), Eye("b", -4 + 0j, 5.0)
    depths = {"a": 2.0, "b": 2.0, lost: 2.5 * math.cos(math.asin(wide))}
    files = {
        each.part: [[Shape(rim, (hole_with_flat(each.at, 2.5, 0.0, depths[each.part], True),))]]
        for each in eyes
    }
    found = read([SharedFlat(*eyes, 0.0)], files, drawing=False)
    place = {"a": "3.000+0.000j", "b": "-4.000+0.000j"}
    flats = [line for line in found.lost if "flat" in line]
    assert flats == ([f"no flat in {lost} near {place[lost]}"] if lost else [])


# ---- eyes ----------------------------------------------------------------------------------------------------------------


def facets(centre: complex, radius: float, count: int) -> Ring:
    return polygon(centre + radius * np.exp(2j * np.pi * np.arange(count) / count))


def round_hole(centre: complex, radius: float) -> Ring:
    return Ring(centre + radius * np.array([1, -1 + 0j]), np.ones(2))


PLATE = facets(0j, 90, 7)
PLACE, NEAR = st.complex_numbers(max_magnitude=30), st.complex_numbers(max_magnitude=0.2)


@settings(max_examples=40)
@given(
    at=PLACE,
    off=st.lists(NEAR, min_size=1, max_size=3),
    sizes=st.lists(st.floats(-0.4, 0.4), min_size=3, max_size=3),
    count=st.integers(20, 90),
    shaft=st.booleans(),
)
def test_an_eye_is_the_mean_of_its_heights(
    at: complex, off: list[complex], sizes: list[float], count: int, shaft: bool
) -> None:
    """A hole is as wide as its narrowest height between flats, a shaft as its thickest over corners; the centre is the mean,
    the spread the largest distance from the lowest one."""
    rings = [facets(at + by, 3 + size / 2, count) for by, size in zip(off, sizes, strict=False)]
    heights = [
        [Shape(ring, ()) if shaft else Shape(PLATE, (facets(at + 9, 3, 9), ring))] for ring in rings
    ]
    found = measure(Eye("x", at, 6.0, shaft), heights)
    assert found is not None
    assert found.centre == pytest.approx(at + np.mean(off), abs=1e-8)
    assert found.spread == pytest.approx(max(abs(by - off[0]) for by in off), abs=1e-8)
    own = sizes[: len(off)]
    thick = max(
        size for size in own if size <= min(own) + 0.5
    )  # what is wider than the thinnest by more is a head
    assert found.diameter == pytest.approx(
        6 + thick if shaft else (6 + min(own)) * math.cos(math.pi / count), abs=1e-8
    )


@pytest.mark.parametrize("diameter, more", [(3.0, 0.75), (20.0, 1.0), (120.0, 2.4)])
@pytest.mark.parametrize("sign", [1, -1])
def test_a_ring_of_another_size_or_elsewhere_is_no_eye(
    diameter: float, more: float, sign: int
) -> None:
    """Off by a quarter of the diameter, in size at most by 1 mm or a fiftieth of it."""
    eye, plate = Eye("x", 5j, diameter), facets(0j, 300, 9)
    for off, shift, there in (
        (0.99, 0.0, True),
        (1.01, 0.0, False),
        (0.0, 0.249, True),
        (0.0, 0.251, False),
    ):
        hole = round_hole(eye.at + sign * shift * diameter, (diameter + sign * off * more) / 2)
        assert (measure(eye, [[Shape(plate, (hole,))]]) is not None) is there


def test_a_pins_head_is_not_its_shank() -> None:
    """Heights of 4 mm, of 4.4 mm and of 4.7 mm: the shank is what is thicker than the thinnest by at most half a millimetre."""
    heights = [[Shape(facets(0j, diameter / 2, 60), ())] for diameter in (4.0, 4.4, 4.7)]
    found = measure(Eye("x", 0j, 4.2, shaft=True), heights)
    assert found is not None and found.diameter == pytest.approx(4.4, abs=1e-9)


@pytest.mark.parametrize("count", [0, 24, 90])
@pytest.mark.parametrize("depth", [1.2, 1.7])
def test_a_flat_in_a_hole_takes_nothing_of_its_diameter(count: int, depth: float) -> None:
    """Of arcs or of facets; what of a flat is no longer than 0.35 of the diameter counts as a facet."""
    half = math.acos(depth / 2)
    ring = hole_with_flat(3j, 2.0, 0.4, depth, True)
    if count:
        angles = 0.4 + np.linspace(half, math.tau - half, count + 1)
        ring = polygon(3j + 2 * np.exp(1j * angles))
    found = measure(Eye("x", 3j, 4.0), [[Shape(PLATE, (ring,))]])
    assert found is not None and found.centre == pytest.approx(3j, abs=1e-9)
    step = (math.tau - 2 * half) / count if count else 0.0
    assert found.diameter == pytest.approx(4 * math.cos(step / 2), abs=1e-9)
    small = polygon(
        3j + 2 * np.exp(1j * np.linspace(0.34, math.tau - 0.34, 61))
    )  # a flat of a third of the diameter
    seen = measure(Eye("x", 3j, 4.0), [[Shape(PLATE, (small,))]])
    assert seen is not None and seen.diameter == pytest.approx(4 * math.cos(0.34), abs=1e-9)


@pytest.mark.parametrize("start", [0, 30, 61, 62])
@pytest.mark.parametrize("cuts", [[0.13], [0.5], [0.1, 0.3, 0.6, 0.9]])
def test_a_flat_that_is_laid_in_pieces_is_one(start: int, cuts: list[float]) -> None:
    """A slicer parts a flat into a long and a short piece, two halves or five, none straight to the last micrometre."""
    half = math.acos(0.73)
    angles = 0.4 + np.linspace(half, math.tau - half, 61)
    round_part = 3 * np.exp(1j * angles)
    along = round_part[-1] + np.array(cuts) * (round_part[0] - round_part[-1])
    ring = polygon(3j + np.roll(np.append(round_part, along * 1.001), -start))
    found = measure(Eye("x", 3j, 6.0), [[Shape(PLATE, (ring,))]])
    assert found is not None and found.centre == pytest.approx(3j, abs=1e-9)
    step = (math.tau - 2 * half) / 60
    assert found.diameter == pytest.approx(6 * math.cos(step / 2), abs=1e-9)
    both = Eye("x", 3j, 6.0), Eye("y", 3j, 6.0)
    files = {each.part: [[Shape(PLATE, (ring,))]] for each in both}
    assert not read([SharedFlat(*both, 0.4)], files, drawing=False).lost


@pytest.mark.parametrize("inwards", [0.3, 0.1])
def test_a_bump_opposite_a_flat_is_in_the_way(inwards: float) -> None:
    """Only what is straight is a flat: one vertex that stands into the hole takes of its diameter."""
    half = math.acos(0.73)
    z = 3 * np.exp(1j * np.linspace(half, math.tau - half, 62))
    z[30] *= 1 - inwards / 3
    found = measure(Eye("x", 0j, 6.0), [[Shape(PLATE, (polygon(z),))]])
    assert found is not None and found.diameter < 6 - inwards / 2


@settings(max_examples=30)
@given(at=PLACE, off=st.tuples(NEAR, NEAR), radius=st.floats(1, 8), size=st.floats(-0.02, 0.02))
def test_a_rounded_end_is_a_circle_through_its_own_points(
    at: complex, off: tuple[complex, complex], radius: float, size: float
) -> None:
    """The end of an arm at two heights, away from the part's origin: its mean centre, the larger radius."""
    heights = []
    for by, more in zip(off, (0.0, size), strict=True):
        small = 0.005 * by  # within the fiftieth of the diameter in which points count
        arc = Ring(
            at + radius * small + radius * (1 + more) * np.array([-1j, 1j]), np.array([1.0, 0.0])
        )
        body = Ring(np.append(arc.points, at - 20 * radius), np.array([1.0, 0.0, 0.0]))
        heights.append([Shape(body, ())])
    found = measure_end(Eye("x", at, 2 * radius, shaft=True), heights)
    assert found is not None
    centres = [at + radius * 0.005 * by for by in off]
    assert found.centre == pytest.approx(np.mean(centres), abs=1e-7)
    assert found.diameter == pytest.approx(2 * radius * (1 + max(size, 0.0)), abs=1e-7)
    assert found.spread == pytest.approx(abs(centres[1] - centres[0]), abs=1e-7)
    assert measure_end(Eye("x", at + 3 * radius, 2 * radius, shaft=True), heights[:1]) is None


def test_five_points_show_a_rounded_end() -> None:
    """Of a drawing of straight edges alone: its circle goes through them."""
    tip = 3 + 2j + 4 * np.exp(1j * np.linspace(-0.9, 0.9, 5))
    found = measure_end(
        Eye("x", 3 + 2j, 8.0, shaft=True), [[Shape(polygon(np.append(tip, -40 + 2j)), ())]]
    )
    assert found is not None and (found.centre, found.diameter) == (
        pytest.approx(3 + 2j, abs=1e-9),
        pytest.approx(8, abs=1e-9),
    )


@pytest.mark.parametrize(("depth", "shaft"), [(1.4, False), (-1.8, True)])
@pytest.mark.parametrize("off", [0j, 0.02 + 0.01j])
def test_an_eye_with_a_keyway_is_its_round_part(depth: float, shaft: bool, off: complex) -> None:
    """Of a bore of 10 with t2 1.4 and a shaft of 10 with t1 1.8 [DIN 6885], 3 wide, in 400 facets; where it is off by so much too."""
    foot = math.sqrt(25 - 1.5**2)
    notch = [1.5 + 1j * (5 + depth), -1.5 + 1j * (5 + depth)]
    start = math.atan2(foot, -1.5)
    round_part = 5 * np.exp(1j * np.linspace(start, math.tau + math.pi - start, 400))
    ring = polygon(3 + off + np.concatenate([round_part, notch]))
    shape = Shape(ring, ()) if shaft else Shape(facets(3, 9, 40), (ring,))
    eye = measure(Eye("x", 3 + 0j, 10.0, shaft), [[shape]])
    assert eye is not None
    assert eye.centre == pytest.approx(3 + off, abs=1e-6)
    assert eye.diameter == pytest.approx(10, abs=1e-3), "sagittas of 400 facets: 0.0006"


def test_a_bore_with_a_keyway_is_its_round_part() -> None:
    """Of the lowest height alone, whatever the part has else; where it has no hole it counts as meant."""
    notch = [0.9 + 2.5j, 0.9 + 3.4j, -0.9 + 3.4j, -0.9 + 2.5j]
    arc = (
        0.1j
        + math.hypot(0.9, 2.4)
        * np.exp(1j * np.linspace(math.atan2(2.4, -0.9), math.tau + math.atan2(2.4, 0.9), 90))[1:-1]
    )
    keyed = polygon(8 + np.concatenate([notch, arc]))
    other, above = facets(-8, 2.5, 40), facets(8.5, 1, 40)
    eye = Eye("x", 8 + 0j, 5.1)
    found = measure_bore(eye, [[Shape(PLATE, (other, keyed))], [Shape(PLATE, (above,))]])
    assert found.centre == pytest.approx(8 + 0.1j, abs=1e-6)
    assert found.diameter == pytest.approx(2 * math.hypot(0.9, 2.4), abs=1e-5)
    assert measure_bore(eye, [[Shape(PLATE, ())]]) == MeasuredEye(eye.at, eye.diameter)


# ---- faces ---------------------------------------------------------------------------------------------------------------


SHARE, LEAN = st.floats(-0.05, 0.05), st.floats(-0.009, 0.009)


@settings(max_examples=40)
@given(
    through=PLACE,
    angle=st.floats(-3, 3),
    width=st.floats(2, 20),
    off=st.tuples(SHARE, SHARE),
    lean=st.tuples(LEAN, LEAN),
    runner=st.booleans(),
    turned=st.booleans(),
)
def test_faces_are_where_they_cross_beside_the_place(
    through: complex,
    angle: float,
    width: float,
    off: tuple[float, float],
    lean: tuple[float, float],
    runner: bool,
    turned: bool,
) -> None:
    """Two faces off by shares of the width and leaning: of a bar that runs between rails, or of the rails, run either way; with
    a longer wall beyond them, and short sides nearer."""
    along = np.exp(1j * angle)
    x = np.array([-0.8, 0.7]) * width
    right, left = (
        through + along * (x + 1j * (width * (side / 2 + o) + x * np.tan(n)))
        for side, o, n in zip((-1, 1), off, lean, strict=True)
    )
    tips = through + along * np.array([-1.5 + 0.1j, -1.5 - 0.1j, 1.4 - 0.1j, 1.4 + 0.1j]) * width
    if runner:
        ring = polygon(np.array([*tips[:2], *right, *tips[2:], *left[::-1]]))
        shape = Shape(ring, ())
    else:
        frame = through + along * np.array([-3 - 3j, 3 - 3j, 3 + 3j, -3 + 3j]) * width
        shape = Shape(
            polygon(frame), (polygon(np.array([*tips[:2], *right, *tips[2:], *left[::-1]])[::-1]),)
        )
    found = measure_faces(through, angle + math.pi * turned, width, [[shape]])
    assert found is not None
    sign = -1 if turned else 1
    offset = sign * (off[0] + off[1]) / 2 * width
    assert (found.offset, found.width) == pytest.approx(
        (offset, width * (1 + off[1] - off[0])), abs=1e-9
    )
    assert found.lean == pytest.approx(sum(lean) / 2, abs=1e-9)


def bars(*heights: float, length: float = 9.0, lean: float = 0.0) -> list[list[Shape]]:
    """A bar at each height of a stack whose upper side lies so high; its lower side at -4, and it may lean, rad."""
    ends = [
        np.array([-length - 4j, length - 4j, length + 1j * h, -length + 1j * h]) for h in heights
    ]
    return [[Shape(polygon(z + 1j * z.real * math.tan(lean)), ())] for z in ends]


def test_faces_at_several_heights_are_one_or_the_nearest() -> None:
    """Two that are apart by a fiftieth of the width are one face, with their mean; of others the nearest counts."""
    assert measure_faces(0j, 0.0, 8.0, bars(4.0, 4.15)) == MeasuredFaces(
        *map(pytest.approx, (0.0375, 0.0, 8.075))
    )
    assert measure_faces(0j, 0.0, 8.0, bars(4.0, 4.17)) == MeasuredFaces(
        *map(pytest.approx, (0.0, 0.0, 8.0))
    )
    assert measure_faces(0j, 0.0, 8.0, bars(5.9)) is not None
    assert measure_faces(0j, 0.0, 8.0, bars(6.1)) is None  # off by more than a quarter of the width
    assert measure_faces(0j, 0.0, 8.0, bars(4.0, length=1.1)) is not None
    assert (
        measure_faces(0j, 0.0, 8.0, bars(4.0, length=0.9)) is None
    )  # sides shorter than a quarter of the width
    assert measure_faces(0j, 0.0, 8.0, bars(4.0, lean=0.0099)) is not None
    assert measure_faces(0j, 0.0, 8.0, bars(4.0, lean=0.0101)) is None
    bulging = Ring(bars(4.0)[0][0].outer.points, np.array([0.0, 0.0, 0.1, 0.0]))
    assert measure_faces(0j, 0.0, 8.0, [[Shape(bulging, ())]]) is None  # an arc is no face


# ---- all features of a machine -------------------------------------------------------------------------------------------

SQUARE = polygon(np.array([-20 - 20j, 20 - 20j, 20 + 20j, -20 + 20j]))


def test_an_outline_is_the_largest_of_its_part_with_the_material_on_its_left() -> None:
    """The rim of the largest height, or for what comes from within the largest hole, run clockwise."""
    small, rim = facets(0j, 10, 30), facets(0j, 15, 30)
    hole, bore = facets(0j, 8, 20), facets(0j, 2, 20)
    heights = [[Shape(small, (bore,))], [Shape(rim, (bore, hole.reversed()))]]
    tip = Eye(None, 30 + 0j, 6.0, shaft=True)
    outside, inside = (
        CamOutline("lift", "cam", "O", None, tip, inside=within) for within in (False, True)
    )
    found = read([outside, inside], {"cam": heights}, drawing=False)
    assert found.rings[outside].area == pytest.approx(rim.area) and found.rings[
        inside
    ].area == pytest.approx(-hole.area)
    assert found.eyes[tip] == MeasuredEye(30 + 0j, 6.0) and found.lost == []
    for missing in ({}, {"cam": [[]]}):
        assert read([outside], missing, drawing=False).lost == ["lift: the outline of cam is lost"]


@settings(max_examples=20)
@given(facing=st.floats(-3, 3), lean=LEAN, off=st.floats(-0.8, 0.8), at=PLACE)
def test_a_face_is_where_its_middle_was_meant(
    facing: float, lean: float, off: float, at: complex
) -> None:
    """A face of a follower, 12 mm long, moved along its own normal and turned; without it the joint is lost."""
    out = np.exp(1j * (facing + lean))
    face = (
        at
        + np.exp(1j * facing) * off / math.cos(lean)
        + out * np.array([6j, -6j, -30 - 4j, -30 + 4j])
    )
    flat = Flat("stem", at, facing, 12.0)
    files = {"cam": [[Shape(SQUARE, ())]], "stem": [[Shape(polygon(face[::-1]), ())]]}
    outline = CamOutline("lift", "cam", "O", None, flat)
    found = read([outline], files, drawing=False).flats[flat]
    assert found.facing == pytest.approx(facing + lean, abs=1e-9)
    assert found.at == pytest.approx(at + np.exp(1j * facing) * off / math.cos(lean), abs=1e-9)
    elsewhere = [[Shape(polygon(np.array([500, 501, 500 + 1j])), ())]]
    assert read([outline], files | {"stem": elsewhere}, drawing=False).lost == [
        "lift: the face is lost"
    ]
    bought = Flat(None, at, facing, 12.0)
    assert (
        read([CamOutline("lift", "cam", "O", None, bought)], files, drawing=False).flats[bought]
        is bought
    )


def test_a_followers_own_tip_is_measured_on_its_part() -> None:
    """Its bore by the round part; a seat as a hole, a rounded end by its circle, a knife edge by the nearest corner."""
    arm = polygon(np.array([-5 - 5j, 30.2 + 0.1j, -5 + 5j]))
    bore = facets(0.1 + 0j, 1.5, 60)
    ended = Ring(np.array([-5 - 3j, 30 - 3j, 30 + 3j, -5 + 3j]), np.array([0.0, 1.0, 0.0, 0.0]))
    seat = Shape(SQUARE, (facets(12 + 0.1j, 2, 60), bore))
    axle = Eye("arm", 0j, 3.0)
    for shape, tip, centre, size in (
        (Shape(arm, (bore,)), Eye("arm", 30 + 0j, 0.0), 30.2 + 0.1j, 0.0),
        (Shape(ended, (bore,)), Eye("arm", 30 + 0j, 6.0, shaft=True), 30 + 0j, 6.0),
        (seat, Eye("arm", 12 + 0j, 4.0), 12 + 0.1j, 4 * math.cos(math.pi / 60)),
    ):
        rolling = Eye(None, 30 + 0j, 6.0, shaft=True)
        outline = CamOutline(
            "lift", "cam", "O", "P", rolling, bore=Eye("cam", 0j, 5.0), own=OwnTip("arm", tip, axle)
        )
        files = {"cam": [[Shape(SQUARE, (facets(0.2j, 2.5, 90),))]], "arm": [[shape]]}
        found = read([outline], files, drawing=False)
        assert found.eyes[axle].centre == pytest.approx(0.1, abs=1e-6)
        assert found.eyes[Eye("cam", 0j, 5.0)].centre == pytest.approx(0.2j, abs=1e-6)
        assert found.eyes[tip].centre == pytest.approx(centre, abs=1e-6) and found.eyes[
            tip
        ].diameter == pytest.approx(size)
        assert axle not in read([outline], {"cam": files["cam"]}, drawing=False).eyes
    lost = read(
        [
            CamOutline(
                "lift",
                "cam",
                "O",
                "P",
                Eye("arm", 9j, 6.0),
                own=OwnTip("arm", Eye("arm", 9j, 6.0), axle),
            )
        ],
        files,
        drawing=False,
    )
    assert Eye("arm", 9j, 6.0) not in lost.eyes and lost.lost == [
        "no eye of 6 mm near 0.000+9.000j in arm"
    ]


def test_what_a_drawing_does_not_show_counts_as_meant() -> None:
    """Rails that stand on a plate are not in its drawing; walls of a slot are. A face that is lost is told."""
    rails, runner = Faces("base", 0j, 0.0, 8.4, drawn=False), Faces("ram", 0j, 0.0, 8.0)
    files = {"ram": bars(4.0), "base": [[Shape(SQUARE, ())]]}
    slide = SlideFaces("guide", rails, runner)
    shown = read([slide], files, drawing=True)
    assert shown.faces == {
        rails: MeasuredFaces(0.0, 0.0, 8.4),
        runner: MeasuredFaces(*map(pytest.approx, (0, 0, 8.0))),
    }
    assert read([slide], files, drawing=False).lost == ["guide: a face or its eye is lost"]
    slot = SlotFaces("slot", replace(runner, drawn=True), Eye(None, 0j, 4.0))
    found = read([slot, slide], files, drawing=True)
    assert set(found.faces) == {runner, rails} and found.eyes == {slot.eye: MeasuredEye(0j, 4.0)}


def test_a_wheel_that_is_lost_is_told() -> None:
    a, b = Teeth("a", 10, 20.0, 6.0), Teeth("b", 20, 40.0, 6.0)
    found = read(
        [GearTeeth("mesh", a, b, ("O", "P"))],
        {"a": [[Shape(evenly(10), ())]], "b": [[]]},
        drawing=False,
    )
    assert list(found.wheels) == [a]
    assert found.lost == ["mesh: the outline of b is lost"]


def test_a_layer_has_the_sections_of_its_own_heights() -> None:
    """Two of six in each of three; all of a part without layers; and what a file shows of one layer alone."""
    heights = [[Shape(facets(0j, k, 8), ())] for k in range(5, 11)]
    assert [of_layer(heights, (k, 3)) for k in range(3)] == [heights[:2], heights[2:4], heights[4:]]
    assert of_layer(heights, None) == heights
    assert of_layer(heights[:1], (1, 3)) == heights[:1]
