"""A cam and the shoe on it from their own files: sound, and with either outline off."""

from __future__ import annotations

import math
import shutil
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from judged import move_outline

import camgen
from camgen.errors import SpecError
from camgen.findings import Finding
from camgen.machines.disc_cam.mechanism import DiscCamDrive
from camgen.machines.sources import read_mechanism
from camgen.pipeline.case import Case
from camgen.pipeline.reading import judge_motion, judge_part

# a finger from its pivot, with a round end of 5 and a belly of 9: x, y and bulge of its corners
FINGER = [(-47.2285, -9.4759, 0), (-34.0113, -16.0566, 0.2082), (-26.8516, -16.4314, 0)]
FINGER += [(2.0989, -5.6209, 0.8922), (-0.7941, 5.9472, 0), (-45.6618, -0.044, 0.7395)]
SPEC = """
mechanism = "disc-cam"
name = "finger"
motor = { speed_rpm = 30 }
segment = [
    { kind = "rise", span_deg = 110, lift = 12, law = "modified-sine" },
    { kind = "dwell", span_deg = 60 },
    { kind = "return", span_deg = 120, to = 0, law = "cycloidal" },
    { kind = "dwell" },
]
[geometry]
base_radius = 25
follower = { motion = "oscillating", pivot_distance = 60, outline = "finger.dxf" }
"""


@pytest.fixture(scope="module")
def spec(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("finger")
    drawing = ezdxf.new(units=4)
    drawing.modelspace().add_lwpolyline(FINGER, "xyb", close=True)
    drawing.modelspace().add_circle((0, 0), 2.5)
    drawing.saveas(folder / "finger.dxf")
    (folder / "finger.toml").write_text(SPEC, encoding="utf-8")
    return folder / "finger.toml"


@pytest.fixture(scope="module")
def sound(spec: Path) -> Path:
    report = camgen.build(spec, spec.parent / "out", ["dxf"])
    assert report.ok, [str(finding) for finding in report.findings if not finding.ok]
    return spec.parent / "out" / "finger"


def findings(folder: Path) -> dict[str, Finding]:
    """What the judge says of the motion that the folder's drawings give, by code."""
    case = Case(read_mechanism(folder / "spec.toml"), folder)
    parts = {name: judge_part(case, name, ["dxf"], dimensioned=False)[1] for name in case.parts}
    result = judge_motion(case.mechanism, "dxf", parts, np.linspace(0, math.tau, 361))
    assert result is not None
    return {each.code: each for each in result[0].findings}


@pytest.mark.long
def test_a_shoe_moves_as_the_program_says(sound: Path) -> None:
    error = findings(sound)["MOTION_ERROR"]
    assert error.ok
    assert error.measured < 0.003  # deg: 2 um on an arm of 40 mm


@pytest.mark.long
def test_the_resolved_spec_needs_no_drawing(sound: Path) -> None:
    text = (sound / "spec.toml").read_text(encoding="utf-8")
    assert 'drawn_in = "finger.dxf"' in text
    assert "contours" in text


@pytest.mark.long
@pytest.mark.parametrize("file", ["finger-cam.dxf", "finger-shoe.dxf"])
def test_a_bump_of_20_um_is_told(sound: Path, tmp_path: Path, file: str) -> None:
    shutil.copytree(sound, tmp_path / "finger")
    move_outline(tmp_path / "finger" / file, lambda z: z * (1 + 0.02 / np.abs(z).max()))
    found = findings(tmp_path / "finger")["MOTION_ERROR"]
    assert not found.ok
    # at a lever of some 40 mm
    assert 0.01 < found.measured < 0.05


@pytest.mark.long
@pytest.mark.parametrize(
    ("changed", "key"),
    [
        ("geometry.follower.arm=40", "geometry.follower.arm"),
        ("geometry.closure=conjugate", "geometry.closure"),
        ("parts.make=printed", "parts.make"),
        ("geometry.follower.shape=roller", "geometry.follower.outline - no value here"),
    ],
)
def test_what_an_outline_has_no_use_for_is_a_fault(spec: Path, changed: str, key: str) -> None:
    with pytest.raises(SpecError) as refused:
        read_mechanism(spec, [changed])
    assert key in str(refused.value)


@pytest.mark.long
def test_a_shape_without_its_drawing_is_a_fault(spec: Path) -> None:
    with pytest.raises(SpecError, match="geometry.follower.outline"):
        read_mechanism(spec, ["geometry.follower.outline=", "geometry.follower.shape=outline"])


@pytest.mark.long
def test_the_smallest_cam_for_a_finger_keeps_to_the_limits(spec: Path) -> None:
    """The next smaller one does not, unless its shaft needs the room."""
    smallest = read_mechanism(spec, ["geometry.base_radius="])
    assert isinstance(smallest, DiscCamDrive)
    assert all(each.ok for each in smallest.limits())
    assert smallest.base_radius < 25
