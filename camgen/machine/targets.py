"""What is wanted of an output by value: stroke, places of a path, straightness, dwell, time ratio.

    course   an output over a turn, or a range, in a person's units: by the model's closed form, or by joints as measured
    target   one wish with its tolerance: a table of the spec that measures a course and says its finding

theta is the drive's angle from the drawn position; where a program moves the drive, the angle of its period.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field

from camgen.errors import Fault, Key
from camgen.findings import Finding, Where, at_least, at_most
from camgen.geometry.convex import hull_corners
from camgen.geometry.hausdorff import Edges, stray
from camgen.numerics import Floats, Points, from_zero, magnitude
from camgen.spec import Coordinate, Record, quantity

_FINE = 8  # places between two samples at which a dwell is looked for
_WINDOWS = 720  # stretches of a path, from so many places, of which the straightest is looked for
_CLOSER = 12  # of them that are measured by the least zone
_PARTS = np.linspace(
    0.0, 1.0, 9
)  # of a stretch in which a nearest place is sought, again in what is left of it
_NARROWER = 18  # times, to 4^-18 of two samples
_CHORDS = 64  # at most, in place of the cubic between two samples
_FINE_SHARE = 0.001  # of a path's tolerance, to which its farthest place is found
_OF_LIFT = 0.001  # of the way from down to up, to which a pen's lift is known
_FINEST = 1e-6  # of a path's length, finer than which nothing is looked for
_STILL = 1e-9  # mm or deg: what goes less far stands still
_ALONG_PATH = 4096  # places along a path, for its breadth
_COLUMNS = 64  # of its length, in which its breadth is measured
_ROUND = 1e-6  # of an extent: what differs by less is as long
NO_STROKES = "turns all round or stands still: it has no two strokes whose times compare"
_RETURNS = 1e-3  # of its way, within which an output is back after a turn

Near = Annotated[float, quantity("mm", gt=0, le=1e6)]
Size = Annotated[float, quantity("mm or deg", gt=0, le=1e6)]
Value = Annotated[float, quantity("mm or deg", ge=-1e6, le=1e6)]
Angle = Annotated[float, quantity("deg", ge=-36000, le=36000)]


@dataclass(frozen=True)
class Course:
    """An output over a range of theta."""

    theta: Floats  # (n,) rad, growing, both ends of the range included
    value: Any  # (n,), complex for a path
    slope: Any  # to theta, (n,)
    unit: str  # "mm" or "deg"
    whole: bool  # whether the range is one turn, after which it goes on as before
    by: str = "deg"  # what a degree of theta stands for, "mm" of a way

    def at(self, theta: Floats) -> Any:
        """The value there, (m,): cubic between the samples; of a whole turn at any angle."""
        low = self.theta[0]
        high = self.theta[-1]
        turns = np.floor((theta - low) / (high - low)) if self.whole else np.zeros(np.shape(theta))
        t = theta - turns * (high - low)
        k = np.clip(np.searchsorted(self.theta, t, side="right") - 1, 0, len(self.theta) - 2)
        h = self.theta[k + 1] - self.theta[k]
        u = (t - self.theta[k]) / h
        a = self.value[k]
        b = self.value[k + 1]
        bend = (1 - u) * (h * self.slope[k] - (b - a)) - u * (h * self.slope[k + 1] - (b - a))
        return a + u * (b - a) + u * (1 - u) * bend + turns * (self.value[-1] - self.value[0])

    @property
    def strokes(self) -> bool:
        """Whether a real output goes to and fro over a whole turn; not one that turns on, or stands still."""
        way = float(np.ptp(self.value))
        return self.whole and _STILL < way and abs(self.value[-1] - self.value[0]) < _RETURNS * way

    def chords(self, error: float) -> tuple[Points, float]:
        """Corners on a path, (m,), and how far it is from the line through them, mm: no more than `error` where so many chords
        do."""
        count = self.count(error)
        return self.corners(count), self.bend / count**2

    @cached_property
    def bend(self) -> float:
        """How far the output is from chords from sample to sample at most, in its unit: a chord of a cubic z lies within
        max |z''| / 8 of it, and z'' is greatest at an end."""
        h = np.diff(self.theta)
        begin = h * self.slope[:-1]
        end = h * self.slope[1:]
        way = np.diff(self.value)
        bends = np.maximum(
            np.abs(6 * way - 4 * begin - 2 * end), np.abs(6 * way - 2 * begin - 4 * end)
        )
        return float(np.max(bends)) / 8

    def count(self, error: float) -> int:
        """Chords between two samples that the output leaves by no more than `error`, at most 64."""
        if self.bend >= _CHORDS**2 * error:
            return _CHORDS
        return max(1, math.ceil(math.sqrt(self.bend / error)))

    def corners(self, count: int) -> Any:
        """Values at the ends of so many chords from sample to sample, (m,)."""
        h = np.diff(self.theta)
        theta = (self.theta[:-1, None] + h[:, None] * np.arange(count) / count).ravel()
        return np.append(self.at(theta), self.value[-1])

    def extreme(self, sign: int) -> tuple[float, float]:
        """theta and value where a real output is greatest (sign 1) or least (-1): where its slope vanishes, or at an end."""
        k = int(np.argmax(sign * self.value))
        last = len(self.theta) - 2
        extremes = [(float(self.theta[k]), float(self.value[k]))]
        for j in {k - 1, k, *((0, last) if self.whole and k in (0, last + 1) else ())} & set(
            range(last + 1)
        ):
            a = self.slope[j]
            b = self.slope[j + 1]
            if a * b < 0:
                t = float(self.theta[j] + a / (a - b) * (self.theta[j + 1] - self.theta[j]))
                extremes.append((t, float(self.at(np.array([t]))[0])))
        return max(extremes, key=lambda pair: sign * pair[1])

    def nearest(self, place: complex) -> list[tuple[float, float]]:
        """theta and distance, mm, of each place of a path that is nearer to `place` than its neighbours; by theta."""
        away = np.abs(self.value[:-1] - place) if self.whole else np.abs(self.value - place)
        before = np.roll(away, 1)
        after = np.roll(away, -1)
        if not self.whole:
            before[0] = after[-1] = math.inf
        k = np.flatnonzero((away <= before) & (away <= after))
        step = self.theta[1] - self.theta[0]
        low = self.theta[k] - step
        high = self.theta[k] + step
        if not self.whole:
            low = np.maximum(low, self.theta[0])
            high = np.minimum(high, self.theta[-1])
        rows = np.arange(len(k))
        for _ in range(_NARROWER):
            t = low[:, None] + (high - low)[:, None] * _PARTS
            best = np.clip(np.argmin(np.abs(self.at(t) - place), axis=1), 1, len(_PARTS) - 2)
            low = t[rows, best - 1]
            high = t[rows, best + 1]
        t = (low + high) / 2
        return sorted(zip(t.tolist(), np.abs(self.at(t) - place).tolist(), strict=True))


def stroke(course: Course) -> float:
    """Difference of the extremes; of a path the larger side of its box."""
    if np.iscomplexobj(course.value):
        sides = [(course.value.real, course.slope.real), (course.value.imag, course.slope.imag)]
        return max(stroke(Course(course.theta, *side, course.unit, course.whole)) for side in sides)
    return course.extreme(1)[1] - course.extreme(-1)[1]


class Stroke(Record):
    """How far an output goes: the difference of its extremes; of a path the larger side of its box."""

    code: ClassVar[str] = "STROKE_ERROR"

    value: Size = Field(description="how far it goes")
    tolerance: Size = Field(description="how far it may differ")

    def finding(self, course: Course, where: Where) -> Finding:
        """STROKE_ERROR."""
        actual = stroke(course)
        message = f"stroke {actual:.6g} {course.unit}, {self.value:g} wanted; the limit is the tolerance of the spec"
        return at_most(
            self.code, abs(actual - self.value), self.tolerance, course.unit, where, message
        )


class Through(Record):
    """Places that a path passes, each at its nearest."""

    code: ClassVar[str] = "PATH_ERROR"

    at: tuple[tuple[Coordinate, Coordinate], ...] = Field(
        description="places [x, y] as drawn", min_length=1, max_length=1000
    )
    tolerance: Near = Field(description="how far from each the path may pass")
    in_order: bool = Field(
        default=False, description="true: the path passes them in this order as theta grows"
    )
    theta_deg: tuple[Angle, ...] | None = Field(
        default=None, description="angles at which it passes the places, one for each"
    )

    def faults(self, path: Key) -> list[Fault]:
        """What does not go together."""
        if self.theta_deg is not None and len(self.theta_deg) != len(self.at):
            return [
                Fault(
                    (*path, "theta_deg"),
                    f"{len(self.theta_deg)} angles",
                    f"one for each of the {len(self.at)} places",
                )
            ]
        if self.theta_deg is not None and self.in_order:
            return [
                Fault(
                    (*path, "in_order"),
                    "true",
                    "false, or no theta_deg: angles say the order already",
                )
            ]
        return []

    @property
    def places(self) -> list[complex]:
        """Where the path shall pass, mm."""
        return [complex(*place) for place in self.at]

    def passes(self, course: Course) -> list[tuple[float, float]]:
        """theta and distance, mm, at which the path passes each place; none where it never passes them in their order."""
        if self.theta_deg is not None:
            t = np.radians(self.theta_deg)
            return list(zip(t.tolist(), np.abs(course.at(t) - self.places).tolist(), strict=True))
        ways = [course.nearest(place) for place in self.places]
        return (
            _in_order(ways, course.whole)
            if self.in_order
            else [min(way, key=lambda pair: pair[1]) for way in ways]
        )

    def finding(self, course: Course, where: Where) -> Finding:
        """PATH_ERROR: the place that the path misses most."""
        passes = self.passes(course)
        how = (
            "in their order"
            if self.in_order
            else "each at its nearest"
            if self.theta_deg is None
            else "at the angles given"
        )
        if not passes:
            return at_most(
                self.code,
                math.nan,
                self.tolerance,
                "mm",
                where,
                "the path never passes the points in this order",
            )
        k = max(range(len(passes)), key=lambda k: passes[k][1])
        x, y = self.at[k]
        message = f"{len(passes)} {'point' if len(passes) == 1 else 'points'}, {how}: point {k + 1} ({x:g}, {y:g}) is missed most, "
        message += f"theta {math.degrees(passes[k][0]) % 360 if course.whole else math.degrees(passes[k][0]):.2f} {course.by}"
        return at_most(self.code, passes[k][1], self.tolerance, "mm", where, message)


class Trace(Record):
    """A whole path: it and the wanted one are nowhere further apart than the tolerance, either way."""

    code: ClassVar[str] = "PATH_ERROR"

    at: tuple[tuple[Coordinate, Coordinate], ...] = Field(
        description="places [x, y] as drawn", min_length=2, max_length=20_000
    )
    joined: bool = Field(
        default=True,
        description="true: lines join the places in their order; false: the places are a dense cloud",
    )
    tolerance: Near = Field(
        description="how far the path may lie from the places and their lines, or these from the path"
    )

    def distance(self, course: Course) -> PathDistance:
        """How far the path and the wanted one are apart at most."""
        resolution = _FINE_SHARE * self.tolerance
        return path_distance(
            *course.chords(resolution), np.array(self.places), self.joined, resolution
        )

    @property
    def places(self) -> list[complex]:
        """Corners of the wanted path, or its places, mm."""
        return [complex(*place) for place in self.at]

    def finding(self, course: Course, where: Where) -> Finding:
        """PATH_ERROR: the farthest place of either line, by a bound that holds between all places looked at."""
        distance = self.distance(course)
        x = distance.place.real
        y = distance.place.imag
        message = f"path and wanted {'line' if self.joined else 'points'} are farthest apart at ({x:.4g}, {y:.4g}) of the "
        message += f"{'path' if distance.of_path else 'wanted one'}, {distance.farthest:.6g} mm; proven for all of both lines, not only at the corners"
        return at_most(self.code, distance.proven, self.tolerance, "mm", where, message)


Line = Annotated[tuple[tuple[Coordinate, Coordinate], ...], Field(min_length=2, max_length=20_000)]


class Lines(Record):
    """Lines that a point draws with a pen that another output lifts: nothing beside them, and all of each.

    Where the lift is between `down` and `up` the pen may touch or not: what it could draw there has to lie on the lines, and no place
    of a line may be left to it.
    """

    code: ClassVar[str] = "PATH_ERROR"

    at: Annotated[tuple[Line, ...], Field(min_length=1, max_length=100)] = Field(
        description="lines, each of places [x, y] as drawn, joined in their order"
    )
    lift: str = Field(
        description="the output that lifts the pen: an angle, a place, or the length of a thread"
    )
    down: Value = Field(description="where that output is as the pen touches; beyond it, too")
    up: Value = Field(description="where it is as the pen is clear; beyond it, too")
    tolerance: Near = Field(
        description="how far what is drawn may lie from the lines, or these from it"
    )

    def faults(self, path: Key) -> list[Fault]:
        """What does not go together."""
        if self.up == self.down:
            return [Fault((*path, "up"), f"{self.up:g}", "another place than down")]
        return []

    @property
    def lines(self) -> list[Points]:
        """Corners of each line, (n,) complex mm."""
        return [np.array([complex(*place) for place in line]) for line in self.at]

    def drawn(self, path: Points, lift: Floats) -> list[Points]:
        """Pieces of a path, (n,) complex mm, at which the pen is not clear; lift: (n,) in its unit."""
        clear = (lift - self.down) / (self.up - self.down) >= 1
        touches = np.concatenate([[False], ~(clear[:-1] & clear[1:]), [False]])
        edges = np.flatnonzero(np.diff(touches)).reshape(-1, 2).tolist()
        return [path[begin : end + 1] for begin, end in edges]

    def _raised(self, lift: Course, count: int) -> tuple[Floats, Floats]:
        """Least and greatest lift on each chord, (m - 1,): 0 is down, 1 is up."""
        raised = (lift.corners(count) - self.down) / (self.up - self.down)
        sag = lift.bend / count**2 / abs(self.up - self.down)
        low = np.minimum(raised[:-1], raised[1:]) - sag
        high = np.maximum(raised[:-1], raised[1:]) + sag
        return low, high

    def distance(self, course: Course, lift: Course) -> PathDistance | None:
        """How far lines and what is drawn are apart at most; None where the pen is never down."""
        resolution = _FINE_SHARE * self.tolerance
        count = max(course.count(resolution), lift.count(_OF_LIFT * abs(self.up - self.down)))
        low, high = self._raised(lift, count)
        corners = course.corners(count)
        a = corners[:-1]
        b = corners[1:]
        down = high <= 0
        if not down.any():
            return None
        wanted = [Edges.of_line(line) for line in self.lines]
        target = Edges(
            np.concatenate([each.a for each in wanted]), np.concatenate([each.b for each in wanted])
        )
        touching = Edges.between(a[low < 1], b[low < 1])
        surely = Edges.between(a[down], b[down])
        return _either_way(touching, target, surely, resolution, course.bend / count**2)

    def finding(self, course: Course, where: Where, lift: Course) -> Finding:
        """PATH_ERROR: the farthest place of a line, or of what is drawn, by a bound that holds between all places looked at."""
        apart = self.distance(course, lift)
        if apart is None:
            message = (
                f"the pen is never down: {self.lift} does not come to {self.down:g} {lift.unit}"
            )
            return at_most(self.code, math.nan, self.tolerance, "mm", where, message)
        x = apart.place.real
        y = apart.place.imag
        message = f"lines and what the pen draws are farthest apart at ({x:.4g}, {y:.4g}) of "
        message += (
            f"its path, where {self.lift} does not lift it clear"
            if apart.of_path
            else f"the lines, beyond where {self.lift} has let it down"
        )
        message += (
            f", {apart.farthest:.6g} mm; proven for all of both lines, not only at the corners"
        )
        return at_most(self.code, apart.proven, self.tolerance, "mm", where, message)


class Function(Record):
    """An angle or a place as a function of theta: pairs that go together, both counted from the first one."""

    code: ClassVar[str] = "FUNCTION_ERROR"

    at: tuple[tuple[Angle, Value], ...] = Field(
        description="pairs of theta, deg, and angle or place, deg or mm",
        min_length=2,
        max_length=1000,
    )
    tolerance: Size = Field(description="how far it may differ")

    def finding(self, course: Course, where: Where) -> Finding:
        """FUNCTION_ERROR: the pair that is missed most."""
        theta, target = np.array(self.at).T
        actual = course.at(np.radians(theta))
        off = actual - actual[0] - (target - target[0])
        k = int(np.argmax(np.abs(off)))
        message = f"{len(off)} pairs, counted from the first: at theta {theta[k]:g} {course.by} {actual[k] - actual[0]:.6g} {course.unit}, "
        message += f"{target[k] - target[0]:g} wanted"
        return at_most(self.code, abs(float(off[k])), self.tolerance, course.unit, where, message)


class Straight(Record):
    """How straight a stretch of a path is: the width of the narrowest strip that holds it (ISO 1101)."""

    code: ClassVar[str] = "STRAIGHTNESS"

    tolerance: Near = Field(description="greatest width of the strip")
    range_deg: tuple[Angle, Angle] | None = Field(
        default=None, description="range of theta over which the path should be straight"
    )
    length: Near | None = Field(
        default=None,
        description="in place of range_deg: length of the stretch from end to end; the straightest one "
        "counts",
    )

    def faults(self, path: Key) -> list[Fault]:
        """What does not go together."""
        if (self.range_deg is None) == (self.length is None):
            return [Fault(path, "", "either range_deg or length")]
        if self.range_deg is not None and not 0 < self.range_deg[1] - self.range_deg[0] <= 360:
            return [
                Fault(
                    (*path, "range_deg"),
                    str(list(self.range_deg)),
                    "the least before the greatest, at most a turn apart",
                )
            ]
        return []

    def finding(self, course: Course, where: Where) -> Finding:
        """STRAIGHTNESS."""
        if self.range_deg is not None:
            low, high = np.radians(self.range_deg)
            way = course.at(np.linspace(low, high, len(course.theta)))
            width = strip(way)
            over = f"from {self.range_deg[0]:g} to {self.range_deg[1]:g} {course.by}"
        else:
            assert self.length is not None
            width, begins, ends = straightest(course, self.length)
            over = f"the straightest {self.length:g} mm, from {math.degrees(begins):.1f} to {math.degrees(ends):.1f} {course.by}"
            if math.isnan(width):
                way = course.at(course.theta[:: max(1, len(course.theta) // _WINDOWS)])
                most = magnitude(way[:, None] - way)
                message = f"the path has no stretch of {self.length:g} mm, its places are at most {most:.4g} mm apart: ask for less"
                return at_most(self.code, width, self.tolerance, "mm", where, message)
        return at_most(
            self.code, width, self.tolerance, "mm", where, f"strip that holds the path {over}"
        )


class Dwell(Record):
    """How long an output rests: the longest span of theta over which it stays within a band."""

    code: ClassVar[str] = "DWELL"

    span_deg: Annotated[float, quantity("deg", gt=0, le=360)] = Field(
        description="least span of theta over which it rests"
    )
    band: Size = Field(description="width of the band within which it rests")
    at: Value | None = Field(default=None, description="middle of the band; default: anywhere")

    def finding(self, course: Course, where: Where) -> Finding:
        """DWELL."""
        span, begins = dwell(course, self.band, self.at)
        message = f"longest span within a band of {self.band:g} {course.unit}"
        message += f" about {self.at:g}" if self.at is not None else ""
        message += (
            f", from {math.degrees(begins):.2f} {course.by}" if span > 0 else ": it never is there"
        )
        return at_least(self.code, math.degrees(span), self.span_deg, course.by, where, message)


class TimeRatio(Record):
    """Quick return: time of the slower stroke to that of the quicker one, between the output's extremes."""

    code: ClassVar[str] = "TIME_RATIO"

    value: Annotated[float, quantity("1", ge=1, le=1e3)] = Field(
        description="slower to quicker, 1 or more"
    )
    tolerance: Annotated[float, quantity("1", gt=0, le=1e6)] = Field(
        description="how far it may differ"
    )

    def finding(self, course: Course, where: Where) -> Finding:
        """TIME_RATIO."""
        if not course.strokes:
            return at_most(self.code, math.nan, self.tolerance, "1", where, NO_STROKES)
        actual, least, most = time_ratio(course)
        message = f"ratio {actual:.6g}, {self.value:g} wanted; extremes at {math.degrees(least):.2f} and {math.degrees(most):.2f} deg"
        return at_most(self.code, abs(actual - self.value), self.tolerance, "1", where, message)


