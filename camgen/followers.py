"""Cam followers: from the wanted motion to pitch curve, profile, pressure angle and undercut, all in closed form.

    trace point     centre of the tip (or roller); the point itself for a knife edge
    pitch curve     path of the trace point as the cam sees it
    profile         envelope of the tip: the parallel curve of the pitch curve at the tip radius, inwards
    pressure angle  between the contact normal and the trace point's velocity
    undercut        profile that a later pass of the tip cuts away again

                         A pivot                    ground: the cam turns by theta, counter-clockwise, about O
                        /                           cam:    ground turned back by theta
            tip  ( C )-'    arm A-C
               (cam)
                 O                                  the pitch curve runs CLOCKWISE round the cam as theta grows

Points are complex numbers, mm; a name ending in _cam is in the cam's frame.
[Norton, Cam Design and Manufacturing Handbook, ch. 7; formulas re-derived for a swinging arm in complex form]
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import pairwise
from typing import Any

import numpy as np

from camgen.errors import DesignError
from camgen.motion import Floats
from camgen.outlines import Arc, Contour, Piece, Points, Smooth, end_point, start_point
from camgen.program import Program, Segment
from camgen.tolerances import SAME_POINT
from camgen.trimming import trim


@dataclass(frozen=True)
class SwingingArm:
    """Follower on an arm: trace point = pivot + arm * exp(i s), s in rad; leaves: sense of s that takes the tip off the cam."""

    pivot: complex
    arm: complex
    tip_radius: float
    leaves: int

    def trace(self, s: Any) -> Points:
        """Trace point in the ground, (n,) complex."""
        return self.pivot + self.arm * np.exp(1j * np.asarray(s))

    def pitch(self, theta: Any, motion: Callable[[Any, int], Floats], order: int) -> Points:
        """Trace point in the cam's frame at cam angle theta, or its derivative to theta of order 0..3, (n,) complex.

        motion(theta, order): the follower's angle s and its derivatives.
        """
        theta = np.asarray(theta, float)
        centre = (-1j) ** order * self.pivot * np.exp(-1j * theta)
        arm = self.arm * np.exp(1j * (motion(theta, 0) - theta))
        if order == 0:
            return np.asarray(centre + arm)
        q1 = motion(theta, 1) - 1
        if order == 1:
            return np.asarray(centre + 1j * q1 * arm)
        q2 = motion(theta, 2)
        if order == 2:
            return np.asarray(centre + (1j * q2 - q1**2) * arm)
        return np.asarray(centre + (1j * motion(theta, 3) - 3 * q1 * q2 - 1j * q1**3) * arm)

    def velocity(self, s: Any) -> Points:
        """Direction in which the trace point moves in the ground as s grows, (n,) complex, length |arm|."""
        return np.asarray(1j * self.arm * np.exp(1j * np.asarray(s)))

    def resting_on(self, point: Any) -> Floats:
        """Follower angle at which the tip touches a point of the ground, (n,) rad; nan out of reach.

        Of the two such angles the one from which the tip leaves the point with s going in the sense `leaves`.
        """
        spoke = (np.asarray(point) - self.pivot) / self.arm
        distance, reach = np.abs(spoke), self.tip_radius / abs(self.arm)
        # half-angle form of the law of cosines: exact where the triangle is flat
        near, far = reach**2 - (1 - distance) ** 2, (1 + distance) ** 2 - reach**2
        with np.errstate(invalid="ignore"):
            opening = 2 * np.arctan2(np.sqrt(near), np.sqrt(far))
        return np.asarray(np.angle(spoke) + self.leaves * opening)


@dataclass(frozen=True)
class Undercut:
    """Cam angles begin..end (rad, end > begin) over which the tip rides on the corner at `corner_cam` instead of a profile.

    shortfall: largest missing follower angle, rad, at cam angle `worst`; depth: the same along the tip's path, mm.
    """

    begin: float
    end: float
    corner_cam: complex
    shortfall: float
    worst: float
    depth: float


@dataclass(frozen=True)
class DiscCam:
    """A disc cam turning about the origin: a program, a follower, and all that follows from them."""

    program: Program
    follower: SwingingArm

    def pitch(self, theta: Any, order: int = 0) -> Points:
        """Pitch curve in the cam's frame, or its derivative to theta of order 0..3, (n,) complex."""
        return self.follower.pitch(theta, self.program, order)

    def tangent(self, theta: Any) -> Points:
        """Unit tangent of the pitch curve in the sense of growing theta, (n,) complex, cam's frame."""
        return _unit(self.pitch(theta, 1))

    def curvature(self, theta: Any) -> Floats:
        """Curvature of the pitch curve, 1/mm, (n,), positive where the cam is convex."""
        return _bending(partial(self.follower.pitch, motion=self.program), theta)

    @cached_property
    def least_radius(self) -> float:
        """Smallest radius of curvature where the pitch curve is convex, corners aside, mm; a larger tip undercuts."""
        bend = max(greatest(self.curvature, a + 1e-9, b - 1e-9)[1] for a, b in pairwise(self.program.joints))
        return 1 / bend if bend > 0 else math.inf

    def profile(self, theta: Any, order: int = 0) -> Points:
        """Untrimmed envelope of the tip in the cam's frame, or its derivative to theta of order 0..2, (n,) complex."""
        return _offset(partial(self.follower.pitch, motion=self.program), self.follower.tip_radius, theta, order)

    def pressure_angle(self, theta: Any) -> Floats:
        """Angle between the contact normal and the trace point's velocity, rad, (n,), 0 or more.

        Where the tip rides on an undercut's corner the normal runs through that corner. [Norton, ch. 7]
        """
        theta = np.asarray(theta, float)
        s = self.reachable(theta)
        outward = 1j * self.tangent(theta)
        for cut in self.undercuts:
            inside = _within(theta, cut)
            trace_cam = self.follower.trace(s[inside]) * np.exp(-1j * theta[inside])
            outward[inside] = _unit(trace_cam - cut.corner_cam)
        away = self.follower.leaves * self.follower.velocity(s) * np.exp(-1j * theta)
        return np.asarray(np.abs(np.angle(away * np.conj(outward))))

    def reachable(self, theta: Any) -> Floats:
        """Follower angle that the exact trimmed cam gives: the program's, less the undercut, (n,) rad."""
        theta = np.asarray(theta, float)
        s = self.program(theta)
        for cut in self.undercuts:
            inside = _within(theta, cut)
            s[inside] = self.follower.resting_on(cut.corner_cam * np.exp(1j * theta[inside]))
        return s

    def riding(self, theta: float) -> bool:
        """Whether the tip rides on an undercut's corner at theta."""
        return any(_within(np.asarray(theta), cut) for cut in self.undercuts)

    @property
    def undercuts(self) -> tuple[Undercut, ...]:
        """Where the tip cannot follow the program."""
        return self._made[1]

    @property
    def outline(self) -> Contour:
        """The exact trimmed profile at theta = 0, counter-clockwise.

        Raises DesignError where the tip leaves no closed profile round the shaft.
        """
        return self._made[0]

    @cached_property
    def _made(self) -> tuple[Contour, tuple[Undercut, ...]]:
        raw: list[Piece] = []
        places: list[float] = []  # cam angle of each raw piece's beginning
        joints = [float(j) for j in self.program.joints]
        place, near = greatest(lambda theta: -np.abs(self.pitch(theta)), joints[0], joints[-1], joints)
        if not self.follower.tip_radius < -near:
            raise DesignError(
                "tip_radius", self.follower.tip_radius, -near, "mm", f"cam angle {math.degrees(place):.3f} deg",
                "the tip reaches the shaft's axis there: use a smaller tip_radius or a smaller swing",
            )  # fmt: skip
        pitches = [
            partial(self.follower.pitch, motion=_continued(segment, joints[k])) for k, segment in enumerate(self.program.segments)
        ]
        wholes = [
            Smooth(partial(_offset, pitch, self.follower.tip_radius), joints[k], joints[k + 1]) for k, pitch in enumerate(pitches)
        ]
        for k, whole in enumerate(wholes):
            corner = self._resting(wholes[k - 1], whole, joints[k])
            pieces = ([corner] if corner else []) + self._forward(whole, pitches[k])
            raw += pieces
            places += [joints[k] if isinstance(p, Arc) else p.t0 for p in pieces]
        kept, cuts = trim(raw) if self.follower.tip_radius else (raw, [])
        outline = Contour(tuple(kept)).reversed()
        if not outline.area > 0:
            raise DesignError(
                "cam area",
                outline.area,
                0.0,
                "mm^2",
                "",
                "the tip leaves no cam round the shaft: use a smaller tip_radius",
            )
        return outline, tuple(self._undercut(raw, places, cut.start, cut.end, cut.at) for cut in cuts)

    def _forward(self, whole: Smooth, pitch: Callable[..., Points]) -> list[Piece]:
        """Stretches of a raw piece that run forwards: where the tip fits into the pitch curve's bend."""
        rho = self.follower.tip_radius
        if rho == 0:
            return [whole]

        def room(theta: Any) -> Floats:
            return 1 - rho * _bending(pitch, theta)

        marks = [whole.t0, *_roots(room, whole.t0, whole.t1), whole.t1]
        return [replace(whole, t0=p, t1=q) for p, q in zip(marks, marks[1:], strict=False) if room((p + q) / 2) > 0]

    def _resting(self, before: Piece, after: Piece, theta: float) -> Arc | None:
        """At a concave corner of the pitch curve the resting tip itself is the profile: its arc joins the two branches."""
        rho = self.follower.tip_radius
        if rho == 0:
            return None
        centre = complex(self.pitch(theta))
        here, there = end_point(before) - centre, start_point(after) - centre
        turn = cmath.phase(there / here)
        # counter-clockwise about the tip's centre is to the left: concave
        return Arc(centre, rho, cmath.phase(here), turn) if turn > SAME_POINT / rho else None

    def _undercut(
        self, raw: list[Piece], places: list[float], start: tuple[int, float], end: tuple[int, float], at: complex
    ) -> Undercut:
        begin, stop = (mark[1] if isinstance(raw[mark[0]], Smooth) else places[mark[0]] for mark in (start, end))
        stop += 2 * math.pi if stop < begin else 0.0

        def missing(theta: Any) -> Floats:
            rides = self.follower.resting_on(at * np.exp(1j * np.asarray(theta)))
            return np.asarray(self.follower.leaves * (self.program(theta) - rides))

        corners = [j for j in np.concatenate((self.program.joints, self.program.joints + 2 * math.pi)) if begin <= j <= stop]
        worst, shortfall = greatest(missing, begin, stop, corners)
        return Undercut(begin, stop, at, shortfall, worst, shortfall * abs(self.follower.arm))


