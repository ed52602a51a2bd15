"""Figures of many cams at once are those that each cam finds by itself, by another search; where one cannot tell, it does not."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from camgen.machine.cams.many import figures_of
from camgen.machine.cams.profile import DiscCam
from camgen.machines.disc_cam.mechanism import DiscCamDrive
from camgen.machines.sources import read_mechanism
from camgen.sweep.run import Row, Task, rows_of, task_of
from camgen.sweep.variants import variants

SPEC = Path(__file__).resolve().parents[3] / "specs" / "disc-cam.toml"
ARM = "geometry.follower.motion='oscillating'"
NO_RADIUS = "geometry.follower.radius="
KINDS = {
    "roller": (
        [],
        [
            "geometry.base_radius=4:40",
            "geometry.follower.offset=-8:8",
            "geometry.follower.radius=1:8",
            "segment.0.lift=3:20",
            "segment.0.law=cycloidal,modified-sine,polynomial-345",
            "motor.speed_rpm=-60,60",
        ],
    ),
    "knife": (
        ["geometry.follower.shape='knife'", NO_RADIUS],
        ["geometry.base_radius=4:40", "geometry.follower.offset=-8:8"],
    ),
    "flat": (
        ["geometry.follower.shape='flat'", NO_RADIUS],
        ["geometry.base_radius=4:60", "geometry.follower.face_width=5:40"],
    ),
    "arm": (
        [ARM],
        [
            "geometry.base_radius=14:50",
            "geometry.follower.arm=40:70",
            "geometry.follower.pivot_distance=50:90",
        ],
    ),
    "face": (
        [ARM, "geometry.follower.shape='flat'", NO_RADIUS],
        [
            "geometry.base_radius=14:50",
            "geometry.follower.pivot_distance=50:90",
            "geometry.follower.face_offset=-5:5",
        ],
    ),
    "pair": (
        ["geometry.closure='conjugate'"],
        ["geometry.base_radius=14:50", "geometry.follower.radius=1:8"],
    ),
    "table": (
        ["segment.0.law={name='table', points=[[0,0],[20,1],[50,6],[80,11],[100,12]]}"],
        ["geometry.base_radius=14:50"],
    ),
    "breaks": (
        ["segment.0.law={name='modified-sine', constant_velocity=0.3}"],
        ["segment.0.lift=5:15"],
    ),
}


@pytest.mark.long
@pytest.mark.parametrize("kind", KINDS)
def test_variants_in_a_crowd_say_what_each_says_by_itself(kind: str) -> None:
    settings, vary = KINDS[kind]
    task = task_of(SPEC, variants(vary, latin=8, seed=3), settings, (), (), Path())
    for together, row in zip(
        rows_of(task, range(8)), (judged_alone(task, k) for k in range(8)), strict=True
    ):
        assert together.keys() == row.keys() and [
            together[key] for key in ("verdict", "fails", "reason")
        ] == [row[key] for key in ("verdict", "fails", "reason")]
        for name, value in row.items():
            assert together[name] == (
                pytest.approx(value, rel=1e-9, abs=1e-12) if isinstance(value, float) else value
            ), name


def judged_alone(task: Task, number: int) -> Row:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(DiscCamDrive, "prepare", classmethod(lambda cls, many: None))
        return rows_of(task, [number])[0]


def test_what_takes_more_than_formulas_is_left_to_each_cam() -> None:
    def cam(*settings: str) -> DiscCam[Any]:
        drive = read_mechanism(SPEC, settings)
        assert isinstance(drive, DiscCamDrive)
        return drive.cam

    usual = cam()
    spans = [f"segment.{k}.span_deg={span}" for k, span in enumerate((50, 10, 50, 250))]
    undercut = cam(
        "geometry.base_radius=8", "geometry.follower.radius=14", "segment.0.lift=25", *spans
    )
    kicked = cam("segment.0.law='uniform'")
    assert undercut.undercuts
    found = figures_of([usual, undercut, kicked, usual])
    assert [one is not None for one in found] == [True, False, False, True] and found[0] == found[3]


def test_a_limit_that_is_met_exactly_is_judged_by_each_cam() -> None:
    steep = read_mechanism(SPEC).study().numbers["pressure_angle_deg"]
    near, clear = (
        read_mechanism(SPEC, [f"limits.pressure_angle_deg={steep + by!r}"]) for by in (1e-9, 1e-3)
    )
    assert isinstance(near, DiscCamDrive) and isinstance(clear, DiscCamDrive)
    DiscCamDrive.prepare([near, clear])
    assert "steepest" in vars(clear.cam) and "steepest" not in vars(near.cam)
