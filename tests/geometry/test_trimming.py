"""Trimmed profiles against another route: the discs of the tip subtracted by shapely, and distances by brute force."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from camgen.errors import DesignError
from camgen.geometry.outlines import Line
from camgen.geometry.trimming import trim
from camgen.machine.cams.profile import DiscCam, SwingingArm
from camgen.motion.program import uniform_swing


def cam(length: float, offset: float, swing_deg: float, rho: float, blend: float) -> DiscCam:
    follower = SwingingArm(complex(length), -complex(length, offset), rho, 1)
    return DiscCam(uniform_swing(math.radians(swing_deg), blend), follower)


@cache
def pitch_polygon(
    length: float, offset: float, swing_deg: float, blend: float
) -> tuple[np.ndarray, np.ndarray]:
    knife = cam(length, offset, swing_deg, 0.0, blend)
    joints = np.mod(knife.program.joints, 2 * math.pi)
    near = (
        (joints[:, None] + np.linspace(-1, 1, 401) * max(2 * blend, 1e-3)).ravel()
        if 0 < blend < 1
        else joints
    )
    theta = np.unique(
        np.mod(np.concatenate((np.linspace(0, 2 * math.pi, 6001), near)), 2 * math.pi)
    )
    return theta, knife.pitch(theta)


def ring(made: DiscCam) -> np.ndarray:
    u = np.linspace(0, 1, 1201)[:-1]
    return np.concatenate([p.at(p.t0 + (p.t1 - p.t0) * u) for p in made.outline.pieces])


def points(z: np.ndarray) -> np.ndarray:
    return shapely.points(z.real, z.imag)


def material(polygon: np.ndarray, rho: float) -> shapely.Polygon | None:
    """What the tip's discs leave round the shaft; facets of the discs' union leave up to 1e-4 rho too much."""
    line = shapely.LinearRing(np.c_[polygon.real, polygon.imag])
    left = shapely.Polygon(line).difference(line.buffer(rho, quad_segs=128))
    held = [p for p in getattr(left, "geoms", [left]) if p.contains(shapely.Point(0, 0))]
    return held[0] if held else None


def free_distance(made: DiscCam, z: np.ndarray, around: np.ndarray) -> np.ndarray:
    """Distance of each point from the whole pitch curve: nearest sample, then a finer and finer grid, and joints."""
    tree = shapely.STRtree(points(made.pitch(around)))
    theta = around[tree.nearest(points(z))]
    step = np.diff(around).max()
    grid = theta[:, None] + np.linspace(-1, 1, 9) * step
    for _ in range(12):
        k = np.argmin(np.abs(made.pitch(grid.ravel()).reshape(grid.shape) - z[:, None]), axis=1)
        theta = grid[np.arange(len(z)), k]
        step /= 3.9
        grid = theta[:, None] + np.linspace(-1, 1, 9) * step
    corners = np.abs(made.pitch(made.program.joints)[:, None] - z).min(axis=0)
    return np.minimum(np.abs(made.pitch(theta) - z), corners)


def check(length: float, offset: float, swing_deg: float, rho: float, blend: float) -> DiscCam:
    """Outline and reachable motion are those of the brute force; DesignError only where that leaves nothing either."""
    size = math.hypot(length, offset)
    theta, polygon = pitch_polygon(length, offset, swing_deg, blend)
    truth = material(polygon, rho)
    made = cam(length, offset, swing_deg, rho, blend)
    try:
        z = ring(made)
    except DesignError as error:
        assert (error.quantity, error.value, error.unit) == ("tip_radius", rho, "mm")
        assert error.where and error.remedy
        assert error.limit == pytest.approx(np.min(np.abs(polygon)), rel=1e-6)
        assert truth is None or rho > 0.998 * np.min(np.abs(polygon))
        return made
    if truth is None:  # a cam that is next to nothing: its facets leave none
        assert rho > 0.998 * np.min(np.abs(polygon))
        return made
    mine = shapely.Polygon(np.c_[z.real, z.imag])
    assert mine.is_valid and mine.contains(shapely.Point(0, 0))
    facets = 5e-5 * size
    assert mine.symmetric_difference(truth).area < facets * truth.length
    assert shapely.distance(points(z), truth.exterior).max() < 10 * facets
    assert abs(made.outline.area - truth.area) < facets * truth.length
    # no point of the outline is nearer to any place of the tip's centre than the tip's radius
    assert np.min(free_distance(made, z[::7], theta)) > rho - 1e-9 * max(1.0, size)
    # the tip touches the material at every angle, and only where it cannot follow does it stand off
    undercut = [np.linspace(c.begin, c.end, 31) for c in made.undercuts]
    angles = np.concatenate((np.linspace(0, 6.28, 181) + 0.0123, *undercut))
    s = made.reachable(angles)
    centre = made.follower.trace(s) * np.exp(-1j * angles)
    gap = shapely.distance(points(centre), truth) - rho
    assert np.max(np.abs(gap)) < 10 * facets
    assert np.all(s <= made.program(angles) + 1e-9)
    return made


@pytest.mark.long
@pytest.mark.parametrize("blend", [0.0, 0.3, math.pi])
@pytest.mark.parametrize("rho", [0.1, 10.0, 12.0, 25.0])
def test_tips_and_blends(rho: float, blend: float) -> None:
    made = check(60.0, 30.0, 30.0, rho, blend)
    if blend == 0 and rho < 14.6:
        # the convex corner is always undercut; beyond 10.52 mm the rise's beginning as well
        assert len(made.undercuts) == (2 if rho > 10.5231 else 1)


@pytest.mark.long
@pytest.mark.parametrize(
    "case",
    [
        (60.0, 30.0, 0.01, 3.0, 0.0),
        (60.0, 30.0, 0.01, 25.0, 0.3),
        (60.0, 60.0, 80.0, 1.0, 0.0),
        (60.0, 60.0, 80.0, 4.0, 0.3),
        (60.0, 180.0, 80.0, 20.0, 0.0),
        (60.0, 0.6, 1.0, 0.05, 0.0),
        (0.1, 0.05, 30.0, 0.005, 0.1),
        (10_000.0, 5_000.0, 30.0, 500.0, 0.0),
        (10_000.0, 5_000.0, 30.0, 1_800.0, 1.0),
        # cusps at the ends of the raw branches: samples there are rounding and must not pass for crossings
        (60.0, 53.802234694660726, 0.8063296435382322, 53.2, 0.8139754198605205),
        (60.0, 50.51087791201738, 34.37964127968207, 25.003699695035177, 0.0002927133496405675),
        (60.0, 12.421007351748726, 10.795856036407795, 6.78, 0.0),
        (60.0, 30.0, 30.0, 3.0, math.radians(0.01)),
    ],
)
def test_hard_cases(case: tuple[float, float, float, float, float]) -> None:
    check(*case)


@pytest.mark.parametrize("blend", [0.0, 0.3, 1.0])
@pytest.mark.parametrize("excess", [-1e-3, -1e-6, -1e-9, 0.0, 1e-9, 1e-7, 1e-5, 1e-3])
def test_tip_at_the_limit_of_undercut(blend: float, excess: float) -> None:
    """A swallowtail of any size, down to rounding: the outline closes and the motion lost goes to nothing with it."""
    limit = cam(60.0, 38.5, 46.0, 0.0, blend).least_radius
    made = cam(60.0, 38.5, 46.0, limit * (1 + excess), blend)
    assert made.outline.area > 0
    smooth = (
        [c for c in made.undercuts if not c.begin < math.pi < c.end]
        if blend == 0
        else list(made.undercuts)
    )
    if excess < 0:
        assert not smooth
    if excess >= (1e-5 if blend else 1e-3):
        assert len(smooth) == 1
    assert all(c.shortfall <= 3 * max(excess, 0) ** 1.5 + 1e-9 for c in smooth)


def test_other_way_round_is_seen() -> None:
    """The check above notices an outline with another tip, and one that was not trimmed."""
    _, polygon = pitch_polygon(60.0, 30.0, 30.0, 0.0)
    truth = material(polygon, 3.0)
    assert truth is not None
    z = ring(cam(60.0, 30.0, 30.0, 3.01, 0.0))
    assert (
        shapely.Polygon(np.c_[z.real, z.imag]).symmetric_difference(truth).area
        > 3e-3 * truth.length
    )
    made = cam(60.0, 30.0, 30.0, 3.0, 0.0)
    raw = made.profile(np.linspace(3.12, math.pi - 1e-6, 50))
    assert np.min(free_distance(made, raw, np.linspace(0, 2 * math.pi, 6001))) < 3 - 1e-3


@pytest.mark.long
@settings(max_examples=15)
@given(
    st.floats(-1, 4),
    st.floats(0.05, 1.5),
    st.floats(0.001, 0.95),
    st.floats(0.002, 1.1),
    st.one_of(st.just(0.0), st.just(math.pi), st.floats(2e-4, 3.1)),
)
def test_all_designs(decade: float, ratio: float, swing: float, tip: float, blend: float) -> None:
    length = 10**decade
    swing_deg = swing * math.degrees(2 * math.atan2(ratio, 1))
    nearest = float(np.min(np.abs(pitch_polygon(length, ratio * length, swing_deg, blend)[1])))
    check(length, ratio * length, swing_deg, tip * nearest, blend)


def test_loops_of_lines() -> None:
    """A square with a loop at a corner, run clockwise: the loop goes, the crossing is exact."""
    ends = [0, 10j, 10 + 10j, 10 + 4j, 12 + 4j, 12 + 6j, 8 + 6j, 8 + 0j]
    lines = [Line(complex(a), complex(b)) for a, b in zip(ends, ends[1:] + ends[:1], strict=True)]
    kept, cuts = trim(lines)
    assert [c.at for c in cuts] == [10 + 6j]
    assert [complex(p.a) for p in kept if isinstance(p, Line)] == [
        10 + 6j,
        8 + 6j,
        8,
        0,
        10j,
        10 + 10j,
    ]
    triangle = [*lines[:2], Line(10 + 10j, 0j)]
    assert trim(triangle) == (triangle, [])


def test_branches_that_never_meet() -> None:
    with pytest.raises(DesignError, match="gap left"):
        trim([Line(0j, 10j), Line(10j, 10 + 10j), Line(10 + 9j, 10 + 0j), Line(10 + 0j, 0j)])
