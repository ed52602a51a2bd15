"""What a person reads of findings and figures, as pieces of HTML: what to change, margins, figures in groups."""

from __future__ import annotations

import math
from collections.abc import Sequence
from html import escape

import numpy as np

from camgen.findings import Finding, NotJudged, as_read, checks
from camgen.report import words
from camgen.report.words import KINDS, NOISE, rounded, sentence
from camgen.study import Figures, Table

NOISE_OF = {
    "mm": 1e-6,
    "deg": 1e-6,
    "N": NOISE,
    "N m": NOISE,
    "W": NOISE,
}  # what is less is rounding: 1 nm, a millionth of a deg
_LONG_LIFE = 1e5  # h, over ten years: what is more is said no more exactly
_NEAR = 0.8  # share of its limit from which on a margin is shown unfolded


class Markup(str):
    """HTML in a cell."""


def cell_text(value: object, digits: int = 6) -> str:
    """A cell: a number with some digits and a true minus, HTML as it is, anything else escaped."""
    if isinstance(value, Markup):
        return value
    if isinstance(value, bool | np.bool_):
        return "yes" if value else "no"
    if isinstance(value, int | np.integer):
        return str(value).replace("-", "−")
    if isinstance(value, float | np.floating):
        return rounded(float(value), digits)
    return _raised("" if value is None else str(value))


def unit_text(unit: str) -> str:
    """A unit behind a number."""
    return f" <small>{_raised(unit)}</small>" if unit not in ("", "1") else ""


def _raised(text: str) -> str:
    """Escaped text with its squares and cubes raised."""
    return escape(text).replace("^2", "²").replace("^3", "³")


def html_table(table: Table) -> str:
    """A table with a caption."""

    def line(row: Sequence[object]) -> str:
        first, *rest = (cell_text(cell, table.digits) for cell in row)
        cells = zip(row[1:], rest, strict=True)
        data = "".join(f"<td{kind(cell)}>{text}</td>" for cell, text in cells)
        return f'<tr><th scope="row">{first}</th>{data}</tr>'

    def kind(cell: object) -> str:
        return ' class="n"' if isinstance(cell, int | float | np.number) else ""

    models = table.rows[0] if table.rows else table.columns
    head = "".join(
        f'<th scope="col"{kind(model)}>{_raised(name)}</th>' if name else "<td></td>"
        for name, model in zip(table.columns, models, strict=True)
    )
    head = f"<caption>{escape(table.title)}</caption><thead><tr>{head}</tr></thead>"
    body = "".join(map(line, table.rows))
    return scrolling(table.title, f"<table>{head}<tbody>{body}</tbody></table>")


def scrolling(title: str, table: str) -> str:
    """A table that scrolls sideways where it is too wide, by the arrow keys too."""
    return (
        f'<div class="scroll" tabindex="0" role="group" aria-label="{escape(title)}">{table}</div>'
    )


def to_change(
    warnings: Sequence[str],
    failing: Sequence[tuple[Finding, str]],
    not_judged: Sequence[NotJudged],
) -> str:
    """What a person must know first: warnings, what fails with its numbers, and what was not judged."""
    said = "".join(f"<p><b>{escape(sentence(text))}</b></p>" for text in warnings)
    if not (failing or not_judged):
        return said
    rows = [
        f'<tr class="bad"><td class="mark"><b>FAILS</b></td><th scope="row"><code>{escape(f.code)}</code> '
        f"<small>{escape(where)}</small><p>{_raised(sentence(f.message))}</p></th>"
        f'<td class="n">{_size(f.measured, f, 6)}</td>'
        f'<td class="n">{_SIGNS[f.sign]} {_size(f.limit, f, 6)}</td></tr>'
        for f, where in failing
    ]
    rows += [_not_judged(each) for each in not_judged]
    head = "".join(
        f'<th scope="col">{title}</th>'
        for title in ("Verdict", "What to change", "Measured", "Limit")
    )
    return f'{said}<table class="change"><thead><tr>{head}</tr></thead><tbody>{"".join(rows)}</tbody></table>'


def _size(value: float, finding: Finding, digits: int) -> str:
    """A value of a finding with its unit."""
    read, unit = as_read(value, finding.unit)
    return f"{rounded(read, digits)}{unit_text(unit)}"


def _not_judged(each: NotJudged) -> str:
    return (
        f'<tr class="open"><td class="mark"><b>NOT JUDGED</b></td><th scope="row"><code>{escape(each.code)}</code>'
        f"<p>{escape(sentence(each.why))}</p></th><td></td><td></td></tr>"
    )


def share_used(finding: Finding) -> float | None:
    """Share of its limit that a finding uses, above 1 where it fails; None where a share has no meaning."""
    measured = finding.measured
    limit = finding.limit
    if not (math.isfinite(measured) and math.isfinite(limit)) or measured == limit:
        return None
    part, whole = (limit, measured) if finding.floor else (measured, limit)
    return part / whole if part >= 0 and whole > 0 else None


