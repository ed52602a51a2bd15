"""Contours of a DXF for readers without polylines: lines and arcs end on end, or one spline each; written, and read back exactly.

A spline is rational, of degree 2, with double knots: each line or arc from a to b has the poles a, c, b with the weights 1,
cos(half its sweep), 1, where c is where the tangents of both ends meet, for a line half way [Piegl, Tiller: The NURBS Book, 7.3].
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from camgen.geometry.chains import Chain
from camgen.geometry.dxf_curves import chains
from camgen.geometry.outlines import Points
from camgen.geometry.rings import Floats, Ring

_JOINT = 1e-6  # mm, between edges that follow one another
_STRAIGHT = 1e8  # mm, radius from which on an arc is a line: its angles would not tell its ends
_MOST_SWEEP = math.pi / 2  # of an arc of a spline: beyond it poles lie far outside


def add_edges(space: Any, points: Points, bulges: Floats, layer: str) -> None:
    """Add a contour as a LINE or ARC for each of its edges, one after the other."""
    attributes = {"layer": layer}
    for a, b, bulge in zip(points, np.roll(points, -1), bulges, strict=True):
        radius = abs(b - a) * (1 + bulge**2) / (4 * abs(bulge)) if bulge else math.inf
        if radius > _STRAIGHT:
            space.add_line((a.real, a.imag), (b.real, b.imag), dxfattribs=attributes)
            continue
        centre = (a + b) / 2 + 1j * (b - a) * (1 - bulge**2) / (4 * bulge)
        start, end = (a, b) if bulge > 0 else (b, a)  # an ARC runs counter-clockwise
        angles = np.degrees(np.angle([start - centre, end - centre])) % 360
        space.add_arc((centre.real, centre.imag), radius, *angles.tolist(), dxfattribs=attributes)


def add_spline(space: Any, points: Points, bulges: Floats, layer: str) -> None:
    """Add a contour as one closed SPLINE, exactly."""
    starts, bulges = _divided(points, bulges)
    ends = np.roll(starts, -1)
    half = 2 * np.arctan(bulges)
    corners = (starts + ends) / 2 - 0.5j * (ends - starts) * np.tan(half)
    poles = np.append(np.column_stack([starts, corners]).ravel(), starts[0])
    weights = np.append(np.column_stack([np.ones(len(half)), np.cos(half)]).ravel(), 1.0)
    spline = space.add_spline(degree=2, dxfattribs={"layer": layer})
    spline.control_points = np.column_stack([poles.real, poles.imag, np.zeros(len(poles))])
    spline.weights = weights
    spline.knots = _knots(len(half))
    spline.dxf.flags = spline.CLOSED | spline.RATIONAL | spline.PLANAR


def _divided(points: Points, bulges: Floats) -> tuple[Points, Floats]:
    """The same contour with arcs of more than a quarter turn in two halves."""
    ends = np.roll(points, -1)
    middles = (points + ends) / 2 - 0.5j * bulges * (ends - points)
    wide = np.abs(4 * np.arctan(bulges)) > _MOST_SWEEP
    count = 1 + wide
    starts = np.repeat(points, count)
    starts[np.cumsum(count)[wide] - 1] = middles[wide]
    return starts, np.repeat(np.where(wide, np.tan(np.arctan(bulges) / 2), bulges), count)


def _knots(edges: int) -> Floats:
    """0, 0, 0, 1, 1, 2, 2, ... n, n, n."""
    return np.concatenate([[0.0], np.repeat(np.arange(edges + 1.0), 2), [float(edges)]])


def ring_of_spline(entity: Any) -> Ring | None:
    """The lines and arcs of which a SPLINE was made; None where it is another one."""
    poles = np.array(entity.control_points, float).reshape(-1, 3)
    edges = (len(poles) - 1) // 2
    weights = np.array(entity.weights, float)
    if (
        entity.dxf.degree != 2
        or not entity.closed
        or edges < 2
        or not len(poles) == len(weights) == 2 * edges + 1
        or not np.array_equal(np.array(entity.knots, float), _knots(edges))
        or not (np.isfinite(poles).all() and np.isfinite(weights).all())
        or poles[:, 2].any()
    ):
        return None
    places = poles[:, 0] + 1j * poles[:, 1]
    starts, corners = places[:-1:2], places[1::2]
    ends = np.append(starts[1:], places[-1])
    chords = ends - starts
    if abs(places[-1] - places[0]) > _JOINT or not np.all(np.abs(chords) > 0):
        return None
    half = np.arctan(2 * np.imag(np.conj((corners - (starts + ends) / 2) / chords)))
    meet = (starts + ends) / 2 - 0.5j * chords * np.tan(half)
    given = np.abs(weights[::2] - 1).max() + np.abs(weights[1::2] - np.cos(half)).max()
    if given > 1e-9 or np.abs(meet - corners).max() > _JOINT:
        return None
    return Ring(starts, np.tan(half / 2))


def rings_of_edges(path: Any, entities: Sequence[Any]) -> tuple[list[Ring], list[float]]:
    """Rings of LINEs and ARCs that follow one another in the file; of those that do not close, the gap, mm."""
    rings: list[Ring] = []
    gaps: list[float] = []
    run: list[Chain] = []
    for edge in chains(path, entities, 1.0)[0]:
        if len(run) == 1 and _gap(run[0], edge) > _JOINT:
            run = [run[0].reversed()]
        if run and _gap(run[-1], edge) > _JOINT:
            gaps.append(_gap(run[-1], run[0]))
            run = []
        turned = run and abs(run[-1].points[-1] - edge.points[0]) > _JOINT
        run.append(edge.reversed() if turned else edge)
        if len(run) > 1 and abs(run[-1].points[-1] - run[0].points[0]) <= _JOINT:
            points = np.concatenate([each.points[:-1] for each in run])
            rings.append(Ring(points, np.concatenate([each.bulges for each in run])))
            run = []
    if run:
        gaps.append(_gap(run[-1], run[0]))
    return rings, gaps


def _gap(before: Chain, edge: Chain) -> float:
    """From the end of one edge to the nearer end of another, mm."""
    return float(np.abs(edge.points[[0, -1]] - before.points[-1]).min())
