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

from camgen.errors import DesignError, SpecError
from camgen.machines.linkage.mechanism import Linkage
from camgen.parts.generator.stacking import lacking
from camgen.pipeline.build import build, check
from camgen.spec import validate
from camgen.tolerance.report import PrintRun, tolerance

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


@pytest.mark.long
def test_its_files_move_the_rocker_as_asked(built: Path) -> None:
    rows = np.loadtxt(built / "motion.csv", delimiter=",", skiprows=1)
    for column in rows.T[1:]:
        moved = column - rows[0, 1]
        assert moved == pytest.approx(lift(rows[:, 0]), abs=1.6e-3)


@pytest.mark.long
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
        ({"shape": "knife", "radius": None}, "cam.0.shape"),
        ({"polydyne": True}, "cam.0.polydyne"),
        ({"segment": [{"kind": "rise", "span": 27}]}, "cam.0.segment.0.lift_deg"),
        ({"segment": [{"kind": "rise", "span": 27, "lift": 6}]}, "cam.0.segment.0.lift"),
        (
            {"segment": [{"kind": "rise", "span": 27, "lift_deg": 6, "task": "RR"}]},
            "cam.0.segment.0.task",
        ),
        (
            {"segment": [{"kind": "rise", "span": 27, "lift_deg": 6, "at_deg": 90}]},
            "cam.0.segment.0.at_deg",
        ),
        (
            {"segment": [{"kind": "rise", "span": 27, "lift_deg": 6, "law": "sinus"}]},
            "cam.0.segment.0.law",
        ),
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


def test_a_span_of_a_disc_is_told() -> None:
    data = plate()
    data["points"]["O"] = [30, 0]
    data["links"]["ground"].append("O")
    data["links"]["ram"].append("O")
    del data["slide"]
    data["drive"] = {"link": "ram", "speed_rpm": 15}
    with pytest.raises(SpecError) as caught:
        validate(Linkage, data)
    assert "cam.0.segment.0.span" in {fault.key for fault in caught.value.faults}


def lifter(span: float, **limits: float) -> Linkage:
    """A head that slides square to the way of its plate, 6 mm by a cycloid."""
    data = plate(follower="head", at="H", segment=[{"kind": "rise", "span": span, "lift": 6}])
    data["cam"][0]["segment"][0]["law"] = "cycloidal"
    data["points"] = {"S": [0, 0], "R": [100, 0], "P": [20, 0], "H": [60, 30]}
    data["points"] |= {"T": [60, 50], "U": [60, 70]}
    data["links"] = {"ground": ["S", "R", "T", "U"], "ram": ["P"], "head": ["H"]}
    data["slide"].append({"link": "head", "along": ["T", "U"]})
    data["output"] = [{"name": "tip", "link": "head"}]
    data["drive"]["range"] = [0, span]
    data["limits"] = limits
    return validate(Linkage, data)


def test_pressure_angle_and_radius_of_an_edge_are_judged_as_designed() -> None:
    """tan(alpha) = s' of a slide, 2 h / L at most of a cycloid; the radius is (1 + s'^2)^1.5 / |s''| less the roller's."""
    found = {each.code: each for each in lifter(27).limits()}
    assert found["PRESSURE_ANGLE"].measured == pytest.approx(math.degrees(math.atan(12 / 27)))
    u = np.linspace(0.5, 1, 200001)[1:-1]
    slope = 6 / 27 * (1 - np.cos(math.tau * u))
    bend = 6 / 27**2 * math.tau * np.sin(math.tau * u)
    least = np.min((1 + slope**2) ** 1.5 / np.abs(bend)) - 4
    assert found["CURVATURE"].measured == pytest.approx(least, rel=1e-6)
    assert found["PRESSURE_ANGLE"].ok and found["CURVATURE"].ok


def test_limits_of_an_edge_fail() -> None:
    found = {
        each.code: each for each in lifter(27, pressure_angle_deg=20, least_radius=25).limits()
    }
    assert not found["PRESSURE_ANGLE"].ok and not found["CURVATURE"].ok


