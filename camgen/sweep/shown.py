"""A sweep's rows as lines of text: keys, verdict, a few figures, codes that fail, and why a variant is refused."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from camgen.errors import wrapped

Row = Mapping[str, Any]

_FIGURES = 4  # at most, unless they were chosen
WIDE = 120  # letters of a line that goes to no terminal
# Words of the figures that say most of a machine, the first ones first; of each the first column that varies.
_TELLING = (
    "pressure_angle transmission_angle play stroke drive_torque hertz_pressure motion_error curvature_radius_min "
    "peak_acceleration mass_g print_time"
).split()


def text_of(cell: object) -> str:
    """A cell as a person reads it."""
    return "" if cell is None else f"{cell:.6g}" if isinstance(cell, float) else str(cell)


def row_lines(
    rows: Sequence[Row],
    keys: Sequence[str],
    chosen: Sequence[str] = (),
    width: int = WIDE,
    unit: Callable[[str], str] = lambda key: "",
    more: int = 0,
) -> list[str]:
    """The rows in columns below their heads, and why variants are refused below them, at most so many letters wide if they can be.

    chosen: figures, else those that say most; unit: of a key; more: rows that are left out.
    """
    reasons = {_reason(row): "" for row in rows if _reason(row)}
    reasons = {reason: f"({k})" for k, reason in enumerate(reasons, 1)}
    why = [str(row["fails"]) or reasons.get(_reason(row), "") for row in rows]
    figures = list(chosen or _telling(rows, keys))
    while True:
        heads = [*(_head(key, keys, unit(key)) for key in keys), "verdict", *figures]
        names = [*keys, "verdict", *figures]
        table = [[*heads, "why" if any(why) else ""]]
        table += [
            [*(text_of(row.get(name)) for name in names), last]
            for row, last in zip(rows, why, strict=True)
        ]
        lines = _aligned(table)
        if chosen or not figures or max(map(len, lines)) <= width:
            break
        figures.pop()
    lines += [f"... and {more:,} more"] if more else []
    for reason, mark in reasons.items():
        lines += wrapped(f"{mark} {reason}", width).splitlines()
    return lines


def _aligned(rows: Sequence[Sequence[str]]) -> list[str]:
    """Rows of cells, the heads first, in columns; numbers stand at the right."""
    columns = list(zip(*rows, strict=True))
    widths = [max(map(len, column)) for column in columns]
    right = [all(map(_numeric, filter(None, column[1:]))) for column in columns]
    return [
        "  ".join(
            cell.rjust(size) if side else cell.ljust(size)
            for cell, size, side in zip(row, widths, right, strict=True)
        ).rstrip()
        for row in rows
    ]


def _reason(row: Row) -> str:
    """Why there is no such machine, on one line."""
    return " ".join(str(row["reason"]).split())


def _head(key: str, keys: Sequence[str], unit: str) -> str:
    """A key, by its last step where that tells it, with its unit."""
    last = key.rpartition(".")[2]
    unit = "" if " or " in unit else unit
    alone = [each.rpartition(".")[2] for each in keys].count(last) == 1 and not last.isdigit()
    return f"{last if alone else key}{f', {unit}' if unit else ''}"


def _telling(rows: Sequence[Row], keys: Sequence[str]) -> Iterator[str]:
    """Figures that say most of the rows: those that vary first."""
    columns = dict.fromkeys(name for row in rows for name in row)
    others = {"variant", "verdict", "fails", "reason", *keys}
    figures = [name for name in columns if name not in others]
    varying = [name for name in figures if len({row.get(name) for row in rows} - {None}) > 1]
    found = [
        next((name for name in group if word in name), "")
        for group in (varying, figures)
        for word in _TELLING
    ]
    yield from list(dict.fromkeys(filter(None, found)))[:_FIGURES]


def _numeric(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True
