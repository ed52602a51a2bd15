"""The sheet of a turned shaft: a view along it with its grooves and keyways, a section through a keyway, and what a workshop asks.

Lengths are measured from the end without the coupling, the left one. A keyway is seen from above.
"""

from __future__ import annotations

import math
from pathlib import Path

from camgen.files.dimensions import number
from camgen.files.measures import Measure, dimension
from camgen.files.page import FILING, MARGIN, SCALES, SIZES
from camgen.files.sheet import Sheet, write_dxf_sheet, write_pdf
from camgen.files.symbols import datum as datum_sign
from camgen.files.symbols import roughness, run_out, symmetry
from camgen.files.title_block import BLOCK, WIDTH, Facts, title_block
from camgen.files.views import area, hatching
from camgen.geometry.outlines import Arc, Contour, Line, Region
from camgen.parts.part import Part
from camgen.parts.turned_shafts import ShaftKeyway, TurnedShaft

_LEFT = 30.0  # of the view, for its diameter
_ROW = 8.0  # from one dimension under it to the next
_OVER = 40.0  # over it, for grooves and signs
_BESIDE = 44.0  # from the view to the section
_AFTER = 22.0  # right of that, for its depth
_NOTE = 4.5
_FINE = 0.01  # mm of paper, chord tolerance of what is hatched
_HATCH = 2.5  # mm of paper
_SEATS = "h6"
_BEYOND = 4.0  # centre lines, beyond what they cross


def write_shaft(folder: Path, name: str, shaft: TurnedShaft, facts: Facts) -> tuple[Path, Path]:
    """Write `<name>-shaft-drawing.dxf` and `.pdf` into folder; returns their paths."""
    page = _Page(shaft, facts)
    sheet = page.draw(f"Shaft ({name})")
    dxf = folder / f"{name}-shaft-drawing.dxf"
    pdf = folder / f"{name}-shaft-drawing.pdf"
    write_dxf_sheet(dxf, sheet, page.scale, page.datum)
    write_pdf(pdf, sheet)
    return dxf, pdf


