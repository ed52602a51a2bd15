"""A sheet of paper as data, and its two outputs: PDF at the printed size, DXF at the part's own size.

Coordinates are complex, mm of paper, from the sheet's lower left corner. The sheet consists of

    Stroke   lines and arcs end to end, open or closed (a closed one is a contour)
    Fill     a filled triangle (an arrowhead)
    Text     one line of text

each on a layer that decides its line. PDF text is set in Helvetica, which every PDF reader brings along.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from camgen.files.dxf import add_contour, document
from camgen.geometry.outlines import Arc, Contour, Line, Piece, end_point, start_point

if TYPE_CHECKING:
    from reportlab.pdfgen.canvas import Canvas

# Layer -> (colour index, line width in 1/100 mm). VIEW holds visible edges that are not cut, HIDDEN those behind material.
LAYERS = {
    "CUT": (7, 50),
    "VIEW": (8, 35),
    "HIDDEN": (8, 18),
    "CENTER": (1, 18),
    "DIM": (5, 18),
    "HATCH": (8, 13),
    "TEXT": (7, 25),
}
# Dashed layers: line type in a DXF, its pattern there and in a PDF, mm of paper.
_DASHES = {
    "CENTER": ("CENTER2", (), (6, 1.2, 0.8, 1.2)),
    "HIDDEN": ("HIDDEN2", (9.0, 6.0, -3.0), (3, 1.5)),
}
# What a character takes at most in CAD programs, by the height of capitals: of LibreCAD's standard font most letters and
# digits take 0.78, the space 0.75; the wide ones stand here.
CAD_ADVANCE = 0.8
_CAD_WIDE = (
    dict.fromkeys("4BDGHKNOPRSTUZ", 0.9)
    | dict.fromkeys("mwAMQVXY#&*Ø", 1.0)
    | dict.fromkeys("W%@_", 1.6)
)
_POINT = 72 / 25.4  # PDF units in a millimetre

# and the height of its capitals by the size [Adobe Core14 AFM]
_FONT = "Helvetica"
_CAP = 0.718
# How DXF readers write what their own fonts may lack.
_DXF_CODES = str.maketrans({"Ø": "%%c", "°": "%%d", "±": "%%p", "×": "x"})

Align = Literal["left", "centre", "right"]
_HALIGN: dict[Align, int] = {"left": 0, "centre": 1, "right": 2}  # in a DXF


@dataclass(frozen=True)
class Stroke:
    """Lines and arcs end to end."""

    pieces: tuple[Piece, ...]
    layer: str
    closed: bool = False


@dataclass(frozen=True)
class Fill:
    """A filled triangle."""

    corners: tuple[complex, complex, complex]
    layer: str


@dataclass(frozen=True)
class Text:
    """One line of text: `at` anchors its base line, `height` of capitals in mm, unit `direction` of reading."""

    at: complex
    text: str
    height: float
    align: Align = "left"
    direction: complex = 1
    layer: str = "TEXT"

    @property
    def width(self) -> float:
        """Length in Helvetica, mm."""
        from reportlab.pdfbase.pdfmetrics import stringWidth

        return float(stringWidth(self.text, _FONT, self.height / _CAP))

    @property
    def room(self) -> float:
        """Length that it may take in a PDF reader or in a CAD program, whose font is its own, mm."""
        return max(self.width, self.height * sum(_CAD_WIDE.get(c, CAD_ADVANCE) for c in self.text))


def arrowhead(tip: complex, direction: complex, layer: str) -> Fill:
    """An arrowhead of 3 mm whose tip points along the unit direction."""
    foot = tip - 3 * direction
    return Fill((tip, foot + 0.5j * direction, foot - 0.5j * direction), layer)


@dataclass
class Sheet:
    """Paper of width x height mm; drawn things in order."""

    width: float
    height: float
    title: str
    things: list[Stroke | Fill | Text] = field(default_factory=list)

    def line(self, *points: complex, layer: str, closed: bool = False) -> None:
        """Add straight strokes through the points."""
        ends = [*points[1:], points[0]] if closed else points[1:]
        pieces = tuple(Line(complex(a), complex(b)) for a, b in zip(points, ends, strict=False))
        self.things.append(Stroke(pieces, layer, closed))

    def contour(self, contour: Contour, layer: str) -> None:
        """Add a closed contour of lines and arcs."""
        self.things.append(Stroke(contour.pieces, layer, True))

    def arc(self, centre: complex, radius: float, start: float, sweep: float, layer: str) -> None:
        """Add an arc, angles in rad."""
        self.things.append(Stroke((Arc(complex(centre), radius, start, sweep),), layer))

    def arrow(self, tip: complex, direction: complex, layer: str = "DIM") -> None:
        """Add an arrowhead of 3 mm whose tip points along the unit direction."""
        self.things.append(arrowhead(tip, direction, layer))

    def text(
        self,
        at: complex,
        text: str,
        height: float = 2.5,
        align: Align = "left",
        layer: str = "TEXT",
        room: float = math.inf,
    ) -> None:
        """Add a line of text, smaller where it might be longer than `room` mm; nothing where it is empty."""
        if text:
            line = Text(at, text, height, align, layer=layer)
            self.things.append(replace(line, height=height * min(1.0, room / line.room)))


def write_pdf(path: Path, sheet: Sheet) -> None:
    """Write the sheet as a one-page PDF at its true size; no date, no chance id, no compression: same sheet, same bytes."""
    from reportlab.pdfgen.canvas import Canvas

    paper = Canvas(
        str(path), (sheet.width * _POINT, sheet.height * _POINT), invariant=1, pageCompression=0
    )
    paper.setTitle(sheet.title)
    paper.scale(_POINT, _POINT)
    paper.setLineCap(1)
    paper.setLineJoin(1)
    for thing in sheet.things:
        if isinstance(thing, Text):
            _set(paper, thing)
            continue
        line = paper.beginPath()
        if isinstance(thing, Fill):
            for k, corner in enumerate(thing.corners):
                (line.lineTo if k else line.moveTo)(corner.real, corner.imag)
            paper.drawPath(line, stroke=0, fill=1)
            continue
        start = start_point(thing.pieces[0])
        line.moveTo(start.real, start.imag)
        for piece in thing.pieces:
            if isinstance(piece, Arc):
                box = (
                    piece.centre.real - piece.radius,
                    piece.centre.imag - piece.radius,
                    piece.centre.real + piece.radius,
                    piece.centre.imag + piece.radius,
                )
                line.arcTo(*box, math.degrees(piece.start), math.degrees(piece.sweep))
            else:
                end = end_point(piece)
                line.lineTo(end.real, end.imag)
        if thing.closed:
            line.close()
        paper.setLineWidth(LAYERS[thing.layer][1] / 100)
        paper.setDash(*([list(_DASHES[thing.layer][2])] if thing.layer in _DASHES else []))
        paper.drawPath(line)
    paper.save()


def _set(paper: Canvas, text: Text) -> None:
    """Set a line of text."""
    u = text.direction
    at = text.at - {"left": 0.0, "centre": 0.5, "right": 1.0}[text.align] * text.width * u
    paper.saveState()
    paper.transform(u.real, u.imag, -u.imag, u.real, at.real, at.imag)
    paper.setFont(_FONT, text.height / _CAP)
    paper.drawString(0, 0, text.text)
    paper.restoreState()


def write_dxf_sheet(path: Path, sheet: Sheet, scale: float, datum: complex) -> None:
    """Write the sheet as DXF so that the part is at its own size, its datum at the origin.

    scale: mm of paper for a mm of the part; datum: where the part's origin is on the paper.
    """

    def xy(z: complex) -> tuple[float, float]:
        w = (z - datum) / scale + 0
        return w.real, w.imag

    corners = (-datum / scale, (complex(sheet.width, sheet.height) - datum) / scale)
    with document(path, LAYERS, corners) as space:
        for kind, pattern, _ in _DASHES.values():
            if pattern:
                space.doc.linetypes.add(kind, pattern)
        for thing in sheet.things:
            at: dict[str, object] = {"layer": thing.layer}
            if thing.layer in _DASHES:
                at |= {"linetype": _DASHES[thing.layer][0], "ltscale": 0.5 / scale}
            if isinstance(thing, Text):
                at |= {
                    "height": thing.height / scale,
                    "rotation": math.degrees(cmath.phase(thing.direction)),
                    "valign": 0,
                    "halign": _HALIGN[thing.align],
                    "insert": xy(thing.at),
                    "align_point": xy(thing.at),
                }
                space.add_text(thing.text.translate(_DXF_CODES), dxfattribs=at)
            elif isinstance(thing, Fill):
                a, b, c = map(xy, thing.corners)
                space.add_solid([a, b, c, c], dxfattribs=at)
            elif thing.closed:
                add_contour(
                    space, Contour(thing.pieces).moved(1 / scale, -datum / scale), thing.layer
                )
                space[-1].update_dxf_attribs(at)
            else:
                for piece in thing.pieces:
                    if isinstance(piece, Arc):
                        low, high = sorted((math.degrees(piece.t0), math.degrees(piece.t1)))
                        space.add_arc(
                            xy(piece.centre), piece.radius / scale, low, high, dxfattribs=at
                        )
                    elif isinstance(piece, Line):
                        space.add_line(xy(piece.a), xy(piece.b), dxfattribs=at)
