"""Walls that a roller leaves in a drum: the envelope of the roller in closed form, as a height over the drum's cylinders.

phi        where the roller stands as the drum sees it, rad about the drum's axis z; a drum that turns by theta has phi = -theta
u, t, k    outward, tangential (counter-clockwise) and axial unit vector at phi; a prime is d/dphi
r          depth along the roller, from the drum's axis
Y, Z       of the roller's axis beside the radial line and along z: its points are r u + Y t + Z k
R(r)       radius of the roller; tan(delta) its slope, 0 of a cylinder
side       +1 the wall above the roller, -1 the one below

A point of the roller with the normal n = cos(delta) m - sin(delta) u, m = cos(psi) k + sin(psi) t, is on a wall where the
velocity of the roller as the drum sees it, Z' k + (r + Y') t - (Y + ...) u, has no part along n. With
r* = r + R tan(delta), A = r* + Y', B = Z', V = hypot(A, B):

    side +1:  psi = -atan2(B, A) - asin(Y tan(delta) / V)        side -1:  psi = pi - atan2(B, A) + asin(Y tan(delta) / V)
    wall      P = r u + (Y + R sin(psi)) t + (Z + R cos(psi)) k

Of a cylinder: the walls are the parallel surfaces, at R on both sides, of the surface that its axis sweeps.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from camgen.errors import DesignError
from camgen.numerics import Floats, Points, latest, peak

_ROUNDS = 60
_CLOSE = 1e-12  # of beta, rad, and of rho over the drum's radius
_STEP = 1e-6  # of the same, over which slopes are taken
_FAR = 0.2  # of the same, by which one round goes at most
_LEAST_AREA = (
    1e-3  # of the walls' points for those of the roller, below which a wall counts as undercut
)


@dataclass(frozen=True)
class DrumRoller:
    """Radius (mm) at the depth `middle`, and how it grows with the depth: the tangent of the cone's half angle."""

    radius: float
    middle: float
    slope: float = 0.0

    def at(self, r: Floats) -> Floats:
        """Radius at the depth r, mm."""
        return self.radius + (r - self.middle) * self.slope


@dataclass(frozen=True)
class RollerPath:
    """Y + i Z of the roller's axis, mm, as a function of phi (rad) and order."""

    place: Callable[[Floats, int], Points]

    def beside(self, phi: Floats, order: int) -> Floats:
        """Y, mm, or its derivative by phi."""
        return self.place(phi, order).real

    def height(self, phi: Floats, order: int) -> Floats:
        """Z, likewise."""
        return self.place(phi, order).imag

    def raised(self, shift: float) -> RollerPath:
        """The same, higher by a shift, mm."""
        return RollerPath(
            lambda phi, order: self.place(phi, order) + (1j * shift if order == 0 else 0.0)
        )


@dataclass(frozen=True, eq=False)
class WallPoints:
    """Points of one wall, all of one shape: polar angle beta (rad) and radius rho, height z, slopes dz/dbeta and dz/drho.

    lean: part of the unit normal along z, above 0. outward: its part along the radius at beta, both of the normal that looks up.
    """

    beta: Floats
    rho: Floats
    z: Floats
    lean: Floats
    outward: Floats
    along: Floats  # dz / dbeta at constant rho, mm
    deeper: Floats  # dz / drho at constant beta


def slide_path(
    motion: Callable[[Floats, int], Floats], height: float, offset: float = 0.0
) -> RollerPath:
    """A roller on a slide along the axis: Z = height + s(theta), Y = offset; motion: s by theta and order, mm."""

    def place(phi: Floats, order: int) -> Points:
        along = (-1) ** order * motion(-phi, order)
        return np.asarray(along * 1j + (complex(offset, height) if order == 0 else 0.0))

    return RollerPath(place)


def swing_path(
    motion: Callable[[Floats, int], Floats], arm: float, pivot: float, height: float
) -> RollerPath:
    """A roller on an arm whose pivot lies `pivot` beside the drum's axis at `height`: Y = pivot - arm cos(gamma).

    motion: gamma by theta and order, rad, from the line square to the axis; the arm's axle is parallel to u.
    """

    def place(phi: Floats, order: int) -> Points:
        """Seen from the pivot -arm exp(-i gamma)."""
        tip = -arm * np.exp(-1j * motion(-phi, 0))
        if order == 0:
            return np.asarray(tip + complex(pivot, height))
        first = -motion(-phi, 1)
        if order == 1:
            return np.asarray(-1j * first * tip)
        return np.asarray((-1j * motion(-phi, 2) - first**2) * tip)

    return RollerPath(place)


def remembered(path: RollerPath) -> RollerPath:
    """The same, which keeps what it gave for the last two arrays of angles, for drums that are tried one after the other."""
    orders = [latest(partial(_of_order, path, order), 2) for order in range(3)]
    return RollerPath(lambda phi, order: orders[order](phi))


def _of_order(path: RollerPath, order: int, phi: Floats) -> Points:
    return path.place(phi, order)


