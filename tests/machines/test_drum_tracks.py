"""Drums: tracks and pins as the mesh has them, by a route of the tests' own; files of other drums are refused by name."""

from __future__ import annotations

import cmath
import itertools
import math
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
import shapely

import camgen
from camgen.errors import DesignError, SpecError
from camgen.files.drawing import write_drawing
from camgen.files.stl import write_stl
from camgen.findings import Finding
from camgen.geometry.mesh import Mesh, slice_mesh
from camgen.machines.drum.mechanism import CamDrum
from camgen.parts import solids
from camgen.parts.solids import solid
from camgen.pipeline.build import build
from camgen.pipeline.drawings import facts_of
from camgen.pipeline.shown import animation
from camgen.settings import assigned
from camgen.spec import validate

TOP = Path(__file__).parents[2]
SPEC = TOP / "specs" / "gallery" / "bird-drum.toml"
BIRD = tomllib.loads(SPEC.read_text(encoding="utf-8"))
REFERENCE = tomllib.loads((TOP / "tests/reference/pin-drums.toml").read_text(encoding="utf-8"))
FINE = 1e-3  # mm, chords
STEP = 2e-3  # deg, of the tooth's simulation


def drum(changes: Mapping[str, Any] = {}) -> CamDrum:
    """The gallery's, with other keys."""
    data: Any = BIRD
    for key, value in changes.items():
        data = assigned(data, key, value)
    return validate(CamDrum, data)


def mesh(machine: CamDrum) -> Mesh:
    return solid(machine.assembly.parts[0], FINE)


def section(machine: CamDrum, z: float) -> np.ndarray:
    """Points of the outer outline at a height, (n,) complex mm."""
    return max(
        (ring.points for ring in slice_mesh(mesh(machine), z)), key=lambda p: np.abs(p).max()
    )


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("drum")
    assert build(SPEC, out, frozenset({"stl", "report"})).ok
    return out / "bird-drum"


# ---- pins ------------------------------------------------------------------------------------------------------------


@pytest.mark.long
@pytest.mark.parametrize("speed", [6.0, -6.0])
def test_a_tooth_that_is_pushed_along_springs_back_when_the_pin_says(speed: float) -> None:
    """The tip goes along a line, pushed by whatever of the turned mesh is on it and not behind: after the release nothing is."""
    sense = math.copysign(1, speed)
    machine = drum({"motor.speed_rpm": speed})
    outline = section(machine, 19.0)
    polygon = shapely.Polygon(np.column_stack([outline.real, outline.imag]))
    line = shapely.LineString([(0, 15.2), (-10 * sense, 15.2)])  # at 90 deg, the way of the turn

    def bend(angle: float) -> float:
        turned = shapely.affinity.rotate(polygon, sense * angle, origin=(0, 0))
        met = turned.intersection(line)
        return 0.0 if met.is_empty else float(max(abs(met.bounds[0]), abs(met.bounds[2])))

    for release in (250.0, 300.0, 350.0):
        before = bend(release - STEP)
        assert before == pytest.approx(math.sqrt(15.5**2 - 15.2**2), abs=2 * FINE)
        assert bend(release + STEP) == 0.0
        assert bend(release - 8) > bend(release - 12) > 0.5  # it is taken along
    hold = machine.study().numbers["pin_hold_deg"]
    assert bend(250 - hold - 0.05) == 0.0 and bend(250 - hold + 0.05) > 0
    angle = np.arange(200.0, 360.0, 7.3)
    (row, _) = machine.assembly.rows
    assert row.bend(np.radians(angle), 0) == pytest.approx([bend(each) for each in angle], abs=5e-3)
    slope = (row.bend(np.radians(240.01), 0) - row.bend(np.radians(239.99), 0)) / np.radians(0.02)
    assert row.bend(np.radians(240.0), 1) == pytest.approx(slope, rel=1e-4)


@pytest.mark.parametrize("row", REFERENCE["shift"])
def test_a_pin_that_is_off_is_off_in_time(row: Mapping[str, float]) -> None:
    machine = drum(
        {
            "motor.speed_rpm": 60 / row["seconds_a_turn"],
            "pin.radius": 20.0,
            "tooth.return_ms": 0.0,
        }
    )
    assert 1e3 * machine.study().numbers["release_shift_s"] == pytest.approx(row["ms"], abs=0.01)


