"""The whole printed machine: all parts, mounted, swept, laid out for printing, with print fits; and seen to fail."""

from __future__ import annotations

import csv
import json
import math
import re
import shutil
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from judged import wrong

from camgen.errors import DesignError, SpecError
from camgen.files.stl import read_stl
from camgen.files.threemf import PartCopy, read_3mf, write_3mf
from camgen.geometry.arcs import as_circle
from camgen.geometry.mesh import Mesh, placing
from camgen.geometry.outlines import circle
from camgen.judge.assembly import sweep
from camgen.machines.mechanism import Mechanism
from camgen.parts.assembly import bodies_in_motion, order_of_assembly
from camgen.parts.solids import solid
from camgen.parts.standing import discs
from camgen.pipeline import build as pipeline
from camgen.pipeline import making
from camgen.pipeline.case import Case
from camgen.pipeline.judging import judge_plates

SPEC = Path(__file__).resolve().parents[2] / "specs" / "uniform-swing.toml"
NAME = "uniform-swing"
FORCED = ("geometry.closure='force'", "geometry.reversal_blend_deg=20", "spring.preload=0.01")
COARSE = ("accuracy.chord_tolerance=0.01", "limits.speed_ripple=0.1")  # for speed
TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


YOURS = ("nozzle-foot", "stand-rail")  # dummies


def machine(*settings: str) -> Mechanism:
    return pipeline.read_mechanism(SPEC, settings)


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The starter spec, all kinds of files, coarse for speed; never changed."""
    out = tmp_path_factory.mktemp("machine")
    report = pipeline.build(SPEC, out, frozenset({"dxf", "stl", "3mf"}), COARSE)
    assert [f for f in report.findings if not f.ok] == []
    return out / NAME


@pytest.fixture
def folder(made: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(made, tmp_path / NAME))


def failing(folder: Path, kind: str) -> set[tuple[str, str]]:
    return {(f.code, str(f.where).split(",")[0]) for f in wrong(folder, kind)}


# ---- what is there ---------------------------------------------------------------------------------------------------


def test_what_you_bring_meets_the_holes_of_base_and_frames() -> None:
    """Rails and the nozzle's foot are dummies; their holes lie on those of what they are screwed on, and the rails hang free."""
    made = machine().assembly

    def places(name: str) -> set[tuple[float, float]]:
        holes = [
            mount.place(complex(z))
            for mount in made.mounts
            if mount.part == name
            for hole in made.by_name[name].drawn.region.holes
            for z, _ in discs(hole)
        ]
        return {(round(z.real, 6), round(z.imag, 6)) for z in holes}

    for yours, ours, count in (("stand-rail", "base", 4), ("nozzle-foot", "frame", 2)):
        assert made.by_name[yours].process == "dummy"
        assert len(places(yours)) == count and places(yours) <= places(ours)
    assert "stand-rail" not in machine("base.mount='none'").assembly.by_name


@pytest.mark.long
def test_all_parts_of_the_table_are_made_in_their_counts(made: Path) -> None:
    counts = {part.name: part.count for part in machine().assembly.parts}
    assert counts == {
        "cam": 2,
        "frame": 2,
        "base": 1,
        "axle": 2,
        "axle-washer": 2,
        "cam-spacer": 1,
        "collet": 1,
        "clamp-ring": 1,
        "cam-pin": 2,
        "frame-pin": 2,
        "nozzle-foot": 1,
        "stand-rail": 2,
    }
    for name in counts:
        assert all((made / f"{NAME}-{name}.{kind}").exists() for kind in ("dxf", "stl", "3mf"))
    printed = {name: count for name, count in counts.items() if name not in YOURS}
    for file, wanted in (("assembly.3mf", counts), ("plate.3mf", printed)):
        items = read_3mf(made / f"{NAME}-{file}").items
        assert Counter(item.name for item in items) == wanted


