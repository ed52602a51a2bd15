"""Levels of an assembly: both searches against each other, distances against shapely, and what cannot be laid."""

from __future__ import annotations

import math

import numpy as np
import pytest

from camgen.errors import DesignError
from camgen.geometry.convex import distance
from camgen.parts import level_rules as lr
from camgen.parts import levels as lv

THETA = np.linspace(0, math.tau, 360, endpoint=False)
STILL = np.ones(len(THETA))


def four_bar() -> tuple[list[lr.Band], list[lr.Axis]]:
    a = 20 * np.exp(1j * THETA)
    d = 70 - a
    far = np.abs(d)
    x = (far**2 + 60**2 - 50**2) / (2 * far)
    b = a + d / far * (x + 1j * np.sqrt(60**2 - x**2))
    bands = [
        lr.Band("crank", np.array([0 * STILL, a]), 5), lr.Band("coupler", np.array([a, b]), 5),
        lr.Band("rocker", np.array([70 * STILL, b]), 5),
    ]  # fmt: skip
    axes = [
        lr.Axis("O", ("crank",), 0j * STILL, 4, True, 0), lr.Axis("A", ("crank", "coupler"), a, 4),
        lr.Axis("B", ("coupler", "rocker"), b, 4), lr.Axis("C", ("rocker",), 70 + 0j * STILL, 4, True),
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
        found = distance(*shapes)
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
            if band.name not in axis.links and distance(band.corners, axis.place[None]).min() < band.radius + axis.radius:
                (low, high), (at, _) = lr.span(axis, found), lr.span(band, found)
                assert at < low or at > high


@pytest.mark.parametrize("over, level", [(0, 2), (1, 3), (2, 4)])
def test_what_passes_a_cover_lies_over_it(monkeypatch: pytest.MonkeyPatch, over: int, level: int) -> None:
    """A wall takes so many levels over its link on level 1; what crosses it lies on the next one, by both searches."""
    bands = [lr.Band("runner", np.array([0 * STILL, 10 * STILL]), 2), lr.Band("other", np.array([5j * STILL, 30j * STILL]), 2)]
    walls = [lr.Wall("cover", np.array([5j * STILL]), 3, "runner", "", over)]
    for _ in range(2):
        assert lv.levels(bands, [], THETA, 0.2, {"runner": 1}, walls) == {"runner": 1, "other": level}
        monkeypatch.setattr(lv, "search", lambda *_: None)


def test_a_pin_in_the_way_is_named() -> None:
    """A link between two ground pivots that both reach higher than it may lie."""
    bands, axes = four_bar()
    post = lr.Axis("T", ("rocker",), 20 + 0j * STILL, 4, True)  # in the crank's and coupler's way
    with pytest.raises(DesignError, match=r"distance of what cannot pass.*T") as caught:
        lv.levels(bands, [*axes, post], THETA, 0.2, {"rocker": 3, "crank": 1, "coupler": 2})
    assert caught.value.limit > caught.value.value


def crossed() -> tuple[list[lr.Band], list[lr.Axis]]:
    """Two links on one pin of the ground, and a third right across it."""
    pin = 0j * STILL
    bands = [lr.Band("low", np.array([pin, pin + 30]), 5), lr.Band("high", np.array([pin, pin - 30]), 5),
             lr.Band("across", np.array([pin + 20j, pin - 20j]), 5)]  # fmt: skip
    return bands, [lr.Axis("C", ("low", "high"), pin, 4, True, far=True)]


def test_a_pin_between_two_plates_leaves_out_where_a_link_passes() -> None:
    """A head on the lower stub, the link, a head under the upper stub."""
    bands, axes = crossed()
    found = lv.levels(bands, axes, THETA, 0.2, over=[("across", "low"), ("high", "across")])
    assert found == {"low": 1, "across": 3, "high": 5}
    assert lv.cuts(bands, axes, (), 0.2, found) == {"C": 1}
    assert lv.cuts(bands[:2], axes, (), 0.2, found) == {}  # it goes through
    over = lv.levels(bands, axes, THETA, 0.2, over=[("low", "across"), ("high", "across")])
    assert over is not None and over["across"] == 1 and min(over["low"], over["high"]) == 3
    assert lv.cuts(bands, axes, (), 0.2, over) == {"C": 0}  # all hangs from the upper plate


def test_a_shaft_that_must_stand_on_the_lower_plate_is_in_the_way() -> None:
    bands, (axis,) = crossed()
    shaft = lr.Axis("C", axis.links, axis.place, 4, True, 0, far=True, low=axis.links)
    with pytest.raises(DesignError, match="cannot pass.*across and C"):
        lv.levels(bands, [shaft], THETA, 0.2, {"low": 2, "high": 3, "across": 1})
    apart = lr.Axis("C", axis.links, axis.place, 4, True, 0, far=True, low=("low",), high=("high",))
    assert lv.levels(bands, [apart], THETA, 0.2, over=[("high", "low")]) == {"low": 1, "across": 2, "high": 3}
