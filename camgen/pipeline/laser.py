"""Sheets for a laser: which parts a sheet can be, their paths nested and written, and read back and judged as cut."""

from __future__ import annotations

import cmath
import csv
import math
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from camgen.bounds import Bound, bounded
from camgen.errors import DesignError, FileError
from camgen.files.cutting import Piece, write_sheet
from camgen.files.rows import write_rows
from camgen.findings import Finding, at_most, in_file
from camgen.geometry.facets import facet_contour
from camgen.judge.measured import Sections
from camgen.judge.round_trip import judge_drawing
from camgen.judge.sheets import Beam, SheetCopy, judge_sheet
from camgen.machines.mechanism import Mechanism
from camgen.parts.assembly import cut_of_sheet
from camgen.parts.fits import Compensation, compensated
from camgen.parts.nesting import Spot, nest
from camgen.parts.part import Part
from camgen.parts.sheets import why_not
from camgen.pipeline.case import Case
from camgen.pipeline.expectation import nominal_part
from camgen.spec import Laser
from camgen.study import Figure, Table

_PACKED = 0.02  # mm, chord tolerance of outlines that are only to be nested
_SIZE = Bound("a list of sheets", 20_000_000, most=200_000)
_COLUMNS = ("sheet", "part", "copy", "x_mm", "y_mm", "angle_deg")


def sheet_parts(mechanism: Mechanism) -> list[Part]:
    """The parts that are cut of sheets."""
    return [part for part in mechanism.assembly.parts if cut_of_sheet(mechanism.assembly, part)]


def _path(part: Part, laser: Laser) -> Part:
    """The part whose outlines are what the middle of the beam follows; DesignError where the beam is too wide for it."""
    try:
        return compensated(part, Compensation(hole=-laser.kerf / 2, profile=-laser.kerf / 2))
    except DesignError as error:
        raise error.mended(
            f"laser.kerf = {laser.kerf:g} mm is too wide for a hole or a slot of {part.name}: take a finer beam, or widen it",
        ) from None


def make_sheets(case: Case) -> None:
    """Write <name>-sheet-1.dxf, .svg and so on, and the list <name>-sheets.csv; nothing where no part can be cut of a sheet.

    DesignError where a part is larger than a sheet, or the beam too wide for it.
    """
    mechanism = case.mechanism
    laser = case.mechanism.laser
    parts = sheet_parts(mechanism)
    if laser is None or not parts:
        return
    paths = {part.name: _path(part, laser) for part in parts}
    copies = [(part.name, k + 1) for part in parts for k in range(part.count)]
    outlines = {name: facet_contour(path.region.outer, _PACKED) for name, path in paths.items()}
    spots: list[Spot] = []
    for (name, _), spot in zip(
        copies, nest([outlines[name] for name, _ in copies], laser.sheet, laser.gap), strict=True
    ):
        if spot is None:
            z = outlines[name]
            raise DesignError(
                f"length of {name}",
                max(float(np.ptp(z.real)), float(np.ptp(z.imag))),
                max(laser.sheet),
                "mm",
                remedy=f"it fits on no sheet of {laser.sheet[0]:g} x {laser.sheet[1]:g} mm: make laser.sheet larger",
            )
        spots.append(spot)
    rows = sorted(
        zip(copies, spots, strict=True),
        key=lambda row: (row[1].sheet, row[1].place.real, row[1].place.imag),
    )
    placements = [
        (copy, Spot(s.sheet, s.angle, complex(round(s.place.real, 6), round(s.place.imag, 6))))
        for copy, s in rows
    ]
    for number in range(1 + max(spot.sheet for spot in spots)):
        pieces = []
        for (name, copy), spot in placements:
            if spot.sheet == number:
                turn = cmath.rect(1, spot.angle)
                path = paths[name]
                engraved = tuple(contour.moved(turn, spot.place) for contour in path.engraving)
                pieces.append(
                    Piece(f"{name}-{copy}", path.region.moved(turn, spot.place), engraved)
                )
        for ending in ("dxf", "svg"):
            write_sheet(
                case.file(f"sheet-{number + 1}", ending),
                pieces,
                laser.sheet,
                mechanism.accuracy.chord_tolerance,
            )
    lines = (
        [
            s.sheet + 1,
            name,
            copy,
            f"{s.place.real:z.6f}",
            f"{s.place.imag:z.6f}",
            f"{math.degrees(s.angle):z.9g}",
        ]
        for (name, copy), s in placements
    )
    write_rows(case.file("sheets", "csv"), _COLUMNS, lines)


def sheet_files(case: Case) -> list[Path]:
    """The files of all sheets that are there, and their list."""
    return [
        path for path in (*case.files("sheet-[0-9]*"), case.file("sheets", "csv")) if path.exists()
    ]


