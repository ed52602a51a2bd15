"""Print fits: outlines moved along their normals by what the printer adds or takes, exactly, so that the motion is kept.

    offset        exact parallel contour: lines and arcs stay lines and arcs, smooth pieces get their parallel curve
    compensation  what the machine does to a part, as plain numbers
    compensated   the part to send to the machine, whose print is the part that was asked for

A contour is run so that the side it moves towards lies on its right. There a joint that turns left opens and is filled by
an arc about the joint; one that turns right closes, and `trimming` cuts the loop at the exact crossing.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from camgen.errors import DesignError
from camgen.geometry.distances import thinnest_wall
from camgen.geometry.facets import facet_contour
from camgen.geometry.outlines import (
    Arc,
    Contour,
    Floats,
    Line,
    Piece,
    Points,
    Region,
    Smooth,
    end_point,
    start_point,
)
from camgen.geometry.trimming import trim
from camgen.numerics import coordinates
from camgen.parts.part import Layer, Part
from camgen.tolerances import SAME_POINT

_CHECK = 1e-5  # of the outline's size: chord tolerance at which the result is compared with a polygon's offset
_SLOPE_STEP = (
    1e-5  # of a piece's parameter, half the step over which the slope of its curvature is taken
)
_TURN = 1e-9  # rad, a joint that turns by less is smooth


@dataclass(frozen=True)
class Compensation:
    """What the printer does, and is to be undone: lengths in mm."""

    hole: float = 0.0  # how far every hole's wall comes inwards (holes print small)
    profile: float = 0.0  # how far the outer wall comes outwards
    shrinkage: float = (
        0.0  # share by which the plastic shrinks in the plane, about the part's datum
    )
    # height and width of the chamfer that takes up the swelling of the first layers (elephant's foot); 0: none
    foot: float = 0.0
    layer: float = 0.2  # steps of that chamfer

    def foot_of(self, part: Part) -> float:
        """Height of a part's chamfer, mm: at most half of its lowest layer."""
        low = min(part.layers, key=lambda layer: (layer.z0, layer.z1))
        return min(self.foot, (low.z1 - low.z0) / 2)


# ---- parallel contours -----------------------------------------------------------------------------------------------


def offset(contour: Contour, distance: float, name: str = "outline") -> Contour:
    """The exact parallel contour at `distance` mm: > 0 outside the enclosed area, < 0 inside; run as the given one is.

    Its area is checked against the offset of a facetted polygon. Raises DesignError (quantity named after `name`) where
    nothing is left, where it falls apart, or where a loop could not be cut off.
    """
    if distance == 0:
        return contour
    clockwise = contour.area < 0
    away = contour.counter_clockwise() if distance > 0 else contour.counter_clockwise().reversed()
    area, slack = _offset_area(contour, distance, name)
    pieces = _raw(away.pieces, abs(distance))
    parallel = Contour(tuple(trim(pieces)[0])).counter_clockwise()
    if not abs(parallel.area - area) <= slack:
        raise DesignError(
            f"area of the {name} moved by {distance:g} mm",
            parallel.area,
            area,
            "mm^2",
            "",
            "a loop of the parallel curve could not be cut off: use a smaller compensation",
        )
    return parallel.reversed() if clockwise else parallel


def _offset_area(contour: Contour, distance: float, name: str) -> tuple[float, float]:
    """Area of the offset of a facetted polygon, and how far it may be from the exact one, mm^2."""
    import shapely

    size = math.sqrt(abs(contour.area))
    tolerance = _CHECK * size
    ring = facet_contour(contour, tolerance)
    face = shapely.Polygon(coordinates(ring))
    outline = face.buffer(distance, quad_segs=128)
    if outline.is_empty:
        room = shapely.length(shapely.maximum_inscribed_circle(face))
        raise DesignError(
            f"compensation of the {name}",
            abs(distance),
            room,
            "mm",
            _at(contour),
            "no material is left: use a smaller one",
        )
    if outline.geom_type != "Polygon" or outline.interiors:
        count = shapely.get_num_geometries(outline) + sum(
            len(p.interiors) for p in shapely.get_parts(outline)
        )
        raise DesignError(
            f"pieces of the {name} moved by {distance:g} mm",
            count,
            1,
            "",
            _at(contour),
            "use a smaller compensation",
        )
    return float(outline.area), float(
        2 * tolerance * max(face.length, outline.length) + 3e-4 * distance**2
    )


def _at(contour: Contour) -> str:
    z = contour.centroid
    return f"x {z.real:.3f}, y {z.imag:.3f} mm"


def _raw(pieces: Sequence[Piece], e: float) -> list[Piece]:
    """Pieces moved by e to their right, joined: by an arc where they part, through the old joint where they overlap."""
    moved: list[Piece] = []
    for piece, following in zip(pieces, [*pieces[1:], pieces[0]], strict=True):
        moved += _parallel(piece, e)
        last = _direction(piece, piece.t1)
        first = _direction(following, following.t0)
        turn = float(np.angle(first / last))
        if abs(turn) * max(e, 1.0) <= max(SAME_POINT, _TURN):
            continue
        joint = end_point(piece)
        if turn > 0:
            moved.append(Arc(joint, e, float(np.angle(-1j * last)), turn))
        else:  # these two lie in what is cut away
            moved += [
                Line(joint - 1j * e * last, joint),
                Line(joint, start_point(following) - 1j * e * first),
            ]
    return moved


def _direction(piece: Piece, t: float) -> complex:
    """Unit tangent in the sense in which the piece is run."""
    d = complex(piece.at(t, 1)) * (1 if piece.t1 > piece.t0 else -1)
    return d / abs(d)


