"""What is bought for the machine round a uniform-swing cam, and in which order all of it goes together."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from camgen.findings import Finding, Where, at_least
from camgen.machines.uniform_swing.printed import SwingMachine
from camgen.parts.catalogue import DOWEL_STANDARD, SCREWS, Bought, fixed_motor, nut
from camgen.study import Doing, Step, Table

_TIP = "press the dowel pin of the tip into the frame, flush with the side away from the cam"
_BEARING = "glue the bearing of the tip on that pin at half the cam's height"
_ENGAGED = 0.8  # diameters of thread that hold a screw in metal


def screw_grip(machine: SwingMachine) -> Finding:
    """SCREW_GRIP: the motor's screws, of a length that is sold, hold by 0.8 diameters of thread or by a whole nut."""
    face = machine.sizes.base.face
    plate = machine.base_plate
    grip = plate.thickness - plate.pocket_depth
    screw = face.screw
    length = face.screw_length(grip)
    least = screw.nut if face.plain else _ENGAGED * screw.nominal
    held = length - grip - (face.depth if face.plain else 0.0)
    said = f"{screw.thread} x {length:g} through {grip:.4g} mm of the base; another base.thickness suits lengths that are sold"
    return at_least("SCREW_GRIP", held, least, "mm", Where("screws of the motor"), said)


def bought(machine: SwingMachine) -> tuple[Bought, ...]:
    """What is bought, by its standard."""
    sizes = machine.sizes
    plate = machine.base_plate
    face = sizes.base.face
    tip = sizes.frame.bearing
    copies = 2 if sizes.pair else 1
    grip = plate.thickness - plate.pocket_depth
    found = fixed_motor("motor", face, f"shaft {machine.shaft_size}", grip)
    if plate.mount:
        size = f"{plate.mount.thread}, {grip:.3g} mm longer than what it takes below the base"
        many = len(plate.mounts)
        held = Bought("screw of the base", plate.mount.standard, size, many, at=(("base", many),))
        found.append(replace(held, thread=plate.mount.thread))
    screw = SCREWS[sizes.nozzle.screw]
    most = machine.last - machine.foot
    least = machine.thickness + screw.nut / 2 if sizes.pair else most
    longer = f"{least:g} to {most:g}" if least < most else f"{most:g}"
    found += [
        Bought(
            "screw of the nozzle",
            screw.standard,
            f"{screw.thread}, {longer} mm longer than the nozzle's foot",
            2,
            at=(("nozzle-foot", 2),),
            thread=screw.thread,
        ),
        replace(nut("nut of the nozzle", screw.thread, 2), at=(("nozzle-foot", 2),)),
    ]
    if sizes.seat:
        found.append(
            Bought(
                "dowel pin of the tip",
                DOWEL_STANDARD,
                f"{sizes.seat:g} m6 x {machine.tip_pin:g}",
                copies,
            )
        )
    if tip:
        size = f"{tip.name}, {tip.size}"
        found.append(Bought("bearing of the tip", tip.standard, size, copies))
    return (*found, Bought("glue", "", "for all that is pressed", 1))


@dataclass(frozen=True)
class _Act:
    """One step."""

    part: str  # as its files name it
    how: str
    laid: tuple[str, ...] = ()  # what of the parts it lays
    height: float = 0.0  # mm, at which a layer is laid
    needs: tuple[str, ...] = ()  # tools


def steps(machine: SwingMachine) -> Table:
    """In which order the machine goes together: from the base up, each part laid on from above, one operation a step."""
    things = {each.name: each for each in bought(machine)}
    layers = [
        *_lower(machine, things["nut of the nozzle"].text),
        *(_second(machine) if machine.sizes.pair else ()),
        _flush(machine),
    ]
    screws = things["screw of the nozzle"].text
    acts = [
        *_ground(machine, things),
        *sorted(layers, key=lambda each: each.height),
        *(_COLLET if machine.sizes.plain else ()),
        _Act(
            "nozzle-foot",
            f"screw your nozzle on the frames with {screws} from above into the nuts",
            ("nozzle-foot",),
        ),
    ]
    return Table(
        "Assembly, step by step",
        ("step", "part", "how"),
        [(k, each.part, each.how) for k, each in enumerate(acts, 1)],
        [
            Step([Doing(each.how, needs=each.needs)], each.laid, 1 if "axle" in each.laid else -1)
            for each in acts
        ],
    )


