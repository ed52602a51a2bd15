"""Targets measured on courses whose answers are known in closed form."""

from __future__ import annotations

import math

import numpy as np
import pytest

from camgen.findings import Where
from camgen.machine import targets
from camgen.machine.targets import (
    Course,
    Dwell,
    Lines,
    Straight,
    Stroke,
    Through,
    TimeRatio,
    Trace,
)
from camgen.numerics import Floats

THETA = np.linspace(0, math.tau, 1441)
PART = np.radians(np.linspace(-30, 50, 321))


def wave(theta: np.ndarray = THETA, whole: bool = True) -> Course:
    return Course(theta, 20 * np.cos(theta), -20 * np.sin(theta), "mm", whole)


def ellipse() -> Course:
    """Half-axes 20 and 5, off the round angles."""
    return Course(
        THETA,
        20 * np.cos(THETA) + 5j * np.sin(THETA),
        -20 * np.sin(THETA) + 5j * np.cos(THETA),
        "mm",
        True,
    )


def test_between_samples_the_course_is_right() -> None:
    theta = np.random.default_rng(3).uniform(-7, 20, 400)
    assert np.max(np.abs(wave().at(theta) - 20 * np.cos(theta))) < 1e-9
    turning = Course(THETA, THETA + np.sin(THETA), 1 + np.cos(THETA), "deg", True)
    assert np.max(np.abs(turning.at(theta) - theta - np.sin(theta))) < 1e-9


def test_stroke() -> None:
    assert targets.stroke(wave()) == pytest.approx(40, abs=1e-9)
    assert targets.stroke(wave(PART, False)) == pytest.approx(
        20 - 20 * math.cos(math.radians(50)), abs=1e-9
    )
    assert targets.stroke(ellipse()) == pytest.approx(40, abs=1e-9)
    assert Stroke(value=40.1, tolerance=0.2).finding(wave(), Where()).ok
    assert not Stroke(value=40.1, tolerance=0.05).finding(wave(), Where()).ok


@pytest.mark.parametrize("band", [0.5, 3.0, 12.0])
def test_a_sine_dwells_longest_where_it_turns_back(band: float) -> None:
    span = math.degrees(2 * math.acos(1 - band / 20))
    assert math.degrees(targets.dwell(wave(), band)[0]) == pytest.approx(span, abs=0.07)
    half = math.degrees(
        2 * math.acos(1 - band / 40)
    )  # of the band about 20 only its lower half is reached
    assert math.degrees(targets.dwell(wave(), band, 20)[0]) == pytest.approx(half, abs=0.07)
    assert Dwell(span_deg=span - 0.1, band=band).finding(wave(), Where()).ok
    assert not Dwell(span_deg=span + 0.1, band=band).finding(wave(), Where()).ok
    assert not Dwell(span_deg=1, band=band, at=60.0).finding(wave(), Where()).ok


def test_time_ratio_of_two_harmonic_strokes() -> None:
    """Out over 200 deg, back over 160 deg."""
    out = math.radians(200)
    u = np.where(out > THETA, THETA / out, 1 + (THETA - out) / (math.tau - out))
    rate = np.where(out > THETA, math.pi / out, math.pi / (math.tau - out))
    course = Course(THETA, -np.cos(math.pi * u), rate * np.sin(math.pi * u), "mm", True)
    assert targets.time_ratio(course)[0] == pytest.approx(200 / 160, abs=1e-5)
    assert TimeRatio(value=1.25, tolerance=1e-3).finding(course, Where()).ok
    assert not TimeRatio(value=1.26, tolerance=1e-3).finding(course, Where()).ok


@pytest.mark.parametrize("value", [np.degrees(THETA), np.zeros(len(THETA))])
def test_what_turns_on_or_stands_still_has_no_time_ratio(value: Floats) -> None:
    course = Course(THETA, value, np.gradient(value, THETA), "deg", True)
    found = TimeRatio(value=1.25, tolerance=1e-3).finding(course, Where("swing"))
    assert not found.ok and "no two strokes" in found.message


def test_places_of_a_path() -> None:
    path = ellipse()
    error = Through(at=((25.0, 0.0), (0.0, -8.0)), tolerance=4.0).finding(path, Where())
    assert error.measured == pytest.approx(5, abs=1e-9) and not error.ok
    assert "point 1 (25, 0) is missed most" in error.message
    t = math.radians(33)
    there = 20 * math.cos(t), 5 * math.sin(t)
    assert Through(at=(there,), tolerance=1e-6, theta_deg=(33.0,)).finding(path, Where()).ok
    late = Through(at=(there,), tolerance=1e-6, theta_deg=(34.0,)).finding(path, Where())
    speed = abs(complex(-20 * math.sin(t), 5 * math.cos(t)))
    assert late.measured == pytest.approx(speed * math.radians(1), rel=0.02)