def _parallel(piece: Piece, e: float) -> list[Piece]:
    """The piece moved by e to its right; nothing where an arc shrinks to its centre."""
    if isinstance(piece, Line):
        shift = -1j * e * _direction(piece, piece.t0)
        return [Line(piece.a + shift, piece.b + shift)]
    if isinstance(piece, Arc):
        radius = piece.radius + e * math.copysign(1.0, piece.sweep)
        if abs(radius) <= SAME_POINT:
            return []
        return [
            Arc(
                piece.centre,
                abs(radius),
                piece.start + (0.0 if radius > 0 else math.pi),
                piece.sweep,
            )
        ]
    return [parallel_curve(piece, e)]


def parallel_curve(piece: Smooth, e: float) -> Smooth:
    """Parallel curve at e mm to the right of a smooth piece as it is run, with derivatives of order 0..2.

    With n the unit normal to the right and k the curvature, q = z + e n and q' = z' (1 + e k): no third derivative. In
    q'' = z'' (1 + e k) + z' e k' only the part along the curve needs k', which is taken as a difference over 2e-5 of the
    parameter, inside the piece: curvature and sagittas do not depend on it.
    """
    inner = piece.function
    low = min(piece.t0, piece.t1)
    high = max(piece.t0, piece.t1)
    side = e * (1 if piece.t1 > piece.t0 else -1)
    half = _SLOPE_STEP * (high - low)

    def curvature(t: Floats) -> Floats:
        d = inner(t, 1)
        return np.asarray(np.imag(np.conj(d) * inner(t, 2)) / np.abs(d) ** 3)

    def function(t: Floats, order: int) -> Points:
        d = inner(t, 1)
        if order == 0:
            return np.asarray(inner(t, 0) - 1j * side * d / np.abs(d))
        stretch = 1 + side * curvature(t)
        if order == 1:
            return np.asarray(d * stretch)
        before = np.clip(t - half, low, high)
        after = np.clip(t + half, low, high)
        slope = (curvature(after) - curvature(before)) / (after - before)
        return np.asarray(inner(t, 2) * stretch + d * side * slope)

    return replace(piece, function=function, origin=None, known={}, fitted={})


# ---- parts -----------------------------------------------------------------------------------------------------------


def compensated(part: Part, fit: Compensation) -> Part:
    """The part whose print is the one given: holes larger, outline smaller, a chamfer at the foot, then scaled up.

    Scaling is about the datum and in the plane alone; heights stay. The bore, centres and engraving follow. Raises
    DesignError where an outline or a wall vanishes, the chamfer is twice as high as the lowest layer, or the part is crossed or a
    drum: its walls lean to the plane in which a printer shrinks and swells it, so no outline of it can be compensated by itself.
    """
    if not part.prismatic:
        what = "is made of two crossed outlines" if part.drum is None else "has a track round it"
        message = f"{part.name} {what} and cannot be compensated for the print"
        remedy = "leave its keys of [print] at 0, and let the slicer compensate"
        raise DesignError(
            "print fits of a part with walls that lean", 1, 0, "", part.name, remedy
        ).saying(message)
    if not -0.5 < fit.shrinkage < 0.5:
        raise DesignError("shrinkage", fit.shrinkage, 0.5, "", part.name, "a share such as 0.003")
    scale = 1 / (1 - fit.shrinkage)
    layers: list[Layer] = []
    cut = part.drawn_layer
    bottom = min(layer.z0 for layer in part.layers)
    for index, layer in enumerate(part.layers):
        floor = layer.z0
        if fit.foot > 0 and layer.z0 == bottom:
            foot = fit.foot_of(part)
            thin = 2 * (layer.z1 - layer.z0)
            steps = max(1, math.ceil(foot / fit.layer - 1e-9))
            if not fit.foot < thin:
                raise DesignError(
                    "elephant-foot chamfer", fit.foot, thin, "mm", part.name, "use a lower one"
                )
            for k in range(steps):
                inset = foot * (1 - k / steps)
                region = _fit(layer.region, fit.hole + inset, fit.profile + inset, part.name)
                layers.append(Layer(region.moved(scale), floor, bottom + foot * (k + 1) / steps))
                floor = layers[-1].z1
            cut += steps if index <= part.drawn_layer else 0
        layers.append(
            Layer(
                _fit(layer.region, fit.hole, fit.profile, part.name).moved(scale),
                floor,
                layer.z1,
            )
        )
    return replace(
        part,
        layers=tuple(layers),
        engraved=tuple(replace(layer, region=layer.region.moved(scale)) for layer in part.engraved),
        centres=tuple(z * scale for z in part.centres),
        bore=None if part.bore is None else (part.bore + 2 * fit.hole) * scale,
        drawn_layer=cut,
    )


def _fit(region: Region, hole: float, profile: float, name: str) -> Region:
    """Holes grown by `hole`, the outline shrunk by `profile`, mm; DesignError where they meet."""
    outer = offset(region.outer, -profile, f"outline of {name}")
    holes = tuple(offset(h, hole, f"hole of {name}") for h in region.holes)
    if (hole or profile) and holes:
        facets: list[Any] = [
            facet_contour(c, 0.01 * math.sqrt(abs(c.area))) for c in (outer, *holes)
        ]
        wall = thinnest_wall(facets[0], facets[1:])
        if not wall > 0:
            raise DesignError(
                "wall",
                wall,
                0.0,
                "mm",
                name,
                "the fits leave no material between holes and outline",
            )
    return Region(outer, holes)
