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
from itertools import islice, product, zip_longest

from camgen.errors import DesignError
from camgen.parts.generator.changes import Change, Unmade
from camgen.parts.generator.connections import GROUND
from camgen.parts.generator.layout import Layout
from camgen.parts.generator.link_outlines import arm_band, link_hubs
from camgen.parts.generator.sizes import Parts
from camgen.parts.level_rules import Axis, Band, NoLevels, NoPassage

BOUGHT = ("dowel", "shoulder")  # pins that are sold in some lengths
_BOWS = (1.1, 2.0, 4.0)  # of the room that is lacking
_SMALLER = (0.8, 0.6)  # of all sizes
# kinds of changes
_SMALL = "smaller parts"
_SLIM = "slimmer parts"
_MOST = 3  # cures that are named
_WIDEST = 1e5  # mm, bow that is worth a try
_TWO_PLATES = Change("parts.plates = 2", {"plates": 2})
_INTERRUPTED = Change('parts.shaft = "interrupted"', {"shaft": "interrupted"})


@dataclass(frozen=True)
class Kind:
    """Changes of one kind, from slight to great, of which the first that mends is named."""

    name: str  # what is said to have been tried
    changes: Sequence[Change]
    frame: bool = False  # whether links may be short of room again, elsewhere


def slimmer(layout: Layout, link: str) -> tuple[str, str]:
    """What makes a link slimmer, and what moves it, by the keys."""
    shape = layout.sizes.shape(link)
    if shape.contours:
        return f"a smaller parts.{link}.outline", f"other points or lengths of link {link}"
    keys = [f"parts.{link}.hub_diameter" if shape.hub_diameter else "parts.wall"]
    keys += [f"parts.{link}.width"] if arm_band(layout, link) else []
    return f"a smaller {' or '.join(keys)}", f"other points or lengths of link {link}"


def slimmer_pin(layout: Layout, point: str) -> tuple[str, str]:
    """What makes a pin or shaft slimmer, and what moves it, by the keys."""
    move = f"other lengths of the links at points.{point}"
    if layout.pivots[point][0] == GROUND:
        posts = (each.key for each in layout.springs.values() if (GROUND, point) == each.a)
        move = f"another place for {next(filter(None, posts), f'points.{point}')}"
    if layout.kind(point) == "shoulder":
        return f'another kind of parts.pins.{point} than "shoulder"', move
    what = "shaft" if point in layout.shafts else "pin"
    return f"a smaller parts.{what}_diameter or parts.head", move


def with_cures(
    layout: Layout,
    refused: DesignError,
    makes: Callable[[Change], bool],
    why_not: Callable[[Change], DesignError | None],
    attempts: Iterable[str],
) -> DesignError:
    """The error with what mends it, as `makes` finds; its own remedy as a guess after that, or what was tried without success.

    why_not: why a change does not mend it; attempts: what was tried before.
    """
    kinds = list(_kinds(layout, refused))
    cures = _first(kinds, makes)
    for change in (change for kind in kinds if kind.frame and not cures for change in kind.changes):
        again = why_not(change)
        if again is None:
            continue
        other = layout.changed(change)
        more = _kinds(other, again) if change.free else _of_room(other, again)
        both = (replace(kind, changes=list(map(change.also, kind.changes))) for kind in more)
        cures += _first(both, makes)
    by = f"mended by {', or by '.join(cures)}"
    if not isinstance(refused, NoLevels | Unmade):  # what it asks for is no guess
        return refused.mended(f"{by}; else {refused.remedy}") if cures else refused
    remedy = refused.guess if isinstance(refused, Unmade) else refused.remedy
    tried = list(dict.fromkeys(kind.name for kind in kinds))
    if isinstance(refused, NoPassage) and not cures and {_SMALL, _SLIM} & set(tried):
        remedy = refused.room(slimmer=False)  # no guess of what was tried without success
    guess = f"a guess: {remedy}" if remedy else ""
    if cures:
        return refused.mended(f"{by}; else {guess}" if guess else by)
    vain = f"tried without success: {', '.join([*attempts, *tried])}"
    return refused.mended("; ".join(filter(None, (guess, vain))))


def frames(sizes: Parts, turns: bool = True) -> list[Change]:
    """Other plates and shafts, the least change first, where the spec leaves them open; turns: whether the drive has a shaft."""
    typed = sizes.model_fields_set
    if sizes.of_sheet or "plates" in typed:
        return []
    fixed = "shaft" in typed or not turns
    return [_TWO_PLATES, *([] if fixed else [_TWO_PLATES.also(_INTERRUPTED)])]


