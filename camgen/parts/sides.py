"""A machine of two sides: the far one is the mirror image of the near one in a plane over it, on the same shaft.

It has the same motion, so far ahead in phase. What is its own mirror image is the same part on both sides, as it lies or turned
over; of any other part the far side has the mirror image, which looks in the hand like the near one.
"""

from __future__ import annotations

import cmath
import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from camgen.geometry.outlines import Arc, Contour, Region, end_point, start_point
from camgen.machine.features import Eye, Faces, Feature, Flat, Mount, OwnTip, StandIn, mapped
from camgen.machine.joining import Module
from camgen.machine.model import Machine
from camgen.parts.assembly import (
    Assembly,
    FlatSeat,
    MotorSeat,
    Row,
    by_heights,
    coupled,
    depth_below,
    further_rows,
    hand_fits,
    joined,
    numbered,
    renamed,
    with_things,
)
from camgen.parts.catalogue import Bought
from camgen.parts.generator.plates import SECOND
from camgen.parts.generator.sizes import SIDE_SPACER, Parts
from camgen.parts.part import Layer, Part, SizeNote
from camgen.parts.standing import standing_copies
from camgen.parts.step_words import TWO_PART
from camgen.parts.steps import distances
from camgen.study import Doing, Later, Mate, Step, Table
from camgen.tolerances import SAME_POINT

PREFIX = "far"  # of the names of the far side
_GAUGE = 30.0  # mm, length of a gauge: through a plate and a web, and long enough to be held
_DIGITS = 6  # to which places count as one, mm


@dataclass(frozen=True)
class Mirror:
    """The plane between both sides, and the shaft that goes through it."""

    height: float  # over the near side's underside, mm
    shaft: str  # the part
    phase: float  # how far the far side is ahead, rad
    sizes: Parts  # of both sides

    @property
    def gap(self) -> float:
        """Between the second plates of both sides, mm."""
        return self.sizes.side_gap

    def mount(self, part: Part, mount: Mount) -> Mount:
        """Where the image of a copy stands."""
        z = round(2 * self.height - mount.z - part.thickness, 9)
        return replace(mount, z=z, flipped=mount.flipped is not _turns_over(part))

    def mate(self, mate: Mate) -> Mate:
        """The image of where something is glued."""
        x, y, z = mate.place
        return replace(mate, place=(x, y, 2 * self.height - z))

    def stand_in(self, thing: StandIn) -> StandIn:
        """The image of what is in the way."""
        twice = 2 * self.height
        discs = tuple((at, r, twice - high, twice - low) for at, r, low, high in thing.discs)
        bars = tuple((a, b, r, twice - high, twice - low) for a, b, r, low, high in thing.bars)
        return replace(thing, discs=discs, bars=bars)

    def through(self, near: Assembly, far: Assembly) -> Part:
        """The shaft of both sides in one piece, with the flat of either."""
        part = near.by_name[self.shaft]
        lengths = [
            self.height - next(mount.z for mount in side.mounts if mount.part == self.shaft)
            for side in (near, far)
        ]
        middle = round(lengths[0], 9)
        region = part.drawn.region
        turned = region.moved(cmath.exp(1j * self.phase))
        layers = (
            Layer(region, 0.0, middle),
            Layer(turned, middle, round(middle + lengths[1], 9)),
        )
        sense = "counter-clockwise" if self.phase > 0 else "clockwise"
        turn = f"{abs(math.degrees(self.phase)):.4g} deg {sense}, seen from the upper end"
        rod = self.sizes.rod(
            layers[1].z1, f"on its lower {middle:g}; on the rest it is turned by {turn}"
        )
        rod = tuple(_filed(note, part.name, math.degrees(self.phase)) for note in rod)
        notes = [note for note in part.notes if not isinstance(note, SizeNote)]
        if not rod:
            notes.append(f"its upper flat is turned by {turn}")
        return replace(part, title="Shaft of both sides", layers=layers, notes=(*rod, *notes))


