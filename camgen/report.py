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
from camgen.findings import Finding
from camgen.mechanism import Plot, Pose, Table
from camgen.outlines import Floats, Points

Ring = tuple[Points, Floats]
Path = str | PathLike[str]

# A ring with more vertices than this is drawn with fewer; files keep them all.
DRAWN_VERTICES = 4000

# Units as suffixes of a number's name, the longest first.
_UNITS = {
    "mm_s2": "mm/s²", "mm_s": "mm/s", "deg_s2": "deg/s²", "deg_s": "deg/s", "rad_s": "rad/s",
    "mm3": "mm³", "mm2": "mm²", "mm": "mm", "deg": "deg", "rpm": "rpm", "percent": "%", "g": "g", "s": "s",
}  # fmt: skip


@dataclass(frozen=True)
class Body:
    """A body of the animation, in its own frame, mm: one shape and a pose for each copy.

    rings: closed outlines (points (n,) complex, bulges (n,)), drawn even-odd, so holes are rings too; bulge k is
    tan(sweep / 4) of the arc from point k to the next, positive counter-clockwise, 0 a straight edge.
    strokes: open polylines (n,) complex; circles: (centre, radius).
    """

    name: str
    poses: Sequence[Pose]
    rings: Sequence[Ring] = ()
    strokes: Sequence[Points] = ()
    circles: Sequence[tuple[complex, float]] = ()


@dataclass(frozen=True)
class Animation:
    """One turn: `theta` (n,) rad, evenly spaced from 0, the end point left out; the poses' arrays are (n,) too.

    Each angle is a frame of the page, which interpolates between: 120 (3 deg) are exact to 0.04 % of a radius.
    output: (n,) the follower's value in `output_unit`, shown as `output_name`. A pose that is nan hides its body.
    """

    theta: Floats
    bodies: Sequence[Body]
    output: Floats | None = None
    output_name: str = "output"
    output_unit: str = ""


@dataclass(frozen=True)
class Report:
    """All that a build found out.

    parts: one mapping each with `name`, `count`, `material_mm3` and more; `files` in it lists the part's file names.
    budget: the error budget by stage; files: further files of the folder to which the page links.
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

    @property
    def ok(self) -> bool:
        """Whether every finding holds."""
        return all(finding.ok for finding in self.findings)

    @property
    def all_tables(self) -> Sequence[Table]:
        """The tables, the error budget first."""
        return (*([self.budget] if self.budget else []), *self.tables)

    def as_dict(self) -> dict[str, object]:
        """The report as report.json holds it: plain values, None for nan and inf."""
        tables = [{"title": t.title, "columns": t.columns, "rows": t.rows} for t in self.all_tables]
        plain: dict[str, object] = _plain(
            {
                "camgen": __version__,
                "name": self.name,
                "mechanism": self.mechanism,
                "ok": self.ok,
                "findings": [finding.as_dict() for finding in self.findings],
                "numbers": self.numbers,
                "parts": self.parts,
                "tables": tables,
                "notes": self.notes,
            }
        )
        return plain


def to_json(report: Report) -> str:
    """report.json as text: strict JSON, floats that read back to the same bits, null for nan and inf."""
    return json.dumps(report.as_dict(), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def to_html(report: Report, figures: Sequence[str] = ()) -> str:
    """report.html as text, self-contained; `figures` are the plots of the report as SVG, in their order."""
    frames = _frames(report.animation) if report.animation else {}
    failed = sum(not finding.ok for finding in report.findings)
    verdict = f"{failed} of {len(report.findings)} checks fail" if failed else f"All {len(report.findings)} checks hold"
    page = Template(files("camgen").joinpath("page.html").read_text(encoding="utf-8"))
    return page.substitute(
        name=escape(report.name),
        mechanism=escape(report.mechanism),
        version=escape(__version__),
        verdict=verdict,
        state="ok" if report.ok else "bad",
        findings=_findings(report.findings),
        animation=_player(report.animation) if report.animation else "",
        numbers=_section("Numbers", _numbers(report.numbers)),
        plots=_section("Curves", _plots(report.plots, figures)),
        tables=_section("Tables", "".join(_table(t.title, t.columns, t.rows) for t in report.all_tables)),
        parts=_section("Parts", _parts(report.parts)),
        notes=_section("Notes", "".join(f"<p>{escape(note)}</p>" for note in report.notes)),
        files=", ".join(_link(name) for name in report.files),
        # Names stay out of the data, so no text of a user's can end the script element.
        frames=json.dumps(frames, separators=(",", ":"), allow_nan=False),
    )


def gallery_svg(report: Report, frame: int = 0) -> str:
    """A still picture of the mechanism at frame `frame` as an SVG file of its own; empty without an animation."""
    if report.animation is None:
        return ""
    box, drawing = _drawing(report.animation, frame)
    title = f"{report.name} ({report.mechanism})"
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{box}" width="480" role="img">'
        f"<title>{escape(title)}</title><style>{_GALLERY_STYLE}</style>{drawing}</svg>\n"
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
    """The same as dicts, lists, text, numbers and None; nan and inf become None."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, np.generic | np.ndarray):
        return _plain(value.tolist())
    if isinstance(value, float):
        return value if math.isfinite(value) else None
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
        return f"{value + 0.0:.6g}".replace("-", "−") if math.isfinite(value) else "–"
    return escape("" if value is None else str(value))


