"""Moments of inertia of parts, from their exact outlines."""

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


def _polar(contour: Contour) -> float:
    """Second moment of the area inside a counter-clockwise contour about the origin, mm^4 (Green's theorem)."""
    z = facet_contour(contour, 0.01)
    w = np.roll(z, -1)
    dot = np.abs(z) ** 2 + np.abs(w) ** 2 + np.real(np.conj(z) * w)
    return float(np.sum(np.imag(np.conj(z) * w) * dot)) / 12
