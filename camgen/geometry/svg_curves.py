"""Curves of an SVG of any maker: paths, polygons, lines, rectangles, circles and ellipses that it shows, as chains of lines and arcs.

mm with y upwards: user coordinate (x, y) of the drawing is (x, -y) times the mm in its unit. An affine map is z -> p z + q conj(z) + r.
"""

from __future__ import annotations

import cmath
import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from camgen.errors import FileError
from camgen.geometry.chains import Chain
from camgen.tolerances import SAME_POINT

_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_GAP = r"[\s,]*"
_COMMAND = re.compile(r"([MmZzLlHhVvCcSsQqTtAa])([^MmZzLlHhVvCcSsQqTtAa]*)")
_ARC = re.compile(
    _GAP.join(f"({each})" for each in (*[_NUMBER] * 3, "[01]", "[01]", *[_NUMBER] * 2))
)
_COUNTS = {"M": 2, "L": 2, "H": 1, "V": 1, "C": 6, "S": 4, "Q": 4, "T": 2, "A": 7, "Z": 0}
_FUNCTION = re.compile(rf"(matrix|translate|scale|rotate|skewX|skewY){_GAP}\(([^()]*)\)")
_LENGTH = re.compile(rf"({_NUMBER})(mm|cm|in|pt|pc)")
_MILLIMETRES = {"mm": 1.0, "cm": 10.0, "in": 25.4, "pt": 25.4 / 72, "pc": 25.4 / 6}
_PIXEL = 25.4 / 96  # mm, the user unit of a drawing without viewBox
_NOT_DRAWN = {"defs", "symbol", "clipPath", "mask", "pattern", "marker", "metadata", "namedview"}
_UNREAD = {"text", "use", "image"}  # what would have to become paths first
_MOST_CHORDS = 200_000
_BEYOND = 1e6  # mm: what no drawing means

Map = tuple[complex, complex, complex]


def curves(path: Path, content: bytes, tolerance: float) -> tuple[list[Chain], str]:
    """The curves of a drawing, mm, those that are no circular arcs as chords within the tolerance, mm; and what it does not read.

    FileError where it is no SVG, names no unit of length, or has a path that cannot be read.
    """
    try:
        root = ElementTree.fromstring(content)
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise FileError(path, f"not a valid SVG file: {error}") from None
    if _tag(root) != "svg":
        raise FileError(path, f"not an SVG file: it begins with <{_tag(root)}>")
    pen = _Pen(tolerance)
    unread = set()
    try:
        scale = _scale(root)
        stack: list[tuple[ElementTree.Element, Map]] = [(root, (0j, complex(scale), 0j))]
        while stack:
            element, outer = stack.pop()
            kind = _tag(element)
            style = element.get("style", "").replace(" ", "") + ";"
            hidden = element.get("display") == "none" or "display:none;" in style
            if kind in _NOT_DRAWN or hidden:
                continue
            if kind in _UNREAD:
                unread.add(kind)
            pen.map = _after(outer, _transform(element.get("transform", "")))
            _draw(pen, kind, element)
            stack += [(each, pen.map) for each in reversed(element)]
    except (ValueError, OverflowError) as error:
        raise FileError(path, str(error)) from None
    return pen.chains, ", ".join(sorted(unread))


def _tag(element: ElementTree.Element) -> str:
    """Name of an element without its namespace; empty for a comment."""
    return str(element.tag).rpartition("}")[2] if isinstance(element.tag, str) else ""


def _scale(root: ElementTree.Element) -> float:
    """Millimetres in a user unit; ValueError where the drawing does not say it."""
    sizes = [_LENGTH.fullmatch(root.get(key, "").strip()) for key in ("width", "height")]
    box = _numbers(root.get("viewBox", ""))
    if not any(sizes):
        raise ValueError(
            'names no unit of length: its <svg> needs a width such as width="120mm" (in Inkscape: '
            "Document Properties, Units mm)"
        )
    if not box:
        return _PIXEL
    if len(box) != 4 or min(box[2:]) <= 0:
        raise ValueError("has a viewBox that is no four numbers: x, y, width and height")
    return min(
        float(size[1]) * _MILLIMETRES[size[2]] / box[k + 2] for k, size in enumerate(sizes) if size
    )


