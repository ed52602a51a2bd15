"""Nine points by homotopy: the known solutions, a hidden four-bar from both ends of the way, its cognates, what is wanted of it."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from camgen.design import nine_points, positions
from camgen.design.fourbars import FourBars, Room
from camgen.design.nine_points import (
    classes,
    doubles,
    equations,
    followed,
    nine_point_four_bars,
    starts,
)
from camgen.design.wanted import PointWish
from camgen.errors import DesignError

FOLDER = Path(__file__).resolve().parents[1] / "reference"
HIDDEN, _, ELLIPSE = tomllib.loads((FOLDER / "points.toml").read_text())["nine"]
NEIGHBOURS = 3  # paths beside that of the hidden four-bar


def hidden() -> FourBars:
    """Frame 80, crank 30, coupler 70, rocker 60, point 25 + 30i, at nine crank angles."""
    coupler = np.exp(1j * math.acos((70**2 + 50**2 - 60**2) / (2 * 70 * 50)))
    a = np.array([[30 + 0j]])
    ends = (np.array([0j]), np.array([80 + 0j]))
    drawn = FourBars(*ends, a, a + 70 * coupler, a + (25 + 30j) * coupler)
    return drawn.driven(np.radians(HIDDEN["crank_deg"]))


def unknowns(bars: FourBars) -> tuple[np.ndarray, np.ndarray]:
    """x, a, y, b of the first four-bar, each with its conjugate, (1, 8), and d with its conjugates, (2, 8)."""
    first = bars.p[0, 0]
    d = bars.p[1:, 0] - first
    size = np.sqrt(np.mean(np.abs(d) ** 2))
    z = np.array([bars.a[0, 0], bars.o[0], bars.b[0, 0], bars.c[0]]) - first
    pairs = np.stack([z, np.conj(z)], axis=-1).reshape(1, 8)
    return pairs / size, np.stack([d, np.conj(d)]) / size


def test_the_known_solutions_are_1442_classes() -> None:
    at, known = starts()
    value, slope = equations(known, at)
    steps = np.linalg.solve(slope, value[:, :, None])[:, :, 0]
    assert known.shape == (1442, 8)
    assert np.max(np.abs(steps) / np.max(np.abs(known), axis=1)[:, None]) < 1e-10
    assert not doubles(known).any()
    apart = np.max(np.abs(classes(known)[:, None] - classes(known)), axis=2)
    assert np.min(apart + np.eye(1442)) > 1e-3
    assert doubles(np.concatenate([known[:5], known[3:4]])).tolist() == [False] * 5 + [True]


def test_a_four_bar_fulfils_the_equations_and_a_damaged_one_does_not() -> None:
    z, at = unknowns(hidden())
    assert np.max(np.abs(equations(z, at)[0])) < 1e-12
    z[0, 0] += 0.01
    assert np.max(np.abs(equations(z, at)[0])) > 1e-4


def test_slopes_are_those_of_difference_quotients() -> None:
    rng = np.random.default_rng(4)
    z = rng.normal(size=(2, 8)) + 1j * rng.normal(size=(2, 8))
    at = rng.normal(size=(2, 8)) + 1j * rng.normal(size=(2, 8))
    _, slope = equations(z, at)
    for k in range(8):
        step = np.zeros(8)
        step[k] = 1e-6
        quotient = (equations(z + step, at)[0] - equations(z - step, at)[0]) / 2e-6
        np.testing.assert_allclose(slope[:, :, k], quotient, rtol=1e-6, atol=1e-6)


def test_a_singular_solution_stops_no_other() -> None:
    at, known = starts()
    value, slope = equations(known[:3] + 0.01, at)
    alone = nine_points._solved(value, slope)
    slope[1] = 0.0
    steps = nine_points._solved(value, slope)
    assert np.isnan(steps[1]).all()
    np.testing.assert_array_equal(steps[[0, 2]], alone[[0, 2]])


@pytest.fixture(scope="module")
def number() -> int:
    """Of the known solution at the other end of the hidden four-bar's way."""
    at, known = starts()
    z, end = unknowns(hidden())
    back, arrived = followed(z, end, at)
    assert arrived.all()
    off = np.max(np.abs(classes(known) - classes(back)), axis=1)
    assert np.sum(off < 1e-9) == 1
    return int(np.argmin(off))


