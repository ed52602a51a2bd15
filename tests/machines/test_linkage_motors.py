"""Several motors of one linkage: a five-bar against its two circles, by a route of the tests' own; parts for each motor."""

from __future__ import annotations

import copy
import math
import tomllib
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import camgen
from camgen import starters
from camgen.errors import DesignError, SpecError
from camgen.machines.linkage.mechanism import Linkage
from camgen.machines.loads.assess import assess
from camgen.spec import validate

Tables = dict[str, Any]
O, C, ARM, ROD = -35 + 0j, 35 + 0j, 50.0, 80.0  # noqa: E741
LAW = {"law": "cycloidal"}


def tables() -> Tables:
    return tomllib.loads(starters.text("five-bar"))


def cycloid(u: np.ndarray) -> np.ndarray:
    return u - np.sin(math.tau * u) / math.tau


def swung(theta: np.ndarray, peak: float) -> np.ndarray:
    """Out by a cycloid in the first half of the period, back by one in the second, rad."""
    u = theta / math.pi
    return math.radians(peak) * np.where(u < 1, cycloid(u), 1 - cycloid(u - 1))


def apex(a: np.ndarray, b: np.ndarray, radius: float) -> np.ndarray:
    """Where circles of one radius about a and b meet, left of the way from b to a's mirror image: above, as drawn."""
    half = (b - a) / 2
    height = np.sqrt(radius**2 - np.abs(half) ** 2)
    return (a + b) / 2 + 1j * half / np.abs(half) * height


def swinging(left: float, right: float) -> Tables:
    """The five-bar of the gallery with both arms there and back, deg."""
    spec = tables()
    for drive, peak in zip(spec["drive"], (left, right), strict=True):
        drive["segment"] = [
            {"span_deg": 180, "to_deg": peak, **LAW},
            {"span_deg": 180, "to_deg": 0, **LAW},
        ]
    return spec


@settings(max_examples=25, deadline=None)
@given(st.floats(-35, -5), st.floats(5, 35))
def test_the_pen_is_where_two_circles_meet(left: float, right: float) -> None:
    machine = camgen.load(swinging(left, right))
    theta = np.linspace(0, math.tau, 181)
    drawn = math.atan2(40, 30)
    a = O + ARM * np.exp(1j * (math.pi - drawn + swung(theta, left)))
    b = C + ARM * np.exp(1j * (drawn + swung(theta, right)))
    assert np.max(np.abs(machine.solve(theta)["pen"] - apex(a, b, ROD))) < 1e-9


def test_another_motor_that_turns_evenly_makes_whole_turns_of_its_own() -> None:
    """Cam plus motor: one arm swings by its program while a crank turns three times, against the first one's sense."""
    spec = tables()
    spec["lengths"] |= {"O-A": 8}
    spec["points"]["A"] = [-43, 0]
    spec["drive"][0] = {"link": "left", "speed_rpm": 10}
    spec["drive"][1] = {"link": "right", "speed_rpm": -30}
    spec["lengths"] |= {"C-B": 8}
    spec["points"] |= {"B": [43, 0], "P": [0, 67]}
    theta = np.linspace(0, math.tau, 181)
    a = O - 8 * np.exp(1j * theta)
    b = C + 8 * np.exp(-3j * theta)
    pen = camgen.load(spec).solve(theta)["pen"]
    assert np.max(np.abs(pen - apex(a, b, ROD))) < 1e-9


def test_one_drive_is_the_same_record_in_either_writing() -> None:
    spec = tomllib.loads(starters.text("four-bar"))
    listed = {**spec, "drive": [spec["drive"]]}
    theta = np.linspace(0, math.tau, 25)
    one, other = camgen.load(spec), camgen.load(listed)
    assert one.drive == other.drive  # type: ignore[attr-defined]
    assert np.array_equal(one.solve(theta)["foot"], other.solve(theta)["foot"])


def drive(spec: Tables, k: int, **changes: Any) -> None:
    spec["drive"][k] |= changes


