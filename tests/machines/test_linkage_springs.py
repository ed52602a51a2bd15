"""[[spring]] of a linkage: what it does to torque and reactions, against energy; what is made and bought; who is refused."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from camgen.errors import DesignError, SpecError
from camgen.machine.joining import Module, joined
from camgen.machine.model import Spring
from camgen.machine.run import solve
from camgen.machines.linkage.mechanism import Linkage
from camgen.pipeline.build import build
from camgen.reading import read
from camgen.spec import validate

THETA = np.linspace(0, math.tau, 721)
POST = 120 + 20j


@pytest.fixture
def four_bar(root: Path) -> dict[str, Any]:
    """The starter, its rocker's pin drawn towards a post on the ground."""
    found = read(root / "specs" / "linkage.toml")
    found["points"]["S"] = [POST.real, POST.imag]
    found["links"]["ground"] = [*found["links"]["ground"], "S"]
    found["spring"] = [{"between": ["B", "S"], "rate": 0.3, "preload": 2.0}]
    return found


def lengths() -> np.ndarray:
    """From the pin of coupler and rocker to the post, by the two circles of a four-bar 70, 20, 60, 50."""
    a = 20 * np.exp(1j * THETA)
    d = 70 - a
    along = (60**2 - 50**2 + np.abs(d) ** 2) / (2 * np.abs(d))
    return np.abs(a + d / np.abs(d) * (along + 1j * np.sqrt(60**2 - along**2)) - POST)


def test_the_drive_gives_what_the_spring_takes(four_bar: dict[str, Any]) -> None:
    """Without masses the torque is the slope of the spring's energy; at its shortest it pulls as the preload says."""
    four_bar["masses"] = {link: {"mass_g": 0} for link in ("crank", "coupler", "rocker")}
    machine = validate(Linkage, four_bar)
    length = lengths()
    numbers = machine.study().numbers
    assert numbers["spring_least_n"] == pytest.approx(2.0, abs=1e-9)
    assert numbers["spring_greatest_n"] == pytest.approx(2.0 + 0.3 * np.ptp(length), rel=1e-5)
    free = length.min() - 2.0 / 0.3
    torque = np.gradient(0.3 * (length - free) ** 2 / 2e3, THETA)  # N mm to N m
    (found,) = solve(machine.model, THETA).forces().drives.values()
    assert np.max(np.abs(found - torque)[2:-2]) < 2e-3 * np.abs(torque).max()


def test_figures_of_a_spring_that_has_a_name_begin_with_spring(four_bar: dict[str, Any]) -> None:
    plain = validate(Linkage, four_bar).study().numbers
    for name in ("left", "spring_left"):
        four_bar["spring"][0]["name"] = name
        numbers = validate(Linkage, four_bar).study().numbers
        assert numbers[f"spring_{name}_greatest_n"] == plain["spring_greatest_n"]


def test_free_length_and_preload_say_the_same(four_bar: dict[str, Any]) -> None:
    free = validate(Linkage, four_bar).construction.springs[0].pull.free
    four_bar["spring"][0] = {"between": ["B", "S"], "rate": 0.3, "free": free}
    assert validate(Linkage, four_bar).construction.springs[0].forces()[0] == pytest.approx(
        2.0, abs=1e-9
    )


@pytest.mark.long
def test_a_machine_with_a_spring_is_built_and_holds(
    four_bar: dict[str, Any], tmp_path: Path
) -> None:
    """A post with its pin and a level for the spring, which is bought; what nothing asks for is as without it."""
    report = build(four_bar, tmp_path, frozenset({"dxf", "3mf"}))
    assert report.ok
    machine = validate(Linkage, read(tmp_path / "linkage" / "spec.toml"))
    levels = machine.layers
    assert levels["spring"] > max(levels["coupler"], levels["rocker"])
    ground = next(part for part in machine.assembly.parts if part.name == "ground")
    assert POST in dict(ground.points).values()
    (told,) = [each for each in machine.assembly.bought if each.name == "extension spring, spring"]
    assert told.standard == "EN 13906-2" and "0.3 N/mm, 2 N at" in told.size
    assert [table for table in report.tables if table.title == "Springs, between their points"]