class Advance(Record):
    """How far a freewheel turns on in a turn, whose wheel swings to and fro as an angle says."""

    code: ClassVar[str] = "ADVANCE_ERROR"

    value: Annotated[float, quantity("deg", gt=0, le=1e6)] = Field(description="deg, wanted")
    tolerance: Annotated[float, quantity("deg", gt=0, le=1e6)] = Field(
        description="deg, how far it may differ"
    )
    lost: Annotated[float, Field(ge=0, le=360)] = Field(
        default=0.0, description="deg, turn of the wheel before the freewheel locks"
    )
    forwards: Literal[-1, 1] = Field(default=1, description="sense of the angle in which it locks")
    time: Literal[-1, 1] = Field(default=1, description="sense in which theta runs")

    def finding(self, course: Course, where: Where) -> Finding:
        """ADVANCE_ERROR."""
        actual = advance(self.forwards * course.value[:: self.time], self.lost)
        message = (
            f"{actual:.6f} deg a turn, {self.value:g} wanted, with {self.lost:g} deg lost before the freewheel locks; if yours "
            "loses more, the link turns by so much less"
        )
        return at_most(self.code, abs(actual - self.value), self.tolerance, "deg", where, message)


Target = Stroke | Through | Trace | Lines | Function | Straight | Dwell | TimeRatio


