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
class Slotted:
    """A slot: both ends of its middle line, complex mm, half its width, mm, and the point whose pin runs in it, or points."""

    low: complex
    high: complex
    half: float
    name: str

    def joined(self, other: Slotted, wall: float) -> Slotted | None:
        """Both as one slot; None where they lie on two lines, differ in width, or a wall of so much, mm, is left between."""
        same = abs(self.half - other.half) < SAME_POINT
        if not same or not in_line(
            np.array([self.low, self.high]), np.array([other.low, other.high])
        ):
            return None
        way = (self.high - self.low) / abs(self.high - self.low)
        row = sorted(
            (self.low, self.high, other.low, other.high), key=lambda z: (z * way.conjugate()).real
        )
        between = abs(row[-1] - row[0]) - abs(self.high - self.low) - abs(other.high - other.low)
        if between >= 2 * self.half + wall:
            return None
        return Slotted(row[0], row[-1], self.half, f"{self.name}, {other.name}")

    @property
    def contour(self) -> Contour:
        """Its edge."""
        return hull([(self.low, self.half), (self.high, self.half)])


def one_by_one(slots: Iterable[Slotted], wall: float) -> list[Slotted]:
    """Slots with those joined that leave no wall of so much, mm, between them."""
    found: list[Slotted] = []
    for slot in slots:
        whole = slot
        for other in tuple(found):
            both = whole.joined(other, wall)
            if both is not None:
                found.remove(other)
                whole = both
        found.append(whole)
    return found
