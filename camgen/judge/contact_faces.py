"""Closed forms of a flat face's contact with one element of an outline that turns, on a slide or an arm.

An element is a corner or a convex arc: its centre c and its radius r, 0 for a corner. The part is H(mu) high in the
direction mu, max of Re(conj(exp(i mu)) c) + r; nothing hollow counts. A face whose normal is exp(i nu) in the ground has
the direction mu = nu - theta in the part, and touches an element while mu lies between the normals at its ends. So each
element covers a known interval of theta, as in `contact_tips`.

On a slide along the real axis the face stands at Re(w) + r, w = c exp(i theta); on an arm, pivot at L on the real axis
and the face d ahead of it, nu = arg(L - w) - arccos((r - d)/|L - w|).
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass

import numpy as np

from camgen.geometry.rings import Floats, Ints, Points, Ring
from camgen.judge.contact_tips import Cover, OnSlide, cos_sin, parts_of, wrapped


def _convex(ring: Ring) -> tuple[Points, Floats, Floats, Floats, Ints]:
    """What a face can touch: centre and radius (0 at corners), direction of the first normal, sweep, element."""
    count = len(ring.points)
    edge = np.flatnonzero(ring.ends != ring.points)
    a = ring.points[edge]
    b = ring.ends[edge]
    bulge = ring.bulges[edge]
    half_turn = (1 + 1j * bulge) ** 2 / (1 + bulge**2)  # exp(i sweep / 2)
    across = -1j * (b - a) / np.abs(b - a)
    first = across / half_turn
    last = across * half_turn
    arc = np.flatnonzero(bulge > 0)
    radius = np.abs(b - a)[arc] * (1 + bulge[arc] ** 2) / (4 * bulge[arc])
    turn = np.angle(np.roll(first, -1) * np.conj(last))
    corner = np.flatnonzero(turn > 0)
    return (
        np.concatenate([a[arc] - radius * first[arc], b[corner]]),
        np.concatenate([radius, np.zeros(len(corner))]),
        np.angle(np.concatenate([first[arc], last[corner]])),
        np.concatenate([4 * np.arctan(bulge[arc]), turn[corner]]),
        np.concatenate([edge[arc], count + edge[corner]]),
    )


@dataclass(frozen=True)
class SlideFace(OnSlide):
    """Face square to its slide, through start + along * s; rows are Re c, Im c, r."""

    start: complex
    along: complex
    leaves: int

    def __post_init__(self) -> None:
        if (
            not cmath.isfinite(self.start)
            or self.leaves not in (-1, 1)
            or not abs(abs(self.along) - 1) < 1e-9
        ):
            raise ValueError(
                f"no face through {self.start} along {self.along} that leaves in the sense {self.leaves}"
            )

    def cover(self, ring: Ring) -> Cover:
        """The face's direction in the part is -u."""
        centre, radius, begin, sweep, source = _convex(ring)
        return Cover(
            -(begin + sweep), sweep, np.column_stack([centre.real, centre.imag, radius]), source
        )

    def progress(self, u: Floats, rows: Floats) -> Floats:
        """Less the height of the part."""
        cosine, sine = cos_sin(u)
        return np.asarray(rows[:, 1] * sine - rows[:, 0] * cosine - rows[:, 2])

    def displacement(self, progress: Floats) -> Floats:
        """The way along the slide."""
        return np.asarray(self.leaves * (-progress - self._begin.real))

    def normal(self, u: Floats, progress: Floats, rows: Floats) -> Points:
        """Along the slide."""
        return np.ones(u.shape, complex)

    def place(self, u: Floats, progress: Floats, rows: Floats) -> Floats:
        """To the left of the slide's line, seen along its way off the part."""
        cosine, sine = cos_sin(u)
        return np.asarray(rows[:, 0] * sine + rows[:, 1] * cosine - self._begin.imag)


