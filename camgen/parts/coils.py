"""Extension springs on the pins of a machine: how the sweep, the report and the order of assembly see them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from camgen.machine.features import Courses, StandIn
from camgen.machine.joining import Module
from camgen.machine.model import Place, Pose
from camgen.numerics import Floats, Points
from camgen.study import Sketch

_TURNS = 8  # that are drawn
_ENDS = 0.15  # of its length, of each straight end


@dataclass(frozen=True)
class Coil:
    """An extension spring on two pins."""

    name: str  # as a sketch
    title: str  # for people
    ends: tuple[Place, Place]  # middles of the pins
    points: tuple[str, str]  # names of these places
    diameter: float  # outside, mm
    eyes: tuple[float, float]  # underside and upper side, mm
    heads: tuple[str, ...]  # copies of heads and caps over its eyes, such as "cap-1-2"
    capped: bool  # whether one of them is a cap
    reach: tuple[float, float] | None = (
        None  # mm from either end, between which the sweep sees it; None: it does not
    )

    @property
    def height(self) -> float:
        """Of its middle line, mm."""
        return sum(self.eyes) / 2

    @property
    def stringing(self) -> str:
        """How it is put on its pins."""
        where = f"points {' and '.join(self.points)}"
        if self.capped:
            return f"{self.title}, eyes on the pins at {where}, before their caps: over these they do not go"
        return f"{self.title}, eyes over the holes at {where}: the pins go in through them, for their heads are wider"

    def stand_ins(self) -> list[StandIn]:
        """Two bars from beside the heads to its middle, where it is longest; the eyes are left out."""
        if self.reach is None or self.reach[1] <= self.reach[0]:
            return []
        start, end = self.reach
        low = self.height - self.diameter / 2
        bar = (complex(start), complex(end), self.diameter / 2, low, low + self.diameter)
        return [StandIn(name, name, (), bars=(bar,), whole=self.name) for name in self.halves]

    @property
    def halves(self) -> tuple[str, str]:
        """Bodies that lie along it, from either end."""
        return f"{self.name} 1", f"{self.name} 2"

    def renamed(self, module: Module) -> Coil:
        """It in the machine of which its own is a module."""
        low, high = self.eyes
        return replace(
            self,
            name=module.part(self.name),
            title=f"{self.title} of {module.prefix}",
            ends=(module.place(self.ends[0]), module.place(self.ends[1])),
            eyes=(low + module.z, high + module.z),
            heads=tuple(map(module.part, self.heads)),
        )


def with_ends(courses: Courses, coils: Sequence[Coil]) -> Courses:
    """Courses of the bodies, and of both ends of each spring that the sweep sees, which lie along it."""
    visible = [coil for coil in coils if coil.reach is not None]
    if not visible:
        return courses

    def found(theta: Floats) -> dict[str, Pose]:
        poses = dict(courses(theta))
        for coil in visible:
            one, other = (_place(poses, end) for end in coil.ends)
            for half, near_end, far_end in zip(
                coil.halves, (one, other), (other, one), strict=True
            ):
                poses[half] = Pose(near_end, np.unwrap(np.angle(far_end - near_end)))
        return poses

    return found


def spring_sketches(coils: Sequence[Coil], courses: Courses) -> list[Sketch]:
    """Springs as the report draws them: a zigzag between both pins, which stretches as the machine moves."""
    return [
        Sketch(each.name, course=partial(_zigzag, courses, each), z=each.height) for each in coils
    ]


def _zigzag(courses: Courses, coil: Coil, theta: Floats) -> Points:
    """The line at theta, (n,) rad: (n, k) complex mm on the ground."""
    poses = courses(theta)
    a, b = (np.broadcast_to(_place(poses, end), theta.shape) for end in coil.ends)
    along = np.concatenate([[0.0], np.linspace(_ENDS, 1 - _ENDS, 2 * _TURNS), [1.0]])
    side = np.array([0.0, 0.0, *np.tile([1.0, -1.0], _TURNS - 1), 0.0, 0.0])
    way = (b - a)[:, None]
    return np.asarray(
        a[:, None] + way * along + 1j * (coil.diameter / 2) * side * way / np.abs(way)
    )


def _place(poses: Mapping[str, Pose], end: Place) -> Points:
    """Where a pin is, (n,) complex mm."""
    pose = poses[end.body]
    return np.asarray(pose.place + np.exp(1j * pose.angle) * end.at)