def pair(apart: float = 30.0) -> dict[str, Any]:
    """A rocker on either side of the plate, mirrored."""
    data = plate()
    data["points"] |= {"C": [10, apart], "B": [60, apart], "D": [10, -apart], "E": [60, -apart]}
    data["links"]["ground"].append("D")
    data["links"]["under"] = ["D", "E"]
    data["cam"].append({**data["cam"][0], "follower": "under", "at": "E"})
    data["output"].append({"name": "mirrored", "link": "under"})
    return data


@pytest.mark.long
def test_a_plate_has_a_track_on_either_side(tmp_path: Path) -> None:
    """An edge that is off moves its own follower alone."""
    file = tmp_path / "pair.toml"
    file.write_text(tomli_w.dumps({**pair(), "name": "pair"}), encoding="utf-8")
    report = build(file, tmp_path, frozenset({"dxf"}))
    assert report.ok, [finding for finding in report.findings if not finding.ok]
    rows = np.loadtxt(tmp_path / "pair/motion.csv", delimiter=",", skiprows=1)
    for column, sense in ((rows[:, 1], 1), (rows[:, 3], -1)):
        assert column - column[0] == pytest.approx(sense * lift(rows[:, 0]), abs=1.6e-3)
    (drawn,) = (tmp_path / "pair").rglob("pair-ram.dxf")
    drawing = ezdxf.readfile(drawn)
    (outline,) = drawing.modelspace().query("LWPOLYLINE")
    corners = outline.get_points("xyseb")
    lowest = min(row[1] for row in corners)
    outline.set_points(
        [(x, y - 0.02 * (y < lowest + 2), *rest) for x, y, *rest in corners], format="xyseb"
    )
    drawing.saveas(drawn)
    errors = {
        each.message.split(":")[0]: each.ok
        for each in check(tmp_path / "pair").findings
        if each.code == "MOTION_ERROR"
    }
    assert errors == {"mirrored": False}


def test_tracks_that_are_no_plate_are_refused() -> None:
    data = pair(6)
    with pytest.raises(DesignError, match="thickness of the plate") as caught:
        validate(Linkage, data).assembly  # noqa: B018
    assert caught.value.unit == "mm"
    data = pair()
    data["points"] |= {"D": [90, 30], "E": [140, 30]}
    with pytest.raises(DesignError, match="tracks on one side of a plate"):
        validate(Linkage, data).assembly  # noqa: B018


def test_a_roller_without_a_wall_is_refused_with_a_radius_that_has_one() -> None:
    """Half of pin and play, and a wall of 0.8 mm; told to 0.01 mm."""
    machine = validate(Linkage, plate(radius=2.0))
    layout = machine.construction.layout
    least = (layout.sizes.pin_diameter + layout.fits.slide_clearance) / 2 + 0.8
    with pytest.raises(DesignError, match="its radius at least") as caught:
        machine.assembly  # noqa: B018
    assert caught.value.value == pytest.approx(2.0 - least + 0.8)
    told = float(str(caught.value).split("its radius at least ")[1].split(",")[0])
    assert least <= told <= least + 0.01 + 1e-9
    assert validate(Linkage, plate(radius=told)).assembly.parts
    thin = float(str(caught.value).split("parts.pin_diameter at most ")[1])
    assert thin == 2.1  # under 2 x (2 - 0.8) less the play of 0.2
    thinner = {**PLATE.get("parts", {}), "pin_diameter": thin}
    slim = validate(Linkage, {**plate(radius=2.0), "parts": thinner})
    assert lacking(slim.construction.layout) is None
    with pytest.raises(DesignError, match="wall round the pin"):
        validate(Linkage, plate(radius=told - 0.02)).assembly  # noqa: B018


def test_what_follows_from_print_errors_is_told_of_a_plate() -> None:
    notes = tolerance(PLATE, printing=PrintRun(samples=50, worst=0)).notes
    assert any(note.startswith("For a plate that slides a turn") for note in notes)
