"""The GLB as others read it: trimesh, and the format's own rules."""

from __future__ import annotations

import io
import json
import math
import struct
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from camgen.errors import FileError
from camgen.files.gltf import SECONDS, Shape, Track, glb, read_glb, upright
from camgen.geometry.mesh import Mesh, placing


def box(x: float, y: float, z: float) -> Mesh:
    made = trimesh.creation.box(extents=(x, y, z))
    return Mesh(np.asarray(made.vertices) + np.array([x, y, z]) / 2, np.asarray(made.faces))


THETA = np.linspace(0, 2 * np.pi, 360, endpoint=False)
PLACE = 5 * np.exp(1j * THETA) + 40
BODIES = [
    Track("ground", np.zeros(360), np.zeros(360, complex), [("base-1", 0, np.eye(3, 4))]),
    Track(
        "crank",
        THETA,
        np.zeros(360, complex),
        [("arm-1", 1, placing(0.5, 3 + 2j, 7.0, 4.0)), ("arm-2", 1, placing(0, 1j, 0, 4.0, True))],
    ),
    Track("slider", np.zeros(360), PLACE, [("base-2", 0, placing(0.0, 0j, 10.0, 3.0))]),
]
SWING = Track("swing", 0.4 * np.sin(THETA) + 0.2, PLACE, [("arm-3", 1, np.eye(3, 4))], True)
SHAPES = [Shape("base", box(30, 20, 3), "#0b62a8"), Shape("arm", box(12, 5, 4), "#ffffff")]


@pytest.fixture(scope="module")
def data() -> bytes:
    return glb("demo", SHAPES, BODIES)


def chunks(data: bytes) -> tuple[dict, bytes]:
    magic, version, size, length, kind = struct.unpack_from("<4sIII4s", data)
    assert (magic, version, size, kind) == (b"glTF", 2, len(data), b"JSON")
    more, name = struct.unpack_from("<I4s", data, 20 + length)
    assert name == b"BIN\0" and 28 + length + more == len(data) and length % 4 == more % 4 == 0
    return json.loads(data[20 : 20 + length]), data[28 + length :]


def values(data: bytes, number: int) -> np.ndarray:
    file, binary = chunks(data)
    accessor = file["accessors"][number]
    view = file["bufferViews"][accessor["bufferView"]]
    assert view["byteOffset"] % 4 == 0
    wide = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[accessor["type"]]
    dtype = {5126: "<f4", 5123: "<u2", 5125: "<u4"}[accessor["componentType"]]
    found = np.frombuffer(binary, dtype, accessor["count"] * wide, view["byteOffset"])
    return found.reshape(-1, wide)


def test_trimesh_finds_every_copy_where_it_belongs_in_metres_with_y_up(data: bytes) -> None:
    scene = trimesh.load(io.BytesIO(data), file_type="glb")
    assert sorted(scene.graph.nodes_geometry) == ["arm-1", "arm-2", "base-1", "base-2"]
    up = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]]) / 1000  # (x, y, z) mm to (x, z, -y) m
    for body in BODIES:
        for copy, shape, transform in body.copies:
            matrix, geometry = scene.graph[copy]
            mesh = SHAPES[shape].mesh.moved(transform)
            turn = (
                np.exp(1j * body.angle[0]) * (mesh.vertices[:, 0] + 1j * mesh.vertices[:, 1])
                + body.place[0]
            )
            wanted = np.column_stack([turn.real, turn.imag, mesh.vertices[:, 2]]) @ up.T
            there = trimesh.transform_points(scene.geometry[geometry].vertices, matrix)
            order, other = (np.lexsort(np.round(rows, 6).T) for rows in (there, wanted))
            np.testing.assert_allclose(there[order], wanted[other], atol=1e-8)
    assert all(mesh.is_watertight and mesh.volume > 0 for mesh in scene.geometry.values())


def test_a_body_whose_plane_stands_is_read_back_and_found_by_trimesh(tmp_path: Path) -> None:
    """x of its plane is -y of the machine, y is z and z is -x."""
    path = tmp_path / "a.glb"
    path.write_bytes(glb("demo", SHAPES, [*BODIES, SWING]))
    course = read_glb(path)[-1]
    assert course.standing and not any(each.standing for each in read_glb(path)[:-1])
    np.testing.assert_allclose(course.angle[:-1], SWING.angle, atol=1e-6)
    np.testing.assert_allclose(course.place[:-1], PLACE, atol=1e-5)
    matrix, _ = trimesh.load(path).graph["arm-3"]
    turned = complex(3, 4) * np.exp(0.2j) + PLACE[0]
    there = matrix @ (3, 4, 5, 1)
    wanted = (-5, turned.imag, turned.real)  # (-5, -x, y) in the machine; glTF has (x, z, -y)
    np.testing.assert_allclose(1000 * there[:3], wanted, atol=1e-5)


