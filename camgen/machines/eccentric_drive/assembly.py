"""An eccentric drive put together: its plate, where every part stands, how joints are measured, what is bought."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from camgen.geometry.outlines import circle, rectangle
from camgen.machine.features import Eye, Faces, Feature, Mount, PinEyes, SlideFaces
from camgen.machine.model import GROUND
from camgen.parts.catalogue import SCREWS, Bought, fastener, nut, turning_text
from camgen.parts.hardware import plate
from camgen.parts.part import Held, Layer, Part, hull

if TYPE_CHECKING:
    from camgen.machines.eccentric_drive.mechanism import EccentricDrive


def body_plate(drive: EccentricDrive) -> Part:
    """Plate with the motor's seat at the origin, the two rails of the guide, and a mounting hole in every corner."""
    g, p, slide, screw = drive.geometry, drive.making, drive.print.slide_clearance, drive.screw
    start, end, middle = drive.rail
    seat, corner = (
        (drive.motor.boss_diameter + drive.print.press_clearance) / 2,
        max(screw.head / 2 + 1, drive.rim),
    )
    beside, outside = drive.motor_screw + drive.rim, middle + p.rail_width / 2 + 2 * corner
    top, bottom = max(g.offset + outside, beside), min(g.offset - outside, -beside)
    left = -drive.motor.diameter / 2 - 2 * corner
    reach = end if drive.tube is None else drive.tube.mouth
    mounts = [
        complex(x, y)
        for x in (left + corner, reach - corner)
        for y in (bottom + corner, top - corner)
    ]
    cover = [complex(end - p.cover_length / 2, g.offset + side * middle) for side in (-1, 1)]
    motor = [side * 1j * drive.motor_screw for side in (-1, 1)]
    tube = [] if drive.tube is None else list(drive.tube.screws)
    screws = [*cover, *motor, *mounts, *tube]
    kinds = ("cover", cover), ("motor", motor), ("mounting", mounts), ("tube", tube)
    names = [
        f"screw {k} of the {kind}" for kind, places in kinds for k in range(1, len(places) + 1)
    ]
    holes = {"motor's seat": circle(0j, seat)}
    holes |= {name: circle(z, screw.clearance / 2) for name, z in zip(names, screws, strict=True)}
    holes |= {} if drive.tube is None else {"window": drive.tube.window}
    region = plate("body", hull([(z, corner) for z in mounts]), holes, drive.allowed.min_wall)
    layers = [Layer(region, 0.0, p.body_thickness)]
    height = p.body_thickness + p.slider_thickness + slide
    for side, place in zip((-1, 1), cover, strict=True):
        y0, y1 = sorted(g.offset + side * (middle + s * p.rail_width / 2) for s in (-1, 1))
        bar, hole = (
            rectangle(complex(start, y0), complex(end, y1)),
            {"screw": circle(place, screw.clearance / 2)},
        )
        rail = plate("rail", bar, hole, drive.allowed.min_wall)
        layers.append(Layer(rail, p.body_thickness, height))
    return Part(
        "body",
        "Body plate with guide",
        tuple(layers),
        centres=(0j, *screws),
        notes=(
            Held(
                "the motor's collar sits in the hole at the origin, from below; two long screws draw it and the motor bar on"
            ),
            "the corners' holes are for mounting",
        ),
        min_wall=drive.allowed.min_wall,
    )


def features_of(drive: EccentricDrive) -> Sequence[Feature]:
    """The shaft in disc and body, the disc in the strap, the pin in rod and slider, the slider on its guide."""
    g, p, slide, press = (
        drive.geometry,
        drive.making,
        drive.print.slide_clearance,
        drive.print.press_clearance,
    )
    boss = drive.motor.boss_diameter
    return (
        # the motor is the pin: its collar in the body, its shaft in the disc, and the mean of both counts twice
        PinEyes(
            "O",
            Eye("disc", 0j, drive.bore),
            Eye("body", 0j, boss + press),
            Eye(None, 0j, (g.shaft_diameter + boss) / 2, shaft=True),
        ),
        PinEyes(
            "E",
            Eye("disc", complex(g.eccentricity), g.eccentric_diameter, shaft=True),
            Eye("rod", 0j, g.eccentric_diameter + slide),
        ),
        PinEyes(
            "P",
            Eye("rod", complex(g.rod), p.pin_diameter + slide),
            Eye("slider", 0j, p.pin_diameter + press),
            Eye("pin", 0j, p.pin_diameter, shaft=True),
        ),
        SlideFaces(
            "guide",
            Faces("body", 1j * g.offset, 0.0, p.slider_width + slide, drawn=False),
            Faces("slider", 0j, 0.0, p.slider_width),
        ),
    )


def mounts_of(drive: EccentricDrive) -> Sequence[Mount]:
    """Every part on its body."""
    p, slide, bed = drive.making, drive.print.slide_clearance, drive.making.body_thickness
    low, top = bed + p.slider_thickness + slide, bed + p.slider_thickness + 2 * slide
    cover = complex(drive.rail[1] - p.cover_length / 2, drive.geometry.offset)
    return (
        Mount("disc", "disc", z=top - p.flange),
        Mount("washer", "disc", z=top + p.rod_thickness + slide),
        Mount("rod", "rod", z=top),
        Mount("slider", "slider", z=bed),
        Mount("pin", "slider", flipped=True, z=bed),
        Mount("clamp", "slider", drive.head[2].real, z=bed + p.slider_thickness),
        Mount("cover", GROUND, cover, z=low),
        Mount("body", GROUND),
        Mount("motor-bar", GROUND, z=-drive.motor.length - bed),
    )


def bought(drive: EccentricDrive) -> Sequence[Bought]:
    """Motor, screws, nuts and the needle's wire."""
    g, p, m, slide = drive.geometry, drive.making, drive.motor, drive.print.slide_clearance
    through = (
        ("screw of the cover", p.body_thickness + p.slider_thickness + slide + p.rod_thickness),
        ("screw of the motor", 2 * p.body_thickness + m.length),
        ("screw of the wire clamp", p.slider_thickness + p.rod_thickness),
    )
    straight = "" if drive.tube is None else f", straight over {drive.tube.wire:.4g}"
    motor = (
        f"{turning_text(m.speed_rpm)}, shaft {g.shaft_diameter:g} x {drive.shaft_length:g} over its face, "
        f"collar {m.boss_diameter:g}, can {m.diameter:g} x {m.length:g}"
    )
    return (
        Bought("motor", "", motor, 1),
        *(fastener(name, p.screw, reach, 2) for name, reach in through),
        *((drive.tube.bought(),) if drive.tube else ()),
        nut("nut", p.screw, 8 if drive.tube else 6),
        Bought(
            "screw for mounting",
            SCREWS[p.screw].standard,
            f"{p.screw} x {p.body_thickness:g} and what carries it",
            4,
        ),
        Bought("needle's wire", "", f"steel, diameter {p.wire_diameter:g}{straight}", 1),
        Bought("supply", "", "USB, 5 V, 1 A or more: a charger or a power bank", 1),
        Bought("switch", "", "rocker switch, round, 20 mm", 1),
    )
