"""Which joints of a machine rub, and how much: by the bearings that its parts show, and the spec's own coefficients."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from camgen.machine.friction import circle
from camgen.machine.model import Cam, Joint, Machine, Pin, Slide, Slot
from camgen.machine.run import solve
from camgen.machines.loads.tables import Weight
from camgen.numerics import Floats
from camgen.parts import materials
from camgen.parts.journals import Journal

_STEP = 0.005  # of a coefficient of friction


def coefficient(journal: Journal, load: Weight | None) -> float:
    """Of a pin's bearing: that of a ball bearing, of the spec, of a slot, or of its materials."""
    if journal.ball:
        return materials.FRICTION_BALL
    if journal.slot or (load is not None and load.friction is not None):
        return guide(load, journal.hole)
    return materials.friction_of(journal.shaft, journal.hole)


def guide(load: Weight | None, own: str) -> float:
    """Of slides and slots: that of the spec, or of the machine's own material on itself."""
    return (
        materials.friction_of(own, own) if load is None or load.friction is None else load.friction
    )


def with_friction(
    machine: Machine, journals: Mapping[str, Journal], load: Weight | None, own: str
) -> Machine:
    """The machine with friction in its pins, as far as their bearings are known, its guides and its cams' contacts.

    own: the material that it is made of.
    """
    guides = guide(load, own)
    touching = 0.0 if load is None else load.contact_friction
    joints: list[Joint] = []
    for joint in machine.joints:
        if isinstance(joint, Pin) and joint.name in journals:
            journal = journals[joint.name]
            radius = journal.diameter / 2
            mu = coefficient(journal, load)
            joint = replace(joint, friction=mu * radius if journal.ball else circle(radius, mu))
        elif isinstance(joint, Slide | Slot):
            joint = replace(joint, friction=guides)
        elif isinstance(joint, Cam) and not joint.friction:
            joint = replace(joint, friction=touching)
        joints.append(joint)
    return replace(machine, joints=tuple(joints))


def locking_friction(
    machine: Machine, journals: Mapping[str, Journal], load: Weight | None, own: str, theta: Floats
) -> str:
    """Of a machine that friction locks somewhere at theta, (n,) rad: with which coefficients, and which it would bear."""
    used = {coefficient(journal, load) for journal in journals.values() if not journal.ball}
    if any(isinstance(joint, Slide | Slot) for joint in machine.joints):
        used.add(guide(load, own))
    low = 0.0
    high = max(used)
    while high - low > _STEP:
        mu = (low + high) / 2
        trial = (load or Weight()).model_copy(update={"friction": mu})
        locks = solve(with_friction(machine, journals, trial, own), theta).forces().locks
        low, high = (low, mu) if np.any(locks) else (mu, high)
    given = load is not None and load.friction is not None
    by = "load.friction" if given else "usual for its materials"
    ends = " to ".join(f"{mu:g}" for mu in dict.fromkeys((min(used), max(used))))
    most = math.floor(low * 100) / 100
    turns = f"it would turn with up to {most:g} in all joints"
    if not most:
        turns = "even 0.01 in all joints would lock it"
    return f"the machine locks at a friction of {ends} ({by}); {turns}"
