"""report.html: one file for people, that needs nothing else: verdict, machine, curves, margins, figures, tables.

The page is page.html, page.css and page.js of this folder, filled in; where there are solids, viewer.js on three.js shows them.
"""

from __future__ import annotations

import base64
import gzip
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, astuple, replace
from functools import cache
from html import escape
from importlib.resources import files
from os import PathLike
from string import Template
from urllib.parse import quote

import numpy as np

from camgen._version import __version__
from camgen.errors import listed
from camgen.files.parts_list import PRINT_SPEED
from camgen.findings import left_out
from camgen.plotting import SERIES
from camgen.report.animation import frames, player
from camgen.report.colours import part_colour
from camgen.report.plots import plot_figure
from camgen.report.report import Report, write_text
from camgen.report.summary import Headline, Summary, summary
from camgen.report.tables import (
    NOISE_OF,
    Markup,
    figure_lists,
    html_table,
    margins,
    to_change,
    unit_text,
    value_text,
)
from camgen.report.words import rounded, sentence
from camgen.study import Mate, Plot, Prism, Scene, Step, Table

_FIRST_PLOTS = 12  # more curves than this are folded away; it fills rows of two and four
_FIRST_OF_PRINTED = 4  # of what is printed, of which one looks for what to buy, print and do first
_MASS = "mass in "  # begins a column of the parts list
_TALL = 3.0  # by which a printed part is higher than the square is wide that it stands on, and asks for a brim
_BRIM = 1.0  # mm wide: parts lie 3 mm apart on a plate
_FLAT = ("as drawn", "turned over")  # how a part lies that is as high as it is thick
_SERIES_DARK = ("#6db3f2", "#f2a069", "#74cf98", "#c99be8", "#dcc04e", "#f08fbf")


@cache
def _asset(file: str) -> str:
    return files("camgen.report").joinpath(file).read_text(encoding="utf-8")


def to_html(report: Report) -> str:
    """report.html as text, self-contained."""
    turn = frames(report.animation) if report.animation else {}
    scene = report.scene
    first = summary(report)
    plates = _plates(report)
    needs = left_out(report.not_judged)
    asked = [each for each in first.not_judged if not each.absent]
    machine = player(report.animation, scene is not None) if report.animation else ""
    machine += _film(report)
    machine += f'<p class="flat">{escape(sentence(report.why_flat))}</p>' if report.why_flat else ""
    return Template(_asset("page.html")).substitute(
        name=escape(report.name),
        mechanism=escape(report.mechanism),
        version=escape(__version__),
        outcome=escape(report.outcome + first.asides),
        unjudged=f'<p class="unjudged">NOT JUDGED: {escape(needs)}</p>' if needs else "",
        state=first.state,
        style=_asset("page.css")
        + _palette(len(report.animation.bodies) if report.animation else 0),
        links=_links(report),
        key=_key_figures(first),
        change=to_change(first.warnings, first.failing, asked),
        machine=machine,
        plots=_section(
            "Curves", _plots(report.plots, _FIRST_OF_PRINTED if plates else _FIRST_PLOTS)
        ),
        shopping=_section("What to buy and to cut", _shopping(report), "shopping")
        + _section("Tools", _tools(report), "tools-at-hand"),
        parts=_section("Parts", _parts(report))
        + _section("Plates, ready to print", plates, "plates")
        + _section("Sheets, as they are cut", _sheets(report), "sheets")
        + _section(scene.work if scene else "", _steps(scene), "steps"),
        findings=_section("Margins", _margins(report), "findings"),
        numbers=_section("Figures", figure_lists(report.numbers)),
        tables=_section("Tables", "".join(map(_folded, map(_as_cut, report.all_tables)))),
        notes=_section(
            "Notes", "".join(f"<p>{escape(sentence(note))}</p>" for note in report.notes)
        ),
        files=", ".join(
            _link(report, file) for file in report.files if not file.endswith("-drawing.pdf")
        ),
        # Names stay out of the data, so no text of a user's can end the script element.
        frames=json.dumps(turn, separators=(",", ":"), allow_nan=False),
        script=_asset("page.js"),
        viewer=_viewer(report, scene) if scene is not None else "",
    )


