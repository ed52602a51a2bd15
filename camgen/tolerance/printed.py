"""A printed copy of a machine as bodies on its pins: centres that are off by the print, and by the play of each pin."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from camgen.machine.model import GROUND, Machine, Pin
from camgen.machine.print_errors import Sizes


def misplaced(machine: Machine, sizes: Sizes, chance: np.random.Generator) -> Machine:
    """The machine with each hole and pin off by the printer's error of a place, as drawn by chance."""

    def off(pin: Pin) -> Pin:
        across, up, other_across, other_up = sizes.place * chance.standard_normal(4)
        a = replace(pin.a, at=pin.a.at + complex(across, up))
        return replace(pin, a=a, b=replace(pin.b, at=pin.b.at + complex(other_across, other_up)))

    return _with_pins(machine, off)


def loose(machine: Machine, chance: np.random.Generator) -> Machine:
    """The machine with each pin at the edge of its clearance, in one direction for all of a run, each as likely as any other.

    What turns round as the load does is not followed.
    """

    def off(pin: Pin) -> Pin:
        play = pin.clearance / 2 * np.exp(1j * math.tau * chance.random())
        return replace(pin, a=replace(pin.a, at=pin.a.at + complex(play)))

    return _with_pins(machine, off)


def _with_pins(machine: Machine, off: Callable[[Pin], Pin]) -> Machine:
    """The machine with other pins; those of driven bodies in the ground stay."""
    driven = {drive.body for drive in machine.drives}
    joints = tuple(
        off(joint)
        if isinstance(joint, Pin) and not {joint.a.body, joint.b.body} <= {GROUND, *driven}
        else joint
        for joint in machine.joints
    )
    return replace(machine, joints=joints)
