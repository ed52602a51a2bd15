"""Several motors of one linkage: a five-bar against its two circles, by a route of the tests' own; parts for each motor."""

from __future__ import annotations

import copy
import math
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import camgen
from camgen import starters
from camgen.errors import DesignError, FileError, SpecError
from camgen.files.grbl import GrblProgram, read_grbl
from camgen.files.servo import read_cam_table
from camgen.machines.follower_motions import FollowerMotion, table_finding, table_motions
from camgen.machines.linkage import pens
from camgen.machines.linkage.mechanism import Linkage
from camgen.machines.loads.assess import assess
from camgen.machines.sources import read_mechanism
from camgen.parts.assembly import order_of_assembly
from camgen.pipeline.making import parts_table
from camgen.pipeline.shopping import steps_of_assembly
from camgen.spec import validate

Tables = dict[str, Any]
O, C, ARM, ROD = -35 + 0j, 35 + 0j, 50.0, 80.0  # noqa: E741
LAW = {"law": "cycloidal"}


def star() -> Tables:
    return tomllib.loads(starters.text("five-bar"))


def tables() -> Tables:
    """The five-bar of the gallery, its pen where both rods meet, with programs in place of a line."""
    spec = star()
    del spec["pen"]
    spec["links"]["left_rod"] = ["A", "P"]
    for key in ("P-Q", "A-Q"):
        del spec["lengths"][key]
    del spec["points"]["Q"]
    spec["output"][0]["point"] = "P"
    return swing(spec, -30, 15)


def swing(spec: Tables, left: float, right: float) -> Tables:
    """With both arms there and back, deg."""
    for drive, peak in zip(spec["drive"], (left, right), strict=True):
        drive["segment"] = [
            {"span_deg": 180, "to_deg": peak, **LAW},
            {"span_deg": 180, "to_deg": 0, **LAW},
        ]
    return spec


def cycloid(u: np.ndarray) -> np.ndarray:
    return u - np.sin(math.tau * u) / math.tau


def swung(theta: np.ndarray, peak: float) -> np.ndarray:
    """Out by a cycloid in the first half of the period, back by one in the second, rad."""
    u = theta / math.pi
    return math.radians(peak) * np.where(u < 1, cycloid(u), 1 - cycloid(u - 1))


def apex(a: np.ndarray, b: np.ndarray, radius: float) -> np.ndarray:
    """Where circles of one radius about a and b meet, left of the way from b to a's mirror image: above, as drawn."""
    half = (b - a) / 2
    height = np.sqrt(radius**2 - np.abs(half) ** 2)
    return (a + b) / 2 + 1j * half / np.abs(half) * height


@settings(max_examples=25, deadline=None)
@given(st.floats(-35, -5), st.floats(5, 35))
def test_the_pen_is_where_two_circles_meet(left: float, right: float) -> None:
    machine = camgen.load(swing(tables(), left, right))
    theta = np.linspace(0, math.tau, 181)
    drawn = math.atan2(40, 30)
    a = O + ARM * np.exp(1j * (math.pi - drawn + swung(theta, left)))
    b = C + ARM * np.exp(1j * (drawn + swung(theta, right)))
    assert np.max(np.abs(machine.solve(theta)["pen"] - apex(a, b, ROD))) < 1e-9


def test_another_motor_that_turns_evenly_makes_whole_turns_of_its_own() -> None:
    """Cam plus motor: one arm swings by its program while a crank turns three times, against the first one's sense."""
    spec = tables()
    spec["lengths"] |= {"O-A": 8}
    spec["points"]["A"] = [-43, 0]
    spec["drive"][0] = {"link": "left", "speed_rpm": 10}
    spec["drive"][1] = {"link": "right", "speed_rpm": -30}
    spec["lengths"] |= {"C-B": 8}
    spec["points"] |= {"B": [43, 0], "P": [0, 67]}
    theta = np.linspace(0, math.tau, 181)
    a = O - 8 * np.exp(1j * theta)
    b = C + 8 * np.exp(-3j * theta)
    pen = camgen.load(spec).solve(theta)["pen"]
    assert np.max(np.abs(pen - apex(a, b, ROD))) < 1e-9


