"""Thirty pairs by routes of their own, none of them a false alarm; and the same pairs with one flank, tooth, tip or axis off."""

from __future__ import annotations

import cmath
import math
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from camgen.geometry.rings import Floats, Points, Ring
from camgen.measuring.drives import Drive, Driven, driven_by

sys.path.insert(0, str(Path(__file__).parents[1] / "judge"))
from pair_outlines import ALPHA, Wheel, centre_distance, inner_ring  # noqa: E402

# mm along the line of action, that a sound pair stays below: chords of both flanks lie in by half a um each. A damaged one exceeds ten times that.
LEAST = 0.001
MODULE = 1.5


def polyline(points: Points) -> Ring:
    return Ring(points, np.zeros(len(points)))


def rack_tooth(wheel: Wheel, rounds: int = 24) -> Points:
    """The cutter's tooth whose tip is at the wheel's root, its middle on Oy, from above the tip circle down and up."""
    low = wheel.r + wheel.m * (wheel.x - wheel.ha - wheel.c)
    high = wheel.ra + wheel.m
    half = math.pi * wheel.m / 4 + wheel.thin / 2  # at the reference line of the cutter
    line = wheel.r + wheel.m * wheel.x
    radius = wheel.rho * wheel.m
    middle = half - (line - low - radius) * math.tan(ALPHA) - radius / math.cos(ALPHA)
    corner = complex(middle, low + radius)
    turns = np.linspace(-ALPHA, -math.pi / 2, rounds)
    right = corner + radius * np.exp(1j * turns)
    top = complex(half + (high - line) * math.tan(ALPHA), high)
    side = np.concatenate([[top], right])
    return np.concatenate([side, -np.conj(side)[::-1]])


@cache
def rolled(wheel: Wheel, steps: int = 100) -> Ring:
    """The outline that a rack leaves of a disc as it rolls on it, step by step: no formula of an involute or a trochoid."""
    import shapely

    far = math.acos(wheel.r / (wheel.ra + wheel.m)) * 1.3
    tooth = rack_tooth(wheel)
    swept = []
    for turn in np.linspace(-far, far, steps):
        z = (tooth + turn * wheel.r) * cmath.exp(1j * turn)
        swept.append(shapely.Polygon(np.column_stack([z.real, z.imag])))
    gap = shapely.get_coordinates(shapely.union_all(swept).exterior) @ [1, 1j]
    gaps = []
    for k in range(wheel.z):
        z = gap * cmath.exp(1j * (math.pi / wheel.z - math.pi / 2 + math.tau * k / wheel.z))
        gaps.append(shapely.Polygon(np.column_stack([z.real, z.imag])))
    rim = wheel.ra * np.exp(1j * np.linspace(0, math.tau, 40 * wheel.z, endpoint=False))
    disc = shapely.Polygon(np.column_stack([rim.real, rim.imag]))
    left = shapely.difference(disc, shapely.union_all(gaps))
    return polyline(shapely.get_coordinates(left.exterior)[:-1] @ [1, 1j]).counter_clockwise()


def rack(m: float, count: int, thin: float) -> Ring:
    """A rack, teeth up, its reference line on Ox, a gap's middle on Oy; cut off behind its teeth."""
    half = math.pi * m / 4 - thin / 2
    slope = math.tan(ALPHA)
    corners = []
    for k in range(count):
        middle = (k - count / 2 + 0.5) * math.pi * m
        for side, height in ((-1, -1.25), (-1, 1.0), (1, 1.0), (1, -1.25)):
            corners.append(complex(middle + side * (half - height * m * slope), height * m))
    ends = [corners[-1].real - 3j * m, corners[0].real - 3j * m]
    return polyline(np.array([*corners, *ends])[::-1])


@dataclass(frozen=True)
class Pair:
    """Outlines about their pivots, and by what an error of the driven one, rad or mm, becomes mm along the line of action."""

    driver: Ring
    driven: Ring
    drive: Drive
    arm: float

    def error(self, driven: Ring | None = None) -> float:
        """Of the worse flank, mm."""
        found = self.followed(driven)
        return self.arm * max(found.transmission_error, found.back_transmission_error)

    def followed(self, driven: Ring | None = None) -> Driven:
        """Free and proven at every angle."""
        found = driven_by(self.driver, driven or self.driven, self.drive)
        assert found.free.all() and found.proven[1:].all()
        return found


Made = Callable[[Wheel], Ring]
ROUTES: dict[str, Made] = {
    "arcs": Wheel.ring,
    "few arcs": lambda wheel: wheel.ring(5),
    "rolled": rolled,
    "24 chords": lambda wheel: wheel.ring(24, arcs=False),
    "60 chords": lambda wheel: wheel.ring(60, arcs=False, root=20),
}


def outer(
    route: str, z: int, k: int, x1: float = 0.0, x2: float = 0.0, turned: float = 0.0
) -> Pair:
    """Wheels of z and k z teeth, the driven one turned as a file may have it."""
    a, b = Wheel(MODULE, z, x1), Wheel(MODULE, k * z, x2)
    distance, _ = centre_distance(a, b)
    made = ROUTES[route]
    driven = made(b).moved(cmath.exp(1j * turned))
    return Pair(made(a), driven, Drive(distance, ratio=-1 / k), b.rb)


