"""What makes a follower leave its cam sooner in one copy than in another: prints, springs, the friction of its joints.

    print    bends the lift of the cam, above all its second derivative, by which inertia throws the follower off
    spring   rate and preload, each by itself, are off by load.spring_error; weight and loads press as they are
    friction of guides and pins holds the follower back; where nothing presses on the cam, only what spring and weight press
             on them is left

Play does nothing: a follower that is pressed on its cam has none.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from camgen.machine.cams.bounce import Bounce, Contact, contact_of
from camgen.machine.forces import Forces
from camgen.machine.model import Cam, Machine
from camgen.machine.run import solve
from camgen.machines.loads.lift_off import by_force, restitution_of, slow, unsprung
from camgen.machines.loads.rubbing import with_friction
from camgen.machines.loads.tables import Weight
from camgen.machines.loads.weights import with_gravity
from camgen.machines.mechanism import Mechanism
from camgen.numerics import Floats, halved
from camgen.tolerance.spread import Spread

_ROWS = 721
_HALVINGS = 16  # of the speeds between which the follower leaves with friction


@dataclass(frozen=True)
class CopiesBounce:
    """One cam: speeds of the machine, rad/s, from which its follower leaves it, (copies,), and hops at its own speed."""

    cam: str
    slides: bool
    designed: float
    rubbing: float  # as designed, with friction in its joints
    print_alone: Floats
    springs_alone: Floats
    all: Floats
    leaving: Sequence[Bounce]  # of the copies that leave their cam


def bounces(spread: Spread, errors: Floats, seed: int) -> list[CopiesBounce]:
    """Of each cam that is closed by force, and whose follower is one mass on one spring; errors: (copies, modes) mm."""
    mechanism = spread.mechanism
    restitution = restitution_of(mechanism.load)
    speed = mechanism.model.speed
    if restitution is None or not by_force(mechanism.model) or not math.isfinite(speed):
        return []
    machine = with_gravity(mechanism.model, mechanism.load, lambda: mechanism.assembly.solids)
    theta = np.linspace(*mechanism.assembly.cycle.range, _ROWS)
    run = solve(machine, theta)
    still = solve(slow(machine), theta).forces()
    size = (mechanism.load or Weight()).spring_error
    chance = np.random.default_rng(seed)
    found = []
    for cam in by_force(machine):
        contact = contact_of(cam, run, still)
        if contact is None or cam.name not in spread.bends or not 0 < contact.lift_off < math.inf:
            continue
        springs = np.array(_springs(contact, cam, machine, theta, still))
        wound = size * chance.standard_normal((len(errors), 2)) * springs
        printed = [_bent(contact, cam, spread, each) for each in errors]
        copies = [_wound(each, *more) for each, more in zip(printed, wound, strict=True)]
        flown = [each.bounce(speed, restitution) for each in copies if each.lift_off < abs(speed)]
        found.append(
            CopiesBounce(
                cam.name,
                bool(cam.slide),
                contact.lift_off,
                _rubbing(mechanism, machine, cam, theta, contact.lift_off),
                np.array([each.lift_off for each in printed]),
                np.array([_wound(contact, *more).lift_off for more in wound]),
                np.array([each.lift_off for each in copies]),
                flown,
            )
        )
    return found


def _bent(contact: Contact, cam: Cam, spread: Spread, errors: Floats) -> Contact:
    """With the lift of a printed cam."""
    bent = spread.bends[cam.name].by(errors)

    def lift(angle: Floats, order: int) -> Floats:
        own = cam.leaves * contact.sense**order * bent(contact.sense * angle, order)
        return np.asarray(contact.lift(angle, order) + own)

    return replace(contact, lift=lift)


def _springs(
    contact: Contact, cam: Cam, machine: Machine, theta: Floats, still: Forces
) -> tuple[float, float]:
    """Rate and preload on a cam of the machine's springs alone; still: with all loads."""
    rest = solve(slow(unsprung(machine)), theta).forces()
    push = cam.leaves * (still.contacts[cam.name] - rest.contacts[cam.name])
    return contact.springs(theta, push)


def _wound(contact: Contact, rate: float, preload: float) -> Contact:
    """With springs whose rate and preload are so much greater."""
    spring = contact.spring
    own = replace(spring, rate=rate + spring.rate, preload=preload + spring.preload)
    return replace(contact, spring=own)


def _rubbing(
    mechanism: Mechanism, machine: Machine, cam: Cam, theta: Floats, smooth: float
) -> float:
    """Least speed, rad/s, at which the follower leaves its cam with friction in its joints; smooth: without.

    inf where it stays on at twice that speed.
    """
    journals = mechanism.assembly.journals
    run = solve(with_friction(machine, journals, mechanism.load, mechanism.material.name), theta)

    def leaves(speed: float) -> bool:
        effort = run.forces_at(math.copysign(speed, machine.speed)).contacts[cam.name]
        return bool(np.nanmin(cam.leaves * effort) <= 0)

    high = 2 * smooth
    return halved(leaves, 0.0, high, _HALVINGS) if leaves(high) else math.inf
