"""The sizes of a linkage's bodies, and of a machine's on which cams stand."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import AfterValidator, ConfigDict, Field, model_validator

from camgen.errors import Fault, Key
from camgen.geometry.outlines import Contour
from camgen.geometry.rings import Ring
from camgen.parts.catalogue import (
    BEARINGS,
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
    in_sleeve,
)
from camgen.parts.keyways import RANGE, keyway, shaft_keyway
from camgen.parts.part import ROD, SizeNote, d_bore, keyed_bore
from camgen.parts.set_screws import SetScrewHub
from camgen.spec import Coordinate, Distance, Length, Record, quantity, text_of_form, unknown

SIDE_SPACER = "side-spacer"  # between both sides of a machine
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

Bulge = Annotated[float, quantity("tan(sweep / 4)", ge=-1e6, le=1e6)]
Contours = tuple[tuple[tuple[Coordinate, Coordinate, Bulge], ...], ...]  # the outer one first


def contour_faults(path: Key, contours: Contours) -> Iterator[Fault]:
    """Contours that bound no area; path: of their key."""
    for k, rows in enumerate(contours):
        z = np.array(rows).reshape(-1, 3)
        ring = Ring(z[:, 0] + 1j * z[:, 1], z[:, 2])
        if len(rows) < 2 or abs(ring.area) < 1e-6 or (ring.points == ring.ends).any():
            right = "rows of x, y and bulge at different places, round an area"
            yield Fault((*path, k), f"{len(rows)} rows", right)


class Shape(Record):
    """The body of one link, where it differs from the others."""

    hub_diameter: Length | None = Field(
        default=None,
        description="diameter of the hubs; it is also the width of the bands, unless width is given",
    )
    width: Length | None = Field(
        default=None,
        description="width of the band of a link with two holes, whose hubs then stand out",
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
        description="how far the band is bent to the left, seen from the first point; 0: straight; default: as far as needed",
    )
    thickness: Length | None = Field(
        default=None, description="thickness of this link; default: the thickness of all links"
    )
    sole_diameter: Length | None = Field(
        default=None,
        description="diameter of the round sole at an output's point where there is no pin, such as a foot",
    )
    rails: Length | None = Field(
        default=None,
        description="least length of rails beyond the travel of its holes; default: camgen finds it",
    )
    stem: Literal["along", "ahead", "behind", "both"] | None = Field(
        default=None,
        description='where a sliding link has its rails: "along" the travel of its holes, or beyond it "ahead", "behind" or on "both" sides',
    )
    outline: str | None = Field(
        default=None,
        description="an SVG or DXF beside the spec: its largest contour is the link's edge, in the coordinates of [points]",
    )
    contours: Contours | None = Field(
        default=None,
        description="contours read from that file, each as rows of x, y, mm, and bulge",
    )
    drawn_in: str | None = Field(default=None, description="the name of that file")
    outline_at: tuple[Coordinate, Coordinate] = Field(
        default=(0.0, 0.0), description="where the origin of that file lies"
    )
    engrave: (
        Annotated[
            str,
            text_of_form(
                "a text of up to 40 letters, digits and signs but $",
                r"^[!-#%-~]([ -#%-~]*[!-#%-~])?$",
                40,
            ),
        ]
        | None
    ) = Field(default=None, description="text that is engraved in the link, 0.4 mm deep")


PinKind = Literal["printed", "turned", "dowel", "shoulder", "bearing"]
PivotKind = Literal["printed", "turned", "dowel", "shoulder", "bearing", "bush"]
_STEEL_PINS = ("turned", "dowel", "shoulder", "steel")  # the last is an old word for dowel


class Can(Record):
    """A motor under the plate, by its sizes: its boss sits in the plate, two screws draw to the plate what holds it.

    A bar behind a round can; round the gearbox of one with square corners a sleeve, into which that is pressed.
    """

    boss_diameter: Length = Field(description="diameter of the collar round its shaft")
    diameter: Length = Field(description="diameter of the can; of a gearbox its longer side")
    length: Length = Field(description="length of the can, with its gears")
    width: Length | None = Field(
        default=None, description="shorter side of a gearbox with square corners, such as an N20's"
    )
    screw: Literal["M2", "M2.5", "M3", "M4", "M5", "M6"] = Field(
        default="M2", description="thread of the two screws that hold it"
    )


class Battery(Record):
    """A frame under the far side's plate, in which a holder of batteries lies; it is glued on."""

    length: Length = Field(description="length of the battery holder, along x")
    width: Length = Field(description="width of the battery holder, along y")
    height: Length = Field(default=8.0, description="height of the frame")
    at: tuple[Coordinate, Coordinate] = Field(
        description="middle of the frame, in the coordinates of [points]"
    )