def _film(report: Report) -> str:
    """The moving picture in the page itself."""
    if not report.film:
        return ""
    data = base64.b64encode(report.film).decode("ascii")
    alt = escape(f"{report.name} in motion")
    return f'<section><img class="film" alt="{alt}" src="data:image/gif;base64,{data}"></section>'


def write_html(path: str | PathLike[str], report: Report) -> None:
    """Write report.html; FileError where it cannot be written."""
    write_text(path, to_html(report))


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
        "steps": [*_on_bench(scene.steps, place)],
        "parts": [
            [str(part.get("title", "")), [[*astuple(hole)] for hole in holes]]
            for part, holes in zip(report.parts, scene.holes, strict=False)
        ],
    }
    machine = gzip.compress(scene.glb, mtime=0)
    data = {"three": packed, "glb": base64.b64encode(machine).decode()}
    blocks = [f'<script type="text/plain" id="{key}">{text}</script>' for key, text in data.items()]
    # No text can end the script element.
    said = json.dumps(lying, separators=(",", ":")).replace("<", r"\u003c")
    blocks.append(f'<script type="application/json" id="lying">{said}</script>')
    return "".join(blocks) + f"<script>{_asset('viewer.js')}</script>"


def _on_bench(steps: Sequence[Step], place: Mapping[str, int]) -> Iterator[dict[str, object]]:
    """Steps of assembly for the script; place: number of each copy. What was put together on the bench comes as one thing."""
    together = dict[str, Sequence[str]]()  # with which copies each was put together
    there = set[str]()
    for step in steps:
        things = list(dict.fromkeys(tuple(together.get(copy, (copy,))) for copy in step.copies))
        come = [thing for thing in things if not there.issuperset(thing)]
        copies = list(dict.fromkeys(copy for thing in things for copy in thing))
        said = _shown_step(replace(step, copies=copies), place)
        if come != [(copy,) for copy in copies]:
            said["things"] = [[place[copy] for copy in thing] for thing in come]
        yield said
        there.update(step.copies)
        together |= {copy: own for _, own, _ in step.laid for copy in own}


def _shown_step(step: Step, place: Mapping[str, int]) -> dict[str, object]:
    """A step of assembly for the script."""
    mates = _shown_mates(step.mates)
    copies = [place[copy] for copy in step.copies]
    wire = [] if step.wire is None else (step.wire.round(2) + 0.0).tolist()
    shapes = _shown_prisms(step.shapes)
    said = {"copies": copies, "way": step.way, "mates": mates, "wire": wire}
    if shapes:
        said |= {"shapes": shapes}
    if step.screws:
        said |= {"screws": _shown_prisms(step.screws)}
    if step.apart:
        said["apart"] = step.apart
    if step.apart or step.up != (0.0, 0.0, 1.0):
        said["up"] = step.up
    if step.along:
        said |= {"along": step.along}
    if step.laid:
        said |= {
            "laid": [
                [name, [place[copy] for copy in own], _shown_mates(fixed)]
                for name, own, fixed in step.laid
            ]
        }
    return said | ({"joins": step.joins} if step.joins else {})


def _shown_prisms(prisms: Sequence[Prism]) -> list[list[object]]:
    """Prisms for the script."""
    return [
        [
            [[round(z.real, 2) + 0.0, round(z.imag, 2) + 0.0] for z in corners],
            round(low, 3),
            round(high, 3),
        ]
        for corners, low, high in prisms
    ]


def _shown_mates(mates: Sequence[Mate]) -> list[dict[str, object]]:
    """Mates for the script."""
    return [
        {**asdict(mate), "place": [round(value, 3) + 0.0 for value in mate.place]}  # no -0
        for mate in mates
    ]


# ---- pieces of text ----


def _link(report: Report, file: str, text: str = "") -> str:
    place = report.places.get(file, file)
    return f'<a href="{escape(quote(place))}">{escape(text or file)}</a>'


def _section(title: str, body: str, kind: str = "") -> str:
    return (
        f'<section class="{kind or title.lower()}" id="to-{kind or title.lower()}"><h2>{title}</h2>{body}</section>'
        if body
        else ""
    )


