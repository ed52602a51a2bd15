"""The lowest versions that pyproject.toml allows are enough: `.ci/run` makes an environment of them, and runs this in it.

Each dependency there is the very one that pyproject.toml names, and each mechanism is built with its machine. What the optional
extras do is seen by the tests beside which `.ci/run` starts this.
"""

from __future__ import annotations

import re
import tomllib
from importlib.metadata import version
from pathlib import Path

import pytest

from camgen.files.formats import RENDERED
from camgen.machines import MECHANISMS
from camgen.pipeline.build import ANY_KIND, build

TOP = Path(__file__).resolve().parent.parent
PROJECT = tomllib.loads((TOP / "pyproject.toml").read_text(encoding="utf-8"))["project"]
LISTED = [
    *PROJECT["dependencies"],
    *(each for extra in PROJECT["optional-dependencies"].values() for each in extra),
]
DEPENDENCIES = [each for each in LISTED if not each.startswith("camgen[")]
EVERYTHING = "eccentric-drive"  # of the others drawings and meshes are made, which take less time


def release(text: str) -> list[int]:
    """Numbers of a version without zeros at the end, as 2.0 is 2.0.0."""
    numbers = [int(part) for part in re.findall(r"^\d+(?:\.\d+)*", text)[0].split(".")]
    while numbers and not numbers[-1]:
        numbers.pop()
    return numbers


@pytest.mark.parametrize("dependency", DEPENDENCIES)
def test_the_lowest_version_is_here(dependency: str) -> None:
    name, _, bound = dependency.partition(">=")
    assert release(version(name)) == release(bound)


@pytest.mark.parametrize("name", MECHANISMS)
def test_each_mechanism_is_built(name: str, tmp_path: Path) -> None:
    kinds = set(ANY_KIND) - {"servo", "mjcf"} if name == EVERYTHING else {"dxf", "stl"}
    report = build(TOP / "specs" / f"{name}.toml", tmp_path, frozenset(kinds))
    endings = {"report": "html", "plots": "png", **RENDERED}
    assert report.ok and {path.suffix for path in (tmp_path / name).iterdir()} >= {
        f".{endings.get(kind, kind)}" for kind in kinds
    }
