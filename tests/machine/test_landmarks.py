"""Closed forms and landmarks: the two machines' values, mpmath, brute force; what their papers print beside what closes."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import chains
import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgen.machine import jets, landmarks, solve
from camgen.machine.closed_form import four_bar, slider_travel, transmission_extremes
from camgen.machine.landmarks import double_points, extremes, moving_centrode, near_stops, zeros
from camgen.numerics import Floats, Points

REFERENCE = Path(__file__).resolve().parents[1] / "reference"
ECCENTRIC = tomllib.loads((REFERENCE / "eccentric-drive.toml").read_text())
TAKE_UP = tomllib.loads((REFERENCE / "thread-take-up.toml").read_text())
TURN = 2 * math.pi
EVERYWHERE = np.random.default_rng(5).uniform(0, TURN, 500)
DRIVE = chains.slider_crank(ECCENTRIC["eccentricity"], ECCENTRIC["rod"])
READINGS = {"printed": chains.take_up(), "interchanged": chains.take_up(interchanged=True)}


def way(theta: Any, order: int) -> np.ndarray:
    """Of the eccentric drive's slider."""
    return solve(DRIVE, theta).derivatives("way")[order]


def eye(reading: str, distance: float = 52.0) -> Callable[[Any, int], np.ndarray]:
    """Path of the eye so far from B."""
    machine = READINGS[reading]
    place = complex(TAKE_UP[reading][0], -distance)

    def curve(theta: Any, order: int = 0) -> np.ndarray:
        return solve(machine, theta, order).point("coupler", place)[order].reshape(np.shape(theta))

    return curve


# The eccentric drive

TABLE = np.radians(ECCENTRIC["angle_deg"])


def test_the_exact_speed_column() -> None:
    np.testing.assert_allclose(
        -way(TABLE, 1) * ECCENTRIC["table_speed"], ECCENTRIC["exact_v3"], rtol=0, atol=6e-11
    )


def test_the_published_speed_column_is_mirrored() -> None:
    v3 = np.array(ECCENTRIC["exact_v3"])
    low = 100 * (1 - np.array(ECCENTRIC["published_v3"])[v3 != 0] / v3[v3 != 0])
    wrong = dict(zip(np.array(ECCENTRIC["angle_deg"])[v3 != 0], low, strict=True))
    for angle, share in wrong.items():
        assert share == pytest.approx(
            ECCENTRIC["published_low_percent"].get(str(angle), 0.0), abs=0.01
        )


def test_the_printed_chain_with_the_wrong_sign_of_phi2() -> None:
    p, e, rod = np.radians([30, 60]), ECCENTRIC["eccentricity"], ECCENTRIC["rod"]
    p2 = +np.arcsin(e * np.sin(p) / rod)
    rate = -e * np.cos(p) / (rod * np.cos(p2))
    v3 = (e * np.sin(p) + rod * rate * np.sin(p2)) * ECCENTRIC["table_speed"]
    np.testing.assert_allclose(v3, [16.4912211622, 28.8993702756], atol=1e-9)
    assert np.abs(e * np.sin(p) + rod * np.sin(p2)).min() > 1  # and it does not close


def test_rod_angle_and_rate_and_the_lost_sign() -> None:
    rod = solve(DRIVE, TABLE).angle("rod")
    np.testing.assert_allclose(-np.degrees(rod[0]), ECCENTRIC["published_phi2_deg"], atol=0.006)
    np.testing.assert_allclose(
        -rod[1] * -ECCENTRIC["table_speed"], -np.array(ECCENTRIC["published_phi2_rate"]), atol=0.01
    )


def test_speeds_of_the_motor() -> None:
    assert ECCENTRIC["motor_rpm"] * TURN / 60 == pytest.approx(ECCENTRIC["motor_speed"], abs=1e-3)
    rpm = ECCENTRIC["motor_rpm"] / 60 * TURN / 60 * 60 / TURN
    assert rpm == pytest.approx(ECCENTRIC["paper_rpm"], abs=5e-3)
    assert rpm * TURN / 60 == pytest.approx(22.69, abs=5e-3)


