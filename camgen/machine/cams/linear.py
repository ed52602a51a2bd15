"""Linear cams: a plate that slides, and a round tip that one of its edges moves.

theta    way of the plate, of which a degree stands for a millimetre, so that it is an angle to all that reads a program
x        the same in mm: 180 theta / pi
travel   unit vector of the ground along which the plate goes as theta grows: -1 of a machine of its own
plate    frame of the plate: at x = 0 that of the ground; the tip stands at -travel x in it when the plate has gone by x

The plate does not turn, so the pitch curve is trace(s) - travel x, and what a round tip leaves of it is its parallel curve, as
of a disc: tan(alpha) = ds/dx of a slide square to the way, and the radius of curvature of such a slide's pitch curve is
(1 + s'^2)^1.5 / |s''|. The pitch curve runs along -travel, and the tip lies to its left: where a follower stands on the other
side of its plate, its program is taken from its end to its beginning, and the plate along -travel (`seen_from_left`).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import pairwise
from typing import Any

import numpy as np

from camgen.errors import DesignError
from camgen.geometry.outlines import Line, Piece, Smooth, end_point, start_point
from camgen.machine.cams.followers import Motion, SlidingTip, SwingingArm
from camgen.machine.cams.profile import sharpness
from camgen.motion.program import Program
from camgen.motion.stroke import Stroke
from camgen.numerics import Floats, Points, greatest

WAY = math.degrees(1)  # mm of the plate's way for 1 of theta
_ALONG = 1e-6  # of a follower's speed, across the plate's way at least
_BESIDE = 1e-9  # of theta, to either side of a joint


def _pitches(
    tip: PlateSlide | PlateArm, turn: complex, theta: Any, motion: Motion, order: int
) -> list[Points]:
    """Trace point in the plate's frame with derivatives to theta; turn: of the trace point's velocity for 1 of s."""
    theta = np.asarray(theta, float)
    s = [motion(theta, k) for k in range(order + 1)]
    way = tip.velocity(s[0], 0)
    rows = [np.asarray(tip.trace(s[0]) - tip.travel * WAY * theta)]
    if order > 0:
        rows.append(np.asarray(way * s[1] - tip.travel * WAY))
    if order > 1:
        rows.append(np.asarray(way * (s[2] + turn * s[1] ** 2)))
    if order > 2:
        rows.append(np.asarray(way * (s[3] + 3 * turn * s[1] * s[2] + turn**2 * s[1] ** 3)))
    return rows


@dataclass(frozen=True)
class PlateSlide(SlidingTip):
    """A round tip on a slide over a plate."""

    travel: complex = -1.0 + 0j  # unit vector of the ground, of the plate as theta grows

    def pitches(self, theta: Any, motion: Motion, order: int) -> list[Points]:
        """Trace point in the plate's frame and its derivatives to theta up to an order 0..3, each (n,) complex."""
        return _pitches(self, 0j, theta, motion, order)


@dataclass(frozen=True)
class PlateArm(SwingingArm):
    """A round tip on an arm over a plate."""

    travel: complex = -1.0 + 0j  # unit vector of the ground, of the plate as theta grows

    def pitches(self, theta: Any, motion: Motion, order: int) -> list[Points]:
        """Trace point in the plate's frame and its derivatives to theta up to an order 0..3, each (n,) complex."""
        return _pitches(self, 1j, theta, motion, order)


