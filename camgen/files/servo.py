"""Cam tables of servo drives: the motion of a follower for a motor that makes it without a cam.

    master   angle of the cam that is left out, deg, in the sense in which it turns
    slave    the follower, mm or deg; velocity and acceleration are its derivatives to the master's degrees
    rows     of a table; where they have velocity and acceleration a drive lays quintics between them, else cubic splines

Texts are written as the makers document them: CODESYS SoftMotion `SMC_CAMXYVA`, Beckhoff TwinCAT 3 (TF5550) `MotionFunctionPoint`,
Siemens S7-1500T `TO_Cam_Struct_PointData`. They are read back here by the same names; no drive has been asked.
"""

from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from camgen.bounds import Bound, read_bytes
from camgen.errors import FileError
from camgen.geometry.outlines import Floats

_SIZE = Bound("a cam table", 10_000_000, most=200_000)
_DECIMALS = 12
_TURN = 360.0  # deg
_LEAST_ROWS = 3
_MOST = 1e6  # of any number in a row, in its unit
_SAME_MASTER = 10.0**-_DECIMALS / 2  # deg: nearer ones are written alike
_COMMENTS = re.compile(r"\(\*.*?\*\)|//[^\n]*", re.DOTALL)
_CSV = ("master_deg", "slave_{unit}", "velocity_{unit}_per_deg", "acceleration_{unit}_per_deg2")


@dataclass(frozen=True)
class CamTable:
    """Rows of a table, each (n,): master, deg, growing; slave; velocity and acceleration per deg, None where it has none.

    unit: of the slave, "mm" or "deg"; "" where a file does not say it.
    """

    unit: str
    master: Floats
    slave: Floats
    velocity: Floats | None = None
    acceleration: Floats | None = None

    @property
    def closed(self) -> bool:
        """Whether it covers one turn."""
        return abs(float(np.ptp(self.master)) - _TURN) < 1e-6

    def curve(self) -> Callable[[Floats, int], Floats]:
        """What a drive makes of it: (master, deg, and order) -> the slave or a derivative per deg, (n,)."""
        if self.velocity is not None and self.acceleration is not None:
            return _quintics(self.master, self.slave, self.velocity, self.acceleration)
        from scipy.interpolate import CubicSpline

        slave = self.slave.copy()
        repeats = self.closed and abs(slave[-1] - slave[0]) <= 10.0**-_DECIMALS
        if repeats:
            slave[-1] = slave[0]
        spline = CubicSpline(self.master, slave, bc_type="periodic" if repeats else "not-a-knot")
        return lambda x, order: np.asarray(spline(np.asarray(x, float), order))


def _quintics(x: Floats, y: Floats, v: Floats, a: Floats) -> Callable[[Floats, int], Floats]:
    """The curve of a quintic between each two rows."""
    h = np.diff(x)
    v0 = v[:-1] * h
    v1 = v[1:] * h
    a0 = a[:-1] * h**2
    a1 = a[1:] * h**2
    step = np.diff(y)
    third = 10 * step - 6 * v0 - 4 * v1 - 1.5 * a0 + 0.5 * a1
    fourth = -15 * step + 8 * v0 + 7 * v1 + 1.5 * a0 - a1
    fifth = 6 * step - 3 * v0 - 3 * v1 - 0.5 * a0 + 0.5 * a1
    factors = np.array([y[:-1], v0, a0 / 2, third, fourth, fifth])

    def curve(at: Floats, order: int) -> Floats:
        at = np.asarray(at, float)
        k = np.clip(np.searchsorted(x, at, side="right") - 1, 0, len(h) - 1)
        u = (at - x[k]) / h[k]
        value = np.zeros(at.shape)
        for power in range(5, order - 1, -1):
            value = value * u + math.perm(power, order) * factors[power, k]
        return value / h[k] ** order

    return curve


