"""The whole printed machine round a uniform-swing cam: which parts, how large, and how they are mounted.

Heights, z = 0 at the base's underside, the motor below it: base, gap (washers on both axles), one frame plate or two on
each other. Where the plate itself is the tip, each plate lies level with its cam, the cams' middle plane is the frames', and
the spacer between the cams leaves each tip clear of the other's cam. Where tips are pins or bearings, the plates lie between
the cams (one plate: under its cam), and each tip stands out of its plate beside its cam.
The frame's own origin is the follower's pivot; the second plate is the first turned over about the line of centres.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from camgen.errors import DesignError
from camgen.followers import DiscCam
from camgen.hardware import Base, Collet, Frame, axle, overlap, spacer, swept_box
from camgen.mechanism import Assembly, Drive, Mount, StandIn
from camgen.outlines import Floats
from camgen.parts import Part, rod
from camgen.sampling import facet_contour
from camgen.spec import Length, Record
from camgen.standards import BEARINGS, DOWELS, MOTOR_FACES, SCREWS, Bearing, MotorFace, dowel, flange

Thread = Literal["M2", "M2.5", "M3", "M4", "M5", "M6"]
Tip = Literal["plate", "pin", "MR63", "MR85", "MR105", "623", "624", "625", "626", "608"]

_LAYOUT = 0.01  # mm, facets of the cam that the frame goes round; the files are judged again
_PLACES = 361  # cam angles at which it does; `gap` is there for what lies between


class BaseTable(Record):
    """The base plate; boss, screw_circle, screws and screw describe the motor "flange"; mount: screws that hold the base."""

    motor: Literal["nema-8", "nema-11", "nema-14", "nema-17", "nema-23", "flange"] = "nema-17"
    boss: Length = 22.0
    screw_circle: Length = 44.0
    screws: Annotated[int, Field(ge=2, le=12)] = 4
    screw: Thread = "M3"
    thickness: Length = 4.0
    wall: Length = 3.0
    window: bool = True
    slot_room: Annotated[float, Field(ge=0, le=100)] = 1.0
    mount: Thread | Literal["none"] = "M3"
    gap: Length = 0.6

    @property
    def face(self) -> MotorFace:
        """The motor that it carries."""
        if self.motor == "flange":
            return flange(self.boss, self.screw_circle, self.screws, self.screw)
        return MOTOR_FACES[self.motor]


class FrameTable(Record):
    """The follower's plates and the two axles that they are pressed on; tip: "plate", "pin" or a bearing by its name."""

    tip: Tip = "plate"
    arm: Length = 10.0
    wall: Length = 3.0
    axle: Length = 6.0
    axle_flange: Length = 12.0
    flange_thickness: Length = 2.0
    slide_at: Length = 24.0
    gap: Length = 1.0

    @property
    def bearing(self) -> Bearing | None:
        """The bearing that is the tip, if one is."""
        return BEARINGS.get(self.tip)

    def seat(self, tip_radius: float) -> float:
        """Diameter of the dowel pin that is pressed into the plate at the tip, mm; 0 where the plate itself is the tip."""
        if self.bearing:
            return float(self.bearing.bore)
        return 2 * tip_radius if self.tip == "pin" else 0.0


class ColletTable(Record):
    """Collet and clamp ring on a plain shaft."""

    wall: Length = 2.4
    length: Length = 6.0
    flange: Length = 2.0
    slits: Annotated[int, Field(ge=2, le=24)] = 4
    slit: Length = 1.0


class NozzleTable(Record):
    """What the frames carry: two screws across the tail, and the load's inertia about the pivot (0: the frames' alone)."""

    screw: Thread = "M3"
    spacing: Length = 20.0
    inertia_kg_m2: Annotated[float, Field(ge=0, le=1e3)] = 0.0
    friction: Annotated[float, Field(ge=0, le=1)] = 0.25


class SpringTable(Record):
    """The spring of force closure, as it acts on the frame: N m per rad, and N m where the tip is nearest to the shaft.

    lever: from the pivot to a straight spring that pulls square to it; what it has to be is stated for that.
    """

    rate: Annotated[float, Field(ge=0, le=1e6)] = 0.0
    preload: Annotated[float, Field(ge=0, le=1e6)] = 0.0
    lever: Length = 24.0


