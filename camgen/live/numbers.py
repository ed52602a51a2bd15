"""The numbers and choices that a spec's file holds: what sliders show, and the file with some of them changed."""

from __future__ import annotations

import math
import os
import re
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from camgen import spec as specs
from camgen.errors import Fault, Key, SpecError, dotted, file_errors
from camgen.motion.laws import LAWS
from camgen.schemas import Data, members_of, shortened, step_below

_MOST = 12  # numbers of a list that get a slider each; longer lists are tables of points
_PLAIN = re.compile(r"[\w+., -]{1,100}")  # a number or a word: no table, which could name a file
_COORDINATE = re.compile(r"points\.(.+)\.([01])")
# Of units for either kind of follower the one of a follower that slides (False) or swings (True).
_UNITS: dict[tuple[str, bool | None], str] = {
    ("mm or deg", False): "mm",
    ("mm or deg", True): "deg",
    ("N or N m", False): "N",
    ("N or N m", True): "N m",
    ("N/mm or N m/rad", False): "N/mm",
    ("N/mm or N m/rad", True): "N m/rad",
    ("N s/mm or N m s/rad", False): "N s/mm",
    ("N s/mm or N m s/rad", True): "N m s/rad",
}
_AT_ZERO = {"deg": 30.0}  # how far a slider goes from 0, by unit; else 10


class Refusal(SpecError):
    """What a page asked for and cannot be done; the spec stays as it was."""


@dataclass(frozen=True)
class Number:
    """A value of the spec, and how it may change."""

    key: str  # dotted, as of `--set`
    value: float | str | bool  # what it is now
    low: float = 0.0  # ends of the slider, within what the schema allows
    high: float = 0.0
    step: float = 0.0  # to which it rounds
    unit: str = ""
    about: str = ""
    choices: Sequence[str] = ()  # in place of a slider, where the value is one of a few


def numbers(data: Data, schema: Data) -> list[Number]:
    """The numbers and choices that the spec's tables hold, in their order; included machines keep theirs to themselves."""
    swings = _swings(data)
    return [
        replace(each, unit=_UNITS.get((each.unit, swings), each.unit))
        for key, value in data.items()
        if key != "mechanism"
        for each in _below((key,), value, schema, schema)
    ]


def _swings(data: Data) -> bool | None:
    """Whether the spec's one follower swings; None where it has no such table."""
    geometry = data.get("geometry")
    follower = geometry.get("follower") if isinstance(geometry, dict) else None
    motion = follower.get("motion") if isinstance(follower, dict) else None
    return None if motion is None else bool(motion == "oscillating")


def _below(path: Key, value: Any, above: Data, root: Data) -> Iterator[Number]:
    node = step_below(above, path[-1], root)
    if node is None:
        return
    if isinstance(value, dict):
        for key, item in value.items():
            if "." not in key:
                yield from _below((*path, key), item, node, root)
    elif (
        isinstance(value, list)
        and len(value) <= _MOST
        or isinstance(value, list)
        and isinstance(value[0], dict)
    ):
        for k, item in enumerate(value):
            yield from _below((*path, k), item, node, root)
    elif isinstance(value, bool | str | int | float):
        unit = str(node.get("unit", above.get("unit", "")))
        about = str(node.get("description", ""))
        yield from _one(path, value, unit if unit != "1" else "", about, members_of(node, root))


def _one(
    path: Key, value: bool | str | int | float, unit: str, about: str, members: Sequence[Data]
) -> Iterator[Number]:
    if isinstance(value, bool):
        yield Number(dotted(path), value, about=about, choices=("false", "true"))
        return
    names = (
        list(LAWS)
        if path[1:] and path[-1] == "law"
        else [str(name) for member in members for name in member.get("enum", ())]
    )
    if isinstance(value, str) or names:
        if str(value) in names:
            yield Number(dotted(path), value, about=about, choices=names)
        return
    kind = next((member for member in members if member.get("type") in ("number", "integer")), None)
    if kind is not None and math.isfinite(value):
        yield Number(dotted(path), value, *_slider(value, kind, unit), unit, about)


def _slider(value: float, kind: Data, unit: str) -> tuple[float, float, float]:
    """Ends and step: from 0 to twice the value, or all that the schema allows where that is little more."""
    least = float(kind.get("minimum", kind.get("exclusiveMinimum", -math.inf)) or 0.0)
    most = float(kind.get("maximum", kind.get("exclusiveMaximum", math.inf)) or 0.0)
    reach = abs(value) or _AT_ZERO.get(unit, 10.0)
    low, high = (
        (least, most)
        if most - least <= 4 * reach
        else (max(least, value - reach), min(most, value + reach))
    )
    step = 10.0 ** math.floor(math.log10((high - low) / 100)) if high > low else 1.0
    step = max(step, 1.0) if kind["type"] == "integer" else step
    low = low + step if "exclusiveMinimum" in kind and low == least else low
    high = high - step if "exclusiveMaximum" in kind and high == most else high
    return low, high, step


def overrides(settings: object, numbers: Sequence[Number]) -> list[str]:
    """Settings that a page sends, {key: text}, as those of `--set`; Refusal for keys that are none of the known ones, and for
    values that are no number and none of the words to choose from."""
    known = {number.key: number for number in numbers}
    if not isinstance(settings, Mapping) or len(settings) > len(known):
        raise Refusal(
            [Fault(("settings",), "", f"a table of at most {len(known)} keys and values")], "page"
        )
    faults = list[Fault]()
    for key, text in settings.items():
        if key not in known:
            faults.append(specs.unknown(("settings",), shortened(str(key)), known))
        elif right := _right(known[key], text):
            faults.append(Fault((), shortened(str(text)), right, source=_label(key)))
    if faults:
        raise Refusal(faults, "page")
    return [f"{key}={text}" for key, text in settings.items()]


def _right(number: Number, text: object) -> str:
    """What to type in place of a text; "" where it is right as it is."""
    if not (isinstance(text, str) and _PLAIN.fullmatch(text) and text.strip()):
        return "a number or a word, as a spec writes it"
    if number.choices:
        return "" if text in number.choices else f"one of {', '.join(number.choices)}"
    if is_number(text):
        return ""
    return typed_number(
        text, f"a number, in {number.unit}" if number.unit else "a number", number.unit
    )


def is_number(text: str) -> bool:
    """Whether a text is a finite number."""
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False


def typed_number(text: str, right: str, unit: str) -> str:
    """What to type in place of a text that is a number with its unit, or with a decimal comma; else as `right` says."""
    bare = text.strip().removesuffix(unit).strip()
    pointed = bare.replace(",", ".")
    if is_number(pointed) and pointed != text.strip():
        how = "a decimal point, not a comma" if "," in text else "a number without a unit"
        return f"{how}: {pointed}"
    return right


def _label(key: str) -> str:
    """A key as its line of the page calls it: a point's x or y."""
    point = _COORDINATE.fullmatch(key)
    return f"{point[1]} {'xy'[int(point[2])]}" if point else key


def write(path: Path, text: str) -> None:
    """Write a spec whole or not at all, with its rights as they were; FileError where that cannot be done."""
    path = path.resolve()
    with file_errors():
        handle, part = tempfile.mkstemp(
            ".part", f".{path.name}.", path.parent
        )  # a name that nobody has put a link at
        try:
            with open(handle, "w", encoding="utf-8", newline="") as file:
                file.write(text)
            os.chmod(part, path.stat().st_mode & 0o777)
            os.replace(part, path)
        except BaseException:
            Path(part).unlink(missing_ok=True)
            raise
