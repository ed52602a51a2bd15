"""Tables of a disc cam's spec: cam and follower, what drives and what loads them, what the designer accepts."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from camgen.machines.loads.tables import CamBears, Drives, Weight
from camgen.machines.pairs import Air
from camgen.motion.polydyne import Lag
from camgen.spec import Length, Record, Rpm, turning


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
    tip_clearance: Air = 0.0


class Motor(Drives):
    """What drives the cam."""

    speed_rpm: Annotated[Rpm, turning()] = 60.0


class Limits(CamBears):
    """What the designer accepts; a finding fails beyond it. undercut and lash are mm, or degrees of an oscillating follower."""

    undercut: Annotated[float, Field(ge=0, le=1e6)] = 0.0
    lash: Annotated[float, Field(ge=0, le=1e6)] = 0.25
    min_wall: Length = 0.8


class LoadTable(Weight):
    """What the follower is and bears, a translating one in kg, N and mm, an oscillating one in kg m^2, N m and rad."""

    mass_kg: Annotated[float, Field(ge=0, le=1e6)] = 0.0
    inertia_kg_m2: Annotated[float, Field(ge=0, le=1e6)] = 0.0
    damping: Annotated[float, Field(ge=0, le=1e6)] = 0.0
    resistance: Annotated[float, Field(ge=0, le=1e6)] = 0.0
    polydyne: bool = False

    def lag(self, speed: float, rate: float) -> Lag:
        """What a cam has to be ahead of this follower; speed: rad/s; rate: of the spring on it, N/mm or N m/rad."""
        if self.stiffness is None:
            return Lag(0.0)
        mass = self.mass_kg * 1e-3 or self.inertia_kg_m2  # with N/mm and mm, or N m/rad and rad
        stiff = self.stiffness
        return Lag(mass * speed**2 / stiff, self.damping * abs(speed) / stiff, rate / stiff)


class SpringTable(Record):
    """The spring that presses the follower on its cam."""

    rate: Annotated[float, Field(ge=0, le=1e6)] = 0.0
    preload: Annotated[float, Field(ge=0, le=1e6)] = 0.0
