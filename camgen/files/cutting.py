"""Sheets for a laser: all outlines that the beam follows, as DXF and as SVG; millimetres, hairlines, a colour for each tool.

Engraving comes first, then holes, then outer contours, part by part: so nothing is cut out of what has moved already.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from html import escape, unescape
from pathlib import Path

import numpy as np

from camgen.bounds import Bound, read_bytes
from camgen.errors import FileError
from camgen.files.dxf import CUT_LAYER, ENGRAVE_LAYER, add_contour, document
from camgen.geometry.arcs import as_circle, bulges, fit_arcs
from camgen.geometry.outlines import Contour, Region
from camgen.geometry.rings import Ring

COLOURS = {
    ENGRAVE_LAYER: (5, "#0000ff"),
    CUT_LAYER: (1, "#ff0000"),
}  # in DXF, in SVG: blue is engraved, red is cut
DXF_LAYERS = {
    layer: (colour, 0) for layer, (colour, _) in COLOURS.items()
}  # line weight 0: a hairline
_HAIRLINE = 0.025  # mm: a thousandth of an inch, under which drivers of lasers cut; a browser hardly shows a thinner line
_DIGITS = 6  # after the point, mm
_MOST = Bound("a sheet in SVG", 20_000_000, b"<", "elements", 200_000)


@dataclass(frozen=True)
class Piece:
    """A part on a sheet: what the beam follows round it, and what it engraves."""

    name: str
    path: Region
    engraved: tuple[Contour, ...] = ()

    def contours(self, tolerance: float) -> Iterator[tuple[str, Contour]]:
        """Layers and contours of lines and arcs, within tolerance, mm, in the order in which they are cut."""
        rows = [
            *((ENGRAVE_LAYER, each) for each in self.engraved),
            *((CUT_LAYER, each) for each in self.path.holes),
        ]
        for layer, contour in (*rows, (CUT_LAYER, self.path.outer)):
            yield layer, fit_arcs(contour.counter_clockwise(), tolerance)


def write_sheet(
    path: Path, pieces: Sequence[Piece], size: tuple[float, float], tolerance: float
) -> None:
    """Write a sheet of this width and height, mm, with its lower left corner at the origin, in the format of the ending."""
    rows = [row for piece in pieces for row in piece.contours(tolerance)]
    if path.suffix == ".dxf":
        layers = {
            layer: look
            for layer, look in DXF_LAYERS.items()
            if layer in {layer for layer, _ in rows}
        }
        with document(path, layers, (0j, complex(*size))) as space:
            for layer, contour in rows:
                add_contour(space, contour, layer)
        return
    width, height = map(_text, size)
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}mm" height="{height}mm" viewBox="0 0 {width} {height}">\n'
    ]
    for layer, (_, colour) in COLOURS.items():
        if not any(name == layer for name, _ in rows):
            continue
        lines.append(f'<g id="{layer}" fill="none" stroke="{colour}" stroke-width="{_HAIRLINE}">\n')
        for piece in pieces:
            elements = [
                _drawn(contour, size[1])
                for name, contour in piece.contours(tolerance)
                if name == layer
            ]
            lines += (
                [f"<g><title>{escape(piece.name, quote=False)}</title>\n", *elements, "</g>\n"]
                if elements
                else []
            )
        lines.append("</g>\n")
    path.write_text("".join([*lines, "</svg>\n"]), encoding="utf-8", newline="\n")


def _text(value: float) -> str:
    return f"{value:z.{_DIGITS}f}".rstrip("0").rstrip(".")


def _drawn(contour: Contour, height: float) -> str:
    """A contour with y downwards, which leaves every arc's sense as it is seen."""
    circle = as_circle(contour)
    if circle:
        centre, radius = circle
        return f'<circle cx="{_text(centre.real)}" cy="{_text(height - centre.imag)}" r="{_text(radius)}"/>\n'
    points, bulge = bulges(contour)
    words = [f"M{_at(points[0], height)}"]
    for a, b, t in zip(points.tolist(), np.roll(points, -1).tolist(), bulge.tolist(), strict=True):
        if t:
            r = _text(abs(b - a) * (1 + t * t) / (4 * abs(t)))
            words.append(f"A{r} {r} 0 0 {int(t < 0)} {_at(b, height)}")
        else:
            words.append(f"L{_at(b, height)}")
    return f'<path d="{" ".join(words)} Z"/>\n'


def _at(z: complex, height: float) -> str:
    return f"{_text(z.real)} {_text(height - z.imag)}"


# ---- read back ---------------------------------------------------------------------------------------------------------

_SIZE = r"([0-9]{1,9}(?:\.[0-9]{1,6})?)"
_NUMBER = f"(-?{_SIZE[1:]}"
_SHEET = re.compile(
    rf'<svg xmlns="http://www\.w3\.org/2000/svg" width="{_SIZE}mm" height="{_SIZE}mm" viewBox="0 0 \1 \2">'
)
_LAYER = {
    layer: f'<g id="{layer}" fill="none" stroke="{colour}" stroke-width="{_HAIRLINE}">'
    for layer, (_, colour) in COLOURS.items()
}
_PIECE = re.compile(r"<g><title>((?:[^<>&]|&amp;|&lt;|&gt;)*)</title>")
_CIRCLE = re.compile(rf'<circle cx="{_NUMBER}" cy="{_NUMBER}" r="{_SIZE}"/>')
_STEP = rf"(?: L{_NUMBER} {_NUMBER}| A{_SIZE} {_SIZE} 0 0 ([01]) {_NUMBER} {_NUMBER})"
_PATH = re.compile(rf'<path d="M{_NUMBER} {_NUMBER}({_STEP}+) Z"/>')
_STEPS = re.compile(_STEP)
_SHOWN = 60  # characters of a line that is not understood


