"""In which order a machine goes together, and where each part goes: on which shaft, how high, over which hole.

Where a hole of one part and an outline of another have one axis and heights in common, the one goes on the other; where two holes
have one axis, they lie over each other and a pin comes through.

    stop          what says how high a part is fixed on a shaft that goes on below it: the part over it. It is loose at first, and
                  glued when its shaft carries another part over the stop
    tight         a hole that is hardly wider than what goes through it: there both are fixed on each other. It is said of the one
                  that comes later, so that what is pressed in or on is held by something that is there
    sub-assembly  parts of one body that begin at one height and are fixed on each other: built by itself, then put in
"""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import takewhile
from typing import Literal

from camgen.machine.features import CamOutline, PinEyes, SlideFaces
from camgen.machine.model import GROUND
from camgen.parts.part import HoldingNote, Part
from camgen.parts.standing import Round, Slot, StandingCopy, has_flat
from camgen.study import Doing, Mate, Step, Table
from camgen.tolerances import SAME_POINT

COLUMNS = ("step", "part", "what", "where", "count", "underside at z, mm", "lies")
_SMALL = ("spacer", "cap", "nut")  # of parts of which several are put on in one step
_RESTS = 1.0  # mm, at most between a part and what lies under it


@dataclass(frozen=True)
class Fixing:
    """What of two parts that go through each other is fixed."""

    play: float  # greatest of a hole that is tight, mm
    rings: frozenset[str] = frozenset()  # names of ball bearings, which are pressed and not glued
    driven: frozenset[str] = frozenset()  # names of parts in which the shaft of a motor ends
    dry: frozenset[str] = frozenset()  # names of parts that are held without glue

    def how(
        self, hole: Round | Slot, holder: Part, outline: Round, held: Part
    ) -> Literal["glue", "press", "free"]:
        """How an outline is fixed in a hole: "free" where it goes through with play, or both are bought to go together."""
        if hole.diameter - outline.diameter > self.play or {holder.name, held.name} & self.dry:
            return "free"
        if holder.process == held.process == "bought" or holder.name in self.rings:
            return "free"  # a bearing's ring turns with its pin, and holds it by nothing
        return "press" if held.name in self.rings else "glue"


_HOLE = "{hole}"  # in words, for a hole's letter
_WHAT = "{what}"  # in what is done, for what it is done with
_IT = "{it}"  # the same where it is named again
_WORDS = {"glue": "pressed and glued", "press": "pressed", "free": ""}
_VERBS = {"glue": "press and glue ", "press": "press ", "free": "put "}
# What a machine has many of is called by its name alone, as it lies in the folder.
_BY_NAME = ("pin", "crank-pin", "spacer", "cap", "nut", "cover", "keeper", "thread-post")


@dataclass(frozen=True)
class _Place:
    """Where something goes, "on pin-1", and what is done for it; both empty where nothing says."""

    where: str = ""
    doings: tuple[Doing, ...] = ()

    def lettered(self, letters: Sequence[str], called: str) -> _Place:
        """With the letters of the holes of one part, one for each copy, and what goes there by its name."""
        said = listed(dict.fromkeys(letters))
        again = "each" if len(letters) > 1 else "it"

        def full(text: str) -> str:
            return text.replace(_HOLE, said).replace(_WHAT, called).replace(_IT, again)

        doings = (Doing(*map(full, (each.verb, each.thing, each.rest))) for each in self.doings)
        return _Place(full(self.where), tuple(doings))


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
)
_STRIP = "a strip of a plastic bag"
_FEELER = "a feeler gauge"


def thickness_gauge(gap: float) -> str:
    """What at hand is as thick as a gap, mm: sheets of paper, a strip of a plastic bag, both, or else a feeler gauge."""
    halves = round(gap / _FOIL)
    count = halves // 2
    if not 0 < halves < 2 * len(_SHEETS) or abs(gap - halves * _FOIL) > SAME_POINT:
        return _FEELER
    return listed(filter(None, (_SHEETS[count], _STRIP if halves % 2 else "")))


def between(gap: float) -> str:
    """How a gap, mm, is set at the bench, in brackets."""
    gauge = thickness_gauge(gap)
    several = gauge.startswith(_SHEETS[2:]) or " and " in gauge
    return f" ({gauge} between, then pull {'them' if several else 'it'} out)"


ON_BENCH = " on the bench"
MOVES = "move "  # begins what is tried at the end of a step
_ON_BENCH = _Place("on the bench", (Doing("lay ", _WHAT, ON_BENCH),))


def called(part: Part, count: int = 1) -> str:
    """What so many copies of a part are called in a sentence: by their name, and where that says too little by their title."""
    title = part.title[:1].lower() + part.title[1:]
    words = set(re.split(r"\W+|_", title.lower()))
    if part.role in _BY_NAME or part.title == f"Link {part.name}":
        title = part.name
    elif count == 1:
        title = f"the {title}"
    if part.name != title and not {*re.split(r"\W+|_", part.name.lower())} <= words:
        title = f"{title} ({part.name})"
    return f"{count} × {title}" if count > 1 else title


# level, first part of the sub-assembly, its name, part in it, whether turned over, underside
_Key = tuple[float, int, str, int, bool, float]


@dataclass(frozen=True)
class _Laying:
    """Copies of one part that come in one step."""

    copies: Sequence[StandingCopy]
    z: float  # of their undersides, mm
    turned_over: bool
    cluster: Sequence[StandingCopy]  # the sub-assembly that they are of; empty where of none


