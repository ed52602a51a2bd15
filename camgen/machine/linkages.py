"""Planar linkages: a crank, dyads on it and points carried along, with exact derivatives.

    step      how one named point follows from earlier ones: Fixed, Crank, RRR, RRP, RPR, On
    linkage   steps in order; four-bar: O, C fixed, A on a crank, B by RRR; slider-crank: B by RRP
    jet       a point with its derivatives to theta, (order + 1, n) complex, mm, mm/rad, mm/rad^2; order 0..2
    branch    +1 or -1: which of a dyad's two assemblies
    gap       by how much a dyad fails to close, mm; negative is to spare

Where a dyad does not close, its point is nan, and so is all that hangs on it. Where it only just closes (stretched or
folded), the position exists and the derivatives do not: they are nan.
"""

from __future__ import annotations

import math
import os
import threading
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from camgen.tolerances import SAME_POINT

Floats = NDArray[np.float64]
Points = NDArray[np.complex128]
Jet = Points
At = Mapping[str, Jet]

# Angles solved at a time: long enough to hide the cost of a call, short enough to stay in the cache.
BLOCK = 32768
# Complex rows of a block that a step may overwrite.
SCRATCH = 6
# From here on a second thread pays for its start.
THREADED = 100_000
_rooms = threading.local()
# A dyad that misses by less than this share of its size is taken as just closing: rounding of theta does as much.
JUST_CLOSES = 1e-14


@dataclass(frozen=True)
class Fixed:
    """A point of the ground."""

    place: complex

    def solve(self, at: At, turn: Points, out: Jet, scratch: Points) -> None:
        """Write the point's jet to out."""
        out[0] = self.place
        out[1:] = 0


@dataclass(frozen=True)
class Crank:
    """The pin of the driven link: pivot (a Fixed point) + arm * exp(i theta), the arm being the one at theta = 0."""

    pivot: str
    arm: complex

    def solve(self, at: At, turn: Points, out: Jet, scratch: Points) -> None:
        """Write the pin's jet to out."""
        np.multiply(turn, self.arm, out=out[0])
        for k in range(1, len(out)):
            np.multiply(out[k - 1], 1j, out=out[k])
        if at[self.pivot][0, 0] != 0:
            out[0] += at[self.pivot][0]


@dataclass(frozen=True)
class RRR:
    """The joint of two links: ra long from a, rb long from b; branch +1 has it to the left of the way from a to b."""

    a: str
    b: str
    ra: float
    rb: float
    branch: int = 1

    def solve(self, at: At, turn: Points, out: Jet, scratch: Points) -> None:
        """Write the joint's jet to out."""
        a, b, ra, rb, branch = at[self.a], at[self.b], self.ra, self.rb, self.branch
        if b.shape[1] == 1:  # from a fixed point half of the sums below vanish
            a, b, ra, rb, branch = b, a, rb, ra, -branch
        a_moves = a.shape[1] > 1
        total, differ = (ra + rb) ** 2, (ra - rb) ** 2
        d, u, z, w = scratch[:4]
        q, root, half, r = scratch[4:6].view(float).reshape(4, -1)
        np.subtract(b[0], a[0], out=d)
        np.multiply(d.real, d.real, out=q)
        np.multiply(d.imag, d.imag, out=r)
        q += r
        # Heron's formula in factors, which lose nothing to cancellation: the root is four times the area a, b, joint.
        np.subtract(total, q, out=root)
        np.subtract(q, differ, out=r)
        root *= r
        divisor = _signed_root(root, (total * JUST_CLOSES) * total, branch)
        np.divide(0.5, q, out=half)
        np.multiply(root, half, out=u.imag)
        half *= ra**2 - rb**2
        np.add(half, 0.5, out=u.real)
        u *= d
        np.add(a[0], u, out=out[0])
        if len(out) == 1:
            return
        # The links u from a and v from b turn at rates w2 and w3, and both carry the joint alike; dot products with v
        # and u part the two. u x v is half the root, u . v = (ra^2 + rb^2 - q) / 2.
        swing = np.divide(2.0, divisor, out=half)
        v_bar = np.conj(np.subtract(u, d, out=d), out=d)
        d1 = np.subtract(b[1], a[1], out=out[1]) if a_moves else b[1]
        np.multiply(v_bar, d1, out=z)
        w.real = 0
        np.multiply(z.real, swing, out=w.imag)
        if len(out) > 2:
            np.multiply(np.conj(u, out=z), d1, out=z)
            np.multiply(z.real, swing, out=r)
        np.multiply(w, u, out=out[1])
        if a_moves:
            out[1] += a[1]
        if len(out) == 2:
            return
        np.square(w, out=w)
        r *= r
        r *= rb**2
        np.subtract(ra**2 + rb**2, q, out=q)
        q *= 0.5
        q *= w.real
        r += q
        d2 = np.subtract(b[2], a[2], out=z) if a_moves else b[2]
        np.multiply(v_bar, d2, out=z)
        np.subtract(z.real, r, out=r)
        np.multiply(r, swing, out=w.imag)
        np.multiply(w, u, out=out[2])
        if a_moves:
            out[2] += a[2]

    def gap(self, at: At) -> Floats:
        """By how much the links are too short or too long for each other, mm, with its derivatives."""
        d = distance(at[self.a], at[self.b])
        total, differ = self.ra + self.rb, abs(self.ra - self.rb)
        far = d[0] > max(self.ra, self.rb)
        rows = np.where(far, d, -d)
        rows[0] += np.where(far, -total, differ)
        return rows


