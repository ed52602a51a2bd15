"""What a terminal shows: the findings as a table, where the files are, and what is being made meanwhile."""

from __future__ import annotations

import math
import os
import re
import sys
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from shutil import get_terminal_size
from typing import TYPE_CHECKING

import click

from camgen.errors import printable
from camgen.report.words import NOISE

if TYPE_CHECKING:
    from camgen.findings import Finding
    from camgen.progress import Progress
    from camgen.report.report import Report

_CONDENSED_FROM = 40  # findings; fewer are printed one by one
_BAR = 20  # characters of the bar of the progress line
_TICKS = 2  # a second, at which it is drawn anew


def _digest(findings: Sequence[Finding]) -> list[tuple[Finding, int]]:
    """Findings to print, each with how many it stands for: of many routine checks that hold only the tightest."""
    from camgen.findings import ROUTINE

    routine: dict[str, list[Finding]] = {}
    for finding in findings:
        if finding.ok and finding.code in ROUTINE and len(findings) > _CONDENSED_FROM:
            routine.setdefault(finding.code, []).append(finding)
    rows = []
    for finding in findings:
        group = routine.get(finding.code, []) if finding.ok else []
        tightest = min(
            group, key=lambda f: abs(f.limit - f.measured) / (abs(f.limit) or 1), default=finding
        )
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


def print_report(report: Report, quiet: bool = False, verbose: bool = False) -> None:
    """The findings as a table on stdout, what fails first; then each failure in words, the verdict, and where the files are.

    quiet: what fails alone, and what this run did beside the result, for that is written nowhere; verbose: every finding by
    itself and in words, every file by name.
    """
    from camgen.findings import left_out, worst_of_each

    failed = [finding for finding in report.findings if not finding.ok]
    if quiet and not failed:
        for text in report.remarks:
            _say(f"note: {report.name}: {text}")
        return
    if not quiet:
        _print_table(report, verbose)
    for finding, where in worst_of_each(failed):
        _say(_sentence(finding, where))
    for finding in report.findings if verbose else ():
        if finding.ok:
            _say(_sentence(finding, str(finding.where)))
    for text in report.remarks if quiet else (*report.warnings, *report.remarks):
        _say(f"note: {text}")
    count = len(report.findings)
    held = "the one finding holds" if count == 1 else f"all {count} findings hold"
    verdict = (
        f"{len(failed)} of {count} findings {'FAILS' if len(failed) == 1 else 'FAIL'}"
        if failed
        else held
    )
    open_ = f"; not judged: {left_out(report.not_judged)}" if report.not_judged else ""
    _say(
        f"{report.name}: {verdict}{open_}",
        "red" if failed else "green" if not open_ else None,
        bold=True,
    )
    codes = list(dict.fromkeys(finding.code for finding in failed))
    if codes:
        _say(
            f"what {'it means' if len(codes) == 1 else 'they mean'} and what helps: camgen explain {' '.join(codes)}"
        )
    for text in (
        () if quiet or report.folder is None else _next_steps(report, Path(report.folder), verbose)
    ):
        _say(text)


def _say(text: str, colour: str | None = None, **style: bool) -> None:
    """Print a line of any text."""
    _print(click.style(printable(text), colour, **style))


def _print(line: str) -> None:
    """Print a line; with its colours on a terminal alone, and not where NO_COLOR asks for none."""
    click.echo(
        line if sys.stdout.isatty() and not os.environ.get("NO_COLOR") else click.unstyle(line)
    )


