"""Cams inside a linkage: their contact bears what the shaft bears, HERTZ by hand, print errors of their outlines."""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np
import pytest
from test_linkage_bodies import cam_ram, cam_rocker

from camgen.machine.model import Cam
from camgen.machine.run import solve
from camgen.machines.loads.assess import assess
from camgen.machines.mechanism import Mechanism
from camgen.machines.sources import read_mechanism
from camgen.tolerance.spread import copies_of, rolled_outputs, spread_of

TURN = np.linspace(0, math.tau, 181)
CASES: list[
    tuple[Any, float, float]
] = [  # the machine, a load on its output that presses it on its cam, what then presses
    (lambda: cam_ram(), -5.0, 5.0),
    (lambda: cam_ram(closure="groove"), 5.0, 5.0),
    (lambda: cam_ram(shape="flat", radius=None), -5.0, 5.0),
    (lambda: cam_rocker(), 0.5, 0.5 / math.hypot(30, 25) * 1e3),
    (lambda: cam_rocker(closure="conjugate"), -0.5, 12.8),
]


def made(tables: dict[str, Any], load: float) -> Mechanism:
    head = {"mechanism": "linkage", "name": "own", "drive": {"link": "crank", "speed_rpm": 6.0}}
    return read_mechanism(
        {**head, **tables, "load": {"friction": 0.0, "on": [{"output": "out", "value": load}]}}, ()
    )


@pytest.mark.parametrize("case", range(len(CASES)))
def test_the_shaft_bears_what_presses_on_the_cam(case: int) -> None:
    tables, load, least = CASES[case]
    machine = made(tables(), load).model
    forces = solve(machine, TURN).forces()
    (cam,) = (joint for joint in machine.joints if isinstance(joint, Cam))
    shaft = next(pin for pin in forces.reactions if pin.startswith("O"))
    pressed = forces.pressing[cam.name]
    np.testing.assert_allclose(pressed, np.abs(forces.reactions[shaft]), rtol=1e-3)
    assert np.min(pressed) == pytest.approx(least, rel=0.02)


def test_hertz_of_a_face_on_its_cam_by_hand() -> None:
    """Where it dwells on the base circle: p = sqrt(F E* / (pi L R)), both of PLA, on a line as long as the cam is thick."""
    found = assess(made(cam_ram(shape="flat", radius=None), -5.0))
    (hertz,) = (each for each in found.findings if each.code == "HERTZ")
    stiff = 3500.0 / (2 * (1 - 0.35**2))
    base = math.sqrt(5.0 * stiff / (math.pi * 4.0 * 35.0))
    assert (
        hertz.ok
        and hertz.measured >= 0.999 * base
        and hertz.measured < 2 * base
        and "the pressure is higher at the ends" in hertz.message
    )
    plot = next(each for each in found.study.plots if each.title.startswith("Hertz"))
    _, degrees, pressure = plot.series[0]
    rests = (degrees > 305) & (degrees < 355)
    np.testing.assert_allclose(pressure[rests], base, rtol=2e-3)


def test_a_follower_that_nothing_presses_is_named() -> None:
    left = assess(made(cam_ram(), 5.0)).not_judged
    assert any(each.code == "HERTZ" and "leaves it" in each.why for each in left)


def lift_off(machine: Mechanism) -> Any:
    (found,) = (each for each in machine.limits() if each.code == "LIFT_OFF")
    return found


@pytest.mark.parametrize("load", [5.0, -5.0])
def test_what_pulls_the_follower_off_its_cam_fails_and_says_how_much_is_missing(
    load: float,
) -> None:
    """A ram that stands across the shaft: the cam bears the load over the cosine of its pressure angle, at no speed."""
    machine = made(cam_ram(), load)
    found = lift_off(machine)
    assert (
        found.ok is (load < 0) and "cam angle" in str(found.where) and not machine.assembly.unjudged
    )
    if not found.ok:
        u = np.linspace(
            0, 1, 2001
        )  # of the cycloidal rise by 12 mm in 120 deg, from 35 mm off the shaft
        s, slope = (
            12 * (u - np.sin(math.tau * u) / math.tau),
            12 * (1 - np.cos(math.tau * u)) / (math.tau / 3),
        )
        assert found.measured == pytest.approx(-5.0 * np.hypot(1, slope / (35 + s)).max(), rel=1e-3)
        assert (
            re.search(r" with 5(\.0\d*)? N more", found.message) and "[[spring]]" in found.message
        )
    else:
        assert found.measured == pytest.approx(5.0, rel=0.02)


def test_weight_counts_and_what_nothing_presses_is_named() -> None:
    head = {"mechanism": "linkage", "name": "own", "drive": {"link": "crank", "speed_rpm": 6.0}}
    loads: list[dict[str, Any]] = [{"gravity_deg": 90}, {"gravity_deg": -90}, {}]
    machines = [read_mechanism({**head, **cam_ram(), "load": load}, ()) for load in loads]
    assert [lift_off(each).ok for each in machines[:2]] == [False, True]
    assert "LIFT_OFF" not in {each.code for each in machines[2].limits()}
    (left,) = (each for each in assess(machines[2]).not_judged if each.code == "LIFT_OFF")
    assert "[[spring]]" in left.needs and "[load]" in left.needs


def test_print_errors_of_its_outline_reach_the_output() -> None:
    """First order against the outline really displaced and rolled."""
    machine = made(cam_ram(), -5.0)
    spread = spread_of(machine)
    kinds = {mode.kind for mode in spread.modes}
    assert {"offset", "bore", "form", "tip"} <= kinds
    errors = np.zeros((1, len(spread.modes)))
    errors[0, [mode.kind for mode in spread.modes].index("offset")] = 0.05
    first = errors @ spread.found["out"].modes
    np.testing.assert_allclose(rolled_outputs(spread, errors)["out"], first, atol=2e-3)
    assert np.max(np.abs(first)) > 0.04
    assert np.all(np.isfinite(copies_of(spread, 50, 1).errors["out"]))
