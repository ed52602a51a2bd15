"""The arrangement drawing of a machine on one sheet: its front, a section through its axes, numbered parts and their list.

Where front and section have one scale the section stands over the front, as in first-angle projection. Pins, shafts, screws and other
rods are not hatched in it. [ISO 128] A part has its number at the view that shows it nearer to the outline; of one that neither shows the
edge is dashed in the front.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from camgen.files.arrangement import MITE, Arrangement
from camgen.files.assembly_list import draw_list, folded_in_full, height
from camgen.files.balloons import BESIDE, RADIUS, balloons
from camgen.files.dimensions import Hole
from camgen.files.dimensions import number as rounded_number
from camgen.files.exploded_sheet import exploded_sheet
from camgen.files.exploded_view import filled
from camgen.files.labels import Label, callouts
from camgen.files.measures import REFERENCE, Measure, Room, dimension
from camgen.files.page import FILING, LARGE, MARGIN, SCALES, SIZES
from camgen.files.sheet import Sheet, Text, write_dxf_sheet, write_pdf
from camgen.files.title_block import BLOCK, WIDTH, Facts, ratio, sheet_words, title_block
from camgen.files.views import contours_of, hatching
from camgen.numerics import coordinates
from camgen.parts.part import Part

# The smallest sheet that will do, and in how many columns its list stands.
_SHEETS = (
    ("A3", SIZES["A3"], 1),
    ("A2", LARGE["A2"], 1),
    ("A1", LARGE["A1"], 1),
    ("A1", LARGE["A1"], 2),
)
_SMALLEST = 0.5  # scale that will do
_MOST = 12  # heights beside the section
_HEIGHT = 2.5  # of their letters and those of notes, mm of paper
_LINE = 3.4  # from one of them to the next
_LOOSE = 8.0  # by which such heights may stand beyond its ends
_BEND = 5.0  # of a section's line on either side of where it bends
_LEVEL = 0.5  # deg, by which the line of a section may lean and count as level
_BAND = BESIDE + RADIUS + 1  # over and under a view, for a row of balloons
_LEFT = 20.0  # of a view, for a height
_RIGHT = (12.0, 22.0)  # of the front, for a letter; of the section, for its heights
_SIZED = 6.0  # under balloons, for the front's width
_NAMED = 8.0  # over balloons, for the section's name
_UNLIKE = 2.5  # times, that one view may be larger than the other
_PLACES = ("over", "under", "beside")  # of the section, the first that will do
_HATCH = 2.0  # between lines, of the first part; of others more
_NARROWER = 1.08  # times, that letters of notes may be
_NOTE = 4.5  # from one line of notes to the next
_SMOOTH = 0.005  # mm of paper, by which a line may be straightened


def write_arrangement(
    folder: Path, name: str, arrangement: Arrangement, facts: Facts
) -> tuple[Path, Path]:
    """Write `<name>-assembly-drawing.dxf` and `.pdf` into folder; returns their paths."""
    page = _Page(arrangement)
    sheet = page.draw(f"Arrangement ({name})", facts)
    dxf = folder / f"{name}-assembly-drawing.dxf"
    pdf = folder / f"{name}-assembly-drawing.pdf"
    write_dxf_sheet(dxf, sheet, page.scale, page.datum)
    write_pdf(pdf, sheet, exploded_sheet(arrangement, sheet.title, facts, page.size))
    return dxf, pdf


@dataclass(frozen=True)
class _View:
    """A view on paper."""

    origin: complex  # its own origin there
    scale: float
    left: float  # from where on what belongs to it may stand
    right: float  # and up to where

    def at(self, z: complex) -> complex:
        """A point of the view on paper."""
        return self.origin + self.scale * z

    def paper(self, face: Any) -> Any:
        """A polygon of the view on paper."""
        import shapely

        def placed(points: Any) -> Any:
            return coordinates(self.origin + self.scale * (points @ np.array([1, 1j])))

        return shapely.transform(face, placed)


@dataclass(frozen=True)
class _Room:
    """What a view takes on paper, mm."""

    size: complex  # of the view itself
    over: float  # for balloons, and a name
    under: float

    @property
    def high(self) -> float:
        """From its lowest balloon to its highest."""
        return self.over + self.size.imag + self.under


@dataclass(frozen=True)
class _Slot:
    """A piece of the sheet, its corners."""

    low: complex
    high: complex


class _Page:
    """Its views on paper."""

    def __init__(self, arrangement: Arrangement) -> None:
        self.arrangement = arrangement
        items = arrangement.items
        for self.size, (self.wide, self.high), columns in _SHEETS:
            self.noted = self.wide - MARGIN - WIDTH - FILING - 6
            self.notes = _packed(arrangement.notes, self.noted)
            self.lists = folded_in_full(items, self.high - 2 * MARGIN - BLOCK, columns)
            self.front, self.section = self._views()
            whole = all(item.whole for column in self.lists for item in column)
            listed = sum(map(len, self.lists)) == len(items) and whole
            if listed and self.front.scale >= _SMALLEST:
                break
        self.scale = self.front.scale

    @property
    def datum(self) -> complex:
        """The machine's own origin in the front."""
        return self.front.origin

    @cached_property
    def _depth(self) -> tuple[float, float]:
        """From where to where the whole machine reaches, mm, without screws of which only what is in it is known."""
        import shapely

        whole = [copy for copy in self.arrangement.copies if not copy.short]
        _, low, _, high = shapely.total_bounds([copy.cut for copy in whole]).tolist()
        return (
            min(low, *(copy.span[0] for copy in whole)),
            max(high, *(copy.span[1] for copy in whole)),
        )

    def _views(self) -> tuple[_View, _View]:
        """Front and section as large as they fit."""
        most = 1.0 if self.size == "A1" else max(SCALES)  # it has room for more, not for larger
        pairs = [
            (front, section)
            for front, section in product(SCALES, SCALES)
            if 1 / _UNLIKE <= front / section <= _UNLIKE and max(front, section) <= most
        ]
        # the largest together, of these the most alike, of these the one with the larger section
        pairs.sort(key=lambda each: (-each[0] * each[1], abs(math.log(each[0] / each[1])), each[0]))
        for scales, place in product(pairs, _PLACES):
            views = self._placed(scales, place)
            if views:
                return views
        raise ValueError("no scale is small enough")

    def _placed(self, scales: tuple[float, float], place: str) -> tuple[_View, _View] | None:
        """Front and section of these scales; None where they do not fit."""
        low, high = self.arrangement.box
        near, far = self.arrangement.deep
        bottom, top = self._depth  # what is not cut reaches farther, and its size with it
        over = max(_BAND + _NAMED, scales[1] * (top - far.imag))
        under = max(_LOOSE, scales[1] * (near.imag - bottom))
        rooms = (
            _Room(scales[0] * (high - low), _BAND, _BAND + _SIZED),
            _Room(scales[1] * (far - near), over, under),
        )
        slots = self._slots(rooms, place)
        views = []
        for k, (room, slot) in enumerate(zip(rooms, slots, strict=True)):
            spare = slot.high.real - slot.low.real - _LEFT - room.size.real - _RIGHT[k]
            if spare < 0 or slot.high.imag - room.high < slot.low.imag:
                return None
            left = slot.low.real + _LEFT + spare / 2
            corner = complex(left, slot.high.imag - room.over - room.size.imag)
            origin = corner - scales[k] * (low, near)[k]
            views.append(_View(origin, scales[k], slot.low.real, slot.high.real))
        front, section = views
        level = self.arrangement.line[1] == 1 and self.arrangement.bend is None
        if place == "over" and scales[0] == scales[1] and level:
            start = front.at(self.arrangement.line[0]).real  # over each other, as they are seen
            begin, end = (start + scales[1] * each.real for each in (near, far))
            if begin >= section.left + _LEFT and end + _RIGHT[1] <= section.right:
                section = replace(section, origin=complex(start, section.origin.imag))
        return front, section

    def _slots(self, rooms: tuple[_Room, _Room], place: str) -> tuple[_Slot, _Slot]:
        """Where front and section may stand: over each other left of the list, the upper one as wide as the sheet where it ends over
        the list, or beside each other, the section over the list."""
        right = self.wide - MARGIN
        middle = right - WIDTH * len(self.lists)
        top = self.high - MARGIN
        foot = MARGIN + _NOTE * len(self.notes) + 3
        over_list = MARGIN + BLOCK + max(map(height, self.lists)) + 2
        front, section = rooms
        if place == "beside":
            head = max(0.0, (top - foot - front.high) / 2)
            aside = max(0.0, (top - over_list - section.high) / 2)
            return (
                _Slot(complex(FILING, foot), complex(middle, top - head)),
                _Slot(complex(middle, over_list), complex(right, top - aside)),
            )
        first, second = (section, front) if place == "over" else (front, section)
        spare = top - foot - first.high - second.high
        slack = top - first.high - over_list
        head = max(0.0, min(spare / 3, slack) if slack > 0 else spare / 3)
        end = top - head - first.high
        upper = _Slot(complex(FILING, end), complex(right if slack > 0 else middle, top - head))
        gap = max(0.0, (spare - head) / 2)
        lower = _Slot(complex(FILING, foot), complex(middle, end - gap))
        return (lower, upper) if place == "over" else (upper, lower)

    def draw(self, title: str, facts: Facts) -> Sheet:
        """The whole sheet."""
        sheet = Sheet(self.wide, self.high, title)
        right = self.wide - MARGIN
        sheet.frame(FILING, MARGIN)
        self._front(sheet)
        self._section(sheet)
        self._sizes(sheet, facts.tolerance)
        self._name(sheet)
        self._levels(sheet)
        self._names(sheet)
        for k, items in enumerate(self.lists, 1):
            draw_list(sheet, complex(right - k * WIDTH, MARGIN + BLOCK), items)
        for k, line in enumerate(reversed(self.notes)):
            at = complex(FILING + 3, MARGIN + 3 + _NOTE * k)
            sheet.text(at, line, _HEIGHT, room=self.noted)
        block = Part("assembly", "Arrangement", ())
        title_block(
            sheet, complex(right, MARGIN), block, facts, self.scale, sheet_words(self.size, 1, 2)
        )
        self._balloons(sheet)
        return sheet

    def _balloons(self, sheet: Sheet) -> None:
        """Numbers of parts round both views."""
        shown = self.arrangement.shown(self.front.scale, self.section.scale)
        views = self.front, self.section
        low = complex(FILING + 1, MARGIN + 1)
        area = low, complex(self.wide - MARGIN - 1, self.high - MARGIN - 1)
        for view, parts, whole in zip(views, shown, self.arrangement.outlines, strict=True):
            placed = {number: view.paper(part) for number, part in parts.items()}
            balloons(sheet, placed, view.paper(filled(whole)), area)

    def _front(self, sheet: Sheet) -> None:
        """Visible edges, axes that stand, and where the section is cut."""
        import shapely

        for _, _, edges in self.arrangement.seen:
            merged = shapely.line_merge(edges) if edges.geom_type == "MultiLineString" else edges
            for line in shapely.get_parts(shapely.simplify(merged, _SMOOTH / self.scale)):
                points = shapely.get_coordinates(line) @ np.array([1, 1j])
                if len(points) > 1:
                    sheet.line(*(self.front.at(z) for z in points.tolist()), layer="VIEW")
        for face in self.arrangement.hidden.values():
            for contour in contours_of(face):
                sheet.contour(contour.moved(self.scale, self.datum), "HIDDEN")
        for axis in self.arrangement.axes:
            for way in (4.0, 4j):
                sheet.line(
                    self.front.at(axis.at) - way, self.front.at(axis.at) + way, layer="CENTER"
                )
        origin, along = self.arrangement.line
        before = self.arrangement.bend or along
        if self.arrangement.bend is not None:
            at = self.front.at(origin)
            sheet.line(at - _BEND * before, at, at + _BEND * along, layer="VIEW")
        ends = (
            (before, -1, _chord(self.arrangement.box, (origin, before))[0]),
            (along, 1, _chord(self.arrangement.box, (origin, along))[1]),
        )
        for way, sense, place in ends:
            out = sense * way
            view = 1j * way
            near = self.front.at(origin + place * way) + 2 * out
            sheet.line(near, near + 6 * out, layer="VIEW")
            tip = near + 6 * out + 5 * view
            sheet.line(near + 6 * out, tip, layer="DIM")
            sheet.arrow(tip, view)
            sheet.text(near + 6 * out - 4 * view - 1.75j, self.arrangement.letter, 3.5, "centre")

    def _names(self, sheet: Sheet) -> None:
        """Names of axes that stand, on free paper."""
        circle = 1.5 * np.exp(2j * np.pi * np.arange(16) / 16)
        labels = []
        for axis in self.arrangement.axes:
            at = self.front.at(axis.at)
            labels.append(Label(axis.name, Hole(at, "", at, 1.5), at + circle))
        area = (
            complex(FILING + 1, MARGIN + 1),
            complex(self.front.right - 8, self.high - MARGIN - 1),
        )
        for each in callouts(labels, sheet, area):
            sheet.things += each.things

    def _section(self, sheet: Sheet) -> None:
        """Faces of the section, hatched part by part, without what lies in their holes."""
        import shapely

        things = [each.cut for each in self.arrangement.copies if each.bought]
        filled = shapely.union_all([shapely.Polygon(), *things])
        near, far = self.arrangement.deep
        for copy in self.arrangement.copies:
            if copy.cut.is_empty:
                continue
            face = copy.cut if copy.bought else copy.cut.difference(filled)
            for contour in contours_of(face):
                whole = contour.moved(self.section.scale, self.section.origin)
                sheet.contour(whole, "VIEW")
            if copy.hatched:
                step = (_HATCH + 0.7 * (copy.number % 3)) / self.section.scale
                lean = -1 if copy.number % 2 else 1
                for ends in _hatched(face, step, lean):
                    sheet.line(*(self.section.at(z) for z in ends), layer="HATCH")
        for middle, radius in self.arrangement.balls:
            ball = radius * self.section.scale
            sheet.arc(self.section.at(middle), ball, 0.0, 2 * np.pi, "VIEW")
        for axis in self.arrangement.axes:
            place = self.arrangement.place(axis.at)
            if place is not None and near.real <= place <= far.real:
                ends = (near.imag, far.imag)
                low, high = (self.section.at(complex(place, z)) for z in ends)
                sheet.line(low - 3j, high + 3j, layer="CENTER")

    def _name(self, sheet: Sheet) -> None:
        """The section's name over its balloons, with its scale where that is its own."""
        near, far = (self.section.at(z) for z in self.arrangement.deep)
        letter = self.arrangement.letter
        name = f"{letter}-{letter}"
        if self.section.scale != self.scale:
            name += f" ({ratio(self.section.scale)})"
        turned = math.degrees(
            math.atan2(*(self.arrangement.line[1].imag, self.arrangement.line[1].real))
        )
        if abs(turned) > _LEVEL and self.arrangement.bend is None:
            way = "clockwise" if turned > 0 else "counter-clockwise"
            name += f", turned {abs(turned):.0f}° {way}"
        sheet.text(complex((near.real + far.real) / 2, far.imag + _BAND + 1), name, 5.0, "centre")

    def _sizes(self, sheet: Sheet, tolerance: str) -> None:
        """Width and height of the front, the width's line under its balloons, depth of the whole machine beside the section and distance
        between the bearings of its shaft: they follow from the parts."""
        import shapely

        low, high = (self.front.at(z) for z in self.arrangement.box)
        whole = [copy for copy in self.arrangement.copies if not copy.short]
        s0 = float(shapely.total_bounds([copy.cut for copy in whole])[0])
        depths = [(*self._depth, -14.0)]
        bearings = self.arrangement.bearings
        depths += [(a, b, -7.0) for a, b in zip(bearings, bearings[1:], strict=False)]
        across = complex(high.real, low.imag), -1j * (_BAND + _SIZED - 2)
        sizes = [
            (self.front, low, *across),
            (self.front, low, complex(low.real, high.imag), -14.0 + 0j),
        ]
        for begin, end, beside in depths:
            near, far = (self.section.at(complex(s0, z)) for z in (begin, end))
            sizes.append((self.section, near, far, complex(beside)))
        for view, a, b, away in sizes:
            factor = self.scale / view.scale
            value = Measure(round(abs(b - a) / view.scale, 1), REFERENCE, factor=factor)
            dimension(sheet, (a, b), away, value, tolerance, Room(FILING + 1))

    def _levels(self, sheet: Sheet) -> None:
        """Heights of faces that the section cuts, mm, upwards from z = 0, right of it, each with a line to its face."""
        near, far = (self.section.at(z) for z in self.arrangement.deep)
        least = near.imag - _LOOSE
        most = far.imag + _LOOSE
        levels = self.arrangement.levels(min(_MOST, int((most - least) / _LINE)))
        if not levels:
            return
        faces = [self.section.at(complex(end, height)) for height, end in reversed(levels)]
        places = _spread([face.imag for face in faces], (least, most), _LINE)
        for level, face, place in zip(reversed(levels), faces, places, strict=True):
            start = complex(far.real + 3, face.imag)
            sheet.line(face + 0.8, start, complex(far.real + 9, place), layer="DIM")
            text = rounded_number(level.height, 2)
            sheet.text(complex(far.real + 10, place - _HEIGHT / 2), text, _HEIGHT, layer="DIM")