def _links(report: Report) -> str:
    """To what a maker looks for first: what to buy, what to print or cut, and the steps."""
    scene = report.scene
    found = {
        "shopping": ("What to buy", _shopping(report)),
        "plates": ("What to print", _plates(report)),
        "sheets": ("What to cut", _sheets(report)),
        "steps": ("How to put it together", _steps(scene)),
        "findings": ("What was checked", report.findings),
    }
    links = [f'<a href="#to-{kind}">{said}</a>' for kind, (said, body) in found.items() if body]
    return f"<nav>{''.join(links)}</nav>" if len(links) > 1 else ""


def _shopping(report: Report) -> str:
    """What is not printed: bought, cut or turned, and what steps use up; each with its number on the arrangement drawing and its own
    drawing, where there are some."""

    def cell(row: _Row, column: str) -> object:
        value = row.get(column, "")
        if column != _DRAWING:
            return value
        return Markup(_link(report, str(value), "PDF")) if value in report.files else ""

    columns = ("no", "how", "part", "what", "count", _DRAWING)
    wanted = [row for row in _parts_list(report) if row["how"] not in _OWNED]
    rows = [tuple(cell(row, column) for column in columns) for row in wanted]
    filled = [k for k in range(len(columns)) if any(row[k] != "" for row in rows)]
    shown = [tuple(row[k] for k in filled) for row in rows]
    return html_table(Table("", [columns[k] for k in filled], shown)) if rows else ""


_DRAWING = "drawing"


def _tools(report: Report) -> str:
    """What one has on a bench."""
    rows = [
        (row["part"], row["what"], row["count"] if row["count"] != 1 else "")
        for row in _parts_list(report)
        if row["how"] == _TOOL
    ]
    return html_table(Table("", ("part", "what", "count"), rows)) if rows else ""


_TOOL = "tool"
_OWNED = ("printed", _TOOL)


_Row = Mapping[str, object]  # of the parts list, by its columns


def _parts_list(report: Report) -> list[_Row]:
    """Its rows."""
    return [
        dict(zip(table.columns, row, strict=False))
        for table in report.tables
        if table.shopping
        for row in _as_cut(table).rows
    ]


def _as_cut(table: Table) -> Table:
    """A table; in the parts list what is cut from one of its rods says so, what else is turned of which steel, and what you bring that it
    is your own."""
    if not table.shopping:
        return table
    rows = [dict(zip(table.columns, row, strict=False)) for row in table.rows]
    rods = [str(row["part"]).removeprefix("steel ") for row in rows if row["how"] == "stock"]
    for row in rows:
        if any(rod in str(row["what"]) for rod in rods):
            row["how"] = _MILLED if "keyway" in str(row["what"]) else _CUT
        elif row["how"] == _TURNED:
            row["how"] = f"turned of {row.get('material') or 'steel'}"
        elif row["how"] == "dummy":
            row["how"] = "your own"
    return replace(table, rows=[tuple(row.values()) for row in rows])


_TURNED = "turned of steel"  # as the list has it
_CUT = "turned of steel: here cut from the rod and filed"  # of the list, which needs no lathe
_MILLED = "turned of steel: here cut from the rod and milled"  # the same with a keyway


def _margins(report: Report) -> str:
    """How far each finding is from its limit, and how the bars are read."""
    return _BARS + margins(report.findings) if report.findings else ""


_BARS = (
    "<p>A bar shows how much of its limit a finding uses; the mark on the bar is the limit. A finding holds up to 100 %: some "
    "sizes, such as gaps on a plate, are made exactly at their limit.</p>"
)


def _folded(table: Table) -> str:
    count = f"{len(table.rows)} row{'' if len(table.rows) == 1 else 's'}"
    summary = f"<summary>{escape(table.title)} <small>{count}</small></summary>"
    return f"<details>{summary}{html_table(table)}</details>"


# ---- verdict ---------------------------------------------------------------------------------------------------------


def _key_figures(first: Summary) -> str:
    """Five figures that tell the most."""
    items = "".join(map(_key_figure, first.figures))
    return f'<dl class="key">{items}</dl>' if items else ""


def _key_figure(each: Headline) -> str:
    value = each.said(
        lambda value: rounded(value, 3) if each.is_error else value_text(value, each.unit, 3)
    )
    beside = escape(each.beside(lambda value: rounded(value, 3)))
    return f"<div><dt>{escape(each.name)}</dt><dd>{value}{unit_text(each.unit)} <small>{beside}</small></dd></div>"


