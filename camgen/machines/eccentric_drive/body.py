"""The body of an eccentric drive: the plate that carries motor, guide and the needle's tube."""

from __future__ import annotations

from typing import TYPE_CHECKING

from camgen.geometry.outlines import circle, rectangle
from camgen.parts.hardware import plate
from camgen.parts.part import Layer, Part, hull

if TYPE_CHECKING:
    from camgen.machines.eccentric_drive.mechanism import EccentricDrive


def body_plate(drive: EccentricDrive) -> Part:
    """Plate with the motor's seat at the origin, the two rails of the guide, and a mounting hole in every corner."""
    g, p, slide, screw = drive.geometry, drive.making, drive.print.slide_clearance, drive.screw
    start, end, middle = drive.rail
    seat, corner = (drive.motor.boss_diameter + drive.print.press_clearance) / 2, max(screw.head / 2 + 1, drive.rim)
    beside, outside = drive.motor_screw + drive.rim, middle + p.rail_width / 2 + 2 * corner
    top, bottom = max(g.offset + outside, beside), min(g.offset - outside, -beside)
    left = -drive.motor.diameter / 2 - 2 * corner
    reach = end if drive.tube is None else drive.tube.mouth
    mounts = [complex(x, y) for x in (left + corner, reach - corner) for y in (bottom + corner, top - corner)]
    cover = [complex(end - p.cover_length / 2, g.offset + side * middle) for side in (-1, 1)]
    motor = [side * 1j * drive.motor_screw for side in (-1, 1)]
    tube = [] if drive.tube is None else list(drive.tube.screws)
    screws = [*cover, *motor, *mounts, *tube]
    kinds = ("cover", cover), ("motor", motor), ("mounting", mounts), ("tube", tube)
    names = [f"screw {k} of the {kind}" for kind, places in kinds for k in range(1, len(places) + 1)]
    holes = {"motor's seat": circle(0j, seat)}
    holes |= {name: circle(z, screw.clearance / 2) for name, z in zip(names, screws, strict=True)}
    holes |= {} if drive.tube is None else {"window": drive.tube.window}
    region = plate("body", hull([(z, corner) for z in mounts]), holes, drive.allowed.min_wall)
    layers = [Layer(region, 0.0, p.body_thickness)]
    height = p.body_thickness + p.slider_thickness + slide
    for side, place in zip((-1, 1), cover, strict=True):
        y0, y1 = sorted(g.offset + side * (middle + s * p.rail_width / 2) for s in (-1, 1))
        bar, hole = rectangle(complex(start, y0), complex(end, y1)), {"screw": circle(place, screw.clearance / 2)}
        rail = plate("rail", bar, hole, drive.allowed.min_wall)
        layers.append(Layer(rail, p.body_thickness, height))
    return Part(
        "body", "Body plate with guide", tuple(layers), centres=(0j, *screws),
        notes=("the motor's collar sits in the hole at the origin, from below", "the corners' holes are for mounting"),
        min_wall=drive.allowed.min_wall,
    )  # fmt: skip
