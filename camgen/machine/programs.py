"""Programs of motion as laws of joints and drives."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

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
class CarriedLaw(CamLaw):
    """A program over the way of a cam that slides, mm: it is gone through once."""

    def __call__(self, way: Floats, order: int = 0) -> Floats:
        """Its order-th derivative at the cam's place, (n,)."""
        return np.asarray(self.sign * self.program(way, order))


@dataclass(frozen=True, eq=False)
class TableLaw:
    """Angles of a period as the law of a drive: a cubic spline through them, and on by whole turns where a period ends turned on."""

    angles: Floats  # rad, at even theta from 0 on, the end of the period left out
    advance: float = 0.0  # rad, over a period

    @cached_property
    def _spline(self) -> Callable[[Floats, int], Floats]:
        """The angles less their mean advance."""
        from scipy.interpolate import CubicSpline

        theta = np.linspace(0, math.tau, len(self.angles) + 1)
        swing = self.angles - self.advance * theta[:-1] / math.tau
        spline = CubicSpline(theta, np.append(swing, swing[0]), bc_type="periodic")
        return lambda x, order: np.asarray(spline(x, order), float)

    def __call__(self, theta: Floats, order: int = 0) -> Floats:
        """Its order-th derivative at theta, (n,)."""
        theta = np.asarray(theta, float)
        value = self._spline(np.mod(theta, math.tau), order)
        rate = self.advance / math.tau
        return value + (rate * theta if order == 0 else rate if order == 1 else 0.0)


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