def _filed(note: SizeNote, name: str, angle: float) -> SizeNote:
    """The note on a rod with two flats, with how a vice sets a quarter of a turn between these; angle: between them, deg."""
    if abs(abs(angle) - 90) > 0.01:
        return note
    jaw = "right" if angle > 0 else "left"
    how = (
        f"The flats of {name} set the phase of both sides. File the lower one until a printed part with its bore goes on. Then clamp "
        f"this half along a vice, its flat against the {jaw} jaw and the upper half, towards you, beside the jaws. File the other "
        "flat level on top, until such a part goes on there too. Some degrees more or less do no harm: one side then steps a little earlier"
    )
    return SizeNote(note, note.stock, note.length, how, note.fit)


def _turns_over(part: Part) -> bool:
    """Whether the image of a part is another part, or it turned over: not the same at all heights."""
    high = part.thickness
    there = {
        (round(high - each.z1, 9), round(high - each.z0, 9), each.region) for each in part.layers
    }
    here = {(round(each.z0, 9), round(each.z1, 9), each.region) for each in part.layers}
    return there != here or bool(part.engraved or part.edges) or not part.prismatic


def _image(part: Part) -> Part:
    """The part of which a copy turned over is the image of one of this part."""
    if not _turns_over(part):
        return part
    if not part.points and all(_mirrored(each.region) for each in (*part.layers, *part.engraved)):
        return part

    def over(layer: Layer) -> Layer:
        return replace(layer, region=layer.region.moved(-1, mirror=True))

    return replace(
        part,
        layers=tuple(map(over, part.layers)),
        engraved=tuple(map(over, part.engraved)),
        centres=tuple(map(_over, part.centres)),
        points=tuple((name, _over(z)) for name, z in part.points),
        side_profile=part.side_profile and part.side_profile.moved(-1, mirror=True),
        edges=tuple(each.mirrored for each in part.edges),
    )


def _over(z: complex) -> complex:
    """A place of a part, as seen when it is turned over."""
    return complex(-z.conjugate())


def _mirrored(region: Region) -> bool:
    """Whether a region is its own mirror image in Oy."""
    image = region.moved(-1, mirror=True)
    holes, others = ({_pieces(hole) for hole in each.holes} for each in (region, image))
    return _pieces(region.outer) == _pieces(image.outer) and holes == others


def _pieces(contour: Contour) -> frozenset[tuple[complex, ...]]:
    """Middle and ends of each piece, whichever way round; of a circle its centre and radius."""

    def rounded(z: complex) -> complex:
        return complex(round(z.real, _DIGITS) + 0.0, round(z.imag, _DIGITS) + 0.0)

    found = list[tuple[complex, ...]]()
    for piece in contour.pieces:
        if isinstance(piece, Arc) and abs(piece.sweep) > math.tau - 1e-9:
            found.append((rounded(piece.centre), rounded(complex(piece.radius))))
            continue
        ends = sorted(
            map(rounded, (start_point(piece), end_point(piece))), key=lambda z: (z.real, z.imag)
        )
        found.append((rounded(complex(piece.at((piece.t0 + piece.t1) / 2))), *ends))
    return frozenset(found)


def _features(features: Sequence[Feature], turned: frozenset[str]) -> list[Feature]:
    """Features as they are on the images of parts; turned: parts of which copies lie turned over."""

    def over(_: str, value: Any) -> Any:
        if isinstance(value, OwnTip):
            return mapped(value, over)
        if not isinstance(value, Eye | Faces | Flat) or value.part not in turned:
            return value
        if isinstance(value, Faces):
            return replace(value, at=_over(value.at), angle=math.pi - value.angle)
        if isinstance(value, Flat):
            return replace(value, at=_over(value.at), facing=math.pi - value.facing)
        return replace(value, at=_over(value.at))

    return [mapped(each, over) for each in features]


