"""The timing diagram: curves at their angles, ends of motions, one sheet in two formats."""

from __future__ import annotations

import re
from pathlib import Path

import ezdxf
import numpy as np
import pytest

from camgen.files.sheet import Stroke, Text
from camgen.files.timing import Motion, timing_sheet, write_timing
from camgen.files.title_block import Facts
from camgen.machines.sources import read_mechanism
from camgen.pipeline.drawings import timing_of

SPECS = Path(__file__).resolve().parents[2] / "specs"
DEGREES = np.linspace(0, 360, 1441)


def lift(name: str, begin: float, end: float, high: float) -> Motion:
    """At rest but from one angle to another, deg, where it is a hump."""
    share = np.clip((DEGREES - begin) / (end - begin), 0, 1)
    rate = np.where((share > 0) & (share < 1), np.sin(2 * np.pi * share), 0.0)
    return Motion(name, "mm", DEGREES, high * (1 - np.cos(2 * np.pi * share)) / 2, rate)


def test_where_a_follower_begins_and_ends_to_move() -> None:
    ends = lift("a", 30, 150, 5).ends
    assert (ends[0], ends[-1]) == pytest.approx((30, 150), abs=0.26)
    still = Motion("b", "mm", DEGREES, 0 * DEGREES, 0 * DEGREES)
    assert still.ends == []


def test_strips_lie_below_each_other_and_peaks_above_their_angles() -> None:
    sheet = timing_sheet("demo", [lift("first", 0, 180, 5), lift("second", 180, 360, 2)], Facts())
    curves = [each for each in sheet.primitives if isinstance(each, Stroke) and each.layer == "CUT"]
    points = [np.array([piece.a for piece in curve.pieces]) for curve in curves]  # type: ignore[union-attr]
    marks = {
        each.text: each.at.real
        for each in sheet.primitives
        if isinstance(each, Text) and each.align == "centre"
    }
    for line, degrees in zip(points, ("90°", "270°"), strict=True):
        assert line[np.argmax(line.imag)].real == pytest.approx(marks[degrees], abs=0.2)
    assert points[0].imag.min() > points[1].imag.max()
    inside = np.concatenate(points)
    assert inside.real.min() > 20 and inside.real.max() < 287 and inside.imag.min() > 46


def test_both_formats_say_the_same(tmp_path: Path) -> None:
    motions = [lift(name, 20, 200, 3) for name in ("in", "out")]
    dxf, pdf = write_timing(tmp_path, "demo", motions, Facts("linkage", revision="C"))
    doc = ezdxf.readfile(dxf)
    assert not doc.audit().errors
    texts = [each.dxf.text.replace("%%d", "°") for each in doc.modelspace().query("TEXT")]
    content = pdf.read_bytes().decode("cp1252")
    said = re.findall(r"Tm \((.*)\) Tj", content)
    assert [re.sub(r"\\260", "°", line) for line in said] == texts
    assert {"in", "out", "Timing diagram", "0", "3", "mm, at 0°: 0", "Revision", "C"} <= set(texts)


def test_a_machines_cams_are_those_of_its_model() -> None:
    machine = read_mechanism(SPECS / "stitch-head.toml")
    motions = timing_of(machine)
    assert [motion.name for motion in motions] == ["lower_cam", "upper_cam"]
    for motion in motions:
        assert motion.stroke[0] == pytest.approx(motion.stroke[-1])
        slope = np.gradient(motion.stroke, DEGREES)
        assert np.allclose(motion.rate[5:-5], slope[5:-5], atol=2e-5 * np.ptp(motion.stroke))


def test_a_curve_that_starts_between_its_ends_has_its_zero_and_its_start() -> None:
    """A sine of 8 mm about 5 mm: it starts at 5, and its 0 lies three sixteenths above its least, -3."""
    stroke = 5 + 8 * np.sin(np.radians(DEGREES))
    motion = Motion("swing", "mm", DEGREES, stroke, 8 * np.cos(np.radians(DEGREES)))
    assert motion.levels == pytest.approx([-3, 0, 5, 13])
    sheet = timing_sheet("demo", [motion], Facts())
    strokes = [each for each in sheet.primitives if isinstance(each, Stroke)]
    curve = next(each for each in strokes if each.layer == "CUT")
    points = np.array([piece.a for piece in curve.pieces])  # type: ignore[union-attr]
    low, high = points.imag.min(), points.imag.max()
    axes = [
        piece.a.imag  # type: ignore[union-attr]
        for each in strokes
        if each.layer == "CENTER"
        for piece in each.pieces
        if abs(piece.b - piece.a) > 100  # type: ignore[union-attr]
    ]
    assert axes == pytest.approx([low + 3 / 16 * (high - low)], abs=0.01)
    texts = {each.text for each in sheet.primitives if isinstance(each, Text)}
    assert {"-3", "0", "5", "13", "mm, at 0°: 5"} <= texts
