"""The indexing cam: its program and files, the torques with the unloader and without, closure, faults and missing designs."""

from __future__ import annotations

import json
import math
import shutil
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from judged import wrong

from camgen.errors import DesignError, FileError, SpecError
from camgen.machines.indexing_cam.card import card
from camgen.machines.indexing_cam.mechanism import IndexingCam
from camgen.machines.indexing_cam.unloader import CrankSpring
from camgen.motion.laws import LAWS, MR_13_COSINES, MR_13_SINES, end_speed
from camgen.pipeline import build as pipeline
from camgen.reading import read
from camgen.spec import dump, validate
from camgen.study import Figures

REFERENCE = tomllib.loads(
    (Path(__file__).resolve().parents[1] / "reference" / "indexing-cam.toml").read_text()
)
STARTER = Path(__file__).resolve().parents[2] / "specs" / "indexing-cam.toml"


def design(**keys: Any) -> IndexingCam:
    """The starter with the ideal spring and with changed keys, given as table__key; None takes a key out."""
    data = read(STARTER) | {"unloader": {"torque": "law"}}
    for path, value in keys.items():
        *tables, key = path.split("__")
        table = data
        for name in tables:
            table = table.setdefault(name, {})
        table[key] = value
        if value is None:
            del table[key]
    return validate(IndexingCam, data)


def verdicts(cam: IndexingCam) -> dict[str, list[Any]]:
    found: dict[str, list[Any]] = {}
    for finding in cam.limits():
        found.setdefault(finding.code, []).append(finding)
    return found


def faults(**keys: Any) -> list[str]:
    with pytest.raises(SpecError) as wrong:
        design(**keys)
    return [fault.key for fault in wrong.value.faults]


# ---- the law at the link ---------------------------------------------------------------------------------------------


def test_peaks_are_those_of_the_page() -> None:
    table = next(t for t in design().study().tables if t.title.startswith("Peaks"))
    for row, name in zip(table.rows, ("b", "c", "bc"), strict=True):
        assert row[1] == pytest.approx(REFERENCE["peaks"]["table"][name], abs=5e-5)
        assert row[2] == pytest.approx(REFERENCE["peaks"]["continuum"][name], abs=5e-5)


def test_errata() -> None:
    assert abs(end_speed(MR_13_SINES, MR_13_COSINES)) == pytest.approx(
        REFERENCE["dwell"]["closes"], abs=1e-9
    )
    printed = (*MR_13_SINES[:-1], -MR_13_SINES[-1])
    assert abs(end_speed(printed, MR_13_COSINES)) == pytest.approx(
        REFERENCE["dwell"]["misses"], abs=5e-5
    )
    sines = list(printed)
    path = "geometry.law.sines"
    assert faults(
        geometry__law={"name": "fourier", "sines": sines, "cosines": list(MR_13_COSINES)}
    ) == [path]
    assert any("A6 = -0.025629" in note for note in design().study().notes)


def test_the_link_turns_by_180_deg_and_rests() -> None:
    cam = design()
    rise, dwell, back = (math.radians(x) for x in (120, 60, 120))
    theta = np.linspace(rise + 1e-9, rise + dwell - 1e-9, 50)
    link = np.degrees(cam.geometry.gear_ratio * cam.motion(theta))
    assert link == pytest.approx(REFERENCE["dwell"]["index_deg"], abs=1e-9)
    rest = np.linspace(rise + dwell + back + 1e-9, math.tau - 1e-9, 50)
    assert cam.motion(rest) == pytest.approx(0, abs=1e-12) and cam.motion(rest, 1) == pytest.approx(
        0, abs=1e-12
    )
    # half way at half the turn, and the return is the same law backwards
    assert cam.motion(np.array([rise / 2])) == pytest.approx(cam.swing / 2, rel=1e-12)
    t = np.linspace(1e-6, rise - 1e-6, 31)
    assert cam.motion(rise + dwell + t) == pytest.approx(cam.motion(rise - t), abs=1e-12)


