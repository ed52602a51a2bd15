"""Bodies of a drum's machine in motion: how near boxes come to each other, by radii, plans and places worked out by hand."""

from __future__ import annotations

import math

import manifold3d
import numpy as np
import pytest

from camgen.geometry.mesh import Mesh
from camgen.geometry.rings import Floats
from camgen.judge.interference import GRID
from camgen.judge.sweep_in_space import (
    _apart,
    _Body,
    _clearances,
    _from_start,
    _least_radius,
    _overlap,
    _searched,
)
from camgen.machine.features import SweptMachine
from camgen.machine.model import GROUND, Pose

THETA = np.linspace(0, math.tau, GRID + 1)


def course(angle: Floats, shift: Floats) -> Floats:
    """Transforms (n, 3, 4) of turns about z and shifts (n, 3)."""
    found = np.zeros((len(angle), 3, 4))
    found[:, 0, 0] = found[:, 1, 1] = np.cos(angle)
    found[:, 1, 0] = np.sin(angle)
    found[:, 0, 1] = -np.sin(angle)
    found[:, 2, 2] = 1
    found[:, :, 3] = shift
    return found


STILL = np.zeros((len(THETA), 3))
LIFT = 2 * np.sin(THETA)
COURSES = {
    GROUND: course(0 * THETA, STILL),
    "drum": course(THETA, STILL),
    "slide": course(0 * THETA, LIFT[:, None] * [0.0, 0.0, 1.0]),
    "carriage": course(0 * THETA, LIFT[:, None] * [1.0, 0.0, 0.0]),
}
Corner = tuple[float, float, float]


def body(on: str, *boxes: tuple[Corner, Corner]) -> _Body:
    """Boxes from corner to corner, mm, on a body of the model."""
    solids = [
        manifold3d.Manifold.cube(np.subtract(high, low)).translate(low) for low, high in boxes
    ]
    mesh = manifold3d.Manifold.batch_boolean(solids, manifold3d.OpType.Add).to_mesh64()
    solid = Mesh(mesh.vert_properties.copy(), mesh.tri_verts.astype(np.int64))
    return _Body(on, on, on, solid, COURSES)


@pytest.mark.parametrize(
    ("triangle", "radius"),
    [
        (((6, 0), (0, 8), (10, 10)), 4.8),  # from a slanted side: 6 * 8 / 10
        (((0, 8), (6, 0), (10, 10)), 4.8),
        (((3, 4), (9, 4), (9, 9)), 5.0),  # from a corner
        (((3, -4), (3, 5), (9, 0)), 3.0),  # from an upright side
        (((-3, -4), (9, -4), (0, 5)), 0.0),
        (((-3, -4), (0, 5), (9, -4)), 0.0),
    ],
)
def test_the_least_radius_of_a_triangle(
    triangle: tuple[tuple[float, float], ...], radius: float
) -> None:
    """The nearest of several counts."""
    far = ((20.0, 20.0), (30.0, 20.0), (30.0, 30.0))
    assert _least_radius(np.array([far, triangle], float)) == pytest.approx(radius, abs=1e-12)


ARM = ((10.0, -1.0, 0.0), (12.0, 1.0, 2.0))  # reaches from 10 mm to the root of 145 mm


@pytest.mark.parametrize(
    ("turning", "other", "apart"),
    [
        # beyond the circle of its corners, at a corner's radius; above it as well
        (ARM, ((15, 15, 0), (17, 17, 2)), 15 * math.sqrt(2) - math.sqrt(145)),
        (ARM, ((15, 15, 5), (17, 17, 6)), math.hypot(15 * math.sqrt(2) - math.sqrt(145), 3)),
        # within the circle that its nearest side leaves free, though not in front of it
        (ARM, ((-4, -3, 0), (4, 3, 2)), 5.0),
        # on its way, but above
        (ARM, ((-11, -1, 2.5), (-10, 1, 4)), 0.5),
        (ARM, ((-11, -1, 1.5), (-10, 1, 4)), 0.0),
    ],
)
def test_what_turns_stays_between_two_radii(
    turning: tuple[Corner, Corner], other: tuple[Corner, Corner], apart: float
) -> None:
    drum, ground = body("drum", turning), body(GROUND, other)
    assert _apart(drum, ground) == pytest.approx(apart, abs=1e-9)
    assert _apart(ground, drum) == pytest.approx(apart, abs=1e-9)


def test_what_rises_stays_beside_what_it_is_beside_in_plan() -> None:
    """A post in the corner of an angle, 1 mm from either of its legs; moved sideways its plan tells nothing."""
    angle = body(GROUND, ((0, 0, 0), (10, 2, 4)), ((0, 0, 0), (2, 10, 4)))
    post = ((3.0, 3.0, 1.0), (5.0, 5.0, 3.0))
    assert _apart(body("slide", post), angle) == pytest.approx(1.0)
    assert _apart(body("carriage", post), angle) == 0.0
    # 2 mm up and down and 3 mm above: the box of all its places
    above = ((0.0, 0.0, 7.0), (2.0, 2.0, 9.0))
    assert _apart(body("slide", above), angle) == pytest.approx(1.0, abs=1e-3)


