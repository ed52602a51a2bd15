"""Measured outlines held against the spec of the cam: points and scans of the exact cam, or of one off by a known way."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from scans import FOLLOWER, SPECS, Glass, cam, saved

from camgen.cli import main
from camgen.geometry.rings import Points

SPEC = SPECS / "uniform-swing.toml"


def run(
    capsys: pytest.CaptureFixture[str], path: Path, *more: object
) -> tuple[int, dict[str, Any], str]:
    arguments = ["motion", path, "--follower", FOLLOWER, "-o", path.parent, *more, "--json"]
    with pytest.raises(SystemExit) as done:
        main([*map(str, arguments)])
    out, err = capsys.readouterr()
    assert "Traceback" not in out + err
    return int(done.value.code or 0), json.loads(out), err


def outline(step: float = 0.2, grown: float = 0.0) -> Points:
    """Places round the exact cam, its wall moved outwards by so much, mm."""
    z = cam()[0][0]
    edge = (
        shapely.Polygon(np.column_stack([z.real, z.imag])).buffer(grown, quad_segs=64).exterior
        if grown
        else (shapely.Polygon(np.column_stack([z.real, z.imag])).exterior)
    )
    places = edge.interpolate(np.arange(0, edge.length, step))
    return np.asarray(shapely.get_x(places) + 1j * shapely.get_y(places))


def points(path: Path, z: Points) -> Path:
    path.write_text("x,y\n" + "\n".join(f"{p.real:.5f},{p.imag:.5f}" for p in z), encoding="utf-8")
    return path


@pytest.mark.long
@pytest.mark.parametrize("over", [False, True])
def test_place_and_turn_of_points_are_found(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], over: bool
) -> None:
    z = outline()
    z += np.random.default_rng(1).normal(0, 0.001, len(z))
    z = np.exp(2.1j) * (-np.conj(z) if over else z) + 300 - 80j
    code, report, _ = run(capsys, points(tmp_path / "p.csv", z), "--against", SPEC)
    numbers = report["numbers"]
    assert code == 0
    wanted = np.degrees(2.1) if over else -np.degrees(2.1)  # within half a turn either way
    assert numbers["fit_turn_deg"] == pytest.approx(wanted, abs=0.005)
    assert numbers["motion_error_max_deg"] < 0.02 and numbers["deviation_rms_mm"] < 0.0015
    assert ("turned over" in report["notes"][0]) == over
    with open(tmp_path / "p-motion" / "motion.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    errors = np.array([float(row["error_deg"]) for row in rows])  # of every fifth sample
    assert np.abs(errors).max() <= numbers["motion_error_max_deg"] * (1 + 1e-6)
    assert np.sqrt(np.mean(errors**2)) == pytest.approx(numbers["motion_error_rms_deg"], rel=0.02)
    assert (
        max(
            abs(float(row["swing_deg"]) - float(row["wanted_deg"]) - float(row["error_deg"]))
            for row in rows
        )
        < 1e-8
    )


@pytest.mark.long
def test_a_wall_that_swelled_is_told_with_its_remedy(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    _, report, _ = run(capsys, points(tmp_path / "p.csv", outline(grown=0.05)), "--against", SPEC)
    assert report["numbers"]["deviation_rms_mm"] == pytest.approx(0.05, abs=0.002)
    assert "profile_compensation = 0.050" in report["notes"][0]


@pytest.mark.long
def test_a_seam_stays_where_it_is(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    z = outline()
    z[100:104] *= 1 + 0.2 / np.abs(z[100:104])
    numbers = run(capsys, points(tmp_path / "p.csv", z), "--against", SPEC)[1]["numbers"]
    assert numbers["deviation_max_mm"] == pytest.approx(0.2, abs=0.04)
    assert numbers["deviation_min_mm"] > -0.03


@pytest.mark.long
def test_one_scan_and_the_known_outline_undo_the_scanner(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = saved(
        tmp_path / "cam.png",
        cam()[0],
        Glass(across=1.003, shear=np.tan(np.radians(1)), turn_deg=20),
    )
    numbers = run(capsys, path, "--against", SPEC)[1]["numbers"]
    assert numbers["motion_error_max_deg"] < 0.012
    assert numbers["scanner_across_percent"] == pytest.approx(0.315, abs=0.01)
    assert numbers["bore_off_centre_mm"] < 0.002 and "scanner_off_mm" not in numbers


@pytest.mark.long
def test_two_scans_keep_what_the_print_shrank(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A print 0.5 % too small, scanned true to size: a scan that is turned and a caliper show it, the outline alone hides it."""
    small = tuple(edge * 0.995 for edge in cam()[0])
    first, second = (
        saved(tmp_path / f"{turn}.png", small, Glass(dpi=300, turn_deg=turn)) for turn in (0, 90)
    )
    width = max(float(np.abs(small[0] - z).max()) for z in small[0])
    shown = run(capsys, first, "--second-scan", second, "--across", width, "--against", SPEC)[1][
        "numbers"
    ]
    hidden = run(capsys, first, "--against", SPEC)[1]["numbers"]
    notes = run(capsys, first, "--second-scan", second, "--against", SPEC)[1]["notes"][0]
    assert (
        "no compensation for [print]" in notes and "profile_compensation" not in notes
    )  # without a caliper
    assert shown["deviation_min_mm"] < -0.15 and shown["motion_error_max_deg"] > 0.05
    assert shown["bore_deviation_mm"] == pytest.approx(-0.025, abs=0.005)
    assert (
        hidden["scale_percent"] == pytest.approx(-0.5, abs=0.02)
        and hidden["deviation_rms_mm"] < 0.01
    )


@pytest.mark.long
@pytest.mark.parametrize(
    "more, words",
    [
        (["--against", SPECS / "disc-cam.toml"], "the cam nearest to it"),
        (["--against", SPECS / "eccentric-drive.toml"], "the spec of a machine with a cam"),
        (["--against", "none.toml"], "none.toml"),
        (["--dpi", "600"], "expected a scan, .png"),
        (
            ["--against", SPEC, "--second-follower", FOLLOWER.replace("-153", "153")],
            "one follower, on the outside",
        ),
    ],
)
def test_what_it_cannot_be_held_against(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], more: list[object], words: str
) -> None:
    path = points(tmp_path / "p.csv", outline(1.0))
    with pytest.raises(SystemExit) as done:
        main([*map(str, ["motion", path, "--follower", FOLLOWER, "-o", tmp_path, *more])])
    assert done.value.code in (2, 3, 4) and words in capsys.readouterr().err
    assert [each.name for each in tmp_path.iterdir()] == ["p.csv"], "nothing half written"