def _fixed(value: float) -> str:
    """As the page's script writes a value."""
    return f"{value:.3f}".replace("-", "−") if math.isfinite(value) else "–"


def _link(name: str) -> str:
    return f'<a href="{escape(quote(name))}">{escape(name)}</a>'


def _section(title: str, body: str) -> str:
    return f'<section class="{title.lower()}"><h2>{title}</h2>{body}</section>' if body else ""


def _used(finding: Finding) -> float | None:
    """Share of its limit that a finding uses, above 1 where it fails; None where a share has no meaning.

    A finding does not say whether its limit is a ceiling or a floor; verdict and order of the two numbers tell.
    """
    measured, limit = finding.measured, finding.limit
    if not (math.isfinite(measured) and math.isfinite(limit)) or measured == limit:
        return None
    part, whole = (measured, limit) if (measured < limit) == finding.ok else (limit, measured)
    return part / whole if part >= 0 and whole > 0 else None


def _findings(findings: Sequence[Finding]) -> str:
    rows = []
    for finding in sorted(findings, key=lambda finding: finding.ok):
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
            f'<td class="n">{_text(finding.limit)}{unit}</td>{bar}</tr>'
        )
    head = "".join(f'<th scope="col">{name}</th>' for name in ("Verdict", "Check", "Measured", "Limit", "Of the limit"))
    return f"<table><thead><tr>{head}</tr></thead><tbody>{''.join(rows)}</tbody></table>"


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


# The mechanism as SVG

_GALLERY_STYLE = (
    "svg{background:#fff;font-family:sans-serif}.grid{stroke:#e6eaee}.axes{stroke:#9aa5b1}.scale{stroke:#39424e}"
    "text{fill:#39424e}use{fill:currentColor;stroke:currentColor}.c0{color:#0b62a8}.c1{color:#b5541c}.c2{color:#2c7a4b}"
    ".c3{color:#7a3e9d}.c4{color:#8a6d00}.c5{color:#a8326e}"
)


def _number(value: float) -> str:
    """Shortest text of a coordinate to 0.1 um, never -0 or an exponent."""
    text = f"{value:.4f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def _xy(z: complex) -> str:
    return f"{_number(z.real)} {_number(z.imag)}"


def _drawn(ring: Ring) -> Ring:
    """The ring with few enough vertices to draw: one for each small step along it, then all edges straight."""
    points, bulges = np.asarray(ring[0], complex), np.asarray(ring[1], float)
    if len(points) <= DRAWN_VERTICES:
        return points, bulges
    along = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(points)))])
    step = np.floor(along / along[-1] * (DRAWN_VERTICES / 2))
    points = points[np.concatenate([[True], np.diff(step) > 0])]
    return points, np.zeros(len(points))


def _path(ring: Ring) -> str:
    """SVG path of a ring in its own frame (y up under the drawing's mirror image, so bulges keep their sense)."""
    points, bulges = _drawn(ring)
    ends = np.roll(points, -1)
    chords = np.abs(ends - points)
    words = [f"M{_xy(points[0])}"]
    for end, chord, bulge in zip(ends.tolist(), chords.tolist(), bulges.tolist(), strict=True):
        if abs(bulge) * chord < 2e-5:  # an arc this flat is a line to 0.01 um, and its radius would overflow renderers
            words.append(f"L{_xy(end)}")
        else:
            radius = _number(chord * (1 + bulge * bulge) / (4 * abs(bulge)))
            words.append(f"A{radius} {radius} 0 {int(abs(bulge) > 1)} {int(bulge > 0)} {_xy(end)}")
    return "".join(words) + "Z"


