"""Forces in linkages: the take-up's cited peaks, balances recomputed by another route, and counterweights that work."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgen.machine.dynamics import Body, Forces, Pin, Slide, crank_weight, kinetostatics, smallest_circle
from camgen.machine.linkages import RRP, RRR, Crank, Fixed, Linkage

TAKE_UP = tomllib.loads((Path(__file__).resolve().parents[1] / "reference" / "thread-take-up.toml").read_text())
THETA = np.arange(36000) * 2 * math.pi / 36000
SPEED = TAKE_UP["speed_rpm"] * 2 * math.pi / 60
PINS = [Pin("O", "crank"), Pin("A", "coupler", "crank"), Pin("B", "output", "coupler"), Pin("C", "output")]
FOUR_BAR = Linkage({"O": Fixed(0), "C": Fixed(9), "A": Crank("O", 30), "B": RRR("A", "C", *TAKE_UP["printed"], 1)})
LOW = {
    "crank": Body("O", "A", 0.0),
    "coupler": Body("A", "B", TAKE_UP["mass"][0], 15 - 10j, TAKE_UP["inertia"][0]),
    "output": Body("C", "B", TAKE_UP["mass"][1], 9.5, TAKE_UP["inertia"][1]),
}
CENTROID = LOW | {
    "coupler": Body("A", "B", TAKE_UP["mass"][0], (0 + 30 + 30 - 52j) / 3, TAKE_UP["inertia"][0]),
    "output": Body("C", "B", TAKE_UP["mass"][1], 19 / 3, TAKE_UP["inertia"][1]),
}


def four_bar(bodies: dict[str, Body], speed: float = SPEED, theta: np.ndarray = THETA) -> Forces:
    return kinetostatics(FOUR_BAR.solve(theta, 2), bodies, PINS, [], "crank", speed)


def peak(forces: Forces, point: str) -> float:
    return float(np.abs(forces.reactions[point]).max())


@pytest.mark.parametrize(("bodies", "key"), [(LOW, "peaks_low_centres"), (CENTROID, "peaks_centroid")])
def test_peak_reactions_of_the_take_up(bodies: dict[str, Body], key: str) -> None:
    forces = four_bar(bodies)
    for point, value in zip("ABC", TAKE_UP[key], strict=True):
        assert peak(forces, point) == pytest.approx(value, abs=6e-4)
    assert peak(forces, "C") == pytest.approx(TAKE_UP["published_peak_C"], abs=3)


def test_reactions_scale_with_the_square_of_the_speed() -> None:
    slow, fast = four_bar(LOW, 100.0, THETA[::100]), four_bar(LOW, 300.0, THETA[::100])
    for point in "OABC":
        np.testing.assert_allclose(fast.reactions[point], 9 * slow.reactions[point], rtol=1e-9, atol=1e-12)


def test_power_balance_and_sum_of_forces() -> None:
    forces = four_bar(LOW)
    np.testing.assert_allclose(forces.torque * SPEED, forces.power, atol=1e-9 * np.abs(forces.power).max())
    # The same rate from the energy itself, by Fourier differentiation.
    waves = np.fft.rfft(forces.energy)
    rate = np.fft.irfft(1j * np.arange(waves.size) * waves) * SPEED
    np.testing.assert_allclose(rate, forces.power, atol=1e-8 * np.abs(forces.power).max())
    # F_A + F_C = m2 a2 + m3 a3, the accelerations by Fourier differentiation of the centres' ways.
    jets = FOUR_BAR.solve(THETA)
    pull = 0
    for name in ("coupler", "output"):
        body = LOW[name]
        a, b = jets[body.a][0], jets[body.b][0]
        way = np.fft.fft((a + (b - a) / abs(b[0] - a[0]) * body.centre) * 1e-3)
        k = np.fft.fftfreq(way.size, 1 / way.size)
        pull = pull + body.mass * np.fft.ifft(np.where(np.abs(k) < 400, -(k**2) * way, 0)) * SPEED**2
    both = forces.reactions["A"] + forces.reactions["C"]
    np.testing.assert_allclose(both, pull, atol=1e-8 * np.abs(both).max())
    np.testing.assert_allclose(forces.shaking, -both, atol=1e-10 * np.abs(both).max())


def test_moment_balance_of_the_output_crank_by_hand() -> None:
    theta = THETA[::500]
    jets, forces = FOUR_BAR.solve(theta, 2), four_bar(LOW, theta=theta)
    body, u = LOW["output"], (jets["B"] - jets["C"]) * 1e-3
    alpha = (u[2] / u[0] - (u[1] / u[0]) ** 2).imag * SPEED**2
    about_c = (np.conj(u[0]) * forces.reactions["B"]).imag
    np.testing.assert_allclose(about_c, (body.inertia + body.mass * 0.0095**2) * alpha, atol=1e-12)


def test_a_wrong_mass_is_seen() -> None:
    heavy = LOW | {"output": Body("C", "B", 0.0084, 9.5, TAKE_UP["inertia"][1])}
    assert peak(four_bar(heavy), "C") != pytest.approx(TAKE_UP["peaks_low_centres"][2], abs=6e-4)


def slider_crank(offset: float) -> tuple[Linkage, dict[str, Body], list[Pin], list[Slide]]:
    linkage = Linkage({"O": Fixed(0), "A": Crank("O", 1.5), "B": RRP("A", 48, 1j * offset, 0.0)})
    bodies = {
        "crank": Body("O", "A", 2e-3, 0.7 + 0.2j, 1e-8),
        "rod": Body("A", "B", 3e-3, 20 + 1j, 2e-7),
        "slider": Body("B", "B", 4e-3),
    }
    pins = [Pin("O", "crank"), Pin("A", "rod", "crank"), Pin("B", "slider", "rod")]
    return linkage, bodies, pins, [Slide("B", "slider", 0.0)]


@pytest.mark.parametrize("offset", [0.0, 7.0])
def test_slider_crank_against_newton_and_energy(offset: float) -> None:
    linkage, bodies, pins, slides = slider_crank(offset)
    theta, speed = THETA[::100], 1361.357
    jets = linkage.solve(theta, 2)
    forces = kinetostatics(jets, bodies, pins, slides, "crank", speed)
    push = 4e-3 * jets["B"][2].real * 1e-3 * speed**2
    np.testing.assert_allclose(forces.reactions["B"].real, push, atol=1e-12 * np.abs(push).max() + 1e-9)
    np.testing.assert_allclose(forces.normals["B"], -forces.reactions["B"].imag, atol=1e-10)
    np.testing.assert_allclose(forces.moments["B"], 0, atol=1e-12)
    np.testing.assert_allclose(forces.torque * speed, forces.power, atol=1e-10 * np.abs(forces.power).max())
    ground = forces.reactions["O"] + 1j * forces.normals["B"]
    np.testing.assert_allclose(ground, -forces.shaking, atol=1e-9 * np.abs(ground).max())


def test_a_slider_heavy_above_its_pin_leans_on_its_guide() -> None:
    linkage, bodies, pins, slides = slider_crank(0.0)
    jets = linkage.solve(THETA[::100], 2)
    bodies |= {"slider": Body("B", "B", 4e-3, 3j)}
    forces = kinetostatics(jets, bodies, pins, slides, "crank", 1000.0)
    # The inertia of 4 g acts 3 mm to the left of the pin; both forces on the slider act at the pin.
    np.testing.assert_allclose(forces.moments["B"], -3e-3 * 4e-3 * jets["B"][2].real * 1e-3 * 1e6, atol=1e-12)


def test_massless_rod_has_the_textbook_torque() -> None:
    """Torque = slider force times its speed over the crank's: T w = m a v."""
    linkage, _, pins, slides = slider_crank(0.0)
    bodies = {"crank": Body("O", "A", 0), "rod": Body("A", "B", 0), "slider": Body("B", "B", 0.01)}
    jets = linkage.solve(THETA[::100], 2)
    forces = kinetostatics(jets, bodies, pins, slides, "crank", 100.0)
    expected = 0.01 * (jets["B"][2].real * 1e-3 * 1e4) * (jets["B"][1].real * 1e-3)
    np.testing.assert_allclose(forces.torque, expected, atol=1e-14)


