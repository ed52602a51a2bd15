"""A plane walker so slow that inertia does nothing: on which feet it stands, how it tilts, how far it gets, what slips.

It stands on an edge of the lower hull of its feet over which its centre of mass lies; of several that with the tilt nearest to the
last. By the lever rule that gives the loads of both feet. They move at unlike speeds, so one of them slips: with equal friction the
one with the smaller load, whatever the coefficient.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from camgen.numerics import Floats, Indices, Points

_ON_FLOOR = 1e-9  # mm, by which another foot may lie below the floor


@dataclass(frozen=True)
class SlowWalk:
    """Rows over a turn, (n,), both ends: tilt of the frame, rad, counter-clockwise; height of a point of it over the floor, mm; the
    two feet that it stands on, (2, n), with their shares of the load; where all feet are along the floor from that point, (k, n)."""

    tilt: Floats
    height: Floats
    pair: Indices
    shares: Floats
    along: Floats

    @property
    def least_share(self) -> float:
        """Of the load on one of two feet: at 0 it tips over the other one."""
        return float(np.min(self.shares))

    @cached_property
    def _moves(self) -> Floats:
        """Of both feet that bear, along the floor from each row to the next, (2, n - 1) mm."""
        pair = self.pair[:, :-1]
        rows = np.arange(pair.shape[1])
        return np.asarray(self.along[pair, rows + 1] - self.along[pair, rows])

    @cached_property
    def _greater(self) -> Indices:
        return np.asarray(np.argmax(self.shares[:, :-1], axis=0))

    @property
    def way(self) -> float:
        """Of the frame in a turn, mm, with equal friction of all feet: the foot with the greater load sticks."""
        rows = np.arange(self._moves.shape[1])
        return -float(np.sum(self._moves[self._greater, rows]))

    def way_between(self, least: float, greatest: float) -> tuple[float, float]:
        """Least and greatest way in a turn, mm, if the friction of each foot is anywhere between two coefficients."""
        loads = self.shares[:, :-1]
        may_stick = greatest * loads >= least * np.max(loads, axis=0)
        back = np.max(np.where(may_stick, self._moves, -np.inf), axis=0)
        ahead = np.min(np.where(may_stick, self._moves, np.inf), axis=0)
        return -float(np.sum(back)), -float(np.sum(ahead))

    @property
    def rubbing(self) -> Floats:
        """What a friction of 1 does along the floor on both feet that bear, (2, n), as a share of the weight.

        On the foot that slips against its motion, on the other one as much the other way.
        """
        moves = self._moves[:, np.r_[: self._moves.shape[1], 0]]  # the last row is the first one
        first = np.sign(moves[1] - moves[0]) * np.min(self.shares, axis=0)
        return np.stack([first, -first])

    @property
    def slip(self) -> float:
        """Of the foot that does not stick, in a turn, mm, by its share of the load: times weight and friction it is work."""
        slips = np.abs(self._moves[0] - self._moves[1])
        return float(np.sum(slips * np.min(self.shares[:, :-1], axis=0)))


def slow_walk(feet: Points, centre: Points, point: complex) -> SlowWalk | int:
    """How a frame walks on feet, (k, n) complex mm in it, y up, with its centre of mass, (n,); or the row at which it falls.

    point: of the frame, whose height and way are told.
    """
    edges = list(itertools.permutations(range(len(feet)), 2))
    tilts = np.empty((len(edges), feet.shape[1]))
    shares = np.empty_like(tilts)
    for row, (left, right) in enumerate(edges):
        way = feet[right] - feet[left]
        length = np.abs(way)
        with np.errstate(all="ignore"):
            back = np.conj(way) / length
        share = np.real(back * (centre - feet[left])) / length
        above = np.min(np.imag(back * (feet - feet[left])), axis=0) >= -_ON_FLOOR
        stands = above & (share >= 0) & (share <= 1) & (np.imag(back * (centre - feet[left])) > 0)
        tilts[row] = np.where(stands, -np.angle(way), np.nan)
        shares[row] = share
    chosen = np.empty(feet.shape[1], np.intp)
    last = 0.0
    for k in range(feet.shape[1]):
        off = np.abs(tilts[:, k] - last)
        if np.all(np.isnan(off)):
            return k
        chosen[k] = np.nanargmin(off)
        last = float(tilts[chosen[k], k])
    rows = np.arange(feet.shape[1])
    tilt = tilts[chosen, rows]
    pair = np.array(edges).T[:, chosen]
    turn = np.exp(1j * tilt)
    right_share = shares[chosen, rows]
    height = np.imag(turn * (point - feet[pair[0], rows]))
    return SlowWalk(
        tilt, height, pair, np.stack([1 - right_share, right_share]), np.real(turn * (feet - point))
    )