def test_order_of_places() -> None:
    around = ((20.0, 0.0), (0.0, 5.0), (-20.0, 0.0), (0.0, -5.0))
    asked = {"tolerance": 1e-6, "in_order": True}
    assert Through(at=around, **asked).finding(ellipse(), Where()).ok
    assert Through(at=(*around[2:], *around[:2]), **asked).finding(ellipse(), Where()).ok
    swapped = (around[0], around[2], around[1], around[3])
    assert Through(at=swapped, tolerance=1e-6).finding(ellipse(), Where()).ok
    assert not Through(at=swapped, **asked).finding(ellipse(), Where()).ok


def test_a_path_as_a_whole_lies_nowhere_further_from_the_wanted_one() -> None:
    """A square about the ellipse's circle: its corners are the farthest, and are no places of a grid along its sides."""
    circle = Course(THETA, 20 * np.exp(1j * THETA), 20j * np.exp(1j * THETA), "mm", True)
    square = ((20.0, 20.0), (-20.0, 20.0), (-20.0, -20.0), (20.0, -20.0), (20.0, 20.0))
    far = 20 * (math.sqrt(2) - 1)
    found = Trace(at=square, tolerance=8.0).finding(circle, Where())
    assert found.code == "PATH_ERROR" and not found.ok and far <= found.measured < far + 0.02
    assert "of the wanted one" in found.message
    assert Trace(at=square, tolerance=8.31).finding(circle, Where()).ok
    inside = tuple(
        (x * 0.5**0.5, y * 0.5**0.5) for x, y in square
    )  # now the path strays, between the corners
    found = Trace(at=inside, tolerance=5.0).finding(circle, Where())
    bulge = 20 * (1 - math.sqrt(0.5))
    assert (
        not found.ok and bulge <= found.measured < bulge + 0.02 and "of the path" in found.message
    )


@pytest.mark.long
@pytest.mark.parametrize("tolerance", [1e-9, 1e-4, 0.03, 3.0])
def test_a_path_is_near_itself_to_what_its_chords_lose(tolerance: float) -> None:
    corners = tuple((float(z.real), float(z.imag)) for z in ellipse().value)
    found = Trace(at=corners, tolerance=tolerance).finding(ellipse(), Where())
    sag = 20 * (THETA[1] / 2) ** 2 / 2  # of the sharpest chord's height, at most
    assert found.measured <= sag + max(2e-3 * tolerance, 4e-4)


def test_a_cloud_has_no_order_and_no_lines() -> None:
    places = [(20 * math.cos(t), 5 * math.sin(t)) for t in np.linspace(0, 6.2, 90)]
    shuffled = tuple(places[37 * k % 90] for k in range(90))
    assert Trace(at=shuffled, joined=False, tolerance=0.9).finding(ellipse(), Where()).ok
    assert not Trace(at=shuffled, tolerance=0.9).finding(ellipse(), Where()).ok
    away = Trace(at=(*shuffled, (0.0, 8.0)), joined=False, tolerance=0.9).finding(
        ellipse(), Where()
    )
    assert (
        away.measured == pytest.approx(3, abs=2e-3) and "(0, 8) of the wanted one" in away.message
    )


def test_sides_of_a_path_do_not_change_with_its_turn() -> None:
    for turn in (0.0, 0.3, math.pi / 4, math.pi / 2):
        length, width = targets.rectangle(ellipse().value * np.exp(1j * turn))
        assert (length, width) == (pytest.approx(40, rel=1e-4), pytest.approx(10, rel=1e-4))
        rounding = np.random.default_rng(1).normal(size=99) * 1e-14
        line = (np.linspace(0, 40, 99) + 1j * rounding) * np.exp(1j * turn)
        assert targets.rectangle(line) == (pytest.approx(40, rel=1e-9), pytest.approx(0, abs=1e-6))


def test_straightness_of_an_arc_is_its_height() -> None:
    circle = Course(THETA, 30 * np.exp(1j * THETA), 30j * np.exp(1j * THETA), "mm", True)
    height = 30 * (1 - math.cos(math.radians(20)))
    assert Straight(tolerance=1.0, range_deg=(100.0, 140.0)).finding(
        circle, Where()
    ).measured == pytest.approx(height, rel=1e-4)
    chord = 2 * 30 * math.sin(math.radians(20))
    assert targets.straightest(circle, chord)[0] == pytest.approx(height, rel=0.03)
    assert math.isnan(targets.straightest(circle, 61.0)[0])
    assert not Straight(tolerance=1.0, length=61.0).finding(circle, Where()).ok


