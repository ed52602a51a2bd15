"""The tables of an eccentric drive's spec."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, field_validator

from camgen.machines.loads.tables import Bears, Drives
from camgen.parts.catalogue import CORE_HOLES
from camgen.parts.generator import sizes
from camgen.spec import Length, Mass, Record, Rpm, turning

Band = tuple[Annotated[float, Field(gt=0, le=1e6)], Annotated[float, Field(gt=0, le=1e6)]]

OLD_WORDS = {
    ("parts", "strap_wall"): "wall",
    ("parts", "rod_thickness"): "thickness",
    ("parts", "flange"): "head",
    ("parts", "body_thickness"): "base_thickness",
    ("parts", "pins"): "pin",
}
# keys of a linkage's sizes that are set here, and why
ELSEWHERE = {
    "shaft_diameter": "geometry.shaft_diameter says it",
    "shaft_flat": "the motor's shaft is round",
    "discs": "geometry.eccentric_diameter says it",
    "mount_diameter": "parts.screw says it",
    "make": "a slider with a groove is printed",
    **dict.fromkeys(("can", "motor", "set_screw", "hand_crank", "shaft"), "[motor] drives it"),
}


class Geometry(Record):
    """Lengths of the mechanism."""

    eccentricity: Length
    rod: Length
    offset: Annotated[float, Field(ge=-1e6, le=1e6)] = 0.0
    eccentric_diameter: Length
    shaft_diameter: Length


class Motor(Drives):
    """What drives the disc; boss_diameter: of the collar by which it sits in the plate, diameter, length: of its can."""

    speed_rpm: Annotated[Rpm, turning(0.001)]
    boss_diameter: Length = 6.0
    diameter: Length = 21.0
    length: Length = 25.0


class Sizes(sizes.Parts):
    """Sizes of the parts, as [parts] of a linkage, and of the needle's."""

    wall: Length = 2.0
    thickness: Length = 3.0
    head: Length = 1.0
    base_thickness: Length = 5.0
    pin: sizes.PinKind = "printed"
    pin_diameter: Length = 3.0
    rail_width: Length = 6.0
    slider_width: Length = 8.0
    slider_thickness: Length = 4.0
    wire_diameter: Length = 1.5
    wire_length: Length | None = None
    tube_length: Annotated[float, Field(ge=0, le=1e6)] = 0.0
    screw: Literal["M2", "M2.5", "M3", "M4", "M5", "M6"] = "M2"
    cover_length: Length = 10.0

    @field_validator("pin", mode="before")
    @classmethod
    def _old_kind(cls, value: object) -> object:
        return "dowel" if value == "steel" else value

    def of_linkage(self) -> dict[str, Any]:
        """[parts] of the linkage, without what other tables say."""
        kept = sizes.Parts.model_fields.keys() - ELSEWHERE.keys()
        found = {key: getattr(self, key) for key in kept}
        thick: dict[str, Any] = {"thickness": self.slider_thickness}
        slider = {
            **thick,
            "hub_diameter": self.slider_width,
            "stem": "behind",
            "rails": self.cover_length,
        }
        shapes = {"slider": slider, "disc": thick}
        for link, shape in self.shapes.items():
            own = shape.model_dump(exclude_none=True)
            shapes[link] = {**shapes.get(link, {}), **own}
        return {**found, **shapes, "mount_diameter": CORE_HOLES[self.screw]}


class Masses(Record):
    """What moves, for forces; the rod's centre of mass from the disc's centre, and its inertia about it."""

    rod_g: Mass
    rod_centre: Annotated[float, Field(ge=-1e6, le=1e6)]
    rod_inertia_g_mm2: Annotated[float, Field(ge=0, le=1e12)]
    slider_g: Mass

    def of_linkage(self) -> dict[str, Any]:
        """[masses] of the linkage; the disc counts as balanced."""
        rod = {"mass_g": self.rod_g, "centre": (self.rod_centre, 0.0)}
        rod["inertia_kg_m2"] = self.rod_inertia_g_mm2 * 1e-9
        return {"rod": rod, "slider": {"mass_g": self.slider_g}}


class Limits(Bears):
    """What the designer accepts; a finding fails beyond it."""

    transmission_angle_deg: Annotated[float, Field(gt=0, lt=90)] = 45.0
    lash: Annotated[float, Field(ge=0, le=1e6)] = 1.0
    stroke: Band | None = None
    strokes_per_s: Band | None = None
    min_wall: Length = 0.8
