"""Contact of a round tip with a turning outline, against closed forms and an independent sphere trace."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.spatial import ConvexHull
from shapes import polygon, rounded

from camgen.geometry.rings import Ring
from camgen.judge.contact import RollingContact, Touch, _merged, contact
from camgen.judge.contact_faces import ArmFace, SlideFace
from camgen.judge.contact_tips import ArmTip, Form, SlideTip
from camgen.machine.closed_form import slider_travel

EXACT = 1e-9  # mm, what the contact claims


def disc(centre: complex, radius: float) -> Ring:
    """A disc of two half-circles."""
    return Ring(centre + radius * np.array([1, -1 + 0j]), np.ones(2))


def sense(pivot: complex, arm: complex) -> int:
    """The sense in which the arm leaves the origin."""
    return -1 if (arm * np.conj(pivot)).imag > 0 else 1


def distance(z: np.ndarray, p: np.ndarray) -> np.ndarray:
    """Distance of each p from the area of the polygon z, 0 inside: point to segment, no shared code."""
    a, b = z, np.roll(z, -1)
    ab = b - a
    ap = p[:, None] - a
    u = np.clip(np.real(ap * np.conj(ab)) / np.abs(ab) ** 2, 0, 1)
    free = np.min(np.abs(ap - u * ab), axis=1)
    crosses = (a.imag > p.imag[:, None]) != (b.imag > p.imag[:, None])
    with np.errstate(divide="ignore", invalid="ignore"):
        x = a.real + (p.imag[:, None] - a.imag) / ab.imag * ab.real
    inside = np.count_nonzero(crosses & (x > p.real[:, None]), axis=1) % 2 == 1
    return np.where(inside, 0.0, free)


def trace(
    z: np.ndarray, pivot: complex, arm: complex, rho: float, leaves: int, theta: np.ndarray
) -> np.ndarray:
    """First touch by steps that can never pass through: the tip moves in by no more than its free distance.

    Starts where arm and pivot are in line, ends where they are again (nan).
    """
    rest = abs(np.angle(arm / pivot))
    psi, todo = np.zeros(len(theta)), np.arange(len(theta))
    psi[:] = 0.0
    for _ in range(4000):
        c = pivot + arm * np.exp(1j * -leaves * (psi[todo] - rest))
        gap = distance(z, c * np.exp(-1j * theta[todo])) - rho
        psi[todo] += np.maximum(gap, 0) / abs(arm)
        todo = todo[(gap > 1e-12) & (psi[todo] < np.pi)]
        if not len(todo):
            break
    psi[psi >= np.pi] = np.nan
    return -leaves * (psi - rest)


def agree(table: RollingContact, z: np.ndarray, rho: float, theta: np.ndarray) -> Touch:
    """The answer touches, and nothing is touched before it, both to EXACT.

    A tip that grazes the outline by less than EXACT before it rests on it may count as touching there or not.
    """
    pivot, arm, leaves = table.form.pivot, table.form.arm, table.form.leaves
    touch = table.touch(theta)
    slow = trace(z, pivot, arm, rho, leaves, theta)

    def grazes(k: int) -> bool:
        """Whether one answer alone touches, or earlier, and does not go deeper than EXACT there."""
        angles = np.array([touch.angle[k], slow[k]])
        near = float(np.nanmax(leaves * angles)) * leaves
        way = near - leaves * np.concatenate([[0.0], np.geomspace(1e-9, 1e-4, 40)])
        if not np.isnan(angles).any():
            way = np.linspace(angles[0], angles[1], 41)
        return bool(
            np.min(distance(z, (pivot + arm * np.exp(1j * way)) * np.exp(-1j * theta[k])))
            > rho - EXACT
        )

    apart = np.isnan(touch.angle) != np.isnan(slow)
    apart |= np.abs(touch.angle - slow) * abs(arm) * np.cos(touch.pressure_angle) >= 2 * EXACT
    sure = np.array([not (apart[k] and grazes(k)) for k in range(len(theta))])
    theta, slow, touch = (
        theta[sure],
        slow[sure],
        Touch(*(values[sure] for values in vars(touch).values())),
    )
    reached = ~np.isnan(touch.angle)
    assert np.array_equal(reached, ~np.isnan(slow))
    c = pivot + arm * np.exp(1j * touch.angle[reached])
    gap = distance(z, c * np.exp(-1j * theta[reached])) - rho
    assert np.max(np.abs(gap), initial=0) < EXACT
    missed = np.abs(slow - touch.angle)[reached] * abs(arm) * np.cos(touch.pressure_angle[reached])
    assert np.max(missed, initial=0) < 2 * EXACT
    return touch


@pytest.mark.parametrize("radius", [0.0, 3.0])
@pytest.mark.parametrize("size", [0.1, 1.0, 100.0])
@pytest.mark.parametrize("arm", [-67 - 25j, -67 + 25j])
def test_disc_of_arcs_is_a_four_bar(radius: float, size: float, arm: complex) -> None:
    """An off-centre disc of two arcs: ground, crank e, coupler r + rho, rocker; two-circle closed form."""
    centre, r, pivot = size * (5 + 2j), size * 20.0, size * (50 - 30j)
    arm = arm * size * pivot / abs(pivot)
    leaves, rho = sense(pivot, arm), size * radius
    theta = np.random.default_rng(3).uniform(-50, 50, 2000)
    touch = contact(disc(centre, r), ArmTip(pivot, arm, rho, leaves)).touch(theta)
    base = centre * np.exp(1j * theta) - pivot
    d = np.abs(base)
    opening = np.arccos((d**2 + abs(arm) ** 2 - (r + rho) ** 2) / (2 * d * abs(arm)))
    expected = np.angle(base * np.exp(1j * leaves * opening) / arm)
    assert np.max(np.abs(touch.angle - expected)) < 1e-14 * 67
    tip = pivot + arm * np.exp(1j * touch.angle)
    normal = tip - centre * np.exp(1j * theta)
    speed = leaves * 1j * arm * np.exp(1j * touch.angle)
    assert np.max(np.abs(touch.pressure_angle - np.angle(normal / speed))) < 1e-12
    lower = (normal * np.exp(-1j * theta)).imag < 0
    assert np.array_equal(touch.element, lower.astype(int))


@pytest.mark.parametrize("distance_to_pivot", [0.1, 1.0, 1e3, 1e4])
def test_pivots_near_and_far(distance_to_pivot: float) -> None:
    """The tip circle stays tangent to the disc, to EXACT, from L = 0.1 to 10,000 mm."""
    centre, r, rho, pivot = 3 + 1j, 20.0, 2.0, distance_to_pivot * np.exp(0.7j)
    arm = (
        22j - pivot
        if distance_to_pivot < 20
        else abs(pivot) * np.exp(1j * (np.pi + 0.7 + 22 / distance_to_pivot))
    )
    theta = np.random.default_rng(4).uniform(0, 7, 2000)
    angle = contact(disc(centre, r), ArmTip(pivot, arm, rho, sense(pivot, arm))).angle(theta)
    reached = ~np.isnan(angle)
    assert reached.mean() > (0.99 if distance_to_pivot > 20 else 0.0)
    tip = pivot + arm * np.exp(1j * angle[reached])
    off = np.abs(tip - centre * np.exp(1j * theta[reached])) - r - rho
    assert np.max(np.abs(off), initial=0) < EXACT


@pytest.mark.long
def test_mixed_arcs_and_edges_with_a_fillet_the_tip_just_fits() -> None:
    """Outline with convex and concave arcs: the same motion as a finely facetted one, to the facets' tolerance."""
    # A rounded notch of radius 3 between two edges, on a disc-like outline.
    ring = Ring(
        np.array([30 - 20j, 30 - 3j, 30 + 3j, 30 + 20j, -25 + 20j, -25 - 20j], complex),
        np.array([0, -1.0, 0, 0.3, 0.4, 0.3]),
    )
    pivot, arm = 80 + 0j, -48 - 25j
    theta = np.random.default_rng(5).uniform(0, 2 * np.pi, 150)
    for rho in (0.0, 2.0, 3.0, 3.5):
        exact = contact(ring, ArmTip(pivot, arm, rho, 1)).touch(theta)
        slow = trace(ring.facetted(1e-5), pivot, arm, rho, 1, theta)
        assert not np.isnan(exact.angle).any()
        off = np.abs(exact.angle - slow) * abs(arm) * np.cos(exact.pressure_angle)
        assert np.max(off) < 3e-5


