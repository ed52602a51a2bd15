"""Linkages and what stands out on them, against the two machines' values, mpmath, brute force and closed forms."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgen.errors import DesignError
from camgen.machine import landmarks, linkages
from camgen.machine.landmarks import double_points, extremes, moving_centrode, near_stops, refuse_open, zeros
from camgen.machine.linkages import RPR, RRP, RRR, Crank, Fixed, Linkage, On, direction, distance, four_bar, slider_travel

REFERENCE = Path(__file__).resolve().parents[1] / "reference"
ECCENTRIC = tomllib.loads((REFERENCE / "eccentric-drive.toml").read_text())
TAKE_UP = tomllib.loads((REFERENCE / "thread-take-up.toml").read_text())
TURN = 2 * math.pi
EVERYWHERE = np.random.default_rng(5).uniform(0, TURN, 500)


def slider_crank(crank: float, rod: float, offset: float = 0.0) -> Linkage:
    return Linkage({"O": Fixed(0), "A": Crank("O", crank), "B": RRP("A", rod, 1j * offset, 0.0)})


def take_up(reading: str, frame: float = 9.0, eye: float = 52.0, branch: int = 1) -> Linkage:
    """O, A, B, C and the eye D: k = -s, so D lies to the right of A-B."""
    coupler, output = TAKE_UP[reading]
    points = {"O": Fixed(0), "C": Fixed(frame), "A": Crank("O", TAKE_UP["input_crank"])}
    return Linkage(points | {"B": RRR("A", "C", coupler, output, branch), "D": On("A", "B", 1 - 1j * eye / coupler)})


def turning(linkage: Linkage, a: str, b: str):
    """Rate of the link a-b over the crank's, as a function for zeros and extremes (order 0, 1)."""

    def rate(theta, order):
        jets = linkage.solve(theta, 2)
        return direction(jets[a], jets[b])[order + 1]

    return rate


# The eccentric drive

DRIVE = slider_crank(ECCENTRIC["eccentricity"], ECCENTRIC["rod"])
TABLE = np.radians(ECCENTRIC["angle_deg"])


def test_the_exact_speed_column() -> None:
    v3 = -DRIVE.solve(TABLE, 1)["B"][1].real * ECCENTRIC["table_speed"]
    np.testing.assert_allclose(v3, ECCENTRIC["exact_v3"], rtol=0, atol=6e-11)


def test_the_published_speed_column_is_mirrored() -> None:
    v3 = np.array(ECCENTRIC["exact_v3"])
    low = 100 * (1 - np.array(ECCENTRIC["published_v3"])[v3 != 0] / v3[v3 != 0])
    wrong = dict(zip(np.array(ECCENTRIC["angle_deg"])[v3 != 0], low, strict=True))
    for angle, share in wrong.items():
        assert share == pytest.approx(ECCENTRIC["published_low_percent"].get(str(angle), 0.0), abs=0.01)


def test_the_printed_chain_with_the_wrong_sign_of_phi2() -> None:
    p, e, rod = np.radians([30, 60]), ECCENTRIC["eccentricity"], ECCENTRIC["rod"]
    p2 = +np.arcsin(e * np.sin(p) / rod)
    rate = -e * np.cos(p) / (rod * np.cos(p2))
    v3 = (e * np.sin(p) + rod * rate * np.sin(p2)) * ECCENTRIC["table_speed"]
    np.testing.assert_allclose(v3, [16.4912211622, 28.8993702756], atol=1e-9)
    assert np.abs(e * np.sin(p) + rod * np.sin(p2)).min() > 1  # and it does not close


def test_rod_angle_and_rate_and_the_lost_sign() -> None:
    jets = DRIVE.solve(TABLE, 2)
    rod = direction(jets["A"], jets["B"])
    np.testing.assert_allclose(-np.degrees(rod[0]), ECCENTRIC["published_phi2_deg"], atol=0.006)
    np.testing.assert_allclose(-rod[1] * -ECCENTRIC["table_speed"], -np.array(ECCENTRIC["published_phi2_rate"]), atol=0.01)


def test_speeds_of_the_motor() -> None:
    assert ECCENTRIC["motor_rpm"] * TURN / 60 == pytest.approx(ECCENTRIC["motor_speed"], abs=1e-3)
    rpm = ECCENTRIC["motor_rpm"] / 60 * TURN / 60 * 60 / TURN
    assert rpm == pytest.approx(ECCENTRIC["paper_rpm"], abs=5e-3)
    assert rpm * TURN / 60 == pytest.approx(22.69, abs=5e-3)


