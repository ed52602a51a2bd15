"""A linkage as parts: links round their hubs, a ground plate, pins, spacers and the shaft that drives.

    link     a band round its hubs, a plate where it has three and more; it lies on its level
    slot     straight, as long as its pin's way; its link lies over the one with the pin
    slide    the link a straight bar between two rails of the plate; it is held down by the links on its pins
    plate    the ground, under level 1: hubs round its pivots, holes for two screws from behind
    pin      pressed into its lowest link or the plate, its head over the highest; the others turn on it
    spacer   round a pin, where levels between its links are empty
    shaft    at the driven link's pivot: its flat turns that link, the highest there; it turns in the plate, held by a collar
    pen      a hole at a point that is an output and no pin

A level is one thickness and one play high, so that flat faces run on each other.
"""

from __future__ import annotations

import cmath
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from camgen.errors import DesignError
from camgen.geometry.outlines import Contour, Region, circle
from camgen.machine import model as m
from camgen.machine.features import Eye, Faces, Feature, Mark, Mount, PinEyes, SlideFaces, SlotFaces
from camgen.machine.run import Run
from camgen.machines.linkage.tables import Parts
from camgen.parts.hardware import plate, spacer
from camgen.parts.inertia import centre_of, inertia_of
from camgen.parts.levels import Axis, Band, Wall, hull_corners, levels
from camgen.parts.part import Layer, Part, d_bore, hull
from camgen.spec import Print
from camgen.tolerances import SAME_POINT

GROUND = m.GROUND
_MM = 1e-3
_ROOM = 0.5  # mm, beyond a pin's way at both ends of its slot
_ABOUT = {"pin": "Pin {}", "spacer": "Spacer {}"}


