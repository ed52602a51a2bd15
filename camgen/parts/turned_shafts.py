"""A turned shaft as data: its sizes with their fits, keyways, grooves for rings, and where bearings sit; mm from one end."""

from __future__ import annotations

import math
from dataclasses import dataclass

# Of outer rings that stand still under the load and may slide [engineersedge.com, 15320].
_HOUSING = "H7"
_COAXIAL = 0.03  # mm, of both: camgen's own rule, as the run-out of what the shaft turns
_FREE = 2.0  # mm, by which the bore of the bearing that is free is wider


@dataclass(frozen=True)
class ShaftKeyway:
    """A keyway with round ends, open where it reaches the end of its shaft."""

    start: float
    length: float
    width: float
    fit: str  # of its width
    depth: float  # t1; 0: not known
    deeper: float  # by how much it may be deeper
    keys: tuple[tuple[float, float], ...] = ()  # from where to where keys lie in it; (): it is full

    @property
    def end(self) -> float:
        """Where it ends."""
        return self.start + self.length


@dataclass(frozen=True)
class RingGrooves:
    """Two grooves for retaining rings on either side of something: over their outer walls `apart`, from `start` on."""

    ring: str  # name of their rings in the list
    start: float
    apart: float
    wider: float  # by how much they may lie farther apart
    diameter: float
    fit: str  # of it
    width: float  # H13
    thick: float  # of a ring

    @property
    def walls(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Where each groove begins and ends."""
        end = self.start + self.apart
        return (self.start, self.start + self.width), (end - self.width, end)


@dataclass(frozen=True)
class ShaftBearings:
    """The two ball bearings of a shaft."""

    name: str
    outside: float  # their diameter
    width: float  # of each
    seats: tuple[float, float]  # where they begin, the one that is held first
    gap: float  # from a bearing to what sits next to it
    fit: str  # of the shaft under them


@dataclass(frozen=True)
class TurnedShaft:
    """A shaft of one diameter."""

    diameter: float
    fit: str  # of it
    length: float
    keyways: tuple[ShaftKeyway, ...]
    bores: tuple[tuple[float, float], ...] = ()  # what sits on it: where each begins, and how long
    grooves: tuple[RingGrooves, ...] = ()
    bearings: ShaftBearings | None = None

    @property
    def volume(self) -> float:
        """Without its grooves and keyways, mm^3; the ends of these are round."""
        section = math.pi * self.diameter**2 / 4
        cut = 0.0
        for pair in self.grooves:
            cut += 2 * pair.width * (section - math.pi * pair.diameter**2 / 4)
        for each in self.keyways:
            half = each.width / 2
            radius = self.diameter / 2
            angle = math.asin(half / radius)
            under = radius**2 * angle + half * radius * math.cos(
                angle
            )  # the circle's arc, over the axis
            cut += (under - each.width * (radius - each.depth)) * (
                each.length - (1 - math.pi / 4) * each.width
            )
        return section * self.length - cut

    @property
    def coupled(self) -> float:
        """Where the end for the coupling begins, behind the second bearing and its ring."""
        behind = self.bearings.seats[1] + self.bearings.width if self.bearings else 0.0
        return max([behind, *(each.walls[1][1] for each in self.grooves)])

    @property
    def housings(self) -> tuple[str, ...]:
        """What the frame has for its bearings, in words: both of them, and each; nothing without any."""
        if self.bearings is None:
            return ()
        first, second = self.bearings.seats
        outside = self.bearings.outside
        wide = self.bearings.width
        # the outer ring is a quarter of the section high
        shoulders = outside - (outside - self.diameter) / 4
        return (
            f"two bores {outside:g} {_HOUSING}, coaxial within {_COAXIAL:g}, their middles {second - first:.4g} apart",
            f"{wide:g} wide between shoulders Ø{shoulders:.3g} at the end without the coupling, at least {wide + _FREE:g} and open at the "
            "other",
        )
