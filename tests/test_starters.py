"""The starters are made from the fields of the tables, which say of each key what it is; they show every key."""

from __future__ import annotations

import re
import tomllib
from typing import Any

import pytest
import starter_comments
from starter_comments import rows, written
from test_cli import run as run  # noqa: F401  a fixture

from camgen import starters
from camgen.edits import edited
from camgen.machines import MECHANISMS, load
from camgen.machines.loads.assess import assess
from camgen.parts import materials
from camgen.parts.generator.sizes import Parts
from camgen.pipeline.making import parts_table
from camgen.schemas import step_below, tables_of
from camgen.spec import schema, validate

# Tables that stand on one line, whose keys are seen in examples.
INLINE = {
    "LawChoice",
    "Stroke",
    "Through",
    "Trace",
    "Lines",
    "Straight",
    "Dwell",
    "TimeRatio",
    "Function",
    "CamSegment",
    "DriveSegment",
    "Applied",
    "Battery",
    "Can",
    "ThreadPosts",
}
SHARED = {
    "EccentricSizes",
    "DiscCamParts",
    "IndexingParts",
}  # they have the keys of a linkage's [parts]
OWN = {
    "source",
    "contours",
    "drawn_in",
}  # of an include, of an outline: written by camgen, not by a person

# What a key's name may end in, and the unit that it then has: the longest ending counts.
ENDINGS = {
    "deg": "deg",
    "rpm": "rpm",
    "mm": "mm",
    "g": "g",
    "kg": "kg",
    "n": "N",
    "n_m": "N m",
    "n_mm": "N/mm",
    "g_mm": "g mm",
    "kg_m2": "kg m^2",
    "g_mm2": "g mm^2",
    "mpa": "MPa",
    "mpa_m_s": "MPa m/s",
    "per_s": "1/s",
}


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
        or not ({"default", "deprecated"} & {*node} or key in table.get("required", ()))
        or (is_number(node) and "unit" not in node)
    ]


def misnamed(root: dict[str, Any]) -> list[tuple[str, str]]:
    """Keys whose name ends in another unit than they have."""
    found = []
    for name, table in tables(root):
        for key, node in table.get("properties", {}).items():
            ending = max((end for end in ENDINGS if key.endswith(f"_{end}")), key=len, default="")
            if ending and is_number(node) and node["unit"] != ENDINGS[ending]:
                found.append((name, key))
    return found


@pytest.mark.parametrize("mechanism", MECHANISMS)
def test_schema_describes_every_key(mechanism: str) -> None:
    root = schema(load(mechanism), mechanism)
    assert bare(root) == misnamed(root) == []
    step = root["$defs"]["Drawing"]["properties"]["profile_step_deg"]
    step["unit"] = "rad"
    assert misnamed(root) == [("Drawing", "profile_step_deg")]
    del step["unit"]
    assert bare(root) == [("Drawing", "profile_step_deg")]


# How a description begins that says nothing without its table, such as "of the roller" of a radius.
_FRAGMENT = re.compile(
    r"(of|that|or|the same|at|by|from|to|with|between|round|behind|beside|about|as)\b"
)


def fragments(root: dict[str, Any]) -> list[tuple[str, str]]:
    """Keys whose description is no phrase of its own."""
    return [
        (name, key)
        for name, table in tables(root)
        for key, node in table.get("properties", {}).items()
        if _FRAGMENT.match(node.get("description", ""))
    ]


@pytest.mark.parametrize("mechanism", MECHANISMS)
def test_a_key_is_understood_by_its_description_alone(mechanism: str) -> None:
    """As the tooltip of a slider, an editor and a schema show it."""
    root = schema(load(mechanism), mechanism)
    assert fragments(root) == []
    root["$defs"]["Print"]["properties"]["bed"]["description"] = "of the bed"
    assert fragments(root) == [("Print", "bed")]


