"""What the README says to type is what works, and what CI types."""

from __future__ import annotations

import re
import shlex
import shutil
import tomllib
from pathlib import Path

import pytest

from camgen import __version__
from camgen.cli import cli, main

ROOT = Path(__file__).resolve().parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")
COMMANDS = [
    line
    for block in re.findall(r"```sh\n(.*?)```", README, re.DOTALL)
    for line in block.splitlines()
    if line.strip()
]
SETTING_UP = [command for command in COMMANDS if command.startswith("python3")]
SET_UP = "python3 -m venv .venv && .venv/bin/pip install -q"


def test_two_commands_set_up_then_build_and_test() -> None:
    build, test = SETTING_UP
    assert build == COMMANDS[0]
    assert build == f"{SET_UP} . && .venv/bin/camgen build specs/walking-leg.toml"
    assert test == f"{SET_UP} -e '.[test]' && .venv/bin/pytest -q -n auto --dist loadfile"


def test_every_extra_stands_in_the_readme_with_what_it_is_for() -> None:
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    shown = dict(re.findall(r'^pip install "\.\[(\w+)\]" +(\S.*)$', README, re.MULTILINE))
    assert shown.keys() == extras["optional-dependencies"].keys() - {"test"}
    pandas = {
        name for name, needs in extras["optional-dependencies"].items() if "pandas>=2.2.2" in needs
    }
    assert pandas == {name for name, what in shown.items() if "to_dataframe()" in what}


def test_ci_runs_exactly_these_two() -> None:
    lines = (ROOT / ".ci" / "run").read_text(encoding="utf-8").splitlines()
    assert set(SETTING_UP) <= {line.strip() for line in lines}
    assert (ROOT / ".ci" / "run").stat().st_mode & 0o111


@pytest.mark.long
def test_every_other_command_works_in_its_order(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    shutil.copytree(ROOT / "specs", tmp_path / "specs")
    swing = (
        tmp_path / "specs" / "uniform-swing.toml"
    )  # its machine is built in tests/machines/test_swing_machine.py
    text = swing.read_text(encoding="utf-8")
    swing.write_text(re.sub(r'(?m)^make = ".*?"', 'make = "cams"', text), encoding="utf-8")
    assert swing.read_text(encoding="utf-8") != text
    monkeypatch.chdir(tmp_path)
    ran = [
        command for command in COMMANDS if command not in SETTING_UP
    ]  # one of them builds what the first one does
    for command in ran:
        program, *arguments = shlex.split(command)
        assert Path(program).name == "camgen", command
        with pytest.raises(SystemExit) as done:
            main(arguments)
        assert done.value.code == 0, f"{command}\n{capsys.readouterr()}"


@pytest.mark.long
def test_what_a_build_says_is_what_it_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (block,) = re.findall(r"```\n\$ (.*?)```", README, re.DOTALL)
    command, *said = block.splitlines()
    monkeypatch.setattr("camgen.files.shelves.MOST_FLAT", 20)  # as it is, but in tests
    shutil.copytree(ROOT / "specs", tmp_path / "specs")
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as done:
        main(shlex.split(command)[1:])
    assert done.value.code == 0 and capsys.readouterr().out.splitlines() == said


def test_python_runs_as_it_stands(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (block,) = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
    assert len([line for line in block.splitlines() if line.strip()]) <= 18
    shutil.copytree(ROOT / "specs", tmp_path / "specs")
    monkeypatch.chdir(tmp_path)
    exec(compile(block, "README.md", "exec"), {})
    told = capsys.readouterr()
    first, second, *faults = told.out.splitlines()
    assert (
        first.startswith("[] 0.00")
        and float(second.split()[0]) == pytest.approx(12, abs=2e-3)
        and told.err == ""
    )
    assert {fault.partition(":")[0].partition(" ")[0] for fault in faults} >= {
        "geometry",
        "segment",
    }


def test_every_command_and_exit_code_is_told() -> None:
    for name in cli.commands:
        assert re.search(rf"camgen {name}\b", README), name
    for code in (0, 1, 2, 3, 4):
        assert re.search(rf"^\| {code} \|", README, re.MULTILINE), code


def test_linked_files_exist() -> None:
    for target in re.findall(r"\]\(([^)#:]+)\)", README):
        assert (ROOT / target).exists(), target


def test_a_maker_reads_it_in_minutes() -> None:
    prose = re.sub(r"```.*?```", "", README, flags=re.DOTALL)
    assert len(prose.partition("## Commands")[0].split()) < 600 and len(prose.split()) < 900


def test_citation_and_changes_name_this_version() -> None:
    assert f"\nversion: {__version__}\n" in (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert __version__.rpartition(".")[0] in (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
