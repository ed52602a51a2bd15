"""Two specs of one name in a folder write the same output folder: which of them an earlier result is from."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

from camgen import spec as specs
from camgen.errors import CamgenError
from camgen.files.folder import SPEC
from camgen.machines.mechanism import Mechanism
from camgen.machines.sources import read_mechanism
from camgen.reading import read


def namesake(spec: Path, mechanism: Mechanism, folder: Path) -> str:
    """The spec file beside this one that describes the earlier result in a folder; "" where none does, or this one too.

    mechanism: that of this spec, with what is left out not yet found.
    """
    try:
        earlier = tomllib.loads((folder / SPEC).read_text(encoding="utf-8"))
        if _describes(mechanism, earlier):
            return ""
        others = [path for path in sorted(spec.parent.glob("*.toml")) if path.name != spec.name]
    except (OSError, ValueError):
        return ""
    for path in others:
        try:
            named = read(path).get("name") == mechanism.name
            if named and _describes(read_mechanism(path), earlier):
                return str(path)
        except CamgenError:
            continue
    return ""


def _describes(mechanism: Mechanism, earlier: dict[str, Any]) -> bool:
    """Whether all that a mechanism's spec says stands in the resolved spec of an earlier result."""
    return _holds(earlier, tomllib.loads(specs.dump(mechanism)))


def _holds(whole: object, part: object) -> bool:
    """Whether a value is that of a resolved spec, or a table or list of it with keys left out."""
    if isinstance(whole, dict) and isinstance(part, dict):
        return all(key in whole and _holds(whole[key], value) for key, value in part.items())
    if isinstance(whole, list) and isinstance(part, list):
        return len(whole) == len(part) and all(map(_holds, whole, part))
    return whole == part
