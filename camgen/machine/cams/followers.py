"""What touches a disc cam: round tips and flat faces, each on an arm or on a slide.

    trace point   centre of a round tip (the point itself for a knife edge)
    pitch curve   path of the trace point as the cam sees it; it runs CLOCKWISE round the cam as theta grows
    envelope      what the tip or the face leaves of the cam, before loops are trimmed: the profile
    room          sense in which the envelope runs: below 0 it runs backwards, and a later pass cuts it away

The cam turns by theta, counter-clockwise, about the origin; `motion(theta, order)` is the follower's displacement s and
its derivatives of order 0..3, rad on an arm and mm on a slide. Points are complex numbers, mm; _cam: the cam's frame.

A round tip's envelope is the parallel curve of its pitch curve. A flat face is a line with normal exp(i phi) at distance
h from the origin, in the cam's frame; its envelope is z = (h + i dh/dphi) exp(i phi), with radius of curvature
h + d2h/dphi2.   [Norton, Cam Design and Manufacturing Handbook, ch. 7; formulas re-derived in complex form]
"""

from __future__ import annotations

import cmath
import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from camgen.numerics import Floats, Points

Motion = Callable[[Any, int], Floats]


class Follower(ABC):
    """The one protocol of all followers; leaves: +1 or -1, the sense of s that takes it off the cam."""

    if TYPE_CHECKING:

        @property
        def leaves(self) -> int:
            """A field of each follower, or found from its others."""

    @abstractmethod
    def envelope(self, theta: Any, motion: Motion, order: int) -> Points:
        """Untrimmed profile in the cam's frame, or its derivative to theta of order 0..2, (n,) complex."""

    @abstractmethod
    def grown(self, by: float) -> Self:
        """The same with its surface so much nearer to the cam, mm."""

    @abstractmethod
    def room(self, theta: Any, motion: Motion) -> Floats:
        """Positive where the envelope runs forwards, 0 at a cusp, (n,)."""

    @abstractmethod
    def radius(self, theta: Any, motion: Motion) -> Floats:
        """Radius of curvature of the profile, mm, (n,): positive where the cam is convex and the follower fits."""

    @abstractmethod
    def clear(self, theta: Any, motion: Motion) -> Floats:
        """Distance of the follower from the shaft's axis, mm, (n,); 0 or less: it reaches the axis."""

    @abstractmethod
    def normal(self, theta: Any, motion: Motion) -> Points:
        """Unit normal of the contact, away from the cam, (n,) complex, cam's frame."""

    @abstractmethod
    def normal_on(self, s: Any, point: Any) -> Points:
        """The same where the follower at s rests on a corner at `point`, (n,) complex, both in the ground."""

    @abstractmethod
    def velocity(self, s: Any, point: Any) -> Points:
        """Motion of the follower where it touches `point`, (n,) complex, mm per unit of s, both in the ground."""

    @abstractmethod
    def resting_on(self, point: Any) -> Floats:
        """Displacement s at which the follower, coming in, first touches a point of the ground, (n,); nan out of reach."""

    @abstractmethod
    def on_base(self, radius: float) -> Self:
        """The same moved along its way until it touches a circle about the axis at s = 0; radius: mm.

        ValueError where it reaches no such circle.
        """

    @abstractmethod
    def ahead_of(self, other: Self) -> float:
        """Displacement from another one on the same way to this one, each at s = 0, mm or rad."""

    def pressure_angle(self, s: Any, point: Any, normal: Any) -> Floats:
        """Angle between the contact's normal and the follower's motion where it touches `point`, rad, (n,), 0 or more.

        point, normal: (n,) complex in the ground, the normal away from the cam. [Norton, ch. 7]
        """
        return np.asarray(np.abs(np.angle(self.leaves * self.velocity(s, point) * np.conj(normal))))


class OnSlide(Follower):
    """Of any form, at start + along * s, along a unit vector of the ground, s in mm."""

    start: complex
    along: complex

    def velocity(self, s: Any, point: Any = 0) -> Points:
        """The slide's direction."""
        return np.full(np.shape(s), self.along)

    def ahead_of(self, other: Self) -> float:
        """Along the slide."""
        return ((self.start - other.start) * self.along.conjugate()).real