def test_greatest_speed_is_before_90_degrees() -> None:
    at = zeros(lambda t, k: DRIVE.point("B")(t, 2).real if k == 0 else np.full(t.shape, np.nan))  # no slope: bisection
    peak = np.degrees(at[0])
    assert peak == pytest.approx(ECCENTRIC["peak_angle_deg"], abs=1e-11)
    ratio = -DRIVE.point("B")(at[:1], 1).real[0] / ECCENTRIC["eccentricity"]
    assert ratio == pytest.approx(ECCENTRIC["peak_ratio"], abs=2e-14)
    assert ratio * 1.5 * 22.6 == pytest.approx(ECCENTRIC["peak_v3"], abs=1e-6)
    ratio2, x = (1.5 / 48) ** 2, math.sin(at[0]) ** 2
    assert ratio2**2 * x**3 - ratio2 * x**2 - x + 1 == pytest.approx(0, abs=1e-14)


def test_speed_has_a_second_harmonic_of_half_lambda() -> None:
    theta = np.arange(64) * TURN / 64
    harmonics = np.fft.rfft(-DRIVE.point("B")(theta, 1).real / 1.5).imag / -32
    assert harmonics[1] == pytest.approx(1, abs=1e-12)
    assert harmonics[2] == pytest.approx(1 / 64, rel=1e-3)


def test_stroke_sag_travel_and_end_accelerations() -> None:
    b = DRIVE.point("B")
    ways = b(np.array([0, math.pi]), 0).real
    assert ways[0] - ways[1] == pytest.approx(ECCENTRIC["stroke"], abs=1e-12)
    assert slider_travel(math.pi / 2, 1.5, 48) - 1.5 == pytest.approx(ECCENTRIC["sag_at_90"], abs=1e-14)
    a = b(np.array([0, math.pi]), 2).real
    assert a[0] == pytest.approx(-1.5 * (1 + 1 / 32), abs=1e-14)
    assert a[0] / a[1] == pytest.approx(-33 / 31, abs=1e-13)
    for angle, way in ECCENTRIC["travel"].items():
        assert slider_travel(math.radians(float(angle)), 1.5, 48) == pytest.approx(way, abs=5e-10)
        assert ways[0] - b(math.radians(float(angle)), 0).real == pytest.approx(way, abs=5e-10)


def test_drive_closes_and_keeps_its_guide() -> None:
    jets = DRIVE.solve(EVERYWHERE)
    assert np.abs(distance(jets["A"], jets["B"])[0] - 48).max() < 1e-12
    assert np.abs(jets["B"].imag).max() == 0


def test_travel_of_a_tiny_crank_keeps_its_digits() -> None:
    crank, rod = 48e-8, 48.0
    with mpmath.workdps(40):
        for theta in EVERYWHERE[:40]:
            s = mpmath.sin(mpmath.mpf(float(theta)))
            c = mpmath.cos(mpmath.mpf(float(theta)))
            exact = crank * (1 - c) + rod - mpmath.sqrt(mpmath.mpf(rod) ** 2 - (mpmath.mpf(crank) * s) ** 2)
            assert slider_travel(theta, crank, rod) == pytest.approx(float(exact), rel=1e-12, abs=0)
            naive = rod + crank - (crank * math.cos(theta) + math.sqrt(rod**2 - (crank * math.sin(theta)) ** 2))
            if exact > crank:
                assert naive != pytest.approx(float(exact), rel=1e-12, abs=0)  # the check would see the cancellation
    tiny = slider_crank(crank, rod).point("B")(EVERYWHERE, 2).real
    np.testing.assert_allclose(tiny, -crank * (np.cos(EVERYWHERE) + 1e-8 * np.cos(2 * EVERYWHERE)), atol=crank * 1e-14)


def test_offset_slider_travel() -> None:
    way = slider_crank(10, 40, 6).point("B")
    np.testing.assert_allclose(slider_travel(EVERYWHERE, 10, 40, 6), (way(0.0) - way(EVERYWHERE)).real, atol=1e-13)


def test_crank_as_long_as_the_rod_stalls_on_the_axis() -> None:
    linkage = slider_crank(20, 20)
    stall = linkage.solve(np.array([math.pi / 2]), 2)["B"]
    assert abs(stall[0, 0]) < 1e-6 and np.isnan(stall[1:]).all()
    np.testing.assert_allclose(linkage.point("B")(np.radians([60, 120, 180])), [20, 0, 0], atol=1e-13)


