"""Cam tables for servo drives: what the follower of each cam does, or a motor by its program, written in the texts of the makers, read back and judged.

<name>-<cam>-codesys.st, -twincat.st   rows with velocity and acceleration, between which the drive lays quintics
<name>-<cam>-s7.st                     points alone, every half degree
<name>-<cam>-servo.csv                 the rows of the first two, for any other drive
<name>-grbl.nc                         one program for all motors, of lines from row to row
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from camgen.errors import Fault, SpecError
from camgen.files.grbl import AXES, ENDING, GrblProgram, read_grbl
from camgen.files.servo import DIALECTS, PLAIN, CamTable, plain_text, read_cam_table
from camgen.findings import Finding, Where, at_most
from camgen.geometry.outlines import Floats
from camgen.machines.follower_motions import (
    CODE,
    NARROWEST,
    FollowerMotion,
    motors_together,
    table_finding,
    table_motions,
)
from camgen.numerics import distinct
from camgen.pipeline.case import Case
from camgen.pipeline.scope import Outcome
from camgen.study import Table

_WIDEST = 30.0  # deg, between two rows
_OFF = 1e-6  # of the stroke, by which quintics between rows may leave the motion
_STEP = 0.5  # deg, between points without velocity
_INSIDE = np.linspace(0, 1, 10)[1:-1]  # places between two rows that are looked at
_SAME_ANGLE = 1e-7  # deg
_LINES = 0.003  # deg, by which lines between the rows of a program leave a motor's motion where it has no jump
_MOST_LINES = 0.005  # deg, by which they may
_SAME_TIME = 0.01  # deg of theta: F has six digits
_ROWS = tuple(180 * 2**k for k in range(8))  # of a program, the last as it is


def _rows(motion: FollowerMotion) -> CamTable:
    """Rows at all breaks, and so many more that quintics between them keep to the motion."""
    ends = _masters(np.arange(0, 360 + _WIDEST, _WIDEST), motion.breaks)
    allowed = _OFF * motion.stroke
    table = _table(motion, ends)
    while True:
        x = table.master
        inside = x[:-1, None] + np.diff(x)[:, None] * _INSIDE
        off = np.abs(table.curve()(inside, 0) - motion.law(inside, 0)).max(axis=1)
        wide = np.flatnonzero((off > allowed) & (np.diff(x) > NARROWEST))
        if not wide.size:
            return table
        table = _table(motion, np.insert(x, wide + 1, (x[wide] + x[wide + 1]) / 2))


def _masters(even: Floats, breaks: Floats) -> Floats:
    """Even angles from 0 to 360 deg and the breaks, copies of one angle once."""
    x = distinct(even, breaks)
    x = np.asarray(x[np.append(True, np.diff(x) > _SAME_ANGLE)], float)
    x[-1] = 360
    return x


def _table(motion: FollowerMotion, x: Floats) -> CamTable:
    return CamTable(motion.unit, x, *(motion.law(x, order) for order in range(3)))


def _even_points(motion: FollowerMotion, most: int) -> CamTable:
    """Even points, with those at breaks as far as there is room."""
    even = np.arange(0, 360 + _STEP, _STEP)
    every = _masters(even, motion.breaks)
    x = every if len(every) <= most else even
    return CamTable(motion.unit, x, motion.law(x, 0))


def _files(case: Case, motion: FollowerMotion) -> dict[str, Path]:
    """The file of each dialect, and of the plain table."""
    name = motion.name.replace(" ", "-")
    found = {}
    for key, ending in (*((key, d.ending) for key, d in DIALECTS.items()), ("csv", PLAIN)):
        what, _, kind = ending.partition(".")
        found[key] = case.file(f"{name}-{what}", kind)
    return found


def make_servo_tables(case: Case) -> None:
    """Write the tables of all cams; SpecError where the machine has none."""
    motions = list(table_motions(case.mechanism))
    if not motions:
        kind = case.mechanism.mechanism
        raise SpecError(
            [
                Fault(
                    ("only",),
                    "servo",
                    f"no servo tables: this {kind} has no cam that turns, and no drive with a program",
                )
            ]
        )
    for motion in motions:
        files = _files(case, motion)
        rows = _rows(motion)
        title = f"{case.mechanism.name}-{motion.name}"
        for key, dialect in DIALECTS.items():
            table = rows if dialect.rates else _even_points(motion, dialect.most)
            _write(files[key], dialect.text(title, table))
        _write(files["csv"], plain_text(rows))
    motors = _motors(case)
    if motors:
        names = [each.name for each in motors]
        _write(_program_file(case), _program(case, motors).text(names))


def _motors(case: Case) -> list[FollowerMotion]:
    """Those that one program turns; none where there are more than it has axes for."""
    motors = list(motors_together(case.mechanism))
    return motors if len(motors) <= len(AXES) else []


def _program_file(case: Case) -> Path:
    what, _, kind = ENDING.partition(".")
    return case.file(what, kind)


def _program(case: Case, motors: Sequence[FollowerMotion]) -> GrblProgram:
    """Rows at even angles of theta, as few as keep to the motions."""
    for rows in _ROWS:
        x = np.linspace(0, 360, rows + 1)
        turned = np.column_stack([each.law(x, 0) for each in motors])
        program = GrblProgram(x / 360 * _period(case), turned)
        if max(each.off(_lines(x, y)) for each, y in zip(motors, turned.T, strict=True)) <= _LINES:
            break
    return program


def _period(case: Case) -> float:
    """Minutes."""
    return math.tau / abs(case.mechanism.model.speed) / 60


def _lines(x: Floats, y: Floats) -> Callable[[Floats, int], Floats]:
    """Lines between places."""
    return lambda at, order: np.interp(at, x, y)


def _write(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8", newline="\n")


def servo_files(case: Case) -> list[Path]:
    """Tables that a build may have made and that are there."""
    endings = (*(f"*-{dialect.ending}" for dialect in DIALECTS.values()), f"*-{PLAIN}", ENDING)
    return [path for ending in endings for path in case.files(ending)]


def judge_servo_tables(case: Case) -> Outcome:
    """SERVO_TABLE of each file: the drive's curve through the rows that are read back, against the motion of the follower."""
    findings: list[Finding] = []
    rows: list[tuple[object, ...]] = []
    for motion in table_motions(case.mechanism):
        for path in _files(case, motion).values():
            finding, row = _judged(path, motion)
            findings.append(finding)
            rows.append(row)
    motors = _motors(case)
    if motors:
        path = _program_file(case)
        program = read_grbl(path, len(motors))
        x = 360 * program.minutes / _period(case)
        for motion, turned in zip(motors, program.turned.T, strict=True):
            off = motion.off(_lines(x, turned))
            findings.append(_of_program(path, motion, x, off))
            rows.append((f"{path.name}, {motion.name}", len(x), motion.unit, off, ""))
    columns = ("file", "rows", "unit", "off by", "acceleration off by, of its peak")
    return Outcome(findings, tables=[Table("Cam tables for servo drives", columns, rows)])


