"""The starters teach: the schema says of each key what their comments say, and they show every key."""

from __future__ import annotations

import re
import tomllib
from typing import Any

import pytest
from test_cli import run as run  # noqa: F401  a fixture

from camgen import starters
from camgen.machines import MECHANISMS, load
from camgen.schemas import step_below, tables_of
from camgen.spec import schema, validate

# Tables that stand on one line, whose keys are seen in examples; those of [bodies] are shown by the starter of a linkage.
INLINE = {
    "LawChoice",
    "Stroke",
    "Through",
    "Trace",
    "Straight",
    "Dwell",
    "TimeRatio",
    "Function",
    "CamSegment",
    "DriveSegment",
    "Applied",
    "Can",
}
OWN = {"source"}  # of an include: written by camgen, not by a person
FITS = {"slide_clearance", "press_clearance"}  # each machine says what else they are


def tables(root: dict[str, Any]) -> list[tuple[str, dict[str, Any]]]:
    return [("", root), *root["$defs"].items()]


def holders(root: dict[str, Any], path: tuple[str, ...]) -> list[dict[str, Any]]:
    """Tables of the schema that hold the key at a path."""
    found = [root]
    for step in path[:-1]:
        found = [each for table in found for each in tables_of(step_below(table, step, root), root)]
    return [table for table in found if path[-1] in table.get("properties", ())]


def is_number(node: dict[str, Any]) -> bool:
    inner = [*node.get("anyOf", ()), *node.get("prefixItems", ()), node.get("items")]
    return node.get("type") in ("number", "integer") or any(
        is_number(each) for each in inner if isinstance(each, dict)
    )


def bare(root: dict[str, Any]) -> list[tuple[str, str]]:
    """Keys without a description, a default where none must be given, or, of a number, a unit."""
    return [
        (name, key)
        for name, table in tables(root)
        for key, node in table.get("properties", {}).items()
        if not node.get("description")
        or not ("default" in node or key in table.get("required", ()))
        or (is_number(node) and "unit" not in node)
    ]


@pytest.mark.parametrize("mechanism", MECHANISMS)
def test_schema_describes_every_key(mechanism: str) -> None:
    root = starters.described(load(mechanism), mechanism)
    assert bare(root) == []
    del root["$defs"]["Accuracy"]["properties"]["chord_tolerance"]["unit"]
    assert bare(root) == [("Accuracy", "chord_tolerance")]


@pytest.mark.parametrize("mechanism", MECHANISMS)
def test_schema_and_starter_say_the_same(mechanism: str) -> None:
    root = starters.described(load(mechanism), mechanism)
    for path, _, said in starters.rows(starters.text(mechanism)):
        for table in holders(root, path) if said else ():
            assert table["properties"][path[-1]]["description"], path
    first = {
        path: said
        for path, _, said in reversed(list(starters.rows(starters.text(mechanism))))
        if said
    }
    assert len(first) > 20
    told = root["$defs"]["Print"]["properties"]["bed_height"]["description"]
    assert told == first["print", "bed_height"] and f"# {told}" in starters.text(mechanism)


@pytest.mark.parametrize("mechanism", [name for name in MECHANISMS if name != "linkage"])
def test_what_a_starter_says_is_said_nowhere_else(mechanism: str) -> None:
    root = schema(load(mechanism), mechanism)
    for path, _, said in starters.rows(starters.text(mechanism)):
        for table in holders(root, path) if said and path[0] != "bodies" else ():
            node = table["properties"][path[-1]]
            assert "description" not in node or "pattern" in node, path