def test_a_spring_holds_a_follower_on_its_cam() -> None:
    """What the cam needs besides is none with it."""
    rise, back = (
        {"kind": kind, "span_deg": 180, "law": "cycloidal", "lift_deg": 20}
        for kind in ("rise", "return")
    )
    cam = {"cam": "disc", "follower": "rocker", "at": "T", "radius": 5, "segment": [rise, back]}
    data: dict[str, Any] = {
        "mechanism": "linkage",
        "name": "own",
        "drive": {"link": "disc", "speed_rpm": 600},
        "points": {"O": [0, 0], "C": [60, 0], "T": [30, 35]},
        "cam": [cam],
        "links": {"ground": ["O", "C"], "disc": ["O"], "rocker": ["C", "T"]},
        "output": [{"name": "a", "link": "rocker"}],
    }
    assert validate(Linkage, data).study().numbers["hold_disc_on_rocker_n_m"] > 0
    data["points"]["S"], data["links"]["ground"] = [-60, -20], ["O", "C", "S"]
    data["spring"] = [{"between": ["T", "S"], "rate": 0.2, "preload": 6.0}]
    machine = validate(Linkage, data)
    assert machine.study().numbers["hold_disc_on_rocker_n_m"] == 0
    assert any("beyond the springs of the spec" in note for note in machine.study().notes)


def test_a_machine_with_a_spring_joins_another(four_bar: dict[str, Any]) -> None:
    own = validate(Linkage, four_bar).model
    whole = joined(own, {Module("other", 300j): own})
    (spring,) = [
        load for load in whole.loads if isinstance(load, Spring) and load.name == "other_spring"
    ]
    assert (spring.a.body, spring.b.at) == ("other_coupler", POST + 300j)
    torque = solve(own, THETA).forces().drives["drive"]
    both = sum(solve(whole, THETA).forces().drives.values())
    assert np.max(np.abs(both - 2 * torque)) < 1e-9 * np.abs(torque).max()


@pytest.mark.parametrize(
    ("change", "kind", "said"),
    [
        ({"free": 50.0}, SpecError, "spring.0 - either free or preload"),
        ({"preload": None}, SpecError, "spring.0 - either free or preload"),
        (
            {"between": ["A", "P"]},
            SpecError,
            "spring.0.between: A, P - expected points of two links: coupler carries both",
        ),
        ({"between": ["B", "X"]}, SpecError, "spring.0.between.1: 'X' - expected one of"),
        (
            {"between": ["B", "O"]},
            SpecError,
            "spring.0.between.1: 'O' - expected a point that is no shaft",
        ),
        ({"name": "coupler"}, SpecError, "spring.0.name: 'coupler' - expected a name of its own"),
        ({"name": "drive"}, SpecError, "spring.0.name: 'drive' - expected a name of its own"),
        (
            {"preload": None, "free": 70.0},
            DesignError,
            "come as near as 64.3024 mm, its free length is 70 mm, and it only pulls",
        ),
        ({"preload": 20.0}, DesignError, "free length is -2.3"),
        ({"rate": 40.0}, DesignError, "no spring of round wire has 40 N/mm"),
    ],
)
def test_springs_that_cannot_be(
    four_bar: dict[str, Any], change: dict[str, Any], kind: type[Exception], said: str
) -> None:
    spring = {**four_bar["spring"][0], **change}
    four_bar["spring"] = [{key: value for key, value in spring.items() if value is not None}]
    with pytest.raises(kind) as caught:
        _ = validate(Linkage, four_bar).assembly
    assert said in str(caught.value)