# ---- curves, figures -------------------------------------------------------------------------------------------------


def _plots(plots: Sequence[Plot], shown: int) -> str:
    """Curves; more than so many are folded away."""
    drawn = [plot_figure(plot, f"plot-{k}") for k, plot in enumerate(once(plots))]
    first = drawn[:shown]
    rest = drawn[shown:]
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
        noise = NOISE_OF.get(plot.y_label, 0.0)
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
    one_axis = plot.turns == other.turns and (plot.turns or plot.x_label == other.x_label)
    if not one_axis or plot.y_label != other.y_label or plot.equal or other.equal:
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


# ---- parts, plates, steps --------------------------------------------------------------------------------------------


_OF_ALL = {
    "assembly": "arrangement drawing",
    "timing": "timing diagram",
    "shaft": "drawing of the shaft",
}  # sheets of the machine


def _parts(report: Report) -> str:
    """A card for each part: how it looks, how many, how thick, its files."""
    cards = []
    rows = {str(row["part"]): row for row in _parts_list(report)}
    for k, part in enumerate(report.parts):
        label = str(part["name"])
        row = rows.get(label, {})
        how = str(row.get("how", "printed"))
        listed = part.get("files", ())
        assert isinstance(listed, Sequence)
        by_hand = how in _NOT_PRINTED or how.startswith("turned ")
        if by_hand:
            listed = [file for file in listed if str(file).rpartition(".")[2] not in _TO_PRINT]
        links = [_link(report, str(file), str(file).rpartition(".")[2].upper()) for file in listed]
        for kind, said in (("", "PDF"), ("-tracks", "PDF of its tracks")):
            drawing = f"{report.name}-{label}{kind}-drawing.pdf"
            links += [_link(report, drawing, said)] if drawing in report.files else []
        facts = [str(part["title"])] if part.get("title") else []
        facts += (
            [f"{rounded(_float(part['thickness_mm']))} mm high"] if "thickness_mm" in part else []
        )
        facts += [how] if by_hand else []
        facts += [each for each in [_estimate([(row, 1 / _count(row))])] if each]
        title = label + (f" × {part['count']}" if part.get("count", 1) != 1 else "")
        cards.append(_card(title, "; ".join(facts), links, f"part-{k}", report.scene is not None))
    whole = [file for file in report.files if file.startswith(f"{report.name}-assembly.")]
    links = [_link(report, file, file.rpartition(".")[2].upper()) for file in whole]
    links += [
        _link(report, file, said)
        for kind, said in _OF_ALL.items()
        if (file := f"{report.name}-{kind}-drawing.pdf") in report.files
    ]
    return (f'<p class="links">All together: {" ".join(links)}</p>' if links else "") + _cards(
        cards
    )


_NOT_PRINTED = ("bought", "cut of steel")
_TO_PRINT = ("stl", "3mf")  # files for a slicer


def _count(row: _Row) -> float:
    """How many copies a row of the parts list is of."""
    count = row.get("count", 1)
    return float(count) if isinstance(count, int | float) and count else 1.0


def _amounts(rows: Sequence[tuple[_Row, float]]) -> tuple[float, float]:
    """How much plastic printed parts take, g, and how long, min; rows: of the parts list, each with its share."""
    mass = minutes = 0.0
    for row, share in rows:
        for column, value in row.items():
            if isinstance(value, int | float) and column.startswith(_MASS):
                mass += value * share
            if isinstance(value, int | float) and column.startswith("print time"):
                minutes += value * share
    return mass, minutes


def _estimate(rows: Sequence[tuple[_Row, float]]) -> str:
    """The same in words, as "12 g, 1.5 h"; "" where the list does not say."""
    mass, minutes = _amounts(rows)
    if not (mass and minutes):
        return ""
    time = f"{rounded(minutes / 60, 2)} h" if minutes >= 60 else f"{max(minutes, 1):.2g} min"
    return f"{rounded(mass, 2)} g, {time}"


def _float(value: object) -> float:
    assert isinstance(value, int | float)
    return float(value)


