"""The whole printed machine round a uniform-swing cam: which parts, how large, and how they are mounted.

Heights, z = 0 at the base's underside, the motor below it: base, gap (washers on both axles), one frame plate or two on
each other; the cams' middle plane is the frames'. The spacer between the cams leaves each tip clear of the other's cam.
The frame's own origin is the follower's pivot; the second plate is the first turned over about the line of centres.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
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
from camgen.standards import MOTOR_FACES, SCREWS, Bought, MotorFace, flange

Thread = Literal["M2", "M2.5", "M3", "M4", "M5", "M6"]

_LAYOUT = 0.01  # mm, facets of the cam that the frame goes round; the files are judged again
_PLACES = 361  # cam angles at which it does; `gap` is there for what lies between
_PRESSED = 0.01  # mm, overlap of a pin and its hole that still counts as touching
_ROLLING = 0.08  # mm, the same of tip and cam on the way round; how they touch is judged by rolling, far more finely


class BaseTable(Record):
    """The base plate; boss, screw_circle, screws and screw describe the motor "flange"."""

    motor: Literal["nema-8", "nema-11", "nema-14", "nema-17", "nema-23", "flange"] = "nema-17"
    boss: Length = 22.0
    screw_circle: Length = 44.0
    screws: Annotated[int, Field(ge=2, le=12)] = 4
    screw: Thread = "M3"
    thickness: Length = 4.0
    wall: Length = 3.0
    window: bool = True
    slot_room: Annotated[float, Field(ge=0, le=100)] = 1.0
    gap: Length = 0.6

    @property
    def face(self) -> MotorFace:
        """The motor that it carries."""
        if self.motor == "flange":
            return flange(self.boss, self.screw_circle, self.screws, self.screw)
        return MOTOR_FACES[self.motor]


class FrameTable(Record):
    """The follower's plates and the two axles that they are pressed on."""

    arm: Length = 10.0
    wall: Length = 3.0
    axle: Length = 6.0
    axle_flange: Length = 12.0
    flange_thickness: Length = 2.0
    slide_at: Length = 24.0
    gap: Length = 1.0


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
    """The spring of force closure, as it acts on the frame: N m per rad, and N m where the tip is nearest to the shaft."""

    rate: Annotated[float, Field(ge=0, le=1e6)] = 0.0
    preload: Annotated[float, Field(ge=0, le=1e6)] = 0.0