def order(
    copies: Sequence[StandingCopy],
    pairs: Sequence[object],
    fixing: Fixing,
    blocks: float = 0.0,
) -> Table:
    """Steps by the height of undersides; what is turned over, such as a pin with its head up, comes from above: by its top; a
    ball bearing with the link that holds it.

    copies: as they stand at one angle; pairs: what joints are measured on; blocks: height of those under the plate, mm.
    """
    fixing = with_joints(fixing, pairs)
    rows = list[tuple[object, ...]]()
    steps = list[Step]()
    there = list[StandingCopy]()
    bench = list[StandingCopy]()  # the sub-assembly that is being built
    stops = _stops(copies, fixing)
    loose = list[_Laying]()  # on their shafts, whose stops are not there yet
    layings = _layings(copies, pairs, fixing)
    for number, laying in enumerate(layings, 1):
        after = (copy for each in layings[number:] for copy in each.copies)
        later = [copy for copy in after if copy.name not in stops]
        cluster = laying.cluster
        part = laying.copies[0].part
        begun = any(copy in there for copy in cluster)
        alone = bool(bench) or (bool(cluster and there) and not begun)
        group = cluster[0].part.name if alone else ""
        # whether it comes on what the step before has brought: a shaft, or a plate that came first
        begins = bool(there) and all(copy in cluster for copy in there) and not bench
        by_hand = [] if alone or begins else [*_by_hand(laying.copies, there, fixing)]
        if all(copy.name in stops for copy in laying.copies):
            shafts = {stops[copy.name].shaft.name: stops[copy.name].shaft for copy in laying.copies}
            places = [_loosely(laying, [each.part.name for each in shafts.values()])]
            loose.append(laying)
            begins = bool(steps and {*shafts} <= {*steps[-1].copies})
            by_hand = [  # what is pushed up on its shaft later
                (part.name, hole.name)
                for copy in laying.copies
                for hole, _ in _fixed_on(copy, [stops[copy.name].shaft], fixing)
            ]
        else:
            places = _places(laying.copies, bench if alone else there, fixing)
            if not alone:
                places = _on_motor(laying.copies, fixing, places, there)
            if not places and alone:
                places = [_ON_BENCH]
            elif not places and (there or not laying.copies[0].holes):
                # a plate that comes first lies
                places = _fixed_one_by_one(later, laying.copies, there, fixing, blocks)
                places = places or _waiting(later, laying.copies)
        lies = "turned over" if laying.turned_over else "as drawn"
        row: tuple[object, ...]
        row = (
            part.name,
            holding_notes(part),
            _where_all(places),
            len(laying.copies),
            laying.z,
            lies,
        )
        rows.append((len(rows) + 1, *row))
        names = [copy.name for copy in laying.copies]
        said = _doings(laying, places, _led(laying.copies[0], there, pairs), first=not there)
        borne = [] if alone else _borne(laying.copies, there, fixing, blocks)
        moved = [] if alone else _moved(laying.copies, there, fixing)
        steps.append(
            Step(
                [*said, *borne, *moved],
                names,
                group=group,
                what=called(part, len(names)).removeprefix("the "),
                small=part.role in _SMALL or part.process == "dummy",
                follows=begins,
                hand_fits=by_hand,
            )
        )
        (bench if alone else there).extend(laying.copies)
        if bench and len(bench) == len(cluster):
            row, doings = _put_in(cluster, there, later, fixing, blocks)
            rows.append((len(rows) + 1, *row))
            by_hand = [*_by_hand(cluster, there, fixing)]
            steps.append(Step(doings, group=group, hand_fits=by_hand))
            there += bench
            bench = []
        for each in [each for each in loose if _held(each, stops, there, fixing)]:
            loose.remove(each)
            row, doings = _push_up(each, stops)
            rows.append((len(rows) + 1, *row))
            names = [copy.name for copy in each.copies]
            steps.append(Step(doings, names, way=1, what=each.copies[0].part.title.lower()))
    title = "Assembly from the bottom up, by height"
    return Table(title, COLUMNS, rows, mated(steps, copies, pairs, fixing))


def _by_hand(
    coming: Sequence[StandingCopy], there: Sequence[StandingCopy], fixing: Fixing
) -> Iterator[tuple[str, str]]:
    """Holes, by part and letter, in which something is fixed in the machine, where no vice gets in: as soon as a plate is there."""
    if not any(each.mount.body == GROUND and each.holes for each in there):
        return
    for copy in coming:
        if copy.part.name in fixing.driven and copy.mount.body != GROUND:
            yield from ((copy.part.name, hole.name) for hole in copy.holes if hole.flat)
        for other in there:
            for holder, held in ((copy, other), (other, copy)):
                if holder.pose.standing != held.pose.standing:
                    continue
                for hole in holder.holes:
                    for each in held.outlines:
                        how = fixing.how(hole, holder.part, each, held.part)
                        if hole.holds(each) and how == "glue":
                            yield holder.part.name, hole.name


def _borne(
    coming: Sequence[StandingCopy],
    there: Sequence[StandingCopy],
    fixing: Fixing,
    blocks: float,
) -> list[Doing]:
    """What bears links, and a plate on blocks, while pins are pressed into them from above."""
    letters = defaultdict[str, list[str]](list)
    for copy in coming:
        for other in there if copy.mount.flipped else ():
            bench = other.mount.body == GROUND and not blocks  # on which it lies
            for mate in () if bench else _mates([copy], [other], fixing):
                if mate.how != "free" and mate.comes:
                    letters[other.part.name] += [mate.label] if mate.label else []
    under = listed(
        f"{listed(dict.fromkeys(own))} of {name}" if own else name for name, own in letters.items()
    )
    rest = ", or under what lies there: it must not bend while you press"
    return [Doing("put a block under ", under, rest)] if under else []


def _moved(
    coming: Sequence[StandingCopy], there: Sequence[StandingCopy], fixing: Fixing
) -> list[Doing]:
    """What is tried when a cap or a pin with a head keeps links in place: that they still move."""
    names = dict[str, None]()
    for copy in coming:
        heads = copy.part.role == "cap" or (copy.mount.flipped and len(copy.outlines) > 1)
        fixed = [*_by_hand([copy], there, fixing)] if heads else []
        if not fixed:
            continue
        axes = [*copy.holes, *copy.outlines]
        for other in there:
            turns = other.part.points and other.mount.body not in (GROUND, copy.mount.body)
            letters = {name for part, name in fixed if part == other.part.name}
            if turns and any(
                hole.name not in letters and any(map(hole.in_line, axes)) for hole in other.holes
            ):
                names[other.part.name] = None
    return [Doing(MOVES, name, " by hand: no joint may be stiff") for name in names]


@dataclass(frozen=True)
class _Stop:
    """What says how high a part is fixed on its shaft, where nothing lies under it and neither end is flush: what comes over it."""

    shaft: StandingCopy
    name: str  # of the part over it, in which the shaft turns
    gap: float  # mm, between both

    def place(self) -> _Place:
        """Where the part is glued."""
        near, gauge = "against", ""
        if self.gap > SAME_POINT:
            near, gauge = f"{self.gap:.2g} mm under", between(self.gap)
        at = f"on {self.shaft.part.name}, {near} {self.name}"
        return _Place(
            f"{_WORDS['glue']} {at}",
            (
                Doing(
                    f"push {_WHAT} up: press and glue it ",
                    f"on {self.shaft.part.name}",
                    f", {near} {self.name}{gauge}",
                ),
            ),
        )