# ---- texts -----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Dialect:
    """How a maker's text has a table.

    ending: of the file behind the part's name; point: type of a row, by which a text is known; fields: names of master, slave and,
    where rows have them, velocity and acceleration; most: rows of one table; lines: (name, rows as text) -> the text.
    """

    ending: str
    maker: str
    point: str
    fields: tuple[str, ...]
    most: int
    lines: Callable[[str, Sequence[str]], Sequence[str]]

    @property
    def rates(self) -> bool:
        """Whether rows have velocity and acceleration."""
        return len(self.fields) > 2

    def text(self, name: str, table: CamTable) -> str:
        """The whole text; name: of the table, which it makes an identifier."""
        columns = [table.master, table.slave]
        if self.rates:
            assert table.velocity is not None and table.acceleration is not None
            columns += [table.velocity, table.acceleration]
        rows = [
            ", ".join(f"{field} := {_number(x)}" for field, x in zip(self.fields, row, strict=True))
            for row in zip(*(column.tolist() for column in columns), strict=True)
        ]
        rates = (
            f"; velocity in {table.unit} per deg, acceleration in {table.unit} per deg^2"
            if self.rates
            else "; cubic splines between the points"
        )
        head = f"(* {self.maker}: master in deg, slave in {table.unit}{rates} *)"
        return "\n".join([head, *self.lines(_identifier(name), rows)]) + "\n"


def _number(value: float) -> str:
    """A literal LREAL: with a decimal point, without an exponent."""
    text = f"{value:z.{_DECIMALS}f}".rstrip("0")
    return text + "0" if text.endswith(".") else text


def _identifier(name: str) -> str:
    """A name as IEC 61131-3 lets one be."""
    plain = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_")
    return plain if plain[:1].isalpha() else f"cam_{plain}"


def _codesys(name: str, rows: Sequence[str]) -> Sequence[str]:
    last = len(rows) - 1
    ends = [re.match(r"dX := ([^,]+)", rows[k]) for k in (0, -1)]
    start, end = (match[1] if match else "" for match in ends)
    return [
        "VAR_GLOBAL",
        f"    {name}_A : ARRAY[0..{last}] OF SMC_CAMXYVA := [",
        *_list(rows),
        f"    {name} : MC_CAM_REF := (nElements := {len(rows)}, byType := 3, xStart := {start}, xEnd := {end}, nTappets := 0, "
        f"strCAMName := '{name}', pce := ADR({name}_A), xPartofLM := TRUE);",
        "END_VAR",
    ]


def _twincat(name: str, rows: Sequence[str]) -> Sequence[str]:
    kinds = ["Polynomial5"] * (len(rows) - 1) + ["Linear"]
    typed = [
        f"FunctionType := EMotionFunctionType.{kind}, {row}"
        for kind, row in zip(kinds, rows, strict=True)
    ]
    return [
        "VAR_GLOBAL",
        f"    {name} : ARRAY[1..{len(rows)}] OF MotionFunctionPoint := [",
        *_list(typed),
        "END_VAR",
    ]


def _s7(name: str, rows: Sequence[str]) -> Sequence[str]:
    return [
        "VAR",
        f"    {name} : ARRAY[1..{len(rows)}] OF TO_Cam_Struct_PointData := [",
        *_list(rows),
        "END_VAR",
    ]


def _list(rows: Sequence[str]) -> list[str]:
    """The rows of an array, and its end."""
    ends = [","] * (len(rows) - 1) + ["];"]
    return [f"        ({row}){end}" for row, end in zip(rows, ends, strict=True)]


DIALECTS: Mapping[str, Dialect] = {
    "codesys": Dialect(
        "codesys.st",
        "CODESYS SoftMotion",
        "SMC_CAMXYVA",
        ("dX", "dY", "dV", "dA"),
        100_000,
        _codesys,
    ),
    "twincat": Dialect(
        "twincat.st",
        "Beckhoff TwinCAT 3, TF5550",
        "MotionFunctionPoint",
        ("MasterPosition", "SlavePosition", "SlaveVelocity", "SlaveAcceleration"),
        100_000,
        _twincat,
    ),
    "s7": Dialect(
        "s7.st",
        "Siemens S7-1500T, TO_Cam",
        "TO_Cam_Struct_PointData",
        ("x", "y"),
        1000,
        _s7,
    ),
}
PLAIN = "servo.csv"  # ending of the table for any other drive