@pytest.mark.parametrize("mechanism", MECHANISMS)
def test_starter_is_as_its_class_says(mechanism: str) -> None:
    """A comment or a default that was changed by hand is written as the field has it; run tests/starter_comments.py."""
    text = starters.text(mechanism)
    assert written(mechanism, text) == text
    (row,) = [row for row in rows(text) if row.path == ("print", "bed_height")]
    assert row.line.endswith("# mm, height of the tallest part that it can print")
    other = text.replace(row.line, "# bed_height = 240 # inch, or so\n                  # or less")
    assert other != text and written(mechanism, other) == text


def test_what_is_no_description_stays() -> None:
    """Text of a starter, a key that its table names freely, a second mention, and an example in a list of tables."""
    lines = """\
# A machine.
[points]                            # mm, where the points are at theta = 0
O = [0, 0]                          # the shaft
# [[gear]]                          # angle of b = ratio * angle of a
# ratio = -2                        # angle of b = ratio * angle of a, a number or teeth of a over those of b, "-12/30"; below 0: they turn
                                    # against each other, above 0: b is a ring, inner = true
# [[gear]]                          # another pair
# ratio = 3                         # inner
                                    # and outer
"""
    assert written("linkage", lines) == lines


@pytest.mark.parametrize("mechanism", MECHANISMS)
def test_starter_shows_every_key(mechanism: str) -> None:
    root, shown = schema(load(mechanism), mechanism), set()
    for row in rows(starters.text(mechanism)):
        for table in holders(root, row.path) if row.path else ():
            shown.add((id(table), row.path[-1]))
    texts = "".join(map(starters.text, MECHANISMS))
    linkage = {row.path[-1] for row in rows(starters.text("linkage")) if row.path[:1] == ("parts",)}
    for name, table in tables(root):
        for key, node in table.get("properties", {}).items():
            if node.get("deprecated"):  # the old name of another
                continue
            free = (name in INLINE or name == "Shape") and re.search(rf"\b{key} = ", texts)
            # The starter points to a linkage's [parts] for what it shares with them.
            shared = name in SHARED and key in Parts.model_fields and key in linkage
            own = key in OWN or (name, key) == ("", "masses")
            assert (id(table), key) in shown or free or shared or own, (name, key)


def test_a_comment_of_several_lines() -> None:
    said = {"description": "one; " * 30 + "two\nthree", "type": "number", "unit": "mm"}
    lines = starter_comments.comment(said, "width")
    assert lines[0].startswith("mm, one; one;") and lines[-1] == "three" and len(lines) == 3
    assert starter_comments.comment({**said, "description": "that"}, "width_mm") == ["that"]


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
        "files.centre_marks=true",
        "-o",
        tmp_path,
    )
    assert code == 0 and "files.centre_marks is read as center_marks" in out + err
    assert "center_marks = true" in (tmp_path / "a" / "spec.toml").read_text(encoding="utf-8")


@pytest.mark.parametrize("mechanism", MECHANISMS)
def test_starter_is_valid(mechanism: str) -> None:
    validate(load(mechanism), tomllib.loads(starters.text(mechanism)))


@pytest.mark.long
@pytest.mark.parametrize("name", [*MECHANISMS, *starters.examples()])
def test_a_short_starter_is_the_same_machine(name: str) -> None:
    """By the class of the spec: of the same record, without comments but its title."""
    cls = load(starters.kind(name))
    short = starters.short(starters.text(name))
    title, *lines = short.splitlines()
    assert title[0] == "#" and not any(line.startswith("#") for line in lines)
    long = starters.text(name)
    assert validate(cls, tomllib.loads(short)) == validate(cls, tomllib.loads(long))
    keys = [line for line in long.splitlines() if line and line[0] != "#"]
    assert len(list(filter(None, lines))) <= len(keys)


@pytest.mark.parametrize("name", starters.METAL)
def test_a_metal_starter_has_each_table_once_with_its_comment(name: str) -> None:
    """What is set stands where it is explained, not at the end beside a table that is still behind a #."""
    tables = re.findall(r"(?m)^(?:# )?\[([\w.]+)\]", starters.in_metal(name))
    assert tables and len(tables) == len(set(tables))


