"""The formats that a part is written in and read back from, one module each, under the endings of their files.

Each module has `write_part(path, job)`; one of solids also `read_part(path, name)`. They are loaded where they are used.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from camgen.geometry.mesh import Mesh
    from camgen.geometry.outlines import Region


@dataclass(frozen=True)
class Format:
    """A format: its module in this package, and whether it holds a solid or else a drawing."""

    module: str
    solid: bool

    @property
    def code(self) -> Any:
        """The module, loaded."""
        return import_module(f"camgen.files.{self.module}")


FORMATS = {"dxf": Format("dxf", False), "stl": Format("stl", True), "3mf": Format("threemf", True)}


@dataclass(frozen=True)
class Job:
    """A part, as a file is to hold it.

    name: of the part; title: of the file; key: what identifiers inside a file are made from.
    region, centres (complex mm): what a drawing shows, within tolerance, mm, as arcs ("bulge") or chords ("lines").
    solid: as it is sent to the printer, None where drawings alone are asked for.
    """

    name: str
    title: str
    key: str
    region: Region
    centres: Sequence[complex]
    tolerance: float
    curves: Literal["bulge", "lines"]
    solid: Mesh | None


def write_part(path: Path, job: Job) -> None:
    """Write a part's file in the format of its ending; an OSError means that it could not be written."""
    FORMATS[path.suffix[1:]].code.write_part(path, job)


def read_solid(path: Path, name: str) -> tuple[Mesh, list[str]]:
    """The solid of the part of this name in a file of a solid, and what is wrong with the file as such.

    FileError where it cannot be read.
    """
    mesh, remarks = FORMATS[path.suffix[1:]].code.read_part(path, name)
    return mesh, remarks