def test_one_drive_is_the_same_record_in_either_writing() -> None:
    spec = tomllib.loads(starters.text("four-bar"))
    listed = {**spec, "drive": [spec["drive"]]}
    theta = np.linspace(0, math.tau, 25)
    one, other = camgen.load(spec), camgen.load(listed)
    assert one.drive == other.drive  # type: ignore[attr-defined]
    assert np.array_equal(one.solve(theta)["foot"], other.solve(theta)["foot"])


def drive(spec: Tables, k: int, **changes: Any) -> None:
    spec["drive"][k] |= changes


@pytest.mark.parametrize(
    ("change", "path", "words"),
    [
        (lambda e: drive(e, 1, link="left"), ("drive", 1, "link"), "drive.0 already turns left"),
        (lambda e: drive(e, 1, link="rihgt"), ("drive", 1, "link"), "right"),
        (lambda e: drive(e, 1, link="left_rod"), ("drive", 1, "link"), "shares a point"),
        (lambda e: drive(e, 1, speed_rpm=12), ("drive", 1, "speed_rpm"), "4, the same as drive.0"),
        (
            lambda e: drive(e, 1, segment=[], speed_rpm=6),
            ("drive", 1, "speed_rpm"),
            "whole multiple of drive.0's 4",
        ),
        (lambda e: drive(e, 1, segment=[], range_deg=[0, 9]), ("drive", 1, "range_deg"), "segment"),
        (lambda e: drive(e, 0, speed_rpm=-10), ("drive", 0, "speed_rpm"), "above 0"),
        (lambda e: e.update(drive=[]), ("drive",), "a table [drive]"),
        (
            lambda e: e["parts"].update(sides=2, plates=2),
            ("parts", "sides"),
            "this one has several",
        ),
        (lambda e: e.update(counterweight={}), ("counterweight",), "this one has several"),
    ],
)
def test_faults_say_where_and_what(
    change: Callable[[Tables], None], path: tuple[str | int, ...], words: str
) -> None:
    spec = copy.deepcopy(tables())
    change(spec)
    with pytest.raises(SpecError) as caught:
        camgen.load(spec)
    found = [each for each in caught.value.faults if tuple(each.path) == path]
    assert any(words in f"{fault.expected} {fault.nearest}" for fault in found)


def test_a_program_out_of_reach_is_told_by_angle_and_shortfall() -> None:
    """The arms open outwards until the rods, 160 mm, no longer span them."""
    theta = np.linspace(0, math.tau, 721)
    drawn = math.atan2(40, 30)
    a = O + ARM * np.exp(1j * (math.pi - drawn + swung(theta, 40)))
    b = C + ARM * np.exp(1j * (drawn + swung(theta, -40)))
    short = np.abs(b - a) - 2 * ROD
    first = math.degrees(theta[np.argmax(short > 0)])
    with pytest.raises(DesignError) as caught:
        assert camgen.load(swing(tables(), 40, -40)).model
    said = caught.value
    assert said.value == pytest.approx(short.max(), abs=1e-9) and said.unit == "mm"
    assert f"from {first:.4g} deg" in said.sentence and "180 deg" in said.sentence


def test_as_many_drives_as_there_are_degrees_of_freedom() -> None:
    few = {**tables(), "drive": {"link": "left"}}
    with pytest.raises(DesignError, match=r"1 degree of freedom left over.*drive one of them"):
        assert camgen.load(few).model
    four_bar = tomllib.loads(starters.text("four-bar"))
    many = {**four_bar, "drive": [four_bar["drive"], {"link": "rocker"}], "parts": {}}
    with pytest.raises(DesignError, match="2 drives for 1 degree of freedom"):
        assert camgen.load(many).model


@pytest.fixture(scope="module")
def made() -> Linkage:
    return validate(Linkage, tables())