def test_the_spring_that_force_closure_asks_for_is_listed() -> None:
    """0.1 N m and 0.01 N m/rad at a lever of 24 mm: 4.167 N, and 17.36 N/m more; it is judged, so it has to be bought."""
    settings = (
        "geometry.closure='force'",
        "spring.preload=0.1",
        "spring.rate=0.01",
        "geometry.reversal_blend_deg=30",
    )
    asked = machine(*settings)
    (row,) = [
        row
        for row in making.parts_table(asked).rows
        if row[0] == "bought" and "return spring" in str(row[1])
    ]
    assert "0.01736 N/mm, 4.167 N at" in str(row[2]) and "lever of 24 mm" in str(row[2])
    assert [name for name in asked.assembly.springs] == [row[1]]
    assert not [row for row in making.parts_table(machine()).rows if "spring" in str(row[1])]


@pytest.mark.long
def test_parts_list(made: Path) -> None:
    with open(made / f"{NAME}-parts.csv", encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    cam = next(row for row in rows if row["part"] == "cam")
    volume = 2 * machine().assembly.parts[0].volume
    assert float(cam["material, mm^3"]) == pytest.approx(volume, rel=5e-3)
    assert float(cam["mass in PLA, g"]) == pytest.approx(volume * 1.24e-3, rel=5e-3)
    bought = {row["part"]: row for row in rows if row["how"] == "bought"}
    assert (
        bought["screw of the motor"]["count"] == "4"
        and "ISO 7380-1" in bought["screw of the motor"]["what"]
    )
    assert "NEMA 17" in bought["motor"]["what"]
    assert json.loads((made / "report.json").read_text())["numbers"]["mass_g"] == pytest.approx(
        sum(float(row["mass in PLA, g"]) for row in rows if row["how"] == "printed"), rel=5e-3
    )


def test_heavier_plastic() -> None:
    def mass(*settings: str) -> float:
        return float(str(making.parts_table(machine(*settings)).rows[0][5]))

    assert mass("material.name='PETG'") == pytest.approx(mass() * 1.27 / 1.24)
    assert mass("material.density=2.48") == pytest.approx(2 * mass())


def test_stacking_heights() -> None:
    """Base 4, gap 0.6, two frames of 6; cams 0.2 mm beyond the frames' middle plane on either side."""
    mounts = machine().assembly.mounts
    heights = {(m.part, m.flipped): m.z for m in mounts}
    middle = 4 + 0.6 + 6
    assert heights["frame", False] == pytest.approx(middle - 6) and heights[
        "frame", True
    ] == pytest.approx(middle)
    assert heights["cam", False] == pytest.approx(middle - 6.2) and heights[
        "cam", True
    ] == pytest.approx(middle + 0.2)
    assert heights["cam-spacer", False] == pytest.approx(middle - 0.2)


def test_tips_that_are_bought_lie_beside_the_frames() -> None:
    """Base 4, gap 0.6, cam 6, 0.2, two frames of 6, 0.2, cam 6; each tip reaches its cam from its frame, and no farther."""
    made = machine("frame.tip='MR63'")
    heights = {(m.part, m.flipped): m.z for m in made.assembly.mounts}
    assert [
        heights["cam", False],
        heights["frame", False],
        heights["frame", True],
        heights["cam", True],
    ] == pytest.approx([4.6, 10.8, 16.8, 23.0])
    tips = {s.name: s.discs for s in made.assembly.stand_ins if s.name.startswith("tip")}
    (pin, ring), (other, other_ring) = tips["tip-1"], tips["tip-2"]
    assert pin == (complex(-60, -30), 1.5, pytest.approx(4.8), pytest.approx(16.8))
    assert ring == (complex(-60, -30), 3.0, pytest.approx(6.35), pytest.approx(8.85))
    assert other[0] == complex(-60, 30) and other[2:] == (pytest.approx(16.8), pytest.approx(28.8))
    assert other_ring[2:] == (pytest.approx(24.75), pytest.approx(27.25))


def test_what_is_bought_for_a_tip_and_the_order_of_assembly() -> None:
    things = {
        thing.name: thing
        for thing in machine(
            "frame.tip='623'", "geometry.tip_radius=5", "parts.thickness=8"
        ).assembly.bought
    }
    assert (things["bearing of the tip"].size, things["bearing of the tip"].count) == (
        "623, 3 x 10 x 4",
        2,
    )
    assert (
        things["dowel pin of the tip"].size == "3 m6 x 16"
        and things["dowel pin of the tip"].standard == "ISO 2338"
    )
    assert "bearing of the tip" not in {
        thing.name for thing in machine("frame.tip='pin'").assembly.bought
    }

    def order(*settings: str) -> list[str]:
        return [
            str(row[1])
            for row in order_of_assembly(machine(*settings).assembly).rows
            if "cam" in str(row[1]) or "frame" in str(row[1])
        ]

    assert order() == [
        *("cam", "cam-pin", "frame", "frame, second copy"),
        *("frame-pin", "both frames", "cam-spacer", "cam, second copy"),
    ]
    assert order("frame.tip='pin'", *FORCED) == ["frame", "frame", "cam", "cam-pin"]


@pytest.mark.parametrize("settings", [(), ("frame.tip='MR63'",), ("frame.tip='pin'", *FORCED)])
def test_a_step_lays_one_part_by_the_name_of_its_file(settings: tuple[str, ...]) -> None:
    made = machine(*settings).assembly
    table = order_of_assembly(made)
    names = {part.name for part in made.parts} | {thing.name for thing in made.bought}
    for row, step in zip(table.rows, table.steps, strict=True):
        assert len({copy.rpartition("-")[0] for copy in step.copies}) <= 1, row
        assert str(row[1]).partition(",")[0] in names | {"both frames"}


def test_axles_have_end_float() -> None:
    """Flange, base, washer and frames take less than the axle has above its flange."""
    parts = {part.name: part for part in machine("print.slide_clearance=0.3").assembly.parts}
    axle, frame = parts["axle"], parts["frame"]
    taken = parts["base"].thickness + parts["axle-washer"].thickness + 2 * frame.thickness
    assert axle.thickness - 2.0 - taken == pytest.approx(0.3)


def test_the_twin_frame_is_the_mirror_image_in_the_line_of_centres() -> None:
    first, second = machine().assembly.poses(np.array([0.3, 2.0]))["frame"]
    z = complex(-60, -30)
    for k in range(2):
        here = first.place[k] + np.exp(1j * first.angle[k]) * z
        there = second.place[k] + np.exp(1j * second.angle[k]) * -z.conjugate()
        swing = first.angle[k]
        assert there == pytest.approx(60 + np.exp(1j * swing) * z.conjugate(), abs=1e-12)
        assert here == pytest.approx(60 + np.exp(1j * swing) * z, abs=1e-12)


@pytest.mark.long
def test_each_kind_of_file_is_judged(made: Path) -> None:
    findings = json.loads((made / "report.json").read_text())["findings"]
    codes = Counter(f["code"] for f in findings)
    assert (
        codes["BED_FIT"] == 3 and codes["MOTION_ERROR"] == codes["TIP_MOTION"] == 3
    )  # once for each kind of file


@pytest.mark.long
def test_no_figure_of_the_source_stands_beside_another_machine(made: Path) -> None:
    """The source gives no lengths, so its measured canvas is never this spec's, and its slips are not this spec's either."""
    report = json.loads((made / "report.json").read_text())
    text = json.dumps([report["tables"], report["notes"]])
    assert (
        "measured on the running machine" not in text
        and "x sin" not in text
        and "Sentyakov" in text
    )


@pytest.mark.long
def test_canvas_is_that_of_constant_speed(made: Path) -> None:
    """Constant speed gives an even canvas on a round collector; on a flat one cos^2 of up to 15 deg keeps within 10 %."""
    numbers = json.loads((made / "report.json").read_text())["numbers"]
    for kind in ("dxf", "stl", "3mf"):
        assert numbers[f"canvas_share_round_{kind}_percent"] >= 98
        assert numbers[f"canvas_share_flat_{kind}_percent"] >= 98


@pytest.mark.long
@pytest.mark.parametrize(
    "settings",
    [
        ("parts.pin_diameter=0", "parts.shaft='d-flat'", "base.motor='flange'", "base.screws=3"),
        (
            "parts.shaft='keyway'",
            "parts.key_width=2",
            "parts.key_depth=1",
            "geometry.tip_radius=0",
            "base.mount='none'",
            "print.bed=[125,70]",
        ),
        ("base.motor='nema-11'", "geometry.swing_deg=20", "parts.thickness=5", "base.mount='M4'"),
        ("frame.tip='pin'", "print.slide_clearance=0.3", "collet.length=8"),
        ("frame.tip='623'", "geometry.tip_radius=5", "parts.thickness=8", *FORCED),
    ],
)
def test_other_machines_work_too(tmp_path: Path, settings: tuple[str, ...]) -> None:
    report = pipeline.build(SPEC, tmp_path, frozenset({"3mf"}), [*settings, *COARSE])
    # tips beside the frames make it higher than the usual shaft reaches
    assert {f.code for f in report.findings if not f.ok} == (
        {"SHAFT_REACH"} if "frame.tip" in settings[0] else set()
    )
    plates = sorted(path.name for path in (tmp_path / NAME).glob("*-plate*.3mf"))
    several = "print.bed=[125,70]" in settings
    assert (len(plates) > 1) == several and plates[
        0
    ] == f"{NAME}-plate{'-2' if several else ''}.3mf"


# ---- seen to fail ----------------------------------------------------------------------------------------------------


def assembled(path: Path, mechanism: Mechanism, **changes: Any) -> None:
    """Assembly file of a machine in which one copy is turned (rad) or shifted, or parts are those of another machine."""
    parts = {part.name: part for part in mechanism.assembly.parts}
    tolerance = mechanism.accuracy.chord_tolerance
    meshes: dict[str, Mesh] = {
        name: solid(part, tolerance) for name, part in (parts | changes.get("other", {})).items()
    }
    items = []
    for part, poses in mechanism.assembly.poses(np.zeros(1)).items():
        for k, pose in enumerate(poses):
            turn, shift, lift = changes.get(f"{part}_{k + 1}".replace("-", "_"), (0.0, 0j, 0.0))
            at = complex(pose.place[0]) + shift
            place = placing(
                float(pose.angle[0]) + turn, at, pose.z + lift, parts[part].thickness, pose.flipped
            )
            items.append(PartCopy(part, f"{part}-{k + 1}", place))
    write_3mf(path, meshes, items, "key")


def swept(path: Path, mechanism: Mechanism) -> list[str]:
    return [
        f"{f.code} {f.where}"
        for f in sweep(path, bodies_in_motion(mechanism.assembly))[0]
        if not f.ok
    ]


@pytest.mark.long
def test_bodies_in_the_way_are_found(tmp_path: Path) -> None:
    whole, path = machine(*COARSE), tmp_path / "x.3mf"
    assembled(path, whole)
    assert swept(path, whole) == []
    assembled(path, whole, frame_1=(math.radians(1.0), 0j, 0.0), collet_1=(0.0, 0j, -0.5))
    failed = swept(path, whole)
    assert any("frame-1" in said and "collet-1" not in said for said in failed)
    assert any("collet-1" in said and "frame-1" not in said for said in failed)


@pytest.mark.long
def test_an_axle_that_meets_the_end_of_its_slot(tmp_path: Path) -> None:
    whole, path = machine(*COARSE), tmp_path / "x.3mf"
    short = {part.name: part for part in machine("geometry.swing_deg=25", *COARSE).assembly.parts}
    assembled(path, whole, other={"base": short["base"]})
    failed = swept(path, whole)
    assert len(failed) == 1 and failed[0].startswith("INTERFERENCE base-1 and axle-2")


def test_a_lost_copy(tmp_path: Path) -> None:
    whole, path = machine(), tmp_path / "x.3mf"
    mesh = solid(whole.assembly.parts[0], 0.01)
    write_3mf(path, {"cam": mesh}, [PartCopy("cam", "cam-1")], "key")
    assert [said.split()[0] for said in swept(path, whole)] == ["COPIES"]


def edited(folder: Path, part: str, change: Any) -> None:
    path = folder / f"{NAME}-{part}.stl"
    data = path.read_bytes()
    triangles = np.frombuffer(data[84:], TRIANGLE).copy()
    corners = triangles["corners"].astype(float)
    plane = change(corners[..., 0] + 1j * corners[..., 1])
    triangles["corners"] = np.stack([plane.real, plane.imag, corners[..., 2]], axis=-1)
    path.write_bytes(data[:84] + triangles.tobytes())


@pytest.mark.long
def test_a_frame_whose_tip_is_drawn_back(folder: Path) -> None:
    """0.06 mm away from the cam nothing overlaps, but the contact no longer drives the frame as asked."""
    edited(folder, "frame", lambda z: np.where(abs(z - complex(-60, -30)) < 3.05, z - 0.06j, z))
    assert ("TIP_MOTION", f"{NAME}-frame.stl") in failing(folder, "stl")


@pytest.mark.long
def test_a_roller_whose_hole_is_off(tmp_path: Path) -> None:
    """The roller is judged about the hole that is in the file."""
    assert pipeline.build(
        SPEC, tmp_path, frozenset({"stl"}), ["frame.tip='pin'", "motor.shaft_length=40", *COARSE]
    ).ok
    edited(
        tmp_path / NAME, "frame", lambda z: np.where(abs(z - complex(-60, -30)) < 3.2, z - 0.05j, z)
    )
    assert ("TIP_MOTION", f"{NAME}-frame.stl") in failing(tmp_path / NAME, "stl")


@pytest.mark.long
def test_a_plate_that_lost_its_copies(folder: Path) -> None:
    package = read_3mf(folder / f"{NAME}-plate.3mf")
    items = [
        PartCopy(item.name, f"{item.name} {k}", item.transform)
        for k, item in enumerate(package.items)
    ]
    write_3mf(folder / f"{NAME}-plate.3mf", package.meshes, items[1:], "key")
    findings = judge_plates(Case(machine(*COARSE), folder), ["3mf"]).findings
    assert [(f.code, str(f.where)) for f in findings if not f.ok] == [("COPIES", "1 plate")]


@pytest.mark.long
def test_a_part_larger_than_the_bed(tmp_path: Path) -> None:
    report = pipeline.build(
        SPEC, tmp_path, frozenset({"3mf"}), ["print.bed=[90,60]", *FORCED, *COARSE]
    )
    failed = {str(f.where) for f in report.findings if not f.ok}
    assert "base" in failed and {f.code for f in report.findings if not f.ok} == {"BED_FIT"}


# ---- print fits ------------------------------------------------------------------------------------------------------

FITS = (
    "print.hole_compensation=0.1",
    "print.profile_compensation=0.06",
    "print.shrinkage=0.004",
    "print.elephant_foot=0.3",
)


@pytest.mark.long
def test_fits_change_what_is_printed_and_keep_the_motion(made: Path, tmp_path: Path) -> None:
    report = pipeline.build(SPEC, tmp_path, frozenset({"dxf", "stl"}), [*FITS, *COARSE])
    assert [f for f in report.findings if not f.ok] == []
    here = tmp_path / NAME
    assert (here / f"{NAME}-cam.dxf").read_bytes() == (made / f"{NAME}-cam.dxf").read_bytes()
    sent, drawn = (read_stl(place / f"{NAME}-cam.stl").vertices for place in (here, made))

    def bore(vertices: np.ndarray) -> float:
        return float(np.min(np.hypot(vertices[:, 0], vertices[:, 1])))

    assert bore(sent) == pytest.approx((2.5 + 0.1) / 0.996, abs=0.011) and bore(
        drawn
    ) == pytest.approx(2.5, abs=0.011)
    far = [float(np.max(np.hypot(v[:, 0], v[:, 1]))) for v in (sent, drawn)]
    assert far[0] == pytest.approx((far[1] - 0.06) / 0.996, abs=0.03)


@pytest.mark.long
@pytest.mark.parametrize("setting", FITS)
def test_files_with_fits_judged_without_them_fail(tmp_path: Path, setting: str) -> None:
    assert pipeline.build(
        SPEC, tmp_path, frozenset({"stl"}), ["parts.make='cams'", setting, *COARSE]
    ).ok
    folder = tmp_path / NAME
    key, value = setting.removeprefix("print.").split("=")
    spec = folder / "spec.toml"
    text = spec.read_text()
    assert f"{key} = {value}" in text
    spec.write_text(text.replace(f"{key} = {value}", f"{key} = 0.0"))
    codes = {code for code, _ in failing(folder, "stl")}
    assert codes & {"MOTION_ERROR", "ROUND_TRIP", "VOLUME"}


# ---- forces ----------------------------------------------------------------------------------------------------------


def lift_off(*settings: str) -> list[bool]:
    return [f.ok for f in machine(*settings).limits() if f.code == "LIFT_OFF"]


@pytest.mark.long
def test_lift_off() -> None:
    force = ("geometry.closure='force'", "nozzle.inertia_kg_m2=0.001")
    assert lift_off(force[1]) == []  # a pair needs no spring
    assert (
        lift_off(force[0]) == lift_off(*force, "spring.preload=100") == [False]
    )  # a sharp reversal, whatever the spring
    assert lift_off(force[0], "geometry.reversal_blend_deg=20") == [False]  # no spring
    blend = (*force, "geometry.reversal_blend_deg=20")
    needed = machine(*blend).study().numbers["spring_preload_needed_n_m"]
    assert lift_off(*blend, f"spring.preload={needed * 0.98}") == [False]
    numbers = machine(*blend, "spring.lever=40").study().numbers
    assert numbers["spring_force_needed_n"] * 0.040 == pytest.approx(needed)
    # a spring of c N/m on a lever a turns with c a^2 N m/rad
    rate = numbers["spring_rate_needed_n_mm"] * 1000 * 0.040**2
    assert rate == pytest.approx(numbers["spring_rate_needed_n_m_per_rad"])
    assert lift_off(*blend, f"spring.preload={needed * 1.02}") == [True]


@pytest.mark.long
def test_finding_and_figures_of_lift_off_say_the_same() -> None:
    """A sharp reversal: no spring is enough, so none is named. Else force, angle and the preload that is needed."""
    force = ("geometry.closure='force'", "nozzle.inertia_kg_m2=0.001")
    sharp = machine(*force)
    (finding,) = [f for f in sharp.limits() if f.code == "LIFT_OFF"]
    study = sharp.study()
    assert (finding.measured, str(finding.where)) == (-math.inf, "cam angle 180.0 deg")
    assert all(
        study.numbers[f"spring_{key}"] == math.inf
        for key in (
            "preload_needed_n_m",
            "rate_needed_n_m_per_rad",
            "force_needed_n",
            "rate_needed_n_mm",
        )
    )
    (note,) = [note for note in study.notes if "spring" in note]
    assert "no spring" in note and "no spring" in finding.message

    blended = machine(*force, "geometry.reversal_blend_deg=20")
    (finding,) = [f for f in blended.limits() if f.code == "LIFT_OFF"]
    needed = blended.study().numbers["spring_preload_needed_n_m"]
    assert (
        -math.inf < finding.measured < 0
        and f"spring.preload above {needed:.4g} N m" in finding.message
    )
    assert "inf" not in finding.message


def test_torque_is_that_of_the_load() -> None:
    """The motor's work over a turn is nothing without friction; the peak grows with the square of the speed."""
    base = ("nozzle.inertia_kg_m2=0.001", "nozzle.friction=0", "geometry.reversal_blend_deg=30")
    slow, fast = (machine(*base, f"motor.speed_rpm={rpm}").study().numbers for rpm in (30, 60))
    assert fast["peak_torque_n_m"] == pytest.approx(4 * slow["peak_torque_n_m"], rel=1e-9)


# ---- bad input -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        (["base.thickness=2"], "thickness of the base"),
        (["base.motor='nema-23'", "geometry.pivot_distance=32", "geometry.arm_offset=20"], "."),
        (["base.wall=0.3"], "wall of the base"),
        (["base.motor='flange'", "base.boss=43"], "wall of the base"),
        (["frame.slide_at=6.5"], "."),
        (["frame.axle=30", "frame.axle_flange=40"], "."),
        (["frame.wall=0.2"], "wall of the frame"),
        (["nozzle.spacing=8"], "wall of the frame"),
        (["collet.wall=0.3"], "wall of the collet"),
        (["collet.length=2"], "travel of the clamp ring"),
        (["collet.slits=24"], "finger of the collet"),
        (["collet.slit=3.5"], "finger of the collet"),
        (["parts.pin_diameter=9"], "."),
        (["geometry.arm_offset=60"], "reach of the cam"),
        (["geometry.arm_offset=1e6"], "reach of the cam"),
        (
            ["frame.tip='MR85'", "geometry.tip_radius=4", "parts.thickness=4"],
            "dowel pin of the tip",
        ),
        (["frame.tip='MR63'", "parts.thickness=3", "parts.wall=9"], "."),
        (["nozzle.screw='M6'", "parts.thickness=3"], "."),
        (["geometry.pivot_distance=20", "geometry.arm_offset=10"], "."),
    ],
)
def test_no_such_machine(settings: list[str], said: str) -> None:
    with pytest.raises(DesignError, match=said) as caught:
        _ = machine(*settings).assembly
    assert caught.value.exit_code == 3 and not math.isnan(caught.value.value)