@pytest.mark.parametrize("mechanism", MECHANISMS)
def test_starter_shows_every_key_and_its_default(mechanism: str) -> None:
    root, text, shown = (
        starters.described(load(mechanism), mechanism),
        starters.text(mechanism),
        set(),
    )
    for path, value, _ in starters.rows(text):
        for table in holders(root, path):
            shown.add((id(table), path[-1]))
            default = table["properties"][path[-1]].get("default")
            asleep = re.search(
                rf"^# {re.escape(path[-1])} = {re.escape(value)}", text, re.MULTILINE
            )
            if (
                value and asleep and default is not None and mechanism != "linkage"
            ):  # it shows what else there is
                assert tomllib.loads(f"x = {value}")["x"] == default, path
    texts = "".join(map(starters.text, MECHANISMS))
    for name, table in tables(root):
        for key in table.get("properties", ()):
            free = (name in INLINE or name in ("Sizes", "Shape")) and re.search(
                rf"\b{key} = ", texts
            )
            assert (
                (id(table), key) in shown or free or key in OWN or (name, key) == ("", "masses")
            ), (name, key)


def test_what_all_machines_share_is_said_alike() -> None:
    said: dict[tuple[str, ...], set[str]] = {}
    for mechanism in MECHANISMS:
        for path, _, about in starters.rows(starters.text(mechanism)):
            if mechanism == "linkage":  # where [[output]] is another thing
                path = {"files": ("output", *path[1:]), "output": ("",)}.get(path[0], path)
            if (
                path[0] in ("print", "material", "accuracy", "output")
                and path[-1] not in FITS
                and path[1:]
            ):
                said.setdefault(path, set()).add(about)
    assert {path: texts for path, texts in said.items() if len(texts) > 1} == {} and len(said) >= 13


def test_a_comment_goes_on_in_the_next_line() -> None:
    lines = '[a]\n# b = "c#d"  # one\n          # two\n# [[e.f]]   # three\n"A-B" = 5 # four\n# text = is not a key?'
    assert list(starters.rows(lines))[:4] == [
        (("a",), "", ""),
        (("a", "b"), '"c#d"', "one two"),
        (("e", "f"), "", "three"),
        (("e", "f", "A-B"), "5", "four"),
    ]


@pytest.mark.parametrize(
    "key, hint",
    [("parts.color", None), ("print.bed_hight", "bed_height"), ("geometry.follower.centre", None)],
)
def test_unknown_keys_are_told(run: Any, tmp_path: Any, key: str, hint: str | None) -> None:  # noqa: F811
    run("new", "disc-cam", tmp_path / "a.toml")
    code, _, err = run("build", tmp_path / "a.toml", "--set", f"{key}=1", "-o", tmp_path)
    assert code == 2 and key in err and (hint is None or f"did you mean '{hint}'?" in err)


@pytest.mark.parametrize(
    ("mechanism", "key", "hint"),
    [("linkage", "mechanism=linkages", "linkage"), ("disc-cam", "mechanism=disk-cam", "disc-cam")],
)
def test_a_mechanism_nearly_named_is_hinted(
    run: Any, tmp_path: Any, mechanism: str, key: str, hint: str
) -> None:  # noqa: F811
    run("new", mechanism, tmp_path / "a.toml")
    code, _, err = run("build", tmp_path / "a.toml", "--set", key, "-o", tmp_path)
    assert code == 2 and f"did you mean '{hint}'?" in err


def test_a_key_in_the_other_spelling_is_built_and_noted(run: Any, tmp_path: Any) -> None:  # noqa: F811
    """A part's outline alone is made; the spec that is written has the key as it is known."""
    run("new", "disc-cam", tmp_path / "a.toml")
    code, out, err = run(
        "build",
        tmp_path / "a.toml",
        "--only",
        "dxf",
        "--set",
        "output.centre_marks=true",
        "-o",
        tmp_path,
    )
    assert code == 0 and "output.centre_marks is read as center_marks" in out + err
    assert "center_marks = true" in (tmp_path / "disc-cam" / "spec.toml").read_text(
        encoding="utf-8"
    )


@pytest.mark.parametrize("mechanism", MECHANISMS)
def test_starter_is_valid(mechanism: str) -> None:
    validate(load(mechanism), tomllib.loads(starters.text(mechanism)))
