"""A follower's program: segments of motion laws round one turn of the cam, s(theta) with derivatives.

segment   one law over a span of cam angle; kind "rise", "dwell", "return" or "reversal"
joint     cam angle where one segment ends and the next begins
matched   segment whose law is the quintic that takes speed and acceleration from its neighbours
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from camgen.motion.laws import (
    TURN,
    TURN_PEAK,
    UNIFORM,
    Floats,
    Law,
    measured,
    polynomial,
    reversed_law,
)
from camgen.numerics import distinct, magnitude, product, solve
from camgen.tolerances import LAW_CLOSES


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
        value = (
            self.scale / self.span**order * self.law(np.asarray(angle, float) / self.span, order)
        )
        return value + self.start if order == 0 else value

    def end_values(self, order: int) -> tuple[float, float]:
        """Displacement or its derivative at its beginning and end."""
        rate = self.scale / self.span**order
        start = 0.0 if order else self.start
        first, last = self.law.end_values[order]
        return rate * first + start, rate * last + start

    @property
    def end(self) -> float:
        """Displacement at the segment's end."""
        return float(self.at(self.span))


@dataclass(frozen=True)
class Jump:
    """A discontinuity: order of the derivative that jumps, cam angle (rad), size (unit of s per rad^order), signed."""

    order: int
    theta: float
    size: float


@dataclass(frozen=True)
class Program:
    """Segments one after the other, the first beginning at cam angle `begin` (rad); together they make one turn."""

    segments: tuple[Segment, ...]
    begin: float = 0.0

    @cached_property
    def joints(self) -> Floats:
        """Cam angles at which the segments begin, and the end of the last, (n + 1,) rad."""
        return self.begin + np.concatenate(([0.0], np.cumsum([s.span for s in self.segments])))

    @cached_property
    def _starts(self) -> Floats:
        """The same after `begin`, from 0."""
        return self.joints - self.begin

    def __call__(self, theta: Any, order: int = 0) -> Floats:
        """Displacement (order 0) or its derivative to theta, (n,); at a joint the later segment counts."""
        angle = np.mod(np.asarray(theta, float) - self.begin, 2 * math.pi)
        starts = self._starts
        which = np.minimum(starts.searchsorted(angle, side="right"), len(self.segments)) - 1
        result = np.empty(angle.shape)
        first, last = (which.min(), which.max()) if which.size else (0, -1)
        for k in range(first, last + 1):
            mine = which == k if first < last else ...  # one segment: all of them
            result[mine] = self.segments[k].at(angle[mine] - starts[k], order)
        return result

    def backwards(self) -> Program:
        """The same passed from its end to its beginning: s(-theta); segments keep the kind that they have by themselves."""
        back = [
            Segment(s.kind, s.span, s.end, -s.scale, reversed_law(s.law))
            for s in reversed(self.segments)
        ]
        return Program(tuple(back), -self.begin)

    def jumps(self, order: int) -> list[float]:
        """Step of the derivative of this order at each joint, the first joint first, (n,)."""
        ends = [s.end_values(order) for s in self.segments]
        return [
            after - before for (_, before), (after, _) in zip((ends[-1], *ends), ends, strict=False)
        ]

    def peak(self, order: int) -> float:
        """Largest size of the derivative of order 1..3, unit of s per rad^order; inf where a lower one jumps."""
        if self.discontinuities(order - 1):
            return math.inf
        return max(
            abs(s.scale) / s.span**order * (s.law.c_v, s.law.c_a, s.law.c_j)[order - 1]
            for s in self.segments
        )

    @cached_property
    def breaks(self) -> Floats:
        """Cam angles, growing, where a derivative of order 0..3 may jump: joints and the breaks inside laws, (m,) rad."""
        inner = [
            b + s.span * np.array(s.law.breaks)
            for b, s in zip(self.joints, self.segments, strict=False)
            if s.scale
        ]
        return distinct(self.joints, *inner)

    @cached_property
    def corners(self) -> Floats:
        """The breaks between which the motion is one smooth curve: joints, and those inside laws that are not smooth, (m,)."""
        laws = [
            (b, s)
            for b, s in zip(self.joints, self.segments, strict=False)
            if s.scale and not s.law.smooth
        ]
        return distinct(self.joints, *(b + s.span * np.array(s.law.breaks) for b, s in laws))

    def knots(self, a: float, b: float) -> Floats:
        """The breaks inside a smooth stretch from a to b, where only the third derivative jumps, (k,) rad."""
        return self.breaks[(self.breaks > a) & (self.breaks < b)]

    def discontinuities(self, highest: int = 2) -> list[Jump]:
        """Every jump of s and its derivatives up to the highest order, joints and breaks inside laws, by angle.

        A jump counts from LAW_CLOSES of the largest value that the order has in the program.
        """
        jumps = [jump for order in range(highest + 1) for jump in self._jumps(order)]
        return sorted(jumps, key=lambda jump: (jump.theta, jump.order))

    def _jumps(self, order: int) -> Sequence[Jump]:
        """Those of one order, looked for once."""
        if order not in self._jumps_by_order:
            starts: list[float] = self.joints.tolist()
            slack = LAW_CLOSES * max(_size(s, order) for s in self.segments)
            jumps = list(zip(starts, self.jumps(order), strict=False))
            for begin, s in zip(starts, self.segments, strict=False):
                rate = s.scale / s.span**order
                jumps += [
                    (begin + u * s.span, rate * step)
                    for u, step in zip(s.law.breaks, s.law.steps[order], strict=True)
                ]
            self._jumps_by_order[order] = [
                Jump(order, theta, size) for theta, size in jumps if abs(size) > slack
            ]
        return self._jumps_by_order[order]

    @cached_property
    def _jumps_by_order(self) -> dict[int, Sequence[Jump]]:
        return {}

    @cached_property
    def extremes(self) -> tuple[float, float]:
        """Least and greatest displacement."""
        ends = [
            s.start + s.scale * value
            for s in self.segments
            for value in (s.law.extremes if s.scale else (0.0,))
        ]
        return min(ends), max(ends)


