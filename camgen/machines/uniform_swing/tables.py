"""The tables of a uniform-swing spec: the cam's, and those of the machine round it, from base to spring."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

from pydantic import BeforeValidator, Field

from camgen.machines.loads.tables import Drives, SwingingCamLimitsTable
from camgen.machines.pairs import Air
from camgen.parts.catalogue import BEARINGS, MOTOR_FACES, Bearing, MotorFace, flange
from camgen.parts.disc_cams import OLD_BORES, ShaftHole
from camgen.spec import Angle, Distance, Length, MinWall, Print, Record, Rpm, quantity, turning
from camgen.vocabulary import OldWords

Thread = Literal["M2", "M2.5", "M3", "M4", "M5", "M6"]
Tip = Literal["plate", "pin", "MR63", "MR85", "MR105", "623", "624", "625", "626", "608"]


class SwingGeometry(Record):
    """Lengths and angles of the mechanism."""

    pivot_distance: Length = Field(description="distance from the shaft O to the pivot A")
    arm_offset: Length = Field(description="distance from A to B, the width of the follower")
    swing_deg: Annotated[float, quantity("deg", gt=0, lt=180)] = Field(
        description="swing from peak to peak"
    )
    tip_radius: Distance = Field(description="radius of a round tip or roller; 0 is a knife edge")
    closure: Literal["conjugate", "force"] = Field(
        default="conjugate",
        description='"conjugate": a second tip on the same cam turned over; "force": a spring',
    )
    tip_clearance: Air = 0.0
    reversal_blend_deg: Angle = Field(
        default=0.0, description="cam angle over which each reversal is smoothed; 0 is sharp"
    )


class SwingMotor(Drives):
    """What drives the cam."""

    speed_rpm: Annotated[Rpm, turning()] = Field(
        default=30.0, description="speed of the cam; below 0: clockwise"
    )


OLD_WORDS: OldWords = {**OLD_BORES, ("parts", "make", "machine"): ("parts", "make", "printed")}


def _no_laser(make: object) -> object:
    """Where sheet is asked for, what can be cut of it."""
    if make == "laser":
        raise ValueError(
            '"printed" or "cams": collet, headed axles and posts are no sheets; [laser] cuts cams as thick as laser.thickness'
        )
    return make


class SwingParts(ShaftHole):
    """The cam as a body; make: "printed" adds all the other parts of the machine."""

    make: Annotated[Literal["printed", "cams"], BeforeValidator(_no_laser)] = Field(
        default="cams", description='"cams": the cams alone; "printed": all parts of the machine'
    )
    thickness: Length = Field(default=6.0, description="thickness of cams and frame plates")
    pin_diameter: Distance = Field(
        default=3.0,
        description="diameter of two holes that match when one cam is turned over; 0: none",
    )
    pins: Literal["printed", "steel"] = Field(
        default="printed",
        description='pins of the cams and of the frames: "printed"; or "steel": turned',
    )
    windows: Annotated[int, Field(ge=0, le=24)] = Field(
        default=5, description="most lightening windows; 0: none"
    )
    wall: Length = Field(
        default=3.0,
        description="wall beside windows and pin holes; beside pins less if the cam is small, down to "
        "min_wall",
    )
    mark_depth: Distance = Field(
        default=0.4, description="engraved arrow that shows the direction of turning; 0: none"
    )


class SwingLimits(SwingingCamLimitsTable):
    """What you accept: beyond a limit its finding fails."""

    lash_deg: Angle = Field(
        default=0.25,
        description="free play between the two tips: the nozzle stands still that far after each "
        "reversal; 0.25 is 1 % of a swing of 25 deg, where the source allows 10 % of the "
        "canvas's thickness",
    )
    min_wall: MinWall = 0.8


class BaseTable(Record):
    """The base plate."""

    motor: Literal["nema-8", "nema-11", "nema-14", "nema-17", "nema-23", "flange"] = Field(
        default="nema-17",
        description='"nema-8", -11, -14, -17, -23, or "flange" with boss, screw_circle, screws and screw',
    )
    boss: Length = Field(
        default=22.0, description='diameter of the centring boss of the motor "flange"'
    )
    screw_circle: Length = Field(
        default=44.0, description='diameter of the circle of screws of the motor "flange"'
    )
    screws: Annotated[int, Field(ge=2, le=12)] = Field(
        default=4, description='number of screws of the motor "flange"'
    )
    screw: Thread = Field(default="M3", description='thread of the screws of the motor "flange"')
    thickness: Length = Field(default=4.0, description="thickness of the plate")
    wall: Length = Field(default=3.0, description="wall round every hole")
    window: bool = Field(default=True, description="an opening between motor and pivot")
    slot_room: Annotated[float, quantity("mm", ge=0, le=100)] = Field(
        default=1.0, description="room left to the axle at both ends of its arc slot"
    )
    mount: Thread | Literal["none"] = Field(
        default="M3",
        description='thread of the four screws that hold the base on its stand; or "none"',
    )
    gap: Length = Field(default=0.6, description="gap between the base and what moves above it")

    @property
    def face(self) -> MotorFace:
        """The motor that it carries."""
        if self.motor == "flange":
            return flange(self.boss, self.screw_circle, self.screws, self.screw)
        return MOTOR_FACES[self.motor]


class FrameTable(Record):
    """The follower's plates and the two axles that they are pressed on."""

    tip: Tip = Field(
        default="plate",
        description='"plate": the plate itself; "pin": a dowel pin, ISO 2338; or a bearing: "MR63", '
        '"MR85", "MR105",\n'
        '"623", "624", "625", "626", "608"; tip_radius is then that of the pin or bearing',
    )
    arm: Length = Field(default=10.0, description="width of the arm")
    wall: Length = Field(
        default=3.0,
        description="wall beside the pivot; less if the cam passes near, down to min_wall",
    )
    axle: Length = Field(
        default=6.0,
        description="diameter of both axles, printed with their flanges; thinner if there is no room, "
        "down to 3",
    )
    axle_flange: Length = Field(default=12.0, description="diameter of the axles' flanges")
    flange_thickness: Length = Field(default=2.0, description="thickness of the axles' flanges")
    slide_at: Length = Field(
        default=24.0, description="distance from the pivot to the axle that slides in the arc slot"
    )
    gap: Length = Field(default=1.0, description="gap between frame and cam off the tip")

    @property
    def bearing(self) -> Bearing | None:
        """The bearing that is the tip, if one is."""
        return BEARINGS.get(self.tip)


