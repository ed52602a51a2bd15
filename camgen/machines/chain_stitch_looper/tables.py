"""The tables of a chain stitch's spec; that of the parts stands with the bodies."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from camgen.machines.loads.tables import Drives, LimitsTable
from camgen.motion.segments import LawChoice, SegmentTable, WholeTurn
from camgen.spec import Length, MinWall, Record, Rpm, quantity, turning

Both = tuple[Length, Length]
Law = Annotated[str | LawChoice, Field(union_mode="left_to_right")]
Distortion = Annotated[float, quantity("1", ge=0, lt=1)]


class StitchGeometry(Record):
    """Figures of stitch, needles and spreaders, named as in the source."""

    needle_spacing: Length = Field(description="z, the width of the stitch")
    point_lengths: Both = Field(description="h1, h2: needle's tip to the top of its eye")
    nose_over_eye: Both = Field(
        description="a1, a2: nose above the top of the eye at capture; 1.5 to 4"
    )
    loop_rise: Both = Field(
        description="S01, S02: needle's rise from its lowest point at capture; 1.5 to 4.5"
    )
    needle_diameter: Length = Field(description="d, the largest")
    plate_to_spreader: Length = Field(
        description="e, top of the plate to the top of the upper spreader; 3 to 5 are usual"
    )
    protrusion: Length = Field(description="l_H, how far the blade reaches below the nose; 1 to 2")
    protrusion_deg: Annotated[float, quantity("deg", ge=30, le=90)] = Field(
        description="tau, lean of its front; 75 to 90"
    )
    feed_deg: Annotated[float, quantity("deg", gt=0, lt=360)] = Field(
        description="phi_t, shaft angle while the fabric moves"
    )
    material_thickness: Length = Field(description="m, greatest thickness of what is sewn")
    velocity_ratio: Annotated[float, quantity("1", gt=0, le=100)] = Field(
        description="r = dL/dS, spreaders to needles; the report says from where to where it works"
    )
    blade_length: Length = Field(description="length of the blade from the nose's tip to the shank")
    mode: Literal["corrected", "published"] = Field(
        default="corrected",
        description='"corrected"; or "published": the source\'s figures with its errors; its design '
        "strikes the needle",
    )
    stitch_length: Length = Field(default=3.0, description="t, for the thread of a stitch")
    p6_setback: Annotated[float, quantity("mm", ge=0, le=1e3)] = Field(
        default=0.0,
        description="how far the front of the body is behind the path of the needle that comes "
        "nearest to it",
    )


class StrokeSegment(SegmentTable):
    """One segment of a program over a stroke of 1."""

    lift: Annotated[float, quantity("1", ge=1e-3, le=1e6)] | None = Field(
        default=None, description="share of the stroke; or to, where it ends"
    )
    to: Annotated[float, quantity("1", ge=-1e6, le=1e6)] | None = Field(
        default=None, description="share of the stroke where it ends"
    )


class Timing(Record):
    """How needles and spreaders move: a law for rise and return alike, or a program of its own whose lifts go from 0 to 1."""

    needle: Law = Field(
        default="simple-harmonic",
        description="law of the needles, for rise and return alike: any of `camgen list`",
    )
    spreader: Law = Field(
        default="simple-harmonic", description="law of the spreaders, as of the needles"
    )
    needle_segment: Annotated[tuple[StrokeSegment, ...], WholeTurn] = Field(
        default=(), description="program of the needles in place of a law, from 0 up to 1 and back"
    )
    spreader_segment: Annotated[tuple[StrokeSegment, ...], WholeTurn] = Field(
        default=(), description="program of the spreaders in place of a law"
    )
    distortion: tuple[Distortion, Distortion] = Field(
        default=(0.0, 0.0),
        description="crank over rod of needles and spreaders, with both laws harmonic; the source: 0.1 "
        "and 0.2",
    )
    lag_deg: Annotated[float, quantity("deg", ge=-180, le=180)] = Field(
        default=0.0, description="how far the spreaders come after the needles"
    )
    needle_stroke: Length | None = Field(
        default=None, description="stroke of the needles; default: as long as the feed needs"
    )


class StitchMotor(Drives):
    """What drives the machine; the shaft's angle is counted in its sense of turning, so either sense makes the same parts."""

    speed_rpm: Annotated[Rpm, turning()] = Field(
        default=3000.0, description="speed of the main shaft; below 0: clockwise"
    )


class StitchLimits(LimitsTable):
    """What you accept: beyond a limit its finding fails."""

    loop_angle_deg: Annotated[float, quantity("deg", ge=0, le=90)] = Field(
        default=1.0, description="greatest difference of the two loops' angles at the pierce"
    )
    clearance: Annotated[float, quantity("mm", ge=0, le=100)] = Field(
        default=0.0,
        description="least distance of needles and spreaders; 0: a needle may slide along the front",
    )
    min_wall: MinWall = 0.8


class Wanted(Record):
    """Bounds within which `camgen design` looks for the spec with the largest smallest clearance."""

    nose_over_eye: Both = Field(default=(1.5, 4.0), description="least and greatest of a1 and a2")
    loop_rise: Both = Field(default=(1.5, 4.5), description="least and greatest of S01 and S02")
    protrusion: Both = Field(default=(1.0, 2.0), description="least and greatest of l_H")
    plate_to_spreader: Both = Field(default=(3.0, 8.0), description="least and greatest of e")
    spreader_stroke: Length = Field(default=40.0, description="greatest stroke of the spreaders")
    nose_length: Length = Field(default=16.0, description="greatest length of the nose")