class ThreadPosts(Record):
    """Posts over which threads run, one at each point of a thread, over all links."""

    diameter: Length = Field(default=2.0, description="diameter of the posts")
    diameters: dict[Name, Length] = Field(
        default={}, description="diameters of single posts: { M = 3 }"
    )
    height: Length = Field(
        default=6.0, description="height of the posts above the highest link, up to their heads"
    )
    groove: Distance = Field(
        default=2.0,
        description="height of the groove that holds the thread; 0: plain posts, along which it slips",
    )
    made: Literal["printed", "steel"] = Field(
        default="printed", description='"printed"; or "steel": turned as drawn'
    )

    def diameter_at(self, point: str) -> float:
        """Of the post at a point, mm."""
        return self.diameters.get(point, self.diameter)

    def faults(self, nozzle: float, head: float) -> Iterator[Fault]:
        """Grooves that cannot be printed, posts whose thread would rub on the heads of pins; head: height of those, mm."""
        path = ("parts", "thread_posts")
        if 0 < self.groove < nozzle:
            right = f"at least the nozzle, {nozzle:g} mm, or 0: none"
            yield Fault((*path, "groove"), f"{self.groove:g}", right)
        least = self.groove + 2 * head if self.groove else nozzle
        if self.height < least:
            right = f"at least {least:g} mm: groove, shoulder, and the heads of pins under it"
            yield Fault((*path, "height"), f"{self.height:g}", right)


