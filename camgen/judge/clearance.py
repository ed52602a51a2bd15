"""How near two bodies come as they shift past each other over a turn: on sections of their files, with no step between.

Bodies do not turn, so all that happens is told by the way of the one as the other sees it, a point that moves in the plane.

    meeting   the shifts of b at which a and b meet: the Minkowski sum of a and -b, an area
    signed    distance of the way's point from that area; inside it less that from its edge, which is the shortest shift that
              parts the bodies
    chord     straight piece of the way, whose distance is exact; it leaves the way by at most `bulge`, which is made small
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from camgen import tolerances
from camgen.files.formats import FORMATS, read_drawing, read_solid
from camgen.findings import Finding, Where, at_least, at_most
from camgen.geometry.mesh import slice_mesh
from camgen.geometry.rings import Floats, Points
from camgen.machine.features import Passing, Poses
from camgen.numerics import coordinates, crests, magnitude
from camgen.study import Figure

_CHORDS = 90  # of the turn, to begin with
_DENT = 1e-5  # mm, by which a vertex may lie inside its neighbours' line through the rounding to float32
_BULGE = 1e-9  # mm, by which a chord may leave the curve where it matters
_PARTS = 128  # of a chord, at which the place of what it comes to is looked up
_POINT = 1e-12  # mm, a chord that is none
_ROUNDS = 16  # of halving; a bulge falls to a quarter each time
_ANGLES = 1441  # at which the distance is drawn and tabled: every quarter degree, both ends
_DIGITS = 6  # of a distance, mm: coordinates in the files have no more

Way = Callable[[Floats], Points]


@dataclass(frozen=True)
class Least:
    """Least signed distance of two bodies over the turn."""

    distance: float  # mm
    theta: float  # rad
    overlaps: tuple[tuple[float, float], ...] = ()  # from where to where, rad


@dataclass(frozen=True)
class Clearances:
    """Findings, figures and curves (name, theta in deg, mm) of one kind of file."""

    findings: tuple[Finding, ...]
    figures: Sequence[Figure]
    curves: tuple[tuple[str, Floats, Floats], ...]


# ---- two bodies ------------------------------------------------------------------------------------------------------


def convex_pieces(ring: Points) -> list[Points]:
    """The ring itself where it is convex but for rounding; else triangles that fill it."""
    edges = np.roll(ring, -1) - ring
    onward = np.roll(edges, -1)
    area = np.sum((np.conj(ring) * np.roll(ring, -1)).imag)
    if np.all(np.sign(area) * (np.conj(edges) * onward).imag >= -_DENT * np.abs(edges + onward)):
        return [ring]
    import mapbox_earcut

    xy = coordinates(ring)
    return list(
        ring[
            mapbox_earcut.triangulate_float64(xy, np.array([len(ring)], np.uint32))
            .reshape(-1, 3)
            .astype(int)
        ]
    )


def meeting(a: Sequence[Points], b: Sequence[Points]) -> Any:
    """The shifts of b at which bodies of outlines a and b meet, a shapely area: of convex pieces the hull of differences."""
    import shapely

    ones, others = ([piece for ring in rings for piece in convex_pieces(ring)] for rings in (a, b))
    # points a rounding apart become one
    shifts = [
        np.round(np.subtract.outer(one, other).ravel(), 12) for one in ones for other in others
    ]
    z: Points = np.concatenate(shifts)
    hulls = shapely.convex_hull(
        shapely.linestrings(
            coordinates(z),
            indices=np.repeat(np.arange(len(shifts)), [len(each) for each in shifts]),
        )
    )
    return shapely.union_all(hulls)


def signed_distances(area: Any, shifts: Points) -> Floats:
    """Signed distance of two bodies at each shift, (n,) mm, by the area of shifts at which they meet."""
    import shapely

    places = shapely.points(shifts.real, shifts.imag)
    apart: Floats = shapely.distance(area, places)
    return np.where(apart > 0, apart, -shapely.distance(shapely.boundary(area), places))


def _along(area: Any, p: Points, q: Points) -> tuple[Floats, Floats]:
    """Least signed distance along each chord from p to q, mm, and its share of the chord where bodies overlap; (n,).

    Golden section where they do: the depth in a convex area is a concave function; of another it is that much at the least.
    """
    import shapely

    chords = shapely.linestrings(np.stack([[p.real, q.real], [p.imag, q.imag]]).transpose(2, 1, 0))
    least: Floats = shapely.distance(
        area, np.where(np.abs(q - p) < _POINT, shapely.points(p.real, p.imag), chords)
    )
    fraction = np.zeros(len(p))
    hit = np.flatnonzero(least <= 0)
    way = (q - p)[hit]
    p = p[hit]
    none = np.zeros(len(hit))
    whole = np.ones(len(hit))

    def depth(u: Floats) -> Floats:
        return -signed_distances(area, p + u * way)

    # an end of the chord may be its deepest place
    fractions = np.stack(
        [crests(depth, none, whole) if np.any(way != 0) else whole / 2, none, whole]
    )
    depths = np.stack([depth(u) for u in fractions])
    best = np.argmax(depths, axis=0)[None]
    least[hit] = np.minimum(-np.take_along_axis(depths, best, 0)[0], 0.0)
    fraction[hit] = np.take_along_axis(fractions, best, 0)[0]
    return least, fraction


# ---- over the turn ---------------------------------------------------------------------------------------------------


def _chords(way: Way, begin: Floats, end: Floats) -> tuple[Points, Points, Floats]:
    """Both ends of the way's chords, (n,) each, and how far it leaves them, (n,) mm, measured at their quarters."""
    quarters = [begin + u * (end - begin) for u in (0.25, 0.5, 0.75)]
    p, q, *between = np.split(way(np.concatenate([begin, end, *quarters])), 5)
    along = q - p
    length = np.where(along == 0, 1.0, np.abs(along) ** 2)
    off = np.zeros(len(p))
    for inner in between:
        z = inner - p
        fraction = np.clip(np.real(np.conj(along) * z) / length, 0.0, 1.0)
        off = np.maximum(off, np.abs(z - fraction * along))
    return p, q, off * (1 + tolerances.BOUND_SPARE)


