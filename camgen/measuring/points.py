"""Measured points round an outline, from a coordinate measuring machine or a dial gauge: a CSV of x, y or angle, radius.

span      from a point to the next
corner    where an outline turns by more in one span than the spans beside it tell: a sharp tip
run       points from corner to corner, through which one cubic spline goes; it is drawn on to where it meets the next one
"""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from camgen.bounds import Bound
from camgen.errors import FileError, counted
from camgen.geometry.rings import Floats, Points, Ring
from camgen.numerics import coordinates, from_zero

# Names of columns, less their unit, in the order in which a pair is looked for.
_PAIRS = (("x", "y"), ("angle", "radius"), ("theta", "radius"), ("angle", "r"), ("theta", "r"))
# points
_LEAST = 24
_MOST = 200_000
POINTS_SIZE = Bound("a table of points", 20_000_000, most=_MOST + 1_000)
_GAP = 0.125  # of the outline's length
_CHORDS = 14_400  # over the turn
_BEYOND = 1e6  # mm
_GROWS = 1.6  # times what is missed, at twice the step: less is scatter, which does not grow, more a corner (2.8) or a curve
_MISSES = 1.33  # times the scatter, of a point from the cubic spline half way between others that scatter as much
_ROUNDING = 1e-6  # mm, of written coordinates
_ROUND = 64  # chords of a quarter of the probe's ball
_SHARP = math.radians(
    3
)  # by which a span turns more than those beside it, at least, to be a corner
_STANDS_OUT = 4.0  # times the difference between the spans beside it
_SIDE = 5  # points on either side that have to be smooth
_ON = 3.0  # times what a spline misses of its own next point, within which a point lies on it
_LONGER = 1.5  # times the span before a corner, that the way to it may be
_TIMES = 20  # steps to where two splines meet


