"""A machine of layers of sheet, `parts.make = "laser"`: every link, ring and the plate as thick as [laser] says, pins of steel.

What stands out of a sheet, or lies in it, cannot be: rails of a slide, seats of ball bearings, pockets, printed pins.
"""

from __future__ import annotations

from typing import Any

from camgen.errors import Fault, Key
from camgen.parts.catalogue import DOWELS
from camgen.parts.generator.sizes import Parts
from camgen.spec import Laser

_HEAD = 1.5  # mm, of the caps on pins, as tables.Parts has it
_PIN = 4.0  # mm, diameter of the thickest dowels that are taken unasked
_STEEL = ("dowel", "shoulder")
NO_RAILS = "a laser cannot cut rails that stand on a plate"
NO_BACK = "the back plate of a groove is as thick as a level and its play, which no sheet is"


def filled(data: Any) -> Any:
    """The tables of a spec with what the sheet decides where [parts] asks for it and leaves it open."""
    parts = data.get("parts") if isinstance(data, dict) else None
    if not isinstance(parts, dict) or parts.get("make") != "laser":
        return data
    laser = data.get("laser")
    if isinstance(laser, dict):
        thickness = laser.get("thickness", Laser().thickness)
    else:
        thickness = getattr(laser, "thickness", None)
    if not isinstance(thickness, int | float):
        return data
    # through two sheets and a cap
    dowels = [wide for wide, (shortest, _) in DOWELS.items() if shortest <= 3 * thickness]
    of_sheet = {
        "thickness": thickness,
        "base_thickness": thickness,
        "pin": "dowel",
        "shaft_made": "steel",
        "head": min(_HEAD, thickness),
        "pin_diameter": max((wide for wide in dowels if wide <= _PIN), default=_PIN),
    }
    return {**data, "parts": {**of_sheet, **parts}}


def faults(sizes: Parts, laser: Laser | None, slides: int = 0, grooves: int = 0) -> list[Fault]:
    """What no layers of sheet can be; slides, grooves: how many there are."""
    if sizes.make != "laser":
        return []
    if laser is None:
        right = "a table [laser] as well, with kerf, thickness, sheet and gap"
        return [Fault(("parts", "make"), "'laser'", right)]
    same = f"{laser.thickness:g}, the same as laser.thickness, because all parts are cut from one sheet"
    thicknesses: dict[Key, float | None] = {
        ("parts", "thickness"): sizes.thickness,
        ("parts", "base_thickness"): sizes.base_thickness,
        **{("parts", link, "thickness"): shape.thickness for link, shape in sizes.shapes.items()},
    }
    kinds: dict[Key, str] = {
        ("parts", "pin"): sizes.pin,
        **{("parts", "pins", point): kind for point, kind in sizes.pins.items()},
    }
    bought = '"dowel" or "shoulder": with make = "laser" pins are bought'
    others: list[tuple[bool, Key, str, str]] = [
        (
            sizes.shaft_made != "steel",
            ("parts", "shaft_made"),
            repr(sizes.shaft_made),
            '"steel": a shaft cannot be cut from sheet',
        ),
        (
            sizes.motor != "none",
            ("parts", "motor"),
            repr(sizes.motor),
            '"none": the heads of its screws need pockets in the plate, which a laser cannot cut',
        ),
        (
            sizes.plates > 1,
            ("parts", "plates"),
            f"{sizes.plates}",
            "1: a second plate needs printed posts and pockets for screw heads",
        ),
        (
            sizes.shaft != "through",
            ("parts", "shaft"),
            repr(sizes.shaft),
            '"through": crank pins with flats are printed',
        ),
        (
            slides > 0,
            ("slide",),
            f"{slides} with parts.make = 'laser'",
            f"slots and pins in place of it, of a cam a follower that swings: {NO_RAILS}",
        ),
        (
            grooves > 0,
            ("cam", "closure"),
            "'groove'",
            f'"force" or "conjugate": {NO_BACK}',
        ),
    ]
    return [
        *(
            Fault(key, f"{value:g}", same)
            for key, value in thicknesses.items()
            if value not in (None, laser.thickness)
        ),
        *(Fault(key, repr(kind), bought) for key, kind in kinds.items() if kind not in _STEEL),
        *(Fault(key, value, right) for wrong, key, value, right in others if wrong),
    ]
