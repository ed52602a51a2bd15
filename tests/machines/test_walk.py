"""`[walk]` of a linkage: what it says, and what it cannot say."""

from __future__ import annotations

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