def _print_table(report: Report, every: bool) -> None:
    """The findings as a table of the terminal's width, those that fail first."""
    findings = [(finding, 1) for finding in report.findings] if every else _digest(report.findings)
    bad = [_cells(report, finding, of) for finding, of in findings if not finding.ok]
    blank = dict.fromkeys(_COLUMNS, "")
    open_ = [
        blank | {"finding": each.code, "where": printable(each.why), "": _OPEN}
        for each in report.not_judged
    ]
    rows = [*bad, *open_, *(_cells(report, finding, of) for finding, of in findings if finding.ok)]
    # a table that goes to a file or a pipe is as wide as it needs to be
    widths = _widths(rows, get_terminal_size().columns if sys.stdout.isatty() else 240)
    shown = [name for name in _COLUMNS if name in widths]
    line = "\u2500" if (sys.stdout.encoding or "").lower().startswith("utf") else "-"
    _say(f"{report.name} ({report.mechanism})", italic=True)
    _say((" " * _BETWEEN).join(_cell(name, name, widths[name]) for name in shown), bold=True)
    _print(line * (sum(widths.values()) + _BETWEEN * (len(widths) - 1)))
    colours = {"ok": "green", "FAIL": "red", _OPEN: "yellow"}
    for row in rows:
        *cells, verdict = (_cell(name, row[name], widths[name]) for name in shown)
        if row[""] == _OPEN:  # a reason without numbers: over all columns between, and never cut
            room = sum(widths[name] for name in shown[1:-1]) + _BETWEEN * (len(shown) - 3)
            cells = [cells[0], f"{row['where']:<{room}}"]
        colour = colours.get(row[""])
        _print((" " * _BETWEEN).join([*cells, click.style(verdict, colour, bold=row[""] != "ok")]))


def _cell(column: str, text: str, width: int) -> str:
    """A cell as wide as its column."""
    text = text if len(text) <= width else f"{text[: width - 1]}\u2026"
    return f"{text:>{width}}" if column in ("measured", "limit", "margin") else f"{text:<{width}}"


def number(value: float, noise: float = NOISE) -> str:
    """A number of four digits, as short as it goes: "0.0018", "1.234e-5"; 0 for what is only rounding."""
    if abs(value) < noise:
        return "0"
    return re.sub(
        r"e([+-])0*(\d)", lambda found: f"e{found[1].strip('+')}{found[2]}", f"{value:.4g}"
    )


def _sentence(finding: Finding, where: str) -> str:
    """A finding as a sentence with its numbers."""
    unit = f" {finding.unit}" if finding.unit else ""
    size = f"{number(finding.measured, NOISE * finding.ok)}{unit}"
    measured = size if not math.isnan(finding.measured) else "could not be measured"
    bound, asked = {
        "<=": ("at most", "allowed"),
        ">=": ("at least", "asked"),
        ">": ("more than", "asked"),
    }[finding.sign]
    limit = (
        "" if math.isnan(finding.limit) else f"; {bound} {number(finding.limit)}{unit} is {asked}"
    )
    at = f" ({where})" if where else ""
    message = finding.message[:1].upper() + finding.message[1:]
    return (
        f"{finding.code}{at} {'holds' if finding.ok else 'fails'}: {measured}{limit}. {message}".rstrip(
            " ."
        )
        + "."
    )


def _next_steps(report: Report, folder: Path, every: bool) -> list[str]:
    """Where the files are, and what to open."""
    paths = {path.name: path for path in sorted(folder.rglob("*")) if path.is_file()}
    names = [*paths]
    kinds = Counter(name.rpartition(".")[2] for name in names)
    known = "dxf", "stl", "3mf", "step", "glb", "svg", "png", "gif", "pdf"
    held = ", ".join(f"{kinds[kind]} {kind.upper()}" for kind in known if kinds[kind])
    said = [f"files are in {folder}{f': {held}' if held else ''}"]
    if every:
        said += [f"  {path}" for path in paths.values()]
    plates = [
        name for name in names if re.fullmatch(rf"{re.escape(report.name)}-plate(-\d+)?\.3mf", name)
    ]
    if "report.html" in names:
        moves = "motion.csv" in names  # a coupon's does not
        said.append(
            f"open {folder / 'report.html'} in a browser to see it{' move' if moves else ''}"
        )
    if plates:
        plates.sort(key=lambda name: (len(name), name))
        said.append(f"print {paths[plates[0]].parent / _first_and_rest(plates)}")
    sheets = [
        name for name in names if re.fullmatch(rf"{re.escape(report.name)}-sheet-\d+\.svg", name)
    ]
    if sheets:
        said.append(
            f"cut {paths[sheets[0]]}{f' and {len(sheets) - 1} more' if len(sheets) > 1 else ''}"
        )
    found = f"{report.name}-print.toml"
    if found in names:
        said.append(f"paste {folder / found} into your specs")
    return said