def test_crank_longer_than_the_rod_has_no_answer_where_it_has_none() -> None:
    b = slider_crank(30, 20).point("B")
    reaches = np.abs(np.sin(EVERYWHERE)) <= 20 / 30
    for order in range(3):
        assert (np.isfinite(b(EVERYWHERE, order)) == reaches).all()
    with pytest.raises(DesignError, match=r"gap at joint B is 10 mm at crank angle (90|270) deg .*41\.8103, 138\.19"):
        refuse_open(slider_crank(30, 20))


# The thread take-up


@pytest.mark.parametrize("reading", ["printed", "interchanged"])
def test_eye_points(reading: str) -> None:
    eye = take_up(reading).point("D")(np.radians(TAKE_UP["eye_angle_deg"]))
    expected = np.array(TAKE_UP[f"eye_{reading}"]) @ [1, 1j]
    assert np.abs(eye - expected).max() < 1e-9


@pytest.mark.parametrize("reading", ["printed", "interchanged"])
def test_transmission_angle(reading: str) -> None:
    linkage, expected = take_up(reading), np.radians(TAKE_UP["transmission_deg"])
    np.testing.assert_allclose(linkages.transmission_extremes(9, 30, *TAKE_UP[reading]), expected, atol=2e-15 * 180)

    def transmission(theta, order):
        jets = linkage.solve(theta, order)
        both = direction(jets["B"], jets["C"]) - direction(jets["B"], jets["A"])
        both[0] = both[0] % TURN
        return both[order]

    at, angle = extremes(transmission)
    np.testing.assert_allclose(at, [0, math.pi], atol=1e-10)
    np.testing.assert_allclose(np.sort(np.minimum(angle, TURN - angle)), expected, atol=1e-13)


def rates(linkage: Linkage, a: str, b: str) -> tuple[np.ndarray, np.ndarray]:
    """Extremes of a link's rate: zeros of its angular acceleration, whose slope is left to bisection."""

    def acceleration(theta, order):
        jets = linkage.solve(theta, 2)
        return direction(jets[a], jets[b])[2] if order == 0 else np.full(theta.shape, np.nan)

    at = zeros(acceleration)
    return np.degrees(at), turning(linkage, a, b)(at, 0)


@pytest.mark.parametrize(("link", "a", "b"), [("w2", "A", "B"), ("w3", "C", "B")])
def test_rate_extremes_and_the_interchange(link: str, a: str, b: str) -> None:
    least, at_least, most, at_most = TAKE_UP[link]
    at, value = rates(take_up("printed"), a, b)
    assert value.min() == pytest.approx(least, abs=1e-9) and at[value.argmin()] == pytest.approx(at_least, abs=1e-3)
    assert value.max() == pytest.approx(most, abs=1e-9) and at[value.argmax()] == pytest.approx(at_most, abs=1e-3)
    # The two links change places in the parallelogram A, B, C, B': the joint goes to the other side.
    other = turning(take_up("interchanged", branch=-1), *(("C", "B") if link == "w2" else ("A", "B")))
    np.testing.assert_allclose(other(EVERYWHERE, 0), turning(take_up("printed"), a, b)(EVERYWHERE, 0), atol=1e-12)


def test_mean_rates_are_one_and_angles_unwrap() -> None:
    theta = np.arange(720) * TURN / 720
    for reading in ("printed", "interchanged"):
        for a, b in (("A", "B"), ("C", "B")):
            jets = take_up(reading).solve(theta, 1)
            angle, rate = direction(jets[a], jets[b])
            assert rate.mean() == pytest.approx(1, abs=1e-12)
            assert np.abs(np.diff(angle)).max() > 6  # the principal angle does jump
            np.testing.assert_allclose(np.diff(np.unwrap(angle)), (rate[1:] + rate[:-1]) / 2 * TURN / 720, atol=1e-5)


def test_spread_grows_with_the_frame() -> None:
    for frame, spread in TAKE_UP["spread"].items():
        _, value = rates(take_up("printed", float(frame)), "C", "B")
        assert np.ptp(value) == pytest.approx(spread, abs=1e-3)


