"""What is loose at first: parts that are fixed by one that comes later, and those whose height on a shaft a stop over them says."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from camgen.parts.blocks import block_height, lowest_plate
from camgen.parts.fixing import Fixing
from camgen.parts.layings import Laying
from camgen.parts.mates import mates_between
from camgen.parts.standing import Round, StandingCopy, seat_of
from camgen.parts.step_places import RESTS, gap_under, height_by, room_under, seats_at_ends
from camgen.parts.step_words import (
    WHAT,
    Place,
    between,
    called,
    gauge_tools,
    listed,
    step_of,
    thickness_gauge,
    where_all,
)
from camgen.study import Doing, Mate
from camgen.tolerances import SAME_POINT


@dataclass(frozen=True)
class Stop:
    """What says how high a part is fixed on its shaft, where nothing lies under it and neither end is flush: what comes over it."""

    shaft: StandingCopy
    name: str  # of the part over it, in which the shaft turns
    gap: float  # mm, between both
    metal: bool  # whether both are of metal
    hidden: bool = False  # whether it is in a hole of another part, from which no gauge comes out
    over: str = ""  # the part of the shaft that turns over the stop
    play: float = 0.0  # mm, of the shaft between both

    def place(self) -> Place:
        """Where the part is glued."""
        shaft = self.shaft.part.name
        near, gauge = "against", ""
        if self.gap > SAME_POINT:
            near, gauge = f"{self.gap:.2g} mm under", between(self.gap, self.metal)
        tools = gauge_tools(self.gap) if gauge else ()
        where = f"glued on {shaft}, {near} {self.name}"
        waits = f"when the glue of {self.over} is hard, " if self.over and not self.metal else ""
        under = "" if self.metal else f". The glue goes on {shaft} under it, none over it"
        push = Doing(
            f"{waits}push {WHAT} up: glue it ",
            f"on {shaft}",
            f", {near} {self.name}{gauge}{under}",
            tools,
        )
        if not (gauge and self.hidden and self.over):
            return Place(where, (push,))
        where = f"glued on {shaft}, against {self.name}, {self.over} lifted by {self.play:.2g} mm"
        gauge = thickness_gauge(self.play)
        thick = f" and lay {gauge} between it and {self.name}"
        doings = (
            Doing(
                f"{waits}lift ",
                self.over,
                f"{thick}, at either side of {shaft}",
                gauge_tools(self.play),
            ),
            Doing(
                f"stick a strip of adhesive tape under {WHAT}, beside ",
                shaft,
                f", to pull it down by. Push it up to {self.name} with a thin stick, and hold it there",
                ("adhesive tape", "thin stick"),
            ),
            Doing(
                f"put a drop of {'retaining compound' if self.metal else 'superglue gel'} on ",
                shaft,
                f" just under it, none over it: that would stick to {self.name}. Pull {WHAT} down over the drop by its tape",
            ),
            Doing(
                f"push {WHAT} up again, against ",
                f"{self.name}: glue it on {shaft} alone, and hold it there until the glue is hard. Pull off the tape",
            ),
            Doing(
                f"pull {gauge} out from under {self.over}: {shaft} has {self.play:.2g} mm of play along its axis"
            ),
        )
        return Place(where, doings)


def stops_of(copies: Sequence[StandingCopy], fixing: Fixing) -> dict[str, Stop]:
    """Stops of the copies that have one, by their names."""
    stops = dict[str, Stop]()
    for copy in copies:
        others = [each for each in copies if each is not copy]
        for hole, shaft in fixed_on(copy, others, fixing):
            if shaft.mount.flipped:  # a pin with its head up comes later
                continue
            over = [
                (each.low - hole.high, other.part.name)
                for other in others
                for each in other.holes
                if hole.in_line(each) and -SAME_POINT < each.low - hole.high < RESTS
            ]
            if over and not height_by(hole, shaft, others, fixing.metal):
                gap, name = min(over)
                reach = _out_of_reach(copy, hole, shaft, others, fixing)
                stops[copy.name] = Stop(shaft, name, gap, fixing.metal, *reach)
    return stops


def _out_of_reach(
    copy: StandingCopy,
    hole: Round,
    shaft: StandingCopy,
    others: Sequence[StandingCopy],
    fixing: Fixing,
) -> tuple[bool, str, float]:
    """Whether the upper face of a copy is in a hole of another part, the part that turns on its shaft next over the plates there, and
    the play of the shaft between both, mm."""
    wide = max((each.diameter for each in copy.outlines), default=math.inf)
    over = [each for other in others for each in other.holes if hole.in_line(each)]
    hidden = any(each.diameter > wide and each.low < hole.high < each.high for each in over)
    plates = [each for each in over if each.low > hole.high - SAME_POINT and each.diameter < wide]
    turning = [
        (each.low, other.part.name)
        for other in others
        if other is not shaft
        for each, _ in fixed_on(other, [shaft], fixing)
        if each.low > hole.high
    ]
    if not turning:
        return hidden, "", 0.0
    low, name = min(turning)
    thick = sum(each.high - each.low for each in plates if each.high < low + SAME_POINT)
    return hidden, name, round(low - hole.high - thick, 6)


def fixed_on(
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


def is_held(
    laying: Laying, stops: Mapping[str, Stop], there: Sequence[StandingCopy], fixing: Fixing
) -> bool:
    """Whether all shafts of what is loose carry another part, higher up."""
    own = {copy.name for copy in laying.copies}
    return all(
        any(
            shaft is stops[copy.name].shaft
            for other in there
            if other.name not in own and other.mount.z > copy.mount.z
            for _, shaft in fixed_on(other, there, fixing)
        )
        for copy in laying.copies
    )


def loosely(laying: Laying, shafts: Sequence[str]) -> Place:
    """Where copies stay until they are pushed up; shafts: of each of them."""
    first = laying.copies[0]
    until = f"; it stays loose until {step_of(first)}"
    doings = (Doing("put ", f"{called(first.part)} loosely on {each}", until) for each in shafts)
    return Place(f"loose on {', '.join(dict.fromkeys(shafts))}", tuple(doings))


def push_up(laying: Laying, stops: Mapping[str, Stop]) -> tuple[tuple[object, ...], list[Doing]]:
    """The row and what is done with what was loose on its shaft and is glued under its stop."""
    part = laying.copies[0].part
    places = list(dict.fromkeys(stops[copy.name].place() for copy in laying.copies))
    row = (part.name, f"{part.title}: push it up", where_all(places), "", laying.z, "as drawn")
    named = called(part, len(laying.copies) if len(places) == 1 else 1)
    return row, [doing for place in places for doing in place.lettered("", named).doings]


def fixed_by(
    later: Iterable[StandingCopy],
    copies: Sequence[StandingCopy],
    there: Sequence[StandingCopy],
    fixing: Fixing,
    blocks: float,
) -> list[Place]:
    """What is said of copies that nothing holds yet: which part that comes later is fixed on them, or goes on or in them; later: in
    the order of their steps."""
    joins = ""
    steps = ""  # the same, with their numbers
    for copy in later:
        mates = mates_between([copy], copies, fixing)
        by = _by(mates, copy, copies)
        if any(mate.how != "free" and not mate.comes for mate in mates):
            joins += " and " if joins else ""
            steps += " and " if steps else ""
            said = f"{copy.part.name} is glued on it{by}"
            steps = f"{steps}{said} in {step_of(copy)}"
            return [_loose(f"{joins}{said}", steps, copies, there, blocks)]
        if mates and not joins:
            joins = f"{copy.part.name} joins it{by}"
            steps = f"{joins} in {step_of(copy)}"
    return [_loose(joins, steps, copies, there, blocks)] if joins else []


def fixed_one_by_one(
    later: Sequence[StandingCopy],
    copies: Sequence[StandingCopy],
    there: Sequence[StandingCopy],
    fixing: Fixing,
    blocks: float,
) -> list[Place]:
    """The same of copies of one part that are not fixed on each other, alike ones together."""
    found = defaultdict[str, list[Place]](list)
    for copy in copies:
        for place in fixed_by(later, [copy], there, fixing, blocks):
            found[place.where].append(place)
    part = copies[0].part
    return [each[0].lettered([""] * len(each), called(part, len(each))) for each in found.values()]


def waiting_under(later: Sequence[StandingCopy], copies: Sequence[StandingCopy]) -> list[Place]:
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
        doings.append(Doing("lay ", under, f", which comes in {step_of(other)}"))
    return [Place("", tuple(doings))]


def _loose(
    until: str,
    steps: str,
    copies: Sequence[StandingCopy],
    there: Sequence[StandingCopy],
    blocks: float,
) -> Place:
    """Where copies stand that nothing holds yet; until: what joins and holds them, steps: the same with the numbers of steps."""
    first, *others = copies
    over = [
        f"{hole.name} over {other.part.name}"
        for hole in first.holes
        for other in there
        if hole.name and any(map(hole.in_line, other.holes))
    ]
    at = f"with {listed(dict.fromkeys(over))}" if over else "as the picture shows"
    prop, props = _prop(first, there, blocks)
    doing = Doing("lay ", f"{WHAT} {at}", f"; it stays loose until {steps}{prop}", props=props)
    if first.slender or (first.outlines and not first.holes):
        below = _stands_over(first, there)
        foot = [each for each in others if each.mount.z < first.mount.z + SAME_POINT]
        low = min(first.outlines, key=lambda each: each.low)
        head = low.diameter - min(each.diameter for each in first.outlines) > SAME_POINT
        down = f", {listed(dict.fromkeys(each.part.name for each in foot))} down" if foot else ""
        down = down or (", head down" if head else "")
        down = down or _end_down(first)
        room, link = room_under(first, there)
        props = (room,) if room > RESTS else ()
        high = f"a rod or block {room:.4g} mm high" if props else thickness_gauge(room)
        high = (
            f"{high} on {link}, which must not move"
            if link
            else f"{high}{_end_below(first, room, there)}"
        )
        on = f", on {high}" if props or (link and room > SAME_POINT) else ""
        rest = f"; it stays loose until {steps}"
        tools = gauge_tools(room) if on and not props else ()
        if on:  # it has a narrow foot
            stays = "" if props else f". Leave {thickness_gauge(room)} there"
            rest += f"{stays}. Adhesive putty beside its foot holds it upright"
            tools += ("adhesive putty",)
        doing = Doing("stand ", f"{WHAT} upright{below}{down}{on}", rest, tools, props)
    return Place(f"loose until {until}", (doing,))


def _end_below(pin: StandingCopy, room: float, there: Sequence[StandingCopy]) -> str:
    """On the end of which pin of its line a prop stands that leaves so much room, mm, under a pin; "" where on none."""
    foot = min(each.low for each in pin.outlines) - room
    ends = (
        f" on the end of {'the lower ' * (other.part is pin.part)}{other.part.name}"
        for other in there
        if other.part.role == "pin" and room > RESTS
        for each in other.outlines
        if each.in_line(pin.outlines[0]) and abs(each.high - foot) < SAME_POINT
    )
    return next(ends, "")


def _prop(
    copy: StandingCopy, there: Sequence[StandingCopy], blocks: float
) -> tuple[str, tuple[float, ...]]:
    """The block that goes under a part that is laid down, and its height, mm; "" and () where it lies on something. blocks: height of
    those under the plate, mm."""
    plate = lowest_plate(there)
    if plate is None or not copy.holes or any(gap_under(hole, there)[1] for hole in copy.holes):
        return "", ()
    if copy.mount.z - plate.mount.z - plate.part.thickness < RESTS:
        return "", ()
    said = f". Prop it on a block {block_height(copy.mount.z, plate, blocks)}"
    return said, (copy.mount.z - plate.mount.z + blocks,)


def _end_down(shaft: StandingCopy) -> str:
    """Which end of a shaft is down, as ", its flat end down"; "" where both ends are alike."""
    seats = {seat_of(layer.region.outer) for layer in shaft.part.layers}
    what = "keyway" if "key" in seats else "flat"
    low, high = seats_at_ends(shaft)
    if abs(low - high) < RESTS / 2:
        return ""
    if not (low and high):
        end = "flat end" if what == "flat" else "end with the keyway"
        return f", its {end} {'down' if low else 'up'}"
    return f", its {'longer' if low > high else 'shorter'} {what}, of {low:.3g} mm, down"


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
