"""The assembly of a drum's machine as written, moved through a turn: which bodies come how near to each other, in space.

    turns    about the drum's axis, x = y = 0: what a body reaches is between two radii
    rises    along that axis: what it is in plan stays as it is
    swings   in a plane that stands

A pair is first held apart by what holds both through the whole turn: a box along the axes, from one radius to another, and of what
stands still or rises its plan. Where these are not far enough apart, distances of the meshes are taken. From one angle to another
no point of a body, as the other one sees it, moves further than the corners of its box do; so where a gap g is seen, and g0 is
needed, all is well on the stretch on which they move by less than g - g0 either way. What that leaves of the turn is looked at in
its middles. Between angles of the grid a corner's way counts with twice what its second difference says.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from camgen.files.threemf import read_3mf
from camgen.findings import Finding, at_least, in_file
from camgen.geometry.mesh import Mesh
from camgen.geometry.rings import Floats
from camgen.judge.assembly import Row, complete, nearest, standing
from camgen.judge.interference import GRID, Clearance, interference
from camgen.judge.slabs import plan_of
from camgen.machine.features import SweptMachine
from camgen.machine.model import GROUND

_PRESSED = 0.01  # mm, overlap of bodies fixed on each other or turning in each other that still counts as touching
_FAR = 2.0  # mm, beyond which no distance is looked for: what is near is found soon
_MOST = 4000  # distances of one pair
_STILL = 1e-9  # mm or rad, less than which nothing moves
_ROUNDING = 1e-4  # mm, of places in a file of float32


@dataclass(frozen=True, eq=False)
class _Body:
    """A copy as the file has it at theta = 0, and how its body goes on from there."""

    name: str
    part: str
    on: str  # body of the model
    mesh: Mesh
    courses: Mapping[str, Floats]  # by body, transforms (n, 3, 4) from theta = 0 over the grid

    @property
    def turns(self) -> bool:
        """Whether it turns about the axis of the drum, or stands still."""
        places = self.courses[self.on]
        upright = np.abs(places[:, 2, :3] - [0, 0, 1]).max() < _STILL
        return bool(upright and np.abs(places[:, :, 3]).max() < _STILL)

    @property
    def rises(self) -> bool:
        """Whether it moves along that axis alone, or stands still."""
        places = self.courses[self.on]
        unturned = np.abs(places[:, :, :3] - np.eye(3)).max() < _STILL
        return bool(unturned and np.abs(places[:, :2, 3]).max() < _STILL)

    @cached_property
    def plan(self) -> Any:
        """As seen from above, a geometry."""
        return plan_of(self.mesh)

    @cached_property
    def solid(self) -> Any:
        """For distances."""
        import manifold3d

        return manifold3d.Manifold(
            manifold3d.Mesh64(
                np.ascontiguousarray(self.mesh.vertices, float), self.mesh.faces.astype(np.uint64)
            )
        )

    @cached_property
    def corners(self) -> Floats:
        """Of its box at theta = 0, (8, 3)."""
        ends = np.stack([self.mesh.vertices.min(axis=0), self.mesh.vertices.max(axis=0)])
        return np.array(list(itertools.product(*ends.T)))

    @cached_property
    def radii(self) -> tuple[float, float]:
        """Least and greatest distance from the axis, mm, through the turn."""
        if self.turns:
            plan = self.mesh.vertices[:, :2]
            return _least_radius(plan[self.mesh.faces]), float(np.hypot(*plan.T).max())
        low, high = self.box
        near = np.maximum(0.0, np.maximum(low[:2], -high[:2]))
        far = np.maximum(np.abs(low[:2]), np.abs(high[:2]))
        return float(np.hypot(*near)), float(np.hypot(*far))

    @cached_property
    def box(self) -> tuple[Floats, Floats]:
        """Lowest and highest coordinates through the turn, (3,) each."""
        low = self.mesh.vertices.min(axis=0)
        high = self.mesh.vertices.max(axis=0)
        if self.on == GROUND:
            return low, high
        if self.turns:
            far = float(np.hypot(*self.mesh.vertices[:, :2].T).max())
            return np.array([-far, -far, low[2]]), np.array([far, far, high[2]])
        places = np.einsum("nij,cj->nci", self.courses[self.on][:, :, :3], self.corners)
        places += self.courses[self.on][:, None, :, 3]
        slack = np.max(np.abs(np.diff(places, 2, axis=0)), axis=(0, 1), initial=0.0)
        ends = places.reshape(-1, 3)
        return ends.min(axis=0) - slack, ends.max(axis=0) + slack


def _least_radius(triangles: Floats) -> float:
    """Least distance of triangles in the plane, (m, 3, 2), from the origin, mm; 0 where one holds it."""
    start = triangles
    side = np.roll(triangles, -1, axis=1) - start
    size = np.einsum("mki,mki->mk", side, side)
    along = -np.einsum("mki,mki->mk", start, side) / np.where(size > 0, size, 1.0)
    nearest = start + np.clip(along, 0, 1)[..., None] * side
    cross = start[..., 0] * side[..., 1] - start[..., 1] * side[..., 0]
    inside = np.all(cross > 0, axis=1) | np.all(cross < 0, axis=1)
    return 0.0 if inside.any() else float(np.hypot(nearest[..., 0], nearest[..., 1]).min())


def _apart(a: _Body, b: _Body) -> float:
    """How far both are apart through the whole turn at least, by what holds them, mm; 0 where that does not tell."""
    import shapely

    (low, high), (other_low, other_high) = a.box, b.box
    gaps = np.maximum(0.0, np.maximum(low - other_high, other_low - high))
    (near, far), (other_near, other_far) = a.radii, b.radii
    ring = max(0.0, near - other_far, other_near - far)
    beside = float(shapely.distance(a.plan, b.plan)) if a.rises and b.rises else 0.0
    return max(float(np.linalg.norm(gaps)), math.hypot(ring, float(gaps[2])), beside)


def sweep_in_space(path: Path, machine: SweptMachine) -> tuple[list[Finding], list[Row]]:
    """Read an assembly file, set it in motion: INTERFERENCE findings, and rows (COLUMNS of `assembly`) of the nearest pairs.

    The file shows theta = 0. A file that does not hold just the copies of the machine is a ROUND_TRIP that fails.
    """
    package = read_3mf(path)
    finding = complete(path, package, machine)
    if not finding.ok:
        return [finding], []
    theta = np.linspace(0, math.tau * machine.turns, GRID + 1)
    courses = {
        name: _from_start(machine, theta, name) for name in {mount.body for mount in machine.mounts}
    }
    bodies = [
        _Body(name, item.name, on, item.placed, courses)
        for name, item, on in standing(package, machine)
    ]
    clearances = list(_clearances(bodies, machine, theta))
    findings = interference(clearances, machine.gap - _ROUNDING, machine.angle, machine.turns)
    if not all(math.isfinite(float(np.sum(each))) for each in courses.values()):
        words = "cannot be judged: the machine does not close all the way"
        unknown = at_least("INTERFERENCE", math.nan, machine.gap, "mm", in_file(path), words)
        return [finding, unknown], []
    return [finding, *findings], nearest(clearances)


def _from_start(machine: SweptMachine, theta: Floats, name: str) -> Floats:
    """Where a body is over theta as seen from where it is at theta = 0: transforms (n, 3, 4)."""
    pose = machine.courses(theta)[name]
    angle = np.broadcast_to(np.asarray(pose.angle, float), theta.shape)
    place = np.broadcast_to(np.asarray(pose.place, complex), theta.shape)
    turn = np.zeros((len(theta), 3, 3))
    turn[:, 0, 0] = turn[:, 1, 1] = np.cos(angle)
    turn[:, 1, 0] = np.sin(angle)
    turn[:, 0, 1] = -turn[:, 1, 0]
    turn[:, 2, 2] = 1
    shift = np.column_stack([place.real, place.imag, np.zeros(len(theta))])
    if name in machine.planes:
        origin = machine.planes[name]
        shift += [origin.real, origin.imag, 0]
        stands = np.array([[0, 0, -1.0], [-1, 0, 0], [0, 1, 0]])
        turn = stands @ turn
        shift = shift @ stands.T
    found = np.empty((len(theta), 3, 4))
    found[:, :, :3] = turn @ turn[0].T
    found[:, :, 3] = shift - found[:, :, :3] @ shift[0]
    return found


def _clearances(bodies: list[_Body], machine: SweptMachine, theta: Floats) -> Iterator[Clearance]:
    """Of all pairs; those that touch by intent as they stand."""
    touching = {frozenset(pair) for pair in machine.touching}
    spare = _PRESSED + 4 * machine.tolerance
    for a, b in itertools.combinations(bodies, 2):
        meant = frozenset((a.part, b.part)) in touching
        fixed = a.on == b.on
        if fixed or meant:
            overlap = -_overlap(a, b)
            yield Clearance(
                a.name, b.name, overlap, overlap, 0.0, spare, 1, at_rest=fixed, standing=not fixed
            )
            continue
        apart = _apart(a, b)
        if apart >= machine.gap - _ROUNDING:
            yield Clearance(a.name, b.name, apart, apart, 0.0, None, 0)
            continue
        yield _searched(a, b, machine.gap, theta)


def _overlap(a: _Body, b: _Body) -> float:
    """Mean thickness of what two bodies have in common as they stand, mm."""
    low = np.maximum(a.corners.min(axis=0), b.corners.min(axis=0))
    high = np.minimum(a.corners.max(axis=0), b.corners.max(axis=0))
    if np.any(high <= low):
        return 0.0
    common = a.solid ^ b.solid
    area = common.surface_area()
    return 2 * common.volume() / area if area > 0 else 0.0


def _searched(a: _Body, b: _Body, needed: float, theta: Floats) -> Clearance:
    """Least gap of two bodies, by distances of their meshes."""
    if len(a.mesh.faces) < len(b.mesh.faces):
        a, b = b, a
    home = a.courses[a.on]
    guest = b.courses[b.on]
    back = np.swapaxes(home[:, :, :3], 1, 2)
    relative = np.concatenate(
        [
            back @ guest[:, :, :3],
            back @ (guest[:, :, 3:] - home[:, :, 3:]),
        ],
        axis=2,
    )
    places = np.einsum("nij,cj->nci", relative[:, :, :3], b.corners) + relative[:, None, :, 3]
    steps = np.linalg.norm(np.diff(places, axis=0), axis=2)
    bend = np.linalg.norm(np.diff(places, 2, axis=0), axis=2).max(initial=0.0)
    path = np.append(0.0, np.cumsum(steps.max(axis=1) + 2 * bend))
    seen = math.inf
    proven = math.inf
    at = 0.0
    count = 0
    stretches = [(0.0, float(path[-1]))]
    while stretches and proven >= needed and count < _MOST:
        low, high = stretches.pop()
        k = int(np.argmin(np.abs(path - (low + high) / 2)))
        gap = float(a.solid.min_gap(b.solid.transform(relative[k]), _FAR))
        count += 1
        if gap < seen:
            seen = gap
            at = float(theta[k])
        safe = gap - needed
        if not safe > 0:
            proven = gap
            break
        off = max(0.0, path[k] - high, low - path[k])
        if off > safe - _STILL:  # the grid's nearest angle tells nothing of so short a stretch
            proven = gap - off - (high - low)
            break
        stretches += [
            (start, end)
            for start, end in ((low, path[k] - safe), (path[k] + safe, high))
            if start < end
        ]
    if stretches and proven >= needed:
        proven = math.nan  # too many distances: nothing is proven
    least = float(np.min([seen, proven, needed]))
    return Clearance(a.name, b.name, seen, least, at, None, count)
