"""How far the timing of bodies that pass each other may be off before they strike: a looper's spreader against its needles.

Of each pair one body is moved earlier or later by an angle of the shaft, the other stays; both as designed, at the heights at
which their files are compared. Play lets both come nearer: of each guide half its clearance.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from camgen.geometry.mesh import Mesh, slice_mesh
from camgen.judge.clearance import meeting, signed_distances
from camgen.machine.features import PartPose, Passing
from camgen.machine.model import Slide
from camgen.machines.mechanism import Mechanism
from camgen.numerics import Points
from camgen.parts.solids import solid

_TURN = np.linspace(0.0, math.tau, 721)
_STEPS = [
    math.radians(deg) for deg in (1.0, 2.0, 4.0, 7.0, 11.0, 16.0, 22.0, 29.0, 37.0, 48.0, 60.0)
]  # that are looked at
_HALVES = 10
_SAME = 1e-9  # mm
_COARSE = 0.01  # mm, chord tolerance of the solids


@dataclass(frozen=True)
class Timing:
    """Of a pair: how near it comes, mm; how much earlier and later the first body may be, rad, exact and with play; inf: 60 deg
    and more. play: how much nearer the guides let them come, mm."""

    pair: str
    least: float
    play: float
    exact: tuple[float, float]
    loose: tuple[float, float]


def timings(mechanism: Mechanism) -> list[Timing]:
    """Of all pairs that pass each other; nothing for bodies that keep together."""
    poses = mechanism.assembly.poses(_TURN)
    mounts = {mount.part: mount for mount in mechanism.assembly.mounts}
    pairs = [
        pair
        for pair in mechanism.assembly.passing
        if all(_shifts(poses[name][0]) for name in (pair.a, pair.b))
    ]
    named = {name for pair in pairs for name in (pair.a, pair.b)}
    solids = {
        part.name: solid(part, _COARSE) for part in mechanism.assembly.parts if part.name in named
    }
    found = []
    for pair in pairs:
        areas = [
            meeting(*sections)
            for plane in pair.planes
            if all(sections := _sections(mechanism, pair, solids, plane))
        ]
        play = sum(_play(mechanism, mounts[name].body) for name in (pair.a, pair.b))
        passing = _Passing(
            np.asarray(poses[pair.a][0].place), np.asarray(poses[pair.b][0].place), areas
        )
        if areas and not passing.together:
            exact, loose = ((passing.until(-1, gap), passing.until(1, gap)) for gap in (0.0, play))
            found.append(Timing(pair.name, passing.least(0.0), play, exact, loose))
    return found


def _shifts(pose: PartPose) -> bool:
    """Whether it does not turn: only such bodies are compared."""
    return not np.any(pose.angle) and not pose.flipped


def _sections(
    mechanism: Mechanism, pair: Passing, solids: Mapping[str, Mesh], plane: float
) -> list[list[Points]]:
    """Outlines of both bodies at a height of the ground, of their solids."""
    rest = mechanism.assembly.poses(np.zeros(1))
    sections = []
    for name in (pair.a, pair.b):
        rings = slice_mesh(solids[name], plane - rest[name][0].z)
        sections.append([ring.points for ring in rings if ring.area > 0])
    return sections


def _play(mechanism: Mechanism, body: str) -> float:
    """Half the clearance of a body's guide, mm; that of the spec where the model has none."""
    held = [
        joint
        for joint in mechanism.model.joints
        if isinstance(joint, Slide) and joint.runner.body == body
    ]
    return (
        max((joint.clearance or mechanism.print.slide_clearance for joint in held), default=0.0) / 2
    )


@dataclass(frozen=True)
class _Passing:
    """A pair over the turn: both places at _TURN, (n,) mm, and the shifts at which they meet, by height."""

    a: Points
    b: Points
    areas: Sequence[Any]

    @property
    def together(self) -> bool:
        """Whether both move by the same law: no timing is between them."""
        return float(np.ptp(np.abs(self.a - self.a[0]) - np.abs(self.b - self.b[0]))) < _SAME

    def least(self, off: float) -> float:
        """Least distance over the turn where a is so much later, rad: mm, below 0 an overlap."""
        later = np.mod(_TURN - off, math.tau)
        place = np.interp(later, _TURN, self.a.real) + 1j * np.interp(later, _TURN, self.a.imag)
        return min(
            float(np.min(np.asarray(signed_distances(area, self.b - place), float)))
            for area in self.areas
        )

    def until(self, way: int, gap: float) -> float:
        """By how much a may be earlier (-1) or later (1) until it is as near as the gap, rad; 0 where it is so already."""
        if self.least(0.0) <= gap:
            return 0.0
        steps = [0.0, *_STEPS]
        beyond = next((k for k in range(1, len(steps)) if self.least(way * steps[k]) <= gap), None)
        if beyond is None:
            return math.inf
        low = steps[beyond - 1]
        high = steps[beyond]
        for _ in range(_HALVES):
            middle = (low + high) / 2
            low, high = (middle, high) if self.least(way * middle) > gap else (low, middle)
        return low
