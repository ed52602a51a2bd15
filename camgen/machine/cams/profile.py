"""Disc cams: from a program and a follower to profile, pressure angle and undercut, all in closed form.

    profile         envelope of the follower as the cam sees it, loops trimmed
    pressure angle  between the contact normal and the follower's motion where it touches
    undercut        profile that a later pass of the follower cuts away again

                         A pivot                    ground: the cam turns by theta, counter-clockwise, about O
                        /                           cam:    ground turned back by theta
            tip  ( C )-'    arm A-C
               (cam)
                 O                                  the envelope runs CLOCKWISE round the cam as theta grows

What touches it is said in `followers`. Points are complex numbers, mm; a name ending in _cam is in the cam's frame.
[Norton, Cam Design and Manufacturing Handbook, ch. 7]
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import pairwise
from typing import Any, Generic

import numpy as np
from typing_extensions import TypeVar

from camgen.errors import DesignError
from camgen.geometry.outlines import Arc, Contour, Line, Piece, Smooth, end_point, start_point
from camgen.geometry.trimming import trim
from camgen.machine.cams.followers import FlatFace, Follower, Motion, RoundTip
from camgen.machine.cams.followers import SwingingArm as SwingingArm
from camgen.machine.cams.shoes import Shoe
from camgen.motion.program import Program, Segment
from camgen.numerics import Floats, Indices, Points, distinct, greatest, latest, sign_changes
from camgen.tolerances import SAME_POINT

_BESIDE = 1e-12  # of a segment: a law's derivatives at a break inside it are those on the side that is asked for
_SAMPLES = 1025  # of a stretch, between which an edge of a shoe is looked for that touches
_HALVINGS = 60
_ASIDE = 1e-9  # rad, to either side of where the pressure angle jumps


@dataclass(frozen=True)
class Undercut:
    """Cam angles over which the follower rides on a corner, not on a profile."""

    begin: float  # rad
    end: float  # rad, > begin
    corner_cam: complex  # mm
    shortfall: float  # largest missing displacement, rad or mm
    worst: float  # cam angle of that, rad
    depth: float  # the same along the contact's path, mm


# What a follower and a motion make, for one cam, (n,), or for many, (cams, n).


def pressure_angle_untrimmed(follower: Follower, theta: Any, motion: Motion) -> Floats:
    """Pressure angle on the untrimmed profile, rad, 0 or more."""
    turn = np.exp(1j * np.asarray(theta, float))
    normal = follower.normal(theta, motion) * turn
    return follower.pressure_angle(
        motion(theta, 0), follower.envelope(theta, motion, 0) * turn, normal
    )


def sharpness(follower: Follower, theta: Any, motion: Motion) -> Floats:
    """The radius of curvature of the untrimmed profile, mm, below 0, where it is to be convex; elsewhere -inf."""
    if isinstance(follower, Shoe):
        return np.asarray(
            follower.chosen(theta, motion, lambda part: sharpness(part, theta, motion))
        )
    radius = follower.radius(theta, motion)
    # a round tip may run in hollows, where its pitch curve's own radius is below 0; a face may not
    return (
        np.where(radius + follower.tip_radius > 0, -radius, -np.inf)
        if isinstance(follower, RoundTip)
        else -radius
    )


def place_on_face(follower: FlatFace, theta: Any, motion: Motion) -> Floats:
    """Where on a face the profile touches it, mm, as `FlatFace.place`."""
    point = follower.envelope(theta, motion, 0) * np.exp(1j * np.asarray(theta))
    return follower.place(motion(theta, 0), point)


def still(s: Any, theta: Any, order: int) -> Floats:
    """The motion of a follower that stands at s."""
    return np.asarray(0.0 if order else s)


F = TypeVar("F", bound=Follower, default=SwingingArm)


@dataclass(frozen=True)
class DiscCam(Generic[F]):
    """A disc cam turning about the origin: a program, a follower, and all that follows from them."""

    program: Program
    follower: F
    air: float = 0.0  # mm, between the follower's tip and the profile; below 0 it presses on it

    @cached_property
    def nearest(self) -> float:
        """Distance of the profile from the axis, mm, below 0 where the axis is cut away: what stands nearest cuts deepest."""
        low, high = (self.cutter.clear(0.0, partial(still, end)) for end in self.program.extremes)
        return float(min(low, high))

    @cached_property
    def cutter(self) -> F:
        """What the profile is the envelope of: the follower, larger by the air."""
        return self.follower.grown(self.air) if self.air else self.follower

    @property
    def tip(self) -> RoundTip:
        """The cutter, which must have a round tip; TypeError for a flat face, which has no pitch curve."""
        if not isinstance(self.cutter, RoundTip):
            raise TypeError("a flat face has no pitch curve")
        return self.cutter

    def pitch(self, theta: Any, order: int = 0) -> Points:
        """Pitch curve in the cam's frame, or its derivative to theta of order 0..3, (n,) complex."""
        return self.tip.pitch(theta, self.program, order)

    def curvature(self, theta: Any) -> Floats:
        """Curvature of the pitch curve, 1/mm, (n,), positive where the cam is convex."""
        return self.tip.pitch_curvature(theta, self.program)

    def radius(self, theta: Any) -> Floats:
        """Radius of curvature of the untrimmed profile, mm, (n,), positive where convex (below 0: hollow, or undercut)."""
        return self.cutter.radius(theta, self.program)

    @cached_property
    def least_radius(self) -> float:
        """Least radius of curvature of the untrimmed profile where it is to be convex, mm; below 0: undercut; inf: none."""
        return -self.greatest(lambda theta: sharpness(self.cutter, theta, self.program))[1]

    def profile(self, theta: Any, order: int = 0) -> Points:
        """Untrimmed envelope of the follower in the cam's frame, or its derivative to theta of order 0..2, (n,) complex."""
        return self.cutter.envelope(theta, self.program, order)

    def pressure_angle(self, theta: Any) -> Floats:
        """Angle between the contact normal and the follower's motion at the contact, rad, (n,), 0 or more.

        Where the follower rides on an undercut's corner that is the contact.
        """
        theta = np.asarray(theta, float)
        angle = self.pressure_angle_untrimmed(theta)
        for cut in self.undercuts:
            inside = _within(theta, cut)
            point = cut.corner_cam * np.exp(1j * theta[inside])
            s = self.cutter.resting_on(point)
            angle[inside] = self.cutter.pressure_angle(s, point, self.cutter.normal_on(s, point))
        return angle

    def pressure_angle_untrimmed(self, theta: Any) -> Floats:
        """Pressure angle on the untrimmed profile, rad, (n,), 0 or more."""
        return pressure_angle_untrimmed(self.cutter, theta, self.program)

    @property
    def steepest(self) -> float:
        """Largest pressure angle over the turn, deg, on the corners of undercuts too."""
        return self._steepest[1]

    @property
    def steepest_at(self) -> float:
        """Cam angle of the largest pressure angle, rad."""
        return self._steepest[0]

    @cached_property
    def _steepest(self) -> tuple[float, float]:
        return self.steepest_between(self.corners[0], self.corners[-1])

    def steepest_between(self, low: float, high: float, riding: bool = True) -> tuple[float, float]:
        """Cam angle, rad, and size, deg, of the largest pressure angle between two cam angles; riding: on the corners of undercuts too.

        It jumps where the speed does and at an undercut's ends: they are looked at from either side.
        """
        ends = [
            low + (end - low) % math.tau for cut in self.undercuts for end in (cut.begin, cut.end)
        ]
        marks = sorted({low, high, *(mark for mark in (*self.corners, *ends) if low < mark < high)})
        peaks = [
            greatest(self.pressure_angle, a + _ASIDE, b - _ASIDE, self.program.knots(a, b))
            for a, b in pairwise(marks)
            if riding or not self.riding((a + b) / 2)
        ]
        place, angle = max(peaks, key=lambda each: each[1], default=(low, 0.0))
        return place, math.degrees(angle)

    @cached_property
    def face_contact(self) -> tuple[float, float]:
        """Between which places a flat face is touched over the turn, mm from the stem's line or the pivot's foot."""
        if not isinstance(self.cutter, FlatFace):
            raise TypeError("only a flat face is touched at more than one place")
        place = partial(place_on_face, self.cutter, motion=self.program)
        low = -self.greatest(lambda theta: -place(theta))[1]
        return low, self.greatest(place)[1]

    def groove(self, clearance: float = 0.0) -> Contour:
        """Outer wall of the groove in which the round tip runs, the outline being the inner one; counter-clockwise.

        clearance: by how much the groove is wider than the tip, mm; the inner wall stays where it is.

        Raises DesignError where the speed jumps or the tip does not fit the pitch curve's hollows.
        """
        tip: Any = self.tip
        away = tip.tip_radius + clearance
        other = DiscCam(self.program, replace(tip, tip_radius=-away))
        place, bend = self.greatest(lambda theta: -self.curvature(theta))
        if bend * away >= 1:
            raise DesignError(
                "radius of the pitch curve's hollow",
                1 / bend,
                away,
                "mm",
                f"cam angle {math.degrees(place):.3f} deg",
                "the groove's outer wall is undercut there: use a smaller tip",
            )
        pieces = [each.whole.reversed() for each in reversed(other._stretches())]
        wall, cuts = trim(pieces)
        if cuts:
            raise DesignError(
                "crossings of the groove's outer wall",
                len(cuts),
                0,
                "",
                "",
                "use a smaller tip or a larger base circle",
            ).saying("the groove's outer wall crosses itself")
        return Contour(tuple(wall)).counter_clockwise()

    def greatest(self, f: Callable[[Any], Floats]) -> tuple[float, float]:
        """Place and value of the largest f(theta) over the turn, looked for between its corners; even in a dwell."""
        peaks = []
        for a, b in pairwise(self.corners):
            if self._segment(a, b)[0].scale == 0:
                peaks.append(((a + b) / 2, float(f(np.array([(a + b) / 2]))[0])))
            else:
                peaks.append(greatest(f, a + 1e-9, b - 1e-9, self.program.knots(a, b)))
        return max(peaks, key=lambda each: each[1])

    def _segment(self, a: float, b: float) -> tuple[Segment, float]:
        """The segment between two neighbouring breaks, and where it begins."""
        joints = self.program.joints
        last = len(self.program.segments) - 1
        k = min(int(np.searchsorted(joints, (a + b) / 2)) - 1, last)
        return self.program.segments[k], float(joints[k])

    def reachable(self, theta: Any, order: int = 0) -> Floats:
        """Displacement that the exact trimmed cam gives: the program's, less the undercut, (n,) rad or mm; or its derivative,
        of which the second is nan where the follower rides on a corner.
        """
        theta = np.asarray(theta, float)
        s = self.program(theta, order)
        for cut in self.undercuts:
            inside = _within(theta, cut)
            point = cut.corner_cam * np.exp(1j * theta[inside])
            rides = self.cutter.resting_on(point)
            if order:
                across = np.conj(self.cutter.normal_on(rides, point))
                slope = np.real(across * 1j * point) / np.real(
                    across * self.cutter.velocity(rides, point)
                )
                rides = slope if order == 1 else np.full(slope.shape, math.nan)
            s[inside] = rides
        return s

    def riding(self, theta: float) -> bool:
        """Whether the follower rides on an undercut's corner at theta."""
        return any(_within(np.asarray(theta), cut) for cut in self.undercuts)

    @cached_property
    def undercuts(self) -> tuple[Undercut, ...]:
        """Where the follower cannot follow the program."""
        return self._outline[1]

    @cached_property
    def length(self) -> float:
        """Of the outline, mm."""
        return self.outline.length

    @cached_property
    def area(self) -> float:
        """In the outline, mm^2."""
        return self.outline.area

    @property
    def outline(self) -> Contour:
        """The exact trimmed profile at theta = 0, counter-clockwise.

        Raises DesignError where the follower leaves no closed profile round the shaft.
        """
        return self._outline[0]

    @cached_property
    def _outline(self) -> tuple[Contour, tuple[Undercut, ...]]:
        self._check_axis()
        self._check_shoe()
        raw: list[Piece] = []
        places: list[
            tuple[float, float]
        ] = []  # cam angle of each raw piece's beginning, and its growth with the parameter
        stretches = self._stretches()
        for k, stretch in enumerate(stretches):
            begin = self.corners[k]
            rest = self._resting(stretches[k - 1].whole, stretch.whole, begin)
            if rest:
                raw.append(rest)
                places.append((begin, 0.0))
            for piece in stretch.forward:
                raw.append(piece)
                places.append((piece.t0, 1.0) if isinstance(piece, Smooth) else (begin, -1.0))
        trims = not _is_knife(self.cutter)
        pieces, cuts = trim(raw) if trims else (raw, [])
        outline = Contour(tuple(pieces)).reversed()
        if not outline.area > 0:
            raise DesignError(
                "cam area",
                outline.area,
                0.0,
                "mm^2",
                "",
                "the tip leaves no cam round the shaft: use a smaller tip_radius",
            )

        def angle(mark: tuple[int, float]) -> float:
            begin, rate = places[mark[0]]
            return begin + rate * (mark[1] - raw[mark[0]].t0)

        return outline, tuple(
            self._undercut(angle(cut.start), angle(cut.end), cut.at) for cut in cuts
        )

    def _check_axis(self) -> None:
        """DesignError where the follower reaches the shaft's axis, so that no cam is left there."""
        ends = [float(j) for j in self.program.joints]
        place, near = greatest(
            lambda theta: -self.cutter.clear(theta, self.program), ends[0], ends[-1], ends
        )
        if near < 0:
            return
        where = f"cam angle {math.degrees(place):.3f} deg"
        if not isinstance(self.cutter, RoundTip):
            raise DesignError(
                "distance of the follower from the axis",
                -near,
                0.0,
                "mm",
                where,
                "it reaches the shaft's axis there: use a larger base circle",
            )
        rho = self.tip.tip_radius
        raise DesignError(
            "tip_radius",
            rho,
            rho - near,
            "mm",
            where,
            "the tip reaches the shaft's axis there: use a smaller tip or a smaller lift",
        )

    def _check_shoe(self) -> None:
        """DesignError where a shoe has no contact with a cam."""
        if not isinstance(self.cutter, Shoe):
            return
        jump = next((each for each in self.program.discontinuities(1) if each.order <= 1), None)
        if jump is not None:
            raise DesignError(
                "jump of the speed",
                abs(jump.size),
                0.0,
                "per rad",
                f"cam angle {math.degrees(jump.theta):.3f} deg",
                "an outline of your own needs a program whose speed does not jump: use another law",
            )
        self.cutter.check(self.program, self.corners)

    @cached_property
    def corners(self) -> tuple[float, ...]:
        """Cam angles between which the profile is one smooth curve, rad: the program's, and where a shoe touches by another edge."""
        of_program = [float(x) for x in self.program.corners]
        shoe = self.cutter
        if not isinstance(shoe, Shoe):
            return tuple(of_program)
        corners = of_program[:1]
        for a, b in pairwise(of_program):
            segment, begin = self._segment(a, b)
            motion = _continuation(segment, begin, a, b)
            changes = _changes(lambda t, m=motion: shoe.touched(shoe.pole(t, m)), a, b)  # type: ignore[misc]
            corners += [*(each for each in changes if a < each < b), b]
        return tuple(corners)

    def _stretches(self) -> list[_Stretch]:
        """Untrimmed profile between neighbouring corners; a dwell's is an arc about the axis."""
        stretches = []
        for a, b in pairwise(self.corners):
            segment, begin = self._segment(a, b)
            motion = _continuation(segment, begin, a, b)
            knots = tuple(float(t) for t in self.program.knots(a, b))
            cutter: Follower = self.cutter
            if isinstance(cutter, Shoe):
                cutter = cutter.parts[int(cutter.touched(cutter.pole((a + b) / 2, motion)))]
            whole: Piece = Smooth(partial(_envelope, cutter, motion), a, b, knots)
            if segment.scale == 0:
                first = complex(whole.at(a))
                whole = Arc(0j, abs(first), cmath.phase(first), a - b)
            stretches.append(_Stretch(whole, motion, cutter))
        return stretches

    def _resting(self, before: Piece, after: Piece, theta: float) -> Piece | None:
        """Where the speed jumps so that the follower's own surface is the profile: an arc of the tip, a line of the face."""
        if isinstance(self.cutter, Shoe):  # for which no speed jumps
            return None
        a = end_point(before)
        b = start_point(after)
        if isinstance(self.cutter, FlatFace):
            ahead = -1j * complex(self.cutter.normal(np.asarray(theta), self.program))
            return Line(a, b) if (ahead.conjugate() * (b - a)).real > SAME_POINT else None
        rho = self.tip.tip_radius
        if rho == 0:
            return None
        centre = complex(self.pitch(theta))
        from_a = a - centre
        to_b = b - centre
        turn = cmath.phase(to_b / from_a)
        # counter-clockwise about the tip's centre is to the left: concave
        return Arc(centre, rho, cmath.phase(from_a), turn) if turn > SAME_POINT / rho else None

    def _undercut(self, begin: float, stop: float, at: complex) -> Undercut:
        stop += 2 * math.pi if stop < begin else 0.0

        def missing(theta: Any) -> Floats:
            rides = self.cutter.resting_on(at * np.exp(1j * np.asarray(theta)))
            return np.asarray(self.cutter.leaves * (self.program(theta) - rides))

        corners = np.concatenate((self.program.joints, self.program.joints + 2 * math.pi))
        worst, shortfall = greatest(
            missing, begin, stop, corners[(begin <= corners) & (corners <= stop)]
        )
        corner = at * np.exp(1j * worst)
        travel = np.abs(self.cutter.velocity(self.cutter.resting_on(corner), corner))
        return Undercut(begin, stop, at, shortfall, worst, shortfall * float(travel))


