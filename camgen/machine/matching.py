"""Which equation each unknown is solved from."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping
from typing import TypeVar

E = TypeVar("E", bound=Hashable)
U = TypeVar("U", bound=Hashable)


def matching(table: Mapping[E, Iterable[U]]) -> dict[U, E]:
    """Of as many unknowns as can be the equation that each is solved from, no equation twice.   [Kuhn's augmenting paths]

    table: of each equation its unknowns.
    """
    owner: dict[U, E] = {}

    def takes(equation: E, seen: set[U]) -> bool:
        for unknown in table[equation]:
            if unknown not in seen:
                seen.add(unknown)
                if unknown not in owner or takes(owner[unknown], seen):
                    owner[unknown] = equation
                    return True
        return False

    for equation in table:
        takes(equation, set())
    return owner
