"""Followers with an outline of a person's own: against round tips and flat faces, and against a cam cut by brute force."""

from __future__ import annotations

import cmath
import math
from itertools import pairwise

import numpy as np
import pytest
import shapely

from camgen.errors import DesignError
from camgen.geometry.facets import facet_contour
from camgen.geometry.outlines import Arc, Contour, Line, bulged, circle
from camgen.machine.cams.followers import Follower, SlidingFace, SlidingTip, SwingingArm
from camgen.machine.cams.profile import DiscCam
from camgen.machine.cams.shoes import Shoe, SlidingShoe, SwingingShoe, convex_edges
from camgen.motion.laws import LAWS
from camgen.motion.program import Program, Segment
from camgen.numerics import Points

BASE = 25.0


def turn(*rows: tuple[float, float, float]) -> Program:
    """Cycloidal segments: span in deg, and displacements at both ends."""
    law = LAWS["cycloidal"]
    return Program(
        tuple(
            Segment("dwell" if a == b else "rise", math.radians(span), a, b - a, law)
            for span, a, b in rows
        )
    )


def program(lift: float) -> Program:
    return turn((110, 0.0, lift), (60, lift, lift), (120, lift, 0.0), (70, 0.0, 0.0))


def belt(*discs: tuple[complex, float]) -> Contour:
    """Round discs, counter-clockwise, with a belt round them."""
    turned = []
    for (a, r), (b, s) in pairwise([*discs, discs[0]]):
        normal = (b - a) / abs(b - a) * cmath.rect(1, -math.acos((r - s) / abs(b - a)))
        turned.append((normal, a + r * normal, b + s * normal))
    pieces: list[Arc | Line] = []
    for k, (centre, radius) in enumerate(discs):
        before, after = turned[k - 1], turned[k]
        sweep = cmath.phase(after[0] / before[0]) % math.tau
        pieces += [Arc(centre, radius, cmath.phase(before[0]), sweep), Line(after[1], after[2])]
    return Contour(tuple(pieces))


SLIPPER = belt((-10 + 4j, 4), (9 + 7j, 7), (20j, 3))
FINGER = belt((-45 - 5j, 5), (-30 - 8j, 9), (0j, 6))


def slid(outline: Contour, offset: float = 0.0) -> SlidingShoe:
    return SlidingShoe(convex_edges(outline), complex(offset), 1j).on_base(BASE)


def swung(outline: Contour) -> SwingingShoe:
    return SwingingShoe(convex_edges(outline), 60 + 0j).on_base(BASE)


def same(shoe: Follower, other: Follower, lift: float) -> None:
    """Both make the same cam, as far as its formulas go."""
    motion = program(lift)
    theta = np.linspace(0.01, 6.27, 300)
    cams = DiscCam(motion, shoe), DiscCam(motion, other)
    for order in (0, 1, 2):
        made, meant = (cam.profile(theta, order) for cam in cams)
        assert np.allclose(made, meant, rtol=0, atol=1e-9)
    assert np.allclose(cams[0].radius(theta), cams[1].radius(theta), rtol=1e-9)
    assert cams[0].outline.area == pytest.approx(cams[1].outline.area, rel=1e-12)
    assert cams[0].least_radius == pytest.approx(cams[1].least_radius, rel=1e-9)


def test_a_disc_on_a_slide_is_a_round_tip() -> None:
    tip = SlidingTip(4 + 0j, 1j, 6.0).on_base(BASE)
    shoe = slid(circle(3 + 1j, 6.0), 1.0)
    assert shoe.start + (3 + 1j) == pytest.approx(tip.start)
    same(shoe, tip, 10.0)
    angle = DiscCam(program(10.0), shoe).steepest
    assert angle == pytest.approx(DiscCam(program(10.0), tip).steepest, abs=1e-6)


def test_a_disc_on_an_arm_is_a_round_tip() -> None:
    arm = SwingingArm(60 + 0j, -50 + 0j, 6.0, 1).on_base(BASE)
    same(swung(circle(-50 + 0j, 6.0)), arm, math.radians(14))


def test_the_bottom_of_a_box_is_a_flat_face() -> None:
    corners = [-40 + 2j, 40 + 2j, 40 + 30j, -40 + 30j]
    box = Contour(tuple(Line(a, b) for a, b in pairwise([*corners, corners[0]])))
    same(slid(box), SlidingFace(BASE * 1j, 1j), 8.0)


@pytest.mark.parametrize("outline", [SLIPPER, belt((-7 + 3j, 2), (8 + 6j, 1.5), (12j, 3))])
def test_a_slipper_lies_on_its_cam_at_every_angle(outline: Contour) -> None:
    touches(DiscCam(program(12.0), slid(outline, 2.0)), outline)


def test_a_finger_lies_on_its_cam_at_every_angle() -> None:
    cam = DiscCam(program(math.radians(12)), swung(FINGER))
    touches(cam, FINGER)
    # two of its edges do, by turns
    assert len(cam.corners) == len(cam.program.corners) + 2