def both_sides(near: Assembly, far: Assembly, mirror: Mirror, machine: Machine) -> Assembly:
    """One machine of two sides.

    near: the one with what drives it; far: one like it, before it is reflected; machine: the model of both.
    """
    of_near = {mirror.shaft, SIDE_SPACER}
    further = [part for part in far.parts if part.name not in of_near]
    images = [_image(part) for part in further]
    of_both = {each.name for each in images if _same(each, near.by_name.get(each.name))}
    module = Module(PREFIX, phase=mirror.phase, shared=frozenset({*of_both, mirror.shaft}))
    turned = frozenset(part.name for part in further if _turns_over(part))
    mounts = [mount for mount in far.mounts if mount.part not in of_near]
    alone = renamed(replace(far, parts=further, mounts=mounts), module)
    things = [
        replace(each, name=thing.name)
        for each, thing in zip(alone.bought, far.bought, strict=True)
        if thing.role != "mount"
    ]
    own = [each for each in images if each.name not in of_both]
    features = renamed(replace(far, features=_features(far.features, turned)), module).features
    there = replace(
        alone,
        parts=[
            replace(each, name=module.part(each.name), title=f"{each.title}, far side")
            for each in own
        ],
        mounts=[module.mount(mirror.mount(far.by_name[mount.part], mount)) for mount in mounts],
        features=[each for each in features if each not in near.features],
        stand_ins=[mirror.stand_in(each) for each in alone.stand_ins],
        bought=(),
        unjudged=(),
    )
    through = mirror.through(near, far)
    taker = _taker(far, mirror.shaft)
    near = replace(
        near,
        parts=[through if part.name == mirror.shaft else part for part in near.parts],
        motor=_passing_on(near, mirror, taker, tuple(each.name for each in alone.machine.drives)),
    )
    copies = Counter(mount.part for mount in there.mounts)
    parts = [replace(part, count=part.count + copies[part.name]) for part in near.parts]
    whole = joined(replace(near, parts=parts), [there], machine)
    frame = far.frame and replace(far.frame, part=module.part(far.frame.part))
    far_side = replace(alone, bought=things, frame=frame)
    order = Later(lambda: [_order(near, far_side, mirror, taker)])
    return replace(whole, bought=_bought(near, far), board="", work=order)


def _passing_on(
    near: Assembly, mirror: Mirror, taker: tuple[str, str], drives: tuple[str, ...]
) -> MotorSeat:
    """The seat of the motor, with the bore in which the shaft of both sides turns the far one; drives: of that."""
    flats = near.motor.flats
    if not flats:
        return near.motor
    part, letter = taker
    sizes = mirror.sizes
    length = near.by_name[part].thickness
    further = FlatSeat(part, letter, sizes.shaft_diameter, sizes.shaft_flat, length, drives)
    return replace(near.motor, flats=(*flats, further))


def _same(part: Part, other: Part | None) -> bool:
    """Whether two parts differ in their number alone."""
    return other is not None and replace(part, count=other.count) == other


def _bought(near: Assembly, far: Assembly) -> list[Bought]:
    """What is bought for both sides: what drives is there once, and nothing holds a plate from behind."""
    counts: Counter[Bought] = Counter()
    for each in near.bought:
        counts[replace(each, count=0)] += each.count
    for each in far.bought:
        if each.role not in ("drive", "supply"):
            counts[replace(each, count=0)] += each.count
    return [replace(each, count=n) for each, n in counts.items() if each.role != "mount"]


def _taker(far: Assembly, shaft: str) -> tuple[str, str]:
    """In what of the far side the shaft of both sides is glued: part and hole."""
    copies = standing_copies(far.parts, far.mounts, far.poses(np.zeros(1)))
    outlines = [
        (held, each) for held in copies if held.part.name == shaft for each in held.outlines
    ]
    for copy in copies:
        for hole in copy.holes:
            for held, outline in outlines:
                how = far.process.fixing.how(hole, copy.part, outline, held.part)
                if hole.holds(outline) and how == "glue" and hole.name:
                    return copy.part.name, hole.name
    return "crank", ""


def _greased(step: Step) -> Step:
    """A spacer that no shaft holds, and that would slip where its side is turned over, stuck where it lies."""
    doings = [
        replace(
            each,
            rest=f"{each.rest}, stuck there with a dot of grease on its rim, none in its bore",
            needs=("grease",),
        )
        if step.small and each.verb == "put " and " over " in each.thing
        else each
        for each in step.doings
    ]
    return replace(step, doings=doings)


