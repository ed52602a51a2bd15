"""What `camgen tolerance` tells: budget, copies and yield as a report, its tables as text."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from camgen.errors import DesignError, Fault, SpecError
from camgen.machine.model import MM, Cam, Output, unit_of
from camgen.machines.sources import Source, read_mechanism
from camgen.numerics import Floats
from camgen.parts.motors import RPM
from camgen.progress import Progress, silent
from camgen.report.report import Report
from camgen.study import Figure, Figures, Plot, Table
from camgen.tolerance.bounces import CopiesBounce, bounces
from camgen.tolerance.findings import CopiesFinding, copies_findings
from camgen.tolerance.spread import (
    Copies,
    Spread,
    copies_of,
    drawn_again,
    rolled_outputs,
    spread_of,
)
from camgen.tolerance.targets import MOST, Loop, TargetYield, loops, targets
from camgen.tolerance.timing import Timing, timings

_SHARES = (0.5, 0.9, 0.95, 0.99, 0.997)  # of copies
_MOST_COPIES = 0.95  # of copies; a finding that fewer hold is explained
_BARS = 60
# Figures of a yield, and of what is wanted by value.
_YIELD = "{of} yield"
_YIELD_FROM = "{of} yield from"
_YIELD_TO = "{of} yield to"
_TARGETS = "targets"
_Z = 1.959964  # standard deviations either way of 95 %
_HOLD = "copies that hold, %", "interval of 95 %, %"
_SHOWN = 10  # of the worst copies
_MOST = 10_000_000  # copies
_NOTES = (
    "Standard deviations: print.size_error, place_error, form_error. Unless the spec gives them, a third of the usual tolerance "
    "of the plastic (FDM tolerance guide, toolsfast.app). Print a part and measure it to find your own.",
    "First order: errors along the normal over the contact's lever, and centres by the joints' slopes. Mean sizes are taken as correct: "
    "compensations of [print] correct a size that is always too small.",
    "The limits of MOTION_ERROR and UNDERCUT are for files; for copies see the quantiles. Walls, and figures from a machine's own "
    "lengths (thread, unloader), are not judged on copies.",
)


_DRUM = "The follower of a drum counts as in the middle between both walls. The worst copies are meshes in which its roller is rolled."
_FREE = "Clearance at each tip, mm, without jamming: tip_clearance of a pair, half of print.slide_clearance of a groove"
_TIMED = (
    "Bodies follow laws of the shaft, as designed: print errors of their gears and guides count as play.",
    "inf means 60 deg or more.",
)


@dataclass(frozen=True)
class PrintRun:
    """How many copies are printed, and what is looked at of them."""

    samples: int = 100_000
    seed: int = 1
    worst: int = 10  # copies of each output that are really rolled and closed
    judged: int = 0  # the first copies of all, by each finding

    def faults(self) -> list[Fault]:
        """Counts that are none, by the option that sets them."""
        counts = {"samples": 1, "worst": 0, "judged": 0}
        faults = [
            Fault((), str(count), f"from {least} to {_MOST}", source=f"--{option}")
            for option, least in counts.items()
            if not least <= (count := getattr(self, option)) <= _MOST
        ]
        if self.seed < 0:
            faults.append(Fault((), str(self.seed), "0 or more", source="--seed"))
        return faults


def tolerance(
    spec: Source,
    overrides: Sequence[str] = (),
    printing: PrintRun | None = None,
    progress: Progress = silent,
) -> Report:
    """Printed copies of a mechanism, the worst of each output really rolled and closed; nothing is written.

    SpecError for counts that are none; DesignError where no joint of the model bears an error.
    """
    printing = printing or PrintRun()
    faults = printing.faults()
    if faults:
        raise SpecError(faults, "command line")
    mechanism = read_mechanism(spec, overrides).resolved()
    progress("computing the sensitivity to each print error", 0.1)
    spread = spread_of(mechanism)
    struck = timings(mechanism)
    if not spread.modes and struck:
        figures: list[Figure] = []
        tables = _timings(struck, figures)
        name = mechanism.name
        return Report(name, mechanism.mechanism, (), Figures(figures), (), (), tables, _TIMED)
    if not spread.modes:
        why = "its bodies follow laws by themselves"
        raise DesignError("joints that print errors can displace", 0, 1, "", mechanism.name, why)
    progress("sampling printed copies", 0.3)
    copies = copies_of(spread, printing.samples, printing.seed)
    figures = []
    tables = [spread.budget(), _quantiles(spread, copies, figures)]
    plots: list[Plot] = []
    tables += _yields(spread, copies, figures)
    tables += _timings(struck, figures)
    few = drawn_again(spread, printing.seed, range(min(printing.samples, MOST)))
    tables += _bounces(bounces(spread, few, printing.seed), mechanism.model.speed, figures)
    tables += _target_yields(targets(spread, few), figures) + _loops(
        loops(spread, few, printing.seed), figures
    )
    judged: Sequence[CopiesFinding] = ()
    if printing.judged:
        progress("judging copies", 0.5)
        first = range(min(printing.samples, printing.judged))
        judged = copies_findings(spread, drawn_again(spread, printing.seed, first))
        tables += _findings(judged, figures)
    for k, output in enumerate(spread.outputs):
        progress(f"rolling the worst copies of {output.name}", 0.5 + 0.5 * k / len(spread.outputs))
        plots += _plots(spread, copies, output)
        if printing.worst:
            tables.append(
                _worst(
                    spread,
                    copies,
                    output,
                    printing.seed,
                    min(printing.worst, printing.samples),
                    figures,
                )
            )
    plots += [
        _histogram(f"Play of {cam}", "loosest place", least_unit(spread, name), loose, spread, name)
        for (name, cam), (loose, _, _) in copies.held.items()
    ]
    sampled = f"{printing.samples} copies, seed {printing.seed}."
    notes = (sampled, *_lost(judged), *_waves(spread), *_NOTES)
    notes += (_DRUM,) if mechanism.assembly.tracks else ()
    return Report(
        mechanism.name,
        mechanism.mechanism,
        (),
        Figures(figures),
        (),
        plots,
        tables,
        notes,
        summary=_summary(printing.samples, figures),
    )


def _lost(found: Sequence[CopiesFinding]) -> Iterator[str]:
    """Of each finding that holds as designed and that few copies hold, why, and the limit that most copies keep to."""
    for each in found:
        floor = each.sign.startswith(">")
        good = float(np.mean(each.holds))
        kept = each.designed >= each.limit if floor else each.designed <= each.limit
        if not kept or good >= _MOST_COPIES:
            continue
        keeps = float(np.nanquantile(each.values, 1 - _MOST_COPIES if floor else _MOST_COPIES))
        yield (
            f"{each.code} of {each.what} holds as designed, which is what a build judges; with print errors it holds in "
            f"{100 * good:.3g} % of copies. {100 * _MOST_COPIES:g} % of copies keep to {each.sign} {keeps:.3g} {each.unit}. If that is not "
            "enough, measure your printer (print.size_error, place_error, form_error) or change the design: camgen explain "
            f"{each.code} SPEC names the keys."
        )


def _waves(spread: Spread) -> list[str]:
    """What is taken of the form of cams, where there are some."""
    if not any(mode.kind == "form" and mode.size > 0 for mode in spread.modes):
        return []
    least, most = spread.sizes.orders
    waves = f"{least}" if least == most else f"{least} to {most}"
    notes = [
        f"The form error of a cam: {waves} waves a turn of equal size, together print.form_error, {spread.sizes.form:.4g} mm. "
        "print.form_orders sets how many: more waves of the same size turn the normal more."
    ]
    if any(
        isinstance(joint, Cam) and joint.over is not None for joint in spread.mechanism.model.joints
    ):
        notes.append(
            "For a plate that slides a turn is one round its link's first point, and bore is how far its track is off that point."
        )
    return notes


def _summary(samples: int, figures: Sequence[Figure]) -> str:
    """The worst of the yields, in a line."""
    yields = [each for each in figures if each.quantity == _YIELD]
    if not yields:
        return f"Errors of {samples} printed copies"
    least = min(yields, key=lambda each: each.value)
    what = {"": "go together and keep their play", _TARGETS: "hold every wanted value"}.get(
        least.of, f"hold {least.of.upper()}"
    )
    ends = [
        f"{each.value:.0f}"
        for quantity in (_YIELD_FROM, _YIELD_TO)
        for each in figures
        if each.quantity == quantity and each.of == least.of
    ]
    sure = f" ({' to '.join(ends)} % with a confidence of 95 %)" if ends else ""
    return f"Least yield: {least.value:.3g} % of copies {what}{sure}"


def _yield(of: str, holds: Floats | NDArray[np.bool_]) -> list[Figure]:
    """Share of copies, (n,), that hold what it is of, and its interval."""
    low, high = wilson(holds)
    shares = {_YIELD: 100 * float(np.mean(holds)), _YIELD_FROM: low, _YIELD_TO: high}
    return [Figure(quantity, share, "%", of) for quantity, share in shares.items()]


def wilson(holds: Floats | NDArray[np.bool_]) -> tuple[float, float]:
    """Interval of 95 % of the share of all copies that would hold, by those that were looked at, (n,), in %.

    The score interval of E. B. Wilson (1927).
    """
    n = len(holds)
    share = float(np.mean(holds))
    middle = share + _Z**2 / (2 * n)
    half = _Z * math.sqrt(share * (1 - share) / n + _Z**2 / (4 * n**2))
    low, high = (100 * (middle + sign * half) / (1 + _Z**2 / n) for sign in (-1, 1))
    return max(low, 0.0), min(high, 100.0)


def _sure(holds: Floats | NDArray[np.bool_]) -> str:
    return "{:.3g} to {:.3g}".format(*wilson(holds))


def least_unit(spread: Spread, name: str) -> str:
    """What people read an output in."""
    return unit_of(next(each for each in spread.outputs if each.name == name))[0]


def _quantiles(spread: Spread, copies: Copies, figures: list[Figure]) -> Table:
    """Worst error of a copy over its motion, which so many copies keep to."""
    rows = []
    for output in spread.outputs:
        unit, scale = unit_of(output)
        found = [float(np.quantile(copies.errors[output.name], share)) * scale for share in _SHARES]
        figures += [
            Figure(f"{{of}} error {100 * share:g} percent", value, unit, output.name)
            for share, value in zip(_SHARES, found, strict=True)
        ]
        rows.append((output.name, unit, *found))
    heads = ("output", "unit", *(f"{100 * share:g} % of copies" for share in _SHARES))
    return Table("Largest error over the motion", heads, rows)


def _yields(spread: Spread, copies: Copies, figures: list[Figure]) -> list[Table]:
    """Share of copies that hold each finding which play and fits decide."""
    limits = {each.output: each.lash for each in spread.mechanism.assembly.demands}
    good = np.ones(len(copies.tight), bool) & ~copies.tight
    rows: list[tuple[object, ...]] = []
    if any(joint.clearance > 0 for joint in spread.mechanism.model.joints):
        rows.append(("PIN_GAP", "all pins go in", 0.0, "mm", 100 * float(np.mean(~copies.tight))))
    for output in spread.outputs:
        unit, scale = unit_of(output)
        pairs = [found for (name, _), found in copies.held.items() if name == output.name]
        play = copies.play[output.name] + sum(
            (np.maximum(loose, 0) for loose, _, _ in pairs), np.zeros(len(good))
        )
        limit = limits.get(output.name, np.inf)
        if np.isfinite(limit) and np.any(play > 0):
            rows.append(
                ("LASH", output.name, limit * scale, unit, 100 * float(np.mean(play <= limit)))
            )
            good &= play <= limit
    by_cam: dict[str, tuple[Floats, Floats, Floats]] = {}
    for (_, cam), each in copies.held.items():
        by_cam.setdefault(cam, each)  # of one that moves several outputs the first
    for cam, (loose, least, air) in by_cam.items():
        code = "INTERFERENCE"
        what = "jams nowhere"
        holds = least >= 0
        if spread.air.get(cam, 0.0) < 0:
            code = "LASH"
            what = "is pressed everywhere"
            holds = loose <= 0
        rows.append((code, f"{cam} {what}", 0.0, "mm", 100 * float(np.mean(holds))))
        most = float(np.quantile(air, 0.99))
        figures.append(Figure("tip clearance 99 percent {of}", most, "mm", cam))
        good &= holds
    if not rows:
        return []
    rows.append(("all of these", "", "", "", 100 * float(np.mean(good))))
    figures.append(Figure(_YIELD, 100 * float(np.mean(good)), "%"))
    told = [
        Table(
            "Yield of play and fits alone",
            ("finding", "what", "limit", "unit", "copies that hold, %"),
            rows,
        )
    ]
    if copies.held:
        shares = [
            (cam, *(float(np.quantile(air, share)) for share in _SHARES))
            for cam, (_, _, air) in by_cam.items()
        ]
        heads = ("contact", *(f"{100 * share:g} % of copies" for share in _SHARES))
        told.append(Table(_FREE, heads, shares))
    return told


def _findings(found: Sequence[CopiesFinding], figures: list[Figure]) -> list[Table]:
    """Each finding of copies that were judged one by one."""
    rows = []
    least: dict[str, tuple[float, CopiesFinding]] = {}
    for each in found:
        limit = f"{each.sign} {each.limit:.4g}"
        good = 100 * float(np.mean(each.holds))
        mean = float(np.nanmean(each.values))
        size = float(np.nanstd(each.values))
        rows.append(
            (
                each.code,
                each.what,
                each.unit,
                limit,
                each.designed,
                mean,
                size,
                good,
                _sure(each.holds),
            )
        )
        if each.code not in least or good < least[each.code][0]:
            least[each.code] = good, each
    for code, (_, worst) in least.items():
        figures += _yield(code.lower(), worst.holds)
    heads = ("finding", "of", "unit", "limit", "as designed", "mean", "standard deviation", *_HOLD)
    return (
        [Table(f"Findings of the first {len(found[0].values)} copies, each judged", heads, rows)]
        if found
        else []
    )


def _target_yields(found: Sequence[TargetYield], figures: list[Figure]) -> list[Table]:
    """Share of copies that keep what is wanted of the outputs by value."""
    rows = [
        (
            each.code,
            each.output,
            each.limit,
            each.unit,
            100 * float(np.mean(each.holds)),
            _sure(each.holds),
        )
        for each in found
    ]
    if found:
        whole = np.all([each.holds for each in found], axis=0)
        figures += _yield(_TARGETS, whole)
        rows.append(("all of these", "", "", "", 100 * float(np.mean(whole)), _sure(whole)))  # type: ignore[arg-type]
    title = (
        f"Share of copies that hold every wanted value, of the first {len(found[0].holds)} copies"
        if found
        else ""
    )
    return [Table(title, ("finding", "output", "limit", "unit", *_HOLD), rows)] if found else []


def _timings(found: Sequence[Timing], figures: list[Figure]) -> list[Table]:
    """How much earlier or later one of two bodies may be until they strike."""
    rows = list[tuple[object, ...]]()
    least = 90.0
    for each in found:
        exact, loose = (
            [float(np.degrees(angle)) for angle in pair] for pair in (each.exact, each.loose)
        )
        rows.append((each.pair, each.least, *exact, each.play, *loose))
        least = min(least, *loose)
    if found:
        figures.append(Figure("timing tolerance", least, "deg"))
    heads = (
        "pair",
        "nearest, mm",
        "earlier, deg",
        "later, deg",
        "play, mm",
        "earlier with play, deg",
        "later with play, deg",
    )
    return (
        [
            Table(
                "Timing: by how much the first of two bodies may be off before they strike",
                heads,
                rows,
            )
        ]
        if found
        else []
    )


def _bounces(found: Sequence[CopiesBounce], speed: float, figures: list[Figure]) -> list[Table]:
    """From which speed followers leave their cams, by what is off; and what they do at the machine's own."""
    if not found:
        return []
    speeds: list[tuple[object, ...]] = []
    hops: list[tuple[object, ...]] = []
    for each in found:
        low, middle, high = (
            float(np.quantile(each.all, share)) / RPM for share in (0.01, 0.5, 0.99)
        )
        figures.append(Figure("lift off speed 1 percent {of}", low, "rpm", each.cam))
        spreads = (each.print_alone, each.springs_alone, each.all)
        sizes = [float(np.std(one)) / RPM for one in spreads]
        speeds.append(
            (each.cam, each.designed / RPM, each.rubbing / RPM, *sizes, low, middle, high)
        )
        stays = each.all > abs(speed)
        figures.append(Figure("{of} stays on", 100 * float(np.mean(stays)), "%", each.cam))
        hops.append((each.cam, 100 * float(np.mean(stays)), _sure(stays), *_hop(each)))
    count = len(found[0].all)
    heads = ("cam", "as designed", "with friction", "print alone, sd", "springs alone, sd")
    ends = ("all, sd", "1 % below", "half below", "99 % below")
    title = f"Speed above which a follower leaves its cam, rpm, for the first {count} copies"
    own = f"At {abs(speed) / RPM:.4g} rpm, of those copies"
    of_those = ("highest hop", "in the air", "hardest knock")
    columns = (
        "cam",
        *_HOLD,
        *(f"{each} of the copies that leave: median and greatest" for each in of_those),
    )
    return [Table(title, (*heads, *ends), speeds), Table(own, columns, hops)]


