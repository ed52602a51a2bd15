"""Triangle meshes: what keeps one from bounding a solid, and its sections at a height."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from camgen.errors import counted
from camgen.geometry.rings import Floats, Ints, Points, Ring
from camgen.numerics import distinct, product
from camgen.tolerances import NORMAL_ROUNDING, SAME_POINT

MOST_TRIANGLES = (
    2_000_000  # of a file: what is judged of each takes some microseconds, and half a kilobyte
)


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangle mesh."""

    vertices: Floats  # (n, 3) mm
    faces: Ints  # (m, 3) indices of vertices, counter-clockwise seen from outside
    normals: Floats | None = None  # (m, 3) as a file stores them, where it was read for them

    @cached_property
    def across(self) -> Floats:
        """Outward normal of each face, as long as twice its area, (m, 3) mm^2."""
        rows = np.ascontiguousarray(self.vertices.T)
        a, b, c = self.faces.T
        first = rows[:, a]
        u = rows[:, b] - first
        v = rows[:, c] - first
        normals = np.empty(self.faces.shape)
        for k, (i, j) in enumerate(
            ((1, 2), (2, 0), (0, 1))
        ):  # np.cross, which is slow on many short vectors
            normals[:, k] = u[i] * v[j] - u[j] * v[i]
        return normals

    @property
    def volume(self) -> float:
        """Signed volume, mm^3; positive when the faces look outwards."""
        middle = self.vertices.mean(axis=0) if len(self.vertices) else np.zeros(3)
        return float(
            np.einsum("ij,ij->", self.vertices[self.faces[:, 0]] - middle, self.across) / 6
        )

    @property
    def manifold(self) -> Any:
        """It as a body of manifold3d."""
        import manifold3d

        return manifold3d.Manifold(
            manifold3d.Mesh64(np.ascontiguousarray(self.vertices), self.faces.astype(np.uint64))
        )

    def moved(self, transform: Floats) -> Mesh:
        """Image under a (3, 4) transform: rotation and shift, applied to column vectors."""
        return Mesh(product(self.vertices, transform[:, :3].T) + transform[:, 3], self.faces)


_UPRIGHT = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
_STANDING = np.array([[0, 0, -1.0], [-1, 0, 0], [0, 1, 0]])


def placing(
    angle: float,
    position: complex,
    z: float,
    thickness: float,
    flipped: bool = False,
    upright: bool = False,
) -> Floats:
    """Transform (3, 4) of a part turned by angle (rad) about z and moved to position (complex mm) and height z, mm.

    flipped: first turned over about Oy, (x, y, z) -> (-x, y, thickness - z): a rotation, no mirror image.
    upright: first stood up on its y = 0, (x, y, z) -> (x, -z, y).
    """
    turn = np.array(
        [[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]]
    )
    over = np.diag([-1.0, 1.0, -1.0]) if flipped else np.eye(3)
    if upright:
        over = _UPRIGHT
    shift = [position.real, position.imag, z + (thickness if flipped else 0)]
    return np.column_stack([product(turn, over), shift]) + 0.0


def in_standing_plane(transform: Floats) -> Floats:
    """A transform (3, 4) in a plane that stands, whose x is -y, y is z and z is -x, as one in space."""
    return np.asarray(product(_STANDING, transform) + 0.0)


