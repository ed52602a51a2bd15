"""A follower as a user tells it to `camgen motion`: a table, or one line, that places it over an outline.

oscillating   a round tip or a flat face on an arm; s is the arm's angle, rad inside, ccw positive
translating   a round tip or a flat face on a slide; s is its way along the slide's direction, mm
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field

from camgen import reading
from camgen import spec as specs
from camgen.errors import Fault, SpecError
from camgen.geometry.rings import Ring
from camgen.judge.contact_faces import ArmFace, SlideFace
from camgen.judge.contact_tips import ArmTip, Form, SlideTip
from camgen.spec import Checked, Length

Coordinate = Annotated[float, Field(ge=-1e6, le=1e6)]
Degrees = Annotated[float, Field(ge=-360, le=360)]
Point = tuple[Coordinate, Coordinate]

# Keys that not every follower has, by motion and by whether it is flat: needed, allowed.
_KEYS = {
    ("oscillating", False): (("pivot", "arm"), ("at_deg", "leaves")),
    ("oscillating", True): (("pivot",), ("at_deg", "leaves", "face_offset")),
    ("translating", False): ((), ("direction_deg", "offset", "at")),
    ("translating", True): ((), ("direction_deg", "at")),
}


class FollowerTable(Checked):
    """A follower, and how the outline is mounted under it.

    contour: on which of the file's closed contours it rides, by size, 1 the largest; inside: it comes to it from within, as
    to the outer wall of a groove. centre: the cam's shaft in the file; flipped: the outline is turned over about Oy through
    the shaft, then by turned_deg. Oscillating: pivot, the arm's axle, from the shaft; at_deg: direction of the arm (axle to
    tip), or of a face's normal (away from the shaft), from which its angle is counted, ccw from Ox; leaves: sense of turning,
    +1 is ccw, that takes it away from the shaft. One of both tells the arm's side. face_offset: how far the face lies ahead
    of the pivot along its normal, mm. Translating: direction_deg, the way out, ccw from Ox; offset: of the tip's line from
    the shaft, mm, positive to the right of the way out; at: distance from the shaft, along the way out, from which the tip's
    centre or the face is counted.
    """

    motion: Literal["oscillating", "translating"]
    shape: Literal["roller", "knife", "flat"] = "roller"
    radius: Length | None = None
    pivot: Point | None = None
    arm: Length | None = None
    at_deg: Degrees | None = None
    leaves: Literal[-1, 1] | None = None
    face_offset: Coordinate | None = None
    direction_deg: Degrees | None = None
    offset: Coordinate | None = None
    at: Coordinate | None = None
    contour: Annotated[int, Field(ge=1, le=1000)] | None = None
    inside: bool = False
    centre: Point = (0.0, 0.0)
    flipped: bool = False
    turned_deg: Degrees = 0.0

    def faults(self) -> Sequence[Fault]:
        """What is wrong between keys that are right one by one."""
        required, optional = _KEYS[self.motion, self.shape == "flat"]
        what = f"a flat '{self.motion}'" if self.shape == "flat" else f"'{self.motion}'"
        takes = f"no value here: {what} takes {', '.join((*required, *optional))}"
        all_keys = {key for keys in _KEYS.values() for group in keys for key in group}
        faults = [
            Fault((key,), "", takes)
            for key in sorted(all_keys - {*required, *optional})
            if getattr(self, key) is not None
        ]
        faults += [
            Fault((key,), "", f"missing: {what} needs it")
            for key in required
            if getattr(self, key) is None
        ]
        if self.shape == "roller" and self.radius is None:
            faults.append(
                Fault(
                    ("radius",), "", "missing: a roller or round tip needs it; shape=knife has none"
                )
            )
        if self.shape != "roller" and self.radius is not None:
            faults.append(
                Fault(
                    ("radius",), f"{self.radius:g}", f"no value here: shape '{self.shape}' has none"
                )
            )
        if self.shape == "flat" and self.inside:
            faults.append(
                Fault(("inside",), "true", "false: a face cannot touch a wall from within")
            )
        if self.pivot is None or faults:
            return faults
        if not abs(complex(*self.pivot)) > 0:
            return [Fault(("pivot",), "0/0", "a pivot away from the shaft")]
        if self.at_deg is None:
            return (
                []
                if self.leaves
                else [
                    Fault(("leaves",), "", "missing: +1 or -1, or at_deg, for the side of the arm")
                ]
            )
        if self._side == 0:
            return [
                Fault(
                    ("at_deg",),
                    f"{self.at_deg:g}",
                    "an arm that does not lie on the line through shaft and pivot",
                )
            ]
        if self.leaves not in (None, -self._side):
            return [
                Fault(
                    ("leaves",),
                    f"{self.leaves:+d}",
                    f"{-self._side:+d}, for an arm at {self.at_deg:g} deg",
                )
            ]
        return []

    @property
    def axle(self) -> complex:
        """The arm's axle, from the shaft, mm; 0 on a slide."""
        return complex(*(self.pivot or (0.0, 0.0)))

    @property
    def _side(self) -> int:
        """Side of the line from the shaft to the pivot on which the arm at at_deg lies, 1 is left, 0 is on it."""
        lean = math.sin(
            math.radians(self.at_deg or 0.0) - math.atan2(self.axle.imag, self.axle.real)
        )
        return 0 if abs(lean) < 1e-12 else int(math.copysign(1, lean))

    @property
    def sense(self) -> int:
        """Sense of s that takes the follower off the cam."""
        return 1 if self.motion == "translating" else self.leaves or -self._side

    @property
    def direction(self) -> complex:
        """Unit vector of the way out on a slide."""
        angle = math.radians(90.0 if self.direction_deg is None else self.direction_deg)
        return complex(math.cos(angle), math.sin(angle))

    @property
    def anchored(self) -> bool:
        """Whether s is counted from a place that the table gives, not from the innermost position."""
        return (self.at if self.motion == "translating" else self.at_deg) is not None

    @property
    def reference(self) -> complex:
        """The follower at s = 0, mm: the arm (a unit normal for its face), or from the shaft the tip's centre or the face."""
        if self.motion == "translating":
            return self.direction * complex(self.at or 0.0, -(self.offset or 0.0))
        unit = (
            -1j * self.sense * self.axle / abs(self.axle)
        )  # square to the line of shaft and axle where none is given
        if self.at_deg is not None:
            unit = complex(math.cos(math.radians(self.at_deg)), math.sin(math.radians(self.at_deg)))
        return (self.arm or 1.0) * unit

    @property
    def form(self) -> Form:
        """The same for `contact`."""
        if self.shape == "flat" and self.motion == "oscillating":
            return ArmFace(self.axle, self.reference, self.face_offset or 0.0, self.sense)
        if self.shape == "flat":
            return SlideFace(self.reference, self.direction, 1)
        if self.motion == "oscillating":
            return ArmTip(self.axle, self.reference, self.radius or 0.0, self.sense, self.inside)
        return SlideTip(self.reference, self.direction, self.radius or 0.0, 1, self.inside)

    @property
    def unit(self) -> tuple[str, float]:
        """What people read s in, and how many of it one unit of s is."""
        return ("mm", 1.0) if self.motion == "translating" else ("deg", math.degrees(1))

    def mounted(self, ring: Ring) -> Ring:
        """The outline as it turns at theta = 0: shaft at the origin, the material on the left."""
        ring = ring.moved(shift=-complex(*self.centre))
        if self.flipped:
            ring = ring.moved(-1, mirror=True).counter_clockwise()
        turn = math.radians(self.turned_deg)
        ring = ring.moved(complex(math.cos(turn), math.sin(turn))) if turn else ring
        return ring.reversed() if self.inside else ring