@pytest.mark.parametrize(
    ("settings", "path"),
    [
        (["parts.pin_diameter=0.3"], "parts.pin_diameter"),
        (["frame.axle=0.001"], "frame.axle"),
        (["frame.flange_thickness=0.3"], "frame.flange_thickness"),
        (["collet.flange=0.1"], "collet.flange"),
        (["collet.slit=0.3"], "collet.slit"),
        (["frame.tip='pin'", "geometry.tip_radius=3.2"], "geometry.tip_radius"),
        (["frame.tip='623'"], "geometry.tip_radius"),
        (["frame.tip='6000'"], "frame.tip"),
        (["base.mount='M7'"], "base.mount"),
        (["print.slide_clearance=0"], "print.slide_clearance"),
        (["base.gap=0.1"], "base.gap"),
        (["print.press_clearance=3"], "print.press_clearance"),
        (["frame.arm=0.5"], "frame.arm"),
        (["frame.axle_flange=6"], "frame.axle_flange"),
        (["base.motor='flange'", "base.screw_circle=20"], "base.screw_circle"),
        (["base.motor='nema-42'"], "base.motor"),
        (
            ["parts.shaft='d-flat'", "parts.bore=5", "parts.flat_depth=0.8"],
            "parts.flat_depth",
        ),  # NEMA 17: 0.5
        (["base.screws=1"], "base.screws"),
        (["base.screw='M7'"], "base.screw"),
        (["base.window=1"], "base.window"),
        (["nozzle.screw='M9'"], "nozzle.screw"),
    ],
)
def test_faults_of_the_new_keys(settings: list[str], path: str) -> None:
    with pytest.raises(SpecError) as caught:
        machine(*settings)
    assert path in {fault.key for fault in caught.value.faults}


