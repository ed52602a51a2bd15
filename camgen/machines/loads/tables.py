"""Tables of every spec on what drives, loads and limits a machine; a mechanism's own tables are built on them."""

from __future__ import annotations

import math
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from camgen.machine.cams.limits import CamLimits
from camgen.machines.loads.applied import Applied
from camgen.parts.journals import MaterialLimits
from camgen.spec import SHARE, Length, Record

Positive = Annotated[float, Field(gt=0, le=1e6)]
Model = Literal["42STH48-2004AC", "42STH40-1004A", "42STH20", "35STH48", "17HS19-2004S1", "17HS24"]


def _in(unit: str) -> object:
    return Field(gt=0, le=1e6, json_schema_extra={"unit": unit})


class Drives(Record):
    """What the motor can give: a torque at the speed, a model of the catalogue, or stall torque and speed without load."""

    torque_n_m: Positive | None = None
    model: Model | None = None
    stall_torque_n_m: Positive | None = None
    no_load_rpm: Positive | None = None
    shaft_length: Length | None = None
    fluctuation: Annotated[float, Field(gt=0, le=1, json_schema_extra=SHARE)] | None = None
    flywheel_kg_m2: Annotated[float, Field(ge=0, le=1e3)] = 0.0

    @model_validator(mode="after")
    def _one(self) -> Self:
        given = [
            key
            for key in ("torque_n_m", "model", "stall_torque_n_m")
            if getattr(self, key) is not None
        ]
        if len(given) > 1:
            raise ValueError(
                f"one of {' and '.join(given)}: each says by itself what the motor gives"
            )
        if (self.stall_torque_n_m is None) != (self.no_load_rpm is None):
            raise ValueError(
                "stall_torque_n_m and no_load_rpm together: between them lies the motor's line"
            )
        return self


class Weight(Record):
    """What acts on all that is made: weight, friction, loads; and how stiff a follower is."""

    gravity_deg: Annotated[float, Field(ge=-360, le=360)] | None = None
    stiffness: Positive | None = None
    damping_ratio: Annotated[float, Field(ge=0, lt=1, json_schema_extra=SHARE)] = 0.05
    friction: Annotated[float, Field(ge=0, le=3, json_schema_extra=SHARE)] | None = None
    contact_friction: Annotated[float, Field(ge=0, le=3, json_schema_extra=SHARE)] = 0.0
    on: Annotated[tuple[Applied, ...], Field(max_length=100)] = ()


class Bears(Record):
    """What the person who makes it knows of its materials; a finding fails beyond it."""

    hertz_mpa: Annotated[float, _in("MPa")] | None = None
    pv_mpa_m_s: Annotated[float, _in("MPa m/s")] | None = None
    pin_stress_mpa: Annotated[float, _in("MPa")] | None = None
    bearing_life_h: Annotated[float, _in("h")] | None = None

    def of_parts(self, table: str, sizes: Record | None) -> MaterialLimits:
        """As data, with the keys of the table of sizes that says what pins are made of."""
        return MaterialLimits(
            self.hertz_mpa,
            self.pv_mpa_m_s,
            self.pin_stress_mpa,
            self.bearing_life_h,
            table,
            frozenset() if sizes is None else frozenset(type(sizes).model_fields),
        )


class CamBears(Bears):
    """What the designer accepts of cams, the same through every spec.

    pressure_angle_deg: 30 of a follower that slides and 45 of one that swings, unless given; least_radius: of the convex
    profile, mm; below 0 an undercut profile is accepted, down to that radius; continuous: what must not jump, -1: no check.
    """

    pressure_angle_deg: Annotated[float, Field(gt=0, le=90)] | None = None
    least_radius: Annotated[float, Field(ge=-1e6, le=1e6)] = 0.0
    speed_ripple: Annotated[float, Field(gt=0, le=10)] = 0.01
    continuous: Annotated[int, Field(ge=-1, le=3)] = 2

    def of_cams(self, undercut: float) -> CamLimits:
        """What is accepted of a joint; undercut: loss of s, mm or rad."""
        return CamLimits(
            self.pressure_angle_deg, undercut, self.least_radius, self.speed_ripple, self.continuous
        )


class SwingingCamBears(CamBears):
    """The same of machines whose followers all swing."""

    undercut_deg: Annotated[float, Field(ge=0, le=180)] = 0.0

    @property
    def cam_limits(self) -> CamLimits:
        """What is accepted of their cams."""
        return self.of_cams(math.radians(self.undercut_deg))