def least_distance(area: Any, way: Way) -> Least:
    """Least signed distance over a turn of two bodies, by the area of shifts at which they meet, as way(theta) shifts one.

    way: (n,) rad -> (n,) complex mm, smooth but for corners. Chords are halved where the least distance may be, until
    they leave the way by no more than a nanometre.
    """
    theta = np.linspace(0, math.tau, _CHORDS + 1)
    begin = theta[:-1]
    end = theta[1:]
    for _ in range(_ROUNDS):
        p, q, bulge = _chords(way, begin, end)
        signed, fraction = _along(area, p, q)
        keep = signed - bulge <= np.min(signed + bulge)
        begin = begin[keep]
        end = end[keep]
        signed = signed[keep]
        fraction = fraction[keep]
        if np.max(bulge[keep]) <= _BULGE:
            break
        middle = (begin + end) / 2
        begin = np.concatenate([begin, middle])
        end = np.concatenate([middle, end])
        signed = np.tile(signed, 2)
        fraction = np.tile(fraction, 2)
    k = int(np.argmin(signed))
    if signed[k] <= 0:
        return Least(
            float(signed[k]), _angle_at(way, begin[k], end[k], fraction[k]), _overlaps(area, way)
        )
    fine = np.linspace(begin[k], end[k], _PARTS + 1)
    return Least(float(signed[k]), float(fine[np.argmin(signed_distances(area, way(fine)))]))


def _angle_at(way: Way, begin: float, end: float, fraction: float) -> float:
    """The angle at which a way is beside the place at a share of its chord: along the chord it may be fast and slow."""
    fine = np.linspace(begin, end, _PARTS + 1)
    z = way(fine) - way(fine[:1])
    distance = np.real(np.conj(z[-1]) * z)
    return float(np.interp(fraction * distance[-1], np.maximum.accumulate(distance), fine))


def _overlaps(area: Any, way: Way) -> tuple[tuple[float, float], ...]:
    """From where to where bodies overlap, as seen at even steps of the turn."""
    theta = np.linspace(0, math.tau, _CHORDS * _PARTS + 1)
    inside = np.flatnonzero(signed_distances(area, way(theta)) <= 0)
    runs = np.split(inside, np.flatnonzero(np.diff(inside) > 1) + 1)
    return tuple((float(theta[run[0]]), float(theta[run[-1]])) for run in runs if len(run))


# ---- on files --------------------------------------------------------------------------------------------------------


def sections(path: Path, part: str, height: float) -> list[Points]:
    """Outer outlines of the section of a part's solid in a file, at a height of its own frame, counter-clockwise.

    Holes are left out. ValueError where the section does not close.
    """
    mesh, _ = read_solid(path, part)
    return [ring.points for ring in slice_mesh(mesh, height) if ring.area > 0]


