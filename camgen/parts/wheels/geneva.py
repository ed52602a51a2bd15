"""Geneva drives: a pin on a crank takes a slotted wheel along by one station a turn; a disc holds the wheel meanwhile.

    crank       about the origin, its pin on Ox; the wheel's axis at the distance on Ox when both are in the middle of a drive
    drive       the crank's angle, -half to +half, over which the pin is in a slot: it enters along it, without an impact
    lock        the crank's disc, on the level of the wheel, in one of its hollows during the dwell
    corner      of the wheel, where a hollow meets the rim: it passes the lock's disc as the drive begins and ends

The lock's disc ends on the line of both axes as the drive begins: further on a hollow that turns would meet it. Inside it is
relieved by what sweeps past: on a circle that clears the rim, then beside a corner's path as the crank sees it, and straight
from there to its end.  [the wheel's angle is arg(C - r exp(-it)) of the other sense]

An inner wheel goes round its crank: its slots open inwards, and both turn in one sense. The slots pass over the crank's axis,
so the lock is a crescent opposite the pin, with no hub; it ends like the other's disc, and a corner's path hollows it out. In
the middle of a drive the pin is at its farthest from the wheel's axis.  [the wheel's angle is arg(C + r exp(it))]
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, Literal

import numpy as np

from camgen.errors import DesignError
from camgen.geometry.outlines import (
    Arc,
    Contour,
    Floats,
    Line,
    Piece,
    Points,
    Smooth,
    end_point,
    start_point,
)
from camgen.numerics import halved

_MIDDLE = 0.1  # of a dwell, in which a crescent's ends hold the wheel alike
# Of what is tried in place of sizes that cannot be: steps of a pin's radius, mm, and distances of the axes up to so many times.
_PIN_STEP = 0.1
_FARTHER = 3.0


@dataclass(frozen=True)
class _Slotted:
    """A crank with one pin and a wheel with slots."""

    stations: int
    distance: float  # of the axes, mm
    pin: float  # radius, mm
    wall: float  # between a slot and the hollow beside it where they are nearest, mm
    slot_air: float = 0.05  # on each side of the pin, mm
    lock_air: float = 0.05  # between lock and hollow, mm
    floor: float = 0.1  # from the pin at its deepest to the end of its slot, mm
    sense: ClassVar[Literal[1, -1]]  # in which the wheel turns as the crank turns on

    def _check(self, most: float) -> None:
        """DesignError of too few slots, a pin thicker than most, mm, or a wheel without a rim beside its slots."""
        if self.stations < 3:
            raise DesignError("stations of a Geneva wheel", self.stations, 3, "", "", "use more")
        if not self.pin < most:
            raise DesignError(
                "radius of the pin",
                self.pin,
                most,
                "mm",
                "",
                "use a smaller pin, or put the axes further apart",
            )
        if not self.horn > 0:
            raise DesignError(
                "width of the wheel's rim between slot and hollow",
                self.horn * self.rim,
                0,
                "mm",
                "",
                "use a smaller pin, or more stations",
            )

    @property
    def pitch(self) -> float:
        """Angle from station to station, rad."""
        return math.tau / self.stations

    @property
    def crank(self) -> float:
        """From the crank's axis to the middle of its pin, mm: the pin enters along the slot."""
        return self.distance * math.sin(self.pitch / 2)

    @property
    def rim(self) -> float:
        """Radius of the wheel, mm: its slots reach as far as the pin's side as it enters."""
        return math.hypot(self.distance * math.cos(self.pitch / 2), self.pin)

    @property
    def lock(self) -> float:
        """Radius of the lock's disc, mm: what slot and wall leave."""
        return self.crank - self.pin - self.slot_air - self.wall - self.lock_air

    @property
    def hollow(self) -> float:
        """Radius of the wheel's hollows, mm."""
        return self.lock + self.lock_air

    @property
    def _corner_angle(self) -> float:
        """Of a corner about the wheel's axis, from the middle of its hollow, rad."""
        rest = self.distance**2 + self.rim**2 - self.hollow**2
        return math.acos(rest / (2 * self.distance * self.rim))

    @property
    def _hollow_half(self) -> float:
        """Half of the angle of a hollow about its own centre, rad."""
        rest = self.distance**2 + self.hollow**2 - self.rim**2
        return math.acos(rest / (2 * self.distance * self.hollow))

    @property
    def _mouth(self) -> float:
        """Half of the angle of a slot's mouth about the wheel's axis, rad."""
        return math.asin((self.pin + self.slot_air) / self.rim)

    @property
    def horn(self) -> float:
        """Angle of the rim between slot and hollow about the wheel's axis, rad."""
        return self.pitch / 2 - self._mouth - self._corner_angle

    @property
    def half(self) -> float:
        """Half of the crank's angle over which it drives, rad."""
        return math.pi / 2 + self.sense * self.pitch / 2

    @property
    def slot_end(self) -> float:
        """From the wheel's axis to the middle of the slots' round ends, mm."""
        beyond = self.floor - self.slot_air
        return self.distance + self.sense * self.crank + self.sense * beyond

    @property
    def speed(self) -> float:
        """Greatest speed of the wheel over that of the crank."""
        sine = math.sin(self.pitch / 2)
        return sine / (1 + self.sense * sine)

    def motion(self, t: Any, order: int = 0) -> Floats:
        """The wheel's angle from the middle of the drive while the pin drives, rad, or its derivatives, order 0..3."""
        turn = 1j * self.sense
        spoke = self.sense * self.crank * np.exp(turn * np.asarray(t, float))
        w = self.distance + spoke
        if order == 0:
            return np.asarray(self.sense * np.angle(w))
        first = turn * spoke / w
        if order == 1:
            return np.asarray(self.sense * first.imag)
        second = -spoke / w - first**2
        if order == 2:
            return np.asarray(self.sense * second.imag)
        third = -turn * spoke / w - 3 * first * second - first**3
        return np.asarray(self.sense * third.imag)

    def _corner(self, t: Any, order: int) -> Points:
        """The corner of the hollow that the lock leaves as the drive begins, as the crank sees it, order 0..3, complex mm.

        Beside the driving slot of an inner wheel, beside the one before of an outer wheel.
        """
        t = np.asarray(t, float)
        ahead = self.sense * (self.pitch / 2 - self._corner_angle)
        arm = self.sense * self.rim * np.exp(1j * (self.motion(t) + ahead - t))
        axis = -self.sense * self.distance * np.exp(-1j * t)
        return _seen(axis, arm, [self.motion(t, k) - (k == 1) for k in range(1, order + 1)])

    def _relief(self, t: Any, order: int) -> Points:
        """The lock's edge beside that path, on its left by the air."""
        return _beside(self._corner, self.lock_air, t, order)

    def _edge(self, hollow: Arc) -> list[Piece]:
        """From the end of a slot on Ox to the mouth of the next one: along rim and hollow."""
        width = self.pin + self.slot_air
        return [
            Line(self.slot_end + 1j * width, cmath.rect(self.rim, self._mouth)),
            Arc(0j, self.rim, self._mouth, self.horn),
            hollow,
            Arc(0j, self.rim, self.pitch - self._mouth - self.horn, self.horn),
        ]