def target_findings(
    targets: Sequence[Target | Advance],
    course: Course,
    where: Where,
    course_of: Callable[[str], Course],
) -> Iterator[Finding]:
    """What an output's course is to each of its targets; course_of: another output, at the same theta."""
    for target in targets:
        if isinstance(target, Lines):
            yield target.finding(course, where, course_of(target.lift))
        else:
            yield target.finding(course, where)


@dataclass(frozen=True)
class PathDistance:
    """How far a path and a wanted one are apart at most."""

    place: complex  # the farthest one that was seen, mm
    foot: complex  # the nearest one to it of the other line, mm
    of_path: bool  # whether the farthest one is of the path, not of the wanted one
    proven: float  # mm, no place of either is farther from the other one

    @property
    def farthest(self) -> float:
        """Distance of the farthest place that was seen, mm."""
        return abs(self.place - self.foot)


def path_distance(
    corners: Points, sag: float, wanted: Points, joined: bool, resolution: float
) -> PathDistance:
    """The greatest distance between a path and a wanted one, either way, to the resolution, mm.

    corners: of a line that is no farther than `sag`, mm, from the path; wanted: (n,) complex mm, joined by lines or by itself.
    """
    path = Edges.of_line(corners)
    target = Edges.of_line(wanted) if joined else Edges.of_places(wanted)
    return _either_way(path, target, path, resolution, sag)


