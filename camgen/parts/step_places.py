"""Where a part goes, in words: on which shaft, how high, over which hole, and how deep a pin is driven."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import takewhile

from camgen.machine.model import GROUND
from camgen.parts.catalogue import BUSH
from camgen.parts.fixing import Fixing, Joint
from camgen.parts.mates import mates_between
from camgen.parts.part import GREASED
from camgen.parts.standing import AROUND, Round, StandingCopy, covers, seat_of
from camgen.parts.step_words import (
    FEELER,
    HOLE,
    IT,
    TWO_PART,
    WHAT,
    Place,
    between,
    called,
    gauge_tools,
    listed,
    pronoun,
    thickness_gauge,
    turned,
    verb,
)
from camgen.study import Doing
from camgen.tolerances import SAME_POINT

RESTS = 1.0  # mm, at most between a part and what lies under it


def places_of(
    copies: Iterable[StandingCopy], below: Sequence[StandingCopy], fixing: Fixing
) -> list[Place]:
    """Where copies go; those that differ in their hole's letter alone together."""
    letters: dict[Place, list[str]] = {}
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
    rest = Place("all else loose", (Doing("put ", "all else in place; nothing holds it yet"),))
    return [*said, *([rest] if said and loose else [])]


def _where(copy: StandingCopy, below: Sequence[StandingCopy], fixing: Fixing) -> tuple[Place, str]:
    """Where a copy goes, by what lies there before it, with HOLE for its hole's letter, and that letter."""
    held = (mate.comes and mate.how != "free" for mate in mates_between([copy], below, fixing))
    if not copy.holes or any(held):  # a pin, a shaft, a ball bearing
        return _pin_words(copy, below, fixing)
    return _hole_words(copy, below, fixing), ""


@dataclass(frozen=True)
class _Meeting:
    """Where a hole of a copy goes: on a shaft or over another hole."""

    letter: str  # of the hole; "" where it has none
    place: str  # "on pin-1", "over crank"
    joint: Joint = ""
    high: str = ""  # how high on the shaft it is fixed
    set_by: str = ""  # how that is set, by sheets of paper
    lies: str = ""  # on what it lies
    shaft: bool = False
    flat: str = ""  # that a flat goes on a flat
    hangs: str = ""  # the pin on which it is fixed, where that is held by nothing but its head
    room: float = 0.0  # how high the gap under that head is, mm; 0 of none
    tools: tuple[str, ...] = ()  # that set how high it is

    @property
    def where(self) -> str:
        """For the table."""
        return " ".join(filter(None, (self.letter, self.joint, self.place))) + self.high


def _hole_words(copy: StandingCopy, below: Sequence[StandingCopy], fixing: Fixing) -> Place:
    """On or over what the holes and slots of a copy go."""
    found = [each for hole in copy.holes if (each := _meeting(hole, copy, below, fixing))]
    borne = {
        each.letter for each in found if each.shaft
    }  # a seat's lip may be on what its seat is over
    found = [each for each in found if each.shaft or not each.letter or each.letter not in borne]
    over_pins = [
        f"its slot over {other.part.name}"
        for slot in copy.slots
        for other in below
        if any(map(slot.holds, other.outlines))
    ]
    where = ", ".join(dict.fromkeys([*(each.where for each in found), *over_pins]))
    return Place(where, tuple(_hole_doings(found, over_pins))) if where else Place()


