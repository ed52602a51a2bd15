"""What a terminal shows: the findings as a table, and what is being made while it takes long."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from threading import Lock, Timer
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from camgen.findings import Finding
    from camgen.jobs import Progress
    from camgen.report import Report

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


def print_report(report: Report) -> None:
    """The findings as a table on stdout, then the verdict."""
    from rich import box
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    class Terminal(Console):
        def on_broken_pipe(self) -> None:
            raise BrokenPipeError  # `main` knows what to do; rich would end with the code of a finding that fails

    # A table that goes to a file or a pipe is as wide as it needs to be.
    console = Terminal(highlight=False, width=None if sys.stdout.isatty() else 240)
    title = f"{report.name} ({report.mechanism})"
    table = Table(title=title, title_justify="left", box=box.SIMPLE_HEAD, pad_edge=False)
    for column in ("finding", "measured", "limit", "margin"):
        table.add_column(column, justify="left" if column == "finding" else "right", no_wrap=True)
    table.add_column("unit", no_wrap=True)
    table.add_column("where", overflow="ellipsis", no_wrap=True, max_width=52)
    table.add_column("", no_wrap=True)
    for finding, of in _condensed(report.findings):
        margin = abs(finding.limit - finding.measured)
        numbers = (finding.measured, finding.limit, margin if finding.ok else -margin)
        verdict = Text("ok", "green") if finding.ok else Text("FAIL", "bold red")
        short = finding.where.removeprefix(f"{report.name}-").replace("cam angle ", "at ")
        where = short if of == 1 else f"tightest of {of}: {short}"
        table.add_row(finding.code, *(f"{n:.4g}" for n in numbers), finding.unit, Text(where), verdict)
    console.print(table)
    failed = [finding for finding in report.findings if not finding.ok]
    for finding in failed:
        console.print(Text(f"{finding.code} ({finding.where}): {finding.message}"), soft_wrap=True)
    for remark in report.remarks:
        console.print(Text(remark), soft_wrap=True)
    count = len(report.findings)
    console.print(f"{count} findings hold" if not failed else f"{len(failed)} of {count} findings FAIL")


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
        with self._lock:
            self._state = text, done
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
