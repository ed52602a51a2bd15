"""Write the comments of the starter specs again, from the fields of their tables: python tests/starter_comments.py

A starter's lines are of three kinds. `key = value   # what it is` and `[table]   # what it is`, with a # before them too
where they may be left out: the comment comes from the field, at the first mention, and goes on in indented lines. A key that
is left out shows its default, but in the examples of a list of tables. All else is the starter's own text and stays.
"""

from __future__ import annotations

import json
import re
import sys
import textwrap
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from camgen import starters
from camgen.machines import MECHANISMS, load
from camgen.schemas import Data, step_below, tables_of, unit_of

COLUMNS = (36, 64)  # of the comments; the second behind long values
WIDTH = 140  # of a line
_TABLE = re.compile(r"(# )?(\[\[?)([a-zA-Z_.0-9-]+)\]\]?(?:\s+#.*)?")
_KEY = re.compile(r"(# )?([a-zA-Z_\"][a-zA-Z_.0-9\"-]*) = ((?:\"[^\"]*\"|[^\"#])*?)(?:\s+#.*)?")
_MORE = re.compile(r"\s{8,}#.*")


@dataclass(frozen=True)
class Row:
    """A line of a starter."""

    line: str  # as it is
    path: tuple[str, ...] = ()  # of the key or table; () of text
    value: str = ""  # of a key, as written
    asleep: bool = False  # behind a #
    text: str = ""  # without its comment


def rows(starter: str) -> Iterator[Row]:
    """The lines of a starter."""
    table: tuple[str, ...] = ()
    for line in starter.splitlines():
        head, key = _TABLE.fullmatch(line), _KEY.fullmatch(line)
        if head:
            table = tuple(head[3].split("."))
            text = f"{head[1] or ''}{head[2]}{head[3]}{']' * len(head[2])}"
            yield Row(line, table, "", bool(head[1]), text)
        elif key:
            name = [key[2].strip('"')] if '"' in key[2] else key[2].split(".")
            text = f"{key[1] or ''}{key[2]} = {key[3]}"
            yield Row(line, (*table, *name), key[3], bool(key[1]), text)
        else:
            yield Row(line)


def fields(root: Data, path: tuple[str, ...]) -> list[Data]:
    """What a schema says of the key at a path, for each table that may stand there."""
    holders = [root]
    for step in path[:-1]:
        below = [step_below(each, step, root) for each in holders]
        holders = [table for each in below for table in tables_of(each, root)]
    return [
        each["properties"][path[-1]] for each in holders if path[-1] in each.get("properties", ())
    ]


def comment(field: Data, key: str) -> list[str]:
    """Lines of what is said of a key: its unit, where its name does not end in it, and its description."""
    unit = unit_of(field) or "1"
    spelled = unit.lower().replace("^", "").replace(" ", "_").replace("/", "_")
    unit = "" if unit == "1" or key.endswith(f"_{spelled}") else f"{unit}, "
    lines = f"{unit}{field['description']}".split("\n")
    return [part for line in lines for part in textwrap.wrap(line, WIDTH - COLUMNS[0] - 2)]


def shown(value: Any) -> str:
    """A default as a spec has it."""
    if isinstance(value, list):
        return f"[{', '.join(map(shown, value))}]"
    return f"{value:g}" if isinstance(value, float) else json.dumps(value)


def with_default(row: Row, known: list[Data], root: Data) -> str:
    """The line of a key that is left out, with its default; without one, and in a list of tables, with the example that it has."""
    above = fields(root, row.path[:-1])
    default = next((each["default"] for each in known if "default" in each), None)
    example = not above or any(tables_of(each, root) == [] or "items" in each for each in above)
    if default is None or example or tomllib.loads(f"x = {row.value}")["x"] == default:
        return row.text
    return f"# {row.path[-1]} = {shown(default)}"


def written(name: str, starter: str) -> str:
    """The starter of a mechanism with comments and defaults as its class has them."""
    root = load(name).model_json_schema()
    lines: list[str] = []
    seen: set[tuple[str, ...]] = set()
    replaced = False
    for row in rows(starter):
        if replaced and _MORE.fullmatch(row.line):
            continue
        known = fields(root, row.path) if row.path else []
        field = next((each for each in known if "description" in each), None)
        replaced = field is not None and row.path not in seen
        if field is None or not replaced:
            lines.append(row.line)
            continue
        seen.add(row.path)
        text = with_default(row, known, root) if row.asleep and row.value else row.text
        first, *more = comment(field, row.path[-1])
        column = next((each for each in COLUMNS if len(text) < each), len(text) + 1)
        lines.append(f"{text.ljust(column)}# {first}")
        lines += [f"{'':{column}}# {each}" for each in more]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    for mechanism in sys.argv[1:] or MECHANISMS:
        made = written(mechanism, starters.text(mechanism))
        (starters.folder() / f"{mechanism}.toml").write_text(made, encoding="utf-8", newline="\n")
