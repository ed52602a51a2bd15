"""Facets: the fewest straight edges that stay within a tolerance of an exact outline.

    facet       chord between two points of a piece; its sagitta is the curve's largest distance from it
    share       what a stretch of curve adds to the number of facets (or arcs, in `arcfit`); shares add up,
                so their sum over a piece is the least number, and equal shares are the best spacing

A facet of length ds on curvature kappa has the sagitta kappa ds^2 / 8, hence the share sqrt(|kappa| / (8 tolerance)) ds
and the least number of vertices on a contour, the integral of that.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from camgen.geometry.outlines import Arc, Contour, Floats, Line, Piece, Points, Smooth
from camgen.numerics import distinct, from_zero, roots

# (turn of the tangent, length, change of curvature) of many short panels -> their shares.
ShareLaw = Callable[[Floats, Floats, Floats], Floats]

# A panel is halved until that changes its share by less than this part of the whole: the sum is then good to 1e-5.
_PANEL_ERROR = 1e-6
# ... and until its tangent turns by less than this, rad: a spike of curvature between two nodes shows in the tangent.
_PANEL_TURN = 0.2
# Rounding of a tangent's angle, rad, and of a curvature, relative: smaller differences are noise and count as none.
_TURN_NOISE = 1e-15
_CURVATURE_NOISE = 1e-12
# Newton stops after a step of this part of the bracket; being quadratic it has then reached the square of it.
LAST_STEP = 1e-4
# Times the ends are spread again before one more is granted, at most and at least: where deviation loses its leading
# term (at an inflection) the error only halves each time, elsewhere two are enough.
_ROUNDS = 16
_LEAST_ROUNDS = 4
# Times a stretch that is off is halved where spreading does not settle; what is off after these is rounding.
_HALVINGS = 12
# The stationary points leave this much of a sagitta unsaid.
_SPARE = 1e-7


def cross(a: Points, b: Points) -> Floats:
    """Cross product of plane vectors; > 0 where b lies to the left of a."""
    return np.asarray(a.real * b.imag - a.imag * b.real)


def dot(a: Points, b: Points) -> Floats:
    """Scalar product of plane vectors."""
    return np.asarray(a.real * b.real + a.imag * b.imag)


class Track:
    """A smooth piece (t0 < t1) on panels fine enough for its shares; a turn of `turn_limit` rad is a share of one.

    t: (m + 1,) nodes; share: (m,) of the panels; cuts: parameters at which curvature changes its sign or the tangent
    has turned by about another radian, so that between two cuts the tangent turns one way and by less than pi / 2.
    Raises ValueError for a piece without length or with a point that has no tangent.
    """

    def __init__(self, piece: Smooth, law: ShareLaw, turn_limit: float = math.inf) -> None:
        """Panels are halved until their shares settle."""
        if not piece.t0 < piece.t1:
            raise ValueError(f"piece without length at t = {piece.t0:.6g}")
        self.piece = piece
        self.turn_limit = turn_limit
        t = piece.spread(257)
        nodes = self._nodes(t)
        turn, share = self._panels(nodes, law)
        rough = np.arange(share.size)
        while rough.size:
            middle = (t[rough] + t[rough + 1]) / 2
            whole = share[rough]
            t = np.insert(t, rough + 1, middle)
            nodes = np.insert(nodes, rough + 1, self._nodes(middle), axis=1)
            turn, share = self._panels(nodes, law)
            first_half = rough + np.arange(rough.size)
            change = np.abs(share[first_half] + share[first_half + 1] - whole)
            again = (change > _PANEL_ERROR * max(1.0, share.sum())) | (
                turn[first_half] + turn[first_half + 1] > _PANEL_TURN
            )
            again &= np.diff(t)[first_half] > 1e-13 * (piece.t1 - piece.t0)
            rough = np.sort(np.concatenate([first_half[again], first_half[again] + 1]))
        self.t = t
        self.share = share
        self.turned = from_zero(turn)
        kappa = nodes[2].real
        flips = np.flatnonzero(kappa[:-1] * kappa[1:] < 0)
        radians = np.floor(self.turned[1:])
        turns = t[1:-1][radians[:-1] < radians[1:]]
        zeros = roots(
            lambda s, _: (self._bend(s), np.zeros(s.size)), t[flips], t[flips + 1], LAST_STEP
        )
        flat = (kappa[1:-1] == 0) & ((kappa[:-2] != 0) | (kappa[2:] != 0))
        self.cuts = distinct(zeros, t[1:-1][flat], turns)

    def _nodes(self, t: Floats) -> Points:
        """Rows point, derivative, curvature."""
        dz = self.piece.at(t, 1)
        with np.errstate(divide="ignore", invalid="ignore"):
            kappa = cross(dz, self.piece.at(t, 2)) / np.abs(dz) ** 3
        if not np.all(np.isfinite(kappa)):
            raise ValueError(
                f"piece has no tangent at t = {t[~np.isfinite(kappa)][0]:.6g}, or no length"
            )
        return np.array([self.piece.at(t), dz, kappa])

    def _bend(self, t: Floats) -> Floats:
        return cross(self.piece.at(t, 1), self.piece.at(t, 2))

    def _panels(self, nodes: Points, law: ShareLaw) -> tuple[Floats, Floats]:
        """Turn of the tangent over each panel, rad >= 0, and the panel's share."""
        z = nodes[0]
        dz = nodes[1]
        kappa = nodes[2].real
        turn = np.maximum(np.abs(np.angle(dz[1:] * np.conj(dz[:-1]))) - _TURN_NOISE, 0)
        change = np.maximum(np.abs(np.diff(kappa)) - _CURVATURE_NOISE * np.abs(kappa[1:]), 0)
        return turn, np.maximum(law(turn, np.abs(np.diff(z)), change), turn / self.turn_limit)

    def even(self, n: int) -> Floats:
        """Ends of n stretches of equal share, (n + 1,)."""
        return _spread(self.t, self.share, n)

    def least_share(self, t: Floats) -> Floats:
        """What the turn asks of the stretches between the ends t (n + 1,); (n,)."""
        return np.asarray(np.diff(np.interp(t, self.t, self.turned)) / self.turn_limit)


