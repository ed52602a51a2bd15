"""The tables of `mechanism = "linkage"`: points, links, lengths, a drive, and what joins and drives the links.

Drawn in one position, dimensioned exactly: points say roughly where things are at theta = 0 and so pick the branch;
lengths override drawn distances. Two links that share a point are pinned there.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, Protocol

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, Discriminator, Field, Tag

from camgen.errors import Fault, Key, SpecError, counted
from camgen.machine.cams.limits import CamLimits
from camgen.machine.targets import (
    Dwell,
    Function,
    Lines,
    Straight,
    Stroke,
    Target,
    Through,
    TimeRatio,
    Trace,
)
from camgen.machines.loads.tables import CamLimitsTable
from camgen.machines.pairs import Air
from camgen.motion.closed import Harmonics, closed_program
from camgen.motion.pen import Corners, closed_line
from camgen.motion.program import Program
from camgen.motion.segments import Kind, Span, WholeTurn, program
from camgen.parts.gears import MOST_TEETH, GearWish
from camgen.parts.generator.sizes import Name
from camgen.parts.wheels.noncircular import WaveLaw, ellipses
from camgen.settings import quotient
from camgen.spec import (
    Coordinate,
    Distance,
    Force,
    Length,
    MinWall,
    Record,
    Rpm,
    quantity,
    turning,
    unknown,
)

Place = tuple[Coordinate, Coordinate]
Two = tuple[Name, Name]
WheelTeeth = Annotated[int, quantity("1", ge=5, le=MOST_TEETH)]
Degrees = Annotated[float, quantity("deg", ge=-36000, le=36000)]
Stretch = Annotated[float, quantity("mm", ge=-360, le=360)]


class DriveSegment(Span):
    """One segment of a drive's program, such as a stepper runs; a rise turns the driven link counter-clockwise."""

    kind: Kind | None = Field(
        default=None,
        description='"rise": counter-clockwise; "return": clockwise; or "dwell"; you may leave it out if to_deg shows which',
    )
    lift_deg: Annotated[float, quantity("deg", ge=1e-3, le=3600)] | None = Field(
        default=None,
        description="how far the driven link turns: back at 0 in the end, or on by whole turns; or to_deg "
        "= 360",
    )
    to_deg: Annotated[float, quantity("deg", ge=-3600, le=3600)] | None = Field(
        default=None, description="angle of the driven link at the end of the segment"
    )

    @property
    def way(self) -> tuple[float | None, float | None]:
        """How far the link turns, and where it ends, deg."""
        return self.lift_deg, self.to_deg


class Drive(Record):
    """What turns: a link that is pinned to the ground, all the way round or to and fro, evenly or by a program."""

    range_key: ClassVar[str] = "range_deg"
    unit: ClassVar[str] = "deg"  # of theta

    link: Name = Field(description="the driven link; it must be pinned to the ground")
    speed_rpm: Annotated[Rpm, turning(0.001)] = Field(
        default=60.0, description="speed of the driven link; below 0: clockwise"
    )
    range_deg: tuple[Degrees, Degrees] | None = Field(
        default=None,
        description="least and greatest angle, counted from the drawn position: the drive then goes to and fro instead of round",
    )
    segments: Annotated[
        tuple[DriveSegment, ...],
        Field(alias="segment", max_length=100),
        WholeTurn,
    ] = Field(
        default=(),
        description="a program in place of an even turn, as a stepper runs it; speed_rpm is then the number of periods per minute",
    )

    def program(self, path: Key = ("drive",)) -> Program | None:
        """Of the driven link from its drawn angle, rad over a period of 2 pi; None where it turns evenly; SpecError."""
        rows = tuple(row.table for row in self.segments)
        return program(rows, math.radians(1), (*path, "segment"), 360.0, "_deg") if rows else None

    def faults(self, path: Key = ("drive",)) -> list[Fault]:
        """What does not go together."""
        if not self.segments:
            return []
        if self.range_deg is not None:
            return [
                Fault(
                    (*path, "range_deg"),
                    str(list(self.range_deg)),
                    "no value here: the segments say how far the drive goes",
                )
            ]
        if self.speed_rpm < 0:
            return [
                Fault(
                    (*path, "speed_rpm"),
                    f"{self.speed_rpm:g}",
                    "above 0, periods of the program: a return turns clockwise",
                )
            ]
        try:
            self.program(path)
        except SpecError as error:
            return list(error.faults)
        return []


