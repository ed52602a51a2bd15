"""The starter specs and examples that come with the package, and the schemas that editors take beside a spec."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from camgen import spec as specs
from camgen.errors import file_errors
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
    """The schema as a file holds it."""
    return json.dumps(specs.schema(cls, mechanism), indent=2, ensure_ascii=False) + "\n"


def write_schema(cls: type[Spec], mechanism: str, where: Path) -> bool:
    """Write it beside a spec that names it, and say so; a file that is there already stays as it is."""
    with file_errors():
        try:
            with open(where / schema_name(mechanism), "x", encoding="utf-8") as stream:
                stream.write(schema_text(cls, mechanism))
        except FileExistsError:
            return False
    return True
