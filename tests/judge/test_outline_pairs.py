"""One outline drives another: closed forms, an independent prototype's figures, and the area of overlap as a route of its own."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from pair_outlines import ALPHA, Wheel, centre_distance, inner_ring, inv

from camgen.geometry.rings import Floats, Points, Ring
from camgen.judge import pairs
from camgen.judge.pair_events import Slide
from camgen.judge.pairs import Body, OutlinePair, PairMotion, pivots_apart

KNOWN = tomllib.loads(
    (Path(__file__).parents[1] / "reference" / "higher_pairs.toml").read_text(encoding="utf-8")
)
TURN = np.linspace(0, math.tau, 361)


def circle(centre: complex, radius: float) -> Ring:
    """Four quarters."""
    return Ring(centre + radius * np.array([1, 1j, -1, -1j]), np.full(4, math.tan(math.pi / 8)))


def meshed(
    first: Wheel, second: Wheel, off: float = 0.0, per_flank: int = 0, theta: Floats | None = None
) -> tuple[PairMotion, Wheel]:
    """Two wheels in mesh over two teeth of the first, shortened as the distance asks; and the second one."""
    distance, _ = centre_distance(first, second)
    total = first.z + second.z
    short = first.x + second.x + total / 2 - distance / first.m
    shortened = [Wheel(each.m, each.z, each.x, each.thin, short) for each in (first, second)]
    rings = [each.ring(per_flank or 8, not per_flank, per_flank // 2 or 4) for each in shortened]
    pair = OutlinePair(Body(rings[:1]), Body(rings[1:]), pivots_apart(distance + off))
    angles = np.linspace(0, math.pi / 3, 1201) if theta is None else theta
    return pair.follow(angles, math.pi / second.z), shortened[1]


def error_um(motion: PairMotion, wheel: Wheel, ratio: float) -> tuple[float, float]:
    """Peak to peak of both bounds less the ratio, at the base circle, um."""
    theta = motion.samples.theta
    return tuple(  # type: ignore[return-value]
        float(np.ptp(bound - ratio * theta)) * wheel.rb * 1e3
        for bound in (motion.samples.low, motion.samples.high)
    )


@pytest.mark.parametrize("row", KNOWN["gears"]["rows"], ids=str)
def test_involute_gears_have_the_backlash_of_the_formula_and_an_error_below_their_sagittae(
    row: list[float],
) -> None:
    x1, x2, distance, chords, sagitta, te, play = row
    first = Wheel(2, 12, x1)
    second = Wheel(2, 30, x2)
    assert centre_distance(first, second)[0] == pytest.approx(distance, abs=1e-6)
    motion, wheel = meshed(first, second, 0.0, int(chords))
    samples = motion.samples
    assert samples.free.all() and samples.proven[1:].all()
    low, high = error_um(motion, wheel, -0.4)
    # a prototype that samples at other angles and lays its root points elsewhere
    assert low == pytest.approx(te, rel=0.03) and high == pytest.approx(te, rel=0.03)
    assert np.mean(samples.play) == pytest.approx(play, rel=1e-4)
    if sagitta:
        assert low <= 2 * sagitta
        assert np.min(samples.play) >= KNOWN["gears"]["backlash"]
    else:
        assert np.mean(samples.play) == pytest.approx(KNOWN["gears"]["backlash"], rel=1e-3)


@pytest.mark.parametrize("off, closed, found", KNOWN["centre_off"]["rows"])
def test_ten_microns_of_centre_distance_are_seen(off: float, closed: float, found: float) -> None:
    first = Wheel(2, 12, 0.4)
    second = Wheel(2, 30, 0.2)
    distance, angle = centre_distance(first, second)
    wider = math.acos(math.cos(angle) * distance / (distance + off))
    formula = 2 * (inv(wider) - inv(angle)) * (first.rb + second.rb) + 0.08 * math.cos(ALPHA)
    assert formula / second.rb == pytest.approx(closed, rel=1e-6)
    motion, wheel = meshed(first, second, off)
    assert np.mean(motion.samples.play) == pytest.approx(found, rel=1e-5)
    assert error_um(motion, wheel, -0.4)[0] == pytest.approx(KNOWN["centre_off"]["te_um"], rel=0.01)


def test_an_inner_gear_has_the_backlash_of_the_outer_one() -> None:
    known = KNOWN["inner_gears"]
    space = Wheel(2, 30, thin=-0.04)
    ring = inner_ring(space, known["tip"], 32.5)
    pinion = Body([Wheel(2, 12).ring()])
    pair = OutlinePair(pinion, Body([pairs.hollow(ring)]), pivots_apart(known["distance"]))
    motion = pair.follow(np.linspace(0, math.pi / 3, 1201), 0.0)
    samples = motion.samples
    assert samples.proven[1:].all()
    assert [np.min(samples.play), np.max(samples.play)] == pytest.approx(known["play"], rel=1e-3)
    assert error_um(motion, space, 0.4)[0] == pytest.approx(known["te_um"], rel=0.1)


# ---- closed forms ----------------------------------------------------------------------------------------------------

RADIUS, ECCENTRICITY, ROLLER, ARM, DISTANCE = 20.0, 7.0, 5.0, 50.0, 60.0
ECCENTRIC = Body([circle(ECCENTRICITY, RADIUS)])


def at_origin(theta: Floats, order: int) -> tuple[Points, Floats]:
    """A driver that turns about the origin of a slide."""
    return pivots_apart(0)(theta, order)


def test_a_circle_lifts_a_flat_face_by_its_highest_point() -> None:
    face = Ring(np.array([-60, 60, 60 + 10j, -60 + 10j]), np.zeros(4))
    motion = OutlinePair(ECCENTRIC, Body([face]), at_origin, Slide(1j)).follow(TURN, 40.0)
    expected = RADIUS + ECCENTRICITY * np.sin(TURN)
    assert np.max(np.abs(motion.samples.low - expected)) < 1e-13
    assert np.isnan(motion.samples.high).all()
    touch = motion.touch(motion.samples, "low")
    assert touch.point == pytest.approx(ECCENTRICITY * np.exp(1j * TURN) + 1j * RADIUS, abs=1e-12)
    assert touch.slope == pytest.approx(ECCENTRICITY * np.cos(TURN), abs=1e-12)
    assert touch.pressure_angle == pytest.approx(np.zeros(len(TURN)), abs=1e-12)


def test_a_circle_lifts_a_sliding_roller_as_the_triangle_says() -> None:
    roller = Body([circle(0, ROLLER)])
    motion = OutlinePair(ECCENTRIC, roller, at_origin, Slide(1j)).follow(TURN, 40.0)
    reach = np.sqrt((RADIUS + ROLLER) ** 2 - (ECCENTRICITY * np.cos(TURN)) ** 2)
    assert np.max(np.abs(motion.samples.low - ECCENTRICITY * np.sin(TURN) - reach)) < 1e-13


@pytest.mark.parametrize(("drop", "told"), [(0.0, False), (1e-4, False), (4e-4, True)])
def test_a_tip_that_drops_by_more_than_rounding_jumps(drop: float, told: bool) -> None:
    """Off the end of a spiral of two half circles, rad: where it falls, and from where to where, by the triangle of its axles."""

    def opening(radius: float) -> float:
        return math.acos((DISTANCE**2 + ARM**2 - radius**2) / (2 * DISTANCE * ARM))

    high = -opening(RADIUS)
    low = math.sqrt(DISTANCE**2 + ARM**2 - 2 * DISTANCE * ARM * math.cos(high + drop))
    step = low - RADIUS
    points = np.array([RADIUS, -RADIUS, RADIUS + step] if drop else [RADIUS, -RADIUS], complex)
    spiral = Ring(points, np.array([1.0, 1.0, 0.0] if drop else [1.0, 1.0]))
    away = (DISTANCE - ARM * np.exp(1j * high)) / RADIUS * np.exp(-1j * high)
    tip = -ARM + np.array([0, 10 * away * np.exp(-0.2j), 10 * away * np.exp(0.2j)])
    pair = OutlinePair(Body([spiral]), Body([Ring(tip, np.zeros(3))]), pivots_apart(DISTANCE))
    found = pair.follow(TURN, high - 0.1).jumps("high")
    assert bool(found) is told
    for jump in found:
        at = math.acos((DISTANCE**2 + RADIUS**2 - ARM**2) / (2 * DISTANCE * RADIUS))
        assert jump.theta == pytest.approx(at, abs=1e-6)
        assert (jump.before, jump.after) == pytest.approx((high, high + drop), abs=1e-6)


def test_a_circle_swings_a_roller_on_an_arm_as_the_triangle_says() -> None:
    arm = Body([circle(-ARM, ROLLER)])
    motion = OutlinePair(ECCENTRIC, arm, pivots_apart(DISTANCE)).follow(TURN, -0.6)
    centre = ECCENTRICITY * np.exp(1j * TURN) - DISTANCE
    away = np.abs(centre)
    cosine = (ARM**2 + away**2 - (RADIUS + ROLLER) ** 2) / (2 * ARM * away)
    expected = np.angle(-centre) - np.arccos(cosine)
    assert np.max(np.abs(motion.samples.high - expected)) < 1e-14
    slope = motion.touch(motion.samples, "high").slope
    step = 1e-4
    beside = motion.bounds(np.array([1.0 - step, TURN[57], 1.0 + step])).high
    assert beside[1] == pytest.approx(expected[57], abs=1e-14)
    between = np.interp(1.0, TURN, slope)
    assert between == pytest.approx((beside[2] - beside[0]) / (2 * step), abs=1e-5)


# ---- the area of overlap ---------------------------------------------------------------------------------------------


def overlap(first: Ring, second: Ring) -> float:
    """Area that two polygons share."""
    shapes = [
        shapely.Polygon(np.column_stack([r.points.real, r.points.imag])) for r in (first, second)
    ]
    return float(shapely.intersection(*shapes).area)


@st.composite
def polygons(draw: st.DrawFn) -> Ring:
    """Star-shaped, 3 to 9 corners, 5 to 14 mm about the origin."""
    count = draw(st.integers(3, 9))
    radii = draw(st.lists(st.floats(5, 14), min_size=count, max_size=count))
    return Ring(np.array(radii) * np.exp(2j * np.pi * np.arange(count) / count), np.zeros(count))


@settings(max_examples=25, deadline=None)
@given(polygons(), polygons(), st.floats(15.0, 22.0), st.floats(0, 6.0))
def test_bounds_are_those_of_the_area_of_overlap(
    first: Ring, second: Ring, distance: float, theta: float
) -> None:
    pair = OutlinePair(Body([first]), Body([second]), pivots_apart(distance))
    samples = pair.follow(np.array([theta]), 0.0).samples
    driver = first.moved(np.exp(1j * theta), -distance)

    def shared(phi: float) -> float:
        return overlap(driver, second.moved(np.exp(1j * phi)))

    if not samples.free[0]:
        grid = np.linspace(-math.pi, math.pi, 181)
        assert min(shared(phi) for phi in grid) > 0
        return
    if math.isnan(samples.low[0]):
        assert max(shared(phi) for phi in np.linspace(-math.pi, math.pi, 181)) == 0
        return
    low = float(samples.low[0])
    high = float(samples.high[0])
    inside = np.linspace(low, high, 33)[1:-1]
    assert max(shared(phi) for phi in inside) < 1e-12
    for bound, sense in ((low, -1), (high, 1)):
        free = (low + high) / 2
        blocked = bound + sense * 1e-3 * min(1.0, (high - low) + 1e-3)
        assert shared(blocked) > 0
        for _ in range(40):
            middle = (free + blocked) / 2
            if shared(middle) > 0:
                blocked = middle
            else:
                free = middle
        # areas of slivers below 1e-16 mm2 are rounding
        assert free == pytest.approx(bound, abs=2e-7)


# ---- the proof -------------------------------------------------------------------------------------------------------


def test_long_steps_of_gears_are_proven_by_halving_them_alone(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    theta = np.linspace(0, math.pi / 3, 31)
    halved, _ = meshed(Wheel(2, 12), Wheel(2, 30), theta=theta)
    assert halved.samples.proven[1:].all()
    monkeypatch.setattr(pairs, "_FINEST", 0)
    coarse, _ = meshed(Wheel(2, 12), Wheel(2, 30), theta=theta)
    assert not coarse.samples.proven[1:].all()


@pytest.mark.long
def test_a_wheel_that_jams_is_free_nowhere_there() -> None:
    motion, _ = meshed(Wheel(2, 12), Wheel(2, 30), -0.5)
    assert not motion.samples.free.any()
