"""Blocks under a machine on the bench: how high those are that prop what is loose, and that bear what is pressed; and strips that keep
glue off what lies under a link."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence

import numpy as np

from camgen.machine.model import GROUND
from camgen.parts.fixing import Fixing
from camgen.parts.mates import mates_between
from camgen.parts.standing import AROUND, Round, StandingCopy, covers, placed
from camgen.parts.step_places import RESTS
from camgen.parts.step_words import STRIP, listed
from camgen.study import Doing
from camgen.tolerances import SAME_POINT

MUST_NOT_SINK = ": it must not sink"
_ASIDE = 1.0  # mm, beside a hole, where its part bears on a block


def lowest_plate(there: Sequence[StandingCopy]) -> StandingCopy | None:
    """The plate under which the blocks lie, or which lies on the bench; None as long as there is none."""
    plates = [each for each in there if each.mount.body == GROUND and each.holes]
    return min(plates, key=lambda each: each.mount.z, default=None)


def block_height(low: float, plate: StandingCopy, blocks: float) -> str:
    """How high a block is that reaches from the bench up to a height, mm; blocks: height of those under the plate, mm."""
    high = low - plate.mount.z + blocks
    if not blocks:
        return f"{high:.4g} mm high"
    if abs(high - blocks) < SAME_POINT:
        return f"as high as those under {plate.part.name}"
    return f"{high:.4g} mm high, where those under {plate.part.name} are {blocks:g} mm high"


def bearing_blocks(
    coming: Sequence[StandingCopy], there: Sequence[StandingCopy], fixing: Fixing, blocks: float
) -> Iterator[Doing]:
    """Blocks that bear a shaft which is loose in its plate, and links and a plate on blocks, while something is pressed on or in them
    from above."""
    plate = lowest_plate(there)
    if plate is None:
        return
    plates = [each for each in there if each.mount.body == GROUND]
    sinking = dict[float, list[str]]()
    bending = defaultdict[float, dict[tuple[str, str], list[str]]](dict)
    for copy in coming:
        for other in there:
            mates = [mate for mate in mates_between([copy], [other], fixing) if mate.how != "free"]
            shaft = other.part.role == "shaft" and mates_between([other], plates, fixing)
            if shaft and any(not mate.comes for mate in mates):
                low = min(each.low for each in other.outlines)
                sinking.setdefault(low, []).append(other.part.name)
            for mate in mates if copy.mount.flipped else ():
                holes = (hole for hole in other.holes if hole.in_line(copy.outlines[0]))
                hole = next(holes)
                lowest = _foot(hole, other, there)
                if lowest is None or not mate.comes or _swept(hole.at, lowest.mount.z, there):
                    continue
                foot = lowest.mount.z
                if blocks or foot > plate.mount.z + SAME_POINT:
                    lies = "" if lowest is other else lowest.part.name
                    letters = bending[foot].setdefault((lies, other.part.name), [])
                    letters += [mate.label] if mate.label else []
    for low, names in sinking.items():
        shafts = listed(dict.fromkeys(names))
        if low - plate.mount.z + blocks < SAME_POINT:
            rest = f" on the bench, where blocks under {plate.part.name} are {blocks:g} mm high"
            yield Doing("stand ", shafts, f"{rest}{MUST_NOT_SINK}")
            continue
        yield Doing(
            "put a block under ",
            shafts,
            f", {block_height(low, plate, blocks)}{MUST_NOT_SINK}",
            props=(low - plate.mount.z + blocks,),
        )
    for low, parts in bending.items():
        under = listed(_at_holes(*names, own) for names, own in parts.items())
        yield Doing(
            "put a block under ",
            under,
            f", {block_height(low, plate, blocks)}: it must not bend",
            props=(low - plate.mount.z + blocks,) * sum(len(own) or 1 for own in parts.values()),
        )


def _at_holes(lowest: str, holder: str, letters: Sequence[str]) -> str:
    """Where a block goes: "W and V of ground", "stand-panel below W and V of ground"; lowest: on what the holder lies, "" of nothing."""
    holes = f"{listed(dict.fromkeys(letters))} of {holder}" if letters else holder
    return f"{lowest} below {holes}" if lowest else holes


def strips_under(
    coming: Sequence[StandingCopy], there: Sequence[StandingCopy], fixing: Fixing
) -> Iterator[Doing]:
    """Strips that keep glue off what lies under a link in which a pin is glued from above, and moves against it."""
    between = defaultdict[tuple[str, str], list[str]](list)
    for copy in () if fixing.metal else coming:
        for other in there if copy.mount.flipped else ():
            for mate in mates_between([copy], [other], fixing):
                glued = (each for each in other.holes if each.in_line(copy.outlines[0]))
                hole = next(glued, None)
                if mate.how != "glue" or hole is None:
                    continue
                under = _lies_on(hole, other, there)
                if under and under.mount.body != other.mount.body:
                    letters = between[under.part.name, other.part.name]
                    letters += [mate.label] if mate.label not in letters else []
    places = [
        f"between {lower} and {upper}" + (f" under {listed(letters)}" if all(letters) else "")
        for (lower, upper), letters in between.items()
    ]
    if places:
        strips = STRIP if len(places) == 1 else "strips of a plastic bag"
        them = "it" if len(places) == 1 else "them"
        rest = f": glue that comes out there must not stick them together. Leave {them} there until it is hard"
        yield Doing("lay ", f"{strips} {listed(places)}", rest, ("plastic bag",))


def _lies_on(
    hole: Round, holder: StandingCopy, there: Sequence[StandingCopy]
) -> StandingCopy | None:
    """What the underside of a hole's part lies on there; None where the next thing is farther below, or nothing."""
    around = hole.at + (hole.diameter / 2 + _ASIDE) * AROUND
    for other in sorted(there, key=lambda each: -each.mount.z):
        gap = holder.mount.z - other.mount.z - other.part.thickness
        if gap > -SAME_POINT and covers(other, around):
            return other if gap < RESTS else None
    return None


def _foot(hole: Round, holder: StandingCopy, there: Sequence[StandingCopy]) -> StandingCopy | None:
    """The lowest of what lies under a hole's part there, one on the other, or that part; None where something else is farther below, and
    no block stands there."""
    around = hole.at + (hole.diameter / 2 + _ASIDE) * AROUND
    lowest = holder
    for other in sorted(there, key=lambda each: -each.mount.z):
        gap = lowest.mount.z - other.mount.z - other.part.thickness
        if gap > -SAME_POINT and covers(other, around):
            if gap >= RESTS:
                return None
            lowest = other
    return lowest


def _swept(at: complex, low: float, there: Sequence[StandingCopy]) -> bool:
    """Whether what turns with a shaft passes below a place and a height of the assembly, mm: no block stands there."""
    shafts = [copy for copy in there if copy.part.role == "shaft"]
    return any(
        abs(at - complex(shaft.pose.place[0])) < _reach(copy, complex(shaft.pose.place[0]))
        for shaft in shafts
        for copy in there
        if copy.mount.body == shaft.mount.body and copy.mount.z < low - SAME_POINT
    )


def _reach(copy: StandingCopy, axis: complex) -> float:
    """How far a copy reaches from an axis, mm."""
    if copy.pose.standing:
        return 0.0
    rings = (placed(copy, layer.region.outer) for layer in copy.part.layers)
    return max(float(np.abs(ring - axis).max()) for ring in rings)
