"""The motion of a pen that draws a line over one turn: rounded within a tolerance, with the least peak acceleration.

    rounding   the line by its length, convolved with four boxes: a cubic B-spline, which leaves it by no more than its share
    time law   |acceleration| = 1 wherever it can be: v^2 <= 1 / curvature and d(v^2)/ds <= 2 sqrt(1 - (v^2 curvature)^2), forwards and
               backwards from the slowest place; the pen slows down at corners of itself. Scaled to one turn.
    smoothing  the place over the angle, convolved with four boxes again: the switches of that law jump in acceleration
[Bobrow, Dubowsky, Gibson 1985: time-optimal motion along a path]
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from camgen.numerics import Floats, Points, halved
from camgen.tolerances import SAME_POINT

_PLACES = 8192  # of the line, and of the turn
_SHARE = 0.5  # of the tolerance, that the rounding takes
_WIDEST = 0.5  # of the whole, that a window takes
_STEPS = 24  # halvings of a window
_NEAR = 1 / 20  # of its size: a line whose ends are nearer is closed
_SMALLEST = 1.0  # mm across


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


def pen_motion(line: Points, tolerance: float) -> Points:
    """Places of the pen at even angles of one turn, its end left out, (m,) complex mm: within the tolerance of the closed line.

    line: corners, (n,) complex mm, without the first again. The deviation counts both ways, of the line from the motion too.
    """
    closed = np.append(line, line[0])
    length = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(closed)))])
    along = np.linspace(0, length[-1], _PLACES, endpoint=False)
    even = _between(along, length, closed)
    exact = _between(np.unique(np.concatenate([along, length[:-1]])), length, closed)
    rounded = _smoothed(even, lambda z: apart(z, exact) <= _SHARE * tolerance)
    theta = _time_law(rounded)
    turn = np.linspace(0, theta[-1], _PLACES, endpoint=False)
    timed = _between(turn, theta, np.append(rounded, rounded[0]))
    return _smoothed(timed, lambda z: apart(z, exact) <= tolerance)


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


def _smoothed(places: Points, within: Callable[[Points], bool]) -> Points:
    """The places convolved with four boxes of the widest window that keeps within."""
    spectrum = np.fft.fft(places)
    k = np.fft.fftfreq(len(places), 1 / len(places))

    def smooth(window: float) -> Points:
        return np.asarray(np.fft.ifft(spectrum * np.sinc(k * window / 4) ** 4))

    too_wide = halved(lambda w: not within(smooth(w)), 0.0, _WIDEST, _STEPS)
    return smooth(too_wide - _WIDEST / 2**_STEPS)


def _time_law(places: Points) -> Floats:
    """Angle at each of the places and at the first again, (n + 1,), on a scale of its own."""
    k = np.fft.fftfreq(len(places), 1 / len(places))
    spectrum = np.fft.fft(places)
    first, second = (np.fft.ifft((2j * math.pi * k) ** order * spectrum) for order in (1, 2))
    rate = np.maximum(np.abs(first), 1e-9 * np.abs(first).max())
    curvature = np.abs((first.conj() * second).imag) / rate**3
    steps = np.abs(np.roll(places, -1) - places)
    fastest = 1 / np.maximum(curvature, 1e-9 / steps.sum())
    start = int(np.argmin(fastest))
    order = (start + np.arange(len(places))) % len(places)
    square = _run_up(fastest[order], curvature[order], steps[order])
    back = order[::-1]
    square = np.minimum(
        square, _run_up(fastest[back], curvature[back], np.roll(steps, 1)[back])[::-1]
    )
    speed = np.empty(len(places))
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