class SlidingDrive(Record):
    """What slides: a link of a [[slide]] on the ground, to and fro along it. A degree of theta stands for a millimetre."""

    range_key: ClassVar[str] = "range"
    unit: ClassVar[str] = "mm"

    slide: Name = Field(
        description="in place of link: the link of a [[slide]] on the ground drives, to and fro"
    )
    speed: Annotated[float, quantity("mm/s", gt=0, le=1e5)] = Field(
        default=20.0, description="speed of a drive that slides"
    )
    range: tuple[Stretch, Stretch] = Field(
        description="least and greatest position of a drive that slides, counted from the drawn one"
    )

    @property
    def link(self) -> str:
        """The driven link."""
        return self.slide

    @property
    def range_deg(self) -> tuple[float, float]:
        """The range in degrees of theta."""
        return self.range

    @property
    def speed_rpm(self) -> float:
        """The speed in turns of theta a minute."""
        return self.speed / 6

    @property
    def segments(self) -> tuple[()]:
        """Of a program: none."""
        return ()

    def program(self, path: Key = ()) -> None:
        """It has none."""

    def faults(self, path: Key = ()) -> list[Fault]:
        """What does not go together: nothing."""
        return []


OneDrive = Drive | SlidingDrive


def _with_speeds(value: object) -> object:
    """A list of drives in which those that say no speed have that of the first, or, if it is none, any: one fault is enough."""
    if not isinstance(value, list | tuple) or not value or not isinstance(value[0], Mapping):
        return value
    first = value[0].get("speed_rpm")
    speed = first if isinstance(first, int | float) and first else 1.0
    others = [{"speed_rpm": speed, **row} if isinstance(row, Mapping) else row for row in value[1:]]
    return (value[0], *others)


def _kind_of_drive(value: object) -> str:
    if isinstance(value, list | tuple):
        return "several"
    slides = isinstance(value, SlidingDrive) or (isinstance(value, Mapping) and "slide" in value)
    return "sliding" if slides else "one"


# One table, or a list: a motor each, over one theta.
Drives = Annotated[
    Annotated[Drive, Tag("one")]
    | Annotated[SlidingDrive, Tag("sliding")]
    | Annotated[tuple[Drive, ...], Field(min_length=1, max_length=8), Tag("several")],
    Discriminator(_kind_of_drive),
    BeforeValidator(_with_speeds),
]


class Pen(Record):
    """A point that two motors lead along a line: what they turn follows from it, in place of programs of their own."""

    point: Name = Field(description="the point that draws; an output of it is judged by the line")
    line: (
        Annotated[str, Field(max_length=300)]
        | Annotated[tuple[Place, ...], Field(min_length=3, max_length=20_000)]
    ) = Field(
        description="one line: an SVG or DXF, a CSV of points, or [x, y] of its corners in order; an open one is drawn there and back"
    )
    at: Place | None = Field(
        default=None,
        description="where the middle of its box is on the ground; default: as drawn",
    )
    width: Annotated[float, quantity("mm", ge=3, le=3000)] | None = Field(
        default=None, description="width of the drawing; default: as drawn"
    )
    tolerance: Annotated[float, quantity("mm", ge=0.01, le=5)] = Field(
        default=0.1, description="how far the pen may be off the line, either way"
    )
    corners: Corners = Field(
        default="round",
        description="whether the pen rounds sharp corners within the tolerance, or stops in them",
    )
    drawn_in: str | None = Field(default=None, description="file that the line was read from")

    @property
    def closed(self) -> NDArray[np.complex128] | None:
        """Corners of the closed line on the ground, (n,) complex mm, the first not repeated; None where it is no line."""
        if isinstance(self.line, str):
            return None
        z = closed_line(np.array([complex(*place) for place in self.line]), self.width)
        if z is None or self.at is None:
            return z
        middle = complex(z.real.max() + z.real.min(), z.imag.max() + z.imag.min()) / 2
        return np.asarray(z - middle + complex(*self.at))

    def faults(self, drives: Sequence[OneDrive]) -> Iterator[Fault]:
        """A line that is none, and what the drives say besides."""
        if isinstance(self.line, str):
            right = "its points: only a spec in a file can name another file"
            yield Fault(("pen", "line"), self.line, right)
        elif self.closed is None:
            right = "a line of at least 3 different points, 1 mm across or more"
            yield Fault(("pen", "line"), f"{len(self.line)} points", right)
        if len(drives) != 2:
            right = "[[drive]] twice beside [pen]: two motors lead a point"
            yield Fault(("drive",), counted(len(drives), "drive"), right)
            return
        for k, drive in enumerate(drives):
            right = "no value here: [pen] says how the drive turns"
            if drive.segments:
                typed = counted(len(drive.segments), "segment")
                yield Fault(("drive", k, "segment"), typed, right)
            if drive.range_deg is not None:
                yield Fault(("drive", k, "range_deg"), str(list(drive.range_deg)), right)
            if drive.speed_rpm != abs(drives[0].speed_rpm):
                right = f"{abs(drives[0].speed_rpm):g}, drawings a minute, of both"
                yield Fault(("drive", k, "speed_rpm"), f"{drive.speed_rpm:g}", right)


