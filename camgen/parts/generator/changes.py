"""Changes of a spec that may mend what cannot be made."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from camgen.errors import DesignError
from camgen.parts.generator.sizes import Parts


@dataclass(frozen=True)
class Change:
    """A change of a spec."""

    words: str
    sizes: Mapping[str, Any] = field(default_factory=dict)  # keys of [parts] that it sets
    free: bool = False  # whether it leaves [layers] out

    def of(self, sizes: Parts) -> Parts:
        """Sizes with this change."""
        return type(sizes).model_validate(_set(sizes.model_dump(exclude_none=True), self.sizes))

    def also(self, other: Change) -> Change:
        """Both."""
        words = f"{self.words} and {other.words}"
        return Change(words, _set(self.sizes, other.sizes), self.free or other.free)

    def tables(self, spec: Mapping[str, Any]) -> dict[str, Any]:
        """Tables of a spec with this change."""
        tables = {**spec, "parts": _set(spec.get("parts", {}), self.sizes)}
        return {**tables, "layers": {}} if self.free else tables


class Unmade(DesignError):
    """What cannot be made of one size or kind.

    kind: name of the change that may mend it, where it does not; guess: what may mend it too.
    """

    def __init__(self, error: DesignError, kind: str, change: Change) -> None:
        mended = error.mended(f"{error.remedy}, or set {change.words}")
        super().__init__(error.quantity, error.value, error.limit, error.unit)
        vars(self).update(vars(mended))
        self.args = mended.args
        self.kind = kind
        self.change = change
        self.guess = error.remedy


def _set(table: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """The table with these keys, those of tables in it one by one."""
    tables = {
        key: _set(table.get(key, {}), value)
        for key, value in changes.items()
        if isinstance(value, Mapping)
    }
    return {**table, **changes, **tables}
