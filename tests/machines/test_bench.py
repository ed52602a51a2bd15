"""Cam machines that stand on a bench: built to files and green, damaged files found out, springs against hand calculation."""

from __future__ import annotations

import json
import math
import re
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
from judged import wrong

from camgen.errors import DesignError, SpecError
from camgen.geometry.distances import point_to_ring
from camgen.geometry.facets import facet_contour
from camgen.machines.disc_cam.mechanism import DiscCamDrive
from camgen.machines.indexing_cam.mechanism import IndexingCam
from camgen.machines.linkage.drawing import RETURN
from camgen.parts.springs import extension_spring
from camgen.pipeline.build import build
from camgen.pipeline.scope import unheard
from camgen.reading import read
from camgen.spec import validate

Floats = np.ndarray
SPECS = Path(__file__).resolve().parents[2] / "specs"
MACHINE = "parts.make='printed'"
ARM = 'geometry.follower={motion="oscillating",shape="roller",radius=5,pivot_distance=60,arm=50}'
FLAT = 'geometry.follower={motion="translating",shape="flat"}'


def made(
    out: Path, *settings: str, kinds: tuple[str, ...] = ("3mf",), spec: str = "disc-cam"
) -> Path:
    """The folder of a green build of a starter spec as a machine."""
    report = build(SPECS / f"{spec}.toml", out, frozenset({*kinds, "report"}), [MACHINE, *settings])
    assert report.ok, [finding for finding in report.findings if not finding.ok]
    return out / spec


def curves(folder: Path) -> dict[str, Floats]:
    """The columns of motion.csv."""
    head = (folder / "motion.csv").read_text(encoding="utf-8").partition("\n")[0].split(",")
    return dict(
        zip(head, np.loadtxt(folder / "motion.csv", delimiter=",", skiprows=1).T, strict=True)
    )


def drive(**tables: Any) -> DiscCamDrive:
    """The starter spec as a machine, with keys of its tables changed."""
    data = read(SPECS / "disc-cam.toml")
    data["parts"]["make"] = "printed"
    for name, table in tables.items():
        data[name] = {**data.get(name, {}), **table}
    return validate(DiscCamDrive, data)


def bought(folder: Path) -> str:
    return (folder / "disc-cam-parts.csv").read_text(encoding="utf-8")


@pytest.mark.long
@pytest.mark.parametrize(
    ("settings", "sprung"),
    [
        ((ARM,), True),
        ((FLAT, "limits.least_radius=1", "motor.speed_rpm=-60"), True),
        (("geometry.closure='groove'",), False),
        ((ARM, "geometry.closure='conjugate'"), False),
    ],
)
def test_the_return_is_cycloidal_in_the_files(
    tmp_path: Path, settings: tuple[str, ...], sprung: bool
) -> None:
    """The starter's return: 12 mm, or degrees, over 120 deg from 160 on; a clockwise cam has its program mirrored."""
    folder = made(tmp_path, *settings)
    rows = curves(folder)
    column = next(
        name
        for name in rows
        if name.endswith("_3mf") and name.startswith(("lift", "swing")) and "speed" not in name
    )
    angle = rows["theta_deg"] if "motor.speed_rpm=-60" not in settings else 360 - rows["theta_deg"]
    u = (angle[(angle >= 160) & (angle <= 280)] - 160) / 120
    off = rows[column][(angle >= 160) & (angle <= 280)] - 12 * (
        1 - u + np.sin(math.tau * u) / math.tau
    )
    assert np.max(np.abs(off - (0 if "lift" in column else off[-1]))) < 2.5e-3
    assert ("extension spring" in bought(folder)) == sprung
    tables = json.loads((folder / "report.json").read_text("utf-8"))["tables"]
    steps = next(table for table in tables if table["title"].startswith("Assembly"))
    assert ("extension spring" in [row[1] for row in steps["rows"]]) == sprung
    pairs = {str(row[0]) for table in tables for row in table["rows"]}
    ends = tuple(f"{RETURN} {k}" for k in (1, 2))  # of which the list has the nearest pairs
    assert any(pair.startswith(ends) or pair.endswith(ends) for pair in pairs) == sprung
    assert not pairs & {f"{RETURN} 1, {RETURN} 2", f"{RETURN} 2, {RETURN} 1"}, (
        "two ends of one spring are no pair"
    )


