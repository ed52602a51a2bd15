"""Numbers to files: report.json (the truth), motion.csv (the curves) and report.html (for people).

Nothing here knows a mechanism: a Report holds findings, numbers, parts, tables, plots and pictures, all plain data. Same
report, same bytes.
"""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from camgen._version import __version__
from camgen.errors import FileError
from camgen.findings import Finding, NotJudged, left_out, worst_of_each
from camgen.study import Figures, Plot, Scene, Table

if TYPE_CHECKING:
    from camgen.files.cutting import SheetPicture
    from camgen.report.animation import Animation

Path = str | PathLike[str]


@dataclass(frozen=True, repr=False)
class Report:
    """All that a build found out.

    parts: one mapping each with `name`, `count`, `material_mm3` and more; `files` in it lists the part's file names.
    animation, scene: the machine in motion, drawn and in three dimensions; budget: the error budget by stage; files: further
    files of the folder to which the page links, and places: those that do not lie at the top, by name; not_judged: codes that were left out; warnings: sentences that a person should
    read before the parts are made; why_flat: a sentence on what to build for a view in three dimensions; remarks: what this run did beside the result, and folder: where it wrote, told but not
    written: the same spec gives the same files; summary: the verdict of a report without findings; film: a GIF that the page shows;
    sheets: as a laser cuts them.
    """

    name: str
    mechanism: str
    findings: Sequence[Finding]
    numbers: Figures = field(default_factory=Figures)
    parts: Sequence[Mapping[str, object]] = ()
    plots: Sequence[Plot] = ()
    tables: Sequence[Table] = ()
    notes: Sequence[str] = ()
    animation: Animation | None = None
    budget: Table | None = None
    files: Sequence[str] = ()
    not_judged: Sequence[NotJudged] = ()
    warnings: Sequence[str] = ()
    remarks: Sequence[str] = ()
    folder: Path | None = None
    scene: Scene | None = None
    why_flat: str = ""
    summary: str = "Nothing is judged here"
    places: Mapping[str, str] = field(default_factory=dict)
    film: bytes = b""
    sheets: Sequence[SheetPicture] = ()

    @property
    def ok(self) -> bool:
        """Whether every finding holds."""
        return all(finding.ok for finding in self.findings)

    @property
    def all_tables(self) -> Sequence[Table]:
        """The tables, the error budget first."""
        return (*([self.budget] if self.budget else []), *self.tables)

    @property
    def failing(self) -> Sequence[tuple[Finding, str]]:
        """Of the findings that fail the worst of each kind, and where they were made."""
        return worst_of_each([finding for finding in self.findings if not finding.ok])

    @property
    def outcome(self) -> str:
        """One line: how many findings hold or fail."""
        failed = sum(not finding.ok for finding in self.findings)
        count = len(self.findings)
        if failed:
            return f"{failed} of {count} findings fail{'s' if failed == 1 else ''}"
        held = {0: self.summary, 1: "The one finding holds"}
        return held.get(count, f"All {count} findings hold")

    @property
    def verdict(self) -> str:
        """One line: how many findings hold or fail, and what was not judged."""
        open_ = f"; NOT JUDGED: {left_out(self.not_judged)}" if self.not_judged else ""
        return f"{self.outcome}{open_}"

    def show(self) -> None:
        """Show the page of the build, with the machine in motion: below the cell of a notebook, else in a browser.

        FileError where the build made none, or no browser opens.
        """
        from camgen.report.notebook import show_page

        page = None if self.folder is None else FilePath(self.folder) / "report.html"
        if page is None or not page.is_file():
            why = 'there is no page; camgen.build makes it, unless only= leaves "report" out'
            raise FileError(page or self.name, why)
        show_page(page)

    def __repr__(self) -> str:
        """The verdict, what fails, and where the files are."""
        lines = [f"{self.name} ({self.mechanism}): {self.verdict}"]
        lines += [f"  {each.code}: {each.message}" for each in self.findings if not each.ok]
        lines += [] if self.folder is None else [f"  files: {self.folder}"]
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        """For a notebook: the verdict, what fails, the margins and the figures that are not of one kind of file.

        Of a report without findings the tables.
        """
        from html import escape

        from camgen.report.tables import figure_lists, html_table, margins, to_change

        designed = Figures(each for each in self.numbers.records if not each.kind)
        head = f"<h3>{escape(self.name)}: {escape(self.verdict)}</h3>"
        changes = to_change(self.warnings, self.failing, self.not_judged)
        tables = "" if self.findings else "".join(map(html_table, self.all_tables))
        return head + changes + margins(self.findings) + figure_lists(designed) + tables

    def as_dict(self) -> dict[str, object]:
        """The report as report.json holds it: plain values, floats of 12 digits, None for nan and inf."""
        tables = [{"title": t.title, "columns": t.columns, "rows": t.rows} for t in self.all_tables]
        plain: dict[str, object] = _plain(
            {
                "camgen": __version__,
                "name": self.name,
                "mechanism": self.mechanism,
                "ok": self.ok,
                "findings": [finding.as_dict() for finding in self.findings],
                "not_judged": [each.as_dict() for each in self.not_judged],
                "numbers": self.numbers,
                "parts": self.parts,
                "tables": tables,
                "notes": self.notes,
                "warnings": self.warnings,
                **({"remarks": self.remarks} if self.remarks else {}),
            }
        )
        return plain


def to_json(report: Report) -> str:
    """report.json as text: strict JSON, floats of 12 digits as in motion.csv, null for nan and inf."""
    return json.dumps(report.as_dict(), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def write_json(path: Path, report: Report) -> None:
    """Write report.json; FileError where it cannot be written."""
    write_text(path, to_json(report))


def write_csv(path: Path, columns: Mapping[str, ArrayLike]) -> None:
    """Write columns, all (n,), under their names: 12 digits, nan as `nan`; FileError where it cannot be written."""
    header = io.StringIO()
    csv.writer(header, lineterminator="\n").writerow(columns)
    # Adding 0 turns -0 into 0; one format of all lines at once is several times faster than one line at a time.
    cells = np.column_stack([np.asarray(column, float) for column in columns.values()]) + 0.0
    line = ",".join(["%.12g"] * cells.shape[1]) + "\n"
    write_text(path, header.getvalue() + (line * len(cells)) % tuple(cells.ravel().tolist()))


def write_text(path: Path, text: str) -> None:
    """Write a file; FileError where it cannot be written."""
    try:
        with open(path, "w", encoding="utf-8", newline="\n") as file:
            file.write(text)
    except OSError as fault:
        raise FileError(path, fault.strerror or str(fault)) from fault


def _plain(value: object) -> Any:
    """The same as dicts, lists, text, numbers of 12 digits and None; nan and inf become None."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, np.generic | np.ndarray):
        return _plain(value.tolist())
    if isinstance(value, float):
        return float(f"{value:z.12g}") if math.isfinite(value) else None
    if value is None or isinstance(value, str | int):
        return value
    if isinstance(value, Sequence):
        return [_plain(item) for item in value]
    raise TypeError(f"{type(value).__name__} has no place in report.json")
