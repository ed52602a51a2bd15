"""Where a printed part's flat faces lie between the layers that it is printed in: `print.layer` says how high these are.

A printer stacks whole layers: the first of print.first_layer, the others of print.layer. A step or a pocket between two of
them comes out at the nearer one.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from camgen.machines.mechanism import Mechanism
from camgen.parts.assembly import printed_parts
from camgen.parts.part import Part
from camgen.study import Table

if TYPE_CHECKING:
    from camgen.files.plates import Side

_SAME = 1e-3  # mm, less is no step
_TOLD = 4  # heights in the sentence; the table has all
_FLAT = 1e-6
COLUMNS = ("part", "height over the bed, mm", "nearest layer, mm", "off, mm")


def between(mechanism: Mechanism, sides: Mapping[str, Side]) -> tuple[Table, tuple[str, ...]]:
    """The heights between layers as a table, and a sentence on them; nothing where print.layer is left out.

    sides: on which the parts lie, as drawn unless said.
    """
    layer = mechanism.print.layer
    first = mechanism.print.first_layer
    rows: list[tuple[str, float, float, float]] = []
    if layer is None:
        return Table("", COLUMNS, rows), ()
    for part in printed_parts(mechanism.assembly):
        for height in _heights(part, sides.get(part.name)):
            near = (
                0.0
                if height < first / 2
                else first + max(0, round((height - first) / layer)) * layer
            )
            if abs(height - near) > _SAME:
                rows.append((part.name, round(height, 6), round(near, 6), round(height - near, 6)))
    table = Table("Faces between layers", COLUMNS, rows)
    if not rows:
        return table, ()
    faces = ", ".join(
        f"{part} at {height:g} (layer at {near:g})" for part, height, near, _ in rows[:_TOLD]
    )
    more = f" and {len(rows) - _TOLD} more" if len(rows) > _TOLD else ""
    return table, (
        f"print.layer = {layer:g}: these faces lie between two layers, and print at the nearer one: {faces}{more}",
    )


def too_thin(mechanism: Mechanism) -> tuple[str, ...]:
    """A sentence on printed parts with a stretch thinner than a layer, which comes out as thick as one, or not at all."""
    layer = max(mechanism.print.first_layer, mechanism.print.layer or 0.0)
    stretches = {
        part.name: min(each.z1 - each.z0 for each in part.layers)
        for part in printed_parts(mechanism.assembly)
        if part.layers
    }
    thin = {name: height for name, height in stretches.items() if height < layer - _SAME}
    if not thin:
        return ()
    named = ", ".join(f"{name} {height:g} mm" for name, height in [*thin.items()][:_TOLD])
    more = f" and {len(thin) - _TOLD} more" if len(thin) > _TOLD else ""
    return (
        f"thinner than a layer of {layer:g} mm: {named}{more}; a larger parts.thickness, or finer print.first_layer and "
        "print.layer",
    )


def _heights(part: Part, side: Side | None) -> Iterator[float]:
    """Heights of a part's flat faces over the bed, mm, from below; of one that lies on a side its whole height alone."""
    levels = {z for layer in (*part.layers, *part.engraved) for z in (layer.z0, layer.z1)}
    low = min(levels)
    high = max(levels)
    up = (
        1.0 if side is None else float(side.turn[2, 2])
    )  # cosine of its lean; -1: it lies turned over
    if side is not None and abs(abs(up) - 1) > _FLAT:
        yield side.height
        return
    if not part.prismatic:
        levels = {low, high}
    heights = sorted({round(z - low if up > 0 else high - z, 9) for z in levels})
    yield from (z for z in heights if not math.isclose(z, 0.0, abs_tol=_SAME))
