"""A motor that is built in, beside what motor.model says of it."""

from pathlib import Path

import pytest

from camgen.errors import SpecError
from camgen.machines.loads.assess import assess
from camgen.machines.mechanism import Mechanism
from camgen.machines.sources import read_mechanism
from camgen.pipeline.judging import motor_without_seat
from camgen.pipeline.shopping import steps_of_assembly

SPECS = Path(__file__).parents[2] / "specs"
BIRD = ("gallery/flapping-bird", "parts.hand_crank=0")
CAM = ("disc-cam", "parts.make=printed", "parts.hub_height=")


def made(name: str, *settings: str) -> Mechanism:
    return read_mechanism(SPECS / f"{name}.toml", settings)


def limits(machine: Mechanism) -> list[float]:
    """Of DRIVE_TORQUE, N m."""
    return [each.limit for each in assess(machine).findings if each.code == "DRIVE_TORQUE"]


def drive(machine: Mechanism) -> str:
    (row,) = (each for each in machine.resolved().assembly.bought if each.role == "drive")
    return row.size


@pytest.mark.parametrize("base", [BIRD, CAM])
def test_no_hand_turns_a_motor_that_is_built_in(base: tuple[str, ...]) -> None:
    """The one model of its frame stands in the hand's place, with the 34.3 mN m of its data sheet, a hand gives 550."""
    machine = made(*base, "motor.model=hand crank", "parts.motor=28byj-48")
    assert limits(machine) == [0.0343]
    assert drive(machine).startswith("28BYJ-48, ") and "hand" not in drive(machine)
    said = 'motor.model = "hand crank" is read as "28BYJ-48", the motor of parts.motor = "28byj-48"'
    assert machine.hints == (said,)
    assert not machine.resolved().hints, "the spec that is written says the model"


@pytest.mark.parametrize("base", [BIRD, CAM])
def test_what_a_frame_of_several_models_gives_stays_open(base: tuple[str, ...]) -> None:
    machine = made(*base, "motor.model=hand crank", "parts.motor=nema-17", "parts.base_thickness=6")
    assert limits(machine) == []
    (said,) = machine.hints
    assert 'parts.motor = "nema-17" drives the machine, no hand' in said
    assert "'17HS19-2004S1'" in said and "35STH48" not in said, "one that fits"
    assert drive(machine).startswith("NEMA 17 frame, ") and "hand" not in drive(machine)
    named = made(*base, "parts.motor=nema-17", "parts.base_thickness=6", "motor.model=42STH20")
    assert limits(named) == [0.18] and not named.hints


def test_a_can_is_no_hand_either() -> None:
    can = "parts.can={diameter=24, length=30, boss_diameter=8}"
    machine = made(*BIRD, can, "motor.model=hand crank", "parts.base_thickness=6")
    assert limits(machine) == [] and "parts.can drives the machine, no hand" in machine.hints[0]


def test_a_cam_alone_has_no_motor_in_it() -> None:
    assert not made("disc-cam", "motor.model=hand crank", "parts.motor=nema-17").hints


@pytest.mark.parametrize(
    ("frame", "model", "right"),
    [
        (
            "nema-17",
            "28BYJ-48",
            'for the motor of parts.motor = "nema-17", or parts.motor = "28byj-48"',
        ),
        ("28byj-48", "17HS24", """'28BYJ-48', for the motor of parts.motor = "28byj-48", or"""),
        ("nema-17", "SG90", 'one of .*for the motor of parts.motor = "nema-17"$'),
        ("nema-23", "17HS24", "no value and motor.torque_n_m, for"),
    ],
)
@pytest.mark.parametrize("base", [BIRD, CAM])
def test_a_model_of_another_frame_contradicts_it(
    base: tuple[str, ...], frame: str, model: str, right: str
) -> None:
    settings = (f"parts.motor={frame}", f"motor.model={model}", "parts.base_thickness=6")
    with pytest.raises(SpecError, match=right) as refused:
        made(*base, *settings)
    assert [each.key for each in refused.value.faults] == ["motor.model"]


def test_capitals_of_a_model_do_not_matter() -> None:
    """Its list has 28BYJ-48 and that of the frames 28byj-48: each takes the other's."""
    machine = made(*BIRD, "motor.model=28byj-48", "parts.motor=28BYJ-48")
    assert limits(machine) == [0.0343]
    assert machine.hints == (
        "motor.model = '28byj-48' is read as '28BYJ-48'",
        "parts.motor = '28BYJ-48' is read as '28byj-48'",
    )
    with pytest.raises(SpecError, match='parts.motor = "nema-17" is its frame'):
        made("linkage", "motor.model=NEMA17")


def warned(machine: Mechanism) -> list[str]:
    return [*assess(machine).warnings, *motor_without_seat(machine.resolved())]


def test_a_stepper_is_not_to_turn_faster_than_its_maker_promises() -> None:
    """1000 steps a second of 5.625/64 deg: 87.89 deg a second, 14.65 rpm."""
    stepper = (*BIRD, "parts.motor=28byj-48", "motor.model=28BYJ-48")
    assert not warned(made(*stepper, "drive.speed_rpm=14.6"))
    for rpm in (14.7, -600):
        (said,) = warned(made(*stepper, f"drive.speed_rpm={rpm}"))
        assert f"is to turn at {abs(rpm):g} rpm, and its maker promises 14.6 rpm" in said
    # a cycloidal rise by 180 deg in 180 deg of theta is twice as fast in its middle [Norton, C_v = 2]
    moves = ("rise", "return")
    program = ", ".join(
        f'{{kind="{kind}", span_deg=180, lift_deg=180, law="cycloidal"}}' for kind in moves
    )
    (said,) = warned(made(*stepper, "drive.speed_rpm=10", f"drive.segment=[{program}]"))
    assert "is to turn at 20 rpm" in said
    assert not warned(made(*stepper, "drive.speed_rpm=600", "motor.torque_n_m=1"))


def test_a_servo_swings() -> None:
    servo = ("gallery/flapping-bird", "parts.hand_crank=0", "motor.model=SG90")
    swings = [each for each in warned(made(*servo)) if "swings through 180 deg" in each]
    assert len(swings) == 1 and "is to turn 360 deg" in swings[0]
    narrow = (*servo, "drive.range_deg=[-90, 90]", "drive.speed_rpm=10")
    assert not [each for each in warned(made(*narrow)) if "swings" in each]


def test_a_model_beside_a_hand_crank_is_not_used() -> None:
    (said,) = warned(made("gallery/flapping-bird", "motor.model=SG90"))
    assert said.startswith('motor.model = "SG90" is not used: parts.hand_crank = 25')
    assert not warned(made("gallery/flapping-bird"))
    assert not warned(made("gallery/flapping-bird", "motor.model="))


def test_steps_connect_a_stepper_to_its_driver_and_a_gearmotor_to_a_supply() -> None:
    """No stepper turns on a supply."""
    motor = steps_of_assembly(made("gallery/beak").resolved())
    (said,) = (each.title for each in motor.steps if "Hold the motor under" in each.title)
    assert "Connect it to its driver and let it run" in said and "supply" not in said
    can = "parts.can={diameter=24, length=30, boss_diameter=8}"
    turned = steps_of_assembly(made(*BIRD, can, "parts.base_thickness=6").resolved())
    (said,) = (each.title for each in turned.steps if "Hold the motor under" in each.title)
    assert "Hold its wires to its supply" in said