def _stops(copies: Sequence[StandingCopy], fixing: Fixing) -> dict[str, _Stop]:
    """Stops of the copies that have one, by their names."""
    stops = dict[str, _Stop]()
    for copy in copies:
        others = [each for each in copies if each is not copy]
        for hole, shaft in _fixed_on(copy, others, fixing):
            over = [
                (each.low - hole.high, other.part.name)
                for other in others
                for each in other.holes
                if hole.in_line(each) and -SAME_POINT < each.low - hole.high < _RESTS
            ]
            if over and not _support(hole, shaft, others):
                gap, name = min(over)
                stops[copy.name] = _Stop(shaft, name, gap)
    return stops


def _fixed_on(
    copy: StandingCopy, copies: Sequence[StandingCopy], fixing: Fixing
) -> Iterator[tuple[Round, StandingCopy]]:
    """Holes of a copy that are glued on a shaft, with that shaft."""
    for hole in copy.holes:
        for shaft in copies:
            for outline in shaft.outlines if shaft.slender else ():
                if (
                    hole.holds(outline)
                    and fixing.how(hole, copy.part, outline, shaft.part) == "glue"
                ):
                    yield hole, shaft


def _held(
    laying: _Laying, stops: Mapping[str, _Stop], there: Sequence[StandingCopy], fixing: Fixing
) -> bool:
    """Whether all shafts of what is loose carry another part, higher up."""
    own = {copy.name for copy in laying.copies}
    return all(
        any(
            shaft is stops[copy.name].shaft
            for other in there
            if other.name not in own and other.mount.z > copy.mount.z
            for _, shaft in _fixed_on(other, there, fixing)
        )
        for copy in laying.copies
    )


def _loosely(laying: _Laying, shafts: Sequence[str]) -> _Place:
    """Where copies stay until they are pushed up; shafts: of each of them."""
    first = laying.copies[0]
    until = f"; loose until {_step_of(first)}"
    doings = (Doing("put ", f"{called(first.part)} loosely on {each}", until) for each in shafts)
    return _Place(f"loose on {', '.join(dict.fromkeys(shafts))}", tuple(doings))


def _push_up(laying: _Laying, stops: Mapping[str, _Stop]) -> tuple[tuple[object, ...], list[Doing]]:
    """The row and what is done with what was loose on its shaft and is glued under its stop."""
    part = laying.copies[0].part
    places = list(dict.fromkeys(stops[copy.name].place() for copy in laying.copies))
    row = (part.name, f"{part.title}: push it up", _where_all(places), "", laying.z, "as drawn")
    named = called(part, len(laying.copies) if len(places) == 1 else 1)
    return row, [doing for place in places for doing in place.lettered("", named).doings]


def _step_of(copy: StandingCopy) -> str:
    """What stands for the number of the next step that has a copy."""
    return f"{{{copy.name}}}"


def _fixed_by(
    later: Iterable[StandingCopy],
    copies: Sequence[StandingCopy],
    there: Sequence[StandingCopy],
    fixing: Fixing,
    blocks: float,
) -> list[_Place]:
    """What is said of copies that nothing holds yet: which part that comes later is fixed on them, or goes on or in them; later: in
    the order of their steps."""
    joins = ""
    steps = ""  # the same, with their numbers
    for copy in later:
        mates = _mates([copy], copies, fixing)
        by = _by(mates, copy, copies)
        if any(mate.how != "free" and not mate.comes for mate in mates):
            joins += " and " if joins else ""
            steps += " and " if steps else ""
            said = f"{copy.part.name} is glued on it{by}"
            steps = f"{steps}{said} in {_step_of(copy)}"
            return [_loose(f"{joins}{said}", steps, copies, there, blocks)]
        if mates and not joins:
            joins = f"{copy.part.name} joins it{by}"
            steps = f"{joins} in {_step_of(copy)}"
    return [_loose(joins, steps, copies, there, blocks)] if joins else []


def _fixed_one_by_one(
    later: Sequence[StandingCopy],
    copies: Sequence[StandingCopy],
    there: Sequence[StandingCopy],
    fixing: Fixing,
    blocks: float,
) -> list[_Place]:
    """The same of copies of one part that are not fixed on each other, alike ones together."""
    found = defaultdict[str, list[_Place]](list)
    for copy in copies:
        for place in _fixed_by(later, [copy], there, fixing, blocks):
            found[place.where].append(place)
    part = copies[0].part
    return [each[0].lettered([""] * len(each), called(part, len(each))) for each in found.values()]


def _waiting(later: Sequence[StandingCopy], copies: Sequence[StandingCopy]) -> list[_Place]:
    """Under which hole of a part that comes later each copy lies, such as a nut; nothing where one lies under none."""
    doings = list[Doing]()
    for copy in copies:
        over = [
            (hole.name, other)
            for other in later
            for hole in other.holes
            if hole.name and any(map(hole.in_line, copy.holes))
        ]
        if not over:
            return []
        point, other = over[0]
        under = f"{called(copy.part)} under {point} of {other.part.name}"
        doings.append(Doing("lay ", under, f", which comes in {_step_of(other)}"))
    return [_Place("", tuple(doings))]


def _loose(
    until: str,
    steps: str,
    copies: Sequence[StandingCopy],
    there: Sequence[StandingCopy],
    blocks: float,
) -> _Place:
    """Where copies stand that nothing holds yet; until: what joins and holds them, steps: the same with the numbers of steps."""
    first, *others = copies
    over = [
        f"{hole.name} over {other.part.name}"
        for hole in first.holes
        for other in there
        if hole.name and any(map(hole.in_line, other.holes))
    ]
    at = f"with {listed(dict.fromkeys(over))}" if over else "as the picture shows"
    doing = Doing("lay ", f"{_WHAT} {at}", f"; loose until {steps}{_prop(first, there, blocks)}")
    if first.slender or (first.outlines and not first.holes):
        below = _stands_over(first, there)
        foot = [each for each in others if each.mount.z < first.mount.z + SAME_POINT]
        low = min(first.outlines, key=lambda each: each.low)
        head = low.diameter - min(each.diameter for each in first.outlines) > SAME_POINT
        down = f", {listed(dict.fromkeys(each.part.name for each in foot))} down" if foot else ""
        down = down or (", head down" if head else "")
        down = down or _end_down(first)
        doing = Doing("stand ", f"{_WHAT} upright{below}{down}", f"; loose until {steps}")
    return _Place(f"loose until {until}", (doing,))


