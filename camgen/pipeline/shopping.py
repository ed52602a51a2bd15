"""What is bought for a machine, and the steps that put it in."""

from __future__ import annotations

import math
from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np

from camgen.machines.mechanism import Mechanism
from camgen.parts import materials
from camgen.parts.assembly import Assembly, depth_below, order_of_assembly
from camgen.parts.bench_steps import at_bench
from camgen.parts.catalogue import CAM_FOLLOWERS, HEX_KEYS, NUT_STANDARD, Bought, turning_text
from camgen.parts.fixing import Fixing, with_joints
from camgen.parts.keyways import parallel_keys
from camgen.parts.look_alikes import with_sorting
from camgen.parts.part import SizeNote
from camgen.parts.reaming import (
    common_drill,
    opened_holes,
    opener,
    screw_holes,
    tight_holes,
    with_cutting,
    with_gluing,
    with_reaming,
)
from camgen.parts.shafts import of_yours
from camgen.parts.standing import StandingCopy, standing_copies
from camgen.parts.step_words import listed
from camgen.parts.tools import SUPPLIES, USES
from camgen.study import Table
from camgen.tolerances import SAME_POINT

_IN_SHAFT = "pressed or tapped into the keyway of the shaft, before that goes through the bore"


def bought_things(mechanism: Mechanism) -> list[Bought]:
    """What is bought for a machine, beside its parts: keys in keyways and the rollers that its load names too; and what is your own."""
    assembly = mechanism.assembly
    keys = [*parallel_keys(assembly.parts, assembly.one_key)]
    if any(each.role == "shaft" for each in assembly.bought):
        keys = [replace(each, at=(), how=_IN_SHAFT) for each in keys]
    things = [*keys, *assembly.bought]
    rollers = [cam.roller for cam in assembly.outlines.values()]
    named = None if mechanism.load is None else mechanism.load.cam_follower
    if named and rollers and not any(rollers):
        rolls = CAM_FOLLOWERS[named]
        discs = [disc for each in assembly.stand_ins if each.rolls for disc in each.discs]
        wide = max((high - low for _, _, low, high in discs), default=rolls.width)
        clear = (rolls.width - wide) / 2 + rolls.beyond
        where = "in your follower, its ring on the cam" + " of its height" * (len(discs) > 1)
        things += rolls.bought(max(len(discs), 1), clear, where)
    return [*things, *_of_yours(mechanism, named)]


def _of_yours(mechanism: Mechanism, named: str | None) -> Iterator[Bought]:
    """What is your own beside a shaft that is made; named: the roller that the load names."""
    stud = f", and {CAM_FOLLOWERS[named].stud:g} H7 for the stud" if named else ""
    follower = Bought("follower", "", f"with its guide or pivot{stud}", 1, "own")
    for thing in mechanism.assembly.bought:
        if thing.shaft is not None:
            yield from of_yours(thing.shaft, _drive(mechanism))
            yield follower


def _drive(mechanism: Mechanism) -> str:
    """What turns a shaft, in words."""
    motor = getattr(mechanism, "motor", None)
    speed = getattr(motor, "speed_rpm", None)
    words = [
        getattr(motor, "model", None),
        "" if speed is None else turning_text(speed),
        "its torque as in the report" if mechanism.load is not None else "",
    ]
    return ", ".join(word for word in words if word)


def _standing(assembly: Assembly) -> tuple[list[StandingCopy], Fixing]:
    """Copies where they stand at theta = 0, and how they are fixed in each other."""
    copies = standing_copies(assembly.parts, assembly.mounts, assembly.poses(np.zeros(1)))
    return copies, with_joints(assembly.process.fixing, assembly.features)


def choices(mechanism: Mechanism) -> list[tuple[str, object]]:
    """Keys that camgen works out where a spec leaves them open, with their values, then those of what is bought."""
    things = [each for each in mechanism.assembly.bought if each.key]
    bought = [(thing.key, f"{thing.name}: {thing.size}") for thing in things]
    return [*mechanism._found().items(), *bought]


def stock(mechanism: Mechanism) -> list[Bought]:
    """Steel from which parts are cut: of each size the length of all of them."""
    pieces = defaultdict[str, list[float]](list)
    assembly = mechanism.assembly
    notes = [note for part in assembly.parts for note in part.notes for _ in range(part.count)]
    gauges = [gauge for step in _work(mechanism).steps for gauge in step.gauges]
    for note in (*notes, *gauges):
        if isinstance(note, SizeNote):
            pieces[note.stock].append(note.length)
    by_hand = ", sawn and filed" if materials.of(mechanism.material.name).printed else ""
    return [
        Bought(
            f"steel {name}",
            "",
            f"{_rounded_up(sum(lengths)):g} mm in total, {_pieces(lengths)}{by_hand}",
            1,
        )
        for name, lengths in pieces.items()
    ]


