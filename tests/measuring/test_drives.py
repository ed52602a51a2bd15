"""`camgen motion DRIVER --drives DRIVEN`: gears as other programs write them, sound and damaged."""

from __future__ import annotations

import csv
import json
import math
import sys
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from click.testing import CliRunner

import camgen
from camgen.cli import cli
from camgen.geometry.rings import Ring

sys.path.insert(0, str(Path(__file__).parents[1] / "judge"))
from pair_outlines import Wheel  # noqa: E402

RATIO = ["--ratio", "-12/30"]


def write(path: Path, ring: Ring, bore: float = 0.0) -> Path:
    """A polyline with bulges, and a bore."""
    drawing = ezdxf.new()
    drawing.header["$INSUNITS"] = 4
    space = drawing.modelspace()
    rows = zip(ring.points.tolist(), ring.bulges.tolist(), strict=True)
    space.add_lwpolyline(
        [(z.real, z.imag, 0, 0, bulge) for z, bulge in rows], format="xyseb", close=True
    )
    if bore:
        space.add_circle((0, 0), bore)
    drawing.saveas(path)
    return path


@pytest.fixture(scope="module")
def gears(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """pinion.dxf and wheel.dxf, the latter with a bore of more than half its size."""
    folder = tmp_path_factory.mktemp("gears")
    write(folder / "pinion.dxf", Wheel(2, 12).ring(), 4)
    write(folder / "wheel.dxf", Wheel(2, 30).ring(), 20)
    return folder


def call(folder: Path, *options: str) -> tuple[int, str]:
    """Exit code and what is printed, of the pinion that drives the wheel."""
    pinion = str(folder / "pinion.dxf")
    wheel = str(folder / "wheel.dxf")
    words = ["motion", pinion, "--drives", wheel, "-o", str(folder / "out"), *options]
    result = CliRunner().invoke(cli, words)
    assert result.exception is None or isinstance(result.exception, SystemExit)
    return result.exit_code, result.output


def report(folder: Path) -> dict[str, object]:
    """What was written."""
    text = (folder / "out" / "pinion-drives-wheel" / "report.json").read_text(encoding="utf-8")
    content: dict[str, object] = json.loads(text)
    return content


def test_a_pair_of_gears_is_followed_until_it_repeats(gears: Path) -> None:
    code, text = call(gears, "--distance", "42", *RATIO, "--tolerance", "0.001")
    assert code == 0, text
    with open(gears / "out" / "pinion-drives-wheel" / "motion.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == ["theta_deg", "driven_low_deg", "driven_high_deg"]
    assert len(rows) == 5 * 1440 + 1
    assert float(rows[-1]["theta_deg"]) == 1800
    assert float(rows[-1]["driven_low_deg"]) == pytest.approx(
        float(rows[0]["driven_low_deg"]) - 720, abs=1e-9
    )
    numbers = report(gears)["numbers"]
    assert isinstance(numbers, dict)
    backlash = math.degrees(2 * 0.04 * math.cos(math.radians(20)) / Wheel(2, 30).rb)
    assert numbers["play_least_deg"] == pytest.approx(backlash, rel=2e-3)
    assert numbers["play_most_deg"] == pytest.approx(backlash, rel=2e-3)
    assert 1e-5 < numbers["transmission_error_deg"] < 5e-4
    assert (gears / "out" / "pinion-drives-wheel" / "report.html").exists()


def test_an_error_above_the_tolerance_fails_and_names_the_place(gears: Path) -> None:
    code, text = call(gears, "--distance", "42", *RATIO, "--tolerance", "1e-6")
    assert code == 1
    assert "TRANSMISSION_ERROR" in text and "of the driver's outline" in text


def test_a_flank_that_is_off_by_20_um_is_seen_at_its_tooth(gears: Path) -> None:
    """Tooth 7 of the wheel, its falling flank thinner: only the bound that it makes changes, while it is in mesh."""
    ring = Wheel(2, 30).ring()
    tooth = len(ring.points) // 30
    rows = slice(7 * tooth + 13, 7 * tooth + 22)
    points = ring.points.copy()
    points[rows] *= np.exp(0.02j / np.abs(points[rows]) * -1)
    damaged = write(gears / "damaged.dxf", Ring(points, ring.bulges))
    sound = camgen.drives(gears / "pinion.dxf", gears / "wheel.dxf", 42.0, ratio=-12 / 30)
    off = camgen.drives(gears / "pinion.dxf", damaged, 42.0, ratio=-12 / 30)
    changes = [
        float(np.max(np.abs(getattr(off, side) - getattr(sound, side)))) * Wheel(2, 30).rb
        for side in ("low", "high")
    ]
    assert max(changes) == pytest.approx(0.02, rel=0.15)
    assert min(changes) < 1e-3
    sound_code, sound_text = call(gears, "--distance", "42", *RATIO, "--tolerance", "0.01")
    assert sound_code == 0, sound_text
    words = [str(gears / "pinion.dxf"), "--drives", str(damaged), "--distance", "42", *RATIO]
    for extra, code in (([], 1), (["--spring", "high"], 1), (["--spring", "low"], 0)):
        options = ["motion", *words, "--tolerance", "0.01", "-o", str(gears / "off"), *extra]
        result = CliRunner().invoke(cli, options)
        assert result.exit_code == code, (extra, result.output)
        assert not extra or "BACK_FLANK_ERROR" not in result.output


@pytest.mark.parametrize(
    "options, code, word",
    [
        (["--distance", "60"], 3, "they never touch"),
        (["--distance", "20"], 3, "overlap at every angle"),
        (["--distance", "-42"], 2, "above 0"),
        (["--distance", "nan"], 2, "above 0"),
        ([], 2, "one of both"),
        (["--distance", "42", "--slides", "0"], 2, "one of both"),
        (["--distance", "42", "--ratio", "nan"], 2, "no ratio"),
        (["--distance", "42", "--ratio", "0"], 2, "other than 0"),
        (["--distance", "42", "--tolerance", "0.1"], 2, "--ratio"),
        (["--distance", "42", "--follower", "radius=3"], 2, "--follower, or --drives"),
    ],
)
def test_what_cannot_be_is_said(gears: Path, options: list[str], code: int, word: str) -> None:
    found, text = call(gears, *options)
    assert found == code, text
    assert word in text


def test_files_that_hold_no_outline_are_refused(gears: Path) -> None:
    empty = gears / "empty.dxf"
    ezdxf.new().saveas(empty)
    pinion = str(gears / "pinion.dxf")
    for wheel in (empty, gears / "none.dxf"):
        words = ["motion", pinion, "--drives", str(wheel), "--distance", "42"]
        result = CliRunner().invoke(cli, words)
        assert result.exit_code == 4, result.output


def test_python_gives_the_same_arrays(gears: Path) -> None:
    driven = camgen.drives(gears / "pinion.dxf", gears / "wheel.dxf", 42.0, ratio=-12 / 30)
    assert driven.free.all() and driven.proven[1:].all()
    assert np.mean(driven.play) == pytest.approx(2.666e-3, rel=1e-3)
    assert driven.transmission_error < 1e-5
    with pytest.raises(camgen.SpecError, match="one of both"):
        camgen.drives(gears / "pinion.dxf", gears / "wheel.dxf")
    with pytest.raises(camgen.SpecError, match="a number"):
        camgen.drives(gears / "pinion.dxf", gears / "wheel.dxf", 42.0, ratio="-12/30")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="unexpected keyword"):
        camgen.drives(gears / "pinion.dxf", gears / "wheel.dxf", 42.0, sping="low")  # type: ignore[call-arg]
