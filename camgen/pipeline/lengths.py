"""How much shorter than drawn rods and shanks of pins of metal are made, so that none stands out of what it goes through.

What moves past the end of a shaft or a pin is a gap away from the part with which that end is flush. This part lies lower where those under
it are as thin as their sheets let them be: the length is shorter by the sum of all that, and then has its tolerance.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from camgen.parts.assembly import Assembly
from camgen.parts.part import Part
from camgen.parts.standing import StandingCopy, standing_copies
from camgen.tolerances import SAME_POINT


def stack_allowance(
    assembly: Assembly, part: Part, thinner: Callable[[Part], float], floor: float
) -> float | None:
    """By how much what one copy of a part goes through may be thinner in all, mm, of the copies the most; None where none goes through
    anything.

    thinner: by how much another part may be, mm; floor: height over which others count, mm.
    """
    copies = standing_copies(assembly.parts, assembly.mounts, assembly.poses(np.zeros(1)))
    stacks = [
        [other for other in copies if other.part is not part and _goes_through(own, other)]
        for own in copies
        if own.part is part and not own.pose.upright
    ]
    sums = [
        sum(thinner(each.part) for each in stack if each.pose.z > floor - SAME_POINT)
        for stack in stacks
        if stack
    ]
    return max(sums, default=None)


def _goes_through(copy: StandingCopy, other: StandingCopy) -> bool:
    """Whether a copy's thinnest outline stands in a hole of another one."""
    size = min((each.diameter for each in copy.outlines), default=0.0)
    shanks = [each for each in copy.outlines if abs(each.diameter - size) < SAME_POINT]
    return any(hole.holds(shank) for hole in other.holes for shank in shanks)
