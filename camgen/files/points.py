"""Measured points round an outline, from a coordinate measuring machine or a dial gauge: a CSV of x, y or angle, radius."""

from __future__ import annotations

import csv
import math
import re
from pathlib import Path

import numpy as np

from camgen.bounds import Bound
from camgen.errors import FileError
from camgen.geometry.rings import Floats, Points, Ring

# Names of columns, less their unit, in the order in which a pair is looked for.
_PAIRS = (("x", "y"), ("angle", "radius"), ("theta", "radius"), ("angle", "r"), ("theta", "r"))
_LEAST, _MOST = 24, 200_000  # points
POINTS_SIZE = Bound("a table of points", 20_000_000, most=_MOST + 1_000)
_GAP = 0.125  # of the outline's length
_CHORDS = 14_400  # over the turn
_BEYOND = 1e6  # mm
_GROWS = 1.6  # times what is missed, at twice the step: less is scatter, which does not grow, more a corner (2.8) or a curve
_MISSES = 1.33  # times the scatter, of a point from the cubic spline half way between others that scatter as much
_ROUNDING = 1e-6  # mm, of written coordinates
_ROUND = 64  # chords of a quarter of the probe's ball


def read_points(path: Path, content: bytes, probe: float = 0.0) -> tuple[Ring, float, str]:
    """Outline through measured points, what the curve between them may be off, mm, and a sentence.

    probe: radius of the ball whose centres the points are, mm: the outline lies so much further in, 0 where it was allowed for.

    The first line names the columns, x and y in mm as they follow each other round the outline, or angle in degrees and radius
    in mm in any order; the curve is a cubic spline through every point. FileError where it holds none.
    """
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise FileError(path, "is no table: it is not text in UTF-8") from None
    first = text.lstrip().partition("\n")[0]
    cut = next((each for each in (";", "\t", ",") if each in first), ",")
    try:
        lines = enumerate(csv.reader(text.splitlines(), delimiter=cut), 1)
        rows = [(number, row) for number, row in lines if any(map(str.strip, row))]
    except csv.Error as error:
        raise FileError(path, f"is no table: {error}") from None
    named = [re.sub(r"[\s_(\[]*(mm|deg|°)[)\]]*$", "", cell.strip().lower()) for cell in rows[0][1]]
    pair = next((pair for pair in _PAIRS if set(pair) <= set(named)), None)
    if pair is None:
        raise FileError(path, f"begins with {first.strip()[:60]!r}: columns x,y or angle,radius were expected")
    if len(rows) - 1 > _MOST:
        raise FileError(path, f"holds {len(rows) - 1} points; {_MOST} at most are taken")
    places = [named.index(name) for name in pair]
    values = []
    for number, row in rows[1:]:
        try:
            each = [float(row[place].replace(",", ".") if cut == ";" else row[place]) for place in places]
        except (ValueError, IndexError):
            raise FileError(path, f"line {number}: two numbers, {pair[0]} and {pair[1]}, were expected") from None
        if not all(abs(value) < _BEYOND for value in each):
            raise FileError(path, f"line {number}: {pair[0]} and {pair[1]} within +-{_BEYOND:g} were expected")
        values.append(each)
    if len(values) < _LEAST:
        raise FileError(path, f"holds {len(values)} points; {_LEAST} at least were expected, all round the outline")
    table = np.array(values)
    z = table[:, 0] + 1j * table[:, 1]
    if pair != ("x", "y"):
        if (table[:, 1] <= 0).any():
            raise FileError(path, f"line {rows[1 + int(np.argmin(table[:, 1]))][0]}: a radius above 0 was expected")
        z = table[:, 1] * np.exp(1j * np.radians(table[:, 0]))
        z = z[np.argsort(table[:, 0] % 360, kind="stable")]
    z = z[np.abs(z - np.roll(z, 1)) > 1e-9]
    steps = np.abs(np.roll(z, -1) - z)
    worst = int(np.argmax(steps)) if len(z) >= _LEAST else 0
    if len(z) < _LEAST or steps[worst] > _GAP * steps.sum():
        where = f"from {z[worst]:.3f} to {z[(worst + 1) % len(z)]:.3f}" if len(z) else "throughout"
        remedy = "measure all round, and list x, y in the order in which they follow each other"
        raise FileError(path, f"has a gap of {steps.max(initial=0):.3f} mm {where}: {remedy}")
    even = z[: len(z) // 2 * 2]
    missed = [np.max(np.abs(_half_way(kept) - left)) for kept, left in
              ((even[::2], even[1::2]), (even[1::2], np.roll(even[::2], -1)))]  # fmt: skip
    off = float(max(missed)) / 2  # by every second point; at half the step a corner is off half as much, a smooth curve less
    noise = _scatter(even)
    edge = _curve(z, max(1, math.ceil(_CHORDS / len(z))))
    said = f"{len(z)} measured points, {steps.max():.3f} mm apart at most; "
    said += f"the curve between them may be {off:.4f} mm off" if not noise else (
        f"they scatter by {noise:.2g} mm (standard deviation) and the curve passes through each, up to {off:.4f} mm off: more "
        "points do not help, smoothed ones do; pressure angles and accelerations show it most"
    )  # fmt: skip
    if probe:
        edge = _further_in(path, edge, probe)
        said += f"; they are centres of a probe's ball, whose radius of {probe:g} mm is taken off"
    return Ring(edge, np.zeros(len(edge))), off, said


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

    moved = shapely.Polygon(np.column_stack([edge.real, edge.imag])).buffer(-distance, quad_segs=_ROUND)
    if not isinstance(moved, shapely.Polygon) or moved.is_empty:
        raise FileError(path, f"has an outline of which a probe of radius {distance:g} mm leaves not one piece")
    return np.asarray(shapely.get_coordinates(moved.exterior)[:-1] @ np.array([1, 1j]))


def _half_way(z: Points) -> Points:
    """The curve half way between each point and the next, (n,)."""
    return _curve(z, 2)[1::2]


def _curve(z: Points, parts: int) -> Points:
    """Cubic spline through points, closed, each span in so many parts, (parts n,)."""
    from scipy.interpolate import CubicSpline

    closed = np.append(z, z[0])
    knots: Floats = np.concatenate([[0], np.cumsum(np.abs(np.diff(closed)))])
    spline = CubicSpline(knots, np.column_stack([closed.real, closed.imag]), bc_type="periodic")
    at = knots[:-1, None] + np.diff(knots)[:, None] * np.arange(parts) / parts
    x, y = spline(at.ravel()).T
    return np.asarray(x + 1j * y)
