"""The starter specs and examples that come with the package, and the schemas that editors take beside a spec."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from copy import deepcopy
from functools import reduce
from itertools import groupby
from operator import getitem
from pathlib import Path
from typing import TYPE_CHECKING, Any

from camgen import spec as specs
from camgen.errors import SpecError, file_errors
from camgen.machines import MECHANISMS, load
from camgen.schemas import step_below
from camgen.settings import split_setting

if TYPE_CHECKING:
    from camgen.schemas import Data
    from camgen.spec import Spec


def folder() -> Path:
    """Where the starter specs are: inside the installed package, or beside it in a checkout."""
    package = Path(__file__).parent
    return next(each for each in (package / "specs", package.parent / "specs") if each.is_dir())


def pictures() -> Path:
    """Where the pictures of the gallery are, in the same two places."""
    package = Path(__file__).parent
    places = (package / "gallery", package.parent / "out" / "gallery")
    return next(each for each in places if each.is_dir())


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


def named(text: str, name: str) -> str:
    """The same spec under another name; a comment behind it stays in its column."""

    def line(found: re.Match[str]) -> str:
        own = f'name = "{name}"'
        return own.ljust(len(found[0]) - 1) + " " if found[1] else own

    return re.sub(r'^name = "[^"]*"( +(?=#))?', line, text, count=1, flags=re.MULTILINE)


# What makes a starter one to be cut of steel: a bore with its key, a roller that is sold, pins and shafts of steel.
_ROLLER = ("load.mass_kg=0.5", "load.cam_follower=KR16", "motor.model=SGMAH-01AJC")
_SHAFTS = (
    "material.name=C45",
    "parts.thickness=6",
    "parts.shaft_diameter=10",
    "parts.shaft_made=steel",
    "parts.shaft_key=true",
    "parts.base_thickness=10",
    "parts.mount_diameter=4.2",
    "parts.mount_screws=3",
    "parts.wall=3",
    "print.slide_clearance=0.1",
    "print.bore_clearance=0.03",
)
METAL = {
    "disc-cam": (
        "material.name=C45",
        "geometry.base_radius=32",
        "geometry.follower.radius=8",
        "parts.bore=20",
        "parts.bore_shape=keyway",
        "parts.set_screw=M5",
        "spring.rate=1",
        "spring.preload=15",
        *_ROLLER,
    ),
    "cylinder-cam": (
        "material.name=C45",
        "geometry.roller.radius=8",
        "geometry.roller.length=11",
        "parts.bore=20",
        "parts.bore_shape=keyway",
        *_ROLLER,
        "load.gravity_deg=-90",
    ),
    "indexing-cam": (
        "material.name=C45",
        "geometry.follower.roller_radius=9.5",
        "load.cam_follower=KR19",
        "parts.thickness=12",
    ),
    "geneva-table": (
        *_SHAFTS,
        "parts.pin=dowel",
        'parts.pins={ O = "bush", C = "bush" }',
        "geneva.0.gap=2",  # the table passes over the pin at the limits of all heights
        "geneva.0.clearance=0.14",  # the lock turns at the limits of all sheets
        "drawing.profile=0.03",
        "drawing.position=0.03",
        "geneva.0.floor=0.5",
        "geneva.0.pin_radius=5",
    ),
    "linkage": (
        *_SHAFTS,
        "parts.pin=bearing",
        'parts.bearing="695"',
        'parts.pins={ O = "bush" }',
        "parts.hand_crank=40",
        "print.slide_clearance=0.2",
    ),
}

# Keys of prints that a starter sets, behind a #.
_OF_PRINTS = ("nozzle = 0.4", "hub_diameter = 16", "hub_height = 6", "min_wall = 0.8")

_WIDE = 110  # characters of a line


def in_metal(name: str) -> str:
    """A starter or an example of METAL, to be cut of steel."""
    from camgen import metal_comments
    from camgen.edits import edited

    whole = edited(_opened(text(name), METAL[name]), METAL[name])
    for words in _OF_PRINTS:
        whole = whole.replace(f"\n{words}  ", f"\n# {words}")
    return metal_comments.in_metal(whole)


def _opened(whole: str, settings: Sequence[str]) -> str:
    """The text with tables that are behind a #, and their keys that are set, so no longer: values stand where they are explained."""
    lines = whole.splitlines(keepends=True)
    for table, keys in groupby(
        sorted(settings), lambda each: each.partition("=")[0].rpartition(".")[0]
    ):
        header = f"# [{table}] "
        first = next((k for k, line in enumerate(lines) if line.startswith(header)), len(lines))
        own = [f"# {each.partition('=')[0].rpartition('.')[2]} = " for each in keys]
        for k, line in enumerate(lines[first:], first):
            if not line.strip():
                break
            if k == first or line.startswith(tuple(own)):
                lines[k] = line[2:].replace(" #", "   #", 1)
    return "".join(lines)


