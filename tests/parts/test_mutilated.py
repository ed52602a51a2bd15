"""Mutilated gears as outlines: both are moved as the law says, and the least distance between them is measured."""

from __future__ import annotations

import cmath
import math
from functools import cache

import numpy as np
import pytest
import shapely

from camgen.errors import DesignError
from camgen.geometry.facets import facet_contour
from camgen.parts.wheels.mutilated import MutilatedLaw, MutilatedPair

PAIRS = (
    ((24, 24), 4, 48.0),
    ((24, 24), 3, 30.0),
    ((30, 24), 4, 54.0),
    ((40, 40), 5, 80.0),
    ((48, 36), 2, 84.0),
    ((26, 39), 3, 65.0),
)
CHORDS = 2e-4  # mm, of the polygons, each wheel's


@cache
def made(case: int) -> MutilatedPair:
    return MutilatedPair(*PAIRS[case], backlash=0.1)


@cache
def polygons(case: int) -> tuple[np.ndarray, np.ndarray]:
    pair = made(case)
    driver, wheel = (
        facet_contour(each, CHORDS) for each in (pair.driver_edge(), pair.wheel_edge())
    )
    return driver, wheel


def gaps(case: int, angles: np.ndarray, turned: float = 0.0) -> np.ndarray:
    """Least distance of both outlines, mm, with the wheel turned further, rad; 0 where they overlap."""
    pair = made(case)
    law = MutilatedLaw(pair)
    driver, wheel = polygons(case)
    found = []
    for t in angles.tolist():
        placed = (
            driver * cmath.exp(1j * t),
            wheel * cmath.exp(1j * (float(law(np.array(t))) + turned)),
        )
        shapes = [
            shapely.Polygon(np.column_stack([z.real + shift, z.imag]))
            for z, shift in zip(placed, (0, pair.distance), strict=True)
        ]
        found.append(shapes[0].distance(shapes[1]))
    return np.array(found)


@pytest.mark.long
@pytest.mark.parametrize("case", range(len(PAIRS)))
def test_the_air_is_the_same_over_a_whole_turn(case: int) -> None:
    """Whoever pushes or holds: corner, flank, round tip or rim, half of the backlash times cos 20 deg is left, and never less."""
    pair = made(case)
    air = 0.05 * math.cos(math.radians(20))
    drive = np.linspace(math.pi - pair.half, math.pi + pair.half, 90)
    angles = np.concatenate([drive, np.linspace(-math.pi + pair.half, math.pi - pair.half, 31)])
    found = gaps(case, angles)
    assert found.min() > air - 2 * CHORDS
    pushed = found[: len(drive)]
    assert pushed.max() < air + 4 * CHORDS


@pytest.mark.parametrize("case", range(len(PAIRS)))
def test_while_it_stands_the_rim_lets_it_turn_neither_way(case: int) -> None:
    pair = made(case)
    angles = np.linspace(*pair.held[0], 9)
    for way in (1, -1):
        assert (gaps(case, angles, way * math.radians(2)) == 0).all()


def test_law_goes_on_by_a_station_a_turn_and_its_derivatives_are_its_own() -> None:
    for case in range(len(PAIRS)):
        pair = made(case)
        law = MutilatedLaw(pair)
        assert float(law(np.array(math.tau)) - law(np.array(0.0))) == pytest.approx(
            -pair.pitch, abs=1e-12
        )
        begin, end = (math.pi + side * pair.half for side in (-1, 1))
        t = np.linspace(begin, end, 400)[3:-3]
        step = 1e-5
        for order in (1, 2, 3):
            slope = (law(t + step, order - 1) - law(t - step, order - 1)) / (2 * step)
            off = np.abs(slope - law(t, order)) / (1 + np.abs(slope))
            assert (
                np.quantile(off, 0.97) < 1e-5
            )  # but beside the two places at which a law takes over
        assert (np.diff(law(t)) < 0).all()


def test_clockwise_it_is_the_mirrored_law() -> None:
    pair = made(0)
    t = np.linspace(0, 12, 500)
    plain, other = MutilatedLaw(pair), MutilatedLaw(pair, -1)
    for order in range(4):
        sign = -((-1.0) ** order)
        assert np.allclose(other(-t, order), sign * plain(t, order), atol=1e-12)
    for (a, b), (c, d) in zip(plain.held, other.held, strict=True):
        assert (a, b) == (-d, -c)


def test_while_flanks_mesh_the_wheel_turns_by_the_ratio_of_the_teeth() -> None:
    for case, (teeth, _, _) in enumerate(PAIRS):
        law = MutilatedLaw(made(case))
        begin, end = made(case).held[1]
        assert np.allclose(law(np.linspace(begin, end, 50), 1), -teeth[0] / teeth[1], atol=1e-12)


@pytest.mark.parametrize(
    ("teeth", "stations", "words"),
    [
        ((24, 24), 5, "give the wheel 25 teeth"),
        ((12, 12), 2, "use more teeth"),
        ((24, 24), 12, "use fewer stations"),
        ((18, 60), 1, "no room for the rim"),
    ],
)
def test_refusals_say_what_to_change(teeth: tuple[int, int], stations: int, words: str) -> None:
    with pytest.raises(DesignError, match=words):
        MutilatedPair(teeth, stations, 60.0, 0.1)
