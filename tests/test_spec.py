"""Specs: every fault at once, in plain words; a resolved spec reads back equal."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import time
import tomllib
from collections.abc import Sequence
from functools import reduce
from operator import getitem
from pathlib import Path
from typing import Annotated, Any, Literal, get_args

import pytest
import tomli_w
from hypothesis import given
from hypothesis import strategies as st
from pydantic import AfterValidator, Field, model_validator
from pydantic_core import PydanticCustomError

import camgen
from camgen import starters
from camgen.errors import Fault, FileError, SpecError, dotted
from camgen.machines import MECHANISMS, load
from camgen.machines.loads.tables import Model
from camgen.machines.sources import read_mechanism
from camgen.motion.segments import NAMES
from camgen.reading import lines, read
from camgen.schemas import keys_of, step_below
from camgen.settings import override
from camgen.spec import Length, Material, Record, Spec, choose, dump, schema, unknown, validate
from camgen.vocabulary import _EXAMPLES, _KEYS, _LIKELY

TOP = Path(__file__).parents[1]


def even(teeth: int) -> int:
    if teeth % 2:
        raise ValueError("an even number of teeth")
    return teeth


class Rise(Record):
    kind: Literal["rise"]
    lift: Length


class Dwell(Record):
    kind: Literal["dwell"]
    span_deg: Annotated[float, Field(gt=0, lt=360)]


class Shape(Record):
    width: Length
    height: Length
    teeth: Annotated[int, AfterValidator(even)] = 2
    side: Literal["left", "right"] = "left"
    lid: Length | None = None
    ribbed: bool = False
    cut: Rise | Dwell | None = None

    @model_validator(mode="after")
    def upright(self) -> Shape:
        if self.height < self.width:
            raise PydanticCustomError(
                "upright", "height to be at least the width, {width}", {"width": self.width}
            )
        return self


class Box(Spec):
    shape: Shape
    segment: tuple[Annotated[Rise | Dwell, Field(discriminator="kind")], ...] = ()

    def faults(self) -> Sequence[Fault]:
        return [Fault(("shape", "lid"), "9", "a small lid")] if self.shape.lid == 9 else []


def box(**shape: Any) -> dict[str, Any]:
    return {"mechanism": "box", "name": "a-box", "shape": {"width": 2, "height": 3.5} | shape}


def faults(data: dict[str, Any]) -> dict[str, Fault]:
    """The faults of a box by path; none may be listed twice."""
    with pytest.raises(SpecError) as caught:
        validate(Box, data, "box.toml")
    found = {fault.key: fault for fault in caught.value.faults}
    assert len(found) == len(caught.value.faults)
    assert caught.value.exit_code == 2
    assert all(path in str(caught.value) for path in ("box.toml", *found))
    return found


@pytest.mark.parametrize(
    "shape, path, value, expected",
    [
        ({"width": -1}, "shape.width", "-1", "a number >= 0.001 and <= 1000000"),
        ({"width": 0}, "shape.width", "0", "a number >= 0.001 and <= 1000000"),
        ({"width": "2"}, "shape.width", "'2'", "a number without quotes: write 2"),
        ({"width": True}, "shape.width", "true", "a number >= 0.001 and <= 1000000, in mm"),
        (
            {"width": 8e-4},
            "shape.width",
            "0.0008",
            "a number >= 0.001 and <= 1000000; lengths are in mm: 0.8?",
        ),
        ({"width": 1e-300}, "shape.width", "1e-300", "a number >= 0.001 and <= 1000000"),
        ({"width": float("nan")}, "shape.width", "nan", "a number >= 0.001 and <= 1000000"),
        ({"width": float("-inf")}, "shape.width", "-inf", "a number >= 0.001 and <= 1000000"),
        (
            {"width": 10**400},
            "shape.width",
            "a number of about 1e400",
            "a number >= 0.001 and <= 1000000",
        ),
        ({"width": [1]}, "shape.width", "[1]", "a number >= 0.001 and <= 1000000"),
        ({"width": {"a": 1}}, "shape.width", "a table with a", "a number >= 0.001 and <= 1000000"),
        ({"lid": "x"}, "shape.lid", "'x'", "a number >= 0.001 and <= 1000000"),
        ({"teeth": 2.5}, "shape.teeth", "2.5", "a whole number"),
        ({"teeth": 3}, "shape.teeth", "3", "an even number of teeth"),
        ({"side": "lef"}, "shape.side", "'lef'", "one of 'left', 'right'"),
        ({"ribbed": 1}, "shape.ribbed", "1", "true or false"),
        (
            {"height": 1},
            "shape",
            "a table with width, height",
            "height to be at least the width, 2.0",
        ),
        ({"cut": 5}, "shape.cut", "5", "a table with kind, lift or a table with kind, span_deg"),
        ({"lid": 9}, "shape.lid", "9", "a small lid"),
    ],
)
def test_fault_names_path_value_and_what_would_be_right(
    shape: Any, path: str, value: str, expected: str
) -> None:
    found = faults(box(**shape))
    nearest = "left" if value == "'lef'" else None
    assert found == {path: Fault(tuple(path.split(".")), value, expected, nearest)}


def test_all_faults_at_once_with_nearest_keys() -> None:
    data = box(widht=4, side=3, heigth=1) | {
        "nmae": "x",
        "print": {"bed": [220], "nozle": 1},
        "accuracy": 3,
    }
    del data["name"], data["shape"]["width"], data["shape"]["height"]
    found = faults(data)
    assert set(found) == {
        "name",
        "nmae",
        "print.bed.1",
        "print.nozle",
        "accuracy",
        "shape.width",
        "shape.widht",
        "shape.height",
        "shape.heigth",
        "shape.side",
    }
    nearest = {
        "nmae": "name",
        "print.nozle": "nozzle",
        "shape.widht": "width",
        "shape.heigth": "height",
    }
    assert {path: fault.nearest for path, fault in found.items() if fault.nearest} == nearest
    assert (
        found["shape.width"].expected
        == "missing: a number >= 0.001 and <= 1000000 ('widht' is no key)"
    )
    assert str(found["print.nozle"]) == "print.nozle: unknown key; did you mean 'nozzle'?"


def test_a_key_of_another_table_is_told_by_its_place() -> None:
    """Speed stands in [drive] of a linkage, in [motor] of others; a key that several tables have is not guessed."""
    linkage = tomllib.loads(starters.text("linkage"))
    linkage["motor"] = {"speed_rpm": 30, "thickness": 3}
    with pytest.raises(SpecError) as error:
        read_mechanism(linkage)
    nearest = {fault.key: fault.nearest for fault in error.value.faults}
    assert nearest == {"motor.speed_rpm": "drive.speed_rpm", "motor.thickness": None}


def test_faults_inside_lists_and_unions() -> None:
    last = {"kind": "dwell", "span_deg": 9, "x": 1}
    segments = [{"kind": "rise", "lift": 0}, {"kind": "dwell"}, {"kind": "fall"}, last]
    found = faults(box() | {"segment": segments})
    assert set(found) == {"segment.0.lift", "segment.1.span_deg", "segment.2", "segment.3.x"}
    assert "rise" in str(found["segment.2"]) or "kind" in str(found["segment.2"])
    assert faults(box() | {"segment": 3})["segment"].value == "3"


@pytest.mark.parametrize("name", ["a/b", "..", "a.b", "A", "a b", "", "a_b", "ä", "a\n", "x" * 61])
def test_name_that_is_no_folder_name(name: str) -> None:
    fault = faults(box() | {"name": name})["name"]
    assert "a-z" in fault.expected and "hyphens" in fault.expected and fault.value


@pytest.mark.parametrize("name", ["con", "prn", "aux", "nul", "com1", "lpt9"])
def test_name_that_windows_keeps_for_a_device(name: str) -> None:
    assert "Windows" in faults(box() | {"name": name})["name"].expected


@pytest.mark.parametrize(
    "name", ["a", "9", "a-b-c", "a--b", "-a", "a-", "cam2", "x" * 60, "con-rod", "com10"]
)
def test_name_that_is_one(name: str) -> None:
    assert validate(Box, box() | {"name": name}).name == name


# ---- reading ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "content, place, words",
    [
        (b"", "line 1, column 1", "empty"),
        (b"# a remark\n\n", "line 1, column 1", "empty"),
        (b"a = \nb = 1", "line 1, column 5", "Invalid value"),
        (b"a = 1\n[x\n", "line 2, column 3", "expected as many brackets"),
        (b"a = 1\na = 2\n\n\n", "line 2, column 6", "stands in line 1 too"),
        (b'a = 1\nb = "\xff"', "line 2, column 6", "UTF-8"),
        (b"\x00\x01", "line 1, column 1", "Invalid"),
        (b'a = "x\ny"', "line 1, column 7", 'quotes round text: "x"'),
        (b"hello, world", "line 1, column 6", "="),
    ],
)
def test_syntax_fault_has_line_and_column(
    tmp_path: Path, content: bytes, place: str, words: str
) -> None:
    path = tmp_path / "s.toml"
    path.write_bytes(content)
    with pytest.raises(SpecError) as caught:
        read(path)
    (fault,) = caught.value.faults
    assert fault.key == place
    assert words in str(caught.value) and str(path) in str(caught.value)


@pytest.mark.parametrize(
    "line, cure",
    [
        ("width = 1/4  # in", "a decimal number: 0.25"),
        ("width = 12,5  # mm", "a decimal point, not a comma: 12.5"),
        ("width: 12.5  # mm", "= in place of the colon: width = 12.5"),
        ('side = "D", "E"', 'a list of texts in brackets, each in quotes: ["D", "E"]'),
        ("side = [D, E1]", 'a list of texts in brackets, each in quotes: ["D", "E1"]'),
        ('"A-B": 25', '= in place of the colon: "A-B" = 25'),
        ('{"mechanism": "disc-cam"}', 'TOML, not JSON: mechanism = "...", one key a line'),
        ("<html><body>", "a spec, which is TOML, not HTML or XML"),
        ("width = 25 mm", "a number without a unit: 25"),
        ("side = left", 'quotes round text: "left"'),
        ("rows = [{ kind = rise, lift = 12 }]", 'quotes round text: "rise"'),
        (
            "[shape]",
            "[shape] once: it stands in line 1 too; put all of its keys under one (rows of a list begin with [[shape]])",
        ),
        ("side = \u201cleft\u201d", 'straight quotes: "..."'),
        ("[size", "as many brackets on both sides: [size]"),
        ("[[size]", "as many brackets on both sides: [[size]]"),
        ("[size]]", "as many brackets on both sides: [size]"),
        (
            "[[shape]]",
            "[[shape]] at each row of a list: above it stands otherwise, such as [shape]",
        ),
    ],
)
def test_usual_mistakes_are_told_by_their_cure(tmp_path: Path, line: str, cure: str) -> None:
    path = tmp_path / "s.toml"
    path.write_text(f"[shape]\n{line}\n")
    with pytest.raises(SpecError, match=r"line 2, column \d+: ") as caught:
        read(path)
    assert caught.value.faults[0].expected == cure


def test_a_key_that_stands_twice_is_told_with_its_first_line(tmp_path: Path) -> None:
    path = tmp_path / "s.toml"
    path.write_text("side = 1\n[shape]\n\nside = 2\nwidth = 3\nside = 4\n")
    with pytest.raises(SpecError, match=r"line 6, .*side once: it stands in line 4 too"):
        read(path)


@pytest.mark.parametrize(
    "text, said",
    [
        ("side = 1\nat = [\n  [1, 2],\n]\nside = 2", "side once: it stands in line 1 too"),
        (
            "side = 1\n[side]",
            "a table of another name, or no side in line 1, where it is a value",
        ),
        (
            "left = 0\n[shape]\nleft = 1\n[shape.left]",
            "a table of another name, or no left in line 3, where it is a value",
        ),
        ("[[side]]\n[side]", "[[side]], as in line 1: it is a row of the same list"),
        ("side.left = 1\nside = 2", "valid TOML: Cannot overwrite a value"),
        (
            "side.left = 1\n[side]",
            "its keys as side.KEY = ... under line 1, where side begins; or all of them here",
        ),
        (
            "a = 1\nside = [{ b = 2 }]\n[[side]]",
            "a row { ... } more in the list side, which begins in line 2; or all of its rows here, as [[side]]",
        ),
        (
            "side = { b = 2 }\n[side]",
            "its keys within the braces in line 1, where side begins; or all of them here",
        ),
    ],
)
def test_a_line_is_named_only_where_the_key_stands(tmp_path: Path, text: str, said: str) -> None:
    """Rows of a list are no tables; a key that stands in another form is in no line by its name."""
    path = tmp_path / "s.toml"
    path.write_text(text)
    with pytest.raises(SpecError, match=f"expected {re.escape(said)}$"):
        read(path)


def test_what_a_table_lacks_comes_behind_what_is_wrong_in_it(tmp_path: Path) -> None:
    """A wrong word first: what its meaning lacks is told as well, and follows from it."""
    text = starters.text("disc-cam").replace('"translating"', '"swinging"')
    spec = tmp_path / "s.toml"
    spec.write_text(text, encoding="utf-8")
    with pytest.raises(SpecError) as caught:
        camgen.load(spec)
    keys = [fault.path[-1] for fault in caught.value.faults]
    assert keys[0] == "motion" and {"arm", "pivot_distance"} <= {*keys[1:]}


def test_a_spec_that_is_not_there_is_looked_for_beside(tmp_path: Path) -> None:
    (tmp_path / "shopcam.toml").write_text("a = 1")
    for name in ("shopcam", "shop-cam.toml"):
        with pytest.raises(FileError, match=r"did you mean .*shopcam\.toml\?"):
            read(tmp_path / name)
    with pytest.raises(FileError, match="cannot be read: No such file"):
        read(tmp_path / "walker.toml")
    (tmp_path / "gallery").mkdir()
    (tmp_path / "gallery" / "walker.toml").write_text("a = 1")
    (tmp_path / "walking.toml").write_text("a = 1")
    with pytest.raises(FileError, match=r"did you mean .*gallery.walker\.toml\?"):
        read(tmp_path / "walker.toml")
    with pytest.raises(FileError, match="cannot be read"):
        read(tmp_path / f"{'walker' * 50}.toml")


@pytest.mark.parametrize(
    "width, said",
    [
        ("25 mm", "lengths are in mm: write 25"),
        ("2,5cm", "lengths are in mm: write 25"),
        ("1/4 in", "lengths are in mm: write 6.35"),
        ('1"', "lengths are in mm: write 25.4"),
        ("12,5", "a number with a decimal point: write 12.5"),
        ("25 apples", "a number >= 0.001 and <= 1000000"),
        ("25 rpm", "a number without a unit; lengths are in mm"),
        ("25 H7", "a number without a fit: write 25; drawing.bore_fit has the fit"),
    ],
)
def test_a_number_in_quotes_is_told_as_it_should_be_written(width: str, said: str) -> None:
    assert said in faults(box() | {"shape": {"width": width, "height": 30}})["shape.width"].expected


def test_lines_of_keys_and_tables() -> None:
    """Neither what stands in texts and comments counts, nor numbers in a list; rows count from 0."""
    text = """a = "b = ["
