"""Views of a part from the left and along y, or its sections there, with their sizes. Coordinates: mm of paper."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from camgen.files import views
from camgen.files.dimensions import number, rod_of
from camgen.files.drawn_part import DrawnPart
from camgen.files.labels import Obstacles
from camgen.files.limits import in_limits
from camgen.files.measures import REFERENCE, Measure
from camgen.files.page import Page
from camgen.files.sheet import Text
from camgen.files.symbols import FRAME, datum, roughness, run_out, width_of
from camgen.geometry.arcs import fit_arcs
from camgen.geometry.drums import Drum
from camgen.geometry.outlines import Contour, extent, rectangle
from camgen.parts.catalogue import SCREWS
from camgen.parts.part import Tap
from camgen.tolerances import SAME_POINT

BOSS = 10.0  # between the dimensions of bosses, beside the view from the left
_UNDER_SHANK = -11j  # from a pin's head to its length, clear of the arrow of its diameter
_FACE = 0.7  # of the radius of a drum's lower end: where its datum is in the view from the left
_HATCH = 2.5  # mm of paper between the lines of a cut face
_THREAD = "6H"  # tolerance class of threads in a part [ISO 965-1]
_OVER_OUTSIDE = 7.0  # from a drum's outside to the frame of its run-out


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
        facts = self.drawn.facts
        if facts.length_limits and self.drawn.shank:
            self._shank_length(complex(left, bottom), facts.length_limits)
        else:
            self.page.dimension(
                complex(left, bottom),
                complex(left + thick, bottom),
                -9j,
                Measure(
                    self.drawn.part.thickness, fit=facts.length_limits or facts.thickness_limits
                ),
            )
        if self.drawn.part.drum:
            self._floor(origin, self.drawn.part.drum)
            return
        heights = sorted(
            {layer.z1 for layer in self.drawn.part.layers} - {self.drawn.part.thickness}
        )
        if self.drawn.seat:  # whose detail has its height
            heights = [z for z in heights if abs(z - self.drawn.seat.floor) > SAME_POINT]
        if self.drawn.part.tap and self.drawn.upright:
            self._thread(origin, self.drawn.part.tap)
            heights.append(self.drawn.part.tap.height)
        heights = heights if len(heights) <= 2 else []  # no room for more; the table has them all
        for i, height in enumerate(heights, 1):
            top = complex(left, self.page.paper(self.drawn.high).imag)
            self.page.dimension(top, top + self.page.scale * height, 9j * i, Measure(height))

    def _shank_length(self, low: complex, limits: str) -> None:
        """Length of a headed pin's shank, and that over all, which follows from it; low: foot of its head, on paper."""
        part = self.drawn.part
        head = min(layer.z1 for layer in part.layers)
        end = low + self.page.scale * part.thickness
        self.page.dimension(
            low + self.page.scale * head,
            end,
            _UNDER_SHANK,
            Measure(part.thickness - head, fit=limits),
            low.real,  # clear of the line of the length over all
        )
        self.page.dimension(low, end, _UNDER_SHANK - 9j, Measure(part.thickness, REFERENCE))

    def _edges_from_left(self, origin: complex) -> None:
        """The boxes of the layers and, dashed, of the bores in them; origin: of the part in this view, on paper."""
        boxes = []
        for layer in self.drawn.part.layers:
            low, high = extent([fit_arcs(layer.region.outer, self.drawn.tolerance)])
            boxes.append(rectangle(complex(layer.z0, low.imag), complex(layer.z1, high.imag)))
        for box in self._joined(boxes):
            self.page.sheet.contour(box.moved(self.page.scale, origin), "VIEW")
        for bore in (
            () if self.drawn.plate else views.side_bores(self.drawn.part, self.drawn.tolerance)
        ):
            self.page.sheet.contour(bore.moved(self.page.scale, origin), "HIDDEN")
        for ends in self._chamfer_edges():
            self.page.sheet.line(*(origin + self.page.scale * end for end in ends), layer="HIDDEN")

    def _joined(self, boxes: Sequence[Contour]) -> Iterable[Contour]:
        """Boxes of layers, as one where no edge is seen between them: all outlines are one, or one circle but for flats."""
        import shapely

        outlines = {layer.region.outer for layer in self.drawn.part.layers}
        rounds = {
            around and (round(abs(around[0]), 6), round(around[1], 6))
            for around in map(rod_of, outlines)
        }
        if len(boxes) == 1 or (len(outlines) > 1 and (len(rounds) > 1 or rounds == {None})):
            return boxes
        shapes = [shapely.Polygon(views.corners(box, self.drawn.tolerance)) for box in boxes]
        whole = shapely.union_all(shapes, grid_size=1e-9)
        return views.contours_of(whole)

    def _chamfer_edges(self) -> Iterator[tuple[complex, complex]]:
        """Edges of the bore's chamfers in the view from the left, z + iy, mm."""
        radius = (self.drawn.part.bore or 0.0) / 2
        c = self.drawn.chamfer
        high = self.drawn.part.thickness
        for end, inner in ((0.0, c), (high, high - c)) if c else ():
            for side in (-1, 1):
                yield complex(end, side * (radius + c)), complex(inner, side * radius)
            yield complex(inner, -radius), complex(inner, radius)

    def _floor(self, origin: complex, drum: Drum) -> None:
        """Diameter of a drum's floor, which follows from its outside and the depth of its track; origin: of the part, on paper."""
        right = origin + self.page.scale * self.drawn.part.thickness
        half = 1j * self.page.scale * drum.floor
        away = complex(self.page.inner + BOSS)
        self.page.dimension(
            right - half, right + half, away, Measure(2 * drum.floor, f"{REFERENCE}Ø")
        )

    def _thread(self, origin: complex, tap: Tap) -> None:
        """A thread in its section: its core is cut out of that, its diameter a thin line on either side [ISO 6410-1]; its axis up to
        the dimension of its height; origin: of the part, on paper."""
        scale = self.page.scale
        half = SCREWS[tap.thread].nominal / 2
        ends = [origin + scale * (tap.height + 1j * y) for y in (tap.inner, tap.outer)]
        for side in (-half, half):
            self.page.sheet.line(*(end + scale * side for end in ends), layer="DIM")
        top = complex(ends[0].real, self.page.paper(self.drawn.high).imag)
        self.page.sheet.line(ends[0] - 2j, top, layer="CENTER")
        tip = ends[1]  # the mouth of the thread, on its axis
        bend = tip + complex(5, 8)
        through = "through into the keyway"
        shelf = Text(0j, through, 2.5).room + 1
        self.page.sheet.line(tip, bend, bend + shelf, layer="DIM")
        self.page.sheet.arrow(tip, (tip - bend) / abs(tip - bend))
        self.page.sheet.text(bend + complex(0.5, 0.8), f"{tap.thread}-{_THREAD}")
        self.page.sheet.text(bend + complex(0.5, -3.3), through)

    def _boss_sizes(self, origin: complex) -> None:
        """Diameters of the bosses, or of a pin's shank, to the right of the view from the left."""
        right = origin + self.page.scale * self.drawn.part.thickness
        shank, fit = self.drawn.facts.shank
        for k, radius in enumerate(self.drawn.bosses, 1):
            half = 1j * self.page.scale * radius
            away = complex(self.page.inner + BOSS * k)
            pressed = fit and abs(2 * radius - shank) < SAME_POINT
            measure = Measure(2 * radius, "Ø", in_limits(fit, shank) if pressed else "")
            self.page.dimension(right - half, right + half, away, measure)
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
            if self.drawn.seat:  # whose detail has z upwards
                edge = top + self.page.scale * self.drawn.low.real
                self.page.sheet.text(edge - 1.5 - 1.25j, "z 0", 2.5, "right")

    def run_out(self) -> None:
        """Run-out of a cam's face at z = 0, of a drum of both ends and of its outside too; of faces and rim of what is round, and of a
        wheel with slots."""
        facts = self.drawn.facts
        if self.drawn.faces_run:
            self._run_out_of_face(-1)
            self._run_out_of_face(1)
        if self.drawn.rim_runs:
            top = self.page.paper(self.drawn.high).imag
            middle = self.page.side_x + self.page.scale * self.drawn.part.thickness / 2
            self._run_out_over(complex(middle, top))
        if not (
            facts.run_out and self.drawn.part.bore and self.drawn.turns and self.drawn.datum_letter
        ):
            return
        self._run_out_of_face(-1)
        if self.drawn.drum:
            self._run_out_of_face(1)
            self._run_out_of_outside(self.drawn.drum)

    def _run_out_of_face(self, side: int) -> None:
        """That of the face at z = 0, side -1, or of the other end: beside it in the view from the left, where paper is free."""
        import shapely

        facts = self.drawn.facts
        layers = self.drawn.part.layers
        lowest = min(layers, key=lambda layer: layer.z0)
        face = lowest if side < 0 else max(layers, key=lambda layer: layer.z1)
        low, high = extent([fit_arcs(face.region.outer, self.drawn.tolerance)])
        bore = max((abs(z.imag) for z in extent(self.drawn.holes)), default=0.0)
        levels = np.linspace(high.imag, low.imag, 32)[1:-1]
        levels = levels[np.abs(levels) > bore]
        wide = width_of([number(facts.run_out), self.drawn.datum_letter])
        edge = self.page.side_x + self.page.scale * self.drawn.part.thickness * (side > 0)
        near = edge - 5 - wide if side < 0 else edge + 5
        places = near + 1j * (self.page.datum.imag + self.page.scale * levels - FRAME / 2)
        x = places.real
        y = places.imag
        boxes = shapely.box(
            x - 4 + 3 * (side < 0), y - 1, x + wide + 1 + 3 * (side < 0), y + FRAME + 1
        )
        obstacles = Obstacles()
        obstacles.add(self.page.sheet.primitives)
        met = obstacles.crossed(boxes) + 100 * ~obstacles.free(boxes) + ~obstacles.off_axes(boxes)
        corner = complex(places[int(np.argmin(met))])
        end = run_out(self.page.sheet, corner, facts.run_out, self.drawn.datum_letter)
        start = (end if side < 0 else corner) + 1j * FRAME / 2
        tip = complex(edge, start.imag)
        self.page.sheet.line(start, tip, layer="DIM")
        self.page.sheet.arrow(tip, -side)

    def _run_out_of_outside(self, drum: Drum) -> None:
        """That of a drum's outside, over its section where that has the most of it."""
        top = np.array([math.pi / 2])
        levels = [wall.over(top, np.array([drum.outside])).z.item() for wall in drum.walls]
        spans = {
            "groove": [(0.0, levels[0]), (levels[-1], drum.length)],
            "rib": [(levels[0], levels[-1])],
            "end": [(0.0, levels[0])],
        }[drum.track]
        low, high = max(spans, key=lambda span: span[1] - span[0])
        x = self.page.side_x + self.page.scale * (low + high) / 2
        self._run_out_over(complex(x, self.page.paper(self.drawn.high).imag))

    def _run_out_over(self, tip: complex) -> None:
        """That of a round outside, over its upper edge in the view from the left; tip: there, on paper."""
        facts = self.drawn.facts
        wide = width_of([number(facts.run_out), self.drawn.datum_letter])
        start = tip + 1j * _OVER_OUTSIDE
        run_out(self.page.sheet, start - wide / 2, facts.run_out, self.drawn.datum_letter)
        self.page.sheet.line(start, tip, layer="DIM")
        self.page.sheet.arrow(tip, -1j)
