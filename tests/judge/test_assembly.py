"""The written assembly of every machine, swept: free as designed, and a part 1 mm out of its place is named."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from camgen.files.threemf import Placed, placing, read_3mf, write_3mf
from camgen.findings import Finding
from camgen.geometry.mesh import Mesh
from camgen.geometry.rings import Floats
from camgen.judge.assembly import sweep
from camgen.machine.model import Pose
from camgen.machines.mechanism import Mechanism
from camgen.parts.solids import solid
from camgen.pipeline import build as pipeline

# The stitch whose needles slide along the spreaders.
SLIDING = (
    "geometry.plate_to_spreader=7", "geometry.velocity_ratio=0.9142857", "geometry.blade_length=34", "geometry.p6_setback=0",
    "limits.clearance=0",
)  # fmt: skip
SPECS = Path(__file__).resolve().parents[2] / "specs"


@cache
def machine(name: str, *settings: str) -> Mechanism:
    return pipeline.read_mechanism(SPECS / f"{name}.toml", ["accuracy.chord_tolerance=0.005", *settings])


@cache
def solids(name: str, *settings: str) -> Mapping[str, Mesh]:
    found = machine(name, *settings)
    return {part.name: solid(part, found.accuracy.chord_tolerance) for part in found.parts()}


def swept(path: Path, name: str, *settings: str, **shifts: complex) -> list[Finding]:
    """Findings of a machine's assembly in which copies are shifted, mm."""
    found, items = machine(name, *settings), []
    start = found.poses(np.zeros(1))
    for part in found.parts():
        for k, pose in enumerate(start[part.name]):
            copy = f"{part.name}-{k + 1}"
            at = complex(pose.place[0]) + shifts.get(copy.replace("-", "_"), 0j)
            items.append(Placed(part.name, copy, placing(float(pose.angle[0]), at, pose.z, part.thickness, pose.flipped)))
    write_3mf(path, dict(solids(name, *settings)), items, "key")
    return sweep(path, found.moved())[0]


@pytest.mark.parametrize("name", sorted({path.stem for path in SPECS.glob("*.toml")} - {"uniform-swing", "four-leg-walker"}))
def test_free_as_designed(tmp_path: Path, name: str) -> None:
    coarse = ("accuracy.chord_tolerance=0.02",) if name == "stitch-head" else ()  # a tenth of its joints' air
    findings = swept(tmp_path / "x.3mf", name, *coarse)
    assert [f"{f.code} {f.where}" for f in findings if not f.ok] == []
    assert "INTERFERENCE" in {f.code for f in findings}


@pytest.mark.parametrize("name, shifted, by, pair", [
    ("thread-take-up", "guide_1", -1, "bell-crank-1 and guide-1"),
    ("thread-take-up", "output_crank_1", 1j, "pivot-1 and output-crank-1"),
    ("thread-take-up", "dowel_2", 1, "frame-1 and dowel-2"),  # fixed: it never moves as the frame sees it
    ("eccentric-drive", "rod_1", 1, "disc-1 and rod-1"),
    ("eccentric-drive", "slider_1", 1j, "body-1 and slider-1"),
    ("chain-stitch-looper", "lower_spreader_1", 1j, "lower-spreader-1 and upper-spreader-1"),
    ("chain-stitch-looper", "upper_spreader_1", -1, "upper-spreader-1 and needle-2-1"),
    ("chain-stitch-looper", "needle_1_1", 1, "needle-1-1 and needle-plate-1"),
    ("disc-cam", "cam_1", -1, "cam-1 and tip on cam-1"),
    ("indexing-cam", "return_cam_1", 1, "return-cam-1 and tip on return-cam-1"),
])  # fmt: skip
def test_a_part_out_of_its_place_is_named(tmp_path: Path, name: str, shifted: str, by: complex, pair: str) -> None:
    close = SLIDING if name == "chain-stitch-looper" else ()
    failed = [f for f in swept(tmp_path / "x.3mf", name, *close, **{shifted: by}) if not f.ok]
    assert {f.code for f in failed} == {"INTERFERENCE"}
    angle = "cam angle" if "cam" in name else "crank angle"
    assert any(f.where.startswith(f"{pair}: ") and angle in f.where for f in failed), [f.where for f in failed]


def test_a_body_that_is_flat_is_named(tmp_path: Path) -> None:
    """It meets nothing, so that it would count as clear of all."""
    path, whole = tmp_path / "x.3mf", machine("eccentric-drive")
    swept(path, "eccentric-drive")
    package = read_3mf(path)
    items = [Placed(item.name, f"{item.name}-{k}", item.transform) for k, item in enumerate(package.items)]
    meshes = {name: mesh.moved(np.diag([1.0, 1, name != "rod", 0])[:3]) for name, mesh in package.meshes.items()}
    write_3mf(path, meshes, items, "key")
    failed = [f for f in sweep(path, whole.moved())[0] if not f.ok]
    assert [(f.code, f.message) for f in failed] == [("INTERFERENCE", "cannot be judged: rod-1 has no volume")]


def test_fits_without_air_may_touch(tmp_path: Path) -> None:
    """With hardly any clearance in the spec, joints touch; a part 1 mm off is still found."""
    tight = "print.slide_clearance=0.02"
    assert machine("eccentric-drive", tight).running_gap == 0
    assert all(f.ok for f in swept(tmp_path / "x.3mf", "eccentric-drive", tight))
    assert not all(f.ok for f in swept(tmp_path / "x.3mf", "eccentric-drive", tight, slider_1=1j))


@pytest.mark.parametrize("jump, said", [(0.0, ""), (1.0, "faster than its course")])
def test_a_motion_that_jumps_is_told(tmp_path: Path, jump: float, said: str) -> None:
    """A body that is elsewhere wherever it is looked at between the angles of the grid."""
    whole, step = machine("eccentric-drive").moved(), np.pi / 1800

    def jumpy(theta: Floats) -> Mapping[str, Pose]:
        off = 40 * jump * np.sin(5 * theta) * (np.abs(theta / step - np.round(theta / step)) > 1e-6)
        found = dict(whole.courses(theta))
        return found | {"slider": replace(found["slider"], place=found["slider"].place + off)}

    swept(tmp_path / "x.3mf", "eccentric-drive")
    failed = [f for f in sweep(tmp_path / "x.3mf", replace(whole, courses=jumpy))[0] if not f.ok]
    assert [(f.code, said in f.message) for f in failed] == ([("INTERFERENCE", True)] if jump else [])


def test_a_tube_beside_its_needle_is_struck(tmp_path: Path) -> None:
    findings = swept(tmp_path / "x.3mf", "eccentric-drive", needle_tube_1=0.15j)
    assert any(not f.ok and "needle-tube-1" in f.where and "needle" in f.where for f in findings)
