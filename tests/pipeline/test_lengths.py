"""Limits along the axes of machines in metal: no shaft, pin or bush stands out of what it goes through."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import ezdxf
import pytest

from camgen import starters
from camgen.files.drawing import write_drawing
from camgen.files.title_block import Facts
from camgen.machines.mechanism import Mechanism
from camgen.machines.sources import read_mechanism
from camgen.pipeline.drawings import facts_of

SPECS = Path(__file__).resolve().parents[2] / "specs"
BEARING = 0.12  # mm, by which one may be narrower, bore 2.5 to 10 [ISO 492]
LINKAGE = (*starters.METAL["linkage"], "parts.pin=bearing")
TABLE = starters.METAL["geneva-table"]


@cache
def facts(spec: str, *settings: str) -> tuple[Mechanism, dict[str, Facts]]:
    machine = read_mechanism(SPECS / f"{spec}.toml", settings)
    return machine, {part.name: facts_of(machine, part) for part in machine.assembly.parts}


def test_the_tail_of_a_pin_ends_in_what_it_is_glued_in() -> None:
    """A pin in crank or rocker goes through 4 of bearing (-0.12), 2 of sleeve (-0.1) and 6 of link (-0.1), in all at least
    11.68, and is 11.5; in the plate through 10 (never less) in place of a link, 15.78, and is 15.5. ISO 2768-m has +-0.2 from 6 to 30."""
    _, found = facts("linkage", *LINKAGE)
    assert found["crank"].thickness_limits == found["rocker"].thickness_limits == "0/-0.1"
    assert found["sleeve-1"].thickness_limits == "0/-0.1"
    assert found["pin-2"].shorter == found["pin-1"].shorter == pytest.approx((0.0, 0.2))
    longest = 11.5 - found["pin-2"].shorter[0]
    assert longest <= (6 - 0.1) + (2 - 0.1) + (4 - BEARING) + 1e-9
    assert found["pin-2"].thickness_limits == ""  # its length over all follows


def test_a_shaft_ends_below_the_top_of_what_it_turns() -> None:
    """Drawn 0.5 below it. From the plate's underside up, the linkage's shaft goes through a crank (-0.1), the table's through a spacer of
    7.9, wheel, spacer and table under general tolerances, together 0.5. What hangs under the plate does not
    count. ISO 2768-m has +-0.1 up to 6, 0.2 up to 30 and 0.3 up to 120; class c 0.2 up to 6 and 0.8 up to 120, and the gap beside the spacer
    bears 0.2, with a gap of 1: 0.8 of the table's."""
    _, found = facts("linkage", *LINKAGE)
    assert found["shaft"].length_limits == "0/-0.3"
    _, found = facts("gallery/geneva-table", *TABLE)
    layers = ("spacer-1", "geneva-crank_to_table", "spacer-2", "table")
    assert {found[name].thinner for name in layers} == {0.0}
    assert found["shaft-table"].length_limits == found["shaft"].length_limits == "0/-0.3"
    assert found["pin-1"].length_limits == ""  # a dowel, as it is sold
    _, coarse = facts(
        "gallery/geneva-table", *TABLE, "geneva.0.gap=1", "drawing.tolerance=ISO 2768-c"
    )
    assert coarse["spacer-1"].thinner == 0.2
    assert coarse["shaft-table"].length_limits == "-0.3/-1.1"


def test_a_plate_is_never_thinner_than_its_bush_is_long() -> None:
    """ISO 2768-m has +-0.2 at 10 mm: all of it goes up. A knob holds nothing of the plate, and no print has such limits."""
    for spec, settings in (("linkage", LINKAGE), ("gallery/geneva-table", TABLE)):
        _, found = facts(spec, *settings)
        assert found["ground"].thickness_limits == "+0.2/0"
        assert not any(each.thicker for name, each in found.items() if name != "ground")
    _, printed = facts("linkage")
    assert not any(each.thicker or any(each.shorter) for each in printed.values())


def test_a_plate_with_guides_has_no_limit_of_its_whole_height() -> None:
    """What it says is the height of the guides: a taller one would leave the slide more play."""
    machine, found = facts("quick-return", "material.name=C45")
    (plate,) = (part for part in machine.assembly.parts if part.name == "ground")
    assert {layer.z1 for layer in plate.layers} > {plate.thickness}
    assert found["ground"].thickness_limits == ""


def test_a_collar_never_reaches_the_plate() -> None:
    """It is set by its underside, 0.1 below the plate with its upper side: ISO 2768-m has +-0.1 at 6 mm, all of it goes down."""
    for spec, settings in (("linkage", LINKAGE), ("gallery/geneva-table", TABLE)):
        _, found = facts(spec, *settings)
        assert found["collar"].thickness_limits == "0/-0.1"
        assert found["hand-crank"].thickness_limits == ""


def test_a_general_tolerance_of_the_spec_is_what_a_length_has() -> None:
    """ISO 2768-f: +-0.15 from 30 to 120, +-0.1 from 6 to 30."""
    _, found = facts("linkage", *LINKAGE, "drawing.tolerance=ISO 2768-fH")
    assert found["shaft"].length_limits == "0/-0.15"
    assert found["ground"].thickness_limits == "+0.1/0"


def test_the_sheets_show_these_limits(tmp_path: Path) -> None:
    """A pin's shank has them, and its length over all stands in parentheses; a shaft's length and a plate's thickness have them."""
    machine, found = facts("linkage", *LINKAGE)
    parts = {part.name: part for part in machine.assembly.parts}
    for name, sizes in (
        ("pin-2", {"11.5 0/-0.2", "(13)", "1.5"}),
        ("shaft", {"30.7 0/-0.3", "25.2 0/-0.2"}),
        ("ground", {"10 +0.2/0"}),
    ):
        paths = write_drawing(tmp_path, "m", parts[name], 0.001, found[name])
        sheet = ezdxf.readfile(next(each for each in paths if each.suffix == ".dxf"))
        said = {
            each.dxf.text.replace("<>", f"{each.get_measurement():g}")
            for each in sheet.modelspace().query("DIMENSION")
        }
        assert sizes <= said, said
        if name == "shaft":  # the hub's key, 6 long, ends with the hub, 0.5 over the shaft
            notes = {each.dxf.text for each in sheet.modelspace().query("TEXT")}
            assert any(each.startswith("Keys at 0 to 6 and 25.2 to the end") for each in notes)
