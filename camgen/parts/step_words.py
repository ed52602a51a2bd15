"""Words of the steps of assembly: names of parts, lists, what sets a gap, and where something goes, as pieces of sentences."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from camgen.parts.fixing import Joint
from camgen.parts.part import Part
from camgen.parts.standing import Seat, StandingCopy
from camgen.study import Doing
from camgen.tolerances import SAME_POINT

HOLE = "{hole}"  # in words, for a hole's letter
WHAT = "{what}"  # in what is done, for what it is done with
IT = "{it}"  # the same where it is named again
_TURNED = {"flat": "flat on flat", "key": "its key in both keyways"}
TWO_PART = "two-part glue"  # of plastic: sets slowly, and bears what a flat would press too hard
_VERBS: dict[Joint, str] = {
    "glued": "glue ",
    "keyed and glued": "press and glue ",  # the key is tight
    "pressed and glued": "press and glue ",
    "pressed": "press ",
    "": "put ",
}
# What a machine has many of is called by its name alone, as it lies in the folder.
_BY_NAME = ("pin", "crank-pin", "spacer", "sleeve", "cap", "nut", "cover", "keeper", "thread-post")


def turned(seat: Seat, metal: bool) -> str:
    """How what a flat or a key turns goes on: with which glue on a flat, where parts are of plastic."""
    glued = f", with {TWO_PART}" if seat == "flat" and not metal else ""
    return f"{_TURNED[seat]}{glued}" if seat else ""


def verb(joint: Joint) -> str:
    """How a sentence begins that fixes a part."""
    return _VERBS[joint]


@dataclass(frozen=True)
class Place:
    """Where something goes, "on pin-1", and what is done for it; both empty where nothing says."""

    where: str = ""
    doings: tuple[Doing, ...] = ()

    def lettered(self, letters: Sequence[str], called: str) -> Place:
        """With the letters of the holes of one part, one for each copy, and what goes there by its name."""
        said = listed(dict.fromkeys(letters))
        again = "each" if len(letters) > 1 else "it"

        def full(text: str) -> str:
            return text.replace(HOLE, said).replace(WHAT, called).replace(IT, again)

        doings = (
            replace(each, verb=full(each.verb), thing=full(each.thing), rest=full(each.rest))
            for each in self.doings
        )
        return Place(full(self.where), tuple(doings))


def where_all(places: Iterable[Place]) -> str:
    """Where copies go."""
    return "; ".join(each.where for each in places)


def step_of(copy: StandingCopy) -> str:
    """What stands for the number of the next step that has a copy."""
    return f"{{{copy.name}}}"


def listed(names: Iterable[str]) -> str:
    """Names as a sentence has them: "A, B and C"."""
    *most, last = [*names] or [""]
    return " and ".join(filter(None, (", ".join(most), last)))


_SHEET = 0.1  # mm, of a sheet of paper of 80 g, about
_FOIL = 0.05  # mm, of a freezer bag or a strong plastic bag, about
_SHEETS = (
    "",
    "one sheet of paper",
    "two sheets of paper",
    "three sheets of paper",
    "four sheets of paper",
    "five sheets of paper",
    "six sheets of paper",
)
STRIP = "a strip of a plastic bag"
FEELER = "a feeler gauge"


def thickness_gauge(gap: float) -> str:
    """What at hand is as thick as a gap, mm: sheets of paper, a strip of a plastic bag, both, or else a feeler gauge."""
    halves = round(gap / _FOIL)
    count = halves // 2
    if not 0 < halves < 2 * len(_SHEETS) or abs(gap - halves * _FOIL) > SAME_POINT:
        return FEELER
    return listed(filter(None, (_SHEETS[count], STRIP if halves % 2 else "")))


def between(gap: float, metal: bool = False) -> str:
    """How a gap, mm, is set at the bench, in brackets; metal: between parts of it."""
    gauge = FEELER if metal else thickness_gauge(gap)
    return f" ({gauge} between, then pull {pronoun(gauge)} out)"


def gauge_tools(gap: float) -> tuple[str, ...]:
    """The tools of a thickness gauge, as in parts.tools."""
    gauge = thickness_gauge(gap)
    if gauge == FEELER:
        return ("feeler gauges",)
    return ("sheets of paper",) * ("paper" in gauge) + ("plastic bag",) * (STRIP in gauge)


def pronoun(gauge: str) -> str:
    """What stands for a thickness gauge: "them" of several things."""
    return "them" if gauge.startswith(_SHEETS[2:]) or " and " in gauge else "it"


ON_BENCH = " on the bench"
MOVES = "move "  # begins what is tried at the end of a step
LIES_ON_BENCH = Place("on the bench", (Doing("lay ", WHAT, ON_BENCH),))


def called(part: Part, count: int = 1) -> str:
    """What so many copies of a part are called in a sentence: by their name, and where that says too little by their title."""
    title = part.title[:1].lower() + part.title[1:]
    words = set(re.split(r"\W+|_", title.lower()))
    link = part.points and part.title.lower() == part.name.replace("_", " ").lower()
    if part.role in _BY_NAME or link:
        title = part.name
    elif count == 1:
        title = f"the {title}"
    if part.name != title and not {*re.split(r"\W+|_", part.name.lower())} <= words:
        title = f"{title} ({part.name})"
    return f"{count} × {title}" if count > 1 else title


# level, first part of the sub-assembly, its name, part in it, whether turned over, underside