def test_each_motor_has_its_seat_its_shaft_and_its_screws(made: Linkage) -> None:
    """Two NEMA 17: their bosses 22 mm wide at O and C, four screws each 31 mm apart; both links take the shafts' flats."""
    assembly = made.assembly
    bought = {each.name: each.count for each in assembly.bought}
    assert bought["drive"] == 2 and bought["screw of the motor"] == 8
    holes = assembly.by_name["ground"].region.holes
    for pivot in (O, C):
        (seat,) = [hole for hole in holes if abs(hole.centroid - pivot) < 1e-6]
        assert 2 * math.sqrt(abs(seat.area) / math.pi) == pytest.approx(22, abs=0.5)
        corners = {complex(x, y) for x in (-15.5, 15.5) for y in (-15.5, 15.5)}
        near = [hole.centroid - pivot for hole in holes if abs(hole.centroid - pivot) < 25]
        assert all(min(abs(z - corner) for z in near) < 1e-6 for corner in corners)
    assert sum(each.name.startswith("motor") for each in assembly.stand_ins) == 2


def test_each_motor_s_torque_is_its_own(made: Linkage) -> None:
    """Held against gravity: power of both motors over the period is what friction takes, each by its own angle."""
    found = assess(made)
    numbers = found.study.numbers
    both = {key: value for key, value in numbers.items() if key.startswith("drive_torque_")}
    assert {"drive_torque_left_n_m", "drive_torque_right_n_m"} <= both.keys()
    most = max(numbers["drive_torque_left_n_m"], numbers["drive_torque_right_n_m"])
    assert numbers["drive_torque_n_m"] == most > 0
    forces = made.solve(np.linspace(0, math.tau, 361)).forces()
    assert set(forces.drives) == {"drive of left", "drive of right"}


def test_without_motors_both_shafts_reach_below_the_plate() -> None:
    spec = tables()
    spec["parts"] = {"shaft_length": 18}
    machine = validate(Linkage, spec)
    names = machine.assembly.by_name
    low = {mount.part: mount.z for mount in machine.assembly.mounts}
    assert {"shaft", "shaft-right"} <= names.keys()
    assert low["shaft"] == low["shaft-right"] == -18
    assert "shafts' lower ends" in machine.assembly.board


# ---- a pen that two motors lead -----------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def drawn() -> Linkage:
    return validate(Linkage, star())


THETA = np.linspace(0, math.tau, 361)


def elbow(pivot: complex, far: np.ndarray, rod: float, side: int) -> np.ndarray:
    """Where an arm about a pivot and a rod to `far` meet, on one side of the way there: circles about both."""
    apart = np.abs(far - pivot)
    along = (apart**2 + ARM**2 - rod**2) / (2 * apart)
    return pivot + (far - pivot) / apart * (along + 1j * side * np.sqrt(ARM**2 - along**2))


def arms(pen: np.ndarray) -> dict[str, np.ndarray]:
    """Angles of both arms of the gallery's five-bar, whose pen is 15 mm from the pin of both rods and 94 mm from the left arm's."""
    a = elbow(O, pen, 94.0, 1)
    corner = math.acos((ROD**2 + 94**2 - 15**2) / (2 * ROD * 94))
    b = elbow(C, a + ROD / 94 * np.exp(1j * corner) * (pen - a), ROD, -1)
    return {"left": np.unwrap(np.angle(a - O)), "right": np.unwrap(np.angle(b - C))}


@pytest.mark.long
def test_both_motors_turn_as_two_circles_say(drawn: Linkage) -> None:
    run = drawn.run(THETA)
    wanted = arms(np.asarray(run["pen"]))
    for link, angle in wanted.items():
        off = run.angle(link)[0] - angle
        assert np.max(np.abs(off - round(off[0] / math.tau) * math.tau)) < 1e-9
    assert np.abs(run["pen"][-1] - run["pen"][0]) < 1e-9


