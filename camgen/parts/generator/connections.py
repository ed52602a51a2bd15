"""What meets what in a linkage of parts: pivots, shafts and what rides on them, wheels, springs, pens.

pivot    a point with a pin: the links that it joins, the ground first, one with a slot last
channel  a slot of the ground; its pin ends in the plate that has it, and is fixed in the link next to that
shaft    in place of a pin where a link that turns on the ground drives or carries wheels: it is fixed in that link
rider    what sits on a pin or shaft beside the links: rollers, wheels
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, TypeVar

from camgen.errors import DesignError
from camgen.geometry.outlines import Contour
from camgen.machine import model as m
from camgen.machine.features import Mount, StandIn
from camgen.machine.jets import thread_length
from camgen.parts.catalogue import Bearing, Bought
from camgen.parts.gears import GearWish
from camgen.parts.generator.cycloids import CycloidWish
from camgen.parts.generator.gears import DowelledWheel, GearPair, GearWheel, PlanetWish, gear_pairs
from camgen.parts.generator.genevas import DowelledEdge, GenevaDrive, GenevaWish
from camgen.parts.generator.mutilated import MutilatedDrive
from camgen.parts.generator.noncircular import NoncircularDrive
from camgen.parts.generator.ratchets import RatchetDrive, RatchetWish
from camgen.parts.generator.sizes import Parts
from camgen.parts.generator.webs import throws, webs, with_webs
from camgen.parts.generator.wheels import (
    EdgeDrive,
    PlateTip,
    Ridden,
    Roller,
    Tip,
    Wheel,
    groove_rim,
    level_of,
    plates,
    tips,
    with_seconds,
)
from camgen.parts.hardware import FACETS
from camgen.parts.part import Layer, Part
from camgen.parts.wheels.involute import Ring
from camgen.parts.wheels.mutilated import MutilatedLaw
from camgen.parts.wheels.noncircular import NoncircularPair
from camgen.spec import Print

GROUND = m.GROUND
D = TypeVar("D", bound=EdgeDrive)
_DRIVES: Mapping[type, type[EdgeDrive]] = {
    GenevaWish: GenevaDrive,
    NoncircularPair: NoncircularDrive,
    MutilatedLaw: MutilatedDrive,
    RatchetWish: RatchetDrive,
}


@dataclass(frozen=True)
class StretchedSpring:
    """A spring between two points, whose pins hold its eyes."""

    a: tuple[str, str]  # body and point
    b: tuple[str, str]
    diameter: float  # mm, outside
    wire: float  # mm
    key: str = ""  # of the spec, that says where its end on the ground is; "" of points that have their own


@dataclass(frozen=True)
class SecondPlate:
    """The plate over all links."""

    # highest level of the lower stub of each pin and shaft that does not go from plate to plate, by its point; 0: all hangs
    cuts: Mapping[str, int]
    columns: tuple[complex, ...]  # places of the posts
    highest: int  # level that is taken


@dataclass(frozen=True)
class Sleeve:
    """What joins the upper end of the shaft to another one over it."""

    diameter: float  # mm, of the other
    flat: float  # mm, of the other
    turn: float  # rad, from this one's flat to the other's
    up: float  # mm, how far the sleeve reaches up on the other


@dataclass(frozen=True)
class MergedFrame:
    """Another machine's frame as the second plate takes it; mm, places on the ground."""

    discs: tuple[tuple[complex, float], ...]  # of its outline
    holes: tuple[Contour, ...]
    above: tuple[Layer, ...]  # what stands on it, heights over the plate's upper side
    shaft: float  # how far the shaft reaches over that side


@dataclass(frozen=True)
class Stand:
    """Another machine's frame that stands on the second plate."""

    name: str
    places: tuple[complex, ...]  # of its screw holes, under which there are posts
    high: float  # mm, of the posts' upper ends
    sleeve: Sleeve | None
    merged: MergedFrame | None


@dataclass(frozen=True)
class Fitting:
    """What a machine of a kind has beside the parts that follow from its joints; lengths mm."""

    feet: tuple[tuple[complex, float], ...] = ()  # holes for screws that hold the plate, diameters
    holes: Mapping[str, Contour] = field(default_factory=dict)  # further ones of the plate
    links: Mapping[str, Part] = field(default_factory=dict)  # bodies of links in place of theirs
    parts: tuple[tuple[Part, Mount], ...] = ()  # further parts
    stand_ins: tuple[StandIn, ...] = ()
    bought: tuple[Bought, ...] = ()
    holder: str = ""  # what holds the plate, as the last step says
    keep_outs: tuple[
        tuple[complex, float], ...
    ] = ()  # discs on the ground that posts keep clear of
    hubs: tuple[tuple[complex, float], ...] = ()  # further discs that the plate holds


