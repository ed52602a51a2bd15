"""Which joints of a machine rub, and how much: by the bearings that its parts show, and the spec's own coefficients."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from camgen.machine.friction import circle
from camgen.machine.model import Cam, Joint, Machine, Pin, Slide, Slot
from camgen.machines.loads.journals import Journal
from camgen.machines.loads.tables import Weight
from camgen.parts import materials


def coefficient(journal: Journal, load: Weight | None) -> float:
    """Of a pin's bearing: that of a ball bearing, of the spec, or of its materials."""
    if journal.ball:
        return materials.FRICTION_BALL
    if load is not None and load.friction is not None:
        return load.friction
    return materials.FRICTION_STEEL if "steel" in (journal.shaft, journal.hole) else materials.FRICTION_PRINTED


def rough(machine: Machine, journals: Mapping[str, Journal], load: Weight | None) -> Machine:
    """The machine with friction in its pins, as far as their bearings are known, its guides and its cams' contacts."""
    guides = materials.FRICTION_PRINTED if load is None or load.friction is None else load.friction
    touching = 0.0 if load is None else load.contact_friction
    joints: list[Joint] = []
    for joint in machine.joints:
        if isinstance(joint, Pin) and joint.name in journals:
            journal = journals[joint.name]
            radius, mu = journal.diameter / 2, coefficient(journal, load)
            joint = replace(joint, friction=mu * radius if journal.ball else circle(radius, mu))
        elif isinstance(joint, Slide | Slot):
            joint = replace(joint, friction=guides)
        elif isinstance(joint, Cam) and not joint.friction:
            joint = replace(joint, friction=touching)
        joints.append(joint)
    return replace(machine, joints=tuple(joints))