def weld(corners: Floats) -> Mesh:
    """Mesh of (m, 3, 3) corners, vertices unique by exact bits.

    A hash table by scatter and gather: all corners write their number to the slot of their hash, the one that stays
    stands for all corners equal to it, and whoever lost the slot to another point tries again with another hash.
    """
    flat = np.ascontiguousarray(corners.reshape(-1, 3)) + 0.0  # -0 becomes 0
    bits = flat.view(np.uint64)
    stand_in = np.empty(len(flat), np.int64)
    slots = 1 << max(len(flat).bit_length(), 4)
    slot_of = np.empty(slots, np.int64)
    open_rows = np.arange(len(flat))
    seed = np.array([0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9], np.uint64)
    while len(open_rows):
        mine = bits[open_rows]
        hash_ = mine[:, 0] * seed[0] ^ mine[:, 1] * seed[1] ^ mine[:, 2] * seed[2]
        slot = ((hash_ ^ hash_ >> np.uint64(29)) * seed[0] >> np.uint64(20)) % np.uint64(slots)
        slot_of[slot] = open_rows
        winner = slot_of[slot]
        same = (bits[winner] == mine).all(axis=1)
        stand_in[open_rows[same]] = winner[same]
        open_rows = open_rows[~same]
        seed = seed * seed[1] | np.uint64(1)
    first = np.zeros(len(flat), bool)
    first[stand_in] = True
    number = np.cumsum(first) - 1
    return Mesh(flat[first], number[stand_in].reshape(-1, 3))


@dataclass(frozen=True)
class MeshFaults:
    """What keeps a mesh from bounding a solid, counted, and what it bounds.

    Edges of one triangle only (open), run twice the same way (flipped), of more than two triangles (crowded);
    triangles without area; stored normals that are not the triangle's own, which harm no solid; bodies (joined by edges);
    signed volume, mm^3, negative when inside out.
    """

    open_edges: int
    flipped_edges: int
    crowded_edges: int
    degenerate: int
    turned_normals: int
    bodies: int
    volume: float

    @property
    def count(self) -> int:
        """Number of faulty edges and triangles; 0 for a watertight mesh."""
        return self.open_edges + self.flipped_edges + self.crowded_edges + self.degenerate

    @property
    def defects(self) -> str:
        """The faults that there are, for people; empty where there is none."""
        kinds = [
            (self.open_edges, "open edge", "open edges"),
            (self.flipped_edges, "edge turned over", "edges turned over"),
            (
                self.crowded_edges,
                "edge of more than two triangles",
                "edges of more than two triangles",
            ),
            (self.degenerate, "triangle without area", "triangles without area"),
            (
                self.turned_normals,
                "stored normal not its triangle's own",
                "stored normals not their triangles' own",
            ),
        ]
        return ", ".join(counted(*kind) for kind in kinds if kind[0])


def mesh_faults(mesh: Mesh) -> MeshFaults:
    """Count the faults of a mesh."""
    a = mesh.faces.ravel()
    b = np.roll(mesh.faces, -1, axis=1).ravel()
    key = np.minimum(a, b) * len(mesh.vertices) + np.maximum(a, b)
    order = np.argsort(key, kind="stable")
    starts = np.flatnonzero(np.diff(key[order], prepend=-1))
    uses = np.diff(starts, append=len(key))
    balance = np.add.reduceat(np.where(a < b, 1, -1)[order], starts) if len(key) else uses
    return MeshFaults(
        open_edges=int(np.count_nonzero(uses == 1)),
        flipped_edges=int(np.count_nonzero((uses == 2) & (balance != 0))),
        crowded_edges=int(np.count_nonzero(uses > 2)),
        degenerate=int(np.count_nonzero(~mesh.across.any(axis=1))),
        turned_normals=0 if mesh.normals is None else _wrong_normals(mesh.normals, mesh.across),
        bodies=len(distinct(joined_by_edges(mesh.faces))),
        volume=mesh.volume,
    )


def _wrong_normals(normals: Floats, directions: Floats) -> int:
    """How many of the stored unit normals are not those of their triangles, which have the directions `directions`, (m, 3)."""
    size = np.linalg.norm(directions, axis=1, keepdims=True)
    off = np.linalg.norm(normals - directions / np.where(size == 0, 1, size), axis=1)
    return int(np.count_nonzero(~(off <= NORMAL_ROUNDING) & (size[:, 0] > 0)))