@pytest.mark.long
def test_the_table_of_an_indexing_cam_turns_by_half_and_rests(tmp_path: Path) -> None:
    """From the files: 180 deg over 120 deg of the cam, half of it at half of them, then 60 deg at rest; gears 6 to 1."""
    # the cam's shaft and the wheels of steel; that its bodies stay apart is seen in test_standing_unloader
    steel = "limits.pin_stress_mpa=350", "limits.tooth_stress_mpa=350"
    rows = curves(made(tmp_path, *steel, spec="indexing-cam", kinds=("dxf",)))
    theta, link, swing = rows["theta_deg"], rows["link_deg_dxf"], rows["swing_deg_dxf"]
    turned = np.abs(np.interp([60.0, 120.0], theta, link) - link[0])
    assert turned == pytest.approx([90.0, 180.0], abs=0.02)
    assert np.ptp(link[(theta >= 120) & (theta <= 180)]) < 0.02
    assert np.max(np.abs(link - link[0] + 6 * (swing - swing[0]))) < 1e-3


@pytest.mark.long
def test_gears_that_cannot_be_and_a_follower_that_no_spring_holds_are_told() -> None:
    data = read(SPECS / "indexing-cam.toml")
    data["parts"]["make"] = "printed"
    with pytest.raises(DesignError, match="whole teeth"):
        _ = validate(
            IndexingCam, {**data, "geometry": {**data["geometry"], "gear_ratio": 2 * math.pi}}
        ).assembly
    with pytest.raises(DesignError, match="another closure"):
        _ = validate(
            IndexingCam, {**data, "geometry": {**data["geometry"], "closure": "force"}}
        ).assembly
    light = {"inertia_kg_m2": 1e-4, "friction_n_m": 0.001}
    sprung = validate(
        IndexingCam,
        {
            **data,
            "geometry": {**data["geometry"], "closure": "force"},
            "load": light,
            "unloader": {"torque": "none"},
        },
    )
    bought = [thing.name for thing in sprung.assembly.bought]
    assert "extension spring" in bought
    assert all(finding.ok for finding in sprung.limits() if finding.code == "FORCE_CLOSURE")


# ---- springs ---------------------------------------------------------------------------------------------------------


def test_a_spring_by_hand() -> None:
    """EN 13906-2 by hand: wire 1 on a mean diameter of 10 with 10 coils is 1.01875 N/mm; 10 N stress it with 289 N/mm^2."""
    spring = extension_spring(1.01875, 60.0, (60.0, 60.0 + 10 / 1.01875), 9.0)
    assert spring is not None
    mean = spring.outside - spring.wire
    assert spring.rate == pytest.approx(81500 * spring.wire**4 / (8 * mean**3 * spring.coils))
    assert spring.stress(60.0 + 10 / 1.01875) <= spring.strength
    one = type(spring)(1.0, 11.0, 10.0, 60.0, 1.01875)
    assert one.stress(60.0 + 10 / 1.01875) == pytest.approx(289.0, rel=1e-3)
    assert one.strength == pytest.approx(0.45 * 1980)
    assert extension_spring(50.0, 60.0, (60.0, 100.0), 5.0) is None  # 2 kN


def test_the_roller_at_rest_bears_the_springs_force() -> None:
    """In the inner dwell nothing moves: the contact bears what the spring pulls with at its shortest, rate * stretch."""
    machine = drive(load={"mass_kg": 0.5}, spring={"rate": 0.5, "preload": 5.0})
    theta = np.radians([130.0, 320.0])
    assert machine.solve(theta).forces().pressing["contact"] == pytest.approx([5.0 + 12 * 0.5, 5.0])


