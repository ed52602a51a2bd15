"""The view of a part along z, with its sizes, datums and names of holes. Coordinates: mm of paper."""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass, replace

import numpy as np

from camgen.files import views
from camgen.files.bore_detail import over_flat
from camgen.files.dimensions import Hole, flat_of, flatted, free, nearest_and_farthest, number
from camgen.files.drawn_part import DrawnPart
from camgen.files.geneva_view import PAST_SLOT
from camgen.files.labels import Label, Obstacles, along, callouts, leader, upper_mark
from camgen.files.limits import in_limits
from camgen.files.measures import REFERENCE, Measure
from camgen.files.page import BESIDE_CASE, FILING, MARGIN, Page
from camgen.files.symbols import FRAME, all_round, datum, line_profile, roughness
from camgen.files.title_block import Rider
from camgen.geometry.arcs import as_circle, fit_arcs
from camgen.geometry.outlines import Contour, Floats
from camgen.numerics import coordinates
from camgen.tolerances import SAME_POINT

_GAP = 24.0  # to overall sizes
_OF_TABLE = 2  # decimals of overall sizes that follow from a table's places and radii
_ASIDE = 0.6  # rad, of a leader from the lines of overall sizes
# where the sense of turning goes, the best first: dimensions are below and to the left
_ARROWS = np.radians([45, 135, -45, -135, 65, 25, 115, 155, -25, -65, -115, -155, 90, 0, -90, 180])
_CASE_FINE = 0.02  # mm of paper, of what shows a case
_FACE_SHOWN = 12.0  # half of what is shown of a flat follower, mm of paper
# from the upper edge of the room over the view down, of the frame of a track's tolerance
_OVER = 8.0