def read_points(path: Path, content: bytes, probe: float = 0.0) -> tuple[Ring, float, str]:
    """Outline through measured points, what the curve between them may be off, mm, and a sentence.

    probe: radius of the ball whose centres the points are, mm: the outline lies so much further in, 0 where it was allowed for.

    The first line names the columns, x and y in mm as they follow each other round the outline, or angle in degrees and radius
    in mm in any order; the curve is a cubic spline through every point, from corner to corner. FileError where it holds none.
    """
    z = _places(path, content)
    steps = np.abs(np.roll(z, -1) - z)
    worst = int(np.argmax(steps)) if len(z) >= _LEAST else 0
    if len(z) < _LEAST or steps[worst] > _GAP * steps.sum():
        where = f"from {z[worst]:.3f} to {z[(worst + 1) % len(z)]:.3f}" if len(z) else "throughout"
        remedy = "measure all round, and list x, y in the order in which they follow each other"
        raise FileError(path, f"has a gap of {steps.max(initial=0):.3f} mm {where}: {remedy}")
    even = z[: len(z) // 2 * 2]
    misses = [
        np.max(np.abs(_half_way(kept) - left))
        for kept, left in ((even[::2], even[1::2]), (even[1::2], np.roll(even[::2], -1)))
    ]
    off = (
        float(max(misses)) / 2
    )  # by every second point; at half the step a corner is off half as much, a smooth curve less
    noise = _scatter(even)
    curve = Curve.through(z)
    edge = curve.chords(max(1, math.ceil(_CHORDS / len(z))))
    remark = f"{len(z)} measured points, {steps.max():.3f} mm apart at most; "
    remark += (
        f"{counted(len(curve.corners), 'sharp corner')} between them; " if curve.corners else ""
    )
    remark += (
        f"the curve between them may be {off:.4f} mm off"
        if not noise
        else (
            f"they scatter by {noise:.2g} mm (standard deviation) and the curve passes through each, up to {off:.4f} mm off: more "
            "points do not help, smoothed ones do; pressure angles and accelerations show it most"
        )
    )
    if probe:
        edge = _further_in(path, edge, probe)
        remark += f"; they are centres of a probe's ball, whose radius of {probe:g} mm is taken off"
    return Ring.straight(edge), off, remark


def _places(path: Path, content: bytes) -> Points:
    """The points of a table in their order, (n,) mm; FileError where it is none."""
    header, rows, separator = _rows(path, content)
    cells = rows[0][1]
    names = [re.sub(r"[\s_(\[]*(mm|deg|°)[)\]]*$", "", cell.strip().lower()) for cell in cells]
    pair = next((pair for pair in _PAIRS if set(pair) <= set(names)), None)
    if pair is None:
        raise FileError(
            path, f"begins with {header.strip()[:60]!r}: columns x,y or angle,radius were expected"
        )
    if len(rows) - 1 > _MOST:
        raise FileError(path, f"holds {len(rows) - 1} points; at most {_MOST} are taken")
    columns = [names.index(name) for name in pair]
    both = f"{pair[0]} and {pair[1]}"
    values = []
    for number, row in rows[1:]:
        try:
            texts = [row[column] for column in columns]
            each = [float(text.replace(",", ".") if separator == ";" else text) for text in texts]
        except (ValueError, IndexError):
            raise FileError(path, f"line {number}: two numbers, {both}, were expected") from None
        if not all(abs(value) < _BEYOND for value in each):
            raise FileError(path, f"line {number}: {both} within +-{_BEYOND:g} were expected")
        values.append(each)
    if len(values) < _LEAST:
        raise FileError(
            path,
            f"holds {len(values)} points; at least {_LEAST} were expected, all round the outline",
        )
    table = np.array(values)
    z = table[:, 0] + 1j * table[:, 1]
    if pair != ("x", "y"):
        angle, radius = table.T
        if (radius <= 0).any():
            line = rows[1 + int(np.argmin(radius))][0]
            raise FileError(path, f"line {line}: a radius above 0 was expected")
        z = (radius * np.exp(1j * np.radians(angle)))[np.argsort(angle % 360, kind="stable")]
    return np.asarray(z[np.abs(z - np.roll(z, 1)) > 1e-9])


def _rows(path: Path, content: bytes) -> tuple[str, list[tuple[int, list[str]]], str]:
    """The first line of a table, its rows with cells, each with its line's number from 1, and what separates its cells."""
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise FileError(path, "is no table: it is not text in UTF-8") from None
    header = text.lstrip().partition("\n")[0]
    separator = next((each for each in (";", "\t", ",") if each in header), ",")
    try:
        lines = enumerate(csv.reader(text.splitlines(), delimiter=separator), 1)
        rows = [(number, row) for number, row in lines if any(map(str.strip, row))]
    except csv.Error as error:
        raise FileError(path, f"is no table: {error}") from None
    return header, rows, separator


def _scatter(z: Points) -> float:
    """Standard deviation of points across their curve, mm; 0 where the way between them is more.

    Of points that scatter every second one misses the others as every fourth one does; of a curve that is only sampled an even
    share of what is missed goes with each halving: half of a corner, 1/16 of a smooth curve.
    """
    z = z[: len(z) // 4 * 4]
    if len(z) < 2 * _LEAST:
        return 0.0
    near, far = (_missed_by(z, step) for step in (1, 2))
    return near / _MISSES if far < _GROWS * near and near > _ROUNDING else 0.0


def _missed_by(z: Points, step: int) -> float:
    """How far points lie across the curve through others, so many before and behind them, mm: root of the mean square."""
    kept = z[:: 2 * step]
    chord = np.roll(kept, -1) - kept
    across = ((_half_way(kept) - z[step :: 2 * step]) * np.conj(chord) / np.abs(chord)).imag
    return float(np.sqrt(np.mean(across**2)))


def _further_in(path: Path, edge: Points, distance: float) -> Points:
    """An outline moved inwards, mm; FileError where not one piece is left."""
    import shapely

    area = shapely.Polygon(coordinates(edge)).buffer(-distance, quad_segs=_ROUND)
    if not isinstance(area, shapely.Polygon) or area.is_empty:
        raise FileError(
            path,
            f"has an outline that is not one piece without a probe's radius of {distance:g} mm",
        )
    return np.asarray(shapely.get_coordinates(area.exterior)[:-1] @ np.array([1, 1j]))


def _half_way(z: Points) -> Points:
    """The curve half way between each point and the next, (n,)."""
    return Curve.through(z).at(np.arange(len(z)), np.full(len(z), 0.5))


# ---- the curve -------------------------------------------------------------------------------------------------------

Spline = Callable[
    ..., Any
]  # of the way along the points, mm: x and y, (n, 2); nu: order of the derivative


@dataclass(frozen=True)
class Corner:
    """Where two runs meet: in a span, so far from its first point and from its second one along them, mm; a point that is a
    corner is the end of its span."""

    span: int
    before: float
    after: float
    place: complex


@dataclass(frozen=True)
class Curve:
    """A closed curve through points, smooth but at its corners."""

    knots: Floats  # way along the points from the first one, which follows the first corner, (n + 1,) mm
    first: int  # index of the first point
    runs: Sequence[
        tuple[int, int, Spline]
    ]  # spans of each, counted from the first point, and the spline through them
    corners: Sequence[Corner]  # in their order, the last one in the last span

    @classmethod
    def through(cls, z: Points) -> Curve:
        """Through points in their order, (n,) complex mm."""
        corners = _corners(z)
        first = 0 if not corners else (corners[-1].span + 1) % len(z)
        points = np.roll(z, -first)
        closed = np.append(points, points[0])
        knots = from_zero(np.abs(np.diff(closed)))
        if not corners:
            return cls(knots, 0, [(0, len(z), _spline(knots, closed, "periodic"))], [])
        corners = [replace(each, span=(each.span - first) % len(z)) for each in corners]
        runs = []
        begin = 0
        for each in corners:
            last = each.span + (
                2 if each.after == 0 else 1
            )  # a point that is itself the corner belongs to both runs
            runs.append(
                (begin, each.span + 1, _spline(knots[begin:last], closed[begin:last], "not-a-knot"))
            )
            begin = each.span + 1
        return cls(knots, first, runs, corners)

    def at(self, spans: Any, shares: Floats) -> Points:
        """Points of spans, counted as the points are, at shares of their length, (n,)."""
        spans = (np.asarray(spans) - self.first) % (len(self.knots) - 1)
        whole = np.diff(self.knots)[spans]
        way = self.knots[spans] + shares * whole
        run = spans.copy()
        for corner in self.corners:
            at_corner = spans == corner.span
            distance = shares * (corner.before + corner.after)
            after = at_corner & (distance > corner.before)
            way[at_corner] = self.knots[corner.span] + distance[at_corner]
            way[after] = (self.knots[corner.span + 1] - corner.after + distance - corner.before)[
                after
            ]
            run[after] = (corner.span + 1) % (len(self.knots) - 1)
        way = np.where((run == 0) & (spans == len(self.knots) - 2), way - self.knots[-1], way)
        points = np.empty(len(spans), complex)
        for begin, end, spline in self.runs:
            at_corner = (run >= begin) & (run < end)
            x, y = spline(way[at_corner]).T
            points[at_corner] = x + 1j * y
        return points

    def chords(self, parts: int) -> Points:
        """Corners of a polygon along it: each span in so many parts, and every corner itself, (n,)."""
        count = len(self.knots) - 1
        spans = np.repeat(np.arange(count), parts)
        shares = np.tile(np.arange(parts) / parts, count)
        places = self.at(spans, shares)
        inside = [corner for corner in self.corners if corner.after]
        for each in sorted(inside, key=lambda corner: -((corner.span + self.first) % count)):
            span = (each.span + self.first) % count
            fraction = each.before / (each.before + each.after)
            places = np.insert(places, span * parts + math.floor(fraction * parts) + 1, each.place)
        return places[np.abs(places - np.roll(places, 1)) > 1e-9]


def _spline(knots: Floats, z: Points, ends: str) -> Spline:
    """Cubic spline through points, with their ways along them."""
    from scipy.interpolate import CubicSpline

    return CubicSpline(knots, coordinates(z), bc_type=ends)  # type: ignore[no-any-return]


def _corners(z: Points) -> list[Corner]:
    """Where the outline turns by more in a span than the spans beside it tell, and both sides meet there."""
    if len(z) < 4 * _SIDE:
        return []
    chord = np.roll(z, -1) - z
    turn = np.angle(chord * np.conj(np.roll(chord, 1)))  # at each point
    span_turn = turn + np.roll(turn, -1)  # over each span
    beside = np.array([np.roll(span_turn, shift) for shift in (-4, -3, -2, 2, 3, 4)])
    more = np.abs(span_turn - np.median(beside, axis=0))
    out = (more > _SHARP) & (more > _STANDS_OUT * np.ptp(beside, axis=0))
    corners: list[Corner] = []
    for span in np.flatnonzero(
        out & (more >= np.roll(more, 1)) & (more > np.roll(more, -1))
    ).tolist():
        corner = _met(z, span)
        away = [(corner.span - other.span) % len(z) for other in corners] if corner else []
        if corner is not None and all(2 * _SIDE <= each <= len(z) - 2 * _SIDE for each in away):
            corners.append(corner)
    return sorted(corners, key=lambda corner: corner.span)


def _met(z: Points, span: int) -> Corner | None:
    """Where the curves through the points before a span and after it meet; None where they do not."""
    whole = abs(z[(span + 1) % len(z)] - z[span])
    earlier = abs(z[span] - z[span - 1])
    later = abs(z[(span + 2) % len(z)] - z[(span + 1) % len(z)])
    before, missed_before = _side(z, span, -1)
    after, missed_after = _side(z, (span + 1) % len(z), 1)
    if abs(_place(after, -whole) - z[span]) <= _ON * missed_after + _ROUNDING:
        return Corner((span - 1) % len(z), earlier, 0.0, complex(z[span]))
    if abs(_place(before, whole) - z[(span + 1) % len(z)]) <= _ON * missed_before + _ROUNDING:
        return Corner(span, whole, 0.0, complex(z[(span + 1) % len(z)]))
    u = whole / 2
    v = -whole / 2
    for _ in range(_TIMES):
        gap = _place(before, u) - _place(after, v)
        before_slope = _place(before, u, 1)
        after_slope = _place(after, v, 1)
        across = (np.conj(before_slope) * after_slope).imag
        if abs(across) < 1e-12:
            return None
        # apart + one du - other dv = 0
        u -= (np.conj(gap) * after_slope).imag / across
        v -= (np.conj(gap) * before_slope).imag / across
    close = abs(_place(before, u) - _place(after, v)) < _ROUNDING * max(1.0, whole)
    inside = 0 < u < _LONGER * earlier and 0 < -v < _LONGER * later
    return (
        Corner(span, float(u), float(-v), complex(_place(before, u))) if close and inside else None
    )


def _side(z: Points, end: int, step: int) -> tuple[Spline, float]:
    """The spline through the points on one side of a span, by the way from the one at its end, and what the same through all
    but that one misses of it, mm. step: +1 for the points that follow."""
    points = z[(end + step * np.arange(_SIDE + 1)) % len(z)]
    ways = step * from_zero(np.abs(np.diff(points)))
    order = slice(None, None, step)
    whole = _spline(ways[:-1][order], points[:-1][order], "not-a-knot")
    less = _spline(ways[1:][order], points[1:][order], "not-a-knot")
    return whole, float(abs(_place(less, 0.0) - points[0]))


def _place(spline: Spline, way: float, order: int = 0) -> complex:
    x, y = spline(way, order)
    return complex(x, y)
