"""Names, groups and digits of figures as people read them."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field

from camgen.findings import as_read
from camgen.study import Figure, Figures

# What quantities are called whose own words do not say it in full.
NAMES = {
    "clearance band {of}": "worst-case free play, either way: {of}",
    "play {of}": "free play of the output: {of}",
    "{of} length": "{of} path length",
    "{of} stroke along": "{of} stroke, its direction",
    "motion error {of}": "motion error: {of}",
    "tip motion error {of}": "motion error of the tip alone: {of}",
    "stroke recovered {of}": "stroke, from the file: {of}",
    "swing recovered {of}": "swing, from the file: {of}",
    "index recovered": "indexing, from the file",
    "lash {of}": "free play of the follower: {of}",
    "canvas share {of}": "canvas within 10 %, {of} collector",
    "mass": "mass of the parts made",
    "print time": "print time of all parts",
    "flat pressure": "pressure of the shaft's flat in its bore, greatest",
    "print time stand": "print time of the stand alone",
    "print layer": "layer height",
    "print nozzle": "diameter of the nozzle",
    "print infill": "infill that mass and print time assume (material.infill)",
    "index": "indexing",
    "drive torque": "torque needed, greatest",
    "drive torque mean": "torque needed, mean",
    "drive power": "power needed, mean",
    "drive force": "force needed, greatest",
    "drive force mean": "force needed, mean",
    "drive torque {of}": "torque needed, greatest: {of}",
    "drive torque mean {of}": "torque needed, mean: {of}",
    "drive power {of}": "power needed, mean: {of}",
    "let down": "payout angle",
    "let down ratio": "payout ratio",
    "peak speed angle": "angle of the peak speed",
    "wear {joint}": "wear, force times speed: {joint}",
    "spring preload needed": "spring preload needed at this rate",
    "spring rate needed": "spring rate needed at this preload",
    "swing by play of axle": "swing by the play of the axle",
    "uniform share": "share of uniform motion",
    "residual share": "share of the peak torque left to the cam",
    "supports": "area that needs supports",
    "pv max": "pressure times speed of bearings, greatest",
    "hertz pressure {of}": "Hertz pressure: {of}",
    "roller slip": "slip at the roller's ends, greatest",
    "roller reversals": "times per turn that the roller's spin reverses",
    "roller reversal slip": "slip as the roller's spin reverses, greatest",
    "roller reversal work": "work that friction takes at each reversal of the spin",
    "flywheel for 2 percent": "flywheel for a speed within 2 %",
    "flywheel for 10 percent": "flywheel for a speed within 10 %",
    "starting torque": "motor torque at standstill that starts the machine at any angle",
    "run up time": "time from rest until the machine runs",
    "speed swing": "swing of the speed, as a share of the mean",
    "settled speed": "mean speed of the running machine",
    "turning inertia": "inertia as the shaft feels it, mean",
    "walk way": "walk: distance in a turn, at low speed",
    "walk speed": "walk: speed at the drive's speed, without inertia",
    "walk way least": "walk: least distance in a turn if the feet's friction differs",
    "walk way greatest": "walk: greatest distance in a turn if the feet's friction differs",
    "walk tilt least": "walk: tilt of the frame, least",
    "walk tilt greatest": "walk: tilt of the frame, greatest",
    "walk rise": "walk: rise and fall of the shaft",
    "walk slip": "walk: slip of a loaded foot in a turn",
    "walk slip work least": "walk: work lost to slip in a turn, least",
    "walk slip work greatest": "walk: work lost to slip in a turn, greatest",
    "walk least support": "walk: least share of the load on a foot",
    "walk falls at": "walk: falls at",
    "ripple {of}": "uneven turning, held on one side: {of}",
    "balance weight at": "direction of the balance weight",
    "balance spring at": "direction of the balance spring",
    "print error {of}": "error from the print: {of}",
    "source r": "R of the source, AC",
    **{
        f"source {sign} {k}": f"{word}{'₁₂'[k - 1]} of the source"
        for k in (1, 2)
        for sign, word in (("r", "r"), ("alpha", "α"), ("beta", "β"))
    },
    "dwell within 0_25 mm": "dwell within 0.25 mm",
}

# Groups of figures, and what belongs to each: what was measured in files, else by the quantity, else by the unit.
FROM_FILES, PRINTING, MAKING, FORCES, SHAPE, MOTION = GROUPS = (
    "From the files",
    "Printing",
    "Making",
    "Forces and drive",
    "Shape and contact",
    "Motion",
)
_UNITS = {
    FORCES: "N, N m, N s, N m s, N/mm, N m/rad, N rad/s, MPa, MPa m/s, J, W, Hz, g mm, kg m²",
    MAKING: "g, h, mm²",
}
_QUANTITIES = {
    FORCES: "roller reversals, roller reversal slip, balance spring at, balance weight at, counterweight, counterweight {of}, counterweight at, crank counterweight at, "
    "crank moment asked at, hop, hop {of}, knock, knock {of}, lift off speed, lift off speed {of}, lift off speed 1 percent {of}, residual share, run up time, settled speed, speed swing, stalls at, second harmonic share, "
    "spring stretch greatest, spring stretch least",
    MAKING: "motor shaft length, outline length, shaft length",
    PRINTING: "print infill, print layer, print nozzle, print time, print time stand, supports",
    SHAPE: "roller slip, base radius, curvature radius min, disc wall, pitch curvature radius min, pitch radius max, pitch radius min, "
    "prime radius, pressure angle, pressure angle low passed, pressure angle return, pressure angle rise, profile area, "
    "profile length, radius max, radius min, undercut, {of} least radius, {of} pressure angle, tip on {of} x, tip on {of} y",
}
_GROUP_OF_UNIT = {unit: group for group, units in _UNITS.items() for unit in units.split(", ")}
_GROUP_OF = {each: group for group, found in _QUANTITIES.items() for each in found.split(", ")}

_SIDES = ("{of} x stroke", "{of} y stroke")  # of a path's box
_RECOVERED = "stroke recovered {of}"
_LEAST_RADIUS = "{of} least radius"
_SHARES = ("print infill",)  # quantities without a unit that are shares

KINDS = ("dxf", "stl", "3mf", "step")  # of files that are measured
NOISE = 1e-9  # what is less counts as 0: lengths are known to some nanometres at best

_EXTREME = re.compile(r" (min|max)( at)?$")  # ends the name of a quantity
_ROUNDING = re.compile(
    r"(?<![\w.-])-?\d+(\.\d+)?e-[1-9]\d+(?!\w)"
)  # a number below NOISE, as a program writes it


@dataclass
class Row:
    """A figure as it is shown: name, unit, value, or one value for each kind of file that it was measured in."""

    quantity: str
    name: str
    unit: str
    group: str
    values: dict[str, float] = field(default_factory=dict)


def rows(numbers: Figures) -> list[Row]:
    """The figures of a report, those of the kinds of files side by side; a path that turns on the spot has no least radius."""
    found: dict[tuple[str, str], Row] = {}
    longer = _longer_sides(numbers)
    for each in numbers.records:
        if each.quantity == _LEAST_RADIUS and each.value < NOISE:
            continue
        title = longer.get((each.module, each.of), "") * (each.quantity == _RECOVERED)
        title = title or name(each)
        value, unit = as_read(each.value, "share" if each.quantity in _SHARES else each.unit)
        row = found.setdefault((title, unit), Row(each.quantity, title, unit, group(each)))
        row.values[each.kind] = float(value)
        if each.kind:
            row.group = FROM_FILES
    return list(found.values())


def _longer_sides(numbers: Figures) -> dict[tuple[str, str], str]:
    """What is measured of a path: not its stroke, the largest extent in any direction, but the longer side of its box along x and y.

    By module and output; one that is alone has no name in what is measured.
    """
    sides: dict[tuple[str, str], dict[str, float]] = {}
    for each in numbers.records:
        if each.quantity in _SIDES:
            sides.setdefault((each.module, each.of), {})[each.quantity] = each.value
    named = {
        key: f"{max(each, key=lambda side: each[side])}, from the file"
        for key, each in sides.items()
    }
    titles = {
        (module, of): name(Figure(words, 0.0, of=of, module=module))
        for (module, of), words in named.items()
    }
    return {(module, ""): title for (module, _), title in titles.items()} | titles


def group(figure: Figure) -> str:
    """Of GROUPS the one that a figure belongs to."""
    if figure.kind:
        return FROM_FILES
    return _GROUP_OF.get(figure.quantity) or _GROUP_OF_UNIT.get(figure.unit, MOTION)


def name(figure: Figure) -> str:
    """What a person reads: "motion error {of}" is "Motion error: pen"."""
    words = _EXTREME.sub(_extreme, NAMES.get(figure.quantity, figure.quantity))
    words = words.format(of=figure.of, joint=figure.joint).replace("_", " ").strip(" :")
    words = f"{figure.module.replace('_', ' ')} {words}".strip()
    return words if words[1:2] in "₁₂" else words[:1].upper() + words[1:]


def _extreme(found: re.Match[str]) -> str:
    """ " min" and " max at" as people say it: ", least" and ", where greatest"."""
    size = "least" if found[1] == "min" else "greatest"
    return f", where {size}" if found[2] else f", {size}"


def sentence(text: str) -> str:
    """A message as a person reads it: a number in it that is only rounding, such as 1.421e-14, is 0."""
    return _ROUNDING.sub("0", text)


def rounded(value: float, digits: int = 4) -> str:
    """A value with so many digits, 0 for what is only rounding; thousands parted, no exponent, a true minus."""
    if math.isnan(value):
        return "–"
    if math.isinf(value):
        return "∞" if value > 0 else "−∞"
    if abs(value) < NOISE or value == 0:
        return "0"
    places = digits - 1 - math.floor(math.log10(abs(value)))
    value = round(value, places)
    if abs(value) < 1e-4:
        power = math.floor(math.log10(abs(value)))
        raised = str(power).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
        return (
            f"{value / 10.0**power:.{min(digits, 3) - 1}f}".rstrip("0")
            .rstrip(".")
            .replace("-", "−")
            + f"·10{raised}"
        )
    text = f"{value:,.{max(0, places)}f}"
    text = text.rstrip("0").rstrip(".") if "." in text else text
    return text.replace(",", " " if abs(value) >= 10_000 else "").replace("-", "−")