JointName = Annotated[
    Name | None, Field(description="name of the joint; default: the names of both links")
]


class Jointed(Protocol):
    """A table that makes a joint."""

    @property
    def joint(self) -> str:
        """Its name."""


class Pair(Record):
    """Two links, a and b, of which one turns the other."""

    if TYPE_CHECKING:
        a: Name
        b: Name
        name: JointName

    @property
    def joint(self) -> str:
        """Name of its joint."""
        return self.name or f"{self.a} to {self.b}"


class Slide(Record):
    """A link that moves along a line of another; it keeps its drawn angle to it and distance from it."""

    link: Name = Field(description="the link that slides")
    on: Name = Field(default="ground", description="the link that guides it")
    along: Two = Field(description="two points of `on`: the guide's direction")
    name: Name | None = Field(
        default=None, description="name of the joint; default: the link's name"
    )

    @property
    def joint(self) -> str:
        """Name of its joint."""
        return self.name or f"{self.link} slide"


class Slot(Record):
    """A pin of one link in a straight slot of another."""

    pin: Name = Field(description="the point of another link that is the pin")
    link: Name = Field(description="the link with the slot")
    along: Two = Field(
        description="two points of `link`: the slot's direction only; its ends follow from the travel of "
        "the pin"
    )
    name: Name | None = Field(
        default=None, description="name of the joint; default: the names of pin and link"
    )

    @property
    def joint(self) -> str:
        """Name of its joint."""
        return self.name or f"{self.pin} in {self.link}"


class Gear(Pair):
    """Two links that turn at a ratio: angle of b = ratio * angle of a, seen from the link that carries both."""

    a: Name = Field(description="the first link")
    b: Name = Field(description="the second link")
    ratio: Annotated[float, quantity("1", ge=-1000, le=1000), BeforeValidator(quotient)] = Field(
        description="angle of b = ratio * angle of a, a number or teeth of a over those of b, "
        '"-12/30"; below 0: they turn against each other, above 0: b is a ring, inner = true'
    )
    inner: bool = Field(
        default=False,
        description="true: b is a ring with its teeth inside, in which the wheel of a runs; the ratio is then above 0",
    )
    teeth: WheelTeeth | None = Field(
        default=None, description="teeth of the wheel of a; default: camgen finds it"
    )
    shift_a: Annotated[float, quantity("1", ge=-1, le=2)] | None = Field(
        default=None,
        description="profile shift of the wheel of a, in modules; above 0 the teeth have thicker roots and no undercut; default: 0",
    )
    shift_b: Annotated[float, quantity("1", ge=-1, le=2)] | None = Field(
        default=None,
        description="profile shift of the wheel of b, in modules; above 0 the teeth of a ring lie farther out; default: 0",
    )
    shift: Literal["balanced"] | None = Field(
        default=None,
        description='"balanced": both profile shifts are found, their sum 0, so that both flanks slide alike',
    )
    relief: Annotated[float, quantity("mm", ge=0, le=1)] = Field(
        default=0.0,
        description="tip relief of both wheels: how far their flanks draw back at the tips",
    )
    spokes: Annotated[int, quantity("1", ge=3, le=12)] | None = Field(
        default=None,
        description="spokes of both wheels, where there is room; default: full discs",
    )
    name: JointName = None

    @property
    def wish(self) -> GearWish:
        """What is asked of its wheels."""
        given = self.shift_a or 0.0, self.shift_b or 0.0
        shifts = None if self.shift == "balanced" else given
        return GearWish(self.teeth, shifts, self.relief, self.spokes or 0, self.inner)


