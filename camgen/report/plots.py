"""Plots of the report as SVG: axes, grid, curves and the names of marks.

Colours and dashes are classes that the page defines, so that one picture serves light, dark and print. A curve that lies
on another is drawn once, under both names; one that only oscillates between two bounds is drawn as the band between them.
Same plot, same text.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape

import numpy as np

from camgen.numerics import Floats, Points
from camgen.study import Plot

_BAND_STEPS = 120  # along x: a band is as wide as the curve is high in each
_REVERSALS = 150  # of direction, from which on a curve is a band

_WIDTH = 336.0
_HEIGHT = 198.0
# the axes' frame, y downwards
_LEFT = 46.0
_RIGHT = 322.0
_TOP = 22.0
_LOW = 164.0
# of a curve's height as a share of its values, below which zero is shown beside it: of amounts, and of places
_EVEN = 0.1
_EVEN_PLACE = 1e-4
_FINE = 0.05  # how far a drawn curve may be off
_ALIKE = 0.5  # curves that are nowhere farther apart are drawn once
# of a mark's name: width of a letter, the wide ones of DejaVu Sans among them, and height of a row
_LETTER = 6.6
_ROW = 12.0
_LINE = 9.0  # least from a number beside the axis to the next
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


@dataclass(frozen=True)
class _Curve:
    """What is drawn of one or more series: its names, its points in the picture (y downwards), and what they are."""

    label: str
    points: Points
    kind: str  # "curve", "band" or "dots"
    upper: int = 0  # of a band: how many points are its upper edge


def ticks(low: float, high: float, most: int = 6) -> list[float]:
    """Round numbers, 1, 2, 2.5 or 5 times a power of ten apart, within two bounds."""
    if not (math.isfinite(low) and math.isfinite(high) and high > low):
        return []
    power = 10.0 ** math.floor(math.log10((high - low) / most))
    step = next(
        power * f for f in (1, 2, 2.5, 5, 10, 20) if (high - low) / (power * f) <= most + 1e-9
    )
    first = math.ceil(low / step - 1e-9)
    return [step * k for k in range(first, math.floor(high / step + 1e-9) + 1)]


def plot_figure(plot: Plot, own: str = "plot") -> str:
    """The plot as a figure of the page: title, keys with room for the values at the cursor, picture; own: begins its ids."""
    drawn, curves = _picture(plot)
    keys = "".join(
        f'<li class="s{k % 6}"><svg class="k" viewBox="0 0 22 8" aria-hidden="true"><path class="curve" d="M0 4h22"/></svg>'
        f"{escape(curve.label)}{'' if plot.levels else ' <output></output>'}</li>"
        for k, curve in enumerate(curves)
    )
    cursor = f'<path class="cursor" d="M0 {_TOP:g}V{_LOW:g}"/>' if plot.turns else ""
    state = " turn" if plot.turns else ""
    return (
        f'<figure class="plot{state}"><figcaption>{escape(plot.title.replace("_", " "))}</figcaption><ul class="keys">{keys}</ul>'
        f"<svg {_attributes(plot, f'0 0 {_WIDTH:g} {_HEIGHT:g}', own)}{drawn}{cursor}</svg></figure>"
    )


def _attributes(plot: Plot, box: str, own: str = "plot") -> str:
    """Attributes, title and description of the picture."""
    names = ", ".join(label for label, _, _ in plot.series)
    return (
        f'class="plotted" viewBox="{box}" role="img" aria-labelledby="{own}-t {own}-d"><title id="{own}-t">{escape(plot.title)}'
        f'</title><desc id="{own}-d">{escape(plot.y_label)} over {escape(plot.x_label)}: {escape(names)}</desc>'
    )


class _Axes:
    """From numbers to places in the picture."""

    def __init__(self, plot: Plot) -> None:
        self.x = _spread(*(plot.ends or (0.0, 1.0)), 0.0) if not plot.turns else (0.0, 360.0)
        values = np.concatenate(
            [[y for _, _, y in plot.points], *(np.asarray(y, float) for _, _, y in plot.series)]
        )
        values = values[np.isfinite(values)]
        low, high = (float(values.min()), float(values.max())) if len(values) else (0.0, 1.0)
        nearly_even = _EVEN_PLACE if plot.places else _EVEN
        if not plot.equal and 0 < high - low < nearly_even * max(abs(low), abs(high)):
            low, high = min(low, 0.0), max(high, 0.0)  # a share of the whole is to be seen
        self.y = low, high
        self.y = _spread(*self.y, 0.05)
        if plot.equal:  # the smaller range grows, so that a millimetre is as long both ways
            across = (_RIGHT - _LEFT) / (self.x[1] - self.x[0])
            up = (_LOW - _TOP) / (self.y[1] - self.y[0])
            scale = min(across, up) * 0.95
            self.x, self.y = (
                (sum(ends) / 2 - size / scale / 2, sum(ends) / 2 + size / scale / 2)
                for ends, size in ((self.x, _RIGHT - _LEFT), (self.y, _LOW - _TOP))
            )
        self.rows = _label_rows(plot, self.x)
        if self.rows:  # room for the names of marks above the curves
            share = (max(self.rows) + 1) * _ROW / (_LOW - _TOP)
            self.y = self.y[0], self.y[1] + share / (1 - share) * (self.y[1] - self.y[0])

    def place(self, x: Floats, y: Floats) -> Points:
        """Places of points (n,), y downwards."""
        x = np.asarray(x, float)
        y = np.asarray(y, float)
        x0, x1 = self.x
        y0, y1 = self.y
        across = _LEFT + (x - x0) / (x1 - x0) * (_RIGHT - _LEFT)
        return np.asarray(across + 1j * (_LOW - (y - y0) / (y1 - y0) * (_LOW - _TOP)))


def _spread(low: float, high: float, share: float) -> tuple[float, float]:
    """Two bounds with so much room beyond them; never of no length, nor so short that rounding shows."""
    size = max(abs(low), abs(high))
    if high - low <= 1e-9 * size or size == 0:
        half = 0.05 * size or 1.0
        return low - half, high + half
    return low - share * (high - low), high + share * (high - low)


def _picture(plot: Plot) -> tuple[str, list[_Curve]]:
    """The picture's inside, and the curves in it."""
    axes = _Axes(plot)
    curves = _curves(plot, axes)
    pieces = [_grid(plot, axes), *(_path(k, curve) for k, curve in enumerate(curves))]
    for (label, x), row in zip(plot.marks, axes.rows, strict=True):
        at = axes.place(np.array([x]), np.array([1.0]))[0].real
        inside = _fits_right(label, at)
        side = 'class="start"' if inside else 'class="end"'
        pieces.append(
            f'<path class="mark" d="M{_n(at)} {_n(_TOP)}V{_n(_LOW)}"/><text {side} x="{_n(at + (3 if inside else -3))}" '
            f'y="{_n(_TOP + 9 + _ROW * row)}">{escape(label)}</text>'
        )
    pieces += [
        _point(name, axes.place(np.array([x]), np.array([y]))[0]) for name, x, y in plot.points
    ]
    x0, x1 = axes.x
    y0, y1 = axes.y
    scale = f"{_LEFT:g} {_RIGHT:g} {x0:.9g} {x1:.9g} {_LOW:g} {_TOP:g} {y0:.9g} {y1:.9g}"
    return f'<g class="drawn" data-axes="{scale}">{"".join(pieces)}</g>', curves


