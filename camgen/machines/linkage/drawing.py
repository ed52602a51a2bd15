"""A drawing: the tables of a spec that say a machine, and what they say of each other.

drawn position   theta = 0; the driven link's angle, a cam follower's place and a cam's angle there are as drawn
pin              a point that two links share; of more links each is pinned to the first, the ground before all
cam              its program begins at theta = 0, where the follower stands on the base circle, and runs in the sense of turning
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Literal

import numpy as np

from camgen.errors import Key
from camgen.machine import model as m
from camgen.machine.cams.limits import Advice
from camgen.machines.linkage import planets
from camgen.machines.linkage import tables as t
from camgen.machines.linkage.links import shape
from camgen.motion.polydyne import Lag, polydyne
from camgen.motion.program import Program
from camgen.motion.segments import program
from camgen.motion.stroke import StrokeSegment, stroke
from camgen.parts.generator.cycloids import CycloidWish
from camgen.parts.generator.genevas import GenevaWish
from camgen.parts.generator.ratchets import RatchetWish
from camgen.parts.generator.wheels import SECOND, Ridden, level_of, naming
from camgen.parts.wheels.cycloid import CycloidDisc, OutputWish
from camgen.parts.wheels.geneva import Geneva, InnerGeneva, geneva
from camgen.parts.wheels.mutilated import MutilatedLaw, MutilatedPair
from camgen.parts.wheels.noncircular import Centrodes, NoncircularPair
from camgen.parts.wheels.ratchet import PawlLaw, RatchetWheel, pawl_of

GROUND = m.GROUND
RETURN = "return_spring"


@dataclass(frozen=True)
class Drawing:
    """The tables that say a machine; `DrawnMachine` is the model, once `drawing_faults` finds nothing wrong between them."""

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
    def pairs(self) -> Sequence[t.Pair]:
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
            made = geneva(kind, table.slots, distance, table.pin_radius, wall, air)
            return made if table.floor is None else replace(made, floor=table.floor)

    def _shafts_apart(self, a: str, b: str) -> float:
        """Distance of the points at which two links are pinned to the ground, mm."""
        ground = self.links[GROUND]
        ends = [ground.index(self.pivot(link) or "") for link in (a, b)]
        exact = shape(self.drawn(ground), _between(ground, self._given_lengths))[0]
        return abs(complex(exact[ends[1]] - exact[ends[0]]))

    @cached_property
    def edge_wishes(self) -> dict[str, Any]:
        """What is asked of each pair that drives by its edge, by its joint; DesignError where there is none such."""
        return {
            **{
                each.joint: GenevaWish(self.geneva_of(each), each.pin, each.gap)
                for each in self.genevas
            },
            **{each.joint: self._noncircular_pair(each) for each in self.noncirculars},
            **{each.joint: self._mutilated_law(each) for each in self.mutilated},
            **{each.joint: self.ratchet_of(each) for each in self.ratchets},
        }

    def _backlash(self, table: t.Noncircular | t.Mutilated) -> float:
        """Play of its teeth, mm."""
        return 2 * self.geneva_sizes[0] if table.backlash is None else table.backlash

    def _noncircular_pair(self, table: t.Noncircular) -> NoncircularPair:
        with naming(f"noncircular {table.joint}"):
            centrodes = Centrodes(table.law, self._shafts_apart(table.a, table.b))
            return NoncircularPair(centrodes, table.teeth, self._backlash(table))

    def _mutilated_law(self, table: t.Mutilated) -> MutilatedLaw:
        apart = self._shafts_apart(table.a, table.b)
        with naming(f"mutilated {table.joint}"):
            pair = MutilatedPair(table.teeth, table.stations, apart, self._backlash(table))
        return MutilatedLaw(pair, self._way(table.a))

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