class Geneva(Pair):
    """A Geneva drive: the pin of link a takes the slotted wheel of link b on by one slot a turn; a disc on a's shaft holds it."""

    a: Name = Field(description="the crank: a link that turns on the ground, with the pin")
    b: Name = Field(description="the wheel: another link that turns on the ground")
    pin: Name = Field(
        description="point of the crank that is its pin, with a roller; slots and the distance of the shafts give its radius"
    )
    slots: Annotated[int, quantity("1", ge=3, le=24)] = Field(
        description="number of slots of the wheel: that many turns of the crank turn it once"
    )
    pin_radius: Length = Field(description="radius of the roller on the pin")
    inner: bool = Field(
        default=False,
        description="true: the wheel goes round its crank and its slots open inwards: it turns with the crank, slower and over more than "
        "half of its turn",
    )
    clearance: Annotated[float, quantity("mm", gt=0, le=2)] | None = Field(
        default=None,
        description="gap of the roller in a slot, and of the disc in the wheel, on either side; default: half of print.slide_clearance",
    )
    floor: Annotated[float, quantity("mm", gt=0, le=20)] | None = Field(
        default=None,
        description="gap between the roller where it is deepest and the end of its slot; default: twice clearance",
    )
    gap: Annotated[float, quantity("mm", gt=0, le=20)] | None = Field(
        default=None,
        description="gap between crank and wheel along their axes, larger than the wheel's rim can tip: a dowel then holds the locking "
        "disc on the crank; default: print.slide_clearance, and the shaft alone holds the disc",
    )
    name: JointName = None


class Noncircular(Pair):
    """Two toothed wheels that are not round: link a turns link b against it, at a ratio that varies over the turn."""

    a: Name = Field(description="the driver: a link that turns on the ground")
    b: Name = Field(description="the driven wheel: another link that turns on the ground")
    teeth: WheelTeeth = Field(
        description="teeth of the wheel of a; the distance of both shafts gives their size"
    )
    turns: Annotated[float, quantity("1", ge=0.05, le=20), BeforeValidator(quotient)] = Field(
        default=1.0, description='turns of b for one turn of a, a number or a quotient, "1/2"'
    )
    eccentricity: Annotated[float, quantity("1", gt=0, le=0.9)] | None = Field(
        default=None,
        description="eccentricity of two equal ellipses that turn about a focus each; as drawn, the far end of a's points to b",
    )
    sines_deg: Annotated[tuple[Degrees, ...], Field(max_length=100)] = Field(
        default=(),
        description="waves of b's angle t turns + sum of sines_k sin kt, in a's angle t from the drawn position, k from 1",
    )
    cosines_deg: Annotated[tuple[Degrees, ...], Field(max_length=100)] = Field(
        default=(), description="further waves of b's angle, cosines_k (cos kt - 1)"
    )
    points: Annotated[tuple[tuple[float, float], ...], Field(max_length=20_000)] | None = Field(
        default=None,
        description="in place of waves: rows of angles of a and b over a turn of a, at most 30 deg apart",
        json_schema_extra={"unit": "deg"},
    )
    tolerance_deg: Annotated[float, quantity("deg", gt=0, le=10)] = Field(
        default=0.01, description="how far the waves may be off these rows"
    )
    backlash: Annotated[float, quantity("mm", gt=0, le=5)] | None = Field(
        default=None,
        description="play of the teeth along their pitch lines; default: print.slide_clearance",
    )
    name: JointName = None

    @property
    def law(self) -> WaveLaw:
        """Angle of b over that of a, both above 0, rad; SpecError of rows that make none."""
        if self.eccentricity is not None:
            return ellipses(self.eccentricity)
        if self.points is None:
            waves = (map(math.radians, each) for each in (self.cosines_deg, self.sines_deg))
            return WaveLaw(self.turns, *map(tuple, waves))
        rows = [(t, angle - self.turns * t) for t, angle in self.points]
        try:
            made = closed_program(rows, "points", math.radians(1), self.tolerance_deg)
        except SpecError as error:
            if not any(fault.path == ("tolerance",) for fault in error.faults):
                raise
            raise SpecError(
                [replace(fault, path=("tolerance_deg",)) for fault in error.faults]
            ) from None
        (segment,) = made.segments
        assert isinstance(segment.law.formula, Harmonics)
        terms = np.array(segment.law.formula.terms)[1:] * segment.scale
        waves = terms * np.exp(-1j * made.begin * np.arange(1, len(terms) + 1))
        return WaveLaw(self.turns, tuple(waves.real.tolist()), tuple((-waves.imag).tolist()))


