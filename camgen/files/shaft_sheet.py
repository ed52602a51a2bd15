"""The sheet of a turned shaft: a view along it with its grooves and keyways, a section through a keyway, and what a workshop asks.

Lengths are measured from the end without the coupling, of a rod the lower one, which is on the left. A keyway is seen from above; the section is turned until it has that on top, as the files of a rod do.
"""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

from camgen.files.dimensions import number
from camgen.files.limits import in_limits
from camgen.files.measures import Box, Measure, Room, dimension
from camgen.files.notes import wrapped
from camgen.files.page import FILING, MARGIN, SCALES, SIZES
from camgen.files.sheet import Sheet, Text, write_dxf_sheet, write_pdf
from camgen.files.symbols import datum as datum_sign
from camgen.files.symbols import roughness, run_out, symmetry, width_of
from camgen.files.title_block import BLOCK, WIDTH, Facts, title_block
from camgen.files.views import area, hatching
from camgen.geometry.outlines import Arc, Contour, Line, Piece, Region
from camgen.parts.part import Part, SizeNote, keyed_bore
from camgen.parts.turned_shafts import ShaftKeyway, TurnedShaft
from camgen.tolerances import SAME_POINT

_LEFT = 30.0  # of the view, for its diameter
_ROW = 7.0  # from one dimension under it to the next
_OVER = 40.0  # over it, for grooves and signs
_BESIDE = 44.0  # from the view to the section
_AFTER = 22.0  # right of that, for what its keyway leaves
_NOTE = 4.5
_FINE = 0.01  # mm of paper, chord tolerance of what is hatched
_HATCH = 2.5  # mm of paper
_BEYOND = 4.0  # centre lines, beyond what they cross
_DATUM = 12.0  # more under the view, where a datum hangs at its diameter
_SHAFT = Part("shaft", "Shaft", ())  # one that is no part of a machine
_CUT = 4.0  # arrow where the section is
_RA = 4.0  # from the end of a shaft to the sign of its roughness
_SIGN = 3.0  # half the width of that


def write_shaft(
    folder: Path, name: str, shaft: TurnedShaft, facts: Facts, part: Part = _SHAFT
) -> list[Path]:
    """Write `<name>-<part>-drawing.dxf` and `.pdf` into folder; returns their paths."""
    stem = f"{name}-{part.name}"
    page = _Page(shaft, replace(facts, number=facts.number or f"{stem}-drawing"), part)
    sheet = page.draw(f"{part.title} ({stem})")
    dxf = folder / f"{stem}-drawing.dxf"
    pdf = folder / f"{stem}-drawing.pdf"
    write_dxf_sheet(dxf, sheet, page.scale, page.middle if shaft.keyways else page.datum)
    write_pdf(pdf, sheet)
    return [dxf, pdf]


