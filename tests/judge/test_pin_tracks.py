"""Pins along lobes: gaps of round pins in an eccentric hole, which are differences of radii and distances."""

from __future__ import annotations

import math

import numpy as np
import pytest

from camgen.findings import Where
from camgen.geometry.rings import Floats, Ring
from camgen.judge.pair_features import features
from camgen.judge.pairs import hollow
from camgen.judge.pin_tracks import TrackedPins, judge_tracks, nearest
from camgen.machine.features import Edge, EngagedPair, Eye, PinTracks

CIRCLE, HOLE, ASIDE, PIN = 20.0, 25.0, 1.0, 2.0  # mm: of pins, of the hole, its middle aside, a pin
PLACES = np.radians([10.0, 130.0, 250.0])


def circle(centre: complex, radius: float) -> Ring:
    return Ring(centre + radius * np.array([1, 1j, -1, -1j]), np.full(4, math.tan(math.pi / 8)))


def still(theta: Floats, order: int = 0) -> Floats:
    return np.zeros(theta.shape)


def wanted(angle: Floats) -> Floats:
    """A gap that is largest along the line of both axes, mm."""
    return 2.5 + 0.1 * np.cos(angle)


def tracked(lobes: int) -> TrackedPins:
    """Three pins that turn in a hole that stands, the second one 0.2 mm thin."""
    sizes = (PIN, PIN - 0.2, PIN)
    pins = [circle(CIRCLE * np.exp(1j * p), size) for p, size in zip(PLACES, sizes, strict=True)]
    hole = hollow(circle(complex(ASIDE), HOLE))
    edges = Edge("pins", Eye("pins", 0j, 4.0)), Edge("plate", Eye("plate", 0j, 4.0))
    tracks = PinTracks("a", lobes, wanted, CIRCLE, 0.1)
    feature = EngagedPair(
        "reducer", edges[:1] * 3, edges[1:], "a", "b", 0.0, (), math.tau, tracks=tracks
    )
    return TrackedPins(feature, tuple(pins), (hole,) * (1 if lobes else 3), 0j, still)


@pytest.mark.parametrize(
    ("lobes", "said"), [(4, "pin 2 at lobe 4: gap 4.2000 mm"), (0, "pin 2 in its hole: gap 4.2000")]
)
def test_the_pin_farthest_from_its_gap_is_told(lobes: int, said: str) -> None:
    """The thin one, where the hole is deepest: 25 + 1 - 20 - 1.8 mm, after 230 deg; 10 deg before the first pin's hollow is
    the last lobe."""
    pins = tracked(lobes)
    finding = judge_tracks(pins, 1.5, Where("x"))
    assert finding.measured == pytest.approx(1.6, abs=1e-9) and not finding.ok
    assert finding.message.startswith(said) and "2.6000 mm wanted" in finding.message
    assert str(finding.where).endswith("crank at 230.000 deg")
    # the thick ones come nearest to the other side, 25 - 1 - 20 - 2 mm
    assert (pins.worst.least, pins.worst.most) == pytest.approx((2.0, 4.2), abs=1e-9)
    assert (pins.worst_gap.gap, pins.worst_gap.meant) == pytest.approx((8.4, 5.2), abs=1e-9)


def test_of_points_far_apart_each_has_its_own_nearest_edge() -> None:
    """Two that are looked up together, 20 mm apart: one has a pin beside it, the other one its own 12 mm on."""
    edges = features([circle(-9 + 0j, 0.1), circle(22 + 0j, 0.1)])
    found = nearest(np.array([-10 + 0j, 10 + 0j]), edges)
    assert found.distance == pytest.approx([0.9, 11.9], abs=1e-9)
    assert found.normal == pytest.approx([-1, -1], abs=1e-9)
