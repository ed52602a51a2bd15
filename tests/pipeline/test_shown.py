"""What the report shows in three dimensions is the machine: its copies, where the assembly has them, as they move."""

from __future__ import annotations

import io
import json
import struct
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
import trimesh

from camgen.parts.assembly import order_of_assembly
from camgen.pipeline import build as pipeline
from camgen.pipeline.making import assembly_copies
from camgen.pipeline.shown import animation, scene

SPECS = Path(__file__).resolve().parents[2] / "specs"
UP = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]]) / 1000  # (x, y, z) mm to (x, z, -y) m


@pytest.mark.parametrize(
    "name", ["coupon", "uniform-swing"]
)  # the others with their heights, in test_pipeline
def test_the_steps_of_assembly_lay_on_every_copy_once(name: str) -> None:
    machine = pipeline.read_mechanism(SPECS / f"{name}.toml").resolved()
    table, counts = (
        order_of_assembly(machine.assembly),
        Counter(mount.part for mount in machine.assembly.mounts),
    )
    every = {f"{part}-{k + 1}": part for part, count in counts.items() for k in range(count)}
    assert len(table.steps) == len(table.rows)
    laid = Counter(copy for step in table.steps for copy in step.copies)
    assert laid == Counter(list(every)), "each once"
    assert {copy for step in table.steps for copy in step.copies} <= {*every}


@pytest.mark.parametrize("name", ["uniform-swing", "quick-return", "eccentric-drive"])
def test_the_glb_is_the_assembly_and_moves_as_it_does(name: str) -> None:
    machine = pipeline.read_mechanism(SPECS / f"{name}.toml").resolved()
    seen = scene(machine, [])
    shown = trimesh.load(io.BytesIO(seen.glb), file_type="glb")
    assert sorted(shown.graph.nodes_geometry) == sorted(seen.copies)
    for copy in assembly_copies(machine):
        matrix, geometry = shown.graph[copy.name]
        wanted = np.column_stack([UP @ copy.transform[:, :3], UP @ copy.transform[:, 3]])
        np.testing.assert_allclose(matrix[:3], wanted, atol=1e-9)
        assert geometry == copy.object
    for part in machine.assembly.parts:
        if part.name in shown.geometry:
            mesh = shown.geometry[part.name]
            assert (
                mesh.is_watertight
                and abs(mesh.volume * 1.0 - part.volume) <= 0.02 * part.walls + 1e-6 * part.volume
            )
    # a quarter of a turn, read from the file's own animation
    size = struct.unpack_from("<I", seen.glb, 12)[0]
    file = json.loads(seen.glb[20 : 20 + size])
    poses = machine.assembly.courses(np.array([np.pi / 2]))
    moved = 0
    for channel in file["animations"][0]["channels"]:
        node, sampler = (
            file["nodes"][channel["target"]["node"]],
            file["animations"][0]["samplers"][channel["sampler"]],
        )
        accessor = file["accessors"][sampler["output"]]
        wide = {"VEC3": 3, "VEC4": 4}[accessor["type"]]
        start = 28 + size + file["bufferViews"][accessor["bufferView"]]["byteOffset"]
        values = np.frombuffer(seen.glb, "<f4", accessor["count"] * wide, start).reshape(-1, wide)[
            (accessor["count"] - 1) // 4
        ]
        pose = poses[node["name"]]
        if wide == 4:
            turn = 2 * np.arctan2(values[2], values[3])
            assert abs(np.exp(1j * turn) - np.exp(1j * float(pose.angle[0]))) < 1e-5
        else:
            assert abs(complex(values[0], values[1]) - complex(pose.place[0])) < 1e-4
        moved += 1
    assert moved >= 2


def test_holes_have_the_names_of_the_drawing_and_lie_where_they_are() -> None:
    machine = pipeline.read_mechanism(SPECS / "quick-return.toml").resolved()
    labels = dict(zip(machine.assembly.parts, scene(machine, []).holes, strict=True))
    crank = next(part for part in labels if part.name == "crank")
    points = dict(crank.points)
    assert set(points) <= {hole.label for hole in labels[crank]}
    for hole in labels[crank]:
        x, y, z = hole.place
        assert 0 < z < crank.thickness
        if hole.label in points:
            assert complex(x, y) == pytest.approx(points[hole.label], abs=1e-6)


def test_paths_lie_among_their_body_and_followers_of_cams_alone_as_high_as_the_cam() -> None:
    machine = pipeline.read_mechanism(SPECS / "walking-leg.toml").resolved()
    (path,) = [body for body in animation(machine).bodies if body.heights]
    foot = next(mount for mount in machine.assembly.mounts if mount.part == "foot")
    thick = next(part.thickness for part in machine.assembly.parts if part.name == "foot")
    assert path.heights is not None and path.heights[0] == path.heights[1]
    assert foot.z < path.heights[0] < foot.z + thick
    cam = pipeline.read_mechanism(SPECS / "disc-cam.toml").resolved()
    follower, _ = [body.heights for body in animation(cam).bodies if body.heights]
    assert follower == (0, cam.assembly.parts[0].drawn.z1)


def test_curves_tell_first_what_each_output_does_then_how_fast(tmp_path: Path) -> None:
    """Two wings of one bird: neither tip waits behind the speed and the play of the other."""
    wings = pipeline.build(SPECS / "gallery" / "flapping-bird.toml", tmp_path, frozenset({"dxf"}))
    first = [plot.title for plot in wings.plots]
    assert first[:4] == ["Left_tip", "Right_tip", "Left_tip: speed", "Right_tip: speed"]
