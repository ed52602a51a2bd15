"""Where the screws of a step are, for its picture: a head on one part, through its clearance hole, and a thread in the next one.

Nothing says where a screw goes but the parts: a clearance hole and a core hole of its thread that have one axis; of a motor, which
is no part, the clearance holes of the plate beside its body.
"""

from __future__ import annotations

import cmath
import math
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import replace

from camgen.machine.features import StandIn
from camgen.machine.model import GROUND
from camgen.parts.catalogue import CORE_HOLES, SCREWS, Bought, Screw
from camgen.parts.mates import comes_again
from camgen.parts.standing import Round, StandingCopy
from camgen.study import Prism, Step
from camgen.tolerances import SAME_POINT

_ALIKE = 0.35  # mm, by which a printed hole may differ from that of its thread
_BESIDE = 6.0  # mm, from a motor's body to a screw that holds it, at most


def round_prism(at: complex, radius: float) -> list[complex]:
    """Corners of a round thing as the pictures of steps have it."""
    return [at + cmath.rect(radius, math.tau * k / 48) for k in range(48)]


def screw_hole(hole: Round, steps: Sequence[Step]) -> tuple[str, float]:
    """The thread of the screw that goes through a hole or cuts its thread there, and the size of the hole for it, mm; "" and 0 of none.
    steps: with their screws."""
    for step in steps:
        for corners, low, high in step.screws[::2]:  # of a shank and a head each
            middle = sum(corners) / len(corners)
            nominal = 2 * abs(corners[0] - middle)
            if (
                abs(hole.at - middle) > SAME_POINT
                or min(high, hole.high) - max(low, hole.low) < SAME_POINT
            ):
                continue
            for thread, _ in step.threads:
                screw = SCREWS[thread]
                for size in (screw.clearance, CORE_HOLES[thread]):
                    if (
                        abs(nominal - screw.nominal) < SAME_POINT
                        and abs(hole.diameter - size) < _ALIKE
                    ):
                        return thread, size
    return "", 0.0


def with_screws(
    steps: Sequence[Step], copies: Sequence[StandingCopy], bought: Sequence[Bought]
) -> list[Step]:
    """Steps with the screws that come in them; bought: by which standards these are."""
    standards = {(each.thread, each.length): each.standard for each in bought if each.length}
    by_name = {copy.name: copy for copy in copies}
    built = defaultdict[str, list[StandingCopy]](list)  # by what is built apart
    found = []
    for number, step in enumerate(steps, 1):
        there = built[step.apart]
        tried = comes_again(step, steps[number:])
        coming = built.pop(step.joins, []) if step.joins and not tried else []
        coming = [*coming, *(by_name[name] for name in step.copies if name in by_name)]
        there += [copy for copy in coming if copy not in there]
        screws = [
            prism
            for thread, length in step.threads
            for screw in [SCREWS[thread].headed(standards.get((thread, length), ""))]
            for prism in _screws(screw, length, step, coming, there)
        ]
        found.append(replace(step, screws=screws))
    return found


def screw_heads(steps: Sequence[Step], copies: Sequence[StandingCopy]) -> list[StandIn]:
    """Heads of the screws in what stands still, as they are in the way of what moves; steps: with their screws."""
    holes = [hole for copy in copies if copy.mount.body == GROUND for hole in copy.holes]
    heads = list[StandIn]()
    for step in steps:
        for (_, foot, end), (corners, low, high) in zip(
            step.screws[::2], step.screws[1::2], strict=True
        ):
            middle = sum(corners) / len(corners)
            if any(
                abs(hole.at - middle) < SAME_POINT and min(hole.high, end) > max(hole.low, foot)
                for hole in holes
            ):
                disc = middle, abs(corners[0] - middle), low, high
                heads.append(StandIn(f"screw-head-{len(heads) + 1}", GROUND, (disc,)))
    return heads


def _screws(
    screw: Screw,
    length: float,
    step: Step,
    coming: Sequence[StandingCopy],
    there: Sequence[StandingCopy],
) -> Iterator[Prism]:
    """Heads and shanks of one kind of screw; where nothing comes, of all that is there."""
    seats = _holes(there, screw.clearance)
    if step.shapes:  # a motor under the plate
        body, *_ = step.shapes[0]
        middle = sum(body) / len(body)
        reach = max(abs(z - middle) for z in body) + _BESIDE
        plates = (each for copy, each in seats if copy.mount.body == GROUND and copy.part.points)
        for hole in plates:
            if not hole.name and abs(hole.at - middle) < reach:
                yield from _screw(screw, length, hole, up=False)
        return
    fresh = {copy.name for copy in coming}
    for core_copy, core in _holes(there, CORE_HOLES[screw.thread]):
        for up in (True, False):
            stack = [
                (copy, hole)
                for copy, hole in seats
                if hole.in_line(core) and 0 < _reach(hole, core, up) <= length + SAME_POINT
            ]
            comes = any(
                not fresh or each.name in fresh for each in (core_copy, *(c for c, _ in stack))
            )
            if stack and comes:
                _, seat = max(stack, key=lambda each: _reach(each[1], core, up))
                yield from _screw(screw, length, seat, up)


def _reach(hole: Round, core: Round, up: bool) -> float:
    """From the far end of a clearance hole to where a core hole begins, mm; up: the core hole is above."""
    return core.low - hole.low if up else hole.high - core.high


def _holes(copies: Sequence[StandingCopy], diameter: float) -> list[tuple[StandingCopy, Round]]:
    """Holes of about a diameter, mm, with the copy of each."""
    return [
        (copy, hole)
        for copy in copies
        for hole in copy.holes
        if not copy.pose.standing and abs(hole.diameter - diameter) < _ALIKE
    ]


def _screw(screw: Screw, length: float, hole: Round, up: bool) -> Iterator[Prism]:
    """A shank through a clearance hole and a head at its end, mm; up: its thread is above."""
    seat, way = (hole.low, 1.0) if up else (hole.high, -1.0)
    for radius, end in ((screw.nominal / 2, way * length), (screw.head / 2, -way * screw.height)):
        low, high = sorted((seat, seat + end))
        yield round_prism(hole.at, radius), low, high
