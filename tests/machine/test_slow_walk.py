"""A quasi-static walk: against walkers whose steps are known, against the least potential energy, and against a prototype."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgen.machine.slow_walk import SlowWalk, slow_walk


def level(left: float, right: float, centre: float) -> SlowWalk:
    """A frame on two feet at -10 and 10 that go back by so much, its centre of mass so far to the right."""
    rows = np.linspace(0, 1, 101)
    feet = np.stack([-10 - left * rows, 10 - right * rows]).astype(complex)
    found = slow_walk(feet, np.full(101, centre + 5j), 5j)
    assert isinstance(found, SlowWalk)
    return found


def test_feet_that_agree_carry_the_frame_without_slip() -> None:
    found = level(3, 3, 0)
    assert found.way == pytest.approx(3) and found.slip == pytest.approx(0, abs=1e-12)
    assert np.all(found.tilt == 0) and np.all(found.height == 5)
    assert found.way_between(0.3, 1.0) == pytest.approx((3, 3))


def test_the_foot_with_the_greater_load_sticks() -> None:
    found = level(2, 1, 2)  # the right one has 12 or more of 20, later of 21
    assert found.way == pytest.approx(1)
    assert found.way_between(0.3, 1.0) == pytest.approx((1, 2))
    assert found.way_between(0.9, 1.0) == pytest.approx((1, 1))
    share = found.shares[0]
    assert found.slip == pytest.approx(np.mean(share), abs=1e-3)
    assert share[0] == pytest.approx(8 / 20)
    assert found.least_share == pytest.approx(float(np.min(found.shares)))


def test_a_centre_beyond_the_feet_falls() -> None:
    rows = np.linspace(0, 1, 11)
    feet = np.stack([-10 + 0 * rows, 10 + 0 * rows]).astype(complex)
    assert slow_walk(feet, 15 * rows + 5j, 0j) == 7  # 10.5 of 10


@settings(max_examples=60, deadline=None)
@given(
    st.lists(st.tuples(st.floats(-50, 50), st.floats(-30, 0)), min_size=3, max_size=6, unique=True),
    st.tuples(st.floats(-20, 20), st.floats(20, 60)),
)
def test_it_stands_where_the_centre_of_mass_is_lowest(
    places: list[tuple[float, float]], at: tuple[float, float]
) -> None:
    """Turned a little either way on the floor its centre of mass would rise."""
    feet = np.array([complex(*place) for place in places])[:, None]
    centre = complex(*at)
    if np.ptp(feet.real) < 5:
        return
    found = slow_walk(feet, np.array([centre]), 0j)

    def height(tilt: float) -> float:
        turn = np.exp(1j * tilt)
        return float((turn * centre).imag - np.min((turn * feet).imag))

    if not isinstance(found, SlowWalk):
        return
    tilt = float(found.tilt[0])
    here = height(tilt)
    assert height(tilt + 1e-4) >= here - 1e-9 and height(tilt - 1e-4) >= here - 1e-9
    assert math.isclose(
        found.height[0], -float(np.min((np.exp(1j * tilt) * feet).imag)), abs_tol=1e-9
    )