@dataclass(frozen=True)
class SwingMachine:
    """All parts of the machine round a cam, and their mounting; lengths mm.

    cam_part: the cam as made; pins: places of its pin holes; swing: peak to peak, rad; reachable: follower angle over
    the cam angle; pair: two cams and two frames; plain: the shaft is clamped by a collet; slide, press: diametral fits.
    """

    cam: DiscCam
    cam_part: Part
    bore: float
    pin: float
    swing: float
    pair: bool
    plain: bool
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

    @property
    def foot(self) -> float:
        """Height of the first frame's underside."""
        return self.base.thickness + self.base.gap

    @property
    def top(self) -> float:
        """Height of the upper cam's upper side."""
        return self.foot + (2 * self.thickness + self.slide if self.pair else self.thickness)

    @property
    def shaft_length(self) -> float:
        """Height of the collet's upper end, or of the upper cam, over the motor's face."""
        return self.top + (self.collet.flange + self.collet.length if self.plain else 0.0)

    @property
    def shaft_note(self) -> str:
        """What the motor's shaft has to be, and what it usually is."""
        asked = f"The motor's shaft is to be {self.bore:g} mm thick and to reach {self.shaft_length:g} mm over its face"
        usual = self.base.face.shaft
        known = f"; on a {self.base.face.name.upper().replace('-', ' ')} frame {usual:g} mm is usual" if usual else ""
        length = " and 24 mm long" if self.base.motor == "nema-17" else ""
        if not self.plain:
            return f"{asked}{known}{length}."
        ring = self.shaft_length - self._collet.travel
        return f"{asked}{known}{length}. The collet holds a shaft that ends no lower than the clamp ring, {ring:g} mm."

    @cached_property
    def rims(self) -> np.ndarray:
        """Edge of the cam at many cam angles, seen from the frame."""
        theta = np.linspace(0, math.tau, _PLACES)[:, None]
        rim = facet_contour(self.cam.outline, _LAYOUT * min(1.0, abs(self.cam.follower.arm) / 60))
        seen = (rim * np.exp(1j * theta) - self.cam.follower.pivot) * np.exp(-1j * self.cam.reachable(theta))
        return np.asarray(seen.ravel())

    @cached_property
    def _base(self) -> Base:
        b, f = self.base, self.frame
        return Base(
            b.face, self.cam.follower.pivot.real, f.axle, f.axle_flange, f.slide_at, self.swing, b.thickness, b.wall,
            self.slide, b.slot_room, b.window,
        )  # fmt: skip

    @cached_property
    def _frame(self) -> Frame:
        f, follower = self.frame, self.cam.follower
        inside = swept_box(self.rims) + complex(f.gap, -f.gap)
        return Frame(
            follower.arm, follower.tip_radius, inside, f.arm, f.axle + self.press, f.slide_at,
            SCREWS[self.nozzle.screw].clearance, self.nozzle.spacing, self.pin, self.thickness, f.wall,
        )  # fmt: skip

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
        arm = self.cam.follower
        deep = overlap(plate.region, self.rims, (arm.arm, arm.tip_radius + f.gap))
        if deep > 0:
            raise DesignError(
                "overlap of frame and cam", deep, 0.0, "mm", "frame, over the turn",
                "use a narrower frame.arm, a larger frame.gap or a smaller swing",
            )  # fmt: skip
        height = self.base.thickness + self.base.gap + count * self.thickness
        made = [
            self.cam_part,
            plate,
            self._base.part(self.min_wall),
            axle(f.axle, height, f.axle_flange, f.flange_thickness),
            spacer("axle-washer", "Washer of an axle", f.axle + self.slide, f.axle_flange, self.base.gap, self.min_wall, 2),
        ]
        if self.pair:
            made.append(self._spacer())
        if self.plain:
            made += [self._collet.sleeve(self.min_wall), self._collet.ring()]
        glued = ("pressed and glued",)
        if self.pins and self._cam_pin_length > self.thickness:
            diameter = self.pin - self.press
            made.append(rod("cam-pin", "Pin of the cams", diameter, self._cam_pin_length, len(self.pins), glued))
        if self.pair and self.pin:
            made.append(rod("frame-pin", "Pin of the frames", self.pin - self.press, 2 * self.thickness, 2, glued))
        return tuple(made)

    @property
    def _cam_pin_length(self) -> float:
        bottom = self.foot - (self.slide if self.pair else 0.0)
        return self.top - bottom + (self.collet.flange if self.plain else 0.0)

    def _spacer(self) -> Part:
        """Washer between the cams, small enough to pass between the tips."""
        room = float(np.min(np.abs(facet_contour(self.cam.outline, _LAYOUT)))) - self.slide
        reach = max([self.bore / 2 + self.wall, *(abs(z) + self.pin / 2 + self.wall for z in self.pins)])
        return spacer(
            "cam-spacer", "Spacer between the cams", self.bore + self.slide, 2 * min(room, reach), 2 * self.slide,
            self.min_wall, 1, [(z, self.pin) for z in self.pins],
        )  # fmt: skip

    # ---- mounting ---------------------------------------------------------------------------------------------------

    def assembly(self, reachable: Callable[[Floats], Floats]) -> Assembly:
        """Where every copy is and how it moves; reachable: follower angle over the cam angle, rad."""
        shaft = Drive("cam", 0j, lambda theta: theta)
        swing = Drive("follower", self.cam.follower.pivot, reachable)
        still = Drive("ground", 0j, np.zeros_like)
        f, t = self.frame, self.thickness
        low = self.foot - (self.slide if self.pair else 0.0)
        beyond = complex(f.slide_at)
        mounts = [Mount("base", still), Mount("cam", shaft, z=low), Mount("frame", swing, z=self.foot)]
        if self.pair:
            mounts.append(Mount("cam", shaft, z=self.top - t, flipped=True))
            mounts.append(Mount("frame", swing, z=self.foot + t, flipped=True, turned=math.pi))
            mounts.append(Mount("cam-spacer", shaft, z=low + t))
            mounts += [Mount("frame-pin", swing, at=z, z=self.foot) for z in self._frame.pins]
        for at in (0j, beyond):
            mounts.append(Mount("axle", swing, at=at, z=-f.flange_thickness))
            mounts.append(Mount("axle-washer", swing, at=at, z=self.base.thickness))
        if self.plain:
            mounts.append(Mount("collet", shaft, z=self.top))
            mounts.append(Mount("clamp-ring", shaft, z=self.top + self.collet.flange + self._collet.travel))
        if self._cam_pin_length > t:
            mounts += [Mount("cam-pin", shaft, at=z, z=low) for z in self.pins]
        made = {part.name for part in self._made}
        return Assembly(
            tuple(mount for mount in mounts if mount.part in made), self._stand_ins(shaft, swing, still), self._touching(),
            0.8 * self.slide / 2 - 2 * self.chord_tolerance,
        )  # fmt: skip

    def _stand_ins(self, shaft: Drive, swing: Drive, still: Drive) -> tuple[StandIn, ...]:
        """Bought things as stacks of discs."""
        face, screw = self.base.face, SCREWS[self.nozzle.screw]
        floor = self.base.thickness - self._base.pocket_depth
        heads = [(z, face.screw.head / 2, floor, floor + face.screw.height) for z in face.screws]
        last = self.foot + (2 if self.pair else 1) * self.thickness
        nominal = float(screw.thread[1:]) / 2
        tail = complex(self.frame.slide_at, self.nozzle.spacing / 2)
        nozzle = [
            disc
            for z in (tail, tail.conjugate())
            for disc in ((z, nominal, self.foot, last), (z, screw.head / 2, last, last + screw.height))
        ]
        bought = [
            StandIn("motor screws", still, tuple(heads)),
            StandIn("nozzle screws", swing, tuple(nozzle)),
        ]
        boss = min(face.boss_height, self.base.thickness)
        if boss:
            bought.append(StandIn("motor boss", still, ((0j, face.boss / 2, 0.0, boss),)))
        bought.append(StandIn("shaft", shaft, ((0j, self.bore / 2, boss, self.shaft_length),)))
        return tuple(bought)

    def _touching(self) -> dict[frozenset[str], float]:
        """Pairs that touch by intent, and the overlap that this may show."""
        spare = 4 * self.chord_tolerance
        pairs = [("collet-1", "clamp-ring-1")]
        pairs += [("shaft", name) for name in ("cam-1", "cam-2")]
        for pin in ("cam-pin-1", "cam-pin-2"):
            pairs += [(pin, name) for name in ("cam-1", "cam-2", "cam-spacer-1", "collet-1")]
        for plate in ("frame-1", "frame-2"):
            pairs += [(plate, name) for name in ("axle-1", "axle-2", "frame-pin-1", "frame-pin-2")]
        tips = [(f"frame-{k}", f"cam-{k}") for k in (1, 2)]
        overlaps = [(pair, _PRESSED) for pair in pairs] + [(pair, _ROLLING) for pair in tips]
        return {frozenset(pair): overlap + spare for pair, overlap in overlaps}

    def bought(self) -> tuple[Bought, ...]:
        """What is bought, by its standard."""
        face, screw = self.base.face, SCREWS[self.nozzle.screw]
        name = f"{face.name.upper().replace('-', ' ')} frame" if face.name != "flange" else "with a plain flange"
        standard = "NEMA ICS 16" if face.name != "flange" else ""
        reach = math.ceil(self.base.thickness - face.screw.height + float(face.screw.thread[1:]) * 1.5)
        through = math.ceil((2 if self.pair else 1) * self.thickness)
        return (
            Bought("motor", standard, f"{name}, shaft {self.bore:g} x {self.shaft_length:g} over its face", 1),
            Bought("screw of the motor", face.screw.standard, f"{face.screw.thread} x {reach}", len(face.screws)),
            Bought("screw of the nozzle", screw.standard, f"{screw.thread} x {through} and what the nozzle takes", 2),
        )


def machine_faults(
    slide: float, press: float, pin: float, min_wall: float, base: BaseTable, frame: FrameTable
) -> Sequence[tuple[bool, str, float, str]]:
    """Checks between keys of the machine: (holds, path, value, what would be right)."""
    return (
        (slide > 0, "print.slide_clearance", slide, "more than 0: the cams and frames of a machine turn past each other"),
        (frame.arm >= min_wall, "frame.arm", frame.arm, f"at least limits.min_wall, {min_wall:g} mm"),
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
