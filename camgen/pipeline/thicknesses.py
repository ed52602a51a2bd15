"""What the gaps between parts of metal that lie over each other bear of their thicknesses.

A part is set over the next one on its axis by a feeler gauge. Over a part on another axis it is then as high as all that lies under it
on its own: where each of these may be thinner by x, and the other part is as thick as drawn, so many x are lost of the gap between both.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from camgen.machine.model import GROUND
from camgen.parts.assembly import Assembly
from camgen.parts.standing import StandingCopy, standing_copies
from camgen.tolerances import SAME_POINT

_STEP = 0.01  # mm, of limits
_SAME_AXIS = 1e-3  # mm


@lru_cache(maxsize=1)  # an assembly is the same object for all of its parts
def thickness_allowances(assembly: Assembly) -> dict[str, float]:
    """By how much each part that lies over another may be thinner than drawn, mm, by its name; so much is left of the tightest gap."""
    poses = assembly.poses(np.zeros(1))
    copies = [
        copy
        for copy in standing_copies(assembly.parts, assembly.mounts, poses)
        if copy.part.process == "printed"
        and copy.part.role != "sleeve"
        and copy.mount.body != GROUND
        and not copy.pose.upright
        and copy.holes
        and copy.mount.z > 0
    ]
    shares = [share for copy in copies if (share := _share(copy, copies)) < math.inf]
    least = math.floor(min(shares, default=0.0) / _STEP + 1e-9) * _STEP
    return {copy.part.name: max(_STEP, least) for copy in copies} if shares else {}


def _share(copy: StandingCopy, copies: Sequence[StandingCopy]) -> float:
    """Of the gap under a copy, down to what is on another axis, for each that lies under it on its own, and one that is left, mm."""
    under = [each for each in copies if each is not copy and _top(each) < copy.mount.z + SAME_POINT]
    stacks = [
        sum(any(_one_axis(at, own.at) for own in each.holes) for each in under)
        for at in (hole.at for hole in copy.holes)
    ]
    others = [
        _top(each)
        for each in under
        if not any(_one_axis(a.at, b.at) for a in copy.holes for b in each.holes)
    ]
    gap = copy.mount.z - max(others, default=-math.inf)
    return gap / (max(stacks) + 1) if max(stacks) else math.inf


def _top(copy: StandingCopy) -> float:
    return copy.mount.z + copy.part.thickness


def _one_axis(a: complex, b: complex) -> bool:
    return abs(a - b) < _SAME_AXIS
