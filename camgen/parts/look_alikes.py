"""A first step at the bench: parts that look alike are told apart by what one measures, and get their names.

Links look alike where all lengths between their holes do, and so do round parts of one diameter. What tells links apart is,
in this order: engraved letters, which one reads, a length, the number of holes, which holes are tight, the size of the outline.
"""

from __future__ import annotations

import cmath
import math
from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from typing import TypeVar

from camgen.geometry.outlines import extent
from camgen.parts.fixing import Fixing
from camgen.parts.part import Part
from camgen.parts.reaming import begun, tight_holes
from camgen.parts.standing import StandingCopy, discs, seat_of
from camgen.parts.step_words import listed
from camgen.parts.turning_over import middle
from camgen.study import Doing, Table
from camgen.tolerances import SAME_POINT

_ALIKE = 0.1  # share by which sizes may differ of what one takes for the same at sight
_MEASURED = 0.3  # mm, a difference that a person measures with a ruler or caliper
_SEEN = 0.05  # mm, the least difference of which a tenth tells
_ROUND = (
    "spacer",
    "sleeve",
    "cap",
    "pin",
    "crank-pin",
)  # roles of what is told apart by its height

T = TypeVar("T")


@dataclass(frozen=True)
class _Link:
    """A part with lettered holes, and which of them are tight."""

    part: Part
    tight: frozenset[str]

    @cached_property
    def holes(self) -> list[tuple[complex, float]]:
        """Middles and radii of all round holes, mm in the part's frame."""
        return [disc for hole in self.part.region.holes for disc in discs(hole)]

    @cached_property
    def sunk(self) -> int:
        """How many round holes are wider at one face, as for heads of screws."""
        wide = defaultdict[complex, set[float]](set)
        for layer in self.part.layers:
            for hole in layer.region.holes:
                for at, radius in discs(hole):
                    wide[complex(round(at.real, 3), round(at.imag, 3))].add(round(radius, 3))
        return sum(len(radii) > 1 for radii in wide.values())

    @cached_property
    def named(self) -> list[tuple[str, complex]]:
        """Lettered holes."""
        return [
            (name, z)
            for name, z in self.part.points
            if any(abs(z - at) < SAME_POINT for at, _ in self.holes)
        ]

    @property
    def lettered(self) -> bool:
        """Whether the letters of all its holes are engraved."""
        return {name for name, _ in self.named} <= self.part.lettered

    @cached_property
    def lengths(self) -> list[tuple[float, str, str]]:
        """Between the lettered holes, mm, the shortest first."""
        pairs = combinations(self.named, 2)
        return sorted((round(abs(z - w), 3), a, b) for (a, z), (b, w) in pairs)

    @cached_property
    def size(self) -> tuple[float, float]:
        """Of the outline, the longer side first, mm."""
        return _size(self.part)

    def looks_like(self, other: _Link) -> bool:
        """Whether one takes both for the same at sight."""
        if len(self.named) != len(other.named):
            return False
        sizes = [each[0] for each in self.lengths] + [*self.size, self.part.thickness]
        others = [each[0] for each in other.lengths] + [*other.size, other.part.thickness]
        return all(math.isclose(*pair, rel_tol=_ALIKE) for pair in zip(sizes, others, strict=True))

    @cached_property
    def flats(self) -> list[tuple[str, str, int, float]]:
        """Lettered holes with a flat, each with another hole, how far its flat is turned from that, deg, and its radius, mm."""
        found = []
        for hole in filter(seat_of, self.part.region.holes):
            for at, radius in discs(hole):
                own = [name for name, z in self.named if abs(z - at) < SAME_POINT]
                others = [each for each in self.named if abs(each[1] - at) > SAME_POINT]
                for name, z in others[:1] if own else ():
                    to_flat = at - middle(hole)  # what it cuts off leaves the middle opposite
                    turn = cmath.phase(to_flat / (z - at))
                    found.append((own[0], name, round(math.degrees(turn)), round(radius, 3)))
        return found

    @property
    def flat_places(self) -> list[tuple[float, int]]:
        """Of the holes with flats their radii and turns, whichever side is up."""
        sides = (
            sorted((radius, sense * turn % 360) for *_, turn, radius in self.flats)
            for sense in (1, -1)
        )
        return min(sides)

    @property
    def tight_places(self) -> list[list[float]]:
        """Of the tight holes, how far each is from the lettered ones, whichever side is up."""
        places = [z for name, z in self.named if name in self.tight]
        return sorted(sorted(round(abs(z - w), 1) for _, w in self.named) for z in places)

    @property
    def key(self) -> tuple[object, ...]:
        """What two links have in common that are one and the same, turned over or not."""
        plain = self.part.prismatic and (self.part.lettered or not self.part.engraved)
        return (
            [each[0] for each in self.lengths],
            sorted(round(radius, 3) for _, radius in self.holes),
            self.flat_places,
            self.tight_places,
            self.sunk,
            round(self.part.thickness, 3),
            round(abs(self.part.region.outer.area), 1),
            "" if plain else self.part.name,
        )


