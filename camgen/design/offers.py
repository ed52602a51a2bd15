"""Designs that a search found for a wish, weighed as machines: how they stand, and which of them is written."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from camgen.design.found import Found
from camgen.design.front import Front
from camgen.design.request import Request
from camgen.errors import DesignError, counted

NO_ERROR = 0.02  # of what is borne: less does not count
_LEAST_AND_HALF = 1.5  # times the least play of a design: nobody gets much less


@dataclass(frozen=True)
class Aim:
    """What decides among designs, and what lets a search find others."""

    lash: float | None  # mm or deg, greatest play, where the wish says it
    useful_play: float  # mm or deg, with which a design is still of use
    unit: str
    error_counts: bool  # whether the nearest is wanted, and not any that is near enough
    best_in: str  # what those of least loss are said to do
    further: str
    tighter: str = "set a smaller print.slide_clearance"

    def within(self, designs: Sequence[Found]) -> Aim:
        """With the play that is of use at least half as much again as the least of these, unless the wish says it."""
        plays = [each.prototype.lash for each in designs if each.prototype.of_use]
        if self.lash is not None or not plays:
            return self
        return replace(self, useful_play=max(self.useful_play, _LEAST_AND_HALF * min(plays)))


@dataclass(frozen=True)
class Offer:
    """Designs and how they are shown."""

    designs: Sequence[Found]
    aim: Aim
    title: str  # of the front's page
    summary: str
    figures: Mapping[str, str]  # as a front has them
    note: str  # above what is found in the spec that is written


def rank(aim: Aim, each: Found) -> tuple[int, float, float]:
    """What designs are sorted by: those of use with useful play by what is best of them, then those of use by their play;
    those that can be built, and those that cannot, by their error."""
    made = each.prototype
    if not made.of_use:
        return (3 if made.obstacle else 2, each.share, each.loss)
    if made.lash > aim.useful_play:
        return (1, made.lash, each.loss)
    return (0, max(each.share, NO_ERROR) if aim.error_counts else 0.0, each.loss)


def written(request: Request, offer: Offer) -> str:
    """Text of the spec of the best design; the front is kept where that is wanted; DesignError where none will do."""
    aim = offer.aim
    within = aim.within(offer.designs)
    order = sorted(offer.designs, key=lambda each: rank(within, each))
    rows = [each.row(number) for number, each in enumerate(order, 1)]
    texts = [request.spec_of(each, offer.note) for each in order] if request.keep else []
    sketches = [each.sketch for each in order]
    summary = f"{counted(len(order), 'design')}: {offer.summary}"
    front = Front(offer.title, summary, offer.figures, texts, rows, sketches)
    if request.keep is not None:
        request.keep(front)
    near = acceptable(order, aim)
    best = near[0]
    many = counted(len(order), "design")
    request.say(f"{many} to choose from; {front.caption(rows[order.index(best)])}")
    if best.prototype.lash > aim.useful_play:
        request.say(
            f"it has more play than {aim.useful_play:.4g} {aim.unit} (wanted.lash, which is not set), the least of a design is "
            f"{min(each.prototype.lash for each in near):.3g} {aim.unit}: {aim.tighter}"
        )
    other = min(near, key=lambda each: each.loss)
    if other is not best:
        request.say(f"{aim.best_in}: {front.caption(rows[order.index(other)])}")
    return request.spec_of(best, offer.note)


def acceptable(order: Sequence[Found], aim: Aim) -> list[Found]:
    """Those that can be built, with no more play than is borne, keep their limits and the wish; DesignError where there are none."""
    can = keeping(order, aim)
    near = [each for each in can if not each.miss]
    if near:
        return near
    far = min(can, key=lambda each: each.share).farthest
    where = "the nearest buildable design"
    if not far.default:
        remedy = f"{aim.further}, or a wider wanted.{far.key}"
        raise DesignError(f"wanted.{far.key}", far.error, far.allowance, far.unit, where, remedy)
    remedy = f"{aim.further}, or wanted.{far.key} = {math.ceil(100 * far.error) / 100:g}"
    raise DesignError("error", far.error, far.allowance, far.unit, where, remedy).saying(
        f"{where} is {far.error:.4g} {far.unit} off; without wanted.{far.key} the limit is {far.default}, "
        f"{far.allowance:.4g} {far.unit}"
    )


def keeping(order: Sequence[Found], aim: Aim) -> list[Found]:
    """Those that can be built, with no more play than is borne, and keep their limits; DesignError where there are none."""
    buildable = [each for each in order if not each.prototype.obstacle]
    if not buildable:
        many = f"front of {len(order)}"
        remedy = f"{aim.further}, or thinner parts"
        raise DesignError("buildable designs", 0, 1, "", many, remedy).saying(
            f"none of {len(order)} designs can be built; the first: {order[0].prototype.obstacle}"
        )
    if aim.lash is not None:
        tight = [each for each in buildable if each.prototype.lash <= aim.lash]
        if not tight:
            least = min(each.prototype.lash for each in buildable)
            remedy = "a smaller print.slide_clearance, or more play"
            where = "the tightest buildable design"
            raise DesignError("wanted.lash", least, aim.lash, aim.unit, where, remedy)
        buildable = tight
    can = [each for each in buildable if not each.prototype.failures]
    if can:
        return can
    nearest = min(buildable, key=lambda each: each.share).prototype
    many = counted(len(buildable), "buildable design")
    only_play = {each.code for each in nearest.failures} == {"LASH"}
    remedy = (
        "a smaller print.slide_clearance, or a greater wanted.lash"
        if only_play
        else "wider [limits]"
    )
    message = f"none of {many} keeps its limits; the nearest one: {nearest.refusal}"
    raise DesignError("designs that keep their limits", 0, 1, "", many, remedy).saying(message)