class Cycloid(Record):
    """A cycloidal drive: a disc on a crank's eccentric rolls inside pins of the ground and turns back by one lobe a turn."""

    crank: Name = Field(description="the link that turns on the ground, with the eccentric")
    disc: Name = Field(
        description="the link that is the disc; it has no other point than the eccentric's"
    )
    at: Name = Field(
        description="point of crank and disc: the eccentric's middle, a disc of parts.discs; how far it is from the shaft is the eccentricity"
    )
    pins: Annotated[int, quantity("1", ge=4, le=100)] = Field(
        description="number of pins; the disc has one lobe less, and turns once for as many turns of the crank"
    )
    radius: Length = Field(description="radius of the circle on which the pins are")
    pin_radius: Length = Field(description="radius of a pin")
    discs: Annotated[int, quantity("1", ge=1, le=2)] = Field(
        default=1,
        description="number of discs: a second one, over the first, is on an eccentric opposite, and runs in the same pins; both together are balanced",
    )
    clearance: Annotated[float, quantity("mm", gt=0, le=2)] | None = Field(
        default=None,
        description="gap between the disc and each pin, and round an output pin in its hole; default: half of print.slide_clearance",
    )
    offset: Annotated[float, quantity("mm", ge=-2, le=2)] = Field(
        default=0.0,
        description="how much smaller the circle of pins is for which the disc is cut: a larger gap at the top of its lobes and in its hollows, less on the flanks that drive",
    )
    output: Name | None = Field(
        default=None,
        description="a link on the crank's shaft that turns with the disc, by pins in holes of it",
    )
    output_pins: Annotated[int, quantity("1", ge=3, le=40)] = Field(
        default=6, description="number of the output's pins"
    )
    output_radius: Length | None = Field(
        default=None,
        description="radius of the circle of the output's pins; default: camgen finds it",
    )
    output_pin_radius: Length | None = Field(
        default=None, description="radius of an output pin; default: as large as there is room for"
    )
    name: Name | None = Field(
        default=None, description="name of the joint; default: the names of crank and disc"
    )

    @property
    def joint(self) -> str:
        """Name of the joint of crank and disc."""
        return self.name or f"{self.crank} to {self.disc}"

    @property
    def output_title(self) -> str:
        """Name of the joint of disc and output."""
        return f"{self.disc} to {self.output}"

    @property
    def twin(self) -> Cycloid | None:
        """The second disc, as a drive of its own."""
        if self.discs == 1:
            return None
        changes = {"at": f"{self.at}_2", "disc": f"{self.disc}_2", "discs": 1}
        name = None if self.name is None else f"{self.name}_2"
        return self.model_copy(update=changes | {"name": name})


class Mutilated(Pair):
    """Mutilated gears: link a has teeth on a part of its rim, which turn link b by one station a turn; the rest of its rim holds b."""

    a: Name = Field(description="the driver: a link that turns on the ground, always in one sense")
    b: Name = Field(
        description="the wheel: another link that turns on the ground; it stands as drawn"
    )
    teeth: tuple[WheelTeeth, WheelTeeth] = Field(
        description="teeth of a, if it had them all round, and of b; the distance of both shafts gives their size"
    )
    stations: Annotated[int, quantity("1", ge=1, le=50)] = Field(
        description="stations of b in a turn, over which its teeth divide; it turns by one in each turn of a"
    )
    backlash: Annotated[float, quantity("mm", gt=0, le=5)] | None = Field(
        default=None,
        description="play of the teeth along their pitch circles; default: print.slide_clearance",
    )
    name: JointName = None


class Ratchet(Pair):
    """A ratchet: the wheel of link a turns one way past the pawl of link b, which falls behind each tooth and holds it the other way."""

    a: Name = Field(description="the wheel: a link that turns on the ground, one way only")
    b: Name = Field(
        description="the pawl: another link that turns on the ground; a [[spring]] draws it to the wheel"
    )
    teeth: Annotated[int, quantity("1", ge=3, le=200)] = Field(description="teeth of the wheel")
    radius: Length = Field(description="radius of the circle on which the tips are")
    depth: Length | None = Field(
        default=None, description="how deep the teeth are; default: an eighth of the radius"
    )
    end_radius: Length = Field(default=1.2, description="radius of the pawl's end")
    draw_deg: Annotated[float, quantity("deg", gt=0, lt=80)] = Field(
        default=38.0,
        description="angle by which a tooth that is turned back draws the pawl in; it and the distance of the shafts give the arm",
    )
    friction: Annotated[float, quantity("1", ge=0, le=3)] = Field(
        default=0.7,
        description="friction coefficient of tooth and pawl at which the pawl is to hold without its spring",
    )
    name: JointName = None

    @property
    def deep(self) -> float:
        """How deep its teeth are, mm."""
        return self.radius / 8 if self.depth is None else self.depth


