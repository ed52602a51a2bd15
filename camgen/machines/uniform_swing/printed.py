"""The whole printed machine round a uniform-swing cam: which parts, how large, and how they are mounted.

Heights, z = 0 at the base's underside, the motor below it: base, gap (washers on both axles), one frame plate or two on
each other. Where the plate itself is the tip, each plate lies level with its cam, the cams' middle plane is the frames', and
the spacer between the cams leaves each tip clear of the other's cam. Where tips are pins or bearings, the plates lie between
the cams (one plate: under its cam), and each tip stands out of its plate beside its cam.
The frame's own origin is the follower's pivot; the second plate is the first turned over about the line of centres.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from camgen.errors import DesignError
from camgen.geometry.facets import facet_contour
from camgen.geometry.outlines import Points, circle
from camgen.machine.features import Mount, StandIn
from camgen.machine.model import GROUND
from camgen.machines.uniform_swing.plates import Base, Frame, overlap, swept_box
from camgen.machines.uniform_swing.room import LEAST_AXLE, washer_wall
from camgen.parts.catalogue import DOWEL_STANDARD, SCREWS, TURNED, dowel
from camgen.parts.disc_cams import LAYOUT
from camgen.parts.hardware import Collet, headed, plate, spacer
from camgen.parts.journals import Journal
from camgen.parts.part import Layer, Part, hull, rod

if TYPE_CHECKING:
    from camgen.machines.uniform_swing.mechanism import UniformSwing

_TOUCHING = 0.1  # mm beyond the tip's own surface, where cam and finger may seem to overlap because the tip touches the cam
_PLACES = 361  # cam angles at which it does; `gap` is there for what lies between


class SwingMachine:
    """All parts of the machine round a cam, and their mounting; lengths mm, pin_wall: kept round the cams' pins."""

    def __init__(self, spec: UniformSwing) -> None:
        p = spec.making
        self.spec, self.cam, self.cam_part, self.room, self.pin_wall = (
            spec,
            spec.cam,
            spec.cam_part,
            spec.room,
            spec.pins[1],
        )
        self.base, self.frame, self.collet, self.nozzle = (
            spec.base,
            spec.frame,
            spec.collet,
            spec.nozzle,
        )
        self.bore, self.pin, self.wall, self.plain, self.pair = (
            p.bore,
            p.pin_diameter,
            p.wall,
            self.room.plain,
            self.room.pair,
        )
        self.slide, self.press, self.min_wall = (
            spec.print.slide_clearance,
            spec.print.press_clearance,
            spec.allowed.min_wall,
        )

    # ---- sizes ------------------------------------------------------------------------------------------------------

    @property
    def pins(self) -> tuple[complex, ...]:
        """Places of the cam's pins."""
        return self.cam_part.centres[1:] if self.pin else ()

    @property
    def thickness(self) -> float:
        """Of cam and frame alike."""
        return self.cam_part.thickness

    @cached_property
    def seat(self) -> float:
        """Diameter of the pin at the tip, 0 where the plate is the tip."""
        return self.frame.seat(self.cam.follower.tip_radius)

    @property
    def _floor(self) -> float:
        """Height of what moves lowest."""
        return self.base.thickness + self.base.gap

    @property
    def low(self) -> float:
        """Height of the first cam's underside."""
        if not self.pair:
            return self.foot + (self.thickness + self.slide if self.seat else 0.0)
        return self._floor - (0.0 if self.seat else self.slide)

    @property
    def foot(self) -> float:
        """Height of the first frame's underside."""
        return self._floor + (self.thickness + self.slide if self.seat and self.pair else 0.0)

    @property
    def last(self) -> float:
        """Height of the frames' upper side."""
        return self.foot + (2 if self.pair else 1) * self.thickness

    @property
    def top(self) -> float:
        """Height of the upper cam's upper side."""
        if not self.pair:
            return self.low + self.thickness
        return self.last + self.slide + (self.thickness if self.seat else 0.0)

    @property
    def shaft_length(self) -> float:
        """Height of the collet's upper end, or of the upper cam, over the motor's face."""
        return self.top + (self.collet.flange + self.collet.length if self.plain else 0.0)

    @property
    def shaft_needed(self) -> float:
        """The least height at which it holds the upper cam."""
        return self.shaft_length - (self._collet.travel if self.plain else 0.0)

    @property
    def shaft_note(self) -> str:
        """What the motor's shaft has to be, and what it usually is."""
        usual = self.base.face.shaft
        known = (
            f" On a {self.base.face.name.upper().replace('-', ' ')} frame {usual:g} mm is usual"
            if usual
            else ""
        )
        length = " and 24 mm long" if self.base.motor == "nema-17" else ""
        return f"The motor's shaft is to be {self.shaft_size}.{known}{length}{'.' if known else ''}"

    @property
    def shaft_size(self) -> str:
        """Diameter and length of the shaft."""
        if not self.plain:
            p = self.spec.making
            flat = f", with a flat {p.flat_depth:g} deep," if p.shaft == "d-flat" else ""
            return (
                f"{self.bore:g} mm thick{flat} and to reach {self.shaft_length:g} mm over its face"
            )
        return f"{self.bore:g} mm thick and to reach {self.shaft_needed:g} to {self.shaft_length:g} mm over its face"

    @cached_property
    def rims(self) -> np.ndarray:
        """Edge of the cam at many cam angles, seen from the frame."""
        theta = np.linspace(0, math.tau, _PLACES)[:, None]
        rim = facet_contour(self.cam.outline, LAYOUT * min(1.0, abs(self.cam.follower.arm) / 60))
        seen = (rim * np.exp(1j * theta) - self.cam.follower.pivot) * np.exp(
            -1j * self.cam.reachable(theta)
        )
        return np.asarray(seen.ravel())

    @cached_property
    def base_plate(self) -> Base:
        """The base as a shape."""
        b, f = self.base, self.frame
        return Base(
            b.face,
            self.cam.follower.pivot.real,
            self.axle,
            f.axle_flange,
            f.slide_at,
            self.room.swing,
            b.thickness,
            b.wall,
            self.slide,
            b.slot_room,
            b.window,
            SCREWS.get(b.mount),
        )

    @cached_property
    def _frame(self) -> Frame:
        """The frame; its finger, which widens towards the arm, is straight where the cam passes too near for that."""
        wide, straight = self._frame_with(False), self._frame_with(True)
        return straight if self._overlap(wide) else wide

    def _overlap(self, frame: Frame) -> float:
        """How deep the cam comes into the plate that is itself the tip, mm, 0 if it does not."""
        arm = self.cam.follower
        tip = arm.arm, arm.tip_radius + min(self.frame.gap, _TOUCHING)
        return 0.0 if self.seat else overlap(frame.part(self.min_wall).region, self.rims, tip)

    def _frame_with(self, straight: bool) -> Frame:
        f, follower = self.frame, self.cam.follower
        screw = SCREWS[self.nozzle.screw]
        return Frame(
            follower.arm,
            self._boss if self.seat else follower.tip_radius,
            self._inside,
            f.arm,
            self.axle + self.press,
            f.slide_at,
            screw.clearance,
            self.nozzle.spacing,
            self.pin,
            self.thickness,
            f.wall,
            self.tip_hole,
            (screw.flats + self.slide, screw.nut),
            self._hub,
            straight,
        )

    @property
    def tip_hole(self) -> float:
        """Diameter of the hole for the tip's pin, 0: none."""
        return self.seat + self.press if self.seat else 0.0

    @property
    def _boss(self) -> float:
        """Radius of the plate round the tip's pin."""
        return self.frame.boss(self.seat, self.press, self.min_wall)

    # ---- what is made smaller where there is no room -----------------------------------------------------------------

    @cached_property
    def _inside(self) -> complex:
        """How near the cam comes to the pivot and to the frame's arm, room included: see `Frame.inside`."""
        return swept_box(self.rims) + complex(self.frame.gap, -self.frame.gap)

    @cached_property
    def axle(self) -> float:
        """Diameter of both axles, mm: as wanted, or what leaves the least wall between axle and cam."""
        fit = max(self.press, self.slide)
        room = math.floor(10 * (2 * (-self._inside.real - self.min_wall - LAYOUT) - fit)) / 10
        least = min(self.frame.axle, LEAST_AXLE)
        if room < least:
            raise DesignError(
                "room for the axle's hub",
                -self._inside.real,
                (least + fit) / 2 + self.min_wall + LAYOUT,
                "mm",
                f"the frame beside the pivot, for an axle of {least:g} mm with limits.min_wall",
                f"the cam comes too near the pivot: {self.room.remedy()}",
            )
        return min(self.frame.axle, room)

    @property
    def _hub(self) -> float:
        """Radius of the frame round the pivot's axle."""
        return min((self.axle + self.press) / 2 + self.frame.wall, -self._inside.real)

    @property
    def _sleeve_wall(self) -> float:
        """Wall of the collet: as wanted, or what the pins leave."""
        c, free = self.collet, min((abs(z) - self.pin / 2 for z in self.pins), default=math.inf)
        return min(
            c.wall,
            c.wall + free - Collet(self.bore, self.slide, c.wall, c.length, c.flange, 0.0).radius,
        )

    @cached_property
    def _rim(self) -> Points:
        return facet_contour(self.cam.outline, LAYOUT)

    @property
    def smaller(self) -> tuple[str, ...]:
        """What is smaller than wanted, for people; nothing where all has room."""
        sizes = [
            ("frame.axle", self.frame.axle, self.axle),
            (
                "frame.wall round the pivot",
                self.frame.wall,
                self._hub - (self.axle + self.press) / 2,
            ),
            ("parts.wall round the cams' pins", self.wall, self.pin_wall),
        ]
        sizes += [("collet.wall", self.collet.wall, self._sleeve_wall)] if self.plain else []
        less = [
            f"{name} {made:.3g} instead of {wanted:g}"
            for name, wanted, made in sizes
            if made < wanted - LAYOUT
        ]
        return (
            (f"Made smaller than usual, for there is no room, mm: {'; '.join(less)}.",)
            if less
            else ()
        )

    @cached_property
    def tip_pin(self) -> float:
        """Length of the dowel pin at the tip; DesignError where none is sold, or its bearing does not fit beside the plate."""
        longest = 2 * self.thickness + self.slide
        length, bearing = dowel(self.seat, longest), self.frame.bearing
        needed = (
            self.thickness + self.slide + max(self.thickness / 2, bearing.width if bearing else 0.0)
        )
        if length < needed:
            raise DesignError(
                "dowel pin of the tip",
                length,
                needed,
                "mm",
                f"{DOWEL_STANDARD}, diameter {self.seat:g} mm, at most {longest:g} mm",
                "use another parts.thickness or another frame.tip",
            )
        return length

    @cached_property
    def _collet(self) -> Collet:
        c, wall = self.collet, self._sleeve_wall
        plain = Collet(self.bore, self.slide, wall, c.length, c.flange, 0.0, (), c.slits, c.slit)
        pins = tuple((z, self.pin) for z in self.pins)
        reach = max((abs(z) + self.pin / 2 + self.wall for z in self.pins), default=0.0)
        flange_diameter = max(plain.ring_diameter, 2 * reach)
        return Collet(
            self.bore, self.slide, wall, c.length, c.flange, flange_diameter, pins, c.slits, c.slit
        )

    # ---- parts ------------------------------------------------------------------------------------------------------

    def parts(self) -> tuple[Part, ...]:
        """Every printed part, the cam first; DesignError where sizes do not go together."""
        return self._made

    @cached_property
    def _made(self) -> tuple[Part, ...]:
        f, count = self.frame, 2 if self.pair else 1
        plate = self._frame.part(self.min_wall, count)
        if self.seat:
            pin = f"hole at the tip for a dowel pin {self.seat:g} m6 x {self.tip_pin:g}, {DOWEL_STANDARD}"
            plate = replace(plate, notes=(*plate.notes, pin))
        deep = self._overlap(self._frame)
        if deep > 0:
            raise DesignError(
                "overlap of frame and cam",
                deep,
                0.0,
                "mm",
                "frame, over the turn",
                "the cam is too steep beside the tip: use a smaller geometry.swing_deg or geometry.tip_radius, or a larger "
                "geometry.arm_offset",
            )
        made = [
            self.cam_part,
            plate,
            self.base_plate.part(self.min_wall),
            replace(
                headed(
                    "axle",
                    "Axle with flange",
                    self.axle,
                    self.last + self.slide,
                    f.axle_flange,
                    f.flange_thickness,
                ),
                count=2,
                notes=("pressed and glued into the frames",),
            ),
            replace(
                spacer(
                    "axle-washer",
                    "Washer of an axle",
                    self.axle + self.slide,
                    min(f.axle_flange, -2 * self._inside.real),
                    self.foot - self.base.thickness,
                    self.min_wall,
                ),
                count=2,
            ),
        ]
        if self.pair:
            made.append(self._spacer())
        if self.plain:
            made += [self._collet.sleeve(self.min_wall), self._collet.ring()]
        glued, pins_made = (
            ("pressed and glued",),
            TURNED if self.spec.making.pins == "steel" else "printed",
        )
        if self.pins and self.cam_pin_length > self.thickness:
            diameter = self.pin - self.press
            rods = rod("cam-pin", "Pin of the cams", diameter, self.cam_pin_length)
            made.append(replace(rods, count=len(self.pins), notes=glued, made=pins_made))
        if self.pair and self.pin:
            length = 2 * self.thickness
            rods = rod("frame-pin", "Pin of the frames", self.pin - self.press, length)
            made.append(replace(rods, count=2, notes=glued, made=pins_made))
        return tuple(made)

    @property
    def cam_pin_length(self) -> float:
        """Length of the pins through the cams and the collet's flange."""
        return self.top - self.low + (self.collet.flange if self.plain else 0.0)

    def _spacer(self) -> Part:
        """Washer between the cams, small enough to pass between the tips."""
        assert self.room.washer is not None, "a pair has one"
        hole, keep = self.room.washer
        reach = max([hole, *(abs(z) + self.pin / 2 for z in self.pins)])
        radius = min(reach + self.wall, float(np.min(np.abs(self._rim))) - keep)
        edge = circle(0j, radius)
        if (
            radius - reach < self.min_wall
        ):  # no round one has room, but one as wide as its holes need
            wall = min(self.wall, washer_wall(self._rim, hole, self.pins, self.pin, keep))
            edge = hull([(0j, hole + wall), *((z, self.pin / 2 + wall) for z in self.pins)])
        holes = {"bore": circle(0j, hole)} | {
            f"pin {k}": circle(z, self.pin / 2) for k, z in enumerate(self.pins, 1)
        }
        region = plate("cam-spacer", edge, holes, self.min_wall)
        return Part(
            "cam-spacer",
            "Spacer between the cams",
            (Layer(region, 0.0, self.top - self.low - 2 * self.thickness),),
            centres=(0j, *self.pins),
            bore=2 * hole,
            min_wall=self.min_wall,
        )

    # ---- mounting ---------------------------------------------------------------------------------------------------

    @cached_property
    def mounts(self) -> tuple[Mount, ...]:
        """Every copy on cam, follower or ground."""
        f, t, low = self.frame, self.thickness, self.low
        beyond = complex(f.slide_at)
        mounts = [
            Mount("base", GROUND),
            Mount("cam", "cam", z=low),
            Mount("frame", "follower", z=self.foot),
        ]
        if self.pair:
            mounts.append(Mount("cam", "cam", z=self.top - t, flipped=True))
            mounts.append(Mount("frame", "follower", z=self.foot + t, flipped=True, turned=math.pi))
            mounts.append(Mount("cam-spacer", "cam", z=low + t))
            mounts += [Mount("frame-pin", "follower", at=z, z=self.foot) for z in self._frame.pins]
        for at in (0j, beyond):
            mounts.append(
                Mount("axle", "follower", at=at, z=-f.flange_thickness - self.slide)
            )  # so much end float
            mounts.append(Mount("axle-washer", "follower", at=at, z=self.base.thickness))
        if self.plain:
            mounts.append(Mount("collet", "cam", z=self.top))
            mounts.append(
                Mount("clamp-ring", "cam", z=self.top + self.collet.flange + self._collet.travel)
            )
        if self.cam_pin_length > t:
            mounts += [Mount("cam-pin", "cam", at=z, z=low) for z in self.pins]
        made = {part.name for part in self._made}
        return tuple(mount for mount in mounts if mount.part in made)

    def journals(self, printed: str) -> dict[str, Journal]:
        """The axle at the pivot: it turns in the base and is pressed into the frames."""
        lever = self.foot - self.base.thickness / 2
        return {"pivot": Journal("pivot", self.axle, self.base.thickness, lever, printed, printed)}

    def stand_ins(self) -> tuple[StandIn, ...]:
        """Bought things as stacks of discs."""
        face, screw = self.base.face, SCREWS[self.nozzle.screw]
        floor = self.base.thickness - self.base_plate.pocket_depth
        heads = [(z, sunk.head / 2, floor, floor + sunk.height) for z, sunk in self.base_plate.sunk]
        last, middle = (
            self.last,
            self.foot + self.thickness if self.pair else self.foot + screw.nut / 2,
        )
        tail = complex(self.frame.slide_at, self.nozzle.spacing / 2)
        nozzle = [
            disc
            for z in (tail, tail.conjugate())
            for disc in (
                (z, screw.nominal / 2, self.foot, last),
                (z, screw.flats / 2, middle - screw.nut / 2, middle + screw.nut / 2),
                (z, screw.head / 2, last, last + screw.height),
            )
        ]
        bought = [
            StandIn("screws of motor and base", GROUND, tuple(heads)),
            StandIn("nozzle screws", "follower", tuple(nozzle)),
        ]
        boss = min(face.boss_height, self.base.thickness)
        if boss:
            bought.append(StandIn("motor boss", GROUND, ((0j, face.boss / 2, 0.0, boss),)))
        p = self.spec.making
        flat = p.flat_depth if p.shaft == "d-flat" else 0.0
        round_part = (-0.5j * flat, (self.bore - flat) / 2)  # the largest disc beside a flat
        bought.append(StandIn("shaft", "cam", ((*round_part, boss, self.shaft_length),)))
        return (
            *bought,
            *(
                StandIn(f"tip-{k + 1}", "follower", discs, rolls=True)
                for k, discs in enumerate(self._tips())
            ),
        )

    def _tips(self) -> list[tuple[tuple[complex, float, float, float], ...]]:
        """Pin, and bearing, of each tip that is not the plate itself, as discs on the follower."""
        if not self.seat:
            return []
        arm, t, length = self.cam.follower.arm, self.thickness, self.tip_pin
        low, high = (
            (self.foot + t - length, self.foot + t)
            if self.pair
            else (self.foot, self.foot + length)
        )
        spans, cams = [(arm, low, high, self.low)], (self.low, self.top - t)
        if self.pair:
            spans.append((arm.conjugate(), self.foot + t, self.foot + t + length, cams[1]))
        found = []
        for z, below, above, cam in spans:
            discs = [(z, self.seat / 2, below, above)]
            if self.frame.bearing:
                half = self.frame.bearing.width / 2
                discs.append(
                    (z, self.frame.bearing.outside / 2, cam + t / 2 - half, cam + t / 2 + half)
                )
            found.append(tuple(discs))
        return found
