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
        description="translating: how far the roller's axis lies beside the drum's, counter-clockwise "
        "as the drum is seen from above (below 0: clockwise)",
    )
    arm: Length | None = Field(
        default=None, description="oscillating: distance from the pivot to the roller's axis"
    )
    pivot: Length | None = Field(
        default=None,
        description="oscillating: how far the pivot lies beside the drum's axis; left out: where the roller "
        "stays nearest to it",
    )
    height: Length | None = Field(
        default=None,
        description="translating: height of the roller's axis at displacement 0; oscillating: height of the "
        "pivot; for a rib of the middle of both rollers; from the drum's lower end; left out: parts.wall is left\nunder the track; of a given length, the track is in its middle",
    )
    guide: Length | None = Field(
        default=None,
        description="distance from the drum's axis at which the slide or the arm's pivot bears, for the figures of "
        "moments; left out: geometry.radius",
    )
    start_deg: Annotated[float, quantity("deg", ge=-80, le=80)] | None = Field(
        default=None,
        description="oscillating: angle of the arm at displacement 0, from perpendicular to the drum's axis; left "
        "out: it swings as far down as up",
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
        "inside the drum",
    )


class DrumGeometry(Record):
    """The drum and what follows it; without radius the drum is the smallest that keeps to the limits."""

    track: Literal["groove", "rib", "end"] = Field(
        default="groove",
        description='"groove": the roller between two walls, print.slide_clearance (in metal 0.05) wider than the roller\n'
        '"rib": two rollers astride of one rib, on a slide\n'
        '"end": the roller on the upper end, held down by a spring',
    )
    follower: DrumFollower = Field(
        default=DrumFollower.model_construct(), description="what moves beside the drum"
    )
    roller: DrumRollerTable = Field(description="the roller in the track")
    radius: Length | None = Field(
        default=None,
        description="outer radius of the drum; left out: the smallest that keeps to "
        "limits.pressure_angle_deg at the roller's inner end, and holds its bore, rounded up",
    )
    length: Length | None = Field(
        default=None,
        description="length of the drum; left out: the track and parts.wall at both ends, rounded up",
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
        description="2: a groove as two pieces, each printed with its wall up, without supports: the drum with its lower "
        "wall, and a ring with the upper one, glued on its core, whose flat holds the ring's angle; 1: supports stand in "
        "the groove, where the roller runs; left out: 2 for a groove that is printed, else 1",
    )
    wall: Length = Field(
        default=3.0,
        description="least wall between the bore and the floor of the track, and at the drum's ends; in a machine "
        "round holes; of a drum in two pieces also the height of the key; in metal at least half as thick as the track "
        "is deep, hardened at least limits.min_wall, camgen's own rule",
    )
    thickness: Length = Field(
        default=6.0,
        description='make "printed": thickness of arm and crank, and least of the end plates',
    )
    rod_diameter: Length = Field(
        default=6.0, description='make "printed": diameter of the four rods between the end plates'
    )
    crank: Length = Field(
        default=40.0,
        description='make "printed" with motor.model "hand crank": from the shaft to the knob',
    )


class DrumLimits(CamLimitsTable):
    """What you accept: beyond a limit its finding fails."""

    lash: Annotated[float, quantity("mm or deg", ge=0, le=1e6)] = Field(
        default=0.25,
        description="free play of the follower between both walls; 0.25 is a hundredth of a lift of 25, "
        "and the running play of printed parts",
    )
    min_wall: MinWall = 0.8
