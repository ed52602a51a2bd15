"""The net under a rebuild sees what moves."""

import json

import net
import pytest


@pytest.fixture
def states(tmp_path):
    """Two equal folders of outputs."""
    for state in ("before", "after"):
        folder = tmp_path / state / "case-0"
        folder.mkdir(parents=True)
        (folder / "part.dxf").write_text("10\n12.5\n20\n-3.0\n")
        (folder / "report.json").write_text(json.dumps({"stroke_mm": 12.0}))
        (folder / "report.html").write_text("<p>12 mm</p>")
        (tmp_path / state / "times.json").write_text(json.dumps({"case-0": 2.0}))
    return tmp_path / "before", tmp_path / "after"


def test_equal_states_hold(states):
    assert net.compare(*states) == 0


def test_a_number_that_is_rounded_otherwise_is_the_same(states):
    (states[1] / "case-0" / "part.dxf").write_text("10\n12.5000000001\n20\n-3.0\n")
    assert net.compare(*states) == 0


@pytest.mark.parametrize(
    "change", ["10\n12.5000001\n20\n-3.0\n", "10\n12.5\n20\n3.0\n", "10\n12.5\n20\n-3.0\n0\nEOF\n"]
)
def test_what_must_be_equal_is_counted(states, change):
    (states[1] / "case-0" / "part.dxf").write_text(change)
    assert net.compare(*states) == 1


def test_a_lost_file_is_counted(states):
    (states[1] / "case-0" / "report.json").unlink()
    assert net.compare(*states) == 1


def test_a_page_may_move_and_is_shown(states, capsys):
    (states[1] / "case-0" / "report.html").write_text("<p>13 mm</p>")
    assert net.compare(*states) == 0
    assert "report.html" in capsys.readouterr().out


def test_every_shipped_spec_is_a_case(root):
    named = {case.name for case in net.cases(root)}
    specs = [*(root / "specs").glob("*.toml"), *(root / "specs" / "gallery").glob("*.toml")]
    assert {f"{path.stem}-0" for path in specs} <= named
