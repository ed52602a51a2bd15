"""A ratchet from its own files: sound, in both senses, and with a tooth, a tip or a pawl that is off."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from judged import by_code, damaged, drawn

from camgen.numerics import Points

SPEC = {
    "mechanism": "linkage",
    "name": "winch",
    "points": {"O": [0, 0], "B": [50, 0], "H": [64, 16], "S": [40, 46]},
    "links": {"ground": ["O", "B", "S"], "wheel": ["O"], "pawl": ["B", "H"]},
    "drive": {"link": "wheel", "speed_rpm": 20},
    "ratchet": [{"a": "wheel", "b": "pawl", "teeth": 8, "radius": 26, "name": "stop"}],
    "spring": [{"between": ["H", "S"], "rate": 0.1, "preload": 1}],
    "output": [{"name": "wheel", "link": "wheel"}],
}
WHEEL, PAWL = (f"winch-{name}-stop.dxf" for name in ("ratchet", "pawl"))
TIP, ROOT = 26.0, 22.75


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return drawn(SPEC, tmp_path_factory.mktemp("winch"))


def first_tip(points: Points) -> Points:
    """Which of a wheel's points is the tip that points nearest to Ox."""
    return (np.abs(points) > TIP - 0.1) & (np.abs(np.angle(points)) < math.pi / 8)


@pytest.mark.long
def test_a_sound_one_falls_behind_each_tooth_and_holds(sound: Path) -> None:
    found = by_code(sound)
    assert all(each.ok for each in found.values())
    assert found["CONTACT"].measured == 100
    assert found["MOTION_ERROR"].unit == "mm" and found["MOTION_ERROR"].measured < 2e-4
    assert found["PAWL_HOLDS"].measured == pytest.approx(math.tan(math.radians(38)), abs=1e-4)


@pytest.mark.long
def test_a_tip_20_um_off_is_refused_with_its_tooth(sound: Path, tmp_path: Path) -> None:
    def lower(points: Points) -> Points:
        return points * (1 - 0.02 / TIP * first_tip(points))

    found = damaged(sound, tmp_path, WHEEL, lower)
    error = found["MOTION_ERROR"]
    assert not error.ok and error.measured == pytest.approx(0.02, abs=2e-3)
    assert "apart at tooth" in error.message and "ratchet-stop" in error.message
    assert "all others" not in error.message
    told = error.message.split("at tooth ")[1].split(",")[0]
    other = damaged(sound, tmp_path / "next", WHEEL, lambda points: _next(points, lower))
    assert f"at tooth {int(told) % 8 + 1}" in other["MOTION_ERROR"].message


def _next(points: Points, change: Callable[[Points], Points]) -> Points:
    """The same of the tooth that comes to the pawl next: the one behind, for the wheel turns counter-clockwise."""
    back = np.exp(0.25j * math.pi)
    return change(points * back) / back


@pytest.mark.long
def test_a_burr_of_50_um_on_a_tip_is_refused(sound: Path, tmp_path: Path) -> None:
    found = damaged(
        sound, tmp_path, WHEEL, lambda points: points * (1 + 0.05 / TIP * first_tip(points))
    )
    error = found["MOTION_ERROR"]
    assert not error.ok and error.measured == pytest.approx(0.05, abs=3e-3)
    assert "there they overlap at tooth" in error.message


@pytest.mark.long
def test_a_missing_tooth_is_missed(sound: Path, tmp_path: Path) -> None:
    found = damaged(
        sound,
        tmp_path,
        WHEEL,
        lambda points: np.where(first_tip(points), points * 0.99 * ROOT / TIP, points),
    )
    falls = found["CONTACT"]
    assert not falls.ok and falls.measured == 87.5
    tooth = falls.message.split("not behind tooth ")[1]
    assert found["MOTION_ERROR"].measured > 2
    assert f"apart at tooth {tooth}" in found["MOTION_ERROR"].message


@pytest.mark.long
def test_a_pawl_50_um_shorter_is_off_at_all_teeth(sound: Path, tmp_path: Path) -> None:
    def shorter(points: Points) -> Points:
        end = np.abs(points) > 15
        return points - 0.05 * end * np.exp(1j * np.angle(points[end].mean()))

    error = damaged(sound, tmp_path, PAWL, shorter)["MOTION_ERROR"]
    assert not error.ok and error.measured == pytest.approx(0.05, abs=0.02)
    assert "all others: the pawl is off" in error.message and "pawl-stop" in error.message


@pytest.mark.long
def test_a_face_that_leans_the_wrong_way_does_not_hold(sound: Path, tmp_path: Path) -> None:
    """Its tip 2.6 mm ahead of its root: it throws the pawl out, and only the tooth behind it locks."""

    def leaning(points: Points) -> Points:
        return points * np.exp(0.1j * first_tip(points))

    holds = damaged(sound, tmp_path, WHEEL, leaning)["PAWL_HOLDS"]
    assert not holds.ok and math.isnan(holds.measured)
    assert "does not hold the pawl" in holds.message


@pytest.mark.long
def test_a_wheel_that_turns_clockwise_is_the_mirror_image(
    sound: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    """Every number of the ratchet is the same."""
    points = {name: [x, -y] for name, (x, y) in SPEC["points"].items()}  # type: ignore[attr-defined]
    other = SPEC | {"points": points, "drive": {"link": "wheel", "speed_rpm": -20}}
    found, meant = (
        json.loads((folder / "report.json").read_text(encoding="utf-8"))["numbers"]
        for folder in (drawn(other, tmp_path_factory.mktemp("mirrored")), sound)
    )
    own = {key: value for key, value in meant.items() if "_stop_" in key}
    assert len(own) >= 5  # least and greatest drop and lost angle, and the draw
    assert {key: found[key] for key in own} == pytest.approx(own, abs=1e-5)