@dataclass(frozen=True)
class _Stretch:
    """Untrimmed profile between two corners, the motion there, and the one tip or face that makes it."""

    whole: Piece
    motion: Motion
    cutter: Follower

    @property
    def forward(self) -> list[Piece]:
        """Its pieces that run forwards: where the follower fits into the curve's bend."""
        whole = self.whole
        if _is_knife(self.cutter) or not isinstance(whole, Smooth):
            return [whole]

        def room(theta: Any) -> Floats:
            return self.cutter.room(theta, self.motion)

        marks = [whole.t0, *_roots(room, whole), whole.t1]
        return [
            replace(whole, t0=p, t1=q)
            for p, q in pairwise(marks)
            if room(np.asarray((p + q) / 2)) > 0
        ]


def _is_knife(follower: Follower) -> bool:
    return isinstance(follower, RoundTip) and follower.tip_radius == 0


def _changes(which: Callable[[Any], Indices], a: float, b: float) -> list[float]:
    """Places between a and b at which an integer function changes, each change told by even samples, to the last digits."""
    x = np.linspace(a, b, _SAMPLES)
    value = which(x)
    changes: list[float] = []
    at = np.flatnonzero(value[1:] != value[:-1])
    low = x[at]
    high = x[at + 1]
    first = value[at]
    last = value[at + 1]
    while len(low):
        begin = low
        end = high
        for _ in range(_HALVINGS):
            middle = (begin + end) / 2
            same = which(middle) == first
            begin = np.where(same, middle, begin)
            end = np.where(same, end, middle)
        changes += end.tolist()
        after = which(end)
        more = np.flatnonzero((after != last) & (end < high))  # a third one between two samples
        low = end[more]
        high = high[more]
        first = after[more]
        last = last[more]
    return sorted(changes)


