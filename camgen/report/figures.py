"""Plots of the report as SVG, the only importer of matplotlib.

Colours are left to the page: each is written as a CSS variable with a value for a page that sets none, so that one
picture serves light, dark and print. Series differ in dashes too, never in colour alone.
"""

from __future__ import annotations

import io
import re
import zlib
from html import escape
from typing import Any

import numpy as np

from camgen.geometry.outlines import Floats
from camgen.study import Plot

# Twice this many points, the least and the greatest of each step, are all that a plot some 400 points wide can show.
STEPS = 360

_WIDTH, _HEIGHT = 432.0, 252.0  # pt
_LEFT, _RIGHT, _LOW, _TOP = 66.0, 422.0, 42.0, 222.0  # the axes' frame, pt from the lower left corner

_LETTER, _ROW = 4.6, 10.0  # pt, of a mark's name: mean width of a letter, height of a row

_INK, _GRID = "#010203", "#040506"
_SERIES = ("#0b62a8", "#b5541c", "#2c7a4b", "#7a3e9d", "#8a6d00", "#a8326e")
_DASHES: tuple[Any, ...] = ("-", (0, (5, 2)), (0, (1, 1.2)), (0, (7, 2, 1.2, 2)), (0, (9, 3)), (0, (3, 1, 1, 1, 1, 1)))
_COLOURS = {
    _INK: "var(--ink, #1d2530)",
    _GRID: "var(--grid, #dfe4ea)",
    **{colour: f"var(--s{k}, {colour})" for k, colour in enumerate(_SERIES)},
}
_STYLE: dict[str, Any] = {
    "svg.fonttype": "none",
    "svg.hashsalt": "camgen",
    "svg.image_inline": True,
    "text.parse_math": False,
    "text.usetex": False,
    "font.family": ["sans-serif"],
    "font.size": 10.0,
    "path.simplify": True,
    "axes.edgecolor": _INK,
    "axes.labelcolor": _INK,
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": _GRID,
    "grid.linewidth": 0.7,
    "text.color": _INK,
    "xtick.color": _INK,
    "ytick.color": _INK,
    "xtick.major.size": 0.0,
    "ytick.major.size": 0.0,
    "legend.frameon": False,
    "legend.labelcolor": _INK,
}


def thinned(x: Floats, y: Floats) -> tuple[Floats, Floats]:
    """At most 2 STEPS + a few of the points (n,), with the least and the greatest of each step and every gap (nan)."""
    x, y = np.asarray(x, float), np.asarray(y, float)
    if len(x) <= 2 * STEPS:
        return x, y
    edges = np.linspace(0, len(x), STEPS + 1).astype(int)
    known = np.isfinite(y)
    low, high = np.where(known, y, np.inf), np.where(known, y, -np.inf)
    kept = [0, len(x) - 1]
    for a, b in zip(edges[:-1], edges[1:], strict=True):
        kept += [a + int(np.argmin(low[a:b])), a + int(np.argmax(high[a:b])), a + int(np.argmin(known[a:b]))]
    # argmin of `known` is a gap where there is one, else the step's first point: dropped unless it is a gap.
    order = np.unique([k for n, k in enumerate(kept) if n < 2 or (n - 2) % 3 < 2 or not known[k]])
    return x[order], y[order]


def plot_svg(plot: Plot, log: bool = False) -> str:
    """The plot as an SVG element to stand in a page, or alone as a file; same plot, same text. log: both axes logarithmic.

    An x axis that covers a turn gets ticks of 45 deg and a `cursor` line that the page's script moves.
    """
    import matplotlib
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    # A user's own matplotlibrc must not change the picture.
    settings: Any = {key: value for key, value in matplotlib.rcParamsDefault.items() if not key.startswith("backend")}
    with matplotlib.rc_context(settings | _STYLE):
        figure = Figure((_WIDTH / 72, _HEIGHT / 72), dpi=72, frameon=False)
        canvas: Any = FigureCanvasSVG(figure)
        axes = figure.add_axes((_LEFT / _WIDTH, _LOW / _HEIGHT, (_RIGHT - _LEFT) / _WIDTH, (_TOP - _LOW) / _HEIGHT), frameon=True)
        axes.patch.set_visible(False)
        turn = _draw(axes, plot, log)
        text = io.StringIO()
        canvas.print_svg(text, metadata=dict.fromkeys(("Date", "Creator", "Format", "Type")))
    return _tidied(text.getvalue(), plot, turn)