def _meeting(
    hole: Round, copy: StandingCopy, below: Sequence[StandingCopy], fixing: Fixing
) -> _Meeting | None:
    """Where one hole of a copy goes."""
    shaft, outline = next(
        (
            (other, each)
            for other in below
            for each in other.outlines
            if hole.holds(each) or (other.part.role == "sleeve" and hole.goes_round(each))
        ),
        (None, None),
    )
    letter = hole.name if shaft is None or hole.name != shaft.part.name else ""
    if shaft is not None and outline is not None:
        joint = fixing.joint(hole, copy.part, outline, shaft.part)
        gap, name = gap_under(hole, below)
        rests = name and gap <= SAME_POINT and fixing.metal  # a shaft's length says it less well
        told = joint and not rests and (shaft.slender or gap > SAME_POINT)
        high = f", {_height(hole, shaft, below, fixing.metal)}" if told else ""
        set_by = between(gap, fixing.metal) if " mm over " in high else ""
        lying = [on for each in copy.holes if (on := _lies_on(each, below))]
        if set_by and lying:
            play = f"{name} must keep some play, or is sanded shorter first"
            high, set_by = f", down on {lying[0]}: {play}", ""
        elif told and "glued" in joint and shaft.part.process == "bought" and not fixing.metal:
            high = _past_the_end(copy, shaft, gap, below, fixing) or high
        flat = turned(outline.flat, fixing.metal) if joint and hole.flat else ""
        flat = f", {flat}" if flat else ""
        lies = f", down on {name}" if name and gap <= SAME_POINT else ""
        at = "" if hole.name or shaft.part.count == 1 else _joint(hole, shaft, below)
        hangs = shaft.part.name if joint and hangs_by_head(shaft, below, fixing) else ""
        on = f"on {shaft.part.name}{at}"
        room, _ = room_under(shaft, below) if hangs else (0.0, "")
        tools = gauge_tools(gap) if set_by or ", with " in high else ()
        if " under it)" in high:
            tools = gauge_tools(hole.low - min(each.low for each in shaft.outlines))
        tools += _glue_of(flat)
        return _Meeting(letter, on, joint, high, set_by, lies, True, flat, hangs, room, tools)
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


def _glue_of(said: str) -> tuple[str, ...]:
    """The glue that a piece of a sentence names, as in parts.tools."""
    return (TWO_PART,) if TWO_PART in said else ()


def _hole_doings(meetings: Sequence[_Meeting], over_pins: Sequence[str]) -> Iterator[Doing]:
    """What is done with a copy, its holes met one by one: what only goes on first, then what is glued."""
    shafts = [each for each in meetings if each.shaft]
    free = [each for each in meetings if each.letter and not each.joint]
    bare = [each for each in meetings if not each.letter and not each.joint]
    whole = WHAT  # what is glued, by its own name until it has been named
    tight = [each for each in shafts if each.joint]
    if len(tight) > 1 and tight == shafts and not any(each.letter for each in tight):
        counts = Counter(each.place.removeprefix("on ") for each in tight)
        pins = listed(f"{n} × {name}" if n > 1 else name for name, n in counts.items())
        lies = next((each.lies for each in tight if each.lies), "")
        told = next((each for each in tight if each.high), tight[0])
        of = f"{told.place.removeprefix('on ')}'s"
        flat = max(each.flat for each in tight)
        high = "" if told.high == lies else told.high.replace(" its ", f" {of} ") + told.set_by
        yield Doing(
            verb(tight[0].joint),
            f"{WHAT} on {pins}",
            f", all at once{lies}{flat}{high}",
            told.tools,
        )
        return
    if len(shafts) > 2:
        ends = Counter((each.letter, each.place) for each in shafts)
        said = listed(
            f"{letter or ('one' if count == 1 else count)} {place}"
            for (letter, place), count in ends.items()
        )
        glued = [each.letter for each in tight if each.letter and "glued" in each.joint]
        if len(glued) > 2:
            yield Doing("try ", WHAT, " on dry first: all ends go in, and it clamps no spacer")
            slow = ": superglue would set before all ends are in"
            yield Doing(f"put {TWO_PART} into ", listed(glued), slow, (TWO_PART,))
        yield Doing("lower ", f"{WHAT} over all ends at once", f", each in its hole: {said}")
        whole = "it"
    elif free or over_pins:
        said = listed(
            dict.fromkeys([*(f"{each.letter} {each.place}" for each in free), *over_pins])
        )
        yield Doing("set ", f"{WHAT} with {said}")
        whole = "it"
    for each in bare if whole == WHAT else ():
        if each.shaft or not shafts:
            bare_hole = not each.shaft and " of " not in each.place
            place = each.place.replace("over ", "on ", 1) if bare_hole else each.place
            yield Doing("put ", f"{WHAT} {place}", ", hole over hole" if bare_hole else "")
    fixed = [each for each in meetings if each.joint]
    highs = [each.high for each in fixed]
    for each in sorted(fixed, key=lambda each: highs.index(each.high)):
        thing = each.letter if whole == "it" else f"{each.letter} of {WHAT}"
        thing = thing if each.letter else whole
        yield Doing(
            verb(each.joint),
            f"{thing} {each.place}",
            f"{each.flat}{_of_shaft(each)}{each.set_by}",
            each.tools,
        )
    hanging = listed(dict.fromkeys(each.hangs for each in fixed if each.hangs))
    if hanging:
        under = dict.fromkeys((each.room, each.hangs) for each in fixed if each.room > SAME_POINT)
        props = tuple(gap for gap, _ in under if gap > RESTS)
        rooms = listed(f"{gap:.4g} mm under {pin}" for gap, pin in under if gap > RESTS)
        held = [f"a rod or block in the gap of {rooms}"] if rooms else []
        held += [f"{thickness_gauge(gap)} under {pin}" for gap, pin in under if gap <= RESTS]
        them = pronoun(held[0]) if len(held) == 1 else "them"
        stay = "stays" if them == "it" else "stay"
        rest = f" {stay} until the glue is hard; then push {them} out to the side"
        rod = f": {listed(held)}{rest}" if held else ""
        if len({pin for _, pin in under}) == len({each.hangs for each in fixed if each.hangs}):
            yield Doing("keep ", hanging, f" where they stand{rod}", props=props)
        else:
            yield Doing("hold ", hanging, f" from below by the head meanwhile{rod}", props=props)


