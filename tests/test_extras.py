"""What to type for a package that is not there works from where camgen came from, and for the environment that runs."""

from __future__ import annotations

import json
import shlex
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from camgen import extras


@pytest.fixture
def own_pip(monkeypatch: pytest.MonkeyPatch) -> None:
    """The environment is active."""
    pip = str(Path(sys.executable).with_name("pip"))
    monkeypatch.setattr(extras.shutil, "which", lambda name: pip)


COMMIT = "0123456789abcdef0123456789abcdef01234567"


@pytest.mark.parametrize(
    "record, line",
    [
        ({"url": "file:///home/a%20b/camgen", "dir_info": {}}, '"/home/a b/camgen[live]"'),
        (
            {"url": "file:///x/camgen-0.1-py3-none-any.whl", "archive_info": {}},
            '"camgen[live] @ file:///x/camgen-0.1-py3-none-any.whl"',
        ),
        (
            {
                "url": "https://example.org/camgen.git",
                "vcs_info": {"vcs": "git", "commit_id": COMMIT},
            },
            f'"camgen[live] @ git+https://example.org/camgen.git@{COMMIT}"',
        ),
        (None, '"camgen[live]"'),
    ],
)
def test_an_extra_comes_from_where_the_package_came_from(
    record: object, line: str, monkeypatch: pytest.MonkeyPatch, own_pip: None
) -> None:
    text = None if record is None else json.dumps(record)
    found = SimpleNamespace(read_text=lambda name: text)
    monkeypatch.setattr(extras, "distribution", lambda name: found)
    assert extras.install_line("live") == f"pip install {line}"


@pytest.mark.parametrize("first", [None, "/usr/bin/pip"])
def test_without_an_active_environment_its_python_is_named(
    first: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As where .venv/bin/camgen is typed: the first pip of the path is none, or the system's."""
    monkeypatch.setattr(extras.shutil, "which", lambda name: first)
    line = extras.pip_line("pandas")
    assert line == f"{sys.executable} -m pip install pandas"
    python, *_ = shlex.split(line)
    said = subprocess.run([python, "-m", "pip", "--version"], capture_output=True, text=True)
    assert said.returncode == 0 and said.stdout.startswith("pip ")
    monkeypatch.setattr(extras.sys, "executable", "C:/Program Files/Python/python.exe")
    assert extras.pip_line("pandas").startswith('"C:/Program Files/Python/python.exe" -m pip')
