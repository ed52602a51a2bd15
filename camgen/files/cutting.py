"""Sheets for a laser: all outlines that the beam follows, as DXF and as SVG; millimetres, hairlines, a colour for each tool.

Engraving comes first, then holes, then outer contours, part by part: so nothing is cut out of what has moved already.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree import ElementTree
from xml.sax.saxutils import escape

import numpy as np

from camgen.bounds import Bound, read_bytes
from camgen.errors import FileError
from camgen.files.dxf import CUT_LAYER, ENGRAVE_LAYER, add_contour, document
from camgen.geometry.arcs import as_circle, bulges, fit_arcs
from camgen.geometry.outlines import Contour, Region
from camgen.geometry.rings import Ring

COLOURS = {ENGRAVE_LAYER: (5, "#0000ff"), CUT_LAYER: (1, "#ff0000")}  # in DXF, in SVG: blue is engraved, red is cut
_HAIRLINE = 0.025  # mm: a thousandth of an inch, under which drivers of lasers cut; a browser hardly shows a thinner line
_DIGITS = 6  # after the point, mm
_SIZE = Bound("a sheet in SVG", 20_000_000, b"<", "elements", 200_000)
_SVG = "{http://www.w3.org/2000/svg}"


@dataclass(frozen=True)
class Piece:
    """A part on a sheet: what the beam follows round it, and what it engraves."""

    name: str
    path: Region
    engraved: tuple[Contour, ...] = ()

    def contours(self, tolerance: float) -> Iterator[tuple[str, Contour]]:
        """Layers and contours of lines and arcs, within tolerance, mm, in the order in which they are cut."""
        rows = [*((ENGRAVE_LAYER, each) for each in self.engraved), *((CUT_LAYER, each) for each in self.path.holes)]
        for layer, contour in (*rows, (CUT_LAYER, self.path.outer)):
            yield layer, fit_arcs(contour.counter_clockwise(), tolerance)


def write_sheet(path: Path, pieces: Sequence[Piece], size: tuple[float, float], tolerance: float) -> None:
    """Write a sheet of this width and height, mm, with its lower left corner at the origin, in the format of the ending."""
    rows = [row for piece in pieces for row in piece.contours(tolerance)]
    if path.suffix == ".dxf":
        used = {layer: (colour, 0) for layer, (colour, _) in COLOURS.items() if layer in {layer for layer, _ in rows}}
        with document(path, used, (0j, complex(*size))) as space:
            for layer, contour in rows:
                add_contour(space, contour, layer)
        return
    wide, high = map(_text, size)
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{wide}mm" height="{high}mm" viewBox="0 0 {wide} {high}">\n'
    ]
    for layer, (_, colour) in COLOURS.items():
        if not any(name == layer for name, _ in rows):
            continue
        lines.append(f'<g id="{layer}" fill="none" stroke="{colour}" stroke-width="{_HAIRLINE}">\n')
        for piece in pieces:
            here = [_drawn(contour, size[1]) for name, contour in piece.contours(tolerance) if name == layer]
            lines += [f"<g><title>{escape(piece.name)}</title>\n", *here, "</g>\n"] if here else []
        lines.append("</g>\n")
    path.write_text("".join([*lines, "</svg>\n"]), encoding="utf-8", newline="\n")


def _text(value: float) -> str:
    return f"{value:z.{_DIGITS}f}".rstrip("0").rstrip(".")


def _drawn(contour: Contour, height: float) -> str:
    """A contour with y downwards, which leaves every arc's sense as it is seen."""
    round_one = as_circle(contour)
    if round_one:
        centre, radius = round_one
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


def read_svg(path: Path) -> tuple[tuple[float, float], dict[str, list[Ring]]]:
    """Width and height, mm, and the rings on each layer, with y upwards, of a sheet in SVG.

    FileError where it cannot be read, is not in millimetres, or holds other things than such sheets.
    """
    try:
        root = ElementTree.fromstring(read_bytes(path, _SIZE))
        size = _size(root)
        rings: dict[str, list[Ring]] = {}
        for group in root:
            name = group.get("id", "")
            if name not in COLOURS or group.get("stroke") != COLOURS[name][1] or group.get("fill") != "none":
                raise ValueError(f"a group {name!r} with stroke {group.get('stroke')!r}")
            rings[name] = [_ring(each, size[1]) for piece in group for each in piece if each.tag != f"{_SVG}title"]
    except OSError as error:
        raise FileError(path, error.strerror or str(error)) from None
    except (ElementTree.ParseError, UnicodeDecodeError, ValueError, KeyError, TypeError) as error:
        raise FileError(path, f"not a sheet in SVG: {error}") from None
    return size, rings


def _size(root: Any) -> tuple[float, float]:
    sides = [re.fullmatch(r"([\d.]+)mm", root.get(name, "")) for name in ("width", "height")]
    if root.tag != f"{_SVG}svg" or None in sides:
        raise ValueError("width and height are not in millimetres")
    width, height = (float(side[1]) for side in sides if side is not None)
    if [float(word) for word in root.get("viewBox").split()] != [0, 0, width, height]:
        raise ValueError("a unit of its drawing is no millimetre")
    return width, height


def _ring(shape: Any, height: float) -> Ring:
    if shape.tag == f"{_SVG}circle":
        x, y, radius = (float(shape.get(name)) for name in ("cx", "cy", "r"))
        return Ring(np.array([complex(x + radius, height - y), complex(x - radius, height - y)]), np.ones(2))
    if shape.tag != f"{_SVG}path":
        raise ValueError(f"an element {shape.tag.rpartition('}')[2]}")
    words = re.findall(r"[MLAZ][^MLAZ]*", shape.get("d"))
    if words[0][0] != "M" or words[-1].strip() != "Z":
        raise ValueError("a path that does not close")
    points: list[complex] = []
    bulges: list[float] = []
    for word in words[:-1]:
        numbers = [float(text) for text in word[1:].split()]
        z = complex(numbers[-2], height - numbers[-1])
        if word[0] == "A":
            sine = min(abs(z - points[-1]) / (2 * numbers[0]), 1.0)  # of half the sweep
            bulges.append(float(np.tan(np.arcsin(sine) / 2)) * (-1 if numbers[4] else 1))
        elif word[0] == "L":
            bulges.append(0.0)
        points.append(z)
    if abs(points[-1] - points[0]) > 10.0**-_DIGITS:
        raise ValueError("a path that does not end where it begins")
    return Ring(np.array(points[:-1]), np.array(bulges))