def test_formula_1_as_printed_does_not_close() -> None:
    l0, l1, (l2, l3), theta = 9, 30, TAKE_UP["printed"], np.radians([20.0, 100, 250])
    with np.errstate(invalid="ignore"):
        reach = np.sqrt(l0**2 + l1**2 - 2 * l0 * l1 * np.cos(theta))
        arc = np.arccos((l0 + l1 + l2 - l3 - 2 * l0 * l1 * np.cos(theta)) / (2 * l0 * l1 * reach))
    phi = np.arctan(l1 * np.sin(theta) / (l1 * np.cos(theta) - l0)) + arc
    closure = np.abs(l1 * np.exp(1j * theta) + l2 * np.exp(1j * phi) - l0) - l3
    assert (np.abs(closure) > 1).all()
    phi = np.arctan2(-l1 * np.sin(theta), l0 - l1 * np.cos(theta))
    phi = phi + np.arccos((l0**2 + l1**2 + l2**2 - l3**2 - 2 * l0 * l1 * np.cos(theta)) / (2 * l2 * reach))
    joint = l1 * np.exp(1j * theta) + l2 * np.exp(1j * phi)
    assert np.abs(joint - take_up("printed").point("B")(theta)).max() < 1e-13


def test_formula_2_as_printed_is_a_reflection() -> None:
    jets = take_up("printed").solve(EVERYWHERE)
    phi = direction(jets["A"], jets["B"])[0]
    x, y = 30.0, -52.0  # in the coupler's axes
    turned = jets["A"][0] + (x * np.cos(phi) - y * np.sin(phi)) + 1j * (x * np.sin(phi) + y * np.cos(phi))
    printed = jets["A"][0] + (x * np.cos(phi) + y * np.sin(phi)) + 1j * (x * np.sin(phi) - y * np.cos(phi))
    assert np.abs(turned - jets["D"][0]).max() < 1e-12
    assert np.abs(printed - jets["D"][0]).min() > 100  # 2 |y|


def test_double_point_and_its_absence() -> None:
    pairs, points = double_points(take_up("interchanged").point("D"))
    np.testing.assert_allclose(np.degrees(pairs), [TAKE_UP["double_point_deg"]], atol=1e-8)
    assert abs(points[0] - complex(*TAKE_UP["double_point"])) < 1e-9
    theta = np.linspace(*pairs[0], 20001)
    loop = take_up("interchanged").point("D")(theta)
    assert [np.ptp(loop.real), np.ptp(loop.imag)] == pytest.approx(TAKE_UP["loop_size"], abs=6e-4)
    assert double_points(take_up("printed").point("D"))[0].shape == (0, 2)


def test_the_small_loop_is_missed_by_too_coarse_a_search() -> None:
    curve = take_up("interchanged", eye=52.6).point("D")
    assert len(double_points(curve)[0]) == 1
    assert len(double_points(curve, 60)[0]) == 0
    assert len(double_points(take_up("interchanged", eye=53.0).point("D"))[0]) == 0


def test_double_points_of_curves_that_are_known() -> None:
    def figure_eight(t, order):
        return [np.sin(t) + 0.5j * np.sin(2 * t), np.cos(t) + 1j * np.cos(2 * t)][order]

    pairs, points = double_points(lambda t, order: figure_eight(t + 0.1, order))
    np.testing.assert_allclose(pairs, [[math.pi - 0.1, TURN - 0.1]], atol=1e-12)
    assert abs(points[0]) < 1e-12
    # A trochoid of four inner loops: exp(it) + a exp(5it) with a > 1/5 crosses itself at least four times.
    many, _ = double_points(lambda t, k: np.exp(1j * t) * 1j**k + 0.5 * (5j) ** k * np.exp(5j * t))
    values = np.exp(1j * many) + 0.5 * np.exp(5j * many)
    assert len(many) >= 4 and len(many) % 4 == 0 and np.abs(values[:, 0] - values[:, 1]).max() < 1e-12


def test_cusp() -> None:
    linkage = take_up("interchanged")

    def off_the_arm(theta, order):
        jets = linkage.solve(theta, 2)
        return moving_centrode(jets["A"], jets["B"])[order].real - (1 if order == 0 else 0)

    angles = zeros(off_the_arm)
    jets = linkage.solve(angles, 2)
    eye = -19 * moving_centrode(jets["A"], jets["B"])[0].imag
    found = np.abs(eye - TAKE_UP["cusp"][0]).argmin()
    assert eye[found] == pytest.approx(TAKE_UP["cusp"][0], abs=1e-8)
    assert np.degrees(angles[found]) == pytest.approx(TAKE_UP["cusp"][1], abs=1e-4)
    assert abs(take_up("interchanged", eye=eye[found]).point("D")(angles[found], 1)) < 1e-11


