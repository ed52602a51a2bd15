"""[[freewheel]] of a linkage: its steps by hand and by the wheel's swing, its faults, the sizes that its clutches ask for."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from camgen.errors import DesignError, SpecError
from camgen.machine.freewheels import Ratchet
from camgen.machine.model import Clutch
from camgen.machines.linkage.mechanism import Linkage
from camgen.spec import validate


def spec(**tables: Any) -> Linkage:
    """A crank rocks a link, whose gear rocks a drum; a table on the drum's shaft turns on."""
    data: dict[str, Any] = {
        "mechanism": "linkage",
        "name": "steps",
        "points": {"O": (0, 0), "A": (15, 0), "B": (45, 52), "C": (60, 0), "D": (110, 0)},
        "links": {
            "ground": ["O", "C", "D"],
            "crank": ["O", "A"],
            "rod": ["A", "B"],
            "rocker": ["C", "B"],
            "drum": ["D"],
            "table": ["D"],
        },
        "drive": {"link": "crank", "speed_rpm": 30},
        "gear": [{"a": "rocker", "b": "drum", "ratio": -2}],
        "freewheel": [{"wheel": "drum", "link": "table", "lost_deg": 2}],
        "output": [{"name": "turn", "link": "table"}, {"name": "rock", "link": "drum"}],
    }
    return validate(Linkage, {**data, **tables})


def test_two_strokes_a_turn_by_hand() -> None:
    """sin 2 theta rises by 2 from -45 to 45 deg and from 135 to 225 deg; half a radian is lost in each."""

    def wheel(theta: np.ndarray, order: int) -> np.ndarray:
        return np.sin(2 * theta) if order == 0 else 2 * np.cos(2 * theta)

    law = Ratchet(wheel, 0.5, start=0.25)
    degrees = np.array([-45.0, 0, 45, 90, 150, 180, 225, 300, 360, 405])
    turned = np.array(
        [-0.5, 0, 1, 1, 1 + max(0.0, math.sin(math.tau * 5 / 6) + 0.5), 1.5, 2.5, 2.5, 3, 4]
    )
    assert law.advance == pytest.approx(3.0)
    assert law(np.radians(degrees)) == pytest.approx(0.25 + turned, abs=1e-9)
    assert law(np.radians([0.0, 90.0]), 1) == pytest.approx([2.0, 0.0])
    back = Ratchet(wheel, 0.5, forwards=-1)  # while it falls; theta runs on
    assert back(np.radians([360.0, 720.0])) == pytest.approx([-3.0, -6.0])
    with pytest.raises(DesignError, match="swing further"):
        _ = Ratchet(wheel, 2.5).advance


@pytest.mark.parametrize(("rpm", "turns"), [(30, "counter-clockwise"), (-30, "clockwise")])
def test_a_table_turns_on_by_the_swing_of_its_drum_less_what_is_lost(
    rpm: float, turns: str
) -> None:
    freewheel = {"wheel": "drum", "link": "table", "lost_deg": 2, "turns": turns}
    made = spec(drive={"link": "crank", "speed_rpm": rpm}, freewheel=[freewheel])
    theta = np.linspace(0, 2 * math.tau, 20_001)
    run = made.run(math.copysign(1, rpm) * theta, 0)
    step = np.ptp(run["rock"]) - math.radians(2)
    way = 1 if turns == "counter-clockwise" else -1
    assert way * run["turn"][[10_000, 20_000]] == pytest.approx([step, 2 * step], abs=1e-6)
    assert np.all(way * np.diff(run["turn"]) >= -1e-12)
    (clutch,) = (joint for joint in made.chain.joints if isinstance(joint, Clutch))
    engaged = np.isfinite(clutch.apart(run.theta))
    moved = np.gradient(run["turn"]) - np.gradient(run["rock"])
    inside = engaged & np.roll(engaged, 1) & np.roll(engaged, -1)
    assert np.abs(moved[inside]).max() < 1e-9 and 0.3 < engaged.mean() < 0.6


def test_plate_and_wheel_are_as_thick_as_the_clutch_unless_given() -> None:
    made = spec().making
    assert (made.base_thickness, made.shape("drum").thickness) == (15.0, 15.0)
    given = spec(parts={"shaft_diameter": 8.0, "base_thickness": 25.0}).making
    assert (given.base_thickness, given.shape("drum").thickness) == (25.0, 22.0)


@pytest.mark.parametrize(
    ("tables", "said"),
    [
        ({"freewheel": [{"wheel": "drumm", "link": "table"}]}, "freewheel.0.wheel.*drum"),
        ({"freewheel": [{"wheel": "rocker", "link": "table"}]}, "on the shaft of table"),
        ({"gear": []}, "link of a \\[\\[gear\\]\\]"),
        ({"parts": {"shaft_diameter": 7.0}}, "a bore of freewheels, 6, 8, 10 mm"),
        (
            {"drive": {"link": "crank", "range_deg": (0, 90)}},
            "no value here beside \\[\\[freewheel\\]\\]",
        ),
    ],
)
def test_what_is_no_freewheel_is_told(tables: dict[str, Any], said: str) -> None:
    with pytest.raises(SpecError, match=said):
        spec(**tables)