@dataclass(frozen=True)
class LinearCam:
    """A plate's upper edge: a program over its way, a follower, and all that follows from them."""

    program: Stroke
    follower: PlateSlide | PlateArm

    @property
    def range(self) -> tuple[float, float]:
        """Least and greatest theta."""
        joints = self.program.joints
        return float(joints[0]), float(joints[-1])

    def greatest(self, f: Callable[[Any], Floats]) -> tuple[float, float]:
        """Place and value of the largest f(theta) along the way, looked for between corners."""
        corners = self.program.corners
        peaks = [
            greatest(f, a + _BESIDE, b - _BESIDE, self.program.knots(a, b))
            for a, b in pairwise(corners)
        ]
        return max(peaks, key=lambda each: each[1])

    def pressure_angle(self, theta: Any) -> Floats:
        """Angle between the contact's normal and the follower's way, rad, (n,), 0 or more."""
        s = self.program(theta)
        return self.follower.pressure_angle(s, 0j, self.follower.normal(theta, self.program))

    @cached_property
    def steepest(self) -> float:
        """Largest pressure angle, deg."""
        return math.degrees(self.greatest(self.pressure_angle)[1])

    @cached_property
    def least_radius(self) -> float:
        """Least radius of curvature of the edge where it is convex, mm; inf: it is nowhere."""
        return -self.greatest(lambda theta: sharpness(self.follower, theta, self.program))[1]

    @cached_property
    def edge(self) -> tuple[Piece, ...]:
        """The edge, run through along -travel, the tip to its left; DesignError where the tip does not fit, or the speed of the lift jumps."""
        self._check()
        pieces: list[Piece] = []
        for a, b in pairwise(self.program.corners):
            knots = tuple(float(t) for t in self.program.knots(a, b))
            piece: Piece = Smooth(partial(_within, self, a, b), a, b, knots)
            middle = np.array([(a + b) / 2])
            if self.program(middle, 1)[0] == 0 and self.program(middle, 2)[0] == 0:
                piece = Line(start_point(piece), end_point(piece))
            pieces.append(piece)
        return tuple(pieces)

    def _back(self, theta: Any) -> Floats:
        """How fast the tip goes back over the plate, mm for 1 of theta, (n,)."""
        onward = self.follower.pitch(theta, self.program, 1)
        return np.asarray((onward * np.conj(self.follower.travel)).real)

    @staticmethod
    def _place(theta: float) -> str:
        """In words; of a program from its end to its beginning theta is 0 or less."""
        return f"{abs(WAY * theta):.4g} mm of the travel"

    def _check(self) -> None:
        jump = next((each for each in self.program.discontinuities(1) if each.order <= 1), None)
        if jump is not None:
            where = self._place(jump.theta)
            remedy = "the edge would have a kink there: use a law that ends smoothly"
            raise DesignError("jump of the speed", abs(jump.size) / WAY, 0.0, "", where, remedy)
        at, tight = self.greatest(lambda theta: -self.follower.room(theta, self.program))
        if tight >= 0:
            radius = 1 / float(self.follower.pitch_curvature(np.array([at]), self.program)[0])
            where = self._place(at)
            remedy = "the edge is undercut: use a smaller roller, a longer span or a smaller lift"
            tip = self.follower.tip_radius
            raise DesignError("radius of the pitch curve", radius, tip, "mm", where, remedy)
        at, back = self.greatest(self._back)
        if back >= 0:
            where = self._place(at)
            remedy = "the arm carries its tip along faster than the plate goes: use a longer span"
            raise DesignError("way of the tip over the plate", -back / WAY, 0.0, "", where, remedy)


def over_way(program: Program, follower: PlateSlide | PlateArm) -> LinearCam:
    """The cam of a program over mm of the way."""
    segments = tuple(replace(each, span=each.span / WAY) for each in program.segments)
    return LinearCam(Stroke(segments), follower)


def seen_from_left(cam: LinearCam) -> LinearCam:
    """The same cam, its pitch curve run through so that the tip lies to its left; DesignError where the tip moves along the plate.

    Places on the plate are as before: of a program that is turned round the plate's frame is that of the ground at x = 0, too.
    """
    follower = cam.follower
    off = follower.leaves * follower.velocity(cam.program.segments[0].start, 0).item()
    across = (off * np.conj(1j * -follower.travel)).real
    if abs(across) <= _ALONG * abs(off):
        remedy = "draw the follower so that it moves across the plate's travel"
        raise DesignError("pressure angle as drawn", 90, 90, "deg", "", remedy)
    if across > 0:
        return cam
    program = cam.program.backwards()
    return LinearCam(program, replace(follower, travel=-follower.travel))


@dataclass(frozen=True)
class PlateTouch:
    """Where a plate is touched, on its body as that stands turned and shifted: body = at + turn * ground at x = 0.

    cam: seen from the left; sense: +1 or -1, of its theta over the plate's way.
    """

    cam: LinearCam
    sense: int
    turn: complex = 1 + 0j
    at: complex = 0j

    def _theta(self, way: Floats) -> Floats:
        low, high = self.cam.range
        return np.clip(self.sense * np.asarray(way, float) / WAY, low + _BESIDE, high - _BESIDE)

    def __call__(self, way: Floats) -> tuple[Points, Points]:
        """Place, complex mm, and unit normal into the follower at places of the plate, (n,) mm."""
        theta = self._theta(way)
        program = self.cam.program
        place = self.cam.follower.envelope(theta, program, 0)
        return self.at + self.turn * place, self.turn * self.cam.follower.normal(theta, program)

    def radius(self, way: Floats) -> Floats:
        """Radius of curvature there, mm, above 0 where it is convex, (n,)."""
        return self.cam.follower.radius(self._theta(way), self.cam.program)

    def across(self, way: Floats) -> Floats:
        """Radius of the tip, mm, (n,)."""
        return np.full(np.shape(way), self.cam.follower.tip_radius)


def _within(cam: LinearCam, low: float, high: float, theta: Floats, order: int) -> Points:
    """The envelope of one stretch; at its ends derivatives are those of the inside."""
    if order:
        theta = np.clip(theta, low + _BESIDE, high - _BESIDE)
    return cam.follower.envelope(theta, cam.program, order)
