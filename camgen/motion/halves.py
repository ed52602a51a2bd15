"""All trigonometric laws of VDI 2143 by one formula: two halves and a line.

      f''  A |  __                       first half    width h1, acceleration A p1(t), t from the segment's beginning
             | /  \\  first              line          width w, speed v_m
      0 -----|/----\\----\\----/---       second half   width h2, deceleration B p2(t), t from the segment's end
             |            \\__/ second
         -B  |                            h1 = c lambda     w = 1 - c     h2 = c (1 - lambda)

    p       shape of a half, at most 1, over t = 0 at the segment's end to 1 at the inflection
    alpha   integral of p                   mu   integral of (1 - t) p
    v0, v1  speeds at both ends, of a segment of length and lift 1

From the two conditions "the speeds agree on the line" and "the displacement is 1", with d = v1 - v0 and R = 1 - v0 (h1 + w) - v1 h2:

    N = alpha2 (mu1 h1 + alpha1 w) + alpha1 mu2 h2      A = (alpha2 R + mu2 h2 d) / (N h1)
    v_m = v0 + alpha1 A h1                              B = (alpha1 R - (mu1 h1 + alpha1 w) d) / (N h2)

The second half is worked out backwards from the end, so that displacement and speed there hold to rounding.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from camgen.numerics import Floats

_SAME = 1e-9  # of a half's greatest value: accelerations and jerks nearer than this do not jump


@dataclass(frozen=True)
class Piece:
    """A stretch of a shape: constant + sine sin(rate x) + cosine cos(rate x), x from its beginning."""

    width: float
    constant: float = 0.0
    sine: float = 0.0
    cosine: float = 0.0
    rate: float = 1.0

    def integral(self, x: Floats, order: int) -> Floats:
        """Value (order 2), its first (1) and second (0) integral from the beginning, or its slope (3), (n,)."""
        k = self.rate
        if order == 0:
            arc = 2 * np.sin(k * x / 2) ** 2
            swing = self.sine * (x - np.sin(k * x) / k) / k + self.cosine * arc / k**2
            return np.asarray(self.constant * x**2 / 2 + swing)
        if order == 1:
            swing = (self.sine * 2 * np.sin(k * x / 2) ** 2 + self.cosine * np.sin(k * x)) / k
            return np.asarray(self.constant * x + swing)
        if order == 2:
            return np.asarray(
                self.constant + self.sine * np.sin(k * x) + self.cosine * np.cos(k * x)
            )
        return np.asarray(k * (self.sine * np.cos(k * x) - self.cosine * np.sin(k * x)))


@dataclass(frozen=True)
class Shape:
    """Course of the acceleration in a half, from the segment's end to the inflection; its pieces make a width of 1."""

    pieces: tuple[Piece, ...]

    @cached_property
    def _starts(self) -> list[tuple[float, float, float]]:
        """Place, first and second integral where each piece begins, and where the last ends."""
        t = first = second = 0.0
        starts = [(t, first, second)]
        for piece in self.pieces:
            x = np.asarray(piece.width)
            second += first * piece.width + float(piece.integral(x, 0))
            first += float(piece.integral(x, 1))
            t += piece.width
            starts.append((t, first, second))
        return starts

    @property
    def alpha(self) -> float:
        """Integral of the shape."""
        return self._starts[-1][1]

    @property
    def mu(self) -> float:
        """Integral of (1 - t) times the shape."""
        return self._starts[-1][2]

    @property
    def steepest(self) -> float:
        """Greatest slope of the shape."""
        return max(
            max(abs(float(piece.integral(np.asarray(x), 3))) for x in (0.0, piece.width))
            for piece in self.pieces
        )

    def end(self, t: float, order: int) -> float:
        """Value or slope at t = 0 or 1."""
        piece = self.pieces[-1 if t else 0]
        return float(piece.integral(np.asarray(piece.width if t else 0.0), order))

    def __call__(self, t: Floats, order: int) -> Floats:
        """Value (order 2), first (1) and second (0) integral from t = 0, or slope (3), (n,)."""
        bounds = [start[0] for start in self._starts[1:-1]]
        which = np.searchsorted(bounds, t, side="right")
        result = np.empty(np.shape(t))
        for k, (piece, (begin, first, second)) in enumerate(
            zip(self.pieces, self._starts, strict=False)
        ):
            mine = which == k
            x = t[mine] - begin
            value = piece.integral(x, order)
            if order == 0:
                value = value + second + first * x
            elif order == 1:
                value = value + first
            result[mine] = value
        return result


