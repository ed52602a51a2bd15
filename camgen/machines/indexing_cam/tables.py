"""The tables of an indexing cam's spec."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated, Literal

from pydantic import Field

from camgen.errors import Fault, SpecError
from camgen.machines.loads.tables import Drives, Positive, SwingingCamBears, Weight
from camgen.machines.pairs import Air
from camgen.motion.program import Segment
from camgen.motion.segments import MATCHED, NamedLaw, backwards, law_of, turning_rows
from camgen.motion.spring_law import characteristic
from camgen.parts.disc_cams import ShaftHole, Thickness
from camgen.spec import Length, Record, Rpm, turning

Span = Annotated[float, Field(ge=1, lt=360)]
NotNegative = Annotated[float, Field(ge=0, le=1e6)]


class Arm(Record):
    """The follower: a roller on an arm, and its axle."""

    arm: Length
    pivot_distance: Length
    roller_radius: Length


class Geometry(Record):
    """Follower, program and gears; the second dwell is what rise, dwell and return leave of the turn."""

    follower: Arm
    base_radius: Length
    law: NamedLaw
    rise_deg: Span
    dwell_deg: Annotated[float, Field(ge=0, lt=360)]
    return_deg: Span | None = None
    index_deg: Annotated[float, Field(ge=1, le=3600)] = 180.0
    gear_ratio: Annotated[float, Field(ge=0.1, le=1000)]
    closure: Literal["conjugate", "force"] = "conjugate"
    tip_clearance: Air = 0.0

    def law_faults(self) -> Sequence[Fault]:
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


class Motor(Drives):
    """What drives the cam shaft."""

    speed_rpm: Annotated[Rpm, turning()] = 30.0


class Driver(Record):
    """A two-crank chain (Whitworth's turning block) before the cam, which then turns fastest in the middle of each turn of the
    link: the crank turns evenly, its pin drives an arm about an axle beside its shaft, the arm the cam 2 to 1."""

    crank: Length = 20.0
    offset: Length


class Freewheels(Record):
    """The link turns on by a turn at a time: a freewheel takes it along as the follower swings out, a second one holds it on
    the ground as that swings back; the follower swings so much further as is lost before a freewheel locks."""

    lost_deg: Annotated[float, Field(ge=0, le=45)] = 1.0


class LoadTable(Weight):
    """What is driven. dwell_torque: what the process may put on the driven link in a dwell; closing: a spring's torque that
    presses the follower on a cam with closure "force"."""

    inertia_kg_m2: Positive
    follower_inertia_kg_m2: NotNegative = 0.0
    friction_n_m: NotNegative = 0.0
    dwell_torque_n_m: NotNegative = 0.0
    closing_n_m: NotNegative = 0.0


UNLOADER_KEYS = {  # keys of an unloader by its kind: needed, allowed
    "none": ((), ()),
    "law": ((), ("balance", "design_rpm")),
    "table": (("points",), ()),
    "crank": (("crank", "guide", "stretch", "lead_deg"), ("stiffness_n_mm",)),
}


class UnloaderTable(Record):
    """The spring on the driven link.

    torque "law": what the law asks at design_rpm, times balance, the ideal, which cannot be built; "crank": a spring on a
    crank pin, its stiffness, unless given, the one that leaves least to the cam; "table": points of position (0 to 0.5 of
    the stroke) and N m; "none": no spring.
    """

    torque: Literal["law", "crank", "table", "none"] = "law"
    balance: Annotated[float, Field(gt=0, le=2)] | None = None
    design_rpm: Positive | None = None
    points: (
        Annotated[tuple[tuple[float, float], ...], Field(min_length=3, max_length=2000)] | None
    ) = None
    stiffness_n_mm: Positive | None = None
    crank: Length | None = None
    guide: Length | None = None
    stretch: NotNegative | None = None
    lead_deg: Annotated[float, Field(ge=0, lt=90)] | None = None

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
                        ("unloader", key), "", f"nothing here: torque '{self.torque}' takes {takes}"
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


class SynthesisTable(Record):
    """Laws sought for the unloader's spring: one for each weight q of Q = C^2 + q Y^2."""

    weights: Annotated[
        tuple[Annotated[float, Field(ge=0, le=1e9)], ...], Field(min_length=1, max_length=20)
    ]
    sines: Annotated[int, Field(ge=1, le=8)] = 5
    cosines: Annotated[int, Field(ge=0, le=3)] = 1


class Parts(ShaftHole):
    """The cams as bodies."""

    thickness: Thickness = 8.0
    bore: Length = 12.0
    shaft: Literal["plain", "keyway", "d-flat"] = "keyway"
    key_width: Length = 4.0
    key_depth: Length = 1.8
    flat_depth: Length = 1.0
    windows: Annotated[int, Field(ge=0, le=24)] = 0
    wall: Length = 4.0


class Limits(SwingingCamBears):
    """What the designer accepts; acceleration_jump in strokes per square of the turn's period.

    residual: peak torque that the unloader may leave to the cam, as a share of that without it; advance_deg: how far a turn of a
    link that turns on may be off.
    """

    lash_deg: Annotated[float, Field(ge=0, le=180)] = 0.25
    acceleration_jump: NotNegative = 3.0
    residual: Annotated[float, Field(ge=0, le=100)] = 0.25
    advance_deg: Annotated[float, Field(gt=0, le=360)] = 0.05
    min_wall: Length = 0.8
