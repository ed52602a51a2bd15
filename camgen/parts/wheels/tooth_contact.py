"""How a tooth of a driver pushes one of a wheel: by its flank, and before and after that past the corners of both.

    x, y        angles of the tooth of the driver and of the one of the wheel, rad, up from the line of both axes
    w           place on the wheel, rad, up from that line: -radius exp(-i w) from its axis

At first the corner of the wheel's tooth slides on the flank of the driver's, then both flanks mesh, and at last the driver's corner
slides on the wheel's flank and round its tip. Where a corner z, seen from a flank's axis, touches it:
arg z + inv(arccos(base / |z|)) is the flank's angle.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from camgen.geometry.outlines import Floats, Points
from camgen.parts.wheels.involute import Wheel

_NEWTON = 40  # steps at most
_HAIR = 1e-24  # least square of a slope: there neither formula counts


@dataclass(frozen=True)
class Tip:
    """Of a tooth on Ox on its left: the middle of its rounding."""

    reach: float  # from the axis, mm
    half: float  # angle, rad
    rounding: float  # radius, mm; 0: a corner


@dataclass(frozen=True)
class ToothContact:
    """A tooth of each wheel, of standard height but for the driver's tip."""

    driver: Wheel
    wheel: Wheel
    distance: float  # of the axes, mm
    free: float  # air of a flank, mm

    @property
    def pressure(self) -> float:
        """Angle of the line on which flanks touch, rad."""
        return self.wheel.rack.pressure

    @property
    def ratio(self) -> float:
        """Angle of the wheel over the driver's while flanks mesh."""
        return self.driver.teeth / self.wheel.teeth

    # ---- along the line on which flanks touch, mm from the pitch point

    @property
    def base_pitch(self) -> float:
        """From flank to flank, mm."""
        return self.driver.pitch * self.driver.base

    def foot(self, wheel: Wheel) -> float:
        """From the pitch point to where the line touches a wheel's base circle, mm."""
        return wheel.base * math.tan(self.pressure)

    def recess(self, wheel: Wheel) -> float:
        """Where a tooth of the driver lets go, mm."""
        return wheel.tangent(wheel.tip) - self.foot(wheel)

    @property
    def approach(self) -> float:
        """From where the wheel's tips are touched to the pitch point, mm."""
        return self.wheel.tangent(self.wheel.tip) - self.foot(self.wheel)

    def seen(self, wheel: Wheel, beyond: float) -> float:
        """Least radius at which a wheel is touched by tips that reach so far beyond the pitch point, mm."""
        return math.hypot(wheel.base, self.foot(wheel) - beyond)

    # ---- the law of a pair of teeth

    def corner(self, w: Any, order: int) -> Points:
        """Of the wheel's tip circle the place w, or a derivative, order 0..3, complex mm from the driver's axis."""
        spoke = -self.wheel.tip * np.exp(-1j * np.asarray(w, float)) * (-1j) ** order
        return np.asarray(spoke + self.distance if order == 0 else spoke)

    def mesh(self, x: Floats) -> Floats:
        """y while both flanks touch."""
        return np.asarray(self.ratio * x + self.wheel.pitch / 2)

    @cached_property
    def meets(self) -> float:
        """y from which on both flanks touch."""
        wheel = self.wheel
        return self.pressure - math.acos(wheel.base / wheel.tip) + wheel.half_top

    def before(self, y: Any, order: int = 0) -> Floats:
        """x while the corner of the wheel's tooth slides on the driver's flank, or a derivative to y."""
        w = np.asarray(y, float) - self.wheel.half_top
        spots = [self.corner(w, k) for k in range(order + 1)]
        base = self.driver.base
        angle = _angle(spots, _on_flank(spots[0], base))
        # of a tooth that is wider by the air
        return angle - (self.driver.half_angle(base) + self.free / base) if order == 0 else angle

    def lets_go(self, tip: Tip) -> float:
        """x up to which both flanks touch."""
        driver = self.driver
        reached = driver.tangent(tip.reach) + tip.rounding
        radius = math.hypot(driver.base, reached)
        return math.acos(driver.base / radius) - self.pressure - driver.half_angle(radius)

    def after(self, tip: Tip, x: Any, order: int = 0) -> Floats:
        """y while the corner of a tooth of the driver slides on the wheel's flank, then round its tip, or a derivative to x."""
        own = self.wheel
        end = self.passes(tip)
        far = self.free + tip.rounding
        within = np.minimum(np.asarray(x, float), end)
        place = -tip.reach * np.exp(1j * (within + tip.half))
        spots = [place * 1j**k + (self.distance if k == 0 else 0) for k in range(order + 1)]
        radius = np.abs(spots[0])
        flat = radius <= math.hypot(own.base, own.tangent(own.tip) + far)
        flank = -_angle(spots, _on_flank(spots[0], own.base))
        round_tip = -_angle(spots, _round_corner(radius, own.tip, far))
        if order == 0:
            flank = flank + own.half_angle(own.base) + far / own.base
            round_tip = round_tip + own.half_top
        found = np.where(flat, flank, round_tip)
        return found if order == 0 else np.where(np.asarray(x) > end, 0.0, found)

    def passes(self, tip: Tip) -> float:
        """x at which a tooth of the driver has left that of the wheel behind: both corners lie on one line from its axis."""
        own = self.wheel
        reach = tip.reach + tip.rounding + self.free
        beside = self.distance**2 + reach**2 - own.tip**2
        return math.acos(beside / (2 * self.distance * reach)) - tip.half

    def entered(self, x: Floats, low: float) -> Floats:
        """y of a tooth that is met at y = low, at x; where both flanks touch what meets."""
        high = self.meets
        if low >= high:
            return np.full(x.shape, high)
        ends = float(self.before(low)), float(self.before(high))
        wanted = np.clip(x, *ends)
        y = low + (high - low) * (wanted - ends[0]) / (ends[1] - ends[0])
        for _ in range(_NEWTON):
            step = (self.before(y) - wanted) / self.before(y, 1)
            y = np.clip(y - step, low, high)
            if np.max(np.abs(step), initial=0.0) < 1e-15:
                break
        return np.where(x >= ends[1], high, y)

    def entering(self, y: Floats, order: int) -> Floats:
        """Derivatives of y to x from those of x to y."""
        first = self.before(y, 1)
        if order == 1:
            return np.asarray(1 / first)
        second = self.before(y, 2)
        if order == 2:
            return np.asarray(-second / first**3)
        return np.asarray((3 * second**2 - first * self.before(y, 3)) / first**5)


