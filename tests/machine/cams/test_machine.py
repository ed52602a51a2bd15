"""Cam, follower and what loads it: a published case, virtual work, friction's heat, pairs and grooves, springs that just hold."""

from __future__ import annotations

import math
import re
import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgen.geometry.outlines import Region, circle, polygon
from camgen.machine import Forces, solve
from camgen.machine.cams.followers import SlidingFace, SlidingTip, SwingingFace
from camgen.machine.cams.machine import CamTouch, FollowerLoad, cam_machine, loaded
from camgen.machine.cams.profile import DiscCam, SwingingArm
from camgen.machines.disc_cam.mechanism import DiscCamDrive
from camgen.motion.laws import LAWS
from camgen.motion.program import Program, Segment, uniform_swing
from camgen.parts.inertia import inertia_of
from camgen.parts.part import Layer, Part
from camgen.spec import validate

NORTON = tomllib.loads(
    (Path(__file__).resolve().parents[2] / "reference" / "disc-cam.toml").read_text()
)["spring"]
THETA = np.linspace(0, 2 * math.pi, 7201)
BLEND = math.radians(20)
CAM = DiscCam(
    uniform_swing(math.radians(30), BLEND), SwingingArm(60 + 0j, complex(-60, -30), 3.0, 1)
)
W = 2 * math.pi * 0.5
SPRING = FollowerLoad(0.0, 0.0, 0.1, 0.5)


def published(shape: dict[str, Any], **tables: dict[str, Any]) -> DiscCamDrive:
    rise, dwell, fall, rest = NORTON["spans_deg"]
    lift, law = NORTON["lift_mm"], "3-4-5"
    return validate(
        DiscCamDrive,
        {
            "mechanism": "disc-cam",
            "name": "norton",
            "geometry": {"base_radius": 60.0, "follower": {"motion": "translating", **shape}},
            "segment": [
                {"kind": "rise", "span_deg": rise, "lift": lift, "law": law},
                {"kind": "dwell", "span_deg": dwell},
                {"kind": "return", "span_deg": fall, "to": 0, "law": law},
                {"kind": "dwell", "span_deg": rest},
            ],
            "motor": {"speed_rpm": NORTON["speed_rad_s"] * 60 / math.tau},
            "load": {"mass_kg": NORTON["mass_kg"], "damping": NORTON["damping_n_s_m"] * 1e-3},
            "spring": {"rate": NORTON["rate_n_m"] * 1e-3, "preload": NORTON["preload_n"]},
            **tables,
        },
    )


def lifted() -> Program:
    """Rise 0 to 10 mm in 90 deg, dwell 45, fall in 180, dwell."""
    spans, scales, starts = (
        (math.radians(a) for a in (90, 45, 180, 45)),
        (10.0, 0.0, -10.0, 0.0),
        (0.0, 10.0, 10.0, 0.0),
    )
    return Program(
        tuple(
            Segment("", a, b, c, LAWS["3-4-5"])
            for a, b, c in zip(spans, starts, scales, strict=True)
        )
    )


def swing(
    load: FollowerLoad,
    friction: float = 0.0,
    speed: float = W,
    pair: bool = False,
    theta: np.ndarray = THETA,
) -> Forces:
    touches = (CamTouch(CAM), CamTouch(CAM, mirrored=True))[: 1 + pair]
    return solve(cam_machine([CAM], speed, load, "form", touches, friction), theta).forces()