def plain_text(table: CamTable) -> str:
    """The table as CSV: master, slave, velocity, acceleration, each column with its unit."""
    assert table.velocity is not None and table.acceleration is not None
    head = ",".join(_CSV).format(unit=table.unit)
    columns = (table.master, table.slave, table.velocity, table.acceleration)
    rows = zip(*(column.tolist() for column in columns), strict=True)
    return "\n".join([head, *(",".join(map(_number, row)) for row in rows)]) + "\n"


# ---- reading ---------------------------------------------------------------------------------------------------------


def read_cam_table(path: Path) -> CamTable:
    """A table in one of the texts, or a CSV: its first two columns are master, deg, and slave; FileError with what is wrong.

    Of a CSV velocity and acceleration count where its heading is the one that is written here.
    """
    try:
        text = read_bytes(path, _SIZE).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise FileError(path, "is not text: a cam table was expected") from None
    plain = _COMMENTS.sub(" ", text)
    dialect = next((each for each in DIALECTS.values() if each.point in plain), None)
    unit, columns = _csv(path, text) if dialect is None else ("", _points(path, plain, dialect))
    master = columns[0]
    if len(master) < _LEAST_ROWS:
        raise FileError(path, f"has {len(master)} rows, a cam table has {_LEAST_ROWS} at least")
    for column in columns:
        absurd = np.flatnonzero(~(np.abs(column) <= _MOST))
        if absurd.size:
            k = int(absurd[0])
            raise FileError(
                path, f"row {k + 1} has {column[k]:g}; numbers up to {_MOST:g} are read"
            )
    wrong = np.flatnonzero(~(np.diff(master) > _SAME_MASTER))
    if wrong.size:
        k = int(wrong[0])
        raise FileError(
            path,
            f"row {k + 2} has master {master[k + 1]:g}, not greater than {master[k]:g} before it",
        )
    return CamTable(unit, *columns)


def _points(path: Path, text: str, dialect: Dialect) -> list[Floats]:
    """Columns of the array of points in a text."""
    number = r"([-+]?\d[\d_]*\.?\d*(?:[eE][-+]?\d+)?)"
    array = text[text.index(dialect.point) :]
    array = array[: array.find("]", array.find("["))]
    rows = []
    for k, match in enumerate(re.finditer(r"\(([^()]*)\)", array), 1):
        fields = dict(re.findall(rf"(\w+)\s*:=\s*{number}\s*(?:,|$)", match[1].strip()))
        missing = [name for name in dialect.fields if name not in fields]
        if missing:
            raise FileError(path, f"point {k} has no number {', '.join(missing)}")
        rows.append([float(fields[name]) for name in dialect.fields])
    return list(np.array(rows).reshape(-1, len(dialect.fields)).T)


def _csv(path: Path, text: str) -> tuple[str, list[Floats]]:
    """Unit and columns of a table with a heading, or without one."""
    lines = [line for line in text.splitlines() if line.strip() and not line.startswith("#")]
    semicolons = any(";" in line for line in lines[:2])
    if semicolons:
        lines = [line.replace(",", ".") for line in lines]
    rows = list(csv.reader(io.StringIO("\n".join(lines)), delimiter=";" if semicolons else ","))
    unit = ""
    width = 2
    if rows and not _is_number(rows[0][0]):
        head = [cell.strip() for cell in rows.pop(0)]
        units = [name for name in ("mm", "deg") if head == [c.format(unit=name) for c in _CSV]]
        unit = units[0] if units else ""
        width = len(_CSV) if units else 2
    for k, row in enumerate(rows, 1):
        if len(row) < width or not all(map(_is_number, row[:width])):
            raise FileError(
                path, f"row {k} has no {width} numbers: a cam table has master, deg, and slave"
            )
    return unit, list(
        np.array([[float(c) for c in row[:width]] for row in rows]).reshape(-1, width).T
    )


def _is_number(cell: str) -> bool:
    try:
        return math.isfinite(float(cell))
    except ValueError:
        return False
