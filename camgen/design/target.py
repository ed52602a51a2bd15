"""A wanted path and how far traced paths lie from it, whatever their place, turn and size.

A path is turned until its longest chord lies along x, scaled until that chord is as long as the target's, and moved until
its least x and y are 0; the target is laid both ways round. Error: mean distance from the path's points to the nearest one of
the target, and the other way, together (the chamfer distance). Fast looks take a grid of distances and few points; `measured`
takes all of them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from camgen.numerics import Floats, Indices, Points

Flags = NDArray[np.bool_]

_DIRECTIONS = (
    32  # in which the ends of a chord are looked for; the ends found are true points of the path
)
# points of the target: to tell its sense, in a fast look, in a refinement
_FEWEST = 12
_FEW = 72
_MANY = 256
_CELLS = 200  # of the grid along the chord
_MARGIN = 40  # cells round the target
_BLOCK = 48  # paths whose distances fit the processor's cache


@dataclass(frozen=True)
class Near:
    """Nearest points: error of each path, and for its points and the target's the nearest of the other kind."""

    error: Floats  # (paths,)
    goal: Points  # nearest of the target to each point of a path, (paths, steps)
    wanted: Points  # points of the target, (paths, many)
    nearest: Indices  # the path's point nearest to each of them, (paths, many)

    def mixed(self, other: Near, take: Flags) -> Near:
        """The other's paths where they are taken, (paths,)."""
        column = take[:, None]
        return Near(
            np.where(take, other.error, self.error),
            np.where(column, other.goal, self.goal),
            np.where(column, other.wanted, self.wanted),
            np.where(column, other.nearest, self.nearest),
        )


class Target:
    """points: of the path wanted, complex, in any order, dense (a line through them is not drawn)."""

    def __init__(self, points: Points) -> None:
        from scipy.spatial import cKDTree

        chord = _farthest(points)
        self.chord = abs(chord)
        along_chord = points * np.conj(chord) / abs(chord)
        self.senses = tuple(_to_corner(each) for each in (along_chord, -along_chord))
        turns = (chord / abs(chord), -chord / abs(chord))
        # how each sense goes back to the points as they were given: turn, and where its corner is
        self.placed = tuple(
            (turn, complex(points[0] - turn * sense[0]))
            for turn, sense in zip(turns, self.senses, strict=True)
        )
        sample = _spread(points, min(_MANY, len(points)))
        self.many = tuple(sense[sample] for sense in self.senses)
        self.few = tuple(sense[sample[:_FEW]] for sense in self.senses)
        self.trees = tuple(
            cKDTree(np.stack([sense.real, sense.imag], axis=-1)) for sense in self.senses
        )
        self.cell = self.chord / _CELLS
        self.grids = tuple(self._grid(tree) for tree in self.trees)

    def _grid(self, tree: object) -> Floats:
        high = max(float(np.max(sense.imag)) for sense in self.senses)
        x = np.arange(-_MARGIN, _CELLS + _MARGIN + 1) * self.cell
        y = np.arange(-_MARGIN, math.ceil(high / self.cell) + _MARGIN + 1) * self.cell
        distances = tree.query(np.stack(np.meshgrid(x, y), axis=-1))[0]  # type: ignore[attr-defined]
        return np.asarray(distances, dtype=np.float32)

    def on_target(self, paths: Points) -> tuple[Points, Points, Indices]:
        """Paths (steps, designs) as they lie on the target, the complex factor that did it (scale and turn), (designs,), and
        the points that count for it, (4, designs): ends of the chord, least x, least y."""
        ends = _ends(paths)
        oriented = paths * self._factor(paths, ends)
        anchors = np.stack(
            [*ends, np.argmin(oriented.real, axis=0), np.argmin(oriented.imag, axis=0)]
        )
        return *self.by_anchors(paths, anchors), anchors

    def by_anchors(self, paths: Points, anchors: Indices) -> tuple[Points, Points]:
        """The same where it is known which points count, as for paths that hardly differ."""
        factor = self._factor(paths, anchors[:2])
        number = np.arange(paths.shape[1])
        return paths * factor - (
            (paths[anchors[2], number] * factor).real
            + 1j * (paths[anchors[3], number] * factor).imag
        ), factor

    def _factor(self, paths: Points, ends: Indices) -> Points:
        number = np.arange(paths.shape[1])
        chord = paths[ends[1], number] - paths[ends[0], number]
        return np.asarray(
            np.conj(chord) * (self.chord / np.maximum(np.abs(chord) ** 2, 1e-300)), complex
        )

    def glance(self, paths: Points) -> Floats:
        """Error of each path, (designs,), by the grid and few points: within a few hundredths of the spacing of the points."""
        error = np.empty(paths.shape[1])
        ways = np.stack([self._look_up(grid, paths) for grid in self.grids])
        better = np.argmin(ways + [_from_points(few[:_FEWEST], paths) for few in self.few], axis=0)
        for sense, few in enumerate(self.few):
            members = np.flatnonzero(better == sense)
            if members.size:
                error[members] = ways[sense, members] + _from_points(few, paths[:, members])
        return error

    def _look_up(self, grid: Floats, paths: Points) -> Floats:
        column = np.clip(
            np.rint(paths.real / self.cell).astype(np.int32) + _MARGIN, 0, grid.shape[1] - 1
        )
        row = np.clip(
            np.rint(paths.imag / self.cell).astype(np.int32) + _MARGIN, 0, grid.shape[0] - 1
        )
        return np.asarray(np.mean(grid[row, column], axis=0))

    def near(self, paths: Points) -> Near:
        """What lies next to what, for a refinement: of the better sense of each path."""
        both = [self._near(sense, paths) for sense in (0, 1)]
        return both[0].mixed(both[1], both[1].error < both[0].error)

    def _near(self, sense: int, paths: Points) -> Near:
        out, goal = self.trees[sense].query(np.stack([paths.real.T, paths.imag.T], axis=-1))
        places = self.many[sense]
        nearest = np.empty((paths.shape[1], len(places)), dtype=np.intp)
        level = np.stack([-places.real, -places.imag, np.ones(len(places))], axis=1)
        for k, path in enumerate(paths.T):  # half of the distance's square, less what all have
            nearest[k] = np.argmin(
                level @ np.stack([path.real, path.imag, 0.5 * np.abs(path) ** 2]), axis=1
            )
        back = np.abs(places - np.take_along_axis(paths.T, nearest, axis=1))
        error = np.mean(out, axis=1) + np.mean(back, axis=1)
        return Near(error, self.senses[sense][goal], np.broadcast_to(places, back.shape), nearest)

    def measured(self, path: Points) -> tuple[float, complex, complex]:
        """Error of one path by all its points and all of the target's, nothing left out or taken from a grid; and how it lies
        on the points as they were given: factor and shift, both complex."""
        from scipy.spatial import cKDTree

        chord = _farthest(path)
        factor = np.conj(chord) / abs(chord) ** 2 * self.chord
        placed = _to_corner(path * factor)
        places = np.stack([placed.real, placed.imag], axis=-1)
        tree = cKDTree(places)
        errors = [
            float(
                np.mean(own.query(places)[0])
                + np.mean(tree.query(np.stack([sense.real, sense.imag], axis=-1))[0])
            )
            for own, sense in zip(self.trees, self.senses, strict=True)
        ]
        turn, corner = self.placed[errors[1] < errors[0]]
        return (
            min(errors),
            complex(factor * turn),
            complex(corner + turn * (placed[0] - path[0] * factor)),
        )


