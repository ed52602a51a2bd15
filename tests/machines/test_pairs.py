"""Air and preload of conjugate pairs, from their files: play of a known size, no false overlap, and wrong cams by name."""

from __future__ import annotations

import math
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from judged import wrong
from test_linkage_bodies import cam_rocker

from camgen import build
from camgen.errors import SpecError
from camgen.machine.model import Cam
from camgen.machine.run import solve
from camgen.machines.pairs import remarks
from camgen.pipeline import build as pipeline
from camgen.tolerance.report import PrintRun, tolerance

SPECS = Path(__file__).parents[2] / "specs"
FLAT = ('geometry.follower={motion="translating",shape="flat"}', "limits.least_radius=1")
PAIR = ('geometry.closure="conjugate"', "name='c'", "accuracy.chord_tolerance=0.002")


def made(folder: Path, *settings: str) -> Any:
    return pipeline.build(SPECS / "disc-cam.toml", folder, frozenset({"dxf"}), settings)


def lash(report: Any) -> float:
    (found,) = [finding.measured for finding in report.findings if finding.code == "LASH"]
    return float(found)


@pytest.mark.long
def test_air_is_play_of_twice_its_size(tmp_path: Path) -> None:
    """A face moves along its normal: 0.1 mm on either side is 0.2 mm of way, and the motion is that of the middle."""
    report = made(tmp_path, *PAIR, *FLAT, "geometry.tip_clearance=0.1")
    assert report.ok, [finding for finding in report.findings if not finding.ok]
    assert lash(report) == pytest.approx(0.2, abs=0.004)
    assert [f.measured < 0.0021 for f in report.findings if f.code == "MOTION_ERROR"] == [
        True,
        True,
    ]


@pytest.mark.long
def test_preload_is_no_play_and_no_fault(tmp_path: Path) -> None:
    """Of a roller straight above its shaft the pressure angle is 0 in the dwells: there both tips give way by 0.05 mm each."""
    report = made(tmp_path, *PAIR, "geometry.tip_clearance=-0.05")
    assert report.ok, [finding for finding in report.findings if not finding.ok]
    assert lash(report) == 0 and report.numbers["preload_dxf_mm"] == pytest.approx(0.1, abs=0.004)
    assert any(left.code == "HERTZ" and "preload" in left.why for left in report.not_judged)
    loose = tmp_path / "loose"
    made(loose, *PAIR, "geometry.tip_clearance=0.05")
    shutil.copy(loose / "c" / "c-cam-2.dxf", tmp_path / "c" / "c-cam-2.dxf")
    found = wrong(tmp_path / "c", "dxf")
    assert any(
        f.code == "MOTION_ERROR" and "c-cam-2.dxf" in str(f.where) and f.measured > 0.09
        for f in found
    )


def test_what_a_preload_presses_with_at_most() -> None:
    """By hand: two arms of l, k each, bend until both tips give way by d: F l cos a = k d / (l cos a), a the pressure angle."""
    found = pipeline.read_mechanism(
        SPECS / "uniform-swing.toml", ["geometry.tip_clearance=-0.1"]
    ).resolved()
    forces = solve(found.model, np.linspace(0, math.tau, 9)).forces()
    _, (left,) = remarks(forces, found.model, found.assembly.outlines, 100.0)
    said = float(left.why.partition("(")[2].partition(" N")[0])
    (cam,) = (joint for joint in found.model.joints if isinstance(joint, Cam))
    arm, steep = (
        abs(cam.touches[0].cam.follower.arm),
        max(f.measured for f in found.limits() if f.code == "PRESSURE_ANGLE"),
    )
    least = 100e3 * 0.1 / arm**2
    assert least < said <= 1.01 * least / math.cos(math.radians(steep)) ** 2
    assert "N at a tip" not in remarks(forces, found.model, found.assembly.outlines)[1][0].why


@pytest.mark.long
def test_air_of_a_pair_in_a_linkage(tmp_path: Path) -> None:
    """On an arm of hypot(30, 25) mm the play is 2 x 0.05 mm over it at least, over its share across the outline at most."""
    spec = {
        "mechanism": "linkage",
        "name": "own",
        "drive": {"link": "crank", "speed_rpm": 60},
        **cam_rocker(closure="conjugate", tip_clearance=0.05),
    }
    report = build(spec, tmp_path, "dxf")
    assert report.ok, [finding for finding in report.findings if not finding.ok]
    least = math.degrees(0.1 / math.hypot(30, 25))
    steep = math.radians(max(f.measured for f in report.findings if f.code == "PRESSURE_ANGLE"))
    assert least < report.numbers["lash_dxf_deg"] < least / math.cos(steep) + 0.01


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        (("geometry.closure='force'", "geometry.tip_clearance=0.1"), "two tips"),
        (
            (
                "geometry.closure='conjugate'",
                "geometry.tip_clearance=-0.5",
                "geometry.follower.radius=0.4",
            ),
            "at least -0.4",
        ),
    ],
)
def test_air_that_cannot_be(settings: tuple[str, ...], said: str, tmp_path: Path) -> None:
    with pytest.raises(SpecError, match=said):
        made(tmp_path, *settings)


def test_the_air_that_copies_ask_for_frees_them() -> None:
    """What 99 of 100 copies of the pair without air ask for, typed as its air, is what 99 of 100 hold with."""
    few = ("print.size_error=0.05",)
    needed = tolerance(SPECS / "uniform-swing.toml", few, PrintRun(20_000, 1, 0)).numbers[
        "tip_clearance_99_percent_contact_mm"
    ]

    def holds(air: float, code: str) -> float:
        settings = (*few, f"geometry.tip_clearance={air}")
        found = tolerance(SPECS / "uniform-swing.toml", settings, PrintRun(20_000, 2, 0))
        (table,) = [each for each in found.tables if each.title == "Yield of play and fits alone"]
        (row,) = [row for row in table.rows if row[0] == code and "contact" in str(row[1])]
        return float(str(row[-1]))

    assert holds(needed, "INTERFERENCE") == pytest.approx(99, abs=0.4)
    assert holds(-needed, "LASH") == pytest.approx(
        99, abs=0.8
    )  # as much preload is left in as many, nearly: errors have no sign
