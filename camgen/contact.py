"""A round tip on a swinging arm against a closed outline that turns: the arm's angle at first touch.

    ground      c = A + a exp(i s)              tip centre; pivot A, arm a, follower angle s
    part        p = c exp(-i theta)             the same point seen from the part, turned by theta about the origin
    offset      the outline moved out by the tip radius; the tip touches the outline when p lies on it

Coming in from its far end the tip centre passes each distance |p| from the origin once, so every point p of the
offset is met at one cam angle alone,

    theta(p) = arg c(|p|) - arg p               (triangle O, A, c)

and each element of the offset covers a known interval of theta. Those intervals, sorted once, make a table; a query
looks its angle up and evaluates one closed form for each element that covers it, mostly one; the first touch wins.
Offset curves that lie inside the true offset (at concave corners) need no trimming: they are met later.

One formula serves edges, arcs and corners. An element through p with outward normal n and curvature k (0 for an edge,
negative where concave) is k|c|^2 - 2 Re(conj(B) c) + C = 0 with B = k p - n, C = k|p|^2 - 2 Re(conj(n) p). With the
pivot on the real axis, c = L + R exp(i psi), and E = k L - B exp(i theta) this is

    |E| cos(psi - arg E) = (2 L Re(B exp(i theta)) - C - k (L^2 + R^2)) / 2R

and psi grows as the tip comes in. The root psi = arg E + arccos(...) is the one with a pressure angle below 90 deg,
where the tip enters the part; at 90 deg theta turns back along the element. Elements are cut there, the side on which
the tip would leave the part is dropped, so that no root has to be tried on an element which it does not belong to.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from camgen.rings import Floats, Ints, Points, Ring
from camgen.tolerances import SAME_POINT

# Interval ends closer than this are one, rad: ends shared by neighbours differ by rounding, and no gap may stay.
# Over it an element is used past its end, 1e-10 mm along a cam of 100 mm.
_SAME_ANGLE = 1e-12

# Queries handled at once: some ten temporary arrays of this many float64 stay in a core's cache.
_BLOCK = 4096

_TURN = 2 * math.pi


@dataclass(frozen=True)
class Touch:
    """First touch at each queried angle, each (n,); nan (element -1) where the tip does not reach the outline.

    angle: follower angle s, rad.
    pressure_angle: from the tip centre's velocity when it is pushed off the part to the outward contact normal, rad,
    counter-clockwise positive, between -pi/2 and pi/2.
    element: i for edge i of the ring, n + i for the corner where edge i ends (n edges).
    """

    angle: Floats
    pressure_angle: Floats
    element: Ints


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
        n0, n1 = self.normal[round_it], self.normal[round_it] * np.exp(1j * self.sweep[round_it])
        eccentric = -spoke[round_it]
        change[round_it] = self.sweep[round_it] + np.angle(1 + eccentric * np.conj(n1)) - np.angle(1 + eccentric * np.conj(n0))
        return change


def _offset(ring: Ring, radius: float) -> _Elements:
    """The outline moved out by the tip radius: edges, and an arc about each convex corner.

    An arc that is concave with less than the tip radius has no offset: the tip cannot reach it. One with the tip radius
    itself, such as the fillet in which the tip rests, has a single point, and its neighbours end there.
    """
    count = len(ring.points)
    edge = np.flatnonzero(ring.ends != ring.points)
    a, b, bulge = ring.points[edge], ring.ends[edge], ring.bulges[edge]
    chord = np.abs(b - a)
    half_turn = (1 + 1j * bulge) ** 2 / (1 + bulge**2)  # exp(i sweep / 2)
    across = -1j * (b - a) / chord
    first, last = across / half_turn, across * half_turn
    curvature = 4 * bulge / (1 + bulge**2) / chord
    open_to_tip = np.flatnonzero(1 + radius * curvature > SAME_POINT)
    edges = _Elements(a + radius * first, b + radius * last, first, 4 * np.arctan(bulge), edge).take(open_to_tip)
    following = np.roll(first, -1)
    turn = np.angle(following * np.conj(last))
    start, end = b + radius * last, b + radius * following
    corner = np.flatnonzero((turn > 0) & (start != end))
    corners = _Elements(start, end, last, turn, count + edge).take(corner)
    return edges.join(corners)


@dataclass(frozen=True)
class RollingContact:
    """Table of first touches, see `rolling_contact`.

    breaks (m + 1,) bound the intervals of cam angle, 0 to 2 pi. Interval j has the candidates first[j]:first[j + 1],
    rows (k L, Re B, Im B, (C + k (L^2 + R^2)) / 2R) of the closed form and the element they come from; the first of
    them is in lead[j]. Cam angle u in bucket int(u scale) lies in interval bucket[...] or the next, in `crowded`
    buckets farther on.
    """

    pivot: complex
    arm: complex
    leaves: int
    breaks: Floats
    first: Ints
    rows: Floats
    source: Ints
    lead: Floats
    scale: float
    bucket: Ints
    crowded: NDArray[np.bool_]

    def angle(self, theta: ArrayLike) -> Floats:
        """Follower angle s, rad, at which the tip first touches the outline turned by theta.

        theta: (n,) rad, any turn.  Returns (n,), nan where the tip does not reach the outline or cannot leave it.
        """
        return self._solve(theta, False).angle

    def touch(self, theta: ArrayLike) -> Touch:
        """As `angle`, with the pressure angle and the element that is touched."""
        return self._solve(theta, True)

    def _solve(self, theta: ArrayLike, fully: bool) -> Touch:
        flat = np.atleast_1d(np.asarray(theta, float)).ravel()
        finite = np.isfinite(flat)
        if not finite.all():
            flat = np.where(finite, flat, 0.0)
        count = len(flat)
        angle, pressure = np.empty(count), np.empty(count if fully else 0)
        element = np.empty(count if fully else 0, np.int64)
        for low in range(0, count, _BLOCK):
            block = slice(low, low + _BLOCK)
            psi, row = self._first_touch(flat[block])
            angle[block] = psi
            if fully:
                pressure[block], element[block] = self._slope(flat[block], psi, row), self.source[row]
        rest = abs(cmath.phase(self.arm / self.pivot))
        angle = -self.leaves * (angle - rest)
        for values in (angle, pressure):
            if len(values):
                values[~finite] = np.nan
        element[np.isnan(angle[: len(element)])] = -1
        shape = np.shape(theta)
        return Touch(angle.reshape(shape), pressure.reshape(shape) if fully else pressure, element)

    def _turned(self, theta: Floats) -> Floats:
        """Cam angle in the frame of the closed form: pivot on the real axis, arm in the upper half plane; 0..2 pi."""
        u = -self.leaves * (theta - cmath.phase(self.pivot))
        return np.asarray(u - _TURN * np.floor(u * (1 / _TURN)))

    def _first_touch(self, theta: Floats) -> tuple[Floats, Ints]:
        u = self._turned(theta)
        slot = (u * self.scale).astype(np.int64)
        place = self.bucket[slot]
        place += u >= self.breaks[place + 1]
        crowded = np.flatnonzero(self.crowded[slot])
        if len(crowded):
            place[crowded] = np.maximum(np.searchsorted(self.breaks, u[crowded], "right") - 1, 0)
        np.minimum(place, len(self.breaks) - 2, out=place)
        psi = self._closed_form(u, self.lead[place])
        row = self.first[place]
        rivals = self.first[place + 1] - row
        where = np.flatnonzero(rivals > 1)
        rank = 0
        while len(where):
            rank += 1
            other = self.first[place[where]] + rank
            found = self._closed_form(u[where], self.rows[other])
            sooner = ~(found >= psi[where])  # nan wins: an outline beyond the tip's reach blocks whatever lies under it
            psi[where[sooner]], row[where[sooner]] = found[sooner], other[sooner]
            where = where[(rivals[where] > rank + 1) & ~np.isnan(psi[where])]
        return psi, row

    def _closed_form(self, u: Floats, rows: Floats) -> Floats:
        ex, ey, cosine = self._terms(u, rows)
        return np.asarray(np.arctan2(ey, ex) + np.arccos(cosine))

    def _terms(self, u: Floats, rows: Floats) -> tuple[Floats, Floats, Floats]:
        """Re E, Im E and cos(psi - arg E)."""
        t = np.tan(u / 2)  # numpy's tan is many times as fast as its sin and cos, and as accurate here
        t2 = t * t
        weight = 1 / (1 + t2)
        cosine, sine = (1 - t2) * weight, 2 * t * weight
        bx, by = rows[:, 1], rows[:, 2]
        turned = bx * cosine - by * sine
        ex = rows[:, 0] - turned
        ey = -(bx * sine + by * cosine)
        level = turned * (abs(self.pivot) / abs(self.arm)) - rows[:, 3]
        # Rounding may carry the quotient past 1 only where the pressure angle is 90 deg.
        return ex, ey, np.minimum(np.maximum(level / np.sqrt(ex * ex + ey * ey), -1.0), 1.0)

    def _slope(self, theta: Floats, psi: Floats, row: Ints) -> Floats:
        """Pressure angle: the outward normal is E + k R exp(i psi), the tip leaves along -i exp(i psi)."""
        rows = self.rows[row]
        ex, ey, _ = self._terms(self._turned(theta), rows)
        normal = (ex + 1j * ey) * np.exp(-1j * psi) + rows[:, 0] * (abs(self.arm) / abs(self.pivot))
        return np.asarray(-self.leaves * np.angle(1j * normal))


def rolling_contact(ring: Ring, pivot: complex, arm: complex, tip_radius: float, leaves: int) -> RollingContact:
    """Table of first touches of a round tip on an outline that turns about the origin.

    ring: counter-clockwise, part frame, at theta = 0 in the ground frame.  pivot: ground, mm.  arm: from the pivot to
    the tip centre at s = 0, mm.  tip_radius: mm, 0 for a knife edge.  leaves: the sense of s, +1 or -1, in which the
    tip moves off the part, away from the origin; it stays on its side of the line through origin and pivot.
    ValueError when these do not fit each other.
    """
    reach, rest = abs(pivot) * abs(arm), (arm * complex(pivot).conjugate()).imag
    if not (math.isfinite(reach) and reach > 0 and math.isfinite(tip_radius) and tip_radius >= 0):
        raise ValueError(f"no contact for pivot {pivot}, arm {arm}, tip radius {tip_radius}")
    if leaves not in (-1, 1) or rest * leaves > 0:
        raise ValueError(f"turning the arm in the sense {leaves} does not take the tip away from the origin")
    if not ring.area > 0:
        raise ValueError("the outline does not run counter-clockwise")
    L, R = abs(pivot), abs(arm)  # noqa: N806
    elements = _framed(_offset(ring, tip_radius), cmath.phase(pivot), leaves)
    pieces, low, width, blocks = _covered(elements, L, R)
    k, p, n = pieces.curvature, pieces.start, pieces.normal
    b = k * p - n
    level = (k * (np.abs(p) ** 2 + L**2 + R**2) - 2 * np.real(np.conj(n) * p)) / (2 * R)
    rows = np.column_stack([k * L, b.real, b.imag, level])
    rows[blocks] = np.nan

    breaks, index = _merged(np.concatenate([low, low + width]) % _TURN)
    count = len(breaks) - 1
    first, last = index[: len(low)], index[len(low) :]
    spans = (last - first) % count
    piece = np.repeat(np.arange(len(low)), spans)
    interval = (np.repeat(first - np.cumsum(spans) + spans, spans) + np.arange(len(piece))) % count
    # An interval that nothing covers gets a row of nan.
    bare = np.flatnonzero(np.bincount(interval, minlength=count) == 0)
    piece = np.concatenate([piece, np.full(len(bare), len(low))])
    order = np.argsort(np.concatenate([interval, bare]), kind="stable")
    rows = np.concatenate([rows, np.full((1, 4), np.nan)])[piece[order]]
    source = np.append(pieces.source, -1)[piece[order]]
    starts = np.append(0, np.cumsum(np.bincount(np.concatenate([interval, bare]), minlength=count)))

    buckets = 4 * count
    edges = np.arange(buckets + 1) * (_TURN / buckets)
    bucket = np.searchsorted(breaks[:-1], edges, "right") - 1
    crowded = np.append(np.diff(bucket) > 1, True)
    return RollingContact(
        complex(pivot), complex(arm), leaves, breaks, starts, rows, source, rows[starts[:-1]],
        buckets / _TURN, bucket, crowded,
    )  # fmt: skip


def _framed(e: _Elements, phase: float, leaves: int) -> _Elements:
    """Elements seen with the pivot on the real axis and the arm above it, mirrored (and so run back) for leaves = 1.

    The pivot's direction is taken up by theta, so only the mirror image is left to do.
    """
    if leaves < 0:
        return e
    last_normal = e.normal * np.exp(1j * e.sweep)
    return _Elements(np.conj(e.end), np.conj(e.start), np.conj(last_normal), e.sweep, e.source)


def _covered(elements: _Elements, L: float, R: float) -> tuple[_Elements, Floats, Floats, NDArray[np.bool_]]:  # noqa: N803
    """Pieces on which the tip enters the part: least cam angle of its interval, width, whether it blocks the tip.

    Elements are cut where the pressure angle is 90 deg and where they leave the ring that the tip centre can reach,
    |L - R| to L + R from the origin. What lies beyond L + R is kept, as if at that distance: it blocks the tip.
    """
    index, share = _cuts(elements, L, R)
    whole = np.ones(len(elements.start), bool)
    whole[index] = False
    plain = np.flatnonzero(whole)
    broken = np.flatnonzero(~whole)
    index = np.concatenate([broken, index, broken])
    share = np.concatenate([np.zeros(len(broken)), share, np.ones(len(broken))])
    order = np.lexsort((share, index))
    index, share = index[order], share[order]
    inner = np.flatnonzero(np.diff(index) == 0)
    cut = elements.take(index[inner]).part(share[inner], share[inner + 1])
    pieces = elements.take(plain).join(cut)
    first, last = (_bearing(np.abs(p), L, R) for p in (pieces.start, pieces.end))
    turned = pieces.turned()
    low = last - np.angle(pieces.start) - turned
    width = first - last + turned
    middle = np.abs(pieces.at(0.5))
    kept = np.flatnonzero((width > 0) & (middle > abs(L - R)))
    return pieces.take(kept), low[kept], width[kept], middle[kept] > L + R


def _bearing(r: Floats, L: float, R: float) -> Floats:  # noqa: N803
    """arg c of the tip centre at distance r from the origin, 0..pi, by half the angle at O of the triangle O, A, c.

    Half-angle form, so that neither a flat triangle nor a pivot far off costs digits.
    """
    r = np.clip(r, abs(L - R), L + R)
    opposite = np.maximum((r + (R - L)) * (R + L - r), 0.0)
    adjacent = np.maximum((r - (R - L)) * (L + R + r), 0.0)
    return np.asarray(2 * np.arctan2(np.sqrt(opposite), np.sqrt(adjacent)))


def _cuts(e: _Elements, L: float, R: float) -> tuple[Ints, Floats]:  # noqa: N803
    """Elements to be cut and the share of the length at which, in no order, 0 < share < 1."""
    k, b = e.curvature, e.curvature * e.start - e.normal
    c = k * np.abs(e.start) ** 2 - 2 * np.real(np.conj(e.normal) * e.start)
    size = np.maximum(np.abs(b), 1e-300)
    unit = b / size
    found: list[tuple[Ints, Points]] = []
    # 90 deg: the arm lies along the normal, so the pivot, L from the origin, is at distance d = +-R from the element:
    # k|P|^2 - 2 Re(conj(B) P) + C = 2 d + k d^2. Of the two such P one has the arm on the right side.
    for d in (R, -R):
        x = (k * (L**2 - R**2) + c - 2 * d) / (2 * L * size)
        at = np.flatnonzero(np.abs(x) < 1)
        stretch = 1 + k[at] * d
        y = -np.sign(d * stretch) * np.sqrt(1 - x[at] ** 2)
        p = L * unit[at] * (x[at] + 1j * y)
        with np.errstate(divide="ignore", invalid="ignore"):
            found.append((at, p - d * (k[at] * p - b[at]) / stretch))
    for r in (L + R, abs(L - R)):
        with np.errstate(divide="ignore"):
            x = (k * r**2 + c) / (2 * r * size)
        at = np.flatnonzero(np.abs(x) < 1)
        for sign in (1, -1):
            found.append((at, r * unit[at] * (x[at] + 1j * sign * np.sqrt(1 - x[at] ** 2))))
    index = np.concatenate([at for at, _ in found])
    p = np.concatenate([p for _, p in found])
    near = np.flatnonzero(np.abs(p - e.start[index]) < e.length[index])  # spares most of them the next step
    index = index[near]
    share = e.take(index).share(p[near])
    inside = np.flatnonzero((share > 0) & (share < 1))
    return index[inside], share[inside]


def _merged(ends: Floats) -> tuple[Floats, Ints]:
    """Sorted distinct interval bounds from 0 to 2 pi, (m + 1,), and which of them each of `ends` is."""
    ends = np.where(ends > _TURN - _SAME_ANGLE, 0.0, ends)
    order = np.argsort(ends)
    steps = np.diff(ends[order], prepend=0.0) > _SAME_ANGLE
    rank = np.empty(len(ends), np.int64)
    rank[order] = np.cumsum(steps)
    return np.concatenate([[0.0], ends[order][steps], [_TURN]]), rank