def _numbers(text: str) -> list[float]:
    """The numbers of a list; ValueError where there is anything else."""
    if left := re.sub(_NUMBER, "", text).replace(",", "").strip():
        raise ValueError(f"has {left[:20]!r} where numbers were expected")
    return [float(each) for each in re.findall(_NUMBER, text)]


# ---- maps --------------------------------------------------------------------------------------------------------------


def _matrix(a: float, b: float, c: float, d: float, e: float = 0.0, f: float = 0.0) -> Map:
    """The map x' = a x + c y + e, y' = b x + d y + f."""
    return complex(a + d, b - c) / 2, complex(a - d, b + c) / 2, complex(e, f)


def _after(outer: Map, inner: Map) -> Map:
    """The inner map, then the outer one."""
    p, q, r = outer
    p2, q2, r2 = inner
    return (
        p * p2 + q * q2.conjugate(),
        p * q2 + q * p2.conjugate(),
        p * r2 + q * r2.conjugate() + r,
    )


def _transform(text: str) -> Map:
    """The map of a transform attribute."""
    whole: Map = (1 + 0j, 0j, 0j)
    if left := _FUNCTION.sub("", text).replace(",", "").strip():
        raise ValueError(f"has a transform that is not read: {left[:40]!r}")
    for name, values in _FUNCTION.findall(text):
        try:
            whole = _after(whole, _function(name, _numbers(values)))
        except (TypeError, IndexError):
            raise ValueError(f"has a transform that is not read: {name}({values})") from None
    return whole


def _function(name: str, values: Sequence[float]) -> Map:
    """The map of one function of a transform."""
    if name == "matrix":
        return _matrix(*values)
    if name == "translate":
        return 1 + 0j, 0j, complex(*values)
    if name == "scale":
        return _matrix(values[0], 0, 0, values[-1])
    tangent = math.tan(math.radians(values[0]))
    if name == "skewX":
        return _matrix(1, 0, tangent, 1)
    if name == "skewY":
        return _matrix(1, tangent, 0, 1)
    turn = cmath.exp(1j * math.radians(values[0]))
    centre = complex(*values[1:])
    return turn, 0j, centre - turn * centre


# ---- curves ------------------------------------------------------------------------------------------------------------


