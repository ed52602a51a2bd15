"""Caps: no lower than the outline asks, between the same points, whatever way they were made."""

import numpy as np
import pytest
from test_solids import cam, edge_balance, hub

from camgen.geometry.mesh import Mesh
from camgen.geometry.outlines import Region, circle, rectangle
from camgen.machines.sources import read_mechanism
from camgen.parts import caps
from camgen.parts.part import Layer, Part
from camgen.parts.solids import solid

TOLERANCE = 1e-3
LEAST = 1.0  # chord tolerances: the least height of a triangle of a cap; three neighbours on a circle alone give four


def level(mesh):
    corners = mesh.vertices[mesh.faces]
    return np.ptp(corners[:, :, 2], axis=1) == 0


def heights(mesh):
    """Least height of each triangle, mm: twice its area over its longest side."""
    corners = mesh.vertices[mesh.faces]
    longest = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).max(axis=1)
    return np.linalg.norm(mesh.across, axis=1) / longest


@pytest.mark.parametrize("part", [cam(), hub()], ids=lambda part: part.name)
def test_least_height(part, monkeypatch):
    fine = solid(part, TOLERANCE)
    assert heights(fine)[level(fine)].min() > LEAST * TOLERANCE
    monkeypatch.setattr(caps, "_delaunay", caps._earcut)
    rough = solid(part, TOLERANCE)
    assert heights(rough)[level(rough)].min() < LEAST * TOLERANCE / 2  # so the bound can fail
    assert edge_balance(fine) and fine.volume == pytest.approx(rough.volume, rel=1e-12)
    assert np.array_equal(np.unique(fine.vertices, axis=0), np.unique(rough.vertices, axis=0))
    assert len(fine.faces) == len(rough.faces)


@pytest.mark.long
@pytest.mark.parametrize("spec", ["uniform-swing", "eccentric-drive", "disc-cam", "linkage"])
def test_least_height_of_machine_parts(root, spec):
    """The collet apart: two of its circles, nearly equal, are facetted 6e-7 mm apart."""
    mechanism = read_mechanism(root / "specs" / f"{spec}.toml").resolved()
    for part in (part for part in mechanism.assembly.parts if part.name != "collet"):
        mesh = solid(part, mechanism.accuracy.chord_tolerance)
        assert heights(mesh)[level(mesh)].min() > LEAST * mechanism.accuracy.chord_tolerance, (
            part.name
        )


def test_the_same_arrays_again():
    assert np.array_equal(solid(hub(), TOLERANCE).faces, solid(hub(), TOLERANCE).faces)


def test_patches_and_islands():
    """A plate with a post on it and a pocket in it: each level face stays, with its holes."""
    plate, post = (
        Layer(Region(rectangle(-10 - 10j, 10 + 10j), (circle(5, 2),)), 0, 2),
        Layer(Region(circle(-5, 2)), 2, 4),
    )
    part = Part(
        "p", "P", (plate, post), engraved=(Layer(Region(circle(0, 2), (circle(0, 1),)), 1.5, 2),)
    )
    mesh = solid(part, TOLERANCE)
    looks = mesh.across[:, 2] / 2
    for z, area in ((2.0, 400 - np.pi * (4 + 4 + 4 - 1)), (1.5, 3 * np.pi), (4.0, 4 * np.pi)):
        here = level(mesh) & (mesh.vertices[mesh.faces[:, 0], 2] == z) & (looks > 0)
        assert looks[here].sum() == pytest.approx(area, abs=0.05)


def test_a_patch_with_a_point_inside_stays():
    """Its outline does not say all of it."""
    vertices = np.array([[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0], [1, 1, 0]], float)
    faces = np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [0, 4, 3]])
    assert sorted(caps.recap(Mesh(vertices, faces)).faces.tolist()) == sorted(faces.tolist())