def test_published_spring_case() -> None:
    made = published({"shape": "flat"})
    theta = np.linspace(0, 2 * math.pi, 36001)
    forces = solve(made.model, theta).forces()
    force = forces.contacts["contact"]
    np.testing.assert_allclose(
        forces.pressing["contact"], force, atol=1e-9
    )  # a flat face presses along its stem
    rise, fall = theta < math.radians(90), (theta > math.radians(135)) & (theta < math.radians(315))
    assert np.min(force[rise]) == pytest.approx(NORTON["least_rise_n"], abs=0.005)
    assert np.min(force[fall]) == pytest.approx(NORTON["least_fall_n"], abs=0.005)
    assert np.max(force) == pytest.approx(NORTON["greatest_n"], abs=0.005)
    assert np.max(forces.power_in) == pytest.approx(NORTON["peak_power_w"], abs=0.005)
    (finding,) = [f for f in made.limits() if f.code == "LIFT_OFF"]
    assert not finding.ok and finding.measured == pytest.approx(NORTON["least_rise_n"], abs=0.005)
    assert "spring.preload above 16.47 N" in finding.message
    numbers = made.study().numbers
    assert numbers["spring_preload_needed_n"] == pytest.approx(16.47, abs=0.005)
    assert numbers["peak_power_w"] == pytest.approx(NORTON["peak_power_w"], abs=0.005)
    assert numbers["peak_torque_n_m"] == pytest.approx(
        NORTON["peak_power_w"] / NORTON["speed_rad_s"], abs=5e-4
    )
    assert numbers["peak_contact_force_n"] == pytest.approx(NORTON["greatest_n"], abs=0.005)
    # [load] alone gives reactions with friction, under `reaction_shaft_n`: names tell them apart
    assert numbers["reaction_shaft_without_friction_n"] == pytest.approx(
        NORTON["greatest_n"], abs=0.005
    )
    assert not any(key.startswith("peak_reaction") for key in numbers)
    held = published(
        {"shape": "flat"},
        spring={"rate": 0.1, "preload": numbers["spring_preload_needed_n"] + 1e-6},
    )
    assert all(f.ok for f in held.limits() if f.code == "LIFT_OFF")


def test_a_spring_keeps_a_reserve_on_its_cam() -> None:
    """A spring of one force all over the turn: twice what inertia asks for leaves half of it where inertia takes most, 1.25 times
    a fifth, and 1.1 times less than 1 - 1 / 1.2, which is asked of metal; beyond that the follower leaves, which LIFT_OFF says."""
    spring = {"rate": 0.0, "preload": 1.0}
    made = published({"shape": "flat"}, spring=spring)
    needed = made.study().numbers["spring_preload_needed_n"]

    def left(share: float, **tables: Any) -> list[tuple[float, bool]]:
        preload = {**spring, "preload": share * needed}
        held = published({"shape": "flat"}, spring=preload, **tables)
        return [(round(f.measured, 3), f.ok) for f in held.limits() if f.code == "SPRING_RESERVE"]

    metal = {"material": {"name": "C45"}}
    little = pytest.approx(1 - 1 / 1.1, abs=1e-3)
    assert left(2, **metal) == [(0.5, True)]
    assert left(1.25, **metal) == [(0.2, True)]
    assert left(1.1, **metal) == [(little, False)]
    assert left(1.1) == [(little, True)]
    assert left(1.1, limits={"spring_reserve": 0.17}) == [(little, False)]
    assert left(0.9) == []


def test_the_spring_that_lift_off_asks_for_has_its_reserve() -> None:
    """A spring of one force all over the turn, of which a share r is left: 1 / (1 - r) times what inertia asks for. SPRING_RESERVE
    names what is missing of that."""
    needed = (
        published({"shape": "flat"}, spring={"preload": 1.0})
        .study()
        .numbers["spring_preload_needed_n"]
    )
    asked = needed / (1 - 0.4)

    def said(code: str, share: float, reserve: float = 0.4) -> str:
        tables = {"limits": {"spring_reserve": reserve}, "spring": {"preload": share * asked}}
        made = published({"shape": "flat"}, **tables)
        return next(each.message for each in made.limits() if each.code == code)

    assert f"a spring.preload above {asked:.4g} N" in said("LIFT_OFF", 0.5)
    assert "keeps it on, with SPRING_RESERVE" in said("LIFT_OFF", 0.5)
    assert f"a spring.preload above {needed:.4g} N" in said("LIFT_OFF", 0.5, 0.0)
    assert f"; {0.1 * asked:.3g} N more preload is enough" in said("SPRING_RESERVE", 0.9)
    assert "more preload" not in said("SPRING_RESERVE", 1.01)