@pytest.mark.parametrize("rho", [1.5, 2.0, 2.5])
def test_a_tip_rests_on_the_ground_of_a_wider_notch(rho: float) -> None:
    """Half round, of radius 3 about (30, 0): a tip in its middle is 27 mm and its own radius from the axis, and an arm of known
    length reaches there at one angle."""
    notch = Ring(
        np.array([30 - 20j, 30 - 3j, 30 + 3j, 30 + 20j, -25 + 20j, -25 - 20j], complex),
        np.array([0, -1.0, 0, 0, 0, 0]),
    )
    pivot, arm, far = 62 + 0j, -48 - 25j, 27 + rho
    x = (far**2 + 62**2 - abs(arm) ** 2) / 124  # where circles about axis and pivot meet, below
    tip = complex(x, -np.sqrt(far**2 - x**2))
    angle = contact(notch, ArmTip(pivot, arm, rho, 1)).angle(np.angle(tip))
    assert angle == pytest.approx(np.angle((tip - pivot) / arm), abs=1e-12)


def star(seed: int, count: int, noise: float) -> np.ndarray:
    """A star-shaped polygon about the origin with noise on its radius, mm."""
    rng = np.random.default_rng(seed)
    phi = np.sort(rng.uniform(0, 2 * np.pi, count))
    phi += np.linspace(0, 1e-3, count)
    radius = 25 + 6 * np.cos(phi + seed) + noise * rng.standard_normal(count).clip(-2, 2)
    return radius * np.exp(1j * phi)