@pytest.mark.long
def test_pins_that_come_before_the_tooth_rests_are_refused() -> None:
    """A tooth is free from one release to the next pin, which meets it a hold before its own release."""
    hold = drum().study().numbers["pin_hold_deg"]
    turned = 6 * 6e-3 * 30  # deg in 30 ms at 6 rpm
    for spare, ok in ((0.01, True), (-0.01, False)):
        machine = drum({"row.0.release_deg": [250.0, 250 + hold + turned + spare]})
        found = [each for each in machine.limits() if each.code == "PIN_SPACING"]
        assert [each.ok for each in found] == [ok, True]
        assert found[0].measured - found[0].limit == pytest.approx(spare, abs=1e-6)


# ---- tracks ----------------------------------------------------------------------------------------------------------


@pytest.mark.long
def test_each_follower_rests_on_its_section_where_its_program_wants_it() -> None:
    """A roller as high as the highest of all circles about the section's points lets it, a flat face as the highest point."""
    machine = drum()
    theta = np.radians([0, 31, 60, 95, 120, 170, 250, 300, 290, 359])
    run = machine.solve(theta)
    for name, z, radius, base in (("wing_lift", 3.0, 5.0, 26.0), ("beak_lift", 15.0, 0.0, 16.0)):
        points = section(machine, z)
        edges = np.roll(points, -1) - points
        dense = np.concatenate([points + share * edges for share in np.linspace(0, 1, 20)])
        turned = dense * np.exp(1j * theta)[:, None]
        beside = np.minimum(np.abs(turned.real), radius)
        high = turned.imag + np.sqrt(radius**2 - beside**2)
        if radius:
            high = np.where(np.abs(turned.real) < radius, high, -np.inf)
        assert high.max(axis=1) - base - radius == pytest.approx(run[name], abs=2 * FINE)
    tail = section(machine, 9.0)
    for angle, s in zip(theta, run["tail_swing"], strict=True):
        # the arm's end at rest lies 24 mm from the shaft, below the line to the pivot
        bearing = math.acos((60**2 + 50**2 - 24**2) / (2 * 60 * 50))
        centre = 60 - 50 * np.exp(1j * (bearing + s))
        edges = np.roll(tail, -1) - tail
        dense = np.concatenate([tail + share * edges for share in np.linspace(0, 1, 20)])
        assert np.abs(dense * np.exp(1j * angle) - centre).min() == pytest.approx(5, abs=2 * FINE)


def test_each_track_has_its_table_with_its_name(tmp_path: Path) -> None:
    """Tracks of the gallery's drum begin and end on their base circles, which are their own; all are on sheets by themselves, the
    zones keep their places to each other, and none is on the drum's own sheet."""
    machine = drum({"material.name": "C45"}).resolved()
    (part,) = machine.assembly.parts
    facts = facts_of(machine, part)
    names = [name for name, _ in facts.tracks]
    assert names == ["wing, z 0 to 6", "tail, z 6 to 12", "beak, z 12 to 18"]
    starts = [abs(points[0][1]) for _, points in facts.tracks]
    assert starts == pytest.approx([disc.geometry.base_radius for disc in machine.discs.values()])
    assert starts[:2] == pytest.approx([26, 19])
    paths = write_drawing(tmp_path, "d", part, 1e-3, facts)
    assert [path.name for path in paths[2:4]] == [
        "d-drum-tracks-drawing.dxf",
        "d-drum-tracks-drawing.pdf",
    ]
    own, *others = (
        [e.dxf.text for e in ezdxf.readfile(path).modelspace().query("TEXT")] for path in paths[::2]
    )
    tables = list(itertools.chain(*others))
    for (name, points), start in zip(facts.tracks, starts, strict=True):
        first = tables.index(f"Track {name}: theoretically exact")
        angle = math.degrees(cmath.phase(points[0][1])) % 360
        rider = facts.riders[names.index(name)]
        heads = ["Cam", "At", "Radius", *["Axis at", "Axis"][: 2 * (0 < rider.radius < math.inf)]]
        row = tables[first + 1 + len(heads) :][: len(heads)]
        assert tables[first + 1 :][: len(heads)] == heads
        assert row[:3] == ["0%%d", f"{angle:.2f}%%d", f"{start:.3f}"]
        if row[3:]:  # in a dwell: the axis lies behind the point that it touches
            assert row[3] == row[1] and float(row[4]) == pytest.approx(start + rider.radius)
    assert {"0.05 CZ", "each track", "Profile by STL, z 0 to 6"} <= set(own)
    assert "Radius" not in own and not [text for text in own if "DXF" in text]


