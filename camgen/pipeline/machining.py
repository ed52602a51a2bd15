"""Tables for machine tools: a cam's profile by its angle, and the path of a cutter's centre round it as exact lines and arcs.

<name>-<part>-profile.csv    contact, normal, curvature and pressure angle at each cam angle, in the part's frame
<name>-<part>-path.dxf .csv  where the centre of a cutter of `files.cutter_radius` runs, counter-clockwise: round the cam, or
                             within the outer wall of a groove
<name>-<part>-developed.dxf  a drum's track unrolled, see `development`
"""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from camgen.bounds import Bound, bounded
from camgen.errors import DesignError, FileError
from camgen.files.dxf import read_dxf, write_dxf
from camgen.files.rows import write_rows
from camgen.findings import Finding, at_most, in_file
from camgen.geometry.arcs import fit_arcs
from camgen.geometry.outlines import Arc, Piece, Region, end_point, start_point
from camgen.geometry.rings import Ring
from camgen.judge.cams import outline_and_law
from camgen.judge.joints import RollingLaw
from camgen.judge.machine_tables import Profile, Step, judge_path, judge_profile
from camgen.judge.round_trip import pieces_of
from camgen.machine.cams.machine import CamTouch
from camgen.machine.features import CamOutline, Mount
from camgen.machine.model import Cam
from camgen.machines.mechanism import Mechanism
from camgen.parts.fits import offset
from camgen.pipeline.case import Case
from camgen.pipeline.development import judge_developments, make_developments

_SIZE = Bound("a table for a machine tool", 50_000_000, most=200_000)
_PROFILE = (
    "theta_deg",
    "radius_mm",
    "angle_deg",
    "x_mm",
    "y_mm",
    "normal_deg",
    "curvature_per_mm",
    "pressure_angle_deg",
)
_PATH = (
    "piece",
    "x0_mm",
    "y0_mm",
    "x1_mm",
    "y1_mm",
    "centre_x_mm",
    "centre_y_mm",
    "radius_mm",
    "sweep_deg",
)


def cams_of(mechanism: Mechanism) -> dict[str, tuple[CamTouch, Mount, float]]:
    """Where cams and outer walls of grooves are touched by their own follower, by the part that each is, how it stands on its
    body, and how far it is off that follower, mm."""
    cams: dict[str, tuple[CamTouch, Mount, float]] = {}
    count: dict[str, int] = {}
    for feature in mechanism.assembly.features:
        if not isinstance(feature, CamOutline):
            continue
        joint = mechanism.model.joint(feature.joint)
        k = count.get(feature.joint, 0)
        count[feature.joint] = k + 1
        mount = [mount for mount in mechanism.assembly.mounts if mount.part == feature.part][
            feature.copy
        ]
        assert isinstance(joint, Cam), f"{feature.joint} is no cam"
        touch = joint.touches[k] if k < len(joint.touches) else None
        left_out = mount.flipped or feature.part in cams or feature.layer is not None
        if isinstance(touch, CamTouch) and not touch.mirrored and not left_out:
            cams[feature.part] = touch, mount, feature.free if touch.outer else 0.0
    return cams


def make_tables(case: Case) -> None:
    """Write what `files.profile_step_deg` and `files.cutter_radius` ask for, of every cam, and the development of every drum.

    DesignError where the cutter's path falls apart.
    """
    files = case.mechanism.files
    tolerance = case.mechanism.accuracy.chord_tolerance
    make_developments(case)
    for name, (touch, mount, free) in cams_of(case.mechanism).items():
        if files.profile_step_deg is not None:
            rows = _profile(touch, mount, free, files.profile_step_deg)
            _write(case.file(f"{name}-profile", "csv"), _PROFILE, rows)
        if files.cutter_radius is not None:
            region = case.parts[name].region
            wall = max(region.holes, key=lambda hole: hole.length) if touch.outer else region.outer
            outline = fit_arcs(wall.counter_clockwise(), tolerance)
            try:
                path = offset(
                    outline, files.cutter_radius * (-1 if touch.outer else 1), f"outline of {name}"
                )
            except DesignError as error:
                raise error.mended(
                    f"a cutter of files.cutter_radius = {files.cutter_radius:g} mm finds no path: use a smaller one",
                ) from None
            write_dxf(case.file(f"{name}-path", "dxf"), Region(path), (), tolerance)
            _write(case.file(f"{name}-path", "csv"), _PATH, map(_piece, path.pieces))


