"""The second sheet of an arrangement drawing: the parts drawn apart with their numbers, and what each of them is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from camgen.files.arrangement import Arrangement
from camgen.files.assembly_list import EDGES, draw_list, folded, height
from camgen.files.balloons import BESIDE, RADIUS, balloons
from camgen.files.exploded_view import Body, Seen, apart, filled, isometric, paper
from camgen.files.page import FILING, LARGE, MARGIN, SIZES
from camgen.files.sheet import Sheet
from camgen.files.title_block import BLOCK, WIDTH, Facts, sheet_words, title_block
from camgen.numerics import coordinates
from camgen.parts.part import Part

_MISSED = 0.05  # of the parts' numbers, that may be hidden
_GAPS = (0.05, 0.08, 0.12)  # between parts, of the machine's size: the first at which most are seen
_SEEN = 1.0  # mm^2 of paper, from which on a part is
_VOLUME = 1e-3  # mm^3, from which on a prism is drawn
_COLUMNS = 3  # of the list
_MOST = 2  # lists beside each other
_ROOM = BESIDE + RADIUS + 2  # round the picture, for balloons

_SPECK = 0.3  # mm of paper, up to which a line is left out
_NOTE = (
    "The way of each part back from where it is in the machine, as the steps of assembly have it.",
    "In the PDF alone: the DXF of this drawing holds its first sheet, at full size.",
)
_LINE = 4.5  # from one of its lines to the next
_TURN = 4.0  # from a tower to where the axis turns that goes on at the next

Area = tuple[complex, complex]  # of paper: its lower left corner, and its upper right one
_Column = tuple["_Tower", Area, complex]  # of the sheet: what stands in it, and where its origin is


@dataclass(frozen=True)
class _Tower:
    """What is built by itself, drawn apart."""

    name: str  # of what is built by itself
    seen: Sequence[Seen]
    axes: Sequence[Any]

    @cached_property
    def bounds(self) -> tuple[complex, complex]:
        """Its corners, mm of the machine."""
        import shapely

        x0, y0, x1, y1 = shapely.total_bounds([each.face for each in self.seen])
        return complex(x0, y0), complex(x1, y1)

    @cached_property
    def faces(self) -> dict[int, Any]:
        """Of each number what is seen of it."""
        import shapely

        faces: dict[int, list[Any]] = {}
        for each in self.seen:
            faces.setdefault(each.number, []).append(each.face)
        return {number: shapely.union_all(own) for number, own in sorted(faces.items())}

    @property
    def clear(self) -> set[int]:
        """Numbers of what has a piece of which others hide less than half."""
        return {each.number for each in self.seen if each.face.area > each.whole.area / 2}


@dataclass(frozen=True)
class _Picture:
    """Towers beside each other, as large as the largest of some areas lets them be."""

    towers: Sequence[_Tower]
    areas: Sequence[Area]
    axis: complex = 0j  # a point of the axis that goes on from one to the next, as it is drawn

    def _fitting(self, area: Area) -> float:
        """Scale at which it fits into an area."""
        sizes = [tower.bounds[1] - tower.bounds[0] for tower in self.towers]
        room = area[1] - area[0] - 2 * _ROOM * complex(len(sizes), 1)
        wide = sum(size.real for size in sizes)
        high = max(size.imag for size in sizes)
        return min(room.real / wide, room.imag / high)

    @cached_property
    def area(self) -> Area:
        """Where it is the largest."""
        return max(self.areas, key=self._fitting)

    @cached_property
    def scale(self) -> float:
        """Of paper to the machine."""
        return self._fitting(self.area)

    @cached_property
    def shown(self) -> set[int]:
        """Numbers of what is seen enough of to point at."""
        least = _SEEN / self.scale**2
        return {
            number
            for tower in self.towers
            for number, face in tower.faces.items()
            if face.area >= least
        }

    @property
    def clear(self) -> set[int]:
        """Numbers of what is seen enough of to know its shape."""
        return self.shown & set[int]().union(*(tower.clear for tower in self.towers))

    def draw(self, sheet: Sheet) -> None:
        """Edges, axes and balloons of each tower in its column, and the way from one to the next."""
        low, high = self.area
        widths = [
            self.scale * (tower.bounds[1] - tower.bounds[0]).real + 2 * _ROOM
            for tower in self.towers
        ]
        spare = (high.real - low.real - sum(widths)) / len(widths)
        left = low.real
        drawn = []
        for tower, width in zip(self.towers, widths, strict=True):
            column = complex(left, low.imag), complex(left + width + spare, high.imag)
            left = column[1].real
            origin = (sum(column) - self.scale * sum(tower.bounds)) / 2
            drawn.append((tower, column, origin))
            for each in tower.seen:
                _lines(sheet, self._placed(each.edges, origin), "VIEW")
            for axis in tower.axes:
                _lines(sheet, self._placed(axis, origin), "CENTER")
            top = origin + self.scale * complex(sum(tower.bounds).real / 2, tower.bounds[1].imag)
            sheet.text(top + 1j * _ROOM, tower.name.capitalize(), 5.0, "centre")
        for below, above in zip(drawn, drawn[1:], strict=False):
            self._join(sheet, below, above)
        least = _SEEN / self.scale**2
        for tower, column, origin in drawn:
            outline = self._placed(filled([each.face for each in tower.seen]), origin)
            parts = {
                number: self._placed(face, origin)
                for number, face in tower.faces.items()
                if face.area >= least
            }
            balloons(sheet, parts, outline, column)

    def _join(self, sheet: Sheet, below: _Column, above: _Column) -> None:
        """The axis of the drive, which goes on from the top of one column at the foot of the next."""
        axis = self.scale * self.axis
        top = complex((below[2] + axis).real, (below[2] + self.scale * below[0].bounds[1]).imag)
        foot = complex((above[2] + axis).real, (above[2] + self.scale * above[0].bounds[0]).imag)
        beside = below[1][1].real
        turns = (top + 1j * _TURN).imag, (foot - 1j * _TURN).imag
        corners = [complex(x, y) for x, y in ((top.real, turns[0]), (beside, turns[0]))]
        corners += [complex(x, y) for x, y in ((beside, turns[1]), (foot.real, turns[1]))]
        sheet.line(top + 1j, *corners, foot - 1j, layer="CENTER")

    def _placed(self, shape: Any, origin: complex) -> Any:
        """A shape of a tower on paper, whose own origin is there."""
        import shapely

        def at(points: Any) -> Any:
            return coordinates(origin + self.scale * (points @ np.array([1, 1j])))

        return shapely.transform(shape, at)


def exploded_sheet(arrangement: Arrangement, title: str, facts: Facts, size: str = "A3") -> Sheet:
    """The sheet, as large as the first one: its list over the title block, the picture beside one of them."""
    wide, high = {**SIZES, **LARGE}[size]
    sheet = Sheet(wide, high, title)
    sheet.frame(FILING, MARGIN)
    right = wide - MARGIN
    foot = MARGIN + BLOCK
    top = high - MARGIN
    items = [replace(item, designation="", material="", heights=()) for item in arrangement.items]
    lists = folded(items, top - foot, _MOST)
    for k, each in enumerate(lists, 1):
        draw_list(sheet, complex(right - k * EDGES[_COLUMNS], foot), each, _COLUMNS)
    block = Part("assembly", "Arrangement, parts drawn apart", ())
    title_block(sheet, complex(right, MARGIN), block, facts, 0.0, sheet_words(size, 2, 2))
    listed = right - EDGES[_COLUMNS] * len(lists)
    areas = [
        (complex(FILING, foot), complex(listed, top)),
        (complex(FILING, MARGIN + _LINE * len(_NOTE) + 3), complex(right - WIDTH, top)),
        (complex(FILING, foot + max(map(height, lists))), complex(right, top)),
    ]
    towers = _towers(arrangement)
    numbers = {body.number for bodies in towers.values() for body in bodies}
    across = abs(arrangement.box[1] - arrangement.box[0])
    axis = paper(arrangement.axes[0].at) if arrangement.axes else 0j
    best: _Picture | None = None

    def picture(gap: float, far: set[int]) -> _Picture:
        drawn = [
            _Tower(name, *isometric(bodies, apart(bodies, gap * across, far)))
            for name, bodies in towers.items()
        ]
        return _Picture(drawn, areas, axis)

    for gap in _GAPS if towers else ():
        one = picture(gap, set())
        for far in (numbers - one.shown, numbers - one.clear):  # what others hide is taken farther
            if far:
                farther = picture(gap, far)
                one = max(one, farther, key=lambda each: (len(each.shown), len(each.clear)))
        if best is None or len(one.shown) > len(best.shown):
            best = one
        if len(numbers - best.shown) <= _MISSED * len(numbers):
            break
    hidden = ""
    if best is not None:
        best.draw(sheet)
        hidden = ", ".join(map(str, sorted(numbers - best.shown)))
    notes = [
        f"{_NOTE[0]}{f' Hidden by others, or too small: {hidden}.' if hidden else ''}",
        *_NOTE[1:],
    ]
    for k, line in enumerate(reversed(notes)):
        sheet.text(complex(FILING + 3, MARGIN + 3 + _LINE * k), line, 2.5)
    return sheet


def _towers(arrangement: Arrangement) -> dict[str, list[Body]]:
    """What of the machine's copies has a volume: of the machine, then of each piece that is built by itself, by its name."""
    import shapely

    towers: dict[str, list[Body]] = {}
    for copy in arrangement.copies:
        prisms = [
            (piece, low, high)
            for shape, low, high in copy.prisms
            for piece in shapely.get_parts(shape)
            if piece.area * (high - low) > _VOLUME
        ]
        if prisms:
            body = Body(copy.number, prisms, copy.coming, copy.solid)
            towers.setdefault(copy.coming.apart, []).append(body)
    return dict(sorted(towers.items()))


def _lines(sheet: Sheet, edges: Any, layer: str) -> None:
    """Draw edges."""
    import shapely

    merged = shapely.line_merge(edges) if edges.geom_type == "MultiLineString" else edges
    for line in shapely.get_parts(merged):
        points = shapely.get_coordinates(line) @ np.array([1, 1j])
        if len(points) > 1 and line.length > _SPECK:
            sheet.line(*points.tolist(), layer=layer)
