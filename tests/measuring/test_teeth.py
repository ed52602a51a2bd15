"""Teeth compared with each other: a tip that is thin, borne by its neighbours; outlines that have no teeth."""

from __future__ import annotations

import cmath
import math
import sys
from pathlib import Path

import numpy as np
import pytest

from camgen.geometry.rings import Ring
from camgen.measuring.drives import Drive, driven_by
from camgen.measuring.teeth import unlike_tooth

sys.path.insert(0, str(Path(__file__).parents[1] / "judge"))
from pair_outlines import Wheel, inner_ring  # noqa: E402

PINION, WHEEL = Wheel(1.5, 20), Wheel(1.5, 40)


def thin(ring: Ring, off: float) -> Ring:
    """The outline with the tip of tooth 7 of forty thinner on one flank, mm."""
    angle = np.angle(ring.points * cmath.exp(-1j * math.tau * 7 / 40))
    tip = (np.abs(ring.points) > WHEEL.ra - 0.6) & (angle > 0) & (angle < math.pi / 40)
    return Ring(ring.points * np.exp(-1j * off * tip / np.abs(ring.points)), ring.bulges)


@pytest.mark.long
@pytest.mark.parametrize("ring", [WHEEL.ring(), WHEEL.ring(24, arcs=False)])
def test_a_thin_tip_that_moves_nothing_is_named(ring: Ring) -> None:
    """By 15 um along the circle, less the flank's lean: the pair turns as evenly as before."""
    drive = Drive(45.0, ratio=-0.5)
    sound, damaged = (
        driven_by(PINION.ring(), each, drive).transmission_error * WHEEL.rb
        for each in (ring, thin(ring, 0.015))
    )
    assert abs(damaged - sound) < 0.003
    tooth = unlike_tooth(thin(ring, 0.015))
    assert tooth is not None and tooth.count == 40
    assert tooth.off == pytest.approx(0.015 * math.cos(math.radians(25)), rel=0.05)
    assert tooth.direction == pytest.approx(math.tau * 7 / 40, abs=math.pi / 40)


def test_sound_teeth_are_alike_outside_and_inside() -> None:
    for ring in (WHEEL.ring().moved(cmath.exp(0.3j)), inner_ring(Wheel(2, 30, 0.4), 29.0081, 33.3)):
        tooth = unlike_tooth(ring)
        assert tooth is not None and tooth.off < 1e-9


def test_what_has_no_teeth_is_not_compared() -> None:
    t = np.linspace(0, math.tau, 300, endpoint=False)
    cam = (20 + 3 * np.cos(t) + np.cos(2 * t)) * np.exp(1j * t)
    for points in (20 * np.exp(1j * t), cam, 20 * np.array([1, 1j, -1, -1j])):
        assert unlike_tooth(Ring(points, np.zeros(len(points)))) is None