@pytest.mark.parametrize(
    ("change", "path", "words"),
    [
        (lambda e: drive(e, 1, link="left"), ("drive", 1, "link"), "drive.0 turns left"),
        (lambda e: drive(e, 1, link="rihgt"), ("drive", 1, "link"), "right"),
        (lambda e: drive(e, 1, link="left_rod"), ("drive", 1, "link"), "shares a point"),
        (lambda e: drive(e, 1, speed_rpm=12), ("drive", 1, "speed_rpm"), "10 as drive.0"),
        (
            lambda e: drive(e, 1, segment=[], speed_rpm=15),
            ("drive", 1, "speed_rpm"),
            "whole multiple of drive.0's 10",
        ),
        (lambda e: drive(e, 1, segment=[], range_deg=[0, 9]), ("drive", 1, "range_deg"), "segment"),
        (lambda e: drive(e, 0, speed_rpm=-10), ("drive", 0, "speed_rpm"), "above 0"),
        (lambda e: e.update(drive=[]), ("drive",), "at least 1"),
        (lambda e: e["parts"].update(sides=2, plates=2), ("parts", "sides"), "several motors"),
        (lambda e: e.update(counterweight={}), ("counterweight",), "several motors"),
    ],
)
def test_faults_say_where_and_what(
    change: Callable[[Tables], None], path: tuple[str | int, ...], words: str
) -> None:
    spec = copy.deepcopy(tables())
    change(spec)
    with pytest.raises(SpecError) as caught:
        camgen.load(spec)
    found = [each for each in caught.value.faults if tuple(each.path) == path]
    assert any(words in f"{fault.expected} {fault.nearest}" for fault in found)


def test_a_program_out_of_reach_is_told_by_angle_and_shortfall() -> None:
    """The arms open outwards until the rods, 160 mm, no longer span them."""
    theta = np.linspace(0, math.tau, 721)
    drawn = math.atan2(40, 30)
    a = O + ARM * np.exp(1j * (math.pi - drawn + swung(theta, 40)))
    b = C + ARM * np.exp(1j * (drawn + swung(theta, -40)))
    short = np.abs(b - a) - 2 * ROD
    first = math.degrees(theta[np.argmax(short > 0)])
    with pytest.raises(DesignError) as caught:
        assert camgen.load(swinging(40, -40)).model
    said = caught.value
    assert said.value == pytest.approx(short.max(), abs=1e-9) and said.unit == "mm"
    assert f"from {first:.4g} deg" in said.sentence and "180 deg" in said.sentence


def test_as_many_drives_as_there_are_degrees_of_freedom() -> None:
    few = {**tables(), "drive": {"link": "left"}}
    with pytest.raises(DesignError, match=r"1 degree of freedom left over.*drive one of them"):
        assert camgen.load(few).model
    four_bar = tomllib.loads(starters.text("four-bar"))
    many = {**four_bar, "drive": [four_bar["drive"], {"link": "rocker"}], "parts": {}}
    with pytest.raises(DesignError, match="2 drives for 1 degree of freedom"):
        assert camgen.load(many).model


@pytest.fixture(scope="module")
def made() -> Linkage:
    return validate(Linkage, tables())


def test_each_motor_has_its_seat_its_shaft_and_its_screws(made: Linkage) -> None:
    """Two NEMA 17: their bosses 22 mm wide at O and C, four screws each 31 mm apart; both links take the shafts' flats."""
    assembly = made.assembly
    bought = {each.name: each.count for each in assembly.bought}
    assert bought["drive"] == 2 and bought["screw of the motor"] == 8
    holes = assembly.by_name["ground"].region.holes
    for pivot in (O, C):
        (seat,) = [hole for hole in holes if abs(hole.centroid - pivot) < 1e-6]
        assert 2 * math.sqrt(abs(seat.area) / math.pi) == pytest.approx(22, abs=0.5)
        corners = {complex(x, y) for x in (-15.5, 15.5) for y in (-15.5, 15.5)}
        near = [hole.centroid - pivot for hole in holes if abs(hole.centroid - pivot) < 25]
        assert all(min(abs(z - corner) for z in near) < 1e-6 for corner in corners)
    assert sum(each.name.startswith("motor") for each in assembly.stand_ins) == 2


def test_each_motor_s_torque_is_its_own(made: Linkage) -> None:
    """Held against gravity: power of both motors over the period is what friction takes, each by its own angle."""
    found = assess(made)
    numbers = found.study.numbers
    both = {key: value for key, value in numbers.items() if key.startswith("drive_torque_")}
    assert {"drive_torque_left_n_m", "drive_torque_right_n_m"} <= both.keys()
    most = max(numbers["drive_torque_left_n_m"], numbers["drive_torque_right_n_m"])
    assert numbers["drive_torque_n_m"] == most > 0
    forces = made.solve(np.linspace(0, math.tau, 361)).forces()
    assert set(forces.drives) == {"drive of left", "drive of right"}


def test_without_motors_both_shafts_reach_below_the_plate() -> None:
    spec = tables()
    spec["parts"] = {"shaft_length": 18}
    machine = validate(Linkage, spec)
    names = machine.assembly.by_name
    low = {mount.part: mount.z for mount in machine.assembly.mounts}
    assert {"shaft", "shaft-right"} <= names.keys()
    assert low["shaft"] == low["shaft-right"] == -18
    assert "shafts' lower ends" in machine.assembly.board
