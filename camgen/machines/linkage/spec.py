"""What the spec of a linkage says: its tables, what turns it, and the drawing that they make.

[points]   roughly where things are at theta = 0          [lengths]  exact distances
[links]    bodies by the points that they carry           [drive]    what turns: all round, or to and fro over range_deg
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from typing import Annotated, Any, ClassVar

from pydantic import Field

from camgen.machine import model as m
from camgen.machine.cams.limits import Advice
from camgen.machines import included as inc
from camgen.machines.linkage import (
    cycloids,
    freewheels,
    pens,
    planets,
    sheets,
)
from camgen.machines.linkage import springs as coils
from camgen.machines.linkage import tables as t
from camgen.machines.linkage.drawing import Drawing
from camgen.machines.linkage.drawn_machine import DrawnMachine
from camgen.machines.loads.counterweights import Counterweight
from camgen.machines.loads.fitted_motor import without_hand
from camgen.machines.loads.tables import Drives
from camgen.machines.mechanism import Mechanism
from camgen.motion.program import Program
from camgen.parts import materials
from camgen.parts.assembly import Cycle
from camgen.parts.generator.connections import Fitting
from camgen.parts.generator.layout import Layout
from camgen.parts.generator.sizes import Name, Parts
from camgen.reading import Data
from camgen.vocabulary import OldWords, Wording

_MOST_ROUNDS = 200  # of a drive, that bring round the carrier of planets


@dataclass(frozen=True)
class Additions:
    """What a template says of its linkage beside the tables."""

    fitting: Callable[[Layout], Fitting] | None = None  # parts beside those of the joints
    programs: Mapping[str, Program] = field(default_factory=dict)  # of cams, by their joints
    loads: tuple[m.Load, ...] = ()
    advice: Advice | None = None  # on its cams
    drive: m.Law | None = None  # angle of the driven link, over theta
    beneath: str | None = None  # link that hangs under the plate with what drives it


def _upright(data: Any) -> Any:
    """The tables with gravity downwards where the machine stands upright and nothing else is said."""
    if not isinstance(data, dict) or not isinstance(data.get("parts"), dict):
        return data
    load = data.get("load", {})
    stands = data["parts"].get("stand") == "board"
    if not stands or not isinstance(load, dict) or "gravity_deg" in load:
        return data
    return {**data, "load": {**load, "gravity_deg": -90.0}}


class LinkageSpec(Mechanism):
    """Spec of a linkage; angles rad, places mm."""

    old_words: ClassVar[OldWords] = {
        **Mechanism.old_words,
        ("motor", "shaft_diameter"): ("parts", "shaft_diameter"),
    }

    points: t.Points = Field(description="where the points are at theta = 0")
    links: t.Links = Field(
        description="bodies by their points; two that share a point are pinned there; ground stands still"
    )
    lengths: t.Lengths = Field(
        default={}, description="exact distances between two points of one link"
    )
    driving: Annotated[t.Drives, Field(alias="drive")] = Field(
        description="what turns the machine; [[drive]] twice: two motors, each with its program",
        json_schema_extra={
            "form": "a table [drive] with the link that turns, or the slide that is pushed; [[drive]] for each of several"
        },
    )
    pen: t.Pen | None = Field(
        default=None, description="a point that two motors lead along a line, in place of programs"
    )
    slides: Annotated[tuple[t.Slide, ...], Field(alias="slide")] = Field(
        default=(), description="a link that moves along a line of another"
    )
    slots: Annotated[tuple[t.Slot, ...], Field(alias="slot")] = Field(
        default=(), description="a pin of one link in a straight slot of another, or of the ground"
    )
    gears: Annotated[tuple[t.Gear, ...], Field(alias="gear")] = Field(
        default=(), description="angle of b = ratio * angle of a"
    )
    planets: Annotated[tuple[t.Planets, ...], Field(max_length=10)] = Field(
        default=(), description="planets on a carrier, round a sun and in a ring"
    )
    cams: Annotated[tuple[t.Cam, ...], Field(alias="cam")] = Field(
        default=(),
        description="the outline of `cam` is made so that `follower` moves by the segments",
    )
    genevas: Annotated[tuple[t.Geneva, ...], Field(alias="geneva", max_length=20)] = Field(
        default=(),
        description="a crank that turns a slotted wheel on by steps, and holds it between",
    )
    noncirculars: Annotated[
        tuple[t.Noncircular, ...], Field(alias="noncircular", max_length=20)
    ] = Field(
        default=(),
        description="two toothed wheels that are not round: one turns the other at a ratio that varies over the turn",
    )
    mutilated: Annotated[tuple[t.Mutilated, ...], Field(max_length=20)] = Field(
        default=(),
        description="gears with teeth on a part of the driver's rim: a wheel that turns by stations, and stands between",
    )
    ratchets: Annotated[tuple[t.Ratchet, ...], Field(alias="ratchet", max_length=20)] = Field(
        default=(),
        description="a wheel that turns one way past a pawl, which falls behind each tooth",
    )
    cycloids: Annotated[tuple[t.Cycloid, ...], Field(alias="cycloid", max_length=10)] = Field(
        default=(),
        description="a disc on an eccentric that rolls inside pins: few parts for a large reduction",
    )
    freewheels: Annotated[tuple[t.Freewheel, ...], Field(alias="freewheel", max_length=20)] = Field(
        default=(),
        description="a link that turns on by steps; a wheel that goes to and fro drives it",
    )
    springs: Annotated[tuple[t.Spring, ...], Field(alias="spring", max_length=20)] = Field(
        default=(),
        description="an extension spring between the pins of two points, of two links; bought, on its own "
        "level",
    )
    wanted: Annotated[tuple[t.Wanted, ...], Field(alias="output", max_length=50)] = Field(
        default=(), description="what is judged and shown; several are allowed"
    )
    includes: Annotated[tuple[t.Include, ...], Field(alias="include", max_length=20)] = Field(
        default=(), description="another spec's machine on the same shaft, printed as this one is"
    )
    motor: Drives | None = Field(default=None, description="what turns the driven link")
    counterweight: Counterweight | None = Field(
        default=None, description="a sector of a disc on the shaft of the driven link: balances it"
    )
    walk: t.Walk | None = Field(
        default=None, description="how the machine stands and walks on a floor"
    )
    masses: dict[Name, t.Masses] = Field(
        default={}, description="masses of links, in place of those of their solids"
    )
    making: Annotated[Parts, Field(alias="parts")] = Field(
        default=Parts.model_validate({}), description="sizes of the parts"
    )
    layers: t.Layers = Field(
        default={},
        description="level of a link, cam or gear, 1 is the lowest; 0 puts a counterweight under the plate; default: camgen finds it",
    )
    allowed: Annotated[t.LinkageLimits, Field(alias="limits")] = Field(
        default=t.LinkageLimits.model_validate({}),
        description="what you accept: beyond a limit its finding fails",
    )

    @property
    def drives(self) -> tuple[t.OneDrive, ...]:
        """What turns it, a motor each."""
        return self.driving if isinstance(self.driving, tuple) else (self.driving,)

    @property
    def programmed(self) -> bool:
        """Whether a drive runs a program, its own or a line's."""
        return self.pen is not None or any(each.segments for each in self.drives)

    @property
    def drive(self) -> t.OneDrive:
        """The first of them, by whose speed theta grows."""
        return self.drives[0]

    @classmethod
    def filled(cls, data: Any) -> Any:
        """The tables with what one of them decides in another."""
        return super().filled(_upright(freewheels.filled(sheets.filled(pens.filled(data)))))

    @classmethod
    def wording(cls, data: Data) -> Wording:
        """The tables in the words of today; an [output] with keys of an [[output]] is that one, not the old word of [files]."""
        output = data.get("output")
        mistaken = isinstance(output, dict) and output.keys() & t.Wanted.model_fields.keys()
        return without_hand(Wording(data, {}, ()) if mistaken else super().wording(data))

    @cached_property
    def host(self) -> inc.Host:
        """As what it includes sees it."""
        return inc.Host(self.model_dump(by_alias=True, exclude_none=True), self.drive.speed_rpm)

    @cached_property
    def diagram(self) -> Drawing:
        """The kinematic diagram that its tables draw."""
        points, links = planets.expanded(self.planets, self.points, self.links, self.lengths)
        points, links = cycloids.expanded(self.cycloids, points, links, self.lengths)
        return Drawing(
            points,
            links,
            self.lengths,
            self.drives,
            self.slides,
            self.slots,
            self.gears,
            self.cams,
            self.wanted,
            self.masses,
            self.allowed,
            self._rooms,
            None if self.load is None else self.load.stiffness,
            self.freewheels,
            self.additions.programs,
            self.additions.advice,
            self.print.slide_clearance + self.print.press_clearance,
            self.genevas,
            (self.print.slide_clearance / 2, self.making.wall),
            self.planets,
            self.noncirculars,
            self.cycloids,
            self.ratchets,
            self.mutilated,
        )

    @cached_property
    def drawn(self) -> DrawnMachine:
        """The machine of that."""
        return DrawnMachine(self.diagram)

    @property
    def _rooms(self) -> Mapping[str, float]:
        """Radius of the circle that a cam must hold, by its closure, mm: its shaft, a groove's pins, with walls."""
        sizes = self.making
        wall = self.allowed.min_wall
        shaft = (sizes.shaft_diameter + self.print.press_clearance) / 2 + 2 * wall
        plain = dict.fromkeys(("force", "conjugate"), shaft)
        return {**plain, "groove": shaft + wall + 1.5 * sizes.pin_diameter}

    @property
    def _speed(self) -> float:
        """Speed of the driven link, rad/s; of one that goes to and fro its greatest, a period being a turn."""
        return self.drive.speed_rpm * math.tau / 60

    @cached_property
    def cycle(self) -> Cycle:
        """How theta runs; what it is called depends on what is made."""
        low, high = self.drive.range_deg or (0.0, 360.0)
        to_and_fro = self.drive.range_deg is not None
        return Cycle(
            math.radians(low),
            math.radians(high),
            sense=self._sense,
            to_and_fro=to_and_fro,
            unit=self.drive.unit,
        )

    @cached_property
    def additions(self) -> Additions:
        """What a template says beside its linkage's tables."""
        return Additions()

    def angle_name(self, cams: bool) -> str:
        """What theta is called; cams: whether any are made."""
        if isinstance(self.drive, t.SlidingDrive):
            return "travel of the drive"
        if self.drive.range_deg is not None or self.programmed:
            return "drive angle"
        return "cam angle" if cams else "crank angle"

    @property
    def down(self) -> complex:
        """Where gravity points, a unit complex."""
        deg = None if self.load is None else self.load.gravity_deg
        return -1j if deg is None else cmath.exp(1j * math.radians(deg))

    @cached_property
    def rounds(self) -> int:
        """Turns of the drive that bring round carriers and rings of planets, and cycloidal discs; 1 where none are known."""
        moving = [link for row in self.planets for link in (row.carrier, row.ring) if link]
        moving += [row.disc for row in self.cycloids]
        rates = [rate for link in moving if (rate := self.diagram.turns_of(link)) is not None]
        return math.lcm(
            *(Fraction(rate).limit_denominator(_MOST_ROUNDS).denominator for rate in rates)
        )

    @cached_property
    def returning(self) -> Sequence[coils.Returning]:
        """Where the springs hang that return followers."""
        if not self.diagram.returns:
            return ()
        play = self.print.slide_clearance
        lasting = materials.of(self.material.name).metal
        return coils.returning(self.drawn.closed(), self.diagram, self.making, play, lasting)