def test_a_spring_that_no_wire_bears_is_no_advice() -> None:
    """Twenty times as fast takes 400 times the force; a wire of 8 mm, the thickest, bears some 1,500 N."""
    slow = published({"shape": "flat"}, spring={"preload": 1.0})
    needed = slow.study().numbers["spring_preload_needed_n"]
    speed = slow.toml().partition("speed_rpm = ")[2].partition("\n")[0]
    fast = slow.replace({"motor.speed_rpm": 20 * float(speed.split()[0])})
    assert 400 * needed > 3000
    message = next(each.message for each in fast.limits() if each.code == "LIFT_OFF")
    asked = re.search(r"only a spring.preload above (\d+) N keeps it", message)
    assert asked is not None
    # what does not grow with the speed: 1 %
    assert float(asked[1]) == pytest.approx(400 * needed, rel=0.01)
    assert "no wire of up to 8 mm bears that" in message


def test_a_roller_presses_at_its_pressure_angle() -> None:
    made = published({"shape": "roller", "radius": 8.0, "offset": 6.0})
    theta = np.linspace(0.01, 6.2, 501)
    forces = solve(made.model, theta).forces()
    steep = made.cam.pressure_angle_untrimmed(theta)
    np.testing.assert_allclose(
        forces.pressing["contact"] * np.cos(steep), forces.contacts["contact"], atol=1e-9
    )
    np.testing.assert_allclose(
        np.abs(forces.normals["guide"]),
        np.abs(forces.pressing["contact"]) * np.sin(steep),
        atol=1e-9,
    )
    # the shaft bears the whole contact force, turned back on the cam
    np.testing.assert_allclose(
        np.abs(forces.reactions["shaft"]), np.abs(forces.pressing["contact"]), atol=1e-9
    )


@pytest.mark.parametrize(
    "follower",
    [
        SlidingTip(6 + 40j, 1j, 5.0),
        SlidingFace(3 + 40j, 1j),
        SwingingArm(60 + 0j, complex(-58, -35), 6.0, 1),
        SwingingFace(60 + 0j, complex(np.exp(-0.9j)), 2.0),
    ],
)
def test_torque_is_the_virtual_work_of_any_follower(follower: Any) -> None:
    swings = isinstance(follower, SwingingArm | SwingingFace)
    program = uniform_swing(0.3, 1.0) if swings else lifted()
    cam = DiscCam(program, follower)
    load = FollowerLoad(2e-3, 1e-3, 0.1, 0.5, 0.2)
    machine = cam_machine([cam], W, load, "force")
    found = loaded(machine, cam, load, THETA)
    lift = [follower.leaves * program(THETA, order) for order in range(3)]
    unit = 1.0 if swings else 1e-3
    effort = (
        load.inertia * unit * lift[2] * W**2
        + load.damping * lift[1] * W
        + load.rate * (lift[0] - lift[0].min())
        + 0.7
    )
    np.testing.assert_allclose(found.effort, effort, atol=1e-9 * np.abs(effort).max())
    np.testing.assert_allclose(found.torque, effort * lift[1] * unit, atol=1e-9)
    arm = np.abs(follower.velocity(program(THETA), cam.profile(THETA) * np.exp(1j * THETA))) * (
        1e-3 if swings else 1.0
    )
    np.testing.assert_allclose(
        found.force, effort / (arm * np.cos(cam.pressure_angle_untrimmed(THETA))), rtol=1e-9
    )


