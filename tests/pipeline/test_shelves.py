"""A machine of many files lies in folders by use: found, judged, linked and compared as a flat one is."""

from __future__ import annotations

import json
import re
import shutil
import tomllib
from pathlib import Path
from types import SimpleNamespace
from typing import cast
from urllib.parse import unquote

import pytest

import camgen
from camgen import starters
from camgen.errors import FileError
from camgen.files.shelves import listed, located, put_away, shelf
from camgen.machines.mechanism import Mechanism
from camgen.measuring.motion import Request, run
from camgen.pipeline.build import build, check
from camgen.pipeline.case import Case
from camgen.pipeline.laser import sheet_files
from camgen.pipeline.shopping import choices, steps_of_assembly, stock, supplies, tools
from camgen.pipeline.summary import plates_of

GROOVE = """
mechanism = "disc-cam"
name = "many"
segment = [
  { kind = "rise", span_deg = 180, lift = 8, law = "cycloidal" },
  { kind = "return", to = 0, span_deg = 180, law = "cycloidal" },
]
[geometry]
base_radius = 25
closure = "groove"
follower = { motion = "translating", shape = "roller", radius = 5 }
[files]
profile_step_deg = 5
cutter_radius = 3
[laser]
thickness = 6
"""
KINDS = frozenset({"dxf", "stl", "3mf", "step", "report"})


@pytest.fixture(scope="module")
def shelved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("shelves")
    spec = folder / "many.toml"
    spec.write_text(GROOVE, encoding="utf-8")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("camgen.files.shelves.MOST_FLAT", 20)
        report = build(spec, folder, KINDS)
    assert report.ok, [finding for finding in report.findings if not finding.ok]
    return folder / "many"


@pytest.mark.parametrize(
    "name, where",
    [
        ("a-cam.dxf", "cad"),
        ("a-cam.step", "cad"),
        ("a-assembly.3mf", "cad"),
        ("a-assembly.glb", "cad"),
        ("a-cam-path.dxf", "cad"),
        ("a-cam.stl", "print"),
        ("a-plate-2.3mf", "print"),
        ("a-cam-drawing.dxf", "drawings"),
        ("a-sheet-1.dxf", "laser"),
        ("a-parts.csv", ""),
        ("motion.csv", ""),
        ("spec.toml", ""),
        ("report.html", ""),
    ],
)
def test_each_file_has_its_shelf(name: str, where: str) -> None:
    assert shelf(name) == where


