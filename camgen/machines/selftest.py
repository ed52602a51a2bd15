"""Published constants beside those that this installation computes: trust in a second."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from camgen.machine.closed_form import four_bar, slider_travel, transmission_extremes
from camgen.machines import papers
from camgen.machines.papers import Row as Row
from camgen.motion.laws import (
    LAWS,
    MR_13_COSINES,
    MR_13_SINES,
    UNIFORM,
    Law,
    end_speed,
    largest,
    modified_sine,
)
from camgen.motion.program import Program, Segment, uniform_swing
from camgen.motion.tasks import REST, End, law_for
from camgen.numerics import peak

# C_v, C_a, C_j inside the segment, jerk at the crossover, largest |v a|.   [VDI 2143; Norton]
_LAWS = {
    "parabolic": "2.0000 4.0000 - - 8.000",
    "simple-harmonic": "1.5708 4.9348 15.503 -15.503 3.876",
    "cubic": "1.5000 6.0000 12.000 -12.000 3.464",
    "cycloidal": "2.0000 6.2832 39.478 -39.478 8.162",
    "modified-trapezoid": "2.0000 4.8881 61.426 -61.426 8.090",
    "modified-sine": "1.7596 5.5280 69.466 -23.155 5.458",
    "3-4-5": "1.8750 5.7735 60.000 -30.000 6.694",
    "4-5-6-7": "2.1875 7.5132 52.500 -52.500 10.750",
    "modified-sine-20": "1.5275 5.9986 94.23 0.000 5.14",
}
# C_v, C_a, C_a*, C_j, C_M between other ends at lambda 1/2.   [closed forms of VDI 2143, worked out with 30 digits elsewhere]
_TASKS = {
    ("harmonic-combination", "RU"): "1.65984793 5.21456606 5.21456606 65.5281698 4.85647193",
    ("modified-trapezoid", "RU"): "1.8482935 4.5173437 4.5173437 56.7666151 6.90922576",
    ("simple-harmonic", "UU"): "1.57079633 4.9348022 4.9348022 15.5031383 3.87578459",
}
# Peaks of v, a, j: 1 in up and down over 90 deg each at 2 pi rad/s, dwells between.   [Norton's running example]
_DOUBLE_DWELL = {
    "simple-harmonic": "6.283 78.96",
    "cycloidal": "8.000 100.53 2526.6",
    "modified-trapezoid": "8.000 78.21 3931",
    "modified-sine": "7.038 88.45 4446",
    "3-4-5": "7.500 92.38 3840",
    "4-5-6-7": "8.750 120.21 3360",
}


def rows() -> Iterator[Row]:
    """Every constant, in groups, recomputed from the formulas; of a law that no table prints, what its own record claims."""
    for name in dict.fromkeys((*_LAWS, *LAWS)):
        law = LAWS[name] if name in LAWS else modified_sine(0.2)
        claims = (law.c_v, law.c_a, law.c_j)
        own = " ".join(f"{claim:.4f}" if math.isfinite(claim) else "-" for claim in claims)
        published = _LAWS.get(name, own)
        labels = ("C_v", "C_a", "C_j", "j(1/2)", "|v a|")
        values = (*(_peak(law, order) for order in (1, 2, 3)), float(law(0.5, 3)), law.c_m)
        for label, text, value in zip(labels, published.split(), values, strict=False):
            if text != "-":
                yield Row(f"{name} {label}", text, value)
    yield from _tasks()
    for name, published in _DOUBLE_DWELL.items():
        for order, text in enumerate(published.split(), start=1):
            value = _double_dwell_peak(LAWS[name], order)
            yield Row(f"double dwell, {name} {'vaj'[order - 1]}", text, value)
    yield from _mr_13()
    yield from _linkages()
    yield from papers.rows()


def _tasks() -> Iterator[Row]:
    """Laws that end in a reversal, their peaks looked for in their formulas."""
    for (name, task), published in _TASKS.items():
        start, end = (End("U", a=None) if letter == "U" else REST for letter in task)
        law = law_for(name, start, end)
        values = (_peak(law, 1), *law.accelerations, _peak(law, 3), law.c_m)
        labels = ("C_v", "C_a", "C_a*", "C_j", "C_M")
        for label, text, value in zip(labels, published.split(), values, strict=True):
            yield Row(f"{name} {task} {label}", text, value)


def _peak(law: Law, order: int) -> float:
    return largest(lambda u: law(u, order), law.breaks)


def _double_dwell_peak(law: Law, order: int) -> float:
    """Peak of a derivative to time at one turn a second."""
    quarter = math.pi / 2
    program = Program(
        (
            Segment("dwell", quarter, 0.0, 0.0, UNIFORM),
            Segment("rise", quarter, 0.0, 1.0, law),
            Segment("dwell", quarter, 1.0, 0.0, UNIFORM),
            Segment("return", quarter, 1.0, -1.0, law),
        )
    )
    joints = [float(j) for j in (program.joints / math.tau)[1:-1]]
    return largest(lambda u: program(math.tau * u, order), joints) * math.tau**order


def _mr_13() -> Iterator[Row]:
    """Closure and peaks of the law MR-13, on the card's 61 positions and between them."""
    law = LAWS["mr-13"]
    misprinted = (*MR_13_SINES[:-1], -MR_13_SINES[-1])
    yield Row("mr-13 speed at its ends", "2.8e-8", abs(end_speed(MR_13_SINES, MR_13_COSINES)))
    off = abs(end_speed(misprinted, MR_13_COSINES))
    yield Row("mr-13 speed at its ends, A6 as printed", "1.6e-3", off)
    yield Row("mr-13 c(0)", "2.550126", float(law(0.0, 2)))
    kappa = np.arange(61) / 60
    b = law(kappa, 1)
    c = law(kappa, 2)
    for label, text, curve in (
        ("|b|", "1.8917", b),
        ("|c|", "6.1487", c),
        ("|b c|", "8.0202", b * c),
    ):
        yield Row(f"mr-13 {label} of 61 positions", text, peak(curve))
    yield Row("mr-13 |b c|", "8.0491", law.c_m)


