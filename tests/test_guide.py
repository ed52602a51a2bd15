"""The guide: what it says of findings is complete, what it says to type works."""

from __future__ import annotations

import ast
import json
import re
import shlex
import webbrowser
from pathlib import Path
from typing import Any

import pytest
import theory
from test_cli import run as run  # noqa: F401  a fixture

from camgen import guide

PACKAGE = Path(guide.__file__).parents[1]
JUDGES = (
    "judge",
    "machine",
    "machines",
    "measuring",
    "pipeline",
    "simulation",
    "sweep",
    "tolerance",
    "files",
)
# Capitals in the code that name no finding.
OTHERS = set(
    "ABC ABCDEFGHIJKLMNOPQRSTUVWXYZ ABCDEFGHJKLMNPQRSTUVWXYZ ABCDEFGHJKLMNPRSTUVWXYZ ABS ARC ASA CASE CENTER CIRCLE CONTINUOUS CUT DIM DIMENSION DXF "
    "ELLIPSE END_VAR HATCH ENGRAVE GROUND HIDDEN INSERT JSON LINE LWPOLYLINE OFF PATH PETG PITCH PLA POLYLINE POSITION SCALAR SCALE SLSQP "
    "SMC_CAMXYVA SPLINE STL TEXT VAR VAR_GLOBAL VIEW WALL".split()
)
WISHES = {
    "FEED_RANGE",
    "LET_DOWN_RATIO",
    "DWELL_DEG",
    "PV",
}  # of the take-up, by the keys of [wanted]; and the short one


def codes(text: str) -> set[str]:
    """Words in capitals that are whole strings of a program."""
    strings = {node.value for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Constant)}
    return {
        word
        for word in strings
        if isinstance(word, str) and re.fullmatch(r"[A-Z]{3,}(_[A-Z0-9]+)*", word)
    }


def test_every_code_has_an_entry_and_every_entry_a_code() -> None:
    files = [
        path for wing in JUDGES for path in (PACKAGE / wing).rglob("*.py") if path.name != "step.py"
    ]  # its own words
    texts = [path.read_text(encoding="utf-8") for path in files]
    assert (set().union(*map(codes, texts)) - OTHERS) | WISHES == set(guide.entries())


def test_a_code_without_an_entry_would_be_seen() -> None:
    assert codes('at_most("NEW_CODE", 1, 2, "mm", "", "DWELL")') - set(guide.entries()) == {
        "NEW_CODE"
    }


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
    undercut, wall = (guide.entries()[each].partition("\n")[2] for each in ("UNDERCUT", "MIN_WALL"))
    assert (code, out) == (0, f"UNDERCUT\n--------\n{undercut}\nMIN_WALL\n--------\n{wall}")
    code, out, err = run("explain", "modified-sin")
    assert code == 2 and "'modified-sin'" in err and "did you mean 'modified-sine'?" in err
    code, out, err = run("explain", "UNDERCUTS")
    assert (code, out) == (2, "") and "did you mean 'UNDERCUT'?" in err
    code, out, err = run("explain", "PRESURE")
    assert (code, out) == (2, "") and "did you mean 'PRESSURE_ANGLE'?" in err
    code, out, err = run("explain", "TRANSMISSION_ANGEL")
    assert code == 2 and "did you mean 'TRANSMISSION_ANGLE'?" in err
    assert "did you mean 'TRANSMISSION_ANGLE'?" in run("explain", "TRANSMISION")[2], "the first"
    assert "did you mean" not in run("explain", "FOO")[2]
    assert "did you mean 'first-cam'?" in run("guide", "frist")[2]
    code, out, err = run("build", "none.toml", "--only", "pdf")
    assert code == 2 and "Drawings, in PDF too, come with dxf." in err
    code, out, err = run("build", "none.toml", "--only", "dfx,stp")
    assert code == 2 and "Did you mean dxf, step?" in err
    code, out, err = run("explain", "a.toml", "LASH", "b.toml")
    assert code == 2 and "one SPEC at a time, not a.toml and b.toml" in err
    code, out, err = run("explain", str(ROOT / "specs" / "none.toml"), "LASH")  # in any order
    assert code == 4 and "none.toml" in err


ROOT = PACKAGE.parent
BLOCKS = [
    (topic, *block)
    for topic in guide.TOPICS
    for block in re.findall(r"^```(\w+)\n(.*?)^```", guide.page(topic), re.M | re.S)
]


def test_every_page_is_a_topic_and_has_a_title() -> None:
    assert {path.stem for path in Path(guide.__file__).parent.glob("*.md")} == set(guide.TOPICS)
    assert len({guide.title(topic) for topic in guide.TOPICS}) == len(guide.TOPICS)
    assert {kind for _, kind, _ in BLOCKS} <= {"sh", "toml", "python", "text"}
    text = "".join(map(guide.page, guide.TOPICS))
    assert set(re.findall(r"camgen guide ([a-z][a-z-]+)", text)) <= set(guide.TOPICS)
    assert all(
        (ROOT / path).exists()
        for path in re.findall(r"`(specs/[a-z-]+\.toml|camgen/[a-z_/]+(?:\.py|\.md)?)`", text)
    )


@pytest.mark.parametrize("name", theory.FIGURES)
def test_the_figures_of_the_theory_pages_are_of_today(name: str) -> None:
    assert theory.path(name).read_text(encoding="utf-8") == theory.FIGURES[name]().svg()


