"""The seat of a ball bearing by itself on the sheet of its part, cut along its axis, with the lip under it. Coordinates: mm of paper.

It stands as the part lies, z upwards, for its bearing comes from above; the section of the part has z downwards. The lip's height is what the link's place hangs on, so that has limits; the seat's depth
follows from it and from the thickness of the part.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from camgen.files import views
from camgen.files.dimensions import hole_of, number
from camgen.files.measures import REFERENCE, Measure, dimension
from camgen.files.sheet import Sheet
from camgen.files.title_block import Facts
from camgen.parts.part import Part
from camgen.tolerances import SAME_POINT

Paper = Callable[[float, float], complex]  # of x and z of the part, mm

HEIGHT = 76.0  # of a detail with its sizes
_AROUND = 46.0  # of that, beside the cut
_WIDE = 60.0  # of the cut, at most
_TITLE = 26.0  # over its upper edge
_OFF = 10.0  # of a size
_OVER = 8.0  # of the seat's diameter: clear of the lines under the title
_MIDDLE = 0.54  # of the width of its room
_WALL = 0.5  # of a seat's radius, as much as is shown round it
_CORNER = 0.1  # mm, of the part: less than a ring's own; camgen's own rule
_HATCH = 2.5  # between the lines of a cut face


@dataclass(frozen=True)
class Seat:
    """A hole in which a ball bearing sits on a lip; mm of the part."""

    labels: tuple[str, ...]  # of the holes that are alike
    radius: float
    lip: float  # radius of the hole under it
    floor: float  # height of the lip over the part's underside
    high: float  # of the part
    fit: str  # such as "JS7 (±0.0075)"


def seat_of(part: Part, facts: Facts) -> Seat | None:
    """The seats of a part, which are all alike; None of a part that has none, or whose sheet asks nothing of lips."""
    found = dict[tuple[float, ...], list[str]]()
    fits = dict[float, str]()
    names = {place: name for name, place in part.points}
    for fit in facts.fits if facts.lip else ():
        under = [
            (hole.radius, layer.z1)
            for layer in part.layers
            for hole in map(hole_of, layer.region.holes)
            if layer is not part.drawn
            and abs(hole.place - fit.at) < SAME_POINT
            and 0 < hole.radius < fit.diameter / 2
        ]
        for lip, floor in under if fit.ring else ():
            label = next((name for z, name in names.items() if abs(z - fit.at) < SAME_POINT), "")
            found.setdefault((fit.diameter / 2, lip, floor), []).append(label)
            fits[fit.diameter / 2] = fit.words.partition(",")[0]
    for (radius, lip, floor), labels in found.items():
        return Seat(tuple(labels), radius, lip, floor, part.thickness, fits[radius])
    return None


@dataclass(frozen=True)
class SeatDetail:
    """A seat, and the room for it: lower left and upper right corner; scale: of the sheet's views."""

    seat: Seat
    facts: Facts
    scale: float
    room: tuple[complex, complex]

    def draw(self, sheet: Sheet, scales: Sequence[float]) -> None:
        """Draw it; scales: from the largest down."""
        seat = self.seat
        low, high = self.room
        wide = (1 + _WALL) * seat.radius
        deep = min(HEIGHT, (high - low).imag) - _AROUND
        scale = next(s for s in scales if s * 2 * wide <= _WIDE and s * seat.high <= deep)
        top = complex(low.real + _MIDDLE * (high - low).real, high.imag - _TITLE)
        foot = top - 1j * scale * seat.high

        def paper(x: float, z: float) -> complex:
            return foot + scale * complex(x, z)

        self._cut(sheet, paper, wide, scale)
        of = " and ".join([", ".join(seat.labels[:-1]), seat.labels[-1]][len(seat.labels) == 1 :])
        title = f"Seat{'s' * (len(seat.labels) > 1)} {of} ({number(scale)}:1)"
        sheet.text(complex(low.real + 1.5, high.imag - 7), title, 3.5)
        corner = f"z upwards; corners at most R{_CORNER:g}"
        sheet.text(complex(low.real + 1.5, high.imag - 11.2), corner, 2.5)

        def size(a: complex, b: complex, away: complex, sign: str, fit: str) -> None:
            measure = Measure(abs(b - a) / scale, sign, fit, self.scale / scale)
            dimension(sheet, (a, b), away, measure, self.facts.tolerance)

        size(paper(-seat.lip, 0.0), paper(seat.lip, 0.0), -1j * _OFF, "Ø", "")
        mouth = paper(-seat.radius, seat.high), paper(seat.radius, seat.high)
        size(*mouth, 1j * _OVER, "Ø", seat.fit)
        lip = f"0/-{self.facts.lip:g}"
        size(paper(wide, 0.0), paper(wide, seat.floor), _OFF + 0j, "", lip)
        # downwards: where there is no room for its number, this stands below, clear of the seat's diameter
        size(paper(-wide, seat.high), paper(-wide, seat.floor), -_OFF + 0j, REFERENCE, "")

    def _cut(self, sheet: Sheet, paper: Paper, wide: float, scale: float) -> None:
        """The cut faces on both sides of the axis, broken off so far from it, and the edges behind the cut; scale: of the detail."""
        import shapely

        seat = self.seat
        for side in (-1, 1):
            edge = [
                (side * wide, 0.0),
                (side * seat.lip, 0.0),
                (side * seat.lip, seat.floor),
                (side * seat.radius, seat.floor),
                (side * seat.radius, seat.high),
                (side * wide, seat.high),
            ]
            corners = [paper(*each) for each in edge]
            sheet.line(*corners, layer="VIEW")
            sheet.line(corners[-1], corners[0], layer="DIM")  # where it is broken off
            for a, b in views.hatching(shapely.Polygon(edge), _HATCH / scale):
                sheet.line(paper(a.real, a.imag), paper(b.real, b.imag), layer="HATCH")
        for x, z in ((seat.lip, 0.0), (seat.radius, seat.floor), (seat.radius, seat.high)):
            sheet.line(paper(-x, z), paper(x, z), layer="VIEW")
        over = 4.0 / scale
        sheet.line(paper(0.0, -over), paper(0.0, seat.high + over), layer="CENTER")