def test_greatest_speed_is_before_90_degrees() -> None:
    at = zeros(
        lambda t, k: way(t, 2) if k == 0 else np.full(t.shape, np.nan)
    )  # no slope: bisection
    peak = np.degrees(at[0])
    assert peak == pytest.approx(ECCENTRIC["peak_angle_deg"], abs=1e-11)
    ratio = -way(at[:1], 1)[0] / ECCENTRIC["eccentricity"]
    assert ratio == pytest.approx(ECCENTRIC["peak_ratio"], abs=2e-14)
    assert ratio * 1.5 * 22.6 == pytest.approx(ECCENTRIC["peak_v3"], abs=1e-6)
    ratio2, x = (1.5 / 48) ** 2, math.sin(at[0]) ** 2
    assert ratio2**2 * x**3 - ratio2 * x**2 - x + 1 == pytest.approx(0, abs=1e-14)


def test_speed_has_a_second_harmonic_of_half_lambda() -> None:
    harmonics = np.fft.rfft(-way(np.arange(64) * TURN / 64, 1) / 1.5).imag / -32
    assert harmonics[1] == pytest.approx(1, abs=1e-12)
    assert harmonics[2] == pytest.approx(1 / 64, rel=1e-3)


def test_stroke_sag_travel_and_end_accelerations() -> None:
    ends = np.array([0, math.pi])
    ways, a = way(ends, 0), way(ends, 2)
    assert ways[0] - ways[1] == pytest.approx(ECCENTRIC["stroke"], abs=1e-12)
    assert slider_travel(math.pi / 2, 1.5, 48) - 1.5 == pytest.approx(
        ECCENTRIC["sag_at_90"], abs=1e-14
    )
    assert a[0] == pytest.approx(-1.5 * (1 + 1 / 32), abs=1e-14)
    assert a[0] / a[1] == pytest.approx(-33 / 31, abs=1e-13)
    for angle, travel in ECCENTRIC["travel"].items():
        assert slider_travel(math.radians(float(angle)), 1.5, 48) == pytest.approx(
            travel, abs=5e-10
        )
        assert ways[0] - way(math.radians(float(angle)), 0)[0] == pytest.approx(travel, abs=5e-10)


def test_travel_of_a_tiny_crank_keeps_its_digits() -> None:
    crank, rod = 48e-8, 48.0
    with mpmath.workdps(40):
        for theta in EVERYWHERE[:40]:
            s = mpmath.sin(mpmath.mpf(float(theta)))
            c = mpmath.cos(mpmath.mpf(float(theta)))
            exact = (
                crank * (1 - c)
                + rod
                - mpmath.sqrt(mpmath.mpf(rod) ** 2 - (mpmath.mpf(crank) * s) ** 2)
            )
            assert slider_travel(theta, crank, rod) == pytest.approx(float(exact), rel=1e-12, abs=0)
            naive = (
                rod
                + crank
                - (crank * math.cos(theta) + math.sqrt(rod**2 - (crank * math.sin(theta)) ** 2))
            )
            if exact > crank:
                assert naive != pytest.approx(
                    float(exact), rel=1e-12, abs=0
                )  # the check would see the cancellation


def test_offset_slider_travel() -> None:
    ways = solve(chains.slider_crank(10, 40, 6), np.append(0.0, EVERYWHERE))["way"]
    np.testing.assert_allclose(slider_travel(EVERYWHERE, 10, 40, 6), ways[0] - ways[1:], atol=1e-13)


# The thread take-up


@pytest.mark.parametrize("reading", ["printed", "interchanged"])
def test_transmission_angle(reading: str) -> None:
    machine, expected = READINGS[reading], np.radians(TAKE_UP["transmission_deg"])
    np.testing.assert_allclose(
        transmission_extremes(9, 30, *TAKE_UP[reading]), expected, atol=2e-15 * 180
    )

    def transmission(theta: np.ndarray, order: int) -> np.ndarray:
        run = solve(machine, theta, order)
        both = run.angle("rocker") - run.angle("coupler")
        both[0] = both[0] % TURN
        return both[order]

    at, angle = extremes(transmission)
    np.testing.assert_allclose(at, [0, math.pi], atol=1e-10)
    np.testing.assert_allclose(np.sort(np.minimum(angle, TURN - angle)), expected, atol=1e-13)


