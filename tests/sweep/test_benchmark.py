"""The benchmark measures what the files hold, says what follows, and is what RESULTS.md shows."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from camgen.cli import main
from camgen.sweep import benchmark, benchmark_report
from camgen.sweep.benchmark import Bench, Row, measure
from camgen.sweep.benchmark_report import STARTERS, sentences, to_markdown

COARSE = (1e-1, 1e-2, 1e-3, 1e-4)
UNTIMED = 9  # columns of its tables that hold no file sizes and no seconds


@pytest.fixture(scope="module")
def benches() -> dict[str, Bench]:
    specs = Path(__file__).resolve().parents[2] / "specs"
    return {
        name: measure(specs / f"{name}.toml", COARSE if name == "uniform-swing" else COARSE[:2])
        for name in STARTERS
    }


def cells(text: str) -> list[list[str]]:
    """The rows of figures of the tables in a text in markdown."""
    return [
        line.strip("| ").split(" | ") for line in text.splitlines() if re.match(r"\| [0-9]", line)
    ]


def figures(cell: str) -> list[float]:
    return [float(word) for word in re.findall(r"[0-9.]+(?:e-?[0-9]+)?", cell)]


@pytest.mark.long
@pytest.mark.parametrize("name", STARTERS)
def test_results_show_what_is_measured(name: str, benches: dict[str, Bench], root: Path) -> None:
    """Counts to the last one, errors to their printed digits, as far as float32 and rounding leave them."""
    text = (root / "tests" / "bench" / "RESULTS.md").read_text(encoding="utf-8")
    block = text.partition("<!-- bench -->")[2].partition("<!-- /bench -->")[0]
    shown = cells(block.partition(f"`{name}`")[2].partition("\n\n`")[0])
    found = cells(to_markdown(benches[name]))
    assert len(shown) == len(benchmark.TOLERANCES) and len(found) == len(benches[name].rows)
    for there, here in zip(shown, found, strict=False):
        assert there[:3] == here[:3]
        for a, b in zip(there[3:UNTIMED], here[3:UNTIMED], strict=True):
            assert figures(a) == pytest.approx(figures(b), rel=0.11, abs=1e-9), (there, here)


@pytest.mark.long
def test_counts_and_errors_of_the_swing_cam(benches: dict[str, Bench]) -> None:
    """Published least numbers (tip 3, without the corner's arc of 71.8 deg) plus that arc; errors just within the tolerance."""
    bench = benches["uniform-swing"]
    published = {1e-1: (38.9, 9.1), 1e-2: (122.9, 19.7), 1e-3: (388.7, 42.4), 1e-4: (1229.2, 91.3)}
    for row in bench.rows:
        vertices, arcs = published[row.tolerance]
        corner = math.radians(71.8) * math.sqrt(3 / (8 * row.tolerance))
        assert row.least_vertices == pytest.approx(vertices + corner, rel=2e-3)
        assert row.least_arcs == pytest.approx(arcs + 1, abs=0.06)
        assert row.least_vertices <= row.vertices <= row.least_vertices + 4
        for kind in ("dxf", "stl"):
            assert 0.9 * row.tolerance < row.outline[kind] <= row.tolerance * (1 + 1e-6) + 4e-6
            # an outline that is off by e turns an arm of 67 mm by e / (67.08 cos 58.3 deg) at the most
            assert (
                row.motion[kind]
                <= math.degrees(row.tolerance / (67.08 * math.cos(math.radians(58.31)))) * 1.05
                + 1e-5
            )
        assert set(row.seconds) == set(benchmark.STAGES) and min(row.size.values()) > 0
        assert row.size["stl"] == 84 + 50 * ((row.size["stl"] - 84) // 50)
        assert not row.faults


@pytest.mark.long
def test_looper_is_exact_but_for_float32(benches: dict[str, Bench]) -> None:
    """Lines and arcs need no fitting; distances of spreaders and needles are off by the rounding of numbers near 30 mm."""
    for row in benches["chain-stitch-looper"].rows:
        assert row.outline["dxf"] < 1e-12 and row.arcs == round(row.least_arcs)
        assert "dxf" not in row.motion and 0 < row.motion["stl"] < 4 * 2.0**-24 * 60
        assert not row.ripple


def made_up(
    stl: Sequence[float], dxf: Sequence[float], tolerances: Sequence[float] = benchmark.TOLERANCES
) -> Bench:
    """Rows with these motion errors and outlines just within the tolerance."""
    rows = [
        Row(
            t,
            round(13 / math.sqrt(t)),
            13 / math.sqrt(t),
            round(5 * t ** (-1 / 3)),
            4 * t ** (-1 / 3),
            {"dxf": t, "stl": max(t, 2e-6)},
            {"dxf": d, "stl": s},
        )
        for t, s, d in zip(tolerances, stl, dxf, strict=True)
    ]
    return Bench("made-up", "motion", "deg", ["cam"], rows)


def test_sentences_tell_where_float32_takes_over() -> None:
    """Errors of 1.6 tolerance that end at 3.2e-6: the two cross at 2e-6 mm."""
    t = np.array(benchmark.TOLERANCES)
    said = " ".join(sentences(made_up(list(np.maximum(1.6 * t, 3.2e-6)), list(1.6 * t))))
    assert "Below 2e-6 mm the float32 of STL sets the motion error, 3e-6 deg" in said
    assert "motion error of the DXF follows the tolerance down to 1e-7 mm: 2e-7 deg" in said
    assert (
        "grow with the power 0.50 of 1 / tolerance (theory: up to 1/2), 1.00 times the least at 0.1 mm"
        in said
    )
    assert "grow with the power 0.33 of 1 / tolerance (theory: up to 1/3), 1.28 times" in said


def test_sentences_of_other_courses() -> None:
    """An STL that keeps up, an error that the tolerance has no part in, and one that is none."""
    t = np.array(benchmark.TOLERANCES)
    assert "STL follows the tolerance down to 1e-7 mm" in " ".join(
        sentences(made_up(list(t), list(t)))
    )
    flat = " ".join(sentences(made_up([4e-7] * 7, [1e-13] * 7)))
    assert "of the STL is 4e-7 deg, whatever the tolerance: the float32 of STL sets it" in flat
    assert "The DXF is exact at every tolerance" in flat
    assert sentences(replace(made_up([1.0], [1.0], [0.1]))) == []  # one tolerance tells nothing


# ---- the command -----------------------------------------------------------------------------------------------------


def run(*arguments: str | Path) -> int:
    with pytest.raises(SystemExit) as done:
        main([str(argument) for argument in arguments])
    assert isinstance(done.value.code, int)
    return done.value.code


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(benchmark_report, "measure", partial(measure, tolerances=(1e-1, 1e-2)))


@pytest.mark.long
@pytest.mark.usefixtures("quick")
def test_command_prints_and_writes(
    root: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run("bench", root / "specs" / "disc-cam.toml", "-o", tmp_path) == 0
    printed = capsys.readouterr().out
    assert (
        "disc-cam, accuracy" in printed
        and "disc-cam, cost" in printed
        and "times the least" in printed
    )
    folder = tmp_path / benchmark_report.FOLDER
    assert {path.name for path in folder.iterdir()} == {
        "bench.csv",
        "bench.md",
        "disc-cam-counts.svg",
        "disc-cam-errors.svg",
        "manifest.json",
    }
    with open(folder / "bench.csv", encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["tolerance_mm"]) for row in rows] == [1e-1, 1e-2]
    assert all(float(row["outline_mm_dxf"]) <= float(row["tolerance_mm"]) for row in rows)
    assert "tolerance, slope 1" in (folder / "disc-cam-errors.svg").read_text(encoding="utf-8")
    assert (
        run("bench", root / "specs" / "disc-cam.toml", "-o", tmp_path) == 0
    )  # replaces its own result


@pytest.mark.usefixtures("quick")
def test_exit_codes(root: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    spec = (root / "specs" / "uniform-swing.toml").read_text(encoding="utf-8")
    wrong, impossible = tmp_path / "wrong.toml", tmp_path / "impossible.toml"
    wrong.write_text(spec.replace("pivot_distance", "pivot_distanse"), encoding="utf-8")
    impossible.write_text(
        re.sub(r"(?m)^arm_offset = .*$", "arm_offset = 1.0", spec), encoding="utf-8"
    )
    assert run("bench", wrong, "-o", tmp_path / "out") == 2
    assert run("bench", impossible, "-o", tmp_path / "out") == 3
    assert run("bench", tmp_path / "none.toml", "-o", tmp_path / "out") == 4
    assert run("bench", wrong, impossible, "-o", tmp_path / "out") == 2
    assert not (tmp_path / "out").exists()
    errors = capsys.readouterr().err
    assert "Traceback" not in errors and "pivot_distance" in errors


@pytest.mark.long
@pytest.mark.usefixtures("quick")
def test_a_damaged_file_is_told(
    root: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """An STL that has lost a triangle: its figures are missing, the fault is printed, the code is 1."""
    write = benchmark.write_stl

    def damaged(path: Path, mesh: object, name: str) -> None:
        write(path, mesh, name)  # type: ignore[arg-type]
        data = path.read_bytes()
        count = int.from_bytes(data[80:84], "little") - 1
        path.write_bytes(data[:80] + count.to_bytes(4, "little") + data[84:-50])

    monkeypatch.setattr(benchmark, "write_stl", damaged)
    assert run("bench", root / "specs" / "disc-cam.toml", "-o", tmp_path) == 1
    assert "at 0.1 mm: WATERTIGHT" in capsys.readouterr().out
    with open(
        tmp_path / benchmark_report.FOLDER / "bench.csv", encoding="utf-8", newline=""
    ) as file:
        row = next(csv.DictReader(file))
    assert (
        row["motion_stl"] == row["outline_mm_stl"] == ""
        and row["motion_dxf"]
        and "WATERTIGHT" in row["faults"]
    )