def _quarter(width: float, sine: float = 0.0, cosine: float = 0.0) -> Piece:
    return Piece(width, 0.0, sine, cosine, math.pi / 2 / width)


PARABOLA = Shape((Piece(1.0, constant=1.0),))
INCLINED_SINE = Shape((Piece(1.0, sine=1.0, rate=math.pi),))
MODIFIED_SINE = Shape((_quarter(1 / 4, sine=1.0), _quarter(3 / 4, cosine=1.0)))
TRAPEZOID = Shape(
    (_quarter(1 / 4, sine=1.0), Piece(1 / 2, constant=1.0), _quarter(1 / 4, cosine=1.0))
)
QUARTER_COSINE = Shape((_quarter(1.0, cosine=1.0),))


def reversal_trapezoid(ramp: float = 0.5) -> Shape:
    """Trapezoid's half that ends in a reversal: constant, then a fall over a share 0 < ramp <= 1 of it."""
    hold = (Piece(1 - ramp, constant=1.0),) if ramp < 1 else ()
    return Shape((*hold, _quarter(ramp, cosine=1.0)))


@dataclass(frozen=True)
class Halves:
    """Formula of a law by the equations at the head of this file, 0 < inflection < 1, 0 <= line < 1."""

    first: Shape
    second: Shape
    inflection: float = 0.5  # lambda
    line: float = 0.0  # w, share of the segment at constant speed
    v0: float = 0.0
    v1: float = 0.0

    @property
    def h1(self) -> float:
        """Width of the first half."""
        return (1 - self.line) * self.inflection

    @property
    def h2(self) -> float:
        """Width of the second half."""
        return (1 - self.line) * (1 - self.inflection)

    @cached_property
    def _sizes(self) -> tuple[float, float]:
        """A and B."""
        first = self.first
        second = self.second
        lever = first.mu * self.h1 + first.alpha * self.line
        change = self.v1 - self.v0
        rest = 1 - self.v0 * (self.h1 + self.line) - self.v1 * self.h2
        n = second.alpha * lever + first.alpha * second.mu * self.h2
        a = (second.alpha * rest + second.mu * self.h2 * change) / (n * self.h1)
        b = (first.alpha * rest - lever * change) / (n * self.h2)
        return a, b

    @property
    def acceleration(self) -> float:
        """A, the greatest of the first half; below 0 where it slows down."""
        return self._sizes[0]

    @property
    def deceleration(self) -> float:
        """B, the greatest of the second half; below 0 where it speeds up."""
        return self._sizes[1]

    @property
    def speed(self) -> float:
        """v_m, on the line or at the inflection."""
        return self.v0 + self.first.alpha * self.acceleration * self.h1

    def __call__(self, u: Floats, order: int) -> Floats:
        """Values of the derivative; at a break the later side counts."""
        u = np.asarray(u, float)
        turn = self.h1 + self.line
        result = np.empty(u.shape)
        first = u < self.h1
        second = u >= turn
        line = ~(first | second)
        result[first] = self._first(u[first], order)
        result[second] = self._second(1 - u[second], order)
        if self.line:
            covered = self.v0 * self.h1 + self.acceleration * self.h1**2 * self.first.mu
            straight = (covered + self.speed * (u[line] - self.h1), self.speed, 0.0, 0.0)
            result[line] = straight[order]
        return result

    def _first(self, x: Floats, order: int) -> Floats:
        """x: from the beginning."""
        h = self.h1
        value = self.acceleration * h ** (2 - order) * self.first(x / h, order)
        base = (self.v0 * x, self.v0, 0.0, 0.0)[order]
        return np.asarray(base + value)

    def _second(self, y: Floats, order: int) -> Floats:
        """y: back from the end."""
        h = self.h2
        value = self.deceleration * h ** (2 - order) * self.second(y / h, order)
        base = (1 - self.v1 * y, self.v1, 0.0, 0.0)[order]
        return np.asarray(base + (-value if order in (0, 2) else value))

    @property
    def _sides(self) -> list[list[tuple[float, float]]]:
        """Acceleration and jerk before and after each place between the parts, which are two with a line."""
        a, b = self._sizes
        before = (a * self.first.end(1, 2), a * self.first.end(1, 3) / self.h1)
        after = (-b * self.second.end(1, 2), b * self.second.end(1, 3) / self.h2)
        still = (0.0, 0.0)
        return [[before, still], [still, after]] if self.line else [[before, after]]

    @property
    def breaks(self) -> tuple[float, ...]:
        """Places inside where acceleration or jerk jumps: pieces of a shape join smoothly."""
        scales = (self.peaks[1], max(self._jerks))
        places = (self.h1, self.h1 + self.line)
        return tuple(
            place
            for place, (before, after) in zip(places, self._sides, strict=False)
            if any(
                abs(x - y) > _SAME * scale
                for x, y, scale in zip(before, after, scales, strict=True)
            )
        )

    @property
    def _jerks(self) -> tuple[float, float]:
        """Greatest jerk of either half."""
        a, b = self._sizes
        return abs(a) * self.first.steepest / self.h1, abs(b) * self.second.steepest / self.h2

    @property
    def peaks(self) -> tuple[float, float, float]:
        """Greatest speed, acceleration and jerk, in size; inf of the jerk where the acceleration jumps inside."""
        a, b = self._sizes
        speed = max(abs(self.v0), abs(self.v1), abs(self.speed))
        acceleration = max(abs(a), abs(b))
        jumps = any(abs(x[0] - y[0]) > _SAME * acceleration for x, y in self._sides)
        return speed, acceleration, math.inf if jumps else max(self._jerks)

    @property
    def ends(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Acceleration and jerk at both ends."""
        a, b = self._sizes
        return (
            (a * self.first.end(0, 2), a * self.first.end(0, 3) / self.h1),
            (-b * self.second.end(0, 2), b * self.second.end(0, 3) / self.h2),
        )


def inflection_for(halves: Halves, deceleration: float) -> float:
    """lambda at which the second half of these halves has its greatest deceleration B; nan where there is none in 0..1.

    B N h2 = alpha1 R - (mu1 h1 + alpha1 w) d is of second degree in lambda.
    """
    first = halves.first
    second = halves.second
    w = halves.line
    c = 1 - w
    change = halves.v1 - halves.v0
    n0 = second.alpha * first.alpha * w + first.alpha * second.mu * c
    n1 = c * (second.alpha * first.mu - first.alpha * second.mu)
    m0 = first.alpha * (1 - halves.v0 * w - halves.v1 * c) - first.alpha * w * change
    m1 = first.alpha * c * change - first.mu * c * change
    scaled = deceleration * c
    return _share(-scaled * n1, scaled * (n1 - n0) - m1, scaled * n0 - m0)


def _share(square: float, linear: float, constant: float) -> float:
    """The root of a polynomial of second degree between 0 and 1; nan where there is none."""
    if abs(square) <= 1e-12 * (abs(linear) + abs(constant)):
        found = [-constant / linear] if linear else []
    else:
        inside = linear**2 - 4 * square * constant
        if inside < 0:
            return math.nan
        far = -(linear + math.copysign(math.sqrt(inside), linear)) / 2
        found = [far / square, *([constant / far] if far else [])]
    return next((x for x in found if 0 < x < 1), math.nan)


def sine_line(a0: float, a1: float) -> tuple[float, float]:
    """lambda and share of the line of the sine-line combination with accelerations a0 > 0 and a1 < 0 at its ends.

    With q = a0 lambda and k = 1 - 2 / pi, c (1 - c k) = pi / (2 q): the moving share c. nan where it is not in 0..1.
    """
    if not a0 > 0 > a1:
        return math.nan, math.nan
    inflection = -a1 / (a0 - a1)
    k = 1 - 2 / math.pi
    inside = 1 - 2 * math.pi * k / (a0 * inflection)
    if inside < 0:
        return inflection, math.nan
    moving = (1 - math.sqrt(inside)) / (2 * k)
    return inflection, 1 - moving if moving <= 1 else math.nan