def _first_and_rest(plates: Sequence[str]) -> str:
    """Files of plates in few words: the first by its name, the others by their numbers: "plate.3mf, and plate-2 to -5"."""
    first, *more = (name.removesuffix(".3mf") for name in plates)
    numbers = [name.removeprefix(first) for name in more]
    rest = (
        f", and plate{numbers[0]}{f' to {numbers[-1]}' if len(numbers) > 1 else ''}"
        if numbers
        else ""
    )
    return f"{first}.3mf{rest}"


def _cells(report: Report, finding: Finding, of: int) -> dict[str, str]:
    """A row of the table by its columns; of: how many findings it stands for."""
    margin = abs(finding.limit - finding.measured)
    noise = NOISE * finding.ok
    limit = "none" if math.isnan(finding.limit) else f"{finding.sign} {number(finding.limit)}"
    where = replace(finding.where, file=finding.where.file.removeprefix(f"{report.name}-"))
    beside = str(replace(where, theta=None)) and where.angle in ("cam angle", "crank angle")
    short = str(replace(where, angle="at") if beside else where)
    cells = {
        "finding": finding.code,
        "measured": number(finding.measured, noise),
        "limit": limit,
        "margin": number(margin if finding.ok else -margin, noise),
        "unit": finding.unit,
        "where": short if of == 1 else f"tightest of {of}: {short}",
        "": "ok" if finding.ok else "FAIL",
    }
    return {name: printable(text) for name, text in cells.items()}


def _widths(rows: Sequence[Mapping[str, str]], room: int) -> dict[str, int]:
    """Width of each column that is shown where there are so many characters in a line."""
    full = (
        {name: max(len(name), *(len(row[name]) for row in rows)) for name in (*_ALWAYS, *_GIVE_WAY)}
        if rows
        else {}
    )
    widths = {name: full[name] for name in _ALWAYS if name in full}
    for name, least in _GIVE_WAY.items() if rows else ():
        left = room - sum(widths.values()) - _BETWEEN * len(widths) - 1
        if left >= min(full[name], least or full[name]):
            widths[name] = min(full[name], left, _WIDE)
    return widths


class Bar:
    """A line on stderr that names the step at work and shows how far it is, from the start; only on a terminal."""

    def __init__(self, wanted: bool = True) -> None:
        """wanted: whether it is shown at all."""
        self._shown = wanted and sys.stderr is not None and sys.stderr.isatty()

    def __enter__(self) -> Progress:
        if self._shown:
            from rich import progress
            from rich.console import Console

            self._line = progress.Progress(
                progress.BarColumn(_BAR),
                progress.TimeElapsedColumn(),
                progress.TextColumn("{task.description}", markup=False),
                console=Console(stderr=True, markup=False, emoji=False, highlight=False),
                transient=True,
                refresh_per_second=_TICKS,
                redirect_stdout=False,
                redirect_stderr=False,
            )
            self._task = self._line.add_task("starting", total=None)
            self._line.start()
        return self._step

    def _step(self, text: str, done: float | None = None) -> None:
        said = printable(text)
        if text.startswith("note: "):  # stays on the screen
            if self._shown:
                self._line.console.print(said, soft_wrap=True)
            elif sys.stderr is not None:
                print(said, file=sys.stderr, flush=True)
        elif self._shown:
            total = None if done is None else 1.0
            self._line.update(
                self._task, description=said, total=total, completed=done or 0.0, refresh=True
            )

    def __exit__(self, *_: object) -> None:
        if self._shown:
            self._line.stop()
