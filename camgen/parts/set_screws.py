"""Hubs that a set screw holds on a shaft, so that nothing walks off: printed, the screw in a nut that lies in a pocket.

              |  |          the screw, along +y, square to the shaft's flat where it has one
        ______|  |______
       |  |===|  |===|  |   the nut in its pocket, open on the hub's upper side
       |  |___|  |___|  |   between nut and bore a wall, outside the nut a wall that it pulls on
        \\      __      /
         \\    (  )    /

How it holds: the screw is turned until the nut presses on its wall as hard as the plastic bears; on a round shaft that force
times HOLDS is what keeps the hub from sliding, along the shaft and round it. [axial holding power of cup points on steel:
ficientdesign.com/set-screw-torque-chart, 50 lb of #4 by 5.2 lb in, 400 lb of 1/4 in by 87 lb in, which are 0.22 and 0.26 of the
screw's force T / (0.2 d); holding power grows with the seating torque: Unbrako, socket set screws]

In a hub of metal with a keyway the screw turns in a thread of the hub and presses on the key, which turns the hub.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass, replace

from camgen.errors import DesignError
from camgen.geometry.outlines import Arc, Contour, Line, Piece, Region, circle, rectangle
from camgen.parts.catalogue import SCREWS, Bought, Screw, nut
from camgen.parts.part import HoldingNote, Layer, Part, d_bore

ON_KEY_STANDARD = "ISO 4026"  # of screws on keys
_ON_KEY = 220.0  # N along the shaft, of a screw from M3 on: the 50 lb of #4, which is thinner
_GRIP = 1.0  # diameters of thread in the wall over the key
_ABOUT = 1.5  # diameters: least height of a hub of metal
HOLDS = 0.2  # of the screw's force, as friction of its point on the shaft
TURNED = 0.2  # torque over force times diameter of a dry screw, as the source above counts
_ROOM = 0.2  # mm, of the pocket round its nut
_LENGTHS = (3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 16.0, 20.0)  # of set screws in shops, mm


@dataclass(frozen=True)
class KeyScrew:
    """A set screw in a hub of metal, on its key: it keeps the hub from sliding; wall: from the keyway's floor to the hub's edge,
    mm."""

    thread: str
    wall: float

    @property
    def least_wall(self) -> float:
        """In which its thread holds, mm."""
        return _GRIP * SCREWS[self.thread].nominal

    @property
    def least_height(self) -> float:
        """Of its hub, mm."""
        return _ABOUT * SCREWS[self.thread].nominal

    def bought(self, count: int) -> list[Bought]:
        """Its rows in the parts list; it ends within the hub where such a length is sold."""
        length = max((each for each in _LENGTHS if each <= self.wall), default=_LENGTHS[0])
        holds = (
            f", holds some {_ON_KEY:g} N along the shaft"
            if SCREWS[self.thread].nominal >= 3
            else ""
        )
        size = f"{self.thread} x {length:g}, flat point{holds}"
        how = "in the thread of the hub with a drop of threadlocker; tighten it on the key"
        return [
            Bought("set screw of the hub", ON_KEY_STANDARD, size, count, how=how),
            Bought("threadlocker", "", "of medium strength", 1, "aside"),
        ]


@dataclass(frozen=True)
class SetScrewHub:
    """A round hub on a shaft, mm: thread of its screw; bore's diameter and depth of its flat (0: none), fit included; walls: at
    least `thin` beside the bore and under the nut, `wall` outside it."""

    thread: str
    bore: float
    flat: float
    thin: float
    wall: float

    @property
    def screw(self) -> Screw:
        """Its thread, clearance hole and nut."""
        return SCREWS[self.thread]

    @property
    def near(self) -> float:
        """From the axis to the nut."""
        return self.bore / 2 - self.flat + self.thin

    @property
    def far(self) -> float:
        """From the axis to the outer side of the pocket."""
        return self.near + self.screw.nut + _ROOM

    @property
    def least_radius(self) -> float:
        """Radius at which the wall outside the nut is as thick, over the pocket's whole width."""
        return math.hypot(self.far + self.wall, (self.screw.flats + _ROOM) / 2)

    @property
    def height(self) -> float:
        """With a floor under the nut, which stands on a corner."""
        return self.thin + 2 * self.screw.flats / math.sqrt(3) + _ROOM

    @property
    def middle(self) -> float:
        """Of the screw over the hub's underside."""
        return self.thin + self.screw.flats / math.sqrt(3) + _ROOM / 2

    def bought(self, radius: float, part: str) -> list[Bought]:
        """Screw and nut, of a part's hub of a radius; the screw ends within the hub where such a length is sold."""
        way = radius - (self.bore / 2 - self.flat)
        length = max((each for each in _LENGTHS if each <= way), default=_LENGTHS[0])
        name = "set screw of the hub"
        return [
            Bought(name, "ISO 4029", f"{self.thread} x {length:g}", 1, at=((part, 1),)),
            replace(nut("nut of the set screw", self.thread, 1), at=((part, 1),)),
        ]

    def force(self, bears: float) -> float:
        """With which the nut presses on its wall where the plastic bears so much, MPa: N."""
        return bears * (math.sqrt(3) / 2 * self.screw.flats**2 - self.screw.clearance**2)

    def layers(self, radius: float, z: float = 0.0, height: float = 0.0) -> list[Layer]:
        """The hub from a height up, higher than it has to be where asked. DesignError where its radius leaves no wall, or the
        screw is as thick as the shaft."""
        if radius < self.least_radius - 1e-9:
            raise DesignError(
                "diameter of the hub with a set screw",
                2 * radius,
                2 * self.least_radius,
                "mm",
                f"{self.thread}, its nut",
                "make it larger, or use a thinner set_screw",
            )
        half = self.screw.clearance / 2
        wide = (self.screw.flats + _ROOM) / 2
        if half >= 0.9 * self.bore / 2:
            raise DesignError(
                "hole of the set screw",
                2 * half,
                0.9 * self.bore,
                "mm",
                self.thread,
                "use a thinner set_screw",
            )
        bore = d_bore(self.bore, self.flat) if self.flat else circle(0j, self.bore / 2)
        pocket = rectangle(complex(-wide, self.near), complex(wide, self.far))
        outer = circle(0j, radius)
        plain = Region(outer, (bore,))
        with_nut = Region(outer, (bore, pocket))
        with_screw = Region(self._cut(radius, half, wide))
        heights = (0.0, self.thin, self.middle - half, self.middle + half, max(self.height, height))
        regions = (plain, with_nut, with_screw, with_nut)
        return [
            Layer(region, z + low, z + high)
            for region, low, high in zip(regions, heights, heights[1:], strict=False)
        ]

    def _cut(self, radius: float, half: float, wide: float) -> Contour:
        """Where the screw's hole, as wide as it is high, leads from the edge through the pocket to the bore."""
        top = math.sqrt(radius**2 - half**2)
        inner = self._inner(half)
        first = cmath.phase(complex(-half, top))
        pieces: list[Piece] = [
            Arc(0j, radius, first, cmath.phase(complex(half, top)) + math.tau - first)
        ]
        right = [
            complex(half, top),
            complex(half, self.far),
            complex(wide, self.far),
            complex(wide, self.near),
            complex(half, self.near),
            complex(half, inner[0]),
        ]
        pieces += [Line(a, b) for a, b in zip(right, right[1:], strict=False)]
        pieces += inner[1]
        mirror = [-z.conjugate() for z in reversed(right)]
        return Contour((*pieces, *(Line(a, b) for a, b in zip(mirror, mirror[1:], strict=False))))

    def _inner(self, half: float) -> tuple[float, list[Piece]]:
        """Where the hole's walls meet the bore, and the bore from its right wall round below to its left one."""
        radius = self.bore / 2
        height = self.bore / 2 - self.flat
        chord = math.sqrt(max(0.0, radius**2 - height**2)) if self.flat else 0.0
        if half >= chord:
            y = math.sqrt(radius**2 - half**2)
            start = cmath.phase(complex(half, y))
            return y, [Arc(0j, radius, start, -(math.pi + 2 * start))]
        lean = math.asin(height / radius)
        corner = complex(chord, height)
        arc = Arc(0j, radius, lean, -(math.pi + 2 * lean))
        sides = (
            Line(complex(half, height), corner),
            Line(-corner.conjugate(), complex(-half, height)),
        )
        return height, [sides[0], arc, sides[1]]

    def collar(self) -> Part:
        """The hub as a part of its own, its origin the axis."""
        return Part(
            "shaft-collar",
            "Collar with a set screw",
            tuple(self.layers(self.least_radius)),
            centres=(0j,),
            bore=self.bore,
            min_wall=min(self.thin, self.wall),
            notes=(HoldingNote(f"set screw {self.thread} in its nut, tight on the shaft"),),
        )
