"""What gaps between parts of metal bear: thicknesses on sheets, lengths of dowels, and how gaps are set at the bench."""

from __future__ import annotations

from functools import cache
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from camgen import starters
from camgen.machines.mechanism import Mechanism
from camgen.machines.sources import read_mechanism
from camgen.parts.catalogue import dowel_excess
from camgen.pipeline.drawings import facts_of
from camgen.pipeline.shopping import steps_of_assembly
from camgen.pipeline.thicknesses import thickness_allowances

SPECS = Path(__file__).resolve().parents[2] / "specs"


@cache
def table(*settings: str) -> Mechanism:
    """The Geneva table in metal, with one gap between all levels and walls that leave room for wide ones."""
    metal = (each for each in starters.METAL["geneva-table"] if not each.startswith("geneva.0.gap"))
    metal = (*metal, "parts.wall=2", *settings)
    return read_mechanism(SPECS / "gallery" / "geneva-table.toml", metal)


def thinner(*settings: str) -> dict[str, float]:
    machine = table(*settings)
    return {part.name: facts_of(machine, part).thinner for part in machine.assembly.parts}


@pytest.mark.parametrize(("gap", "allowed"), [(0.1, 0.03), (0.15, 0.05), (0.3, 0.1)])
def test_parts_over_each_other_may_be_thinner_by_a_share_of_their_gap(
    gap: float, allowed: float
) -> None:
    """The pin's cap is over crank and roller and passes over the wheel: of its gap each may take a third. ISO 2768-m allows 0.1 at 6 mm
    [ISO 2768-1], and a gap that bears so much has no limit of its own."""
    found = thinner(f"print.slide_clearance={gap}")
    own = {"crank", "lock-crank_to_table", "geneva-crank_to_table", "roller-crank_to_table"}
    own |= {"table", "spacer-1"}
    expected = allowed if allowed < 0.1 else 0.0
    assert {round(found[name], 6) for name in own} == {expected}
    assert {found[name] for name in ("ground", "shaft", "pin-1", "hand-crank", "knob")} == {0.0}
    assert not any(thinner("material.name=PLA", f"print.slide_clearance={gap}").values())


def test_no_gap_closes_where_thicknesses_are_at_their_limits() -> None:
    """All sums of both stacks of the table, each part at either limit, gauges of 0.1 mm between what a gauge sets: crank, roller and cap on
    the pin, spacer and wheel on the table's shaft; cap and wheel, wheel and crank never meet."""
    allowed = thickness_allowances(table().assembly)["crank"]
    gauge = 0.1
    limits = (6.0 - allowed, 6.0)
    for crank, roller, spacer, wheel in product(limits, limits, limits, limits):
        under_cap = gauge + crank + gauge + roller + gauge
        under_wheel = gauge + spacer + gauge
        assert under_cap - (under_wheel + wheel) > 0
        assert under_wheel - (gauge + crank) > 0


def test_a_dowel_has_room_at_its_greatest_length() -> None:
    """DIN 7 allows 0.3 mm more up to 10, 0.5 up to 50 and 0.8 beyond [nutbolt.org/Standards/Pin-Dowel.html, table 2]: the pin of the table
    is 16 long, for one of 18 might reach the table; printed it stays as it was."""
    assert [dowel_excess(length) for length in (10.0, 12.0, 50.0, 60.0)] == [0.3, 0.5, 0.5, 0.8]
    for settings, length in (
        ((), 16.0),
        (("material.name=PLA", "print.slide_clearance=0.1"), 18.0),
    ):
        machine = table(*settings)
        mounts = {mount.part: mount for mount in machine.assembly.mounts}
        parts = {part.name: part for part in machine.assembly.parts}
        assert parts["pin-1"].thickness == length
        if not settings:
            longest = mounts["pin-1"].z + length + 0.5
            assert longest < mounts["table"].z
            cap = mounts["cap-1"].z + parts["cap-1"].thickness
            assert cap == pytest.approx(mounts["pin-1"].z + length)


def test_gaps_of_metal_are_set_by_a_feeler_gauge_and_holes_by_their_sheets() -> None:
    """No end that is flush says how high a part is, for lengths of shafts and dowels differ by more than a gap; no scraper, no paper."""
    steps = steps_of_assembly(table()).steps
    said = [" ".join((d.verb, d.thing, d.rest)) for step in steps for d in step.doings]
    whole = "\n".join(said)
    assert "scrape" not in whole and "by hand, and keep it straight" not in whole
    assert "Ream these to the fits on their sheets" in whole
    (cap,) = (line for line in said if "cap-1" in line and "on pin-1" in line)
    assert "0.1 mm over roller" in cap and "feeler gauge" in cap and "flush" not in cap
    (top,) = (line for line in said if "C of table" in line and "☐" not in line)
    assert "0.1 mm over spacer-1" in top and "feeler gauge" in top


def test_a_cap_on_a_dowel_goes_on_by_hand() -> None:
    """Its hole is F7 (5: +0.022/+0.010, ISO 286), its pin m6 (+0.012/+0.004): no vice reaches it."""
    machine = table()
    (cap,) = (part for part in machine.assembly.parts if part.name == "cap-1")
    (fit,) = facts_of(machine, cap).fits
    assert fit.words == "F7 (+0.022/+0.01), glued on Ø5 m6"
    assert np.isclose(fit.diameter, 5.0)