@pytest.mark.long
def test_the_pen_is_on_its_line_and_all_of_the_line_is_drawn(drawn: Linkage) -> None:
    import shapely

    pen = np.asarray(drawn.run(np.linspace(0, math.tau, 7201))["pen"])
    line = np.array([complex(*place) for place in star()["pen"]["line"]])
    line += complex(5, 95) - complex(np.ptp(line.real) / 2 + line.real.min(), 1.7)
    corners = shapely.LineString(np.column_stack([line.real, line.imag]))
    path = shapely.LineString(np.column_stack([pen.real, pen.imag]))
    assert shapely.hausdorff_distance(path, corners, densify=0.001) <= 0.1
    assert drawn.wanted[0].path is not None and drawn.wanted[0].path.tolerance == 0.1


@pytest.mark.long
def test_a_pen_out_of_reach_is_told_by_angle_and_shortfall() -> None:
    """A circle whose farthest point is beyond arm and rod, 144 mm from O."""
    spec = star()
    circle = 20 * np.exp(1j * np.linspace(0, math.tau, 73))
    spec["pen"] |= {"line": [[z.real, z.imag] for z in circle], "at": [-35, 130]}
    with pytest.raises(DesignError, match="Q is led out of reach.*pen.at") as caught:
        assert validate(Linkage, spec).chain
    assert caught.value.unit == "mm" and caught.value.value == pytest.approx(6, abs=0.1)


def test_arm_and_rod_stretch_no_further_than_the_angle_between_them_says(drawn: Linkage) -> None:
    """Seen from the pen: the angle between arm and rod at A, and at B, where the least is beside theta = 0; a stricter limit fails."""
    pen = np.asarray(drawn.run(np.linspace(0, math.tau, 7201))["pen"])
    angles = arms(pen)
    assert drawn.pen is not None
    found = pens.stretches(drawn.chain, drawn.pen, 20.0)
    a = O + ARM * np.exp(1j * angles["left"])
    corner = math.acos((ROD**2 + 94**2 - 15**2) / (2 * ROD * 94))
    p = a + ROD / 94 * np.exp(1j * corner) * (pen - a)
    b = C + ARM * np.exp(1j * angles["right"])
    for finding, arm, rod in zip(found, (a - O, b - C), (pen - a, p - b), strict=True):
        between = np.abs(np.angle(rod / arm))
        least = np.degrees(np.minimum(between, math.pi - between)).min()
        assert finding.ok and finding.measured == pytest.approx(least, abs=1e-4)
    assert not any(each.ok for each in pens.stretches(drawn.chain, drawn.pen, 70.0))


def test_the_reach_of_the_pen_ends_at_circles(drawn: Linkage) -> None:
    """On the left arm's side: rings about O; all that is reached is in it, and the drawing is reached."""
    (shown,) = [plot for plot in drawn.study().plots if plot.title == "Reach of the pen"]
    series = {name: x + 1j * y for name, x, y in shown.series}
    assert set(series) == {"edge of the reach", "rods in line", "line"}
    far = np.abs(series["edge of the reach"] - O)
    assert far.max() < 144 and far.min() > 44
    a = elbow(O, series["rods in line"], 94.0, 1)
    corner = math.acos((ROD**2 + 94**2 - 15**2) / (2 * ROD * 94))
    p = a + ROD / 94 * np.exp(1j * corner) * (series["rods in line"] - a)
    b = elbow(C, p, ROD, -1)
    assert np.max(np.abs(np.sin(np.angle((p - a) / (p - b))))) < 0.051


def table_of(motion: FollowerMotion, folder: Path) -> Path:
    """Its rows as CSV, a row each deg, its velocity and acceleration by differences."""
    x = np.linspace(0, 360, 1441)
    y = motion.law(x, 0)
    path = folder / "table.csv"
    path.write_text("\n".join(f"{a:.6f},{b:.12f}" for a, b in zip(x, y, strict=True)))
    return path


