"""The starter specs, whose comments are what the schema says of each key.

A line `key = value   # what it is` describes a key, with a # before it too; lines of comment alone that are indented go on with
the line above. Tables are as in TOML, `# [load]` is one that a spec may leave out.
"""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from camgen import spec as specs
from camgen.errors import file_errors
from camgen.machines import MECHANISMS, load
from camgen.schemas import step_below, tables_of
from camgen.settings import split_setting

if TYPE_CHECKING:
    from camgen.schemas import Data
    from camgen.spec import Spec

_TABLE = re.compile(r"(?:# )?\[\[?([a-zA-Z_.0-9-]+)\]\]?(?:\s+# (.*))?")
_KEY = re.compile(r"(?:# )?([a-zA-Z_\"][a-zA-Z_.0-9\"-]*) = (.*)")
_MORE = re.compile(r"\s{8,}# ?(.*)")
_COMMENT = re.compile(r"""^((?:"[^"]*"|[^"#])*?)\s+# (.*)$""")

# Units by the end of a key's name, the longest first.
_UNITS = {
    "_kg_m2": "kg m^2",
    "_g_mm2": "g mm^2",
    "_n_mm": "N/mm",
    "_n_m": "N m",
    "_deg": "deg",
    "_rpm": "rpm",
    "_kg": "kg",
    "_mm": "mm",
    "_g": "g",
    "_n": "N",
    "ratio": "1",
}

# Units in what is said of a key: "mm, of the hub", "mm or deg, motion that may be lost", "slower to quicker; no unit".
_UNIT = r"(?:mm|deg|share|N s/mm|N m s/rad|N/mm|N m/rad|N m|N|1/s|g/cm\^3|1)"
_SAID = re.compile(rf"(?:^|, )({_UNIT}(?: or {_UNIT})?)(?=[,;: ])|; no (unit)$")


def folder() -> Path:
    """Where the starter specs are: inside the installed package, or beside it in a checkout."""
    package = Path(__file__).parent
    return next(each for each in (package / "specs", package.parent / "specs") if each.is_dir())


def examples() -> list[str]:
    """Names of further specs that stand alone: the gallery, and machines of the class linkage; without those of a front."""
    files = {
        path.stem: path for part in (".", "gallery") for path in (folder() / part).glob("*.toml")
    }
    return sorted(
        name
        for name, path in files.items()
        if name not in MECHANISMS and "\n[[include]]" not in path.read_text(encoding="utf-8")
    )


def text(name: str) -> str:
    """The starter of a mechanism, or an example."""
    return next(folder().rglob(f"{name}.toml")).read_text(encoding="utf-8")


def kind(name: str) -> str:
    """Mechanism of a starter or an example."""
    return name if name in MECHANISMS else str(tomllib.loads(text(name))["mechanism"])


def summary(name: str) -> str:
    """Its first line."""
    return text(name).partition("\n")[0].lstrip("# ")


def rows(starter: str) -> Iterator[tuple[tuple[str, ...], str, str]]:
    """Each key or table of a starter: its path, its value as written (of a table ""), what is said of it."""
    table: tuple[str, ...] = ()
    begun: tuple[tuple[str, ...], str, list[str]] | None = None
    for line in starter.splitlines():
        more = _MORE.fullmatch(line)
        if more and begun:
            begun[2].append(more[1].strip())
            continue
        if begun:
            yield begun[0], begun[1], " ".join(filter(None, begun[2]))
        head, key = _TABLE.fullmatch(line), _KEY.fullmatch(line)
        begun = None
        if head:
            table = tuple(head[1].split("."))
            begun = table, "", [head[2] or ""]
        elif key:
            said = _COMMENT.match(key[2])
            name = (
                tuple(part.strip('"') for part in key[1].split("."))
                if '"' not in key[1]
                else (key[1].strip('"'),)
            )
            begun = (*table, *name), said[1] if said else key[2], [said[2] if said else ""]
    if begun:
        yield begun[0], begun[1], " ".join(filter(None, begun[2]))


def described(cls: type[Spec], mechanism: str) -> Data:
    """The JSON Schema of a mechanism's spec, each key with what its starter says of it and its unit."""
    root = specs.schema(cls, mechanism)
    _tell_units(root)
    for path, _, said in rows(text(mechanism)):
        tables = [root]
        for step in path[:-1]:
            tables = [
                each for table in tables for each in tables_of(step_below(table, step, root), root)
            ]
        for table in tables:
            if said and path[-1] in table.get("properties", ()):
                table["properties"][path[-1]]["description"] = said
    _tell_units(root)
    for table in (root, *root.get("$defs", {}).values()):
        for node in table.get("properties", {}).values():
            for each in tables_of(node, root) + tables_of(step_below(node, "a", root), root):
                if (
                    "description" in each
                ):  # a table: what its class says, where the starter says nothing
                    node.setdefault("description", each["description"].partition("\n")[0])
    return root


def unit_at(data: Mapping[str, Any], path: str) -> str:
    """Unit of a dotted key of a spec; "" where it has none."""
    kind = specs.choose(dict(data), MECHANISMS)
    root = described(load(kind), kind)
    node: Data | None = root
    for step in split_setting(f"{path}=")[0]:
        node = step_below(node, int(step) if step.isdigit() else step, root)
    unit = (node or {}).get("unit", "")
    return "" if unit == "1" else str(unit)


def schema_name(mechanism: str) -> str:
    """Name of the schema's file beside a spec."""
    return f"{mechanism}.schema.json"


def schema_text(cls: type[Spec], mechanism: str) -> str:
    """The schema as a file holds it."""
    return json.dumps(described(cls, mechanism), indent=2, ensure_ascii=False) + "\n"


def write_schema(cls: type[Spec], mechanism: str, where: Path) -> bool:
    """Write it beside a spec that names it, and say so; a file that is there already stays as it is."""
    with file_errors():
        try:
            with open(where / schema_name(mechanism), "x", encoding="utf-8") as stream:
                stream.write(schema_text(cls, mechanism))
        except FileExistsError:
            return False
    return True


def _tell_units(root: Data) -> None:
    """Give each key of numbers its unit, where it is known."""
    for table in (root, *root.get("$defs", {}).values()):
        for name, node in table.get("properties", {}).items():
            unit = _unit(name, node)
            if unit is not None:
                node["unit"] = unit


def _unit(name: str, node: Mapping[str, Any]) -> str | None:
    """Unit of a key: as its type has it, or by the end of its name; None of what is no number."""
    kinds = [node]
    for kind in kinds:
        items = kind.get("items")
        kinds += [
            *kind.get("anyOf", ()),
            *kind.get("prefixItems", ()),
            *([items] if isinstance(items, dict) else []),
        ]
    types = {kind.get("type") for kind in kinds}
    if not types & {"number", "integer"}:
        return None
    typed = next((kind["unit"] for kind in kinds if "unit" in kind), None)
    said = _SAID.search(node.get("description", ""))
    named = next((unit for ending, unit in _UNITS.items() if name.endswith(ending)), None)
    return (
        typed
        or (said and (said[1] or "1").replace("share", "1"))
        or named
        or ("1" if "integer" in types else None)
    )
