"""What the report shows of a machine, as data: plots, tables, sketches, numbers and notes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from camgen.numerics import Floats, Points


@dataclass(frozen=True)
class Plot:
    """A figure of the report: series of (label, x, y); `marks` are vertical lines (label, x).

    A plot over the cam angle has x in degrees. equal: a shape, one mm the same both ways.
    """

    title: str
    x_label: str
    y_label: str
    series: Sequence[tuple[str, Floats, Floats]]
    marks: Sequence[tuple[str, float]] = ()
    equal: bool = False


@dataclass(frozen=True)
class Table:
    """A table of the report: rows of text or numbers under the columns' names."""

    title: str
    columns: Sequence[str]
    rows: Sequence[Sequence[object]]


@dataclass(frozen=True)
class Sketch:
    """What is drawn but not made: strokes (polylines, complex mm) and circles (centre, radius) on a body of the model."""

    name: str
    strokes: Sequence[Points] = ()
    circles: Sequence[tuple[complex, float]] = ()
    body: str = "ground"


@dataclass(frozen=True)
class Study:
    """What the report shows of a mechanism, without the report knowing the mechanism.

    columns: of motion.csv, where no contact gives them; (1441,) each, every quarter degree of a turn, both ends included.
    """

    numbers: Mapping[str, float] = field(default_factory=dict)
    plots: Sequence[Plot] = ()
    tables: Sequence[Table] = ()
    sketches: Sequence[Sketch] = ()
    notes: Sequence[str] = ()
    columns: Mapping[str, Floats] = field(default_factory=dict)


def together(studies: Sequence[Study]) -> Study:
    """All of them as one; of figures with one name the first counts."""
    numbers: dict[str, float] = {}
    for each in studies:
        numbers |= {name: value for name, value in each.numbers.items() if name not in numbers}
    return Study(
        numbers,
        [plot for each in studies for plot in each.plots],
        [table for each in studies for table in each.tables],
        [sketch for each in studies for sketch in each.sketches],
        [note for each in studies for note in each.notes],
    )
