"""`[walk]` of a linkage: what it says, and what it cannot say."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

from camgen.errors import SpecError
from camgen.machines.linkage.mechanism import Linkage
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