def test_an_arm_bears_the_torque_that_the_spec_gives_its_spring() -> None:
    """N m about the pivot at both ends of the swing, as [spring] says."""
    arm = {
        "motion": "oscillating",
        "shape": "roller",
        "radius": 5.0,
        "pivot_distance": 60.0,
        "arm": 50.0,
    }
    machine = drive(
        geometry={"follower": arm},
        load={"inertia_kg_m2": 1e-4},
        spring={"rate": 0.3, "preload": 0.1},
    )
    torque = machine.solve(np.radians([320.0, 130.0])).forces().contacts["contact"]
    assert torque == pytest.approx([0.1, 0.1 + 0.3 * math.radians(12)])


@pytest.mark.parametrize(
    "follower", [{}, {"motion": "oscillating", "pivot_distance": 60.0, "arm": 50.0}]
)
def test_a_shops_spring_goes_into_the_spec_by_the_formulas_of_the_list(
    follower: dict[str, Any],
) -> None:
    """Rate and free length come back as they were put in; a machine whose spec names its spring is told of no other."""
    shape = {"motion": "translating", "shape": "roller", "radius": 5.0, **follower}
    (told,) = (
        each.size
        for each in drive(geometry={"follower": shape}).assembly.bought
        if each.name == "extension spring"
    )
    preload, rate = (
        text.replace(" (", " * (").replace(" R", " * R")
        for text in re.split(r"preload = |, rate = ", told)[1:]
    )
    values = {"R": 0.05, "L": 48.0}
    values["preload"] = eval(preload, values)
    spring = {"preload": values["preload"], "rate": eval(rate, values)}
    mine = drive(geometry={"follower": shape}, load={}, spring=spring)
    found = mine.linkage.construction.springs[0].spring
    assert (found.rate, found.free) == (
        pytest.approx(0.05, rel=1e-3),
        pytest.approx(48, abs=0.02),
    )
    assert not any("of a shop" in each.size for each in mine.assembly.bought)


def test_a_fast_heavy_follower_gets_a_spring_that_holds_it_and_a_weak_one_is_told() -> None:
    fast = {"motor": {"speed_rpm": 300.0}, "load": {"mass_kg": 0.5}}
    assert all(finding.ok for finding in drive(**fast).limits())
    weak = drive(**fast, spring={"rate": 0.05, "preload": 1.0})
    assert {finding.code for finding in weak.limits() if not finding.ok} == {"LIFT_OFF"}


@pytest.mark.parametrize(
    ("tables", "error", "said"),
    [
        ({"geometry": {"closure": "conjugate"}}, DesignError, "meets the shaft"),
        (
            {
                "geometry": {
                    "follower": {"motion": "oscillating", "shape": "flat", "pivot_distance": 80.0}
                },
                "limits": {"least_radius": 1},
            },
            DesignError,
            "arm of a face.*give it a roller",
        ),
        (
            {
                "geometry": {
                    "follower": {
                        "motion": "oscillating",
                        "shape": "flat",
                        "pivot_distance": 80.0,
                        "face_offset": 2.0,
                    }
                }
            },
            DesignError,
            "face_offset",
        ),
        (
            {"load": {"mass_kg": 1.0}, "spring": {"rate": 100.0, "preload": 5.0}},
            DesignError,
            r"return spring.*\[spring\]",
        ),
        ({"parts": {"thickness": 0.1}}, SpecError, r"parts.thickness.*nozzle"),
    ],
)
def test_what_cannot_be_made_is_told(
    tables: dict[str, Any], error: type[Exception], said: str
) -> None:
    with pytest.raises(error, match=said):
        _ = drive(**tables).assembly


# ---- damage ----------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A green build's drawings, never changed."""
    folder = made(tmp_path_factory.mktemp("bench"), kinds=("dxf",))
    assert failing(folder) == set()
    return folder