class Planets(Record):
    """A planetary set: planets on a carrier run round a sun and in a ring; one of these three is fixed, the ground."""

    fixed: Literal["ring", "carrier", "sun"] = Field(
        default="ring", description="what stands still on the ground; it has no link of its own"
    )
    sun: Name | None = Field(default=None, description="the link with the sun's wheel")
    carrier: Name | None = Field(
        default=None, description="the link that carries the planets' pins"
    )
    ring: Name | None = Field(
        default=None,
        description="the link with the ring, whose teeth are inside; none where that is fixed",
    )
    at: Name = Field(
        description="point of the carrier, or of the ground: the first planet's pin; the others are found"
    )
    count: Annotated[int, quantity("1", ge=1, le=12)] = Field(description="planets")
    teeth: tuple[WheelTeeth, WheelTeeth] = Field(
        description="teeth of the sun and of a planet; the ring has those of the sun and twice a planet's"
    )
    spacing: Literal["even", "nearest"] = Field(
        default="even",
        description='"even": planets all as far from each other; "nearest": as the teeth let them, where they do not go in evenly',
    )
    name: Name | None = Field(
        default=None,
        description="name of the set; its planets have this name and a number; default: planet",
    )

    @property
    def joint(self) -> str:
        """Its name."""
        return self.name or "planet"

    @property
    def links(self) -> list[str]:
        """Names of the planets' links."""
        return [f"{self.joint}_{k}" for k in range(1, self.count + 1)]

    @property
    def pins(self) -> list[str]:
        """Points of the planets."""
        return [self.at, *(f"{self.at}_{k}" for k in range(2, self.count + 1))]

    @property
    def all_teeth(self) -> tuple[int, int, int]:
        """Of sun, planet and ring."""
        sun, planet = self.teeth
        return sun, planet, sun + 2 * planet


class Freewheel(Record):
    """A link that turns on: a one-way clutch in a wheel that goes to and fro takes it along, one in the plate holds it."""

    wheel: Name = Field(description="a link on the same shaft, which a gear rocks to and fro")
    link: Name = Field(description="the link that turns on")
    turns: Literal["counter-clockwise", "clockwise"] = Field(
        default="counter-clockwise", description="sense in which it turns on"
    )
    lost_deg: Annotated[float, quantity("deg", ge=0, le=45)] = Field(
        default=1.0, description="turn of the wheel before its clutch locks"
    )
    name: JointName = None

    @property
    def joint(self) -> str:
        """Name of its joint."""
        return self.name or f"{self.wheel} to {self.link}"


class CamSegment(Span):
    """One segment of a cam's program; lift_deg and to_deg for a follower that swings, lift and to for one that slides."""

    kind: Kind | None = Field(
        default=None,
        description='"rise": away from the cam\'s shaft; "return": back to it; or "dwell"; you may leave it out if the end shows which',
    )
    span: Annotated[float, quantity("mm", ge=1e-3, le=1e5)] | None = Field(
        default=None,
        description="how much of the travel of a cam that slides it takes, in place of span_deg",
    )
    lift: Length | None = Field(
        default=None, description="how far a follower slides; or to, where it ends"
    )
    to: Coordinate | None = Field(default=None, description="where the sliding follower ends")
    lift_deg: Annotated[float, quantity("deg", ge=1e-3, le=180)] | None = Field(
        default=None, description="how far a follower swings; or to_deg = 20, where it ends"
    )
    to_deg: Annotated[float, quantity("deg", ge=-180, le=180)] | None = Field(
        default=None, description="where the swinging follower ends"
    )

    @property
    def way(self) -> tuple[float | None, float | None]:
        """How far the follower goes, and where it ends, mm or deg."""
        swings = self.lift_deg is not None or self.to_deg is not None
        return (self.lift_deg, self.to_deg) if swings else (self.lift, self.to)


class ReturnSpring(Record):
    """The spring that presses a follower on its cam: what is not given is found."""

    rate: Annotated[float, quantity("N/mm or N m/rad", ge=0, le=1e6)] = Field(
        default=0.0, description="rate of the spring, as it acts on the follower; 0: found"
    )
    preload: Force = Field(
        default=0.0,
        description="force or torque where the follower is lowest; 0: what keeps it on the cam",
    )
    post: Place | None = Field(
        default=None,
        description="where the spring's end on the ground is; default: in line with the pull, beyond the cam",
    )


