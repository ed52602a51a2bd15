"""Wheels that are not round from their own files: sound, and with a flank, a tooth or a centre that is off."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from judged import by_code, damaged, drawn

from camgen.numerics import Points
from camgen.parts.wheels.noncircular import TOLERANCE

SPEC = {
    "mechanism": "linkage",
    "name": "pair",
    "points": {"O": [0, 0], "C": [36, 0]},
    "links": {"ground": ["O", "C"], "crank": ["O"], "wheel": ["C"]},
    "drive": {"link": "crank"},
    "noncircular": [
        {
            "a": "crank",
            "b": "wheel",
            "teeth": 24,
            "sines_deg": [0, -math.degrees(0.08)],
            "backlash": 0.1,
            "name": "mesh",
        }
    ],
    "output": [{"name": "turn", "link": "wheel"}],
}
DRIVER, DRIVEN = (f"pair-wheel-mesh-{link}.dxf" for link in ("crank", "wheel"))
# deg, what both wheels' arcs may do: the normals of flanks pass the driven axis at 14 mm or more
ARCS = math.degrees(2 * TOLERANCE / 14)
NEAR = math.radians(7.4)  # half of a tooth's pitch: the one on Ox, of either wheel beside a gap


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return drawn(SPEC, tmp_path_factory.mktemp("pair"))


@pytest.mark.long
def test_a_sound_pair_turns_by_its_law(sound: Path) -> None:
    found = by_code(sound)
    assert all(each.ok for each in found.values())
    assert found["CONTACT"].measured == 100.0
    assert found["MOTION_ERROR"].measured < ARCS
    assert found["PIN_GAP"].measured < 5e-4


@pytest.mark.long
def test_a_flank_that_stands_out_is_told_by_its_play(sound: Path, tmp_path: Path) -> None:
    """By 20 um across Ox: each wheel answers for half of 20 um cos 20 deg."""

    def out(points: Points) -> Points:
        flank = (np.abs(np.angle(points)) < NEAR) & (points.imag > 0.2)
        assert flank.sum() > 10
        return points + 0.02j * flank

    gap = damaged(sound, tmp_path, DRIVER, out)["PIN_GAP"]
    assert not gap.ok
    assert gap.measured == pytest.approx(0.01 * math.cos(math.radians(20)), rel=0.15)
    assert gap.where.joint == "mesh"
    assert "wheel-mesh-crank and wheel-mesh-wheel" in gap.message


@pytest.mark.long
def test_a_missing_tooth_is_told_by_its_play(sound: Path, tmp_path: Path) -> None:
    def without(points: Points) -> Points:
        tooth = np.abs(np.angle(points)) < NEAR
        root = np.abs(points[tooth]).min()
        return np.where(tooth, points / np.abs(points) * root, points)

    gap = damaged(sound, tmp_path, DRIVER, without)["PIN_GAP"]
    assert not gap.ok and gap.measured > 10 * gap.limit
    assert "wheel-mesh-crank and wheel-mesh-wheel" in gap.message


@pytest.mark.long
def test_a_wheel_off_its_centre_is_told_by_its_play(sound: Path, tmp_path: Path) -> None:
    """By 10 um: where it stands away from its mate both flanks have 2 sin 20 deg of that more, half of it for each wheel."""
    found = damaged(sound, tmp_path, DRIVEN, lambda points: points + 0.01)
    gap = found["PIN_GAP"]
    assert not gap.ok
    assert gap.measured == pytest.approx(0.01 * math.sin(math.radians(20)), rel=0.15)


@pytest.mark.long
def test_a_wheel_that_is_turned_is_off_by_as_much(sound: Path, tmp_path: Path) -> None:
    by = math.radians(0.02)
    found = damaged(sound, tmp_path, DRIVEN, lambda points: points * np.exp(1j * by))
    assert not found["MOTION_ERROR"].ok
    assert found["MOTION_ERROR"].measured == pytest.approx(0.02, abs=ARCS)


@pytest.mark.long
def test_wheels_that_are_too_large_jam_and_are_named(sound: Path, tmp_path: Path) -> None:
    found = damaged(sound, tmp_path, DRIVEN, lambda points: points * 1.02)
    assert not found["CONTACT"].ok and found["CONTACT"].measured < 90
    assert "wheel-mesh-crank and wheel-mesh-wheel overlap" in found["CONTACT"].message