def _hop(copies: CopiesBounce) -> tuple[str, str, str]:
    """Of the copies that leave their cam the middle one and the worst: how far, how long, how hard."""
    leaving = [each for each in copies.leaving if each.hops]
    if not leaving:
        return "", "", ""
    unit, scale = ("mm", 1.0) if copies.slides else ("deg", math.degrees(1))
    per, size = ("m/s", MM) if copies.slides else ("deg/s", scale)

    def both(values: Sequence[float], unit: str) -> str:
        return f"{np.median(values):.3g}, at most {max(values):.3g} {unit}"

    heights = [scale * each.highest.height for each in leaving]
    lost = [100 * each.lost for each in leaving]
    knocks = [size * each.knock for each in leaving]
    return both(heights, unit), both(lost, "%"), both(knocks, per)


def _loops(found: Sequence[Loop], figures: list[Figure]) -> list[Table]:
    """Share of copies in which the smallest loop of a path is left."""
    for each in found:
        figures.append(Figure("{of} loop printed", 100 * each.printed, "%", each.output))
        figures.append(Figure("{of} loop loose", 100 * each.loose, "%", each.output))
    rows = [
        (
            each.output,
            float(np.degrees(each.begins)),
            float(np.degrees(each.ends)),
            each.extent,
            100 * each.printed,
            100 * each.loose,
        )
        for each in found
    ]
    heads = (
        "path",
        "from, deg",
        "to, deg",
        "extent, mm",
        "left in copies, %",
        "the same with the play of their pins, %",
    )
    return [Table("Smallest loops of paths", heads, rows)] if found else []


