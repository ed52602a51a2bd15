"""A groove in two pieces, each printed with its wall up: the drum with the lower wall and a core, and a ring with the upper one.

|__ _|  |_ __|      The ring is put on from above. It goes round the core with play, sits on the core's shoulder, and a key holds
|__| |  | |__|      its angle: there the core is narrower, with a flat on +y, as the bore has its own. All heights are over the
   | |  | |         drum's lower end, mm; the ring's own z runs down from the drum's upper end, for it is printed turned over.
 __| |  | |__
|____|  |____|
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from camgen.errors import DesignError
from camgen.geometry.drum_walls import RollerPath
from camgen.geometry.drums import Drum
from camgen.geometry.outlines import Contour
from camgen.machine.features import DrumRing, Mount
from camgen.machines.cylinder_cam.track import Track
from camgen.numerics import Floats, Points
from camgen.parts.part import Part, d_bore, drum_ring, keyed_drum
from camgen.parts.steps import COLUMNS
from camgen.study import Doing, Step, Table

DRUM = "drum"
RING = "ring"
SEAT = "flat on flat, down on the core's shoulder"
GLUED = f"pressed and glued on {DRUM}, {SEAT}"


def ring_mount(ring: Part, top: float) -> Mount:
    """Where the ring stands on the cam: turned over, its own z = 0 at the height top."""
    return Mount(ring.name, "cam", flipped=True, z=top - ring.thickness)


@dataclass(frozen=True)
class Pieces:
    """Both pieces of a groove; DesignError where its drum has no room for the key."""

    track: Track
    bore_reach: float  # how far the shaft's hole reaches from the axis
    slide: float  # diametral, of the ring round the core
    press: float  # diametral, of its key

    def __post_init__(self) -> None:
        track = self.track
        least = self.bore_reach + 2 * track.wall
        if track.floor < least - 1e-9:
            remedy = "there is no room for the key between bore and track: a larger geometry.radius, a smaller parts.wall, or parts.pieces = 1"
            where = "the floor of the track"
            raise DesignError(
                "geometry.radius",
                track.radius,
                track.radius + least - track.floor,
                "mm",
                where,
                remedy,
            )
        room = track.drum.span[1]
        if self.shoulder < room:
            remedy = "there is no room for the key over the track: a larger geometry.length, a smaller parts.wall, or parts.pieces = 1"
            limit = track.length + room - self.shoulder
            raise DesignError(
                "geometry.length", track.length, limit, "mm", "the highest wall", remedy
            )

    @property
    def shoulder(self) -> float:
        """Height of the face on which the ring sits."""
        return self.track.length - self.track.key_height

    @property
    def key_radius(self) -> float:
        """Of the core over the shoulder."""
        return self.track.floor - self.track.wall / 2

    @property
    def flat(self) -> float:
        """Distance of its flat from the axis."""
        return max(self.bore_reach + self.track.wall, self.key_radius / 2)

    @property
    def corner(self) -> float:
        """Half the length of the flat, which is the lever of an error of the key."""
        return math.sqrt(self.key_radius**2 - self.flat**2)

    @property
    def thinnest(self) -> float:
        """Of the shoulder's width, the key's height and what is left round the bore."""
        return min(self.track.wall / 2, self.track.key_height, self.flat - self.bore_reach)

    def _key(self, clearance: float) -> Contour:
        """Outline of the key, its walls further out by half a clearance."""
        radius = self.key_radius + clearance / 2
        return d_bore(2 * radius, radius - self.flat - clearance / 2)

    @property
    def inside(self) -> float:
        """Radius of the ring within its wall."""
        return self.track.floor + self.slide / 2

    @cached_property
    def _lower(self) -> Drum:
        return replace(self.track.drum, track="end", length=self.shoulder)

    @cached_property
    def _upper(self) -> Drum:
        """In the ring's own frame, turned over about Oy: what stands at phi stands at pi - phi, and both coordinates change sign."""
        drum = self.track.drum
        top = self.track.length

        def place(phi: Floats, order: int) -> Points:
            turned = (-1) ** (order + 1) * drum.path.place(math.pi - phi, order)
            return np.asarray(turned + (1j * top if order == 0 else 0.0))

        breaks = tuple(np.mod(-math.pi - np.array(drum.breaks), math.tau).tolist())
        ring = replace(
            drum,
            track="end",
            floor=self.inside,
            path=RollerPath(place),
            breaks=breaks,
            pocket=self.track.key_height,
        )
        return replace(ring, length=ring.span[1])

    def parts(self, hole: Contour) -> tuple[Part, Part]:
        """Drum and ring."""
        drum = keyed_drum(
            DRUM,
            "Drum of a cylinder cam, its lower wall",
            self._lower,
            hole,
            self._key(0.0),
            self.track.length,
        )
        ring = drum_ring(RING, "Ring with the upper wall", self._upper, self._key(self.press))
        return drum, replace(ring, notes=(f"{SEAT}, glued",))

    @property
    def ring(self) -> DrumRing:
        """What the judge is told of the ring."""
        middle = (self.shoulder + self.track.length) / 2
        return DrumRing(RING, self.track.length, middle, math.hypot(self.corner, self.flat))

    def steps(self) -> Table:
        """In which order they go together."""
        rows = [
            (1, DRUM, "Drum", "on the table, its core up", 1, 0.0, "as drawn"),
            (2, RING, "Ring", GLUED, 1, self.track.length - self._upper.length, "turned over"),
        ]
        said = (
            (DRUM, "lay the drum on the table, its core up"),
            (RING, f"glue the ring on the drum, {SEAT}"),
        )
        steps = [Step([Doing(text)], [f"{name}-1"]) for name, text in said]
        return Table("Assembly of the drum", COLUMNS, rows, steps)