Slopes = tuple[Floats, Floats, Floats, Floats]


def _on_flank(z: Points, base: float) -> Slopes:
    """inv(arccos(base / |z|)) and its derivatives to log |z|, rad."""
    t = np.sqrt(np.maximum((np.abs(z) / base) ** 2 - 1, _HAIR))
    bend = (1 + t**2) / t
    return t - np.arctan(t), t, bend, (1 - 1 / t**2) * bend


def _round_corner(radius: Floats, tip: float, free: float) -> Slopes:
    """Less the angle between two points at a radius and at the tip's that are `free` apart, and derivatives to log radius, rad."""
    cosine = np.clip((tip**2 + radius**2 - free**2) / (2 * tip * radius), -1.0, 1.0)
    rate = (radius**2 - tip**2 + free**2) / (2 * tip * radius)
    sine = np.sqrt(np.maximum(1 - cosine**2, _HAIR))
    second = cosine / sine + cosine * rate**2 / sine**3
    third = rate / sine + (3 * cosine**2 * rate + rate**3) / sine**3
    third = third + 3 * cosine**2 * rate**3 / sine**5
    return -np.arccos(cosine), rate / sine, second, third


def _angle(spots: Sequence[Points], added: Slopes) -> Floats:
    """Of the last order of `spots`, a point and its derivatives, arg z + added(log |z|), or its derivative, order 0..3."""
    z = spots[0]
    order = len(spots) - 1
    if order == 0:
        return np.asarray(np.angle(z) + added[0])
    first = spots[1] / z
    if order == 1:
        return np.asarray(first.imag + added[1] * first.real)
    second = spots[2] / z - first**2
    if order == 2:
        return np.asarray(second.imag + added[2] * first.real**2 + added[1] * second.real)
    third = spots[3] / z - first * spots[2] / z - 2 * first * second
    way = added[3] * first.real**3 + 3 * added[2] * first.real * second.real
    return np.asarray(third.imag + way + added[1] * third.real)
