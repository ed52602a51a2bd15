"""The seat of a ball bearing on the sheet of its link: cut, with its sizes and their limits, in the free part of the paper."""

from __future__ import annotations

import tomllib
from dataclasses import replace
from functools import cache

import pytest

from camgen.files.drawing import _Layout
from camgen.files.seat_detail import seat_of
from camgen.files.sheet import Size, Text
from camgen.machines.linkage.mechanism import Linkage
from camgen.pipeline.drawings import facts_of
from camgen.spec import validate
from camgen.starters import in_metal


@cache
def machine() -> Linkage:
    return validate(Linkage, tomllib.loads(in_metal("linkage")))


def sheet_of(name: str) -> _Layout:
    part = machine().assembly.by_name[name]
    return _Layout(part, f"x-{name}", 1e-3, facts_of(machine(), part))


@pytest.mark.parametrize(("name", "title"), [("coupler", "Seats A and B"), ("rocker", "Seat C")])
def test_a_seat_has_its_sizes_with_limits_and_each_once(name: str, title: str) -> None:
    """695ZZ, 13 x 4, in a link of 6: over it a play of 0.2, so 4.2 deep, and the lip is 1.8 high. A quarter of the section high, the outer
    ring begins at 11; of a lip of 10.5 whose edge is broken by 0.2 to 0.4 what is flat begins at 10.9 to 11.3. The next link's gap of 0.2
    hangs on the lip, which takes half of it. JS7 of 13: half of 18 thousandths either way [ISO 286]."""
    layout = sheet_of(name)
    sizes = [each for each in layout.sheet.things if isinstance(each, Size)]
    said = {(each.sign, round(each.value, 6), each.fit) for each in sizes}
    assert {
        ("Ø", 13.0, " JS7 (±0.009)"),
        ("Ø", 10.5, ""),
        ("", 1.8, " 0/-0.1"),
        ("(", 4.2, ")"),
    } <= said
    assert sum(abs(each.value - 1.8) < 1e-6 for each in sizes) == 1, (
        "not in the view from the left too"
    )
    for each in sizes:  # as a program measures it
        measured = abs(each.b - each.a) / layout.scale * each.factor
        assert measured == pytest.approx(each.value, abs=1e-6)
    texts = [each for each in layout.sheet.primitives if isinstance(each, Text)]
    assert any(each.text == f"{title} (2:1)" for each in texts)
    assert not any("deep" in note for note in layout.notes)


def test_a_sheet_asks_nothing_of_a_lip_that_is_printed_or_of_a_part_without_a_ring() -> None:
    part = machine().assembly.by_name["coupler"]
    facts = facts_of(machine(), part)
    assert seat_of(part, facts) is not None
    assert seat_of(part, replace(facts, lip=0.0)) is None
    bare = [replace(fit, ring=False) for fit in facts.fits]
    assert seat_of(part, replace(facts, fits=bare)) is None
    crank = machine().assembly.by_name["crank"]
    assert seat_of(crank, facts_of(machine(), crank)) is None
