"""The machine round the drum of a cylinder cam: two end plates on four rods, its shaft in ball bearings, carriage or arm, hand crank.

 ====o====  crank        The drum's axis is upright, as its files have it. Both plates are one part, the upper one turned over:
___________ plate        a bearing in a seat, four rods. The two rods on the roller's side guide the carriage of a slide, or hold
 |  |#|  |                the bracket on which an arm turns; both are bored along the rods and carry their pin square to them.
 |  |#|==|  carriage     Between plates and drum two spacers on the shaft take up what the follower needs of height. On an end cam
_|__|#|__|_ plate        a compression spring round each of these rods presses the carriage down, from the upper plate;
                         an arm is pulled down by an extension spring between the roller's pin and one in its bracket.
                         Heights are over the lower plate's underside, along the drum's axis; lengths mm.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np

from camgen.errors import DesignError
from camgen.geometry.outlines import Contour, Region, circle, rectangle
from camgen.machine.cams.followers import SwingingArm
from camgen.machine.cams.profile import DiscCam
from camgen.machine.features import Mount
from camgen.machine.model import GROUND, Place, Pose
from camgen.machines.cylinder_cam.pieces import ring_mount
from camgen.machines.cylinder_cam.tables import DrumParts
from camgen.machines.cylinder_cam.track import Track
from camgen.machines.return_spring import ReturnSpring
from camgen.numerics import Floats, Points
from camgen.parts.catalogue import BEARINGS, CORE_HOLES, DOWELS, Bearing, Bought, ball_roller
from camgen.parts.coils import Coil
from camgen.parts.generator.sizes import Parts as PinSizes
from camgen.parts.hardware import headed, spacer
from camgen.parts.part import Layer, Part, SizeNote, hull
from camgen.parts.springs import EYE, ExtensionSpring, WorkingSpring, compression_spring
from camgen.study import Sketch, Upright

CAM = "cam"
_FOLLOWER = "follower"
AIR = 1.0  # between bodies that pass each other
END_PLAY = 0.1  # between a spacer and its bearing
_LIP = 1.5  # of a plate under its bearing
PIN_SHARE = 0.4  # diameter of a roller's pin as a share of the roller's, at most
_CAP = 2.0  # room of the cap that keeps an arm on its pin
_KNOB = (12.0, 25.0)  # diameter and length
_STUB = 5.0  # diameter of its pin, in the crank
_HEAD = (9.0, 2.0)  # diameter and height of that pin's head
_HANGING = 30.0  # from pin to pin of an arm's spring, and as much more as its roller moves
_ROUND = 12  # points of a spring's wire for each coil
FOOT = 0.5  # of the shaft over the lower plate's underside
_OUT = 20.0  # of the shaft over the upper plate, where a motor turns it
_SCREW = "M3"  # of what is fixed to the carriage, and of what the machine stands on
_GRID = 5.0  # between the carriage's screws
_SAWN = 0.5  # step of the length of a rod that a person saws
_FILED = 0.1  # step of that of a pin, which ends beside the floor of the track


def roller_pin(radius: float, length: float) -> float:
    """Diameter of the pin on which a roller of this size turns, mm: a ball bearing's bore, else a dowel's; 0 where none is so thin."""
    ball = ball_roller(2 * radius, length)
    if ball is not None:
        return ball.bore
    return max((size for size in DOWELS if size <= 2 * PIN_SHARE * radius), default=0.0)


def _cut(stock: str, length: float, rest: str = "") -> SizeNote:
    """Of which steel a part is cut, and how long, mm."""
    return SizeNote(f"steel {stock} {length:.4g}{rest}", stock, length)


def _upright(name: str, at: complex, height: float) -> Mount:
    """Of what stands on the ground with its axis along x, at its place in plan and at a height, mm."""
    return Mount(name, GROUND, at, math.pi / 2, z=height, upright=True)


def _part(name: str, title: str, region: Region, height: float, *notes: str, **more: Any) -> Part:
    """A part of one region, so high, mm; more: what else is said of it."""
    return Part(name, title, (Layer(region, 0.0, height),), notes=notes, **more)


def shaft_bearing(bore: float) -> Bearing | None:
    """The largest ball bearing of a bore, mm, whose shoulder a printed spacer can have; None without one."""
    fitting = (each for each in BEARINGS.values() if each.bore == bore)
    return max(fitting, key=lambda each: each.outside, default=None)


@dataclass(frozen=True)
class Fits:
    """Diametral, mm."""

    press: float
    slide: float


@dataclass(frozen=True)
class Bench:
    """Sizes, parts and mounts of the machine round a drum."""

    track: Track
    sizes: DrumParts
    fits: Fits
    drum: Sequence[Part]  # and the ring on it, where it is in two pieces
    cranked: bool  # whether a hand turns it
    # of both springs, N where the carriage is lowest and N/mm; of an arm's, N m and N m/rad, 0 of which is found; None: nothing
    # presses it
    pressing: tuple[float, float] | None = None

    # ---- sizes ------------------------------------------------------------------------------------------------------

    @cached_property
    def bearing(self) -> Bearing:
        """Of the shaft."""
        found = shaft_bearing(self.sizes.bore)
        assert found is not None, "no ball bearing for the shaft"
        return found

    @property
    def pin(self) -> float:
        """Diameter of the roller's pin, and of an arm's."""
        roller = self.track.geometry.roller
        return roller_pin(roller.radius, roller.length)

    @property
    def plate_thickness(self) -> float:
        """Of both end plates."""
        return max(self.sizes.thickness, _LIP + self.bearing.width)

    @property
    def block_depth(self) -> float:
        """Of the carriage or the bracket, away from the drum's axis."""
        return self.sizes.rod_diameter + self.fits.slide + 2 * self.sizes.wall

    @property
    def arm_face(self) -> float:
        """Distance of an arm's inner face from the drum's axis."""
        return self.track.radius + AIR + _CAP

    @property
    def block_face(self) -> float:
        """Distance of the inner face of carriage or bracket from the drum's axis."""
        if not self.track.swings:
            return self.track.radius + AIR
        return self.arm_face + self.sizes.thickness + self.bracket_gap

    @cached_property
    def bracket_gap(self) -> float:
        """Between an arm and its bracket: room for the spring that pulls it."""
        return AIR / 2 if self.hung is None else self.hung[1].outside + AIR

    @property
    def hook(self) -> float:
        """How far the roller's pin stands out of an arm for its spring; 0 without one."""
        return 0.0 if self.hung is None else self.bracket_gap - AIR / 2

    @cached_property
    def bracket_pins(self) -> dict[complex, float]:
        """Diameters of pins in the bracket of an arm by their places, y + iz from the pivot's height: the pivot, and one of its spring."""
        pins = {complex(self.track.pivot): self.pin}
        if self.hung is not None:
            post = self.hung[0].post
            pins[complex(self.track.pivot - post.real, post.imag)] = self.pin
        return pins

    @property
    def rod_spacing(self) -> float:
        """Half the distance of two rods; the pin in the block on them passes beside its bores."""
        reach = self.sizes.rod_diameter / 2 + self.sizes.wall + self.pin / 2
        beside = abs(self.track.geometry.follower.offset)
        half = max(self.track.radius / 2, beside + reach)
        if self.track.swings:
            for aside in sorted(abs(at.real) for at in self.bracket_pins):
                if abs(aside - half) < reach:
                    half = aside + reach
        return half

    @property
    def rods(self) -> tuple[complex, ...]:
        """Places of the rods, x + iy of the drum; the first two are on the follower's side."""
        front = self.block_face + self.block_depth / 2
        back = -self.track.radius - AIR - self.sizes.rod_diameter / 2
        half = self.rod_spacing
        return tuple(complex(x, side * half) for x in (front, back) for side in (-1, 1))

    @property
    def pin_end(self) -> float:
        """Distance of the roller's pin's outer end from the drum's axis."""
        if self.track.swings:
            return self.arm_face + self.sizes.thickness + self.hook
        return self.block_face + self.block_depth

    @property
    def pin_below(self) -> float:
        """How far the roller's pin ends before the roller's inner end, at least, so that its length is in steps of a file."""
        room = self.pin_end - self.track.inner
        least = min(AIR, self.track.geometry.roller.length / 4)
        return room - math.floor((room - least) / _FILED + 1e-6) * _FILED

    @property
    def rollers(self) -> tuple[float, ...]:
        """Heights of the rollers over the follower's middle."""
        half = (self.track.geometry.distance or 0.0) / 2
        return (-half, half) if half else (0.0,)

    @property
    def block_height(self) -> float:
        """Along the rods: as long as a guide needs that two rods hold."""
        around = 2 * (self.rollers[-1] + self.pin / 2 + self.sizes.wall)
        return max(1.5 * self.rod_spacing, around, 2 * self.sizes.rod_diameter)

    @property
    def arm_hub(self) -> float:
        """Radius of an arm round its pins."""
        return self.pin / 2 + self.sizes.wall

    @cached_property
    def _span(self) -> tuple[float, float]:
        """Lowest and highest place of drum and follower over the drum's lower end."""
        track = self.track
        low, high = track.program.extremes
        half = self.block_height / 2
        ends = [0.0, track.length]
        if track.swings:
            arm = track.geometry.follower.arm or 0.0
            tips = [track.height + arm * math.sin(track.start + s) for s in (low, high)]
            ends += [tip + side * self.arm_hub for tip in tips for side in (-1, 1)]
            low_pin = min(at.imag for at in self.bracket_pins) - self.pin / 2 - self.sizes.wall
            ends += [track.height + min(-half, low_pin), track.height + half]
        else:
            ends += [track.height + low - half, track.height + high + half]
        room = self._wound.shortest - AIR if self._wound is not None else 0.0
        return min(ends) - AIR, max(*ends, track.height + high + half + room) + AIR

    @cached_property
    def _wound(self) -> WorkingSpring | None:
        """Either spring with the least room over the carriage where it is highest; DesignError where none can be."""
        if self.pressing is None or self.track.swings:
            return None
        force, rate = (each / 2 for each in self.pressing)
        low, high = self.track.program.extremes
        inside = EYE * self.sizes.rod_diameter
        found = compression_spring(rate, force, high - low, inside, self.block_depth)
        if found is None:
            raise DesignError(
                "compression springs of round wire",
                0,
                1,
                "",
                f"{force:.4g} N and {rate:.4g} N/mm each, {inside:.4g} to {self.block_depth:.4g} mm wide, over {high - low:.4g} mm",
                "another spring.preload or spring.rate, a smaller lift, or a larger parts.wall, which makes room for a wider one",
            )
        return found

    @cached_property
    def hung(self) -> tuple[ReturnSpring, ExtensionSpring] | None:
        """What pulls an arm down: where it hangs, in the arm's plane about its pivot, and the spring; DesignError where none can be."""
        if self.pressing is None or not self.track.swings:
            return None
        track = self.track
        low, high = track.program.extremes
        arm = cmath.rect(track.geometry.follower.arm or 0.0, track.start)
        middle = arm * cmath.exp(0.5j * (low + high))
        length = _HANGING + abs(arm) * (high - low)
        preload, rate = self.pressing
        cam = DiscCam(track.program, SwingingArm(0j, arm, track.geometry.roller.radius, 1))
        post = middle - 1j * middle / abs(middle) * length
        sizes = PinSizes(pin_diameter=self.pin)
        hung = ReturnSpring(cam, True, sizes, self.fits.slide, rate, preload, post)
        try:
            return hung, hung.spring(0.0)
        except DesignError as error:
            remedy = "another spring.preload or spring.rate, a smaller lift or a longer arm"
            raise error.mended(remedy) from None

    @property
    def spring(self) -> WorkingSpring | None:
        """Either of the springs as it stands on the carriage, or that of an arm; None where nothing presses it."""
        if self.hung is not None:
            return WorkingSpring(self.hung[1], *self.hung[0].way)
        wound = self._wound
        if wound is None:
            return None
        more = self.ceiling - self.carriage_top(self.track.program.extremes[1]) - wound.shortest
        longer = replace(wound.spring, free=wound.spring.free + more)
        return replace(
            wound,
            spring=longer,
            shortest=wound.shortest + more,
            longest=wound.longest + more,
            name="each spring",
            count=2,
        )

    @property
    def ceiling(self) -> float:
        """Height of the upper plate's underside."""
        return self.top - self.plate_thickness

    def carriage_top(self, s: float) -> float:
        """Height of the carriage's upper side at a displacement, mm."""
        return self.base + self.track.height + s + self.block_height / 2

    @property
    def base(self) -> float:
        """Height of the drum's lower end."""
        return self.plate_thickness - self._span[0]

    @property
    def top(self) -> float:
        """Height of the upper plate's upper side, and length of the rods, which are sawn: the carriage has up to a step more room."""
        least = self.base + self._span[1] + self.plate_thickness
        return math.ceil(least / _SAWN - 1e-6) * _SAWN

    @property
    def plane(self) -> complex:
        """Place of the origin of the follower's plane in that which stands, its x as the machine's -y and its y as z."""
        beside = (self.track.geometry.follower.arm or 0.0) - self.track.pivot
        if not self.track.swings:
            beside = -self.track.geometry.follower.offset
        return complex(beside, self.base + self.track.height)

    # ---- parts ------------------------------------------------------------------------------------------------------

    @cached_property
    def made(self) -> Sequence[tuple[Part, Sequence[Mount]]]:
        """Each part and where its copies stand."""
        return [
            *self._stand(),
            *self._turning(),
            *(self._arm() if self.track.swings else self._carriage()),
            *self._roller(),
        ]

    @property
    def parts(self) -> list[Part]:
        """All parts, with their counts."""
        return [replace(part, count=len(mounts)) for part, mounts in self.made]

    @property
    def mounts(self) -> list[Mount]:
        """Of all copies."""
        return [mount for _, mounts in self.made for mount in mounts]

    @property
    def touching(self) -> list[tuple[str, str]]:
        """Parts that touch as they move: the shaft is as wide as its bearings are, and the roller is rolled by itself."""
        pairs = [("shaft", "bearing"), *(("roller", part.name) for part in self.drum)]
        return [*pairs, ("arm", "pivot")] if self.track.swings else pairs

    def _hole(self, at: complex, diameter: float, fit: float) -> Contour:
        return circle(at, (diameter + fit) / 2)

    @cached_property
    def _plate_screws(self) -> tuple[complex, ...]:
        """Places of the core holes between both front rods and both back ones, by which the machine is screwed on from below."""
        rim = self.sizes.wall + CORE_HOLES[_SCREW] / 2
        ends = {complex(at.real) for at in self.rods}
        free = (
            self.rod_spacing >= self.sizes.rod_diameter / 2 + rim
            and min(map(abs, ends)) >= self.bearing.outside / 2 + rim
        )
        return tuple(sorted(ends, key=abs)) if free else ()

    @property
    def _carriage_pins(self) -> dict[complex, float]:
        """Places and diameters of the pins of its rollers in the carriage."""
        beside = self.track.geometry.follower.offset
        return {complex(-beside, z): self.pin for z in self.rollers}

    def screws(self) -> list[Bought]:
        """What fixes the machine on what it stands on, and what it moves on the carriage: the builder's own."""
        core = f"{_SCREW}, into core holes of {CORE_HOLES[_SCREW]:g}, at most"
        below = f"{core} {self.plate_thickness:.4g} into the plate"
        into = f"{core} {self.block_depth:.4g} into the carriage"
        held = 0 if self.track.swings else len(self._carriage_screws(self._carriage_pins))
        counts = (
            ("screw from below", below, len(self._plate_screws)),
            ("screw of the load", into, held),
        )
        return [Bought(name, "", size, count, "own") for name, size, count in counts if count]

    def _carriage_screws(self, pins: Mapping[complex, float]) -> tuple[complex, ...]:
        """Places of four core holes in the carriage, as far apart as the grid allows between its bores; none where no four fit."""
        rim = self.sizes.wall + CORE_HOLES[_SCREW] / 2
        wide = self.rod_spacing - (self.sizes.rod_diameter + self.fits.slide) / 2 - rim
        across, along = (
            math.floor(2 * room / _GRID) * _GRID / 2 for room in (wide, self.block_height / 2 - rim)
        )
        places = tuple(complex(x, y) for x in (-across, across) for y in (-along, along))
        apart = min(abs(at - pin) - size / 2 for at in places for pin, size in pins.items())
        return places if min(across, along) > 0 and apart >= rim else ()

    def _stand(self) -> Iterator[tuple[Part, Sequence[Mount]]]:
        """Plates, rods and bearings."""
        s = self.sizes
        ball = self.bearing
        hubs = [(at, s.rod_diameter / 2 + s.wall) for at in self.rods]
        hubs.append((0j, ball.outside / 2 + s.wall))
        edge = hull(hubs)
        rods = [self._hole(at, s.rod_diameter, self.fits.press) for at in self.rods]
        rods += [circle(at, CORE_HOLES[_SCREW] / 2) for at in self._plate_screws]
        floor = self.plate_thickness - ball.width
        layers = (
            Layer(Region(edge, (circle(0j, ball.lip / 2), *rods)), 0.0, floor),
            Layer(
                Region(edge, (self._hole(0j, ball.outside, self.fits.press), *rods)),
                floor,
                self.plate_thickness,
            ),
        )
        title = "End plate"
        notes = [f"the seat of bearing {ball.name} towards the drum"]
        if self._plate_screws:
            title += f", two holes for {_SCREW}"
            core = f"{CORE_HOLES[_SCREW]:g} for {_SCREW}"
            notes.append(f"two holes of {core} screws, from below: what it stands on")
        plate = Part(
            "end-plate",
            title,
            layers,
            centres=(0j, *self.rods),
            notes=tuple(notes),
            drawn_layer=1,
        )
        yield (
            plate,
            [
                Mount("end-plate", GROUND),
                Mount("end-plate", GROUND, 0j, math.pi, True, self.top - self.plate_thickness),
            ],
        )
        size = f"{ball.name}, {ball.size} {ball.standard}"
        ring = Region(circle(0j, ball.outside / 2), (circle(0j, ball.bore / 2),))
        title = "Ball bearing of the shaft"
        bearing = _part("bearing", title, ring, ball.width, size, process="bought")
        places = (floor, self.top - self.plate_thickness)
        yield bearing, [Mount("bearing", GROUND, z=z) for z in places]
        rod = Region(circle(0j, s.rod_diameter / 2))
        cut = _cut(f"rod {s.rod_diameter:g} h9", self.top)
        part = _part("rod", "Rod", rod, self.top, cut, "glued into both plates", process="bought")
        yield part, [Mount("rod", GROUND, at) for at in self.rods]

    def _turning(self) -> Iterator[tuple[Part, Sequence[Mount]]]:
        """Drum, shaft, spacers, crank, knob and its pin."""
        s = self.sizes
        drum, *rings = self.drum
        yield drum, [Mount(drum.name, CAM, z=self.base)]
        for ring in rings:
            yield ring, [ring_mount(ring, self.base + self.track.length)]
        low = FOOT
        over = AIR + s.thickness if self.cranked else _OUT
        length = self.top - low + over
        shape = "plain" if s.bore_shape == "keyway" else s.bore_shape
        own = s.model_copy(update={"bore_shape": shape})
        cut = _cut(f"rod {s.bore:g} h9", length, self._flat())
        held = "glued into the drum" if s.bore_shape == "plain" else "through the drum's bore"
        shaft = _part("shaft", "Shaft", Region(own.hole()), length, cut, held, process="bought")
        yield shaft, [Mount("shaft", CAM, z=low)]
        shoulder = circle(0j, self.bearing.shoulder / 2)
        bore = self._hole(0j, s.bore, self.fits.press)
        gaps = (
            ("spacer-below", self.plate_thickness + END_PLAY, self.base),
            (
                "spacer-above",
                self.base + self.track.length,
                self.top - self.plate_thickness - END_PLAY,
            ),
        )
        for name, under, upper in gaps:
            title = f"Spacer {name.removeprefix('spacer-')} the drum"
            washer = Region(shoulder, (bore,))
            part = _part(name, title, washer, upper - under, centres=(0j,))
            yield part, [Mount(name, CAM, z=under)]
        if self.cranked:
            yield from self._crank()

    def _flat(self) -> str:
        """What the list says of the shaft's flat or keyway."""
        s = self.sizes
        if s.bore_shape == "d-flat":
            return f" with a flat {s.flat_depth:g} deep all along"
        return f" with a key {s.key_width:g} wide" if s.bore_shape == "keyway" else ""

    def _crank(self) -> Iterator[tuple[Part, Sequence[Mount]]]:
        s = self.sizes
        arm = complex(s.crank)
        hubs = [(0j, s.reach + s.wall), (arm, _STUB / 2 + s.wall)]
        stub = self._hole(arm, _STUB, self.fits.press)
        region = Region(hull(hubs), (s.hole(), stub))
        note = "glued on the shaft, the pin of the knob into its other hole"
        crank = _part("crank", "Hand crank", region, s.thickness, note, centres=(0j, arm))
        under = self.top + AIR
        yield crank, [Mount("crank", CAM, z=under)]
        wide, tall = _KNOB
        play = self.fits.slide
        knob = spacer("knob", "Knob of the crank", _STUB + play, wide, tall, 0.0)
        yield knob, [Mount("knob", CAM, arm, z=under + s.thickness + play)]
        long = s.thickness + tall + 2 * play
        pin = headed("knob-pin", "Pin of the knob", _STUB, long, *_HEAD)
        yield replace(pin, notes=("glued in",)), [Mount("knob-pin", CAM, arm, 0.0, True, under)]

    def _block(
        self,
        name: str,
        title: str,
        pins: Mapping[complex, float],
        fit: float,
        screws: Sequence[complex] = (),
    ) -> Part:
        """A block on the two rods of the follower's side, its datum between them half way up.

        Its x runs along the turn, its y along the rods; pins: places and diameters of holes square to both, as those of screws are;
        fit: on the rods.
        """
        s = self.sizes
        half = self.rod_spacing
        rim = s.rod_diameter / 2 + s.wall
        left = min(-half - rim, *(at.real - size / 2 - s.wall for at, size in pins.items()))
        right = max(half + rim, *(at.real + size / 2 + s.wall for at, size in pins.items()))
        tall = self.block_height / 2
        low = min(-tall, *(at.imag - size / 2 - s.wall for at, size in pins.items()))
        depth = self.block_depth
        outline = rectangle(complex(left, low), complex(right, tall))
        holes = (
            *(self._hole(at, size, self.fits.press) for at, size in pins.items()),
            *(circle(at, CORE_HOLES[_SCREW] / 2) for at in screws),
        )
        bores = tuple(
            self._hole(complex(sign * half, depth / 2), s.rod_diameter, fit) for sign in (-1, 1)
        )
        across = Region(rectangle(complex(left), complex(right, depth)), bores)
        layer = Layer(Region(outline, holes), 0.0, depth)
        return Part(name, title, (layer,), centres=tuple(pins), side_profile=across)

    def _carriage(self) -> Iterator[tuple[Part, Sequence[Mount]]]:
        """Of a slide: a block that runs on two rods, with the pins of its rollers."""
        beside = self.track.geometry.follower.offset
        pins = self._carriage_pins
        screws = self._carriage_screws(pins)
        title = "Carriage"
        notes = ["runs on two rods; the pin of the roller glued in"]
        if screws:
            pitch = f"{2 * screws[-1].real:g} x {2 * screws[-1].imag:g}"
            title += f", four holes for {_SCREW} {pitch} apart"
            size = f"{CORE_HOLES[_SCREW]:g} through its {self.block_depth:.4g}"
            notes.append(f"four holes of {size}, for {_SCREW} screws: what it moves")
        part = self._block("carriage", title, pins, self.fits.slide, screws)
        at = complex(beside)
        outside = self.block_face + self.block_depth
        yield replace(part, notes=tuple(notes)), [Mount("carriage", _FOLLOWER, at, z=-outside)]

    def _arm(self) -> Iterator[tuple[Part, Sequence[Mount]]]:
        """Of an arm: a bracket glued on two rods, the pin in it, the arm, and the cap that keeps it there."""
        s = self.sizes
        track = self.track
        arm = complex(track.geometry.follower.arm or 0.0)
        bracket = self._block("bracket", "Bracket of the arm", self.bracket_pins, self.fits.press)
        height = self.base + track.height
        also = "" if self.hung is None else ", and that of its spring"
        note = f"glued on two rods; the pin of the arm glued in{also}"
        yield (
            replace(bracket, notes=(note,)),
            [_upright("bracket", complex(self.block_face), height)],
        )
        cap = self.arm_face - END_PLAY
        inner = self.track.radius + AIR
        length = self.block_face + self.block_depth - inner
        yield (
            self._pin_part("pivot", "Pin of the arm", length, "glued into bracket and cap"),
            [_upright("pivot", complex(inner, track.pivot), height)],
        )
        yield (
            _part("cap", "Cap of the arm's pin", self._washer, cap - inner, centres=(0j,)),
            [_upright("cap", complex(inner, track.pivot), height)],
        )
        edge = hull([(0j, self.arm_hub), (arm, self.arm_hub)])
        holes = (
            self._hole(0j, self.pin, self.fits.slide),
            self._hole(arm, self.pin, self.fits.press),
        )
        yield from self._hanging()
        note = "turns on its pin; that of the roller glued in"
        yield (
            _part("arm", "Arm", Region(edge, holes), s.thickness, note, centres=(0j, arm)),
            [Mount("arm", _FOLLOWER, 0j, track.start, z=-self.arm_face - s.thickness)],
        )

    def _hanging(self) -> Iterator[tuple[Part, Sequence[Mount]]]:
        """Of an arm that a spring pulls: the spring's pin in the bracket, and what keeps the arm off the bracket."""
        if self.hung is None:
            return
        outer = self.arm_face + self.sizes.thickness
        height = self.base + self.track.height
        pivot, post = self.bracket_pins
        length = self.block_face + self.block_depth - outer - AIR / 2
        pin = self._pin_part("spring-pin", "Pin of the spring", length, "glued into the bracket")
        at = complex(outer + AIR / 2, post.real)
        yield pin, [_upright("spring-pin", at, height + post.imag)]
        title = "Sleeve between arm and bracket"
        wide = self.bracket_gap - END_PLAY
        yield (
            _part("sleeve", title, self._washer, wide, centres=(0j,)),
            [_upright("sleeve", complex(outer + END_PLAY, pivot.real), height)],
        )

    @property
    def _washer(self) -> Region:
        """What is pressed on the pin of an arm."""
        return Region(circle(0j, self.arm_hub), (self._hole(0j, self.pin, self.fits.press),))

    def _pin_part(self, name: str, title: str, length: float, note: str) -> Part:
        region = Region(circle(0j, self.pin / 2))
        cut = _cut(f"pin {self.pin:g} h8", length)
        return _part(name, title, region, length, cut, note, process="bought")

    def _roller(self) -> Iterator[tuple[Part, Sequence[Mount]]]:
        """Rollers and their pins, which end a little before the rollers' inner ends."""
        track = self.track
        roller = track.geometry.roller
        face = self.arm_face if track.swings else self.block_face
        holder = self.pin_end
        middle = cmath.rect(track.geometry.follower.arm or 0.0, track.start) if track.swings else 0j
        places = [middle + 1j * z for z in self.rollers]
        holds = "arm" if track.swings else "carriage"
        pin = self._pin_part(
            "roller-pin",
            "Pin of the roller",
            holder - track.inner - self.pin_below,
            f"glued into the {holds}",
        )
        yield pin, [Mount("roller-pin", _FOLLOWER, at, z=-holder) for at in places]
        ball = ball_roller(2 * roller.radius, roller.length)
        outer = track.inner + roller.length
        if ball is not None:
            ring = Region(circle(0j, roller.radius), (circle(0j, self.pin / 2),))
            notes = (f"{ball.name}, {ball.size} {ball.standard}", "glued on its pin")
            part = _part("roller", "Roller", ring, roller.length, *notes, process="bought")
            yield part, [Mount("roller", _FOLLOWER, at, z=-outer) for at in places]
            return
        hole = self._hole(0j, self.pin, self.fits.slide)
        collar = (
            self.pin / 2 + (roller.radius - self.pin / 2) / 2
        )  # keeps it off what holds the pin
        gap = face - END_PLAY - outer
        layers = (
            Layer(Region(circle(0j, collar), (hole,)), 0.0, gap),
            Layer(Region(circle(0j, roller.radius), (hole,)), gap, gap + roller.length),
        )
        part = Part("roller", "Roller", layers, centres=(0j,), drawn_layer=1)
        yield part, [Mount("roller", _FOLLOWER, at, z=END_PLAY - face) for at in places]

    # ---- springs ----------------------------------------------------------------------------------------------------

    @property
    def carriage_rest(self) -> float:
        """Height of the carriage's upper side at cam angle 0."""
        return self.carriage_top(float(self.track.program(np.zeros(1))[0]))

    def wires(self) -> list[Floats]:
        """Line of each spring's wire at cam angle 0, (n, 3) mm: round its rod, its ends closed, or between both pins; nothing
        without one."""
        if self.hung is not None:
            line, deep = self._hanging_wire(np.zeros(1))
            across = np.full(line.shape[1], self._hanging_depth) - deep
            return [np.column_stack([across, -line[0].real, line[0].imag])]
        if self.spring is None:
            return []
        spring = self.spring.spring
        low = self.carriage_rest
        turn = np.linspace(0, spring.coils + 2, _ROUND * math.ceil(spring.coils + 2) + 1)
        half = spring.wire / 2
        ends = [half, 3 * half, self.ceiling - low - 3 * half, self.ceiling - low - half]
        z = low + np.interp(turn, [0, 1, spring.coils + 1, spring.coils + 2], ends)
        round_ = spring.mean / 2 * np.exp(2j * math.pi * turn)
        return [
            np.column_stack([(at + round_).real, (at + round_).imag, z]) for at in self.rods[:2]
        ]

    @property
    def _hanging_depth(self) -> float:
        """Distance of the middle line of an arm's spring from the drum's axis, along x."""
        return self.arm_face + self.sizes.thickness + self.bracket_gap / 2

    def _hanging_wire(self, theta: Floats) -> tuple[Points, Floats]:
        """The wire of an arm's spring at cam angles, (n, k) complex mm in the plane that stands, and how far each of its points lies
        nearer to the drum's axis than its middle line, (k,) mm."""
        assert self.hung is not None, "no spring pulls the arm"
        hung, spring = self.hung
        ends = (Place(GROUND, hung.post), Place(_FOLLOWER, hung.hooked))
        coil = Coil("spring", "Spring", ends, ("", ""), spring.outside, (0.0, 0.0), ((), ()), False)
        still = Pose(np.zeros(1, complex), np.zeros(1))
        s = self.track.program(theta)
        wires = np.array(
            [
                coil.wire({GROUND: still, _FOLLOWER: Pose(still.place, np.array([angle]))})
                for angle in s
            ]
        )
        pivot = complex(-self.track.pivot, self.base + self.track.height)
        return pivot + wires[..., 0] + 1j * wires[..., 1], wires[0, :, 2]

    def sketches(self) -> list[Sketch]:
        """Springs as the report shows them: their wire round each rod or between its pins, in a plane that stands."""
        if self.hung is not None:
            return [
                Sketch(
                    "spring",
                    course=lambda theta: self._hanging_wire(theta)[0],
                    swell=self._hanging_wire(np.zeros(1))[1],
                    upright=Upright(self._hanging_depth, self._hanging_depth),
                )
            ]
        wires = self.wires()
        if not wires:
            return []
        low = self.carriage_rest
        start = float(self.track.program(np.zeros(1))[0])

        def course(wire: Floats, theta: Floats) -> Points:
            pressed = (self.track.program(theta) - start) / (self.ceiling - low)
            z = wire[:, 2] + pressed[:, None] * (self.ceiling - wire[:, 2])
            return np.asarray(-wire[:, 1] + 1j * z)

        return [
            Sketch(
                f"spring {k}",
                course=partial(course, wire),
                swell=rod.real - wire[:, 0],
                upright=Upright(rod.real, rod.real),
            )
            for k, (rod, wire) in enumerate(zip(self.rods[:2], wires, strict=True), 1)
        ]