class Parts(Record):
    """Sizes of the parts; a table with a link's name is the shape of that link."""

    model_config = ConfigDict(extra="allow")
    __pydantic_extra__: dict[str, Shape] = Field(init=False)

    make: Literal["printed", "laser"] = Field(
        default="printed",
        description='"printed"; or "laser": in layers of the sheet of [laser], with pins and shaft of '
        "steel",
    )
    thickness: Length = Field(default=4.0, description="thickness of links, cams and followers")
    pin: PinKind = Field(
        default="printed",
        description='"printed": with a head; "turned": the same shape in steel; "dowel": bought, of steel, with a printed cap;\n"shoulder": '
        'a shoulder screw with a nut; "bearing": a printed pin in ball bearings that are pressed into the links',
    )
    pins: dict[Name, PivotKind] = Field(
        default={},
        description='the pin of single points, in place of pin: { A = "bearing" }; { O = "bush" } is a shaft in a bronze bush (ISO 4379) '
        "that is pressed into the plate",
    )
    pin_diameter: Length = Field(default=5.0, description="diameter of the pins")
    bearing: str | None = Field(
        default=None,
        description=f'ball bearing of pins = "bearing": {", ".join(BEARINGS)}; its bore is pin_diameter; default: the narrowest of that',
    )
    discs: Annotated[dict[Name, Length], Field(min_length=1)] | None = Field(
        default=None,
        description="diameter of pins so large that a shaft goes through them: eccentrics, or pivots of "
        "the ground; each has a strap round it",
    )
    wall: Length = Field(default=2.0, description="wall round each hole")
    head: Length = Field(
        default=1.5, description="height of a pin's head, and how far it stands out all round"
    )
    base_thickness: Length = Field(default=5.0, description="thickness of the ground's plate")
    shaft_diameter: Length = Field(
        default=6.0,
        description="diameter of the drive shaft; a flat on it turns the driven link",
    )
    shaft_flat: Distance = Field(
        default=0.8,
        description="depth of the shaft's flat; 0: a round shaft, on which you press and glue the parts",
    )
    shaft_key: bool = Field(
        default=False,
        description="true: parallel keys (DIN 6885) in keyways of the shafts (P9 in metal) turn the parts, in place of flats",
    )
    shaft: Literal["through", "interrupted"] = Field(
        default="through",
        description='"through": one straight shaft; "interrupted": webs joined by crank pins, so that rods can sweep across the axis',
    )
    plates: Literal[1, 2] = Field(
        default=1,
        description="2: a second plate, on posts over all links, holds the far ends of pins and shafts",
    )
    sides: Literal[1, 2] = Field(
        default=1,
        description="2: the machine and its mirror image on one shaft, as a walker with legs on both sides; plates = 2 and shaft = "
        '"interrupted" are then the defaults',
    )
    side_phase_deg: Annotated[float, quantity("deg", ge=-360, le=360)] = Field(
        default=180.0, description="how far the far side is ahead of the near side"
    )
    side_gap: Distance = Field(
        default=0.0,
        description="gap between the second plates of both sides, held by spacers: it sets the feet farther apart; 0: plate on plate",
    )
    shaft_made: Literal["printed", "steel"] = Field(
        default="printed",
        description='"printed"; or "steel": turned, with the flat, like the crank pins of an interrupted shaft;\ndefault: "steel" if the '
        "pins are of steel",
    )
    shaft_length: Length = Field(default=15.0, description="length of the shaft below the plate")
    motor: Literal["none", "nema-8", "nema-11", "nema-14", "nema-17", "nema-23", "28byj-48"] = (
        Field(
            default="none",
            description='"none"; or "nema-17" (8, 11, 14, 23) or "28byj-48": a motor under the plate, whose own shaft drives the machine',
        )
    )
    can: Can | None = Field(
        default=None,
        description="in place of motor: a motor with a round can, held by a bar behind it",
    )
    battery: Battery | None = Field(
        default=None,
        description="a frame for a battery holder, under the plate of the far side",
    )
    set_screw: Literal["none", "M2", "M2.5", "M3", "M4", "M5"] = Field(
        default="none",
        description="set screw of a collar at the upper end of a motor's shaft, so that nothing slides "
        'off: "none"; or "M2" to "M5"',
    )
    hand_crank: Distance = Field(
        default=0.0,
        description="radius of a hand crank at the shaft's lower end, from the shaft to the knob; 0: none",
    )
    rail_width: Length = Field(
        default=5.0,
        description="width of the rails on both sides of a link that slides on the plate",
    )
    cover: bool = Field(
        default=True,
        description="true: a cover, screwed on the rails, holds down the links that slide",
    )
    mount_diameter: Length = Field(
        default=2.5,
        description="diameter of the plate's holes for screws from behind: core hole of M3",
    )
    stand: Literal["none", "board", "box"] = Field(
        default="none",
        description='"none": you use your own board or frame; "board": the plate stands upright on a foot, clear of all that moves;\n"box": '
        "the plate lies on walls with finger joints, round a motor; all these sheets are as thick as thickness",
    )
    mount_screws: Literal[2, 3] = Field(
        default=2,
        description="number of screws from behind: one at each end of the plate, a third one farthest from the line between them",
    )
    pen_diameter: Distance = Field(
        default=3.0,
        description="diameter of the hole for a pen, at an output's point where there is no pin; 0: none",
    )
    thread_posts: ThreadPosts | None = Field(
        default=None, description="posts over which threads run"
    )

    @model_validator(mode="before")
    @classmethod
    def _of_other_keys(cls, data: Any) -> Any:
        """The shaft is the motor's, of steel where pins are, and goes on between two plates into a second side, where nothing
        else is said."""
        if not isinstance(data, Mapping):
            return data
        decided: dict[str, Any] = {}
        face = MOTOR_FACES.get(str(data.get("motor")))
        if face is not None:
            decided["shaft_diameter"] = face.shaft
            if face.flat:
                decided["shaft_flat"] = face.flat
        if data.get("pin") in _STEEL_PINS:
            decided["shaft_made"] = "steel"
        if data.get("sides") == 2:
            decided |= {"plates": 2, "shaft": "interrupted"}
        return {**decided, **data}

    @property
    def driven_by_shaft(self) -> Parts:
        """Of the far side of a machine: nothing but its shaft turns it."""
        least = self.thickness + 2
        none = {
            "motor": "none",
            "can": None,
            "set_screw": "none",
            "hand_crank": 0.0,
        }
        return self.model_copy(update={**none, "shaft_length": least})

    @property
    def shapes(self) -> dict[str, Shape]:
        """What is special to links, by their names."""
        return self.__pydantic_extra__ or {}

    def shape(self, link: str) -> Shape:
        """What is special to a link."""
        return self.shapes.get(link, Shape.model_validate({}))

    @property
    def thread_post_sizes(self) -> ThreadPosts:
        """Of the posts over which threads run."""
        return self.thread_posts or ThreadPosts.model_validate({})

    @property
    def shafts_made(self) -> str:
        """How shafts are made, for the parts list."""
        return TURNED if self.shaft_made == "steel" else "printed"

    def rod(self, length: float, flat: str, fit: str = ROD) -> tuple[SizeNote, ...]:
        """Of what a shaft of steel is cut, for the parts list; nothing of one that is printed.

        length: of it, mm; flat: where on it the flat or the keyway is; fit: of the rod.
        """
        if self.shaft_made == "printed":
            return ()
        cut = ""
        if self.shaft_key:
            width, _, depth = self.keyway
            cut = f", keyway {width:g} wide, {depth:g} deep {flat}"
        elif self.shaft_flat:
            cut = f", a flat {self.shaft_flat:g} deep {flat}"
        stock = f"rod {self.shaft_diameter:g} {fit}"
        return (SizeNote(f"{stock} x {length:g}{cut}", stock, length, fit=fit),)

    @property
    def keyway(self) -> tuple[float, float, float]:
        """Width of the keyways of shafts and what sits there, depth in that and in the shaft, mm."""
        usual = keyway(self.shaft_diameter)
        assert usual is not None  # a fault else
        return usual[0], usual[1], shaft_keyway(self.shaft_diameter)[0]

    @property
    def key_room(self) -> float:
        """How far the bore of what a shaft turns reaches over its circle, mm."""
        return self.keyway[1] if self.shaft_key else 0.0

    def shaft_bore(self, fit: float) -> Contour:
        """Of what a shaft turns, with its keyway or flat upwards; fit: by which it is wider, mm."""
        wide = self.shaft_diameter + fit
        if self.shaft_key:
            width, depth, _ = self.keyway
            return keyed_bore(wide, width, depth - fit / 2)
        return d_bore(wide, self.shaft_flat)

    @property
    def shaft_profile(self) -> Contour:
        """Outline of a shaft where what sits there is turned."""
        if self.shaft_key:
            width, _, depth = self.keyway
            return keyed_bore(self.shaft_diameter, width, -depth)
        return d_bore(self.shaft_diameter, self.shaft_flat)

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
        bar = self.base_thickness
        if c.width is not None:
            gearbox = c.diameter, c.width, c.length
            return in_sleeve(gearbox, c.boss_diameter, self.shaft_diameter, c.screw, bar)
        return in_bar(c.diameter, c.length, c.boss_diameter, self.shaft_diameter, c.screw, bar)

    @property
    def shaft_text(self) -> str:
        """The shaft that drives, for the parts list."""
        if self.shaft_key:
            return f"shaft of {self.shaft_diameter:g} with a keyway {self.keyway[0]:g} wide"
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
        links = tuple(links)
        known = [*type(self).model_fields, *links]
        strangers = [name for name in self.shapes if name not in known]
        return [
            *(unknown(("parts", name), None, known) for name in strangers),
            *(fault for link in links for fault in self._shape_faults(link, nozzle, min_wall)),
            *self._pin_faults(),
            *self._motor_faults(nozzle),
            *self._post_faults(nozzle),
            *self._shaft_faults(),
            *self._stand_faults(),
            *(self.thread_posts.faults(nozzle, self.head) if self.thread_posts else ()),
            *(
                self._fault(key, f"at least the nozzle, {nozzle:g} mm")
                for key in ("thickness", "wall", "head", "base_thickness", "rail_width")
                if getattr(self, key) < nozzle
            ),
        ]

    def _fault(self, key: str, right: str) -> Fault:
        """A size or a choice that is wrong."""
        value = getattr(self, key)
        return Fault(
            ("parts", key), f"{value:g}" if isinstance(value, float) else repr(value), right
        )

    def _shape_faults(self, link: str, nozzle: float, min_wall: float) -> Iterator[Fault]:
        """Of one link's body."""
        shape = self.shape(link)
        least = f"at least the nozzle, {nozzle:g} mm"
        if shape.thickness is not None and (link == "ground" or shape.thickness < nozzle):
            right = (
                "no value here: parts.base_thickness is the thickness of the ground's plate"
                if link == "ground"
                else least
            )
            yield Fault(("parts", link, "thickness"), f"{shape.thickness:g}", right)
        if shape.contours is not None and link == "ground":
            yield Fault(("parts", link, "outline"), repr(shape.drawn_in), "a link that moves")
        yield from contour_faults(("parts", link, "contours"), shape.contours or ())
        for key in ("hub_diameter", "width", "bow", "rails", "stem"):
            if shape.contours is not None and getattr(shape, key) is not None:
                right = "no value here: the outline says how wide the link is"
                yield Fault(("parts", link, key), str(getattr(shape, key)), right)
        if shape.width is not None and shape.width < max(nozzle, min_wall):
            right = least if min_wall < nozzle else f"at least limits.min_wall, {min_wall:g} mm"
            yield Fault(("parts", link, "width"), f"{shape.width:g}", right)

    def _pin_faults(self) -> Iterator[Fault]:
        """Of pins of steel, and of their heads."""
        kinds = {self.pin, *self.pins.values()}
        thickest = SHOULDER_SCREWS[-1].diameter
        if "dowel" in kinds and self.pin_diameter not in DOWELS:
            sold = ", ".join(f"{size:g}" for size in DOWELS)
            yield self._fault("pin_diameter", f"a diameter in which dowels are sold: {sold}")
        if "shoulder" in kinds and self.pin_diameter > thickest:
            yield self._fault("pin_diameter", f"at most {thickest:g}, the thickest shoulder screw")
        fitting = [each.name for each in BEARINGS.values() if each.bore == self.pin_diameter]
        if self.bearing not in (None, *fitting):
            sold = ", ".join(fitting) or "none is sold"
            yield self._fault("bearing", f"one with a bore of {self.pin_diameter:g} mm: {sold}")
        if self.head > self.thickness:
            yield self._fault(
                "head",
                f"at most parts.thickness, {self.thickness:g} mm, because a head takes one level",
            )

    def _motor_faults(self, nozzle: float) -> Iterator[Fault]:
        """Of the motor that is named, its screws in the plate, and what sits on its shaft."""
        if self.can is not None and self.motor != "none":
            right = f'no table here, or no parts.motor = "{self.motor}": only one motor drives'
            yield Fault(("parts", "can"), "", right)
        face = self.face
        if face is None:
            if self.set_screw != "none":
                right = "no value here without parts.motor: the collar with the screw sits on the motor's shaft"
                yield self._fault("set_screw", right)
            return
        motor = f'of motor = "{self.motor}"'
        if self.shaft_diameter != face.shaft:
            yield self._fault(
                "shaft_diameter",
                f"{face.shaft:g} mm, the shaft {motor}; without this key camgen takes it",
            )
        elif face.flat and self.shaft_flat != face.flat:
            over = f"{face.shaft - face.flat:g} over its flat"
            right = f"{face.flat:g} mm, the flat of the shaft {motor}, {over}; without this key camgen takes it"
            yield self._fault("shaft_flat", right)
        least = self.pocket + 2 * nozzle
        if self.base_thickness < least:
            right = (
                f"at least {least:g} mm, for the heads of the motor's screws and a floor under them"
            )
            yield self._fault("base_thickness", right)
        grip = self.base_thickness - self.pocket
        screw = face.screw
        if face.screw_length(grip) < grip + screw.nominal / 2:
            right = f"a thickness through which a screw {screw.thread} that is sold holds the motor"
            yield self._fault("base_thickness", right)

    def _post_faults(self, nozzle: float) -> Iterator[Fault]:
        """Of the screws that hold a second plate on its posts."""
        if self.plates == 1:
            return
        screw = self.post_screw
        if screw is None:
            holes = ", ".join(map(str, CORE_HOLES.values()))
            right = f"the core hole of a screw, because the posts have the same: {holes}"
            yield self._fault("mount_diameter", right)
            return
        least = screw.height + SUNK + 2 * nozzle
        if self.base_thickness < least:
            right = f"at least {least:g} mm, for the sunk heads of the posts' screws and a floor under them"
            yield self._fault("base_thickness", right)

    def _stand_faults(self) -> Iterator[Fault]:
        """Of what the plate stands on."""
        if self.stand == "box" and self.hand_crank:
            right = '"board", or no parts.hand_crank: a hand cannot reach into a box'
            yield self._fault("stand", right)
        if self.stand != "none" and self.sides == 2:
            right = '"none" beside parts.sides = 2: a machine of two sides stands by itself'
            yield self._fault("stand", right)

    def _shaft_faults(self) -> Iterator[Fault]:
        """Of the driven shaft, its flat or its keys, and its hand crank."""
        if self.shaft_key:
            yield from self._key_faults()
        least = self.thickness + 2
        held = "the collar under the plate and its play"
        if self.hand_crank:
            least = 2 * self.thickness + 2
            held = "the collar under the plate and the hand crank"
            if self.face is not None:
                right = f"0, or no parts.motor: {self.motor} already drives"
                yield self._fault("hand_crank", right)
            elif self.hand_crank < self.least_crank:
                right = f"at least {self.least_crank:g} mm, so that the knob clears the shaft"
                yield self._fault("hand_crank", right)
        if self.shaft_length < least:
            yield self._fault("shaft_length", f"at least {least:g} mm, for {held}")
        flat = (self.shaft_flat and not self.shaft_key) or self.shaft != "through"
        if flat and not 0.05 <= self.shaft_flat / self.shaft_diameter < 0.5:
            thin, half = 0.05 * self.shaft_diameter, self.shaft_diameter / 2
            right = f"{thin:g} to less than {half:g} mm on this shaft, so that it turns the link"
            yield self._fault("shaft_flat", right)

    def _key_faults(self) -> Iterator[Fault]:
        """Of keys on shafts that have none."""
        if keyway(self.shaft_diameter) is None:
            yield self._fault("shaft_diameter", RANGE)
        others = (
            ("shaft_made", self.shaft_made == "printed", '"steel": a key is for shafts of steel'),
            ("make", self.of_sheet, '"printed", or no parts.shaft_key: keys are no sheet'),
            ("shaft", self.shaft != "through", '"through", or no parts.shaft_key: webs have flats'),
        )
        yield from (self._fault(key, right) for key, wrong, right in others if wrong)
        if self.discs is not None:
            right = "false beside parts.discs: flats turn eccentrics"
            yield Fault(("parts", "shaft_key"), "true", right)
        if self.motor != "none" or self.can is not None:
            right = "false beside a motor, whose shaft has no keyway"
            yield Fault(("parts", "shaft_key"), "true", right)