class Cam(Record):
    """A cam: the outline of link `cam` is made so that `follower` moves by the segments."""

    cam: Name = Field(
        description="a link that turns on the ground, or the one that drives along a slide: its outline is made"
    )
    follower: Name = Field(description="a link that swings or slides on the ground")
    shape: Literal["roller", "knife", "flat"] = Field(
        default="roller",
        description='tip of the follower: "roller" (with its radius), "knife" or "flat"; default: a roller',
    )
    at: Name = Field(
        description="point of the follower: the roller's centre, the edge, or a point of the face"
    )
    radius: Length | None = Field(default=None, description="radius of the roller")
    closure: Literal["force", "groove", "conjugate"] = Field(
        default="force",
        description='what holds the follower on the cam: "force", "groove" or "conjugate"',
    )
    face_width: Length | None = Field(
        default=None, description="width of a flat face; default: the width of the contact"
    )
    face_offset: Coordinate = Field(
        default=0.0,
        description="how far a flat face that swings lies ahead of its pivot, away from the cam",
    )
    base_radius: Length | Literal["least"] | None = Field(
        default=None,
        description='radius on which the follower stands at theta = 0; "least": the smallest that keeps within [limits], rounded up; '
        "default: as drawn",
    )
    damping: Annotated[float, quantity("N s/mm or N m s/rad", ge=0, le=1e6)] = Field(
        default=0.0, description="damping of the follower, in proportion to its speed"
    )
    resistance: Force = Field(
        default=0.0, description="constant force or torque against the follower's lift"
    )
    spring: ReturnSpring | None = Field(
        default=None,
        description='closure "force": a return spring to a post beyond the cam; with spring = {} camgen finds all its values',
    )
    polydyne: bool = Field(
        default=False,
        description="true: camgen corrects the cam so that the follower, elastic by load.stiffness, follows the program at this speed",
    )
    tip_clearance: Air = 0.0
    name: JointName = None
    segment: Annotated[tuple[CamSegment, ...], Field(min_length=1, max_length=100), WholeTurn] = (
        Field(
            description="segments of the program: lift_deg where the follower swings, lift where it "
            "slides"
        )
    )

    @property
    def joint(self) -> str:
        """Name of its joint."""
        return self.name or f"{self.cam} on {self.follower}"


class Spring(Record):
    """An extension spring between the pins of two points, of two links; it loads the machine."""

    between: Two = Field(description="two points, of two links: its pins")
    rate: Annotated[float, quantity("N/mm", ge=1e-4, le=1e4)] = Field(
        description="rate of the spring: how its pull grows with its length"
    )
    free: Length | None = Field(
        default=None,
        description="free length: up to this distance of its points the spring does not pull",
    )
    preload: Annotated[float, quantity("N", ge=0, le=1e6)] | None = Field(
        default=None, description="pull of the spring where it is shortest, in place of free"
    )
    name: Name | None = Field(
        default=None,
        description="name of the spring, of its level and of its figures; default: spring, with a number if there are several",
    )


class Wanted(Record):
    """One output that is shown and judged: a point's path, a link's angle, a sliding link's place, or the length of a thread;
    and its targets."""

    name: Name = Field(description="name of the output")
    point: Name | None = Field(default=None, description="point whose path is the output")
    link: Name | None = Field(
        default=None, description="link whose angle, or whose place along its slide, is the output"
    )
    thread: Annotated[tuple[Name, ...], Field(min_length=2, max_length=50)] | None = Field(
        default=None,
        description="points in their order: the output is the length of a thread over a post at each of them",
    )
    stroke: Stroke | None = Field(
        default=None, description="how far it should go; for a path the larger side of its box"
    )
    points: Through | None = Field(
        default=None,
        description="places that it should pass; in_order = true, or theta_deg = [0, 40]: when",
    )
    path: Trace | None = Field(
        default=None,
        description="path that it should follow; lines join the places, joined = false: a dense cloud",
    )
    lines: Lines | None = Field(
        default=None,
        description="in place of a path: lines that it should draw with a pen that another output lifts",
    )
    straightness: Straight | None = Field(
        default=None,
        description="a stretch that should be straight, by its length or by range_deg = [310, 370]",
    )
    dwell: Dwell | None = Field(
        default=None,
        description="how long it should rest within a band; at = 60: about that place",
    )
    time_ratio: TimeRatio | None = Field(
        default=None,
        description="wanted ratio of the slower stroke's time to the quicker one's",
    )
    function: Function | None = Field(
        default=None,
        description="pairs of theta and angle that it should keep, both counted from the first",
    )

    @property
    def targets(self) -> tuple[Target, ...]:
        """What is wanted of it by value."""
        every = (
            self.stroke,
            self.points,
            self.path,
            self.lines,
            self.straightness,
            self.dwell,
            self.time_ratio,
            self.function,
        )
        return tuple(target for target in every if target is not None)


