"""Spur gears: pairs of whole teeth for a distance and a ratio, and involute outlines.

    module      pitch diameter over teeth, mm; addendum 1, dedendum 1.25 of it; pressure angle 20 deg
    backlash    along the pitch circle, mm: each tooth of a pair is thinner by half of it

[Norton, Design of Machinery, ch. 9]
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from typing import Any

import numpy as np

from camgen.errors import DesignError
from camgen.geometry.outlines import Arc, Contour, Line, Piece, Points, Smooth

PRESSURE = math.radians(20)
_ADDENDUM = 1.0
_DEDENDUM = 1.25
_LARGE = 2.0  # mm, module that is not passed where more teeth serve as well
_MOST = 400  # teeth of a wheel
_WHOLE = 1e-9  # of a ratio, that counts as one of whole numbers
_ROLL = 0.05  # rad, at which a flank begins: at the base circle itself its curvature has no bound


@dataclass(frozen=True)
class Spur:
    """One wheel: teeth, module and by how much each tooth is thinner at the pitch circle, mm. A tooth lies on Ox."""

    teeth: int
    module: float
    thinner: float

    @property
    def pitch(self) -> float:
        """Radius of the pitch circle, mm."""
        return self.module * self.teeth / 2

    @property
    def base(self) -> float:
        """Radius of the base circle, mm."""
        return self.pitch * math.cos(PRESSURE)

    @property
    def tip(self) -> float:
        """Radius of the tips, mm."""
        return self.pitch + _ADDENDUM * self.module

    @property
    def root(self) -> float:
        """Radius of the roots, mm."""
        return self.pitch - _DEDENDUM * self.module

    @property
    def thickness(self) -> float:
        """Of a tooth along the pitch circle, mm."""
        return math.pi * self.module / 2 - self.thinner

    def least_roll(self, mate: Spur) -> float:
        """Roll angle at which a mate's tips begin to touch, rad; below 0 they would cut into the flanks' feet."""
        way = (self.pitch + mate.pitch) * math.sin(PRESSURE)
        return (way - math.sqrt(mate.tip**2 - mate.base**2)) / self.base

    def outline(self) -> Contour:
        """The edge, counter-clockwise about the axis."""
        half = (
            self.thickness / 2 / self.pitch + math.tan(PRESSURE) - PRESSURE
        )  # of a tooth at the base circle
        foot = math.sqrt(max(self.root / self.base, 1.0) ** 2 - 1) if self.root > self.base else 0.0
        begin = max(foot, _ROLL)
        end = math.sqrt((self.tip / self.base) ** 2 - 1)
        half_angle = half - (begin - math.atan(begin))
        top = half - (end - math.atan(end))
        if top <= 0:
            raise DesignError(
                "tooth's tip", 2 * top * self.tip, 0, "mm", f"{self.teeth} teeth", "use more teeth"
            )
        pieces: list[Piece] = []
        rise, fall = (
            Smooth(partial(_flank, self.base, -side * half, side), begin, end) for side in (1, -1)
        )
        for k in range(self.teeth):
            middle = math.tau * k / self.teeth
            up = rise.moved(cmath.rect(1, middle))
            down = fall.moved(cmath.rect(1, middle)).reversed()
            low = complex(up.at(begin))
            high = complex(down.at(begin))
            feet = [self.root * z / abs(z) for z in (low, high)]
            if foot < begin:
                pieces.append(Line(feet[0], low))
            pieces += [up, Arc(0j, self.tip, middle - top, 2 * top), down]
            if foot < begin:
                pieces.append(Line(high, feet[1]))
            radius = self.root if foot < begin else abs(high)
            pieces.append(
                Arc(0j, radius, middle + half_angle, math.tau / self.teeth - 2 * half_angle)
            )
        return Contour(tuple(pieces))


def _flank(base: float, start: float, side: int, roll: Any, order: int) -> Points:
    """Involute that leaves its base circle at the polar angle `start`, to the left (side 1) or right; order 0..2."""
    t = np.asarray(roll, float)
    spoke = base * np.exp(1j * (start + side * t))
    return np.asarray((spoke * (1 - 1j * side * t), t * spoke, spoke * (1 + 1j * side * t))[order])


def pair(
    distance: float, ratio: float, backlash: float, least: float, teeth: int | None, where: str
) -> tuple[Spur, Spur]:
    """Two wheels that mesh outside: angle of b = ratio * angle of a, ratio below 0; distance of their axes, mm.

    least: module that can be made, mm; teeth: of a, None to find them. DesignError, with `where`, if there is no such pair.
    """
    fraction = Fraction(abs(ratio)).limit_denominator(_MOST)

    def refused(
        quantity: str, value: float, limit: float, unit: str, remedy: str, message: str = ""
    ) -> DesignError:
        error = DesignError(quantity, value, limit, unit, where, remedy)
        return error.saying(message) if message else error

    if ratio > 0:
        remedy = "put a link with a wheel between, and two gears, each with a ratio below 0"
        message = f"gear.ratio {ratio:g} at {where}: wheels side by side turn against each other, and no inner teeth are made"
        raise refused("ratio of wheels", ratio, 0, "", remedy, message)
    if abs(fraction - abs(ratio)) > _WHOLE * abs(ratio) or not fraction:
        fraction = (
            fraction if abs(ratio) < 1 else 1 / Fraction(1 / abs(ratio)).limit_denominator(_MOST)
        ) or Fraction(1, _MOST)
        remedy = f"take one of whole teeth, such as -{fraction.numerator}/{fraction.denominator} = {-float(fraction):.12g}"
        message = f"ratio {ratio:.12g} at {where} is none of wheels of at most {_MOST} teeth"
        raise refused("ratio", ratio, -float(fraction), "", remedy, message)
    if not distance > 0:
        raise refused(
            "distance of the axes",
            distance,
            0,
            "mm",
            "pin both links to the ground at different points",
        )
    parts = fraction.numerator + fraction.denominator
    if teeth is not None and teeth % fraction.numerator:
        remedy = f"take a multiple of {fraction.numerator}, so that the other wheel has whole ones"
        raise refused("teeth", teeth, fraction.numerator, "", remedy)
    counts = (
        [teeth // fraction.numerator]
        if teeth is not None
        else range(math.ceil(2 * distance / _LARGE / parts) or 1, _MOST)
    )
    module = 0.0
    for k in counts:
        module = 2 * distance / (k * parts)
        a, b = (
            Spur(k * each, module, backlash / 2)
            for each in (fraction.numerator, fraction.denominator)
        )
        if min(a.least_roll(b), b.least_roll(a)) >= _ROLL:
            break
        if teeth is not None:
            roll = math.degrees(min(a.least_roll(b), b.least_roll(a)))
            raise refused(
                "roll at which the tips begin to touch",
                roll,
                math.degrees(_ROLL),
                "deg",
                "use more teeth",
            )
    if module < least:
        raise refused(
            "module",
            module,
            least,
            "mm",
            "put the axes further apart, or take a ratio of smaller whole numbers",
        )
    return a, b
