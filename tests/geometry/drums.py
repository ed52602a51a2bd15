"""The drums of tests/reference/drums.toml."""

from __future__ import annotations

import math
import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

from camgen.geometry.drum_walls import DrumRoller, slide_path, swing_path
from camgen.geometry.drums import Drum
from camgen.geometry.mesh import Mesh
from camgen.geometry.outlines import circle
from camgen.motion.program import Program
from camgen.motion.segments import SegmentTable, program
from camgen.parts.part import Part, drum_part
from camgen.parts.solids import solid

REFERENCE: dict[str, Any] = tomllib.loads(
    (Path(__file__).parents[1] / "reference" / "drums.toml").read_text(encoding="utf-8")
)


def rise_and_return(lift: float, span_deg: float = 120, unit: float = 1.0) -> Program:
    """Rise, dwell of 60 deg, return, dwell: cycloidal."""
    rows = [
        SegmentTable(kind="rise", span_deg=span_deg, lift=lift, law="cycloidal"),
        SegmentTable(kind="dwell", span_deg=60),
        SegmentTable(kind="return", span_deg=120, lift=lift, law="cycloidal"),
        SegmentTable(kind="dwell"),
    ]
    return program(rows, unit)


def lopsided() -> Program:
    """A rise that a mirror image shows: 3-4-5 of 15 mm in 100 deg, dwell 40, cycloidal return in 160."""
    rows = [
        SegmentTable(kind="rise", span_deg=100, lift=15, law="3-4-5"),
        SegmentTable(kind="dwell", span_deg=40),
        SegmentTable(kind="return", span_deg=160, lift=15, law="cycloidal"),
        SegmentTable(kind="dwell"),
    ]
    return program(rows)


A = Drum(30, 21.5, 55, "groove", slide_path(rise_and_return(15), 20), DrumRoller(5, 26))
C = replace(A, roller=DrumRoller(5, 26, 5 / 26))
END = replace(A, track="end")
RIB = replace(A, track="rib", pitch=REFERENCE["rib"]["pitch"])
OFFSET = replace(A, path=slide_path(lopsided(), 20, 3.0))

ARM = 40.0
SWING = math.radians(10)
PIVOT = ARM * (1 + math.cos(SWING)) / 2
_SWINGS = rise_and_return(20, unit=math.radians(1))


def swings(theta: Any, order: int) -> Any:
    """Angle of B's arm."""
    return _SWINGS(theta, order) - (SWING if order == 0 else 0.0)


B = replace(A, path=swing_path(swings, ARM, PIVOT, 27))


def bored(drum: Drum) -> Part:
    """The drum on a shaft of 12 mm."""
    return drum_part("drum", "Drum", drum, circle(0j, 6))


def mesh_of(drum: Drum, tolerance: float) -> Mesh:
    """Its solid with that bore."""
    return solid(bored(drum), tolerance)
