"""The first step at the bench of what is printed: holes in which something turns or slides are opened to their size, and tried; those
into which something goes by hand, and those that stay tight, are told apart from them."""

from __future__ import annotations

import cmath
import math
from collections import defaultdict
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from camgen.parts.catalogue import SCREWS
from camgen.parts.fixing import JOINTS, Fixing, Joint
from camgen.parts.part import Part, SizeNote
from camgen.parts.screws import screw_hole
from camgen.parts.standing import Round, StandingCopy
from camgen.parts.step_words import TWO_PART, listed
from camgen.study import Doing, Laid, Step, Table
from camgen.tolerances import SAME_POINT

MEDIUM = "anaerobic compound of medium strength"  # of what a key turns
KEYED_GLUE = "glue of keyed parts"  # its name in lists
_WIDEST = 13.0  # mm, of a drill that people have


def opened_holes(copies: Sequence[StandingCopy], fixing: Fixing) -> dict[float, int]:
    """How many holes in which something turns or slides are opened, by their size, mm."""
    return {
        size: sum(part.count * len(holes) for part, holes in parts.values())
        for size, parts in sorted(_holes(copies, fixing, _reamed).items())
    }


def with_reaming(
    table: Table, copies: Sequence[StandingCopy], fixing: Fixing, metal: bool = False
) -> Table:
    """The order of assembly, begun with the holes that are to be reamed and those that stay tight; as it is where there are none.
    metal: whether the parts are of it: they come made as on their sheets, and their glue is one for metal."""
    opened = _holes(copies, fixing, _running if metal else _reamed)
    fixed = tight_holes(copies, fixing)
    keyed = _joined(copies, fixing, "keyed and glued")
    if metal:
        fitted = _joined(copies, fixing, "glued")
        tight = _joined(copies, fixing, "pressed", "pressed and glued")
    else:
        by_hand = {hole for step in table.steps for hole in step.hand_fits}
        fitted = _of(fixed, by_hand)
        tight = _of(fixed, _letters(fixed) - by_hand)
    if not opened and not fixed:
        return table
    said = []
    rough = False  # whether a drill is one that few people have
    words = _IN_METAL if metal else _IN_PLASTIC
    bores = _bores(opened, fixed)

    def lines_of(holes: Mapping[float, _Holes], tool: Callable[[float], str]) -> list[str]:
        """What opens holes, and which, in words."""
        every = sorted(holes.items())
        return [f"{tool(size)}: {listed(_named(parts, size, bores))}" for size, parts in every]

    lines = lines_of(opened, words.running)
    if lines:
        count = sum(p.count * len(letters) for of in opened.values() for p, letters in of.values())
        holes = {1: "the hole", 2: "both holes"}.get(count, f"all {count} holes")
        rough = not metal and any(map(common_drill, opened))
        said = [words.opened.format(holes) + _ROUGH * rough + _ticks(lines)]
    said += [words.by_hand + _ticks(lines_of(fitted, words.tool))] if fitted else []
    said += [_KEYED + _ticks(lines_of(keyed, words.tool))] if keyed else []
    said += [words.tight + _ticks(lines_of(tight, words.tool))] if tight else []
    said += [] if metal else _for_screws(screw_holes(copies, fixing, table.steps))
    what = (
        "Holes in which something turns or slides" if lines else "Holes in which something is fixed"
    )
    where = "; ".join(lines or lines_of(fixed, words.tool))
    needs = (
        ("fine sandpaper",) * rough
        + ("scraper",) * bool(fixed and not metal)
        + ("vice",) * bool(tight)
    )
    return begun(table, Doing("\n".join(said), needs=needs), what, where, count if lines else "")


