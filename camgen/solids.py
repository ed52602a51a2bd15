"""From a part to a closed triangle mesh: facetted, extruded, stacked, and checked before anyone sees it.

    ring    (n,) complex, mm, closed without repeating the first point; anticlockwise round material, clockwise round
            a hole; every coordinate is a float32 number, so that the rounding of STL and 3MF changes nothing
    prism   a region between two heights: two caps and a strip of wall per ring, walls exactly upright

A prism keeps the rings' vertices as they are. Only a stack of layers passes through manifold3d's Boolean operations.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from camgen.arcfit import as_circle
from camgen.errors import DesignError
from camgen.outlines import Contour, Floats, Points, Region
from camgen.parts import Layer, Part
from camgen.sampling import facet_circle, facet_contour
from camgen.tolerances import FLOAT32_ROUNDING

Faces = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Mesh:
    """A closed triangle mesh: vertices (n, 3) mm, unique; faces (m, 3) indices, anticlockwise seen from outside."""

    vertices: Floats
    faces: Faces

    @property
    def volume(self) -> float:
        """Signed volume, mm^3; positive when the faces look outwards."""
        a, b, c = np.moveaxis(self.vertices[self.faces], 1, 0)
        return float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6


def solid(part: Part, tolerance: float) -> Mesh:
    """The part as one closed body, in the part's frame; same part, same arrays.

    tolerance: chord tolerance, mm. Outlines are inscribed; full circles round empty space (bores, pockets) are
    circumscribed, so that a pin still fits. A crossed part has no engraving. Raises DesignError where an outline crosses
    itself or another one, or where the layers do not make exactly one body.
    """
    layers = [_prism(layer, tolerance, part.name, pocket=False) for layer in part.layers]
    pockets = [_prism(layer, tolerance, part.name, pocket=True) for layer in part.engraved]
    if part.crossed is not None:
        mesh = _cross(layers, part.crossed, tolerance, part.name)
    else:
        mesh = layers[0] if len(layers) == 1 and not pockets else _combine(layers, pockets)
    _check(mesh, part.name)
    return mesh


def rings(region: Region, tolerance: float, pocket: bool = False) -> list[Points]:
    """Facetted rings of a region, outer first; `pocket`: the region is taken away instead of being material."""
    outer = _ring(region.outer, tolerance, outside=pocket)
    holes = [_ring(hole, tolerance, outside=not pocket)[::-1] for hole in region.holes]
    return [outer, *holes]


def _ring(contour: Contour, tolerance: float, outside: bool) -> Points:
    """Anticlockwise float32-clean ring without repeated points or points in line with their neighbours."""
    round_one = as_circle(contour) if outside else None
    z = facet_circle(*round_one, tolerance, outside=True) if round_one else facet_contour(contour, tolerance)
    z = z.astype(np.complex64).astype(np.complex128) + 0  # + 0 turns -0 into 0
    while True:
        z = np.asarray(z[z != np.roll(z, 1)])
        before, after = z - np.roll(z, 1), np.roll(z, -1) - z
        # Exact: differences of neighbours have under 27 bits, their products fit a float64.
        idle = (np.conj(before) * after).imag == 0
        idle &= ~np.roll(idle, 1)
        if not idle.any() or len(z) <= 3:
            break
        z = z[~idle]
    return z if _area(z) > 0 else z[::-1]


def _area(z: Points) -> float:
    """Signed area of a ring, mm^2."""
    w = z - z[0]
    return float(np.sum((np.conj(w) * np.roll(w, -1)).imag)) / 2


def _prism(layer: Layer, tolerance: float, name: str, pocket: bool) -> Mesh:
    """The layer's region between its two heights; raises DesignError where the rings cross."""
    loops = rings(layer.region, tolerance, pocket)
    _check_rings(loops, name)
    z = np.concatenate(loops)
    n = len(z)
    floor = np.column_stack([z.real, z.imag, np.full(n, np.float32(layer.z0))])
    ceiling = np.column_stack([z.real, z.imag, np.full(n, np.float32(layer.z1))])

    ends = np.cumsum([len(loop) for loop in loops])
    here = np.arange(n)
    following = here + 1
    following[ends - 1] = ends - [len(loop) for loop in loops]
    cap = _triangles(loops)
    walls = [np.column_stack([here, following, following + n]), np.column_stack([here, following + n, here + n])]
    return Mesh(np.concatenate([floor, ceiling]) + 0.0, np.concatenate([cap[:, ::-1], cap + n, *walls]))


def _triangles(loops: Sequence[Points]) -> Faces:
    """Triangles between the rings, anticlockwise, using every point: (m, 3) indices into the rings end to end."""
    import manifold3d
    import mapbox_earcut

    z = np.concatenate(loops)
    xy = np.column_stack([z.real, z.imag])
    ends = np.cumsum([len(loop) for loop in loops]).astype(np.uint32)
    faces = mapbox_earcut.triangulate_float64(xy, ends).reshape(-1, 3).astype(np.int64)
    a, b, c = z[faces].T
    doubled = (np.conj(b - a) * (c - a)).imag
    wanted = sum(_area(loop) for loop in loops)
    # Earcut is linear but makes no promise: it drops points that come in line on the way.
    complete = len(faces) == len(z) + 2 * (len(loops) - 1) - 2 and np.all(doubled != 0)
    if complete and abs(np.sum(np.abs(doubled)) / 2 - wanted) <= 1e-9 * wanted:
        return np.where((doubled > 0)[:, None], faces, faces[:, ::-1])
    corners = [np.column_stack([loop.real, loop.imag]) for loop in loops]
    return np.asarray(manifold3d.triangulate(corners), np.int64)


