"""What a build makes beside the parts' own files: damaged or lost, with a mended manifest too, `check` fails or names it."""

from __future__ import annotations

import hashlib
import json
import re
import shutil
import struct
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from judged import judged
from stl_rows import TRIANGLE

from camgen.errors import FileError
from camgen.pipeline import build as pipeline
from camgen.pipeline import rebuild
from camgen.report.report import Report

ROOT = Path(__file__).resolve().parents[2]
ALL = frozenset(rebuild.ANY_KIND) - {"mjcf", "plots", *rebuild.RENDERED}
# A cam alone, of sheet, with all tables: every kind of file but those of a linkage's chain.
CAM = (
    "parts.hub_height=0",
    "laser.thickness=6",
    "parts.thickness=6",
    "output.profile_step_deg=5",
    "output.cutter_radius=3",
)
Damage = Callable[[bytes], bytes]


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("sound")
    report = pipeline.build(ROOT / "specs" / "disc-cam.toml", out, ALL, CAM)
    assert report.ok, [finding for finding in report.findings if not finding.ok]
    return out / "disc-cam"


@pytest.fixture
def folder(sound: Path, tmp_path: Path) -> Path:
    """A copy of it to be damaged."""
    return Path(shutil.copytree(sound, tmp_path / "disc-cam"))


def mended(folder: Path, **about: object) -> None:
    """The manifest as it were if the folder had been built as it is now."""
    path = folder / "manifest.json"
    manifest = json.loads(path.read_text(encoding="utf-8"))
    data = {each.name: each.read_bytes() for each in sorted(folder.iterdir()) if each != path}
    files = {
        name: {"bytes": len(each), "sha256": hashlib.sha256(each).hexdigest()}
        for name, each in data.items()
    }
    path.write_text(json.dumps({**manifest, **about, "files": files}), encoding="utf-8")


def failing(folder: Path) -> set[str]:
    """Codes that fail, or that a file cannot be read."""
    try:
        return {finding.code for finding in judged(folder).findings if not finding.ok}
    except FileError:
        return {"FileError"}


@pytest.mark.long
def test_a_sound_folder_is_as_it_is_made_anew(folder: Path) -> None:
    report = judged(folder)
    (anew,) = [finding for finding in report.findings if finding.code == "REBUILD"]
    assert report.ok and not report.not_judged and not report.remarks and "14 files" in anew.message


@pytest.mark.long
@pytest.mark.parametrize("kinds", ["dxf", "report", "stl,3mf,report", "step"])
def test_a_smaller_build_is_as_it_is_made_anew(kinds: str, tmp_path: Path) -> None:
    settings = ("geometry.closure='conjugate'", "output.profile_step_deg=5")
    pipeline.build(
        ROOT / "specs" / "disc-cam.toml", tmp_path, frozenset(kinds.split(",")), settings
    )
    assert failing(tmp_path / "disc-cam") == set()


# ---- lost ------------------------------------------------------------------------------------------------------------


def names(folder: Path) -> Iterator[str]:
    yield from sorted(
        path.name for path in folder.iterdir() if path.name not in ("spec.toml", "manifest.json")
    )


@pytest.mark.long
def test_every_file_that_is_lost_is_told(sound: Path, folder: Path) -> None:
    """Of each file, by itself, with a manifest that does not list it."""
    quiet = []
    for name in names(sound):
        (folder / name).unlink()
        mended(folder)
        quiet += [] if failing(folder) else [name]
        shutil.copy(sound / name, folder)
    assert len(list(names(sound))) > 15 and quiet == []


@pytest.mark.long
@pytest.mark.parametrize("ending", ["stl", "dxf", "step", "html"])
def test_a_whole_kind_that_is_lost_is_told(folder: Path, ending: str) -> None:
    for path in folder.glob(f"*.{ending}"):
        path.unlink()
    mended(folder)
    assert failing(folder)


