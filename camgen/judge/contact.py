"""A follower against a closed outline that turns: its displacement at first touch.

Each element of the outline, as the follower sees it, covers a known interval of the cam angle (`contact_tips`,
`contact_faces`). Those intervals, sorted once, make a table; a query looks its angle up and evaluates one closed form
for each element that covers it, mostly one; the first touch wins.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from camgen.geometry.rings import Floats, Ints, Ring
from camgen.judge.contact_tips import ArmTip, Form, SlideTip

# Interval ends closer than this are one, rad: ends shared by neighbours differ by rounding, and no gap may stay.
# Over it an element is used past its end, 1e-10 mm along a cam of 100 mm.
_SAME_ANGLE = 1e-12

# Beside the ends of an interval, rad, its element is touched for sure: 1e-7 mm along a cam of 100 mm.
_BESIDE = 1e-9

# Queries handled at once: some ten temporary arrays of this many float64 stay in a core's cache.
_BLOCK = 4096

_TURN = 2 * math.pi


@dataclass(frozen=True)
class Touch:
    """First touch at each queried angle, each (n,); nan (element -1) where the follower does not reach the outline.

    angle: the follower's displacement s, rad on an arm, mm on a slide.
    pressure_angle: from the follower's velocity where it touches, when it is pushed off the part, to the outward contact
    normal, rad, counter-clockwise positive, between -pi/2 and pi/2.
    element: i for edge i of the ring, n + i for the corner where edge i ends (n edges).
    place: where along a face it is touched, mm, from the stem's line or the pivot's foot, to the left of its normal; nan
    for a round tip.
    """

    angle: Floats
    pressure_angle: Floats
    element: Ints
    place: Floats


@dataclass(frozen=True)
class RollingContact:
    """Table of first touches, see `contact`.

    breaks (m + 1,) bound the intervals of cam angle, 0 to 2 pi. Interval j has the candidates first[j]:first[j + 1],
    rows of the form's closed form and the element they come from; the first of them is in lead[j]. Cam angle u in bucket
    int(u scale) lies in interval bucket[...] or the next, in `crowded` buckets farther on.
    """

    form: Form
    breaks: Floats
    first: Ints
    rows: Floats
    source: Ints
    lead: Floats
    scale: float
    bucket: Ints
    crowded: NDArray[np.bool_]

    def angle(self, theta: ArrayLike) -> Floats:
        """Displacement s, rad or mm, at which the follower first touches the outline turned by theta.

        theta: (n,) rad, any turn.  Returns (n,), nan where it does not reach the outline or cannot leave it.
        """
        return self._solve(theta, False).angle

    def touch(self, theta: ArrayLike) -> Touch:
        """As `angle`, with the pressure angle and the element that is touched."""
        return self._solve(theta, True)

    @property
    def changes(self) -> Floats:
        """Cam angles just before and just after each at which the touch goes from one element to the next, (n,) rad.

        A knife edge is there on a vertex of the outline.
        """
        low = self.breaks[:-1]
        high = self.breaks[1:]
        wide = high - low > 2 * _BESIDE
        u = np.concatenate([low[wide] + _BESIDE, high[wide] - _BESIDE])
        zero, one = self.form.turned(np.array([0.0, 1.0]))
        sense = 1 if (one - zero) % _TURN < math.pi else -1
        return np.asarray(sense * (u - zero) % _TURN)

    def _solve(self, theta: ArrayLike, fully: bool) -> Touch:
        flat = np.atleast_1d(np.asarray(theta, float)).ravel()
        finite = np.isfinite(flat)
        if not finite.all():
            flat = np.where(finite, flat, 0.0)
        count = len(flat)
        angle = np.empty(count)
        rest = count if fully else 0
        pressure = np.empty(rest)
        place = np.empty(rest)
        element = np.empty(rest, np.int64)
        for low in range(0, count, _BLOCK):
            block = slice(low, low + _BLOCK)
            u = self.form.turned(flat[block])
            progress, row = self._first_touch(u)
            angle[block] = progress
            if fully:
                rows = self.rows[row]
                pressure[block] = np.angle(self.form.normal(u, progress, rows))
                place[block] = self.form.place(u, progress, rows)
                element[block] = self.source[row]
        angle = self.form.displacement(angle)
        for values in (angle, pressure, place):
            if len(values):
                values[~finite] = np.nan
        element[np.isnan(angle[: len(element)])] = -1
        shape = np.shape(theta)
        if not fully:
            return Touch(angle.reshape(shape), pressure, element, place)
        return Touch(
            angle.reshape(shape),
            pressure.reshape(shape),
            element.reshape(shape),
            place.reshape(shape),
        )

    def _first_touch(self, u: Floats) -> tuple[Floats, Ints]:
        slot = (u * self.scale).astype(np.int64)
        place = self.bucket[slot]
        place += u >= self.breaks[place + 1]
        crowded = np.flatnonzero(self.crowded[slot])
        if len(crowded):
            place[crowded] = np.maximum(np.searchsorted(self.breaks, u[crowded], "right") - 1, 0)
        np.minimum(place, len(self.breaks) - 2, out=place)
        progress = self.form.progress(u, self.lead[place])
        row = self.first[place]
        rivals = self.first[place + 1] - row
        where = np.flatnonzero((rivals > 1) & ~np.isnan(progress))
        rank = 0
        while len(where):
            rank += 1
            rival = self.first[place[where]] + rank
            rival_progress = self.form.progress(u[where], self.rows[rival])
            sooner = ~(
                rival_progress >= progress[where]
            )  # nan wins: an outline beyond the tip's reach blocks whatever lies under it
            progress[where[sooner]] = rival_progress[sooner]
            row[where[sooner]] = rival[sooner]
            where = where[(rivals[where] > rank + 1) & ~np.isnan(progress[where])]
        return progress, row


def contact(ring: Ring, form: Form) -> RollingContact:
    """Table of first touches of a follower with an outline that turns about the origin.

    ring: material on its left, part frame, at theta = 0 in the ground frame: counter-clockwise, or clockwise for the wall
    that a tip `inside` comes to from within.  ValueError where it runs the other way.
    """
    within = isinstance(form, ArmTip | SlideTip) and form.inside
    if not (ring.area < 0 if within else ring.area > 0):
        raise ValueError(
            f"the outline does not run {'clockwise' if within else 'counter-clockwise'}"
        )
    cover = form.cover(ring)
    rows = np.concatenate([cover.rows, np.full((1, cover.rows.shape[1]), np.nan)])
    pieces = len(cover.low)
    breaks, index = _merged(np.concatenate([cover.low, cover.low + cover.width]) % _TURN)
    count = len(breaks) - 1
    first = index[:pieces]
    last = index[pieces:]
    spans = (last - first) % count
    piece = np.repeat(np.arange(pieces), spans)
    interval = (np.repeat(first - np.cumsum(spans) + spans, spans) + np.arange(len(piece))) % count
    # An interval that nothing covers gets a row of nan.
    bare = np.flatnonzero(np.bincount(interval, minlength=count) == 0)
    piece = np.concatenate([piece, np.full(len(bare), pieces)])
    order = np.argsort(np.concatenate([interval, bare]), kind="stable")
    rows = rows[piece[order]]
    source = np.append(cover.source, -1)[piece[order]]
    starts = np.append(0, np.cumsum(np.bincount(np.concatenate([interval, bare]), minlength=count)))

    buckets = 4 * count
    edges = np.arange(buckets + 1) * (_TURN / buckets)
    bucket = np.searchsorted(breaks[:-1], edges, "right") - 1
    crowded = np.append(np.diff(bucket) > 1, True)
    return RollingContact(
        form, breaks, starts, rows, source, rows[starts[:-1]], buckets / _TURN, bucket, crowded
    )


def _merged(ends: Floats) -> tuple[Floats, Ints]:
    """Sorted distinct interval bounds from 0 to 2 pi, (m + 1,), and which of them each of `ends` is."""
    ends = np.where(ends > _TURN - _SAME_ANGLE, 0.0, ends)
    order = np.argsort(ends)
    steps = np.diff(ends[order], prepend=0.0) > _SAME_ANGLE
    rank = np.empty(len(ends), np.int64)
    rank[order] = np.cumsum(steps)
    return np.concatenate([[0.0], ends[order][steps], [_TURN]]), rank
