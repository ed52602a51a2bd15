"""A follower that leaves its cam: where it flies, where it comes back, and how hard.

    N     = m s'' w^2 + c s' w + k s + P    what presses the follower on the cam, which turns evenly at w; s is the lift over its angle
    leave   where N falls through 0: the follower flies on by itself
    flight  m y'' + c y' + k y + P = 0, from the lift and the speed where it left: in closed form
    land    where y meets s again; knock, the speed at which it does

After a knock the follower springs back with a share of that speed, the restitution; where that is small it stays on.
m, c, k, P of a follower in a machine are those that give what presses at all angles: what moves with it counts as mass at its place.
[Norton, Cam Design and Manufacturing Handbook, ch. 10]
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from camgen.machine.forces import Forces
from camgen.machine.model import Cam
from camgen.machine.run import Run
from camgen.numerics import Floats, halved, magnitude

TURNS = 2  # a hop may reach into the next turn
_STEP = math.radians(0.1)  # of the cam, at which contact and flight are looked at
_STRETCH = 300  # steps that are looked at together
_ROUNDS = 40  # halvings of a step, down to the rounding of an angle
_STAYS = 3e-3  # of the greatest speed of the lift, below which a follower does not spring back
_EVEN = 1e-9  # of a cam's turning, by which its rate may change
_FITS = 1e-2  # of the greatest effort, by which one mass on one spring may miss it
_NONE = 1e-9  # of it, or of a lift, that is rounding
_TURN = np.linspace(0, math.tau, 1441)

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
        rate = math.sqrt(abs(square - half**2))
        # what a velocity of 1 does, and its change
        if square >= half**2:
            fade = np.exp(-half * time)
            kick = fade * (np.sin(rate * time) / rate if rate else time)
            change = fade * np.cos(rate * time) - half * kick
        else:  # it creeps back
            fade = np.exp(-square / (half + rate) * time)
            kick = fade * -np.expm1(-2 * rate * time) / (2 * rate)
            change = fade * (1 + np.exp(-2 * rate * time)) / 2 - half * kick
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

    leaves: float  # angle, rad: of the cam, or of the machine
    lands: float  # inf where nothing brings it back
    height: float  # greatest distance of the follower from where the cam would have it, mm or rad
    knock: float  # speed at which they meet, mm/s or rad/s


@dataclass(frozen=True)
class Bounce:
    """What a follower that leaves its cam does."""

    lift_off: float  # least speed of the machine at which it leaves, rad/s
    hops: Sequence[Hop]  # over some turns of the cam
    turn: float  # of the cam, rad of the machine's angle

    @property
    def highest(self) -> Hop:
        """The hop that takes it farthest from its cam."""
        return max(self.hops, key=lambda hop: hop.height)

    @property
    def lost(self) -> float:
        """Share of the motion that the follower flies; 1 where the last hop outlasts the turns that were looked at."""
        flown = sum(abs(hop.lands - hop.leaves) for hop in self.hops)
        return min(1.0, flown / (TURNS * self.turn))

    @property
    def knock(self) -> float:
        """Greatest speed at which it meets the cam, mm/s or rad/s."""
        return max(hop.knock for hop in self.hops)


@dataclass(frozen=True)
class Contact:
    """A cam that turns evenly, and what presses its follower on it; its lift is over the cam's angle, forwards from 0 of its law."""

    lift: Lift
    spring: Spring
    rate: float  # of the cam over theta, with its sign
    begin: float  # angle of the cam at theta 0, rad
    sense: float  # 1 or -1: the cam's, as time goes on

    def bounce(self, speed: float, restitution: float) -> Bounce:
        """What the follower does at a speed of the machine, rad/s; angles are theta."""
        flown = hops(self.lift, self.spring, abs(speed * self.rate), restitution)
        told = [
            replace(hop, leaves=self._theta(hop.leaves), lands=self._theta(hop.lands))
            for hop in flown
        ]
        return Bounce(self.lift_off, told, math.tau / abs(self.rate))

    @property
    def lift_off(self) -> float:
        """Least speed of the machine, rad/s, at which nothing presses somewhere; inf where there is none."""
        return lift_off_speed(self.lift, self.spring, _TURN) / abs(self.rate)

    def springs(self, theta: Floats, push: Floats) -> tuple[float, float]:
        """Rate and preload of what pushes the follower at rest on its cam so at theta, both (n,)."""
        lift = self.lift(self.sense * (self.rate * theta + self.begin), 0)
        rate, preload = _shares([lift, np.ones_like(push)], push, magnitude(push))
        return rate, preload

    def _theta(self, angle: float) -> float:
        return (self.sense * angle - self.begin) / self.rate


