"""Mutilated gears from their own files: sound, and with a rim, a tooth or a hollow that is off."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from judged import by_code, damaged, drawn

from camgen.numerics import Points
from camgen.parts.wheels.mutilated import MutilatedPair

SPEC = {
    "mechanism": "linkage",
    "name": "steps",
    "points": {"O": [0, 0], "C": [60, 0]},
    "links": {"ground": ["O", "C"], "crank": ["O"], "wheel": ["C"]},
    "drive": {"link": "crank"},
    "mutilated": [
        {
            "a": "crank",
            "b": "wheel",
            "teeth": [24, 24],
            "stations": 4,
            "backlash": 0.1,
            "name": "mesh",
        }
    ],
    "output": [{"name": "turn", "link": "wheel"}],
}
PAIR = MutilatedPair((24, 24), 4, 60.0, 0.1)
DRIVER, WHEEL = (f"steps-wheel-mesh-{link}.dxf" for link in ("crank", "wheel"))


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return drawn(SPEC, tmp_path_factory.mktemp("steps"))


@pytest.mark.long
def test_sound_gears_go_by_their_law(sound: Path) -> None:
    found = by_code(sound)
    assert all(each.ok for each in found.values())
    assert found["CONTACT"].measured == 100.0
    assert found["PIN_GAP"].measured < 1.5e-3


@pytest.mark.long
def test_a_rim_that_is_too_small_is_told_by_its_play(sound: Path, tmp_path: Path) -> None:
    """By 50 um all along: the wheel has as much more on both sides while it stands, half of it for each wheel."""

    def smaller(points: Points) -> Points:
        rim = np.abs(np.abs(points) - PAIR.lock) < 1e-3
        assert rim.sum() > 2
        return np.where(rim, points * (1 - 0.05 / PAIR.lock), points)

    gap = damaged(sound, tmp_path, DRIVER, smaller)["PIN_GAP"]
    assert not gap.ok
    assert gap.measured == pytest.approx(0.05, rel=0.15)
    assert "wheel-mesh-crank and wheel-mesh-wheel" in gap.message


@pytest.mark.long
def test_a_rim_that_is_too_large_jams(sound: Path, tmp_path: Path) -> None:
    def larger(points: Points) -> Points:
        rim = np.abs(np.abs(points) - PAIR.lock) < 1e-3
        return np.where(rim, points * (1 + 0.1 / PAIR.lock), points)

    assert not damaged(sound, tmp_path, DRIVER, larger)["CONTACT"].ok


@pytest.mark.long
def test_a_tooth_that_is_left_out_is_told(sound: Path, tmp_path: Path) -> None:
    """The middle one of the driver's five."""
    middle = math.pi  # the drive is opposite to the middle of a rest

    def without(points: Points) -> Points:
        off = np.angle(points * np.exp(-1j * middle))
        tooth = (np.abs(off) < PAIR.driver.pitch / 2) & (np.abs(points) > PAIR.driver.root)
        assert tooth.sum() > 10
        return np.where(tooth, points / np.abs(points) * PAIR.driver.root, points)

    found = damaged(sound, tmp_path, DRIVER, without)
    assert not found["PIN_GAP"].ok and found["PIN_GAP"].measured > 10 * found["PIN_GAP"].limit


@pytest.mark.long
def test_a_last_tooth_that_is_too_low_leaves_the_wheel_short_of_its_station(
    sound: Path, tmp_path: Path
) -> None:
    """By 0.2 mm: nothing pushes the wheel to where it is meant."""
    last = (
        PAIR.drive[1] - PAIR.middle
    )  # it has just passed the line of both axes as the wheel stops
    corner = 1.5 * PAIR.wheel.pitch - PAIR.wheel.half_top
    seen = 60 - PAIR.wheel.tip * np.exp(-1j * corner)
    low = seen * np.exp(-1j * (math.pi + last))

    def lower(points: Points) -> Points:
        near = np.abs(np.angle(points / low)) < PAIR.driver.pitch / 2
        high = near & (np.abs(points) > PAIR.last.tip - 0.2)
        assert high.sum() == 2  # ends of its tip
        return np.where(high, points / np.abs(points) * (PAIR.last.tip - 0.2), points)

    gap = damaged(sound, tmp_path, DRIVER, lower)["PIN_GAP"]
    assert not gap.ok and gap.measured > 0.05


@pytest.mark.long
def test_a_wheel_that_is_turned_is_off_by_as_much(sound: Path, tmp_path: Path) -> None:
    found = damaged(sound, tmp_path, WHEEL, lambda z: z * np.exp(1j * math.radians(0.05)))
    assert not found["MOTION_ERROR"].ok
    assert found["MOTION_ERROR"].measured == pytest.approx(0.05, abs=0.01)
