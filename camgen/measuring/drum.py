"""`camgen motion DRUM.stl --roller ...`: the motion of a roller in the track of a cylinder cam, from the mesh of any maker alone."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from camgen import reading
from camgen import spec as specs
from camgen.errors import DesignError, FileError
from camgen.files.folder import name_of
from camgen.findings import at_most, in_file
from camgen.geometry.mesh import Mesh, mesh_faults
from camgen.judge.follower_table import inline_tables
from camgen.judge.rolled_drum import Rolled, RollerTable, roll, track_findings
from camgen.measuring.folder import write_folder
from camgen.measuring.meshes import MESH_SIZES, ForeignMesh, read_mesh
from camgen.numerics import Floats, magnitude
from camgen.report.report import Report
from camgen.study import Figure, Plot

_EACH = 2  # of which every second is a row of motion.csv: a quarter degree
_PACKAGES = ("numpy", "pydantic", "lib3mf", "trimesh")


def read_roller(
    given: str | PathLike[str] | Mapping[str, Any], option: str = "--roller"
) -> RollerTable:
    """The table from text such as "radius=5,length=8,inner=22", its keys, or a TOML file, its table [roller] or all of it.

    SpecError with every fault; FileError where the file cannot be read.
    """
    if isinstance(given, Mapping):
        data: Mapping[str, Any] = given
    else:
        text = str(given)
        data = reading.read(Path(text)) if text.endswith(".toml") else inline_tables(text, option)
    table = data.get("roller", data)
    return specs.validate(RollerTable, dict(table if isinstance(table, Mapping) else data), option)


def rolls(path: Path, roller: str | PathLike[str] | Mapping[str, Any], harmonics: int) -> Rolled:
    """What is free for the follower of a roller in the drum of a mesh; SpecError, FileError or DesignError."""
    table = read_roller(roller, "roller")
    return _rolled(_mesh(path).mesh, table, harmonics)


def _rolled(mesh: Mesh, table: RollerTable, harmonics: int) -> Rolled:
    """The roller in a mesh; DesignError of one that is inside out, and of one without a track, with what is wrong with the mesh."""
    faults = mesh_faults(mesh)
    if not faults.count and faults.volume < 0:
        remedy = "the mesh is inside out: turn its faces round, so that they look outwards"
        raise DesignError("volume", faults.volume, 0, "mm^3", "the drum", remedy)
    try:
        return roll(mesh, table, harmonics)
    except DesignError as error:
        if not faults.count:
            raise
        remedy = f"{error.remedy}; the mesh has {faults.defects}: mend it first"
        raise error.mended(remedy) from None


def _mesh(path: Path) -> ForeignMesh:
    """The content of a mesh; FileError of any other file."""
    if path.suffix.lower() not in MESH_SIZES:
        raise FileError(path, f"a roller needs a mesh, {', '.join(MESH_SIZES)}")
    return read_mesh(path)


# ---- the report ------------------------------------------------------------------------------------------------------


def run(
    path: Path,
    roller: str,
    harmonics: int,
    out: Path,
    progress: Callable[[str], None] = lambda _: None,
) -> Report:
    """Read a mesh, roll the roller in it, write OUT/<file>-motion/ with report.html, report.json and motion.csv.

    Raises SpecError, FileError or DesignError; where the mesh is not watertight, a finding says so.
    """
    table = read_roller(roller)
    progress(f"reading {path.name}")
    content = _mesh(path)
    progress("rolling")
    rolled = _rolled(content.mesh, table, harmonics)
    faults = mesh_faults(content.mesh)
    triangles = f"{len(content.mesh.faces)} triangles"
    findings = [
        *content.findings,
        at_most("WATERTIGHT", faults.count, 0, "faults", in_file(path), triangles),
        *track_findings(rolled, table, in_file(path)),
    ]
    columns = _columns(rolled, table)
    report = Report(f"{name_of(path)}-motion", "a roller in a drum", findings)
    report = replace(
        report,
        numbers=report.numbers | _figures(rolled, table, len(content.mesh.faces)),
        plots=_plots(columns, table, harmonics),
        notes=tuple(_notes(rolled, table, harmonics, content.unit)),
        remarks=tuple(_summary(rolled, table)),
        files=("motion.csv", "report.json", "manifest.json"),
    )
    return write_folder(report, columns, out, _PACKAGES, progress)


def _columns(rolled: Rolled, table: RollerTable) -> Mapping[str, Floats]:
    """Of motion.csv: every quarter degree, both ends of the turn included."""
    name, scale = table.unit
    columns = {"theta_deg": np.degrees(rolled.theta), f"follower_{name}": rolled.motion * scale}
    if rolled.track != "end":
        columns[f"follower_low_{name}"] = rolled.low * scale
        columns[f"follower_high_{name}"] = rolled.high * scale
        columns[f"play_{name}"] = rolled.play * scale
    columns[f"speed_{name}_rad"] = rolled.speed * scale
    columns[f"acceleration_{name}_rad2"] = rolled.acceleration * scale
    columns["pressure_angle_deg"] = np.degrees(rolled.pressure_angle)
    turn = {key: np.append(values[::_EACH], values[0]) for key, values in columns.items()}
    turn["theta_deg"][-1] = turn["theta_deg"][0] + 360.0
    return turn


def _figures(rolled: Rolled, table: RollerTable, triangles: int) -> list[Figure]:
    name, scale = table.unit
    known = rolled.motion[np.isfinite(rolled.motion)] * scale
    play = rolled.play[np.isfinite(rolled.play)] * scale
    figures = [Figure("triangles", triangles)]
    if len(known):
        figures.append(
            Figure("stroke" if table.arm is None else "swing", float(np.ptp(known)), name)
        )
        figures.append(Figure("follower least", float(known.min()), name))
        figures.append(Figure("follower most", float(known.max()), name))
    if len(play):
        figures.append(Figure("play least", float(play.min()), name))
        figures.append(Figure("play most", float(play.max()), name))
    if np.isfinite(rolled.speed).all():
        steepest = magnitude(rolled.pressure_angle)
        figures += [
            Figure("peak speed", magnitude(rolled.speed) * scale, f"{name}/rad"),
            Figure(
                "peak acceleration",
                magnitude(rolled.acceleration) * scale,
                f"{name}/rad²",
            ),
            Figure("pressure angle", math.degrees(steepest), "deg"),
            Figure("off between samples", rolled.between, "mm"),
        ]
    return figures


def _plots(columns: Mapping[str, Floats], table: RollerTable, harmonics: int) -> list[Plot]:
    name, _ = table.unit
    passed = f"low-passed at {harmonics} harmonics"
    shown = (
        ("Follower", name, f"follower_{name}"),
        ("Play between both walls", name, f"play_{name}"),
        (f"Speed, {passed}", f"{name} per rad", f"speed_{name}_rad"),
        (f"Acceleration, {passed}", f"{name} per rad²", f"acceleration_{name}_rad2"),
        ("Pressure angle at the roller's inner end", "deg", "pressure_angle_deg"),
    )
    return [
        Plot(title, "cam angle, deg", unit, [(title, columns["theta_deg"], columns[key])])
        for title, unit, key in shown
        if key in columns
    ]


def _notes(rolled: Rolled, table: RollerTable, harmonics: int, unit: str) -> Iterator[str]:
    if unit:
        yield unit
    place = "height of the roller's axis along the drum's axis, as the file counts it"
    if table.arm is not None:
        place = "angle of the arm, from the plane perpendicular to the drum's axis, positive along the axis"
    if table.track == "rib":
        place = "height of the middle of both rollers along the drum's axis, as the file counts it"
    yield f"The drum turns counter-clockwise about its axis. The follower's place is the {place}."
    if table.track == "end":
        yield "The roller lies on the wall below it; a spring must hold it there."
    yield (
        "The roller lies against the triangles themselves, exactly at each of "
        f"{len(rolled.theta)} angles; between two of them either wall may stand {rolled.between:.2g} mm nearer."
    )
    yield f"Speed, acceleration and pressure angle are low-passed at {harmonics} harmonics of a turn."
    yield "Arm, slide and frame round the drum are not judged: the roller alone is."


def _summary(rolled: Rolled, table: RollerTable) -> Iterator[str]:
    name, scale = table.unit
    if not np.isfinite(rolled.motion).any():
        return
    yield f"the follower moves {float(np.nanmax(rolled.motion) - np.nanmin(rolled.motion)) * scale:.4g} {name}"
    if rolled.track != "end":
        least, most = (float(f(rolled.play)) * scale for f in (np.nanmin, np.nanmax))
        yield f"its play is {least:.2g} to {most:.2g} {name}"