def with_gluing(
    table: Table, copies: Sequence[StandingCopy], fixing: Fixing, metal: bool = False
) -> Table:
    """The order of assembly, begun with how all its steps glue; as it is where nothing is glued."""
    if not tight_holes(copies, fixing):
        return table
    which = " what has no key" if _joined(copies, fixing, "keyed and glued") else ""
    said = [f"in all steps glue{which} with {glue(metal)}, a trace only"]
    pins = {copy.part.name for copy in copies if copy.part.role == "pin"}
    said += [_DEGREASED] if metal else []
    said += [_OUT_OF_BALLS] if metal and pins & fixing.journals else []
    hung = any(copy.part.name in pins and copy.mount.flipped for copy in copies)
    said += [_OUT_OF_JOINTS] if hung and not metal else []
    needs = {need for each in _needs(table) for need in each}
    said += [_SLOW] if TWO_PART in needs else []
    moves = bool(opened_holes(copies, fixing))
    said += [_SWING] if moves else []
    capped = moves and not metal and any(copy.part.role == "cap" for copy in copies)
    said += [_WIPED] if capped else []
    gauges = [words for name, words in sorted(_GAUGES.items()) if name in needs]
    said += [_PULLED.format(" and ".join(gauges))] if gauges and not metal else []
    slit = "plastic bag" in needs and not metal
    said += [_SLIT] if slit else []
    said += [_PROPPED] if any(doing.props for step in table.steps for doing in step.doings) else []
    own = ("oil",) * moves + ("alcohol",) * capped + ("scissors",) * slit
    doing = Doing("\n".join(said), needs=own)
    return begun(table, doing, "How parts are glued", "", "")


def screw_holes(
    copies: Sequence[StandingCopy], fixing: Fixing, steps: Sequence[Step]
) -> dict[tuple[str, float], _Holes]:
    """Holes of printed parts for screws, by thread and size, mm."""
    return {
        (thread, size): holes
        for thread in sorted({thread for step in steps for thread, _ in step.threads})
        for size, holes in sorted(_holes(copies, fixing, _screwed(thread, steps)).items())
    }


def _screwed(thread: str, steps: Sequence[Step]) -> _Size:
    """The size of a hole for a screw of a thread, mm; 0 of any other hole."""

    def size_of(hole: Round, *_: object) -> float:
        own, size = screw_hole(hole, steps)
        return size if own == thread else 0.0

    return size_of


def _for_screws(holes: Mapping[tuple[str, float], _Holes]) -> Iterator[str]:
    """How the holes of screws are tried and opened, in words."""
    through = list[str]()
    cut = list[str]()
    for (thread, size), parts in holes.items():
        counts = ((part, len(letters)) for part, letters in parts.values())
        said = listed(
            f"{'the hole' if n == 1 else f'{n} holes'} of {part.name}{f' ({part.count} ×)' if part.count > 1 else ''}"
            for part, n in counts
        )
        lines = cut if size < SCREWS[thread].nominal else through
        lines.append(f"{size:g} mm, for {thread}: {said}")
    if through:
        yield _SCREWED + _ticks(through)
    if cut:
        yield _THREADED + _ticks(cut)


_SCREWED = "Try a screw in each of these. Where it does not go through by hand, turn a drill of this size in the hole"
_THREADED = "Screws cut their own threads in these. Turn a drill of this size in them, straight, and then a screw, in and out"


def _needs(table: Table) -> Iterator[set[str]]:
    """Tools of all that is done."""
    return ({*doing.needs} for step in table.steps for doing in step.doings)


def with_cutting(table: Table, parts: Sequence[Part], metal: bool = False) -> Table:
    """The order of assembly, begun with what is cut of steel, and with dowels, of which a printed machine's links pass over both
    ends; as it is where there is neither, and in metal, where all comes made as on its sheet."""
    sizes = [(part, note) for part in parts for note in part.notes if isinstance(note, SizeNote)]
    lines = [f"{part.count} × {part.name}: {note}" for part, note in sizes]
    lines += [f"1 × gauge: {gauge}" for step in table.steps for gauge in step.gauges]
    said = [f"cut and file the steel parts, and deburr them{_ticks(lines)}"] if lines else []
    said += dict.fromkeys(note.how for _, note in sizes if note.how)
    if any(part.process == "bought" and part.role == "pin" for part in parts):
        said.append(_DOWELS if lines else _DOWELS[:1].lower() + _DOWELS[1:])
    if metal or not said:
        return table
    count = sum(part.count for part, _ in sizes)
    what = "What is cut of steel" if lines else "Lengths of dowels"
    needs = ("file", "caliper", *(("saw",) if lines else ()))
    return begun(table, Doing("\n".join(said), needs=needs), what, "; ".join(lines), count or "")