@pytest.mark.long
@settings(max_examples=150)
@given(
    seed=st.integers(0, 10**6),
    count=st.integers(12, 90),
    noise=st.sampled_from([0.0, 0.1, 1.0, 4.0]),
    rho=st.sampled_from([0.0, 0.5, 3.0, 10.0]),
    arm=st.sampled_from([-60 + 30j, -60 - 30j, -40 + 20j, -75 - 50j]),
    bearing=st.floats(-3.1, 3.1),
)
def test_noisy_polygons_against_the_trace(
    seed: int, count: int, noise: float, rho: float, arm: complex, bearing: float
) -> None:
    """Concave corners, edges past 90 deg of pressure angle, knife edges: the first touch, to EXACT."""
    z, turn = star(seed, count, noise), np.exp(1j * bearing)
    pivot, arm = 60 * turn, arm * turn
    theta = np.random.default_rng(seed).uniform(-9, 9, 60)
    agree(contact(polygon(z), ArmTip(pivot, arm, rho, sense(pivot, arm))), z, rho, theta)


def test_edges_pass_90_degrees_of_pressure_angle() -> None:
    """A ratchet tooth and a deep notch: the tip drops off a point, and the elements beneath it stay untouched."""
    z = np.array([20 - 20j, 35 + 2j, 18 + 4j, 26 + 12j, 10 + 26j, -2 + 8j, -24 + 18j, -26 - 14j])
    theta = np.random.default_rng(6).uniform(0, 2 * np.pi, 700)
    for arm in (-60 - 30j, -60 + 30j):
        for rho in (0.0, 1.0, 6.0):
            table = contact(polygon(z), ArmTip(60 + 0j, arm, rho, sense(60 + 0j, arm)))
            touch = agree(table, z, rho, theta)
            assert np.max(np.abs(touch.pressure_angle)) > np.radians(75)
            assert np.max(np.abs(touch.pressure_angle)) <= np.pi / 2


def test_origin_outside_the_outline_leaves_angles_without_contact() -> None:
    z = 40 + 9j + 6 * np.exp(2j * np.pi * np.arange(7) / 7)
    theta = np.random.default_rng(7).uniform(0, 2 * np.pi, 300)
    touch = agree(contact(polygon(z), ArmTip(60 + 0j, -60 + 30j, 2.0, -1)), z, 2.0, theta)
    none = np.isnan(touch.angle)
    assert 0.3 < none.mean() < 0.95
    assert (touch.element[none] == -1).all() and (touch.element[~none] >= 0).all()


def test_mirrored_setup_gives_the_mirrored_answer() -> None:
    z = star(11, 60, 2.0)
    theta = np.random.default_rng(8).uniform(-7, 7, 500)
    here = contact(polygon(z), ArmTip(55 + 10j, -60 + 30j, 3.0, -1)).touch(theta)
    there = contact(polygon(np.conj(z)[::-1]), ArmTip(55 - 10j, -60 - 30j, 3.0, 1)).touch(-theta)
    np.testing.assert_allclose(there.angle, -here.angle, rtol=0, atol=1e-13)
    np.testing.assert_allclose(there.pressure_angle, -here.pressure_angle, rtol=0, atol=1e-9)


@given(st.integers(0, 10**6))
@settings(max_examples=30)
def test_turning_part_and_ground_together(seed: int) -> None:
    """Part turned by t, ground turned by g: the angle asked at theta is that of theta - t + g, over many turns."""
    rng = np.random.default_rng(seed)
    z, t, g = star(seed, 40, 1.0), rng.uniform(-9, 9), rng.uniform(-9, 9)
    pivot, arm, theta = 60 + 5j, -60 + 20j, rng.uniform(-100, 100, 200)
    here = contact(polygon(z), ArmTip(pivot, arm, 1.5, -1)).touch(theta)
    turn = np.exp(1j * g)
    there = contact(polygon(z * np.exp(1j * t)), ArmTip(pivot * turn, arm * turn, 1.5, -1)).touch(
        theta - t + g
    )
    off = np.abs(here.angle - there.angle) * np.cos(here.pressure_angle)
    assert np.nanmax(off) < 1e-11


def test_outline_beyond_the_reach_blocks_the_tip() -> None:
    """L = 20, R = 15: a spike to 50 mm cannot be left, so nan there; the disc elsewhere is touched."""
    z = np.array([20 + 1j, -20 + 20j, -20 - 20j, 20 - 1j, 50 + 0j])
    table = contact(polygon(z), ArmTip(20 + 0j, 15j, 0.0, -1))
    bearing = np.linspace(-0.4, 0.4, 81)
    blocked = np.isnan(table.angle(-bearing))
    assert blocked[40] and not blocked.all()