def _prop(copy: StandingCopy, there: Sequence[StandingCopy], blocks: float) -> str:
    """The block that goes under a part that is laid down; "" where it lies on something. blocks: height of those under the plate, mm."""
    plate = min(
        (each for each in there if each.mount.body == GROUND and each.holes),
        key=lambda each: each.mount.z,
        default=None,
    )
    if plate is None or not copy.holes or any(_under(hole, there)[1] for hole in copy.holes):
        return ""
    if copy.mount.z - plate.mount.z - plate.part.thickness < _RESTS:
        return ""
    high = copy.mount.z - plate.mount.z + blocks
    where = f", where those under {plate.part.name} are {blocks:g} mm high" if blocks else ""
    return f". Prop it on a block {high:.3g} mm high{where}"


def _end_down(shaft: StandingCopy) -> str:
    """Which end of a shaft is down, as ", its flat end down"; "" where both ends are alike."""
    layers = sorted(shaft.part.layers, key=lambda each: each.z0)
    low, high = (
        sum(
            each.z1 - each.z0
            for each in takewhile(lambda each: has_flat(each.region.outer), ordered)
        )
        for ordered in ((layers[::-1], layers) if shaft.mount.flipped else (layers, layers[::-1]))
    )
    if abs(low - high) < _RESTS / 2:
        return ""
    if not (low and high):
        return f", its flat end {'down' if low else 'up'}"
    return f", its {'longer' if low > high else 'shorter'} flat, of {low:.3g} mm, down"


def _stands_over(shaft: StandingCopy, there: Sequence[StandingCopy]) -> str:
    """Over which hole or part that is there a pin or a shaft stands, as " over B of low2"; "" where over none."""
    low = min(each.low for each in shaft.outlines)
    under = [
        (bool(each.name), round(each.high, 6), f"{each.name} of " if each.name else "", other)
        for other in there
        for each in (*other.holes, *other.outlines)
        if each.in_line(shaft.outlines[0]) and each.high < low + SAME_POINT
    ]
    if not under:
        return ""
    _, _, point, other = max(under, key=lambda each: each[:2])
    return f" over {point}{other.part.name}"


def _by(mates: Iterable[Mate], copy: StandingCopy, copies: Iterable[StandingCopy]) -> str:
    """By which holes a copy goes on copies, in words; "" where they have no letters but the names of what goes through."""
    letters = {name for name, _ in copy.part.points} - {each.part.name for each in copies}
    named = dict.fromkeys(mate.label for mate in mates if mate.label in letters)
    return f" by {' and '.join(named)}" if named else ""


def _put_in(
    cluster: Sequence[StandingCopy],
    there: Sequence[StandingCopy],
    later: Sequence[StandingCopy],
    fixing: Fixing,
    blocks: float,
) -> tuple[tuple[object, ...], list[Doing]]:
    """The row of a sub-assembly that is built, and what is done with it; the first of its copies names it."""
    first = cluster[0]
    own = first.part.name
    others = list(dict.fromkeys(each.part.name for each in cluster if each.part.name != own))
    places = list[_Place]()
    for copy in cluster:
        if not _mates([copy], there, fixing):
            continue
        found = _places([copy], there, fixing)
        if copy.part.name != own:
            found = [_Place(f"{copy.part.name} {each.where}", each.doings) for each in found]
        places += [each for each in found if each not in places]
    places = _on_motor(cluster, fixing, places, there)
    if not places and there and (first.mount.body != GROUND or not first.holes):
        places = _fixed_by(later, cluster, there, fixing, blocks)  # a plate lies as it is
    places = [each.lettered("", called(first.part)) for each in places or [_ON_BENCH]]
    what = f"{first.part.title} with {', '.join(others or [own])}"
    row = (own, what, _where_all(places), "", first.mount.z, "as drawn")
    doings = [doing for place in places for doing in place.doings]
    return row, [*doings, *_jig(cluster, there, later, fixing)]


def _jig(
    cluster: Sequence[StandingCopy],
    there: Sequence[StandingCopy],
    later: Sequence[StandingCopy],
    fixing: Fixing,
) -> Iterator[Doing]:
    """That a plate which comes later is laid on the pins dry over the shaft of a web that is glued on its own: nothing else holds that
    upright. A square says whether it is where there are no pins yet."""
    shafts = [copy for copy in cluster if copy.part.role == "shaft"]
    if not shafts or not any(mate.how == "glue" for mate in _mates(cluster, there, fixing)):
        return
    plates = [copy for copy in later if copy.mount.body == GROUND and copy.part.points]
    if plates and not any(_mates([plate], there, fixing) for plate in plates):
        holder = next(copy for copy in cluster if copy not in shafts).part.name
        square = f" is square to {holder}, and leave it until the glue is hard"
        yield Doing("check with a square that ", shafts[0].part.name, square)
        return
    for plate in plates:
        mates = [mate for mate in _mates([plate], shafts, fixing) if mate.label]
        if mates:
            over = f", with {mates[0].label} over {shafts[0].part.name}"
            yield Doing(f"lay {plate.part.name} on the pins, dry", over)
            until = ": it keeps the shaft upright. Then take it off"
            yield Doing("leave it there until the glue is hard", "", until)
            return


def _on_motor(
    copies: Sequence[StandingCopy],
    fixing: Fixing,
    places: Sequence[_Place],
    there: Sequence[StandingCopy],
) -> list[_Place]:
    """Where copies go, with the motor's shaft if one of them is fixed on that."""
    driven = [
        hole
        for copy in copies
        if copy.part.name in fixing.driven and copy.mount.body != GROUND
        for hole in copy.holes
    ]
    if not driven:
        return [*places]
    shaft = "on the motor's shaft"
    glued = ", flat on flat, with a trace of glue in its bore and none on the motor"
    flat = glued if any(hole.flat for hole in driven) else ""
    gap, under = min(
        (each for hole in driven if (each := _under(hole, there))[1]), default=(0.0, "")
    )
    high = f", {gap:.3g} mm over {under}{between(gap)}" if gap > SAME_POINT else ""
    where = ", ".join(filter(None, (shaft, _where_all(places))))
    named = called(copies[0].part)
    doings = [one for each in places for one in each.doings]
    on = doings.pop(0).thing.removeprefix(named) if doings and doings[0].verb == "set " else ""
    push = Doing("push ", f"{named} {shaft}{f',{on}' if on else ''}{flat}{high}")
    return [_Place(f"pushed {where}", (push, *doings))]


def with_joints(fixing: Fixing, pairs: Sequence[object]) -> Fixing:
    """The fixing that knows the ball bearings of joints, and what is on the shaft of a motor, which no part is."""
    eyes = [each for each in pairs if isinstance(each, PinEyes)]
    driving = (each for each in eyes if each.pin is not None and each.pin.part is None)
    driven = {eye.part for each in driving for eye in (each.a, each.b) if eye.part is not None}
    rings = frozenset(ring.part for each in eyes for ring in each.rings)
    return replace(fixing, rings=fixing.rings | rings, driven=frozenset(driven))


