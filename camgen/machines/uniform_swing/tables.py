"""The tables of a uniform-swing spec: the cam's, and those of the machine round it, from base to spring."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from camgen.machines.loads.tables import Drives, SwingingCamBears
from camgen.machines.pairs import Air
from camgen.parts.catalogue import BEARINGS, MOTOR_FACES, Bearing, MotorFace, flange
from camgen.parts.disc_cams import ShaftHole
from camgen.spec import Length, Record, Rpm, turning

Thread = Literal["M2", "M2.5", "M3", "M4", "M5", "M6"]
Tip = Literal["plate", "pin", "MR63", "MR85", "MR105", "623", "624", "625", "626", "608"]


class Geometry(Record):
    """Lengths and angles of the mechanism."""

    pivot_distance: Length
    arm_offset: Length
    swing_deg: Annotated[float, Field(gt=0, lt=180)]
    tip_radius: Annotated[float, Field(ge=0, le=1e6)]
    closure: Literal["conjugate", "force"] = "conjugate"
    tip_clearance: Air = 0.0
    reversal_blend_deg: Annotated[float, Field(ge=0, le=180)] = 0.0


class Motor(Drives):
    """What drives the cam."""

    speed_rpm: Annotated[Rpm, turning()] = 30.0


class Parts(ShaftHole):
    """The cam as a body; make: "machine" adds all the other parts of the printed machine."""

    thickness: Length = 6.0
    pin_diameter: Annotated[float, Field(ge=0, le=1e6)] = 3.0
    pins: Literal["printed", "steel"] = "printed"
    windows: Annotated[int, Field(ge=0, le=24)] = 5
    wall: Length = 3.0
    mark_depth: Annotated[float, Field(ge=0, le=1e6)] = 0.4


class Limits(SwingingCamBears):
    """What the designer accepts; a finding fails beyond it."""

    lash_deg: Annotated[float, Field(ge=0, le=180)] = 0.25
    min_wall: Length = 0.8


class BaseTable(Record):
    """The base plate; boss, screw_circle, screws and screw describe the motor "flange"; mount: screws that hold the base."""

    motor: Literal["nema-8", "nema-11", "nema-14", "nema-17", "nema-23", "flange"] = "nema-17"
    boss: Length = 22.0
    screw_circle: Length = 44.0
    screws: Annotated[int, Field(ge=2, le=12)] = 4
    screw: Thread = "M3"
    thickness: Length = 4.0
    wall: Length = 3.0
    window: bool = True
    slot_room: Annotated[float, Field(ge=0, le=100)] = 1.0
    mount: Thread | Literal["none"] = "M3"
    gap: Length = 0.6

    @property
    def face(self) -> MotorFace:
        """The motor that it carries."""
        if self.motor == "flange":
            return flange(self.boss, self.screw_circle, self.screws, self.screw)
        return MOTOR_FACES[self.motor]


class FrameTable(Record):
    """The follower's plates and the two axles that they are pressed on; tip: "plate", "pin" or a bearing by its name."""

    tip: Tip = "plate"
    arm: Length = 10.0
    wall: Length = 3.0
    axle: Length = 6.0
    axle_flange: Length = 12.0
    flange_thickness: Length = 2.0
    slide_at: Length = 24.0
    gap: Length = 1.0

    @property
    def bearing(self) -> Bearing | None:
        """The bearing that is the tip, if one is."""
        return BEARINGS.get(self.tip)

    def seat(self, tip_radius: float) -> float:
        """Diameter of the dowel pin that is pressed into the plate at the tip, mm; 0 where the plate itself is the tip."""
        if self.bearing:
            return float(self.bearing.bore)
        return 2 * tip_radius if self.tip == "pin" else 0.0

    def boss(self, seat: float, press: float, min_wall: float) -> float:
        """Radius of the plate round a tip's pin of the diameter `seat`, mm."""
        return (seat + press) / 2 + 2 * min_wall


class ColletTable(Record):
    """Collet and clamp ring on a plain shaft."""

    wall: Length = 2.4
    length: Length = 6.0
    flange: Length = 2.0
    slits: Annotated[int, Field(ge=2, le=24)] = 4
    slit: Length = 1.0


class NozzleTable(Record):
    """What the frames carry: two screws across the tail, and the load's inertia about the pivot (0: the frames' alone)."""

    screw: Thread = "M3"
    spacing: Length = 20.0
    inertia_kg_m2: Annotated[float, Field(ge=0, le=1e3)] = 0.0
    friction: Annotated[float, Field(ge=0, le=1)] = 0.25


class SpringTable(Record):
    """The spring of force closure, as it acts on the frame: N m per rad, and N m where the tip is nearest to the shaft.

    lever: from the pivot to a straight spring that pulls square to it; what it has to be is stated for that.
    """

    rate: Annotated[float, Field(ge=0, le=1e6)] = 0.0
    preload: Annotated[float, Field(ge=0, le=1e6)] = 0.0
    lever: Length = 24.0
