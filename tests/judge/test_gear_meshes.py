"""GEAR_MESH: a pair of wheels, outside or in a ring, from its own files, sound, and with one flank, bore or tooth that is off."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from judged import drawn, motion_findings, moved_copy

import camgen
from camgen.findings import Finding
from camgen.numerics import Points

TEETH = 36  # of the crank's wheel, which has twice as many as the drum's
SPEC = {
    "mechanism": "linkage",
    "name": "pair",
    "points": {"O": [0, 0], "A": [20, 0], "C": [60, 0], "B": [70, 0]},
    "links": {"ground": ["O", "C"], "crank": ["O", "A"], "drum": ["C", "B"]},
    "drive": {"link": "crank"},
    "gear": [{"a": "crank", "b": "drum", "ratio": -2, "teeth": TEETH, "name": "pair"}],
    "output": [{"name": "out", "link": "drum"}],
}
WHEEL = "pair-gear-pair-crank.dxf"
INNER = {
    **SPEC,
    "name": "inner",
    "points": {"O": [0, 0], "A": [24, 0]},
    "links": {"ground": ["O", "A"], "pinion": ["A"], "drum": ["O"]},
    "drive": {"link": "pinion"},
    "gear": [{"a": "pinion", "b": "drum", "ratio": f"12/{TEETH}", "inner": True, "name": "pair"}],
}
PINION = "inner-gear-pair-pinion.dxf"
RING = "inner-gear-pair-drum.dxf"


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return drawn(SPEC, tmp_path_factory.mktemp("pair"))


def meshing(folder: Path) -> Finding:
    """What the judge says of the folder's drawings."""
    (found,) = [each for each in motion_findings(folder, 9) if each.code == "GEAR_MESH"]
    return found


def damaged(
    folder: Path, to: Path, change: Callable[[Points], Points], wheel: str = WHEEL
) -> Finding:
    """The pair with other points of a wheel's teeth."""
    return meshing(moved_copy(folder, to, wheel, change))


def flank(points: Points, by: float, tooth: float = 3) -> Points:
    """The later flank of one tooth, or space of a ring, turned by so many mm."""
    radius = np.abs(points)
    turned = points * np.exp(-2j * math.pi * tooth / TEETH)
    off = (np.angle(turned) > 0) & (np.angle(turned) < 0.9 * math.pi / TEETH)
    off &= radius > radius.min() + 0.4 * np.ptp(radius)
    return points * np.where(off, np.exp(1j * by / radius), 1)


@pytest.mark.long
def test_a_sound_pair_turns_evenly_within_its_arcs(sound: Path) -> None:
    found = meshing(sound)
    assert found.ok and 0 < found.measured < found.limit
    assert found.limit == pytest.approx(4 * 0.001, rel=1e-6)


@pytest.mark.long
@pytest.mark.parametrize("by", [-0.02, 0.02])
def test_a_flank_that_is_off_is_seen_as_much_and_named(
    sound: Path, tmp_path: Path, by: float
) -> None:
    found = damaged(sound, tmp_path, lambda points: flank(points, by))
    assert not found.ok
    # along the normal a flank moves by the cosine of the pressure angle; neighbours carry a part of what is missing
    assert found.measured == pytest.approx(0.02 * math.cos(math.radians(20)), abs=0.003)
    assert "unlike the others is at 30.0 deg of gear-pair-crank" in found.message


@pytest.mark.long
def test_teeth_beside_the_bore_s_middle_are_told(sound: Path, tmp_path: Path) -> None:
    """By 10 um: twice that from peak to peak, along a normal that leans by the pressure angle."""
    found = damaged(sound, tmp_path, lambda points: points + 0.01)
    assert not found.ok and found.measured == pytest.approx(0.02, rel=0.2)
    assert "the teeth of each wheel are alike" in found.message


