"""Closed forms of a round tip's contact with one element of an outline that turns, on an arm or a slide.

    ground      c(s)                            tip centre, s the follower's displacement
    part        p = c exp(-i theta)             the same point seen from the part, turned by theta about the origin
    offset      the outline moved out by the tip radius; the tip touches the outline when p lies on it
    progress    what grows as the follower comes in; the least of all elements' is the first touch

Coming in from its far end the tip centre passes each distance |p| from the origin once, so every point p of the
offset is met at one cam angle alone, theta(p) = arg c(|p|) - arg p, and each element of the offset covers a known
interval of theta, from which the table of `contact` is made. Offset curves that lie inside the true offset (at concave
corners) need no trimming: they are met later.

One formula serves edges, arcs and corners. An element through p with outward normal n and curvature k (0 for
an edge, negative where concave) is k|c|^2 - 2 Re(conj(B) c) + C = 0 with B = k p - n, C = k|p|^2 - 2 Re(conj(n) p).

On an arm, pivot on the real axis, c = L + R exp(i psi); with E = k L - B exp(i theta)

    |E| cos(psi - arg E) = (2 L Re(B exp(i theta)) - C - k (L^2 + R^2)) / 2R

and psi grows as the tip comes in. The root psi = arg E + arccos(...) is the one with a pressure angle below 90 deg,
where the tip enters the part; at 90 deg theta turns back along the element. On a slide along the real axis, c = x + i e,

    k x^2 - 2 Re(B exp(i theta)) x + (k e^2 + C - 2 e Im(B exp(i theta))) = 0

and the root is the one with k x - Re(B exp(i theta)) > 0. Elements are cut at 90 deg, the side on which the tip would
leave the part is dropped, so that no root has to be tried on an element which it does not belong to.

`inside`: the tip comes from within, outwards to the wall of a groove; then the other roots and the other sides count.
"""

from __future__ import annotations

import cmath
import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from camgen.geometry.rings import Floats, Ints, Points, Ring
from camgen.tolerances import SAME_POINT

_TURN = 2 * math.pi


@dataclass(frozen=True)
class Cover:
    """Pieces of an outline by the cam angle at which they are touched: least angle, width, row of the closed form, element."""

    low: Floats
    width: Floats
    rows: Floats
    source: Ints


class Form(Protocol):
    """What the table needs to know of a follower; u is the cam angle in the form's own frame, 0 to 2 pi."""

    def cover(self, ring: Ring) -> Cover:
        """The pieces that the follower can touch as it comes in; a row of nan blocks it."""

    def turned(self, theta: Floats) -> Floats:
        """u from the cam angle."""

    def progress(self, u: Floats, rows: Floats) -> Floats:
        """How far the follower comes in until it touches the pieces of these rows, one for each u."""

    def displacement(self, progress: Floats) -> Floats:
        """s, rad or mm."""

    def normal(self, u: Floats, progress: Floats, rows: Floats) -> Points:
        """Outward contact normal over the direction in which the follower's surface moves off the part there, (n,)."""

    def place(self, u: Floats, progress: Floats, rows: Floats) -> Floats:
        """Where along a face it is touched, mm, (n,); nan for a tip."""


def wrapped(u: Floats) -> Floats:
    """The same angle from 0 to 2 pi."""
    return np.asarray(u - _TURN * np.floor(u * (1 / _TURN)))


def cos_sin(u: Floats) -> tuple[Floats, Floats]:
    """Cosine and sine."""
    t = np.tan(u / 2)  # numpy's tan is many times as fast as its sin and cos, and as accurate here
    t2 = t * t
    weight = 1 / (1 + t2)
    return (1 - t2) * weight, 2 * t * weight


