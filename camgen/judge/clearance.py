"""How near two bodies come as they shift past each other over a turn: on sections of their files, with no step between.

Bodies do not turn, so all that happens is told by the way of the one as the other sees it, a curve in the plane.

    chord     straight piece of that way; it leaves the curve by at most `bulge`, which is measured and made small
    sweep     all that a convex body covers along a chord: a convex polygon again, so the least distance along the chord
              is the distance of two polygons, exact, and not that of the positions that were looked at
    signed    distance where apart, 0 grazing, less the shortest shift that parts them where they overlap

Overlap along a chord is a concave function for convex bodies, so its greatest value is found, not sampled. A body that
is not convex is taken as its triangles; then the overlap is that of the worst pair, at the least.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from camgen import tolerances
from camgen.files.dxf import read_dxf
from camgen.files.formats import read_solid
from camgen.findings import Finding, at_least, at_most
from camgen.geometry.mesh import slice_mesh
from camgen.geometry.rings import Floats, Points
from camgen.machine.contacts import Apart, Pose
from camgen.numerics import crests

if TYPE_CHECKING:
    import shapely

_CHORDS = 90  # of the turn, to begin with
_DENT = 1e-5  # mm, by which a vertex may lie inside its neighbours' line through the rounding to float32
_BULGE = 1e-9  # mm, by which a chord may leave the curve where it matters
_FRACTIONS = 129  # of a chord, at which the begin of an overlap is looked up
_ROUNDS = 16  # of halving; a bulge falls to a quarter each time
_ANGLES = 1441  # at which the distance is drawn and tabled: every quarter degree, both ends
_DIGITS = 6  # of a distance, mm: coordinates in the files have no more

Poses = Callable[[Floats], Mapping[str, Sequence[Pose]]]
Way = Callable[[Floats], Points]


@dataclass(frozen=True)
class Least:
    """Least signed distance over the turn, mm, the angle of it, rad, and from where to where bodies overlap, rad."""

    distance: float
    theta: float
    overlaps: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True)
class Cleared:
    """Findings, numbers and curves (name, theta in deg, mm) of one kind of file."""

    findings: tuple[Finding, ...]
    numbers: Mapping[str, float]
    curves: tuple[tuple[str, Floats, Floats], ...]


# ---- polygons --------------------------------------------------------------------------------------------------------


def _cross(a: Points, b: Points) -> Floats:
    return np.asarray((np.conj(a) * b).imag)


def convex_pieces(ring: Points) -> list[Points]:
    """The ring itself, counter-clockwise, where it is convex but for rounding; else triangles that fill it."""
    edges = np.roll(ring, -1) - ring
    if np.sum(_cross(ring, np.roll(ring, -1))) < 0:
        ring = ring[::-1]
        edges = np.roll(ring, -1) - ring
    onward = np.roll(edges, -1)
    if np.all(_cross(edges, onward) >= -_DENT * np.abs(edges + onward)):
        return [ring]
    import mapbox_earcut

    xy = np.column_stack([ring.real, ring.imag])
    faces = mapbox_earcut.triangulate_float64(xy, np.array([len(ring)], np.uint32)).reshape(-1, 3)
    triangles = [ring[face] for face in faces.astype(int)]
    turned = [float(_cross(t[1:2] - t[0], t[2:] - t[0])[0]) for t in triangles]
    return [t if way > 0 else t[::-1] for t, way in zip(triangles, turned, strict=True) if way != 0]


def _slabs(a: Points, b: Points) -> tuple[Points, Floats]:
    """Convex a and b overlap, b shifted by p, where Re(conj(normal) p) < limit for all: (m,) outward normals and limits."""
    edges = np.concatenate([np.roll(a, -1) - a, b - np.roll(b, -1)])
    edges = edges[edges != 0]
    normals = -1j * edges / np.abs(edges)
    reach_a = np.max(np.real(np.conj(normals)[:, None] * a), axis=1)
    reach_b = np.max(np.real(-np.conj(normals)[:, None] * b), axis=1)
    return normals, reach_a + reach_b


def _polygons(rings: Sequence[Points]) -> list[shapely.Polygon]:
    import shapely

    return [shapely.Polygon(np.column_stack([ring.real, ring.imag])) for ring in rings]


def _sweeps(b: Points, p: Points, q: Points) -> NDArray[np.object_]:
    """Hulls of convex b shifted by p and by q: all that it covers on the chords from p to q, (n,) polygons."""
    import shapely

    corners = np.concatenate([b + p[:, None], b + q[:, None]], axis=1)
    return np.asarray(shapely.convex_hull(shapely.multipoints(np.stack([corners.real, corners.imag], axis=-1))))


class _Bodies:
    """Two bodies made ready: outlines of the one that stands still, convex pieces of both."""

    def __init__(self, a: Sequence[Points], b: Sequence[Points]) -> None:
        self.a = [piece for ring in a for piece in convex_pieces(ring)]
        self.b = [piece for ring in b for piece in convex_pieces(ring)]
        self.fixed, self.parts = _polygons(a), _polygons(self.a)

    def along(self, p: Points, q: Points) -> tuple[Floats, Floats]:
        """Least signed distance along each chord from p to q, mm, and its share of the chord where bodies overlap; (n,)."""
        import shapely

        least, share = np.full(len(p), np.inf), np.zeros(len(p))
        for other in self.b:
            sweeps = _sweeps(other, p, q)
            apart = np.min([shapely.distance(body, sweeps) for body in self.fixed], axis=0)
            least = np.minimum(least, apart)
            hit = np.flatnonzero(apart <= 0)
            for part, piece in zip(self.parts, self.a, strict=True) if len(hit) else ():
                both = hit[shapely.distance(part, sweeps[hit]) <= 0]
                if not len(both):
                    continue
                depth, at = _deepest(*_slabs(piece, other), p[both], q[both])
                deeper = -depth < least[both]
                least[both[deeper]], share[both[deeper]] = -depth[deeper], at[deeper]
        return least, share


def _deepest(normals: Points, limits: Floats, p: Points, q: Points) -> tuple[Floats, Floats]:
    """Greatest overlap of two convex bodies along each chord, mm, at least 0, and its share of the chord: golden section."""

    def depth(u: Floats) -> Floats:
        found: Floats = np.min(limits - np.real(np.conj(normals) * (p + u * (q - p))[:, None]), axis=1)
        return found

    none, whole = np.zeros(len(p)), np.ones(len(p))
    # an end of the chord may be its deepest place
    shares = np.stack([crests(depth, none, whole) if np.any(p != q) else whole / 2, none, whole])
    depths = np.stack([depth(u) for u in shares])
    best = np.argmax(depths, axis=0)[None]
    return np.maximum(np.take_along_axis(depths, best, 0)[0], 0.0), np.take_along_axis(shares, best, 0)[0]


def signed_distances(a: Sequence[Points], b: Sequence[Points], shifts: Points) -> Floats:
    """Signed distance of the bodies of outlines a and b at each shift of b, (n,) mm."""
    import shapely

    places = [ring + shifts[:, None] for ring in b]
    moving = [shapely.polygons(np.stack([z.real, z.imag], axis=-1)) for z in places]
    distance: Floats = np.min([shapely.distance(body, other) for other in moving for body in _polygons(a)], axis=0)
    hit = distance <= 0
    if hit.any():
        distance[hit] = np.minimum(_Bodies(a, b).along(shifts[hit], shifts[hit])[0], 0.0)
    return distance


# ---- over the turn ---------------------------------------------------------------------------------------------------


def _bulges(way: Way, begin: Floats, end: Floats) -> Floats:
    """How far the way leaves its chords, (n,) mm, measured at their quarters."""
    p, q = way(begin), way(end)
    along = q - p
    length = np.where(along == 0, 1.0, np.abs(along) ** 2)
    off = np.zeros(len(p))
    for u in (0.25, 0.5, 0.75):
        z = way(begin + u * (end - begin)) - p
        share = np.clip(np.real(np.conj(along) * z) / length, 0.0, 1.0)
        off = np.maximum(off, np.abs(z - share * along))
    return off * (1 + tolerances.BOUND_SPARE)


def least_distance(a: Sequence[Points], b: Sequence[Points], way: Way) -> Least:
    """Least signed distance over a turn of a body of outlines `a` and one of `b` that is shifted by way(theta).

    way: (n,) rad -> (n,) complex mm, smooth but for corners. Chords are halved where the least distance may be, until
    they leave the way by no more than a nanometre.
    """
    bodies, theta = _Bodies(a, b), np.linspace(0, math.tau, _CHORDS + 1)
    begin, end = theta[:-1], theta[1:]
    overlaps: tuple[tuple[float, float], ...] = ()
    for step in range(_ROUNDS):
        p, q, bulge = way(begin), way(end), _bulges(way, begin, end)
        signed, share = bodies.along(p, q)
        if step == 0 and np.any(signed <= 0):
            overlaps = _overlaps(a, b, way, begin[signed <= 0], end[signed <= 0])
        keep = signed - bulge <= np.min(signed + bulge)
        begin, end, signed, share = begin[keep], end[keep], signed[keep], share[keep]
        if np.max(bulge[keep]) <= _BULGE:
            break
        middle = (begin + end) / 2
        begin, end = np.concatenate([begin, middle]), np.concatenate([middle, end])
        signed, share = np.tile(signed, 2), np.tile(share, 2)
    k = int(np.argmin(signed))
    if signed[k] <= 0:
        return Least(float(signed[k]), float(begin[k] + share[k] * (end[k] - begin[k])), overlaps)
    fine = np.linspace(begin[k], end[k], _FRACTIONS)
    return Least(float(signed[k]), float(fine[np.argmin(signed_distances(a, b, way(fine)))]))


def _overlaps(a: Sequence[Points], b: Sequence[Points], way: Way, begin: Floats, end: Floats) -> tuple[tuple[float, float], ...]:
    """From where to where bodies overlap, seen at fractions of the first and the last of the chords in touch with each other."""
    order = np.argsort(begin)
    begin, end = begin[order], end[order]
    breaks = np.flatnonzero(begin[1:] > end[:-1] + 1e-12)
    found = []
    for first, last in zip([0, *(breaks + 1)], [*breaks, len(begin) - 1], strict=True):
        ends = []
        for chord, which in ((first, 0), (last, -1)):
            theta = np.linspace(begin[chord], end[chord], _FRACTIONS)
            inside = theta[signed_distances(a, b, way(theta)) <= 0]
            ends.append(float(inside[which]) if len(inside) else float(theta[_FRACTIONS // 2]))
        found.append((ends[0], ends[1]))
    return tuple(found)


# ---- on files --------------------------------------------------------------------------------------------------------


def sections(path: Path, part: str, height: float) -> list[Points]:
    """Outer outlines of the section of a part's solid in a file, at a height of its own frame, counter-clockwise.

    Holes are left out. ValueError where the section does not close.
    """
    mesh, _ = read_solid(path, part)
    return [ring.points for ring in slice_mesh(mesh, height) if ring.area > 0]


def drawn_outline(path: Path, mirrored: bool, tolerance: float) -> list[Points]:
    """Outer outline of a drawing, counter-clockwise, arcs within the tolerance, mm; mirrored: in Oy.

    ValueError where the drawing does not close.
    """
    drawing = read_dxf(path)
    if drawing.faults or not drawing.cut:
        raise ValueError("; ".join(fault.message for fault in drawing.faults) or "nothing is drawn to be cut")
    outer = max(drawing.cut, key=lambda ring: abs(ring.area))
    return [(outer.moved(-1, mirror=True) if mirrored else outer).counter_clockwise().facetted(tolerance)]


def judge_clearance(
    kind: str, folder: Path, prefix: str, pairs: Sequence[Apart], poses: Poses, chord_tolerance: float
) -> Cleared:
    """Whether all pairs stay apart over the turn, on the files <prefix>-<part>.<kind> in a folder.

    Bodies may graze: what the outlines of both may be off is allowed beside the pair's gap.
    """
    findings: list[Finding] = []
    numbers: dict[str, float] = {}
    curves: list[tuple[str, Floats, Floats]] = []
    for pair in pairs:
        where = f"{prefix}-{pair.a}.{kind} and {prefix}-{pair.b}.{kind}"
        rest = poses(np.zeros(1))
        way = _way(pair, poses)
        least, slack, curve = Least(math.inf, 0.0), 2 * chord_tolerance, np.full(_ANGLES, np.inf)
        turn = np.linspace(0, math.tau, _ANGLES)
        for plane in pair.planes[:1] if kind == "dxf" else pair.planes:  # a drawing shows one height
            try:
                if kind == "dxf":
                    shown = (pair.drawn.get(name, (name, False)) for name in (pair.a, pair.b))
                    a, b = (drawn_outline(folder / f"{prefix}-{name}.dxf", over, chord_tolerance) for name, over in shown)
                else:
                    names = {name: folder / f"{prefix}-{name}.{kind}" for name in (pair.a, pair.b)}
                    a, b = (sections(path, name, plane - rest[name][0].z) for name, path in names.items())
            except ValueError as error:
                findings.append(at_most("CLEARANCE", math.nan, 0, "mm", where, str(error)))
                break
            if not a or not b:
                remark = f"no section of {pair.b if a else pair.a} at height {plane:.6g} mm"
                findings.append(at_most("CLEARANCE", math.nan, 0, "mm", where, remark))
                break
            found = least_distance(a, b, way)
            least = min(least, found, key=lambda each: each.distance)
            size = max(float(np.max(np.abs(ring))) for ring in (*a, *b))
            slack = max(slack, 2 * chord_tolerance + 4 * tolerances.FLOAT32_ROUNDING * size)
            curve = np.minimum(curve, signed_distances(a, b, way(turn)))
        else:
            findings.append(_finding(pair, least, slack, where))
            numbers[f"clearance_{pair.name.lower().replace('/', '_')}_{kind}_mm"] = round(least.distance, _DIGITS) + 0.0
            curves.append((pair.name, np.degrees(turn), curve))
    return Cleared(tuple(findings), numbers, tuple(curves))


def _way(pair: Apart, poses: Poses) -> Way:
    """How b shifts as a sees it."""

    def way(theta: Floats) -> Points:
        a, b = (poses(theta)[name][0] for name in (pair.a, pair.b))
        if np.any(a.angle != 0) or np.any(b.angle != 0) or a.flipped or b.flipped:
            raise ValueError(f"{pair.name}: only bodies that shift are compared")
        return np.asarray(b.position - a.position)

    return way


def _finding(pair: Apart, least: Least, slack: float, where: str) -> Finding:
    degrees = math.degrees(least.theta)
    if least.distance < -slack:
        ranges = " and ".join(f"{math.degrees(a):.1f} to {math.degrees(b):.1f}" for a, b in least.overlaps)
        said = f"strikes: overlaps from {ranges} deg, deepest at {degrees:.2f} deg"
    elif least.distance <= slack:
        said = f"grazes at {degrees:.2f} deg"
    else:
        said = f"clear by {least.distance:.3f} mm at the least, at {degrees:.2f} deg"
    return at_least(
        "CLEARANCE", round(least.distance, _DIGITS) + 0.0, pair.gap, "mm", f"{pair.name}: {where}",
        f"{said}; up to {slack:.2g} mm either way is grazing", slack,
    )  # fmt: skip
