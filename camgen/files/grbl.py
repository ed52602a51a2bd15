"""Programs for Grbl 1.1: motors that turn together, straight from row to row, each row in its own time.

An axis X, Y, Z is a motor and its "mm" a degree: $100 to $102 are steps per degree. The words are those of Grbl's documentation
(commands.md, version 1.1) and of its parser: G90 places, G93 with an F in every block (1 / minutes that it takes), G4 P seconds of rest,
since a block of no step is left out, G92 to call the place where the motors stand 0, M2 the end. No controller has been asked.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from camgen.bounds import Bound, read_bytes
from camgen.errors import FileError
from camgen.numerics import Floats

ENDING = "grbl.nc"
AXES = ("X", "Y", "Z")
_SIZE = Bound("a program for Grbl", 10_000_000, most=200_000)
_PLACES = 4  # decimals of a degree
_FEEDS = 6  # significant digits of F
_COMMENT = re.compile(r"\([^)]*\)|;.*")
_WORD = re.compile(r"([A-Z])([-+]?\d+\.?\d*)")
_MODES = frozenset({"G21", "G90", "G93"})
_LETTERS = {"G92": "", "G1": "F", "G4": "P", "M2": ""}  # of a block's words beside axes


@dataclass(frozen=True)
class GrblProgram:
    """Places of motors at times: minutes, (n,), from 0 on, and deg, (n, k), from 0 on; lines between them."""

    minutes: Floats
    turned: Floats

    def text(self, names: Sequence[str]) -> str:
        """The whole program; names: of the motors."""
        listed = ", ".join(
            f"{axis}: {_plain(name)}" for axis, name in zip(AXES, names, strict=False)
        )
        head = [f"({listed})", "(deg; set steps per deg as $100, $101, $102)", "G21 G90 G93"]
        zero = " ".join(f"{axis}0" for axis, _ in zip(AXES, names, strict=False))
        lines = [*head, f"G92 {zero}"]
        written = np.round(self.turned, _PLACES) + 0.0
        taken = np.diff(self.minutes)
        for k, minutes in enumerate(taken.tolist()):
            if np.array_equal(written[k], written[k + 1]):
                lines.append(f"G4 P{60 * minutes:.6f}")
                continue
            words = [
                f"{a}{x:.{_PLACES}f}" for a, x in zip(AXES, written[k + 1].tolist(), strict=False)
            ]
            lines.append(f"G1 {' '.join(words)} F{_decimal(1 / minutes)}")
        return "\n".join([*lines, "M2"]) + "\n"


def _plain(name: str) -> str:
    """A name as a comment may hold it, in a line of 80 characters."""
    return re.sub(r"[^A-Za-z0-9 _-]+", "-", name)[:18]


def _decimal(value: float) -> str:
    """A number without an exponent."""
    return np.format_float_positional(value, precision=_FEEDS, fractional=False, trim="-")


def read_grbl(path: Path, motors: int) -> GrblProgram:
    """A program for so many motors as it is written here; FileError with what is wrong, and in which line."""
    text = read_bytes(path, _SIZE).decode("ascii", errors="replace")
    axes = AXES[:motors]
    modes: set[str] = set()
    place: dict[str, float] = {}
    minutes = [0.0]
    rows: list[list[float]] = []
    ended = False
    for number, line in enumerate(text.splitlines(), 1):
        codes, values = _block(path, number, line, axes)
        if ended and codes:
            raise FileError(path, f"line {number} comes after M2, which ends the program")
        modes |= codes & _MODES
        ended |= "M2" in codes
        if "G92" in codes:
            if rows:
                raise FileError(path, f"line {number} has a second G92: the places before it move")
            place = values
            rows = [list(place.values())]
        elif codes & {"G1", "G4"}:
            minutes.append(minutes[-1] + _taken(path, number, codes, values))
            place |= {axis: values[axis] for axis in place if axis in values}
            rows.append(list(place.values()))
    if not _MODES <= modes or len(rows) != len(minutes) or len(rows) < 2 or len(place) != motors:
        reason = f"is no such program: G21, G90, G93, a G92 with {', '.join(axes)} and then G1 or G4 were expected"
        raise FileError(path, reason)
    if not ended:
        raise FileError(path, "cut short: it does not end in M2")
    return GrblProgram(np.array(minutes), np.array(rows))


def _block(
    path: Path, number: int, line: str, axes: Sequence[str]
) -> tuple[set[str], dict[str, float]]:
    """Codes and values of a line; FileError where it has a word that is not written here, or one twice."""
    block = _COMMENT.sub("", line).strip()
    words = _WORD.findall(block)
    if "".join(f"{a}{b}" for a, b in words) != block.replace(" ", ""):
        raise FileError(
            path, f"line {number} has {block[:40]!r}: letters with numbers were expected"
        )
    codes = [f"{a}{float(b):g}" for a, b in words if a in "GM"]
    letters = [a for a, _ in words if a not in "GM"]
    known = _MODES if set(codes) <= _MODES else {codes[0]} & _LETTERS.keys()
    allowed = {*known, *(axes if known & {"G1", "G92"} else ())}
    allowed.update(*(_LETTERS.get(code, "") for code in known))
    for word in (*codes, *letters):
        if word not in allowed:
            raise FileError(path, f"line {number} has {word}, which no such program has there")
    if len({*codes, *letters}) < len(words):
        raise FileError(path, f"line {number} has a word twice")
    return set(codes), {a: float(b) for a, b in words if a not in "GM"}


def _taken(path: Path, number: int, codes: set[str], values: dict[str, float]) -> float:
    """Minutes of a block."""
    key = "F" if "G1" in codes else "P"
    if not values.get(key, 0.0) > 0:
        raise FileError(path, f"line {number} has no {key} above 0, which says how long it takes")
    return 1 / values[key] if key == "F" else values[key] / 60