@dataclass(frozen=True)
class _Elements:
    """Pieces of the offset outline, run with the material on their left, in the frame of the closed form.

    start, end: points; normal: outward unit normal at the start; sweep: turn of the normal, rad; source: ring element.
    """

    start: Points
    end: Points
    normal: Points
    sweep: Floats
    source: Ints

    @cached_property
    def length(self) -> Floats:
        return np.asarray(np.abs(self.end - self.start) / np.sinc(self.sweep / _TURN))

    @cached_property
    def curvature(self) -> Floats:
        return self.sweep / self.length

    def at(self, share: Floats | float) -> Points:
        """Points at the given share of the length; exact for lines and arcs of any radius."""
        half = share * self.sweep / 2
        chord = self.length * share * np.sinc(half / np.pi)
        return np.asarray(self.start + 1j * self.normal * np.exp(1j * half) * chord)

    def share(self, p: Points) -> Floats:
        """Share of the length at which p, a point of the element or of its continuation, lies; outside 0..1 off it."""
        chord = (p - self.start) * np.conj(1j * self.normal)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(np.abs(chord) / (self.length * np.sinc(np.angle(chord) / np.pi)))

    def take(self, index: Ints) -> _Elements:
        return _Elements(*(getattr(self, name)[index] for name in self.__dataclass_fields__))

    def join(self, other: _Elements) -> _Elements:
        pairs = ((getattr(self, name), getattr(other, name)) for name in self.__dataclass_fields__)
        return _Elements(*(np.concatenate(pair) for pair in pairs))

    def part(self, first: Floats, last: Floats) -> _Elements:
        """The pieces between two shares of each element."""
        start = np.where(first == 0, self.start, self.at(first))
        end = np.where(last == 1, self.end, self.at(last))
        normal = self.normal * np.exp(1j * first * self.sweep)
        return _Elements(start, end, normal, self.sweep * (last - first), self.source)

    def turned(self) -> Floats:
        """Change of arg p along each element, rad, exact also where an arc goes round the origin."""
        change = np.angle(self.end * np.conj(self.start))
        spoke = self.normal - self.curvature * self.start  # minus centre times curvature
        round_it = np.flatnonzero((np.abs(spoke) < 1) & (self.sweep != 0))
        n0 = self.normal[round_it]
        n1 = self.normal[round_it] * np.exp(1j * self.sweep[round_it])
        eccentric = -spoke[round_it]
        change[round_it] = (
            self.sweep[round_it]
            + np.angle(1 + eccentric * np.conj(n1))
            - np.angle(1 + eccentric * np.conj(n0))
        )
        return change


def _offset(ring: Ring, radius: float) -> _Elements:
    """The outline moved out by the tip radius: edges, and an arc about each convex corner.

    An arc that is concave with less than the tip radius has no offset: the tip cannot reach it. One with the tip radius
    itself, such as the fillet in which the tip rests, has a single point, and its neighbours end there.
    """
    count = len(ring.points)
    edge = np.flatnonzero(ring.ends != ring.points)
    a = ring.points[edge]
    b = ring.ends[edge]
    bulge = ring.bulges[edge]
    chord = np.abs(b - a)
    half_turn = (1 + 1j * bulge) ** 2 / (1 + bulge**2)  # exp(i sweep / 2)
    across = -1j * (b - a) / chord
    first = across / half_turn
    last = across * half_turn
    curvature = 4 * bulge / (1 + bulge**2) / chord
    open_to_tip = np.flatnonzero(1 + radius * curvature > SAME_POINT)
    edges = _Elements(
        a + radius * first, b + radius * last, first, 4 * np.arctan(bulge), edge
    ).take(open_to_tip)
    following = np.roll(first, -1)
    turn = np.angle(following * np.conj(last))
    start = b + radius * last
    end = b + radius * following
    corner = np.flatnonzero((turn > 0) & (start != end))
    corners = _Elements(start, end, last, turn, count + edge).take(corner)
    return edges.join(corners)


def _level(e: _Elements) -> tuple[Points, Floats]:
    """B and C of each element."""
    k = e.curvature
    return k * e.start - e.normal, k * np.abs(e.start) ** 2 - 2 * np.real(
        np.conj(e.normal) * e.start
    )


def _at_distance(e: _Elements, squared: Floats | float) -> list[tuple[Ints, Points]]:
    """Both points of the elements, or of their continuations, at a distance from the origin given by its square."""
    b, c = _level(e)
    size = np.maximum(np.abs(b), 1e-300)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        r = np.sqrt(np.broadcast_to(squared, size.shape))
        x = (e.curvature * r**2 + c) / (2 * r * size)
    at = np.flatnonzero(np.abs(x) < 1)
    place = r[at] * b[at] / size[at]
    return [(at, place * (x[at] + 1j * sign * np.sqrt(1 - x[at] ** 2))) for sign in (1, -1)]


