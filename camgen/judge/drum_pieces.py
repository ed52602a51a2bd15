"""A drum of two pieces, put together from their meshes: how they overlap, whether the ring sits, what its key leaves of its angle.

overlap   of both bodies as placed; of each lump of it the mean thickness, twice its volume over its surface, mm
seat      how far the ring could still go down: lowered by d it overlaps by area (d - gap), so two depths give the gap
key       section across it: a convex core in a convex hole. It bites where the core, turned, reaches out of the hole
"""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from camgen.findings import Finding, Where, at_most
from camgen.geometry.mesh import Mesh, slice_mesh
from camgen.numerics import Points, halved

_LOWERED = 0.1  # mm, and twice that
_MOST = math.radians(10)  # of the key's play
_STEPS = 40


def placed(ring: Mesh, top: float) -> Mesh:
    """A ring as it sits on the drum: turned over about Oy, its z = 0 at the height top."""
    return Mesh(ring.vertices * [-1.0, 1.0, -1.0] + [0.0, 0.0, top], ring.faces)


def together(drum: Mesh, ring: Mesh) -> Mesh:
    """Both as one mesh, each closed."""
    return Mesh(
        np.concatenate([drum.vertices, ring.vertices]),
        np.concatenate([drum.faces, ring.faces + len(drum.vertices)]),
    )


@dataclass(frozen=True, eq=False)
class DrumPieces:
    """Drum and ring as placed; key: height of a section across the key, mm."""

    drum: Mesh
    ring: Mesh
    key: float

    @cached_property
    def _bodies(self) -> tuple[Any, Any]:
        return self.drum.manifold, self.ring.manifold

    def _overlap(self, down: float) -> Any:
        """What both share, the ring lowered."""
        drum, ring = self._bodies
        return drum ^ ring.translate([0.0, 0.0, -down])

    @property
    def play(self) -> float:
        """Half the turn that the key leaves to the ring, rad; nan without a key."""
        try:
            low, high = self.key_turn(max(self.bite(0.0), 0.0))
        except ValueError:
            return math.nan
        return (high - low) / 2

    @property
    def overlap(self) -> float:
        """The deepest of seat, key, and the thickest lump of what both share, mm; 0 without one."""
        lumps = self._overlap(0.0).decompose()
        found = [2 * each.volume() / each.surface_area() for each in lumps]
        found.append(-self.seat_gap)
        with suppress(ValueError):  # of a key that is not there
            found.append(self.bite(0.0))
        return float(max([0.0, *(depth for depth in found if math.isfinite(depth))]))

    @property
    def seat_gap(self) -> float:
        """Between the ring and the shoulder under it, mm, below 0 where it overlaps; nan where it meets none."""
        first, second = (self._overlap(k * _LOWERED).volume() for k in (1, 2))
        if second <= first or first <= 0:
            return math.nan
        return float(_LOWERED * (1 - first / (second - first)))

    @cached_property
    def _sections(self) -> tuple[Points, Points]:
        """Corners of the core and of the hole, (n,) and (m,) complex mm, across the key; ValueError where there are none."""
        core = slice_mesh(self.drum, self.key)
        hole = slice_mesh(self.ring, self.key)
        if not core or len(hole) < 2:
            raise ValueError("no section across the key")
        outer = max(core, key=lambda ring: abs(ring.area))
        inner = min(hole, key=lambda ring: abs(ring.area))
        return outer.points, inner.points

    def bite(self, angle: float) -> float:
        """How far the core reaches out of the hole that is turned by an angle, rad, mm; below 0 there is room."""
        core, hole = self._sections
        edge = np.roll(hole, -1) - hole
        outward = 1j * edge / np.abs(edge)  # the material is on its left
        turned = core * np.exp(-1j * angle)
        off = np.real(np.conj(outward)[:, None] * (turned[None, :] - hole[:, None]))
        return float(np.max(off))

    def key_turn(self, slack: float) -> tuple[float, float]:
        """The ring's turns, clockwise and counter-clockwise, at which its key bites by a slack, mm: rad, nan without a key."""
        try:
            if self.bite(0.0) > slack:
                return math.nan, math.nan
            ends = []
            for sense in (-1, 1):
                if self.bite(sense * _MOST) <= slack:
                    return math.nan, math.nan

                def bites(angle: float, sense: int = sense) -> bool:
                    return self.bite(sense * angle) > slack

                ends.append(sense * halved(bites, 0.0, _MOST, _STEPS))
        except ValueError:
            return math.nan, math.nan
        return ends[0], ends[1]


def pieces_findings(
    pieces: DrumPieces, corner: float, press: float, tolerance: float, where: Where
) -> list[Finding]:
    """INTERFERENCE of both, PIN_GAP of seat and key; corner: lever of the key, press: its diametral clearance, mm."""
    facets = 2 * tolerance
    low, high = pieces.key_turn(facets + max(0.0, -press / 2))
    seat = "how far the ring is off the drum's shoulder; its wall is off with it"
    key = "how far the key holds the ring off its angle, at the key's corners"
    return [
        at_most(
            "INTERFERENCE",
            pieces.overlap,
            facets + max(0.0, -press / 2),
            "mm",
            where,
            "overlap of drum and ring as assembled",
        ),
        at_most("PIN_GAP", abs(pieces.seat_gap), facets, "mm", where, seat),
        at_most("PIN_GAP", abs(low + high) / 2 * corner, facets, "mm", where, key),
    ]
