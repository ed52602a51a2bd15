"""Two needles and two spreaders (loopers) of the two-thread flat chain stitch: from the stitch to parts that clear each other.

    Y ^      N1        N2                 X along the line of the needles, 0 at needle 1; Y up, 0 at the plate's top;
      |=======|=========|=======  plate   Z across, along the feed, 0 in the needles' plane.
      |       |         |                 P1 comes from the left, P2 from the right and one pitch H higher:
      |  -----V----->   |  <----- P2      mirror images in X = z/2.
      |  P1 ---->       V
[Horobets, Manoilenko; figures in `stitch`, bodies in `bodies`]
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Annotated, Self

import numpy as np
from pydantic import Field

from camgen.errors import DesignError, Fault, Key, SpecError
from camgen.findings import Finding, Where, at_least, at_most
from camgen.geometry.outlines import Floats
from camgen.machine.features import Mount, Passing
from camgen.machine.model import (
    GROUND,
    Along,
    Body,
    Cam,
    Drive,
    Machine,
    Output,
    Pin,
    Place,
    Pose,
    Slide,
)
from camgen.machines.chain_stitch_looper.bodies import (
    LEAST_RADIUS,
    Bodies,
    SpreaderParts,
    room_on_nose,
    seat_back,
)
from camgen.machines.chain_stitch_looper.ratio import Condition, ratio_conditions, ratio_range
from camgen.machines.chain_stitch_looper.stitch import (
    HARMONIC,
    Design,
    Pair,
    Stitch,
    crank_driven,
    to_and_fro,
)
from camgen.machines.chain_stitch_looper.study import (
    SOURCE_DISTORTION,
    distortion_row,
    distortion_table,
    study,
    timing_study,
)
from camgen.machines.chain_stitch_looper.tables import (
    StitchGeometry,
    StitchLimits,
    StitchMotor,
    Timing,
    Wanted,
)
from camgen.machines.chain_stitch_looper.threads import lengths, moments, seam, sketches
from camgen.machines.mechanism import Mechanism, refuse_failing
from camgen.motion.program import Program
from camgen.motion.segments import LawChoice, SegmentTable, law_of, program, program_faults
from camgen.parts.assembly import Assembly
from camgen.spec import validate
from camgen.study import Study, figures_in, united
from camgen.tolerances import SAME_POINT

# What the source allows: key, least, greatest, unit.
ALLOWED = {
    "nose_over_eye": (1.5, 4.0, "mm"),
    "loop_rise": (1.5, 4.5, "mm"),
    "protrusion": (1.0, 2.0, "mm"),
    "protrusion_deg": (75.0, 90.0, "deg"),
}


class ChainStitchLooper(Mechanism):
    """Spec and answers of the two-thread chain stitch; the output is L, how far the spreaders have moved, mm."""

    geometry: StitchGeometry
    timing: Timing = Timing.model_construct()
    motor: StitchMotor = StitchMotor.model_construct()
    making: Annotated[SpreaderParts, Field(alias="parts")] = SpreaderParts.model_construct()
    allowed: Annotated[StitchLimits, Field(alias="limits")] = StitchLimits.model_construct()
    wanted: Wanted | None = Field(
        default=None,
        description="bounds for `camgen design`, which looks for the largest smallest clearance",
    )

    def faults(self) -> Sequence[Fault]:
        """What is wrong between keys that are right one by one."""
        g = self.geometry
        p = self.making
        t = self.timing
        faults = [
            fault
            for name, choice, tables in self._moves()
            for fault in (
                program_faults(tables, ("timing", f"{name}_segment"))
                if tables
                else _law_faults(choice, ("timing", name))
            )
        ]
        if any(t.distortion) and not self._harmonic:
            right = "[0, 0] with other laws than simple-harmonic"
            faults.append(Fault(("timing", "distortion"), f"{list(t.distortion)}", right))
        if not faults:
            for name, _, tables in self._moves():
                top = max(float(s.start) for s in program(tables).segments) if tables else 1.0
                if abs(top - 1) > 1e-9:
                    path = ("timing", f"{name}_segment")
                    faults.append(Fault(path, f"rises to {top:g}", "a program from 0 up to 1"))
        checks = [
            (
                p.plate_thickness < g.plate_to_spreader,
                ("parts", "plate_thickness"),
                p.plate_thickness,
                f"less than plate_to_spreader, {g.plate_to_spreader:g} mm",
            ),
            (
                p.running_gap < g.protrusion,
                ("parts", "running_gap"),
                p.running_gap,
                f"less than the protrusion, {g.protrusion:g} mm",
            ),
            (
                p.edge_radius == 0 or p.edge_radius >= LEAST_RADIUS,
                ("parts", "edge_radius"),
                p.edge_radius,
                f"0, or at least {LEAST_RADIUS:g} mm: less is neither drawn nor made",
            ),
            (
                self.allowed.min_wall >= self.print.nozzle,
                ("limits", "min_wall"),
                self.allowed.min_wall,
                f"at least the nozzle, {self.print.nozzle:g} mm",
            ),
            (
                g.mode == "corrected" or not (t.needle_segment or t.spreader_segment or t.lag_deg),
                ("geometry", "mode"),
                0.0,
                '"corrected" with segments or lag_deg: the source knows none of them',
            ),
        ]
        for key in ("hole_compensation", "profile_compensation", "shrinkage", "elephant_foot"):
            value = getattr(self.print, key)
            right = "0: spreaders and needles are crossed outlines, which have no print fits; set them in the slicer"
            checks.append((value == 0, ("print", key), value, right))
        if self.wanted is not None:
            for key in ("nose_over_eye", "loop_rise", "protrusion", "plate_to_spreader"):
                low, high = getattr(self.wanted, key)
                right = f"the least value first, then the greatest; {high:g} is less"
                checks.append((low <= high, ("wanted", key), low, right))
        faults += [
            Fault(path, f"{value:g}", right) for fine, path, value, right in checks if not fine
        ]
        return faults

    @property
    def _harmonic(self) -> bool:
        """Whether both laws are the source's."""
        return all(move == "simple-harmonic" and not tables for _, move, tables in self._moves())

    def _moves(self) -> list[tuple[str, str | LawChoice, tuple[SegmentTable, ...]]]:
        t = self.timing
        return [
            ("needle", t.needle, t.needle_segment),
            ("spreader", t.spreader, t.spreader_segment),
        ]

    # ---- figures -----------------------------------------------------------------------------------------------------

    @cached_property
    def stitch(self) -> Stitch:
        """What the spec gives, in the source's terms."""
        g = self.geometry
        t = self.timing
        needle, spreader = (_program(choice, tables) for _, choice, tables in self._moves())
        if any(t.distortion):
            needle, spreader = map(crank_driven, t.distortion)
        setback = g.p6_setback if g.mode == "corrected" else 0.0  # the source has none
        return Stitch(
            g.needle_spacing,
            g.point_lengths,
            g.nose_over_eye,
            g.loop_rise,
            g.needle_diameter,
            g.plate_to_spreader,
            g.protrusion,
            math.radians(g.feed_deg),
            g.material_thickness,
            g.velocity_ratio,
            self.making.side_gap,
            setback,
            t.needle_stroke,
            needle,
            spreader,
            math.radians(t.lag_deg),
        )

    @cached_property
    def design(self) -> Design:
        """The figures that the parts are made to; DesignError where no such mechanism exists."""
        return self.stitch.design(self.geometry.mode == "published")

    @property
    def _sense(self) -> int:
        """Always 1: nothing of the shaft is made, and its angle is counted in its sense of turning."""
        return 1

    def _found(self) -> Mapping[str, object]:
        """The needles' stroke, and what every mechanism fills in."""
        return {**super()._found(), "timing.needle_stroke": self.design.needle_stroke}

    def _unloaded(self) -> Machine:
        """Needles and spreaders on their guides, by laws of the shaft; outputs "spreader" and "needle", mm."""
        d = self.design
        g = self.stitch
        still = np.zeros(1)
        moves = {
            "needle-1": (complex(0, -d.given.depths[0]), 1j, d.risen),
            "needle-2": (complex(g.spacing, -d.given.depths[1]), 1j, d.risen),
            "lower-spreader": (complex(-d.before[0], -g.levels[0]), 1 + 0j, d.moved),
            "upper-spreader": (complex(g.spacing + d.before[1], -g.levels[1]), -1 + 0j, d.moved),
        }
        start = {
            name: Pose(place + way * float(law(still)[0]), 0.0)
            for name, (place, way, law) in moves.items()
        }
        guides = [
            Slide(f"guide of {name}", Place(GROUND, place), Place(name), cmath.phase(way))
            for name, (place, way, _) in moves.items()
        ]
        cams = [
            Cam(f"cam of {name}", "shaft", name, law, f"guide of {name}")
            for name, (_, _, law) in moves.items()
        ]
        return Machine(
            (Body(GROUND), Body("shaft"), *(Body(name) for name in moves)),
            (Pin("bearing", Place("shaft"), Place(GROUND)), *guides, *cams),
            (Drive("motor", "shaft"),),
            {"shaft": Pose(0j, 0.0), **start},
            outputs=(
                Output("spreader", Along("guide of lower-spreader")),
                Output("needle", Along("guide of needle-1")),
            ),
            speed=abs(self._speed),
        )

    def motion(self, theta: Floats, order: int = 0) -> Floats:
        """How far the spreaders have moved, mm, or its derivative to the shaft's angle; (n,)."""
        return self.design.moved(theta, order)

    # ---- parts -------------------------------------------------------------------------------------------------------

    @cached_property
    def bodies(self) -> Bodies:
        """Spreaders, dummies and gauges."""
        g = self.geometry
        return Bodies(
            self.design,
            self.making,
            math.radians(g.protrusion_deg),
            g.blade_length,
            self.allowed.min_wall,
        )

    @property
    def _back(self) -> float:
        return seat_back(math.radians(self.geometry.protrusion_deg), self.making.lean)

    @cached_property
    def assembly(self) -> Assembly:
        """Both spreaders; needles and plate as dummies for the assembly; gauges of the outlines and of the section.

        Spreaders and needles stand on their guides, the plate still; gauges stand nowhere. What passes by may graze, or keeps
        the gap of its contact.
        """
        floor = self.bodies.plan[2].imag
        needle = -self.stitch.needle / 2
        spreaders = [Mount(name, name, z=floor) for name in ("lower-spreader", "upper-spreader")]
        needles = [Mount(name, name, z=needle) for name in ("needle-1", "needle-2")]
        plate = Mount("needle-plate", GROUND, z=-self.bodies.plate.thickness / 2)
        made = self._assembly(self.bodies.parts, (*spreaders, *needles, plate))
        return replace(made, passing=self._passing(), process=replace(made.process, gap=0.0))

    def _passing(self) -> Sequence[Passing]:
        """Needles against spreaders in the needles' plane, the spreaders against each other there and beside it."""
        gap = self.allowed.clearance
        t1, *_, t5 = self.bodies.plan
        beside = (t1.imag + t5.imag) / 2
        lower = "lower-spreader"
        upper = "upper-spreader"
        drawn = {lower: ("needle-section", True), upper: ("needle-section", False)}
        return (
            Passing("N1/P1", lower, "needle-1", (0.0,), gap, drawn),
            Passing("N2/P1", lower, "needle-2", (0.0,), gap, drawn),
            Passing("N2/P2", upper, "needle-2", (0.0,), gap, drawn),
            Passing("N1/P2", upper, "needle-1", (0.0,), gap, drawn),
            Passing("P1/P2", lower, upper, (0.0, beside), self.making.running_gap),
        )

    # ---- checks and study --------------------------------------------------------------------------------------------

    def limits(self) -> Sequence[Finding]:
        """Ranges of the source, loops, needles out of the fabric while it moves, blade, velocity ratio."""
        d = self.design
        g = self.geometry
        p = self.making
        one, two = (math.degrees(angle) for angle in d.pierce_angles)
        found = [
            *(self._range(key) for key in ALLOWED),
            at_least(
                "MIN_WALL",
                p.nose_width,
                self.allowed.min_wall,
                "mm",
                Where("parts.nose_width"),
                "width of the nose at the thread's seat, from where it runs to a point",
            ),
            at_least(
                "SIDE_GAP",
                p.side_gap,
                2 * self.accuracy.chord_tolerance,
                "mm",
                Where("parts.side_gap"),
                "beside the needles' plane each nose passes the needles' flanks at this gap; the outlines of both may be "
                "off by the limit",
            ),
            *(self._loop(k, margin) for k, margin in enumerate(d.margins)),
            at_most(
                "LOOP_ANGLE",
                abs(one - two),
                self.allowed.loop_angle_deg,
                "deg",
                Where("both loops at the pierce"),
                f"{one:.4f} and {two:.4f} deg; equal where plate_to_spreader is needle_spacing / velocity_ratio and "
                "protrusion half the difference of the point_lengths",
            ),
            *(
                at_least(
                    "FEED",
                    math.degrees(angle),
                    g.feed_deg,
                    "deg",
                    Where(f"needle {k}"),
                    "shaft angle over which the needle is out of the fabric; the feed takes the limit. A longer "
                    "needle_stroke or a smaller plate_to_spreader gives more",
                )
                for k, angle in enumerate(d.out_of_fabric, 1)
            ),
            at_least(
                "BLADE_LENGTH",
                g.blade_length,
                d.spreader_stroke - min(d.before),
                "mm",
                Where("spreaders"),
                "the blade reaches under its own needle until the end of the stroke",
            ),
        ]
        return [*found, self._ratio()] if g.mode == "corrected" and self._in_step else found

    def _loop(self, k: int, margin: float) -> Finding:
        pierced = margin > SAME_POINT
        remark = (
            f"the tip of needle {2 - k} never comes down to nose level {k + 1}: use less protrusion, or raise its loop_rise"
            if math.isnan(margin)
            else "nose past the other needle's axis when its tip comes down to nose level: a loop that slides along the nose is "
            f"{'pierced' if pierced else 'missed'}; the seat is {-self.design.seat_margins[k]:.3f} mm short of that axis"
        )
        where = Where(f"spreader {k + 1} and needle {2 - k}")
        return Finding("LOOP", pierced, margin, 0.0, "mm", where, remark, True)

    def _ratio(self) -> Finding:
        ratio = self.geometry.velocity_ratio
        works = self.ratio_range
        if works is None:
            at_fault = min(self._conditions, key=lambda condition: condition.spare(ratio)).name
            remark = f"no ratio works; at this one what fails is: {at_fault}"
            return at_most("VELOCITY_RATIO", ratio, math.nan, "", Where("spec"), remark)
        (low, why_low), (high, why_high) = works
        remark = f"works from {low:.9g} ({why_low}) to {high:.9g} ({why_high})"
        return _between("VELOCITY_RATIO", ratio, (low, high), "", Where("spec"), remark)

    def _range(self, key: str) -> Finding:
        low, high, unit = ALLOWED[key]
        value = getattr(self.geometry, key)
        values = value if isinstance(value, tuple) else (value,)
        worst = min(values, key=lambda v: min(v - low, high - v))
        remark = f"{', '.join(f'{v:g}' for v in values)} {unit}; the source allows {low:g} to {high:g} {unit}"
        return _between("ALLOWED_RANGE", worst, (low, high), unit, Where(f"geometry.{key}"), remark)

    @property
    def _in_step(self) -> bool:
        s = self.stitch
        return s.needle_program is s.spreader_program is HARMONIC and s.lag == 0

    @cached_property
    def _conditions(self) -> list[Condition]:
        """All that the velocity ratio must keep for every finding to hold; laws in step."""
        g = self.geometry
        limits = self.allowed
        s = self.stitch
        found = ratio_conditions(
            s.design(), g.blade_length, limits.clearance, math.radians(limits.loop_angle_deg)
        )
        return [*found, *room_on_nose(s, self.making, self._back)]

    @property
    def ratio_range(self) -> tuple[tuple[float, str], tuple[float, str]] | None:
        """Least and greatest velocity_ratio with which the corrected design works, and what stops it there; laws in step."""
        return ratio_range(self._conditions, self.geometry.velocity_ratio)

    def study(self) -> Study:
        """Synchrogram and events, figures, loops, thread, velocity ratio; for the source's own inputs also its errata."""
        conditions = self._conditions if self._in_step else []
        areas = figures_in(
            "mm²",
            side_outline_area=self.bodies.side_outline().area,
            top_outline_area=self.bodies.top_outline().area,
            needle_section_area=self.bodies.section_outline().area,
        )
        found = study(
            self.stitch,
            self.design,
            self.geometry.stitch_length,
            conditions,
            areas,
            abs(self.motor.speed_rpm),
        )
        timing = timing_study(self.bodies.clock)
        rows = [
            distortion_row(each.timing.distortion, each.bodies.clock)
            for each in self._crank_driven()
        ]
        rods = [distortion_table(rows)] if rows else []
        published = self.geometry.mode == "published" and self.geometry.p6_setback
        left_out = ["Left out: p6_setback, for the published design has none."] if published else []
        loops, table = lengths(self.design)
        return replace(
            found,
            numbers=united([found.numbers, timing.numbers, loops]),
            sketches=sketches(self.design),
            tables=[*timing.tables, *rods, *found.tables, table],
            plots=[
                *found.plots,
                *moments(self.design),
                seam(self.design, self.geometry.stitch_length),
            ],
            notes=[*found.notes, *timing.notes, *left_out],
        )

    def _crank_driven(self) -> Sequence[ChainStitchLooper]:
        """This machine, and the same driven by cranks and rods as the source has them; none with other laws or lag."""
        if not self._harmonic:
            return ()
        data = self.model_dump(by_alias=True, exclude_none=True)
        own = self.timing.distortion
        pairs = dict.fromkeys([(0.0, 0.0), SOURCE_DISTORTION, own])
        timing = data["timing"]
        return [
            self
            if pair == own
            else validate(type(self), data | {"timing": timing | {"distortion": pair}})
            for pair in pairs
        ]

    # ---- synthesis ---------------------------------------------------------------------------------------------------

    def designed(self) -> Self:
        """The spec within [wanted] whose smallest clearance is largest: needles, and noses past the piercing needles.

        Needles, spacing, fabric and feed stay; without [wanted] the source's ranges count. DesignError where nothing clears.
        """
        from camgen.machines.chain_stitch_looper.design import Room, best_clearance

        if not self._in_step:
            right = "simple-harmonic laws without lag: only for these there is a search"
            raise SpecError([Fault(("timing",), "", right)])
        w = self.wanted or Wanted()
        p = self.making
        bounds = {
            name: getattr(w, name)
            for name in ("nose_over_eye", "loop_rise", "protrusion", "plate_to_spreader")
        }
        low, high = bounds["protrusion"]
        # the arcs at V1 and V2 need room on the protrusion's front
        lean = math.radians(self.geometry.protrusion_deg)
        needed = 2 * p.edge_radius * self._back * math.sin(lean) + p.running_gap
        if not needed <= high:
            where = "its greatest value"
            remedy = "edge_radius and running_gap need more: allow more, or make them smaller"
            raise DesignError("wanted.protrusion", high, needed, "mm", where, remedy)
        bounds["protrusion"] = (max(low, math.ceil(1e4 * needed) / 1e4), high)
        pitch = p.clamp_hole + 2 * self.allowed.min_wall + p.running_gap
        room = Room(
            w.spreader_stroke,
            w.nose_length,
            pitch,
            self.allowed.clearance,
            self.allowed.loop_angle_deg,
        )
        best = best_clearance(self.stitch, bounds, room)
        design = best.design()
        data = self.model_dump(by_alias=True, exclude_none=True)
        data["geometry"] |= {
            "nose_over_eye": best.over_eye,
            "loop_rise": best.rise,
            "protrusion": best.protrusion,
            "mode": "corrected",
            "plate_to_spreader": best.plate,
            "velocity_ratio": best.ratio,
            "p6_setback": best.setback,
            "blade_length": math.ceil(
                max(design.spreader_stroke - min(design.before), design.nose + 2)
            ),
        }
        result = validate(type(self), data, "design")
        _ = result.assembly  # refused where it cannot be made
        refuse_failing(result)
        return result


def _between(
    code: str, value: float, limits: Pair, unit: str, where: Where, remark: str
) -> Finding:
    """Against the nearer of two limits."""
    low, high = limits
    check, limit = (at_least, low) if value - low < high - value else (at_most, high)
    return check(code, value, limit, unit, where, remark)


def _law_faults(choice: str | LawChoice, path: Key) -> list[Fault]:
    try:
        law_of(choice)
    except SpecError as error:
        named = isinstance(choice, LawChoice)
        return [
            replace(fault, path=(*path, *fault.path) if named else path) for fault in error.faults
        ]
    return []


def _program(choice: str | LawChoice, tables: tuple[SegmentTable, ...]) -> Program:
    if tables:
        return program(tables)
    return HARMONIC if choice == "simple-harmonic" else to_and_fro(law_of(choice))
