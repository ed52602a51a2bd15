"""What mends links that find no levels, or parts that cannot be made: in words by their keys, and tried, the least change first.

    bow        of a link with two hubs, by what it lacks, twice and four times that, to either side; unasked, unless the spec has
               it straight
    slimmer    that link's hubs, the head that is in the way, the pin or shaft
    smaller    pins, heads and walls all alike, then the shaft too where it is in the way
    plates     a second one, which lets pins be in two stubs, a shaft that is interrupted or goes through, or one plate alone

What is named as mending was made: the spec with that change has all its parts. All else that is said is called a guess.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice, zip_longest

from camgen.errors import DesignError
from camgen.parts.generator.changes import Change, Unmade
from camgen.parts.generator.joined import GROUND
from camgen.parts.generator.layout import Layout
from camgen.parts.level_rules import Axis, Band, Crowded, Unlaid

BOUGHT = ("dowel", "shoulder")  # pins that are sold in some lengths
_BOWS = (1.1, 2.0, 4.0)  # of the room that is lacking
_SMALLER = (0.8, 0.6)  # of all sizes
_SMALL, _SLIM = "smaller parts", "slimmer parts"  # kinds of changes
_MOST = 3  # cures that are told
_WIDEST = 1e5  # mm, bow that is worth a try


@dataclass(frozen=True)
class Kind:
    """Changes of one kind, from slight to great, of which the first that mends is told.

    name: what is said to have been tried; frame: whether links may be short of room again, elsewhere.
    """

    name: str
    changes: Sequence[Change]
    frame: bool = False


def slimmer(layout: Layout, link: str) -> tuple[str, str]:
    """What makes a link slimmer, and what moves it, by the keys."""
    shape = layout.sizes.shape(link)
    keys = [f"parts.{link}.hub_diameter" if shape.hub_diameter else "parts.wall"]
    keys += [f"parts.{link}.width"] if layout.arm_band(link) else []
    return f"a smaller {' or '.join(keys)}", f"other points or lengths of link {link}"


def slimmer_pin(layout: Layout, point: str) -> tuple[str, str]:
    """What makes a pin or shaft slimmer, and what moves it, by the keys."""
    move = (
        f"points.{point} elsewhere"
        if layout.pivots[point][0] == GROUND
        else f"other lengths to points.{point}"
    )
    if layout.kind(point) == "shoulder":
        return f'another kind of parts.pins.{point} than "shoulder"', move
    return (
        f"a smaller parts.{'shaft' if point in layout.shafts else 'pin'}_diameter or parts.head",
        move,
    )


def with_cures(
    layout: Layout,
    refused: DesignError,
    makes: Callable[[Change], bool],
    why_not: Callable[[Change], DesignError | None],
    attempts: Iterable[str],
) -> DesignError:
    """The error with what mends it, as `makes` finds; its own remedy as a guess after that, or what was tried in vain.

    why_not: why a change does not mend it; attempts: what was tried before.
    """
    kinds = list(_kinds(layout, refused))
    mends = _first(kinds, makes)
    for change in (change for kind in kinds if kind.frame and not mends for change in kind.changes):
        again, other = why_not(change), layout.changed(change)
        more = (
            () if again is None else _kinds(other, again) if change.free else _of_room(other, again)
        )
        mends += _first(
            [replace(kind, changes=[change.also(each) for each in kind.changes]) for kind in more],
            makes,
        )
    if not isinstance(refused, Unlaid | Unmade):  # what it asks for is no guess
        return (
            refused.mended(f"mended by {', or by '.join(mends)}; else {refused.remedy}")
            if mends
            else refused
        )
    remedy = refused.guess if isinstance(refused, Unmade) else refused.remedy
    tried = list(dict.fromkeys(kind.name for kind in kinds))
    if isinstance(refused, Crowded) and not mends and {_SMALL, _SLIM} & set(tried):
        remedy = refused.room(slimmer=False)  # no guess of what was tried in vain
    guess = f"a guess: {remedy}" if remedy else ""
    if mends:
        return refused.mended(
            f"mended by {', or by '.join(mends)}{f'; else {guess}' if guess else ''}"
        )
    vain = f"tried in vain: {', '.join([*attempts, *tried])}"
    return refused.mended("; ".join(filter(None, (guess, vain))))


def _first(kinds: Iterable[Kind], makes: Callable[[Change], bool]) -> list[str]:
    """In words the first change of each kind that mends, of the first kinds that do."""
    found = (next((change.words for change in kind.changes if makes(change)), "") for kind in kinds)
    return list(islice(filter(None, found), _MOST))


def bent(layout: Layout, refused: Crowded) -> Iterator[Layout]:
    """Layouts in which one of the two that cannot pass is bent, from slight to wide; of links whose bow the spec leaves open."""
    ways = (
        _bent(link, refused.needed - refused.distance)
        for link in _bendable(layout, refused)
        if layout.sizes.shape(link).bow is None
    )
    for bows in zip_longest(*ways):
        yield from (layout.changed(each) for each in bows if each is not None)


def _links(refused: Crowded) -> list[str]:
    """Links of the two that cannot pass."""
    return [
        thing.link for thing in (refused.a, refused.b) if isinstance(thing, Band) and thing.link
    ]


def _bendable(layout: Layout, refused: Crowded) -> list[str]:
    """Of these those with two hubs that are straight."""
    return [
        link
        for link in _links(refused)
        if len(layout.hubs(link)) == 2
        and not layout.sizes.shape(link).bow
        and link not in layout.guides
    ]


def _kinds(layout: Layout, refused: DesignError) -> Iterator[Kind]:
    """Kinds of changes that may mend it."""
    s = layout.sizes
    if layout.given:
        yield Kind("other levels", [Change("leaving [layers] out", free=True)], True)
    yield from _of_room(layout, refused)
    if isinstance(refused, Unmade):
        yield Kind(refused.kind, [refused.change])
    if s.of_sheet:
        return
    if s.pin in BOUGHT:
        yield Kind("pins that are printed", [Change('parts.pin = "printed"', {"pin": "printed"})])
    if s.plates == 1:
        two = [Change("parts.plates = 2", {"plates": 2})]
        if s.shaft == "through":
            two.append(
                Change(
                    'parts.plates = 2 and parts.shaft = "interrupted"',
                    {"plates": 2, "shaft": "interrupted"},
                )
            )
        yield Kind("two plates", two, True)
    else:
        yield Kind("one plate", [Change("parts.plates = 1", {"plates": 1})], True)
    if s.shaft == "interrupted":
        through = [Change('parts.shaft = "through"', {"shaft": "through"})]
        if s.plates == 1:
            through.append(
                Change(
                    'parts.shaft = "through" and parts.plates = 2',
                    {"shaft": "through", "plates": 2},
                )
            )
        yield Kind("a shaft that goes through", through, True)
    elif s.plates > 1:
        yield Kind(
            "an interrupted shaft",
            [Change('parts.shaft = "interrupted"', {"shaft": "interrupted"})],
            True,
        )


def _of_room(layout: Layout, refused: DesignError) -> Iterator[Kind]:
    """What makes room for two things, where they cannot pass."""
    if not isinstance(refused, Crowded):
        return
    s, short = layout.sizes, refused.needed - refused.distance
    for link in _bendable(layout, refused):
        if s.shape(link).bow is not None:
            yield Kind("bows", list(_bent(link, short)))
    for link in (
        link
        for link in _links(refused)
        if short <= s.wall - layout.min_wall and s.shape(link).hub_diameter is None
    ):
        wide = round(2 * (min(radius for _, radius in layout.hubs(link)) - short) - 0.05, 1)
        yield Kind(
            _SLIM,
            [Change(f"parts.{link}.hub_diameter = {wide:g}", {link: {"hub_diameter": wide}})],
        )
    least = layout.min_wall + layout.fits.slide_clearance / 2 + 0.05  # of a head: a spacer's wall
    share = s.head - short / max(
        1, sum(isinstance(thing, Axis) for thing in (refused.a, refused.b))
    )
    head = math.floor(10 * share) / 10
    if head >= least:
        yield Kind(_SLIM, [Change(f"parts.head = {head:g}", {"head": head})])
    keys: list[tuple[str, ...]] = [("pin_diameter", "wall", "head")]
    shaft = any(isinstance(thing, Axis) and thing.shaft for thing in (refused.a, refused.b))
    if shaft and s.face is None:
        keys.append((*keys[0], "shaft_diameter"))
    sizes = (
        {key: round(factor * getattr(s, key), 2) for key in each}
        for each in keys
        for factor in _SMALLER
    )
    if s.pin == "printed":
        smaller = [
            Change(" and ".join(f"parts.{key} = {size:g}" for key, size in each.items()), each)
            for each in sizes
            if each["wall"] >= layout.min_wall and each["head"] >= least
        ]
        yield from [Kind(_SMALL, smaller)] if smaller else []


def _bent(link: str, short: float) -> Iterator[Change]:
    """A link with bows, to either side, from slight to wide."""
    for bow in (
        float(f"{side * factor * short:.2g}")
        for factor in _BOWS
        for side in (1, -1)
        if factor * short < _WIDEST
    ):
        yield Change(f"parts.{link}.bow = {bow:g}", {link: {"bow": bow}})
