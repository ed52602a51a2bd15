"""Steps of assembly as a person at the bench takes them: what is one action is one step.

    sub-assembly   what is pressed together on the bench and put in goes into one step
    small parts    spacers and caps that come one after the other do too, a few at a time
    far side       its steps say so, and are said in full: it is mirrored, and what was done pages before is forgotten

Of a machine with more than a few steps:

    level          a few links that go on one after the other are one step, with a list to tick off
    bench first    of many, all sub-assemblies are pressed before the others, like ones counted
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import groupby, pairwise, takewhile
from typing import TypeVar

from camgen.parts.step_words import MOVES, ON_BENCH
from camgen.study import Doing, Step, Table, sentences

_SMALL = 5  # spacers and caps that are put on in one step, at most
_FEW = 16  # steps after the lists, up to which each stands alone
_MANY = 28  # of these, from which on sub-assemblies are pressed first
_PRESSED = 3  # sub-assemblies that are worth a step of their own, at least
_KINDS = 8  # of sub-assemblies that are pressed in one step, at most: what one picture can show
_LINES = 4  # of a list to tick off, at most: what one picture can show

T = TypeVar("T")
_Rows = Sequence[Sequence[object]]
_Run = tuple[Step, _Rows]  # a step, and its rows of the table


def at_bench(table: Table) -> Table:
    """The order with fewer steps; its rows remain, each with the number of its step."""
    if len(table.rows) != len(table.steps):
        return table
    actions = [*_actions([*zip(table.steps, table.rows, strict=True)])]
    lists = [_one(action) for action in takewhile(lambda each: not each[0][0].copies, actions)]
    actions = actions[len(lists) :]
    bench = [*_bench_first(actions, table.columns)] if len(actions) > _MANY else []
    rest = [_placed(action) if bench else _one(action) for action in actions]
    runs = [*lists, *bench, *(_levels(rest) if len(actions) > _FEW else rest)]
    steps = [_of_side(step) if step.apart else step for step, _ in runs]
    return replace(
        table,
        rows=[(number, *row[1:]) for number, (_, rows) in enumerate(runs, 1) for row in rows],
        steps=[_with_numbers(step, k, steps) for k, step in enumerate(steps)],
    )


_Action = tuple[Sequence[Step], _Rows]  # steps that are one action, and the row of each


def _actions(steps: Sequence[tuple[Step, Sequence[object]]]) -> Iterator[_Action]:
    """Steps that are one action, together."""
    run: list[Step] = []
    rows: list[Sequence[object]] = []
    for step, row in steps:
        if run and not _goes_on(run, step):
            yield run, rows
            run, rows = [], []
        run.append(step)
        rows.append(row)
    if run:
        yield run, rows


def _goes_on(run: Sequence[Step], step: Step) -> bool:
    """Whether a step is of one action with those before it."""
    last = run[-1]
    if (step.apart, step.way) != (last.apart, last.way):
        return False
    if last.group and last.copies:
        return True
    few = sum(len(each.copies) for each in (*run, step)) <= _SMALL
    return step.follows or (step.small and all(each.small for each in run) and few)


def _one(action: _Action) -> _Run:
    """Several steps as one."""
    return _whole(action[0]), action[1]


def _whole(run: Sequence[Step]) -> Step:
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
    doings = [*_built(run)] if built else [doing for step in run for doing in step.doings]
    return Step(
        sorted(doings, key=lambda each: each.verb == MOVES),  # what is tried comes last
        list(dict.fromkeys(copy for step in run for copy in step.copies)),
        last.way,
        mates,
        apart=last.apart,
        up=last.up,
        shapes=[shape for step in run for shape in step.shapes],
        threads=[thread for step in run for thread in step.threads],
        screws=[screw for step in run for screw in step.screws],
        small=all(step.small for step in run),
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


# ---- a machine with many steps ---------------------------------------------------------------------------------------


def _is_pressed(run: Sequence[Step]) -> bool:
    """Whether steps press a sub-assembly on the bench and put it in."""
    return bool(run[0].group) and len(run) > 1 and run[-1].doings[0].rest != ON_BENCH


def _bench_first(actions: Sequence[_Action], columns: Sequence[str]) -> Iterator[_Run]:
    """Steps in which all sub-assemblies are pressed, each kind with its number, a few kinds together; none where there are few."""
    pressed = [run for run, _ in actions if _is_pressed(run)]
    if len(pressed) < _PRESSED:
        return
    kinds: dict[str, list[Sequence[Step]]] = {}
    for run in pressed:
        kinds.setdefault(sentences(_inner(run)), []).append(run)
    by_verb: dict[str, list[Sequence[Sequence[Step]]]] = {}
    for alike in kinds.values():
        by_verb.setdefault(_inner(alike[0])[0].verb, []).append(alike)
    both = any(len({run[0].apart for run in alike}) > 1 for alike in kinds.values())
    shares = [*_shares([alike for own in by_verb.values() for alike in own], _KINDS)]
    # what is glued on one of them when it has been pressed, such as a frame
    after = {copy for run, _ in actions for step in run if step.pressed for copy in step.copies[1:]}
    for number, share in enumerate(shares):
        begins = _PRESS if number == 0 else _PRESS_MORE
        if number == 0 and both:
            begins += _FOR_BOTH
        ends = f"\n{_HARD}" if number == len(shares) - 1 else ""
        cells = {"what": "What is pressed together on the bench", "count": sum(map(len, share))}
        row = tuple(cells.get(column, "") for column in columns)
        laid = [
            (
                alike[0][0].group,
                [copy for step in alike[0] for copy in step.copies if copy not in after],
                [mate for step in alike[0][:-1] for mate in step.mates],
            )
            for alike in share
        ]
        yield Step([Doing(begins, "", f".{_pressed_list(share)}{ends}")], laid=laid), [row]


_PRESS = "put these together on the bench, with a vice. They go into the machine later"
_PRESS_MORE = "put these together on the bench as well"
_FOR_BOTH = (
    ". Those with F are for the far side, the mirror image of this one: lay the link with its letters down, do with it what the "
    'line says, and write F on it. Steps that begin with "Far side" take these'
)
_HARD = "Let all this get hard before you use it"


def _pressed_list(kinds: Sequence[Sequence[Sequence[Step]]]) -> str:
    """Sub-assemblies of some kinds as lines to tick off, those together that begin alike."""
    lines = ""
    for verb, own in groupby(kinds, lambda alike: _inner(alike[0])[0].verb):
        lines += f"\n{verb.rstrip().capitalize()}:"
        for alike in own:
            said = sentences(_inner(alike[0]))[len(verb) :].removesuffix(".")
            lines += f"\n☐ {said}{_number_made(alike)}"
    return lines


def _number_made(alike: Sequence[Sequence[Step]]) -> str:
    """How many of a sub-assembly are made, and how many of these are mirrored; "" of one."""
    if len(alike) == 1:
        return ""
    handed = sum(not step.small for step in alike[0][:-1]) > 1  # else caps on a pin
    mirrored = sum(bool(run[0].apart) for run in alike) if handed else 0
    hands = f", {mirrored} of them mirrored: F" if 0 < mirrored < len(alike) else ""
    return f" (make {len(alike)}{hands})"


def _shares(items: Sequence[T], most: int) -> Iterator[Sequence[T]]:
    """Items in order, in shares of about one size, none larger than the most."""
    count = math.ceil(len(items) / most)
    ends = [round(k * len(items) / count) for k in range(count + 1)]
    return (items[low:high] for low, high in pairwise(ends))


def _inner(run: Sequence[Step]) -> list[Doing]:
    """What is done on the bench with a sub-assembly, but for what is laid there: first what is handled, then what is said of it."""
    doings = [
        replace(each, verb=each.verb.removeprefix("then "))
        for step in run[:-1]
        for each in step.doings
        if each.rest != ON_BENCH
    ]
    return sorted(doings, key=lambda each: not each.thing)


def _placed(action: _Action) -> _Run:
    """An action as one step, of a machine of which all sub-assemblies are pressed before; of one of these, how it is put in."""
    run, rows = action
    whole = _whole(run)
    if whole.pressed:
        return replace(whole, doings=whole.pressed), rows
    if not _is_pressed(run):
        return whole, rows
    inside = {mate.place for mate in whole.mates if mate.within}
    mates = [mate for mate in whole.mates if mate.place not in inside]
    return replace(whole, doings=run[-1].doings, mates=mates), rows


def _levels(runs: Sequence[_Run]) -> Iterator[_Run]:
    """Steps in which links and small parts are only put on, a few together: as many to a step as to the next."""
    for (simple, *_), alike in groupby(
        runs, lambda run: (_simple(run[0]), run[0].apart, run[0].way)
    ):
        level = [*alike]
        if not simple:
            yield from level
            continue
        yield from map(_level, _shares(level, _LINES))


_IN_ORDER = "put these on in this order"  # begins a step that has a list
_PUT_ON = ("set ", "put ", "lay ", "stand ")


def _simple(step: Step) -> bool:
    """Whether a step only puts on a link, stands a pin or lays a link, or brings small parts."""
    only = all(each.verb.startswith(_PUT_ON) or each.verb == MOVES for each in step.doings)
    return bool(step.copies) and not step.shapes and not step.joins and (step.small or only)


def _level(runs: Sequence[_Run]) -> _Run:
    """Several steps as one, with a list to tick off in their order."""
    if len(runs) == 1:
        return runs[0]
    steps = [step for step, _ in runs]
    lines = "".join(f"\n☐ {line}" for step in steps for line in step.lines)
    whole = replace(
        steps[-1],
        doings=[Doing(_IN_ORDER, "", f":{lines}")],
        copies=list(dict.fromkeys(copy for step in steps for copy in step.copies)),
        mates=[mate for step in steps for mate in step.mates],
        small=False,
    )
    return whole, [row for _, rows in runs for row in rows]


# ---- sides and numbers -----------------------------------------------------------------------------------------------


def _of_side(step: Step) -> Step:
    """A step that says of which side it is."""
    begins = (step.doings[0].verb, step.doings[0].rest)
    alike = [*takewhile(lambda each: (each.verb, each.rest) == begins, step.doings)]
    verb = f"{step.apart}: {begins[0]}"
    first = [replace(each, verb=verb) for each in alike]
    return replace(step, doings=[*first, *step.doings[len(alike) :]])


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
    later = next(iter(coming), 0)
    return f"step {later}" if later else "this step"
