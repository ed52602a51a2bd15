"""Steps of assembly as a person at the bench takes them: what is one action is one step, and a side that is like another one is
said once.

    sub-assembly   what is pressed together on the bench and put in goes into one step
    small parts    spacers and caps that come one after the other do too, a few at a time
    far side       steps that are like those of the near side are done again by their numbers, with a list to tick off
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import takewhile

from camgen.parts.sides import PREFIX
from camgen.parts.steps import ON_BENCH, listed
from camgen.study import Doing, Step, Table

_SMALL = 5  # spacers and caps that are put on in one step, at most
_AGAIN = 8  # steps of the near side that one step repeats, at most: after it one compares with its picture

_Run = tuple[Step, int]  # a step, and how many rows of the table it is


def at_bench(table: Table) -> Table:
    """The order with fewer steps; its rows remain, each with the number of its step."""
    if len(table.rows) != len(table.steps):
        return table
    runs = [*_said_once([*_actions(table.steps)])]
    steps = [step for step, _ in runs]
    rows = iter(table.rows)
    numbered = [
        (number, *next(rows)[1:]) for number, (_, count) in enumerate(runs, 1) for _ in range(count)
    ]
    return replace(
        table,
        rows=numbered,
        steps=[_with_numbers(step, k, steps) for k, step in enumerate(steps)],
    )


def _actions(steps: Sequence[Step]) -> Iterator[_Run]:
    """Steps that are one action, as one."""
    run: list[Step] = []
    for step in steps:
        if run and not _goes_on(run, step):
            yield _one(run), len(run)
            run = []
        run.append(step)
    if run:
        yield _one(run), len(run)


def _goes_on(run: Sequence[Step], step: Step) -> bool:
    """Whether a step is of one action with those before it."""
    last = run[-1]
    if (step.apart, step.way) != (last.apart, last.way):
        return False
    if last.group and last.copies:
        return True
    few = sum(len(each.copies) for each in (*run, step)) <= _SMALL
    return step.follows or (step.small and all(each.small for each in run) and few)


def _one(run: Sequence[Step]) -> Step:
    """Several steps as one."""
    if len(run) == 1:
        return run[0]
    last = run[-1]
    built = bool(run[0].group)
    mates = [
        replace(mate, within=(built and step is not last) or step.follows)
        for step in run
        for mate in step.mates
    ]
    others = listed(step.what for step in run[1:] if step.what)
    return Step(
        [*_built(run)] if built else [doing for step in run for doing in step.doings],
        list(dict.fromkeys(copy for step in run for copy in step.copies)),
        last.way,
        mates,
        apart=last.apart,
        up=last.up,
        shapes=[shape for step in run for shape in step.shapes],
        what=f"{run[0].what} with {others}" if built else listed(step.what for step in run),
    )


def _built(run: Sequence[Step]) -> Iterator[Doing]:
    """What is done with a sub-assembly: what it is laid on is said where it stays there."""
    first, *inner, last = run
    begins, *more = last.doings
    stays = begins.rest == ON_BENCH
    lies = [each for each in first.doings if each.rest == ON_BENCH]
    yield from lies if stays else ()
    yield from (doing for step in inner for doing in step.doings)
    yield from (each for each in first.doings if each not in lies)
    if not stays:
        yield replace(begins, verb=f"then {begins.verb}" if begins.verb else "")
    yield from more


# ---- a side that is like another one ---------------------------------------------------------------------------------


def _said_once(runs: Sequence[_Run]) -> Iterator[_Run]:
    """Runs of steps of what is built by itself that are like those of the rest, each as one; all others say of which side they are."""
    near = [_words(step) if not step.apart else "" for step, _ in runs]
    after = 0  # of the near side's steps, the first that can be done again
    again: list[
        tuple[int, _Run]
    ] = []  # steps of the near side, counted from 0, and those of the far one
    for step, rows in runs:
        alike = _words(step) in near[after:] and step.apart and step.copies
        number = near.index(_words(step), after) if alike else -1
        if again and (number != again[-1][0] + 1 or len(again) == _AGAIN):
            yield _again(again)
            again = []
        if alike:
            after = number + 1
            again.append((number, (step, rows)))
        else:
            yield (_of_side(step), rows) if step.apart else (step, rows)
    if again:
        yield _again(again)


def _words(step: Step) -> str:
    """What a step says, without the names of its side and the numbers of copies."""
    said = step.title.replace(f"{PREFIX}-", "") if step.apart else step.title
    return re.sub(r"\{([\w-]+)-\d+\}", r"{\1}", said)


def _again(run: Sequence[tuple[int, _Run]]) -> _Run:
    """Steps of the near side done again; one alone is said in full."""
    steps = [step for _, (step, _) in run]
    rows = sum(rows for _, (_, rows) in run)
    if len(run) == 1:
        return _of_side(steps[0]), rows
    first, last = run[0][0] + 1, run[-1][0] + 1
    ticks = "".join(f"\n☐ {step.what}" for step in steps)
    doings = [
        Doing(
            f"{steps[0].apart}: do steps {first} to {last} again, as the picture shows them, mirrored"
        ),
        Doing(f"tick off:{ticks}"),
    ]
    copies = list(dict.fromkeys(copy for step in steps for copy in step.copies))
    mates = [mate for step in steps for mate in step.mates]
    whole = Step(doings, copies, steps[-1].way, mates, apart=steps[0].apart, up=steps[0].up)
    return whole, rows


def _of_side(step: Step) -> Step:
    """A step that says of which side it is."""
    begins = (step.doings[0].verb, step.doings[0].rest)
    alike = [*takewhile(lambda each: (each.verb, each.rest) == begins, step.doings)]
    verb = f"{step.apart}: {begins[0]}"
    first = [replace(each, verb=verb) for each in alike]
    return replace(step, doings=[*first, *step.doings[len(alike) :]])


# ---- numbers ---------------------------------------------------------------------------------------------------------


def _with_numbers(step: Step, place: int, steps: Sequence[Step]) -> Step:
    """A step with the numbers of later ones where it names a copy that comes in them."""

    def number(found: re.Match[str]) -> str:
        return _number(found[1], place, steps)

    doings = [
        replace(each, rest=re.sub(r"\{([\w-]+)\}", number, each.rest)) for each in step.doings
    ]
    return replace(step, doings=doings)


def _number(copy: str, place: int, steps: Sequence[Step]) -> str:
    """The next step that has a copy, in words."""
    coming: Iterable[int] = (
        k for k, step in enumerate(steps, 1) if k > place + 1 and copy in step.copies
    )
    return f"step {next(iter(coming), place + 1)}"