def test_no_answer_where_not_assembled_or_at_a_dead_point() -> None:
    linkage = Linkage({"O": Fixed(0), "A": Crank("O", 30), "B": RRP("A", 20, 0, 0.0)})
    _, bodies, pins, slides = slider_crank(0.0)
    jets = linkage.solve(np.array([0.1, math.pi / 2, 3.0]), 2)
    forces = kinetostatics(jets, bodies, pins, slides, "crank", 10.0)
    assert (np.isfinite(forces.torque) == [True, False, True]).all()
    assert np.isnan(forces.reactions["O"][1]) and np.isnan(forces.energy[1])
    with pytest.raises(ValueError, match="7 unknown forces for 9 balances"):
        kinetostatics(jets, bodies, pins[:2], slides, "crank", 10.0)


def test_balancing_as_in_the_paper() -> None:
    """Coupler's centre brought to B, then the output crank's with it to C: nothing shakes, and the pins bear more."""
    coupler = LOW["coupler"].balanced(30, 20.0)
    assert coupler.centre == pytest.approx(30)
    output = LOW["output"].balanced(0, 15.0, carried=coupler.mass, at=19)
    both = (output.mass * output.centre + coupler.mass * 19) / (output.mass + coupler.mass)
    assert abs(both) < 1e-12
    before, after = four_bar(LOW), four_bar(LOW | {"coupler": coupler, "output": output})
    assert np.abs(after.shaking).max() < 1e-9 * np.abs(before.shaking).max()
    assert peak(after, "B") > peak(before, "B") and np.abs(after.torque).max() > np.abs(before.torque).max()
    np.testing.assert_allclose(after.torque * SPEED, after.power, atol=1e-9 * np.abs(after.power).max())


