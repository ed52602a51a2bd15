"""Changes of a spec that may mend what cannot be made."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from camgen.errors import DesignError
from camgen.parts.generator.sizes import Parts


@dataclass(frozen=True)
class Change:
    """A change of a spec, in words; sizes: keys of [parts] that it sets, of a link or of pins some; free: whether it leaves
    [layers] out."""

    words: str
    sizes: Mapping[str, Any] = field(default_factory=dict)
    free: bool = False

    def of(self, sizes: Parts) -> Parts:
        """The sizes so changed."""
        return type(sizes).model_validate(_set(sizes.model_dump(exclude_none=True), self.sizes))

    def also(self, other: Change) -> Change:
        """Both."""
        return Change(
            f"{self.words} and {other.words}",
            _set(self.sizes, other.sizes),
            self.free or other.free,
        )

    def tables(self, spec: Mapping[str, Any]) -> dict[str, Any]:
        """The tables of a spec so changed."""
        found = {**spec, "parts": _set(spec.get("parts", {}), self.sizes)}
        return {**found, "layers": {}} if self.free else found


class Unmade(DesignError):
    """What cannot be made of one size or kind, and a change that may mend it; kind: how it is named where it does not; guess:
    what may mend it too."""

    def __init__(self, error: DesignError, kind: str, change: Change) -> None:
        remedy = f"{error.remedy}, or set {change.words}"
        super().__init__(
            error.quantity,
            error.value,
            error.limit,
            error.unit,
            error.where,
            remedy,
            error.sentence,
        )
        self.kind, self.change, self.guess = kind, change, error.remedy


def _set(table: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """The table with these keys, those of tables in it one by one."""
    tables = {
        key: _set(table.get(key, {}), value)
        for key, value in changes.items()
        if isinstance(value, Mapping)
    }
    return {**table, **changes, **tables}
