"""Sizes of a Geneva wheel in its plan view: slots, hollows, rim. Coordinates: mm of paper."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable
from dataclasses import dataclass

from camgen.files.dimensions import SlottedWheel, number
from camgen.files.measures import Measure
from camgen.files.page import Page
from camgen.tolerances import SAME_POINT


@dataclass(frozen=True)
class SlottedView:
    """Such a wheel in its place on the sheet.

    off: deviations of its slots' width and of its hollows' radius; high: upper right corner of the part, mm.
    """

    wheel: SlottedWheel
    page: Page
    off: str
    high: complex

    def draw(self, leader: Callable[[complex, complex, str], None]) -> None:
        """Width, depth and spacing of a wheel's slots, its hollows and its rim; of those at the top, where one is upright.

        leader: draws one onto a point of the part from a direction, with a text.
        """
        wheel = self.wheel
        sheet = self.page.sheet
        count = len(wheel.slots)
        off = self.off
        slot = max(wheel.slots, key=lambda z: round(z.imag, 6))
        way = slot / abs(slot)
        for middle in wheel.slots:
            along = middle / abs(middle)
            ends = middle - wheel.width * along, along * max(wheel.rim, abs(middle) + wheel.width)
            sheet.line(*map(self.page.paper, ends), layer="CENTER")
        sheet.arc(self.page.datum, self.page.scale * abs(slot), 0.0, math.tau, "CENTER")
        said = f"{count} × {number(wheel.width)} {off}".rstrip()
        if abs(way.real) < SAME_POINT:
            mouth = self.page.paper(1j * self.high.imag)
            half = self.page.scale * wheel.width / 2
            measure = Measure(wheel.width, f"{count} × ", off)
            self.page.dimension(mouth - half, mouth + half, 9j, measure)
            right = self.page.paper(self.high.real + 0j)
            deep = right + 1j * self.page.scale * abs(slot)
            self.page.dimension(right, deep, 9 + 0j, Measure(abs(slot)))
        else:
            side = slot + 0.5j * way * wheel.width
            leader(side + way, way, f"{said} wide, ends about R{number(abs(slot))}")
        hollow = max(
            wheel.hollows, key=lambda arc: round((arc.centre * (3 + 2j).conjugate()).real, 6)
        )
        away = hollow.centre / abs(hollow.centre)
        far = number(abs(hollow.centre))
        bottom = complex(hollow.at((hollow.t0 + hollow.t1) / 2, 0))
        said = f"{count} × R{number(hollow.radius)} {off}".rstrip()
        leader(bottom, away, f"{said} about R{far}")
        rim = cmath.rect(wheel.rim, cmath.phase(hollow.centre) - math.pi / count)
        rim *= cmath.exp(1j * (wheel.width / 2 + 1) / wheel.rim)
        leader(rim, rim / abs(rim), f"Ø{number(2 * wheel.rim)}")
        self._spacing(slot, count)

    def _spacing(self, slot: complex, count: int) -> None:
        """Angle from one of so many even slots to the next one, clockwise."""
        radius = 0.6 * self.page.scale * abs(slot)
        start = cmath.phase(slot)
        pitch = math.tau / count
        self.page.sheet.arc(self.page.datum, radius, start - pitch, pitch, "DIM")
        for angle, sense in ((start, 1), (start - pitch, -1)):
            turn = cmath.exp(1j * angle)
            lean = cmath.exp(-1j * sense * 1.5 / radius)  # an arrow's half on the arc
            self.page.sheet.arrow(self.page.datum + radius * turn, sense * 1j * turn * lean)
        said = self.page.datum + cmath.rect(radius + 3, start - pitch / 2) - 1.2j
        self.page.sheet.text(said, f"{count} × {number(360 / count)}°", 2.5, "centre")
