"""A follower's program: segments of motion laws round one turn of the cam, s(theta) with derivatives."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from camgen.motion import TURN, TURN_PEAK, UNIFORM, Floats, Law


@dataclass(frozen=True)
class Segment:
    """Motion start + scale * law(u) while the cam turns by span (rad); for a rise, `scale` is the lift."""

    kind: str
    span: float
    start: float
    scale: float
    law: Law

    def at(self, angle: Any, order: int = 0) -> Floats:
        """Displacement or its derivative to theta at `angle` rad after the segment's beginning, (n,)."""
        value = self.scale / self.span**order * self.law(np.asarray(angle, float) / self.span, order)
        return value + self.start if order == 0 else value

    @property
    def end(self) -> float:
        """Displacement at the segment's end."""
        return float(self.at(self.span))


@dataclass(frozen=True)
class Program:
    """Segments one after the other, the first beginning at cam angle `begin` (rad); together they make one turn."""

    segments: tuple[Segment, ...]
    begin: float = 0.0

    @cached_property
    def joints(self) -> Floats:
        """Cam angles at which the segments begin, and the end of the last, (n + 1,) rad."""
        return self.begin + np.concatenate(([0.0], np.cumsum([s.span for s in self.segments])))

    def __call__(self, theta: Any, order: int = 0) -> Floats:
        """Displacement (order 0) or its derivative to theta, (n,); at a joint the later segment counts."""
        angle = np.mod(np.asarray(theta, float) - self.begin, 2 * math.pi)
        starts = self.joints - self.begin
        which = np.clip(np.searchsorted(starts, angle, side="right") - 1, 0, len(self.segments) - 1)
        result = np.empty(angle.shape)
        for k, segment in enumerate(self.segments):
            mine = which == k
            result[mine] = segment.at(angle[mine] - starts[k], order)
        return result

    def jumps(self, order: int) -> Floats:
        """Step of the derivative of this order at each joint, the first joint first, (n,)."""
        before = [s.at(s.span, order) for s in self.segments]
        after = [s.at(0.0, order) for s in self.segments]
        return np.array(after) - np.roll(before, 1)


def uniform_swing(swing: float, blend: float = 0.0) -> Program:
    """Uniform rise and uniform return of `swing` (rad peak to peak), each reversal smoothed over `blend` rad of cam angle.

    s runs from -swing/2 at theta = 0 to +swing/2 at theta = pi. Blending keeps the peaks where they are, so the
    uniform speed is swing / (pi - blend * (1 - 2 TURN_PEAK)). blend = 0: sharp; blend <= pi.
    """
    speed = swing / (math.pi - blend * (1 - 2 * TURN_PEAK))
    edge = swing / 2 - TURN_PEAK * blend * speed
    rise = Segment("rise", math.pi - blend, -edge, 2 * edge, UNIFORM)
    fall = Segment("return", math.pi - blend, edge, -2 * edge, UNIFORM)
    if blend == 0:
        return Program((rise, fall))
    low = Segment("reversal", blend, -edge, -speed * blend, TURN)
    high = Segment("reversal", blend, edge, speed * blend, TURN)
    whole = (low, rise, high, fall) if blend < math.pi else (low, high)
    return Program(whole, begin=-blend / 2)
