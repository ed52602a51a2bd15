"""What is where in a linkage of parts: holes and hubs, pins and shafts, slots, what slides between which rails, levels.

level    a link's or a wheel's: as high as the thickest on it and one play, so that flat faces run on each other; what is
         thinner stands on its floor, and spacers on that; 0 is the plate
"""

from __future__ import annotations

import cmath
import math
from dataclasses import replace
from functools import cached_property

from camgen.geometry.outlines import Contour
from camgen.parts.catalogue import (
    BEARINGS,
    DOWEL_STANDARD,
    HARD_DOWEL_STANDARD,
    Bearing,
    bush_in,
    narrowest,
)
from camgen.parts.fixing import IN_BUSH, JOURNAL, PIN, Joint, joint_of
from camgen.parts.generator.changes import Change
from camgen.parts.generator.connections import GROUND, Connections, StretchedSpring
from camgen.parts.generator.covers import Cover, cover
from camgen.parts.generator.cycloids import CycloidDrive, CycloidWish
from camgen.parts.generator.genevas import GenevaDrive
from camgen.parts.generator.guides import Guide, Rails, Runner, Way, guide
from camgen.parts.generator.wheels import Roller, Tip, naming, plate_outline
from camgen.parts.part import ROD, d_bore
from camgen.parts.set_screws import SetScrewHub
from camgen.parts.wheels.cycloid import OutputPins

__all__ = ["GROUND", "Layout", "StretchedSpring"]

_PLAIN = ("printed", "turned", "dowel")  # pins that may stand in the plate, or hang from it
_ROOM = 0.5  # mm, beyond a pin's way at both ends of its slot


_RECESS = 0.5  # mm: camgen's own rule; four parts may be as much thinner together


def pivot_name(point: str) -> str:
    """Name of the part that is a disc of the ground."""
    return f"pivot-{point}"


