"""JSON Schemas of specs: what lies below a key, and what it asks for in plain words."""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Mapping, Sequence
from typing import Any

Data = dict[str, Any]


def members_of(node: Data, root: Data) -> list[Data]:
    """The schemas that a value may follow, references resolved, null left out."""
    if "$ref" in node:
        return members_of(root["$defs"][node["$ref"].rsplit("/", 1)[1]], root)
    for key in ("anyOf", "oneOf", "allOf"):
        if key in node:
            return [member for each in node[key] for member in members_of(each, root)]
    return [] if node.get("type") == "null" else [node]


def keys_of(node: Data | None, root: Data) -> Data:
    """Keys of a table's schema and their schemas; of all members of a union together."""
    return {
        key: value
        for member in members_of(node or {}, root)
        for key, value in member.get("properties", {}).items()
    }


def step_below(node: Data | None, step: str | int, root: Data) -> Data | None:
    """Schema one step below: of a table's key or a list's item; None where there is none."""
    if isinstance(step, str):
        members = members_of(node or {}, root)
        names = [rule for member in members for rule in member.get("patternProperties", {}).items()]
        free = [
            member["additionalProperties"]
            for member in members
            if isinstance(member.get("additionalProperties"), dict)
        ]
        free += [rule for pattern, rule in names if re.search(pattern, step)]
        table: Data | None = keys_of(node, root).get(step) or next(iter(free), None)
        return table
    for member in members_of(node or {}, root):
        items: list[Data] = member.get("prefixItems", [])
        if member.get("type") == "array":
            return items[step] if step < len(items) else member.get("items")
    return None


_SPELLINGS = (("center", "centre"), ("color", "colour"), ("gray", "grey"))


def other_spelling(key: str, known: Collection[str]) -> str | None:
    """The key that is known of one in American or British spelling; None where there is none."""
    swapped = (key.replace(*way) for pair in _SPELLINGS for way in (pair, pair[::-1]))
    return next((each for each in swapped if each != key and each in known), None)


def tables_of(node: Data | None, root: Data) -> list[Data]:
    """The tables that a value may be, or a list of it may hold."""
    tables = []
    for member in members_of(node or {}, root):
        tables += tables_of(member["items"], root) if "items" in member else [member]
    return tables


def unit_of(node: Data) -> str | None:
    """Unit of a number, or of the numbers that a value is made of; "1" of counts; None of what is no number."""
    kinds = [node]
    for kind in kinds:
        inner = (
            *kind.get("anyOf", ()),
            *kind.get("prefixItems", ()),
            *kind.get("patternProperties", {}).values(),
            *(kind.get(key) for key in ("items", "additionalProperties")),
        )
        kinds += [each for each in inner if isinstance(each, dict)]
    types = {kind.get("type") for kind in kinds}
    units = (str(kind["unit"]) for kind in kinds if "unit" in kind)
    return next(units, "1" if "integer" in types and "number" not in types else None)


# ---- plain words -----------------------------------------------------------------------------------------------------


def in_words(node: Data | None, root: Data) -> str:
    """What a schema asks for, in plain words: "a number > 0 and <= 1000000"."""
    if node is not None and "form" in node:
        return str(node["form"])
    return (
        " or ".join(
            dict.fromkeys(_simple_words(member, root) for member in members_of(node or {}, root))
        )
        or "a value"
    )


_COUNTS = {"minItems": "at least", "maxItems": "at most"}


def _simple_words(node: Data, root: Data) -> str:
    if "form" in node:
        return str(node["form"])
    if "const" in node or "enum" in node:
        return one_of(node.get("enum") or [node["const"]])
    kind = node.get("type")
    if kind == "object":
        if "properties" not in node:
            kinds = [*node.get("patternProperties", {}).values(), node.get("additionalProperties")]
            held = kinds[0]
            return (
                f"a table of names, each {in_words(held, root)}"
                if isinstance(held, dict)
                else "a table"
            )
        return f"a table with {', '.join(node['properties'])}"
    if kind == "array":
        if "prefixItems" in node:
            words = [in_words(item, root) for item in node["prefixItems"]]
            same = len({*words}) == 1 and len(words) > 1
            return (
                f"a list of {len(words)}, each {words[0]}"
                if same
                else f"a list of {', '.join(words)}"
            )
        bounds = " and ".join(f"{word} {node[key]}" for key, word in _COUNTS.items() if key in node)
        return f"a list{f' of {bounds}' if bounds else ''}, each item {in_words(node.get('items'), root)}"
    signs = {"exclusiveMinimum": ">", "minimum": ">=", "exclusiveMaximum": "<", "maximum": "<="}
    bounds = " and ".join(f"{sign} {node[key]:.12g}" for key, sign in signs.items() if key in node)
    name = {
        "number": "a number",
        "integer": "a whole number",
        "boolean": "true or false",
        "string": "text",
    }.get(str(kind), "a value")
    if "pattern" in node:
        name += f" of the form {node['pattern']}"
    return f"{name} {bounds}" if bounds else name


def one_of(names: Sequence[object]) -> str:
    """Values of which one is right."""
    listed = ", ".join(shown(name) for name in names)
    return f"one of {listed}" if len(names) > 1 else listed


def shortened(text: str) -> str:
    """At most 60 characters of it."""
    return text if len(text) <= 60 else text[:57] + "..."


def shown(value: object) -> str:
    """A value as a spec would write it, at most 60 characters."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, Mapping):
        return (
            f"a table with {shortened(', '.join(map(str, value)))}" if value else "an empty table"
        )
    if isinstance(value, list | tuple):
        return shortened(f"[{', '.join(shown(item) for item in value)}]")
    if isinstance(value, int) and abs(value) >= 10**30:
        return f"a number of about 1e{math.floor(math.log10(abs(value)))}"
    if isinstance(value, str):
        return shortened(repr(value))
    if isinstance(value, float):
        return f"{value:.12g}"
    text = str(value)  # of a machine its whole spec
    return text if len(text) <= 60 else shortened(repr(value))