def test_one_turn_is_the_animation_and_only_what_moves_is_in_it(data: bytes) -> None:
    file, _ = chunks(data)
    (turn,) = file["animations"]
    names = {
        file["nodes"][c["target"]["node"]]["name"] + " " + c["target"]["path"]
        for c in turn["channels"]
    }
    assert names == {"crank rotation", "slider translation"}
    rotation, translation = (values(data, s["output"]) for s in turn["samplers"])
    time = values(data, turn["samplers"][0]["input"])[:, 0]
    assert time[0] == 0 and time[-1] == SECONDS and np.all(np.diff(time) > 0) and len(time) == 361
    assert file["accessors"][turn["samplers"][0]["input"]]["max"] == [SECONDS]
    np.testing.assert_allclose(np.linalg.norm(rotation, axis=1), 1, atol=1e-6)
    assert np.all((rotation[1:] * rotation[:-1]).sum(axis=1) > 0.99), (
        "consecutive quaternions on one side"
    )
    turned = 2 * np.unwrap(np.arctan2(rotation[:, 2], rotation[:, 3]), period=2 * np.pi)
    np.testing.assert_allclose(turned, np.linspace(0, 2 * math.pi, 361), atol=1e-5)
    np.testing.assert_allclose(translation[:-1, 0] + 1j * translation[:-1, 1], PLACE, atol=1e-5)
    np.testing.assert_array_equal(translation[0], translation[-1])


def test_bounds_indices_and_the_root_are_as_the_format_asks(data: bytes) -> None:
    file, _ = chunks(data)
    root = file["nodes"][file["scenes"][0]["nodes"][0]]
    assert root["scale"] == [0.001] * 3 and np.allclose(
        root["rotation"], [-math.sqrt(0.5), 0, 0, math.sqrt(0.5)]
    )
    for mesh in file["meshes"]:
        (primitive,) = mesh["primitives"]
        assert list(primitive["attributes"]) == ["POSITION"], "without normals faces are flat"
        points, corners = (
            values(data, n) for n in (primitive["attributes"]["POSITION"], primitive["indices"])
        )
        accessor = file["accessors"][primitive["attributes"]["POSITION"]]
        assert (
            accessor["min"] == points.min(0).tolist() and accessor["max"] == points.max(0).tolist()
        )
        assert corners.max() < len(points)
    blue, white = (
        material["pbrMetallicRoughness"]["baseColorFactor"] for material in file["materials"]
    )
    assert white == [1, 1, 1, 1] and blue[2] == pytest.approx(0.39157, abs=1e-5)


def test_same_machine_same_bytes_and_one_at_rest_has_no_animation(data: bytes) -> None:
    assert glb("demo", SHAPES, BODIES) == data
    assert "animations" not in chunks(glb("demo", SHAPES[:1], BODIES[:1]))[0]


def test_a_body_waits_where_the_machine_cannot_go() -> None:
    angle = np.where((THETA > 1) & (THETA < 2), np.nan, THETA)
    data = glb(
        "demo",
        SHAPES,
        [Track("crank", angle, np.zeros(360, complex), [("arm-1", 1, np.eye(3, 4))])],
    )
    file, _ = chunks(data)
    rotation = values(data, file["animations"][0]["samplers"][0]["output"])
    waits = np.flatnonzero((THETA > 1) & (THETA < 2))
    assert np.isfinite(rotation).all() and np.all(rotation[waits] == rotation[waits[0] - 1])


def turned(quaternion: list[float], vector: list[float]) -> np.ndarray:
    """v + 2 u x (u x v + w v) of a unit quaternion (u, w)."""
    axis, w = np.array(quaternion[:3]), quaternion[3]
    v = np.array(vector, float)
    return v + 2 * np.cross(axis, np.cross(axis, v) + w * v)


@given(st.floats(0, math.tau))
def test_what_is_up_becomes_y_and_the_front_z(angle: float) -> None:
    down = [math.cos(angle), math.sin(angle), 0.0]
    standing = upright((down[0], down[1], down[2]))
    assert turned(standing, down) == pytest.approx([0, -1, 0], abs=1e-12)
    assert turned(standing, [0, 0, 1]) == pytest.approx([0, 0, 1], abs=1e-12)
    lying = upright((0.0, 0.0, -1.0))
    assert turned(lying, [0, 0, -1]) == pytest.approx([0, -1, 0], abs=1e-12)
    assert turned(lying, [0, -1, 0]) == pytest.approx([0, 0, 1], abs=1e-12)


