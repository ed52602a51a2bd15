"""A roller in the track of a drum, from the drum's triangles alone: how low and how high the roller can lie at every angle.

The drum turns about z; where the roller stands, x runs along it, outwards, y beside it, and z along the drum's axis. The roller
is a cylinder or a cone of the radius R(x) between its ends, its axis at y = Y and the height sought. A point (x, y, z) of the wall below
keeps the axis at

    z + sqrt(R(x)^2 - (y - Y)^2)

or higher. On a triangle that is concave, and linear on each line through the apex of the cone (along x, of a cylinder); so its
largest value on the triangle, cut at both ends of the roller, is on an edge of what is left. On an edge it is at an end or where
its derivative is 0, which is a quadratic: exact, and without iteration. The wall above is the mirror image.

Between two samples a bound is above its chord by at most M h^2 / 8: it is the largest of functions of single points, each of
which bends downwards by at most M = rho^2 / (R cos(alpha)^3), alpha the pressure angle.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from camgen.geometry.mesh import Mesh, joined_by_edges
from camgen.numerics import Floats, distinct

Ints = np.ndarray[tuple[int, ...], np.dtype[np.int64]]

_FLAT = 0.2  # part of a unit normal along the axis from which a triangle may be a wall
_SHARE = 0.25  # of the ring beyond the roller's inner end, that a wall covers at least
_PAIRS = 1_000_000  # of angle and triangle that are treated at once
_ROUNDS = 40  # of an arm, whose roller moves sideways as it rises
_SAME = 1e-7  # mm
_LEVEL = 0.2  # slope, below which a secant is not trusted


@dataclass(frozen=True)
class SolidRoller:
    """Ends of a roller by their distance from the drum's axis, its radius half way between them, mm, and its slope."""

    inner: float
    outer: float
    radius: float
    slope: float = 0.0

    def at(self, x: Floats) -> Floats:
        """Its radius at the distance x from the drum's axis."""
        return self.radius + (x - (self.inner + self.outer) / 2) * self.slope

    @property
    def largest(self) -> float:
        """Its largest radius, mm."""
        return self.radius + abs(self.slope) * (self.outer - self.inner) / 2


@dataclass(frozen=True, eq=False)
class Wall:
    """Triangles, joined by edges, that look up (side -1: they lie below a roller) or down."""

    side: int
    rows: Ints  # (m,) of the mesh's faces
    corners: Floats  # (m, 3, 3) mm
    height: float  # of their middle


def walls(mesh: Mesh, inner: float) -> list[Wall]:
    """All that a roller could lie on, from below upwards: round the axis, beyond the distance `inner` from it."""
    corners = mesh.vertices[mesh.faces]
    normals = mesh.across
    size = np.linalg.norm(normals, axis=1)
    distance = np.hypot(corners[..., 0], corners[..., 1])
    found = []
    ring = math.pi * max(float(distance.max(initial=0.0)) ** 2 - inner**2, 0.0)
    beyond = distance.max(axis=1) > inner
    for side in (-1, 1):
        rows = np.flatnonzero(beyond & (-side * normals[:, 2] > _FLAT * size))
        for group in _joined(mesh, rows):
            weight = np.abs(normals[group, 2]) / 2
            if weight.sum() > _SHARE * ring:
                level = float(np.average(corners[group, :, 2].mean(axis=1), weights=weight))
                found.append(Wall(side, group, corners[group], level))
    return sorted(found, key=lambda wall: wall.height)


def _joined(mesh: Mesh, rows: Ints) -> Iterator[Ints]:
    """The triangles of these that hang together by edges."""
    label = joined_by_edges(mesh.faces[rows])
    for each in distinct(label):
        yield rows[label == each]


def limits(
    wall: Wall,
    roller: SolidRoller,
    phi: Floats,
    beside: Callable[[Floats], Floats],
) -> Floats:
    """Height at which the roller lies on the wall, (n,), nan where it meets none.

    phi: (n,) rad, where the roller stands as the drum sees it, even over the turn and rising. beside: Y by the height,
    (n,) mm, nan where an arm does not reach.
    """
    corners = wall.corners * np.array([1.0, 1.0, -wall.side])
    height = np.full(len(phi), roller.radius - wall.side * wall.height)
    offset = beside(-wall.side * height)
    slope = np.full(len(phi), -1.0)  # of the change by the height, of which a secant finds the root
    change = _lowest(corners, roller, phi, offset) - height
    for _ in range(_ROUNDS):
        step = -change / slope
        height = height + step
        before = offset
        offset = beside(-wall.side * height)
        if np.array_equal(offset, before, equal_nan=True):
            break
        last = change
        change = _lowest(corners, roller, phi, offset) - height
        if np.nanmax(np.abs(change), initial=0.0) < _SAME:
            break
        with np.errstate(divide="ignore", invalid="ignore"):
            secant = (change - last) / step
        slope = np.where((secant < -_LEVEL) & (secant > -1 / _LEVEL), secant, -1.0)
    return -wall.side * height


