"""Tables of a drum's spec: its tracks with their followers, its rows of pins with their teeth, what the designer accepts."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from camgen.machines.disc_cam.tables import TrackFollower
from camgen.motion.segments import SegmentTable, WholeTurn
from camgen.parts.disc_cams import ShaftBore, Thickness
from camgen.parts.generator.sizes import Name
from camgen.spec import Distance, Length, MinWall, Record, Rpm, quantity, turning

Height = Annotated[float, quantity("mm", ge=0, le=1e4)]
Release = Annotated[float, quantity("deg", ge=0, lt=360)]


class DrumBody(Record):
    """The body that carries tracks and pins."""

    core_radius: Length = Field(
        description="radius of the drum between its tracks, and where its pins stand"
    )
    length: Length | None = Field(
        default=None, description="length of the drum; default: up to its highest track or row"
    )


class TrackTable(Record):
    """A disc cam on the drum, with its follower; without base_radius it is the smallest that keeps to the limits."""

    name: Name = Field(description="name of the track and of its follower")
    height: Height = Field(description="height of its lower face over the drum's lower end")
    thickness: Thickness = Field(default=6.0, description="how high it is, along the axis")
    follower: TrackFollower = Field(description="what rides on it")
    base_radius: Length | None = Field(
        default=None,
        description="radius of the base circle, which touches the track from inside; default: the smallest that keeps within [limits] and "
        "stands out of the core, rounded up",
    )
    segment: Annotated[tuple[SegmentTable, ...], Field(min_length=1, max_length=100), WholeTurn] = (
        Field(description="segments of its motion: one after another they make the turn")
    )


class ToothTable(Record):
    """The teeth of a comb: each points at the drum's axis, and a pin bends it aside until its tip slips off the pin's end."""

    radius: Length = Field(description="distance of a tooth's tip from the drum's axis")
    at_deg: Annotated[float, quantity("deg", ge=-360, le=360)] = Field(
        default=90.0, description="where the comb stands, counter-clockwise from +x of the files"
    )
    return_ms: Annotated[float, quantity("ms", ge=0, le=1e5)] = Field(
        description="time in which a tooth that is let go comes to rest: no pin may touch it before"
    )


class PinTable(Record):
    """The pins, all alike: bars that stand out of the core."""

    radius: Length = Field(description="distance of their ends from the drum's axis")
    width: Length = Field(default=1.2, description="width of a pin, along the turn")
    thickness: Thickness = Field(default=2.0, description="height of a pin, along the axis")


class RowTable(Record):
    """Pins at one height, which pass one tooth."""

    name: Name = Field(description="name of the row, such as its note")
    height: Height = Field(description="height of its pins' lower faces over the drum's lower end")
    release_deg: Annotated[tuple[Release, ...], Field(min_length=1, max_length=1000)] = Field(
        description="angles by which the drum has turned when each of its pins lets the tooth go, growing"
    )


class DrumMotor(Record):
    """What turns the drum."""

    speed_rpm: Annotated[Rpm, turning()] = Field(
        default=6.0,
        description="speed of the drum; below 0 it turns clockwise, and programs and rows run in that sense",
    )


class DrumBore(ShaftBore):
    """The drum's bore."""


class TrackLimits(Record):
    """What you accept: beyond a limit its finding fails."""

    pressure_angle_deg: Annotated[float, quantity("deg", gt=0, le=90)] | None = Field(
        default=None,
        description="greatest pressure angle; default: 30 if the follower slides, 45 if it swings",
    )
    least_radius: Distance = Field(
        default=0.0, description="least radius of a track where it is convex, for wear"
    )
    speed_ripple: Annotated[float, quantity("1", gt=0, le=10)] = Field(
        default=0.01,
        description="largest error of the follower's speed in the files, as a share of its greatest speed",
    )
    continuous: Annotated[int, Field(ge=-1, le=3)] = Field(
        default=2,
        description="what must not jump: 0 displacement, 1 velocity, 2 acceleration, 3 jerk; -1: no check",
    )
    min_wall: MinWall = 0.8
