"""The cam of a uniform swing as a plate: shaft hole, two pins' holes, windows, an engraved arrow.

Pin holes are each other's mirror images in Oy and keyway or flat lie on Oy, so that a cam turned over about Oy fits another one.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from camgen.errors import DesignError
from camgen.geometry.distances import inside, point_to_ring, thinnest_wall
from camgen.geometry.facets import facet_contour
from camgen.geometry.outlines import Points, Region, circle
from camgen.machine.cams.profile import DiscCam
from camgen.machines.uniform_swing.room import Pins, Room
from camgen.machines.uniform_swing.tables import SwingSizes
from camgen.parts.disc_cams import LAYOUT
from camgen.parts.part import Layer, Part, arrowhead, windows

# circumscribed radius of the direction mark, mm, and its most as a share of the bore
_ARROW = 2.5
_ARROW_SHARE = 0.3125

Disc = tuple[complex, float]  # centre, radius


@dataclass(frozen=True)
class CamPlate:
    """A cam and the tables of its plate."""

    sizes: SwingSizes
    cam: DiscCam
    sense: int  # in which it turns, +1 or -1

    @cached_property
    def rim(self) -> Points:
        """Its edge in facets, on which holes are placed."""
        return facet_contour(self.cam.outline, LAYOUT * min(1.0, abs(self.cam.follower.arm) / 60))

    @cached_property
    def room(self) -> Room:
        """Room that the geometry leaves."""
        return Room(self.sizes)

    @cached_property
    def _placed(self) -> tuple[complex, float]:
        """Place of one pin hole and the wall that both keep."""
        p = self.sizes.making
        if p.make == "printed" and p.pin_diameter:
            return self.room.pins(self.rim)
        return Pins(p.pin_diameter, p.reach, p.wall, self.sizes.min_wall).placed(self.rim)

    @property
    def pins(self) -> tuple[complex, ...]:
        """Places of the pin holes."""
        if not self.sizes.making.pin_diameter:
            return ()
        place = self._placed[0]
        return place, -place.conjugate()

    @property
    def pin_wall(self) -> float:
        """What they keep, mm."""
        return self._placed[1]

    @cached_property
    def part(self) -> Part:
        """The plate; its origin is the shaft's axis."""
        p = self.sizes.making
        rim = self.rim
        reach = p.reach
        room = float(np.min(point_to_ring(np.zeros(1, complex), rim)))
        if reach >= room:
            remedy = "the bore leaves the cam: use a smaller one"
            raise DesignError(
                "parts.bore", p.bore, 2 * room, "mm", "the cam's nearest side", remedy
            )
        pins = [(z, p.pin_diameter / 2) for z in self.pins]
        mark = self._mark(pins) if p.mark_depth else None
        engraved = (
            (Layer(Region(arrowhead(*mark)), p.thickness - p.mark_depth, p.thickness),)
            if mark
            else ()
        )
        taken = [*pins, *([mark[:2]] if mark else [])]
        holes = [
            p.hole(),
            *(circle(*pin) for pin in pins),
            *windows(rim, reach, p.windows, p.wall, taken),
        ]
        # a hole smaller than the tolerance must not lose its corners
        rings = [facet_contour(h, min(LAYOUT, 0.01 * math.sqrt(abs(h.area)))) for h in holes]
        wall = thinnest_wall(rim, rings)
        if not wall > 0:
            raise DesignError(
                "wall",
                wall,
                self.sizes.min_wall,
                "mm",
                ("the cam's holes", "its edge"),
                "holes meet or leave the cam: use a smaller bore, key, pin_diameter or wall",
            )
        return Part(
            "cam",
            "Uniform-swing cam",
            (Layer(Region(self.cam.outline, tuple(holes)), 0.0, p.thickness),),
            2 if self.sizes.pair else 1,
            engraved,
            (0j, *self.pins),
            self._notes(bool(mark)),
            p.bore,
            self.sizes.min_wall,
        )

    def _mark(self, pins: Sequence[Disc]) -> tuple[complex, float, complex] | None:
        """Place, size and direction of the engraved arrow beside the bore, below it if there is room; None without any."""
        p = self.sizes.making
        size = min(_ARROW, _ARROW_SHARE * p.bore)
        free = p.wall / 2
        for turn in (-90, 90, -45, -135, 45, 135, 0, 180):
            spoke = cmath.rect(1, math.radians(turn))
            at = spoke * (p.reach + free + size)
            z = np.array([at])
            edge = float(point_to_ring(z, self.rim)[0]) if inside(z, self.rim)[0] else 0.0
            if min([edge, *(abs(at - centre) - radius for centre, radius in pins)]) > size + free:
                return at, size, self.sense * 1j * spoke
        return None

    def _notes(self, marked: bool) -> tuple[str, ...]:
        """What the drawing says beside the numbers."""
        notes = [*self.sizes.making.notes()]
        if marked:
            notes.append("engraved arrow: sense of turning of the cam that is not turned over")
        elif self.sizes.making.mark_depth:
            turns = "counter-clockwise" if self.sense > 0 else "clockwise"
            notes.append(f"no room for the engraved arrow: turns {turns} as drawn")
        if self.sizes.pair:
            notes.append("two alike, one turned over about Oy, engraved faces together")
            notes.append("the tip at -Y rides on this one, the tip at +Y on the other")
        return tuple(notes)