# ---- round tips ------------------------------------------------------------------------------------------------------


class RoundTip(Follower):
    """A tip of radius tip_radius (0: a knife edge) about a trace point."""

    tip_radius: float

    @abstractmethod
    def trace(self, s: Any) -> Points:
        """Trace point in the ground, (n,) complex."""

    @abstractmethod
    def pitches(self, theta: Any, motion: Motion, order: int) -> list[Points]:
        """Trace point in the cam's frame and its derivatives to theta up to an order 0..3, each (n,) complex."""

    def pitch(self, theta: Any, motion: Motion, order: int) -> Points:
        """The one of that order."""
        return self.pitches(theta, motion, order)[order]

    def envelope(self, theta: Any, motion: Motion, order: int) -> Points:
        """Parallel curve at the tip's radius to the right of the pitch curve; the right is the cam's inside."""
        rho = self.tip_radius
        if not np.any(rho):
            return self.pitch(theta, motion, order)
        d0, d1, *more = self.pitches(theta, motion, order + 1)
        speed = np.abs(d1)
        if order == 0:
            return np.asarray(d0 - 1j * rho * d1 / speed)
        d2 = more[0]
        cross = np.imag(np.conj(d1) * d2)
        cube = speed * speed * speed  # numpy's power of 3 takes ten times as long
        room = 1 + rho * cross / cube
        if order == 1:
            return np.asarray(d1 * room)
        d3 = more[1]
        dot = np.real(np.conj(d1) * d2)
        room_slope = rho * (
            np.imag(np.conj(d1) * d3) / cube - 3 * cross * dot / (cube * speed * speed)
        )
        return np.asarray(d2 * room + d1 * room_slope)

    def grown(self, by: float) -> Self:
        """Its radius is larger."""
        return replace(self, tip_radius=self.tip_radius + by)  # type: ignore[type-var]

    def pitch_curvature(self, theta: Any, motion: Motion) -> Floats:
        """Curvature of the pitch curve, 1/mm, (n,), positive where the cam is convex."""
        _, d1, d2 = self.pitches(theta, motion, 2)
        speed = np.abs(d1)
        return np.asarray(-np.imag(np.conj(d1) * d2) / (speed * speed * speed))

    def room(self, theta: Any, motion: Motion) -> Floats:
        """1 - tip_radius * curvature of the pitch curve."""
        return np.asarray(1 - self.tip_radius * self.pitch_curvature(theta, motion))

    def radius(self, theta: Any, motion: Motion) -> Floats:
        """Radius of curvature of the pitch curve less the tip's."""
        with np.errstate(divide="ignore"):
            return np.asarray(1 / self.pitch_curvature(theta, motion) - self.tip_radius)

    def clear(self, theta: Any, motion: Motion) -> Floats:
        """Distance of the trace point less the tip's radius."""
        return np.asarray(np.abs(self.pitch(theta, motion, 0)) - self.tip_radius)

    def normal(self, theta: Any, motion: Motion) -> Points:
        """Square to the pitch curve."""
        d1 = self.pitch(theta, motion, 1)
        return np.asarray(1j * d1 / np.abs(d1))

    def normal_on(self, s: Any, point: Any) -> Points:
        """From the corner to the trace point."""
        spoke = self.trace(s) - point
        return np.asarray(spoke / np.abs(spoke))