class _Page:
    """The views of a shaft on paper."""

    def __init__(self, shaft: TurnedShaft, facts: Facts, part: Part) -> None:
        self.shaft = shaft
        self.facts = facts
        self.part = part
        self.axis = "A-B" if shaft.bearings else facts.datum_letters[0]  # the datum
        self.fit = in_limits(shaft.fit, shaft.diameter)
        across = Text(0j, f"Ø{number(shaft.diameter)} {self.fit}", 3.5)
        self.over = max(_OVER, across.room + 6)  # which reads upwards
        self.low = 0.0 if shaft.bearings else _DATUM
        self.notes = [line for note in self._notes() for line in wrapped(note)]
        rows = len(self._lengths()) + 1
        foot = max(BLOCK, 6 + _NOTE * len(self.notes))
        for self.size, (self.wide, self.high) in SIZES.items():
            room = self.wide - FILING - MARGIN - _LEFT - 12
            beside = _BESIDE + _AFTER if shaft.keyways else 0.0
            spare = self.high - 2 * MARGIN - foot - self.over - self.low - _ROW * rows - 6
            fitting = (
                each
                for each in SCALES
                if each * shaft.diameter <= spare
                and each * (shaft.length + (shaft.diameter if shaft.keyways else 0))
                <= room - beside
            )
            self.scale = next(fitting, SCALES[-1])
            if self.scale >= 1:
                break
        y = self.high - MARGIN - self.over - self.scale * shaft.diameter / 2
        self.datum = complex(FILING + _LEFT, y)

    @property
    def middle(self) -> complex:
        """Axis of the section, right of the view, on paper."""
        return self.at(self.shaft.length) + _BESIDE + self.scale * self.shaft.diameter / 2

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
        self._seats(sheet)
        self._surfaces(sheet)
        if self.shaft.keyways:
            self._section(sheet, self.shaft.keyways[0])
        for k, line in enumerate(reversed(self.notes)):
            at = complex(FILING + 3, MARGIN + 3 + _NOTE * k)
            sheet.text(at, line, 2.5, room=right - WIDTH - FILING - 5)
        title_block(sheet, complex(right, MARGIN), self.part, self.facts, self.scale, self.size)
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
        sheet.line(*(self.at(*each) for each in (*upper, *lower)), layer="VIEW", closed=True)
        edges = [(chamfer, radius), (end - chamfer, radius)] if chamfer else []
        edges += [(x, grooves.diameter / 2) for *wall, grooves in walls for x in wall]
        for x, y in edges:
            half = self._open_at(x)  # of a keyway that cuts the edge
            for side in (1, -1) if half else ():
                sheet.line(self.at(x, side * y), self.at(x, side * half), layer="VIEW")
            if not half:
                sheet.line(self.at(x, y), self.at(x, -y), layer="VIEW")
        sheet.line(self.at(0) - _BEYOND, self.at(end) + _BEYOND, layer="CENTER")

    def _open(self, keyway: ShaftKeyway) -> tuple[bool, bool]:
        """Whether a keyway is open at its lower and at its upper end."""
        return keyway.start < SAME_POINT, keyway.end > self.shaft.length - SAME_POINT

    def _open_at(self, x: float) -> float:
        """Half the width of a keyway that is open at an end, at x, mm; 0 elsewhere."""
        cut = (
            each.width / 2
            for each in self.shaft.keyways
            if any(self._open(each)) and each.start < x < each.end
        )
        return next(cut, 0.0)

    def _keyway(self, sheet: Sheet, keyway: ShaftKeyway) -> None:
        """A keyway from above, with the round ends that a cutter leaves."""
        half = keyway.width / 2
        side = 1j * half
        at_start, at_end = self._open(keyway)
        first = complex(keyway.start + half * (not at_start))
        last = complex(keyway.end - half * (not at_end))
        right: Piece = Arc(last, half, -math.pi / 2, math.pi)
        left: Piece = Arc(first, half, math.pi / 2, math.pi)
        if at_end:  # on the line of the end
            right = Line(last - side, last + side)
        if at_start:
            left = Line(first + side, first - side)
        contour = Contour(
            (Line(first - side, last - side), right, Line(last + side, first + side), left)
        )
        sheet.contour(contour.moved(self.scale, self.datum), "VIEW")

    def _lengths(self) -> list[tuple[float, float, Measure]]:
        """From where to where each length is measured, and what it says, the shortest first."""
        found = []
        for keyway in self.shaft.keyways:
            ends = self._open(keyway)
            if ends[1] and not ends[0]:  # from the end from which all lengths are
                found.append((0.0, keyway.start, Measure(keyway.start, fit="0/-0.2")))
                continue
            if not any(ends):
                found.append((0.0, keyway.start, Measure(keyway.start)))
            if not all(ends):
                found.append((keyway.start, keyway.end, Measure(keyway.length, fit="+0.2/0")))
        for each in self.shaft.grooves:
            found.append((0.0, each.start, Measure(each.start)))
            measure = Measure(each.apart, fit=f"+{each.wider:g}/0")
            found.append((each.start, each.start + each.apart, measure))
        return sorted(found, key=lambda each: (each[1], -each[0]))

    def _beside(self, length: tuple[float, float, Measure]) -> bool:
        """Whether what a length says stands beside its line, where those of others above it would cross it."""
        start, end, measure = length
        said = Text(0j, f"{number(measure.value)}{measure.behind}", 3.5)
        return start > 0 and self.scale * (end - start) < said.width + 7

    def _sizes(self, sheet: Sheet) -> None:
        """Lengths under the view, its diameter left of it."""
        radius = self.shaft.diameter / 2
        rows = [
            *sorted(self._lengths(), key=self._beside),
            (0.0, self.shaft.length, Measure(self.shaft.length, fit=self.facts.length_limits)),
        ]
        texts: list[Box] = []
        for k, (start, end, measure) in enumerate(rows, 1):
            ends = self.at(start, -radius), self.at(end, -radius)
            free = self.at(0).real if start else FILING + 1  # clear of the end's own line
            away = -1j * (_ROW * k + 2 + self.low)
            room = Room(free, tuple(texts))
            texts.append(dimension(sheet, ends, away, measure, self.facts.tolerance, room))
        ends = self.at(0, -radius), self.at(0, radius)
        diameter = self.shaft.diameter
        across = Measure(diameter, "Ø", self.fit)
        dimension(sheet, ends, complex(-14), across, self.facts.tolerance, Room(FILING + 1))
        if not self.shaft.bearings:
            tail = 6j * (self.scale * diameter < 12)  # of an arrow outside
            datum_sign(sheet, ends[0] - 14 - tail, -1j, self.axis)
        if self.facts.rod_chamfer:
            foot = self.at(self.shaft.length, -radius)
            bend = foot + 6 - 8j
            sheet.line(foot, bend, bend + 4, layer="DIM")
            sheet.arrow(foot, (foot - bend) / abs(foot - bend))
            sheet.text(bend + 5 - 0.9j, f"2 × {number(self.facts.rod_chamfer)} × 45°", 2.5)

    def _grooves(self, sheet: Sheet) -> None:
        """What all grooves are, at the last one."""
        if not self.shaft.grooves:
            return
        grooves = max(self.shaft.grooves, key=lambda each: each.start)
        same = 2 * len(self.shaft.grooves)
        foot = self.at(grooves.walls[1][1] - grooves.width / 2, grooves.diameter / 2)
        text = f"{same} × {number(grooves.width)} H13, Ø{number(grooves.diameter)} {grooves.fit}, DIN 471"
        self._leader(sheet, foot, 27, text)

    def _seats(self, sheet: Sheet) -> None:
        """The fit under the bearings, at the second one, where it is not that of the whole shaft."""
        shaft = self.shaft
        if shaft.bearings is None or shaft.bearings.fit == shaft.fit:
            return
        foot = self.at(shaft.bearings.seats[1] + 0.9 * shaft.bearings.width, shaft.diameter / 2)
        fit = in_limits(shaft.bearings.fit, shaft.diameter)
        self._leader(sheet, foot, 34, f"Seats A and B Ø{number(shaft.diameter)} {fit}")

    def _leader(self, sheet: Sheet, foot: complex, over: float, text: str) -> None:
        """A text so far over the shaft, mm of paper, to the right of what it says something of."""
        bend = complex(foot.real + 4, self.at(0, self.shaft.diameter / 2).imag + over)
        sheet.line(foot, bend, bend + 4, layer="DIM")
        sheet.arrow(foot, (foot - bend) / abs(foot - bend))
        sheet.text(bend + 5 - 0.9j, text, 2.5)

    def _surfaces(self, sheet: Sheet) -> None:
        """Roughness of the shaft, and where bearings are the datum of both, the run-out of what sits between and of the end for the
        coupling."""
        shaft = self.shaft
        radius = shaft.diameter / 2
        fine = self.facts.roughness or self.facts.bore_roughness
        foot = self.at(self._bare, radius)
        if shaft.bearings:
            for letter, start in zip("AB", shaft.bearings.seats, strict=True):
                datum_sign(sheet, self.at(start + shaft.bearings.width / 2, radius), 1j, letter)
            end = self.at(shaft.length, radius)
            foot = end + _RA
            if fine:  # on a line that goes on from the shaft, where nothing else stands
                sheet.line(end, foot + _SIGN, layer="DIM")
        if fine:
            roughness(sheet, foot, f"Ra {number(fine)}")
        if not (shaft.bores and self.facts.run_out):
            return
        wide = width_of([number(self.facts.run_out), self.axis])
        self._run_out(sheet, self.at((shaft.coupled + shaft.length) / 2, radius), 1, wide)
        start, length = shaft.bores[0]
        tip = self.at(start + 0.8 * length, radius)
        bend = tip + 20j
        leader = max((self.at(each.walls[1][1]).real for each in shaft.grooves), default=0.0)
        crossed = tip.real - 2 < leader < bend.real + 4 + wide  # by what all grooves are
        self._run_out(sheet, tip, -1 if crossed else 1, wide)

    def _run_out(self, sheet: Sheet, tip: complex, side: int, wide: float) -> None:
        """The frame of a run-out over the shaft, left (-1) or right (1) of its leader; wide: the frame."""
        bend = tip + 20j
        sheet.line(tip, bend, bend + 2 * side, layer="DIM")
        sheet.arrow(tip, -1j)
        corner = bend + 2 * side - wide * (side < 0) - 3j
        run_out(sheet, corner, self.facts.run_out, self.axis)

    @property
    def _bare(self) -> float:
        """Middle of the longest stretch without a keyway, mm from the left end; of the shaft where there is none."""
        cuts = sorted((each.start, each.end) for each in self.shaft.keyways)
        ends = [0.0, *(x for cut in cuts for x in cut), self.shaft.length]
        spans = list(zip(ends[::2], ends[1::2], strict=True))
        low, high = max(spans, key=lambda span: span[1] - span[0])
        return (low + high) / 2

    def _section(self, sheet: Sheet, keyway: ShaftKeyway) -> None:
        """A section through a keyway, turned so that this is on top, and where it is."""
        shaft = self.shaft
        middle = self.middle
        radius = shaft.diameter / 2
        half = keyway.width / 2
        depth = keyway.depth or keyway.width / 2
        contour = keyed_bore(shaft.diameter, keyway.width, -depth).moved(self.scale, middle)
        sheet.contour(contour, "CUT")
        for a, b in hatching(area(Region(contour), _FINE), _HATCH):
            sheet.line(a, b, layer="HATCH")
        reach = self.scale * radius + _BEYOND
        for way in (reach, 1j * reach):
            sheet.line(middle - way, middle + way, layer="CENTER")
        edge = math.sqrt(radius**2 - half**2)
        corners = [middle + self.scale * complex(x, edge) for x in (-half, half)]
        away = 1j * (self.scale * (radius - edge) + 10)
        width = Measure(keyway.width, fit=in_limits(keyway.fit, keyway.width))
        dimension(sheet, (corners[0], corners[1]), away, width, self.facts.tolerance)
        symmetric = self.facts.symmetry or self.facts.own_key
        wide = width_of([number(symmetric), self.axis]) if symmetric else 0.0
        if keyway.depth:
            foot = middle - 1j * self.scale * radius
            top = middle + 1j * self.scale * (radius - depth)
            left = Measure(shaft.diameter - depth, fit=f"0/-{keyway.deeper:g}")
            aside = complex(max(self.scale * radius + 10, wide / 2 + 6))  # clear of the frame
            dimension(sheet, (foot, top), aside, left, self.facts.tolerance)
        if symmetric:
            corner = middle + complex(-wide / 2, self.scale * radius + 18)
            symmetry(sheet, corner, symmetric, self.axis)
        self._cut_line(sheet, keyway)
        title = middle + 1j * (self.scale * radius + 31)
        sheet.text(title, "C-C, turned 90°", 3.5, "centre")

    def _cut_line(self, sheet: Sheet, keyway: ShaftKeyway) -> None:
        """Where the section is, with the way in which it is seen."""
        radius = self.shaft.diameter / 2
        x = (keyway.start + keyway.end) / 2
        for y, way in ((self.at(x, radius) + 3j, 1j), (self.at(x, -radius) - 3j, -1j)):
            end = y + 3 * way
            sheet.line(y, end, end + _CUT, layer="VIEW")
            sheet.arrow(end + _CUT, 1)
            sheet.text(end - 1.5 - 1.7j, "C", 3.5, "right")

    def _notes(self) -> list[str]:
        """What the views do not say."""
        shaft = self.shaft
        facts = self.facts
        grooves = "grooves and keyways" if shaft.grooves else "keyways"
        seated = shaft.bearings is not None and shaft.bearings.fit != shaft.fit
        but = f"seats, {grooves}" if seated else grooves
        lines = [f"Ø{number(shaft.diameter)} {shaft.fit} but for {but}"]
        lines += [f"Bore of what it turns: {a:.4g} to {a + long:.4g}" for a, long in shaft.bores]
        if shaft.bearings:
            width = shaft.bearings.width
            first, second = (f"{x:.4g} to {x + width:.4g}" for x in shaft.bearings.seats)
            lines.append(f"Seats of {shaft.bearings.name}: A {first}, B {second}")
            lines.append(f"End for the coupling: the last {shaft.length - shaft.coupled:.4g} mm")
            lines.append("Centre holes ISO 6411 allowed at both ends")
        keys = [key for each in shaft.keyways for key in each.keys]
        ends = [f"{b:.4g}" if b < shaft.length else "the end" for _, b in keys]
        where = " and ".join(f"{a:.4g} to {end}" for (a, _), end in zip(keys, ends, strict=True))
        lines += [f"Key{'s' * (len(keys) > 1)} at {where} from the left"] if keys else []
        lines += ["Keyways' corners as DIN 6885"] if shaft.keyways else []
        lines.append(f"Elsewhere Ra {number(facts.roughness_elsewhere)}")
        lines.append(f"Edges {facts.edges}")
        own = [
            each for each in self.part.notes if not isinstance(each, SizeNote)
        ]  # as in the views
        lines += [facts.heat_treatment, facts.protection, *own]
        return [line[:1].upper() + line[1:] for line in lines if line]