def _plates(report: Report) -> str:
    if report.scene is None:
        return ""
    cards = []
    mass = 0.0
    rows = {str(row["part"]): row for row in _parts_list(report)}
    for k, plate in enumerate(report.scene.plates):
        copies = f"{len(plate.copies)} {'copy' if len(plate.copies) == 1 else 'copies'}"
        found = [rows[part] for part, _ in plate.copies if part in rows]
        taken = [(row, 1 / _count(row)) for row in found]
        mass += _amounts(taken)[0]
        estimate = _estimate(taken)
        copies += f"; about {estimate}" if estimate else ""
        copies += f"; {' × '.join(f'{side:.0f}' for side in plate.size)} mm high"
        cards.append(
            _card(f"Plate {k + 1}", copies, [_link(report, plate.file, "3MF")], f"plate-{k}", True)
        )
    count = len(cards)
    these = f"these {count} plates: they hold" if count > 1 else "this plate: it holds"
    again = "Take the file of a single part only to print that part again."
    need = "They need" if count > 1 else "It needs"
    filament = f"{need} about {rounded(mass, 2)} g of {_plastic(report)}. " if mass else ""
    bed = "for a bed of {:g} × {:g} mm".format(*report.scene.plates[0].bed) if cards else ""
    said = f"<p>Print {these} every part, {bed}. {_settings(report)}{filament}{_footing(report)}{again}</p>"
    return said + _cards(cards) if cards else ""


def _plastic(report: Report) -> str:
    """What is printed, as the parts list names it."""
    columns = (column for table in report.tables if table.shopping for column in table.columns)
    masses = (column for column in columns if column.startswith(_MASS))
    return next(masses, "").removeprefix(_MASS).removesuffix(", g") or "filament"


def _settings(report: Report) -> str:
    """With which settings of the slicer the estimates are, as a sentence; "" where nothing is known of them."""
    known = {each.quantity: each.value for each in report.numbers.records}
    if not {"print layer", "print nozzle", "print infill", "print time"} <= {*known}:
        return ""
    solid = known["print infill"] == 1
    filled = (
        "100% infill, for weight and strength are those of solid parts"
        if solid
        else f"and walls and infill that make {known['print infill']:.0%} of a part plastic"
    )
    wide = [str(part["name"]) for part in report.parts if part.get("sparse_infill")]
    do = "where little is carried"
    if wide:
        do = f"for {listed('part', wide)}, wide and still; print the others solid"
    less = f"Four walls and 30% infill take less time, and do {do}. " * solid
    return (
        f"Settings: layers of {known['print layer']:.2g} mm, a nozzle of {known['print nozzle']:g} mm, {filled}. "
        f"With these it takes about {rounded(known['print time'], 2)} h at {PRINT_SPEED:g} mm/s. {less}"
    )


def _footing(report: Report) -> str:
    """Which printed parts ask for supports, and which for a brim; "" where it is not known how they lie."""
    rows = {str(row["part"]): row for row in _parts_list(report) if row.get("lies")}
    hollow = [part for part, row in rows.items() if _float(row["overhang, mm^2"]) > 0]
    slim = [
        str(part["name"])
        for part in report.parts
        if (row := rows.get(str(part["name"]))) is not None
        and row["lies"] in _FLAT
        and _float(part["thickness_mm"]) > _TALL * _float(row["on the bed, mm^2"]) ** 0.5
    ]
    supports = f"Supports under {listed('part', hollow)} alone. " if hollow else "No supports. "
    brim = (
        f"A brim of {_BRIM:g} mm round {listed('part', slim)}, tall on a small foot. "
        if slim
        else ""
    )
    return supports + brim if rows else ""


