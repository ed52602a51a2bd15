"""The tables of a thread take-up's spec; those of masses and of consumed thread stand beside what they feed."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import Field

from camgen.machines.loads.tables import Drives, LimitsTable
from camgen.parts.generator.sizes import Parts
from camgen.parts.hardware import FACETS
from camgen.spec import Coordinate, Distance, Length, MinWall, Print, Record, Rpm, quantity, turning

HEAD = 1.0  # mm, height of a head, and how far it stands out all round
Point = tuple[Coordinate, Coordinate]


class TakeUpGeometry(Record):
    """Lengths and angles of the mechanism, guides in the machine's axes (origin O)."""

    input_crank: Length = Field(description="length of the input crank, O to A")
    coupler: Length = Field(description="length of the bell crank, A to B")
    output_crank: Length = Field(description="length of the output crank, B to C")
    frame: Length = Field(description="distance of the pivots, O to C")
    eye_distance: Length = Field(description="distance of the eye, B to D")
    eye_angle_deg: Annotated[float, quantity("deg", gt=-180, le=180)] = Field(
        description="angle between B-A and B-D, D on the pivots' side"
    )
    branch: Literal[1, -1] = Field(
        description="+1: B to the left of the way from A to C; -1: to the right"
    )
    guides: tuple[Point, Point] = Field(description="places of the guides M and N")
    frame_angle_deg: Annotated[float, quantity("deg", ge=-360, le=360)] = Field(
        default=0.0, description="direction from O to C"
    )


class TakeUpMotor(Drives):
    """What drives the input crank."""

    speed_rpm: Annotated[Rpm, turning(0.001)] = Field(
        description="speed of the input shaft; below 0: clockwise"
    )


class Wanted(Record):
    """What `camgen design` searches for and a build checks; each wish may be left out."""

    feed_range: Length | None = Field(
        default=None, description="how much thread it gives and takes in a turn"
    )
    let_down_ratio: Annotated[float, quantity("1", gt=0, le=100)] | None = Field(
        default=None,
        description="ratio of the angle in which thread is let down to the angle in which it is pulled up",
    )
    dwell_deg: Annotated[float, quantity("deg", gt=0, lt=360)] | None = Field(
        default=None,
        description="dwell from the eye's first entry to its last exit of a circle about its near "
        "stop",
    )
    dwell_radius: Length = Field(default=1.0, description="radius of that circle")
    tolerance: Annotated[float, quantity("1", ge=1e-6, le=0.5)] = Field(
        default=0.01, description="share by which each wanted value may be off"
    )


class TakeUpParts(Record):
    """The links as bodies."""

    thickness: Length = Field(default=4.0, description="thickness of a link")
    wall: Length = Field(
        default=1.2, description="wall round every hole: three lines of the nozzle"
    )
    shaft_diameter: Length = Field(default=6.0, description="diameter of the input shaft")
    shaft_length: Length = Field(default=12.0, description="length of the shaft below the frame")
    shaft_flat: Length = Field(
        default=0.5, description="depth of the flat that turns the input crank"
    )
    pin_diameter: Length = Field(default=3.5, description="diameter of pins and dowels")
    pins: Literal["printed", "steel", "all-steel"] = Field(
        default="printed",
        description='"printed"; "steel": A, B, dowels and shaft, turned as drawn\n'
        '"all-steel": guides and finger as well, which stand upright and are thin',
    )
    mount_diameter: Length = Field(
        default=2.5,
        description="diameter of the frame's holes for screws from behind: core hole of M3",
    )
    stand: Literal["none", "board", "box"] = Field(
        default="none", description="what the frame is screwed on, as for any linkage"
    )
    finger_diameter: Length = Field(default=2.0, description="diameter of the finger with the eye")
    guide_diameter: Length = Field(default=2.0, description="diameter of the guides")
    thread_height: Length = Field(
        default=6.0, description="height of finger and guides above the bell crank"
    )
    groove: Distance = Field(
        default=2.0,
        description="height of the groove that holds the thread; 0: plain posts, along which it slips",
    )

    def head(self, fits: Print, min_wall: float) -> float:
        """Height of the heads of pins and posts, and how far they stand out all round, mm: spacers are as wide."""
        return max(HEAD, min_wall + fits.slide_clearance / 2 + 2 * FACETS)

    def bearing(self, frame: float, fits: Print, min_wall: float) -> float:
        """Diameter of the disc about C, mm: a wall about the shaft, which is `frame` off, and about two dowels beside it."""
        shaft = (self.shaft_diameter + fits.slide_clearance) / 2
        dowel = (self.pin_diameter + fits.press_clearance) / 2
        wall = max(self.wall, min_wall + 2 * FACETS)
        beside = math.sqrt(max(0.0, (shaft + dowel + wall) ** 2 - frame**2))
        return 2 * max(frame + shaft + wall, beside + dowel + wall)

    def of_linkage(self, frame: float, fits: Print, min_wall: float) -> Parts:
        """The sizes of the linkage; frame: from O to C, mm."""
        same = {"thickness", "wall", "pin_diameter", "mount_diameter", "stand"}
        same |= {"shaft_diameter", "shaft_length", "shaft_flat"}
        steel = self.pins != "printed"
        found = {
            **self.model_dump(include=same),
            "base_thickness": self.thickness,
            "head": self.head(fits, min_wall),
            "mount_screws": 3,
            "pin": "turned" if steel else "printed",
            "shaft_made": "steel" if steel else "printed",
            "discs": {"C": self.bearing(frame, fits, min_wall)},
            "thread_posts": {
                "diameter": self.guide_diameter,
                "diameters": {"D": self.finger_diameter},
                "height": self.thread_height,
                "groove": self.groove,
                "made": "steel" if self.pins == "all-steel" else "printed",
            },
        }
        return Parts.model_validate(found)


class TakeUpLimits(LimitsTable):
    """What you accept: beyond a limit its finding fails."""

    transmission_angle_deg: Annotated[float, quantity("deg", ge=0, lt=90)] = Field(
        default=40.0, description="least angle between coupler and output crank"
    )
    gap: Distance = Field(
        default=0.2, description="least gap between what moves and what stands in its way"
    )
    excess: Distance = Field(
        default=7.0, description="most thread supplied beyond what is consumed"
    )
    lash: Distance = Field(
        default=7.0,
        description="free play of the feed by that of all joints; 7: play is excess thread, and the "
        "source allows 7 mm of that",
    )
    min_wall: MinWall = 0.8
