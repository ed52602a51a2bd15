"""A machine run over angles: outputs with their rates, poses, points, forces and play, each worked out when asked for."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from camgen.errors import ArgumentError, Fault, no_such, wrong_order
from camgen.machine.constraints import Constraints
from camgen.machine.forces import Forces, kinetostatics, peaks
from camgen.machine.jets import fill
from camgen.machine.loops import chain_of
from camgen.machine.model import Angle, Cam, Machine, Output, Path, Place, Pose, unit_of
from camgen.machine.state import State
from camgen.numerics import Floats, Points
from camgen.study import Plot, data_frame

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame

# Angles solved at a time: long enough to hide the cost of a call, short enough to stay in the processor's cache.
BLOCK = 16384

T = TypeVar("T")


def solve(
    machine: Machine, theta: ArrayLike, order: int = 2, loaded: Callable[[], Machine] | None = None
) -> Run:
    """The machine at theta, (n,) rad, with derivatives up to the order, 0..2.

    loaded: gives the same machine with what only forces ask for, masses, loads and friction; made when they are asked for.

    nan where it does not close. Raises DesignError where the machine's equations and unknowns do not match.
    """
    if order not in (0, 1, 2):
        raise wrong_order(order, "solve")
    return Run(machine, np.ravel(np.asarray(theta, float)), order, loaded)


@dataclass(frozen=True)
class Play:
    """How far the clearance of each joint, and of all together, can move an output either way, (n,), in its unit.

    First order, each joint at its worst.
    """

    by_joint: Mapping[str, Floats]
    total: Floats

    def __repr__(self) -> str:
        """The greatest alone."""
        return f"Play at {len(self.total)} angles: up to {peaks({'total': self.total, **self.by_joint})}"


class Lazy(Mapping[str, T]):
    """What belongs to some names, each worked out once, when it is asked for; said: of a name, in a line for people."""

    def __init__(
        self,
        names: Iterable[str],
        make: Callable[[str], T],
        said: Callable[[str], str] = lambda name: f"{name}: worked out when asked for",
    ) -> None:
        self._names = tuple(names)
        self._make = make
        self._said = said
        self._made = dict[str, T]()

    def __getitem__(self, name: str) -> T:
        if name not in self._made:
            self._made[name] = self._make(name)
        return self._made[name]

    def __contains__(self, name: object) -> bool:
        return name in self._names

    def get(self, name: str, default: Any = None) -> Any:
        """What belongs to the name, the default where there is no such name."""
        return self[name] if name in self._names else default

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def __repr__(self) -> str:
        return "\n".join(map(self._said, self._names))


def _ranges(parts: Mapping[str, Floats]) -> str:
    """Between what each of some values runs, such as "x 1 to 5, y -2 to 2"; "" where none is finite."""
    return ", ".join(
        f"{axis} {np.nanmin(rows):.6g} to {np.nanmax(rows):.6g}".strip()
        for axis, rows in parts.items()
        if np.isfinite(rows).any()
    )


def _parts(output: Output, values: Floats | Points) -> dict[str, Floats]:
    """An output's values in the unit in which people read them; of a path by its axes."""
    if isinstance(output.of, Path):
        return {"x": values.real, "y": values.imag}
    return {"": unit_of(output)[1] * values.real}