def test_formula_1_as_printed_does_not_close() -> None:
    l0, l1, (l2, l3), theta = 9, 30, TAKE_UP["printed"], np.radians([20.0, 100, 250])
    with np.errstate(invalid="ignore"):
        reach = np.sqrt(l0**2 + l1**2 - 2 * l0 * l1 * np.cos(theta))
        arc = np.arccos((l0 + l1 + l2 - l3 - 2 * l0 * l1 * np.cos(theta)) / (2 * l0 * l1 * reach))
    phi = np.arctan(l1 * np.sin(theta) / (l1 * np.cos(theta) - l0)) + arc
    closure = np.abs(l1 * np.exp(1j * theta) + l2 * np.exp(1j * phi) - l0) - l3
    assert (np.abs(closure) > 1).all()
    phi = np.arctan2(-l1 * np.sin(theta), l0 - l1 * np.cos(theta))
    phi = phi + np.arccos(
        (l0**2 + l1**2 + l2**2 - l3**2 - 2 * l0 * l1 * np.cos(theta)) / (2 * l2 * reach)
    )
    joint = l1 * np.exp(1j * theta) + l2 * np.exp(1j * phi)
    assert np.abs(joint - solve(READINGS["printed"], theta).point("rocker", "B")[0]).max() < 1e-13


def test_formula_2_as_printed_is_a_reflection() -> None:
    run = solve(READINGS["printed"], EVERYWHERE)
    phi, a, d = run.angle("coupler")[0], run.point("coupler", "A")[0], eye("printed")(EVERYWHERE)
    x, y = 30.0, -52.0  # in the coupler's axes
    turned = a + (x * np.cos(phi) - y * np.sin(phi)) + 1j * (x * np.sin(phi) + y * np.cos(phi))
    printed = a + (x * np.cos(phi) + y * np.sin(phi)) + 1j * (x * np.sin(phi) - y * np.cos(phi))
    assert np.abs(turned - d).max() < 1e-12
    assert np.abs(printed - d).min() > 100  # 2 |y|


def test_double_point_and_its_absence() -> None:
    pairs, points = double_points(eye("interchanged"))
    np.testing.assert_allclose(np.degrees(pairs), [TAKE_UP["double_point_deg"]], atol=1e-8)
    assert abs(points[0] - complex(*TAKE_UP["double_point"])) < 1e-9
    theta = np.linspace(*pairs[0], 20001)
    loop = eye("interchanged")(theta)
    assert [np.ptp(loop.real), np.ptp(loop.imag)] == pytest.approx(TAKE_UP["loop_size"], abs=6e-4)
    assert double_points(eye("printed"))[0].shape == (0, 2)


def test_the_small_loop_is_missed_by_too_coarse_a_search() -> None:
    curve = eye("interchanged", 52.6)
    assert len(double_points(curve)[0]) == 1
    assert len(double_points(curve, 60)[0]) == 0
    assert len(double_points(eye("interchanged", 53.0))[0]) == 0


def test_double_points_of_curves_that_are_known() -> None:
    def figure_eight(t, order):
        return [np.sin(t) + 0.5j * np.sin(2 * t), np.cos(t) + 1j * np.cos(2 * t)][order]

    pairs, points = double_points(lambda t, order: figure_eight(t + 0.1, order))
    np.testing.assert_allclose(pairs, [[math.pi - 0.1, TURN - 0.1]], atol=1e-12)
    assert abs(points[0]) < 1e-12
    # A trochoid of four inner loops: exp(it) + a exp(5it) with a > 1/5 crosses itself at least four times.
    many, _ = double_points(lambda t, k: np.exp(1j * t) * 1j**k + 0.5 * (5j) ** k * np.exp(5j * t))
    values = np.exp(1j * many) + 0.5 * np.exp(5j * many)
    assert (
        len(many) >= 4 and len(many) % 4 == 0 and np.abs(values[:, 0] - values[:, 1]).max() < 1e-12
    )


def test_cusp() -> None:
    machine = READINGS["interchanged"]

    def centrode(theta: np.ndarray) -> np.ndarray:
        run = solve(machine, theta)
        return moving_centrode(run.point("coupler", "A"), run.point("coupler", "B"))

    angles = zeros(lambda theta, order: centrode(theta)[order].real - (order == 0))
    far = -19 * centrode(angles)[0].imag
    found = np.abs(far - TAKE_UP["cusp"][0]).argmin()
    assert far[found] == pytest.approx(TAKE_UP["cusp"][0], abs=1e-8)
    assert np.degrees(angles[found]) == pytest.approx(TAKE_UP["cusp"][1], abs=1e-4)
    assert abs(eye("interchanged", far[found])(angles[found], 1)) < 1e-11


