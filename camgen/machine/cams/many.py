"""Figures of many disc cams at once: each follower's own formulas, evaluated over arrays of (cams, angles).

    kin       cams whose programs have the same laws one after the other, whatever their spans and lifts, and whose followers
              are of one kind: their motion is one formula, and so is all that follows from it
    stretch   part of a segment, from share to share of its span, in which the motion is one smooth curve
    peak      where a figure is greatest: looked for at the nodes of the integrals, then between the two beside the best

What has a corner in its speed, an undercut, or a profile that is not seen whole from its axis takes more than formulas: for
such a cam there is no answer here, and it is looked at by itself.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property, partial
from itertools import pairwise
from typing import Any

import numpy as np

from camgen.machine.cams.followers import FlatFace, Motion, RoundTip
from camgen.machine.cams.profile import (
    DiscCam,
    place_on_face,
    pressure_angle_untrimmed,
    sharpness,
    still,
)
from camgen.machine.cams.shoes import Shoe
from camgen.numerics import Floats, Indices, distinct, gauss_legendre

_BLOCK = 256  # cams whose arrays stay in the processor's cache
_PANELS = 8  # of a stretch, each with as many nodes as these
_GAUSS = gauss_legendre(16)
_BESIDE = 1e-9  # of a segment, from the end of a stretch to its first node
_SHARE = (
    1e-2  # of a figure's range, by which a lower peak may be the highest when looked at closely
)
# places between two neighbours, and how often: to 4^-9 of a node's distance
_ZOOM = 9
_TIMES = 9
_GROUND = 0.0  # theta at which a cam's frame is the ground's: nothing here depends on how far the cam has turned
_PLAIN = 0.02  # least sine between the profile and its radius, and least share of the cam that the follower keeps from the axis


@dataclass(frozen=True)
class ProfileFigures:
    """Of one cam: pressure angle, deg; least radius, length, farthest and nearest point, between where and where a face is
    touched, mm; area, mm^2.
    """

    steepest: float
    least_radius: float
    length: float
    area: float
    farthest: float
    nearest: float
    face_from: float
    face_to: float


def figures_of(cams: Sequence[DiscCam[Any]]) -> list[ProfileFigures | None]:
    """Figures of each cam; None for one that has to be looked at by itself."""
    figures: list[ProfileFigures | None] = [None] * len(cams)
    kin: dict[Hashable, list[int]] = {}
    for k, cam in enumerate(cams):
        if not cam.program.discontinuities(1) and not isinstance(cam.follower, Shoe):
            kin.setdefault(_kind(cam), []).append(k)
    for alike in kin.values():
        for first in range(0, len(alike), _BLOCK):
            block = alike[first : first + _BLOCK]
            for k, one in zip(block, _Kin([cams[k] for k in block]).figures(), strict=True):
                figures[k] = one
    return figures


def _kind(cam: DiscCam[Any]) -> Hashable:
    follower = cam.cutter
    knife = isinstance(follower, RoundTip) and not follower.tip_radius
    return (
        type(follower),
        follower.leaves,
        knife,
        tuple((id(s.law), not s.scale) for s in cam.program.segments),
    )


@dataclass(frozen=True)
class _Stretch:
    """Shares of a segment's span at which all is looked at, (n,), and the weights of an integral over it, 0 at its ends."""

    segment: int
    nodes: Floats
    weights: Floats


Figure = Callable[[Any, Any, Motion], Floats]  # a follower, theta and motion to a figure


