"""A spec's text with some of it changed: comments, order and layout stay."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Any

from camgen import reading
from camgen.settings import override


def edited(text: str, settings: Sequence[str]) -> str:
    """The text with some keys set anew, KEY=VALUE as of `--set`; a key that it did not have is added to its table."""
    import tomlkit

    document = tomlkit.parse(text)
    data: reading.Data = document.unwrap()
    for setting in settings:
        data = override(data, setting)
        holder: Any = document
        value: Any = data
        *tables, last = (
            (int(step) if step.isdigit() else step) for step in setting.partition("=")[0].split(".")
        )
        for step in tables:
            if isinstance(step, str) and step not in holder:
                holder[step] = tomlkit.table()
            holder = holder[step]
            value = value[step]
        put(holder, last, value[last])
    return tomlkit.dumps(document)


def put(holder: Any, key: str | int, value: Any) -> None:
    """Set a key of a document's table, or an item of its list; a comment behind it stays in its column."""
    if isinstance(key, str) and key not in holder:
        if isinstance(value, dict):  # on one line, among the keys of its table
            from tomlkit import inline_table

            row = inline_table()
            row.update(value)
            value = row
        holder[key] = value
    elif holder[key] != value:
        before = holder[key]
        holder[key] = value
        trivia = holder[key].trivia
        longer = len(holder[key].as_string()) - len(before.as_string())
        if trivia.comment:
            trivia.comment_ws = " " * max(1, len(trivia.comment_ws) - longer)


def with_tables(
    text: str, tables: Mapping[str, Any], without: Collection[str] = (), said: str = ""
) -> str:
    """The text with whole tables added, or keys added to tables that it has, less some tables; said: a comment before them."""
    import tomlkit

    document: Any = tomlkit.parse(text)
    for name in without:
        document.pop(name, None)
    if said:
        document.add(tomlkit.nl())
        document.add(tomlkit.comment(said))
    for name, value in tables.items():
        if isinstance(value, Mapping):
            if name not in document:
                document.add(tomlkit.nl())
                document.add(name, tomlkit.table())
            for key, each in value.items():
                if key not in document[name]:
                    document[name][key] = each
        else:
            rows = tomlkit.aot()
            for row in value:
                rows.append(tomlkit.item(row))
            document.add(tomlkit.nl())
            document.add(name, rows)
    return tomlkit.dumps(document)
