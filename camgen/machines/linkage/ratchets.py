"""[[ratchet]]: what is wrong between its table and the links, springs, drives and outputs of its linkage."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from camgen.errors import Fault, Key
from camgen.machines.linkage import tables as t
from camgen.machines.linkage.drawing import Drawing
from camgen.machines.linkage.drawing_faults import shaft_faults


def faults(drawing: Drawing, springs: Sequence[t.Spring]) -> Iterator[Fault]:
    """What is wrong with all of them, once their links are found."""
    for k, each in enumerate(drawing.ratchets):
        path: Key = ("ratchet", k)
        if not each.deep < each.radius:
            right = f"below radius ({each.radius:g}): roots lie round the axis"
            yield Fault((*path, "depth"), f"{each.deep:g}", right)
        wrong = [*shaft_faults(drawing, path, each)]
        yield from wrong
        if wrong:
            continue
        yield from _wheel_faults(drawing, path, each)
        yield from _pawl_faults(drawing, path, each, springs)


def _wheel_faults(drawing: Drawing, path: Key, each: t.Ratchet) -> Iterator[Fault]:
    """A wheel of which nobody knows that it turns one way."""
    drive = drawing.drive
    still = drive.range_deg is not None or drive.segments
    if still or drawing.turns_of(each.a) is None:
        right = "a link that turns one way alone: that of a drive that goes round, or one that gears join with it"
        yield Fault((*path, "a"), repr(each.a), right)


def _pawl_faults(
    drawing: Drawing, path: Key, each: t.Ratchet, springs: Sequence[t.Spring]
) -> Iterator[Fault]:
    """A pawl without a spring, or one that moves more than itself."""
    points = {*drawing.links[each.b]} - {drawing.pivot(each.b)}
    if not any(points & {*spring.between} for spring in springs):
        right = f"a pawl that a spring draws in: add [[spring]] between a point of {each.b} and one of the ground"
        yield Fault((*path, "b"), repr(each.b), right)
    if not drawing.moves_alone(each.b):
        right = "a link that no other joint holds or moves: a pawl falls"
        yield Fault((*path, "b"), repr(each.b), right)
    for k, output in enumerate(drawing.outputs):
        if output.link == each.b or output.point in points:
            right = f"another one: {each.b} falls behind each tooth, and is judged as a pawl"
            key = "link" if output.link else "point"
            yield Fault(("output", k, key), repr(output.link or output.point), right)
