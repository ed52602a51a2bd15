"""What is not made, among the steps of assembly: springs before what is wider than their eyes, and what the machine stands on."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace

from camgen.machine.features import Mount
from camgen.machine.joining import Module
from camgen.machines.linkage.bodies import Bodies
from camgen.machines.linkage.layout import Layout
from camgen.study import Table
from camgen.tolerances import SAME_POINT


def finished(
    table: Table,
    bodies: Bodies,
    mounts: Sequence[Mount],
    titles: Mapping[str, str],
    module: Module | None = None,
) -> Table:
    """Steps of assembly with those of the springs, each before the first head or cap over its eyes, and with what carries and
    turns the whole.

    mounts: of the springs' own machine; titles: of springs; module: how that machine stands in the one whose steps these are.
    """
    layout = bodies.layout
    rows = list(zip(table.rows, table.copies or [()] * len(table.rows), strict=True))
    for name, spring in sorted(layout.springs.items(), key=lambda each: layout.level[each[0]]):
        points = [point for _, point in (spring.a, spring.b)]
        over = [copy for point in points for copy in _heads(layout, mounts, point)]
        where = f"points {' and '.join(points)}"
        said = f"eyes on the pins at {where}, before their caps: over these they do not go"
        if not any(copy.startswith("cap") for copy in over):
            said = f"eyes over the holes at {where}: the pins go in through them, for their heads are wider"
        named = set(over if module is None else map(module.part, over))
        first = next((k for k, (_, laid) in enumerate(rows) if named & set(laid)), len(rows))
        title = titles.get(
            name, "Extension spring" if name == "spring" else f"Extension spring {name}"
        )
        title, up = (title, 0.0) if module is None else (f"{title} of {module.prefix}", module.z)
        step = (
            0,
            "extension spring",
            f"{title}, {said}",
            "",
            1,
            layout.eye(name)[0] + up,
            "as bought",
        )
        rows.insert(first, (step, ()))
    if module is None:
        rows.append(((0, "board", f"Stands on {bodies.stands}", "", 1, 0.0, "as yours"), ()))
    numbered = [(count, *row[1:]) for count, (row, _) in enumerate(rows, 1)]
    return replace(table, rows=tuple(numbered), copies=tuple(laid for _, laid in rows))


def _heads(layout: Layout, mounts: Sequence[Mount], point: str) -> list[str]:
    """Copies of a pin with a head on top, or of caps, at a point."""
    link, number, found = layout.pressed_in(point), Counter[str](), []
    for mount in mounts:
        number[mount.part] += 1
        there = (
            mount.body == layout.carrier(link)
            and abs(mount.at - layout.at(link, point)) < SAME_POINT
        )
        if there and (
            mount.part.startswith("cap-") or mount.part.startswith("pin-") and mount.flipped
        ):
            found.append(f"{mount.part}-{number[mount.part]}")
    return found
