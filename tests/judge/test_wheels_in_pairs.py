"""Wheels as they are made, through the judge's contact engine: play, evenness and motion of their own outlines as arcs."""

from __future__ import annotations

import math

import numpy as np
import pytest

from camgen.geometry.arcs import bulges, fit_arcs
from camgen.geometry.outlines import Contour
from camgen.geometry.rings import Floats, Points, Ring
from camgen.judge.pairs import Body, OutlinePair, hollow, pivots_apart
from camgen.parts.wheels.cycloid import CycloidDisc
from camgen.parts.wheels.geneva import Geneva
from camgen.parts.wheels.involute import BasicRack
from camgen.parts.wheels.involute import Ring as InnerWheel
from camgen.parts.wheels.mesh import Sizes

FIT = 2e-4  # mm, of the arcs
RACK = BasicRack(2.0)


def _ring(contour: Contour) -> Ring:
    return Ring(*bulges(fit_arcs(contour, FIT)))


@pytest.mark.parametrize(
    ("teeth", "side", "shifts", "relief"),
    [
        ((12, 30), 1, (0.4, 0.2), 0.0),
        ((20, 41), 1, (0.1, 0.3), 0.02),
        ((20, 60), -1, (0.0, 0.0), 0.0),
        ((12, 30), -1, (0.4, 0.4), 0.0),
    ],
)
def test_wheels_run_evenly_with_the_play_of_the_formula(
    teeth: tuple[int, int], side: int, shifts: tuple[float, float], relief: float
) -> None:
    """Over two teeth the driven wheel keeps to the ratio within both fits of arcs; relieved tips leave that as it is."""
    mesh = Sizes(RACK, *teeth, side, 0.08).mesh(*shifts)
    mesh = mesh.relieved(relief) if relief else mesh
    inner = isinstance(mesh.b, InnerWheel)
    driven = _ring(mesh.b.outline())
    pair = OutlinePair(
        Body([_ring(mesh.a.outline())]),
        Body([hollow(driven) if inner else driven]),
        pivots_apart(-mesh.distance if inner else mesh.distance),
    )
    theta = np.linspace(0.0, 2 * mesh.a.pitch, 241)
    samples = pair.follow(theta, 0.0 if inner else math.pi + mesh.b.pitch / 2).samples
    assert samples.free.all()
    # across both flanks; along them it is more by the cosine of the pressure angle, and a hair where a tip hands over
    allowed = 2.5 * FIT / mesh.b.base
    for bound in (samples.low, samples.high):
        assert np.ptp(bound - mesh.ratio * theta) < allowed
    assert np.abs(samples.play - mesh.backlash()).max() < 2 * allowed


# Stations and least play in the dwell, rad, of an independent prototype: distance 60, pin 3, lock 3.65 less than the crank.
@pytest.mark.parametrize(("stations", "play"), [(3, 3.34e-3), (4, 2.36e-3), (6, 1.93e-3)])
def test_a_geneva_wheel_follows_its_pin_and_stands_on_its_lock(stations: int, play: float) -> None:
    """Pin and lock at two heights: while it drives the middle of the play is the closed form, else the wheel stands."""
    geneva = Geneva(stations, 60.0, 3.0, 0.55)
    pin = Ring(geneva.crank + 3.0 * np.array([1, 1j, -1, -1j]), np.full(4, math.tan(math.pi / 8)))
    pair = OutlinePair(
        Body([pin, _ring(geneva.lock_disc())], [(0.0, 1.0), (1.0, 2.0)]),
        Body([_ring(geneva.wheel())], [(0.0, 2.0)]),
        pivots_apart(60.0),
    )
    theta = np.linspace(-0.8 * geneva.half, math.tau - 1.2 * geneva.half, 721)
    start = math.pi + float(geneva.motion(theta[0]))
    samples = pair.follow(theta, start).samples
    assert samples.free.all()
    middle = (samples.low + samples.high) / 2 - math.pi
    drives = np.abs(theta) < 0.8 * geneva.half
    assert np.abs(middle - geneva.motion(theta))[drives].max() < 1e-4
    rests = (theta > 1.3 * geneva.half) & (theta < math.tau - 1.3 * geneva.half)
    stand = math.pi - geneva.pitch / 2
    assert (samples.low[rests] < stand).all() and (stand < samples.high[rests]).all()
    assert samples.play[rests].max() < 0.01
    assert samples.play[rests].min() == pytest.approx(play, rel=0.01)


def test_a_cycloidal_disc_turns_back_by_a_lobe_within_its_levers_play() -> None:
    """On its eccentric inside of eleven pins; play between both bounds that the pins' levers give to first order."""
    disc = CycloidDisc(11, 40.0, 3.0, 1.5, 0.02)
    quarters = 3.0 * np.array([1, 1j, -1, -1j])
    pins = [Ring(z + quarters, np.full(4, math.tan(math.pi / 8))) for z in disc.pin_places()]

    def pose(theta: Floats, order: int) -> tuple[Points, Floats]:
        """The pins, which stand still, as seen from the eccentric's middle."""
        return -1.5 * 1j**order * np.exp(1j * theta), np.zeros(theta.shape)

    pair = OutlinePair(Body(pins), Body([_ring(disc.outline())]), pose)
    theta = np.linspace(0.0, math.tau / 5, 241)
    samples = pair.follow(theta).samples
    assert samples.free.all()
    middle = (samples.low + samples.high) / 2
    assert np.abs(middle - disc.ratio * theta).max() < 1e-4
    assert samples.play.min() == pytest.approx(disc.play[0], rel=0.01)
    assert samples.play.max() < 2.76476e-3 * 1.02
