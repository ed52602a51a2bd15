"""The tables of `mechanism = "linkage"`: points, links, lengths, a drive, and what joins and drives the links.

Drawn in one position, dimensioned exactly: points say roughly where things are at theta = 0 and so pick the branch;
lengths override drawn distances. Two links that share a point are pinned there.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from camgen.motion.segments import NamedLaw
from camgen.spec import Length, Record

Name = Annotated[
    str,
    Field(
        pattern=r"^[A-Za-z][A-Za-z0-9_]*$",
        max_length=40,
        description="a name of letters, digits and _, a letter first",
    ),
]
Coordinate = Annotated[float, Field(ge=-1e6, le=1e6)]
Place = tuple[Coordinate, Coordinate]
Two = tuple[Name, Name]
Degrees = Annotated[float, Field(ge=-36000, le=36000)]


class Drive(Record):
    """What turns: a link that is pinned to the ground, all the way round or to and fro."""

    link: Name = Field(description="the driven link; it must be pinned to the ground")
    speed_rpm: Annotated[float, Field(ge=-1e6, le=1e6)] = Field(60.0, description="rpm; below 0: clockwise")
    range_deg: tuple[Degrees, Degrees] | None = Field(
        None, description="deg from the drawn position, least and greatest: to and fro instead of turns"
    )


class Slide(Record):
    """A link that moves along a line of another; it keeps its drawn angle to it and distance from it."""

    link: Name = Field(description="the link that slides")
    on: Name = Field("ground", description="the link that guides it")
    along: Two = Field(description="two points of `on`: the guide's direction")
    name: Name | None = Field(None, description="of the joint; the link's name unless given")


class Slot(Record):
    """A pin of one link in a straight slot of another."""

    pin: Name = Field(description="the point of another link that is the pin")
    link: Name = Field(description="the link with the slot")
    along: Two = Field(description="two points of `link`: the slot's centre line")
    name: Name | None = Field(None, description="of the joint; pin and link unless given")


class Gear(Record):
    """Two links that turn in proportion: angle of b = ratio * angle of a, seen from the link that carries both."""

    a: Name = Field(description="link")
    b: Name = Field(description="link")
    ratio: Annotated[float, Field(ge=-1000, le=1000)] = Field(description="below 0: b turns the other way")
    name: Name | None = Field(None, description="of the joint; both links unless given")


class CamSegment(Record):
    """One segment of a cam's program; lift_deg and to_deg for a follower that swings, lift and to for one that slides."""

    kind: Literal["rise", "dwell", "return"] = Field(description="a rise moves the follower away from the cam's centre")
    span_deg: Annotated[float, Field(ge=1e-3, le=360)] = Field(description="deg of the cam's turn")
    lift: Length | None = Field(None, description="mm, how far a follower slides")
    to: Annotated[float, Field(ge=-1e6, le=1e6)] | None = Field(None, description="mm, or where it ends")
    lift_deg: Annotated[float, Field(gt=0, le=180)] | None = Field(None, description="deg, how far a follower swings")
    to_deg: Annotated[float, Field(ge=-180, le=180)] | None = Field(None, description="deg, or where it ends")
    law: NamedLaw | None = Field(None, description="see camgen list; not of a dwell")


class Cam(Record):
    """A cam: the outline of link `cam` is made so that `follower` moves by the segments."""

    cam: Name = Field(description="a link that turns on the ground")
    follower: Name = Field(description="a link that swings or slides on the ground")
    shape: Literal["roller", "knife", "flat"] = Field("roller", description="what of the follower touches the cam")
    at: Name = Field(description="point of the follower: the roller's centre, the edge, or a point of the face")
    radius: Length | None = Field(None, description="mm, of the roller")
    closure: Literal["force", "groove", "conjugate"] = Field("force", description="what holds the follower on the cam")
    name: Name | None = Field(None, description="of the joint; both links unless given")
    segment: Annotated[tuple[CamSegment, ...], Field(min_length=1, max_length=100)] = Field(description="the program")


class Wanted(Record):
    """One output that is shown and judged: a point's path, a link's angle, or a sliding link's place."""

    name: Name
    point: Name | None = Field(None, description="a point: its path")
    link: Name | None = Field(None, description="a link: its angle, or its place along its slide")


class Masses(Record):
    """Mass of a link; what is left out comes from its solid."""

    mass_g: Annotated[float, Field(ge=0, le=1e6)] = Field(description="g")
    centre: Place | None = Field(None, description="mm in the link's axes: origin its first point, x towards its second")
    inertia_kg_m2: Annotated[float, Field(ge=0, le=1e6)] = Field(0.0, description="kg m^2, about the centre of mass")


def pair(key: str) -> tuple[str, str] | None:
    """The two points of a key of [lengths], "A-B"; None where it is none."""
    names = key.split("-")
    return (names[0].strip(), names[1].strip()) if len(names) == 2 and all(names) else None


Points = dict[Name, Place]
Links = dict[Name, Annotated[tuple[Name, ...], Field(min_length=1, max_length=60)]]
Lengths = dict[str, Length]
Layers = dict[Name, Annotated[int, Field(ge=0, le=60)]]
Tables = dict[str, Any]