def _listed(path: Path) -> dict[int, list[SheetCopy]]:
    """The list of sheets as read: what lies on each, by its number; FileError where it is none."""
    sheets: dict[int, list[SheetCopy]] = {}
    bounded(path, _SIZE)
    try:
        with open(path, encoding="utf-8", newline="") as file:
            for row in csv.DictReader(file):
                place = complex(float(row["x_mm"]), float(row["y_mm"]))
                copy = SheetCopy(
                    row["part"], int(row["copy"]), math.radians(float(row["angle_deg"])), place
                )
                sheets.setdefault(int(row["sheet"]), []).append(copy)
    except OSError as error:
        raise FileError(path, error.strerror or str(error)) from None
    except (KeyError, ValueError, TypeError) as error:
        raise FileError(path, f"not a list of sheets: {error!r}") from None
    return sheets


def judge_sheets(
    case: Case,
) -> tuple[list[Finding], dict[str, Sections], list[Table], list[Figure]]:
    """Findings on all sheets; sections of every part, as cut of a sheet or else as drawn; tables; figures."""
    mechanism = case.mechanism
    laser = case.mechanism.laser
    assert laser is not None, "sheets are asked for"
    features = mechanism.assembly.features
    tolerance = mechanism.accuracy.chord_tolerance
    parts = {part.name: part for part in sheet_parts(mechanism)}
    findings: list[Finding] = []
    sections: dict[str, Sections] = {}
    rows: list[tuple[object, ...]] = []
    figures: list[Figure] = []
    if parts:
        sheets = _listed(case.file("sheets", "csv"))
        strange = sorted(
            {each.part for copies in sheets.values() for each in copies} - parts.keys()
        )
        if strange:
            raise FileError(
                case.file("sheets", "csv"),
                f"lists {', '.join(strange)}, which are not cut of sheets",
            )
        shapes = {name: nominal_part(part, tolerance, features) for name, part in parts.items()}
        beam = Beam(laser.kerf, laser.gap, laser.sheet)
        for number, copies in sorted(sheets.items()):
            dxf, svg = (case.file(f"sheet-{number}", ending) for ending in ("dxf", "svg"))
            sheet_findings, verdicts = judge_sheet(dxf, svg, copies, shapes, beam)
            findings += sheet_findings
            sections |= {name: each.sections for name, each in verdicts.items()}
            rows += _rows(number, copies, laser)
        findings += _copies(sheets, parts, case)
        figures = [
            Figure("sheets", len(sheets)),
            Figure("sheet density", _density(sheets, parts, laser)),
        ]
    for part in mechanism.assembly.parts:
        if part.name not in parts:
            rows.append(("none", part.name, part.count, "", why_not(part, laser.thickness)))
        if part.name not in sections and case.file(part.name, "dxf").exists():
            shape = nominal_part(part, tolerance, features, None, mechanism.files)
            verdict = judge_drawing(case.file(part.name, "dxf"), shape)
            if verdict.sections:
                sections[part.name] = verdict.sections
    columns = ("sheet", "part", "count", "angles, deg", "otherwise")
    return (
        findings,
        sections,
        [Table("Cut of sheets, and what is made otherwise", columns, rows)],
        figures,
    )


def _rows(number: int, copies: Sequence[SheetCopy], laser: Laser) -> list[tuple[object, ...]]:
    """What lies on a sheet, for people."""
    rows: list[tuple[object, ...]] = []
    for name in dict.fromkeys(copy.part for copy in copies):
        angles = ", ".join(f"{math.degrees(copy.angle):g}" for copy in copies if copy.part == name)
        rows.append(
            (
                f"{number}, {laser.thickness:g} mm",
                name,
                sum(copy.part == name for copy in copies),
                angles,
                "",
            )
        )
    return rows


def _copies(
    sheets: dict[int, list[SheetCopy]], parts: dict[str, Part], case: Case
) -> list[Finding]:
    """COPIES of all sheets together: those that are missing, too many or wrongly numbered."""
    present = Counter((copy.part, copy.copy) for copies in sheets.values() for copy in copies)
    expected_copies = Counter(
        (name, k + 1) for name, part in parts.items() for k in range(part.count)
    )
    off = max((expected_copies - present).total(), (present - expected_copies).total())
    remark = f"{present.total()} copies of {len(parts)} parts on {len(sheets)} sheet{'' if len(sheets) == 1 else 's'}"
    return [at_most("COPIES", off, 0, "copies", in_file(case.file("sheets", "csv")), remark)]


def _density(sheets: dict[int, list[SheetCopy]], parts: dict[str, Part], laser: Laser) -> float:
    """Area within the outlines of all parts over that of the sheets, of the last one as far as it is used."""
    area = length_used = 0.0
    outlines = {name: facet_contour(part.region.outer, _PACKED) for name, part in parts.items()}
    for number, copies in sheets.items():
        area += sum(abs(parts[copy.part].region.outer.area) for copy in copies)
        ends = [
            float((outlines[copy.part] * cmath.rect(1, copy.angle) + copy.place).real.max())
            for copy in copies
        ]
        length_used += laser.sheet[1] * (max(ends) if number == max(sheets) else laser.sheet[0])
    return area / length_used if length_used else math.nan
