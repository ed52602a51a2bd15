"""Meshes: sections and faults of prisms and balls that another program extruded."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from test_rings import regular

from camgen.geometry.mesh import Mesh, mesh_faults, slice_mesh

OUTLINE = regular(300, 30.0) * (1 + 0.2 * np.cos(2 * np.angle(regular(300))))
HOLE = regular(40, 4.0, 2 + 1j)


def prism(outline: np.ndarray, height: float = 6.0, holes: tuple[np.ndarray, ...] = ()) -> Mesh:
    """Prism by trimesh's own extrusion (another route than the project's), float32 as an STL holds it."""
    from shapely import Polygon

    rings = [np.column_stack([z.real, z.imag]) for z in (outline, *holes)]
    solid = trimesh.creation.extrude_polygon(Polygon(rings[0], rings[1:]), height)
    return Mesh(solid.vertices.astype(np.float32).astype(float), np.asarray(solid.faces))


def test_slice_of_a_ball_at_vertices_and_between() -> None:
    """Rings of an icosphere at heights that hit its vertices and at others: closed, about the right area."""
    ball = trimesh.creation.icosphere(4, 10.0)
    mesh = Mesh(np.asarray(ball.vertices), np.asarray(ball.faces))
    for z in (0.0, 1.0, float(mesh.vertices[77, 2]), -9.0):
        (ring,) = slice_mesh(mesh, z)
        assert ring.area == pytest.approx(np.pi * (100 - z * z), rel=0.02)


def test_mesh_faults_are_counted_one_by_one() -> None:
    mesh = prism(OUTLINE, holes=(HOLE,))
    volume = mesh_faults(mesh).volume
    missing = mesh_faults(Mesh(mesh.vertices, mesh.faces[1:]))
    assert (missing.open_edges, missing.flipped_edges, missing.crowded_edges) == (3, 0, 0)
    flipped = mesh.faces.copy()
    flipped[5] = flipped[5, ::-1]
    assert mesh_faults(Mesh(mesh.vertices, flipped)).flipped_edges == 3
    double = mesh_faults(Mesh(mesh.vertices, np.vstack([mesh.faces, mesh.faces[:1]])))
    assert double.crowded_edges == 3
    inside_out = mesh_faults(Mesh(mesh.vertices, mesh.faces[:, ::-1]))
    assert inside_out.count == 0 and inside_out.volume == pytest.approx(-volume)
    flat = mesh.vertices.copy()
    flat[mesh.faces[0, 0]] = flat[mesh.faces[0, 1]]
    assert mesh_faults(Mesh(flat, mesh.faces)).degenerate > 0
    apart = Mesh(
        np.vstack([mesh.vertices, mesh.vertices + 100]), np.vstack([mesh.faces, mesh.faces + 680])
    )
    assert mesh_faults(apart).bodies == 2


def test_a_section_through_a_hole_in_the_wall_does_not_close() -> None:
    mesh = prism(OUTLINE)
    walls = np.flatnonzero(np.ptp(mesh.vertices[mesh.faces][:, :, 2], axis=1) > 0)
    with pytest.raises(ValueError, match="does not close"):
        slice_mesh(Mesh(mesh.vertices, np.delete(mesh.faces, walls[7], axis=0)), 3.0)
    flipped = mesh.faces.copy()
    flipped[walls[7]] = flipped[walls[7], ::-1]
    with pytest.raises(ValueError, match="does not close"):
        slice_mesh(Mesh(mesh.vertices, flipped), 3.0)
