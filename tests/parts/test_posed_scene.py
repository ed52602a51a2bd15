"""`machine.scene(theta)`: solids of all bodies, where the model has them, under the names of the GLB."""

from __future__ import annotations

import io
import math
import tomllib
from pathlib import Path

import numpy as np
import pytest
import trimesh

import camgen
from camgen.pipeline import shown
from camgen.pipeline.making import assembly_copies

SPECS = Path(__file__).resolve().parents[2] / "specs"
NAMES = ["linkage", "disc-cam", "uniform-swing", "gallery/scotch-yoke"]


@pytest.mark.long
@pytest.mark.parametrize("name", NAMES)
def test_every_copy_stands_where_its_body_is_and_is_its_part(name: str) -> None:
    machine = camgen.load(SPECS / f"{name}.toml")
    scenes = {theta: machine.scene(theta) for theta in (0.0, 2.0)}
    for theta, scene in scenes.items():
        poses = machine.assembly.poses(np.array([theta]))
        copies = {f"{part}-{k + 1}" for part, each in poses.items() for k in range(len(each))}
        assert set(scene.graph.nodes_geometry) == copies and scene.units == "mm"
        for part, each in poses.items():
            thickness = machine.assembly.by_name[part].thickness
            for k, pose in enumerate(each):
                matrix, geometry = scene.graph[f"{part}-{k + 1}"]
                at, turn = complex(pose.place[0]), np.exp(1j * float(pose.angle[0]))
                # the part's point (3, 4, 5), carried by hand
                x, y, z = (-3, 4, thickness - 5) if pose.flipped else (3, 4, 5)
                there = at + turn * complex(x, y)
                wanted = (there.real, there.imag, pose.z + z)
                assert matrix @ [3, 4, 5, 1] == pytest.approx((*wanted, 1), abs=1e-9)
                assert geometry == part
    for part in machine.assembly.parts:
        mesh = scene.geometry[part.name]
        slack = part.walls * machine.accuracy.chord_tolerance + 1e-6 * part.volume
        assert mesh.is_watertight and abs(mesh.volume - part.volume) <= slack
    for copy in assembly_copies(machine):  # as the assembly's file has them
        matrix, _ = scenes[0.0].graph[copy.name]
        assert matrix[:3] == pytest.approx(copy.transform, abs=1e-9)


def test_it_is_the_tree_of_the_glb() -> None:
    machine = camgen.load(SPECS / "linkage.toml")
    theirs = trimesh.load(io.BytesIO(shown.scene(machine, []).glb), file_type="glb")
    ours = machine.scene(0.0)
    assert set(ours.graph.nodes) - {"world"} == set(theirs.graph.nodes) - {"world", machine.name}
    bodies = [body.name for body in machine.model.moving]
    for copy in ours.graph.nodes_geometry:
        parents = [each.graph.transforms.parents[copy] for each in (ours, theirs)]
        assert parents[0] == parents[1] and parents[0] in ("ground", *bodies)


def test_a_drive_to_and_fro_takes_its_own_angle() -> None:
    tables = tomllib.loads((SPECS / "linkage.toml").read_text(encoding="utf-8"))
    tables["drive"]["range_deg"] = [-40, 70]
    machine = camgen.load(tables)
    for theta in (-0.5, 1.0):
        pose = machine.solve(theta).pose("rocker")
        matrix, _ = machine.scene(theta).graph["rocker"]
        assert math.atan2(matrix[1, 0], matrix[0, 0]) == pytest.approx(
            (float(pose.angle[0]) + math.pi) % math.tau - math.pi
        )
        assert complex(*matrix[:2, 3]) == pytest.approx(complex(pose.place[0]))


def test_where_nothing_closes_it_says_so() -> None:
    tables = tomllib.loads((SPECS / "linkage.toml").read_text(encoding="utf-8"))
    tables["drive"]["range_deg"] = [-40, 70]
    tables["lengths"]["O-A"] = (
        45  # straight out to the left it is 115 from C, of 110 that coupler and rocker reach
    )
    machine = camgen.load(tables)
    closes = np.isfinite(machine.solve(theta := np.linspace(0, 6, 61)).pose("rocker").angle)
    assert closes.any() and not closes.all()
    machine.scene(theta[closes][0])
    with pytest.raises(camgen.DesignError, match="does not close at drive angle"):
        machine.scene(theta[~closes][0])
