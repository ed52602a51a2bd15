"""From a part to a closed triangle mesh: facetted, extruded, stacked, and checked before anyone sees it.

    ring    (n,) complex, mm, closed without repeating the first point; anticlockwise round material, clockwise round
            a hole; every coordinate is a float32 number, so that the rounding of STL and 3MF changes nothing
    prism   a region between two heights: two caps and a strip of wall per ring, walls exactly upright

A prism keeps the rings' vertices as they are. Only a stack of layers passes through manifold3d's Boolean operations.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from camgen.errors import DesignError
from camgen.geometry.arcs import as_circle
from camgen.geometry.drums import Drum
from camgen.geometry.facets import facet_circle, facet_contour, reach
from camgen.geometry.mesh import MOST_TRIANGLES, Mesh
from camgen.geometry.outlines import Contour, Floats, Points, Region
from camgen.numerics import among, coordinates, distinct, magnitude
from camgen.parts.caps import Faces, area, recap, triangles
from camgen.parts.part import Layer, Part
from camgen.tolerances import FLOAT32_ROUNDING, MERGED_STEPS

# of the outlines of a drum, or of a stack of layers, whose union takes a time that grows almost with their square: 28,000 take half a minute
_MOST_POINTS = 40_000
_MOST_ALONE = MOST_TRIANGLES // 4  # of all outlines of a part: its mesh has four triangles for each
_COUNTED = 1e-9  # of an outline's size, the tolerance down to which points are counted
_FINEST = 1e-8  # mm, for which points are counted; float32 has no finer ones
_COARSER = 1.2  # from one tolerance that is tried to the next


def solid(part: Part, tolerance: float) -> Mesh:
    """The part as one closed body, in the part's frame; same part, same arrays.

    tolerance: chord tolerance, mm. Outlines are inscribed; full circles round empty space (bores, pockets) are
    circumscribed, so that a pin still fits. A crossed part has no engraving. Raises DesignError where an outline crosses
    itself or another one, where the layers do not make exactly one body, or where their union would take minutes.
    """
    plain = part.drum is None and part.side_profile is None
    alone = plain and len(part.layers) == 1 and not part.engraved
    refuse_too_fine(part, tolerance, _MOST_ALONE if alone else _MOST_POINTS)
    if part.drum is not None:
        mesh = _drum(part, part.drum, tolerance)
        _check(mesh, part.name)
        return mesh
    layers = [
        _prism(layer, tolerance, part.name, pocket=False, fine=alone) for layer in part.layers
    ]
    pockets = [_prism(layer, tolerance, part.name, pocket=True) for layer in part.engraved]
    if part.side_profile is not None:
        mesh = _cross(layers, part, tolerance)
    elif not alone:
        mesh = _combine(layers, pockets)
    else:  # one body, since its rings bound one region
        _check(layers[0], part.name)
        return layers[0]
    _check(mesh, part.name)
    _check_bodies(mesh, part.name)
    return mesh


def refuse_too_fine(part: Part, tolerance: float, most: int = _MOST_ALONE) -> None:
    """DesignError, with a tolerance that has been tried, where the outlines of a part have too many points.

    What curves have grows with the inverse root of the tolerance: of very many this tells the number before they are made.
    """
    counted = _COUNTED * max(reach(layer.region.outer) for layer in part.layers)
    if tolerance > counted and most == _MOST_ALONE:
        return

    def count(fine: float) -> int:
        return sum(len(ring) for layer in part.layers for ring in rings(layer.region, fine))

    def points(fine: float) -> float:
        if fine >= counted:
            return count(fine)
        found = count(counted)
        curved = 2 * (found - count(4 * counted))
        return found + curved * (math.sqrt(counted / fine) - 1)

    finest = max(tolerance, _FINEST)
    found = points(finest)
    if found <= most:
        return
    least = finest * (found / most) ** 2
    while points(least) > most:
        least *= _COARSER
    least = float(f"{_COARSER * least:.1e}")
    raise DesignError(
        "accuracy.chord_tolerance",
        tolerance,
        least,
        "mm",
        f"the outlines of {part.name}, which may have {most:,} points",
        "a larger accuracy.chord_tolerance, or a smaller part",
    )


def rings(region: Region, tolerance: float, pocket: bool = False) -> list[Points]:
    """Facetted rings of a region, outer first; `pocket`: the region is taken away instead of being material."""
    outer = _ring(region.outer, tolerance, outside=pocket)
    holes = [_ring(hole, tolerance, outside=not pocket)[::-1] for hole in region.holes]
    return [outer, *holes]


def _ring(contour: Contour, tolerance: float, outside: bool) -> Points:
    """Anticlockwise float32-clean ring without repeated points or points in line with their neighbours."""
    round_one = as_circle(contour) if outside else None
    z = (
        facet_circle(*round_one, tolerance, outside=True)
        if round_one
        else facet_contour(contour, tolerance)
    )
    z = z.astype(np.complex64).astype(np.complex128) + 0  # + 0 turns -0 into 0
    while True:
        z = np.asarray(z[z != np.roll(z, 1)])
        before = z - np.roll(z, 1)
        after = np.roll(z, -1) - z
        # Exact: differences of neighbours have under 27 bits, their products fit a float64.
        idle = (np.conj(before) * after).imag == 0
        idle &= ~np.roll(idle, 1)
        if not idle.any() or len(z) <= 3:
            break
        z = z[~idle]
    return z if area(z) > 0 else z[::-1]


def _prism(layer: Layer, tolerance: float, name: str, pocket: bool, fine: bool = False) -> Mesh:
    """The layer's region between its two heights, its caps as they are to stay (fine) or to be cut; DesignError where the rings
    cross."""
    loops = rings(layer.region, tolerance, pocket)
    _check_rings(loops, name)
    z, cap = triangles(loops, fine)
    n = len(z)
    floor = np.column_stack([z.real, z.imag, np.full(n, np.float32(layer.z0))])
    ceiling = np.column_stack([z.real, z.imag, np.full(n, np.float32(layer.z1))])

    sizes = np.array([len(loop) for loop in loops])
    corner = np.arange(sizes.sum())
    following = corner + 1
    following[np.cumsum(sizes) - 1] -= sizes
    walls = [
        np.column_stack([corner, following, following + n]),
        np.column_stack([corner, following + n, corner + n]),
    ]
    return Mesh(
        np.concatenate([floor, ceiling]) + 0.0, np.concatenate([cap[:, ::-1], cap + n, *walls])
    )


def _drum(part: Part, drum: Drum, tolerance: float) -> Mesh:
    """A drum's rings, with a key on its upper end, its ends with the holes of its layers, and the walls of these."""
    rims = drum.rings(tolerance).astype(np.float32).astype(float) + 0.0
    count = rims.shape[1]
    rising = drum.rising(rims)
    made = _Rings([*rims])
    faces = []
    for k in range(len(rims) - 1):
        low, high = (np.arange(count) + row * count for row in (k, k + 1))
        faces += _strip(low, high, rising[k])
    holes = rings(part.layers[0].region, tolerance)[1:]
    bottom = np.arange(count)
    top = bottom + (len(rims) - 1) * count
    height = float(rims[-1, 0, 2])
    if part.key is not None:
        edge = rings(part.key.region, tolerance)[0]
        foot = made.ring(edge, height)
        faces.append(made.cap(top, [foot[::-1]], 1, part.name))
        top = made.ring(edge, float(np.float32(part.key.z1)))
        faces += _strip(foot, top)
        height = float(np.float32(part.key.z1))
    lower, upper = ([made.ring(hole, z) for hole in holes] for z in (float(rims[0, 0, 2]), height))
    for low, high in zip(lower, upper, strict=True):
        faces += _strip(low, high)
    faces.append(made.cap(bottom, lower, -1, part.name))
    faces.append(made.cap(top, upper, 1, part.name))
    return Mesh(made.vertices, np.concatenate(faces))