def _doings(laying: _Laying, places: Sequence[_Place], led: str, first: bool) -> list[Doing]:
    """What is done with the copies of one part; led: in or against what they run; first: nothing is there yet."""
    part = laying.copies[0].part
    named = called(part, len(laying.copies))
    notes = [note for note in part.notes if isinstance(note, HoldingNote)]
    if part.process == "dummy":
        return [Doing(f"{part.title}: the picture shows where your own one is")]
    if first and not places and not notes:
        places = [_ON_BENCH]
    doings = [doing for place in places for doing in place.lettered("", named).doings]
    if led and doings and doings[0].verb in ("lay ", "set "):
        begins, *more = doings
        on = begins.thing.removeprefix(f"{named} ") if begins.verb == "set " else ""
        loose = begins.rest if begins.rest.startswith("; ") else ""
        rest = f", {on}" if on else loose
        doings = [Doing("lay ", f"{named} {led}", rest), *more]
    elif led:
        doings = [Doing("lay ", f"{named} {led}"), *doings]
    elif not doings and notes:
        doings = [Doing(f"{named.removeprefix('the ')}: {notes.pop(0)}")]
    elif not doings:
        doings = [Doing("put ", f"{named} in place as the picture shows")]
    if laying.turned_over and laying.copies[0].holes:
        doings.append(Doing("it lies turned over: the side that its drawing shows is down"))
    return [*doings, *(Doing(note) for note in notes)]


def _led(copy: StandingCopy, there: Sequence[StandingCopy], pairs: Sequence[object]) -> str:
    """In which guide a copy slides, or in which groove it rolls, as far as that is there; "" where in none."""
    known = {each.part.name for each in there}
    for pair in pairs:
        slides = isinstance(pair, SlideFaces) and pair.runner.part == copy.part.name
        if isinstance(pair, SlideFaces) and slides and pair.rails.part in known:
            return f"in the guide of {pair.rails.part}"
        if isinstance(pair, CamOutline) and pair.roller == copy.part.name and pair.part in known:
            walls = [
                each.part
                for each in pairs
                if isinstance(each, CamOutline) and each.joint == pair.joint and each.part in known
            ]
            if len(walls) == 2:
                return f"between {listed(walls)}"
    return ""


def _where_all(places: Iterable[_Place]) -> str:
    """Where copies go."""
    return "; ".join(each.where for each in places)


def _layings(
    copies: Sequence[StandingCopy], pairs: Sequence[object], fixing: Fixing
) -> list[_Laying]:
    """All copies by steps, in their order; those of a sub-assembly one after the other."""
    eyes = [each for each in pairs if isinstance(each, PinEyes)]
    seats = {
        ring.part: {eye.part for each in eyes for eye in (each.a, each.b)}
        for each in eyes
        for ring in each.rings
    }
    place = {name: k for k, name in enumerate(dict.fromkeys(copy.part.name for copy in copies))}

    def height(copy: StandingCopy) -> float:
        mount = copy.mount
        holders = seats.get(copy.part.name, set())
        beside = [each.mount for each in copies if each.mount.body == mount.body]
        over = copy.part.thickness if mount.flipped else 0.0
        undersides = [each.z for each in beside if each.part in holders]
        return round(min([mount.z + over, *undersides]), 6) + 0.0

    levels = {copy.name: height(copy) for copy in copies}
    found: dict[_Key, list[StandingCopy]] = {}
    clusters: dict[_Key, list[StandingCopy]] = {}
    for cluster in _clusters(copies, levels, fixing):
        carrier = {copy.name for copy in cluster if _carries(copy, cluster, fixing)}
        cluster.sort(key=lambda copy: (copy.name not in carrier, place[copy.part.name]))
        alone = len(cluster) == 1
        names = list(dict.fromkeys(copy.part.name for copy in cluster))
        for copy in cluster:
            key = (
                levels[copy.name],
                place[cluster[0].part.name],
                "" if alone else cluster[0].name,
                names.index(copy.part.name),
                copy.mount.flipped,
                round(copy.mount.z, 6) + 0.0,
            )
            found.setdefault(key, []).append(copy)
            clusters[key] = [] if alone else cluster
    return [
        _Laying(found[key], found[key][0].mount.z, found[key][0].mount.flipped, clusters[key])
        for key in sorted(found)
    ]


def _clusters(
    copies: Sequence[StandingCopy], levels: Mapping[str, float], fixing: Fixing
) -> list[list[StandingCopy]]:
    """Copies of one body that begin at one height, as drawn, and are fixed on each other; all others each by itself."""
    clusters: list[list[StandingCopy]] = []
    for copy in copies:
        joined = [copy]
        rest = []
        for cluster in clusters:
            first = cluster[0]
            beside = (
                first.mount.body == copy.mount.body
                and levels[first.name] == levels[copy.name]
                and not (first.mount.flipped or copy.mount.flipped)
            )
            fixed = beside and any(mate.how != "free" for mate in _mates([copy], cluster, fixing))
            if fixed:
                joined = [*cluster, *joined]
            else:
                rest.append(cluster)
        clusters = [*rest, joined]
    return clusters


def _carries(copy: StandingCopy, cluster: Sequence[StandingCopy], fixing: Fixing) -> bool:
    """Whether all others of a sub-assembly, of which there are several, are fixed on one of it."""
    others = [each for each in cluster if each is not copy]
    return len(others) > 1 and all(
        any(mate.how != "free" for mate in _mates([each], [copy], fixing)) for each in others
    )


def holding_notes(part: Part) -> str:
    """What a part is, and what its notes say of how it is held."""
    notes = [note for note in part.notes if isinstance(note, HoldingNote)]
    return f"{part.title}: {'; '.join(notes)}" if notes else part.title


# ---- where parts meet ------------------------------------------------------------------------------------------------