def test_friction_turns_into_heat_where_profile_and_tip_slide() -> None:
    # The contact wanders along the profile and round the tip; the difference of both is what slides.
    mu = 0.2
    forces, free = swing(SPRING, mu), swing(SPRING)
    tangent = CAM.pitch(THETA, 1)
    tangent /= np.abs(tangent)
    normal = 1j * tangent * np.exp(1j * (THETA - CAM.program(THETA)))  # seen from the follower
    round_tip = np.gradient(np.unwrap(np.angle(normal)), THETA) * CAM.follower.tip_radius
    along = CAM.profile(THETA, 1) / tangent
    slides = np.abs(along.real - round_tip) * 1e-3
    heat = forces.drives["motor"] - free.drives["motor"]
    assert np.allclose(heat[5:-5], (mu * forces.pressing["contact"] * slides)[5:-5], rtol=1e-3)
    assert np.all(heat > 0)


def test_friction_can_jam() -> None:
    # a cam that turns counter-clockwise drags the first tip outwards, the other way it drags it into the cam
    load = FollowerLoad(preload=1.0)
    for mu, speed in ((0.3, W), (0.3, -W), (3.0, W)):
        assert np.all(np.isfinite(swing(load, mu, speed).pressing["contact"]))
    tight = loaded(cam_machine([CAM], -W, load, "force", friction=3.0), CAM, load, THETA)
    assert np.isinf(tight.force).any() and np.all(np.isinf(tight.torque) == np.isinf(tight.force))


def test_conjugate_pair_shares_the_effort() -> None:
    theta = np.concatenate(
        [
            np.linspace(BLEND, math.pi - BLEND, 999),
            np.linspace(math.pi + BLEND, 2 * math.pi - BLEND, 999),
        ]
    )
    for sign in (1.0, -1.0):
        load = FollowerLoad(preload=sign)
        forces = swing(load, pair=True, theta=theta)
        assert np.all(forces.pressing["contact"] > 0)
        assert np.allclose(forces.drives["motor"], sign * CAM.program(theta, 1), atol=1e-12)
        assert np.all(
            swing(load, 0.1, pair=True, theta=theta).drives["motor"] > forces.drives["motor"]
        )

    # the second tip's own path gives its normal, by differences
    def path(angle: np.ndarray) -> np.ndarray:
        return np.exp(-1j * angle) * (60 + complex(-60, 30) * np.exp(1j * CAM.program(angle)))

    tangent = (path(theta + 1e-5) - path(theta - 1e-5)) * np.exp(1j * theta)
    swings = 1j * complex(-60, 30) * np.exp(1j * CAM.program(theta))
    lever = np.abs(np.real(np.conj(1j * tangent / np.abs(tangent)) * swings)) * 1e-3
    assert np.allclose(
        swing(FollowerLoad(preload=-1.0), pair=True, theta=theta).pressing["contact"],
        1 / lever,
        rtol=1e-6,
    )


def test_either_wall_of_a_groove_bears() -> None:
    cam = DiscCam(lifted(), SlidingTip(6 + 40j, 1j, 5.0))
    for sign in (1.0, -1.0):
        touches = (CamTouch(cam), CamTouch(cam, outer=True))
        forces = solve(
            cam_machine([cam], W, FollowerLoad(preload=sign), touches=touches), THETA
        ).forces()
        np.testing.assert_allclose(
            forces.pressing["contact"] * np.cos(cam.pressure_angle_untrimmed(THETA)), 1.0, rtol=1e-9
        )
    one, other = CamTouch(cam)(THETA)[0], CamTouch(cam, outer=True)(THETA)[0]
    np.testing.assert_allclose((one + other) / 2, cam.pitch(THETA), atol=1e-12)