@pytest.mark.long
def test_a_tooth_that_fills_its_gap_jams(sound: Path, tmp_path: Path) -> None:
    found = damaged(sound, tmp_path, lambda points: flank(points, 0.3))
    assert not found.ok
    assert math.isinf(found.measured) or found.measured > 0.1
    assert "unlike the others is at 30.0 deg of gear-pair-crank" in found.message


@pytest.mark.long
def test_a_tooth_that_is_missing_is_named(sound: Path, tmp_path: Path) -> None:
    """Its neighbours carry on, and the wheels fall back between them."""

    def broken(points: Points) -> Points:
        radius = np.abs(points)
        off = np.abs(np.angle(points * np.exp(-2j * math.pi * 5 / TEETH))) < 0.9 * math.pi / TEETH
        return points * np.where(off, radius.min() / radius, 1)

    found = damaged(sound, tmp_path, broken)
    assert not found.ok and found.measured > 0.05
    assert "unlike the others is at 50.0 deg of gear-pair-crank" in found.message


@pytest.mark.long
def test_facets_of_a_sound_pair_fit(tmp_path: Path) -> None:
    """Facets lie inside by as much as they may on all four flanks: play grows, and the fit holds."""
    gear = {"a": "crank", "b": "drum", "ratio": "-12/30", "name": "pair"}
    points = {**SPEC["points"], "C": [63, 0], "B": [73, 0]}  # type: ignore[dict-item]
    spec = {**SPEC, "points": points, "gear": [gear]}
    report = camgen.build(spec, tmp_path, ["stl"])
    assert report.ok, [str(finding) for finding in report.findings if not finding.ok]


@pytest.fixture(scope="module")
def ring(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return drawn(INNER, tmp_path_factory.mktemp("inner"))


@pytest.mark.long
def test_a_sound_ring_turns_evenly_within_its_arcs(ring: Path) -> None:
    found = meshing(ring)
    assert found.ok and 0 < found.measured < found.limit
    assert found.limit == pytest.approx(4 * 0.001, rel=1e-6)


@pytest.mark.long
@pytest.mark.parametrize("by", [-0.02, 0.02])
def test_a_ring_s_flank_that_is_off_is_seen_and_named(
    ring: Path, tmp_path: Path, by: float
) -> None:
    """A space lies on the x axis, so the flank after space 3 of 36 is one of the tooth at 35 deg; one that is missing is borne
    in part by its neighbours."""
    found = damaged(ring, tmp_path, lambda points: flank(points, by), RING)
    assert not found.ok
    assert (0.006 if by > 0 else 0.015) < found.measured < 0.021
    assert "unlike the others is at 35.0 deg of gear-pair-drum" in found.message


@pytest.mark.long
def test_a_ring_beside_its_axis_is_told(ring: Path, tmp_path: Path) -> None:
    """By 10 um: twice that from peak to peak."""
    found = damaged(ring, tmp_path, lambda points: points + 0.01j, RING)
    assert not found.ok and found.measured == pytest.approx(0.02, rel=0.2)
    assert "the teeth of each wheel are alike" in found.message


@pytest.mark.long
@pytest.mark.parametrize(("wheel", "at"), [(PINION, "30.0"), (RING, "55.0")])
def test_a_tooth_that_is_missing_in_a_ring_is_named(
    ring: Path, tmp_path: Path, wheel: str, at: str
) -> None:
    """Tooth 5 of 12, or of 36: cut down to the roots."""
    middle = math.radians(float(at))
    half = 0.9 * math.pi / (12 if wheel == PINION else TEETH)

    def broken(points: Points) -> Points:
        radius = np.abs(points)
        root = radius.min() if wheel == PINION else radius.max()
        off = np.abs(np.angle(points * np.exp(-1j * middle))) < half
        return points * np.where(off, root / radius, 1)

    found = damaged(ring, tmp_path, broken, wheel)
    assert not found.ok and found.measured > 0.05
    assert f"unlike the others is at {at} deg of {wheel[6:-4]}" in found.message
