"""Centrodes against what is known of them: the circles of Cardan, and the crossing of the cranks' lines of a four-bar."""

from __future__ import annotations

import math

import numpy as np
import pytest

from camgen.machine.centrodes import centrodes
from camgen.machine.model import GROUND, Body, Drive, Machine, Pin, Place, Pose, Slot
from camgen.machine.run import solve

THETA = np.radians(np.arange(3.0, 360.0, 7.0))


def test_a_ladder_rolls_in_a_circle_twice_its_own() -> None:
    """Ends on two lines at right angles, 80 apart: fixed centrode a circle of radius 80 about the crossing, moving one of
    radius 40 about the middle (Cardan). A crank of 40 from the crossing to the middle drives it."""
    bodies = (Body("crank", {"pin": 40 + 0j}), Body("ladder", {"pin": 0j, "end": 40 + 0j}))
    joints = (
        Pin("shaft", Place("crank"), Place(GROUND)),
        Pin("middle", Place("crank", 40 + 0j), Place("ladder")),
        Slot("line", Place(GROUND), Place("ladder", 40 + 0j)),
    )
    start = {
        "crank": Pose(0j, 0.3),
        "ladder": Pose(40 * complex(math.cos(0.3), math.sin(0.3)), -0.3),
    }
    machine = Machine(
        bodies,
        joints,
        (Drive("motor", "crank", lambda t, k=0: t + 0.3 if k == 0 else 0 * t + (k == 1)),),
        start,
    )
    theta = np.linspace(-1.7, 1.2, 60)  # up to where the ladder stands upright, and may turn back
    fixed, moving = centrodes(solve(machine, theta, 1), "ladder", 80.0)
    assert np.abs(fixed) == pytest.approx(80.0)
    assert np.abs(moving) == pytest.approx(40.0)


def test_a_couplers_centre_is_where_the_cranks_lines_cross() -> None:
    """Kennedy: of a four-bar 20, 70, 50 on 60; and far away, where the cranks are parallel, it is no place."""
    a, b = 0j, 60 + 0j
    crank = 20 * np.exp(1j * 0.8)
    far = b - crank
    reach = abs(far)
    lean = math.acos((70**2 + reach**2 - 50**2) / (2 * 70 * reach))
    coupler = float(np.angle(far)) + lean
    rocker = float(np.angle(crank + 70 * np.exp(1j * coupler) - b))
    bodies = (
        Body("crank", {"A": 20 + 0j}),
        Body("coupler", {"A": 0j, "B": 70 + 0j}),
        Body("rocker", {"B": 50 + 0j}),
    )
    joints = (
        Pin("O", Place("crank"), Place(GROUND, a)),
        Pin("A", Place("crank", 20 + 0j), Place("coupler")),
        Pin("B", Place("coupler", 70 + 0j), Place("rocker", 50 + 0j)),
        Pin("C", Place("rocker"), Place(GROUND, b)),
    )
    start = {
        "crank": Pose(a, 0.8),
        "coupler": Pose(complex(crank), coupler),
        "rocker": Pose(b, rocker),
    }
    machine = Machine(
        bodies,
        joints,
        (Drive("motor", "crank", lambda t, k=0: t + 0.8 if k == 0 else 0 * t + (k == 1)),),
        start,
    )
    run = solve(machine, THETA, 1)
    fixed, moving = centrodes(run, "coupler", 70.0)
    seen = np.isfinite(fixed)
    assert seen.sum() > 20 and not seen.all()
    one, other = np.exp(1j * run.angle("crank")[0]), np.exp(1j * run.angle("rocker")[0])
    for centre, way in ((fixed - a, one), (fixed - b, other)):
        assert np.imag(centre / way)[seen] == pytest.approx(0.0, abs=1e-8)
    pose = run.pose("coupler")
    assert (pose.place + np.exp(1j * pose.angle) * moving)[seen] == pytest.approx(fixed[seen])
