"""Where parts meet: what goes on what is there, or through it, and how it is fixed there."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

from camgen.machine.features import SlideFaces
from camgen.parts.fixing import Fixing, with_joints
from camgen.parts.standing import Round, Slot, StandingCopy
from camgen.study import Mate, Step
from camgen.tolerances import SAME_POINT


def mated(
    steps: Sequence[Step],
    copies: Sequence[StandingCopy],
    pairs: Sequence[object],
    fixing: Fixing,
) -> list[Step]:
    """Steps with what comes and goes on what is there; names of parts in them stand for all their copies.

    A copy that comes twice is loose at first: its place is fixed when it comes again, and so is what was built apart. A step in which
    no copy comes keeps its own.
    """
    fixing = with_joints(fixing, pairs)
    slides = [each for each in pairs if isinstance(each, SlideFaces)]
    built = defaultdict[str, list[StandingCopy]](list)  # by what is built apart
    bench = list[StandingCopy]()  # the sub-assembly
    found = []
    for number, step in enumerate(steps):
        named = {*step.copies}
        again = {name for each in steps[number + 1 :] for name in each.copies}
        tried = comes_again(step, steps[number + 1 :])
        coming = [copy for copy in copies if copy.name in named or copy.part.name in named]
        names = [copy.name for copy in coming]
        there = built[step.apart]
        glued = replace(fixing, dry=frozenset(step.dry))
        if step.group and coming:
            mates = mates_between(coming, bench, glued)
            bench += coming
        else:
            if not coming and step.group:
                coming = bench
            coming = [*built[step.joins], *coming] if step.joins else coming
            mates = [*mates_between(coming, there, glued), *_sliding(coming, there, slides)]
            if step.joins and not tried:
                del built[step.joins]
            if not tried:
                there += [copy for copy in coming if copy not in there]
            bench = [] if step.group else bench
        mates = [mate if mate.label else _of_joint(mate, [*there, *coming]) for mate in mates]
        if named & again or tried:
            mates = [replace(mate, how="free") for mate in mates]
        mates = [*mates, *step.glued]
        found.append(replace(step, copies=names, mates=mates if coming else step.mates))
    return found


def comes_again(step: Step, later: Iterable[Step]) -> bool:
    """Whether what was built apart and comes in a step comes again, so that it is only tried in this one."""
    return bool(step.joins) and any(each.joins == step.joins for each in later)


def _of_joint(mate: Mate, copies: Iterable[StandingCopy]) -> Mate:
    """Where a hole has no name, such as a cap's: with that of the joint, by the next hole on its axis that has one."""
    x, y, z = mate.place
    beside = [
        (abs((hole.low + hole.high) / 2 - z), hole.name)
        for copy in copies
        for hole in copy.holes
        if hole.name and abs(hole.at - complex(x, y)) < SAME_POINT
    ]
    return replace(mate, label=min(beside, default=(0.0, ""))[1])


def mates_between(
    coming: Iterable[StandingCopy], there: Sequence[StandingCopy], fixing: Fixing
) -> list[Mate]:
    """Where what comes goes on what is there, or through it; parts of one body that are loose on each other are left out."""
    mates = dict[tuple[object, ...], Mate]()
    for copy in coming:
        for other in there:
            for holder, held in ((copy, other), (other, copy)):
                alike = holder.pose.standing == held.pose.standing
                for mate in _through(holder, held, fixing, held is copy) if alike else ():
                    dry = {copy.part.name, other.part.name} & fixing.dry
                    if mate.how != "free" or dry or copy.mount.body != other.mount.body:
                        x, y, z = (round(value, 3) for value in mate.place)
                        mates.setdefault((mate.how, x, y, z), mate)
    return list(mates.values())


def _through(
    holder: StandingCopy, held: StandingCopy, fixing: Fixing, comes: bool
) -> Iterator[Mate]:
    """Where outlines of one copy go through holes and slots of another."""
    openings: list[Round | Slot] = [*holder.holes, *holder.slots]
    for hole in openings:
        for outline in held.outlines:
            on_sleeve = (
                isinstance(hole, Round) and held.part.role == "sleeve" and hole.goes_round(outline)
            )
            if not (on_sleeve or hole.holds(outline)):
                continue
            low = max(hole.low, outline.low)
            high = min(hole.high, outline.high)
            place = held.in_space(outline.at, (low + high) / 2)
            label = hole.name if isinstance(hole, Round) else ""
            how = (
                fixing.how(hole, holder.part, outline, held.part)
                if isinstance(hole, Round)
                else "free"
            )
            yield Mate(how, label, place, outline.diameter, high - low, comes)


def _sliding(
    coming: Iterable[StandingCopy],
    there: Sequence[StandingCopy],
    slides: Sequence[SlideFaces],
) -> Iterator[Mate]:
    """Where what comes slides on what is there, in the middle of the runner's faces."""
    for copy in coming:
        for other in there:
            for pair in slides:
                runner, rails = (
                    (copy, other) if copy.part.name == pair.runner.part else (other, copy)
                )
                if (runner.part.name, rails.part.name) == (pair.runner.part, pair.rails.part):
                    at = runner.at(pair.runner.at)
                    middle = runner.mount.z + runner.part.thickness / 2
                    yield Mate("free", "", (at.real, at.imag, middle))