@dataclass(frozen=True)
class RRP:
    """The pin of a slider, `rod` from a, on the line through `through` at `angle` rad; branch +1 has it ahead of a."""

    a: str
    rod: float
    through: complex
    angle: float
    branch: int = 1

    def solve(self, at: At, turn: Points, out: Jet, scratch: Points) -> None:
        """Write the pin's jet to out."""
        a = at[self.a]
        along = complex(np.exp(1j * self.angle))
        x = a * along.conjugate()
        x[0] -= self.through * along.conjugate()
        y = x.imag
        root = (self.rod - y[0]) * (self.rod + y[0])
        divisor = _signed_root(root, JUST_CLOSES * self.rod**2, self.branch)
        s = x.real.copy()
        s[0] += root
        if len(out) > 1:
            slope = -y[0] * y[1] / divisor
            s[1] += slope
        if len(out) > 2:
            s[2] -= (y[1] * y[1] + y[0] * y[2] + slope * slope) / divisor
        np.multiply(s, along, out=out)
        out[0] += self.through

    def gap(self, at: At) -> Floats:
        """By how much the rod is too short to reach the guide, mm, with its derivatives."""
        along = complex(np.exp(1j * self.angle))
        x = at[self.a] * along.conjugate()
        x[0] -= self.through * along.conjugate()
        rows: Floats = np.sign(x.imag[0]) * x.imag
        rows[0] -= self.rod
        return rows


@dataclass(frozen=True)
class RPR:
    """A point on a link that turns about b and whose straight guide the pin a slides along.

    The guide passes b at `offset` mm to its left; branch +1 has a ahead of b, -1 behind. The point is at `arm` (complex
    mm) in the link's axes: origin b, x along the guide. Its turn alone is the point with arm 1 less b.
    """

    a: str
    b: str
    arm: complex
    offset: float = 0.0
    branch: int = 1

    def solve(self, at: At, turn: Points, out: Jet, scratch: Points) -> None:
        """Write the point's jet to out."""
        a, b = at[self.a], at[self.b]
        d = a[0] - b[0]
        far, e = np.abs(d), self.offset
        s = (far - e) * (far + e)
        divisor = _signed_root(s, JUST_CLOSES * e**2, self.branch)
        u = d * (s - 1j * e) / (far * far)
        r = u * self.arm
        out[0] = b[0] + r
        if len(out) > 1:
            m = np.conj(u) * (a[1] - b[1])
            w = m.imag / divisor
            out[1] = b[1] + 1j * w * r
        if len(out) > 2:
            m2 = np.conj(u) * (a[2] - b[2])
            out[2] = b[2] + (1j * (m2.imag - 2 * w * (m.real + w * e) + w * w * e) / divisor - w * w) * r

    def gap(self, at: At) -> Floats:
        """By how much the pin is too near to b for the guide, mm, with its derivatives."""
        rows = -distance(at[self.a], at[self.b])
        rows[0] += abs(self.offset)
        return rows


@dataclass(frozen=True)
class On:
    """A point carried by the link a-b: a + share * (b - a), the share complex (0 is a, 1 is b, 1j to the left of a)."""

    a: str
    b: str
    share: complex

    def solve(self, at: At, turn: Points, out: Jet, scratch: Points) -> None:
        """Write the point's jet to out."""
        np.subtract(at[self.b], at[self.a], out=out)
        out *= self.share
        out += at[self.a]


Step = Fixed | Crank | RRR | RRP | RPR | On


