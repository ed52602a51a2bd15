"""Two wheels that mesh: what their involutes ask of the distance, and how well they run.

side          1: both outer wheels; -1: b is a ring, all formulas are those of a wheel with as many teeth below 0
working angle of pressure at the distance at which both mesh
path          along the line of action from where it touches a's base circle, mm
balanced      shifts with which both flanks slide alike where they slide most
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from camgen.errors import DesignError
from camgen.numerics import sign_changes
from camgen.parts.wheels.involute import BasicRack, Relief, Ring, Teeth, Wheel, involute

LEAST_RATIO = 1.0  # of contact: below, a pair of teeth parts before the next one meets
_AIR = (
    0.01  # of the module: how far a ring's tips stay outside of what its pinion's involutes reach
)
_LOW = 0.05  # rad, roll of the foot of an involute
_FURTHEST = 1.5  # shift that is looked at, either way
_LOOKS = 61
_CORNERS = 4001  # places of a tip's corner on its way through the mate's gap
_WAY = 7.0  # teeth, on which these lie


def angle_of(involute_angle: float) -> float:
    """The angle whose involute it is, rad, by Newton's method from (3 inv)^(1/3)."""
    angle = min(1.4, math.cbrt(3 * max(0.0, involute_angle)))
    for _ in range(60):
        step = (involute(angle) - involute_angle) / max(math.tan(angle) ** 2, 1e-300)
        angle -= step
        if abs(step) < 1e-15:
            break
    return angle


@dataclass(frozen=True)
class Sizes:
    """What a pair is asked to be; teeth_b counts those of a ring where side is -1."""

    rack: BasicRack
    teeth_a: int
    teeth_b: int
    side: int = 1
    backlash: float = 0.0  # mm along the reference circles; each tooth is thinner by half of it

    @property
    def sum(self) -> int:
        """Of the teeth, those of a ring below 0."""
        return self.teeth_a + self.side * self.teeth_b

    @property
    def plain(self) -> float:
        """Distance without shifts, mm."""
        return self.rack.module * abs(self.sum) / 2

    def working_angle(self, shift_a: float, shift_b: float) -> float:
        """Of pressure, rad, where flanks thinned by nothing just fit."""
        total = shift_a + self.side * shift_b
        pressure = self.rack.pressure
        value = involute(pressure) + 2 * math.tan(pressure) * total / self.sum
        if not value > 0:
            raise DesignError("involute of the working angle", value, 0, "rad")
        return angle_of(value)

    def distance(self, shift_a: float, shift_b: float) -> float:
        """Of the axes, mm."""
        angle = self.working_angle(shift_a, shift_b)
        return self.plain * math.cos(self.rack.pressure) / math.cos(angle)

    def mesh(self, shift_a: float = 0.0, shift_b: float = 0.0) -> Mesh:
        """Both wheels, their tips as high as leaves the rack's clearance, those of a ring on the pinion's involutes."""
        rack = self.rack
        distance = self.distance(shift_a, shift_b)
        thinner = self.backlash / 2
        if self.side > 0:
            short = shift_a + shift_b + (self.plain - distance) / rack.module
            a, b = (
                Wheel(teeth, rack, shift, thinner, short)
                for teeth, shift in ((self.teeth_a, shift_a), (self.teeth_b, shift_b))
            )
            return Mesh(a, b, distance)
        a = Wheel(self.teeth_a, rack, shift_a, thinner)
        involutes = Teeth(self.teeth_b, rack, shift_b, thinner)
        height = involutes.reference - rack.module * (rack.addendum - shift_b)
        angle = self.working_angle(shift_a, shift_b)
        on_involute = distance * math.sin(angle) + a.tangent(a.form)
        least = math.hypot(involutes.base, on_involute)
        clear = distance + a.root + rack.clearance * rack.module
        tip = max(height, least + _AIR * rack.module, clear)
        ring = Ring(self.teeth_b, rack, shift_b, thinner, tip)
        return Mesh(a, ring, distance)

    def balanced(self, total: float = 0.0) -> tuple[float, float]:
        """Shifts of a and b with this sum (of a ring: difference) with which both slide alike; DesignError if there are none."""

        def shifts(first: float) -> tuple[float, float]:
            return first, self.side * (total - first)

        def difference(first: float) -> float:
            try:
                sliding = self.mesh(*shifts(first)).sliding
            except DesignError:
                return math.nan
            return sliding[0] - sliding[1]

        grid = np.linspace(-_FURTHEST, _FURTHEST, _LOOKS)
        found = sign_changes(lambda xs: np.array([difference(x) for x in xs]), grid)
        worst = [(min(self.mesh(*shifts(x)).sliding), -abs(x), float(x)) for x in found.tolist()]
        if not worst:
            raise DesignError(
                "shifts with which both wheels slide alike",
                0,
                1,
                "",
                "",
                "give shift_a and shift_b, or more teeth",
            )
        return shifts(max(worst)[2])


