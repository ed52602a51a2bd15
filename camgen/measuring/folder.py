"""The folder that `camgen motion` leaves: report and curves, whole or not at all."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

from camgen.files.folder import StagingFolder, write_manifest
from camgen.numerics import Floats
from camgen.report.page import write_html
from camgen.report.report import Report, write_csv, write_json

# What reads the outlines of others.
OUTLINE_PACKAGES = ("numpy", "pydantic", "ezdxf", "lib3mf", "scipy", "shapely", "trimesh")


def write_folder(
    report: Report,
    columns: Mapping[str, Floats],
    out: Path,
    packages: tuple[str, ...],
    progress: Callable[[str], None],
) -> Report:
    """Write OUT/<name>/: report.json, and where there are columns motion.csv and report.html; the report with its folder.

    packages: on which the figures depend. FileError where the folder cannot be written.
    """
    with StagingFolder(out / report.name) as folder:
        if columns:
            progress("writing the report")
            write_csv(folder / "motion.csv", columns)
            write_html(folder / "report.html", report)
        write_json(folder / "report.json", report)
        write_manifest(folder, packages)
    return replace(report, folder=out / report.name)
