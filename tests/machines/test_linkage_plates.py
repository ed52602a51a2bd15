"""A plate that slides as the cam of a linkage: motion, force and proof against closed forms, and damages of its edge."""

from __future__ import annotations

import copy
import math
import shutil
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
import tomli_w

from camgen.errors import SpecError
from camgen.machines.linkage.mechanism import Linkage
from camgen.pipeline.build import build, check
from camgen.spec import validate

PLATE: dict[str, Any] = {
    "mechanism": "linkage",
    "name": "plate",
    "points": {"S": [0, 0], "R": [100, 0], "P": [20, 0], "B": [60, 30], "C": [10, 30]},
    "links": {"ground": ["S", "R", "C"], "ram": ["P"], "rocker": ["C", "B"]},
    "drive": {"slide": "ram", "speed": 15, "range": [0, 27]},
    "slide": [{"link": "ram", "along": ["S", "R"]}],
    "cam": [
        {
            "cam": "ram",
            "follower": "rocker",
            "at": "B",
            "radius": 4,
            "resistance": 0.5,
            "segment": [
                {"kind": "rise", "span": 15, "lift_deg": 6, "law": "cycloidal"},
                {"kind": "return", "span": 12, "to_deg": 2, "law": "3-4-5"},
            ],
        }
    ],
    "output": [{"name": "tip", "link": "rocker"}],
    "print": {"nozzle": 0.4},
    "load": {"friction": 0.0, "contact_friction": 0.0},
}


def plate(**cam: Any) -> dict[str, Any]:
    data = copy.deepcopy(PLATE)
    data["cam"][0].update(cam)
    return data


def lift(way: np.ndarray) -> np.ndarray:
    """Of the rocker, deg: a cycloid over 15 mm, a 3-4-5 polynomial over the next 12."""
    u = way / 15
    v = np.clip((way - 15) / 12, 0, 1)
    back = v**3 * (10 - 15 * v + 6 * v**2)
    return np.where(way < 15, 6 * (u - np.sin(math.tau * u) / math.tau), 6 - 4 * back)


def test_the_rocker_goes_by_the_way_of_the_plate() -> None:
    way = np.linspace(0, 27, 28)
    run = validate(Linkage, plate()).solve(np.radians(way))
    assert np.degrees(run["tip"] - run["tip"][0]) == pytest.approx(lift(way), abs=1e-9)


def test_half_a_newton_metre_takes_its_slope_of_the_drive() -> None:
    """Half way along a cycloid of 6 deg in 15 mm the slope is 2 h / L, so 0.5 N m take 6.98 N."""
    machine = validate(Linkage, plate()).model
    from camgen.machine.run import solve

    push = solve(machine, np.radians([7.5])).forces().drives["drive"].item()
    assert push == pytest.approx(0.5 * 2 * math.radians(6) / 15e-3, rel=1e-3)


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("plate")
    file = folder / "plate.toml"
    file.write_text(tomli_w.dumps(PLATE), encoding="utf-8")
    report = build(file, folder, frozenset({"dxf", "3mf"}))
    assert report.ok, [finding for finding in report.findings if not finding.ok]
    codes = {finding.code for finding in report.findings}
    assert {"MOTION_ERROR", "SPEED_RIPPLE", "INTERFERENCE", "HERTZ", "LIFT_OFF"} <= codes
    return folder / "plate"


def test_its_files_move_the_rocker_as_asked(built: Path) -> None:
    rows = np.loadtxt(built / "motion.csv", delimiter=",", skiprows=1)
    for column in rows.T[1:]:
        moved = column - rows[0, 1]
        assert moved == pytest.approx(lift(rows[:, 0]), abs=1.6e-3)


@pytest.mark.parametrize("micrometres", [20, -20])
def test_an_edge_that_is_20_um_off_moves_the_rocker_by_it(
    built: Path, tmp_path: Path, micrometres: int
) -> None:
    """On the top of the lift: 0.02 mm at 50 mm from the axle, 0.0229 deg, over the cosine of 6 deg."""
    folder = tmp_path / "plate"
    shutil.copytree(built, folder)
    (file,) = folder.rglob("plate-ram.dxf")
    drawing = ezdxf.readfile(file)
    (outline,) = drawing.modelspace().query("LWPOLYLINE")
    rows = outline.get_points("xyseb")
    highest = max(row[1] for row in rows)
    outline.set_points(
        [(x, y + micrometres * 1e-3 * (y > highest - 2), *rest) for x, y, *rest in rows],
        format="xyseb",
    )
    drawing.saveas(file)
    report = check(folder)
    errors = [each for each in report.findings if each.code == "MOTION_ERROR" and not each.ok]
    assert len(errors) == 1 and errors[0].where.file == "plate-*.dxf"
    top = math.degrees(0.02 / (50 * math.cos(math.radians(6))))
    assert errors[0].measured == pytest.approx(top, rel=0.1)


@pytest.mark.parametrize(
    ("cam", "key"),
    [
        ({"shape": "flat", "radius": None}, "cam.0.shape"),
        ({"closure": "groove"}, "cam.0.closure"),
        ({"base_radius": 20}, "cam.0.base_radius"),
        ({"spring": {}}, "cam.0.spring"),
        ({"segment": [{"kind": "rise", "span_deg": 27, "lift_deg": 6}]}, "cam.0.segment.0.span"),
        ({"segment": [{"kind": "rise", "span": 20, "lift_deg": 6}]}, "drive.range"),
    ],
)
def test_what_does_not_go_with_a_plate_is_told_by_its_key(cam: dict[str, Any], key: str) -> None:
    data = plate(**cam)
    data["cam"][0] = {name: value for name, value in data["cam"][0].items() if value is not None}
    with pytest.raises(SpecError) as caught:
        validate(Linkage, data)
    assert key in {fault.key for fault in caught.value.faults}