def _spread(body: Body) -> Points:
    """Points whose hull is the body's, to a thousandth of its size: vertices, arcs' insides, circles."""
    groups = [np.zeros(1, complex), *(np.asarray(stroke, complex) for stroke in body.strokes)]
    for ring in body.rings:
        points, bulges = _drawn(ring)
        chord = np.roll(points, -1) - points
        sweep = 4 * np.arctan(bulges)
        for share in np.arange(8) / 8:
            curved = np.abs(bulges) > 1e-9
            half = np.where(curved, np.sin(sweep / 2), 1.0)
            along = np.where(curved, np.sin(share * sweep / 2) / half, share)
            groups.append(points + chord * along * np.exp(-1j * (1 - share) * sweep / 2))
    groups += [centre + radius * np.exp(2j * np.pi * np.arange(48) / 48) for centre, radius in body.circles]
    points = np.concatenate(groups)
    outward = np.exp(-2j * np.pi * np.arange(72) / 72)
    return np.asarray(points[np.unique([np.argmax((points * way).real) for way in outward])])


def _posed(pose: Pose, count: int) -> tuple[Floats, Points]:
    """Angles, rad, and positions, mm, (count,) each, of a pose that may be constant."""
    return np.broadcast_to(pose.angle, count), np.broadcast_to(np.asarray(pose.position, complex), count)


def _copies(animation: Animation) -> list[tuple[int, Pose]]:
    """(index of body, pose) of all copies, lowest first; sketches lie on top."""
    copies = [(k, pose) for k, body in enumerate(animation.bodies) for pose in body.poses]
    return sorted(copies, key=lambda copy: (not animation.bodies[copy[0]].rings, copy[1].z))


def _frames(animation: Animation) -> dict[str, object]:
    """What the page's script needs: of each copy its [deg, x, y] by frame (a single one where it rests)."""
    poses = []
    for _, pose in _copies(animation):
        angle, position = _posed(pose, len(animation.theta))
        rows = np.round(np.column_stack([np.degrees(angle), position.real, position.imag]) + 0.0, 3).tolist()
        states = [row if all(map(math.isfinite, row)) else None for row in rows]
        poses.append(states[:1] if all(state == states[0] for state in states) else states)
    output = [] if animation.output is None else np.asarray(animation.output, float).tolist()
    return {
        "frames": len(animation.theta),
        "poses": poses,
        "flipped": [pose.flipped for _, pose in _copies(animation)],
        "output": [float(f"{value:.6g}") if math.isfinite(value) else None for value in output],
    }