def _sheets(report: Report) -> str:
    """Sheets for a laser, as far as parts lie on them, with sizes and names: lines as wide as a person sees them."""
    drawn = []
    for k, sheet in enumerate(report.sheets, 1):
        reach = (
            max((low.real + across for _, low, across, _ in sheet.parts), default=0.0),
            max((low.imag + up for _, low, _, up in sheet.parts), default=0.0),
        )
        # from its lower left corner; what is empty beyond the half is not shown
        wide, high = (
            whole if used > whole / 2 else used
            for used, whole in zip(reach, sheet.size, strict=True)
        )
        top = sheet.size[1] - high
        edge = 0.06 * max(wide, high)
        texts = [
            f'<text x="{wide / 2:.6g}" y="{top + high + 0.8 * edge:.6g}">{wide:.4g} mm</text>',
            f'<text transform="translate({-0.4 * edge:.6g} {top + high / 2:.6g}) rotate(-90)">{high:.4g} mm</text>',
            *(_on_sheet(sheet.size[1], 0.35 * edge, *part) for part in sheet.parts),
        ]
        box = f"{-edge:.6g} {top - 0.2 * edge:.6g} {wide + 1.2 * edge:.6g} {high + 1.2 * edge:.6g}"
        groups = sheet.groups.replace('<g id="', '<g class="')  # a page has several sheets
        count = len(sheet.parts)
        said = (
            f"{count} {'part' if count == 1 else 'parts'} within {reach[0]:.4g} × {reach[1]:.4g} mm "
            f"of a sheet of {sheet.size[0]:g} × {sheet.size[1]:g} mm; red is cut, {sheet.cut / 1000:.3g} m "
            "in all; blue is engraved first"
        )
        drawn.append(
            f'<figure><svg viewBox="{box}" font-size="{0.35 * edge:.3g}" role="img" aria-label="Sheet {k}: {said}">'
            f'<rect width="{sheet.size[0]:g}" height="{sheet.size[1]:g}"/>{groups}{"".join(texts)}</svg>'
            f"<figcaption>Sheet {k}, {_link(report, sheet.file)}: {said}</figcaption></figure>"
        )
    return "".join(drawn)


def _on_sheet(height: float, most: float, name: str, low: complex, across: float, up: float) -> str:
    """The name of a part in its middle, along its longer side, at most so high, mm; height: of the sheet."""
    long = max(across, up)
    short = min(across, up)
    size = min(most, 1.4 * long / max(len(name), 1), 0.5 * short)
    turn = " rotate(-90)" if up > across else ""
    x = low.real + across / 2
    y = height - low.imag - up / 2
    place = f'transform="translate({x:.6g} {y:.6g}){turn}" dy="0.35em"'
    return f'<text {place} font-size="{size:.3g}">{escape(name)}</text>'


def _steps(scene: Scene | None) -> str:
    if scene is None or len(scene.steps) < 2:
        return ""
    cards = [
        _card(f"Step {k + 1}", step.text, [], f"step-{k}", _has_picture(step))
        for k, step in enumerate(scene.steps)
    ]
    all_steps = (
        f"<details open><summary>All steps</summary>{_keys(scene.steps)}{_cards(cards)}</details>"
    )
    return _BENCH + all_steps


def _has_picture(step: Step) -> bool:
    """Whether something comes in it that can be shown."""
    return bool(
        step.copies
        or step.wire is not None
        or step.joins
        or step.shapes
        or step.laid
        or step.screws
    )


def _keys(steps: Sequence[Step]) -> str:
    """What the colours of the small pictures mean, as far as there are any."""
    hows = {mate.how for step in steps for mate in step.mates}
    hows |= {mate.how for step in steps for _, _, mates in step.laid for mate in mates}
    shown = {
        "new": True,
        "glue": "glue" in hows,
        "free": "free" in hows,
        "screw": any(step.screws for step in steps),
    }
    words = (f'<span class="{key}">{_KEYS[key]}</span>' for key, there in shown.items() if there)
    return f'<p class="glues">{"".join(words)}</p>'


_KEYS = {
    "new": "comes in this step",
    "glue": "glue here",
    "free": "no glue: it moves",
    "screw": "screw",
}
# Steps one after the other, as the script shows them; without it the cards below remain.
_BENCH = (
    '<div class="bench" hidden><div class="view"><canvas id="bench" tabindex="0" role="img" aria-label="The step in three '
    "dimensions; left and right arrow keys: one step back and on; Home and End: first and last step; up and down and with Shift: turn; "
    'plus and minus: zoom"></canvas><div id="whole" aria-hidden="true" hidden></div>'
    '<div id="marks" aria-hidden="true"></div></div>'
    '<p id="said" aria-live="polite"></p><div class="controls"><button id="back">Back</button><button id="next">Next</button>'
    '<input id="seek" type="range" min="1" value="1" aria-label="step"><output id="count"></output><button id="again">Show again</button>'
    '<p class="glues bench-keys"><span class="glue">glue here</span><span class="free">no glue: it moves</span>'
    '<span class="screw">screw</span><span class="below">seen from below</span></p></div></div>'
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
