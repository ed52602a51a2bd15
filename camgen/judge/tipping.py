"""TIPPING: by how much the table may lean until a machine on its stand falls over, weighed from the solids of the assembly as written.

The machine stands on all corners that lie lowest; about the edges of their hull it tips. Over the turn the centre of mass must lie
inside: with its height h over the table and its distance d from an edge it tips at atan(d / h). Bought things weigh nothing here.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from camgen.files.threemf import read_3mf
from camgen.findings import Finding, at_least, in_file
from camgen.judge.assembly import standing
from camgen.judge.balance import first_moment
from camgen.machine.features import SweptMachine

LEAST_DEG = 10.0  # by which the table may lean at least
_LOWEST = 0.01  # mm, over the lowest corner, that counts as on the table
_SAMPLES = 720  # of the turn
_STEADY = 1e-6  # mm, by which a stand is at least wide


@dataclass(frozen=True)
class Standing:
    """What the judge needs to know of a machine that stands: which way is down, a unit vector, and densities of parts."""

    down: tuple[float, float, float]
    densities: Mapping[str, float]  # g/mm^3, 0 of what is bought
    unweighed: str = "what is bought"  # as people call it


def judge_tipping(path: Path, machine: SweptMachine, stands: Standing) -> Finding:
    """The assembly's file, which shows theta = 0, through the turn."""
    import shapely

    down = np.array(stands.down)
    across = np.linalg.svd(down[None])[2][1:]  # two unit vectors along the table
    phase = np.linspace(0, math.tau, _SAMPLES, endpoint=False)
    courses = machine.courses(phase)
    start = machine.courses(np.zeros(1))
    mass = 0.0
    moment = np.zeros((_SAMPLES, 3))
    corners = []
    for _, item, body in standing(read_3mf(path), machine):
        corners.append(item.placed.vertices)
        volume, first = first_moment(item.placed)
        weight = stands.densities[item.name]
        mass += weight * volume
        pose = courses[body]
        home = complex(start[body].place[0])
        way = np.exp(1j * (pose.angle - float(start[body].angle[0])))
        flat = volume * pose.place + way * (complex(first[0], first[1]) - volume * home)
        high = np.full(_SAMPLES, first[2])
        columns = [np.broadcast_to(each, _SAMPLES) for each in (flat.real, flat.imag, high)]
        moment += weight * np.column_stack(columns)
    centre = moment / mass
    every = np.concatenate(corners)
    low = float((every @ down).max())
    feet = every[every @ down > low - _LOWEST] @ across.T
    base = shapely.MultiPoint(feet).convex_hull
    points = shapely.points(centre @ across.T)
    inside = np.where(shapely.covers(base, points), 1.0, -1.0)
    rim = base.exterior if base.area > _STEADY else base
    off = inside * shapely.distance(rim, points)
    lean = np.degrees(np.arctan2(off, low - centre @ down))
    k = int(np.argmin(lean))
    remark = (
        f"the centre of mass of {mass:.4g} g stays {off[k]:z.1f} mm inside the edge of its stand, {low - float(centre[k] @ down):z.1f} mm "
        f"over the table, at {math.degrees(phase[k]):z.0f} deg; without {stands.unweighed}"
    )
    return at_least("TIPPING", float(lean[k]), LEAST_DEG, "deg", in_file(path), remark)
