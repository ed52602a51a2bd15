"""The dimensioned drawing of a part: laid out once as a sheet, written as DXF and as PDF.

Views in first-angle projection: the part as its layers lie, seen along z; to its right seen from the left, bores dashed;
below it seen along y a part that is crossed with a second outline, or a section of one whose layers differ; one through the
bore of a plate or a drum, or through a keyway, takes the place of the view from the left. Of a plate's through holes none is
dashed: a note says that they go through. Overall sizes, a table of holes with their fits and of the corners and
roundings of every outline, notes and a title block. An outline that is no chain of lines and arcs, a cam's, is in the part's
own file; it gets its least and greatest radius, a table of radii, and its overall sizes in parentheses.
Nothing here knows a mechanism.
"""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

from camgen.files import bore_detail, seat_detail
from camgen.files.bore_detail import BoreDetail
from camgen.files.drawn_part import DrawnPart
from camgen.files.geneva_view import GenevaView
from camgen.files.notes import NOTES, notes_of
from camgen.files.page import FILING, MARGIN, SCALES, SIZES, TABLE_WIDTHS, Page
from camgen.files.plan_view import PlanView
from camgen.files.seat_detail import SeatDetail
from camgen.files.shaft_sheet import write_shaft
from camgen.files.sheet import Sheet, Text, write_dxf_sheet, write_pdf
from camgen.files.side_view import BOSS, SideViews
from camgen.files.symbols import position, squareness
from camgen.files.title_block import BLOCK, Facts, sheet_words, title_block
from camgen.files.track_tables import ROW, grid, tables_sheets
from camgen.files.tracks import SECTION_ROOM, development, drum_section, plates_section
from camgen.parts.part import Part

# Room round the plan view for dimensions, and between the views, mm: left and below, right and above.
_LEFT = 31.0
_BELOW = 28.0
_RIGHT = 24.0
_ABOVE = 24.0
_BESIDE = 12.0
_RUN_OUT = 10.0  # more to the right of a drum's plan view, for the run-out of that end
_THIRD = 8.0  # from the plan view's dimension to the third view, and from that to what is below
_BORE = 27.0  # to the dimension of a round bore there, past the sign of its roughness
_SURFACE = 10.0  # room above for them
_LINES = 20  # of notes, more than which stand in two columns where there is room
_FRAMED = 9.0  # height of the frame of a tolerance over the notes, with air


def write_drawing(
    folder: Path, prefix: str, part: Part, tolerance: float, facts: Facts
) -> list[Path]:
    """Write `<prefix>-<part>-drawing.dxf` and `.pdf` into folder, and tables that have sheets of their own as `-tracks-drawing`,
    `-tracks-2-drawing` and so on; returns their paths.

    tolerance: mm, of the arcs that stand for the exact outline. An OSError means that a file could not be written.
    """
    if facts.shaft:
        return write_shaft(folder, prefix, facts.shaft, facts, part)
    stem = f"{prefix}-{part.name}"
    layout = _Layout(part, stem, tolerance, facts)
    paths = [folder / f"{stem}-drawing.dxf", folder / f"{stem}-drawing.pdf"]
    write_dxf_sheet(paths[0], layout.sheet, layout.scale, layout.datum)
    write_pdf(paths[1], layout.sheet)
    for name, sheet in layout.tables.items():
        paths += [folder / f"{name}.dxf", folder / f"{name}.pdf"]
        write_dxf_sheet(paths[-2], sheet, 1.0, 0j)
        write_pdf(paths[-1], sheet)
    return paths


