"""Solids of drums: a groove, a rib or an end cam round a cylinder, as rings that all have their points at the same angles.

Each wall is a height over polar angle and radius, so the drum is one outline for each angle: outside, wall, floor, wall, outside.
Along the walls radii are even from the floor to the outside; angles are dense where the walls bend. A cell of sides dbeta and drho stands off its wall by

    |P_bb . n| dbeta^2 / 8 + |P_br . n| dbeta drho / 4 + |P_rr . n| drho^2 / 8

at most, which is held to the tolerance; on the outside its ring adds rho dbeta^2 / 8 square to it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from camgen.errors import DesignError
from camgen.geometry.drum_walls import DrumRoller, DrumWall, RollerPath, WallPoints, undercut
from camgen.geometry.mesh import MOST_TRIANGLES
from camgen.numerics import Floats, from_zero

Track = Literal["groove", "rib", "end"]

_FINE = 720  # angles at which the walls' bend is looked at
# rad, off a break: a short part of a law bends a wall there alone
_BESIDE = np.geomspace(1e-6, 0.1, 100)
_CLOSER = 3  # rounds in which its least area is looked for, each between the neighbours of the least before
_LEVELS = 9  # and radii
_MOST_ROWS = 1000
_LEAST_COLUMNS = 120  # for a whole turn, at any place: facets are then finer than the 60 harmonics of a turn that speeds have
_ONE_CYLINDER = 1e-5  # of the outside: radii of rings that rounding to float32 alone has made two
_COARSER = 1.1  # from one tolerance that is tried to the next, where one is too fine
_MARGIN = 0.95  # of the tolerance that is used: the bend is taken between angles, too
_MOST = 0.9 * MOST_TRIANGLES  # of its walls and outside: its ends and its bore have more
_LEAST_AREA = 0.0
# angles and radii of moments: walls are smooth in either but for jumps of a law's higher derivatives
_EVEN = 1440
_NODES = 8


@dataclass(frozen=True)
class DrumMoments:
    """Volume, mm^3, its first moment in the plane, complex mm^4, and its polar one about the axis, mm^5; area of its walls, mm^2."""

    volume: float
    first: complex
    polar: float
    walls: float


@dataclass(frozen=True)
class Drum:
    """A cylinder from z = 0 to its length without a bore, with a track between the radii of its floor and its outside; mm.

    A groove's roller lies between both walls. An end cam has the wall below the roller alone: above it the drum is no thicker
    than its floor, or where it has a pocket it is open within its floor, down to that height. A rib, on a core as thick as the
    floor, has one roller above it and one below: `pitch` between their axes, the path is that of the middle.
    """

    outside: float
    floor: float
    length: float
    track: Track
    path: RollerPath
    roller: DrumRoller
    pitch: float = 0.0
    breaks: tuple[float, ...] = ()  # cam angles at which its path may not be smooth, rad
    pocket: float | None = None  # of an end cam without a core: height of the floor within its wall

    @property
    def walls(self) -> tuple[DrumWall, ...]:
        """From below upwards."""
        if self.track == "end":
            return (DrumWall(self.path, self.roller, -1),)
        if self.track == "groove":
            return tuple(DrumWall(self.path, self.roller, side) for side in (-1, 1))
        return tuple(
            DrumWall(self.path.raised(-side * self.pitch / 2), self.roller, side)
            for side in (1, -1)
        )

    def rings(self, tolerance: float) -> Floats:
        """Its surface from the rim of its lower end to that of its upper one, (m, n, 3) mm: n points counter-clockwise on each ring.

        Facets between neighbours stand off the walls by at most `tolerance`. DesignError as of `span`, and where they were
        more than a file may have.
        """
        self.span  # noqa: B018  refuses what is no drum
        beta, rows = self._grid(tolerance)
        rho = np.linspace(self.floor, self.outside, rows + 1)
        heights = [wall.over(beta, rho[:, None]).z for wall in self.walls]
        turn = np.exp(1j * beta)
        return np.array(
            [
                np.column_stack([radius * turn.real, radius * turn.imag, z])
                for radius, z in self._outline(beta, rho, heights)
            ]
        )

    def rising(self, rims: Floats) -> NDArray[np.bool_]:
        """Which cells between neighbouring points of its rings, (m, n, 3) mm, are cut from below on the left to above on the right, (m - 1, n).

        It is the diagonal whose middle is nearer to the wall: both facets stand off less. On cylinders it makes no difference.
        """
        place = rims[..., 0] + 1j * rims[..., 1]
        rising = np.ones(place[1:].shape, bool)
        radii = np.abs(place[:, 0])
        rows = np.flatnonzero(np.abs(np.diff(radii)) > _ONE_CYLINDER * self.outside)
        low, high = (np.stack([place[k], rims[k, :, 2]]) for k in (rows, rows + 1))
        low_next, high_next = (np.roll(each, -1, axis=2) for each in (low, high))
        turn = np.angle(low[0] + high_next[0] + low_next[0] + high[0])
        radius = np.clip(np.abs(low[0] + high_next[0]) / 2, self.floor, self.outside)
        walls = [wall.over(turn.real, radius.real) for wall in self.walls]
        off = []
        for ends in (low + high_next, low_next + high):
            beside = np.angle(ends[0] * np.exp(-1j * turn))
            heights = [wall.z + beside * wall.along for wall in walls]
            off.append(np.min([np.abs(ends[1].real / 2 - z) for z in heights], axis=0))
        rising[rows] = off[0] <= off[1]
        return rising

    @cached_property
    def blank(self) -> tuple[tuple[float, float, float], ...]:
        """What it is turned from, from below: radius, lower and upper end of each cylinder, mm."""
        low, high = self.span
        if self.track == "groove" or self.pocket is not None:
            return ((self.outside, 0.0, self.length),)
        if self.track == "end":
            return ((self.outside, 0.0, high), (self.floor, high, self.length))
        return (
            (self.floor, 0.0, low),
            (self.outside, low, high),
            (self.floor, high, self.length),
        )

    @cached_property
    def moments(self) -> DrumMoments:
        """Of its volume, its pocket filled, by Gauss along the radius and even angles; DesignError as of `span`."""
        self.span  # noqa: B018
        beta = np.linspace(0, math.tau, _EVEN, endpoint=False)
        nodes, weights = np.polynomial.legendre.leggauss(_NODES)
        half = (self.outside - self.floor) / 2
        rho = (self.floor + half + half * nodes)[:, None]
        share = half * weights[:, None] * math.tau / _EVEN
        walls = [wall.over(beta, rho) for wall in self.walls]
        area = float(sum(np.sum(share * rho / wall.lean) for wall in walls))
        bottom = 0.0 if self.track != "rib" else walls[0].z
        top = walls[-1].z if self.track != "groove" else self.length - walls[1].z + walls[0].z
        height = share * (top - bottom)
        core = math.pi * self.floor**2 * self.length
        return DrumMoments(
            core + float(np.sum(height * rho)),
            complex(np.sum(height * rho**2 * np.exp(1j * beta))),
            core * self.floor**2 / 2 + float(np.sum(height * rho**3)),
            area,
        )

    @cached_property
    def edge_heights(self) -> tuple[Floats, ...]:
        """Heights of each wall at the floor and outside, (2, n) mm, over even angles; DesignError where one is undercut."""
        self.refuse_undercut()
        radii = np.array([[self.floor], [self.outside]])
        return tuple(wall.over(_even(), radii).z for wall in self.walls)

    def refuse_undercut(self) -> None:
        """DesignError where a wall is undercut on the floor: at even angles, and ever closer to where the path may not be smooth."""
        off = np.concatenate([-_BESIDE, [0.0], _BESIDE])
        beta = np.sort(np.concatenate([_even(), *(off - cam_angle for cam_angle in self.breaks)]))
        for wall in self.walls:
            where = beta
            for _ in range(_CLOSER):
                ratio = wall.area_ratio(where, np.full(len(where), self.floor))
                k = int(np.argmin(ratio))
                least = float(ratio[k])
                at = float(where[k])
                low = where[max(k - 1, 0)]
                high = where[min(k + 1, len(where) - 1)]
                where = np.sort(np.append(np.linspace(low, high, 100), at))
            if least <= _LEAST_AREA:
                raise undercut(min(least, 0.0), self.floor, at)

    @cached_property
    def span(self) -> tuple[float, float]:
        """Lowest and highest place of its walls, mm.

        DesignError where a wall is undercut, leaves the drum's ends, or a rib has no thickness.
        """
        levels = self.edge_heights
        low = float(min(np.min(z) for z in levels))
        high = float(max(np.max(z) for z in levels))
        if self.track == "rib" and float(np.min(levels[1] - levels[0])) <= 0:
            thickness = float(np.min(levels[1] - levels[0]))
            remedy = "move the rollers apart, or take smaller ones"
            raise DesignError("thickness of the rib", thickness, 0.0, "mm", "its thinnest", remedy)
        if low <= 0 or (high >= self.length and self.pocket is None):
            raise self._leaving(low, high)
        return low, high

    def _leaving(self, low: float, high: float) -> DesignError:
        """Of walls that leave its ends."""
        below = low <= 0
        width = high - low
        if width < self.length:
            way = (
                f"up by more than {-low:.4g}"
                if below
                else f"down by more than {high - self.length:.4g}"
            )
            remedy = f"the track leaves the drum, which is long enough: move the follower {way} mm"
        else:
            remedy = f"the track takes {width:.4g} mm of the drum's {self.length:.4g}: make it longer, or the lift smaller"
        value = low if below else high
        limit = 0.0 if below else self.length
        where = "its lowest" if below else "its highest"
        return DesignError("height of the wall", value, limit, "mm", where, remedy)

    def _grid(self, tolerance: float) -> tuple[Floats, int]:
        """Angles, and the number of rows from floor to outside, that need the fewest triangles."""
        found = self._fewest(tolerance)
        if found is None or found[0] > _MOST:
            raise self._too_fine(tolerance)
        _, density, rows = found
        filled = from_zero(density) * math.tau / _FINE
        count = max(math.ceil(filled[-1]), 12)
        shares = np.arange(count) / count * filled[-1]
        return np.interp(shares, filled, np.linspace(0, math.tau, _FINE + 1)), rows

    @cached_property
    def _bend(self) -> tuple[Floats, Floats, Floats]:
        """At even angles and radii of its walls, and of its outside: along the turn / 8, the twist / 4 and along the radius / 8.

        Each (m, n): a row for each wall and radius and one for the outside, which is bent along the turn alone.
        """
        beta = _even()
        rho = np.linspace(self.floor, self.outside, _LEVELS)[:, None]
        bends = [_widened(_bends(wall.over(beta, rho))) for wall in self.walls]
        along, twist, deep = np.concatenate(bends, axis=1)
        outside = np.full((1, _FINE), self.outside)
        return (
            np.concatenate([along, outside]) / 8,
            np.concatenate([twist, 0 * outside]) / 4,
            np.concatenate([deep, 0 * outside]) / 8,
        )

    def _fewest(self, tolerance: float) -> tuple[float, Floats, int] | None:
        """Triangles, angles for each rad, (n,), and rows; None where no number of rows is enough."""
        along, twist, deep = self._bend
        best: tuple[float, Floats, int] | None = None
        for rows in range(1, _MOST_ROWS):
            step = (self.outside - self.floor) / rows
            left = _MARGIN * tolerance - deep * step**2
            if np.min(left) <= 0:
                continue
            across = twist * step / (_MARGIN * tolerance)
            density = np.max(np.maximum(np.sqrt(along / left), across), axis=0)
            density = np.maximum(density, _LEAST_COLUMNS / math.tau)
            count = np.sum(density) * math.tau / _FINE
            triangles = 2 * count * (len(self.walls) * rows + 4)
            if best is not None and triangles > best[0]:
                break
            best = (triangles, density, rows)
        return best

    def _too_fine(self, tolerance: float) -> DesignError:
        """Of facets for a tolerance, that are more than a file may have; the remedy is a tolerance that has been tried."""
        least = tolerance
        found = None
        while found is None or found[0] > _MOST:
            least *= _COARSER
            found = self._fewest(least)
        least = _rounded_up(least)
        return DesignError(
            "accuracy.chord_tolerance",
            tolerance,
            least,
            "mm",
            f"the walls of the drum, whose mesh may have {MOST_TRIANGLES:,} triangles",
            "a larger accuracy.chord_tolerance, or a smaller drum",
        )

    def _outline(self, beta: Floats, rho: Floats, heights: list[Floats]) -> list[Floats]:
        """Radius and height of each point of the outline, (2, m) at the angles, material on its left seen with z up."""
        level = np.ones(len(beta))

        def point(radius: float, z: float) -> Floats:
            return np.array([radius * level, z * level])

        inwards = [
            np.array([radius * level, z])
            for radius, z in zip(rho[::-1], heights[0][::-1], strict=True)
        ]
        edge = self.floor if self.track == "rib" else self.outside
        top = self.outside if self.track == "groove" else self.floor
        bottom = [point(edge, 0)]
        end = [point(top, self.length if self.pocket is None else self.pocket)]
        if self.track == "end":
            return [*bottom, *inwards, *end]
        outwards = [
            np.array([radius * level, z]) for radius, z in zip(rho, heights[1], strict=True)
        ]
        if self.track == "groove":
            return [*bottom, *inwards, *outwards, *end]
        lower = [np.array([radius * level, z]) for radius, z in zip(rho, heights[0], strict=True)]
        upper = [
            np.array([radius * level, z])
            for radius, z in zip(rho[::-1], heights[1][::-1], strict=True)
        ]
        return [*bottom, *lower, *upper, *end]


def _rounded_up(value: float) -> float:
    """To two digits."""
    step = 10.0 ** (math.floor(math.log10(value)) - 1)
    return math.ceil(value / step) * step


def _bends(wall: WallPoints) -> Floats:
    """|P_bb . n|, |P_br . n| and |P_rr . n| on a grid of even angles (columns) and radii (rows), (3, rows, columns).

    Of the closed first derivatives' differences: they place points, and make none.
    """
    angle = math.tau / wall.z.shape[1]
    depth = float(wall.rho[1, 0] - wall.rho[0, 0])
    bent = (np.roll(wall.along, -1, axis=1) - np.roll(wall.along, 1, axis=1)) / (2 * angle)
    twisted, deeper = (np.gradient(each, depth, axis=0) for each in (wall.along, wall.deeper))
    # P_b = rho e_b + z_b k and P_r = e_r + z_r k, so P_bb has -rho e_r too and P_br has e_b
    sideways = -wall.lean * wall.along / wall.rho
    return np.abs(
        [
            bent * wall.lean - wall.rho * wall.outward,
            twisted * wall.lean + sideways,
            deeper * wall.lean,
        ]
    )


def _even() -> Floats:
    """Angles round the turn at which walls are looked at, (n,) rad."""
    return np.linspace(0, math.tau, _FINE, endpoint=False)


def _widened(values: Floats) -> Floats:
    """The largest of each value and its neighbours, two on either side round the turn and one along the radius, (k, m, n)."""
    turned = np.max([np.roll(values, k, axis=2) for k in (-2, -1, 0, 1, 2)], axis=0)
    beside = np.pad(turned, ((0, 0), (1, 1), (0, 0)), mode="edge")
    return np.asarray(np.maximum(turned, np.maximum(beside[:, :-2], beside[:, 2:])))