def read_follower(
    given: str | PathLike[str] | Mapping[str, Any], option: str = "--follower"
) -> FollowerTable:
    """Follower from its table, from a TOML file (its table [follower], or all of it), or from text such as
    "oscillating,pivot=60/0,arm=67".

    SpecError with every fault; FileError where the file cannot be read.
    """
    if isinstance(given, str) and not given.endswith(".toml"):
        data = inline_tables(given, option)
    else:
        data = (
            reading.tables(given, option)
            if isinstance(given, Mapping)
            else reading.read(Path(given))
        )
        table = data.get("follower", data)
        data = table if isinstance(table, dict) else {"motion": table}
    return specs.validate(FollowerTable, data, option)


def pair_faults(first: FollowerTable, second: FollowerTable) -> Sequence[Fault]:
    """Why two tables are not two tips of one follower."""
    tables = (("--follower", first), ("--second-follower", second))
    if first.motion != second.motion:
        return [
            Fault(
                ("motion",),
                second.motion,
                f"'{first.motion}', as --follower",
                source="--second-follower",
            )
        ]
    key = "at" if first.motion == "translating" else "at_deg"
    faults = [
        Fault((key,), "", "missing: where both tips are at one moment", source=name)
        for name, f in tables
        if not f.anchored
    ]
    if first.pivot != second.pivot:
        faults.append(
            Fault(
                ("pivot",),
                f"{second.axle:g}",
                "that of --follower: both tips are on one follower",
                source="--second-follower",
            )
        )
    if first.inside and second.inside:
        faults.append(
            Fault(
                ("inside",),
                "true",
                "false for one of the two: a groove also has an inner wall",
                source="--second-follower",
            )
        )
    same = first.inside != second.inside  # in a groove both walls are met on one line
    sense, which = (1, "that of") if same else (-1, "opposite to that of")
    if first.motion == "translating" and abs(second.direction - sense * first.direction) > 1e-9:
        faults.append(
            Fault(
                ("direction_deg",),
                "",
                f"a direction {which} --follower",
                source="--second-follower",
            )
        )
    if first.motion == "oscillating" and not faults and second.sense != sense * first.sense:
        faults.append(
            Fault(
                ("leaves",),
                f"{second.sense:+d}",
                f"{sense * first.sense:+d}, {which} --follower",
                source="--second-follower",
            )
        )
    return faults


def inline_tables(text: str, option: str) -> reading.Data:
    """Tables of "oscillating,pivot=60/0,arm=67": the first word is the motion, a point is x/y, a value is TOML's or text."""
    first, *rest = [item.strip() for item in text.split(",")]
    data: reading.Data = {}
    if "=" in first:
        rest.insert(0, first)
    else:
        data["motion"] = first
    faults = []
    for item in rest:
        key, equals, value = (part.strip() for part in item.partition("="))
        if not equals or not key or not value:
            faults.append(
                Fault((), repr(item), "KEY=VALUE, such as arm=67 or pivot=60/0", source=option)
            )
        elif key in data:
            faults.append(Fault((key,), value, "each key once", source=option))
        else:
            cells = [_value(cell) for cell in value.split("/")]
            data[key] = cells if len(cells) > 1 else cells[0]
    if faults:
        raise SpecError(faults, "command line")
    return data


def _value(text: str) -> object:
    try:
        parsed = tomllib.loads(f"value = {text}")
    except ValueError:
        return text
    return parsed["value"] if len(parsed) == 1 else text
