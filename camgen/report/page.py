"""report.html: one file for people, that needs nothing else: verdict, machine, curves, margins, figures, tables.

The page is page.html, page.css and page.js of this folder, filled in; where there are solids, viewer.js on three.js shows them.
"""

from __future__ import annotations

import base64
import gzip
import json
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from html import escape
from importlib.resources import files
from string import Template
from typing import TYPE_CHECKING
from urllib.parse import quote

import numpy as np

from camgen._version import __version__
from camgen.findings import Finding, NotJudged, told_once
from camgen.plotting import SERIES
from camgen.report.animation import frames, player
from camgen.report.colours import part_colour
from camgen.report.figures import figure
from camgen.report.words import GROUPS, KINDS, NOISE, UNITS, Figure, figures, name, rounded

if TYPE_CHECKING:
    from camgen.report.report import Report
    from camgen.study import Plot, Scene, Table

_FIRST_PLOTS = 12  # more curves than this are folded away; it fills rows of two, three and four
_SERIES_DARK = ("#6db3f2", "#f2a069", "#74cf98", "#c99be8", "#dcc04e", "#f08fbf")
_NOISE = {
    "mm": 1e-6,
    "deg": 1e-6,
    "N": NOISE,
    "N m": NOISE,
    "W": NOISE,
}  # what is less is rounding: 1 nm, a millionth of a deg
_NEAR = 0.8  # share of its limit from which on a margin is shown unfolded


@cache
def _asset(file: str) -> str:
    return files("camgen.report").joinpath(file).read_text(encoding="utf-8")


def to_html(report: Report) -> str:
    """report.html as text, self-contained."""
    turn = frames(report.animation) if report.animation else {}
    scene = report.scene
    machine = player(report.animation, scene is not None) if report.animation else ""
    return Template(_asset("page.html")).substitute(
        name=escape(report.name),
        mechanism=escape(report.mechanism),
        version=escape(__version__),
        verdict=escape(report.verdict),
        state="bad"
        if not report.ok
        else "open"
        if report.not_judged
        else "ok"
        if report.findings
        else "",
        style=_asset("page.css")
        + _palette(len(report.animation.bodies) if report.animation else 0),
        key=_key_figures(report),
        change=to_change(report),
        machine=machine,
        plots=_section("Curves", _plots(report.plots)),
        parts=_section("Parts", _parts(report))
        + _section("Plates, ready to print", _plates(scene), "plates")
        + _section(scene.work if scene else "", _steps(scene), "steps"),
        findings=_section("Margins", margins(report.findings)),
        numbers=_section("Figures", figure_lists(report.numbers)),
        tables=_section("Tables", "".join(map(_folded, report.all_tables))),
        notes=_section("Notes", "".join(f"<p>{escape(note)}</p>" for note in report.notes)),
        files=", ".join(_link(file) for file in report.files if not file.endswith("-drawing.pdf")),
        # Names stay out of the data, so no text of a user's can end the script element.
        frames=json.dumps(turn, separators=(",", ":"), allow_nan=False),
        script=_asset("page.js"),
        viewer=_viewer(report, scene) if scene is not None else "",
    )


def _palette(count: int) -> str:
    """Colours of curves and parts as variables of the page, light and dark."""
    light = "".join(f"--s{k}:{colour};" for k, colour in enumerate(SERIES))
    dark = "".join(f"--s{k}:{colour};" for k, colour in enumerate(_SERIES_DARK))
    light += "".join(f"--p{k}:{part_colour(k)};" for k in range(count))
    dark += "".join(f"--p{k}:{part_colour(k, dark=True)};" for k in range(count))
    classes = "".join(f".c{k}{{color:var(--p{k})}}" for k in range(count))
    return (
        f":root{{{light}}}@media screen and (prefers-color-scheme:dark){{:root{{{dark}}}}}{classes}"
    )


def _viewer(report: Report, scene: Scene) -> str:
    """What shows the machine in three dimensions: three.js packed, the machine itself, what lies where, and the script."""
    packed = base64.b64encode(
        files("camgen.report").joinpath("three.bundle.js.gz").read_bytes()
    ).decode()
    number = {str(part["name"]): k for k, part in enumerate(report.parts)}
    place = {copy: k for k, copy in enumerate(scene.copies)}
    lying = {
        "plates": [
            [
                [number[part], *(float(f"{v:z.6g}") for v in transform.ravel())]
                for part, transform in plate.copies
            ]
            for plate in scene.plates
        ],
        "steps": [[place[copy] for copy in step.copies] for step in scene.steps],
    }
    machine = gzip.compress(scene.glb, mtime=0)
    data = {"three": packed, "glb": base64.b64encode(machine).decode()}
    blocks = [f'<script type="text/plain" id="{key}">{text}</script>' for key, text in data.items()]
    blocks.append(
        f'<script type="application/json" id="lying">{json.dumps(lying, separators=(",", ":"))}</script>'
    )
    return "".join(blocks) + f"<script>{_asset('viewer.js')}</script>"