def test_servo_tables_are_the_angles_and_a_damaged_one_is_refused(
    drawn: Linkage, tmp_path: Path
) -> None:
    motions = {each.name: each for each in table_motions(drawn)}
    assert set(motions) == {"drive of left", "drive of right"}
    pen = np.asarray(drawn.run(np.radians(np.arange(361)))["pen"])
    for link, angle in arms(pen).items():
        motion = motions[f"drive of {link}"]
        turned = np.degrees(angle - angle[0])
        assert np.max(np.abs(motion.law(np.arange(361.0), 0) - turned)) < 1e-7
        path = table_of(motion, tmp_path)
        assert table_finding(read_cam_table(path), motion, path).ok
        rows = path.read_text().splitlines()
        master, slave = rows[700].split(",")
        rows[700] = f"{master},{float(slave) + 0.02:.12f}"
        path.write_text("\n".join(rows))
        assert not table_finding(read_cam_table(path), motion, path).ok


@pytest.mark.parametrize(
    ("change", "path", "words"),
    [
        (lambda e: e["pen"].update(point="X"), ("pen", "point"), "Q"),
        (lambda e: e["pen"].update(point="O"), ("pen", "point"), "moves"),
        (lambda e: e["pen"].update(line=[[0, 0], [0, 0], [0, 0]]), ("pen", "line"), "different"),
        (lambda e: e["pen"].update(line="star.svg"), ("pen", "line"), "in a file"),
        (lambda e: e.update(drive=e["drive"][0]), ("drive",), "twice"),
        (lambda e: swing(e, 5, 5), ("drive", 0, "segment"), "[pen] says"),
        (lambda e: drive(e, 1, speed_rpm=8), ("drive", 1, "speed_rpm"), "of both"),
    ],
)
def test_faults_of_a_pen(
    change: Callable[[Tables], Any], path: tuple[str | int, ...], words: str
) -> None:
    spec = star()
    change(spec)
    with pytest.raises(SpecError) as caught:
        validate(Linkage, spec)
    found = [each for each in caught.value.faults if tuple(each.path) == path]
    assert any(words in f"{fault.expected} {fault.nearest}" for fault in found)


def test_a_line_in_a_file_is_the_same_line(drawn: Linkage, tmp_path: Path) -> None:
    rows = star()["pen"]["line"]
    (tmp_path / "star.csv").write_text("\n".join(f"{x},{y}" for x, y in rows))
    text = starters.text("five-bar")
    written = str(rows)
    assert written in text
    (tmp_path / "star.toml").write_text(text.replace(written, '"star.csv"'))
    made = camgen.load(tmp_path / "star.toml")
    assert made.pen.drawn_in == "star.csv"  # type: ignore[attr-defined]
    assert made.pen.line == drawn.pen.line  # type: ignore[attr-defined,union-attr]


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        (
            lambda e: drive(e, 0, speed_rpm=0),
            "drive.0.speed_rpm: 0 - expected a number other than 0",
        ),
        (
            lambda e: drive(e, 1, speed_rpm=7),
            "drive.1.speed_rpm: 7 - expected 4, drawings a minute",
        ),
        (
            lambda e: drive(e, 0, range_deg=[0, 50]),
            "drive.0.range_deg: [0.0, 50.0] - expected no value here",
        ),
        (lambda e: e["drive"].pop(), "drive: 1 drive - expected [[drive]] twice beside [pen]"),
        (lambda e: e["parts"].update(discs={}), "a table of names, each a number >= 0.001"),
    ],
)
def test_beside_a_pen_a_slip_is_one_fault(change: Callable[[Tables], None], fault: str) -> None:
    spec = star()
    change(spec)
    with pytest.raises(SpecError) as caught:
        camgen.load(spec)
    assert len(caught.value.faults) == 1 and fault in str(caught.value)


@pytest.fixture(scope="module")
def programmed(tmp_path_factory: pytest.TempPathFactory) -> Any:
    return camgen.build(star(), tmp_path_factory.mktemp("grbl"), only="servo")


def judged(folder: Path) -> dict[str, bool]:
    """Of a folder's program: whether each motor turns as it has to."""
    found = camgen.check(folder).findings
    program = [each for each in found if each.where.kind == "nc" and each.code == "SERVO_TABLE"]
    return {each.where.output: each.ok for each in program}


