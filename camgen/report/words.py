"""Names and units that people read, for the figures that a machine gives under keys such as peak_speed_mm_s."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field

# Units as suffixes of a figure's key, the longest first.
UNITS = {
    "mpa_m_s": "MPa m/s",
    "n_m_per_rad": "N m/rad",
    "n_rad_s": "N rad/s",
    "n_m_s": "N m s",
    "deg_rad2": "deg/rad²",
    "mm_rad2": "mm/rad²",
    "deg_rad": "deg/rad",
    "mm_rad": "mm/rad",
    "kg_m2": "kg m²",
    "n_mm": "N/mm",
    "g_mm": "g mm",
    "n_m": "N m",
    "mm_s2": "mm/s²",
    "deg_s2": "deg/s²",
    "rad_s": "rad/s",
    "mm_s": "mm/s",
    "deg_s": "deg/s",
    "per_s": "1/s",
    "mm3": "mm³",
    "mm2": "mm²",
    "percent": "%",
    "mm": "mm",
    "deg": "deg",
    "rpm": "rpm",
    "mpa": "MPa",
    "hz": "Hz",
    "n": "N",
    "j": "J",
    "w": "W",
    "h": "h",
    "g": "g",
    "s": "s",
}

# What quantities are called that a machine gives, where their keys do not say it in full.
NAMES = {
    "clearance_band": "worst case of the joints' play",
    "motion_error": "motion error",
    "tip_motion_error": "motion error of the tip alone",
    "stroke_recovered": "stroke, from the file",
    "swing_recovered": "swing, from the file",
    "index_recovered": "indexing, from the file",
    "lash": "free play of the follower",
    "canvas_share_round": "canvas within 10 %, round collector",
    "canvas_share_flat": "canvas within 10 %, flat collector",
    "mass": "mass of what is printed",
    "print_time": "time to print all",
    "index": "indexing",
    "let_down": "payout angle",
    "let_down_ratio": "payout ratio",
    "peak_speed_angle": "angle of the peak speed",
    "wear": "wear, force times speed",
    "swing_by_play_of_axle": "swing by the play of the axle",
    "uniform_share": "share of uniform motion",
    "residual_share": "share of the shaking force left",
    "supports": "area that needs supports",
    "pv_greatest": "pressure times speed of bearings, greatest",
    "hertz_pressure": "Hertz pressure",
    "flywheel_for_2_percent": "flywheel for a speed within 2 %",
    "flywheel_for_10_percent": "flywheel for a speed within 10 %",
    "balance_weight_at": "direction of the balance weight",
    "balance_spring_at": "direction of the balance spring",
    "print_error": "off by print errors",
    "source_r": "R of the source, AC",
    **{
        f"source_{sign}_{k}": f"{word}{'₁₂'[k - 1]} of the source"
        for k in (1, 2)
        for sign, word in (("r", "r"), ("alpha", "α"), ("beta", "β"))
    },
}

# Groups of figures, each with what its keys hold, in the order of the page; the first that matches counts.
GROUPS = (
    (
        "From the files",
        r"motion_error|clearance|recovered|lash|canvas_share|tip_radius|_dxf|_stl|_3mf|_step(?=_|$)",
    ),
    ("Making", r"^mass|print_time|supports|shaft_length|area|outline|section"),
    (
        "Forces and drive",
        r"torque|force|reaction|energy|inertia|"
        r"hertz|^pv|friction|drive|flywheel|balance|vibration|bearing_life|acceleration_factor|lift_off|follower_freq|"
        r"kick|spring|wear|weight|shaking|harmonic|residual",
    ),
    ("Shape and contact", r"radius|profile|pressure|undercut|curvature|wall|tip_on"),
    ("Motion", r""),
)

KINDS = ("dxf", "stl", "3mf", "step")  # of files that are measured
NOISE = 1e-9  # what is less counts as 0: lengths are known to some nanometres at best


@dataclass
class Figure:
    """A figure as it is shown: name, unit, value, or one value for each kind of file that it was measured in."""

    name: str
    unit: str
    group: str
    values: dict[str, float] = field(default_factory=dict)


def figures(numbers: Mapping[str, float]) -> list[Figure]:
    """The figures of a report, those of the kinds of files side by side."""
    found: dict[tuple[str, str], Figure] = {}
    for key, value in numbers.items():
        suffix = next((unit for unit in UNITS if key.endswith("_" + unit)), "")
        stem = key.removesuffix("_" + suffix) if suffix else key
        kind = next((kind for kind in KINDS if re.search(rf"_{kind}(?=_|$)", stem)), "")
        stem = re.sub(rf"_{kind}(?=_|$)", "", stem) if kind else stem
        group = next(name for name, pattern in GROUPS if re.search(pattern, key))
        figure = found.setdefault((stem, suffix), Figure(name(stem), UNITS.get(suffix, ""), group))
        figure.values[kind] = float(value)
    return list(found.values())


def name(stem: str) -> str:
    """Words for a key without unit and kind: motion_error_pen is "motion error: pen"."""
    known = max((k for k in NAMES if stem == k or stem.startswith(k + "_")), key=len, default="")
    words = (
        NAMES[known] + ": " + stem[len(known) + 1 :]
        if known and known != stem
        else NAMES.get(stem, stem)
    )
    words = re.sub(r"_(max|greatest)_at$", ", where greatest", words)
    words = re.sub(r"_(min|least)_at$", ", where least", words)
    words = re.sub(r"_(max|greatest)$", ", greatest", words)
    words = re.sub(r"_(min|least)$", ", least", words)
    words = re.sub(r"within (\d+) (\d+)", r"within \1.\2", words.replace("_", " "))
    if re.search(r"\b(reaction|wear)\b", words):  # of a joint, whose point has a capital letter
        words = re.sub(r"\b[a-w]\b", lambda letter: letter[0].upper(), words)
    return words if words[1:2] in "₁₂" else words[:1].upper() + words[1:]


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