@pytest.mark.long
def test_all_lost_files_are_told_at_once(folder: Path) -> None:
    for name in ("motion.csv", "disc-cam-cam.stl"):
        (folder / name).unlink()
    with pytest.raises(FileError, match="2 files that manifest.json lists are missing") as caught:
        judged(folder)
    said = str(caught.value)
    assert all(f"{name} (not there)" in said for name in ("motion.csv", "disc-cam-cam.stl"))
    assert f"camgen build {folder / 'spec.toml'} --out {folder.parent}" in said
    pipeline.build(folder / "spec.toml", folder.parent, ALL)  # what it says mends it
    assert failing(folder) == set()


@pytest.mark.long
def test_a_file_of_no_such_build_is_told(folder: Path) -> None:
    (folder / "disc-cam-lever.csv").write_text("1\n", encoding="utf-8")
    assert failing(folder) == set()  # somebody's own
    mended(folder)
    assert failing(folder) == {"REBUILD"}


# ---- damaged ---------------------------------------------------------------------------------------------------------


def digit(data: bytes) -> bytes:
    """After the middle the first digit of a number that is not tiny is one more, unless it is a 9; of packed bytes any digit."""
    first, any_ = re.compile(rb"(?<=[ ,])[0-8](?![\d.]*e-)"), re.compile(rb"[0-8]")
    match = first.search(data, len(data) // 2) or any_.search(data, len(data) // 2)
    assert match is not None
    return data[: match.start()] + bytes([match[0][0] + 1]) + data[match.end() :]


def replaced(was: str, now: str) -> Damage:
    def edit(data: bytes) -> bytes:
        assert was.encode() in data
        return data.replace(was.encode(), now.encode())

    return edit


def in_glb(edit: Callable[[dict[str, Any], bytearray], None]) -> Damage:
    """Damage of the two chunks of a GLB."""

    def changed(data: bytes) -> bytes:
        (length,) = struct.unpack_from("<I", data, 12)
        whole, rest = json.loads(data[20 : 20 + length]), bytearray(data[28 + length :])
        edit(whole, rest)
        text = json.dumps(whole).encode()
        text += b" " * (-len(text) % 4)
        head = struct.pack("<4sIII4s", b"glTF", 2, 28 + len(text) + len(rest), len(text), b"JSON")
        return head + text + struct.pack("<I4s", len(rest), b"BIN\0") + bytes(rest)

    return changed


def node(number: int, **keys: object) -> Damage:
    return in_glb(lambda whole, _: whole["nodes"][number].update(keys))


def sample(whole: dict[str, Any], data: bytearray) -> None:
    """The body is 1 deg on at one moment."""
    output = whole["accessors"][whole["animations"][0]["samplers"][0]["output"]]
    place = whole["bufferViews"][output["bufferView"]]["byteOffset"] + 100 * 16
    turn = struct.unpack_from("<4f", data, place)
    half = np.arctan2(turn[2], turn[3]) + np.radians(0.5)
    struct.pack_into("<4f", data, place, 0, 0, np.sin(half), np.cos(half))


def vertex(whole: dict[str, Any], data: bytearray) -> None:
    struct.pack_into("<f", data, whole["bufferViews"][0]["byteOffset"] + 120, 3.0)


def stl(data: bytes) -> bytes:
    triangles = np.frombuffer(data[84:], TRIANGLE).copy()
    triangles["corners"][5, 0, 0] += 1
    return data[:84] + triangles.tobytes()


def dxf(edit: Callable[[Any], object], folder: Path) -> Damage:
    def changed(data: bytes) -> bytes:
        (path := folder / "x.dxf").write_bytes(data)
        drawing = ezdxf.readfile(path)
        edit(drawing)
        drawing.saveas(path)
        data = path.read_bytes()
        path.unlink()
        return data

    return changed


def larger(drawing: Any) -> None:
    """The outline, a tenth larger."""
    outline = max(drawing.modelspace().query("LWPOLYLINE[layer=='CUT']"), key=len)
    outline.set_points([(1.1 * x, 1.1 * y, *rest) for x, y, *rest in outline.get_points()])


def dimension(drawing: Any) -> None:
    block = drawing.modelspace().query("DIMENSION")[0].get_geometry_block()
    text = next(each for each in block if each.dxftype() == "TEXT")
    text.dxf.text = "1" + text.dxf.text


def circle(drawing: Any) -> None:
    drawing.modelspace().query("CIRCLE")[0].dxf.radius += 0.05


def packed(folder: Path) -> Damage:
    """A 3MF with one vertex elsewhere."""

    def changed(data: bytes) -> bytes:
        (path := folder / "x.zip").write_bytes(data)
        with zipfile.ZipFile(path) as package:
            parts = {name: package.read(name) for name in package.namelist()}
        with zipfile.ZipFile(path, "w") as package:
            for name, text in parts.items():
                package.writestr(
                    name, re.sub(rb'<vertex x="[^"]*"', b'<vertex x="1.234"', text, count=1)
                )
        data = path.read_bytes()
        path.unlink()
        return data

    return changed


# name -> what is done to it, and which finding is to say so
KINDS: dict[str, tuple[str, str]] = {
    "motion": ("motion.csv", "REBUILD"),
    "report": ("report.json", "REBUILD"),
    "page": ("report.html", "REBUILD"),
    "list": ("disc-cam-parts.csv", "PARTS_LIST"),
    "pdf": ("disc-cam-cam-drawing.pdf", "REBUILD"),
    "profile": ("disc-cam-cam-profile.csv", "ROUND_TRIP"),
    "path": ("disc-cam-cam-path.csv", "ROUND_TRIP"),
    "sheets": ("disc-cam-sheets.csv", ""),
    "sheet": ("disc-cam-sheet-1.svg", "ROUND_TRIP"),
}


@pytest.mark.long
@pytest.mark.parametrize("name", KINDS)
def test_one_digit_of_a_text_is_told(folder: Path, name: str) -> None:
    file, code = KINDS[name]
    path = folder / file
    path.write_bytes(digit(path.read_bytes()))
    mended(folder)
    found = failing(folder)
    assert found and (code in found or "FileError" in found or not code)


@pytest.mark.long
@pytest.mark.parametrize(
    "file, damage, code",
    [
        ("motion.csv", replaced("theta_deg", "theta"), "REBUILD"),
        ("report.html", replaced("findings hold", "findings h0ld"), "REBUILD"),
        ("report.json", replaced('"ok": true', '"ok": false'), "REBUILD"),
        ("report.json", lambda data: b"[" * 100_000, "REBUILD"),
        ("disc-cam-parts.csv", replaced(",1,", ",2,"), "PARTS_LIST"),
        ("disc-cam-parts.csv", lambda data: data + b"bought,dowel,,1\n", "PARTS_LIST"),
        ("disc-cam-assembly.glb", node(1, rotation=[0, 0, 1, 0]), "FileError"),
        ("disc-cam-assembly.glb", node(1, scale=[1, 1, 1]), "FileError"),
        ("disc-cam-assembly.glb", node(0, scale=[0.002] * 3), "FileError"),
        (
            "disc-cam-assembly.glb",
            node(2, matrix=[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 1]),
            "ROUND_TRIP",
        ),
        ("disc-cam-assembly.glb", in_glb(lambda whole, _: whole.pop("animations")), "ROUND_TRIP"),
        ("disc-cam-assembly.glb", in_glb(sample), "ROUND_TRIP"),
        ("disc-cam-assembly.glb", in_glb(vertex), "REBUILD"),
        ("disc-cam-assembly.glb", lambda data: data[:1000], "FileError"),
        ("disc-cam-assembly.glb", lambda data: b"glTF" + b"\xff" * 40, "FileError"),
        ("disc-cam-cam.stl", stl, "WATERTIGHT"),
        ("disc-cam-sheet-1.svg", replaced("<circle ", '<circle display="none" '), "ROUND_TRIP"),
        ("disc-cam-cam.step", replaced("CARTESIAN_POINT('',(", "CARTESIAN_POINT('',(1"), ""),
        ("disc-cam-assembly.step", replaced("CARTESIAN_POINT('',(", "CARTESIAN_POINT('',(1"), ""),
    ],
)
def test_a_damage_is_told(folder: Path, file: str, damage: Damage, code: str) -> None:
    path = folder / file
    was = path.read_bytes()
    path.write_bytes(damage(was))
    assert path.read_bytes() != was
    mended(folder)
    found = failing(folder)
    assert code in found if code else found


@pytest.mark.long
@pytest.mark.parametrize(
    "file, edit, codes",
    [
        ("disc-cam-cam-drawing.dxf", larger, {"ROUND_TRIP", "REBUILD"}),
        ("disc-cam-cam-drawing.dxf", dimension, {"REBUILD"}),
        ("disc-cam-cam-path.dxf", larger, {"ROUND_TRIP", "CUTTER", "REBUILD"}),
        ("disc-cam-cam.dxf", circle, {"ROUND_TRIP"}),
        ("disc-cam-sheet-1.dxf", circle, {"ROUND_TRIP"}),
    ],
)
def test_a_drawing_that_is_damaged_is_told(
    folder: Path, file: str, edit: Callable[[Any], object], codes: set[str]
) -> None:
    path = folder / file
    path.write_bytes(dxf(edit, folder)(path.read_bytes()))
    mended(folder)
    assert failing(folder) >= codes


@pytest.mark.long
@pytest.mark.parametrize("file", ["disc-cam-cam.3mf", "disc-cam-assembly.3mf"])
def test_a_package_that_is_damaged_is_told(folder: Path, file: str) -> None:
    path = folder / file
    path.write_bytes(packed(folder)(path.read_bytes()))
    mended(folder)
    assert failing(folder)


@pytest.mark.long
def test_a_plate_that_is_damaged_or_lost_and_the_chain_of_a_linkage_are_told(
    tmp_path: Path,
) -> None:
    report = pipeline.build(
        ROOT / "specs" / "gallery" / "four-bar.toml", tmp_path, frozenset({"3mf"})
    )
    folder = Path(str(report.folder))
    for name, damage in (
        ("four-bar-plate.3mf", packed(folder)),
        ("four-bar-chain.pmks", digit),
        ("four-bar-chain.svg", digit),
    ):
        was = (path := folder / name).read_bytes()
        path.write_bytes(damage(was))
        mended(folder)
        assert failing(folder), name
        path.unlink()
        mended(folder)
        assert failing(folder), name
        path.write_bytes(was)
        mended(folder)
    assert failing(folder) == set()


# ---- by others, and by this one's own digits -------------------------------------------------------------------------


OTHERS = [
    {"camgen": "0.0"},
    {"packages": {"numpy": "1.0"}},
    {"packages": 5},
    {"system": "Linux x86_64 X86_V2"},
]


@pytest.mark.long
def test_a_folder_of_another_version_holds_where_every_byte_is_the_same(folder: Path) -> None:
    mended(folder, camgen="0.0", kinds=7)
    report = judged(folder)
    assert report.ok and not report.not_judged


@pytest.mark.long
@pytest.mark.parametrize("about", OTHERS, ids=str)
def test_of_a_folder_of_other_versions_what_is_left_is_named(
    folder: Path, about: dict[str, object]
) -> None:
    path = folder / "motion.csv"
    path.write_bytes(digit(path.read_bytes()))
    mended(folder, **about)
    report = judged(folder)
    (named,) = report.not_judged
    assert (
        report.ok
        and named.code == "REBUILD"
        and "motion.csv" in named.why
        and "REBUILD" in report.verdict
    )


@pytest.mark.long
def test_what_a_shop_reads_is_read_back_whoever_built_it(folder: Path) -> None:
    """Nothing is made anew to be compared, and a drawing, a parts list and the machine in motion fail by what they hold."""
    for file, damage in (
        ("disc-cam-cam-drawing.dxf", dxf(larger, folder)),
        ("disc-cam-parts.csv", replaced(",1,", ",2,")),
        ("disc-cam-assembly.glb", in_glb(sample)),
        ("disc-cam-cam-profile.csv", digit),
    ):
        was = (path := folder / file).read_bytes()
        path.write_bytes(damage(was))
        mended(folder, camgen="0.0")
        report = judged(folder)
        assert {str(f.where).split(",")[0] for f in report.findings if not f.ok} == {file}, file
        assert [file in each.why for each in report.not_judged if each.code == "REBUILD"] == [True]
        path.write_bytes(was)


def last_digits(text: str, more: float) -> str:
    """Every third number with many digits a little larger."""
    count = iter(range(10**6))
    edit = lambda match: f"{float(match[0]) + more:.12g}" if next(count) % 3 == 0 else match[0]  # noqa: E731
    return re.sub(r"(?<![\d.])\d+\.\d{6,}", edit, text)


@pytest.mark.long
def test_last_digits_are_another_processor_s(folder: Path) -> None:
    """By numpy's functions they differ from one to the next: seen up to 3e-10 mm in drawings, 1e-10 in motion.csv."""
    for name in ("motion.csv", "disc-cam-cam-profile.csv", "disc-cam-cam-drawing.dxf"):
        path = folder / name
        text = path.read_text(encoding="utf-8")
        path.write_text(other := last_digits(text, 3e-10), encoding="utf-8")
        assert other != text
    mended(folder, system="another")
    assert failing(folder) == set()
    path = folder / "motion.csv"
    path.write_text(last_digits(path.read_text(encoding="utf-8"), 1e-6), encoding="utf-8")
    mended(folder, system=rebuild.system())
    assert failing(folder) == {"REBUILD"}


@given(st.floats(-1e3, 1e3), st.floats(1e-8, 1.0), st.sampled_from(["x{}", "<td>{}</td>", "{},7"]))
def test_numbers_that_are_the_same_are_so_by_a_billionth(
    value: float, off: float, text: str
) -> None:
    there, anew = text.format(repr(value + off * (1 + abs(value)))), text.format(repr(value))
    assert not rebuild._same(there, anew) and rebuild._same(anew, anew)
    assert rebuild._same(text.format(repr(value + 1e-11)), anew) or "e" in repr(
        value + 1e-11
    ) + repr(value)
    assert not rebuild._same(anew + " ", anew) and not rebuild._same("y" + anew, anew)


@pytest.mark.long
def test_a_part_that_was_changed_and_holds_makes_the_report_another_one_s(folder: Path) -> None:
    """It is judged as it is now; what the build said of it is named, not failed."""
    path = folder / "disc-cam-cam.dxf"
    drawing = ezdxf.readfile(path)
    outline = max(drawing.modelspace().query("LWPOLYLINE"), key=len)
    outline.set_points([(x + 2e-5, y, *rest) for x, y, *rest in outline.get_points()])
    drawing.saveas(path)
    report: Report = judged(folder)
    assert report.ok, [finding for finding in report.findings if not finding.ok]
    assert any("judged as they are now: disc-cam-cam.dxf" in remark for remark in report.remarks)
    assert any(
        "as they were: motion.csv, report.html, report.json" in remark for remark in report.remarks
    )
    mended(folder)
    assert failing(folder) == {"REBUILD"}


@pytest.mark.long
@pytest.mark.parametrize("again", [False, True])
def test_reports_that_follow_from_what_fails_are_not_told_again(folder: Path, again: bool) -> None:
    """A parts list with one more: the reports of the build said that all holds, which is no second fault."""
    path = folder / "disc-cam-parts.csv"
    path.write_bytes(path.read_bytes().replace(b",1,", b",2,", 1))
    if again:
        mended(folder)
    report = judged(folder)
    bad = {finding.code for finding in report.findings if not finding.ok}
    assert bad == ({"PARTS_LIST", "REBUILD"} if again else {"PARTS_LIST", "MANIFEST"})
    told = [finding.message for finding in report.findings if finding.code == "REBUILD"]
    assert not any("report." in message for message in told)
    assert any(
        "not those that fail now: report.html, report.json" in each for each in report.remarks
    )
    (folder / "report.html").unlink()
    mended(folder)
    (anew,) = (each for each in judged(folder).findings if each.code == "REBUILD")
    assert not anew.ok and "report.html is not there" in anew.message
