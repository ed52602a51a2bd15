"""Measured outlines laid upon each other: turn, shift, and what the measuring device did to all of them alike.

    rigid      z -> exp(i turn) z + shift
    device     w = z + m conj(z): m.real is half of what the x axis is too long beside the y axis, m.imag half of their shear;
               with a turn and one scale for both axes that is every linear map

A shape is its edges, closed lines of points, (n,) complex, mm. Strays, such as specks of dust, do not count.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from camgen.geometry.rings import Floats, Points
from camgen.numerics import coordinates, least_squares

_ANGLES = 16384  # over the turn, at which radii are compared
_BACKWARDS = (
    0.02  # share of its length that an outline may run backwards as seen from the origin, by noise
)
_STRAYS = 4.0  # robust standard deviations beyond which a point is left out
_SMOOTH = 3  # points to either side from which an edge's direction is taken
_MOST_POINTS = 20_000  # that are laid on others
_ROUNDS = 30


@dataclass(frozen=True)
class Registration:
    """How one shape lies on another, and the rms distance, mm, of the points that count."""

    turn: float
    shift: complex
    off: float

    def back(self, z: Points) -> Points:
        """Points of the other shape in the frame of the first."""
        return np.asarray((z - self.shift) * np.exp(-1j * self.turn))


def straighten(w: Points, m: complex) -> Points:
    """The places that a device with the distortion m shows as w."""
    return np.asarray((w - m * np.conj(w)) / (1 - abs(m) ** 2))


def lay(
    shape: Sequence[Points],
    others: Sequence[Sequence[Points]],
    distortion: bool = False,
    start: float | None = None,
) -> tuple[complex, list[Registration]]:
    """Distortion m common to all shapes (0 unless it is asked for), and how the first, straightened, lies on each other one.

    The origin of each is near one point of the body, the first of its edges the outline. start: a turn to begin with, rad;
    without one that at which the outlines' radii are most alike.
    """
    poses = [
        Registration(turn_between(shape[0], other[0]) if start is None else start, 0j, np.inf)
        for other in others
    ]
    points = np.concatenate(shape)
    points = points[:: max(1, len(points) // _MOST_POINTS)]
    targets = [_Target(other) for other in others]
    m = 0j
    for _ in range(_ROUNDS):
        blocks = []
        rights = []
        misses = []
        for k, (target, each) in enumerate(zip(targets, poses, strict=True)):
            spun = np.exp(1j * each.turn)
            at = spun * straighten(points, m) + each.shift
            near, normal, miss = target.nearest(at, m)
            counting = _counting(miss)
            moves = np.conj(target.shown[near]) - spun * np.conj(points)  # per m
            columns = [moves, 1j * moves] if distortion else []
            table = np.zeros((int(counting.sum()), 3 * len(poses) + len(columns)))
            own_columns = [
                1j * spun * straighten(points, m),
                np.ones(len(points)),
                np.full(len(points), 1j),
            ]
            for place, column in [
                *enumerate(columns),
                *enumerate(own_columns, len(columns) + 3 * k),
            ]:
                table[:, place] = np.real(np.conj(normal) * column)[counting]
            blocks.append(table)
            rights.append(-miss[counting])
            misses.append(float(np.sqrt(np.mean(miss[counting] ** 2))))
        step = np.asarray(least_squares(np.concatenate(blocks), np.concatenate(rights)))
        common = complex(step[0], step[1]) if distortion else 0j
        m += common
        own_steps = step[2 if distortion else 0 :].reshape(-1, 3)
        poses = [
            Registration(each.turn + a, each.shift + complex(x, y), off)
            for each, (a, x, y), off in zip(poses, own_steps, misses, strict=True)
        ]
        if np.max(np.abs(step)) < 1e-8:
            break
    return m, poses


def lay_on_known(
    outline: Points, reference: Points, device: bool = False
) -> tuple[Points, complex, float, Registration]:
    """A measured outline laid on one that is known, in the known one's frame: (n,) mm; m and scale of what measured it, found
    if device and otherwise 0 and 1; how it lay, seen from both centres of area.
    """
    points = outline
    target = _Target([reference])
    turn = turn_between(points, reference)
    shift = 0j
    m = 0j
    scale = 1.0
    off = np.inf
    some = points[:: max(1, len(points) // _MOST_POINTS)]
    for _ in range(_ROUNDS):
        spun = np.exp(1j * turn) / scale
        at = spun * straighten(some, m) + shift
        _, normal, miss = target.nearest(at, 0j)
        counting = _counting(miss)
        columns = [1j * (at - shift), np.ones(len(at)), np.full(len(at), 1j)]
        if device:
            columns += [shift - at, -spun * np.conj(some), -1j * spun * np.conj(some)]
        table = np.column_stack([np.real(np.conj(normal) * column) for column in columns])
        a, x, y, *more = np.asarray(least_squares(table[counting], -miss[counting])).tolist()
        turn = turn + a
        shift = shift + complex(x, y)
        off = float(np.sqrt(np.mean(miss[counting] ** 2)))
        if device:
            scale = scale * (1 + more[0])
            m = m + complex(more[1], more[2])
        if max(map(abs, (a, x, y, *more))) < 1e-9:
            break
    placed = np.exp(1j * turn) / scale * straighten(points, m) + shift
    return np.asarray(placed), m, scale, Registration(turn, shift, off)


def deviation(outline: Points, reference: Points) -> Floats:
    """How far points of an outline lie outside a known, counter-clockwise one, along its normal, (n,) mm."""
    return _Target([reference]).nearest(outline, 0j)[2]


def dense(outline: Points, step: float) -> Points:
    """An outline with points at most a step apart, mm."""
    chord = np.roll(outline, -1) - outline
    count = np.maximum(1, np.ceil(np.abs(chord) / step)).astype(int)
    edge = np.repeat(np.arange(len(count)), count)
    u = (np.arange(len(edge)) - np.repeat(np.cumsum(count) - count, count)) / count[edge]
    return np.asarray(outline[edge] + u * chord[edge])


def _counting(miss: Floats) -> Any:
    """Which of some distances are no strays."""
    off = np.abs(miss - np.median(miss))
    return off <= _STRAYS * 1.4826 * np.median(off) + 1e-12


class _Target:
    """A shape on which others are laid."""

    def __init__(self, shape: Sequence[Points]) -> None:
        self.shown: Points = np.concatenate(shape)
        self._along = np.concatenate([np.roll(z, -_SMOOTH) - np.roll(z, _SMOOTH) for z in shape])
        self._tree: Any = None
        self._m = complex(np.inf)

    def nearest(self, at: Points, m: complex) -> tuple[Any, Points, Floats]:
        """For points, (n,): the nearest of the shape's own, straightened; the unit normal there; the distance along it."""
        from scipy.spatial import cKDTree

        shape = straighten(self.shown, m)
        along = straighten(self._along, m)
        if self._tree is None or abs(m - self._m) > 1e-6:
            self._tree = cKDTree(coordinates(shape))
            self._m = m
        near = self._tree.query(coordinates(at))[1]
        normal = -1j * along[near] / np.abs(along[near])
        return near, normal, np.real(np.conj(normal) * (at - shape[near]))


