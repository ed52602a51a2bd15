"""The table of a cam's track on its sheet: radii of an outline, points that a follower touches, heights of a drum's roller or of a
plate's edge."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from camgen.files.sheet import Align, Sheet
from camgen.files.title_block import Facts, title_block
from camgen.geometry.drums import Drum
from camgen.parts.part import Part

ROW = 5.0  # height of a row, mm of paper
_HEIGHT = 2.5  # of its text
_WIDTH, _HIGH = 420.0, 297.0  # A3
_FILING = 20.0
_MARGIN = 10.0
_COLUMNS = (
    "Cam: angle by which the part has turned",
    "At: direction of the point that the follower then touches, from X, ccw",
    "Radius: distance of that point from the axis, mm",
)


@dataclass(frozen=True)
class TrackTable:
    """Its rows, which stand in as many columns beside each other as there is room for."""

    title: str
    heads: tuple[str, ...]
    widths: tuple[float, ...]  # mm of paper
    rows: Sequence[tuple[str, ...]]

    def beside(self, room: float) -> int:
        """How many rows stand beside each other in so many mm of paper."""
        return round(room / sum(self.widths))

    def count(self, room: float) -> int:
        """How many lines it has there, without title and head."""
        return -(-len(self.rows) // self.beside(room))

    def lines(self, room: float) -> list[list[str]]:
        """These lines."""
        count = self.count(room)
        return [[cell for row in self.rows[k::count] for cell in row] for k in range(count)]


def grid(
    sheet: Sheet,
    corner: complex,
    rows: Sequence[Sequence[str]],
    widths: Sequence[float],
    numbers: Sequence[int],
) -> None:
    """A table from its upper left corner down; numbers: columns that are set to the right."""
    edges = corner.real + np.cumsum((0.0, *widths))
    for i, row in enumerate(rows):
        y = corner.imag - (i + 1) * ROW
        for k, cell in enumerate(row):
            at = complex(edges[k + 1] - 1.5 if k in numbers else edges[k] + 1.5, y + 1.3)
            side: Align = "right" if k in numbers else "left"
            sheet.text(at, cell, _HEIGHT, side, room=widths[k] - 2)
        sheet.line(complex(edges[0], y), complex(edges[-1], y), layer="TEXT")
    for x in edges:
        sheet.line(complex(x, corner.imag), complex(x, y), layer="TEXT")


def tables_sheet(tables: Sequence[TrackTable], part: Part, facts: Facts, title: str) -> Sheet:
    """The tables of a part's tracks side by side on a sheet of their own; those without room are left out and counted."""
    sheet = Sheet(_WIDTH, _HIGH, title)
    right, top = _WIDTH - _MARGIN, _HIGH - _MARGIN
    corners = (
        complex(_FILING, _MARGIN),
        complex(right, _MARGIN),
        complex(right, top),
        complex(_FILING, top),
    )
    sheet.line(*corners, layer="TEXT", closed=True)
    left = _FILING + ROW
    most = int((top - _MARGIN - facts.height) / ROW) - 4
    for k, table in enumerate(tables):
        beside = -(-len(table.rows) // most)
        wide = beside * sum(table.widths)
        if left + wide > right:
            sheet.text(complex(_FILING + ROW, _MARGIN + ROW), f"{len(tables) - k} more: by STL")
            break
        level = top - 2 * ROW
        sheet.text(complex(left, level + 1.3), table.title, _HEIGHT, room=wide)
        lines = [list(table.heads * beside), *table.lines(wide)]
        numbers = range(len(table.heads) * beside)
        sheet.line(complex(left, level), complex(left + wide, level), layer="TEXT")
        grid(sheet, complex(left, level), lines, table.widths * beside, numbers)
        left += wide + ROW
    for k, said in enumerate(_COLUMNS):
        sheet.text(complex(_FILING + ROW, _MARGIN + ROW * (len(_COLUMNS) - k + 1)), said)
    own = replace(facts, number=f"{facts.number}-tracks")
    title_block(sheet, complex(right, _MARGIN), part, own, 0.0, "A3")
    return sheet


def track_tables(
    facts: Facts, polar: Sequence[tuple[float, float]], drum: Drum | None
) -> list[TrackTable]:
    """The tables of a part, one for each of its tracks. polar: angle, deg, and radius of its outline, mm."""
    exact = "theoretically exact" if facts.profile else "by cam angle"
    if len(facts.tracks) > 1:
        return [
            replace(_touched(points), title=f"Track {name}: {exact}")
            for name, points in facts.tracks
        ]
    table = _table(facts, polar, drum)
    return [table] if table else []


def _touched(points: Sequence[tuple[float, complex]]) -> TrackTable:
    """Where a follower touches a track."""
    rows = [
        (f"{angle:g}°", f"{math.degrees(cmath.phase(z)) % 360:.2f}°", f"{abs(z):.3f}")
        for angle, z in points
    ]
    return TrackTable("", ("Cam", "At", "Radius"), (14.0, 18.5, 18.5), rows)


def _table(
    facts: Facts, polar: Sequence[tuple[float, float]], drum: Drum | None
) -> TrackTable | None:
    """The table of a part with one track; None where there is nothing to tell."""
    if facts.levels:
        exact = "Theoretically exact edge" if facts.profile else "Edge"
        rows: list[tuple[str, ...]] = [(f"{z.real:g}", f"{z.imag:.3f}") for z in facts.levels]
        return TrackTable(f"{exact}: Y over X", ("X", "Y"), (15.0, 19.0), rows)
    if facts.heights:
        exact = "Exact axis" if facts.profile else "Axis"
        of = "both rollers' middle" if drum and drum.track == "rib" else "the roller"
        title = f"{exact} of {of}: angle from X, ccw, and height"
        rows = [(f"{a:g}°", f"{at:.2f}°", f"{z:.3f}") for a, at, z in facts.heights]
        return TrackTable(title, ("Drum", "At", "Z"), (14.0, 18.5, 18.5), rows)
    if polar and facts.tracks:
        exact = "Theoretically exact track" if facts.profile else "Track by cam angle"
        ((_, points),) = facts.tracks
        return replace(_touched(points), title=f"{exact}: where the follower touches, from X, ccw")
    if polar:
        exact = "Theoretically exact radii" if facts.profile else "Radii of the profile"
        title = f"{exact} about the origin, by the angle from X, ccw"
        rows = [(f"{angle:g}°", f"{radius:.3f}") for angle, radius in polar]
        return TrackTable(title, ("Angle", "Radius"), (15.0, 19.0), rows)
    return None
