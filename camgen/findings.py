"""Findings: what was checked, as data; passing ones are listed too, with their margin."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from pathlib import PurePath


@dataclass(frozen=True)
class Where:
    """Where a finding was made; `str` of it is what a person reads: file, thing and angle, with commas between."""

    thing: str = ""  # in words, where the names below say too little by themselves
    file: str = ""  # by its name, with a star for all parts; "" where no file is judged
    kind: str = ""  # of the file, such as "dxf"
    part: str = ""  # or copy of one, or body; "" where the file alone says which
    other: str = ""  # part of a pair
    joint: str = ""
    output: str = ""
    theta: float | None = None  # rad
    angle: str = "cam angle"  # what theta is called
    digits: int | None = 3  # decimals of the angle, deg; None: as many as it has
    unit: str = "deg"  # what a degree of theta stands for, "mm" of a way
    module: str = ""  # name of an included machine

    def __str__(self) -> str:
        thing = self.thing or self.part or self.joint or self.output
        text = ", ".join(filter(None, (self.file, thing, self.angle_text)))
        return f"{self.module}: {text}" if self.module else text

    @property
    def angle_text(self) -> str:
        """Its angle in words, "" without one."""
        if self.theta is None:
            return ""
        degrees = math.degrees(self.theta)
        number = f"{degrees:g}" if self.digits is None else f"{degrees:.{self.digits}f}"
        return f"{self.angle} {number} {self.unit}".lstrip()


def in_file(path: PurePath) -> Where:
    """A file, by its name and kind."""
    return Where(file=path.name, kind=path.suffix[1:].lower())


@dataclass(frozen=True)
class Finding:
    """One check: stable code, verdict, measured value against its limit, unit, where (file or part), a sentence.

    floor: whether the limit is the least that is asked, not the most that is borne; strict: whether the limit itself is
    too little then. Neither is written to report.json.
    """

    code: str
    ok: bool
    measured: float
    limit: float
    unit: str
    where: Where
    message: str
    floor: bool = False
    strict: bool = False

    def __str__(self) -> str:
        """As a person reads it, on one line."""
        verdict = "holds" if self.ok else "fails"
        measured, _ = as_read(self.measured, self.unit)
        limit, unit = as_read(self.limit, self.unit)
        compared = f"{measured:.4g} {self.sign} {limit:.4g} {unit}".rstrip()
        if not self.ok:
            compared = f"not {compared}"
        return f"{self.code} {verdict}: {compared}; {self.where}; {self.message}".rstrip("; ")

    @property
    def sign(self) -> str:
        """How what is measured has to compare with the limit: "<=", ">=" or ">"."""
        return (">" if self.strict else ">=") if self.floor else "<="

    def within(self, tolerance: float) -> Finding:
        """The finding where a least value may be missed by so much; its limit is told as it was written."""
        return replace(self, ok=bool(self.measured >= self.limit - tolerance))

    def as_dict(self) -> dict[str, object]:
        """The finding as report.json lists it."""
        return {
            each.name: str(self.where) if each.name == "where" else getattr(self, each.name)
            for each in fields(self)
            if each.name not in ("floor", "strict")
        }


def as_read(value: float, unit: str) -> tuple[float, str]:
    """A value and its unit as people read them: a share in percent, and 1 file, not 1 files."""
    if unit == "share":
        return 100 * value, "%"
    return value, _ONE.get(unit, unit) if value == 1 else unit


# Units that are counts, of one.
_ONE = {
    "contours": "contour",
    "copies": "copy",
    "crossings": "crossing",
    "faults": "fault",
    "files": "file",
    "jumps": "jump",
    "rows": "row",
    "sheets": "sheet",
}


@dataclass(frozen=True)
class NotJudged:
    """A code that was left out: why, as a sentence; needs: what would let it be judged, in a few words; absent: whether that is
    kinds of files which are not there."""

    code: str
    why: str
    needs: str
    absent: bool = False

    def as_dict(self) -> dict[str, object]:
        """The same as report.json lists it."""
        return {"code": self.code, "why": self.why}


def left_out(not_judged: Sequence[NotJudged]) -> str:
    """One line: the codes that were not judged, each once, by what they need; empty where all were."""
    needs = dict.fromkeys(each.needs for each in not_judged)
    groups = [
        (", ".join(dict.fromkeys(each.code for each in not_judged if each.needs == need)), need)
        for need in needs
    ]
    return "; ".join(
        f"{codes} ({'need' if ',' in codes else 'needs'} {need})" for codes, need in groups
    )


_ALIKE = 0.1  # limits of one check, as a share


def _excess(finding: Finding) -> float:
    """How far a finding is beyond its limit."""
    beyond = finding.measured - finding.limit
    return -beyond if finding.floor else beyond


def checks(findings: Sequence[Finding]) -> list[list[Finding]]:
    """Findings by checks, which several files or parts may go through.

    One check: of one code and unit, on one output of one machine, with limits that are alike, such as those of a motion
    error in several files. Two at the very same place are two checks.
    """
    groups: dict[tuple[object, ...], list[Finding]] = {}
    limits: dict[tuple[object, ...], list[float]] = {}
    count = Counter[tuple[object, ...]]()
    for finding in findings:
        where = finding.where
        kind = (finding.code, finding.sign, finding.unit, where.module, where.output)
        known = limits.setdefault(kind, [])
        alike = (each for each in known if math.isclose(each, finding.limit, rel_tol=_ALIKE))
        limit = next(alike, finding.limit)
        if limit not in known:
            known.append(limit)
        check = kind if finding.code in ROUTINE else (*kind, limit)
        place = (*check, replace(where, theta=None))
        groups.setdefault((*check, count[place]), []).append(finding)
        count[place] += 1
    return list(groups.values())


_SAME_FAULT = 0.05  # share by which a file's figure may differ from that of the design


def worst_of_each(findings: Sequence[Finding]) -> list[tuple[Finding, str]]:
    """Of findings of one check the worst, with how many there are and where they were made, such as several files or parts.

    What the files show as the design has it already is told with the design.
    """
    groups = checks(findings)
    worst = [max(group, key=_excess) for group in groups]
    rows = []
    for group, finding in zip(groups, worst, strict=True):
        if any(_shows(other, finding) for other in groups):
            continue
        places = "; ".join(filter(None, dict.fromkeys(str(each.where) for each in group)))
        said = f"worst of {len(group)}: {places}" if len(group) > 1 else places
        also = [other for other in worst if _shows(group, other)]
        rows.append((finding, f"{said}; the files show it too" if also else said))
    return rows


def _shows(design: Sequence[Finding], worst: Finding) -> bool:
    """Whether the worst of a file is what a single finding of the design says already."""
    (first, *more) = design
    return (
        not (more or first.where.file)
        and bool(worst.where.file)
        and (first.code, first.unit, first.where.module, first.where.output)
        == (worst.code, worst.unit, worst.where.module, worst.where.output)
        and math.isclose(first.measured, worst.measured, rel_tol=_SAME_FAULT)
    )


# Codes that every part's every file is checked for: many lines of one kind, of which the tightest tells enough.
ROUTINE = frozenset(
    {
        "DXF_UNITS",
        "DXF_CLOSED",
        "WATERTIGHT",
        "VOLUME",
        "ROUND_TRIP",
        "MIN_WALL",
        "BED_FIT",
        "COPIES",
        "SHEET_FIT",
        "KERF",
    }
)


def at_most(
    code: str, measured: float, limit: float, unit: str, where: Where, message: str
) -> Finding:
    """A finding that holds when measured <= limit; nan never holds."""
    return Finding(
        code, bool(measured <= limit), float(measured), float(limit), unit, where, message
    )


def at_least(
    code: str, measured: float, limit: float, unit: str, where: Where, message: str
) -> Finding:
    """A finding that holds when measured >= limit; nan never holds."""
    return Finding(
        code, bool(measured >= limit), float(measured), float(limit), unit, where, message, True
    )
