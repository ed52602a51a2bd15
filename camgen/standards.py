"""Bought parts by their standard name: motor frames, screws, bearings, mm; and what printers are fed with.

Motor frames: NEMA ICS 16-2001 (metric values as in BOSL2, nema_steppers.scad; NEMA 8 as tabled at piclist.com/techref/io/
stepper/nemasizes.htm). Screw heads: ISO 7380-1 from M3, ISO 4762 below, where ISO 7380-1 has no size; clearance holes:
ISO 273, medium. Bearings: boundary dimensions of ISO 15.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Screw:
    """A metric screw: clearance hole, head diameter and height, mm, and the standard of its head."""

    thread: str
    clearance: float
    head: float
    height: float
    standard: str


@dataclass(frozen=True)
class Bearing:
    """A deep groove ball bearing: bore, outside diameter and width, mm."""

    name: str
    bore: float
    outside: float
    width: float


@dataclass(frozen=True)
class MotorFace:
    """Face of a motor about its shaft: centring boss (diameter, height), places of its screw holes, complex mm.

    half: half the body's width across, mm; shaft: usual diameter, 0 where the frame sets none.
    """

    name: str
    boss: float
    boss_height: float
    screws: tuple[complex, ...]
    screw: Screw
    half: float
    shaft: float


@dataclass(frozen=True)
class Bought:
    """A line of the parts list that is bought: what, by which standard, which size, how many."""

    name: str
    standard: str
    size: str
    count: int


# Density of printed plastics, g/cm^3. Source: the generic profiles of UltiMaker's fdm_materials
# (generic_pla.xml.fdm_material and its neighbours, element <density>).
DENSITY = {"PLA": 1.24, "PETG": 1.27, "ABS": 1.10, "ASA": 1.06, "nylon": 1.14, "PC": 1.19}

SCREWS = {
    screw.thread: screw
    for screw in (
        Screw("M2", 2.4, 3.8, 2.0, "ISO 4762"),
        Screw("M2.5", 2.9, 4.5, 2.5, "ISO 4762"),
        Screw("M3", 3.4, 5.7, 1.65, "ISO 7380-1"),
        Screw("M4", 4.5, 7.6, 2.2, "ISO 7380-1"),
        Screw("M5", 5.5, 9.5, 2.75, "ISO 7380-1"),
        Screw("M6", 6.6, 10.5, 3.3, "ISO 7380-1"),
    )
}

BEARINGS = {
    bearing.name: bearing
    for bearing in (
        Bearing("623", 3, 10, 4),
        Bearing("624", 4, 13, 5),
        Bearing("625", 5, 16, 5),
        Bearing("626", 6, 19, 6),
        Bearing("608", 8, 22, 7),
    )
}


def _square(name: str, side: float, spacing: float, boss: float, height: float, thread: str, shaft: float) -> MotorFace:
    half = spacing / 2
    corners = tuple(complex(x, y) for x, y in ((half, half), (-half, half), (-half, -half), (half, -half)))
    return MotorFace(name, boss, height, corners, SCREWS[thread], side / 2, shaft)


MOTOR_FACES = {
    face.name: face
    for face in (
        _square("nema-8", 20.3, 16.0, 15.0, 1.5, "M2", 4.0),
        _square("nema-11", 28.2, 23.0, 22.0, 2.0, "M2.5", 5.0),
        _square("nema-14", 35.2, 26.0, 22.0, 2.0, "M3", 5.0),
        _square("nema-17", 42.3, 31.0, 22.0, 2.0, "M3", 5.0),
        _square("nema-23", 57.0, 47.14, 38.1, 1.6, "M5", 6.35),
    )
}


def flange(boss: float, screw_circle: float, count: int, thread: str) -> MotorFace:
    """A plain round flange: `count` screws evenly on a circle (diameter, mm), the first on the x axis.

    The boss is taken to be as high as the plate allows, the body to end where the screws' heads do.
    """
    screw = SCREWS[thread]
    places = tuple(cmath.rect(screw_circle / 2, math.tau * k / count) for k in range(count))
    return MotorFace("flange", boss, 0.0, places, screw, screw_circle / 2 + screw.head / 2, 0.0)
