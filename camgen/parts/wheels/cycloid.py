"""Cycloidal discs: a disc on an eccentric that rolls inside a circle of pins, and turns back by one lobe a turn.

    c(t)        the pins' centres as seen from the disc, an epitrochoid: R exp(it) - e exp(iNt)
    outline     parallel to it on the inside, a pin's radius away
    lobes       pins - 1: the disc turns by -1/lobes while its eccentric turns once
    equidistant what is cut away more than a pin's radius, mm; the play comes from it
    offset      by how much smaller a pin circle is that the disc is cut for, mm
    output      pins of a link about the eccentric's axis, in round holes of the disc that are wider by the eccentricity

[the curve's derivative is i (R exp(it) - eN exp(iNt)), so its normal is that without the i]
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from camgen.errors import DesignError
from camgen.geometry.outlines import Contour, Floats, Points, Smooth
from camgen.tolerances import SAME_POINT

_NEWTON = 6  # steps to a foot that is an offset away
_FOOT = 0.8  # of the trace's radius in its hollows: up to that offset the foot is found within 1e-9 mm, past it there are two
_PLACES = 721  # of the eccentric, from one pin to the next


@dataclass(frozen=True)
class CycloidDisc:
    """A disc with one lobe less than there are pins."""

    pins: int
    radius: float  # of the pins' circle, mm
    pin: float  # radius of a pin, mm
    eccentricity: float  # mm
    equidistant: float = 0.0  # mm
    offset: float = 0.0  # mm

    def __post_init__(self) -> None:
        if self.pins < 3:
            raise DesignError("pins of a cycloidal disc", self.pins, 3, "", "", "use more pins")
        most = max(self.equidistant + abs(self.offset), SAME_POINT)
        if not self.eccentricity > most:
            raise DesignError(
                "eccentricity",
                self.eccentricity,
                most,
                "mm",
                "",
                "draw the eccentric's point farther from the shaft: it must be more than the clearance round the pins",
            )
        share = self.eccentricity * self.pins / self.cut_radius
        if not share < 1:
            raise DesignError(
                "eccentricity times pins over the pins' circle",
                share,
                1,
                "",
                "",
                f"use an eccentricity below {self.cut_radius / self.pins:.4g} mm",
            )
        apart = self.radius * math.sin(math.pi / self.pins)
        if not self.pin < apart:
            raise DesignError(
                "radius of the pins", self.pin, apart, "mm", "", "use smaller pins, or fewer"
            )
        if not self.cut < self.largest_pin:
            raise DesignError(
                "radius of a pin with its clearance",
                self.cut,
                self.largest_pin,
                "mm",
                "",
                "use smaller pins, or a smaller eccentricity",
            )
        if not self.offset < _FOOT * self.hollow_radius:
            raise DesignError(
                "offset",
                self.offset,
                _FOOT * self.hollow_radius,
                "mm",
                "",
                "use less offset, or a smaller eccentricity: the hollows are too narrow for it",
            )
        if self.offset and not self.least_gap > SAME_POINT:
            raise DesignError(
                "least clearance of a lobe beside a pin",
                self.least_gap,
                SAME_POINT,
                "mm",
                "",
                "use more clearance, or less offset",
            )

    @property
    def lobes(self) -> int:
        """Of the disc."""
        return self.pins - 1

    @property
    def cut_radius(self) -> float:
        """Radius of the pin circle that the disc is cut for, mm."""
        return self.radius - self.offset

    @property
    def cut(self) -> float:
        """From the pins' centres to the outline, mm."""
        return self.pin + self.equidistant

    @property
    def ratio(self) -> float:
        """Turns of the disc for one of its eccentric, the pins standing still."""
        return -1 / self.lobes

    @property
    def least_gap(self) -> float:
        """Least gap of a pin from the outline, all the way round, mm."""
        return float(np.min(self.gap(np.linspace(0.0, math.pi, _PLACES))))

    @property
    def play(self) -> tuple[float, float]:
        """Free angle of the disc, least and greatest, rad: by the gaps of its pins over their levers, to first order."""
        free, _, _ = self._held
        both = free + free[::-1]  # the other way round the same pins, as in a mirror
        return float(both.min()), float(both.max())

    @property
    def ripple(self) -> float:
        """By how much the disc turns unevenly where it is held on one side, peak to peak, rad: to first order."""
        return float(np.ptp(self._held[0]))

    @cached_property
    def _held(self) -> tuple[Floats, Floats, Floats]:
        """The pin that holds the disc on one side while the eccentric goes from one pin to the next, (n,): the disc's angle until it
        does, rad, its lever, mm, and the curvature of pin and lobe together, 1/mm."""
        x = np.linspace(0.0, math.tau / self.pins, _PLACES)[:, None]
        x = x + math.tau * np.arange(self.pins) / self.pins
        t = -x / self.lobes
        along = self.trace(t, 1)
        levers = np.real(np.conj(self.trace(t)) * along) / np.abs(along)
        curvature, _ = self._curvature(t)
        both = 1 / self.pin + curvature / (1 - self.cut * curvature)
        pushes = levers > SAME_POINT
        ways = np.where(pushes, self.gap(x) / np.where(pushes, levers, 1.0), np.inf)
        holds = np.argmin(ways, axis=1)
        row = np.arange(_PLACES)
        return ways[row, holds], levers[row, holds], both[row, holds]

    @property
    def largest_pin(self) -> float:
        """Radius from which on a pin would cut into the lobes' flanks, mm: the trace's least radius of curvature."""
        return 1 / max(self._extremes)

    @property
    def hollow_radius(self) -> float:
        """Least radius of the trace where it is hollow, mm; infinite where it is nowhere."""
        least = min(self._extremes)
        return -1 / least if least < 0 else math.inf

    @property
    def _extremes(self) -> list[float]:
        """Curvature of the trace, 1/mm, where it is least and greatest: in hollows, at lobes' tops, and where it turns between."""
        a, b, c, d = self._shape
        places = [-1.0, 1.0]
        turning = (1.5 * d * a - b * c) / (0.5 * b * d)
        places += [turning] if abs(turning) < 1 else []
        return [(a - b * w) / math.pow(c - d * w, 1.5) for w in places]

    @property
    def _shape(self) -> tuple[float, float, float, float]:
        """Numbers a, b, c, d of the trace's curvature (a - b cos zt) / (c - d cos zt)^1.5."""
        n = self.pins
        radius = self.cut_radius
        e = self.eccentricity
        return (
            radius**2 + e**2 * n**3,
            (n + 1) * n * radius * e,
            radius**2 + e**2 * n**2,
            2 * radius * e * n,
        )

    def trace(self, t: Any, order: int = 0) -> Points:
        """Centre of a pin as the disc sees it, or its derivative, complex mm."""
        t = np.asarray(t, float)
        n = self.pins
        unit = np.exp(1j * t)
        return np.asarray(
            1j**order * (self.cut_radius * unit - n**order * self.eccentricity * np.exp(1j * n * t))
        )

    def _curvature(self, t: Floats) -> tuple[Floats, Floats]:
        """Of the trace, 1/mm, and its derivative."""
        a, b, c, d = self._shape
        z = self.lobes
        cosine = np.cos(z * t)
        under = c - d * cosine
        value = (a - b * cosine) / under**1.5
        slope = z * np.sin(z * t) * (b / under**1.5 - 1.5 * d * (a - b * cosine) / under**2.5)
        return value, slope

    def curve(self, t: Floats, order: int) -> Points:
        """The outline, or its derivatives to t, complex mm."""
        along = self.trace(t, 1)
        if order == 0:
            return np.asarray(self.trace(t) + 1j * self.cut * along / np.abs(along))
        curvature, change = self._curvature(t)
        share = 1 - self.cut * curvature
        if order == 1:
            return np.asarray(share * along)
        return np.asarray(share * self.trace(t, 2) - self.cut * change * along)

    def outline(self) -> Contour:
        """The edge, counter-clockwise about the disc's own axis; lobe by lobe, a hollow on Ox."""
        step = math.tau / self.lobes
        one = Smooth(self.curve, 0.0, step)
        return Contour(tuple(one.moved(np.exp(1j * k * step)) for k in range(self.lobes)))

    def pin_places(self) -> list[complex]:
        """Centres of the pins about the eccentric's axis, mm, with the eccentric along Ox and the disc's hollow on it."""
        turn = math.tau / self.pins
        return [complex(self.radius * np.exp(1j * turn * k)) for k in range(self.pins)]

    @property
    def hollow(self) -> float:
        """Least radius of the outline about the disc's axis, in the middle of a hollow, mm."""
        return self.cut_radius - self.eccentricity - self.cut

    def gap(self, angle: Any) -> Floats:
        """Of a pin from the outline, (n,) mm; angle: from the eccentric to the pin, seen from the shaft, rad.

        The foot on the trace of the pins that the disc is cut for is found by Newton's method, from the pin's own place.
        """
        # seen from the disc a pin is at -angle / lobes of the trace, but for the offset
        t = -np.asarray(angle, float) / self.lobes
        centre = self.trace(t) + self.offset * np.exp(1j * t)
        for _ in range(_NEWTON):
            way = centre - self.trace(t)
            first = self.trace(t, 1)
            second = self.trace(t, 2)
            along = np.real(np.conj(first) * way)
            t = t - along / (np.real(np.conj(second) * way) - np.abs(first) ** 2)
        out = -1j * self.trace(t, 1)
        apart = np.real(np.conj(out / np.abs(out)) * (centre - self.trace(t)))
        return np.asarray(apart + self.equidistant)

    @property
    def hardest(self) -> tuple[float, float]:
        """Lever, mm, and curvature of pin and lobe together, 1/mm, where one pin alone holds the disc and is pressed hardest."""
        _, lever, bend = self._held
        worst = int(np.argmax(bend / lever))
        return float(lever[worst]), float(bend[worst])

    def output_hole(self, pin: float, air: float) -> float:
        """Radius of a hole through which an output pin of this radius takes the turning off, mm."""
        return pin + self.eccentricity + air