[t] # [u]
c = [
  1, # d = 2
  { e = 2 },
]
f.g = 1
[[r]]
h = '''
i = 3
[z]
'''
[r.s]
[[r]]
"x.y" = 3
[[r.u]]
[[r.u]]
v = 1
"""
    assert lines(text) == {
        ("a",): 1,
        ("t",): 2,
        ("t", "c"): 3,
        ("t", "c", 1): 5,
        ("t", "c", 1, "e"): 5,
        ("t", "f", "g"): 7,
        ("r", 0): 8,
        ("r", 0, "h"): 9,
        ("r", 0, "s"): 13,
        ("r", 1): 14,
        ("r", 1, "x.y"): 15,
        ("r", 1, "u", 0): 16,
        ("r", 1, "u", 1): 17,
        ("r", 1, "u", 1, "v"): 18,
    }


@pytest.mark.parametrize("spec", [*(TOP / "specs").rglob("*.toml")], ids=lambda path: path.stem)
def test_each_key_of_our_specs_has_its_line(spec: Path) -> None:
    text = spec.read_text(encoding="utf-8")
    data = tomllib.loads(text)
    rows = text.splitlines()
    found = lines(text)
    assert len(found) >= len(data)
    for path, line in found.items():
        reduce(getitem, path, data)
        assert (
            path[-1] in rows[line - 1]
            if isinstance(path[-1], str)
            else set("[{") & {*rows[line - 1]}
        )


def test_faults_of_a_file_tell_their_lines_in_order(tmp_path: Path) -> None:
    path = tmp_path / "s.toml"
    starter = (TOP / "specs" / "disc-cam.toml").read_text(encoding="utf-8")
    path.write_text(
        starter.replace("base_radius = 25", "base_raduis = 25").replace("lift = 12", "lift = -1")
    )
    rows = path.read_text(encoding="utf-8").splitlines()
    settings = ["motor.speed_rpm=0"]
    with pytest.raises(SpecError) as caught:
        read_mechanism(path, settings)
    *own, anew = caught.value.faults
    assert anew.line is None and str(anew).startswith("motor.speed_rpm: 0")
    assert [rows[fault.line - 1].split()[0] for fault in own if fault.line] == [
        "base_raduis",
        "lift",
    ]
    assert str(own[0]).startswith(f"line {own[0].line}: geometry.base_raduis: unknown key")


@pytest.mark.parametrize(
    "content, says",
    [
        ('mechanism = "disc-cam"\nname = "ä"'.encode("latin-1"), "line 2, column 9: byte 0xe4"),
        ('mechanism = "disc-cam"'.encode("utf-16-le"), "line 1, column 1: the file is UTF-16"),
        (b"\xff\xfea\x00", "line 1, column 1: the file is UTF-16"),
        (b"a = " + b"9" * 5000 + b"\nb c = 1", "4300 digits"),
        (b"a = " + b"[" * 5000 + b"]" * 5000 + b"\nb c = 1", "32 deep"),
    ],
    ids=["latin-1", "utf-16", "utf-16 with its mark", "number", "depth"],
)
def test_lines_are_not_sought_in_what_is_no_toml(tmp_path: Path, content: bytes, says: str) -> None:
    path = tmp_path / "s.toml"
    path.write_bytes(content)
    with pytest.raises(SpecError, match=says):
        read_mechanism(path)


@pytest.mark.parametrize("content", ["a = " + "[" * 5000, "a = " + "9" * 5000])
def test_toml_beyond_python(tmp_path: Path, content: str) -> None:
    path = tmp_path / "s.toml"
    path.write_text(content)
    with pytest.raises(SpecError):
        read(path)


@pytest.mark.parametrize("line", ["a%s = 1", "[a%s]", "b = {c = 1, 'a'%s = 1}"])
def test_a_key_of_many_steps_is_refused_before_it_is_parsed(tmp_path: Path, line: str) -> None:
    """tomllib alone takes a minute for a key of 50,000."""
    path = tmp_path / "s.toml"
    path.write_text("d = 1\n" + line % (50_000 * " . a"))
    begin = time.process_time()
    with pytest.raises(SpecError, match=r"line 2, column \d+.* nested at most 32 deep"):
        read(path)
    assert time.process_time() - begin < 1


def test_what_is_no_readable_file(tmp_path: Path) -> None:
    for path, words in (
        (tmp_path, "folder"),
        (tmp_path / "none.toml", "No such file"),
        (tmp_path / "a\0b", "null"),
    ):
        with pytest.raises(FileError, match=words) as caught:
            read(path)
        assert caught.value.exit_code == 4


def test_byte_order_mark_and_windows_lines_are_fine(tmp_path: Path) -> None:
    path = tmp_path / "s.toml"
    path.write_bytes(b"\xef\xbb\xbfa = 1\r\n[b]\r\nc = 'd'\r\n")
    assert read(path) == {"a": 1, "b": {"c": "d"}}


# ---- --set -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "setting, expected",
    [
        ("shape.width=24", {"shape": {"width": 24, "height": 1}}),
        ("shape.width = 2.5", {"shape": {"width": 2.5, "height": 1}}),
        ("shape.side=right", {"shape": {"width": 1, "height": 1, "side": "right"}}),
        ('shape.side="right"', {"shape": {"width": 1, "height": 1, "side": "right"}}),
        ("shape.ribbed=true", {"shape": {"width": 1, "height": 1, "ribbed": True}}),
        (
            "print.bed=[200, 100]",
            {"shape": {"width": 1, "height": 1}, "print": {"bed": [200, 100]}},
        ),
        ("name=1\nmechanism = 2", {"shape": {"width": 1, "height": 1}, "name": "1\nmechanism = 2"}),
        ("name=a=b", {"shape": {"width": 1, "height": 1}, "name": "a=b"}),
        ('shape."A-B"=4', {"shape": {"width": 1, "height": 1, "A-B": 4}}),
        (""" shape . 'a.b=c' = 4""", {"shape": {"width": 1, "height": 1, "a.b=c": 4}}),
        (r'"q\"".x=""', {"shape": {"width": 1, "height": 1}, 'q"': {"x": ""}}),
    ],
)
def test_override(setting: str, expected: dict[str, Any]) -> None:
    data = {"shape": {"width": 1, "height": 1}}
    assert override(data, setting) == expected
    assert data == {"shape": {"width": 1, "height": 1}}


@pytest.mark.parametrize(
    "setting", ["", "shape.width", "=3", "shape.=3", ".width=3", "name.x=1", '""=1', r'"\q"=1']
)
def test_override_of_the_wrong_form(setting: str) -> None:
    with pytest.raises(SpecError, match="--set"):
        override({"name": "n"}, setting)


SEGMENTS = {
    "name": "n",
    "output": [{}],
    "segment": [{"kind": "rise", "lift": 5}, {"kind": "dwell"}],
    "shape": {"width": 1, "points": [[0, 1]]},
}


@pytest.mark.parametrize(
    ("setting", "path", "expected"),
    [
        ("segment.0.lift=80", ("segment", 0), {"kind": "rise", "lift": 80}),
        ("segment.1={kind = 'rise'}", ("segment", 1), {"kind": "rise"}),
        ("shape.points.0.1=2.5", ("shape", "points"), [[0, 2.5]]),
        ("segment.1=", ("segment",), [{"kind": "rise", "lift": 5}]),
        ("segment.0.lift=", ("segment", 0), {"kind": "rise"}),
        ("shape.points =  ", ("shape",), {"width": 1}),
        ("shape=", (), {"name": "n", "output": [{}], "segment": SEGMENTS["segment"]}),
        ("name=''", ("name",), ""),
    ],
)
def test_override_of_a_list_and_removal(
    setting: str, path: tuple[str | int, ...], expected: object
) -> None:
    found: Any = override(SEGMENTS, setting)
    for step in path:
        found = found[step]
    assert found == expected


@pytest.mark.parametrize(
    ("setting", "said"),
    [
        ("segment.2.lift=1", "--set segment.2.lift - segment has 2 items, 0 to 1: there is no 2"),
        ("segment.-1.lift=1", "segment has 2 items"),
        ("segment.²=1", "segment has 2 items"),
        (f"segment.{'9' * 5000}=1", "segment has 2 items"),
        ("segment.lift=1", "segment has 2 items, 0 to 1: there is no lift"),
        ("segment.7=", "segment has 2 items"),
        (
            "output.marks=true",
            "output has one item, 0: there is no marks (did you mean 'files.marks'?)",
        ),
        ("shape.points.1.0=2", "shape.points has one item, 0: there is no 1"),
        (
            "shape.widht=",
            "--set shape.widht - nothing to remove: there is no widht in shape (did you mean 'width'?)",
        ),
        ("shapes.width=", "there is no shapes (did you mean 'shape'?)"),
        ("zzz=", "nothing to remove: there is no zzz"),
        ("name.x=", "name is a value and has no keys"),
    ],
)
def test_override_where_there_is_nothing(setting: str, said: str) -> None:
    with pytest.raises(SpecError) as caught:
        override(SEGMENTS, setting)
    assert said in str(caught.value)


def test_override_of_an_unknown_key_is_found_by_validation() -> None:
    assert faults(override(box(), "shape.widht=3"))["shape.widht"].nearest == "width"


# ---- mechanism -------------------------------------------------------------------------------------------------------


def test_unknown_mechanism_with_nearest_name_and_the_shared_faults() -> None:
    with pytest.raises(SpecError) as caught:
        choose(
            {"mechanism": "uniform-swin", "name": "A B", "geometry": {}},
            ["uniform-swing", "disc-cam"],
        )
    assert [fault.key for fault in caught.value.faults] == ["mechanism", "name"]
    first = caught.value.faults[0]
    assert (first.value, first.nearest) == ("'uniform-swin'", "uniform-swing")
    assert first.expected == "one of 'disc-cam', 'uniform-swing'"


@pytest.mark.parametrize("value", [None, 3, ["disc-cam"], {"disc-cam": 1}, ""])
def test_mechanism_missing_or_no_name(value: object) -> None:
    data = {"name": "a"} | ({} if value is None else {"mechanism": value})
    with pytest.raises(SpecError) as caught:
        choose(data, ["disc-cam"])
    assert [fault.key for fault in caught.value.faults] == ["mechanism"]


def test_known_mechanism() -> None:
    assert choose({"mechanism": "disc-cam"}, ["disc-cam", "x"]) == "disc-cam"
    assert unknown("MECHANISM", "zzz", ["disc-cam"]).nearest is None


# ---- writing ---------------------------------------------------------------------------------------------------------

lengths = st.floats(min_value=1e-3, max_value=1e6) | st.integers(1, 10**6)


@given(
    width=lengths,
    lid=lengths | st.none(),
    lifts=st.lists(lengths, max_size=3),
    side=st.sampled_from(["left", "right"]),
    chord=st.floats(1e-7, 0.1),
)
def test_dump_reads_back_equal_and_dumps_the_same(
    width: Any, lid: Any, lifts: list[Any], side: str, chord: float
) -> None:
    data = box(width=width, height=1e6, side=side) | {"accuracy": {"chord_tolerance": chord}}
    if lid not in (None, 9):
        data["shape"]["lid"] = lid
    data["segment"] = [{"kind": "rise", "lift": lift} for lift in lifts]
    record = validate(Box, data)
    text = dump(record)
    again = validate(Box, tomllib.loads(text))
    assert again == record
    assert dump(again) == text
    assert again.shape.width == width and [segment.lift for segment in again.segment] == lifts  # type: ignore[union-attr]


@pytest.mark.parametrize("zero", ["-0.0", "5e-324", "-1e-310"])
@pytest.mark.parametrize("key", ["geometry.follower.offset", "print.slide_clearance"])
def test_minus_zero_and_what_is_next_to_it_is_zero(key: str, zero: str) -> None:
    """They are equal, and what is kept for equal records must not differ."""
    data = tomllib.loads(starters.text("disc-cam"))
    minus, plain = (
        dump(validate(load("disc-cam"), override(data, f"{key}={zero}"))) for zero in (zero, "0.0")
    )
    assert minus == plain and f"{key.rpartition('.')[2]} = 0.0\n" in minus


def test_whole_numbers_and_floats_end_equal() -> None:
    assert dump(validate(Box, box(width=60, height=60))) == dump(
        validate(Box, box(width=60.0, height=60.0))
    )


def test_short_arrays_stand_on_one_line_and_long_ones_on_many(root: Path) -> None:
    """Of an example with points, links, nested pairs and tables in arrays: what is read is the same as what tomli_w writes."""
    data = read(root / "specs" / "thread-take-up.toml")
    data["geometry"]["guides"] = [[float(k), 1.5] for k in range(2)]
    record = validate(load("thread-take-up"), data)
    text = dump(record)
    assert "guides = [[0.0, 1.5], [1.0, 1.5]]\n" in text and "bed = [220.0, 220.0]\n" in text
    assert tomllib.loads(text) == tomllib.loads(
        tomli_w.dumps(record.model_dump(by_alias=True, exclude_none=True))
    )
    cam = read(root / "specs" / "disc-cam.toml")
    rows = [[float(k), k / 7] for k in range(60)]
    odd = 'a "[" b, ]'
    cam["segment"][0]["law"] = {"name": "table", "points": rows, "source": odd}
    text = dump(validate(load("disc-cam"), cam))
    assert (
        max(map(len, text.splitlines())) < 400
        and tomllib.loads(text)["segment"][0]["law"]["points"] == rows
    )
    assert tomllib.loads(text)["segment"][0]["law"]["source"] == odd


@pytest.mark.parametrize("mechanism", MECHANISMS)
def test_starter_is_valid_and_its_schema_knows_every_key(root: Path, mechanism: str) -> None:
    record = validate(load(mechanism), read(root / "specs" / f"{mechanism}.toml"))
    resolved = tomllib.loads(dump(record))
    described = schema(load(mechanism), mechanism)
    assert described["properties"]["mechanism"]["const"] == mechanism
    for key, table in resolved.items():
        assert key in described["properties"]
        if isinstance(table, dict):
            node = described["properties"][key]
            if (
                "propertyNames" in node or "additionalProperties" in node
            ):  # its keys are names of the user's own
                continue
            reference = next(
                n["$ref"]
                for n in [node, *node.get("anyOf", []), *node.get("oneOf", [])]
                if "$ref" in n
            )  # a table that may be left out
            name = reference.rsplit("/", 1)[-1]
            assert set(table) <= set(described["$defs"][name]["properties"])


# ---- files and tables that no spec has -------------------------------------------------------------------------------


@pytest.mark.parametrize("depth", [33, 600, 5000])
@pytest.mark.parametrize("form", ["dotted", "header", "inline", "list"])
def test_tables_nested_too_deep_are_a_fault(tmp_path: Path, depth: int, form: str) -> None:
    """From a file and from --set; the deepest that a real spec has is segment.0.law.points.0.0."""
    keys = ".".join("a" * depth)
    text = {
        "dotted": f"{keys} = 1",
        "header": f"[{keys}]\nb = 1",
        "inline": "a = " + "{a = " * depth + "1" + "}" * depth,
        "list": "a = " + "[" * depth + "]" * depth,
    }[form]
    (tmp_path / "deep.toml").write_text(text)
    with pytest.raises(SpecError, match="nested"):
        read(tmp_path / "deep.toml")
    if form == "header":
        return
    with pytest.raises(SpecError) as caught:
        validate(Spec, override({"mechanism": "x", "name": "y"}, text.replace(" ", "")))
    assert len(str(caught.value)) < 1000


def test_a_real_spec_is_not_too_deep(root: Path) -> None:
    for path in sorted((root / "specs").glob("*.toml")):
        assert read(path)
    law = "law={name='polynomial',conditions=[[0,0,0],[1,0,1]]}"
    assert override({}, f"a.b.c.d={{{law}}}")["a"]["b"]["c"]["d"]["law"]["conditions"][1] == [
        1,
        0,
        1,
    ]


@pytest.mark.long
@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes and devices in the file system")
def test_only_files_of_a_sane_size_are_read(tmp_path: Path) -> None:
    """A device that never ends, a pipe that nobody fills, and a file of 11 MB: refused at once."""
    os.mkfifo(tmp_path / "pipe")
    with open(tmp_path / "large.toml", "wb") as file:
        file.truncate(11_000_000)
    for path, said in (
        (Path("/dev/zero"), "is a pipe or a device"),
        (tmp_path / "pipe", "is a pipe or a device"),
        (tmp_path / "large.toml", "10 MB"),
    ):
        code = "import sys\nfrom camgen.cli import main\nmain(['build', *sys.argv[1:]])"
        done = subprocess.run(
            [sys.executable, "-c", code, str(path)], capture_output=True, text=True, timeout=60
        )
        assert done.returncode == 4 and said in done.stderr and str(path) in done.stderr


@pytest.mark.parametrize(
    "mechanism", ["uniform-swing", "eccentric-drive", "thread-take-up", "indexing-cam", "disc-cam"]
)
def test_the_limit_of_free_play_is_a_key_whose_default_has_a_reason(mechanism: str) -> None:
    root = schema(load(mechanism), mechanism)
    limits = keys_of(step_below(root, "limits", root), root)
    (told,) = [key for name, key in limits.items() if name in ("lash", "lash_deg")]
    reason = rf"free play .*; {told['default']:g}(: | is )"
    assert re.match(reason, told["description"])


def test_a_key_in_the_other_spelling_is_taken_and_told(root: Path) -> None:
    """center_marks is American, a mass's centre British; with both there, or with neither near, it stays a fault."""
    from camgen.machines import load

    disc, linkage = (read(root / "specs" / f"{name}.toml") for name in ("disc-cam", "linkage"))
    made = validate(load("disc-cam"), override(disc, "files.centre_marks=true"))
    assert made.files.center_marks and made.hints == ("files.centre_marks is read as center_marks",)
    assert validate(load("disc-cam"), disc).hints == ()
    for key in ("mass_g=12", "center=[10.0, 0.0]"):
        linkage = override(linkage, f"masses.rocker.{key}")
    told = validate(load("linkage"), linkage)
    assert told.masses["rocker"].centre == (10, 0) and told.hints == (
        "masses.rocker.center is read as centre",
    )
    assert "center" in linkage["masses"]["rocker"]  # what was given stays as it is
    with pytest.raises(SpecError, match="masses.rocker.center: unknown key"):
        validate(load("linkage"), override(linkage, "masses.rocker.centre=[9.0, 0.0]"))