@pytest.mark.parametrize(
    "rise, dwell, back", [(60, 40, 100), (150, 30, 150), (90, 180, 90), (120, 0, 240)]
)
def test_rise_and_dwell_are_free(rise: float, dwell: float, back: float) -> None:
    cam = design(
        geometry__rise_deg=rise,
        geometry__dwell_deg=dwell,
        geometry__return_deg=back,
        geometry__gear_ratio=10.0,
        limits__pressure_angle_deg=89,
    )
    spans = [math.degrees(s.span) for s in cam.program.segments]
    assert sum(spans) == pytest.approx(360, abs=1e-9)
    assert spans[0] == pytest.approx(rise) and back in [pytest.approx(s) for s in spans]
    assert cam.study().numbers["turn_period_s"] == pytest.approx(rise / 360 * 2)  # at 30 rpm


# ---- torques ---------------------------------------------------------------------------------------------------------


def test_bare_torque_is_inertia_times_acceleration() -> None:
    """By hand: J n phi'' at the follower's axle, phi'' = C_a stroke / T^2 at its peak."""
    numbers = design(load__friction_n_m=0.0).study().numbers
    period = 120 / 360 * 2.0
    peak = 0.05 * 6.1500726 * math.pi / period**2
    assert numbers["inertia_torque_peak_n_m"] == pytest.approx(peak, rel=1e-5)
    assert numbers["follower_torque_peak_without_n_m"] == pytest.approx(6 * peak, rel=1e-5)
    speed = 1.8917386 * math.pi / period
    assert numbers["kinetic_energy_j"] == pytest.approx(0.05 * speed**2 / 2, rel=1e-6)
    # power: |b c| of the page, at the cam shaft by its speed of 1 turn in 2 s
    shaft = 8.0491 * 0.05 * math.pi**2 / period**3 / math.pi
    assert numbers["shaft_torque_peak_without_n_m"] == pytest.approx(shaft, rel=1e-5)


@pytest.mark.parametrize(("rise", "back"), [(120, 88), (88, 120)])
def test_peaks_are_those_of_the_faster_way(rise: float, back: float) -> None:
    """Speed, acceleration and energy of the link from its angles by differences, over the whole turn of the cam."""
    cam = design(geometry__rise_deg=rise, geometry__return_deg=back)
    theta = np.linspace(0, math.tau, 72_001)
    angle = cam.geometry.gear_ratio * cam.motion(theta) * 180 / math.pi
    step = (theta[1] - theta[0]) / (30 * math.tau / 60)
    speed = np.max(np.abs(np.diff(angle))) / step
    inside = np.abs(np.diff(angle, 2)) / step**2
    numbers = cam.study().numbers
    assert numbers["link_peak_speed_deg_s"] == pytest.approx(speed, rel=1e-4)
    assert numbers["link_peak_acceleration_deg_s2"] == pytest.approx(np.max(inside), rel=1e-3)
    assert numbers["kinetic_energy_j"] == pytest.approx(
        0.05 * math.radians(speed) ** 2 / 2, rel=1e-3
    )


def test_an_impact_has_no_greatest_acceleration() -> None:
    assert (
        design(geometry__law="uniform").study().numbers["link_peak_acceleration_deg_s2"] == math.inf
    )


def test_the_starter_has_a_spring_that_can_be_built() -> None:
    """A spring of 1 N/mm on the card's crank; inertia, friction and spring put together by hand, apart from the program."""
    found = pipeline.read_mechanism(STARTER, [])
    assert isinstance(found, IndexingCam) and found.unloader.torque == "crank"
    law, kappa = LAWS["mr-13"], np.linspace(0, 1, 20_001)[1:-1]
    phi = math.radians(18) + math.radians(324) * law(kappa)
    cord = np.abs(120 + 30 * np.exp(1j * phi))
    spring = (6 + cord - 90) * 30 * 120 * np.sin(phi) / cord * 1e-3 * 324 / 180
    bare = 0.05 * math.pi / (2 / 3) ** 2 * law(kappa, 2)
    left = max(np.max(np.abs(bare + f - spring)) / np.max(np.abs(bare + f)) for f in (0.1, -0.1))
    numbers = found.study().numbers
    assert numbers["residual_share_percent"] == pytest.approx(100 * left, rel=1e-3)
    assert 15 < 100 * left < 20 and verdicts(found)["RESIDUAL_TORQUE"][0].ok
    assert "ideal" not in verdicts(found)["RESIDUAL_TORQUE"][0].message
    forces = numbers["spring_force_least_n"], numbers["spring_force_greatest_n"]
    assert forces == pytest.approx(
        (6, 6 + math.sqrt(30**2 + 120**2 + 2 * 30 * 120 * math.cos(math.radians(18))) - 90)
    )
    table = next(t for t in found.study().tables if "by the unloader's spring" in t.title)
    assert [row[0].split(":")[0] for row in table.rows] == ["none", "ideal", "this spring"]
    assert table.rows[1][2] == pytest.approx(100 * 0.1 / (2.1736146 + 0.1), rel=1e-5)
    assert table.rows[2][2] == pytest.approx(100 * left, rel=1e-3)


