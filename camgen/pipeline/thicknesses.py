"""What the gaps between parts of metal that lie over each other bear of their thicknesses.

A part is set over the next one on its axis by a feeler gauge. Over a part on another axis it is then as high as all that lies under it
on its own: where each of these may be thinner by x, and each up to the other part, on that one's axis, thicker, so many x are lost of the
gap between both.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Collection, Sequence
from functools import lru_cache
from itertools import combinations

import numpy as np

from camgen.geometry.arcs import fit_arcs
from camgen.geometry.outlines import Points, extent
from camgen.machine.model import GROUND
from camgen.parts.assembly import Assembly
from camgen.parts.part import Part
from camgen.parts.standing import StandingCopy, standing_copies
from camgen.tolerances import SAME_POINT

_STEP = 0.01  # mm, of limits
_SAME_AXIS = 1e-3  # mm
_FINE = 1e-3  # mm, of arcs in place of curves
_SAMPLES = 721  # of theta


@lru_cache(maxsize=1)  # an assembly is the same object for all of its parts
def thickness_allowances(assembly: Assembly) -> dict[str, float]:
    """By how much each part that lies over another may be thinner than drawn, mm, by its name; so much is left of the tightest gap."""
    poses = assembly.poses(np.zeros(1))
    standing = standing_copies(assembly.parts, assembly.mounts, poses)
    copies = [
        copy
        for copy in standing
        if copy.part.process == "printed"
        and copy.part.role != "sleeve"
        and copy.mount.body != GROUND
        and not copy.pose.upright
        and copy.holes
        and copy.mount.z > 0
    ]
    apart = _apart(assembly, standing)
    shares = [share for copy in copies if (share := _share(copy, copies, apart)) < math.inf]
    least = math.floor(min(shares, default=0.0) / _STEP + 1e-9) * _STEP
    return {copy.part.name: max(_STEP, least) for copy in copies} if shares else {}


def _apart(assembly: Assembly, standing: Sequence[StandingCopy]) -> set[tuple[str, str]]:
    """Names of copies that never come over each other: wherever the machine stands, their middles are farther apart than they reach."""
    least, greatest = assembly.cycle.range
    theta = np.linspace(least, least + assembly.cycle.swept * (greatest - least), _SAMPLES)
    poses = assembly.poses(theta)
    number = Counter[str]()
    places = list[Points]()
    for copy in standing:
        places.append(poses[copy.part.name][number[copy.part.name]].place)
        number[copy.part.name] += 1
    found = set[tuple[str, str]]()
    for (a, at), (b, other) in combinations(zip(standing, places, strict=True), 2):
        way = np.abs(at - other)
        step = float(np.max(np.abs(np.diff(way)), initial=0.0))
        if float(np.min(way)) - step > _reach(a.part) + _reach(b.part):
            found |= {(a.name, b.name), (b.name, a.name)}
    return found


def _reach(part: Part) -> float:
    """Greatest distance of a part's outlines from its datum, mm, or more: that of a corner of their box."""
    low, high = extent([fit_arcs(layer.region.outer, _FINE) for layer in part.layers])
    return max(
        abs(low), abs(high), abs(complex(low.real, high.imag)), abs(complex(high.real, low.imag))
    )


def _share(
    copy: StandingCopy, copies: Sequence[StandingCopy], apart: Collection[tuple[str, str]]
) -> float:
    """Of the gap under a copy, down to what is on another axis, for each that lies under it on its own and each up to the other part on
    that one's, mm: the least of all gaps."""
    under = [each for each in copies if each is not copy and _top(each) < copy.mount.z + SAME_POINT]
    own = _stack(copy, under)
    others = [
        each
        for each in under
        if not any(_one_axis(a.at, b.at) for a in copy.holes for b in each.holes)
        and (copy.name, each.name) not in apart
        and not _passes_beside(copy, each, copies)
    ]
    if not own:
        return math.inf
    gaps = ((copy.mount.z - _top(each), _stack(each, copies)) for each in others)
    return min((gap / (own + stack) for gap, stack in gaps), default=math.inf)


def _stack(copy: StandingCopy, copies: Sequence[StandingCopy]) -> int:
    """How many of some copies lie on one axis of one, up to its upper side."""
    return max(
        sum(
            _top(each) < _top(copy) + SAME_POINT
            and any(_one_axis(hole.at, own.at) for own in each.holes)
            for each in copies
        )
        for hole in copy.holes
    )


def _passes_beside(copy: StandingCopy, other: StandingCopy, copies: Sequence[StandingCopy]) -> bool:
    """Whether a round copy never comes over another one: a part on its body and axis, as wide at least, runs at the other one's heights, as
    a roller in a slot does under the cap of its pin."""
    if len(copy.outlines) < len(copy.part.layers):
        return False
    widest = max(copy.outlines, key=lambda each: each.diameter)
    return any(
        _one_axis(each.at, widest.at) and each.diameter > widest.diameter - SAME_POINT
        for beside in copies
        if beside is not copy and beside.mount.body == copy.mount.body
        for each in beside.outlines
        if each.low < _top(other) - SAME_POINT and each.high > other.mount.z + SAME_POINT
    )


def _top(copy: StandingCopy) -> float:
    return copy.mount.z + copy.part.thickness


def _one_axis(a: complex, b: complex) -> bool:
    return abs(a - b) < _SAME_AXIS