def test_one_program_for_grbl_turns_both_motors(drawn: Linkage, programmed: Any) -> None:
    """By its own words alone, and circles about the pivots: both motors together hold the pen within 0.1 mm of its line."""
    import shapely

    rows = [
        {word[0]: float(word[1:]) for word in line.split()}
        for line in (programmed.folder / "five-bar-grbl.nc").read_text().splitlines()
        if line.startswith("G1")
    ]
    minutes = sum(1 / row["F"] for row in rows)
    assert minutes == pytest.approx(1 / star()["drive"][0]["speed_rpm"], rel=1e-5)
    assert judged(programmed.folder) == {"drive of left": True, "drive of right": True}
    line = np.array([complex(*place) for place in star()["pen"]["line"]])
    line += complex(5, 95) - complex(np.ptp(line.real) / 2 + line.real.min(), 1.7)
    start = arms(np.asarray(drawn.run(np.zeros(1))["pen"]))  # where it is to be begun
    a = O + ARM * np.exp(1j * (start["left"] + np.radians([row["X"] for row in rows])))
    b = C + ARM * np.exp(1j * (start["right"] + np.radians([row["Y"] for row in rows])))
    middle = (a + b) / 2
    p = middle + 1j * (b - a) / np.abs(b - a) * np.sqrt(ROD**2 - np.abs(b - a) ** 2 / 4)
    corner = math.acos((ROD**2 + 94**2 - 15**2) / (2 * ROD * 94))
    pen = a + 94 / ROD * np.exp(-1j * corner) * (p - a)
    ring = shapely.LinearRing(np.column_stack([line.real, line.imag]))
    assert np.max(shapely.distance(shapely.points(pen.real, pen.imag), ring)) < 0.1


def test_a_motor_that_turns_evenly_beside_a_program_is_an_axis_too(tmp_path: Path) -> None:
    """An arm on a crank of 12 that goes round once while the other swings; X is the first drive, as the list has them."""
    spec = tables()
    spec["lengths"] |= {"O-A": 12}
    spec["points"]["A"] = [-47, 0]
    spec["drive"][0] = {"link": "left", "speed_rpm": 10}
    made = camgen.build(spec, tmp_path, only="servo")
    program = read_grbl(made.folder / "five-bar-grbl.nc", 2)
    share = program.minutes * 10
    expected = np.column_stack([360 * share, np.degrees(swung(math.tau * share, 15))])
    assert np.max(np.abs(program.turned - expected)) < 1e-3
    assert judged(made.folder) == {"drive of left": True, "drive of right": True}


@pytest.mark.long
@pytest.mark.parametrize(
    "row, old, new, failing",
    [
        (300, "X-5.", "X-6.", {"drive of left"}),
        (300, "Y-21.", "Y-22.", {"drive of right"}),
        (300, "F2880", "F1440", {"drive of left", "drive of right"}),
    ],
)
def test_a_spoilt_program_fails(
    programmed: Any, tmp_path: Path, row: int, old: str, new: str, failing: set[str]
) -> None:
    import shutil

    folder = shutil.copytree(programmed.folder, tmp_path / "five-bar")
    path = folder / "five-bar-grbl.nc"
    lines = path.read_text().splitlines()
    assert old in lines[row]
    lines[row] = lines[row].replace(old, new)
    path.write_text("\n".join(lines))
    assert {name for name, ok in judged(folder).items() if not ok} == failing