def _point(name: str, at: complex) -> str:
    """A point with its name beside it, inside the frame."""
    left = at.real > _RIGHT - _LETTER * (len(name) + 1)
    side, x = ('class="end"', at.real - 4) if left else ('class="start"', at.real + 4)
    return (
        f'<circle class="named" cx="{_n(at.real)}" cy="{_n(at.imag)}" r="2"/><text {side} x="{_n(x)}" '
        f'y="{_n(max(at.imag - 3, _TOP + 9))}">{escape(name)}</text>'
    )


def _grid(plot: Plot, axes: _Axes) -> str:
    """Grid, frame, numbers and what the axes show."""
    size = max(map(abs, axes.y))
    power = 0 if 1e-3 <= size < 1e5 else math.floor(math.log10(size))
    unit = plot.y_label.replace("^2", "²").replace("^3", "³") + (
        f" · 10{str(power).translate(_RAISED)}" if power else ""
    )
    angles = [45.0 * k for k in range(9)] if plot.turns else ticks(*axes.x, 7)
    shown = 10.0**power
    x_ticks = [(t, _text(t, axes.x)) for t in angles]
    y_ticks = [(y, escape(text)) for text, y in plot.levels] or [
        (t, _text(t / shown, (axes.y[0] / shown, axes.y[1] / shown))) for t in ticks(*axes.y)
    ]
    x0, x1 = axes.x
    y0, y1 = axes.y
    across = [_LEFT + (t - x0) / (x1 - x0) * (_RIGHT - _LEFT) for t, _ in x_ticks]
    up = [_LOW - (t - y0) / (y1 - y0) * (_LOW - _TOP) for t, _ in y_ticks]
    rules = "".join(f"M{_n(x)} {_TOP:g}V{_LOW:g}" for x in across) + "".join(
        f"M{_LEFT:g} {_n(y)}H{_RIGHT:g}" for y in up
    )
    below = "".join(
        f'<text x="{_n(x)}" y="{_LOW + 15:g}">{text}</text>'
        for x, (_, text) in zip(across, x_ticks, strict=True)
    )
    numbers = list[str]()
    last = math.inf
    for y, (_, text) in sorted(zip(up, y_ticks, strict=True), reverse=True):
        if last - y >= _LINE:
            numbers.append(f'<text x="{_LEFT - 6:g}" y="{_n(y + 4)}">{text}</text>')
            last = y
    beside = "".join(numbers)
    return (
        f'<path class="rule" d="{rules}"/><path class="frame" d="M{_LEFT:g} {_TOP:g}V{_LOW:g}H{_RIGHT:g}"/>'
        f'<g class="mid">{below}</g><g class="end">{beside}<text x="{_RIGHT:g}" y="{_HEIGHT - 6:g}">{escape(plot.x_label)}</text>'
        f'</g><text x="4" y="13">{escape(unit)}</text>'
    )


