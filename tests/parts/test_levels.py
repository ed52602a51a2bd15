"""Levels of an assembly: both searches against each other, distances against shapely, and what cannot be laid."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from camgen.errors import DesignError
from camgen.geometry.convex import distance, hull_corners
from camgen.parts import level_rules as lr
from camgen.parts import levels as lv

THETA = np.linspace(0, math.tau, 360, endpoint=False)
STILL = np.ones(len(THETA))


def things(bands: Any, axes: Any, **more: Any) -> lr.Things:
    return lr.Things(bands, axes, 0.2, **more)


def four_bar() -> tuple[list[lr.Band], list[lr.Axis]]:
    a = 20 * np.exp(1j * THETA)
    d = 70 - a
    far = np.abs(d)
    x = (far**2 + 60**2 - 50**2) / (2 * far)
    b = a + d / far * (x + 1j * np.sqrt(60**2 - x**2))
    bands = [
        lr.Band("crank", np.array([0 * STILL, a]), 5),
        lr.Band("coupler", np.array([a, b]), 5),
        lr.Band("rocker", np.array([70 * STILL, b]), 5),
    ]
    axes = [
        lr.Axis("O", ("crank",), 0j * STILL, 4, True, 0),
        lr.Axis("A", ("crank", "coupler"), a, 4),
        lr.Axis("B", ("coupler", "rocker"), b, 4),
        lr.Axis("C", ("rocker",), 70 + 0j * STILL, 4, True),
    ]
    return bands, axes


def test_distance_is_that_of_polygons() -> None:
    import shapely

    chance = np.random.default_rng(5)
    for corners in ((1, 2), (2, 2), (2, 3), (3, 4), (1, 3)):
        shapes = []
        for k in corners:
            points = (
                chance.uniform(-1, 1, (k, 50))
                + 1j * chance.uniform(-1, 1, (k, 50))
                + chance.uniform(-1, 1, 50)
            )
            if k > 2:
                points = np.array(
                    [
                        points[:, j][np.argsort(np.angle(points[:, j] - points[:, j].mean()))]
                        for j in range(50)
                    ]
                ).T
                points = points[:3]
            shapes.append(points)
        found = distance(*shapes)
        for j in range(50):
            hulls = [
                shapely.MultiPoint([(z.real, z.imag) for z in shape[:, j]]).convex_hull
                for shape in shapes
            ]
            assert found[j] == pytest.approx(hulls[0].distance(hulls[1]), abs=1e-12)


def test_four_bar_lies_on_two_levels() -> None:
    assert lv.quick_levels(things(*four_bar())) == {"crank": 1, "coupler": 2, "rocker": 1}


def test_levels_that_are_given_are_kept() -> None:
    assert lv.quick_levels(things(*four_bar()), {"rocker": 4}) == {
        "crank": 1,
        "coupler": 2,
        "rocker": 4,
    }


def test_what_must_lie_over_another_does() -> None:
    assert lv.quick_levels(things(*four_bar(), over=[("rocker", "coupler")])) == {
        "crank": 1,
        "coupler": 2,
        "rocker": 3,
    }


@pytest.mark.parametrize("given", [{}, {"rocker": 2}, {"crank": 2}, {"coupler": 3}])
def test_the_integer_program_finds_what_all_orders_give(given: dict[str, int]) -> None:
    machine = things(*four_bar())
    every = lv.quick_levels(machine, given)
    assert every is not None and lv.levels(machine, THETA, given) == every


def test_spans_of_what_meets_never_share_a_level() -> None:
    bands, axes = four_bar()
    found = lv.quick_levels(things(bands, axes))
    assert found is not None
    for band in bands:
        for axis in axes:
            if (
                band.name not in axis.links
                and distance(band.corners, axis.place[None]).min() < band.radius + axis.radius
            ):
                (low, high), (at, _) = lr.span(axis, found), lr.span(band, found)
                assert at < low or at > high


@pytest.mark.parametrize("over, level", [(0, 2), (1, 3), (2, 4)])
def test_what_passes_a_cover_lies_over_it(over: int, level: int) -> None:
    """A wall takes so many levels over its link on level 1; what crosses it lies on the next one, by both searches."""
    bands = [
        lr.Band("runner", np.array([0 * STILL, 10 * STILL]), 2),
        lr.Band("other", np.array([5j * STILL, 30j * STILL]), 2),
    ]
    walls = [lr.Wall("cover", np.array([5j * STILL]), 3, "runner", "", over)]
    machine = things(bands, [], walls=walls)
    lowest = {"runner": 1, "other": level}
    assert lv.quick_levels(machine, {"runner": 1}) == lowest
    assert lv.levels(machine, THETA, {"runner": 1}) == lowest


def test_a_pin_in_the_way_is_named() -> None:
    """A link between two ground pivots that both reach higher than it may lie."""
    bands, axes = four_bar()
    post = lr.Axis("T", ("rocker",), 20 + 0j * STILL, 4, True)  # in the crank's and coupler's way
    with pytest.raises(DesignError, match="crank and T cannot pass .* and need ") as caught:
        lv.levels(things(bands, [*axes, post]), THETA, {"rocker": 3, "crank": 1, "coupler": 2})
    assert caught.value.limit > caught.value.value


def crossed() -> tuple[list[lr.Band], list[lr.Axis]]:
    """Two links on one pin of the ground, and a third right across it."""
    pin = 0j * STILL
    bands = [
        lr.Band("low", np.array([pin, pin + 30]), 5),
        lr.Band("high", np.array([pin, pin - 30]), 5),
        lr.Band("across", np.array([pin + 20j, pin - 20j]), 5),
    ]
    return bands, [lr.Axis("C", ("low", "high"), pin, 4, True, far=True)]


def test_a_pin_between_two_plates_leaves_out_where_a_link_passes() -> None:
    """A head on the lower stub, the link, a head under the upper stub."""
    bands, axes = crossed()
    found = lv.quick_levels(things(bands, axes, over=[("across", "low"), ("high", "across")]))
    assert found == {"low": 1, "across": 3, "high": 5}
    assert lv.cuts(things(bands, axes), found) == {"C": 1}
    assert lv.cuts(things(bands[:2], axes), found) == {}  # it goes through
    over = lv.quick_levels(things(bands, axes, over=[("low", "across"), ("high", "across")]))
    assert over is not None and over["across"] == 1 and min(over["low"], over["high"]) == 3
    assert lv.cuts(things(bands, axes), over) == {"C": 0}  # all hangs from the upper plate


def test_a_shaft_that_must_stand_on_the_lower_plate_is_in_the_way() -> None:
    bands, (axis,) = crossed()
    shaft = lr.Axis("C", axis.links, axis.place, 4, True, 0, far=True, low=axis.links)
    with pytest.raises(DesignError, match="across and C cannot pass"):
        lv.levels(things(bands, [shaft]), THETA, {"low": 2, "high": 3, "across": 1})
    apart = lr.Axis("C", axis.links, axis.place, 4, True, 0, far=True, low=("low",), high=("high",))
    assert lv.quick_levels(things(bands, [apart], over=[("high", "low")])) == {
        "low": 1,
        "across": 2,
        "high": 3,
    }


def beside(far: bool = True) -> tuple[list[lr.Band], list[lr.Axis]]:
    """Two links, each on a pin of the ground, which stand 3 mm apart: no plate has room for the heads of both."""
    one, other = 0j * STILL, 3 + 0j * STILL
    bands = [
        lr.Band("low", np.array([one, one - 30]), 5),
        lr.Band("high", np.array([other, other + 30]), 5),
    ]
    return bands, [
        lr.Axis("O", ("low",), one, 4, True, far=far, low=("low",) if far else ()),
        lr.Axis("C", ("high",), other, 4, True, far=far),
    ]


def test_pins_side_by_side_are_held_by_a_plate_each() -> None:
    """O, a shaft, by the lower one, so C by the upper one, its head under its link and over the other's."""
    found = lv.quick_levels(things(*beside()))
    assert found is not None and found["high"] >= found["low"] + 2  # a level for the head of C
    assert lv.cuts(things(*beside()), found) == {"O": found["low"], "C": 0}
    with pytest.raises(DesignError, match="(O and C|C and O|low and C|high and O) cannot pass"):
        lv.levels(things(*beside(far=False)), THETA)