def test_every_figure_stands_in_a_page_and_in_a_terminal_its_path() -> None:
    shown = [
        name
        for topic in guide.TOPICS
        for name in re.findall(r"!\[.+?\]\((\S+)\.svg\)", guide.page(topic))
    ]
    assert sorted(shown) == sorted(theory.FIGURES)
    text = guide.in_terminal("theory-linkage")
    assert "![" not in text and all(
        Path(path).exists() for path in re.findall(r"`(/\S+\.svg)`", text)
    )
    assert len(re.findall(r"`(/\S+\.svg)`", text)) == 2


@pytest.mark.long
@pytest.mark.parametrize("topic", guide.TOPICS)
def test_what_a_page_says_to_type_works(
    topic: str,
    run: Any,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,  # noqa: F811
) -> None:
    (tmp_path / "specs").symlink_to(ROOT / "specs")
    monkeypatch.chdir(tmp_path)
    for kind, text in [(kind, text) for page, kind, text in BLOCKS if page == topic]:
        if kind == "toml":
            Path(text.partition("\n")[0].lstrip("# ")).write_text(text, "utf-8")
        elif kind == "python":
            exec(compile(text, f"{topic}.md", "exec"), {})
        for line in text.splitlines() if kind == "sh" else ():
            program, *arguments = shlex.split(line, comments=True)
            code, out, err = run(*arguments)
            wanted = re.search(r"# ends with (\d)$", line)
            assert program == "camgen" and code == (int(wanted[1]) if wanted else 0), (
                f"{line}\n{out}{err}"
            )


NOTEBOOK = Path(guide.__file__).parent / "python.ipynb"


def displayed(value: Any) -> str:
    """What a notebook shows of the last expression of a cell: of a picture nothing but that there is one."""
    for kind in ("_repr_html_", "_repr_markdown_", "_repr_png_"):
        said = getattr(value, kind)() if hasattr(value, kind) else None
        if said is not None:
            return str(said)
    return "" if value is None else repr(value)


@pytest.mark.long
def test_the_notebook_runs_from_its_first_cell_to_its_last(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    notebook = json.loads(NOTEBOOK.read_text(encoding="utf-8"))
    cells = ["".join(cell["source"]) for cell in notebook["cells"] if cell["cell_type"] == "code"]
    assert not any(cell.get("outputs") for cell in notebook["cells"]), (
        "runs of a person's are not kept"
    )
    opened: list[str] = []
    monkeypatch.setattr(webbrowser, "open", lambda uri: opened.append(uri) or True)
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    shown = []
    for number, cell in enumerate(cells):
        *body, last = ast.parse(cell).body
        ends = isinstance(last, ast.Expr)
        statements = ast.Module(body if ends else [*body, last], [])
        exec(compile(statements, f"cell {number}", "exec"), names)
        if isinstance(last, ast.Expr):
            value = eval(compile(ast.Expression(last.value), f"cell {number}", "eval"), names)
            shown.append(displayed(value))
    assert names["least"] < 0.75 and names["report"].ok and len(names["swept"]) == 8
    assert [Path(uri).name for uri in opened] == ["report.html"]
    text = "\n".join(shown)
    for words in ("Run at 361 angles", "8 variants", "findings hold", "## LASH", "PNG"):
        assert words in text
    said = capsys.readouterr().out
    assert (
        "lengths.O-A: -60 - expected" in said
        and "drive.speed: unknown key; did you mean 'speed_rpm'?" in said
    )


def test_the_guide_is_shown_and_listed(run: Any) -> None:  # noqa: F811
    code, out, _ = run("guide")
    assert code == 0 and [line.split()[2] for line in out.splitlines()] == list(guide.TOPICS)
    code, out, _ = run("guide", "first-cam")
    assert code == 0 and out.startswith("Your first cam\n==============\n\nWith this page")
    assert "\n2. Build it\n-----------\n" in out and "\n#" not in re.sub(
        r"```.*?```", "", out, flags=re.S
    )
    assert "\n# " in run("guide", "own-linkage")[1], "a comment of a spec is no heading"
    bare = re.compile(r"^#+ |^[=-]+\n", re.M)
    assert bare.sub("", out) == bare.sub("", guide.in_terminal("first-cam"))
    assert "\nPicture: The cam of section 1" in guide.in_terminal("first-cam")
    code, out, err = run("guide", "firstcam")
    assert (code, out) == (2, "") and "did you mean 'first-cam'?" in err


_SOURCE = re.compile(r"`((?:[\w.-]+/)*[\w.-]+\.py)\b")  # a file of Python that a page names
_FOR_MAKERS = ("house", "new-machine")  # pages of people who have the source


def test_pages_of_users_name_no_file_that_they_do_not_have() -> None:
    """Whoever installs camgen has no folder of its source to read in."""
    named = {topic: _SOURCE.findall(guide.page(topic)) for topic in guide.TOPICS}
    assert {topic for topic, files in named.items() if files} == set(_FOR_MAKERS)


def test_every_file_that_the_makers_pages_name_is_there(root: Path) -> None:
    """As a path from `camgen/` or from the top, or as a name in one of the folders named before it in its row."""
    for topic in _FOR_MAKERS:
        for line in guide.page(topic).splitlines():
            folders = [root, root / "camgen"]
            folders += [root / "camgen" / each for each in re.findall(r"`([\w/]+/)`", line)]
            for name in _SOURCE.findall(line) + re.findall(r"`python ([\w/]+\.py)", line):
                assert any((each / name).is_file() for each in folders), (topic, name)