@pytest.mark.long
@settings(deadline=None, max_examples=40)
@given(st.floats(0, 20), st.floats(1, 15))
def test_springs_just_keep_contact(preload: float, speed: float) -> None:
    cam = DiscCam(lifted(), SlidingFace(40j, 1j))
    theta = np.linspace(0, 2 * math.pi, 2001)

    def at(load: FollowerLoad) -> Any:
        return loaded(cam_machine([cam], speed, load, "force"), cam, load, theta)

    load = FollowerLoad(7.5, 2.74e-3, 0.0, preload)
    tight, rate = at(load).spring_needed(load)
    if math.isinf(rate):  # too little where no spring can help: at the bottom of the lift
        found = at(load)
        assert np.min(found.effort[found.lift == 0]) <= 1e-9
    else:
        kept = float(np.min(at(replace(load, rate=rate)).effort))
        assert kept >= -1e-9 and (rate == 0 or kept == pytest.approx(0, abs=1e-9))
    low = float(np.min(at(replace(load, preload=tight)).effort))
    assert low >= -1e-9 and (tight == 0 or low == pytest.approx(0, abs=1e-9))


@pytest.mark.parametrize("make, sprung", [("cams", False), ("printed", True)])
def test_an_empty_spring_is_found_for_a_machine_and_none_of_a_cam_alone(
    make: str, sprung: bool
) -> None:
    """A machine finds its spring; of a cam alone LIFT_OFF says that none presses, without saying that nothing could hold it."""
    light = {"motor": {"speed_rpm": 60}, "load": {"mass_kg": 0.1}, "parts": {"make": make}}
    made = published({"shape": "flat"}, spring={}, **light)
    (finding,) = [f for f in made.limits() if f.code == "LIFT_OFF"]
    assert finding.ok == sprung
    if not sprung:
        assert "spring.preload and spring.rate are 0; a spring.preload above" in finding.message
        assert "As it is now, it loses contact at any speed" in finding.message


def test_a_follower_that_nothing_presses_through_a_dwell_is_not_held() -> None:
    """A spring without preload pulls with nothing where it is shortest: the force is 0 N there, and the first knock lifts it."""
    slow = {"motor": {"speed_rpm": 6}, "load": {"mass_kg": 0.1}}
    loose = published({"shape": "flat"}, **slow, spring={"rate": 1.0})
    (finding,) = [f for f in loose.limits() if f.code == "LIFT_OFF"]
    assert finding.measured == pytest.approx(0.0, abs=1e-12) and not finding.ok
    assert "no force presses" in finding.message and "spring.preload above 0 N" in finding.message
    begin = 360 - NORTON["spans_deg"][3]  # of the low dwell
    assert (
        f"from {begin:.1f} to 360.0 deg" in finding.message
        and str(finding.where) == f"cam angle {begin:.1f} deg"
    )
    assert "spring.rate" not in finding.message  # no rate presses where the spring is not stretched
    held = published({"shape": "flat"}, **slow, spring={"rate": 1.0, "preload": 0.5})
    (finding,) = [f for f in held.limits() if f.code == "LIFT_OFF"]
    assert finding.measured == pytest.approx(0.5, abs=1e-9) and finding.ok


def test_kicks_are_there_only_where_the_speed_jumps() -> None:
    load = FollowerLoad(2e-3)
    sharp = DiscCam(uniform_swing(math.radians(30)), CAM.follower)
    assert loaded(cam_machine([sharp], -W, load), sharp, load, THETA).kick == pytest.approx(
        4e-3 * W * math.radians(30) / math.pi
    )
    found = loaded(cam_machine([CAM], W, load), CAM, load, THETA)
    assert (
        found.kick == 0
        and not found.keeps_contact("").ok
        and found.keeps_contact("press on").message.endswith("press on")
    )


@pytest.mark.parametrize(
    ("tables", "path"),
    [
        ({"load": {"inertia_kg_m2": 1.0}}, "load.inertia_kg_m2"),
        ({"load": None}, "load.mass_kg"),
        ({"load": {"mass_kg": -1.0}}, "load.mass_kg"),
        ({"spring": {"rat": 1.0}}, "spring.rat"),
    ],
)
def test_loads_that_cannot_be(tables: dict[str, Any], path: str) -> None:
    from camgen.errors import SpecError

    with pytest.raises(SpecError) as refused:
        published({"shape": "flat"}, **tables)
    assert path in {fault.key for fault in refused.value.faults}


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
