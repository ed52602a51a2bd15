"""Wheels that are not round: their centrodes against a prototype's, their edges through the contact engine, round ones as any."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path
from typing import Literal

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgen.errors import DesignError
from camgen.geometry.arcs import bulges
from camgen.geometry.facets import facet_contour
from camgen.geometry.outlines import Contour
from camgen.geometry.rings import Floats, Ring
from camgen.judge.pairs import Body, OutlinePair, pivots_apart
from camgen.parts.wheels.involute import BasicRack, Wheel
from camgen.parts.wheels.noncircular import (
    TOLERANCE,
    Centrodes,
    NoncircularPair,
    WaveLaw,
    ellipses,
)

KNOWN = tomllib.loads(
    (Path(__file__).parents[1] / "reference" / "noncircular.toml").read_text("utf-8")
)
TURN = np.linspace(0, math.tau, 721)


def _double(k: float) -> WaveLaw:
    return WaveLaw(1.0, (), (0.0, -k))


def _engaged(pair: NoncircularPair) -> OutlinePair:
    bodies = (Body([Ring(*bulges(edge))]) for edge in (pair.driver, pair.driven))
    return OutlinePair(*bodies, pivots_apart(pair.centrodes.distance))


def _play(pair: NoncircularPair, t: Floats) -> tuple[Floats, Floats]:
    """How far the driven wheel goes to either side: a flank's normal passes its axis at r2 cos(20 deg + or - the lean)."""
    centrodes = pair.centrodes
    arm = centrodes.distance - np.abs(centrodes.driver(t))
    lean = centrodes.lean(t)
    air = pair.backlash / 2 * math.cos(pair.pressure)
    return air / (arm * np.cos(pair.pressure + lean)), air / (arm * np.cos(pair.pressure - lean))


# ---- centrodes ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("k", "length", "lean"), KNOWN["double"]["rows"])
def test_centrodes_are_as_long_and_lean_as_the_prototype_says(
    k: float, length: float, lean: float
) -> None:
    centrodes = Centrodes(_double(k), KNOWN["double"]["distance"])
    assert abs(centrodes.length - length) < 1e-5
    assert abs(math.degrees(np.max(np.abs(centrodes.lean(TURN)))) - lean) < 0.006
    ends = centrodes.driven(np.array([0.0, math.tau]))
    assert abs(ends[1] - ends[0]) < 1e-12
    chords = np.abs(np.diff(centrodes.driven(np.linspace(0, math.tau, 20001)))).sum()
    assert abs(chords - length) < 2e-5  # so is the driven wheel's, by chords


def test_the_sharpest_place_of_a_centrode_is_the_prototypes() -> None:
    bend = Centrodes(_double(0.1), KNOWN["double"]["distance"]).curvature("driver", TURN)
    assert abs(1 / bend.max() - KNOWN["double"]["sharpest"]) < 6e-4


@pytest.mark.parametrize("e", [0.2, 0.5, 0.8])
def test_equal_ellipses_about_their_foci_are_the_centrodes(e: float) -> None:
    """Distances from both foci add up to the major axis, for either wheel, and the angles are Kepler's."""
    law = ellipses(e)
    centrodes = Centrodes(law, 60.0)
    for curve, focus in ((centrodes.driver, 60 * e), (centrodes.driven, 60 * e)):
        z = curve(TURN)
        assert np.allclose(np.abs(z) + np.abs(z - focus), 60.0, atol=1e-9)
    t = np.linspace(-3, 3, 61)
    expected = 2 * np.arctan((1 + e) / (1 - e) * np.tan(t / 2))
    assert np.allclose(law(t), expected, atol=1e-12)


def test_a_law_of_a_slope_has_its_values_and_derivatives() -> None:
    law = WaveLaw.of_slope(lambda t: 1 / (2 + np.cos(t)))
    assert math.isclose(law.mean, 1 / math.sqrt(3))
    assert np.allclose(law(TURN, 1), 1 / (2 + np.cos(TURN)), atol=1e-14)
    assert np.allclose(law(TURN, 2), np.sin(TURN) / (2 + np.cos(TURN)) ** 2, atol=1e-12)
    assert abs(float(law(0.0))) < 1e-15


# ---- edges ----------------------------------------------------------------------------------------------------------


def test_round_centrodes_give_the_wheel_of_the_same_rack() -> None:
    """Each point of one edge lies on the other, within the arcs of one and the chords of the other."""
    pair = NoncircularPair(Centrodes(WaveLaw(1.0), 60.0), 24, 0.04)
    wheel = Wheel(24, BasicRack(2.5), thinner=0.02)
    points = facet_contour(pair.driver, 1e-4)
    shape = _polygon(wheel.outline())
    import shapely

    off = shapely.distance(shape.exterior, shapely.points(points.real, points.imag))
    assert off.max() < 2.1 * TOLERANCE
    assert abs(pair.driver.area - wheel.outline().area) < TOLERANCE * wheel.outline().length / 2


def _polygon(contour: Contour) -> object:
    import shapely

    points = facet_contour(contour, 1e-4)
    return shapely.Polygon(np.c_[points.real, points.imag])


PAIRS = {
    "ncgears": NoncircularPair(Centrodes(_double(0.08), 36.0), 24, 0.04),
    "ellipses": NoncircularPair(Centrodes(ellipses(0.3), 60.0), 25, 0.1),
    "two turns": NoncircularPair(Centrodes(WaveLaw(0.5, (0.05,), (0.03,)), 60.0), 24, 0.1),
    "half a turn": NoncircularPair(Centrodes(WaveLaw(2.0, (), (0.0, 0.1)), 60.0), 46, 0.1),
}