def _either_way(
    path: Edges, target: Edges, drawn: Edges, resolution: float, sag: float
) -> PathDistance:
    """How far a path is from what is wanted, and that from what of the path is surely drawn; sag: of edges of the path, mm."""
    fine = max(resolution, _FINEST * max(path.length, target.length))
    forth = stray(path, target, fine)
    back = stray(target, drawn, fine)
    far = forth if forth.farthest >= back.farthest else back
    return PathDistance(far.place, far.foot, far is forth, max(forth.proven, back.proven) + sag)


def one_line(pieces: Sequence[Points]) -> Points:
    """Polylines as one with gaps, (n,) complex."""
    gap = np.array([complex(math.nan, math.nan)])
    return np.concatenate([gap[:0], *(each for piece in pieces for each in (piece, gap))])


def advance(angle: Floats, lost: float) -> float:
    """How far a freewheel turns on in one period of its wheel's angle, (n,), both ends included: it locks where the wheel is
    `lost` further than it has been drawn back, and goes with it from there. In the unit of the angle."""
    ways = angle.tolist()
    ahead = math.inf  # where it locks
    progress = 0.0  # how far it has come
    for k, place in enumerate([*ways, *ways]):  # the first time round it finds its places
        progress = 0.0 if k == len(ways) else progress
        ahead = min(ahead, place + lost)
        if place > ahead:
            progress += place - ahead
            ahead = place
    return progress


