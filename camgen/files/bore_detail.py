"""A bore by itself on the sheet of its part, with its sizes, their tolerances and the datums. Coordinates: mm of paper."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from camgen.files.dimensions import flat_of, hole_of, number
from camgen.files.labels import Obstacles
from camgen.files.limits import deviations, in_limits
from camgen.files.measures import Measure, dimension
from camgen.files.sheet import Sheet, Text
from camgen.files.symbols import FRAME, datum, roughness, symmetry, width_of
from camgen.files.title_block import Facts
from camgen.geometry.outlines import Contour, extent
from camgen.parts.keyways import keyed, keyway
from camgen.tolerances import SAME_POINT

HEIGHT = 99.0  # of a detail with its sizes
_HIGH = 48.0  # of the bore in it, at most
_RADIUS = 32.0  # of its bore, beside its sizes
_MIDDLE = 0.56  # of the width of its room
_TITLE = 24.0  # over its upper edge
_LEANING = math.radians(197)  # of the leader of its roughness
_OFF = 10.0  # of a size
_OFF_KEY = 7.0  # so that the frame of its symmetry has room under the title
_PAST_DATUM = 10.0  # more where the datum of a flat is between
_BESIDE = 0.6  # of half a flat's width, from the axis to its datum
_TURN = math.radians(1.0)  # that a flat may leave: camgen's own rule
_CORNER = 0.2  # mm, of a bore's flat: as much as the edges of its shaft are broken
_STEP = 0.005  # mm, of the limits over a flat


@dataclass(frozen=True)
class BoreDetail:
    """A bore, and the room for it: lower left and upper right corner; below it down to `foot` the sheet is still its own.

    label: the hole's own; letters: of the datums that its axis and what holds its angle are; scale: of the sheet's views.
    """

    contour: Contour
    facts: Facts
    label: str
    letters: tuple[str, str]
    scale: float
    room: tuple[complex, complex]
    foot: complex
    turned: bool = False  # from its place in the views

    @property
    def _radius(self) -> float:
        key = keyed(self.contour)
        return key.radius if key else hole_of(self.contour).radius

    @property
    def _top(self) -> float:
        """Of the bore, or of the floor of a keyway, over its axis, mm of the part."""
        key = keyed(self.contour)
        return key.radius + key.depth if key else extent([self.contour])[1].imag

    def draw(self, sheet: Sheet, scales: Sequence[float]) -> None:
        """Draw it, a flat that stands askew upwards, a keyway always; scales: from the largest down."""
        flat = flat_of(self.contour)
        key = keyed(self.contour)
        way = key.way if key else flat[0] if flat else 1j
        if min(abs(way.real), abs(way.imag)) > SAME_POINT or (key and abs(way - 1j) > SAME_POINT):
            upright = self.contour.moved(1j / way)
            replace(self, contour=upright, turned=True).draw(sheet, scales)
            return
        low, high = self.room
        top = self._top
        radius = self._radius
        scale = self._own_scale(scales)
        middle = (high.imag + low.imag) / 2 - scale * (top - radius) / 2
        at = complex(low.real + _MIDDLE * (high - low).real, middle)
        sheet.contour(self.contour.moved(scale, at), "VIEW")
        for way in (1, 1j):
            over = 3 * way
            start = at - scale * radius * way - over
            end = at + scale * (top if way == 1j else radius) * way + over
            sheet.line(start, end, layer="CENTER")
        larger = f" ({number(scale)}:1)" if scale > self.scale else ""  # else as the views
        title = f"Bore {self.label}".rstrip() + ", turned" * self.turned + larger
        level = min(high.imag - 6, middle + scale * top + _TITLE)
        sheet.text(complex(low.real + 1.5, level), title, 3.5)
        if keyed(self.contour) and self.facts.key_fit and keyway(2 * radius):
            sheet.text(complex(low.real + 1.5, level - 4.2), "corners as DIN 6885", 2.5)
        elif flat and self.facts.key_fit:
            said = f"corners of the flat at most R{number(_CORNER)}"
            sheet.text(complex(low.real + 1.5, level - 4.2), said, 2.5)
        self._sizes(sheet, at, scale)

    def _sizes(self, sheet: Sheet, at: complex, scale: float) -> None:
        """Diameter, and height and width of a flat or a keyway, with their datums; at: the axis."""
        facts = self.facts
        radius = self._radius
        top = self._top
        key = keyed(self.contour)

        def size(a: complex, b: complex, away: complex, sign: str, fit: str) -> None:
            measure = Measure(abs(b - a), sign, fit, self.scale / scale)
            dimension(sheet, (at + scale * a, at + scale * b), away, measure, facts.tolerance)

        flat = flat_of(self.contour)
        below = flat is not None and flat[0].imag < -0.5  # its datum comes before the diameter
        bore = -1j * (scale * radius + _OFF + _PAST_DATUM * below)
        beside = complex(scale * radius + _OFF)
        over = at + 1j * scale * top
        size(-radius + 0j, radius + 0j, bore, "Ø", _limits(facts.bore_fit, 2 * radius))
        if facts.bore_roughness:
            self._surface(sheet, at + cmath.rect(scale * radius, _LEANING))
        if facts.profile or facts.symmetry:
            datum(sheet, at + bore, -1j, self.letters[0])
        if flat:
            way, depth = flat
            ends = -radius * way, (depth - radius) * way
            upright = abs(way.imag) > 0.5
            limits = over_flat(facts, radius, depth)
            size(*ends, beside if upright else 1j * beside.real, "", limits)
            beside_axis = _BESIDE * math.sqrt(radius**2 - (depth - radius) ** 2)
            over = at + scale * (
                ends[1] + beside_axis * abs(way.imag) + 1j * beside_axis * abs(way.real)
            )
        if key:
            half = key.width / 2
            width = _limits(facts.key_fit, key.width)
            size(complex(-half, top), complex(half, top), 1j * _OFF_KEY, "", width)
            size(complex(0, -radius), complex(0, top), beside, "", self._depth)
            over += 1j * _OFF_KEY
        if facts.profile and (key or flat):
            datum(sheet, over, flat[0] if flat else 1j, self.letters[1])
        if key and facts.symmetry:
            self._symmetry(sheet, over)

    @property
    def _depth(self) -> str:
        """Limits of bore and keyway together, of a keyway of its usual depth."""
        radius = self._radius
        deeper = keyway(2 * radius)
        usual = deeper is not None and abs(deeper[1] - (self._top - radius)) < SAME_POINT
        return f"+{deeper[2]:g}/0" if self.facts.key_fit and deeper and deeper[2] and usual else ""

    def _symmetry(self, sheet: Sheet, over: complex) -> None:
        """Symmetry of a keyway: beside the datum at the middle of its width, or higher, where paper is free."""
        import shapely

        wide = width_of([number(self.facts.symmetry), self.letters[0]])
        rises = 1j * np.arange(4.4, 4.4 + 2 * FRAME)
        corners = np.concatenate([over - (wide + 4) + rises, over + 4 + rises])
        corners = corners[np.argsort(corners.imag, kind="stable")]
        x = corners.real
        y = corners.imag
        boxes = shapely.box(x - 0.5, y - 0.5, x + wide + 0.5, y + FRAME + 0.5)
        obstacles = Obstacles((self.foot, self.room[1]))
        obstacles.add(sheet.primitives)
        met = obstacles.crossed(boxes) + 100 * (~obstacles.free(boxes) + ~obstacles.within(boxes))
        corner = complex(corners[int(np.argmin(met))])
        symmetry(sheet, corner, self.facts.symmetry, self.letters[0])

    def _own_scale(self, scales: Sequence[float]) -> float:
        """Above that of the views where there is room for that."""
        high = self._radius + self._top
        usual = next(s for s in scales if s * high <= _HIGH)
        room = (self.room[1] - self.room[0]).imag - (HEIGHT - _HIGH)
        larger = [
            s
            for s in reversed(scales)
            if s > self.scale and s * self._radius <= _RADIUS and s * high <= room
        ]
        return usual if usual > self.scale or not larger else larger[0]

    def _surface(self, sheet: Sheet, tip: complex) -> None:
        """Roughness, to the left of a point of the bore's edge."""
        start = tip + cmath.rect(5.0, _LEANING)
        sheet.line(tip, start, layer="DIM")
        sheet.arrow(tip, (tip - start) / abs(tip - start))
        text = f"Ra {self.facts.bore_roughness:g}"
        foot = start - 6 - Text(0j, text, 2.5).room
        sheet.line(start, foot - 2, layer="DIM")
        roughness(sheet, foot, text)