FILES = {"curves": "lines", "center_marks": True, "cutter_radius": 3.0, "curvs": 1}


@given(st.dictionaries(st.sampled_from(sorted(FILES)), st.sampled_from(["old", "new", "both"])))
def test_the_old_name_of_a_table_is_taken_and_its_faults_keep_it(words: dict[str, str]) -> None:
    """[output] is [files], where it is no list; what stands under both words is as the old one says, and told."""
    old = {key: FILES[key] for key, word in words.items() if word != "new"}
    new = {
        key: FILES[key] if word == "new" else None for key, word in words.items() if word != "old"
    }
    data = read(Path(starters.folder()) / "disc-cam.toml") | {"output": old, "files": new}
    try:
        made = validate(load("disc-cam"), data)
    except SpecError as error:
        assert [fault.key for fault in error.faults] == [
            "files.curvs" if words["curvs"] == "new" else "output.curvs"
        ]
        return
    assert "curvs" not in words
    twice = [f"files.{key}" for key in old if words[key] == "both"]
    beside = f", in place of {', '.join(twice)} beside it" if twice else ""
    assert made.hints == (f"output is read as files{beside}",)
    whole = validate(load("disc-cam"), {**data, "output": {}, "files": new | old})
    assert made.model_dump() == whole.model_dump()
    assert "[files]" in dump(made) and "[output]" not in dump(made)


