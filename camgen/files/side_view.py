"""Views of a part from the left and along y, or its sections there, with their sizes. Coordinates: mm of paper."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from camgen.files import views
from camgen.files.dimensions import number
from camgen.files.drawn_part import DrawnPart
from camgen.files.labels import Obstacles
from camgen.files.limits import in_limits
from camgen.files.measures import REFERENCE, Measure
from camgen.files.page import Page
from camgen.files.symbols import FRAME, datum, roughness, run_out, width_of
from camgen.geometry.arcs import fit_arcs
from camgen.geometry.drums import Drum
from camgen.geometry.outlines import extent, rectangle

BOSS = 10.0  # between the dimensions of bosses, beside the view from the left
_FACE = 0.7  # of the radius of a drum's lower end: where its datum is in the view from the left
_HATCH = 2.5  # mm of paper between the lines of a cut face
_WALL = 7.0  # between dimensions of a drum's walls


@dataclass(frozen=True)
class SideViews:
    """The view from the left and the one below the plan view, in their places on the sheet."""

    drawn: DrawnPart
    page: Page

    def draw(self) -> None:
        """Edge view, heights growing to the right, with the thickness."""
        left = self.page.side_x
        origin = complex(left, self.page.datum.imag)
        if self.drawn.upright:
            self._cut(self.drawn.upright, origin, 1j)
            ends = (
                self.page.paper(self.drawn.low).imag - 16,
                self.page.paper(self.drawn.high).imag + self.page.room_above - 6,
            )
            place = complex(left, ends[self.drawn.part.drum is not None])
            self.page.sheet.text(place, f"{self.drawn.letter}-{self.drawn.letter}", 3.5)
        else:
            self._edges_from_left(origin)
        self._boss_sizes(origin)
        if self.drawn.face_letter:
            end = min(self.drawn.part.layers, key=lambda layer: layer.z0).region.outer
            low = _FACE * extent([end])[0].imag
            datum(
                self.page.sheet,
                complex(left, self.page.paper(1j * low).imag),
                -1,
                self.drawn.face_letter,
            )
        thick = self.page.scale * self.drawn.part.thickness
        if self.drawn.low.imag <= self.drawn.zero.imag <= self.drawn.high.imag:
            y = self.page.paper(self.drawn.zero).imag
            self.page.sheet.line(complex(left - 4, y), complex(left + thick + 4, y), layer="CENTER")
        bottom = self.page.paper(self.drawn.low).imag
        away = -9j if self.drawn.part.drum is None else -3j * _WALL
        self.page.dimension(
            complex(left, bottom),
            complex(left + thick, bottom),
            away,
            Measure(self.drawn.part.thickness),
        )
        if self.drawn.part.drum:
            self._walls(origin, self.drawn.part.drum)
            return
        heights = sorted(
            {layer.z1 for layer in self.drawn.part.layers} - {self.drawn.part.thickness}
        )
        heights = heights if len(heights) <= 2 else []  # no room for more; the table has them all
        for i, height in enumerate(heights, 1):
            top = complex(left, self.page.paper(self.drawn.high).imag)
            self.page.dimension(top, top + self.page.scale * height, 9j * i, Measure(height))

    def _edges_from_left(self, origin: complex) -> None:
        """The boxes of the layers and, dashed, of the bores in them; origin: of the part in this view, on paper."""
        for layer in self.drawn.part.layers:
            low, high = extent([fit_arcs(layer.region.outer, self.drawn.tolerance)])
            box = rectangle(complex(layer.z0, low.imag), complex(layer.z1, high.imag))
            self.page.sheet.contour(box.moved(self.page.scale, origin), "VIEW")
        for bore in (
            () if self.drawn.plate else views.side_bores(self.drawn.part, self.drawn.tolerance)
        ):
            self.page.sheet.contour(bore.moved(self.page.scale, origin), "HIDDEN")
        for ends in self._chamfer_edges():
            self.page.sheet.line(*(origin + self.page.scale * end for end in ends), layer="HIDDEN")

    def _chamfer_edges(self) -> Iterator[tuple[complex, complex]]:
        """Edges of the bore's chamfers in the view from the left, z + iy, mm."""
        radius = (self.drawn.part.bore or 0.0) / 2
        c = self.drawn.chamfer
        high = self.drawn.part.thickness
        for end, inner in ((0.0, c), (high, high - c)) if c else ():
            for side in (-1, 1):
                yield complex(end, side * (radius + c)), complex(inner, side * radius)
            yield complex(inner, -radius), complex(inner, radius)

    def _walls(self, origin: complex, drum: Drum) -> None:
        """Diameter of a drum's floor in its section, and how far its walls are from its ends there; origin: of the part, on paper."""
        right = origin + self.page.scale * self.drawn.part.thickness
        half = 1j * self.page.scale * drum.floor
        away = complex(self.page.inner + BOSS)
        self.page.dimension(right - half, right + half, away, Measure(2 * drum.floor, "Ø"))
        for side in (-1, 1):
            rim = origin + 1j * side * self.page.scale * drum.outside
            beta = np.array([side * math.pi / 2])
            levels = [wall.over(beta, np.array([drum.outside])).z.item() for wall in drum.walls]
            spans = [(0.0, levels[0]), (levels[-1], drum.length)][: len(levels)]
            for k, (low, high) in enumerate(spans, 1):
                ends = rim + self.page.scale * low, rim + self.page.scale * high
                self.page.dimension(*ends, 1j * side * k * _WALL, Measure(high - low, REFERENCE))

    def _boss_sizes(self, origin: complex) -> None:
        """Diameters of the bosses, to the right of the view from the left."""
        right = origin + self.page.scale * self.drawn.part.thickness
        for k, radius in enumerate(self.drawn.bosses, 1):
            half = 1j * self.page.scale * radius
            away = complex(self.page.inner + BOSS * k)
            self.page.dimension(right - half, right + half, away, Measure(2 * radius, "Ø"))
        if self.page.inner:
            self._bore_size(right)

    def _bore_size(self, right: complex) -> None:
        """Diameter of a round bore with its fit, datum and roughness; right: its end in the view, on paper."""
        facts = self.drawn.facts
        size = self.drawn.part.bore or 0.0
        half = 0.5j * self.page.scale * size
        fit = in_limits(facts.bore_fit, size) if facts.bore_fit else ""
        self.page.dimension(
            right - half, right + half, complex(self.page.inner), Measure(size, "Ø", fit)
        )
        foot = right + self.page.inner - half - (6j if 2 * half.imag < 12 else 0j)
        datum(self.page.sheet, foot, -1j, self.drawn.datum_letter)
        if facts.bore_roughness:
            roughness(self.page.sheet, right + half + 3, f"Ra {facts.bore_roughness:g}")

    def _cut(self, section: views.Section, origin: complex, turn: complex) -> None:
        """A section on paper: its faces hatched, and the edges behind it; turn: of the view, its z downwards before."""
        way = self.page.scale * turn
        for contour in views.contours_of(section.faces):
            self.page.sheet.contour(contour.moved(way, origin, mirror=True), "VIEW")
        hatching = views.hatching(section.faces, _HATCH / self.page.scale)
        for layer, lines in (("VIEW", section.beyond), ("HATCH", hatching)):
            for ends in lines:
                self.page.sheet.line(*(origin + way * z.conjugate() for z in ends), layer=layer)

    def third(self) -> None:
        """The view from above or the section, heights z growing downwards."""
        top = complex(
            self.page.datum.real, self.page.paper(self.drawn.low).imag - self.page.room_below
        )
        for contour in self.drawn.beyond:
            self.page.sheet.contour(contour.moved(self.page.scale, top, mirror=True), "VIEW")
        for bore in views.above_bores(self.drawn.part, self.drawn.tolerance):
            self.page.sheet.contour(bore.moved(self.page.scale, top, mirror=True), "HIDDEN")
        if self.drawn.section:
            self._cut(self.drawn.section, top, 1)
            self.page.sheet.text(
                top + self.page.scale * self.drawn.low.real + 2.5j,
                f"{self.drawn.letter}-{self.drawn.letter}",
                3.5,
            )

    def run_out(self) -> None:
        """Run-out of a cam's face at z = 0: to the left of it in the view from the left, where paper is free."""
        facts = self.drawn.facts
        if not (
            facts.run_out and self.drawn.part.bore and self.drawn.turns and self.drawn.datum_letter
        ):
            return
        import shapely

        face = min(self.drawn.part.layers, key=lambda layer: layer.z0).region
        low, high = extent([fit_arcs(face.outer, self.drawn.tolerance)])
        bore = max((abs(z.imag) for z in extent(self.drawn.holes)), default=0.0)
        levels = np.linspace(high.imag, low.imag, 32)[1:-1]
        levels = levels[np.abs(levels) > bore]
        wide = width_of([number(facts.run_out), self.drawn.datum_letter])
        left = self.page.side_x
        places = (
            left - 5 - wide + 1j * (self.page.datum.imag + self.page.scale * levels - FRAME / 2)
        )
        x = places.real
        y = places.imag
        boxes = shapely.box(x - 1, y - 1, x + wide + 4, y + FRAME + 1)
        obstacles = Obstacles()
        obstacles.add(self.page.sheet.primitives)
        met = obstacles.crossed(boxes) + 100 * ~obstacles.free(boxes) + ~obstacles.off_axes(boxes)
        corner = complex(places[int(np.argmin(met))])
        end = (
            run_out(self.page.sheet, corner, facts.run_out, self.drawn.datum_letter)
            + 1j * FRAME / 2
        )
        self.page.sheet.line(end, complex(left, end.imag), layer="DIM")
        self.page.sheet.arrow(complex(left, end.imag), 1)
