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

from collections.abc import Iterator, Sequence
from dataclasses import replace

from camgen.machine.features import CamOutline, SlideFaces
from camgen.machine.model import GROUND
from camgen.parts.blocks import bearing_blocks, strips_under
from camgen.parts.fixing import Fixing, with_joints
from camgen.parts.layings import Laying, layings_of
from camgen.parts.loose_parts import (
    fixed_by,
    fixed_on,
    fixed_one_by_one,
    is_held,
    loosely,
    push_up,
    stops_of,
    waiting_under,
)
from camgen.parts.mates import mated, mates_between
from camgen.parts.part import GluedNote, HoldingNote, Part
from camgen.parts.standing import Round, StandingCopy
from camgen.parts.step_places import fixed_on_pin, gap_under, places_of
from camgen.parts.step_words import (
    LIES_ON_BENCH,
    MOVES,
    TWO_PART,
    Place,
    between,
    called,
    gauge_tools,
    listed,
    turned,
    where_all,
)
from camgen.study import Doing, Mate, Step, Table
from camgen.tolerances import SAME_POINT

COLUMNS = ("step", "part", "what", "where", "count", "underside at z, mm", "lies")
_FOOT = 1.0  # mm, of a part that is glued by its foot, for the picture
_SMALL = ("spacer", "sleeve", "cap", "nut")  # of parts of which several are put on in one step


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
    stops = stops_of(copies, fixing)
    untried = dict[str, Doing]()  # what is moved when no pin stands on its head any more, by part
    loose = list[Laying]()  # on their shafts, whose stops are not there yet
    layings = layings_of(copies, pairs, fixing)
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
            places = [loosely(laying, [each.part.name for each in shafts.values()])]
            loose.append(laying)
            begins = bool(steps and {*shafts} <= {*steps[-1].copies})
            by_hand = [  # what is pushed up on its shaft later
                (part.name, hole.name)
                for copy in laying.copies
                for hole, _ in fixed_on(copy, [stops[copy.name].shaft], fixing)
            ]
        else:
            places = places_of(laying.copies, bench if alone else there, fixing)
            if not alone:
                places = _on_motor(laying.copies, fixing, places, there)
            if not places and alone:
                places = [LIES_ON_BENCH]
            elif not places and (there or not laying.copies[0].holes):
                # a plate that comes first lies
                places = fixed_one_by_one(later, laying.copies, there, fixing, blocks)
                places = places or waiting_under(later, laying.copies)
        lies = "turned over" if laying.turned_over else "as drawn"
        row: tuple[object, ...]
        row = (
            part.name,
            holding_notes(part),
            where_all(places),
            len(laying.copies),
            laying.z,
            lies,
        )
        rows.append((len(rows) + 1, *row))
        names = [copy.name for copy in laying.copies]
        said = _doings(laying, places, _led(laying.copies[0], there, pairs), first=not there)
        borne = [] if alone else [*bearing_blocks(laying.copies, there, fixing, blocks)]
        borne += [] if alone else strips_under(laying.copies, there, fixing)
        moved = [*_squared(laying.copies, bench, fixing)] if alone else []
        if not alone:
            untried |= {each.thing: each for each in _moved(laying.copies, there, fixing)}
        if untried and not any(_stands(copy, [*there, *laying.copies], fixing) for copy in there):
            moved += untried.values()
            untried = {}
        steps.append(
            Step(
                [*borne, *said, *moved],
                names,
                group=group,
                small=part.role in _SMALL or part.process == "dummy",
                follows=begins,
                hand_fits=by_hand,
                glued=[] if alone else [*_glued_besides(laying.copies, fixing)],
            )
        )
        (bench if alone else there).extend(laying.copies)
        if bench and len(bench) == len(cluster):
            row, doings = _put_in(cluster, there, later, fixing, blocks)
            rows.append((len(rows) + 1, *row))
            by_hand = [*_by_hand(cluster, there, fixing)]
            glued = [*_glued_besides(cluster, fixing)]
            steps.append(Step(doings, group=group, hand_fits=by_hand, glued=glued))
            there += bench
            bench = []
        for each in [each for each in loose if is_held(each, stops, there, fixing)]:
            loose.remove(each)
            row, doings = push_up(each, stops)
            rows.append((len(rows) + 1, *row))
            names = [copy.name for copy in each.copies]
            steps.append(Step(doings, names, way=1))
    if untried and steps:
        steps[-1] = replace(steps[-1], doings=[*steps[-1].doings, *untried.values()])
    title = "Assembly from the bottom up, by height"
    return Table(title, COLUMNS, rows, mated(steps, copies, pairs, fixing))