@dataclass(frozen=True)
class DrumWall:
    """One wall that the roller leaves."""

    path: RollerPath
    roller: DrumRoller
    side: int

    def contact(self, phi: Floats, r: Floats) -> Floats:
        """Angle psi of the contact round the roller, rad, from k towards t; nan where none of its normals is square to its way."""
        return self._contact(self.path.place(phi, 0), self.path.place(phi, 1), r)

    def _contact(self, place: Points, velocity: Points, r: Floats) -> Floats:
        reach = r + self.roller.at(r) * self.roller.slope + velocity.real
        climb = velocity.imag
        with np.errstate(invalid="ignore", divide="ignore"):  # a cone far beside, or no speed
            tilt = np.arcsin(place.real * self.roller.slope / np.hypot(reach, climb))
        turn = -np.arctan2(climb, reach) - self.side * tilt
        return np.asarray(turn if self.side > 0 else math.pi + turn)

    def area_ratio(self, phi: Floats, r: Floats) -> Floats:
        """Area of the wall for that of the surface of the roller's axis; at 0 and below the wall is undercut.

        Exact for a cylinder: 1 - side R (Z'' (r + Y') - Z' Y'') / V^3 + side R Y Z' / V^3 - R^2 Z'^2 / V^4; of a cone with r*.
        """
        radius = self.roller.at(r)
        velocity = self.path.place(phi, 1)
        change = self.path.place(phi, 2)
        reach = r + radius * self.roller.slope + velocity.real
        climb = velocity.imag
        speed = np.hypot(reach, climb)
        bend = change.imag * reach - climb * change.real
        bend = bend - self.path.beside(phi, 0) * climb
        return np.asarray(
            1 - self.side * radius * bend / speed**3 - (radius * climb / speed**2) ** 2
        )

    def points(self, phi: Floats, r: Floats) -> WallPoints:
        """Where the roller at phi touches the wall at the depth r; shapes broadcast."""
        return self._points(phi, self.path.place(phi, 0), self.path.place(phi, 1), r)

    def _points(self, phi: Floats, place: Points, velocity: Points, r: Floats) -> WallPoints:
        psi = self._contact(place, velocity, r)
        radius = self.roller.at(r)
        across = place.real + radius * np.sin(psi)
        turn = np.arctan2(across, r)
        cosine = 1 / math.hypot(1, self.roller.slope)
        inward = self.roller.slope * cosine
        # the normal at phi (u, t, k), and turned to beta
        up = np.cos(psi) * cosine
        tangential = np.sin(psi) * cosine
        outward = -inward * np.cos(turn) + tangential * np.sin(turn)
        onward = inward * np.sin(turn) + tangential * np.cos(turn)
        rho = np.hypot(r, across)
        sense = np.sign(up)
        return WallPoints(
            phi + turn,
            rho,
            place.imag + radius * np.cos(psi),
            np.abs(up),
            sense * outward,
            -rho * onward / up,
            -outward / up,
        )

    def over(self, beta: Floats, rho: Floats) -> WallPoints:
        """The wall's points at polar angles and radii, which broadcast. DesignError where it has none: it is undercut."""
        beta, rho = (np.asarray(each, float) for each in np.broadcast_arrays(beta, rho))
        phi = beta.copy()
        r = rho.copy()
        size = peak(rho)
        for _ in range(_ROUNDS):
            place = self.path.place(phi, 0)
            velocity = self.path.place(phi, 1)
            found = self._points(phi, place, velocity, r)
            off = beta - found.beta
            short = rho - found.rho
            if np.all(np.abs(off) < _CLOSE) and np.all(np.abs(short) < _CLOSE * size):
                return found
            # Newton; slopes by differences, which count for its pace alone
            ahead = self.points(phi + _STEP, r)
            outer = self._points(phi, place, velocity, r + _STEP * size)
            turned = (ahead.beta - found.beta) / _STEP
            widened = (ahead.rho - found.rho) / _STEP
            leant = (outer.beta - found.beta) / (_STEP * size)
            deeper = (outer.rho - found.rho) / (_STEP * size)
            area = turned * deeper - leant * widened
            area = np.where(np.abs(area) < _LEAST_AREA, _LEAST_AREA, area)
            phi = phi + np.clip((off * deeper - short * leant) / area, -_FAR, _FAR)
            r = r + np.clip((short * turned - off * widened) / area, -_FAR * size, _FAR * size)
        row = np.unravel_index(int(np.argmax(np.abs(off))), off.shape)
        ratio = float(self.area_ratio(phi, r)[row])
        raise undercut(ratio, float(rho[row]), float(phi[row]))


def undercut(ratio: float, rho: float, phi: float) -> DesignError:
    """Of a wall that has no point at a radius, mm; ratio: its area near there for that of the surface of the roller's axis, which at
    0 and below says by how much."""
    where = f"radius {rho:.4g} mm, cam angle {math.degrees(-phi) % 360:.4g} deg"
    remedy = "a smaller geometry.roller.radius or lift, a larger geometry.radius or a longer span_deg mends it"
    error = DesignError(
        "area of the wall for that of the roller's axis", ratio, 0.0, "", where, remedy
    )
    said = f"the wall is undercut: the roller touches none of it at {where}"
    if ratio <= 0:
        said += f", where it has {ratio:.3g} of the area that the roller's axis sweeps"
    return error.saying(said)