def _in_order(
    ways: Sequence[Sequence[tuple[float, float]]], whole: bool
) -> list[tuple[float, float]]:
    """Of each place one of its nearest passes so that theta grows from place to place, the worst distance the least; none
    where there is no such order."""

    def passed(limit: float) -> list[tuple[float, float]] | None:
        for start in (pair for pair in ways[0] if pair[1] <= limit):
            chain = [start]
            end = start[0] + math.tau if whole else math.inf
            for way in ways[1:]:
                later = [
                    (t + turn, away)
                    for t, away in way
                    if away <= limit
                    for turn in ((0.0, math.tau) if whole else (0.0,))
                ]
                later = [pair for pair in later if chain[-1][0] < pair[0] < end]
                if not later:
                    break
                chain.append(min(later))
            else:
                return chain
        return None

    limits = sorted(away for way in ways for _, away in way)
    chain_of_passes = next(
        (chain for limit in limits if (chain := passed(limit)) is not None), None
    )
    return chain_of_passes or []


def strip(places: Points) -> float:
    """Width of the narrowest strip that holds all places, mm: one side of it lies along an edge of their convex hull."""
    return rectangle(places)[1]


def rectangle(places: Points) -> tuple[float, float]:
    """Longer and smaller side of the narrowest rectangle that holds all places, mm: of that strip."""
    hull = places[hull_corners(places.tolist())]
    if len(hull) < 3:
        return magnitude(hull - hull[0]), 0.0
    sides = []
    for a, b in pairwise([*hull, hull[0]]):
        along_edge = (hull - a) * np.conj((b - a) / abs(b - a))
        sides.append((float(np.ptp(along_edge.imag)), float(np.ptp(along_edge.real))))
    width, length = min(sides)
    return length, width


