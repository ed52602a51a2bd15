"""When each copy and each thing that is bought comes in the steps of assembly, and how it moves there."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from camgen.files.arrangement import Copy
from camgen.files.exploded_view import Body, Coming
from camgen.parts.catalogue import (
    FOLLOWER_NUT,
    FOLLOWER_WASHER,
    NUT_STANDARD,
    ROLLER_STANDARD,
    Bought,
)
from camgen.parts.keyways import KEY
from camgen.parts.set_screws import ON_KEY_STANDARD
from camgen.pipeline.bought_shapes import Thing
from camgen.study import Table

_ABOVE = (0.0, 0.0, -1.0)  # the way of what comes from above
_BELOW = (0.0, 0.0, 1.0)
_RECTANGLE = 5  # points of its closed outline
_NEAR = 0.01  # mm, by which neighbours may lie in each other
_AFTER = 0.5  # of a step, by which what comes with it comes after the parts


def comings_of(steps: Table) -> dict[str, Coming]:
    """Of each copy of a part, by its name, when it comes first in the steps, and how. What is built by itself stays apart where nothing
    comes after it; else its parts come when it joins the others, the first of them as it does."""
    joins = {step.joins: k for k, step in enumerate(steps.steps) if step.joins}
    last = max((k for k, step in enumerate(steps.steps) if step.copies), default=0)
    begun = set[str]()
    comings = dict[str, Coming]()
    for k, step in enumerate(steps.steps):
        order, apart, mover = float(k), step.apart, step
        while apart in joins and joins[apart] <= last:
            joint = steps.steps[joins[apart]]
            if step.copies and apart not in begun:
                begun.add(apart)
                mover = joint
            order = joins[apart] + order / len(steps.steps) * _AFTER
            apart = joint.apart
        x, y, z = mover.along or (mover.way * each for each in mover.up)
        for name in step.copies:
            comings.setdefault(name, Coming(order, (x, y, z), apart))
    return comings


def coming_of(thing: Bought, shape: Thing, made: Sequence[Copy], steps: Table) -> Coming:
    """When a thing that is bought comes: with a row of its own, or as soon as all parts are there that it touches; a key in the first
    of them before the other comes, or with both."""
    body = Body(0, shape)
    parts = [(Body(0, copy.prisms), copy.coming) for copy in made if copy.prisms]
    touched = [(part, coming) for part, coming in parts if body.meets(part)]
    names = Counter(coming.apart for _, coming in touched)
    apart = max(names, key=lambda name: names[name], default="")
    orders = [coming.order for _, coming in touched if coming.apart == apart]
    order = max(orders, default=0.0) + _AFTER
    if thing.name == KEY:
        order -= 2 * _AFTER if len({*orders}) > 1 else _AFTER
    for row, cells in enumerate(steps.rows):
        if len(steps.rows) == len(steps.steps) and (thing.name, thing.size) == cells[1:3]:
            order = float(row)
    way = _way(thing, shape, body, [part for part, _ in touched], [part for part, _ in parts])
    return Coming(order, way, apart)


def after_what_is_nearer(things: Sequence[tuple[Thing, Coming]]) -> list[Coming]:
    """When things that are bought come, each after all that it would bar the way: that it is beyond of, on the way on which both come.
    Rings on either side of a bearing have one row in the steps."""
    bodies = [Body(0, shape, coming) for shape, coming in things]

    def bars(k: int, n: int) -> bool:
        one, other = bodies[k], bodies[n]
        if one.coming.way != other.coming.way or not one.coming.way[2]:
            return False
        beyond = (
            one.low >= other.high - _NEAR
            if one.coming.way[2] < 0
            else one.high <= other.low + _NEAR
        )
        return beyond and bool(one.plan.intersects(other.plan))

    found = []
    for k, (_, coming) in enumerate(things):
        barred = [things[n][1].order for n in range(len(things)) if bars(k, n)]
        found.append(
            replace(coming, order=max(coming.order, *(order + _AFTER / 2 for order in barred)))
            if barred
            else coming
        )
    return found


def _way(
    thing: Bought, shape: Thing, body: Body, touched: Sequence[Body], parts: Sequence[Body]
) -> tuple[float, float, float]:
    """In which it moves: what lies towards its inner end; a screw away from its head, one from behind and a motor up; what is wholly
    under all that it touches, or under the whole machine, up."""
    lies = thing.standard in (ON_KEY_STANDARD, ROLLER_STANDARD)
    lies |= thing.name in (FOLLOWER_WASHER, FOLLOWER_NUT)
    if lies and all(len(face.exterior.coords) == _RECTANGLE for face, *_ in shape):
        begin, end = np.array(shape[0][0].exterior.coords)[:2] @ np.array([1, 1j])
        inwards = (begin - end) / abs(begin - end)
        return float(inwards.real), float(inwards.imag), 0.0
    under = all(part.middle > body.high for part in touched or parts)
    beneath = body.high <= min(part.low for part in parts)
    if (
        is_from_behind(thing, shape)
        or under
        or beneath
        or thing.role == "drive"
        or body.headed_below
    ):
        return _BELOW
    return _ABOVE


def is_from_behind(thing: Bought, shape: Thing) -> bool:
    """Whether it is a screw through a board of yours, of which only what is in the machine is known."""
    return bool(thing.thread) and thing.standard != NUT_STANDARD and len(shape) == 1