def _draw(axes: Any, plot: Plot, log: bool) -> bool:
    """Fill the axes; True where x covers one turn in degrees."""
    for k, (label, x, y) in enumerate(plot.series):
        style = {"color": _SERIES[k % 6], "linestyle": _DASHES[k % 6], "linewidth": 1.8 if k == 0 else 1.5}
        x, y = thinned(x, y)
        axes.plot(x, np.where(np.isfinite(y), y, np.nan), label=label, **style)
    ends = [float(bound) for _, x, _ in plot.series if len(x) for bound in (np.min(x), np.max(x))]
    turn = bool(ends) and -1 < min(ends) < 15 and 345 < max(ends) < 361
    if turn:
        axes.set_xlim(0, 360)
        axes.set_xticks(range(0, 361, 45))
    elif plot.equal:
        axes.set_aspect("equal", adjustable="datalim")
    elif ends and min(ends) < max(ends):
        axes.set_xlim(min(ends), max(ends))
    low, high = axes.get_ylim()
    rows = _label_rows(plot, axes.get_xlim())
    if rows:  # room for their names above the curves
        share = (max(rows) + 1) * _ROW / (_TOP - _LOW)
        high += max(0.1, share / (1 - share)) * (high - low)
        axes.set_ylim(low, high)

    def number(value: float, _: object) -> str:
        return f"{0 if abs(value) < 1e-9 * (high - low) else value:.10g}".replace("-", "−")

    if log:
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.xaxis.set_major_formatter("{x:g}")
        axes.yaxis.set_major_formatter("{x:g}")
    else:
        axes.yaxis.set_major_formatter(number)
        axes.yaxis.set_major_locator(_ticks(6))
    axes.set_xlabel(plot.x_label)
    axes.set_ylabel(plot.y_label)
    for (label, x_mark), row in zip(plot.marks, rows, strict=True):
        axes.axvline(x_mark, color=_INK, linewidth=0.7, linestyle=(0, (2, 2)))
        # On the side where there is room.
        inside = x_mark < sum(axes.get_xlim()) / 2
        axes.annotate(
            label, (x_mark, 1), (3 if inside else -3, -2 - _ROW * row), xycoords=("data", "axes fraction"),
            textcoords="offset points", va="top", ha="left" if inside else "right", fontsize=8.5,
        )  # fmt: skip
    if (count := len(plot.series)) > 1:
        # One row of names where they fit (a letter is about 5 pt), else two: the room above the axes.
        columns = count if sum(36 + 5 * len(label) for label, _, _ in plot.series) < _RIGHT - _LEFT else (count + 1) // 2
        axes.legend(
            loc="lower left", bbox_to_anchor=(0, 1), ncols=columns, borderpad=0, borderaxespad=0.4,
            handlelength=2.4, columnspacing=1.4, fontsize=9,
        )  # fmt: skip
    return turn


def _label_rows(plot: Plot, ends: tuple[float, float]) -> list[int]:
    """The row, from the top, in which each mark's name stands clear of those before it."""
    taken: list[list[tuple[float, float]]] = []
    rows = []
    for label, x in plot.marks:
        at, wide = (_RIGHT - _LEFT) * (x - ends[0]) / (ends[1] - ends[0]), _LETTER * len(label) + 6
        left = at if x < sum(ends) / 2 else at - wide
        free = [k for k, row in enumerate(taken) if all(left >= b or left + wide <= a for a, b in row)]
        row = free[0] if free else len(taken)
        if not free:
            taken.append([])
        taken[row].append((left, left + wide))
        rows.append(row)
    return rows


def _ticks(count: int) -> Any:
    from matplotlib.ticker import MaxNLocator

    return MaxNLocator(count, steps=[1, 2, 2.5, 5, 10])


def _tidied(text: str, plot: Plot, turn: bool) -> str:
    """matplotlib's file as an element: title, colours as variables, no ids but those referred to, unique in a page."""
    body = text[text.index("<svg") :]
    body = body[body.index(">") + 1 : body.rindex("</svg>")]
    referred = set(re.findall(r"#([mp][0-9a-f]+)", body))
    own = f"p{zlib.crc32((plot.title + text).encode()):08x}"
    body = re.sub(r' id="([^"]*)"', lambda m: f' id="{own}-{m[1]}"' if m[1] in referred else "", body)
    body = re.sub(r"#([mp][0-9a-f]+)\b(?=[)\"])", rf"#{own}-\1", body)
    body = re.sub(r"font: ([0-9.]+px) [^;\"]*", r"font-size: \1", body)
    body = re.sub(r"font-family: [^;\"]*;? ?", "", body)
    body = re.sub(r"#[0-9a-f]{6}\b", lambda m: _COLOURS.get(m[0], m[0]), body)
    body = re.sub(r" ?\n\s*", " ", body)
    names = ", ".join(label for label, _, _ in plot.series)
    cursor = (
        f'<line class="cursor" data-width="{_RIGHT - _LEFT:g}" x1="{_LEFT:g}" x2="{_LEFT:g}" y1="{_HEIGHT - _TOP:g}" '
        f'y2="{_HEIGHT - _LOW:g}" stroke="none"/>'
    )
    return (
        '<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" '
        f'viewBox="0 0 {_WIDTH:g} {_HEIGHT:g}" font-family="system-ui, sans-serif" role="img" '
        f'aria-labelledby="{own}-t {own}-d"><title id="{own}-t">{escape(plot.title)}</title>'
        f'<desc id="{own}-d">{escape(plot.y_label)} over {escape(plot.x_label)}: {escape(names)}</desc>'
        f"{body.strip()}{cursor if turn else ''}</svg>"
    )
