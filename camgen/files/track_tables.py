"""The table of a cam's track on its sheet: radii of an outline, points that a follower touches, heights of a drum's roller or of a
plate's edge."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from camgen.files.dimensions import number
from camgen.files.sheet import Align, Sheet
from camgen.files.title_block import BLOCK, Facts, sheet_words, title_block
from camgen.geometry.drums import Drum
from camgen.parts.part import Part

ROW = 5.0  # height of a row, mm of paper
_HEIGHT = 2.5  # of its text
_WIDTH, _HIGH = 420.0, 297.0  # A3
_FILING = 20.0
_MARGIN = 10.0
# What heads of tables on a sheet of their own mean.
_COLUMNS = {
    "Cam": "angle by which the part has turned",
    "Drum": "angle by which the drum has turned",
    "Angle": "from X, ccw",
    "At": "direction of the point that the follower then touches, from X, ccw",
    "Radius": "distance of that point from the axis, mm",
    "Axis at": "direction of the axis of the follower's roller then, from X, ccw",
    "Axis": "distance of that axis from the cam's, mm: the path of a cutter as thick as the roller",
    "X": "along the plate, mm",
    "Y": "height of its edge there, mm",
    "Z": "height of the roller's axis over the lower end, mm",
}


_ON_DRUM = {"At": "direction of the axis of the follower's roller then, from X, ccw"}


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


def tables_sheets(
    tables: Sequence[TrackTable], part: Part, facts: Facts, stem: str
) -> dict[str, Sheet]:
    """Sheets with the tables of a part's tracks side by side, in columns as long as a sheet is high, by their files' names without
    the ends, after the first sheet, which is the part's own. Their number is that of the first sheet, or that name where it has none."""
    right, top = _WIDTH - _MARGIN, _HIGH - _MARGIN
    most = int((top - _MARGIN - BLOCK) / ROW) - 3
    columns = [
        (replace(table, rows=table.rows[k : k + most]), 0 if k else -(-len(table.rows) // most))
        for table in tables
        for k in range(0, len(table.rows), most)
    ]
    heads = list(dict.fromkeys(head for table in tables for head in table.heads))
    sheets = dict[str, Sheet]()
    left = right
    for column, titled in columns:
        wide = sum(column.widths)
        if left + wide > right:
            which = f"tracks-{len(sheets) + 1}" if sheets else "tracks"
            name = f"{stem}-{which}-drawing"
            sheet = sheets[name] = Sheet(_WIDTH, _HIGH, f"Tracks of {part.title} ({stem})")
            _frame(sheet, heads)
            left = _FILING + ROW
        level = complex(left, top - 2 * ROW)
        room = titled * (wide + ROW) - ROW
        sheet.text(level + 1.3j, column.title if titled else "", _HEIGHT, room=room)
        sheet.line(level, level + wide, layer="TEXT")
        lines = [column.heads, *column.rows]
        grid(sheet, level, lines, column.widths, range(len(column.heads)))
        left += wide + ROW
    for k, (name, sheet) in enumerate(sheets.items(), 2):
        own = replace(facts, number=facts.number or name)
        size = sheet_words("A3", k, len(sheets) + 1)
        title_block(sheet, complex(right, _MARGIN), part, own, 0.0, size)
    return sheets


def _frame(sheet: Sheet, heads: Sequence[str]) -> None:
    """Frame of a sheet, and what the heads of its tables mean."""
    sheet.frame(_FILING, _MARGIN)
    columns = _COLUMNS | _ON_DRUM if "Z" in heads else _COLUMNS
    for k, head in enumerate(heads):
        at = complex(_FILING + ROW, _MARGIN + ROW * (len(heads) - k))
        sheet.text(at, f"{head}: {columns[head]}")


def track_tables(
    facts: Facts, polar: Sequence[tuple[float, float]], drum: Drum | None
) -> list[TrackTable]:
    """The tables of a part, one for each of its tracks. polar: angle, deg, and radius of its outline, mm."""
    exact = "theoretically exact" if facts.profile else "by cam angle"
    if len(facts.tracks) > 1:
        return [
            replace(_touched(points[:: facts.stride]), title=f"Track {name}: {exact}")
            for name, points in facts.tracks
        ]
    table = _table(facts, polar, drum)
    return [table] if table else []


def relief_table(points: Sequence[complex], facts: Facts) -> TrackTable:
    """Points of what relieves a disc that locks a Geneva wheel."""
    exact = "Theoretically exact relief" if facts.profile else "Relief"
    rows: list[tuple[str, ...]] = [(number(z.real), number(z.imag)) for z in points]
    return TrackTable(f"{exact}: points in order, joined smoothly", ("X", "Y"), (17.0, 17.0), rows)


def own_tables(facts: Facts, tables: Sequence[TrackTable], full: bool) -> list[TrackTable]:
    """Those on sheets of their own: of several tracks, of one whose table the sheet has no room for (full), and with the axes of
    rollers where tracks have a tolerance."""
    rolls = [0 < each.radius < math.inf for each in facts.riders]
    if facts.profile and any(rolls):
        return [
            replace(
                _touched(points, centres if rolling else ()),
                title=f"Track {name}: theoretically exact" if name else "Exact track",
            )
            for (name, points), centres, rolling in zip(
                facts.tracks, facts.centres, rolls, strict=True
            )
        ]
    if facts.profile and facts.heights and tables:
        return [replace(tables[0], rows=_heights(facts.heights))]
    return list(tables) if full or len(tables) > 1 else []


def _heights(heights: Sequence[tuple[float, float, float]]) -> list[tuple[str, ...]]:
    """Rows of a drum's track."""
    return [(f"{a:g}°", f"{at:.2f}°", f"{z:.3f}") for a, at, z in heights]


def _touched(
    points: Sequence[tuple[float, complex]], centres: Sequence[complex] = ()
) -> TrackTable:
    """Where a follower touches a track, and where its roller's axis is."""
    rows: list[tuple[str, ...]] = [(f"{angle:g}°", *_polar(z)) for angle, z in points]
    if not centres:
        return TrackTable("", ("Cam", "At", "Radius"), (14.0, 18.5, 18.5), rows)
    rows = [(*row, *_polar(z)) for row, z in zip(rows, centres, strict=True)]
    heads = ("Cam", "At", "Radius", "Axis at", "Axis")
    return TrackTable("", heads, (14.0, 18.5, 18.5, 18.5, 18.5), rows)


def _polar(z: complex) -> tuple[str, str]:
    """Direction and distance of a place from the origin."""
    return f"{math.degrees(cmath.phase(z)) % 360:.2f}°", f"{abs(z):.3f}"


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
        rows = _heights(facts.heights[:: facts.stride])
        return TrackTable(title, ("Drum", "At", "Z"), (14.0, 18.5, 18.5), rows)
    if polar and facts.tracks:
        exact = "Theoretically exact track" if facts.profile else "Track by cam angle"
        ((_, points),) = facts.tracks
        own = _touched(points[:: facts.stride])
        return replace(own, title=f"{exact}: where the follower touches, from X, ccw")
    if polar:
        exact = "Theoretically exact radii" if facts.profile else "Radii of the profile"
        title = f"{exact} about the origin, by the angle from X, ccw"
        rows = [(f"{angle:g}°", f"{radius:.3f}") for angle, radius in polar]
        return TrackTable(title, ("Angle", "Radius"), (15.0, 19.0), rows)
    return None
