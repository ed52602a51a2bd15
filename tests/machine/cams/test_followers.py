"""Sliding and flat followers: envelopes against fits of the curve itself, published answers, undercut, grooves, sizes."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from numpy.polynomial.chebyshev import Chebyshev

from camgen.errors import DesignError
from camgen.geometry.outlines import Arc, Line, Smooth
from camgen.machine.cams.followers import (
    Follower,
    SlidingFace,
    SlidingTip,
    SwingingArm,
    SwingingFace,
)
from camgen.machine.cams.limits import CamLimits
from camgen.machine.cams.profile import DiscCam
from camgen.machine.cams.sizing import largest, least_base_radius, smallest, survey
from camgen.motion.laws import LAWS, UNIFORM
from camgen.motion.program import Program, Segment

QUARTER = math.pi / 2
TURN = np.linspace(0.01, 6.27, 1201)


def double_dwell(law: str, lift: float = 1.0) -> Program:
    """Norton's running example: dwell, rise, dwell, fall, 90 deg each."""
    made = LAWS[law]
    return Program(
        (
            Segment("dwell", QUARTER, 0.0, 0.0, UNIFORM),
            Segment("rise", QUARTER, 0.0, lift, made),
            Segment("dwell", QUARTER, lift, 0.0, UNIFORM),
            Segment("return", QUARTER, lift, -lift, made),
        )
    )


def there_and_back(law: str, lift: float) -> Program:
    made = LAWS[law]
    return Program(
        (Segment("rise", math.pi, 0.0, lift, made), Segment("return", math.pi, lift, -lift, made))
    )


FOLLOWERS: list[Follower] = [
    SlidingTip(3 + 20j, 1j, 4.0),
    SlidingTip(3 - 20j, 1j, 4.0, -1),
    SlidingTip(20 + 3j, 1 + 0j, 0.0),
    SlidingFace(3 + 20j, 1j),
    SlidingFace(3 - 20j, 1j, -1),
    SwingingFace(60 + 0j, np.exp(-1.3j), 5.0),
    SwingingFace(60j, 1j * np.exp(1.0j), -2.0),
    SwingingArm(60 + 0j, -58 - 20j, 3.0, 1),
]


def fitted(cam: DiscCam, middle: float) -> tuple[Chebyshev, Chebyshev]:
    x = middle + 0.1 * np.cos(np.pi * (np.arange(24) + 0.5) / 24)
    z = cam.profile(x)
    return Chebyshev.fit(x, z.real, 23), Chebyshev.fit(x, z.imag, 23)


@pytest.mark.parametrize("follower", FOLLOWERS, ids=lambda f: f"{type(f).__name__}{f.leaves:+d}")
@pytest.mark.parametrize("middle", [0.7, 2.0, 4.0])
def test_envelope_derivatives_and_curvature(follower: Follower, middle: float) -> None:
    """By polynomials fitted through the curve; curvature from their derivatives."""
    cam = DiscCam(there_and_back("3-4-5", 0.3), follower)
    x, y = fitted(cam, middle)
    d1, d2 = (complex(x.deriv(k)(middle), y.deriv(k)(middle)) for k in (1, 2))
    at = np.asarray(middle)
    assert abs(complex(cam.profile(at, 1)) - d1) < 1e-9
    assert abs(complex(cam.profile(at, 2)) - d2) < 1e-7
    assert float(cam.radius(at)) == pytest.approx(
        -(abs(d1) ** 3) / (d1.conjugate() * d2).imag, rel=1e-8
    )


@pytest.mark.parametrize(
    "follower",
    [f for f in FOLLOWERS if getattr(f, "tip_radius", 1)],
    ids=lambda f: f"{type(f).__name__}{f.leaves:+d}",
)
def test_the_follower_touches_its_envelope_and_leaves_it(follower: Follower) -> None:
    """The outline, turned, is touched where the follower is: no point of it lies deeper, one lies on it."""
    cam = DiscCam(there_and_back("3-4-5", 0.3), follower)
    z = cam.profile(np.linspace(0, 2 * math.pi, 4001))
    for theta in (0.3, 1.7, 3.9, 5.5):
        ground = z * np.exp(1j * theta)
        s = follower.resting_on(ground)
        furthest = np.nanmax(follower.leaves * s)
        assert furthest == pytest.approx(follower.leaves * float(cam.program(theta)), abs=2e-5)
        own = complex(cam.profile(np.asarray(theta))) * np.exp(1j * theta)
        assert float(follower.resting_on(own)) == pytest.approx(
            float(cam.program(theta)), abs=1e-12
        )