# DIN 7 allows 0.3 mm at lengths up to 10 mm, 0.5 mm at those up to 50 mm [nutbolt.org/Standards/Pin-Dowel.html].
_DOWELS = (
    "Measure the dowels: as they are sold some are up to 0.5 mm too long. File or grind these to their length in the list, for "
    "parts pass close over their ends"
)


_SWING = (
    "First put a drop of oil into the joint beside it: that keeps the glue out. When a pin or cap keeps a link in place, tilt the "
    "machine. As long as its other end is free, the link must swing by its own weight"
)


# Parts of metal come oiled, and some go through greased bores before they are glued. Strength over time on steel, 5 min to 168 h, is in its makers'
# sheets as a graph [scribd.com/document/510259854, LOCTITE 638; dtsheet.com/doc/1041088, 641]: the hours are camgen's own rule.
_DEGREASED = (
    "Degrease each bore, pin and end of a shaft before it is glued, once more after it went through a greased bore, and let it dry. "
    "Leave each joint alone until the compound is hard, at least half an hour; only after 24 hours, or as its maker's sheet says, may the machine run"
)
# Of a pin that goes through a ball bearing before it is glued.
_OUT_OF_BALLS = "Where a pin goes through a ball bearing, put it in the hole under that alone, none on the pin: it would run into the balls"
_SLOW = f"Where a step names {TWO_PART}, use that alone, and let it get hard before anything there is moved"
# Of a pin whose head holds a link in place.
_OUT_OF_JOINTS = "Where a pin goes through a part that turns on it, put the glue into the tight hole, none on the pin, and wipe off what comes out below"
_GAUGES = {"plastic bag": "strips", "sheets of paper": "paper"}  # of tools that set gaps
_PULLED = "Pull {} out of gaps as soon as the part is on, before the glue is hard, unless the step says to leave them there"
_SLIT = "Slit each strip to its middle: so it goes round a pin, and comes out again"
_WIPED = "Wipe the oil off a pin's end with alcohol before a cap is glued on it"
_PROPPED = "A block under one part alone goes as soon as the glue is hard or another part holds it"


def glue(metal: bool) -> str:
    """What parts are glued with on shafts and pins."""
    if metal:
        return "anaerobic retaining compound of high strength for cylindrical joints of metal"
    return "superglue gel or two-part glue"


def _letters(holes: Mapping[float, _Holes]) -> set[tuple[str, str]]:
    """Holes by part and letter."""
    every = (each for parts in holes.values() for each in parts.items())
    return {(name, letter) for name, (_, letters) in every for letter in letters}


def _of(holes: Mapping[float, _Holes], chosen: Collection[tuple[str, str]]) -> dict[float, _Holes]:
    """Those of the holes that are chosen, by part and letter."""
    found = dict[float, _Holes]()
    for size, parts in holes.items():
        for name, (part, letters) in parts.items():
            own = [letter for letter in letters if (name, letter) in chosen]
            if own:
                found.setdefault(size, {})[name] = part, own
    return found


def _joined(copies: Sequence[StandingCopy], fixing: Fixing, *joints: Joint) -> dict[float, _Holes]:
    """Holes of printed parts with one of these joints, by the diameter of what is fixed there, mm."""

    def size_of(
        hole: Round, holder: StandingCopy, copies: Sequence[StandingCopy], fixing: Fixing
    ) -> float:
        others = (each for each in copies if each is not holder)
        return round(_widest(hole, holder, others, fixing, joints), 3)

    return _holes(copies, fixing, size_of)


def opener(size: float, runs: bool = False) -> str:
    """What opens a hole of a size, mm; runs: in which something turns or slides."""
    drill = _running_drill(size) if runs else math.floor(10 * size + SAME_POINT) / 10
    return f"drill {drill:g}" if size <= _WIDEST else "fine sandpaper"


def _running_drill(size: float) -> float:
    """The narrowest drill that leaves a hole no narrower than a size, mm: drills are in tenths."""
    return math.ceil(10 * size - SAME_POINT) / 10


