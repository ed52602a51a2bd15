"""The whole printed machine round a uniform-swing cam: which parts, how large, and how they are mounted.

Heights, z = 0 at the base's underside, the motor below it: base, gap (washers on both axles), one frame plate or two on
each other. Where the plate itself is the tip, each plate lies level with its cam, the cams' middle plane is the frames', and
the spacer between the cams leaves each tip clear of the other's cam. Where tips are pins or bearings, the plates lie between
the cams (one plate: under its cam), and each tip stands out of its plate beside its cam.
The frame's own origin is the follower's pivot; the second plate is the first turned over about the line of centres.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from camgen.errors import DesignError
from camgen.geometry.facets import facet_contour
from camgen.geometry.outlines import Points, Region, circle
from camgen.machine.cams.profile import DiscCam
from camgen.machine.features import Mount, StandIn
from camgen.machine.model import GROUND
from camgen.machines.uniform_swing.cam_plate import CamPlate
from camgen.machines.uniform_swing.plates import Base, Frame, overlap, swept_box
from camgen.machines.uniform_swing.room import LEAST_AXLE
from camgen.machines.uniform_swing.tables import SwingSizes
from camgen.parts.catalogue import DOWEL_STANDARD, SCREWS, TURNED, Screw, dowel
from camgen.parts.disc_cams import LAYOUT
from camgen.parts.hardware import Collet, headed, plate, spacer
from camgen.parts.journals import Journal
from camgen.parts.part import Layer, Part, hull, rod
from camgen.study import Figure, Figures, Study

_TOUCHING = 0.1  # mm beyond the tip's own surface, where cam and finger may seem to overlap because the tip touches the cam
_RAIL = 20.0  # mm, height of the rails that are drawn for a stand
_FOOT = 4.0  # mm, thickness of the foot that is drawn for a nozzle
_PLACES = 361  # cam angles at which it does; `gap` is there for what lies between


@dataclass(frozen=True)
class SwingMachine:
    """All parts of the machine round a cam, and their mounting; lengths mm."""

    plate: CamPlate  # of the cam
    cam_part: Part  # the same as made

    @property
    def sizes(self) -> SwingSizes:
        """The tables from which the parts follow."""
        return self.plate.sizes

    @property
    def cam(self) -> DiscCam:
        """The cam as designed."""
        return self.plate.cam

    # ---- heights ----------------------------------------------------------------------------------------------------

    @property
    def thickness(self) -> float:
        """Of cam and frame alike."""
        return self.sizes.making.thickness

    @property
    def play(self) -> float:
        """Between what moves past each other, and of what turns in a hole."""
        return self.sizes.fits.slide_clearance

    @property
    def _floor(self) -> float:
        """Height of what moves lowest."""
        return self.sizes.base.thickness + self.sizes.base.gap

    @property
    def _beside(self) -> float:
        """How much higher a frame lies than the cam beside it, or lower: nothing where the plate is the tip."""
        return self.thickness + self.play if self.sizes.seat else 0.0

    @property
    def low(self) -> float:
        """Height of the first cam's underside."""
        if not self.sizes.pair:
            return self.foot + self._beside
        return self._floor - (0.0 if self.sizes.seat else self.play)

    @property
    def foot(self) -> float:
        """Height of the first frame's underside."""
        return self._floor + (self._beside if self.sizes.pair else 0.0)

    @property
    def last(self) -> float:
        """Height of the frames' upper side."""
        return self.foot + (2 if self.sizes.pair else 1) * self.thickness

    @property
    def top(self) -> float:
        """Height of the upper cam's upper side."""
        if not self.sizes.pair:
            return self.low + self.thickness
        return self.last + self.play + (self.thickness if self.sizes.seat else 0.0)

    @property
    def cam_pin_length(self) -> float:
        """Length of the pins through the cams and the collet's flange; 0 where there are none."""
        length = self.top - self.low + (self.sizes.collet.flange if self.sizes.plain else 0.0)
        return length if self.plate.pins and length > self.thickness else 0.0

    # ---- the shaft --------------------------------------------------------------------------------------------------

    @property
    def shaft_length(self) -> float:
        """Height of the collet's upper end, or of the upper cam, over the motor's face."""
        c = self.sizes.collet
        return self.top + (c.flange + c.length if self.sizes.plain else 0.0)

    @property
    def shaft_needed(self) -> float:
        """The least height at which it holds the upper cam."""
        return self.shaft_length - (self._collet.travel if self.sizes.plain else 0.0)

    @property
    def shaft_note(self) -> str:
        """What the motor's shaft has to be, and what it usually is."""
        base = self.sizes.base
        usual = base.face.shaft
        known = f" On a {base.face.title} {usual:g} mm is usual" if usual else ""
        length = " and 24 mm long" if base.motor == "nema-17" else ""
        return f"The motor's shaft must be {self.shaft_size}.{known}{length}{'.' if known else ''}"

    @property
    def shaft_size(self) -> str:
        """Diameter and length of the shaft."""
        p = self.sizes.making
        thick = f"{p.bore:g} mm thick"
        reach = f"{self.shaft_length:g} mm long beyond its face"
        if self.sizes.plain:
            return f"{thick} and {self.shaft_needed:g} to {reach}"
        flat = f", with a flat {p.flat_depth:g} deep," if p.bore_shape == "d-flat" else ""
        return f"{thick}{flat} and {reach}"

    # ---- base and frame ---------------------------------------------------------------------------------------------

    @cached_property
    def rims(self) -> Points:
        """Edge of the cam at many cam angles, seen from the frame, (n,)."""
        follower = self.cam.follower
        theta = np.linspace(0, math.tau, _PLACES)[:, None]
        turned = self.plate.rim * np.exp(1j * theta) - follower.pivot
        return np.asarray((turned * np.exp(-1j * self.cam.reachable(theta))).ravel())

    @cached_property
    def base_plate(self) -> Base:
        """The base as a shape."""
        b = self.sizes.base
        f = self.sizes.frame
        return Base(
            b.face,
            self.cam.follower.pivot.real,
            self.axle,
            f.axle_flange,
            f.slide_at,
            self.plate.room.swing,
            b.thickness,
            b.wall,
            self.play,
            b.slot_room,
            b.window,
            SCREWS.get(b.mount),
        )

    @cached_property
    def _frame(self) -> Frame:
        """The frame; its finger, which widens towards the arm, is straight where the cam passes too near for that."""
        wide = self._frame_with(False)
        return self._frame_with(True) if self._overlap(wide) else wide

    def _overlap(self, frame: Frame) -> float:
        """How deep the cam comes into the plate that is itself the tip, mm, 0 if it does not."""
        s = self.sizes
        arm = self.cam.follower
        tip = arm.arm, arm.tip_radius + min(s.frame.gap, _TOUCHING)
        return 0.0 if s.seat else overlap(frame.part(s.min_wall).region, self.rims, tip)

    def _frame_with(self, straight: bool) -> Frame:
        s = self.sizes
        screw = SCREWS[s.nozzle.screw]
        return Frame(
            self.cam.follower.arm,
            s.boss,
            self._inside,
            s.frame.arm,
            self._axle_hole,
            s.frame.slide_at,
            screw.clearance,
            s.nozzle.spacing,
            s.making.pin_diameter,
            self.thickness,
            s.frame.wall,
            s.tip_hole,
            (screw.flats + self.play, screw.nut),
            self._hub,
            straight,
        )

    # ---- what is made smaller where there is no room -----------------------------------------------------------------

    @cached_property
    def _inside(self) -> complex:
        """How near the cam comes to the pivot and to the frame's arm, room included: see `Frame.inside`."""
        gap = self.sizes.frame.gap
        return swept_box(self.rims) + complex(gap, -gap)

    @cached_property
    def axle(self) -> float:
        """Diameter of both axles, mm: as wanted, or what leaves the least wall between axle and cam."""
        wanted = self.sizes.frame.axle
        min_wall = self.sizes.min_wall
        fit = max(self.sizes.fits.press_clearance, self.play)
        room = math.floor(10 * (2 * (-self._inside.real - min_wall - LAYOUT) - fit)) / 10
        least = min(wanted, LEAST_AXLE)
        if room < least:
            raise DesignError(
                "room for the axle's hub",
                -self._inside.real,
                (least + fit) / 2 + min_wall + LAYOUT,
                "mm",
                f"the frame beside the pivot, for an axle of {least:g} mm with limits.min_wall",
                f"the cam comes too near the pivot: {self.plate.room.remedy()}",
            )
        return min(wanted, room)

    @property
    def _axle_hole(self) -> float:
        return self.axle + self.sizes.fits.press_clearance

    @property
    def _hub(self) -> float:
        """Radius of the frame round the pivot's axle."""
        return min(self._axle_hole / 2 + self.sizes.frame.wall, -self._inside.real)

    @property
    def _sleeve_wall(self) -> float:
        """Wall of the collet: as wanted, or what the pins leave."""
        wall = self.sizes.collet.wall
        pin = self.sizes.making.pin_diameter
        free = min((abs(z) - pin / 2 for z in self.plate.pins), default=math.inf)
        return min(wall, wall + free - self.plate.room.collet(wall).radius)

    @cached_property
    def _rim(self) -> Points:
        return facet_contour(self.cam.outline, LAYOUT)

    @property
    def smaller(self) -> tuple[str, ...]:
        """What is smaller than wanted, for people; nothing where all has room."""
        s = self.sizes
        sizes = [
            ("frame.axle", s.frame.axle, self.axle),
            ("frame.wall round the pivot", s.frame.wall, self._hub - self._axle_hole / 2),
            ("parts.wall round the cams' pins", s.making.wall, self.plate.pin_wall),
        ]
        sizes += [("collet.wall", s.collet.wall, self._sleeve_wall)] if s.plain else []
        less = [
            f"{name} {made:.3g} instead of {wanted:g}"
            for name, wanted, made in sizes
            if made < wanted - LAYOUT
        ]
        said = (
            f"Some sizes are smaller than usual, because there is no room, mm: {'; '.join(less)}."
        )
        return (said,) if less else ()

    @cached_property
    def tip_pin(self) -> float:
        """Length of the dowel pin at the tip; DesignError where none is sold, or its bearing does not fit beside the plate."""
        seat = self.sizes.seat
        bearing = self.sizes.frame.bearing
        longest = 2 * self.thickness + self.play
        length = dowel(seat, longest)
        held = max(self.thickness / 2, bearing.width if bearing else 0.0)
        needed = self.thickness + self.play + held
        if length < needed:
            raise DesignError(
                "dowel pin of the tip",
                length,
                needed,
                "mm",
                f"{DOWEL_STANDARD}, diameter {seat:g} mm, at most {longest:g} mm",
                "use another parts.thickness or another frame.tip",
            )
        return length

    @cached_property
    def _collet(self) -> Collet:
        pin = self.sizes.making.pin_diameter
        reach = max(
            (abs(z) + pin / 2 + self.sizes.making.wall for z in self.plate.pins), default=0.0
        )
        plain = self.plate.room.collet(self._sleeve_wall)
        flange = max(plain.ring_diameter, 2 * reach)
        return replace(plain, flange_diameter=flange, pins=tuple((z, pin) for z in self.plate.pins))

    def study(self) -> Study:
        """The shaft's length, what the axle's play is to the swing, and what is to be said of sizes."""
        # the frame shifts on its axle by half the clearance, which turns it until the tip is on the cam again
        across = abs(self.cam.follower.arm) * math.cos(math.radians(self.cam.steepest))
        swing = math.degrees(self.play / 2 / across)
        found = [
            Figure("shaft length", self.shaft_length, "mm"),
            Figure("swing by play of axle", swing, "deg"),
        ]
        return Study(Figures(found), notes=(self.shaft_note, *self.smaller))

    # ---- parts ------------------------------------------------------------------------------------------------------

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        """Every printed part, the cam first; DesignError where sizes do not go together."""
        s = self.sizes
        f = s.frame
        frame = self.frame_part
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
            frame,
            self.base_plate.part(s.min_wall),
            replace(
                headed(
                    "axle",
                    "Axle with flange",
                    self.axle,
                    self.last + self.play,
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
                    self.axle + self.play,
                    min(f.axle_flange, -2 * self._inside.real),
                    self.foot - s.base.thickness,
                    s.min_wall,
                ),
                count=2,
            ),
        ]
        if s.pair:
            made.append(self._spacer())
        if s.plain:
            made += [self._collet.sleeve(s.min_wall), self._collet.ring()]
        return (*made, *self._pins(), *self._yours())

    @cached_property
    def frame_part(self) -> Part:
        """One of the plates that swing; its origin is the pivot."""
        s = self.sizes
        plate = self._frame.part(s.min_wall, 2 if s.pair else 1)
        if not s.seat:
            return plate
        pin = f"hole at the tip for a dowel pin {s.seat:g} m6 x {self.tip_pin:g}, {DOWEL_STANDARD}"
        return replace(plate, notes=(*plate.notes, pin))

    def _pins(self) -> list[Part]:
        """Those of the cams and of the frames."""
        s = self.sizes
        wanted = [("cam-pin", "Pin of the cams", self.cam_pin_length)]
        if s.pair and s.making.pin_diameter:
            wanted.append(("frame-pin", "Pin of the frames", 2 * self.thickness))
        diameter = s.making.pin_diameter - s.fits.press_clearance
        made = TURNED if s.making.pins == "steel" else "printed"
        return [
            replace(
                rod(name, title, diameter, length),
                count=2,
                notes=("pressed and glued",),
                process=made,
            )
            for name, title, length in wanted
            if length
        ]

    def _yours(self) -> list[Part]:
        """What you bring, drawn as far as it meets the machine: rails under the base, the foot of the nozzle."""
        s = self.sizes
        base = self.base_plate
        screw = SCREWS[s.nozzle.screw]
        tail = complex(0, s.nozzle.spacing / 2)
        spread = f"two screws {screw.thread}, {s.nozzle.spacing:g} mm apart"
        said = f"{spread}, {s.frame.slide_at:g} mm from the pivot, square to the frames' line"
        found = [_bar("nozzle-foot", "Foot of your nozzle", screw, _FOOT, (tail, -tail))]
        found[0] = replace(found[0], notes=(said, "the nozzle itself is yours"))
        if base.mount:
            ends = 0j, complex(base.pivot)
            rail = _bar("stand-rail", "Rail of your stand", base.mount, _RAIL, ends)
            free = s.frame.flange_thickness + self.play
            apart = abs(base.mounts[0] - base.mounts[1])
            notes = (
                f"two screws {base.mount.thread}, {base.pivot:.4g} mm apart; both rails {apart:.4g} mm apart",
                f"at least {free:g} mm high, for the axles' flanges; the motor hangs between them",
            )
            found.append(replace(rail, count=2, notes=notes))
        return found

    def _spacer(self) -> Part:
        """Washer between the cams, small enough to pass between the tips."""
        s = self.sizes
        washer = self.plate.room.washer
        pins = self.plate.pins
        assert washer is not None, "a pair has one"
        pin = s.making.pin_diameter
        wall = s.making.wall
        reach = max([washer.hole, *(abs(z) + pin / 2 for z in pins)])
        radius = min(reach + wall, float(np.min(np.abs(self._rim))) - washer.inset)
        edge = circle(0j, radius)
        if radius - reach < s.min_wall:  # no round one has room, but one as wide as its holes need
            wall = min(wall, washer.wall(self._rim, pins, pin))
            edge = hull([(0j, washer.hole + wall), *((z, pin / 2 + wall) for z in pins)])
        holes = {"bore": circle(0j, washer.hole)}
        holes |= {f"pin {k}": circle(z, pin / 2) for k, z in enumerate(pins, 1)}
        region = plate("cam-spacer", edge, holes, s.min_wall)
        return Part(
            "cam-spacer",
            "Spacer between the cams",
            (Layer(region, 0.0, self.top - self.low - 2 * self.thickness),),
            centres=(0j, *pins),
            bore=2 * washer.hole,
            min_wall=s.min_wall,
        )

    # ---- mounting ---------------------------------------------------------------------------------------------------

    @cached_property
    def mounts(self) -> tuple[Mount, ...]:
        """Every copy on cam, follower or ground."""
        s = self.sizes
        f = s.frame
        t = self.thickness
        low = self.low
        mounts = [
            Mount("base", GROUND),
            Mount("cam", "cam", z=low),
            Mount("frame", "follower", z=self.foot),
        ]
        if s.pair:
            mounts.append(Mount("cam", "cam", z=self.top - t, flipped=True))
            mounts.append(Mount("frame", "follower", z=self.foot + t, flipped=True, angle=math.pi))
            mounts.append(Mount("cam-spacer", "cam", z=low + t))
            mounts += [Mount("frame-pin", "follower", at=z, z=self.foot) for z in self._frame.pins]
        for at in (0j, complex(f.slide_at)):
            # so much end float
            mounts.append(Mount("axle", "follower", at=at, z=-f.flange_thickness - self.play))
            mounts.append(Mount("axle-washer", "follower", at=at, z=s.base.thickness))
        if s.plain:
            home = self.top + s.collet.flange + self._collet.travel
            mounts.append(Mount("collet", "cam", z=self.top))
            mounts.append(Mount("clamp-ring", "cam", z=home))
        if self.cam_pin_length:
            mounts += [Mount("cam-pin", "cam", at=z, z=low) for z in self.plate.pins]
        mounts.append(Mount("nozzle-foot", "follower", at=complex(f.slide_at), z=self.last))
        rails = self.base_plate.mounts[:2]
        mounts += [Mount("stand-rail", GROUND, at=z, z=-_RAIL) for z in rails]
        return tuple(mounts)

    def journals(self, printed: str) -> dict[str, Journal]:
        """The axle at the pivot: it turns in the base and is pressed into the frames."""
        thick = self.sizes.base.thickness
        lever = self.foot - thick / 2
        return {"pivot": Journal("pivot", self.axle, thick, lever, printed, printed)}

    def stand_ins(self) -> tuple[StandIn, ...]:
        """Bought things as stacks of discs."""
        s = self.sizes
        screw = SCREWS[s.nozzle.screw]
        p = s.making
        face = s.base.face
        base = self.base_plate
        floor = base.thickness - base.pocket_depth
        heads = [(z, sunk.head / 2, floor, floor + sunk.height) for z, sunk in base.sunk]
        last = self.last
        half = screw.nut / 2
        middle = self.foot + (self.thickness if s.pair else half)
        tail = complex(s.frame.slide_at, s.nozzle.spacing / 2)
        nozzle = [
            disc
            for z in (tail, tail.conjugate())
            for disc in (
                (z, screw.nominal / 2, self.foot, last + _FOOT),
                (z, screw.flats / 2, middle - half, middle + half),
                (z, screw.head / 2, last + _FOOT, last + _FOOT + screw.height),
            )
        ]
        bought = [
            StandIn("screws of motor and base", GROUND, tuple(heads)),
            StandIn("nozzle screws", "follower", tuple(nozzle)),
        ]
        boss = min(face.boss_height, s.base.thickness)
        if boss:
            bought.append(StandIn("motor boss", GROUND, ((0j, face.boss / 2, 0.0, boss),)))
        flat = p.flat_depth if p.bore_shape == "d-flat" else 0.0
        round_part = (-0.5j * flat, (p.bore - flat) / 2)  # the largest disc beside a flat
        bought.append(StandIn("shaft", "cam", ((*round_part, boss, self.shaft_length),)))
        tips = (
            StandIn(f"tip-{k}", "follower", discs, rolls=True)
            for k, discs in enumerate(self._tips(), 1)
        )
        return (*bought, *tips)

    def _tips(self) -> list[tuple[tuple[complex, float, float, float], ...]]:
        """Pin, and bearing, of each tip that is not the plate itself, as discs on the follower."""
        s = self.sizes
        arm = self.cam.follower.arm
        t = self.thickness
        if not s.seat:
            return []
        low = self.foot + t - self.tip_pin if s.pair else self.foot
        tips = [(arm, low, self.low)]  # place, height of its pin, height of its cam
        if s.pair:
            tips.append((arm.conjugate(), self.foot + t, self.top - t))
        found = []
        for z, below, cam in tips:
            discs = [(z, s.seat / 2, below, below + self.tip_pin)]
            if s.frame.bearing:
                half = s.frame.bearing.width / 2
                middle = cam + t / 2
                discs.append((z, s.frame.bearing.outside / 2, middle - half, middle + half))
            found.append(tuple(discs))
        return found


def _bar(name: str, title: str, screw: Screw, height: float, ends: tuple[complex, complex]) -> Part:
    """A bar with a hole for a screw at each end, which stands for a thing of the user's; mm."""
    outer = hull([(z, screw.head / 2) for z in ends])
    region = Region(outer, tuple(circle(z, screw.clearance / 2) for z in ends))
    layers = (Layer(region, 0.0, height),)
    return Part(name, f"{title}, not to be made", layers, centres=ends, process="dummy")
