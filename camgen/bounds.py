"""How large a file may be: bytes, and things in it; what is larger is refused before it is read."""

from __future__ import annotations

import os
import stat
from dataclasses import dataclass
from difflib import get_close_matches
from glob import escape
from pathlib import Path

from camgen.errors import FileError

_CHUNK = 1 << 20  # bytes that are counted at a time


@dataclass(frozen=True)
class Bound:
    """How large a file of one kind may be.

    The time to read a file grows with what it holds more than with its bytes: each thing in it has a mark, which is quickly
    counted.
    """

    what: str  # the file, such as "a spec file"
    most_bytes: int
    marks: bytes = b"\n"  # each thing in it has one of these
    things: str = "lines"
    most: int | None = None  # things; None: as many as there is room for
    remedy: str = ""  # what to do where there are more


def bounded(path: Path, bound: Bound) -> int:
    """Size of a plain file, bytes; FileError where it is none (a pipe may wait for ever), cannot be read, or is larger."""
    try:
        status = os.stat(path)
        if stat.S_ISDIR(status.st_mode):
            raise FileError(path, f"is a folder, {bound.what} was expected")
        if not stat.S_ISREG(status.st_mode):
            raise FileError(path, f"is a pipe or a device; {bound.what} was expected")
        after = f": {bound.remedy}" if bound.remedy else ""
        if status.st_size > bound.most_bytes:
            most = f"at most {bound.most_bytes / 1e6:.0f} MB are read"
            raise FileError(
                path, f"is {status.st_size / 1e6:.0f} MB large; {most} of {bound.what}{after}"
            )
        if bound.most is not None and status.st_size > bound.most:
            with open(path, "rb") as file:
                count = sum(
                    chunk.count(mark)
                    for chunk in iter(lambda: file.read(_CHUNK), b"")
                    for mark in bound.marks
                )
            if count > bound.most:
                raise FileError(
                    path,
                    f"has {count:,} {bound.things}; at most {bound.most:,} are read of {bound.what}{after}",
                )
        return status.st_size
    except FileNotFoundError as error:
        meant = meant_file(Path(path))
        said = f"there is no such file; did you mean {meant}?" if meant else error.strerror
        raise FileError(path, f"cannot be read: {said}") from None
    except (OSError, ValueError) as error:  # ValueError: a zero byte in the path
        raise FileError(
            path, f"cannot be read: {getattr(error, 'strerror', None) or error}"
        ) from None


def meant_file(path: Path) -> str:
    """The file of that name in a folder beside it, else the one beside it whose name is nearest; "" where there is none.

    Only files of the same kind, by their ending; specs where it has none.
    """
    name = path if path.suffix else path.with_suffix(".toml")
    try:
        below = sorted(path.parent.glob(f"*/{escape(name.name)}"))
        beside = {each.stem: each for each in sorted(path.parent.glob(f"*{escape(name.suffix)}"))}
    except (OSError, ValueError):
        return ""
    near = [beside[stem] for stem in get_close_matches(path.stem, beside, 1)]
    same = [each for each in near if each.stem == path.stem]
    return str([*same, *below, *near][0]) if near or below else ""


def read_bytes(path: Path, bound: Bound) -> bytes:
    """The bytes of a file that is no larger than that; FileError as `bounded`."""
    bounded(path, bound)
    try:
        return Path(path).read_bytes()
    except OSError as error:
        raise FileError(path, f"cannot be read: {error.strerror or error}") from None