def _shares(e: _Elements, points: list[tuple[Ints, Points]]) -> tuple[Ints, Floats]:
    """Elements to be cut and the share of the length at which, in no order, 0 < share < 1."""
    index = np.concatenate([at for at, _ in points])
    p = np.concatenate([p for _, p in points])
    near = np.flatnonzero(
        np.abs(p - e.start[index]) < e.length[index]
    )  # spares most of them the next step
    index = index[near]
    share = e.take(index).share(p[near])
    inside = np.flatnonzero((share > 0) & (share < 1))
    return index[inside], share[inside]


def parts_of(count: int, index: Ints, share: Floats) -> tuple[Ints, Ints, Floats, Floats]:
    """Elements that stay whole; and of those that are cut, piece by piece, the element and the shares it runs between."""
    whole = np.ones(count, bool)
    whole[index] = False
    broken = np.flatnonzero(~whole)
    index = np.concatenate([broken, index, broken])
    share = np.concatenate([np.zeros(len(broken)), share, np.ones(len(broken))])
    order = np.lexsort((share, index))
    index = index[order]
    share = share[order]
    inner = np.flatnonzero(np.diff(index) == 0)
    return np.flatnonzero(whole), index[inner], share[inner], share[inner + 1]


def _cut(e: _Elements, cuts: tuple[Ints, Floats]) -> _Elements:
    plain, index, first, last = parts_of(len(e.start), *cuts)
    pieces = e.take(index).part(first, last)
    return e.take(plain).join(
        pieces.take(np.flatnonzero(pieces.start != pieces.end))
    )  # cuts beside each other may be one


class _RoundTip(ABC):
    """What a tip on an arm and one on a slide share."""

    inside: bool

    @property
    def _sign(self) -> int:
        return -1 if self.inside else 1

    @abstractmethod
    def _bearing(self, r: Floats) -> Floats:
        """arg c of the tip centre at distance r from the origin."""

    def _pieces(
        self, whole: _Elements, cuts: tuple[Ints, Floats]
    ) -> tuple[_Elements, Floats, Floats, Floats]:
        """The elements cut; of each piece least cam angle and width, rad, and how far its middle is from the origin, mm."""
        pieces = _cut(whole, cuts)
        first, last = (self._bearing(np.abs(p)) for p in (pieces.start, pieces.end))
        turn = pieces.turned()
        edge = (
            first - np.angle(pieces.start) if self.inside else last - np.angle(pieces.start) - turn
        )
        return pieces, edge, self._sign * (first - last + turn), np.abs(pieces.at(0.5))

    def place(self, u: Floats, progress: Floats, rows: Floats) -> Floats:
        """None."""
        return np.full(u.shape, np.nan)


