"""Edges of any shape that drive a body: the air on the side from which it is moved, against the triangle of two round pins."""

from __future__ import annotations

import math

import numpy as np
import pytest

from camgen.geometry.rings import Floats, Ring
from camgen.judge.edges import Engagement
from camgen.machine.features import Edge, EngagedPair, Eye

APART, ARM, FREE = 30.0, 20.0, 0.2  # mm: axis to axis, axis to the driven pin, air


def circle(centre: complex, radius: float) -> Ring:
    return Ring(centre + radius * np.array([1, 1j, -1, -1j]), np.full(4, math.tan(math.pi / 8)))


def angle(distance: float) -> float:
    """Of the driven arm off the line of both axes, rad, where the pins' middles are so far apart, mm."""
    return math.acos((APART**2 + ARM**2 - distance**2) / (2 * APART * ARM))


class Standing:
    """A follower that stands, about to be moved on."""

    def __init__(self, place: float) -> None:
        self.place = place

    def __call__(self, theta: Floats, order: int = 0) -> Floats:
        return np.full(theta.shape, (self.place, 1.0)[order])


@pytest.mark.parametrize("air", [FREE, 0.9 * FREE])
def test_air_beside_a_dead_point_is_told_where_the_follower_is_wanted(air: float) -> None:
    """Two pins touch 0.33 deg off the line of their axes: the lever there is a fourteenth of that at the air that is meant."""
    near = 10.001  # mm, radii of both pins
    driver = Edge("driver", Eye("driver", 0j, 4.0))
    driven = Edge("driven", Eye("driven", 0j, 4.0))
    pair = EngagedPair("x", (driver,), (driven,), "a", "b", FREE, (), 0.1, pushed=((0.0, 0.1),))
    wanted = Standing(angle(near + air))
    rings = (circle(0j, 5.001),), (circle(complex(-ARM), 5.0),)
    gap = Engagement(pair, *rings, complex(APART), wanted).worst_gap
    assert gap.gap == pytest.approx(2 * air, rel=0.02) and gap.meant == 2 * FREE
    assert (gap.driver, gap.driven) == ("driver", "driven")