def test_each_follower_is_shown_as_high_as_its_track() -> None:
    shown = {each.name: each.heights for each in animation(drum()).bodies}
    assert shown["wing-follower"] == (0.0, 6.0) and shown["tail-follower"] == (6.0, 12.0)
    assert shown["beak-follower"] == (12.0, 18.0)


# ---- files -----------------------------------------------------------------------------------------------------------


def failing(folder: Path, machine: CamDrum) -> Sequence[Finding]:
    """What is found of a folder whose STL is that of another drum."""
    path = folder / "bird-drum-drum.stl"
    own = path.read_bytes()
    try:
        write_stl(path, mesh(machine), "drum")
        return [each for each in camgen.check(folder).findings if not each.ok]
    finally:
        path.write_bytes(own)


@pytest.mark.long
def test_what_was_built_holds(folder: Path) -> None:
    assert failing(folder, drum()) == []
    pins = (folder / "bird-drum-pins.csv").read_text(encoding="utf-8").splitlines()
    assert pins[0] == "row,pin,height_mm,release_deg,place_deg,release_s" and len(pins) == 6
    assert pins[1].startswith("low,1,19.000000,250.000000,") and pins[1].endswith(",6.944444")


@pytest.mark.long
def test_a_pin_moved_by_a_twentieth_of_a_millimetre_is_named(folder: Path) -> None:
    off = math.degrees(0.05 / 15.5)
    found = {e.code: e for e in failing(folder, drum({"row.0.release_deg.1": 300 + off}))}
    moved = found["RELEASE_ANGLE"]
    assert moved.measured == pytest.approx(off, abs=1e-3)
    assert "row low, pin 2" in moved.message and "5.13 ms late" in moved.message
    assert "ROUND_TRIP" in found


@pytest.mark.long
def test_a_pin_that_is_missing_or_one_more_is_named(folder: Path) -> None:
    for releases, said in (
        ([250.0, 350.0], "row low: pin 2, at 300 deg, is missing"),
        (
            [250.0, 300.0, 320.0, 350.0],
            "row low: pin 2, at 300 deg, is not alone: 2 let go near there",
        ),
    ):
        found = failing(folder, drum({"row.0.release_deg": releases}))
        (missing,) = (each for each in found if each.code == "RELEASE_ANGLE")
        assert math.isnan(missing.measured) and missing.message == said


@pytest.mark.long
@pytest.mark.parametrize("track", [0, 1, 2])
def test_a_track_that_is_turned_is_named(folder: Path, track: int) -> None:
    """By half a degree: its first and last segment are longer and shorter by that."""
    span = BIRD["track"][track]["segment"][0]["span_deg"]
    found = failing(folder, drum({f"track.{track}.segment.0.span_deg": span + 0.5}))
    (error,) = (each for each in found if each.code == "MOTION_ERROR")
    name = ("wing_lift", "tail_swing", "beak_lift")[track]
    assert error.where.output == name and error.message.startswith(name)


@pytest.mark.long
def test_a_face_at_another_height_is_told(folder: Path) -> None:
    found = failing(
        folder, drum({"track.0.thickness": 5.95, "track.1.height": 5.95, "track.1.thickness": 6.05})
    )
    (level,) = (each for each in found if each.code == "ROUND_TRIP" and each.where.kind == "stl")
    assert level.measured == pytest.approx(0.05, abs=1e-5)
    assert level.message == "the flat face at z 6 is 0.05 mm off its height"


@pytest.mark.long
def test_what_a_printer_takes_is_taken_back_before_pins_are_judged(tmp_path: Path) -> None:
    report = build(
        SPEC,
        tmp_path,
        frozenset({"stl"}),
        overrides=["print.profile_compensation=0.1", "print.hole_compensation=0.1"],
    )
    assert report.ok
    assert sum(each.code == "RELEASE_ANGLE" for each in report.findings) == 2