def _of_shaft(meeting: _Meeting) -> str:
    """How high something is fixed on a shaft, with whose end that is: "flush with the upper end of shaft"."""
    shaft = meeting.place.removeprefix("on ").partition(" at ")[0]
    return re.sub(r" its (\w+ end)", rf" the \1 of {shaft}", meeting.high)


def _past_the_end(
    copy: StandingCopy,
    pin: StandingCopy,
    gap: float,
    below: Sequence[StandingCopy],
    fixing: Fixing,
) -> str:
    """How high a part is fixed on a pin that is bought, whose ends are not where they are drawn: a cap so far over what lies under
    it, a plate with a gap over the head of a pin that hangs in it; "" where nothing says."""
    if copy.part.role == "cap" and gap > SAME_POINT:
        return f", with {thickness_gauge(gap)} under it"
    head = next(
        (
            mate
            for mate in below
            if mate.part.role == "cap" and mates_between([mate], [pin], fixing)
        ),
        None,
    )
    if head is None or not hangs_by_head(pin, below, fixing):
        return ""
    top = head.mount.z + head.part.thickness
    over = [
        (each.low - top, other.part.name)
        for other in below
        for each in other.holes
        if each.in_line(pin.outlines[0]) and -SAME_POINT < each.low - top < RESTS
    ]
    gap, name = min(over, default=(0.0, ""))
    return f", with {thickness_gauge(gap)} between {head.part.name} and {name}" if gap else ""


def room_under(pin: StandingCopy, below: Sequence[StandingCopy]) -> tuple[float, str]:
    """How high the gap is between a pin that stands upright, with its cap, and what lies below it there, mm; 0 of none. And on what
    stands what props it, where that is not in line with it: a link that crosses its axis; "" of none."""
    low = min(each.low for each in pin.outlines)
    around = pin.outlines[0].at + pin.outlines[0].diameter / 2 * AROUND
    under = [
        (each.high, "")
        for other in below
        for each in (*other.outlines, *other.holes)
        if each.in_line(pin.outlines[0]) and each.high < low + SAME_POINT
    ]
    under += [
        (
            other.mount.z + other.part.thickness,
            "" if other.mount.body == GROUND else other.part.name,
        )
        for other in below
        if other.mount.z + other.part.thickness < low + SAME_POINT and covers(other, around)
    ]
    high, name = max(under, key=lambda each: (round(each[0], 6), not each[1]), default=(low, ""))
    return low - high, name


def _lies_on(hole: Round, below: Sequence[StandingCopy]) -> str:
    """On what a part lies round one of its holes; "" where on nothing."""
    gap, name = gap_under(hole, below)
    return name if gap <= SAME_POINT else ""