def test_not_finite_angles_answer_nan_and_shapes_are_kept() -> None:
    table = contact(disc(1, 20.0), ArmTip(60 + 0j, -60 + 30j, 3.0, -1))
    answer = table.angle(np.array([[0.0, np.nan], [np.inf, 1.0]]))
    assert answer.shape == (2, 2)
    assert np.isnan(answer).tolist() == [[False, True], [True, False]]
    assert table.angle(0.25).shape == ()
    assert table.angle(np.array([])).shape == (0,)


def test_bounds_of_intervals_are_distinct() -> None:
    """From 0 to the whole turn, each once, 0 and the turn being the same place."""
    bounds, which = _merged(np.array([0.0, 2.0, 1.0, 2.0, 2 * np.pi]))
    assert bounds.tolist() == [0, 1, 2, 2 * np.pi] and which.tolist() == [0, 2, 1, 2, 0]


@pytest.mark.parametrize("rho", [0.0, 2.0])
def test_no_gap_at_the_ends_of_the_intervals(rho: float) -> None:
    """Angles at, and one step of float64 beside, every bound of the table: always an answer, and a right one.

    Where the tip drops off a point, either side of the drop is right.
    """
    z = star(5, 80, 0.5)
    table = contact(
        polygon(z), ArmTip(60 + 0j, -60 + 30j, rho, -1)
    )  # pivot on Ox, arm above: theta is used as it is
    bounds = table.breaks[:-1]
    near = np.concatenate(
        [bounds, np.nextafter(bounds, -1), np.nextafter(bounds, 9), bounds + 1e-12, bounds - 1e-12]
    )
    touch = table.touch(near)
    traces = [trace(z, 60 + 0j, -60 + 30j, rho, -1, near + step) for step in (-3e-12, 0, 3e-12)]
    off = np.min([np.abs(touch.angle - slow) for slow in traces], axis=0) * np.cos(
        touch.pressure_angle
    )
    assert np.max(off) * 67 < EXACT


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"leaves": 1}, "does not take the tip away"),
        ({"leaves": 0}, "does not take the tip away"),
        ({"tip_radius": -1.0}, "no contact"),
        ({"tip_radius": float("nan")}, "no contact"),
        ({"pivot": 0j}, "no contact"),
        ({"ring": disc(0, 20.0).reversed()}, "counter-clockwise"),
    ],
)
def test_setups_that_make_no_sense(change: dict[str, object], words: str) -> None:
    setup = {
        "ring": disc(0, 20.0),
        "pivot": 60 + 0j,
        "arm": -60 + 30j,
        "tip_radius": 3.0,
        "leaves": -1,
    } | change
    ring = setup.pop("ring")
    with pytest.raises(ValueError, match=words):
        contact(ring, ArmTip(**setup))  # type: ignore[arg-type]


def test_a_moved_vertex_is_seen() -> None:
    """The measure itself can fail: a vertex moved by 1 um shifts the answer by about as much, and only near it."""
    z = 25 * np.exp(2j * np.pi * np.arange(200) / 200)
    theta = np.linspace(0, 2 * np.pi, 2000, endpoint=False)
    good = contact(polygon(z), ArmTip(60 + 0j, -60 + 25j, 3.0, -1)).angle(theta)
    z[70] *= 1 + 1e-3 / 25
    bad = contact(polygon(z), ArmTip(60 + 0j, -60 + 25j, 3.0, -1)).angle(theta)
    moved = np.abs(bad - good) * 65
    assert 0.9e-3 < moved.max() < 1.2e-3
    assert np.mean(moved > 1e-9) < 0.02


# ---- slides and faces ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("size", [0.1, 1.0, 100.0])
@pytest.mark.parametrize(
    ("radius", "eccentricity", "roller"), [(20.0, 5.0, 3.0), (20.0, 1.5, 0.0), (12.0, 11.0, 40.0)]
)
@pytest.mark.parametrize("leaves", [1, -1])
def test_in_line_tip_on_an_off_centre_disc_is_a_slider_crank(
    size: float, radius: float, eccentricity: float, roller: float, leaves: int
) -> None:
    """Crank e, rod a + r: s = e cos t + sqrt((a + r)^2 - e^2 sin^2 t); to 1e-12 of the size, with arcs."""
    a, e, r = size * radius, size * eccentricity, size * roller
    theta = np.random.default_rng(1).uniform(-50, 50, 3000)
    for along in (1 + 0j, 1j, np.exp(0.3j)):
        t = theta - np.angle(leaves * along)
        touch = contact(disc(complex(e), a), SlideTip(0j, along, r, leaves)).touch(theta)
        way = (e + a + r) - leaves * touch.angle
        assert np.max(np.abs(way - slider_travel(t, e, a + r))) < 1e-12 * max(1.0, size)
        normal = np.arcsin(e * np.sin(t) / (a + r))
        np.testing.assert_allclose(touch.pressure_angle, -normal, atol=1e-12)


