"""Springs as the report draws them: a zigzag between the pins of their eyes, which stretches as the machine moves."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial

import numpy as np

from camgen.machine.model import Pose
from camgen.machines.linkage.layout import Layout
from camgen.numerics import Floats, Points
from camgen.study import Sketch

_TURNS = 8  # that are drawn
_ENDS = 0.15  # of its length, of each straight end

Courses = Callable[[Floats], Mapping[str, Pose]]  # poses of a machine's bodies at theta, (n,) rad
End = tuple[str, complex]  # body, and place in its frame, mm


def sketches(layout: Layout, courses: Courses) -> tuple[Sketch, ...]:
    """Of each spring of a layout."""
    found = []
    for name, spring in layout.springs.items():
        one, other = (
            (layout.carrier(link), layout.at(link, point)) for link, point in (spring.a, spring.b)
        )
        course = partial(_zigzag, courses, one, other, spring.diameter / 2)
        found.append(Sketch(name, course=course, z=sum(layout.eye(name)) / 2))
    return tuple(found)


def _zigzag(courses: Courses, one: End, other: End, radius: float, theta: Floats) -> Points:
    """The line at theta, (n,) rad: (n, k) complex mm on the ground."""
    poses = courses(theta)
    a, b = (
        np.broadcast_to(poses[body].place + np.exp(1j * poses[body].angle) * at, theta.shape)
        for body, at in (one, other)
    )
    along = np.concatenate([[0.0], np.linspace(_ENDS, 1 - _ENDS, 2 * _TURNS), [1.0]])
    side = np.array([0.0, 0.0, *np.tile([1.0, -1.0], _TURNS - 1), 0.0, 0.0])
    way = (b - a)[:, None]
    return np.asarray(a[:, None] + way * along + 1j * radius * side * way / np.abs(way))
