"""Counterweights on a shaft: a hub and a sector of a disc that stands out of it, of one material or with steel pins pressed in.

moment    density x thickness x 2/3 (R^3 - r^3) sin(half) of the sector between hub r and rim R, half its angle on each
          side of its middle line: first moment about the shaft, g mm
rim       R, from that in closed form; pins along the rim move with it, so that with them R is found by halving
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

from camgen.errors import DesignError
from camgen.geometry.outlines import Arc, Contour, Line, circle
from camgen.numerics import halved
from camgen.parts.catalogue import TURNED
from camgen.parts.hardware import plate
from camgen.parts.part import Layer, Part, rod

NAME = "counterweight"
_LEAST = 1.0  # mm, by which a sector stands out of its hub: a lighter one is narrower instead


@dataclass(frozen=True)
class Sector:
    """A counterweight's shape: a sector, with pins of steel where it has them."""

    hub: float  # radius, mm
    thickness: float  # mm
    half: float  # of its angle, rad
    heavy: float  # density, g/mm^3
    pins: int = 0
    pin: float = 0.0  # diameter, mm
    press: float = 0.0  # by how much a pin's hole is wider, mm
    steel: float = 0.0  # density, g/mm^3
    wall: float = 0.0  # round the pins, mm

    def places(self, rim: float) -> list[complex]:
        """The pins of a sector along +x, as near to the rim as the wall allows, side by side, mm."""
        at = rim - self.wall - (self.pin + self.press) / 2
        if not self.pins or at <= 0:
            return []
        step = 2 * math.asin(min(1.0, (self.pin + self.press + self.wall) / (2 * at)))
        return [cmath.rect(at, (k - (self.pins - 1) / 2) * step) for k in range(self.pins)]

    @property
    def least(self) -> float:
        """The smallest rim whose sector holds its pins, mm."""
        room = self.wall + (self.pin + self.press) / 2
        low = self.hub + 2 * room
        high = self.hub + 2 * room + (self.pins + 2) * 2 * room
        if not self.pins:
            return self.hub

        def fits(rim: float) -> bool:
            last = self.places(rim)[-1]
            rest = self.half - cmath.phase(last)
            return rest >= 0 and (rest >= math.pi / 2 or abs(last) * math.sin(rest) >= room)

        while not fits(high):
            high *= 2
        return halved(fits, low, high)

    def moment(self, rim: float) -> float:
        """Of the sector without its hub, pins in it, about the shaft, g mm."""
        whole = self.heavy * self.thickness * 2 / 3 * (rim**3 - self.hub**3) * math.sin(self.half)
        each = (
            self.thickness
            * math.pi
            / 4
            * (self.steel * self.pin**2 - self.heavy * (self.pin + self.press) ** 2)
        )
        return whole + each * sum(place.real for place in self.places(rim))

    def rim(self, moment: float) -> float:
        """The radius that has a moment, g mm; DesignError where its pins alone are more."""
        if not self.pins:
            return math.cbrt(
                self.hub**3 + 3 * moment / (2 * self.heavy * self.thickness * math.sin(self.half))
            )
        low = self.least
        if self.moment(low) > moment:
            raise DesignError(
                "moment of the counterweight's pins",
                self.moment(low),
                moment,
                "g mm",
                NAME,
                "ask for fewer or thinner pins (counterweight.pins, counterweight.pin_diameter), or for a thinner counterweight",
            )
        high = 2 * low
        while self.moment(high) < moment:
            high *= 2
        return halved(lambda rim: self.moment(rim) >= moment, low, high)


def outline(hub: float, rim: float, half: float) -> Contour:
    """Edge of a hub about the origin with a sector along +x; a sector that hardly stands out is left away."""
    if rim - hub < 1e-6:
        return circle(0j, hub)
    a = cmath.exp(-1j * half)
    b = cmath.exp(1j * half)
    return Contour(
        (
            Arc(0j, rim, -half, 2 * half),
            Line(rim * b, hub * b),
            Arc(0j, hub, half, math.tau - 2 * half),
            Line(hub * a, rim * a),
        )
    )


def counterweight(
    sector: Sector, bore: Contour, moment: complex, made: str, min_wall: float, note: str
) -> tuple[Part, list[tuple[Part, complex]], float]:
    """A counterweight on a shaft through the origin, its pins with their places, and its radius, mm.

    bore: of the hub, in the axes of `moment`, complex g mm: what the sector is to have. made: as of a part; note: how it is
    held. A sector that would stand out by less than 1 mm is made narrower and stands out by that.
    """
    size = abs(moment)
    turn = moment / abs(moment) if moment else 1.0 + 0j
    rim = sector.rim(size)
    half = sector.half
    if not sector.pins and rim < sector.hub + _LEAST:
        rim = sector.hub + _LEAST
        half = math.asin(min(1.0, size / sector.moment(rim) * math.sin(half)))
    edge = outline(sector.hub, rim if half > 1e-6 else sector.hub, half).moved(turn)
    holes: Mapping[str, Contour] = {
        "bore": bore,
        **{
            f"pin {k}": circle(z * turn, (sector.pin + sector.press) / 2)
            for k, z in enumerate(sector.places(rim), 1)
        },
    }
    moment_note = f"{size:.4g} g mm at {math.degrees(cmath.phase(turn)):.4g} deg about the shaft, hub and bore left out"
    part = Part(
        NAME,
        "Counterweight",
        (Layer(plate(NAME, edge, holes, min_wall), 0.0, sector.thickness),),
        centres=(0j,),
        notes=(note, moment_note),
        min_wall=min_wall,
        process=made,
        role="counterweight",
    )
    places = [z * turn for z in sector.places(rim)]
    if not places:
        return part, [], rim
    pin = replace(
        rod(f"{NAME}-pin", "Pin of the counterweight", sector.pin, sector.thickness),
        count=sector.pins,
        notes=("pressed and glued in",),
        process=TURNED,
        role="counterweight",
    )
    return part, [(pin, z) for z in places], rim
