"""A machine's bodies with the masses of what is made of them: solids by their material; what a spec says itself stays."""

from __future__ import annotations

import cmath
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from camgen.machine.model import GROUND, MM, Body, Gravity, Machine
from camgen.machines.loads.tables import Weight
from camgen.parts.inertia import Solids

PULL = 9.80665  # m/s^2
_SAME = 1e-6  # share by which a mass may differ and be the solids'


@dataclass(frozen=True)
class Masses:
    """A machine with its masses."""

    machine: Machine
    sources: Mapping[str, str]  # where they come from, by body


def with_masses(model: Machine, solids: Solids, load: Weight | None) -> Masses:
    """The model with the masses of its solids where the spec gives none, and with gravity where [load] has it.

    A body whose inertia about its own origin is given, such as a follower's about its pivot, keeps that; only its mass and
    centre, which load its pivot, come from the solid.
    """
    bodies: list[Body] = []
    sources: dict[str, str] = {}
    for body in model.bodies:
        if body.name == GROUND:
            bodies.append(body)
            continue
        own = solids.body(body)
        source = "given"
        if not own.mass:
            own = body
            if not (body.mass or body.inertia):
                source = "none: camgen makes no part of it"
        elif body.mass:
            if abs(body.mass - own.mass) <= _SAME * own.mass:
                source = "solids"
            own = body
        elif not body.inertia:
            source = "solids"
        else:
            rest = body.inertia - own.mass * abs(own.centre * MM) ** 2
            if rest >= 0 or gravity(load):  # a weight counts, even where a little inertia does not
                own = replace(own, inertia=max(rest, 0.0))
                source = "inertia given, mass of the solids"
            else:
                own = body
                source = "inertia given"
        bodies.append(own)
        sources[body.name] = source
    loads = model.loads
    if not any(isinstance(load, Gravity) for load in loads):
        loads = (*loads, *gravity(load))
    return Masses(replace(model, bodies=tuple(bodies), loads=loads), sources)


def gravity(load: Weight | None) -> tuple[Gravity, ...]:
    """Gravity of [load]; none where it says nothing of it."""
    deg = None if load is None else load.gravity_deg
    return () if deg is None else (Gravity(cmath.rect(PULL, cmath.pi * deg / 180)),)


def with_gravity(model: Machine, load: Weight | None, solids: Callable[[], Solids]) -> Machine:
    """The model as it is, or where [load] has gravity with it and with the masses of the solids, made only for that."""
    return with_masses(model, solids(), load).machine if gravity(load) else model