def _roots(f: Callable[[Any], Floats], piece: Smooth) -> list[float]:
    """Places along a piece (t0 < t1) where f changes sign: looked for at its knots, even samples, the lowest place."""
    samples = piece.spread(1025)
    lowest, _ = greatest(lambda x: -f(x), piece.t0, piece.t1, samples)
    roots: list[float] = sign_changes(f, distinct(samples, [lowest])).tolist()
    return roots


def _continuation(segment: Segment, begin: float, a: float, b: float) -> Motion:
    """The segment's motion between the breaks a and b, its derivatives at these those on the inside.

    Curves are asked for point, tangent and bend at the same angles one after the other: what the law says there is kept
    until other angles come.
    """
    low = a - begin
    high = b - begin
    low += _BESIDE * segment.span if low > 0 else 0.0
    high -= _BESIDE * segment.span if high < (1 - _BESIDE) * segment.span else 0.0

    known_at = latest(lambda theta: dict[int, Floats]())

    def motion(theta: Any, order: int) -> Floats:
        theta = np.asarray(theta, float)
        known = known_at(theta)
        if order not in known:
            angle = theta - begin
            angle = np.minimum(np.maximum(angle, low), high) if order else angle
            value = np.asarray(segment.at(angle, order))
            value.flags.writeable = False
            known[order] = value
        return known[order]

    return motion


def _envelope(follower: Follower, motion: Motion, theta: Any, order: int) -> Points:
    return follower.envelope(theta, motion, order)


def _within(theta: Floats, cut: Undercut) -> Any:
    return np.mod(theta - cut.begin, 2 * math.pi) < cut.end - cut.begin