def test_near_stop_round_the_double_point() -> None:
    curve, centre = take_up("interchanged").point("D"), complex(*TAKE_UP["double_point"])
    for radius, degrees in TAKE_UP["near_stop_deg"].items():
        spans = np.degrees(near_stops(curve, centre, float(radius)))
        assert spans.max() - spans.min() == pytest.approx(degrees, abs=0.06)
        inside = np.abs(curve(np.radians(np.arange(0, 360, 0.01))) - centre) <= float(radius)
        assert (spans[:, 1] - spans[:, 0]).sum() == pytest.approx(inside.sum() * 0.01, abs=0.03)


def test_feed_diagram() -> None:
    curve, ends = take_up("interchanged").point("D"), [np.array([[complex(*g)], [0], [0]]) for g in TAKE_UP["guides"]]

    def feed(theta, order):
        eye = np.stack([curve(theta, k) for k in range(3)])
        return sum(distance(end, eye) for end in ends)[order]

    at, length = extremes(feed)
    at = np.degrees(at)
    longest, at_longest, shortest, at_shortest = TAKE_UP["feed"]
    assert length.max() == pytest.approx(longest, abs=1e-4) and length.min() == pytest.approx(shortest, abs=1e-4)
    assert at[length.argmax()] == pytest.approx(at_longest, abs=0.01)
    assert at[length.argmin()] == pytest.approx(at_shortest, abs=0.01)
    assert np.ptp(length) == pytest.approx(TAKE_UP["feed_range"], abs=1e-4)
    down = at[length.argmin()] - at[length.argmax()]
    assert down == pytest.approx(TAKE_UP["let_down_deg"], abs=0.01)
    assert down / (360 - down) == pytest.approx(TAKE_UP["let_down_ratio"], abs=0.01)


def test_eye_through_a_guide_has_a_kink_not_a_number() -> None:
    curve = take_up("printed").point("D")
    rows = distance(np.array([[complex(curve(1.0))], [0], [0]]), np.array([[curve(1.0, k)] for k in range(3)]))
    assert rows[0, 0] == 0 and np.isnan(rows[1:]).all()


def test_frame_to_the_fold_and_past_it() -> None:
    refuse_open(take_up("printed", 19 - 1e-6))
    for frame in (19.0001, 19 + 1e-9):
        with pytest.raises(DesignError) as refused:
            refuse_open(take_up("printed", frame))
        assert refused.value.value == pytest.approx(frame - 19, rel=1e-4)
        assert "180" in refused.value.where or "crank angle 0" in refused.value.where
    kinds = {frame: four_bar(frame, 30, 30, 19) for frame in (9, 19, 19.0001)}
    assert [k.kind for k in kinds.values()] == ["double-crank", "change-point", "rocker-crank"]
    assert [k.full_turn for k in kinds.values()] == [True, True, False]
    assert kinds[19.0001].slack == pytest.approx(-1e-4, rel=1e-6)


@pytest.mark.parametrize("lengths", [(30.0, 30.0), (19.0, 19.0), (25.0, 25.0)])
def test_equal_coupler_and_output(lengths: tuple[float, float]) -> None:
    linkage = Linkage({"O": Fixed(0), "C": Fixed(9), "A": Crank("O", 30), "B": RRR("A", "C", *lengths, 1)})
    jets = linkage.solve(EVERYWHERE)
    open_ = np.abs(jets["A"][0] - 9) > sum(lengths)
    assert (np.isnan(jets["B"][0]) == open_).all()
    assert np.nanmax(np.abs(np.abs(jets["B"][0] - 9) - lengths[1])) < 1e-13


def test_no_frame_turns_as_one_body() -> None:
    jets = take_up("printed", 0.0).solve(EVERYWHERE, 2)
    for a, b in (("A", "B"), ("C", "B")):
        rows = direction(jets[a], jets[b])
        np.testing.assert_allclose(rows[1], 1, atol=1e-13)
        np.testing.assert_allclose(rows[2], 0, atol=1e-13)


# The engine


def test_four_bar_classes() -> None:
    assert four_bar(40, 10, 30, 30).kind == "crank-rocker"
    assert four_bar(40, 30, 30, 10).kind == "rocker-crank"
    assert four_bar(40, 30, 10, 30).kind == "double-rocker"
    assert four_bar(40, 25, 20, 22).kind == "triple-rocker"
    assert four_bar(30, 20, 30, 20).kind == "change-point"
    assert four_bar(100, 20, 30, 20).kind == "none"
    assert four_bar(100, 20, 30, 20).open_deg == ((0.0, 180.0),)


