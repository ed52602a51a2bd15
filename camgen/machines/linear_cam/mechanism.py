"""Any linear cam: a plate slides along, and its upper edge moves a follower through segments of motion.

        (o)            The plate slides along -x, so the follower passes along +x over it: way 0 is where it stands at x = 0 of
     ____|___          the plate's files. A translating follower slides along y, its output is in mm; an oscillating one has its
    /        \\__       axle on the left, its output is the arm's angle, growing upwards. Gravity or a spring holds it on the
   |____________|      edge. The way is gone through to and fro.

theta is the way: a degree of it stands for a millimetre.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from camgen.errors import DesignError, Fault, SpecError
from camgen.findings import Finding, NotJudged, Where
from camgen.geometry.distances import thinnest_wall
from camgen.geometry.facets import facet_contour
from camgen.geometry.outlines import Contour, Line, Region, circle, end_point, start_point
from camgen.machine.cams.limits import edge_findings, program_findings
from camgen.machine.cams.linear import WAY, LinearCam, PlateArm, PlateSlide
from camgen.machine.cams.machine import FollowerLoad, Loaded, contact_machine, loaded_by
from camgen.machine.features import Mount, PlateEdge
from camgen.machine.model import GROUND, MM, Cam, Drive, Machine, Place, Slide, Turning
from camgen.machine.strength import line_contact
from camgen.machines.cam_loads import (
    kept_on,
    line_hertz,
    load_faults,
    load_of,
    pushed_figures,
)
from camgen.machines.disc_cam.curves import peak_figures
from camgen.machines.disc_cam.tables import LoadTable, SpringTable
from camgen.machines.linear_cam.tables import PlateDrive, PlateGeometry, PlateLimits, PlateParts
from camgen.machines.loads.tables import thin_walls
from camgen.machines.mechanism import Mechanism
from camgen.motion.stroke import Stroke, StrokeSegment, stroke
from camgen.numerics import Floats
from camgen.parts import materials
from camgen.parts.assembly import Assembly, Cycle
from camgen.parts.disc_cams import roller_note
from camgen.parts.part import Layer, Part
from camgen.study import Figure, Figures, Later, Plot, Sketch, Study

_SMOOTHER = "a law that ends smoother joins them"
_FLATTER = "a longer span or a smaller lift"
_AS_DRAWN = "0: the edge of a linear cam is in its files as drawn; let the slicer compensate"
_NO_TURN = "no value here: a plate that slides has no cam angle"
_RIGID = "no value here: a plate's follower counts as rigid"
_NOT_MADE = "no value here: camgen makes the plate alone, without pins, bearings or gears"
_NO_SHAFT = "no value here: no shaft turns"
_SAMPLES = 1441  # of the way, in curves
_COARSE = 0.01  # mm, by which edges may be off where it is asked whether holes lie in them
_BY_WAY: dict[str, Any] = {"angle": "way of the plate", "unit": "mm"}  # how places are told


class LinearCamDrive(Mechanism):
    """Spec and answers of a linear cam; the output is the follower's displacement s, mm or rad."""

    hardened = True
    no_use = (
        ("print", "profile_compensation", _AS_DRAWN),
        ("print", "shrinkage", _AS_DRAWN),
        ("load", "stiffness", _RIGID),
        ("load", "damping_ratio", _RIGID),
        ("load", "polydyne", _RIGID),
        (
            "load",
            "restitution",
            "no value here: camgen calculates hops only for cams that turn evenly",
        ),
        (
            "load",
            "spring_error",
            "no value here: camgen judges spring errors only for cams that turn",
        ),
        (
            "load",
            "cam_follower",
            "no value here: the roller counts as steel, and its life is not judged",
        ),
        ("limits", "frequency_ratio", _RIGID),
        ("limits", "bearing_life_h", _NOT_MADE),
        ("limits", "pin_stress_mpa", _NOT_MADE),
        ("limits", "tooth_stress_mpa", _NOT_MADE),
        ("limits", "pv_mpa_m_s", _NOT_MADE),
        ("limits", "run_up_s", _NO_SHAFT),
        ("limits", "speed_swing", _NO_SHAFT),
        ("files", "profile_step_deg", _NO_TURN),
        ("files", "cutter_radius", "no value here: camgen makes no cutter path for a plate"),
    )

    geometry: PlateGeometry
    segment: Annotated[tuple[StrokeSegment, ...], Field(min_length=1, max_length=100)] = Field(
        description="segments of the motion: one after another they make the plate's travel"
    )
    drive: PlateDrive = Field(
        default=PlateDrive.model_construct(), description="what moves the plate"
    )
    load: LoadTable | None = Field(
        default=None,
        description="mass and loads of the follower, for forces, and whether it stays on the plate",
    )
    spring: SpringTable | None = Field(
        default=None,
        description="the spring that presses the follower on the plate; the report says how strong it must be",
    )
    making: Annotated[PlateParts, Field(alias="parts")] = PlateParts.model_construct()
    allowed: Annotated[PlateLimits, Field(alias="limits")] = PlateLimits.model_construct()

    def faults(self) -> Sequence[Fault]:
        """What is wrong between keys that are right one by one."""
        f = self.geometry.follower
        found = []
        for key, belongs, what in (
            ("radius", f.shape == "roller", "a roller has a radius"),
            ("arm", self.geometry.follower.swings, "an oscillating follower has an arm"),
        ):
            value = getattr(f, key)
            path = ("geometry", "follower", key)
            if belongs and value is None:
                found.append(Fault(path, "", f"missing: {what}"))
            elif not belongs and value is not None:
                found.append(Fault(path, f"{value:g}", f"no value here: only {what}"))
        if f.start_deg and not self.geometry.follower.swings:
            path = ("geometry", "follower", "start_deg")
            found.append(
                Fault(
                    path, f"{f.start_deg:g}", "no value here: only an oscillating follower has it"
                )
            )
        found += thin_walls(self.allowed.min_wall, self.print.nozzle)
        widest = 2 * (min(self.geometry.height / 2, self.making.ends) - self.allowed.min_wall)
        if self.making.hole > max(widest, 0.0):
            right = f"at most {max(widest, 0.0):.4g}: geometry.height and twice parts.ends, less two of limits.min_wall; 0: no holes"
            found.append(Fault(("parts", "hole"), f"{self.making.hole:g}", right))
        found += self.unused_faults()
        found += load_faults(self.load, self.spring, not f.swings, True, False)
        try:
            self.program  # noqa: B018
        except SpecError as error:
            found += error.faults
        return found

    # ---- motion -----------------------------------------------------------------------------------------------------

    @property
    def _speed(self) -> float:
        return self.drive.speed / WAY

    @cached_property
    def program(self) -> Stroke:
        """The follower's motion along the way, mm or rad, over theta."""
        return stroke(self.segment, 1 / self.geometry.follower.unit[1], 1 / WAY)

    def motion(self, theta: Floats, order: int = 0) -> Floats:
        """Wanted displacement s (mm or rad) or its derivative to theta, (n,)."""
        return self.program(theta, order)

    @cached_property
    def cam(self) -> LinearCam:
        """The plate's edge."""
        f = self.geometry.follower
        radius = f.radius or 0.0
        rest = 1j * (self.geometry.height + radius)
        if not self.geometry.follower.swings:
            return LinearCam(self.program, PlateSlide(rest, 1j, radius))
        arm = cmath.rect(f.arm or 0.0, math.radians(f.start_deg))
        return LinearCam(self.program, PlateArm(rest - arm, arm, radius, 1))

    def _unloaded(self) -> Machine:
        """Plate and follower; output "lift", mm, or "swing", rad."""
        law = stroke(self.segment, 1 / self.geometry.follower.unit[1], 1.0)
        contact = Cam("contact", "cam", "follower", law, closure="force", over="rails")
        made = contact_machine(contact, self.cam.follower, self._speed, self._load)
        rails = Slide("rails", Place(GROUND), Place("cam"), math.pi)
        drive = Drive("motor", "cam", Turning(WAY), "rails")
        return replace(made, joints=(rails, *made.joints[1:]), drives=(drive,))

    @property
    def _lowest(self) -> float:
        """Least height of the edge over the plate's bottom along the way, mm."""
        return -self.cam.greatest(
            lambda theta: -self.cam.follower.envelope(theta, self.program, 0).imag
        )[1]

    # ---- parts ------------------------------------------------------------------------------------------------------

    @cached_property
    def _outline(self) -> Contour:
        """The plate's outline, counter-clockwise; beyond the way its edge goes straight on."""
        edge = self.cam.edge
        ends = self.making.ends
        left = start_point(edge[0])
        right = end_point(edge[-1])
        low, high = self.cam.range
        tangents = [
            complex(self.cam.follower.normal(np.array([t]), self.program)[0])
            for t in (low + 1e-9, high - 1e-9)
        ]
        first = left + 1j * tangents[0] * ends
        last = right - 1j * tangents[1] * ends
        lowest = min(first.imag, last.imag, self._lowest)
        if lowest <= 0:
            remedy = "the edge goes below the plate's bottom: a greater geometry.height, or shorter parts.ends"
            raise DesignError("height of the edge", lowest, 0.0, "mm", "its lowest", remedy)
        corners = [complex(first.real), complex(last.real), last]
        return Contour(
            (
                Line(corners[0], corners[1]),
                Line(corners[1], last),
                Line(last, right),
                *(piece.reversed() for piece in reversed(edge)),
                Line(left, first),
                Line(first, corners[0]),
            )
        )

    @cached_property
    def _region(self) -> Region:
        """The plate's face; DesignError where a hole leaves its edge."""
        holes = tuple(circle(place, self.making.hole / 2) for place in self._screws)
        edges = [facet_contour(each, _COARSE) for each in (self._outline, *holes)]
        if thinnest_wall(edges[0], edges[1:]) <= 0:
            remedy = "the edge is too low there: a greater geometry.height, or a smaller parts.hole (0: none)"
            least = self.allowed.min_wall
            raise DesignError("wall of the plate", 0.0, least, "mm", "a hole for a screw", remedy)
        return Region(self._outline, holes)

    @cached_property
    def assembly(self) -> Assembly:
        """The plate."""
        p = self.making
        f = self.geometry.follower
        notes = roller_note(2 * f.radius) if f.radius else ()
        part = Part(
            self.drive.slide,
            "Plate of a linear cam",
            (Layer(self._region, 0.0, p.thickness),),
            notes=notes,
            centres=self._screws,
            min_wall=self.allowed.min_wall,
        )
        made = self._assembly([part], [Mount(self.drive.slide, "cam")])
        low, high = self.cam.range
        cycle = Cycle(low, high, name="travel of the plate", to_and_fro=True, unit="mm")
        return replace(made, cycle=cycle, edges=(self._plate_edge,))

    @property
    def _screws(self) -> tuple[complex, ...]:
        """Middles of the holes for screws."""
        places = [complex(WAY * theta, self.geometry.height / 2) for theta in self.cam.range]
        return tuple(places) if self.making.hole else ()

    @property
    def _plate_edge(self) -> PlateEdge:
        """What the judge is told of the follower."""
        follower = self.cam.follower
        pivot = None if isinstance(follower, PlateSlide) else follower.pivot
        reference = follower.start if isinstance(follower, PlateSlide) else follower.arm
        return PlateEdge(self.drive.slide, "contact", follower.tip_radius, reference, pivot)

    # ---- checks and figures -----------------------------------------------------------------------------------------

    def limits(self) -> Sequence[Finding]:
        """PRESSURE_ANGLE and CURVATURE of the edge, and what the program does."""
        self._region  # noqa: B018  refuses what is no plate
        allowed = self.allowed.of_cams(0.0)
        unit = self.geometry.follower.unit
        of_program = program_findings(self.program, unit, allowed, _SMOOTHER)
        return [
            *edge_findings(self.cam, allowed, "exact edge", _FLATTER),
            *(replace(each, where=replace(each.where, **_BY_WAY)) for each in of_program),
            *self._borne,
        ]

    # ---- loads ------------------------------------------------------------------------------------------------------

    @cached_property
    def _load(self) -> FollowerLoad | None:
        return load_of(self.load, self.spring)

    @cached_property
    def _loaded(self) -> Loaded | None:
        """Forces along the way; None without [load]."""
        if self._load is None:
            return None
        theta = self._ways
        follower = self.cam.follower
        arm = 1.0 if isinstance(follower, PlateSlide) else abs(follower.arm) * MM
        lever = arm * np.cos(self.cam.pressure_angle(theta))
        found = loaded_by(self._pulled, theta, self.program(theta), lever)
        return replace(found, where=Where("plate", **_BY_WAY))

    @property
    def _ways(self) -> Floats:
        """theta along the way, both sides of each joint too."""
        low, high = self.cam.range
        return np.union1d(np.linspace(low, high, _SAMPLES), self.program.breaks[1:] - 1e-9)

    @cached_property
    def _pressure(self) -> Floats | None:
        """Greatest pressure of a steel roller on the plate's edge along the way, (n,) MPa; None without [load], and of a knife edge."""
        radius = self.geometry.follower.radius
        if self._loaded is None or radius is None:
            return None
        bend = self.cam.follower.pitch_curvature(self._ways, self.program)
        curvature = 1 / (
            radius * (1 - radius * bend)
        )  # 1/R and that of the edge, bend / (1 - R bend)
        own = materials.of(self.material.name)
        steel = materials.STEEL.elastic
        force = self._loaded.force
        return np.asarray(
            line_contact(force, self.making.thickness, curvature, own.elastic, steel)[0]
        )

    @property
    def _hertz(self) -> Finding | NotJudged | None:
        """Of the tip on the plate's edge; None where nothing presses."""
        if self._loaded is None:
            return None
        if self._pressure is None:
            why = "a knife edge touches: it has no width, and no formula gives its pressure"
            return NotJudged("HERTZ", why, "a roller")
        if not np.any(self._pressure):
            return None
        k = int(np.argmax(self._pressure))
        where = Where("plate", theta=float(self._ways[k]), digits=1, **_BY_WAY)
        given = self.allowed.hertz_mpa
        length = self.making.thickness
        return line_hertz(float(self._pressure[k]), length, self.material.name, given, where)

    @property
    def _borne(self) -> list[Finding]:
        """LIFT_OFF, and HERTZ where the roller presses and a limit of the plate's material is known."""
        if self._loaded is None:
            return []
        pressed = [self._hertz] if isinstance(self._hertz, Finding) else []
        least = self.allowed.reserve(self.material.name)
        return [*kept_on(self._loaded, self._load, self._pulled, None, least), *pressed]

    def _unjudged(self) -> Sequence[NotJudged]:
        """HERTZ of a knife edge, and of a material of which no limit is known."""
        return [self._hertz] if isinstance(self._hertz, NotJudged) else []

    @property
    def _load_figures(self) -> list[Figure]:
        if self._loaded is None or self._load is None:
            return []
        figures = [
            Figure("peak contact force", float(np.max(self._loaded.force)), "N"),
            *pushed_figures(self._loaded, self._load, not self.geometry.follower.swings),
        ]
        if self._pressure is not None:
            most = float(np.max(self._pressure))
            figures.append(Figure("hertz pressure {of}", most, "MPa", "contact"))
        return figures

    def study(self) -> Study:
        """Sizes, motion and its derivatives, pressure angle."""
        unit, scale = self.geometry.follower.unit
        low, high = self.program.extremes
        begin, end = self.cam.range
        figures = [
            Figure(
                "swing" if self.geometry.follower.swings else "stroke", scale * (high - low), unit
            ),
            Figure("way", WAY * (end - begin), "mm"),
            Figure("pressure angle", self.cam.steepest, "deg"),
            Figure("curvature radius min", self.cam.least_radius, "mm"),
            *peak_figures(self.program, (unit, scale), self._speed),
            *self._load_figures,
        ]
        return Study(
            Figures(each for each in figures if math.isfinite(each.value)),
            Later(self._plots),
            sketches=Later(lambda: [self._sketch()]),
            notes=Later(self._notes),
        )

    def _plots(self) -> list[Plot]:
        unit, scale = self.geometry.follower.unit
        theta = self._ways
        way = WAY * theta
        names = ("Displacement", "Velocity", "Acceleration")
        units = (unit, f"{unit}/s", f"{unit}/s^2")
        label = "travel of the plate, mm"
        rows = [scale * self._speed**k * self.program(theta, k) for k in range(3)]
        curves = [
            Plot(name, label, text, [("wanted", way, row)])
            for name, text, row in zip(names, units, rows, strict=True)
        ]
        steep = np.degrees(self.cam.pressure_angle(theta))
        curves.append(Plot("Pressure angle", label, "deg", [("exact edge", way, steep)]))
        if self._loaded is not None:
            force = ("follower on plate", way, self._loaded.force)
            curves.append(Plot("Contact force", label, "N", [force]))
        return curves

    def _sketch(self) -> Sketch:
        """The follower at s = 0, in the frame that its pose moves."""
        follower = self.cam.follower
        radius = follower.tip_radius
        if isinstance(follower, PlateSlide):
            line = np.array([follower.start, follower.start + 1j * self.geometry.height])
            centre = follower.start
        else:
            line = np.array([0, follower.arm])
            centre = follower.arm
        return Sketch("follower", [line], [(centre, radius)] if radius else [], "follower")

    def _notes(self) -> list[str]:
        follower = self.cam.follower
        over = f"{follower.trace(0.0).item().imag:.4g} mm over the plate's bottom"
        place = f"at displacement 0 the centre of its tip stands {over}"
        if isinstance(follower, PlateArm):
            pivot = follower.pivot
            place = f"its pivot is at x = {pivot.real:.4g}, y = {pivot.imag:.4g} mm; {place}"
        return [
            f"camgen makes the plate only. You make its slide, the follower with its guide, and what presses it on the edge: {place}.",
            "The plate moves along -x from travel 0, where the follower stands at x = 0 of its files.",
        ]
