"""A sweep's table as a page for people: sortable rows, one figure over another, two as a map by colour, the front of any two."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from importlib.resources import files
from pathlib import Path
from string import Template
from typing import Any

from camgen.errors import file_errors
from camgen.report.sketches import Gallery

MOST = 5_000  # rows that a page bears; of more every second, third... is shown


def shown_step(count: int) -> int:
    """1 where a page bears all of so many rows, 2 where it shows every second one, and so on."""
    return -(-count // MOST)


@dataclass(frozen=True)
class SweepPage:
    """What the page of a sweep says beside its rows."""

    title: str
    summary: str
    columns: Sequence[str]
    keys: Sequence[str]  # the columns that were varied
    wishes: Sequence[str] = ()  # columns of the figures of a wish
    galleries: Sequence[Gallery] = ()
    units: Mapping[str, str] = field(
        default_factory=dict
    )  # of keys; the other columns name theirs last


def write_page(path: Path, page: SweepPage, rows: Iterable[Mapping[str, Any]], count: int) -> None:
    """Write the page of a sweep of `count` rows, of which those that `shown_step` says are given."""
    step = shown_step(count)
    summary = page.summary
    if step > 1:
        summary += f" This page shows every variant whose number is a multiple of {step}; the table has all."
    content = {
        "columns": list(page.columns),
        "keys": list(page.keys),
        "units": dict(page.units),
        "wished": list(page.wishes),
        "rows": [[row.get(column) for column in page.columns] for row in rows],
    }
    data = json.dumps(content, ensure_ascii=False).replace("<", "\\u003c")
    template = Template(files("camgen.report").joinpath("sweep.html").read_text(encoding="utf-8"))
    text = template.substitute(
        title=escape(page.title),
        summary=escape(summary),
        galleries="\n".join(each.html() for each in page.galleries),
        data=data,
    )
    with file_errors():
        path.write_text(text, encoding="utf-8", newline="\n")