@dataclass(frozen=True)
class _Kin:
    cams: Sequence[DiscCam[Any]]

    @cached_property
    def _spans(self) -> Floats:
        return np.array([[s.span for s in cam.program.segments] for cam in self.cams])

    @cached_property
    def _scales(self) -> Floats:
        return np.array([[s.scale for s in cam.program.segments] for cam in self.cams])

    @cached_property
    def _starts(self) -> Floats:
        return np.array([[s.start for s in cam.program.segments] for cam in self.cams])

    @cached_property
    def _columns(self) -> dict[str, Any]:
        """Fields of the followers, (cams, 1) where they differ, so that they go with (cams, angles)."""
        columns = {}
        for each in fields(self.cams[0].cutter):
            values = np.array([getattr(cam.cutter, each.name) for cam in self.cams])
            columns[each.name] = (
                values[0].item() if np.all(values == values[0]) else values[:, None]
            )
        return columns

    def _follower(self, rows: Any) -> Any:
        columns = {
            name: value[rows] if isinstance(value, np.ndarray) else value
            for name, value in self._columns.items()
        }
        return replace(self.cams[0].cutter, **columns)

    def _course(self, k: int, u: Floats, rows: Any) -> Motion:
        """Motion of some cams at shares u of their segment k: (n,) for all of them, or (rows, n); at whatever theta is asked."""
        span, scale, start = (
            each[rows, k, None] for each in (self._spans, self._scales, self._starts)
        )
        law = self.cams[0].program.segments[k].law
        values = dict[int, Floats]()

        def motion(theta: Any, order: int) -> Floats:
            if order not in values:
                values[order] = scale / span**order * law(u.ravel(), order).reshape(u.shape) + (
                    0 if order else start
                )
            return values[order]

        return motion

    @cached_property
    def _stretches(self) -> list[_Stretch]:
        nodes, weights = _GAUSS
        stretches = []
        for k, segment in enumerate(self.cams[0].program.segments):
            if not segment.scale:
                stretches.append(_Stretch(k, np.array([0.5]), np.array([1.0])))
                continue
            law = segment.law
            corners = [0.0, *(() if law.smooth else law.breaks), 1.0]
            for a, b in pairwise(corners):
                edges = distinct(
                    np.linspace(a, b, _PANELS + 1), [x for x in law.breaks if a < x < b]
                )
                half = np.diff(edges)[:, None] / 2
                inner = (edges[:-1, None] + half * (1 + nodes)).ravel()
                weigh = (half * weights).ravel()
                ends = a + _BESIDE, b - _BESIDE
                stretches.append(
                    _Stretch(
                        k,
                        np.concatenate([ends[:1], inner, ends[1:]]),
                        np.concatenate([[0.0], weigh, [0.0]]),
                    )
                )
        return stretches

    def figures(self) -> list[ProfileFigures | None]:
        """Figures of all of them."""
        everyone = slice(None)
        flat = issubclass(type(self.cams[0].cutter), FlatFace)
        courses = [self._course(each.segment, each.nodes, everyone) for each in self._stretches]
        follower = self._follower(everyone)
        count = len(self.cams)
        length, area, farthest = (np.zeros(count) for _ in range(3))
        sine, clear = (np.full(count, math.inf) for _ in range(2))
        for stretch, course in zip(self._stretches, courses, strict=True):
            place, along = (follower.envelope(_GROUND, course, order) for order in (0, 1))
            away = np.abs(place)
            speed = np.abs(along)
            sector = -np.imag(np.conj(place) * along)
            weight = self._spans[:, stretch.segment, None] * stretch.weights
            length += np.sum(weight * speed, axis=1)
            area += np.sum(weight * sector, axis=1) / 2
            farthest = np.maximum(farthest, np.max(away, axis=1))
            sine = np.minimum(sine, np.min(sector / (away * speed), axis=1))
            clear = np.minimum(clear, np.min(follower.clear(_GROUND, course), axis=1))
        steepest = np.degrees(self._peak(pressure_angle_untrimmed, courses))
        least = -self._peak(sharpness, courses)
        ends = (
            (-self._peak(_nearer, courses), self._peak(place_on_face, courses))
            if flat
            else (np.zeros(count), np.zeros(count))
        )
        has_radius = flat or bool(np.any(follower.tip_radius))
        plain = (sine > _PLAIN) & (clear > _PLAIN * farthest) & ((least > 0) | (not has_radius))
        lifts = np.array([cam.program.extremes for cam in self.cams]).T[..., None]
        nearest = np.min([follower.clear(_GROUND, partial(still, lift)) for lift in lifts], axis=0)[
            :, 0
        ]
        rows = np.stack([steepest, least, length, area, farthest, nearest, *ends]).T
        plain &= ~np.isnan(rows).any(axis=1)
        return [
            ProfileFigures(*row) if fine else None
            for fine, row in zip(plain, rows.tolist(), strict=True)
        ]

    def _peak(self, figure: Figure, courses: Sequence[Motion]) -> Floats:
        """Greatest value of a figure over the turn, (cams,)."""
        follower = self._follower(slice(None))
        values = [
            np.broadcast_to(figure(follower, _GROUND, course), (len(self.cams), each.nodes.size))
            for each, course in zip(self._stretches, courses, strict=True)
        ]
        best = np.max([np.max(each, axis=1) for each in values], axis=0)
        least = np.min(
            [np.min(np.where(np.isfinite(each), each, best[:, None]), axis=1) for each in values],
            axis=0,
        )
        with np.errstate(invalid="ignore"):
            near = best - _SHARE * (best - least)
        for stretch, value in zip(self._stretches, values, strict=True):
            if stretch.nodes.size == 1:
                continue
            beside = np.pad(value, ((0, 0), (1, 1)), constant_values=-np.inf)
            top = (
                (value >= beside[:, :-2])
                & (value >= beside[:, 2:])
                & (value >= near[:, None])
                & np.isfinite(value)
            )
            rows, at = np.nonzero(top)
            if rows.size:
                last = stretch.nodes.size - 1
                low = stretch.nodes[np.maximum(at - 1, 0)]
                high = stretch.nodes[np.minimum(at + 1, last)]
                np.maximum.at(best, rows, self._zoom(figure, stretch.segment, rows, low, high))
        return np.asarray(best)

    def _zoom(self, figure: Figure, k: int, rows: Indices, low: Floats, high: Floats) -> Floats:
        """Greatest value between two shares of segment k, of one cam a row."""
        follower = self._follower(rows)
        best = np.full(rows.size, -np.inf)
        one = np.arange(rows.size)
        for _ in range(_TIMES):
            u = low[:, None] + (high - low)[:, None] * np.linspace(0, 1, _ZOOM)
            value = np.broadcast_to(figure(follower, _GROUND, self._course(k, u, rows)), u.shape)
            top = np.argmax(value, axis=1)
            best = np.maximum(best, value[one, top])
            low = u[one, np.maximum(top - 1, 0)]
            high = u[one, np.minimum(top + 1, _ZOOM - 1)]
        return best


def _nearer(follower: FlatFace, theta: Floats, motion: Motion) -> Floats:
    return -place_on_face(follower, theta, motion)
