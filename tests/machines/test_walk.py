"""`[walk]` of a linkage: what it says, and what it cannot say."""

from __future__ import annotations

import json
import math
import tomllib
from pathlib import Path

import numpy as np
import pytest

from camgen import load, starters
from camgen.errors import SpecError
from camgen.guide import page
from camgen.machine.model import GROUND, Gravity, Pin
from camgen.machine.run import solve
from camgen.machines.linkage.mechanism import Linkage
from camgen.machines.loads.assess import assess
from camgen.pipeline import build as pipeline

SPEC = Path(__file__).resolve().parents[2] / "specs" / "four-leg-walker.toml"
FEET = "walk.feet=['foot1', 'foot2', 'foot3', 'foot4']"


def walker(*overrides: str) -> Linkage:
    found = pipeline.read_mechanism(SPEC, overrides)
    assert isinstance(found, Linkage)
    return found


def test_a_walker_is_told_by_its_feet() -> None:
    walk = walker(FEET, "walk.payload_g=40").walk
    assert walk is not None and walk.feet == ("foot1", "foot2", "foot3", "foot4")
    assert (walk.payload_g, walk.payload_at, walk.friction) == (40, None, (0.3, 0.6, 1.0))
    assert walker().walk is None


def test_all_that_is_wrong_with_feet_is_told_at_once() -> None:
    with pytest.raises(SpecError) as told:
        walker("walk.feet=['foot1', 'foot5', 'foot1']", "walk.payload_at=[0, 20]")
    assert [fault.key for fault in told.value.faults] == [
        "walk.feet.1",
        "walk.feet.2",
        "walk.payload_at",
    ]
    with pytest.raises(SpecError, match="walk.friction"):
        walker(FEET, "walk.friction=[0]")


@pytest.mark.long
def test_a_slow_walk_is_that_of_an_independent_prototype() -> None:
    """Each published value by its last digit."""
    table = tomllib.loads((SPEC.parents[1] / "tests/reference/slow_walk.toml").read_text("utf-8"))
    numbers = walker(FEET, "walk.payload_g=40").study().numbers
    for key, row in table["four-leg-walker"].items():
        assert numbers[key] == pytest.approx(row["value"], abs=row["within"]), key
    assert numbers["walk_tilt_least_deg"] == pytest.approx(
        -numbers["walk_tilt_greatest_deg"], abs=1e-3
    )
    assert numbers["walk_way_least_mm"] <= numbers["walk_way_mm"] <= numbers["walk_way_greatest_mm"]
    ratio = numbers["walk_slip_work_greatest_j"] / numbers["walk_slip_work_least_j"]
    assert ratio == pytest.approx(1.0 / 0.3)


@pytest.mark.long
def test_freight_beyond_its_feet_makes_it_fall() -> None:
    study = walker(FEET, "walk.payload_g=1000", "walk.payload_at=[400, 0]").study()
    assert "walk_falls_at_deg" in study.numbers and "walk_way_mm" not in study.numbers
    assert any("falls" in note for note in study.notes)


@pytest.mark.long
@pytest.mark.parametrize("frictions", ["[0.6]", "[1.0, 0.6, 0.3]"])
def test_its_drive_gives_what_the_slipping_feet_take(frictions: str) -> None:
    """Over a turn, without friction of joints: weight and inertia give back what they take, so that the work is that of the slip.

    By another route: constraints of the joints here, distances along the floor there. It slips at the middle friction.
    """
    one = walker(FEET, "walk.payload_g=400", f"walk.friction={frictions}")
    theta = np.linspace(0, math.tau, 1441)
    forces = solve(one.weighed(one.model).machine, theta).forces()
    work = sum(np.trapezoid(torque, theta) for torque in forces.drives.values())
    numbers = one.study().numbers
    slip = numbers["walk_slip_work_greatest_j"] / max(json.loads(frictions))
    assert work == pytest.approx(0.6 * slip, rel=0.01)


@pytest.mark.long
def test_its_pins_bear_the_weight_on_the_feet_that_stand() -> None:
    """The reactions of what hangs on the ground add up to all weight but that of the frame and its freight, which is no body."""
    one = walker(FEET, "walk.payload_g=400", "drive.speed_rpm=0.01", "walk.friction=[0.3]")
    machine = one.weighed(one.model).machine
    theta = np.linspace(0, math.tau, 181)
    forces = solve(machine, theta).forces()
    own = one.assembly.solids.body(machine.body(GROUND)).mass + 0.4
    joints = [
        each
        for each in machine.joints
        if isinstance(each, Pin) and GROUND in (each.a.body, each.b.body)
    ]
    borne = sum(
        forces.reactions[each.name] * (1 if each.b.body == GROUND else -1) for each in joints
    )
    np.testing.assert_allclose(np.abs(borne.imag), own * 9.80665, rtol=2e-3)
    asked = walker(FEET, "load.gravity_deg=-90")
    weights = [
        each for each in asked.weighed(asked.model).machine.loads if isinstance(each, Gravity)
    ]
    assert len(weights) == 1


def test_one_that_falls_is_told_and_bears_nothing() -> None:
    fallen = walker(FEET, "walk.payload_g=1000", "walk.payload_at=[400, 0]")
    assert not fallen.weighed(fallen.model).machine.loads


def test_the_guide_says_how_much_torque_the_toy_needs() -> None:
    """With its weight on its feet, and with its legs in the air, where gravity and friction alone act on them."""
    toy = load(next(starters.folder().rglob("walker.toml")))
    hung = toy.replace({"walk": None, "load.gravity_deg": -90})
    needed = [assess(each).study.numbers["drive_torque_n_m"] for each in (toy, hung)]
    said = page("simulation")
    assert (
        f"needs {needed[0]:.3f} N m; with its legs in the air it needs {needed[1]:.3f} N m" in said
    )
