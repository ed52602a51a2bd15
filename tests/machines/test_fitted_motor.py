"""A motor that is built in, beside what motor.model says of it."""

from pathlib import Path

import pytest

from camgen.errors import SpecError
from camgen.machines.loads.assess import assess
from camgen.machines.mechanism import Mechanism
from camgen.machines.sources import read_mechanism

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