def test_counterweight_on_the_crank_is_the_best_there_is() -> None:
    before = four_bar(LOW)
    moment, left = crank_weight(before.reactions["O"], THETA, SPEED)
    assert left < 0.9 * peak(before, "O")

    def peak_with(weight: complex) -> float:
        place = weight / abs(weight) * 20
        return peak(four_bar(LOW | {"crank": Body("O", "A", 0.0).with_weight(abs(weight) / 20, place)}, theta=THETA[::20]), "O")

    assert peak_with(moment) == pytest.approx(left, rel=1e-5)
    for step in 1e-3 * abs(moment) * np.exp(1j * np.arange(8) * math.pi / 4):
        assert peak_with(moment + step) > left
    far = four_bar(LOW | {"crank": Body("O", "A", 0.0).with_weight(abs(moment) / 20, moment / abs(moment) * 20)})
    for point in "ABC":  # an evenly turning weight loads nothing but its own bearing
        np.testing.assert_allclose(far.reactions[point], before.reactions[point], atol=1e-9)


def test_weights_add_up_as_point_masses() -> None:
    body = Body("A", "B", 2.0, 3 + 1j, 1e-6).with_weight(0.5, -4 + 2j)
    assert body.mass == 2.5 and body.centre == pytest.approx((2 * (3 + 1j) + 0.5 * (-4 + 2j)) / 2.5)
    about_origin = body.inertia + body.mass * abs(body.centre) ** 2 * 1e-6
    assert about_origin == pytest.approx(1e-6 + (2 * 10 + 0.5 * 20) * 1e-6, rel=1e-12)


@given(st.lists(st.complex_numbers(max_magnitude=100), min_size=1, max_size=30))
@settings(max_examples=100)
def test_smallest_circle_holds_all_and_no_smaller_one_does(points: list[complex]) -> None:
    z = np.array(points)
    centre, radius = smallest_circle(z)
    assert np.abs(z - centre).max() <= radius * (1 + 1e-9) + 1e-12
    # The greatest distance is convex in the centre: no neighbour may be better.
    for step in 1e-3 * np.exp(1j * np.arange(12) * math.pi / 6):
        assert np.abs(z - centre - step).max() >= radius - 1e-9