@pytest.mark.long
@pytest.mark.parametrize(
    "setting",
    ["print.profile_compensation=2", "print.elephant_foot=1", "print.hole_compensation=2"],
)
def test_fits_that_leave_no_material(tmp_path: Path, setting: str) -> None:
    with pytest.raises(DesignError) as caught:
        pipeline.build(SPEC, tmp_path, frozenset({"stl"}), [setting])
    assert caught.value.where or caught.value.remedy
    assert not (tmp_path / NAME).exists()


def test_pins_that_meet_the_bore_are_refused() -> None:
    """The pin's hole keeps the wall to the bore by its place; with the bore's play the spacer's wall is what is left."""
    part = machine().assembly.parts[0]
    bore, pin = (hole for hole in part.region.holes[:2])
    gap = (
        abs(pin.centroid) - math.sqrt(abs(bore.area) / math.pi) - math.sqrt(abs(pin.area) / math.pi)
    )
    assert gap == pytest.approx(3.0) and abs(bore.area) == pytest.approx(abs(circle(0j, 2.5).area))


MODERATE = [(50, 25, 30), (30, 15, 30), (40, 20, 30), (60, 20, 20), (30, 10, 10), (50, 40, 20)]


@pytest.mark.parametrize(("pivot", "arm", "swing"), MODERATE)
def test_machines_of_moderate_size_have_room(pivot: float, arm: float, swing: float) -> None:
    """Their cams are 4 to 9 mm deep at the nearest side of the shaft, or leave 3 mm beside the pivot."""
    sizes = (
        f"geometry.pivot_distance={pivot}",
        f"geometry.arm_offset={arm}",
        f"geometry.swing_deg={swing}",
    )
    small = machine(*sizes)
    assert {part.name for part in small.assembly.parts} == {
        part.name for part in machine().assembly.parts
    }
    assert any(
        note.startswith("Some sizes are smaller than usual") for note in small.study().notes
    ) == ((pivot, arm) in {(30, 15), (30, 10), (50, 40)})


