"""Levels of an assembly: both searches against each other, distances against shapely, and what cannot be laid."""

from __future__ import annotations

import math

import numpy as np
import pytest

from camgen.errors import DesignError
from camgen.parts import levels as lv

THETA = np.linspace(0, math.tau, 360, endpoint=False)
STILL = np.ones(len(THETA))


def four_bar() -> tuple[list[lv.Band], list[lv.Axis]]:
    a = 20 * np.exp(1j * THETA)
    d = 70 - a
    far = np.abs(d)
    x = (far**2 + 60**2 - 50**2) / (2 * far)
    b = a + d / far * (x + 1j * np.sqrt(60**2 - x**2))
    bands = [
        lv.Band("crank", np.array([0 * STILL, a]), 5), lv.Band("coupler", np.array([a, b]), 5),
        lv.Band("rocker", np.array([70 * STILL, b]), 5),
    ]  # fmt: skip
    axes = [
        lv.Axis("O", ("crank",), 0j * STILL, 4, True, False), lv.Axis("A", ("crank", "coupler"), a, 4),
        lv.Axis("B", ("coupler", "rocker"), b, 4), lv.Axis("C", ("rocker",), 70 + 0j * STILL, 4, True),
    ]  # fmt: skip
    return bands, axes


def test_distance_is_that_of_polygons() -> None:
    import shapely

    chance = np.random.default_rng(5)
    for corners in ((1, 2), (2, 2), (2, 3), (3, 4), (1, 3)):
        shapes = []
        for k in corners:
            points = chance.uniform(-1, 1, (k, 50)) + 1j * chance.uniform(-1, 1, (k, 50)) + chance.uniform(-1, 1, 50)
            if k > 2:
                points = np.array([points[:, j][np.argsort(np.angle(points[:, j] - points[:, j].mean()))] for j in range(50)]).T
                points = points[:3]
            shapes.append(points)
        found = lv.distance(*shapes)
        for j in range(50):
            hulls = [shapely.MultiPoint([(z.real, z.imag) for z in shape[:, j]]).convex_hull for shape in shapes]
            assert found[j] == pytest.approx(hulls[0].distance(hulls[1]), abs=1e-12)


def test_four_bar_lies_on_two_levels() -> None:
    assert lv.levels(*four_bar(), THETA, 0.2) == {"crank": 1, "coupler": 2, "rocker": 1}


def test_levels_that_are_given_are_kept() -> None:
    assert lv.levels(*four_bar(), THETA, 0.2, {"rocker": 4}) == {"crank": 1, "coupler": 2, "rocker": 4}


def test_what_must_lie_over_another_does() -> None:
    bands, axes = four_bar()
    assert lv.levels(bands, axes, THETA, 0.2, over=[("rocker", "coupler")]) == {"crank": 1, "coupler": 2, "rocker": 3}


@pytest.mark.parametrize("given", [{}, {"rocker": 2}, {"crank": 2}, {"coupler": 3}])
def test_the_integer_program_finds_what_all_orders_give(monkeypatch: pytest.MonkeyPatch, given: dict[str, int]) -> None:
    every = lv.levels(*four_bar(), THETA, 0.2, given)
    monkeypatch.setattr(lv, "search", lambda *_: None)
    assert lv.levels(*four_bar(), THETA, 0.2, given) == every


def test_spans_of_what_meets_never_share_a_level() -> None:
    bands, axes = four_bar()
    found = lv.levels(bands, axes, THETA, 0.2)
    for band in bands:
        for axis in axes:
            if band.name not in axis.links and lv.distance(band.corners, axis.place[None]).min() < band.radius + axis.radius:
                (low, high), (at, _) = lv.span(axis, found), lv.span(band, found)
                assert at < low or at > high


@pytest.mark.parametrize("over, level", [(0, 2), (1, 3), (2, 4)])
def test_what_passes_a_cover_lies_over_it(monkeypatch: pytest.MonkeyPatch, over: int, level: int) -> None:
    """A wall takes so many levels over its link on level 1; what crosses it lies on the next one, by both searches."""
    bands = [lv.Band("runner", np.array([0 * STILL, 10 * STILL]), 2), lv.Band("other", np.array([5j * STILL, 30j * STILL]), 2)]
    walls = [lv.Wall("cover", np.array([5j * STILL]), 3, "runner", "", over)]
    for _ in range(2):
        assert lv.levels(bands, [], THETA, 0.2, {"runner": 1}, walls) == {"runner": 1, "other": level}
        monkeypatch.setattr(lv, "search", lambda *_: None)


def test_a_pin_in_the_way_is_named() -> None:
    """A link between two ground pivots that both reach higher than it may lie."""
    bands, axes = four_bar()
    post = lv.Axis("T", ("rocker",), 20 + 0j * STILL, 4, True)  # in the crank's and coupler's way
    with pytest.raises(DesignError, match=r"distance of what cannot pass.*T") as caught:
        lv.levels(bands, [*axes, post], THETA, 0.2, {"rocker": 3, "crank": 1, "coupler": 2})
    assert caught.value.limit > caught.value.value
