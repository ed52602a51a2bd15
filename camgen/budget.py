"""Error budget: what each stage from law to file adds, in mm of outline and degrees of swing."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from camgen.arcfit import bulges, fit_arcs
from camgen.distances import point_to_ring
from camgen.mechanism import Rolling, Table
from camgen.outlines import Contour, Floats, Points
from camgen.readback import Ring, Shape
from camgen.verify import Motion, judged_angles, mounted

_PAIRS = 4_000_000  # distances computed at most for one figure
_SAMPLES = 4096  # points of the exact outline that are measured, unless that makes too many pairs


def error_budget(
    outline: Contour, polygon: Ring, drive: Rolling, reachable: Motion, tolerance: float, read: Mapping[str, Shape],
    undercut: tuple[float, float],
) -> Table:
    """One row a stage: largest outline error (mm) and largest change of the follower's angle (deg) that it adds.

    outline: the exact one; polygon: the facets made of it, as they print; read: shapes recovered from the files, by kind
    ("dxf", "stl", "3mf"); undercut: what the spec implies, mm at the tip and deg.
    The outline error is the largest over even samples of the exact outline, the angle's over the judged cam angles.
    """
    theta = judged_angles()
    exact = reachable(theta)

    def swing(ring: Ring) -> Floats:
        return mounted(Shape(ring, ()), drive).angle(theta)

    unit, scale = drive.unit

    def largest(a: Floats, b: Floats) -> float:
        return scale * float(np.nanmax(np.abs(a - b)))

    rows: list[tuple[str, float, float]] = [("law: undercut that the spec implies", *undercut)]
    if "dxf" in read:
        arcs = Ring(*bulges(fit_arcs(outline, tolerance)))
        fitted = swing(arcs)
        rows.append(("arc fit (DXF)", _arc_error(outline, arcs), largest(fitted, exact)))
        rows.append(("decimals of DXF", _moved(arcs, read["dxf"].outer), largest(swing(read["dxf"].outer), fitted)))
    meshes = [kind for kind in ("stl", "3mf") if kind in read]
    if meshes:
        facetted = swing(polygon)
        rows.append(("facets (STL, 3MF)", _facet_error(outline, polygon.points), largest(facetted, exact)))
        for kind in meshes:
            ring = read[kind].outer
            rows.append((f"float32 of {kind.upper()}", _moved(polygon, ring), largest(swing(ring), facetted)))
    return Table("Error budget by stage", ("stage", "outline, mm", f"follower, {unit}"), rows)


def _samples(outline: Contour, edges: int) -> Points:
    n = max(64, min(_SAMPLES, _PAIRS // edges) // len(outline.pieces))
    return np.concatenate([p.at(np.linspace(p.t0, p.t1, n)) for p in outline.pieces])


def _facet_error(outline: Contour, polygon: Points) -> float:
    return float(np.max(point_to_ring(_samples(outline, len(polygon)), polygon)))


def _arc_error(outline: Contour, ring: Ring) -> float:
    """Largest distance of samples of the exact outline from a ring of arcs, mm."""
    z = _samples(outline, len(ring.points))[:, None]
    a, b, t = ring.points, ring.ends, ring.bulges
    straight = t == 0
    bend = np.where(straight, 1.0, t)
    centre = (a + b) / 2 + 0.5j * (b - a) * (1 - bend**2) / (2 * bend)
    spoke = z - centre
    # on the arc's side of its chord and between its ends, seen from the centre
    turned = np.mod(np.angle(spoke * np.conj(a - centre)) * np.sign(bend), 2 * math.pi)
    beside = turned <= 4 * np.arctan(np.abs(bend))
    along = np.clip(np.real((z - a) * np.conj(b - a)) / np.abs(b - a) ** 2, 0, 1)
    chord = np.abs(z - a - along * (b - a))
    corner = np.minimum(np.abs(z - a), np.abs(z - b))
    arc = np.where(beside, np.abs(np.abs(spoke) - np.abs(a - centre)), corner)
    return float(np.max(np.min(np.where(straight, chord, arc), axis=1)))


def _moved(made: Ring, read: Ring) -> float:
    """Largest distance of a vertex that was read from the nearest one that was made, mm."""
    import shapely

    tree = shapely.STRtree(shapely.points(made.points.real, made.points.imag))
    nearest = made.points[tree.nearest(shapely.points(read.points.real, read.points.imag))]
    return float(np.max(np.abs(read.points - nearest)))
