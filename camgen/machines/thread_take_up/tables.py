"""The tables of a thread take-up's spec; those of masses and of consumed thread stand beside what they feed."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from camgen.machines.loads.tables import Bears, Drives
from camgen.spec import Length, Record, Rpm, turning

Coordinate = Annotated[float, Field(ge=-1e6, le=1e6)]
Point = tuple[Coordinate, Coordinate]


class Geometry(Record):
    """Lengths and angles of the mechanism, guides in the machine's axes (origin O)."""

    input_crank: Length
    coupler: Length
    output_crank: Length
    frame: Length
    eye_distance: Length
    eye_angle_deg: Annotated[float, Field(gt=-180, le=180)]
    branch: Literal[1, -1]
    guides: tuple[Point, Point]
    frame_angle_deg: Annotated[float, Field(ge=-360, le=360)] = 0.0


class Motor(Drives):
    """What drives the input crank."""

    speed_rpm: Annotated[Rpm, turning(0.001)]


class Wanted(Record):
    """What `camgen design` searches for and a build checks; each wish may be left out."""

    feed_range: Length | None = None
    let_down_ratio: Annotated[float, Field(gt=0, le=100)] | None = None
    dwell_deg: Annotated[float, Field(gt=0, lt=360)] | None = None
    dwell_radius: Length = 1.0
    tolerance: Annotated[float, Field(ge=1e-6, le=0.5)] = 0.01


class Parts(Record):
    """The links as bodies."""

    thickness: Length = 4.0
    wall: Length = 1.2
    shaft_diameter: Length = 6.0
    shaft_length: Length = 12.0
    shaft_flat: Length = 0.5
    pin_diameter: Length = 3.5
    pins: Literal["printed", "steel", "all-steel"] = "printed"
    mount_diameter: Length = 2.5
    finger_diameter: Length = 2.0
    guide_diameter: Length = 2.0
    thread_height: Length = 6.0
    groove: Annotated[float, Field(ge=0, le=1e6)] = 2.0


class Limits(Bears):
    """What the designer accepts; a finding fails beyond it."""

    transmission_angle_deg: Annotated[float, Field(ge=0, lt=90)] = 40.0
    gap: Annotated[float, Field(ge=0, le=1e6)] = 0.2
    excess: Annotated[float, Field(ge=0, le=1e6)] = 7.0
    lash: Annotated[float, Field(ge=0, le=1e6)] = 7.0
    min_wall: Length = 0.8
