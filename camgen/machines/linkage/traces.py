"""Where a linkage's points go while a hand moves them: nothing is checked, and the drawing is not closed first."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence, Set
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import combinations
from typing import NamedTuple

import numpy as np

from camgen.errors import DesignError
from camgen.geometry.facets import facet_contour
from camgen.machine.model import GROUND
from camgen.machine.run import solve
from camgen.machines.linkage import motors, pens
from camgen.machines.linkage.drawn_machine import DrawnMachine
from camgen.machines.linkage.mechanism import Linkage
from camgen.numerics import Floats, Points, magnitude

_SEEN = 0.05  # mm, that an outline on a screen may be off
COUNT = 73  # angles of a turn, both ends included: a path is smooth to the eye


class Apex(NamedTuple):
    """A point that two others and its distances from them place, on the side where it is drawn."""

    point: str
    a: str
    b: str


Places = Mapping[str, tuple[float, float]]
Lengths = Mapping[str, float]


def angles(linkage: Linkage, count: int = COUNT) -> Floats:
    """Angles of the driven link from its drawn one, (count,) rad: a turn, its range, or what its program runs through; of several
    motors a period."""
    if len(linkage.drives) > 1:
        return np.linspace(0, math.tau, count)
    program = linkage.drive.program()
    if program is not None:
        return np.asarray(program(np.linspace(0, math.tau, count)))
    return np.radians(np.linspace(*(linkage.drive.range_deg or (0.0, 360.0)), count))


def traces(
    linkage: Linkage, theta: Floats, points: Places | None = None, lengths: Lengths | None = None
) -> dict[str, Points]:
    """Place of each point at these angles, (n,) complex mm; nan where the machine does not close.

    theta: (n,) rad; points, lengths: in place of those of the spec, mm. The branch is that of the drawn places.
    Raises DesignError where the joints hold too much or too little, or the pen of two motors is out of reach.
    """
    drawing = linkage.diagram
    if points is not None:
        drawing = replace(drawing, points=points)
    if lengths is not None:
        drawing = replace(drawing, lengths=lengths)
    chain = DrawnMachine(drawing).rough
    pen = linkage.pen
    machine = motors.moved(chain, linkage.drives) if pen is None else pens.led(chain, pen)
    run = solve(machine, theta, 0)
    return {
        point: np.full(theta.shape, body.points[point])
        if body.name == GROUND
        else run.point(body.name, point)[0]
        for body in reversed(machine.bodies)
        for point in body.points
    }


def apexes(linkage: Linkage) -> list[Apex] | None:
    """Points in the order in which circles about two placed ones give each, those of the ground and of the driven link first.

    None where this does not place all of them, or where [lengths] and drawing have to be balanced in the shape of a link.
    """
    joints = (linkage.slides, linkage.slots, linkage.gears, linkage.cams, linkage.freewheels)
    if (
        any(joints)
        or len(linkage.drives) > 1
        or not all(_is_plain(linkage, name) for name in linkage.links)
    ):
        return None
    rest = dict(linkage.links)
    ground = rest.pop(GROUND)
    driven = rest.pop(linkage.drive.link)
    if len(set(ground) & set(driven)) != 1:
        return None
    placed = {*ground, *driven}
    steps = []
    while rest:
        dyad = _dyad(rest, placed)
        if dyad is None:
            return None
        links, step = dyad
        steps.append(step)
        placed.add(step.point)
        for name in links:
            points = rest.pop(name)
            a, b = (point for point in points if point in placed)
            steps += [Apex(point, a, b) for point in points if point not in placed]
            placed.update(points)
    return steps


def _is_plain(linkage: Linkage, name: str) -> bool:
    """Whether a link is as it is drawn, or its lengths alone say what it is."""
    points = linkage.links[name]
    given = len(linkage.diagram.lengths_of(points))
    return not given or len(points) == 2 or len(points) == 3 == given


def _dyad(
    links: Mapping[str, Sequence[str]], placed: Set[str]
) -> tuple[tuple[str, str], Apex] | None:
    """Two links, each with one placed point, and the pin that they share; None where there are none."""
    ends = {name: [point for point in points if point in placed] for name, points in links.items()}
    for first, second in combinations(links, 2):
        shared = [point for point in links[first] if point in links[second]]
        if len(ends[first]) == len(ends[second]) == len(shared) == 1:
            a, b, point = *ends[first], *ends[second], *shared
            if len({a, b, point}) == 3:
                return (first, second), Apex(point, a, b)
    return None


def idle(linkage: Linkage) -> list[str]:
    """Coordinates of [points] that change nothing, "B.0" its x: lengths and the branch decide where the point is."""
    theta = np.append(0.0, angles(linkage, 9)[:-1])
    measured = {name.strip() for pair in linkage.lengths for name in pair.split("-")}
    before = traces(linkage, theta)
    size = max(abs(z).max() for z in before.values())
    found = []
    for name in (name for name in linkage.points if name in measured):
        for axis in (0, 1):
            place = list(linkage.points[name])
            place[axis] += 1e-3 * size
            after = traces(linkage, theta, {**linkage.points, name: (place[0], place[1])})
            moved = max(magnitude(after[each] - before[each]) for each in before)
            if moved <= 1e-9 * size:
                found.append(f"{name}.{axis}")
    return found


@dataclass(frozen=True)
class CamShape:
    """A cam as it lies at theta = 0."""

    link: str
    pivot: str
    outline: Points  # (n,) about its axis, mm, the first place not repeated
    turns: float  # for one of the driven link


def cam_shapes(linkage: Linkage) -> list[CamShape]:
    """The cams to be seen; none of those that cannot be made as they are drawn."""
    drawing = linkage.diagram
    shapes = []
    for cam in linkage.cams:
        with suppress(DesignError, ValueError):
            pivot = drawing.pivot(cam.cam)
            assert pivot is not None, "drawing_faults has looked"
            shapes.append(
                CamShape(
                    cam.cam,
                    pivot,
                    facet_contour(linkage.drawn.disc(cam).outline, _SEEN),
                    drawing.turns_of(cam.cam) or 1.0,
                )
            )
    return shapes