def marched(
    z: np.ndarray, start: complex, ahead: complex, rho: float, theta: np.ndarray
) -> np.ndarray:
    """Way of a tip along `ahead` from `start` at first touch, by steps that can never pass through, from 80 mm off."""
    x, todo = np.full(len(theta), 80.0), np.arange(len(theta))
    for _ in range(6000):
        gap = distance(z, (start + ahead * x[todo]) * np.exp(-1j * theta[todo])) - rho
        x[todo] -= np.maximum(gap, 0)
        todo = todo[(gap > 1e-12) & (x[todo] > -80)]  # some never meet it
        if not len(todo):
            break
    return x


@settings(max_examples=60)
@given(
    seed=st.integers(0, 10**6),
    noise=st.sampled_from([0.0, 0.1, 1.0, 4.0]),
    rho=st.sampled_from([0.0, 0.5, 3.0, 10.0]),
    aside=st.floats(-8, 8),
    bearing=st.floats(-3.1, 3.1),
    leaves=st.sampled_from([1, -1]),
)
def test_slides_on_noisy_polygons(
    seed: int, noise: float, rho: float, aside: float, bearing: float, leaves: int
) -> None:
    """First touch of a sliding tip against the march, of faces against the highest vertex; place and pressure too."""
    z, along = star(seed, 40, noise), np.exp(1j * bearing)
    start, ahead = along * (2 + 1j * aside), leaves * along
    theta = np.random.default_rng(seed).uniform(-9, 9, 40)
    touch = contact(polygon(z), SlideTip(start, along, rho, leaves)).touch(theta)
    x = marched(z, start, ahead, rho, theta)
    before = (
        np.real((start + ahead * x) * np.conj(ahead)) > 0
    )  # past the axis a tip would come out on the other side
    off = np.abs(leaves * x - touch.angle)[before] * np.cos(touch.pressure_angle[before])
    assert np.max(off, initial=0) < EXACT

    ground = z[None] * np.exp(1j * theta[:, None])
    face = contact(polygon(z), SlideFace(start, along, leaves)).touch(theta)
    heights = np.real((ground - start) * np.conj(ahead))
    assert np.max(np.abs(leaves * np.max(heights, axis=1) - face.angle)) < 1e-12
    k = np.argmax(heights, axis=1)
    assert (
        np.max(np.abs(np.imag((ground[np.arange(40), k] - start) * np.conj(ahead)) - face.place))
        < 1e-9
    )


@settings(max_examples=40)
@given(
    seed=st.integers(0, 10**6),
    noise=st.sampled_from([0.0, 0.1, 1.0]),
    ahead=st.floats(-6, 12, allow_subnormal=False),
    bearing=st.floats(-3.1, 3.1),
    leaves=st.sampled_from([1, -1]),
)
def test_a_swinging_face_on_noisy_polygons(
    seed: int, noise: float, ahead: float, bearing: float, leaves: int
) -> None:
    """Tangent from each vertex by the triangle at the pivot; the first that the face meets; contact normal by definition."""
    z, pivot = star(seed, 40, noise), 70 * np.exp(1j * bearing)
    facing = pivot / 70 * np.exp(-1.2j * leaves)
    theta = np.random.default_rng(seed).uniform(-9, 9, 40)
    touch = contact(polygon(z), ArmFace(complex(pivot), complex(facing), ahead, leaves)).touch(
        theta
    )
    ground = z[None] * np.exp(1j * theta[:, None])
    spoke = (ground - pivot) / facing
    met = np.angle(spoke * np.exp(1j * leaves * np.arccos(ahead / np.abs(spoke))))
    assert np.max(np.abs(leaves * np.max(leaves * met, axis=1) - touch.angle)) < 1e-12
    normal = facing * np.exp(1j * touch.angle)
    deepest = np.max(np.real((ground - pivot) * np.conj(normal)[:, None]), axis=1)
    assert np.max(np.abs(deepest - ahead)) < EXACT
    at = ground[np.arange(40), np.argmax(leaves * met, axis=1)]
    assert np.max(np.abs(np.imag(np.conj(normal) * (at - pivot)) - touch.place)) < 1e-9
    assert (
        np.max(np.abs(np.angle(normal / (1j * leaves * (at - pivot))) - touch.pressure_angle))
        < 1e-9
    )


