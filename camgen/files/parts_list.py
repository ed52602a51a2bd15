"""The parts list to print: material, mass and time of all copies, by plain rules."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING

from camgen.parts.part import Part

if TYPE_CHECKING:
    from camgen.files.plates import Side

# The rule of print time. A bead as wide as the nozzle and half as high, laid at this speed, gives the volumetric flow;
# what is filled is printed, all of a part or its share; each layer of each copy costs as much again for travel, retraction and slow outer walls.
PRINT_SPEED = 60.0  # mm/s
LAYER_SHARE = 0.5  # of the nozzle: height of a layer
LAYER_OVERHEAD = 6.0  # s


@dataclass(frozen=True)
class Row:
    """A printed part in the list: count, and material (mm^3), mass (g) and time to print (min) of ALL its copies."""

    part: str
    title: str
    count: int
    material_mm3: float
    mass_g: float
    print_min: float


def layer_height(nozzle: float, layer: float | None) -> float:
    """Height of layers, mm: as given, or a share of the nozzle's diameter, mm."""
    return layer or LAYER_SHARE * nozzle


def parts_list(
    parts: Sequence[Part],
    density: float,
    infill: float = 1.0,
    nozzle: float = 0.4,
    layer: float | None = None,
    sides: Mapping[str, Side] = MappingProxyType({}),
) -> list[Row]:
    """A row for each part: exact volume, mass by density, time = filled volume / flow + layers * overhead.

    density: g/cm^3, of the plastic; infill: share of a part that is plastic. The flow is nozzle * layer * PRINT_SPEED; layer: mm,
    LAYER_SHARE * nozzle unless given. sides: on which each part lies; without them as drawn.
    """
    filled = infill * density / 1000  # g/mm^3
    layer = layer_height(nozzle, layer)
    flow = nozzle * layer * PRINT_SPEED
    rows = []
    for part in parts:
        height = sides[part.name].height if part.name in sides else part.thickness
        seconds = infill * part.volume / flow + math.ceil(height / layer - 1e-6) * LAYER_OVERHEAD
        rows.append(
            Row(
                part.name,
                part.title,
                part.count,
                part.count * part.volume,
                part.count * part.volume * filled,
                part.count * seconds / 60,
            )
        )
    return rows
