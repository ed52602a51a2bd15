"""Any disc cam: a follower that slides or swings, with a roller, a flat face or a knife edge, through segments of motion.

      y                  The cam turns counter-clockwise about O. A translating follower slides along Oy, `offset` to the
      |  | stem          right of O; its output is in mm. An oscillating one has its pivot at (pivot_distance, 0), its arm
      |__|_              or face on the side of -y, where the rise turns it counter-clockwise; its output is an angle.
     ( O  )              At s = 0 the follower stands on the base circle.

closure "force": a spring keeps it on the cam; "conjugate": a second cam drives it back on the other side; "groove": a
roller runs between the cam and an outer wall, three plates pinned together.   [Norton, ch. 7]
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cached_property
from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
from pydantic import Field

from camgen.errors import DesignError, Fault, SpecError
from camgen.findings import Finding, NotJudged
from camgen.geometry.outlines import Floats
from camgen.machine.cams.bounce import Bounce
from camgen.machine.cams.followers import Follower, SlidingFace, SlidingTip, SwingingFace
from camgen.machine.cams.limits import Advice, CamLimits, ExactCam, cam_findings, undercut_numbers
from camgen.machine.cams.machine import (
    CamTouch,
    FollowerLoad,
    Loaded,
    cam_machine,
    loaded,
)
from camgen.machine.cams.many import ProfileFigures
from camgen.machine.cams.profile import DiscCam, SwingingArm
from camgen.machine.cams.sizing import least_base_radius, written
from camgen.machine.features import CamOutline, Demand
from camgen.machine.model import Machine
from camgen.machines.cam_loads import (
    corrected,
    force_study,
    kept_on,
    load_faults,
    load_of,
    polydyne_faults,
)
from camgen.machines.cam_tables import CamTables
from camgen.machines.disc_cam.alone import CamsAlone
from camgen.machines.disc_cam.curves import peak_figures, plots, segments_table, sketch
from camgen.machines.disc_cam.faults import (
    bought_faults,
    closure_faults,
    follower_faults,
    hub_faults,
    key_screw_faults,
)
from camgen.machines.disc_cam.followers import drawn, standing_on
from camgen.machines.disc_cam.tables import (
    DiscCamGeometry,
    DiscCamLimits,
    DiscCamMotor,
    DiscCamParts,
    LoadTable,
    SpringTable,
)
from camgen.machines.disc_cam.walls import CamWalls
from camgen.machines.free_play import between
from camgen.machines.loads.lift_off import bounce_figures, bounce_of
from camgen.machines.loads.tables import CamLimitsTable, thin_walls
from camgen.machines.loads.weights import gravity
from camgen.machines.metal import filled, shaft_notes, shaft_of
from camgen.machines.pairs import air_faults, still_faults
from camgen.motion.program import Program
from camgen.motion.segments import SegmentTable, WholeTurn, program
from camgen.parts import materials
from camgen.parts.assembly import Assembly, FollowerFacts, MotorSeat
from camgen.parts.engraving import with_upper_sides
from camgen.parts.springs import to_wind, wished
from camgen.study import Figure, Figures, Later, Plot, Sketch, Study
from camgen.tolerances import WALL_FACETS

_STEM = 0.5  # of the bore: diameter of a stem of metal
_TIE = 1e-6  # deg or mm from a limit, nearer than which a cam of many is looked at by itself


class DiscCamDrive(CamTables):
    """Spec and answers of a disc cam; the output is the follower's displacement s, mm or rad, 0 on the base circle."""

    doubled: ClassVar[Collection[str]] = ("thickness", "pin_diameter", "set_screw")

    geometry: DiscCamGeometry
    segment: Annotated[tuple[SegmentTable, ...], Field(min_length=1, max_length=100), WholeTurn] = (
        Field(description="segments of the motion: one after another they make the turn")
    )
    motor: DiscCamMotor = DiscCamMotor.model_construct()
    load: LoadTable | None = Field(
        default=None,
        description="mass and loads of the follower, for forces, motor torque, and whether it stays on "
        "the cam",
    )
    spring: SpringTable | None = Field(
        default=None,
        description='closure "force": the spring that presses the follower on the cam; the report says how strong it must be',
    )
    making: Annotated[DiscCamParts, Field(alias="parts")] = DiscCamParts.model_construct()
    allowed: Annotated[DiscCamLimits, Field(alias="limits")] = DiscCamLimits.model_construct()

    @classmethod
    def filled(cls, data: Any) -> Any:
        """The tables with what one of them decides in another."""
        return super().filled(filled(data))

    def faults(self) -> Sequence[Fault]:
        """What is wrong between keys that are right one by one."""
        g = self.geometry
        slides = not g.follower.swings
        sprung = g.closure == "force"
        found = [*follower_faults(g.follower), *closure_faults(g, self.making.make)]
        least = self.allowed.min_wall
        if not self.standing:
            found += hub_faults(self.making, g.closure, least)
            found += key_screw_faults(self.making, self.material.name)
        found += thin_walls(least, self.print.nozzle)
        try:
            self._given  # noqa: B018
        except SpecError as error:
            found += error.faults
        found += self.size_faults("follower")
        tip = None if g.follower.shape == "flat" else g.follower.radius or 0.0
        found += air_faults(("geometry", "tip_clearance"), g.tip_clearance, g.closure, tip)
        found += load_faults(self.load, self.spring, slides, sprung, self.standing)
        if not found and self.load is not None and self.load.polydyne:
            alone = self.standing and sprung
            found += polydyne_faults(self.load, self.spring, self._given, alone)
        found += still_faults(("segment",), [table.kind for table in self.segment])
        name = None if self.load is None else self.load.cam_follower
        if name and not self.standing and g.follower.shape == "roller" and g.follower.radius:
            found += bought_faults(name, g.follower.radius, ("geometry", "follower", "radius"))
        return found

    # ---- motion -----------------------------------------------------------------------------------------------------

    @cached_property
    def _given(self) -> Program:
        """The segments, one after the other."""
        return program(self.segment, 1 / self.geometry.follower.unit[1])

    @cached_property
    def program(self) -> Program:
        """The follower's motion over the turn, mm or rad; on a clockwise cam the segments lie the other way round."""
        made = corrected(self._given, self.load, self.spring, self._speed)
        return made if self._sense > 0 else made.backwards()

    @cached_property
    def _highest(self) -> tuple[float, float]:
        """Least and greatest displacement, mm or rad."""
        return self.program.extremes

    def motion(self, theta: Floats, order: int = 0) -> Floats:
        """Wanted displacement s (mm or rad) or its derivative to theta, (n,)."""
        return self.program(theta, order)

    # ---- the cam ----------------------------------------------------------------------------------------------------

    @cached_property
    def base_radius(self) -> float:
        """The spec's, or the smallest that a workshop writes and that keeps to the allowed pressure angle and least radius, with room for its holes."""
        if self.geometry.base_radius is not None:
            return self.geometry.base_radius
        return written(*self._least_base)

    @cached_property
    def _least_base(self) -> tuple[float, Callable[[float], bool]]:
        """The smallest base radius that holds what it must, mm, and whether another one does."""
        return least_base_radius(self._cam(drawn(self.geometry)), self.cam_limits, self._room)

    @property
    def _room(self) -> float:
        """Radius of the circle that holds the cam's shaft, its hub and a groove's pins, with walls, mm."""
        p = self.making
        wall = 2 * self.allowed.min_wall
        shaft = (p.shaft_diameter + self.print.press_clearance) / 2 if self.standing else p.reach
        pins = wall / 2 + 1.5 * p.pin_diameter if self.geometry.closure == "groove" else 0.0
        hub = 0.0 if self.standing or not p.hub_height else p.hub_diameter
        return max(shaft + pins, hub / 2) + wall

    @property
    def _is_as_wide_as_its_hub(self) -> bool:
        """Whether the base radius is open, and its motion alone would be content with a smaller one."""
        return self.geometry.base_radius is None and self._least_base[0] <= self._room * (1 + 1e-9)

    def _found(self) -> Mapping[str, object]:
        """The base radius, and what all cams fill in."""
        steepest = self.cam_limits.steepest(self.cam)
        return {
            **super()._found(),
            "geometry.base_radius": self.base_radius,
            "limits.pressure_angle_deg": steepest,
        }

    @cached_property
    def cams(self) -> list[DiscCam[Follower]]:
        """The cam; with conjugate closure also the second one."""
        return [
            self._cam(follower)
            for follower in standing_on(self.base_radius, self.geometry, self._highest[1])
        ]

    def _cam(self, follower: Follower) -> DiscCam[Follower]:
        return DiscCam(self.program, follower, self.geometry.tip_clearance)

    @property
    def cam(self) -> DiscCam[Follower]:
        """The cam that drives outwards."""
        return self.cams[0]

    @property
    def sizes(self) -> DiscCamParts:
        """[parts]."""
        return self.making

    def _cam_machine(self) -> Machine:
        """Cam and follower; output "lift", mm, or "swing", rad."""
        closed: Literal["form", "force"] = "force" if self.geometry.closure == "force" else "form"
        groove = (
            (CamTouch(self.cam), CamTouch(self.cam, outer=True))
            if self.geometry.closure == "groove"
            else ()
        )
        return cam_machine(self.cams, self._speed, self._load, closed, groove)

    def _unloaded(self) -> Machine:
        if not self.standing:
            return self._cam_machine()
        return super()._unloaded()

    # ---- what it is as a linkage ------------------------------------------------------------------------------------

    def tables(self) -> Mapping[str, Any]:
        """Cam and follower, which stands on its base circle; a spring where that is what holds it."""
        f = self.geometry.follower
        suffix = "" if self.geometry.follower.unit[0] == "mm" else "_deg"
        tip = self._touching
        follower = self.cam.follower
        points = {"shaft": 0j, "tip": tip}
        links = {"ground": ["shaft"], "cam": ["shaft"]}
        found: dict[str, Any] = {}
        if isinstance(follower, SlidingTip | SlidingFace):
            points |= {"rest": tip, "above": tip + follower.along}
            links |= {"ground": ["shaft", "rest", "above"], "follower": ["tip"]}
            found["slide"] = ({"name": "guide", "link": "follower", "along": ("rest", "above")},)
        else:
            pivot = complex(self.geometry.follower.pivot_distance or 0.0)
            points |= {"pivot": pivot, "level": 2 * pivot}  # its angle is 0 at s = 0
            links |= {"ground": ["shaft", "pivot"], "follower": ["pivot", "level", "tip"]}
        cam = {
            "name": "contact",
            "cam": "cam",
            "follower": "follower",
            "at": "tip",
            "segment": tuple(self._segment(row, suffix) for row in self.segment),
            "closure": self.geometry.closure,
            "tip_clearance": self.geometry.tip_clearance,
            **f.model_dump(include={"shape", "radius", "face_width"}),
        }
        if self.geometry.closure == "force":
            cam["spring"] = self.spring.model_dump() if self.spring else {}
        if self.load is not None:
            cam |= self.load.model_dump(include={"damping", "resistance", "polydyne"})
            found["masses"] = self.load.of_follower()
        bears = self.allowed.model_dump(include={*CamLimitsTable.model_fields, "min_wall"})
        own = {f"{key}{suffix}": getattr(self.allowed, key) for key in ("undercut", "lash")}
        return {
            "points": {name: (z.real, z.imag) for name, z in points.items()},
            "links": links,
            "drive": {"link": "cam", "speed_rpm": self.motor.speed_rpm},
            "cam": (cam,),
            "output": ({"name": "swing" if suffix else "lift", "link": "follower"},),
            "parts": self.making.of_linkage(),
            "limits": bears | own,
            **found,
        }

    @staticmethod
    def _segment(row: SegmentTable, suffix: str) -> dict[str, Any]:
        """As a [[cam.segment]]."""
        names = {"lift": f"lift{suffix}", "to": f"to{suffix}", "inflection": "lambda"}
        return {names.get(key, key): value for key, value in row if value is not None}

    @property
    def _touching(self) -> complex:
        """Where the follower touches at s = 0, on a face in the middle of its way, on the ground."""
        match self.cam.follower:
            case SwingingArm(pivot, arm):
                return pivot + arm
            case SlidingTip(start) | SlidingFace(start):
                return start
            case SwingingFace(pivot, facing, ahead):
                if ahead:
                    raise DesignError(
                        "geometry.follower.face_offset",
                        ahead,
                        0,
                        "mm",
                        "the arm of a face",
                        'its line goes through its pivot: use 0, or make the cams alone (parts.make = "cams")',
                    )
                return pivot + facing * 0.5j * sum(self.cam.face_contact)
        raise TypeError(f"no machine for {type(self.cam.follower).__name__}")

    @cached_property
    def assembly(self) -> Assembly:
        """The cams, or the whole machine."""
        if not self.standing:
            return self._bare()
        return super().assembly

    @cached_property
    def _load(self) -> FollowerLoad | None:
        return load_of(self.load, self.spring)

    @cached_property
    def _loaded(self) -> Loaded | None:
        """Forces over the turn, to either side of the program's breaks; None of a cam alone without [load]."""
        if self._load is None and not self.standing:
            return None
        breaks = self.program.breaks[(self.program.breaks > 0) & (self.program.breaks < math.tau)]
        theta = np.union1d(np.linspace(0, math.tau, 1441), breaks - 1e-9)
        return loaded(self._pulled, self.cam, self._load or FollowerLoad(), theta)

    @cached_property
    def _bounce(self) -> Bounce | None:
        """What the follower does where no spring holds it; None where it is held, or where that is not known."""
        if not self._loaded or self.geometry.closure != "force":
            return None
        return bounce_of(self._pulled, self._loaded, self.load)

    @property
    def _spring_wish(self) -> tuple[float, float, float] | None:
        """Of a cam alone beside a sliding stem, as [spring] says."""
        if self.spring is None or not self.spring.preload or self.geometry.follower.unit[0] != "mm":
            return None
        return self.spring.rate, self.spring.preload, self._highest[1] - self._highest[0]

    @property
    def _stem(self) -> float:
        """Diameter of the follower's stem, mm, round which a spring presses it on a cam of metal: camgen's own rule; else 0."""
        return _STEM * self.making.bore if materials.of(self.material.name).metal else 0.0

    def _unjudged(self) -> Sequence[NotJudged]:
        """Of a cam alone without a load: a material that is not printed has a strength that wants to be judged."""
        if self.standing or self._load is not None or materials.of(self.material.name).printed:
            return ()
        codes = ("LIFT_OFF", "HERTZ") if self.geometry.closure == "force" else ("HERTZ",)
        why = "the spec does not say which force presses the follower on the cam"
        needs = "[load], with the mass that moves, and [spring]" if len(codes) > 1 else "[load]"
        return [NotJudged(code, why, needs) for code in codes]

    # ---- parts ------------------------------------------------------------------------------------------------------

    @cached_property
    def _alone(self) -> CamsAlone:
        return CamsAlone(
            self.geometry,
            self.making,
            self.cams,
            self.cam_limits,
            self.allowed.min_wall,
            self.print.slide_clearance,
            self.material.name,
            self._sense,
        )

    def _bare(self) -> Assembly:
        """The cams alone."""
        alone = self._alone
        groove = self.geometry.closure == "groove"
        parts = [*with_upper_sides(alone.plates, alone.outlines), *alone.shoe]
        made = self._assembly(parts, alone.mounts(), alone.outlines)
        spring = wished(self._spring_wish, self._stem)
        hub = self.making.hub(self.allowed.min_wall)
        name = alone.plates[0].name
        screw = [] if hub is None else hub.bought(self.making.hub_diameter / 2, name)
        on_key = self.making.key_screw
        tapped = sum(part.tap is not None for part in alone.plates)
        screw += [] if on_key is None else on_key.bought(tapped)
        heights = {part.name: part.thickness for part in parts}
        length = max(mount.z + heights[mount.part] for mount in made.mounts if mount.body == "cam")
        lengths = [length] if groove else [part.thickness for part in alone.plates]
        carried = shaft_of(
            self.making, self.material.name, self.motor.model, lengths, self.drawing.key_fit
        )
        return replace(
            made,
            springs=spring,
            bought=[
                *carried[:1],
                *screw,  # before the bearings
                *carried[1:],
                *to_wind(self._spring_wish, self._stem),
                *alone.dowels(),
                *alone.screws(),
            ],
            motor=MotorSeat(hub=hub),
            dowel=self.making.pin_diameter if groove else 0.0,
            thread=alone.screw.thread if groove and alone.screw else "",
            follower=FollowerFacts(wish=self._spring_wish),
            demands=self.demands(),
        )

    def demands(self) -> tuple[Demand, ...]:
        """The play that is borne."""
        return (
            Demand(
                self.model.outputs[0].name, lash=self.allowed.lash / self.geometry.follower.unit[1]
            ),
        )

    # ---- checks and study -------------------------------------------------------------------------------------------

    @property
    def cam_limits(self) -> CamLimits:
        """What is accepted of the cams."""
        return self.allowed.of_cams(self.allowed.undercut / self.geometry.follower.unit[1])

    @cached_property
    def _clears_axle(self) -> bool:
        """Whether the cams are known to clear the follower's axle; else their facets are looked at."""
        return False

    @classmethod
    def prepare(cls, many: Sequence[Self]) -> None:
        """Figures of all their cams at once, of those that are cams alone, given by their size, without load."""
        from camgen.machines.disc_cam.variants import fill

        alone = []
        for each in many:
            if each.geometry.base_radius is not None and not each.standing and each.load is None:
                with suppress(DesignError):  # told when its limits are asked for
                    alone.append((each, each.cams))
        filled = fill([(cams, each._sure) for each, cams in alone])
        for (each, _), clears in zip(alone, filled, strict=True):
            if clears:
                vars(each).update(_clears_axle=True)

    def _sure(self, cam: DiscCam[Any], figures: ProfileFigures) -> bool:
        """Whether no rounding can turn a verdict on figures of a cam, and it clears its follower's axle in any case."""
        follower = self.geometry.follower
        limits = self.allowed
        width = 2 * max(figures.face_to, -figures.face_from)
        room = math.inf
        if follower.swings:
            width = figures.face_to - figures.face_from
            room = (follower.pivot_distance or 0.0) - figures.farthest
        near = [
            figures.steepest - self.cam_limits.steepest(cam),
            figures.least_radius - limits.least_radius,
        ]
        if follower.face_width:
            near.append(width - follower.face_width)
        return room > self.accuracy.chord_tolerance and not any(abs(each) < _TIE for each in near)

    def findings(self) -> Sequence[Finding]:
        """None beside those of its cams, which `limits` has."""
        return ()

    def limits(self) -> Sequence[Finding]:
        """Pressure angle, undercut, curvature, face width and jumps of the motion against the spec's limits."""
        f = self.geometry.follower
        further = "an offset towards the rise" if not f.swings else "another arm or pivot_distance"
        larger = "a larger base_radius (where it is left out, camgen takes the smallest that holds)"
        advice = Advice(
            f"{larger}, a longer span or {further}",
            larger + (" or a smaller radius" if f.shape == "roller" else ""),
        )
        cams = [
            ExactCam(f"exact profile{name}", cam, advice)
            for cam, name in zip(self.cams, self._names, strict=True)
        ]
        facets = None if self._clears_axle or self.standing else self.accuracy.chord_tolerance
        findings = cam_findings(
            cams, self.cam_limits, face_width=f.face_width, chord_tolerance=facets
        )
        if self._loaded and self.geometry.closure == "force":
            least = self.allowed.reserve(self.material.name)
            findings += kept_on(self._loaded, self._load, self._pulled, self._bounce, least)
        return findings

    def forecast(self) -> Sequence[Finding]:
        """Design checks and forecasts; of cams alone what holes leave of them, and the free play of a follower between two contacts."""
        if self.standing:
            return super().forecast()
        air = (
            self.print.slide_clearance
            if self.geometry.closure == "groove"
            else self.geometry.tip_clearance
        )
        return [
            *self.limits(),
            *CamWalls(
                self.cams,
                self.making,
                self.geometry.closure == "groove",
                self.allowed.min_wall,
                2 * max(WALL_FACETS, self.accuracy.chord_tolerance),
                lambda: self.assembly.parts,
                self._alone.screw.clearance if self._alone.screw else 0.0,
            ).findings(),
            *between(self.cams, air, self.allowed.lash / self.geometry.follower.unit[1]),
        ]

    @property
    def _names(self) -> list[str]:
        if len(self.cams) == 1:
            return [""]
        if not self.standing:
            return [" of cam-1", " of cam-2"]
        return [
            f" of {each.part}" for each in self.assembly.features if isinstance(each, CamOutline)
        ]

    def study(self) -> Study:
        """Its own figures: those of a linkage say the same."""
        return self.figures()

    def figures(self) -> Study:
        """Figures of the cam, motion and its derivatives, pressure angle, curvature and the profile coloured by the former."""
        return Study(
            self._figures(),
            Later(self._plots),
            Later(lambda: [segments_table(self.program, self.geometry.follower.unit)]),
            Later(self._sketches),
            Later(lambda: [*self._notes(), *self._forces.notes]),
        )

    def _plots(self) -> list[Plot]:
        """Motion, pressure angle, curvature, profile and forces."""
        who = [name.strip() or "exact profile" for name in self._names]
        curves = plots(
            self.program, self.cams, who, self.geometry.follower.unit, self._speed, self.base_radius
        )
        return [*curves, *self._forces.plots]

    def _sketches(self) -> list[Sketch]:
        """Of cams alone the shaft, and the follower that is no part."""
        shaft = Sketch("ground", (), ((0j, self.making.bore / 4),))
        if self.standing:
            return []
        drawn_in = self.geometry.follower.shape == "outline"
        width = self.geometry.follower.face_width
        return [shaft] if drawn_in else [sketch(self.cams, self.base_radius, width), shaft]

    def _figures(self) -> Figures:
        """Sizes of the cam, peaks of its motion, and of its forces."""
        unit, scale = self.geometry.follower.unit
        f = self.geometry.follower
        cam = self.cam
        low, high = self._highest
        figures = [
            Figure("stroke" if unit == "mm" else "swing", scale * (high - low), unit),
            Figure("base radius", self.base_radius, "mm"),
            Figure("prime radius", self.base_radius + (f.radius or 0.0), "mm"),
            Figure("pressure angle", max(each.steepest for each in self.cams), "deg"),
            Figure("curvature radius min", min(each.least_radius for each in self.cams), "mm"),
            *peak_figures(self.program, (unit, scale), self._speed),
            Figure("profile length", cam.length, "mm"),
            Figure("profile area", cam.area, "mm²"),
            *undercut_numbers(self.cams).records,
        ]
        if f.shape == "flat":
            wide = max(high - low for low, high in (each.face_contact for each in self.cams))
            figures.append(Figure("face width needed", wide, "mm"))
        elif f.shape != "outline":
            pitch = cam.least_radius + cam.tip.tip_radius
            figures.append(Figure("pitch curvature radius min", pitch, "mm"))
        figures += bounce_figures(self._bounce, not f.swings)
        return Figures(figures) | self._forces.numbers

    @cached_property
    def _forces(self) -> Study:
        if not self._loaded:
            return Study()
        pushed = self.geometry.closure == "force"
        slides = not self.geometry.follower.swings
        return force_study(
            self._loaded, self._load or FollowerLoad(), slides, pushed, bool(gravity(self.load))
        )

    def _notes(self) -> list[str]:
        notes = [
            "A translating follower's output is in mm, an oscillating one's in degrees; theta is counter-clockwise."
        ]
        if math.isinf(self.program.peak(2)):
            notes.append(
                "The velocity jumps, so the acceleration has no finite peak; its curve leaves the jumps out."
            )
        if self.standing:
            from camgen.parts.generator.troughs import open_rails

            notes += open_rails(self.linkage.bodies.layout)
        elif self.geometry.closure == "force" and not self._loaded:
            notes.append(
                "You must press the follower on the cam yourself. With [load] and [spring] in the spec, LIFT_OFF and HERTZ judge whether it stays on and how hard it presses."
            )
        if not self.standing:
            notes += shaft_notes(self.making, self.material.name, self.motor.model)
        if self._is_as_wide_as_its_hub:
            keys = "parts.shaft_diameter" if self.standing else "parts.bore, parts.hub_diameter"
            notes.append(
                f"geometry.base_radius = {self.base_radius:g} comes from the room that the cam needs, not from its motion: {keys}"
                f"{', parts.pin_diameter' if self.geometry.closure == 'groove' else ''} and limits.min_wall."
            )
        if self.allowed.continuous < 0:
            notes.append("Jumps of the motion are not judged: limits.continuous = -1.")
        return notes
