"""A point that two motors lead along a line: the angles that they turn by, from the point.

led        the machine seen from its point: carriages along x and y carry it along the line, and both motors are let go. It is closed
           as any machine is, on the branch that is drawn; what its driven links turn by is what the motors have to turn by
stretched  an arm and its rod in line: the point is at the edge of what they reach, and a motor cannot hold its speed (inverse
           singularity). The machine as it is driven folds elsewhere, where both rods are in line (direct singularity)
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationError

from camgen.errors import Fault, listed
from camgen.findings import Finding, Where
from camgen.machine import freedom
from camgen.machine import model as m
from camgen.machine.loops import chain_of
from camgen.machine.model import GROUND
from camgen.machine.programs import TableLaw
from camgen.machine.reach import determinant, folds
from camgen.machine.run import Run, solve
from camgen.machine.state import Dyad
from camgen.machine.stepwise import closed_by_dyads
from camgen.machines.linkage.drawing import Drawing
from camgen.machines.linkage.figures import fold_margin
from camgen.machines.linkage.motors import refuse_open
from camgen.machines.linkage.tables import Pen
from camgen.motion.pen import pen_motion
from camgen.numerics import Floats, Points
from camgen.spec import unknown
from camgen.study import Plot

_OF_TOLERANCE = 0.9  # that the pen's motion takes; files and facets leave the rest
_CARRIAGES = "pen x", "pen y"
_RANK = 6  # digits of places that are written
_GRID = 121  # places each way of the picture of the reach
_WIDE = 2.2  # of the longest lever, half of that picture
_FOLDED = 0.05  # sine of the transmission angle below which a place is shown as one


def filled(data: Any) -> Any:
    """The tables of a spec in which an output of the pen's point is judged by its line."""
    if not isinstance(data, dict) or "pen" not in data:
        return data
    pen = data["pen"]
    rows = data.get("output")
    if not isinstance(pen, dict) or not isinstance(rows, list | tuple):
        return data
    try:
        known = Pen.model_validate(pen, strict=False)  # lists as well
    except ValidationError:
        return data
    line = known.closed
    mine = [row for row in rows if isinstance(row, dict) and row.get("point") == known.point]
    if line is None or any("path" in row for row in mine):
        return data
    closed = np.append(line, line[0])
    places = tuple((round(z.real, _RANK), round(z.imag, _RANK)) for z in closed.tolist())
    path = {"path": {"at": places, "tolerance": known.tolerance}}
    if not mine:
        return {**data, "output": (*rows, {"name": "pen", "point": known.point, **path})}
    return {**data, "output": tuple({**row, **path} if row is mine[0] else row for row in rows)}


def faults(pen: Pen, drawing: Drawing) -> Iterator[Fault]:
    """What is wrong with it beside the other tables."""
    moving = [
        point
        for point in drawing.points
        if any(point in held for link, held in drawing.links.items() if link != GROUND)
        and point not in drawing.links.get(GROUND, ())
    ]
    if pen.point not in drawing.points:
        yield unknown(("pen", "point"), pen.point, drawing.points)
    elif pen.point not in moving:
        yield Fault(("pen", "point"), repr(pen.point), f"a point that moves: {', '.join(moving)}")
    yield from pen.faults(drawing.drives)


@lru_cache(maxsize=8)
def _motion(pen: Pen) -> Points:
    """Places of the pen at even theta of a period, (n,) complex mm."""
    line = pen.closed
    assert line is not None, "a fault of the spec"
    return pen_motion(line, _OF_TOLERANCE * pen.tolerance, pen.corners)


def led(chain: m.Machine, pen: Pen) -> m.Machine:
    """The chain with the laws of its two motors, and as it stands at theta = 0, the pen at the line's beginning.

    chain: closed as drawn. DesignError where the line is out of reach, or led through a fold.
    """
    seen = carried(chain, pen)
    _refuse_far(seen, pen)
    places = _motion(pen)
    theta = np.linspace(0, math.tau, len(places) + 1)
    run = solve(seen, theta, 0)
    drives = []
    for drive in chain.drives:
        angle = run.angle(drive.body)[0]
        advance = math.tau * round((angle[-1] - angle[0]) / math.tau)
        drives.append(replace(drive, law=TableLaw(angle[:-1], advance)))
    start = {
        body.name: m.Pose(
            complex(run.pose(body.name).place[0]), float(run.pose(body.name).angle[0])
        )
        for body in chain.moving
    }
    found = replace(chain, drives=tuple(drives), start=start)
    refuse_open(found)
    return found


def _refuse_far(seen: m.Machine, pen: Pen) -> None:
    """DesignError where the machine, seen from its point, does not close along the line, or folds."""
    remedy = "draw the line elsewhere or smaller (pen.at, pen.width), or make the links longer"
    refuse_open(seen, f"{pen.point} is led out of reach", remedy)


