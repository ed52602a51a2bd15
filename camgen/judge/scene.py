"""The judge of a machine in motion as a viewer shows it: every copy of every part where it is at each moment."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from camgen.errors import counted
from camgen.files.gltf import read_glb
from camgen.findings import Finding, at_most, in_file
from camgen.geometry.rings import Floats, Points
from camgen.numerics import magnitude
from camgen.tolerances import FLOAT32_ROUNDING

if TYPE_CHECKING:
    from camgen.files.gltf import Course

_STEPS = 8  # float32 roundings of a place and, through quaternions, of a turn


@dataclass(frozen=True, eq=False)
class Flight:
    """Where a copy of a part is to be: angle (n,) rad and place (n,) complex mm at even times, the end as the beginning, nan
    where the machine cannot go; z: height, mm; flipped: turned over about its own y axis first, within its thickness, mm;
    upright: first stood up, y as -z and z as y; standing: all this in a plane that stands, its x as -y, y as z, z as -x.

    reach: of the part's farthest point from its origin, mm.
    """

    part: str
    angle: Floats
    place: Points
    z: float
    flipped: bool
    thickness: float
    reach: float
    upright: bool = False
    standing: bool = False

    @property
    def transforms(self) -> Floats:
        """The same as (n, 3, 4)."""
        cosine = np.cos(self.angle)
        sine = np.sin(self.angle)
        zero = 0 * self.angle
        ones = 1 + 0 * self.angle
        side, height = (-1, self.z + self.thickness) if self.flipped else (1, self.z)
        x = side * cosine, side * sine, zero
        y = -sine, cosine, zero
        z = zero, zero, side * ones
        if self.upright:
            y = z
            z = (sine, -cosine, zero)
        place = self.place.real, self.place.imag, height * ones
        rows = [each for row in zip(x, y, z, place, strict=True) for each in row]
        found = np.stack(rows, axis=1).reshape(-1, 3, 4)
        return _stood(found) if self.standing else found


def _stood(transforms: Floats) -> Floats:
    """Transforms (n, 3, 4) in a plane that stands as those in space."""
    x, y, z = np.moveaxis(transforms, 1, 0)
    return np.stack([-z, -x, y], axis=1)


def judge_scene(
    path: Path,
    flights: Mapping[str, Flight],
    seconds: float,
    down: tuple[float, float, float] = (0.0, 0.0, -1.0),
) -> Finding:
    """ROUND_TRIP of a GLB: how far a point of a copy is out of its place, mm, at any frame of an animation of so many seconds.

    down: which way is down, a unit vector.
    """
    copies = [
        (copy, part, course, transform)
        for course in read_glb(path, down)
        for copy, part, transform in course.copies
    ]
    if sorted((copy, part) for copy, part, *_ in copies) != sorted(
        (copy, each.part) for copy, each in flights.items()
    ):
        remark = f"{len(copies)} copies, which are not the {len(flights)} of the machine"
        return at_most("ROUND_TRIP", math.nan, 0, "mm", in_file(path), remark)
    rows = [
        (*_off(course, transform, flights[copy], seconds), copy)
        for copy, _, course, transform in copies
    ]
    off, limit, copy = max(rows, key=lambda row: row[0] / row[1])
    remark = f"{counted(len(rows), 'copy', 'copies')} in place throughout the animation"
    return at_most("ROUND_TRIP", off, limit, "mm", replace(in_file(path), part=copy), remark)


def _off(course: Course, transform: Floats, flight: Flight, seconds: float) -> tuple[float, float]:
    """How far a copy's points are out of their places, and may be, mm; inf where its body moves at other times."""
    frames = len(flight.angle)
    size = flight.reach + float(np.nanmax(np.abs(flight.place), initial=abs(flight.z)))
    limit = _STEPS * FLOAT32_ROUNDING * (size + magnitude(course.place))
    even = len(course.angle) == frames and np.allclose(
        course.seconds, np.linspace(0, seconds, frames), rtol=1e-6
    )
    if len(course.angle) > 1 and not even:
        return math.inf, limit
    turn = np.zeros((len(course.angle), 3, 3))
    turn[:, 0, 0] = turn[:, 1, 1] = np.cos(course.angle)
    turn[:, 1, 0] = np.sin(course.angle)
    turn[:, 0, 1] = -turn[:, 1, 0]
    turn[:, 2, 2] = 1
    transforms = np.einsum("nij,jk->nik", turn, transform)
    transforms[:, :2, 3] += np.column_stack([course.place.real, course.place.imag])
    if course.standing:
        transforms = _stood(transforms)
    error = np.abs(transforms - flight.transforms)
    off = np.max(error[..., 3], axis=1) + flight.reach * np.max(error[..., :3], axis=(1, 2))
    return float(np.nanmax(off, initial=0.0)), limit