def test_the_ideal_is_named_as_such() -> None:
    cam = design()
    (finding,) = verdicts(cam)["RESIDUAL_TORQUE"]
    assert (
        "ideal spring, which cannot be built" in finding.message
        and 'unloader.torque = "law"' in finding.message
    )
    plot = next(p for p in cam.study().plots if p.title.startswith("Torque on the driven link"))
    assert [name for name, *_ in plot.series] == ["inertia", "ideal spring"]


def test_the_spring_of_the_law_bears_all_inertia() -> None:
    numbers = design(load__friction_n_m=0.0).study().numbers
    assert numbers["residual_share_percent"] < 1e-4
    assert numbers["spring_energy_j"] == pytest.approx(numbers["kinetic_energy_j"], rel=1e-5)
    pressed = 0.05 * REFERENCE["dwell"]["c0"] * math.pi / (2 / 3) ** 2
    assert numbers["spring_torque_in_dwell_n_m"] == pytest.approx(pressed, rel=1e-6)
    assert numbers["follower_torque_in_dwell_n_m"] == pytest.approx(6 * pressed, rel=1e-6)


@pytest.mark.parametrize("balance", [0.5, 0.9, 1.2])
def test_what_is_not_balanced_is_left(balance: float) -> None:
    numbers = (
        design(load__friction_n_m=0.0, unloader__balance=balance, limits__residual=1.0)
        .study()
        .numbers
    )
    assert numbers["residual_share_percent"] == pytest.approx(100 * abs(1 - balance), rel=1e-5)


@pytest.mark.long
def test_another_speed_leaves_the_difference_of_squares() -> None:
    cam = design(load__friction_n_m=0.0)
    table = next(t for t in cam.study().tables if "other speeds" in t.title)
    for percent, bare, left, share in table.rows:
        f = float(percent) / 100  # type: ignore[arg-type]
        assert share == pytest.approx(100 * abs(1 - f**-2), abs=1e-4)
        assert left == pytest.approx(float(bare) * abs(1 - f**-2), abs=1e-5)  # type: ignore[arg-type]
    slow = design(
        load__friction_n_m=0.0,
        motor__speed_rpm=15.0,
        unloader__design_rpm=30.0,
        limits__residual=10.0,
    )
    assert slow.study().numbers["residual_share_percent"] == pytest.approx(300, rel=1e-4)


def test_friction_is_left_to_the_cam() -> None:
    numbers = design(load__friction_n_m=0.1).study().numbers
    assert numbers["follower_torque_peak_with_n_m"] == pytest.approx(6 * 0.1, rel=1e-5)


def test_no_power_is_lost_on_the_way_to_the_shaft() -> None:
    cam = design(load__friction_n_m=0.0)
    theta = np.linspace(0, math.tau, 20_001)
    found = cam.indexing.at(theta)
    assert (
        abs(np.trapezoid(found.shaft_bare, theta)) < 1e-6
        and abs(np.trapezoid(found.shaft, theta)) < 1e-6
    )


def test_a_table_of_the_law_is_the_law() -> None:
    law, unit = LAWS["mr-13"], 0.05 * math.pi / (2 / 3) ** 2
    kappa = np.linspace(0, 0.5, 801)
    a = law(kappa)
    a[0], a[-1] = 0.0, 0.5
    points = [[float(x), float(y)] for x, y in zip(a, unit * law(kappa, 2), strict=True)]
    cam = design(load__friction_n_m=0.0, unloader={"torque": "table", "points": points})
    assert cam.study().numbers["residual_share_percent"] < 0.05


