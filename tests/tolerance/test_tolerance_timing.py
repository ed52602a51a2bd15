"""How far a looper's timing may be off: at the angle that is told its bodies touch, measured by another route."""

from __future__ import annotations

import importlib
import math
from pathlib import Path

import numpy as np
import pytest
import shapely
import shapely.affinity

from camgen.geometry.mesh import slice_mesh
from camgen.machines.sources import read_mechanism
from camgen.parts.solids import solid
from camgen.tolerance.report import tolerance
from camgen.tolerance.timing import Timing, timings

LOOPER = Path(__file__).resolve().parents[2] / "specs" / "chain-stitch-looper.toml"


@pytest.fixture(scope="module")
def found() -> dict[str, Timing]:
    return {each.pair: each for each in timings(read_mechanism(LOOPER, ()))}


def test_needles_and_spreaders_touch_at_the_angle_that_is_told(found: dict[str, Timing]) -> None:
    """Outlines moved and measured by shapely's own distance."""
    machine, each = read_mechanism(LOOPER, ()), found["N2/P2"]
    parts = {part.name: part for part in machine.assembly.parts}
    rest, theta = machine.assembly.poses(np.zeros(1)), np.linspace(0, math.tau, 721)
    faces = {}
    for name in ("upper-spreader", "needle-2"):
        rings = slice_mesh(solid(parts[name], 0.01), -rest[name][0].z)
        faces[name] = shapely.union_all(
            [shapely.Polygon(np.column_stack([r.points.real, r.points.imag])) for r in rings]
        )

    def nearest(later: float) -> float:
        a, b = (
            machine.assembly.poses(theta - later)["upper-spreader"][0].place,
            machine.assembly.poses(theta)["needle-2"][0].place,
        )
        close = np.argsort(np.abs(b - a))[::3]
        return min(
            shapely.affinity.translate(faces["needle-2"], z.real, z.imag).distance(
                faces["upper-spreader"]
            )
            for z in (b - a)[close]
        )

    assert nearest(0.0) == pytest.approx(each.least, abs=0.02)
    assert nearest(each.exact[1]) < 0.03 < nearest(0.7 * each.exact[1])
    assert nearest(each.loose[1]) == pytest.approx(each.play, abs=0.03)


def test_play_takes_of_the_timing_and_spreaders_keep_together(found: dict[str, Timing]) -> None:
    assert set(found) == {"N1/P1", "N2/P1", "N2/P2", "N1/P2"}  # P1 and P2 move by one law
    for each in found.values():
        assert 0 < each.play and all(
            0 < loose < exact for loose, exact in zip(each.loose, each.exact, strict=True)
        )


def test_tolerance_of_a_looper_tells_its_timing(
    found: dict[str, Timing], monkeypatch: pytest.MonkeyPatch
) -> None:
    module = importlib.import_module("camgen.tolerance.report")
    monkeypatch.setattr(module, "timings", lambda mechanism: list(found.values()))
    told = tolerance(LOOPER)
    assert told.numbers["timing_tolerance_deg"] == pytest.approx(
        math.degrees(min(found["N2/P2"].loose))
    )
    assert told.tables[0].title.startswith("Timing") and len(told.tables[0].rows) == 4
