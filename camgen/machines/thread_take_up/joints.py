"""The take-up as a machine: bodies and joints, and on what of its parts these are measured."""

from __future__ import annotations

import cmath
from collections.abc import Sequence
from typing import TYPE_CHECKING

from camgen.machine.features import Eye, Feature, Mark, Mount, PinEyes
from camgen.machine.model import GROUND

if TYPE_CHECKING:
    from camgen.machines.thread_take_up.mechanism import ThreadTakeUp


LINKS = {"input-crank": "crank", "bell-crank": "coupler", "output-crank": "output"}  # part -> body


def features_of(spec: ThreadTakeUp) -> Sequence[Feature]:
    """Pins O, A, B and C; the eye and the guides, between which the thread is the output."""
    g, p, slide, press = spec.geometry, spec.making, spec.print.slide_clearance, spec.print.press_clearance
    shaft, turning, pressed, ring = p.shaft_diameter, p.pin_diameter + slide, p.pin_diameter + press, 2 * spec.bodies.bearing
    return (
        PinEyes(
            "O", Eye("pivot", complex(-g.frame), shaft + slide), Eye("input-crank", 0j, shaft + press),
            Eye("shaft", 0j, shaft, True),
        ),
        PinEyes(
            "A", Eye("input-crank", complex(g.input_crank), pressed), Eye("bell-crank", 0j, turning),
            Eye("pin-a", 0j, p.pin_diameter, True),
        ),
        PinEyes(
            "B", Eye("output-crank", complex(g.output_crank), pressed), Eye("bell-crank", complex(g.coupler), turning),
            Eye("pin-b", 0j, p.pin_diameter, True),
        ),
        PinEyes("C", Eye("pivot", 0j, ring, True), Eye("output-crank", 0j, ring + slide)),
        Mark(Eye("bell-crank", spec.take_up.eye, p.finger_diameter + press)),
        *(Mark(Eye("frame", guide, p.guide_diameter + press)) for guide in spec.take_up.guides),
    )  # fmt: skip


def mounts_of(spec: ThreadTakeUp) -> Sequence[Mount]:
    """Every part on its body, a level for each layer, without a counterweight."""
    t, p, level = spec.take_up, spec.making, spec.bodies.level
    dowels = [t.pivot + cmath.exp(1j * t.tilt) * place for place in spec.bodies.dowels]
    return (
        Mount("frame", GROUND), Mount("pivot", GROUND, t.pivot, t.tilt, z=p.thickness), Mount("output-crank", "output", z=level),
        Mount("input-crank", "crank", z=2 * level), Mount("bell-crank", "coupler", z=3 * level),
        Mount("shaft", "crank", z=-p.shaft_length), Mount("collar", "crank", z=-level),
        Mount("pin-a", "crank", complex(t.crank), flipped=True, z=2 * level),
        Mount("pin-b", "output", complex(t.output), flipped=True, z=level), *(Mount("dowel", GROUND, z) for z in dowels),
        Mount("finger", "coupler", t.eye, flipped=True, z=3 * level),
        *(Mount("guide", GROUND, z, flipped=True) for z in t.guides),
    )  # fmt: skip