@dataclass(frozen=True)
class SwingingArm(RoundTip):
    """Round tip on an arm: trace point = pivot + arm * exp(i s), s in rad."""

    pivot: complex
    arm: complex
    tip_radius: float
    leaves: int

    def trace(self, s: Any) -> Points:
        """Trace point in the ground, (n,) complex."""
        return self.pivot + self.arm * np.exp(1j * np.asarray(s))

    def pitches(self, theta: Any, motion: Motion, order: int) -> list[Points]:
        """Trace point in the cam's frame and its derivatives to theta up to an order 0..3, each (n,) complex."""
        theta = np.asarray(theta, float)
        centre = self.pivot * np.exp(-1j * theta)
        s = [motion(theta, k) for k in range(order + 1)]
        arm = self.arm * np.exp(1j * (s[0] - theta))
        rows = [centre + arm]
        if order > 0:
            q1 = s[1] - 1
            rows.append(-1j * centre + 1j * q1 * arm)
        if order > 1:
            rows.append(-centre + (1j * s[2] - q1**2) * arm)
        if order > 2:
            rows.append(1j * centre + (1j * s[3] - 3 * q1 * s[2] - 1j * q1**3) * arm)
        return rows

    def velocity(self, s: Any, point: Any = 0) -> Points:
        """Motion of the trace point, length |arm|."""
        return np.asarray(1j * self.arm * np.exp(1j * np.asarray(s)))

    def resting_on(self, point: Any) -> Floats:
        """Angle at which the tip touches a point of the ground, (n,) rad; nan out of reach.

        Of the two such angles the one from which the tip leaves the point with s going in the sense `leaves`.
        """
        spoke = (np.asarray(point) - self.pivot) / self.arm
        distance = np.abs(spoke)
        reach = self.tip_radius / abs(self.arm)
        # half-angle form of the law of cosines: exact where the triangle is flat
        near = reach**2 - (1 - distance) ** 2
        far = (1 + distance) ** 2 - reach**2
        with np.errstate(invalid="ignore"):
            opening = 2 * np.arctan2(np.sqrt(near), np.sqrt(far))
        return np.asarray(np.angle(spoke) + self.leaves * opening)

    def on_base(self, radius: float) -> Self:
        """By the triangle of axis, pivot and trace point, on the side from which s goes off."""
        far = abs(self.pivot)
        arm = abs(self.arm)
        cosine = (far**2 + arm**2 - (radius + self.tip_radius) ** 2) / (2 * far * arm)
        if not abs(cosine) < 1:
            raise ValueError("pivot, arm and pitch circle make no triangle")
        turn = cmath.rect(arm, self.leaves * math.acos(cosine))
        return replace(self, arm=-self.pivot / far * turn)

    def ahead_of(self, other: Self) -> float:
        """Angle between both arms."""
        return cmath.phase(self.arm / other.arm)


@dataclass(frozen=True)
class SlidingTip(OnSlide, RoundTip):
    """Round tip on a slide: trace point = start + along * s, s in mm, along a unit vector of the ground."""

    start: complex
    along: complex
    tip_radius: float
    leaves: int = 1

    def trace(self, s: Any) -> Points:
        """Trace point in the ground, (n,) complex."""
        return self.start + self.along * np.asarray(s)

    def pitches(self, theta: Any, motion: Motion, order: int) -> list[Points]:
        """Trace point in the cam's frame and its derivatives to theta up to an order 0..3, each (n,) complex."""
        theta = np.asarray(theta, float)
        turn = np.exp(-1j * theta)
        place = [
            self.trace(motion(theta, 0)),
            *(self.along * motion(theta, k) for k in range(1, order + 1)),
        ]
        rows = [place[0]]
        while (
            len(rows) <= order
        ):  # each pass is a derivative of place * exp(-i theta), and of what follows from it
            place = [further - 1j * value for value, further in pairwise(place)]
            rows.append(place[0])
        return [np.asarray(each * turn) for each in rows]

    def resting_on(self, point: Any) -> Floats:
        """Displacement at which the tip touches a point of the ground, (n,) mm; nan out of reach."""
        spoke = (np.asarray(point) - self.start) * self.along.conjugate()
        with np.errstate(invalid="ignore"):
            opening = np.sqrt((self.tip_radius - spoke.imag) * (self.tip_radius + spoke.imag))
        return np.asarray(spoke.real + self.leaves * opening)

    def on_base(self, radius: float) -> Self:
        """As far beside the axis as before."""
        beside = (self.start * self.along.conjugate()).imag
        room = (radius + self.tip_radius) ** 2 - beside**2
        if room <= 0:
            raise ValueError("the slide passes beside the pitch circle")
        return replace(self, start=(self.leaves * math.sqrt(room) + 1j * beside) * self.along)


# ---- flat faces ------------------------------------------------------------------------------------------------------


