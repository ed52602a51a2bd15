"""The whole chain: what a build writes, that it writes the same bytes again, and that README's picture is of today."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import zipfile
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import gallery
import numpy as np
import pytest

from camgen.parts.assembly import order_of_assembly
from camgen.pipeline import build as pipeline
from camgen.pipeline.making import parts_table

TOP = Path(__file__).resolve().parents[2]
SPEC = TOP / "specs" / "uniform-swing.toml"
ALL = frozenset(pipeline.KINDS)
CAMS = [
    "parts.make='cams'",
    "parts.bore=8",
]  # the cam alone; the whole machine is in test_swing_machine


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir())}


@pytest.fixture(scope="module")
def made(built: Callable[..., Path]) -> Path:
    return built("uniform-swing", *CAMS)


def test_the_files_of_the_contract_are_there(made: Path) -> None:
    part = "uniform-swing-cam"
    assert set(contents(made)) == {
        "spec.toml",
        "motion.csv",
        "report.json",
        "report.html",
        "manifest.json",
        "uniform-swing-assembly.3mf",
        "uniform-swing-assembly.glb",
        "uniform-swing-plate.3mf",
        "uniform-swing-parts.csv",
        f"{part}.dxf",
        f"{part}.stl",
        f"{part}.3mf",
        f"{part}-drawing.dxf",
        f"{part}-drawing.pdf",
    }


def test_the_page_tells_the_size_of_a_plate_as_another_reader_measures_its_file(made: Path) -> None:
    with zipfile.ZipFile(made / "uniform-swing-plate.3mf") as package:
        model = ElementTree.fromstring(package.read("3D/3dmodel.model"))
    core = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
    solids = {
        each.attrib["id"]: [
            [float(v.attrib[axis]) for axis in "xyz"] for v in each.iter(core + "vertex")
        ]
        for each in model.iter(core + "object")
    }
    placed = []
    for copy in model.iter(core + "component"):
        matrix = np.array(copy.attrib["transform"].split(), float).reshape(4, 3)
        placed.append(np.array(solids[copy.attrib["objectid"]]) @ matrix[:3] + matrix[3])
    corners = np.concatenate(placed)
    low, high = corners.min(axis=0), corners.max(axis=0)
    size = " × ".join(f"{side:.0f}" for side in high - low)
    assert f"; {size} mm high" in (made / "report.html").read_text(encoding="utf-8")


def test_report_json_is_the_report(made: Path) -> None:
    report = json.loads((made / "report.json").read_text())
    assert report["name"] == report["mechanism"] == "uniform-swing" and report["ok"] is True
    for finding in report["findings"]:
        assert set(finding) == {"code", "ok", "measured", "limit", "unit", "where", "message"}
    codes = [finding["code"] for finding in report["findings"]]
    assert codes.count("MOTION_ERROR") == 3  # once for each kind of file
    assert set(codes) >= {
        "SPEED_RIPPLE",
        "UNDERCUT",
        "PRESSURE_ANGLE",
        "MIN_WALL",
        "WATERTIGHT",
        "VOLUME",
        "DXF_CLOSED",
        "DXF_UNITS",
        "ROUND_TRIP",
        "LASH",
        "INTERFERENCE",
    }
    assert report["numbers"]["swing_deg"] == 30
    assert [part["count"] for part in report["parts"]] == [2]
    stages = [
        row[0]
        for table in report["tables"]
        if table["title"].startswith("Error budget")
        for row in table["rows"]
    ]
    assert len(stages) >= 4


def test_the_loss_at_the_reversal_is_the_exact_undercut(made: Path) -> None:
    """0.07283194 deg at 180 deg, by mpmath at 40 digits; recovered between the judged angles next to it."""
    findings = json.loads((made / "report.json").read_text())["findings"]
    exact, *recovered = [f["measured"] for f in findings if f["code"] == "UNDERCUT"]
    assert exact == pytest.approx(0.0728319409614635, abs=1e-9)
    assert len(recovered) == 3
    slope = (
        0.16 * 0.05
    )  # deg of loss a deg of cam angle beside the reversal, and the widest step between judged angles
    assert all(exact - slope - 1.8e-3 <= loss <= exact + 1.8e-3 for loss in recovered)


def test_motion_csv_holds_wanted_and_recovered(made: Path) -> None:
    rows = np.genfromtxt(made / "motion.csv", delimiter=",", names=True)
    assert rows.dtype.names == (
        "theta_deg",
        "swing_deg",
        "swing_deg_dxf",
        "swing_deg_stl",
        "swing_deg_3mf",
    )
    assert rows["theta_deg"] == pytest.approx(np.arange(1441) / 4)
    half = rows["theta_deg"] <= 180
    wanted = np.where(half, -15 + rows["theta_deg"] / 6, 45 - rows["theta_deg"] / 6)
    assert np.abs(rows["swing_deg"] - wanted).max() < 1e-9
    away = np.abs(rows["theta_deg"] - 180) > 1.5
    for kind in ("dxf", "stl", "3mf"):
        assert np.abs(rows[f"swing_deg_{kind}"] - wanted)[away].max() < 1.73e-3


@pytest.mark.long
def test_same_spec_same_bytes_in_another_process_and_from_the_resolved_spec(
    made: Path, tmp_path: Path
) -> None:
    environment = {**os.environ, "PYTHONHASHSEED": "4711", "TZ": "Asia/Tokyo"}
    command = [
        sys.executable,
        str(TOP / "tests" / "flat.py"),
        "build",
        str(made / "spec.toml"),
        "-o",
        str(tmp_path),
    ]
    subprocess.run(command, check=True, capture_output=True, env=environment, cwd=tmp_path)
    assert contents(tmp_path / "uniform-swing") == contents(made)


@pytest.mark.long
def test_check_says_what_the_build_said(made: Path) -> None:
    """And that the files beside the parts are as they are made anew."""
    before = contents(made)
    findings = json.loads((made / "report.json").read_text())["findings"]
    checked: Any = pipeline.check(made).as_dict()["findings"]
    assert checked[:-1] == findings and (checked[-1]["code"], checked[-1]["ok"]) == (
        "REBUILD",
        True,
    )
    assert contents(made) == before


@pytest.mark.long
@pytest.mark.parametrize(
    "name",
    sorted({path.stem for path in SPEC.parent.glob("*.toml")} - {"coupon", "four-leg-walker"}),
)
def test_every_machine_has_steps_of_assembly_for_all_that_stands_in_it(name: str) -> None:
    machine = pipeline.read_mechanism(
        TOP / "specs" / f"{name}.toml", CAMS[:1] if name == "uniform-swing" else ()
    )
    steps, poses = order_of_assembly(machine.assembly), machine.assembly.poses(np.zeros(1))
    assert [row[0] for row in steps.rows] == list(range(1, len(steps.rows) + 1))
    copies = Counter({part.name: len(poses[part.name]) for part in machine.assembly.parts})
    told: Counter[str] = Counter()
    # what comes again, such as a collar that is pushed up, has no count in its row
    first = [
        (row, step)
        for row, step in zip(steps.rows, steps.steps, strict=True)
        if step.copies and row[4] != ""
    ]
    rows = [row for row, _ in first]
    boarded = {"linkage", "eccentric-drive", "thread-take-up"}
    alone = [
        row[1]
        for row, step in zip(steps.rows, steps.steps, strict=True)
        if not step.copies and not step.group
    ]
    assert alone.count("board") == (machine.mechanism in boarded)  # the builder's own
    # a shaft that no part of the machine is has to be turned
    listed = {
        row[1] for row in parts_table(machine).rows if row[0] in ("bought", "turned of steel")
    }
    assert {*alone} <= {"board", "motor", *listed}
    for _, part, _, _, count, z, lies in rows:
        told[part] += count
        assert (z, lies == "turned over") in [
            (pytest.approx(pose.z), pose.flipped) for pose in poses[part]
        ]
    assert told == +copies
    thick = {
        part.name: part.thickness for part in machine.assembly.parts
    }  # what is turned over comes from above
    heights = [
        (round(z + thick[part] * (lies == "turned over"), 6), lies == "turned over")
        for _, part, _, _, _, z, lies in rows
        if part != "motor-bar"  # comes from below, with its motor
    ]
    # a pin with its head up comes as soon as what it keeps is there, over all of that
    lying = [height for height, over in heights if not over]
    assert lying == sorted(lying)
    highest = np.maximum.accumulate([height for height, _ in heights])
    assert all(height == top for (height, over), top in zip(heights, highest, strict=True) if over)
    counts = Counter(mount.part for mount in machine.assembly.mounts)
    every = {f"{part}-{k + 1}": part for part, count in counts.items() for k in range(count)}
    laid = Counter(copy for _, step in first for copy in step.copies)
    assert len(steps.steps) == len(steps.rows) and laid == Counter(list(every)), (
        "each copy is laid once"
    )
    assert {copy for step in steps.steps for copy in step.copies} <= {*every}


@pytest.mark.long
@pytest.mark.parametrize("only", ["dxf", "stl", "3mf", "report"])
def test_only_what_is_asked_for_is_written(tmp_path: Path, only: str) -> None:
    assert pipeline.build(SPEC, tmp_path, frozenset({only}), CAMS).ok
    names = set(contents(tmp_path / "uniform-swing"))
    endings = {name.rsplit(".", 1)[1] for name in names}
    always = {"toml", "json", "csv"}
    assert "uniform-swing-parts.csv" in names and ("motion.csv" in names) == (only != "report")
    own = {"dxf": {"dxf", "pdf"}, "stl": {"stl"}, "3mf": {"3mf"}, "report": {"html"}}[only]
    assert endings == always | own
    assert pipeline.check(tmp_path / "uniform-swing").ok


@pytest.mark.long
@pytest.mark.parametrize(
    "settings",
    [
        ["geometry.tip_radius=0", "parts.mark_depth=0"],
        ["geometry.reversal_blend_deg=20", "parts.shaft='keyway'"],
        ["geometry.reversal_blend_deg=180", "output.curves='lines'"],
        ["geometry.closure='force'", "parts.shaft='d-flat'", "parts.windows=0"],
        ["geometry.swing_deg=1", "parts.pin_diameter=0"],
    ],
)
def test_other_specs_move_as_asked_too(tmp_path: Path, settings: list[str]) -> None:
    report = pipeline.build(
        SPEC, tmp_path, frozenset({"dxf", "stl"}), [*CAMS, *settings, "limits.speed_ripple=0.1"]
    )
    assert [f for f in report.findings if not f.ok] == []


@pytest.mark.long
@pytest.mark.parametrize("scale", [0.01, 100])
def test_any_size(tmp_path: Path, scale: float) -> None:
    """The same machine in other units: all lengths scaled, tolerance too."""
    lengths = {
        "geometry.pivot_distance": 60,
        "geometry.arm_offset": 30,
        "geometry.tip_radius": 3,
        "parts.thickness": 6,
        "parts.bore": 8,
        "parts.pin_diameter": 3,
        "parts.wall": 3,
        "parts.mark_depth": 0.4,
        "limits.min_wall": 0.8,
        "accuracy.chord_tolerance": 0.001,
    }
    settings = [f"{key}={value * scale:.12g}" for key, value in lengths.items()] + [
        "print.nozzle=0.004",
        "print.bed=[1e5, 1e5]",
        "print.bed_height=1e5",
        CAMS[0],
    ]
    report = pipeline.build(SPEC, tmp_path, frozenset({"dxf", "stl"}), settings)
    assert [f for f in report.findings if not f.ok] == []


@pytest.mark.long
@pytest.mark.parametrize("name", gallery.FRAMES)
def test_the_pictures_in_the_readme_are_of_today(name: str) -> None:
    assert gallery.alike(gallery.path(name).read_text(encoding="utf-8"), gallery.picture(name))


@pytest.mark.long
@pytest.mark.parametrize("name", gallery.SOLID)
def test_the_pictures_in_space_are_of_today(name: str) -> None:
    kept = gallery.path(name, "png").read_bytes()
    assert gallery.same_pixels(kept, gallery.solid(name))
    assert not gallery.same_pixels(kept, gallery.solid("end-cam"))


def test_another_picture_is_not_alike() -> None:
    text = gallery.path("disc-cam").read_text(encoding="utf-8")
    first = re.search(r' d="M(\S+) ', text)
    assert first is not None
    moved = f"{float(first[1]) + 500:g}"
    damaged = text[: first.start(1)] + moved + text[first.end(1) :]
    assert gallery.alike(text, text) and not gallery.alike(text, damaged)
    assert not gallery.alike(text, text.replace("<path", "<line", 1))
    turned = re.sub(r"rotate\((\S+?)\)", "rotate(77)", text, count=1)
    assert turned != text and not gallery.alike(text, turned)


def test_the_moving_picture_of_the_readme_is_this_leg_and_comes_round() -> None:
    text = gallery.moving("walking-leg")
    assert gallery.alike(gallery.path("walking-leg-moving").read_text(encoding="utf-8"), text)
    place = r"%\{transform:(translate\(\S+\)) rotate\((\S+)deg\)\}"
    turns = re.findall(rf"\{{0{place}.*?\}}100{place}", text)
    assert len(turns) == text.count("@keyframes") > 10
    for start, begun, end, ended in turns:
        assert start == end and abs((float(ended) - float(begun) + 180) % 360 - 180) < 0.02
