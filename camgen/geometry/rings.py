"""Flat shapes as the judge holds them: rings of straight edges and arcs, and circles fitted to them.

    ring     closed outline: the vertices and, per edge, the DXF bulge tan(sweep / 4)
    shape    flat material: an outer ring, counter-clockwise, less its holes

Points of the plane are complex numbers x + iy, mm.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from camgen.errors import counted
from camgen.numerics import Floats as Floats
from camgen.numerics import Points as Points
from camgen.numerics import least_squares, magnitude

Ints = NDArray[np.int64]

_MOST_FACETS = 5_000_000  # of one ring: beyond it no memory serves


@dataclass(frozen=True)
class Ring:
    """Closed outline: edge i runs from points[i] to points[i + 1], the last one back to points[0]."""

    points: Points  # (n,) complex mm
    bulges: Floats  # (n,) tan(sweep / 4), 0 for a straight edge, positive where it turns left

    @classmethod
    def straight(cls, points: Points) -> Ring:
        """With straight edges alone; points: (n,) complex mm."""
        return cls(points, np.zeros(len(points)))

    @property
    def ends(self) -> Points:
        """Last point of each edge, (n,)."""
        return np.concatenate([self.points[1:], self.points[:1]])

    @cached_property
    def area(self) -> float:
        """Signed area, mm^2, positive when counter-clockwise; arcs counted exactly."""
        a = self.points - self.points[0]
        b = self.ends - self.points[0]
        return float(np.sum(np.imag(np.conj(a) * b) / 2 + self._caps()))

    @cached_property
    def centroid(self) -> complex:
        """Centre of the enclosed area, mm; arcs counted exactly."""
        a = self.points - self.points[0]
        b = self.ends - self.points[0]
        if not self.bulges.any():
            triangles = np.imag(np.conj(a) * b) / 2
            return complex(self.points[0] + np.sum(triangles * (a + b) / 3) / np.sum(triangles))
        half = 2 * np.arctan(self.bulges)
        flat = np.abs(half) < 0.02
        safe = np.where(flat, 1.0, half)
        # A cap's centre above its chord as a share of its height; a flat one is a parabola's, 2/5.
        share = (
            2 * np.sin(safe) ** 3 / (3 * (safe - np.sin(safe) * np.cos(safe))) - np.cos(safe)
        ) / (1 - np.cos(safe))
        above = (a + b) / 2 - np.where(flat, 0.4, share) * 0.5j * self.bulges * (b - a)
        triangles = np.imag(np.conj(a) * b) / 2
        caps = self._caps()
        moment = np.sum(triangles * (a + b) / 3 + caps * above)
        return complex(self.points[0] + moment / np.sum(triangles + caps))

    def _caps(self) -> Floats:
        """Signed area between each edge's arc and its chord, mm^2, (n,)."""
        t = self.bulges
        if not t.any():
            return np.zeros(t.shape)
        straight = np.abs(t) < 0.01
        safe = np.where(straight, 1.0, t)
        # Per chord^2; the series serves where the closed form would cancel.
        exact = ((1 + safe**2) ** 2 * np.arctan(safe) - safe * (1 - safe**2)) / (8 * safe**2)
        cap = np.where(straight, t / 3 + t**3 / 15 - t**5 / 105, exact)
        return np.asarray(cap * np.abs(self.ends - self.points) ** 2)

    @cached_property
    def length(self) -> float:
        """Length, mm."""
        return float(
            np.sum(np.abs(self.ends - self.points) / np.sinc(2 * np.arctan(self.bulges) / np.pi))
        )

    @property
    def box(self) -> tuple[float, float, float, float]:
        """Least x and y, greatest x and y, mm; arcs counted exactly."""
        arcs = self.bulges != 0
        a = self.points[arcs]
        b = self.ends[arcs]
        t = self.bulges[arcs]
        centre = (a + b) / 2 + 0.5j * (b - a) * (1 - t * t) / (2 * t)
        compass = np.array([1, 1j, -1, -1j])
        # An extreme of the circle lies on the arc when it is passed before the end is.
        angle = np.angle(compass[:, None] / (a - centre)) * np.sign(t) % (2 * np.pi)
        extremes = (centre + compass[:, None] * np.abs(a - centre))[
            angle <= 4 * np.arctan(np.abs(t))
        ]
        z = np.concatenate([self.points, extremes])
        return float(z.real.min()), float(z.imag.min()), float(z.real.max()), float(z.imag.max())

    def reversed(self) -> Ring:
        """The same outline run the other way."""
        return Ring(self.points[::-1], -np.roll(self.bulges[::-1], -1))

    def counter_clockwise(self) -> Ring:
        """The outline run counter-clockwise."""
        return self if self.area > 0 else self.reversed()

    def moved(self, turn: complex = 1, shift: complex = 0, mirror: bool = False) -> Ring:
        """Image under z -> turn * z + shift, of the conjugate when mirror; the sense of turning is kept.

        The flip about Oy, z -> -conj(z), is turn = -1 with mirror.
        """
        if mirror:
            return Ring(turn * np.conj(self.points) + shift, -self.bulges).reversed()
        return Ring(turn * self.points + shift, self.bulges)

    def facetted(self, tolerance: float) -> Points:
        """Vertices (m,) complex of a polygon inscribed in the outline, its chords within `tolerance` mm of the arcs.

        OverflowError where that takes millions of chords.
        """
        if not self.bulges.any():
            return self.points
        sweep = 4 * np.arctan(self.bulges)
        chord = self.ends - self.points
        radius = np.abs(chord) / np.where(sweep == 0, 1, 2 * np.abs(np.sin(sweep / 2)))
        step = 2 * np.arccos(np.maximum(1 - tolerance / np.maximum(radius, tolerance), 0.0))
        step = np.minimum(step, np.pi / 3)  # six chords on a full circle, however small it is
        with np.errstate(divide="ignore", invalid="ignore"):  # a radius without a tolerance
            needed = np.where(sweep == 0, 1.0, np.maximum(np.ceil(np.abs(sweep) / step), 1.0))
        if not needed.sum() <= _MOST_FACETS:
            raise OverflowError(
                f"more than {_MOST_FACETS} chords within {tolerance:g} mm of an outline, the most that are made"
            )
        count = needed.astype(int)
        edge = np.repeat(np.arange(len(count)), count)
        half = sweep[edge] / 2
        u = (np.arange(len(edge)) - np.repeat(np.cumsum(count) - count, count)) / count[edge]
        along = u * np.sinc(u * half / np.pi) / np.sinc(half / np.pi)
        return np.asarray(self.points[edge] + chord[edge] * along * np.exp(1j * half * (u - 1)))

    def samples(self) -> Points:
        """Vertices, and on each arc seven points between its ends in equal steps, (m,) complex."""
        half = 2 * np.arctan(self.bulges)
        arcs = half != 0
        u = np.arange(1, 8)[:, None] / 8
        along = u * np.sinc(u * half[arcs] / np.pi) / np.sinc(half[arcs] / np.pi)
        inner = self.points[arcs] + (self.ends - self.points)[arcs] * along * np.exp(
            1j * half[arcs] * (u - 1)
        )
        return np.concatenate([self.points, inner.ravel()])

    def encloses(self, z: complex) -> bool:
        """Whether z lies inside (arcs facetted to a thousandth of the outline's size, at most 0.01 mm)."""
        left, low, right, high = self.box
        a = self.facetted(min(1e-3 * max(right - left, high - low), 0.01)) - z
        b = np.roll(a, -1)
        crosses = (a.imag > 0) != (b.imag > 0)
        side = np.imag(np.conj(a) * b)[crosses] > 0
        return bool(np.count_nonzero(side == (b.imag > a.imag)[crosses]) % 2)