def test_cycloidal_cam_with_a_radial_roller() -> None:
    """Norton: roller 0.5 in, 30 deg: prime radius 1.75094, base 1.25094, least pitch radius of curvature 1.39411 in."""
    program = double_dwell("cycloidal")
    prime = smallest(
        lambda d: DiscCam(program, SlidingTip(1j * d, 1j, 0.5)), math.radians(30), 0.0, 0.6, 100.0
    )
    cam = DiscCam(program, SlidingTip(1j * prime, 1j, 0.5))
    assert prime == pytest.approx(1.75094, abs=5e-6) and prime - 0.5 == pytest.approx(
        1.25094, abs=5e-6
    )
    assert cam.least_radius + 0.5 == pytest.approx(1.39411, abs=5e-6)
    assert math.degrees(cam.greatest(cam.pressure_angle)[1]) == pytest.approx(30, abs=1e-9)
    # the same from the closed form in line: tan = s' / (prime + s)
    theta = np.linspace(QUARTER, 2 * QUARTER, 200_001)
    assert prime == pytest.approx(
        float(np.max(program(theta, 1) / math.tan(math.radians(30)) - program(theta))), abs=1e-9
    )


def test_cycloidal_cam_with_a_flat_face() -> None:
    """Norton: least radius of curvature 0.25 in: base 1.89263 in, face width 2.54648 in (8 / pi)."""
    program = double_dwell("cycloidal")
    base = smallest(
        lambda d: DiscCam(program, SlidingFace(1j * d, 1j)), math.radians(30), 0.25, 0.6, 100.0
    )
    cam = DiscCam(program, SlidingFace(1j * base, 1j))
    assert base == pytest.approx(1.89263, abs=5e-6)
    assert cam.least_radius == pytest.approx(0.25, abs=1e-9)
    places = cam.follower.place(program(TURN), cam.profile(TURN) * np.exp(1j * TURN))
    assert np.ptp(places) == pytest.approx(8 / math.pi, abs=1e-4)
    assert not cam.undercuts and np.max(cam.pressure_angle(TURN)) < 1e-15


@pytest.mark.parametrize("offset", [0.0, 0.7, -3.0])
def test_harmonic_flat_faced_cam_is_a_circle(offset: float) -> None:
    """Uicker, Pennock, Shigley: 2 in over 180 deg and back, prime radius 1.5 in: 2.5 in everywhere, 1.0 in off centre."""
    cam = DiscCam(there_and_back("simple-harmonic", 2.0), SlidingFace(offset + 1.5j, 1j))
    np.testing.assert_allclose(cam.radius(TURN), 2.5, rtol=1e-13)
    np.testing.assert_allclose(np.abs(cam.profile(TURN) + 1j), 2.5, rtol=1e-13)
    assert cam.outline.area == pytest.approx(math.pi * 2.5**2, rel=1e-12)


def test_offset_towards_the_rise_lowers_its_pressure_angle() -> None:
    """tan = (s' - e) / (sqrt(Rp^2 - e^2) + s), by hand."""
    program, e = double_dwell("cycloidal", 10.0), 3.0
    cam = DiscCam(program, SlidingTip(e + 1j * math.sqrt(30**2 - e**2), 1j, 4.0))
    s, speed = program(TURN), program(TURN, 1)
    expected = np.arctan(np.abs(speed - e) / (math.sqrt(30**2 - e**2) + s))
    np.testing.assert_allclose(cam.pressure_angle(TURN), expected, atol=1e-12)


def test_flat_face_undercut_rides_on_the_corner() -> None:
    """Where s + s'' is below -base the face rides on a corner, up to the undercut's ends; the rest is followed."""
    program = double_dwell("cycloidal", 12.0)
    cam = DiscCam(program, SlidingFace(14j, 1j))
    assert cam.radius(TURN).min() < 0 and cam.undercuts
    polygon = np.concatenate([p.at(np.linspace(p.t0, p.t1, 4000)) for p in cam.outline.pieces])
    theta = np.linspace(0, 2 * math.pi, 301) + 0.0123
    support = np.max(np.imag(polygon[None] * np.exp(1j * theta[:, None])), axis=1) - 14
    np.testing.assert_allclose(cam.reachable(theta), support, atol=2e-5)
    assert np.max(program(theta) - cam.reachable(theta)) == pytest.approx(
        max(c.shortfall for c in cam.undercuts), rel=1e-2
    )
    for cut in cam.undercuts:
        ends = np.array([cut.begin, cut.end])
        np.testing.assert_allclose(
            cam.follower.resting_on(cut.corner_cam * np.exp(1j * ends)), program(ends), atol=1e-9
        )


def test_a_sharp_start_gives_a_flat_on_the_cam_and_an_arc_under_a_roller() -> None:
    """Uniform rise and return: where the speed jumps up the follower's own surface is the profile."""
    program = there_and_back("uniform", 6.0)
    flat, rolled = (
        DiscCam(program, f).outline for f in (SlidingFace(25j, 1j), SlidingTip(25j, 1j, 3.0))
    )
    (line,) = [p for p in flat.pieces if isinstance(p, Line)]
    assert abs(line.b - line.a) == pytest.approx(
        2 * 6 / math.pi, abs=1e-9
    )  # place on the face = s'
    (arc,) = [p for p in rolled.pieces if isinstance(p, Arc)]
    assert arc.radius == 3 and arc.centre == pytest.approx(25j, abs=1e-12)