def crossed(
    corners: Floats, roller: SolidRoller, phi: Floats, height: Floats, beside: Floats
) -> NDArray[np.bool_]:
    """Whether the roller, at these heights and so far beside the radial line, cuts any of some triangles at each angle, (n,).

    A triangle keeps the roller out of one interval of heights, since triangle and roller are convex.
    """
    found = np.zeros(len(phi), bool)
    corners = corners[np.hypot(corners[..., 0], corners[..., 1]).max(axis=1) >= roller.inner]
    bottom = corners[..., 2].min(axis=1) - roller.largest
    top = corners[..., 2].max(axis=1) + roller.largest
    for sample, row in _pairs(*_ranges(corners), _window(roller, beside), phi):
        near = (bottom[row] < height[sample]) & (height[sample] < top[row])
        sample = sample[near]
        row = row[near]
        x, y = _turned(corners[row], phi[sample, None])
        aside = y - beside[sample, None]
        meets = _room(x, aside, roller) > 0
        sample = sample[meets]
        placed = np.stack([x, aside, corners[row, :, 2]], axis=-1)[meets]
        upper = _on_triangles(placed, roller)
        lower = -_on_triangles(placed * np.array([1.0, 1.0, -1.0]), roller)
        found[sample[(lower < height[sample]) & (height[sample] < upper)]] = True
    return found


def _window(roller: SolidRoller, beside: Floats) -> float:
    """To either side of the roller's direction, rad, what it can touch."""
    reach = roller.largest + float(np.nanmax(np.abs(beside), initial=0.0))
    return math.pi if reach >= roller.inner else math.asin(reach / roller.inner)


def _lowest(corners: Floats, roller: SolidRoller, phi: Floats, beside: Floats) -> Floats:
    """Least height of the roller above triangles, (n,), nan where it meets none."""
    window = _window(roller, beside)
    lowest = np.full(len(phi), -math.inf)
    points = _each_once(corners)
    angle = np.arctan2(points[:, 1], points[:, 0])
    for sample, row in _pairs(angle, angle, window, phi):
        x, y = _turned(points[row], phi[sample])
        aside = y - beside[sample]
        room = (roller.at(x) - aside) * (roller.at(x) + aside)
        meets = (x >= roller.inner) & (x <= roller.outer) & (room >= 0)
        np.maximum.at(lowest, sample[meets], points[row[meets], 2] + np.sqrt(room[meets]))
    top = corners[..., 2].max(axis=1) + roller.largest
    for sample, row in _pairs(*_ranges(corners), window, phi):
        near = top[row] > lowest[sample]
        sample = sample[near]
        row = row[near]
        x, y = _turned(corners[row], phi[sample, None])
        aside = y - beside[sample, None]
        room = _room(x, aside, roller)
        high = corners[row, :, 2].max(axis=1) + np.sqrt(np.maximum(room, 0.0))
        meets = (room >= 0) & (high > lowest[sample])
        placed = np.stack([x, aside, corners[row, :, 2]], axis=-1)[meets]
        np.maximum.at(lowest, sample[meets], _on_triangles(placed, roller))
    return np.where(np.isfinite(lowest), lowest, math.nan)


def _room(x: Floats, aside: Floats, roller: SolidRoller) -> Floats:
    """R^2 - y^2 of each triangle at most, (n,), by its corners' x and y - Y, (n, 3); below 0 where the roller cannot meet it."""
    nearest = np.maximum(0.0, np.maximum(aside.min(axis=1), -aside.max(axis=1)))
    between = (x.max(axis=1) >= roller.inner) & (x.min(axis=1) <= roller.outer)
    return np.where(between, roller.largest**2 - nearest**2, -1.0)


def _each_once(corners: Floats) -> Floats:
    """Each point once, (n, 3)."""
    return np.unique(corners.reshape(-1, 3), axis=0)


def _turned(points: Floats, phi: Floats) -> tuple[Floats, Floats]:
    """x and y of points in the frame of a roller at phi."""
    cosine = np.cos(phi)
    sine = np.sin(phi)
    return (
        points[..., 0] * cosine + points[..., 1] * sine,
        points[..., 1] * cosine - points[..., 0] * sine,
    )