@dataclass(frozen=True)
class Geneva(_Slotted):
    """A crank with one pin and a wheel outside of it."""

    sense = -1

    def __post_init__(self) -> None:
        slotted = self.slot_end * math.sin(self.pitch / 2) - self.slot_air
        self._check(min(slotted, self.pin + self.lock - self.clear))
        if not self._parting < self.half:
            said = f"corners of the wheel sweep away the end of the disc that locks it, which has a radius of {self.lock:.4g} mm"
            remedy = "use a smaller pin or a thinner wall, or put the axes further apart"
            end = abs(complex(self._relief(self._parting, 0)))
            raise DesignError(
                "way of a corner from the crank's axis", end, self.lock, "mm", "", remedy
            ).saying(said)

    @property
    def clear(self) -> float:
        """Radius of the lock's disc where the wheel's rim passes, mm."""
        return self.distance - self.rim - self.lock_air

    @property
    def held(self) -> tuple[tuple[float, float], ...]:
        """Ranges of the crank's angle in which slot or lock hold the wheel on both sides, rad: not while one hands it to the other."""
        end = math.sqrt(self.rim**2 - (self.pin + self.slot_air) ** 2)
        spokes = self.distance**2 + self.crank**2 - end**2
        drive = math.acos(spokes / (2 * self.distance * self.crank))
        begin = self.half + self._hollow_half
        return (-drive, drive), (begin, math.tau - begin)

    def wheel(self) -> Contour:
        """The wheel's edge, counter-clockwise about its axis, a slot on Ox."""
        width = self.pin + self.slot_air
        mouth = cmath.rect(self.rim, self._mouth)
        end = self.slot_end
        middle = cmath.rect(self.distance, self.pitch / 2)
        turn = self._hollow_half
        hollow = Arc(middle, self.hollow, self.pitch / 2 + math.pi + turn, -2 * turn)
        slot = Arc(complex(end), width, -math.pi / 2, -math.pi)
        next_slot = cmath.exp(1j * self.pitch)
        back = Line(mouth.conjugate() * next_slot, (end - 1j * width) * next_slot)
        one = [slot, *self._edge(hollow), back]
        turns = [cmath.exp(1j * self.pitch * k) for k in range(self.stations)]
        return Contour(tuple(piece.moved(turn) for turn in turns for piece in one))

    @cached_property
    def _passing(self) -> float:
        """Crank angle at which the corner is on the line of both axes, rad, below 0."""
        turned = self.pitch / 2 - self._corner_angle
        return halved(lambda t: float(self.motion(t)) <= turned, -self.half, 0.0)

    @cached_property
    def _parting(self) -> float:
        """Crank angle at which the corner's path, with the air, heads for the end of the lock's disc, rad."""
        end = cmath.rect(self.lock, self.half)

        def past(t: float) -> bool:
            along = complex(self._relief(t, 1))
            return (along.conjugate() * (end - complex(self._relief(t, 0)))).imag >= 0

        return halved(past, self._passing, self.half)

    def lock_disc(self) -> Contour:
        """The lock's edge, counter-clockwise about the crank's axis, its pin on Ox; on the level of the wheel."""
        path = Smooth(self._relief, self._passing, self._parting)
        inner = cmath.phase(start_point(path))
        end = cmath.rect(self.lock, self.half)
        pieces: tuple[Piece, ...] = (
            Arc(0j, self.lock, self.half, math.tau - 2 * self.half),
            Line(end.conjugate(), end_point(path).conjugate()),
            path.moved(mirror=True).reversed(),
            Arc(0j, self.clear, -inner, 2 * inner),
            path,
            Line(end_point(path), end),
        )
        return Contour(pieces)