def _to_corner(paths: Points) -> Points:
    return np.asarray(
        paths - (np.min(paths.real, axis=0) + 1j * np.min(paths.imag, axis=0)), complex
    )


def _ends(paths: Points) -> Indices:
    """Ends of the longest chord of each path (steps, designs) between points extreme in one of some directions, (2, designs)."""
    angles = math.pi * np.arange(_DIRECTIONS) / _DIRECTIONS
    directions = np.stack([np.cos(angles), np.sin(angles)]).astype(np.float32)
    reach = np.stack([paths.real.T, paths.imag.T], axis=-1).astype(np.float32) @ directions
    number = np.arange(paths.shape[1])[:, None]
    high = np.argmax(reach, axis=1)
    low = np.argmin(reach, axis=1)
    chords = paths.T[number, high] - paths.T[number, low]
    best = np.argmax(chords.real**2 + chords.imag**2, axis=1)[:, None]
    return np.stack([np.take_along_axis(each, best, axis=1)[:, 0] for each in (low, high)])


def _farthest(points: Points) -> complex:
    """From one end of the longest chord to the other."""
    from scipy.spatial import ConvexHull, QhullError
    from scipy.spatial.distance import cdist

    try:
        points = points[ConvexHull(np.stack([points.real, points.imag], axis=-1)).vertices]
    except QhullError:  # all on one line: its ends are the extremes along it
        along = (points * np.conj(points[np.argmax(np.abs(points - points[0]))] - points[0])).real
        points = points[[int(np.argmin(along)), int(np.argmax(along))]]
    points = _ends_of_chords(points)
    places = np.stack([points.real, points.imag], axis=-1)
    a, b = divmod(int(np.argmax(cdist(places, places, "sqeuclidean"))), len(points))
    return complex(points[b] - points[a])


def _ends_of_chords(points: Points) -> Points:
    """Those that may end the longest chord: together two are no farther from the middle of a long one than it is long."""
    a = points[np.argmax(np.abs(points - points[0]))]
    b = points[np.argmax(np.abs(points - a))]
    away = np.abs(points - (a + b) / 2)
    least = abs(b - a) * (1 - 1e-9) - np.max(away)
    return np.asarray(points[away >= least])


def _spread(points: Points, count: int) -> Indices:
    """Numbers of points far from each other: each next one is the farthest from those taken."""
    sample = [0]
    gap = np.abs(points - points[0])
    while len(sample) < count:
        sample.append(int(np.argmax(gap)))
        gap = np.minimum(gap, np.abs(points - points[sample[-1]]))
    return np.asarray(sample, dtype=np.intp)


def _from_points(points: Points, paths: Points) -> Floats:
    """Mean distance from the points to the nearest one of each path, (designs,)."""
    x, y = (np.ascontiguousarray(part, dtype=np.float32) for part in (paths.real.T, paths.imag.T))
    px, py = (part.astype(np.float32)[:, None, None] for part in (points.real, points.imag))
    distances = np.empty(paths.shape[1])
    for first in range(0, len(distances), _BLOCK):
        block = slice(first, first + _BLOCK)
        square = x[None, block] - px
        square *= square
        more = y[None, block] - py
        more *= more
        square += more
        distances[block] = np.mean(np.sqrt(np.min(square, axis=2)), axis=0)
    return distances