def test_a_setting_by_the_old_name_of_a_table_is_taken(root: Path) -> None:
    """Of a spec as it was resolved, whose [files] is filled in, too; a list under the word is another thing."""
    disc, linkage = (read(root / "specs" / f"{name}.toml") for name in ("disc-cam", "linkage"))
    for data in (disc, tomllib.loads(dump(validate(load("disc-cam"), disc)))):
        made = validate(load("disc-cam"), override(data, "output.curves='lines'"))
        assert made.files.curves == "lines"
    assert override(linkage, "output.0.name='tip'")["output"][0]["name"] == "tip"
    with pytest.raises(SpecError, match="did you mean 'files.step'"):
        override(linkage, "output.step=true")
    with pytest.raises(SpecError) as told:
        validate(load("linkage"), linkage | {"output": {"name": "pen"}})
    (fault,) = told.value.faults
    assert (fault.key, fault.value) == ("output", "a table") and "[[output]]" in fault.expected


@pytest.mark.parametrize("key", ["pin", "wall", "stand", "motor"])
def test_a_link_with_the_name_of_a_key_of_parts_says_so(key: str) -> None:
    tables = {
        "mechanism": "linkage",
        "name": "x",
        "points": {"O": [0, 0], "A": [20, 0], "B": [60, 50], "C": [70, 0]},
        "links": {
            "ground": ["O", "C"],
            "crank": ["O", "A"],
            "coupler": ["A", "B"],
            key: ["C", "B"],
        },
        "drive": {"link": "crank"},
        "output": [{"name": "s", "point": "B"}],
        "parts": {key: {"band": 5}},
    }
    with pytest.raises(SpecError, match=f"a value: {key} is a key of .parts.; a link of that name"):
        camgen.load(tables)


