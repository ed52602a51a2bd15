"""How a machine with [walk] walks if it goes slowly: figures of the quasi-static walk, and the loads of the floor on its feet."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from camgen.machine.model import GROUND, MM, Effort, Machine
from camgen.machine.run import solve
from camgen.machine.slow_walk import SlowWalk, slow_walk
from camgen.machines.linkage.tables import Walk
from camgen.machines.loads.weights import PULL
from camgen.numerics import Floats, Points
from camgen.parts.inertia import Solids
from camgen.study import Figure, Figures, Plot, Study

_ANGLES = 1441
_SAID = (
    "The walk is calculated in the plane, with points as feet, and so slowly that inertia does not matter. If all feet have the same friction, the "
    "distance does not depend on it; the range is for feet whose frictions differ within walk.friction. The distance is a lower "
    "estimate. Drive, pins and bearings bear the machine's weight, on the feet on which it stands at each angle; the foot that slips "
    "rubs with the middle walk.friction."
)


@dataclass(frozen=True)
class Standing:
    """How a machine stands on its feet over a turn of the shaft, and what the floor presses them with."""

    machine: Machine  # with the masses of its bodies
    walk: Walk
    feet: Sequence[str]  # outputs, of all sides
    up: complex  # turns a place in the machine's axes into one whose y is up
    theta: Floats  # (n,) rad, in the order of turning
    mass: float  # kg, with the payload
    found: SlowWalk | int  # or the row at which it falls

    @property
    def floor(self) -> tuple[Effort, ...]:
        """Forces of the floor on each foot, N in the machine's axes: its share of the weight, and what rubs where one slips."""
        if not isinstance(self.found, SlowWalk):
            return ()
        weight = self.mass * PULL
        frictions = sorted(self.walk.friction)
        rubbing = frictions[len(frictions) // 2] * self.found.rubbing
        rows = np.arange(self.theta.size)
        force = np.zeros((len(self.feet), self.theta.size), complex)
        for k, pair in enumerate(self.found.pair):
            force[pair, rows] = weight * (rubbing[k] + 1j * self.found.shares[k])
        force *= np.exp(-1j * self.found.tilt) / self.up
        places = {output.name: output.of for output in self.machine.outputs}
        sense = slice(None, None, 1 if self.theta[-1] > self.theta[0] else -1)
        return tuple(
            Effort(
                f"floor on {foot}, {axis}",
                places[foot],
                FloorLaw(self.theta[sense], part[sense]),
                way,
            )
            for foot, own in zip(self.feet, force, strict=True)
            for axis, way, part in (("x", 1 + 0j, own.real), ("y", 1j, own.imag))
            if np.any(part)
        )


@dataclass(frozen=True, eq=False)
class FloorLaw:
    """A force over a turn, linear between its rows: growing angles, (n,) rad, and values, (n,) N."""

    theta: Floats
    values: Floats

    def __call__(self, theta: Floats, order: int = 0) -> Floats:
        """At theta, (n,) rad."""
        return np.asarray(np.interp(theta, self.theta, self.values, period=math.tau))


def standing(
    machine: Machine, solids: Solids, walk: Walk, feet: Sequence[str], down: complex
) -> Standing | None:
    """How it stands on its feet; None where no mass of it is known, or it does not close.

    machine: with the masses of its bodies; feet: outputs, of all sides; down: a unit complex.
    """
    theta = np.linspace(0, math.tau, _ANGLES)[:: 1 if machine.speed >= 0 else -1]
    run = solve(machine, theta, 0)
    up = 1j / -down
    shaft = complex(run.pose(machine.drives[0].body).place[0])
    bodies = [*machine.moving, solids.body(machine.body(GROUND))]
    mass = walk.payload_g / 1e3
    at = shaft if walk.payload_at is None else complex(*walk.payload_at)
    moment: Points = np.full(theta.size, mass * at)
    for body in bodies:
        centre = body.centre if body.name == GROUND else run.point(body.name, body.centre)[0]
        moment = moment + body.mass * centre
        mass += body.mass
    places = np.stack([np.asarray(run[name], complex) for name in feet])
    if not mass or not np.all(np.isfinite(places)):
        return None
    found = slow_walk(up * places, up * moment / mass, up * shaft)
    return Standing(machine, walk, feet, up, theta, mass, found)


def study(standing: Standing | None) -> Study:
    """Way, tilt, rise, slip and support over a turn of the shaft."""
    if standing is None:
        return Study(
            notes=[
                "camgen gives no walk: it knows no mass of the machine, or the machine does not close."
            ]
        )
    walk = standing.walk
    theta = standing.theta
    found = standing.found
    if not isinstance(found, SlowWalk):
        deg = math.degrees(theta[found])
        said = f"The walker falls at crank angle {deg:.1f} deg: its centre of mass lies beyond its feet."
        return Study(Figures([Figure("walk falls at", deg, "deg")]), notes=[said])
    least, greatest = found.way_between(min(walk.friction), max(walk.friction))
    work = standing.mass * PULL * found.slip * MM
    tilt = np.degrees(found.tilt)
    figures = [
        Figure("walk way", found.way, "mm"),
        Figure("walk speed", found.way * abs(standing.machine.speed) / math.tau, "mm/s"),
        Figure("walk way least", least, "mm"),
        Figure("walk way greatest", greatest, "mm"),
        Figure("walk tilt least", float(np.min(tilt)), "deg"),
        Figure("walk tilt greatest", float(np.max(tilt)), "deg"),
        Figure("walk rise", float(np.ptp(found.height)), "mm"),
        Figure("walk slip", found.slip, "mm"),
        Figure("walk slip work least", min(walk.friction) * work, "J"),
        Figure("walk slip work greatest", max(walk.friction) * work, "J"),
        Figure("walk least support", found.least_share),
    ]
    degrees = np.degrees(theta)
    plots = [
        Plot("Walk: tilt of the frame", "crank angle, deg", "deg", [("tilt", degrees, tilt)]),
        Plot(
            "Walk: height of the shaft",
            "crank angle, deg",
            "mm",
            [("height", degrees, found.height)],
        ),
    ]
    return Study(Figures(figures), plots, notes=[_SAID])