def test_motors_that_stand_still_rest(tmp_path: Path) -> None:
    """A quarter of a minute there, a rest of one, a quarter back."""
    turned = np.array([[0, 0], [90, -10], [90, -10], [0, 0]], float)
    program = GrblProgram(np.array([0, 0.25, 1.25, 1.5]), turned)
    text = program.text(["left arm", "ümlaut (2)"])
    assert [line for line in text.splitlines() if line[0] != "("] == [
        "G21 G90 G93",
        "G92 X0 Y0",
        "G1 X90.0000 Y-10.0000 F4",
        "G4 P60.000000",
        "G1 X0.0000 Y0.0000 F4",
        "M2",
    ]
    assert text.isascii() and max(map(len, text.splitlines())) <= 80
    path = tmp_path / "a.nc"
    path.write_text(text)
    again = read_grbl(path, 2)
    assert np.array_equal(again.turned, turned)
    assert again.minutes.tolist() == pytest.approx(program.minutes.tolist())


@pytest.mark.parametrize(
    "text, says",
    [
        ("G21 G90 G93\nG92 X0\nG1 X5 Y1 F2\nM2", "a G92 with X, Y"),
        ("G21 G90\nG92 X0 Y0\nG1 X5 F2\nM2", "G93"),
        ("G21 G90 G93\nG1 X5 F2\nM2", "G92"),
        ("G21 G90 G93\nG92 X0 Y0\nG1 X5\nM2", "line 3 has no F"),
        ("G21 G90 G93\nG92 X0 Y0\nG1 X5 F-2\nM2", "line 3 has no F"),
        ("G21 G90 G93\nG92 X0 Y0\nG1 Xfive F2\nM2", "line 3 has"),
        ("G21 G90 G93\nG92 X0 Y0\nG1 X5 F2\nG91\nG1 X5 F2\nM2", "line 4 has G91"),
        ("G20 G90 G93\nG92 X0 Y0\nG1 X5 F2\nM2", "line 1 has G20"),
        ("G21 G90 G93\nG92 X0 Y0\nG2 X5 I1 F2\nM2", "line 3 has G2"),
        ("G21 G90 G93\nG92 X0 Y0\nG1 X5 Z5 F2\nM2", "line 3 has Z"),
        ("G21 G90 G93\nG92 X0 Y0\nG1 X5 X6 F2\nM2", "line 3 has a word twice"),
        ("G21 G90 G93\nG92 X0 Y0\nX5 F2\nM2", "line 3 has X"),
        ("G21 G90 G93\nG92 X0 Y0\nG1 X5 F2\nG92 X0 Y0\nM2", "line 4 has a second G92"),
        ("G21 G90 G93\nG92 X0 Y0\nG1 X5 F2\nM3 S100\nM2", "line 4 has M3"),
        ("G21 G90 G93\nG92 X0 Y0\nG1 X5 F2\nM2\nG1 X9 F2", "line 5 comes after M2"),
        ("G21 G90 G93\nG92 X0 Y0\nG1 X5 F2", "cut short"),
        ("", "no such program"),
    ],
)
def test_what_is_no_program_for_grbl(tmp_path: Path, text: str, says: str) -> None:
    path = tmp_path / "a.nc"
    path.write_text(text)
    with pytest.raises(FileError, match=says):
        read_grbl(path, 2)


def test_a_motor_is_screwed_on_as_soon_as_its_plate_is_there() -> None:
    """Its screws go through the plate from above, where links lie later; without one nothing is said of it."""
    spec = Path(__file__).resolve().parents[2] / "specs" / "linkage.toml"
    settings = ("parts.motor=nema-17", "motor.model=17HS19-2004S1", "parts.hand_crank=0")
    rows = order_of_assembly(read_mechanism(spec, settings).assembly).rows
    parts = [row[1] for row in rows]
    assert parts.index("motor") == parts.index("ground") + 1 < parts.index("crank")
    assert [row[0] for row in rows] == list(range(1, len(rows) + 1))
    assert "motor" not in [row[1] for row in order_of_assembly(read_mechanism(spec).assembly).rows]