def _centred(step: Step, hole: tuple[str, str], far: Assembly, sizes: Parts) -> Step:
    """A step that glues a web on a crank pin, in which the shaft of both sides comes last: till then a gauge like that shaft, through
    the plate that is not on yet, holds its hole over the axis."""
    part, letter = hole
    comes = any(name.rpartition("-")[0] == part for name in step.copies)
    webbed = any(each.role == "crank-pin" for each in far.parts)
    plate = next((each.name for each in far.parts if each.name == SECOND), "")
    glued = any(mate.how == "glue" for mate in step.mates)
    if not (comes and webbed and plate and glued) or step.group:
        return step
    gauges = sizes.rod(_GAUGE, "all along")
    gauge = "the gauge" if gauges else "a spare shaft"
    doings = [
        Doing(
            f"lay {plate} on the pins, dry, and push {gauge} through its {letter} into {letter} of {part}"
        ),
        Doing(
            "leave both there until the glue is hard: then its axis is that of the shaft. Take both off again"
        ),
    ]
    return replace(step, doings=[*step.doings, *doings], gauges=gauges)


def _stopped(step: Step, far: Assembly) -> Step:
    """A step that glues a link on the shaft of a side, with where that stands in the pictures: nothing but links will hold it."""
    if not step.group or step.copies:
        return step
    copies = standing_copies(far.parts, far.mounts, far.poses(np.zeros(1)))
    axes = [copy.outlines[0].at for copy in copies if copy.part.role == "shaft"]
    glued = [complex(*mate.place[:2]) for mate in step.mates if mate.how == "glue"]
    if not any(abs(at - axis) < SAME_POINT for at in glued for axis in axes):
        return step
    driven = [hole for copy in copies if copy.part.name == step.group for hole in copy.holes]
    stands = f"turn {step.group} until it stands as the pictures show{distances(driven, copies)}"
    return step.also(f"{stands}. Whenever links have been moved, turn it back there")


def _fed(row: Row, far: Assembly, mirror: Mirror) -> Row:
    """A row of what is bought; of batteries, with what they take of their frame, which is up before the far side goes on."""
    cells, step = row
    shapes = []
    for mount in far.mounts:
        part = far.by_name[mount.part]
        if part.role == "battery-frame":
            stands = mirror.mount(part, mount)
            corners = [start_point(each) for each in part.drawn.region.holes[0].pieces]
            shapes.append(([*map(stands.place, corners)], stands.z, stands.z + part.thickness))
    if not shapes:
        return row
    doings = [
        Doing("turn it over: the frame is up"),
        Doing(
            f"stick the {cells[1]} on the plate in the frame with double-sided tape",
            needs=("double-sided tape",),
        ),
    ]
    return cells, Step(doings, apart=f"{PREFIX} side", shapes=shapes)


def _tried(
    mirror: Mirror, motor: MotorSeat, fed: bool, screwed: bool, where: tuple[str, str]
) -> Row:
    """The row of both sides that run on each other, dry; motor: what does it, fed: by batteries, where: on what the far side lies, and
    what takes the shaft."""
    on, taker = where
    run = "turn the shaft"
    if motor.frame:
        run = "connect the motor to its driver and let it run"
    elif motor.reach is not None:
        led = "lead the wires of the batteries past both plates and along a spacer, taped to it where no link comes, join them"
        run = f"{led if fed else 'hold the wires of a supply'} to the motor's and let it run"
    backwards = ". If it goes backwards, swap the motor's two wires" if fed else ""
    lower = "lower the far side" if fed else "turn the far side over and lower it"
    doings = [
        Doing(f"{lower} on the {on}, without {'screws or ' if screwed else ''}glue yet"),
        Doing(f"{mirror.shaft} goes into {taker}; turn the far crank until the flat fits"),
        Doing(
            f"{run}, slowly through the whole motion: no joint may be stiff{backwards}",
            needs=("connectors", "double-sided tape") if fed else (),
        ),
    ]
    cells = "Far side on the near one, dry", f"on {mirror.shaft}, its flat in line", 1, 0.0
    step = Step(doings, joins=f"{PREFIX} side")
    return (0, "both sides", *cells, "far side turned over"), step


