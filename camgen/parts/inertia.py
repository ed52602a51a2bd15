"""Moments of inertia and centres of parts, from their exact outlines."""

from __future__ import annotations

import numpy as np

from camgen.geometry.facets import facet_contour
from camgen.geometry.outlines import Contour
from camgen.parts.part import Part

MM = 1e-3


def inertia_of(part: Part, density: float) -> float:
    """Moment of inertia of a part about its origin's upright axis, kg m^2; density in kg/m^3. Engraving counts.

    By polygons that follow the outlines within 0.01 mm, so right to about 1e-3.
    """
    total = 0.0
    for sign, layers in ((1, part.layers), (-1, part.engraved)):
        for layer in layers:
            holes = sum(_polar(hole.counter_clockwise()) for hole in layer.region.holes)
            total += sign * (layer.z1 - layer.z0) * (_polar(layer.region.outer.counter_clockwise()) - holes)
    return total * density * MM**5


def centre_of(part: Part) -> complex:
    """Centre of a part's volume in the plane, complex mm in its frame; by the same polygons."""
    total, weight = 0j, 0.0
    for sign, layers in ((1, part.layers), (-1, part.engraved)):
        for layer in layers:
            for side, contour in ((1, layer.region.outer), *((-1, hole) for hole in layer.region.holes)):
                z = facet_contour(contour.counter_clockwise(), 0.01)
                w = np.roll(z, -1)
                cross = np.imag(np.conj(z) * w)
                share = sign * side * (layer.z1 - layer.z0)
                total += share * complex(np.sum(cross * (z + w))) / 6
                weight += share * float(np.sum(cross)) / 2
    return total / weight


def _polar(contour: Contour) -> float:
    """Second moment of the area inside a counter-clockwise contour about the origin, mm^4 (Green's theorem)."""
    z = facet_contour(contour, 0.01)
    w = np.roll(z, -1)
    dot = np.abs(z) ** 2 + np.abs(w) ** 2 + np.real(np.conj(z) * w)
    return float(np.sum(np.imag(np.conj(z) * w) * dot)) / 12
