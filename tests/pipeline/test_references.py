"""Files that a spec names: all of them, and all by one rule."""

from __future__ import annotations

import copy
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from camgen import reading
from camgen.bounds import Bound
from camgen.design.run import design
from camgen.errors import FileError, SpecError, dotted
from camgen.machines.sources import files_of, read_mechanism
from camgen.settings import override

LAW = "{ name = 'table', file = 'FILE' }"
# Where a spec may name a file: a starter, how the key is set, and its path.
PLACES = [
    ("disc-cam", f"segment.0.law={LAW}", "segment.0.law.file"),
    ("linkage", "include=[{ spec = 'FILE' }]", "include.0.spec"),
    (
        "linkage",
        f"drive.segment=[{{ kind = 'rise', span_deg = 360, to = 360, law = {LAW} }}]",
        "drive.segment.0.law.file",
    ),
    (
        "linkage",
        f"cam=[{{ segment = [{{ kind = 'rise', law = {LAW} }}] }}]",
        "cam.0.segment.0.law.file",
    ),
    ("linkage", "load.on=[{ name = 'x', output = 'swing', file = 'FILE' }]", "load.on.0.file"),
    (
        "linkage",
        f"include=[{{ spec = {{ segment = [{{ law = {LAW} }}] }} }}]",
        "include.0.spec.segment.0.law.file",
    ),
    ("indexing-cam", f"geometry.law={LAW}", "geometry.law.file"),
    ("chain-stitch-looper", f"timing.needle={LAW}", "timing.needle.file"),
    (
        "chain-stitch-looper",
        f"timing.spreader_segment=[{{ kind = 'rise', law = {LAW} }}]",
        "timing.spreader_segment.0.law.file",
    ),
]
AWAY = [
    "/etc/passwd",
    "//etc/passwd",
    "C:/Windows/win.ini",
    "C:win.ini",
    "..\\\\win.ini",
    "\\\\\\\\host\\\\x",
]


@pytest.mark.parametrize(("starter", "setting", "path"), PLACES, ids=[path for *_, path in PLACES])
def test_each_place_is_known_and_leads_nowhere_but_beside_the_spec(
    root: Path, starter: str, setting: str, path: str
) -> None:
    plain = reading.read(root / "specs" / f"{starter}.toml")
    data = override(plain, setting.replace("FILE", "other.csv"))
    assert [(dotted(each.path), each.name) for each in reading.references(data)] == [
        (path, "other.csv")
    ]
    assert [each.path for each in reading.references(plain)] == []
    for name in AWAY:
        (reference,) = reading.references(override(plain, setting.replace("'FILE'", f'"{name}"')))
        with pytest.raises(SpecError) as told:
            reference.file(root / "specs")
        assert [fault.key for fault in told.value.faults] == [
            path
        ] and "relative path" in told.value.faults[0].expected


@pytest.mark.parametrize(("starter", "setting", "path"), PLACES, ids=[path for *_, path in PLACES])
def test_a_file_elsewhere_is_never_opened(
    root: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    starter: str,
    setting: str,
    path: str,
) -> None:
    (secret := tmp_path / "secret.csv").write_text("0,0\nsecret,1\n1,1\n", encoding="utf-8")
    opened = list[Path]()
    real = reading.read_bytes

    def seen(file: Path, bound: Bound) -> bytes:
        opened.append(Path(file).resolve())
        return real(file, bound)

    for module in (reading, sys.modules["camgen.motion.tables"]):
        monkeypatch.setattr(module, "read_bytes", seen)
    (spec := tmp_path / "spec.toml").write_text(
        (root / "specs" / f"{starter}.toml").read_text("utf-8"), encoding="utf-8"
    )
    for name in (str(secret), f"C:{secret.name}"):
        data = override(reading.read(spec), setting.replace("FILE", name))
        with pytest.raises(SpecError) as told:
            read_mechanism(data)
        assert path in [fault.key for fault in told.value.faults] and "secret,1" not in str(
            told.value
        )
    assert secret not in opened and spec in opened


