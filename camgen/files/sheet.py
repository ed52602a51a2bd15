"""A sheet of paper as data, and its two outputs: PDF at the printed size, DXF at the part's own size.

Coordinates are complex, mm of paper, from the sheet's lower left corner. The sheet consists of

    Stroke   lines and arcs end to end, open or closed (a closed one is a contour)
    Fill     a filled triangle (an arrowhead)
    Text     one line of text

each on a layer that decides its line. PDF text is set in Helvetica, which every PDF
reader brings along.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal

import numpy as np

from camgen.files.dxf import add_contour, document
from camgen.geometry.outlines import Arc, Contour, Line, Piece, start_point

# Layer -> (colour index, line width in 1/100 mm). VIEW holds visible edges that are not cut, HIDDEN those behind material.
LAYERS = {"CUT": (7, 50), "VIEW": (8, 35), "HIDDEN": (8, 18), "CENTER": (1, 18), "DIM": (5, 18), "TEXT": (7, 25)}
# Dashed layers: line type in a DXF, its pattern there and in a PDF, mm of paper.
_DASHES = {"CENTER": ("CENTER2", (), "6 1.2 0.8 1.2"), "HIDDEN": ("HIDDEN2", (9.0, 6.0, -3.0), "3 1.5")}
# What a character takes at most in CAD programs, by the height of capitals: of LibreCAD's standard font most letters and
# digits take 0.78, the space 0.75; the wide ones stand here.
CAD_ADVANCE = 0.8
_CAD_WIDE = dict.fromkeys("4BDGHKNOPRSTUZ", 0.9) | dict.fromkeys("mwAMQVXY#&*Ø", 1.0) | dict.fromkeys("W%@_", 1.6)
_POINT = 72 / 25.4  # PDF units in a millimetre

# Advance widths of Helvetica, 1/1000 of the size, characters 32 to 126. [Adobe Core14 AFM, Helvetica.afm]
_WIDTHS = (
    "278 278 355 556 556 889 667 191 333 333 389 584 278 333 278 278 556 556 556 556 556 556 556 556 556 556 278 278 "
    "584 584 584 556 1015 667 667 722 722 667 611 778 722 278 500 667 556 833 722 778 667 778 722 667 611 722 667 944 "
    "667 667 611 278 278 278 469 556 333 556 556 500 556 556 278 556 556 222 222 500 222 833 556 556 556 556 333 500 "
    "278 556 500 722 500 500 500 334 260 334 584"
)
_WIDTH = {chr(32 + i): int(width) for i, width in enumerate(_WIDTHS.split())} | {"Ø": 778, "×": 584, "°": 400, "±": 584}
_CAP = 0.718  # height of its capitals by the size
# How DXF readers write what their own fonts may lack.
_DXF_CODES = str.maketrans({"Ø": "%%c", "°": "%%d", "±": "%%p", "×": "x"})

Align = Literal["left", "centre", "right"]


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
        return sum(_WIDTH.get(c, 600) for c in self.text) / 1000 * self.height / _CAP

    @property
    def room(self) -> float:
        """Length that it may take in a PDF reader or in a CAD program, whose font is its own, mm."""
        return max(self.width, self.height * sum(_CAD_WIDE.get(c, CAD_ADVANCE) for c in self.text))


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
        foot = tip - 3 * direction
        self.things.append(Fill((tip, foot + 0.5j * direction, foot - 0.5j * direction), layer))

    def text(
        self,
        at: complex,
        text: str,
        height: float = 2.5,
        align: Align = "left",
        direction: complex = 1,
        layer: str = "TEXT",
        room: float = math.inf,
    ) -> None:
        """Add a line of text, smaller where it might be longer than `room` mm."""
        line = Text(at, text, height, align, direction, layer)
        shrink = min(1.0, room / line.room) if text else 1.0
        self.things.append(replace(line, height=height * shrink))


def write_pdf(path: Path, sheet: Sheet) -> None:
    """Write the sheet as a one-page PDF at its true size; no date, no id, no compression."""
    content = f"{_POINT:.9f} 0 0 {_POINT:.9f} 0 0 cm 1 J 1 j\n" + "".join(map(_operators, sheet.things))
    box = f"{sheet.width * _POINT:.3f} {sheet.height * _POINT:.3f}"
    title = sheet.title.replace("\\", r"\\").replace("(", r"\(").replace(")", r"\)")
    bodies = [
        "<< /Type /Catalog /Pages 2 0 R >>",
        "<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
        f"<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {box}] /Contents 4 0 R /Resources << /Font << /F 5 0 R >> >> >>",
        f"<< /Length {len(content.encode('cp1252'))} >>\nstream\n{content}endstream",
        "<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica /Encoding /WinAnsiEncoding >>",
        f"<< /Title ({title}) >>",
    ]
    data, places = b"%PDF-1.4\n", []
    for number, body in enumerate(bodies, 1):
        places.append(len(data))
        data += f"{number} 0 obj\n{body}\nendobj\n".encode("cp1252")
    table = "".join(f"{place:010d} 00000 n \n" for place in places)
    size = len(bodies) + 1
    data += f"xref\n0 {size}\n0000000000 65535 f \n{table}".encode()
    data += f"trailer\n<< /Size {size} /Root 1 0 R /Info 6 0 R >>\nstartxref\n{data.rindex(b'xref')}\n%%EOF\n".encode()
    path.write_bytes(data)


def _operators(thing: Stroke | Fill | Text) -> str:
    """PDF operators of one thing, in mm."""
    if isinstance(thing, Text):
        size = thing.height / _CAP
        back = {"left": 0.0, "centre": 0.5, "right": 1.0}[thing.align] * thing.width
        at, u = thing.at - back * thing.direction, thing.direction
        safe = thing.text.replace("\\", r"\\").replace("(", r"\(").replace(")", r"\)")
        safe = safe.encode("cp1252", "replace").decode("cp1252")
        turn = f"{u.real:.5f} {u.imag:.5f} {-u.imag:.5f} {u.real:.5f}"
        return f"BT /F {size:.4f} Tf {turn} {_pair(at)} Tm ({safe}) Tj ET\n"
    if isinstance(thing, Fill):
        a, b, c = map(_pair, thing.corners)
        return f"{a} m {b} l {c} l f\n"
    dash = f"[{_DASHES[thing.layer][2] if thing.layer in _DASHES else ''}] 0 d"
    steps = [f"{LAYERS[thing.layer][1] / 100:g} w {dash} {_pair(start_point(thing.pieces[0]))} m"]
    for piece in thing.pieces:
        if isinstance(piece, Arc):
            steps += _beziers(piece)
        else:
            steps.append(f"{_pair(complex(piece.at(piece.t1)))} l")
    return "\n".join(steps) + (" s\n" if thing.closed else " S\n")


def _beziers(arc: Arc) -> list[str]:
    """An arc as cubic Bezier curves of at most 45 deg: 4e-6 of the radius off."""
    n = math.ceil(abs(arc.sweep) / (math.pi / 4))
    t = np.linspace(arc.t0, arc.t1, n + 1)
    handle = 4 / 3 * math.tan(arc.sweep / n / 4)
    z, dz = arc.at(t), arc.at(t, 1) * handle
    return [f"{_pair(z[i] + dz[i])} {_pair(z[i + 1] - dz[i + 1])} {_pair(z[i + 1])} c" for i in range(n)]


def _pair(z: complex) -> str:
    return f"{z.real + 0.0:.4f} {z.imag + 0.0:.4f}"


def write_dxf_sheet(path: Path, sheet: Sheet, scale: float, datum: complex) -> None:
    """Write the sheet as DXF so that the part is at its own size, its datum at the origin.

    scale: mm of paper for a mm of the part; datum: where the part's origin is on the paper.
    """
    from ezdxf.enums import TextEntityAlignment

    alignment = {
        "left": TextEntityAlignment.LEFT,
        "centre": TextEntityAlignment.CENTER,
        "right": TextEntityAlignment.RIGHT,
    }

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
                at |= {"height": thing.height / scale, "rotation": math.degrees(cmath.phase(thing.direction))}
                entity = space.add_text(thing.text.translate(_DXF_CODES), dxfattribs=at)
                entity.set_placement(xy(thing.at), align=alignment[thing.align])
            elif isinstance(thing, Fill):
                a, b, c = map(xy, thing.corners)
                space.add_solid([a, b, c, c], dxfattribs=at)
            elif thing.closed:
                add_contour(space, Contour(thing.pieces).moved(1 / scale, -datum / scale), thing.layer)
                space[-1].update_dxf_attribs(at)
            else:
                for piece in thing.pieces:
                    if isinstance(piece, Arc):
                        low, high = sorted((math.degrees(piece.t0), math.degrees(piece.t1)))
                        space.add_arc(xy(piece.centre), piece.radius / scale, low, high, dxfattribs=at)
                    elif isinstance(piece, Line):
                        space.add_line(xy(piece.a), xy(piece.b), dxfattribs=at)