class ColletTable(Record):
    """Collet and clamp ring on a plain shaft."""

    wall: Length = Field(default=2.4, description="wall of the sleeve; less if the pins need room")
    length: Length = Field(default=6.0, description="length of the sleeve")
    flange: Length = Field(default=2.0, description="thickness of the collet's flange")
    slits: Annotated[int, Field(ge=2, le=24)] = Field(default=4, description="number of slits")
    slit: Length = Field(default=1.0, description="width of a slit")


class NozzleTable(Record):
    """What the frames carry: two screws across the tail, and the load's inertia about the pivot (0: the frames' alone)."""

    screw: Thread = Field(
        default="M3",
        description="thread of two screws across the frames' tail, into nuts between the frames",
    )
    spacing: Length = Field(default=20.0, description="distance of the two screws")
    inertia_kg_m2: Annotated[float, quantity("kg m^2", ge=0, le=1e3)] = Field(
        default=0.0, description="moment of inertia about the pivot, besides the frames"
    )
    friction: Annotated[float, quantity("1", ge=0, le=1)] = Field(
        default=0.25, description="friction coefficient between tip and cam; 0.01 for a bearing"
    )


class SpringTable(Record):
    """The spring of force closure, as it acts on the frame: N m per rad, and N m where the tip is nearest to the shaft.

    lever: from the pivot to a straight spring that pulls square to it; what it has to be is stated for that.
    """

    rate: Annotated[float, quantity("N m/rad", ge=0, le=1e6)] = Field(
        default=0.0, description="rate of the spring that holds the tip on the cam"
    )
    preload: Annotated[float, quantity("N m", ge=0, le=1e6)] = Field(
        default=0.0, description="force of the spring where the tip is nearest to the shaft"
    )
    lever: Length = Field(
        default=24.0,
        description="distance from the pivot to a straight spring: the report says which spring this needs",
    )


@dataclass(frozen=True)
class SwingSizes:
    """The tables from which the parts follow."""

    geometry: SwingGeometry
    making: SwingParts
    base: BaseTable
    frame: FrameTable
    collet: ColletTable
    nozzle: NozzleTable
    fits: Print
    min_wall: float  # mm

    def value(self, table: str, key: str) -> float:
        """That of a key, by the names of a spec."""
        if table == "limits":
            return self.min_wall
        return float(
            getattr(
                {"parts": self.making, "print": self.fits}.get(table) or getattr(self, table), key
            )
        )

    @property
    def pair(self) -> bool:
        """Whether there are two cams."""
        return self.geometry.closure == "conjugate"

    @property
    def plain(self) -> bool:
        """Whether a collet clamps the shaft."""
        return self.making.bore_shape == "plain"

    @property
    def seat(self) -> float:
        """Diameter of the dowel pin that is pressed into the plate at the tip, mm; 0 where the plate itself is the tip."""
        bearing = self.frame.bearing
        if bearing:
            return float(bearing.bore)
        return 2 * self.geometry.tip_radius if self.frame.tip == "pin" else 0.0

    @property
    def tip_hole(self) -> float:
        """Diameter of the hole for that pin, mm; 0: none."""
        return self.seat + self.fits.press_clearance if self.seat else 0.0

    @property
    def boss(self) -> float:
        """Radius of the plate round that pin, mm; where the plate is the tip that of the tip."""
        return self.tip_hole / 2 + 2 * self.min_wall if self.seat else self.geometry.tip_radius
