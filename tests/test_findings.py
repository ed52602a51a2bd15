"""Where something was found, and what is wrong with a spec: records, and the texts that people read."""

from __future__ import annotations

import ast
import math
from collections import defaultdict
from dataclasses import replace
from pathlib import Path

import pytest

from camgen.errors import DesignError, Fault
from camgen.findings import Where, at_most, in_file


@pytest.mark.parametrize(
    ("where", "text"),
    [
        (Where(), ""),
        (Where("drive"), "drive"),
        (in_file(Path("out/x-cam.DXF")), "x-cam.DXF"),
        (replace(in_file(Path("x.3mf")), part="post-1"), "x.3mf, post-1"),
        (
            Where(file="x-*.stl", output="pen", theta=math.pi / 3),
            "x-*.stl, pen, cam angle 60.000 deg",
        ),
        (Where("pin B", part="pin-1", joint="B"), "pin B"),
        (Where(joint="B", theta=math.pi, angle="", digits=1), "B, 180.0 deg"),
        (Where(theta=math.radians(30.5), angle="crank angle", digits=None), "crank angle 30.5 deg"),
        (Where("lengths", module="take_up"), "take_up: lengths"),
    ],
)
def test_a_place_is_told_by_what_is_known(where: Where, text: str) -> None:
    assert str(where) == text
    finding = at_most("X", 1.0, 2.0, "mm", where, "")
    assert finding.as_dict()["where"] == text


def test_a_finding_is_one_line_for_a_person() -> None:
    held = at_most("MOTION_ERROR", 0.0010561, 0.00111, "mm", Where(output="s"), "rolled")
    assert str(held) == "MOTION_ERROR holds: 0.001056 <= 0.00111 mm; s; rolled"
    failed = at_most("LASH", 3, 2, "deg", Where("arm"), "")
    assert str(failed) == "LASH fails: not 3 <= 2 deg; arm"


def test_a_file_knows_its_kind() -> None:
    assert in_file(Path("a/b.STEP")).kind == "step" and in_file(Path("spec")).kind == ""


@pytest.mark.parametrize(
    ("fault", "text"),
    [
        (Fault(("segment", 1, "lift"), "", "x"), "segment.1.lift"),
        (Fault(("wanted", "vary", "geometry.rod"), "", "x"), 'wanted.vary."geometry.rod"'),
        (Fault(("shape", "lid"), "", "x", source="--set"), "--set shape.lid"),
        (Fault((), "", "x", source="line 3, column 1"), "line 3, column 1"),
    ],
)
def test_a_key_is_told_as_it_is_typed(fault: Fault, text: str) -> None:
    assert fault.key == text and str(fault).startswith(f"{text} -")
    assert fault.facts["path"] == text


def test_a_place_between_two_things_is_told_so() -> None:
    error = DesignError("wall", 1.0, 2.0, "mm", ("hole A", "edge"), "move A")
    assert error.between == ("hole A", "edge") and error.where == "between hole A and edge"
    assert str(error) == "wall is 1 mm between hole A and edge, limit: at least 2 mm; move A"
    assert (
        str(DesignError("wall", 1.0, 2.0, "mm", "hole A"))
        == "wall is 1 mm at hole A, limit: at least 2 mm"
    )


@pytest.mark.parametrize(
    ("value", "limit", "told"),
    [
        (8.95, 8.935531, "8.95 mm, limit: at most 8.936 mm"),
        (3.00004, 3.0, "3.00004 mm, limit: at most 3 mm"),
        (-5.38544, 0.0, "-5.385 mm, limit: at least 0 mm"),
        (1_999_998.0, 2_000_000.0, "1999998 mm, limit: at least 2000000 mm"),
        (float("inf"), 2.0, "inf mm, limit: at most 2 mm"),
        (0.0, 0.0, "0 mm, limit 0 mm"),
    ],
)
def test_a_fault_tells_on_which_side_of_its_limit_it_must_lie(
    value: float, limit: float, told: str
) -> None:
    """In four digits, or as many as tell the two apart."""
    assert str(DesignError("gap", value, limit, "mm")) == f"gap is {told}"


def test_a_code_has_one_unit_wherever_it_is_found() -> None:
    """As far as the source names both; an output's own unit, mm or deg, stands in a variable."""
    units = defaultdict[str, set[str]](set)
    package = Path(__file__).resolve().parent.parent / "camgen"
    for file in package.rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if not (isinstance(node, ast.Call) and isinstance(node.func, ast.Name)):
                continue
            place = {"at_most": 3, "at_least": 3, "Finding": 4}.get(node.func.id)
            if place is None or len(node.args) <= place:
                continue
            code, unit = (node.args[k] for k in (0, place))
            if isinstance(code, ast.Constant) and isinstance(unit, ast.Constant):
                units[code.value].add(unit.value)
    assert len(units) > 60
    assert not {code: each for code, each in units.items() if len(each) > 1}