class FlatFace(Follower):
    """A straight face; its normal points away from the cam."""

    @abstractmethod
    def line(self, theta: Any, motion: Motion, order: int) -> tuple[Points, Floats, Floats]:
        """Face in the cam's frame: unit normal exp(i phi), (n,); h and phi with derivatives to theta, (order + 1, n)."""

    @abstractmethod
    def at_rest(self, s: Any) -> tuple[Points, Points]:
        """A point of the face from which places on it count, and its unit normal, in the ground, (n,) complex."""

    def _slopes(
        self, theta: Any, motion: Motion, order: int
    ) -> tuple[Points, list[Floats], Floats]:
        """Normal; h, dh/dphi = g and the derivatives of g to theta up to `order`; h in front; derivatives of phi."""
        normal, h, phi = self.line(theta, motion, order + 1)
        q = phi[1]
        with np.errstate(divide="ignore", invalid="ignore"):
            slopes = [h[0], h[1] / q]
            if order > 0:
                slopes.append((h[2] - slopes[1] * phi[2]) / q)
            if order > 1:
                slopes.append((h[3] - 2 * slopes[2] * phi[2] - slopes[1] * phi[3]) / q)
        return normal, slopes, np.asarray([h[1], q, phi[2] if order else q])

    def envelope(self, theta: Any, motion: Motion, order: int) -> Points:
        """Envelope of the face: (h + i g) exp(i phi), and i (q h + g') exp(i phi) along it, q = dphi/dtheta."""
        normal, (h, g, *more), (h1, q, q1) = self._slopes(theta, motion, order)
        if order == 0:
            return np.asarray((h + 1j * g) * normal)
        speed = q * h + more[0]
        if order == 1:
            return np.asarray(1j * speed * normal)
        return np.asarray(1j * (q1 * h + q * h1 + more[1] + 1j * q * speed) * normal)

    def room(self, theta: Any, motion: Motion) -> Floats:
        """Speed with which the contact runs round the cam, mm/rad, clockwise positive."""
        _, (h, _, g1), (_, q, _) = self._slopes(theta, motion, 1)
        return np.asarray(-(q * h + g1))

    def radius(self, theta: Any, motion: Motion) -> Floats:
        """Radius of curvature, h + d2h/dphi2; 0 or less: undercut."""
        _, (h, _, g1), (_, q, _) = self._slopes(theta, motion, 1)
        return np.asarray(h + g1 / q)

    def clear(self, theta: Any, motion: Motion) -> Floats:
        """Distance of the face's line, on the far side of the axis negative."""
        return np.asarray(self.line(theta, motion, 0)[1][0])

    def normal(self, theta: Any, motion: Motion) -> Points:
        """The face's own."""
        return self.line(theta, motion, 0)[0]

    def normal_on(self, s: Any, point: Any) -> Points:
        """The face's own."""
        return self.at_rest(s)[1]

    def place(self, s: Any, point: Any) -> Floats:
        """Where on the face a point of the ground touches it, mm, (n,), positive to the left of the normal."""
        datum, normal = self.at_rest(s)
        return np.asarray(np.imag(np.conj(normal) * (point - datum)))


