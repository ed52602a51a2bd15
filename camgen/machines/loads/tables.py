"""Tables of every spec on what drives, loads and limits a machine; a mechanism's own tables are built on them."""

from __future__ import annotations

import math
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from camgen.errors import Fault
from camgen.machine.cams.limits import RESERVE, CamLimits, MotionLimits
from camgen.machines.loads.applied import Applied
from camgen.parts import materials
from camgen.parts.journals import DriveLimits, MaterialLimits
from camgen.spec import Angle, Coordinate, Length, Record, quantity

Positive = Annotated[float, Field(gt=0, le=1e6)]
Model = Literal[
    "hand crank",
    "42STH48-2004AC",
    "42STH40-1004A",
    "42STH20",
    "35STH48",
    "17HS19-2004S1",
    "17HS24",
    "28BYJ-48",
    "TT-1:48",
    "N20-100:1",
    "N20-298:1",
    "N20-1000:1",
    "SG90",
    "MG90S",
    "SGMSH-10A",
    "SGMAH-01AJC",
]
CamFollowerName = Literal[
    "KR16", "KR19", "KR22", "KR26", "KR30", "KR32", "KR35", "KR40", "KR47", "KR52"
]
Direction = Annotated[float, quantity("deg", ge=-360, le=360)]


class Drives(Record):
    """What turns the machine: a model of the catalogue or a hand, or what another motor gives."""

    model: Model | None = Field(
        default=None,
        description='"hand crank", or a motor of the catalogue (stepper, gearmotor, servo): camgen schema lists them',
    )
    torque_n_m: Annotated[Positive, quantity("N m")] | None = Field(
        default=None,
        description="torque of the motor at this speed, in place of the model's torque",
    )
    stall_torque_n_m: Annotated[Positive, quantity("N m")] | None = Field(
        default=None,
        description="torque at standstill of a motor with brushes, in place of torque_n_m; the torque falls to 0 at no_load_rpm",
    )
    no_load_rpm: Annotated[Positive, quantity("rpm")] | None = Field(
        default=None, description="speed at which a motor with brushes gives no torque"
    )
    shaft_length: Length | None = Field(
        default=None,
        description="length of the motor's shaft beyond its face; a finding fails if it is too short; default: the usual length for the "
        "motor's frame size",
    )
    flywheel_kg_m2: Annotated[float, quantity("kg m^2", ge=0, le=1e3)] = Field(
        default=0.0,
        description="moment of inertia of the flywheel, the rotor and all else that turns evenly with the shaft; camgen adds the machine's "
        "own bodies",
    )

    @model_validator(mode="after")
    def _one(self) -> Self:
        if self.torque_n_m is not None and self.stall_torque_n_m is not None:
            raise ValueError(
                "one of torque_n_m and stall_torque_n_m: each says by itself what the motor gives"
            )
        if (self.stall_torque_n_m is None) != (self.no_load_rpm is None):
            raise ValueError(
                "stall_torque_n_m and no_load_rpm together: between them lies the motor's line"
            )
        return self


class MovingFollower(Record):
    """What rides on a cam, and how it moves."""

    motion: Literal["translating", "oscillating"]

    @property
    def swings(self) -> bool:
        """Whether it is an arm, not a slide."""
        return self.motion == "oscillating"

    @property
    def unit(self) -> tuple[str, float]:
        """What people read its displacement in, and how many of that one mm or rad is."""
        return ("deg", math.degrees(1)) if self.swings else ("mm", 1.0)


class Weight(Record):
    """Loads on the machine: weight, friction, applied loads; and the stiffness of a follower."""

    gravity_deg: Direction | None = Field(
        default=None,
        description="direction of gravity in the machine's plane, from the x axis; default: -90, downwards, if the plate stands upright "
        '(parts.stand = "board"); else the machine lies flat and its weight does not count',
    )
    stiffness: Annotated[Positive, quantity("N/mm or N m/rad")] | None = Field(
        default=None,
        description="stiffness of a follower between its cam and its mass: with it the report shows how the follower vibrates",
    )
    damping_ratio: Annotated[float, quantity("1", ge=0, lt=1)] = Field(
        default=0.05,
        description="damping of the follower's vibration, as a share of the critical damping",
    )
    friction: Annotated[float, quantity("1", ge=0, le=3)] | None = Field(
        default=None,
        description="friction coefficient of pins and guides; default: 0.7 for prints, 0.42 for metals, 0.2 for a print on metal, 0.0015 "
        "for ball bearings",
    )
    contact_friction: Annotated[float, quantity("1", ge=0, le=3)] = Field(
        default=0.0, description="friction coefficient of a tip that slides on a cam"
    )
    restitution: Annotated[float, quantity("1", ge=0, lt=1)] = Field(
        default=0.3,
        description="share of its speed that a follower keeps as it bounces off the cam; if LIFT_OFF fails, it changes what follows the "
        "first hop",
    )
    spring_error: Annotated[float, quantity("1", ge=0, le=0.5)] = Field(
        default=0.05,
        description="standard deviation of a spring's rate and of its preload, as a share; for camgen tolerance",
    )
    cam_follower: CamFollowerName | None = Field(
        default=None,
        description='a bought roller on the cams, "KR16" to "KR52" (its diameter); camgen judges its life',
    )
    on: Annotated[tuple[Applied, ...], Field(max_length=100)] = Field(
        default=(),
        description="more loads over the turn, such as a jet, a hose or a thread, each a table [[load.on]]: see camgen new linkage",
    )