@dataclass(frozen=True)
class OutputPins:
    """Pins of a link about the shaft, each in a round hole of the disc: they turn as the disc does.

    Between a hole's centre and its pin's lies the eccentricity, the same way at all of them.
    """

    count: int
    circle: float  # radius of the circle on which they are, mm
    pin: float  # radius of a pin, mm
    hole: float  # radius of a hole, mm

    @property
    def hardest(self) -> tuple[float, float]:
        """Lever, mm, and curvature of pin and hole together, 1/mm, where one pin alone holds the disc and is pressed hardest.

        That is where two pins are as far off the line that pushes best, half of their spacing.
        """
        return self.circle * math.cos(math.pi / self.count), 1 / self.pin - 1 / self.hole


@dataclass(frozen=True)
class OutputWish:
    """What is asked of output pins; what is None is as large as there is room for, mm."""

    count: int
    circle: float | None = None
    pin: float | None = None

    def pins(self, disc: CycloidDisc, inner: float, wall: float, air: float) -> OutputPins:
        """Pins of a disc; inner: radius of the disc that they keep clear of, mm. DesignError where there is no room."""
        outer = disc.hollow - wall
        circle = round((inner + outer) / 2, 2) if self.circle is None else self.circle
        room = min(circle - inner, outer - circle)
        beside = circle * math.sin(math.pi / self.count) - wall / 2
        least = disc.output_hole(0.0, air)
        largest = min(room, beside)
        if self.pin is None:
            pin = math.floor(20 * (largest - least)) / 20  # to a twentieth of a millimetre
        else:
            pin = self.pin
        hole = disc.output_hole(pin, air)
        what = "radius of a hole for an output pin"
        if pin <= 0 or hole > room + SAME_POINT:
            remedy = (
                f"put the output pins on a circle of {(inner + outer) / 2:.4g} mm, or use a larger radius of the pins' circle"
                if pin <= 0 or self.circle is not None
                else f"use an output_pin_radius of at most {largest - least:.4g} mm"
            )
            at = f"between {inner:.4g} mm, the eccentric with its keeper, and {outer:.4g} mm, a wall within the hollows of the disc"
            raise DesignError(what, max(hole, least), room, "mm", at, remedy)
        if hole > beside + SAME_POINT:
            remedy = "use fewer output_pins, or smaller ones"
            raise DesignError(what, hole, beside, "mm", "a wall from its neighbours", remedy)
        return OutputPins(self.count, circle, pin, hole)
