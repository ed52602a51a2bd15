"""Meshes of one part as other programs write them: OBJ, PLY, OFF and GLB, their units and axes, and files that are wrong."""

from __future__ import annotations

import json
import math
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from camgen.errors import FileError
from camgen.geometry.mesh import mesh_faults
from camgen.measuring import meshes
from camgen.measuring.meshes import read_mesh
from camgen.measuring.outlines import Hints, read_outline

# a box of 10 x 20 x 30 mm, its corners by hand
CORNERS = [(x, y, z) for x in (0, 10) for y in (0, 20) for z in (0, 30)]
SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
TRIANGLES = [(a, *pair) for a, b, c, d in SIDES for pair in ((b, c), (c, d))]


def obj(faces: list[tuple[int, ...]] = SIDES, index: Callable[[int], int] = lambda k: k + 1) -> str:
    rows = [f"v {x} {y} {z}" for x, y, z in CORNERS] + ["vn 0 0 1", "usemtl steel"]
    rows += ["f " + " ".join(f"{index(k)}//1" for k in face) for face in faces]
    return "# a box\nmtllib box.mtl\no box\n" + "\n".join(rows) + "\n"


def ply() -> str:
    head = "ply\nformat ascii 1.0\ncomment a box\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
    head += "element face 6\nproperty list uchar int vertex_indices\nend_header\n"
    rows = [f"{x} {y} {z}" for x, y, z in CORNERS]
    return head + "\n".join(rows + [" ".join(map(str, (4, *face))) for face in SIDES]) + "\n"


def off() -> str:
    rows = [f"{x} {y} {z}" for x, y, z in CORNERS]
    rows += [" ".join(map(str, (3, *face))) for face in TRIANGLES]
    return "OFF\n# a box\n8 12 0\n" + "\n".join(rows) + "\n"


def glb(change: Callable[[dict[str, Any]], object] = lambda whole: None) -> bytes:
    """The box as glTF has it: metres, y up, so that its z = 30 mm is y = 0.03 m; its node stands 1 m to the left of a node there."""
    points = np.array([(x, z, -y) for x, y, z in CORNERS], "<f4") / np.float32(1000)
    faces = np.array(TRIANGLES, "<u2")
    data = points.tobytes() + faces.tobytes()
    whole: dict[str, Any] = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [
            {"name": "root", "translation": [1, 0, 0], "children": [1]},
            {"name": "box", "mesh": 0, "translation": [-1, 0, 0]},
        ],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 96},
            {"buffer": 0, "byteOffset": 96, "byteLength": 72},
        ],
        "buffers": [{"byteLength": len(data)}],
    }
    change(whole)
    text = json.dumps(whole).encode()
    text += b" " * (-len(text) % 4)
    size = 20 + len(text) + 8 + len(data)
    head = struct.pack("<4sIII4s", b"glTF", 2, size, len(text), b"JSON")
    return head + text + struct.pack("<I4s", len(data), b"BIN\0") + data


def written(path: Path, content: str | bytes) -> Path:
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path


WAYS = {
    "quads.obj": obj(),
    "triangles.obj": obj(TRIANGLES),
    "windows.obj": obj().replace("\n", "\r\n"),
    "backwards.obj": obj(index=lambda k: k - 8),
    "text.ply": ply(),
    "binary.ply": trimesh.Trimesh(CORNERS, TRIANGLES, process=False).export(file_type="ply"),
    "text.off": off(),
    "box.glb": glb(),
}


@pytest.mark.parametrize("name", WAYS)
def test_a_box_is_a_box_however_it_is_written(tmp_path: Path, name: str) -> None:
    held = read_mesh(written(tmp_path / name, WAYS[name]))
    faults = mesh_faults(held.mesh)
    assert (faults.count, faults.bodies) == (0, 1)
    assert faults.volume == pytest.approx(10 * 20 * 30, rel=1e-6)
    assert np.sort(held.mesh.vertices, axis=0)[[0, -1]] == pytest.approx(
        np.array([(0, 0, 0), (10, 20, 30)]), abs=1e-4
    )
    assert ("metres with y up" if name.endswith("glb") else "names no unit") in held.unit
    outline = read_outline(tmp_path / name, Hints(12.0))
    assert outline.ring is not None and outline.ring.box == pytest.approx((0, 0, 10, 20), abs=1e-4)
    assert outline.remark.endswith(held.unit) and all(each.ok for each in outline.findings)


def test_an_open_mesh_is_read_and_told(tmp_path: Path) -> None:
    outline = read_outline(written(tmp_path / "open.obj", obj(SIDES[:-1])))
    assert [each.code for each in outline.findings if not each.ok] == ["WATERTIGHT"]


