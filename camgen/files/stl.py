"""STL: one part's solid in binary, the unit left to convention (mm). What is read may be text as well."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from camgen.bounds import read_bytes
from camgen.errors import FileError
from camgen.files.formats import FORMATS, Job
from camgen.geometry.mesh import MOST_TRIANGLES, Mesh, weld

_ROW = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def write_part(path: Path, job: Job) -> None:
    """Write the part's solid."""
    assert job.solid is not None, "a file of a solid is asked for"
    write_stl(path, job.solid, job.title)


def read_part(path: Path, name: str) -> tuple[Mesh, list[str]]:
    """The part's solid with its stored normals; an STL says nothing that could be wrong with the file as such."""
    return read_stl(path, normals=True), []


def write_stl(path: Path, mesh: Mesh, name: str) -> None:
    """Write a mesh as binary STL whose header names the part (ASCII, cut at 80 bytes)."""
    # Never "solid" at the beginning: readers would take the file for text.
    label = f"camgen {name}".encode("ascii", "replace")[:80]
    rows = np.zeros(len(mesh.faces), _ROW)
    rows["corners"] = mesh.vertices[mesh.faces]
    rows["normal"] = mesh.across / np.linalg.norm(mesh.across, axis=1, keepdims=True)
    for column in ("corners", "normal"):
        rows[column] += np.float32(0)  # which makes 0 of -0
    path.write_bytes(label.ljust(80, b"\0") + np.array(len(rows), "<u4").tobytes() + rows.tobytes())


def read_stl(path: str | Path, normals: bool = False) -> Mesh:
    """Read an STL file, binary or text; FileError with the reason when it is cut short, too long or not finite.

    normals: keep the stored ones, which many programs leave at zero; FileError then where the file is text.
    """
    data = read_bytes(Path(path), FORMATS["stl"].size)
    count = int.from_bytes(data[80:84], "little")
    binary = len(data) >= 84 and len(data) == 84 + 50 * count
    triangles = count if binary else data.count(b"vertex") // 3
    if triangles > MOST_TRIANGLES:
        reason = f"has {triangles:,} triangles; at most {MOST_TRIANGLES:,} are read"
        raise FileError(path, f"{reason}: reduce the mesh, or export it with a larger tolerance")
    if binary:
        rows = np.frombuffer(data, _ROW, offset=84)
        corners = rows["corners"].astype(float)
        stored = rows["normal"].astype(float) if normals else None
    elif data.lstrip().startswith(b"solid") and b"facet" in data[:1000]:
        if normals:
            raise FileError(path, "is an STL in text; a binary one was expected")
        if not re.search(rb"endsolid[^\n]*\s*$", data):
            raise FileError(path, "STL text cut short: it does not end in endsolid")
        words = (
            word
            for place in re.finditer(rb"vertex\s+(\S+)\s+(\S+)\s+(\S+)", data)
            for word in place.groups()
        )
        try:
            corners = np.fromiter(map(float, words), float).reshape(-1, 3, 3)
            stored = None
        except ValueError as error:
            raise FileError(path, f"STL text with a wrong vertex: {error}") from None
    elif len(data) < 84:
        raise FileError(path, f"not an STL file: {len(data)} bytes, the header alone has 84")
    else:
        change = "cut short" if len(data) < 84 + 50 * count else "too long"
        raise FileError(
            path,
            f"{change}: {len(data)} bytes, but a header of {count} triangles needs {84 + 50 * count}",
        )
    if not np.isfinite(corners).all():
        raise FileError(path, "a vertex is not finite")
    mesh = weld(corners)
    return Mesh(mesh.vertices, mesh.faces, stored)
