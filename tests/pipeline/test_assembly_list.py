"""The list of an arrangement drawing against the parts list and the files of drawings."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

from camgen.machines.mechanism import Mechanism
from camgen.machines.sources import read_mechanism
from camgen.parts.catalogue import TURNED
from camgen.pipeline.assembly_list import items_of
from camgen.pipeline.drawings import facts_of
from camgen.pipeline.making import parts_table
from camgen.pipeline.shopping import supplies
from camgen.starters import in_metal

SPECS = Path(__file__).resolve().parents[2] / "specs"


def machine(name: str, number: str = "") -> Mechanism:
    """A shipped machine or a starter in metal, with the number of its drawings."""
    starter = name.removeprefix("metal ")
    path = SPECS / f"{name}.toml"
    spec = tomllib.loads(path.read_text() if starter == name else in_metal(starter))
    if number:
        spec["drawing"] = {**spec.get("drawing", {}), "number": number}
    return read_mechanism(spec)


@pytest.mark.parametrize(
    "name", ["two-leg-walker", "gallery/flapping-bird", "metal geneva-table", "metal disc-cam"]
)
def test_items_are_the_parts_and_what_is_bought_of_the_parts_list(name: str) -> None:
    """As many of each as the parts list says, numbered from 1 in one run; stock, tools and what is used up are no items, but glue is."""
    mechanism = machine(name)
    listed = parts_table(mechanism)
    parts = mechanism.assembly.by_name
    items = [item for item, _ in items_of(mechanism, listed)]
    assert [item.number for item in items] == list(range(1, len(items) + 1))
    used_up = {thing.name for thing in supplies(mechanism)} - {"two-part glue"}
    counts = [
        row[3]
        for row in listed.rows
        if row[1] in parts or (row[0] in ("bought", TURNED) and row[1] not in used_up)
    ]
    assert sorted(item.count for item in items) == sorted(counts)  # type: ignore[type-var]
    whats = [str(row[2]) for row in listed.rows]
    for item in items[len(parts) :]:
        assert item.designation in whats or item.material == "C45"


def test_an_item_names_its_drawing_or_its_whole_designation() -> None:
    """A link its drawing, a dowel its standard, size and how it is fixed, a rod both, a shaft of cams the sheet of its own."""
    geneva = machine("metal geneva-table")
    items = {item.what: item for item, _ in items_of(geneva, parts_table(geneva))}
    assert items["Driver crank"].designation == "crank-drawing"
    assert items["Driver crank"].material == "C45"
    assert items["Pin 1"].designation == "dowel ISO 8734, 5 m6 x 18, pressed and glued in"
    assert items["Pin 1"].material == "bought"
    assert items["Shaft"].designation.startswith("shaft-drawing: rod 10 f7 x 38.6, keyway 3 wide")
    assert items["parallel key"].designation == "3 x 3 x 6, DIN 6885 form A"
    cam = machine("metal disc-cam")
    items = {item.what: item for item, _ in items_of(cam, parts_table(cam))}
    assert items["shaft"].designation == "shaft-drawing: 20 h6 x 105, C45"
    assert items["shaft"].material == "C45"


def test_an_item_has_the_number_of_its_drawing_where_the_spec_has_one() -> None:
    """That of the part's own title block; the part is named then, since its drawing's number does not."""
    mechanism = machine("metal geneva-table", "G-7")
    parts = mechanism.assembly.by_name
    items = {item.what: item for item, _ in items_of(mechanism, parts_table(mechanism))}
    crank = items["crank: Driver crank"]
    assert crank.designation == facts_of(mechanism, parts["crank"]).number == "G-7-02"
