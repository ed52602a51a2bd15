"""Tables beside a spec: laws' rows of angle and displacement, loads' rows of theta and force, in the units of their headings."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from camgen.bounds import Bound, read_bytes
from camgen.errors import Fault, FileError, SpecError

_MOST_LINES = 200_000  # of a table; the longest that a spec takes has 100,000 rows
_ANGLES = {
    "deg": 1.0,
    "degree": 1.0,
    "degrees": 1.0,
    "\u00b0": 1.0,
    "rad": math.degrees(1),
    "turn": 360.0,
    "turns": 360.0,
}
_FORCES = {"n": 1.0, "kn": 1e3, "kgf": 9.80665, "lbf": 4.4482216152605}
_TORQUES = {"nm": 1.0, "ncm": 1e-2, "nmm": 1e-3, "knm": 1e3, "lbfin": 0.1129848290276167}
_OTHERS = ("mm", "cm", "inch", "kg", "kpa", "mpa", "bar", "rpm", "hz")
_PARTS = 3  # of a unit's name: lbf in, N / mm


def read_points(path: Path) -> tuple[tuple[float, float], ...]:
    """Two numbers a row from the first two columns of a text file, see `read_table`."""
    return read_table(path)[1]


def read_table(
    path: Path, columns: str = "angle and displacement"
) -> tuple[Sequence[str], tuple[tuple[float, float], ...]]:
    """Heading of the first two columns, as far as there is one, and their rows; rows before the first number are headings.

    Columns part at commas, semicolons, tabs or spaces; with semicolons or tabs a comma in a number is its decimal point.
    Lines that start with # are left out. FileError where it cannot be read; SpecError with the lines that are no numbers.
    columns: what messages call them.
    """
    try:
        text = read_bytes(
            path, Bound(f"a table of {columns}", 10_000_000, most=_MOST_LINES)
        ).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise FileError(path, f"is not text: a table of {columns} was expected") from None
    points: list[tuple[float, float]] = []
    heading: Sequence[str] = ()
    faults = []
    lines = text.splitlines()
    if len(lines) > _MOST_LINES:  # that end otherwise than those that were counted
        raise FileError(
            path,
            f"has {len(lines):,} lines; at most {_MOST_LINES:,} are read of a table of {columns}",
        )
    for number, line in enumerate(lines, start=1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        wide = re.split(r"[;\t]", line)
        if len(wide) > 1:
            cells = [cell.replace(",", ".") for cell in wide]
        else:
            cells = re.split(r"\s*,\s*|\s+", line.strip())
        try:
            x = float(cells[0])
            y = float(cells[1])
            if not math.isfinite(x + y):
                raise ValueError
            points.append((x, y))
        except (ValueError, IndexError):
            if points:
                faults.append(
                    Fault(
                        (),
                        line.strip()[:60],
                        f"two numbers: {columns}",
                        source=f"{path.name} line {number}",
                    )
                )
            else:
                heading = (
                    wide if len(wide) > 1 else line.split(",") if "," in line else line.split()
                )
    if faults or not points:
        nothing = Fault(
            (), f"{len(text)} characters", f"rows of two numbers: {columns}", source=path.name
        )
        raise SpecError(faults or [nothing], str(path))
    return heading[:2], tuple(points)


def unit_in(cell: str, units: Mapping[str, Any]) -> str:
    """The unit that ends a column's heading: "force (N)", "theta_deg"; in plain letters, "" where there is none of those known
    and no other short word in brackets."""
    words = [word for word in re.split(r"[^a-z\u00b0]+", cell.lower()) if word]
    for count in range(min(_PARTS, len(words)), 0, -1):
        if (name := "".join(words[-count:])) in units:
            return name
    bracket = re.search(r"[\[(]([^])]{1,6})[])]\s*$", cell)
    return bracket[1].strip() if bracket else ""


def load_table(path: Path) -> tuple[list[list[float]], str | None]:
    """Rows of theta, deg, and force, N, or torque, N m, and which of both, None where no heading says it.

    SpecError for other units.
    """
    heading, points = read_table(path, "theta and force or torque")
    every = dict.fromkeys(_OTHERS) | _ANGLES | _FORCES | _TORQUES
    names = [unit_in(cell, every) for cell in heading] if len(heading) == 2 else ["", ""]
    faults = []
    scales = [1.0, 1.0]
    columns = (
        (_ANGLES, "deg, rad or turns"),
        (_FORCES | _TORQUES, "a force in N, kN, kgf, lbf; a torque in N m, N mm, lbf in"),
    )
    for k, (name, (right, shape)) in enumerate(zip(names, columns, strict=True)):
        if name and name not in right:
            faults.append(
                Fault(
                    (),
                    repr(heading[k].strip()),
                    shape,
                    source=f"{path.name}, heading of column {k + 1}",
                )
            )
        scales[k] = right.get(name, 1.0)
    if faults:
        raise SpecError(faults, str(path))
    kind = "N" if names[1] in _FORCES else "N m" if names[1] in _TORQUES else None
    return [[x * scales[0], y * scales[1]] for x, y in points], kind
