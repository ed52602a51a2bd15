"""The mesh of one part in a file of any maker, in mm with z up: STL, 3MF, and by trimesh OBJ, PLY, OFF and GLB.

format          unit and axes
STL             none reason: taken as mm, z up
3MF             as its model says
OBJ, PLY, OFF   none reason: taken as mm, z up
GLB             metres, y up [glTF 2.0, 3.4]: turned and scaled
"""

from __future__ import annotations

import io
import json
import logging
import math
import re
import struct
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from camgen.bounds import Bound, read_bytes
from camgen.errors import FileError, counted
from camgen.files.formats import FORMATS
from camgen.files.stl import read_stl
from camgen.files.threemf import read_3mf
from camgen.findings import Finding, in_file
from camgen.geometry.mesh import MOST_TRIANGLES, Mesh, weld

_LARGE = 200_000_000  # bytes
_LINES = 6_000_000
_REDUCE = "reduce the mesh, or export it with a larger tolerance"
# those that trimesh reads, by the endings of their files
_SIZES = {
    ".obj": Bound("an OBJ file", _LARGE, most=_LINES, remedy=_REDUCE),
    ".ply": Bound("a PLY file", _LARGE, remedy=_REDUCE),
    ".off": Bound("an OFF file", _LARGE, most=_LINES, remedy=_REDUCE),
    ".glb": Bound("a GLB", _LARGE, remedy=_REDUCE),
}
MESH_SIZES = {**{f".{kind}": FORMATS[kind].size for kind in ("stl", "3mf")}, **_SIZES}
_3MF_UNITS = {
    "micrometer": 1e-3,
    "millimeter": 1.0,
    "centimeter": 10.0,
    "inch": 25.4,
    "foot": 304.8,
    "meter": 1e3,
}
_METRE = 1e3  # mm
_MOST_SAID = 10_000_000  # bytes of JSON in a GLB
_MOST_NODES = 10_000
_TRIANGLES = 4  # mode of a primitive in glTF
_NUMBER = re.compile(rb"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d{1,2})?")
_LISTED = 5  # names of parts in a message


@dataclass(frozen=True, eq=False)
class ForeignMesh:
    """What a file holds."""

    mesh: Mesh  # mm, z up, corners that are equal are one
    findings: tuple[Finding, ...]
    unit: str  # of the file, and how its axes were turned, for people


def read_mesh(path: Path) -> ForeignMesh:
    """The one part in a file that ends in one of MESH_SIZES.

    FileError where the file is larger than its bound, cannot be read or holds no triangles, or several parts.
    """
    kind = path.suffix.lower()
    if kind == ".3mf":
        content = _from_3mf(path)
    elif kind == ".stl":
        content = ForeignMesh(read_stl(path), (), "")
    else:
        content = _by_trimesh(path, kind)
    if not len(content.mesh.faces):
        raise FileError(path, "holds no triangles")
    if not np.isfinite(content.mesh.vertices).all():
        raise FileError(path, "a vertex is not finite")
    return content


def _from_3mf(path: Path) -> ForeignMesh:
    package = read_3mf(path, strict=False)
    if len(package.items) != 1:
        raise FileError(path, f"holds {len(package.items)} objects; one part was expected")
    unit = package.unit.lower()
    scale = _3MF_UNITS.get(unit, math.nan)
    mesh = package.items[0].placed
    units = Finding("MESH_UNITS", scale == 1, scale, 1, "mm", in_file(path), f"its unit is {unit}")
    return ForeignMesh(Mesh(mesh.vertices * scale, mesh.faces), (units,), "")


# ---- by trimesh ------------------------------------------------------------------------------------------------------


def _by_trimesh(path: Path, kind: str) -> ForeignMesh:
    data = read_bytes(path, _SIZES[kind])
    _BEFORE[kind](path, data)
    corners = _corners(path, kind, data)
    if len(corners) > MOST_TRIANGLES:
        reason = f"has {len(corners):,} triangles; at most {MOST_TRIANGLES:,} are read"
        raise FileError(path, f"{reason}: {_REDUCE}")
    if not np.isfinite(corners).all():
        raise FileError(path, _wrong_number(kind, data) or "a vertex is not finite")
    if kind != ".glb":
        return ForeignMesh(weld(corners), (), "it names no unit: taken as millimetres, z up")
    upright = np.stack([corners[..., 0], -corners[..., 2], corners[..., 1]], axis=-1)
    unit = "metres with y up, as glTF has them: multiplied by 1000 and turned to z up"
    return ForeignMesh(weld(_METRE * upright), (), unit)


def _corners(path: Path, kind: str, data: bytes) -> Any:
    """Corners of all triangles as the file has them, (m, 3, 3)."""
    import trimesh

    logging.getLogger("trimesh").addHandler(logging.NullHandler())  # else it prints
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # numpy only warns of a number that is none
            content = trimesh.load(
                io.BytesIO(data), file_type=kind[1:], process=False, skip_materials=True
            )
            geometries = content.dump() if isinstance(content, trimesh.Scene) else [content]
            meshes = [each for each in geometries if isinstance(each, trimesh.Trimesh)]
            triangles = [np.asarray(each.vertices, float)[each.faces] for each in meshes]
            corners = np.concatenate([np.zeros((0, 3, 3)), *triangles])
    except Exception as error:  # a reader of formats fails in any way on bytes that are none
        reason = _wrong_number(kind, data) or " ".join(str(error).split())[:200]
        name = f"is no {kind[1:].upper()} that can be read"
        raise FileError(path, f"{name}: {reason or type(error).__name__}") from None
    return corners