def breadth(places: Points) -> float:
    """How far a path's ways there and back are apart, across its longest extent and in the mean along it, mm.

    places: (n,) complex mm along the path.  0 of a path that returns on itself, such as an arc, but for a hundredth of its length.
    """
    length, direction = extent(places)
    if length == 0.0:
        return 0.0
    turned = places * np.exp(-1j * direction)
    travelled = from_zero(np.abs(np.diff(turned)))
    even = np.linspace(0.0, travelled[-1], _ALONG_PATH)
    along = np.interp(even, travelled, turned.real)
    across = np.interp(even, travelled, turned.imag)
    column = np.minimum((along - along.min()) * (_COLUMNS / length), _COLUMNS - 1).astype(int)
    low = np.full(_COLUMNS, np.inf)
    high = np.full(_COLUMNS, -np.inf)
    np.minimum.at(low, column, across)
    np.maximum.at(high, column, across)
    return float(np.mean(high - low))


def extent(places: Points) -> tuple[float, float]:
    """Largest distance of two places, mm, and the direction of the line through them, rad in (-pi/2, pi/2].

    places: (n,) complex mm.  Of a round path, which has many such lines, the one of the least direction.
    """
    hull = places[hull_corners(places.tolist())]
    squares = np.subtract.outer(hull.real, hull.real) ** 2
    squares += np.subtract.outer(hull.imag, hull.imag) ** 2
    row, column = np.nonzero(squares >= squares.max() * (1 - 4 * _ROUND))
    across = hull[row] - hull[column]
    across = np.where((across.real > 0) | ((across.real == 0) & (across.imag > 0)), across, -across)
    size = magnitude(across)
    longest = across[np.abs(across) >= size * (1 - _ROUND)]
    return size, float(np.angle(longest).min()) if size else 0.0


