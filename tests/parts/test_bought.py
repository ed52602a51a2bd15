"""Motors and cam followers of the catalogue: their rows against what was read, and what a machine makes of them."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path

import pytest

from camgen.errors import SpecError
from camgen.machine import strength
from camgen.machines.loads.assess import Assessment, assess
from camgen.machines.loads.drive import motor_of
from camgen.machines.loads.tables import Drives, Model
from camgen.machines.mechanism import Mechanism
from camgen.machines.sources import read_mechanism
from camgen.parts.catalogue import CAM_FOLLOWERS, MOTOR_FACES
from camgen.parts.motors import GEARED, HAND_CRANK, SERVOS, SHAFTS, STEPPERS
from camgen.pipeline.judging import motor_without_seat
from camgen.pipeline.making import parts_table

ROOT = Path(__file__).resolve().parents[2]
FACTS = tomllib.loads((ROOT / "tests" / "reference" / "bought.toml").read_text(encoding="utf-8"))
CAM = (
    "load.mass_kg=2",
    "spring.rate=5",
    "spring.preload=40",
    "limits.bearing_life_h=1000",
)


def made(name: str, *settings: str) -> Mechanism:
    return read_mechanism(ROOT / "specs" / f"{name}.toml", settings).resolved()


@pytest.mark.parametrize("row", FACTS["cam_followers"], ids=lambda row: row[0])
def test_a_cam_follower_is_what_its_maker_says(row: list[object]) -> None:
    name, outside, width, stud, thread, length, newtons = row
    follower = CAM_FOLLOWERS[str(name)]
    assert [
        follower.outside,
        follower.width,
        follower.stud,
        follower.thread,
        follower.length,
    ] == [outside, width, stud, thread, length]
    assert follower.rating == pytest.approx(float(str(newtons)) / 1000)
    if name in FACTS["ina"]:
        assert [outside, stud] == FACTS["ina"][name]


@pytest.mark.parametrize("name", GEARED)
def test_a_gearmotor_gives_what_was_read(name: str) -> None:
    volts, kgf_cm, rpm = FACTS["geared"][name]
    motor = motor_of(Drives(model=name))  # type: ignore[arg-type]
    assert motor is not None and f"at {volts:g} V" in motor.said
    assert motor.torque(0.0) == pytest.approx(kgf_cm * 0.0980665)
    assert motor.no_load * 60 / math.tau == pytest.approx(rpm)
    assert motor.torque(motor.no_load / 2) == pytest.approx(motor.stall / 2)


def test_every_model_that_may_be_named_has_a_row() -> None:
    assert set(Model.__args__) == {*STEPPERS, *GEARED, *SERVOS, HAND_CRANK}  # type: ignore[attr-defined]


def test_28byj_48_sits_under_the_plate_beside_its_shaft() -> None:
    facts = FACTS["28byj-48"]
    face = MOTOR_FACES["28byj-48"]
    between = abs(face.screws[0] - face.screws[1])
    middle = sum(face.screws) / 2
    assert (between, abs(middle)) == (facts["holes"], facts["shaft_beside"])
    assert (face.shaft, face.shaft - 2 * face.flat) == (facts["shaft"], facts["over_both_flats"])
    assert face.reach >= abs(middle) + facts["can"] / 2 - 1e-9
    assert STEPPERS["28BYJ-48"].holding == facts["torque_n_m"]
    machine = made("quick-return", "parts.motor=28byj-48", "motor.model=28BYJ-48")
    (plate,) = (part for part in machine.assembly.parts if part.name == "ground")
    holes = [hole for layer in plate.layers for hole in layer.region.holes]
    assert len(holes) >= 3  # seat of the boss, and two for screws
    bought = {thing.name: thing.size for thing in machine.assembly.bought}
    assert bought["drive"].startswith("28BYJ-48, ") and "frame" not in bought["drive"]
    assert SHAFTS["28byj-48"][0] == face.shaft


def life(*settings: str) -> Assessment:
    return assess(made("disc-cam", *CAM, *settings))


def test_life_of_a_cam_follower_by_hand() -> None:
    """With a steady load the life is (C / P)^(10/3) million turns of the ring, which rolls round the profile once a turn."""
    given = life("load.cam_follower=KR16", "geometry.follower.radius=8")
    (finding,) = (each for each in given.findings if each.code == "BEARING_LIFE")
    assert finding.ok and "KR16" in finding.message and "nine of ten" in finding.message
    mean = float(finding.message.split("mean of ")[1].split(" N")[0])
    rate = finding.measured * 3600
    turns = strength.bearing_life(3660.0, mean, 10 / 3)
    ring = turns / rate  # turns a second, at 60 rpm of a cam of some 28 mm radius
    assert 28 / 8 * 0.8 < ring < 28 / 8 * 1.4


def test_a_cam_follower_of_another_size_than_the_roller_is_refused() -> None:
    """A cam for a tip of 8 mm moves a KR19, which has 9.5 mm, otherwise than asked."""
    with pytest.raises(SpecError) as refused:
        made("disc-cam", *CAM, "load.cam_follower=KR19", "geometry.follower.radius=8")
    (fault,) = refused.value.faults
    assert fault.path == ("geometry", "follower", "radius") and fault.value == "8"
    assert fault.expected == "9.5, as load.cam_follower = 'KR19': half of its diameter"
    with pytest.raises(SpecError, match="19 - expected 9.5, .* 19 is its diameter"):
        made("disc-cam", *CAM, "load.cam_follower=KR19", "geometry.follower.radius=19")
    made("disc-cam", *CAM, "load.cam_follower=KR19", "geometry.follower.radius=9.5")


def test_a_cam_follower_is_in_the_list_of_parts_where_the_roller_is_not_made() -> None:
    alone = made("disc-cam", *CAM, "load.cam_follower=KR16", "geometry.follower.radius=8")
    whole = made("disc-cam", *CAM, "load.cam_follower=KR16", "parts.make=machine")
    names = [[row[1] for row in parts_table(each).rows] for each in (alone, whole)]
    assert "cam follower" in names[0] and "cam follower" not in names[1]


@pytest.mark.parametrize(
    ("name", "settings", "key"),
    [
        (
            "linkage",
            ("motor.model=42STH48-2004AC",),
            'Set parts.motor = "nema-17" for a seat, and a shaft of 5 mm',
        ),
        ("linkage", (), None),
        ("linkage", ("parts.motor=nema-17",), None),
        ("linkage", ("parts.hand_crank=40",), None),
        (
            "linkage",
            ("motor.model=N20-100:1",),
            "Set parts.can, with the motor's sizes, for a seat",
        ),
        ("quick-return", (), None),
        ("stitch-head", (), None),
        (
            "disc-cam",
            ("parts.hub_height=", "parts.make=printed", "motor.model=42STH48-2004AC"),
            'parts.motor = "nema-17"',
        ),
        ("disc-cam", (), None),
        ("gallery/beak", (), None),
    ],
)
def test_a_motor_for_which_the_parts_have_no_place_is_told(
    name: str, settings: tuple[str, ...], key: str | None
) -> None:
    """One of the catalogue, over the shaft of a machine; a hand and an industrial servo are joined to the shaft by their users."""
    said = motor_without_seat(made(name, *settings))
    assert bool(said) == (key is not None)
    for sentence in said:
        assert str(key) in sentence and "shaft of 6 mm, below the plate" in sentence


def test_a_drive_that_is_joined_to_the_shaft_has_its_model_in_the_list() -> None:
    machine = made("linkage", "motor.model=42STH48-2004AC")
    (drive,) = (each for each in machine.assembly.bought if each.role == "drive")
    assert drive.size.startswith("42STH48-2004AC, 60 rpm, for a shaft of 6")


def test_a_hand_crank_that_no_shop_has_says_which_key_makes_one() -> None:
    machine = made("linkage", "motor.model=hand crank")
    (drive,) = (each for each in machine.assembly.bought if each.role == "drive")
    assert drive.size.startswith("hand crank (your own, or parts.hand_crank adds one), 60 rpm")
    cranked = made("linkage", "motor.model=hand crank", "parts.hand_crank=40")
    assert not any(each.role == "drive" for each in cranked.assembly.bought)
    assert "hand-crank" in {part.name for part in cranked.assembly.parts}