def fixed_on_pin(
    pin: StandingCopy, below: Iterable[StandingCopy], fixing: Fixing
) -> list[StandingCopy]:
    """What is fixed on a pin, or holds it."""
    return [
        other
        for other in below
        for mate in mates_between([other], [pin], fixing)
        if mate.how != "free" and other is not pin
    ]


def hangs_by_head(pin: StandingCopy, below: Sequence[StandingCopy], fixing: Fixing) -> bool:
    """Whether a pin stands on its head, and nothing else there is fixed on it."""
    fixed = fixed_on_pin(pin, below, fixing)
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


def _height(hole: Round, shaft: StandingCopy, below: Sequence[StandingCopy], metal: bool) -> str:
    """How high a part is fixed on a shaft: flush with an end, or over what lies there, or as far as one measures."""
    low = min(each.low for each in shaft.outlines)
    over = hole.low - low
    gauge = thickness_gauge(over)
    under = f" ({gauge} under it)" if gauge != FEELER and not metal else ""
    return (
        height_by(hole, shaft, below, metal) or f"underside {over:.4g} mm from its lower end{under}"
    )


def height_by(
    hole: Round, shaft: StandingCopy, below: Sequence[StandingCopy], metal: bool = False
) -> str:
    """What says how high a part is fixed on a shaft: an end that is flush, or what lies under it; "" where neither does.

    metal: what lies under it first: the length of a shaft or a dowel differs by more than the gaps of metal bear.
    """
    gap, name = gap_under(hole, below)
    if metal and name and gap > SAME_POINT:
        return f"{gap + _fallen(hole, name, below):.3g} mm over {name}"
    if abs(hole.low - min(each.low for each in shaft.outlines)) < SAME_POINT:
        low, high = seats_at_ends(shaft)
        told = metal and hole.flat == "key" and abs(high - low) > SAME_POINT and high and low
        which = f" ({'longer' if low > high else 'shorter'} keyway, {low:.3g} mm)" if told else ""
        return f"flush with its lower end{which}"
    if abs(hole.high - max(each.high for each in shaft.outlines)) < SAME_POINT:
        return "flush with its upper end"
    if not name:
        return ""
    return f"{gap:.3g} mm over {name}" if gap > SAME_POINT else f"down on {name}"


def _fallen(hole: Round, name: str, below: Sequence[StandingCopy]) -> float:
    """By how much a part under a hole that nothing fixes lies lower at the bench than it is drawn, mm: what it can move either way."""
    loose = (
        other
        for other in below
        if other.part.name == name
        and (other.part.role == "spacer" or GREASED in other.part.notes)
        and any(hole.in_line(each) for each in other.holes)
    )
    room = next((room_under(other, below)[0] for other in loose), 0.0)
    return room if room < RESTS else 0.0


def seats_at_ends(shaft: StandingCopy) -> tuple[float, float]:
    """Lengths of the flat or keyway at the lower and at the upper end of a shaft, mm; 0 where that is round."""
    layers = sorted(shaft.part.layers, key=lambda each: each.z0)
    low, high = (
        sum(
            each.z1 - each.z0
            for each in takewhile(lambda each: seat_of(each.region.outer), ordered)
        )
        for ordered in ((layers[::-1], layers) if shaft.mount.flipped else (layers, layers[::-1]))
    )
    return low, high


def gap_under(hole: Round, below: Sequence[StandingCopy]) -> tuple[float, str]:
    """How far over what lies next under a hole, mm, and its part's name; 0 and "" where nothing does. A bush that is flush with its
    plate is not what one measures from."""
    under = [
        (round(hole.low - each.high, 9), other.part.name == BUSH, other.part.name)
        for other in below
        for each in other.holes
        if hole.in_line(each) and -SAME_POINT < hole.low - each.high < RESTS
    ]
    gap, _, name = min(under, default=(0.0, False, ""))
    return gap, name