@given(st.lists(st.floats(1, 50), min_size=4, max_size=4))
@settings(max_examples=60)
def test_open_angles_are_where_nothing_assembles(lengths: list[float]) -> None:
    frame, crank, coupler, output = lengths
    theta = np.linspace(0.001, 179.999, 400)
    points = {"O": Fixed(0), "C": Fixed(frame), "A": Crank("O", crank)}
    joint = Linkage(points | {"B": RRR("A", "C", coupler, output)}).point("B")(np.radians(theta))
    told = np.zeros(theta.shape, bool)
    near = np.zeros(theta.shape, bool)
    for low, high in four_bar(*lengths).open_deg:
        told |= (theta > low) & (theta < high)
        near |= (np.abs(theta - low) < 1e-3) | (np.abs(theta - high) < 1e-3)
    assert (np.isnan(joint) == told)[~near].all()


def test_dead_points_of_a_crank_rocker_are_extremes_of_its_output() -> None:
    linkage = Linkage({"O": Fixed(0), "C": Fixed(40), "A": Crank("O", 10), "B": RRR("A", "C", 35, 30)})

    def output(theta, order):
        jets = linkage.solve(theta, order)
        return direction(jets["C"], jets["B"])[order]

    at, _ = extremes(output)
    # Triangle O, C, B with the coupler and the crank in line, stretched and folded.
    stretched, folded = (math.acos((40**2 + side**2 - 30**2) / (2 * 40 * side)) for side in (45, 25))
    np.testing.assert_allclose(at, np.sort([stretched, folded + math.pi]), atol=1e-12)


def chained() -> Linkage:
    """Every kind of step, dyads on moving points on both sides included."""
    return Linkage(
        {
            "O": Fixed(0),
            "C": Fixed(42 - 5j),
            "R": Fixed(-30 - 20j),
            "A": Crank("O", 10 + 3j),
            "B": RRR("A", "C", 38, 30, -1),
            "E": On("A", "B", 0.4 - 0.7j),
            "F": RPR("A", "R", 20 + 8j, 5.0, -1),
            "G": RRR("E", "F", 60, 55, 1),
            "H": RRP("G", 150, 10 + 70j, 0.3, -1),
        }
    )


def exact_chain(theta):
    """The same linkage with mpmath and trigonometry, no dyad formula in common: angles by arccos and arcsin."""
    exp, arg, acos = (lambda x: mpmath.expj(x)), mpmath.arg, mpmath.acos
    a = mpmath.mpc(10, 3) * exp(theta)
    c, r = mpmath.mpc(42, -5), mpmath.mpc(-30, -20)

    def joint(p, q, rp, rq, side):
        d = abs(q - p)
        return p + rp * exp(arg(q - p) + side * acos((rp**2 + d**2 - rq**2) / (2 * rp * d)))

    b = joint(a, c, 38, 30, -1)
    e = a + (b - a) * mpmath.mpc("0.4", "-0.7")
    # The guide passes r at 5 to its left and a lies behind: a - r = u (-s + 5i).
    d = a - r
    u = exp(arg(d) - (mpmath.pi - mpmath.asin(5 / abs(d))))
    f = r + u * mpmath.mpc(20, 8)
    g = joint(e, f, 60, 55, 1)
    way = (g - mpmath.mpc(10, 70)) * exp(-mpmath.mpf(0.3))
    reach = way.real - 150 * mpmath.cos(mpmath.asin(way.imag / 150))
    return {"A": a, "B": b, "E": e, "F": f, "G": g, "H": mpmath.mpc(10, 70) + reach * exp(mpmath.mpf(0.3))}


def test_every_step_and_its_derivatives_against_mpmath() -> None:
    theta = EVERYWHERE[:12]
    jets = chained().solve(theta, 2)
    with mpmath.workdps(40):
        step = mpmath.mpf("1e-9")
        for k, angle in enumerate(theta):
            back, mid, on = (exact_chain(mpmath.mpf(float(angle)) + i * step) for i in (-1, 0, 1))
            for name, place in mid.items():
                first, second = (on[name] - back[name]) / (2 * step), (on[name] - 2 * place + back[name]) / step**2
                got = jets[name][:, k]
                assert abs(got[0] - complex(place)) < 2e-13 * 100
                assert abs(got[1] - complex(first)) < 1e-12 * 100
                assert abs(got[2] - complex(second)) < 1e-11 * 100


