"""Outlines of wheels and the like from their textbook formulas, for tests alone: a route of its own beside the product's makers."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from camgen.geometry.rings import Floats, Points, Ring

ALPHA = math.radians(20)


def inv(angle: float | Floats) -> float | Floats:
    """Involute function."""
    return np.tan(angle) - angle


def through(points: Points) -> tuple[Points, Floats]:
    """Three-point arcs through points 0, 1, 2; 2, 3, 4; ...: first points and bulges, the last point left out."""
    first, via, last = points[:-2:2], points[1:-1:2], points[2::2]
    return first, np.tan(np.angle((last - via) / (via - first)) / 2)


def chords(points: Points) -> tuple[Points, Floats]:
    """Straight edges, the last point left out."""
    return points[:-1], np.zeros(len(points) - 1)


def closed(pieces: list[tuple[Points, Floats]]) -> Ring:
    """Pieces end to end."""
    return Ring(
        np.concatenate([points for points, _ in pieces]),
        np.concatenate([bulges for _, bulges in pieces]),
    )


@dataclass(frozen=True)
class Wheel:
    """An involute wheel cut by a rack: module, teeth, shift, thinning at the reference circle (mm), tip shortening, cutter's tip radius."""

    m: float
    z: int
    x: float = 0.0
    thin: float = 0.04
    short: float = 0.0
    rho: float = 0.38
    ha: float = 1.0
    c: float = 0.25

    @property
    def r(self) -> float:
        """Reference circle."""
        return self.m * self.z / 2

    @property
    def rb(self) -> float:
        """Base circle."""
        return self.r * math.cos(ALPHA)

    @property
    def ra(self) -> float:
        """Tip circle."""
        return self.r + self.m * (self.ha + self.x - self.short)

    def half_angle(self, radius: float | Floats) -> float | Floats:
        """Of the tooth at a radius."""
        at_reference = (
            math.pi / (2 * self.z)
            + 2 * self.x * math.tan(ALPHA) / self.z
            - self.thin / (2 * self.r)
        )
        ratio = np.minimum(self.rb / np.asarray(radius), 1.0)
        return at_reference + inv(ALPHA) - inv(np.arccos(ratio))

    def trochoid(self, u: float | Floats) -> Points:
        """What the cutter's tip leaves, the space's middle on Oy."""
        h0 = self.m * (self.ha + self.c - self.rho - self.x)
        centre = self.xi + np.asarray(u) + 1j * (self.r - h0)
        away = centre - 1j * self.r
        return (centre + self.rho * self.m * away / np.abs(away)) * np.exp(1j * u / self.r)

    @property
    def xi(self) -> float:
        """Half of the flat of the cutter's tip."""
        return (
            math.pi * self.m / 4
            + self.thin / 2
            - self.m * (self.ha + self.c - self.rho) * math.tan(ALPHA)
            - self.rho * self.m / math.cos(ALPHA)
        )

    def involute(self, radius: Floats) -> Points:
        """The flank beside the space whose middle is on Oy."""
        return radius * np.exp(1j * (math.pi / 2 - math.pi / self.z + self.half_angle(radius)))

    @property
    def end_of_root(self) -> tuple[float, float]:
        """Parameter of the trochoid and radius where it meets the involute."""
        h0 = self.m * (self.ha + self.c - self.rho - self.x)
        last = h0 / math.tan(ALPHA) - self.xi
        y = h0 + self.rho * self.m * math.sin(ALPHA)
        if y <= self.r * math.sin(ALPHA) ** 2:
            away = self.r * math.sin(ALPHA) - y / math.sin(ALPHA)
            return last, math.hypot(self.rb, away)

        def beside(u: float) -> float:
            p = complex(self.trochoid(u))
            return float(np.angle(p) - np.angle(self.involute(np.array(abs(p)))))

        u = np.linspace(-self.xi, last, 4001)
        p = self.trochoid(u)
        off = np.angle(p) - np.angle(self.involute(np.abs(p)))
        crossing = np.flatnonzero((off[:-1] * off[1:] < 0) & (np.abs(p[1:]) > self.rb))
        found = brentq(beside, u[crossing[0]], u[crossing[0] + 1], xtol=1e-14)
        return found, abs(complex(self.trochoid(found)))

    def ring(self, per_flank: int = 8, arcs: bool = True, root: int = 4) -> Ring:
        """The outline, ccw, a tooth's middle on Ox: so many arcs or chords on each flank."""
        end, form = self.end_of_root
        k = 2 if arcs else 1
        piece = through if arcs else chords
        u = np.linspace(-self.xi, end, k * root + 1)
        roll = np.linspace(
            math.sqrt(max(form**2 - self.rb**2, 0)),
            math.sqrt(self.ra**2 - self.rb**2),
            k * per_flank + 1,
        )
        flank = np.concatenate([self.trochoid(u)[:-1], self.involute(np.hypot(self.rb, roll))])
        # middle of the space on Oy; of the tooth clockwise of it
        flank = flank * np.exp(-1j * (math.pi / 2 - math.pi / self.z))
        # ccw: up the mirrored flank, over the tip, down this one, along the root
        down = flank[::-1]
        up = np.conj(flank)
        tip = np.angle(down[0] / up[-1])
        bottom = 2 * math.pi / self.z - np.angle(down[-1] / up[0])
        parts = []
        tooth = [
            piece(up),
            (up[-1:], np.array([math.tan(tip / 4)])),
            piece(down),
            (down[-1:], np.array([math.tan(bottom / 4)])),
        ]
        for n in range(self.z):
            turn = np.exp(2j * math.pi * n / self.z)
            parts += [(turn * points, bulges) for points, bulges in tooth]
        return closed(parts)


def inner_ring(space: Wheel, tip: float, root: float, per_flank: int = 8) -> Ring:
    """Contour of an inner gear whose spaces are the teeth of a wheel, from its tip radius out to its root, mm; ccw."""
    roll = np.linspace(
        math.sqrt(tip**2 - space.rb**2), math.sqrt(root**2 - space.rb**2), 2 * per_flank + 1
    )
    radius = np.hypot(space.rb, roll)
    up = radius * np.exp(-1j * space.half_angle(radius))
    down = np.conj(up)[::-1]
    top = np.array([math.tan(np.angle(down[0] / up[-1]) / 4)])
    bottom = np.array([math.tan((math.tau / space.z - np.angle(down[-1] / up[0])) / 4)])
    tooth = [through(up), (up[-1:], top), through(down), (down[-1:], bottom)]
    turns = np.exp(1j * math.tau * np.arange(space.z) / space.z)
    return closed([(turn * points, bulges) for turn in turns for points, bulges in tooth])


def centre_distance(first: Wheel, second: Wheel) -> tuple[float, float]:
    """Distance without backlash of unthinned wheels, mm, and working pressure angle, rad."""
    total = first.z + second.z
    target = inv(ALPHA) + 2 * math.tan(ALPHA) * (first.x + second.x) / total
    angle = brentq(lambda a: inv(a) - target, 1e-3, 1.0, xtol=1e-15)
    return first.m * total / 2 * math.cos(ALPHA) / math.cos(angle), angle