def test_pins_match_when_the_cam_is_turned_over_and_keep_their_walls() -> None:
    """A cam whose thinnest side lies beside the shaft carries its pins on the deep side."""
    cam, *_ = machine(
        "geometry.pivot_distance=30", "geometry.arm_offset=10", "geometry.swing_deg=10"
    ).assembly.parts
    one, other = cam.centres[1:]
    assert other == -one.conjugate() and one.real > 0 and one.imag > 0
    spacer = next(
        p
        for p in machine("geometry.pivot_distance=40", "geometry.arm_offset=20").assembly.parts
        if p.name == "cam-spacer"
    )
    assert as_circle(spacer.region.outer) is None and len(spacer.region.holes) == 3


@pytest.mark.parametrize(
    ("pivot", "arm", "swing"), [(60, 20, 30), (60, 50, 20), (30, 60, 10), (100, 30, 30)]
)
def test_a_refused_machine_says_what_has_room(pivot: float, arm: float, swing: float) -> None:
    """Each key that is named makes, with its value, a machine of it."""
    sizes = (
        f"geometry.pivot_distance={pivot}",
        f"geometry.arm_offset={arm}",
        f"geometry.swing_deg={swing}",
    )
    with pytest.raises(DesignError) as caught:
        _ = machine(*sizes).assembly
    remedies = re.findall(r"([a-z]+\.[a-z_]+) = ([\d.]+)", caught.value.remedy)
    assert remedies
    for key, value in remedies:
        assert machine(*sizes, f"{key}={value}").assembly.parts, key