@dataclass(frozen=True)
class InnerGeneva(_Slotted):
    """A crank with one pin and a wheel round it."""

    sense = 1

    def __post_init__(self) -> None:
        self._check(self.crank - self.slot_air - self.wall - self.lock_air)
        thick = min(self.lock - abs(complex(self._relief(t, 0))) for t in (self._begin, self._end))
        if not thick > 0:
            raise DesignError(
                "width of the crescent that locks the wheel",
                thick,
                0,
                "mm",
                "",
                "use a smaller pin, or put the axes further apart",
            )

    @property
    def reach(self) -> float:
        """Of the slots from the wheel's axis, mm."""
        return self.slot_end + self.pin + self.slot_air

    @property
    def seats(self) -> tuple[complex, complex]:
        """Places of two dowels in the middle of the lock, halfway to both its ends, mm, its pin on Ox."""
        half = self.dwell / 2
        inside = halved(
            lambda t: cmath.phase(complex(self._relief(t, 0))) <= math.pi - half,
            self._begin,
            self._end,
        )
        radius = (self.lock + abs(complex(self._relief(inside, 0)))) / 2
        place = cmath.rect(radius, math.pi - half)
        return place, place.conjugate()

    @property
    def dwell(self) -> float:
        """Half of the crank's angle over which the lock holds the wheel, rad; half of that of the lock's arc."""
        return math.pi - self.half

    @property
    def held(self) -> tuple[tuple[float, float], ...]:
        """Ranges of the crank's angle in which slot or lock hold the wheel on both sides, rad: not while one hands it to the other.

        Beside the ends of a drive the lock, with its longer lever, leaves less play than the pin. In a dwell the ends of the lock
        hold the wheel, with equal levers in its middle.
        """
        levers = 1 / math.cos(self.pitch / 2) - 1
        bend = self.distance * math.tan(self.pitch / 2)  # of the wheel's way there, mm
        drive = self.half - math.sqrt(2 * self.lock_air * levers / bend)
        begin = math.pi - _MIDDLE * self.dwell
        return (-drive, drive), (begin, math.tau - begin)

    def wheel(self) -> Contour:
        """The edge of the wheel's opening, counter-clockwise about its axis, a slot on Ox."""
        width = self.pin + self.slot_air
        mouth = cmath.rect(self.rim, self._mouth)
        end = self.slot_end
        middle = cmath.rect(self.distance, self.pitch / 2)
        turn = math.pi - self._hollow_half
        hollow = Arc(middle, self.hollow, self.pitch / 2 - turn, 2 * turn)
        slot = Arc(complex(end), width, -math.pi / 2, math.pi)
        one = [Line(mouth.conjugate(), end - 1j * width), slot, *self._edge(hollow)]
        next_slot = cmath.exp(1j * self.pitch)
        turns = [next_slot**k for k in range(self.stations)]
        return Contour(tuple(piece.moved(turn) for turn in turns for piece in one))

    @cached_property
    def _begin(self) -> float:
        """Crank angle at which that edge is on the line of shaft and pin, rad."""
        return halved(lambda t: complex(self._relief(t, 0)).imag >= 0, -self.half, 0.0)

    @cached_property
    def _end(self) -> float:
        """Crank angle at which that edge is beside the end of the lock's arc, rad."""
        beside = cmath.exp(1j * (self.dwell - math.pi))

        def past(t: float) -> bool:
            return (complex(self._relief(t, 0)) * beside).imag <= 0

        return halved(past, self._begin, self.half)

    def lock_disc(self) -> Contour:
        """The crescent's edge, counter-clockwise, its pin on Ox; on the level of the wheel."""
        path = Smooth(self._relief, self._begin, self._end)
        end = cmath.rect(self.lock, math.pi - self.dwell)
        pieces: tuple[Piece, ...] = (
            Arc(0j, self.lock, math.pi - self.dwell, 2 * self.dwell),
            Line(end.conjugate(), end_point(path).conjugate()),
            path.moved(mirror=True).reversed(),
            path,
            Line(end_point(path), end),
        )
        return Contour(pieces)


