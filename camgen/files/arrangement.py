"""The arrangement drawing of a machine on one sheet: its front, a section through its axes, numbered parts and their list.

The front is seen along z, what lies behind other parts left out. The section A-A is cut square to the front along a line and seen so
that heights z go upwards; where both have one scale it stands over the front, as in first-angle projection. Pins, shafts, screws and
other rods are not hatched in it. [ISO 128] A part that is seen in the front has its number over or under that, one that only the section
shows has it over the section; of one that neither shows the edge is dashed in the front. Nothing here knows a mechanism.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from camgen.files.dimensions import Hole
from camgen.files.dimensions import number as rounded_number
from camgen.files.labels import Label, callouts
from camgen.files.measures import REFERENCE, Measure, dimension
from camgen.files.page import FILING, LARGE, MARGIN, SCALES, SIZES
from camgen.files.sheet import Sheet, Text, write_dxf_sheet, write_pdf
from camgen.files.title_block import BLOCK, WIDTH, Facts, ratio, title_block
from camgen.files.track_tables import ROW, grid
from camgen.files.views import contours_of, hatching
from camgen.parts.part import Part

_SIZES = {"A3": SIZES["A3"], **LARGE}  # the smallest that will do
_SMALLEST = 0.5  # scale that will do
_FACE = 0.5  # mm, from which on a level face has its height beside the section
_HEIGHTS = (2.5, 1.8)  # of their letters, mm of paper
_LINE = 4 / 3  # from one of them to the next, by that
_LOOSE = 8.0  # by which such heights may stand beyond its ends
_LETTER = "A"
_BALLOON = 4.0  # radius, mm of paper
_APART = 9.0  # from one balloon to the next
_STAGGER = 9.0  # from one row of balloons to the next
_CLEAR = 9.0  # from a view to its balloons
_LETTERED = 4.0  # from letters of the section to balloons beside them
_LEFT = 20.0  # of a view, for a height
_RIGHT = (12.0, 22.0)  # of the front, for a letter; of the section, for its heights
_SIZED = 9.0  # under the front, for its width
_NAMED = 12.0  # over the section, for its name
_UNLIKE = 2.5  # times, that one view may be larger than the other
_PLACES = ("over", "under", "beside")  # of the section, the first that will do
_HATCH = 2.0  # between lines, of the first part; of others more
_COLUMNS = (10.0, 110.0, 10.0, 40.0)  # of the list: number, part, quantity, how it is made
_SEEN = 3.0  # mm^2 of paper, from which on a part is pointed at in a view
_SLIVER = 0.01  # mm^2, up to which a piece counts as hidden
_MITE = 1e-4  # mm: what is left of an edge that is hidden
_CLAUSE = re.compile(r"[,;:] ")
_NOTE = 4.5  # from one line of notes to the next
_SMOOTH = 0.005  # mm of paper, by which a line may be straightened


@dataclass(frozen=True)
class Item:
    """A row of the list."""

    what: str
    count: object
    made: str  # how, and of what
    number: int


@dataclass(frozen=True)
class Copy:
    """A copy of a part where it stands, mm of the machine.

    faces: polygons as seen along z, each with the height of its upper side; cut: polygon of what the section meets, along the line and z.
    """

    number: int
    faces: Sequence[tuple[Any, float]]
    cut: Any
    hatched: bool
    bought: bool = False  # what is no part, and lies in the holes of parts
    short: bool = False  # whether nothing says how long it is, such as a motor's body


@dataclass(frozen=True)
class Axis:
    """An axis that stands: where, mm, and its name in the spec."""

    at: complex
    name: str


@dataclass(frozen=True)
class Arrangement:
    """A machine as its sheet shows it."""

    copies: Sequence[Copy]
    items: Sequence[Item]
    line: tuple[
        complex, complex
    ]  # of the section: a point, and its unit direction, from which the cut's places count
    axes: Sequence[Axis]
    notes: Sequence[str]

    @cached_property
    def seen(self) -> list[tuple[int, Any, Any]]:
        """Number, visible polygon and visible edges of each face, from the highest down."""
        import shapely

        faces = [(top, copy.number, face) for copy in self.copies for face, top in copy.faces]
        above = shapely.Polygon()
        seen = []
        levels = sorted({top for top, _, _ in faces}, reverse=True)
        for level in levels:
            here = [(number, face) for top, number, face in faces if top == level]
            for number, face in here:
                edges = face.boundary.difference(above.buffer(_MITE))
                seen.append((number, face.difference(above), edges))
            above = shapely.union_all([above, *(face for _, face in here)])
        return seen

    @cached_property
    def box(self) -> tuple[complex, complex]:
        """Corners of the front, mm."""
        import shapely

        x0, y0, x1, y1 = shapely.total_bounds([face for _, face, _ in self.seen])
        return complex(x0, y0), complex(x1, y1)

    @cached_property
    def deep(self) -> tuple[complex, complex]:
        """Corners of the section, along the line and z, mm."""
        import shapely

        s0, z0, s1, z1 = shapely.total_bounds([copy.cut for copy in self.copies])
        return complex(s0, z0), complex(s1, z1)

    @cached_property
    def levels(self) -> list[float]:
        """Heights of level faces that the section cuts, mm to hundredths, from the highest down."""
        import shapely

        edges = [
            np.column_stack([z[:-1], z[1:]])
            for copy in self.copies
            if not copy.bought
            for ring in shapely.get_rings(shapely.get_parts(copy.cut))
            for z in [shapely.get_coordinates(ring)]
        ]
        a, low, b, high = np.concatenate([np.zeros((0, 4)), *edges]).T
        level = (abs(high - low) < _MITE) & (abs(b - a) > _FACE)
        heights: list[float] = np.unique(np.round(low[level], 2))[::-1].tolist()
        return heights

    def anchors(self, scale: float) -> tuple[dict[int, complex], dict[int, complex]]:
        """Of each number a point of its part in the front, of those that are hardly seen there one in the section, as far as they are cut."""
        front, cut = self._pieces
        ahead = {number for number, (area, _) in front.items() if area >= _SEEN / scale**2}
        below = cut.keys() - ahead
        rest = front.keys() - ahead - below
        covered = _largest((number, face) for number, face in self.hidden.items())
        return (
            {number: front[number][1] for number in sorted(ahead | rest)}
            | {number: place for number, (_, place) in covered.items()},
            {number: cut[number][1] for number in sorted(below)},
        )

    @cached_property
    def _pieces(self) -> tuple[dict[int, tuple[float, complex]], dict[int, tuple[float, complex]]]:
        """Of each number its largest piece in the front, and in the section."""
        return (
            _largest((number, face) for number, face, _ in self.seen),
            _largest((copy.number, copy.cut) for copy in self.copies),
        )

    @cached_property
    def hidden(self) -> dict[int, Any]:
        """Of each number that neither view shows the highest face, which is drawn dashed."""
        front, cut = self._pieces
        shown = front.keys() | cut.keys()
        faces = [(top, copy.number, face) for copy in self.copies for face, top in copy.faces]
        highest = sorted(faces, key=lambda each: each[0])
        return {number: face for _, number, face in highest if number not in shown}


def _largest(faces: Iterator[tuple[int, Any]]) -> dict[int, tuple[float, complex]]:
    """Of each number the area of its largest piece, and a point inside of it."""
    import shapely

    largest: dict[int, tuple[float, complex]] = {}  # none of what rounding leaves along an edge
    for number, face in faces:
        for piece in shapely.get_parts(face):
            if piece.area > largest.get(number, (_SLIVER, 0j))[0]:
                inside = piece.representative_point()
                largest[number] = float(piece.area), complex(inside.x, inside.y)
    return largest


def write_arrangement(
    folder: Path, name: str, arrangement: Arrangement, facts: Facts
) -> tuple[Path, Path]:
    """Write `<name>-assembly-drawing.dxf` and `.pdf` into folder; returns their paths."""
    page = _Page(arrangement)
    sheet = page.draw(f"Arrangement ({name})", facts)
    dxf = folder / f"{name}-assembly-drawing.dxf"
    pdf = folder / f"{name}-assembly-drawing.pdf"
    write_dxf_sheet(dxf, sheet, page.scale, page.datum)
    write_pdf(pdf, sheet)
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
        for self.size, (self.wide, self.high) in _SIZES.items():
            views = self._views()
            fits = len(arrangement.items) <= self._most and views[0].scale >= _SMALLEST
            if fits and (self._letters(views[1]) or not arrangement.levels):
                break
        self.front, self.section, self.both = views
        self.scale = self.front.scale

    @property
    def datum(self) -> complex:
        """The machine's own origin in the front."""
        return self.front.origin

    @property
    def _most(self) -> int:
        """Rows that the list has room for, without its head."""
        return int((self.high - 2 * MARGIN - BLOCK) / ROW) - 1

    def _views(self) -> tuple[_View, _View, bool]:
        """Front and section as large as they fit, and whether the front has balloons under it too."""
        pairs = [
            (front, section)
            for front, section in product(SCALES, SCALES)
            if 1 / _UNLIKE <= front / section <= _UNLIKE
        ]
        # the largest together, of these the most alike, of these the one with the larger section
        pairs.sort(key=lambda each: (-each[0] * each[1], abs(math.log(each[0] / each[1])), each[0]))
        for scales, both, place in product(pairs, (True, False), _PLACES):
            views = self._placed(scales, both, place)
            if views:
                return *views, both
        raise ValueError("no scale is small enough")

    def _placed(
        self, scales: tuple[float, float], both: bool, place: str
    ) -> tuple[_View, _View] | None:
        """Front and section of these scales; None where they do not fit."""
        low, high = self.arrangement.box
        near, far = self.arrangement.deep
        rooms = self._rooms(scales, both)
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
        if place == "over" and scales[0] == scales[1] and self.arrangement.line[1] == 1:
            start = front.at(self.arrangement.line[0]).real  # over each other, as they are seen
            begin, end = (start + scales[1] * each.real for each in (near, far))
            if begin >= section.left + _LEFT and end + _RIGHT[1] <= section.right:
                section = replace(section, origin=complex(start, section.origin.imag))
        return front, section

    def _rooms(self, scales: tuple[float, float], both: bool) -> tuple[_Room, _Room]:
        """What front and section take."""
        low, high = self.arrangement.box
        near, far = self.arrangement.deep
        above, below, cut = (len(each) for each in self._numbers(scales[0], both))
        wide = self.wide - MARGIN - WIDTH - FILING - 16
        front = _Room(
            scales[0] * (high - low), self._over(above, wide), self._over(below, wide) + _SIZED
        )
        return front, _Room(scales[1] * (far - near), self._over(cut, wide) + _NAMED, _LOOSE)

    def _slots(self, rooms: tuple[_Room, _Room], place: str) -> tuple[_Slot, _Slot]:
        """Where front and section may stand: over each other left of the list, the upper one as wide as the sheet where it ends over
        the list, or beside each other, the section over the list."""
        right = self.wide - MARGIN
        middle = right - WIDTH
        top = self.high - MARGIN
        foot = MARGIN + _NOTE * len(self.arrangement.notes) + 3
        rows = min(len(self.arrangement.items), self._most) + 1
        over_list = MARGIN + BLOCK + ROW * rows + 2
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

    @property
    def _clear(self) -> float:
        """From a view to its balloons: clear of the section's letters too where these stand over or under the front."""
        return _CLEAR + (_LETTERED if abs(self.arrangement.line[1].imag) > 0.5 else 0.0)

    def _over(self, count: int, wide: float) -> float:
        """Room for so many balloons over or under a view, or else for the section's letters that stand there."""
        bare = self._clear if self._clear > _CLEAR else 0.0
        return self._clear + _STAGGER * _rows(count, (0.0, wide)) if count else bare

    def _numbers(
        self, scale: float, both: bool
    ) -> tuple[dict[int, complex], dict[int, complex], dict[int, complex]]:
        """Anchors of the balloons over the front, under it, and over the section."""
        front, cut = self.arrangement.anchors(scale)
        low, high = self.arrangement.box
        middle = (low.imag + high.imag) / 2
        below = {n: z for n, z in front.items() if both and z.imag < middle}
        return {n: z for n, z in front.items() if n not in below}, below, cut

    def draw(self, title: str, facts: Facts) -> Sheet:
        """The whole sheet."""
        sheet = Sheet(self.wide, self.high, title)
        right = self.wide - MARGIN
        sheet.frame(FILING, MARGIN)
        self._front(sheet)
        self._section(sheet)
        above, below, cut = self._numbers(self.scale, self.both)
        low, high = (self.front.at(z) for z in self.arrangement.box)
        end = self.section.at(self.arrangement.deep[1]).imag
        heads = [
            self._balloons(sheet, self.front, above, high.imag + self._clear, 1),
            self._balloons(sheet, self.front, below, low.imag - self._clear, -1),
            self._balloons(sheet, self.section, cut, end + self._clear, 1),
        ]
        self._sizes(sheet, facts.tolerance, heads[1])
        self._name(sheet, heads[2])
        self._levels(sheet)
        self._names(sheet)
        self._list(sheet)
        for k, line in enumerate(reversed(self.arrangement.notes)):
            sheet.text(
                complex(FILING + 3, MARGIN + 3 + _NOTE * k),
                line,
                2.5,
                room=right - WIDTH - FILING - 6,
            )
        block = Part("assembly", "Arrangement", ())
        title_block(sheet, complex(right, MARGIN), block, facts, self.scale, self.size)
        return sheet

    def _balloons(
        self, sheet: Sheet, view: _View, anchors: Mapping[int, complex], first: float, way: int
    ) -> float:
        """Balloons of a view, and where they end."""
        columns = view.left + 8, view.right - 8
        low, high = (view.at(z).real for z in self.arrangement.box)
        if way < 0 and len(anchors) * _APART < high - low:  # clear of the width's own lines
            columns = low + _BALLOON + 1, high - _BALLOON - 1
        _balloons(sheet, {n: view.at(z) for n, z in anchors.items()}, first, way, columns)
        return first + way * (self._over(len(anchors), columns[1] - columns[0]) - self._clear)

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
        begin, end = _chord(self.arrangement.box, self.arrangement.line)
        view = 1j * along
        for place, out in ((begin, -along), (end, along)):
            near = self.front.at(origin + place * along) + 2 * out
            sheet.line(near, near + 6 * out, layer="VIEW")
            tip = near + 6 * out + 5 * view
            sheet.line(near + 6 * out, tip, layer="DIM")
            sheet.arrow(tip, view)
            sheet.text(near + 6 * out - 4 * view - 1.75j, _LETTER, 3.5, "centre")

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
        for axis in self.arrangement.axes:
            place = (axis.at - self.arrangement.line[0]) / self.arrangement.line[1]
            if abs(place.imag) < _MITE and near.real <= place.real <= far.real:
                ends = (near.imag, far.imag)
                low, high = (self.section.at(complex(place.real, z)) for z in ends)
                sheet.line(low - 3j, high + 3j, layer="CENTER")

    def _name(self, sheet: Sheet, end: float) -> None:
        """The section's name over its balloons, with its scale where that is its own."""
        near, far = (self.section.at(z) for z in self.arrangement.deep)
        name = f"{_LETTER}-{_LETTER}"
        if self.section.scale != self.scale:
            name += f" ({ratio(self.section.scale)})"
        sheet.text(complex((near.real + far.real) / 2, end + 4), name, 5.0, "centre")

    def _sizes(self, sheet: Sheet, tolerance: str, foot: float) -> None:
        """Width and height of the front, the width's line under its balloons, depth of the section: they follow from the parts."""
        import shapely

        low, high = (self.front.at(z) for z in self.arrangement.box)
        cuts = [copy.cut for copy in self.arrangement.copies if not copy.short]
        s0, z0, _, z1 = shapely.total_bounds(cuts).tolist()
        near, far = (self.section.at(complex(s0, z)) for z in (z0, z1))
        depth = self.section.scale, self.scale / self.section.scale
        sizes = (
            (
                low,
                complex(high.real, low.imag),
                (foot - _SIZED + 2 - low.imag) * 1j,
                (self.scale, 1.0),
            ),
            (low, complex(low.real, high.imag), -14.0, (self.scale, 1.0)),
            (near, far, -14.0, depth),
        )
        for a, b, away, (scale, factor) in sizes:
            value = Measure(round(abs(b - a) / scale, 1), REFERENCE, factor=factor)
            dimension(sheet, (a, b), complex(away), value, tolerance, FILING + 1)

    def _letters(self, section: _View) -> float:
        """How high letters of the heights beside a section may be, mm; 0 where they are too many."""
        near, far = self.arrangement.deep
        room = section.scale * (far - near).imag + 2 * _LOOSE
        count = len(self.arrangement.levels)
        return next((each for each in _HEIGHTS if count * each * _LINE < room), 0.0)

    def _levels(self, sheet: Sheet) -> None:
        """Heights of the faces that the section cuts, mm, upwards from z = 0, right of it, in smaller letters where they are many; none
        where they are too many even so."""
        levels = self.arrangement.levels
        near, far = (self.section.at(z) for z in self.arrangement.deep)
        wanted = [self.section.at(complex(0, level)).imag for level in reversed(levels)]
        least = near.imag - _LOOSE
        most = far.imag + _LOOSE
        high = self._letters(self.section)
        if not levels or not high:
            return
        places = _spread(wanted, (least, most), high * _LINE)
        for level, at, place in zip(reversed(levels), wanted, places, strict=True):
            start = complex(far.real + 2, at)
            sheet.line(start, start + 3, complex(far.real + 9, place), layer="DIM")
            text = rounded_number(level, 2)
            sheet.text(complex(far.real + 10, place - high / 2), text, high, layer="DIM")

    def _list(self, sheet: Sheet) -> None:
        """The list of parts over the title block, its first row the lowest. [ISO 7573]"""
        items = self.arrangement.items
        shown = items if len(items) <= self._most else items[: self._most - 1]
        rows = [
            (str(each.number), _fitting(each.what), str(each.count), each.made) for each in shown
        ]
        if len(shown) < len(items):
            rows.append(("...", f"{len(items) - len(shown)} more: see the list of parts", "", ""))
        lines = [*reversed(rows), ("Item", "Part", "Qty", "Made")]
        corner = complex(self.wide - MARGIN - WIDTH, MARGIN + BLOCK + ROW * len(lines))
        grid(sheet, corner, lines, _COLUMNS, (0, 2))
        sheet.line(corner, corner + WIDTH, layer="TEXT")


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
        if abs(way) > _MITE
    ]
    begin = max(a for a, _ in spans)
    end = min(b for _, b in spans)
    return (begin, end) if begin < end else (min(ends), max(ends))


