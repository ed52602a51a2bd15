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
    """The result of which spec file beside this one a folder holds, to the last key; "" where of none, or of this one as well.

    mechanism: that of this spec, with what is left out not yet found.
    """
    try:
        earlier = tomllib.loads((folder / SPEC).read_text(encoding="utf-8"))
        others = [path for path in sorted(spec.parent.glob("*.toml")) if path.name != spec.name]
        if _made_by(mechanism, earlier) or _made_by(read_mechanism(spec), earlier):
            return ""
    except (OSError, ValueError, CamgenError):
        return ""
    for path in others:
        try:
            if read(path).get("name") == mechanism.name and _made_by(read_mechanism(path), earlier):
                return f"the result of {path}"
        except CamgenError:
            continue
    return ""


def _made_by(mechanism: Mechanism, earlier: dict[str, Any]) -> bool:
    """Whether the resolved spec of an earlier result says all that a mechanism's spec says."""
    return _holds(earlier, tomllib.loads(specs.dump(mechanism)))


def _holds(whole: object, part: object) -> bool:
    """Whether a table or list of a resolved spec has each value of one in which keys may be left out."""
    if isinstance(whole, dict) and isinstance(part, dict):
        return all(_holds(whole.get(key), value) for key, value in part.items())
    if isinstance(whole, list) and isinstance(part, list):
        return len(whole) == len(part) and all(map(_holds, whole, part))
    return whole == part
