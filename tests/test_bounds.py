"""Files that hold too much are refused before they are read: by bytes, by what is in them, in words and with an exit code."""

from __future__ import annotations

import os
import struct
import tomllib
from collections.abc import Callable
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w
from hypothesis import example, given
from hypothesis import strategies as st

from camgen import bounds, reading
from camgen.bounds import Bound, bounded, read_bytes
from camgen.cli import main
from camgen.errors import MOST_LISTED, FileError, SpecError
from camgen.files.formats import FORMATS, READABLE
from camgen.files.gcode import hole_walls, read_gcode
from camgen.geometry.mesh import MOST_TRIANGLES
from camgen.machines.spec_files import with_tables
from camgen.motion import tables
from camgen.motion.tables import read_table
from camgen.study import Table

SPECS = Path(__file__).resolve().parent.parent / "specs"
DISC = (SPECS / "disc-cam.toml").read_text(encoding="utf-8")
WORDS = Bound("a list of words", 1000, b" \n", "words", 5, "use fewer")

# ---- a bound ----


@pytest.mark.parametrize("chunk", [1, 3, 1 << 20])
def test_things_are_counted_however_they_are_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, chunk: int
) -> None:
    monkeypatch.setattr(bounds, "_CHUNK", chunk)
    path = tmp_path / "a"
    path.write_bytes(b"aa bb\ncc dd\nee ")
    assert read_bytes(path, WORDS) == b"aa bb\ncc dd\nee " and bounded(path, WORDS) == 15
    path.write_bytes(b"aa bb\ncc dd\nee ff\n")
    with pytest.raises(
        FileError, match="has 6 words; at most 5 are read of a list of words: use fewer"
    ):
        read_bytes(path, WORDS)


def test_bytes_are_looked_at_first(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bounds, "_CHUNK", "nothing is read")
    bound = Bound("a list", 2_000_000, most=5)
    with open(tmp_path / "a", "wb") as file:
        file.truncate(3_000_000)
    with pytest.raises(FileError, match="is 3 MB large; at most 2 MB are read of a list$"):
        bounded(tmp_path / "a", bound)
    (tmp_path / "b").write_bytes(b"\n" * 5)  # so few bytes hold no more things
    assert bounded(tmp_path / "b", bound) == 5


def test_only_plain_files(tmp_path: Path) -> None:
    for path, said in (
        (tmp_path, "is a folder, a list of words was expected"),
        (tmp_path / "none", "cannot be read: "),
        (Path("a\0b"), "cannot be read: "),
    ):
        with pytest.raises(FileError, match=said):
            bounded(path, WORDS)
    if hasattr(os, "mkfifo"):
        os.mkfifo(tmp_path / "pipe")
        with pytest.raises(FileError, match="is a pipe or a device"):
            bounded(tmp_path / "pipe", WORDS)


# ---- specs ----

MANY = {
    "keys": (
        "".join(f"k{k}=1\n" for k in range(700_000)) + DISC,
        "spec: 700,[0-9]+ keys and tables - expected at most 20,000",
    ),
    "values": (
        "x=[" + "1," * 4_900_000 + "1]\n" + DISC,
        "spec: 4,900,[0-9]+ values in lists - expected at most 500,000",
    ),
    "tables": (
        DISC + "[[segment]]\n" * 700_000,
        "spec: 700,[0-9]+ keys and tables - expected at most 20,000",
    ),
    "inner lists": (
        "x=[" + "[]," * 3_000_000 + "]\n" + DISC,
        "values in lists - expected at most 500,000",
    ),
    "inner tables": (
        "x=[" + "{}," * 3_000_000 + "]\n" + DISC,
        "values in lists - expected at most 500,000",
    ),
    "keys of inner tables": (
        "x=[" + "{a=1}," * 700_000 + "]\n" + DISC,
        "keys and tables - expected at most 20,000",
    ),
}


