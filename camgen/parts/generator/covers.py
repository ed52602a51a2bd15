"""What keeps a runner in its guide: over each pair of rails a cover that is screwed on them, under the runner a saddle.

cover    one level over the runner, or more where the heads of its screws need it; the heads are sunk into it
screw    two in each rail, from above into core holes as deep as the rail stands over the saddle
saddle   fills what lies between rails under a runner on a level that is not the lowest
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from camgen.errors import DesignError
from camgen.geometry.outlines import Region, circle
from camgen.machine.features import Mount
from camgen.parts.catalogue import CORE_HOLES, HEAD_ROOM, SCREWS, Bought, Screw
from camgen.parts.generator.changes import Change, Unmade
from camgen.parts.generator.sizes import SUNK, Parts
from camgen.parts.hardware import plate
from camgen.parts.part import Layer, Part, hull
from camgen.spec import Print

_THREADS = ("M3", "M2.5", "M2")  # the first that the rails hold

Ends = tuple[complex, complex]


@dataclass(frozen=True)
class Cover:
    """Sizes of all covers; mm."""

    screw: Screw
    length: float  # of a screw
    radius: float  # of a cover's corner about each screw
    levels: int  # how many a cover takes
    thickness: float
    grip: float  # under a screw's head

    @property
    def core(self) -> float:
        """Diameter of a core hole, mm."""
        return CORE_HOLES[self.screw.thread]

    def inset(self, rail_width: float) -> float:
        """How far a screw is from the middle of a rail's round end, so that the cover reaches no further, mm."""
        return max(0.0, self.radius - rail_width / 2)

    def least(self, rail_width: float) -> float:
        """Least length of a rail's middle line, mm: the corners of a cover stay beside each other."""
        return 2 * (self.inset(rail_width) + self.radius)

    def places(self, rails: Sequence[Ends], rail_width: float) -> list[complex]:
        """Places of the screws in the rails under one cover, complex mm in the guide's axes."""
        inset = self.inset(rail_width)
        ways = [(a, b, (b - a) / abs(b - a)) for a, b in rails]
        return [z for a, b, way in ways for z in (a + inset * way, b - inset * way)]

    def part(self, places: Sequence[complex], along: complex, min_wall: float) -> Part:
        """The cover with its screws at these places; its origin is their middle, Ox the guide's line."""
        middle = sum(places) / len(places)
        own = [(z - middle) / along for z in places]
        outer = hull([(z, self.radius) for z in own])

        def region(wide: float) -> Region:
            holes = {f"screw {k}": circle(z, wide / 2) for k, z in enumerate(own, 1)}
            return plate("cover", outer, holes, min_wall)

        low = Layer(region(self.screw.clearance), 0.0, self.grip)
        high = Layer(region(self.screw.head + HEAD_ROOM), self.grip, self.thickness)
        screws = f"{len(own)} screws {self.screw.thread} x {self.length:g}"
        return Part(
            "cover",
            "Cover of a guide",
            (low, high),
            centres=tuple(own),
            min_wall=min_wall,
            notes=(f"held on its rails by {screws}, heads sunk",),
            role="cover",
        )

    def bought(self, covers: Sequence[Mount]) -> list[Bought]:
        """The screws of covers, heads sunk."""
        size = f"{self.screw.thread} x {self.length:g}, into core holes of {self.core:g}"
        at = tuple((name, 4) for name in dict.fromkeys(each.part for each in covers))
        name = "screw of a cover"
        screw = self.screw
        held = Bought(
            name,
            screw.standard,
            size,
            4 * len(covers),
            at=at,
            thread=screw.thread,
            length=self.length,
        )
        return [held] if covers else []


def cover(sizes: Parts, fits: Print, min_wall: float) -> Cover | None:
    """With the largest screws that the rails hold; None where none is wanted. DesignError where they hold none."""
    if not sizes.cover:
        return None
    step = sizes.thickness + fits.slide_clearance
    play = fits.slide_clearance
    for thread in _THREADS:
        screw = SCREWS[thread]
        core = CORE_HOLES[thread]
        levels = math.ceil((screw.height + SUNK + 2 * fits.nozzle + play) / step - 1e-9)
        thickness = levels * step - play
        grip = thickness - screw.height - SUNK
        length = screw.length(grip, sizes.thickness + 2 * play)
        wall = (sizes.rail_width - core) / 2
        if wall >= min_wall and length >= grip + screw.nominal / 2:
            radius = (screw.head + HEAD_ROOM) / 2 + 1.25 * max(min_wall, 2 * fits.nozzle)
            return Cover(screw, length, radius, levels, thickness, grip)
    needed = core + 2 * min_wall
    where = "screws of the covers"
    remedy = "make the rails wider and as high as half a screw's diameter"
    error = DesignError("parts.rail_width", sizes.rail_width, needed, "mm", where, remedy)
    raise Unmade(error, "rails without covers", Change("parts.cover = false", {"cover": False}))


def drilled(rail: Ends, width: float, screws: Sequence[complex], core: float) -> Region:
    """A rail seen from above, with the core holes of those screws that are in it."""
    a, b = rail
    way = (b - a) / abs(b - a)
    own = [z for z in screws if abs(((z - a) / way).imag) < width / 2]
    return Region(hull([(a, width / 2), (b, width / 2)]), tuple(circle(z, core / 2) for z in own))


def saddle(rails: Sequence[Ends], width: float) -> Region:
    """What lies under a runner and the rails beside it."""
    return Region(hull([(z, width / 2) for ends in rails for z in ends]))