class _Rings:
    """Points of a body as they come, each ring by the numbers of its own."""

    def __init__(self, rims: Sequence[Floats]) -> None:
        self.vertices = np.concatenate(rims)

    def ring(self, z: Points, height: float) -> Faces:
        """Points at a height, and their numbers."""
        first = len(self.vertices)
        more = np.column_stack([z.real, z.imag, np.full(len(z), height)])
        self.vertices = np.concatenate([self.vertices, more])
        return np.arange(first, len(self.vertices))

    def cap(self, edge: Faces, holes: Sequence[Faces], side: int, name: str) -> Faces:
        """Level triangles between rings, edge counter-clockwise and holes clockwise, that look up (side +1) or down."""
        plan = self.vertices[:, 0] + 1j * self.vertices[:, 1]
        loops = [plan[edge], *(plan[hole] for hole in holes)]
        _check_rings(loops, name)
        points, cap = triangles(loops)
        index = np.concatenate([edge, *holes])
        index = np.concatenate(
            [index, self.ring(points[len(index) :], float(self.vertices[edge[0], 2]))]
        )
        return np.asarray(index[cap[:, ::side]])


def _strip(low: Faces, high: Faces, rising: NDArray[np.bool_] | bool = True) -> list[Faces]:
    """Triangles between two rings of as many points, of material on the left of the lower one.

    rising: whether a cell is cut from its first point below to its second above, or the other way, (n,).
    """
    low_next = np.roll(low, -1)
    high_next = np.roll(high, -1)
    return [
        np.column_stack([low, low_next, np.where(rising, high_next, high)]),
        np.column_stack([np.where(rising, low, low_next), high_next, high]),
    ]