def _glued(
    mirror: Mirror,
    metal: bool,
    screws: Sequence[Bought],
    where: tuple[str, str],
    hole: tuple[str, str],
) -> Row:
    """The row of both sides that are joined, by screws where there are some; where: as of `_tried`, hole: that takes the shaft."""
    on, taker = where
    _, letter = hole
    glue = "glue" if metal else TWO_PART
    through = f" through {letter} of its second plate, with a thin stick" if letter else ""
    through += ", a trace all round in the half away from that plate: the shaft pushes it onwards"
    clear = "put none on the shaft, in that plate or in a spacer between: the shaft turns in these"
    tools = {TWO_PART: glue == TWO_PART, "thin stick": bool(letter)}
    needs = tuple(each for each, used in tools.items() if used)
    doings = [
        Doing("lift the far side off, as soon as all moved freely in that trial"),
        Doing(f"put {glue} into ", taker, through, needs),
        Doing(clear),
    ]
    if screws:
        held = "screw it on the spacers through the far plate and its posts, tight crosswise"
        doings.append(Doing(f"lower it again, {mirror.shaft} into {taker}, and {held}"))
    else:
        both = f"{taker} on {mirror.shaft} and the far second plate on the {on}"
        doings += [Doing(f"put {glue} on the {on}"), Doing("lower it again: press ", both)]
    between = "spacers" if mirror.gap else "second plate"
    cells = (
        f"Second plate on {between}, {'screwed' if screws else 'glued'}: the shaft of both sides is glued into the far side",
        f"pressed and glued on {mirror.shaft}, its flat in line",
        1,
        0.0,
    )
    step = Step(doings, joins=f"{PREFIX} side", hand_fits=[hole])
    return (0, "both sides", *cells, "far side turned over"), step


def _order(near: Assembly, far: Assembly, mirror: Mirror, hole: tuple[str, str]) -> Table:
    """The near side from the bottom up, the far one likewise on its own plate, then one on the other, by the shaft of both.

    hole: of the far side, that takes the shaft: part and letter.
    """
    part, letter = hole
    taker = f"{letter} of the far {part}" if letter else f"the far {part}"
    before = Counter[str]()
    for mount in near.mounts:
        before[mount.part] += 1
    blocks = max(map(depth_below, (near, far)))  # the same ones, for steps that are done again
    by_hand = hand_fits(near) | hand_fits(far) | {hole}
    first = by_heights(near, None, blocks, by_hand)
    second = by_heights(far, before, blocks, by_hand)
    screws = [
        replace(each, at=())
        for each in far.bought
        if any(part.endswith(SIDE_SPACER) for part, _ in each.at)
    ]
    rows = [
        (tuple(row), step.also("set it back on its blocks") if row[1] == SIDE_SPACER else step)
        for row, step in zip(first.rows, first.steps, strict=True)
    ]
    for row, step in zip(second.rows, second.steps, strict=True):
        held = _stopped(_centred(_greased(step), hole, far, mirror.sizes), far)
        glued = [*map(mirror.mate, held.glued)]
        there = replace(held, apart=f"{PREFIX} side", up=(0.0, 0.0, -1.0), glued=glued)
        rows.append((tuple(row), there))
    on = "spacers" if mirror.gap else "second plate of the near side"
    further = [_fed(row, far, mirror) for row in further_rows(near)]
    fed = [row for row in further if row[1].shapes]
    rows += fed
    rows.append(_tried(mirror, near.motor, bool(fed), bool(screws), (on, taker)))
    joining = _glued(mirror, near.process.fixing.metal, screws, (on, taker), hole)
    cells, step = with_things(joining, [*screws, *coupled(near)])
    hard = "let nothing turn until the glue is hard, as long as its pack says: nothing parts both sides after that"
    rows.append((cells, step.also(hard)))
    rows += [row for row in further if not row[1].shapes]
    return numbered(replace(first, title="Assembly, side by side"), rows)