def _ranges(corners: Floats) -> tuple[Floats, Floats]:
    """First and last polar angle of each triangle, rad; a whole turn of one with the axis in it."""
    z = corners[..., 0] + 1j * corners[..., 1]
    first = np.angle(z[:, 0])
    more = np.angle(z * np.exp(-1j * first)[:, None])
    low = more.min(axis=1)
    high = more.max(axis=1)
    turns = np.angle(np.roll(z, -1, axis=1) * np.conj(z)).sum(axis=1)
    whole = (np.abs(turns) > 1) | (high - low >= math.pi)
    return first + np.where(whole, -math.pi, low), first + np.where(whole, math.pi, high)


def _pairs(first: Floats, last: Floats, window: float, phi: Floats) -> Iterator[tuple[Ints, Ints]]:
    """Samples at which things between two polar angles are within the window, and the things; some at once."""
    step = math.tau / len(phi)
    low = np.ceil((first - window - phi[0]) / step).astype(np.int64)
    high = np.floor((last + window - phi[0]) / step).astype(np.int64)
    count = np.clip(high - low + 1, 0, len(phi))
    total = np.cumsum(count)
    begin = 0
    while begin < len(count):
        before = total[begin - 1] if begin else 0
        end = max(int(np.searchsorted(total, before + _PAIRS)), begin + 1)
        row = np.repeat(np.arange(begin, end), count[begin:end])
        starts = np.repeat(total[begin:end] - count[begin:end] - before, count[begin:end])
        sample = (low[row] + np.arange(len(row)) - starts) % len(phi)
        yield sample, row
        begin = end


def _on_triangles(placed: Floats, roller: SolidRoller) -> Floats:
    """Least height above each triangle, (n, 3, 3) of x, y - Y and z, that the roller meets; -inf where it does not."""
    highest = np.full(len(placed), -math.inf)
    for k in range(3):
        np.maximum(highest, _on_edges(placed[:, k], placed[:, (k + 1) % 3], roller), out=highest)
    for end in (roller.inner, roller.outer):
        beyond = placed[..., 0] >= end
        count = beyond.sum(axis=1)
        rows = np.flatnonzero((count == 1) | (count == 2))
        # the corner that is alone on its side
        lone = np.argmax(beyond[rows] == (count[rows] == 1)[:, None], axis=1)
        a, b, c = (placed[rows, (lone + k) % 3] for k in range(3))
        cuts = [
            a + (other - a) * ((end - a[:, :1]) / (other[:, :1] - a[:, :1])) for other in (b, c)
        ]
        for cut in cuts:
            cut[:, 0] = end
        highest[rows] = np.maximum(highest[rows], _on_edges(cuts[0], cuts[1], roller))
    return highest


def _on_edges(start: Floats, end: Floats, roller: SolidRoller) -> Floats:
    """Largest z + sqrt(R(x)^2 - y^2) on each edge between the roller's ends; -inf where the roller does not meet it.

    With Q = R^2 - y^2 = A t^2 + 2 B t + C and w = A t + B, the derivative is 0 where w^2 (dz^2 - A) = dz^2 (B^2 - A C), w against dz.
    """
    x, y, z = start.T
    dx, dy, dz = (end - start).T
    radius = roller.at(x)
    grows = roller.slope * dx
    low = np.zeros(len(x))
    high = np.ones(len(x))
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        for value, slope in (
            (x - roller.inner, dx),
            (roller.outer - x, -dx),
            (radius - y, grows - dy),
            (radius + y, grows + dy),
        ):
            # value + slope t >= 0
            zero = -value / slope
            low = np.where(slope > 0, np.maximum(low, zero), low)
            high = np.where(slope < 0, np.minimum(high, zero), high)
            high = np.where((slope == 0) & (value < 0), -1.0, high)
        square = grows**2 - dy**2
        linear = radius * grows - y * dy
        constant = radius**2 - y**2
        spread = np.maximum(linear**2 - square * constant, 0.0)
        w = -np.sign(dz) * np.abs(dz) * np.sqrt(spread / (dz**2 - square))
        direct = (w - linear) / square
        other = (linear**2 - dz**2 * constant) / ((dz**2 - square) * (w + linear))
        place = np.where(w * linear > 0, other, direct)
    place = np.where(np.isfinite(place), place, low)
    highest = np.full(len(x), -math.inf)
    for t in (low, high, np.clip(place, low, np.maximum(low, high))):
        r = radius + grows * t
        aside = y + dy * t
        room = np.maximum((r - aside) * (r + aside), 0.0)
        highest = np.maximum(highest, z + dz * t + np.sqrt(room))
    return np.where(low <= high, highest, -math.inf)