def _spread(t: Floats, share: Floats, n: int) -> Floats:
    """Ends of n stretches of equal share when those between the given ends have `share`, (n + 1,)."""
    sums = from_zero(share)
    if sums[-1] == 0:
        return np.linspace(t[0], t[-1], n + 1)
    even = np.interp(np.linspace(0, sums[-1], n + 1), sums, t)
    even[0] = t[0]
    even[-1] = t[-1]
    return even


def fewest(
    track: Track, deviation: Callable[[Floats], Floats], tolerance: float, power: float
) -> Floats:
    """Ends (n + 1,) of the fewest stretches whose deviation(ends), (n,) mm, is nowhere above the tolerance.

    Deviation goes with the (1 / power)th power of a stretch's share, so the measured ones tell the true shares and
    the ends are spread again; n is raised where the measured shares do not fit into it, or after _ROUNDS rounds. A curve
    with waves finer than its stretches has no such power: there those that are off are halved, a few more than the fewest.
    Raises ValueError where rounding hides the tolerance.
    """
    n = max(1, math.ceil(track.share.sum()))
    rounds = 0
    t = track.even(n)
    for attempt in range(10 * _ROUNDS):
        deviations = deviation(t)
        if deviations.max() <= tolerance:
            return t
        share = np.maximum((deviations / tolerance) ** power, track.least_share(t))
        rounds += 1
        if rounds == _ROUNDS or (rounds >= _LEAST_ROUNDS and share.sum() > n):
            # One at a time; faster where rounding blurs very many.
            n = n + 1 + n * attempt // 1_000_000
            rounds = 0
        t = _spread(t, share, n)
    for _ in range(_HALVINGS):
        deviations = deviation(t)
        off = np.flatnonzero(deviations > tolerance)
        if not off.size:
            return t
        t = np.insert(t, off + 1, (t[off] + t[off + 1]) / 2)
    raise ValueError(
        f"no {t.size - 1} stretches keep within {tolerance:.3g} mm; rounding leaves {deviations.max():.3g} mm"
    )


def _facet_law(tolerance: float) -> ShareLaw:
    return lambda turn, length, _: np.sqrt(turn * length / (8 * tolerance))


def sagittas(track: Track, t: Floats) -> Floats:
    """Largest distance of the curve from each chord between the ends t (n + 1,); (n,) mm.

    Between two cuts the tangent is parallel to the chord at most once, and there lies the only extreme.
    A facet that the curve overhangs at an end (its tangent turns back) is charged the overhang too.
    """
    piece = track.piece
    z = piece.at(t)
    chord = np.diff(z)
    size = np.abs(chord)
    along = np.where(size > 0, chord / np.where(size > 0, size, 1), 1)
    edges = distinct(t, track.cuts)
    chord_of = np.clip(np.searchsorted(t, edges[:-1], "right") - 1, 0, size.size - 1)
    tangents = piece.at(edges, 1)

    def extremes(axis: Points, spans: NDArray[np.intp]) -> tuple[NDArray[np.intp], Points]:
        """Places (from the facet's start, in its frame) where the curve runs square to the axis of its span's facet."""
        turns = dot(axis[spans], tangents[spans]) * dot(axis[spans], tangents[spans + 1]) <= 0
        spans = spans[turns]
        square = axis[spans]

        def g(s: Floats, i: NDArray[np.intp]) -> tuple[Floats, Floats]:
            return dot(square[i], piece.at(s, 1)), dot(square[i], piece.at(s, 2))

        facet = chord_of[spans]
        s = roots(g, edges[spans], edges[spans + 1], LAST_STEP)
        return facet, (piece.at(s) - z[facet]) * np.conj(along[facet])

    u = along[chord_of]
    facet, place = extremes(1j * u, np.arange(chord_of.size))
    height = np.zeros(size.size)
    np.maximum.at(height, facet, np.abs(place.imag))

    back = np.flatnonzero((dot(u, tangents[:-1]) <= 0) | (dot(u, tangents[1:]) <= 0))
    if back.size:
        overhang = np.zeros(size.size)
        facet, place = extremes(u, back)
        for owner, where in (
            (facet, place),
            (chord_of[back], (piece.at(edges[back]) - z[chord_of[back]]) * np.conj(u[back])),
        ):
            np.maximum.at(overhang, owner, np.maximum(-where.real, where.real - size[owner]))
        height = np.hypot(height, overhang)
    return height * (1 + _SPARE)


