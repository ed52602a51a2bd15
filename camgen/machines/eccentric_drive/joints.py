"""The eccentric drive as a machine: bodies and joints, and on what of its parts these are measured."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from camgen.machine.features import Eye, Faces, Feature, Mount, PinEyes, SlideFaces
from camgen.machine.model import GROUND

if TYPE_CHECKING:
    from camgen.machines.eccentric_drive.mechanism import EccentricDrive


def features_of(drive: EccentricDrive) -> Sequence[Feature]:
    """The shaft in disc and body, the disc in the strap, the pin in rod and slider, the slider on its guide."""
    g, p, slide, press = drive.geometry, drive.making, drive.print.slide_clearance, drive.print.press_clearance
    boss = drive.motor.boss_diameter
    return (
        # the motor is the pin: its collar in the body, its shaft in the disc, and the mean of both counts twice
        PinEyes(
            "O", Eye("disc", 0j, drive.bore), Eye("body", 0j, boss + press),
            Eye(None, 0j, (g.shaft_diameter + boss) / 2, shaft=True),
        ),
        PinEyes(
            "E", Eye("disc", complex(g.eccentricity), g.eccentric_diameter, shaft=True),
            Eye("rod", 0j, g.eccentric_diameter + slide),
        ),
        PinEyes(
            "P", Eye("rod", complex(g.rod), p.pin_diameter + slide), Eye("slider", 0j, p.pin_diameter + press),
            Eye("pin", 0j, p.pin_diameter, shaft=True),
        ),
        SlideFaces(
            "guide", Faces("body", 1j * g.offset, 0.0, p.slider_width + slide, drawn=False),
            Faces("slider", 0j, 0.0, p.slider_width),
        ),
    )  # fmt: skip


def mounts_of(drive: EccentricDrive) -> Sequence[Mount]:
    """Every part on its body."""
    p, slide, bed = drive.making, drive.print.slide_clearance, drive.making.body_thickness
    low, top = bed + p.slider_thickness + slide, bed + p.slider_thickness + 2 * slide
    cover = complex(drive.rail[1] - p.cover_length / 2, drive.geometry.offset)
    return (
        Mount("disc", "disc", z=top - p.flange), Mount("washer", "disc", z=top + p.rod_thickness + slide),
        Mount("rod", "rod", z=top), Mount("slider", "slider", z=bed), Mount("pin", "slider", flipped=True, z=bed),
        Mount("clamp", "slider", drive.head[2].real, z=bed + p.slider_thickness), Mount("cover", GROUND, cover, z=low),
        Mount("body", GROUND), Mount("motor-bar", GROUND, z=-drive.motor.length - bed),
    )  # fmt: skip