def short(whole: str) -> str:
    """The same machine in few lines: no comments, no key that has its default; what is short stands on one line."""
    title = whole.partition("\n")[0]
    data = _without_defaults(tomllib.loads(whole))
    lines: list[str] = []
    tables: list[str] = []
    for key, value in data.items():
        line = _line(_key(key), value)
        if not isinstance(value, dict | list) or len(line) <= _WIDE and len(value) == 1:
            lines.append(line)
        elif isinstance(value, list):
            lines += [f"{_key(key)} = [", *(f"  {_inline(row)}," for row in value), "]"]
        else:
            inner = (_line(_key(below), each) for below, each in value.items())
            tables += ["", f"[{_key(key)}]", *inner]
    return "\n".join([title, *lines, *tables, ""])


def _without_defaults(data: Data) -> Data:
    """A spec's tables without the keys that change nothing; rows of lists stay whole."""
    cls = load(str(data["mechanism"]))
    record = specs.validate(cls, data)
    for *tables, key in _paths(data):
        fewer = deepcopy(data)
        del reduce(getitem, tables, fewer)[key]
        with suppress(SpecError):
            if specs.validate(cls, fewer) == record:
                data = fewer
    return data


def _paths(table: Data, above: Sequence[str] = ()) -> Iterator[list[str]]:
    """Steps to each key of some tables, those within a table before itself."""
    for key, value in table.items():
        if isinstance(value, dict):
            yield from _paths(value, (*above, key))
        yield [*above, key]


def _line(key: str, value: Any) -> str:
    """A key with its value; of a table with one key a key with a dot."""
    if isinstance(value, dict) and len(value) == 1:
        ((below, inner),) = value.items()
        return _line(f"{key}.{_key(below)}", inner)
    return f"{key} = {_inline(value)}"


def _key(key: str) -> str:
    return key if re.fullmatch(r"[\w-]+", key, re.ASCII) else json.dumps(key, ensure_ascii=False)


def _inline(value: Any) -> str:
    """A value on one line."""
    if isinstance(value, dict):
        return (
            "{ " + ", ".join(f"{_key(key)} = {_inline(each)}" for key, each in value.items()) + " }"
        )
    if isinstance(value, list):
        return f"[{', '.join(map(_inline, value))}]"
    return json.dumps(value, ensure_ascii=False) if isinstance(value, str | bool) else repr(value)


def kind(name: str) -> str:
    """Mechanism of a starter or an example."""
    return name if name in MECHANISMS else str(tomllib.loads(text(name))["mechanism"])


def summary(name: str) -> str:
    """Its first line."""
    return text(name).partition("\n")[0].lstrip("# ")


def unit_at(data: Mapping[str, Any], path: str) -> str:
    """Unit of a dotted key of a spec; "" where it has none."""
    kind = specs.choose(dict(data), MECHANISMS)
    root = specs.schema(load(kind), kind)
    node: Data | None = root
    for step in split_setting(f"{path}=")[0]:
        node = step_below(node, int(step) if step.isdigit() else step, root)
    unit = (node or {}).get("unit", "")
    return "" if unit == "1" else str(unit)


def schema_name(mechanism: str) -> str:
    """Name of the schema's file beside a spec."""
    return f"{mechanism}.schema.json"


def schema_text(cls: type[Spec], mechanism: str) -> str:
    """The schema as a file holds it: of specs to build, and of those whose [wanted] is for `camgen design`."""
    from camgen.design.wanted import wish_schema

    found = specs.schema(cls, mechanism)
    if "wanted" not in found["properties"]:
        wishes = wish_schema(mechanism)
        found["$defs"] |= wishes.pop("$defs")
        found["properties"]["wanted"] = wishes
        if "anyOf" in wishes:  # tables that a search makes are not to be given
            found["if"] = {"required": ["wanted"]}
            found["else"] = {"required": found["required"]}
            found["required"] = ["mechanism", "name"]
    return json.dumps(found, indent=2, ensure_ascii=False) + "\n"


def write_schema(cls: type[Spec], mechanism: str, where: Path) -> bool:
    """Write it beside a spec that names it, and say so; a file that is there already stays as it is."""
    with file_errors():
        try:
            with open(where / schema_name(mechanism), "x", encoding="utf-8") as stream:
                stream.write(schema_text(cls, mechanism))
        except FileExistsError:
            return False
    return True
