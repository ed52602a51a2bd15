"""What verdicts say: the limit that was written, what was not judged, what a key does not act on, what was found."""

from __future__ import annotations

import json
import re
import struct
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from camgen.machines.sources import read_mechanism
from camgen.pipeline.build import KINDS, build, check
from camgen.pipeline.judging import sparse_infill
from camgen.report.report import Report
from camgen.report.terminal import print_report

SPECS = Path(__file__).resolve().parents[2] / "specs"
ALL = frozenset(KINDS)
# The stitch whose needles slide along the spreaders.
BARE = (
    "geometry.plate_to_spreader=7",
    "geometry.velocity_ratio=0.9142857",
    "geometry.blade_length=34",
    "geometry.p6_setback=0",
    "limits.clearance=0",
)
Make = Callable[..., Report]


@pytest.fixture
def make(tmp_path: Path) -> Make:
    """Builds a starter spec: name, kinds of files, settings."""

    def call(name: str, kinds: str, *settings: str) -> Report:
        return build(SPECS / f"{name}.toml", tmp_path, frozenset(kinds.split(",")), settings)

    return call


@pytest.mark.long
def test_wall_is_shown_with_the_limit_that_was_written(make: Make) -> None:
    # 6.6 mm is the least disc: 6.6 / 2 - 1.5 - 2 / 2 = 0.8 mm of wall
    report = make(
        "eccentric-drive",
        "dxf,stl",
        "geometry.eccentric_diameter=6.6",
        "accuracy.chord_tolerance=0.01",
    )
    walls = [finding for finding in report.findings if finding.code == "MIN_WALL"]
    assert {finding.limit for finding in walls} == {0.8} and all(finding.ok for finding in walls)
    thinnest = min(walls, key=lambda finding: finding.measured)
    assert (
        0.78 <= thinnest.measured < 0.8 and "0.02 mm" in thinnest.message
    )  # two contours, each 0.01 mm off at most


@pytest.mark.long
def test_units_are_counted_faults(make: Make, tmp_path: Path) -> None:
    assert {
        (f.measured, f.limit) for f in make("disc-cam", "dxf").findings if f.code == "DXF_UNITS"
    } == {(0, 0)}
    drawing = tmp_path / "disc-cam" / "disc-cam-cam.dxf"
    drawing.write_text(drawing.read_text().replace("$INSUNITS\n 70\n4", "$INSUNITS\n 70\n1"))
    (told,) = (f for f in check(tmp_path / "disc-cam").findings if f.code == "DXF_UNITS")
    assert (told.ok, told.measured, told.limit) == (False, 1, 0) and "millimetres" in told.message


# ---- what was not judged ---------------------------------------------------------------------------------------------


@pytest.mark.long
def test_drawings_of_the_looper_clear_as_its_solids_do(make: Make) -> None:
    # by another route: the STL's sections are cut from triangles, a drawing is an outline
    clearly = ("geometry.p6_setback=1.5", "limits.clearance=0.3", "parts.running_gap=0.2")
    report = make("chain-stitch-looper", "dxf,stl", *BARE, *clearly)
    numbers = {
        name: value for name, value in report.numbers.items() if name.startswith("clearance_")
    }
    for pair in ("n1_p1", "n2_p1", "n2_p2", "n1_p2", "p1_p2"):
        assert numbers[f"clearance_{pair}_dxf_mm"] == pytest.approx(
            numbers[f"clearance_{pair}_stl_mm"], abs=2e-3
        )
    clear = [finding for finding in report.findings if finding.code == "CLEARANCE"]
    assert len(clear) == 10 and [f.ok for f in clear[:5]] == [f.ok for f in clear[5:]]
    assert {f.limit for f in clear} <= {0.0, 0.1, 0.2, 0.3}


@pytest.mark.long
def test_drawings_alone_show_that_a_needle_strikes(make: Make) -> None:
    report = make("chain-stitch-looper", "dxf", "timing.lag_deg=6", *BARE)
    assert not report.ok and {f.code for f in report.findings if not f.ok} == {"CLEARANCE"}
    assert {each.code for each in report.not_judged} == {
        "WATERTIGHT",
        "VOLUME",
        "BED_FIT",
        "INTERFERENCE",
    }