@pytest.mark.parametrize("text, said", MANY.values(), ids=MANY)
def test_a_spec_of_too_much_is_never_parsed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, text: str, said: str
) -> None:
    def parsed(text: str) -> None:
        raise AssertionError("it was")

    monkeypatch.setattr(tomllib, "loads", parsed)
    path = tmp_path / "a.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(SpecError, match=said):
        reading.read(path)


def test_keys_that_count_twice_are_counted_once_read(tmp_path: Path) -> None:
    """`a.b = 1` is a table and its key, and so is all that Python hands over."""
    path = tmp_path / "a.toml"
    path.write_text("".join(f"k{k}.a=1\n" for k in range(10_001)), encoding="utf-8")
    with pytest.raises(SpecError, match="20,002 keys and tables"):
        reading.read(path)
    with pytest.raises(SpecError, match="20,001 keys and tables"):
        reading.tables({str(k): 1 for k in range(20_001)})
    with pytest.raises(SpecError, match="500,001 values in lists"):
        reading.tables({"x": [0] * 500_001})
    assert reading.tables({"x": [0] * 500_000, **{str(k): 1 for k in range(19_999)}})


def test_the_exit_code_is_that_of_a_wrong_spec(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "a.toml"
    path.write_text(MANY["keys"][0], encoding="utf-8")
    with pytest.raises(SystemExit) as done:
        main(["build", str(path), "-o", str(tmp_path / "out")])
    err = capsys.readouterr().err
    assert (
        done.value.code == 2
        and len(err.splitlines()) == 2
        and "at most 20,000" in err
        and not (tmp_path / "out").exists()
    )


TEXT = st.text("abc,=[]#\n'\"", max_size=5)
VALUES: st.SearchStrategy[Any] = st.recursive(
    st.integers(-9, 9) | st.booleans() | TEXT,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(TEXT, inner, max_size=4),
    max_leaves=30,
)


@pytest.mark.long
@example({",": [{"": [0]}]})
@example({'a"=': [{"'#": 1}]})
@given(st.dictionaries(TEXT, VALUES, max_size=6))
def test_nothing_that_is_there_is_left_uncounted(data: dict[str, Any]) -> None:
    """At a glance no fewer keys are seen than are given, dotted ones apart, and no fewer values in lists."""
    deep, keys, values = reading.extent_of(data)
    assert deep and (keys, values) == (len(flat(data, dict)), len(flat(data, list)))
    seen = reading.counted(tomli_w.dumps(data))
    assert (
        seen[0] >= keys - len([each for each in flat(data, dict) if isinstance(each, dict)])
        and seen[1] >= values
    )


def flat(value: Any, kind: type) -> list[Any]:
    """What stands in the tables, or in the lists, of a value."""
    held = (
        list(value.values())
        if isinstance(value, dict)
        else value
        if isinstance(value, list)
        else []
    )
    return [
        *(held if isinstance(value, kind) else []),
        *(each for inner in held for each in flat(inner, kind)),
    ]


@pytest.mark.parametrize("path", sorted(SPECS.rglob("*.toml")), ids=lambda path: path.stem)
def test_specs_have_far_fewer(path: Path) -> None:
    keys, values = reading.counted(path.read_text(encoding="utf-8"))
    assert keys < reading.MOST_KEYS / 20 and values < reading.MOST_VALUES / 20


def test_of_many_faults_some_are_listed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "a.toml"
    path.write_text("".join(f"k{k}=1\n" for k in range(MOST_LISTED + 23)) + DISC, encoding="utf-8")
    with pytest.raises(SystemExit) as done:
        main(["build", str(path)])
    lines = capsys.readouterr().err.splitlines()
    assert done.value.code == 2 and len(lines) == 1 + MOST_LISTED + 1
    assert "123 faults" in lines[0] and lines[-1].strip() == "and 23 more"


# ---- other files ----


def refused(
    read: Callable[[Path], object], path: Path, said: str, text: bytes = b"1,2\n" * 30
) -> None:
    path.write_bytes(text)
    with pytest.raises(FileError, match=said):
        read(path)


# The format or the constant that bounds a file, who reads it, and a name for it.
READERS = [
    ("dxf", "camgen.files.dxf:read_dxf", "a.dxf"),
    ("step", "camgen.files.step:read_step", "a.step"),
    ("gcode", "camgen.files.gcode:read_gcode", "a.gcode"),
    ("camgen.files.cutting._MOST", "camgen.files.cutting:read_svg", "a.svg"),
    ("camgen.pipeline.laser._SIZE", "camgen.pipeline.laser:_listed", "a.csv"),
    ("camgen.pipeline.machining._SIZE", "camgen.pipeline.machining:_read_path", "a.csv"),
]


def own(read: str) -> Callable[[Path], object]:
    module, _, name = read.partition(":")
    found: Callable[[Path], object] = getattr(import_module(module), name)
    return found


@pytest.mark.parametrize("bound, read, name", READERS, ids=[each[1] for each in READERS])
def test_each_reader_has_a_bound(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, bound: str, read: str, name: str
) -> None:
    function = own(read)
    module, _, constant = bound.rpartition(".")
    old = getattr(import_module(module), constant) if module else READABLE[bound].size
    assert old.most is not None
    new = replace(old, marks=b"\n", most=29)
    if module:
        monkeypatch.setattr(bound, new)
    for formats in (FORMATS, READABLE):
        if not module and bound in formats:
            monkeypatch.setitem(formats, bound, replace(formats[bound], size=new))
    refused(function, tmp_path / name, f"has 30 {old.things}; at most 29 are read of {old.what}")


def test_a_list_of_parts_has_a_bound(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from camgen.judge import parts_table

    monkeypatch.setattr(parts_table, "_SIZE", replace(parts_table._SIZE, most=29))
    wanted = Table("", ("1", "2"), [(1, 2)] * 29)
    refused(
        lambda path: parts_table.judge_list(path, wanted),
        tmp_path / "a.csv",
        "has 30 lines; at most 29 are read of a parts list",
    )
    assert (
        parts_table.judge_list(written(tmp_path / "a.csv", b"1,2\n" * 29), wanted).measured == 1
    )  # one is missing


def test_what_a_glb_says_has_a_bound(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from camgen.files import gltf

    monkeypatch.setattr(gltf, "_MOST_SAID", 29)
    data = struct.pack("<4sIII4s", b"glTF", 2, 50, 30, b"JSON") + bytes(30)
    refused(gltf.read_glb, tmp_path / "a.glb", "30 bytes of JSON; at most 29 are read", data)


def test_triangles_are_counted_before_they_are_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from camgen.files.stl import read_stl
    from camgen.files.threemf import PartCopy, read_3mf, write_3mf
    from camgen.geometry.mesh import Mesh

    assert MOST_TRIANGLES == 2_000_000
    for module in ("stl", "threemf"):
        monkeypatch.setattr(f"camgen.files.{module}.MOST_TRIANGLES", 3)
    refused(
        read_stl,
        tmp_path / "a.stl",
        "4 triangles; at most 3 are",
        bytes(80) + (4).to_bytes(4, "little") + bytes(200),
    )
    facet = b"facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
    refused(
        read_stl,
        tmp_path / "b.stl",
        "4 triangles; at most 3 are",
        b"solid b\n" + 4 * facet + b"endsolid b\n",
    )
    assert (
        len(read_stl(written(tmp_path / "c.stl", b"solid c\n" + 3 * facet + b"endsolid c\n")).faces)
        == 3
    )
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    write_3mf(tmp_path / "d.3mf", {"d": Mesh(corners, faces)}, [PartCopy("d", "d")], "d")
    with pytest.raises(FileError, match="has 4 triangles; at most 3 are"):
        read_3mf(tmp_path / "d.3mf")


def written(path: Path, data: bytes) -> Path:
    path.write_bytes(data)
    return path


@pytest.mark.parametrize("end", [b"\n", b"\r\n", b"\r"])
def test_lines_of_a_table_however_they_end(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, end: bytes
) -> None:
    monkeypatch.setattr(tables, "_MOST_LINES", 30)
    path = written(tmp_path / "a.csv", (b"1,2" + end) * 30)
    assert len(read_table(path)[1]) == 30
    refused(
        read_table,
        path,
        "has 31 lines; at most 30 are read of a table of angle and displacement",
        (b"1,2" + end) * 31,
    )


def test_tables_together_hold_no_more_than_a_spec(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Or the resolved spec, in which their points stand, could not be read."""
    written(tmp_path / "a.csv", b"1,2\n" * 40)
    law = {"name": "table", "file": "a.csv"}
    data = {"segment": [{"law": dict(law)} for _ in range(3)]}
    monkeypatch.setattr(reading, "MOST_VALUES", 360)
    assert len(with_tables(data, tmp_path)["segment"][2]["law"]["points"]) == 40
    monkeypatch.setattr(reading, "MOST_VALUES", 359)
    with pytest.raises(SpecError, match="360 values in lists - expected at most 359"):
        with_tables(data, tmp_path)


# ---- G-code: few lines may hold many walls, and few walls many pairs of them ----


def squares(path: Path, corners: list[tuple[float, float, float]], layers: int = 1) -> Path:
    """Walls along squares: a corner, and the side."""
    lines = ["M83"]
    for k in range(layers):
        lines += [f"G1 Z{0.2 * (k + 1):.1f}"]
        for x, y, side in corners:
            lines += [f"G1 X{x} Y{y} F9000", ";TYPE:External perimeter", ";WIDTH:0.45"]
            lines += [
                f"G1 X{x + a * side} Y{y + b * side} E1"
                for a, b in ((1, 0), (1, 1), (0, 1), (0, 0))
            ]
    return written(path, "\n".join(lines).encode())


def test_walls_are_bounded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = squares(tmp_path / "a.gcode", [(30 * k, 0, 20) for k in range(4)], 5)
    assert len(read_gcode(path)) == 20
    monkeypatch.setattr("camgen.files.gcode._MOST_BESIDE", 3)
    with pytest.raises(
        FileError,
        match="has 4 outer walls at a height of 0.2 mm; at most 3 are read: slice fewer parts",
    ):
        read_gcode(path)
    monkeypatch.setattr("camgen.files.gcode._MOST_WALLS", 18)
    with pytest.raises(
        FileError, match="has more than 18 outer walls: slice fewer parts at a time"
    ):
        read_gcode(path)


def test_walls_that_lie_over_each_other_are_bounded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each meets itself and those of all other layers: 2 bodies of 5 layers make 2 x 25 pairs."""
    from camgen.judge import sliced

    walls = read_gcode(squares(tmp_path / "a.gcode", [(0, 0, 20), (30, 0, 20)], 5))
    for at_once in (1, 3, 500):
        monkeypatch.setattr(sliced, "_AT_ONCE", at_once)
        assert [len(body) for body in sliced.bodies(walls)] == [5, 5]
    monkeypatch.setattr(sliced, "_MOST_MET", 50)
    assert len(sliced.bodies(walls)) == 2
    monkeypatch.setattr(sliced, "_MOST_MET", 49)
    with pytest.raises(OverflowError, match="more than 49 times"):
        sliced.bodies(walls)


def test_holes_lie_in_an_odd_number_of_walls(tmp_path: Path) -> None:
    nested = [(k, k, 40 - 2 * k) for k in range(0, 15, 3)]
    walls = read_gcode(
        squares(tmp_path / "a.gcode", [nested[2], nested[0], (60, 0, 20), *nested[3:], nested[1]])
    )
    assert hole_walls(walls) == [False, False, False, True, False, True]
