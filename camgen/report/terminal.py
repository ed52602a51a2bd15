"""What a terminal shows: the findings as a table, and what is being made while it takes long."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from threading import Lock, Timer
from typing import TYPE_CHECKING, Any

from camgen.errors import printable

if TYPE_CHECKING:
    from camgen.findings import Finding
    from camgen.pipeline.jobs import Progress
    from camgen.report.report import Report

_CONDENSED_FROM = 40  # findings; fewer are printed one by one
_PATIENCE = 1.0  # s, work that takes less needs no bar


def _condensed(findings: Sequence[Finding]) -> list[tuple[Finding, int]]:
    """Findings to print, each with how many it stands for: of many routine checks that hold only the tightest."""
    from camgen.findings import ROUTINE

    routine: dict[str, list[Finding]] = {}
    for finding in findings:
        if finding.ok and finding.code in ROUTINE and len(findings) > _CONDENSED_FROM:
            routine.setdefault(finding.code, []).append(finding)
    rows = []
    for finding in findings:
        group = routine.get(finding.code, []) if finding.ok else []
        tightest = min(group, key=lambda f: abs(f.limit - f.measured) / (abs(f.limit) or 1), default=finding)
        if finding is tightest:
            rows.append((finding, max(1, len(group))))
    return rows


# Columns of the table and how many characters each needs at least, None: all. Those that stand ahead of the others are
# always shown; the others give way, the last first, where the terminal is narrow.
_ALWAYS = ("finding", "measured", "limit", "")
_GIVE_WAY = {"unit": None, "where": 12, "margin": None}
_COLUMNS = ("finding", "measured", "limit", "margin", "unit", "where", "")
_OPEN = "not judged"
_WIDE = 52  # characters of "where" at most
_BETWEEN = 2  # characters between columns


def print_report(report: Report) -> None:
    """The findings as a table on stdout, then the verdict."""
    from rich import box
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    from camgen.findings import left_out

    class Terminal(Console):
        def on_broken_pipe(self) -> None:
            raise BrokenPipeError  # `main` knows what to do; rich would end with the code of a finding that fails

    rows = [_cells(report, finding, of) for finding, of in _condensed(report.findings)]
    rows += [dict.fromkeys(_COLUMNS, "") | {"finding": each.code, "where": each.why, "": _OPEN} for each in report.not_judged]
    # A table that goes to a file or a pipe is as wide as it needs to be.
    console = Terminal(highlight=False, width=None if sys.stdout.isatty() else 240)
    widths = _widths(rows, console.width)
    console.width = max(console.width, sum(widths.values()) + _BETWEEN * len(widths))
    table = Table(title=Text(printable(f"{report.name} ({report.mechanism})")), title_justify="left", box=box.SIMPLE_HEAD,
                  pad_edge=False, show_edge=False, padding=(0, 1, 0, 0))  # fmt: skip
    for column in (name for name in _COLUMNS if name in widths):
        justify: Any = "right" if column in ("measured", "limit", "margin") else "left"
        table.add_column(column, justify=justify, overflow="ellipsis", no_wrap=True, width=widths[column])
    styles = {"ok": "green", "FAIL": "bold red", _OPEN: "bold red"}
    for row in rows:
        table.add_row(*(Text(text, styles.get(text, "") if not name else "") for name, text in row.items() if name in widths))
    console.print(table)
    failed = [finding for finding in report.findings if not finding.ok]
    for finding in failed:
        console.print(Text(printable(f"{finding.code} ({finding.where}): {finding.message}")), soft_wrap=True)
    for text in (*report.warnings, *report.remarks):
        console.print(Text(printable(f"note: {text}")), soft_wrap=True)
    count = len(report.findings)
    verdict = f"{count} findings hold" if not failed else f"{len(failed)} of {count} findings FAIL"
    open_ = f"; not judged: {left_out(report.not_judged)}" if report.not_judged else ""
    console.print(Text(printable(verdict + open_)), soft_wrap=True)
    if report.folder is not None:
        console.print(Text(printable(f"files are in {report.folder}")), soft_wrap=True)


def _cells(report: Report, finding: Finding, of: int) -> dict[str, str]:
    """A row of the table by its columns; of: how many findings it stands for."""
    margin = abs(finding.limit - finding.measured)
    limit = f"{'>= ' if finding.floor else ''}{finding.limit:.4g}"
    short = finding.where.removeprefix(f"{report.name}-").replace("cam angle ", "at ").replace(", crank angle ", ", at ")
    cells = {
        "finding": finding.code, "measured": f"{finding.measured:.4g}", "limit": limit,
        "margin": f"{margin if finding.ok else -margin:.4g}", "unit": finding.unit,
        "where": short if of == 1 else f"tightest of {of}: {short}", "": "ok" if finding.ok else "FAIL",
    }  # fmt: skip
    return {name: printable(text) for name, text in cells.items()}


def _widths(rows: Sequence[Mapping[str, str]], room: int) -> dict[str, int]:
    """Width of each column that is shown where there are so many characters in a line."""
    full = {name: max(len(name), *(len(row[name]) for row in rows)) for name in (*_ALWAYS, *_GIVE_WAY)} if rows else {}
    found = {name: full[name] for name in _ALWAYS if name in full}
    for name, least in _GIVE_WAY.items() if rows else ():
        left = room - sum(found.values()) - _BETWEEN * len(found) - 1
        if left >= min(full[name], least or full[name]):
            found[name] = min(full[name], left, _WIDE)
    return found


class Bar:
    """A progress bar on stderr that names the step at work, once the work takes over a second; only on a terminal."""

    def __enter__(self) -> Progress:
        self._bar: Any = None
        self._state: tuple[str, float | None] = ("", None)
        self._lock = Lock()
        self._timer = Timer(_PATIENCE, self._show)
        self._timer.daemon = True
        if sys.stderr is not None and sys.stderr.isatty():
            self._timer.start()
        return self._step

    def _step(self, text: str, done: float | None = None) -> None:
        if text.startswith("note: ") and sys.stderr is not None:  # stays on the screen, and is told at once
            print(printable(text), file=sys.stderr, flush=True)
            return
        with self._lock:
            self._state = printable(text), done
            self._draw()

    def _show(self) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

        with self._lock:
            columns = BarColumn(30), TimeElapsedColumn(), TextColumn("{task.description}")
            self._bar = Progress(*columns, console=Console(stderr=True), transient=True)
            self._bar.add_task("", total=None)
            self._draw()
            self._bar.start()

    def _draw(self) -> None:
        text, done = self._state
        if self._bar is not None:
            self._bar.update(0, description=text, completed=done or 0.0, total=None if done is None else 1.0)

    def __exit__(self, *_: object) -> None:
        self._timer.cancel()
        if self._timer.is_alive():
            self._timer.join()
        if self._bar is not None:
            self._bar.stop()