def test_all_laws_that_name_no_file_so_are_told_at_once(root: Path) -> None:
    data = reading.read(root / "specs" / "disc-cam.toml")
    data["segment"] = [
        {**each, "law": {"name": "table", "file": f"/x{k}"}}
        for k, each in enumerate(data["segment"])
    ]
    with pytest.raises(SpecError) as told:
        read_mechanism(data)
    assert [fault.key for fault in told.value.faults] == [
        f"segment.{k}.law.file" for k in range(len(data["segment"]))
    ]


def test_a_wanted_path_is_named_by_the_same_rule(tmp_path: Path) -> None:
    (tmp_path / "secret.csv").write_text("0,0\n1,1\n2,0\n", encoding="utf-8")
    spec: dict[str, Any] = {
        "mechanism": "linkage",
        "name": "x",
        "wanted": {"path": str(tmp_path / "secret.csv")},
    }
    (reference,) = reading.references(spec)
    assert reference.path == ("wanted", "path")
    with pytest.raises(SpecError, match=r"wanted\.path.*relative path"):
        design(spec)


def test_a_law_is_read_beside_its_spec_from_wherever_camgen_runs(
    root: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (folder := tmp_path / "specs").mkdir()
    rows = "".join(
        f"{x:.4f},{x - np.sin(2 * np.pi * x) / (2 * np.pi):.9f}\n" for x in np.linspace(0, 1, 41)
    )
    (folder / "law.csv").write_text(rows, encoding="utf-8")
    text = (root / "specs" / "chain-stitch-looper.toml").read_text("utf-8")
    (folder / "looper.toml").write_text(text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    made = read_mechanism(
        folder / "looper.toml", ["timing.needle={ name = 'table', file = 'law.csv' }"]
    )
    assert made.timing.needle.source == "law.csv" and len(made.timing.needle.points) == 41  # type: ignore[attr-defined]
    with pytest.raises(FileError, match="law.csv"):
        read_mechanism(
            reading.read(folder / "looper.toml") | {},
            ["timing.needle={ name = 'table', file = 'law.csv' }"],
        )


def test_a_file_outside_the_spec_s_folder_is_read_and_told(root: Path, tmp_path: Path) -> None:
    (folder := tmp_path / "specs").mkdir()
    (tmp_path / "rise.csv").write_text("0 0\n1 1\n2 3\n3 4\n", encoding="utf-8")
    (folder / "cam.toml").write_text(
        (root / "specs" / "disc-cam.toml").read_text("utf-8"), encoding="utf-8"
    )
    made = read_mechanism(
        folder / "cam.toml", ["segment.0.law={ name = 'table', file = '../rise.csv', rest = true }"]
    )
    assert made.hints == (
        "segment.0.law.file was read from ../rise.csv, outside the spec's folder",
    )


def test_files_of_a_spec_and_of_those_that_it_includes(tmp_path: Path) -> None:
    """Whether they are there or not; an included spec includes none."""
    (tmp_path / "sub").mkdir()
    texts = {
        "a.toml": "include = [{ spec = 'sub/b.toml' }, { spec = 'none.toml' }, { spec = '/etc/hosts' }]\nname = 'a'\n",
        "sub/b.toml": "include = [{ spec = '../a.toml' }]\nload = { on = [{ file = 'load.csv' }] }\n",
    }
    for name, text in texts.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    found = [file.relative_to(tmp_path).as_posix() for file in files_of(tmp_path / "a.toml")]
    assert found == ["a.toml", "sub/b.toml", "none.toml", "sub/load.csv"]
    (tmp_path / "a.toml").write_text("no toml", encoding="utf-8")
    assert files_of(tmp_path / "a.toml") == [tmp_path / "a.toml"]


def test_references_change_nothing(root: Path) -> None:
    data = reading.read(root / "specs" / "stitch-head.toml")
    before = copy.deepcopy(data)
    assert {each.kind for each in reading.references(data)} == {"spec"} and data == before
