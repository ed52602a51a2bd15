"""FLOOR_CLEARANCE: how far all but its feet stays over the floor under a machine that walks, by the assembly as written.

The floor is level and touches the lowest foot at each angle of the turn. What ends in a sole counts as a foot, whole.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from camgen.files.threemf import read_3mf
from camgen.findings import Finding, at_least, in_file
from camgen.judge.assembly import standing
from camgen.machine.features import SweptMachine
from camgen.machine.model import Pose
from camgen.numerics import Floats, Points

LEAST = 2.0  # mm, that all else keeps from the floor
_SAMPLES = 720  # of the turn


def judge_floor(
    path: Path,
    machine: SweptMachine,
    down: tuple[float, float, float],
    feet: frozenset[str],
) -> Finding:
    """The assembly's file, which shows theta = 0, through the turn; down: a unit vector across z; feet: names of parts."""
    phase = np.linspace(0, math.tau, _SAMPLES, endpoint=False)
    courses = machine.courses(phase)
    way = complex(down[0], down[1])
    floor = np.full(_SAMPLES, -np.inf)
    depths = defaultdict[str, Floats](lambda: np.full(_SAMPLES, -np.inf))
    for name, part, body, corners, radius in _things(path, machine):
        depth = radius + _depth(courses[body], corners, way)
        if part in feet:
            floor = np.maximum(floor, depth)
        else:
            depths[name] = np.maximum(depths[name], depth)
    name = min(depths, key=lambda each: float(np.min(floor - depths[each])))
    room = floor - depths[name]
    k = int(np.argmin(room))
    remark = f"{name} over the floor under the lowest foot, at {math.degrees(phase[k]):z.0f} deg"
    return at_least("FLOOR_CLEARANCE", float(room[k]), LEAST, "mm", in_file(path), remark)


def _things(path: Path, machine: SweptMachine) -> Iterator[tuple[str, str, str, Points, float]]:
    """Name, part, body, corners in its axes, complex mm, and what lies round these, mm, of all copies and stand-ins."""
    import shapely

    start = machine.courses(np.zeros(1))
    for name, item, body in standing(read_3mf(path), machine):
        rim = shapely.MultiPoint(item.placed.vertices[:, :2]).convex_hull
        x, y = shapely.get_coordinates(rim).T
        home = complex(np.asarray(start[body].place).flat[0])
        back = np.exp(-1j * float(np.asarray(start[body].angle).flat[0]))
        yield name, item.name, body, (x + 1j * y - home) * back, 0.0
    for thing in machine.stand_ins:
        for at, radius, *_ in thing.discs:
            yield thing.name, "", thing.body, np.array([at]), radius
        for a, b, radius, *_ in thing.bars:
            yield thing.name, "", thing.body, np.array([a, b]), radius


def _depth(pose: Pose, corners: Points, way: complex) -> Floats:
    """How far a body reaches along a direction, (n,) mm."""
    turn = np.exp(1j * np.asarray(pose.angle, float)) * np.conj(way)
    reach = np.real(np.multiply.outer(corners, turn)).max(axis=0)
    return np.asarray(reach + np.real(np.conj(way) * pose.place), float) + np.zeros(_SAMPLES)