@pytest.mark.long
@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 10**6),
    count=st.integers(3, 5),
    radius=st.floats(0.2, 8),
    far=st.floats(8, 40),
    ahead=st.floats(-15, 20),
    leaves=st.sampled_from([1, -1]),
)
@example(seed=4, count=4, radius=2.0, far=12.0, ahead=14.0, leaves=1)
@example(seed=5, count=3, radius=1.0, far=10.0, ahead=12.0, leaves=-1)
def test_a_face_comes_down_on_a_part_that_reaches_past_its_pivot(
    seed: int, count: int, radius: float, far: float, ahead: float, leaves: int
) -> None:
    """The first angle at which a face, turned down from where it faces away from the origin, lies as deep as the part is high
    in its direction; none where the part is higher from the start."""
    rng = np.random.default_rng(seed)
    turns = (np.arange(count) + rng.uniform(0, 0.9, count)) * (2 * np.pi / count)
    corners = hull(rng.uniform(2, 20, count) * np.exp(1j * turns))
    theta, down = rng.uniform(-9, 9, 60), np.linspace(0, np.pi, 4001)
    found = contact(
        rounded(corners, radius), ArmFace(far + 0j, complex(np.exp(-1.2j * leaves)), ahead, leaves)
    ).angle(theta)
    ways = theta[:, None, None] + leaves * down[:, None]  # of corners against the face's normal
    room = (
        far * np.cos(down) + ahead - np.max(np.real(corners * np.exp(1j * ways)), axis=2) - radius
    )
    met = np.argmax(room <= 0, axis=1)
    none = (room[:, 0] <= 0) | np.all(room > 0, axis=1)
    assert np.array_equal(np.isnan(found), none)
    k = np.flatnonzero(~none)
    before, after = room[k, met[k] - 1], room[k, met[k]]
    wanted = down[met[k]] + (down[1] - down[0]) * after / (before - after)
    assert (
        np.max(np.abs(leaves * found[k] - (1.2 - wanted)), initial=0) < 2e-3
    )  # on a grid: less where it does not graze


def hull(points: np.ndarray) -> np.ndarray:
    """The convex hull of points, counter-clockwise, that are not all on one line."""
    return points[ConvexHull(np.column_stack([points.real, points.imag])).vertices]


@pytest.mark.long
@settings(max_examples=40, deadline=None)
@given(
    seed=st.integers(0, 10**6),
    count=st.integers(3, 5),
    radius=st.sampled_from([1.0, 6.0, 12.0]),
    rho=st.sampled_from([0.0, 4.0]),
    far=st.floats(45, 70),
    leaves=st.sampled_from([1, -1]),
)
def test_noses_that_a_tip_grazes(
    seed: int, count: int, radius: float, rho: float, far: float, leaves: int
) -> None:
    """Discs round slim polygons, met by tips on an arm and on a slide until they pass by: as if the tip were larger by them."""
    rng = np.random.default_rng(seed)
    corners = hull(
        rng.uniform(4, 22, count)
        * np.exp(1j * (np.arange(count) + rng.uniform(0, 0.9, count)) * 2 * np.pi / count)
    )
    ring = rounded(corners, radius)
    if distance(corners, np.zeros(1, complex))[0] > 0:
        ring, corners = ring.moved(shift=-ring.centroid), corners - ring.centroid
    theta = rng.uniform(-9, 9, 60)
    pivot = far * np.exp(1j * rng.uniform(-3, 3))
    arm = pivot * np.exp(1j * (np.pi + leaves * rng.uniform(0.3, 1.2))) * rng.uniform(0.7, 1.05)
    agree(
        contact(ring, ArmTip(complex(pivot), complex(arm), rho, leaves)),
        corners,
        radius + rho,
        theta,
    )
    along = np.exp(1j * rng.uniform(-3, 3))
    start, ahead = along * complex(2, rng.uniform(-12, 12)), leaves * along
    touch = contact(ring, SlideTip(complex(start), complex(along), rho, leaves)).touch(theta)
    x = marched(corners, start, ahead, radius + rho, theta)
    before = np.real((start + ahead * x) * np.conj(ahead)) > 0
    off = np.abs(leaves * x - touch.angle)[before] * np.cos(touch.pressure_angle[before])
    assert np.max(off, initial=0) < EXACT


@settings(max_examples=40, deadline=None)
@given(
    seed=st.integers(0, 10**6),
    radius=st.sampled_from([0.5, 2.0]),
    far=st.floats(15, 45),
    reach=st.floats(0.4, 1.3),
    start=st.integers(0, 99),
    leaves=st.sampled_from([1, -1]),
)
def test_the_vertex_with_which_a_ring_begins_says_nothing(
    seed: int, radius: float, far: float, reach: float, start: int, leaves: int
) -> None:
    """Of outlines that reach further than the arm, too: these block it, whichever element comes first."""
    ring = rounded(hull(star(seed, 12, 4.0) * 1.5), radius)
    start %= len(ring.points)
    rolled = Ring(np.roll(ring.points, -start), np.roll(ring.bulges, -start))
    tip = far * (1 - reach * np.exp(0.7j * leaves))
    theta = np.random.default_rng(seed).uniform(-9, 9, 60)
    forms: list[Form] = [
        ArmTip(complex(far), complex(tip - far), radius, leaves),
        ArmFace(complex(far), complex(np.exp(-1.2j * leaves)), far / 9, leaves),
        SlideTip(complex(far / 4), 1j, radius, 1),
        SlideFace(1j, 1j, 1),
    ]
    for form in forms:
        np.testing.assert_allclose(
            contact(rolled, form).angle(theta), contact(ring, form).angle(theta), atol=1e-12
        )