@pytest.fixture
def few(number: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Only the way of the hidden four-bar is gone, and a few beside it."""
    at, known = starts()
    some = (number + np.arange(NEIGHBOURS + 1)) % len(known)
    monkeypatch.setattr(nine_points, "starts", lambda: (at, known[some]))


@pytest.mark.usefixtures("few")
def test_a_hidden_four_bar_is_found_with_its_cognates_by_either_crank() -> None:
    bars = nine_point_four_bars(hidden().p[:, 0])
    for lengths in HIDDEN["lengths"][:2]:
        for frame, crank, coupler, rocker in (lengths, [lengths[k] for k in (0, 3, 2, 1)]):
            off = np.max(np.abs(bars.lengths.T - [frame, crank, coupler, rocker]), axis=1)
            assert np.min(off) < 1e-5
    for a, b in ((bars.a, bars.o), (bars.b, bars.c), (bars.a, bars.b), (bars.p, bars.b)):
        assert np.max(np.ptp(np.abs(a - b), axis=0)) < 1e-9
    np.testing.assert_array_equal(bars.p, np.repeat(hidden().p, len(bars.o), axis=1))


def test_cognates_pass_the_points_with_the_lengths_of_another_program() -> None:
    bars = hidden().with_cognates()
    assert len(bars.o) == 6
    off = np.max(np.abs(bars.lengths.T - HIDDEN["lengths"][1]), axis=1)
    assert np.min(off) < 1e-5
    for a, b in ((bars.a, bars.o), (bars.b, bars.c), (bars.a, bars.b), (bars.p, bars.a)):
        assert np.max(np.ptp(np.abs(a - b), axis=0)) < 1e-9


@pytest.mark.usefixtures("few")
def test_of_two_solutions_at_one_end_both_are_followed_again(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The first one, of the hidden four-bar, jumps to the end of the second one."""
    runs: list[int] = []

    def jumping(known: np.ndarray, *others: Any) -> tuple[np.ndarray, np.ndarray]:
        z, arrived = followed(known, *others)
        if not runs:
            z[0] = z[1]
        runs.append(len(known))
        return z, arrived

    monkeypatch.setattr(nine_points, "followed", jumping)
    bars = nine_point_four_bars(hidden().p[:, 0])
    assert runs == [NEIGHBOURS + 1, 2]
    off = np.max(np.abs(bars.lengths.T - HIDDEN["lengths"][0]), axis=1)
    assert np.min(off) < 1e-5


@pytest.mark.long
@pytest.mark.parametrize("sham", [False, True])
def test_what_the_straight_way_loses_comes_by_the_bent_one(
    sham: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One solution, whose straight way is lost or comes to a sham, the coupler point a joint; bent it leads to the hidden four-bar."""
    at, known = starts()
    z, end = unknowns(hidden())
    back, arrived = followed(z, end, at, aside=-nine_points._ASIDE)
    off = np.max(np.abs(classes(known) - classes(back)), axis=1)
    assert arrived.all() and np.min(off) < 1e-9
    asides: list[complex] = []

    def losing(*way: Any, aside: complex = 0.0) -> tuple[np.ndarray, np.ndarray]:
        asides.append(aside)
        z, arrived = followed(*way, aside=aside)
        if not aside:
            z[:, :2] = 0
            arrived[:] = sham
        return z, arrived

    monkeypatch.setattr(nine_points, "starts", lambda: (at, known[[np.argmin(off)]]))
    monkeypatch.setattr(nine_points, "followed", losing)
    lengths = nine_point_four_bars(hidden().p[:, 0]).lengths.T
    assert np.min(np.max(np.abs(lengths - HIDDEN["lengths"][0]), axis=1)) < 1e-5
    assert asides == [0, 0, nine_points._ASIDE]


def test_four_bars_that_are_nearly_images_in_a_mirror_are_two(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Points of an ellipse, symmetrical but for their last digits: the sums of the cognates' pivots differ by 1e-6."""
    points = np.array([complex(*place) for place in ELLIPSE["points"]])
    d = points[1:] - points[0]
    d = d / np.sqrt(np.mean(np.abs(d) ** 2))
    end = np.stack([d, np.conj(d)])
    drawn = np.array(
        [
            [-0.41836 + 0.12653j, -0.67531 - 0.00013j, -0.62435 + 0.18871j, -0.54609 - 0.00010j],
            [-0.77804 + 0.38078j, -0.93776 - 0.00005j, -0.25754 + 0.12593j, -0.67557 - 0.00013j],
        ]
    )
    z = nine_points.newton(np.stack([drawn, np.conj(drawn)], axis=-1).reshape(2, 8), end)
    at, known = starts()
    back, arrived = followed(z, end, at)
    assert arrived.all()
    off = np.max(np.abs(classes(back)[:, None] - classes(known)), axis=2)
    numbers = np.argmin(off, axis=1)
    assert np.max(np.min(off, axis=1)) < 1e-9 and numbers[0] != numbers[1]
    monkeypatch.setattr(nine_points, "starts", lambda: (at, known[numbers]))
    bars = nine_point_four_bars(points)
    cranks = np.sort(bars.lengths[1].reshape(6, 2), axis=0)
    assert len(bars.o) == 12 and np.max(np.abs(cranks[:, 0] - cranks[:, 1])) > 0.01
    for a, b in ((bars.a, bars.o), (bars.b, bars.c), (bars.a, bars.b), (bars.p, bars.b)):
        assert np.max(np.ptp(np.abs(a - b), axis=0)) < 1e-7


@pytest.mark.usefixtures("few")
def test_exact_four_bars_become_designs_or_their_defects_are_counted(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The least squares beside it finds nothing here."""
    monkeypatch.setattr(positions, "near", lambda passing, *rest: hidden().those(np.zeros(1, bool)))
    wish = PointWish(points=tuple((z.real, z.imag) for z in hidden().p[:, 0].tolist()))

    def cranks(longest: float) -> list[float]:
        room = Room(-200 - 200j, 200 + 200j, 6.0, longest, math.radians(20), True)
        designs = positions.point_designs(wish, room, {}, np.random.default_rng(0))
        found = [designs.of(k) for k in range(len(designs.losses))]
        return sorted(abs(each.places["A"] - each.places["O"]) for each in found)

    np.testing.assert_allclose(cranks(250.0), [23.178544, 30], atol=1e-5)
    with pytest.raises(DesignError, match="with a link or pivot out of bounds") as told:
        cranks(50.0)
    assert "a greater wanted.longest" in str(told.value)


@pytest.mark.usefixtures("few")
def test_a_point_that_comes_twice_leaves_no_single_solutions() -> None:
    z = hidden().p[:, 0].copy()
    z[4] = z[0]
    assert not len(nine_point_four_bars(z).o)
