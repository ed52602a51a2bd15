"""What a terminal shows: the verdict, what fails, five figures, where the files are, and what is being made meanwhile."""

from __future__ import annotations

import math
import os
import re
import sys
from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from shutil import get_terminal_size
from typing import TYPE_CHECKING, Literal

import click

from camgen.errors import for_terminal, printable
from camgen.findings import as_read
from camgen.report.words import NOISE, sentence

if TYPE_CHECKING:
    from camgen.findings import Finding, NotJudged
    from camgen.progress import Progress
    from camgen.report.report import Report
    from camgen.report.summary import Headline, Summary

_BAR = 20  # characters of the bar of the progress line
_TICKS = 2  # a second, at which it is drawn anew


# Columns of the table of all findings.
_COLUMNS = ("finding", "measured", "limit", "margin", "unit", "where", "")
_NUMBERS = ("measured", "limit", "margin")
_DROPPED = ((60, ("margin", "unit", "where")), (100, ("margin",)))  # where the terminal is narrower
_OPEN = "not judged"
_ROUND_TRIP = "ROUND_TRIP"  # of each file
_COLOURS = {"ok": "green", "FAIL": "red", _OPEN: "yellow"}
_STATES = {"ok": "green", "bad": "red"}
_LEAST = 50  # characters that a table takes at least
_PIPE = 240  # the same in a file or a pipe


def print_report(report: Report, quiet: bool = False, verbose: bool = False) -> None:
    """Verdict, what fails and what is not judged in words, five figures, and which file to open.

    quiet: what fails alone, and what this run did beside the result, for that is written nowhere; verbose: the table of all
    findings, each in words, and every file by name.
    """
    from camgen.report.summary import summary

    first = summary(report)
    if quiet and not first.failing:
        for text in report.remarks:
            _say(f"note: {report.name}: {text}")
        return
    outcome = first.verdict[:1].lower() + first.verdict[1:]
    if first.failing:
        outcome = re.sub("fails?$", lambda found: found[0].upper(), outcome)
    _say(f"{report.name}: {outcome}{first.asides}", _STATES.get(first.state), bold=True)
    for text in (*_troubles(first), *_notes(report, first, quiet)):
        _say(text)
    if quiet:
        return
    for text in figure_lines(first.figures):
        _say(text)
    if verbose:
        _print_findings(report)
        for finding in report.findings:
            if finding.ok and finding.code != _ROUND_TRIP:
                _say(_sentence(finding, str(finding.where)))
    for text in _next_steps(report, first, verbose):
        _say(text)


def _troubles(first: Summary) -> Iterator[str]:
    """What fails, and what is not judged, in words."""
    for finding, where in first.failing:
        yield _sentence(finding, where)
    codes = list(dict.fromkeys(finding.code for finding, _ in first.failing))
    if codes:
        means = "it means" if len(codes) == 1 else "they mean"
        yield f"what {means} and what helps: camgen explain {' '.join(codes)}"
    absent = sum(each.absent for each in first.not_judged)
    if absent:
        need = "kind of finding needs" if absent == 1 else "kinds of findings need"
        yield f"{_OPEN}: {absent} {need} files that the folder does not have; -v lists them"
    for codes_open, why in _reasons([each for each in first.not_judged if not each.absent]):
        yield f"{_OPEN}: {codes_open}: {why}"


def _notes(report: Report, first: Summary, quiet: bool) -> list[str]:
    """What to read before the parts are made, and what this run did beside the result."""
    warned = () if quiet else first.warnings
    said = [f"warning: {sentence(text)}" for text in warned]
    return said + [f"note: {sentence(text)}" for text in report.remarks]


def _reasons(not_judged: Sequence[NotJudged]) -> Iterator[tuple[str, str]]:
    """Codes with one reason together, and the reason."""
    for why in dict.fromkeys(each.why for each in not_judged):
        yield ", ".join(each.code for each in not_judged if each.why == why), sentence(why)


def _say(text: str, colour: str | None = None, **style: bool) -> None:
    """Print a line of any text, on a terminal wrapped at its width."""
    _print(click.style(for_terminal(printable(text), sys.stdout), colour, **style))


def _print(line: str) -> None:
    """Print a line; with its colours on a terminal alone, and not where NO_COLOR asks for none."""
    click.echo(
        line if sys.stdout.isatty() and not os.environ.get("NO_COLOR") else click.unstyle(line)
    )


def figure_lines(figures: Sequence[Headline]) -> Iterator[str]:
    """Figures with their unit and limit, one a line."""
    rows = []
    for each in figures:
        beside = each.beside(number)
        code = f" ({each.finding.code})" if each.finding else ""
        rows.append((f"  {each.name}", each.said(number), each.unit, f"{beside}{code}"))
    if not rows:
        return
    names, values, units, _ = (max(map(len, column)) for column in zip(*rows, strict=True))
    for name, value, unit, beside in rows:
        yield f"{name:<{names}}  {value:>{values}}  {unit:<{units}}  {beside}".rstrip()