def test_near_stop_round_the_double_point() -> None:
    curve, centre = eye("interchanged"), complex(*TAKE_UP["double_point"])
    for radius, degrees in TAKE_UP["near_stop_deg"].items():
        spans = np.degrees(near_stops(curve, centre, float(radius)))
        assert spans.max() - spans.min() == pytest.approx(degrees, abs=0.06)
        inside = np.abs(curve(np.radians(np.arange(0, 360, 0.01))) - centre) <= float(radius)
        assert (spans[:, 1] - spans[:, 0]).sum() == pytest.approx(inside.sum() * 0.01, abs=0.03)


def test_eye_through_a_guide_has_a_kink_not_a_number() -> None:
    rows = jets.thread_length(
        np.array([[eye("printed")(1.0, k)] for k in range(3)]),
        np.array([[eye("printed")(1.0)], [0], [0]]),
    )
    assert rows[0, 0] == 0 and np.isnan(rows[1:]).all()


# Four-bars


def test_four_bar_classes() -> None:
    assert four_bar(40, 10, 30, 30).kind == "crank-rocker"
    assert four_bar(40, 30, 30, 10).kind == "rocker-crank"
    assert four_bar(40, 30, 10, 30).kind == "double-rocker"
    assert four_bar(40, 25, 20, 22).kind == "triple-rocker"
    assert four_bar(30, 20, 30, 20).kind == "change-point"
    assert four_bar(100, 20, 30, 20).kind == "none"
    assert four_bar(100, 20, 30, 20).open_deg == ((0.0, 180.0),)


def test_the_fold_of_the_take_up() -> None:
    kinds = {frame: four_bar(frame, 30, 30, 19) for frame in (9, 19, 19.0001)}
    assert [k.kind for k in kinds.values()] == ["double-crank", "change-point", "rocker-crank"]
    assert [k.full_turn for k in kinds.values()] == [True, True, False]
    assert kinds[19.0001].slack == pytest.approx(-1e-4, rel=1e-6)


@given(st.lists(st.floats(1, 50), min_size=4, max_size=4))
@settings(max_examples=60, deadline=None)
def test_open_angles_are_where_nothing_assembles(lengths: list[float]) -> None:
    frame, crank, coupler, output = lengths
    theta = np.linspace(0.001, 179.999, 400)
    far = np.abs(frame - crank * np.exp(1j * np.radians(theta)))
    closes = (far <= coupler + output) & (far >= abs(coupler - output))
    told, near = np.zeros(theta.shape, bool), np.zeros(theta.shape, bool)
    for low, high in four_bar(*lengths).open_deg:
        told |= (theta > low) & (theta < high)
        near |= (np.abs(theta - low) < 1e-3) | (np.abs(theta - high) < 1e-3)
    assert (closes == ~told)[~near].all()


def test_dead_points_of_a_crank_rocker_are_extremes_of_its_output() -> None:
    machine = chains.four_bar(40, 10, 35, 30)
    at, _ = extremes(lambda theta, order: solve(machine, theta, order).angle("rocker")[order])
    # Triangle O, C, B with the coupler and the crank in line, stretched and folded.
    stretched, folded = (
        math.acos((40**2 + side**2 - 30**2) / (2 * 40 * side)) for side in (45, 25)
    )
    np.testing.assert_allclose(at, np.sort([stretched, folded + math.pi]), atol=1e-12)


def test_unit_turn_to_1e_15() -> None:
    theta = np.concatenate(
        [EVERYWHERE, -EVERYWHERE, [0, math.pi, -math.pi, math.pi / 2, TURN, 1e4, 1e-300]]
    )
    assert np.abs(jets.unit_turn(theta) - np.exp(1j * theta)).max() < 1e-15


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


def test_a_line_to_and_fro_does_not_cross_itself() -> None:
    """Rounding alone makes its pieces cross; a lemniscate's two branches do, at a right angle."""

    def line(theta: Floats, order: int) -> Points:
        sway = (np.cos(theta) + 0.3 * np.sin(2 * theta), -np.sin(theta) + 0.6 * np.cos(2 * theta))[
            order
        ]
        return np.asarray(np.exp(0.3j) * (20 + sway))

    def eight(theta: Floats, order: int) -> Points:
        return np.asarray(
            (np.sin(theta) + 0.5j * np.sin(2 * theta), np.cos(theta) + 1j * np.cos(2 * theta))[
                order
            ]
        )

    assert not len(double_points(line, 1440)[0])
    pairs, places = double_points(eight, 1441)
    assert len(pairs) == 1 and abs(places[0]) < 1e-9
