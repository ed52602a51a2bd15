"""Extension springs on the pins of a machine: how the sweep, the report and the order of assembly see them."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
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
    # of either end, copies of heads and caps over its eye, such as "cap-1-2"
    heads: tuple[tuple[str, ...], tuple[str, ...]]
    capped: bool  # whether one of them is a cap
    reach: tuple[float, float] | None = (
        None  # mm from either end, between which the sweep sees it; None: it does not
    )

    @property
    def height(self) -> float:
        """Of its middle line, mm."""
        return sum(self.eyes) / 2

    def stringing(self, length: float) -> str:
        """How it is put on its pins, which are so far apart then, mm."""
        where = f"points {' and '.join(self.points)}"
        apart = f"{length:.4g} mm from pin to pin"
        if self.capped:
            return f"{self.title}, eyes on the pins at {where}, before their caps: over these they do not go; {apart}"
        return (
            f"{self.title}, eyes over the holes at {where}: the pins go in through them, for their heads are wider; "
            f"{apart}"
        )

    def through(self, coming: Collection[str], before: Collection[str], length: float) -> str:
        """What is said of pins that come through its eyes from above, "" of others; before: copies that are there."""
        comes, there = (
            [bool(set(end) & set(copies)) for end in self.heads] for copies in (coming, before)
        )
        if self.capped or not any(comes):
            return ""
        if all(comes):
            return f"through both eyes of the {self._called}, stretched to {length:.4g} mm"
        if any(there):
            return f"through the other eye of the {self._called}: stretch it to {length:.4g} mm"
        return f"through an eye of the {self._called}"

    @property
    def _called(self) -> str:
        return self.title[0].lower() + self.title[1:]

    def length(self, poses: Mapping[str, Pose]) -> float:
        """From pin to pin, mm, at the first angle of the poses."""
        a, b = (complex(_place(poses, end)[0]) for end in self.ends)
        return abs(b - a)

    def wire(self, poses: Mapping[str, Pose]) -> Floats:
        """The line of its wire at the first angle of the poses, (n, 3) mm: an eye round each pin, legs, and coils."""
        a, b = (complex(_place(poses, end)[0]) for end in self.ends)
        way = (b - a) / abs(b - a)
        radius = self.diameter / 2
        round_ = np.linspace(0, 2 * np.pi, 25)
        eye = radius * np.exp(1j * round_)
        turn = np.linspace(0, 2 * np.pi * _TURNS, 16 * _TURNS + 1)
        swell = np.minimum(
            1, np.minimum(turn, turn[::-1]) / np.pi
        )  # from the axis out to the coils
        along = _ENDS + (1 - 2 * _ENDS) * turn / turn[-1]
        coils = a + (b - a) * along + 1j * way * radius * swell * np.cos(turn)
        flat = np.concatenate([a + way * eye, coils, b - way * eye])
        level = np.zeros(len(eye))
        height = self.height + np.concatenate([level, radius * swell * np.sin(turn), level])
        return np.column_stack([flat.real, flat.imag, height])

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
            heads=(
                tuple(map(module.part, self.heads[0])),
                tuple(map(module.part, self.heads[1])),
            ),
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