_COLLET = (
    _Act("collet", "glue the collet on the upper cam", ("collet",)),
    _Act(
        "clamp-ring",
        "push the clamp-ring over the collet, wide end first, until it is home",
        ("clamp-ring",),
    ),
)


def _ground(machine: SwingMachine, things: Mapping[str, Bought]) -> Iterator[_Act]:
    """Base and axles, before all layers."""
    motor = ", ".join(each.text for each in things.values() if each.role.startswith("drive"))
    yield _Act("base", f"screw the base on the motor, heads in the pockets: {motor}", ("base",))
    yield _Act(
        "axle",
        "push 2 × axle from below, one through the hole, one through the arc slot; a tape holds both",
        ("axle",),
        needs=("adhesive tape",),
    )
    yield _Act("axle-washer", "put an axle-washer on each axle", ("axle-washer",))
    if machine.base_plate.mounts:
        free = (
            f"{machine.sizes.frame.flange_thickness + machine.play:g} mm free below for the axles"
        )
        screws = things["screw of the base"].text
        said = f"screw the base on your stand with {screws}, {free}, before the frames cover the screws"
        yield _Act("base", said, ("stand-rail",))


def _lower(machine: SwingMachine, nuts: str) -> Iterator[_Act]:
    """The first cam and the first frame with its tip; nuts: of the nozzle."""
    low = machine.low
    over = low - machine.sizes.base.thickness
    turned = f"put the cam on the motor's shaft, arrow up, {over:.3g} mm over the base"
    yield _Act("cam", turned, ("cam-1",), low)
    if machine.cam_pin_length:
        yield _Act("cam-pin", "press each cam-pin into a hole of the cam", ("cam-pin",), low)
    foot = machine.foot
    yield _Act("frame", "press and glue the frame on both axles, as drawn", ("frame-1",), foot)
    yield from _tip(machine, foot)
    below = "" if machine.sizes.pair else ", below"
    said = f"lay {nuts} in the pockets of the frame{below}"
    yield _Act("nut of the nozzle", said, (), foot)


def _tip(machine: SwingMachine, height: float) -> Iterator[_Act]:
    """The tip of the frame at a height, mm, where it is no part of the frame."""
    if machine.sizes.seat:
        yield _Act("dowel pin of the tip", _TIP, (), height)
    if machine.sizes.frame.bearing:
        yield _Act("bearing of the tip", _BEARING, (), height)


def _second(machine: SwingMachine) -> Iterator[_Act]:
    """The second frame and the second cam of a pair, turned over."""
    top = _top(machine)
    over = "put the second frame on the first, turned over about the line of the axles"
    yield _Act("frame, second copy", over, ("frame-2",), top)
    yield from _tip(machine, top)
    if machine.sizes.making.pin_diameter:
        pins = "press each frame-pin into the holes of both frames"
        yield _Act("frame-pin", pins, ("frame-pin",), top)
    cam = machine.top - machine.thickness
    spacer = "put cam-spacer on the first cam and its pins"
    yield _Act("cam-spacer", spacer, ("cam-spacer",), cam)
    over = "put the second cam on the pins, turned over about Oy: its arrow down"
    yield _Act("cam, second copy", over, ("cam-2",), cam)


def _top(machine: SwingMachine) -> float:
    """Height at which the last frame is laid, mm."""
    return machine.foot + machine.thickness if machine.sizes.pair else machine.foot


def _flush(machine: SwingMachine) -> _Act:
    """What sets the end float, once the last frame lies."""
    frames = "both frames" if machine.sizes.pair else "the frame"
    said = f"press {frames} on until the axles end flush, which leaves them {machine.play:g} mm of end float"
    return _Act(frames.removeprefix("the "), said, (), _top(machine) + 1e-3)