@pytest.mark.long
@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 10**6),
    count=st.integers(3, 7),
    radius=st.sampled_from([0.5, 4.0, 12.0]),
    far=st.floats(14, 60),
    ahead=st.floats(-20, 20),
    bearing=st.floats(-3.1, 3.1),
    leaves=st.sampled_from([1, -1]),
)
@example(
    seed=285, count=3, radius=0.5, far=14, ahead=0, bearing=0, leaves=1
)  # a corner that is farther off than the pivot
@example(
    seed=0, count=3, radius=0.5, far=14, ahead=18, bearing=1, leaves=1
)  # a face that would meet it after half a turn
def test_a_swinging_face_comes_down_on_what_is_beside_its_pivot(
    seed: int, count: int, radius: float, far: float, ahead: float, bearing: float, leaves: int
) -> None:
    """Turned in from where it faces straight away, by small steps: it stops where the part's height is its own. A part that
    reaches over it there holds it off for good."""
    rng = np.random.default_rng(seed)
    corners = hull(rng.uniform(-12, 12, count) + 1j * rng.uniform(-12, 12, count))
    ring, pivot = rounded(corners, radius), far * np.exp(1j * bearing)
    if ring.centroid and not ring.encloses(0):  # a shaft through it
        ring, corners = ring.moved(shift=-ring.centroid), corners - ring.centroid
    facing = np.exp(1j * (bearing - 1.2 * leaves))
    if abs((np.conj(facing) * pivot).imag) < 1e-3:
        return
    theta = rng.uniform(-9, 9, 40)
    touch = contact(ring, ArmFace(complex(pivot), complex(facing), ahead, leaves)).touch(theta)

    def over(nu: np.ndarray, k: np.ndarray) -> np.ndarray:
        """How far the part reaches over the face, which faces nu from the pivot's direction; (steps, angles)."""
        normal = np.exp(1j * (bearing + leaves * nu))
        reach = (
            np.real(corners[:, None, None] * np.exp(1j * theta[k]) * np.conj(normal)).max(axis=0)
            + radius
        )
        return np.asarray(reach - ahead - far * np.cos(nu))

    nu = np.linspace(0, -np.pi, 2001)[:, None] + np.zeros(len(theta))
    gaps = over(nu, np.arange(len(theta)))
    blocked, meets = gaps[0] >= 0, (gaps >= 0).any(axis=0)
    first = np.argmax(gaps >= 0, axis=0)
    grazes = np.array(
        [
            np.sort(-gaps[: max(first[k], 1), k])[0] < 1e-2
            and first[k] > 3
            and np.max(gaps[: first[k] - 2, k]) > -1e-2
            for k in range(len(theta))
        ]
    )
    assert np.isnan(touch.angle[(blocked | ~meets) & ~grazes]).all()
    sure = np.flatnonzero(~blocked & meets & ~grazes)
    low, high = nu[first[sure] - 1, sure], nu[first[sure], sure]
    for _ in range(50):
        middle = (low + high) / 2
        low, high = (
            np.where(over(middle, sure) < 0, middle, low),
            np.where(over(middle, sure) < 0, high, middle),
        )
    met = np.exp(1j * (bearing + leaves * low))
    assert (
        np.max(np.abs(np.angle(met / (facing * np.exp(1j * touch.angle[sure])))), initial=0) < 1e-9
    )
    ground = corners[:, None] * np.exp(1j * theta[sure])
    at = (
        ground[np.argmax(np.real(ground * np.conj(met)), axis=0), np.arange(len(sure))]
        + radius * met
    )
    assert (
        np.max(np.abs(np.imag(np.conj(met) * (at - pivot)) - touch.place[sure]), initial=0) < 1e-6
    )


def test_arcs_under_a_face_are_discs() -> None:
    """An off-centre disc: on a slide e cos t + a; on an arm the tangent from the pivot."""
    theta = np.random.default_rng(2).uniform(-9, 9, 1000)
    ring, e, a = disc(5 + 2j, 20.0), 5 + 2j, 20.0
    slide = contact(ring, SlideFace(3j, 1j, 1)).angle(theta)
    np.testing.assert_allclose(slide, np.imag(e * np.exp(1j * theta)) + a - 3, atol=1e-13)
    arm = contact(ring, ArmFace(70 + 0j, complex(np.exp(-1.2j)), 4.0, 1)).angle(theta)
    spoke = e * np.exp(1j * theta) - 70
    np.testing.assert_allclose(
        arm,
        np.angle(spoke * np.exp(1.2j) * np.exp(1j * np.arccos((4 - a) / np.abs(spoke)))),
        atol=1e-13,
    )


