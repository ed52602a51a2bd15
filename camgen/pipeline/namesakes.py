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
    """Of which spec file beside this one the earlier result in a folder is, in words; "" where of none, or of this one as well.

    mechanism: that of this spec, with what is left out not yet found. A file that differs from the result in fewer keys than
    this one, as it stands too, is named as probable: it may have been built with --set.
    """
    try:
        earlier = tomllib.loads((folder / SPEC).read_text(encoding="utf-8"))
        fewest = min(_differences(mechanism, earlier), _differences(read_mechanism(spec), earlier))
        others = [path for path in sorted(spec.parent.glob("*.toml")) if path.name != spec.name]
    except (OSError, ValueError, CamgenError):
        return ""
    found = ""
    for path in others:
        try:
            if read(path).get("name") != mechanism.name:
                continue
            count = _differences(read_mechanism(path), earlier)
        except CamgenError:
            continue
        if count < fewest:
            fewest = count
            found = f"probably that of {path}, built with --set," if count else f"that of {path}"
    return found


def _differences(mechanism: Mechanism, earlier: dict[str, Any]) -> int:
    """How many values that a mechanism's spec says are others in the resolved spec of an earlier result."""
    return _count(earlier, tomllib.loads(specs.dump(mechanism)))


def _count(whole: object, part: object) -> int:
    """In how many values a table or list of a resolved spec differs from one in which keys may be left out."""
    if isinstance(whole, dict) and isinstance(part, dict):
        return sum(_count(whole.get(key), value) for key, value in part.items())
    if isinstance(whole, list) and isinstance(part, list):
        shorter = sum(map(_count, whole, part))
        return shorter + abs(len(whole) - len(part))
    return int(whole != part)