def failing(folder: Path) -> set[str]:
    return {finding.code for finding in wrong(folder, "dxf")}


def mirror(drawing: ezdxf.document.Drawing) -> None:
    line = max(drawing.modelspace().query("LWPOLYLINE"), key=len)
    line.set_points([(-x, y, -b) for x, y, b in line.get_points("xyb")], format="xyb")


def shift_seat(drawing: ezdxf.document.Drawing) -> None:
    circles = drawing.modelspace().query("CIRCLE")
    seat = min(circles, key=lambda c: abs(complex(*c.dxf.center.vec2)))
    seat.dxf.center = (0.0, 0.03)


@pytest.mark.long
@pytest.mark.parametrize(("part", "edit"), [("cam-contact", mirror), ("follower", shift_seat)])
def test_a_mirrored_cam_and_a_roller_seat_30_um_off(
    sound: Path, tmp_path: Path, part: str, edit: Callable[[ezdxf.document.Drawing], None]
) -> None:
    folder = Path(shutil.copytree(sound, tmp_path / "disc-cam"))
    path = folder / f"disc-cam-{part}.dxf"
    drawing = ezdxf.readfile(path)
    edit(drawing)
    drawing.saveas(path)
    assert "MOTION_ERROR" in failing(folder)


@pytest.mark.long
def test_a_motor_under_the_plate_and_its_seat_30_um_off(tmp_path: Path) -> None:
    """NEMA 17: four screws M3 on a square of 31, a boss of 22 about the shaft; the shaft turns the crank."""
    motor = ["parts.motor=nema-17"]
    report = build(SPECS / "linkage.toml", tmp_path, frozenset({"dxf", "3mf"}), motor)
    assert report.ok, [finding for finding in report.findings if not finding.ok]
    folder = tmp_path / "linkage"
    listed = (folder / "linkage-parts.csv").read_text(encoding="utf-8")
    assert (
        "NEMA 17 frame" in listed and "shaft of 5 with a flat 0.5 deep" in listed
    )  # usual: 4.5 over the flat
    assert not (folder / "linkage-shaft.dxf").exists()
    drawing = ezdxf.readfile(folder / "linkage-ground.dxf")
    circles = list(drawing.modelspace().query("CIRCLE"))
    screws = [complex(*c.dxf.center.vec2) for c in circles if c.dxf.radius == pytest.approx(1.7)]
    assert (
        sorted((round(abs(z.real), 9), round(abs(z.imag), 9)) for z in screws) == [(15.5, 15.5)] * 4
    )
    seat = next(c for c in circles if abs(complex(*c.dxf.center.vec2)) < 1e-9)
    assert seat.dxf.radius == pytest.approx(11)
    seat.dxf.center = (0.03, 0.0)
    drawing.saveas(folder / "linkage-ground.dxf")
    assert "MOTION_ERROR" in failing(folder)


@pytest.mark.parametrize(
    ("sizes", "said"),
    [
        (
            {"motor": "nema-17", "shaft_diameter": 6.0},
            'shaft_diameter: 6 - expected 5 mm, the shaft of motor = "nema-17"',
        ),
        (
            {"motor": "nema-17", "shaft_flat": 0.8},
            'shaft_flat: 0.8 - expected 0.5 mm, .* motor = "nema-17", 4.5 over its flat',
        ),
        (
            {"motor": "nema-17", "shaft_diameter": 5.0, "base_thickness": 2.0},
            "base_thickness: 2 - expected at least 2.65",
        ),
        (
            {"motor": "nema-17", "shaft_diameter": 5.0, "base_thickness": 200.0},
            "base_thickness: 200 - .* that is sold",
        ),
    ],
)
def test_a_motor_that_does_not_fit_is_told(sizes: dict[str, Any], said: str) -> None:
    with pytest.raises(SpecError, match=said):
        drive(parts=sizes)


