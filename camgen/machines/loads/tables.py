"""Tables of every spec on what drives, loads and limits a machine; a mechanism's own tables are built on them."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from camgen.spec import Length, Record

Share = Annotated[float, Field(gt=0, le=1)]
Positive = Annotated[float, Field(gt=0, le=1e6)]
Model = Literal["42STH48-2004AC", "42STH40-1004A", "42STH20", "35STH48", "17HS19-2004S1", "17HS24"]


class Drives(Record):
    """What the motor can give: a torque at the speed, a model of the catalogue, or stall torque and speed without load."""

    torque_n_m: Annotated[
        Positive | None, Field(description="N m, that the motor gives at speed_rpm")
    ] = None
    model: Annotated[
        Model | None, Field(description="a stepper of the catalogue, by its holding torque; no unit")
    ] = None
    stall_torque_n_m: Annotated[
        Positive | None, Field(description="N m, at standstill; its torque falls evenly to no_load_rpm")
    ] = None
    no_load_rpm: Annotated[
        Annotated[float, Field(gt=0, le=1e6)] | None, Field(description="rpm, at which it gives no torque")
    ] = None
    shaft_length: Annotated[
        Length | None, Field(description="mm, of the motor's shaft over its face; that of its frame unless given")
    ] = None
    fluctuation: Annotated[
        Share | None, Field(description="share of the speed that it may swing by; the report says which flywheel")
    ] = None
    flywheel_kg_m2: Annotated[float, Field(
        ge=0, le=1e3,
        description="kg m^2, of what turns evenly with the shaft besides the machine's own bodies, the motor's rotor too",
    )] = 0.0  # fmt: skip

    @model_validator(mode="after")
    def _one(self) -> Self:
        given = [key for key in ("torque_n_m", "model", "stall_torque_n_m") if getattr(self, key) is not None]
        if len(given) > 1:
            raise ValueError(f"one of {' and '.join(given)}: each says by itself what the motor gives")
        if (self.stall_torque_n_m is None) != (self.no_load_rpm is None):
            raise ValueError("stall_torque_n_m and no_load_rpm together: between them lies the motor's line")
        return self


class Weight(Record):
    """What pulls on all that is made."""

    gravity_deg: Annotated[
        Annotated[float, Field(ge=-360, le=360)] | None,
        Field(description="deg from the x axis, whither weight pulls in its plane; -90: down the page; left out: it lies flat"),
    ] = None
    stiffness: Annotated[
        Positive | None,
        Field(description="N/mm of a follower that slides, N m/rad of one that swings, from cam to mass: tells its vibration"),
    ] = None
    damping_ratio: Annotated[float, Field(ge=0, lt=1, description="of the same, a share of the critical one")] = 0.05


class Bears(Record):
    """What the person who makes it knows of its materials; a finding fails beyond it."""

    hertz_mpa: Annotated[
        Positive | None,
        Field(description="MPa, pressure of a cam's contact; else that at which the strongest printed plastic yields"),
    ] = None
    pv_mpa_m_s: Annotated[
        Positive | None,
        Field(description="MPa m/s, pressure times sliding speed of a plain bearing; else 0.4, of a bearing's plastic, dry"),
    ] = None
    pin_stress_mpa: Annotated[
        Positive | None, Field(description="MPa, bending stress of a pin; unless given that of its material")
    ] = None
    bearing_life_h: Annotated[
        Positive | None, Field(description="h, that a roller's ball bearing has to run; not judged unless given")
    ] = None
