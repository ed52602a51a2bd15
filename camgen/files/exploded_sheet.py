"""The second sheet of an arrangement drawing: the parts drawn apart with their numbers, and what each of them is."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from camgen.files.arrangement import Arrangement
from camgen.files.assembly_list import EDGES, draw_list, folded, height
from camgen.files.balloons import BESIDE, RADIUS, balloons
from camgen.files.exploded_view import Body, Seen, apart, filled, isometric
from camgen.files.page import FILING, MARGIN, SIZES
from camgen.files.sheet import Sheet
from camgen.files.title_block import BLOCK, WIDTH, Facts, sheet_words, title_block
from camgen.numerics import coordinates
from camgen.parts.part import Part

_GAPS = (0.05, 0.08, 0.12)  # between parts, of the machine's size: the first at which most are seen
_SEEN = 4.0  # mm^2 of paper, from which on a part is
_VOLUME = 1e-3  # mm^3, from which on a prism is drawn
_COLUMNS = 3  # of the list
_MOST = 2  # lists beside each other
_ROOM = BESIDE + RADIUS + 2  # round the picture, for balloons

Area = tuple[complex, complex]  # of paper: its lower left corner, and its upper right one


@dataclass(frozen=True)
class _Picture:
    """Parts drawn apart, as large as the larger of some areas lets them be."""

    seen: Sequence[Seen]
    axes: Sequence[Any]
    areas: Sequence[Area]

    @cached_property
    def bounds(self) -> tuple[complex, complex]:
        """Its corners, mm of the machine."""
        import shapely

        x0, y0, x1, y1 = shapely.total_bounds([each.face for each in self.seen])
        return complex(x0, y0), complex(x1, y1)

    def _fitting(self, area: Area) -> float:
        """Scale at which it fits into an area."""
        size = self.bounds[1] - self.bounds[0]
        room = area[1] - area[0] - 2 * _ROOM * (1 + 1j)
        return min(room.real / size.real, room.imag / size.imag)

    @cached_property
    def area(self) -> Area:
        """Where it is the largest."""
        return max(self.areas, key=self._fitting)

    @cached_property
    def scale(self) -> float:
        """Of paper to the machine."""
        return self._fitting(self.area)

    @cached_property
    def shown(self) -> dict[int, Any]:
        """Of each number what is seen of it, where that is enough to point at."""
        import shapely

        faces: dict[int, list[Any]] = {}
        for each in self.seen:
            faces.setdefault(each.number, []).append(each.face)
        whole = {number: shapely.union_all(own) for number, own in sorted(faces.items())}
        least = _SEEN / self.scale**2
        return {number: face for number, face in whole.items() if face.area >= least}

    def placed(self, shape: Any) -> Any:
        """A shape of it on paper."""
        import shapely

        origin = (sum(self.area) - self.scale * sum(self.bounds)) / 2

        def at(points: Any) -> Any:
            return coordinates(origin + self.scale * (points @ np.array([1, 1j])))

        return shapely.transform(shape, at)

    def draw(self, sheet: Sheet) -> None:
        """Its edges, axes and balloons."""

        for each in self.seen:
            _lines(sheet, self.placed(each.edges), "VIEW")
        for axis in self.axes:
            _lines(sheet, self.placed(axis), "CENTER")
        outline = self.placed(filled([each.face for each in self.seen]))
        parts = {number: self.placed(face) for number, face in self.shown.items()}
        balloons(sheet, parts, outline, self.area)


def exploded_sheet(arrangement: Arrangement, title: str, facts: Facts) -> Sheet:
    """The sheet: its list over the title block, the picture beside one of them."""
    wide, high = SIZES["A3"]
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
    title_block(sheet, complex(right, MARGIN), block, facts, 0.0, sheet_words("A3", 2, 2))
    listed = right - EDGES[_COLUMNS] * len(lists)
    areas = [
        (complex(FILING, foot), complex(listed, top)),
        (complex(FILING, MARGIN), complex(right - WIDTH, top)),
        (complex(FILING, foot + max(map(height, lists))), complex(right, top)),
    ]
    bodies = list(_bodies(arrangement))
    size = abs(arrangement.box[1] - arrangement.box[0])
    best: _Picture | None = None
    for gap in _GAPS if bodies else ():
        picture = _Picture(*isometric(bodies, apart(bodies, gap * size)), areas)
        if best is None or len(picture.shown) > len(best.shown):
            best = picture
        if len(best.shown) == len({body.number for body in bodies}):
            break
    if best is not None:
        best.draw(sheet)
    return sheet


def _bodies(arrangement: Arrangement) -> Iterator[Body]:
    """What of the machine's copies has a volume."""
    import shapely

    for copy in arrangement.copies:
        prisms = [
            (piece, low, high)
            for shape, low, high in copy.prisms
            for piece in shapely.get_parts(shape)
            if piece.area * (high - low) > _VOLUME
        ]
        if prisms:
            yield Body(copy.number, prisms)


def _lines(sheet: Sheet, edges: Any, layer: str) -> None:
    """Draw edges."""
    import shapely

    merged = shapely.line_merge(edges) if edges.geom_type == "MultiLineString" else edges
    for line in shapely.get_parts(merged):
        points = shapely.get_coordinates(line) @ np.array([1, 1j])
        if len(points) > 1:
            sheet.line(*points.tolist(), layer=layer)