def stretches(chain: m.Machine, pen: Pen, least_deg: float) -> list[Finding]:
    """TRANSMISSION_ANGLE seen from the pen: how near each arm and its rod come to one line, where no motor can hold its speed.

    chain: as it is led. It is the angle between both, or its supplement.
    """
    return [
        fold_margin(
            fold,
            least_deg,
            Where(f"{listed('joint', fold.joints)}, seen from the pen"),
            "least along the line; at 0 an arm and its rod are stretched, and the pen is at the edge of its reach",
        )
        for fold in folds(carried(chain, pen))
    ]


def reach_of(chain: m.Machine, pen: Pen) -> Plot:
    """Where the pen can be led with its arms on the sides that they have, the line, and where the rods are in line.

    chain: as it is led. A grid of places, each closed from the pen, then from the motors' angles.
    """
    line = _motion(pen)
    middle = complex(line.real.mean(), line.imag.mean())
    size = max(
        abs(place.at)
        for joint in chain.joints
        if isinstance(joint, m.Pin)
        for place in (joint.a, joint.b)
    )
    across = np.linspace(-_WIDE * size, _WIDE * size, _GRID)
    places = (middle + across[None, :] + 1j * across[:, None]).ravel()
    index = np.arange(places.size, dtype=float)
    seen = carried(chain, pen)
    ways = (places.real, places.imag)
    drives = tuple(
        replace(drive, law=_Listed(values)) for drive, values in zip(seen.drives, ways, strict=True)
    )
    run = solve(replace(seen, drives=drives), index, 0)
    with np.errstate(all="ignore"):
        turned = [_Listed(_direction(run, drive.body)) for drive in chain.drives]
        led_on = replace(
            chain,
            drives=tuple(replace(d, law=law) for d, law in zip(chain.drives, turned, strict=True)),
        )
        steps = chain_of(led_on)
        least = np.full(places.size, np.inf)
        for number, step in enumerate(steps.steps):
            if isinstance(step, Dyad):
                least = np.fmin(least, np.abs(determinant(steps, number, index)))
    open_ = ~np.isfinite(turned[0].values + turned[1].values)
    reached = ~open_.reshape(_GRID, _GRID)
    edge = reached & ~_inner(reached)
    folded = reached & (least.reshape(_GRID, _GRID) < _FOLDED)
    grid = places.reshape(_GRID, _GRID)
    series = [
        ("edge of the reach", grid[edge].real, grid[edge].imag),
        ("rods in line", grid[folded].real, grid[folded].imag),
        ("line", line.real, line.imag),
    ]
    series = [each for each in series if each[1].size]
    dots = [name for name, *_ in series if name != "line"]
    return Plot("Reach of the pen", "x, mm", "y, mm", series, equal=True, dots=dots)


def _direction(run: Run, body: str) -> Floats:
    """A body's angle at each place by itself, rad, whichever way the places are passed."""
    return np.asarray(np.angle(run.point(body, 1 + 0j)[0] - run.point(body, 0j)[0]), float)


def _inner(reached: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Places of a grid whose four neighbours are reached too, as far as the grid goes."""
    wide = np.pad(reached, 1, constant_values=True)
    return np.asarray(wide[:-2, 1:-1] & wide[2:, 1:-1] & wide[1:-1, :-2] & wide[1:-1, 2:])


@dataclass(frozen=True, eq=False)
class _Listed:
    """Values by their number, in place of a law: theta counts them."""

    values: Floats

    def __call__(self, theta: Floats, order: int = 0) -> Floats:
        """Those of the nearest numbers, (n,)."""
        if order:
            return np.zeros(np.shape(theta))
        number = np.clip(np.rint(theta).astype(int), 0, len(self.values) - 1)
        return np.asarray(self.values[number], float)


def carried(chain: m.Machine, pen: Pen) -> m.Machine:
    """The machine whose point carriages lead along the line, its motors let go, closed where the line begins."""
    places = _motion(pen)
    body = next(each for each in chain.moving if pen.point in each.points)
    pose = chain.start_of(body.name)
    at = complex(pose.place + np.exp(1j * pose.angle) * body.points[pen.point])
    across, along = _CARRIAGES
    ground = m.Place(GROUND)
    joints = (
        m.Slide(across, ground, m.Place(across)),
        m.Slide(along, m.Place(across), m.Place(along), math.pi / 2),
        m.Pin(f"pen at {pen.point}", m.Place(along), body.at(pen.point)),
    )
    start = {
        **chain.start,
        across: m.Pose(complex(at.real), 0.0),
        along: m.Pose(at, 0.0),
    }
    drives = (
        m.Drive(f"{across} drive", across, TableLaw(places.real), across),
        m.Drive(f"{along} drive", along, TableLaw(places.imag), along),
    )
    machine = m.Machine(
        (*chain.bodies, m.Body(across), m.Body(along)),
        (*chain.joints, *joints),
        drives,
        start,
        speed=chain.speed,
    )
    closed = closed_by_dyads(machine)
    if closed is not None:
        return closed
    _refuse_far(machine, pen)
    return freedom.close_drawing(machine)
