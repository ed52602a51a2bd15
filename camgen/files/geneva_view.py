"""Sizes of a Geneva drive in the plan views of its wheel and of the disc that locks it. Coordinates: mm of paper.

Slots and hollows have limits of size, and their middle planes and axes tolerances of position about the bore, from exact places;
the disc's arc one of coaxiality, and what relieves it one of profile with a table of points.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from camgen.files.dimensions import SlottedWheel, number
from camgen.files.drawn_part import DrawnPart
from camgen.files.labels import Obstacles
from camgen.files.limits import decimals, general
from camgen.files.measures import Measure
from camgen.files.page import FILING, Page
from camgen.files.sheet import Sheet, Text
from camgen.files.symbols import (
    FRAME,
    boxed,
    coaxiality,
    line_profile,
    position,
    roughness,
    width_of,
)
from camgen.files.tracks import looser
from camgen.geometry.outlines import Arc
from camgen.tolerances import SAME_POINT

_TEXT = 2.5
_FAR = tuple(np.arange(8.0, 70.0, 3.0))  # from a tip to its shelf
_ASIDE = tuple(np.radians([0, 15, -15, 30, -30, 45, -45, 65, -65, 90, -90, 120, -120]))
_DEEPER = "0/-0.3"  # of the end of a slot, towards the axis: no roller meets it
_OVER = 7.0  # from the line of a slot's width to the frame of its position
PAST_SLOT = 20.0  # from there up, over the frame
_UP = 9.0  # height of a sign of roughness over a shelf, with air


@dataclass(frozen=True)
class Note:
    """What a leader says: a text with an exact size behind it in a box, the frame of a tolerance below, a roughness behind both."""

    text: str
    exact: str = ""
    frame: Callable[[Sheet, complex], complex] | None = None
    cells: tuple[str, ...] = ()  # of that frame
    ra: float = 0.0

    @property
    def words(self) -> float:
        """How wide text and box are."""
        box = Text(0j, self.exact, _TEXT).room + 4 if self.exact else 0.0
        return Text(0j, self.text, _TEXT).room + box

    @property
    def width(self) -> float:
        """Of the whole shelf."""
        wide = max(self.words, width_of(self.cells) if self.frame else 0.0) + 2
        return wide + (Text(0j, self._roughness, _TEXT).room + 7 if self.ra else 0.0)

    @property
    def _roughness(self) -> str:
        return f"Ra {self.ra:g}"

    def draw(self, sheet: Sheet, left: complex) -> None:
        """On a shelf whose left end is there."""
        sheet.line(left, left + self.width, layer="DIM")
        at = left + 1 + 1.2j
        room = Text(0j, self.text, _TEXT).room
        if self.exact:  # up to its box
            sheet.text(at + room, self.text, _TEXT, "right")
            boxed(sheet, at + room + 2.5, self.exact)
        else:
            sheet.text(at, self.text, _TEXT)
        if self.frame:
            self.frame(sheet, left + 1 - 1j * (FRAME + 0.8))
        if self.ra:
            wide = Text(0j, self._roughness, _TEXT).room + 5
            roughness(sheet, left + self.width - wide, self._roughness)


@dataclass(frozen=True)
class GenevaView:
    """A wheel with slots, or the disc that locks one, in its place on the sheet."""

    drawn: DrawnPart
    page: Page

    def draw(self) -> None:
        """Sizes of every wheel and lock that the part has; nothing on another part."""
        for wheel in self.drawn.slotted:
            self._wheel(wheel)
        if self.drawn.lock:
            self._lock(*self.drawn.lock)

    @property
    def _datums(self) -> tuple[str, ...]:
        letters = (self.drawn.datum_letter, self.drawn.angle_letter)
        return tuple(each for each in letters if each)

    def _size(self, value: float) -> str:
        """A size under the general tolerance of the sheet."""
        return number(value, decimals(general(value, self.drawn.facts.tolerance)))

    def _wheel(self, wheel: SlottedWheel) -> None:
        """Width, depth and spacing of a wheel's slots, its hollows and its rim; of those at the top, where one is upright."""
        sheet = self.page.sheet
        facts = self.drawn.facts
        count = len(wheel.slots)
        off = looser(facts.profile)
        slot = max(wheel.slots, key=lambda z: round(z.imag, 6))
        way = slot / abs(slot)
        for middle in wheel.slots:
            along = middle / abs(middle)
            ends = middle - wheel.width * along, along * max(wheel.rim, abs(middle) + wheel.width)
            sheet.line(*map(self.page.paper, ends), layer="CENTER")
        sheet.arc(self.page.datum, self.page.scale * abs(slot), 0.0, math.tau, "CENTER")
        self._spacing(slot, count)
        said = f"{count} × {number(wheel.width)} {off}".rstrip()
        if abs(way.real) < SAME_POINT:
            self._upright(wheel, abs(slot), count)
        else:
            side = slot + 0.5j * way * wheel.width
            deep = _DEEPER if facts.profile else ""
            ends_at = f"{said} wide, ends about R{self._size(abs(slot))} {deep}".rstrip()
            self._note(side + way, way, self._located(Note(ends_at), across=True))
        hollow = max(
            wheel.hollows, key=lambda arc: round((arc.centre * (3 + 2j).conjugate()).real, 6)
        )
        away = hollow.centre / abs(hollow.centre)
        far = f"R{number(abs(hollow.centre))}"
        bottom = complex(hollow.at((hollow.t0 + hollow.t1) / 2, 0))
        said = f"{count} × R{number(hollow.radius)} {off}".rstrip()
        about = Note(f"{said} about", far) if facts.profile else Note(f"{said} about {far}")
        self._note(bottom, away, self._located(about))
        rim = cmath.rect(wheel.rim, cmath.phase(hollow.centre) - math.pi / count)
        rim *= cmath.exp(1j * (wheel.width / 2 + 1) / wheel.rim)
        self._note(rim, rim / abs(rim), Note(f"Ø{self._size(2 * wheel.rim)}"))

    def _located(self, note: Note, across: bool = False) -> Note:
        """With a tolerance of position, of a middle plane where it is across, and the roughness of a track."""
        facts = self.drawn.facts
        if not facts.profile:
            return note
        frame = partial(position, width=facts.profile, datums=self._datums, flat=across)
        cells = (f"{'' if across else 'Ø'}{number(facts.profile)}", *self._datums)
        return Note(note.text, note.exact, frame, cells, facts.roughness)

    def _upright(self, wheel: SlottedWheel, depth: float, count: int) -> None:
        """Width and depth of the slot at the top, as dimensions."""
        page = self.page
        facts = self.drawn.facts
        high = self.drawn.high
        mouth = page.paper(1j * high.imag)
        half = page.scale * wheel.width / 2
        measure = Measure(wheel.width, f"{count} × ", looser(facts.profile))
        page.dimension(mouth - half, mouth + half, 9j, measure)
        if facts.profile:
            located = self._located(Note(""), across=True)
            corner = mouth - half - 6 + 1j * (9 + _OVER) - width_of(located.cells)
            assert located.frame is not None
            end = located.frame(page.sheet, corner)
            if facts.roughness:
                roughness(page.sheet, end + 4, f"Ra {facts.roughness:g}")
                page.sheet.line(end, end + 6 + Text(0j, "Ra 0.00", _TEXT).room, layer="DIM")
        right = page.paper(high.real + 0j)
        deeper = Measure(depth, "R", _DEEPER if facts.profile else "")
        page.dimension(right, right + 1j * page.scale * depth, 9 + 0j, deeper)

    def _spacing(self, slot: complex, count: int) -> None:
        """Angle from one of so many even slots to the next one, clockwise."""
        page = self.page
        radius = 0.6 * page.scale * abs(slot)
        start = cmath.phase(slot)
        pitch = math.tau / count
        page.sheet.arc(page.datum, radius, start - pitch, pitch, "DIM")
        for angle, sense in ((start, 1), (start - pitch, -1)):
            turn = cmath.exp(1j * angle)
            lean = cmath.exp(-1j * sense * 1.5 / radius)  # an arrow's half on the arc
            page.sheet.arrow(page.datum + radius * turn, sense * 1j * turn * lean)
        said = page.datum + cmath.rect(radius + 3, start - pitch / 2) - 1.2j
        step = f"{number(360 / count)}°"
        if not self.drawn.facts.profile:
            page.sheet.text(said, f"{count} × {step}", _TEXT, "centre")
            return
        times = f"{count} ×"
        page.sheet.text(said, times, _TEXT, "right")
        boxed(page.sheet, said + 1.5, step)

    def _lock(self, arc: Arc, relief: Sequence[complex]) -> None:
        """Radius of the disc's arc, about the bore, and the tolerance of what relieves it."""
        facts = self.drawn.facts
        middle = complex(arc.at((arc.t0 + arc.t1) / 2, 0))
        way = middle / abs(middle) * cmath.exp(0.7j)
        said = f"R{number(arc.radius)} {looser(facts.profile, True)}".rstrip()
        if not facts.profile:
            self._note(arc.radius * way, way, Note(said))
            return
        frame = partial(coaxiality, width=facts.profile, datums=self._datums[:1])
        cells = (f"Ø{number(facts.profile)}", *self._datums[:1])
        self._note(arc.radius * way, way, Note(said, "", frame, cells, facts.roughness))
        profile = partial(line_profile, width=facts.profile, datums=self._datums)
        tip = (relief[-2] + relief[-1]) / 2
        note = Note("relief, by its table", "", profile, (number(facts.profile), *self._datums))
        self._note(tip, middle / abs(middle), note)

    def _note(self, point: complex, way: complex, note: Note) -> None:
        """A leader onto a point of the part from a direction, with its shelf where paper is free."""
        import shapely

        sheet = self.page.sheet
        tip = self.page.paper(point)
        obstacles = Obstacles((complex(FILING, 0), complex(self.page.table_x, sheet.height - 11)))
        obstacles.add(sheet.primitives)
        tries = [
            (tip + far * way * cmath.rect(1, turn), far, abs(turn))
            for far in _FAR
            for turn in _ASIDE
        ]
        lefts = [z if z.real >= tip.real else z - note.width for z, _, _ in tries]
        below = FRAME + 2.0 if note.frame else 1.0
        above = _UP if note.ra else 5.5
        x = np.array([z.real for z in lefts])
        y = np.array([z.imag for z in lefts])
        boxes = shapely.box(x - 1, y - below, x + note.width + 1, y + above)
        legs = [shapely.LineString([(z.real, z.imag), (tip.real, tip.imag)]) for z, _, _ in tries]
        met = 100.0 * ~obstacles.free(boxes) + 200 * ~obstacles.within(boxes)
        met += 20 * obstacles.crossed(boxes) + 12 * ~obstacles.off_axes(boxes)
        met += 50 * ~obstacles.free(shapely.buffer(legs, 0.5)) + 5 * obstacles.crossed(legs)
        met += np.array([0.2 * far + 2 * turn for _, far, turn in tries])
        k = int(np.argmin(met))
        start = tries[k][0]
        sheet.line(tip, start, layer="DIM")
        sheet.arrow(tip, (tip - start) / abs(tip - start))
        note.draw(sheet, lefts[k])
