"""Tables of a disc cam's spec: cam and follower, what drives and what loads them, what the designer accepts."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from camgen.machines.loads.tables import Bears, Drives, Weight
from camgen.spec import Length, Record, Rpm, turning

_LASH = (
    "free play of the follower in a groove or between a pair of cams, mm, or deg of an oscillating one; 0.25: a hundredth of a "
    "lift of 25, and the running play of printed parts"
)


class FollowerTable(Record):
    """What rides on the cam."""

    motion: Literal["translating", "oscillating"]
    shape: Literal["roller", "flat", "knife"]
    radius: Length | None = None
    offset: Annotated[float, Field(ge=-1e6, le=1e6)] = 0.0
    pivot_distance: Length | None = None
    arm: Length | None = None
    face_offset: Annotated[float, Field(ge=-1e6, le=1e6)] = 0.0
    face_width: Length | None = None


class Geometry(Record):
    """The cam and its follower; without base_radius it is the smallest that keeps to the limits."""

    follower: FollowerTable
    base_radius: Length | None = None
    closure: Literal["force", "conjugate", "groove"] = "force"


class Motor(Drives):
    """What drives the cam."""

    speed_rpm: Annotated[Rpm, turning()] = 60.0


class Limits(Bears):
    """What the designer accepts; a finding fails beyond it. undercut and lash are mm, or degrees of an oscillating follower.

    least_radius: of the convex profile, mm; below 0 an undercut profile is accepted, down to that radius.
    """

    pressure_angle_deg: Annotated[float, Field(gt=0, lt=90)] = 30.0
    least_radius: Annotated[float, Field(ge=-1e6, le=1e6)] = 0.0
    undercut: Annotated[float, Field(ge=0, le=1e6)] = 0.0
    lash: Annotated[float, Field(ge=0, le=1e6, description=_LASH)] = 0.25
    speed_ripple: Annotated[float, Field(gt=0, le=10)] = 0.01
    continuous: Annotated[int, Field(ge=-1, le=3)] = 2
    min_wall: Length = 0.8


def _said(text: str) -> object:
    return Field(ge=0, le=1e6, description=text)


class LoadTable(Weight):
    """What the follower is and bears, a translating one in kg, N and mm, an oscillating one in kg m^2, N m and rad."""

    mass_kg: Annotated[float, _said("mass of a translating follower with all that it moves, kg")] = 0.0
    inertia_kg_m2: Annotated[float, _said("inertia of an oscillating follower about its pivot, kg m^2")] = 0.0
    damping: Annotated[float, _said("resistance in proportion to its speed, N s/mm or N m s/rad")] = 0.0
    resistance: Annotated[float, _said("constant resistance against its lift, N or N m")] = 0.0


class SpringTable(Record):
    """The spring that presses the follower on its cam."""

    rate: Annotated[float, _said("of the spring, N/mm or N m/rad of the follower")] = 0.0
    preload: Annotated[float, _said("what it presses with at the follower's lowest place, N or N m")] = 0.0