def _facets_of_arc(radius: float, sweep: float, tolerance: float) -> int:
    """Least number of chords: sagitta r (1 - cos(half)) <= tolerance, and at least three on a full circle."""
    half = min(2 * math.asin(math.sqrt(min(1.0, tolerance / (2 * radius)))), math.pi / 3)
    return max(1, math.ceil(abs(sweep) / (2 * half)))


def facet(piece: Piece, tolerance: float) -> Floats:
    """Parameters (n + 1,), from t0 to t1, of the fewest points whose chords keep within `tolerance` mm of the piece.

    Raises ValueError for a piece without length and for a tolerance that is not positive.
    """
    if not 0 < tolerance < math.inf:
        raise ValueError(f"tolerance is {tolerance} mm, must be positive")
    if isinstance(piece, Line):
        if piece.a == piece.b:
            raise ValueError(f"line without length at {piece.a:.6g}")
        return np.array([0.0, 1.0])
    if isinstance(piece, Arc):
        if not (piece.radius > 0 and piece.sweep):
            raise ValueError(f"arc without length about {piece.centre:.6g}")
        return np.linspace(
            piece.t0, piece.t1, _facets_of_arc(piece.radius, piece.sweep, tolerance) + 1
        )
    if piece.t1 < piece.t0:
        return facet(piece.reversed(), tolerance)[::-1]
    key = (piece.t0, piece.t1, tolerance)
    if (
        key not in piece.known
    ):  # always found on the curve itself, so that it does not matter which image asks first
        track = Track(
            replace(piece.origin, t0=piece.t0, t1=piece.t1) if piece.origin else piece,
            _facet_law(tolerance),
        )
        piece.known[key] = fewest(track, lambda t: sagittas(track, t), tolerance, 1 / 2)
        piece.known[key].setflags(write=False)
    return piece.known[key]


def facet_contour(contour: Contour, tolerance: float) -> Points:
    """Inscribed polygon within `tolerance` mm of the contour: its vertices (n,), the first not repeated, n >= 3.

    Vertices lie on the contour, joints among them.
    """
    if all(isinstance(piece, Line) for piece in contour.pieces) and len(contour.pieces) < 3:
        raise ValueError("fewer than three straight lines enclose nothing")
    ring = np.concatenate([piece.at(facet(piece, tolerance)[:-1]) for piece in contour.pieces])
    return ring if ring.size >= 3 else facet_contour(contour, tolerance / 2)


def facet_circle(centre: complex, radius: float, tolerance: float, outside: bool = False) -> Points:
    """Regular polygon (n,) within `tolerance` mm of a circle, counter-clockwise from its rightmost point.

    Inscribed; or circumscribed (`outside`), for a bore that must not come out small.
    """
    if not (tolerance > 0 and radius > 0):
        raise ValueError(f"radius {radius} mm and tolerance {tolerance} mm must be positive")
    # A polygon about r is one inscribed in r / cos(pi / n), which may be at most r + tolerance.
    n = _facets_of_arc(radius + tolerance if outside else radius, 2 * math.pi, tolerance)
    reach = radius / math.cos(math.pi / n) if outside else radius
    return np.asarray(centre + reach * np.exp(2j * math.pi * np.arange(n) / n))


def reach(contour: Contour) -> float:
    """About how far a contour reaches across, mm: by some of its points."""
    z = np.concatenate([piece.at(np.linspace(piece.t0, piece.t1, 9)) for piece in contour.pieces])
    return float(max(np.ptp(z.real), np.ptp(z.imag)))


def theoretical_vertices(contour: Contour, tolerance: float) -> float:
    """Least number of vertices of an inscribed polygon, the integral of sqrt(|kappa| / (8 tolerance)) ds."""

    def least(piece: Piece) -> float:
        if isinstance(piece, Line):
            return 0.0
        if isinstance(piece, Arc):
            return abs(piece.sweep) * math.sqrt(piece.radius / (8 * tolerance))
        forward = piece if piece.t0 < piece.t1 else piece.reversed()
        return float(Track(forward, _facet_law(tolerance)).share.sum())

    return sum(least(piece) for piece in contour.pieces)