def _stands(copy: StandingCopy, there: Sequence[StandingCopy], fixing: Fixing) -> bool:
    """Whether a pin stands on its head, and nothing holds it over that: it falls where what is under it moves."""
    if copy.part.role != "pin" or copy.mount.flipped or not copy.outlines:
        return False
    middle = copy.mount.z + copy.part.thickness / 2
    held = fixed_on_pin(copy, there, fixing)
    return all(each.part.role == "cap" and each.mount.z < middle for each in held)


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
    motor = any(other.part.name in fixing.driven for other in there)
    how = " by hand, or by the motor where that holds it" if motor else " by hand"
    return [Doing(MOVES, name, f"{how}: no joint may be stiff") for name in names]


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
    places = list[Place]()
    carried = list[str]()
    for copy in cluster:
        if not mates_between([copy], there, fixing):
            continue
        found = places_of([copy], there, fixing)
        if copy.part.name != own and first.mount.body == GROUND and first.part.points:
            carried.append(where_all(found))  # a plate goes with what is pressed into it
            continue
        if copy.part.name != own:
            found = [Place(f"{copy.part.name} {each.where}", each.doings) for each in found]
        places += [each for each in found if each not in places]
    if carried:
        doing = Doing("put ", f"{called(first.part)} {listed(carried)}")
        places.append(Place(listed(carried), (doing,)))
    places = _on_motor(cluster, fixing, places, there)
    if not places and there and (first.mount.body != GROUND or not first.holes):
        places = fixed_by(later, cluster, there, fixing, blocks)  # a plate lies as it is
    places = [each.lettered("", called(first.part)) for each in places or [LIES_ON_BENCH]]
    what = f"{first.part.title} with {', '.join(others or [own])}"
    row = (own, what, where_all(places), "", first.mount.z, "as drawn")
    doings = [doing for place in places for doing in place.doings]
    borne = bearing_blocks(cluster, there, fixing, blocks)
    return row, [*borne, *doings, *_jig(cluster, there, later, fixing)]


def _squared(
    coming: Sequence[StandingCopy], bench: Sequence[StandingCopy], fixing: Fixing
) -> Iterator[Doing]:
    """That a shaft which is glued in a link on the bench is set upright by a square: the link is too thin to hold it so."""
    for copy in () if fixing.metal else coming:
        for other in bench:
            glued = any(mate.how == "glue" for mate in mates_between([copy], [other], fixing))
            shaft, holder = (copy, other) if copy.part.role == "shaft" else (other, copy)
            if glued and shaft.part.role == "shaft" and len(holder.part.points) > 1:
                rest = f" is square to {holder.part.name}, and leave it until the glue is hard"
                yield Doing("check with a square that ", shaft.part.name, rest, ("square",))


def _jig(
    cluster: Sequence[StandingCopy],
    there: Sequence[StandingCopy],
    later: Sequence[StandingCopy],
    fixing: Fixing,
) -> Iterator[Doing]:
    """That a plate which comes later is laid on the pins dry over the shaft of a web that is glued on its own: nothing else holds that
    upright. A square says whether it is where there are no pins yet."""
    shafts = [copy for copy in cluster if copy.part.role == "shaft"]
    if not shafts or not any(mate.how == "glue" for mate in mates_between(cluster, there, fixing)):
        return
    plates = [copy for copy in later if copy.mount.body == GROUND and copy.part.points]
    if plates and not any(mates_between([plate], there, fixing) for plate in plates):
        holder = next(copy for copy in cluster if copy not in shafts).part.name
        square = f" is square to {holder}, and leave it until the glue is hard"
        yield Doing("check with a square that ", shafts[0].part.name, square, ("square",))
        return
    for plate in plates:
        mates = [mate for mate in mates_between([plate], shafts, fixing) if mate.label]
        if mates:
            over = f", with {mates[0].label} over {shafts[0].part.name}"
            yield Doing(f"lay {plate.part.name} on the pins, dry", over)
            until = ": it keeps the shaft upright. Then take it off"
            yield Doing("leave it there until the glue is hard", "", until)
            return