def inner(z1: int, z2: int, x: float, tip: float) -> Pair:
    """A pinion in a ring of the same shift, module 2; tip: radius of the ring's tips, by the reference's table."""
    a, space = Wheel(2, z1, x), Wheel(2, z2, x, thin=-0.04)
    distance = (z2 - z1) * 1.0
    ring = inner_ring(space, tip, space.r + 2 * (1.25 + x))
    drive = Drive(distance, ratio=z1 / z2, inside=True)
    return Pair(a.ring(), ring, drive, space.rb)


def sliding(z: int, x: float) -> Pair:
    """A pinion on a rack."""
    a = Wheel(2, z, x)
    # it moves by z teeth to the right
    bar = rack(2, z + 8, 0.04).moved(shift=-complex(math.pi * z, a.r + 2 * x))
    drive = Drive(slides=0.0, ratio=a.r)
    return Pair(a.ring(), bar, drive, math.cos(ALPHA))


SOUND: dict[str, Callable[[], Pair]] = {
    **{
        f"{route} {z}/{k * z} x {x1:g} {x2:g}": lambda route=route, row=(z, k, x1, x2): outer(  # type: ignore[misc]
            route, *row, turned=0.1 * row[0]
        )
        for route in ROUTES
        for z, k, x1, x2 in ((18, 1, 0, 0), (17, 2, 0.2, -0.2), (12, 2, 0.4, 0.2), (20, 2, 0, 0.3))
    },
    **{
        f"inner {z1}/{z2} x {x:g}": lambda row=(z1, z2, x, tip): inner(*row)  # type: ignore[misc]
        for z1, z2, x, tip in (
            (12, 30, 0.0, 29.0497),
            (12, 30, 0.4, 29.0081),
            (20, 60, 0.0, 58.2798),
        )
    },
    **{
        f"rack {z} x {x:g}": lambda row=(z, x): sliding(*row)  # type: ignore[misc]
        for z, x in ((12, 0.4), (18, 0.0), (18, 0.3), (25, 0.0), (25, -0.2), (31, 0.1), (40, 0.0))
    },
}


def test_there_are_thirty() -> None:
    assert len(SOUND) == 30


@pytest.mark.long
@pytest.mark.parametrize("name", SOUND)
def test_sound_pairs_are_no_false_alarm(name: str) -> None:
    assert SOUND[name]().error() < LEAST


DAMAGED = ["arcs", "60 chords"]


@cache
def pair_of(route: str) -> Pair:
    return outer(route, 20, 2)


def tooth(ring: Ring, number: int) -> tuple[np.ndarray, Floats]:
    """Which points are a tooth's of forty, and their angles from its middle, rad."""
    angle = np.angle(ring.points * cmath.exp(-1j * math.tau * number / 40))
    return np.abs(angle) < math.pi / 40, angle


@pytest.mark.parametrize("route", DAMAGED)
@pytest.mark.parametrize("off", [0.01, 0.015, 0.02])
def test_a_flank_that_is_too_thick_shows_as_much(route: str, off: float) -> None:
    pair = pair_of(route)
    own, angle = tooth(pair.driven, 7)
    flank = own & (angle > 0) & (np.abs(pair.driven.points) > 28.5)
    points = pair.driven.points * np.exp(1j * off * flank / np.abs(pair.driven.points))
    assert pair.error(Ring(points, pair.driven.bulges)) == pytest.approx(off, rel=0.25)


@pytest.mark.parametrize("route", DAMAGED)
def test_an_axis_that_is_off_by_10_um_shows_twice_over_a_turn(route: str) -> None:
    pair = pair_of(route)
    assert pair.error(pair.driven.moved(shift=0.01j)) == pytest.approx(0.02, rel=0.25)


@pytest.mark.parametrize("route", DAMAGED)
def test_a_lost_tooth_and_a_burr_of_50_um_are_found(route: str) -> None:
    pair = pair_of(route)
    ring = pair.driven
    own, angle = tooth(ring, 7)
    radius = np.abs(ring.points)
    lost = Ring(
        ring.points * np.where(own, radius.min() / radius, 1), np.where(own, 0, ring.bulges)
    )
    assert pair.error(lost) > 10 * LEAST
    tip = int(np.argmax(np.where(own & (angle > 0), radius + 5 * angle, 0)))
    points = ring.points.copy()
    points[tip] *= 1 + 0.05j / radius[tip]
    assert pair.error(Ring(points, ring.bulges)) > 10 * LEAST


def test_a_distance_that_is_off_by_10_um_shows_as_play() -> None:
    """By 2 da sin(pressure angle) along the line of action, as the working angle is the cutter's; the error stays."""
    pair = pair_of("arcs")
    more = Pair(pair.driver, pair.driven, Drive(pair.drive.distance + 0.01, ratio=-0.5), pair.arm)  # type: ignore[operator]
    plays = [float(np.mean(each.followed().play)) * pair.arm for each in (pair, more)]
    assert plays[1] - plays[0] == pytest.approx(0.02 * math.sin(ALPHA), rel=0.01)
    assert more.error() < LEAST