_Motion = Callable[[Any, int], Floats]


def greatest(f: Callable[[Any], Floats], a: float, b: float, also: list[float] | None = None) -> tuple[float, float]:
    """Place and value of the largest f(x) on a..b: even samples, then zoomed in on the best until the interval is rounding.

    also: further places to try, where f has a corner.
    """
    x = np.unique(np.concatenate((np.linspace(a, b, 1025), np.asarray(also or [a]))))
    for _ in range(40):
        y = f(x)
        k = int(np.nanargmax(y))
        low, high = x[max(k - 1, 0)], x[min(k + 1, len(x) - 1)]
        if high - low <= 1e-14 * max(1.0, abs(b)):
            break
        x = np.unique(np.concatenate((np.linspace(low, high, 17), [x[k]])))
    return float(x[k]), float(y[k])


def _roots(f: Callable[[Any], Floats], a: float, b: float) -> list[float]:
    """Places between a and b where f changes sign: even samples and the lowest place, then bisection, vectorised."""
    lowest, _ = greatest(lambda x: -f(x), a, b)
    x = np.union1d(np.linspace(a, b, 1025), lowest)
    y = f(x)
    k = np.flatnonzero(np.sign(y[:-1]) * np.sign(y[1:]) < 0)
    low, high, sign = x[k], x[k + 1], np.sign(y[k])
    for _ in range(60):
        middle = (low + high) / 2
        same = np.sign(f(middle)) == sign
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return [float(r) for r in (low + high) / 2]