def contact_of(cam: Cam, run: Run, still: Forces) -> Contact | None:
    """How a follower is pressed on its cam, by what it takes over a turn; without friction in its pins.

    still: the same at rest. None where the cam turns unevenly or its law is not that of a turn, and where mass or pull change too
    much over the turn for one mass on one spring.
    """
    angle, turning, bend = run.angle(cam.cam)
    rate = float(np.mean(turning))
    if not rate or max(np.ptp(turning), np.max(np.abs(bend))) > _EVEN * abs(rate):
        return None
    ends = np.array([cam.law(np.array([0.0, math.tau]), order) for order in (0, 1)])
    if np.ptp(ends, axis=1).max() > _NONE:
        return None
    sense = math.copysign(1.0, rate * run.machine.speed)
    lowest = float(np.min(cam.leaves * cam.law(_TURN, 0)))

    def lift(forwards: Floats, order: int) -> Floats:
        law = cam.law(np.mod(sense * forwards, math.tau), order)
        return np.asarray(cam.leaves * sense**order * law - (0.0 if order else lowest))

    forwards = sense * (angle - cam.phase)
    spring = fitted_spring(
        [lift(forwards, order) for order in range(3)],
        abs(rate * run.machine.speed),
        cam.leaves * still.contacts[cam.name],
        cam.leaves * run.forces().contacts[cam.name],
    )
    begin = float(angle[0]) - cam.phase - rate * float(run.theta[0])
    return None if spring is None else Contact(lift, spring, rate, begin, sense)


def fitted_spring(
    lift: Sequence[Floats], speed: float, still: Floats, effort: Floats
) -> Spring | None:
    """The mass on a spring that takes what a follower does; None where none does.

    lift: it and its derivatives by the cam's angle, (n,) each; speed: of the cam, rad/s; still, effort: what presses at rest and at
    this speed, (n,).
    """
    largest = magnitude(effort)
    if not np.all(np.isfinite(effort)) or not largest:
        return None
    rate, preload = _shares([lift[0], np.ones_like(still)], still, largest)
    mass, damping = _shares([lift[2] * speed**2, lift[1] * speed], effort - still, largest)
    if mass <= 0:
        return None
    spring = Spring(mass, damping, rate, preload)
    fitted = mass * lift[2] * speed**2 + damping * lift[1] * speed + rate * lift[0] + preload
    return spring if np.max(np.abs(fitted - effort)) <= _FITS * largest else None


def _shares(of: Sequence[Floats], total: Floats, largest: float) -> list[float]:
    """By how much two curves make up a third; 0 of one that makes up nothing of the largest."""
    sizes = [magnitude(each) or 1.0 for each in of]
    columns = np.stack([each / size for each, size in zip(of, sizes, strict=True)], axis=1)
    found = np.linalg.lstsq(columns, total, rcond=None)[0]
    pairs = zip(found.tolist(), sizes, strict=True)
    return [share / size if abs(share) > _NONE * largest else 0.0 for share, size in pairs]


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


def hops(lift: Lift, spring: Spring, speed: float, restitution: float) -> list[Hop]:
    """Flights over some turns at a speed above 0, rad/s, from where the cam presses hardest; none where it presses everywhere.

    restitution: speed after a knock over that before it, which moves what comes after the first hop.
    """
    angle = np.arange(0, math.tau, _STEP)
    begin = float(angle[int(np.argmax(spring.push(lift, angle, speed)))])
    return list(_hops(lift, spring, (speed, restitution), begin, begin + TURNS * math.tau))


def _hops(
    lift: Lift, spring: Spring, knocks: tuple[float, float], angle: float, end: float
) -> Iterator[Hop]:
    """Flights from an angle to another; knocks: speed and restitution."""
    speed, restitution = knocks
    stays = _STAYS * speed * magnitude(lift(np.arange(0, math.tau, _STEP), 1))
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
        back = restitution * knock
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