def _text(value: float, ends: tuple[float, float]) -> str:
    return f"{0 if abs(value) < 1e-9 * (ends[1] - ends[0]) else value:.10g}".replace("-", "−")


def _n(value: float) -> str:
    """A place in the picture."""
    return f"{value:z.2f}".rstrip("0").rstrip(".")


def _curves(plot: Plot, axes: _Axes) -> list[_Curve]:
    """The series as they are drawn, those that lie on one another once."""
    groups: list[tuple[list[str], Floats, Floats, Points]] = []
    for label, x, y in plot.series:
        x = np.asarray(x, float)
        y = np.asarray(y, float)
        y = np.where(np.isfinite(y), y, np.nan)
        places = axes.place(x, y)
        for labels, x_before, _, drawn in groups:
            gap = np.abs(places - drawn) if np.array_equal(x, x_before) else np.full(1, np.inf)
            if (
                np.array_equal(np.isnan(places), np.isnan(drawn))
                and len(gap)
                and not np.nanmax(gap, initial=0.0) > _ALIKE
            ):
                labels.append(label)
                break
        else:
            groups.append(([label], x, y, places))
    return [
        _curve(_common_label(labels, plot.sources), x, y, axes, labels[0] in plot.dots)
        for labels, x, y, _ in groups
    ]


def _common_label(labels: Sequence[str], sources: Mapping[str, tuple[str, str]]) -> str:
    """One name for curves that are the same: "x wanted", "x from DXF" are "x wanted = DXF"."""
    if len(labels) == 1:
        return labels[0]
    parts = [sources.get(label, ("", label)) for label in labels]
    first = parts[0][0]
    names = (name if what == first else f"{what} {name}".strip() for what, name in parts)
    return f"{first} {' = '.join(names)}".strip()


