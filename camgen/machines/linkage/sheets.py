"""A machine of layers of sheet, `parts.make = "laser"`: every link, ring and the plate as thick as [laser] says, pins of steel.

What stands out of a sheet, or lies in it, cannot be: rails of a slide, seats of ball bearings, pockets, printed pins.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from camgen.errors import Fault, Key
from camgen.parts.catalogue import DOWELS
from camgen.parts.generator.sizes import Parts
from camgen.spec import Laser

_HEAD = 1.5  # mm, of the caps on pins, as tables.Parts has it
_PIN = 4.0  # mm, diameter of the thickest dowels that are taken unasked
_STEEL = ("dowel", "shoulder")


def filled(data: Any, table: str) -> Any:
    """The tables of a spec with what the sheet decides where `table`, of parts, asks for it and leaves it open."""
    if not (
        isinstance(data, Mapping)
        and isinstance(data.get(table), Mapping)
        and data[table].get("make") == "laser"
    ):
        return data
    laser = data.get("laser")
    if not isinstance(laser, Mapping | Laser):
        return data
    thick = (
        laser.get("thickness", Laser().thickness) if isinstance(laser, Mapping) else laser.thickness
    )
    if not isinstance(thick, int | float):
        return data
    sold = [
        diameter
        for diameter, (shortest, _) in DOWELS.items()
        if diameter <= _PIN and shortest <= 3 * thick
    ]
    own = {
        "thickness": thick,
        "base_thickness": thick,
        "pin": "dowel",
        "shaft_made": "steel",
        "head": min(_HEAD, thick),
    }
    own["pin_diameter"] = max(sold, default=_PIN)  # through two sheets and a cap
    return {**data, table: own | data[table]}


def faults(
    sizes: Parts, laser: Laser | None, table: str, slides: int = 0, grooves: int = 0
) -> list[Fault]:
    """What no layers of sheet can be; slides, grooves: how many there are."""
    if sizes.make != "laser":
        return []
    if laser is None:
        return [
            Fault(
                (table, "make"),
                "'laser'",
                "a table [laser] beside it: kerf, thickness, sheet, gap",
            )
        ]
    found = []
    same = f"{laser.thickness:g}, as thick as laser.thickness: all is cut of one sheet"
    thick: dict[Key, float] = {
        (table, key): getattr(sizes, key) for key in ("thickness", "base_thickness")
    }
    thick |= {
        (table, link, "thickness"): shape.thickness
        for link, shape in sizes.shapes.items()
        if shape.thickness is not None
    }
    found += [
        Fault(key, f"{value:g}", same) for key, value in thick.items() if value != laser.thickness
    ]
    kinds: dict[Key, str] = {
        (table, "pin"): sizes.pin,
        **{(table, "pins", point): kind for point, kind in sizes.pins.items()},
    }
    steel = '"dowel" or "shoulder": with make = "laser" pins are bought'
    found += [Fault(key, repr(kind), steel) for key, kind in kinds.items() if kind not in _STEEL]
    if sizes.shaft_made != "steel":
        found.append(
            Fault((table, "shaft_made"), repr(sizes.shaft_made), '"steel": no sheet is a shaft')
        )
    if sizes.motor != "none":
        right = '"none": the heads of its screws lie in pockets of the plate, and a laser cuts none'
        found.append(Fault((table, "motor"), repr(sizes.motor), right))
    if sizes.plates > 1:
        found.append(
            Fault(
                (table, "plates"),
                f"{sizes.plates}",
                "1: a second one is screwed on printed posts, heads in pockets",
            )
        )
    if sizes.shaft != "through":
        found.append(
            Fault(
                (table, "shaft"), repr(sizes.shaft), '"through": crank pins with flats are printed'
            )
        )
    if slides:
        right = "slots and pins in place of it, of a cam a follower that swings: rails stand on plates, and no sheet does"
        found.append(Fault(("slide",), f"{slides} with {table}.make = 'laser'", right))
    if grooves:
        right = '"force" or "conjugate": the back plate of a groove is as thick as a level and its play, which no sheet is'
        found.append(Fault(("cam", "closure"), "'groove'", right))
    return found
