"""A drawing that is closed step by step, held against Newton's method on all joints at once; near a fold it is left to that."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from chains import CHAINS, four_bar

from camgen.machine import freedom
from camgen.machine.constraints import Constraints
from camgen.machine.model import Machine, Place, Pose
from camgen.machine.reach import FAR
from camgen.machine.stepwise import closed_by_dyads, stays_clear

DYADS = {name: make for name, make in CHAINS.items() if closed_by_dyads(make()) is not None}


def drawn_roughly(machine: Machine, seed: int) -> Machine:
    """The same, its driven body as it is, all others up to 3 mm and 0.05 rad from where they close."""
    rng = np.random.default_rng(seed)
    driven = {drive.body for drive in machine.drives}
    start = {
        name: pose
        if name in driven
        else Pose(
            pose.place + complex(*rng.uniform(-3, 3, 2)), pose.angle + rng.uniform(-0.05, 0.05)
        )
        for name, pose in machine.start.items()
    }
    return replace(machine, start=start)


@pytest.mark.parametrize("name", DYADS)
def test_it_closes_where_newtons_method_does(name: str) -> None:
    rough = drawn_roughly(DYADS[name](), 3)
    steps = closed_by_dyads(rough)
    whole = freedom.close_drawing(rough)
    assert steps is not None
    size = Constraints(whole).size
    for body, pose in whole.start.items():
        assert abs(steps.start[body].place - pose.place) < 1e-12 * size
        assert steps.start[body].angle == pytest.approx(pose.angle, abs=1e-12)


def test_larger_blocks_and_what_does_not_close_are_left_to_the_general_way() -> None:
    left = CHAINS.keys() - DYADS.keys()
    assert {"double butterfly", "Stephenson III"} <= left and len(DYADS) >= 10
    assert closed_by_dyads(replace(four_bar(40, 15, 45, 35), drives=())) is None  # loose
    bar = four_bar(40, 15, 45, 35)
    near = replace(bar.joint("B"), a=Place("coupler", 5), b=Place("rocker", 5))
    joints = tuple(near if joint.name == "B" else joint for joint in bar.joints)
    assert closed_by_dyads(replace(bar, joints=joints)) is None


@pytest.mark.parametrize(("coupler", "clear"), [(45.0, True), (20.05, False), (59.9, False)])
def test_a_range_is_clear_where_no_transmission_angle_is_small(coupler: float, clear: bool) -> None:
    """Of frame 40, crank 15, output 35 the diagonal goes from 25 to 55 mm."""
    machine = four_bar(40, 15, coupler, 35)
    corner = [
        (coupler**2 + 35**2 - diagonal**2) / (2 * coupler * 35) for diagonal in (25, 55)
    ]  # by the law of cosines
    least = min(np.sqrt(1 - np.square(corner)))
    assert stays_clear(machine) == clear == bool(least > FAR)