def turn_between(outline: Points, other: Points) -> float:
    """Turn about the origin, rad, that lays an outline on another one best, to a fraction of a degree."""
    a, b = (np.fft.rfft(radii(z) - np.mean(radii(z))) for z in (outline, other))
    return float(np.argmax(np.fft.irfft(np.conj(a) * b))) * 2 * np.pi / _ANGLES


def star(outline: Points) -> bool:
    """Whether each ray from the origin meets the outline once, noise aside."""
    step = np.imag(np.conj(outline) * np.roll(outline, -1)) / np.abs(outline)
    return bool(abs(step.sum()) > (1 - 2 * _BACKWARDS) * np.abs(step).sum())


def radii(outline: Points) -> Floats:
    """Radius of an outline at even angles from 0, (_ANGLES,) mm."""
    angle = np.linspace(0, 2 * np.pi, _ANGLES, endpoint=False)
    return np.asarray(
        np.interp(angle, np.angle(outline) % (2 * np.pi), np.abs(outline), period=2 * np.pi)
    )


def middle(outlines: Sequence[Points]) -> tuple[Points, float]:
    """The outline half way through several of one body, which are stars, and their rms distance from it along the radius, mm."""
    table = np.array([radii(each) for each in outlines])
    radius = np.median(table, axis=0)
    angle = np.linspace(0, 2 * np.pi, _ANGLES, endpoint=False)
    return np.asarray(radius * np.exp(1j * angle)), float(np.sqrt(np.mean((table - radius) ** 2)))
