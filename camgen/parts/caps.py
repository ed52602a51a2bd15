"""Caps: triangles between rings, as high as the rings let them be, for thin ones make slicers and kernels stumble.

    ring    (n,) complex, mm, closed without repeating the first point; anticlockwise round material, clockwise round a hole

Of the triangles between given points Delaunay's have the largest least angle, so no cap is lower than its outline asks: where
two points of it lie near each other, or three in a row nearly on one line. A cap has the vertices of its outlines and no other.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from camgen.geometry.mesh import Mesh, joined_by_edges
from camgen.geometry.outlines import Points
from camgen.numerics import among, coordinates, distinct

Faces = NDArray[np.int64]

# Both ways take a time that grows faster than the rings. Those of more points than _LONG are first cut into some _CHUNKS
# chunks, see _banded; their triangles are as they come.
_LONG = 8000
_CHUNKS = 1500


def area(z: Points) -> float:
    """Signed area of a ring, mm^2."""
    w = z - z[0]
    return float(np.sum((np.conj(w) * np.roll(w, -1)).imag)) / 2


def triangles(loops: Sequence[Points], fine: bool = True) -> tuple[Points, Faces]:
    """Triangles between the rings, anticlockwise, using every point; fine: as high as they can be, which takes longer.

    Returns the rings' points end to end, followed by points inside where there are many, and (m, 3) indices into them.
    """
    import manifold3d

    z = np.concatenate(loops)
    region_area = sum(area(loop) for loop in loops)
    tries = (_bands, _earcut) if len(z) > _LONG else (_delaunay, _earcut) if fine else (_earcut,)
    for attempt in tries:
        points, faces = attempt(loops)
        a, b, c = points[faces].T
        twice_area = (np.conj(b - a) * (c - a)).imag
        # Neither makes a promise: earcut drops points that come in line on the way. All turned one way, as many as there must
        # be and of the right area, they lie side by side.
        complete = len(faces) == len(z) + 2 * (len(points) - len(z)) + 2 * (
            len(loops) - 1
        ) - 2 and np.all(twice_area > 0)
        if complete and abs(np.sum(twice_area) / 2 - region_area) <= 1e-9 * region_area:
            return points, faces
    corners = [coordinates(loop) for loop in loops]
    return z, np.asarray(manifold3d.triangulate(corners), np.int64)


def _earcut(loops: Sequence[Points]) -> tuple[Points, Faces]:
    """Earcut's triangles, each turned anticlockwise."""
    import mapbox_earcut

    z = np.concatenate(loops)
    ends = np.cumsum([len(loop) for loop in loops]).astype(np.uint32)
    faces = mapbox_earcut.triangulate_float64(coordinates(z), ends).reshape(-1, 3).astype(np.int64)
    a, b, c = z[faces].T
    return z, np.where(((np.conj(b - a) * (c - a)).imag > 0)[:, None], faces, faces[:, ::-1])


