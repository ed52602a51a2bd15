"""Programs of motion as laws of joints and drives."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from camgen.machine.model import Floats
from camgen.motion.program import Program


@dataclass(frozen=True)
class CamLaw:
    """A cam's program as the law of a joint: sign (+1 or -1) times the displacement."""

    program: Program
    sign: int

    def __call__(self, theta: Floats, order: int = 0) -> Floats:
        """Its order-th derivative at the cam's angle theta, (n,)."""
        return np.asarray(self.sign * self.program(np.mod(theta, math.tau), order))

    @property
    def signed(self) -> Program:
        """The follower's own displacement."""
        segments = [
            replace(each, start=self.sign * each.start, scale=self.sign * each.scale)
            for each in self.program.segments
        ]
        return replace(self.program, segments=tuple(segments))

    @property
    def highest(self) -> float:
        """Greatest displacement that a segment begins or ends with: laws run between their ends."""
        return max(max(each.start, each.end) for each in self.program.segments)


@dataclass(frozen=True)
class DriveLaw:
    """A program as the law of a drive: start + s(theta), and on by whole turns where a period ends turned on."""

    program: Program
    start: float

    @property
    def reach(self) -> tuple[float, float] | None:
        """Least and greatest angle from the start, rad; None where it turns on and on."""
        ends = [segment.start for segment in self.program.segments]
        return None if abs(self.program.segments[-1].end) > 1e-9 else (min(ends), max(ends))

    def __call__(self, theta: Floats, order: int = 0) -> Floats:
        """Its order-th derivative at theta, (n,)."""
        value = np.asarray(self.program(theta, order))
        if order:
            return value
        advance = self.program.segments[-1].end
        return self.start + value + advance * np.floor(np.asarray(theta, float) / math.tau)
