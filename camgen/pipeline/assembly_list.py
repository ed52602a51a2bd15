"""The list of an arrangement drawing: the parts of a machine, then what is bought and stays in it, as the parts list counts them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from camgen.files.assembly_list import Item
from camgen.files.dimensions import number as rounded
from camgen.files.dimensions import round_of
from camgen.geometry.arcs import fit_arcs
from camgen.geometry.outlines import extent
from camgen.machines.mechanism import Mechanism
from camgen.parts.catalogue import CUT, TURNED, Bought
from camgen.parts.materials import STEEL
from camgen.parts.part import Part
from camgen.parts.step_words import TWO_PART
from camgen.pipeline.drawings import SHAFT_STEEL, drawing_number, material_of, shaft_facts
from camgen.pipeline.shopping import bought_things, supplies
from camgen.study import Table
from camgen.tolerances import SAME_POINT

_LISTED = ("bought", TURNED)  # what the list names beside parts
_FINE = 0.01  # mm, by which arcs may differ from a curve
FOR_SHOP = ("drawing", "material", "mass of one, g", "overall, mm")  # columns of the parts list


def numbers_of(mechanism: Mechanism, rows: Sequence[Sequence[object]]) -> Iterator[int | str]:
    """The number on the arrangement drawing of each row of the parts list, how and part first; "" of stock, tools and what is used up."""
    order = list(mechanism.assembly.by_name)
    # such as oil: no items of a machine; glue stays in it
    used_up = {each.name for each in supplies(mechanism)} - {TWO_PART}
    number = len(order)
    for how, name, *_ in rows:
        if name in order:
            yield order.index(str(name)) + 1
        elif how in _LISTED and name not in used_up:
            number += 1
            yield number
        else:
            yield ""


def for_shop(
    mechanism: Mechanism, rows: Sequence[Sequence[object]]
) -> Iterator[tuple[object, ...]]:
    """FOR_SHOP of each row of the parts list, how, part, what, count, volume and mass of all first; "" of what is bought."""
    parts = mechanism.assembly.by_name
    shafts = {each.name: each.shaft for each in mechanism.assembly.bought if each.shaft}
    for _, name, _, count, volume, mass, *_ in rows:
        part = parts.get(str(name))
        shaft = shafts.get(str(name))
        drawing = f"{mechanism.name}-{name}-drawing.pdf"
        if part is None and shaft is not None:
            size = f"Ø{shaft.diameter:g} x {shaft.length:g}"
            yield drawing, SHAFT_STEEL, shaft_facts(mechanism, shaft).mass_g, size
        elif part is None or part.process in ("bought", "dummy"):
            yield ("",) * len(FOR_SHOP)
        else:
            steel = part.process in (TURNED, CUT)
            of_all = float(str(volume)) * STEEL.density * 1e-3 if steel else mass
            one = float(str(of_all)) / int(str(count)) if of_all else ""
            yield drawing, material_of(mechanism, part)[0], one, _overall(part)


def _overall(part: Part) -> str:
    """Sizes of a part: diameter and length where it is round, else those of the box along its axes, to a tenth as on its sheet; mm."""
    low, high = extent([fit_arcs(layer.region.outer, _FINE) for layer in part.layers])
    size = high - low
    thick = f"{part.thickness:.4g}"
    disc = round_of(max(part.layers, key=lambda layer: layer.region.area).region.outer)
    if disc and max(size.real, size.imag) <= 2 * disc[1] + SAME_POINT:
        return f"Ø{2 * disc[1]:.4g} x {thick}"
    return f"{rounded(size.real, 1)} x {rounded(size.imag, 1)} x {thick}"


def items_of(mechanism: Mechanism, listed: Table) -> Iterator[tuple[Item, Bought | None]]:
    """Each item, and the thing that it is where it is bought and is no part; listed: the parts list."""
    parts = mechanism.assembly.by_name
    things = {(thing.name, thing.listing): thing for thing in bought_things(mechanism)}
    rows = [dict(zip(listed.columns, row, strict=True)) for row in listed.rows]
    numbered = {int(str(row["no"])): row for row in rows if row["no"]}
    for number, row in sorted(numbered.items()):
        name = str(row["part"])
        what = str(row["what"])
        count = row["count"]
        if name in parts:
            yield _part(mechanism, parts[name], number, what, count), None
            continue
        thing = things.get((name, what))
        item = Item(number, count, name, what, str(row["how"]))
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