def _check_rings(loops: Sequence[Points], name: str) -> None:
    """Raise DesignError, with the place, unless the rings bound one connected region."""
    import shapely

    outer, *holes = [np.column_stack([loop.real, loop.imag]) for loop in loops]
    reason = shapely.is_valid_reason(shapely.Polygon(outer, holes)) if len(outer) > 2 else "No area"
    if reason != "Valid Geometry":
        place = reason.replace("[", " at (").replace("]", ") mm")
        raise DesignError(f"outline faults of {name}", 1, 0, "", place, "outlines may not cross, touch or nest")


def _manifold(mesh: Mesh) -> Any:
    import manifold3d

    return manifold3d.Manifold(manifold3d.Mesh64(np.ascontiguousarray(mesh.vertices), mesh.faces.astype(np.uint64)))


def _combine(layers: Sequence[Mesh], pockets: Sequence[Mesh]) -> Mesh:
    """Union of the layers less the pockets; new vertices are brought back to float32 with walls upright."""
    import manifold3d

    body = manifold3d.Manifold.batch_boolean([_manifold(m) for m in layers], manifold3d.OpType.Add)
    if pockets:
        body = manifold3d.Manifold.batch_boolean([body, *map(_manifold, pockets)], manifold3d.OpType.Subtract)
    raw = body.to_mesh64()
    vertices, faces = np.asarray(raw.vert_properties)[:, :3], np.asarray(raw.tri_verts).astype(np.int64)
    levels = np.unique(np.concatenate([m.vertices[:, 2] for m in (*layers, *pockets)]))
    height = levels[np.argmin(np.abs(vertices[:, 2, None] - levels), axis=1)]
    known = np.unique(np.concatenate([m.vertices[:, 0] + 1j * m.vertices[:, 1] for m in (*layers, *pockets)]))
    plan = _upright(vertices[:, 0] + 1j * vertices[:, 1], known)

    return _ordered(np.column_stack([plan.real, plan.imag, height]), faces)


def _cross(layers: Sequence[Mesh], crossed: Region, tolerance: float, name: str) -> Mesh:
    """The stack as far as it lies in the region (x + iz) extruded along y; vertices are rounded to float32."""
    import manifold3d

    stack = manifold3d.Manifold.batch_boolean([_manifold(m) for m in layers], manifold3d.OpType.Add)
    reach = 1 + max(float(np.max(np.abs(m.vertices[:, 1]))) for m in layers)
    upright = _prism(Layer(crossed, -reach, reach), tolerance, name, pocket=False)
    # (x, y, z) to (x, z, y) is a mirror image, so the faces turn round
    across = Mesh(np.ascontiguousarray(upright.vertices[:, [0, 2, 1]]), np.ascontiguousarray(upright.faces[:, ::-1]))
    body = manifold3d.Manifold.batch_boolean([stack, _manifold(across)], manifold3d.OpType.Intersect)
    raw = body.to_mesh64()
    vertices = np.asarray(raw.vert_properties)[:, :3].astype(np.float32).astype(float) + 0.0
    return _ordered(vertices, np.asarray(raw.tri_verts).astype(np.int64))


def _ordered(vertices: Floats, faces: Faces) -> Mesh:
    """A mesh without doubled vertices and the faces that they leave flat, in an order that does not depend on threads."""
    vertices, index = np.unique(vertices, axis=0, return_inverse=True)
    faces = index.reshape(-1)[faces]
    faces = faces[np.all(faces != np.roll(faces, 1, axis=1), axis=1)]
    first = np.argmin(faces, axis=1)
    faces = np.take_along_axis(faces, (first[:, None] + np.arange(3)) % 3, axis=1)
    return Mesh(vertices, faces[np.lexsort(faces.T[::-1])])


def _upright(plan: Points, known: Points) -> Points:
    """Plan points (x + iy) as float32 numbers, those that differ by rounding alone made equal.

    Points of the rings stay as they are; a crossing of two rings, computed once for each height, takes the first value.
    """
    new = np.flatnonzero(~np.isin(plan, known))
    same = 4 * FLOAT32_ROUNDING * max(1.0, float(np.max(np.abs(plan))))
    result = plan.copy()
    settled: list[complex] = []
    for k in new:
        near = [z for z in settled if abs(z - plan[k]) <= same]
        if not near:
            closest = known[np.argmin(np.abs(known - plan[k]))]
            near = [closest if abs(closest - plan[k]) <= same else complex(np.complex64(plan[k]))]
            settled += near
        result[k] = near[0]
    return result + 0


def _check(mesh: Mesh, name: str) -> None:
    """Raise DesignError unless the mesh is one closed body with volume, after rounding to float32."""
    place = np.asarray(mesh.vertices, np.float32)
    if len(np.unique(place, axis=0)) != len(place):
        raise DesignError(f"distinct vertices of {name}", len(np.unique(place, axis=0)), len(place), "", "float32")
    body = _manifold(mesh)
    if body.status().name != "NoError" or body.is_empty() or not mesh.volume > 0:
        raise DesignError(f"volume of {name}", mesh.volume, 0, "mm^3", body.status().name, "outlines must not touch")
    bodies = len(body.decompose())
    if bodies != 1:
        raise DesignError(f"bodies of {name}", bodies, 1, "", "", "let the layers overlap")