class _Page:
    """The views of a shaft on paper."""

    def __init__(self, shaft: TurnedShaft, facts: Facts) -> None:
        self.shaft = shaft
        self.facts = facts
        rows = len(self._lengths()) + 1
        for self.size, (self.wide, self.high) in SIZES.items():
            room = self.wide - FILING - MARGIN - _LEFT - 12
            beside = _BESIDE + _AFTER if shaft.keyways else 0.0
            spare = self.high - 2 * MARGIN - BLOCK - _OVER - _ROW * rows - 6
            self.scale = next(
                each
                for each in SCALES
                if each * shaft.diameter <= spare
                and each * (shaft.length + (shaft.diameter if shaft.keyways else 0))
                <= room - beside
            )
            if self.scale >= 1:
                break
        y = self.high - MARGIN - _OVER - self.scale * shaft.diameter / 2
        self.datum = complex(FILING + _LEFT, y)

    def at(self, x: float, y: float = 0.0) -> complex:
        """A point of the view, mm from the left end and off the axis, on paper."""
        return self.datum + self.scale * complex(x, y)

    def draw(self, title: str) -> Sheet:
        """The whole sheet."""
        sheet = Sheet(self.wide, self.high, title)
        right = self.wide - MARGIN
        sheet.frame(FILING, MARGIN)
        self._outline(sheet)
        for keyway in self.shaft.keyways:
            self._keyway(sheet, keyway)
        self._sizes(sheet)
        self._grooves(sheet)
        self._surfaces(sheet)
        if self.shaft.keyways:
            self._section(sheet, self.shaft.keyways[0])
        notes = self._notes()
        for k, line in enumerate(reversed(notes)):
            at = complex(FILING + 3, MARGIN + 3 + _NOTE * k)
            sheet.text(at, line, 2.5, room=right - WIDTH - FILING - 5)
        part = Part("shaft", "Shaft", ())
        title_block(sheet, complex(right, MARGIN), part, self.facts, self.scale, self.size)
        return sheet

    def _outline(self, sheet: Sheet) -> None:
        """Both sides with their grooves, chamfers, walls of grooves, and the axis."""
        shaft = self.shaft
        radius = shaft.diameter / 2
        chamfer = self.facts.rod_chamfer
        end = shaft.length
        upper = [(0.0, radius - chamfer), (chamfer, radius)]
        walls = sorted((*wall, each) for each in shaft.grooves for wall in each.walls)
        for begin, stop, grooves in walls:
            floor = grooves.diameter / 2
            upper += [(begin, radius), (begin, floor), (stop, floor), (stop, radius)]
        upper += [(end - chamfer, radius), (end, radius - chamfer)]
        lower = [(x, -y) for x, y in reversed(upper)]
        sheet.line(*(self.at(*each) for each in (*upper, *lower)), layer="CUT", closed=True)
        edges = [(chamfer, radius), (end - chamfer, radius)] if chamfer else []
        edges += [(x, grooves.diameter / 2) for *wall, grooves in walls for x in wall]
        for x, y in edges:
            sheet.line(self.at(x, y), self.at(x, -y), layer="CUT")
        sheet.line(self.at(0) - _BEYOND, self.at(end) + _BEYOND, layer="CENTER")

    def _keyway(self, sheet: Sheet, keyway: ShaftKeyway) -> None:
        """A keyway from above."""
        half = keyway.width / 2
        first, last = complex(keyway.start + half), complex(keyway.end - half)
        side = 1j * half
        contour = Contour(
            (
                Line(first - side, last - side),
                Arc(last, half, -math.pi / 2, math.pi),
                Line(last + side, first + side),
                Arc(first, half, math.pi / 2, math.pi),
            )
        )
        sheet.contour(contour.moved(self.scale, self.datum), "CUT")

    def _lengths(self) -> list[tuple[float, float, Measure]]:
        """From where to where each length is measured, and what it says, the shortest first."""
        found = []
        for keyway in self.shaft.keyways:
            found.append((0.0, keyway.start, Measure(keyway.start)))
            found.append((keyway.start, keyway.end, Measure(keyway.length, fit="+0.2/0")))
        for each in self.shaft.grooves:
            found.append((0.0, each.start, Measure(each.start)))
            measure = Measure(each.apart, fit=f"+{each.wider:g}/0")
            found.append((each.start, each.start + each.apart, measure))
        return sorted(found, key=lambda each: (each[1], -each[0]))

    def _sizes(self, sheet: Sheet) -> None:
        """Lengths under the view, its diameter left of it."""
        radius = self.shaft.diameter / 2
        rows = [*self._lengths(), (0.0, self.shaft.length, Measure(self.shaft.length))]
        for k, (start, end, measure) in enumerate(rows, 1):
            ends = self.at(start, -radius), self.at(end, -radius)
            free = self.at(0).real if start else FILING + 1  # clear of the end's own line
            dimension(sheet, ends, -1j * (_ROW * k + 2), measure, self.facts.tolerance, free)
        ends = self.at(0, -radius), self.at(0, radius)
        across = Measure(self.shaft.diameter, "Ø", _SEATS)
        dimension(sheet, ends, complex(-14), across, self.facts.tolerance, FILING + 1)
        if self.facts.rod_chamfer:
            foot = self.at(self.shaft.length, radius)
            bend = foot + 6 + 8j
            sheet.line(foot, bend, bend + 4, layer="DIM")
            sheet.arrow(foot, (foot - bend) / abs(foot - bend))
            sheet.text(bend + 0.5 + 1j, f"2 × {number(self.facts.rod_chamfer)} × 45°", 2.5)

    def _grooves(self, sheet: Sheet) -> None:
        """What all grooves are, at the last one."""
        if not self.shaft.grooves:
            return
        grooves = max(self.shaft.grooves, key=lambda each: each.start)
        same = 2 * len(self.shaft.grooves)
        foot = self.at(grooves.walls[1][1] - grooves.width / 2, grooves.diameter / 2)
        bend = complex(foot.real + 4, self.at(0, self.shaft.diameter / 2).imag + 27)
        text = f"{same} × {number(grooves.width)} H13, Ø{number(grooves.diameter)} {grooves.fit}, DIN 471"
        sheet.line(foot, bend, bend + 4, layer="DIM")
        sheet.arrow(foot, (foot - bend) / abs(foot - bend))
        sheet.text(bend + 5 - 0.9j, text, 2.5)

    def _surfaces(self, sheet: Sheet) -> None:
        """Roughness of the seats, the datum of both bearings, and the run-out of what sits between."""
        shaft = self.shaft
        radius = shaft.diameter / 2
        for letter, start in zip("AB", shaft.seats, strict=True):
            foot = self.at(start + shaft.width / 2, radius)
            datum_sign(sheet, foot, 1j, letter)
        start, length = shaft.bores[0]
        foot = self.at(shaft.seats[1] + shaft.width, radius) + 4
        if self.facts.roughness:
            roughness(sheet, foot, f"Ra {number(self.facts.roughness)}")
        if self.facts.run_out:
            tip = self.at(start + 0.8 * length, radius)
            bend = tip + 20j
            sheet.line(tip, bend, bend + 2, layer="DIM")
            sheet.arrow(tip, -1j)
            run_out(sheet, bend + 2 - 3j, self.facts.run_out, "A-B")

    def _section(self, sheet: Sheet, keyway: ShaftKeyway) -> None:
        """A section through a keyway, right of the view, the keyway on its right."""
        shaft = self.shaft
        radius = shaft.diameter / 2
        half = keyway.width / 2
        floor = radius - (keyway.depth or keyway.width / 2)
        angle = math.asin(half / radius)
        edge = math.sqrt(radius**2 - half**2)
        middle = self.at(shaft.length) + _BESIDE + self.scale * radius
        contour = Contour(
            (
                Arc(0j, radius, angle, math.tau - 2 * angle),
                Line(complex(edge, -half), complex(floor, -half)),
                Line(complex(floor, -half), complex(floor, half)),
                Line(complex(floor, half), complex(edge, half)),
            )
        ).moved(self.scale, middle)
        sheet.contour(contour, "CUT")
        for a, b in hatching(area(Region(contour), _FINE), _HATCH):
            sheet.line(a, b, layer="HATCH")
        reach = self.scale * radius + _BEYOND
        for way in (reach, 1j * reach):
            sheet.line(middle - way, middle + way, layer="CENTER")
        corners = [middle + self.scale * complex(edge, y) for y in (-half, half)]
        dimension(
            sheet,
            (corners[0], corners[1]),
            complex(self.scale * (radius - edge) + 10),
            Measure(keyway.width, fit=keyway.fit),
            self.facts.tolerance,
        )
        if keyway.depth:
            ends = middle - self.scale * radius, middle + self.scale * complex(floor, -half)
            measure = Measure(shaft.diameter - keyway.depth, fit=f"0/-{keyway.deeper:g}")
            lower = complex(ends[0].real, ends[1].imag)
            away = -1j * (self.scale * (radius - half) + 8)
            dimension(sheet, (lower, ends[1]), away, measure, self.facts.tolerance)
        if self.facts.symmetry:
            corner = middle + complex(-22, self.scale * radius + 8)
            symmetry(sheet, corner, self.facts.symmetry, "A-B")
        cut = self.at((keyway.start + keyway.end) / 2, radius)
        for y, way in ((cut.imag + 3, 1), (self.at(0, -radius).imag - 3, -1)):
            tip = complex(cut.real, y)
            sheet.line(tip, tip + 3j * way, layer="VIEW")
        sheet.text(complex(cut.real - 1.5, cut.imag + 3), "C", 3.5, "right")
        sheet.text(middle + 1j * (self.scale * radius + 17), "C-C", 5.0, "centre")

    def _notes(self) -> list[str]:
        """What the views do not say."""
        shaft = self.shaft
        first, second = (f"{x:.4g} to {x + shaft.width:.4g}" for x in shaft.seats)
        facts = self.facts
        return [
            f"Ø{number(shaft.diameter)} {_SEATS} all along, but for its grooves and keyways.",
            *(f"Bore of what it turns: {a:.4g} to {a + length:.4g}." for a, length in shaft.bores),
            f"Seats of bearings {shaft.bearing}: A {first}, B {second}.",
            f"End for the coupling: the last {shaft.length - shaft.seats[1] - shaft.width:.4g} mm.",
            f"Elsewhere Ra {number(facts.roughness_elsewhere)}.",
            "Centre holes ISO 6411 allowed at both ends.",
            f"Edges {facts.edges}.",
        ]