def _linkages() -> Iterator[Row]:
    """Closed forms of the eccentric (e = 1.5, rod 48) and of the thread take-up's four-bar (9, 30, 19, 30)."""
    for angle, text in ((30, "0.206821627"), (90, "1.523443225"), (180, "3.000000000")):
        travel = float(slider_travel(math.radians(angle), 1.5, 48.0))
        yield Row(f"eccentric, travel at {angle} deg", text, travel)
    bars = (9.0, 30.0, 19.0, 30.0)
    least, greatest = (math.degrees(angle) for angle in transmission_extremes(*bars))
    yield Row("four-bar, transmission angle at 0 deg", "44.0034273489", least)
    yield Row("four-bar, transmission angle at 180 deg", "103.1834814862", greatest)
    yield Row("four-bar, Grashof margin", "10.000", four_bar(*bars).margin)
    speed = float(uniform_swing(math.radians(30))(1.0, 1))
    yield Row("uniform swing of 30 deg, speed ratio", "6.000", 1 / speed)


def to_text(results: Sequence[Row]) -> str:
    """The rows as a table, and what they come to."""
    lines = [f"{'constant':<52}{'published':>14}{'here':>16}  verdict"]
    for row in results:
        ours = 0.0 if abs(row.ours) < 1e-12 else row.ours  # rounding
        lines.append(f"{row.what:<52}{row.published:>14}{ours:>16.10g}  {row.verdict}")
    off = sum(not row.ok for row in results)
    refuted = sum(bool(row.refuted) for row in results)
    undecided = sum(bool(row.undecided) for row in results)
    agree = (
        f"{len(results) - refuted - undecided} constants agree; {refuted} printed values are refuted, "
        f"{undecided} cannot be decided from their sources"
    )
    return "\n".join([*lines, f"{off} of {len(results)} constants are OFF" if off else agree])
