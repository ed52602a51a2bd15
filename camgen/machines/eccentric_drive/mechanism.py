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

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Annotated, Any, ClassVar

import numpy as np
from pydantic import Field

from camgen.errors import DesignError, Fault
from camgen.findings import Finding, Where, at_least, at_most
from camgen.geometry.outlines import Floats
from camgen.machine.closed_form import refuse_gap, slider_travel
from camgen.machine.features import Demand
from camgen.machines.eccentric_drive.needle import Needle, rim
from camgen.machines.eccentric_drive.study import study
from camgen.machines.eccentric_drive.tables import (
    ELSEWHERE,
    OLD_WORDS,
    EccentricGeometry,
    EccentricLimits,
    EccentricMotor,
    EccentricSizes,
    Masses,
)
from camgen.machines.loads.counterweights import Counterweight
from camgen.machines.template import Template
from camgen.parts.generator.connections import Fitting
from camgen.parts.generator.discs import wall_of_disc
from camgen.parts.generator.layout import Layout
from camgen.study import Figure, Figures, Study
from camgen.tolerances import SAME_POINT
from camgen.vocabulary import OldWords

_LINKS = {"ground": ("O", "R", "S"), "disc": ("O", "E"), "rod": ("E", "P"), "slider": ("P",)}


class EccentricDrive(Template):
    """Spec and answers of an eccentric drive; the output is the slider's way from its outermost place, mm."""

    old_words: ClassVar[OldWords] = {**Template.old_words, **OLD_WORDS}

    geometry: EccentricGeometry
    motor: EccentricMotor
    making: Annotated[EccentricSizes, Field(alias="parts")] = Field(
        default=EccentricSizes.model_validate({}),
        description="sizes of its bodies, as [parts] of a linkage has them: see camgen schema",
    )
    masses: Masses | None = Field(
        default=None, description="adds joint forces and torque to the report"
    )
    counterweight: Counterweight | None = Field(
        default=None,
        description="a sector of a disc on the motor's shaft, over the keeper washer: balances the disc",
    )
    allowed: Annotated[EccentricLimits, Field(alias="limits")] = EccentricLimits.model_construct()

    def faults(self) -> Sequence[Fault]:
        """What is wrong between keys that are right one by one."""
        p = self.making
        motor = self.motor
        slide = self.print.slide_clearance
        found = [*p.faults(_LINKS, self.print.nozzle, self.allowed.min_wall)]
        for key, why in ELSEWHERE.items():
            if getattr(p, key) != type(p).model_fields[key].get_default(call_default_factory=True):
                found.append(Fault(("parts", key), "", f"no value here: {why}"))
        floor = p.slider_thickness - self.print.nozzle
        thin = floor - slide / 2 if p.tube_length else floor
        shaft = self.geometry.shaft_diameter
        least = 2 * rim(p, self.allowed.min_wall)
        straight = (
            "no value here without parts.tube_length: the wire's point stands out of the tube"
        )
        kept = "so that a floor as thick as the nozzle stays"
        nozzle = f"at least the nozzle, {self.print.nozzle:g} mm"
        checks = [
            (
                self.allowed.min_wall >= self.print.nozzle,
                ("limits", "min_wall"),
                self.allowed.min_wall,
                nozzle,
            ),
            (
                p.wire_diameter <= thin,
                ("parts", "wire_diameter"),
                p.wire_diameter,
                f"at most {thin:g} mm, {kept}",
            ),
            (
                p.wire_diameter < p.slider_width,
                ("parts", "wire_diameter"),
                p.wire_diameter,
                "less than slider_width",
            ),
            (
                p.pin_diameter < p.slider_width,
                ("parts", "pin_diameter"),
                p.pin_diameter,
                "less than slider_width",
            ),
            (
                not p.tube_length or p.tube_length >= least,
                ("parts", "tube_length"),
                p.tube_length,
                f"at least {least:.4g} mm, or 0: none",
            ),
            (
                bool(p.tube_length) or p.wire_length is None,
                ("parts", "wire_length"),
                p.wire_length or 0.0,
                straight,
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
        found += self.counterweight.faults() if self.counterweight else ()
        for name in ("stroke", "strokes_per_s"):
            low, high = getattr(self.allowed, name) or (0.0, 1.0)
            checks.append((low < high, ("limits", name), low, "the least first, then the greatest"))
        wrong = (
            Fault(path, f"{value:g}", expected)
            for fine, path, value, expected in checks
            if not fine
        )
        return [*found, *wrong]

    # ---- what it is as a linkage --------------------------------------------------------------------------------------

    def tables(self) -> Mapping[str, Any]:
        """Disc, rod and slider; the disc is a pin of its link, through which the motor's shaft goes."""
        g = self.geometry
        motor = self.motor
        p = self.making
        self._refuse_gap()
        outermost = self.outermost
        sum_ = g.rod**2 - g.offset**2
        pin = g.eccentricity + math.sqrt(max(0.0, sum_))
        bears = self.allowed.model_dump(exclude={"stroke", "strokes_per_s"})
        can = motor.model_dump(include={"boss_diameter", "diameter", "length"})
        shaft = {"shaft_diameter": g.shaft_diameter, "shaft_flat": 0.0}
        found = {
            "points": {
                "O": (0.0, 0.0),
                "E": (g.eccentricity, 0.0),
                "P": (pin, g.offset),
                "R": (outermost, g.offset),  # the guide, from the outermost place towards the shaft
                "S": (outermost - g.eccentricity, g.offset),
            },
            "links": _LINKS,
            "lengths": {"O-E": g.eccentricity, "E-P": g.rod},
            "drive": {"link": "disc", "speed_rpm": motor.speed_rpm},
            "slide": ({"link": "slider", "along": ("R", "S"), "name": "guide"},),
            "output": ({"name": "travel", "link": "slider"},),
            "parts": {
                **p.of_linkage(),
                **shaft,
                "discs": {"E": g.eccentric_diameter},
                "can": {**can, "screw": p.screw},
            },
            "limits": bears,
        }
        found |= {"masses": self.masses.of_linkage()} if self.masses else {}
        return found | ({"counterweight": self.counterweight} if self.counterweight else {})

    def _refuse_gap(self) -> None:
        """DesignError with the angles where the rod does not reach the guide, or where it stands square to that."""
        g = self.geometry
        needed = g.eccentricity + abs(g.offset)
        worst = 270.0 if g.offset > 0 else 90.0
        if needed > g.rod:
            sines = [(g.offset + side * g.rod) / g.eccentricity for side in (1, -1)]
            turns = [math.degrees(math.asin(sine)) for sine in sines if abs(sine) <= 1]
            refuse_gap("P", needed - g.rod, worst, [*turns, *(180 - turn for turn in turns)])
        if g.rod - needed <= SAME_POINT:
            at = f"crank angle {worst:g} deg"
            said = "these lengths make a change point: the rod is perpendicular to the guide, the slider can stall; use a longer rod"
            raise DesignError("geometry.rod", g.rod, needed, "mm", at, said)

    @cached_property
    def outermost(self) -> float:
        """The slider pin's greatest x, mm: crank and rod in one line."""
        g = self.geometry
        reach = (g.rod + g.eccentricity - g.offset) * (g.rod + g.eccentricity + g.offset)
        return math.sqrt(max(0.0, reach))

    @property
    def innermost(self) -> float:
        """Its least x, mm."""
        g = self.geometry
        return math.sqrt(max(0.0, (g.rod - g.eccentricity) ** 2 - g.offset**2))

    def motion(self, theta: Floats, order: int = 0) -> Floats:
        """Way of the slider from its outermost place towards the shaft, mm, or its derivative to theta, (n,)."""
        g = self.geometry
        if order == 0:
            begun = 0.0
            if g.offset:  # at theta = 0 the slider is not outermost; the difference of two squares, without cancellation
                at_zero = g.eccentricity + math.sqrt((g.rod - g.offset) * (g.rod + g.offset))
                begun = self.outermost - at_zero
            return begun + slider_travel(theta, g.eccentricity, g.rod, g.offset)
        return np.asarray(
            self.linkage.run(theta, order).derivatives("travel")[order], float
        ).reshape(np.shape(theta))

    def demands(self) -> tuple[Demand, ...]:
        """The slider's way."""
        return (Demand("travel", self.motion, stroke=True, lash=self.allowed.lash),)

    def refuse(self) -> None:
        """Raise DesignError where the disc has no wall."""
        g = self.geometry
        bore = g.shaft_diameter + self.print.press_clearance
        sizes = g.eccentric_diameter, bore, self.allowed.min_wall
        wall_of_disc(g.eccentricity, *sizes, "geometry.eccentric_diameter")

    # ---- the needle ---------------------------------------------------------------------------------------------------

    def fitting(self, layout: Layout) -> Fitting:
        """The needle's holder, clamp and tube."""
        return self._needle(layout).fitting()

    def _needle(self, layout: Layout) -> Needle:
        ends = self.innermost, self.outermost
        return Needle(self.making, layout, *ends, self.geometry.offset)

    @cached_property
    def needle(self) -> Needle | None:
        """In its tube; None without one."""
        return self._needle(self.linkage.construction.sketched) if self.making.tube_length else None

    # ---- checks and figures -------------------------------------------------------------------------------------------

    def findings(self) -> Sequence[Finding]:
        """STROKE, STROKE_RATE, and those of the needle."""
        stroke = round(self.outermost - self.innermost, 9)
        rate = abs(self.motor.speed_rpm) / 60
        said = "twice geometry.eccentricity, in line"
        found = []
        for code, value, band, unit, where, message in (
            ("STROKE", stroke, self.allowed.stroke, "mm", Where("slider"), said),
            (
                "STROKE_RATE",
                rate,
                self.allowed.strokes_per_s,
                "1/s",
                Where("motor"),
                "motor.speed_rpm / 60",
            ),
        ):
            if band is not None:
                found.append(at_least(code, value, band[0], unit, where, message))
                found.append(at_most(code, value, band[1], unit, where, message))
        return [*found, *(self.needle.findings(self.allowed.stroke) if self.needle else ())]

    def figures(self) -> Study:
        """Stroke, peak speed and its angle, harmonics, travel; the published table where the lengths are the paper's."""
        g = self.geometry
        bore = g.shaft_diameter + self.print.press_clearance
        wall = g.eccentric_diameter / 2 - g.eccentricity - bore / 2
        figures = [
            Figure("stroke", self.outermost - self.innermost, "mm"),
            Figure("motor shaft length", self.assembly.motor.reach or 0.0, "mm"),
            Figure("disc wall", wall, "mm"),
            *(self.needle.figures if self.needle else ()),
        ]
        lengths = (g.eccentricity, g.rod, g.offset)
        loaded = self.masses is not None
        found = study(self.linkage.chain, self.motion, lengths, self.motor.speed_rpm, loaded)
        needle = self.needle
        return replace(
            found,
            numbers=Figures(figures) | found.numbers,
            sketches=(*found.sketches, *((needle.sketch(),) if needle else ())),
        )
