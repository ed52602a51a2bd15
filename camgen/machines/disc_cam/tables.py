"""Tables of a disc cam's spec: cam and follower, what drives and what loads them, what the designer accepts."""

from __future__ import annotations

from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, model_validator

from camgen.geometry.outlines import Contour, bulged
from camgen.machines.cam_tables import CamSizes
from camgen.machines.loads.tables import CamLimitsTable, Drives, MovingFollower, Weight
from camgen.machines.pairs import Air
from camgen.motion.polydyne import Lag
from camgen.parts.disc_cams import CamParts
from camgen.parts.generator.sizes import Contours
from camgen.spec import Coordinate, Force, Length, MinWall, Record, Rpm, quantity, turning


class TrackFollower(MovingFollower):
    """What rides on a cam with a roller, a flat face or a knife edge."""

    motion: Literal["translating", "oscillating"] = Field(
        description='"translating" or "oscillating"'
    )
    shape: Literal["roller", "flat", "knife"] = Field(
        description='"roller" (with its radius), "flat" or "knife"; there is no default'
    )
    radius: Length | None = Field(default=None, description="radius of the roller")
    offset: Coordinate = Field(
        default=0.0,
        description="translating: how far the slide is to the right of the shaft (below 0: to the "
        "left)",
    )
    pivot_distance: Length | None = Field(
        default=None, description="oscillating: distance from the shaft O to the pivot A"
    )
    arm: Length | None = Field(
        default=None,
        description="oscillating roller or knife: distance from A to its centre or edge",
    )
    face_offset: Coordinate = Field(
        default=0.0,
        description="oscillating face: how far it lies ahead of A, away from the cam (below 0: towards "
        "it)",
    )
    face_width: Length | None = Field(
        default=None,
        description="flat: width of the face, centred on the stem or on the contact; checked if given",
    )


class FollowerTable(TrackFollower):
    """What rides on the cam."""

    shape: Literal["roller", "flat", "knife", "outline"] = Field(  # type: ignore[assignment]
        description='"roller" (with its radius), "flat", "knife" or "outline"; there is no default'
    )
    outline: str | None = Field(
        default=None,
        description='"outline": an SVG or DXF beside the spec, whose largest contour is convex where the cam touches it\ntranslating: +y '
        "points away from the cam, and the origin lies on the slide; oscillating: the origin is the pivot A",
    )
    contours: Contours | None = Field(
        default=None,
        description="contours read from that file, each as rows of x, y, mm, and bulge",
    )
    drawn_in: str | None = Field(default=None, description="the name of that file")

    @model_validator(mode="before")
    @classmethod
    def _drawn(cls, data: Any) -> Any:
        """An outline says what shape it is."""
        if isinstance(data, dict) and ("outline" in data or "contours" in data):
            return {"shape": "outline", **data}
        return data

    @property
    def drawing(self) -> list[Contour]:
        """Its outline and the holes in it, as they are drawn; nothing without one."""
        rows = [np.array(each) for each in self.contours or ()]
        return [bulged(each[:, 0] + 1j * each[:, 1], each[:, 2]) for each in rows]


class DiscCamGeometry(Record):
    """The cam and its follower; without base_radius the cam is the smallest that keeps to the limits."""

    follower: FollowerTable = Field(description="what rides on the cam")
    base_radius: Length | None = Field(
        default=None,
        description="radius of the base circle, which touches the cam from inside; default: the smallest that keeps within [limits] and "
        "has room for the shaft, rounded up",
    )
    closure: Literal["force", "conjugate", "groove"] = Field(
        default="force",
        description='"force": a spring holds the follower on the cam\n"conjugate": a second cam and follower on the far side drive it back '
        '(cam-1, cam-2)\n"groove": a roller runs between two walls; the groove is print.slide_clearance (in metal 0.05) wider '
        "than it\n(inner, outer and back plate, joined by pins)",
    )
    tip_clearance: Air = 0.0


class DiscCamMotor(Drives):
    """What drives the cam."""

    speed_rpm: Annotated[Rpm, turning()] = Field(
        default=60.0,
        description="speed of the cam; below 0 it turns clockwise, and the program runs in that sense",
    )


class DiscCamParts(CamParts, CamSizes):
    """Sizes of the cams, or of a whole machine; a table with a link's name is the shape of that link."""


class DiscCamLimits(CamLimitsTable):
    """What you accept: beyond a limit its finding fails."""

    undercut: Annotated[float, quantity("mm or deg", ge=0, le=1e6)] = Field(
        default=0.0, description="motion that may be lost by undercut"
    )
    lash: Annotated[float, quantity("mm or deg", ge=0, le=1e6)] = Field(
        default=0.25,
        description="free play allowed to the follower in a groove or between a pair of cams; 0.25 is 1 % of a lift of 25, and the running "
        "play of printed parts",
    )
    min_wall: MinWall = 0.8


class LoadTable(Weight):
    """Mass and loads of the follower: kg, N and mm if it slides, kg m^2, N m and rad if it swings."""

    mass_kg: Annotated[float, quantity("kg", ge=0, le=1e6)] = Field(
        default=0.0, description="mass of a translating follower and what it moves"
    )
    inertia_kg_m2: Annotated[float, quantity("kg m^2", ge=0, le=1e6)] = Field(
        default=0.0, description="moment of inertia of an oscillating follower about its pivot"
    )
    damping: Annotated[float, quantity("N s/mm or N m s/rad", ge=0, le=1e6)] = Field(
        default=0.0, description="damping of the follower, in proportion to its speed"
    )
    resistance: Force = Field(
        default=0.0, description="constant force or torque against the follower's lift"
    )
    polydyne: bool = Field(
        default=False,
        description="true: camgen corrects the cam so that the mass behind the stiffness follows the program at this speed",
    )

    def of_follower(self) -> dict[str, Any]:
        """[masses] of the linkage, where they are given; what swings has its inertia about its pivot."""
        if self.inertia_kg_m2:
            turned = {"mass_g": 0.0, "centre": (0.0, 0.0), "inertia_kg_m2": self.inertia_kg_m2}
            return {"follower": turned}
        still = {"mass_g": 1e3 * self.mass_kg, "centre": (0.0, 0.0)}
        return {"follower": still} if self.mass_kg else {}

    def lag(self, speed: float, rate: float) -> Lag:
        """What a cam has to be ahead of this follower; speed: rad/s; rate: of the spring on it, N/mm or N m/rad."""
        if self.stiffness is None:
            return Lag(0.0)
        mass = self.mass_kg * 1e-3 or self.inertia_kg_m2  # with N/mm and mm, or N m/rad and rad
        stiff = self.stiffness
        return Lag(mass * speed**2 / stiff, self.damping * abs(speed) / stiff, rate / stiff)


class SpringTable(Record):
    """The spring that presses the follower on its cam."""

    rate: Annotated[float, quantity("N/mm or N m/rad", ge=0, le=1e6)] = Field(
        default=0.0,
        description="rate of the return spring; with rate and preload 0 camgen chooses a spring for a machine, and cams made alone have "
        "none",
    )
    preload: Force = Field(
        default=0.0, description="force or torque of the spring where the follower is lowest"
    )