def drawn_outline(path: Path, part: str, mirrored: bool, tolerance: float) -> list[Points]:
    """Outer outline of a drawing, counter-clockwise, arcs within the tolerance, mm; mirrored: in Oy.

    ValueError where the drawing does not close.
    """
    drawing = read_drawing(path, part)
    if drawing.faults or not drawing.cut:
        raise ValueError(
            "; ".join(fault.message for fault in drawing.faults) or "nothing is drawn to be cut"
        )
    outer = max(drawing.cut, key=lambda ring: abs(ring.area))
    return [
        (outer.moved(-1, mirror=True) if mirrored else outer)
        .counter_clockwise()
        .facetted(tolerance)
    ]


def judge_clearance(
    kind: str,
    file: Callable[[str, str], Path],
    pairs: Sequence[Passing],
    poses: Poses,
    chord_tolerance: float,
) -> Clearances:
    """Whether all pairs stay apart over the turn, on their files.

    file: path of a part's file of a kind.

    Bodies may graze: what the outlines of both may be off is allowed beside the pair's gap.
    """
    findings: list[Finding] = []
    figures: list[Figure] = []
    curves: list[tuple[str, Floats, Floats]] = []
    solid = FORMATS[kind].solid

    for pair in pairs:
        names = " and ".join(file(name, kind).name for name in (pair.a, pair.b))
        where = Where(names, kind=kind, part=pair.a, other=pair.b)
        rest = poses(np.zeros(1))
        way = _way(pair, poses)
        least = Least(math.inf, 0.0)
        slack = 2 * chord_tolerance
        curve = np.full(_ANGLES, np.inf)
        turn = np.linspace(0, math.tau, _ANGLES)
        for plane in pair.planes if solid else pair.planes[:1]:  # a drawing shows one height
            try:
                if solid:
                    a, b = (
                        sections(file(name, kind), name, plane - rest[name][0].z)
                        for name in (pair.a, pair.b)
                    )
                else:
                    drawings = (pair.drawn.get(name, (name, False)) for name in (pair.a, pair.b))
                    a, b = (
                        drawn_outline(file(name, kind), name, over, chord_tolerance)
                        for name, over in drawings
                    )
            except ValueError as error:
                findings.append(at_most("CLEARANCE", math.nan, 0, "mm", where, str(error)))
                break
            if not a or not b:
                remark = f"no section of {pair.b if a else pair.a} at height {plane:.6g} mm"
                findings.append(at_most("CLEARANCE", math.nan, 0, "mm", where, remark))
                break
            area = meeting(a, b)
            nearest = least_distance(area, way)
            least = min(least, nearest, key=lambda each: each.distance)
            size = max(magnitude(ring) for ring in (*a, *b))
            slack = max(slack, 2 * chord_tolerance + 4 * FORMATS[kind].rounding * size)
            curve = np.minimum(curve, signed_distances(area, way(turn)))
        else:
            findings.append(_finding(pair, least, slack, where))
            apart = round(least.distance, _DIGITS) + 0.0
            figures.append(Figure("clearance {of}", apart, "mm", pair.name.lower(), kind=kind))
            curves.append((pair.name, np.degrees(turn), curve))
    return Clearances(tuple(findings), figures, tuple(curves))


def _way(pair: Passing, poses: Poses) -> Way:
    """How b shifts as a sees it."""

    def way(theta: Floats) -> Points:
        there = poses(theta)
        a, b = (there[name][0] for name in (pair.a, pair.b))
        if np.any(a.angle != 0) or np.any(b.angle != 0) or a.flipped or b.flipped:
            raise ValueError(f"{pair.name}: only bodies that shift are compared")
        return np.asarray(b.place - a.place)

    return way


def _finding(pair: Passing, least: Least, slack: float, where: Where) -> Finding:
    degrees = math.degrees(least.theta)
    if least.distance < -slack:
        ranges = " and ".join(
            f"{math.degrees(a):z.1f} to {math.degrees(b):z.1f}" for a, b in least.overlaps
        )
        words = f"strikes: overlaps from {ranges} deg, deepest at {degrees:z.2f} deg"
    elif least.distance <= slack:
        words = f"grazes at {degrees:z.2f} deg"
    else:
        words = f"clear by {least.distance:z.3f} mm at the least, at {degrees:z.2f} deg"
    return at_least(
        "CLEARANCE",
        round(least.distance, _DIGITS) + 0.0,
        pair.gap,
        "mm",
        replace(where, thing=f"{pair.name}: {where.thing}"),
        f"{words}; up to {slack:.2g} mm either way is grazing",
    ).within(slack)
