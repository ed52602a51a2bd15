"""The list of an arrangement drawing, over its title block, its first item the lowest. [ISO 7573]

A cell that is longer than its column goes on in the next line.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import zip_longest

import numpy as np

from camgen.files.sheet import Align, Sheet, Text

ROW = 4.0  # of a line, mm
_HEIGHT = 2.5  # of its letters
_LINES = 4  # of a cell, at most, where the list has no room for it in full
_IN_FULL = 12  # of one that is in full
_MORE = " ... as in the parts list"
_HEADS = ("No.", "Qty", "Part", "Drawing, or designation", "Material", "z from, to")
_COLUMNS = (8.0, 8.0, 46.0, 62.0, 16.0, 30.0)
EDGES = np.cumsum((0.0, *_COLUMNS))
_NUMBERS = (0, 1)  # columns that are set to the right


@dataclass(frozen=True)
class Item:
    """A part, or what is bought."""

    number: int
    count: object
    what: str
    designation: str  # the number of its drawing, or what it is sold as
    material: str = ""  # or that it is bought
    heights: Sequence[str] = ()  # from where to where copies reach, mm; or why none is drawn
    most: int = _LINES  # lines of a cell

    @cached_property
    def lines(self) -> list[tuple[str, ...]]:
        """Its cells line by line."""
        cells = (str(self.number), str(self.count), self.what, self.designation, self.material)
        wide = zip(cells, _COLUMNS, strict=False)
        columns = [_wrapped(cell, column - 2, self.most) for cell, column in wide]
        return list(zip_longest(*columns, self.heights, fillvalue=""))

    @property
    def whole(self) -> bool:
        """Whether its cells have all that they are to say."""
        said = (" ".join(filter(None, column)) for column in zip(*self.lines, strict=True))
        return [*said][2:4] == [" ".join(self.what.split()), " ".join(self.designation.split())]


def _wrapped(text: str, room: float, most: int) -> list[str]:
    """A text in so many lines of a cell at most; of one that is too long as much as there is room for."""
    words = text.split()
    for count in range(len(words), 0, -1):
        lines = [""]
        for word in [*words[:count], *(_MORE.split() if count < len(words) else ())]:
            longer = f"{lines[-1]} {word}".strip()
            if not lines[-1] or Text(0j, longer, _HEIGHT).room <= room:
                lines[-1] = longer
            else:
                lines.append(word)
        if len(lines) <= most:
            return lines
    return [text]


def height(items: Sequence[Item]) -> float:
    """Of the list with its head, mm."""
    return ROW * (1 + sum(len(item.lines) for item in items))


def folded(items: Sequence[Item], room: float, most: int) -> list[Sequence[Item]]:
    """A list in columns, so high each and at most so many; where they have no room for all items, the last says how many more there
    are."""
    columns: list[list[Item]] = [[]]
    for k, item in enumerate(items):
        if height([*columns[-1], item]) > room and len(columns) < most:
            columns.append([])
        column = columns[-1]
        last = len(columns) == most and k < len(items) - 1
        if height([*column, item]) + last * ROW > room:
            more = f"{len(items) - k} more: see the list of parts"
            column.append(Item(item.number, "", "", more))
            break
        column.append(item)
    return [*columns]


def folded_in_full(items: Sequence[Item], room: float, most: int) -> list[Sequence[Item]]:
    """The same with all that cells say, of each item in turn where the list has room for it in its columns."""
    chosen = [*items]
    lists = folded(chosen, room, most)
    for k, item in enumerate(items):
        longer = [*chosen[:k], replace(item, most=_IN_FULL), *chosen[k + 1 :]]
        full = folded(longer, room, most)
        if len(full) == len(lists) and sum(map(len, full)) == sum(map(len, lists)):
            chosen, lists = longer, full
    return lists


def draw_list(sheet: Sheet, corner: complex, items: Sequence[Item], columns: int = 6) -> None:
    """Draw so many columns of the list from its lower left corner up."""
    edges = EDGES[: columns + 1]
    level = corner
    rows: list[list[tuple[str, ...]]] = [[_HEADS], *(item.lines for item in items)]
    for lines in rows:
        for line in reversed(lines):
            for k, cell in enumerate(line[:columns]):
                right = k in _NUMBERS
                x = edges[k + 1] - 1 if right else edges[k] + 1
                align: Align = "right" if right else "left"
                at = level + x + 1j * (ROW - _HEIGHT) / 2
                sheet.text(at, cell, _HEIGHT, align, room=_COLUMNS[k] - 2)
            level += 1j * ROW
        sheet.line(level, level + edges[-1], layer="TEXT")
    for x in edges:
        sheet.line(corner + x, level + x, layer="TEXT")