@dataclass(frozen=True)
class SwingMachine:
    """All parts of the machine round a cam, and their mounting; lengths mm.

    cam_part: the cam as made; pins: places of its pin holes; swing: peak to peak, rad; reachable: follower angle over
    the cam angle; pair: two cams and two frames; plain: the shaft is clamped by a collet; flat: depth of its flat, 0:
    none; slide, press: diametral fits.
    """

    cam: DiscCam
    cam_part: Part
    bore: float
    pin: float
    swing: float
    pair: bool
    plain: bool
    flat: float
    wall: float
    slide: float
    press: float
    min_wall: float
    chord_tolerance: float
    base: BaseTable
    frame: FrameTable
    collet: ColletTable
    nozzle: NozzleTable

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
    def shaft_note(self) -> str:
        """What the motor's shaft has to be, and what it usually is."""
        usual = self.base.face.shaft
        known = f" On a {self.base.face.name.upper().replace('-', ' ')} frame {usual:g} mm is usual" if usual else ""
        length = " and 24 mm long" if self.base.motor == "nema-17" else ""
        return f"The motor's shaft is to be {self.shaft_size}.{known}{length}{'.' if known else ''}"

    @property
    def shaft_size(self) -> str:
        """Diameter and length of the shaft."""
        if not self.plain:
            return f"{self.bore:g} mm thick and to reach {self.shaft_length:g} mm over its face"
        ring = self.shaft_length - self._collet.travel
        return f"{self.bore:g} mm thick and to reach {ring:g} to {self.shaft_length:g} mm over its face"

    @cached_property
    def rims(self) -> np.ndarray:
        """Edge of the cam at many cam angles, seen from the frame."""
        theta = np.linspace(0, math.tau, _PLACES)[:, None]
        rim = facet_contour(self.cam.outline, _LAYOUT * min(1.0, abs(self.cam.follower.arm) / 60))
        seen = (rim * np.exp(1j * theta) - self.cam.follower.pivot) * np.exp(-1j * self.cam.reachable(theta))
        return np.asarray(seen.ravel())

    @cached_property
    def base_plate(self) -> Base:
        """The base as a shape."""
        b, f = self.base, self.frame
        return Base(
            b.face, self.cam.follower.pivot.real, f.axle, f.axle_flange, f.slide_at, self.swing, b.thickness, b.wall,
            self.slide, b.slot_room, b.window, SCREWS.get(b.mount),
        )  # fmt: skip

    @cached_property
    def _frame(self) -> Frame:
        f, follower = self.frame, self.cam.follower
        inside = swept_box(self.rims) + complex(f.gap, -f.gap)
        screw = SCREWS[self.nozzle.screw]
        return Frame(
            follower.arm, self._boss if self.seat else follower.tip_radius, inside, f.arm, f.axle + self.press, f.slide_at,
            screw.clearance, self.nozzle.spacing, self.pin, self.thickness, f.wall, self.tip_hole,
            (screw.flats + self.slide, screw.nut),
        )  # fmt: skip

    @property
    def tip_hole(self) -> float:
        """Diameter of the hole for the tip's pin, 0: none."""
        return self.seat + self.press if self.seat else 0.0

    @property
    def _boss(self) -> float:
        """Radius of the plate round the tip's pin."""
        return self.tip_hole / 2 + 2 * self.min_wall

    @cached_property
    def tip_pin(self) -> float:
        """Length of the dowel pin at the tip; DesignError where none is sold, or its bearing does not fit beside the plate."""
        longest = 2 * self.thickness + self.slide
        length, bearing = dowel(self.seat, longest), self.frame.bearing
        needed = self.thickness + self.slide + max(self.thickness / 2, bearing.width if bearing else 0.0)
        if length < needed:
            raise DesignError(
                "dowel pin of the tip", length, needed, "mm", f"ISO 2338, diameter {self.seat:g} mm, at most {longest:g} mm",
                "use another parts.thickness or another frame.tip",
            )  # fmt: skip
        return length

    @cached_property
    def _collet(self) -> Collet:
        c = self.collet
        plain = Collet(self.bore, self.slide, c.wall, c.length, c.flange, 0.0, (), c.slits, c.slit)
        pins = tuple((z, self.pin) for z in self.pins)
        reach = max((abs(z) + self.pin / 2 + self.wall for z in self.pins), default=0.0)
        flange_diameter = max(plain.ring_diameter, 2 * reach)
        return Collet(self.bore, self.slide, c.wall, c.length, c.flange, flange_diameter, pins, c.slits, c.slit)

    # ---- parts ------------------------------------------------------------------------------------------------------

    def parts(self) -> tuple[Part, ...]:
        """Every printed part, the cam first; DesignError where sizes do not go together."""
        return self._made

    @cached_property
    def _made(self) -> tuple[Part, ...]:
        f, count = self.frame, 2 if self.pair else 1
        plate = self._frame.part(self.min_wall, count)
        if self.seat:
            pin = f"hole at the tip for a dowel pin {self.seat:g} m6 x {self.tip_pin:g}, ISO 2338"
            plate = replace(plate, notes=(*plate.notes, pin))
        arm = self.cam.follower
        deep = 0.0 if self.seat else overlap(plate.region, self.rims, (arm.arm, arm.tip_radius + f.gap))
        if deep > 0:
            raise DesignError(
                "overlap of frame and cam", deep, 0.0, "mm", "frame, over the turn",
                "use a narrower frame.arm, a larger frame.gap or a smaller swing",
            )  # fmt: skip
        made = [
            self.cam_part,
            plate,
            self.base_plate.part(self.min_wall),
            axle(f.axle, self.last + self.slide, f.axle_flange, f.flange_thickness),
            spacer(
                "axle-washer", "Washer of an axle", f.axle + self.slide, f.axle_flange, self.foot - self.base.thickness,
                self.min_wall, 2,
            ),
        ]  # fmt: skip
        if self.pair:
            made.append(self._spacer())
        if self.plain:
            made += [self._collet.sleeve(self.min_wall), self._collet.ring()]
        glued = ("pressed and glued",)
        if self.pins and self.cam_pin_length > self.thickness:
            diameter = self.pin - self.press
            made.append(rod("cam-pin", "Pin of the cams", diameter, self.cam_pin_length, len(self.pins), glued))
        if self.pair and self.pin:
            made.append(rod("frame-pin", "Pin of the frames", self.pin - self.press, 2 * self.thickness, 2, glued))
        return tuple(made)

    @property
    def cam_pin_length(self) -> float:
        """Length of the pins through the cams and the collet's flange."""
        return self.top - self.low + (self.collet.flange if self.plain else 0.0)

    def _spacer(self) -> Part:
        """Washer between the cams, small enough to pass between the tips."""
        room = float(np.min(np.abs(facet_contour(self.cam.outline, _LAYOUT)))) - self.slide
        if self.seat:
            room += self.cam.follower.tip_radius - self._boss
        reach = max([self.bore / 2 + self.wall, *(abs(z) + self.pin / 2 + self.wall for z in self.pins)])
        return spacer(
            "cam-spacer", "Spacer between the cams", self.bore + self.slide, 2 * min(room, reach),
            self.top - self.low - 2 * self.thickness, self.min_wall, 1, [(z, self.pin) for z in self.pins],
        )  # fmt: skip

    # ---- mounting ---------------------------------------------------------------------------------------------------

    def assembly(self, reachable: Callable[[Floats], Floats]) -> Assembly:
        """Where every copy is and how it moves; reachable: follower angle over the cam angle, rad."""
        shaft = Drive("cam", 0j, lambda theta: theta)
        swing = Drive("follower", self.cam.follower.pivot, reachable)
        still = Drive("ground", 0j, np.zeros_like)
        f, t, low = self.frame, self.thickness, self.low
        beyond = complex(f.slide_at)
        mounts = [Mount("base", still), Mount("cam", shaft, z=low), Mount("frame", swing, z=self.foot)]
        if self.pair:
            mounts.append(Mount("cam", shaft, z=self.top - t, flipped=True))
            mounts.append(Mount("frame", swing, z=self.foot + t, flipped=True, turned=math.pi))
            mounts.append(Mount("cam-spacer", shaft, z=low + t))
            mounts += [Mount("frame-pin", swing, at=z, z=self.foot) for z in self._frame.pins]
        for at in (0j, beyond):
            mounts.append(Mount("axle", swing, at=at, z=-f.flange_thickness - self.slide))  # so much end float
            mounts.append(Mount("axle-washer", swing, at=at, z=self.base.thickness))
        if self.plain:
            mounts.append(Mount("collet", shaft, z=self.top))
            mounts.append(Mount("clamp-ring", shaft, z=self.top + self.collet.flange + self._collet.travel))
        if self.cam_pin_length > t:
            mounts += [Mount("cam-pin", shaft, at=z, z=low) for z in self.pins]
        made = {part.name for part in self._made}
        return Assembly(tuple(mount for mount in mounts if mount.part in made), self._stand_ins(shaft, swing, still))

    def _stand_ins(self, shaft: Drive, swing: Drive, still: Drive) -> tuple[StandIn, ...]:
        """Bought things as stacks of discs."""
        face, screw = self.base.face, SCREWS[self.nozzle.screw]
        floor = self.base.thickness - self.base_plate.pocket_depth
        heads = [(z, sunk.head / 2, floor, floor + sunk.height) for z, sunk in self.base_plate.sunk]
        last, middle = self.last, self.foot + self.thickness if self.pair else self.foot + screw.nut / 2
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
            StandIn("screws of motor and base", still.course, tuple(heads)),
            StandIn("nozzle screws", swing.course, tuple(nozzle)),
        ]
        boss = min(face.boss_height, self.base.thickness)
        if boss:
            bought.append(StandIn("motor boss", still.course, ((0j, face.boss / 2, 0.0, boss),)))
        round_part = (-0.5j * self.flat, (self.bore - self.flat) / 2)  # the largest disc beside a flat
        bought.append(StandIn("shaft", shaft.course, ((*round_part, boss, self.shaft_length),)))
        return (*bought, *(StandIn(f"tip-{k + 1}", swing.course, discs, rolls=True) for k, discs in enumerate(self._tips())))

    def _tips(self) -> list[tuple[tuple[complex, float, float, float], ...]]:
        """Pin, and bearing, of each tip that is not the plate itself, as discs on the follower."""
        if not self.seat:
            return []
        arm, t, length = self.cam.follower.arm, self.thickness, self.tip_pin
        low, high = (self.foot + t - length, self.foot + t) if self.pair else (self.foot, self.foot + length)
        spans, cams = [(arm, low, high, self.low)], (self.low, self.top - t)
        if self.pair:
            spans.append((arm.conjugate(), self.foot + t, self.foot + t + length, cams[1]))
        found = []
        for z, below, above, cam in spans:
            discs = [(z, self.seat / 2, below, above)]
            if self.frame.bearing:
                half = self.frame.bearing.width / 2
                discs.append((z, self.frame.bearing.outside / 2, cam + t / 2 - half, cam + t / 2 + half))
            found.append(tuple(discs))
        return found