def test_a_thick_collet_moves_the_pins_outwards() -> None:
    cam = machine("collet.wall=4").assembly.parts[0]
    assert abs(cam.centres[1]) - 1.5 > 2.6 + 4  # bore with its fit, and the wall


def test_screws_that_do_not_reach_the_motor() -> None:
    """M3 x 20 ends 0.45 mm short of what a base 22.3 mm thick leaves under the screws' heads."""
    held = {f.code: f for f in machine("base.thickness=22.3").limits()}["SCREW_GRIP"]
    assert (
        not held.ok
        and held.measured == pytest.approx(-0.45)
        and held.limit == pytest.approx(0.8 * 3)
    )
    assert {f.code: f for f in machine().limits()}["SCREW_GRIP"].ok


def test_a_nema_23_is_held_by_nuts() -> None:
    """Its face has plain holes in a flange of 4.8 mm."""
    bought = {thing.name: thing.size for thing in machine("base.motor='nema-23'").assembly.bought}
    assert bought["nut of the motor"] == "M5" and "with a nut" in bought["screw of the motor"]


def test_play_of_the_axle() -> None:
    """0.1 mm to either side on an arm of 67.08 mm at 58.3 deg of pressure angle: 0.1 / (67.082 cos 58.306 deg) = 0.1626 deg."""
    assert machine().study().numbers["swing_by_play_of_axle_deg"] == pytest.approx(0.1626, abs=2e-4)