def _check_rings(loops: Sequence[Points], name: str) -> None:
    """Raise DesignError, with the place, unless the rings bound one connected region."""
    import shapely

    outer, *holes = [coordinates(loop) for loop in loops]
    reason = shapely.is_valid_reason(shapely.Polygon(outer, holes)) if len(outer) > 2 else "No area"
    if reason != "Valid Geometry":
        place = reason.replace("[", " at (").replace("]", ") mm")
        raise DesignError(
            f"outline faults of {name}", 1, 0, "", place, "outlines may not cross, touch or nest"
        )


def _combine(layers: Sequence[Mesh], pockets: Sequence[Mesh]) -> Mesh:
    """Union of the layers less the pockets; new vertices are brought back to float32 with walls upright."""
    import manifold3d

    body = manifold3d.Manifold.batch_boolean([m.manifold for m in layers], manifold3d.OpType.Add)
    if pockets:
        body = manifold3d.Manifold.batch_boolean(
            [body, *(m.manifold for m in pockets)], manifold3d.OpType.Subtract
        )
    raw = body.to_mesh64()
    vertices = np.asarray(raw.vert_properties)[:, :3]
    faces = np.asarray(raw.tri_verts).astype(np.int64)
    levels = distinct(*(m.vertices[:, 2] for m in (*layers, *pockets)))
    height = levels[np.argmin(np.abs(vertices[:, 2, None] - levels), axis=1)]
    known_points = distinct(
        *(m.vertices[:, 0] + 1j * m.vertices[:, 1] for m in (*layers, *pockets))
    )
    plan = _upright(vertices[:, 0] + 1j * vertices[:, 1], known_points)

    return recap(_canonical(np.column_stack([plan.real, plan.imag, height]), faces))


def _cross(layers: Sequence[Mesh], part: Part, tolerance: float) -> Mesh:
    """The stack as far as it lies in the part's other region extruded along y, its edges cut round; rounded to float32."""
    import manifold3d

    stack = manifold3d.Manifold.batch_boolean([m.manifold for m in layers], manifold3d.OpType.Add)
    reach = 1 + max(magnitude(m.vertices[:, 1]) for m in layers)
    assert part.side_profile is not None
    upright = _prism(Layer(part.side_profile, -reach, reach), tolerance, part.name, pocket=False)
    # (x, y, z) to (x, z, y) is a mirror image, so the faces turn round
    across = Mesh(
        np.ascontiguousarray(upright.vertices[:, [0, 2, 1]]),
        np.ascontiguousarray(upright.faces[:, ::-1]),
    )
    body = manifold3d.Manifold.batch_boolean([stack, across.manifold], manifold3d.OpType.Intersect)
    cutters = [_canonical(*edge.cutter(tolerance)).manifold for edge in part.edges]
    if cutters:
        body = manifold3d.Manifold.batch_boolean([body, *cutters], manifold3d.OpType.Subtract)
    if body.is_empty():
        raise DesignError(
            f"volume of {part.name}", 0.0, 0.0, "mm^3", "", "its two outlines must meet"
        )
    raw = body.to_mesh64()
    vertices = np.asarray(raw.vert_properties)[:, :3].astype(np.float32).astype(float) + 0.0
    faces = np.asarray(raw.tri_verts).astype(np.int64)
    # Where cuts nearly meet, edges are a few float32 steps long: no two readers agree on the normal of a face with one.
    start = faces.ravel()
    end = np.roll(faces, -1, axis=1).ravel()
    step = MERGED_STEPS * FLOAT32_ROUNDING * magnitude(vertices)
    for k in np.flatnonzero(
        (start < end) & (np.abs(vertices[start] - vertices[end]).max(axis=1) <= step)
    ):
        vertices[end[k]] = vertices[start[k]]
    mesh = _canonical(vertices, faces)
    return _canonical(mesh.vertices, _split_flat(mesh))