class Run:
    """What a machine does at theta, (n,) rad. run["name"] is an output: rad, mm, or complex mm for a path, (n,).

    `list(run)` are the outputs' names. SpecError for a name that the machine does not have.
    """

    def __init__(
        self,
        machine: Machine,
        theta: Floats,
        order: int,
        loaded: Callable[[], Machine] | None = None,
    ) -> None:
        self.machine = machine
        self.theta = theta
        self.order = order
        self._loaded = loaded
        chain = chain_of(machine)
        self._states = [
            chain.state(theta[k : k + BLOCK], order) for k in range(0, max(theta.size, 1), BLOCK)
        ]
        self._outputs: dict[str, Floats | Points] = {}

    def __iter__(self) -> Iterator[str]:
        return (output.name for output in self.machine.outputs)

    def __contains__(self, name: object) -> bool:
        return name in tuple(self)

    def __repr__(self) -> str:
        """Its angles, and what each output does."""
        if not self.theta.size:
            return "Run at 0 angles"
        sweep = f"{math.degrees(self.theta[0]):.6g} to {math.degrees(self.theta[-1]):.6g} deg"
        return "\n  ".join([f"Run at {self.theta.size} angles, {sweep}", *map(self._said, self)])

    def _said(self, name: str) -> str:
        """An output in a line: between what it moves."""
        output = self.machine.output(name)
        ends = _ranges(_parts(output, self[name]))
        return f"{name}: {ends} {unit_of(output)[0]}" if ends else f"{name}: does not close"

    def __getitem__(self, name: str) -> Floats | Points:
        """An output by its name, (n,); SpecError where there is none."""
        rows: Floats | Points = self.derivatives(name)[0]
        return rows

    def derivatives(self, name: str) -> Floats | Points:
        """An output with its derivatives to theta, (order + 1, n)."""
        if name not in self._outputs:
            output = self.machine.output(name)
            kind = complex if isinstance(output.of, Path) else float
            self._outputs[name] = self._rows(lambda state, into: state.output(output, into), kind)
        return self._outputs[name]

    def _rows(self, fill: Callable[[State, Any], object], kind: type) -> Any:
        """What each state puts into its columns of one array, (order + 1, n)."""
        rows: NDArray[Any] = np.empty((self.order + 1, self.theta.size), kind)
        with np.errstate(all="ignore"):
            for k, state in enumerate(self._states):
                fill(state, rows[:, k * BLOCK : (k + 1) * BLOCK])
        return rows

    @property
    def outputs(self) -> Mapping[str, Floats | Points]:
        """Of each output by name: rad, mm, or complex mm for a path, (n,)."""
        return self._rates(0)

    @property
    def velocity(self) -> Mapping[str, Floats | Points]:
        """Of each output by name: rad/s, mm/s."""
        return self._rates(1)

    @property
    def acceleration(self) -> Mapping[str, Floats | Points]:
        """Of each output by name: rad/s^2, mm/s^2."""
        return self._rates(2)

    def _rates(self, order: int) -> Mapping[str, Floats | Points]:
        """The outputs' time derivatives of one order, by name."""
        self._check(order)

        def rate(name: str) -> Floats | Points:
            rows: Floats | Points = self.derivatives(name)[order]
            return rows * self.machine.speed**order if order else rows

        def said(name: str) -> str:
            """Between what it runs, in the unit of its values."""
            output = self.machine.output(name)
            unit = ("rad" if isinstance(output.of, Angle) else "mm") + ("", "/s", "/s^2")[order]
            rows = rate(name)
            axes: dict[str, Floats] = {"": rows.real}
            if isinstance(output.of, Path):
                axes = {"x": rows.real, "y": rows.imag}
            nothing = "does not close" if rows.size else "no angles"
            ends = _ranges(axes)
            return f"{name}: {ends} {unit}" if ends else f"{name}: {nothing}"

        return Lazy(self, rate, said)

    def _check(self, order: int) -> None:
        """SpecError for an order that is none, or that was not solved."""
        if order not in (0, 1, 2):
            raise wrong_order(order, "run")
        if order > self.order:
            right = f"at most {self.order}, as solved: solve(theta, order={order}) gives it"
            raise ArgumentError([Fault(("order",), str(order), right)], "run")

    def columns(self, order: int = 0) -> dict[str, Floats]:
        """The outputs as motion.csv has them, (n,) each: theta_deg, swing_deg, ram_mm, pen_x_mm, pen_y_mm.

        order: 1 with their velocities, swing_deg_per_s, 2 with their accelerations too, swing_deg_per_s2.
        """
        self._check(order)
        columns = {"theta_deg": np.degrees(self.theta)}
        for each, per in enumerate(("", "_per_s", "_per_s2")[: order + 1]):
            values = self._rates(each)
            for output in self.machine.outputs:
                unit = unit_of(output)[0]
                for axis, rows in _parts(output, values[output.name]).items():
                    columns["_".join(filter(None, (output.name, axis, unit))) + per] = rows
        return columns

    def to_dataframe(self, order: int = 0) -> DataFrame:
        """The columns of motion.csv as a DataFrame of pandas; CamgenError where that is not installed."""
        return data_frame(self.columns(order))

    def pose(self, body: str) -> Pose:
        """A body's frame on the ground: place (n,) complex mm, angle (n,) rad, continuous."""
        self.machine.body(body)
        return Pose(self.point(body, 0j)[0], self.angle(body)[0])

    def point(self, body: str, point: str | complex) -> Points:
        """A body's named point, or a place in its frame (complex mm), with derivatives to theta, (order + 1, n) complex mm."""
        of = self.machine.body(body)
        place = of.at(point) if isinstance(point, str) else Place(body, point)
        return np.asarray(self._rows(lambda state, into: state.point(place, into), complex))

    def length(self, slide: str) -> Floats:
        """Place along a slide or slot with derivatives to theta, (order + 1, n) mm."""
        if slide not in (lengths := self._states[0].lengths):
            raise no_such("slide or slot", slide, list(lengths), "machine")
        return np.asarray(self._rows(lambda state, into: fill(into, state.lengths[slide]), float))

    def angle(self, body: str) -> Floats:
        """A body's angle, continuous, with derivatives to theta, (order + 1, n) rad."""
        self.machine.body(body)
        groups = self._states[0].chain.groups
        rows: Floats = self._rows(
            lambda state, into: fill(into, state.angle(groups.of[body])), float
        )
        rows[0] += groups.excess[body]
        return rows

    def argument(self, cam: Cam) -> Floats:
        """What the law of a cam is asked at, continuous, with derivatives to theta, (order + 1, n): rad, or mm of one that slides."""
        rows = self.angle(cam.cam) if cam.over is None else self.length(cam.over)
        rows[0] -= cam.phase
        return rows

    def poses(self) -> Floats:
        """Poses of all moving bodies, (n, 3 bodies), as `Constraints` has them."""
        rows: Floats = self._poses[0]
        return rows

    @cached_property
    def _system(self) -> Constraints:
        return Constraints(self.machine)

    @cached_property
    def _poses(self) -> Floats:
        """Poses of all moving bodies with derivatives, (order + 1, n, 3 bodies)."""
        rows = np.empty((self.order + 1, self.theta.size, self._system.width))
        for k, body in enumerate(self._system.bodies):
            origin = self.point(body, 0j)
            rows[:, :, 3 * k] = origin.real
            rows[:, :, 3 * k + 1] = origin.imag
            rows[:, :, 3 * k + 2] = self.angle(body)
        return rows

    def forces(self) -> Forces:
        """Reactions, contacts, drives, energy and power at the machine's speed; nan where it has none."""
        self._check(2)
        return self._forces

    @cached_property
    def _forces(self) -> Forces:
        if self._loaded is not None:
            return Run(self._loaded(), self.theta, self.order).forces()
        return self.forces_at(self.machine.speed)

    def forces_at(self, speed: float) -> Forces:
        """Reactions, contacts, drives, energy and power at another speed of theta, rad/s."""
        q, first, second = self._poses
        return kinetostatics(self._system, self.theta, q, first, second, speed)

    def plot(
        self, *outputs: str, order: int = 0, beside: Mapping[str, Run] | None = None
    ) -> Figure:
        """Curves of the outputs, all unless named, over theta below each other, which a notebook shows.

        order: 0 the outputs, 1 their velocities, 2 their accelerations, a second; rad in deg. A path is drawn as it lies in the
        plane, its rates along x and y. beside: other runs by what they are called, such as {"longer rod": run}, drawn in the
        same axes. SpecError for a name that a machine does not have, or an order that was not solved.
        """
        from camgen.plotting import figure_of

        others = {} if beside is None else beside
        if not isinstance(others, Mapping) or not all(isinstance(r, Run) for r in others.values()):
            right = 'runs by what they are called, such as {"longer rod": run}'
            raise ArgumentError([Fault(("beside",), type(beside).__name__, right)], "run.plot")
        plots = []
        for name in outputs or self:
            plot = self._curve(name, order)
            more = [
                (f"{label} {series}" if series != name else label, x, y)
                for label, run in others.items()
                for series, x, y in run._curve(name, order).series
            ]
            plots.append(replace(plot, series=[*plot.series, *more]))
        return figure_of(plots)

    def _curve(self, name: str, order: int) -> Plot:
        """What an output, or a rate of it, is over theta."""
        output = self.machine.output(name)
        values = self._rates(order)[name]
        unit, scale = unit_of(output)
        y_label = unit + ("", "/s", "/s²")[order]
        title = name + ("", ": velocity", ": acceleration")[order]
        theta = np.degrees(self.theta)
        if not isinstance(output.of, Path):
            return Plot(title, "theta, deg", y_label, [(name, theta, scale * values.real)])
        if order == 0:
            return Plot(title, "x, mm", "y, mm", [(name, values.real, values.imag)], equal=True)
        series = [("x", theta, values.real), ("y", theta, values.imag)]
        return Plot(title, "theta, deg", y_label, series)

    def play(self, output: str) -> Play:
        """How far the joints' clearances let the output move."""
        (reach,) = self._system.shares([output], self._poses[0], self.theta)
        by_joint = {j.name: reach[j.name] * (j.clearance / 2) for j in self.machine.joints}
        return Play(by_joint, np.asarray(sum(by_joint.values(), np.zeros(self.theta.size))))
