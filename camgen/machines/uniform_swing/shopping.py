"""What is bought for the machine round a uniform-swing cam, and in which order all of it goes together."""

from __future__ import annotations

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
        found.append(Bought("screw of the base", plate.mount.standard, size, len(plate.mounts)))
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
        ),
        nut("nut of the nozzle", screw.thread, 2),
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


def steps(machine: SwingMachine) -> Table:
    """In which order the machine goes together: from the base up, each part laid on from above, one operation a step."""
    m = machine
    sizes = machine.sizes
    things = {each.name: each for each in bought(machine)}
    motor = ", ".join(each.text for each in things.values() if each.role.startswith("drive"))
    nuts = things["nut of the nozzle"].text
    # height, part as its files name it, how, what of the parts is laid
    layers: list[tuple[float, str, str, tuple[str, ...]]] = [
        (
            m.low,
            "cam",
            f"put the cam on the motor's shaft, arrow up, {m.low - sizes.base.thickness:.3g} mm over the base",
            ("cam-1",),
        )
    ]
    if m.cam_pin_length:
        layers.append((m.low, "cam-pin", "press each cam-pin into a hole of the cam", ("cam-pin",)))
    layers.append(
        (m.foot, "frame", "press and glue the frame on both axles, as drawn", ("frame-1",))
    )
    if sizes.seat:
        layers.append((m.foot, "dowel pin of the tip", _TIP, ()))
    if sizes.frame.bearing:
        layers.append((m.foot, "bearing of the tip", _BEARING, ()))
    layers.append(
        (
            m.foot,
            "nut of the nozzle",
            f"lay {nuts} in the pockets of the frame{'' if sizes.pair else ', below'}",
            (),
        )
    )
    top = m.foot
    if sizes.pair:
        top = m.foot + m.thickness
        layers.append(
            (
                top,
                "frame, second copy",
                "put the second frame on the first, turned over about the line of the axles",
                ("frame-2",),
            )
        )
        if sizes.seat:
            layers.append((top, "dowel pin of the tip", _TIP, ()))
        if sizes.frame.bearing:
            layers.append((top, "bearing of the tip", _BEARING, ()))
        if sizes.making.pin_diameter:
            layers.append(
                (
                    top,
                    "frame-pin",
                    "press each frame-pin into the holes of both frames",
                    ("frame-pin",),
                )
            )
        second = m.top - m.thickness
        layers += [
            (second, "cam-spacer", "put cam-spacer on the first cam and its pins", ("cam-spacer",)),
            (
                second,
                "cam, second copy",
                "put the second cam on the pins, turned over about Oy: its arrow down",
                ("cam-2",),
            ),
        ]
    said = "the frame" if not sizes.pair else "both frames"
    flush = (
        f"press {said} on until the axles end flush, which leaves them {m.play:g} mm of end float"
    )
    layers.append((top + 1e-3, "frame" if not sizes.pair else "both frames", flush, ()))
    rows: list[tuple[str, str, tuple[str, ...]]] = [
        ("base", f"screw the base on the motor, heads in the pockets: {motor}", ("base",)),
        (
            "axle",
            "push 2 × axle from below, one through the hole, one through the arc slot; a tape holds both",
            ("axle",),
        ),
        ("axle-washer", "put an axle-washer on each axle", ("axle-washer",)),
    ]
    if m.base_plate.mounts:
        free = f"{sizes.frame.flange_thickness + m.play:g} mm free below for the axles"
        screws = things["screw of the base"].text
        said = f"screw the base on your stand with {screws}, {free}, before the frames cover the screws"
        rows.append(("base", said, ("stand-rail",)))
    rows += [(what, how, laid) for _, what, how, laid in sorted(layers, key=lambda each: each[0])]
    if sizes.plain:
        rows += [
            ("collet", "glue the collet on the upper cam", ("collet",)),
            (
                "clamp-ring",
                "push the clamp-ring over the collet, wide end first, until it is home",
                ("clamp-ring",),
            ),
        ]
    rows.append(
        (
            "nozzle-foot",
            f"screw your nozzle on the frames with {things['screw of the nozzle'].text} from above into the nuts",
            ("nozzle-foot",),
        )
    )
    return Table(
        "Assembly, step by step",
        ("step", "part", "how"),
        [(k, what, how) for k, (what, how, _) in enumerate(rows, 1)],
        [Step([Doing(how)], laid, 1 if "axle" in laid else -1) for _, how, laid in rows],
    )