def test_a_pin_beside_a_motors_own_shaft_hangs_from_the_upper_plate() -> None:
    """That shaft goes through the lower plate alone."""
    bands, (shaft, pin) = beside()
    axes = [lr.Axis("O", ("low",), shaft.place, 4, True), pin]
    found = lv.quick_levels(things(bands, axes))
    assert found is not None and lv.cuts(things(bands, axes), found) == {"C": 0}


def running(
    far: bool, across: complex = 1j
) -> tuple[list[lr.Band], list[lr.Axis], list[lr.Opening]]:
    """Two pins that run to and fro in slots through the origin, each there when the other is at its end."""
    one, other = 20 * np.cos(THETA) + 0j, 20 * np.sin(THETA) * across
    bands = [
        lr.Band("a", np.array([one, one + 9]), 3),
        lr.Band("b", np.array([other, other + 9 * across]), 3),
    ]
    places = {"P": ("a", one), "Q": ("b", other)}
    axes = [
        lr.Axis(f"pin {name}", (link,), at, 4, True, far=far, runs=True)
        for name, (link, at) in places.items()
    ]
    ends = [np.array([-20 * way * STILL, 20 * way * STILL]) for way in (1, across)]
    return (
        bands,
        axes,
        [lr.Opening(f"slot {k}", ends[k], 3.0, axis.name) for k, axis in enumerate(axes)],
    )


