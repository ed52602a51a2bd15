"""What is bought for the machine round a uniform-swing cam, and in which order all of it goes together."""

from __future__ import annotations

from camgen.findings import Finding, Where, at_least
from camgen.machines.uniform_swing.printed import SwingMachine
from camgen.parts.catalogue import DOWEL_STANDARD, SCREWS, Bought, nut
from camgen.study import Table

_ENGAGED = 0.8  # diameters of thread that hold a screw in metal


def screw_grip(machine: SwingMachine) -> Finding:
    """SCREW_GRIP: the motor's screws, of a length that is sold, hold by 0.8 diameters of thread or by a whole nut."""
    face, plate = machine.sizes.base.face, machine.base_plate
    grip, screw = plate.thickness - plate.pocket_depth, face.screw
    length, least = face.screw_length(grip), screw.nut if face.plain else _ENGAGED * screw.nominal
    held = length - grip - (face.depth if face.plain else 0.0)
    said = f"{screw.thread} x {length:g} through {grip:.4g} mm of the base; another base.thickness suits lengths that are sold"
    return at_least("SCREW_GRIP", held, least, "mm", Where("screws of the motor"), said)


def bought(machine: SwingMachine) -> tuple[Bought, ...]:
    """What is bought, by its standard."""
    sizes, plate = machine.sizes, machine.base_plate
    face, tip = sizes.base.face, sizes.frame.bearing
    nema, copies = face.name != "flange", 2 if sizes.pair else 1
    name = f"{face.name.upper().replace('-', ' ')} frame" if nema else "with a plain flange"
    grip = plate.thickness - plate.pocket_depth
    length = face.screw_length(grip)
    into = f"{face.screw.thread} x {length:g}, " + (
        "with a nut" if face.plain else f"{length - grip:.3g} mm of it in the motor"
    )
    found = [
        Bought("motor", face.standard, f"{name}, shaft {machine.shaft_size}", 1, "drive"),
        Bought("screw of the motor", face.screw.standard, into, len(face.screws)),
    ]
    if face.plain:
        found.append(nut("nut of the motor", face.screw.thread, len(face.screws)))
    if plate.mount:
        size = f"{plate.mount.thread}, {grip:.3g} mm longer than what it takes below the base"
        found.append(Bought("screw of the base", plate.mount.standard, size, len(plate.mounts)))
    screw, most = SCREWS[sizes.nozzle.screw], machine.last - machine.foot
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
        size = f"{tip.name}, {tip.bore:g} x {tip.outside:g} x {tip.width:g}"
        found.append(Bought("bearing of the tip", tip.standard, size, copies))
    return (*found, Bought("glue", "", "for all that is pressed", 1))


_LAID = {  # what is made for each step
    "base, motor": ("base",),
    "axles, washers": ("axle", "axle-washer"),
    "cam": ("cam-1", "cam-pin"),
    "frame plate": ("frame-1",),
    "second frame plate": ("frame-2", "frame-pin"),
    "spacer, second cam": ("cam-spacer", "cam-2"),
    "collet, clamp ring": ("collet", "clamp-ring"),
}


def steps(machine: SwingMachine) -> Table:
    """In which order the machine goes together: from the base up, each part laid on from above."""
    m, sizes = machine, machine.sizes
    tip = "; dowel pin pressed in, flush with the side away from the cam" if sizes.seat else ""
    tip += ", the bearing glued on it at half the cam's height" if sizes.frame.bearing else ""
    nuts = "nozzle's nuts in their pockets" + ("" if sizes.pair else " below")
    flush = f"pressed on until the axles end flush, which leaves them {m.play:g} mm of end float"
    over = f"{m.low - sizes.base.thickness:.3g} mm over the base"
    layers = [
        (m.low, "cam", f"on the shaft, arrow up, {over}{'; its pins' if m.cam_pin_length else ''}"),
        (m.foot, "frame plate", f"as drawn, pressed and glued on both axles{tip}; {nuts}"),
    ]
    if sizes.pair:
        pinned = "; its pins" if sizes.making.pin_diameter else ""
        layers += [
            (
                m.foot + m.thickness,
                "second frame plate",
                f"turned over about the line of the axles{pinned}; {flush}",
            ),
            (
                m.top - m.thickness,
                "spacer, second cam",
                "on the first cam and its pins, turned over about Oy, arrow down",
            ),
        ]
    else:
        layers.append((m.foot + 1e-3, "axles", flush))
    rows = [
        ("base, motor", "motor below, its screws' heads in the pockets"),
        (
            "axles, washers",
            "from below, held by a tape, one through the hole, one through the arc slot; a washer on each",
        ),
        *((what, how) for _, what, how in sorted(layers, key=lambda layer: layer[0])),
    ]
    if m.base_plate.mounts:
        below = sizes.frame.flange_thickness + m.play
        rows.insert(
            2,
            (
                "base",
                f"on its stand, {below:g} mm free below for the axles, before the frames cover the screws",
            ),
        )
    if sizes.plain:
        rows.append(
            (
                "collet, clamp ring",
                "collet glued on the upper cam; ring over it, wide end first, pushed home",
            )
        )
    rows.append(("nozzle", "on the frames, its screws from above into the nuts"))
    numbered = [(k, *row) for k, row in enumerate(rows, 1)]
    return Table(
        "Assembly, step by step",
        ("step", "what", "how"),
        numbered,
        [_LAID.get(what, ()) for what, _ in rows],
    )