def _drawing(animation: Animation, frame: int) -> tuple[str, str]:
    """View box and markup of the mechanism at a frame; the page's script moves the `use` elements."""
    copies, count = _copies(animation), len(animation.theta)
    reach = []
    for k, pose in copies:
        angle, position = _posed(pose, count)
        shape = _spread(animation.bodies[k])
        shape = -np.conj(shape) if pose.flipped else shape
        reach.append((position[:, None] + np.exp(1j * angle[:, None]) * shape).ravel())
    cloud = np.concatenate([np.zeros(1, complex), *reach])
    cloud = cloud[np.isfinite(cloud)]
    left, right, low, high = cloud.real.min(), cloud.real.max(), cloud.imag.min(), cloud.imag.max()
    size = max(right - left, high - low, 1e-3)
    left, right, low, high = left - 0.05 * size, right + 0.05 * size, low - 0.13 * size, high + 0.05 * size
    power = 10.0 ** math.floor(math.log10(size / 10))
    step = next(power * factor for factor in (1, 2, 5, 10) if power * factor >= size / 10.000001)
    across, up = (np.arange(math.ceil(a / step), b / step) * step for a, b in ((left, right), (low, high)))
    grid = "".join(f"M{_xy(complex(x, low))}V{_number(high)}" for x in across)
    grid += "".join(f"M{_xy(complex(left, y))}H{_number(right)}" for y in up)
    thin, bar = _number(size / 500), complex(left + 0.04 * size, low + 0.05 * size)
    shapes = "".join(_shape(k, body, size / 60) for k, body in enumerate(animation.bodies))
    dashes = f' stroke-dasharray="{_number(size / 80)} {_number(size / 160)}"'
    uses = "".join(
        f'<use href="#body-{k}" class="c{k % 6}"{dashes if pose.flipped else ""} {_placed(pose, frame, count)}/>'
        for k, pose in copies
    )
    axes = f"M{_number(left)} 0H{_number(right)}M0 {_number(low)}V{_number(high)}"
    text = f'<text x="{_number(bar.real)}" y="{_number(-bar.imag - size / 60)}" font-size="{_number(size / 32)}">'
    return (
        " ".join(map(_number, (left, -high, right - left, high - low))),
        f'<defs>{shapes}</defs><g transform="scale(1 -1)" fill="none" stroke-width="{thin}" stroke-linejoin="round">'
        f'<path class="grid" d="{grid}"/><path class="axes" d="{axes}" stroke-dasharray="{_number(size / 30)} '
        f'{_number(size / 120)} {_number(size / 240)} {_number(size / 120)}"/>'
        f'<path class="scale" stroke-width="{_number(size / 200)}" d="M{_xy(bar)}h{_number(2 * step)}"/>{uses}</g>'
        f"{text}{2 * step:g} mm</text>",
    )


def _shape(k: int, body: Body, cross: float) -> str:
    """A body as a symbol to be placed: tinted material, strokes, circles and a cross at its datum."""
    rings = "".join(_path(ring) for ring in body.rings)
    lines = "".join("M" + "L".join(_xy(z) for z in np.asarray(stroke).tolist()) for stroke in body.strokes)
    mark = f"M-{(c := _number(cross))} 0H{c}M0 -{c}V{c}" if rings else ""
    rounds = "".join(
        f'<circle cx="{_number(z.real)}" cy="{_number(z.imag)}" r="{_number(radius)}" fill-opacity=".12"/>'
        for z, radius in body.circles
    )
    return (
        f'<g id="body-{k}">' + (f'<path fill-rule="evenodd" fill-opacity=".2" d="{rings}"/>' if rings else "")
        + (f'<path fill="none" d="{lines}{mark}"/>' if lines or mark else "") + rounds + "</g>"
    )  # fmt: skip


def _placed(pose: Pose, frame: int, count: int) -> str:
    angle, position = _posed(pose, count)
    if not np.isfinite(angle[frame] + position[frame]):
        return 'display="none"'
    mirror = "scale(-1 1)" if pose.flipped else ""
    return f'transform="translate({_xy(position[frame])})rotate({_number(math.degrees(angle[frame]))}){mirror}"'


def _player(animation: Animation) -> str:
    """The drawing with its legend, play button, slider and read-out; without script a still picture."""
    box, drawing = _drawing(animation, 0)
    legend = []
    for k, body in enumerate(animation.bodies):
        for flipped in sorted({pose.flipped for pose in body.poses}):
            number = sum(pose.flipped == flipped for pose in body.poses)
            words = body.name + (", flipped" if flipped else "") + (f" × {number}" if number > 1 else "")
            legend.append(f'<li class="c{k % 6}{" flipped" if flipped else ""}">{escape(words)}</li>')
    names = ", ".join(body.name for body in animation.bodies)
    value = "" if animation.output is None else (
        f'<span>{escape(animation.output_name)} <output id="value">{_fixed(animation.output[0])}</output> '
        f"{escape(animation.output_unit)}</span>"
    )  # fmt: skip
    return (
        f'<figure class="player"><svg id="mechanism" viewBox="{box}" role="img" aria-labelledby="drawn drawn-what">'
        f'<title id="drawn">The mechanism in motion</title><desc id="drawn-what">Seen along the axes, y up: '
        f"{escape(names)}.</desc>{drawing}</svg><ul>{''.join(legend)}</ul>"
        '<div class="controls"><button type="button" id="play" hidden>Play</button>'
        '<input id="theta" type="range" min="0" max="360" step="0.5" value="0" aria-label="cam angle, degrees" hidden>'
        f'<p><span>θ <output id="angle">0.0</output> deg</span>{value}</p></div></figure>'
    )
