"""Words of a spec that have another name today: an old one is taken, with a note, and faults keep the word that was typed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from camgen.errors import Fault, Key, dotted
from camgen.reading import Data

# Of a table, ("output",), of a key in one, ("parts", "flange"), or of its value, ("parts", "make", "machine"): the word of today.
OldWords = Mapping[tuple[str, ...], tuple[str, ...]]


@dataclass(frozen=True)
class Wording:
    """The tables of a spec in the words of today, and how they were typed."""

    data: Data
    typed: Mapping[Key, Key]  # of a key of today: as it was typed
    notes: tuple[str, ...]  # what to tell of old words

    def as_typed(self, fault: Fault) -> Fault:
        """The fault by the key that the person typed."""
        known = next((n for n in (2, 1) if fault.path[:n] in self.typed), 0)
        return replace(fault, path=self.typed.get(fault.path[:known], ()) + fault.path[known:])


def wording(data: Data, old_words: OldWords) -> Wording:
    """Read the old words of a spec's tables; what stands under both words is that of the old one, such as of `--set`.

    Where a list stands under the old word of a table, or a table under that of a key, it is another thing, and is left.
    """
    typed: dict[Key, Key] = {}
    notes = []
    for old, new in old_words.items():
        source = data.get(old[0])
        if not isinstance(source, dict) or (len(old) > 1 and not _has(source, *old[1:])):
            continue
        target = data.get(new[0], {})
        if not isinstance(target, dict):
            continue
        moved = {key: key for key in source} if len(old) == 1 else {old[1]: new[1]}
        left = {key: value for key, value in source.items() if key not in moved}
        into = left if old[0] == new[0] else target
        beside = [dotted((new[0], key)) for key in moved.values() if key in into]
        data = {key: value for key, value in data.items() if key != old[0]}
        if len(old) > 1:
            data[old[0]] = left
        data[new[0]] = {**into, **{key: (*new[2:], source[word])[0] for word, key in moved.items()}}
        typed |= {(new[0], key): (old[0], word) for word, key in moved.items()}
        if not into:
            typed[new[:1]] = old[:1]
        place = f", in place of {', '.join(beside)} beside it" if beside else ""
        notes.append(f"{_written(old)} is read as {_written(new)}{place}")
    return Wording(data, typed, tuple(notes))


def _has(table: Data, key: str, *value: str) -> bool:
    """Whether a table has a key that is no table; with that value, if one is given."""
    return key in table and not isinstance(table[key], dict) and value in ((), (table[key],))


def _written(word: tuple[str, ...]) -> str:
    """A table, key or value as a person writes it."""
    return dotted(word) if len(word) < 3 else f'{dotted(word[:2])} = "{word[2]}"'
