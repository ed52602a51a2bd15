"""Where the files of a large machine lie: by what a person does with them.

print      plates, parts as STL and 3MF
laser      sheets to cut
drawings   dimensioned drawings
cad        outlines and paths to cut, exact solids, the assembly, tables for servo drives
the top    report, lists, texts, curves, spec and manifest
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from pathlib import Path

MOST_FLAT = 20  # files
_SHELVES = (
    (
        "cad",
        re.compile(r".*-assembly\.(3mf|glb|step)|.*-(path|profile|servo)\.csv|.*\.st|.*-grbl\.nc"),
    ),
    ("drawings", re.compile(r".*-drawing\.(pdf|dxf)")),
    ("laser", re.compile(r".*-sheet-\d+\.(dxf|svg)")),
    ("print", re.compile(r".*\.(stl|3mf)")),
    ("cad", re.compile(r".*\.(dxf|step)")),
)
NAMES = ("print", "laser", "drawings", "cad")


def shelf(name: str) -> str:
    """The folder in which a file of this name lies where there are many; "" for one that stays at the top."""
    return next((shelf for shelf, names in _SHELVES if names.fullmatch(name)), "")


def located(path: Path) -> Path:
    """A file of a build where it lies, on its shelf or flat; a stray copy beside the shelves does not count."""
    shelved = path.parent / shelf(path.name) / path.name
    return shelved if shelved.exists() else path


def shelved(folder: Path, pattern: str = "*") -> list[Path]:
    """Files on the shelves of a build, by a pattern of their names."""
    return [path for name in NAMES for path in sorted((folder / name).glob(pattern))]


def listed(folder: Path, pattern: str) -> list[Path]:
    """Files of a build by a pattern of their names, wherever they lie: shorter names first, then by the alphabet."""
    found = [*folder.glob(pattern), *shelved(folder, pattern)]
    return sorted(found, key=lambda path: (len(path.name), path.name))


def put_away(folder: Path, names: Iterable[str]) -> None:
    """Move the files of a build onto their shelves where it has many; names: of those that are still to come to the top."""
    files = [path for path in folder.iterdir() if path.is_file()]
    if len(files) + len({*names} - {path.name for path in files}) <= MOST_FLAT:
        return
    for path in files:
        if name := shelf(path.name):
            (folder / name).mkdir(exist_ok=True)
            os.replace(path, folder / name / path.name)
