"""Error budget: what each stage from law to file adds, in mm of outline and degrees of swing."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from camgen.geometry.arcs import bulges, fit_arcs
from camgen.geometry.deviation import outline_error
from camgen.geometry.outlines import Contour, Floats
from camgen.geometry.rings import Ring, Shape
from camgen.judge.rolling import Motion, judged_angles, mounted
from camgen.machine.contacts import Rolling
from camgen.machine.study import Table


def error_budget(
    outline: Contour, polygon: Ring, drive: Rolling, reachable: Motion, tolerance: float, read: Mapping[str, Shape],
    undercut: tuple[float, float],
) -> Table:
    """One row a stage: largest outline error (mm) and largest change of the follower's angle (deg) that it adds.

    outline: the exact one; polygon: the facets made of it, as they print; read: shapes recovered from the files, by kind
    ("dxf", "stl", "3mf"); undercut: what the spec implies, mm at the tip and deg.
    The outline error is the largest anywhere along the exact outline, the angle's that over the judged cam angles.
    """
    theta = judged_angles()
    exact = reachable(theta)

    def swing(ring: Ring) -> Floats:
        return mounted(Shape(ring, ()), drive).angle(theta)

    def off(ring: Ring) -> float:
        return outline_error(outline.counter_clockwise(), ring.counter_clockwise())

    unit, scale = drive.unit

    def largest(a: Floats, b: Floats) -> float:
        return scale * float(np.nanmax(np.abs(a - b)))

    rows: list[tuple[str, float, float]] = [("law: undercut that the spec implies", *undercut)]
    if "dxf" in read:
        arcs = Ring(*bulges(fit_arcs(outline, tolerance)))
        fitted = swing(arcs)
        rows.append(("arc fit (DXF)", off(arcs), largest(fitted, exact)))
        rows.append(("decimals of DXF", _moved(arcs, read["dxf"].outer), largest(swing(read["dxf"].outer), fitted)))
    meshes = [kind for kind in ("stl", "3mf") if kind in read]
    if meshes:
        facetted = swing(polygon)
        rows.append(("facets (STL, 3MF)", off(polygon), largest(facetted, exact)))
        for kind in meshes:
            ring = read[kind].outer
            rows.append((f"float32 of {kind.upper()}", _moved(polygon, ring), largest(swing(ring), facetted)))
    return Table("Error budget by stage", ("stage", "outline, mm", f"follower, {unit}"), rows)


def _moved(made: Ring, read: Ring) -> float:
    """Largest distance of a vertex that was read from the nearest one that was made, mm."""
    import shapely

    tree = shapely.STRtree(shapely.points(made.points.real, made.points.imag))
    nearest = made.points[tree.nearest(shapely.points(read.points.real, read.points.imag))]
    return float(np.max(np.abs(read.points - nearest)))
