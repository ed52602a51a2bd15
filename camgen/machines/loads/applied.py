"""[[load.on]]: what a person says acts on the machine besides its own weight and springs, over theta.

on an output   value along it as it grows, by virtual work: N on a way, N m on an angle; thread tension on a length of thread
on a body      a force on a point of it, in the ground's axes or turning with it; or a torque, where no point is given
its value      constant, or from a table over theta; "along" it acts the way that it moves, below 0 it resists
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from camgen.errors import Fault, Key, SpecError
from camgen.machine.model import Along, Angle, Effort, Function, Machine, Path, Place
from camgen.numerics import Floats
from camgen.spec import Coordinate, Record, quantity, unknown

_Size = Annotated[float, quantity("N or N m", ge=-1e6, le=1e6)]
_Turn = Annotated[float, quantity("deg", ge=-36000, le=36000)]
_Word = Annotated[str, Field(min_length=1, max_length=60)]


class Applied(Record):
    """A load on an output, on a point of a body, or a torque on a body."""

    name: _Word | None = Field(
        default=None, description="name of the load; default: load with its number"
    )
    output: _Word | None = Field(
        default=None,
        description="output on which the load acts: a place, an angle or a path; or give body, and a "
        "point of it",
    )
    body: _Word | None = Field(
        default=None,
        description="in place of output: body on which the load acts; without a point it is a torque",
    )
    point: _Word | tuple[Coordinate, Coordinate] | None = Field(
        default=None,
        description="where on the body it acts: a named point, or x, y in the body's frame",
    )
    value: _Size | None = Field(
        default=None,
        description="constant value, above 0 in the direction in which the output grows; or points = [[0, 0], [90, -0.1], [270, 0]], or a "
        "file",
    )
    points: (
        Annotated[tuple[tuple[_Turn, _Size], ...], Field(min_length=2, max_length=100_000)] | None
    ) = Field(
        default=None,
        description="in place of value: rows of theta, deg, and value; linear between, 0 outside",
        json_schema_extra={"unit": "N or N m"},
    )
    file: _Word | None = Field(
        default=None,
        description="in place of points: a text file beside the spec with the same rows",
    )
    unit: Literal["N", "N m"] | None = Field(
        default=None, description="unit of the values; a file's heading says it"
    )
    source: _Word | None = Field(default=None, description="where the values come from")
    direction_deg: _Turn | None = Field(
        default=None, description="direction of a force on a point or path, from the x axis"
    )
    acts: Literal["fixed", "with the body", "along"] = Field(
        default="fixed",
        description='"fixed": in the ground\'s axes; "with the body": turns with it; direction_deg is the '
        'direction of both\n"along": in the direction of motion, below 0 a brake',
    )

    @model_validator(mode="after")
    def _whole(self) -> Self:
        wrong = []
        if (self.output is None) == (self.body is None):
            wrong.append("either output or body, on which the load acts")
        if self.point is not None and self.body is None:
            wrong.append("body as well: the body that has this point")
        if sum(each is not None for each in (self.value, self.points, self.file)) != 1:
            wrong.append("one of value, points and file: how large the load is")
        if self.points is not None:
            degrees = [row[0] for row in self.points]
            for k, (before, here) in enumerate(pairwise(degrees), 1):
                if not before < here:
                    wrong.append(
                        f"rows with growing angles: row {k} has {here:g} deg after {before:g}"
                    )
                    break
            else:
                span = degrees[-1] - degrees[0]
                if span > 360 + 1e-9:
                    wrong.append(f"points within one turn: they span {span:g} deg")
        aimed = self.direction_deg is not None
        if aimed and (self.acts == "along" or (self.body is not None and self.point is None)):
            wrong.append("no direction_deg: the motion, or the torque, gives the direction")
        on_point = self.body is not None and self.point is not None
        if on_point and self.acts != "along" and not aimed:
            wrong.append('direction_deg: the direction of the force; or acts = "along"')
        if self.acts == "with the body" and self.point is None:
            wrong.append(
                'acts = "with the body" with a point: a direction that turns with its body'
            )
        if wrong:
            raise ValueError("; ".join(wrong))
        return self


@dataclass(frozen=True)
class Table:
    """A load over theta: linear between its rows (rad, value), 0 before the first and after the last; a turn repeats itself."""

    theta: tuple[float, ...]
    values: tuple[float, ...]

    def __call__(self, theta: Floats, order: int = 0) -> Floats:
        """At theta, (n,) rad."""
        if len(self.theta) == 1:
            return np.full(np.shape(theta), self.values[0] if order == 0 else 0.0)
        first = self.theta[0]
        last = self.theta[-1]
        angle = np.asarray(theta, float)
        within = first + np.mod(angle - first, math.tau)
        if last >= first + math.tau - 1e-12:  # a turn's end
            within = np.where((angle > first) & (within == first), last, within)
        return np.asarray(np.interp(within, self.theta, self.values, right=0.0))

    def jumps(self, name: str) -> list[str]:
        """A sentence where it jumps from one turn to the next, or from 0 and to 0 outside its rows."""
        first = self.values[0]
        last = self.values[-1]
        begin = math.degrees(self.theta[0])
        end = math.degrees(self.theta[-1])
        if end - begin > 360 - 1e-6:
            if first == last:
                return []
            return [
                f"Load {name} jumps at {begin % 360:g} deg: its table ends with {last:g} and begins with {first:g}."
            ]
        steps = []
        if first:
            steps.append(f"at {begin % 360:g} deg from 0 to {first:g}")
        if last:
            steps.append(f"at {end % 360:g} deg from {last:g} to 0")
        return [f"Load {name} jumps {' and '.join(steps)}: outside its rows it is 0."] * bool(steps)


def efforts(loads: Sequence[Applied], machine: Machine) -> tuple[Effort, ...]:
    """Loads of a spec on a model of it; SpecError with all that is on what is not there."""
    made: list[Effort] = []
    faults: list[Fault] = []
    names = {getattr(load, "name", "") for load in machine.loads}
    for k, each in enumerate(loads):
        path = ("load", "on", k)
        count = len(faults)
        name = each.name or f"load {k + 1}"
        if name in names:
            faults.append(Fault((*path, "name"), repr(name), "a name of its own"))
        names.add(name)
        of = _measure(each, machine, path, faults)
        if each.file is not None:
            right = "read beside a spec file; tables of Python have points"
            faults.append(Fault((*path, "file"), repr(each.file), right))
        if of is None or len(faults) > count:
            continue
        unit, what = ("N m", "an angle") if isinstance(of, Angle) else ("N", "a way")
        if each.unit not in (None, unit):
            faults.append(Fault((*path, "unit"), repr(each.unit), f"{unit} on {what}"))
        degrees = each.direction_deg
        direction = (*path, "direction_deg")
        if isinstance(of, Path) and each.acts != "along" and degrees is None:
            right = 'missing: the direction of the force; or acts = "along"'
            faults.append(Fault(direction, "", right))
        if not isinstance(of, Path) and degrees is not None:
            right = "no value here: the output already has a direction"
            faults.append(Fault(direction, f"{degrees:g}", right))
        rows = each.points or ((0.0, each.value or 0.0),)
        law = Table(tuple(math.radians(deg) for deg, _ in rows), tuple(value for _, value in rows))
        way = cmath.rect(1.0, math.radians(degrees or 0.0))
        made.append(Effort(name, of, law, way, each.acts == "with the body", each.acts == "along"))
    if faults:
        raise SpecError(faults)
    return tuple(made)


def jumps(machine: Machine) -> list[str]:
    """What to know of tables over theta that do not end as they begin: from turn to turn such a load jumps."""
    return [
        sentence
        for load in machine.loads
        if isinstance(load, Effort) and isinstance(load.law, Table) and len(load.law.theta) > 1
        for sentence in load.law.jumps(load.name)
    ]


def _measure(
    each: Applied, machine: Machine, path: Key, faults: list[Fault]
) -> Angle | Along | Path | Function | None:
    """What a load acts on; None with a fault where there is no such thing."""
    if each.output is not None:
        outputs = {output.name: output.of for output in machine.outputs}
        if each.output not in outputs:
            faults.append(unknown((*path, "output"), each.output, outputs))
        return outputs.get(each.output)
    bodies = {body.name: body for body in machine.moving}
    if each.body not in bodies:
        faults.append(unknown((*path, "body"), each.body, bodies))
        return None
    body = bodies[each.body]
    if each.point is None:
        return Angle(body.name)
    if isinstance(each.point, tuple):
        return Path(Place(body.name, complex(*each.point)))
    if each.point not in body.points:
        faults.append(unknown((*path, "point"), each.point, body.points))
        return None
    return Path(body.at(each.point))
