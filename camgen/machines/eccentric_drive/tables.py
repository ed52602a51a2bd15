"""The tables of an eccentric drive's spec."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, field_validator

from camgen.machines.loads.tables import Drives, LimitsTable
from camgen.parts.catalogue import CORE_HOLES
from camgen.parts.generator import sizes
from camgen.spec import Coordinate, Distance, Length, Mass, MinWall, Record, Rpm, quantity, turning
from camgen.vocabulary import OldWords

Band = tuple[Annotated[float, Field(gt=0, le=1e6)], Annotated[float, Field(gt=0, le=1e6)]]

OLD_WORDS: OldWords = {
    ("motor", "shaft_diameter"): ("geometry", "shaft_diameter"),
    ("parts", "strap_wall"): ("parts", "wall"),
    ("parts", "rod_thickness"): ("parts", "thickness"),
    ("parts", "flange"): ("parts", "head"),
    ("parts", "body_thickness"): ("parts", "base_thickness"),
    ("parts", "pins"): ("parts", "pin"),
}
# keys of a linkage's sizes that are set here, and why
ELSEWHERE = {
    "shaft_diameter": "geometry.shaft_diameter says it",
    "shaft_flat": "the motor's shaft is round",
    "shaft_key": "the motor's shaft is round",
    "discs": "geometry.eccentric_diameter says it",
    "thread_posts": "it has no thread",
    "mount_diameter": "parts.screw says it",
    "mount_screws": "four screws hold the plate",
    "make": "a slider with a groove is printed",
    **dict.fromkeys(("can", "motor", "set_screw", "hand_crank", "shaft"), "[motor] drives it"),
}


class EccentricGeometry(Record):
    """Lengths of the mechanism."""

    eccentricity: Length = Field(description="distance from the shaft O to the disc's centre E")
    rod: Length = Field(description="length of the rod, from E to the pin P of the slider")
    offset: Coordinate = Field(
        default=0.0, description="distance of the guide from the shaft; 0 is in line"
    )
    eccentric_diameter: Length = Field(description="diameter of the disc")
    shaft_diameter: Length = Field(description="diameter of the motor's shaft")


class EccentricMotor(Drives):
    """What drives the disc."""

    speed_rpm: Annotated[Rpm, turning(0.001)] = Field(
        description="speed of the shaft; below 0: clockwise"
    )
    boss_diameter: Length = Field(
        default=6.0,
        description="diameter of the motor's collar, which sits in the plate: measure yours",
    )
    diameter: Length = Field(
        default=21.0, description="diameter of the motor's can, over the flats' corners"
    )
    length: Length = Field(
        default=25.0,
        description="length of the motor's can; a bar behind it and two long screws hold it",
    )


class EccentricSizes(sizes.Parts):
    """Sizes of the parts, as [parts] of a linkage, and of the needle's."""

    wall: Length = Field(default=2.0, description="wall round holes, pins and the disc")
    thickness: Length = Field(
        default=3.0, description="thickness of the rod with its strap, and of the wire's clamp"
    )
    head: Length = Field(
        default=1.0, description="height of the pin's head and of the disc's keeper"
    )
    base_thickness: Length = Field(
        default=5.0, description="thickness of the plate that holds it all"
    )
    pin: sizes.PinKind = Field(
        default="printed",
        description='pin of the slider: "printed"; or "dowel": of steel, if a printed one does not bear '
        "the speed",
    )
    pin_diameter: Length = Field(default=3.0, description="diameter of the pin in the slider")
    rail_width: Length = Field(default=6.0, description="width of the rails beside the slider")
    slider_width: Length = Field(default=8.0, description="width of the slider across the guide")
    slider_thickness: Length = Field(
        default=4.0, description="thickness of the slider and of the disc's flange"
    )
    wire_diameter: Length = Field(
        default=1.5,
        description="diameter of the needle, in the slider's groove, clamped at the slider's head",
    )
    wire_length: Length | None = Field(
        default=None,
        description="length of the needle, from the inner end of its groove to its point; default: the point is flush with the tube's "
        "mouth when the slider is innermost",
    )
    tube_length: Distance = Field(
        default=0.0,
        description="length of the tube that guides the needle beyond the slider's head; 0: none",
    )
    screw: Literal["M2", "M2.5", "M3", "M4", "M5", "M6"] = Field(
        default="M2", description="screws of motor, wire clamp, tube and mounting"
    )
    cover_length: Length = Field(
        default=10.0, description="least length of the rails and their cover along the guide"
    )

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

    rod_g: Mass = Field(description="mass of the rod")
    rod_centre: Coordinate = Field(
        description="distance of the rod's centre of mass from E, towards P"
    )
    rod_inertia_g_mm2: Annotated[float, quantity("g mm^2", ge=0, le=1e12)] = Field(
        description="moment of inertia of the rod about its centre of mass"
    )
    slider_g: Mass = Field(description="mass of the slider with the needle")

    def of_linkage(self) -> dict[str, Any]:
        """[masses] of the linkage; the disc counts as balanced."""
        rod = {"mass_g": self.rod_g, "centre": (self.rod_centre, 0.0)}
        rod["inertia_kg_m2"] = self.rod_inertia_g_mm2 * 1e-9
        return {"rod": rod, "slider": {"mass_g": self.slider_g}}


class EccentricLimits(LimitsTable):
    """What you accept: beyond a limit its finding fails."""

    transmission_angle_deg: Annotated[float, quantity("deg", gt=0, lt=90)] = Field(
        default=45.0, description="least angle between the rod and the normal of the guide"
    )
    lash: Distance = Field(
        default=1.0,
        description="free play of the slider by that of all joints; 1: the source lets the needle reach 2 "
        "to 3 mm deep, and play moves its point within that",
    )
    stroke: Annotated[Band, quantity("mm")] | None = Field(
        default=None,
        description="least and greatest stroke allowed: how deep the needle goes",
    )
    strokes_per_s: Annotated[Band, quantity("1/s")] | None = Field(
        default=None, description="least and greatest number of strokes a second"
    )
    min_wall: MinWall = 0.8