@dataclass(frozen=True)
class Linkage:
    """Named points, each step using points named before it."""

    points: Mapping[str, Step]

    def solve(
        self, theta: ArrayLike, order: int = 0, names: tuple[str, ...] | None = None, out: dict[str, Jet] | None = None
    ) -> dict[str, Jet]:
        """Jets of the points named (all), (order + 1, n) complex, at theta, (n,) rad; nan where not assembled.

        out: what an earlier call for as many angles has returned, written over: memory fresh from the system is slow.
        """
        if order not in (0, 1, 2):
            raise ValueError(f"order is 0, 1 or 2, not {order}")
        angles = np.ravel(np.asarray(theta, float))
        shape = (order + 1, angles.size)
        jets = {name: np.empty(shape, complex) for name in names or self.points} if out is None else out
        if any(jet.shape != shape or jet.dtype != complex for jet in jets.values()):
            raise ValueError(f"out holds jets of another shape than {shape}, complex")
        lanes = min(2, os.cpu_count() or 1) if angles.size >= THREADED else 1
        cuts = [angles.size * k // lanes for k in range(lanes + 1)]
        if lanes == 1:
            self._solve(angles, order, jets, *cuts)
        else:
            with ThreadPoolExecutor(lanes) as pool:
                list(pool.map(lambda k: self._solve(angles, order, jets, cuts[k], cuts[k + 1]), range(lanes)))
        return jets

    def _solve(self, theta: Floats, order: int, jets: dict[str, Jet], start: int, stop: int) -> None:
        """Solve the angles from start to stop into jets, block by block."""
        spare = [name for name in self.points if name not in jets]
        room = _room(1 + SCRATCH + len(spare) * (order + 1))
        grounded = [name for name, step in self.points.items() if isinstance(step, Fixed)]
        fixed = {name: np.zeros((order + 1, 1), complex) for name in grounded}
        with np.errstate(all="ignore"):
            for i in range(start, stop, BLOCK):
                block = slice(i, min(i + BLOCK, stop))
                rows = room[:, : block.stop - i]
                turn, scratch, rest = unit_turn(theta[block], out=rows[0]), rows[1 : 1 + SCRATCH], rows[1 + SCRATCH :]
                at = {name: rest[k * (order + 1) : (k + 1) * (order + 1)] for k, name in enumerate(spare)}
                at |= {name: jet[:, block] for name, jet in jets.items()} | fixed
                for name, step in self.points.items():
                    step.solve(at, turn, at[name], scratch)
                for name in fixed.keys() & jets.keys():
                    jets[name][:, block] = fixed[name]

    def point(self, name: str) -> Callable[[ArrayLike, int], Points]:
        """The named point as a callable of (theta, order): the order-th derivative, shaped like theta."""

        def curve(theta: ArrayLike, order: int = 0) -> Points:
            derivative: Points = self.solve(theta, order, (name,))[name][order]
            return derivative.reshape(np.shape(theta))

        return curve

    def gaps(self, theta: ArrayLike, order: int = 0) -> dict[str, Floats]:
        """Gap of each dyad by the name of its point, (order + 1, n) mm: over 0 where it does not close."""
        at = self.solve(theta, order)
        return {name: step.gap(at) for name, step in self.points.items() if isinstance(step, RRR | RRP | RPR)}


def unit_turn(theta: Floats, out: Points | None = None) -> Points:
    """exp(i theta), (n,): by the half-angle, whose tangent costs a fraction of sine and cosine."""
    turn = np.empty(theta.shape, complex) if out is None else out
    t = 0.5 * theta
    np.tan(t, out=t)
    h = t * t
    h += 1.0
    np.divide(2.0, h, out=h)
    np.subtract(h, 1.0, out=turn.real)
    np.multiply(t, h, out=turn.imag)
    return turn


def _room(rows: int) -> Points:
    """Rows of BLOCK complex numbers to overwrite, kept by each thread: memory fresh from the system is slow."""
    room: Points | None = getattr(_rooms, "room", None)
    if room is None or room.shape[0] < rows or room.shape[1] != BLOCK:
        room = _rooms.room = np.empty((rows, BLOCK), complex)
    return room


def _signed_root(square: Floats, slack: float, branch: int) -> Floats:
    """Turn a square into its signed root in place: nan where negative, 0 where by less than the slack.

    Returns the same to divide by, nan for 0.
    """
    closes = square.min(initial=np.inf) > 0
    if not closes:
        square[(square < 0) & (square >= -slack)] = 0
    np.sqrt(square, out=square)
    if branch < 0:
        np.negative(square, out=square)
    return square if closes else np.where(square == 0, np.nan, square)


def distance(a: Jet, b: Jet) -> Floats:
    """Distance of two points with its derivatives, (order + 1, n) mm; derivatives nan where the points meet."""
    with np.errstate(all="ignore"):
        d = b - a
        rows = np.empty(d.shape)
        rows[0] = np.hypot(d[0].real, d[0].imag)
        if len(d) > 1:
            toward = np.conj(d[0] / rows[0])
            rows[1:] = (toward * d[1:]).real
        if len(d) > 2:
            rows[2] += (toward * d[1]).imag ** 2 / rows[0]
    return rows


def direction(a: Jet, b: Jet) -> Floats:
    """Angle of the way from a to b with its derivatives, (order + 1, n) rad; nan where the points meet.

    The angle lies in (-pi, pi]; np.unwrap makes it continuous over a sorted turn.
    """
    with np.errstate(all="ignore"):
        d = b - a
        rows = np.empty(d.shape)
        rows[0] = np.where(d[0] == 0, np.nan, np.angle(d[0]))
        if len(d) > 1:
            rate = d[1] / d[0]
            rows[1] = rate.imag
        if len(d) > 2:
            rows[2] = (d[2] / d[0] - rate * rate).imag
    return rows


def slider_travel(theta: ArrayLike, crank: float, rod: float, offset: float = 0.0) -> Floats:
    """Way of a slider from its place at theta = 0 towards the crank's pivot, mm; nan where the rod does not reach.

    Guide parallel to the x axis at y = offset. Free of cancellation for a crank however short: no difference of rods is
    taken. In line it is the travel from the outermost point.
    """
    turn = unit_turn(np.atleast_1d(np.asarray(theta, float)))
    half = unit_turn(np.atleast_1d(np.asarray(theta, float)) / 2).imag
    y = crank * turn.imag
    with np.errstate(invalid="ignore"):
        roots = np.sqrt((rod - offset) * (rod + offset)) + np.sqrt((rod - y + offset) * (rod + y - offset))
        way: Floats = 2 * crank * half**2 + y * (y - 2 * offset) / roots
    return way.reshape(np.shape(theta))


@dataclass(frozen=True)
class FourBar:
    """A four-bar's class by Grashof: kind and margin, mm (the two middle lengths less the shortest and the longest).

    Some link turns fully where the margin is over 0; at 0 all fold into one line and the branch is lost (change point).
    full_turn: the crank passes every angle. slack: what is to spare at the tighter of its two critical places, mm
    (under 0: the gap). open_deg: crank angles, 0 to 180 and mirrored, over which the chain does not close.
    """

    kind: str
    margin: float
    full_turn: bool
    slack: float
    open_deg: tuple[tuple[float, float], ...]


def four_bar(frame: float, crank: float, coupler: float, output: float) -> FourBar:
    """Which four-bar these lengths make, mm; kinds are named by the crank, then the output.   [Grashof 1883]"""
    lengths = sorted((frame, crank, coupler, output))
    margin = lengths[1] + lengths[2] - lengths[0] - lengths[3]
    # The distance of the coupler's and the output's far ends runs from |frame - crank| to frame + crank.
    near, far = abs(frame - crank), frame + crank
    least, most = abs(coupler - output), coupler + output
    slack = min(most - far, near - least)
    spans = []
    if slack < 0:
        turn = [
            0.0 if side <= near else 180.0 if side >= far else math.degrees(_corner(frame, crank, side)) for side in (least, most)
        ]
        spans = [span for span in ((0.0, turn[0]), (turn[1], 180.0)) if span[1] > span[0]]
    if sum(lengths[:3]) < lengths[3]:
        kind = "none"
    elif abs(margin) <= SAME_POINT:
        kind = "change-point"
    elif margin < 0:
        kind = "triple-rocker"
    else:
        kinds = {frame: "double-crank", crank: "crank-rocker", output: "rocker-crank", coupler: "double-rocker"}
        kind = kinds[lengths[0]]
    return FourBar(kind, margin, slack >= 0, slack, tuple(spans))


def transmission_extremes(frame: float, crank: float, coupler: float, output: float) -> tuple[float, float]:
    """Angle between coupler and output at theta = 0 and pi, its extremes over a full turn, rad; nan where open."""
    return _corner(coupler, output, abs(frame - crank)), _corner(coupler, output, frame + crank)


def _corner(a: float, b: float, c: float) -> float:
    """Angle between sides a and b of the triangle whose third side is c, rad; nan where there is none."""
    stretch, fold = (a + b - c) * (a + b + c), (c - a + b) * (c + a - b)
    return 2 * math.atan2(math.sqrt(fold), math.sqrt(stretch)) if stretch >= 0 and fold >= 0 else math.nan