def test_distance_and_direction_against_finite_differences() -> None:
    h = 1e-4
    back, mid, on = (chained().solve(EVERYWHERE[:50] + k * h, 2) for k in (-1, 0, 1))
    for measure in (distance, direction):
        before, rows, after = (measure(at["E"], at["G"]) for at in (back, mid, on))
        np.testing.assert_allclose(rows[0, :], np.abs(mid["G"][0] - mid["E"][0])) if measure is distance else None
        np.testing.assert_allclose(rows[1], (after[0] - before[0]) / (2 * h), atol=1e-5)
        np.testing.assert_allclose(rows[2], (after[1] - before[1]) / (2 * h), atol=1e-5)


def test_rates_that_are_wrong_are_seen() -> None:
    """The finite difference test resolves an acceleration that is off by a part in a million."""
    jets, h = chained().solve(EVERYWHERE[:5], 2), 1e-4
    ahead, behind = chained().solve(EVERYWHERE[:5] + h, 1)["H"][1], chained().solve(EVERYWHERE[:5] - h, 1)["H"][1]
    second = (ahead - behind) / (2 * h)
    np.testing.assert_allclose(jets["H"][2], second, rtol=1e-6)
    assert (np.abs(jets["H"][2] * (1 + 1e-5) - second) > 1e-6 * np.abs(second)).all()


@given(
    st.floats(0, 100), st.floats(0.1, 50), st.floats(0.1, 100), st.floats(0.1, 100), st.sampled_from([1, -1]),
    st.floats(-50, 50),
)  # fmt: skip
@settings(max_examples=150)
def test_closure_or_nothing(frame, crank, coupler, output, branch, theta0) -> None:
    theta = theta0 + np.linspace(0, 7, 50)
    points = {"O": Fixed(0), "C": Fixed(frame), "A": Crank("O", crank), "B": RRR("A", "C", coupler, output, branch)}
    jets = Linkage(points).solve(theta, 2)
    a, b = crank * np.exp(1j * theta), jets["B"][0]
    reach, size = np.abs(frame - a), frame + crank + coupler + output
    possible = (reach < coupler + output - 1e-12 * size) & (reach > abs(coupler - output) + 1e-12 * size)
    impossible = (reach > coupler + output + 1e-12 * size) | (reach < abs(coupler - output) - 1e-12 * size)
    # A reach of next to nothing leaves the joint's direction open: the one place where what could close gives nothing.
    assert np.isfinite(b)[possible & (reach > 1e-9 * size)].all() and np.isnan(b)[impossible].all()
    ok = np.isfinite(b) & (reach > 1e-3 * size)
    assert (np.abs(np.abs(b - a) - coupler)[ok] <= 1e-12 * size).all()
    assert (np.abs(np.abs(b - frame) - output)[ok] <= 1e-12 * size).all()
    side = (np.conj(frame - a) * (b - a)).imag * branch
    assert (side[ok] >= -1e-12 * size**2).all()
    # Rigid links: no stretching, u . u' = 0 and u' . u' + u . u'' = 0, for both links.
    for pivot in ("A", "C"):
        u = jets["B"] - jets[pivot]
        sure = ok & np.isfinite(u[2])
        scale = size * (np.abs(u[1]) + np.abs(jets["B"][1]) + crank)[sure]
        assert (np.abs((np.conj(u[0]) * u[1]).real[sure]) <= 1e-9 * scale).all()
        rest = np.abs(np.abs(u[1]) ** 2 + (np.conj(u[0]) * u[2]).real)[sure]
        assert (rest <= 1e-8 * (np.abs(u[1]) ** 2 + size * (np.abs(u[2]) + np.abs(jets["B"][2]) + crank))[sure]).all()


@given(st.floats(0.1, 60), st.floats(0.1, 60), st.floats(-40, 40), st.floats(-3, 3), st.sampled_from([1, -1]))
@settings(max_examples=60)
def test_slider_and_guide_close_or_nothing(crank, rod, offset, angle, branch) -> None:
    through = 5 + 1j * offset
    linkage = Linkage(
        {
            "O": Fixed(0),
            "R": Fixed(through),
            "A": Crank("O", crank),
            "B": RRP("A", rod, through, angle, branch),
            "G": RPR("A", "R", 1, offset, branch),
        }
    )
    at = linkage.solve(EVERYWHERE[:60])
    a, b, g, along = at["A"][0], at["B"][0], at["G"][0] - through, np.exp(1j * angle)
    height, size = ((a - through) / along).imag, crank + rod + 60
    assert (np.isfinite(b) == (np.abs(height) <= rod))[np.abs(np.abs(height) - rod) > 1e-12 * size].all()
    ok = np.isfinite(b)
    assert (np.abs(np.abs(b - a)[ok] - rod) <= 1e-12 * size).all()
    assert (np.abs(((b - through) / along).imag[ok]) <= 1e-12 * size).all()
    assert ((((b - a) / along).real * branch)[ok] >= -1e-12 * size).all()
    far = np.abs(a - through)
    assert (np.isfinite(g) == (far >= abs(offset)))[(np.abs(far - abs(offset)) > 1e-9) & (far > 1e-9)].all()
    ok = np.isfinite(g) & (far > 1e-3)
    assert (np.abs(np.abs(g[ok]) - 1) <= 1e-10).all()
    a, g = a[ok], g[ok]
    assert (np.abs(((a - through) / g).imag - offset) <= 1e-10 * size).all()
    assert (((a - through) / g).real * branch >= -1e-10 * size).all()


