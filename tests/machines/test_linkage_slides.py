"""A slide that drives a linkage: against the triangle of its links, from the files, and what does not go with it."""

from __future__ import annotations

import copy
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w

from camgen.errors import DesignError, SpecError
from camgen.machine.model import Torque
from camgen.machine.run import solve
from camgen.machines.linkage.mechanism import Linkage
from camgen.machines.loads.assess import assess
from camgen.pipeline.build import build, check
from camgen.spec import validate

LIFT: dict[str, Any] = {
    "mechanism": "linkage",
    "name": "lift",
    "points": {"S": [0, 0], "R": [100, 0], "P": [20, 0], "B": [60, 50], "C": [90, 0]},
    "links": {"ground": ["S", "R", "C"], "ram": ["P"], "rod": ["P", "B"], "rocker": ["C", "B"]},
    "drive": {"slide": "ram", "speed": 15, "range": [-15, 12]},
    "slide": [{"link": "ram", "along": ["S", "R"]}],
    "output": [{"name": "tip", "link": "rocker"}],
    "print": {"nozzle": 0.4},
    "load": {"friction": 0.0},
}
ROD = math.hypot(40, 50)
ROCKER = math.hypot(30, 50)


def lift(**tables: Any) -> Linkage:
    data = copy.deepcopy(LIFT)
    for name, keys in tables.items():
        data[name] = {**data.get(name, {}), **keys} if isinstance(keys, dict) else keys
    return validate(Linkage, data)


def angle(way: np.ndarray) -> np.ndarray:
    """Of the rocker, rad, by the triangle of ram, rod and rocker."""
    base = 70 - way
    return math.pi - np.arccos((ROCKER**2 + base**2 - ROD**2) / (2 * ROCKER * base))


def test_a_ram_moves_the_rocker_of_its_triangle() -> None:
    way = np.linspace(-15, 12, 28)
    run = lift().solve(np.radians(way))
    assert run["tip"] == pytest.approx(angle(way), abs=1e-9)
    slope = (angle(way + 1e-4) - angle(way - 1e-4)) / 2e-4
    assert run.velocity["tip"] == pytest.approx(15 * slope, rel=1e-6)


def test_the_ram_pushes_what_the_rocker_asks() -> None:
    """1 N m on the rocker takes dangle/dway N m/mm of the ram, so a thousand times that in N."""
    machine = lift().model
    still = tuple(type(body)(body.name, body.points) for body in machine.bodies)
    bent = type(machine)(
        still,
        machine.joints,
        machine.drives,
        machine.start,
        (Torque("load", "rocker", 1.0),),
        machine.outputs,
        machine.speed,
    )
    way = np.linspace(-10, 10, 9)
    pushes = solve(bent, np.radians(way)).forces().drives["drive"]
    slope = (angle(way + 1e-4) - angle(way - 1e-4)) / 2e-4
    assert pushes == pytest.approx(-1e3 * slope, rel=1e-6)


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("lift")
    file = folder / "lift.toml"
    file.write_text(tomli_w.dumps(LIFT), encoding="utf-8")
    report = build(file, folder, frozenset({"dxf", "3mf"}))
    assert report.ok, [finding for finding in report.findings if not finding.ok]
    return folder / "lift"


@pytest.mark.long
def test_its_files_move_as_it_does(built: Path) -> None:
    header = (built / "motion.csv").read_text(encoding="utf-8").splitlines()[0]
    assert header == "theta_mm,tip_deg,tip_deg_dxf,tip_deg_3mf"
    rows = np.loadtxt(built / "motion.csv", delimiter=",", skiprows=1)
    assert rows[[0, 1, -1], 0] == pytest.approx([-15, -14.75, 12])
    for column in rows.T[1:]:
        assert column == pytest.approx(np.degrees(angle(rows[:, 0])), abs=1e-4)
    assert not list(built.glob("*shaft*")) and list(built.glob("lift-ram.*"))
    assert "linear, 27 mm at 15 mm/s" in (built / "lift-parts.csv").read_text(encoding="utf-8")


@pytest.mark.long
def test_a_damaged_file_is_told_by_its_place_in_mm(built: Path, tmp_path: Path) -> None:
    import shutil

    import ezdxf

    folder = tmp_path / "lift"
    shutil.copytree(built, folder)
    (rod,) = folder.rglob("lift-rod.dxf")
    drawing = ezdxf.readfile(rod)
    hole = max(drawing.modelspace().query("CIRCLE"), key=lambda each: abs(each.dxf.center))
    hole.dxf.center += (0.2, 0, 0)
    drawing.saveas(rod)
    failing = {f.code: str(f.where) for f in check(folder).findings if not f.ok}
    assert "MOTION_ERROR" in failing
    assert "travel of the drive" in failing["MOTION_ERROR"] and " mm" in failing["MOTION_ERROR"]


def test_figures_are_of_a_force() -> None:
    numbers = assess(lift()).study.numbers
    assert {"drive_force_n", "drive_power_w"} <= numbers.keys()
    assert "drive_torque_n_m" not in numbers
    assert "peak_force_n" in lift().study().numbers