@dataclass(frozen=True)
class Bodies:
    """What is made of a machine of pins.

    machine: closed as drawn; driven: link on the shaft; given: levels that are asked for; min_wall: mm;
    strokes: least and greatest place along each slot and slide, mm.
    """

    machine: m.Machine
    driven: str
    sizes: Parts
    fits: Print
    min_wall: float
    given: Mapping[str, int]
    strokes: Mapping[str, tuple[float, float]]

    # ---- what is where ----------------------------------------------------------------------------------------------

    def lacking(self) -> DesignError | None:
        """What to say of joints of which no bodies are made yet."""
        others = [joint for joint in self.machine.joints if not isinstance(joint, m.Pin | m.Slot)]
        others = [joint for joint in others if not (isinstance(joint, m.Slide) and joint.guide.body == GROUND)]
        if others:
            kind = type(others[0]).__name__.lower()
            return DesignError(
                "joints without bodies", len(others), 0, "", f"{kind} {others[0].name}",
                "bodies are made of pins, pins in slots and slides on the ground so far: make this joint of such",
            )  # fmt: skip
        try:
            for link in self.slides:
                self._runner(link)
        except DesignError as error:
            return error
        return None

    @cached_property
    def slides(self) -> dict[str, m.Slide]:
        """The slide of each link that slides on the ground."""
        return {joint.runner.body: joint for joint in self.machine.joints if isinstance(joint, m.Slide)}

    @cached_property
    def slots(self) -> dict[str, m.Slot]:
        """The slot that a point's pin runs in, by the point's name."""
        found: dict[str, m.Slot] = {}
        for joint in (joint for joint in self.machine.joints if isinstance(joint, m.Slot)):
            points = self.machine.body(joint.runner.body).points
            found[next(name for name, z in points.items() if z == joint.runner.at)] = joint
        if len(found) < sum(isinstance(joint, m.Slot) for joint in self.machine.joints):
            raise DesignError("slots of one pin", 2, 1, "", "[[slot]]", "give each slot a pin of its own")
        return found

    @cached_property
    def pivots(self) -> dict[str, tuple[str, ...]]:
        """Links at each point with a pin, the ground first and one with a slot last, by the point's name."""
        bodies, slots = self.machine.bodies, self.slots
        carriers = {name: [b.name for b in bodies if name in b.points] for body in bodies for name in body.points}
        return {
            name: (*sorted(links, key=lambda link: link != GROUND), *([slots[name].guide.body] if name in slots else ()))
            for name, links in carriers.items() if len(links) > 1 or name in slots
        }  # fmt: skip

    @cached_property
    def pens(self) -> dict[str, str]:
        """The link of each point that is an output and no pin."""
        found = {}
        for output in self.machine.outputs:
            if isinstance(output.of, m.Path) and self.sizes.pen_diameter and output.of.of.body != GROUND:
                body = self.machine.body(output.of.of.body)
                name = next(name for name, z in body.points.items() if z == output.of.of.at)
                if name not in self.pivots:
                    found[name] = body.name
        return found

    @cached_property
    def shaft(self) -> str:
        """The point at which the driven link is pinned to the ground."""
        return next(name for name, links in self.pivots.items() if links[0] == GROUND and self.driven in links)

    def _turning(self, point: str) -> float:
        """Diameter of what turns at a point, mm."""
        return self.sizes.shaft_diameter if point == self.shaft else self.sizes.pin_diameter

    def _pressed_in(self, point: str) -> str:
        """The link in which the pin or the shaft of a point is fixed."""
        if point == self.shaft:
            return self.driven
        links = self.pivots[point]  # never the last where that has a slot, for it lies over the others
        return links[0] if links[0] == GROUND else min(links, key=lambda link: self.level[link])

    def hole(self, point: str, link: str) -> float:
        """Diameter of a link's hole at a point, mm."""
        if point in self.pens:
            return self.sizes.pen_diameter
        return self._turning(point) + self._fit(point, link)

    def _fit(self, point: str, link: str) -> float:
        return self.fits.press_clearance if link == self._pressed_in(point) else self.fits.slide_clearance

    def _hub(self, point: str, link: str) -> float:
        """Radius of a link's hub, mm, whichever fit its hole gets."""
        wide = max(self.fits.press_clearance, self.fits.slide_clearance)
        hole = self.sizes.pen_diameter if point in self.pens else self._turning(point) + wide
        return (self.sizes.shape(link).hub_diameter or hole + 2 * self.sizes.wall) / 2

    def points_of(self, link: str) -> dict[str, complex]:
        """The points of a link that have a round hole, in its frame."""
        points = self.machine.body(link).points.items()
        return {name: complex(z) for name, z in points if name in self.pivots or self.pens.get(name) == link}

    def _slots_of(self, link: str) -> dict[str, tuple[complex, complex]]:
        """Both ends of a pin's way in each slot of a link, room included, in the link's frame."""
        found = {}
        for point, joint in self.slots.items():
            if joint.guide.body == link:
                way, (low, high) = cmath.exp(1j * joint.angle), self.strokes[joint.name]
                found[point] = (joint.guide.at + (low - _ROOM) * way, joint.guide.at + (high + _ROOM) * way)
        return found

    def _hubs(self, link: str) -> list[tuple[complex, float]]:
        """Hubs of a link, those at the ends of its slots too: place in its frame and radius; of a runner both its ends."""
        if link in self.slides:
            return self._runner(link)
        return self._round(link)

    def _runner(self, link: str) -> list[tuple[complex, float]]:
        """Both ends of the straight bar that slides, and its half width; DesignError where its holes lie beside its line."""
        joint, slots = self.slides[link], [slot.name for slot in self.slots.values() if slot.guide.body == link]
        along = cmath.exp(1j * (joint.angle - joint.turn))
        places = [(z - joint.runner.at) / along for z in self.points_of(link).values()] or [0j]
        aside = max(abs(place.imag) for place in places)
        if aside > SAME_POINT or slots:
            raise DesignError(
                "slots of a link that slides" if slots else "distance from the line of its slide", len(slots) or aside, 0,
                "" if slots else "mm", f"link {link}",
                "bodies are made of sliding links whose pins lie on one line along the slide, without slots, so far",
            )  # fmt: skip
        hubs = self._round(link)
        head = self.sizes.pin_diameter / 2 + self.sizes.head + self.fits.slide_clearance
        half = max([head, *(radius for _, radius in hubs)])
        ends = min(place.real for place in places) - half, max(place.real for place in places) + half
        return [(joint.runner.at + end * along, half) for end in ends]

    def _rails(self, link: str) -> list[tuple[complex, complex]]:
        """Both ends of the middle line of each rail of a link, on the ground."""
        joint, ((a, half), (b, _)) = self.slides[link], self._runner(link)
        along, own = cmath.exp(1j * joint.angle), cmath.exp(1j * (joint.angle - joint.turn))
        low, high = self.strokes[joint.name]
        ends = [low + ((a - joint.runner.at) / own).real, high + ((b - joint.runner.at) / own).real]
        off = half + (self.fits.slide_clearance + self.sizes.rail_width) / 2
        one, other = (joint.guide.at + end * along for end in ends)
        return [(one + side * 1j * off * along, other + side * 1j * off * along) for side in (-1, 1)]

    def _round(self, link: str) -> list[tuple[complex, float]]:
        hubs = [(z, self._hub(point, link)) for point, z in self.points_of(link).items()]
        return hubs + [(z, self._hub(point, link)) for point, ends in self._slots_of(link).items() for z in ends]

    # ---- levels -----------------------------------------------------------------------------------------------------

    @cached_property
    def level(self) -> dict[str, int]:
        """Level of each link, 0 the ground's plate."""
        if all(body.name in self.given for body in self.machine.moving):
            return {GROUND: 0, **self.given}
        raise ValueError("levels are found before bodies are made")

    def levels(self, run: Run) -> dict[str, int]:
        """Level of each link, those given kept; run: samples over the whole motion."""
        bands, axes = [], []
        for body in self.machine.moving:
            hubs = self._hubs(body.name)
            corners = hull_corners([z for z, _ in hubs])
            at = np.array([run.point(body.name, hubs[k][0])[0] for k in corners])
            bands.append(Band(body.name, at, max(radius for _, radius in hubs)))
        for point, links in self.pivots.items():
            moving = tuple(link for link in links if link != GROUND)
            driven = point == self.shaft
            upper = self.driven if driven else moving[-1]
            over = [(upper, link) for link in moving if link != upper] if driven or point in self.slots else []
            place = run.point(links[0], point)[0]
            radius = self._turning(point) / 2 + self.sizes.head
            axes.append(Axis(point, moving, place, radius, links[0] == GROUND, not driven, tuple(over)))
        walls = [
            Wall(f"rail of {link}", np.array([np.full(run.theta.shape, z) for z in ends]), self.sizes.rail_width / 2, link)
            for link in self.slides for ends in self._rails(link)
        ]  # fmt: skip
        return levels(bands, axes, run.theta, self.fits.slide_clearance, self.given, walls)

    def floor(self, level: int) -> float:
        """Height of a level's floor over the plate's underside, mm."""
        step = self.sizes.thickness + self.fits.slide_clearance
        return 0.0 if level == 0 else self.sizes.base_thickness + self.fits.slide_clearance + (level - 1) * step

    def _top(self, level: int) -> float:
        return self.floor(level) + (self.sizes.thickness if level else self.sizes.base_thickness)

    # ---- parts ------------------------------------------------------------------------------------------------------

    @cached_property
    def _made(self) -> tuple[list[Part], list[Mount]]:
        parts = [self._plate(), *(self._link(body.name) for body in self.machine.moving)]
        mounts = [Mount(part_name(GROUND), GROUND)]
        mounts += [Mount(part_name(body.name), body.name, z=self.floor(self.level[body.name])) for body in self.machine.moving]
        bought: list[tuple[Part, Mount]] = []
        for point in self.pivots:
            bought += self._stack(point)
        names: dict[Part, str] = {}
        for part, mount in bought:  # what is alike is one part
            like = replace(part, name=part.name, title=part.title)
            if like not in names:
                count = sum(name.rpartition("-")[0] == part.name for name in names.values()) + 1
                names[like] = f"{part.name}-{count}" if part.name in _ABOUT else part.name
            mounts.append(replace(mount, part=names[like]))
        copies = Counter(mount.part for mount in mounts)
        for like, name in names.items():
            title = _ABOUT[like.name].format(name.rpartition("-")[2]) if like.name in _ABOUT else like.title
            parts.append(replace(like, name=name, title=title, count=copies[name]))
        return parts, mounts

    @property
    def parts(self) -> Sequence[Part]:
        """Plate, links, then what holds them together."""
        return self._made[0]

    @property
    def mounts(self) -> Sequence[Mount]:
        """Every copy of every part on its body."""
        return self._made[1]

    def _link(self, link: str) -> Part:
        points = self.points_of(link)
        holes: dict[str, Contour] = {}
        for point, z in points.items():
            holes[f"hole {point}"] = circle(z, self.hole(point, link) / 2)
            if point == self.shaft and link == self.driven:
                holes[f"hole {point}"] = self._profile(self.fits.press_clearance).moved(1, z)
        for point, (low, high) in self._slots_of(link).items():
            radius = (self._turning(point) + self.fits.slide_clearance) / 2
            holes[f"slot {point}"] = hull([(low, radius), (high, radius)])
        outer = hull(self._hubs(link))
        region = plate(f"link {link}", outer, holes, self.min_wall)
        bore = next((self.hole(point, link) for point, z in points.items() if z == 0), None)
        return Part(
            part_name(link), f"Link {link}", (Layer(region, 0.0, self.sizes.thickness),), centres=tuple(points.values()),
            notes=(f"level {self.level[link]}", *self._pressed(link)), bore=bore, min_wall=self.min_wall,
        )  # fmt: skip

    def _pressed(self, link: str) -> list[str]:
        fixed = [point for point in self.points_of(link) if point in self.pivots and self._pressed_in(point) == link]
        return [f"pressed in here: {', '.join(fixed)}"] if fixed else []

    def _plate(self) -> Part:
        points = {name: z for name, z in self.points_of(GROUND).items() if name in self.pivots}
        holes = {f"hole {point}": circle(z, self.hole(point, GROUND) / 2) for point, z in points.items()}
        hubs, rails, rail = [(z, self._hub(point, GROUND)) for point, z in points.items()], [], self.sizes.rail_width / 2
        for link in self.slides:
            for ends in self._rails(link):
                top = self._top(self.level[link])
                rails.append(Layer(Region(hull([(z, rail) for z in ends])), self.sizes.base_thickness, top))
                hubs += [(z, rail + self.sizes.wall) for z in ends]
        screw = self.sizes.mount_diameter / 2
        under = self._collar + self.sizes.mount_diameter  # a screw's head beside the collar
        beside = [*hubs, (points[self.shaft], under)]
        pairs = [(a, b) for a in beside for b in beside]
        a, b = max(pairs, key=lambda pair: abs(pair[1][0] - pair[0][0]) + pair[0][1] + pair[1][1])
        way = (b[0] - a[0]) / abs(b[0] - a[0]) if a[0] != b[0] else 1.0 + 0j
        screws = [a[0] - way * (a[1] + screw), b[0] + way * (b[1] + screw)]
        holes |= {f"screw {k}": circle(z, screw) for k, z in enumerate(screws, 1)}
        outer = hull([*hubs, *((z, screw + self.sizes.wall) for z in screws)])
        region = plate("ground plate", outer, holes, self.min_wall)
        return Part(
            part_name(GROUND), "Ground plate", (Layer(region, 0.0, self.sizes.base_thickness), *rails),
            centres=(*points.values(), *screws), min_wall=self.min_wall,
            notes=("the outermost holes are for screws from behind", *self._pressed(GROUND)),
        )  # fmt: skip

    @property
    def _collar(self) -> float:
        """Radius of the shaft's collar, mm."""
        return self.sizes.shaft_diameter / 2 + self.sizes.head + self.sizes.wall

    def _profile(self, fit: float) -> Contour:
        """Outline of the shaft, a circle with a flat, or of its hole."""
        return d_bore(self.sizes.shaft_diameter + fit, self.sizes.shaft_flat)

    def _stack(self, point: str) -> list[tuple[Part, Mount]]:
        """Pin or shaft of a point, and what is threaded on it."""
        s, play, body = self.sizes, self.fits.slide_clearance, self._pressed_in(point)
        held = sorted(self.level[link] for link in self.pivots[point])
        at, top, found = self._at(body, point), self._top(held[-1]), []
        if point == self.shaft:
            found.append((self._shaft(top), Mount("shaft", body, at, z=-s.shaft_length)))
            ring = Region(circle(0j, self._collar), (self._profile(self.fits.press_clearance),))
            collar = Part(
                "collar", "Collar of the shaft", (Layer(ring, 0.0, s.thickness),), centres=(0j,), min_wall=self.min_wall,
                notes=("pressed and glued on the shaft under the plate",),
            )  # fmt: skip
            found.append((collar, Mount("collar", body, at, z=-play - s.thickness)))
        else:
            bottom = self.floor(held[0])
            found.append((self._headed(top + play - bottom), Mount("pin", body, at, flipped=True, z=bottom)))
        for low, high in zip(held, held[1:], strict=False):
            height = self.floor(high) - self._top(low) - 2 * play
            if high - low > 1:
                wide = self._turning(point)
                ring_part = spacer("spacer", "Spacer", wide + play, wide + 2 * s.head, height, self.min_wall)
                found.append((ring_part, Mount("spacer", body, at, z=self._top(low) + play)))
        return found

    def _at(self, body: str, point: str) -> complex:
        return complex(self.machine.body(body).points[point])

    def _shaft(self, top: float) -> Part:
        length = self.sizes.shaft_length + top
        layer = Layer(Region(self._profile(0.0)), 0.0, length)
        return Part("shaft", "Shaft", (layer,), centres=(0j,), notes=(f"glued into link {self.driven} and the collar",))

    def _headed(self, length: float) -> Part:
        """A round pin so long below its head, printed head down."""
        s = self.sizes
        head = Layer(Region(circle(0j, s.pin_diameter / 2 + s.head)), 0.0, s.head)
        shank = Layer(Region(circle(0j, s.pin_diameter / 2)), s.head, s.head + length)
        return Part("pin", "Pin", (head, shank), centres=(0j,), notes=("pressed and glued in",), cut=1)

    # ---- joints -----------------------------------------------------------------------------------------------------

    def _point_of(self, joint: m.Joint) -> tuple[str, str, str]:
        """The point of a pin or slot, and its two links, a slot's last."""
        if isinstance(joint, m.Slot):
            return next(name for name, slot in self.slots.items() if slot == joint), joint.runner.body, joint.guide.body
        assert isinstance(joint, m.Pin)
        at = self.machine.body(joint.a.body).points
        point = next(n for n, z in at.items() if z == joint.a.at and joint.b.body in self.pivots.get(n, ()))
        return point, joint.a.body, joint.b.body

    def features(self) -> Sequence[Feature]:
        """Holes, slots and pins of every joint, and pens."""
        on = {(mount.body, mount.at): mount.part for mount in self.mounts if mount.part.startswith("pin-")}
        found: list[Feature] = []
        for joint in self.machine.joints:
            if isinstance(joint, m.Slide):
                found.append(self._faces(joint))
                continue
            point, a, b = self._point_of(joint)
            fixed = self._pressed_in(point)
            part = "shaft" if point == self.shaft else on[fixed, self._at(fixed, point)]
            pin, one = Eye(part, 0j, self._turning(point), True), Eye(part_name(a), self._at(a, point), self.hole(point, a))
            if isinstance(joint, m.Slot):
                middle = sum(self._slots_of(b)[point]) / 2
                walls = Faces(part_name(b), middle, joint.angle, self.hole(point, b))
                found.append(SlotFaces(joint.name, walls, one, pin))
            else:
                found.append(PinEyes(joint.name, one, Eye(part_name(b), self._at(b, point), self.hole(point, b)), pin))
        return [*found, *(Mark(Eye(part_name(link), self._at(link, point), self.sizes.pen_diameter))
                          for point, link in self.pens.items())]  # fmt: skip

    def _faces(self, joint: m.Slide) -> SlideFaces:
        """Rails, which the plate's own drawing does not show, and runner."""
        link = joint.runner.body
        (a, half), (b, _) = self._runner(link)
        (c, d), (e, f) = self._rails(link)
        rails = Faces(part_name(GROUND), (c + d + e + f) / 4, joint.angle, 2 * half + self.fits.slide_clearance, False)
        return SlideFaces(joint.name, rails, Faces(part_name(link), (a + b) / 2, joint.angle - joint.turn, 2 * half))

    def fitted(self) -> m.Machine:
        """The machine with the clearances of its fits, diametral, mm."""
        joints = []
        for joint in self.machine.joints:
            play = self.fits.slide_clearance
            if not isinstance(joint, m.Slide):
                point, a, b = self._point_of(joint)
                play = self._fit(point, a) + self._fit(point, b)
            joints.append(replace(joint, clearance=play))
        return replace(self.machine, joints=tuple(joints))

    def weighed(self, density: float, given: Collection[str]) -> m.Machine:
        """The fitted machine with the masses of its solids, but for links whose mass is given; density: kg/m^3."""
        machine, made = self.fitted(), {part.name: part for part in self.parts}
        bodies = []
        for body in machine.bodies:
            if body.name not in (GROUND, *given):
                rows = []
                for mount in (mount for mount in self.mounts if mount.body == body.name):
                    part = made[mount.part]
                    mass, centre = part.volume * density * _MM**3, centre_of(part)
                    own = inertia_of(part, density) - mass * abs(centre * _MM) ** 2
                    rows.append((mass, mount.place(centre), own))
                mass = sum(row[0] for row in rows)
                centre = sum(row[0] * row[1] for row in rows) / mass
                inertia = sum(own + each * abs((place - centre) * _MM) ** 2 for each, place, own in rows)
                body = replace(body, mass=mass, centre=centre, inertia=inertia)
            bodies.append(body)
        return replace(machine, bodies=tuple(bodies))


def part_name(link: str) -> str:
    """Name of a link's part: such that its files are not taken for those of the whole machine."""
    return f"link-{link}" if link.lower().startswith(("plate", "assembly", "parts")) else link
