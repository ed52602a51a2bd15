"""A machine of one degree of freedom in time: how it runs up from rest, how its speed swings once it has, where it stalls.

With J(theta) the inertia of all bodies as the shaft feels it, M what the motor gives and T what loads and friction take,

    d(J w^2 / 2) = (M(w) - T(theta, w)) dtheta

in which no derivative of J is asked for. T is a parabola in w: weights and springs, damping, and what friction takes of reactions
that grow with w^2. Friction is that at even speed; what an acceleration adds to the reactions is left out.
Solutions of one equation of first order never cross: a machine that runs up comes ever nearer to its settled turn, from below,
and one that gets through its first turn does not stall later.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from camgen.numerics import Floats, halved

NEAR = 0.95  # of the settled speed at the same angle, at which a machine has run up
MOST_TURNS = 200  # of the period, in which it has to
_FIRST = 1e-9  # of a cell, over which a start from rest is uniformly accelerated
_ERROR = 1e-5  # of energy and of time, that a step of the lower order may be off; a turn is then right to about 1e-5
_SMALL = 1e-2  # of the energy without load: of less a step may be off as much as of this
_STALLS = 1e-12  # of a cell: a step that has to be shorter shows that the speed goes to 0
_SETTLED = 1e-8  # of the energy, to which the settled turn returns to itself
_HALVINGS = 26  # of a bracket of energy or inertia
_ROUNDS = 20  # of the search for the settled turn, by Aitken's extrapolation of three turns

Cell = tuple[tuple[float, float, float, float], ...]  # cubics of J, and of T's three coefficients
State = tuple[float, float, float]  # place in a cell, energy, J, and time, s


@dataclass(frozen=True)
class MotorLine:
    """A motor whose torque falls in a straight line from standstill to its speed without load."""

    stall: float  # N m
    no_load: float  # rad/s

    @property
    def slope(self) -> float:
        """By which its torque falls, N m s/rad."""
        return self.stall / self.no_load

    def torque(self, speed: float) -> float:
        """At a speed, rad/s, N m."""
        return self.stall - self.slope * speed


@dataclass(frozen=True)
class Course:
    """A shaft from rest, row by row: how far it has turned, rad, its speed, rad/s, and when, s; stalls: whether it stops there."""

    angle: Floats
    speed: Floats
    time: Floats
    stalls: bool = False


@dataclass(frozen=True)
class ShaftLoad:
    """What a machine asks of its shaft, (n,) evenly over a period of its angle, rad, without the end; in the sense in which it
    turns."""

    period: float
    inertia: Floats  # kg m^2
    still: Floats  # T = still + damping w + inertial w^2, N m
    damping: Floats
    inertial: Floats

    def with_flywheel(self, inertia: float) -> ShaftLoad:
        """With more inertia, kg m^2, that turns evenly with the shaft."""
        return replace(self, inertia=self.inertia + inertia)

    def torque(self, speed: float) -> Floats:
        """T at an even speed, rad/s, (n,) N m."""
        return self.still + speed * (self.damping + speed * self.inertial)

    # ---- a motor that gives one torque ------------------------------------------------------------------------------

    def even_torque(self, mean: float) -> Floats:
        """Speed over the period, (n,) rad/s, of its mean over time, under a motor that gives the mean torque at all angles.

        In closed form: the energy is what the torque leaves over, whatever the speed. T is that at the mean speed.
        """
        return self._speeds(self.surplus(mean), mean)

    def surplus(self, mean: float) -> Floats:
        """Energy of the shaft over the period less its least, (n,) J; as above."""
        torque = self.torque(mean)
        sums = 13 * (torque + np.roll(torque, -1)) - np.roll(torque, 1) - np.roll(torque, -2)
        work = np.concatenate([[0.0], np.cumsum(np.mean(torque) - sums / 24)[:-1]])
        return np.asarray((work - np.min(work)) * self.period / len(work))

    def _speeds(self, surplus: Floats, mean: float) -> Floats:
        least = float(np.min(self.inertia)) * mean**2 / 2
        most = float(np.max(self.inertia)) * mean**2 / 2 + float(np.max(surplus))

        def speeds(energy: float) -> Floats:
            return np.asarray(np.sqrt(2 * (energy + surplus) / self.inertia))

        def fits(energy: float) -> bool:
            return bool(1 / np.mean(1 / speeds(energy)) >= mean)

        low = 1e-12 * least
        return speeds(halved(fits, low, most, _HALVINGS))

    def flywheel_for(self, swing: float, mean: float) -> float:
        """Inertia, kg m^2, by which the speed swings no more than so under an even torque; 0 where it does not."""
        surplus = self.surplus(mean)

        def fits(inertia: float) -> bool:
            return swing_of(self.with_flywheel(inertia)._speeds(surplus, mean)) <= swing

        if fits(0.0):
            return 0.0
        most = float(np.mean(self.inertia))
        while not fits(most):
            most *= 4
        return halved(fits, 0.0, most, _HALVINGS)

    # ---- a motor whose torque falls with the speed ------------------------------------------------------------------

    def run_up(self, motor: MotorLine, settled: Floats | None = None) -> Course:
        """From rest at the start of the period, until the speed is NEAR that of the settled turn, (n,); without it over a period.

        Ends where it stalls, or after MOST_TURNS.
        """
        turns = 1 if settled is None else MOST_TURNS
        n = len(self.inertia)
        rows = [(0.0, 0.0, 0.0)]
        before = 0.0
        for place, energy, time in self._march(motor, None, turns):
            speed = math.sqrt(2 * energy / self.inertia[int(place) % n])
            row = (place * self.period / n, speed, time)
            if energy == 0:
                angle, speeds, times = np.array([*rows, row]).T
                return Course(angle, speeds, times, stalls=True)
            share = 0.0 if settled is None else speed / float(settled[int(place) % n])
            if share >= NEAR:
                part = (NEAR - before) / (share - before)
                cut = np.array(rows[-1]) * (1 - part) + np.array(row) * part
                return Course(*np.array([*rows, cut]).T)
            before = share
            rows.append(row)
        return Course(*np.array(rows).T)

    def settled(self, motor: MotorLine) -> Floats | None:
        """Speed over the period once it comes back to itself, (n,) rad/s; None where the machine stalls from rest."""
        energy = self._after_turn(motor, None)
        for _ in range(_ROUNDS if energy else 0):
            once = self._after_turn(motor, energy)
            twice = self._after_turn(motor, once)
            bend = twice - 2 * once + energy
            near = abs(once - energy) <= _SETTLED * energy or not bend
            best = twice if near else energy - (once - energy) ** 2 / bend
            energy = best if best > 0 else twice
            if near:
                break
        if not energy:
            return None
        energies = [energy, *(row[1] for row in self._march(motor, energy, 1))][:-1]
        return np.asarray(np.sqrt(2 * np.array(energies) / self.inertia))

    def _after_turn(self, motor: MotorLine, energy: float | None) -> float:
        """Energy after a period, J, from one at its start, None: rest; 0 where it stalls."""
        last = 0.0
        for _, now, _ in self._march(motor, energy, 1):
            last = now
        return last

    @cached_property
    def _cells(self) -> list[Cell]:
        """Between each sample and the next, in a place from 0 to 1, the cubics through four samples."""
        cubics = [_cubics(each) for each in (self.inertia, self.still, self.damping, self.inertial)]
        return list(zip(*cubics, strict=True))

    def _march(
        self, motor: MotorLine, energy: float | None, turns: int
    ) -> Iterator[tuple[float, float, float]]:
        """Place in samples, energy, J, and time, s, at the end of each cell, from an energy at the start, None: rest.

        The last row is where it stalls, with an energy of 0.
        """
        n = len(self.inertia)
        width = self.period / n
        begin = 0.0
        time = 0.0
        if energy is None:
            given = motor.stall - float(self.still[0])
            if given <= 0:
                yield 0.0, 0.0, 0.0
                return
            begin = _FIRST
            energy = given * width * begin
            time = 2 * width * begin / math.sqrt(2 * energy / float(self.inertia[0]))
        for k in range(turns * n):
            begin, energy, time = _through(self._cells[k % n], motor, width, (begin, energy, time))
            if not energy:
                yield k + begin, 0.0, time
                return
            begin = 0.0
            yield k + 1.0, energy, time


def swing_of(speeds: Floats) -> float:
    """Greatest less least speed, as a share of what lies in the middle of both."""
    most = float(np.max(speeds))
    least = float(np.min(speeds))
    return 2 * (most - least) / (most + least)


def mean_speed(speeds: Floats) -> float:
    """Over time, of speeds evenly over the angle."""
    return float(1 / np.mean(1 / speeds))


def _cubics(samples: Floats) -> list[tuple[float, float, float, float]]:
    before = np.roll(samples, 1)
    after = np.roll(samples, -1)
    next_one = np.roll(samples, -2)
    rows = (
        samples,
        -before / 3 - samples / 2 + after - next_one / 6,
        (before + after) / 2 - samples,
        (next_one - before) / 6 + (samples - after) / 2,
    )
    return [(a, b, c, d) for a, b, c, d in np.stack(rows, axis=1).tolist()]


def _through(cell: Cell, motor: MotorLine, width: float, state: State) -> State:
    """Through a cell to its end, or to where the energy is 0."""
    place, energy, time = state
    step = 1.0 - place
    while place < 1.0:
        left = 1.0 - place
        step = min(step, left)
        found = _stepped(cell, motor, width, (place, energy, time), step)
        if found is None:
            growth = 0.25
        else:
            (_, there, then), error = found
            growth = min(5.0, max(0.2, 0.9 * error ** (-1 / 3))) if error else 5.0
            if error <= 1:
                place = 1.0 if step == left else place + step
                energy = there
                time = then
        if growth < 1 and step < _STALLS:
            return place, 0.0, time
        step *= growth
    return place, energy, time


def _stepped(
    cell: Cell, motor: MotorLine, width: float, state: State, step: float
) -> tuple[State, float] | None:
    """After a step along a cell, and by how much too far off it is; None where the energy falls to 0 on the way.

    A Rosenbrock pair of order 3 and 2 (Rodas3), stiffly stable: a light machine follows its motor's line almost at once.
    """
    place, energy, time = state
    power, haste = _rates(cell, motor, width, place, energy)
    power_slope, haste_slope, power_drift, haste_drift = _slopes(cell, motor, width, place, energy)
    per = 2 / step
    stiff = per - power_slope
    first = (power + step * power_drift / 2) / stiff
    second = (power + 4 * first / step + 3 * step * power_drift / 2) / stiff
    first_time = (haste + step * haste_drift / 2 + haste_slope * first) / per
    second_time = (
        haste + 4 * first_time / step + 3 * step * haste_drift / 2 + haste_slope * second
    ) / per
    there = energy + 2 * first
    if there <= 0:
        return None
    power, haste = _rates(cell, motor, width, place + step, there)
    third = (power + (first - second) / step) / stiff
    third_time = (haste + (first_time - second_time) / step + haste_slope * third) / per
    there += third
    if there <= 0:
        return None
    power, haste = _rates(cell, motor, width, place + step, there)
    last = (power + (first - second - 8 / 3 * third) / step) / stiff
    passed = (first_time - second_time - 8 / 3 * third_time) / step
    last_time = (haste + passed + haste_slope * last) / per
    there += last
    if there <= 0:
        return None
    then = time + 2 * first_time + third_time + last_time
    least = _SMALL * cell[0][0] * motor.no_load**2 / 2
    error = max(abs(last) / max(there, least), abs(last_time) / max(then, width / motor.no_load))
    return (place + step, there, then), error / _ERROR


def _rates(
    cell: Cell, motor: MotorLine, width: float, place: float, energy: float
) -> tuple[float, float]:
    """Of energy and time along a cell, J and s."""
    inertia, still, damping, inertial = (
        a + place * (b + place * (c + place * d)) for a, b, c, d in cell
    )
    speed = math.sqrt(2 * energy / inertia)
    taken = still + speed * (damping + speed * inertial)
    return width * (motor.torque(speed) - taken), width / speed


def _slopes(
    cell: Cell, motor: MotorLine, width: float, place: float, energy: float
) -> tuple[float, float, float, float]:
    """How both rates change by the energy, and by the place."""
    inertia, _, damping, inertial = (
        a + place * (b + place * (c + place * d)) for a, b, c, d in cell
    )
    inertia_drift, still_drift, damping_drift, inertial_drift = (
        b + place * (2 * c + place * 3 * d) for _, b, c, d in cell
    )
    speed = math.sqrt(2 * energy / inertia)
    speed_slope = 1 / (inertia * speed)
    speed_drift = -speed * inertia_drift / (2 * inertia)
    power_slope = -width * (motor.slope + damping + 2 * speed * inertial)
    taken_drift = still_drift + speed * (damping_drift + speed * inertial_drift)
    haste_slope = -width / speed**2
    return (
        power_slope * speed_slope,
        haste_slope * speed_slope,
        power_slope * speed_drift - width * taken_drift,
        haste_slope * speed_drift,
    )