def _size(segment: Segment, order: int) -> float:
    """Largest value that a derivative takes in the segment, at least that of a uniform motion to the power of the order."""
    peak = (1.0, segment.law.c_v, segment.law.c_a, segment.law.c_j)[order]
    return abs(segment.scale) / segment.span**order * max(1.0, peak if math.isfinite(peak) else 1.0)


def matched(
    spans: Sequence[float],
    levels: Sequence[float],
    before: tuple[float, float] | None = None,
    after: tuple[float, float] | None = None,
) -> list[Segment]:
    """Quintic segments through the levels (n + 1,), which join their neighbours in speed and acceleration.

    before, after: speed and acceleration of the neighbours; None: the last segment joins the first (a whole turn).
    At inner joints speed and acceleration are free and the jerk continues, too; so does the fourth derivative, except
    where the motion reverses: there the speed is 0.
    """
    n = len(spans)
    rises = np.sign(np.diff(levels))
    whole = before is None or after is None
    free = range(n) if whole else range(1, n)
    # Unknown speed and acceleration at joint k are x[2 k], x[2 k + 1].
    rows = np.zeros((2 * n + 2, 2 * n + 2))
    values = np.zeros(2 * n + 2)
    for k in free:
        for jump, order in enumerate((3, 4)):
            row = rows[2 * k + jump]
            if order == 4 and rises[k] * rises[k - 1] < 0:
                row[2 * k] = 1
                continue
            for which, sign, end in ((k - 1, 1, 1.0), (k, -1, 0.0)):
                which %= n
                slopes, end_values = _quintic_end(
                    order, end, spans[which], levels[which], levels[which + 1]
                )
                row[2 * which : 2 * which + 4] += sign * slopes
                values[2 * k + jump] -= sign * end_values
    if whole:
        rows[2 * n : 2 * n + 2, :2] = np.eye(2)
        rows[2 * n : 2 * n + 2, 2 * n :] = -np.eye(2)
    else:
        rows[:2, :2] = np.eye(2)
        rows[2 * n :, 2 * n :] = np.eye(2)
        values[:2] = before
        values[2 * n :] = after
    x = solve(rows[None], values[None])[0].reshape(-1, 2)
    return [_quintic(spans[k], levels[k], levels[k + 1], x[k], x[k + 1]) for k in range(n)]


# Coefficients c3, c4, c5 of a quintic over u = 0..1 from s(1) - s(0), s'(0), s''(0), s'(1), s''(1).
_QUINTIC = np.array([[10, -6, -1.5, -4, 0.5], [-15, 8, 1.5, 7, -1], [6, -3, -0.5, -3, 0.5]])


def _quintic_end(order: int, u: float, span: float, s0: float, s1: float) -> tuple[Floats, float]:
    """Derivative of order 3 or 4 of a quintic at u: its dependence on v0, a0, v1, a1, and the rest."""
    weights = np.array(
        [math.perm(k, order) * u ** (k - order) if k >= order else 0.0 for k in (3, 4, 5)]
    )
    row = product(weights[None], _QUINTIC)[0] / span**order
    return row[1:] * np.array([span, span**2, span, span**2]), float(row[0] * (s1 - s0))


def _quintic(span: float, s0: float, s1: float, start: Floats, end: Floats) -> Segment:
    """The quintic segment with this speed and acceleration at its ends."""
    rates = np.array(
        [s1 - s0, start[0] * span, start[1] * span**2, end[0] * span, end[1] * span**2]
    )
    scale = magnitude(rates) or 1.0
    rates = rates / scale
    high = product(_QUINTIC, rates[:, None])[:, 0]
    formula = polynomial(0.0, rates[1], rates[2] / 2, *high)
    ends = ((0.0, *map(float, rates[1:3])), (float(rates[0]), *map(float, rates[3:])))
    kind = "rise" if s1 > s0 else "return"
    return Segment(
        kind,
        span,
        s0,
        scale,
        measured("matched", formula, "quintic that joins its neighbours", ends=ends),
    )


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