def test_crank_spring_is_the_slope_of_its_energy() -> None:
    """Torque against the numeric derivative of the spring's energy over the link's angle; dead in the middle."""
    spring = CrankSpring(2.0, 30.0, 120.0, 6.0, math.radians(18), math.pi)
    a = np.linspace(0, 1, 4001)
    phi = math.radians(18) + 2 * (math.pi - math.radians(18)) * a
    stretch = 6.0 + np.abs(30 * np.exp(1j * phi) + 120) - 90
    energy = 2.0 * stretch**2 / 2 * 1e-3
    slope = -np.gradient(energy, a * math.pi)
    assert spring(a)[2:-2] == pytest.approx(slope[2:-2], abs=2e-5)
    assert spring(a) == pytest.approx(-spring(a)[::-1], abs=1e-12) and spring(a)[0] > 0


def test_the_card_parameters_as_a_crank_spring_come_near_mr_13() -> None:
    """gamma, lambda, x0 and Y of the card, read as a spring on a crank's cord, give P within 15 % of C of the law's c."""
    card, law, kappa = REFERENCE["unloader"], LAWS["mr-13"], np.linspace(0, 0.5, 61)
    spring = CrankSpring(
        1e3, 1.0, card["lambda"], card["x0"], card["gamma"], 2 * (math.pi - card["gamma"])
    )
    effort = card["factor"] * spring(law(kappa))
    assert effort[0] == pytest.approx(REFERENCE["dwell"]["c0"], rel=0.03)
    assert np.max(np.abs(effort - law(kappa, 2))) < 0.15 * law.c_a
    assert np.max(np.abs(0.5 * effort - law(kappa, 2))) > 0.4 * law.c_a


# ---- findings that hold, and that are seen to fail --------------------------------------------------------------------


def test_joints() -> None:
    speed, acceleration = verdicts(design())["JOINT_JUMP"]
    assert speed.ok and acceleration.ok
    assert acceleration.measured == pytest.approx(REFERENCE["dwell"]["c0"], abs=1e-6)
    assert not verdicts(design(limits__acceleration_jump=2.5))["JOINT_JUMP"][1].ok
    assert not verdicts(design(geometry__law="uniform", unloader={"torque": "none"}))["JOINT_JUMP"][
        0
    ].ok
    smooth = design(geometry__law="modified-sine", limits__acceleration_jump=0)
    assert all(finding.ok for finding in verdicts(smooth)["JOINT_JUMP"])


def test_residual_torque_fails_where_the_spring_is_too_weak() -> None:
    assert verdicts(design())["RESIDUAL_TORQUE"][0].ok
    assert not verdicts(design(unloader__balance=0.5))["RESIDUAL_TORQUE"][0].ok
    assert "RESIDUAL_TORQUE" not in verdicts(design(unloader={"torque": "none"}))


def test_force_closure_in_the_dwell() -> None:
    """The unloader presses with J B1 stroke / T^2 on the link: 0.9013 N m here."""
    assert verdicts(design(load__dwell_torque_n_m=0.90))["FORCE_CLOSURE"][0].ok
    assert not verdicts(design(load__dwell_torque_n_m=0.91))["FORCE_CLOSURE"][0].ok
    assert not verdicts(design(load__dwell_torque_n_m=0.01, unloader={"torque": "none"}))[
        "FORCE_CLOSURE"
    ][0].ok


@pytest.mark.parametrize("spring, needed", [("law", 6 * 0.901289), ("none", 6 * 2.1736146)])
def test_a_single_cam_needs_a_closing_torque(spring: str, needed: float) -> None:
    """With the unloader it pulls off in the inner dwell, without it the link's inertia does in the run-down."""
    keys = {"geometry__closure": "force", "unloader": {"torque": spring}, "load__friction_n_m": 0.0}
    short = verdicts(design(**keys, load__closing_n_m=0.999 * needed))["FORCE_CLOSURE"][0]
    assert not short.ok and short.measured == pytest.approx(-0.001 * needed, rel=0.01)
    assert verdicts(design(**keys, load__closing_n_m=1.001 * needed))["FORCE_CLOSURE"][0].ok
    assert [part.name for part in design(**keys).assembly.parts] == ["cam"]


def test_pressure_angle_and_undercut_are_seen_to_fail() -> None:
    assert not verdicts(design(limits__pressure_angle_deg=30.5))["PRESSURE_ANGLE"][0].ok
    follower = {"arm": 90.0, "pivot_distance": 120.0, "roller_radius": 45.0}
    sharp = design(
        geometry__follower=follower,
        geometry__base_radius=20.0,
        geometry__rise_deg=60.0,
        geometry__return_deg=60.0,
        geometry__law="modified-sine",
    )
    assert not verdicts(sharp)["UNDERCUT"][0].ok


