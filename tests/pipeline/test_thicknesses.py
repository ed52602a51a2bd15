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


@pytest.mark.parametrize(("gap", "allowed"), [(0.1, 0.05), (0.15, 0.07), (0.3, 0.15)])
def test_parts_over_each_other_may_be_thinner_by_a_share_of_their_gap(
    gap: float, allowed: float
) -> None:
    """Over its spacer the wheel passes over the crank: of its gap each of both may take a half. The cap of the pin, 8 wide, is in a slot
    of 10 where it passes the wheel. ISO 2768-m allows 0.1 up to 6 mm [ISO 2768-1], and a gap that bears so much has no limit of its own."""
    found = thinner(f"print.slide_clearance={gap}")
    own = {"crank", "lock-crank_to_table", "geneva-crank_to_table", "roller-crank_to_table"}
    own |= {"table", "spacer-1"}
    expected = allowed if allowed < 0.1 else 0.0
    assert {round(found[name], 6) for name in own} == {expected}
    assert {found[name] for name in ("ground", "shaft", "pin-1", "hand-crank", "knob")} == {0.0}
    assert not any(thinner("material.name=PLA", f"print.slide_clearance={gap}").values())


def test_the_table_of_the_starter_needs_no_limits_of_thickness() -> None:
    """Its wheel is 2 mm over its crank, and its table, over three parts, 2.2 mm over the cap, which is over three: at the general
    tolerance of 0.1, or 0.2 over 6 mm, no part asks for a limit, and none meets another."""
    machine = read_mechanism(
        SPECS / "gallery" / "geneva-table.toml", starters.METAL["geneva-table"]
    )
    found = {part.name: facts_of(machine, part) for part in machine.assembly.parts}
    parts = {part.name: part.thickness for part in machine.assembly.parts}
    axis = ("spacer-1", "geneva-crank_to_table", "spacer-2")
    pin = ("crank", "roller-crank_to_table", "cap-1")
    assert not any(found[name].thickness_limits for name in (*axis, *pin, "table"))

    def general(name: str) -> float:
        return 0.2 if parts[name] > 6 else 0.1

    under_table = sum(0.1 + parts[name] - general(name) for name in axis) + 0.1
    over_cap = sum(0.1 + parts[name] + general(name) for name in pin)
    assert under_table - over_cap > 0.3
    under_wheel = 0.1 + parts["spacer-1"] - general("spacer-1") + 0.1
    assert under_wheel - (0.1 + parts["crank"] + general("crank")) > 0.6

    # on a bush 10 h13 long that is flush below, over a dowel of 18 on a plate of 10 +0.2, the table's rim lower by the play of its bore
    lowest = 10 - 0.22 + sum(parts[name] - general(name) + 0.2 for name in axis[:2])
    lowest += parts["spacer-2"] - general("spacer-2") - 0.3
    assert lowest - (10 + 0.2 + 0.1 + 18 + dowel_excess(18.0)) > 0.3


def test_no_gap_closes_where_thicknesses_are_at_their_limits() -> None:
    """Each part at either limit, gauges of 0.1 mm between what a gauge sets: wheel and crank never meet. In 0.3 they are within the
    general tolerance, either way."""
    allowed = thickness_allowances(table().assembly)["crank"]
    for gauge, low, high in ((0.1, -allowed, 0.0), (0.3, -0.1, 0.1)):
        for crank, spacer in product((6.0 + low, 6.0 + high), repeat=2):
            under_wheel = gauge + spacer + gauge
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
    assert "ream" not in whole.lower(), "that is on the sheets"
    (cap,) = (line for line in said if "cap-1" in line and "on pin-1" in line)
    assert "0.2 mm over roller" in cap and "feeler gauge" in cap and "flush" not in cap
    (top,) = (line for line in said if "C of table" in line and "☐" not in line)
    assert "0.2 mm over spacer-1" in top and "feeler gauge" in top


def test_a_cap_on_a_dowel_goes_on_by_hand() -> None:
    """Its hole is F7 (5: +0.022/+0.010, ISO 286), its pin m6 (+0.012/+0.004): no vice reaches it."""
    machine = table()
    (cap,) = (part for part in machine.assembly.parts if part.name == "cap-1")
    (fit,) = facts_of(machine, cap).fits
    assert fit.words == "E8 (+0.038/+0.02), glued on Ø5 m6"
    assert np.isclose(fit.diameter, 5.0)