def mated(
    steps: Sequence[Step],
    copies: Sequence[StandingCopy],
    pairs: Sequence[object],
    fixing: Fixing,
) -> list[Step]:
    """Steps with what comes and goes on what is there; names of parts in them stand for all their copies.

    A copy that comes twice is loose at first: its place is fixed when it comes again. A step in which no copy comes keeps its own.
    """
    fixing = with_joints(fixing, pairs)
    slides = [each for each in pairs if isinstance(each, SlideFaces)]
    built = defaultdict[str, list[StandingCopy]](list)  # by what is built apart
    bench = list[StandingCopy]()  # the sub-assembly
    found = []
    for number, step in enumerate(steps):
        named = {*step.copies}
        again = {name for each in steps[number + 1 :] for name in each.copies}
        coming = [copy for copy in copies if copy.name in named or copy.part.name in named]
        names = [copy.name for copy in coming]
        there = built[step.apart]
        glued = replace(fixing, dry=frozenset(step.dry))
        if step.group and coming:
            mates = _mates(coming, bench, glued)
            bench += coming
        else:
            if not coming and step.group:
                coming = bench
            coming = [*built.pop(step.joins, []), *coming] if step.joins else coming
            mates = [*_mates(coming, there, glued), *_sliding(coming, there, slides)]
            there += [copy for copy in coming if copy not in there]
            bench = [] if step.group else bench
        mates = [mate if mate.label else _of_joint(mate, [*there, *coming]) for mate in mates]
        if named & again:
            mates = [replace(mate, how="free") for mate in mates]
        mates = [*mates, *step.glued]
        found.append(replace(step, copies=names, mates=mates if coming else step.mates))
    return found


def _of_joint(mate: Mate, copies: Iterable[StandingCopy]) -> Mate:
    """Where a hole has no name, such as a cap's: with that of the joint, by the next hole on its axis that has one."""
    x, y, z = mate.place
    beside = [
        (abs((hole.low + hole.high) / 2 - z), hole.name)
        for copy in copies
        for hole in copy.holes
        if hole.name and abs(hole.at - complex(x, y)) < SAME_POINT
    ]
    return replace(mate, label=min(beside, default=(0.0, ""))[1])


def _mates(
    coming: Iterable[StandingCopy], there: Sequence[StandingCopy], fixing: Fixing
) -> list[Mate]:
    """Where what comes goes on what is there, or through it; parts of one body that are loose on each other are left out."""
    mates = dict[tuple[object, ...], Mate]()
    for copy in coming:
        for other in there:
            for holder, held in ((copy, other), (other, copy)):
                alike = holder.pose.standing == held.pose.standing
                for mate in _through(holder, held, fixing, held is copy) if alike else ():
                    dry = {copy.part.name, other.part.name} & fixing.dry
                    if mate.how != "free" or dry or copy.mount.body != other.mount.body:
                        x, y, z = (round(value, 3) for value in mate.place)
                        mates.setdefault((mate.how, x, y, z), mate)
    return list(mates.values())


def _through(
    holder: StandingCopy, held: StandingCopy, fixing: Fixing, comes: bool
) -> Iterator[Mate]:
    """Where outlines of one copy go through holes and slots of another."""
    openings: list[Round | Slot] = [*holder.holes, *holder.slots]
    for hole in openings:
        for outline in held.outlines:
            if not hole.holds(outline):
                continue
            low = max(hole.low, outline.low)
            high = min(hole.high, outline.high)
            place = held.in_space(outline.at, (low + high) / 2)
            label = hole.name if isinstance(hole, Round) else ""
            how = (
                fixing.how(hole, holder.part, outline, held.part)
                if isinstance(hole, Round)
                else "free"
            )
            yield Mate(how, label, place, outline.diameter, high - low, comes)


def _sliding(
    coming: Iterable[StandingCopy],
    there: Sequence[StandingCopy],
    slides: Sequence[SlideFaces],
) -> Iterator[Mate]:
    """Where what comes slides on what is there, in the middle of the runner's faces."""
    for copy in coming:
        for other in there:
            for pair in slides:
                runner, rails = (
                    (copy, other) if copy.part.name == pair.runner.part else (other, copy)
                )
                if (runner.part.name, rails.part.name) == (pair.runner.part, pair.rails.part):
                    at = runner.at(pair.runner.at)
                    middle = runner.mount.z + runner.part.thickness / 2
                    yield Mate("free", "", (at.real, at.imag, middle))


# ---- in words --------------------------------------------------------------------------------------------------------


def _places(
    copies: Iterable[StandingCopy], below: Sequence[StandingCopy], fixing: Fixing
) -> list[_Place]:
    """Where copies go; those that differ in their hole's letter alone together."""
    letters: dict[_Place, list[str]] = {}
    loose = False
    part = None
    for copy in copies:
        part = copy.part
        place, letter = _where(copy, below, fixing)
        if place.where:
            letters.setdefault(place, []).append(letter)
        loose = loose or not place.where
    said = [
        place.lettered(each, called(part, len(each)))
        for place, each in letters.items()
        if part is not None
    ]
    rest = _Place("all else loose", (Doing("put ", "all else in place; nothing holds it yet"),))
    return [*said, *([rest] if said and loose else [])]


def _where(copy: StandingCopy, below: Sequence[StandingCopy], fixing: Fixing) -> tuple[_Place, str]:
    """Where a copy goes, by what lies there before it, with _HOLE for its hole's letter, and that letter."""
    held = (mate.comes and mate.how != "free" for mate in _mates([copy], below, fixing))
    if not copy.holes or any(held):  # a pin, a shaft, a ball bearing
        return _pin_words(copy, below, fixing)
    return _hole_words(copy, below, fixing), ""


@dataclass(frozen=True)
class _Meeting:
    """Where a hole of a copy goes: on a shaft or over another hole."""

    letter: str  # of the hole; "" where it has none
    place: str  # "on pin-1", "over crank"
    fit: Literal["glue", "press", "free"] = "free"
    high: str = ""  # how high on the shaft it is fixed
    set_by: str = ""  # how that is set, by sheets of paper
    lies: str = ""  # on what it lies
    shaft: bool = False
    flat: str = ""  # that a flat goes on a flat
    hangs: str = ""  # the pin on which it is fixed, where that is held by nothing but its head
    room: str = ""  # how high the gap under that head is
    sinks: str = ""  # the shaft on which it is fixed, where that is loose in a plate

    @property
    def where(self) -> str:
        """For the table."""
        how = _WORDS[self.fit]
        return " ".join(filter(None, (self.letter, how, self.place))) + self.high


def _hole_words(copy: StandingCopy, below: Sequence[StandingCopy], fixing: Fixing) -> _Place:
    """On or over what the holes and slots of a copy go."""
    found = [each for hole in copy.holes if (each := _meeting(hole, copy, below, fixing))]
    over_pins = [
        f"its slot over {other.part.name}"
        for slot in copy.slots
        for other in below
        if any(map(slot.holds, other.outlines))
    ]
    where = ", ".join(dict.fromkeys([*(each.where for each in found), *over_pins]))
    return _Place(where, tuple(_hole_doings(found, over_pins))) if where else _Place()


