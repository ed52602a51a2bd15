"""How stiff an arm is in its plane, from its outline: held at one point, pushed across at another.

    1 / k = integral of (l - x)^2 / (E I(x)) dx from the held point to the pushed one, l mm off
I(x): second moment of what material a cut across the line meets, about the middle of that material.
[Castigliano's theorem for a beam in bending; with I even F l^3 / (3 E I)]
"""

from __future__ import annotations

import cmath
import math
from typing import Any

import numpy as np

from camgen.geometry.facets import facet_contour
from camgen.parts.part import Part

_CUTS = 200  # along the arm
_FACETS = 0.02  # mm


def bending_stiffness(part: Part, root: complex, tip: complex, modulus: float) -> float:
    """N/mm at `tip`, across the line from `root`, mm in the part's frame; modulus: Young's, MPa.

    0 where a cut meets nothing.
    """
    import shapely

    length = abs(tip - root)
    turn = cmath.exp(-1j * cmath.phase(tip - root))
    shapes: list[tuple[float, Any]] = []
    for layer in part.layers:
        rings = [
            (facet_contour(contour, _FACETS) - root) * turn
            for contour in (layer.region.outer, *layer.region.holes)
        ]
        outer, *holes = ([(z.real, z.imag) for z in ring] for ring in rings)
        shapes.append((layer.z1 - layer.z0, shapely.Polygon(outer, holes)))
    x = (np.arange(_CUTS) + 0.5) * length / _CUTS
    reach = max(max(abs(value) for value in shape.bounds) for _, shape in shapes)
    cuts = [
        [(high, *piece) for high, shape in shapes for piece in _pieces(shape, float(place), reach)]
        for place in x
    ]
    if not all(cuts):
        return 0.0
    moments = np.array([_second_moment(cut) for cut in cuts])
    return float(1 / np.sum((length - x) ** 2 / (modulus * moments) * length / _CUTS))


def _pieces(shape: Any, x: float, reach: float) -> list[tuple[float, float]]:
    """From where to where a cut at x meets material, mm."""
    import shapely

    chord = shape.intersection(shapely.LineString([(x, -reach - 1), (x, reach + 1)]))
    return [
        (each.bounds[1], each.bounds[3]) for each in shapely.get_parts(chord) if each.length > 0
    ]


def _second_moment(pieces: list[tuple[float, float, float]]) -> float:
    """Of rectangles (thickness, from, to) about their common middle, mm^4."""
    areas = [high * (b - a) for high, a, b in pieces]
    middle = math.fsum(
        area * (a + b) / 2 for area, (_, a, b) in zip(areas, pieces, strict=True)
    ) / math.fsum(areas)
    middles = (
        high * (b - a) ** 3 / 12 + area * ((a + b) / 2 - middle) ** 2
        for area, (high, a, b) in zip(areas, pieces, strict=True)
    )
    return math.fsum(middles)
