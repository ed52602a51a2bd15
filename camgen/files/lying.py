"""On which side a part is laid on the bed: the one that carries most and overhangs least.

    side       a direction of the part that is turned down
    contact    area that lies on the bed
    overhang   area, seen from below, of what leans outwards by more than 45 deg and does not lie on the bed: it needs supports
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

from camgen.geometry.outlines import Floats

_STEEP = np.cos(np.radians(45)) + 1e-6  # a chamfer of 45 deg prints
_FLAT = 1e-3  # mm, by which a face that lies on the bed may be off it
_CLEARLY = 0.01  # of the contact, by which another side has to be better than the part's own underside
_TRIED = 12  # flat sides beyond the six along the axes


class Solid(Protocol):
    """A closed mesh, as made or as read back: vertices (n, 3) mm; faces (m, 3), anticlockwise seen from outside."""

    @property
    def vertices(self) -> Floats:
        """Corners."""

    @property
    def faces(self) -> Any:
        """Indices of corners."""


@dataclass(frozen=True)
class Side:
    """A side to lie on: its name, the turn (3, 3) that brings it down, contact and overhang, mm^2, and the height then, mm."""

    name: str = "as drawn"
    contact: float = 0.0
    overhang: float = 0.0
    height: float = 0.0
    turn: Floats = field(default_factory=lambda: np.eye(3), compare=False)

    @property
    def worth(self) -> float:
        """Contact less overhang, mm^2."""
        return self.contact - self.overhang


def side(mesh: Solid, down: Floats) -> Side:
    """The part lying with the direction `down`, a unit vector (3,) of its frame, towards the bed."""
    areas = _areas(mesh)
    seen = areas @ down  # from below, mm^2; above 0 where a face looks down
    depth = mesh.vertices @ down
    lying = np.all(depth[mesh.faces] > np.max(depth) - _FLAT, axis=1) & (seen > 0)
    leaning = ~lying & (seen > _STEEP * np.linalg.norm(areas, axis=1))
    return Side(_name(down), float(seen[lying].sum()), float(seen[leaning].sum()), float(np.ptp(depth)), _turn(down))


def lying_side(mesh: Solid) -> Side:
    """The side whose contact exceeds its overhang by most; the part's own underside unless another one is clearly better."""
    own = side(mesh, np.array([0.0, 0.0, -1.0]))
    areas = _areas(mesh)
    areas = areas[np.any(areas != 0, axis=1)]
    sizes = np.linalg.norm(areas, axis=1)
    steps = np.rint(areas / sizes[:, None] * 1000).astype(np.int64) + 1000  # 0 to 2000, each normal one number of three digits
    _, first, index = np.unique(steps @ np.array([2001**2, 2001, 1]), return_index=True, return_inverse=True)
    normals, whole = (steps[first] - 1000) / 1000, np.bincount(index, sizes)
    largest = np.argsort(-whole, kind="stable")[:_TRIED]
    flat = normals[largest[whole[largest] > own.worth]]  # of a smaller one no more than its area can lie on the bed
    downs = [*np.eye(3), *-np.eye(3)[:2], *(n / np.linalg.norm(n) for n in flat)]
    best = max((side(mesh, down) for down in downs), key=lambda each: round(each.worth, 3))
    return best if best.worth > own.worth + _CLEARLY * max(own.contact, best.contact) else own


def _areas(mesh: Solid) -> Floats:
    """Outward normal of each face, as long as its area, (m, 3) mm^2."""
    corners = mesh.vertices[mesh.faces]
    return np.asarray(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2)


def _name(down: Floats) -> str:
    """What people call it."""
    axis = int(np.argmax(np.abs(down)))
    if abs(down[axis]) < 1 - 1e-9:
        return f"on the side towards ({down[0]:.3g}, {down[1]:.3g}, {down[2]:.3g})"
    if axis == 2:
        return "as drawn" if down[2] < 0 else "turned over"
    return f"on its side towards {'-' if down[axis] < 0 else '+'}{'xy'[axis]}"


def _turn(down: Floats) -> Floats:
    """The rotation (3, 3) for column vectors that brings `down` to -z; what looks up is turned over about y first."""
    if down[2] > 0:
        over = np.diag([-1.0, 1.0, -1.0])
        return np.asarray(_turn(over @ down) @ over) + 0.0
    across = np.cross(down, [0.0, 0.0, -1.0])
    cross = np.array([[0, -across[2], across[1]], [across[2], 0, -across[0]], [-across[1], across[0], 0]])
    return np.asarray(np.eye(3) + cross + cross @ cross / (1 - down[2])) + 0.0
