"""A sweep's journal, a file beside its table: what is done survives a kill.

Its first line says which sweep it is of, each further one is a variant's row behind a digest of it and of the sweep; a run that
finds one of its own goes on from there.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterable, Iterator
from contextlib import suppress
from pathlib import Path

import numpy as np

from camgen._version import __version__
from camgen.errors import FileError, file_errors
from camgen.files.folder import locked
from camgen.sweep.tables import Row


class Journal:
    """Rows on disk as they come, one a line, and where each variant's row begins: of a sweep, by its digest, of `count` variants.

    strange: lines that are no rows of this sweep as it wrote them; their variants are judged again.
    """

    def __init__(self, path: Path, sweep: str, count: int) -> None:
        self.path = path
        self.strange = 0
        self.places = np.full(count, -1, dtype=np.int64)
        self._sweep = sweep
        head = json.dumps({"camgen": __version__, "sweep": sweep, "variants": count}) + "\n"
        with file_errors():
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file = open(path, "a+b")  # noqa: SIM115
            self._file.seek(0)
            if not locked(self._file, wait=False):
                self._file.close()
                raise FileError(
                    path,
                    "another run of camgen writes it; wait for that, or choose another table with -o",
                )
            first = self._file.readline()
            if not first.endswith(b"\n"):  # new, or ended before its first line was whole
                self._file.truncate(0)
                self._file.write(head.encode())
            elif first != head.encode():
                self._file.close()
                message = (
                    "is the journal of another sweep; remove it, or choose another table with -o"
                )
                raise FileError(path, message)
            else:
                self._lines()
            self._file.seek(0, os.SEEK_END)

    def _lines(self) -> None:
        """Find the rows; what a kill cut off at the end is dropped."""
        place = self._file.tell()
        for line in iter(self._file.readline, b""):
            row = self._row(line)
            if row is not None:
                self.places[row["variant"]] = place
            elif line.endswith(b"\n"):
                self.strange += 1
            else:
                self._file.truncate(place)
                return
            place += len(line)

    def _line(self, row: Row) -> bytes:
        text = json.dumps(row, ensure_ascii=False).encode()
        return self._digest(text) + b" " + text + b"\n"

    def _row(self, line: bytes) -> Row | None:
        """The row of a line as this sweep wrote it; None of any other line, whatever it holds."""
        digest, _, text = line.removesuffix(b"\n").partition(b" ")
        if not line.endswith(b"\n") or digest != self._digest(text):
            return None
        try:
            row = json.loads(text)
        except (ValueError, RecursionError):
            return None
        return (
            row if isinstance(row, dict) and self._has(row.get("variant")) and _whole(row) else None
        )

    def _has(self, variant: object) -> bool:
        """Whether this is the number of a variant: 1.0 and true are none."""
        return type(variant) is int and 0 <= variant < len(self.places)

    def _digest(self, text: bytes) -> bytes:
        """Of a row and the sweep that it is of."""
        return hashlib.sha256(self._sweep.encode() + b" " + text).hexdigest()[:16].encode()

    @property
    def done(self) -> int:
        """How many variants have a row."""
        return int(np.count_nonzero(self.places >= 0))

    def add(self, rows: Iterable[Row]) -> None:
        """Write the rows of variants that have none yet; FileError where the disk is full."""
        try:
            for row in rows:
                if self.places[row["variant"]] < 0:
                    self.places[row["variant"]] = self._file.tell()
                    self._file.write(self._line(row))
            self._file.flush()
        except OSError as error:
            message = f"{error.strerror or error}; {self.done} variants are in it: the same command goes on from there"
            raise FileError(self.path, message) from None

    def rows(self, step: int = 1) -> Iterator[Row]:
        """All rows by the variants' numbers, or every second one, third one...; FileError where one is no longer as written."""
        for place in self.places[self.places >= 0][::step]:
            self._file.seek(int(place))
            row = self._row(self._file.readline())
            if row is None:
                raise FileError(
                    self.path,
                    "was changed during this run; the same command judges the changed rows again",
                )
            yield row
        self._file.seek(0, os.SEEK_END)

    def close(self) -> None:
        """Leave the file as it is; what a full disk refused was told."""
        with suppress(OSError):
            self._file.close()


def _whole(row: Row) -> bool:
    """Whether a row says what every row says, in texts and numbers."""
    texts = all(isinstance(row.get(name), str) for name in ("verdict", "fails", "reason"))
    return texts and all(
        value is None or isinstance(value, str | int | float) for value in row.values()
    )