@dataclass(frozen=True)
class Connections:
    """A machine, the sizes of its parts, and what meets what; lengths mm."""

    drawn: m.Machine  # closed as drawn
    driven: str  # link that the drive moves
    sizes: Parts
    fits: Print
    min_wall: float
    given: Mapping[str, int]  # levels that are asked for
    strokes: Mapping[str, tuple[float, float]]  # least and greatest place along slots and slides
    cams: Mapping[str, Ridden] = field(default_factory=dict)  # what touches each
    gears: Mapping[str, GearWish] = field(default_factory=dict)  # what is asked of each pair
    planets: Sequence[PlanetWish] = ()
    cycloids: Sequence[CycloidWish] = ()
    # what is asked of pairs that drive by their edges: wishes of Geneva drives and ratchets, wheels that are not round,
    # laws of mutilated gears
    edges: Mapping[str, object] = field(default_factory=dict)
    stems: Mapping[str, str] = field(default_factory=dict)  # how slides' runners reach their rails
    sunk: bool = False  # whether the ground's pins turn in the plate, heads under it
    springs: Mapping[str, StretchedSpring] = field(default_factory=dict)
    # the link on whose shaft a link runs, and its one-way clutch
    freewheels: Mapping[str, tuple[str, Bearing]] = field(default_factory=dict)
    marks: Mapping[str, complex] = field(default_factory=dict)  # holes that show how links stand
    guest_links: Mapping[str, str] = field(default_factory=dict)  # links on another layout's shaft
    further: tuple[str, ...] = ()  # links that other motors turn, a shaft each
    feet: Sequence[tuple[complex, float]] = ()  # further holes of the plate, diameters
    hangs: bool = False  # whether these hold the plate
    second: SecondPlate | None = None  # over all, once levels are found
    weights: Sequence[Wheel] = ()  # counterweights on shafts
    tall: frozenset[str] = frozenset()  # points of dowels that stand out of their caps by a level
    stands: tuple[Stand, ...] = ()  # what else stands on the second plate
    keep_outs: tuple[
        tuple[complex, float], ...
    ] = ()  # discs on the ground that posts keep clear of
    fitting: Callable[[Any], Fitting] | None = None  # makes `fitted` of the layout on its levels
    fitted: Fitting = Fitting()
    metal: bool = False  # whether parts are of it
    drawn_poses: Mapping[str, m.Pose] = field(default_factory=dict)  # of links by [points] alone

    # ---- joints -----------------------------------------------------------------------------------------------------

    @cached_property
    def machine(self) -> m.Machine:
        """The machine with all its points."""
        return with_seconds(self.drawn, self.cams)

    @property
    def drivers(self) -> tuple[str, ...]:
        """Links that motors turn: not one that slides."""
        return tuple(link for link in (self.driven, *self.further) if link not in self.slides)

    @cached_property
    def webs(self) -> dict[str, tuple[str, ...]]:
        """Points of each web of the interrupted shaft, from below, by its name; nothing where the shaft goes through."""
        if self.sizes.shaft != "interrupted":
            return {}
        links = {body.name: tuple(body.points) for body in self.machine.bodies}
        shaft = next(point for point in links[self.driven] if point in links[GROUND])
        return webs(
            self.driven, shaft, throws(links, self.driven, list(self.slots)), self.sizes.plates > 1
        )

    @cached_property
    def bodies(self) -> dict[str, m.Body]:
        """Of the machine by their names, the driven link as its webs, each in that link's axes."""
        return {body.name: body for body in with_webs(self.machine.bodies, self.driven, self.webs)}

    @property
    def moving(self) -> list[str]:
        """Names of those that move."""
        return [name for name in self.bodies if name != GROUND]

    def carrier(self, link: str) -> str:
        """The body of the model that a web is of; any other link is one itself."""
        return self.driven if link in self.webs else link

    def web_at(self, body: str, point: str) -> str:
        """The lowest web with a point, of the driven link where it has webs; any other link is itself."""
        return (
            next((web for web, held in self.webs.items() if point in held), body)
            if body == self.driven
            else body
        )

    @property
    def upper_web(self) -> str:
        """The last web, which turns in the second plate."""
        return [*self.webs, self.driven][max(0, len(self.webs) - 1)]

    def webs_at(self, point: str) -> list[str]:
        """Webs that the pin or shaft of a point joins, from below."""
        return [
            link
            for link in self.pivots.get(point, ())
            if link in self.webs and link != self.slotted_link(point)
        ]

    @cached_property
    def slides(self) -> dict[str, m.Slide]:
        """The slide of each link that slides."""
        return {
            joint.runner.body: joint for joint in self.machine.joints if isinstance(joint, m.Slide)
        }

    @cached_property
    def slots(self) -> dict[str, m.Slot]:
        """The slot that a point's pin runs in, by the point's name."""
        joints = [joint for joint in self.machine.joints if isinstance(joint, m.Slot)]
        slots = {self._named(joint.runner)[1]: joint for joint in joints}
        if len(slots) < len(joints):
            remedy = "give each slot a pin of its own"
            raise DesignError("slots of one pin", 2, 1, "", "[[slot]]", remedy)
        return slots

    def slotted_link(self, point: str) -> str:
        """The link with the slot in which a point's pin runs, "" where it runs in none."""
        return self.slots[point].guide.body if point in self.slots else ""

    @cached_property
    def channels(self) -> set[str]:
        """Points whose pins run in slots of the ground."""
        return {point for point in self.slots if self.slotted_link(point) == GROUND}

    @cached_property
    def tips(self) -> list[Tip]:
        """What runs on each cam."""
        return tips(self.machine, self.cams, self.sizes, self.fits.slide_clearance)

    @cached_property
    def plates(self) -> list[PlateTip]:
        """Cams that slide, and what runs on them."""
        return plates(self.machine, self.cams)

    @cached_property
    def gear_pairs(self) -> list[GearPair]:
        """Pairs of gears; their backlash is the clearance of what slides, their least module two nozzles."""
        least = 2 * self.fits.nozzle
        backlash = self.fits.slide_clearance
        return gear_pairs(self.machine, self.gears, self.planets, backlash, least)

    @cached_property
    def gear_wheels(self) -> list[GearWheel]:
        """Wheels of gears, rings too."""
        every = (wheel for each in self.gear_pairs for wheel in (each.a, each.b))
        return list(dict.fromkeys(every))

    @cached_property
    def dowelled(self) -> list[DowelledWheel | DowelledEdge]:
        """What dowels hold: rings of inner teeth, suns that stand still, inner Geneva wheels and their locks."""
        rim = groove_rim(self.sizes) + self.fits.press_clearance
        edges = (
            each
            for drive in self.drives_of(GenevaDrive)
            for each in drive.dowelled(self.machine, rim)
        )
        return [*self.dowelled_wheels, *edges]

    @cached_property
    def pinned(self) -> list[DowelledEdge]:
        """Locks on shafts that a dowel holds on their cranks."""
        hub = (self.sizes.pin_diameter + self.fits.press_clearance) / 2 + self.rim
        found = []
        for drive in self.drives_of(GenevaDrive):
            lock = drive.pinned(self.machine, hub)
            if lock is None:
                continue
            if self.sizes.of_sheet:
                where = f"geneva {drive.joint.name}"
                remedy = (
                    "leave geneva.gap out: levels of sheet lie as far apart as the sheet is thick"
                )
                raise DesignError("gaps of sheet", 1, 0, "", where, remedy)
            if self.sizes.plates < 2:  # which hold a shaft at one end alone
                drive.refuse_tipping(self.fits.slide_clearance / self.sizes.base_thickness)
            found.append(lock)
        return found

    @cached_property
    def dowelled_wheels(self) -> list[DowelledWheel]:
        """Rings of inner teeth, and suns that stand still."""
        rim = groove_rim(self.sizes) + self.fits.press_clearance
        bore = self.sizes.shaft_diameter / 2 + self.fits.slide_clearance
        between = {
            level_of(wish.level): wish.carrier for wish in self.planets if wish.sun == GROUND
        }
        found = []
        for wheel in self.gear_wheels:
            root = wheel.gear.root
            if isinstance(wheel.gear, Ring):
                found.append(DowelledWheel(wheel, root + rim, between.get(wheel.level, "")))
            elif wheel.link == GROUND:
                self._refuse_small(wheel, root - bore)
                found.append(DowelledWheel(wheel, bore))
        return found

    def _refuse_small(self, sun: GearWheel, room: float) -> None:
        """DesignError where a sun on the ground has no room for dowels between its bore and its teeth, mm."""
        needed = self.sizes.pin_diameter + self.fits.press_clearance + 2 * self.min_wall
        if room < needed:
            raise DesignError(
                "room for dowels between the sun's bore and its teeth",
                room,
                needed,
                "mm",
                f"planets {sun.level}",
                "use a larger sun: more teeth of it in planets.teeth, or the first planet's pin further from the axis",
            )

    @property
    def standing_suns(self) -> list[GearWheel]:
        """Suns on the ground, through which a shaft goes."""
        return [each.wheel for each in self.dowelled_wheels if not each.within]

    @cached_property
    def edge_drives(self) -> list[EdgeDrive]:
        """Pairs whose wheels drive each other by their edges."""
        wide = (self.sizes.shaft_diameter + self.fits.press_clearance) / 2
        hub = wide + self.sizes.key_room + self.rim
        return [
            _DRIVES[type(wish)](self.machine.cam(name), wish, hub)
            for name, wish in self.edges.items()
        ]

    def drives_of(self, kind: type[D]) -> list[D]:
        """Those of one kind."""
        return [each for each in self.edge_drives if isinstance(each, kind)]

    @cached_property
    def rollers(self) -> list[Roller]:
        """All rollers on pins."""
        return [
            *(tip.roller for tip in self.tips if tip.rolls),
            *(plate.roller for plate in self.plates),
            *(each.roller for each in self.drives_of(GenevaDrive)),
        ]

    @cached_property
    def wheels(self) -> list[Wheel]:
        """Cam discs, gears' wheels on shafts and pins, wheels that drive by their edges, counterweights."""
        on_dowels = {each.wheel for each in self.dowelled_wheels}
        return [
            *(tip.wheel for tip in self.tips),
            *(each.wheel for each in self.gear_wheels if each not in on_dowels),
            *(wheel for each in self.edge_drives for wheel in each.wheels),
            *self.weights,
        ]

    @cached_property
    def pivots(self) -> dict[str, tuple[str, ...]]:
        """Links at each point with a pin, the ground first and one with a slot last, by the point's name."""
        slots = self.slots
        single = {roller.point for roller in self.rollers}.union(
            self.hook_points, self.guest_links, slots
        )
        carriers: dict[str, list[str]] = {}
        for body in self.bodies.values():
            for point in body.points:
                carriers.setdefault(point, []).append(body.name)
        return {
            point: (
                *sorted(links, key=lambda link: link != GROUND),
                *([slots[point].guide.body] if point in slots else ()),
            )
            for point, links in carriers.items()
            if len(links) > 1 or point in single
        }

    @cached_property
    def hook_points(self) -> set[str]:
        """Points on whose pin a spring's eye sits."""
        return {point for each in self.springs.values() for _, point in (each.a, each.b)}

    @cached_property
    def alone(self) -> dict[str, str]:
        """Links that are no more than a wheel on their shaft, and the level of that wheel."""
        levels = {wheel.link: wheel.level for wheel in reversed(self.wheels)}
        ringed = {each.wheel.link for each in self.dowelled}
        return {
            link: level
            for link, level in levels.items()
            if len(self.bodies[link].points) <= 1
            and not self.sizes.shape(link).hub_diameter
            and link not in ringed
        }

    @cached_property
    def shafts(self) -> dict[str, str]:
        """The link that is fixed on the shaft at a point: driven ones first."""
        loose = {*self.freewheels, *self.planet_pins}
        on_shafts = [wheel.link for wheel in self.wheels if wheel.link not in loose]
        shafts: dict[str, str] = {}
        for link in dict.fromkeys([*self.drivers, *on_shafts]):
            shafts.setdefault(self.axis_of(link), link)
        return {**shafts, **self.guest_links}

    def axis_of(self, link: str) -> str:
        """The point about which a link turns on the ground."""
        held = self.bodies[link].points
        return next(point for point in held if self.pivots.get(point, ("",))[0] == GROUND)

    def axis_of_wheel(self, wheel: GearWheel | Wheel) -> str:
        """The point of the ground about which a wheel on dowels lies."""
        beside = wheel.beside if isinstance(wheel, GearWheel) else ""
        return self.axis_of(beside or wheel.link)

    @cached_property
    def planet_pins(self) -> dict[str, str]:
        """The point about which each planet turns on its carrier."""
        return dict(pair for wish in self.planets for pair in wish.planets)

    @cached_property
    def over_shafts(self) -> dict[str, tuple[str, ...]]:
        """Links of planetary sets and cycloidal drives that turn on the shaft at a point over what is fixed on it, a cap over them."""
        over: dict[str, tuple[str, ...]] = {}
        for wish in self.planets:
            members = wish.turning
            point = self.axis_of(members[0])
            fixed = self.shafts.get(point)
            above = members[members.index(fixed) + 1 :] if fixed in members else []
            if above:
                over[point] = (*over.get(point, ()), *above)
        for each in (each for each in self.cycloids if each.opposite is None):
            point = self.axis_of(each.crank)
            if each.output is not None and self.shafts.get(point) == each.crank:
                over[point] = (*over.get(point, ()), each.output)
        return over

    @cached_property
    def riders(self) -> dict[str, list[str]]:
        """Levels of what sits on a pin or shaft beside the links, by the point's name."""
        pairs = [
            *((roller.point, roller.level) for roller in self.rollers),
            *((self.shaft_of(wheel.link), wheel.level) for wheel in self.wheels),
            *((self.axis_of_wheel(sun), sun.level) for sun in self.standing_suns),
            *((end[1], name) for name, each in self.springs.items() for end in (each.a, each.b)),
        ]
        riders: dict[str, list[str]] = {}
        for point, level in pairs:
            riders.setdefault(point, []).append(level)
        return riders

    def shaft_of(self, link: str) -> str:
        """The point of a link's shaft, or of the one that it turns on; of a planet that of its pin."""
        if link in self.planet_pins:
            return self.planet_pins[link]
        on = self.freewheels[link][0] if link in self.freewheels else link
        found = (point for point, held in self.shafts.items() if held == on)
        return next(found, None) or self.axis_of(on)

    @cached_property
    def discs(self) -> dict[str, tuple[str, str]]:
        """Of each pin that is a disc its link, and the point of the shaft that goes through it; through one of the ground the
        nearest."""
        discs = {}
        for point in self.disc_sizes:
            links = self.pivots.get(point, ())
            shafts = [shaft for shaft in self.shafts if shaft != point]
            if links[:1] == (GROUND,) and point not in self.shafts and shafts:
                at = self.bodies[GROUND].points
                discs[point] = GROUND, min(shafts, key=lambda name: abs(at[name] - at[point]))
            for shaft in (shaft for shaft in shafts if self.shafts[shaft] in links):
                discs[point] = self.shafts[shaft], shaft
        return discs

    @cached_property
    def disc_sizes(self) -> dict[str, float]:
        """Diameters of pins that are discs, mm, by their points; a second eccentric is as large as the first."""
        given = self.sizes.discs or {}
        second = {upper: given[lower] for upper, lower in self.eccentrics.items() if lower in given}
        return {**given, **second}

    @cached_property
    def eccentrics(self) -> dict[str, str]:
        """The point of each eccentric that is a part of its own, over another one, and the point of that."""
        return {each.at: each.opposite.at for each in self.cycloids if each.opposite is not None}

    def on_ground(self, point: str) -> bool:
        """Whether a pin is a disc of the ground."""
        return point in self.discs and self.discs[point][0] == GROUND

    def discs_on(self, shaft: str) -> list[str]:
        """Points of the discs through which the shaft at a point goes."""
        return [point for point, (_, on) in self.discs.items() if on == shaft]

    def clutch(self, point: str) -> Bearing | None:
        """The one-way clutches in which a shaft turns."""
        return next(
            (each for on, each in self.freewheels.values() if self.shafts.get(point) == on), None
        )

    @cached_property
    def threads(self) -> dict[str, tuple[tuple[str, str], ...]]:
        """Links and points of the posts that each thread passes, by the name of its output."""
        threads = {}
        for output in self.machine.outputs:
            if isinstance(output.of, m.Function) and output.of.value is thread_length:
                threads[output.name] = tuple(map(self._named, output.of.of))
        return threads

    def _named(self, place: m.Place) -> tuple[str, str]:
        """The body of a place, and which of its points that is."""
        points = self.machine.body(place.body).points
        return place.body, next(name for name, z in points.items() if z == place.at)

    @cached_property
    def thread_posts(self) -> dict[str, str]:
        """The link of each point at which a thread has a post."""
        return {point: link for thread in self.threads.values() for link, point in thread}

    @cached_property
    def pens(self) -> dict[str, str]:
        """The link of each point that is an output and no pin."""
        pens = {}
        for output in self.machine.outputs:
            if (
                isinstance(output.of, m.Path)
                and self.sizes.pen_diameter
                and output.of.of.body != GROUND
            ):
                body, name = self._named(output.of.of)
                if name not in self.pivots and name not in self.thread_posts:
                    pens[name] = body
        return pens

    @property
    def rim(self) -> float:
        """Width of the material round a hole, mm: where that is just the least wall, so much more as facets may take of it."""
        wall = self.sizes.wall
        least = self.min_wall
        return max(wall, least + 2 * FACETS) if wall >= least else wall

    def on_motor(self, point: str, link: str) -> bool:
        """Whether a hole is the plate's for the motor's boss."""
        driven = self.shafts.get(point) in self.drivers
        return self.sizes.face is not None and link == GROUND and driven
