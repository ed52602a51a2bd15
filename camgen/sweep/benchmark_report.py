"""What a benchmark says: tables for a terminal, a README and a spreadsheet, plots, and the sentences a designer wants."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from camgen.files.folder import StagingFolder, write_manifest
from camgen.files.formats import FORMATS
from camgen.geometry.outlines import Floats
from camgen.plotting import figure_of, image
from camgen.progress import Progress, silent
from camgen.study import Plot
from camgen.sweep.benchmark import JUDGED, KINDS, STAGES, Bench, measure
from camgen.tolerances import SAME_POINT

STARTERS = ("uniform-swing", "indexing-cam", "chain-stitch-looper")
FOLDER = "bench_tolerance"  # with an underscore, which no spec's name has
_FLOOR = 2.0  # times what the tolerance gives: more is set by something else
_ROUNDING = 1e-12  # mm and deg, of numbers near 100 in float64
_FLAT = 10.0  # times the error at the finest tolerance: one that is nowhere more does not follow the tolerance


def run(specs: Sequence[Path], out: Path, progress: Progress = silent) -> list[Bench]:
    """Measure each spec; writes out/FOLDER with bench.csv, bench.md and two plots a spec, once all is done.

    Raises SpecError, DesignError or FileError.
    """
    with StagingFolder(out / FOLDER) as folder:
        benches = []
        for k, spec in enumerate(specs):

            def step(text: str, done: float | None = None, begun: int = k) -> None:
                progress(text, (begun + (done or 0.0)) / len(specs))

            benches.append(measure(spec, progress=step))
        (folder / "bench.csv").write_text(to_csv(benches), encoding="utf-8", newline="\n")
        (folder / "bench.md").write_text(
            "\n".join(to_markdown(bench) for bench in benches), encoding="utf-8", newline="\n"
        )
        for bench in benches:
            for what, plot in plots(bench).items():
                svg = image(figure_of([plot], log=True), "svg")
                (folder / f"{bench.name}-{what}.svg").write_bytes(svg)
        write_manifest(folder, ())
    return benches


def sentences(bench: Bench) -> list[str]:
    """What a designer wants to know, from the rows: growth against theory, and from where finer tolerances buy nothing."""
    fine = [
        row for row in bench.rows if row.outline.get("stl", math.inf) <= _FLOOR * row.tolerance
    ]  # float32 takes no part
    lines = _growth(
        "vertices",
        "STL",
        "1/2",
        [(row.tolerance, row.vertices, row.least_vertices) for row in fine],
    )
    lines += _growth(
        "arcs",
        "DXF",
        "1/3",
        [(row.tolerance, row.arcs, row.least_arcs) for row in bench.rows if row.arcs],
    )
    by_motion = any("dxf" in row.motion for row in bench.rows)
    what, unit = (f"{bench.motion} error", bench.unit) if by_motion else ("outline error", "mm")
    for kind in JUDGED:
        errors = [(row.tolerance, row.motion if by_motion else row.outline) for row in bench.rows]
        points = [(tolerance, error[kind]) for tolerance, error in errors if kind in error]
        if len(points) < 2:
            continue
        worst = max(error for _, error in points)
        finest, floor = points[-1]
        # An error goes with the tolerance until something else sets it: the coarser half tells how.
        ratio = float(
            np.median([error / tolerance for tolerance, error in points[: (len(points) + 1) // 2]])
        )
        file = kind.upper()
        least = f"{_short(floor, 1)} {unit}"
        setter = f"the {FORMATS[kind].numbers} of {file}" if FORMATS[kind].rounding else "rounding"
        if worst < SAME_POINT:
            lines.append(f"The {file} is exact at every tolerance.")
        elif worst < _FLAT * floor:
            lines.append(
                f"The {what} of the {file} is {least}, whatever the tolerance: {setter} sets it."
            )
        elif floor <= _FLOOR * ratio * finest:
            lines.append(
                f"The {what} of the {file} follows the tolerance down to {_short(finest, 1)} mm: {least}."
            )
        else:
            lines.append(
                f"Below {_short(floor / ratio, 1)} mm {setter} sets the {what}, {least}: "
                "a finer tolerance makes only larger files."
            )
    apart = [row.motion["stl"] for row in bench.rows if "stl" in row.motion]
    if apart and not by_motion:
        off = _short(max(apart), 1)
        lines.append(
            f"{bench.motion.capitalize()}s of bodies in the STL are within {off} {bench.unit} at every tolerance."
        )
    return lines


def _growth(
    what: str, kind: str, theory: str, counts: Sequence[tuple[float, int, float]]
) -> list[str]:
    """How a count grows as the tolerance falls: (tolerance, count, least count) of each row."""
    if len(counts) < 2:
        return []
    (coarse, few, _), *_, (fine, many, _) = counts
    if few == many:
        return [f"Its {few} {what} are those of the outline itself, at every tolerance."]
    times = [count / least for _, count, least in counts]
    power = math.log(many / few) / math.log(coarse / fine)
    return [
        f"{what.capitalize()} of the {kind} grow with the power {power:.2f} of 1 / tolerance (theory: up to {theory}), "
        f"{times[0]:.2f} times the least at {_short(coarse, 1)} mm and {times[-1]:.2f} at {_short(fine, 1)} mm."
    ]


def _short(value: float | None, digits: int = 2) -> str:
    """So many digits, with a power of ten below a hundredth; what is less than rounding is 0."""
    if value is None or value < _ROUNDING:
        return "–" if value is None else "0"
    return (
        f"{value:.{digits}g}"
        if not 0 < value < 0.01
        else f"{value:.{digits - 1}e}".replace("e-0", "e-")
    )


def accuracy(bench: Bench) -> tuple[list[str], list[list[str]]]:
    """Columns and rows, as text, of what each tolerance gives: counts, and largest errors by kind of file."""
    motion = f"{bench.motion}, {bench.unit}"
    columns = ["tolerance, mm", "vertices (least)", "arcs (least)"]
    columns += [
        f"{what} {kind.upper()}" for what in ("outline, mm", motion, "ripple") for kind in JUDGED
    ]
    return columns, [
        [
            _short(row.tolerance, 1),
            f"{row.vertices or '–'} ({row.least_vertices:.1f})",
            f"{row.arcs or '–'} ({row.least_arcs:.1f})",
            *(
                _short(values.get(kind))
                for values in (row.outline, row.motion, row.ripple)
                for kind in JUDGED
            ),
        ]
        for row in bench.rows
    ]


def cost(bench: Bench) -> tuple[list[str], list[list[str]]]:
    """Columns and rows, as text, of what each tolerance costs."""
    columns = [
        "tolerance, mm",
        *(f"{kind.upper()}, kB" for kind in KINDS),
        *(f"{stage}, s" for stage in STAGES),
    ]
    return columns, [
        [
            _short(row.tolerance, 1),
            *(f"{row.size[kind] / 1000:.0f}" for kind in KINDS),
            *(f"{row.seconds[stage]:.2f}" for stage in STAGES),
        ]
        for row in bench.rows
    ]


def to_text(bench: Bench) -> str:
    """Both tables, the sentences and the faults, for a terminal."""
    from rich import box
    from rich.console import Console
    from rich.table import Table

    console = Console(file=io.StringIO(), width=160, highlight=False)
    for what, (columns, rows) in (("accuracy", accuracy(bench)), ("cost", cost(bench))):
        title = f"{bench.name}, {what}"
        table = Table(title=title, title_justify="left", box=box.SIMPLE_HEAD, pad_edge=False)
        for column in columns:
            table.add_column("\n".join(column.rsplit(" ", 1)), justify="right")
        for row in rows:
            table.add_row(*row)
        console.print(table)
    stream = console.file
    assert isinstance(stream, io.StringIO)
    faults = [
        fault
        for row in bench.rows
        for fault in (f"at {row.tolerance:g} mm: {each}" for each in row.faults)
    ]
    return "\n".join([stream.getvalue(), *sentences(bench), *faults])


def to_markdown(bench: Bench) -> str:
    """The table for a README: accuracy, sizes, and seconds in all as the last column; then the sentences."""
    columns, rows = accuracy(bench)
    columns = [*columns, "DXF, kB", "STL, kB", "s in all"]
    lines = [f"`{bench.name}` ({', '.join(bench.parts)}):", ""]
    lines += [" | ".join(["", *columns, ""]).strip(), "|".join(["", *(["---"] * len(columns)), ""])]
    for cells, row in zip(rows, bench.rows, strict=True):
        sizes = [f"{row.size[kind] / 1000:.0f}" for kind in JUDGED]
        lines.append(
            " | ".join(["", *cells, *sizes, f"{sum(row.seconds.values()):.1f}", ""]).strip()
        )
    return "\n".join([*lines, "", " ".join(sentences(bench)), ""])


def to_csv(benches: Sequence[Bench]) -> str:
    """All figures, one line a mechanism and tolerance; what does not exist is empty."""
    by_kind = [f"{what}_{kind}" for what in ("outline_mm", "motion", "ripple") for kind in JUDGED]
    stages = [f"{stage}_s" for stage in STAGES]
    counts = ["vertices", "least_vertices", "arcs", "least_arcs"]
    text = io.StringIO()
    lines = csv.writer(text, lineterminator="\n")
    lines.writerow(
        [
            "name",
            "tolerance_mm",
            *counts,
            *by_kind,
            "motion_unit",
            *(f"{k}_bytes" for k in KINDS),
            *stages,
            "faults",
        ]
    )
    for bench in benches:
        for row in bench.rows:
            figures = [
                values.get(kind)
                for values in (row.outline, row.motion, row.ripple)
                for kind in JUDGED
            ]
            lines.writerow(
                [
                    bench.name,
                    f"{row.tolerance:g}",
                    row.vertices,
                    f"{row.least_vertices:.1f}",
                    row.arcs,
                    f"{row.least_arcs:.1f}",
                ]
                + ["" if value is None else f"{value:.6g}" for value in figures]
                + [bench.unit]
                + [row.size[kind] for kind in KINDS]
                + [f"{row.seconds[s]:.3f}" for s in STAGES]
                + ["; ".join(row.faults)]
            )
    return text.getvalue()


def plots(bench: Bench) -> dict[str, Plot]:
    """Counts and errors over the tolerance, for logarithmic axes, each beside its theory."""
    x = np.array([row.tolerance for row in bench.rows])

    def series(label: str, values: Sequence[float | None]) -> list[tuple[str, Floats, Floats]]:
        known = np.array(
            [value if value and value >= _ROUNDING else math.nan for value in values], float
        )
        return [(label, x, known)] if np.isfinite(known).any() else []

    rows = bench.rows
    counts = series("vertices", [row.vertices for row in rows])
    counts += series("least, slope −1/2", [row.least_vertices for row in rows])
    counts += series("arcs", [row.arcs for row in rows])
    counts += series("least, slope −1/3", [row.least_arcs for row in rows])
    errors = [("tolerance, slope 1", x, x)]
    for kind in JUDGED:
        errors += series(f"outline {kind.upper()}, mm", [row.outline.get(kind) for row in rows])
        errors += series(
            f"{bench.motion} {kind.upper()}, {bench.unit}", [row.motion.get(kind) for row in rows]
        )
    label = "chord tolerance, mm"
    return {
        "counts": Plot(f"{bench.name}: vertices and arcs", label, "count", counts),
        "errors": Plot(f"{bench.name}: errors", label, "error", errors),
    }
