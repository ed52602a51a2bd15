"""Contacts, pins and bearings against published examples, in the units in which these are printed.

Figures of textbooks are quoted without the book at hand; each follows by hand as well.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from camgen.machine import flywheel, strength
from camgen.machine.strength import Elastic

LB_IN = Elastic(30e6, 0.28)  # any units that go together do: here pounds and inches


def test_crane_wheel_on_its_rail() -> None:
    """Norton, Machine Design, 4th ed., example 7-2: wheel 12 in wide 0.875 in on a flat rail, 5000 lbf, steel."""
    pressure, width = strength.line_contact(5000.0, 0.875, 1 / 6.0, LB_IN, LB_IN)
    assert float(pressure) == pytest.approx(70243, abs=0.5)
    assert float(width) == pytest.approx(0.0518, abs=5e-5)
    assert 5000 / (2 * float(width) * 0.875) == pytest.approx(55169, abs=0.5)


def test_the_constants_of_roark() -> None:
    """Roark's Formulas for Stress and Strain, table 14.1, case 2: equal materials with nu = 0.3."""
    both = Elastic(207e3, 0.3)
    load, diameter = 40.0, 25.0  # N/mm, mm
    pressure, width = strength.line_contact(load * 10, 10.0, 2 / diameter, both, both)
    assert float(pressure) / math.sqrt(load * 207e3 / diameter) == pytest.approx(0.591, abs=5e-4)
    assert 2 * float(width) / math.sqrt(load * diameter / 207e3) == pytest.approx(2.15, abs=5e-3)


def test_a_hollow_that_fits_and_a_pull_press_nothing() -> None:
    pressure, width = strength.line_contact(
        np.array([10.0, -10.0]), 5.0, np.array([-0.1, 0.1]), LB_IN, LB_IN
    )
    assert np.all(pressure == 0) and math.isinf(width[0]) and width[1] == 0


def test_pressure_times_speed_of_a_plastic_bearing() -> None:
    """BNB Industries, bearing technical information: shaft 5/8 in, length 1 1/32 in, 35 lb at 120 rpm: 54.3 psi, 19.635 fpm."""
    slides = strength.sliding(
        np.array([35.0]), np.array([120 * math.tau / 60]), 0.625, 1 + 1 / 32, 0.1
    )
    assert slides.pressure[0] == pytest.approx(54.3, abs=0.05)
    feet = slides.speed[0] * 1e3 / 12 * 60  # from thousandths of the unit a second to feet a minute
    assert feet == pytest.approx(19.635, abs=5e-4)
    assert slides.pressure[0] * feet == pytest.approx(1066.2, abs=0.1)


def test_heat_is_friction_times_both() -> None:
    slides = strength.sliding(np.array([100.0, 300.0]), np.array([10.0, -10.0]), 20.0, 5.0, 0.5)
    assert slides.power == pytest.approx(0.5 * 200 * 0.1)  # W: 200 N at 0.1 m/s
    assert slides.pv == pytest.approx(2.0 * 0.1)


def test_bearing_of_shigley() -> None:
    """Shigley's Mechanical Engineering Design, example 11-1: 400 lbf for 5000 h at 1725 rpm asks for C10 = 3211 lbf."""
    turns = 5000 * 60 * 1725
    assert strength.bearing_life(3211, 400) == pytest.approx(turns, rel=1e-3)
    assert math.isinf(strength.bearing_life(1.0, 0.0))


def test_bearing_of_rollers() -> None:
    """machinecalcs.com: C / P = 6 gives 216 million turns of balls, about 392 million of rollers."""
    assert strength.bearing_life(30, 5) == pytest.approx(216e6)
    assert strength.bearing_life(30, 5, 10 / 3) == pytest.approx(392e6, rel=2e-3)


def test_mean_load_of_a_bearing_is_cubic() -> None:
    assert strength.mean_load(np.full(5, 7.0), np.ones(5)) == pytest.approx(7.0)
    assert strength.mean_load(np.array([2.0, 0.0]), np.ones(2)) == pytest.approx(
        4 ** (1 / 3)
    )  # half the turns at 2, half at 0


def test_round_sections() -> None:
    """M / W, four thirds of Q / A, T / Wp of a round bar, from its second moments."""
    d = 3.5
    inertia = math.pi * d**4 / 64
    assert strength.pin_bending(-10.0, 6.0, d) == pytest.approx(60 * d / 2 / inertia)
    assert strength.pin_shear(10.0, d) == pytest.approx(4 / 3 * 10 / (math.pi * d**2 / 4))
    assert strength.shaft_twist(50.0, d) == pytest.approx(50 * d / 2 / (2 * inertia))


# Torque of a one-cylinder engine over two turns, lbf in, every 15 deg [Shigley's Mechanical Engineering Design, table 16-6].
ENGINE = (
    0,
    2800,
    2090,
    2430,
    2160,
    1840,
    1590,
    1210,
    1066,
    803,
    532,
    184,
    0,
    -107,
    -206,
    -260,
    -323,
    -310,
    -242,
    -126,
    -8,
    89,
    125,
    85,
    0,
    -85,
    -125,
    -89,
    8,
    126,
    242,
    310,
    323,
    280,
    206,
    107,
    0,
    -107,
    -206,
    -292,
    -355,
    -371,
    -362,
    -312,
    -272,
    -274,
    -548,
    -760,
    0,
)


def test_flywheel_of_an_engine() -> None:
    """Shigley, example 16-6: 3368 in lbf over two turns, 268 lbf in; its largest loop, 3531 in lbf, summed crudely up to 180 deg."""
    theta, torque = np.radians(15.0 * np.arange(len(ENGINE))), np.array(ENGINE, float)
    mean = flywheel.mean_torque(theta, torque)
    assert mean * 4 * math.pi == pytest.approx(3368, abs=1) and mean == pytest.approx(268, abs=0.1)
    assert flywheel.energy_swing(theta, torque) == pytest.approx(3531, rel=0.03)


def test_a_sine_of_torque_swings_by_twice_its_size() -> None:
    theta = np.linspace(0, math.tau, 7201)
    assert flywheel.energy_swing(theta, 5 + 3 * np.sin(theta)) == pytest.approx(6.0, rel=1e-6)


def test_the_flat_of_a_shaft_turns_its_hub_by_the_moment_of_its_pressure() -> None:
    """Pressure that grows evenly over half of the flat of a D shaft, summed strip by strip, gives the torque back."""
    diameter, depth, length, torque = 3.0, 0.5, 4.0, 116.0  # mm, N mm
    peak = float(strength.flat_pressure(torque, diameter, depth, length))
    half = diameter / 2 * math.sin(math.acos((diameter / 2 - depth) / (diameter / 2)))
    edges = np.linspace(0, half, 4001)
    middle = (edges[1:] + edges[:-1]) / 2
    pressure = peak * middle / half
    assert float(np.sum(pressure * middle * np.diff(edges)) * length) == pytest.approx(
        torque, rel=1e-6
    )
    assert strength.flat_pressure(torque, diameter, depth, 2 * length) == pytest.approx(peak / 2)
