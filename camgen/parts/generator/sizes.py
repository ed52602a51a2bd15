"""The sizes of a linkage's bodies, and of a machine's on which cams stand."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, ConfigDict, Field, model_validator

from camgen.errors import Fault
from camgen.parts.catalogue import (
    CORE_HOLES,
    DOWELS,
    MOTOR_FACES,
    SCREWS,
    SHOULDER_SCREWS,
    TURNED,
    MotorFace,
    Screw,
    ShoulderScrew,
    in_bar,
)
from camgen.parts.set_screws import SetScrewHub
from camgen.spec import Length, Record, quantity, text_of_form, unknown

SUNK = 0.2  # mm, by which a screw's head lies below the surface
HOOK_ROOM = 0.5  # mm, from what holds the eye of a spring to its coils

Name = Annotated[
    str,
    text_of_form(
        "a name of letters, digits and _, a letter first, at most 40",
        r"^[A-Za-z][A-Za-z0-9_]*$",
        40,
    ),
]


class Shape(Record):
    """The body of one link, where it differs from the others."""

    hub_diameter: Length | None = Field(
        default=None, description="of the hubs and, unless width says otherwise, of the bands"
    )
    width: Length | None = Field(
        default=None, description="of the band of a link with two holes, whose hubs then stand out"
    )
    bow: (
        Annotated[
            float,
            quantity("mm", ge=-1e6, le=1e6),
            AfterValidator(lambda bow: bow if abs(bow) >= 1e-3 else 0.0),
        ]
        | None
    ) = Field(
        default=None,
        description="how far that band is bent, to the left from the first point; 0: not; left out: as "
        "far as needed",
    )
    thickness: Length | None = Field(default=None, description="that of all links unless given")
    rails: Length | None = Field(
        default=None,
        description="length at least of those beyond its holes' way; found unless given",
    )
    stem: Literal["along", "ahead", "behind", "both"] | None = Field(
        default=None,
        description='of a link that slides: rails "along" its holes\' way, or beyond it "ahead", "behind" '
        'or "both"',
    )


PinKind = Literal["printed", "dowel", "shoulder", "bearing"]


class Can(Record):
    """A motor with a round can under the plate: its boss sits in the plate, two long screws draw a bar behind it to the plate."""

    boss_diameter: Length = Field(description="of the collar round its shaft")
    diameter: Length = Field(description="of the can")
    length: Length = Field(description="of the can")
    screw: Literal["M2", "M2.5", "M3", "M4", "M5", "M6"] = Field(
        default="M2", description="of the two that hold it"
    )


class Parts(Record):
    """Sizes of the bodies; a further table by a link's name is the shape of that link."""

    model_config = ConfigDict(extra="allow")
    __pydantic_extra__: dict[str, Shape] = Field(init=False)

    make: Literal["printed", "laser"] = Field(
        default="printed",
        description='"printed"; or "laser": layers of the sheet of [laser], as thick as it, with pins and '
        "shaft of steel",
    )
    thickness: Length = Field(default=4.0, description="of links, cams and followers")
    pin: PinKind = Field(
        default="printed",
        description='"printed": with a head; "dowel": bought, of steel, with a printed cap; "shoulder": a '
        "screw and a nut;\n"
        '"bearing": printed, in ball bearings that are pressed into the links',
    )
    pins: dict[Name, PinKind] = Field(
        default={}, description='the same of single points: { A = "bearing" }'
    )
    pin_diameter: Length = Field(default=5.0, description="of the pins")
    discs: Annotated[dict[Name, Length], Field(min_length=1)] | None = Field(
        default=None,
        description="diameter of pins through which their link's shaft goes: eccentrics, with a strap round each",
    )
    wall: Length = Field(default=2.0, description="round each hole")
    head: Length = Field(
        default=1.5, description="of a pin: its height, and how far it stands out all round"
    )
    base_thickness: Length = Field(default=5.0, description="of the ground's plate")
    shaft_diameter: Length = Field(
        default=6.0, description="of the shaft that drives, with a flat that turns the driven link"
    )
    shaft_flat: Annotated[float, quantity("mm", ge=0, le=1e6)] = Field(
        default=0.8,
        description="depth of that flat; 0: a round shaft, on which all is pressed and glued",
    )
    shaft: Literal["through", "interrupted"] = Field(
        default="through",
        description='"through"; or "interrupted": webs on their own levels, joined by crank pins; rods '
        "sweep over the axis",
    )
    plates: Literal[1, 2] = Field(
        default=1,
        description="2: a second one on posts over all links holds the far ends of pins and shafts",
    )
    shaft_made: Literal["printed", "steel"] = Field(
        default="printed",
        description='"printed"; or "steel": turned, with the flat, as are crank pins that join webs of an '
        "interrupted shaft",
    )
    shaft_length: Length = Field(default=15.0, description="of the shaft below the plate")
    motor: Literal["none", "nema-8", "nema-11", "nema-14", "nema-17", "nema-23"] = Field(
        default="none",
        description='"none"; or "nema-17" (8, 11, 14, 23): screwed under the plate, its own shaft drives',
    )
    can: Can | None = Field(
        default=None,
        description="a motor with a round can in its place, held by a bar behind it",
    )
    set_screw: Literal["none", "M2", "M2.5", "M3", "M4", "M5"] = Field(
        default="none",
        description='"none"; or "M2" to "M5": of a collar at the upper end of a motor\'s shaft, so that '
        "nothing walks off",
    )
    hand_crank: Annotated[float, quantity("mm", ge=0, le=1e6)] = Field(
        default=0.0,
        description="from the shaft to the knob of a crank at its lower end, to turn it by hand; 0: none",
    )
    rail_width: Length = Field(
        default=5.0, description="of the rails on both sides of a link that slides on the plate"
    )
    cover: bool = Field(
        default=True, description="whether a cover, screwed on the rails, holds down what slides"
    )
    mount_diameter: Length = Field(
        default=2.5, description="of the plate's holes for screws from behind: core hole of M3"
    )
    pen_diameter: Annotated[float, quantity("mm", ge=0, le=1e6)] = Field(
        default=3.0, description="of the hole at a point that is an output and no pin; 0: none"
    )

    @model_validator(mode="before")
    @classmethod
    def _of_motor(cls, data: Any) -> Any:
        """The shaft is the motor's, where nothing else is said."""
        face = MOTOR_FACES.get(str(data.get("motor"))) if isinstance(data, Mapping) else None
        if face is None:
            return data
        return {
            "shaft_diameter": face.shaft,
            **({"shaft_flat": face.flat} if face.flat else {}),
            **data,
        }

    @property
    def shapes(self) -> dict[str, Shape]:
        """What is special to links, by their names."""
        return self.__pydantic_extra__ or {}

    def shape(self, link: str) -> Shape:
        """What is special to a link."""
        return self.shapes.get(link, Shape.model_validate({}))

    @property
    def shafts_made(self) -> str:
        """How shafts are made, for the list of parts."""
        return TURNED if self.shaft_made == "steel" else "printed"

    @property
    def of_sheet(self) -> bool:
        """Whether all is cut of one sheet."""
        return self.make == "laser"

    @property
    def thick_key(self) -> str:
        """The key that says how thick links are."""
        return "laser.thickness" if self.of_sheet else "parts.thickness"

    @property
    def shoulder(self) -> ShoulderScrew:
        """The thinnest shoulder screw that is as thick as a pin."""
        return next(screw for screw in SHOULDER_SCREWS if screw.diameter >= self.pin_diameter)

    @property
    def hook(self) -> float:
        """Least length of a spring's hooks, inside, mm: its coils begin beside what holds their eyes on the pins."""
        wide = self.pin_diameter / 2 + self.head
        if "shoulder" in (self.pin, *self.pins.values()):
            wide = max(
                wide,
                self.shoulder.diameter / 2 + self.head,
                self.shoulder.head / 2,
                self.shoulder.flats / math.sqrt(3),
            )
        return self.pin_diameter / 2 + wide + HOOK_ROOM

    @property
    def post_screw(self) -> Screw | None:
        """Of the posts of a second plate, whose core hole is that of the plate's other screws; None where no thread has it."""
        return next(
            (SCREWS[thread] for thread, hole in CORE_HOLES.items() if hole == self.mount_diameter),
            None,
        )

    @property
    def least_crank(self) -> float:
        """Shortest hand crank, mm: hubs of shaft and knob beside each other."""
        return self.shaft_diameter / 2 + 2 * self.head + 2 * self.wall + self.pin_diameter

    @property
    def face(self) -> MotorFace | None:
        """Of the motor under the plate."""
        if self.can is None:
            return MOTOR_FACES.get(self.motor)
        c = self.can
        rim = (c.diameter, c.length, c.boss_diameter)
        return in_bar(*rim, self.shaft_diameter, c.screw, self.base_thickness)

    @property
    def shaft_text(self) -> str:
        """The shaft that drives, for the list of parts."""
        if not self.shaft_flat:
            return f"round shaft of {self.shaft_diameter:g}"
        return f"shaft of {self.shaft_diameter:g} with a flat {self.shaft_flat:g} deep"

    def collar(self, press: float, min_wall: float) -> SetScrewHub | None:
        """What holds on a motor's shaft; None where no set screw is asked for."""
        if self.set_screw == "none":
            return None
        return SetScrewHub(
            self.set_screw, self.shaft_diameter + press, self.shaft_flat, min_wall, self.wall
        )

    @property
    def pocket(self) -> float:
        """Depth of the pockets for the heads of its screws, mm."""
        return 0.0 if self.face is None else self.face.screw.height + SUNK

    def faults(self, links: Iterable[str], nozzle: float, min_wall: float = 0.0) -> list[Fault]:
        """Tables of links that are not there, walls that a printer cannot make, a flat that is none."""
        known = [*type(self).model_fields, *links]
        found = [unknown(("parts", name), None, known) for name in self.shapes if name not in known]
        least = f"at least the nozzle, {nozzle:g} mm"
        for link in links:
            thickness = self.shape(link).thickness
            if thickness is not None and link == "ground":
                right = "nothing here: the plate's is parts.base_thickness"
                found.append(Fault(("parts", "ground", "thickness"), f"{thickness:g}", right))
            elif thickness is not None and thickness < nozzle:
                found.append(Fault(("parts", link, "thickness"), f"{thickness:g}", least))
            width = self.shape(link).width
            if width is not None and width < max(nozzle, min_wall):
                thinnest = (
                    least if min_wall < nozzle else f"at least limits.min_wall, {min_wall:g} mm"
                )
                found.append(Fault(("parts", link, "width"), f"{width:g}", thinnest))
        kinds = {self.pin, *self.pins.values()}
        if "dowel" in kinds and self.pin_diameter not in DOWELS:
            right = f"one in which dowels are sold: {', '.join(f'{size:g}' for size in DOWELS)}"
            found.append(Fault(("parts", "pin_diameter"), f"{self.pin_diameter:g}", right))
        if "shoulder" in kinds and self.pin_diameter > SHOULDER_SCREWS[-1].diameter:
            right = f"at most {SHOULDER_SCREWS[-1].diameter:g}, the thickest shoulder screw"
            found.append(Fault(("parts", "pin_diameter"), f"{self.pin_diameter:g}", right))
        if self.set_screw != "none" and self.face is None:
            said = "nothing here: parts.motor, on whose shaft its collar sits"
            found.append(Fault(("parts", "set_screw"), repr(self.set_screw), said))
        if self.face is not None:
            if self.shaft_diameter != self.face.shaft:
                right = (
                    f'{self.face.shaft:g} mm, the shaft of motor = "{self.motor}"; left out, it is'
                )
                found.append(Fault(("parts", "shaft_diameter"), f"{self.shaft_diameter:g}", right))
            elif self.face.flat and self.shaft_flat != self.face.flat:
                over = f"{self.face.shaft - self.face.flat:g} over its flat"
                right = f'{self.face.flat:g} mm, the flat of the shaft of motor = "{self.motor}", {over}; left out, it is'
                found.append(Fault(("parts", "shaft_flat"), f"{self.shaft_flat:g}", right))
            if self.base_thickness < self.pocket + 2 * nozzle:
                right = f"at least {self.pocket + 2 * nozzle:g} mm: the heads of the motor's screws, and a floor"
                found.append(Fault(("parts", "base_thickness"), f"{self.base_thickness:g}", right))
            grip, screw = self.base_thickness - self.pocket, self.face.screw
            if self.face.screw_length(grip) < grip + screw.nominal / 2:
                right = (
                    f"a thickness through which a screw {screw.thread} that is sold holds the motor"
                )
                found.append(Fault(("parts", "base_thickness"), f"{self.base_thickness:g}", right))
        held, floor = self.post_screw if self.plates > 1 else None, SUNK + 2 * nozzle
        if self.plates > 1 and held is None:
            right = f"the core hole of a screw, as the posts have it too: {', '.join(map(str, CORE_HOLES.values()))}"
            found.append(Fault(("parts", "mount_diameter"), f"{self.mount_diameter:g}", right))
        if held is not None and self.base_thickness < held.height + floor:
            right = f"at least {held.height + floor:g} mm: the sunk heads of the posts' screws, and a floor"
            found.append(Fault(("parts", "base_thickness"), f"{self.base_thickness:g}", right))
        if self.head > self.thickness:
            right = f"at most the thickness, {self.thickness:g} mm: it takes one level"
            found.append(Fault(("parts", "head"), f"{self.head:g}", right))
        if self.hand_crank:
            right = f"at least {self.least_crank:g} mm: its knob beside the shaft"
            if self.face is not None:
                right = f"nothing here, or no parts.motor: {self.motor} drives"
            if self.face is not None or self.hand_crank < self.least_crank:
                found.append(Fault(("parts", "hand_crank"), f"{self.hand_crank:g}", right))
            if self.shaft_length < 2 * self.thickness + 2:
                right = f"at least {2 * self.thickness + 2:g} mm: the collar under the plate and the hand crank"
                found.append(Fault(("parts", "shaft_length"), f"{self.shaft_length:g}", right))
        elif self.shaft_length < self.thickness + 2:
            right = f"at least {self.thickness + 2:g} mm: the collar under the plate, and its play"
            found.append(Fault(("parts", "shaft_length"), f"{self.shaft_length:g}", right))
        thin = [
            key
            for key in ("thickness", "wall", "head", "base_thickness", "rail_width")
            if getattr(self, key) < nozzle
        ]
        found += [Fault(("parts", key), f"{getattr(self, key):g}", least) for key in thin]
        if self.can is not None and self.motor != "none":
            right = f'nothing here, or no parts.motor = "{self.motor}": one motor drives'
            found.append(Fault(("parts", "can"), "", right))
        round_ = not self.shaft_flat and self.shaft == "through"
        if not round_ and not 0.05 <= self.shaft_flat / self.shaft_diameter < 0.5:
            right = "between a twentieth and half of shaft_diameter, so that it turns the link"
            found.append(Fault(("parts", "shaft_flat"), f"{self.shaft_flat:g}", right))
        return found