def _depth(
    pin: StandingCopy,
    fixed: Sequence[tuple[Round, StandingCopy]],
    holes: Sequence[tuple[Round, StandingCopy]],
) -> str:
    """How deep a pin or ring is driven into what it is fixed in: till its head is down, or it lies on a lip, or where the end is that goes in first, and what is
    left under a head.

    holes: all that it goes through.
    """
    head = max(pin.outlines, key=lambda each: each.diameter)
    borne = [other.part for hole, other in holes if abs(hole.high - head.low) < SAME_POINT]
    if borne and pin.mount.flipped and len(pin.outlines) > 1:
        return f"its head down on {borne[0].name}"
    foot = min(pin.outlines, key=lambda each: each.low)
    lips = [each for _, other in fixed for each in other.holes if each.in_line(foot)]
    if any(abs(lip.high - foot.low) < SAME_POINT and lip.diameter < foot.diameter for lip in lips):
        return "from above, down on the lip"
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
    if gap := _head_gap(pin, [hole for hole, _ in holes]):
        return f"{end}, {gap:.3g} mm left under its head with all pushed down{between(gap)}"
    return end


def _head_gap(pin: StandingCopy, holes: Sequence[Round]) -> float:
    """How much is left under the head of a pin that comes from above, mm, with all that it goes through pushed together under it;
    0 where nothing says."""
    head = max(pin.outlines, key=lambda each: each.diameter)
    top = head.low
    left = 0.0
    for hole in sorted(holes, key=lambda each: -each.high):
        if hole.high > head.low - SAME_POINT:
            continue
        if top - hole.high >= RESTS:
            break
        left += max(0.0, top - hole.high)
        top = min(top, hole.low)
    hangs = pin.mount.flipped and len(pin.outlines) > 1
    return left if hangs else 0.0


def _pin_words(
    copy: StandingCopy, below: Sequence[StandingCopy], fixing: Fixing
) -> tuple[Place, str]:
    """Through what a pin or a shaft goes that lies there, from above, and where it is fixed; HOLE for the hole's letter, and that."""
    round_holes = [
        (hole, other, outline)
        for other in reversed(below)
        for hole in other.holes
        for outline in copy.outlines
        if hole.holds(outline)
    ]
    letter = next((hole.name for hole, _, _ in round_holes if hole.name), "")
    point = f"{HOLE} of " if letter else ""
    words: dict[Joint, list[str]] = {}
    for hole, other, outline in round_holes:
        names = words.setdefault(fixing.joint(hole, other.part, outline, copy.part), [])
        names += [other.part.name] if other.part.name not in names else []
    ways: list[str] = []
    beginning = ""  # of the first of them
    begins = "put "
    first = ""  # of the sentence, after what it is done with
    more = ""  # of the sentence, after that
    above = " from above" if copy.mount.flipped else ""
    for joint, names in sorted(words.items(), key=lambda each: each[0] != ""):
        fit = f"{joint} " if joint else ""
        into = "into " if fit else "through "
        through = listed(names)
        if not ways:
            begins = verb(joint) if fit else "push "
            beginning = fit
            first, more = f"{above} {into}{point or through}", f"{through if point else ''}"
            ways.append(f"{into}{point}{through}")
        else:
            more += f"; {verb(joint)}{IT} {into}{through}"
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
    seats = dict.fromkeys(each.flat for hole, _, each in tight if hole.flat and each.flat)
    flats = [turned(seat, fixing.metal) for seat in seats]
    if copy.mount.flipped:  # from above, where a head may be in the way
        side = "flush with its upper side"
        top = max((each.high for each in copy.outlines), default=0.0)
        gaps = [
            (hole.high - other.mount.z - other.part.thickness, hole.high - top)
            for hole, other in fixed
        ]
    else:
        side = "from above, flush with its underside"
        foot = min((each.low for each in copy.outlines), default=0.0)
        gaps = [(hole.low - other.mount.z, hole.low - foot) for hole, other in fixed]
    deep = ""
    if any(max(map(abs, gap)) < SAME_POINT for gap in gaps):
        ways.append(side)
    elif fixed and (deep := _depth(copy, fixed, [(hole, other) for hole, other, _ in round_holes])):
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
    gap = _head_gap(copy, [hole for hole, *_ in round_holes]) if deep else 0.0
    needs = (gauge_tools(gap) if gap else ()) + _glue_of(rest)
    doing = Doing(begins, f"{WHAT}{first}", rest, needs)
    return (Place(f"{beginning}{said}", (doing,)) if said else Place()), letter