class Include(Record):
    """Another spec's machine on the same shaft; printed as this one is, at this one's speed."""

    spec: Annotated[str, Field(max_length=300)] | dict[str, Any] = Field(
        description="path of the other spec, seen from this one's folder; or its tables"
    )
    name: Name | None = Field(
        default=None,
        description="name that stands before the names of its parts; default: the name in its spec",
    )
    at: Place = Field(default=(0.0, 0.0), description="where its origin is on the ground")
    phase_deg: Degrees = Field(default=0.0, description="how far its shaft is ahead of this one's")
    z: Annotated[float, quantity("mm", ge=-1e4, le=1e4)] | None = Field(
        default=None,
        description="how far the machine is raised; default: above all machines before it",
    )
    mounted: bool = Field(
        default=False,
        description="true: on posts on the second plate; where both shafts are in line a sleeve joins "
        "them",
    )
    ride: dict[str, Name] = Field(
        default={},
        description="bodies of the other machine that links of this one carry, in place of its own "
        "guides and cams: body = link",
    )
    ride_tolerance: Distance = Field(
        default=0.01,
        description="how far such a body may be from where the other machine would have it",
    )
    source: str | None = Field(default=None, description="where the tables were read")


class Masses(Record):
    """Mass of a link; what is left out comes from its solid."""

    mass_g: Annotated[float, quantity("g", ge=0, le=1e6)] = Field(description="mass of the link")
    centre: Place | None = Field(
        default=None,
        description="centre of mass, seen from the link's first point, x towards its second",
    )
    inertia_kg_m2: Annotated[float, quantity("kg m^2", ge=0, le=1e6)] = Field(
        default=0.0, description="moment of inertia about the centre of mass"
    )


class Walk(Record):
    """How a machine stands and walks on a floor; with parts.sides = 2 the far side's feet do so too."""

    feet: Annotated[tuple[Name, ...], Field(min_length=2, max_length=50)] = Field(
        description="outputs of points that stand on the floor"
    )
    payload_g: Annotated[float, quantity("g", ge=0, le=1e6)] = Field(
        default=0.0,
        description="mass of what the frame carries besides its own parts, such as motor, battery and freight",
    )
    payload_at: Place | None = Field(
        default=None,
        description="where the centre of mass of this payload is on the ground; default: at the driven shaft",
    )
    friction: Annotated[
        tuple[Annotated[float, quantity("1", gt=0, le=3)], ...], Field(min_length=1, max_length=9)
    ] = Field(
        default=(0.3, 0.6, 1.0),
        description="friction coefficients of feet on the floor: the report has the range over them",
    )

    def faults(self, wanted: Sequence[Wanted]) -> Iterator[Fault]:
        """Feet that are no outputs of points, or named twice; a place of nothing."""
        points = [each.name for each in wanted if each.point is not None]
        for k, name in enumerate(self.feet):
            if name not in points:
                yield unknown(("walk", "feet", k), name, points)
            elif name in self.feet[:k]:
                yield Fault(("walk", "feet", k), name, "each foot once")
        if self.payload_at is not None and not self.payload_g:
            yield Fault(
                ("walk", "payload_at"), str(list(self.payload_at)), "payload_g with it: its mass"
            )


@lru_cache(maxsize=1024)
def pair(key: str) -> tuple[str, str] | None:
    """The two points of a key of [lengths], "A-B"; None where it is none."""
    names = key.split("-")
    return (names[0].strip(), names[1].strip()) if len(names) == 2 and all(names) else None


class LinkageLimits(CamLimitsTable):
    """What you accept: beyond a limit its finding fails."""

    transmission_angle_deg: Annotated[float, quantity("deg", ge=0, lt=90)] = Field(
        default=20.0, description="least transmission angle of each loop"
    )
    undercut: Distance = Field(
        default=0.0, description="motion that a sliding follower may lose by undercut"
    )
    undercut_deg: Annotated[float, quantity("deg", ge=0, le=180)] = Field(
        default=0.0, description="motion that a swinging follower may lose by undercut"
    )
    lash: Distance | None = Field(
        default=None,
        description="greatest free play of an output that is a place or a path; default: a quarter of its stroke, or of the smaller side "
        "of a path that is a loop",
    )
    lash_deg: Annotated[float, quantity("deg", ge=0, le=360)] | None = Field(
        default=None,
        description="greatest free play of an output that is an angle; default: a quarter of its swing",
    )
    min_wall: MinWall = 0.8

    def of_follower(self, slides: bool) -> CamLimits:
        """What is accepted of a cam, by whether its follower slides or swings."""
        return self.of_cams(self.undercut if slides else math.radians(self.undercut_deg))


Points = Annotated[
    dict[Name, Place], Field(json_schema_extra={"form": "a table of points, such as A = [20, 0]"})
]
Links = Annotated[
    dict[Name, Annotated[tuple[Name, ...], Field(min_length=1, max_length=200)]],
    Field(
        json_schema_extra={"form": 'a table of links by their points, such as crank = ["O", "A"]'}
    ),
]
Lengths = dict[str, Length]
Layers = dict[Name, Annotated[int, Field(ge=0, le=60)]]
