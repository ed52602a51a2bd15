"""Counterweights that work: on links as in the take-up's paper, on the crank the best there is; the smallest circle."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest
from chains import take_up
from hypothesis import given, settings
from hypothesis import strategies as st

from camgen.machine import Body, Forces, solve
from camgen.machine.balancing import balanced, crank_weight, smallest_circle, with_weight

MACHINE = take_up()
THETA = np.arange(36000) * 2 * math.pi / 36000
LINKS = {body.name: body for body in MACHINE.bodies}


def forces(links: Mapping[str, Body] = {}, theta: np.ndarray = THETA) -> Forces:  # noqa: B006
    bodies = tuple({**LINKS, **links}.values())
    return solve(replace(MACHINE, bodies=bodies), theta).forces()


def peak(found: Forces, point: str) -> float:
    return float(np.abs(found.reactions[point]).max())


def test_balancing_as_in_the_paper() -> None:
    """Coupler's centre brought to B, then the output crank's with it to C: nothing shakes, and the pins bear more."""
    coupler = balanced(LINKS["coupler"], 30, 20.0)
    assert coupler.centre == pytest.approx(30)
    output = balanced(LINKS["rocker"], 0, 15.0, carried=coupler.mass, at=19)
    both = (output.mass * output.centre + coupler.mass * 19) / (output.mass + coupler.mass)
    assert abs(both) < 1e-12
    before, after = forces(), forces({"coupler": coupler, "rocker": output})
    assert np.abs(after.shaking).max() < 1e-9 * np.abs(before.shaking).max()
    assert peak(after, "B") > peak(before, "B")
    assert np.abs(after.drives["motor"]).max() > np.abs(before.drives["motor"]).max()


def test_counterweight_on_the_crank_is_the_best_there_is() -> None:
    before, speed = forces(), MACHINE.speed
    moment, left = crank_weight(before.reactions["O"], THETA, speed)
    assert left < 0.9 * peak(before, "O")

    def peak_with(weight: complex) -> float:
        place = weight / abs(weight) * 20
        return peak(
            forces({"crank": with_weight(LINKS["crank"], abs(weight) / 20, place)}, THETA[::20]),
            "O",
        )

    assert peak_with(moment) == pytest.approx(left, rel=1e-5)
    for step in 1e-3 * abs(moment) * np.exp(1j * np.arange(8) * math.pi / 4):
        assert peak_with(moment + step) > left
    far = forces(
        {"crank": with_weight(LINKS["crank"], abs(moment) / 20, moment / abs(moment) * 20)}
    )
    for point in "ABC":  # an evenly turning weight loads nothing but its own bearing
        np.testing.assert_allclose(far.reactions[point], before.reactions[point], atol=1e-9)


def test_weights_add_up_as_point_masses() -> None:
    body = with_weight(Body("link", mass=2.0, centre=3 + 1j, inertia=1e-6), 0.5, -4 + 2j)
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


def test_points_that_are_one_but_for_rounding() -> None:
    """An unbalanced disc that turns evenly: seen from it, one force; the search ends all the same."""
    theta = np.linspace(0, 2 * np.pi, 1441)
    seen = 0.3 * np.exp(1j * (theta + 0.4)) * np.exp(-1j * theta)
    centre, radius = smallest_circle(seen)
    assert abs(centre - 0.3 * np.exp(0.4j)) < 1e-12 and radius < 1e-12
