"""A sheet of paper as data, and its two outputs: PDF at the printed size, DXF at the part's own size.

Coordinates are complex, mm of paper, from the sheet's lower left corner. The sheet consists of

    Stroke   lines and arcs end to end, open or closed (a closed one is a contour)
    Fill     a filled triangle (an arrowhead)
    Text     one line of text
    Size     a linear dimension: in a DXF one DIMENSION, drawn as on paper by its own block

each on a layer that decides its line. PDF text is set in Helvetica, which every PDF reader brings along.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from camgen.files.dxf import add_contour, document
from camgen.geometry.outlines import Arc, Contour, Line, Piece, end_point, start_point

if TYPE_CHECKING:
    from reportlab.pdfgen.canvas import Canvas

# Layer -> (colour index, line width in 1/100 mm). CUT holds closed contours, WALL those of a drum unrolled, which are open,
# VIEW visible edges that are not cut, HIDDEN those behind material, CASE what runs beside faces that are hardened.
LAYERS = {
    "CUT": (7, 50),
    "WALL": (7, 50),
    "VIEW": (8, 35),
    "HIDDEN": (8, 18),
    "CASE": (7, 70),
    "CENTER": (1, 18),
    "DIM": (5, 18),
    "HATCH": (8, 13),
    "TEXT": (7, 25),
}
# Dashed layers: line type in a DXF, its pattern there and in a PDF, mm of paper.
_DASHES = {
    "CENTER": ("CENTER2", (), (6, 1.2, 0.8, 1.2)),
    "HIDDEN": ("HIDDEN2", (9.0, 6.0, -3.0), (3, 1.5)),
    "CASE": ("CASE", (20.0, 14.0, -2.5, 1.0, -2.5), (7, 1.6, 0.8, 1.6)),
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
_DIMSTYLE = "camgen"
_ALONG = 128  # flag of a polyline whose dashes go on past its corners
_LINEAR = 32  # a DIMENSION that is turned, with a block of its own
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
        return _lengths(self.text, self.height)[0]

    @property
    def room(self) -> float:
        """Length that it may take in a PDF reader or in a CAD program, whose font is its own, mm."""
        return max(_lengths(self.text, self.height))


@lru_cache(maxsize=1024)  # a label is tried at many places, and a word begins many lines
def _lengths(text: str, height: float) -> tuple[float, float]:
    """How long a line is in Helvetica, and at most in a CAD program, mm."""
    from reportlab.pdfbase.pdfmetrics import stringWidth

    cad = height * sum(_CAD_WIDE.get(c, CAD_ADVANCE) for c in text)
    return float(stringWidth(text, _FONT, height / _CAP)), cad


@dataclass(frozen=True)
class Size:
    """A linear dimension between two points."""

    a: complex
    b: complex
    line: complex  # where its line ends on the side of b
    value: float  # mm of the part
    sign: str  # before the number, such as "Ø"
    primitives: tuple[Stroke | Fill | Text, ...]  # what is seen of it
    decimals: int = 3  # of the number
    fit: str = ""  # behind the number
    factor: float = 1.0  # mm of the part for one that a program measures: below 1 in a detail


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
    things: list[Stroke | Fill | Text | Size] = field(default_factory=list)

    @property
    def primitives(self) -> Iterator[Stroke | Fill | Text]:
        """All that is seen, in order."""
        for thing in self.things:
            yield from thing.primitives if isinstance(thing, Size) else (thing,)

    def line(self, *points: complex, layer: str, closed: bool = False) -> None:
        """Add straight strokes through the points."""
        ends = [*points[1:], points[0]] if closed else points[1:]
        pieces = tuple(Line(complex(a), complex(b)) for a, b in zip(points, ends, strict=False))
        self.things.append(Stroke(pieces, layer, closed))

    def frame(self, filing: float, margin: float) -> None:
        """Add the frame of a drawing; filing, margin: from the paper's left edge and from its others, mm."""
        right, top = self.width - margin, self.height - margin
        corners = (filing + 1j * margin, right + 1j * margin, right + 1j * top, filing + 1j * top)
        self.line(*corners, layer="TEXT", closed=True)

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


def write_pdf(path: Path, *sheets: Sheet) -> None:
    """Write sheets as the pages of a PDF at their true size; no date, no chance id, no compression: same sheets, same bytes."""
    from reportlab.pdfgen.canvas import Canvas

    paper = Canvas(str(path), invariant=1, pageCompression=0)
    paper.setTitle(sheets[0].title)
    for sheet in sheets:
        _draw_page(paper, sheet)
    paper.save()


