"""What is left out before the formulas of touches are asked changes nothing: against all pairs of features in each pose alone."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.spatial import cKDTree
from shapely import Polygon

from camgen.geometry.rings import Floats, Points, Ring
from camgen.judge.pair_events import Couples, Freedom, Meetings, Slide, Turn
from camgen.judge.pair_features import Features, features
from camgen.judge.pair_search import Bodies, Poses, _reached, greatest_way, nearing
from camgen.judge.pairs import Body, OutlinePair, pivots_apart

GAPS = [0.0, 1.5, -0.2]  # mm, between both bodies as they touch
DISTANCE = 34.0
EVERYWHERE = (math.inf, math.inf)
SAMPLED = 0.003  # mm, more than points on features, 0.08 apart, add to a distance of 1.5: 0.08^2 / (2 * 1.5)


def outline(chance: np.random.Generator, radius: float, hollow: bool) -> Ring:
    """A ragged one about the origin, of arcs and lines, with a few edges much longer than the others.

    One that crosses itself bounds no body: it is drawn again.
    """
    while True:
        count = int(chance.integers(5, 40))
        angle = np.sort(chance.uniform(0, 2 * math.pi, count))
        points = radius * chance.uniform(0.75, 1.05, count) * np.exp(1j * angle)
        bulges = np.where(chance.random(count) < 0.5, 0.0, chance.uniform(-0.4, 0.4, count))
        ring = Ring(points, bulges).counter_clockwise()
        z = ring.facetted(1e-6)
        if Polygon(np.column_stack([z.real, z.imag])).is_valid:
            return ring.reversed() if hollow else ring


def all_pairs(bodies: Bodies, place: complex, e: complex, gap: float) -> Meetings:
    """Each feature of the driver with each of the driven body in one pose, but for two lines."""
    i, j = (each.ravel() for each in np.indices((len(bodies.a), len(bodies.b))))
    turn = np.full(len(i), e)
    return Meetings(bodies.a, bodies.b, i, j, place + turn * bodies.a.centre[i], turn, gap)


def all_touches(m: Meetings, freedom: Freedom) -> list[tuple[float, bool]]:
    """Where all of them touch, and whether the touch closes."""
    line_a = m.a.straight[m.i]
    line_b = m.b.straight[m.j]
    found = []
    for formula, mask in (
        (freedom.rounds, ~line_a & ~line_b),
        (freedom.driver_lines, line_a & ~line_b & (m.b.radius[m.j] >= 0)),
        (freedom.driven_lines, ~line_a & line_b & (m.a.radius[m.i] >= 0)),
    ):
        events = formula(m.take(np.flatnonzero(mask)))
        found += zip(events.phi.tolist(), events.closing.tolist(), strict=True)
    return found


def next_touch(touches: list[tuple[float, bool]], guess: float, sense: int, period: float) -> float:
    """The way to the next touch that ends what is free; inf where there is none."""
    ways = [sense * (phi - guess) for phi, closing in touches if closing == (sense > 0)]
    if period < math.inf:
        ways = [way % period for way in ways]
    return min((way for way in ways if way >= 0), default=math.inf)


def pair_of(seed: int, slides: bool, gap: float) -> tuple[OutlinePair, np.random.Generator]:
    """Two ragged outlines near to each other, or one within the other."""
    chance = np.random.default_rng(seed)
    inside = bool(chance.random() < 0.3) and not slides
    driver = Body([outline(chance, 15.0, False)])
    driven = Body([outline(chance, 20.0, False)])
    distance = DISTANCE
    if inside:
        driven = Body([outline(chance, 24.0, True)])
        distance = 5.0
    freedom = Slide(complex(np.exp(1j * chance.uniform(0, 6)))) if slides else Turn()
    pose = pivots_apart(distance, (float(chance.uniform(-2, 2)), float(chance.uniform(-1, 1))))
    return OutlinePair(driver, driven, pose, freedom, -gap), chance


def moved(pair: OutlinePair, chance: np.random.Generator, step: float) -> tuple[Floats, Floats]:
    """Angles of the driver, and a guess of the driven body that goes along."""
    theta = chance.uniform(0, 6) + step * np.arange(40)
    scale = 1.0 if pair.freedom.period < math.inf else 12.0
    guess = scale * (chance.uniform(-3, 3) + chance.uniform(-1, 1) * (theta - theta[0]))
    return theta, guess


@pytest.mark.long
@settings(max_examples=80, deadline=None)
@given(
    st.integers(0, 2**32 - 1),
    st.booleans(),
    st.sampled_from(GAPS),
    st.sampled_from([1e-3, 0.02, 0.3, math.inf]),
    st.sampled_from([1e-4, 1e-2, 0.1]),
)
@example(1, False, 0.0, math.inf, 1e-2)
@example(2, True, 1.5, 0.02, 1e-2)
@example(183253444, True, -0.2, math.inf, 1e-4)
def test_bounds_are_those_of_all_pairs_of_features(
    seed: int, slides: bool, gap: float, window: float, step: float
) -> None:
    pair, chance = pair_of(seed, slides, gap)
    theta, guess = moved(pair, chance, step)
    scale = 12.0 if slides else 1.0
    below = window * scale * chance.uniform(0.5, 1, 40) if window < math.inf else window
    above = window * scale
    found, _, missed = pair.measured(theta, guess, (below, above), False)
    place, angle = pair.pose(theta, 0)
    for k in range(0, 40, 3):
        e = complex(np.exp(1j * angle[k]))
        touches = all_touches(all_pairs(pair.bodies, complex(place[k]), e, gap), pair.freedom)
        far = []
        for sense, value, most in ((-1, found.low[k], below), (1, found.high[k], above)):
            way = next_touch(touches, float(guess[k]), sense, pair.freedom.period)
            reach = float(np.broadcast_to(most, 40)[k])
            if abs(way - reach) < 1e-9:
                continue
            beyond = way > reach or way == math.inf
            far.append(beyond and reach < math.inf)
            assert math.isnan(value) == beyond
            if not beyond:
                assert sense * (value - guess[k]) == pytest.approx(way, abs=1e-9)
        assert bool(missed[k]) == any(far)


def beside_a_touch(
    pair: OutlinePair, chance: np.random.Generator, step: float
) -> tuple[Floats, Floats]:
    """The same, the guess just before a touch at the first pose, if there is one."""
    theta, guess = moved(pair, chance, step)
    scale = 1.0 if pair.freedom.period < math.inf else 12.0
    (touch,) = pair.measured(theta[:1], guess[:1], EVERYWHERE, False)[0].high
    way = scale * 10 ** chance.uniform(-5, -2)
    return theta, guess if math.isnan(touch) else guess + touch - guess[0] - way


def told_near(couples: Couples, poses: Poses, freedom: Freedom) -> list[int]:
    """Places of the pairs that may come to touch before the next pose, found by halving the list."""
    if not len(nearing(couples, poses, freedom, math.inf)):
        return []
    count = len(couples.i)
    if count == 1:
        return [0]
    parts = np.array_split(np.arange(count), 2)
    return [int(part[k]) for part in parts for k in told_near(couples.take(part), poses, freedom)]


def points_of(own: Features, k: int) -> Points:
    """Places on a feature, 25 of them, its ends included."""
    share = np.linspace(-1, 1, 25)
    along = own.centre[k] + 1j * own.middle[k] * own.length[k] * (share + 1) / 2
    return np.asarray(along + own.radius[k] * own.middle[k] * np.exp(1j * own.half[k] * share))


def least_distance(pair: OutlinePair, way: Floats) -> float:
    """Between both outlines at a pose, by points on their features, mm; way: angle of the driver and guess."""
    place, angle = pair.pose(way[:1], 0)
    a, b = pair.bodies.a, pair.bodies.b
    first = np.concatenate([points_of(a, k) for k in range(len(a.radius))])
    second = np.concatenate([points_of(b, k) for k in range(len(b.radius))])
    first = place + np.exp(1j * angle) * first
    second = pair.freedom.moved(way[1:]) + pair.freedom.turned(way[1:]) * second
    tree = cKDTree(np.column_stack([second.real, second.imag]))
    return float(np.min(tree.query(np.column_stack([first.real, first.imag]))[0]))


def distances(pair: OutlinePair, i: int, j: int, ways: Floats) -> Floats:
    """Of two features at some poses, (n,) mm; ways: angle of the driver and guess, (n, 2)."""
    theta, guess = ways.T
    place, angle = pair.pose(theta, 0)
    turned = pair.freedom.turned(guess)[:, None]
    first = place[:, None] + np.exp(1j * angle)[:, None] * points_of(pair.bodies.a, i)
    second = pair.freedom.moved(guess)[:, None] + turned * points_of(pair.bodies.b, j)
    return np.asarray(np.min(np.abs(first[:, :, None] - second[:, None]), axis=(1, 2)))


@pytest.mark.long
@settings(max_examples=60, deadline=None)
@given(
    st.integers(0, 2**32 - 1),
    st.booleans(),
    st.sampled_from(GAPS),
    st.sampled_from([1e-4, 1e-3, 1e-2]),
)
@example(3, False, 1.5, 1e-3)
@example(95874, True, 1.5, 1e-2)
@example(1, False, 1.5, 1e-2)
@example(14, False, 1.5, 1e-2)
def test_a_step_is_proven_where_all_pairs_stay_apart(
    seed: int, slides: bool, gap: float, step: float
) -> None:
    """A guess that is free and proven stays so, by the distance of both outlines; a step is proven where no pair at all may touch,
    and a pair that may touch is left out only if it is farther than anything moves. The guess begins beside a touch."""
    pair, chance = pair_of(seed, slides, gap)
    theta, guess = beside_a_touch(pair, chance, step)
    window = 1e-4  # so small that it hides no fault of what sieves by it
    _, ahead, _ = pair.measured(theta, guess, (window, window))
    poses = pair.poses(theta, guess, EVERYWHERE)
    a = pair.bodies.a
    b = pair.bodies.b
    lines = np.add.outer(a.straight.astype(int), b.straight)
    hollows = np.add.outer((a.radius < 0).astype(int), b.radius < 0)
    i, j = np.nonzero(lines + hollows <= 1)
    for k in range(39):
        here = poses.take(np.array([k]))
        none = np.zeros(len(i), np.int64)
        every = Couples(a, b, i, j, none, here.place[:, None], here.e[:, None], gap)
        near = told_near(every, here, pair.freedom)
        assert near or ahead[k]
        ways = np.linspace([theta[k], guess[k]], [theta[k + 1], guess[k + 1]], 4)
        if gap > 0 and ahead[k] and least_distance(pair, ways[0]) > gap + SAMPLED:
            assert min(least_distance(pair, each) for each in ways[1:]) > gap
        way = greatest_way(pair.bodies, here) + abs(gap)
        for n in near:
            apart = distances(pair, int(i[n]), int(j[n]), ways[:1])
            told = nearing(every.take(np.array([n])), here, pair.freedom, way)
            assert len(told) or apart[0] > way


@pytest.mark.parametrize(
    ("apart", "change", "reached"),
    [
        (5.0, -6.0, True),  # to both sides of zero
        (-5.0, 6.0, True),
        (5.0, -4.95, True),  # as near as what is spared
        (-5.0, 4.95, True),
        (5.0, -4.8, False),
        (-5.0, 4.8, False),
        (5.0, 6.0, False),  # farther away
        (-5.0, -6.0, False),
        (0.05, 6.0, True),
        (-0.05, -6.0, True),
    ],
)
def test_a_distance_comes_to_zero_on_its_way(apart: float, change: float, reached: bool) -> None:
    found = _reached(np.array([apart]), np.array([change]), np.array([0.1]))
    assert found.tolist() == [reached]


def test_a_touch_across_a_gap_is_told_before_it_comes() -> None:
    """Features that are to stay a gap apart are never near by their own size alone."""
    told = 0
    for seed in range(12):
        pair, chance = pair_of(seed, bool(seed % 2), 1.5)
        theta, guess = beside_a_touch(pair, chance, 1e-2)
        _, ahead, _ = pair.measured(theta, guess, EVERYWHERE)
        told += np.count_nonzero(~ahead)
    assert told >= 12


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_a_group_holds_its_features_and_their_normals(seed: int) -> None:
    chance = np.random.default_rng(seed)
    own = features([outline(chance, 15.0, False), outline(chance, 4.0, True)])
    for level, groups in enumerate(own.tree):
        of = np.arange(len(own)) >> level
        assert len(groups) == of[-1] + 1
        assert np.all(np.abs(own.hub - groups.hub[of]) + own.reach <= groups.reach[of] + 1e-9)
        off = np.angle(own.middle * np.exp(-1j * groups.angle[of]))
        assert np.all(np.abs(off) + own.half <= np.maximum(groups.half[of], 0) + 1e-9) or np.any(
            groups.half >= math.pi
        )


def test_features_follow_each_other_along_the_outline() -> None:
    """So that groups of those that follow each other are small."""
    square = Ring(np.array([10 + 10j, -10 + 10j, -10 - 10j, 10 - 10j]), np.zeros(4))
    own = features([square])
    assert np.max(np.abs(np.diff(own.hub))) <= 0.011 * square.length
