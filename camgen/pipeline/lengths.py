"""How much shorter than drawn rods and shanks of pins of metal are made, so that none stands out of what it goes through.

What moves past the end of a shaft or a pin is a gap away from the part in which that ends. This part lies lower where those under it are
as thin as their sheets let them be: the length is shorter by what the sum of all that is beyond its own distance from the top, and then
has its tolerance.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from camgen.parts.assembly import Assembly
from camgen.parts.part import Part
from camgen.parts.standing import StandingCopy, standing_copies
from camgen.tolerances import SAME_POINT


def stack_allowance(
    assembly: Assembly, part: Part, thinner: Callable[[Part], float], headed: bool
) -> float | None:
    """By how much what one copy of a part goes through may be thinner in all beyond what its end lies within that, mm, of the copies the
    most; None where none goes through anything.

    thinner: by how much another part may be, mm; headed: whether it hangs from a head, and is no shaft whose upper end counts.
    """
    copies = standing_copies(assembly.parts, assembly.mounts, assembly.poses(np.zeros(1)))
    floor = -math.inf if headed else -SAME_POINT
    found = list[float]()
    for own in copies:
        if own.part is not part or own.pose.upright:
            continue
        stack = [other for other in copies if other.part is not part and _goes_through(own, other)]
        over = [other for other in stack if other.pose.z > floor]
        lies = [_within(own, other, headed) for other in over]
        if stack:
            found.append(sum(thinner(each.part) for each in over) - max(lies, default=0.0))
    return max(0.0, *found) if found else None


def _within(own: StandingCopy, other: StandingCopy, headed: bool) -> float:
    """By how much a copy's end lies within another one that it goes through, mm; below 0 beyond it."""
    if headed:
        return own.pose.z - other.pose.z
    return other.pose.z + other.part.thickness - own.pose.z - own.part.thickness


def _goes_through(copy: StandingCopy, other: StandingCopy) -> bool:
    """Whether a copy's thinnest outline stands in a hole of another one."""
    size = min((each.diameter for each in copy.outlines), default=0.0)
    shanks = [each for each in copy.outlines if abs(each.diameter - size) < SAME_POINT]
    return any(hole.holds(shank) for hole in other.holes for shank in shanks)