def _first(kinds: Iterable[Kind], makes: Callable[[Change], bool]) -> list[str]:
    """In words the first change of each kind that mends, of the first kinds that do."""
    words = (next((change.words for change in kind.changes if makes(change)), "") for kind in kinds)
    return list(islice(filter(None, words), _MOST))


def with_bows(layout: Layout, refused: NoPassage) -> Iterator[Layout]:
    """Layouts in which one of the two that cannot pass is bent, from slight to wide; of links whose bow the spec leaves open."""
    ways = (
        _bows(link, refused.needed - refused.distance)
        for link in _bendable(layout, refused)
        if layout.sizes.shape(link).bow is None
    )
    for bows in zip_longest(*ways):
        yield from (layout.changed(each) for each in bows if each is not None)


def _links(refused: NoPassage) -> list[str]:
    """Links of the two that cannot pass."""
    pair = (refused.a, refused.b)
    return [thing.link for thing in pair if isinstance(thing, Band) and thing.link]


def _bendable(layout: Layout, refused: NoPassage) -> list[str]:
    """Links of the two that cannot pass with two hubs, straight."""
    return [
        link
        for link in _links(refused)
        if len(link_hubs(layout, link)) == 2
        and not layout.sizes.shape(link).bow
        and not layout.sizes.shape(link).contours
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
    turns = layout.driven not in layout.slides
    two = _TWO_PLATES
    interrupted = _INTERRUPTED
    through = Change('parts.shaft = "through"', {"shaft": "through"})
    if s.plates == 1:
        both = [two.also(interrupted)] if s.shaft == "through" and turns else []
        yield Kind("two plates", [two, *both], True)
    else:
        yield Kind("one plate", [Change("parts.plates = 1", {"plates": 1})], True)
    if s.shaft == "interrupted":
        both = [through.also(two)] if s.plates == 1 else []
        yield Kind("a shaft that goes through", [through, *both], True)
    elif s.plates > 1 and turns:
        yield Kind("an interrupted shaft", [interrupted], True)


def _of_room(layout: Layout, refused: DesignError) -> Iterator[Kind]:
    """What makes room for two things, where they cannot pass."""
    if not isinstance(refused, NoPassage):
        return
    s = layout.sizes
    short = refused.needed - refused.distance
    for link in _bendable(layout, refused):
        if s.shape(link).bow is not None:
            yield Kind("bows", list(_bows(link, short)))
    for link in _links(refused):
        if short <= s.wall - layout.min_wall and not (
            s.shape(link).hub_diameter or s.shape(link).contours
        ):
            wide = round(
                2 * (min(radius for _, radius in link_hubs(layout, link)) - short) - 0.05, 1
            )
            words = f"parts.{link}.hub_diameter = {wide:g}"
            yield Kind(_SLIM, [Change(words, {link: {"hub_diameter": wide}})])
    least = layout.min_wall + layout.fits.slide_clearance / 2 + 0.05  # of a head: a spacer's wall
    axes = [thing for thing in (refused.a, refused.b) if isinstance(thing, Axis)]
    head = math.floor(10 * (s.head - short / max(1, len(axes)))) / 10
    if head >= least:
        yield Kind(_SLIM, [Change(f"parts.head = {head:g}", {"head": head})])
    if s.pin != "printed":
        return
    keys: list[tuple[str, ...]] = [("pin_diameter", "wall", "head")]
    if s.face is None and any(axis.shaft for axis in axes):
        keys.append((*keys[0], "shaft_diameter"))
    smaller = []
    for each, factor in product(keys, _SMALLER):
        sizes = {key: round(factor * getattr(s, key), 2) for key in each}
        if sizes["wall"] >= layout.min_wall and sizes["head"] >= least:
            words = " and ".join(f"parts.{key} = {size:g}" for key, size in sizes.items())
            smaller.append(Change(words, sizes))
    if smaller:
        yield Kind(_SMALL, smaller)


def _bows(link: str, short: float) -> Iterator[Change]:
    """A link with bows, to either side, from slight to wide."""
    for factor, side in product(_BOWS, (1, -1)):
        if factor * short < _WIDEST:
            bow = float(f"{side * factor * short:.2g}")
            yield Change(f"parts.{link}.bow = {bow:g}", {link: {"bow": bow}})
