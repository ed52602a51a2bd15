"""A round tip that runs along the upper edge of a plate that slides: its motion, from the outline in a file alone.

The plate has gone by x along -x: in its frame the tip's slide, or its arm's axle, stands x further on. Of all straight edges
and corners that look up each stops the tip at one place; the highest stops it first.

    slide, edge     n . (A + s d) = R from the edge's line, its foot between both ends; d: the slide's direction
    slide, corner   |A + s d - corner| = R, the further one along d
    arm             n . (A + a exp(i psi)) = R from the edge: psi = arg n - acos(..), and of a corner by the triangle with its axle;
                    to the right of the axle alone, as the arm comes down from upright
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from camgen.geometry.rings import Ring
from camgen.numerics import Floats, Points

_ROWS = 64  # places that are looked at together
_SPARE = 1e-6  # mm, more than rounding, by which what lies near is taken


@dataclass(frozen=True)
class Tip:
    """A round tip: radius; rest, its centre at s = 0, from the axle `pivot` of its arm, or on a slide along y; mm."""

    radius: float
    rest: complex
    pivot: complex | None = None
    along: complex = 1j  # unit vector of a slide, upwards


@dataclass(frozen=True)
class GroundTip:
    """A round tip as it stands on the ground over a plate that goes along `travel`; start: its centre on a slide, or its axle.

    way: of a slide a unit vector, of an arm the tip's centre from the axle, mm; leaves: the sense of s that takes it off.
    """

    radius: float
    start: complex
    way: complex
    swings: bool
    leaves: int
    travel: complex

    @property
    def senses(self) -> tuple[int, int]:
        """Of x along -travel, and of y to the left of that."""
        axis = -self.travel
        off = self.leaves * self.way * (1j if self.swings else 1) / axis
        right = (self.way / axis).real if self.swings else 1.0
        return (1 if right > 0 else -1), (1 if off.imag > 0 else -1)

    def seen(self, z: Points) -> Points:
        """Places of the ground, or of the plate as it lies at x = 0, in the frame of `run`."""
        across, up = self.senses
        local = np.asarray(z / -self.travel)
        return np.asarray(across * local.real + 1j * up * local.imag)

    def run(self, ring: Ring, x: Floats, chord: float) -> Floats:
        """s at each place of the plate along travel, (n,) mm or rad; see `run`. ring: the plate's at x = 0 on the ground."""
        across, up = self.senses
        points = self.seen(ring.points)
        local = replace(ring, points=points, bulges=across * up * ring.bulges)
        start, way = self.seen(np.array([self.start, self.way]))
        if self.swings:
            tip = Tip(self.radius, complex(way), complex(start))
        else:
            tip = Tip(self.radius, complex(start), along=self.leaves * complex(way))
        return self.leaves * run(local, tip, across * np.asarray(x, float), chord)

    def pressure_angle(self, s: Floats, slope: Floats) -> Floats:
        """Angle between the contact's normal and the tip's way, rad, (n,), 0 or more; slope: ds/dx, mm or rad for a mm."""
        way = self.way * (1j * np.exp(1j * s) if self.swings else np.ones(np.shape(s)))
        normal = 1j * (way * slope - self.travel)
        off = np.angle(way * np.conj(normal))
        return np.asarray(np.minimum(np.abs(off), math.pi - np.abs(off)))


def pressure_angle(tip: Tip, s: Floats, slope: Floats) -> Floats:
    """Angle between the contact's normal and the tip's way, rad, (n,), 0 or more; s: mm or rad, slope: ds/dx.

    The normal is square to the way of the tip's centre over the plate, 1 + v ds/dx, v the centre's velocity for 1 of s.
    """
    way = np.full(len(s), 1j)
    if tip.pivot is not None:
        way = 1j * tip.rest * np.exp(1j * s)
    normal = 1j * (1 + way * slope)
    return np.asarray(np.abs(np.angle(way * np.conj(normal))))


def run(ring: Ring, tip: Tip, x: Floats, chord: float) -> Floats:
    """Where a tip that comes to the outline from above stands at each place of the way, (n,) mm: s, mm or rad, (n,).

    chord: by which chords may lie off the outline's arcs, mm. nan where nothing stops it.
    """
    points = ring.counter_clockwise().facetted(chord)
    onward = np.roll(points, -1) - points
    up = onward.real < 0  # material is on the left, so what looks up runs to the left
    starts = points[up]
    sides = onward[up]
    corners = np.unique(np.concatenate([starts, starts + sides]))
    find = _of_slide if tip.pivot is None else _of_arm
    middles = starts + sides / 2
    halves = np.abs(sides) / 2
    found = []
    for k in range(0, len(x), _ROWS):
        rows = x[k : k + _ROWS]
        place = (rows.min() + rows.max()) / 2
        reach = tip.radius + np.ptp(rows) / 2 + _SPARE
        near = _from_way(tip, middles - place) <= reach + halves
        some = corners[_from_way(tip, corners - place) <= reach]
        stops = find(tip, starts[near], sides[near], some, rows[:, None])
        found.append(np.fmax.reduce(stops, axis=1, initial=np.nan))
    return np.concatenate(found)


def _from_way(tip: Tip, points: Points) -> Floats:
    """Distance of points from the way of the tip's centre, mm: a circle about its axle, or its slide's line."""
    if tip.pivot is None:
        return np.asarray(np.abs(((points - tip.rest) * np.conj(tip.along)).imag))
    return np.asarray(np.abs(np.abs(points - tip.pivot) - abs(tip.rest)))


def _of_slide(tip: Tip, starts: Points, sides: Points, corners: Points, x: Floats) -> Floats:
    """s of a slide by each that may stop it, (n, candidates)."""
    rest = x + tip.rest
    lengths = np.abs(sides)
    normal = -1j * sides / lengths
    rises = (tip.along * np.conj(normal)).real
    with np.errstate(divide="ignore", invalid="ignore"):
        s = (tip.radius - ((rest - starts) * np.conj(normal)).real) / rises
    foot = ((rest + s * tip.along - starts) * np.conj(sides)).real / lengths**2
    s = np.where((foot >= 0) & (foot <= 1) & (rises > 0), s, np.nan)
    spoke = (corners - rest) * np.conj(tip.along)
    with np.errstate(invalid="ignore"):
        tops = spoke.real + np.sqrt(tip.radius**2 - spoke.imag**2)
    return np.concatenate([s, tops], axis=1)


def _of_arm(tip: Tip, starts: Points, sides: Points, corners: Points, x: Floats) -> Floats:
    """s of an arm that points to the right by each that may stop it, (n, candidates)."""
    assert tip.pivot is not None
    arm = abs(tip.rest)
    axle = x + tip.pivot
    normal = -1j * sides / np.abs(sides)
    off = np.real(np.conj(normal) * (axle - starts))
    with np.errstate(invalid="ignore"):
        psi = np.angle(normal) - np.arccos((tip.radius - off) / arm)
    centre = axle + arm * np.exp(1j * psi)
    foot = np.real(np.conj(sides) * (centre - starts)) / np.abs(sides) ** 2
    psi = np.where((foot >= 0) & (foot <= 1), psi, np.nan)
    spoke = corners - axle
    far = np.abs(spoke)
    with np.errstate(invalid="ignore"):
        opening = np.arccos((far**2 + arm**2 - tip.radius**2) / (2 * far * arm))
    psi = np.concatenate([psi, np.angle(spoke) + opening], axis=1)
    return np.where(np.abs(psi) <= math.pi / 2, psi, np.nan) - np.angle(tip.rest)
