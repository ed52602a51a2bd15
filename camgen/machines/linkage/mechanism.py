"""Any planar machine from a spec: `mechanism = "linkage"`.

    [points]   roughly where things are at theta = 0          [lengths]  exact distances
    [links]    bodies by the points that they carry           [drive]    what turns: all round, or to and fro over range_deg
    signal     one number over theta that an output gives: an angle, a place, or a coordinate of a path

theta is the driven link's angle from its drawn position; where a program moves it, the angle of the period, which is time. Of a
drive that goes to and fro the poses are asked for over a
whole period: a harmonic motion from the least angle of the range to the greatest and back.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from typing import Annotated, Any, Self

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field, model_validator

from camgen.errors import CamgenError, DesignError, Fault, SpecError, counted
from camgen.findings import Finding, NotJudged
from camgen.geometry.outlines import Floats
from camgen.machine import model as m
from camgen.machine.cams.limits import Advice
from camgen.machine.features import Balance, CamOutline, Feature
from camgen.machine.forces import Forces
from camgen.machine.freewheels import Ratchet
from camgen.machine.joining import Module, joined
from camgen.machine.programs import DriveLaw
from camgen.machine.reach import refuse_folds, refuse_partial
from camgen.machine.run import Run, solve
from camgen.machine.stepwise import stays_clear
from camgen.machines import included as inc
from camgen.machines.linkage import (
    bridges,
    cycloids,
    figures,
    freewheels,
    lifts,
    motors,
    pens,
    planets,
    ratchets,
    sheets,
    walking,
)
from camgen.machines.linkage import springs as coils
from camgen.machines.linkage import tables as t
from camgen.machines.linkage.asked_range import refuse_range
from camgen.machines.linkage.drawing import Drawing
from camgen.machines.linkage.drawing_faults import drawing_faults, shape_faults
from camgen.machines.linkage.part_names import refuse_alike
from camgen.machines.linkage.weights import counterbalanced, under_faults, weight_faults
from camgen.machines.loads.applied import efforts
from camgen.machines.loads.bearing import LoadCheck
from camgen.machines.loads.counterweights import Counterweight, balance_of, found_moment
from camgen.machines.loads.lift_off import by_force, lift_off, restitution_of
from camgen.machines.loads.tables import Drives
from camgen.machines.loads.weights import gravity, with_masses
from camgen.machines.mechanism import Mechanism, Remarks
from camgen.machines.return_spring import SAMPLES
from camgen.motion.program import Program
from camgen.parts import assembly as assemblies
from camgen.parts import materials
from camgen.parts.assembly import Assembly, Cycle, Feet, FollowerFacts, Frame, MotorSeat
from camgen.parts.catalogue import CLUTCHES, Bearing, turning_text
from camgen.parts.counterweights import NAME
from camgen.parts.generator import webs, wheels
from camgen.parts.generator.beneath import Beneath
from camgen.parts.generator.bodies import Bodies
from camgen.parts.generator.changes import Change
from camgen.parts.generator.coils import coils_of
from camgen.parts.generator.connections import Fitting
from camgen.parts.generator.cures import frames
from camgen.parts.generator.joints import part_name, pivot_of
from camgen.parts.generator.layout import Layout
from camgen.parts.generator.mounted import upper_end
from camgen.parts.generator.plates import with_battery
from camgen.parts.generator.posts import posts
from camgen.parts.generator.sizes import Name, Parts
from camgen.parts.generator.stacking import first_choice, lacking, with_levels
from camgen.parts.generator.table_stand import TableStand, on_stand
from camgen.parts.generator.trials import tried, with_cures
from camgen.parts.journals import journals
from camgen.parts.motors import GEARED, HOLES_UNKNOWN
from camgen.parts.part import Part
from camgen.parts.sides import PREFIX as FAR
from camgen.parts.sides import Mirror, both_sides
from camgen.parts.stiffness import bending_stiffness
from camgen.parts.turning_over import fit_turned_over
from camgen.reading import Data
from camgen.spec import Checked, unknown, validate
from camgen.study import ROWS, Figures, Later, Study, together
from camgen.vocabulary import Wording

_SAMPLES = np.linspace(
    0, math.tau, 1440, endpoint=False
)  # of a period, at which links are looked at for their levels


_MOST_ROUNDS = 200  # of a drive, that bring round the carrier of planets
_SHOWN_TURNS = 8  # of the drive, at most
_SWEPT_TURNS = 100  # of the drive, at most
_MARK = 0.8  # of a hub's radius, to the hole that shows how what turns on stands
_LEAST_GAP = 2.0  # mm, between the second plates of two sides, that a spacer fills


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


class Linkage(Mechanism):
    """Spec and answers of a linkage; angles rad, places mm."""

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
        description="level of a link, cam or gear, 1 is the lowest; 0 puts a counterweight under the "
        "plate; found unless given",
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
    def _programmed(self) -> bool:
        """Whether a drive runs a program, its own or a line's."""
        return self.pen is not None or any(each.segments for each in self.drives)

    @property
    def drive(self) -> t.OneDrive:
        """The first of them, by whose speed theta grows."""
        return self.drives[0]

    @model_validator(mode="before")
    @classmethod
    def _of_sheet(cls, data: Any) -> Any:
        return _upright(freewheels.filled(sheets.filled(pens.filled(data))))

    @classmethod
    def wording(cls, data: Data) -> Wording:
        """The tables in the words of today; an [output] with keys of an [[output]] is that one, not the old word of [files]."""
        output = data.get("output")
        mistaken = isinstance(output, dict) and output.keys() & t.Wanted.model_fields.keys()
        return Wording(data, {}, ()) if mistaken else super().wording(data)

    def faults(self) -> Sequence[Fault]:
        """What is wrong between keys that are right one by one."""
        return [
            *self._table_faults(),
            *self._layer_faults(),
            *self._making_faults(),
            *self._thread_faults(),
            *self._side_faults(),
            *self._drive_faults(),
        ]

    def _table_faults(self) -> Iterator[Fault]:
        """Of bodies, joints, gears, springs and outputs, before anything is made of them."""
        for k, row in enumerate(self.planets):
            yield from planets.faults(("planets", k), row, self.points, self.links)
        yield from drawing_faults(self._drawing)
        if not self.wanted:
            right = (
                "missing: [[output]] with a name and a point or link: its path or angle is judged"
            )
            yield Fault(("output",), "", right)
        yield from ratchets.faults(self._drawing, self.springs)
        links = self._drawing.links
        joints = self._drawing.names_of_joints()
        yield from coils.faults(self.springs, links, self._turning, [*links, *joints])
        on_shafts = self.freewheels, self.links, self.gears, self.drive, self.making
        yield from freewheels.faults(*on_shafts)

    @property
    def _turning(self) -> list[str]:
        """What may turn all round: drives, cams, gears and what else has teeth or slots."""
        return [
            *(each.link for each in self.drives),
            *(cam.cam for cam in self.cams),
            *(name for gear in self.gears for name in (gear.a, gear.b)),
            *(name for geneva in self.genevas for name in (geneva.a, geneva.b)),
            *(name for pair in self.noncirculars for name in (pair.a, pair.b)),
            *(name for pair in self.mutilated for name in (pair.a, pair.b)),
            *(name for each in self.ratchets for name in (each.a, each.b)),
            *(name for row in self.cycloids for name in (row.crank, row.output) if name),
        ]

    def _layer_faults(self) -> Iterator[Fault]:
        """Names in [layers] of nothing that lies on a level, and where a counterweight may lie."""
        links = self._drawing.links
        lying = [link for link in links if link != m.GROUND]
        lying += webs.further(links, self.drive.link, self._slotted, self.making)
        lying += [*self._drawing.levels_of_joints(), *coils.names(self.springs)]
        lying += [title for title, *_ in self._drawing.returns.values()]
        if self.counterweight is not None:
            yield from weight_faults(self.counterweight, self.drive, self.masses, lying)
            if self._under:
                yield from under_faults(self.counterweight, self.making)
            lying.append(NAME)
        for name, level in self.layers.items():
            if name not in lying:
                yield unknown(("layers", name), name, lying)
            if not level and name != NAME:
                right = "1 or more: 0, under the plate, is for a counterweight"
                yield Fault(("layers", name), "0", right)

    def _making_faults(self) -> Iterator[Fault]:
        """Of [parts] and [laser]: shapes, sheets, shafts, pins and eccentrics of this machine."""
        making = self.making
        yield from making.faults(self._drawing.links, self.print.nozzle, self.allowed.min_wall)
        grooves = sum(cam.closure == "groove" for cam in self.cams)
        yield from sheets.faults(making, self.laser, len(self.slides), grooves)
        drive = self.drive.link
        if making.shaft == "interrupted" and {drive, m.GROUND} <= self.links.keys():
            yield from webs.faults(self.links, self.points, drive, self._slotted)
        hung = {point for _, *both in self._drawing.returns.values() for point in both}
        for key, named, points in (
            ("pins", making.pins, {*self._drawing.points, *hung}),
            ("discs", making.discs or (), self.points),
        ):
            for name in named:
                if name not in points:
                    yield unknown(("parts", key, name), name, points)
        yield from self._eccentric_faults()

    def _thread_faults(self) -> Iterator[Fault]:
        """Of the posts that a thread runs round."""
        threaded = [point for each in self.wanted for point in each.thread or ()]
        posts = self.making.thread_post_sizes
        if threaded and self.making.thread_posts is None:
            yield from posts.faults(self.print.nozzle, self.making.head)
        for name in posts.diameters:
            if name not in threaded:
                path = ("parts", "thread_posts", "diameters", name)
                yield Fault(path, "", "a point of a thread")

    def _drive_faults(self) -> Iterator[Fault]:
        """Of motors, their programs and pens, of a walk, and of what is included."""
        if self.walk is not None:
            yield from self.walk.faults(self.wanted)
        yield from motors.faults(self._drawing, self.making, self._of_one_motor)
        if self.pen is None:
            yield from motors.program_faults(self._drawing.drives)
        else:
            yield from pens.faults(self.pen, self._drawing)
        if not self.includes:
            return
        if self.drive.segments:
            right = "nothing here beside [[include]]: what is included turns evenly with the shaft"
            found = counted(len(self.drive.segments), "segment")
            yield Fault(("drive", "segment"), found, right)
        yield from inc.faults(self.includes, self._host)

    @property
    def _of_one_motor(self) -> Mapping[str, bool]:
        """Which tables are there that several motors cannot have beside them."""
        return {
            "include": bool(self.includes),
            "freewheel": bool(self.freewheels),
            "planets": bool(self.planets),
            "cycloid": bool(self.cycloids),
            "counterweight": self.counterweight is not None,
            "motor": self.motor is not None and isinstance(self.drive, t.SlidingDrive),
        }

    def _eccentric_faults(self) -> Iterator[Fault]:
        """Eccentrics of cycloidal drives without a size, and second discs."""
        for k, row in enumerate(self.cycloids):
            own = ("cycloid", k), row, self.cycloids, self.points, self.links
            yield from cycloids.faults(*own)
            shaft = self._drawing.pivot(row.crank) if row.crank in self.links else None
            if row.at in (self.making.discs or ()) or not {shaft, row.at} <= self.points.keys():
                continue
            off = abs(self._drawing.at(row.at) - self._drawing.at(shaft or ""))
            bore = self.making.shaft_diameter + self.print.press_clearance
            least = math.ceil(2 * (off + self.allowed.min_wall) + bore)
            right = f"missing: the diameter of the eccentric round the shaft, {least} mm or more"
            yield Fault(("parts", "discs", row.at), "", right)

    def _side_faults(self) -> Iterator[Fault]:
        """Why there cannot be two sides, and soles without a foot."""
        feet = {each.point for each in self.wanted}
        for name, shape in self.making.shapes.items():
            if shape.sole_diameter is not None and feet.isdisjoint(self.links.get(name, ())):
                right = f"nothing here, or an [[output]] at a point of {name} that is its foot"
                yield Fault(("parts", name, "sole_diameter"), f"{shape.sole_diameter:g}", right)
        if self.making.sides == 1:
            if self.making.battery is not None:
                right = "nothing here, or parts.sides = 2: it lies under the far side's plate"
                yield Fault(("parts", "battery"), "", right)
            if self.making.side_gap:
                right = "nothing here, or parts.sides = 2: it is between both sides"
                yield Fault(("parts", "side_gap"), f"{self.making.side_gap:g}", right)
            return
        if 0 < self.making.side_gap < _LEAST_GAP:
            right = f"0, or at least {_LEAST_GAP:g} mm: a spacer"
            yield Fault(("parts", "side_gap"), f"{self.making.side_gap:g}", right)
        key = ("parts", "sides")
        if self.making.plates == 1:
            yield Fault(
                key, "2", "1, or parts.plates = 2 beside it: both second plates lie back to back"
            )
        for name, beside in (
            ("[[include]]", self.includes),
            ("[[spring]]", self.springs),
            ("[counterweight]", self.counterweight),
        ):
            if beside:
                yield Fault(key, "2", f"1 beside {name}, which only a machine of one side has")
        outputs = {each.name for each in self.wanted}
        for table, names in (("links", {*self.links}), ("output", outputs)):
            for name in sorted(name for name in names if f"{FAR}_{name}" in names):
                right = f"another name: the far side's {name} has it"
                yield Fault((table, f"{FAR}_{name}"), "", right)

    def faults_beside(self, before: Checked, changed: Collection[str]) -> Sequence[Fault]:
        """Of other lengths alone: whether links can have them."""
        assert isinstance(before, Linkage)
        same_keys = self.lengths.keys() == before.lengths.keys()
        if changed != {"lengths"} or not same_keys or self.includes:
            return self.faults()
        others = (key for key, length in self.lengths.items() if length != before.lengths[key])
        ends = [{*(t.pair(key) or ())} for key in others]
        links = {
            name: points
            for name, points in self.links.items()
            if any(both.issubset(points) for both in ends)
        }
        return list(shape_faults(self._drawing, links))

    @property
    def _under(self) -> bool:
        """Whether its counterweight lies under the plate."""
        return self.layers.get(NAME) == 0

    @property
    def _slotted(self) -> list[str]:
        return [slot.pin for slot in self.slots]

    def _whole_spec(self) -> dict[str, Any]:
        return self.model_dump(by_alias=True, exclude_none=True)

    @cached_property
    def _host(self) -> inc.Host:
        return inc.Host(self._whole_spec(), self.drive.speed_rpm)

    # ---- motion -----------------------------------------------------------------------------------------------------

    @cached_property
    def _drawing(self) -> Drawing:
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

    @property
    def _rooms(self) -> Mapping[str, float]:
        """Radius of the circle that a cam must hold, by its closure, mm: its shaft, a groove's pins, with walls."""
        sizes = self.making
        wall = self.allowed.min_wall
        shaft = (sizes.shaft_diameter + self.print.press_clearance) / 2 + 2 * wall
        plain = dict.fromkeys(("force", "conjugate"), shaft)
        return {**plain, "groove": shaft + wall + 1.5 * sizes.pin_diameter}

    def _unloaded(self) -> m.Machine:
        """The model with its parts' masses and the play of their fits, its far side, and what is included; DesignError where no
        such parts can be made."""
        own = joined(self._fitted, {far: self._far_fitted for far in self._far_module})
        return joined(own, {each.module: each.mechanism.model for each in self.modules})

    @cached_property
    def modules(self) -> Sequence[inc.IncludedMachine]:
        """The machines of other specs, each above those before it."""
        if not self.includes:
            return ()
        bare = self._bare
        top = max(high for _, high in inc.heights(bare.parts, bare.mounts))
        play = self.print.slide_clearance
        end = upper_end(bare.layout)
        modules = inc.stack(self.includes, self._host, self.chain, top, play, end)
        inc.distinct(
            modules,
            bare.parts,
            lambda: joined(self.chain, {each.module: each.mechanism.model for each in modules}),
        )
        return modules

    @cached_property
    def _fitted(self) -> m.Machine:
        return self._weighed(self.bodies)

    def _weighed(self, bodies: Bodies) -> m.Machine:
        """The machine of some bodies with their masses and springs."""
        return self._weighed_with(bodies, self.sprung)

    def _weighed_with(self, bodies: Bodies, springs: Sequence[coils.MountedSpring]) -> m.Machine:
        machine = bodies.with_masses(self._process.density, self.masses)
        if self._beneath is not None:
            machine = self._beneath.joined(machine, self._process.density)
        pulls = (each.pull for each in springs)
        return replace(machine, loads=(*machine.loads, *self.additions.loads, *pulls))

    @property
    def closing(self) -> float:
        """What return springs press followers on their cams with at least, N or N m; inf without any."""
        pulls = {each.name: each.spring for each in self.sprung}
        found = (each.spring.closing(pulls[each.name]) for each in self._returning)
        return min(found, default=math.inf)

    @cached_property
    def sprung(self) -> Sequence[coils.MountedSpring]:
        """Springs between links, and those that return followers; DesignError where one of them cannot be made."""
        return [
            *self._hung,
            *(
                each.sprung(self.chain, 0.0 if each.spring.given else self._least_pull(each))
                for each in self._returning
            ),
        ]

    @cached_property
    def _period(self) -> Run:
        """The chain over a period, of planets until their carrier is back: what levels are found by."""
        return self.run(self.cycle.theta(_SAMPLES * self.rounds), 0)

    @cached_property
    def _hung(self) -> Sequence[coils.MountedSpring]:
        """Those of [[spring]]."""
        if not self.springs:
            return ()
        return coils.sprung(self.springs, self._period, self.making)

    @cached_property
    def _returning(self) -> Sequence[coils.Returning]:
        """Where the springs hang that return followers."""
        if not self._drawing.returns:
            return ()
        play = self.print.slide_clearance
        return coils.returning(self._drawing.machine(), self._drawing, self.making, play)

    def _least_pull(self, spring: coils.Returning) -> float:
        """What a return spring must pull with, N, by what all but such springs do."""
        contact = self._unreturned.contacts[spring.cam.name]
        return spring.spring.least_pull(spring.cam.leaves * contact)

    @cached_property
    def _unreturned(self) -> Forces:
        """Of the machine without its return springs, over the turns of its drive."""
        bodies = Bodies(with_levels(self._layout_with(self._hung), self._period))
        machine = self._weighed_with(bodies, self._hung)
        own = () if self.load is None else efforts(self.load.on, machine)
        machine = replace(machine, loads=(*machine.loads, *gravity(self.load), *own))
        return solve(machine, SAMPLES).forces()

    @cached_property
    def chain(self) -> m.Machine:
        """The model, closed as drawn; DesignError where it does not close, is loose or locked, or cannot move as asked.

        Each pin has the play of one that is pressed into one of its links.
        """
        chain = self._drawing.machine()
        for spring in self._returning:
            chain = spring.on(chain)
        if len(self.drives) > 1:
            return (
                motors.driven(chain, self.drives) if self.pen is None else pens.led(chain, self.pen)
            )
        law: m.Law | None
        program = self.drive.program()
        if program is None:
            law = None
            reach = None if self.drive.range_deg is None else self.cycle.range
        else:
            law = DriveLaw(program, chain.start[self.drive.link].angle)
            reach = law.reach
        clear = stays_clear(chain, *(reach or (0.0, math.tau)))
        if reach is not None:
            refuse_range(chain, self.drive, *reach)
        elif not clear:
            refuse_partial(chain, self.allowed.transmission_angle_deg)
        if not clear:
            refuse_folds(chain, *(reach or (0.0, math.tau)))
        law = self.additions.drive or law
        if law is not None:
            drive, *held = chain.drives
            chain = replace(chain, drives=(replace(drive, law=law), *held))
        return self._drawing.released(chain)

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
    def _whole(self) -> m.Machine:
        own = joined(self.chain, dict.fromkeys(self._far_module, self.chain))
        return joined(own, {each.module: each.mechanism.model for each in self.modules})

    def run(self, theta: ArrayLike, order: int = 2) -> Run:
        """The chain of this spec alone at theta, (n,) rad."""
        return solve(self.chain, theta, order)

    @cached_property
    def _moving(self) -> figures.LinkageMotion:
        """It without what is included, as figures see it."""
        even = not self._programmed
        springs = bool(self.springs or self._returning)
        return figures.LinkageMotion(
            self.chain, self.cycle, [each.link for each in self.drives], self.wanted, even, springs
        )

    def motion(self, theta: Floats, order: int = 0) -> Floats:
        """The first signal over a period, rad or mm; its derivatives are to theta."""
        found: Floats = self._moving.signals[0].rows(
            self.run(self.cycle.theta(np.asarray(theta, float)), order)
        )[order]
        return found

    # ---- bodies -----------------------------------------------------------------------------------------------------

    @cached_property
    def bodies(self) -> Bodies:
        """What is made of it, and what holds machines that stand on it."""
        stands = tuple(each.stand for each in self.modules if each.stand is not None)
        return (
            Bodies(replace(self._bare.layout, stands=stands), self._bare.weight, self._bare.under)
            if stands
            else self._bare
        )

    @cached_property
    def assembly(self) -> Assembly:
        """Ground plate, links, pins, spacers, shaft and collar, and what is included; DesignError where there are joints of
        which no bodies are made."""
        own = self._made_of(self.bodies, self.model)
        if self._far_bodies is not None:
            far = self._made_of(self._far_bodies, self._far_fitted)
            own = replace(both_sides(own, far, self._mirror, self.model), feet=self._feet)
        whole = assemblies.joined(own, [each.assembly for each in self.modules], self.model)
        name = self._angle_name(any(isinstance(each, CamOutline) for each in whole.features))
        swept = self.rounds if self.rounds <= _SWEPT_TURNS else 1
        cycle = replace(self.cycle, name=name, turns=self.turns, swept=swept)
        whole = replace(whole, cycle=cycle)
        if self.making.stand == "none":
            return whole
        sizes = self.bodies.sizes
        kind = self.making.stand
        return on_stand(
            TableStand(whole, kind, sizes, self.print, self.allowed.min_wall, -self._down)
        )

    def _angle_name(self, cams: bool) -> str:
        """What theta is called; cams: whether any are made."""
        if isinstance(self.drive, t.SlidingDrive):
            return "travel of the drive"
        if self.drive.range_deg is not None or self._programmed:
            return "drive angle"
        return "cam angle" if cams else "crank angle"

    @property
    def _feet(self) -> Feet:
        """What a machine of two sides walks on."""
        soled = (name for name, shape in self.making.shapes.items() if shape.sole_diameter)
        near = [part_name(link) for link in soled if link in self.links]
        far = [module.part(part) for module in self._far_module for part in near]
        return Feet((self._down.real, self._down.imag, 0.0), frozenset([*near, *far]))

    @property
    def _down(self) -> complex:
        """Where gravity points, a unit complex."""
        deg = None if self.load is None else self.load.gravity_deg
        return -1j if deg is None else cmath.exp(1j * math.radians(deg))

    @cached_property
    def rounds(self) -> int:
        """Turns of the drive that bring round carriers and rings of planets, and cycloidal discs; 1 where none are known."""
        moving = [link for row in self.planets for link in (row.carrier, row.ring) if link]
        moving += [row.disc for row in self.cycloids]
        rates = [rate for link in moving if (rate := self._drawing.turns_of(link)) is not None]
        return math.lcm(
            *(Fraction(rate).limit_denominator(_MOST_ROUNDS).denominator for rate in rates)
        )

    @property
    def turns(self) -> int:
        """Of the drive, that bring round what turns on by freewheels, or with planets; 1 where eight do not."""
        if 1 < self.rounds <= _SHOWN_TURNS:
            return self.rounds
        laws = [each.law for each in self.chain.joints if isinstance(each, m.Clutch)]
        steps = [law.advance / math.tau for law in laws if isinstance(law, Ratchet)]
        whole = (
            n
            for n in range(1, _SHOWN_TURNS + 1)
            if all(abs(n * s - round(n * s)) < 1e-9 for s in steps)
        )
        return next(whole, 1)

    # ---- the far side -----------------------------------------------------------------------------------------------

    @cached_property
    def _far_bodies(self) -> Bodies | None:
        """The far side before it is reflected: the same on the same levels, without what drives; None where there is none."""
        if self.making.sides == 1:
            return None
        near = self.bodies.layout
        return Bodies(with_battery(replace(near, sizes=near.sizes.driven_by_shaft)))

    @cached_property
    def _far_fitted(self) -> m.Machine:
        """The far side's model with its masses, in step with the near one's."""
        assert self._far_bodies is not None, "asked for with two sides alone"
        return self._weighed(self._far_bodies)

    @property
    def _far_module(self) -> Sequence[Module]:
        """How the far side stands in the whole, if there is one."""
        phase = math.radians(self.making.side_phase_deg)
        return () if self.making.sides == 1 else (Module(FAR, phase=phase),)

    @property
    def _mirror(self) -> Mirror:
        """Half-way between both second plates; DesignError where no shaft gets there."""
        end = upper_end(self.bodies.layout)
        assert end is not None, "a fault of the spec"
        if end.axis is None:
            raise DesignError(
                "shafts in the second plate",
                0,
                1,
                "",
                f"link {self.drive.link}",
                'set parts.shaft = "interrupted": its upper end goes on into the far side',
            )
        phase = math.radians(self.making.side_phase_deg)
        gap = self.making.side_gap
        return Mirror(end.top + gap / 2, end.shaft, phase, gap)

    def _made_of(self, bodies: Bodies, machine: m.Machine) -> Assembly:
        """What is made without what is included; machine: its model."""
        plastic = self.material.name
        sizes = bodies.sizes
        features = bodies.features()
        frame = sizes.motor if sizes.can is None else ""
        motor = (
            MotorSeat(crank=sizes.hand_crank)
            if sizes.face is None
            else MotorSeat(frame, bodies.shaft_reach, bodies.collar)
        )
        feet = len(bodies.layout.feet)
        ends = bodies.parts[0].centres[-sizes.mount_screws - feet :]
        screws = () if bodies.layout.hangs else ends[: sizes.mount_screws]
        fixings = tuple((z, sizes.mount_diameter) for z in screws)
        sprung = [each.bought(sizes.pin_diameter) for each in self.sprung]
        ways = {each.name: each.way(sizes.pin_diameter) for each in self.sprung}
        made = Assembly(
            machine,
            self._engraved(bodies.parts, features),
            self._process,
            self.cycle,
            bodies.mounts,
            features,
            demands=figures.demands(self._moving, self.allowed),
            stand_ins=bodies.stand_ins(),
            strands=bodies.strands(),
            balances=()
            if self.counterweight is None
            else (self._balance(self.counterweight, bodies),),
            coils=coils_of(bodies.layout, bodies.parts, bodies.mounts, ways=ways),
            bought=[*bodies.bought(self._driving_text), *sprung, *lifts.bought(self._moving)],
            springs=coils.mounted(self.sprung, by_force(self.chain), sizes.pin_diameter),
            journals=journals(machine, features, bodies.parts, bodies.mounts, plastic),
            posts=tuple(
                posts(bodies, {each.name: each.forces()[1] for each in self.sprung}, plastic)
            ),
            frame=Frame(bodies.parts[0].name, fixings),
            motor=motor,
            shaft=bodies.shaft,
            board=bodies.stands,
            material_limits=self._material_limits,
            unjudged=Later(lambda: [*self._unswept, *self._pressed.not_judged]),
            texts={"chain.svg": bridges.svg(self.chain), "chain.pmks": bridges.pmks(self.chain)},
            follower=FollowerFacts(self._arm_stiffness),
        )
        return made if self._beneath is None else self._beneath.added(made)

    @property
    def _driving_text(self) -> str:
        """What its drive is to do, in words."""
        drive = self.drive
        if isinstance(drive, t.Drive):
            turning = turning_text(drive.speed_rpm)
            model = self.motor.model if self.motor else None
            if model is None or model.lower() == self.making.motor or self.making.hand_crank:
                return turning
            return ", ".join((f"{model} ({HOLES_UNKNOWN})" if model in GEARED else model, turning))
        low, high = drive.range
        return f"linear, {high - low:g} mm at {drive.speed:g} mm/s, on link {drive.link}"

    @property
    def _unswept(self) -> Iterator[NotJudged]:
        """What the sweep leaves out of carriers that come round after many turns alone."""
        if self.rounds > _SWEPT_TURNS:
            why = f"bodies are moved over one turn of {self.rounds}, after which all are back"
            yield NotJudged("INTERFERENCE", why, f"a ratio of at most {_SWEPT_TURNS} whole turns")

    def _engraved(self, parts: Sequence[Part], features: Sequence[Feature]) -> Sequence[Part]:
        """Parts with what is engraved in them: a text in a link, letters of holes in what has named points, and what says the
        upper side of a cam or wheel that fits turned over as well; of sheet only where engraving is cut too.
        """
        texts = {
            part_name(link): (shape.engrave, f"parts.{link}.engrave")
            for link in self._drawing.links
            if (shape := self.making.shape(link)).engrave
        }
        letters = bool(self.files.hole_letters)
        reversible = set(fit_turned_over(parts, features))
        if not (texts or letters or reversible):
            return parts
        from camgen.parts.engraving import engraved, with_upper_side

        engraves = self.files.engrave or not self.making.of_sheet
        mark = self.files.up_marks and engraves and self.making.sides == 1
        lettered = (engraved(part, letters, *texts.get(part.name, ())) for part in parts)
        return [
            with_upper_side(part, mark) if part.name in reversible else part for part in lettered
        ]

    @property
    def _arm_stiffness(self) -> float | None:
        """Of the follower that swings on the one cam of the machine, N m/rad; None of another, or where there are several."""
        swinging = [cam for cam in self.cams if self._drawing.slide_of(cam.follower) is None]
        if len(self.cams) != 1 or not swinging:
            return None
        (cam,) = swinging
        points = self.bodies.layout.points_of(cam.follower)
        pivot = self._drawing.pivot(cam.follower) or ""
        if not {pivot, cam.at} <= points.keys():
            return None
        name = part_name(cam.follower)
        arm = next(part for part in self.bodies.parts if part.name == name)
        held = points[pivot]
        pushed = points[cam.at]
        modulus = materials.of(self.material.name).elastic.modulus
        return bending_stiffness(arm, held, pushed, modulus) * abs(pushed - held) ** 2 * 1e-3

    def _balance(self, weight: Counterweight, made: Bodies) -> Balance:
        """What the solids of the driven link with its counterweight are held to."""
        link = self.drive.link
        whole = self._balanced[1]
        origin = made.layout.at(link, made.layout.shaft_of(link))
        pivot = pivot_of(made.layout, link)
        solids = made.solids(self._process.density)
        return balance_of(link, pivot, origin, whole - weight.other, solids)

    @cached_property
    def _bare(self) -> Bodies:
        """What is made of it alone; levels that [layers] leaves open are found."""
        unmade = lacking(self._layout)
        if unmade is not None:
            raise unmade
        bodies = self._balanced[0]
        refuse_alike(bodies.parts, self._drawing.links, self.making.discs or ())
        return bodies

    @cached_property
    def _balanced(self) -> tuple[Bodies, complex]:
        """The bodies, and the moment that all that turns with a balanced crank is to have, complex g mm; DesignError with what
        mends it, where a change is found that does."""
        try:
            assert self._laid[0].parts
        except DesignError as refused:
            raise with_cures(refused, self._layout, self._period, self._parts_with) from None
        return self._laid

    def _parts_with(self, change: Change) -> Sequence[Part]:
        """Those of the spec so changed, see `_with`."""
        return self._with(change).assembly.parts

    def _with(self, change: Change) -> Self:
        """The spec so changed, on the same chain, its parts made by no further cures; DesignError or SpecError where it has none."""
        other = validate(type(self), change.tables(self._whole_spec()))
        vars(other).update(chain=self.chain, additions=self.additions)
        vars(other)["_balanced"] = other._laid
        assert other.assembly.parts
        return other

    def on_a_frame(self) -> tuple[Self, Change]:
        """The spec as it is, or with the first other plates and shaft that it leaves open by which it has parts, and that change.

        DesignError where there is none: that of the spec as it is, with what was tried.
        """
        layout = self._layout
        as_it_is = Change("")
        others = frames(self.making, layout.driven not in layout.slides)
        refused: CamgenError | None = None
        for change in (as_it_is, *others):
            try:
                return self._with(change), change
            except (DesignError, SpecError) as error:
                refused = refused or error
        assert refused is not None
        raise tried(refused, layout, others)

    @cached_property
    def _laid(self) -> tuple[Bodies, complex]:
        run = self._period
        if self.counterweight is None:
            return Bodies(with_levels(self._layout, run)), 0j
        return counterbalanced(
            self.counterweight, self._layout, run, self._process.density, self._weighed
        )

    @property
    def _layout(self) -> Layout:
        return self._layout_with(self.sprung)

    def _layout_with(self, springs: Sequence[coils.MountedSpring]) -> Layout:
        """What is over the plate, with these springs."""
        whole = self._whole_layout(springs)
        if self._beneath is None:
            return whole
        return replace(self._beneath.above, springs=whole.springs)

    @cached_property
    def _beneath(self) -> Beneath | None:
        """What hangs under the plate."""
        arm = self.additions.beneath
        if arm is None:
            return None
        run = self._period
        return Beneath(self._whole_layout(()), arm, run)

    def _whole_layout(self, springs: Sequence[coils.MountedSpring]) -> Layout:
        cams = self._drawing.ridden
        gears = {gear.joint: gear.wish for gear in self.gears}
        sets = tuple(planets.wish(row) for row in self.planets)
        return Layout(
            self.chain,
            self.drive.link,
            self.making,
            self.print,
            self.allowed.min_wall,
            self.layers,
            {},
            cams,
            gears,
            genevas=self._drawing.named_genevas,
            noncirculars=self._drawing.noncircular_pairs,
            mutilated=self._drawing.mutilated_laws,
            ratchets=self._drawing.ratchet_wishes,
            planets=sets,
            cycloids=self._drawing.cycloid_wishes,
            springs={each.name: each.stretched for each in springs},
            freewheels={each.wheel: (each.link, self._clutch) for each in self.freewheels},
            marks={
                each.link: complex(_MARK * hub / 2)
                for each in self.freewheels
                if (hub := self.making.shape(each.link).hub_diameter)
            },
            further=tuple(each.link for each in self.drives[1:]),
            keep_outs=inc.clearings(self.includes, lambda: self._host),
            fitting=self.additions.fitting,
            drawn_poses=self._drawing.drawn_poses,
        )

    @property
    def _clutch(self) -> Bearing:
        """In wheel and plate, of each freewheel."""
        return CLUTCHES[self.making.shaft_diameter][0]

    @cached_property
    def additions(self) -> Additions:
        """What a template says beside its linkage's tables."""
        return Additions()

    @cached_property
    def sketched(self) -> Layout:
        """Before levels: with the strokes of its slots and slides, and the first choice of their stems."""
        return first_choice(self._layout, self._period)

    def _found(self) -> Mapping[str, object]:
        """Levels, bows, the included specs and where they stand, and what every mechanism fills in."""
        levels: dict[str, object] = {
            f"layers.{link}": level for link, level in self.bodies.layout.given.items()
        }
        weight = {} if self.counterweight is None else found_moment(self._balanced[1])
        tables = [inc.resolved_table(each) for each in self.modules]
        sizes = self.bodies.layout.sizes
        bases = self._drawing.bases
        levels |= {
            f"cam.{k}.base_radius": bases[name]
            for k, name in enumerate(self._drawing.named_cams)
            if name in bases
        }
        if sizes != self.making:  # a link is bent
            levels["parts"] = sizes.model_dump(by_alias=True, exclude_none=True)
        return {**super()._found(), **levels, **weight, **({"include": tables} if tables else {})}

    def resolved(self) -> Self:
        """The same with its levels, on the same chain."""
        found = super().resolved()
        # cached: nothing that they depend on was filled in
        same = vars(self).keys() & {
            "chain",
            "additions",
            "bodies",
            "_bare",
            "_balanced",
            "_laid",
            "modules",
            "sprung",
        }
        found.__dict__.update({name: vars(self)[name] for name in same})
        return found

    def limits(self) -> Sequence[Finding]:
        """Targets by the model as designed, and how near each loop comes to a fold."""
        least = self.allowed.transmission_angle_deg
        found = [
            *figures.targets(self._moving),
            *figures.transmission_angles(self._moving, least),
            *(() if self.pen is None else pens.stretches(self.chain, self.pen, least)),
            *wheels.limits(self._layout.tips),
            *wheels.plate_limits(self._layout.plates),
        ]
        return [*found, *self._pressed.findings, *self._included_limits]

    def limits_of(self, code: str) -> Sequence[Finding]:
        """Those of one code; of LIFT_OFF without the profiles of cams, which take longer."""
        if code != "LIFT_OFF":
            return super().limits_of(code)
        found = (*self._pressed.findings, *self._included_limits)
        return [finding for finding in found if finding.code == code]

    @property
    def _included_limits(self) -> Sequence[Finding]:
        return [finding for each in self.modules for finding in inc.limits(each, self.chain)]

    @cached_property
    def _pressed(self) -> LoadCheck:
        """What holds its own cams' followers; those of what is included are judged there."""
        cams = by_force(self.chain)
        if not cams or lacking(self._layout) is not None:
            return LoadCheck()
        theta = np.linspace(*self.cycle.range, len(_SAMPLES) + 1)
        kicks = self._drawing.kicks()
        bounces = restitution_of(self.load)
        found = lift_off(self._pulled, cams, kicks, theta, self._angle_name(True), bounces)
        unit = self.cycle.unit
        told = [replace(each, where=replace(each.where, unit=unit)) for each in found.findings]
        return replace(found, findings=told)

    def remarks(self) -> Remarks:
        """Followers that stand elsewhere than drawn, and how many links are closed together on what each kind of file shows."""
        return Remarks(links=len(self._drawing.links), warnings=self._drawing.shifted())

    def study(self) -> Study:
        """Outputs, curves and paths, the class of a four-bar; those of what is included; all outputs over one turn."""
        own = figures.study(self._moving, self._made, lambda: self.assembly.cycle.label)
        if self._pressed.figures:
            own = together([own, Study(Figures(self._pressed.figures))])
        if self.walk is not None:
            own = together([own, self._walk(self.walk)])
        if (pen := self.pen) is not None:
            own = together([own, Study(plots=Later(lambda: [pens.reach_of(self.chain, pen)]))])
        if not self.includes:
            return own
        whole = self.solve(np.linspace(*self.cycle.range, ROWS), 0)
        timing = figures.timing(whole, self.drive.link)
        return together([own, *map(inc.study, self.modules), timing])

    def _walk(self, walk: t.Walk) -> Study:
        """How it walks if it goes slowly, on the feet of both sides."""
        solids = self.assembly.solids
        machine = with_masses(self.assembly.exact, solids, self.load).machine
        far = {f"{FAR}_{foot}" for foot in walk.feet}
        feet = [*walk.feet, *(each.name for each in machine.outputs if each.name in far)]
        return walking.study(machine, solids, walk, feet, self._down)

    @property
    def _made(self) -> figures.Build | None:
        """What is made; None where there are joints of which no bodies are made."""
        if lacking(self._layout) is not None:
            return None
        machine = replace(self.model, loads=(*self.model.loads, *gravity(self.load)))
        return figures.Build(self.bodies.layout, machine, self.sprung, self.slots)
