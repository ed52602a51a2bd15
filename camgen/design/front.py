"""What a search offers: its designs weighed as machines, those that can be built first, and which of them is acceptable."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any, Protocol, TypeVar

from camgen import reading
from camgen.design.prototype import Prototype
from camgen.design.wanted import FunctionWish, LinkWish, PathWish
from camgen.errors import DesignError, FileError, counted, file_errors
from camgen.report.sketches import Gallery, Sketch, picture


class Design(Protocol):
    """A machine that a search found."""

    @property
    def prototype(self) -> Prototype:
        """Whether it can be made, and its play."""

    @property
    def sketch(self) -> Sketch:
        """What a sketch shows."""

    def data(self) -> reading.Data:
        """Tables of its spec."""

    def row(self, number: int) -> dict[str, Any]:
        """What a table of the front shows."""


D = TypeVar("D", bound=Design)


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
        return [self._caption(row) for row in self.rows]

    def _caption(self, row: Mapping[str, Any]) -> str:
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
                    folder, "exists already and is left as it is; choose another folder"
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
            "fails": "Can be built, but keeps not all that is wanted",
            "refused": "Cannot be built",
        }
        return [
            Gallery(title, [each for verdict, each in shown if verdict == wanted])
            for wanted, title in titles.items()
        ]


def with_prototype(design: D) -> D:
    """The same, weighed as a machine: a task of its own."""
    _ = design.prototype
    return design


Buildable = PathWish | FunctionWish | LinkWish


@dataclass(frozen=True)
class Aim:
    """What a design must keep to be chosen, and how that is said."""

    wish: PathWish | FunctionWish
    allowance: float  # how far it may be off
    unit: str  # of that
    off: str  # what an error is
    size: str  # that of which a twentieth is borne without a tolerance


def keeping(front: Sequence[D], wish: Buildable, unit: str, error: Callable[[D], float]) -> list[D]:
    """Those that can be built, with no more play than is borne, and keep their limits; DesignError where there are none."""
    buildable = [each for each in front if not each.prototype.obstacle]
    if not buildable:
        room = "a larger wanted.frame" if isinstance(wish, FunctionWish) else wish.further
        raise DesignError(
            "buildable designs",
            0,
            1,
            "",
            f"front of {len(front)}",
            f"{room}, or thinner parts",
        ).saying(
            f"none of {len(front)} designs can be built; the first: {front[0].prototype.obstacle}"
        )
    if wish.lash is not None:
        tight = [each for each in buildable if each.prototype.lash <= wish.lash]
        if not tight:
            least = min(each.prototype.lash for each in buildable)
            remedy = "a smaller print.slide_clearance, or more play"
            raise DesignError(
                "wanted.lash", least, wish.lash, unit, "the tightest buildable design", remedy
            )
        buildable = tight
    can = [each for each in buildable if not each.prototype.failures]
    if not can:
        nearest = min(buildable, key=error).prototype
        many = counted(len(buildable), "buildable design")
        only_play = {each.code for each in nearest.failures} == {"LASH"}
        remedy = (
            "a smaller print.slide_clearance, or a greater wanted.lash"
            if only_play
            else "wider [limits]"
        )
        message = f"none of {many} keeps its limits; the nearest one: {nearest.refusal}"
        raise DesignError(
            "designs that keep their limits",
            0,
            1,
            "",
            many,
            remedy,
        ).saying(message)
    return can


def acceptable(front: Sequence[D], aim: Aim, error: Callable[[D], float]) -> list[D]:
    """Those of `keeping` with no more error than is borne; DesignError where there are none."""
    wanted = aim.wish
    unit = aim.unit
    can = keeping(front, wanted, unit, error)
    near = [each for each in can if error(each) <= aim.allowance]
    least = min(map(error, can))
    if not near and wanted.tolerance is None:
        raise DesignError(
            f"distance {aim.off}",
            least,
            aim.allowance,
            unit,
            "the nearest buildable design",
            f"{wanted.further}, or wanted.tolerance = {math.ceil(100 * least) / 100:g}",
        ).saying(
            f"the nearest buildable design is {least:.4g} {unit} {aim.off}; without wanted.tolerance the limit is a twentieth of "
            f"{aim.size}, {aim.allowance:.4g} {unit}"
        )
    if not near:
        remedy = f"{wanted.further}, or a wider wanted.tolerance"
        raise DesignError(
            "wanted.tolerance", least, aim.allowance, unit, "the nearest buildable design", remedy
        )
    return near
