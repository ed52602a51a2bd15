"""The judge of a parts list: every row that a shop or a buyer reads, against what the machine needs."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from itertools import repeat, zip_longest
from pathlib import Path

from camgen.bounds import Bound, bounded
from camgen.errors import FileError, counted
from camgen.findings import Finding, at_most, in_file
from camgen.study import Table

_SIZE = Bound("a parts list", 10_000_000, most=20_000)
_SHARE = 0.005  # by which a number of three digits may be off


def judge_list(path: Path, table: Table) -> Finding:
    """PARTS_LIST of a list in a file: how many of its rows are not those of the table."""
    bounded(path, _SIZE)
    try:
        with open(path, encoding="utf-8", newline="") as file:
            rows = list(csv.reader(file, strict=True))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise FileError(
            path, f"cannot be read as a parts list: {getattr(error, 'strerror', None) or error}"
        ) from None
    wanted_rows: list[Sequence[object]] = [table.columns, *table.rows]
    lines = [(k, *pair) for k, pair in enumerate(zip_longest(rows, wanted_rows, fillvalue=()), 1)]
    faults = [line for line in lines if not _same(line[1], line[2])]
    remark = f"{counted(len(table.rows), 'row')}: what is made, cut, turned or bought, and how many"
    if faults:
        k, row, wanted = faults[0]
        columns = table.columns if k > 1 else ()
        remark = f"line {k} has {_difference(row, wanted, columns)}"
    return at_most("PARTS_LIST", len(faults), 0, "rows", in_file(path), remark)


def _same(row: Sequence[str], wanted: Sequence[object]) -> bool:
    """Whether a row says what is meant: numbers to the digits that are written, all else by the letter."""
    return len(row) == len(wanted) and all(
        _cell(text, value) for text, value in zip(row, wanted, strict=True)
    )


def _difference(row: Sequence[str], wanted: Sequence[object], columns: Sequence[str]) -> str:
    """What a wrong row has instead of what is meant: the cells that differ, each by its column; of the head by themselves."""
    if not (row and wanted):
        found, meant = (", ".join(map(str, cells[1:4])) or "nothing" for cells in (row, wanted))
        return f"{found} instead of {meant}"
    if len(row) != len(wanted):
        return f"{len(row)} cells instead of {len(wanted)}"
    names = (f"{column} " for column in columns) if columns else repeat("")
    return "; ".join(
        f"{name}{text or 'nothing'} instead of {_written(value)}"
        for name, text, value in zip(names, row, wanted, strict=False)
        if not _cell(text, value)
    )


def _written(value: object) -> str:
    """A cell that is meant; a number to the digits by which a wrong one differs."""
    return f"{value:.4g}" if isinstance(value, float) else str(value) or "nothing"


def _cell(text: str, value: object) -> bool:
    if not isinstance(value, float):
        return text == str(value)
    try:
        return abs(float(text) - value) <= _SHARE * abs(value)
    except ValueError:
        return False