def _curve(label: str, x: Floats, y: Floats, axes: _Axes, dots: bool) -> _Curve:
    if dots:
        return _Curve(label, axes.place(x, y), "dots")
    places = axes.place(x, y)
    steps = np.diff(places.imag)
    if np.isfinite(places).all() and np.count_nonzero(steps[1:] * steps[:-1] < -0.25) > _REVERSALS:
        edges = np.linspace(0, len(y), _BAND_STEPS + 1).astype(int)
        rows = [(x[a], x[b - 1], y[a:b].min(), y[a:b].max()) for a, b in itertools.pairwise(edges)]
        left, right, low, high = (np.array(column) for column in zip(*rows, strict=True))
        middle = np.concatenate([left[:1], (left[1:] + right[:-1]) / 2, right[-1:]])
        # at each border of two steps the wider of both, so that the band holds the whole curve
        lower = np.minimum(np.append(low, low[-1]), np.append(low[:1], low))
        upper = np.maximum(np.append(high, high[-1]), np.append(high[:1], high))
        top = simplification(axes.place(middle, upper), _FINE)
        bottom = simplification(axes.place(middle, lower), _FINE)
        return _Curve(label, np.concatenate([top, bottom[::-1]]), "band", len(top))
    return _Curve(label, places, "curve")


def simplification(points: Points, tolerance: float) -> Points:
    """Some of the points (n,), so that none is farther than the tolerance from the line through them [Douglas, Peucker 1973]."""
    kept = np.zeros(len(points), bool)
    kept[[0, -1]] = True
    open_ends = [(0, len(points) - 1)]
    while open_ends:
        a, b = open_ends.pop()
        if b - a < 2:
            continue
        chord = points[b] - points[a]
        inner = points[a + 1 : b] - points[a]
        size = abs(chord)
        off = np.abs((np.conj(chord) * inner).imag) / size if size > 1e-9 else np.abs(inner)
        k = int(np.argmax(off))
        if off[k] > tolerance:
            kept[a + 1 + k] = True
            open_ends += [(a, a + 1 + k), (a + 1 + k, b)]
    return points[kept]


def _path(k: int, curve: _Curve) -> str:
    """Markup of a curve; a band says how many of its points are the upper edge."""
    group = f'<g class="s{k % 6}">'
    if curve.kind == "dots":
        known = curve.points[np.isfinite(curve.points)]
        return (
            group
            + "".join(
                f'<circle class="dots" cx="{_n(z.real)}" cy="{_n(z.imag)}" r="2.2"/>' for z in known
            )
            + "</g>"
        )
    if curve.kind == "band":
        return f'{group}<path class="band" data-upper="{curve.upper}" d="M{_line(curve.points)}Z"/></g>'
    known = np.isfinite(curve.points)
    starts = np.flatnonzero(known & ~np.append(False, known[:-1]))
    stops = np.flatnonzero(known & ~np.append(known[1:], False)) + 1
    pieces = [simplification(curve.points[a:b], _FINE) for a, b in zip(starts, stops, strict=True)]
    return f'{group}<path class="curve" d="{"".join("M" + _line(piece) for piece in pieces)}"/></g>'


def _line(points: Points) -> str:
    return "L".join(f"{_n(z.real)} {_n(z.imag)}" for z in points)


def _fits_right(label: str, at: float) -> bool:
    """Whether a mark's name has room to the right of it, in the frame."""
    return at + 3 + _LETTER * len(label) <= _RIGHT


def _label_rows(plot: Plot, ends: tuple[float, float]) -> list[int]:
    """The row, from the top, in which each mark's name stands clear of those before it."""
    taken: list[list[tuple[float, float]]] = []
    rows = []
    for label, x in plot.marks:
        at = (_RIGHT - _LEFT) * (x - ends[0]) / (ends[1] - ends[0])
        wide = _LETTER * len(label) + 6
        left = at if _fits_right(label, _LEFT + at) else at - wide
        free = [
            k for k, row in enumerate(taken) if all(left >= b or left + wide <= a for a, b in row)
        ]
        row = free[0] if free else len(taken)
        if not free:
            taken.append([])
        taken[row].append((left, left + wide))
        rows.append(row)
    return rows
