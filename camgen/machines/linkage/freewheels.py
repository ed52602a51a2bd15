"""[[freewheel]]: what is wrong with it, and the sizes that its clutches ask for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from camgen.errors import Fault
from camgen.machine.model import GROUND
from camgen.machines.linkage import tables as t
from camgen.parts.catalogue import CLUTCHES
from camgen.parts.generator.sizes import Parts
from camgen.spec import unknown


def filled(data: Any) -> Any:
    """The tables of a spec whose plate and wheels are as thick as the clutches in them, unless they say otherwise."""
    if not isinstance(data, dict) or "freewheel" not in data:
        return data
    rows = data["freewheel"]
    if not isinstance(rows, list | tuple):
        return data
    parts = data.get("parts", {})
    if not isinstance(parts, dict):
        return data
    usual = Parts.model_fields["shaft_diameter"].default
    clutch = CLUTCHES.get(parts.get("shaft_diameter", usual))
    wheels = [row.get("wheel") for row in rows if isinstance(row, dict)]
    if clutch is None:
        return data
    own = {wheel: {"thickness": clutch[0].width} for wheel in wheels if isinstance(wheel, str)}
    return {**data, "parts": {"base_thickness": clutch[0].width, **own, **parts}}


def faults(
    freewheels: Sequence[t.Freewheel],
    links: Mapping[str, Sequence[str]],
    gears: Sequence[t.Gear],
    drive: t.OneDrive,
    sizes: Parts,
) -> list[Fault]:
    """What is wrong with them."""
    found = []
    geared = {name for gear in gears for name in (gear.a, gear.b)}
    for k, each in enumerate(freewheels):
        path = ("freewheel", k)
        wrong = [
            unknown((*path, key), name, links)
            for key, name in (("wheel", each.wheel), ("link", each.link))
            if name not in links
        ]
        if not wrong:
            shared = {*links[each.wheel]} & {*links[each.link]} & {*links.get(GROUND, ())}
            if each.wheel == each.link or not shared:
                right = f"another link on the shaft of {each.link}, on the ground"
                wrong.append(Fault((*path, "wheel"), repr(each.wheel), right))
            elif each.wheel not in geared:
                right = "a link of a [[gear]], which is no more than its wheel"
                wrong.append(Fault((*path, "wheel"), repr(each.wheel), right))
        found += wrong
    if freewheels and sizes.shaft_diameter not in CLUTCHES:
        right = f"a bore of freewheels, {', '.join(f'{bore:g}' for bore in CLUTCHES)} mm"
        found.append(Fault(("parts", "shaft_diameter"), f"{sizes.shaft_diameter:g}", right))
    if freewheels and (drive.range_deg is not None or drive.segments):
        right = "no value here beside [[freewheel]]: the drive turns evenly, all the way round"
        key = "segment" if drive.segments else drive.range_key
        found.append(Fault(("drive", key), "", right))
    return found