@dataclass(frozen=True)
class PlanView:
    """A part as its layers lie, in its place on the sheet."""

    drawn: DrawnPart
    page: Page

    def draw(self) -> None:
        """Outlines, axes, followers, overall sizes and radii."""
        sheet = self.page.sheet
        scale = self.page.scale

        def put(contour: Contour, layer: str) -> None:
            sheet.contour(contour.moved(scale, self.page.datum), layer)

        for contour in (self.drawn.outer, *self.drawn.holes):
            put(contour, "CUT")
        for contour in self.drawn.above:
            put(contour, "VIEW")
        for contour in self.drawn.hidden:
            put(contour, "HIDDEN")
        for contour in self.drawn.engraved:
            put(contour, "TEXT")
        self._cases()
        self._centre_lines()
        for rider in self.drawn.riders:
            self._rider(rider)
        low = self.page.paper(self.drawn.low)
        high = self.page.paper(self.drawn.high)
        span = self.drawn.high - self.drawn.low
        # the extension lines start at the box: the points where it touches the outline are not all on one side
        shaft = flatted(self.drawn.part.region.outer)
        diameters = [
            2 * each for each in (self.drawn.disc, shaft[1] if shaft else None) if each
        ]  # diameters
        tabled = self.drawn.rounded
        follows = free(self.drawn.part.region.outer) or self.drawn.slotted or tabled
        other = REFERENCE if follows else ""
        digits = _OF_TABLE if tabled else None
        signs = (
            "Ø" if any(abs(size - each) < SAME_POINT for each in diameters) else other
            for size in (span.real, span.imag)
        )
        wide, tall = signs
        one = flat_of(self.drawn.part.region.outer) if shaft else None
        flat = over_flat(self.drawn.facts, shaft[1], one[1], shaft=True) if shaft and one else ""
        outer_fit = self.drawn.outer_fit or self.drawn.facts.ring_fit
        round_fit = in_limits(outer_fit, span.real) if outer_fit else ""
        fit = round_fit if wide == "Ø" else flat
        self.page.dimension(
            low,
            complex(high.real, low.imag),
            -1j * _GAP,
            Measure(span.real, wide, fit, digits=digits),
        )
        if self.drawn.rim_letter:
            plate = self.drawn.facts.levels
            middle = (2 * self.drawn.low.real + self.drawn.high.real) / 3 if plate else 0.0
            foot = self.page.paper(complex(middle, self.drawn.low.imag)) - 1j * _GAP * (not plate)
            datum(self.page.sheet, foot, -1j, self.drawn.rim_letter)
        if self.drawn.disc is None:
            aside = -_GAP + 0j
            fit = "" if tall else flat
            ends = low, complex(low.real, high.imag)
            self.page.dimension(*ends, aside, Measure(span.imag, tall, fit, digits=digits))
        self._radii()
        if self.drawn.section:
            y = self.drawn.section.y
            ends = complex(self.drawn.low.real, y), complex(self.drawn.high.real, y)
            self._plane(ends, -1j)
            if abs(y) > SAME_POINT:
                a, b = map(self.page.paper, ends)
                self.page.sheet.line(a - 4, b + 4, layer="CENTER")
        if self.drawn.upright:
            self._plane((1j * self.drawn.low.imag, 1j * self.drawn.high.imag), 1)

    def _plane(self, ends: tuple[complex, complex], view: complex) -> None:
        """Where a section is cut, from end to end of the part, mm, and the direction of view on the sheet."""
        along = (ends[1] - ends[0]) / abs(ends[1] - ends[0])
        for place, out in ((ends[0], -along), (ends[1], along)):
            near = self.page.paper(place) + 4 * out
            if self.drawn.turns and (out.real + out.imag) > 0:  # past the name of an axis
                near += (5 + self.page.scale * self.drawn.rise * out.imag) * out
            elif out == 1j and self.drawn.slotted:  # past the width of a slot
                near += PAST_SLOT * out
            end = near + 6 * out
            self.page.sheet.line(near, end, layer="VIEW")
            self.page.sheet.line(end, end + 5 * view, layer="DIM")
            self.page.sheet.arrow(end + 5 * view, view)
            aside = 1.2j if view.imag else complex(-2.8, -1.75)
            self.page.sheet.text(end + aside, self.drawn.letter, 3.5, "centre")

    def hole_datums(self) -> None:
        """Datums that are holes: that of a track's angle, and the one that others are placed from, unless a bore's detail has it."""
        if self.drawn.angle_hole is not None:
            self._hole_datum(self.drawn.angle_hole, self.drawn.angle_letter)
        if self.drawn.placed and (
            self.drawn.bored is None or self.drawn.origin != self.drawn.datum_letter
        ):
            for hole in [hole for _, hole in self.drawn.named if hole.place == self.drawn.zero][:1]:
                self._hole_datum(hole, self.drawn.origin)
        elif self.drawn.rim_runs and self.drawn.bored is None:
            about_axis = dict(self.drawn.named)[self.drawn.axis_label]
            self._hole_datum(about_axis, self.drawn.datum_letter)

    def _hole_datum(self, hole: Hole, letter: str) -> None:
        """A datum at the edge of its hole, where paper is free."""
        import shapely

        ways = np.exp(0.25j * math.pi * np.arange(8))
        tips = self.page.paper(hole.place) + self.page.scale * hole.radius * ways
        ends = tips + 7.5 * ways  # middles of the letter's box
        boxes = shapely.box(ends.real - 3, ends.imag - 3, ends.real + 3, ends.imag + 3)
        obstacles = Obstacles()
        obstacles.add(self.page.sheet.primitives)
        met = obstacles.crossed(boxes) + 100 * ~obstacles.free(boxes) + ~obstacles.off_axes(boxes)
        k = int(np.argmin(met))
        datum(self.page.sheet, complex(tips[k]), complex(ways[k]), letter)

    def upper_side(self) -> None:
        """UP, where whoever makes the part is to mark its upper side."""
        if self.drawn.part.to_mark:
            import shapely

            area = views.area(self.drawn.part.region, self.drawn.tolerance)
            origin = np.array([self.page.datum.real, self.page.datum.imag])
            face = shapely.transform(area, lambda points: self.page.scale * points + origin)
            mark = upper_mark(self.page.sheet, face, self.page.datum)
            self.page.sheet.things += [mark] if mark else []

    def labels(self, foot: float) -> None:
        """Names of holes and of what stands on the part, where paper is free, some with leaders; foot: height of what is below the views."""
        labels = [
            self._named(label, hole)
            for label, hole in (*self.drawn.named, *self.drawn.standing.values())
        ]
        area = (
            complex(FILING + 1, MARGIN + foot),
            complex(self.page.table_x - 1, self.page.sheet.height - MARGIN - 1),
        )
        for each in callouts(labels, self.page.sheet, area):
            self.page.sheet.things += each.things

    def _named(self, label: str, hole: Hole) -> Label:
        """A label with its hole on paper."""
        rim = along([self.drawn.rims[hole].moved(self.page.scale, self.page.datum)])
        return Label(
            label,
            replace(
                hole, middle=self.page.paper(hole.middle), radius=self.page.scale * hole.radius
            ),
            rim,
        )

    def _centre_lines(self) -> None:
        """Axes through the zero point across the whole part, crosses on round holes and other centres."""
        sheet = self.page.sheet
        over = 4.0
        zero = self.drawn.zero
        low = self.page.paper(self.drawn.low)
        high = self.page.paper(self.drawn.high)
        axes = (
            self.drawn.low.real <= zero.real <= self.drawn.high.real
            and self.drawn.low.imag <= zero.imag <= self.drawn.high.imag
        )
        if axes:
            x = self.page.paper(zero).real
            y = self.page.paper(zero).imag
            right = complex(high.real + over, y)
            top = complex(x, high.imag + over + self.page.scale * self.drawn.rise)
            sheet.line(complex(low.real - over, y), right, layer="CENTER")
            sheet.line(complex(x, low.imag - over), top, layer="CENTER")
            for end, way, name in ((right, 1, "X"), (top, 1j, "Y")) if self.drawn.turns else ():
                sheet.arrow(end + 3 * way, way)
                sheet.text(end + 1.5 + (1.5 if way == 1j else 1.5j), name, 2.5)
        radii = dict.fromkeys(self.drawn.part.centres, 1.0)
        circles = [
            as_circle(contour)
            for contour in (self.drawn.part.region.outer, *self.drawn.part.region.holes)
        ]
        radii |= {
            circle[0]: min(circle[1], 5 / self.page.scale + 1) for circle in circles if circle
        }
        for centre, radius in radii.items():
            if axes and abs(centre - zero) < 1e-9:
                continue
            at = self.page.paper(centre)
            reach = self.page.scale * radius + 2
            for direction in (1, 1j):
                sheet.line(at - reach * direction, at + reach * direction, layer="CENTER")

    def _cases(self) -> None:
        """Thick chain lines beside contours that are case hardened, outside the material.

        [blickinsbuch.westermann.de/978-3-7100-2824-3/160, 7.3.4.3: some 2 mm outside what is treated; ISO 15787]
        """
        import shapely

        for contour in self.drawn.cased:
            ring = along([fit_arcs(contour, self.drawn.tolerance)]) * self.page.scale
            way = 1 if contour is self.drawn.part.region.outer else -1
            line = shapely.Polygon(coordinates(ring)).buffer(way * BESIDE_CASE).exterior
            x, y = shapely.simplify(line, _CASE_FINE).coords.xy
            points = self.page.datum + np.array(x) + 1j * np.array(y)
            self.page.sheet.line(*points[:-1].tolist(), layer="CASE", closed=True)

    def _rider(self, rider: Rider) -> None:
        """A follower where the cam has not turned, dashed, and beside it the way in which its displacement s grows."""
        sheet = self.page.sheet
        centre = self.page.paper(rider.centre)
        radius = self.page.scale * rider.tip
        if math.isinf(rider.radius):
            along = 1j * rider.normal * _FACE_SHOWN
            sheet.line(centre - along, centre + along, layer="HIDDEN")
            radius = _FACE_SHOWN
        elif radius:
            sheet.arc(centre, radius, 0.0, math.tau, "HIDDEN")
            for way in (rider.way, 1j * rider.way):
                sheet.line(centre - (radius + 2) * way, centre + (radius + 2) * way, layer="CENTER")
        side = 1j * rider.way
        tip = centre + (radius + 5) * side + 6 * rider.way
        sheet.line(tip - 10 * rider.way, tip, layer="DIM")
        sheet.arrow(tip, rider.way)
        sheet.text(tip + 2.5 * side - 1.2j, "s", 3.5, "centre")

    def _radii(self) -> None:
        """Least and greatest distance of a curve from the datum, or the diameter of a circle."""
        circle = as_circle(self.drawn.outer)
        disc = self.drawn.disc
        shown = disc is not None and circle and abs(circle[1] - disc) < SAME_POINT
        if circle and not shown and not self.drawn.shank:
            centre, radius = circle
            aside = cmath.exp(0.25j * math.pi)
            self._leader(centre + radius * aside, aside, f"Ø{number(2 * radius)}")
        if free(self.drawn.part.region.outer) and not (self.drawn.facts.levels or self.drawn.lock):
            ends = nearest_and_farthest(self.drawn.outer)
            ways = [(z / abs(z) if z else 1) for z in ends]
            inner = "base" if self.drawn.facts.tracks else "inner"
            for point, way, word in zip(ends, ways, (inner, "outer"), strict=True):
                self._leader(point, way, f"{word} circle (R{number(abs(point))})")

    def _leader(self, point: complex, direction: complex, text: str) -> None:
        """Arrow from outside onto a point of the outline, with the text along it, aside from the overall sizes."""
        for size in (-1, -1j):
            aside = cmath.phase(direction / size)
            if abs(aside) < _ASIDE:
                direction = size * cmath.rect(1, math.copysign(_ASIDE, aside))

        def clear(way: complex) -> float:
            """Past what a flange shows, mm of paper."""
            beyond = (
                along(self.drawn.above) - point if self.drawn.above else np.zeros(1)
            ) * way.conjugate()
            return self.page.scale * max(0.0, float(np.max(beyond.real)))

        self.page.sheet.things += leader(
            self.page.sheet, self.page.paper(point), direction, clear, text
        )

    def turning(self) -> None:
        """Arc with an arrow outside the part: the positive sense, counter-clockwise, where paper is free, on a diagonal if it can."""
        import shapely

        ring = along([self.drawn.outer, *self.drawn.above])
        places = []
        strips = []
        for angle in _ARROWS.tolist():
            near: Floats = np.abs(np.angle(ring * cmath.exp(-1j * angle)))
            reach = float(np.max(np.abs(ring)[near < 0.5], initial=float(np.min(np.abs(ring)))))
            radius = self.page.scale * reach + 5
            half = min(0.4, 9 / radius)
            turned = angle + np.linspace(-half, half + 5 / radius, 9)  # with room for the sign
            arc = self.page.datum + radius * np.exp(1j * turned)
            places.append((angle, radius, half))
            strips.append(shapely.buffer(shapely.linestrings(coordinates(arc)), 2.0))
        right = complex(self.page.table_x, self.page.sheet.height - MARGIN)
        obstacles = Obstacles((complex(FILING, MARGIN), right))
        obstacles.add(self.page.sheet.primitives)
        taken = ~obstacles.free(strips) | ~obstacles.within(strips)
        k = int(np.argmin(100 * taken + obstacles.crossed(strips) + ~obstacles.off_axes(strips)))
        angle, radius, half = places[k]
        self.page.sheet.arc(self.page.datum, radius, angle - half, 2 * half, "TEXT")
        tip = self.page.datum + cmath.rect(radius, angle + half)
        self.page.sheet.arrow(tip, 1j * cmath.exp(1j * (angle + half - 1.5 / radius)), "TEXT")
        sign = tip + 2.5j * cmath.exp(1j * (angle + half)) - 1.2j
        self.page.sheet.text(sign, "+", 3.5, "centre")

    def surface(self) -> None:
        """Tolerance and roughness of a cam's track: over the view, with a leader onto the track."""
        facts = self.drawn.facts
        if not self.drawn.surface:
            return
        datums = [letter for letter in (self.drawn.datum_letter, self.drawn.angle_letter) if letter]
        sheet = self.page.sheet
        middle = (self.drawn.low.real + self.drawn.high.real) / 2
        start = (
            self.page.paper(complex(middle, self.drawn.high.imag))
            + 4
            + 1j * (self.page.room_above - _OVER)
        )
        beside = [
            self.page.paper(each.centre).real + self.page.scale * each.tip
            for each in self.drawn.riders
        ]
        start = complex(max([start.real, *(x + 5 for x in beside)]), start.imag)
        track = next(
            each
            for each in (self.drawn.part.region.outer, *self.drawn.part.region.holes)
            if free(each)
        )
        ring = along([fit_arcs(track, self.drawn.tolerance)]) * self.page.scale + self.page.datum
        upper = ring[ring.imag > self.page.datum.imag]
        tip = complex(upper[int(np.argmin(np.abs(upper.real - start.real)))])
        sheet.line(tip, start, layer="DIM")
        sheet.arrow(tip, (tip - start) / abs(tip - start))
        wide = 0.0
        if facts.roughness:
            wide = roughness(sheet, start + 3, f"Ra {facts.roughness:g}") + 5
        sheet.line(start, start + wide + 2, layer="DIM")
        if not facts.levels:
            all_round(sheet, start)
        several = len(self.drawn.track_tables) > 1
        end = start + wide + 2
        if facts.profile:
            corner = end - 1j * FRAME / 2
            end = line_profile(sheet, corner, facts.profile, datums, several) + 1j * FRAME / 2
        if several:
            sheet.text(end + 2 - 1.2j, "each track", 2.5)