@dataclass(frozen=True)
class Layer:
    """What one tool of the laser follows."""

    pieces: list[tuple[str, list[Ring]]]  # titles of groups, and what stands in each, y upwards, mm

    @property
    def rings(self) -> list[Ring]:
        """All of them."""
        return [ring for _, rings in self.pieces for ring in rings]

    @property
    def titles(self) -> list[str]:
        """Of the groups."""
        return [title for title, _ in self.pieces]


def read_svg(path: Path) -> tuple[tuple[float, float], dict[str, Layer]]:
    """Width and height, mm, and the layers of a sheet in SVG.

    A line that `write_sheet` does not write is refused, whatever it says: attributes, styles, references and units move, hide or
    scale what a laser cuts in more ways than can be listed. FileError with that line, or where the file cannot be read.
    """
    try:
        return _Lines(read_bytes(path, _MOST).decode("utf-8")).sheet()
    except OSError as error:
        raise FileError(path, error.strerror or str(error)) from None
    except ValueError as error:
        raise FileError(path, f"not a sheet in SVG as camgen writes it: {error}") from None


@dataclass(frozen=True)
class SheetPicture:
    """A sheet as a person sees it: its file's name, width and height, the lines of its groups, what is cut out of it, and how far.

    parts: name, lower left corner, width and height of each, mm, y upwards; as the beam goes, which is half the kerf outside.
    """

    file: str
    size: tuple[float, float]
    groups: str
    parts: Sequence[tuple[str, complex, float, float]]
    cut: float  # mm


def sheet_picture(path: Path) -> SheetPicture:
    """The picture of a sheet in SVG, read as `read_svg` does; FileError as there."""
    size, layers = read_svg(path)
    _, *lines = path.read_text(encoding="utf-8").splitlines()
    pieces = layers[CUT_LAYER].pieces if CUT_LAYER in layers else []
    parts = []
    for name, rings in pieces:
        boxes = np.array([ring.box for ring in rings])
        left, low = boxes[:, :2].min(axis=0)
        right, high = boxes[:, 2:].max(axis=0)
        parts.append((name, complex(left, low), float(right - left), float(high - low)))
    length = sum(float(ring.length) for _, rings in pieces for ring in rings)
    return SheetPicture(path.name, size, "\n".join(lines[:-1]), parts, length)


class _Lines:
    """The lines of a sheet, taken one by one; ValueError at one that does not belong where it stands."""

    def __init__(self, text: str) -> None:
        self.lines = text.split("\n")
        self.number = 0

    @property
    def line(self) -> str:
        """The one that is next, "" at the end."""
        return self.lines[self.number] if self.number < len(self.lines) else ""

    def take(self, pattern: str | re.Pattern[str]) -> re.Match[str] | None:
        """The next line's match, taken; None, and it stays, where it is another one."""
        match = re.fullmatch(re.escape(pattern) if isinstance(pattern, str) else pattern, self.line)
        self.number += match is not None
        return match

    def need(self, pattern: str | re.Pattern[str], what: str) -> re.Match[str]:
        """The same of a line that must come here."""
        match = self.take(pattern)
        if match is None:
            raise ValueError(
                f"line {self.number + 1}, where {what} is expected, is {self.line[:_SHOWN]!r}"
            )
        return match

    def sheet(self) -> tuple[tuple[float, float], dict[str, Layer]]:
        """All of it."""
        width, height = (
            float(side) for side in self.need(_SHEET, "a sheet in millimetres").groups()
        )
        layers = {}
        for name, line in _LAYER.items():
            if self.take(line):
                layers[name] = self.layer(height)
        self.need("</svg>", f"a layer of {', '.join(_LAYER)} or the end")
        if any(self.lines[self.number :]):
            raise ValueError("something follows its end")
        return (width, height), layers

    def layer(self, height: float) -> Layer:
        """A layer's pieces."""
        pieces = list[tuple[str, list[Ring]]]()
        while not self.take("</g>"):
            title = unescape(self.need(_PIECE, "a piece with its title")[1])
            rings = list[Ring]()
            while not self.take("</g>"):
                rings.append(self.ring(height))
            pieces.append((title, rings))
        return Layer(pieces)

    def ring(self, height: float) -> Ring:
        """A contour."""
        if circle := self.take(_CIRCLE):
            x, y, radius = (float(number) for number in circle.groups())
            return Ring(
                np.array([complex(x + radius, height - y), complex(x - radius, height - y)]),
                np.ones(2),
            )
        path = self.need(_PATH, "a circle or a closed path")
        points = [complex(float(path[1]), height - float(path[2]))]
        bulges = list[float]()
        for line_x, line_y, radius, second_radius, clockwise, arc_x, arc_y in _STEPS.findall(
            path[3]
        ):
            z = complex(float(line_x or arc_x), height - float(line_y or arc_y))
            if radius != second_radius or (radius and not float(radius)):
                raise ValueError(
                    f"line {self.number}: an arc of the radii {radius} and {second_radius}"
                )
            sine = (
                min(abs(z - points[-1]) / (2 * float(radius)), 1.0) if radius else 0.0
            )  # of half the sweep
            bulges.append(math.tan(math.asin(sine) / 2) * (-1 if clockwise == "1" else 1))
            points.append(z)
        if abs(points[-1] - points[0]) > 10.0**-_DIGITS:
            raise ValueError(f"line {self.number}: a path that does not end where it begins")
        return Ring(np.array(points[:-1]), np.array(bulges))
