"""Stiffness of arms from their outlines against the beams of the tables."""

from __future__ import annotations

import cmath
import math

import pytest

from camgen import starters
from camgen.geometry.outlines import Region, polygon, rectangle
from camgen.machines.loads.assess import assess
from camgen.machines.sources import read_mechanism
from camgen.parts.part import Layer, Part
from camgen.parts.stiffness import bending_stiffness

BAR = rectangle(-10 - 4j, 70 + 4j)
FOLLOWER = "geometry.follower={motion='oscillating', shape='roller', radius=5.0, pivot_distance=60.0, arm=50.0}"


def plate(*regions: Region, high: float = 5.0) -> Part:
    return Part("bar", "Bar", tuple(Layer(region, 0.0, high) for region in regions))


def test_an_even_bar_is_the_cantilever_of_the_tables() -> None:
    """k = 3 E I / l^3, I = b h^3 / 12 of a beam that is held at one end; whichever way it lies."""
    k = 3 * 2000 * (5 * 8**3 / 12) / 60**3
    assert bending_stiffness(plate(Region(BAR)), 0j, 60 + 0j, 2000.0) == pytest.approx(k, rel=1e-4)
    turn = cmath.rect(1, 0.7)
    turned = plate(Region(BAR.moved(turn, 3 + 2j)))
    assert bending_stiffness(turned, 3 + 2j, 3 + 2j + 60 * turn, 2000.0) == pytest.approx(
        k, rel=1e-4
    )


def test_a_slot_along_it_takes_its_moment_and_a_bar_that_narrows_its_integral() -> None:
    slot = rectangle(-5 - 2j, 65 + 2j)
    k = 3 * 2000 * (5 * (8**3 - 4**3) / 12) / 60**3
    assert bending_stiffness(plate(Region(BAR, (slot,))), 0j, 60 + 0j, 2000.0) == pytest.approx(
        k, rel=1e-4
    )
    taper = polygon([-6j, 60 - 3j, 60 + 3j, 6j])  # 12 high, then 6: h = 6 + y / 10, y from the tip

    def primitive(u: float) -> float:  # of y^2 / u^3, u = 6 + y / 10
        return 1000 * (math.log(u) + 12 / u - 18 / u**2)

    k = 2000 * 5 / 12 / (primitive(12.0) - primitive(6.0))
    assert bending_stiffness(plate(Region(taper)), 0j, 60 + 0j, 2000.0) == pytest.approx(
        k, rel=1e-4
    )


def test_an_arm_that_does_not_reach_has_none() -> None:
    assert bending_stiffness(plate(Region(rectangle(-10 - 4j, 30 + 4j))), 0j, 60 + 0j, 2000.0) == 0


def test_the_follower_of_a_machine_tells_its_own() -> None:
    """Between the even bar as wide as its hubs, and a tenth of it."""
    spec = starters.folder() / "disc-cam.toml"
    machine = read_mechanism(
        spec, ("parts.make='printed'", FOLLOWER, "segment.0.lift=15", "geometry.base_radius=25")
    )
    found = assess(machine).study.numbers["follower_arm_stiffness_n_m_per_rad"]
    even = 3 * 3500 * (4 * 12**3 / 12) / 50**3 * 50**2 * 1e-3
    assert 0.1 * even < found < 1.2 * even
    assert (
        "follower_arm_stiffness_n_m_per_rad" not in assess(read_mechanism(spec, ())).study.numbers
    )