def _split_flat(mesh: Mesh) -> Faces:
    """Faces without those that rounding has made flat: of each the middle corner splits the face across its longest side."""
    faces = mesh.faces.copy()
    for _ in range(len(faces)):
        corners = mesh.vertices[faces]
        areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        flat = np.flatnonzero(~areas.any(axis=1))
        if not len(flat):
            break
        k = int(flat[0])
        lengths = np.linalg.norm(np.roll(corners[k], -1, axis=0) - corners[k], axis=1)
        p, q, middle = np.roll(faces[k], -int(np.argmax(lengths)))
        across = np.flatnonzero(np.any((faces == q) & (np.roll(faces, -1, axis=1) == p), axis=1))
        if len(across) != 1:
            break
        far = next(v for v in faces[across[0]] if v not in (p, q))
        faces[k] = (q, middle, far)
        faces[across[0]] = (middle, p, far)
    return faces


def _canonical(vertices: Floats, faces: Faces) -> Mesh:
    """A mesh without doubled vertices and the faces that they leave flat, in an order that does not depend on threads."""
    vertices, index = np.unique(vertices, axis=0, return_inverse=True)
    faces = index.reshape(-1)[faces]
    faces = faces[np.all(faces != np.roll(faces, 1, axis=1), axis=1)]
    first = np.argmin(faces, axis=1)
    faces = np.take_along_axis(faces, (first[:, None] + np.arange(3)) % 3, axis=1)
    return Mesh(vertices, faces[np.lexsort(faces.T[::-1])])


def _upright(plan: Points, reference: Points) -> Points:
    """Plan points (x + iy) as float32 numbers, those that differ by rounding alone made equal.

    Points of the rings, the reference, which grow, stay as they are; a crossing of two rings, computed once for each height, takes the
    first value.
    """
    new = np.flatnonzero(~among(plan, reference))
    same = 4 * FLOAT32_ROUNDING * max(1.0, magnitude(plan))
    result = plan.copy()
    low = np.searchsorted(reference.real, plan[new].real - same)
    high = np.searchsorted(reference.real, plan[new].real + same, side="right")
    # new points by the square in which they lie, so that each is compared with its neighbours alone
    squares: defaultdict[tuple[int, int], list[tuple[int, complex]]] = defaultdict(list)
    for k, first, last in zip(new, low, high, strict=True):
        z = complex(plan[k])
        column = math.floor(z.real / same)
        row = math.floor(z.imag / same)
        beside = (squares.get((column + i, row + j), ()) for i in (-1, 0, 1) for j in (-1, 0, 1))
        near = [each for square in beside for each in square if abs(each[1] - z) <= same]
        if near:
            result[k] = min(near)[1]
            continue
        closest = min(reference[first:last], key=lambda each: abs(each - z), default=math.inf)
        value = complex(closest) if abs(closest - z) <= same else complex(np.complex64(z))
        squares[math.floor(value.real / same), math.floor(value.imag / same)].append(
            (int(k), value)
        )
        result[k] = value
    return result + 0


def _check(mesh: Mesh, name: str) -> None:
    """Raise DesignError unless the mesh is closed, with volume, and its vertices are still distinct as float32."""
    place = np.asarray(mesh.vertices, np.float32)
    place = place[np.lexsort(place.T)]
    same = int(np.count_nonzero(np.all(place[1:] == place[:-1], axis=1)))
    if same:
        raise DesignError(
            f"distinct vertices of {name}", len(place) - same, len(place), "", "float32"
        )
    a = mesh.faces
    b = np.roll(mesh.faces, -1, axis=1)
    size = len(mesh.vertices)
    forth = np.sort((a * size + b).ravel())
    back = np.sort((b * size + a).ravel())
    # closed: every edge is run once each way
    faults = int(np.count_nonzero(forth != back)) + int(np.count_nonzero(forth[1:] == forth[:-1]))
    if faults or not mesh.volume > 0:
        raise DesignError(
            f"volume of {name}",
            mesh.volume,
            0,
            "mm^3",
            f"{faults} faulty edges",
            "outlines must not touch",
        )


def _check_bodies(mesh: Mesh, name: str) -> None:
    """Raise DesignError unless a closed mesh is one body."""
    bodies = len(mesh.manifold.decompose())
    if bodies != 1:
        raise DesignError(f"bodies of {name}", bodies, 1, "", "", "let the layers overlap")
