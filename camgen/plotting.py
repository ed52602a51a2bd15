"""Static pictures of plots by matplotlib, as a file for a paper or a figure in a notebook; the report's page draws its own.

The same plot gives the same bytes: no date, no chance ids, no settings of the user's.
"""

from __future__ import annotations

import io
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from camgen.study import Plot

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PLOT_FILES = ("svg", "png")  # written of each plot
_SIZE = (6.5, 3.6)  # inches, of a plot
SERIES = ("#0b62a8", "#b5541c", "#2c7a4b", "#7a3e9d", "#8a6d00", "#a8326e")
_DOTS = "os^D"  # shapes of dots, each in all colours
_DASHES = ("-", "--", ":", "-.", (0, (9, 2)), (0, (4, 1, 1, 1, 1, 1)))
_TURN = 360.0  # deg
_STYLE: dict[Any, Any] = {
    "font.family": "DejaVu Sans",  # which matplotlib brings along
    "font.size": 9,
    "axes.titlesize": 10,
    "axes.grid": True,
    "grid.color": "#dfe4ea",
    "lines.linewidth": 1.4,
    "legend.frameon": False,
    "savefig.dpi": 150,
    "svg.fonttype": "none",  # text stays text
    "svg.hashsalt": "camgen",
}


@contextmanager
def _own_style() -> Iterator[None]:
    """Settings of its own, whatever matplotlibrc says."""
    import matplotlib

    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(_STYLE)
        yield


def figure_of(plots: Sequence[Plot], log: bool = False) -> Figure:
    """The plots below each other as a figure, which a notebook shows; log: both axes are logarithmic."""
    from matplotlib.figure import Figure

    class NotebookFigure(Figure):
        """A figure that a notebook shows without pyplot."""

        def _repr_png_(self) -> bytes:
            return image(self, "png")

    with _own_style():
        whole = NotebookFigure(
            figsize=(_SIZE[0], _SIZE[1] * max(1, len(plots))), layout="constrained"
        )
        for row, plot in enumerate(plots, 1):
            _draw(whole.add_subplot(len(plots), 1, row), plot, log)
    return whole


def image(figure: Figure, kind: str) -> bytes:
    """A figure's bytes as "svg" or "png"."""
    from camgen._version import __version__

    maker = "Creator" if kind == "svg" else "Software"
    metadata = {maker: f"camgen {__version__}", **({"Date": None} if kind == "svg" else {})}
    file = io.BytesIO()
    with _own_style():
        figure.savefig(file, format=kind, metadata=metadata)
    return file.getvalue()


def write_plots(folder: Path, prefix: str, plots: Sequence[Plot]) -> None:
    """Write `<prefix>-plot-<title>.svg` and `.png` of each plot; the second of one title gets a number."""
    names: set[str] = set()
    for plot in plots:
        title = re.sub("[^a-z0-9]+", "-", plot.title.lower()).strip("-")[:60].strip("-") or "curve"
        name = title
        count = 1
        while name in names:
            count += 1
            name = f"{title}-{count}"
        names.add(name)
        figure = figure_of([plot])
        for kind in PLOT_FILES:
            (folder / f"{prefix}-plot-{name}.{kind}").write_bytes(image(figure, kind))


def _draw(axes: Axes, plot: Plot, log: bool) -> None:
    """Draw a plot: its series, marks and named points."""
    alike: dict[str, int] = {}  # series of one colour
    for name, x, y in plot.series:
        k = alike.setdefault(plot.hollow.get(name, name), len(alike))
        colour = SERIES[k % len(SERIES)]
        label = name.replace("_", " ")
        heights = np.where(np.isfinite(y), y, np.nan)
        if name in plot.dots:
            shape = _DOTS[k // len(SERIES) % len(_DOTS)]
            inside = "none" if name in plot.hollow else colour
            axes.plot(x, heights, shape, color=colour, mfc=inside, markersize=4, label=label)
        else:
            axes.plot(x, heights, color=colour, linestyle=_DASHES[k % len(_DASHES)], label=label)
    for name, at in plot.marks:
        axes.axvline(at, color="#5b6675", linestyle=":", linewidth=0.8)
        axes.annotate(
            name,
            (at, 1),
            xycoords=("data", "axes fraction"),
            xytext=(2, -3),
            textcoords="offset points",
            rotation=90,
            ha="left",
            va="top",
            fontsize=7,
        )
    for name, *place in plot.points:
        axes.plot(*place, "o", color="#1d2530", markersize=3)
        axes.annotate(name, (place[0], place[1]), xytext=(3, 3), textcoords="offset points")
    axes.set_title(plot.title.replace("_", " "), loc="left")
    axes.set_xlabel(plot.x_label)
    axes.set_ylabel(plot.y_label.replace("^2", "²").replace("^3", "³"))
    if plot.levels:
        axes.set_yticks([y for _, y in plot.levels], [text for text, _ in plot.levels])
        axes.grid(axis="y")
    if plot.equal:
        axes.set_aspect("equal", adjustable="datalim")
    if log:
        axes.set_xscale("log")
        axes.set_yscale("log")
    elif plot.turns:
        axes.set_xlim(0, _TURN)
        axes.set_xticks(np.arange(0, _TURN + 1, 45))
    if len(plot.series) > 1:
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