@dataclass(frozen=True)
class Shape:
    """Flat material: the inside of `outer` (counter-clockwise) less its holes."""

    outer: Ring
    holes: tuple[Ring, ...]

    @property
    def area(self) -> float:
        """Area, mm^2."""
        return self.outer.area - sum(abs(hole.area) for hole in self.holes)

    def moved(self, turn: complex = 1, shift: complex = 0, mirror: bool = False) -> Shape:
        """Image under z -> turn * z + shift, of the conjugate when mirror."""
        image = (ring.moved(turn, shift, mirror) for ring in self.holes)
        return Shape(self.outer.moved(turn, shift, mirror), tuple(image))


def shape_of(rings: Sequence[Ring]) -> Shape:
    """The one flat part that the rings bound: the largest is the outside, all others are its holes.

    ValueError when there is no ring, or when one lies outside the largest (more than one part).
    """
    if not rings:
        raise ValueError("no closed contour")
    outer, *holes = sorted(rings, key=lambda ring: -abs(ring.area))
    outside = sum(not outer.encloses(complex(hole.points[0])) for hole in holes)
    if outside:
        raise ValueError(f"{counted(outside, 'contour')} outside the largest one")
    return Shape(outer.counter_clockwise(), tuple(holes))


# ---- circles -----------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Circle:
    """Circle through measured points: centre, diameter, the points' largest distance from it, the free diameter.

    `clear_diameter` is the largest pin about the centre that passes: for a facetted hole whose vertices lie on the
    circle it is the diameter between flats, for a shaft with a flat twice the flat's distance. All in mm.
    """

    centre: complex
    diameter: float
    deviation: float
    clear_diameter: float


