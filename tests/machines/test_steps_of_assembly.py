"""Where each step of assembly puts its part, against what the spec says of joints and heights."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from camgen.geometry.outlines import Region, circle
from camgen.machine.features import Mount, PartPose
from camgen.machines.assembly import order
from camgen.machines.mechanism import Mechanism
from camgen.parts.part import Layer, Part
from camgen.pipeline.jobs import read_mechanism


@pytest.fixture(scope="module")
def leg() -> Mechanism:
    return read_mechanism(Path(__file__).parents[2] / "specs" / "walking-leg.toml", [])


def where(mechanism: Mechanism) -> dict[str, str]:
    return {str(row[1]): str(row[3]) for row in mechanism.steps().rows}


def test_each_link_is_said_to_go_over_those_that_it_is_jointed_to(leg: Mechanism) -> None:
    """Joints of the spec: A crank and both rods, B and D shoulder, E and F foot, C the ground's pin."""
    said = where(leg)
    assert said["upper_rod"] == "A over crank, B over shoulder" and said["link"] == "D over shoulder, F over foot"
    assert said["hanger"] == "C on pin-1, E over foot" and said["lower_rod"] == "A over upper_rod, E over hanger"
    through = "through B of upper_rod and shoulder; through D of link and shoulder; through F of link and foot"
    assert said["pin-3"] == through
    assert said["pin-2"] == "through A of lower_rod, upper_rod and crank; through E of lower_rod, hanger and foot"


def test_how_far_from_its_end_a_shaft_holds_each(leg: Mechanism) -> None:
    """By the undersides of the table: the shaft's at -15, collar's at -3.2, plate's at 0, crank's at 5.2 mm."""
    said, z = where(leg), {str(row[1]): float(str(row[5])) for row in leg.steps().rows}
    for name, point in (("collar", ""), ("ground", "O "), ("crank", "O ")):
        assert said[name].startswith(f"{point}on shaft, underside {z[name] - z['shaft']:.4g} mm from its lower end"), name


def test_what_is_turned_over_goes_where_its_mirror_image_stands() -> None:
    """A plate with a hole at x = 5, turned over about Oy and moved by 20: over a pin at x = 15, and over none at x = 25."""
    plate = Part("plate", "Plate", (Layer(Region(circle(0, 9), (circle(5, 1.1),)), 0, 2),), points=(("P", 5 + 0j),))
    pin = Part("pin", "Pin", (Layer(Region(circle(0, 1)), 0, 30),))
    for x, expected in ((15.0, "P on pin, underside 10 mm from its lower end"), (25.0, "")):
        poses = {
            "pin": [PartPose(np.array([x + 0j]), np.zeros(1), False, 0.0)],
            "plate": [PartPose(np.array([20 + 0j]), np.zeros(1), True, 10.0)],
        }

        mounts = (Mount("pin", "ground", x), Mount("plate", "ground", 20, 0.0, True, 10.0))
        rows = order((pin, plate), mounts, poses, ()).rows
        assert rows[1][3] == expected
    wide = replace(plate, layers=(Layer(Region(circle(0, 9), (circle(5, 4),)), 0, 2),))
    poses["pin"] = [PartPose(np.array([15 + 0j]), np.zeros(1), False, 0.0)]
    assert order((pin, wide), mounts, poses, ()).rows[1][3] == ""  # far too wide to be held by it
