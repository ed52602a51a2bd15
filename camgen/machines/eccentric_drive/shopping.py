"""What is bought for an eccentric drive."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from camgen.parts.catalogue import SCREWS, Bought, fastener, nut, turning_text

if TYPE_CHECKING:
    from camgen.machines.eccentric_drive.mechanism import EccentricDrive


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
        Bought("screw for mounting", SCREWS[p.screw].standard, f"{p.screw} x {p.body_thickness:g} and what carries it", 4),
        Bought("needle's wire", "", f"steel, diameter {p.wire_diameter:g}{straight}", 1),
        Bought("supply", "", "USB, 5 V, 1 A or more: a charger or a power bank", 1),
        Bought("switch", "", "rocker switch, round, 20 mm", 1),
    )