@pytest.mark.long
def test_the_walker_buys_one_motor_by_its_model_and_one_holder() -> None:
    spec = Path(__file__).resolve().parents[2] / "specs" / "gallery" / "walker.toml"
    made = read_mechanism(spec).assembly
    (motor,) = (each for each in made.bought if each.role == "drive")
    assert "N20-1000:1 for 6 V (measure yours: parts.can)" in motor.size
    (holder,) = (each for each in made.bought if each.role == "supply")
    assert holder.count == 1 and "52 x 48" in holder.size
    rows = order_of_assembly(made).rows
    names = [str(row[1]) for row in rows]
    assert names.count("motor") == 1, "one for both sides"
    begin = names[names.index("ground") : names.index("motor") + 1]
    pins = [name for name in begin if name.startswith("pin-")]
    assert begin == ["ground", *pins, "motor-bar", "motor"], "when the plate has its pins"
    assert "8 rpm at work, 13 rpm without load" in motor.size, "as shops list it"
    bar = str(rows[names.index("motor-bar")][2])
    assert bar.startswith("Motor bar: round the motor's gearbox, pressed, flush with its front")


def test_glue_round_the_flats_of_the_walker_bears_what_they_do_not() -> None:
    """A flat 0.5 deep on 3 mm is sqrt(5) wide; PLA bears 20 MPa again and again, glue on it half of 865 lb/in^2."""
    spec = next(starters.folder().rglob("walker.toml"))
    assessed = assess(read_mechanism(spec))
    numbers = assessed.study.numbers
    torque = numbers["drive_torque_n_m"] * 1000
    pressure = numbers["flat_pressure_mpa"]
    assert pressure == pytest.approx(3 * torque / (3 * (5**0.5 / 2) ** 2)) and pressure > 20
    shear = torque / 1.5 / (3.141593 * 3 * 3)  # at the shaft's radius, all round the bore
    assert numbers["glue_shear_mpa"] == pytest.approx(shear)
    assert shear < 865 * 0.00689476 / 2 and not assessed.warnings
    ratio = (0.5 * 2.5) / (0.5 * 4 / 3 * (4 - 0.5 * 4 / 3))  # of both half widths squared
    pins = ["m_of_crank", "m_of_crank_web2", "n_of_crank_web2", "n_of_crank_web3"]
    for pin in pins:
        assert numbers[f"flat_pressure_{pin}_mpa"] == pytest.approx(pressure * ratio)
    far = numbers["flat_pressure_o_of_crank_web3_mpa"]
    assert pressure / 2 < far < pressure, "the far side's share, at times nearly all"


@pytest.mark.parametrize(
    ("changes", "bears"),
    [
        (["walk.payload_g=300"], "it bears 2.9 MPa on PLA"),
        (["material.name=nylon"], "it is not known what it bears on nylon"),
    ],
)
def test_glue_that_does_not_bear_a_flats_torque_is_a_warning(
    changes: list[str], bears: str
) -> None:
    spec = next(starters.folder().rglob("walker.toml"))
    assessed = assess(read_mechanism(spec, changes))
    (said,) = assessed.warnings
    numbers = assessed.study.numbers
    assert said.startswith("The flat of 3 mm in O of crank presses its bore with")
    assert f"takes a shear of {numbers['glue_shear_mpa']:.2g} MPa, and {bears}" in said
    assert said.endswith("make the shaft or crank thicker.")
    assert len(said) < 300, "a terminal shows it in three lines"


def test_a_light_toy_needs_no_glue_for_its_flats() -> None:
    light = assess(read_mechanism(next(starters.folder().rglob("flapping-bird.toml"))))
    numbers = light.study.numbers
    assert 0 < numbers["flat_pressure_mpa"] < 20 and not light.warnings
    assert "glue_shear_mpa" not in numbers


def test_the_list_has_both_glues_where_steps_ask_for_two() -> None:
    """Who buys epoxy alone has none for the collar, which asks for superglue gel."""
    mechanism = read_mechanism(next(starters.folder().rglob("flapping-bird.toml")))
    what = {str(row[1]): str(row[2]) for row in parts_table(mechanism).rows}
    assert what["glue"].startswith("superglue gel, for") and "epoxy" in what["two-part glue"]
    said = " ".join(step.title for step in steps_of_assembly(mechanism).steps)
    assert "a drop of superglue gel" in said and "with two-part glue" in said
