"""A sweep's rows in memory, to look at, to choose from and to go on with."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from html import escape
from os import PathLike
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from camgen.errors import Fault, SpecError
from camgen.machines.mechanism import Mechanism
from camgen.machines.sources import changed
from camgen.numerics import Floats
from camgen.spec import unknown
from camgen.study import Plot, data_frame
from camgen.sweep.run import HOLDS, LIMITS, Engine, Processes, SweepResult, Task, here, judged
from camgen.sweep.shown import row_lines, text_of
from camgen.sweep.tables import Row, writer_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame

_SHOWN = 12  # rows of a table that is printed
_COLOURS = 24  # series of a plot that can be told apart


@dataclass(frozen=True, repr=False)
class SweepTable:
    """Variants of a spec, a row each: its keys, verdict, codes that fail, reason of refusal, and figures.

    table["stroke_mm"] is a column, (n,): floats, nan where there is none, or texts. Iterating gives rows, as dicts.
    """

    task: Task
    result: SweepResult
    rows: Sequence[Row]

    @property
    def columns(self) -> Sequence[str]:
        """Names of the columns."""
        return self.result.columns

    @property
    def keys(self) -> Sequence[str]:
        """Names of the columns of keys that were varied."""
        return [axis.key for axis in self.task.variants.axes]

    def __len__(self) -> int:
        return len(self.rows)

    def __iter__(self) -> Iterator[Row]:
        return iter(self.rows)

    def __getitem__(self, column: str) -> NDArray[Any]:
        if column not in self.columns:
            raise SpecError([replace(unknown((), column, self.columns), source="column")], "table")
        cells = [row.get(column) for row in self.rows]
        if any(isinstance(cell, str) for cell in cells):
            return np.array(["" if cell is None else str(cell) for cell in cells], dtype=object)
        return np.array([np.nan if cell is None else cell for cell in cells], float)

    @property
    def holding(self) -> SweepTable:
        """The rows alone whose every limit, or finding, holds."""
        return self._of([row for row in self.rows if row["verdict"] in (HOLDS, LIMITS)])

    def front(self, least: Sequence[str] = (), most: Sequence[str] = ()) -> SweepTable:
        """Of the rows that hold those that no other one beats: in these columns none has less, or more, and is as good elsewhere."""
        if not (least or most):
            fault = Fault((), "no column", "columns of which the least, or the most, is wanted")
            raise SpecError([replace(fault, source="front")], "table")
        held = self.holding
        worth = np.array(
            [*(held[name] for name in least), *(-held[name] for name in most)], float
        ).T
        sound = np.isfinite(worth).all(axis=1)
        rows = [
            row
            for k, row in enumerate(held.rows)
            if sound[k] and not _beaten(k, worth[sound], worth)
        ]
        return self._of(rows)

    def machine(self, variant: int) -> Mechanism:
        """The mechanism of a row, by the number that it has in the column `variant`; SpecError, DesignError where there is none."""
        task = self.task
        if not 0 <= variant < task.variants.count:
            fault = Fault((), str(variant), f"0 to {task.variants.count - 1}", source="variant")
            raise SpecError([fault], "table")
        settings = [*task.settings, *task.variants.settings(variant)]
        return changed(dict(task.data), task.source, task.folder, settings)

    def to_dataframe(self) -> DataFrame:
        """All columns as a DataFrame of pandas, its index the variants' numbers; CamgenError where that is not installed."""
        frame = data_frame({name: self[name] for name in self.columns})
        return frame.set_index(frame["variant"].astype(int)).drop(columns="variant")

    def plot(self, x: str, *columns: str) -> Figure:
        """Columns over another one, below each other, which a notebook shows; a colour for each value of the other keys that vary.

        Rows that do not hold are hollow. Where the other keys have more than 24 values together, all rows have one colour.
        """
        from camgen.plotting import figure_of

        return figure_of([self._plot(x, column) for column in columns])

    def _plot(self, x: str, column: str) -> Plot:
        for name in (x, column):
            if self[name].dtype == object:
                fault = Fault((), repr(name), "a column of numbers", source="column")
                raise SpecError([fault], "table")
        others = [key for key in self.keys if key != x]
        values = [tuple(text_of(row[key]) for key in others) for row in self.rows]
        if len(set(values)) > _COLOURS:
            others = []
            values = [()] * len(self.rows)
        held = np.array([row["verdict"] in (HOLDS, LIMITS) for row in self.rows], bool)
        series = []
        hollow = {}
        for each in dict.fromkeys(values):
            names = (f"{key.rpartition('.')[2]} = {v}" for key, v in zip(others, each, strict=True))
            label = ", ".join(names) or "holds"
            alike = np.array([value == each for value in values], bool) & np.isfinite(self[column])
            failing = f"{label}, does not hold" if others else "does not hold"
            hollow[failing] = label
            for name, part in ((label, alike & held), (failing, alike & ~held)):
                if part.any():
                    series.append((name, self[x][part], self[column][part]))
        title = f"Sweep of {self.task.data.get('name', Path(self.task.source).stem)}"
        return Plot(title, x, column, series, dots=[label for label, *_ in series], hollow=hollow)

    def write(self, path: str | PathLike[str]) -> None:
        """Write the table as .csv or .parquet; SpecError for another name, FileError where it cannot be written."""
        file = Path(path)
        writer_of(file)(file, self.columns, iter(self.rows))

    def _of(self, rows: Sequence[Row]) -> SweepTable:
        return replace(self, rows=rows)

    def _cells(self, columns: Sequence[str], count: int) -> list[list[str]]:
        """Head and first rows as text."""
        cells = [[text_of(row.get(name)) for name in columns] for row in self.rows[:count]]
        return [list(columns), *cells]

    def __repr__(self) -> str:
        """The verdicts, and the first rows."""
        more = max(len(self.rows) - _SHOWN, 0)
        rows = self.rows[:_SHOWN]
        lines = row_lines(rows, self.keys, self.task.keep, more=more) if rows else []
        return "\n".join([self._summary, *lines])

    def _repr_html_(self) -> str:
        """For a notebook: the verdicts, and the first rows with all columns."""
        head, *body = self._cells(self.columns, 5 * _SHOWN)
        rows = [_line("th", head), *(_line("td", line) for line in body)]
        return f"<p>{escape(self._summary)}</p><table>{''.join(rows)}</table>"

    @property
    def _summary(self) -> str:
        few = f" {len(self.rows)} of them here." if len(self.rows) < self.result.count else ""
        return self.result.summary + few


def swept(task: Task, jobs: int = 1) -> SweepTable:
    """All variants of a task judged, by so many processes; nothing but the files that it asks for is written."""
    engine: Engine = Processes(jobs) if jobs > 1 else here
    with TemporaryDirectory() as folder:
        with judged(task, Path(folder) / "journal", engine, jobs) as (result, rows):
            return SweepTable(task, result, list(rows()))


def _line(tag: str, cells: Sequence[str]) -> str:
    return f"<tr>{''.join(f'<{tag}>{escape(cell)}</{tag}>' for cell in cells)}</tr>"


def _beaten(k: int, others: Floats, worth: Floats) -> bool:
    """Whether another row is nowhere worse than the k-th and somewhere better."""
    better = (others <= worth[k]).all(axis=1) & (others < worth[k]).any(axis=1)
    return bool(better.any())