def test_a_machine_that_stands_up_is_no_file_of_one_that_lies(tmp_path: Path) -> None:
    (path := tmp_path / "a.glb").write_bytes(glb("demo", SHAPES, BODIES, 1, (0.0, -1.0, 0.0)))
    assert len(read_glb(path, (0.0, -1.0, 0.0))) == len(BODIES)
    with pytest.raises(FileError, match="the whole is turned"):
        read_glb(path)


# ---- read back -------------------------------------------------------------------------------------------------------


def test_bodies_come_back_as_they_move(data: bytes, tmp_path: Path) -> None:
    (path := tmp_path / "a.glb").write_bytes(data)
    found = read_glb(path)
    assert [course.name for course in found] == ["ground", "crank", "slider"]
    assert [[copy[:2] for copy in course.copies] for course in found] == [
        [("base-1", "base")],
        [("arm-1", "arm"), ("arm-2", "arm")],
        [("base-2", "base")],
    ]
    for course, body in zip(found, BODIES, strict=True):
        count = len(course.angle)
        assert count == (1 if body.name == "ground" else 361)
        assert (
            np.abs(np.exp(1j * course.angle) - np.exp(1j * np.resize(body.angle, count))).max()
            < 1e-6
        )
        assert np.abs(course.place - np.resize(body.place, count)).max() < 1e-5
        for (_, _, there), (_, _, meant) in zip(course.copies, body.copies, strict=True):
            assert np.abs(there - meant).max() < 1e-8
    assert found[1].seconds[-1] == SECONDS and np.allclose(
        np.diff(found[1].seconds), SECONDS / 360, rtol=1e-4
    )


STRANGE = [
    lambda whole: whole["nodes"][1].update(scale=[1, 1, 1]),
    lambda whole: whole["nodes"][1].update(mesh=0),
    lambda whole: whole["nodes"][0].update(translation=[0, 0, 1]),
    lambda whole: whole["nodes"][0].update(scale=[1, 1, 1]),
    lambda whole: whole["nodes"][2].update(extensions={}),
    lambda whole: whole.update(skins=[]),
    lambda whole: whole.update(extensionsUsed=["KHR_node_visibility"]),
    lambda whole: whole["scenes"][0]["nodes"].append(1),
    lambda whole: whole["animations"][0]["samplers"][0].update(interpolation="STEP"),
    lambda whole: whole["nodes"][1].update(name=5),
    lambda whole: whole["animations"].append(whole["animations"][0]),
    lambda whole: whole["nodes"].append({"name": "x"}),
    lambda whole: whole["accessors"][-1].update(sparse={}),
    lambda whole: whole["accessors"][-1].update(count=3),
    lambda whole: whole["bufferViews"][-1].update(byteStride=20),
    lambda whole: whole["nodes"][3].update(rotation=[0, 0, 1, 0]),
]


@pytest.mark.parametrize("number", range(len(STRANGE)))
def test_what_could_move_scale_or_hide_something_is_refused(
    data: bytes, tmp_path: Path, number: int
) -> None:
    whole, rest = chunks(data)
    STRANGE[number](whole)
    text = json.dumps(whole).encode()
    text += b" " * (-len(text) % 4)
    head = struct.pack("<4sIII4s", b"glTF", 2, 28 + len(text) + len(rest), len(text), b"JSON")
    (path := tmp_path / "a.glb").write_bytes(
        head + text + struct.pack("<I4s", len(rest), b"BIN\0") + rest
    )
    with pytest.raises(FileError, match="not a machine in GLB as camgen writes it"):
        read_glb(path)


@given(draw=st.data())
def test_any_bytes_are_read_or_refused(
    data: bytes, tmp_path_factory: pytest.TempPathFactory, draw: st.DataObject
) -> None:
    path = tmp_path_factory.getbasetemp() / "any.glb"
    damaged = bytearray(data)
    for _ in range(draw.draw(st.integers(1, 4))):
        damaged[draw.draw(st.integers(0, 4000))] = draw.draw(
            st.sampled_from(b'0159-.,:"[]{}eE\x00\xff')
        )
    path.write_bytes(
        bytes(damaged[: draw.draw(st.integers(0, len(damaged)))])
        if draw.draw(st.booleans())
        else bytes(damaged)
    )
    with suppress(FileError):
        read_glb(path)


def test_a_file_without_a_header_is_told_as_cut_short(tmp_path: Path) -> None:
    path = tmp_path / "short.glb"
    path.write_bytes(b"glTF")
    with pytest.raises(FileError, match="it is cut short: 4 bytes"):
        read_glb(path)