def with_sorting(
    table: Table, parts: Sequence[Part], copies: Sequence[StandingCopy], fixing: Fixing
) -> Table:
    """The order of assembly, begun with the parts that look alike; as it is where none do."""
    tight: dict[str, set[str]] = {}
    for holes in tight_holes(copies, fixing).values():
        for name, (_, letters) in holes.items():
            tight.setdefault(name, set()).update(letters)
    made = (part for part in parts if part.process == "printed" and not part.role)
    links = (_Link(part, frozenset(tight.get(part.name, ()))) for part in made)
    alike = _groups((each for each in links if len(each.named) > 1), _Link.looks_like)
    lettered = [link for group in alike if _told_by_letters(group) for link in group]
    alike = [group for group in alike if not _told_by_letters(group)]
    lines = [*map(_told_apart, alike)]
    rounds = (part for part in parts if part.role in _ROUND)
    lines += [*map(_by_height, _groups(rounds, _of_one_width))]
    if not (lines or lettered):
        return table
    said = _SORT + (_WRITE if alike else "")
    said += _LENGTHS if any(" mm from " in line for line in lines) else ""
    said += _ONE if any(_OR in line for line in lines) else ""
    if any(_NARROW in line for line in lines):
        said += _UNSEEN
    if lettered:
        names = (
            f"{link.part.name} {' '.join(name for name, _ in link.named)}" for link in lettered
        )
        lines.insert(0, f"letters beside their holes name these: {', '.join(names)}")
        lines.append(_faces(table, copies))
    said += "".join(f"\n☐ {line}" for line in lines if line)
    one = {copy.part.name: copy.name for copy in reversed(copies)}
    seen = [link.part for group in alike for link in group]
    laid = [(part.name, [one[part.name]], ()) for part in seen if part.name in one]
    needs = ("marker", "caliper") if alike else ("caliper",)
    begins = Doing(said, needs=needs)
    return begun(table, begins, "Parts that look alike", "; ".join(filter(None, lines)), laid=laid)


def _faces(table: Table, copies: Sequence[StandingCopy]) -> str:
    """On which side letters are as parts go on, in words; of a machine of two sides for each of them."""
    turned = {name: step.up[2] < 0 for step in table.steps for name in step.copies}
    faces = defaultdict[bool, dict[str, bool]](
        dict
    )  # by whether of the side turned over, of each part
    for copy in copies:
        if copy.part.lettered and copy.name in turned:
            far = turned[copy.name]
            faces[far][copy.part.name] = copy.pose.flipped is far
    said = []
    for far, parts in sorted(faces.items()):
        up, down = (
            [name for name, is_up in parts.items() if is_up is each] for each in (True, False)
        )
        few, rest = (up, "down") if len(up) < len(down) else (down, "up")
        but = f", except on {listed(few)}" if few else ""
        whose = "on the far side they" if far else "as parts go on, letters"
        said.append(f"{whose} face {rest}{but}")
    return "; ".join(said)


_SORT = "sort what looks alike"
_WRITE = (
    ". Write on each part its name and the letters of its holes; its picture among the parts shows them. Do this before you "
    "open holes"
)
_OR = " or "  # between parts that are one
_LENGTHS = ". Lengths are from the middle of one hole to that of another"
_ONE = '. Parts with "or" between them are the same, turned over'
_NARROW = "narrower in "
_UNSEEN = (
    ". Narrower holes, in which pins are fixed, look like the others: write the name on such a part as you take it off the printer's "
    "plate, where the slicer names it, or make all again with files.hole_letters = true, which engraves the letters"
)