@pytest.mark.parametrize(
    "tables, said",
    [
        ({"include": [{"name": "leg", "spec": 3}]}, "include.0.spec: 3 - expected text or a table"),
        ({"include": [3]}, "include.0: 3 - expected a table with spec, name, "),
        ({"masses": {"crank": 3}}, "masses.crank: 3 - expected a table with mass_g, "),
    ],
)
def test_what_should_be_a_table_is_told_as_one(tables: dict[str, Any], said: str) -> None:
    data = read(TOP / "specs" / "linkage.toml")
    with pytest.raises(SpecError) as caught:
        read_mechanism(data | tables)
    assert said in str(caught.value)


@pytest.mark.parametrize(
    "wrong",
    [
        "geometry.base_radius=a",
        "geometry.follower.shape=a",
        "geometry.follower.radius=-3",
        "parts.bore=a",
        "motor.speed_rpm=a",
    ],
)
def test_a_wrong_size_hides_no_fault_of_the_program(wrong: str) -> None:
    data = read(TOP / "specs" / "disc-cam.toml")
    for setting in (wrong, "segment.0.law=cycloydal"):
        data = override(data, setting)
    with pytest.raises(SpecError) as caught:
        read_mechanism(data)
    found = [dotted(fault.path) for fault in caught.value.faults]
    assert found == [wrong.partition("=")[0], "segment.0.law"]


