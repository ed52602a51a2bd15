"""The tables of an indexing cam's spec."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated, Literal

from pydantic import Field

from camgen.errors import Fault, SpecError
from camgen.machines.cam_tables import CamSizes
from camgen.machines.indexing_cam.unloader import CrankSpring, SpringTorque, antisymmetric
from camgen.machines.loads.tables import Direction, Drives, Positive, SwingingCamLimitsTable, Weight
from camgen.machines.pairs import Air, air_faults
from camgen.motion.program import Segment
from camgen.motion.segments import MATCHED, NamedLaw, backwards, law_of, turning_rows
from camgen.motion.spring_law import characteristic
from camgen.parts.disc_cams import (
    Bore,
    BoreShape,
    FlatDepth,
    KeyDepth,
    KeyWidth,
    Thickness,
)
from camgen.spec import Angle, Length, MinWall, Record, Rpm, quantity, turning

Span = Annotated[float, quantity("deg", ge=1, lt=360)]
NotNegative = Annotated[float, Field(ge=0, le=1e6)]


class Arm(Record):
    """The follower: a roller on an arm, and its axle."""

    arm: Length = Field(description="distance from the pivot A to the roller's centre")
    pivot_distance: Length = Field(description="distance from the shaft O to the pivot A")
    roller_radius: Length = Field(description="radius of the roller")


class IndexingGeometry(Record):
    """Follower, program and gears; the second dwell is what rise, dwell and return leave of the turn."""

    follower: Arm = Field(description="the arm that swings")
    base_radius: Length = Field(description="radius of the cam in the inner dwell")
    law: NamedLaw = Field(
        description="law of the turn: a name (camgen list), or a table with parameters"
    )
    rise_deg: Span = Field(description="cam angle of a turn of the driven link")
    dwell_deg: Annotated[float, quantity("deg", ge=0, lt=360)] = Field(
        description="cam angle of the outer dwell; the inner one is what is left of 360"
    )
    return_deg: Span | None = Field(
        default=None, description="cam angle of the turn back; default: that of the rise"
    )
    index_deg: Annotated[float, quantity("deg", ge=1, le=3600)] = Field(
        default=180.0, description="turn of the driven link"
    )
    gear_ratio: Annotated[float, quantity("1", ge=0.1, le=1000)] = Field(
        description="turn of the driven link / turn of the follower"
    )
    closure: Literal["conjugate", "force"] = Field(
        default="conjugate",
        description='"conjugate": a second cam and roller; "force": a spring closes (load.closing_n_m)',
    )
    tip_clearance: Air = 0.0

    @property
    def back_deg(self) -> float:
        """Cam angle of the turn back."""
        return self.rise_deg if self.return_deg is None else self.return_deg

    def faults(self) -> Sequence[Fault]:
        """What does not go together."""
        f = self.follower
        found = []
        spans = math.fsum((self.rise_deg, self.dwell_deg, self.back_deg))
        if spans > 360:
            right = (
                f"rise_deg, dwell_deg and return_deg of at most 360 together, they make {spans:g}"
            )
            found.append(Fault(("geometry", "dwell_deg"), f"{self.dwell_deg:g}", right))
        if f.roller_radius >= f.arm:
            right = f"less than the arm, {f.arm:g} mm: the roller would cover the arm's own pivot"
            where = ("geometry", "follower", "roller_radius")
            found.append(Fault(where, f"{f.roller_radius:g}", right))
        path = ("geometry", "tip_clearance")
        found += air_faults(path, self.tip_clearance, self.closure, f.roller_radius)
        return [*found, *self._law_faults()]

    def _law_faults(self) -> Sequence[Fault]:
        """What is wrong with the law, which runs between dwells there and back."""
        choice = self.law
        if choice.name == MATCHED:
            return [
                Fault(
                    ("geometry", "law"), f"'{MATCHED}'", "a law of its own: it runs between dwells"
                )
            ]
        try:
            law = law_of(choice)
        except SpecError as error:
            return [replace(f, path=("geometry", "law", *f.path)) for f in error.faults]
        turning = turning_rows(choice)
        if turning:
            return [replace(f, path=("geometry", "law", *f.path)) for f in turning]
        fault = backwards(Segment("rise", 1.0, 0.0, 1.0, law), ("geometry", "law"))
        return [] if fault is None else [fault]


class IndexingMotor(Drives):
    """What drives the cam shaft."""

    speed_rpm: Annotated[Rpm, turning()] = Field(
        default=30.0,
        description="speed of the cam shaft; below 0 it turns clockwise, and the program runs in that sense",
    )


class Driver(Record):
    """A two-crank chain (Whitworth's turning block) before the cam, which then turns fastest in the middle of each turn of the
    link: the crank turns evenly, its pin drives an arm about an axle beside its shaft, the arm the cam 2 to 1."""

    crank: Length = Field(
        default=20.0,
        description="distance from the crank's shaft to its pin; it turns evenly, twice while the "
        "cam turns once",
    )
    offset: Length = Field(
        description="distance of the arm's axle from the crank's shaft, less than the crank; the "
        "report compares with an even drive"
    )


class Freewheels(Record):
    """The link turns on by a turn at a time: a freewheel takes it along as the follower swings out, a second one holds it on
    the ground as that swings back; the follower swings so much further as is lost before a freewheel locks."""

    lost_deg: Annotated[float, quantity("deg", ge=0, le=45)] = Field(
        default=1.0,
        description="turn of the wheel before a clutch locks; the follower swings further by that",
    )


class LoadTable(Weight):
    """What is driven, and what loads it."""

    gravity_deg: Direction | None = Field(
        default=None,
        description="not for an indexing cam, which camgen calculates as lying flat",
    )
    inertia_kg_m2: Annotated[Positive, quantity("kg m^2")] = Field(
        description="moment of inertia of the driven link with the table"
    )
    follower_inertia_kg_m2: Annotated[NotNegative, quantity("kg m^2")] = Field(
        default=0.0, description="moment of inertia of the follower about its pivot"
    )
    friction_n_m: Annotated[NotNegative, quantity("N m")] = Field(
        default=0.0, description="friction torque at the driven link"
    )
    dwell_torque_n_m: Annotated[NotNegative, quantity("N m")] = Field(
        default=0.0, description="torque that the process puts on the driven link in a dwell"
    )
    closing_n_m: Annotated[NotNegative, quantity("N m")] = Field(
        default=0.0,
        description='torque of the closing spring at the follower\'s pivot, with closure "force"',
    )


UNLOADER_KEYS = {  # keys of an unloader by its kind: needed, allowed
    "none": ((), ()),
    "law": ((), ("balance", "design_rpm")),
    "table": (("points",), ()),
    "crank": (("crank", "guide", "stretch", "lead_deg"), ("stiffness_n_mm",)),
}


class UnloaderTable(Record):
    """The spring on the driven link."""

    torque: Literal["law", "crank", "table", "none"] = Field(
        default="law",
        description='"crank": a spring on a cord from a crank pin, geared to the link; "table" or "none"\n'
        '"law": the ideal, the torque that balances the inertia of its motion, which no spring has',
    )
    balance: Annotated[float, quantity("1", gt=0, le=2)] | None = Field(
        default=None, description='share of the inertia torque, with "law"'
    )
    design_rpm: Annotated[Positive, quantity("rpm")] | None = Field(
        default=None,
        description='speed for which the spring is made, with "law"; default: motor.speed_rpm',
    )
    points: (
        Annotated[tuple[tuple[float, float], ...], Field(min_length=3, max_length=2000)] | None
    ) = Field(
        default=None,
        description='"table": rows of share of the stroke and torque',
        json_schema_extra={"unit": "N m"},
    )
    stiffness_n_mm: Annotated[Positive, quantity("N/mm")] | None = Field(
        default=None,
        description="rate of the spring; default: the rate that leaves the least torque to the cam",
    )
    crank: Length | None = Field(
        default=None, description="distance of the cord's pin from its shaft"
    )
    guide: Length | None = Field(
        default=None, description="distance from the crank's axis to where the cord is guided"
    )
    stretch: Annotated[NotNegative, quantity("mm")] | None = Field(
        default=None, description="stretch of the spring at mid stroke"
    )
    lead_deg: Annotated[float, quantity("deg", ge=0, lt=90)] | None = Field(
        default=None,
        description="how far past the dead centre the crank is at the ends of the stroke; with "
        "[freewheel] before it, where the turn ends",
    )

    def faults(self, on: bool) -> list[Fault]:
        """What does not go together; on: whether the link turns on."""
        needed, further = UNLOADER_KEYS[self.torque]
        takes = ", ".join((*needed, *further)) or "nothing more"
        missing = f"missing: torque '{self.torque}' needs it"
        found = [
            Fault(("unloader", key), "", missing) for key in needed if getattr(self, key) is None
        ]
        for key in type(self).model_fields:
            if (
                key != "torque"
                and getattr(self, key) is not None
                and key not in (*needed, *further)
            ):
                found.append(
                    Fault(
                        ("unloader", key),
                        "",
                        f"no value here: torque '{self.torque}' takes {takes}",
                    )
                )
        if self.crank is not None and self.guide is not None and self.guide <= self.crank:
            found.append(
                Fault(
                    ("unloader", "guide"),
                    f"{self.guide:g}",
                    f"more than the crank, {self.crank:g} mm",
                )
            )
        if self.torque == "table" and self.points is not None:
            try:
                characteristic(self.points)
            except SpecError as error:
                found += [replace(f, path=("unloader", *f.path)) for f in error.faults]
        if on and self.torque not in ("none", "crank"):
            right = '"crank" or "none" with [freewheel]: a torque that ends as far back as it begins forwards cannot go on'
            found.append(Fault(("unloader", "torque"), f"'{self.torque}'", right))
        return found

    def spring(self, stroke: float, on: bool) -> SpringTorque | None:
        """Torque on the link over the share of its stroke, rad, of what is no law; on: whether the link turns on.

        A crank's spring whose stiffness is left open has 1 N/mm.
        """
        if self.torque == "table" and self.points is not None:
            return antisymmetric(characteristic(self.points))
        if self.torque != "crank":
            return None
        return CrankSpring(
            self.stiffness_n_mm or 1.0,
            self.crank or 0.0,
            self.guide or 0.0,
            self.stretch or 0.0,
            math.radians(self.lead_deg or 0.0),
            stroke,
            on,
        )


class SynthesisTable(Record):
    """Laws sought for the unloader's spring: one for each weight q of Q = C^2 + q Y^2."""

    weights: Annotated[
        tuple[Annotated[float, quantity("1", ge=0, le=1e9)], ...],
        Field(min_length=1, max_length=20),
    ] = Field(description="weights q of the spring's size against the peak acceleration")
    sines: Annotated[int, Field(ge=1, le=8)] = Field(
        default=5, description="number of sine terms of the law"
    )
    cosines: Annotated[int, Field(ge=0, le=3)] = Field(
        default=1, description="number of cosine terms of the law"
    )


class IndexingParts(CamSizes):
    """Sizes of the cams, or of a whole machine; a table with a link's name is the shape of that link."""

    thickness: Thickness = Field(
        default=8.0,
        description="thickness of a cam; in a machine that of links, cams and followers, 4",
    )
    bore: Bore = 12.0
    bore_shape: BoreShape = "keyway"
    key_width: KeyWidth = 4.0
    key_depth: KeyDepth = 1.8
    flat_depth: FlatDepth = 1.0
    windows: Annotated[int, Field(ge=0, le=24)] = Field(
        default=0, description="most lightening windows in a cam"
    )
    wall: Length = Field(
        default=4.0,
        description="wall beside the windows of a cam; in a machine that round each hole, 2",
    )


class IndexingLimits(SwingingCamLimitsTable):
    """What you accept: beyond a limit its finding fails."""

    lash_deg: Angle = Field(
        default=0.25,
        description="free play of the follower between the pair of cams; 0.25: under a hundredth of a "
        "swing of 30 deg; in the dwells the unloader presses one roller on, so the link "
        "stands there without play",
    )
    acceleration_jump: Annotated[NotNegative, quantity("1")] = Field(
        default=3.0,
        description="greatest jump of acceleration at a joint, in strokes per square of the turn's "
        "period; MR-13 has 2.55 by design",
    )
    residual: Annotated[float, quantity("1", ge=0, le=100)] = Field(
        default=0.25,
        description="greatest share of the peak torque (that without the unloader) that is left to the cam",
    )
    advance_deg: Annotated[float, quantity("deg", gt=0, le=360)] = Field(
        default=0.05,
        description="how far a turn of the table may be off with [freewheel]; errors of the turns "
        "add up",
    )
    min_wall: MinWall = 0.8
