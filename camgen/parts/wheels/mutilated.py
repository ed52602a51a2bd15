"""Mutilated gears: a driver with teeth on a part of its rim turns a wheel by one station a turn; the rest of its rim holds the wheel.

    u           the driver's angle, v the wheel's, rad; both turn so that what is between the axes goes up
    w           place on the wheel, rad, up from the line of both axes: -radius exp(-i w) from its axis
    x, y        angles of a tooth of the driver and of the one of the wheel that it pushes, as u and w: see `tooth_contact`
    block       teeth of the wheel without gaps between them, hollowed by the driver's rim; one at each station
    lock        the driver's rim without teeth, in a hollow: the wheel stands
    free        air of a flank, and of the lock in its hollow, on either side, mm

The last tooth is as low as it must be to leave the wheel at a station: as it
passes, the corner of the wheel's tooth is `free` beyond its circle. The first one is as low as it must be to get in beside a tooth
that stands.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar, Literal

import numpy as np

from camgen.errors import DesignError
from camgen.geometry.outlines import Arc, Contour, Floats, Line, Piece
from camgen.parts.wheels.involute import LEAST_TIP, BasicRack, Wheel
from camgen.parts.wheels.tooth_contact import Tip, ToothContact

_MOST_JOINED = 8  # teeth of a block
_ROUNDING = 0.2  # modules, of the corner that lets go last: a sharp one wears, or is printed round


@dataclass(frozen=True)
class MutilatedPair:
    """Both wheels, of standard teeth."""

    teeth: tuple[int, int]  # of the driver, had it teeth all round, and of the wheel
    stations: int  # of the wheel
    distance: float  # of the axes, mm
    backlash: float  # mm along the pitch circles; each tooth is thinner by half of it
    pressure: ClassVar[float] = math.radians(20)

    def __post_init__(self) -> None:
        if self.teeth[1] % self.stations:
            least = self.stations * math.ceil(self.teeth[1] / self.stations)
            said = f"{self.teeth[1]} teeth do not divide into {self.stations} stations"
            remedy = f"give the wheel {least} teeth"
            what = "teeth of the wheel"
            raise DesignError(what, self.teeth[1], least, "", "", remedy).saying(said)
        if self.joined < 2:
            said = "the tips of both wheels do not reach far enough into each other for the last tooth to reach a station"
            more = "use more teeth on both"
            raise DesignError("teeth joined to a block", self.joined, 2, "", "", more).saying(said)
        if self.pushing < 2:
            said = f"{self.joined} of {self.travel} teeth from station to station are joined to the block that is held"
            remedy = "use fewer stations, or more teeth on the wheel"
            what = "teeth of the driver"
            raise DesignError(what, self.pushing, 2, "", "", remedy).saying(said)
        self._refuse_low_tips()
        self._refuse_deep_tips()
        self._refuse_wide_teeth()

    def _refuse_low_tips(self) -> None:
        """DesignError where the first or the last tooth is so low that its flank never meshes with the wheel's."""
        least = {
            "first": self.contact.base_pitch - self.contact.approach,
            "last": -self.contact.approach,
        }
        for name, wheel in {"first": self.first, "last": self.last}.items():
            if self.contact.recess(wheel) <= least[name]:
                said = f"the driver's {name} tooth, as low as it must be, lets go before another one holds the wheel"
                need = math.hypot(self.driver.base, self.contact.foot(self.driver) + least[name])
                what = f"radius of the {name} tooth's tip"
                remedy = "use more teeth on both"
                raise DesignError(what, wheel.tip, need, "mm", "", remedy).saying(said)

    def _refuse_deep_tips(self) -> None:
        """DesignError where a tip reaches below the other wheel's flanks."""
        wheel = self.wheel
        reached = {
            "driver": self.contact.seen(self.driver, self.contact.approach),
            "wheel": self.contact.seen(wheel, self.contact.recess(self.driver)),
        }
        for name, least in reached.items():
            own = self.driver if name == "driver" else wheel
            if own.form > least:
                said = f"tips of the other wheel reach below the flanks of the {name}'s {own.teeth} teeth"
                what = "radius at which the flanks begin"
                remedy = "use more teeth"
                raise DesignError(what, own.form, least, "mm", "", remedy).saying(said)

    def _refuse_wide_teeth(self) -> None:
        """DesignError where the driver's teeth leave no room for its lock."""
        rest = self.rest
        if rest <= 0:
            said = f"{self.pushing} of {self.teeth[0]} teeth of the driver leave no room for the rim that holds the wheel"
            what = "angle over which the wheel is held"
            remedy = "use more stations, or more teeth on the driver"
            raise DesignError(what, math.degrees(rest), 0, "deg", "", remedy).saying(said)

    @property
    def module(self) -> float:
        """Of the teeth, mm."""
        return 2 * self.distance / sum(self.teeth)

    @property
    def free(self) -> float:
        """Air on either side, mm."""
        return self.backlash / 2 * math.cos(self.pressure)

    @property
    def pitch(self) -> float:
        """Angle from station to station, rad."""
        return math.tau / self.stations

    @property
    def travel(self) -> int:
        """Teeth of the wheel from station to station."""
        return self.teeth[1] // self.stations

    @cached_property
    def driver(self) -> Wheel:
        """Of its teeth between the first and the last."""
        return self._wheel(0)

    @cached_property
    def wheel(self) -> Wheel:
        """The wheel's teeth."""
        return self._wheel(1)

    def _wheel(self, k: int) -> Wheel:
        return Wheel(self.teeth[k], BasicRack(self.module, self.pressure), 0.0, self.backlash / 2)

    @cached_property
    def contact(self) -> ToothContact:
        """Of one tooth of each."""
        return ToothContact(self.driver, self.wheel, self.distance, self.free)

    @cached_property
    def joined(self) -> int:
        """Teeth of a block: as many as the last tooth reaches."""
        reached = (k for k in range(_MOST_JOINED, 0, -1) if self._leaving(k) <= self.driver.tip)
        return next(reached, 0)

    @property
    def pushing(self) -> int:
        """Teeth of the driver."""
        return self.travel + 1 - self.joined

    def _leaving(self, joined: int) -> float:
        """Tip of the driver's last tooth with blocks of so many teeth, mm."""
        wheel = self.wheel
        return (
            abs(complex(self.contact.corner((joined + 1) / 2 * wheel.pitch - wheel.half_top, 0)))
            - self.free
        )

    @cached_property
    def first(self) -> Wheel:
        """The driver's first tooth, which passes the upper corner of the wheel's second one."""
        wheel = self.wheel
        place = -(self.joined + 1) / 2 * wheel.pitch + wheel.half_top
        return self._lowered(abs(complex(self.contact.corner(place, 0))) - self.free)

    @cached_property
    def last(self) -> Wheel:
        """The driver's last tooth."""
        return self._lowered(self._leaving(self.joined))

    def _lowered(self, tip: float) -> Wheel:
        """A tooth of the driver up to a radius, mm."""
        driver = self.driver
        return replace(driver, shortened=max(0.0, driver.tip - tip) / self.module)

    def _places(self, tooth: int) -> tuple[float, float]:
        """Angles of a pair of teeth, from 1, at u = 0 and v = 0, rad."""
        past = tooth - 1
        own = self.joined / 2 + past
        other = (self.joined - 1) / 2 + past
        return -own * self.driver.pitch, -other * self.wheel.pitch

    # ---- the law of both wheels

    @cached_property
    def drive(self) -> tuple[float, float]:
        """u at which the wheel starts and stands again."""
        start, place = self._places(1)
        begin = (
            float(self.contact.before(place))
            if place < self.contact.meets
            else (place - self.wheel.pitch / 2) / self.contact.ratio
        )
        return begin - start, self.contact.passes(self._tip(self.pushing)) - self._places(
            self.pushing
        )[0]

    @property
    def half(self) -> float:
        """Half of the driver's angle over which the wheel turns, rad."""
        return (self.drive[1] - self.drive[0]) / 2

    @property
    def jumps(self) -> tuple[float, float]:
        """Speed of the wheel over that of the driver as it starts and as it stops."""
        begin, end = self.motion(np.array(self.drive), 1)
        return float(begin), float(end)

    @property
    def middle(self) -> float:
        """u in the middle of that."""
        return sum(self.drive) / 2

    @property
    def rest(self) -> float:
        """Half of the driver's angle over which the lock holds the wheel on both sides, rad."""
        return math.pi - self.half - self._hollow_half

    @property
    def held(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Ranges of the driver's angle from the middle of a rest in which lock or flanks hold the wheel on both sides, rad."""
        base = self.driver.base
        step = self.contact.base_pitch
        # of the first tooth along the line; the back of a tooth is touched half a base pitch later
        begin = step / 2 - self.contact.recess(self.first)
        end = begin
        for k in range(self.pushing):
            wheel = self._tooth(k + 1)
            if k * step + step / 2 - self.contact.recess(wheel) > end + 1e-9:
                break
            end = k * step + step / 2 + self.contact.approach
        begin = max(begin, -self.contact.approach)
        tip = self._tip(self.pushing)
        last = self.driver.tangent(tip.reach) + tip.rounding - self.contact.foot(self.driver)
        end = min(end, (self.pushing - 1) * step + last)
        zero = -self._places(1)[0] - self.driver.pitch / 4 - self.middle + math.pi
        return (-self.rest, self.rest), (begin / base + zero, end / base + zero)

    def _tooth(self, k: int) -> Wheel:
        """The driver's k-th, from 1."""
        return {1: self.first, self.pushing: self.last}.get(k, self.driver)

    def _tip(self, k: int) -> Tip:
        """Of the driver's k-th, on the side that pushes."""
        wheel = self._tooth(k)
        rounding = _ROUNDING * self.module if k == self.pushing else 0.0
        reach = wheel.tip - rounding
        return Tip(reach, wheel.half_angle(reach) - rounding / wheel.base, rounding)

    def motion(self, u: Any, order: int = 0) -> Floats:
        """The wheel's angle v within `drive`, or its derivative, order 0..3; rad."""
        u = np.asarray(u, float)
        start, place = self._places(1)
        meshes = self.contact.mesh(u + start) - place
        if order == 0:
            found = meshes
        else:
            found = np.full(u.shape, self.contact.ratio if order == 1 else 0.0)
        early = self.contact.entered(u + start, place)
        if place < self.contact.meets:
            entering = early < self.contact.meets
            found = np.where(
                entering,
                early - place if order == 0 else self.contact.entering(early, order),
                found,
            )
        best = np.full(u.shape, -np.inf)
        last = self.pushing
        for k in (last - 1, last):
            x = u + self._places(k)[0]
            tip = self._tip(k)
            v = self.contact.after(tip, x) - self._places(k)[1]
            taken = (u > self.contact.lets_go(self._tip(last)) - self._places(last)[0]) & (v > best)
            best = np.where(taken, v, best)
            found = np.where(taken, v if order == 0 else self.contact.after(tip, x, order), found)
        return np.asarray(found)

    # ---- edges

    @property
    def _corner_angle(self) -> float:
        """Of a block's corner about the wheel's axis, from its middle, rad."""
        wheel = self.wheel
        return (
            (self.joined - 1) / 2 * wheel.pitch
            + wheel.half_top
            - LEAST_TIP * self.module / wheel.tip
        )

    @property
    def hollow(self) -> float:
        """Radius of the blocks' hollows, mm."""
        return abs(complex(self.contact.corner(self._corner_angle, 0)))

    @property
    def lock(self) -> float:
        """Radius of the driver's rim without teeth, mm."""
        return self.hollow - self.free

    @property
    def _hollow_half(self) -> float:
        """Half of a hollow's angle about the driver's axis, rad."""
        return abs(cmath.phase(complex(self.contact.corner(self._corner_angle, 0))))

    def driver_edge(self) -> Contour:
        """The driver's edge, counter-clockwise about its axis; the wheel lies on Ox, in the middle of a rest."""
        begin, end = self.drive
        driver = self.driver
        foot = driver.half_foot
        pieces: list[Piece] = []
        for k in range(self.pushing, 0, -1):
            place = self._places(k)[0]
            tooth = self._last_tooth() if k == self.pushing else _whole(self._tooth(k))
            pieces += _moved(place, tooth)
            if k > 1:
                pieces.append(Arc(0j, driver.root, place + foot, driver.pitch - 2 * foot))
        left = self._places(1)[0] + foot
        right = self._places(self.pushing)[0] - foot
        ends = [cmath.rect(1, -each) for each in (begin, end)]
        pieces += [
            Arc(0j, driver.root, left, -begin - left),
            Line(driver.root * ends[0], self.lock * ends[0]),
            Arc(0j, self.lock, -begin, math.tau - (end - begin)),
            Line(self.lock * ends[1], driver.root * ends[1]),
            Arc(0j, driver.root, -end, right + end),
        ]
        return Contour(tuple(_moved(self.middle - math.pi, pieces)))

    def _last_tooth(self) -> list[Piece]:
        """On Ox, from root circle to root circle; rounded where it pushes."""
        last = self.last
        tip = self._tip(self.pushing)
        middle = cmath.rect(tip.reach, tip.half)
        reached = last.tangent(tip.reach) + tip.rounding
        ends = math.hypot(last.base, reached)
        begins = cmath.rect(ends, last.half_angle(ends))
        turn = cmath.phase((begins - middle) * cmath.exp(-1j * tip.half))
        left = replace(last, shortened=(self.driver.tip - ends) / self.module).left
        return [
            *last.right,
            Arc(0j, last.tip, -last.half_top, last.half_top + tip.half),
            Arc(middle, tip.rounding, tip.half, turn),
            *left,
        ]

    def wheel_edge(self) -> Contour:
        """The wheel's edge, counter-clockwise about its axis, a block at rest on -Ox, where the driver is."""
        wheel = self.wheel
        gap = Arc(0j, wheel.root, wheel.half_foot, wheel.pitch - 2 * wheel.half_foot)
        one = [*self._block(), *_moved((self.joined - 1) / 2 * wheel.pitch, [gap])]
        for k in range(self.travel - self.joined):
            one += _moved(((self.joined + 1) / 2 + k) * wheel.pitch, [*_whole(wheel), gap])
        turns = (math.pi + self.pitch * k for k in range(self.stations))
        return Contour(tuple(piece for turn in turns for piece in _moved(turn, one)))

    def _block(self) -> Iterator[Piece]:
        """About Ox, from root circle to root circle."""
        wheel = self.wheel
        end = (self.joined - 1) / 2 * wheel.pitch
        corner = self._corner_angle
        land = end + wheel.half_top - corner
        turn = self._hollow_half
        yield from _moved(-end, wheel.right)
        yield Arc(0j, wheel.tip, -end - wheel.half_top, land)
        yield Arc(complex(self.distance), self.hollow, math.pi + turn, -2 * turn)
        yield Arc(0j, wheel.tip, corner, land)
        yield from _moved(end, wheel.left)


def _whole(wheel: Wheel) -> list[Piece]:
    """A tooth on Ox, from root circle to root circle."""
    top = wheel.half_top
    return [*wheel.right, Arc(0j, wheel.tip, -top, 2 * top), *wheel.left]


def _moved(angle: float, pieces: Sequence[Piece]) -> list[Piece]:
    """Pieces turned about the axis."""
    turn = cmath.exp(1j * angle)
    return [piece.moved(turn) for piece in pieces]


@dataclass(frozen=True)
class MutilatedLaw:
    """The wheel's angle over the driver's, rad, both 0 in the middle of a rest: on by a station a turn, against the driver's sense.

    way: the sense in which the driver turns.
    """

    pair: MutilatedPair
    way: Literal[1, -1] = 1

    @property
    def breaks(self) -> tuple[float, float]:
        """Angles of the driver at which the wheel's speed jumps, rad."""
        return self.drives

    @property
    def held(self) -> tuple[tuple[float, float], ...]:
        """Ranges of the driver's angle in which lock or flanks hold the wheel on both sides, rad."""
        return tuple(map(self._turned, self.pair.held))

    @property
    def drives(self) -> tuple[float, float]:
        """Range in which the driver moves the wheel, rad."""
        return self._turned((math.pi - self.pair.half, math.pi + self.pair.half))

    def _turned(self, span: tuple[float, float]) -> tuple[float, float]:
        """A range as the driver's sense has it."""
        return span if self.way > 0 else (-span[1], -span[0])

    def __call__(self, t: Any, order: int = 0) -> Floats:
        """Its order-th derivative, 0..3, at the driver's angle t, (n,) rad, nan at nan; 0 while it stands."""
        pair = self.pair
        t = self.way * np.asarray(t, float)
        turn = np.floor(t / math.tau)
        u = t - math.tau * turn - math.pi + pair.middle
        begin, end = pair.drive
        with np.errstate(invalid="ignore"):
            moved = pair.motion(np.clip(u, begin, end), order)
            drives = (u > begin) & (u < end)
        if order == 0:
            return np.asarray(-self.way * (moved + pair.pitch * turn))
        return np.where(drives, -self.way * moved * float(self.way) ** order, 0.0)
