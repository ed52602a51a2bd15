"""What is bought for the machine round a uniform-swing cam, and in which order all of it goes together."""

from __future__ import annotations

from camgen.findings import Finding, Where, at_least
from camgen.machines.uniform_swing.printed import SwingMachine
from camgen.parts.catalogue import DOWEL_STANDARD, SCREWS, Bought, fixed_motor, nut
from camgen.study import Step, Table

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
    """In which order the machine goes together: from the base up, each part laid on from above."""
    m = machine
    sizes = machine.sizes
    tip = "; dowel pin pressed in, flush with the side away from the cam" if sizes.seat else ""
    tip += ", the bearing glued on it at half the cam's height" if sizes.frame.bearing else ""
    nuts = "nozzle's nuts in their pockets" + ("" if sizes.pair else " below")
    flush = f"pressed on until the axles end flush, which leaves them {m.play:g} mm of end float"
    cam = f"on the shaft, arrow up, {m.low - sizes.base.thickness:.3g} mm over the base"
    cam += "; its pins" if m.cam_pin_length else ""
    frame = f"as drawn, pressed and glued on both axles{tip}; {nuts}"
    # height, what, how, what of the parts is laid
    layers: list[tuple[float, str, str, tuple[str, ...]]] = [
        (m.low, "cam", cam, ("cam-1", "cam-pin")),
        (m.foot, "frame plate", frame, ("frame-1",)),
    ]
    if sizes.pair:
        over = "turned over about the line of the axles"
        over += "; its pins" if sizes.making.pin_diameter else ""
        second = "on the first cam and its pins, turned over about Oy, arrow down"
        layers += [
            (
                m.foot + m.thickness,
                "second frame plate",
                f"{over}; {flush}",
                ("frame-2", "frame-pin"),
            ),
            (m.top - m.thickness, "spacer, second cam", second, ("cam-spacer", "cam-2")),
        ]
    else:
        layers.append((m.foot + 1e-3, "axles", flush, ()))
    rows = [
        ("base, motor", "motor below, its screws' heads in the pockets", ("base",)),
        (
            "axles, washers",
            "from below, held by a tape, one through the hole, one through the arc slot; a washer on each",
            ("axle", "axle-washer"),
        ),
    ]
    if m.base_plate.mounts:
        free = f"{sizes.frame.flange_thickness + m.play:g} mm free below for the axles"
        said = f"on your stand, {free}, before the frames cover the screws"
        rows.append(("base", said, ("stand-rail",)))
    rows += [(what, how, laid) for _, what, how, laid in sorted(layers)]
    if sizes.plain:
        ring = "collet glued on the upper cam; ring over it, wide end first, pushed home"
        rows.append(("collet, clamp ring", ring, ("collet", "clamp-ring")))
    rows.append(
        ("nozzle", "yours, on the frames, its screws from above into the nuts", ("nozzle-foot",))
    )
    return Table(
        "Assembly, step by step",
        ("step", "what", "how"),
        [(k, what, how) for k, (what, how, _) in enumerate(rows, 1)],
        [Step(f"{what}: {how}", laid, 1 if "axle" in laid else -1) for what, how, laid in rows],
    )
