"""A shoe on a cam: an eccentric disc under a flat sole and under a round one on an arm, by the eccentric's height and a triangle."""

from __future__ import annotations

import math

import numpy as np
import pytest

from camgen.geometry.rings import Floats, Ring
from camgen.judge.edge_contact import EdgeContact
from camgen.judge.pair_events import Slide, Turn

ASIDE, RADIUS = 7.0, 20.0  # mm: the disc's middle from the shaft, and its radius
THETA = np.linspace(-7.0, 13.0, 97)  # rad, over more than three turns


def circle(centre: complex, radius: float) -> Ring:
    return Ring(centre + radius * np.array([1, 1j, -1, -1j]), np.full(4, math.tan(math.pi / 8)))


class Lifted:
    """A follower that begins on the disc."""

    def __init__(self, s: float) -> None:
        self.s = s

    def __call__(self, theta: Floats, order: int = 0) -> Floats:
        return np.full(theta.shape, self.s if order == 0 else 0.0)


@pytest.mark.parametrize("leaves", [1, -1])
def test_a_flat_sole_is_as_high_as_the_disc_at_any_angle(leaves: int) -> None:
    sole = Ring(np.array([-60, 60, 60 + 10j, -60 + 10j]), np.zeros(4))
    slide = Slide(leaves * 1j)
    contact = EdgeContact(circle(ASIDE, RADIUS), sole, 0j, slide, leaves, Lifted(leaves * RADIUS))
    height = RADIUS + ASIDE * np.sin(THETA)
    touch = contact.touch(THETA)
    assert touch.angle == pytest.approx(leaves * height, abs=1e-9)
    assert contact.angle(THETA) == pytest.approx(leaves * height, abs=1e-9)
    assert touch.pressure_angle == pytest.approx(np.zeros(97), abs=1e-9)
    assert contact.slope(THETA) == pytest.approx(leaves * ASIDE * np.cos(THETA), abs=1e-9)
    assert (touch.element >= 0).all()


@pytest.mark.parametrize("leaves", [1, -1])
def test_a_round_sole_on_an_arm_is_where_the_triangle_says(leaves: int) -> None:
    """Its pivot 60 mm from the shaft, its middle 50 mm from the pivot and 25 mm from the disc's."""
    apart, arm, reach = 60.0, 50.0, RADIUS + 5.0
    shoe = circle(complex(-arm), 5.0)

    def law(theta: Floats) -> Floats:
        line = ASIDE * np.exp(1j * theta) - apart  # from the pivot to the disc's middle
        far = np.abs(line)
        corner = np.arccos((far**2 + arm**2 - reach**2) / (2 * far * arm))
        return np.angle(-line) + leaves * corner

    start = float(law(np.zeros(1))[0])
    contact = EdgeContact(
        circle(ASIDE, RADIUS), shoe, complex(apart), Turn(), leaves, Lifted(start)
    )
    assert contact.angle(THETA) == pytest.approx(law(THETA), abs=1e-9)
    step = 1e-5
    slope = (law(THETA + step) - law(THETA - step)) / (2 * step)
    assert contact.slope(THETA) == pytest.approx(slope, abs=1e-6)