def changed(**keys: object) -> Callable[[dict[str, Any]], object]:
    return lambda whole: whole.update(keys)


WRONG = {
    "gone.obj": (obj().replace("f 1//1 2", "f 9//1 2"), "line 14: a face names vertex 9; 1 to 8"),
    "zero.obj": (obj().replace("f 1//1 2", "f 0//1 2"), "line 14: a face names vertex 0;"),
    "early.obj": (obj(index=lambda k: k - 8) + "v 0 0 0\n", "line 14: a face names vertex -8;"),
    "number.obj": (obj().replace("v 0 20 0", "v 0 2o 0"), "line 6: '2o' is no number"),
    "nan.obj": (obj().replace("v 0 20 0", "v 0 nan 0"), "line 6: 'nan' is no number"),
    "none.obj": ("# nothing\n", "holds no triangles"),
    "number.ply": (ply().replace("0 20 0", "0 2o 0"), "line 13: '2o' is no number"),
    "short.ply": (ply()[:-20], "cut short: 14 lines of vertices and faces by its header, 12 in"),
    "bytes.ply": (WAYS["binary.ply"][:-3], "is no PLY that can be read: .*unexpected length"),
    "mesh.ply": ("plain\n", "line 1: ply, and a header"),
    "short.off": (off()[:-8], "cut short: 20 lines of vertices and faces by its header, 19 in"),
    "number.off": (off().replace("0 20 0", "0 2o 0"), "line 6: '2o' is no number"),
    "far.off": (off().replace("3 0 1 3", "3 0 1 8"), "is no OFF that can be read: .*index"),
    "none.off": ("8 12 0\n", "line 1: OFF and the numbers"),
    "short.glb": (glb()[:-3], "its header says [0-9]+ bytes, it has"),
    "packed.glb": (glb(changed(extensionsRequired=["KHR_draco_mesh_compression"])), "needs KHR_dr"),
    "away.glb": (glb(changed(buffers=[{"uri": "/etc/passwd"}])), "leads to other files"),
    "bomb.glb": (
        glb(lambda whole: whole["accessors"][0].pop("bufferView")),
        "has values that its bytes do not hold",
    ),
    "many.glb": (
        glb(lambda whole: whole["accessors"][0].update(count=10**12)),
        "has 1,000,000,000,036 values",
    ),
    "lines.glb": (
        glb(lambda whole: whole["meshes"][0]["primitives"][0].update(mode=1)),
        "a mesh of lines or strips",
    ),
    "two.glb": (
        glb(lambda whole: whole["nodes"][0].update(mesh=0)),
        r"holds 2 objects \(root, box\); one part was expected",
    ),
    "list.glb": (glb(changed(nodes=3)), "is no GLB that can be read"),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_is_wrong_is_refused_with_its_place(tmp_path: Path, name: str) -> None:
    content, said = WRONG[name]
    with pytest.raises(FileError, match=said):
        read_mesh(written(tmp_path / name, content))


def test_another_ending_is_told(tmp_path: Path) -> None:
    for name, content, said in (("a.stl", glb(), "GLB"), ("b.obj", ply(), "PLY")):
        with pytest.raises(FileError, match=f"looks like {said}"):
            read_outline(written(tmp_path / name, content))


def test_sizes_have_a_bound(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(meshes, "MOST_TRIANGLES", 11)
    for name in ("quads.obj", "text.ply", "text.off", "box.glb"):
        with pytest.raises(FileError, match="has 12 triangles; at most 11 are read: reduce"):
            read_mesh(written(tmp_path / name, WAYS[name]))
    monkeypatch.setattr(meshes, "_MOST_SAID", 20)
    with pytest.raises(FileError, match="bytes of JSON; at most 20 "):
        read_mesh(tmp_path / "box.glb")


@settings(max_examples=60, deadline=None)
@given(name=st.sampled_from(sorted(WAYS)), data=st.data())
def test_damaged_bytes_are_read_or_refused(
    tmp_path_factory: pytest.TempPathFactory, name: str, data: st.DataObject
) -> None:
    content = WAYS[name]
    content = content.encode() if isinstance(content, str) else bytes(content)
    at = data.draw(st.integers(0, len(content) - 1))
    gone = data.draw(st.integers(0, 20))
    put = data.draw(st.binary(max_size=3))
    path = tmp_path_factory.getbasetemp() / name
    path.write_bytes(content[:at] + put + content[at + gone :])
    try:
        held = read_mesh(path)
    except FileError:
        return
    assert np.isfinite(held.mesh.vertices).all() and not math.isnan(held.mesh.volume)
