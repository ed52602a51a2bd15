"""Planetary sets: sun, planets on a carrier, ring; whether they go together, and how they turn.

count       planets, evenly spread where teeth of sun and ring together are a multiple of it
seats       angles at which planets can stand: multiples of a turn over the teeth of sun and ring together
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from camgen.errors import DesignError
from camgen.parts.wheels.mesh import Mesh

Member = Literal["sun", "carrier", "ring"]
_SAME = 1e-6  # mm, by which both distances may differ


def seats(teeth: tuple[int, int, int], count: int) -> list[float]:
    """Angles of planets about the sun from that of the first one, rad, as evenly spread as teeth of sun, planet and ring let them."""
    whole = teeth[0] + teeth[2]
    return [math.tau / whole * round(k * whole / count) for k in range(count)]


def turns(teeth: tuple[int, int, int], fixed: Member, driven: Member) -> dict[str, float]:
    """Turns of each member, and of a planet, for one of `driven` while `fixed` stands still; teeth of sun, planet and ring.

    All turn by the same where they are locked together; seen from the carrier, sun and ring turn against each other as
    their teeth do [Willis].
    """
    sun, planet, ring = teeth
    seen = {"sun": 1.0, "carrier": 0.0, "ring": -sun / ring, "planet": -sun / planet}
    rate = seen[driven] - seen[fixed]
    return {name: (each - seen[fixed]) / rate for name, each in seen.items()}


@dataclass(frozen=True)
class PlanetSet:
    """A sun with its planets, the planets in their ring; both pairs have the planet in common."""

    sun: Mesh  # a: the sun, b: a planet
    ring: Mesh  # a: a planet, b: the ring
    count: int
    gap: float = 0.0  # that neighbours keep, mm

    def __post_init__(self) -> None:
        apart = abs(self.sun.distance - self.ring.distance)
        if apart > _SAME:
            sun, planet, ring = self.teeth
            raise DesignError(
                "distance of the planets from the sun's axis and from the ring's",
                apart,
                _SAME,
                "mm",
                "",
                f"take a ring of {sun + 2 * planet} teeth"
                if ring != sun + 2 * planet
                else "other shifts",
            )
        neighbours = 2 * self.sun.distance * math.sin(math.pi / self.count)
        least = 2 * self.sun.b.tip + self.gap
        if self.count > 1 and neighbours < least:
            raise DesignError(
                f"distance of {self.count} planets from each other",
                neighbours,
                least,
                "mm",
                "",
                "take fewer planets, or a larger sun",
            )

    @property
    def teeth(self) -> tuple[int, int, int]:
        """Of sun, planet and ring."""
        return self.sun.a.teeth, self.sun.b.teeth, self.ring.b.teeth