def _meeting(
    hole: Round, copy: StandingCopy, below: Sequence[StandingCopy], fixing: Fixing
) -> _Meeting | None:
    """Where one hole of a copy goes."""
    shaft, outline = next(
        ((other, each) for other in below for each in other.outlines if hole.holds(each)),
        (None, None),
    )
    letter = hole.name if shaft is None or hole.name != shaft.part.name else ""
    if shaft is not None and outline is not None:
        fit = fixing.how(hole, copy.part, outline, shaft.part)
        long = shaft.slender or shaft.part.role == "shaft"
        gap, name = _under(hole, below)
        told = _WORDS[fit] and (long or gap > SAME_POINT)
        high = f", {_height(hole, shaft, below)}" if told else ""
        set_by = between(gap) if " mm over " in high else ""
        lying = [on for each in copy.holes if (on := _lies_on(each, below))]
        if set_by and lying:
            high, set_by = f", down on {lying[0]}: {gap:.3g} mm stay free over {name}", ""
        flat = ", flat on flat" if _WORDS[fit] and hole.flat and outline.flat else ""
        lies = f", down on {name}" if name and gap <= SAME_POINT else ""
        at = "" if hole.name or shaft.part.count == 1 else _joint(hole, shaft, below)
        hangs = shaft.part.name if _WORDS[fit] and _hangs(shaft, below, fixing) else ""
        plates = [each for each in below if each.mount.body == GROUND]
        loose = _WORDS[fit] and shaft.part.role == "shaft" and _mates([shaft], plates, fixing)
        sinks = shaft.part.name if loose else ""
        on = f"on {shaft.part.name}{at}"
        room = _room(shaft, below) if hangs else ""
        return _Meeting(letter, on, fit, high, set_by, lies, True, flat, hangs, room, sinks)
    under = [
        (each.high, other.part.name, each.name)
        for other in below
        for each in other.holes
        if hole.in_line(each)
    ]
    through = [
        other.part.name
        for other in below
        for each in other.outlines
        if hole.in_line(each) and each.low < hole.high and each.high > hole.low
    ]
    if through and not letter:
        return _Meeting(letter, f"over {through[0]}")
    slots = [
        (slot.high, other.part.name)
        for other in below
        for slot in other.slots
        if slot.in_line(hole)
    ]
    if under:
        _, name, point = max(under)
        of = f"{point} of " if point and point != hole.name else ""
        return _Meeting(letter, f"over {of}{name}")
    return _Meeting(letter, f"over the slot of {max(slots)[1]}") if slots else None


def _hole_doings(meetings: Sequence[_Meeting], over_pins: Sequence[str]) -> Iterator[Doing]:
    """What is done with a copy, its holes met one by one: what only goes on first, then what is glued."""
    shafts = [each for each in meetings if each.shaft]
    free = [each for each in meetings if each.letter and each.fit == "free"]
    bare = [each for each in meetings if not each.letter and each.fit == "free"]
    whole = _WHAT  # what is glued, by its own name until it has been named
    tight = [each for each in shafts if each.fit != "free"]
    if len(tight) > 1 and tight == shafts and not any(each.letter for each in tight):
        counts = Counter(each.place.removeprefix("on ") for each in tight)
        pins = listed(f"{n} × {name}" if n > 1 else name for name, n in counts.items())
        lies = next((each.lies for each in tight if each.lies), "")
        told = next((each for each in tight if each.high), tight[0])
        of = f"{told.place.removeprefix('on ')}'s"
        flat = max(each.flat for each in tight)
        high = "" if told.high == lies else told.high.replace(" its ", f" {of} ") + told.set_by
        yield Doing(_VERBS[tight[0].fit], f"{_WHAT} on {pins}", f", all at once{lies}{flat}{high}")
        return
    if len(shafts) > 2:
        ends = Counter((each.letter, each.place) for each in shafts)
        said = listed(
            f"{letter or ('one' if count == 1 else count)} {place}"
            for (letter, place), count in ends.items()
        )
        rest = f", each in its hole before you press: {said}"
        yield Doing("lower ", f"{_WHAT} over all ends at once", rest)
        whole = "it"
    elif free or over_pins:
        said = listed(
            dict.fromkeys([*(f"{each.letter} {each.place}" for each in free), *over_pins])
        )
        yield Doing("set ", f"{_WHAT} with {said}")
        whole = "it"
    for each in bare if whole == _WHAT else ():
        if each.shaft or not shafts:
            bare_hole = not each.shaft and " of " not in each.place
            place = each.place.replace("over ", "on ", 1) if bare_hole else each.place
            yield Doing("put ", f"{_WHAT} {place}", ", hole over hole" if bare_hole else "")
    fixed = [each for each in meetings if each.fit != "free"]
    highs = [each.high for each in fixed]
    for each in sorted(fixed, key=lambda each: highs.index(each.high)):
        thing = each.letter if whole == "it" else f"{each.letter} of {_WHAT}"
        thing = thing if each.letter else whole
        yield Doing(
            _VERBS[each.fit], f"{thing} {each.place}", f"{each.flat}{each.high}{each.set_by}"
        )
    hanging = listed(dict.fromkeys(each.hangs for each in fixed if each.hangs))
    if hanging:
        rooms = listed(dict.fromkeys(each.room for each in fixed if each.room))
        rod = f": push a rod or block from the side into the gap of {rooms}" if rooms else ""
        yield Doing("hold ", hanging, f" from below by the head while you press{rod}")
    sinking = listed(dict.fromkeys(each.sinks for each in fixed if each.sinks))
    if sinking:
        yield Doing("put a block under ", sinking, ": it must not sink while you press")


def _room(pin: StandingCopy, below: Sequence[StandingCopy]) -> str:
    """How high the gap is between a pin that stands on its head, with its cap, and what is in line with it below; "" of none."""
    low = min(each.low for each in pin.outlines)
    under = [
        each.high
        for other in below
        for each in (*other.outlines, *other.holes)
        if each.in_line(pin.outlines[0]) and each.high < low + SAME_POINT
    ]
    gap = low - max(under, default=low)
    return f"{gap:.4g} mm under {pin.part.name}" if gap > _RESTS else ""


def _lies_on(hole: Round, below: Sequence[StandingCopy]) -> str:
    """On what a part lies round one of its holes; "" where on nothing."""
    gap, name = _under(hole, below)
    return name if gap <= SAME_POINT else ""


def _hangs(pin: StandingCopy, below: Sequence[StandingCopy], fixing: Fixing) -> bool:
    """Whether a pin stands on its head, and nothing else there is fixed on it."""
    fixed = [
        other
        for other in below
        for mate in _mates([other], [pin], fixing)
        if mate.how != "free" and other is not pin
    ]
    return bool(fixed) and all(other.part.role == "cap" for other in fixed)


