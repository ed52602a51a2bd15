"""What verdicts say: the limit that was written, what was not judged, what a key does not act on, what was found."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from camgen.pipeline import KINDS, build, check
from camgen.report import Report

SPECS = Path(__file__).parent.parent / "specs"
ALL = frozenset(KINDS)
Make = Callable[..., Report]


@pytest.fixture
def make(tmp_path: Path) -> Make:
    """Builds a starter spec: name, kinds of files, settings."""

    def call(name: str, kinds: str, *settings: str) -> Report:
        return build(SPECS / f"{name}.toml", tmp_path, frozenset(kinds.split(",")), settings)

    return call


def test_wall_is_shown_with_the_limit_that_was_written(make: Make) -> None:
    # 6.6 mm is the least disc: 6.6 / 2 - 1.5 - 2 / 2 = 0.8 mm of wall
    report = make("eccentric-drive", "dxf,stl", "geometry.eccentric_diameter=6.6", "accuracy.chord_tolerance=0.01")
    walls = [finding for finding in report.findings if finding.code == "MIN_WALL"]
    assert {finding.limit for finding in walls} == {0.8} and all(finding.ok for finding in walls)
    thinnest = min(walls, key=lambda finding: finding.measured)
    assert 0.78 <= thinnest.measured < 0.8 and "0.02 mm" in thinnest.message  # two contours, each 0.01 mm off at most


def test_units_are_counted_faults(make: Make, tmp_path: Path) -> None:
    assert {(f.measured, f.limit) for f in make("disc-cam", "dxf").findings if f.code == "DXF_UNITS"} == {(0, 0)}
    drawing = tmp_path / "disc-cam" / "disc-cam-cam.dxf"
    drawing.write_text(drawing.read_text().replace("$INSUNITS\n 70\n4", "$INSUNITS\n 70\n1"))
    (told,) = (f for f in check(tmp_path / "disc-cam").findings if f.code == "DXF_UNITS")
    assert (told.ok, told.measured, told.limit) == (False, 1, 0) and "millimetres" in told.message