@dataclass(frozen=True)
class ArmTip(_RoundTip):
    """Tip centre = pivot + arm * exp(i s), s in rad; rows are k L, Re B, Im B, (C + k (L^2 + R^2)) / 2R."""

    pivot: complex
    arm: complex
    tip_radius: float
    leaves: int
    inside: bool = False

    def __post_init__(self) -> None:
        product = abs(self.pivot) * abs(self.arm)
        side = (self.arm * complex(self.pivot).conjugate()).imag
        if not (
            math.isfinite(product)
            and product > 0
            and math.isfinite(self.tip_radius)
            and self.tip_radius >= 0
        ):
            raise ValueError(
                f"no contact for pivot {self.pivot}, arm {self.arm}, tip radius {self.tip_radius}"
            )
        if self.leaves not in (-1, 1) or side * self.leaves > 0:
            raise ValueError(
                f"turning the arm in the sense {self.leaves} does not take the tip away from the origin"
            )

    def cover(self, ring: Ring) -> Cover:
        """Pieces within the ring that the tip centre can reach, |L - R| to L + R from the origin.

        What lies beyond L + R is kept, as if at that distance: it blocks the tip.
        """
        L = abs(self.pivot)
        R = abs(self.arm)
        e = _offset(ring, self.tip_radius)
        if self.leaves > 0:
            # Pivot on the real axis and arm above it, mirrored (and so run back); theta takes up the pivot's direction.
            e = _Elements(
                np.conj(e.end),
                np.conj(e.start),
                np.conj(e.normal * np.exp(1j * e.sweep)),
                e.sweep,
                e.source,
            )
        pieces, edge, width, middle = self._pieces(e, self._cuts(e))
        touchable = np.flatnonzero((width > 0) & (middle > abs(L - R)))
        pieces = pieces.take(touchable)
        k = pieces.curvature
        p = pieces.start
        n = pieces.normal
        b = k * p - n
        level = (k * (np.abs(p) ** 2 + L**2 + R**2) - 2 * np.real(np.conj(n) * p)) / (2 * R)
        rows = np.column_stack([k * L, b.real, b.imag, level])
        if not self.inside:
            rows[middle[touchable] > L + R] = np.nan
        return Cover(edge[touchable], width[touchable], rows, pieces.source)

    def _bearing(self, r: Floats) -> Floats:
        """arg c of the tip centre at distance r from the origin, 0..pi, by half the angle at O of the triangle O, A, c.

        Half-angle form, so that neither a flat triangle nor a pivot far off costs digits.
        """
        L = abs(self.pivot)
        R = abs(self.arm)
        r = np.clip(r, abs(L - R), L + R)
        opposite = np.maximum((r + (R - L)) * (R + L - r), 0.0)
        adjacent = np.maximum((r - (R - L)) * (L + R + r), 0.0)
        return np.asarray(2 * np.arctan2(np.sqrt(opposite), np.sqrt(adjacent)))

    def _cuts(self, e: _Elements) -> tuple[Ints, Floats]:
        L = abs(self.pivot)
        R = abs(self.arm)
        k = e.curvature
        b, c = _level(e)
        size = np.maximum(np.abs(b), 1e-300)
        cuts = [*_at_distance(e, (L + R) ** 2), *_at_distance(e, (L - R) ** 2)]
        # 90 deg: the arm lies along the normal, so the pivot, L from the origin, is at distance d = +-R from the element:
        # k|P|^2 - 2 Re(conj(B) P) + C = 2 d + k d^2. Of the two such P one has the arm on the right side.
        for d in (R, -R):
            x = (k * (L**2 - R**2) + c - 2 * d) / (2 * L * size)
            at = np.flatnonzero(np.abs(x) < 1)
            stretch = 1 + k[at] * d
            y = -np.sign(d * stretch) * np.sqrt(1 - x[at] ** 2)
            p = L * b[at] / size[at] * (x[at] + 1j * y)
            with np.errstate(divide="ignore", invalid="ignore"):
                cuts.append((at, p - d * (k[at] * p - b[at]) / stretch))
        return _shares(e, cuts)

    def turned(self, theta: Floats) -> Floats:
        """Pivot on the real axis, arm in the upper half plane."""
        return wrapped(-self.leaves * (theta - cmath.phase(self.pivot)))

    def progress(self, u: Floats, rows: Floats) -> Floats:
        """psi, or -psi from inside."""
        ex, ey, cosine = self._terms(u, rows)
        if not self.inside:
            return np.asarray(np.arctan2(ey, ex) + np.arccos(cosine))
        psi = np.arctan2(ey, ex) - np.arccos(cosine)
        return np.asarray(-np.where(psi < -1e-9, psi + _TURN, psi))

    def _terms(self, u: Floats, rows: Floats) -> tuple[Floats, Floats, Floats]:
        """Re E, Im E and cos(psi - arg E)."""
        cosine, sine = cos_sin(u)
        bx = rows[:, 1]
        by = rows[:, 2]
        across = bx * cosine - by * sine
        ex = rows[:, 0] - across
        ey = -(bx * sine + by * cosine)
        level = across * (abs(self.pivot) / abs(self.arm)) - rows[:, 3]
        # Rounding may carry the quotient past 1 only where the pressure angle is 90 deg.
        return ex, ey, np.minimum(np.maximum(level / np.sqrt(ex * ex + ey * ey), -1.0), 1.0)

    def displacement(self, progress: Floats) -> Floats:
        """The arm's angle."""
        return np.asarray(
            -self.leaves * (self._sign * progress - abs(cmath.phase(self.arm / self.pivot)))
        )

    def normal(self, u: Floats, progress: Floats, rows: Floats) -> Points:
        """E + k R exp(i psi), over -i exp(i psi) along which the tip leaves."""
        ex, ey, _ = self._terms(u, rows)
        psi = self._sign * progress
        normal = (ex + 1j * ey) * np.exp(-1j * psi) + rows[:, 0] * (abs(self.arm) / abs(self.pivot))
        direction = self._sign * 1j * normal
        return np.asarray(np.conj(direction) if self.leaves > 0 else direction)