def test_edges_that_are_tangent_to_a_micron_make_the_same_cam() -> None:
    """As a drawing has them that was written with few digits."""
    exact = DiscCam(program(math.radians(12)), swung(FINGER))
    points = np.array([complex(each.at(each.t0)) for each in FINGER.pieces])
    bulges = [math.tan(each.sweep / 4) if isinstance(each, Arc) else 0.0 for each in FINGER.pieces]
    rounded = bulged(np.round(points, 3), np.round(bulges, 5))
    cam = DiscCam(exact.program, swung(rounded))
    assert cam.outline.area == pytest.approx(exact.outline.area, rel=1e-5)
    assert cam.undercuts == ()


def test_a_corner_touches_as_a_knife_edge() -> None:
    corners = [-8 + 2j, 0j, 8 + 3j, 20j]
    wedge = Contour(tuple(Line(a, b) for a, b in pairwise([*corners, corners[0]])))
    cam = DiscCam(program(6.0), slid(wedge, 1.0))
    touches(cam, wedge)
    assert np.any(cam.follower.own_radius(np.linspace(0, 6, 200), cam.program) == 0)


def touches(cam: DiscCam[Shoe], outline: Contour) -> None:
    """The outline where the program has it neither cuts into the cam nor stands off it."""
    rim = facet_contour(cam.outline, 1e-5)
    disc = shapely.Polygon(np.column_stack([rim.real, rim.imag]))
    shoe = facet_contour(outline, 1e-5)
    for theta in np.linspace(0, math.tau, 41):
        s = float(cam.program(theta))
        z = posed(cam.follower, shoe, s) * cmath.exp(-1j * theta)
        body = shapely.Polygon(np.column_stack([z.real, z.imag]))
        assert shapely.distance(disc, body) < 3e-5
        assert disc.intersection(body).area < 1e-3


def posed(follower: Shoe, z: Points, s: float) -> Points:
    if isinstance(follower, SlidingShoe):
        return np.asarray(follower.start + 1j * s + z)
    assert isinstance(follower, SwingingShoe)
    return np.asarray(follower.pivot + follower.turn * cmath.exp(1j * s) * z)


def test_what_a_large_sole_cannot_reach_is_an_undercut() -> None:
    """A sole of radius 80 gouges where the round tip of that radius does, and falls short by as much."""
    half = math.asin(30 / 80)
    sole = Contour(
        (
            Arc(80j, 80.0, -math.pi / 2 - half, 2 * half),
            Line(30 + (80 - 80 * math.cos(half)) * 1j, 40j),
            Line(40j, -30 + (80 - 80 * math.cos(half)) * 1j),
        )
    )
    motion = turn((40, 0.0, 12.0), (50, 12.0, 0.0), (270, 0.0, 0.0))
    cut = DiscCam(motion, slid(sole)).undercuts
    meant = DiscCam(motion, SlidingTip(1j, 1j, 80.0).on_base(BASE)).undercuts
    assert len(cut) == len(meant) == 1
    for one, other in zip(cut, meant, strict=True):
        assert one.shortfall == pytest.approx(other.shortfall, abs=1e-6)
        assert one.worst == pytest.approx(other.worst, abs=1e-3)
        assert one.shortfall > 0.1


def test_a_hollow_sole_is_refused_where_it_would_touch() -> None:
    bow = Arc(-30j, 31.0, math.pi / 2 + 0.3, -0.6)  # hollow, between two feet
    left, right = complex(bow.at(bow.t0)), complex(bow.at(bow.t1))
    arch = Contour(
        (
            bow,
            Line(right, right + 2 - 3j),
            Line(right + 2 - 3j, right + 8 + 20j),
            Line(right + 8 + 20j, left - 8 + 20j),
            Line(left - 8 + 20j, left - 2 - 3j),
            Line(left - 2 - 3j, left),
        )
    )
    with pytest.raises(DesignError) as refused:
        DiscCam(program(8.0), slid(arch)).outline  # noqa: B018
    said = str(refused.value)
    assert "geometry.follower.outline" in said and "hollow" in said and "cam angle" in said


@pytest.mark.parametrize("half", [14.5, 15.0, 20.0])
def test_a_sole_in_whose_hollow_the_base_circle_lies_is_refused(half: float) -> None:
    """A bulge of 0.3 is a hollow of 0.3 times half its chord, here of a radius above that of the base circle."""
    points = np.array([-half, half, half + 20j, -half + 20j])
    sole = bulged(points, np.array([-0.3, 0.0, 0.0, 0.0]))
    with pytest.raises(DesignError, match="hollow where the cam would touch it") as refused:
        slid(sole)
    assert refused.value.value == pytest.approx(0.3 * half)
    assert f"on its edge at (0.000, {0.3 * half:.3f}) mm" in str(refused.value).replace(
        "-0.0", "0.0"
    )


def test_an_arm_as_fast_as_its_cam_is_refused() -> None:
    motion = turn((30, 0.0, 0.4), (60, 0.4, 0.0), (270, 0.0, 0.0))
    with pytest.raises(DesignError, match="swings as fast as its cam turns"):
        DiscCam(motion, swung(FINGER)).outline  # noqa: B018