def straightest(course: Course, length: float) -> tuple[float, float, float]:
    """Of all stretches of a path whose ends are `length` mm apart the narrowest strip: width, theta of both ends; nan where
    there is none."""
    n = _WINDOWS
    span = course.theta[-1] - course.theta[0]
    theta = course.theta[0] + np.arange(2 * n + 1 if course.whole else n + 1) * (span / n)
    z = course.at(theta)
    strips = []
    for i in range(n):
        ahead = z[i : i + n + 1] - z[i]
        far = np.flatnonzero(np.abs(ahead) >= length)
        if far.size:
            end = int(far[0])
            strips.append(
                (
                    float(np.ptp((ahead[: end + 1] * np.conj(ahead[end])).imag) / abs(ahead[end])),
                    i,
                    i + end,
                )
            )
    closer = [
        (strip(z[i : j + 1]), float(theta[i]), float(theta[j]))
        for _, i, j in sorted(strips)[:_CLOSER]
    ]
    return min(closer, default=(math.nan, math.nan, math.nan))


def dwell(course: Course, band: float, at: float | None = None) -> tuple[float, float]:
    """Longest span of theta, rad, over which a real output stays within a band, and where it begins."""
    n = (len(course.theta) - 1) * _FINE
    theta = np.linspace(course.theta[0], course.theta[-1], n + 1)
    if course.whole:
        theta = np.concatenate([theta, theta[1:] + (theta[-1] - theta[0])])
    value = course.at(theta)
    step = theta[1] - theta[0]
    best = 0.0
    begins = float(theta[0])
    if at is not None:
        edges = np.flatnonzero(
            np.diff(np.concatenate([[False], np.abs(value - at) <= band / 2, [False]]))
        )
        for i, j in edges.reshape(-1, 2):
            if (j - 1 - i) * step > best:
                best = float((j - 1 - i) * step)
                begins = float(theta[i])
    else:
        low: list[int] = []  # of the window, growing values; high: falling ones
        high: list[int] = []
        first = heads = tails = 0
        for k, x in enumerate(value.tolist()):
            while len(low) > heads and value[low[-1]] >= x:
                low.pop()
            while len(high) > tails and value[high[-1]] <= x:
                high.pop()
            low.append(k)
            high.append(k)
            while value[high[tails]] - value[low[heads]] > band:
                first += 1
                heads += low[heads] < first
                tails += high[tails] < first
            if (k - first) * step > best:
                best = float((k - first) * step)
                begins = float(theta[first])
    return min(best, float(course.theta[-1] - course.theta[0])), begins


def time_ratio(course: Course) -> tuple[float, float, float]:
    """Time of the slower stroke to that of the quicker, and theta of the least and the greatest place, rad."""
    least = course.extreme(-1)[0]
    most = course.extreme(1)[0]
    forth = (most - least) % math.tau
    return max(forth, math.tau - forth) / max(min(forth, math.tau - forth), 1e-300), least, most
