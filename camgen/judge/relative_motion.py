"""How one body moves as another one sees it: its path, the point of it that moves least, its straight way if it only slides."""

from __future__ import annotations

import functools

import numpy as np

from camgen.geometry.rings import Floats, Ints, Points
from camgen.judge.slabs import Course
from camgen.numerics import from_zero, magnitude

AT_REST = 1e-6  # mm, a path that is no motion
STRAIGHT = 1e-6  # mm, and share of a turn, by which a guest that slides may be off its straight way

ROUNDING = 1e-6  # share of a way by which what is on it may seem to go further
_SUDDEN = 4  # times the turns in the steps beside it, from which a step is looked into
_HALVINGS = 24
_REST = 0.2  # of its turn, that a step with a jump keeps as it is halved


class Motion:
    """How one body, the guest, moves as another, the home, sees it: home = shift + turn * guest, turn a unit complex number.

    theta: (n,) the grid; turns, shifts: (n,) complex on it.
    """

    def __init__(self, home: Course, guest: Course, theta: Floats) -> None:
        self.theta = theta
        self._courses = (home, guest)
        self.turns, self.shifts = self._read(theta)
        self._jumps = self._jumps_in(self._sudden()).tolist()

    def _sudden(self) -> Ints:
        """Steps of the grid in which the guest turns many times as far as in those before and after."""
        steps = np.abs(np.diff(self.turns))
        if len(steps) < 3:
            return np.empty(0, int)
        ahead = np.append(steps[2:], [0.0, 0.0])
        behind = np.append([0.0, 0.0], steps[:-2])
        return np.flatnonzero(steps > _SUDDEN * np.maximum(ahead, behind) + AT_REST)

    def _jumps_in(self, steps: Ints) -> Ints:
        """Those steps of the grid in which the turn does not grow less as the step is halved; all are halved together."""
        low = self.theta[steps]
        high = self.theta[steps + 1]
        first = self.turns[steps]
        last = self.turns[steps + 1]
        whole = np.abs(last - first)
        for _ in range(_HALVINGS if len(steps) else 0):
            middle = (low + high) / 2
            here, _ = self._read(middle)
            before = np.abs(here - first) > np.abs(last - here)
            high = np.where(before, middle, high)
            last = np.where(before, here, last)
            low = np.where(before, low, middle)
            first = np.where(before, first, here)
        return steps[np.abs(last - first) > _REST * whole]

    @property
    def at_rest(self) -> bool:
        """Whether there is no motion."""
        ways = np.abs(self.turns - self.turns[0]), np.abs(self.shifts - self.shifts[0])
        return bool(np.max(ways) < AT_REST)

    def at(self, theta: Floats) -> tuple[Points, Points]:
        """Turn and shift at other angles; in a step of the grid in which the guest jumps, on the way that it turns through."""
        turns, shifts = self._read(theta)
        for k in self._jumps:
            low = self.theta[k]
            high = self.theta[k + 1]
            inside = np.flatnonzero((theta > low) & (theta < high))
            if len(inside):
                share = (theta[inside] - low) / (high - low)
                turns[inside], shifts[inside] = self._between(k, share)
        return turns, shifts

    @functools.cached_property
    def halfway(self) -> tuple[Points, Points]:
        """Turns and shifts in the middle of each step of the grid, (n - 1,)."""
        return self.at((self.theta[1:] + self.theta[:-1]) / 2)

    def _between(self, k: int, share: Floats) -> tuple[Points, Points]:
        """From one pose of the grid to the next about the point that both have in common, or straight where they only slide."""
        by = self.turns[k + 1] / self.turns[k]
        way = self.shifts[k + 1] - by * self.shifts[k]
        turn = np.exp(1j * np.angle(by) * share)
        if abs(by - 1) < AT_REST:
            return self.turns[k] * turn, self.shifts[k] + share * (
                self.shifts[k + 1] - self.shifts[k]
            )
        centre = way / (1 - by)
        return self.turns[k] * turn, centre + (self.shifts[k] - centre) * turn

    def _read(self, theta: Floats) -> tuple[Points, Points]:
        """Turn and shift by the courses."""
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
        if not abs(way) > AT_REST or magnitude(self.turns - self.turns[0]) > STRAIGHT:
            return None
        along = way / abs(way)
        beside = ((self.shifts - first) * along.conjugate()).imag
        if magnitude(beside) > STRAIGHT:
            return None
        bend = magnitude(np.diff(self.shifts, 2)) * along
        return complex(first) - bend, complex(last) + bend

    def path(self, centre: complex, reach: float) -> Floats:
        """How far points of the guest, at most `reach` from a centre, have gone at most by each angle of the grid, (n,) mm."""
        if centre not in self._path_bounds:
            self._path_bounds[centre] = _path_bound(self.shifts + self.turns * centre)
        return self._path_bounds[centre] + reach * self._turn_bound

    def keeps_to_paths(self, centre: complex) -> bool:
        """Whether halfway between poses of the grid no point has gone further about a centre than the path, whatever its reach."""
        if centre not in self._keeping:
            self._keeping[centre] = _kept(
                self.steps_halfway(centre), np.diff(self.path(centre, 0.0))
            )
        return self._keeping[centre] and self._turns_kept

    def steps_halfway(self, centre: complex) -> Floats:
        """From the poses before and after to each halfway between them, (2, n - 1) mm, of a point of the guest."""
        turns, shifts = self.halfway
        return _steps(self.shifts + self.turns * centre, shifts + turns * centre)

    @functools.cached_property
    def turns_halfway(self) -> Floats:
        """The same of the turns."""
        return _steps(self.turns, self.halfway[0])

    @functools.cached_property
    def _turns_kept(self) -> bool:
        return _kept(self.turns_halfway, np.diff(self._turn_bound))

    @functools.cached_property
    def _keeping(self) -> dict[complex, bool]:
        return {}

    @functools.cached_property
    def _path_bounds(self) -> dict[complex, Floats]:
        return {}

    @functools.cached_property
    def _turn_bound(self) -> Floats:
        return _path_bound(self.turns)


def _steps(places: Points, halfway: Points) -> Floats:
    return np.abs(halfway - np.stack([places[:-1], places[1:]]))


def _kept(steps: Floats, way: Floats) -> bool:
    """Whether no step is longer than the way of the grid's step, but for rounding."""
    return bool(np.all(steps <= way * (1 + ROUNDING)))


def _path_bound(places: Points) -> Floats:
    """Bound of the way along a grid by each of its angles, (n,): the sum of chords, each with the greatest bend beside it.

    A bend is a second difference. Half of it bounds what the speed in a step differs from its chord's where the second
    derivative is no greater than at the four bends near by; a whole one is taken.
    """
    chords = np.diff(places)
    bends = np.pad(np.abs(np.diff(chords)), 2, mode="edge")
    near = np.max([bends[k : k + len(chords)] for k in range(4)], axis=0)
    return from_zero(np.abs(chords) + near)
