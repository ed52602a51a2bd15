"""`camgen motion` of a cam table: what a servo drive makes of its rows, and how far that is off the follower of a spec's cam."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from camgen.errors import Fault, SpecError
from camgen.files.folder import name_of
from camgen.files.servo import CamTable, read_cam_table
from camgen.findings import Finding, at_most, in_file
from camgen.geometry.rings import Floats
from camgen.machines.follower_motions import table_finding, table_motions
from camgen.machines.sources import read_mechanism
from camgen.measuring.folder import write_folder
from camgen.numerics import peak
from camgen.report.report import Report
from camgen.study import ROWS, Figure, Figures, Plot

_JUMP = 0.02  # of its greatest size, by which velocity or acceleration may differ at both ends of a turn
_PACKAGES = ("numpy", "pydantic", "scipy")
_ORDERS = (
    ("slave", "{}"),
    ("velocity", "{}/rad"),
    ("acceleration", "{}/rad²"),
    ("jerk", "{}/rad³"),
)


@dataclass(frozen=True)
class _Driven:
    """A table and the curve that a drive lays through its rows."""

    path: Path
    table: CamTable
    curve: Callable[[Floats, int], Floats]  # per deg

    @property
    def unit(self) -> str:
        """Of the slave; "units" where the file does not say it."""
        return self.table.unit or "units"

    def at(self, x: Floats, order: int) -> Floats:
        """The slave or its derivative per rad."""
        return self.curve(x, order) * math.degrees(1.0) ** order


def run(
    path: Path,
    against: Path | None,
    out: Path,
    progress: Callable[[str], None] = lambda _: None,
) -> Report:
    """Read a table, lay the drive's curve through it, write OUT/<file>-motion/ with report.html, report.json and motion.csv.

    against: a spec, whose cam the table is to replace: the one whose follower is nearest.
    Raises SpecError, FileError or DesignError.
    """
    progress(f"reading {path.name}")
    table = read_cam_table(path)
    driven = _Driven(path, table, table.curve())
    name = name_of(path)
    x = np.linspace(table.master[0], table.master[-1], ROWS)
    columns: dict[str, Floats] = {"master_deg": x}
    plots = []
    figures = [
        Figure("rows", len(table.master)),
        Figure("stroke", float(np.ptp(driven.at(x, 0))), driven.unit),
    ]
    for order, (what, unit) in enumerate(_ORDERS):
        values = driven.at(x, order)
        shown = unit.format(driven.unit)
        figure = Figure(f"peak {what}", peak(values), shown)
        figures += [figure] if order else []
        columns[Figure(what, 0.0, shown).key] = values
        plots.append(Plot(what.capitalize(), "master, deg", shown, [(what, x, values)]))
    report = Report(
        f"{name}-motion",
        "cam table of a servo drive",
        [_jumps(driven)] if table.closed else [],
        Figures(figures),
        (),
        plots,
        notes=[_note(table)],
    )
    if against is not None:
        report, columns = _compared(report, columns, driven, against)
    report = replace(report, remarks=_summary(report, driven))
    return write_folder(report, columns, out, _PACKAGES, progress)


def _note(table: CamTable) -> str:
    """How the curve was laid, in words."""
    laid = (
        "Cubic splines through the points"
        if table.velocity is None
        else "Quintics between the rows, by their velocity and acceleration"
    )
    return f"{laid}: a drive that is set otherwise makes another motion. Derivatives are to the master's angle."


def _jumps(driven: _Driven) -> Finding:
    """MOTION_JUMP: whether slave, velocity and acceleration begin as they end; a slave may have gone on by whole turns."""
    first, last = driven.table.master[[0, -1]]
    inside = np.linspace(first, last, ROWS)
    count = 0
    for order in range(3):
        step = float(driven.at(last, order) - driven.at(first, order))
        if order == 0 and driven.table.unit != "mm":
            step -= 360 * round(step / 360)
        values = driven.at(inside, order)
        size = float(np.ptp(values)) if order == 0 else peak(values)
        count += abs(step) > _JUMP * size
    message = "jumps of the slave, its velocity and its acceleration from the table's end to its beginning"
    return at_most("MOTION_JUMP", count, 0, "jumps", in_file(driven.path), message)


def _compared(
    report: Report, columns: Mapping[str, Floats], driven: _Driven, against: Path
) -> tuple[Report, dict[str, Floats]]:
    """The report with the follower of the spec's cam that is nearest."""
    motions = list(table_motions(read_mechanism(against).resolved()))
    if not motions:
        fault = Fault((), against.name, "the spec of a machine with a cam", source="--against")
        raise SpecError([fault], "command line")
    x = columns["master_deg"]
    motion = min(
        motions, key=lambda each: peak(driven.curve(x, 0) - each.law(x, 0)) / (each.stroke or 1)
    )
    error = driven.curve(x, 0) - motion.law(x, 0)
    figures = [
        Figure("motion error max", peak(error), motion.unit, motion.name),
        Figure("motion error rms", float(np.sqrt(np.mean(error**2))), motion.unit, motion.name),
    ]
    plot = Plot(
        f"Table less the follower of {motion.name}",
        "master, deg",
        motion.unit,
        [("error", x, error)],
    )
    columns = {**columns, f"wanted_{motion.unit}": motion.law(x, 0), f"error_{motion.unit}": error}
    numbers = report.numbers | figures
    findings = [*report.findings, table_finding(driven.table, motion, driven.path)]
    note = f"Held against the follower of {motion.name} in {against.name}."
    return replace(
        report,
        findings=findings,
        numbers=numbers,
        plots=[*report.plots, plot],
        notes=[*report.notes, note],
    ), columns


def _summary(report: Report, driven: _Driven) -> list[str]:
    """What a person asked for, in a few lines."""
    by_quantity = {each.quantity: each for each in report.numbers.records}
    stroke = by_quantity["stroke"]
    said = [
        f"the slave moves {stroke.value:.4g} {stroke.unit} over {np.ptp(driven.table.master):.4g} deg of the master, by "
        f"{len(driven.table.master)} rows"
    ]
    error = by_quantity.get("motion error max")
    if error is not None:
        said.append(f"it is {error.value:.2g} {error.unit} off the follower of {error.of} at most")
    return said