def thin_walls(least: float, nozzle: float) -> list[Fault]:
    """A least wall of parts that no nozzle makes, mm."""
    right = f"at least the nozzle, {nozzle:g} mm"
    return [Fault(("limits", "min_wall"), f"{least:g}", right)] if least < nozzle else []


class LimitsTable(Record):
    """What the person who makes it knows of its materials; a finding fails beyond it."""

    hertz_mpa: Annotated[Positive, quantity("MPa")] | None = Field(
        default=None,
        description="greatest contact pressure of a cam; default: the pressure at which the strongest printed plastic yields",
    )
    pv_mpa_m_s: Annotated[Positive, quantity("MPa m/s")] | None = Field(
        default=None,
        description="greatest pressure times sliding speed of plain bearings; 0.4 is that of a bearing plastic that runs dry",
    )
    pin_stress_mpa: Annotated[Positive, quantity("MPa")] | None = Field(
        default=None,
        description="greatest bending stress of pins; default: what their material bears, 350 for steel",
    )
    tooth_stress_mpa: Annotated[Positive, quantity("MPa")] | None = Field(
        default=None,
        description="greatest bending stress at the root of a gear's tooth; default: what the material bears",
    )
    bearing_life_h: Annotated[Positive, quantity("h")] | None = Field(
        default=None,
        description="hours that ball bearings and cam followers must last; default: not judged",
    )

    run_up_s: Annotated[Positive, quantity("s")] | None = Field(
        default=None,
        description="longest time from rest until the machine runs; default: not judged",
    )
    speed_swing: Annotated[float, quantity("1", gt=0, le=2)] | None = Field(
        default=None,
        description="share by which the speed may swing, such as 0.02; the finding says which flywheel this needs; default: not judged",
    )

    @property
    def of_motion(self) -> MotionLimits:
        """Of the followers of cams."""
        return MotionLimits()

    def of_parts(self, sizes: Record | None) -> MaterialLimits:
        """As data, with the keys of [parts], which says what pins are made of."""
        return MaterialLimits(
            self.hertz_mpa,
            self.pv_mpa_m_s,
            self.pin_stress_mpa,
            self.tooth_stress_mpa,
            self.bearing_life_h,
            self.of_motion,
            DriveLimits(self.run_up_s, self.speed_swing),
            frozenset() if sizes is None else frozenset(type(sizes).model_fields),
        )


class CamLimitsTable(LimitsTable):
    """What the designer accepts of cams, the same through every spec."""

    pressure_angle_deg: Annotated[float, quantity("deg", gt=0, le=90)] | None = Field(
        default=None,
        description="greatest angle between the cam's push and the follower's motion; default: 30 if the follower slides, 45 if it swings",
    )
    least_radius: Coordinate = Field(
        default=0.0,
        description="least radius where the profile is convex, for wear; a value below 0 allows undercut down to that radius",
    )
    speed_ripple: Annotated[float, quantity("1", gt=0, le=10)] = Field(
        default=0.01,
        description="largest error of the follower's speed in the files, as a share of its greatest speed",
    )
    continuous: Annotated[int, Field(ge=-1, le=3)] = Field(
        default=2,
        description="what must not jump: 0 displacement, 1 velocity, 2 acceleration, 3 jerk; -1: no check",
    )
    table_rounding: Annotated[float, quantity("1", gt=0, le=100)] = Field(
        default=0.1,
        description="largest error of the acceleration that the rounding of a table's rows can cause, as a share of the greatest "
        "acceleration",
    )

    velocity: Annotated[Positive, quantity("mm/s or deg/s")] | None = Field(
        default=None, description="greatest velocity of a follower; default: not judged"
    )
    acceleration: Annotated[float, quantity("mm/s^2 or deg/s^2", gt=0, le=1e9)] | None = Field(
        default=None, description="greatest acceleration of a follower; default: not judged"
    )
    jerk: Annotated[float, quantity("mm/s^3 or deg/s^3", gt=0, le=1e12)] | None = Field(
        default=None, description="greatest jerk of a follower; default: not judged"
    )
    frequency_ratio: Annotated[float, quantity("1", gt=0, le=1e4)] | None = Field(
        default=None,
        description="least ratio of a follower's natural frequency (load.stiffness) to the turns of its cam per second, such as 10; "
        "default: not judged",
    )
    spring_reserve: Annotated[float, quantity("1", ge=0, lt=1)] | None = Field(
        default=None,
        description="least share of the spring's force that is left to press the follower on its cam; default: 0, in metal 0.17, where the "
        "spring pulls 1.2 times as hard as what would lift the follower off",
    )

    def reserve(self, material: str) -> float:
        """The least share of a spring's force that is left, of a machine of a material."""
        usual = RESERVE if materials.of(material).metal else 0.0
        return usual if self.spring_reserve is None else self.spring_reserve

    @property
    def of_motion(self) -> MotionLimits:
        """Of the followers of cams."""
        return MotionLimits(self.velocity, self.acceleration, self.jerk, self.frequency_ratio)

    def of_cams(self, undercut: float) -> CamLimits:
        """What is accepted of a joint; undercut: loss of s, mm or rad."""
        return CamLimits(
            self.pressure_angle_deg,
            undercut,
            self.least_radius,
            self.speed_ripple,
            self.table_rounding,
            self.continuous,
        )


class SwingingCamLimitsTable(CamLimitsTable):
    """What the designer accepts of cams whose followers all swing."""

    undercut_deg: Angle = Field(
        default=0.0,
        description="swing that may be lost by undercut, as a round tip loses it at a sharp reversal",
    )

    @property
    def cam_limits(self) -> CamLimits:
        """What is accepted of their cams."""
        return self.of_cams(math.radians(self.undercut_deg))