def _bands(loops: Sequence[Points]) -> tuple[Points, Faces]:
    """A fan on each chunk of a ring from a new point inside the material, and earcut's triangles between the fans.

    The new points are float32 numbers. A chunk that its point does not wholly see, at a corner, stays as it is.
    """
    size = sum(len(loop) for loop in loops)
    step = -(-size // _CHUNKS)
    inner_rings: list[Faces] = []
    tips: list[Points] = []
    fans: list[Faces] = []
    begin = 0
    new = size
    for loop in loops:
        n = len(loop)
        chunk = np.arange(n) // step
        start = np.arange(0, n, step)
        following = np.roll(loop, -1)
        stop = np.append(loop[start[1:]], loop[0])
        tip = ((loop[start] + stop) / 2 + 0.3j * (stop - loop[start])).astype(np.complex64).astype(
            complex
        ) + 0
        clear = (np.conj(following - loop) * (tip[chunk] - loop)).imag > 0
        good = np.logical_and.reduceat(clear, start)
        number = new + np.cumsum(good) - 1
        edge = np.flatnonzero(good[chunk])
        fans.append(np.column_stack([begin + edge, begin + (edge + 1) % n, number[chunk[edge]]]))
        stays = np.flatnonzero(~good[chunk] | (np.arange(n) % step == 0))
        place = np.concatenate([stays, start[good] + 0.5])
        inner_rings.append(np.concatenate([begin + stays, number[good]])[np.argsort(place)])
        tips.append(tip[good])
        begin = begin + n
        new = new + int(np.count_nonzero(good))
    points = np.concatenate([*loops, *tips])
    _, inner = _earcut([points[index] for index in inner_rings])
    return points, np.concatenate([*fans, np.concatenate(inner_rings)[inner]])


def _delaunay(loops: Sequence[Points]) -> tuple[Points, Faces]:
    """Delaunay's triangles between the rings, each turned anticlockwise."""
    import shapely

    z = np.concatenate(loops)
    outer, *holes = [coordinates(loop) for loop in loops]
    places = shapely.get_coordinates(
        shapely.constrained_delaunay_triangles(shapely.Polygon(outer, holes))
    )
    corners = (places[:, 0] + 1j * places[:, 1]).reshape(-1, 4)[:, :3]
    order = np.argsort(z)
    faces = order[np.minimum(np.searchsorted(z[order], corners), len(z) - 1)]
    if not np.array_equal(z[faces], corners):
        return z, faces[:0]
    a, b, c = corners.T
    return z, np.where(((np.conj(b - a) * (c - a)).imag > 0)[:, None], faces, faces[:, ::-1])


def recap(mesh: Mesh) -> Mesh:
    """The same body with its level faces divided anew, each between the same vertices of its outlines."""
    corners = mesh.vertices[mesh.faces]
    level = np.all(corners[:, :, 2] == corners[:, :1, 2], axis=1)
    looks = np.where(level, np.sign(mesh.across[:, 2]), 0.0)
    new_faces = [mesh.faces[~level]]
    for z in distinct(corners[level][:, 0, 2]):
        for side in (-1.0, 1.0):
            cap = mesh.faces[(looks == side) & (corners[:, 0, 2] == z)]
            new_faces += [_redivide(mesh, patch, side) for patch in _patches(cap)]
    faces = np.concatenate(new_faces)
    first = np.argmin(faces, axis=1)
    faces = np.take_along_axis(faces, (first[:, None] + np.arange(3)) % 3, axis=1)
    return Mesh(mesh.vertices, faces[np.lexsort(faces.T[::-1])])


def _patches(faces: Faces) -> list[Faces]:
    """Level faces that edges join, together."""
    label = joined_by_edges(faces)
    return [faces[label == k] for k in distinct(label)]


def _redivide(mesh: Mesh, patch: Faces, side: float) -> Faces:
    """A patch's triangles anew; as they are where its outlines touch in a point, or there are points inside."""
    if len(patch) < 2:
        return patch
    a = patch.ravel()
    b = np.roll(patch, -1, axis=1).ravel()
    if side < 0:
        a, b = b, a
    forth = a * len(mesh.vertices) + b
    back = b * len(mesh.vertices) + a
    rim = ~among(forth, np.sort(back))
    following = dict(zip(a[rim].tolist(), b[rim].tolist(), strict=True))
    if len(following) != np.count_nonzero(rim):
        return patch
    rings: list[list[int]] = []
    while following:
        ring = [next(iter(following))]
        while (after := following.pop(ring[-1])) != ring[0]:
            ring.append(after)
        rings.append(ring)
    size = sum(map(len, rings))
    if size != len(distinct(patch.ravel())):
        return patch
    plan = mesh.vertices[:, 0] + 1j * mesh.vertices[:, 1]
    rings.sort(key=lambda ring: -abs(area(plan[ring])))
    z, faces = triangles([plan[ring] for ring in rings])
    if len(z) != size:
        return patch
    new_faces = np.concatenate(rings)[faces]
    return new_faces if side > 0 else new_faces[:, ::-1]