def test_slots_that_cross_are_in_a_plate_each() -> None:
    bands, axes, openings = running(True)
    found = lv.quick_levels(things(bands, axes, openings=openings))
    assert found is not None
    ends = lv.cuts(things(bands, axes, openings=openings), found)
    assert sorted(ends) == ["pin P", "pin Q"] and min(ends.values()) == 0 < max(ends.values())
    with pytest.raises(DesignError, match="slot 0 and slot 1"):
        bands, axes, openings = running(False)
        lv.levels(things(bands, axes, openings=openings), THETA)


def test_slots_on_one_line_are_one() -> None:
    """So neither is in the way of the other; their pins, at its ends a quarter of a turn apart, would meet."""
    bands, axes, openings = running(False, 1 + 0j)
    apart = [bands[0], lr.Band("b", bands[1].corners + 60, 3)]
    pins = [axes[0], lr.Axis("pin Q", ("b",), axes[1].place + 60, 4, True, runs=True)]
    joined = [openings[0], lr.Opening("slot 1", openings[1].corners + 35, 3.0, "pin Q")]
    assert lv.levels(things(apart, pins, openings=joined), THETA) == {"a": 1, "b": 1}
    aside = [openings[0], lr.Opening("slot 1", openings[1].corners + 35 + 1j, 3.0, "pin Q")]
    assert lv.quick_levels(things(apart, pins, openings=aside)) is None


def test_a_pin_in_a_slot_ends_in_one_plate() -> None:
    """Nothing is in its way: in the lower one, and it does not go through to the upper."""
    bands, axes, openings = running(True)
    alone = things(bands[:1], axes[:1], openings=openings[:1])
    found = lv.quick_levels(alone)
    assert found == {"a": 1} and lv.cuts(alone, found) == {"pin P": 1}


@pytest.mark.parametrize("find", [lv.quick_levels, lambda content: lv.levels(content, THETA)])
def test_what_is_stacked_is_laid_on_what_it_hangs_over(find: Any) -> None:
    """Crank and rocker could share a level: stacked, the rocker is the next over the crank, which lies on the plate."""
    bands, axes = four_bar()
    free = find(things(bands, axes))
    assert free["rocker"] != free["crank"] + 1
    level = find(things(bands, axes, stacked=[("rocker", "crank"), ("crank", "")]))
    assert (level["crank"], level["rocker"]) == (1, 2)


@pytest.mark.parametrize("seed", range(40))
def test_the_nearest_sample_is_found_without_looking_at_all_of_them(seed: int) -> None:
    """Two polygons that turn and wander, against the distance at every sample."""
    rng = np.random.default_rng(seed)
    theta = np.linspace(0, 2 * np.pi, 720, endpoint=False)

    def band(name: str, corners: int) -> lr.Band:
        shape = rng.normal(size=corners) + 1j * rng.normal(size=corners)
        order = hull_corners(list(shape))
        turn = np.exp(1j * rng.integers(-2, 3) * theta)
        way = 3 * rng.normal() * np.exp(1j * rng.integers(-2, 3) * (theta - rng.uniform(0, 6)))
        return lr.Band(name, 5 * shape[order][:, None] * turn + 10 * rng.normal() + way, 1.0)

    a, b = band("a", int(rng.integers(1, 7))), band("b", int(rng.integers(1, 7)))
    steps = lr.ways(a.corners) + lr.ways(b.corners)
    apart = distance(a.corners, b.corners) - steps
    k = int(np.argmin(apart))
    (rule,) = lr.Things([a, b], [], gap=100.0).rules
    assert (rule.distance, rule.k) == (max(0.0, float(apart[k])), k)
