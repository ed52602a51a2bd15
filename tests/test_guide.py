"""The guide: what it says of findings is complete, what it says to type works."""

from __future__ import annotations

import ast
import re
from pathlib import Path
from typing import Any

import pytest
from test_cli import run as run  # noqa: F401  a fixture

from camgen import guide

PACKAGE = Path(guide.__file__).parents[1]
JUDGES = ("judge", "machine", "machines", "pipeline", "files")
# Capitals in the code that name no finding.
OTHERS = set(
    "ABC ABCDEFGHIJKLMNOPQRSTUVWXYZ ABCDEFGHJKLMNPQRSTUVWXYZ ABS ARC ASA CENTER CIRCLE CONTINUOUS CUT DIM DXF ELLIPSE GROUND "
    "HIDDEN INSERT JSON LINE LWPOLYLINE PETG PLA POLYLINE SLSQP SPLINE STL TEXT VIEW".split()
)
WISHES = {"FEED_RANGE", "LET_DOWN_RATIO", "DWELL_DEG"}  # of the take-up, by the keys of [wanted]


def codes(text: str) -> set[str]:
    """Words in capitals that are whole strings of a program."""
    strings = {node.value for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Constant)}
    return {word for word in strings if isinstance(word, str) and re.fullmatch(r"[A-Z]{3,}(_[A-Z0-9]+)*", word)}


def test_every_code_has_an_entry_and_every_entry_a_code() -> None:
    texts = [path.read_text(encoding="utf-8") for wing in JUDGES for path in (PACKAGE / wing).rglob("*.py")]
    assert (set().union(*map(codes, texts)) - OTHERS) | WISHES == set(guide.entries())


def test_a_code_without_an_entry_would_be_seen() -> None:
    assert codes('at_most("NEW_CODE", 1, 2, "mm", "", "DWELL")') - set(guide.entries()) == {"NEW_CODE"}


@pytest.mark.parametrize("code", guide.entries())
def test_an_entry_says_meaning_formula_limit_and_remedy(code: str) -> None:
    entry = guide.entries()[code]
    assert re.fullmatch(
        rf"## {code}\n[A-Z].*?\.\n- Formula: .+?\n- Limit: .+?\n- Remedy: .+?\.\n", entry, re.DOTALL
    ), entry
    assert 10 < len(guide.in_short(entry)) < 120


def test_explain_shows_entries_and_names_the_nearest(run: Any) -> None:  # noqa: F811
    code, out, _ = run("explain")
    assert code == 0 and [line.split()[0] for line in out.splitlines()] == list(guide.entries())
    code, out, _ = run("explain", "undercut", "MIN_WALL")
    assert (code, out) == (0, f"{guide.entries()['UNDERCUT']}\n{guide.entries()['MIN_WALL']}")
    code, out, err = run("explain", "UNDERCUTS")
    assert (code, out) == (2, "") and "did you mean 'UNDERCUT'?" in err
