"""Forces of a cam follower: a published case, virtual work, friction's heat, and springs that just keep contact."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgen.geometry.outlines import Region, circle, polygon
from camgen.machine.cam_forces import (
    Load,
    arm_contact,
    kicks,
    lift_of,
    lift_off,
    pair_contact,
)  # fmt: skip
from camgen.machine.cams import DiscCam, SwingingArm
from camgen.motion.laws import POLYNOMIAL_345, Floats
from camgen.motion.program import Program, Segment, uniform_swing
from camgen.parts.inertia import inertia_of
from camgen.parts.part import Layer, Part

THETA = np.linspace(0, 2 * math.pi, 7201)
BLEND = math.radians(20)
CAM = DiscCam(uniform_swing(math.radians(30), BLEND), SwingingArm(60 + 0j, complex(-60, -30), 3.0, 1))
W = 2 * math.pi * 0.5


def published() -> Program:
    """Rise 0 to 10 mm in 90 deg, dwell 45, fall in 180, dwell; 3-4-5; lengths in m."""
    spans = [math.radians(a) for a in (90, 45, 180, 45)]
    scales = (0.010, 0.0, -0.010, 0.0)
    starts = (0.0, 0.010, 0.010, 0.0)
    return Program(
        tuple(Segment("", a, b, c, POLYNOMIAL_345) for a, b, c in zip(spans, starts, scales, strict=True))
    )  # fmt: skip


def test_published_spring_case() -> None:
    # 10 rad/s, 7.5 kg, 2.74 N s/m, 100 N/m, 10 N: -6.47 N on the rise, +6.47 N on the fall, 27.76 N, 2.27 W
    theta = np.linspace(0, 2 * math.pi, 36001)
    lift = lift_of(published(), theta)
    load = Load(7.5, 2.74, 100.0, 10.0)
    force = load.effort(lift, 10.0)
    rise, fall = theta < math.radians(90), (theta > math.radians(135)) & (theta < math.radians(315))
    assert np.min(force[rise]) == pytest.approx(-6.47, abs=0.005)
    assert np.min(force[fall]) == pytest.approx(6.47, abs=0.005)
    assert np.max(force) == pytest.approx(27.76, abs=0.005)
    assert np.max(force * lift[1] * 10.0) == pytest.approx(2.27, abs=0.005)
    finding = lift_off(force, theta, "use a stronger spring")
    assert (finding.code, finding.ok) == ("LIFT_OFF", False) and "stronger spring" in finding.message
    preload = load.preload_needed(lift, 10.0)
    assert preload == pytest.approx(16.47, abs=0.005)
    assert lift_off(replace(load, preload=preload + 1e-9).effort(lift, 10.0), theta, "").ok
    assert lift_off(np.array([1.0, math.nan]), theta, "").ok is False


@given(st.floats(0, 20), st.floats(1, 15), st.floats(0, 5))
def test_springs_just_keep_contact(preload: float, speed: float, least: float) -> None:
    lift = lift_of(published(), np.linspace(0, 2 * math.pi, 2001))
    load = Load(7.5, 2.74, 0.0, preload)
    rate = load.rate_needed(lift, speed, least)
    if math.isinf(rate):  # too little where no spring can help: at the bottom of the lift
        assert np.min((load.effort(lift, speed) - least)[lift[0] == 0]) < 0
        return
    kept = float(np.min(replace(load, rate=rate).effort(lift, speed)))
    assert kept >= least - 1e-9
    if rate > 0:
        assert kept == pytest.approx(least, abs=1e-9)
    tight = load.preload_needed(lift, speed, least)
    low = float(np.min(replace(load, preload=tight).effort(lift, speed)))
    assert low >= least - 1e-9 and (tight == 0 or low == pytest.approx(least, abs=1e-9))


def nozzle_effort(load: Load) -> tuple[Floats, Floats]:
    lift = lift_of(CAM.program, THETA)
    return lift, load.effort(lift, W)


def test_torque_is_the_virtual_work() -> None:
    lift, effort = nozzle_effort(Load(2e-3, 1e-3, 0.1, 0.5))
    contact = arm_contact(CAM, THETA, effort)
    assert np.allclose(contact.torque, effort * lift[1], atol=1e-12)
    lever = abs(CAM.follower.arm) * 1e-3 * np.cos(CAM.pressure_angle(THETA))
    assert np.allclose(contact.force, effort / lever)
    # an inertia alone takes no work over a turn
    bare = arm_contact(CAM, THETA, Load(2e-3).effort(lift, W)).torque
    assert abs(np.trapezoid(bare, THETA)) < 1e-6 * np.max(np.abs(bare)) and np.max(np.abs(bare)) > 0


def test_friction_turns_into_heat_where_profile_and_tip_slide() -> None:
    # The contact wanders along the profile and round the tip; the difference of both is what slides.
    lift, effort = nozzle_effort(Load(0.0, 0.0, 0.1, 0.5))
    mu = 0.2
    contact = arm_contact(CAM, THETA, effort, mu)
    normal = 1j * CAM.tangent(THETA) * np.exp(1j * (THETA - CAM.program(THETA)))  # seen from the follower
    round_tip = np.gradient(np.unwrap(np.angle(normal)), THETA) * CAM.follower.tip_radius
    along = CAM.profile(THETA, 1) / CAM.tangent(THETA)
    slides = np.abs(along.real - round_tip) * 1e-3
    heat = contact.torque - effort * lift[1]
    assert np.allclose(heat[5:-5], (mu * contact.force * slides)[5:-5], rtol=1e-3)
    assert np.all(heat > 0)


def test_friction_can_jam() -> None:
    # a cam that turns counter-clockwise drags the first tip outwards, the other way it drags it into the cam
    effort = np.ones(THETA.shape)
    free = [arm_contact(CAM, THETA, effort, mu, sense) for mu, sense in ((0.3, 1), (0.3, -1), (3.0, 1))]
    assert all(np.all(np.isfinite(contact.force)) for contact in free)
    tight = arm_contact(CAM, THETA, effort, 3.0, -1)
    assert np.isinf(tight.force).any() and np.all(np.isinf(tight.torque) == np.isinf(tight.force))


def test_conjugate_pair_shares_the_effort() -> None:
    theta = np.concatenate([np.linspace(BLEND, math.pi - BLEND, 999), np.linspace(math.pi + BLEND, 2 * math.pi - BLEND, 999)])
    for sign in (1.0, -1.0):
        contact = pair_contact(CAM, theta, np.full(theta.shape, sign))
        assert np.all(contact.force > 0)
        assert np.allclose(contact.torque, sign * CAM.program(theta, 1), atol=1e-12)
        assert np.all(pair_contact(CAM, theta, np.full(theta.shape, sign), 0.1).torque > contact.torque)
    # the second tip's own path gives its normal, by differences
    def path(angle: Floats) -> Floats:
        return np.exp(-1j * angle) * (60 + complex(-60, 30) * np.exp(1j * CAM.program(angle)))

    tangent = (path(theta + 1e-5) - path(theta - 1e-5)) * np.exp(1j * theta)
    swings = 1j * complex(-60, 30) * np.exp(1j * CAM.program(theta))
    lever = np.abs(np.real(np.conj(1j * tangent / np.abs(tangent)) * swings)) * 1e-3
    assert np.allclose(pair_contact(CAM, theta, np.full(theta.shape, -1.0)).force, 1 / lever, rtol=1e-6)
    # in the second half turn the second tip is pushed at 39.9 to 58.3 deg  [uniform-swing cam, a tip with a radius]
    sharp = DiscCam(uniform_swing(math.radians(30)), CAM.follower)
    fall = np.linspace(math.pi + 1e-6, 2 * math.pi - 1e-6, 2000)
    force = pair_contact(sharp, fall, np.full(fall.shape, -1.0)).force
    steep = np.degrees(np.arccos(1 / (force * math.hypot(60, 30) * 1e-3)))
    assert np.min(steep) == pytest.approx(39.9, abs=0.3) and np.max(steep) == pytest.approx(58.3, abs=0.3)


def test_kicks_are_there_only_where_the_speed_jumps() -> None:
    swing = math.radians(30)
    sharp = kicks(uniform_swing(swing), 2e-3, W)
    assert sharp == pytest.approx(np.array([2, -2]) * 2e-3 * W * swing / math.pi)
    assert np.allclose(kicks(CAM.program, 2e-3, W), 0, atol=1e-15)


def test_inertia_of_a_disc_and_of_a_bar_with_a_hole() -> None:
    disc = Part("", "", (Layer(Region(circle(0j, 20)), 0.0, 5.0),))
    mass = 1240 * math.pi * 0.02**2 * 0.005
    assert inertia_of(disc, 1240) == pytest.approx(mass * 0.02**2 / 2, rel=2e-3)
    bar = Region(polygon([0j, 60 + 0j, 60 + 10j, 10j]), (circle(50 + 5j, 3),))
    pocket = Layer(Region(circle(20 + 5j, 2)), 5.0, 6.0)
    hole = math.pi * 9 * (2525 + 4.5) * 6 + math.pi * 4 * (425 + 2) * 1
    whole = 600 * (3600 + 100) / 3 * 6
    made = Part("", "", (Layer(bar, 0.0, 6.0),), engraved=(pocket,))
    assert inertia_of(made, 1000) == pytest.approx((whole - hole) * 1e-12, rel=2e-3)
