"""Edges of any shape that drive a body: the air on the side from which it is moved, against the triangle of two round pins."""

from __future__ import annotations

import math

import numpy as np
import pytest

from camgen.findings import Where
from camgen.geometry.rings import Floats, Ring
from camgen.judge.edges import Engagement, judge_edges
from camgen.judge.pairs import hollow
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


def test_an_edge_beside_the_way_does_not_count_for_the_one_ahead() -> None:
    """The pin has its air to a disc ahead, and three quarters of it to one that it passes: so far it is not pushed."""
    pin = complex(-ARM)
    ahead = pin + 1j * (10 + FREE)  # mm from the driven axis
    # rad: 0.14 mm away where it is nearest, and 0.15 mm, three quarters of the air, a milliradian before the pin is there
    near = 10 + 0.75 * FREE
    passed = -1e-3 - math.acos((30.14**2 + ARM**2 - near**2) / (2 * 30.14 * ARM))
    beside = -30.14 * complex(math.cos(passed), math.sin(passed))
    driver = Edge("driver", Eye("driver", 0j, 4.0))
    driven = Edge("driven", Eye("driven", 0j, 4.0))
    pair = EngagedPair(
        "x",
        (driver, driver),
        (driven,),
        "a",
        "b",
        FREE,
        (),
        0.1,
        rates=(0.0, 0.0),
        pushed=((0.0, 0.1),),
    )
    discs = circle(ahead + APART, 5.0), circle(beside + APART, 5.0)
    found = Engagement(pair, discs, (circle(pin, 5.0),), complex(APART), Standing(0.0))
    assert found.worst_gap.gap == pytest.approx(2 * FREE, rel=0.02)


def clutch(air: float) -> Engagement:
    """A disc on the same axis takes a pin along in a hole that is so much wider all round."""
    edge = Edge("disc", Eye("disc", 0j, 4.0)), Edge("arm", Eye("arm", 0j, 4.0))
    pair = EngagedPair("x", edge[:1], edge[1:], "a", "b", FREE, ((0.0, 0.1),), 0.1)
    hole = hollow(circle(complex(ARM), 5.0 + air))
    return Engagement(pair, (hole,), (circle(complex(ARM), 5.0),), 0j, Along())


class Along:
    """A follower that turns as its driver."""

    def __call__(self, theta: Floats, order: int = 0) -> Floats:
        return theta + 0.0 if order == 0 else np.ones(theta.shape)


@pytest.mark.parametrize("air", [FREE, 0.6 * FREE, 1.5 * FREE])
def test_a_pin_in_a_hole_has_its_play_on_both_sides_at_any_angle(air: float) -> None:
    """Its middle goes so far along a chord either way; after 37 periods as in the first one."""
    pin = clutch(air)
    turn = 2 * math.asin(air / 2 / ARM)
    theta = np.array([0.033, 3.733])
    assert pin.play(theta) == pytest.approx(2 * turn, abs=1e-9)
    assert pin(theta) == pytest.approx(theta, abs=1e-9)
    assert pin.lever(theta) == pytest.approx(ARM, rel=1e-3)
    assert pin.worst_gap.gap == pytest.approx(2 * air, rel=1e-3)


@pytest.mark.parametrize(
    ("air", "share", "said"),
    [
        (
            0.0005,
            100.0,
            "it overlaps at none of them, nor from one to the next; play 0.003 to 0.003 deg",
        ),
        (1e-6, 0.0, "there it is free, but with too little play to prove its way"),
        (-0.1, 0.0, "there disc and arm overlap"),
    ],
)
def test_a_pin_with_little_air_is_followed_in_short_steps(
    air: float, share: float, said: str
) -> None:
    """A step of 0.5 deg moves the pin by 175 um, a sixteenth by 11 um: only a path that goes along stays in a hole of 0.5 um.

    Play: 2 * 0.5 um on an arm of 20 mm are 0.003 deg.
    """
    found = judge_edges(clutch(air), Where())
    assert found.measured >= share and found.ok == (share == 100)
    assert said in found.message
