"""What a search offers, as a folder: a spec for each design, a table and a page, those that can be built first."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

from camgen.errors import FileError, file_errors
from camgen.report.sketches import Gallery, Sketch, picture


@dataclass(frozen=True, repr=False)
class Front:
    """Designs that no other one beats."""

    title: str  # of the page
    summary: str
    figures: Mapping[
        str, str
    ]  # columns, how a person reads them; the first two are drawn, one over the other
    texts: Sequence[str]  # a spec for each design
    rows: Sequence[Mapping[str, Any]]  # of the table
    sketches: Sequence[Sketch]

    def __len__(self) -> int:
        return len(self.rows)

    def __iter__(self) -> Iterator[Mapping[str, Any]]:
        """The rows of the table."""
        return iter(self.rows)

    def __repr__(self) -> str:
        """Its title and figures."""
        return "\n".join([self.title, *(f"  {words}" for words in self._captions())])

    def _repr_html_(self) -> str:
        """For a notebook: its table."""
        head = "".join(f"<th>{escape(name)}</th>" for name in self.rows[0])
        rows = [
            "".join(f"<td>{escape(str(cell))}</td>" for cell in row.values()) for row in self.rows
        ]
        body = "".join(f"<tr>{row}</tr>" for row in (head, *rows))
        return f"<h4>{escape(self.title)}</h4><p>{escape(self.summary)}</p><table>{body}</table>"

    def _captions(self) -> list[str]:
        """What is said of each design."""
        return [self.caption(row) for row in self.rows]

    def caption(self, row: Mapping[str, Any]) -> str:
        """What is said of the design of a row."""
        figures = [
            text.format(row[column])
            for column, text in self.figures.items()
            if row[column] is not None
        ]
        said = f"design {row['design']}: {', '.join(figures)}"
        if row["parts"]:
            said += f"; with {row['parts']}"
        return f"{said}; {row['verdict']}: {row['reason']}" if row["reason"] else said

    def write(self, folder: Path) -> None:
        """01.toml, 02.toml, ..., front.csv and front.html; FileError where the folder exists."""
        from camgen.report.sweep_page import SweepPage, write_page

        with file_errors():
            try:
                folder.mkdir(parents=True)
            except FileExistsError:
                raise FileError(
                    folder, "exists already, and camgen did not touch it; choose another folder"
                ) from None
            for number, text in enumerate(self.texts, 1):
                (folder / f"{number:02d}.toml").write_text(text, encoding="utf-8", newline="\n")
            stream = io.StringIO()
            table = csv.DictWriter(stream, list(self.rows[0]), lineterminator="\n")
            table.writeheader()
            table.writerows(self.rows)
            (folder / "front.csv").write_text(stream.getvalue(), encoding="utf-8", newline="\n")
        across, up, *_ = self.figures
        columns = list(self.rows[0])
        page = SweepPage(self.title, self.summary, columns, [across], [up], self._galleries())
        write_page(folder / "front.html", page, self.rows, len(self.rows))

    def _galleries(self) -> list[Gallery]:
        """Those that can be built as wanted, then the others."""
        shown = [
            (row["verdict"], (picture(sketch, words), words))
            for row, sketch, words in zip(self.rows, self.sketches, self._captions(), strict=True)
        ]
        titles = {
            "holds": "Can be built",
            "fails": "Can be built, but misses a wanted value",
            "refused": "Cannot be built",
        }
        return [
            Gallery(title, [each for verdict, each in shown if verdict == wanted])
            for wanted, title in titles.items()
        ]