def _draw_page(paper: Canvas, sheet: Sheet) -> None:
    """Draw a sheet as the next page."""
    paper.setPageSize((sheet.width * _POINT, sheet.height * _POINT))
    paper.scale(_POINT, _POINT)
    paper.setLineCap(1)
    paper.setLineJoin(1)
    for thing in sheet.primitives:
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
    paper.showPage()


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
    corners = (-datum / scale, (complex(sheet.width, sheet.height) - datum) / scale)
    with document(path, LAYERS, corners) as space:
        for kind, pattern, _ in _DASHES.values():
            if pattern:
                space.doc.linetypes.add(kind, pattern)
        if any(isinstance(thing, Size) for thing in sheet.things):
            style = space.doc.dimstyles.new(_DIMSTYLE, _dimension_style(scale))
            style.copy_to_header(
                space.doc
            )  # which programs take that draw sizes by rules of their own
        to_part = _ToPart(scale, datum)
        for thing in sheet.things:
            if isinstance(thing, Size):
                to_part.size(space, thing)
            else:
                to_part.put(space, thing)


def _dimension_style(scale: float) -> dict[str, Any]:
    """How a program draws a dimension anew: as on paper, numbers with three decimals less idle zeros.

    Lengths are scaled one by one: by a $DIMSCALE LibreCAD would scale the widths of all lines too.
    """
    paper = {"dimtxt": 3.5, "dimasz": 3.0, "dimexo": 1.0, "dimexe": 2.0, "dimgap": 0.9}  # mm
    number = {"dimlunit": 2, "dimdec": 3, "dimzin": 8, "dimdsep": ord(".")}
    place = {"dimtad": 1, "dimtih": 0, "dimtoh": 0, "dimscale": 1.0}
    colour = dict.fromkeys(("dimclrd", "dimclre", "dimclrt"), LAYERS["DIM"][0])
    return {key: length / scale for key, length in paper.items()} | number | place | colour


@dataclass(frozen=True)
class _ToPart:
    """From paper to a DXF in which the part is at its own size."""

    scale: float  # mm of paper for a mm of the part
    datum: complex  # where the part's origin is on the paper

    def xy(self, z: complex) -> tuple[float, float]:
        """A point of the paper."""
        w = (z - self.datum) / self.scale + 0
        return w.real, w.imag

    def size(self, space: Any, size: Size) -> None:
        """Add a DIMENSION with its block."""
        block = space.doc.blocks.new_anonymous_block(type_char="D")
        for thing in size.primitives:
            self.put(block, thing)
        text = next(thing for thing in size.primitives if isinstance(thing, Text))
        at = {
            "layer": "DIM",
            "dimstyle": _DIMSTYLE,
            "geometry": block.name,
            "dimtype": _LINEAR,
            "defpoint": self.xy(size.line),
            "defpoint2": self.xy(size.a),
            "defpoint3": self.xy(size.b),
            "text_midpoint": self.xy(text.at + text.height / 2 * 1j * text.direction),
            "angle": math.degrees(cmath.phase(size.b - size.a)),
            "text": (size.sign + "<>" + size.fit).translate(_DXF_CODES),
            "actual_measurement": size.value / size.factor,
        }
        dimension = space.new_entity("DIMENSION", at)
        if (size.decimals, size.factor) != (3, 1.0):
            own = {"dimdec": size.decimals, "dimlfac": size.factor}
            dimension.set_acad_dstyle(own | {"dimtxt": text.height / self.scale})

    def put(self, space: Any, thing: Stroke | Fill | Text) -> None:
        """Add what is drawn to a modelspace or a block."""
        at: dict[str, object] = {"layer": thing.layer}
        if thing.layer in _DASHES:
            at |= {"linetype": _DASHES[thing.layer][0], "ltscale": 0.5 / self.scale}
        if isinstance(thing, Text):
            at |= {
                "height": thing.height / self.scale,
                "rotation": math.degrees(cmath.phase(thing.direction)),
                "valign": 0,
                "halign": _HALIGN[thing.align],
                "insert": self.xy(thing.at),
                "align_point": self.xy(thing.at),
            }
            space.add_text(thing.text.translate(_DXF_CODES), dxfattribs=at)
        elif isinstance(thing, Fill):
            a, b, c = map(self.xy, thing.corners)
            space.add_solid([a, b, c, c], dxfattribs=at)
        elif thing.closed:
            contour = Contour(thing.pieces).moved(1 / self.scale, -self.datum / self.scale)
            add_contour(space, contour, thing.layer)
            space[-1].update_dxf_attribs(at)
            if "linetype" in at and space[-1].dxftype() == "LWPOLYLINE":
                space[-1].dxf.flags |= _ALONG
        else:
            self._strokes(space, thing, at)

    def _strokes(self, space: Any, stroke: Stroke, at: dict[str, object]) -> None:
        """Add lines and arcs one by one."""
        for piece in stroke.pieces:
            if isinstance(piece, Arc):
                low, high = sorted((math.degrees(piece.t0), math.degrees(piece.t1)))
                space.add_arc(
                    self.xy(piece.centre), piece.radius / self.scale, low, high, dxfattribs=at
                )
            elif isinstance(piece, Line):
                space.add_line(self.xy(piece.a), self.xy(piece.b), dxfattribs=at)
