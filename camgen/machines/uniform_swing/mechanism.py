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

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Annotated, ClassVar

import numpy as np
from pydantic import Field

from camgen.errors import DesignError, Fault
from camgen.findings import Finding, NotJudged
from camgen.geometry.outlines import Floats
from camgen.machine.cams.limits import (
    Advice,
    ExactCam,
    cam_findings,
)
from camgen.machine.cams.machine import CamTouch, FollowerLoad, cam_machine, cam_outline, loaded
from camgen.machine.cams.profile import DiscCam, SwingingArm
from camgen.machine.features import Demand, Eye, Feature, Mount, OwnTip
from camgen.machine.model import Machine
from camgen.machines.cam_loads import reserve, unweighed
from camgen.machines.loads.lift_off import bounce_of
from camgen.machines.mechanism import Mechanism
from camgen.machines.pairs import air_faults
from camgen.machines.uniform_swing.cam_plate import CamPlate
from camgen.machines.uniform_swing.printed import SwingMachine
from camgen.machines.uniform_swing.room import faults
from camgen.machines.uniform_swing.shopping import bought, screw_grip, steps
from camgen.machines.uniform_swing.study import (
    SwingForces,
    blend_study,
    canvas_study,
    figures,
    pressure_angles,
    sketches,
)
from camgen.machines.uniform_swing.tables import (
    OLD_WORDS,
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
from camgen.parts.assembly import Assembly, FollowerFacts, MotorSeat
from camgen.parts.inertia import inertia_of
from camgen.parts.springs import to_wind, wished
from camgen.study import ROWS, Later, Study, together
from camgen.vocabulary import OldWords


class UniformSwing(Mechanism):
    """Spec and answers of a uniform-swing cam drive; the output is the follower's angle s, rad, 0 in mid position."""

    old_words: ClassVar[OldWords] = {**Mechanism.old_words, **OLD_WORDS}

    geometry: SwingGeometry
    motor: SwingMotor = SwingMotor.model_construct()
    making: Annotated[SwingParts, Field(alias="parts")] = SwingParts.model_construct()
    base: BaseTable = BaseTable.model_construct()
    frame: FrameTable = FrameTable.model_construct()
    collet: ColletTable = Field(
        default=ColletTable.model_construct(), description="a collet for a plain shaft"
    )
    nozzle: NozzleTable = NozzleTable.model_construct()
    spring: SpringTable = Field(
        default=SpringTable.model_construct(),
        description="the spring of force closure, as it acts on the frame",
    )
    allowed: Annotated[SwingLimits, Field(alias="limits")] = SwingLimits.model_construct()

    def faults(self) -> Sequence[Fault]:
        """What is wrong between keys that are right one by one."""
        g = self.geometry
        p = self.making
        found = faults(self.sizes)
        found += air_faults(("geometry", "tip_clearance"), g.tip_clearance, g.closure, g.tip_radius)
        deg = None if self.load is None else self.load.gravity_deg
        if deg is not None:
            weight = unweighed(deg, bool(self.nozzle.inertia_kg_m2), p.make == "printed")
            found += [] if weight is None else [weight]
        return [*found, *p.misfits()]

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
        pair = self.sizes.pair
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
        wound = [replace(each, size=each.size + lever) for each in to_wind(self._spring_wish)]
        demands = (
            Demand("swing", lash=math.radians(self.allowed.lash_deg), lash_of="limits.lash_deg"),
        )
        machine = self.machine
        facts = FollowerFacts(wish=self._spring_wish)
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
        spring = self.spring
        lever = spring.lever
        if self.sizes.pair or not spring.preload:
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
        if self.making.make != "printed":
            return None
        plate = self.plate
        plate.room.check()
        return SwingMachine(plate, plate.part)

    # ---- assembly ---------------------------------------------------------------------------------------------------

    @cached_property
    def _features(self) -> Sequence[Feature]:
        follower = self.cam.follower
        own = None
        if self.machine is not None:
            seat = self.sizes.tip_hole
            tip = Eye("frame", follower.arm, seat or 2 * follower.tip_radius, shaft=not seat)
            bore = Eye("frame", 0j, self.machine.frame_part.bore or 0.0)
            own = OwnTip("frame", tip, bore, follower.tip_radius if seat else None)
        first = cam_outline(self.cam, "cam", self.allowed.cam_limits, self.making.bore)
        first = replace(first, own=own)
        if not self.sizes.pair:
            return (first,)
        tip = Eye(None, follower.arm.conjugate(), 2 * follower.tip_radius)
        return (first, replace(first, tip=tip, leaves=-1, copy=1, own=None))

    def limits(self) -> Sequence[Finding]:
        """Pressure angle and undercut of the exact cam against the spec's limits."""
        rise, back = pressure_angles(self.cam)
        advice = Advice(
            f"rise {rise:.1f} deg, return {back:.1f} deg; a smaller geometry.swing_deg or a larger geometry.arm_offset",
            "a smaller geometry.tip_radius or a geometry.reversal_blend_deg",
            "a geometry.reversal_blend_deg joins them",
        )
        cams = [ExactCam("exact profile", self.cam, advice)]
        return [
            *cam_findings(
                cams, self.allowed.cam_limits, chord_tolerance=self.accuracy.chord_tolerance
            ),
            *([screw_grip(self.machine)] if self.machine else []),
            *(self._forces.findings() if self._forces else []),
        ]

    def _unjudged(self) -> Sequence[NotJudged]:
        """LIFT_OFF of force closure where nothing says what swings."""
        if self._forces or self.sizes.pair:
            return ()
        why = "the spec does not say what the spring has to move"
        return (NotJudged("LIFT_OFF", why, "nozzle.inertia_kg_m2"),)

    @cached_property
    def _load(self) -> FollowerLoad:
        """Nozzle and frames about the pivot, and the spring of force closure."""
        inertia = self.nozzle.inertia_kg_m2
        if self.machine is not None:
            frame = self.machine.frame_part
            inertia += frame.count * inertia_of(frame, self._process.density)
        if self.sizes.pair:
            return FollowerLoad(inertia)
        return FollowerLoad(inertia, rate=self.spring.rate, preload=self.spring.preload)

    @cached_property
    def _forces(self) -> SwingForces | None:
        """Forces over the turn, where an inertia is known: the frames' of a machine, or the nozzle's."""
        if not self._load.inertia:
            return None
        turn = np.linspace(0, math.tau, ROWS)
        lever = None if self.sizes.pair else self.spring.lever
        found = loaded(self._pulled, self.cam, self._load, turn)
        bounce = None if lever is None else bounce_of(self._pulled, found, self.load)
        least = self.allowed.reserve(self.material.name)
        left = [] if lever is None else reserve(found, self._pulled, least)
        return SwingForces(found, self._load, lever, bounce, least, left)

    def recovered(self, theta: Floats, motion: Mapping[str, Floats]) -> Study:
        """The canvas that the recovered motion lays; for a machine also the choice of the blend."""
        laid = canvas_study(theta, motion)
        if self.machine is None:
            return laid
        blend = math.radians(self.geometry.reversal_blend_deg)
        return together([laid, blend_study(self.cam, blend)])

    def study(self) -> Study:
        """Figures, speed and pressure-angle curves, and the remedies for what the design suffers from."""
        own = figures(self.cam, self.geometry, abs(self.motor.speed_rpm))
        bore = self.making.bore
        if self.machine is None:
            around = Study(sketches=sketches(self.cam.follower, self.sizes.pair, bore / 4))
        else:
            around = self.machine.study()
        return together([own, around, *([self._forces.study()] if self._forces else [])])
