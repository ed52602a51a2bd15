"""The first step at the bench of what is printed: holes in which something turns are opened to their size, and tried."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import replace

from camgen.parts.part import Part
from camgen.parts.standing import Round, StandingCopy
from camgen.parts.steps import Fixing, listed
from camgen.study import Doing, Step, Table
from camgen.tolerances import SAME_POINT

_WIDEST = 13.0  # mm, of a drill that people have


def with_reaming(table: Table, copies: Sequence[StandingCopy], fixing: Fixing) -> Table:
    """The order of assembly, begun with the holes that are to be reamed; as it is where there are none."""
    tools = _holes(copies, fixing)
    if not tools:
        return table
    lines = [f"{_tool(size)}: {listed(_named(parts))}" for size, parts in sorted(tools.items())]
    count = sum(
        part.count * len(holes) for parts in tools.values() for part, holes in parts.values()
    )
    ticks = "".join(f"\n☐ {line}" for line in lines)
    said = (
        f"open {f'all {count} holes' if count > 1 else 'the hole'} in which something turns, by hand and straight, with a "
        f"drill or reamer of this size; what goes in must then drop through by its own weight{ticks}"
    )
    cells = {"step": 1, "what": "Holes in which something turns", "count": count}
    cells |= {"where": "; ".join(lines), "how": said}
    row = tuple(cells.get(column, "") for column in table.columns)
    rows = [row, *((int(str(step)) + 1, *cells) for step, *cells in table.rows)]
    return replace(table, rows=rows, steps=[Step([Doing(said)]), *table.steps])


def reamer_size(diameter: float, play: float) -> float:
    """Of a drill or reamer for a hole with play round a diameter, mm: in tenths, as drills are, where one of these is wider than
    the diameter, else in hundredths, as reamers are."""
    size = diameter + play + SAME_POINT
    drill = math.floor(10 * size) / 10
    return drill if drill > diameter else math.floor(100 * size) / 100


def _tool(size: float) -> str:
    """What opens a hole of a size, mm."""
    return f"{size:g} mm" if size <= _WIDEST else f"{size:g} mm, with fine sandpaper"


_Holes = dict[str, tuple[Part, list[str]]]  # by the name of a part


def _named(parts: _Holes) -> Iterator[str]:
    """Holes of each part in words: "B and C1 of low1 (2 ×)"."""
    for part, holes in parts.values():
        many = f" ({part.count} ×)" if part.count > 1 else ""
        letters = [name for name in holes if name]
        rest = len(holes) - len(letters)
        bare = ["the bore" if rest == 1 else f"{rest} bores"] if rest else []
        yield f"{listed([*letters, *bare])} of {part.name}{many}"


def _holes(copies: Sequence[StandingCopy], fixing: Fixing) -> dict[float, _Holes]:
    """Holes of printed parts in which another body turns, by the size of what opens them, mm."""
    found = defaultdict[float, _Holes](dict)
    seen = set[tuple[str, str, float, float]]()
    for holder in copies:
        if holder.part.process != "printed":
            continue
        for hole in holder.holes:
            size = _turning_in(hole, holder, copies, fixing)
            own = (holder.part.name, hole.name, round(hole.diameter, 3), _away(hole, holder))
            if not size or own in seen:
                continue
            seen.add(own)
            found[size].setdefault(holder.part.name, (holder.part, []))[1].append(hole.name)
    return dict(found)


def _away(hole: Round, holder: StandingCopy) -> float:
    """What tells holes of one part without names apart: how far each is from the part's datum, mm."""
    return round(abs(hole.at - holder.at(0j)), 3)


def _turning_in(
    hole: Round, holder: StandingCopy, copies: Sequence[StandingCopy], fixing: Fixing
) -> float:
    """The size of a drill or reamer for a hole, mm, as wide as what turns in it; 0 where nothing does."""
    widest = max(
        (
            outline.diameter
            for held in copies
            if held.mount.body != holder.mount.body and held.pose.standing == holder.pose.standing
            for outline in held.outlines
            if hole.holds(outline) and fixing.how(hole, holder.part, outline, held.part) == "free"
        ),
        default=0.0,
    )
    if not widest:
        return 0.0
    return reamer_size(round(widest, 3), hole.diameter - widest)
