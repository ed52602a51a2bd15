"""Arcs: an exact outline as lines and circular arcs with common tangents, within a tolerance.

    biarc     two arcs from one point and tangent to another, with a common tangent where they meet (the joint)
    bulge     tan(sweep / 4) of an arc, > 0 counter-clockwise; with its end points it is the whole arc

A biarc over the length 2h of a curve whose curvature grows by kappa' a mm leaves e = kappa' (2h)^3 / 324 at a third of
each half and nothing at the joint (integrate e''' = kappa' twice from both ends). So the least number of arcs is the
integral of (|kappa'| / (40.5 tolerance))^(1/3) ds, and equal parts of it are the best spacing.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from camgen.geometry.facets import LAST_STEP, ShareLaw, Track, cross, dot, facet, fewest
from camgen.geometry.outlines import Arc, Contour, Floats, Line, Piece, Points, Smooth, start_point
from camgen.geometry.rings import Ring
from camgen.numerics import magnitude, roots

# A biarc turns by no more than this, rad, however loose the tolerance: each of its arcs stays well below a half circle.
_BIARC_TURN = 2 * math.pi / 3
# Places on each arc at which stationary points of the deviation are bracketed; a biarc on a spiral has one an arc.
_BRACKETS = 8
# An arc flatter than this, radius over chord, becomes a line where the tolerance allows; ...
_FLAT = 1e5
# ... one flatter than this, radius over the size of the piece, must: its centre would lose its ends to rounding.
_FLATTEST = 1e5
# Of a family of curves: places of each at which its curvature is seen, places of a biarc at which its deviation is (it is
# greatest near a third of each half), and the share of its biarcs that are spread evenly.
_SPREAD = 64
_SEEN = 11
_EVENLY = 0.1
# Of arcs in place of straight edges: how many of these there must be, and how far an arc turns at most, rad.
_LEAST_RUN = 3
_ARC_TURN = math.pi / 4


@dataclass(frozen=True)
class Biarcs:
    """n biarcs, arrays (n,): ends z0, z1, joint, unit tangents there, signed sweeps (rad) and curvatures (1/mm).

    The joint is the one with equal chords: no case of parallel tangents to set apart, and it lies on a spiral
    up to terms of fourth order.
    """

    z0: Points
    joint: Points
    z1: Points
    tangent0: Points
    tangent_joint: Points
    sweeps: tuple[Floats, Floats]
    kappas: tuple[Floats, Floats]

    @classmethod
    def through(cls, z: Points, tangents: Points) -> Biarcs:
        """Biarcs between neighbours of the points z (n + 1,) with unit tangents there."""
        return cls.between(z[:-1], z[1:], tangents[:-1], tangents[1:])

    @classmethod
    def between(cls, z0: Points, z1: Points, tangent0: Points, tangent1: Points) -> Biarcs:
        """Biarcs from points z0 to z1 with unit tangents there, (n,) each."""
        v = z1 - z0
        a = np.angle(tangent0 / v)
        b = np.angle(tangent1 / v)
        leg = v / (2 * np.cos((b - a) / 4)) * np.exp(0.25j * (a - b))
        sweeps = (-(3 * a + b) / 2, (3 * b + a) / 2)
        kappas = (2 * np.sin(sweeps[0] / 2) / np.abs(leg), 2 * np.sin(sweeps[1] / 2) / np.abs(leg))
        middle_tangent = v / np.abs(v) * np.exp(-0.5j * (a + b))
        return cls(z0, z0 + leg, z1, tangent0, middle_tangent, sweeps, kappas)


def _tangents(piece: Smooth, t: Floats) -> Points:
    dz = piece.at(t, 1)
    return np.asarray(dz / np.abs(dz))


def _biarc_law(tolerance: float) -> ShareLaw:
    """Shares in biarcs, half the number of arcs."""
    return lambda _, length, change: np.cbrt(change * length**2 / (324 * tolerance))


def deviations(piece: Smooth, t: Floats) -> Floats:
    """Largest distance between each biarc on the ends t (n + 1,) and the piece, either way; (n,) mm.

    Measured along the arc's normals: the normal of the joint divides the curve between the two arcs, and on each part
    the extremes are where curve and arc run parallel. A stretch that no biarc can follow answers its whole size.
    """
    fit = Biarcs.through(piece.at(t), _tangents(piece, t))
    n = fit.z0.size
    size = np.abs(fit.z1 - fit.z0)

    def past_joint(s: Floats, i: np.ndarray) -> tuple[Floats, Floats]:
        along = fit.tangent_joint[i]
        return dot(along, piece.at(s) - fit.joint[i]), dot(along, piece.at(s, 1))

    parting = roots(past_joint, t[:-1], t[1:], LAST_STEP)

    # Both halves as one array of 2n arcs; an arc is a point on it, its tangent there and its curvature.
    point = np.concatenate([fit.z0, fit.joint])
    tangent = np.concatenate([fit.tangent0, fit.tangent_joint])
    kappa = np.concatenate(fit.kappas)
    lo = np.concatenate([t[:-1], parting])
    hi = np.concatenate([parting, t[1:]])

    def offset(s: Floats, i: np.ndarray) -> Floats:
        """Distance to the left of arc i, from f = d - kappa d^2 / 2, which a straight arc does not spoil."""
        w = piece.at(s) - point[i]
        f = cross(tangent[i], w) - kappa[i] * np.abs(w) ** 2 / 2
        return np.asarray(2 * f / (1 + np.sqrt(np.maximum(1 - 2 * kappa[i] * f, 0))))

    def parallel(s: Floats, i: np.ndarray) -> tuple[Floats, Floats]:
        """Derivatives of f: its first is 0 where the curve runs parallel to arc i."""
        w = piece.at(s) - point[i]
        d1 = piece.at(s, 1)
        d2 = piece.at(s, 2)
        slope = cross(tangent[i], d1) - kappa[i] * dot(w, d1)
        return slope, cross(tangent[i], d2) - kappa[i] * (dot(w, d2) + np.abs(d1) ** 2)

    # The first half touches its arc at z0 and the second at z1: there f' = 0 without being an extreme.
    inner = np.arange(1, _BRACKETS + 1) / (_BRACKETS + 1)
    grid = lo[:, None] + (hi - lo)[:, None] * np.concatenate([inner, [1.0]])
    grid[n:] = lo[n:, None] + (hi - lo)[n:, None] * np.concatenate([[0.0], inner])
    arc = np.broadcast_to(np.arange(2 * n)[:, None], grid.shape)
    slope = parallel(grid.ravel(), arc.ravel())[0].reshape(grid.shape)
    row, column = np.nonzero(slope[:, :-1] * slope[:, 1:] < 0)
    s = roots(lambda x, i: parallel(x, row[i]), grid[row, column], grid[row, column + 1], LAST_STEP)

    worst = np.abs(offset(grid.ravel(), arc.ravel())).reshape(grid.shape).max(axis=1)
    np.maximum.at(worst, row, np.abs(offset(s, row)))
    astray = np.abs(piece.at(parting) - fit.joint) > np.abs(fit.joint - fit.z0)
    wide = np.maximum(np.abs(fit.sweeps[0]), np.abs(fit.sweeps[1])) > 3
    return np.where(astray | wide, size, np.maximum(worst[:n], worst[n:]))


def _arc(a: complex, b: complex, sweep: float) -> Arc:
    """The arc from a to b."""
    centre = (a + b) / 2 + 0.5j * (b - a) / math.tan(sweep / 2)
    return Arc(centre, abs(b - a) / (2 * abs(math.sin(sweep / 2))), cmath.phase(a - centre), sweep)


def _ends(piece: Smooth, tolerance: float) -> tuple[Floats, Floats]:
    """Ends of the fewest biarcs within the tolerance, (n + 1,), and the deviation of each, (n,) mm; once for all images."""
    key = (piece.t0, piece.t1, tolerance)
    if key not in piece.fitted:
        curve = replace(piece.origin, t0=piece.t0, t1=piece.t1) if piece.origin else piece
        track = Track(curve, _biarc_law(tolerance), _BIARC_TURN)
        t = fewest(track, lambda ends: deviations(curve, ends), tolerance, 1 / 3)
        piece.fitted[key] = t, deviations(curve, t)
    return piece.fitted[key]


def _fit_smooth(piece: Smooth, tolerance: float) -> list[Piece]:
    if piece.t1 < piece.t0:
        return [p.reversed() for p in reversed(_fit_smooth(piece.reversed(), tolerance))]
    t, deviation = _ends(piece, tolerance)
    z = piece.at(t)
    fit = Biarcs.through(z, _tangents(piece, t))
    allowance = tolerance - deviation
    limit = 1 / (_FLATTEST * max(np.abs(z - z[0]).max(), np.abs(z).max()))
    pieces: list[Piece] = []
    for i in range(t.size - 1):
        ends = [complex(fit.z0[i]), complex(fit.joint[i]), complex(fit.z1[i])]
        spans = [
            (ends[j], ends[j + 1], float(fit.sweeps[j][i]), float(fit.kappas[j][i])) for j in (0, 1)
        ]
        flat = [
            abs(kappa * (b - a)) * _FLAT < 1
            and abs(b - a) / 2 * math.tan(abs(sweep) / 4) <= allowance[i]
            for a, b, sweep, kappa in spans
        ]
        if all(flat) or any(
            abs(span[3]) < limit and not line for span, line in zip(spans, flat, strict=True)
        ):
            corners = piece.at(facet(replace(piece, t0=t[i], t1=t[i + 1]), tolerance))
            pieces += [
                Line(complex(a), complex(b)) for a, b in zip(corners[:-1], corners[1:], strict=True)
            ]
        else:
            pieces += [
                Line(a, b) if line else _arc(a, b, sweep)
                for (a, b, sweep, _), line in zip(spans, flat, strict=True)
            ]
    return pieces


def fit_family(
    family: Callable[[Floats], tuple[Points, Points]], t0: Floats, t1: Floats, tolerance: float
) -> list[list[Piece]]:
    """Arcs of many smooth curves of one kind at once, within `tolerance` mm of each; curve k runs from t0[k] to t1[k], (n, 1).

    family: points and unit tangents the way the curves run, (n, m), at t (n, m), row k of curve k. All have as many biarcs,
    spread by what each leaves; the deviation is seen at _SEEN places of each.
    """
    even = np.linspace(0.0, 1.0, _SPREAD + 1)
    z, tangents = family(t0 + (t1 - t0) * even)
    length = np.abs(np.diff(z, axis=1))
    turned = np.angle(tangents[:, 1:] / tangents[:, :-1])
    between = (length[:, 1:] + length[:, :-1]) / 2
    change = np.abs(np.diff(turned / length, axis=1)) / between
    shares = np.cbrt(np.pad(change, ((0, 0), (1, 0)), "edge") / (324 * tolerance)) * length
    turns = np.abs(turned) / _BIARC_TURN
    shares = shares + turns + _EVENLY * (shares + turns).mean()
    shares = np.pad(np.cumsum(shares, axis=1), ((0, 0), (1, 0)))
    count = max(1, math.ceil(float(shares[:, -1].max()) / (1 + _EVENLY)))
    while True:
        marks = np.linspace(0.0, 1.0, count + 1)
        places = [np.interp(marks, row / row[-1], even) for row in shares]
        ends = t0 + (t1 - t0) * np.array(places)
        fit, deviation = _family_fit(family, ends)
        if deviation <= tolerance:
            break
        count = max(count + 1, math.ceil(count * min(2.0, (deviation / tolerance) ** (1 / 3))))
    pieces: list[Piece] = []
    z = np.stack([fit.z0, fit.joint, fit.z1], axis=-1)
    for three, *sweeps in zip(z.tolist(), *(each.tolist() for each in fit.sweeps), strict=True):
        for a, b, sweep in zip(three[:-1], three[1:], sweeps, strict=True):
            pieces.append(Line(a, b) if abs(sweep) * _FLAT < 1 else _arc(a, b, sweep))
    return [pieces[k : k + 2 * count] for k in range(0, len(pieces), 2 * count)]


def _family_fit(
    family: Callable[[Floats], tuple[Points, Points]], ends: Floats
) -> tuple[Biarcs, float]:
    """Biarcs between neighbouring ends of each row, (n, m + 1), one row after the other, and their largest deviation, mm."""
    share = np.arange(1, _SEEN + 1) / (_SEEN + 1)
    inside = ends[:, :-1, None] + np.diff(ends)[:, :, None] * share
    z, tangents = family(ends)
    seen, _ = family(inside.reshape(len(ends), -1))
    seen = seen.reshape(-1, _SEEN)
    rows = (z[:, :-1], z[:, 1:], tangents[:, :-1], tangents[:, 1:])
    fit = Biarcs.between(*(each.ravel() for each in rows))
    second = dot(fit.tangent_joint[:, None], seen - fit.joint[:, None]) > 0
    tangent = np.where(second, fit.tangent_joint[:, None], fit.tangent0[:, None])
    kappa = np.where(second, fit.kappas[1][:, None], fit.kappas[0][:, None])
    w = seen - np.where(second, fit.joint[:, None], fit.z0[:, None])
    f = cross(tangent, w) - kappa * np.abs(w) ** 2 / 2
    off = 2 * f / (1 + np.sqrt(np.maximum(1 - 2 * kappa * f, 0)))
    return fit, magnitude(off)


def _below_half(arc: Arc) -> list[Arc]:
    """The arc in equal parts that each sweep less than pi, so that every |bulge| < 1."""
    parts = math.floor(abs(arc.sweep) / math.pi + 1e-12) + 1
    step = arc.sweep / parts
    return [Arc(arc.centre, arc.radius, arc.start + i * step, step) for i in range(parts)]


@lru_cache(maxsize=256)  # one fit serves the cut file, the drawing and the report
def fit_arcs(contour: Contour, tolerance: float) -> Contour:
    """The contour as lines and arcs (each sweeping less than pi) within `tolerance` mm of it, either way.

    Joints stay where they are, with their exact points and tangents; lines and arcs stay as they are, but that
    arcs of pi and more are divided (a full circle is not: see `as_circle`).
    """
    if not 0 < tolerance < math.inf:
        raise ValueError(f"tolerance is {tolerance} mm, must be positive")
    if as_circle(contour):
        return contour
    pieces: list[Piece] = []
    for piece in contour.pieces:
        if isinstance(piece, Smooth):
            pieces += _fit_smooth(piece, tolerance)
        else:
            pieces += _below_half(piece) if isinstance(piece, Arc) else [piece]
    return Contour(tuple(pieces))


def as_circle(contour: Contour) -> tuple[complex, float] | None:
    """Centre and radius of a contour that is one full circle, else None."""
    match contour.pieces:
        case (Arc(centre, radius, _, sweep),) if math.isclose(
            abs(sweep), 2 * math.pi, rel_tol=1e-12
        ):
            return centre, radius
    return None


def bulges(contour: Contour) -> tuple[Points, Floats]:
    """Vertices (n,) and bulges (n,) of a closed polyline, |bulge| < 1; bulge i belongs to the edge from vertex i on.

    Raises ValueError for a contour that is not of lines and arcs only.
    """
    vertices: list[tuple[complex, float]] = []
    for piece in contour.pieces:
        if isinstance(piece, Smooth):
            raise ValueError("only lines and arcs have bulges; fit arcs first")
        if isinstance(piece, Arc):
            vertices += [(start_point(arc), math.tan(arc.sweep / 4)) for arc in _below_half(piece)]
        else:
            vertices.append((piece.a, 0.0))
    return np.array([z for z, _ in vertices], complex), np.array([bulge for _, bulge in vertices])


def theoretical_arcs(contour: Contour, tolerance: float) -> float:
    """Least number of arcs: the integral of (|kappa'| / (40.5 tolerance))^(1/3) ds on a smooth piece, 1 else."""

    def least(piece: Piece) -> float:
        if not isinstance(piece, Smooth):
            return 1.0
        forward = piece if piece.t0 < piece.t1 else piece.reversed()
        return 2 * float(Track(forward, _biarc_law(tolerance)).share.sum())

    return sum(least(piece) for piece in contour.pieces)


def with_arcs(ring: Ring, tolerance: float) -> Ring:
    """An outline with arcs in place of straight edges: all corners and the middles of all edges lie within the tolerance of them, mm.

    Each arc goes from a corner to another one through one between, and takes as many edges as it can. Edges that are no part
    of one stay as they are.
    """
    straight = ring.bulges == 0
    if np.count_nonzero(straight) < _LEAST_RUN:
        return ring
    ways = ring.ends - ring.points
    turn = np.abs(np.angle(ways * np.roll(ways, 1).conj()))
    # no arc goes past the sharpest corner, or the end of an arc
    first = int(np.argmax(np.where(straight & np.roll(straight, 1), turn, math.pi)))
    points = np.roll(ring.points, -first)
    bulges = np.roll(ring.bulges, -first)
    curved = np.append(np.flatnonzero(bulges), len(points))
    around = np.append(points, points[:1])
    kept = []
    bent = []
    k = 0
    while k < len(points):
        edge = int(curved[np.searchsorted(curved, k)])
        run = 1 if edge == k else _longest_arc(around[k : edge + 1], tolerance)
        kept.append(k)
        chosen = around[k : k + run + 1]
        bent.append(_bulge_through(chosen) if run > 1 else float(bulges[k]))
        k += run
    return Ring(points[kept], np.array(bent))


def _longest_arc(points: Points, tolerance: float) -> int:
    """How many edges from the first point on one arc takes, at least 1."""
    most = len(points) - 1
    works = 1
    fails = most + 1
    step = 2
    while step < fails and _lie_on_arc(points[: step + 1], tolerance):
        works = step
        step = min(2 * step, most) if step < most else fails
    fails = min(fails, step)
    while fails - works > 1:
        middle = (works + fails) // 2
        if _lie_on_arc(points[: middle + 1], tolerance):
            works = middle
        else:
            fails = middle
    return works


def _bulge_through(points: Points) -> float:
    """Of the arc from the first point to the last one through the one in the middle; 0 of a line."""
    via = points[len(points) // 2]
    half = cmath.phase((points[-1] - via) / (via - points[0]))
    return math.tan(half / 2) if abs(half) * _FLATTEST > 1 else 0.0


def _lie_on_arc(points: Points, tolerance: float) -> bool:
    """Whether corners and middles of edges are that near to the arc, one after the other along it."""
    chord = points[-1] - points[0]
    if not (abs(chord) > 0 and np.abs(np.diff(points)).min() > 0):
        return False
    bulge = _bulge_through(points)
    samples = np.concatenate([points, (points[1:] + points[:-1]) / 2])
    z = (samples - points[0]) / chord
    if bulge == 0.0:
        off = np.abs(z.imag) * abs(chord)
        along = z[: len(points)].real
    else:
        if 4 * abs(math.atan(bulge)) > _ARC_TURN:
            return False
        centre = 0.5 + 0.25j * (1 / bulge - bulge)
        radius = abs(centre)
        off = np.abs(np.abs(z - centre) - radius) * abs(chord)
        along = math.copysign(1.0, bulge) * np.angle((z[: len(points)] - centre) / -centre)
    return bool(off.max() <= tolerance and (np.diff(along) > 0).all())
