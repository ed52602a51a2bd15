"""Settings such as "geometry.swing_deg=24", as `--set` takes them: split into keys and value, and set in a spec's tables.

"segment.1.lift=80" goes into a list, "wanted.feed_range=" removes; keys are bare or quoted, as in TOML.
"""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import replace
from difflib import get_close_matches
from fractions import Fraction
from functools import lru_cache
from typing import Any

from camgen.errors import Fault, SpecError, dotted
from camgen.reading import DEEPEST, SHALLOWER, Data, extent_of
from camgen.schemas import shortened, shown

_STEP = re.compile(r"""\s*(?:"((?:[^"\\]|\\.)*)"|'([^']*)'|([^.=]*?))\s*([.=])""", re.DOTALL)

_PLAIN = re.compile(r"[\w-]+(\.[\w-]+)*=")  # most settings

_DECIMAL = re.compile(r"-?(0|[1-9]\d*)\.\d+")  # as TOML has it, too


def quotient(value: object) -> object:
    """A ratio that is typed as text, "-12/30" or "-0.4", as a number; anything else as it is."""
    if not isinstance(value, str):
        return value
    try:
        return float(Fraction(value.replace(" ", "")))
    except (ValueError, ArithmeticError):
        return value


def split_setting(setting: str) -> tuple[list[str], str]:
    """The keys of "lengths.'A-B' = 5", bare or quoted as in TOML, and the text behind "="; no keys where it has no such form."""
    if plain := _PLAIN.match(setting):
        return plain[0][:-1].split("."), setting[plain.end() :]
    keys = list[str]()
    place = 0
    while found := _STEP.match(setting, place):
        quoted, literal, bare, end = found.groups()
        if quoted is not None:
            try:
                (quoted,) = tomllib.loads(f'"{quoted}" = 0')
            except ValueError:
                return [""], ""
        keys.append(next(key for key in (quoted, literal, bare) if key is not None))
        place = found.end()
        if end == "=":
            return keys, setting[place:]
    return [""], ""


def override(data: Data, setting: str) -> Data:
    """Copy of the tables with one value set, "geometry.swing_deg=24", or removed, "wanted.feed_range="; the value is TOML, or
    else text. A list goes by its index from 0, as faults tell it: "segment.1.lift=80". A key may be quoted, as in TOML.

    A key that no spec has is left for `validate` to find; SpecError where the setting is not of this form, where a list is
    shorter, and where there is nothing to remove.
    """
    keys, text = split_setting(setting)
    if not all(keys):
        key, _, value = setting.partition(":")
        known = re.fullmatch(r"\s*[\w-]+(\.[\w-]+)+\s*", key)
        such = f"{key.strip()}={value.strip() or '24'}" if known else "geometry.swing_deg=24"
        raise SpecError([Fault((), shown(setting), f"KEY=VALUE, such as {such}", source="--set")])
    if places := [key for key in keys if re.fullmatch(r"[\w-]+\[\d+\]", key)]:
        right = f"the place of a row behind a dot: {places[0].replace('[', '.').rstrip(']')}"
        raise SpecError([Fault((), shown(setting), right, source="--set")])
    return _assigned(data, keys, None if not text.strip() else _value(text))


def assigned(data: Data, key: str, value: Any) -> Data:
    """The same of a key as a person types it, "lengths.A-B", and a value of Python; None removes the key."""
    keys = _steps(key)
    if not keys:
        raise SpecError([Fault((), shown(key), "such as geometry.swing_deg", source="key")])
    try:
        return _assigned(data, keys, _plain(value))
    except SpecError as error:
        raise SpecError([replace(fault, source="") for fault in error.faults]) from None


@lru_cache(maxsize=256)
def _steps(key: str) -> tuple[str, ...]:
    """The steps of a key; none where it is no key."""
    keys, rest = split_setting(f"{key}=")
    return tuple(keys) if all(keys) and not rest else ()


