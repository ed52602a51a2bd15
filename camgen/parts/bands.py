"""The band of a link with two hubs, narrower than these or bent in its plane, so that it passes round what is in its way.

middle line   the arc from the centre of one hub to that of the other, or the straight line
bow           how far the middle line leaves the straight one half way, mm; > 0 to the left, seen from the first hub
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass

from camgen.errors import DesignError
from camgen.geometry.outlines import Arc, Contour, Line

_NEAR = 0.05  # mm, between the middle line and the chords in its place


@dataclass(frozen=True)
class ArmBand:
    """Two hubs and the band between them; mm."""

    link: str  # its name, for messages
    a: complex  # centres
    b: complex
    radii: tuple[float, float]
    width: float
    bow: float = 0.0

    @property
    def _length(self) -> float:
        return abs(self.b - self.a)

    @property
    def radius(self) -> float:
        """Of the middle line, mm; infinite where it is straight."""
        return (self._length**2 / 4 + self.bow**2) / (2 * abs(self.bow)) if self.bow else math.inf

    @property
    def _centre(self) -> complex:
        """Of the middle line's circle."""
        normal = 1j * (self.b - self.a) / self._length
        return (self.a + self.b) / 2 + normal * (self.bow - math.copysign(self.radius, self.bow))

    def middle(self) -> list[complex]:
        """Corners of chords of the middle line, which it leaves by no more than `sagitta`."""
        if not self.bow:
            return [self.a, self.b]
        half = 2 * math.asin(min(1.0, self._length / 2 / self.radius))
        count = math.ceil(half / (2 * math.acos(1 - min(1.0, _NEAR / self.radius))))
        step = cmath.exp(-1j * math.copysign(half / count, self.bow))
        return [*(self._centre + (self.a - self._centre) * step**k for k in range(count)), self.b]

    @property
    def sagitta(self) -> float:
        """How far the middle line is from its chords at most, mm."""
        return _NEAR if self.bow else 0.0

    def outline(self) -> Contour:
        """Its edge, of lines and arcs, counter-clockwise; DesignError where there is none."""
        limits = [
            (
                f"parts.{self.link}.width",
                self.width,
                2 * min(self.radii),
                "the smaller hub: use a narrower one or larger hubs",
            ),
            (
                f"parts.{self.link}.bow",
                abs(self.bow),
                self._length / 2,
                "half the distance of its hubs: use a smaller one",
            ),
            (
                f"parts.{self.link}.width",
                self.width,
                2 * self.radius,
                "twice the radius of its middle line: use a smaller bow",
            ),
        ]
        for key, value, limit, remedy in limits:
            if value > limit + 1e-9:
                raise DesignError(key, value, limit, "mm", f"link {self.link}", remedy)
        (a_left, a_right), (b_left, b_right) = (
            [self._corner(end, side) for side in (1, -1)] for end in (0, 1)
        )
        return Contour(
            (
                self._edge(a_right, b_right, 1),
                self._hub(self.b, self.radii[1], b_right, b_left),
                self._edge(b_left, a_left, -1),
                self._hub(self.a, self.radii[0], a_left, a_right),
            )
        )

    def _hub(self, centre: complex, radius: float, start: complex, stop: complex) -> Arc:
        """The edge round a hub."""
        return Arc(
            centre,
            radius,
            cmath.phase(start - centre),
            cmath.phase((stop - centre) / (start - centre)) % math.tau,
        )

    def _edge(self, start: complex, stop: complex, sense: int) -> Arc | Line:
        """One edge of the band; sense: 1 from a to b on the right, -1 back on the left."""
        if not self.bow:
            return Line(start, stop)
        centre = self._centre
        side = math.copysign(1, self.bow)
        sweep = cmath.phase((stop - centre) / (start - centre))
        if sweep * sense * side > 0:  # a half turn
            sweep -= math.copysign(math.tau, sweep)
        return Arc(
            centre, self.radius - sense * side * self.width / 2, cmath.phase(start - centre), sweep
        )

    def _corner(self, end: int, side: int) -> complex:
        """Where an edge meets a hub, the second where `end`; side: 1 the left edge, -1 the right one."""
        hub = (self.a, self.b)[end]
        radius = self.radii[end]
        half = self.width / 2
        if not self.bow:
            way = (self.b - self.a) / self._length
            return hub + way * (
                math.sqrt(max(0.0, radius**2 - half**2)) * (-1 if end else 1) + side * 1j * half
            )
        edge = self.radius + side * math.copysign(half, self.bow)
        cosine = (self.radius**2 + edge**2 - radius**2) / (2 * self.radius * edge)
        turn = math.acos(min(1.0, cosine)) * (1 if end else -1) * math.copysign(1, self.bow)
        return self._centre + (hub - self._centre) * (edge / self.radius) * cmath.exp(1j * turn)
