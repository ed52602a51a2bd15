"""Pitch curve, profile, pressure angle and undercut, against mpmath, the paper's steps and cited facts."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path
from typing import Any, cast

import mpmath
import numpy as np
import pytest

from camgen.errors import DesignError
from camgen.machine.cams.profile import DiscCam, SwingingArm, _continuation
from camgen.motion.laws import UNIFORM
from camgen.motion.program import Program, Segment, uniform_swing

FACTS = tomllib.loads(
    (Path(__file__).resolve().parents[2] / "reference" / "uniform_swing.toml").read_text()
)
L = FACTS["machine"]["pivot_distance"]
H = FACTS["machine"]["arm_offset"]
DELTA, RHO = math.radians(FACTS["machine"]["swing_deg"]) / 2, FACTS["machine"]["tip_radius"]
R, K = math.hypot(L, H), math.pi / (2 * DELTA)
TURN = np.linspace(0, 2 * math.pi, 3601)[1:-1]
RISE = TURN[TURN < math.pi - 1e-9]
RETURN = TURN[TURN > math.pi + 1e-9]


def cam(
    rho: float = RHO,
    blend: float = 0.0,
    length: float = L,
    offset: float = H,
    swing: float = 2 * DELTA,
) -> DiscCam:
    return DiscCam(
        uniform_swing(swing, blend), SwingingArm(complex(length), -complex(length, offset), rho, 1)
    )


def exact_pitch(theta: mpmath.mpf) -> mpmath.mpc:
    """The source's geometry in mpmath: tip C(alpha), turned back by the cam's angle."""
    lever, offset = mpmath.mpf(L), mpmath.mpf(H)
    delta = mpmath.mpf(FACTS["machine"]["swing_deg"]) * mpmath.pi / 360
    share = theta / mpmath.pi
    alpha = mpmath.atan2(offset, lever) + delta * (2 * share - 1 if share <= 1 else 3 - 2 * share)
    arm = mpmath.sqrt(lever**2 + offset**2)
    return mpmath.mpc(lever - arm * mpmath.cos(alpha), -arm * mpmath.sin(alpha)) * mpmath.exp(
        1j * -theta
    )


def exact_profile(theta: mpmath.mpf) -> mpmath.mpc:
    slope = mpmath.diff(exact_pitch, theta, h=mpmath.mpf(10) ** -15)
    return exact_pitch(theta) - 1j * RHO * slope / abs(slope)


@pytest.mark.parametrize("theta", [0.02, 0.9, 2.2, 3.05, 3.3, 4.4, 6.2])
def test_pitch_and_profile_derivatives(theta: float) -> None:
    mpmath.mp.dps = 50
    made = cam()
    for order in range(4):
        truth = mpmath.diff(exact_pitch, mpmath.mpf(theta), order, h=mpmath.mpf(10) ** -12)
        assert abs(complex(made.pitch(theta, order)) - complex(truth)) < 1e-12
    for order in range(3):
        truth = mpmath.diff(exact_profile, mpmath.mpf(theta), order, h=mpmath.mpf(10) ** -10)
        assert abs(complex(made.profile(theta, order)) - complex(truth)) < 1e-11


def test_blended_derivatives_are_those_of_the_curve() -> None:
    """In the reversal, where s has all its derivatives: complex polynomial fitted through the curve itself."""
    made = cam(blend=0.8)
    x = np.cos(np.pi * (np.arange(24) + 0.5) / 24)
    for middle in (0.1, 3.0, 3.4, 1.5):
        fit = np.polynomial.chebyshev.Chebyshev.fit(
            middle + 0.05 * x, made.pitch(middle + 0.05 * x).real, 23
        )
        imag = np.polynomial.chebyshev.Chebyshev.fit(
            middle + 0.05 * x, made.pitch(middle + 0.05 * x).imag, 23
        )
        for order, tolerance in ((1, 1e-9), (2, 1e-6), (3, 1e-3)):
            truth = fit.deriv(order)(middle) + 1j * imag.deriv(order)(middle)
            assert abs(complex(made.pitch(middle, order)) - truth) < tolerance


def by_steps(sign: float) -> np.ndarray:
    """The paper's recursion: in each step the held cam's world (pivot A, tip C) is turned back about O and C about A.

    sign: of `x sin` in the y rows; -1 is a rotation, +1 as printed in equations 7, 8 and 11. Returns both half turns.
    """
    n = FACTS["erratum"]["steps_per_half_turn"]
    d = math.pi / n
    middle = math.acos(L / R)
    halves = []
    for alpha, a, first in ((middle - DELTA, -d / K, True), (middle + DELTA, d / K, False)):
        r = math.sqrt(L**2 + R**2 - 2 * L * R * math.cos(alpha))
        beta = math.acos(R / r * math.sin(alpha)) * math.copysign(1, R * math.cos(alpha) - L)
        xa, ya = (L, 0.0) if first else (-L, 0.0)
        xc, yc = (
            (-r * math.sin(beta), -r * math.cos(beta))
            if first
            else (r * math.sin(beta), r * math.cos(beta))
        )
        path = [complex(xc, yc)]
        for _ in range(n):
            xc, yc = xc * math.cos(d) + yc * math.sin(d), yc * math.cos(d) + sign * xc * math.sin(d)
            xa, ya = xa * math.cos(d) + ya * math.sin(d), ya * math.cos(d) + sign * xa * math.sin(d)
            dx, dy = xc - xa, yc - ya
            xc, yc = (
                xa + dx * math.cos(a) + dy * math.sin(a),
                ya + dy * math.cos(a) + sign * dx * math.sin(a),
            )
            path.append(complex(xc, yc))
        halves.append(path)
    return np.array(halves)


def test_steps_of_the_source() -> None:
    made = cam()
    theta = np.linspace(0, math.pi, FACTS["erratum"]["steps_per_half_turn"] + 1)
    closed = np.array([made.pitch(theta), made.pitch(theta + math.pi)])
    right, printed = by_steps(-1), by_steps(+1)
    assert np.max(np.abs(right - closed)) < FACTS["erratum"]["agreement_mm"]
    assert np.max(np.abs(printed - closed)) > 10
    # the step's matrix as printed is not a rotation: determinant cos 2 phi
    assert np.max(np.abs(np.abs(printed[0]) - np.abs(closed[0]))) > 1


def test_conjugate_is_the_same_cam_turned_over() -> None:
    """The second tip's path in the cam's frame is the mirror image in Oy of P(pi - theta)."""
    made = cam()
    second = L + made.follower.arm.conjugate() * np.exp(1j * made.program(TURN))
    mirrored = -np.conj(made.pitch(math.pi - TURN))
    assert np.max(np.abs(second * np.exp(-1j * TURN) - mirrored)) < 1e-13
    assert np.max(np.abs(second * np.exp(-1j * TURN) + np.conj(made.pitch(TURN)))) > 1


def test_pitch_curve_facts() -> None:
    made, facts = cam(), FACTS["pitch_curve"]
    radius = np.abs(made.pitch(np.linspace(0, 2 * math.pi, 7201)))
    assert [np.min(radius), np.max(radius)] == pytest.approx(facts["radius_mm"], abs=0.005)
    ends = np.linspace(1e-12, math.pi - 1e-12, 2001)
    rise, back = (1 / np.max(made.curvature(half)) for half in (ends, ends + math.pi))
    assert made.least_radius + made.tip.tip_radius == pytest.approx(min(rise, back), rel=1e-8)
    assert rise == pytest.approx(facts["curvature_radius_rise_mm"], abs=0.005)
    assert back == pytest.approx(facts["curvature_radius_return_mm"], abs=0.005)
    for at, expected, sense in ((math.pi, "corner_convex_deg", -1), (0.0, "corner_concave_deg", 1)):
        after, before = (complex(made.pitch(at + step, 1)) for step in (1e-12, -1e-12))
        turn = np.angle(after / before)
        # the curve runs clockwise: a left turn is concave
        assert sense * np.degrees(turn) == pytest.approx(facts[expected], abs=0.05)


def test_pressure_angles() -> None:
    """From the definition, by finite differences of the curve as the ground sees it; and the cited ranges."""
    facts, knife = FACTS["pressure_angle"], cam(rho=0.0)
    for half, key in ((RISE, "rise_deg"), (RETURN, "return_deg")):
        step = 1e-6
        chord = knife.pitch(half + step) - knife.pitch(half - step)
        velocity = 1j * knife.follower.arm * np.exp(1j * (knife.program(half) - half))
        square = np.degrees(
            np.arccos(np.abs(np.imag(chord * np.conj(velocity))) / np.abs(chord) / np.abs(velocity))
        )
        angle = np.degrees(knife.pressure_angle(half))
        np.testing.assert_allclose(angle, square, atol=2e-6)
        assert [np.min(angle), np.max(angle)] == pytest.approx(facts[key], abs=0.06)
    assert math.degrees(math.atan2(H, L)) == pytest.approx(facts["tilt_deg"], abs=0.05)


def test_undercut_against_40_digits() -> None:
    mpmath.mp.dps = 40
    facts = FACTS["undercut"]
    pi = mpmath.pi

    def branch(theta: mpmath.mpf, half: int) -> mpmath.mpc:
        delta = mpmath.mpf(15) * pi / 180
        alpha = mpmath.atan2(H, L) + delta * (
            2 * theta / pi - 1 if half == 1 else 3 - 2 * theta / pi
        )
        rate = (1 if half == 1 else -1) * 2 * delta / pi
        arm = mpmath.sqrt(L**2 + H**2) * mpmath.exp(1j * alpha)
        slope = (-1j * rate * arm - 1j * (L - arm)) * mpmath.exp(1j * -theta)
        return (L - arm) * mpmath.exp(1j * -theta) - 1j * RHO * slope / abs(slope)

    def apart(t: mpmath.mpf, u: mpmath.mpf) -> list[mpmath.mpf]:
        z = branch(t, 1) - branch(u, 2)
        return [z.real, z.imag]

    begin, end = mpmath.findroot(apart, (mpmath.mpf("3.1246"), mpmath.mpf("3.1551")))
    corner = branch(begin, 1)
    spoke = (corner * mpmath.exp(1j * pi) - L) / (-mpmath.mpc(L, H))
    opening = mpmath.acos(
        (1 + abs(spoke) ** 2 - (mpmath.mpf(RHO) ** 2 / (L**2 + H**2))) / (2 * abs(spoke))
    )
    lost = 15 - mpmath.degrees(mpmath.arg(spoke) + opening)

    (cut,) = cam().undercuts
    assert float(mpmath.degrees(begin)) == pytest.approx(facts["begin_deg"], abs=1e-8)
    assert float(mpmath.degrees(end)) == pytest.approx(facts["end_deg"], abs=1e-7)
    assert complex(corner) == pytest.approx(complex(*facts["corner_cam_mm"]), abs=1e-11)
    assert abs(float(lost)) == pytest.approx(facts["shortfall_deg"], abs=1e-15)
    assert abs(float(lost)) != pytest.approx(facts["rejected_shortfall_deg"], abs=1e-5)

    assert (cut.begin, cut.end) == pytest.approx((float(begin), float(end)), abs=1e-12)
    assert cut.corner_cam == pytest.approx(complex(corner), abs=1e-12)
    assert math.degrees(cut.shortfall) == pytest.approx(abs(float(lost)), abs=1e-11)
    assert math.degrees(cut.worst) == pytest.approx(facts["worst_deg"], abs=1e-6)
    assert cut.depth == pytest.approx(facts["depth_mm"], abs=5e-8)


def test_the_slope_of_what_is_reachable_is_that_of_its_values() -> None:
    made = cam()
    (cut,) = made.undercuts
    theta = np.linspace(cut.begin, cut.end, 41)[1:-1]
    theta = np.concatenate([theta, theta + 1.0])
    step = 1e-5
    slope = (made.reachable(theta + step) - made.reachable(theta - step)) / (2 * step)
    np.testing.assert_allclose(made.reachable(theta, 1), slope, atol=1e-8)
    assert np.isnan(made.reachable(theta, 2)).tolist() == [True] * 39 + [False] * 39


def test_reachable_joins_the_program() -> None:
    made = cam()
    (cut,) = made.undercuts
    free = TURN[(cut.begin > TURN) | (cut.end < TURN)]
    assert np.array_equal(made.reachable(free), made.program(free))
    ends = np.array([cut.begin + 1e-13, cut.end - 1e-13])
    np.testing.assert_allclose(made.reachable(ends), made.program(ends), atol=1e-12)
    inside = np.linspace(cut.begin, cut.end, 99)[1:-1]
    assert np.all(made.reachable(inside) < made.program(inside))
    assert all(made.riding(t) for t in inside) and not any(made.riding(t) for t in free[::100])


def test_fillet_at_the_concave_corner_is_the_tip() -> None:
    made = cam()
    turn = math.radians(FACTS["pitch_curve"]["corner_concave_deg"])
    fillets = [p for p in made.outline.pieces if type(p).__name__ == "Arc"]
    assert len(fillets) == 1 and fillets[0].radius == RHO
    assert fillets[0].centre == pytest.approx(complex(made.pitch(0.0)), abs=1e-12)
    assert abs(fillets[0].sweep) == pytest.approx(turn, abs=1e-3)


def test_knife_edge_is_the_pitch_curve() -> None:
    made = cam(rho=0.0)
    assert not made.undercuts
    assert np.array_equal(made.profile(TURN), made.pitch(TURN))

    # Green's theorem on a fine polygon, corrected by Richardson
    def polygon(n: int) -> float:
        z = made.pitch(np.linspace(0, 2 * math.pi, n, endpoint=False))
        return abs(float(np.sum(np.imag(np.conj(z) * np.roll(z, -1)))) / 2)

    assert made.outline.area == pytest.approx((4 * polygon(8000) - polygon(4000)) / 3, rel=1e-10)


def test_a_motion_that_is_asked_from_two_sides_answers_each() -> None:
    """Another thread asks for other angles while the law works."""
    angles = np.array([0.5])
    others = np.array([1.5])

    def law(u: np.ndarray, order: int) -> np.ndarray:
        if u[0] == 0.25:
            assert motion(others, 0) == 0.75
        return u

    motion = _continuation(Segment("rise", 2.0, 0.0, 1.0, cast(Any, law)), 0.0, 0.0, 2.0)
    assert motion(angles, 0) == 0.25
    assert motion(others, 0) == 0.75
    angles[0] = 1.0
    assert motion(angles, 0) == 0.5


def test_resting_follower_makes_a_circle() -> None:
    """No motion: pitch circle |C|, cam circle |C| - rho, pressure angle that of the fixed arm."""
    still = Program(
        (Segment("dwell", math.pi, 0.0, 0.0, UNIFORM), Segment("dwell", math.pi, 0.0, 0.0, UNIFORM))
    )
    made = DiscCam(still, SwingingArm(60 + 0j, -60 - 30j, 3.0, 1))
    np.testing.assert_allclose(np.abs(made.pitch(TURN)), 30, rtol=1e-14)
    np.testing.assert_allclose(np.abs(made.profile(TURN)), 27, rtol=1e-14)
    np.testing.assert_allclose(made.curvature(TURN), 1 / 30, rtol=1e-13)
    np.testing.assert_allclose(made.pressure_angle(TURN), math.atan2(30, 60), rtol=1e-12)
    assert made.outline.area == pytest.approx(math.pi * 27**2, rel=1e-13)
    assert made.outline.length == pytest.approx(2 * math.pi * 27, rel=1e-13)


def test_resting_on_a_point_is_the_law_of_cosines() -> None:
    arm = SwingingArm(60 + 0j, -60 - 30j, 3.0, 1)
    for point in (-1 - 28j, 2 - 27.5j, -1.5 - 31j):
        for leaves in (1, -1):
            s = float(SwingingArm(arm.pivot, arm.arm, 3.0, leaves).resting_on(point))
            assert abs(complex(arm.trace(s)) - point) == pytest.approx(3.0, abs=1e-13)
            assert abs(complex(arm.trace(s + leaves * 0.01)) - point) > 3.0
    assert math.isnan(float(arm.resting_on(60 + 1j)))


@pytest.mark.parametrize("rho", [14.62, 20.0, 25.0, 45.0, 100.0, 1e6])
def test_tip_that_reaches_the_axis(rho: float) -> None:
    with pytest.raises(DesignError) as caught:
        _ = cam(rho=rho).outline
    error = caught.value
    assert (error.quantity, error.value, error.unit) == ("tip_radius", rho, "mm")
    assert error.limit == pytest.approx(FACTS["pitch_curve"]["radius_mm"][0], abs=0.005)
    assert "cam angle" in error.where and "smaller" in error.remedy