def _judged(path: Path, motion: FollowerMotion) -> tuple[Finding, tuple[object, ...]]:
    """Finding and row of the report on one file."""
    table = read_cam_table(path)
    curve = table.curve()
    of_acceleration = motion.off(curve, 2) / (motion.off(_still, 2) or 1.0)
    row = (path.name, len(table.master), motion.unit, motion.off(curve), of_acceleration)
    return table_finding(table, motion, path), row


def _of_program(path: Path, motion: FollowerMotion, x: Floats, off: float) -> Finding:
    """SERVO_TABLE of what a program turns a motor by; x: theta at its rows by the time that they take, deg; off: deg."""
    where = Where(file=path.name, kind=path.suffix[1:], output=motion.name)
    stroke = motion.stroke or 1.0
    limit = 100 * _MOST_LINES / stroke
    if abs(x[-1] - 360) > _SAME_TIME:
        message = f"takes the time of {x[-1]:.6g} deg of theta, not of 360"
        return at_most(CODE, math.nan, limit, "percent", where, message)
    message = f"off the motion by at most {off:.2g} deg of {stroke:.4g} deg, by lines between {len(x)} rows"
    return at_most(CODE, 100 * off / stroke, limit, "percent", where, message)


def _still(x: Floats, order: int) -> Floats:
    return np.zeros(np.shape(x))
