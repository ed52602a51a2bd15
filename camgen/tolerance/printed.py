"""A printed copy of a machine as bodies on its pins: centres that are off by the print, and by the play of each pin."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from camgen.machine.model import GROUND, Machine, Pin
from camgen.machine.print_errors import Sizes


def printed_copy(machine: Machine, sizes: Sizes, chance: np.random.Generator) -> Machine:
    """The machine with each pin off in both of its bodies, as drawn by chance; pins of driven bodies in the ground stay.

    Both holes are off by the printer's error of a place. A pin lies at the edge of its clearance, in one direction for all of a run,
    each as likely as any other: what turns round as the load does is not followed.
    """
    driven = {drive.body for drive in machine.drives}
    joints = []
    for joint in machine.joints:
        held = isinstance(joint, Pin) and {joint.a.body, joint.b.body} <= {GROUND, *driven}
        if not isinstance(joint, Pin) or held:
            joints.append(joint)
            continue
        across, up, other_across, other_up = sizes.place * chance.standard_normal(4)
        play = joint.clearance / 2 * np.exp(1j * math.tau * chance.random())
        a = replace(joint.a, at=joint.a.at + complex(across, up) + complex(play))
        b = replace(joint.b, at=joint.b.at + complex(other_across, other_up))
        joints.append(replace(joint, a=a, b=b))
    return replace(machine, joints=tuple(joints))