def test_marks_of_a_path_and_notes_are_of_a_way() -> None:
    """27 mm in 24 steps."""
    path = {"name": "top", "point": "B"}
    study = lift(output=[path]).study()
    (plot,) = (each for each in study.plots if each.title.startswith("Path"))
    assert plot.dots == ("every 1.125 mm", "wanted")
    assert any("all speeds are for a constant speed of the drive" in note for note in study.notes)


def test_targets_are_told_in_mm_of_the_way() -> None:
    rocker = {"name": "tip", "link": "rocker"}
    pin = {"name": "top", "point": "B"}
    for output, said in (
        ({**rocker, "dwell": {"span_deg": 5, "band": 1}}, r"from 6\.04 mm"),
        ({**rocker, "function": {"at": [[0, 0], [10, 3]], "tolerance": 9}}, "at theta 10 mm"),
        ({**pin, "points": {"at": [[60, 50]], "theta_deg": [3], "tolerance": 5}}, r"3\.00 mm"),
        ({**pin, "straightness": {"range_deg": [0, 9], "tolerance": 5}}, "from 0 to 9 mm"),
    ):
        found = next(each for each in lift(output=[output]).limits())
        assert re.search(said, found.message), found
        assert found.code != "DWELL" or found.unit == "mm"


def test_what_does_not_slide_on_the_ground_does_not_drive() -> None:
    for tables, key in (
        ({"drive": {"slide": "rod"}}, "drive.slide"),
        ({"drive": {"slide": "none"}}, "drive.slide"),
        ({"drive": {"range": [12, -15]}}, "drive.range"),
        ({"drive": {"link": "rocker"}}, "drive.link"),
        ({"motor": {"torque_n_m": 1.0}}, "motor"),
        ({"parts": {"hand_crank": 20.0}}, "parts.hand_crank"),
        ({"parts": {"shaft": "interrupted"}}, "parts.shaft"),
        ({"parts": {"motor": "nema-17"}}, "parts.motor"),
        ({"counterweight": {}}, "counterweight"),
    ):
        with pytest.raises(SpecError) as caught:
            lift(**tables)
        assert key in {fault.key for fault in caught.value.faults}, key


def test_a_key_of_the_other_drive_is_told_with_the_nearest_of_this_one() -> None:
    for drive, key, nearest in (
        ({"link": "ram", "speed": 15}, "speed", "speed_rpm"),
        ({**LIFT["drive"], "speed_rpm": 15}, "speed_rpm", "speed"),
    ):
        with pytest.raises(SpecError) as caught:
            validate(Linkage, {**copy.deepcopy(LIFT), "drive": drive})
        fault = next(each for each in caught.value.faults if each.key == f"drive.{key}")
        assert fault.nearest == nearest


def rocked(**tables: Any) -> Linkage:
    """The same chain with a rocker that drives."""
    data = {**copy.deepcopy(LIFT), **tables}
    data["drive"] = {"link": "rocker", "speed_rpm": 15, "range_deg": [0, 5]}
    return validate(Linkage, data)


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("along", [["S", "R"], ["R", "S"]])
def test_a_cam_that_slides_and_does_not_drive_is_told_what_makes_it(
    side: int, along: list[str]
) -> None:
    """Arm and angle of the linear cam are those of the rocker C-B, from the plate's way up, on whichever side it lies."""
    rise = [{"kind": "rise", "span_deg": 180, "lift_deg": 5}, {"kind": "return", "to_deg": 0}]
    cam = {"cam": "ram", "follower": "rocker", "at": "B", "radius": 4, "segment": rise}
    points = {**LIFT["points"], "B": [60, side * 50]}
    slide = [{"link": "ram", "along": along}]
    with pytest.raises(SpecError, match=r"a \[\[slot\]\] for the pin B") as caught:
        rocked(cam=[cam], points=points, slide=slide)
    said = str(caught.value)
    assert 'mechanism = "linear-cam"' in said and 'link = "rocker" runs' in said
    assert '[drive] slide = "ram"' in said
    angle = math.degrees(math.acos(30 / ROCKER))
    assert f"arm = {ROCKER:.4g}, start_deg = {angle:.4g} " in said


def test_a_cam_that_slides_below_a_follower_that_slides_is_told_the_other_mechanism() -> None:
    rise = [{"kind": "rise", "span_deg": 180, "lift": 5}, {"kind": "return", "to": 0}]
    cam = {"cam": "ram", "follower": "head", "at": "H", "radius": 4, "segment": rise}
    points = {**LIFT["points"], "H": [60, 30], "T": [60, 60]}
    links = {**LIFT["links"], "head": ["H"], "ground": ["S", "R", "C", "T"]}
    slides = [*LIFT["slide"], {"link": "head", "along": ["T", "H"]}]
    with pytest.raises(SpecError, match="linear-cam") as caught:
        rocked(cam=[cam], points=points, links=links, slide=slides)
    assert "start_deg" not in str(caught.value)


def test_a_range_beyond_the_chain_is_told_in_mm() -> None:
    """Rod and rocker are in line where the ram is both their lengths from C."""
    furthest = 70 - ROD - ROCKER
    with pytest.raises(DesignError, match=r"drive\.range goes from -60 to 12 mm") as caught:
        lift(drive={"range": [-60, 12]}).model  # noqa: B018
    assert caught.value.limit == pytest.approx(furthest, abs=1e-4)
    assert caught.value.unit == "mm"
