"""Exact planar outlines: lines, arcs and smooth curves, joined into closed contours and regions.

Points are complex numbers x + iy, mm, so a turn is a product and a mirror image a conjugate.

    piece     one Line, Arc or Smooth curve, run from `t0` to `t1`
    contour   pieces end to end, closed; counter-clockwise round material, whichever way round a hole
    region    an outer contour less its holes

A piece answers `at(t, order)` with the point (order 0) or its derivatives to t (1, 2); everything else
(length, area, facets, arcs) follows from that one callable.

No number of a piece is -0: it equals 0, so a result that is kept for equal outlines would have the sign of whichever came first.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from camgen.numerics import Floats as Floats
from camgen.numerics import Points as Points
from camgen.numerics import distinct, gauss_legendre
from camgen.tolerances import SAME_POINT

_CONGRUENT = (
    1e-12  # share of its size by which an image may differ from the curve and still have its facets
)
_GAUSS_NODES, _GAUSS_WEIGHTS = gauss_legendre(16)


@dataclass(frozen=True)
class Line:
    """Straight piece from a to b; t runs from 0 to 1."""

    a: complex
    b: complex
    t0 = 0.0
    t1 = 1.0

    def __post_init__(self) -> None:
        _set(self, a=complex(self.a) + 0j, b=complex(self.b) + 0j)

    def at(self, t: Any, order: int = 0) -> Points:
        """Point or derivative at t, (n,) complex."""
        t = np.asarray(t, float)
        if order == 0:
            return np.asarray(self.a * (1 - t) + self.b * t, complex)
        return np.full(t.shape, self.b - self.a if order == 1 else 0, complex)

    def reversed(self) -> Line:
        """The same points run the other way."""
        return Line(self.b, self.a)

    def moved(self, turn: complex = 1, shift: complex = 0, mirror: bool = False) -> Line:
        """Image under z -> turn * z + shift, of the conjugate when mirror."""
        return Line(_image(self.a, turn, shift, mirror), _image(self.b, turn, shift, mirror))


@dataclass(frozen=True)
class Arc:
    """Circular piece; t is the polar angle about the centre, from `start` to `start + sweep` (sweep < 0: clockwise)."""

    centre: complex
    radius: float
    start: float
    sweep: float

    def __post_init__(self) -> None:
        _set(self, centre=complex(self.centre) + 0j, start=self.start + 0.0)

    @property
    def t0(self) -> float:
        """Polar angle of the first point."""
        return self.start

    @property
    def t1(self) -> float:
        """Polar angle of the last point."""
        return self.start + self.sweep

    def at(self, t: Any, order: int = 0) -> Points:
        """Point or derivative to the polar angle at t, (n,) complex."""
        spoke = self.radius * np.exp(1j * np.asarray(t, float))
        return np.asarray(self.centre + spoke if order == 0 else 1j**order * spoke)

    def reversed(self) -> Arc:
        """The same points run the other way."""
        return Arc(self.centre, self.radius, self.start + self.sweep, -self.sweep)

    def moved(self, turn: complex = 1, shift: complex = 0, mirror: bool = False) -> Arc:
        """Image under z -> turn * z + shift, of the conjugate when mirror; turn may scale."""
        sign = -1 if mirror else 1
        return Arc(
            _image(self.centre, turn, shift, mirror),
            self.radius * abs(turn),
            sign * self.start + cmath.phase(turn),
            sign * self.sweep,
        )


@dataclass(frozen=True)
class Smooth:
    """Smooth piece: `function(t, order)` gives points and derivatives of order 0..2 for t between t0 and t1.

    The curvature has no jump inside; a joint with a jump belongs between two pieces. t1 < t0 runs backwards.
    """

    function: Callable[[Floats, int], Points]
    t0: float
    t1: float
    # growing parameters at which the slope of the curvature may jump; those outside of the piece count for nothing
    knots: tuple[float, ...] = ()
    # the curve of which this one is a congruent image; None where it is its own
    origin: Smooth | None = field(default=None, compare=False, repr=False)
    # facets of any of its images, by t0, t1 and tolerance
    known: dict[tuple[float, float, float], Floats] = field(
        default_factory=dict, compare=False, repr=False
    )
    # ends and deviations of the biarcs along any of its images, by the same
    fitted: dict[tuple[float, float, float], tuple[Floats, Floats]] = field(
        default_factory=dict, compare=False, repr=False
    )

    def __post_init__(self) -> None:
        _set(self, t0=self.t0 + 0.0, t1=self.t1 + 0.0)

    def spread(self, count: int) -> Floats:
        """Parameters from t0 to t1, evenly spread, and the knots between them; (count,) and more."""
        even = np.linspace(self.t0, self.t1, count)
        low = min(self.t0, self.t1)
        high = max(self.t0, self.t1)
        inside = [t for t in self.knots if low < t < high]
        if not inside:
            return even
        both = distinct(even, inside)
        return both if self.t0 < self.t1 else both[::-1]

    def at(self, t: Any, order: int = 0) -> Points:
        """Point or derivative at t, (n,) complex."""
        return self.function(np.asarray(t, float), order)

    def reversed(self) -> Smooth:
        """The same points run the other way."""
        return replace(self, t0=self.t1, t1=self.t0)

    def moved(self, turn: complex = 1, shift: complex = 0, mirror: bool = False) -> Smooth:
        """Image under z -> turn * z + shift, of the conjugate when mirror."""
        inner = self.function

        def image(t: Floats, order: int) -> Points:
            z = inner(t, order)
            return turn * (np.conj(z) if mirror else z) + (shift if order == 0 else 0)

        if abs(abs(turn) - 1) > _CONGRUENT:
            return replace(self, function=image, origin=None, known={}, fitted={})
        return replace(self, function=image, origin=self.origin or self)


Piece = Line | Arc | Smooth


def _set(piece: Piece, **values: complex) -> None:
    """Set fields of a frozen piece as it is made."""
    for name, value in values.items():
        object.__setattr__(piece, name, value)


def _image(z: complex, turn: complex, shift: complex, mirror: bool) -> complex:
    return turn * (z.conjugate() if mirror else z) + shift


def start_point(piece: Piece) -> complex:
    """First point of a piece."""
    return piece.a if isinstance(piece, Line) else complex(piece.at(piece.t0))


def end_point(piece: Piece) -> complex:
    """Last point of a piece."""
    return piece.b if isinstance(piece, Line) else complex(piece.at(piece.t1))


def _integral(piece: Piece, integrand: Callable[[Points, Points], Floats]) -> float:
    """Integral of integrand(point, derivative) dt along a piece.

    Gauss-Legendre of 16 points on panels that are doubled until the sum settles to 1e-14 of its size; exact on a line.
    """
    panels = 1 if isinstance(piece, Line) else 8
    last = math.nan
    while True:
        edges = (
            piece.spread(panels + 1)
            if isinstance(piece, Smooth)
            else np.linspace(piece.t0, piece.t1, panels + 1)
        )
        half = (edges[1:] - edges[:-1]) / 2
        t = (edges[:-1] + half)[:, None] + half[:, None] * _GAUSS_NODES
        value = float(
            np.sum(half[:, None] * _GAUSS_WEIGHTS * integrand(piece.at(t), piece.at(t, 1)))
        )
        if isinstance(piece, Line) or abs(value - last) <= 1e-14 * abs(value) or panels >= 256:
            return value
        panels = 2 * panels
        last = value


def _fan(piece: Piece, origin: complex) -> float:
    """Signed area between a piece and its rays from the origin, mm^2; of lines and arcs in closed form."""
    if isinstance(piece, Line):
        return 0.5 * ((piece.a - origin).conjugate() * (piece.b - origin)).imag
    if isinstance(piece, Arc):
        chord = cmath.rect(piece.radius, piece.t1) - cmath.rect(piece.radius, piece.t0)
        return 0.5 * (
            piece.radius**2 * piece.sweep + ((piece.centre - origin).conjugate() * chord).imag
        )
    return 0.5 * _integral(piece, lambda z, dz: np.imag(np.conj(z - origin) * dz))


@dataclass(frozen=True)
class Contour:
    """A closed sequence of pieces, each beginning where the one before it ends (within SAME_POINT)."""

    pieces: tuple[Piece, ...]

    def __post_init__(self) -> None:
        starts = [start_point(piece) for piece in self.pieces]
        size = max(1.0, *map(abs, starts))
        for piece, following in zip(self.pieces, starts[1:] + starts[:1], strict=True):
            end = end_point(piece)
            gap = abs(end - following)
            if not gap <= SAME_POINT * size:
                raise ValueError(f"contour has a gap of {gap:.3g} mm at {end:.6g}")

    @cached_property
    def area(self) -> float:
        """Signed area, mm^2, positive when counter-clockwise (Green's theorem)."""
        origin = start_point(self.pieces[0])
        return sum(_fan(piece, origin) for piece in self.pieces)

    @cached_property
    def centroid(self) -> complex:
        """Centre of the enclosed area, mm."""
        origin = start_point(self.pieces[0])

        def moment(part: Callable[[Points], Floats]) -> float:
            return sum(
                _integral(p, lambda z, dz: part(z - origin) * np.imag(np.conj(z - origin) * dz))
                for p in self.pieces
            )

        return origin + complex(moment(np.real), moment(np.imag)) / (3 * self.area)

    @cached_property
    def length(self) -> float:
        """Length, mm."""
        return sum(abs(_integral(p, lambda z, dz: np.abs(dz))) for p in self.pieces)

    def reversed(self) -> Contour:
        """The same points run the other way."""
        return Contour(tuple(p.reversed() for p in reversed(self.pieces)))

    def moved(self, turn: complex = 1, shift: complex = 0, mirror: bool = False) -> Contour:
        """Image under z -> turn * z + shift (of the conjugate when mirror), run so that the sense of turning is kept."""
        image = Contour(tuple(p.moved(turn, shift, mirror) for p in self.pieces))
        return image.reversed() if mirror else image

    def counter_clockwise(self) -> Contour:
        """The contour run counter-clockwise."""
        return self if self.area > 0 else self.reversed()


@dataclass(frozen=True)
class Region:
    """Flat material: the inside of `outer` less the insides of `holes`."""

    outer: Contour
    holes: tuple[Contour, ...] = ()

    @property
    def area(self) -> float:
        """Area, mm^2."""
        return abs(self.outer.area) - sum(abs(hole.area) for hole in self.holes)

    @property
    def length(self) -> float:
        """Length of all edges, mm."""
        return self.outer.length + sum(hole.length for hole in self.holes)

    def moved(self, turn: complex = 1, shift: complex = 0, mirror: bool = False) -> Region:
        """Image under z -> turn * z + shift, of the conjugate when mirror."""
        return Region(
            self.outer.moved(turn, shift, mirror),
            tuple(h.moved(turn, shift, mirror) for h in self.holes),
        )


def circle(centre: complex, radius: float) -> Contour:
    """A full circle, counter-clockwise from its rightmost point."""
    return Contour((Arc(complex(centre), radius, 0.0, 2 * math.pi),))


def polygon(points: Sequence[complex]) -> Contour:
    """Straight contour through the points, in their order."""
    ring = [complex(z) for z in points]
    return Contour(tuple(Line(a, b) for a, b in zip(ring, ring[1:] + ring[:1], strict=True)))


def bulged(points: Points, bulges: Floats) -> Contour:
    """Contour of straight edges and arcs: points (n,) complex mm, and for the edge from each to the next tan(sweep / 4), (n,)."""
    pieces: list[Piece] = []
    for a, b, t in zip(points.tolist(), np.roll(points, -1).tolist(), bulges.tolist(), strict=True):
        if t == 0:
            pieces.append(Line(a, b))
            continue
        centre = (a + b) / 2 + 0.5j * (b - a) * (1 - t * t) / (2 * t)
        pieces.append(Arc(centre, abs(a - centre), cmath.phase(a - centre), 4 * math.atan(t)))
    return Contour(tuple(pieces))


def rectangle(low: complex, high: complex) -> Contour:
    """The rectangle between two corners, mm; the first one is the lower left."""
    return polygon([low, complex(high.real, low.imag), high, complex(low.real, high.imag)])


def kidney(
    centre: complex, radius: float, half_width: float, start: float, sweep: float
) -> Contour:
    """Arc slot: all points within half_width of an arc about `centre` (rad, sweep > 0), counter-clockwise."""
    first = centre + radius * cmath.exp(1j * start)
    last = centre + radius * cmath.exp(1j * (start + sweep))
    return Contour(
        (
            Arc(centre, radius + half_width, start, sweep),
            Arc(last, half_width, start + sweep, math.pi),
            Arc(centre, radius - half_width, start + sweep, -sweep),
            Arc(first, half_width, start + math.pi, math.pi),
        )
    )


def extent(contours: Sequence[Contour]) -> tuple[complex, complex]:
    """Lower left and upper right corner of the box round contours of lines and arcs, complex mm, exact."""
    pieces = [piece for contour in contours for piece in contour.pieces]
    others = [piece for piece in pieces if not isinstance(piece, Arc)]
    points = [end for piece in others for end in (start_point(piece), end_point(piece))]
    arcs = [piece for piece in pieces if isinstance(piece, Arc)]
    quarter = math.pi / 2
    for arc in arcs:
        low, high = sorted((arc.t0, arc.t1))
        turns = range(math.ceil(low / quarter), math.floor(high / quarter) + 1)
        points += [arc.centre + arc.radius * 1j ** (k % 4) for k in turns]
    centres = np.array([arc.centre for arc in arcs], complex)
    radii = np.array([arc.radius for arc in arcs])
    ends = np.array([(arc.t0, arc.t1) for arc in arcs]).reshape(-1, 2).T
    points += (centres + radii * np.exp(1j * ends)).ravel().tolist()
    z = np.array(points)
    return complex(z.real.min(), z.imag.min()), complex(z.real.max(), z.imag.max())
