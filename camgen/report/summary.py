"""What a person reads first of a report, as data: verdict, what fails or is not judged, five figures, which file to open.

Terminal and page show the same records.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from camgen.findings import Finding, NotJudged
from camgen.report import words
from camgen.report.report import Report
from camgen.report.tables import share_used
from camgen.study import Figure

_STROKES = ("stroke", "swing", "index", "needle stroke", "{of} stroke")  # how far a machine moves
_ALONG = "{of} stroke along"
_WALK = "walk way"
_COUNT = 5  # of figures
_NOTHING = (
    1e-6  # of a torque in N m, a mass in g or a time in h: less is none that a person speaks of
)
_HEAVY = 1e4  # g, from which a mass is told in kg
_LEAST_TORQUE = 1e-4  # N m, a gram on an arm of 10 mm: less comes of no load
_KINDS = ("dxf", "stl", "3mf", "step", "glb", "svg", "png", "gif", "pdf")
# What is shown beside the stroke, the weightiest first: what it is called, code of its findings, else quantity of a figure.
_OTHERS = (
    ("Walk in a turn", "", _WALK),
    ("Walking speed", "", "walk speed"),
    ("Off the path", "PATH_ERROR", ""),
    ("Straightness", "STRAIGHTNESS", ""),
    ("Dwell", "DWELL", ""),
    ("Free play", "LASH", ""),
    ("Pressure angle", "PRESSURE_ANGLE", ""),
    ("Base radius", "", "base radius"),
    ("Drum radius", "", "drum radius"),
    ("Transmission angle", "TRANSMISSION_ANGLE", ""),
    ("", "", ""),  # what of _STRENGTH is used most
    ("Torque needed", "DRIVE_TORQUE", "drive torque"),
    ("Force needed", "", "drive force"),
    ("Motion error", "MOTION_ERROR", ""),
    ("Contact pressure", "HERTZ", ""),
    ("Mass", "", "mass"),
    ("Time to print", "", "print time"),
    ("Least gap", "INTERFERENCE", ""),
)
# What breaks or wears first: before torque and error where more than half of its limit is used.
_STRENGTH = {
    "HERTZ": "Contact pressure",
    "PIN_STRESS": "Pin stress",
    "SHAFT_STRESS": "Shaft stress",
    "SPRING_STRESS": "Spring stress",
    "TOOTH_STRESS": "Tooth stress",
    "PV": "Pressure times speed",
}
_MUCH = 0.5
_ERRORS = ("MOTION_ERROR", "PATH_ERROR")


@dataclass(frozen=True)
class Headline:
    """A figure that tells much of a machine."""

    name: str
    value: float
    unit: str
    finding: Finding | None = None  # that judges it
    along: Sequence[float] = ()  # directions of its strokes, deg from the x axis

    @property
    def is_error(self) -> bool:
        """Whether it tells how far off something is: measured, however small."""
        return self.finding is not None and self.finding.code in _ERRORS

    def said(self, shown: Callable[[float], str]) -> str:
        """Its value in words; an error that is only rounding is measured, and no bare 0; shown: a number as text."""
        rounding = self.is_error and self.value < words.NOISE
        return f"below {shown(words.NOISE)}" if rounding else shown(self.value)

    def beside(self, shown: Callable[[float], str]) -> str:
        """Its limit or its direction in words; shown: a number as text."""
        if self.along:
            return f"along {' and '.join(shown(each) for each in self.along)} deg"
        if self.finding is None or math.isnan(self.finding.limit):
            return ""
        return f"{'at least' if self.finding.floor else 'at most'} {shown(self.finding.limit)}"


@dataclass(frozen=True)
class FileStep:
    """What to do with a file: print plate.3mf, and plate-2."""

    verb: str
    file: str  # its path from the folder that was written
    rest: str = ""


@dataclass(frozen=True)
class Summary:
    """What a person reads first."""

    state: str  # "ok", "open": something is not judged or warned of, "bad", or "" without findings
    verdict: str
    asides: str  # how much is not judged and warned of, such as "; 1 warning", behind the verdict
    failing: Sequence[tuple[Finding, str]]  # the worst of each kind, and where
    not_judged: Sequence[NotJudged]
    warnings: Sequence[str]
    figures: Sequence[Headline]  # five: motion, play, angle, torque, error
    files: Sequence[str]  # in the folder that was written, by their paths from there
    kinds: Sequence[tuple[str, int]]  # how many files of each kind
    steps: Sequence[FileStep]  # what to open, print, cut and paste


def summary(report: Report) -> Summary:
    """What a person reads first of a report."""
    failing = report.failing
    open_ = report.not_judged or report.warnings
    state = "bad" if failing else "open" if open_ else "ok" if report.findings else ""
    folder = None if report.folder is None else Path(report.folder)
    found = [] if folder is None else sorted(each for each in folder.rglob("*") if each.is_file())
    files = {path.name: str(path.relative_to(folder)) for path in found if folder is not None}
    count = Counter(name.rpartition(".")[2] for name in files)
    return Summary(
        state,
        report.outcome,
        _asides(report),
        failing,
        report.not_judged,
        report.warnings,
        list(_figures(report))[:_COUNT],
        [*files.values()],
        [(kind, count[kind]) for kind in _KINDS if count[kind]],
        [*_steps(report, files)],
    )


def _asides(report: Report) -> str:
    """How much of a report is not judged, and of how much it warns, behind its verdict; "" of nothing."""
    open_ = len(report.not_judged)
    warned = len(report.warnings)
    said = f"; {open_} not judged" if open_ else ""
    return said + (f"; {warned} warning{'s' * (warned > 1)}" if warned else "")


def _figures(report: Report) -> Iterator[Headline]:
    """How far the first two outputs move, a path along its largest extent, then the others that are known.

    Outputs that move equally far to all digits that are shown, as both wings of a bird, are one figure.
    """
    designed = [each for each in report.numbers.records if not each.kind]
    strokes = dict[str, Figure]()
    for each in designed:
        if each.quantity in _STROKES:
            strokes.setdefault(each.of, each)
    walks = any(each.quantity == _WALK for each in designed)
    directions = {each.of: each.value for each in designed if each.quantity == _ALONG}
    for first, *others in _equally_far([*strokes.values()][: 1 if walks else None])[:2]:
        names = [each.of for each in (first, *others)]
        along = dict.fromkeys(round(directions[of], 1) for of in names if of in directions)
        name = words.name(replace(first, of=" and ".join(names)) if len(names) == 2 else first)
        more = f" and {len(others)} more" if len(others) > 1 else ""
        yield Headline(f"{name}{more}", first.value, first.unit, along=[*along])
    by_code: dict[str, list[Finding]] = {}
    for finding in report.findings:
        by_code.setdefault(finding.code, []).append(finding)
    judged = {code: _worst(findings) for code, findings in by_code.items()}
    strained = _strained([each for each in judged.values() if each is not None])
    for name, code, quantity in _OTHERS:
        figure = next((each for each in designed if each.quantity == quantity), None)
        if quantity and not (figure and figure.value > _NOTHING):
            continue  # such as the torque of a cam on which nothing is known to press
        if figure and figure.unit == "N m" and figure.value < _LEAST_TORQUE:
            continue  # what moves parts of no weight
        worst = judged.get(code) if code else None if quantity else strained
        if worst is not None and worst.code == "LASH" and worst.ok and not worst.measured:
            continue  # a force holds the joints to one side
        if worst is not None and (not code or worst is not strained):
            output = worst.where.output  # a file tells that of its worst output alone
            of = f" of {output.replace('_', ' ')}" if output and len(strokes) > 1 else ""
            yield Headline(
                f"{name or _STRENGTH[worst.code]}{of}", worst.measured, worst.unit, worst
            )
        elif worst is None and figure is not None:
            heavy = figure.unit == "g" and figure.value >= _HEAVY
            value, unit = (figure.value / 1000, "kg") if heavy else (figure.value, figure.unit)
            yield Headline(name, value, unit)


def _equally_far(strokes: Sequence[Figure]) -> list[list[Figure]]:
    """Strokes of which four digits and the unit are the same together, in their order."""
    alike: dict[tuple[str, str, str], list[Figure]] = {}
    for each in strokes:
        alike.setdefault((each.quantity, f"{each.value:.4g}", each.unit), []).append(each)
    return [*alike.values()]


def _strained(findings: Sequence[Finding]) -> Finding | None:
    """Of findings on strength the one that uses most of its limit, where that is more than half, or fails."""
    used = [(share_used(each) or 0.0, each) for each in findings if each.code in _STRENGTH]
    share, most = max(used, key=lambda pair: pair[0], default=(0.0, None))
    return most if share > _MUCH else None


def _worst(findings: Sequence[Finding]) -> Finding | None:
    """Of findings of one code that which is nearest to its limit; of bodies the least gap, not an overlap that is meant."""
    known = [
        each
        for each in findings
        if math.isfinite(each.measured) and (each.floor or each.code != "INTERFERENCE")
    ]
    return max(known, key=lambda each: (not each.ok, share_used(each) or 0.0), default=None)


def _print_time(report: Report) -> str:
    """How long a printer takes for all parts, with which infill, and how much of it for a stand that takes most; "" where that is
    not known."""
    hours = {each.quantity: each.value for each in report.numbers.records}
    whole = hours.get("print time", 0.0)
    stand = hours.get("print time stand", 0.0)
    if whole <= _NOTHING:
        return ""
    of_stand = (
        f"; the stand takes {words.rounded(stand, 2)} h of it, and can be cut from sheet instead"
    )
    infill = hours.get("print infill", 1.0)
    layers = f"in layers of {hours['print layer']:.2g} mm " if "print layer" in hours else ""
    how = f"{layers}at {infill:.0%} infill"
    return f" (all parts, estimated {words.rounded(whole, 2)} h {how}{of_stand if stand > whole / 2 else ''})"


def _purchases(report: Report) -> str:
    """How much of the parts list is bought, rods among it, in words; "" of nothing."""
    counts = [
        row[table.columns.index("count")]
        for table in report.tables
        if table.shopping
        for row in table.rows
        if row[0] in ("bought", "stock")
    ]
    pieces = sum(each for each in counts if isinstance(each, int))
    kinds = f"{len(counts)} kind{'s' * (len(counts) > 1)}"
    return f"{kinds}, {pieces} piece{'s' * (pieces > 1)}" if counts else ""


def _steps(report: Report, files: Mapping[str, str]) -> Iterator[FileStep]:
    """What to do with the files of a machine; files: their paths by their names."""
    name = report.name
    bought = _purchases(report)
    if "report.html" in files:
        moves = " move" if "motion.csv" in files else ""  # a coupon's does not
        built = f"{name}-assembly.glb" in files and any(len(t.steps) > 1 for t in report.tables)
        joined = " and how to put it together" if built else ""
        yield FileStep("open", "report.html", f" in a browser to see it{moves}{joined}")
    parts = files.get(f"{name}-parts.csv")
    if parts and bought:
        yield FileStep("buy what is marked bought or stock in", parts, f" ({bought})")
    plates = [each for each in files if re.fullmatch(rf"{re.escape(name)}-plate(-\d+)?\.3mf", each)]
    if plates:
        first, *more = sorted(plates, key=lambda each: (len(each), each))
        stem = first.removesuffix(".3mf")
        numbers = [each.removesuffix(".3mf").removeprefix(stem) for each in more]
        last = f" to {numbers[-1]}" if len(numbers) > 1 else ""
        others = f", and plate{numbers[0]}{last}" if numbers else ""
        yield FileStep("print", files[first], others + _print_time(report))
    sheets = [each for each in files if re.fullmatch(rf"{re.escape(name)}-sheet-\d+\.svg", each)]
    if sheets:
        yield FileStep(
            "cut", files[sheets[0]], f" and {len(sheets) - 1} more" if len(sheets) > 1 else ""
        )
    tables = [each for each in files if re.search(r"-(codesys|twincat|s7)\.st$", each)]
    if tables:
        others = f"; {len(tables) - 1} more are for other drives" if len(tables) > 1 else ""
        yield FileStep("load", files[sorted(tables)[0]], f" into the drive's project{others}")
    if f"{name}-grbl.nc" in files:
        yield FileStep("send", files[f"{name}-grbl.nc"], " to a controller with Grbl")
    if f"{name}-print.toml" in files:
        yield FileStep("paste", f"{name}-print.toml", " into your specs")