# ---- files -----------------------------------------------------------------------------------------------------------


@pytest.mark.long
def test_files_move_as_asked(built: Callable[..., Path]) -> None:
    folder = built("indexing-cam")
    report = pipeline.check(folder)
    assert report.ok, [f for f in report.findings if not f.ok]
    moved = [str(f.where) for f in report.findings if f.code == "MOTION_ERROR"]
    assert len(moved) == 6 and sum("return-cam" in where for where in moved) == 3
    for kind in ("dxf", "stl", "3mf"):
        assert report.numbers[f"index_recovered_{kind}_deg"] == pytest.approx(180, abs=0.05)
    *own, anew = report.as_dict()["findings"]
    assert (
        own == json.loads((folder / "report.json").read_text())["findings"]
        and anew["code"] == "REBUILD"
    )


@pytest.mark.long
def test_swapped_cams_do_not_move_as_asked(built: Callable[..., Path], tmp_path: Path) -> None:
    shutil.copytree(built("indexing-cam"), tmp_path / "indexing-cam")
    one, other = (
        tmp_path / "indexing-cam" / f"indexing-cam-{name}.dxf" for name in ("cam", "return-cam")
    )
    a, b = one.read_bytes(), other.read_bytes()
    one.write_bytes(b)
    other.write_bytes(a)
    assert {f.code for f in wrong(tmp_path / "indexing-cam", "dxf")} == {
        "MOTION_ERROR",
        "ROUND_TRIP",
    }


def test_the_resolved_spec_is_the_spec() -> None:
    cam = design(synthesis={"weights": [1.0, 10.0]})
    assert validate(IndexingCam, tomllib.loads(dump(cam))) == cam
    table = next(t for t in cam.study().tables if t.title.startswith("Laws for this spring"))
    assert [row[0] for row in table.rows] == [1.0, 10.0]
    assert table.rows[0][1] < table.rows[1][1] and table.rows[0][2] > table.rows[1][2]  # type: ignore[operator]


@pytest.mark.long
def test_the_law_for_a_spring_becomes_a_spec() -> None:
    """For the spring of MR-13 and a large weight MR-13 comes back, nearly; with a small one its peak is lower."""
    peaks = []
    for weight in (1e4, 1.0):
        start = design(synthesis={"weights": [10.0, weight]}, load__friction_n_m=0.0)
        found = start.designed()
        assert found.unloader.torque == "table" and found.geometry.law.name == "fourier"
        a = np.linspace(0, 1, 200)
        assert start.unloading is not None and found.unloading is not None
        size = float(np.max(np.abs(start.unloading(a))))
        assert found.unloading(a) == pytest.approx(start.unloading(a), abs=1e-3 * size)
        peaks.append(found.law.c_a)
        table = next(t for t in start.study().tables if t.title.startswith("Laws for this spring"))
        assert found.law.c_a == pytest.approx(table.rows[-1][1], rel=1e-6)
        if weight == 1e4:
            assert found.study().numbers["residual_share_percent"] < 1
    assert peaks[0] == pytest.approx(6.15007, abs=0.02) and peaks[1] < peaks[0]
    with pytest.raises(SpecError, match="weights"):
        design().designed()


# ---- bad input -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "path, value",
    [
        ("geometry.law", "mr13"),
        ("geometry.law", "matched"),
        ("geometry.dwell_deg", 121),
        ("geometry.return_deg", 0.5),
        ("geometry.closure", "groove"),
        ("geometry.follower.roler_radius", 1),
        ("load.closing_n_m", 1),
        ("unloader.torque", "spring"),
        ("unloader.points", [[0, 1]]),
        ("unloader.stiffness_n_mm", 1),
        ("unloader.crank", 1),
        ("unloader.guide", 1),
        ("unloader.stretch", 1),
        ("unloader.lead_deg", 18),
        ("synthesis.weights", []),
        ("parts.key_width", 12.0),
        ("parts.wall", 0.1),
        ("limits.min_wall", 0.1),
    ],
)
def test_each_wrong_key_is_named(path: str, value: object) -> None:
    assert any(found.startswith(path) for found in faults(**{path.replace(".", "__"): value}))