@pytest.mark.parametrize(
    "setting, said",
    [
        ("base_radius=20", "did you mean 'geometry.base_radius'?"),
        ("motor.rpm=20", "did you mean 'speed_rpm'?"),
        ("drawing.bore_fit=H77", "did you mean 'H7'?"),
        ("drawing.bore_fit=H12", "did you mean 'H11'?"),
        ("geometry.follower.diameter=16", "write radius = 8, which is half of it"),
        ("geometry.base_diameter=50", "write base_radius = 25, which is half of it"),
        (f"geometry.base_diameter={10**400}", "known here: follower, base_radius"),
        ("segment.0.type=rise", "unknown key; did you mean 'kind'?"),
        ("segment.0.angle=100", "unknown key; did you mean 'span_deg'?"),
        ("segment.0.stroke=12", "unknown key; did you mean 'lift'?"),
        ("load.force_n=3", "unknown key; did you mean 'resistance'?"),
        ("load.spring_rate=2", "did you mean 'spring.rate'?"),
        ("geometry.follower.mass_kg=2", "did you mean 'load.mass_kg'?"),
        ("geometry.base_circle=20", "did you mean 'base_radius'?"),
        ("geometry.radius=5", "did you mean 'geometry.follower.radius'?"),
        ("drive.speed_rpm=60", "drive: unknown key; did you mean 'motor.speed_rpm'?"),
        ("gemoetry.base_radius=20", "gemoetry: unknown key; did you mean 'geometry'?"),
        ("parts.material=steel", "did you mean 'material'?"),
        ("material.name=hardened steel", "expected one of '16MnCr5', '42CrMo4'; or of 'ABS'"),
        ('print.bed="220 x 200"', "a list without quotes: write [220, 200]"),
        ('parts.bore="20 H7"', "a number without a fit: write 20; drawing.bore_fit has the fit"),
        ("segment.0.lift=-12", 'kind = "return" with lift = 12 goes back'),
        ('name="My Cam"', 'write "my-cam"'),
        ("mechanism=", "mechanism - missing: one of"),
    ],
)
def test_what_is_meant_is_told_of_a_machine(setting: str, said: str) -> None:
    data = override(read(TOP / "specs" / "disc-cam.toml"), setting)
    with pytest.raises(SpecError) as caught:
        read_mechanism(data)
    assert said in str(caught.value)