class Layout(Connections):
    """A machine and the sizes of its parts, on their levels."""

    def changed(self, change: Change) -> Layout:
        """With other sizes."""
        given = {} if change.free else self.given
        return replace(self, sizes=change.of(self.sizes), given=given)

    # ---- holes and hubs -----------------------------------------------------------------------------------------------

    def at(self, body: str, point: str) -> complex:
        """Place of a point in a body's axes."""
        return complex(self.bodies[body].points[point])

    def turning(self, point: str) -> float:
        """Diameter of what turns at a point, mm."""
        if point in self.discs:
            return self.disc_sizes[point]
        if point in self.shafts:
            return self.sizes.shaft_diameter
        if self.kind(point) == "shoulder":
            return self.sizes.shoulder.diameter
        return self.sizes.pin_diameter

    def kind(self, point: str) -> str:
        """The kind of pin of a point: "keyed" of what joins webs, "disc" of one round a shaft.

        Of a shaft "bearing" or "printed"; no bearing in a slot, or under what rides on it.
        """
        if point in self.discs:
            return "disc"
        if point in self.shafts:
            return "bearing" if self.clutch(point) else self.sizes.pins.get(point, "printed")
        if self.webs_at(point):
            return "keyed"
        kind = self.sizes.pins.get(point, self.sizes.pin)
        if kind == "bearing" and (point in self.slots or point in self.riders):
            return "printed"
        return kind

    def bearing(self, point: str) -> Bearing | None:
        """The ball bearing on the pin of a point, or the clutch of a shaft."""
        if self.kind(point) == "bush":  # drawn with the play of what slides
            bush = bush_in(self.turning(point), self.sizes.base_thickness)
            return bush and replace(bush, bore=bush.bore + self.fits.running_clearance)
        if self.kind(point) != "bearing":
            return None
        named = None if point in self.shafts else BEARINGS.get(self.sizes.bearing or "")
        return self.clutch(point) or named or narrowest(self.turning(point))

    @property
    def dowels(self) -> str:
        """Standard of the dowels: hard ones in metal, which a roller does not wear."""
        return HARD_DOWEL_STANDARD if self.metal else DOWEL_STANDARD

    @property
    def on_shaft(self) -> Joint:
        """How what a shaft turns is fixed on it."""
        return joint_of(ROD, self.metal and self.sizes.shaft_key)

    def rod_fit(self, link: str) -> str:
        """Fit of the rod of which the shaft of a link is cut."""
        return IN_BUSH if self.metal and self.kind(self.axis_of(link)) == "bush" else ROD

    @property
    def recess(self) -> float:
        """By how much shafts and pins end within what they go through, mm, so that in metal none stands out of that."""
        return _RECESS if self.metal else 0.0

    def pin_joint(self, point: str) -> Joint:
        """How the pin of a point is fixed in its link."""
        borne = self.metal and self.bearing(point) is not None
        return joint_of(JOURNAL if borne else PIN)

    def pin_held(self, point: str) -> str:
        """The same in notes: of plastic the step says whether a vice presses it in or it goes in by hand, and glue holds it either way."""
        return self.pin_joint(point) if self.metal else "glued"

    def bearing_in(self, point: str, link: str) -> Bearing | None:
        """The ball bearing in a link's hole at a point."""
        return None if link == self.pressed_in(point) else self.bearing(point)

    def spacer_diameter(self, point: str) -> float:
        """Of what keeps links apart on a pin or shaft, mm: it lies beside the seat of a bearing."""
        bearing = None if point in self.shafts else self.bearing(point)
        return (self.turning(point) if bearing is None else bearing.outside) + 2 * self.sizes.head

    def head_radius(self, point: str) -> float:
        """Greatest radius of what is on a pin or shaft to hold links or keep them apart, mm."""
        found = self.spacer_diameter(point) / 2
        if point in self.discs:
            return max(found, self.hub(point, self.pressed_in(point)))
        screw = self.sizes.shoulder if self.kind(point) == "shoulder" else None
        held = self.collar(point)
        found = found if held is None else max(found, held.least_radius)
        return found if screw is None else max(found, screw.head / 2, screw.flats / math.sqrt(3))

    def collar(self, point: str) -> SetScrewHub | None:
        """What a set screw holds on the shaft of a motor at a point, over all that sits there.

        None where it is no motor's, or nothing asks for it.
        """
        if self.sizes.face is None or self.shafts.get(point) not in self.drivers:
            return None
        return self.sizes.collar(self.fits.press_clearance, self.min_wall)

    @cached_property
    def hung_points(self) -> set[str]:
        """Points whose pin has its head below: under a roller that hangs from its follower, or under the plate."""
        return {roller.point for roller in self.rollers if roller.hung} | self.under_plate

    @cached_property
    def under_plate(self) -> set[str]:
        """Points whose pin has its head under the plate."""
        if self.sizes.face is not None:
            return set()
        grounded = {
            point
            for point, links in self.pivots.items()
            if links[0] == GROUND and point not in self.shafts
        }
        grounded = {point for point in grounded - self.hook_points if point not in self.slots}
        return {point for point in grounded if self.kind(point) in _PLAIN} if self.sunk else set()

    def below(self, spring: StretchedSpring) -> int:
        """How many levels a spring takes under its own."""
        play = self.fits.slide_clearance
        needed = self._under_eye(spring) + (spring.diameter + spring.wire) / 2 + play
        return max(0, math.ceil(needed / (self.least_thickness + play) - 1e-9) - 1)

    def _under_eye(self, spring: StretchedSpring) -> float:
        """How far the eyes of a spring lie over the floor of its lowest level, mm: in the middle of its coils.

        These lie as low as they can without rubbing on what is beneath; of sheet on whole spacers.
        """
        air = self.fits.slide_clearance
        middle = (spring.diameter - spring.wire) / 2 + air
        step = self.sizes.thickness + air
        return step * math.ceil(middle / step - 1e-9) if self.sizes.of_sheet else middle

    def eye(self, name: str) -> tuple[float, float]:
        """Underside and upper side of the eyes of a spring, mm."""
        spring = self.springs[name]
        low = round(self.floor(self.level[name] - self.below(spring)) + self._under_eye(spring), 9)
        return low, round(low + spring.wire, 9)

    def between_plates(self, point: str) -> bool:
        """Whether a second plate can hold the far end of what stands on the ground at a point."""
        if self.sizes.plates < 2 or not (self.pivots[point][0] == GROUND or point in self.channels):
            return False
        if point in self.shafts:
            return self.shafts[point] in self.webs or not self.on_motor(point, GROUND)
        return self.kind(point) in _PLAIN

    def split_level(self, point: str) -> int | None:
        """The highest level of the lower stub of a point that is two, one on each plate; None of what goes through."""
        return None if self.second is None else self.second.cuts.get(point)

    def in_second(self, point: str) -> bool:
        """Whether the second plate holds what stands on the ground at a point, or a stub of it."""
        at = self.split_level(point)
        return (
            self.second is not None
            and self.between_plates(point)
            and (at is None or at < self.on(point)[-1][0])
        )

    def profile(self, point: str, link: str) -> Contour | None:
        """A link's hole at a point where it has a flat: that of what turns it, or of a web's crank pin; None of a round one."""
        s = self.sizes
        fit = self.fits.press_clearance
        if self.shafts.get(point) == link or (link in self.webs and point in self.shafts):
            return s.shaft_bore(fit)
        if link in self.webs_at(point) and point not in self.shafts:
            return d_bore(s.pin_diameter + fit, self.key_depth)
        return None

    @property
    def key_depth(self) -> float:
        """Of the flats of crank pins, mm: the shaft's, by their diameters."""
        return self.sizes.shaft_flat * self.sizes.pin_diameter / self.sizes.shaft_diameter

    @property
    def least_thickness(self) -> float:
        """Thickness of the thinnest link, mm."""
        return min([self.sizes.thickness, *map(self.thickness, self.moving)])

    def pressed_in(self, point: str) -> str:
        """The link in which the pin or the shaft of a point is fixed."""
        if point in self.shafts:
            return self.shafts[point]
        if point in self.discs:
            return self.discs[point][0]
        links = self.pivots[
            point
        ]  # never the last where that has a slot, for it lies over the others
        if point in self.channels:
            next_to_plate = max if self.in_second(point) else min
            return next_to_plate(links[:-1], key=lambda link: self.level[link])
        if point in self.under_plate:
            return max(links, key=lambda link: self.level[link])
        return links[0] if links[0] == GROUND else min(links, key=lambda link: self.level[link])

    def _fixing(self, point: str) -> tuple[str, ...]:
        """Where a pin or shaft is fixed on whichever level its links lie; nothing where that depends on it."""
        if point in self.shafts or point in self.discs:
            return (self.pressed_in(point),)
        return (GROUND,) if self.pivots[point][0] == GROUND else ()

    def hole(self, point: str, link: str) -> float:
        """Diameter of a link's hole at a point, mm."""
        if point in self.pens:
            return self.sizes.pen_diameter
        if point in self.thread_posts:
            return self.sizes.thread_post_sizes.diameter_at(point) + self.fits.press_clearance
        if self.on_motor(point, link):
            return self.sizes.face.boss + self.fit(point, link)  # type: ignore[union-attr]
        bearing = self.bearing_in(point, link)
        if bearing is not None:
            return bearing.outside + self.fits.press_clearance
        return self.turning(point) + self.fit(point, link)

    def fit(self, point: str, link: str) -> float:
        """Diametral fit of a link's hole at a point, mm."""
        if link == self.slotted_link(point):
            return self.fits.slide_clearance
        if point in self.discs and link == self.pressed_in(point):
            return 0.0  # it is a part of its link
        fixed = (
            link in self.webs_at(point)
            or self.on_motor(point, link)
            or self.kind(point) == "bearing"
            or link == self.pressed_in(point)
        )
        return self.fits.press_clearance if fixed else self.fits.running_clearance

    def hub(self, point: str, link: str) -> float:
        """Radius of a link's hub, mm, whichever fit its hole gets."""
        if point in self.pens or point in self.thread_posts or self.on_motor(point, link):
            hole = self.hole(point, link)
            sole = self.sizes.shape(link).sole_diameter
            if sole is not None and point in self.pens:
                return sole / 2
        else:
            bearing = None if link in self._fixing(point) else self.bearing(point)
            turning = self.turning(point) if bearing is None else bearing.outside
            hole = turning + max(self.fits.press_clearance, self.fits.slide_clearance)
        room = self.sizes.key_room if self.shafts.get(point) == link else 0.0
        return (self.sizes.shape(link).hub_diameter or hole + 2 * (self.rim + room)) / 2

    def points_of(self, link: str) -> dict[str, complex]:
        """The points of a link that have a round hole, in its axes."""
        points = self.bodies[link].points.items()
        return {
            name: complex(z)
            for name, z in points
            if name in self.pivots or link in (self.pens.get(name), self.thread_posts.get(name))
        }

    def slots_of(self, link: str) -> dict[str, tuple[complex, complex]]:
        """Both ends of a pin's way in each slot of a link, room included, in the link's axes."""
        slots = {}
        for point, joint in self.slots.items():
            if joint.guide.body == link:
                way = cmath.exp(1j * joint.angle)
                low, high = self.strokes[joint.name]
                slots[point] = (
                    joint.guide.at + (low - _ROOM) * way,
                    joint.guide.at + (high + _ROOM) * way,
                )
        return slots

    def slot_width(self, point: str) -> float:
        """Of the slot in which a point's pin runs, mm."""
        return self.turning(point) + self.fits.slide_clearance

    def round_hubs(self, link: str) -> list[tuple[complex, float]]:
        """Hubs of a link, those at the ends of its slots too: place in its axes and radius."""
        hubs = [(z, self.hub(point, link)) for point, z in self.points_of(link).items()]
        hubs += [
            (z, self.hub(point, link)) for point, ends in self.slots_of(link).items() for z in ends
        ]
        for tip in self.noses(link):
            if tip.shape == "knife" or tip.joint.slide is not None:
                nose = tip.nose(float(self.machine.start_of(link).angle), self.nose_radius)
                hubs += [(self.at(link, tip.point) + z, radius) for z, radius in nose]
        return hubs

    def noses(self, link: str) -> list[Tip]:
        """Knives and faces of a link."""
        return [tip for tip in self.tips if not tip.rolls and tip.joint.follower == link]

    @property
    def nose_radius(self) -> float:
        """Radius of the discs of knives and faces, mm."""
        return self.sizes.pin_diameter / 2 + self.sizes.wall

    # ---- cycloidal drives --------------------------------------------------------------------------------------------

    @cached_property
    def cycloid_drives(self) -> list[CycloidDrive]:
        """Cycloidal drives, with the output pins for which there is room; DesignError where there is none."""
        above = {wish.opposite.link: wish.link for wish in self.cycloids if wish.opposite}
        return [
            CycloidDrive(wish, self.machine, self._output_pins(wish.first), above.get(wish.link))
            for wish in self.cycloids
        ]

    def _output_pins(self, wish: CycloidWish) -> OutputPins | None:
        if wish.output is None:
            return None
        wall = self.rim
        clear = self.head_radius(wish.at) + self.fits.slide_clearance
        inner = max(self.hole(wish.at, wish.link) / 2 + wall, clear)
        with naming(f"cycloid {wish.joint}"):
            return wish.pins.pins(wish.disc, inner, wall, wish.air)

    @cached_property
    def guides(self) -> dict[str, Guide]:
        """What slides in what, by the link that slides."""
        play = self.fits.slide_clearance
        head = self.sizes.pin_diameter / 2 + self.sizes.head + play
        width = self.sizes.rail_width
        return {
            link: guide(
                joint,
                Runner(
                    self.round_hubs(link), bool(self.slots_of(link)), head, self.plate_edge(link)
                ),
                Way(self.strokes[joint.name], self._clear(link)),
                Rails(width, play, self.sizes.shape(link).rails, self.cover),
                self.stems.get(link, "along"),
            )
            for link, joint in self.slides.items()
        }

    def plate_edge(self, link: str) -> Contour | None:
        """The outline of a link that is a cam, without the bars on which it slides; None of any other."""
        head = self.sizes.pin_diameter / 2 + self.sizes.head + self.fits.slide_clearance
        deep = 2 * (head + self.sizes.wall)
        tips = [each for each in self.plates if each.joint.cam == link]
        return plate_outline(tips, self.round_hubs(link), head, deep) if tips else None

    @cached_property
    def cover(self) -> Cover | None:
        """What lies on rails to hold down what slides; None where nothing slides, or none is wanted."""
        return cover(self.sizes, self.fits, self.min_wall) if self.slides else None

    def _clear(self, link: str) -> tuple[float, float]:
        """Between which places on the line of its slide no rails of a link may stand, for cams on their way up, mm."""
        low = math.inf
        high = -math.inf
        for tip in self.tips:
            if tip.joint.follower == link and (tip.grooved or tip.hung or not tip.rolls):
                joint = self.slides[link]
                away = self.at(GROUND, self.shaft_of(tip.joint.cam)) - joint.guide.at
                middle = (away / cmath.exp(1j * joint.angle)).real
                low = min(low, middle - tip.wheel.radius)
                high = max(high, middle + tip.wheel.radius)
        return low, high

    # ---- levels -----------------------------------------------------------------------------------------------------

    @cached_property
    def level(self) -> dict[str, int]:
        """Level of each link, 0 the ground's plate, and of what touches on shafts."""
        if all(name in self.given for name in self.lying):
            return {
                GROUND: 0,
                **self.given,
                **{link: self.given[level] for link, level in self.alone.items()},
            }
        raise ValueError("levels are found before bodies are made")

    @property
    def lying(self) -> list[str]:
        """What lies on a level: links, what touches on shafts, springs."""
        links = [link for link in self.moving if link not in self.alone]
        found = list(dict.fromkeys([*links, *(wheel.level for wheel in self.wheels)]))
        twice = self.springs.keys() & set(found)
        if twice:
            raise ValueError(f"a spring has the name of a link or wheel: {', '.join(twice)}")
        return [*found, *self.springs]

    def on(self, point: str) -> list[tuple[int, float, float]]:
        """What sits on a pin or shaft, from below: level, underside and top, mm; links, rollers, wheels, a groove's back plate,
        eyes of springs."""
        # an eccentric over another one is no part of its link's body
        beneath = self.discs[point][0] if point in self.eccentrics else ""
        links = [
            (link, self.thickness(link))
            for link in self.pivots[point]
            if link not in self.alone and link != beneath
        ]
        discs = self.discs_on(point)
        for carrier in {self.discs[disc][0] for disc in discs}:  # as thick as what turns on them
            top = max(self.disc_top(disc) for disc in discs if self.discs[disc][0] == carrier)
            thick = round(top - self.floor(self.level[carrier]), 9)
            links = [(link, thick if link == carrier else high) for link, high in links]
        wheels = [wheel for wheel in self.wheels if self.shaft_of(wheel.link) == point]
        # a roller is as thick as its wheel
        wheels += [roller.wheel for roller in self.rollers if roller.point == point]
        links += [(wheel.level, wheel.high or self.wheel_thickness(wheel.link)) for wheel in wheels]
        suns = (each for each in self.standing_suns if self.axis_of_wheel(each) == point)
        links += [(sun.level, self.sizes.thickness) for sun in suns]
        floors = [(name, self.floor(self.level[name]), thick) for name, thick in links]
        stands = {
            each.wheel.level: self.top_of(each.wheel.link)
            for each in self.pinned
            if self.shaft_of(each.wheel.link) == point
        }
        stands |= {
            roller.level: self.roller_span(roller)[0]
            for roller in self.rollers
            if roller.point == point and roller.down
        }
        levels = {
            (self.level[name], stands.get(name, low), low + thick) for name, low, thick in floors
        }
        grooves = [
            tip.level for tip in self.tips if tip.grooved and self.shaft_of(tip.joint.cam) == point
        ]
        levels |= {
            (level, self.floor(level), self.top(level))
            for name in grooves
            for level in self._beneath(name)
        }
        levels |= {
            (self.level[name], *self.eye(name))
            for name in self.riders.get(point, ())
            if name in self.springs
        }
        levels |= {
            (self.on(disc)[-1][0] + 1, self.disc_top(disc), self.disc_top(disc) + self.sizes.head)
            for disc in discs
            if not self.on_ground(disc) and disc not in self.eccentrics.values()
        }
        if self.capped(point):
            level, _, top = max(levels)
            low = round(top + self.fits.slide_clearance, 9)
            levels |= {(level + 1, low, low + self.sizes.head)}
        return sorted(levels)

    def capped(self, point: str) -> bool:
        """Whether a cap on the shaft of a point holds what turns on it over all that is fixed there."""
        return point in self.over_shafts and self.collar(point) is None

    def disc_top(self, point: str) -> float:
        """Height of the upper side of a disc, mm: its keeper lies there, a play over what turns on it; over one of the ground
        the link of the shaft."""
        play = 0.0 if self.on_ground(point) else self.fits.slide_clearance
        return round(self.on(point)[-1][2] + play, 9)

    def _beneath(self, name: str) -> list[int]:
        """Levels that a groove's back plate or a spring takes under its own."""
        below = self.below(self.springs[name]) if name in self.springs else 1
        return [self.level[name] - 1 - k for k in range(below)]

    @property
    def screwed(self) -> bool:
        """Whether screws from behind hold the ground's plate: not one that hangs under another, or walks."""
        return not self.hangs and self.sizes.sides == 1

    def thickness(self, link: str) -> float:
        """Of a link, or of the wheel that it is alone, mm; of the ground's plate."""
        if link == GROUND:
            return self.sizes.base_thickness
        return self.sizes.shape(link).thickness or self.sizes.thickness

    def top_of(self, link: str) -> float:
        """Height of the upper side of a link, mm."""
        return round(self.floor(self.level[link]) + self.thickness(link), 9)

    def roller_span(self, roller: Roller) -> tuple[float, float]:
        """Heights of a roller's sides, mm: those of the wheel that it touches, or down to a play over its link."""
        floor = self.floor(self.level[roller.level])
        over_link = round(self.top_of(roller.link) + self.fits.slide_clearance, 9)
        low = min(floor, over_link) if roller.down else floor
        return low, floor + self.wheel_thickness(roller.wheel.link)

    def wheel_thickness(self, link: str) -> float:
        """Of the wheels on a link's shaft and of the rollers on them, mm."""
        return self.thickness(link) if link in self.alone else self.sizes.thickness

    @cached_property
    def _heights(self) -> list[float]:
        """Of the levels, the plate first, mm: of the thickest on each, and enough for a pin's head."""
        links = [link for link in self.moving if link not in self.alone]
        thick = [(self.level[link], self.thickness(link)) for link in links]
        thick += [
            (self.level[each.level], each.high or self.wheel_thickness(each.link))
            for each in self.wheels
        ]
        for drive in self.drives_of(GenevaDrive):
            more = (drive.wish.gap or 0.0) - self.fits.slide_clearance
            crank = drive.joint.cam
            thick.append((self.level[crank], self.thickness(crank) + max(0.0, more)))
        names = [*(tip.level for tip in self.tips if tip.grooved), *self.springs]
        levels = [
            *(self.level[name] for name in self.springs),
            *(level for name in names for level in self._beneath(name)),
        ]
        covered = {self.level[link] for link, each in self.guides.items() if each.covered}
        above = self.cover.levels if self.cover else 0
        levels += [level + k for level in covered for k in range(above + 1)]
        usual = self.sizes.thickness
        thick += [(level, usual) for level in levels]
        heights = [self.sizes.base_thickness]
        for level in range(1, max(self.level.values()) + 1):
            highest = max((high for at, high in thick if at == level), default=usual)
            heights.append(max(highest, self.sizes.head))
        return heights

    def floor(self, level: int) -> float:
        """Height of a level's floor over the plate's underside, mm."""
        # rounded, so that like pins are one part
        return round(sum(self._heights[:level]) + level * self.fits.slide_clearance, 9)

    def top(self, level: int) -> float:
        """Height of the upper side of the thickest on a level, mm."""
        return self.floor(level) + self._heights[level]