def _kind(finding: Finding) -> str:
    """In which kind of file it was found, "" as designed."""
    return finding.where.kind if finding.where.kind in KINDS else ""


def _urgent(finding: Finding) -> tuple[bool, float]:
    used = share_used(finding)
    return not finding.ok, -1.0 if used is None else used


def margins(findings: Sequence[Finding]) -> str:
    """One row a check: of each kind of file the finding that is nearest to its limit, or farthest beyond."""
    order = sorted(checks(findings), key=_urgency, reverse=True)
    kinds = [kind for kind in ("", *KINDS) if any(_kind(finding) == kind for finding in findings)]
    near = [
        group for group in order if _urgency(group) >= (False, _NEAR) or group[0].code in _ALWAYS
    ]
    shown = near if len(near) < len(order) - 1 else order
    rest = [group for group in order if group not in shown]
    text = _margins(shown, kinds) if shown else ""
    if rest:
        count = sum(map(len, rest))
        codes = len({group[0].code for group in rest})
        more = "more " if shown else ""
        hold = f"{count} {more}findings of {codes} kinds hold; none uses {100 * _NEAR:.0f} % of its limit"
        text += f"<details><summary>{hold}</summary>{_margins(rest, kinds)}</details>"
    return text


def _urgency(group: Sequence[Finding]) -> tuple[bool, float]:
    """That of the finding nearest to its limit."""
    return max(map(_urgent, group))


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
        limit = f"{_SIGNS[worst.sign]}&nbsp;{_size(worst.limit, worst, 4)}"
        rows.append(
            f'<tr class="{state}"><th scope="row"><span class="mark"><b>{verdict}</b></span> <code>{escape(worst.code)}</code>'
            f"<p>{_raised(sentence(worst.message))} <small>{escape(str(worst.where))}</small></p></th>{cells}"
            f'<td class="n" data-of="limit">{limit}</td></tr>'
        )
    columns = "".join(f'<th scope="col">{title}</th>' for title in head)
    head_row = f"<thead><tr>{columns}</tr></thead>"
    return scrolling(
        "Findings", f'<table class="rows">{head_row}<tbody>{"".join(rows)}</tbody></table>'
    )


def _cell(group: Sequence[Finding], kind: str) -> str:
    """The tightest of some findings of one code in one kind of file, with the share of its limit."""
    if not group:
        return "<td></td>"
    worst = max(group, key=_urgent)
    used = share_used(worst)
    bar = ""
    if used is not None:
        percent = f"{100 * used:.0f} %" if used < 10 else "> 1000 %"
        # Eight tenths of the bar are the limit, so that a failing bar is seen to pass the mark.
        bar = f'<span class="use"><span class="bar"><i style="width:{80 * min(used, 1.25):.1f}%"></i></span> {percent}</span>'
    count = f" <small>tightest of {len(group)}</small>" if len(group) > 1 else ""
    bad = "" if all(finding.ok for finding in group) else " bad"
    long = worst.unit == "h" and worst.measured > _LONG_LIFE >= worst.limit
    measured, _ = as_read(worst.measured, worst.unit)
    said = value_text(measured, "h", 6) if long else rounded(measured)
    return f'<td class="n{bad}" data-of="{kind.upper() or "designed"}">{said}{count}{bar}</td>'


def figure_lists(numbers: Figures) -> str:
    """The figures in groups, those of the files with a column for each kind."""
    rows = words.rows(numbers)
    text = ""
    for group in reversed(words.GROUPS):
        members = [row for row in rows if row.group == group]
        by_kind = [row for row in members if set(row.values) != {""}]
        body = "".join(
            f"<div><dt>{escape(row.name)}</dt><dd>{_known(row, '')}{unit_text(row.unit)}</dd></div>"
            for row in members
            if row not in by_kind
        )
        body = f"<dl>{body}</dl>" if body else ""
        if by_kind:
            there = [kind for row in by_kind for kind in row.values]
            kinds = [kind for kind in dict.fromkeys(("", *KINDS, *there)) if kind in there]
            cells = [
                (row.name, row.unit, *(_known(row, kind) for kind in kinds)) for row in by_kind
            ]
            heads = ("figure", "unit", *(kind.upper() or "designed" for kind in kinds))
            body += html_table(Table(group, heads, cells))
        text += (
            f"<details{' open' if len(members) <= 24 else ''}><summary>{group}</summary>{body}</details>"
            if body
            else ""
        )
    return text


def _known(row: words.Row, kind: str) -> str:
    """A figure's value, "" where no such file was measured."""
    return value_text(row.values[kind], row.unit, 4) if kind in row.values else ""


def value_text(value: float, unit: str, digits: int) -> str:
    """A value to some digits, 0 for less than a nanometre or a millionth of a degree, "over 100 000" for a longer life."""
    if unit == "h" and value > _LONG_LIFE:
        return f"over {rounded(_LONG_LIFE, digits)}"
    return "0" if abs(value) < NOISE_OF.get(unit, 0.0) else rounded(value, digits)