def _rounded_up(length: float) -> float:
    """A length to buy, in tenths of a mm."""
    return math.ceil(10 * length - SAME_POINT) / 10


def _pieces(lengths: Sequence[float]) -> str:
    """Into how many pieces a rod is cut."""
    return f"plus the saw cuts, for {len(lengths)} pieces" if len(lengths) > 1 else "for one piece"


def tools(mechanism: Mechanism) -> list[Bought]:
    """What the steps of assembly of a printed machine ask for: drills for its holes, what they name, and what else is at hand on a
    bench."""
    if not materials.of(mechanism.material.name).printed:
        return []
    assembly = mechanism.assembly
    copies, fixing = _standing(assembly)
    found = dict[str, str]()
    for size, count in opened_holes(copies, fixing).items():
        holes = f"for {count} hole{'' if count == 1 else 's'} of {size:g} mm"
        common = common_drill(size)
        found[opener(size, True)] = holes + (
            f", or drill {common:g} and sandpaper" if common else ""
        )
    for size in sorted(tight_holes(copies, fixing)):
        found.setdefault(opener(size), f"for holes of {size:g} mm that come out too tight")
    for _, size in screw_holes(copies, fixing, _work(mechanism).steps):
        found.setdefault(opener(size), "for holes of screws that come out too tight")
    needs = _needs(mechanism)
    held = ["springs"] if "pliers" in needs else []
    held += ["nuts"] if any(each.standard == NUT_STANDARD for each in assembly.bought) else []
    uses = USES | {"pliers": f"{USES['pliers']}, for {' and '.join(held)}"}
    for name in uses:
        if name in needs or (name == "pliers" and held):
            found.setdefault(name, uses[name])
    for each in assembly.bought:
        key = HEX_KEYS.get(each.standard, {}).get(each.thread)
        if key:
            found[f"hex key {key:g}"] = f"for {each.thread}, {each.standard}"
    things = [Bought(name, "", size, 1) for name, size in found.items()]
    for gauge in dict.fromkeys(each for step in _work(mechanism).steps for each in step.gauges):
        things.append(Bought("gauge", "", f"{gauge}, cut of the same rod", 1))
    if blocks := depth_below(assembly):
        things.append(Bought("block", "", f"at least {blocks} mm high, under the machine", 2))
    return [*things, *_props(mechanism)]


def supplies(mechanism: Mechanism) -> list[Bought]:
    """What the steps of assembly of a printed machine use up."""
    needs = _needs(mechanism) if materials.of(mechanism.material.name).printed else set()
    return [Bought(name, "", what, 1) for name, what in SUPPLIES.items() if name in needs]


def _needs(mechanism: Mechanism) -> set[str]:
    """Tools and supplies that the steps of assembly name."""
    steps = _work(mechanism).steps
    return {need for step in steps for doing in step.doings for need in doing.needs}


def _props(mechanism: Mechanism) -> list[Bought]:
    """Blocks that prop or bear something in steps: of each height as many as one step asks for."""
    counts = Counter[str]()
    for step in _work(mechanism).steps:
        own = Counter(
            f"{each:.4g}" for doing in (*step.doings, *step.pressed) for each in doing.props
        )
        counts |= own
    if not counts:
        return []
    highs = listed(
        f"{n} × {high}" if n > 1 else high
        for high, n in sorted(counts.items(), key=lambda each: float(each[0]))
    )
    size = f"or a stack of card, {highs} mm high, where a step asks for it"
    return [Bought("prop", "", size, sum(counts.values()))]


def _work(mechanism: Mechanism) -> Table:
    """In which order a machine goes together, with all that is bought for it, one part after the other."""
    metal = materials.of(mechanism.material.name).metal
    return _made_once(mechanism.assembly, tuple(bought_things(mechanism)), metal)


@lru_cache(maxsize=1)  # a machine's lists and its page ask for it one after the other
def _made_once(made: Assembly, bought: Sequence[Bought], metal: bool) -> Table:
    """The same of an assembly."""
    assembly = replace(made, bought=bought)
    copies, fixing = _standing(assembly)
    glued = with_gluing(order_of_assembly(assembly), copies, fixing, metal)
    cut = with_cutting(glued, assembly.parts, metal)
    reamed = with_reaming(cut, copies, fixing, metal)
    return with_sorting(reamed, assembly.parts, copies, fixing)


def steps_of_assembly(mechanism: Mechanism) -> Table:
    """In which order a machine goes together, with all that is bought for it, as a person at the bench takes it."""
    return at_bench(_work(mechanism))