@pytest.mark.parametrize("law", ["parabolic", "modified-trapezoid", "modified-sine", "4-5-6-7"])
def test_pieces_end_where_the_law_breaks(law: str) -> None:
    """No piece has a jump of curvature inside; dwells are exact arcs; a parabolic rise has a break in its middle."""
    program = double_dwell(law, 10.0)
    outline = DiscCam(program, SlidingTip(30j, 1j, 5.0)).outline
    assert sum(isinstance(p, Arc) for p in outline.pieces) == 2
    assert len(outline.pieces) == len(program.breaks) - 1
    for piece in outline.pieces:
        if isinstance(piece, Smooth):
            t = np.linspace(piece.t0, piece.t1, 20001)
            d1, d2 = piece.at(t, 1), piece.at(t, 2)
            kappa = np.imag(np.conj(d1) * d2) / np.abs(d1) ** 3
            assert np.max(np.abs(np.diff(kappa))) < 1e-3 * (1 + np.max(np.abs(kappa)))
    for a, b in pairwise(outline.pieces):
        assert abs(a.at(a.t1) - b.at(b.t0)) < 1e-9


def test_groove_walls_are_two_radii_apart() -> None:
    cam = DiscCam(double_dwell("cycloidal", 10.0), SlidingTip(30j, 1j, 5.0))
    inner = np.concatenate([p.at(np.linspace(p.t0, p.t1, 3000)) for p in cam.outline.pieces])
    wall = cam.groove()
    outer = np.concatenate([p.at(np.linspace(p.t0, p.t1, 400)) for p in wall.pieces])
    near = np.min(np.abs(outer[:, None] - inner[None]), axis=1)
    np.testing.assert_allclose(near, 10.0, atol=2e-4)
    # Steiner: the area between parallel curves is their distance times the length half way
    middle = sum(
        np.sum(np.abs(np.diff(cam.pitch(np.linspace(a, b, 4001)))))
        for a, b in pairwise(cam.program.breaks)
    )
    assert wall.area - cam.outline.area == pytest.approx(10.0 * middle, rel=1e-6)


def test_a_groove_whose_wall_is_undercut_is_told() -> None:
    cam = DiscCam(double_dwell("cycloidal", 30.0), SlidingTip(16j, 1j, 12.0))
    with pytest.raises(DesignError, match="smaller tip"):
        cam.groove()


@pytest.mark.parametrize("follower", [SlidingFace(-0.5j, 1j), SlidingTip(3j, 1j, 4.0)])
def test_a_follower_that_reaches_the_axis_is_told(follower: Follower) -> None:
    with pytest.raises(DesignError, match="axis"):
        _ = DiscCam(double_dwell("cycloidal"), follower).outline


def test_no_size_keeps_to_the_limits() -> None:
    program = double_dwell("cycloidal", 10.0)
    with pytest.raises(DesignError, match="no base_radius"):
        smallest(
            lambda d: DiscCam(program, SlidingTip(1j * d, 1j, 5.0)), math.radians(5), 0.0, 6.0, 20.0
        )


def test_no_cam_is_sought_that_is_larger_than_a_workshop() -> None:
    """At 0.05 deg a rise of 10 mm in 90 deg asks for ten metres."""
    cam = DiscCam(double_dwell("cycloidal", 10.0), SlidingTip(30j, 1j, 5.0))
    limits = CamLimits(pressure_angle=0.05)
    with pytest.raises(DesignError, match="looked for, 500 mm.*no base_radius"):
        least_base_radius(cam, limits, 5.0)
    assert largest(12.0) == 500.0
    assert largest(80.0) == 800.0  # ten strokes


def test_an_arm_whose_pivot_is_all_but_on_the_axis_leaves_no_base_radius() -> None:
    """Its roller goes round at about the arm's length from the axis, whatever the base radius."""
    arm = SwingingArm(0.001 + 0j, 40j, 4.0, 1)
    cam = DiscCam(double_dwell("cycloidal", 0.2), arm)
    with pytest.raises(DesignError, match="no base_radius to choose"):
        least_base_radius(cam, CamLimits(), 5.0)


def test_a_flat_face_has_no_pitch_curve() -> None:
    with pytest.raises(TypeError):
        DiscCam(double_dwell("cycloidal"), SlidingFace(10j, 1j)).pitch(0.0)


@pytest.mark.parametrize("law", ["cycloidal", "modified-sine", "simple-harmonic", "parabolic"])
@pytest.mark.parametrize(
    "follower", [SlidingTip(2 + 30j, 1j, 5.0), SlidingFace(40j, 1j), SlidingTip(20j, 1j, 4.0)]
)
def test_a_survey_agrees_with_the_exact_extremes(law: str, follower: Follower) -> None:
    cam = DiscCam(double_dwell(law, 9.0), follower)
    found = survey(cam)
    assert math.degrees(abs(found.pressure - cam.greatest(cam.pressure_angle_untrimmed)[1])) < 5e-3
    assert found.least_radius == pytest.approx(cam.least_radius, abs=0.02)
    assert found.clear == pytest.approx(
        -cam.greatest(lambda t: -follower.clear(t, cam.program))[1], abs=1e-6
    )