def _wrong_number(kind: str, data: bytes) -> str:
    """The first line of a text without a finite number where there should be one; "" of what is no text."""
    if kind == ".glb" or b"format binary" in data[:1000]:
        return ""
    head = {".ply": b"end_header", ".off": b"OFF", ".obj": b""}[kind]
    first = data[: data.find(head) + len(head)].count(b"\n")
    for number, line in enumerate(data.split(b"\n")[first:], first + 1):
        words = line.partition(b"#")[0].replace(b"/", b" ").split()
        if kind == ".obj":
            words = words[1:4] if words[:1] == [b"v"] else []
        for word in words:
            if word != head and not _NUMBER.fullmatch(word):
                text = word[:20].decode("ascii", "replace")
                return f"line {number}: '{text}' is no number"
    return ""


def _obj(path: Path, data: bytes) -> None:
    """FileError, with the line, where a face names a vertex that is not there, or that trimesh takes for another one.

    Of a number below 0, which counts back from the last vertex before the face, it counts back from the last one of the file.
    """
    lines = data.split(b"\n")
    total = sum(line.split()[:1] == [b"v"] for line in lines)
    before = 0
    for number, line in enumerate(lines, 1):
        words = line.split()
        before += words[:1] == [b"v"]
        for word in words[1:] if words[:1] == [b"f"] else ():
            index = word.partition(b"/")[0]
            valid = re.fullmatch(rb"-?[1-9]\d{0,9}", index) and abs(int(index)) <= total
            if valid and (before == total or not index.startswith(b"-")) or word == b"\\":
                continue
            reason = f"line {number}: a face names vertex {index.decode('ascii', 'replace')}"
            raise FileError(path, f"{reason}; 1 to {total} were expected")


def _off(path: Path, data: bytes) -> None:
    """FileError where a file does not begin as an OFF does, or has not the lines that it counts."""
    bare = re.sub(rb"#[^\n]*", b"", data)
    head = re.match(rb"\s*C?OFF\s+(\d+)\s+(\d+)[^\n]*", bare)
    if head is None:
        raise FileError(path, "line 1: OFF and the numbers of vertices and faces were expected")
    _count(path, int(head[1]) + int(head[2]), bare[head.end() :])


def _ply(path: Path, data: bytes) -> None:
    """FileError where the header of a PLY does not end, or a text has not the lines that it counts."""
    head, end, rest = data.partition(b"end_header")
    if not head.startswith(b"ply") or not end:
        raise FileError(path, "line 1: ply, and a header that ends in end_header, were expected")
    if b"format ascii" in head:
        counts = re.findall(rb"^element\s+\S+\s+(\d+)\s*$", head, re.MULTILINE)
        _count(path, sum(map(int, counts)), rest)


def _count(path: Path, limit: int, body: bytes) -> None:
    """FileError where a text has fewer lines than its header says."""
    count = sum(not line.isspace() and bool(line) for line in body.split(b"\n"))
    if count < limit:
        reason = f"{counted(limit, 'line')} of vertices and faces by its header"
        raise FileError(path, f"cut short: {reason}, {count} in the file")


def _glb(path: Path, data: bytes) -> None:
    """FileError of a GLB that holds not one part, or more than its bytes, or leads to other files."""
    try:
        mark, version, size, length, kind = struct.unpack_from("<4sIII4s", data)
        if (mark, version, size, kind) != (b"glTF", 2, len(data), b"JSON"):
            raise ValueError(f"its header says {size} bytes, it has {len(data)}")
        if length > _MOST_SAID:
            raise ValueError(f"{length:,} bytes of JSON; at most {_MOST_SAID:,} are read")
        whole = json.loads(data[20 : 20 + length])
        needed = [
            each
            for each in whole.get("extensionsRequired", [])
            if not each.startswith(("KHR_materials_", "KHR_texture_"))
        ]
        nodes = whole.get("nodes", [])
        parts = [node for node in nodes if "mesh" in node]
        points = sum(each["count"] for each in whole.get("accessors", []))
        refusals = {
            f"needs {', '.join(map(str, needed))}: export it without": needed,
            "leads to other files": any("uri" in each for each in whole.get("buffers", [])),
            "has values that its bytes do not hold": any(
                "bufferView" not in each or "sparse" in each for each in whole.get("accessors", [])
            ),
            f"has {points:,} values: {_REDUCE}": points > 10 * MOST_TRIANGLES,
            f"has {len(nodes):,} nodes; at most {_MOST_NODES:,} are read": len(nodes) > _MOST_NODES,
            "has a mesh of lines or strips: export triangles": any(
                each.get("mode", _TRIANGLES) != _TRIANGLES
                for mesh in whole.get("meshes", [])
                for each in mesh["primitives"]
            ),
        }
    except (ArithmeticError, AttributeError, LookupError, RecursionError) as error:
        raise FileError(path, f"is no GLB that can be read: {type(error).__name__}") from None
    except (TypeError, ValueError, struct.error) as error:
        raise FileError(path, f"is no GLB that can be read: {error}") from None
    for reason, holds in refusals.items():
        if holds:
            raise FileError(path, reason)
    if len(parts) != 1:
        names = ", ".join(str(node.get("name", "?")) for node in parts[:_LISTED])
        more = f" ({names}{', ...' if len(parts) > _LISTED else ''})" if names else ""
        raise FileError(path, f"holds {len(parts)} objects{more}; one part was expected")


_BEFORE: dict[str, Callable[[Path, bytes], None]] = {
    ".obj": _obj,
    ".ply": _ply,
    ".off": _off,
    ".glb": _glb,
}