def test_a_given_level_of_a_spring_is_kept(four_bar: dict[str, Any]) -> None:
    four_bar["layers"] = {"spring": 6}
    machine = validate(Linkage, four_bar)
    assert machine.bodies.layout.level["spring"] == 6


# ---- the post of a return spring --------------------------------------------------------------------------------------

PECKER: dict[str, Any] = {
    "mechanism": "linkage",
    "name": "pecker",
    "points": {
        "O": [0, 0],
        "W": [-58, -4],
        "Tw": [-16, 24],
        "N": [58, -4],
        "Th": [16, 24],
    },
    "links": {"ground": ["O", "W", "N"], "shaft": ["O"], "wing": ["W", "Tw"], "head": ["N", "Th"]},
    "drive": {"link": "shaft", "speed_rpm": 20},
    "motor": {"model": "hand crank"},
    "cam": [
        {
            "cam": "shaft",
            "follower": follower,
            "at": tip,
            "radius": 5,
            "name": name,
            "spring": {},
            "segment": [{"to_deg": lift, "span_deg": 180}, {"to_deg": 0, "span_deg": 180}],
        }
        for follower, tip, name, lift in (("wing", "Tw", "flap", 18), ("head", "Th", "peck", 14))
    ],
    "output": [{"name": "flap", "link": "wing"}],
}


def pecker(post: tuple[float, float] | None) -> Linkage:
    """A shaft with two cams, the second one's spring on a post of its own."""
    flap, peck = PECKER["cam"]
    spring = {} if post is None else {"post": post}
    return validate(Linkage, {**PECKER, "cam": [flap, {**peck, "spring": spring}]})


@pytest.mark.long
def test_a_return_spring_that_crosses_the_shaft_is_moved_by_the_key_that_the_message_names() -> (
    None
):
    with pytest.raises(DesignError) as caught:
        _ = pecker(None).assembly.parts
    assert "return_spring_peck and shaft O cannot pass on any level" in str(caught.value)
    assert "guess: make 4" in str(caught.value)
    assert "another place for cam.1.spring.post" in str(
        caught.value
    ) and "points.peck_post" not in str(caught.value)
    moved = pecker((60, -40))
    assert moved.chain.body("ground").points["peck_post"] == 60 - 40j
    assert {"return_spring_flap", "return_spring_peck"} <= moved.bodies.layout.level.keys()


def test_a_post_that_pulls_the_follower_off_its_cam_is_refused_with_a_place_that_does_not() -> None:
    """The head turns clockwise about N as its cam lifts it; pull and way back by hand at its lowest."""
    off = 60 + 90j
    lever = (16 + 24j) - (58 - 4j)
    pull = off - (16 + 24j)
    angle = math.degrees(abs(np.angle(pull / (1j * lever))))
    assert angle > 90
    with pytest.raises(DesignError, match=r"put cam\.1\.spring\.post beyond the cam") as caught:
        _ = pecker((off.real, off.imag)).chain
    assert caught.value.value >= angle - 1e-6 and caught.value.limit == 90
    near = re.findall(r"-?[\d.]+", caught.value.remedy)[-2:]
    assert abs(np.angle((complex(*map(float, near)) - (16 + 24j)) / (1j * lever))) < 0.2


def test_one_code_is_judged_as_among_all_and_equal_cams_are_worked_out_once() -> None:
    machine = pecker((60, -40))
    (found,) = {each.code for each in machine.limits_of("LIFT_OFF")}
    assert found == "LIFT_OFF" and len(machine.limits_of("LIFT_OFF")) == 2
    for code in ("LIFT_OFF", "SPRING_RESERVE", "PRESSURE_ANGLE"):
        same = [each for each in machine.limits() if each.code == code]
        assert same and machine.limits_of(code) == same
    cams = {id(tip.cam) for tip in machine.bodies.layout.tips}
    assert {id(tip.cam) for tip in pecker((60, -40)).bodies.layout.tips} == cams