class _Layout:
    """The sheet of one part; fills `sheet`, and knows `scale` and where the part's `datum` is on the paper."""

    def __init__(self, part: Part, stem: str, tolerance: float, facts: Facts) -> None:
        drawn = self.drawn = DrawnPart(part, stem, tolerance, facts)
        self.tables = tables_sheets(drawn.own_tables, part, facts, stem)
        self.notes = notes_of(drawn, len(self.tables))
        self.right = _RIGHT + (_RUN_OUT if drawn.drum and facts.run_out else 0.0)
        self.inner = _BORE if drawn.bored and not drawn.detailed else 0.0
        self.beside = _BESIDE + self.inner + BOSS * (len(drawn.bosses) + (part.drum is not None))
        self.depth = part.thickness if part.side_profile or drawn.section else 0.0
        surface = drawn.surface or ((drawn.slotted or drawn.lock) and facts.profile)
        self.over = _ABOVE + (_SURFACE if surface else 0.0)
        self.unrolled = None
        self.track_section = None
        if drawn.drum:
            wide = SIZES["A3"][0] - FILING - MARGIN - sum(TABLE_WIDTHS)
            self.unrolled = development(drawn.drum, facts, drawn.datums, wide, SCALES)
            self.track_section = drum_section(drawn.drum, facts, SCALES)
        if facts.groove:
            depth = part.drawn.z1 - part.drawn.z0
            self.track_section = plates_section(facts.groove, depth, facts, SCALES)
        self.size_name, self.scale = self._choose()
        width, height = SIZES[self.size_name]
        self.sheet = Sheet(width, height, f"{part.title} ({stem})")
        self.table_x = width - MARGIN - sum(TABLE_WIDTHS)
        self.datum = self._datum()
        self.page = Page(
            sheet=self.sheet,
            datum=self.datum,
            scale=self.scale,
            tolerance=facts.tolerance,
            side_x=(self.datum + self.scale * drawn.high).real + self.right + _BESIDE / 2,
            room_above=self._room_above,
            room_below=_BELOW + _THIRD,
            inner=self.inner,
            table_x=self.table_x,
        )
        self.sheet.frame(FILING, MARGIN)
        self._views()
        self._table()
        self._details()
        self._note_lines()
        self._tracks()
        facts = replace(facts, number=facts.number or f"{stem}-drawing")
        corner = complex(width - MARGIN, MARGIN)
        size = sheet_words(self.size_name, 1, 1 + len(self.tables))
        title_block(self.sheet, corner, part, facts, self.scale, size)

    def _views(self) -> None:
        """All views with what is written at them."""
        plan = PlanView(self.drawn, self.page)
        sides = SideViews(self.drawn, self.page)
        plan.draw()
        sides.draw()
        sides.third()
        GenevaView(self.drawn, self.page).draw()
        plan.surface()
        sides.run_out()
        plan.hole_datums()
        if self.drawn.turns:
            plan.turning()
        plan.upper_side()
        plan.labels(self.sheet.height - 2 * MARGIN - self._room(self.size_name)[1])

    def _room(self, size: str) -> tuple[float, float]:
        """Width and height that both views and their dimensions may take, mm."""
        width, height = SIZES[size]
        foot = self._foot(size) + (self.unrolled.room if self.unrolled else 0.0)
        return width - FILING - MARGIN - sum(TABLE_WIDTHS), height - 2 * MARGIN - foot

    def _column(self, size: str) -> int:
        """How many lines of notes stand over each other: many fill two columns of an A3 sheet, beside no section of a track."""
        count = len(self.notes)
        split = count > _LINES and size == "A3" and not self.track_section
        return math.ceil(count / 2) if split else count

    def _foot(self, size: str) -> float:
        """Height of notes, title block and the section of a track beside them, mm."""
        frames = self.drawn.placed + (self.drawn.square is not None)
        notes = 3.0 + 4.5 * self._column(size) + _FRAMED * frames
        return max(BLOCK, notes, SECTION_ROOM.imag if self.track_section else 0.0)

    def _tracks(self) -> None:
        """The section of a track beside the notes, and a drum's development over both."""
        corner = complex(FILING, MARGIN)
        if self.track_section:
            place = corner + 3 + NOTES + 4
            self.track_section.draw(self.sheet, place, self.scale, self.drawn.facts.tolerance)
        if self.unrolled:
            self.unrolled.draw(self.sheet, corner + 1j * self._foot(self.size_name))

    def _choose(self) -> tuple[str, float]:
        """Sheet size and scale: A4 unless A3 spares a reduction or the tables need it."""
        span = self.drawn.high - self.drawn.low

        def best(size: str) -> float:
            wide, tall = self._room(size)
            wide -= _LEFT + self.right + self.beside
            tall -= _BELOW + self.over + (2 * _THIRD if self.depth else 0.0)
            high = span.imag + self.depth + self.drawn.rise
            fits = (
                s
                for s in SCALES
                if s * (span.real + self.drawn.part.thickness) <= wide and s * high <= tall
            )
            return next(fits, SCALES[-1])

        if self.track_section:
            return "A3", best("A3")
        a4 = best("A4")
        a3 = best("A3")
        long = (1 + len(self.drawn.rows) + self.drawn.track_lines()) * ROW > SIZES["A4"][
            1
        ] - 2 * MARGIN - BLOCK - self.drawn.details
        tables = self.drawn.track_table or self.drawn.details
        return ("A3", a3) if (a4 < 1 and a3 > a4) or (long and tables) else ("A4", a4)

    def _datum(self) -> complex:
        """Where the part's origin goes: both views in the middle of their room."""
        wide, tall = self._room(self.size_name)
        span = self.scale * (self.drawn.high - self.drawn.low)
        spare_x = (
            wide
            - _LEFT
            - self.right
            - self.beside
            - span.real
            - self.scale * self.drawn.part.thickness
        )
        third = 2 * _THIRD + self.scale * self.depth if self.depth else 0.0
        spare_y = tall - _BELOW - self._room_above - span.imag - third
        foot = SIZES[self.size_name][1] - 2 * MARGIN - tall
        corner = complex(FILING + _LEFT + spare_x / 2, MARGIN + foot + _BELOW + third + spare_y / 2)
        return corner - self.scale * self.drawn.low

    @property
    def _room_above(self) -> float:
        """Room over the plan view, mm of paper."""
        return self.over + self.scale * self.drawn.rise

    def _table(self) -> None:
        """Table of holes, at the upper right; rows that do not fit are counted in its last line; then that of a cam's radii."""
        top = self.sheet.height - MARGIN
        room = self.drawn.lines_beside(self.size_name)
        width = sum(TABLE_WIDTHS)
        table = self.drawn.track_table
        rows = self.drawn.rows
        room = room - (self.drawn.track_lines() if table else 0)
        if len(rows) > room:
            rows = [
                *rows[: room - 1],
                ("...", "", "", f"{len(rows) - room + 1} more: see {self.drawn.stem}.dxf"),
            ]
        if rows:
            head = ("Hole, pin" if self.drawn.standing else "Hole", "X", "Y", "Size")
            first = min(
                20.0,
                max(TABLE_WIDTHS[0], *(Text(0j, cell, 2.5).room + 2 for cell, *_ in (head, *rows))),
            )
            widths = (first, *TABLE_WIDTHS[1:3], sum(TABLE_WIDTHS[::3]) - first)
            grid(self.sheet, complex(self.table_x, top), [head, *rows], widths, (1, 2))
        self.free = top - (len(rows) + 1 if rows else 0) * ROW
        if table is None:
            return
        top -= (len(rows) + 2) * ROW
        self.sheet.text(complex(self.table_x + 1.5, top + 1.3), table.title, room=width - 3)
        beside = table.beside(width)
        lines = [list(table.heads * beside), *table.lines(width)]
        numbers = range(len(table.heads) * beside)
        grid(self.sheet, complex(self.table_x, top), lines, table.widths * beside, numbers)
        self.free = top - len(lines) * ROW

    def _details(self) -> None:
        """Under the tables the seat of a ball bearing by itself, and a bore with a keyway or a flat."""
        low = complex(self.table_x, MARGIN + BLOCK)
        high = complex(self.sheet.width - MARGIN, self.free)
        if self.drawn.seat:
            above = bore_detail.HEIGHT * self.drawn.detailed
            room = low + 1j * above, high
            SeatDetail(self.drawn.seat, self.drawn.facts, self.scale, room).draw(self.sheet, SCALES)
            high -= 1j * seat_detail.HEIGHT
        if self.drawn.detail is None:
            return
        letters = self.drawn.datum_letter, self.drawn.angle_letter
        foot = complex(FILING, MARGIN)
        detail = BoreDetail(
            self.drawn.detail,
            self.drawn.facts,
            self.drawn.axis_label,
            letters,
            self.scale,
            (low, high),
            foot,
        )
        detail.draw(self.sheet, SCALES)

    def _note_lines(self) -> None:
        """Notes at the lower left, beside the title block, upwards."""
        high = self._column(self.size_name)
        for i, line in reversed([*enumerate(self.notes)]):
            column, row = divmod(i, high)
            place = complex(FILING + 3 + column * (NOTES + 4), MARGIN + 3 + 4.5 * (high - 1 - row))
            self.sheet.text(place, line, 2.5, room=NOTES)
        corner = complex(FILING + 3.5, MARGIN + 4 + 4.5 * high)
        square = self.drawn.square
        if square is not None:
            end = squareness(self.sheet, corner, square.zone, self.drawn.face_letter)
            self.sheet.text(end + 2 + 1.8j, square.holes, room=58)
            corner += 1j * _FRAMED
        if self.drawn.placed:
            keyed_too = self.drawn.origin == self.drawn.datum_letter and self.drawn.detailed
            letters = (self.drawn.origin, self.drawn.angle_letter if keyed_too else "")
            datums = [letter for letter in letters if letter]
            end = position(self.sheet, corner, self.drawn.facts.position, datums)
            which = "fitted holes" if self.drawn.threaded else "round holes"
            self.sheet.text(end + 2 + 1.8j, f"{which}; X and Y are exact", room=58)