def machine_faults(
    tip_radius: float, slide: float, press: float, pin: float, min_wall: float, nozzle: float, joined: bool, base: BaseTable,
    frame: FrameTable, collet: ColletTable,
) -> Sequence[tuple[bool, str, float, str]]:
    """Checks between keys of the machine: (holds, path, value, what would be right); joined: pins must join its cams."""
    rollers = [d / 2 for d in DOWELS] if frame.tip == "pin" else [b.outside / 2 for b in (frame.bearing,) if b]
    thin = {
        "parts.pin_diameter": pin or min_wall, "frame.arm": frame.arm, "frame.axle": frame.axle,
        "frame.flange_thickness": frame.flange_thickness, "collet.flange": collet.flange,
    }  # fmt: skip
    return (
        *((size >= min_wall, path, size, f"at least limits.min_wall, {min_wall:g} mm") for path, size in thin.items()),
        (pin > 0 or not joined, "parts.pin_diameter", pin, "more than 0: pins join the two cams on a plain shaft"),
        (collet.slit >= nozzle, "collet.slit", collet.slit, f"at least the nozzle, {nozzle:g} mm, or it closes in print"),
        (
            frame.tip == "plate" or tip_radius in rollers,
            "geometry.tip_radius", tip_radius,
            f"that of frame.tip = \"{frame.tip}\": {', '.join(f'{radius:g}' for radius in rollers)} mm",
        ),
        (slide > 0, "print.slide_clearance", slide, "more than 0: the cams and frames of a machine turn past each other"),
        (base.gap > slide, "base.gap", base.gap, f"more than print.slide_clearance, {slide:g} mm"),
        (press < pin or not pin, "print.press_clearance", press, f"less than parts.pin_diameter, {pin:g} mm"),
        (
            frame.axle_flange > frame.axle + slide,
            "frame.axle_flange", frame.axle_flange, f"more than the axle and its clearance, {frame.axle + slide:g} mm",
        ),
        (
            base.motor != "flange" or base.screw_circle > base.boss,
            "base.screw_circle", base.screw_circle, f"more than base.boss, {base.boss:g} mm",
        ),
    )  # fmt: skip
