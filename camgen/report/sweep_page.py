"""A sweep's table as a page for people: sortable rows, one figure over another, two as a map by colour, the front of any two."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from importlib.resources import files
from pathlib import Path
from string import Template
from typing import Any

from camgen.errors import file_errors
from camgen.report.sketches import gallery

MOST = 5_000  # rows that a page bears; of more every second, third... is shown


def shown_step(count: int) -> int:
    """1 where a page bears all of so many rows, 2 where it shows every second one, and so on."""
    return -(-count // MOST)


def write_page(
    path: Path,
    title: str,
    summary: str,
    columns: Sequence[str],
    keys: Sequence[str],
    rows: Iterable[Mapping[str, Any]],
    count: int,
    wished: Sequence[str] = (),
    pictures: Sequence[tuple[str, str]] = (),
    units: Mapping[str, str] | None = None,
) -> None:
    """Write the page of a sweep of `count` rows, of which those that `shown_step` says are given; keys: the columns that were
    varied; wished: figures of a wish; pictures: SVG and what is said of each; units: of keys, the other columns name theirs last.
    """
    shown, step = [[row.get(column) for column in columns] for row in rows], shown_step(count)
    if step > 1:
        summary += f" This page shows every variant whose number is a multiple of {step}; the table has all."
    told = {
        "columns": list(columns),
        "keys": list(keys),
        "units": units or {},
        "wished": list(wished),
        "rows": shown,
    }
    data = json.dumps(told, ensure_ascii=False).replace("<", "\\u003c")
    page = Template(files("camgen.report").joinpath("sweep.html").read_text(encoding="utf-8"))
    text = page.substitute(
        title=escape(title), summary=escape(summary), gallery=gallery(pictures), data=data
    )
    with file_errors():
        path.write_text(text, encoding="utf-8", newline="\n")