@pytest.mark.long
@pytest.mark.parametrize(
    "name, kinds, settings, left_out",
    [
        ("disc-cam", "dxf", (), {"WATERTIGHT", "VOLUME", "BED_FIT", "INTERFERENCE"}),
        ("disc-cam", "stl", (), {"DXF_CLOSED", "DXF_UNITS", "INTERFERENCE"}),
        ("disc-cam", "dxf,3mf", (), set()),
        (
            "disc-cam",
            "report",
            ("geometry.closure='groove'", "parts.hub_height=0"),
            {
                "DXF_CLOSED",
                "DXF_UNITS",
                "WATERTIGHT",
                "VOLUME",
                "ROUND_TRIP",
                "MIN_WALL",
                "MOTION_ERROR",
                "SPEED_RIPPLE",
                "LASH",
                "INTERFERENCE",
                "BED_FIT",
            },
        ),
        (
            "eccentric-drive",
            "report",
            (),
            {
                "DXF_CLOSED",
                "DXF_UNITS",
                "WATERTIGHT",
                "VOLUME",
                "ROUND_TRIP",
                "MIN_WALL",
                "MOTION_ERROR",
                "STROKE_ERROR",
                "LASH",
                "PIN_GAP",
                "BED_FIT",
                "INTERFERENCE",
            },
        ),
    ],
)
def test_what_kinds_of_files_leave_unjudged_is_named(
    make: Make, tmp_path: Path, name: str, kinds: str, settings: tuple[str, ...], left_out: set[str]
) -> None:
    report = make(name, kinds, *settings)
    assert report.ok
    for files in (report.not_judged, check(tmp_path / name).not_judged):
        assert {each.code for each in files} == left_out
        assert all("the folder has no" in each.why for each in files)


@pytest.mark.long
@pytest.mark.parametrize(
    "name, settings",
    [
        ("disc-cam", ("geometry.closure='conjugate'",)),
        (
            "disc-cam",
            (
                "geometry.follower={motion='translating', shape='flat', face_width=60}",
                "limits.least_radius=0",
            ),
        ),
        ("indexing-cam", ()),
        ("thread-take-up", ()),
    ],
)
def test_every_code_that_is_announced_is_given(
    make: Make, name: str, settings: tuple[str, ...]
) -> None:
    """A stage that announced a code which no file gives would name it among those left out, once something else fails."""
    report = make(
        name, "dxf,stl,3mf", "print.bed=[1, 1]", "accuracy.chord_tolerance=0.01", *settings
    )
    assert not report.ok and not report.not_judged


def test_what_a_broken_file_leaves_unjudged_is_named(make: Make, tmp_path: Path) -> None:
    make("disc-cam", "stl")
    mesh = tmp_path / "disc-cam" / "disc-cam-cam.stl"
    data = bytearray(mesh.read_bytes())
    data[96:100] = struct.pack("<f", 99)  # a corner of the first triangle
    mesh.write_bytes(data)
    report = check(tmp_path / "disc-cam")
    assert {f.code for f in report.findings if not f.ok} == {"WATERTIGHT"}
    assert {"MOTION_ERROR", "VOLUME", "ROUND_TRIP"} <= {each.code for each in report.not_judged}


@pytest.mark.long
def test_a_file_that_was_changed_is_told_as_judged_or_not(make: Make, tmp_path: Path) -> None:
    """The drawing of a chain is an SVG like a sheet for the laser, but unlike that it is not judged."""
    assert not make("linkage", "dxf").remarks
    drawing, chain = (
        tmp_path / "linkage" / f"linkage-{name}" for name in ("crank.dxf", "chain.svg")
    )
    drawing.write_text("999\nlooked at by somebody\n" + drawing.read_text("utf-8"), "utf-8")
    chain.write_text("nothing", "utf-8")
    report = check(tmp_path / "linkage")
    assert [
        text
        for text in report.remarks
        if "changed since the build" in text and "linkage-crank.dxf" in text
    ]
    (told,) = (finding for finding in report.findings if not finding.ok)
    assert told.code == "MANIFEST" and "linkage-chain.svg" in told.message


@pytest.mark.long
def test_a_smaller_build_says_what_goes_with_the_larger_one(make: Make) -> None:
    make("disc-cam", "dxf,stl")
    (said,) = make("disc-cam", "dxf").remarks
    assert "removed 1 file (STL)" in said and "--only" in said
    assert not make("disc-cam", "dxf").remarks