@pytest.mark.long
def test_the_report_names_the_spring(sound: Path) -> None:
    report = json.loads((sound / "report.json").read_text(encoding="utf-8"))
    assert report["numbers"]["least_contact_force_n"] > 0


def test_a_groove_of_no_base_radius_gets_room_for_its_pins() -> None:
    """Each hole of the cam as made lies inside it, with a wall of limits.min_wall or more."""
    made = drive(geometry={"closure": "groove", "base_radius": None})
    cam = next(part for part in made.assembly.parts if "inner" in part.name)
    outer, *holes = (
        facet_contour(contour, 1e-3)
        for contour in (cam.layers[0].region.outer, *cam.layers[0].region.holes)
    )
    assert len(holes) == 3 and all(
        np.min(point_to_ring(hole, outer)) >= made.allowed.min_wall for hole in holes
    )


@pytest.mark.parametrize(
    ("parts", "idle"), [({"hub_height": 7.0}, ["parts.hub_height"]), ({"rim": 9.0}, ["parts.rim"])]
)
def test_keys_that_a_machine_replaces_are_named(parts: dict[str, float], idle: list[str]) -> None:
    """What is set, and not what the starter brings, the hub of a cam alone; with the cams alone they all act."""
    assert drive().remarks().unused == [] and drive(parts=parts).remarks().unused == idle
    told = [each for each in unheard(drive(parts=parts), ("dxf",)) if "on cams alone" in each]
    assert len(told) == 1 and all(key in told[0] for key in idle)
    alone = read(SPECS / "disc-cam.toml")
    assert validate(DiscCamDrive, alone).remarks().unused == ()


def test_a_dowel_that_is_not_sold_is_told_by_keys() -> None:
    """Dowels of 5 mm end at 50 mm (ISO 2338); a post of the return spring as high as four thick levels asks for more."""
    spec = drive(parts={"pin": "dowel", "thickness": 30, "shaft_length": 40})
    with pytest.raises(
        DesignError, match=r"the longest dowel of 5 mm is 50 mm, [\d.]+ mm are needed at pin"
    ) as caught:
        _ = spec.assembly
    assert "parts.thickness" in str(caught.value)


OLD = {"make": "machine", "thickness": 6.0, "shaft": "keyway"}


@pytest.mark.parametrize(
    ("parts", "bodies", "today"),
    [
        (OLD, {"thickness": 5.0, "pin": "dowel"}, {"thickness": 5.0, "pin": "dowel"}),
        (OLD, {}, {"thickness": 4.0, "pin_diameter": 5.0}),
        (OLD | {"make": "cams"}, {"make": "laser", "thickness": 5.0}, OLD | {"make": "cams"}),
    ],
)
def test_a_spec_of_two_tables_is_read_as_before(
    parts: dict[str, Any], bodies: dict[str, Any], today: dict[str, Any]
) -> None:
    """[parts] had the sizes of cams alone, [bodies] those of a machine; each acted where it was made."""
    data = read(SPECS / "disc-cam.toml")
    old = validate(DiscCamDrive, {**data, "parts": parts, "bodies": bodies})
    made = {"make": "printed", **today, "bore_shape": "keyway"}
    made.pop("shaft", None)
    assert old.making == validate(DiscCamDrive, {**data, "parts": made}).making
    assert 'parts.shaft = "keyway" is read as parts.bore_shape = "keyway"' in old.hints
    assert "bodies is read as parts" in old.hints


def test_parts_that_are_no_table_are_told() -> None:
    data = read(SPECS / "disc-cam.toml")
    for own in ({}, {"bodies": {"thickness": 5.0}}):
        with pytest.raises(SpecError, match="parts: 5 - expected a table"):
            validate(DiscCamDrive, {**data, "parts": 5, **own})


def test_faults_of_an_old_table_are_told_by_its_name() -> None:
    with pytest.raises(SpecError, match=r"bodies.thickness: 0.1 .*nozzle"):
        drive(parts={"make": "machine"}, bodies={"thickness": 0.1})