def _worst(
    spread: Spread, copies: Copies, output: Output, seed: int, count: int, figures: list[Figure]
) -> Table:
    """The copies with the largest errors: by first order, and really made."""
    unit, scale = unit_of(output)
    order = np.argsort(-copies.errors[output.name], kind="stable")[:count]
    made = (
        np.abs(
            rolled_outputs(spread, drawn_again(spread, seed, [int(k) for k in order]))[output.name]
        ).max(axis=1)
        * scale
    )
    rows = [
        (int(k), float(copies.errors[output.name][k]) * scale, float(real))
        for k, real in zip(order, made, strict=True)
    ]
    if len(made):
        figures.append(Figure("{of} error worst", float(np.max(made)), unit, output.name))
    title = f"Worst copies of {output.name}, {unit}"
    title += f": the first {_SHOWN} of {count} that were rolled" if count > _SHOWN else ""
    return Table(title, ("copy", "first order", "calculated in full"), rows[:_SHOWN])


def _plots(spread: Spread, copies: Copies, output: Output) -> list[Plot]:
    """How far three standard deviations reach over the motion, and how often which worst error occurs."""
    unit, scale = unit_of(output)
    sizes = np.array([mode.size for mode in spread.modes])
    band = (
        3
        * scale
        * np.sqrt(np.sum((np.abs(spread.found[output.name].modes) * sizes[:, None]) ** 2, axis=0))
    )
    angle = np.degrees(spread.theta)
    drawn = Plot(
        f"Error of {output.name} by the print",
        spread.mechanism.assembly.cycle.label,
        unit,
        [("3 standard deviations above", angle, band), ("3 below", angle, -band)],
    )
    return [
        drawn,
        _histogram(
            f"Largest error of {output.name}",
            "worst of a copy",
            unit,
            copies.errors[output.name],
            spread,
            output.name,
        ),
    ]


def _histogram(title: str, what: str, unit: str, values: Floats, spread: Spread, name: str) -> Plot:
    """Share of copies in each of some steps."""
    scale = unit_of(next(each for each in spread.outputs if each.name == name))[1]
    counts, edges = np.histogram(values * scale, _BARS)
    x = np.repeat(edges, 2)[1:-1]
    return Plot(
        title,
        f"{what}, {unit}",
        "% of copies",
        [("copies", x, np.repeat(100 * counts / len(values), 2))],
    )


def to_text(report: Report) -> str:
    """Its tables and notes for a terminal."""
    blocks = [f"{report.name} ({report.mechanism})"]
    for table in report.tables:
        cells = [[*map(str, table.columns)], *([_cell(cell) for cell in row] for row in table.rows)]
        widths = [max(len(row[k]) for row in cells) for k in range(len(table.columns))]
        lines = [
            "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
            for row in cells
        ]
        blocks.append("\n".join([table.title, *(f"  {line}" for line in lines)]))
    return "\n\n".join([*blocks, "\n".join(report.notes)])


def _cell(value: object) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)