@pytest.mark.parametrize("gap", [0.6, 0.4])
def test_the_nearest_place_of_a_carriage_is_seen_and_proven(gap: float) -> None:
    """It comes 2 mm nearer in the middle of the first half turn; 0.5 mm are needed."""
    carriage = body("carriage", ((0, 0, 0), (4, 4, 4)))
    wall = body(GROUND, ((6 + gap, 0, 0), (8, 4, 4)), ((6 + gap, 0, 5), (8, 4, 9)))
    for pair in ((carriage, wall), (wall, carriage)):
        found = _searched(*pair, 0.5, THETA)
        assert {found.a, found.b} == {"carriage", GROUND} and not found.at_rest
        if gap > 0.5:
            assert found.gap >= gap - 1e-9 and found.proven == 0.5
        else:
            assert gap <= found.gap < 0.5 and found.proven == found.gap
            assert math.cos(found.theta - math.pi / 2) > 0.95  # at which less than 0.5 mm is left
        assert found.evaluations < 100


def test_a_post_that_a_turning_arm_hits_for_an_instant_is_found() -> None:
    """A cube of 0.2 mm on the arm's way at 100 deg, which its corners pass in some degrees."""
    arm = body("drum", ARM)
    middle = 11 * np.array([math.cos(math.radians(100)), math.sin(math.radians(100))])
    post = body(GROUND, ((*(middle - 0.1), 0.9), (*(middle + 0.1), 1.1)))
    found = _searched(arm, post, 0.05, THETA)
    assert found.gap < 0.05 and math.degrees(found.theta) == pytest.approx(100, abs=8)
    beside = body(GROUND, ((*(middle - 0.1), 2.1), (*(middle + 0.1), 2.3)))  # 0.1 mm above it
    assert _searched(arm, beside, 0.05, THETA).proven == 0.05
    # a micron more than is needed, 20 microns of way from angle to angle: not proven between them, and told soon
    close = _searched(arm, beside, 0.099, THETA)
    assert close.gap == pytest.approx(0.1) and 0.0 < close.proven < 0.099
    assert close.evaluations < 1000


def test_what_two_bodies_have_in_common_is_told_by_its_mean_thickness() -> None:
    """A slab of 10 x 10 x 0.1 mm: twice its volume over its surface."""
    low, high = body(GROUND, ((0, 0, 0), (10, 10, 4))), body("slide", ((0, 0, 3.9), (10, 10, 9)))
    assert _overlap(low, high) == pytest.approx(2 * 10 / (2 * 100 + 4), rel=1e-6)
    assert _overlap(low, body("slide", ((0, 0, 4), (10, 10, 9)))) == 0.0
    assert _overlap(low, body("slide", ((11, 0, 0), (12, 10, 9)))) == 0.0


@pytest.mark.parametrize("stands", [False, True])
def test_a_course_begins_where_the_file_shows_its_body(stands: bool) -> None:
    """A point of a body that turns and shifts, in a plane that lies, or that stands: its x as -y, its y as z, its z as -x."""
    machine = SweptMachine(
        [],
        lambda theta: {"arm": Pose(7 - 2j + 3 * theta, 0.3 + 2 * theta)},
        [],
        [],
        0.5,
        0.01,
        planes={"arm": 5 + 6j} if stands else {},
    )
    theta = np.array([0.0, 0.4, 1.9])
    plane = np.exp(1j * (0.3 + 2 * theta)) * (1 + 2j) + 7 - 2j + 3 * theta
    places = np.column_stack([plane.real, plane.imag, np.full(3, 4.0)])
    if stands:
        plane = plane + 5 + 6j
        places = np.column_stack([np.full(3, -4.0), -plane.real, plane.imag])
    found = _from_start(machine, theta, "arm")
    assert found[:, :, :3] @ places[0] + found[:, :, 3] == pytest.approx(places, abs=1e-12)


def test_each_pair_is_judged_as_it_is_meant() -> None:
    """Two parts pressed together, two that touch by intent as they stand, two far apart, and two that are searched."""
    slab = 2 * 10 / 204  # mm, mean thickness of 10 x 10 x 0.1
    plate = body(GROUND, ((0, 0, 0), (10, 10, 4)))
    pressed = body(GROUND, ((0, 0, 3.9), (10, 10, 6)))
    slide = body("slide", ((0, 0, -6), (10, 10, 0.1)))
    carriage = body("carriage", ((0, 0, -16), (10, 10, -8.3)))
    machine = SweptMachine([], lambda theta: {}, [], [], 0.5, 0.01, touching=[("slide", GROUND)])
    found = list(_clearances([plate, pressed, slide], machine, THETA))
    assert [each.gap for each in found] == pytest.approx([-slab, -slab, 0.0], abs=1e-9)
    assert [each.allowed for each in found] == pytest.approx([0.05] * 3)
    assert [(each.at_rest, each.standing) for each in found] == [
        (True, False),
        (False, True),
        (False, True),
    ]
    # 8.3 mm below the plate, and 0.3 mm below the slide where that is lowest
    far, near, _ = _clearances([carriage, plate, slide], machine, THETA)
    assert far.gap == far.proven == pytest.approx(8.3) and far.evaluations == 0
    assert 0.3 <= near.gap < 0.5 and near.proven == near.gap and near.allowed is None