def common_drill(size: float) -> float:
    """The next narrower drill of a set in half millimetres, for a hole in which something turns or slides; 0 where its own drill is
    one of these, or none is."""
    drill = _running_drill(size)
    common = math.floor(2 * size + SAME_POINT) / 2
    return 0.0 if size > _WIDEST or abs(drill - common) < SAME_POINT else common


def _tool(size: float) -> str:
    """The size of a hole, mm, and what opens it where that is no drill of people."""
    return f"{size:g} mm" if size <= _WIDEST else f"{size:g} mm, with {opener(size)}"


def running(size: float) -> str:
    """The same of a hole in which something turns or slides; of a size between two drills which one is wide enough."""
    drill = _running_drill(size)
    between = size <= _WIDEST and drill - size > SAME_POINT
    return f"{size:g} mm, with a reamer or a drill of {drill:g}" if between else _tool(size)


def _bare(size: float) -> str:
    """The size of a hole, mm."""
    return f"{size:g} mm"


@dataclass(frozen=True)
class _Words:
    """How holes of a material are brought to their fits."""

    opened: str  # those in which something turns or slides
    by_hand: str  # those into which something goes by hand
    tight: str
    running: Callable[[float], str]  # the size of these, and what opens them
    tool: Callable[[float], str]  # the same of a hole in which something is fixed


_IN_PLASTIC = _Words(
    "open {} in which something turns or slides. Turn a drill of this size in it by hand, and keep it straight, until what goes in drops "
    "through by its own weight",
    "Open these until the part slides in by hand. Use a drill of this size, or a scraper where there is a flat. No vice reaches "
    "them later; the glue holds the part where its step says so",
    "These holes stay tight. In their step, press the part in with a vice. If it does not go in, scrape the hole, or turn a "
    "drill of this size in it by hand",
    running,
    _tool,
)
_ROUGH = ". If your drills are in steps of 0.5 mm, turn the next narrower one in it, then fine sandpaper rolled round a thin rod"
_IN_METAL = _Words(
    "try {} in which something turns or slides: what goes in drops through by its own weight",
    "What these hold goes in by hand; the compound holds it",
    "What these hold is pressed in, in its step",
    _bare,
    _bare,
)
_KEYED = (
    "These have keyways. In their step, tap the key into the shaft first, then press the part over it: the key is tight in both and turns "
    f"the part. {MEDIUM[0].upper()}{MEDIUM[1:]} keeps that from sliding along the shaft; a puller takes it off again"
)


def _bores(*several: Mapping[float, _Holes]) -> dict[str, set[float]]:
    """Sizes of the holes without letters by the name of their part, mm."""
    found = defaultdict[str, set[float]](set)
    for size, parts in (each for holes in several for each in holes.items()):
        for name, (_, letters) in parts.items():
            if "" in letters:
                found[name].add(size)
    return found


def _ticks(lines: Sequence[str]) -> str:
    """Lines to tick off."""
    return "".join(f"\n☐ {line}" for line in lines)


def begun(
    table: Table,
    doing: Doing,
    what: str,
    where: str,
    count: int | str = "",
    laid: Laid = (),
) -> Table:
    """The order of assembly with one more step before all others; laid: what its picture shows."""
    said = doing.verb
    cells = {"step": 1, "what": what, "where": where, "count": count, "how": said}
    row = tuple(cells.get(column, "") for column in table.columns)
    rows = [row, *((int(str(step)) + 1, *cells) for step, *cells in table.rows)]
    return replace(table, rows=rows, steps=[Step([doing], laid=laid), *table.steps])


def running_size(diameter: float, play: float) -> float:
    """Of a hole with play round a diameter, mm: in tenths, as drills are, where one of these is wider than the diameter, else in
    hundredths."""
    size = diameter + play + SAME_POINT
    drill = math.floor(10 * size) / 10
    return drill if drill > diameter else math.floor(100 * size) / 100


_Holes = dict[str, tuple[Part, list[str]]]  # by the name of a part