def _on_shaft_of_motor(copies: Sequence[StandingCopy], fixing: Fixing) -> list[Round]:
    """Holes of copies in which the shaft of a motor is."""
    return [
        hole
        for copy in copies
        if copy.part.name in fixing.driven and copy.mount.body != GROUND
        for hole in copy.holes
    ]


def _glued_besides(copies: Sequence[StandingCopy], fixing: Fixing) -> Iterator[Mate]:
    """Where the flat of a motor's shaft is glued in copies, and where these are glued on what they stand, for the picture: the shaft is
    none of the parts, and nothing goes through a face."""
    for hole in _on_shaft_of_motor(copies, fixing):
        if hole.flat:
            place = hole.at.real, hole.at.imag, (hole.low + hole.high) / 2
            yield Mate("glue", hole.name, place, hole.diameter, hole.high - hole.low)
    for copy in copies:
        if any(isinstance(note, GluedNote) for note in copy.part.notes):
            foot = copy.outlines[0]
            place = foot.at.real, foot.at.imag, foot.low
            yield Mate("glue", "", place, foot.diameter, _FOOT, True)


def _on_motor(
    copies: Sequence[StandingCopy],
    fixing: Fixing,
    places: Sequence[Place],
    there: Sequence[StandingCopy],
) -> list[Place]:
    """Where copies go, with the motor's shaft if one of them is fixed on that."""
    driven = _on_shaft_of_motor(copies, fixing)
    if not driven:
        return [*places]
    shaft = "on the motor's shaft"
    glued = f", {turned('flat', fixing.metal)} all round in its bore and none on the motor"
    flat = glued if any(hole.flat for hole in driven) else ""
    gap, under = min(
        (each for hole in driven if (each := gap_under(hole, there))[1]), default=(0.0, "")
    )
    high = f", {gap:.3g} mm over {under}{between(gap)}" if gap > SAME_POINT else ""
    where = ", ".join(filter(None, (shaft, where_all(places))))
    named = called(copies[0].part)
    doings = [one for each in places for one in each.doings]
    on = doings.pop(0).thing.removeprefix(named) if doings and doings[0].verb == "set " else ""
    tools = gauge_tools(gap) if high else ()
    tools += (TWO_PART,) if TWO_PART in flat else ()
    push = Doing("push ", f"{named} {shaft}{f',{on}' if on else ''}{flat}{high}", "", tools)
    if flat:  # else it is turned on the shaft
        at = distances(driven, there)
        dry = f"{named} {shaft}, dry, and run the motor until it stands as the picture shows{at}. Take it off again"
        again = "whenever the motor has moved the links, stop it there again"
        return [Place(f"pushed {where}", (Doing("put ", dry), push, *doings, Doing(again)))]
    return [Place(f"pushed {where}", (push, *doings))]


def distances(driven: Sequence[Round], there: Sequence[StandingCopy]) -> str:
    """Where what a motor turns stands, by what a caliper measures from a hole of it to two of the plate, in words; "" where none are
    named. driven: its holes, one of them on the motor's axis."""
    fixed = [
        hole for plate in there if plate.mount.body == GROUND for hole in plate.holes if hole.name
    ]
    turning = [hole for hole in driven if hole.name and not any(map(hole.in_line, fixed))]
    if not turning:
        return ""
    moved = turning[0]
    off = {
        hole.name: abs(hole.at - moved.at) for hole in fixed if not any(map(hole.in_line, driven))
    }
    first, second, *_ = [*sorted(off, key=lambda name: off[name]), "", ""]
    if not second:
        return ""
    return f", {moved.name} {off[first]:.1f} mm from the middle of {first} and {off[second]:.1f} mm from that of {second}"


def _doings(laying: Laying, places: Sequence[Place], led: str, first: bool) -> list[Doing]:
    """What is done with the copies of one part; led: in or against what they run; first: nothing is there yet."""
    part = laying.copies[0].part
    named = called(part, len(laying.copies))
    notes = [note for note in part.notes if isinstance(note, HoldingNote)]
    if part.process == "dummy":
        return [Doing(f"{part.title}: the picture shows where your own one is")]
    if first and not places and not notes:
        places = [LIES_ON_BENCH]
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


def holding_notes(part: Part) -> str:
    """What a part is, and what its notes say of how it is held."""
    notes = [note for note in part.notes if isinstance(note, HoldingNote)]
    return f"{part.title}: {'; '.join(notes)}" if notes else part.title