def _hatched(face: Any, step: float, lean: int) -> list[tuple[complex, complex]]:
    """Lines that fill a face, at 45 deg or leaning to the other side."""
    from shapely import affinity

    turned = face if lean > 0 else affinity.scale(face, -1, 1, origin=(0, 0))
    lines = hatching(turned, step)
    return lines if lean > 0 else [(-a.conjugate(), -b.conjugate()) for a, b in lines]


def _balloons(
    sheet: Sheet,
    anchors: Mapping[int, complex],
    first: float,
    way: int,
    columns: tuple[float, float],
) -> None:
    """Numbers in circles, in rows from the height `first` on, up (1) or down (-1), each with a line to its part that ends in a dot."""
    order = sorted(anchors, key=lambda number: (anchors[number].real, anchors[number].imag))
    rows = _rows(len(order), columns)
    for row in range(rows):
        numbers = order[row::rows]
        places = _spread([anchors[number].real for number in numbers], columns)
        for number, x in zip(numbers, places, strict=True):
            middle = complex(x, first + way * (_BALLOON + _STAGGER * row))
            to = anchors[number] - middle
            sheet.arc(middle, _BALLOON, 0.0, 2 * np.pi, "TEXT")
            sheet.text(middle - 1.25j, str(number), 2.5, "centre")
            sheet.line(middle + _BALLOON * to / abs(to), anchors[number], layer="DIM")
            sheet.arc(anchors[number], 0.5, 0.0, 2 * np.pi, "DIM")


def _fitting(text: str) -> str:
    """As many of a text's first clauses as a line of the list has room for, at least one."""
    while Text(0j, text, 2.5).room > _COLUMNS[1] - 2 and (clauses := _CLAUSE.split(text))[1:]:
        text = text[: len(text) - len(clauses[-1])].rstrip(" ,;:")
    return text


def _rows(count: int, columns: tuple[float, float]) -> int:
    """In how many rows so many balloons stand."""
    return -(-count // int((columns[1] - columns[0]) / _APART))


def _spread(
    wanted: Sequence[float], columns: tuple[float, float], apart: float = _APART
) -> list[float]:
    """Places in order, as near as can be to those wanted, which rise, so far apart, mm."""
    steps = apart * np.arange(len(wanted))
    low, high = columns
    shifted = np.array(wanted) - steps  # of which places in order rise
    pushed = np.maximum.accumulate(shifted), np.minimum.accumulate(shifted[::-1])[::-1]
    middle = (pushed[0] + pushed[1]) / 2  # to the right by those before, to the left by those after
    places: list[float] = (np.clip(middle, low, max(low, high - steps[-1])) + steps).tolist()
    return places
