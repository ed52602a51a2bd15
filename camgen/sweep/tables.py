"""A sweep's rows as a table: CSV, or Parquet; written beside the target, then renamed."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from itertools import islice
from pathlib import Path
from typing import Any

from camgen.errors import Fault, FileError, SpecError, file_errors
from camgen.extras import install_line
from camgen.files.rows import write_rows

Row = dict[str, Any]


def _write_csv(path: Path, columns: Sequence[str], rows: Iterator[Row]) -> None:
    with file_errors():
        part = path.with_name(path.name + ".part")
        write_rows(part, columns, ([row.get(name) for name in columns] for row in rows))
        os.replace(part, path)


def pyarrow_at(path: Path) -> Any:
    """The package that writes Parquet; FileError where there is none."""
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        raise FileError(
            path,
            f"needs pyarrow: {install_line('table')}; a name that ends in .csv needs nothing",
        ) from None
    return pyarrow


def _write_parquet(path: Path, columns: Sequence[str], rows: Iterator[Row]) -> None:
    arrow = pyarrow_at(path)
    text = ("verdict", "fails", "reason")
    batch = list(islice(rows, 10_000))
    partly_text = {name for name in columns if any(isinstance(row.get(name), str) for row in batch)}
    kinds = {
        name: arrow.int64()
        if name == "variant"
        else arrow.string()
        if name in partly_text or name in text
        else arrow.float64()
        for name in columns
    }
    schema = arrow.schema(list(kinds.items()))
    with file_errors():
        part = path.with_name(path.name + ".part")
        with arrow.parquet.ParquetWriter(part, schema) as writer:
            while batch:
                found = [
                    {
                        name: str(row[name])
                        if name in partly_text and row.get(name) is not None
                        else row.get(name)
                        for name in columns
                    }
                    for row in batch
                ]
                writer.write_table(arrow.Table.from_pylist(found, schema))
                batch = list(islice(rows, 10_000))
        os.replace(part, path)


Writer = Callable[[Path, Sequence[str], Iterator[Row]], None]
_WRITERS: dict[str, Writer] = {".csv": _write_csv, ".parquet": _write_parquet}


def writer_of(path: Path) -> Writer:
    """What writes a table of this name; SpecError where nothing does, FileError where its package is missing."""
    write = _WRITERS.get(path.suffix.lower())
    if write is None:
        right = f"a name that ends in {' or '.join(_WRITERS)}"
        raise SpecError([Fault((), path.name, right, source="-o")], "command line")
    if write is _write_parquet:
        pyarrow_at(path)
    return write
