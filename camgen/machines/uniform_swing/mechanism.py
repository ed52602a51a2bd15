"""The uniform-swing cam drive: a cam that swings a follower frame to and fro at constant angular speed.

                      B ----------- A          O cam centre (origin), A fixed pivot at (L, 0)
                      |             :          A-B-C the follower, AB = H, BC = L, right angle at B,
       O              |             :          C the tip that touches the cam; drawn turned by 90 deg
                      C

In mid position O, A, B, C is a rectangle with C = (0, -H). The follower's angle s is its turn from there; the tip leaves
the cam as s grows. With closure "conjugate" a second tip, mirrored in OA, rides on the same cam turned over about Oy.
[Sentyakov et al., Vestnik TGTU 2018, 24(4), 698-706, with the signs of eqs. 7, 8 and 11 corrected]
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Annotated

import numpy as np
from pydantic import Field

from camgen.errors import DesignError, Fault
from camgen.findings import Finding, NotJudged
from camgen.geometry.outlines import Floats
from camgen.machine.cams.limits import (
    ARM_PRESSURE,
    Advice,
    ExactCam,
    cam_findings,
    undercut_numbers,
)
from camgen.machine.cams.machine import CamTouch, FollowerLoad, Loaded, cam_machine, cam_outline
from camgen.machine.cams.profile import DiscCam, SwingingArm
from camgen.machine.features import Demand, Eye, Feature, Mount, OwnTip
from camgen.machine.model import Machine
from camgen.machines.cam_loads import lift_off, unweighed
from camgen.machines.mechanism import Mechanism
from camgen.machines.pairs import air_faults
from camgen.machines.uniform_swing.cam_plate import CamPlate
from camgen.machines.uniform_swing.pictures import Model, pictures
from camgen.machines.uniform_swing.printed import SwingMachine
from camgen.machines.uniform_swing.room import Check, machine_checks
from camgen.machines.uniform_swing.shopping import bought, screw_grip, steps
from camgen.machines.uniform_swing.study import (
    NO_SPRING,
    blend_study,
    canvas_study,
    force_study,
    forces,
    source_figures,
)
from camgen.machines.uniform_swing.tables import (
    BaseTable,
    ColletTable,
    FrameTable,
    NozzleTable,
    SpringTable,
    SwingGeometry,
    SwingLimits,
    SwingMotor,
    SwingParts,
    SwingSizes,
)
from camgen.motion.program import uniform_swing
from camgen.numerics import greatest
from camgen.parts.assembly import Assembly, FollowerFacts, MotorSeat
from camgen.parts.inertia import inertia_of
from camgen.parts.springs import to_wind, wished
from camgen.study import Later, Plot, Sketch, Study, Table


class UniformSwing(Mechanism):
    """Spec and answers of a uniform-swing cam drive; the output is the follower's angle s, rad, 0 in mid position."""

    geometry: SwingGeometry
    motor: SwingMotor = SwingMotor.model_construct()
    making: Annotated[SwingParts, Field(alias="parts")] = SwingParts.model_construct()
    base: BaseTable = BaseTable.model_construct()
    frame: FrameTable = FrameTable.model_construct()
    collet: ColletTable = Field(
        default=ColletTable.model_construct(), description="for a plain shaft"
    )
    nozzle: NozzleTable = NozzleTable.model_construct()
    spring: SpringTable = Field(
        default=SpringTable.model_construct(),
        description="of force closure, as it acts on the frame",
    )
    allowed: Annotated[SwingLimits, Field(alias="limits")] = SwingLimits.model_construct()

    def faults(self) -> Sequence[Fault]:
        """What is wrong between keys that are right one by one."""
        p, nozzle, blend = self.making, self.print.nozzle, self.geometry.reversal_blend_deg
        checks: list[Check] = [
            (
                blend in (0, 180) or 0.01 <= blend <= 179.99,
                ("geometry", "reversal_blend_deg"),
                blend,
                "0 (sharp), 0.01 to 179.99, or 180",
            ),  # a stretch of less would be rounding
            (p.wall >= nozzle, ("parts", "wall"), p.wall, f"at least the nozzle, {nozzle:g} mm"),
            (
                self.allowed.min_wall >= nozzle,
                ("limits", "min_wall"),
                self.allowed.min_wall,
                f"at least the nozzle, {nozzle:g} mm",
            ),
            (
                p.mark_depth < p.thickness,
                ("parts", "mark_depth"),
                p.mark_depth,
                f"less than the thickness, {p.thickness:g} mm",
            ),
        ]
        if p.make == "machine":
            checks += machine_checks(self.sizes)
        deg = None if self.load is None else self.load.gravity_deg
        weight = (
            None
            if deg is None
            else unweighed(deg, bool(self.nozzle.inertia_kg_m2), p.make == "machine")
        )
        found = [
            Fault(path, f"{value:g}", expected)
            for fine, path, value, expected in checks
            if not fine
        ]
        g = self.geometry
        found += air_faults(("geometry", "tip_clearance"), g.tip_clearance, g.closure, g.tip_radius)
        return [*found, *p.misfits(), *([] if weight is None else [weight])]

    @cached_property
    def cam(self) -> DiscCam:
        """The cam engine set up for this spec; raises DesignError where the follower cannot swing so far."""
        g = self.geometry
        arm = -complex(g.pivot_distance, g.arm_offset)
        room = 2 * math.atan2(g.arm_offset, g.pivot_distance)
        if math.radians(g.swing_deg) >= room:
            raise DesignError(
                "geometry.swing_deg",
                g.swing_deg,
                math.degrees(room),
                "deg",
                "the inner end of the swing",
                "the tip reaches the line of the two shafts there: use a smaller one, or a geometry.arm_offset above "
                f"{g.pivot_distance * math.tan(math.radians(g.swing_deg / 2)):.4g} mm",
            )
        program = uniform_swing(math.radians(g.swing_deg), math.radians(g.reversal_blend_deg))
        return DiscCam(
            program,
            SwingingArm(complex(g.pivot_distance), arm, g.tip_radius, leaves=1),
            g.tip_clearance,
        )

    def _found(self) -> Mapping[str, object]:
        """The pressure angle that is accepted, and what every mechanism fills in."""
        return {
            **super()._found(),
            "limits.pressure_angle_deg": self.allowed.cam_limits.steepest(self.cam),
        }

    def _unloaded(self) -> Machine:
        """Cam and follower; output "swing", rad."""
        pair = self.geometry.closure == "conjugate"
        touches = (CamTouch(self.cam), CamTouch(self.cam, mirrored=True))[: 1 + pair]
        return cam_machine(
            [self.cam],
            self._speed,
            self._load,
            "form" if pair else "force",
            touches,
            self.nozzle.friction,
        )

    def motion(self, theta: Floats, order: int = 0) -> Floats:
        """Wanted angle s of the follower (rad) or its derivative to theta, (n,)."""
        return self.cam.program(theta, order)

    # ---- parts ------------------------------------------------------------------------------------------------------

    @cached_property
    def assembly(self) -> Assembly:
        """The cam, with conjugate closure two of it, one of them turned over about Oy; or the whole machine.

        Pin holes lie on Ox at equal distances and keyway or flat on Oy, so the turned part fits the other one.
        """
        springs = wished(self._spring_wish)
        lever = f"; pulls square to a lever of {self.spring.lever:g} mm about the pivot, no eye is made for it"
        wound = [replace(each, size=each.size + lever) for each in to_wind(springs)]
        demands = (Demand("swing", lash=math.radians(self.allowed.lash_deg)),)
        machine, facts = self.machine, FollowerFacts(wish=self._spring_wish)
        if machine is None:
            part = self.plate.part
            above = self.making.thickness + self.print.slide_clearance
            mounts = (Mount("cam", "cam"), Mount("cam", "cam", flipped=True, z=above))
            return replace(
                self._assembly((part,), mounts[: part.count], self._features),
                demands=demands,
                bought=wound,
                springs=springs,
                journals={},
                motor=MotorSeat(self.base.motor),
                follower=facts,
            )
        return replace(
            self._assembly(machine.parts, machine.mounts, self._features),
            demands=demands,
            stand_ins=machine.stand_ins(),
            bought=(*bought(machine), *wound),
            springs=springs,
            journals=machine.journals(self.material.name),
            motor=MotorSeat(self.base.motor, machine.shaft_needed),
            follower=replace(facts, roller=self.frame.bearing),
            work=Later(lambda: [steps(machine)]),
        )

    @property
    def _spring_wish(self) -> tuple[float, float, float] | None:
        """Of force closure: a straight one on the spec's lever, as [spring] asks: N/mm, least N, travel, mm."""
        spring, lever = self.spring, self.spring.lever
        if self.geometry.closure != "force" or not spring.preload:
            return None
        return (
            1e3 * spring.rate / lever**2,
            1e3 * spring.preload / lever,
            lever * math.radians(self.geometry.swing_deg),
        )

    @cached_property
    def sizes(self) -> SwingSizes:
        """The tables from which the parts follow."""
        return SwingSizes(
            self.geometry,
            self.making,
            self.base,
            self.frame,
            self.collet,
            self.nozzle,
            self.print,
            self.allowed.min_wall,
        )

    @cached_property
    def plate(self) -> CamPlate:
        """The cam as a plate."""
        return CamPlate(self.sizes, self.cam, self._sense)

    @cached_property
    def machine(self) -> SwingMachine | None:
        """All that is made round the cam; None of cams alone. DesignError where there is no room for it."""
        if self.making.make != "machine":
            return None
        plate = self.plate
        plate.room.check()
        return SwingMachine(plate, plate.part)

    # ---- assembly ---------------------------------------------------------------------------------------------------

    @cached_property
    def _features(self) -> Sequence[Feature]:
        follower, own = self.cam.follower, None
        if self.machine is not None:
            seat = self.sizes.tip_hole
            tip = Eye("frame", follower.arm, seat or 2 * follower.tip_radius, shaft=not seat)
            bore = Eye("frame", 0j, self.machine.frame_part.bore or 0.0)
            own = OwnTip("frame", tip, bore, follower.tip_radius if seat else None)
        first = cam_outline(self.cam, "cam", self.allowed.cam_limits, self.making.bore, own=own)
        if self.geometry.closure == "force":
            return (first,)
        tip = Eye(None, follower.arm.conjugate(), 2 * follower.tip_radius)
        return (first, replace(first, tip=tip, leaves=-1, copy=1, own=None))

    @cached_property
    def _pressure(self) -> tuple[float, float]:
        """Largest pressure angle over the rise and over the return, less the undercut, deg."""
        return (
            self.cam.steepest_between(0.0, math.pi, riding=False),
            self.cam.steepest_between(math.pi, math.tau, riding=False),
        )

    def limits(self) -> Sequence[Finding]:
        """Pressure angle and undercut of the exact cam against the spec's limits."""
        rise, back = self._pressure
        advice = Advice(
            f"rise {rise:.1f} deg, return {back:.1f} deg; a smaller geometry.swing_deg or a larger geometry.arm_offset",
            "a smaller geometry.tip_radius or a geometry.reversal_blend_deg",
            "a geometry.reversal_blend_deg joins them",
        )
        cams = [ExactCam("exact profile", self.cam, advice)]
        findings = cam_findings(
            cams, self.allowed.cam_limits, chord_tolerance=self.accuracy.chord_tolerance
        )
        if self.machine is not None:
            findings.append(screw_grip(self.machine))
        loaded = self._forces
        if loaded and self.geometry.closure == "force":
            less = "less inertia or a longer reversal_blend_deg"
            findings.append(lift_off(loaded, self._load, False, NO_SPRING, less))
        return findings

    def _unpressed(self) -> Sequence[NotJudged]:
        """LIFT_OFF of force closure where nothing says what swings."""
        if self._forces or self.geometry.closure != "force":
            return ()
        return (
            NotJudged(
                "LIFT_OFF", "nothing says what the spring has to move", "nozzle.inertia_kg_m2"
            ),
        )

    @cached_property
    def _load(self) -> FollowerLoad:
        """Nozzle and frames about the pivot, and the spring of force closure."""
        inertia = self.nozzle.inertia_kg_m2
        if self.machine is not None:
            frame = self.machine.frame_part
            inertia += frame.count * inertia_of(frame, self._process.density)
        pushed = self.geometry.closure == "force"
        return FollowerLoad(
            inertia,
            0.0,
            self.spring.rate if pushed else 0.0,
            self.spring.preload if pushed else 0.0,
        )

    @cached_property
    def _forces(self) -> Loaded | None:
        """Forces over the turn, where an inertia is known: the frames' of a machine, or the nozzle's."""
        if not self._load.inertia:
            return None
        return forces(self._pulled, self.cam, self._load)

    def recovered(self, theta: Floats, motion: Mapping[str, Floats]) -> Study:
        """The canvas that the recovered motion lays; for a machine also the choice of the blend."""
        laid = canvas_study(theta, motion)
        if self.making.make == "cams":
            return laid
        choice = blend_study(self.cam, math.radians(self.geometry.reversal_blend_deg))
        return replace(
            laid, plots=[*laid.plots, *choice.plots], tables=[*laid.tables, *choice.tables]
        )

    def study(self) -> Study:
        """Figures, speed and pressure-angle curves, and the remedies for what the design suffers from."""
        g, cam = self.geometry, self.cam
        theta = np.linspace(0, 2 * math.pi, 1441)
        radius = np.abs(cam.pitch(theta))
        rpm = abs(self.motor.speed_rpm)
        speed = float(np.max(np.abs(cam.program(theta, 1))))
        numbers = {
            "swing_deg": g.swing_deg,
            "speed_ratio": 1 / speed,
            **source_figures(g.pivot_distance, g.arm_offset, math.radians(g.swing_deg)),
            "uniform_share_percent": 100 * (1 - g.reversal_blend_deg / 180),
            "follower_speed_deg_s": math.degrees(speed) * rpm * math.tau / 60,
            "peak_speed_mm_s": abs(cam.follower.arm) * speed * rpm * math.tau / 60,
            "pitch_radius_min_mm": float(np.min(radius)),
            "pitch_radius_max_mm": float(np.max(radius)),
            "pitch_curvature_radius_min_mm": 1 / greatest(cam.curvature, 0.0, 2 * math.pi)[1],
            "profile_length_mm": cam.outline.length,
            "profile_area_mm2": cam.outline.area,
            "pressure_angle_rise_deg": self._pressure[0],
            "pressure_angle_return_deg": self._pressure[1],
            **undercut_numbers([cam]),
        }
        if self.machine is not None:
            numbers["shaft_length_mm"] = self.machine.shaft_length
            # the frame shifts on its axle by half the clearance, which turns it until the tip is on the cam again
            across = abs(cam.follower.arm) * math.cos(math.radians(self.cam.steepest))
            numbers["swing_by_play_of_axle_deg"] = math.degrees(
                self.print.slide_clearance / 2 / across
            )
        degrees = np.degrees(theta)
        steep = np.degrees(cam.pressure_angle(theta))
        lever = self.spring.lever if g.closure == "force" else None
        loaded = force_study(self._forces, self._load, lever) if self._forces else Study()
        undercut = Table(
            "Undercut of the exact profile",
            ("from, deg", "to, deg", "largest shortfall, deg", "at, deg", "at the tip, mm"),
            [
                [
                    math.degrees(u.begin),
                    math.degrees(u.end),
                    math.degrees(u.shortfall),
                    math.degrees(u.worst),
                    u.depth,
                ]
                for u in cam.undercuts
            ],
        )
        return Study(
            numbers | dict(loaded.numbers),
            plots=(
                *loaded.plots,
                Plot(
                    "Pressure angle", "cam angle, deg", "deg", [("exact profile", degrees, steep)]
                ),
                *pictures(Model(g.pivot_distance, g.arm_offset, math.radians(g.swing_deg), cam)),
            ),
            tables=(undercut,) if cam.undercuts else (),
            sketches=self._sketches() if self.making.make == "cams" else (),
            notes=(*self._notes(), *loaded.notes),
        )

    def _sketches(self) -> tuple[Sketch, Sketch]:
        arm, rho = self.cam.follower.arm, self.cam.follower.tip_radius
        corner = 1j * arm.imag
        strokes = [np.array([0, corner, arm])]
        circles = [(arm, rho)] if rho else []
        if self.geometry.closure == "conjugate":
            strokes.append(np.conj(strokes[0]))
            circles += [(z.conjugate(), r) for z, r in circles]
        pivots = [
            (0j, self.making.bore / 4),
            (complex(self.geometry.pivot_distance), self.making.bore / 4),
        ]
        return Sketch("follower", strokes, circles, "follower"), Sketch("ground", (), pivots)

    def _notes(self) -> tuple[str, ...]:
        notes = [
            "Source: Sentyakov et al., Vestnik TGTU 2018, 24(4), 698-706, which gives no lengths: these are the spec's own.",
            "MOTION_ERROR compares with the wanted motion less the undercut that the spec implies; UNDERCUT states that loss.",
        ]
        if self.cam.steepest > ARM_PRESSURE:
            tilt = math.degrees(cmath.phase(-self.cam.follower.arm))
            notes.append(
                f"The tip's path is tilted by {tilt:.1f} deg against the radius, which helps the rise and harms the return; "
                "the conjugate pair does not change that. Remedies: a smaller swing, another arm_offset / pivot_distance, or "
                "a disc cam with its pivot placed so that the arm is square to the cam's radius in mid position."
            )
        if self.machine is not None:
            notes.append(self.machine.shaft_note)
            notes += self.machine.smaller
        return tuple(notes)