@pytest.mark.parametrize("rho", [0.5, 3.0, 6.0])
@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("leaves", [1, -1])
def test_the_wall_of_a_groove_from_within(rho: float, seed: int, leaves: int) -> None:
    """First touch on the way out, on a slide and on an arm, by steps of the distance from the wall."""
    z = star(seed, 40, (0.0, 1.0)[seed % 2]) * 1.6
    rng = np.random.default_rng(seed)
    theta, along = rng.uniform(-9, 9, 30), np.exp(1j * rng.uniform(-3, 3))

    def wall(p: np.ndarray) -> np.ndarray:
        a, ab = z, np.roll(z, -1) - z
        u = np.clip(np.real((p[:, None] - a) * np.conj(ab)) / np.abs(ab) ** 2, 0, 1)
        return np.min(np.abs(p[:, None] - a - u * ab), axis=1)

    def outwards(place: object, rate: float) -> np.ndarray:
        x = np.zeros(len(theta))
        for _ in range(6000):
            gap = wall(place(x) * np.exp(-1j * theta)) - rho  # type: ignore[operator]
            x += np.maximum(gap, 0) / rate
            if np.max(gap) < 1e-12:
                break
        return x

    hole, start, ahead = polygon(z).reversed(), along * 3j, leaves * along
    touch = contact(hole, SlideTip(start, along, rho, leaves, True)).touch(theta)
    x = outwards(lambda x: start + ahead * x, 1.0)
    assert np.max(np.abs(leaves * x - touch.angle) * np.cos(touch.pressure_angle)) < 1e-8

    pivot = 90 * along
    arm = -0.9 * pivot * np.exp(0.3j * leaves)
    touch = contact(hole, ArmTip(pivot, arm, rho, leaves, True)).touch(theta)
    rest = float(np.angle(-pivot / arm))
    x = outwards(lambda x: pivot + arm * np.exp(1j * (rest + leaves * x)), abs(arm))
    assert (
        np.max(np.abs(rest + leaves * x - touch.angle) * np.cos(touch.pressure_angle)) * abs(arm)
        < 1e-8
    )


@pytest.mark.parametrize("size", [1e-3, 0.1])
def test_small_outlines_run_their_own_way_too(size: float) -> None:
    """Discs and holes far smaller than 1 mm^2: met at their radius, refused where they are run the other way."""
    ring = disc(0, 3 * size)
    within = SlideTip(0j, 1j, size, 1, True)
    assert contact(ring, SlideTip(0j, 1j, size, 1)).angle(0.3) == pytest.approx(4 * size)
    assert contact(ring.reversed(), within).angle(0.3) == pytest.approx(2 * size)
    for wrong, form in ((ring.reversed(), SlideFace(0j, 1j, 1)), (ring, within)):
        with pytest.raises(ValueError, match="the outline does not run"):
            contact(wrong, form)


@pytest.mark.parametrize(
    "make",
    [
        lambda: SlideTip(0j, 2j, 1.0, 1),
        lambda: SlideTip(0j, 1j, -1.0, 1),
        lambda: SlideTip(0j, 1j, 1.0, 0),
        lambda: SlideFace(complex("nan"), 1j, 1),
        lambda: SlideFace(0j, 0j, 1),
        lambda: ArmFace(60 + 0j, 1 + 0j, 0.0, 1),
        lambda: ArmFace(60 + 0j, -1j, 0.0, -1),
        lambda: contact(disc(0, 20.0).reversed(), SlideTip(0j, 1j, 1.0, 1)),
        lambda: contact(disc(0, 20.0), SlideTip(0j, 1j, 1.0, 1, True)),
    ],
)
def test_slides_and_faces_that_make_no_sense(make: object) -> None:
    with pytest.raises(ValueError):
        make()  # type: ignore[operator]


@pytest.mark.parametrize(
    "form",
    [
        SlideTip(2 + 0j, 1j, 3.0, 1),
        SlideFace(0j, 1j, 1),
        ArmFace(70 + 0j, complex(np.exp(-1.2j)), 0.0, 1),
    ],
)
def test_a_moved_vertex_is_felt_by_every_follower(form: Form) -> None:
    z = 25 * np.exp(2j * np.pi * np.arange(200) / 200)
    theta = np.linspace(0, 2 * np.pi, 4000, endpoint=False)
    good = contact(polygon(z), form).angle(theta)
    z[70] *= 1 + 1e-3 / 25
    moved = np.abs(contact(polygon(z), form).angle(theta) - good) * (
        66 if isinstance(form, ArmFace) else 1
    )
    assert 0.9e-3 < moved.max() < 1.2e-3
    assert np.mean(moved > 1e-9) < 0.02
