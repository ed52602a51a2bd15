"""A round tip that runs along the upper edge of a plate that slides: its motion, from the outline in a file alone.

The plate has gone by x along -x: in its frame the tip's slide, or its arm's axle, stands x further on. Of all straight edges
and corners that look up each stops the tip at one place; the highest stops it first.

    slide, edge     the tip's centre is R off the edge's line, its foot between both ends
    slide, corner   y = y_c + sqrt(R^2 - (x - x_c)^2)
    arm             n . (A + a exp(i psi)) = R from the edge: psi = arg n - acos(..), and of a corner by the triangle with its axle;
                    to the right of the axle alone, as the arm comes down from upright
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from camgen.geometry.rings import Ring
from camgen.numerics import Floats, Points

_ROWS = 64  # places that are looked at together


@dataclass(frozen=True)
class Tip:
    """A round tip: radius; rest, its centre at s = 0, from the axle `pivot` of its arm, or on a slide along y; mm."""

    radius: float
    rest: complex
    pivot: complex | None = None


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
    found = [
        np.fmax.reduce(find(tip, starts, sides, corners, x[k : k + _ROWS, None]), axis=1)
        for k in range(0, len(x), _ROWS)
    ]
    return np.concatenate(found)


def _of_slide(tip: Tip, starts: Points, sides: Points, corners: Points, x: Floats) -> Floats:
    """s of a slide by each that may stop it, (n, candidates)."""
    across = x + tip.rest.real
    normal = -1j * sides / np.abs(sides)
    foot = (across - tip.radius * normal.real - starts.real) / sides.real
    high = starts.imag + foot * sides.imag + tip.radius * normal.imag
    high = np.where((foot >= 0) & (foot <= 1), high, np.nan)
    with np.errstate(invalid="ignore"):
        tops = corners.imag + np.sqrt(tip.radius**2 - (across - corners.real) ** 2)
    return np.concatenate([high, tops], axis=1) - tip.rest.imag


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
