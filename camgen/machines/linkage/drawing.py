"""From the tables of a spec to the model: links with exact lengths, joints where they share points, closed as drawn.

drawn position   theta = 0; the driven link's angle, a cam follower's place and a cam's angle there are as drawn
pin              a point that two links share; of more links each is pinned to the first, the ground before all
cam              its program begins at theta = 0, where the follower stands on the base circle, and runs in the sense of turning
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from typing import Any, Literal

import numpy as np

from camgen.errors import DesignError, Key
from camgen.machine import freedom
from camgen.machine import model as m
from camgen.machine.cams.followers import Follower
from camgen.machine.cams.limits import Advice
from camgen.machine.cams.linear import WAY
from camgen.machine.cams.profile import DiscCam
from camgen.machine.cams.sizing import least_base_radius
from camgen.machine.freewheels import Ratchet
from camgen.machine.jets import thread_length
from camgen.machine.programs import CamLaw, CarriedLaw
from camgen.machine.run import solve
from camgen.machine.stepwise import closed_by_dyads
from camgen.machines.linkage import planets
from camgen.machines.linkage import tables as t
from camgen.machines.linkage.links import shape
from camgen.motion.polydyne import Lag, polydyne
from camgen.motion.program import Program
from camgen.motion.segments import program
from camgen.motion.stroke import StrokeSegment, stroke
from camgen.parts.generator.cycloids import CycloidWish
from camgen.parts.generator.ratchets import RatchetWish
from camgen.parts.generator.wheels import SECOND, Ridden, follower_of, level_of, naming, pivot
from camgen.parts.wheels.cycloid import CycloidDisc, OutputWish
from camgen.parts.wheels.geneva import Geneva, GenevaLaw, InnerGeneva
from camgen.parts.wheels.mutilated import MutilatedLaw, MutilatedPair
from camgen.parts.wheels.noncircular import Centrodes, NoncircularPair
from camgen.parts.wheels.ratchet import PawlLaw, RatchetWheel, pawl_of

GROUND = m.GROUND
RETURN = "return_spring"
_LEAST_SHIFT = 1.0  # mm or deg, of a follower from where it is drawn, that is told


@dataclass(frozen=True)
class Drawing:
    """The tables that say a machine; `machine()` is the model, once `drawing_faults` finds nothing wrong between them."""

    points: Mapping[str, tuple[float, float]]
    links: Mapping[str, Sequence[str]]
    lengths: Mapping[str, float]
    drives: Sequence[t.OneDrive]
    slides: Sequence[t.Slide] = ()
    slots: Sequence[t.Slot] = ()
    gears: Sequence[t.Gear] = ()
    cams: Sequence[t.Cam] = ()
    outputs: Sequence[t.Wanted] = ()
    masses: Mapping[str, t.Masses] = ()  # type: ignore[assignment]
    limits: t.LinkageLimits = t.LinkageLimits()
    rooms: Mapping[str, float] = field(default_factory=dict)  # by closure: circle in a cam, mm
    stiffness: float | None = None  # of a follower, N/mm or N m/rad
    freewheels: Sequence[t.Freewheel] = ()
    programs: Mapping[str, Program] = field(default_factory=dict)  # of cams, by their joints
    advice: Advice | None = None  # on cams, in the words of a template
    play: float = 0.0  # of each pin, slide and slot, diametral, mm
    genevas: Sequence[t.Geneva] = ()
    geneva_sizes: tuple[float, float] = (0.1, 2.0)  # air unless given, and wall of a wheel, mm
    planets: Sequence[t.Planets] = ()  # whose points and links are among the others
    noncirculars: Sequence[t.Noncircular] = ()
    cycloids: Sequence[t.Cycloid] = ()
    ratchets: Sequence[t.Ratchet] = ()
    mutilated: Sequence[t.Mutilated] = ()

    # ---- names ----------------------------------------------------------------------------------------------------

    @property
    def drive(self) -> t.OneDrive:
        """The first, by whose speed theta grows."""
        return self.drives[0]

    def names_of_drives(self) -> list[str]:
        """Of the model's drives: drive, of several with their links."""
        several = len(self.drives) > 1
        return [f"drive of {each.link}" if several else "drive" for each in self.drives]

    def joints(self) -> Iterable[tuple[tuple[str, int], str]]:
        """Path and name of each joint that has a table."""
        tables: Iterable[tuple[str, Sequence[t.Jointed]]] = (
            ("slide", self.slides),
            ("slot", self.slots),
            ("gear", self.gears),
            ("cam", self.cams),
            ("geneva", self.genevas),
            ("noncircular", self.noncirculars),
            ("mutilated", self.mutilated),
            ("ratchet", self.ratchets),
            ("freewheel", self.freewheels),
            ("planets", self.planets),
            ("cycloid", self.cycloids),
            ("cycloid", [row.twin for row in self.cycloids if row.twin]),
        )
        for kind, rows in tables:
            yield from (((kind, k), row.joint) for k, row in enumerate(rows))

    def names_of_joints(self) -> list[str]:
        """Of pins, of all joints that have a table, and of their levels."""
        return [
            *self.points,
            *(name for _, name in self.joints()),
            *self.levels_of_joints(),
            *self.names_of_drives(),
        ]

    def levels_of_joints(self) -> list[str]:
        """Names in [layers] of what has a level of its own beside the links: cams, the second one of a pair, gears, Geneva drives, wheels
        that are not round, mutilated gears, ratchets."""
        wheels: list[t.Jointed] = [*self.gears, *self.planets, *self.genevas]
        wheels += [*self.noncirculars, *self.mutilated, *self.ratchets]
        levels = [level_of(row.joint) for row in wheels]
        for cam in self.cams:
            if cam.shape != "roller" or self.carries_plate(cam):
                continue
            key = level_of(cam.joint)
            levels += [key, key + SECOND] if cam.closure == "conjugate" else [key]
        return levels

    @property
    def pairs(self) -> Sequence[t.Gear | t.Geneva | t.Noncircular | t.Mutilated]:
        """Links a and b that turn each other."""
        return [*self.gears, *self.genevas, *self.noncirculars, *self.mutilated]

    # ---- looking up -----------------------------------------------------------------------------------------------

    def at(self, point: str) -> complex:
        """A point's drawn place."""
        return complex(*self.points[point])

    def drawn(self, points: Sequence[str]) -> m.Points:
        """Drawn places of several, (n,)."""
        return np.array([self.at(point) for point in points])

    def lengths_of(self, points: Sequence[str]) -> dict[tuple[int, int], float]:
        """Lengths that are given between these points, by their places in the row, mm."""
        return _between(points, self._lengths)

    @cached_property
    def _lengths(self) -> list[tuple[tuple[str, str], float]]:
        """The lengths, by the points between which they are, and those of the cranks of Geneva drives."""
        made = [
            ((self.pivot(each.a) or "", each.pin), self.geneva_of(each).crank)
            for each in self.genevas
        ]
        return [*self._given_lengths, *made]

    @property
    def _given_lengths(self) -> list[tuple[tuple[str, str], float]]:
        pairs = ((t.pair(key), length) for key, length in self.lengths.items())
        return [(names, length) for names, length in pairs if names]

    def geneva_of(self, table: t.Geneva) -> Geneva | InnerGeneva:
        """Its wheel and disc; DesignError where there is none."""
        distance = self._shafts_apart(table.a, table.b)
        usual, wall = self.geneva_sizes
        air = usual if table.clearance is None else table.clearance
        with naming(f"geneva {table.joint}"):
            kind = InnerGeneva if table.inner else Geneva
            return kind(table.slots, distance, table.pin_radius, wall, air, air)

    def _shafts_apart(self, a: str, b: str) -> float:
        """Distance of the points at which two links are pinned to the ground, mm."""
        ground = self.links[GROUND]
        ends = [ground.index(self.pivot(link) or "") for link in (a, b)]
        exact = shape(self.drawn(ground), _between(ground, self._given_lengths))[0]
        return abs(complex(exact[ends[1]] - exact[ends[0]]))

    @cached_property
    def noncircular_pairs(self) -> dict[str, NoncircularPair]:
        """Wheels that are not round, by their joints; DesignError where there are none such."""
        made = {}
        for each in self.noncirculars:
            backlash = 2 * self.geneva_sizes[0] if each.backlash is None else each.backlash
            with naming(f"noncircular {each.joint}"):
                centrodes = Centrodes(each.law, self._shafts_apart(each.a, each.b))
                made[each.joint] = NoncircularPair(centrodes, each.teeth, backlash)
        return made

    @cached_property
    def mutilated_laws(self) -> dict[str, MutilatedLaw]:
        """Mutilated gears, by their joints; DesignError where there are none such."""
        made = {}
        for each in self.mutilated:
            backlash = 2 * self.geneva_sizes[0] if each.backlash is None else each.backlash
            apart = self._shafts_apart(each.a, each.b)
            with naming(f"mutilated {each.joint}"):
                pair = MutilatedPair(each.teeth, each.stations, apart, backlash)
            made[each.joint] = MutilatedLaw(pair, self._way(each.a))
        return made

    def _way(self, link: str) -> Literal[1, -1]:
        """The sense in which a link turns."""
        rate = self.turns_of(link) or 1.0
        return 1 if self.drive.speed_rpm * rate > 0 else -1

    def ratchet_of(self, table: t.Ratchet) -> RatchetWish:
        """What is asked of its wheel and pawl; DesignError where there are none such."""
        way = self._way(table.a)
        distance = self._shafts_apart(table.a, table.b)
        with naming(f"ratchet {table.joint}"):
            wheel = RatchetWheel(table.teeth, table.radius, table.radius - table.deep)
            pawl = pawl_of(wheel, distance, table.end_radius, math.radians(table.draw_deg))
        return RatchetWish(PawlLaw(pawl, way), table.friction)

    @cached_property
    def ratchet_wishes(self) -> dict[str, RatchetWish]:
        """What is asked of each ratchet, by its joint."""
        return {each.joint: self.ratchet_of(each) for each in self.ratchets}

    def cycloid_of(self, row: t.Cycloid) -> CycloidWish:
        """What is asked of its disc and pins; DesignError where there is none."""
        points = self.links[row.crank]
        exact = shape(self.drawn(points), _between(points, self._given_lengths))[0]
        shaft = points.index(self.pivot(row.crank) or "")
        eccentricity = abs(complex(exact[points.index(row.at)] - exact[shaft]))
        usual = self.geneva_sizes[0]
        air = usual if row.clearance is None else row.clearance
        with naming(f"cycloid {row.joint}"):
            sizes = row.pins, row.radius, row.pin_radius, eccentricity
            disc = CycloidDisc(*sizes, air, row.offset)
        asked = OutputWish(row.output_pins, row.output_radius, row.output_pin_radius)
        links = row.crank, row.at, row.disc
        return CycloidWish(row.joint, disc, *links, air, row.output, row.output_title, asked)

    @cached_property
    def cycloid_wishes(self) -> list[CycloidWish]:
        """What is asked of each cycloidal drive, that of a second disc after that of the first."""
        wishes = []
        for row in self.cycloids:
            first = self.cycloid_of(row)
            wishes.append(first)
            if row.twin is not None:
                wishes.append(replace(self.cycloid_of(row.twin), opposite=first))
        return wishes

    @cached_property
    def named_genevas(self) -> dict[str, tuple[Geneva | InnerGeneva, str]]:
        """Each Geneva drive with its pin, by the name of its joint."""
        return {each.joint: (self.geneva_of(each), each.pin) for each in self.genevas}

    def pivot(self, link: str) -> str | None:
        """The point at which a link is pinned to the ground."""
        return next(
            (point for point in self.links[link] if point in self.links.get(GROUND, ())), None
        )

    def slide_of(self, link: str) -> t.Slide | None:
        """The slide of a link that slides."""
        return next((slide for slide in self.slides if slide.link == link), None)

    def carrier(self, slot: t.Slot) -> str | None:
        """The link whose pin runs in the slot."""
        return next(
            (
                name
                for name, points in self.links.items()
                if name != slot.link and slot.pin in points
            ),
            None,
        )

    @property
    def named_cams(self) -> dict[str, t.Cam]:
        """All cams by the names of their joints."""
        return {cam.joint: cam for cam in self.cams}

    @property
    def returns(self) -> dict[str, tuple[str, str, str]]:
        """Of each return spring its name and those of its points, on the ground and on the follower, by the cam's joint."""
        held = [name for name, cam in self.named_cams.items() if cam.spring is not None]
        pairs = {}
        for name in held:
            level = level_of(name)
            cam = self.named_cams[name]
            names = f"{RETURN}_{level}", f"{level}_post", f"{level}_hook"
            title, post, hook = (RETURN, "post", "hook") if len(held) == 1 else names
            pairs[name] = title, post, cam.at if cam.shape == "roller" else hook
        return pairs

    def carries_plate(self, cam: t.Cam) -> bool:
        """Whether a cam is a plate: the driven link, which slides."""
        return isinstance(self.drive, t.SlidingDrive) and cam.cam == self.drive.link

    def rate_of(self, drive: t.OneDrive) -> float | None:
        """Turns of a driven link over theta, below 0 against the first one; None of one that a program moves."""
        if drive is self.drive:
            return 1.0
        return None if drive.segments else drive.speed_rpm / self.drive.speed_rpm

    def turns_of(self, link: str) -> float | None:
        """Turns of a link for one of the driven one, by gears, below 0 against it; None where no gears join them."""
        turns = {
            each.link: rate
            for each in self.drives
            if isinstance(each, t.Drive) and (rate := self.rate_of(each)) is not None
        }
        for _ in (*self.gears, *self.planets, *self.cycloids):
            for gear in self.gears:
                if gear.a in turns:
                    turns.setdefault(gear.b, turns[gear.a] * gear.ratio)
                if gear.b in turns and gear.ratio:
                    turns.setdefault(gear.a, turns[gear.b] / gear.ratio)
            for row in self.planets:
                planets.turn_on(row, turns)
            for each in self.cycloids:
                if each.crank in turns:
                    turns.setdefault(each.disc, -turns[each.crank] / (each.pins - 1))
                    if each.twin is not None:
                        turns.setdefault(each.twin.disc, turns[each.disc])
                if each.output and each.disc in turns:
                    turns.setdefault(each.output, turns[each.disc])
        return turns.get(link)

    def moves_alone(self, follower: str) -> bool:
        """Whether no joint but its own hold on the ground and its cam holds a follower."""
        others = {
            point
            for name, points in self.links.items()
            if name not in (follower, GROUND)
            for point in points
        }
        slots = {slot.pin for slot in self.slots} & {*self.links[follower]}
        joined = [slot.link for slot in self.slots] + [each.on for each in self.slides]
        joined += [name for row in self.pairs for name in (row.a, row.b)]
        joined += [cam.cam for cam in self.cams]
        joined += [each.a for each in self.ratchets]
        joined += [
            name for row in self.cycloids for name in (row.crank, row.disc, row.output or "")
        ]
        return not (slots or others & {*self.links[follower]} or follower in joined)

    def speed_of(self, cam: t.Cam) -> float:
        """Speed of a cam, rad/s, below 0 where it turns clockwise; that of the drive where no gears join them."""
        return self.drive.speed_rpm * math.tau / 60 * (self.turns_of(cam.cam) or 1.0)

    def inertia_of(self, cam: t.Cam) -> float:
        """Of a follower by [masses]: kg, or kg m^2 about its pivot."""
        mass = dict(self.masses).get(cam.follower)
        if mass is None:
            return 0.0
        if self.slide_of(cam.follower) is not None:
            return mass.mass_g / 1e3
        points = self.links[cam.follower]
        exact = shape(self.drawn(points), self.lengths_of(points))[0]
        first = (exact - exact[0]) * cmath.exp(-1j * cmath.phase(exact[1] - exact[0]))
        pivot = complex(first[points.index(self.pivot(cam.follower) or "")])
        centre = complex(*mass.centre) if mass.centre else complex(np.mean(first))
        return mass.inertia_kg_m2 + mass.mass_g / 1e3 * abs((centre - pivot) * m.MM) ** 2

    def program_of(self, cam: t.Cam, path: Key = ("cam",)) -> Program:
        """The cam's program in its sense of turning, s in mm or rad, 0 at its beginning; SpecError with every fault."""
        known = self.programs.get(cam.joint)
        if known is not None:
            return known
        made = self.written_program(cam, path)
        if cam.polydyne and self.stiffness is not None:
            stiff = self.stiffness
            speed = abs(self.speed_of(cam))
            mass = self.inertia_of(cam) * (1.0 if self.slide_of(cam.follower) is None else m.MM)
            rate = 0.0 if cam.spring is None else cam.spring.rate
            lag = Lag(mass * speed**2 / stiff, cam.damping * speed / stiff, rate / stiff)
            made = polydyne(made, lag)
        turns = self.drive.range_deg is None
        return made.backwards() if turns and self.speed_of(cam) < 0 else made

    def written_program(self, cam: t.Cam, path: Key) -> Program:
        """A cam's segments one after the other; of a plate over mm of its way."""
        swings = self.slide_of(cam.follower) is None
        if self.carries_plate(cam):
            lifts = [
                (row.lift_deg, row.to_deg) if swings else (row.lift, row.to) for row in cam.segment
            ]
            stretches = [
                StrokeSegment(kind=row.kind, span=row.span or 0.0, lift=lift, to=to, law=row.law)
                for row, (lift, to) in zip(cam.segment, lifts, strict=True)
            ]
            unit, suffix = (math.radians(1), "_deg") if swings else (1.0, "")
            return stroke(stretches, unit, 1.0, path, suffix)
        rows = tuple(
            row.going(*((row.lift_deg, row.to_deg) if swings else (row.lift, row.to)))
            for row in cam.segment
        )
        unit, suffix = (math.radians(1), "_deg") if swings else (1.0, "")
        return program(rows, unit, (*path, "segment"), suffix=suffix)

    @cached_property
    def ridden(self) -> dict[str, Ridden]:
        """What touches each cam, and what of that is accepted, by its joint."""
        return {
            cam.joint: Ridden(
                cam.shape,
                cam.radius,
                cam.closure,
                cam.at,
                cam.tip_clearance,
                cam.face_width,
                self.limits.of_follower(self.slide_of(cam.follower) is not None),
                cam.face_offset,
                self.advice,
            )
            for cam in self.cams
        }

    def kicks(self) -> list[str]:
        """Names of cams whose follower's speed jumps."""
        programs = {cam.joint: self.program_of(cam) for cam in self.cams}
        return [
            name
            for name, made in programs.items()
            if any(jump.order == 1 for jump in made.discontinuities(1))
        ]

    # ---- the model ------------------------------------------------------------------------------------------------

    def machine(self) -> m.Machine:
        """The model, closed at theta = 0; DesignError where it does not close, is loose or locked."""
        drawn = self.rough
        closed = closed_by_dyads(drawn)
        if closed is not None:
            return closed
        machine = freedom.close_drawing(drawn)
        freedom.refuse_unsound(machine)
        return machine

    @cached_property
    def _open(self) -> m.Machine:
        """The model as drawn, open where lengths are others than drawn."""
        bodies, start = self._bodies()
        joints = [*self._pins(bodies), *self._slides(bodies, start), *self._slots(bodies)]
        joints += [self._gear(gear, start) for gear in self.gears]
        joints += [self._gear(gear, start) for row in self.planets for gear in planets.gears(row)]
        joints += [self._cam(cam, start, joints) for cam in self.cams]
        joints += [self._geneva(geneva, bodies, start) for geneva in self.genevas]
        joints += [self._noncircular(each, start) for each in self.noncirculars]
        joints += [self._mutilated(each, start) for each in self.mutilated]
        joints += [self._ratchet(each, start) for each in self.ratchets]
        joints += [joint for wish in self.cycloid_wishes for joint in _cycloid(wish, start)]
        drives = [
            self._drive(name, each, start, joints)
            for name, each in zip(self.names_of_drives(), self.drives, strict=True)
        ]
        outputs = tuple(self._output(each, bodies) for each in self.outputs)
        speed = self.drive.speed_rpm * math.tau / 60
        made = {joint.name: joint for joint in joints}
        loads = [self._load(cam, made[cam.joint]) for cam in self.cams]  # type: ignore[arg-type]
        held = [
            m.Drive(f.joint, f.link, m.Turning(0.0, start[f.link].angle)) for f in self.freewheels
        ]
        return m.Machine(
            tuple(bodies.values()),
            tuple(joints),
            (*drives, *held),
            start,
            tuple(load for load in loads if load is not None),
            outputs,
            speed,
        )

    def _drive(
        self,
        name: str,
        drive: t.OneDrive,
        start: Mapping[str, m.Pose],
        joints: Sequence[m.Joint],
    ) -> m.Drive:
        if isinstance(drive, t.SlidingDrive):
            slide, place = self._sliding(drive.link, joints)
            return m.Drive(name, drive.link, m.Turning(WAY, place), slide.name)
        law = m.Turning(self.rate_of(drive) or 1.0, start[drive.link].angle)
        return m.Drive(name, drive.link, law, motor=drive.link if len(self.drives) > 1 else None)

    def _sliding(self, link: str, joints: Sequence[m.Joint]) -> tuple[m.Slide, float]:
        """The joint of a link that slides on the ground, and its drawn place along that, mm."""
        slide = next(
            each for each in joints if isinstance(each, m.Slide) and each.runner.body == link
        )
        way = cmath.exp(1j * slide.angle)
        return slide, ((self.at(self.links[link][0]) - slide.guide.at) / way).real

    def _load(self, cam: t.Cam, joint: m.Cam) -> m.Resistance | None:
        """What [[cam]] says that the follower bears."""
        if not cam.damping and not cam.resistance:
            return None
        slide = joint.slide
        of = m.Angle(cam.follower) if slide is None else m.Along(slide)
        force = -joint.leaves * cam.resistance
        return m.Resistance(f"load of {joint.name}", of, force, damping=cam.damping)

    def _follower(self, cam: t.Cam) -> tuple[m.Cam, Follower]:
        """A cam's joint, and its follower as drawn, about the cam's axis."""
        name = cam.joint
        joint = self._open.joint(name)
        assert isinstance(joint, m.Cam)
        sign: Literal[1, -1] = 1 if joint.leaves > 0 else -1
        return joint, follower_of(self._open, joint, self.ridden[name], cam.at, sign)

    def disc(self, cam: t.Cam) -> DiscCam[Any]:
        """A cam about its axis, as it lies at theta = 0; DesignError where it cannot be made."""
        joint, follower = self._follower(cam)
        assert isinstance(joint.law, CamLaw)
        base = self.bases.get(cam.joint)
        on_base = follower if base is None else follower.on_base(base)
        return DiscCam(joint.law.signed, on_base, cam.tip_clearance)

    @cached_property
    def bases(self) -> dict[str, float]:
        """Base radius of each cam that says it, by its joint, mm; DesignError where none keeps to the limits."""
        radii = {}
        for cam in self.cams:
            if cam.base_radius is None:
                continue
            name = cam.joint
            base = cam.base_radius
            if base == "least":
                joint, follower = self._follower(cam)
                assert isinstance(joint.law, CamLaw)
                made = DiscCam(joint.law.signed, follower, cam.tip_clearance)
                room = self.rooms.get(cam.closure, 0.0)
                base = least_base_radius(made, self.ridden[name].limits, room)
            radii[name] = base
        return radii

    @cached_property
    def shifts(self) -> dict[str, float]:
        """How far each base radius moves its cam's follower from where it is drawn, by the cam's joint, mm or rad,
        counter-clockwise; DesignError where the follower cannot stand there."""
        shifts = {}
        for cam in self.cams:
            name = cam.joint
            if name not in self.bases:
                continue
            _, follower = self._follower(cam)
            try:
                shifts[name] = follower.on_base(self.bases[name]).ahead_of(follower)
            except ValueError as error:
                remedy = "use another base_radius, or draw the follower elsewhere"
                raise DesignError(
                    "base_radius",
                    self.bases[name],
                    0,
                    "mm",
                    f"cam {name}",
                    remedy,
                ).saying(f"cam {name}: {error}") from None
        return shifts

    @property
    def drawn_poses(self) -> Mapping[str, m.Pose]:
        """Where links stand by [points] alone."""
        return self._open.start

    @property
    def rough(self) -> m.Machine:
        """The model not yet closed, each follower that says its base radius on that; DesignError where it cannot stand there."""
        machine = self._open
        for name, shift in self.shifts.items():
            joint = self._open.joint(name)
            assert isinstance(joint, m.Cam)
            machine = _moved(machine, joint, shift)
        return machine

    def shifted(self) -> list[str]:
        """What to know of each follower that a base radius moves from where it is drawn, by 1 deg or 1 mm and more."""
        sentences = []
        for k, (name, cam) in enumerate(self.named_cams.items()):
            shift = self.shifts.get(name, 0.0)
            slides = self.slide_of(cam.follower) is not None
            size = abs(shift) if slides else math.degrees(abs(shift))
            if size < _LEAST_SHIFT:
                continue
            way = "" if slides else " clockwise" if shift < 0 else " counter-clockwise"
            amount = f"{size:.3g} {'mm' if slides else 'deg'}"
            verb = "moves" if slides else "turns"
            sentences.append(
                f"{cam.follower} stands {amount}{way} from where it is drawn: cam.{k}.base_radius = {self.bases[name]:.4g} "
                f"{verb} it; it stands as drawn without base_radius"
            )
        return sentences

    def released(self, machine: m.Machine) -> m.Machine:
        """The machine with its freewheels; what they turn on is held still by drives of their names until then."""
        clutches = tuple(self._clutch(freewheel, machine) for freewheel in self.freewheels)
        if not clutches:
            return machine
        joints = (*machine.joints, *clutches)
        return replace(machine, joints=joints, drives=machine.drives[: -len(clutches)])

    def _clutch(self, freewheel: t.Freewheel, held: m.Machine) -> m.Clutch:
        """The joint of wheel and link; held: the machine, its freewheels' links held."""
        wheel = m.Output("wheel", m.Angle(freewheel.wheel), "rad")
        seen = replace(held, outputs=(wheel,))

        def turned(theta: m.Floats, order: int) -> m.Floats:
            return np.asarray(solve(seen, theta, order).derivatives("wheel")[order], float)

        law = Ratchet(
            turned,
            math.radians(freewheel.lost_deg),
            1 if freewheel.turns == "counter-clockwise" else -1,
            -1 if held.speed < 0 else 1,
            held.start[freewheel.link].angle,
        )
        name = freewheel.joint
        return m.Clutch(name, freewheel.wheel, freewheel.link, law, law.apart)

    def _bodies(self) -> tuple[dict[str, m.Body], dict[str, m.Pose]]:
        bodies = {}
        start = {}
        masses = dict(self.masses)
        for name, points in self.links.items():
            drawn = tuple(self.at(point) for point in points)
            lengths = tuple(self.lengths_of(points).items())
            exact, pose = _laid(drawn, lengths, name == GROUND)
            if name != GROUND:
                start[name] = pose
            mass = masses.get(name)
            places = dict(zip(points, exact, strict=True))
            if mass is None:
                bodies[name] = m.Body(name, places)
            else:
                centre = complex(*mass.centre) if mass.centre else complex(np.mean(exact))
                bodies[name] = m.Body(name, places, mass.mass_g / 1e3, centre, mass.inertia_kg_m2)
        return bodies, start

    def _pins(self, bodies: Mapping[str, m.Body]) -> list[m.Joint]:
        pins: list[m.Joint] = []
        for point in self.points:
            links = [name for name, points in self.links.items() if point in points]
            links.sort(key=lambda name: name != GROUND)
            for other in links[1:]:
                name = point if len(links) == 2 else f"{point} of {other}"
                pins.append(
                    m.Pin(name, bodies[links[0]].at(point), bodies[other].at(point), self.play)
                )
        return pins

    def _line(self, body: m.Body, along: t.Two) -> tuple[complex, float]:
        a, b = (complex(body.points[point]) for point in along)
        return a, cmath.phase(b - a)

    def _slides(self, bodies: Mapping[str, m.Body], start: Mapping[str, m.Pose]) -> list[m.Joint]:
        slides: list[m.Joint] = []
        for slide in self.slides:
            base = m.Pose(0j, 0.0) if slide.on == GROUND else start[slide.on]
            through, angle = self._line(bodies[slide.on], slide.along)
            runner = self.links[slide.link][0]
            place = (self.at(runner) - base.place) * cmath.exp(-1j * base.angle)
            away = (place - through) * cmath.exp(-1j * angle)
            aside = through + 1j * away.imag * cmath.exp(1j * angle)
            slides.append(
                m.Slide(
                    slide.joint,
                    m.Place(slide.on, aside),
                    bodies[slide.link].at(runner),
                    angle,
                    start[slide.link].angle - base.angle,
                    self.play,
                )
            )
        return slides

    def _slots(self, bodies: Mapping[str, m.Body]) -> list[m.Joint]:
        slots: list[m.Joint] = []
        for slot in self.slots:
            through, angle = self._line(bodies[slot.link], slot.along)
            carrier = self.carrier(slot)
            assert carrier is not None, "drawing_faults has looked"
            slots.append(
                m.Slot(
                    slot.joint,
                    m.Place(slot.link, through),
                    bodies[carrier].at(slot.pin),
                    angle,
                    self.play,
                )
            )
        return slots

    def _gear(self, gear: t.Gear, start: Mapping[str, m.Pose]) -> m.Gear:
        carriers = [
            name
            for name, points in self.links.items()
            if name not in (gear.a, gear.b)
            and set(points) & set(self.links[gear.a])
            and set(points) & set(self.links[gear.b])
        ]
        carrier = GROUND if GROUND in carriers or not carriers else carriers[0]
        angle = {GROUND: 0.0} | {name: start[name].angle for name in start}
        base = angle[carrier]
        phase = (angle[gear.b] - base) - gear.ratio * (angle[gear.a] - base)
        return m.Gear(gear.joint, gear.a, gear.b, gear.ratio, phase, carrier)

    def _cam(self, cam: t.Cam, start: Mapping[str, m.Pose], joints: Sequence[m.Joint]) -> m.Cam:
        slide = self.slide_of(cam.follower)
        carrier, phase = self._carrier(cam, start, joints)
        spoke = self._spoke(cam, carrier)
        if slide is not None:
            joint, rest = self._sliding(cam.follower, joints)
            way = cmath.exp(1j * joint.angle)
        else:
            hinge = self.pivot(cam.follower)
            assert hinge is not None, "drawing_faults has looked"
            way = 1j * (self.at(cam.at) - self.at(hinge))
            rest = start[cam.follower].angle
        outward = (spoke.conjugate() * way).real
        if abs(outward) <= 1e-6 * abs(spoke) * abs(way):
            off = (
                f"the travel of {cam.cam}"
                if carrier
                else f"the line from {self.pivot(cam.cam)} to {cam.at}"
            )
            remedy = (
                f"the follower moves along {off}: draw {cam.at} elsewhere"
                if carrier
                else f"the follower moves across {off}: draw {cam.at} elsewhere"
            )
            raise DesignError("pressure angle as drawn", 90, 90, "deg", f"cam {cam.joint}", remedy)
        sign = 1 if outward > 0 else -1
        form: Literal["form", "force"] = "force" if cam.closure == "force" else "form"
        return m.Cam(
            cam.joint,
            cam.cam,
            cam.follower,
            CarriedLaw(self.program_of(cam), sign)
            if carrier
            else CamLaw(self.program_of(cam), sign),
            None if slide is None else slide.joint,
            phase,
            rest,
            form,
            sign,
            over=carrier.name if carrier else None,
        )

    def _carrier(
        self, cam: t.Cam, start: Mapping[str, m.Pose], joints: Sequence[m.Joint]
    ) -> tuple[m.Slide | None, float]:
        """The slide of a plate, None of a disc; and the cam's place along it, mm, or its angle, rad, as drawn."""
        if not self.carries_plate(cam):
            return None, start[cam.cam].angle
        return self._sliding(cam.cam, joints)

    def _spoke(self, cam: t.Cam, carrier: m.Slide | None) -> complex:
        """What points from a cam to what touches it: from a disc's shaft, or square to a plate's way."""
        if carrier is None:
            pivot = self.pivot(cam.cam)
            assert pivot is not None, "drawing_faults has looked"
            return self.at(cam.at) - self.at(pivot)
        way = cmath.exp(1j * carrier.angle)
        aside = (self.at(cam.at) - carrier.guide.at) / way
        return 1j * math.copysign(1, aside.imag) * way

    def _geneva(
        self, table: t.Geneva, bodies: Mapping[str, m.Body], start: Mapping[str, m.Pose]
    ) -> m.Cam:
        """The joint; its angle is 0 in the middle of a drive: the pin is on the line of both axes, towards that of the wheel, but
        away from that of an inner one."""
        law = GenevaLaw(self.geneva_of(table))
        ground = bodies[GROUND].points
        axes = [complex(ground[self.pivot(link) or ""]) for link in (table.a, table.b)]
        crank = bodies[table.a].points
        spoke = complex(crank[table.pin]) - complex(crank[self.pivot(table.a) or ""])
        phase = cmath.phase(law.geneva.sense * (axes[0] - axes[1]) / spoke)
        angle = start[table.a].angle - phase
        rest = start[table.b].angle - float(law(np.array(angle)))
        name = table.joint
        return m.Cam(name, table.a, table.b, law, phase=phase, rest=rest)

    def _noncircular(self, table: t.Noncircular, start: Mapping[str, m.Pose]) -> m.Cam:
        """The joint; its angle is 0 as drawn."""
        law = self.noncircular_pairs[table.joint].centrodes.law.reversed
        phase, rest = (start[link].angle for link in (table.a, table.b))
        return m.Cam(table.joint, table.a, table.b, law, phase=phase, rest=rest)

    def _mutilated(self, table: t.Mutilated, start: Mapping[str, m.Pose]) -> m.Cam:
        """The joint; its angle is 0 as drawn, in the middle of a rest."""
        law = self.mutilated_laws[table.joint]
        phase, rest = (start[link].angle for link in (table.a, table.b))
        return m.Cam(table.joint, table.a, table.b, law, phase=phase, rest=rest)

    def _ratchet(self, table: t.Ratchet, start: Mapping[str, m.Pose]) -> m.Cam:
        """The joint; its angle is 0 in the seat of a tooth, and as drawn the pawl is halfway from drop to drop."""
        law = self.ratchet_wishes[table.joint].law
        pawl = law.pawl
        angle = law.way * (pawl.dropping - pawl.wheel.pitch / 2)
        phase = start[table.a].angle - angle
        rest = start[table.b].angle - float(law(np.array(angle)))
        links = table.joint, table.a, table.b, law
        return m.Cam(*links, phase=phase, rest=rest, closure="force", leaves=-law.way)

    def _place(self, point: str, bodies: Mapping[str, m.Body]) -> m.Place:
        """A point on the first link that has it."""
        carrier = next(name for name, points in self.links.items() if point in points)
        return bodies[carrier].at(point)

    def _output(self, output: t.Wanted, bodies: Mapping[str, m.Body]) -> m.Output:
        if output.point is not None:
            return m.Output(output.name, m.Path(self._place(output.point, bodies)))
        if output.thread is not None:
            places = tuple(self._place(point, bodies) for point in output.thread)
            return m.Output(output.name, m.Function(places, thread_length))
        assert output.link is not None
        slide = self.slide_of(output.link)
        if slide is not None:
            return m.Output(output.name, m.Along(slide.joint))
        return m.Output(output.name, m.Angle(output.link), "rad")


