"""Tables of a linear cam's spec: plate and follower, its drive, what the designer accepts."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from camgen.machines.loads.tables import CamLimitsTable, MovingFollower
from camgen.parts.disc_cams import Thickness
from camgen.parts.generator.sizes import Name
from camgen.spec import Distance, Length, MinWall, Record, quantity


class PlateFollower(MovingFollower):
    """What rides on the plate."""

    motion: Literal["translating", "oscillating"] = Field(
        default="translating",
        description='"translating": on a slide perpendicular to the plate\'s travel; "oscillating": on an arm whose '
        "pivot is on the left",
    )
    shape: Literal["roller", "knife"] = Field(
        default="roller", description='"roller" (with its radius) or "knife"'
    )
    radius: Length | None = Field(default=None, description="radius of the roller")
    arm: Length | None = Field(
        default=None,
        description="oscillating: distance from the pivot to the roller's centre, or the edge",
    )
    start_deg: Annotated[float, quantity("deg", ge=-80, le=80)] = Field(
        default=0.0,
        description="oscillating: angle of the arm at displacement 0, from the plate's travel, upwards above 0",
    )


class PlateGeometry(Record):
    """The plate and what follows it."""

    follower: PlateFollower = Field(description="what rides on the plate")
    height: Length = Field(
        default=20.0,
        description="height of the edge over the plate's bottom where the displacement is 0",
    )


class PlateDrive(Record):
    """What moves the plate."""

    slide: Name = Field(default="cam", description="what slides: the plate, as its files call it")
    speed: Annotated[float, quantity("mm/s", gt=0, le=1e5)] = Field(
        default=20.0, description="speed of the plate on its slide"
    )


class PlateParts(Record):
    """The plate as a body."""

    thickness: Thickness = Field(default=5.0, description="thickness of the plate")
    ends: Length = Field(
        default=8.0, description="how far the plate extends beyond both ends of its travel"
    )
    hole: Annotated[float, quantity("mm", ge=0, le=1000)] = Field(
        default=4.5,
        description="diameter of the two holes for screws, below both ends of its travel; 0: none",
    )


class PlateLimits(CamLimitsTable):
    """What you accept: beyond a limit its finding fails."""

    least_radius: Distance = Field(
        default=0.0, description="least radius of the edge where it is convex, for wear"
    )
    min_wall: MinWall = 0.8
