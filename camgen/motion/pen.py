"""The motion of a pen that draws a line over one turn: rounded within a tolerance, with the least peak acceleration.

    rounding   the line by its length, convolved with four boxes: a cubic B-spline, which leaves it by no more than its share
    time law   |acceleration| = 1 wherever it can be: v^2 <= 1 / curvature and d(v^2)/ds <= 2 sqrt(1 - (v^2 curvature)^2), forwards and
               backwards from the slowest place; the pen slows down at corners of itself. Scaled to one turn.
    smoothing  the place over the angle, convolved with four boxes again: the switches of that law jump in acceleration
    stops      where the pen stops at corners, the line from one to the next is rounded by itself, mirrored in both ends, and the pen
               rests at each for as long as the window of the smoothing is wide: it is in the corner then, and nothing is cut off
    strokes    of several lines the pen stops at both ends of each, and rests there for longer, while it is let down or lifted; it goes
               straight from one to the next
[Bobrow, Dubowsky, Gibson 1985: time-optimal motion along a path]
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from camgen.numerics import (
    Floats,
    Indices,
    Points,
    coordinates,
    from_zero,
    halved,
    magnitude,
    spread,
)
from camgen.tolerances import SAME_POINT

_PLACES = 8192  # of the line, and of the turn
_SHARE = 0.5  # of the tolerance, that the rounding takes
_WIDEST = 0.5  # of the whole, that a window takes
_STEPS = 24  # halvings of a window
_NEAR = 1 / 20  # of its size: a line whose ends are nearer is closed
_SMALLEST = 1.0  # mm across
_SHARP = math.radians(40)  # by which a line turns at a corner, at least
_RESTS = 1 / 8  # of a turn, that the pen rests at most
_LEAST_PLACES = 64  # of the way between two corners

Corners = Literal["round", "stop"]


def closed_line(places: Points, width: float | None = None) -> Points | None:
    """Corners of a line that a pen draws over and over, the first not repeated, mm; None of one that is too small, or of no 3 places.

    places: of a line in order, (n,) complex mm; an open one is drawn there and back. width: its width, mm, in place of its own.
    """
    z = places[np.abs(np.diff(places, prepend=np.nan)) != 0]
    size = spread(z) if z.size else 0.0
    if z.size < 3 or size < _SMALLEST:
        return None
    if width is not None:
        z = z * (width / np.ptp(z.real))
        size = spread(z)
    gap = abs(z[-1] - z[0])
    if gap < _NEAR * size:
        return np.asarray(z[:-1] if gap < SAME_POINT else z)
    return np.concatenate([z, z[-2:0:-1]])


@dataclass(frozen=True)
class _Way:
    """Of the pen, at even lengths: all of a closed line, or from one stop to the next.

    start: where it begins; advance: to where it ends, 0 where it comes back; count: of its places; wave: what these have beside those,
    (n,), periodic: behind a stop it is the same as before it, turned by half a turn. period: of the wave, of the length of the whole
    line.
    """

    start: complex
    advance: complex
    count: int
    wave: Points
    period: float

    @property
    def places(self) -> Points:
        """From its start on, its end left out."""
        share = np.arange(self.count) / self.count
        return np.asarray(self.start + self.advance * share + self.wave[: self.count])

    @property
    def curvature(self) -> Floats:
        """At its places, 1/mm."""
        k = np.fft.fftfreq(len(self.wave), 1 / len(self.wave))
        spectrum = np.fft.fft(self.wave)
        first, second = (np.fft.ifft((2j * math.pi * k) ** order * spectrum) for order in (1, 2))
        first += 2 * self.advance
        rate = np.maximum(np.abs(first), 1e-9 * np.abs(first).max())
        return np.asarray((np.abs((first.conj() * second).imag) / rate**3)[: self.count])

    def rounded(self, window: float) -> _Way:
        """The same within a window, of the length of the whole line."""
        return replace(self, wave=_smoothed(self.wave, window / self.period))


def strokes_in_order(lines: Sequence[Points]) -> list[Points]:
    """Lines as a pen draws them, one after the other with short ways between: some turned round, closed ones begun at another corner.

    lines: corners of each, (n,) complex mm, n > 1; of a closed one the first again at its end. Each time the nearest end is next, from
    whichever line makes the sum of the ways' square roots, which their times go by, the least. What goes on where another ends is one.
    """
    tours = [_tour(lines, first) for first in range(len(lines))]
    return min(tours, key=lambda tour: sum(math.sqrt(way) for way in _gaps(tour)))


def _gaps(tour: Sequence[Points]) -> list[float]:
    """Ways of the lifted pen, mm, the last one back to the first stroke."""
    return [float(abs(b[0] - a[-1])) for a, b in zip(tour, [*tour[1:], tour[0]], strict=True)]


def _tour(lines: Sequence[Points], first: int) -> list[Points]:
    """All lines, the nearest end next."""
    rest = [line for k, line in enumerate(lines) if k != first]
    tour = [lines[first]]
    while rest:
        end = tour[-1][-1]
        begun = [_begun(line, end) for line in rest]
        k = int(np.argmin([abs(line[0] - end) for line in begun]))
        rest.pop(k)
        if abs(begun[k][0] - end) < SAME_POINT:
            tour[-1] = np.concatenate([tour[-1], begun[k][1:]])
        else:
            tour.append(begun[k])
    return tour


def _begun(line: Points, at: complex) -> Points:
    """A line, or the same the other way round, from its end that is nearest; of a closed one from its corner."""
    if abs(line[-1] - line[0]) < SAME_POINT:
        ring = np.roll(line[:-1], -int(np.argmin(np.abs(line[:-1] - at))))
        return np.append(ring, ring[0])
    return line if abs(line[0] - at) <= abs(line[-1] - at) else line[::-1]


@dataclass(frozen=True)
class Lifting:
    """What lifting a pen takes of a turn, as shares of it."""

    rest: float  # for which the pen is still at each end of a stroke
    up: float  # from one such rest to the next, at least, while it is lifted
    down: float  # between the rests of a stroke, at least


@dataclass(frozen=True)
class LiftedMotion:
    """The motion of a pen that is lifted: it begins within the first stroke.

    places: at even angles of a turn, its end left out, (m,) complex mm. ends: the middle of the rest at which each stroke begins, and of
    that at which it ends, (n, 2) rad; the first stroke begins before the turn.
    """

    places: Points
    ends: Floats


def strokes_motion(
    strokes: Sequence[Points], tolerance: float, corners: Corners, lifting: Lifting
) -> LiftedMotion:
    """The motion of a pen along strokes in their order, within the tolerance of each.

    strokes: corners of each, (n,) complex mm, n > 1, no two alike in a row; of a closed one the first again at its end.
    """
    line = np.concatenate(strokes)
    sizes = np.array([len(stroke) for stroke in strokes])
    firsts = np.cumsum(sizes) - sizes
    ends = np.column_stack([firsts, firsts + sizes - 1])
    sharp = _sharp(line) if corners == "stop" else np.zeros(0, np.intp)
    stops = np.union1d(sharp, ends)
    numbers = np.searchsorted(stops, ends.ravel())  # of the ends among the stops
    rests = np.zeros(stops.size)
    rests[numbers] = lifting.rest
    ways = zip(numbers, [*numbers[1:], stops.size], strict=True)
    spans = tuple(
        _Span(int(a), int(b), (lifting.down, lifting.up)[k % 2]) for k, (a, b) in enumerate(ways)
    )
    law, window = _moved(line, stops, tolerance, rests, spans)
    middles = law.middles(window)[numbers].reshape(-1, 2)
    begin = round(float(middles[0].mean()) * _PLACES)
    middles = middles - begin / _PLACES
    return LiftedMotion(np.roll(law.at(window), -begin), math.tau * middles)


def pen_motion(line: Points, tolerance: float, corners: Corners = "round") -> Points:
    """Places of the pen at even angles of one turn, its end left out, (m,) complex mm: within the tolerance of the closed line.

    line: corners, (n,) complex mm, without the first again. The deviation counts both ways, of the line from the motion too.
    """
    stops = _sharp(line) if corners == "stop" else np.zeros(0, np.intp)
    if stops.size:
        line = np.roll(line, -stops[0])
    law, window = _moved(line, stops - stops[:1], tolerance, np.zeros(stops.size), ())
    return law.at(window)


def _moved(
    line: Points, stops: Indices, tolerance: float, rests: Floats, spans: tuple[_Span, ...]
) -> tuple[_TimeLaw, float]:
    """The time law along a closed line that begins at its first stop, and the widest window that keeps to the tolerance."""
    ways, exact = _ways(line, stops)

    def rounded(window: float) -> list[_Way]:
        return [each.rounded(window) for each in ways]

    def off(found: Sequence[_Way]) -> float:
        return apart(np.concatenate([each.places for each in found]), exact)

    ways = rounded(_widest(lambda w: off(rounded(w)) <= _SHARE * tolerance, _WIDEST))
    law = _time_law(ways, rests, spans)
    widest = _RESTS / stops.size if stops.size else _WIDEST
    return law, _widest(lambda w: apart(law.at(w), exact) <= tolerance, widest)


def _sharp(line: Points) -> Indices:
    """Which corners of a closed line are sharp."""
    steps = np.roll(line, -1) - line
    return np.flatnonzero(np.abs(np.angle(steps / np.roll(steps, 1))) > _SHARP)


def _ways(line: Points, stops: Indices) -> tuple[list[_Way], Points]:
    """Of a closed line between its stops, the first of which it begins with, and its places, among them all corners."""
    closed = np.append(line, line[0])
    length = from_zero(np.abs(np.diff(closed)))
    along = np.linspace(0, length[-1], _PLACES, endpoint=False)
    exact = _between(np.unique(np.concatenate([along, length[:-1]])), length, closed)
    if not stops.size:
        return [_Way(0j, 0j, _PLACES, _between(along, length, closed), 1.0)], exact
    ends = np.append(stops, line.size)
    ways = []
    for first, last in zip(ends[:-1].tolist(), ends[1:].tolist(), strict=True):
        share = (length[last] - length[first]) / length[-1]
        count = max(_LEAST_PLACES, round(share * _PLACES))
        places = _between(np.linspace(length[first], length[last], count + 1), length, closed)
        advance = complex(closed[last] - closed[first])
        wave = places - places[0] - advance * np.arange(count + 1) / count
        whole = np.concatenate([wave[:-1], -wave[:0:-1]])
        ways.append(_Way(complex(places[0]), advance, count, whole, 2 * share))
    return ways, exact


def _between(at: Floats, along: Floats, places: Points) -> Points:
    """Places between others that lie at `along`, on lines."""
    return np.asarray(np.interp(at, along, places.real) + 1j * np.interp(at, along, places.imag))


def apart(one: Points, other: Points) -> float:
    """The most by which a dense closed line leaves another one, either way, mm; its places are joined by lines."""
    from scipy.spatial import cKDTree

    def off(places: Points, line: Points) -> float:
        ends = np.roll(line, -1)
        tree = cKDTree(coordinates(line))
        nearest = tree.query(coordinates(places))[1]
        distance = np.full(places.shape, math.inf)
        for k in (nearest - 1, nearest):
            edge = ends[k] - line[k]
            size = np.abs(edge) ** 2
            share = ((places - line[k]) * edge.conj()).real / np.where(size > 0, size, 1.0)
            distance = np.minimum(distance, np.abs(places - line[k] - np.clip(share, 0, 1) * edge))
        return float(distance.max())

    return max(off(one, other), off(other, one))


def peak_acceleration(places: Points) -> float:
    """Greatest acceleration of places at even angles of a turn, mm/rad^2."""
    k = np.fft.fftfreq(len(places), 1 / len(places))
    return magnitude(np.fft.ifft(-(k**2) * np.fft.fft(places)))


def _smoothed(places: Points, window: float) -> Points:
    """Places of a period convolved with four boxes, which are a window of it together."""
    k = np.fft.fftfreq(len(places), 1 / len(places))
    return np.asarray(np.fft.ifft(np.fft.fft(places) * np.sinc(k * window / 4) ** 4))


def _widest(within: Callable[[float], bool], most: float) -> float:
    """The widest window that keeps within."""
    too_wide = halved(lambda w: not within(w), 0.0, most, _STEPS)
    return too_wide - most / 2.0**_STEPS


@dataclass(frozen=True)
class _Span:
    """From one stop to another, by their numbers, and the share of a turn that it takes at least, rests at both left out."""

    first: int
    last: int
    least: float


@dataclass(frozen=True)
class _TimeLaw:
    """When the pen is where, but for the smoothing; a window of that, a share of a turn, is how long it rests at each stop besides.

    places: (n,) complex mm; theta: there and at the first again, (n + 1,), on a scale of its own; starts: the places of stops.
    rests: at each stop beside the window, shares of a turn.
    """

    places: Points
    theta: Floats
    starts: Indices
    rests: Floats
    spans: tuple[_Span, ...]

    def middles(self, window: float) -> Floats:
        """Of the rest at each stop, share of a turn; the turn begins in the middle of the first."""
        theta, rests = self._timing(window)
        return theta[self.starts] + (np.cumsum(rests) - rests / 2) - rests[:1] / 2

    def at(self, window: float) -> Points:
        """The places at even angles of a turn, smoothed by the window."""
        theta, rests = self._timing(window)
        begun = np.cumsum(np.concatenate([[0.0], rests]))
        passed = np.searchsorted(self.starts, np.arange(theta.size), side="right")
        left = theta + begun[passed] - rests[:1].sum() / 2
        later = self.starts[1:]
        at = np.insert(left, later, left[later] - rests[1:])
        closed = np.append(self.places, self.places[0])
        even = np.linspace(0, 1, _PLACES, endpoint=False)
        return _smoothed(_between(even, at, np.insert(closed, later, self.places[later])), window)

    def _timing(self, window: float) -> tuple[Floats, Floats]:
        """Theta without rests, and these, shares of a turn: spans that would be too short are slower, and all others faster."""
        rests = self.rests + window if self.starts.size else self.rests
        bounds = np.append(self.starts, len(self.places))
        at = self.theta[bounds]
        times = np.array([at[each.last] - at[each.first] for each in self.spans])
        least = np.array([each.least for each in self.spans])
        slow = np.zeros(len(self.spans), bool)
        while True:
            whole = (self.theta[-1] - times[slow].sum()) / (1 - rests.sum() - least[slow].sum())
            slower = times < least * whole
            if np.array_equal(slower, slow):
                break
            slow = slower
        steps = np.diff(self.theta) / whole
        for k in np.flatnonzero(slow).tolist():
            span = self.spans[k]
            steps[bounds[span.first] : bounds[span.last]] *= least[k] * whole / times[k]
        return from_zero(steps), rests


def _time_law(ways: Sequence[_Way], rests: Floats, spans: tuple[_Span, ...]) -> _TimeLaw:
    """Of ways one after the other, the least peak acceleration; rests: shares of a turn where each begins, none where none stops."""
    places = np.concatenate([each.places for each in ways])
    counts = [len(each.places) for each in ways]
    starts = np.array(np.cumsum(counts) - counts if rests.size else [], np.intp)
    curvature = np.concatenate([each.curvature for each in ways])
    steps = np.abs(np.roll(places, -1) - places)
    fastest = 1 / np.maximum(curvature, 1e-9 / steps.sum())
    fastest[starts] = 0.0
    return _TimeLaw(places, _fastest(fastest, curvature, steps), starts, rests, spans)


def _fastest(fastest: Floats, curvature: Floats, steps: Floats) -> Floats:
    """Angle at each of the places and at the first again, (n + 1,), on a scale of its own; fastest: greatest speeds there."""
    start = int(np.argmin(fastest))
    order = (start + np.arange(len(steps))) % len(steps)
    square = _run_up(fastest[order], curvature[order], steps[order])
    back = order[::-1]
    square = np.minimum(
        square, _run_up(fastest[back], curvature[back], np.roll(steps, 1)[back])[::-1]
    )
    speed = np.empty(len(steps))
    speed[order] = np.sqrt(square)
    mean = (speed + np.roll(speed, -1)) / 2
    # from rest to rest: where a line turns back, neighbours may both be at rest
    stopped = 2 * np.sqrt(steps)
    return from_zero(np.minimum(steps / mean, stopped))


def _run_up(fastest: Floats, curvature: Floats, steps: Floats) -> Floats:
    """Greatest squares of the speed by a run from the first place on, which the last one closes."""
    squares = fastest.tolist()
    bends = curvature.tolist()
    lengths = steps.tolist()
    for lap in range(2):
        for k in range(len(squares)):
            if lap == 0 and k == 0:
                continue
            before = squares[k - 1]
            across = before * bends[k - 1]
            gain = 2 * lengths[k - 1] * math.sqrt(max(0.0, 1 - across * across))
            squares[k] = min(squares[k], before + gain)
    return np.array(squares)
