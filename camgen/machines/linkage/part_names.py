"""Names of a linkage's parts: no two that differ in their capitals alone, since their files would be one on some systems."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from camgen.errors import Fault, Key, SpecError
from camgen.parts.generator.joints import part_name
from camgen.parts.generator.layout import pivot_name
from camgen.parts.part import Part


def refuse_alike(parts: Iterable[Part], links: Iterable[str], discs: Iterable[str]) -> None:
    """Raise SpecError where a part that is called after a link, or after a point of parts.discs, is not the only one of its name."""
    number = Counter(part.name.lower() for part in parts)
    named: list[tuple[str, Key]] = [(part_name(link), ("links", link)) for link in links]
    named += [(pivot_name(point), ("parts", "discs", point)) for point in discs]
    right = "another name: this machine has two parts called {}, in capitals or not, and their files would be one"
    faults = [
        Fault(key, "", right.format(name.lower()))
        for name, key in named
        if number[name.lower()] > 1
    ]
    if faults:
        raise SpecError(faults)