def joined_by_edges(faces: Ints) -> Ints:
    """A number for each triangle, (n,): the same of all that edges join; faces: (n, 3) vertices."""
    a = faces.ravel()
    b = np.roll(faces, -1, axis=1).ravel()
    key = np.minimum(a, b) * (int(faces.max(initial=0)) + 1) + np.maximum(a, b)
    order = np.argsort(key, kind="stable")
    shared = np.flatnonzero(np.diff(key[order]) == 0)
    return components(len(faces), order[shared] // 3, order[shared + 1] // 3)


def components(count: int, a: Ints, b: Ints) -> Ints:
    """Connected components of a graph with links a-b, (count,): every node takes its neighbours' least label."""
    label = np.arange(count)
    while (label[a] != label[b]).any():
        least = np.minimum(label[a], label[b])
        np.minimum.at(label, label[a], least)
        np.minimum.at(label, label[b], least)
        while (label[label] != label).any():
            label = label[label]
    return label


def slice_mesh(mesh: Mesh, z: float) -> list[Ring]:
    """Section of a mesh at height z: straight rings, material on their left (outside ccw, holes cw).

    A vertex at exactly z counts as above. A point on the line through its neighbours, within SAME_POINT, is left out:
    such points come from the diagonals of upright walls. ValueError when the section does not close.
    """
    above = mesh.vertices[:, 2] >= z
    side = above[mesh.faces]
    high = side.sum(axis=1)
    crossing_faces = np.flatnonzero((high == 1) | (high == 2))
    if not len(crossing_faces):
        return []
    top = high[crossing_faces] == 1
    lone = np.argmax(
        side[crossing_faces] == top[:, None], axis=1
    )  # the corner that is alone on its side
    faces = mesh.faces[crossing_faces]
    row = np.arange(len(crossing_faces))
    a, b, c = (faces[row, (lone + k) % 3] for k in range(3))
    # crossing runs from edge a-tail to edge a-head
    tail = np.where(top, b, c)
    head = np.where(top, c, b)
    size = len(mesh.vertices)
    start = np.minimum(a, tail) * size + np.maximum(a, tail)
    end = np.minimum(a, head) * size + np.maximum(a, head)
    by_start = np.argsort(start)
    by_end = np.argsort(end)
    wrong = int(np.count_nonzero(start[by_start] != end[by_end]))
    if wrong or (np.diff(start[by_start]) == 0).any():
        raise ValueError(f"the section at z = {z:.6g} mm does not close")
    following = np.empty(len(crossing_faces), np.int64)
    following[by_end] = by_start
    low = mesh.vertices[start // size]
    up = mesh.vertices[start % size]
    parameter = (z - low[:, 2]) / (up[:, 2] - low[:, 2])
    x, y = (low[:, k] + parameter * (up[:, k] - low[:, k]) for k in (0, 1))
    points = x + 1j * y
    return [ring for loop in _loops(following) if (ring := _without_idle(points[loop])) is not None]


def _loops(following: Ints) -> list[Ints]:
    """The cycles of a permutation, each as its members in order."""
    step = following.tolist()
    loops = []
    visited = bytearray(len(step))
    for first in range(len(step)):
        if visited[first]:
            continue
        loop = []
        k = first
        while not visited[k]:
            visited[k] = 1
            loop.append(k)
            k = step[k]
        loops.append(np.array(loop))
    return loops


def _without_idle(z: Points) -> Ring | None:
    """Ring through z less repeated points and those on the line of their neighbours; None when nothing is left."""
    z = z[np.abs(z - np.concatenate([z[-1:], z[:-1]])) > SAME_POINT]
    before = z - np.concatenate([z[-1:], z[:-1]])
    length = np.abs(before)
    after = np.concatenate([before[1:], before[:1]])
    turn = np.conj(before) * after
    # The far neighbour is to lie on the line of the short edge: so two near vertices that bend a little are not both idle.
    idle = np.abs(turn.imag) <= SAME_POINT * np.minimum(
        length, np.concatenate([length[1:], length[:1]])
    )
    z = z[~(idle & (turn.real > 0))]
    return Ring.straight(z) if len(z) > 2 else None
