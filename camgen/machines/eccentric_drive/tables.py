"""The tables of an eccentric drive's spec."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from camgen.machines.loads.tables import Bears, Drives
from camgen.spec import Length, Record, Rpm, turning

Band = tuple[Annotated[float, Field(gt=0, le=1e6)], Annotated[float, Field(gt=0, le=1e6)]]


class Geometry(Record):
    """Lengths of the mechanism."""

    eccentricity: Length
    rod: Length
    offset: Annotated[float, Field(ge=-1e6, le=1e6)] = 0.0
    eccentric_diameter: Length
    shaft_diameter: Length


class Motor(Drives):
    """What drives the disc; boss_diameter: of the collar by which it sits in the body, diameter, length: of its can."""

    speed_rpm: Annotated[Rpm, turning(0.001)]
    boss_diameter: Length = 6.0
    diameter: Length = 21.0
    length: Length = 25.0


class Parts(Record):
    """The bodies of the parts."""

    strap_wall: Length = 2.0
    rod_thickness: Length = 3.0
    flange: Length = 1.0
    pin_diameter: Length = 3.0
    pins: Literal["printed", "steel"] = "printed"
    slider_width: Length = 8.0
    slider_thickness: Length = 4.0
    wire_diameter: Length = 1.5
    wire_length: Length | None = None
    tube_length: Annotated[float, Field(ge=0, le=1e6)] = 0.0
    rail_width: Length = 6.0
    cover_length: Length = 10.0
    screw: Literal["M2", "M2.5", "M3", "M4", "M5", "M6"] = "M2"
    body_thickness: Length = 5.0


class Limits(Bears):
    """What the designer accepts; a finding fails beyond it."""

    transmission_angle_deg: Annotated[float, Field(gt=0, le=90)] = 45.0
    lash: Annotated[float, Field(ge=0, le=1e6)] = 1.0
    stroke: Band | None = None
    strokes_per_s: Band | None = None
    min_wall: Length = 0.8