def _continued(segment: Segment, begin: float) -> _Motion:
    return lambda theta, order: segment.at(np.asarray(theta) - begin, order)


def _unit(z: Points) -> Points:
    return np.asarray(z / np.abs(z))


def _bending(pitch: Callable[..., Points], theta: Any) -> Floats:
    """Curvature of the pitch curve, positive where the cam is convex (the curve runs clockwise)."""
    d1, d2 = pitch(theta, order=1), pitch(theta, order=2)
    return np.asarray(-np.imag(np.conj(d1) * d2) / np.abs(d1) ** 3)


def _offset(pitch: Callable[..., Points], rho: float, theta: Any, order: int) -> Points:
    """Parallel curve at rho to the right of the pitch curve and its derivatives; the right is the cam's inside."""
    d0, d1 = pitch(theta, order=0), pitch(theta, order=1)
    speed = np.abs(d1)
    if order == 0:
        return np.asarray(d0 - 1j * rho * d1 / speed)
    d2 = pitch(theta, order=2)
    cross = np.imag(np.conj(d1) * d2)
    room = 1 + rho * cross / speed**3
    if order == 1:
        return np.asarray(d1 * room)
    d3 = pitch(theta, order=3)
    dot = np.real(np.conj(d1) * d2)
    room_slope = rho * (np.imag(np.conj(d1) * d3) / speed**3 - 3 * cross * dot / speed**5)
    return np.asarray(d2 * room + d1 * room_slope)


def _within(theta: Floats, cut: Undercut) -> Any:
    return np.mod(theta - cut.begin, 2 * math.pi) < cut.end - cut.begin