def _joint(hole: Round, pin: StandingCopy, below: Sequence[StandingCopy]) -> str:
    """At which point of which part a pin is, of several that are alike: of the next part under a hole, or else over it."""
    named = [
        (each.low > hole.low, abs(each.low - hole.low), f" at {each.name} of {other.part.name}")
        for other in below
        for each in other.holes
        if each.name and any(map(each.holds, pin.outlines))
    ]
    return min(named, default=(False, 0.0, ""))[2]


def _height(hole: Round, shaft: StandingCopy, below: Sequence[StandingCopy]) -> str:
    """How high a part is fixed on a shaft: flush with an end, or over what lies there, or as far as one measures."""
    low = min(each.low for each in shaft.outlines)
    over = hole.low - low
    gauge = thickness_gauge(over)
    under = f" ({gauge} under it)" if gauge != _FEELER else ""
    return _support(hole, shaft, below) or f"underside {over:.4g} mm from its lower end{under}"


def _support(hole: Round, shaft: StandingCopy, below: Sequence[StandingCopy]) -> str:
    """What says how high a part is fixed on a shaft: an end that is flush, or what lies under it; "" where neither does."""
    if abs(hole.low - min(each.low for each in shaft.outlines)) < SAME_POINT:
        return "flush with its lower end"
    if abs(hole.high - max(each.high for each in shaft.outlines)) < SAME_POINT:
        return "flush with its upper end"
    gap, name = _under(hole, below)
    if not name:
        return ""
    return f"{gap:.3g} mm over {name}" if gap > SAME_POINT else f"down on {name}"


def _under(hole: Round, below: Sequence[StandingCopy]) -> tuple[float, str]:
    """How far over what lies next under a hole, mm, and its part's name; 0 and "" where nothing does."""
    under = [
        (hole.low - each.high, other.part.name)
        for other in below
        for each in other.holes
        if hole.in_line(each) and -SAME_POINT < hole.low - each.high < _RESTS
    ]
    return min(under, default=(0.0, ""))


def _depth(
    pin: StandingCopy, fixed: Sequence[tuple[Round, StandingCopy]], holes: Sequence[Round]
) -> str:
    """How deep a pin is driven into what it is fixed in: where the end is that goes in first, and what is left under a head.

    holes: all that it goes through.
    """
    if pin.mount.flipped:
        hole, _ = min(fixed, key=lambda each: each[0].low)
        out = hole.low - min(each.low for each in pin.outlines)
        side = "below"
    else:
        hole, _ = max(fixed, key=lambda each: each[0].high)
        out = max(each.high for each in pin.outlines) - hole.high
        side = "above"
    end = f"till {out:.3g} mm of it stand out {side}" if out > SAME_POINT else f"flush {side}"
    if out < -SAME_POINT:
        end = f"its end {-out:.3g} mm inside"
    head = max(pin.outlines, key=lambda each: each.diameter)
    under = [head.low - hole.high for hole in holes if hole.high < head.low - SAME_POINT]
    if pin.mount.flipped and len(pin.outlines) > 1 and under and min(under) < _RESTS:
        return f"{end}, {min(under):.3g} mm left under its head{between(min(under))}"
    return end


def _pin_words(
    copy: StandingCopy, below: Sequence[StandingCopy], fixing: Fixing
) -> tuple[_Place, str]:
    """Through what a pin or a shaft goes that lies there, from above, and where it is fixed; _HOLE for the hole's letter, and that."""
    round_holes = [
        (hole, other, outline)
        for other in reversed(below)
        for hole in other.holes
        for outline in copy.outlines
        if hole.holds(outline)
    ]
    letter = next((hole.name for hole, _, _ in round_holes if hole.name), "")
    point = f"{_HOLE} of " if letter else ""
    words: dict[Literal["glue", "press", "free"], list[str]] = {}
    for hole, other, outline in round_holes:
        names = words.setdefault(fixing.how(hole, other.part, outline, copy.part), [])
        names += [other.part.name] if other.part.name not in names else []
    ways: list[str] = []
    beginning = ""  # of the first of them
    verb = "put "
    first = ""  # of the sentence, after what it is done with
    more = ""  # of the sentence, after that
    above = " from above" if copy.mount.flipped else ""
    for how, names in sorted(words.items(), key=lambda each: each[0] != "free"):
        fit = f"{_WORDS[how]} " if _WORDS[how] else ""
        into = "into " if fit else "through "
        through = listed(names)
        if not ways:
            verb = _VERBS[how] if fit else "push "
            beginning = fit
            first, more = f"{above} {into}{point or through}", f"{through if point else ''}"
            ways.append(f"{into}{point}{through}")
        else:
            more += f"; {_VERBS[how]}{_IT} {into}{through}"
            ways.append(f"{fit}{into}{through}")
    slots = dict.fromkeys(
        other.part.name
        for other in reversed(below)
        if any(slot.holds(outline) for slot in other.slots for outline in copy.outlines)
    )
    tight = [
        each
        for each in round_holes
        if fixing.how(each[0], each[1].part, each[2], copy.part) != "free"
    ]
    fixed = [(hole, other) for hole, other, _ in tight]
    flats = ["flat on flat"] if any(hole.flat and each.flat for hole, _, each in tight) else []
    if copy.mount.flipped:  # from above, where a head may be in the way
        side = "flush with its upper side"
        top = max((each.high for each in copy.outlines), default=0.0)
        gaps = [
            (hole.high - other.mount.z - other.part.thickness, hole.high - top)
            for hole, other in fixed
        ]
    else:
        side = "flush with its underside"
        foot = min((each.low for each in copy.outlines), default=0.0)
        gaps = [(hole.low - other.mount.z, hole.low - foot) for hole, other in fixed]
    if any(max(map(abs, gap)) < SAME_POINT for gap in gaps):
        ways.append(side)
    elif fixed and (deep := _depth(copy, fixed, [hole for hole, *_ in round_holes])):
        ways.append(deep)
    in_slots = [f"in the slot of {name}" for name in slots]
    flush = [*flats, *ways[len(words) :]]
    said = ", ".join([*ways, *in_slots])
    rest = ", ".join(filter(None, (more, *flush, *in_slots)))
    if point:
        first = first.removesuffix(" of ")
        rest = f" of {rest}"
    elif rest and not rest.startswith(";"):
        rest = f", {rest}" if first else f" {rest}"
    doing = Doing(verb, f"{_WHAT}{first}", rest)
    return (_Place(f"{beginning}{said}", (doing,)) if said else _Place()), letter
