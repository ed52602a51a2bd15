"""The tables of a chain stitch's spec; that of the parts stands with the bodies."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from camgen.machines.loads.tables import Bears, Drives
from camgen.motion.segments import LawChoice, SegmentTable
from camgen.spec import Length, Record, Rpm, turning

Both = tuple[Length, Length]
Law = Annotated[str | LawChoice, Field(union_mode="left_to_right")]
Distortion = Annotated[float, Field(ge=0, lt=1, json_schema_extra={"unit": "1"})]


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
    distortion: tuple[Distortion, Distortion] = (0.0, 0.0)
    lag_deg: Annotated[float, Field(ge=-180, le=180)] = 0.0
    needle_stroke: Length | None = None


class Motor(Drives):
    """What drives the machine; the shaft's angle is counted in its sense of turning, so either sense makes the same parts."""

    speed_rpm: Annotated[Rpm, turning()] = 3000.0


class Limits(Bears):
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
