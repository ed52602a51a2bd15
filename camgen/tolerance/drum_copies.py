"""Printed copies of a cylinder cam: the mesh of its drum with the copy's errors in it, in which the judge rolls the copy's roller.

A wall is off, and waves, along its normal, the bore shifts the whole drum; roller, guide, arm and pivot are off in the roller's
table. Drum and copies have the same facets, which so count for nothing in what a copy differs by.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from camgen.geometry.mesh import Mesh
from camgen.geometry.outlines import circle
from camgen.judge.rolled_drum import RollerTable, roll, roller_table
from camgen.machine.print_errors import Mode
from camgen.machines.cylinder_cam.track import Track
from camgen.numerics import Floats, Points
from camgen.parts.part import drum_part
from camgen.parts.solids import solid
from camgen.tolerance.drums import RING, SIDES

_FACETS = 5e-3  # mm, chord tolerance of the walls: a twentieth of what prints err by
_ON_WALL = 1e-4  # mm, by which the points of a wall may be off it: they are rounded as in a file
_BORE_SHARE = 0.5  # of the floor, for a drum's bore: its walls alone are rolled on
_HARMONICS = 60


@dataclass(frozen=True, eq=False)
class _WallPoints:
    """Which of the mesh's points are on a wall, (m,), their polar angles, (m,) rad, and unit normals into the track, (m, 3)."""

    rows: Any
    angle: Floats
    normal: Floats


@dataclass(frozen=True, eq=False)
class DrumCopies:
    """Copies of a drum by the errors of its modes, rolled at so many even angles from 0 on."""

    track: Track
    modes: Sequence[Mode]
    waves: Sequence[int]
    samples: int
    key: float | None = None  # of a drum in two pieces: half the length of its key's flat, mm

    @cached_property
    def _mesh(self) -> Mesh:
        """Of the drum in one piece."""
        bore = circle(0j, _BORE_SHARE * self.track.floor)
        return solid(drum_part("drum", "", self.track.drum, bore), _FACETS)

    @cached_property
    def _table(self) -> RollerTable:
        return roller_table(self.track.rolled, _FACETS)

    @cached_property
    def _walls(self) -> dict[str, _WallPoints]:
        """Of each wall, by its name in modes."""
        x, y, z = self._mesh.vertices.T
        drum = self.track.drum
        outer = np.flatnonzero(np.hypot(x, y) > drum.floor - _ON_WALL)
        angle = np.arctan2(y, x)[outer]
        walls = {}
        for wall in drum.walls:
            points = wall.over(angle, np.hypot(x, y)[outer])
            on = np.abs(points.z - z[outer]) < _ON_WALL
            radial = points.outward + 1j * -points.along * points.lean / points.rho
            level = radial * np.exp(1j * angle)
            up = np.column_stack([level.real, level.imag, points.lean])
            walls[SIDES[wall.side]] = _WallPoints(outer[on], angle[on], -wall.side * up[on])
        return walls

    def _bump(self, errors: Sequence[float], angle: Floats) -> Floats:
        """How far a wall stands into the track at polar angles: by an offset, and by each wave's cosine and sine."""
        share = 1 / np.sqrt(len(self.waves))
        shapes = [share * wave(k * angle) for k in self.waves for wave in (np.cos, np.sin)]
        return np.asarray(errors @ np.stack([np.ones(len(angle)), *shapes]))

    def _copy(self, given: dict[tuple[str, str], list[float]]) -> Mesh:
        """The mesh of a copy; given: its errors by place and kind, in the order of their modes."""
        points = self._mesh.vertices.copy()
        for name, wall in self._walls.items():
            errors = [*given[name, "offset"], *given[name, "form"]]
            points[wall.rows] += self._bump(errors, wall.angle)[:, None] * wall.normal
        if self.key is not None:
            upper = self._walls[SIDES[1]].rows
            turn = np.exp(1j * given[RING, "key"][0] / self.key)
            plan = (points[upper, 0] + 1j * points[upper, 1]) * turn
            higher = points[upper, 2] + given[RING, "seat"][0]
            points[upper] = np.column_stack([plan.real, plan.imag, higher])
        points[:, :2] += given["drum", "bore"]
        return Mesh(points, self._mesh.faces)

    def _moved(self, errors: Floats) -> Floats:
        """s of one copy, its rest with it, (samples,) mm or rad."""
        given: dict[tuple[str, str], list[float]] = {}
        for mode, error in zip(self.modes, errors, strict=True):
            given.setdefault((mode.where, mode.kind), []).append(float(error))
        told = self._table.model_dump()
        told["inner"] += given["roller", "depth"][0] - given["drum", "radius"][0]
        told["radius"] += given.get(("roller", "tip"), [0.0])[0]
        own = 0.0  # of the follower, for a roller where it is
        if self._table.arm is None or self._table.pivot is None:
            beside, own = given["guide, roller", "centre"]
            told["offset"] = (self._table.offset or 0.0) + beside
        else:
            aside, up = given["pivot, ground", "centre"]
            told["pivot"] = (self._table.pivot[0] + aside, self._table.pivot[1] + up)
            along, across = given["arm, roller", "centre"]
            told["arm"] = self._table.arm + along
            own = across / self._table.arm
        rolled = roll(self._copy(given), RollerTable(**told), _HARMONICS, self.samples)
        return rolled.motion - own

    def outputs(self, errors: Floats) -> Points:
        """s of copies with these errors, (copies, modes) mm, less that of one without, (copies, samples + 1), mm or rad: the end
        of the turn is its beginning."""
        exact = self._moved(np.zeros(len(self.modes)))
        made = np.array([self._moved(each) - exact for each in errors])
        return np.concatenate([made, made[:, :1]], axis=1)