def _print_findings(report: Report) -> None:
    """All findings as a table, those that fail first, then what is not judged."""
    blank = dict.fromkeys(_COLUMNS, "")
    open_ = [
        blank | {"finding": each.code, "where": f"needs {each.needs}", "": _OPEN}
        for each in report.not_judged
    ]
    bad = [_cells(report, finding) for finding in report.findings if not finding.ok]
    good = [*_good_rows(report)]
    # a table that goes to a file or a pipe is as wide as it needs to be
    width = get_terminal_size().columns if sys.stdout.isatty() else _PIPE
    left = next((gone for least, gone in _DROPPED if width < least), ())
    shown = [name for name in _COLUMNS if name not in left]
    rows = [tuple(row[name] for name in shown) for row in (*bad, *open_, *good)]
    numbers = [shown.index(name) for name in _NUMBERS if name in shown]
    _print_table(shown, rows, numbers, max(width, _LEAST))


def _good_rows(report: Report) -> Iterator[dict[str, str]]:
    """Rows of what holds; files that are as designed, of which there may be hundreds, in one: the worst of them."""
    from camgen.report.tables import share_used

    good = [finding for finding in report.findings if finding.ok]
    files = [finding for finding in good if finding.code == _ROUND_TRIP]
    worst = max(files, key=lambda finding: share_used(finding) or 0, default=None)
    for finding in good:
        if finding is worst and len(files) > 1:
            row = _cells(report, finding)
            yield row | {"where": f"{row['where']}, the worst of {len(files)}"}
        elif finding is worst or finding.code != _ROUND_TRIP:
            yield _cells(report, finding)


def _print_table(
    heads: Sequence[str], rows: Sequence[Sequence[str]], numbers: Collection[int], width: int
) -> None:
    """A table, of which the column "where" takes several lines where it is too wide; numbers: columns that stand at the right."""
    from rich.box import SIMPLE_HEAD
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    for k, head in enumerate(heads):
        side: Literal["left", "right"] = "right" if k in numbers else "left"
        table.add_column(head, justify=side, no_wrap=head != "where")
    for row in rows:
        table.add_row(
            *(
                Text(
                    printable(cell),
                    _COLOURS.get(cell, ""),
                    no_wrap=head != "where",
                    overflow="fold",
                )
                for head, cell in zip(heads, row, strict=True)
            )
        )
    console = Console(width=width)
    with console.capture() as capture:
        console.print(table)
    for line in capture.get().strip("\n").splitlines():
        _print(line.rstrip())


def number(value: float, noise: float = NOISE) -> str:
    """A number of four digits, as short as it goes: "0.0018", "1.234e-5"; 0 for what is only rounding."""
    if abs(value) < noise:
        return "0"
    return re.sub(
        r"e([+-])0*(\d)", lambda found: f"e{found[1].strip('+')}{found[2]}", f"{value:.4g}"
    )


def _size(value: float, finding: Finding) -> str:
    """A value of a finding with its unit."""
    read, unit = as_read(value, finding.unit)
    return f"{number(read)} {unit if unit != '1' else ''}".rstrip()


def _sentence(finding: Finding, where: str) -> str:
    """A finding as a sentence with its numbers."""
    rounding = not finding.ok and 0 < finding.measured < NOISE
    size = f"below {number(NOISE)} {finding.unit}" if rounding else _size(finding.measured, finding)
    measured = size if not math.isnan(finding.measured) else "could not be measured"
    bound, asked = {
        "<=": ("at most", "allowed"),
        ">=": ("at least", "needed"),
        ">": ("more than", "needed"),
    }[finding.sign]
    least = (
        "" if math.isnan(finding.limit) else f"; {asked}: {bound} {_size(finding.limit, finding)}"
    )
    at = f" ({where})" if where else ""
    message = sentence(finding.message[:1].upper() + finding.message[1:])
    return (
        f"{finding.code}{at} {'holds' if finding.ok else 'fails'}: {measured}{least}. {message}".rstrip(
            " ."
        )
        + "."
    )


_MAKING = (
    "buy what is marked bought or stock in",
    "print",
    "cut",
    "load",
    "send",
)  # what is done with a file to make a part or let it move


def _next_steps(report: Report, first: Summary, every: bool) -> list[str]:
    """Where the files are, what to open, and what to make where nothing fails."""
    if report.folder is None:
        return []
    folder = Path(report.folder)
    held = ", ".join(f"{count} {kind.upper()}" for kind, count in first.kinds)
    said = [f"files are in {folder}{f': {held}' if held else ''}"]
    if every:
        said += [f"  {folder / name}" for name in first.files]
    made = [step for step in first.steps if step.verb not in _MAKING]
    waits = first.state == "bad" and len(made) < len(first.steps)
    steps = made if waits else first.steps
    said += [f"{step.verb} {folder / step.file}{step.rest}" for step in steps]
    return [*said, "make no parts yet: correct first what fails above"] if waits else said


def _cells(report: Report, finding: Finding) -> dict[str, str]:
    """A row of the table by its columns."""
    measured, unit = as_read(finding.measured, finding.unit)
    bound, _ = as_read(finding.limit, finding.unit)
    margin = abs(bound - measured)
    noise = NOISE * finding.ok
    limit = "none" if math.isnan(bound) else f"{finding.sign} {number(bound)}"
    where = replace(finding.where, file=finding.where.file.removeprefix(f"{report.name}-"))
    beside = str(replace(where, theta=None)) and where.angle in ("cam angle", "crank angle")
    return {
        "finding": finding.code,
        "measured": number(measured, noise),
        "limit": limit,
        "margin": number(margin if finding.ok else -margin, noise),
        "unit": unit,
        "where": str(replace(where, angle="at") if beside else where),
        "": "ok" if finding.ok else "FAIL",
    }


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
                self._line.console.print(said)
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