@pytest.mark.long
def test_what_was_not_judged_is_said_by_name_in_terminal_and_page(
    make: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    report = make("uniform-swing", "dxf,report")
    print_report(report)
    first, *told, place, see, buy = capsys.readouterr().out.splitlines()
    assert first == f"uniform-swing: all {len(report.findings)} findings hold; 4 not judged"
    assert told[0] == (
        "not judged: 4 kinds of findings need files that the folder does not have; -v lists them"
    )
    assert not told[1].startswith("not judged")
    assert place.startswith(f"files are in {tmp_path / 'uniform-swing'}: ")
    assert str(tmp_path) in see and see.endswith("to see it move")
    assert re.fullmatch(
        r"buy what is marked bought or stock in .*-parts\.csv \(\d+ kinds, \d+ pieces\)", buy
    )
    print_report(report, verbose=True)
    assert re.search(r"^ INTERFERENCE .* not judged *$", capsys.readouterr().out, re.M)
    data = json.loads((tmp_path / "uniform-swing" / "report.json").read_text("utf-8"))
    assert data["ok"] and {"code", "why"} == set(data["not_judged"][0])
    assert any("the folder has no 3MF" in each["why"] for each in data["not_judged"])
    page = (tmp_path / "uniform-swing" / "report.html").read_text("utf-8")
    assert '<p class="verdict open">' in page and "NOT JUDGED: INTERFERENCE" in page
    assert page.count("WATERTIGHT, VOLUME (need STL or 3MF or STEP)") == 1  # said once
    assert '<tr class="open">' not in page


@pytest.mark.long
@pytest.mark.parametrize(
    "kinds, setting, told",
    [
        (
            "dxf,stl",
            "print.profile_compensation=0.1",
            "print.profile_compensation = 0.1 changes only STL and 3MF",
        ),
        ("dxf", "print.elephant_foot=0.2", "print.elephant_foot = 0.2"),
        ("stl", "print.profile_compensation=0.1", ""),
        ("stl", "files.curves='lines'", "has no effect without DXF"),
        ("dxf,stl", "files.curves='lines'", ""),
        (
            "dxf",
            "files.engrave=true",
            "files.engrave = true has no effect: no part has anything engraved",
        ),
    ],
)
def test_key_that_cannot_act_on_a_file_is_told(
    make: Make, capsys: pytest.CaptureFixture[str], kinds: str, setting: str, told: str
) -> None:
    report = make("disc-cam", kinds, setting, "parts.hub_height=0", "motor.model=hand crank")
    print_report(report)
    assert told in " ".join(report.warnings) and len(report.warnings) == bool(told)
    assert ("warning: " in capsys.readouterr().out) is bool(told)


# ---- what was found --------------------------------------------------------------------------------------------------


@pytest.mark.long
@pytest.mark.parametrize(
    "name, settings, found",
    [
        ("disc-cam", (), {"geometry.base_radius", "limits.pressure_angle_deg", "material.density"}),
        (
            "disc-cam",
            (
                "geometry.follower={motion='oscillating', shape='roller', radius=5, pivot_distance=70, arm=60}",
            ),
            {"geometry.base_radius", "limits.pressure_angle_deg", "material.density"},
        ),
        (
            "indexing-cam",
            ("motor.speed_rpm=45", "unloader={torque='law'}"),
            {
                "geometry.return_deg",
                "unloader.balance",
                "unloader.design_rpm",
                "limits.pressure_angle_deg",
                "material.density",
            },
        ),
        (
            "thread-take-up",
            (),
            {"masses.coupler_centre", "masses.output_crank_centre", "material.density"},
        ),
        ("chain-stitch-looper", (), {"timing.needle_stroke", "material.density"}),
    ],
)
def test_resolved_spec_holds_what_was_found_and_is_the_same_machine(
    tmp_path: Path, name: str, settings: tuple[str, ...], found: set[str]
) -> None:
    text = (SPECS / f"{name}.toml").read_text("utf-8")
    spec = tmp_path / "left-open.toml"
    open_keys = "base_radius" if name == "disc-cam" else "coupler_centre|output_crank_centre"
    spec.write_text(re.sub(rf"(?m)^({open_keys}) = .*$", "", text), "utf-8")
    build(spec, tmp_path, frozenset({"dxf" if name == "disc-cam" else "report"}), settings)
    first = {path.name: path.read_bytes() for path in (tmp_path / name).iterdir()}
    written = tomllib.loads(first["spec.toml"].decode())
    given = read_mechanism(spec, settings)
    assert {
        key
        for key, value in given._found().items()
        if at(written, key) == pytest.approx(value, abs=0)
    } == found
    assert read_mechanism(tmp_path / name / "spec.toml") == given.resolved()
    if name == "disc-cam":
        (tmp_path / "again.toml").write_bytes(first["spec.toml"])
        build(tmp_path / "again.toml", tmp_path / "b", frozenset({"dxf"}))
        assert {path.name: path.read_bytes() for path in (tmp_path / "b" / name).iterdir()} == first


def at(data: dict[str, Any], key: str) -> Any:
    for step in key.split("."):
        data = data[step]
    return data


def test_wide_plates_that_stand_still_need_no_infill() -> None:
    """Four walls of 0.4 to either side fill what is up to 3.2 wide: posts of Ø8.1 about holes of 3.4, caps and the frame of the battery,
    whose walls are 1.6; links move."""
    walker = read_mechanism(SPECS / "gallery" / "walker.toml")
    wide = {part.name for part in walker.assembly.parts if sparse_infill(walker, part)}
    assert wide == {"ground", "second-plate", "far-ground"}
