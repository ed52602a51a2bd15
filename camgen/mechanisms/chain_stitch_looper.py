"""Two needles and two spreaders (loopers) of the two-thread flat chain stitch: from the stitch to parts that clear each other.

    Y ^      N1        N2                 X along the line of the needles, 0 at needle 1; Y up, 0 at the plate's top;
      |=======|=========|=======  plate   Z across, along the feed, 0 in the needles' plane.
      |       |         |                 P1 comes from the left, P2 from the right and one pitch H higher:
      |  -----V----->   |  <----- P2      mirror images in X = z/2.
      |  P1 ---->       V
A spreader's own frame: u rearward from the nose's tip, y up from nose level, w as Z. Its part has x = u (the lower one, P1,
x = -u), y, and z = w from its lowest place up. Two layers, the body with its slanting front P6 and the flank with the nose,
are crossed with the outline from above.
[Horobets, Manoilenko; figures in camgen.stitch. Nose, shank, gaps and radii are a reconstruction: the scan has no figures]
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field

from camgen.crossing import rounded
from camgen.errors import DesignError, Fault, SpecError
from camgen.findings import Finding, at_least, at_most
from camgen.looper_study import study
from camgen.mechanism import Apart, Mechanism, Pose, Study
from camgen.outlines import Contour, Floats, Points, Region, circle, polygon
from camgen.parts import Layer, Part
from camgen.program import Program
from camgen.segments import LawChoice, SegmentTable, law_of, program, program_faults
from camgen.spec import Length, Record, validate
from camgen.stitch import HARMONIC, Design, Stitch, ratio_conditions, ratio_range, to_and_fro

Both = tuple[Length, Length]
Law = Annotated[str | LawChoice, Field(union_mode="left_to_right")]

# What the source allows: key, least, greatest, unit.
ALLOWED = {
    "nose_over_eye": (1.5, 4.0, "mm"),
    "loop_rise": (1.5, 4.5, "mm"),
    "protrusion": (1.0, 2.0, "mm"),
    "protrusion_deg": (75.0, 90.0, "deg"),
}
_TEMPLATE = 1.0  # mm, thickness of the templates for outlines and section
_BEYOND = 10.0  # mm that plate and needles are drawn beyond what they need


class Geometry(Record):
    """Figures of stitch, needles and spreaders, named as in the source."""

    needle_spacing: Length
    point_lengths: Both
    nose_over_eye: Both
    loop_rise: Both
    needle_diameter: Length
    plate_to_spreader: Length
    protrusion: Length
    protrusion_deg: Annotated[float, Field(ge=30, le=90)]
    feed_deg: Annotated[float, Field(gt=0, lt=360)]
    material_thickness: Length
    velocity_ratio: Annotated[float, Field(gt=0, le=100)]
    blade_length: Length
    mode: Literal["corrected", "published"] = "corrected"
    stitch_length: Length = 3.0
    p6_setback: Annotated[float, Field(ge=0, le=1e3)] = 0.0


class Timing(Record):
    """How needles and spreaders move: a law for rise and return alike, or a program of its own whose lifts go from 0 to 1."""

    needle: Law = "simple-harmonic"
    spreader: Law = "simple-harmonic"
    needle_segment: tuple[SegmentTable, ...] = ()
    spreader_segment: tuple[SegmentTable, ...] = ()
    lag_deg: Annotated[float, Field(ge=-180, le=180)] = 0.0
    needle_stroke: Length | None = None


class Motor(Record):
    """What drives the machine."""

    speed_rpm: Annotated[float, Field(gt=0, le=1e6)] = 3000.0


class Parts(Record):
    """Spreaders and plate as bodies."""

    nose_width: Length = 1.2
    side_gap: Annotated[float, Field(ge=0, le=10)] = 0.1
    shed_deg: Annotated[float, Field(ge=0, lt=45)] = 3.0
    lean: Literal["nose", "shank"] = "nose"
    edge_radius: Annotated[float, Field(ge=0, le=10)] = 0.3
    running_gap: Annotated[float, Field(ge=0, le=10)] = 0.0
    shank_length: Length = 12.0
    shank_width: Length = 6.0
    clamp_hole: Length = 2.2
    plate_thickness: Length = 2.0


class Limits(Record):
    """What the designer accepts; a finding fails beyond it."""

    loop_angle_deg: Annotated[float, Field(ge=0, le=90)] = 1.0
    clearance: Annotated[float, Field(ge=0, le=100)] = 0.0
    min_wall: Length = 0.8


class Wanted(Record):
    """Bounds within which `camgen design` looks for the spec with the largest smallest clearance."""

    nose_over_eye: Both = (1.5, 4.0)
    loop_rise: Both = (1.5, 4.5)
    protrusion: Both = (1.0, 2.0)
    plate_to_spreader: Both = (3.0, 8.0)
    spreader_stroke: Length = 40.0
    nose_length: Length = 16.0


class ChainStitchLooper(Mechanism):
    """Spec and answers of the two-thread chain stitch; the output is L, how far the spreaders have moved, mm."""

    geometry: Geometry
    timing: Timing = Timing()
    motor: Motor = Motor()
    making: Annotated[Parts, Field(alias="parts")] = Parts()
    allowed: Annotated[Limits, Field(alias="limits")] = Limits()
    wanted: Wanted | None = None

    def faults(self) -> Sequence[Fault]:
        """What is wrong between keys that are right one by one."""
        g, p, t = self.geometry, self.making, self.timing
        found = [
            fault
            for name, choice, tables in self._moves()
            for fault in (program_faults(tables, f"timing.{name}_segment") if tables else _law_faults(choice, f"timing.{name}"))
        ]
        if not found:
            for name, _, tables in self._moves():
                top = max((float(s.start) for s in program(tables).segments), default=1.0) if tables else 1.0
                if abs(top - 1) > 1e-9:
                    found.append(Fault(f"timing.{name}_segment", f"rises to {top:g}", "a program from 0 up to 1"))
        checks = [
            (p.plate_thickness < g.plate_to_spreader, "parts.plate_thickness", p.plate_thickness,
             f"less than plate_to_spreader, {g.plate_to_spreader:g} mm"),
            (p.running_gap < g.protrusion, "parts.running_gap", p.running_gap, f"less than the protrusion, {g.protrusion:g} mm"),
            (self.allowed.min_wall >= self.print.nozzle, "limits.min_wall", self.allowed.min_wall,
             f"at least the nozzle, {self.print.nozzle:g} mm"),
            (g.mode == "corrected" or not (t.needle_segment or t.spreader_segment or t.lag_deg or g.p6_setback),
             "geometry.mode", 0.0, "\"corrected\" with segments, lag_deg or p6_setback: the source knows none of them"),
        ]  # fmt: skip
        for key in ("hole_compensation", "profile_compensation", "shrinkage", "elephant_foot"):
            value = getattr(self.print, key)
            checks.append((value == 0, f"print.{key}", value, "0: files are judged as drawn, let the slicer compensate"))
        if self.wanted is not None:
            for key in ("nose_over_eye", "loop_rise", "protrusion", "plate_to_spreader"):
                low, high = getattr(self.wanted, key)
                checks.append((low <= high, f"wanted.{key}", low, f"the least value first, then the greatest; {high:g} is less"))
        found += [Fault(path, f"{value:g}", expected) for fine, path, value, expected in checks if not fine]
        return found

    def _moves(self) -> list[tuple[str, str | LawChoice, tuple[SegmentTable, ...]]]:
        t = self.timing
        return [("needle", t.needle, t.needle_segment), ("spreader", t.spreader, t.spreader_segment)]

    # ---- figures -----------------------------------------------------------------------------------------------------

    @cached_property
    def stitch(self) -> Stitch:
        """What the spec gives, in the source's terms."""
        g, t = self.geometry, self.timing
        needle, spreader = (_program(choice, tables) for _, choice, tables in self._moves())
        return Stitch(
            g.needle_spacing, g.point_lengths, g.nose_over_eye, g.loop_rise, g.needle_diameter, g.plate_to_spreader,
            g.protrusion, math.radians(g.feed_deg), g.material_thickness, g.velocity_ratio, self.making.side_gap,
            g.p6_setback, t.needle_stroke, needle, spreader, math.radians(t.lag_deg),
        )  # fmt: skip

    @cached_property
    def design(self) -> Design:
        """The figures that the parts are made to; DesignError where no such mechanism exists."""
        return self.stitch.design(self.geometry.mode == "published")

    def motion(self, theta: Floats, order: int = 0) -> Floats:
        """How far the spreaders have moved, mm, or its derivative to the shaft's angle; (n,)."""
        return self.design.moved(theta, order)

    # ---- outlines ----------------------------------------------------------------------------------------------------

    def side_outline(self, radius: float = 0.0, behind: float = 0.0, foot: float | None = None) -> Contour:
        """Outline in (u, y), counter-clockwise: V0 nose, V1 seat, V2 to V5; V1, V2 and V5 rounded.

        behind: shank beyond the blade's end; foot: depth of the underside, l_H unless said. DesignError where arcs do not fit.
        """
        d, g = self.design, self.geometry
        low = g.protrusion if foot is None else foot
        lean = low / math.tan(math.radians(g.protrusion_deg)) * (1 if self.making.lean == "nose" else -1)
        end, b = g.blade_length + behind, self.stitch.height
        points = [0j, complex(d.l3, 0), complex(d.l3 - lean, -low), complex(end, -low), complex(end, b), complex(d.nose, b)]
        return self._rounded(points, [0, radius, radius, 0, 0, radius])

    def section_outline(self, behind: float = 0.0, foot: float | None = None) -> Contour:
        """Outline in (u, y) of what stands in the needles' plane: B, C and the body behind them; sharp."""
        d, end, b = self.design, self.geometry.blade_length + behind, self.stitch.height
        low = self.geometry.protrusion if foot is None else foot
        return polygon([complex(d.l1, 0), complex(d.l1, -low), complex(end, -low), complex(end, b), complex(d.nose, b)])

    def top_outline(self, radius: float = 0.0) -> Contour:
        """Outline in (u, w), counter-clockwise: T0 nose, then T5 to T1; T1 and T4 rounded."""
        d, (t1, t2, t3, t4, t5) = self.design, self._plan()
        return self._rounded([complex(0, t5.imag), t5, t4, t3, t2, t1], [0, 0, min(radius, d.opening / 2), 0, 0, radius])

    def _plan(self) -> tuple[complex, complex, complex, complex, complex]:
        """T1 to T5."""
        d, p, end = self.design, self.making, self.geometry.blade_length
        gap, widening = self.geometry.needle_diameter / 2 + p.side_gap, math.tan(math.radians(p.shed_deg))
        return (
            complex(d.l3, gap + p.nose_width), complex(end, gap + p.nose_width + (end - d.l3) * widening),
            complex(end, gap - d.opening - (end - d.nose) * widening), complex(d.nose, gap - d.opening), complex(d.nose, gap),
        )  # fmt: skip

    def _rounded(self, points: list[complex], radii: list[float]) -> Contour:
        try:
            return rounded(points, radii)
        except ValueError as corner:
            raise DesignError(
                "edge_radius", self.making.edge_radius, 0.0, "mm", f"corner at {points[int(str(corner))]:.4g} mm",
                "its arc does not fit between the next corners: use a smaller one or a longer blade or protrusion",
            ) from None  # fmt: skip

    # ---- parts -------------------------------------------------------------------------------------------------------

    def parts(self) -> Sequence[Part]:
        """Both spreaders; needles and plate as dummies for the assembly; templates of the outlines and of the section."""
        return self._parts

    @cached_property
    def _parts(self) -> tuple[Part, ...]:
        radius, upper = self.making.edge_radius, self._spreader
        mirrored = [Layer(layer.region.moved(-1, mirror=True), layer.z0, layer.z1) for layer in upper.layers]
        assert upper.crossed is not None
        lower = replace(
            upper, name="lower-spreader", title="Lower spreader (P1), mirror image", layers=tuple(mirrored),
            centres=tuple(-z.conjugate() for z in upper.centres), crossed=upper.crossed.moved(-1, mirror=True),
        )  # fmt: skip
        outlines = [
            ("side-outline", "Template: side outline", self.side_outline(radius)),
            ("top-outline", "Template: outline from above, at the height of C", self.top_outline(radius)),
            ("needle-section", "Template: section in the needles' plane", self.section_outline()),
        ]
        templates = [Part(name, title, (Layer(Region(outline), 0.0, _TEMPLATE),)) for name, title, outline in outlines]
        return (lower, upper, *self._needles, self._plate, *templates)

    @cached_property
    def _spreader(self) -> Part:
        """The upper spreader: body and flank one above the other in z, crossed with the outline from above and the shank."""
        g, d, p = self.geometry, self.design, self.making
        t1, t2, t3, t4, t5 = self._plan()
        if not d.nose < g.blade_length:
            raise DesignError(
                "blade_length", g.blade_length, d.nose, "mm", "the nose alone", "use a longer blade or a smaller velocity_ratio"
            )
        foot, floor, end = g.protrusion - p.running_gap, t3.imag, g.blade_length + p.shank_length
        hole_at = complex(g.blade_length + p.shank_length / 2, (self.stitch.height - foot) / 2)
        height = self.stitch.height + foot
        wall = (min(height, p.shank_length) - p.clamp_hole) / 2
        if not wall > 0:
            raise DesignError(
                "clamp_hole", p.clamp_hole, min(height, p.shank_length), "mm", "the shank's height and length",
                "use a smaller hole: the shank may be no higher than the blade, for the other spreader passes it",
            )  # fmt: skip
        hole = circle(hole_at, p.clamp_hole / 2)
        body = Region(self.section_outline(p.shank_length, foot), (hole,))
        flank = Region(self.side_outline(p.edge_radius, p.shank_length, foot), (hole,))
        ceiling = max(t2.imag, floor + p.shank_width)
        # P6 and the nose's tip bound the material in front; the outline from above runs on before them and leaves room.
        lead = -1.0
        side = complex(lead, t5.imag + lead * p.nose_width / d.l3)
        slant = (t4 - t3) / (t4 - t3).real
        corner = t3 + slant * (lead - t3.real)
        points = [corner, t3, complex(end, t3.imag), complex(end, ceiling)]
        points += [complex(t2.real, ceiling)] if ceiling > t2.imag else []
        points += [t2, t1, side]
        radii = [p.edge_radius if z == t1 else 0.0 for z in points]
        plan = self._rounded(points, radii).moved(shift=-1j * floor)
        middle = t5.imag - floor
        return Part(
            "upper-spreader", "Upper spreader (P2)",
            (Layer(body, 0.0, middle), Layer(flank, middle, ceiling - floor)), 1, (), (hole_at,),
            (f"needles' plane at z = {-floor:.4f}", f"nose edges rounded R{p.edge_radius:g}; polish where the thread runs"),
            None, self.allowed.min_wall, 1, Region(plan),
        )  # fmt: skip

    @cached_property
    def _needles(self) -> tuple[Part, Part]:
        """Needles, upright in the drawing's plane: round above, the point a wedge whose section here is the cone's."""
        g, r = self.geometry, self.geometry.needle_diameter / 2
        top = max(self.stitch.depths) + g.material_thickness + _BEYOND

        def needle(k: int) -> Part:
            h = g.point_lengths[k]
            outline = polygon([0j, complex(r, h), complex(r, top), complex(-r, top), complex(-r, h)])
            crossed = Region(circle(complex(0, r), r))
            notes = ("dummy for the assembly; cone and wedge have the same section in this plane",)
            return Part(f"needle-{k + 1}", f"Needle {k + 1}", (Layer(Region(outline), 0.0, 2 * r),), notes=notes, crossed=crossed)

        return needle(0), needle(1)

    @cached_property
    def _plate(self) -> Part:
        g, p = self.geometry, self.making
        z, half = g.needle_spacing, max(self._spreader.thickness, 6.0)
        r = g.needle_diameter / 2 + min(0.4, (z - g.needle_diameter) / 4)
        left, right, t = -_BEYOND, z + _BEYOND, p.plate_thickness
        outline = polygon([complex(left, -t), complex(right, -t), complex(right, 0), complex(left, 0)])
        top = polygon([complex(left, 0), complex(right, 0), complex(right, 2 * half), complex(left, 2 * half)])
        holes = tuple(circle(complex(x, half), r) for x in (0.0, z))
        return Part(
            "needle-plate", "Needle plate", (Layer(Region(outline), 0.0, 2 * half),), notes=("dummy for the assembly",),
            crossed=Region(top, holes),
        )  # fmt: skip

    # ---- assembly ----------------------------------------------------------------------------------------------------

    def poses(self, theta: Floats) -> Mapping[str, Sequence[Pose]]:
        """Spreaders along X, needles along Y, the plate still; templates stand nowhere."""
        theta = np.asarray(theta, float)
        zero, d, g = np.zeros(theta.shape), self.design, self.stitch
        tips, noses = d.tips(theta), d.noses(theta)
        floor = self._plan()[2].imag

        def at(x: Floats, y: Floats, z: float) -> list[Pose]:
            place: Points = np.empty(theta.shape, complex)
            place.real, place.imag = x, y
            return [Pose(zero, place, z=z)]

        return {
            "lower-spreader": at(noses[0], zero - g.levels[0], floor),
            "upper-spreader": at(g.spacing - noses[1], zero - g.levels[1], floor),
            "needle-1": at(zero, tips[0], -g.needle / 2),
            "needle-2": at(zero + g.spacing, tips[1], -g.needle / 2),
            "needle-plate": at(zero, zero, -self._plate.thickness / 2),
            "side-outline": [],
            "top-outline": [],
            "needle-section": [],
        }

    def contacts(self) -> Sequence[Apart]:
        """Needles against spreaders in the needles' plane, the spreaders against each other there and beside it."""
        gap, t1, t5 = self.allowed.clearance, *self._plan()[::4]
        beside = (t1.imag + t5.imag) / 2
        spreaders = {"P1": "lower-spreader", "P2": "upper-spreader"}
        pairs = [("N1/P1", "N2/P1", "N2/P2", "N1/P2")]
        found = [Apart(name, spreaders[name[3:]], f"needle-{name[1]}", (0.0,), gap) for name in pairs[0]]
        return (*found, Apart("P1/P2", "lower-spreader", "upper-spreader", (0.0, beside), self.making.running_gap))

    # ---- checks and study --------------------------------------------------------------------------------------------

    def limits(self) -> Sequence[Finding]:
        """Ranges of the source, loops, needles out of the fabric while it moves, blade, velocity ratio."""
        d, g = self.design, self.geometry
        found = [self._range(key) for key in ALLOWED]
        turning = 1 - 1e-9  # S_X is made for the feed's angle, which comes back rounded
        for k, margin in enumerate(d.margins):
            found.append(
                replace(
                    at_least(
                        "LOOP", margin, 0.0, "mm", f"spreader {k + 1} and needle {2 - k}",
                        "nose past the other needle's axis when its tip comes down to nose level: a loop that slides along the "
                        f"nose is {'pierced' if margin > 0 else 'missed'}; the seat is {-d.held[k]:.3f} mm short of that axis",
                    ),
                    ok=margin > 0,
                )
            )  # fmt: skip
        one, two = (math.degrees(angle) for angle in d.pierce_angles)
        found.append(
            at_most(
                "LOOP_ANGLE", abs(one - two), self.allowed.loop_angle_deg, "deg", "both loops at the pierce",
                f"{one:.4f} and {two:.4f} deg; equal where plate_to_spreader is needle_spacing / velocity_ratio and "
                "protrusion half the difference of the point_lengths",
            )
        )  # fmt: skip
        for k, angle in enumerate(d.out_of_fabric):
            found.append(
                at_least(
                    "FEED", math.degrees(angle), g.feed_deg * turning, "deg", f"needle {k + 1}",
                    "shaft angle over which the needle is out of the fabric; the feed takes the limit. A longer needle_stroke "
                    "or a smaller plate_to_spreader gives more",
                )
            )  # fmt: skip
        found.append(
            at_least(
                "BLADE_LENGTH", g.blade_length, d.spreader_stroke - min(d.before), "mm", "spreaders",
                "the blade reaches under its own needle until the end of the stroke",
            )
        )
        if g.mode == "corrected" and self._in_step:
            (low, why_low), (high, why_high) = self.ratio_range
            below = g.velocity_ratio - low < high - g.velocity_ratio
            remark = f"works from {low:.9g} ({why_low}) to {high:.9g} ({why_high})"
            check = at_least if below else at_most
            found.append(check("VELOCITY_RATIO", g.velocity_ratio, low if below else high, "", "spec", remark))
        return found

    def _range(self, key: str) -> Finding:
        low, high, unit = ALLOWED[key]
        value = getattr(self.geometry, key)
        values = value if isinstance(value, tuple) else (value,)
        worst = min(values, key=lambda v: min(v - low, high - v))
        remark = f"{', '.join(f'{v:g}' for v in values)} {unit}; the source allows {low:g} to {high:g} {unit}"
        check, limit = (at_least, low) if worst - low < high - worst else (at_most, high)
        return check("ALLOWED_RANGE", worst, limit, unit, f"geometry.{key}", remark)

    @property
    def _in_step(self) -> bool:
        s = self.stitch
        return s.needle_program is s.spreader_program is HARMONIC and s.lag == 0

    @property
    def ratio_range(self) -> tuple[tuple[float, str], tuple[float, str]]:
        """Least and greatest velocity_ratio with which the corrected design works, and what stops it there; laws in step."""
        return ratio_range(ratio_conditions(self.stitch.design(), self.geometry.blade_length))

    def study(self) -> Study:
        """Synchrogram and events, published and corrected figures side by side, errata, loops, thread, velocity ratio."""
        conditions = ratio_conditions(self.stitch.design(), self.geometry.blade_length) if self._in_step else []
        areas = {
            "side_outline_area_mm2": self.side_outline().area,
            "top_outline_area_mm2": self.top_outline().area,
            "needle_section_area_mm2": self.section_outline().area,
        }
        return study(self.stitch, self.design, self.geometry.stitch_length, conditions, areas, self.motor.speed_rpm)

    # ---- synthesis ---------------------------------------------------------------------------------------------------

    def designed(self) -> Self:
        """The spec within [wanted] whose smallest clearance is largest: needles, and noses past the piercing needles.

        Needles, spacing, fabric and feed stay. SpecError where [wanted] is missing; DesignError where nothing clears.
        """
        from camgen.looper_design import best_clearance

        if self.wanted is None:
            raise SpecError([Fault("wanted", "", "missing: a table, it may be empty, [wanted]")])
        if not self._in_step:
            raise SpecError([Fault("timing", "", "simple-harmonic laws without lag: only for these there is a search")])
        w = self.wanted
        bounds = {name: getattr(w, name) for name in ("nose_over_eye", "loop_rise", "protrusion", "plate_to_spreader")}
        pitch = self.making.clamp_hole + 2 * self.allowed.min_wall + self.making.running_gap
        found = best_clearance(self.stitch, bounds, w.spreader_stroke, w.nose_length, pitch)
        made = found.design()
        data = self.model_dump(by_alias=True, exclude_none=True)
        data["geometry"] |= {
            "nose_over_eye": found.over_eye, "loop_rise": found.rise, "protrusion": found.protrusion, "mode": "corrected",
            "plate_to_spreader": found.plate, "velocity_ratio": found.ratio, "p6_setback": found.setback,
            "blade_length": math.ceil(max(made.spreader_stroke - min(made.before), made.nose + 2)),
        }  # fmt: skip
        result = validate(type(self), data, "design")
        result.parts()
        failed = next((finding for finding in result.limits() if not finding.ok), None)
        if failed is not None:
            raise DesignError(failed.code, failed.measured, failed.limit, failed.unit, failed.where, failed.message)
        return result


def _law_faults(choice: str | LawChoice, path: str) -> list[Fault]:
    try:
        law_of(choice)
    except SpecError as error:
        named = isinstance(choice, LawChoice)
        return [Fault(f"{path}.{f.path}" if named and f.path else path, f.value, f.expected, f.nearest) for f in error.faults]
    return []


def _program(choice: str | LawChoice, tables: tuple[SegmentTable, ...]) -> Program:
    if tables:
        return program(tables)
    return HARMONIC if choice == "simple-harmonic" else to_and_fro(law_of(choice))
