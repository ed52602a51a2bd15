"""Tables of a spec that had another name: the old word is taken, with a note, and faults keep the word that was typed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from camgen.errors import Fault, Key
from camgen.reading import Data
from camgen.schemas import shown

RENAMED = {"output": "files"}  # old: new; a list under the old word is another thing


@dataclass(frozen=True)
class Wording:
    """The tables of a spec in the words of today, and how they were typed."""

    data: Data
    typed: Mapping[Key, Key] = field(default_factory=dict)  # of a key of today: as it stands
    twice: Sequence[Fault] = ()  # keys that stand under both words
    notes: tuple[str, ...] = ()  # what to tell of old words

    def as_typed(self, fault: Fault) -> Fault:
        """The fault by the key that the person typed."""
        path = fault.path
        return replace(fault, path=self.typed.get(path[:2], path[:2]) + path[2:])


def wording(data: Data) -> Wording:
    """Read the old words of a spec's tables as those of today."""
    found = Wording(data)
    for old, new in RENAMED.items():
        table, beside = found.data.get(old), found.data.get(new, {})
        if not (isinstance(table, dict) and isinstance(beside, dict)):
            continue
        rest = {key: value for key, value in found.data.items() if key != old}
        typed: dict[Key, Key] = {(new, key): (old, key) for key in table if key not in beside}
        if not beside:
            typed[(new,)] = (old,)
        found = Wording(
            rest | {new: {**table, **beside} if beside else table},
            {**found.typed, **typed},
            [
                *found.twice,
                *(
                    Fault((old, key), shown(table[key]), f"once: {new}.{key} says it too")
                    for key in table
                    if key in beside
                ),
            ],
            (*found.notes, f"[{old}] is read as [{new}]"),
        )
    return found


def key_of_today(keys: list[str], data: Data) -> list[str]:
    """The steps to a key that is to be set: those of today where the tables stand under the new word alone."""
    new = RENAMED.get(keys[0])
    stands = new is not None and isinstance(data.get(new), dict)
    return [new, *keys[1:]] if new and stands and keys[0] not in data else keys