def setting_of(key: str, value: Any) -> str:
    """A key and a value of Python as text of `--set`."""
    return f"{key}={_toml(_plain(value))}"


def _plain(value: Any) -> Any:
    """A value of Python as tables hold it: numpy's numbers and arrays, ranges and tuples as numbers and lists."""
    if isinstance(value, str | bool | float | int) and type(value).__module__ == "builtins":
        return value
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, Mapping):
        return {each: _plain(item) for each, item in value.items()}
    return [_plain(item) for item in value] if isinstance(value, Sequence) else value


def _toml(value: Any) -> str:
    """A plain value on one line of TOML."""
    if isinstance(value, dict):
        return (
            f"{{{', '.join(f'{json.dumps(key)} = {_toml(item)}' for key, item in value.items())}}}"
        )
    if isinstance(value, list):
        return f"[{', '.join(map(_toml, value))}]"
    return repr(value) if isinstance(value, float) else json.dumps(value, ensure_ascii=False)


def _assigned(data: Data, keys: Sequence[str], value: Any) -> Data:
    """Copy of the tables with the value at the keys, removed where it is None."""
    removed = value is None
    deep = len(keys) + (extent_of(value)[0] if isinstance(value, dict | list) else 0)
    if deep > DEEPEST:
        raise SpecError([Fault((), f"nested {deep} deep", SHALLOWER, source="--set")])
    changed = dict(data)
    holder: Any = changed
    for depth, name in enumerate(keys, 1):
        key = _key(holder, keys, depth)
        last = depth == len(keys)
        if removed and isinstance(holder, dict) and key not in holder:
            where = f" in {dotted(keys[: depth - 1])}" if depth > 1 else ""
            nearest = get_close_matches(name, holder, 1)
            fault = Fault(
                tuple(keys),
                "",
                f"nothing to remove: there is no {name}{where}",
                nearest[0] if nearest else None,
                source="--set",
            )
            raise SpecError([fault])
        if not last:
            inner = holder.setdefault(key, {}) if isinstance(holder, dict) else holder[key]
            # what lies beside the path stays shared; rows of a record are a tuple
            holder[key] = list(inner) if isinstance(inner, tuple) else copy(inner)
            holder = holder[key]
        elif removed:
            del holder[key]
        else:
            holder[key] = value
    return changed


def _value(text: str) -> Any:
    """A setting's value: TOML, or else text."""
    if _DECIMAL.fullmatch(text):  # most settings of a sweep, which reads many
        return float(text)
    try:
        parsed = tomllib.loads(f"value = {text}")
        return parsed["value"] if len(parsed) == 1 else text
    except (ValueError, RecursionError):
        return text.strip()


def _key(holder: Any, keys: Sequence[str], depth: int) -> Any:
    """The step of --set's path at a depth as a key of the table, or an index of the list, that stands at the steps above it."""
    name = keys[depth - 1]
    if isinstance(holder, dict):
        return name
    where = dotted(keys[: depth - 1])
    if not isinstance(holder, list):
        raise SpecError(
            [Fault(tuple(keys), "", f"{where} is a value and has no keys", source="--set")]
        )
    if not (name.isascii() and name.isdecimal() and len(name) < 10 and int(name) < len(holder)):
        has = (
            f"{len(holder)} items, 0 to {len(holder) - 1}"
            if len(holder) > 1
            else "one item, 0"
            if holder
            else "no item"
        )
        first = f"; {where}.0.{shortened(name)} is that of the first"
        row = len(holder) > 1 and depth == len(keys) and not name.lstrip("-").isdecimal()
        moved = keys[: depth - 1] == ["output"] and not name.isdecimal()  # as a linkage has them
        raise SpecError(
            [
                Fault(
                    tuple(keys),
                    "",
                    f"{where} has {has}: there is no {shortened(name)}{first * row}",
                    f"files.{name}" if moved else None,
                    source="--set",
                )
            ]
        )
    return int(name)