def _told_by_letters(links: Sequence[_Link]) -> bool:
    """Whether engraved letters tell links apart."""
    names = {frozenset(name for name, _ in each.named) for each in links}
    return all(each.lettered for each in links) and len(names) == len(links)


def _groups(items: Iterable[T], alike: Callable[[T, T], bool]) -> list[list[T]]:
    """Items that are like the first one of a group, where there are several."""
    groups: list[list[T]] = []
    for item in items:
        group = next((each for each in groups if alike(each[0], item)), None)
        if group is None:
            groups.append([item])
        else:
            group.append(item)
    return [group for group in groups if len(group) > 1]


def _size(part: Part) -> tuple[float, float]:
    """Of a part's outline, the longer side first, mm."""
    low, high = extent([layer.region.outer for layer in part.layers])
    sides = high.real - low.real, high.imag - low.imag
    return max(sides), min(sides)


def _of_one_width(a: Part, b: Part) -> bool:
    """Whether two round parts, both pins or none, look alike but for their heights."""
    if ("pin" in a.role) != ("pin" in b.role):
        return False
    return math.isclose(_size(a)[0], _size(b)[0], rel_tol=_ALIKE)


def _by_height(parts: Sequence[Part]) -> str:
    """Round parts by their heights, in words."""
    ordered = sorted(parts, key=lambda each: each.thickness)
    along = "long" if any("pin" in each.role for each in parts) else "high"
    return f"{listed(f'{each.name} {each.thickness:.4g}' for each in ordered)} mm {along}"


def _told_apart(links: Sequence[_Link]) -> str:
    """What tells links apart that look alike, in words; those that are one and the same together."""
    classes: list[list[_Link]] = []
    for link in links:
        same = next((each for each in classes if each[0].key == link.key), None)
        if same is None:
            classes.append([link])
        else:
            same.append(link)
    told = _telling([same[0] for same in classes])
    return "; ".join(
        f"{_OR.join(each.part.name for each in same)}{_words(same, told)}" for same in classes
    )


_Telling = Callable[[_Link], tuple[str, str]]  # what, and what of it differs in links that are one


def _words(same: Sequence[_Link], told: Sequence[_Telling]) -> str:
    """What is said of links that are one and the same."""
    said = []
    for tell in told:
        what, _ = tell(same[0])
        said.append(what + " or ".join(dict.fromkeys(tell(link)[1] for link in same)))
    return f": {', '.join(said)}" if said else ""


def _telling(links: Sequence[_Link]) -> list[_Telling]:
    """What is said of each of several links, each other than the others; nothing of one alone."""

    def spread(values: Iterable[float]) -> float:
        values = list(values)
        return max(values) - min(values)

    lengths = [spread(each.lengths[k][0] for each in links) for k in range(len(links[0].lengths))]
    longest = max(range(len(lengths)), key=lambda k: lengths[k])

    def length(link: _Link) -> tuple[str, str]:
        apart, a, b = link.lengths[longest]
        return f"{apart:.1f} mm from ", f"{a} to {b}"

    def tight(link: _Link) -> tuple[str, str]:
        letters = [name for name, _ in link.named if name in link.tight]
        return _NARROW, listed(letters) or "none"

    def count(link: _Link) -> tuple[str, str]:
        return f"{len(link.holes)} holes", ""

    def flat(link: _Link) -> tuple[str, str]:
        turned = [f"{a}'s {turn:g} deg from {b}" for a, b, turn, _ in link.flats]
        return "seen from above flats lie ", listed(turned)

    def size(link: _Link) -> tuple[str, str]:
        return "{:.1f} x {:.1f} mm".format(*link.size), ""

    def sunk(link: _Link) -> tuple[str, str]:
        return f"{link.sunk or 'none'} of them wider at one face", ""

    told: list[_Telling] = [length] if lengths[longest] >= _MEASURED else []
    told += [count] if spread(len(each.holes) for each in links) else []
    told += [tight] if any(each.tight_places != links[0].tight_places for each in links) else []
    if all(each.flats for each in links):
        told += [flat] if any(each.flat_places != links[0].flat_places for each in links) else []
    if told or len(links) == 1:
        apart = len({_words([each], told) for each in links}) == len(links)
        further = sunk if spread(each.sunk for each in links) else size
        return told if apart else [*told, further]
    return [length] if lengths[longest] >= _SEEN else [size]