def test_the_shortest_way_to_a_cam_has_some_fifteen_lines() -> None:
    assert len(starters.short(starters.text("disc-cam")).splitlines()) == 16


@pytest.mark.parametrize("name", [*MECHANISMS, *starters.examples()])
def test_the_title_in_lists_is_whole_sentences(name: str) -> None:
    assert starters.summary(name).endswith(".")


@pytest.mark.parametrize("name", ["c", "a-cam-with-a-longer-name"])
def test_another_name_leaves_the_comment_in_its_column(name: str) -> None:
    text = 'mechanism = "valve"    # kind\nname = "valve"         # folder\n[part]\nname = "x"\n'
    renamed = starters.named(text, name)
    kind, own, *rest = renamed.splitlines()
    assert own.startswith(f'name = "{name}"') and rest == ["[part]", 'name = "x"']
    assert len(name) > 5 or own.index("#") == kind.index("#")


def test_a_name_that_fills_its_column_keeps_a_space_before_its_comment() -> None:
    assert starters.named('name = "a"  # folder', "abcde") == 'name = "abcde" # folder'


@pytest.mark.parametrize("name", starters.METAL)
def test_the_comments_of_a_starter_of_steel_are_not_those_of_a_print(name: str) -> None:
    """Its thickness behind a # is 6 mm, which in steel is 12; nothing in it speaks of a printer, and what it sets is what the starter and
    METAL set, but for sizes of prints. A key stands once, with its comment."""
    whole = starters.in_metal(name)
    assert "show their defaults" not in whole
    words = r"nozzle|printers?|prints?(?![.\w])(?!\])|slicer|infill|first layer"
    assert [
        line for line in whole.splitlines() if re.search(rf"\b({words})\b", line, re.IGNORECASE)
    ] == []
    sets = tomllib.loads(edited(starters.text(name), starters.METAL[name]))
    for table, key in (("print", "nozzle"), ("parts", "hub_diameter"), ("parts", "hub_height")):
        if name != "geneva-table":  # whose table has a hub of its own
            sets.get(table, {}).pop(key, None)
    sets.get("limits", {}).pop("min_wall", None)
    assert tomllib.loads(whole) == sets
    texts = [
        line
        for line in whole.splitlines()
        if line.startswith(('name = "C45"', "slide_clearance = "))
    ]
    assert all(line.find("#") == 36 for line in texts if name == "linkage") and texts


@pytest.mark.parametrize("name", starters.METAL)
def test_a_starter_of_steel_holds_and_has_what_a_workshop_asks_for(name: str) -> None:
    """Of C45; a key with its length [DIN 6885] and a roller that is sold; shafts of steel, dowels, ball bearings; walls of 1 mm."""
    machine: Any = validate(load(starters.kind(name)), tomllib.loads(starters.in_metal(name)))
    assert materials.of(machine.material.name).metal and machine.allowed.min_wall == 1
    assert all(each.ok for each in [*machine.limits(), *assess(machine).findings])
    bought = {str(row[1]): str(row[2]) for row in parts_table(machine).rows if row[0] == "bought"}
    if name in ("geneva-table", "linkage"):
        made = {str(row[1]): str(row[0]) for row in parts_table(machine).rows}
        assert made["shaft"] == "turned of steel"
        assert "anaerobic" in bought["glue"]
        joint = bought["pin-1"] if name == "geneva-table" else bought["bearing-695"]
        assert joint.startswith(("Pin 1: dowel ISO 8734", "Ball bearing: ball bearing 695ZZ"))
        # a core hole of 4.2 [ISO 2306]
        assert bought["screw of the plate, from behind"].startswith("M5")
    else:
        assert re.search(r"x \d+, DIN 6885", bought["parallel key"])
        assert bought["cam follower"].startswith("KR")
        assert not any("plain bore" in note for note in machine.study().notes)