def test_few_files_lie_flat_and_one_more_does_not(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("camgen.files.shelves.MOST_FLAT", 3)
    for name in ("a.dxf", "a.stl"):
        (tmp_path / name).touch()
    put_away(tmp_path, ["manifest.json"])
    assert located(tmp_path / "a.dxf") == tmp_path / "a.dxf"
    put_away(tmp_path, ["manifest.json", "report.json"])
    assert located(tmp_path / "a.dxf") == tmp_path / "cad" / "a.dxf"
    assert listed(tmp_path, "a.*") == [tmp_path / "cad" / "a.dxf", tmp_path / "print" / "a.stl"]


def test_what_camgen_chooses_is_told_with_its_key_and_stays_so_when_the_key_is_set() -> None:
    """A drum whose radius the spec leaves open, and the screws of a plate on its stand: M3 has a core hole of 2.5 [ISO 2306]."""
    machine = camgen.load(tomllib.loads(starters.text("drum-feeder")))
    assert "radius" not in machine.source_tables["geometry"]
    chosen = dict(choices(machine))
    assert chosen["geometry.radius"] == 34 and chosen["parts.pieces"] == 2
    assert dict(choices(machine.resolved())) == chosen
    stands = dict(choices(camgen.load(tomllib.loads(starters.text("four-bar")))))
    assert stands["parts.mount_diameter"] == "screw of the plate, through the stand: M3 x 8"
    assert stands["layers.coupler"] == 2


def test_steel_and_drills_are_listed() -> None:
    """Rods of 62.5 mm, four, and a shaft of 69; a reamer of 4.05 mm is in few boxes, and no pin of 4 goes through what a drill of
    4 leaves: the next drill opens that hole."""
    feeder = camgen.load(tomllib.loads(starters.text("drum-feeder")))
    lengths = {each.name: each.size for each in stock(feeder)}
    assert lengths["steel rod 6 h9"] == (
        f"{4 * 62.5 + 69:g} mm in total, plus the saw cuts, for 5 pieces, sawn and filed"
    )
    assert {each.count for each in stock(feeder)} == {1}, "one rod, whatever comes of it"
    leg = camgen.load(tomllib.loads(starters.text("walking-leg")))
    drills = {each.name: each.size for each in tools(leg)}
    assert drills["drill 4.1"].endswith(" of 4.05 mm, or drill 4 and sandpaper")
    bird = {
        each.name: each.size
        for each in tools(camgen.load(tomllib.loads(starters.text("flapping-bird"))))
    }
    assert {
        "drill 5",
        "drill 5.2",
        "drill 6",
        "drill 6.2",
        "fine sandpaper",
        "vice",
        "hex key 2",
    } <= bird.keys(), "as its steps ask"
    assert bird["block"].startswith("at least 34 mm high") and "saw" not in bird
    assert "22 and 2 × 34 mm high" in bird["prop"], "under the shaft, and under two pins at once"
    assert {"saw", "file", "caliper"} <= {each.name for each in tools(feeder)}
    own = {each.name: each.count for each in feeder.assembly.bought if each.role == "own"}
    assert own == {"screw from below": 2, "screw of the load": 4}


# What steps say, as people read it, and how the list calls that. Pliers are for nuts too, of which no step says how they are held.
SAID = {
    r"(?<!sand)paper": "sheets of paper",
    "plastic bag": "plastic bag",
    "feeler gauge": "feeler gauges",
    "with a square": "square",
    "scrape": "scraper",
    "with a vice": "vice",
    "drop of oil": "oil",
    "with alcohol": "alcohol",
    "[Aa]dhesive putty": "adhesive putty",
    "Slit each strip": "scissors",
    "grease": "grease",
    "double-sided tape": "double-sided tape",
    "a tape holds|strip of adhesive tape": "adhesive tape",
    "Write on each part": "marker",
    "Cut and file": "saw",
    "Cut and file|File or grind": "file",
    "join them to the motor's": "connectors",
    "[Ee]xtension spring": "pliers",
}


@pytest.mark.parametrize(
    "name",
    [
        "flapping-bird",
        "walker",
        "drum-feeder",
        "uniform-swing",
        "cylinder-cam",
        "walking-leg",
        "ratchet",
        "dial-table",
        "five-bar",
        "stepping-gears",
    ],
)
def test_the_list_has_what_steps_name_and_nothing_that_none_names(name: str) -> None:
    machine = camgen.load(tomllib.loads(starters.text(name)))
    titles = " ".join(step.title for step in steps_of_assembly(machine).steps)
    listed = {each.name for each in (*tools(machine), *supplies(machine))}
    nuts = any(each.standard == "ISO 4032" for each in machine.assembly.bought)
    for words, tool in SAID.items():
        named = bool(re.search(words, titles)) or (tool == "pliers" and nuts)
        assert named == (tool in listed), tool


def test_parts_of_a_machine_called_plate_or_sheet_are_none(tmp_path: Path) -> None:
    """Parts of an included machine have its name in front of theirs."""
    for name in ("plate.3mf", "plate-2.3mf", "plate-crank.3mf", "sheet-1.dxf", "sheet-crank.dxf"):
        (tmp_path / f"a-{name}").touch()
    case = Case(cast(Mechanism, SimpleNamespace(name="a")), tmp_path)
    assert [path.name for path in plates_of(case)] == ["a-plate.3mf", "a-plate-2.3mf"]
    assert [path.name for path in sheet_files(case)] == ["a-sheet-1.dxf"]


@pytest.mark.long
def test_the_manifest_tells_each_path_and_the_top_holds_what_is_read(shelved: Path) -> None:
    manifest = json.loads((shelved / "manifest.json").read_text(encoding="utf-8"))
    files = [path.relative_to(shelved).as_posix() for path in shelved.rglob("*") if path.is_file()]
    assert sorted([*manifest["files"], "manifest.json"]) == sorted(files)
    top = {path.name for path in shelved.iterdir()}
    assert {"cad", "drawings", "laser", "print", "report.html", "many-parts.csv"} <= top
    assert not any(shelf(name) for name in top)


@pytest.mark.long
def test_the_page_links_to_files_where_they_lie(shelved: Path) -> None:
    page = (shelved / "report.html").read_text(encoding="utf-8")
    links = {unquote(link) for link in re.findall(r'<a href="([^"#:]+)"', page)}
    assert {"print/many-plate.3mf", "laser/many-sheet-1.svg"} <= links
    assert not [link for link in links if not (shelved / link).is_file()]


@pytest.mark.long
def test_it_is_judged_again_and_a_changed_drawing_is_named_by_its_path(
    shelved: Path, tmp_path: Path
) -> None:
    folder = tmp_path / "many"
    shutil.copytree(shelved, folder)
    assert check(folder).ok
    (drawing,) = (folder / "drawings").glob("*-back-drawing.dxf")
    drawing.write_bytes(drawing.read_bytes() + b"\n")
    failed = {finding.code: finding for finding in check(folder).findings if not finding.ok}
    assert (
        failed.keys() == {"MANIFEST"} and f"drawings/{drawing.name}" in failed["MANIFEST"].message
    )
    drawing.unlink()
    with pytest.raises(FileError, match=f"drawings/{drawing.name}"):
        check(folder)


@pytest.mark.long
def test_a_stray_copy_beside_the_shelves_is_not_judged(shelved: Path, tmp_path: Path) -> None:
    """Neither where it is sound nor in place of what lies on the shelf."""
    folder = tmp_path / "many"
    shutil.copytree(shelved, folder)
    shutil.copy(folder / "cad" / "many-outer.dxf", folder / "many-inner.dxf")
    assert check(folder).ok
    shutil.move(folder / "many-inner.dxf", folder / "cad" / "many-inner.dxf")
    shutil.copy(shelved / "cad" / "many-inner.dxf", folder / "many-inner.dxf")
    assert not check(folder).ok


@pytest.mark.long
def test_another_part_in_place_of_one_on_its_shelf_fails(shelved: Path, tmp_path: Path) -> None:
    folder = tmp_path / "many"
    shutil.copytree(shelved, folder)
    shutil.copy(folder / "cad" / "many-outer.dxf", folder / "cad" / "many-inner.dxf")
    assert not check(folder).ok


@pytest.mark.long
def test_motion_finds_a_file_by_the_name_that_it_has_in_a_flat_folder(
    shelved: Path, tmp_path: Path
) -> None:
    request = Request(follower="translating,shape=roller,radius=5")
    flat, shelf_ = (
        run(path, request, tmp_path).numbers
        for path in (shelved / "many-inner.dxf", shelved / "cad" / "many-inner.dxf")
    )
    assert flat == shelf_ and flat