def fit_circle(points: Points, weights: Floats | None = None) -> tuple[complex, float, float]:
    """Centre, radius and largest deviation, mm, of the circle of least squares through (n,) complex points; weights: (n,), how
    much each counts, all the same unless given.

    Algebraic fit [Kasa 1976], then Gauss-Newton on the true distances. nan for fewer than three points.
    """
    if len(points) < 3:
        return complex(np.nan, np.nan), np.nan, np.nan
    root_weight = np.ones(len(points)) if weights is None else np.sqrt(weights / weights.max())
    origin = points.mean()
    z = points - origin
    table = np.column_stack([2 * z.real, 2 * z.imag, np.ones(len(z))])
    x, y, c = least_squares(root_weight[:, None] * table, root_weight * np.abs(z) ** 2)
    centre = complex(x, y)
    radius = float(np.sqrt(max(c + x * x + y * y, 0.0)))
    for _ in range(8):
        spoke = z - centre
        distance = np.abs(spoke)
        table = np.column_stack([spoke.real / distance, spoke.imag / distance, np.ones(len(z))])
        dx, dy, dr = least_squares(root_weight[:, None] * table, root_weight * (distance - radius))
        centre = centre + complex(dx, dy)
        radius = radius + float(dr)
        if abs(complex(dx, dy)) + abs(dr) < 1e-15 * radius:
            break
    return complex(centre + origin), radius, magnitude(np.abs(z - centre) - radius)


def _circle(ring: Ring, points: Points, weights: Floats | None = None) -> Circle:
    centre, radius, deviation = fit_circle(points, weights)
    a = ring.points - centre
    b = ring.ends - centre
    u = np.clip(-np.real(np.conj(b - a) * a) / np.abs(b - a) ** 2, 0, 1)
    reach = np.where(ring.bulges == 0, np.abs(a + u * (b - a)), np.abs(a))
    nearest = min(float(reach.min()), float(np.abs(ring.samples() - centre).min()))
    return Circle(centre, 2 * radius, deviation, 2 * nearest)


def hole_circles(shape: Shape) -> list[Circle]:
    """For each hole, in order, the circle through its vertices (and through points of its arcs)."""
    return [_circle(hole, hole.samples()) for hole in shape.holes]


def bore_circle(ring: Ring, nominal_diameter: float) -> Circle:
    """Circle of a bore's round part; corners of a keyway, which lie off it, are left out.

    Starts from the nominal circle about the datum, which a sound bore is near, and draws the band of points that count
    tighter with each fit. A vertex counts as much as its edges are long, so that many on a corner which a nozzle rounds do not
    draw the circle to it.
    """
    points = ring.samples()
    edges = np.abs(ring.ends - ring.points)
    weights = np.ones(len(points)) if ring.bulges.any() else edges + np.roll(edges, 1)
    centre = 0j
    radius = nominal_diameter / 2
    for fraction in (0.1, 0.03, 0.01, 0.003, 0.001):
        misfit = np.abs(np.abs(points - centre) - radius)
        core = np.flatnonzero(misfit <= fraction * nominal_diameter)
        if len(core) < 4:  # far from the nominal one: what lies best
            core = np.argsort(misfit, kind="stable")[: max(len(points) // 2, 4)]
        centre, radius, deviation = fit_circle(points[core], weights[core])
    on_circle = np.abs(np.abs(points - centre) - radius) <= max(
        2 * deviation, 1e-6 * nominal_diameter
    )
    return _circle(ring, points[on_circle], weights[on_circle])