@pytest.mark.long
def test_a_pin_that_hardly_reaches_over_its_tooth_is_seen(tmp_path: Path) -> None:
    report = build(SPEC, tmp_path, frozenset({"stl"}), overrides=["pin.radius=15.202"])
    assert report.ok


def test_of_steel_it_is_told_that_no_force_is_judged() -> None:
    assert not list(drum().assembly.unjudged)
    steel = drum({"material.name": "C45"})
    assert {each.code for each in steel.assembly.unjudged} == {"LIFT_OFF", "HERTZ"}


def test_the_resolved_spec_makes_the_same_drum() -> None:
    machine = validate(
        CamDrum,
        {**BIRD, "track": [{k: v for k, v in BIRD["track"][0].items() if k != "base_radius"}]},
    )
    found = machine.resolved()
    assert found.track[0].base_radius == machine.discs["wing"].base_radius > 12
    assert found.geometry.length == 22.0 and found.resolved() == found


# ---- wrong specs -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("changes", "key", "said"),
    [
        ({"track.1.height": 5.0}, "track.1.height", "6, where wing ends, or at least 6.8"),
        ({"row.1.name": "wing"}, "row.1.name", "a name of its own"),
        ({"tooth": None}, "tooth", "missing"),
        ({"row": None}, "pin", "no table here without"),
        (
            {"tooth.radius": 16.0},
            "tooth.radius",
            "between the core, 12 mm, and the ends of the pins, 15.5 mm",
        ),
        ({"pin.radius": 11.0}, "pin.radius", "more than the core, 12 mm"),
        ({"row.0.release_deg": [10.0, 9.0]}, "row.0.release_deg.1", "more than"),
        ({"row.0.release_deg": [1.0, 359.0]}, "row.0.release_deg.0", "its own width behind"),
        ({"geometry.length": 20.0}, "geometry.length", "at least 22, where high ends"),
        (
            {"track.1.follower.arm": None},
            "track.1.follower.arm",
            "missing: an oscillating roller or knife edge has an arm",
        ),
        (
            {"track.0.follower.radius": None},
            "track.0.follower.radius",
            "missing: a roller has a radius",
        ),
        ({"track.0.segment.0.lift": 9.0, "track.0.segment.3.to": 1.0}, "track.0.segment", "0"),
        ({"track.0.follower.shape": "outline"}, "track.0.follower.shape", "roller"),
        ({"pin.radius": 15.2019}, "pin.radius", "at least 15.202: 2 accuracy.chord_tolerance"),
        ({"limits.min_wall": 0.2}, "limits.min_wall", "nozzle"),
        ({"files.cutter_radius": 2.0}, "files.cutter_radius", "no outline to cut"),
        ({"load.stiffness": 200.0}, "load.stiffness", "count as rigid"),
        ({"parts.bore_shape": "d-flat", "parts.flat_depth": 9.0}, "parts.flat_depth", "bore"),
    ],
)
def test_wrong_keys_are_told_by_their_names(
    changes: Mapping[str, Any], key: str, said: str
) -> None:
    with pytest.raises(SpecError) as told:
        drum(changes)
    faults = {fault.key: fault for fault in told.value.faults}
    assert any(each.startswith(key) for each in faults), faults
    assert said in str(told.value)


@pytest.mark.long
def test_outlines_of_too_many_points_are_refused_with_a_tolerance_that_does(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The union of layers takes a time that grows almost with the square of the points: 200 s of a processor at 1e-6."""
    (part,) = camgen.load(TOP / "specs" / "drum.toml").assembly.parts
    for tolerance in (1e-6, 1e-12):
        with pytest.raises(DesignError, match=r"accuracy\.chord_tolerance is 1e-\d+ mm") as refused:
            solid(part, tolerance)
        assert 5e-6 < refused.value.limit < 1e-5
    monkeypatch.setattr(solids, "_MOST_POINTS", 3000)
    with pytest.raises(DesignError) as refused:
        solid(part, 1e-4)
    advised = refused.value.limit
    assert 1e-4 < advised < 2e-3 and solid(part, advised).volume > 0
    with pytest.raises(DesignError):
        solid(part, advised / 2)


def test_a_core_that_hides_a_track_is_refused() -> None:
    with pytest.raises(DesignError, match=r"core.*track beak"):
        drum({"geometry.core_radius": 16.5, "row": None, "pin": None, "tooth": None}).limits()
