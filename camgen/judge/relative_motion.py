"""How one body moves as another one sees it: its path, the point of it that moves least, its straight way if it only slides."""

from __future__ import annotations

import functools

import numpy as np

from camgen.geometry.rings import Floats, Points
from camgen.judge.slabs import Course

AT_REST = 1e-6  # mm, a path that is no motion
STRAIGHT = 1e-6  # mm, and share of a turn, by which a guest that slides may be off its straight way


class Motion:
    """How one body, the guest, moves as another, the home, sees it: home = shift + turn * guest, turn a unit complex number.

    theta: (n,) the grid; turns, shifts: (n,) complex on it.
    """

    def __init__(self, home: Course, guest: Course, theta: Floats) -> None:
        self.theta = theta
        self._courses = (home, guest)
        self.turns, self.shifts = self.at(theta)

    @property
    def at_rest(self) -> bool:
        """Whether there is no motion."""
        ways = np.abs(self.turns - self.turns[0]), np.abs(self.shifts - self.shifts[0])
        return bool(np.max(ways) < AT_REST)

    def at(self, theta: Floats) -> tuple[Points, Points]:
        """Turn and shift at other angles."""
        (alpha, p), (beta, q) = (course(theta) for course in self._courses)
        back = np.exp(-1j * alpha)
        return np.exp(1j * (beta - alpha)), (q - p) * back

    @functools.cached_property
    def calmest(self) -> complex:
        """The point of the guest that moves least, by the mean square of its steps; a pin joint's centre."""
        turns = np.diff(self.turns)
        shifts = np.diff(self.shifts)
        weight = float(np.sum(np.abs(turns) ** 2))
        return complex(-np.sum(np.conj(turns) * shifts) / weight) if weight > AT_REST**2 else 0j

    @functools.cached_property
    def straight(self) -> tuple[complex, complex] | None:
        """Ends of the shift of a guest that only slides on a straight line, bends between the grid's angles included."""
        first = self.shifts[np.argmax(np.abs(self.shifts - self.shifts[0]))]
        last = self.shifts[np.argmax(np.abs(self.shifts - first))]
        way = complex(last - first)
        if not abs(way) > AT_REST or float(np.max(np.abs(self.turns - self.turns[0]))) > STRAIGHT:
            return None
        along = way / abs(way)
        beside = ((self.shifts - first) * along.conjugate()).imag
        if float(np.max(np.abs(beside))) > STRAIGHT:
            return None
        bend = float(np.max(np.abs(np.diff(self.shifts, 2)))) * along
        return complex(first) - bend, complex(last) + bend

    def path(self, centre: complex, reach: float) -> Floats:
        """How far points of the guest, at most `reach` from a centre, have gone at most by each angle of the grid, (n,) mm."""
        if centre not in self._path_bounds:
            self._path_bounds[centre] = _path_bound(self.shifts + self.turns * centre)
        return self._path_bounds[centre] + reach * self._turn_bound

    @functools.cached_property
    def _path_bounds(self) -> dict[complex, Floats]:
        return {}

    @functools.cached_property
    def _turn_bound(self) -> Floats:
        return _path_bound(self.turns)


def _path_bound(places: Points) -> Floats:
    """Bound of the way along a grid by each of its angles, (n,): the sum of chords, each with the greatest bend beside it.

    A bend is a second difference. Half of it bounds what the speed in a step differs from its chord's where the second
    derivative is no greater than at the four bends near by; a whole one is taken.
    """
    chords = np.diff(places)
    bends = np.pad(np.abs(np.diff(chords)), 2, mode="edge")
    near = np.max([bends[k : k + len(chords)] for k in range(4)], axis=0)
    return np.concatenate([[0.0], np.cumsum(np.abs(chords) + near)])
