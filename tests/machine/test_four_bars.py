"""Many four-bars at once against the one solver, closed forms, and a chain that opens."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgen.machine.closed_form import four_bar, transmission_extremes
from camgen.machine.four_bars import four_bars

RNG = np.random.default_rng(3)
THETA = np.linspace(0, math.tau, 64, endpoint=False)


def test_both_links_keep_their_lengths_and_the_branch_its_side() -> None:
    f, r, c, o = RNG.uniform(10, 60, (4, 3000))
    side = RNG.choice([-1, 1], 3000)
    seen = 0
    for block in four_bars(f, r, c, o, THETA, side):
        n = slice(block.first, block.first + block.frame.size)
        seen += block.frame.size
        there = np.isfinite(block.b.real)
        np.testing.assert_allclose(
            np.abs(block.b - block.a)[there], np.broadcast_to(c[n], there.shape)[there], rtol=1e-9
        )
        np.testing.assert_allclose(
            np.abs(block.b - f[n])[there], np.broadcast_to(o[n], there.shape)[there], rtol=1e-9
        )
        left = ((f[n] - block.a).conjugate() * (block.b - block.a)).imag
        assert np.all((left * side[n] > 0)[there])
        for k in range(
            0, block.frame.size, 97
        ):  # who cannot turn fully is open somewhere, but for what lies between two angles
            bar = four_bar(*(float(each[block.first + k]) for each in (f, r, c, o)))
            assert (
                block.closes[k] == 1 if bar.full_turn else block.closes[k] < 1 or bar.slack > -0.1
            )
    assert seen == 3000


@settings(max_examples=50)
@given(st.floats(30, 60), st.floats(5, 12), st.floats(30, 60), st.floats(30, 60))
def test_extremes_are_the_closed_forms(f: float, r: float, c: float, o: float) -> None:
    """A crank-rocker or drag link: at 0 and pi, which are among the angles."""
    if not four_bar(f, r, c, o).full_turn:
        return
    (block,) = four_bars(f, r, c, o, THETA)
    found = [float(each[0]) for each in block.transmission]
    np.testing.assert_allclose(found, transmission_extremes(f, r, c, o), atol=1e-7)


def test_swing_of_a_crank_rocker_and_turn_of_a_drag_link() -> None:
    """Swing by the two dead points, where crank and coupler lie in one line; a drag link's output goes round."""
    fine = np.linspace(0, math.tau, 20001)
    (rocker,) = four_bars(40.0, 12.0, 35.0, 30.0, fine)

    def corner(side: float) -> float:
        return math.acos((40**2 + 30**2 - side**2) / (2 * 40 * 30))

    assert rocker.output_range[0] == pytest.approx(corner(35 + 12) - corner(35 - 12), abs=1e-6)
    (drag,) = four_bars(9.0, 30.0, 19.0, 30.0, fine)
    assert drag.output_range[0] == pytest.approx(math.tau, abs=1e-9)


def test_points_of_couplers_and_open_chains() -> None:
    (block,) = four_bars([40.0, 10.0], [12.0, 30.0], [35.0, 5.0], [30.0, 6.0], THETA)
    path = block.coupler_point([20.0, 1.0], [0.0, 0.0])
    np.testing.assert_allclose(np.abs(path[:, 0] - block.a[:, 0]), 20, rtol=1e-12)
    assert (
        block.closes[1] == 0
        and np.isnan(block.output_range[1])
        and np.isnan(block.transmission[0][1])
    )