@dataclass(frozen=True)
class Mesh:
    """A pair at its distance, mm."""

    a: Wheel
    b: Wheel | Ring
    distance: float

    @property
    def side(self) -> int:
        """1: outside, -1: in a ring."""
        return -1 if isinstance(self.b, Ring) else 1

    @property
    def working_angle(self) -> float:
        """Angle between the line of action and the common tangent of both pitch circles, rad."""
        return math.acos(min(1.0, abs(self.a.base + self.side * self.b.base) / self.distance))

    @property
    def line(self) -> float:
        """Between both base circles along the line of action, mm."""
        return self.distance * math.sin(self.working_angle)

    @property
    def ratio(self) -> float:
        """Turns of b for one of a."""
        return -self.side * self.a.teeth / self.b.teeth

    def _across(self, way: float) -> float:
        """A place on the path by its distance from where the line touches the other base circle, mm, either way."""
        return self.line - way if self.side > 0 else way - self.line

    @property
    def path(self) -> tuple[float, float]:
        """Where contact begins, on b's tip, and where it ends, on a's, mm."""
        begin = self._across(self.b.tangent(self.b.tip))
        end = self.a.tangent(self.a.tip)
        if self.side > 0:
            end = min(end, self._across(self.b.tangent(self.b.form)))
        return max(begin, self.a.tangent(self.a.form)), end

    @property
    def begins_low(self) -> bool:
        """Whether a tip of either reaches the foot of the other's involutes, where they bend most."""
        roll = self.line - self.b.tangent(self.b.tip), self.line - self.a.tangent(self.a.tip)
        return roll[0] < _LOW * self.a.base or roll[1] < _LOW * self.b.base

    @property
    def base_pitch(self) -> float:
        """From flank to flank along the line of action, mm."""
        return math.pi * self.a.module * math.cos(self.a.rack.pressure)

    @property
    def contact_ratio(self) -> float:
        """Pairs of teeth that touch on average, by flanks as they are: what is undercut touches nothing."""
        begin, end = self.path
        return (end - begin) / self.base_pitch

    @property
    def sliding(self) -> tuple[float, float]:
        """Specific sliding of a and of b where it is most, at the end of the path nearest to their root; below 0."""
        begin, end = self.path
        teeth = self.a.teeth / self.b.teeth

        def of(way: float, own: float, ratio: float) -> float:
            return 1 - ratio * way / own if own > 0 else -math.inf

        return (
            of(abs(self._from_b(begin)), begin, teeth),
            of(end, abs(self._from_b(end)), 1 / teeth),
        )

    def _from_b(self, place: float) -> float:
        """A place on the path from where the line touches b's base circle, mm."""
        return self.line - self.side * place if self.side > 0 else place + self.line

    def backlash(self, distance: float | None = None) -> float:
        """Free angle of b while a stands, rad, at this distance or another one, mm."""
        away = self.distance if distance is None else distance
        bases = abs(self.a.base + self.side * self.b.base)
        if not away >= bases:
            raise DesignError("distance of the axes", away, bases, "mm")
        wider = involute(math.acos(bases / away)) - involute(self._tight_angle)
        thinner = (self.a.thinner + self.b.thinner) * math.cos(self.a.rack.pressure)
        return (self.side * 2 * wider * bases + thinner) / self.b.base

    @property
    def _tight_angle(self) -> float:
        """Working angle at which teeth that nothing thins would just fit, rad."""
        sizes = Sizes(self.a.rack, self.a.teeth, self.b.teeth, self.side)
        return sizes.working_angle(self.a.shift, self.b.shift)

    def relieved(self, amount: float) -> Mesh:
        """With tips drawn back by `amount`, mm, from where one pair of whole flanks is always left: it runs as evenly as before.

        A ring's teeth stay.
        """
        begin, end = self.path
        spare = max(0.0, (end - begin) - self.base_pitch)
        share = spare / 2 if self.side > 0 else spare
        a = replace(self.a, relief=Relief(amount, math.hypot(self.a.base, end - share)))
        if isinstance(self.b, Ring):
            return replace(self, a=a)
        from_b = self.line - begin - share
        b = replace(self.b, relief=Relief(amount, math.hypot(self.b.base, from_b)))
        return replace(self, a=a, b=b)

    @property
    def inner_margin(self) -> float:
        """How far a ring's tips stay outside of the feet of the pinion's involutes, mm along the line of action."""
        return self.b.tangent(self.b.tip) - self.line - self.a.tangent(self.a.form)

    @property
    def fillet_overlaps(self) -> tuple[float, float]:
        """How far a tip of b cuts into the roots of a, and one of a into those of b, mm beside the flank; below 0 neither does.

        By the way of the tip's corner through the gap, flanks in touch. Of outer wheels: a ring's tips stay on involutes.
        """
        assert isinstance(self.b, Wheel)
        return self._overlap(self.a, self.b), self._overlap(self.b, self.a)

    def _overlap(self, own: Wheel, mate: Wheel) -> float:
        """How far a tip of the mate cuts into the roots of one wheel, mm."""
        angle = np.linspace(-_WAY, _WAY, _CORNERS) / mate.teeth
        corner = mate.half_angle(mate.tip)
        place = mate.tip * np.exp(1j * (angle + corner)) - self.distance
        seen = -place * np.exp(1j * angle * mate.teeth / own.teeth)
        radius = np.abs(seen)
        low = radius < own.form
        if not low.any():
            return -math.inf
        play = self.backlash() * self.b.base / own.base / 2
        free = own.half_gap(radius[low])
        return float(np.max((play - np.angle(seen[low]) - free) * radius[low]))

    @property
    def tip_clearance(self) -> float:
        """Of a ring: how far a pinion's tip passes the ring's where both circles of the tips cross, mm, flanks in touch.

        The pinion's corner is there when it has turned by its polar angle less half of its tooth; the ring's corner, by the
        ratio, must be ahead of that place.
        """
        assert isinstance(self.b, Ring)
        a = self.a
        b = self.b
        away = self.distance
        from_a = math.acos((b.tip**2 - away**2 - a.tip**2) / (2 * away * a.tip))
        from_b = math.acos((b.tip**2 + away**2 - a.tip**2) / (2 * away * b.tip))
        turned = from_a - a.half_angle(a.tip)
        apart = b.half_angle(b.tip) + turned * self.ratio - from_b
        return (apart - self.backlash() / 2) * b.tip

    def check(self, least: float = LEAST_RATIO) -> None:
        """DesignError where a pair of teeth parts before the next one meets, or a ring's teeth and the pinion's foul each other."""
        if self.contact_ratio < least:
            raise DesignError(
                "contact ratio",
                self.contact_ratio,
                least,
                "",
                "",
                "use more teeth, or other shifts",
            )
        if isinstance(self.b, Ring):
            tip = math.hypot(self.b.base, self.a.tangent(self.a.tip) + self.line)
            if tip > self.b.form:
                raise DesignError(
                    "where a pinion's tip meets the ring's roundings",
                    tip,
                    self.b.form,
                    "mm",
                    "",
                    "use a ring of more teeth, or a larger shift of it",
                )
            if self.tip_clearance < 0:
                raise DesignError(
                    "clearance of a ring's tips beside the pinion's, which leaves its gaps",
                    self.tip_clearance,
                    0,
                    "mm",
                    "",
                    f"use a ring of more than {self.b.teeth - self.a.teeth} teeth more than the pinion's",
                )
