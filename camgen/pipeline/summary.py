"""What a build says of itself beside the parts' own files: the machine in motion, curves, texts of its kind, reports, drawings.

All of it follows from spec.toml and the parts' files, so that it can be made again from a folder and compared.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from camgen.errors import FileError
from camgen.files.cutting import SheetPicture, sheet_picture
from camgen.files.formats import RENDERED, SOLID
from camgen.geometry.outlines import Floats
from camgen.parts.fixing import is_as_sold
from camgen.pipeline.case import Case
from camgen.plotting import write_plots
from camgen.report.page import once, write_html
from camgen.report.report import Report, write_csv, write_json
from camgen.study import Plate, Scene

_WITHOUT_SOLIDS = (
    "This page has no view in three dimensions and no steps of assembly, since no solids were built: "
    "build with --only 3mf,report, or without --only"
)


def plates_of(case: Case) -> list[Path]:
    """The plate files of a build, in their order."""
    return [*case.files("plate.3mf"), *case.files("plate-[0-9]*.3mf")]


def rendered_file(case: Case, folder: Path, kind: str) -> Path:
    """Where a picture of the whole machine lies, of a kind of RENDERED."""
    return folder / f"{case.mechanism.name}-{kind}.{RENDERED[kind]}"


def scene_of(case: Case, kinds: Collection[str]) -> Scene | None:
    """The machine in three dimensions, with the plates as they lie in the folder; None where nothing asks for it."""
    if "report" not in kinds or not any(kind in kinds for kind in SOLID):
        return None
    from camgen.pipeline.shown import scene

    plates = [_plate(path, case.mechanism.print.bed) for path in plates_of(case)]
    return scene(case.mechanism, plates)


def _plate(path: Path, bed: tuple[float, float]) -> Plate:
    """A plate as its file has it, for a bed of a width and depth, mm."""
    from camgen.files.threemf import read_3mf

    items = read_3mf(path).items
    corners = [item.placed.vertices for item in items] or [np.zeros((1, 3))]
    width, depth, height = np.ptp(np.vstack(corners), axis=0).tolist()
    copies = [(item.name, item.transform) for item in items]
    return Plate(path.name, copies, (width, depth, height), bed)


def _sheets(case: Case) -> list[SheetPicture]:
    """The sheets for a laser that are there, as pictures; what cannot be read is a finding elsewhere."""
    pictures = []
    for path in case.files("sheet-[0-9]*.svg") if case.mechanism.laser is not None else ():
        with suppress(FileError):
            pictures.append(sheet_picture(path))
    return pictures


def draw_part(case: Case, name: str, folder: Path) -> None:
    """Write the dimensioned drawing of a part; nothing of one that is used as it is sold."""
    from camgen.files import drawing
    from camgen.pipeline.drawings import facts_of

    mechanism = case.mechanism
    part = case.parts[name]
    if is_as_sold(part):
        return
    facts = facts_of(mechanism, part)
    drawing.write_drawing(folder, mechanism.name, part, mechanism.accuracy.chord_tolerance, facts)


def write_texts(case: Case, folder: Path) -> None:
    """Write the texts of a machine's kind, such as a linkage's chain."""
    for name, text in case.mechanism.assembly.texts.items():
        (folder / f"{case.mechanism.name}-{name}").write_text(text, encoding="utf-8", newline="\n")


@dataclass(frozen=True)
class Summary:
    """What a report is written of: the kinds of files that were asked for, what was found of them, the columns of motion.csv, and
    the machine in three dimensions."""

    kinds: Collection[str]
    report: Report
    columns: Mapping[str, Floats]
    scene: Scene | None


def report_files(summary: Summary) -> list[str]:
    """Names of what `write_report` writes, but plots."""
    return [
        "report.json",
        *(["motion.csv"] if summary.columns else []),
        *(["report.html"] if "report" in summary.kinds else []),
    ]


def write_report(summary: Summary, case: Case, folder: Path) -> None:
    """Write motion.csv, report.json, and where they are asked for report.html, plots and pictures of the machine."""
    if summary.columns:
        write_csv(folder / "motion.csv", summary.columns)
    if "report" in summary.kinds:
        from camgen.pipeline.shown import animation

        report = replace(
            summary.report,
            animation=animation(case.mechanism, case.study.sketches),
            scene=summary.scene,
            why_flat="" if summary.scene else _WITHOUT_SOLIDS,
            places=case.places,
            sheets=_sheets(case),
        )
        write_html(folder / "report.html", report)
    if "plots" in summary.kinds:
        write_plots(folder, case.mechanism.name, once(summary.report.plots))
    for kind in RENDERED.keys() & summary.kinds:
        from camgen.pipeline.shown import rendered

        rendered_file(case, folder, kind).write_bytes(rendered(case.mechanism, kind))
    write_json(folder / "report.json", summary.report)