@pytest.mark.parametrize(
    "unloader, paths",
    [
        ({"torque": "crank"}, ["crank", "guide", "stretch", "lead_deg"]),
        (
            {
                "torque": "crank",
                "stiffness_n_mm": 1,
                "crank": 30,
                "guide": 20,
                "stretch": 0,
                "lead_deg": 18,
            },
            ["guide"],
        ),
        ({"torque": "table"}, ["points"]),
        ({"torque": "table", "points": [[0, 1], [0.3, 2], [0.2, 1], [0.5, 0]]}, ["points.2"]),
        ({"torque": "table", "points": [[0, 1], [0.3, 2], [0.4, 1]]}, ["points"]),
        ({"torque": "none", "balance": 1.0, "crank": 3.0}, ["balance", "crank"]),
    ],
)
def test_an_unloader_has_the_keys_of_its_kind(unloader: dict[str, Any], paths: list[str]) -> None:
    assert faults(unloader=unloader) == [f"unloader.{path}" for path in paths]


def test_a_law_that_runs_backwards_is_refused() -> None:
    points = [[0, 0], [1, 0.5], [2, 0.3], [3, 1.0]]
    assert faults(geometry__law={"name": "table", "points": points}) == ["geometry.law.points.2"]
    assert faults(synthesis={"weights": [1.0]}, unloader={"torque": "none"}) == ["synthesis"]


@pytest.mark.long
def test_a_law_from_a_file(tmp_path: Path) -> None:
    """The cycloidal law as a table beside the spec; the resolved spec holds its points and needs no other file."""
    u = np.linspace(0, 1, 201)
    rows = [f"{x},{x - math.sin(math.tau * x) / math.tau}" for x in u]
    (tmp_path / "law.csv").write_text("\n".join(["share,share", *rows]))
    text = STARTER.read_text().replace(
        'law = "mr-13"', 'law = { name = "table", file = "law.csv" }'
    )
    (tmp_path / "t.toml").write_text(text)
    report = pipeline.build(
        tmp_path / "t.toml", tmp_path / "out", frozenset({"dxf"}), ['unloader={torque="law"}']
    )
    assert [f.code for f in report.findings if not f.ok] == []
    by_name = design(geometry__law="cycloidal")
    theta = np.linspace(0, math.tau, 500)
    (tmp_path / "law.csv").unlink()
    made = pipeline.read_mechanism(tmp_path / "out" / "indexing-cam" / "spec.toml")
    assert made.motion(theta) == pytest.approx(by_name.motion(theta), abs=1e-8)
    with pytest.raises(FileError, match=r"law\.csv"):
        pipeline.build(tmp_path / "t.toml", tmp_path / "out", frozenset({"dxf"}))


@pytest.mark.parametrize(
    "keys, quantity",
    [
        ({"geometry__base_radius": 15.0}, "geometry.base_radius"),
        ({"geometry__base_radius": 250.0}, "geometry.base_radius"),
        ({"geometry__gear_ratio": 1.2}, "swing"),
        ({"parts__bore": 110.5, "parts__shaft": "plain"}, "parts.bore"),
    ],
)
def test_designs_that_do_not_exist(keys: dict[str, Any], quantity: str) -> None:
    with pytest.raises(DesignError, match=quantity):
        cam = design(**keys)
        cam.limits()
        _ = cam.assembly


def test_card_of_the_source() -> None:
    """31 rows; P = Y G by the source's crank and spring, written out by hand, and what it differs from c on the 61 positions."""
    table, plots, printed = card(LAWS["mr-13"])
    numbers = Figures(printed)
    assert [row[0] for row in table.rows] == list(range(31)) and [
        name for name, *_ in plots[0].series
    ] == ["c, the law", "P = Y G, the unloader"]
    for z in (0, 7, 19):
        phi = math.pi / 10 + 2 * (math.pi - math.pi / 10) * float(table.rows[z][1])  # type: ignore[arg-type]
        cord = math.sqrt(1 + 16 + 8 * math.cos(phi))
        effort = 4.640648 * (0.2 + cord - 3) * 4 * math.sin(phi) / cord
        assert table.rows[z][5] == pytest.approx(effort, abs=1e-9)
    assert numbers["card_effort_start_ratio"] == pytest.approx(2.498, abs=5e-4)
    assert numbers["card_effort_peak_ratio"] == pytest.approx(6.449, abs=5e-4)
    assert numbers["card_difference_max_ratio"] == pytest.approx(0.875, abs=5e-4)
    assert card(LAWS["cycloidal"])[1:] == ([], [])