@pytest.mark.parametrize("turned", [0.0, 30.0, 89.0, 91.0, 200.0])
def test_the_extent_of_a_path_is_its_longest_chord(turned: float) -> None:
    """Of a right triangle of 3, 4 and 5 its longest side, which leans by atan(3 / 4); turned with it, to half a turn."""
    triangle = np.array([0, 4, 4 + 3j]) * np.exp(1j * math.radians(turned))
    size, along = targets.extent(triangle)
    wanted = (turned + math.degrees(math.atan2(3, 4)) + 90) % 180 - 90
    assert (size, math.degrees(along)) == pytest.approx((5, wanted))
    assert targets.extent(np.array([1 + 1j, 1 + 1j])) == (0, 0)


def test_a_strip_lies_as_it_must() -> None:
    box = np.array([0, 10, 10 + 2j, 2j, 5 + 1j]) * np.exp(0.3j)
    assert targets.strip(box) == pytest.approx(2, abs=1e-12)
    assert targets.strip(np.array([0, 3 + 4j, 6 + 8j])) == 0


def lifted(begin: float, end: float, low: float = 0.0) -> Course:
    """A lift that is 0 until `begin`, deg, 1 up to `end`, and 0 again; it takes a degree to go up or down."""
    theta = np.degrees(THETA)
    value = np.clip(theta - begin, 0, 1) - np.clip(theta - end, 0, 1)
    return Course(THETA, low + (1 - low) * value, np.zeros_like(THETA), "mm", True)


Corners = tuple[tuple[float, float], ...]
UPPER = tuple((20 * math.cos(t), 5 * math.sin(t)) for t in np.linspace(0, math.pi, 400))


def lines(*at: Corners) -> Lines:
    return Lines(at=at, lift="lift", down=0.1, up=0.9, tolerance=0.1)


def test_lines_count_only_while_the_pen_is_down() -> None:
    """The upper half of an ellipse is drawn, the lower one is not; half a degree more of it is 0.05 mm."""
    wanted = lines(UPPER)
    found = wanted.finding(ellipse(), Where(), lifted(180, 359))
    assert found.ok
    assert found.measured == pytest.approx(5 * math.sin(math.radians(0.9)), abs=0.01)


@pytest.mark.long
@pytest.mark.parametrize("begin, end", [(184, 359), (180, 350), (10, 359)])
def test_a_lift_at_the_wrong_time_is_seen(begin: float, end: float) -> None:
    """Too late, let down too early, lifted over most of the line: by so much the ends are apart."""
    found = lines(UPPER).finding(ellipse(), Where(), lifted(begin, end))
    touches = [math.radians(each) for each in (begin + 0.9, end + 0.1)]
    at = [complex(20 * math.cos(t), 5 * math.sin(t)) for t in touches]
    late = max(abs(at[0] + 20) if begin > 180 else 0.0, abs(at[1] - 20) if end < 359 else 0.0)
    surely = math.radians(begin + 0.1)
    missed = abs(complex(20 * math.cos(surely), 5 * math.sin(surely)) + 20) if begin < 180 else 0.0
    assert not found.ok
    assert found.measured == pytest.approx(max(late, missed), abs=0.02)


def test_a_pen_that_is_never_down_or_never_up() -> None:
    wanted = lines(UPPER)
    never = wanted.finding(ellipse(), Where(), lifted(180, 359, low=0.5))
    assert not never.ok and "never down" in never.message
    always = wanted.finding(ellipse(), Where(), lifted(359, 359.1))
    assert always.measured == pytest.approx(10, abs=0.01) and not always.ok  # (0, -5) to (0, 5)


def test_each_of_several_lines_has_to_be_drawn() -> None:
    """One more, 3 mm beside the path and 8 mm long."""
    beside = ((-4.0, 8.0), (4.0, 8.0))
    found = lines(UPPER, beside).finding(ellipse(), Where(), lifted(180, 359))
    assert found.measured == pytest.approx(8 - 5 * math.sqrt(1 - 0.04), abs=0.02)
    assert "beyond where lift has let it down" in found.message


def test_pieces_that_are_drawn() -> None:
    """Each from a clear sample to the next clear one: up from 181 deg, down from 359 deg on."""
    course = ellipse()
    wanted = lines(UPPER)
    lift = np.asarray(lifted(180, 359).value)
    ways = wanted.drawn(course.value, lift)
    assert [len(way) for way in ways] == [4 * 181 + 1, 5]
    assert [way[0] for way in ways] == [course.value[0], course.value[4 * 359]]