def over_flat(facts: Facts, radius: float, over: float, shaft: bool = False) -> str:
    """Deviations of the distance over a bore's flat, or over a shaft's, of that radius and distance, mm; "" where none is asked for."""
    if not facts.key_fit:
        return ""
    allowed = flat_allowance(radius, over)
    return f"0/-{allowed:g}" if shaft else f"+{allowed:g}/0"


def flat_allowance(radius: float, over: float) -> float:
    """By what bore and shaft may each differ over a flat, mm: both together let the shaft turn by at most a degree either way, about
    an edge of the flat, where a step of a hundredth does."""
    steps = math.floor(_half_flat(radius, over) * math.sin(_TURN) / 2 / _STEP + 1e-9)
    return max(2, steps) * _STEP


def turn_of_flat(radius: float, over: float) -> float:
    """By how much a shaft turns either way in a bore with a flat at these limits, rad; lengths mm."""
    return math.asin(min(1.0, 2 * flat_allowance(radius, over) / _half_flat(radius, over)))


def turn_of_key(diameter: float, width: float, fit: str) -> float:
    """By how much a hub turns either way on a shaft by a key h9 in keyways of one fit, rad; nan beyond the table of fits; lengths mm."""
    keyway_limits = deviations(width, fit)
    key_limits = deviations(width, "h9")
    if keyway_limits is None or key_limits is None:
        return math.nan
    return max(0.0, keyway_limits[1] - key_limits[0]) / (diameter / 2)  # half the play of each


def _half_flat(radius: float, over: float) -> float:
    """Half the width of a flat, mm."""
    return math.sqrt(radius**2 - (over - radius) ** 2)


def _limits(fit: str, size: float) -> str:
    """A fit with its deviations; "" of none."""
    return in_limits(fit, size) if fit else ""