def _cycloid(wish: CycloidWish, start: Mapping[str, m.Pose]) -> list[m.Cam]:
    """Its joints, at their angle 0 as drawn: crank and disc, disc and output, which turns as the disc does."""
    crank, disc = (start[link].angle for link in (wish.crank, wish.link))
    law = m.Turning(wish.disc.ratio)
    joints = [m.Cam(wish.joint, wish.crank, wish.link, law, phase=crank, rest=disc)]
    if wish.output is not None and wish.opposite is None:  # the first disc says how it turns
        joints.append(wish.output_law(start))
    return joints


def _between(
    points: Sequence[str], lengths: Iterable[tuple[tuple[str, str], float]]
) -> dict[tuple[int, int], float]:
    """Those of the lengths that lie between these points, by their places in the row, mm."""
    found = {}
    for names, length in lengths:
        if names[0] in points and names[1] in points:
            a, b = sorted(points.index(name) for name in names)
            found[a, b] = length
    return found


@lru_cache(maxsize=256)  # of variants most links are the same
def _laid(
    drawn: tuple[complex, ...], lengths: tuple[tuple[tuple[int, int], float], ...], still: bool
) -> tuple[tuple[complex, ...], m.Pose]:
    """A link's points in its frame, and where that is drawn; those of what stands still are on the ground."""
    exact = shape(np.array(drawn), dict(lengths))[0]
    if still:
        return tuple(exact.tolist()), m.Pose(0j, 0.0)
    angle = cmath.phase(exact[1] - exact[0]) if len(exact) > 1 else 0.0
    pose = m.Pose(complex(exact[0]), angle)
    exact = (exact - exact[0]) * cmath.exp(-1j * angle)
    if len(exact) > 1:
        exact[1] = abs(exact[1])
    return tuple(exact.tolist()), pose


def _moved(machine: m.Machine, joint: m.Cam, ahead: float) -> m.Machine:
    """The machine with a cam's follower further along its way, mm or rad, as it stands at theta = 0."""
    pose = machine.start_of(joint.follower)
    if joint.slide is not None:
        slide = machine.slide(joint.slide)
        pose = replace(pose, place=pose.place + ahead * cmath.exp(1j * slide.angle))
    else:
        turn = cmath.exp(1j * ahead)
        hinge = pivot(machine, joint.follower)[1]
        pose = m.Pose(hinge + (pose.place - hinge) * turn, pose.angle + ahead)
    joints = tuple(
        replace(joint, rest=joint.rest + ahead) if each.name == joint.name else each
        for each in machine.joints
    )
    return replace(machine, joints=joints, start={**machine.start, joint.follower: pose})