def _chord(box: tuple[complex, complex], line: tuple[complex, complex]) -> tuple[float, float]:
    """From where to where a line runs through a box, mm from its point; where it misses the box, as far as that reaches."""
    low, high = box
    origin, along = line
    ends = [
        ((complex(x, y) - origin) / along).real
        for x in (low.real, high.real)
        for y in (low.imag, high.imag)
    ]
    spans = [
        sorted(((a - at) / way, (b - at) / way))
        for a, b, at, way in (
            (low.real, high.real, origin.real, along.real),
            (low.imag, high.imag, origin.imag, along.imag),
        )
        if abs(way) > MITE
    ]
    begin = max(a for a, _ in spans)
    end = min(b for _, b in spans)
    return (begin, end) if begin < end else (min(ends), max(ends))


def _packed(notes: Sequence[str], room: float) -> list[str]:
    """Notes in lines, a short one behind the first that leaves room for it; one that is too long for a line goes on in the next."""
    lines: list[str] = []
    for note in notes:
        whole = _fits(note, room)
        begun = len(lines)
        for piece in [note] if whole else note.split():
            fitting = range(len(lines)) if whole else range(begun, len(lines))[-1:]
            k = next((k for k in fitting if _fits(f"{lines[k]} {piece}", room)), None)
            if k is None:
                lines.append(piece)
            else:
                lines[k] += f" {piece}"
    return lines


def _fits(text: str, room: float) -> bool:
    """Whether a note has room on a line, a little narrower than usual if it must."""
    return Text(0j, text, _HEIGHT).room <= _NARROWER * room


def _hatched(face: Any, step: float, lean: int) -> list[tuple[complex, complex]]:
    """Lines that fill a face, at 45 deg or leaning to the other side."""
    from shapely import affinity

    turned = face if lean > 0 else affinity.scale(face, -1, 1, origin=(0, 0))
    lines = hatching(turned, step)
    return lines if lean > 0 else [(-a.conjugate(), -b.conjugate()) for a, b in lines]


def _spread(wanted: Sequence[float], columns: tuple[float, float], apart: float) -> list[float]:
    """Places in order, as near as can be to those wanted, which rise, so far apart, mm."""
    steps = apart * np.arange(len(wanted))
    low, high = columns
    shifted = np.array(wanted) - steps  # of which places in order rise
    pushed = np.maximum.accumulate(shifted), np.minimum.accumulate(shifted[::-1])[::-1]
    middle = (pushed[0] + pushed[1]) / 2  # to the right by those before, to the left by those after
    places: list[float] = (np.clip(middle, low, max(low, high - steps[-1])) + steps).tolist()
    return places
