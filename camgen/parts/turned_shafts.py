"""A turned shaft as data: its sizes with their fits, keyways, grooves for rings, and where bearings sit; mm from one end."""

from __future__ import annotations

from dataclasses import dataclass


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
