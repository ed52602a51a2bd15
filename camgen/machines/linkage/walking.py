"""How a machine with [walk] walks if it goes slowly: figures of the quasi-static walk, as a range over friction."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from camgen.machine.model import GROUND, MM, Machine
from camgen.machine.run import solve
from camgen.machine.slow_walk import SlowWalk, slow_walk
from camgen.machines.linkage.tables import Walk
from camgen.machines.loads.weights import PULL
from camgen.numerics import Points
from camgen.parts.inertia import Solids
from camgen.study import Figure, Figures, Plot, Study

_ANGLES = 1441
_SAID = (
    "Walk: so slow that inertia does nothing, in the plane, on points as feet. With equal friction of all feet the distance does not "
    "depend on it; the range is that of feet which differ within walk.friction. The distance is a lower estimate. "
    "The drive's torque is that of legs in the air; on the floor it is more: see camgen simulate."
)


def study(
    machine: Machine, solids: Solids, walk: Walk, feet: Sequence[str], down: complex
) -> Study:
    """Way, tilt, rise, slip and support over a turn of the shaft; feet: outputs, of all sides; down: a unit complex.

    machine: with the masses of its bodies.
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
        return Study(
            notes=["No walk is given: no mass of the machine is known, or it does not close."]
        )
    found = slow_walk(up * places, up * moment / mass, up * shaft)
    if not isinstance(found, SlowWalk):
        deg = math.degrees(theta[found])
        said = f"The walker falls at crank angle {deg:.1f} deg: its centre of mass lies beyond its feet."
        return Study(Figures([Figure("walk falls at", deg, "deg")]), notes=[said])
    least, greatest = found.way_between(min(walk.friction), max(walk.friction))
    work = mass * PULL * found.slip * MM
    tilt = np.degrees(found.tilt)
    figures = [
        Figure("walk way", found.way, "mm"),
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
