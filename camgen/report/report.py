"""Numbers to files: report.json (the truth), motion.csv (the curves) and report.html (for people).

Nothing here knows a mechanism: a Report holds findings, numbers, parts, tables and an Animation, all plain data. The
plots arrive as ready SVG text, so that this module runs without a plotting library. Same report, same bytes.
"""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from importlib.resources import files
from os import PathLike
from string import Template
from typing import Any
from urllib.parse import quote

import numpy as np
from numpy.typing import ArrayLike

from camgen import __version__
from camgen.errors import FileError
from camgen.findings import ROUTINE, Finding, NotJudged, left_out
from camgen.report.animation import Animation, frames, player
from camgen.study import Plot, Table

Path = str | PathLike[str]

# More findings than this, and the routine ones that hold are folded away.
_FOLDED_FROM = 40

# Units as suffixes of a number's name, the longest first.
_UNITS = {
    "n_rad_s": "N rad/s", "n_m_s": "N m s", "n_m": "N m", "g_mm": "g mm", "mpa_m_s": "MPa m/s", "mpa": "MPa", "w": "W",
    "hz": "Hz", "kg_m2": "kg m²", "n": "N", "j": "J", "h": "h",
    "deg_rad2": "deg/rad²", "mm_rad2": "mm/rad²", "deg_rad": "deg/rad", "mm_rad": "mm/rad",
    "mm_s2": "mm/s²", "mm_s": "mm/s", "deg_s2": "deg/s²", "deg_s": "deg/s", "rad_s": "rad/s",
    "mm3": "mm³", "mm2": "mm²", "mm": "mm", "deg": "deg", "rpm": "rpm", "percent": "%", "g": "g", "s": "s",
}  # fmt: skip


@dataclass(frozen=True)
class Report:
    """All that a build found out.

    parts: one mapping each with `name`, `count`, `material_mm3` and more; `files` in it lists the part's file names.
    budget: the error budget by stage; files: further files of the folder to which the page links; not_judged: codes that
    were left out; warnings: sentences that a person should read before the parts are made; remarks: what this run did
    beside the result, and folder: where it wrote, told but not written: the same spec gives the same files.
    """

    name: str
    mechanism: str
    findings: Sequence[Finding]
    numbers: Mapping[str, float] = field(default_factory=dict)
    parts: Sequence[Mapping[str, object]] = ()
    plots: Sequence[Plot] = ()
    tables: Sequence[Table] = ()
    notes: Sequence[str] = ()
    animation: Animation | None = None
    budget: Table | None = None
    files: Sequence[str] = ()
    not_judged: Sequence[NotJudged] = ()
    warnings: Sequence[str] = ()
    remarks: Sequence[str] = ()
    folder: Path | None = None

    @property
    def ok(self) -> bool:
        """Whether every finding holds."""
        return all(finding.ok for finding in self.findings)

    @property
    def all_tables(self) -> Sequence[Table]:
        """The tables, the error budget first."""
        return (*([self.budget] if self.budget else []), *self.tables)

    @property
    def verdict(self) -> str:
        """One line: how many checks hold or fail, and what was not judged."""
        failed, count = sum(not finding.ok for finding in self.findings), len(self.findings)
        held = {0: "Nothing is judged here", 1: "The one check holds"}.get(count, f"All {count} checks hold")
        said = f"{failed} of {count} checks fail{'s' if failed == 1 else ''}" if failed else held
        return f"{said}; NOT JUDGED: {left_out(self.not_judged)}" if self.not_judged else said

    def _repr_html_(self) -> str:
        """For a notebook: the verdict, the findings, what fails first, and the figures that are not of one kind of file."""
        kinds = ("_dxf_", "_stl_", "_3mf_")
        figures = {name: value for name, value in self.numbers.items() if not any(kind in name for kind in kinds)}
        found = f"<h3>{escape(self.name)}: {escape(self.verdict)}</h3>{_findings(self.findings, self.not_judged)}"
        return found + "".join(f"<p>{escape(text)}</p>" for text in self.warnings) + _numbers(figures)

    def as_dict(self) -> dict[str, object]:
        """The report as report.json holds it: plain values, floats of 12 digits, None for nan and inf."""
        tables = [{"title": t.title, "columns": t.columns, "rows": t.rows} for t in self.all_tables]
        plain: dict[str, object] = _plain(
            {
                "camgen": __version__,
                "name": self.name,
                "mechanism": self.mechanism,
                "ok": self.ok,
                "findings": [finding.as_dict() for finding in self.findings],
                "not_judged": [each.as_dict() for each in self.not_judged],
                "numbers": self.numbers,
                "parts": self.parts,
                "tables": tables,
                "notes": self.notes,
                "warnings": self.warnings,
                **({"remarks": self.remarks} if self.remarks else {}),
            }
        )
        return plain


