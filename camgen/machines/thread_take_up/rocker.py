"""The source's claim against the usual take-up: a crank-rocker of the same feed beside its two cranks.

The source prints no lengths of the crank-rocker that it compares with (37 mm of excess, 190 N at C, twice the wear). This one was
searched for: all lengths, the eye and the guides free, so that it feeds as much and its excess over the same consumption is the
least (differential evolution over ten sizes). Its links are as heavy by length as those of the two cranks.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from camgen.machine.landmarks import TURN
from camgen.machine.model import Body, Floats
from camgen.machines.thread_take_up.feed import TakeUp
from camgen.study import Figure, Figures, Table

ROCKER = TakeUp(
    19.28, 37.91, 47.13, 47.29, 56.8, 2.01, 1, (-24.83 + 43.7j, -62.62 + 157.23j)
)  # mm, rad: found by that search for a feed of 82.2 mm
ANGLES = np.linspace(0, TURN, 720, endpoint=False)


def least_excess(t: TakeUp, consumption: Floats) -> float:
    """Greatest supply less consumption, mm, the stitch timed as is best and nowhere short; consumption: at 720 even angles."""
    supply = t.supply(ANGLES)
    found = []
    for each in (supply, supply[::-1]):  # the crank may turn either way
        spare = np.array([np.roll(each, k) - consumption for k in range(len(ANGLES))])
        found.append(float((spare.max(axis=1) - np.minimum(spare.min(axis=1), 0.0)).min()))
    return min(found)


def alike(t: TakeUp, other: TakeUp, bodies: Mapping[str, Body]) -> dict[str, Body]:
    """Links of the other take-up, as heavy by length as those of this one, their centres and inertias to scale."""

    def scaled(name: str, share: float) -> Body:
        mine = bodies[name]
        yours = other.links[name]
        return replace(
            yours,
            mass=mine.mass * share,
            centre=mine.centre * share,
            inertia=mine.inertia * share**3,
        )

    coupler = (other.coupler + other.eye_distance) / (t.coupler + t.eye_distance)
    output = scaled("output", other.output / t.output)
    return {"crank": other.links["crank"], "coupler": scaled("coupler", coupler), "output": output}


def against(
    t: TakeUp, bodies: Mapping[str, Body], speed: float, consumption: Floats | None
) -> tuple[Figures, Table]:
    """Figures and a table of the two; speed: of the crank, rad/s; consumption: at 720 even angles, mm, None where not known."""
    pair = (t, bodies), (ROCKER, alike(t, ROCKER, bodies))
    figures: list[dict[str, float]] = []
    for each, masses in pair:
        forces = each.forces(ANGLES, masses, speed)
        wear = each.wear(ANGLES, forces, speed)
        figures.append(
            {
                "feed, mm": each.diagram.range,
                "let down to pulled up": max(each.diagram.ratio, 1 / each.diagram.ratio),
                "least excess, mm": math.nan
                if consumption is None
                else least_excess(each, consumption),
                "greatest reaction at C, N": float(np.nanmax(np.abs(forces.reactions["C"]))),
                "mean wear measure of A, B, C, N rad/s": sum(wear.values()) / 3,
            }
        )
    two, one = figures
    said = {
        "least excess, mm": "7 and 37",
        "greatest reaction at C, N": "120 and 190",
        "mean wear measure of A, B, C, N rad/s": "more than twice",
    }
    rows = [(name, two[name], one[name], one[name] / two[name], said.get(name, "")) for name in two]
    found = [
        Figure("rocker excess", one["least excess, mm"], "mm"),
        Figure("rocker reaction {joint}", one["greatest reaction at C, N"], "N", joint="C"),
        Figure("rocker wear", one["mean wear measure of A, B, C, N rad/s"], "N rad/s"),
    ]
    numbers = Figures(each for each in found if not math.isnan(each.value))
    columns = ("", "two cranks", "crank-rocker", "ratio", "the source's")
    return numbers, Table(
        "Two cranks against a crank-rocker of the same feed, found by a search", columns, rows
    )
