"""A follower that leaves its cam: where it flies, where it comes back, and how hard.

    N     = m s'' w^2 + c s' w + k s + P    what presses the follower on the cam, which turns evenly at w; s is the lift over its angle
    leave   where N falls through 0: the follower flies on by itself
    flight  m y'' + c y' + k y + P = 0, from the lift and the speed where it left: in closed form
    land    where y meets s again; knock, the speed at which it does

After a knock the follower springs back with a share of that speed, the restitution; where that is small it stays on.
[Norton, Cam Design and Manufacturing Handbook, ch. 10]
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from camgen.numerics import Floats, halved

RESTITUTION = (
    0.3  # speed after a knock over that before it: assumed, it moves what comes after the first hop
)
TURNS = 2  # a hop may reach into the next turn
_STEP = math.radians(0.1)  # of the cam, at which contact and flight are looked at
_STRETCH = 300  # steps that are looked at together
_ROUNDS = 40  # halvings of a step, down to the rounding of an angle
_STAYS = 3e-3  # of the greatest speed of the lift, below which a follower does not spring back
_EVEN = 1e-6  # of the greatest effort, by which what is constant may change

Lift = Callable[[Floats, int], Floats]  # lift and its derivatives by the cam's angle, rad


@dataclass(frozen=True)
class Spring:
    """What moves a follower beside its cam, in N, mm, s of a slide and N m, rad, s of an arm."""

    mass: float  # N s^2/mm, or kg m^2
    damping: float
    rate: float
    preload: float  # at lift 0, with all that is constant

    def push(self, lift: Lift, angle: Floats, speed: float) -> Floats:
        """What presses the follower on the cam at a speed, rad/s."""
        return np.asarray(
            self.mass * lift(angle, 2) * speed**2
            + self.damping * lift(angle, 1) * speed
            + self.rate * lift(angle, 0)
            + self.preload
        )

    def flight(self, place: float, velocity: float, time: Floats) -> tuple[Floats, Floats]:
        """Lift and velocity a time after it was let go, (n,) s."""
        half = self.damping / self.mass / 2
        square = self.rate / self.mass
        pull = -(self.preload + self.rate * place) / self.mass
        root = np.emath.sqrt(square - half**2)
        fade = np.exp(-half * time)
        swing = time if root == 0 else np.real(np.sin(root * time) / root)
        kick = fade * swing  # what a velocity of 1 does, and its change
        change = fade * np.real(np.cos(root * time)) - half * kick
        if square:
            fall = (1 - change - 2 * half * kick) / square  # what an acceleration of 1 does
        elif half:
            fall = (time - kick) / (2 * half)
        else:
            fall = time**2 / 2
        moved = place + velocity * kick + pull * fall
        return moved, velocity * change + pull * kick


@dataclass(frozen=True)
class Hop:
    """A flight between cam and cam."""

    leaves: float  # angle of the cam, rad, from 0 of the first turn
    lands: float  # inf where nothing brings it back
    height: float  # greatest distance of the follower from where the cam would have it, mm or rad
    knock: float  # speed at which they meet, mm/s or rad/s


@dataclass(frozen=True)
class Bounce:
    """What a follower that leaves its cam does."""

    lift_off: float  # least speed of the cam at which it leaves, rad/s
    hops: Sequence[Hop]  # over some turns, at least one

    @property
    def highest(self) -> Hop:
        """The hop that takes it farthest from its cam."""
        return max(self.hops, key=lambda hop: hop.height)

    @property
    def knock(self) -> float:
        """Greatest speed at which it meets the cam, mm/s or rad/s."""
        return max(hop.knock for hop in self.hops)


def spring_of(
    lift: Lift, effort: Floats, theta: Floats, speed: float, spring: Spring
) -> Spring | None:
    """The spring with what presses at all angles the same, effort at theta, (n,), being known; None where that changes over the turn.

    So weight and resistance of a slide count; that of an arm's mass, which pulls differently at each angle, does not go.
    """
    rest = effort - spring.push(lift, theta, speed)
    known = np.isfinite(rest)
    largest = float(np.max(np.abs(effort[known]), initial=0.0))
    if not spring.mass or np.ptp(rest[known]) > _EVEN * largest:
        return None
    constant = spring.preload + float(np.median(rest[known]))
    return Spring(spring.mass, spring.damping, spring.rate, constant)


def lift_off_speed(lift: Lift, spring: Spring, theta: Floats) -> float:
    """Least speed of the cam, rad/s, at which nothing presses somewhere; inf where there is none."""
    bend = spring.mass * lift(theta, 2)
    drag = spring.damping * lift(theta, 1)
    still = spring.rate * lift(theta, 0) + spring.preload
    if np.any(still <= 0):
        return 0.0
    with np.errstate(all="ignore"):
        speed = (
            2 * still / (-drag + np.sqrt(drag**2 - 4 * bend * still))
        )  # bend w^2 + drag w + still = 0
    return float(np.min(speed, where=(bend < 0) & np.isfinite(speed), initial=math.inf))


def hops(lift: Lift, spring: Spring, speed: float) -> list[Hop]:
    """Flights over some turns at a speed above 0, rad/s, from where the cam presses hardest; none where it presses everywhere."""
    angle = np.arange(0, math.tau, _STEP)
    begin = float(angle[int(np.argmax(spring.push(lift, angle, speed)))])
    return list(_hops(lift, spring, speed, begin, begin + TURNS * math.tau))


def _hops(lift: Lift, spring: Spring, speed: float, angle: float, end: float) -> Iterator[Hop]:
    stays = _STAYS * speed * float(np.max(np.abs(lift(np.arange(0, math.tau, _STEP), 1))))
    velocity = None  # of a follower that springs back
    while angle < end:
        if velocity is None:
            leave = _first(lambda a: spring.push(lift, a, speed), angle, angle + math.tau)
            if leave is None or leave >= end:
                return
            angle = leave
            velocity = float(_at(lift, angle, 1)) * speed
        place = float(_at(lift, angle, 0))
        left = angle
        sprung = velocity

        def gap(a: Floats, order: int = 0) -> Floats:
            flown = spring.flight(place, sprung, (a - left) / speed)  # noqa: B023
            return np.asarray(flown[order] - lift(a, order) * speed**order)

        land = _first(gap, left + _STEP, left + TURNS * math.tau)
        if land is None:  # nothing brings it back
            yield Hop(left, math.inf, math.inf, 0.0)
            return
        flown = np.linspace(left, land, max(3, math.ceil((land - left) / _STEP)))
        knock = -float(gap(np.array([land]), 1)[0])
        yield Hop(left, land, float(np.max(gap(flown))), max(knock, 0.0))
        angle = land
        back = RESTITUTION * knock
        velocity = float(_at(lift, land, 1)) * speed + back if back > stays else None


def _at(lift: Lift, angle: float, order: int) -> float:
    return float(lift(np.array([angle]), order)[0])


def _first(value: Callable[[Floats], Floats], low: float, high: float) -> float | None:
    """The first angle of a range at which a value is 0 or less, found between two steps by halving; None where it stays above."""
    steps = np.arange(low, high, _STEP)
    for begin in range(0, len(steps), _STRETCH):
        below = np.flatnonzero(value(steps[begin : begin + _STRETCH]) <= 0)
        if below.size:
            k = begin + int(below[0])
            if k == 0:
                return low
            return halved(
                lambda angle: bool(value(np.array([angle]))[0] <= 0),
                float(steps[k - 1]),
                float(steps[k]),
                _ROUNDS,
            )
    return None
