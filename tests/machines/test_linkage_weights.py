"""The counterweight of a linkage: sized for the machine that carries it, kept by a resolved spec, and told where it cannot be."""

from __future__ import annotations

import cmath
import math
from pathlib import Path

import numpy as np
import pytest

from camgen.errors import DesignError, SpecError
from camgen.machine.balancing import crank_weight
from camgen.machine.run import solve
from camgen.machines.linkage.mechanism import Linkage
from camgen.machines.loads.assess import assess
from camgen.pipeline import build as pipeline

SPEC = Path(__file__).resolve().parents[2] / "specs" / "linkage.toml"
TURN = np.linspace(0, math.tau, 721)


def made(*overrides: str) -> Linkage:
    found = pipeline.read_mechanism(SPEC, overrides)
    assert isinstance(found, Linkage)
    return found


def test_no_other_weight_would_spare_the_bearing_more() -> None:
    """With it on, the best further weight is none: the circle round all forces that the crank sees lies about the shaft."""
    machine = made("counterweight.made='steel'").model
    forces = solve(machine, TURN).forces()
    crank = next(joint for joint in machine.joints if joint.name == "O")
    force = forces.reactions["O"] * (1 if crank.a.body == "crank" else -1)  # type: ignore[union-attr]
    more, left = crank_weight(force, TURN, machine.speed)
    assert 1e3 * abs(more) < 0.5  # g mm, of 155
    assert float(np.abs(force).max()) == pytest.approx(left, rel=1e-3)


def test_against_the_frame_it_shakes_least() -> None:
    numbers = assess(made("counterweight.against='frame'")).study.numbers
    bearing = assess(made("counterweight.against='bearing'")).study.numbers
    assert numbers["counterweight_shaking_after_n"] < bearing["counterweight_shaking_after_n"]
    assert numbers["counterweight_shaking_after_n"] == pytest.approx(
        bearing["shaking_force_balanced_n"], rel=0.02
    )
    assert numbers["counterweight_shaking_after_n"] < numbers["counterweight_shaking_before_n"]


def test_what_else_is_on_the_shaft_is_balanced_with_it() -> None:
    plain, more = (
        made("counterweight.pins=0").assembly.balances[0],
        made("counterweight.other_g_mm=50", "counterweight.other_deg=90").assembly.balances[0],
    )
    assert plain is not None and more is not None
    assert plain.moment - more.moment == pytest.approx(50 * cmath.exp(0.5j * math.pi), abs=0.5)


def test_a_resolved_spec_makes_the_same() -> None:
    first = made("counterweight.pins=2")
    again = pipeline.read_mechanism(first.resolved().model_dump(by_alias=True, exclude_none=True))
    assert (
        isinstance(again, Linkage)
        and again.counterweight is not None
        and again.counterweight.given is not None
    )
    assert {part.name: part.volume for part in again.assembly.parts} == pytest.approx(
        {p.name: p.volume for p in first.assembly.parts}
    )
    assert [(mount.part, mount.z) for mount in again.assembly.mounts] == [
        (mount.part, mount.z) for mount in first.assembly.mounts
    ]


def test_a_moment_of_none_is_one() -> None:
    balance = made("counterweight.moment_g_mm=0", "counterweight.at_deg=0").assembly.balances[0]
    assert balance is not None and balance.moment == 0 and balance.tolerance > 0.1


@pytest.mark.parametrize(
    "settings, said",
    [
        (["counterweight.moment_g_mm=10"], "moment_g_mm and at_deg together"),
        (["counterweight.pins=1", "drive.range_deg=[0, 30]"], "does not turn evenly"),
        (["counterweight.pins=1", "masses.crank.mass_g=5"], "sizes for the solids"),
        (["counterweight.pins=13"], "counterweight.pins"),
        (["counterweight.half_angle_deg=5"], "counterweight.half_angle_deg"),
    ],
)
def test_what_does_not_go_together_is_told(settings: list[str], said: str) -> None:
    with pytest.raises(SpecError) as caught:
        made(*settings)
    assert said in str(caught.value)


def test_pins_that_are_too_heavy_are_told() -> None:
    with pytest.raises(DesignError, match="counterweight.pin_diameter"):
        _ = made("counterweight.pins=3", "counterweight.pin_diameter=50").assembly