def _write(path: Path, columns: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    said = ([_text(cell) if isinstance(cell, float) else cell for cell in row] for row in rows)
    write_rows(path, columns, said)


def _text(value: float) -> str:
    """A number with nine decimals at most; blank for none."""
    return "" if math.isnan(value) else f"{value:z.9f}".rstrip("0").rstrip(".")


def _profile(
    touch: CamTouch, mount: Mount, free: float, step_deg: float
) -> Iterable[Sequence[object]]:
    """Rows of a cam's table over a turn; on an undercut's corner there is no normal and no curvature."""
    theta = np.radians(np.arange(0, 360, step_deg))
    cam = touch.cam
    place, normal = touch(theta)
    place = place - free * normal
    radius = touch.radius(theta) - free
    pressure = cam.pressure_angle(theta)
    with np.errstate(divide="ignore"):
        curvature = 1 / radius
    for undercut in () if touch.outer else cam.undercuts:
        rides = np.mod(theta - undercut.begin, math.tau) < undercut.end - undercut.begin
        place[rides] = undercut.corner_cam
        normal[rides] = np.nan
        curvature[rides] = np.nan
    turn = np.exp(-1j * mount.angle)
    place = (place - mount.at) * turn
    normal = normal * turn
    columns = (
        np.degrees(theta),
        np.abs(place),
        np.degrees(np.angle(place)) % 360,
        place.real,
        place.imag,
        np.degrees(np.angle(normal)) % 360,
        curvature,
        np.degrees(pressure),
    )
    rows: list[tuple[object, ...]] = list(
        zip(*(column.tolist() for column in columns), strict=True)
    )
    return rows


def _piece(piece: Piece) -> Sequence[object]:
    """A row of the cutter's path; the cells of a centre are blank on a line."""
    a = start_point(piece)
    b = end_point(piece)
    ends = (a.real, a.imag, b.real, b.imag)
    if isinstance(piece, Arc):
        centre = (piece.centre.real, piece.centre.imag, piece.radius, math.degrees(piece.sweep))
        return ("arc ccw" if piece.sweep > 0 else "arc cw", *ends, *centre)
    return ("line", *ends, "", "", "", "")


def table_files(case: Case) -> list[Path]:
    """Tables and paths that a build may have made and that are there."""
    names = [
        (f"{name}-{what}", ending)
        for name in case.parts
        for what, ending in (
            ("profile", "csv"),
            ("path", "dxf"),
            ("path", "csv"),
            ("developed", "dxf"),
        )
    ]
    return [path for path in (case.file(*each) for each in names) if path.exists()]


def judge_tables(case: Case) -> list[Finding]:
    """Whether tables lie on the outlines in the parts' own DXF, column by column, and whether the cutter on its path leaves those
    outlines."""
    files = case.mechanism.files
    tolerance = case.mechanism.accuracy.chord_tolerance
    findings = list(judge_developments(case))
    for name, (touch, *_) in cams_of(case.mechanism).items():
        rings = sorted(
            read_dxf(case.file(name, "dxf"), any_curves=True).cut, key=lambda ring: -abs(ring.area)
        )
        if not rings[touch.outer :]:
            continue  # told as the drawing is judged
        outline = rings[touch.outer].counter_clockwise()
        table = case.file(f"{name}-profile", "csv")
        if files.profile_step_deg is not None:
            try:
                law = _rolled(case.mechanism, name, rings)
            except ValueError as fault:
                findings.append(
                    at_most("ROUND_TRIP", math.nan, 2 * tolerance, "mm", in_file(table), str(fault))
                )
            else:
                ring = (
                    outline.reversed() if touch.outer else outline
                )  # with the material on its left
                findings += judge_profile(
                    table, _read_profile(table), ring, law, files.profile_step_deg, tolerance
                )
        path = case.file(f"{name}-path", "dxf")
        if files.cutter_radius is not None:
            pieces = _read_path(path.with_suffix(".csv"))
            findings += judge_path(
                path, pieces, outline, files.cutter_radius, 2 * tolerance, touch.outer
            )
    return findings


def _rolled(mechanism: Mechanism, part: str, rings: Sequence[Ring]) -> RollingLaw:
    """What the follower rolls to on a part's outline as it is drawn; ValueError where it does not fit."""
    feature = next(
        each
        for each in mechanism.assembly.features
        if isinstance(each, CamOutline) and each.part == part
    )
    made = mechanism.assembly
    sections = [pieces_of(rings)]
    law = outline_and_law(mechanism.model, feature, made.mounts, sections, made.shoe(feature))[1]
    assert isinstance(law, RollingLaw), "a plate has no table over a turn"
    return law


def _rows(path: Path, columns: Sequence[str]) -> list[list[str]]:
    """Cells of a table with these columns; FileError where it is none."""
    bounded(path, _SIZE)
    try:
        with open(path, encoding="utf-8", newline="") as file:
            head, *rows = csv.reader(file, strict=True)
        if head != list(columns) or any(len(row) != len(columns) for row in rows):
            raise ValueError(f"its columns must be {', '.join(columns)}")
        return rows
    except (OSError, UnicodeDecodeError, ValueError, csv.Error) as error:
        raise FileError(
            path, f"cannot be read as a table: {getattr(error, 'strerror', None) or error}"
        ) from None


def _number(cell: str) -> float:
    """A finite number; ValueError for anything else."""
    value = float(cell)
    if not math.isfinite(value):
        raise ValueError(f"{cell!r} is no finite number")
    return value


def _read_profile(path: Path) -> Profile:
    """A table of a profile; FileError where it is none."""
    rows = _rows(path, _PROFILE)
    blank = [_PROFILE.index(name) for name in ("normal_deg", "curvature_per_mm")]
    try:
        cells = [
            [math.nan if k in blank and not cell else _number(cell) for k, cell in enumerate(row)]
            for row in rows
        ]
    except ValueError as error:
        raise FileError(path, f"not a table of a profile: {error}") from None
    theta, radius, angle, x, y, normal, curvature, pressure = (
        np.array(cells).reshape(-1, len(_PROFILE)).T
    )
    facing = np.exp(1j * np.radians(normal))
    return Profile(
        np.radians(theta),
        x + 1j * y,
        radius,
        np.radians(angle),
        facing,
        curvature,
        np.radians(pressure),
    )


def _read_path(path: Path) -> list[Step]:
    """A table of a path; FileError where it is none."""
    try:
        return [_step(*row) for row in _rows(path, _PATH)]
    except ValueError as error:
        raise FileError(path, f"not a table of a path: {error}") from None


def _step(kind: str, *cells: str) -> Step:
    """A row of a path's table."""
    x0, y0, x1, y1 = map(_number, cells[:4])
    x, y, radius, sweep = (_number(cell) if cell else math.nan for cell in cells[4:])
    return Step(kind, complex(x0, y0), complex(x1, y1), complex(x, y), radius, math.radians(sweep))