def to_json(report: Report) -> str:
    """report.json as text: strict JSON, floats of 12 digits as in motion.csv, null for nan and inf."""
    return json.dumps(report.as_dict(), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def to_html(report: Report, figures: Sequence[str] = ()) -> str:
    """report.html as text, self-contained; `figures` are the plots of the report as SVG, in their order."""
    turn = frames(report.animation) if report.animation else {}
    page = Template(files("camgen.report").joinpath("page.html").read_text(encoding="utf-8"))
    return page.substitute(
        name=escape(report.name),
        mechanism=escape(report.mechanism),
        version=escape(__version__),
        verdict=escape(report.verdict),
        state="ok" if report.ok and not report.not_judged else "bad",
        findings="".join(f"<p><b>{escape(text)}</b></p>" for text in report.warnings)
        + _findings(report.findings, report.not_judged),
        animation=player(report.animation) if report.animation else "",
        numbers=_section("Numbers", _numbers(report.numbers)),
        plots=_section("Curves", _plots(report.plots, figures)),
        tables=_section("Tables", "".join(_table(t.title, t.columns, t.rows) for t in report.all_tables)),
        parts=_section("Parts", _parts(report.parts)),
        notes=_section("Notes", "".join(f"<p>{escape(note)}</p>" for note in report.notes)),
        files=", ".join(_link(name) for name in report.files),
        # Names stay out of the data, so no text of a user's can end the script element.
        frames=json.dumps(turn, separators=(",", ":"), allow_nan=False),
    )


def write_json(path: Path, report: Report) -> None:
    """Write report.json; FileError where it cannot be written."""
    _write(path, to_json(report))


def write_csv(path: Path, columns: Mapping[str, ArrayLike]) -> None:
    """Write columns, all (n,), under their names: 12 digits, nan as `nan`; FileError where it cannot be written."""
    header = io.StringIO()
    csv.writer(header, lineterminator="\n").writerow(columns)
    # Adding 0 turns -0 into 0; one format of all lines at once is several times faster than one line at a time.
    cells = np.column_stack([np.asarray(column, float) for column in columns.values()]) + 0.0
    line = ",".join(["%.12g"] * cells.shape[1]) + "\n"
    _write(path, header.getvalue() + (line * len(cells)) % tuple(cells.ravel().tolist()))


def write_html(path: Path, report: Report, figures: Sequence[str] = ()) -> None:
    """Write report.html with the plots' SVG texts; FileError where it cannot be written."""
    _write(path, to_html(report, figures))


def _write(path: Path, text: str) -> None:
    try:
        with open(path, "w", encoding="utf-8", newline="\n") as file:
            file.write(text)
    except OSError as fault:
        raise FileError(path, fault.strerror or str(fault)) from fault


def _plain(value: object) -> Any:
    """The same as dicts, lists, text, numbers of 12 digits and None; nan and inf become None."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, np.generic | np.ndarray):
        return _plain(value.tolist())
    if isinstance(value, float):
        return float(f"{value:.12g}") if math.isfinite(value) else None
    if value is None or isinstance(value, str | int):
        return value
    if isinstance(value, Sequence):
        return [_plain(item) for item in value]
    raise TypeError(f"{type(value).__name__} has no place in report.json")


# Text for people


def _text(value: object) -> str:
    """A cell: numbers with six digits and a true minus, anything else escaped."""
    if isinstance(value, bool | np.bool_):
        return "yes" if value else "no"
    if isinstance(value, int | np.integer):
        return str(value).replace("-", "−")
    if isinstance(value, float | np.floating):
        return "–" if math.isnan(value) else f"{value + 0.0:.6g}".replace("-", "−").replace("inf", "∞")
    return escape("" if value is None else str(value))


def _link(name: str) -> str:
    return f'<a href="{escape(quote(name))}">{escape(name)}</a>'


def _section(title: str, body: str) -> str:
    return f'<section class="{title.lower()}"><h2>{title}</h2>{body}</section>' if body else ""


def _used(finding: Finding) -> float | None:
    """Share of its limit that a finding uses, above 1 where it fails; None where a share has no meaning."""
    measured, limit = finding.measured, finding.limit
    if not (math.isfinite(measured) and math.isfinite(limit)) or measured == limit:
        return None
    part, whole = (limit, measured) if finding.floor else (measured, limit)
    return part / whole if part >= 0 and whole > 0 else None


def _findings(findings: Sequence[Finding], not_judged: Sequence[NotJudged]) -> str:
    """What fails first, then what was not judged; of many parts the routine checks that hold are folded away."""
    routine = [finding for finding in findings if finding.ok and finding.code in ROUTINE]
    if len(findings) <= _FOLDED_FROM:
        return _findings_table(findings, not_judged)
    shown = _findings_table([finding for finding in findings if finding not in routine], not_judged)
    summary = f"<summary>{len(routine)} routine checks of files and solids hold</summary>"
    return f"{shown}<details>{summary}{_findings_table(routine)}</details>"


def _findings_table(findings: Sequence[Finding], not_judged: Sequence[NotJudged] = ()) -> str:
    open_rows = [
        f'<tr class="bad"><td class="mark"><b>NOT JUDGED</b></td><th scope="row"><code>{escape(each.code)}</code>'
        f"<p>{escape(each.why)}</p></th><td></td><td></td><td></td></tr>"
        for each in not_judged
    ]
    rows: list[str] = []
    for finding in sorted(findings, key=lambda finding: finding.ok):
        if finding.ok:
            rows, open_rows = [*rows, *open_rows], []
        used, state = _used(finding), "ok" if finding.ok else "bad"
        bar = "<td></td>"
        if used is not None:
            percent = f"{100 * used:.0f} %" if used < 10 else "> 1000 %"
            # Eight tenths of the bar are the limit, so that a failing bar is seen to pass the mark.
            width = f"{80 * min(used, 1.25):.1f}"
            bar = f'<td class="use"><span class="bar"><i style="width:{width}%"></i></span> {percent}</td>'
        unit = f" <small>{escape(_UNITS.get(finding.unit, finding.unit))}</small>" if finding.unit else ""
        rows.append(
            f'<tr class="{state}"><td class="mark"><b>{"holds" if finding.ok else "FAILS"}</b></td>'
            f'<th scope="row"><code>{escape(finding.code)}</code> <small>{escape(finding.where)}</small>'
            f"<p>{escape(finding.message)}</p></th>"
            f'<td class="n">{_text(finding.measured)}{unit}</td>'
            f'<td class="n">{"≥ " if finding.floor else ""}{_text(finding.limit)}{unit}</td>{bar}</tr>'
        )
    head = "".join(f'<th scope="col">{name}</th>' for name in ("Verdict", "Check", "Measured", "Limit", "Of the limit"))
    return f"<table><thead><tr>{head}</tr></thead><tbody>{''.join([*rows, *open_rows])}</tbody></table>"


def _table(title: str, columns: Sequence[str], rows: Sequence[Sequence[object]], ready: bool = False) -> str:
    """A table with a caption; `ready`: text cells are markup already."""

    def line(row: Sequence[object]) -> str:
        cells = [cell if ready and isinstance(cell, str) else _text(cell) for cell in row]
        rest = "".join(f"<td{kind(cell)}>{text}</td>" for cell, text in zip(row[1:], cells[1:], strict=True))
        return f'<tr><th scope="row">{cells[0]}</th>{rest}</tr>'

    def kind(cell: object) -> str:
        return ' class="n"' if isinstance(cell, int | float | np.number) else ""

    models = rows[0] if rows else columns
    head = "".join(f'<th scope="col"{kind(m)}>{escape(name)}</th>' for name, m in zip(columns, models, strict=True))
    head = f"<caption>{escape(title)}</caption><thead><tr>{head}</tr></thead>"
    return f'<div class="scroll"><table>{head}<tbody>{"".join(map(line, rows))}</tbody></table></div>'


def _named(key: str) -> tuple[str, str]:
    """Words and unit of a number's name such as peak_speed_mm_s."""
    unit = next((suffix for suffix in _UNITS if key.endswith("_" + suffix)), "")
    return key.removesuffix("_" + unit).replace("_", " "), _UNITS.get(unit, "")


def _numbers(numbers: Mapping[str, float]) -> str:
    items = []
    for key, value in numbers.items():
        label, unit = _named(key)
        items.append(f"<div><dt>{escape(label)}</dt><dd>{_text(value)} <small>{escape(unit)}</small></dd></div>")
    return f"<dl>{''.join(items)}</dl>" if items else ""


def _parts(parts: Sequence[Mapping[str, object]]) -> str:
    keys = [key for key in dict.fromkeys(key for part in parts for key in part) if key != "files"]
    if not parts:
        return ""
    columns = [f"{words} ({unit})" if unit else words for words, unit in map(_named, keys)]
    rows = []
    for part in parts:
        names = part.get("files", ())
        assert isinstance(names, Sequence)
        cells = [escape(value) if isinstance(value, str) else value for value in map(part.get, keys)]
        rows.append([*cells, " ".join(_link(str(name)) for name in names)])
    return _table("Made from this spec", [*columns, "files"], rows, ready=True)


def _plots(plots: Sequence[Plot], figures: Sequence[str]) -> str:
    return "".join(
        f'<figure class="plot">{figure}<figcaption>{escape(plot.title)}</figcaption></figure>'
        for plot, figure in zip(plots, figures, strict=True)
    )
