"""The motion of a pen that draws a line over one turn: rounded within a tolerance, with the least peak acceleration.

    rounding   the line by its length, convolved with four boxes: a cubic B-spline, which leaves it by no more than its share
    time law   |acceleration| = 1 wherever it can be: v^2 <= 1 / curvature and d(v^2)/ds <= 2 sqrt(1 - (v^2 curvature)^2), forwards and
               backwards from the slowest place; the pen slows down at corners of itself. Scaled to one turn.
    smoothing  the place over the angle, convolved with four boxes again: the switches of that law jump in acceleration
    stops      where the pen stops at corners, the line from one to the next is rounded by itself, mirrored in both ends, and the pen
               rests at each for as long as the window of the smoothing is wide: it is in the corner then, and nothing is cut off
[Bobrow, Dubowsky, Gibson 1985: time-optimal motion along a path]
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from camgen.numerics import Floats, Indices, Points, halved
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
    size = max(np.ptp(z.real), np.ptp(z.imag)) if z.size else 0.0
    if z.size < 3 or size < _SMALLEST:
        return None
    if width is not None:
        z = z * (width / np.ptp(z.real))
        size = max(np.ptp(z.real), np.ptp(z.imag))
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


def pen_motion(line: Points, tolerance: float, corners: Corners = "round") -> Points:
    """Places of the pen at even angles of one turn, its end left out, (m,) complex mm: within the tolerance of the closed line.

    line: corners, (n,) complex mm, without the first again. The deviation counts both ways, of the line from the motion too.
    """
    stops = _sharp(line) if corners == "stop" else np.zeros(0, np.intp)
    if stops.size:
        line = np.roll(line, -stops[0])
    ways, exact = _ways(line, stops - stops[:1])

    def rounded(window: float) -> list[_Way]:
        return [each.rounded(window) for each in ways]

    def off(found: Sequence[_Way]) -> float:
        return apart(np.concatenate([each.places for each in found]), exact)

    ways = rounded(_widest(lambda w: off(rounded(w)) <= _SHARE * tolerance, _WIDEST))
    timed = _time_law(ways, stops.size > 0)
    widest = _RESTS / stops.size if stops.size else _WIDEST
    return timed(_widest(lambda w: apart(timed(w), exact) <= tolerance, widest))


def _sharp(line: Points) -> Indices:
    """Which corners of a closed line are sharp."""
    steps = np.roll(line, -1) - line
    return np.flatnonzero(np.abs(np.angle(steps / np.roll(steps, 1))) > _SHARP)


def _ways(line: Points, stops: Indices) -> tuple[list[_Way], Points]:
    """Of a closed line between its stops, the first of which it begins with, and its places, among them all corners."""
    closed = np.append(line, line[0])
    length = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(closed)))])
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
        tree = cKDTree(np.column_stack([line.real, line.imag]))
        nearest = tree.query(np.column_stack([places.real, places.imag]))[1]
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
    return float(np.abs(np.fft.ifft(-(k**2) * np.fft.fft(places))).max())


def _smoothed(places: Points, window: float) -> Points:
    """Places of a period convolved with four boxes, which are a window of it together."""
    k = np.fft.fftfreq(len(places), 1 / len(places))
    return np.asarray(np.fft.ifft(np.fft.fft(places) * np.sinc(k * window / 4) ** 4))


def _widest(within: Callable[[float], bool], most: float) -> float:
    """The widest window that keeps within."""
    too_wide = halved(lambda w: not within(w), 0.0, most, _STEPS)
    return too_wide - most / 2.0**_STEPS


def _time_law(ways: Sequence[_Way], stops: bool) -> Callable[[float], Points]:
    """The places at even angles of a turn, smoothed by a window of it; where each way begins, the pen rests for as long if it stops."""
    places = np.concatenate([each.places for each in ways])
    counts = [len(each.places) for each in ways]
    starts = np.array(np.cumsum(counts) - counts if stops else [], np.intp)
    curvature = np.concatenate([each.curvature for each in ways])
    steps = np.abs(np.roll(places, -1) - places)
    fastest = 1 / np.maximum(curvature, 1e-9 / steps.sum())
    fastest[starts] = 0.0
    theta = _fastest(fastest, curvature, steps)
    closed = np.append(places, places[0])
    passed = np.searchsorted(starts, np.arange(theta.size), side="right")

    def timed(window: float) -> Points:
        rest = window * theta[-1] / (1 - window * len(starts))
        whole = theta[-1] + rest * len(starts)
        left = theta + rest * (passed - 0.5 * stops)
        at = np.insert(left, starts[1:], left[starts[1:]] - rest)
        turn = np.linspace(0, whole, _PLACES, endpoint=False)
        return _smoothed(
            _between(turn, at, np.insert(closed, starts[1:], places[starts[1:]])), window
        )

    return timed


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
    return np.concatenate([[0.0], np.cumsum(np.minimum(steps / mean, stopped))])


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
