"""What mends links that find no levels: in words by their keys, and tried on the layout, the least change first.

    bow        of a link with two hubs, by what it lacks, twice and four times that, to either side; unasked, unless the spec has
               it straight
    slimmer    that link's hubs, the head that is in the way, the pin or shaft
    smaller    pins, heads and walls all alike
    plates     a second one, which lets pins be in two stubs, and a shaft that is interrupted
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from itertools import islice, zip_longest
from typing import Any

from camgen.errors import DesignError
from camgen.machine.run import Run
from camgen.machines.linkage.joined import GROUND
from camgen.machines.linkage.layout import Layout
from camgen.parts.levels import Axis, Band, Crowded

Search = Callable[[Layout, Run, bool], dict[str, int] | None]
_BOWS = (1.1, 2.0, 4.0)  # of the room that is lacking
_SMALLER = (0.8, 0.6)  # of all sizes
_MOST = 3  # cures that are told


def slimmer(layout: Layout, link: str) -> tuple[str, str]:
    """What makes a link slimmer, and what moves it, by the keys."""
    shape = layout.sizes.shape(link)
    keys = [f"parts.{link}.hub_diameter" if shape.hub_diameter else "parts.wall"]
    keys += [f"parts.{link}.width"] if layout.arm_band(link) else []
    return f"a smaller {' or '.join(keys)}", f"other points or lengths of link {link}"


def slimmer_pin(layout: Layout, point: str) -> tuple[str, str]:
    """What makes a pin or shaft slimmer, and what moves it, by the keys."""
    move = f"points.{point} elsewhere" if layout.pivots[point][0] == GROUND else f"other lengths to points.{point}"
    if layout.kind(point) == "shoulder":
        return f'another kind of parts.pins.{point} than "shoulder"', move
    return f"a smaller parts.{'shaft' if point in layout.shafts else 'pin'}_diameter or parts.head", move


def cured(layout: Layout, run: Run, refused: Crowded, search: Search, tried: list[str]) -> str:
    """The remedy: what was found to mend it, which keys may, and what was tried."""
    found = (next((said for said, other in kind if _lies(other, run, search)), "") for kind in _changed(layout, refused))
    mends = list(islice(filter(None, found), _MOST))
    tries = f"; tried: {', '.join(tried)}, bows, slimmer and smaller parts, two plates"
    return f"mended by {', or by '.join(mends)}; else {refused.remedy}{tries}" if mends else f"{refused.remedy}{tries}"


def bent(layout: Layout, refused: Crowded) -> Iterator[Layout]:
    """Layouts in which one of the two that cannot pass is bent, from slight to wide; of links whose bow the spec leaves open."""
    ways = (_bent(layout, link, refused.needed - refused.distance) for link in _bendable(layout, refused)
            if layout.sizes.shape(link).bow is None)  # fmt: skip
    for bows in zip_longest(*ways):
        yield from (each[1] for each in bows if each is not None)


def _links(refused: Crowded) -> list[str]:
    """Links of the two that cannot pass."""
    return [thing.level for thing in (refused.a, refused.b) if isinstance(thing, Band) and thing.name == f"link {thing.level}"]


def _bendable(layout: Layout, refused: Crowded) -> list[str]:
    """Of these those with two hubs that are straight."""
    return [link for link in _links(refused)
            if len(layout.hubs(link)) == 2 and not layout.sizes.shape(link).bow and link not in layout.guides]  # fmt: skip


def _lies(layout: Layout, run: Run, search: Search) -> bool:
    """Whether levels are found soon, the heads of the plate's pins over or under it."""
    try:
        return any(search(each, run, False) is not None for each in layout.heads())
    except DesignError:
        return False


def _changed(layout: Layout, refused: Crowded) -> Iterator[Iterable[tuple[str, Layout]]]:
    """Layouts with a change each, and the change in words; of each kind of change from slight to great."""
    s, short = layout.sizes, refused.needed - refused.distance
    if layout.given:
        yield [("leaving [layers] out", replace(layout, given={}))]
    yield from (_bent(layout, link, short) for link in _bendable(layout, refused) if s.shape(link).bow is not None)
    for link in (link for link in _links(refused) if short <= s.wall - layout.min_wall and s.shape(link).hub_diameter is None):
        wide = round(2 * (min(radius for _, radius in layout.hubs(link)) - short) - 0.05, 1)
        yield [(f"parts.{link}.hub_diameter = {wide:g}", _with(layout, {link: {"hub_diameter": wide}}))]
    least = layout.min_wall + layout.fits.slide_clearance / 2 + 0.05  # of a head: a spacer's wall
    share = s.head - short / max(1, sum(isinstance(thing, Axis) for thing in (refused.a, refused.b)))
    head = math.floor(10 * share) / 10
    if head >= least:
        yield [(f"parts.head = {head:g}", _with(layout, {"head": head}))]
    sizes = ({key: round(factor * getattr(s, key), 2) for key in ("pin_diameter", "wall", "head")} for factor in _SMALLER)
    if s.pin == "printed":
        yield [(" and ".join(f"parts.{key} = {size:g}" for key, size in each.items()), _with(layout, each))
               for each in sizes if each["wall"] >= layout.min_wall and each["head"] >= least]  # fmt: skip
    if s.plates == 1:
        yield _with_two_plates(layout)


def _with_two_plates(layout: Layout) -> Iterator[tuple[str, Layout]]:
    """A layout with a second plate, then with an interrupted shaft too."""
    yield "parts.plates = 2", _with(layout, {"plates": 2})
    webbed = _with(layout, {"plates": 2, "shaft": "interrupted"})
    if webbed.webs and layout.sizes.shaft == "through":
        yield 'parts.plates = 2 and parts.shaft = "interrupted"', webbed


_WIDEST = 1e5  # mm, bow that is worth a try


def _bent(layout: Layout, link: str, short: float) -> Iterator[tuple[str, Layout]]:
    """A link with bows, to either side, from slight to wide."""
    for bow in (float(f"{side * factor * short:.2g}") for factor in _BOWS for side in (1, -1) if factor * short < _WIDEST):
        yield f"parts.{link}.bow = {bow:g}", _with(layout, {link: {"bow": bow}})


def _with(layout: Layout, changes: Mapping[str, Any]) -> Layout:
    """The layout with other sizes; of a link some keys."""
    table = layout.sizes.model_dump(exclude_none=True)
    for key, value in changes.items():
        table[key] = {**table.get(key, {}), **value} if isinstance(value, dict) else value
    return replace(layout, sizes=type(layout.sizes).model_validate(table))