def test_just_closing_chain_has_a_position_and_no_derivative() -> None:
    # A parallelogram stretched into one line.
    jets = Linkage(
        {"O": Fixed(0), "C": Fixed(30), "A": Crank("O", 20), "B": RRR("A", "C", 30, 20)}
    ).solve(np.array([math.pi]), 2)  # fmt: skip
    assert abs(jets["B"][0, 0] - 10) < 1e-6 and np.isnan(jets["B"][1:]).all()


def test_blocks_and_threads_give_the_same_as_one_angle(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(linkages, "BLOCK", 64)
    whole = chained().solve(EVERYWHERE, 2)
    monkeypatch.setattr(linkages, "THREADED", 100)
    split = chained().solve(EVERYWHERE, 2)
    monkeypatch.undo()
    for name, jet in chained().solve(EVERYWHERE, 2).items():
        np.testing.assert_array_equal(whole[name], jet)
        np.testing.assert_array_equal(split[name], jet)
    single = chained().solve(float(EVERYWHERE[3]), 2)
    assert single["H"].shape == (3, 1) and abs(single["H"][0, 0] - whole["H"][0, 3]) < 1e-12
    assert np.isnan(chained().point("H")(np.array([math.nan, math.inf]))).all()
    assert chained().point("H")(EVERYWHERE.reshape(50, 10), 1).shape == (50, 10)
    with pytest.raises(ValueError, match="order is 0, 1 or 2, not 3"):
        chained().solve(EVERYWHERE, 3)


def test_unit_turn_to_1e_15() -> None:
    theta = np.concatenate([EVERYWHERE, -EVERYWHERE, [0, math.pi, -math.pi, math.pi / 2, TURN, 1e4, 1e-300]])
    assert np.abs(linkages.unit_turn(theta) - np.exp(1j * theta)).max() < 1e-15


def test_zeros_and_extremes_of_known_functions() -> None:
    np.testing.assert_allclose(zeros(lambda t, k: [np.sin, np.cos][k](t)), [0, math.pi], atol=1e-14)
    at, value = extremes(lambda t, k: np.cos(t + k * math.pi / 2) + 3 * (k == 0))
    np.testing.assert_allclose(at, [0, math.pi], atol=1e-14)
    np.testing.assert_allclose(value, [4, 2], atol=1e-14)
    assert zeros(lambda t, k: 2 + np.sin(t)).size == 0
    assert landmarks.near_stops(lambda t, k: np.exp(1j * t) * 1j**k, 0j, 2.0).shape == (0, 2)
    # A circle of 1 about 1: the chord of length 1 from a point on it subtends 60 deg.
    spans = near_stops(lambda t, k: np.exp(1j * t) * 1j**k, 1 + 0j, 1.0)
    np.testing.assert_allclose(spans, [[math.pi * 5 / 3, math.pi * 7 / 3]], atol=1e-12)


def test_memory_of_an_earlier_call_is_written_over() -> None:
    linkage = Linkage({"O": Fixed(0), "C": Fixed(9), "A": Crank("O", 30), "B": RRR("A", "C", 30, 19, -1)})
    first = linkage.solve(np.linspace(0, 1, 50), 2, ("A", "B"))
    kept = first["B"]
    again = linkage.solve(np.linspace(1, 2, 50), 2, out=first)
    fresh = linkage.solve(np.linspace(1, 2, 50), 2, ("A", "B"))
    assert again["B"] is kept
    np.testing.assert_array_equal(again["B"], fresh["B"])
    with pytest.raises(ValueError, match="another shape"):
        linkage.solve(np.linspace(1, 2, 51), 2, out=first)
