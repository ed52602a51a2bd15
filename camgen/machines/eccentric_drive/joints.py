"""The eccentric drive as a machine: bodies and joints, and on what of its parts these are measured."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from camgen.geometry.outlines import Floats, Points
from camgen.machine.features import Eye, Faces, Feature, Mount, PinEyes, SlideFaces
from camgen.machine.model import GROUND, Body, Drive, Function, Machine, Output, Pin, Place, Pose, Slide

if TYPE_CHECKING:
    from camgen.machines.eccentric_drive.mechanism import EccentricDrive


def machine_of(drive: EccentricDrive) -> Machine:
    """Disc, rod and slider between shaft and guide."""
    g, slide, press = drive.geometry, drive.print.slide_clearance, drive.print.press_clearance
    at = {name: complex(jet[0, 0]) for name, jet in drive.linkage.solve(np.zeros(1), 0).items()}
    way = at["P"] - at["E"]
    return Machine(
        (Body("disc"), Body("rod"), Body("slider")),
        (
            Pin("O", Place("disc"), Place(GROUND), 2 * press),
            Pin("E", Place("disc", complex(g.eccentricity)), Place("rod"), slide),
            Pin("P", Place("rod", complex(g.rod)), Place("slider"), slide + press),
            Slide("guide", Place(GROUND, 1j * g.offset), Place("slider"), clearance=slide),
        ),
        (Drive("motor", "disc"),),
        {"disc": Pose(0j, 0.0), "rod": Pose(at["E"], math.atan2(way.imag, way.real)), "slider": Pose(at["P"], 0.0)},
        outputs=(Output("travel", Function((Place("slider"),), partial(_way, drive.outermost))),),
    )  # fmt: skip


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
    """Parts that make the joints."""
    return (Mount("body", GROUND), Mount("disc", "disc"), Mount("rod", "rod"), Mount("slider", "slider"))


def _way(outermost: float, place: Points) -> Floats:
    """Way from the outermost place towards the shaft, with its derivatives: jets (order + 1, n), mm."""
    way = -place.real
    way[0] += outermost
    return np.asarray(way)
