"""The list of an arrangement drawing: the parts of a machine, then what is bought and stays in it, as the parts list counts them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from camgen.files.assembly_list import Item
from camgen.machines.mechanism import Mechanism
from camgen.parts.catalogue import TURNED, Bought
from camgen.parts.part import Part
from camgen.pipeline.drawings import SHAFT_STEEL, drawing_number, material_of, shaft_facts
from camgen.pipeline.shopping import bought_things, supplies
from camgen.study import Table

_LISTED = ("bought", TURNED)  # what the list names beside parts


def items_of(mechanism: Mechanism, listed: Table) -> Iterator[tuple[Item, Bought | None]]:
    """Each item, and the thing that it is where it is bought and is no part; listed: the parts list, how, part, what and count first."""
    parts = mechanism.assembly.by_name
    rows = [(str(how), str(name), str(what), count) for how, name, what, count, *_ in listed.rows]
    order = list(parts)
    made = [row for row in rows if row[1] in parts]
    made.sort(key=lambda row: order.index(row[1]))
    for number, (_, name, what, count) in enumerate(made, 1):
        yield _part(mechanism, parts[name], number, what, count), None
    things = {(thing.name, thing.listing): thing for thing in bought_things(mechanism)}
    used_up = {each.name for each in supplies(mechanism)}  # such as oil: no items of a machine
    number = len(made)
    for how, name, what, count in rows:
        if name in parts or how not in _LISTED or name in used_up:
            continue
        number += 1
        thing = things.get((name, what))
        item = Item(number, count, name, what, how)
        if thing is not None and thing.shaft is not None:
            facts = shaft_facts(mechanism, thing.shaft)
            drawing = facts.number.removeprefix(f"{mechanism.name}-")
            item = replace(item, designation=f"{drawing}: {thing.size}", material=SHAFT_STEEL)
        yield item, thing


def _part(mechanism: Mechanism, part: Part, number: int, what: str, count: object) -> Item:
    """A part of the machine with its drawing, or what it is sold as; what: in the parts list."""
    note = part.notes[0] if part.notes and part.process in _LISTED else ""
    words = what.removeprefix(part.title).removeprefix(f": {note}")
    own = drawing_number(mechanism, part.name)
    drawing = own or f"{part.name}-drawing"
    named = part.listed if own else part.title  # else its drawing has its name
    bought = part.process == "bought" and note
    designation = note if bought else ": ".join(text for text in (drawing, note) if text)
    return Item(number, count, named + words, designation, material_of(mechanism, part)[0])