@dataclass(frozen=True)
class ArmFace:
    """Face on an arm: at s = 0 its normal is `facing` (unit) and it lies `ahead` mm from the pivot along it; s in rad."""

    pivot: complex
    facing: complex
    ahead: float
    leaves: int

    def __post_init__(self) -> None:
        lever = (complex(self.facing).conjugate() * self.pivot).imag
        if not (
            abs(abs(self.facing) - 1) < 1e-9
            and math.isfinite(abs(self.pivot) + self.ahead)
            and lever
        ):
            raise ValueError(
                f"no face for pivot {self.pivot}, normal {self.facing}, {self.ahead} mm ahead"
            )
        if self.leaves != math.copysign(1, lever):
            raise ValueError(
                f"turning the face in the sense {self.leaves} does not take it away from the origin"
            )

    def cover(self, ring: Ring) -> Cover:
        """Corners and arcs on the origin's side of the pivot's foot; what is as high as the pivot blocks the face."""
        far = abs(self.pivot)
        centre, radius, begin, sweep, source = _convex(ring)
        if self.leaves < 0:
            centre = np.conj(centre)
            begin = -(begin + sweep)
        size = np.abs(centre)
        bearing = np.angle(centre)
        more = radius - self.ahead
        index = []
        fractions = []
        # Directions in which the contact is the pivot's foot, and in which the part is as high as the pivot, or as far below.
        for cosine in (
            (far**2 - size**2 - more**2, 2 * more * size),
            (far - more, size),
            (-far - more, size),
        ):
            with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
                opening = np.arccos(cosine[0] / cosine[1])
                for side in (1, -1):
                    fraction = wrapped(bearing + side * opening - begin) / sweep
                    at = np.flatnonzero((fraction > 0) & (fraction < 1))
                    index.append(at)
                    fractions.append(fraction[at])
        whole, broken, first, last = parts_of(
            len(size), np.concatenate(index), np.concatenate(fractions)
        )
        of = np.concatenate([whole, broken])
        first = begin[of] + sweep[of] * np.concatenate([np.zeros(len(whole)), first])
        last = begin[of] + sweep[of] * np.concatenate([np.ones(len(whole)), last])
        ends = [
            self._closed(size[of] * np.cos(mu - bearing[of]) + more[of]) - mu
            for mu in (first, last)
        ]
        width = ends[0] - ends[1]
        height = size[of] * np.cos((first + last) / 2 - bearing[of]) + more[of]
        touchable = np.flatnonzero((width > 0) & (height > -far))
        rows = np.column_stack([centre.real, centre.imag, radius])[of[touchable]]
        rows[height[touchable] > far] = np.nan
        return Cover(ends[1][touchable], width[touchable], rows, source[of[touchable]])

    def _closed(self, height: Floats) -> Floats:
        """nu at which the face stands at this height less `ahead`, -pi to 0."""
        return np.asarray(-np.arccos(np.clip(height / abs(self.pivot), -1, 1)))

    def turned(self, theta: Floats) -> Floats:
        """Pivot on the real axis, the face's normal in the lower half plane."""
        return wrapped(self.leaves * (theta - cmath.phase(self.pivot)))

    def _spoke(self, u: Floats, rows: Floats) -> Points:
        cosine, sine = cos_sin(u)
        return np.asarray(abs(self.pivot) - (rows[:, 0] + 1j * rows[:, 1]) * (cosine + 1j * sine))

    def progress(self, u: Floats, rows: Floats) -> Floats:
        """-nu."""
        spoke = self._spoke(u, rows)
        cosine = np.clip((rows[:, 2] - self.ahead) / np.abs(spoke), -1, 1)
        return np.asarray(np.arccos(cosine) - np.angle(spoke))

    def displacement(self, progress: Floats) -> Floats:
        """The face's angle."""
        begin = self.leaves * cmath.phase(complex(self.facing) / self.pivot)
        return np.asarray(self.leaves * (-progress - begin))

    def normal(self, u: Floats, progress: Floats, rows: Floats) -> Points:
        """The face's normal over the way of its own point there."""
        lever = -self._lever(u, progress, rows)
        direction = (
            lever + 1j * self.ahead
        )  # the way of the contact is i * (its place from the pivot)
        return np.asarray(np.conj(direction) if self.leaves > 0 else direction)

    def _lever(self, u: Floats, progress: Floats, rows: Floats) -> Floats:
        """Place on the face from the pivot's foot, to the left of the normal in the form's frame."""
        return np.asarray(-np.imag(self._spoke(u, rows) * np.exp(1j * progress)))

    def place(self, u: Floats, progress: Floats, rows: Floats) -> Floats:
        """From the pivot's foot, to the left of the normal."""
        return np.asarray(self.leaves * self._lever(u, progress, rows))
