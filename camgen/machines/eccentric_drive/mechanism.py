"""The eccentric drive of a needle machine: an eccentric disc on the motor's shaft, a rod with a strap round it, a slider.

       .---.
      /  E--\\------------------------- P ==>     O shaft (origin), E the disc's centre, OE = eccentricity,
      \\  O  /                         slider      EP = rod, P the slider's pin on the guide y = offset, along x
       '---'

A slider-crank: the disc is a crank as long as its centre is off the shaft, however large it is. The output is the way of
P from its outermost place towards the shaft, mm.
[Sviridov, Vladimirov, Chusovitin, study of the crank-slider mechanism of a tattoo machine, with its table corrected]
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Annotated, ClassVar

import numpy as np
from pydantic import Field

from camgen.errors import DesignError, Fault, Key
from camgen.findings import Finding, Where, at_least, at_most
from camgen.geometry.outlines import Contour, Floats, Region, circle, polygon, rectangle
from camgen.machine import model
from camgen.machine.closed_form import refuse_gap, slider_travel
from camgen.machine.features import Asked, Mount
from camgen.machines.eccentric_drive.assembly import body_plate, bought, features_of, mounts_of
from camgen.machines.eccentric_drive.study import Masses, study
from camgen.machines.eccentric_drive.tables import Geometry, Limits, Motor, Parts
from camgen.machines.eccentric_drive.tube import FACETS, NeedleTube, tube_checks
from camgen.machines.loads.counterweights import (
    Counterweight,
    ShaftSeat,
    ShaftWeight,
    found_moment,
)
from camgen.machines.loads.weights import weighed
from camgen.machines.mechanism import Mechanism
from camgen.parts.assembly import Assembly, MotorSeat
from camgen.parts.catalogue import SCREWS, TURNED, Screw
from camgen.parts.hardware import headed, plate
from camgen.parts.inertia import Solids
from camgen.parts.part import Held, Layer, Part, hull
from camgen.study import Study
from camgen.tolerances import SAME_POINT


class EccentricDrive(Mechanism):
    """Spec and answers of an eccentric drive; the output is the slider's way from its outermost place, mm."""

    fixed: ClassVar[str] = "pressed"

    geometry: Geometry
    motor: Motor
    making: Annotated[Parts, Field(alias="parts")] = Parts.model_construct()
    masses: Masses | None = None
    counterweight: Counterweight | None = None
    allowed: Annotated[Limits, Field(alias="limits")] = Limits.model_construct()

    def faults(self) -> Sequence[Fault]:
        """What is wrong between keys that are right one by one."""
        p, motor, slide = self.making, self.motor, self.print.slide_clearance
        nozzle = f"at least the nozzle, {self.print.nozzle:g} mm"
        thin: list[tuple[Key, float]] = [(("limits", "min_wall"), self.allowed.min_wall)]
        thin += [
            (("parts", key), getattr(p, key))
            for key in ("strap_wall", "flange", "rod_thickness", "body_thickness")
        ]
        checks = [(value >= self.print.nozzle, path, value, nozzle) for path, value in thin]
        room, floor = p.slider_thickness + slide, p.slider_thickness - self.print.nozzle
        screw, shaft = SCREWS[p.screw].clearance, self.geometry.shaft_diameter
        checks += [
            (
                p.flange < room,
                ("parts", "flange"),
                p.flange,
                f"less than {room:g} mm, so that it clears the body",
            ),
            (
                p.wire_diameter <= floor,
                ("parts", "wire_diameter"),
                p.wire_diameter,
                f"at most {floor:g} mm, so that a floor as thick as the nozzle stays in the slider",
            ),
            (
                p.pin_diameter < p.slider_width,
                ("parts", "pin_diameter"),
                p.pin_diameter,
                "less than slider_width",
            ),
            (
                p.wire_diameter < p.slider_width,
                ("parts", "wire_diameter"),
                p.wire_diameter,
                "less than slider_width",
            ),
            (
                screw < p.rail_width,
                ("parts", "rail_width"),
                p.rail_width,
                f"more than the screw's hole, {screw:g} mm",
            ),
            (
                screw < p.cover_length,
                ("parts", "cover_length"),
                p.cover_length,
                f"more than the screw's hole, {screw:g} mm",
            ),
            (
                motor.boss_diameter > shaft,
                ("motor", "boss_diameter"),
                motor.boss_diameter,
                f"more than its shaft, {shaft:g} mm",
            ),
            (
                motor.diameter > motor.boss_diameter,
                ("motor", "diameter"),
                motor.diameter,
                "more than boss_diameter",
            ),
        ]
        checks += tube_checks(p, slide, floor, 2 * self.rim)
        found = [*(self.counterweight.faults() if self.counterweight else ())]
        for name in ("stroke", "strokes_per_s"):
            low, high = getattr(self.allowed, name) or (0.0, 1.0)
            checks.append((low < high, ("limits", name), low, "the least first, then the greatest"))
        return [
            *found,
            *(
                Fault(path, f"{value:g}", expected)
                for fine, path, value, expected in checks
                if not fine
            ),
        ]

    # ---- motion -----------------------------------------------------------------------------------------------------

    def _unloaded(self) -> model.Machine:
        """Disc (O-E), rod (E-P) and slider on its guide, with [masses] where given; output "travel", mm.

        Raises DesignError with the angles where the rod does not reach the guide.
        """
        g, ground = self.geometry, model.GROUND
        needed, across = g.eccentricity + abs(g.offset), 1j * g.offset
        worst = 270.0 if g.offset > 0 else 90.0
        if needed > g.rod:
            sines = [(g.offset + side * g.rod) / g.eccentricity for side in (1, -1)]
            turns = [math.degrees(math.asin(sine)) for sine in sines if abs(sine) <= 1]
            refuse_gap("P", needed - g.rod, worst, [*turns, *(180 - turn for turn in turns)])
        if g.rod - needed <= SAME_POINT:
            raise DesignError(
                "geometry.rod",
                g.rod,
                needed,
                "mm",
                f"crank angle {worst:g} deg",
                "these lengths make a change point: the rod stands square to the guide, the slider can stall; use a longer rod",
            )
        disc, rod, slider = (self.masses or Masses.none()).bodies(g.eccentricity, g.rod)
        start, end = (
            complex(g.eccentricity),
            g.eccentricity + math.sqrt((g.rod - g.offset) * (g.rod + g.offset)) + across,
        )
        outermost = model.Place(ground, self.outermost + across)
        play, press = self.print.slide_clearance, self.print.press_clearance
        return model.Machine(
            (model.Body(ground), disc, rod, slider),
            (
                model.Pin("O", disc.at("O"), model.Place(ground), 2 * press),
                model.Pin("E", rod.at("E"), disc.at("E"), play),
                model.Pin("P", slider.at("P"), rod.at("P"), play + press),
                model.Slide("guide", outermost, slider.at("P"), math.pi, 0.0, play),
            ),
            (model.Drive("motor", "disc"),),
            {
                "disc": model.Pose(0j, 0.0),
                "rod": model.Pose(start, cmath.phase(end - start)),
                "slider": model.Pose(end, 0.0),
            },
            outputs=(model.Output("travel", model.Along("guide")),),
            speed=self._speed,
        )

    @cached_property
    def outermost(self) -> float:
        """The slider pin's greatest x, mm: crank and rod in one line."""
        g = self.geometry
        return math.sqrt((g.rod + g.eccentricity - g.offset) * (g.rod + g.eccentricity + g.offset))

    def motion(self, theta: Floats, order: int = 0) -> Floats:
        """Way of the slider from its outermost place towards the shaft, mm, or its derivative to theta, (n,)."""
        g = self.geometry
        if order == 0:
            begun = 0.0
            if g.offset:  # at theta = 0 the slider is not outermost; the difference of two squares, without cancellation
                at_zero = g.eccentricity + math.sqrt((g.rod - g.offset) * (g.rod + g.offset))
                begun = self.outermost - at_zero
            return begun + slider_travel(theta, g.eccentricity, g.rod, g.offset)
        return np.asarray(self.solve(theta, order).derivatives("travel")[order], float).reshape(
            np.shape(theta)
        )

    # ---- parts ------------------------------------------------------------------------------------------------------

    @cached_property
    def bore(self) -> float:
        """Of the disc, mm."""
        return self.geometry.shaft_diameter + self.print.press_clearance

    @cached_property
    def _inner(self) -> tuple[float, float]:
        """Least x of the slider and greatest of the rod's end, mm."""
        g, p = self.geometry, self.making
        x_in = math.sqrt((g.rod - g.eccentricity) ** 2 - g.offset**2)
        return x_in - p.slider_width / 2, self.outermost + max(
            self._eye_radius, p.pin_diameter / 2 + 1
        )

    @cached_property
    def _eye_radius(self) -> float:
        p = self.making
        return (p.pin_diameter + self.print.slide_clearance) / 2 + p.strap_wall

    @cached_property
    def _strap_radius(self) -> float:
        return (
            self.geometry.eccentric_diameter + self.print.slide_clearance
        ) / 2 + self.making.strap_wall

    @cached_property
    def _slider_front(self) -> float:
        """How far the slider reaches outwards from its pin, mm: past rod and cover at its innermost place."""
        start, rod_end = self._inner
        return rod_end + 1 + self.making.cover_length - (start + self.making.slider_width / 2)

    @cached_property
    def assembly(self) -> Assembly:
        """Motor bar, body with rails, slider, disc with flange, rod with strap, keeper washer, cover, wire clamp and pin; tube
        and counterweight where they are asked for.

        Disc and washer turn, the rod follows, slider, pin and clamp shift; the others stand still.
        """
        parts, mounts, weight = self.own_parts, self.own_mounts, self.weight
        if weight is not None:
            parts = (*parts, *weight.parts)
            mounts = (*mounts, *weight.mounts(self.shaft_length - weight.part.thickness))
        made = self._assembly(parts, mounts, features_of(self))
        return replace(
            made,
            asked=(Asked("travel", self.motion, stroke=True, lash=self.allowed.lash),),
            balances=() if weight is None else (weight.balance(made.solids),),
            stand_ins=(self.tube.needle(),) if self.tube else (),
            bought=bought(self),
            motor=MotorSeat(reach=self.shaft_length),
        )

    @cached_property
    def weight(self) -> ShaftWeight | None:
        """The counterweight on the motor's shaft, over the keeper washer, against disc, rod and slider."""
        if self.counterweight is None:
            return None
        hub = self.bore / 2 + max(self.making.strap_wall, self.allowed.min_wall)
        note = Held(
            "press and glue on the motor's shaft above the keeper washer, across from the disc's thick side as drawn"
        )
        solids = Solids(self.own_parts, self.own_mounts, self._process.density)
        machine = weighed(self.model, solids, self.load).machine
        seat = ShaftSeat(
            hub,
            circle(0j, self.bore / 2),
            self.making.rod_thickness,
            self.allowed.min_wall,
            self.print,
            note,
        )
        return ShaftWeight(self.counterweight, "disc", solids, machine, seat)

    def _found(self) -> Mapping[str, object]:
        """The moment of a counterweight, and what every mechanism fills in."""
        return {**super()._found(), **(found_moment(self.weight.moment) if self.weight else {})}

    @cached_property
    def own_parts(self) -> tuple[Part, ...]:
        """All but a counterweight."""
        g, p, wall = self.geometry, self.making, self.allowed.min_wall
        self._check_sizes()
        slide, press = self.print.slide_clearance, self.print.press_clearance
        bore, pin_hole = circle(0j, self.bore / 2), p.pin_diameter + press
        keeper = Region(circle(complex(g.eccentricity), self._strap_radius), (bore,))
        rim = Region(circle(complex(g.eccentricity), g.eccentric_diameter / 2), (bore,))
        disc_height = p.rod_thickness + slide
        disc = Part(
            "disc",
            "Eccentric disc",
            (Layer(keeper, 0.0, p.flange), Layer(rim, p.flange, p.flange + disc_height)),
            centres=(0j, complex(g.eccentricity)),
            min_wall=wall,
            cut=1,
            notes=(
                Held("press on the motor's shaft, flange below"),
                "cut from sheet, the flange is a second washer",
            ),
        )
        washer = Part(
            "washer",
            "Keeper washer",
            (Layer(keeper, 0.0, p.flange),),
            centres=(0j,),
            notes=(Held("press on the shaft above the disc, in line with its flange"),),
            min_wall=wall,
        )
        outline = hull([(0j, self._strap_radius), (complex(g.rod), self._eye_radius)])
        eyes = (
            circle(0j, (g.eccentric_diameter + slide) / 2),
            circle(complex(g.rod), (p.pin_diameter + slide) / 2),
        )
        rod = Part(
            "rod",
            "Connecting rod with strap",
            (Layer(Region(outline, eyes), 0.0, p.rod_thickness),),
            centres=(0j, complex(g.rod)),
            min_wall=wall,
        )
        tube = () if self.tube is None else (self.tube.part(),)
        return (
            body_plate(self),
            self._slider(pin_hole),
            disc,
            rod,
            washer,
            self._cover(),
            self._clamp(),
            self._pin(),
            self._motor_bar(),
            *tube,
        )

    def _check_sizes(self) -> None:
        """Raise DesignError where the disc has no wall, the strap meets the guide, or rod and slider cannot be made."""
        g, need = self.geometry, self.allowed.min_wall
        thin = g.eccentric_diameter / 2 - g.eccentricity - self.bore / 2
        if thin < need - SAME_POINT:
            works = 2 * (need + g.eccentricity + self.bore / 2)
            raise DesignError(
                "MIN_WALL of the eccentric disc",
                thin,
                need,
                "mm",
                "the thin side of its bore",
                f"D/2 - e - d/2 must reach it: geometry.eccentric_diameter of {works:g} mm or more works",
            )
        self.model  # noqa: B018  refuses what does not close, before roots of negative numbers are taken
        seat = self._inner[0] - (self.motor.boss_diameter + self.print.press_clearance) / 2
        if seat < need:
            raise DesignError(
                "wall between the motor's seat and the guide",
                seat,
                need,
                "mm",
                "body",
                "use a longer rod or a motor with a smaller boss_diameter",
            )
        room = self._inner[0] - self._strap_radius - g.eccentricity
        if room < self.print.slide_clearance:
            raise DesignError(
                "geometry.rod",
                g.rod,
                g.rod - room + self.print.slide_clearance,
                "mm",
                "the slider's innermost place",
                "the flange would meet the slider: use a longer rod or a smaller disc",
            )

    @cached_property
    def screw(self) -> Screw:
        """Of cover, motor, wire clamp, tube and mounting."""
        return SCREWS[self.making.screw]

    @cached_property
    def rim(self) -> float:
        """Radius of the material round a screw's hole, mm."""
        return self.screw.clearance / 2 + max(
            self.making.strap_wall, self.allowed.min_wall + FACETS
        )

    @cached_property
    def head(self) -> tuple[float, float, complex]:
        """Of the slider's head, always outside the guide: its begin and length along x, and its upper screw, mm."""
        p, screw = self.making, self.screw
        aside = p.wire_diameter / 2 + self.allowed.min_wall + FACETS + screw.clearance / 2
        length = 2 * max(
            screw.head / 2 + 1, self.rim + 0.2
        )  # 0.2: the clamp is so much shorter at both ends
        return self._slider_front + 1, length, complex(self._slider_front + 1 + length / 2, aside)

    @cached_property
    def hook(self) -> float:
        """Where the needle's groove begins, past the rod's end, from the slider's pin, mm."""
        return self._inner[1] - self.outermost + 1 + self.making.wire_diameter

    @cached_property
    def tube(self) -> NeedleTube | None:
        """What guides the needle beyond the slider; None where no length is given."""
        return NeedleTube(self) if self.making.tube_length else None

    def _slider(self, pin_hole: float) -> Part:
        """Block on the guide: pin hole at the origin, along x a groove for the needle's wire, two screws for its clamp."""
        p, (neck, length, screw) = self.making, self.head
        half, groove, front = p.slider_width / 2, p.wire_diameter / 2, neck + length
        wide = max(half, screw.imag + self.rim)
        hook = self.hook
        rear = [complex(-half, half), complex(-half, -half)]
        shoulder = [complex(neck, -half), complex(neck, -wide)] if wide > half else []
        under = [*rear, *shoulder, complex(front, -wide)]
        over = [z.conjugate() for z in reversed(under[2:])]

        def slot(end: float) -> list[complex]:
            return [
                complex(end, -groove),
                complex(hook, -groove),
                complex(hook, groove),
                complex(end, groove),
            ]

        shank = polygon([*rear, complex(neck, -half), *slot(neck), complex(neck, half)])
        holes = {"pin": circle(0j, pin_hole / 2)}
        screws = {
            f"clamp screw {k}": circle(z, self.screw.clearance / 2)
            for k, z in enumerate((screw.conjugate(), screw), 1)
        }
        wall, floor = self.allowed.min_wall, p.slider_thickness - p.wire_diameter
        proud = p.slider_thickness - p.wire_diameter / 4
        layers = (
            Layer(plate("slider", polygon([*under, *over]), holes | screws, wall), 0.0, floor),
            Layer(
                plate("slider", polygon([*under, *slot(front), *over]), holes | screws, wall),
                floor,
                proud,
            ),
            Layer(plate("slider", shank, holes, wall), proud, p.slider_thickness),
        )
        return Part(
            "slider",
            "Needle holder",
            layers,
            centres=(0j, screw.conjugate(), screw),
            min_wall=wall,
            notes=(
                "the needle's wire lies in the groove",
                "clamp, screws and nuts hold it at the head",
            ),
        )

    def _clamp(self) -> Part:
        """Plate over the wire at the slider's head; its origin is its middle."""
        _, length, screw = self.head
        half = complex(length / 2 - 0.2, max(self.making.slider_width / 2, screw.imag + self.rim))
        note = Held("screws and nuts hold it on the needle's wire")
        return self._bored(
            "clamp",
            "Wire clamp",
            rectangle(-half, half),
            screw.imag,
            self.making.rod_thickness,
            0.0,
            (note,),
        )

    def _cover(self) -> Part:
        middle = self.rail[2]
        half = complex(self.making.cover_length / 2, middle + self.making.rail_width / 2)
        return self._bored(
            "cover", "Guide cover", rectangle(-half, half), middle, self.making.rod_thickness
        )

    def _motor_bar(self) -> Part:
        """Bar behind the motor, drawn to the body by two long screws; its hole takes a boss at the motor's rear."""
        boss, screw = (
            (self.motor.boss_diameter + self.print.slide_clearance) / 2,
            1j * self.motor_screw,
        )
        wall = max(self.making.strap_wall, self.allowed.min_wall + FACETS)
        outer = hull([(-screw, self.rim), (0j, boss + wall), (screw, self.rim)])
        note = "behind the motor; two long screws draw both to the body"
        return self._bored(
            "motor-bar", "Motor bar", outer, screw.imag, self.making.body_thickness, boss, (note,)
        )

    def _bored(
        self,
        name: str,
        title: str,
        outer: Contour,
        screw: float,
        height: float,
        boss: float = 0.0,
        notes: tuple[str, ...] = (),
    ) -> Part:
        """A plate with two screws at x = 0, y = +-screw, and in their middle a hole for a boss of this radius."""
        places = (-1j * screw, 1j * screw)
        holes = {"boss": circle(0j, boss)} if boss else {}
        holes |= {
            f"screw {k}": circle(z, self.screw.clearance / 2) for k, z in enumerate(places, 1)
        }
        layer, centres = (
            Layer(plate(name, outer, holes, self.allowed.min_wall), 0.0, height),
            (0j, *places) if boss else places,
        )
        return Part(
            name, title, (layer,), centres=centres, notes=notes, min_wall=self.allowed.min_wall
        )

    def _pin(self) -> Part:
        """Pin with a head, put in from above."""
        p, note = self.making, "press into the slider through the rod"
        made = TURNED if p.pins == "steel" else "printed"
        shank = p.slider_thickness + 3 * self.print.slide_clearance + p.rod_thickness
        return headed(
            "pin", "Slider pin", p.pin_diameter, shank, p.pin_diameter + 2, 1.0, 1, (note,), made
        )

    @cached_property
    def rail(self) -> tuple[float, float, float]:
        """Where the rails begin and end along x, and the middle of a rail from the guide's axis, mm."""
        p = self.making
        start = self._inner[0]
        end = start + p.slider_width / 2 + self._slider_front
        return start, end, (p.slider_width + self.print.slide_clearance + p.rail_width) / 2

    @cached_property
    def motor_screw(self) -> float:
        """Distance of the motor's two long screws from its shaft, beside its can and beside what turns, mm."""
        beside = self.motor.diameter / 2 + self.screw.clearance / 2
        return (
            max(beside, self.geometry.eccentricity + self._strap_radius + self.screw.head / 2) + 1
        )

    @cached_property
    def shaft_length(self) -> float:
        """How far the motor's shaft must reach over its face: to the upper side of the keeper washer, or counterweight, mm."""
        p, weight = self.making, self.counterweight
        washer = (
            p.body_thickness
            + p.slider_thickness
            + 3 * self.print.slide_clearance
            + p.rod_thickness
            + p.flange
        )
        return washer + (weight.thickness or p.rod_thickness if weight else 0.0)

    # ---- assembly ---------------------------------------------------------------------------------------------------

    @property
    def own_mounts(self) -> Sequence[Mount]:
        """The same without a counterweight."""
        return (*mounts_of(self), *((self.tube.mount(),) if self.tube else ()))

    # ---- checks and study -------------------------------------------------------------------------------------------

    def forecast(self) -> Sequence[Finding]:
        """Of the base, where disc, strap, rod and slider can be made."""
        self._check_sizes()
        return super().forecast()

    def limits(self) -> Sequence[Finding]:
        """Least transmission angle: of the rod against the square to the guide."""
        g = self.geometry
        self.model  # noqa: B018
        reach = (g.eccentricity + abs(g.offset)) / g.rod
        worst = math.degrees(math.acos(reach))
        theta = math.radians(270 if g.offset > 0 else 90)
        where = Where(theta=theta, angle="crank angle", digits=0)
        message = "90 deg less the rod's greatest tilt; a longer rod enlarges it"
        found = [
            at_least(
                "TRANSMISSION_ANGLE",
                worst,
                self.allowed.transmission_angle_deg,
                "deg",
                where,
                message,
            )
        ]
        stroke = round(self.outermost - self._inner[0] - self.making.slider_width / 2, 9)
        bands = (
            (
                "STROKE",
                stroke,
                self.allowed.stroke,
                "mm",
                Where("slider"),
                "twice geometry.eccentricity, in line",
            ),
            (
                "STROKE_RATE",
                abs(self.motor.speed_rpm) / 60,
                self.allowed.strokes_per_s,
                "1/s",
                Where("motor"),
                "motor.speed_rpm / 60",
            ),
        )
        for code, value, band, unit, where, message in bands:
            if band is not None:
                found.append(at_least(code, value, band[0], unit, where, message))
                found.append(at_most(code, value, band[1], unit, where, message))
        return [*found, *(self.tube.findings() if self.tube else ())]

    def study(self) -> Study:
        """Stroke, peak speed and its angle, harmonics, travel; the published table where the lengths are the paper's."""
        g = self.geometry
        numbers = {
            "stroke_mm": self.outermost - self._inner[0] - self.making.slider_width / 2,
            "motor_shaft_length_mm": self.shaft_length,
            "disc_wall_mm": g.eccentric_diameter / 2 - g.eccentricity - self.bore / 2,
        }
        found = study(
            self.model,
            self.motion,
            (g.eccentricity, g.rod, g.offset),
            self.motor.speed_rpm,
            self.masses is not None,
        )
        tube = self.tube
        sketches = (*found.sketches, *((tube.sketch(),) if tube else ()))
        return replace(
            found,
            numbers={**numbers, **(tube.numbers if tube else {}), **found.numbers},
            sketches=sketches,
        )