def _named(parts: _Holes, size: float, bores: Mapping[str, set[float]]) -> Iterator[str]:
    """Holes of each part in words: "B and C1 of low1 (2 ×)"; size: of what is fixed there, mm; bores: as of `_bores`."""
    for part, holes in parts.values():
        many = f" ({part.count} ×)" if part.count > 1 else ""
        letters = [name for name in holes if name]
        rest = len(holes) - len(letters)
        beside = part.bore is not None and size < part.bore / 2 + SAME_POINT
        sizes = bores.get(part.name, ())
        which = (
            {min(sizes): "narrower ", max(sizes): "wider "}.get(size, "") if len(sizes) > 1 else ""
        )
        one = "the hole beside the bore" if beside else f"the {which}bore"
        bare = [one if rest == 1 else f"{rest} {which}bores"] if rest else []
        yield f"{listed([*letters, *bare])} of {part.name}{many}"


_Size = Callable[[Round, StandingCopy, Sequence[StandingCopy], Fixing], float]


def tight_holes(copies: Sequence[StandingCopy], fixing: Fixing) -> dict[float, _Holes]:
    """Holes of printed parts in which something is fixed, by the diameter of that, mm."""
    return _joined(copies, fixing, *JOINTS)


def _holes(
    copies: Sequence[StandingCopy],
    fixing: Fixing,
    size_of: _Size,
) -> dict[float, _Holes]:
    """Holes of printed parts by a size, mm, that is 0 of those that do not count."""
    found = defaultdict[float, _Holes](dict)
    seen = set[tuple[object, ...]]()
    for holder in copies:
        if holder.part.process != "printed":
            continue
        for hole in holder.holes:
            size = size_of(hole, holder, copies, fixing)
            own = (holder.part.name, hole.name, round(hole.diameter, 3), _own_place(hole, holder))
            if not size or own in seen:
                continue
            seen.add(own)
            found[size].setdefault(holder.part.name, (holder.part, []))[1].append(hole.name)
    return dict(found)


def _own_place(hole: Round, holder: StandingCopy) -> tuple[float, float]:
    """What tells holes of one part without names apart: where each is in the part's frame, mm."""
    turned = cmath.exp(-1j * float(holder.pose.angle[0]))
    at = (hole.at - complex(holder.pose.place[0])) * turned
    return round((-at if holder.pose.flipped else at).real, 3) + 0.0, round(at.imag, 3) + 0.0


def _reamed(
    hole: Round, holder: StandingCopy, copies: Sequence[StandingCopy], fixing: Fixing
) -> float:
    """The size to which a hole is opened, mm, for what turns or slides in it; 0 where nothing does, or a sleeve clear of it."""
    widest = _running(hole, holder, copies, fixing)
    return running_size(widest, hole.diameter - widest) if widest else 0.0


def _running(
    hole: Round, holder: StandingCopy, copies: Sequence[StandingCopy], fixing: Fixing
) -> float:
    """Diameter of what turns or slides in a hole, mm; 0 where nothing does, or a sleeve clear of it."""
    others = (
        each
        for each in copies
        if each.part.role != "sleeve" and _moves(holder, each, fixing) and each is not holder
    )
    return round(_widest(hole, holder, others, fixing, ("",)), 3)


def _moves(holder: StandingCopy, held: StandingCopy, fixing: Fixing) -> bool:
    """Whether one part moves on another: on one body a knob or a spacer does, which has play there in all of its holes."""
    if held.mount.body != holder.mount.body:
        return True
    tells = math.isfinite(fixing.play)  # whether play tells what is loose from what is fixed
    return tells and not any(_widest(hole, holder, [held], fixing, JOINTS) for hole in holder.holes)


def _widest(
    hole: Round,
    holder: StandingCopy,
    others: Iterable[StandingCopy],
    fixing: Fixing,
    joints: Sequence[Joint],
) -> float:
    """The diameter of what goes through a hole with one of these joints, mm, "" what is free there; 0 of nothing."""
    return max(
        (
            outline.diameter
            for held in others
            if held.pose.standing == holder.pose.standing
            for outline in held.outlines
            if hole.holds(outline) and fixing.joint(hole, holder.part, outline, held.part) in joints
        ),
        default=0.0,
    )