def test_the_number_of_a_steel_without_quotes_is_told_as_with_them():
    with pytest.raises(SpecError, match="did you mean '16MnCr5'"):
        read_mechanism(TOP / "specs/disc-cam.toml", ["material.name=1.7131"])


@pytest.mark.parametrize(
    "key, word, meant",
    [
        ("segment.0.law", "sine", "one of 'cycloidal', 'modified-sine', 'simple-harmonic'"),
        ("segment.0.law", "SHM", "did you mean 'simple-harmonic'"),
        (
            "segment.0.law",
            "modifiedsine",
            "- did you mean 'modified-sine'? expected one of '3-4-5'",
        ),
        ("segment.2.kind", "fall", "did you mean 'return'"),
        ("material.name", "1.7131", "did you mean '16MnCr5'?"),
        ("material.name", "1.0503", "did you mean 'C45'?"),
        ("material.name", "mild steel", "one of 'C45', '42CrMo4', '16MnCr5', 'stainless'"),
        ("material.name", "aluminum", "did you mean 'aluminium'"),
        ("motor.model", "NEMA 17", "one of '17HS19-2004S1', '17HS24'"),
        ("geometry.closure", "spring", "did you mean 'force'"),
        ("geometry.follower.motion", "swinging", "did you mean 'oscillating'"),
        ("mechanism", "four-bar", "camgen new four-bar FILE writes such a one"),
    ],
)
def test_a_word_that_people_use_is_told_by_the_names_here(key, word, meant):
    with pytest.raises(SpecError) as caught:
        read_mechanism(TOP / "specs/disc-cam.toml", [f'{key}="{word}"'])
    told = {dotted(fault.path): str(fault) for fault in caught.value.faults}
    assert meant in told[key]
    if meant.startswith("one of"):  # all others are named behind those
        known = {
            "law": NAMES,
            "name": get_args(Material.model_fields["name"].annotation),
            "model": get_args(Model),
        }
        assert all(f"'{name}'" in told[key] for name in known[key.rpartition(".")[2]])


@pytest.mark.parametrize(
    ("setting", "said"),
    [
        ('slot.0.pin=["A"]', 'text, no list: write "A"'),
        ('slide.0.along="R-T"', 'a list: write ["R", "T"]'),
        ('links.arm="D, E"', 'a list: write ["D", "E"]'),
        ("output.0.stroke=80", "a table: write { value = 80, tolerance = ... }"),
    ],
)
def test_a_list_or_table_that_is_meant_is_told_of_a_linkage(setting: str, said: str) -> None:
    with pytest.raises(SpecError, match=re.escape(said)):
        read_mechanism(override(read(TOP / "specs" / "quick-return.toml"), setting))


def test_each_key_of_a_word_is_one_of_a_mechanism():
    tables = [each.keys() for kind in MECHANISMS for each in tables_in(schema(load(kind), kind))]
    for word, keys in _KEYS.items():
        assert all(any(key in table for table in tables) for key in keys), word


def tables_in(root):
    """The properties of each table of a schema."""
    return [each["properties"] for each in (root, *root["$defs"].values()) if "properties" in each]


def test_each_name_and_example_of_a_word_exists():
    names = {"law": NAMES, "mechanism": MECHANISMS, "model": get_args(Model)}
    for kind, known in names.items():
        assert {name for meant in _LIKELY[kind].values() for name in meant} <= {*known}
    assert {*_EXAMPLES.values()} <= {*starters.examples()}


def test_faults_of_keys_do_not_hide_those_between_keys():
    overrides = ["print.nozle=0.4", 'geometry.base_radius="25 mm"', "segment.0.span_deg=300"]
    with pytest.raises(SpecError) as caught:
        read_mechanism(TOP / "specs/disc-cam.toml", [overrides[0], overrides[2]])
    paths = [dotted(fault.path) for fault in caught.value.faults]
    assert "print.nozle" in paths and "segment.3.span_deg" in paths
    with pytest.raises(SpecError) as caught:  # what a wrong size means is not known
        read_mechanism(TOP / "specs/disc-cam.toml", overrides)
    assert [dotted(fault.path) for fault in caught.value.faults][-1] != "segment.3.span_deg"


def test_a_console_completes_keys_and_not_the_names_of_pydantic():
    names = dir(read_mechanism(TOP / "specs/disc-cam.toml"))
    assert {"geometry", "replace", "solve"} <= {*names}
    assert not {"model_dump", "parse_obj", "json"} & {*names}


# ---- words that were meant otherwise, and files -----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("value", "names", "nearest"),
    [
        ("KR20", ("KR16", "KR19", "KR22", "KR52"), "KR19"),
        ("kr50", ("KR16", "KR19", "KR22", "KR52"), "KR52"),
        ("rolling", ("translating", "oscillating"), None),
        ("oscilating", ("translating", "oscillating"), "oscillating"),
        ("ranslating", ("translating", "oscillating"), "translating"),
    ],
)
def test_a_guess_is_near_by_number_too_and_not_far_in_spelling(
    value: str, names: tuple[str, ...], nearest: str | None
) -> None:
    assert unknown(("x",), value, names).nearest == nearest


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (('name = "disc-cam"', 'name = "disc-cam'), 'quotes round text: "disc-cam"'),
        (('name = "disc-cam"', 'name = disc-cam"'), 'quotes round text: "disc-cam"'),
        (('motion = "translating"', "motion = 'translating"), 'quotes round text: "translating"'),
    ],
)
def test_a_lost_quote_is_told_with_its_line(
    tmp_path: Path, root: Path, change: tuple[str, str], said: str
) -> None:
    text = (root / "specs" / "disc-cam.toml").read_text(encoding="utf-8")
    assert text.count(change[0]) == 1
    line = text[: text.index(change[0])].count("\n") + 1
    spec = tmp_path / "lost.toml"
    spec.write_text(text.replace(*change), encoding="utf-8")
    with pytest.raises(SpecError, match=rf"line {line}, column \d+: .*{re.escape(said)}"):
        read_mechanism(spec)


@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-be"])
def test_a_file_in_utf_16_is_told_how_to_save_it(tmp_path: Path, encoding: str) -> None:
    spec = tmp_path / "wide.toml"
    mark = "\ufeff" if encoding == "utf-16-be" else ""
    spec.write_bytes((mark + 'name = "x"').encode(encoding))
    with pytest.raises(SpecError, match="the file is UTF-16 - expected UTF-8: save it"):
        read_mechanism(spec)


