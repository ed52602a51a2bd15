"""Trimming of an envelope that crosses itself: loops removed at their exact crossing points.

The pieces run round the material with the material on the RIGHT. What a tip leaves standing where two of its passes
meet is a convex corner, so at a crossing the outline turns right: of the two ways to jump from one branch to the other
only one does, and that tells which stretch is cut away.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from camgen.errors import DesignError
from camgen.geometry.outlines import (
    Arc,
    Floats,
    Line,
    Piece,
    Points,
    Smooth,
    end_point,
    start_point,
)
from camgen.numerics import distinct
from camgen.tolerances import INTERSECTION, SAME_POINT

_EVEN = 384  # samples of a piece, evenly in its parameter
_GRADED = 1.3 ** -np.arange(
    4, 88
)  # samples crowding towards both ends: a loop there is of any size down to 1e-10
_GRAZING = 1e-5  # rad, neighbours that cross at less run on into each other; a loop turns by more than half a turn
_BETWEEN = 8  # samples from one knot of a piece to the next
_BLOCK = 16  # chords in one bounding box of the crossing search


@dataclass(frozen=True)
class Cut:
    """A stretch cut away between (piece, parameter) `start` and `end`, which meet at the point `at`."""

    at: complex
    start: tuple[int, float]
    end: tuple[int, float]


def trim(pieces: Sequence[Piece]) -> tuple[list[Piece], list[Cut]]:
    """The closed outline left of `pieces` (cyclic, material on the right), and what was cut away.

    Consecutive pieces may be apart where their ends are to be cut away. Raises DesignError where no closed outline is left.
    """
    cuts = _outermost(pieces, [_cut(pieces, *crossing) for crossing in _crossings(pieces)])
    outline: list[Piece] = []
    if not cuts:
        outline = list(pieces)
    for cut, following in zip(cuts, cuts[1:] + cuts[:1], strict=True) if cuts else ():
        first, t0 = cut.end
        last, t1 = following.start
        if first == last and _fraction(pieces[first], t0) < _fraction(pieces[first], t1):
            outline.append(part_between(pieces[first], t0, t1))
            continue
        outline.append(part_between(pieces[first], t0, pieces[first].t1))
        k = (first + 1) % len(pieces)
        while k != last:
            outline.append(pieces[k])
            k = (k + 1) % len(pieces)
        outline.append(part_between(pieces[last], pieces[last].t0, t1))
    size = max(abs(start_point(p)) for p in pieces)
    for here_piece, next_piece in zip(outline, outline[1:] + outline[:1], strict=True):
        gap = abs(end_point(here_piece) - start_point(next_piece))
        if gap > SAME_POINT * max(1.0, size):
            z = end_point(here_piece)
            raise DesignError(
                "gap left in the profile",
                gap,
                0.0,
                "mm",
                f"x {z.real:.3f}, y {z.imag:.3f} mm",
                "the tip cuts away more than the cam can lose: use a smaller tip or a smaller lift",
            )
    return outline, cuts


def _fraction(piece: Piece, t: float) -> float:
    return (t - piece.t0) / (piece.t1 - piece.t0)


def part_between(piece: Piece, t0: float, t1: float) -> Piece:
    """The part of a piece from one parameter to another."""
    if isinstance(piece, Arc):
        return Arc(piece.centre, piece.radius, t0, t1 - t0)
    if isinstance(piece, Line):
        return Line(complex(piece.at(t0)), complex(piece.at(t1)))
    return replace(piece, t0=t0, t1=t1)


def _cut(pieces: Sequence[Piece], i: int, ti: float, j: int, tj: float) -> Cut:
    into = complex(pieces[i].at(ti, 1)) * np.sign(pieces[i].t1 - pieces[i].t0)
    away = complex(pieces[j].at(tj, 1)) * np.sign(pieces[j].t1 - pieces[j].t0)
    at = complex(pieces[i].at(ti))
    turns_right = (into.conjugate() * away).imag < 0
    return Cut(at, (i, ti), (j, tj)) if turns_right else Cut(at, (j, tj), (i, ti))


def _outermost(pieces: Sequence[Piece], cuts: list[Cut]) -> list[Cut]:
    """Cuts that lie in no other cut, in the order of their starts; a cut may reach past the last piece into the first."""

    def place(mark: tuple[int, float]) -> float:
        return mark[0] + _fraction(pieces[mark[0]], mark[1])

    def inside(mark: tuple[int, float], cut: Cut) -> bool:
        at = place(mark)
        start = place(cut.start)
        end = place(cut.end)
        return start < at < end if start < end else at > start or at < end

    keep = []
    for cut in cuts:
        others = [c for c in cuts if c is not cut]
        if not any(inside(cut.start, c) and inside(cut.end, c) for c in others):
            keep.append(cut)
    return sorted(keep, key=lambda c: place(c.start))


def _samples(piece: Piece, least: float) -> tuple[Floats, Points]:
    """Parameters and points along a piece; those within `least` mm of an end are left out, for at a cusp they are rounding."""
    if isinstance(piece, Line):
        return np.array([piece.t0, piece.t1]), np.array([piece.a, piece.b])
    u = distinct(np.linspace(0, 1, _EVEN), _GRADED, 1 - _GRADED)
    t = piece.t0 + (piece.t1 - piece.t0) * u
    if isinstance(piece, Smooth) and piece.knots:  # a loop may lie between any two of them
        knots = piece.spread(2)
        between = (
            knots[:-1] + fraction * np.diff(knots)
            for fraction in np.linspace(0, 1, _BETWEEN, endpoint=False)
        )
        t = distinct(t, *between)[:: 1 if piece.t0 < piece.t1 else -1]
    z = piece.at(t)
    keep = np.minimum(np.abs(z - z[0]), np.abs(z - z[-1])) > least
    keep[[0, -1]] = True
    return t[keep], z[keep]


def _crossings(pieces: Sequence[Piece]) -> list[tuple[int, float, int, float]]:
    """All proper crossings (piece i, t, piece j, t) with i, t before j, t; residual below INTERSECTION."""
    least = 10 * INTERSECTION * max(1.0, *(abs(start_point(p)) for p in pieces))
    parameters, points = zip(*(_samples(p, least) for p in pieces), strict=True)
    a = np.concatenate([z[:-1] for z in points])
    b = np.concatenate([z[1:] for z in points])
    piece_of = np.concatenate([np.full(len(t) - 1, k) for k, t in enumerate(parameters)])
    chord_of = np.concatenate([np.arange(len(t) - 1) for t in parameters])
    crossings = []
    for i, j in zip(*_crossing_chords(a, b), strict=True):
        p = int(piece_of[i])
        q = int(piece_of[j])
        tp = parameters[p]
        tq = parameters[q]
        u, v = _chord_crossing(a[i], b[i], a[j], b[j])
        start = (
            tp[chord_of[i]] + u * (tp[chord_of[i] + 1] - tp[chord_of[i]]),
            tq[chord_of[j]] + v * (tq[chord_of[j] + 1] - tq[chord_of[j]]),
        )
        ti, tj = _newton(pieces[p], pieces[q], *start)
        apart = (q + _fraction(pieces[q], tj)) - (p + _fraction(pieces[p], ti))
        if min(apart, len(pieces) - apart) < 1e-9:
            continue  # a joint or one point found twice, not a crossing
        if _grazes(pieces, p, ti, q, tj):
            continue
        crossings.append((p, ti, q, tj))
    return crossings


def _grazes(pieces: Sequence[Piece], p: int, t: float, q: int, u: float) -> bool:
    """Whether two neighbours, run on smoothly into each other, only seem to cross at their joint, where rounding rules."""
    if (q - p) % len(pieces) not in (1, len(pieces) - 1):
        return False
    first, second = (
        pieces[k].at(s, 1) * np.sign(pieces[k].t1 - pieces[k].t0) for k, s in ((p, t), (q, u))
    )
    turn = complex(np.conj(first) * second)
    return turn.real > 0 and abs(turn.imag) < _GRAZING * turn.real


def _crossing_chords(a: Points, b: Points) -> tuple[Floats, Floats]:
    """Pairs (i < j) of chords a-b that properly cross, neighbours aside; boxes over blocks of chords find the candidates."""
    import shapely

    starts = np.arange(0, len(a), _BLOCK)

    def extremes(low: Floats, pick: np.ufunc) -> Floats:
        return np.asarray(pick.reduceat(low, starts))

    x0 = extremes(np.minimum(a.real, b.real), np.minimum)
    x1 = extremes(np.maximum(a.real, b.real), np.maximum)
    y0 = extremes(np.minimum(a.imag, b.imag), np.minimum)
    y1 = extremes(np.maximum(a.imag, b.imag), np.maximum)
    boxes = shapely.box(x0, y0, x1, y1)
    first, second = np.sort(shapely.STRtree(boxes).query(boxes), axis=0)
    first, second = np.divmod(distinct(first * len(boxes) + second), len(boxes))
    offsets = np.arange(_BLOCK)
    i = np.broadcast_to(
        (starts[first, None] + offsets)[:, :, None], (len(first), _BLOCK, _BLOCK)
    ).ravel()
    j = np.broadcast_to(
        (starts[second, None] + offsets)[:, None, :], (len(first), _BLOCK, _BLOCK)
    ).ravel()
    real = (j > i + 1) & (j < len(a))
    i = i[real]
    j = j[real]

    def side(p: Points, q: Points, z: Points) -> Floats:
        return np.imag(np.conj(q - p) * (z - p))

    cross = (side(a[i], b[i], a[j]) * side(a[i], b[i], b[j]) < 0) & (
        side(a[j], b[j], a[i]) * side(a[j], b[j], b[i]) < 0
    )
    return i[cross], j[cross]


def _chord_crossing(a: complex, b: complex, c: complex, d: complex) -> tuple[float, float]:
    """Fractions along a-b and c-d at which the two lines cross."""
    p = b - a
    q = d - c
    w = c - a
    determinant = (p.conjugate() * q).imag
    return (w.conjugate() * q).imag / determinant, (w.conjugate() * p).imag / determinant


def _newton(p: Piece, q: Piece, t: float, u: float) -> tuple[float, float]:
    """Parameters at which two pieces cross, from a start near by."""
    size = max(1.0, abs(complex(p.at(t))))
    for _ in range(50):
        gap = complex(q.at(u)) - complex(p.at(t))
        along_p = complex(p.at(t, 1))
        along_q = complex(q.at(u, 1))
        determinant = (along_p.conjugate() * along_q).imag
        if abs(gap) <= INTERSECTION * size * 0.01 or determinant == 0:
            break
        t += (gap.conjugate() * along_q).imag / determinant
        u += (gap.conjugate() * along_p).imag / determinant
    return _within(p, t), _within(q, u)


def _within(piece: Piece, t: float) -> float:
    low, high = sorted((piece.t0, piece.t1))
    return min(max(t, low), high)