@dataclass(frozen=True)
class SlidingFace(OnSlide, FlatFace):
    """Face through start + along * s (the stem's axis), s in mm, square to its slide but for `lean`, by which its normal is turned
    from there, rad; leaves -1: on the other side."""

    start: complex
    along: complex
    leaves: int = 1
    lean: float = 0.0

    @property
    def ahead(self) -> complex:
        """Its normal."""
        return self.leaves * self.along * (cmath.rect(1, self.lean) if np.any(self.lean) else 1)

    def grown(self, by: float) -> Self:
        """It stands lower on its slide."""
        return replace(self, start=self.start - by * self.ahead)

    def line(self, theta: Any, motion: Motion, order: int) -> tuple[Points, Floats, Floats]:
        """h = start along the normal + s; phi turns back with theta."""
        theta = np.asarray(theta, float)
        ahead = self.ahead
        share = (ahead.conjugate() * self.along).real
        h = share * np.array([motion(theta, k) for k in range(order + 1)])
        h[0] += (ahead.conjugate() * self.start).real
        phi = np.zeros_like(h)
        phi[0] = np.angle(ahead) - theta
        if order:
            phi[1] = -1
        return ahead * np.exp(-1j * theta), h, phi

    def at_rest(self, s: Any) -> tuple[Points, Points]:
        """The stem's axis on the face."""
        place = self.start + self.along * np.asarray(s)
        return place, np.full(place.shape, self.ahead)

    def resting_on(self, point: Any) -> Floats:
        """Displacement at which the face touches a point of the ground, (n,) mm."""
        across = self.ahead.conjugate()
        return np.asarray(
            np.real((np.asarray(point) - self.start) * across) / (self.along * across).real
        )

    def on_base(self, radius: float) -> Self:
        """Its stem as far beside the axis as before."""
        beside = (self.start * self.along.conjugate()).imag
        high = (self.leaves * radius - beside * math.sin(self.lean)) / math.cos(self.lean)
        return replace(self, start=(high + 1j * beside) * self.along)


@dataclass(frozen=True)
class SwingingFace(FlatFace):
    """Face on an arm: at s = 0 its normal is `facing` (unit) and it lies `ahead` mm from the pivot along that; s in rad."""

    pivot: complex
    facing: complex
    ahead: float

    def grown(self, by: float) -> Self:
        """It lies less far ahead."""
        return replace(self, ahead=self.ahead - by)

    @property
    def leaves(self) -> int:
        """The sense of s in which the face goes off the axis at s = 0."""
        return 1 if np.all((self.facing.conjugate() * self.pivot).imag > 0) else -1

    def line(self, theta: Any, motion: Motion, order: int) -> tuple[Points, Floats, Floats]:
        """h = the pivot along the normal + ahead; phi = s - theta."""
        theta = np.asarray(theta, float)
        s = [motion(theta, k) for k in range(order + 1)]
        turn = self.facing * np.exp(1j * s[0])
        lever = np.conj(turn) * self.pivot
        p = lever.real
        p1 = lever.imag
        h = [p + self.ahead]  # derivatives of h - ahead = p to s: p1, -p, -p1
        phi = [np.angle(self.facing) + s[0] - theta]
        if order > 0:
            h.append(p1 * s[1])
            phi.append(s[1] - 1)
        if order > 1:
            h.append(p1 * s[2] - p * s[1] ** 2)
            phi.append(s[2])
        if order > 2:
            h.append(p1 * s[3] - 3 * p * s[1] * s[2] - p1 * s[1] ** 3)
            phi.append(s[3])
        return np.asarray(turn * np.exp(-1j * theta)), np.array(h), np.array(phi)

    def at_rest(self, s: Any) -> tuple[Points, Points]:
        """The foot of the pivot on the face."""
        turn = self.facing * np.exp(1j * np.asarray(s))
        return self.pivot + self.ahead * turn, turn

    def velocity(self, s: Any, point: Any) -> Points:
        """That of the face's own point there."""
        return np.asarray(1j * (point - self.pivot))

    def resting_on(self, point: Any) -> Floats:
        """Angle at which the face touches a point of the ground, (n,) rad; nan nearer to the pivot than `ahead`."""
        spoke = (np.asarray(point) - self.pivot) / self.facing
        with np.errstate(invalid="ignore", divide="ignore"):
            opening = np.arccos(self.ahead / np.abs(spoke))
        # of both tangents the one on which the point lies on the cam's side of the foot
        return np.asarray(np.angle(spoke * np.exp(1j * self.leaves * opening)))

    def on_base(self, radius: float) -> Self:
        """The tangent of the circle on the side from which s goes off."""
        far = abs(self.pivot)
        cosine = (radius - self.ahead) / far
        if not abs(cosine) < 1:
            raise ValueError("the face touches no such circle from its pivot")
        turn = cmath.rect(1, -self.leaves * math.acos(cosine))
        return replace(self, facing=self.pivot / far * turn)

    def ahead_of(self, other: Self) -> float:
        """Angle between both normals."""
        return cmath.phase(self.facing / other.facing)