@dataclass
class _Pen:
    """Draws chains; places are those of the drawing, which its map makes mm."""

    tolerance: float  # mm, of chords
    map: Map = (1 + 0j, 0j, 0j)
    chains: list[Chain] = field(default_factory=list)
    chords: int = 0
    at: complex = 0j
    start: complex = 0j
    points: list[complex] = field(default_factory=list)  # mm
    bulges: list[float] = field(default_factory=list)

    def image(self, z: complex) -> complex:
        """The place in mm; OverflowError beyond all drawings."""
        p, q, r = self.map
        image = p * z + q * z.conjugate() + r
        if not abs(image) < _BEYOND:
            raise OverflowError("has a coordinate beyond 1 km: is the unit wrong?")
        return image

    def move(self, z: complex) -> None:
        """Begin another chain."""
        self.end()
        self.at = self.start = z

    def line(self, z: complex) -> None:
        """A straight edge."""
        self._add([self.image(z)], 0.0)
        self.at = z

    def cubic(self, b: complex, c: complex, d: complex) -> None:
        """A Bezier curve: |z''| is at most six times a second difference of its corners."""
        corners = [self.image(z) for z in (self.at, b, c, d)]
        bend = max(abs(corners[k] - 2 * corners[k + 1] + corners[k + 2]) for k in (0, 1))
        count = self._count(math.sqrt(6 * bend / (8 * self.tolerance)))
        t = np.arange(1, count + 1) / count
        powers = ((1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t**2 * (1 - t), t**3)
        z = sum(corner * power for corner, power in zip(corners, powers, strict=True))
        self._add(np.asarray(z).tolist(), 0.0)
        self.at = d

    def arc(self, centre: complex, a: complex, b: complex, span: tuple[float, float]) -> None:
        """An arc c + a cos t + b sin t of an ellipse, t over the span, rad."""
        start, sweep = span
        middle = self.image(centre)
        p, q, _ = self.map
        a, b = (p * each + q * each.conjugate() for each in (a, b))
        side = 1 if (a.conjugate() * b).imag > 0 else -1
        round_ = abs(b - side * 1j * a) <= 1e-9 * abs(a)
        chords = abs(sweep) * math.sqrt((abs(a) + abs(b)) / (8 * self.tolerance))
        count = 2 if round_ else max(6, self._count(chords))
        t = start + sweep * np.arange(1, count + 1) / count
        bulge = math.tan(side * sweep / count / 4) if round_ else 0.0
        self._add((middle + a * np.cos(t) + b * np.sin(t)).tolist(), bulge)
        self.at = centre + 0j

    def end(self, closed: bool = False) -> None:
        """End the chain, with the edge back to its start where it is closed."""
        if closed and self.points and abs(self.points[-1] - self.points[0]) > SAME_POINT:
            self.line(self.start)
        if len(self.points) > 1:
            points = np.array(self.points)
            shut = abs(points[-1] - points[0]) <= SAME_POINT
            self.chains.append(Chain(points, np.array(self.bulges), bool(shut)))
        self.at = self.start
        self.points = []
        self.bulges = []

    def _count(self, chords: float) -> int:
        """How many chords so many are; OverflowError where the drawing takes too many."""
        self.chords += max(1, math.ceil(min(chords, 2 * _MOST_CHORDS)))
        if self.chords > _MOST_CHORDS:
            raise OverflowError(f"has curves of more than {_MOST_CHORDS:,} chords: simplify them")
        return max(1, math.ceil(chords))

    def _add(self, points: Sequence[complex], bulge: float) -> None:
        """Edges of one bulge to these points, mm."""
        if not self.points:
            self.points = [self.image(self.at)]
        self.points += points
        self.bulges += [bulge] * len(points)


def _draw(pen: _Pen, kind: str, element: ElementTree.Element) -> None:
    """Draw an element that is a curve."""

    def size(key: str, default: float = 0.0) -> float:
        values = _numbers(element.get(key, "").removesuffix("px"))
        return values[0] if values else default

    if kind == "path":
        _path(pen, element.get("d", ""))
    elif kind in ("polygon", "polyline"):
        values = _numbers(element.get("points", ""))
        if len(values) % 2:
            raise ValueError(f"has a {kind} with an odd number of coordinates")
        pairs = zip(values[::2], values[1::2], strict=True)
        _polygon(pen, [complex(*pair) for pair in pairs], kind == "polygon")
    elif kind == "line":
        _polygon(pen, [complex(size("x1"), size("y1")), complex(size("x2"), size("y2"))], False)
    elif kind in ("circle", "ellipse"):
        centre = complex(size("cx"), size("cy"))
        wide = size("r") or size("rx")
        pen.move(centre + wide)
        pen.arc(centre, complex(wide), 1j * (size("r") or size("ry")), (0.0, math.tau))
        pen.end()
    elif kind == "rect":
        low = complex(size("x"), size("y"))
        wide = size("width")
        high = size("height")
        rx = min(size("rx", size("ry")), wide / 2)
        ry = min(size("ry", rx), high / 2)
        _rectangle(pen, low, (wide, high), (rx, ry))


def _polygon(pen: _Pen, corners: Sequence[complex], closed: bool) -> None:
    """Straight edges from corner to corner."""
    if corners:
        pen.move(corners[0])
    for corner in corners[1:]:
        pen.line(corner)
    pen.end(closed)


def _rectangle(
    pen: _Pen, low: complex, size: tuple[float, float], radii: tuple[float, float]
) -> None:
    """A rectangle with round corners, where these radii are not 0."""
    wide, high = size
    rx, ry = radii
    if not rx or not ry:
        corners = [low, low + wide, low + complex(wide, high), low + 1j * high]
        _polygon(pen, corners, True)
        return
    centres = [complex(wide - rx, ry), complex(wide - rx, high - ry), complex(rx, high - ry)]
    pen.move(low + rx)
    for k, centre in enumerate([*centres, complex(rx, ry)]):
        begin = (k - 1) * math.pi / 2
        pen.line(low + centre + complex(rx * math.cos(begin), ry * math.sin(begin)))
        pen.arc(low + centre, complex(rx), 1j * ry, (begin, math.pi / 2))
    pen.end(closed=True)


def _path(pen: _Pen, text: str) -> None:
    """Draw a path's data."""
    if left := _COMMAND.sub("", text).strip():
        raise ValueError(f"has a path that is not read: {left[:40]!r}")
    before = ("", 0j)  # the last command, and the last corner of its Bezier curve
    for letter, rest in _COMMAND.findall(text):
        kind = letter.upper()
        for k, values in enumerate(_arguments(kind, rest)):
            name = "L" if kind == "M" and k else kind
            before = (name, _step(pen, name, values, before, letter.islower()))
    pen.end()


def _arguments(kind: str, text: str) -> Iterator[list[float]]:
    """Numbers of a command, by its repetitions; flags of an arc need no space between."""
    count = _COUNTS[kind]
    if kind == "A":
        rows = [[float(each) for each in row] for row in _ARC.findall(text)]
        if not rows or _ARC.sub("", text).replace(",", "").strip():
            raise ValueError(f"has a path with an arc that is not read: A{text[:40]}")
        yield from rows
        return
    values = _numbers(text)
    if not count and not values:
        yield []
        return
    if not count or not values or len(values) % count:
        raise ValueError(f"has a path whose {kind} is followed by {len(values)} numbers")
    yield from (values[k : k + count] for k in range(0, len(values), count))


def _step(
    pen: _Pen, kind: str, values: Sequence[float], before: tuple[str, complex], relative: bool
) -> complex:
    """One step of a path; the last corner of its Bezier curve, which a smooth one after it mirrors."""
    origin = pen.at if relative else 0j
    if kind == "Z":
        pen.end(closed=True)
        return pen.at
    if kind in "HV":
        across = complex(values[0] + origin.real, pen.at.imag)
        pen.line(across if kind == "H" else complex(pen.at.real, values[0] + origin.imag))
        return pen.at
    if kind == "A":
        _elliptic(pen, values, origin + complex(*values[5:]))
        return pen.at
    z = [origin + complex(x, y) for x, y in zip(values[::2], values[1::2], strict=True)]
    if kind in "ML":
        (pen.move if kind == "M" else pen.line)(z[0])
        return pen.at
    smooth = {"S": "CS", "T": "QT"}.get(kind, "")
    if smooth:
        mirrored = 2 * pen.at - before[1] if before[0] and before[0] in smooth else pen.at
        z = [mirrored, *z]
    start = pen.at
    if kind in "CS":
        pen.cubic(*z)
        return z[1]
    corner, end = z
    pen.cubic(start + 2 / 3 * (corner - start), end + 2 / 3 * (corner - end), end)
    return corner


def _elliptic(pen: _Pen, values: Sequence[float], end: complex) -> None:
    """An arc of a path by its ends, after SVG 1.1, F.6.5 and F.6.6."""
    rx, ry, angle, large, left = (abs(values[0]), abs(values[1]), *values[2:5])
    start = pen.at
    if start == end:
        return
    if not rx or not ry:
        pen.line(end)
        return
    turn = cmath.exp(1j * math.radians(angle))
    half = (start - end) / 2 / turn
    unit = complex(half.real / rx, half.imag / ry)
    grow = max(1.0, abs(unit))
    rx *= grow
    ry *= grow
    unit /= grow
    off = math.sqrt(max(0.0, 1 / abs(unit) ** 2 - 1)) * (1 if large == left else -1)
    middle = 1j * off * unit
    centre = turn * complex(rx * middle.real, ry * middle.imag) + (start + end) / 2
    first = cmath.phase(unit - middle)
    sweep = (cmath.phase(-unit - middle) - first) % math.tau
    if not left:
        sweep -= math.tau
    pen.arc(centre, turn * rx, turn * 1j * ry, (first, sweep))
    pen.at = end
