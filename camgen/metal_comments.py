"""What the comments of a starter say of prints, said of metal: keys of printers are left out, words are exchanged."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

_COLUMN = 36  # of a comment behind a key
_WIDTH = 140  # of a line
_ENTRY = re.compile(r"((?:# )?([\w.\"-]+) = .*?|(?:# )?\[.*?\])( +# (.*))?")
_MORE = re.compile(r" {20,}# (.*)")

# Keys that are of a printer, of its material or of a part in two pieces, as one prints it.
_OF_PRINTERS = {
    *("nozzle", "bed", "bed_height", "bed_margin", "hole_compensation", "profile_compensation"),
    *("shrinkage", "elephant_foot", "first_layer", "layer", "xy_step", "infill", "pieces"),
    *("size_error", "place_error", "form_error", "form_orders"),
}
# Words of prints, and what is so in metal.
_WORDS = {
    "your printer, and the fits that it needs": "clearances of what moves and of what is pressed in",
    "material that you print with, or cut parts from": "material that parts are cut from",
    'printed: "PLA", "PETG", "ABS", "ASA", "nylon" or "PC"; cut: ': "",
    "0.7 for prints, 0.42 for metals, 0.2 for a print on metal, 0.0015 for": "0.42, 0.0015 for",
    ", printed as this one is": ", made as this one is",
    ", pressed in along the rim of a printed one": ", pressed in along its rim",
    "with a printed cap": "with a cap",
    "a printed pin in ball bearings": "a pin in ball bearings",
    "; printed holes come out narrower: see hole_compensation": "",
    "two lines of the nozzle, in metal 1, and in a": "1, in a",
    "the pressure at which the strongest printed plastic yields": "what the material bears",
    "the running play of printed parts": "the running play",
    "a printed machine with a slide": "a machine with a slide",
    "the whole machine, printed": "the whole machine",
}
# Lines of a starter's own text.
_LINES = {
    "# A printed groove is made in two pieces, the drum and a ring glued on it, each printed with its wall up: no support stands where the roller\n"
    "# runs. An end cam needs none either. A drum of metal is one piece.\n": "# A drum of metal is one piece.\n",
    "\nclearance = 0.14\n": f"\n{'clearance = 0.14':{_COLUMN}}# mm; at the limits of all sheets the lock still turns\n",
    "# Printed pins do not bear the unloader's spring.\n": "",
    "show their defaults": "show usual values (metal has defaults of its own)",
}


@dataclass(frozen=True)
class _Entry:
    """A line of a starter with the lines on which its comment goes on."""

    lines: Sequence[str]
    text: str = ""  # key and value, or a table's head, without the comment
    key: str = ""
    comment: str = ""

    @property
    def asleep(self) -> bool:
        """Whether it is behind a #."""
        return self.text.startswith("# ")


def in_metal(starter: str) -> str:
    """The text of a starter of metal with comments that speak of that; what it sets stays."""
    for words, of_metal in _LINES.items():
        starter = starter.replace(words, of_metal)
    entries = list(_entries(starter))
    tables = [
        0,
        *(k for k, each in enumerate(entries) if each.text.lstrip("# ").startswith("[")),
        len(entries),
    ]
    kept = [each for a, b in zip(tables, tables[1:], strict=False) for each in _awake(entries[a:b])]
    lines = [line for each in kept for line in _said(each).lines]
    return "\n".join([*lines, ""])


def _entries(starter: str) -> Iterator[_Entry]:
    """The lines of a starter, those together on which a comment goes on."""
    held: _Entry | None = None
    for line in starter.splitlines():
        more = _MORE.fullmatch(line)
        if more and held is not None and held.comment:
            held = replace(held, lines=[*held.lines, line], comment=f"{held.comment} {more[1]}")
            continue
        if held is not None:
            yield held
        found = _ENTRY.fullmatch(line)
        held = _Entry([line], found[1], found[2] or "", found[4] or "") if found else _Entry([line])
    if held is not None:
        yield held


def _awake(table: Sequence[_Entry]) -> Iterator[_Entry]:
    """A table's entries without those of printers; a key that is set without a comment stands where it is behind a #, with that comment."""
    asleep = {each.key for each in table if each.asleep and each.key}
    plain = {each.key: each for each in table if each.key in asleep and not each.asleep}
    waiting = set(plain)
    for each in table:
        if plain.get(each.key) is each or (each.asleep and each.key in _OF_PRINTERS):
            continue
        if each.key in waiting:
            waiting.remove(each.key)
            yield _wrapped(replace(each, text=plain[each.key].text))
        else:
            yield each


def _said(entry: _Entry) -> _Entry:
    """With a comment that speaks of metal."""
    comment = entry.comment
    for words, of_metal in _WORDS.items():
        comment = comment.replace(words, of_metal)
    return entry if comment == entry.comment else _wrapped(replace(entry, comment=comment))


def _wrapped(entry: _Entry) -> _Entry:
    """With its comment in lines anew."""
    column = max(_COLUMN, len(entry.text) + 1)
    rows = textwrap.wrap(entry.comment, _WIDTH - column - 2, break_long_words=False) or [""]
    first = f"{entry.text.ljust(column)}# {rows[0]}"
    return replace(entry, lines=[first, *(f"{'':{column}}# {row}" for row in rows[1:])])