# ---- pieces of text --------------------------------------------------------------------------------------------------


def _text(value: object) -> str:
    """A cell: numbers with six digits and a true minus, anything else escaped."""
    if isinstance(value, bool | np.bool_):
        return "yes" if value else "no"
    if isinstance(value, int | np.integer):
        return str(value).replace("-", "−")
    if isinstance(value, float | np.floating):
        return rounded(float(value), 6)
    return escape("" if value is None else str(value))


def _link(file: str, words: str = "") -> str:
    return f'<a href="{escape(quote(file))}">{escape(words or file)}</a>'


def _section(title: str, body: str, kind: str = "") -> str:
    return (
        f'<section class="{kind or title.lower()}"><h2>{title}</h2>{body}</section>' if body else ""
    )


def _unit(unit: str) -> str:
    return f" <small>{escape(UNITS.get(unit, unit))}</small>" if unit else ""


def _table(title: str, columns: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """A table with a caption."""

    def line(row: Sequence[object]) -> str:
        # What is only estimated, mass and time, is told to three digits.
        cells = (
            rounded(cell, 3)
            if isinstance(cell, float) and column.endswith((", g", ", min"))
            else _text(cell)
            for column, cell in zip(columns, row, strict=True)
        )
        rest = "".join(
            f"<td{kind(cell)}>{text}</td>" for cell, text in list(zip(row, cells, strict=True))[1:]
        )
        return f'<tr><th scope="row">{_text(row[0])}</th>{rest}</tr>'

    def kind(cell: object) -> str:
        return ' class="n"' if isinstance(cell, int | float | np.number) else ""

    rows = list(rows)
    models = rows[0] if rows else columns
    named = (column.replace("^2", "²").replace("^3", "³") for column in columns)
    heads = (
        f'<th scope="col"{kind(m)}>{escape(c)}</th>' if c else "<td></td>"
        for c, m in zip(named, models, strict=True)
    )
    head = "".join(heads)
    head = f"<caption>{escape(title)}</caption><thead><tr>{head}</tr></thead>"
    return _scrolling(title, f"<table>{head}<tbody>{''.join(map(line, rows))}</tbody></table>")


def _scrolling(title: str, table: str) -> str:
    """A table that scrolls sideways where it is too wide, by the arrow keys too."""
    return (
        f'<div class="scroll" tabindex="0" role="group" aria-label="{escape(title)}">{table}</div>'
    )


def _folded(table: Table) -> str:
    count = f"{len(table.rows)} row{'' if len(table.rows) == 1 else 's'}"
    summary = f"<summary>{escape(table.title)} <small>{count}</small></summary>"
    return f"<details>{summary}{_table(table.title, table.columns, table.rows)}</details>"


# ---- verdict ---------------------------------------------------------------------------------------------------------


def _key_figures(report: Report) -> str:
    """Five figures that tell the most: how far it moves, how exactly, with what play and at which angles, how heavy it is."""
    found: list[tuple[str, float, str, str]] = []
    listed = figures(report.numbers)
    strokes = [
        f
        for f in listed
        if f.name.endswith(("stroke", "Swing", "Stroke", "Indexing")) and "" in f.values
    ]
    found += [(f.name, f.values[""], f.unit, "") for f in strokes[:1]]
    for code, words in (
        ("MOTION_ERROR", "Motion error"),
        ("LASH", "Free play"),
        ("PRESSURE_ANGLE", "Pressure angle"),
        ("TRANSMISSION_ANGLE", "Transmission angle"),
        ("INTERFERENCE", "Least gap"),
    ):
        of = [
            f
            for f in report.findings
            if f.code == code and math.isfinite(f.measured) and (f.floor or code != "INTERFERENCE")
        ]
        if of:
            worst = max(of, key=lambda f: (not f.ok, _used(f) or 0.0))
            limit = f"{'at least' if worst.floor else 'at most'} {rounded(worst.limit, 3)}"
            found.append((words, worst.measured, worst.unit, limit))
    for key, words in (
        ("peak_torque", "Peak torque"),
        ("mass", "Mass printed"),
        ("print_time", "Time to print"),
    ):
        found += [
            (words, f.values[""], f.unit, "")
            for f in listed
            if "" in f.values and f.name == name(key)
        ]
    items = [
        f"<div><dt>{escape(words)}</dt><dd>{_rounded(value, unit, 3)}{_unit(unit)} <small>{escape(limit)}</small></dd></div>"
        for words, value, unit, limit in found[:5]
    ]
    return f'<dl class="key">{"".join(items)}</dl>' if items else ""


def to_change(report: Report) -> str:
    """What a person must know first: warnings, what fails with its numbers, and what was not judged."""
    said = "".join(f"<p><b>{escape(text)}</b></p>" for text in report.warnings)
    failing = told_once([finding for finding in report.findings if not finding.ok])
    if not (failing or report.not_judged):
        return said
    rows = [
        f'<tr class="bad"><td class="mark"><b>FAILS</b></td><th scope="row"><code>{escape(f.code)}</code> '
        f"<small>{escape(where)}</small><p>{escape(f.message)}</p></th>"
        f'<td class="n">{_text(f.measured)}{_unit(f.unit)}</td>'
        f'<td class="n">{_SIGNS[f.sign]} {_text(f.limit)}{_unit(f.unit)}</td></tr>'
        for f, where in failing
    ]
    rows += [_not_judged(each) for each in report.not_judged]
    head = "".join(
        f'<th scope="col">{words}</th>'
        for words in ("Verdict", "What to change", "Measured", "Limit")
    )
    return f'{said}<table class="change"><thead><tr>{head}</tr></thead><tbody>{"".join(rows)}</tbody></table>'


def _not_judged(each: NotJudged) -> str:
    return (
        f'<tr class="open"><td class="mark"><b>NOT JUDGED</b></td><th scope="row"><code>{escape(each.code)}</code>'
        f"<p>{escape(each.why)}</p></th><td></td><td></td></tr>"
    )


# ---- margins ---------------------------------------------------------------------------------------------------------


def _used(finding: Finding) -> float | None:
    """Share of its limit that a finding uses, above 1 where it fails; None where a share has no meaning."""
    measured, limit = finding.measured, finding.limit
    if not (math.isfinite(measured) and math.isfinite(limit)) or measured == limit:
        return None
    part, whole = (limit, measured) if finding.floor else (measured, limit)
    return part / whole if part >= 0 and whole > 0 else None


def _kind(finding: Finding) -> str:
    """In which kind of file it was found, "" as designed."""
    return finding.where.kind if finding.where.kind in KINDS else ""


def _urgent(finding: Finding) -> tuple[bool, float]:
    used = _used(finding)
    return not finding.ok, -1.0 if used is None else used


def margins(findings: Sequence[Finding]) -> str:
    """One row a code: of each kind of file the finding that is nearest to its limit, or farthest beyond."""
    groups: dict[tuple[str, str], list[Finding]] = {}
    for finding in findings:
        groups.setdefault((finding.code, finding.unit), []).append(finding)
    worst = {key: max(group, key=_urgent) for key, group in groups.items()}
    order = sorted(groups, key=lambda key: _urgent(worst[key]), reverse=True)
    kinds = [kind for kind in ("", *KINDS) if any(_kind(finding) == kind for finding in findings)]
    near = [
        key
        for key in order
        if not worst[key].ok or (_used(worst[key]) or 0) >= _NEAR or worst[key].code in _ALWAYS
    ]
    shown = near if len(near) < len(order) - 1 else order
    rest = [key for key in order if key not in shown]
    text = _margins([groups[key] for key in shown], kinds) if shown else ""
    if rest:
        count = sum(len(groups[key]) for key in rest)
        hold = f"{count} more findings of {len(rest)} kinds hold, none uses {_NEAR:.0%} of its limit".replace(
            "%", " %"
        )
        text += f"<details><summary>{hold}</summary>{_margins([groups[key] for key in rest], kinds)}</details>"
    return text


_SIGNS = {"<=": "≤", ">=": "≥", ">": "&gt;"}
_ALWAYS = ("MOTION_ERROR", "LASH", "PRESSURE_ANGLE", "TRANSMISSION_ANGLE", "INTERFERENCE")


def _margins(groups: Sequence[Sequence[Finding]], kinds: Sequence[str]) -> str:
    head = ["Finding", *(kind.upper() or "Design, assembly" for kind in kinds), "Limit"]
    rows = []
    for group in groups:
        worst = max(group, key=_urgent)
        cells = "".join(_cell([f for f in group if _kind(f) == kind], kind) for kind in kinds)
        state = "ok" if worst.ok else "bad"
        verdict = "holds" if worst.ok else "FAILS"
        limit = f"{_SIGNS[worst.sign]}&nbsp;{rounded(worst.limit, 4)}{_unit(worst.unit)}"
        rows.append(
            f'<tr class="{state}"><th scope="row"><span class="mark"><b>{verdict}</b></span> <code>{escape(worst.code)}</code>'
            f"<p>{escape(worst.message)} <small>{escape(str(worst.where))}</small></p></th>{cells}"
            f'<td class="n" data-of="limit">{limit}</td></tr>'
        )
    columns = "".join(f'<th scope="col">{words}</th>' for words in head)
    head_row = f"<thead><tr>{columns}</tr></thead>"
    return _scrolling(
        "Findings", f'<table class="rows">{head_row}<tbody>{"".join(rows)}</tbody></table>'
    )


def _cell(group: Sequence[Finding], kind: str) -> str:
    """The tightest of some findings of one code in one kind of file, with the share of its limit."""
    if not group:
        return "<td></td>"
    worst = max(group, key=_urgent)
    used, bar = _used(worst), ""
    if used is not None:
        percent = f"{100 * used:.0f} %" if used < 10 else "> 1000 %"
        # Eight tenths of the bar are the limit, so that a failing bar is seen to pass the mark.
        bar = f'<span class="use"><span class="bar"><i style="width:{80 * min(used, 1.25):.1f}%"></i></span> {percent}</span>'
    count = f" <small>tightest of {len(group)}</small>" if len(group) > 1 else ""
    bad = "" if all(finding.ok for finding in group) else " bad"
    return f'<td class="n{bad}" data-of="{kind.upper() or "designed"}">{rounded(worst.measured)}{count}{bar}</td>'


# ---- curves, figures -------------------------------------------------------------------------------------------------


def _plots(plots: Sequence[Plot]) -> str:
    drawn = [figure(plot, f"plot-{k}") for k, plot in enumerate(once(plots))]
    first, rest = drawn[:_FIRST_PLOTS], drawn[_FIRST_PLOTS:]
    said = f"{len(rest)} more curve{'' if len(rest) == 1 else 's'}"
    folded = (
        f'<details><summary>{said}</summary><div class="grid">{"".join(rest)}</div></details>'
        if rest
        else ""
    )
    return f'<div class="grid">{"".join(first)}</div>{folded}' if first else ""


def once(plots: Sequence[Plot]) -> list[Plot]:
    """The plots less those of mere rounding, and those that show nothing new: an earlier one has all their curves, and takes
    over their marks."""
    kept: list[Plot] = []
    for plot in plots:
        noise = next(
            (size for unit, size in _NOISE.items() if re.search(rf"(^|\W){unit}$", plot.y_label)),
            0.0,
        )
        if noise and all(np.nanmax(np.abs(y), initial=0.0) < noise for _, _, y in plot.series):
            continue
        at = next((k for k, other in enumerate(kept) if _shows(other, plot)), None)
        if at is None:
            kept.append(plot)
        elif not kept[at].marks:
            kept[at] = replace(kept[at], marks=plot.marks)
    return kept


def _shows(plot: Plot, other: Plot) -> bool:
    """Whether a plot shows all curves of another one, to what can be seen."""
    units = (
        (plot.x_label.rpartition(", ")[2], plot.y_label),
        (other.x_label.rpartition(", ")[2], other.y_label),
    )
    if units[0] != units[1] or plot.equal or other.equal or plot.turns != other.turns:
        return False
    for _, x, y in other.series:
        size = float(np.ptp(y[np.isfinite(y)])) if np.isfinite(y).any() else 0.0
        alike = (
            len(s)
            and s[0] <= x[0] + 1
            and s[-1] >= x[-1] - 1
            and np.nanmax(np.abs(np.interp(x, s, w) - y), initial=0.0) <= 0.005 * size
            for _, s, w in plot.series
        )
        if not (size > 0 and np.isfinite(y).all() and any(alike)):
            return False
    return bool(other.series)


def figure_lists(numbers: Mapping[str, float]) -> str:
    """The figures in groups, those of the files with a column for each kind."""
    listed = figures(numbers)
    text = ""
    for group, _ in reversed(GROUPS):
        members = [each for each in listed if each.group == group]
        by_kind = [each for each in members if set(each.values) != {""}]
        plain = [each for each in members if each not in by_kind]
        body = "".join(
            f"<div><dt>{escape(each.name)}</dt><dd>{_known(each, '')}{_unit(each.unit)}</dd></div>"
            for each in plain
        )
        body = f"<dl>{body}</dl>" if body else ""
        if by_kind:
            kinds = [kind for kind in KINDS if any(kind in each.values for each in by_kind)]
            rows = (_row(each, kinds) for each in by_kind)
            body += _table(group, ["figure", "unit", *(kind.upper() for kind in kinds)], rows)
        text += (
            f"<details{' open' if len(members) <= 24 else ''}><summary>{group}</summary>{body}</details>"
            if body
            else ""
        )
    return text


def _row(each: Figure, kinds: Sequence[str]) -> tuple[str, ...]:
    return (
        each.name,
        each.unit,
        *(_known(each, kind) if kind in each.values else "" for kind in kinds),
    )


def _known(each: Figure, kind: str) -> str:
    """A figure's value, 0 for less than a nanometre or a millionth of a degree."""
    return _rounded(each.values[kind], each.unit, 4)


def _rounded(value: float, unit: str, digits: int) -> str:
    """The same of any value and unit."""
    return "0" if abs(value) < _NOISE.get(unit, 0.0) else rounded(value, digits)


# ---- parts, plates, steps --------------------------------------------------------------------------------------------


def _parts(report: Report) -> str:
    """A card for each part: how it looks, how many, how thick, its files."""
    cards = []
    for k, part in enumerate(report.parts):
        label = str(part["name"])
        listed = part.get("files", ())
        assert isinstance(listed, Sequence)
        links = [_link(str(file), str(file).rpartition(".")[2].upper()) for file in listed]
        drawing = f"{report.name}-{label}-drawing.pdf"
        links += [_link(drawing, "PDF")] if drawing in report.files else []
        facts = [str(part["title"])] if part.get("title") else []
        facts += (
            [f"{rounded(_float(part['thickness_mm']), 3)} mm high"]
            if "thickness_mm" in part
            else []
        )
        facts += (
            [f"{rounded(_float(part['material_mm3']) / 1000, 3)} cm³"]
            if "material_mm3" in part
            else []
        )
        title = label.replace("_", " ") + (
            f" × {part['count']}" if part.get("count", 1) != 1 else ""
        )
        cards.append(_card(title, "; ".join(facts), links, f"part-{k}", report.scene is not None))
    whole = [file for file in report.files if file.startswith(f"{report.name}-assembly.")]
    links = [_link(file, file.rpartition(".")[2].upper()) for file in whole]
    return (f'<p class="links">All together: {" ".join(links)}</p>' if links else "") + _cards(
        cards
    )


def _float(value: object) -> float:
    assert isinstance(value, int | float)
    return float(value)


def _plates(scene: Scene | None) -> str:
    if scene is None:
        return ""
    cards = []
    for k, plate in enumerate(scene.plates):
        copies = f"{len(plate.copies)} {'copy' if len(plate.copies) == 1 else 'copies'}"
        cards.append(
            _card(f"Plate {k + 1}", copies, [_link(plate.file, "3MF")], f"plate-{k}", True)
        )
    return _cards(cards)


def _steps(scene: Scene | None) -> str:
    if scene is None or len(scene.steps) < 2:
        return ""
    return _cards(
        [
            _card(f"Step {k + 1}", step.title, [], f"step-{k}", bool(step.copies))
            for k, step in enumerate(scene.steps)
        ]
    )


def _card(title: str, text: str, links: Sequence[str], view: str, shown: bool) -> str:
    canvas = (
        f'<canvas class="small" data-view="{view}" width="320" height="220" aria-hidden="true"></canvas>'
        if shown
        else ""
    )
    files_of = f'<p class="links">{" ".join(links)}</p>' if links else ""
    return f"<li>{canvas}<h3>{escape(title)}</h3><p>{escape(text)}</p>{files_of}</li>"


def _cards(cards: Sequence[str]) -> str:
    return f'<ul class="cards">{"".join(cards)}</ul>' if cards else ""