@pytest.mark.long
@pytest.mark.parametrize("name", PAIRS)
def test_teeth_drive_by_the_law_with_the_play_of_the_closed_form(name: str) -> None:
    """At all angles free, proven in between, both bounds off the law by the play and the arcs of both edges."""
    pair = PAIRS[name]
    law = pair.centrodes.law
    turns = max(1, round(1 / law.mean))
    t = np.linspace(0, math.tau * turns, 361 * turns)
    samples = _engaged(pair).follow(t, 0.0).samples
    assert samples.free.all()
    assert samples.proven[1:].all()
    low, high = _play(pair, t)
    arm = (pair.centrodes.distance - np.abs(pair.centrodes.driver(t))) * math.cos(math.radians(45))
    arcs = 2 * TOLERANCE / arm
    assert np.all(np.abs(samples.low + law(t) + low) < arcs)
    assert np.all(np.abs(samples.high + law(t) - high) < arcs)


def test_module_and_play_are_those_that_ncgears_states_of_its_pair() -> None:
    """Its play is that of the offset at the least and greatest radius, where nothing leans."""
    known = KNOWN["ncgears"]
    backlash = 4 * known["clearance"] / math.cos(math.radians(20))
    pair = NoncircularPair(Centrodes(_double(0.08), known["distance"]), 24, backlash)
    assert math.isclose(pair.module, known["module"], rel_tol=1e-12)
    play = np.degrees(sum(_play(pair, TURN)))
    assert np.allclose([play.min(), play.max()], known["play_deg"], atol=1e-9)


@pytest.mark.long
def test_equal_ellipses_with_an_odd_number_of_teeth_are_one_part() -> None:
    """The driven wheel is the driver turned by half a turn and mirrored."""
    pair = PAIRS["ellipses"]
    image = pair.driver.moved(mirror=True)
    assert math.isclose(image.area, pair.driven.area, rel_tol=1e-9)
    assert abs(image.centroid - pair.driven.centroid) < 1e-6


@pytest.mark.long
@settings(max_examples=8, deadline=None)
@given(
    st.tuples(*[st.floats(-0.03, 0.03)] * 4),
    st.sampled_from([(1.0, 31), (0.5, 30), (1 / 3, 30)]),
)
def test_any_gentle_law_is_followed(waves: tuple[float, ...], size: tuple[float, int]) -> None:
    mean, teeth = size
    scaled = tuple(mean * wave for wave in waves)
    law = WaveLaw(mean, scaled[:2], scaled[2:])
    pair = NoncircularPair(Centrodes(law, 60.0), teeth, 0.1)
    t = np.linspace(0, math.tau, 73)
    engaged = _engaged(pair)
    for angle in t[::12].tolist():
        wanted = float(-law(angle))
        assert not engaged.overlaps(angle, wanted)
        low, high = (float(each) for each in _play(pair, np.array(angle)))
        assert engaged.overlaps(angle, wanted + 1.5 * high)
        assert engaged.overlaps(angle, wanted - 1.5 * low)


# ---- what cannot be -------------------------------------------------------------------------------------------------


def test_a_law_that_turns_back_is_refused_with_the_angle() -> None:
    with pytest.raises(DesignError, match=r"turns back \(driver at 0\.0 deg: -0\.2 times"):
        Centrodes(_double(0.6), 60.0)


def test_a_hollow_centrode_is_refused_whatever_the_teeth() -> None:
    for teeth in (24, 240):
        with pytest.raises(DesignError, match="centrode of the driver is hollow"):
            NoncircularPair(Centrodes(_double(0.2), 60.0), teeth)


@pytest.mark.parametrize("e", [0.1, 0.4, 0.6])
def test_too_few_teeth_are_refused_with_the_least_that_do(e: float) -> None:
    """The least is that of the rounding's undercut at b^2 / a, the sharpest bend of an ellipse."""
    centrodes = Centrodes(ellipses(e), 60.0)
    with pytest.raises(DesignError, match=r"use teeth = (\d+) or more") as caught:
        NoncircularPair(centrodes, 12)
    rack = BasicRack(1.0)
    bend = 30 * (1 - e * e)
    least = 2 * rack.least_shift(0) / math.sin(rack.pressure) ** 2
    teeth = math.ceil(least * centrodes.length / math.pi / (2 * bend))
    assert f"use teeth = {teeth} or more" in caught.value.remedy
    NoncircularPair(centrodes, teeth)
    with pytest.raises(DesignError):
        NoncircularPair(centrodes, teeth - 1)


@pytest.mark.parametrize(
    ("law", "said"),
    [
        (WaveLaw(2.0, (), (0.05,)), "does not close"),
        (WaveLaw(2 / 3, (), (0.05,)), "does not close"),
        (WaveLaw(2 / 3, (), (0.0, 0.02)), "would have 37.5 teeth"),
    ],
)
def test_a_driven_wheel_that_does_not_close_is_refused(law: WaveLaw, said: str) -> None:
    with pytest.raises(DesignError, match=said):
        NoncircularPair(Centrodes(law, 60.0), 25)


@pytest.mark.parametrize("wheel", ["driver", "driven"])
def test_reach_of_an_ellipse_is_that_of_its_ends(wheel: Literal["driver", "driven"]) -> None:
    assert np.allclose(PAIRS["ellipses"].reach(wheel), (30 * 0.7, 30 * 1.3), atol=1e-5)
