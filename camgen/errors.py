"""What can go wrong, as exceptions that carry their facts; each class knows its exit code."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import Any, Self, TextIO, TypeVar

E = TypeVar("E", bound="CamgenError")

INTERRUPTED = 130  # exit code after Ctrl-C


def printable(text: str, keep: str = "") -> str:
    """The text with what does not print written as an escape, as `repr` does: nothing in it steers a terminal.

    keep: characters that stay, such as the line breaks of a message.
    """
    return "".join(
        c if c.isprintable() or c in keep else c.encode("unicode_escape").decode() for c in text
    )


def wrapped(text: str, width: int) -> str:
    """The text with lines of at most so many letters, broken at blanks alone: further lines of a sentence are set in by four."""
    from textwrap import fill

    lines = []
    for line in text.split("\n"):
        indent = " " * (len(line) - len(line.lstrip()))
        lines.append(
            fill(
                line,
                width,
                subsequent_indent=f"{indent}    ",
                break_long_words=False,
                break_on_hyphens=False,
            )
            if len(line) > width
            else line
        )
    return "\n".join(lines)


def for_terminal(text: str, stream: TextIO) -> str:
    """The text as a stream shows it: on a terminal wrapped at its width, else as it is."""
    from shutil import get_terminal_size

    return wrapped(text, get_terminal_size().columns) if stream.isatty() else text


class CamgenError(Exception):
    """Base of all errors that a user can cause; `exit_code` is what the command line returns."""

    exit_code = 1

    def __reduce__(self) -> tuple[Any, ...]:
        return _sent, (type(self), self.args, vars(self))


def _sent(kind: type[E], arguments: tuple[Any, ...], facts: dict[str, Any]) -> E:
    """An error as another process raised it: with its facts, not made anew from its message."""
    error = kind.__new__(kind, *arguments)
    vars(error).update(facts)
    return error


UNKNOWN = "unknown key"
COMMAND_LINE = "command line"  # source of faults that no spec has
MOST_LISTED = 100  # faults that a message lists; nobody reads more
LONG_LIST = 100  # letters of a list of names, behind which nobody looks for what was meant


Key = tuple[str | int, ...]  # steps through a spec's tables: names of keys, places in lists from 0


def dotted(key: Sequence[str | int]) -> str:
    """A key as a person types it: its steps joined by dots, quoted where they hold a dot, "=" or a quote."""
    return ".".join(
        json.dumps(step, ensure_ascii=False)
        if isinstance(step, str) and set(step) & set(".=\"'")
        else str(step)
        for step in key
    )


@dataclass(frozen=True)
class Fault:
    """One thing wrong with a spec."""

    path: Key
    value: str  # as found, "" where that says nothing
    expected: str  # what would be right
    nearest: str | None = None  # known key or name
    source: str = ""  # what holds the key, where it is not the spec: an option, a line of a file
    unknown: bool = False  # whether there is no such key
    line: int | None = None  # of the spec's file, from 1, where it stands or its table begins

    @property
    def key(self) -> str:
        """Its place as a person types it, after what holds it."""
        return " ".join(filter(None, (self.source, dotted(self.path))))

    @property
    def facts(self) -> dict[str, Any]:
        """What is wrong, for programs."""
        return {
            "path": self.key,
            "value": self.value,
            "expected": self.expected,
            "nearest": self.nearest,
            "line": self.line,
        }

    def __str__(self) -> str:
        place = self.key if self.line is None else f"line {self.line}: {self.key}"
        if self.unknown:
            known = f"{UNKNOWN}; did you mean '{self.nearest}'?" if self.nearest else self.expected
            return printable(f"{place}: {known}")
        found = f": {self.value} -" if self.value else " -"
        expected = f"expected {self.expected}" if self.value else self.expected
        if self.nearest and len(self.expected) > LONG_LIST:  # what is near comes first
            return printable(f"{place}{found} did you mean '{self.nearest}'? {expected}")
        hint = f" (did you mean '{self.nearest}'?)" if self.nearest else ""
        return printable(f"{place}{found} {expected}{hint}")


class SpecError(CamgenError):
    """The spec is wrong; carries every fault found at once."""

    exit_code = 2

    def __init__(self, faults: Sequence[Fault], source: str = "spec") -> None:
        self.faults = tuple(faults)
        self.source = source
        more = len(self.faults) - MOST_LISTED
        lines = "\n".join(
            [
                *(f"  {fault}" for fault in self.faults[:MOST_LISTED]),
                *([f"  and {more} more"] if more > 0 else []),
            ]
        )
        super().__init__(
            f"{source}: {len(self.faults)} fault{'' if len(self.faults) == 1 else 's'}\n{lines}"
        )


class ArgumentError(SpecError, ValueError):
    """A wrong argument of a method: a ValueError too, as Python calls it."""


def no_such(what: str, name: object, known: Sequence[str], source: str) -> ArgumentError:
    """Error for a name that a thing does not have; what: kind of the name, known: the names that there are."""
    nearest = get_close_matches(str(name), known, 1)
    there = f"one of {', '.join(known)}" if known else f"none: there is no {what}"
    fault = Fault((what,), repr(name), there, nearest[0] if nearest else None)
    return ArgumentError([fault], source)


def by_beginning(name: str, names: Sequence[str]) -> str | None:
    """The first of some names whose beginning is nearly a name; None where that is short, or none is alike."""
    beginnings = {each[: len(name) + 1]: each for each in reversed(names)}
    near = get_close_matches(name, beginnings, 1, 0.7) if len(name) > 3 else []
    return beginnings[near[0]] if near else None


def wrong_order(order: object, source: str) -> ArgumentError:
    """Error for an order of derivatives beyond 0..2."""
    return ArgumentError([Fault(("order",), str(order), "0, 1 or 2")], source)


def _told_apart(value: float, limit: float) -> tuple[str, str]:
    """Two numbers in at least four digits, whole parts in full, and in as many as tell the one from the other."""
    whole = max(len(f"{abs(each):.0f}") for each in (value, limit))
    shown = "", ""
    for digits in range(min(max(whole, 4), 9), 10):
        shown = f"{value:.{digits}g}", f"{limit:.{digits}g}"
        if shown[0] != shown[1]:
            break
    return shown


def _message(sentence: str, remedy: str) -> str:
    return f"{sentence}; {remedy}" if remedy else sentence


class DesignError(CamgenError):
    """The spec is well formed but no such mechanism exists.

    quantity, value, limit, unit: what fails and by how much; where: at which angle or place, or between which two things;
    remedy: what to change.
    """

    exit_code = 3

    def __init__(
        self,
        quantity: str,
        value: float,
        limit: float,
        unit: str,
        where: str | tuple[str, str] = "",
        remedy: str = "",
    ) -> None:
        self.quantity = quantity
        self.value = value
        self.limit = limit
        self.unit = unit
        self.between: tuple[str, ...] = where if isinstance(where, tuple) else ()
        self.where = where if isinstance(where, str) else f"between {where[0]} and {where[1]}"
        self.remedy = remedy
        at = "" if self.between else "at "
        place = f" {at}{self.where}" if self.where else ""
        of = f" {unit}" if unit else ""
        named = f" ({self.where})" if self.where else ""
        if unit == "" and (value, limit) == (0, 1):  # what is counted
            sentence = f"there are no {quantity}{named}"
        elif unit == "" and limit == 0 and isinstance(value, int):
            sentence = f"{quantity}: {value}, and none is allowed{named}"
        else:
            found, allowed = _told_apart(value, limit)
            side = ": at least" if value < limit else ": at most" if value > limit else ""
            sentence = f"{quantity} is {found}{of}{place}, limit{side} {allowed}{of}"
        self.sentence = sentence
        super().__init__(_message(sentence, remedy))

    def mended(self, remedy: str) -> Self:
        """This error with another remedy."""
        facts = {**vars(self), "remedy": remedy}
        return _sent(type(self), (_message(self.sentence, remedy),), facts)

    def saying(self, sentence: str) -> Self:
        """This error with a sentence of its own before the remedy, where the facts in a row would be none."""
        facts = {**vars(self), "sentence": sentence}
        return _sent(type(self), (_message(sentence, self.remedy),), facts)

    def placed(self, places: Sequence[str]) -> Self:
        """This error with lines below it that tell where the keys that it names are written."""
        return _sent(type(self), ("\n  ".join([str(self), *places]),), vars(self))

    @property
    def facts(self) -> dict[str, Any]:
        """What fails, for programs: None in place of a number that is not finite, which JSON does not have."""
        numbers = {
            name: each if math.isfinite(each) else None
            for name, each in (("value", self.value), ("limit", self.limit))
        }
        return {
            "quantity": self.quantity,
            **numbers,
            "unit": self.unit,
            "where": self.where,
            "remedy": self.remedy,
        }


def listed(thing: str, names: Sequence[str], most: int = 10) -> str:
    """Names with what they are: "joint A", "joints A and B", "links a, b, c and 7 more"."""
    shown = list(names[:most])
    more = len(names) - most
    shown += [f"{more} more"] if more > 0 else []
    return (
        f"{thing} {shown[0]}"
        if len(shown) == 1
        else f"{thing}s {', '.join(shown[:-1])} and {shown[-1]}"
    )


def counted(number: int, thing: str, things: str = "") -> str:
    """How many there are of a thing: "1 body", "2 bodies", "0 faults"."""
    return f"{number} {thing if number == 1 else things or thing + 's'}"


class FileError(CamgenError):
    """A file could not be written or read; carries its path and the reason."""

    exit_code = 4

    def __init__(self, path: object, reason: str) -> None:
        self.path = str(path)
        self.reason = reason
        self.key: Key = ()  # of the spec that names the file, where one does
        super().__init__(f"{path}: {reason}")

    def named_by(self, key: Key, line: int | None = None) -> FileError:
        """The error with the key of the spec that names the file, and its line there."""
        place = dotted(key) if line is None else f"line {line}: {dotted(key)}"
        error = FileError(self.path, self.reason)
        error.key = key
        error.args = (f"{self.path}: {self.reason} ({place} names it)",)
        return error


def explained(error: CamgenError | OSError) -> CamgenError:
    """The error itself, or the FileError that stands for an OSError."""
    if isinstance(error, CamgenError):
        return error
    path = Path(error.filename or "file")
    if isinstance(error, FileNotFoundError) and not path.parent.exists():
        return FileError(path, f"there is no folder {path.parent}")
    return FileError(path, error.strerror or str(error))


@contextmanager
def file_errors() -> Iterator[None]:
    """`with file_errors():` raises the FileError that stands for an OSError."""
    try:
        yield
    except OSError as error:
        raise explained(error) from error