def geneva(
    kind: type[Geneva | InnerGeneva],
    stations: int,
    distance: float,
    pin: float,
    wall: float,
    air: float,
) -> Geneva | InnerGeneva:
    """A drive of these sizes, mm, air on each side, and twice as much at the floor of a slot; the DesignError of one that cannot be says which pin or distance can."""

    def can(distance: float, pin: float) -> bool:
        try:
            kind(stations, distance, pin, wall, air, air, 2 * air)
        except (DesignError, ValueError):  # the latter where rim and hollow do not even meet
            return False
        return True

    try:
        return kind(stations, distance, pin, wall, air, air, 2 * air)
    except DesignError as error:
        pins = np.arange(math.floor(pin / _PIN_STEP), 0, -1) * _PIN_STEP
        distances = np.arange(math.ceil(distance), math.ceil(_FARTHER * distance))
        thinner = next((f"{each:.4g}" for each in pins if can(distance, float(each))), "")
        farther = next((f"{each:.4g}" for each in distances if can(float(each), pin)), "")
        remedies = [f"use a smaller pin, of a radius of at most {thinner} mm"] if thinner else []
        remedies += [f"put the axes at least {farther} mm apart"] if farther else []
        raise (error.mended(", or ".join(remedies)) if remedies else error) from None


def _seen(axis: Points, arm: Points, rates: list[Floats]) -> Points:
    """A point at the end of an arm about an axis as the crank sees it, or its derivative, complex mm.

    axis: of the wheel there, which goes round against the crank; rates: derivatives of the arm's angle over the crank's, of order 1 and up.
    """
    if not rates:
        return np.asarray(axis + arm)
    rate = 1j * rates[0]
    if len(rates) == 1:
        return np.asarray(-1j * axis + rate * arm)
    change = 1j * rates[1]
    if len(rates) == 2:
        return np.asarray(-axis + (change + rate**2) * arm)
    third = 1j * rates[2] + 3 * rate * change + rate**3
    return np.asarray(1j * axis + third * arm)


def _beside(path: Callable[[Any, int], Points], offset: float, t: Any, order: int) -> Points:
    """A curve on the left of a path by an offset, mm, order 0..2."""
    along = path(t, 1)
    length = np.abs(along)
    if order == 0:
        return np.asarray(path(t, 0) + 1j * offset * along / length)
    bend = path(t, 2)
    curvature = (along.conj() * bend).imag / length**3
    share = 1 - offset * curvature
    if order == 1:
        return np.asarray(share * along)
    change = (along.conj() * path(t, 3)).imag / length**3
    change = change - 3 * curvature * (along.conj() * bend).real / length**2
    return np.asarray(share * bend - offset * change * along)


@dataclass(frozen=True)
class GenevaLaw:
    """The wheel's angle over the crank's, rad, both 0 in the middle of a drive: on by a station a turn, at rest in between."""

    geneva: Geneva | InnerGeneva

    @property
    def breaks(self) -> tuple[float, float]:
        """Crank angles at which the acceleration jumps, rad."""
        return -self.geneva.half, self.geneva.half

    def __call__(self, t: Any, order: int = 0) -> Floats:
        """Its order-th derivative, 0..3, at the crank's angle t, (n,) rad, nan at nan; in a dwell as at rest."""
        t = np.asarray(t, float)
        turn = np.floor(t / math.tau + 0.5)
        within = t - math.tau * turn
        half = self.geneva.half
        with np.errstate(invalid="ignore"):
            moved = self.geneva.motion(np.clip(within, -half, half), order)
        if order == 0:
            return np.asarray(moved + self.geneva.sense * self.geneva.pitch * turn)
        return np.where(np.abs(within) < half, moved, 0.0)