class OnSlide:
    """What tip and face on a slide share: through start + along * s, complex mm and unit vector; leaves: sense off the part."""

    start: complex
    along: complex
    leaves: int

    @property
    def _ahead(self) -> complex:
        return self.leaves * complex(self.along)

    @property
    def _begin(self) -> complex:
        """x + i e at s = 0."""
        return self.start * self._ahead.conjugate()

    def turned(self, theta: Floats) -> Floats:
        """The slide's way off the part along the real axis."""
        return wrapped(theta - cmath.phase(self._ahead))


@dataclass(frozen=True)
class SlideTip(OnSlide, _RoundTip):
    """Tip centre = start + along * s, along a unit vector, s in mm; rows are k, Re B, Im B, C + k e^2."""

    start: complex
    along: complex
    tip_radius: float
    leaves: int
    inside: bool = False

    def __post_init__(self) -> None:
        if not (
            cmath.isfinite(self.start) and math.isfinite(self.tip_radius) and self.tip_radius >= 0
        ):
            raise ValueError(f"no contact for start {self.start}, tip radius {self.tip_radius}")
        if self.leaves not in (-1, 1) or not abs(abs(self.along) - 1) < 1e-9:
            raise ValueError(f"no slide along {self.along} that leaves in the sense {self.leaves}")

    def cover(self, ring: Ring) -> Cover:
        """Pieces farther from the origin than the slide; on its way in the tip stops beside the origin."""
        offset = self._begin.imag
        e = _offset(ring, self.tip_radius)
        _, c = _level(e)
        cuts = _at_distance(e, offset**2) if offset else []
        for way in (
            (offset, -offset) if offset else (0.0,)
        ):  # 90 deg: the tangent is as far from the origin as the slide
            with np.errstate(divide="ignore", invalid="ignore"):
                cuts += _at_distance(e, (c + 2 * way) / e.curvature)  # below 0 there is none
        pieces, edge, width, middle = self._pieces(e, _shares(e, cuts))
        touchable = np.flatnonzero((width > 0) & (middle > abs(offset)))
        pieces = pieces.take(touchable)
        b, c = _level(pieces)
        k = pieces.curvature
        rows = np.column_stack([k, b.real, b.imag, c + k * offset**2])
        return Cover(edge[touchable], width[touchable], rows, pieces.source)

    def _bearing(self, r: Floats) -> Floats:
        offset = self._begin.imag
        return np.asarray(np.arctan2(offset, np.sqrt(np.maximum((r - offset) * (r + offset), 0.0))))

    def _terms(self, u: Floats, rows: Floats) -> tuple[Floats, Floats, Floats]:
        """Re and Im of B exp(i theta), and k x - Re(B exp(i theta))."""
        cosine, sine = cos_sin(u)
        k, bx, by, level = rows.T
        x = bx * cosine - by * sine
        y = bx * sine + by * cosine
        return (
            x,
            y,
            self._sign * np.sqrt(np.maximum(x * x - k * (level - 2 * self._begin.imag * y), 0.0)),
        )

    def progress(self, u: Floats, rows: Floats) -> Floats:
        """-x, or x from inside."""
        bx, by, root = self._terms(u, rows)
        k = rows[:, 0]
        level = rows[:, 3] - 2 * self._begin.imag * by
        opposite = (
            bx * self._sign <= 0
        )  # of the two forms the one without a difference of like numbers
        with np.errstate(divide="ignore", invalid="ignore"):
            x = np.where(opposite, level / (bx - root), (bx + root) / k)
        return np.asarray(-self._sign * x)

    def displacement(self, progress: Floats) -> Floats:
        """The way along the slide."""
        return np.asarray(self.leaves * (-self._sign * progress - self._begin.real))

    def normal(self, u: Floats, progress: Floats, rows: Floats) -> Points:
        """k c - B exp(i theta), over the slide's way off the wall."""
        _, by, root = self._terms(u, rows)
        return np.asarray(self._sign * (root + 1j * (rows[:, 0] * self._begin.imag - by)))
