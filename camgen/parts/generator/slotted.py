"""Slots as holes: straight, round at both ends; two on one line with no wall between them are one."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from camgen.geometry.outlines import Contour
from camgen.parts.level_rules import in_line
from camgen.parts.part import hull
from camgen.tolerances import SAME_POINT


@dataclass(frozen=True)
class SlotHole:
    """A slot as a hole."""

    low: complex  # mm, one end of its middle line
    high: complex  # the other
    half: float  # mm, half its width
    name: str  # of the point whose pin runs in it, or of several

    def joined(self, other: SlotHole, wall: float) -> SlotHole | None:
        """Both as one slot; None where they lie on two lines, differ in width, or a wall of so much, mm, is left between."""
        ends = [self.low, self.high]
        others = [other.low, other.high]
        same = abs(self.half - other.half) < SAME_POINT
        if not same or not in_line(np.array(ends), np.array(others)):
            return None
        length = abs(self.high - self.low)
        way = (self.high - self.low) / length
        low, *_, high = sorted(ends + others, key=lambda z: (z * way.conjugate()).real)
        if abs(high - low) - length - abs(other.high - other.low) >= 2 * self.half + wall:
            return None
        return SlotHole(low, high, self.half, f"{self.name}, {other.name}")

    @property
    def contour(self) -> Contour:
        """Its edge."""
        return hull([(self.low, self.half), (self.high, self.half)])


def one_by_one(slots: Iterable[SlotHole], wall: float) -> list[SlotHole]:
    """Slots with those joined that leave no wall of so much, mm, between them."""
    apart: list[SlotHole] = []
    for slot in slots:
        whole = slot
        for other in tuple(apart):
            both = whole.joined(other, wall)
            if both is not None:
                apart.remove(other)
                whole = both
        apart.append(whole)
    return apart
