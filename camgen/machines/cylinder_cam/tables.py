"""Tables of a cylinder cam's spec: drum, track, roller and follower, its bore, what the designer accepts."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from camgen.machines.loads.tables import CamLimitsTable, MovingFollower
from camgen.parts.disc_cams import ShaftBore
from camgen.spec import Coordinate, Length, MinWall, Record, quantity


class DrumFollower(MovingFollower):
    """What moves beside the drum."""

    motion: Literal["translating", "oscillating"] = Field(
        default="translating",
        description='"translating": on a slide along the drum\'s axis; "oscillating": on an arm whose '
        "pivot's axis is perpendicular to that axis",
    )
    offset: Coordinate = Field(
        default=0.0,
        description="translating: how far the roller's axis passes beside the drum's axis, counter-clockwise seen from above (below 0: "
        "clockwise)",
    )
    arm: Length | None = Field(
        default=None, description="oscillating: distance from the pivot to the roller's axis"
    )
    pivot: Length | None = Field(
        default=None,
        description="oscillating: how far the pivot lies beside the drum's axis; default: where the roller stays nearest to that axis",
    )
    height: Length | None = Field(
        default=None,
        description="height over the drum's lower end: translating, of the roller's axis at displacement 0 (of a rib, of the middle "
        "between both rollers); oscillating, of the pivot;\ndefault: parts.wall is left under the track, or, if length is "
        "given, the track is in the middle of the drum",
    )
    guide: Length | None = Field(
        default=None,
        description="distance from the drum's axis to the slide or to the arm's pivot, for the moments in the report; default: "
        "geometry.radius",
    )
    start_deg: Annotated[float, quantity("deg", ge=-80, le=80)] | None = Field(
        default=None,
        description="oscillating: angle of the arm at displacement 0, from the plane perpendicular to the drum's axis; default: the arm "
        "swings as far down as up",
    )


class DrumRollerTable(Record):
    """The roller in the track; its axis points to the drum's."""

    radius: Length = Field(description="radius of the roller, of a cone half way along it")
    length: Length = Field(description="length of the roller")
    cone_deg: Annotated[float, quantity("deg", ge=-45, le=45)] = Field(
        default=0.0,
        description="half angle of a conical roller, above 0 where it grows outwards; in a groove 0 or more",
    )
    end_clearance: Length = Field(
        default=0.5,
        description="gap between the roller's inner end and the floor, and how far its outer end lies "
        "inside the drum; in metal, where load.cam_follower is named and geometry.radius left out, by default 0.4 more than its head "
        "stands out of its ring, but on an end cam",
    )


class DrumGeometry(Record):
    """The drum and what follows it; without radius the drum is the smallest that keeps to the limits."""

    track: Literal["groove", "rib", "end"] = Field(
        default="groove",
        description='"groove": the roller runs between two walls; the groove is print.slide_clearance (in metal 0.05) wider than it\n"rib": '
        'two rollers astride of one rib, on a slide\n"end": the roller on the upper end, held down by a spring',
    )
    follower: DrumFollower = Field(
        default=DrumFollower.model_construct(), description="what moves beside the drum"
    )
    roller: DrumRollerTable = Field(description="the roller in the track")
    radius: Length | None = Field(
        default=None,
        description="outer radius of the drum; default: the smallest that keeps within limits.pressure_angle_deg at the roller's inner end "
        "and has room for the bore, rounded up",
    )
    length: Length | None = Field(
        default=None,
        description="length of the drum; default: the length of the track and of parts.wall at both ends, rounded up",
    )
    distance: Length | None = Field(
        default=None, description="rib: distance between the axes of both rollers"
    )


class DrumParts(ShaftBore):
    """The drum as a body, with the bore of its shaft, and the machine round it."""

    make: Literal["drum", "printed"] = Field(
        default="drum",
        description='"drum": the drum alone\n'
        '"printed": the machine as well: end plates on four rods, shaft in ball bearings, carriage or arm with\n'
        "its roller, hand crank; on an end cam two springs that press the carriage down, or one that pulls the arm",
    )
    pieces: Literal[1, 2] | None = Field(
        default=None,
        description="2: a groove in two pieces, each printed with its wall up and without supports: the drum with the lower wall, and a "
        "ring with the upper wall, which you glue on the drum's core (a flat holds its angle); 1: one piece, with supports in "
        "the groove where the roller runs; default: 2 for a printed groove, else 1",
    )
    wall: Length = Field(
        default=3.0,
        description="least wall between the bore and the floor of the track, and at the drum's ends; in a machine also round holes; in a "
        "drum of two pieces also the height of the key; in metal at least half the depth of the track, if hardened at least "
        "limits.min_wall (camgen's own rule)",
    )
    thickness: Length = Field(
        default=6.0,
        description='make "printed": thickness of the arm and the crank; the end plates are at least as thick',
    )
    rod_diameter: Length = Field(
        default=6.0, description='make "printed": diameter of the four rods between the end plates'
    )
    crank: Length = Field(
        default=40.0,
        description='make "printed" with motor.model "hand crank": distance from the shaft to the knob',
    )


class DrumLimits(CamLimitsTable):
    """What you accept: beyond a limit its finding fails."""

    lash: Annotated[float, quantity("mm or deg", ge=0, le=1e6)] = Field(
        default=0.25,
        description="free play allowed to the follower between both walls; 0.25 is 1 % of a lift of 25, and the running play of printed "
        "parts",
    )
    min_wall: MinWall = 0.8