def test_a_file_that_is_missing_is_told_with_the_key_and_line_that_name_it(
    tmp_path: Path, root: Path
) -> None:
    text = (root / "specs" / "linkage.toml").read_text(encoding="utf-8")
    spec = tmp_path / "own.toml"
    spec.write_text(text + '\n[parts.coupler]\noutline = "wing.svg"\n', encoding="utf-8")
    last = len(spec.read_text(encoding="utf-8").splitlines())
    with pytest.raises(FileError) as caught:
        read_mechanism(spec)
    assert str(caught.value).startswith(f"{tmp_path / 'wing.svg'}: cannot be read")
    assert str(caught.value).endswith(f"(line {last}: parts.coupler.outline names it)")


def test_a_table_that_is_missing_is_told_by_what_it_needs(root: Path) -> None:
    data = read(root / "specs" / "disc-cam.toml")
    del data["geometry"]["follower"]
    with pytest.raises(SpecError) as caught:
        read_mechanism(data)
    assert "geometry.follower - missing: a table with motion and shape; other keys" in str(
        caught.value
    )


def test_a_drawing_that_is_none_is_one_fault() -> None:
    data = {"mechanism": "linkage", "name": "x", "wanted": {"drawing": [[[0, 0]]]}}
    with pytest.raises(SpecError) as caught:
        camgen.design(data)
    (fault,) = caught.value.faults
    assert fault.path == ("wanted", "drawing") and "[[x, y], [x, y], ...]" in fault.expected


@pytest.mark.parametrize(
    ("mechanism", "make", "key"),
    [
        ("uniform-swing", "", "parts.bore"),
        ("disc-cam", "cams", "parts.bore"),
        ("disc-cam", "printed", "parts.shaft_diameter"),
        ("indexing-cam", "cams", "parts.bore"),
        ("cylinder-cam", "", "parts.bore"),
        ("drum", "", "parts.bore"),
        ("linkage", "", "parts.shaft_diameter"),
        ("thread-take-up", "", "parts.shaft_diameter"),
        ("eccentric-drive", "", "geometry.shaft_diameter"),
    ],
)
def test_the_shaft_of_the_motor_is_the_machines(mechanism: str, make: str, key: str) -> None:
    """[motor] says the shaft's diameter in every spec, by the same word."""
    data = tomllib.loads(starters.text(mechanism))
    if make:
        data.setdefault("parts", {})["make"] = make
    table, name = key.split(".")
    size = 5.5 if table == "geometry" else 6.5  # in the motor's collar; wide enough for a keyway
    wanted = {**data, table: {**data.get(table, {}), name: size}}
    typed = {**data, "motor": {**data.get("motor", {}), "shaft_diameter": size}}
    typed[table] = {word: value for word, value in data.get(table, {}).items() if word != name}
    machine = read_mechanism(typed)
    assert dump(machine) == dump(read_mechanism(wanted))
    assert machine.hints == (f"motor.shaft_diameter is read as {key}",)
    with pytest.raises(SpecError) as error:
        read_mechanism({**typed, "motor": {**typed["motor"], "shaft_diameter": "wide"}})
    assert "motor.shaft_diameter" in {fault.key for fault in error.value.faults}
    root = schema(load(mechanism), mechanism)
    keys = keys_of(step_below(root, "motor", root), root)
    assert "shaft_diameter" in keys


@pytest.mark.parametrize(
    ("spec", "setting", "said"),
    [
        (
            "eccentric-drive",
            "geometry=",
            "a table with eccentricity, rod, eccentric_diameter and shaft_diameter; other keys",
        ),
        (
            "linkage",
            "parts.hand_crank=true",
            "parts.hand_crank: true - expected a number >= 0 and <= 1000000, in mm",
        ),
        (
            "disc-cam",
            "print.bed=220",
            "print.bed: 220 - expected a list of two sizes: write [220, 220]",
        ),
        (
            "disc-cam",
            f"print.bed={10**400}",
            "print.bed: a number of about 1e400 - expected a list",
        ),
        ("disc-cam", "lift=3", "lift: unknown key; did you mean 'segment.0.lift'?"),
        (
            "linkage",
            "pin_diameter=4",
            "did you mean 'counterweight.pin_diameter' or 'parts.pin_diameter'?",
        ),
        # both sizes of the hub may be what is wrong: that which was set is told first
        (
            "disc-cam",
            "parts.bore=60",
            "parts.bore: 60 - expected at most 14.4 mm, by limits.min_wall in a hub of parts.hub_diameter = 16; or parts.hub_diameter = 61.6 or more",
        ),
        (
            "disc-cam",
            "parts.hub_diameter=9",
            "parts.hub_diameter: 9 - expected at least 9.6 mm: limits.min_wall round parts.bore = 8",
        ),
    ],
)
def test_a_slip_is_told_by_the_key_that_was_typed_and_what_to_write(
    root: Path, spec: str, setting: str, said: str
) -> None:
    with pytest.raises(SpecError) as caught:
        read_mechanism(root / "specs" / f"{spec}.toml", [setting])
    assert said in str(caught.value)


@pytest.mark.parametrize(
    ("span", "known"),
    [
        ("1.5708", 90),
        ("3.14159", 180),
        ("1.745", 100),
        ("1.57", None),
        ("90", None),
        ("1.746", None),
    ],
)
def test_an_angle_that_looks_like_radians_is_told(root: Path, span: str, known: int | None) -> None:
    found = read_mechanism(root / "specs" / "disc-cam.toml", [f"segment.0.span_deg={span}"])
    said = [hint for hint in found.hints if " rad are " in hint]
    key = "segment.0.span_deg"
    assert said == [f"{key} = {span} is read in degrees; {span} rad are {known} deg"] * bool(known)


@pytest.mark.parametrize(
    ("setting", "said"),
    [
        ("segment.0.lift=0.012", "segment.0.lift = 0.012 is read in mm; 0.012 m are 12 mm"),
        (
            "geometry.base_radius=0.025",
            "geometry.base_radius = 0.025 is read in mm; 0.025 m are 25 mm",
        ),
        ("load.mass_kg=800", "load.mass_kg = 800 is read in kg; 800 g are 0.8 kg"),
        ("load.mass_kg=80", None),
        ("segment.0.lift=0.12", None),
        ("accuracy.chord_tolerance=0.012", None),
        ("print.slide_clearance=0.02", None),
        ("drawing.profile=0.03", None),
    ],
)
def test_a_number_that_looks_like_another_unit_is_told(
    root: Path, setting: str, said: str | None
) -> None:
    found = read_mechanism(root / "specs" / "disc-cam.toml", [setting])
    assert [hint for hint in found.hints if " is read in " in hint] == ([said] if said else [])


def test_a_key_that_is_missing_is_told_by_what_it_is(root: Path) -> None:
    data = read(root / "specs" / "gallery" / "geneva-table.toml")
    del data["geneva"][0]["pin_radius"]
    with pytest.raises(SpecError) as caught:
        read_mechanism(data)
    said = "geneva.0.pin_radius - missing: radius of the roller on the pin (a number >= 0.001 and <= 1000000)"
    assert said in str(caught.value)
