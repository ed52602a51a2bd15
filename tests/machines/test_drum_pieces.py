"""A groove in two pieces: put together from both files it is the groove in one, and wrong pieces are seen."""

from __future__ import annotations

import json
import math
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import manifold3d
import numpy as np
import pytest

from camgen.errors import DesignError, SpecError
from camgen.files.stl import write_stl
from camgen.findings import Finding
from camgen.geometry.mesh import Mesh
from camgen.judge.drum_pieces import placed, together
from camgen.judge.rolled_drum import roll, roller_table
from camgen.machines.cylinder_cam.mechanism import CylinderCam
from camgen.parts.inertia import centre_of, inertia_of, mass_moments
from camgen.parts.solids import solid
from camgen.pipeline import build as pipeline
from camgen.pipeline.case import Case
from camgen.pipeline.drums import judge_drum
from camgen.spec import validate

SPEC = Path(__file__).parents[2] / "specs" / "cylinder-cam.toml"
TOLERANCE = 0.01
ARM = {"motion": "oscillating", "arm": 40.0}
FOLLOWERS: dict[str, dict[str, Any]] = {
    "slide": {},
    "offset": {"follower": {"offset": 4.0}},
    "arm": {"follower": ARM},
    "cone": {"roller": {"radius": 5.0, "length": 6.0, "cone_deg": 10.0}},
}
Change = Callable[[Mesh], Mesh]


def drum(pieces: int = 2, **tables: dict[str, Any]) -> CylinderCam:
    """The starter with an unsymmetric rise; tables: keys in place of its own."""
    data = tomllib.loads(SPEC.read_text(encoding="utf-8"))
    data["geometry"]["roller"]["length"] = 6.0
    data["accuracy"] = {"chord_tolerance": TOLERANCE}
    data["segment"][0] |= {"span_deg": 100.0, "law": "3-4-5"}
    tables["parts"] = {"pieces": pieces, **tables.get("parts", {})}
    tables["limits"] = {"lash": 1.0, **tables.get("limits", {})}
    for name, keys in tables.items():
        data[name] = {**data.get(name, {}), **keys}
    return validate(CylinderCam, data)


def same(mesh: Mesh) -> Mesh:
    return mesh


def moved(z: float) -> Change:
    return lambda mesh: Mesh(mesh.vertices + [0, 0, z], mesh.faces)


def turned(degrees: float, above: float = -math.inf) -> Change:
    """What lies higher than a height in the file, turned about the axis."""

    def change(mesh: Mesh) -> Mesh:
        z = (mesh.vertices[:, 0] + 1j * mesh.vertices[:, 1]) * np.exp(1j * math.radians(degrees))
        there = np.column_stack([z.real, z.imag, mesh.vertices[:, 2]])
        high = mesh.vertices[:, 2] > above
        return Mesh(np.where(high[:, None], there, mesh.vertices), mesh.faces)

    return change


def verdicts(
    path: Path, made: CylinderCam, ring: Change = same, lower: Change = same
) -> list[Finding]:
    """What the judge says of both files, the ring or the drum changed."""
    case = Case(made, path)
    for part, change in zip(made.assembly.parts, (lower, ring), strict=True):
        write_stl(case.file(part.name, "stl"), change(solid(part, TOLERANCE)), part.name)
    return list(judge_drum(case, ["stl"]).findings)


def failing(found: list[Finding]) -> set[str]:
    return {each.code for each in found if not each.ok}


@pytest.mark.long
@pytest.mark.parametrize("kind", FOLLOWERS)
def test_both_pieces_together_are_the_groove_in_one(kind: str) -> None:
    """The motion and the play of one drum, whose pieces are one, rolled in each mesh: they differ by facets alone."""
    made = drum(geometry=FOLLOWERS[kind])
    track = made.track
    geometry = {
        **FOLLOWERS[kind],
        "radius": track.radius,
        "length": track.length,
        "follower": {**FOLLOWERS[kind].get("follower", {}), "height": track.height},
    }
    whole = drum(1, geometry=geometry)
    table = roller_table(made.assembly.tracks[0], TOLERANCE)
    lower, ring = (solid(part, TOLERANCE) for part in made.assembly.parts)
    both = roll(together(lower, placed(ring, track.length)), table, 60, 720)
    one = roll(solid(whole.assembly.parts[0], TOLERANCE), table, 60, 720)
    facets = 2 * TOLERANCE / math.cos(math.radians(36)) / (table.arm or 1.0)
    assert both.low == pytest.approx(one.low, abs=facets)
    assert both.high == pytest.approx(one.high, abs=facets)
    assert not both.cut.any()
    assert np.ptp(both.motion) == pytest.approx(np.ptp(made.program(both.theta)), abs=facets)


def test_pieces_are_sound_and_no_face_of_them_hangs() -> None:
    """By the meshes: each is one closed body of its volume and inertia, and but for its underside nothing looks down."""
    made = drum(print={"press_clearance": 0.1})
    for part in made.assembly.parts:
        mesh = solid(part, 0.002)
        body = manifold3d.Manifold(
            manifold3d.Mesh64(np.array(mesh.vertices), np.array(mesh.faces, np.uint64))
        )
        assert body.status() == manifold3d.Error.NoError and len(body.decompose()) == 1
        assert part.volume == pytest.approx(body.volume(), rel=3e-4)
        moments = mass_moments(mesh, 1000.0)
        polar = moments.second[0, 0] + moments.second[1, 1]
        polar += moments.mass * (moments.centre[0] ** 2 + moments.centre[1] ** 2)
        assert inertia_of(part, 1000.0) == pytest.approx(polar * 1e-6, rel=1e-3)
        centre = complex(moments.centre[0], moments.centre[1])
        assert centre_of(part) == pytest.approx(centre, abs=1e-3 * made.track.radius)
        lean = mesh.across[:, 2] / np.linalg.norm(mesh.across, axis=1)
        hanging = (lean < -1e-6) & (mesh.vertices[mesh.faces][:, :, 2].max(axis=1) > 0)
        assert not hanging.any(), part.name
    whole = solid(drum(1).assembly.parts[0], 0.01)
    lean = whole.across[:, 2] / np.linalg.norm(whole.across, axis=1)
    assert ((lean < -0.9) & (whole.vertices[whole.faces][:, :, 2].min(axis=1) > 1)).any()


@pytest.mark.long
def test_wrong_pieces_are_seen(tmp_path: Path) -> None:
    made = drum()
    assert failing(verdicts(tmp_path, made)) == set()
    whole = failing(verdicts(tmp_path, made, turned(1.0)))
    assert {"MOTION_ERROR", "PIN_GAP", "INTERFERENCE"} <= whole
    key = made.assembly.parts[1].layers[0].z1
    wall = verdicts(tmp_path, made, turned(1.0, key + 1e-3))
    assert failing(wall) >= {"MOTION_ERROR", "LASH"} or "GROOVE_FIT" in failing(wall)
    assert "PIN_GAP" not in failing(wall)
    (error,) = (each.measured for each in wall if each.code == "MOTION_ERROR")
    steepest = float(np.max(np.abs(made.program(np.linspace(0, 7, 5000), 1))))
    assert error == pytest.approx(math.radians(1) * steepest / 2, abs=0.02)  # of one wall of two


@pytest.mark.parametrize("way", [0.05, -0.05])
def test_a_ring_that_sits_too_high_or_too_deep_is_seen(way: float, tmp_path: Path) -> None:
    """In the ring's own file up is down on the drum: its wall and its seat go by 0.05 mm, the middle of both walls by half."""
    found = verdicts(tmp_path, drum(), moved(way))
    assert {"MOTION_ERROR", "PIN_GAP"} <= failing(found)
    seat = next(each for each in found if each.code == "PIN_GAP")
    assert seat.measured == pytest.approx(0.05, abs=1e-3)
    assert ("INTERFERENCE" in failing(found)) == (way > 0)
    (error,) = (each.measured for each in found if each.code == "MOTION_ERROR")
    assert error == pytest.approx(0.025, abs=TOLERANCE)


@pytest.mark.long
def test_a_thick_core_and_a_seat_that_is_gone_are_seen(tmp_path: Path) -> None:
    def thicker(mesh: Mesh) -> Mesh:
        """The core, as far as it is round, 0.3 mm wider: the ring has 0.1 mm of play on a side."""
        rho = np.hypot(mesh.vertices[:, 0], mesh.vertices[:, 1])
        core = np.abs(rho - made.track.floor) < 1e-4
        return Mesh(
            mesh.vertices * np.where(core, 1 + 0.3 / rho, 1)[:, None] ** [1, 1, 0], mesh.faces
        )

    made = drum()
    assert "INTERFERENCE" in failing(verdicts(tmp_path, made, lower=thicker))
    gone = verdicts(tmp_path, made, moved(-5.0))
    assert any(each.code == "PIN_GAP" and math.isnan(each.measured) for each in gone)


def test_the_keys_play_is_told(tmp_path: Path) -> None:
    """A flat of half the length l lets its ring turn by half the clearance over l; the follower goes by half of its wall's way."""
    made = drum(print={"press_clearance": 0.1}, geometry={"radius": 30.0})
    case = Case(made, tmp_path)
    for part in made.assembly.parts:
        write_stl(case.file(part.name, "stl"), solid(part, TOLERANCE), part.name)
    outcome = judge_drum(case, ["stl"])
    numbers = {each.key: each.value for each in outcome.numbers.records}
    core = made.track.floor - 1.5  # half of parts.wall
    flat = core / 2
    half = math.sqrt(core**2 - flat**2)
    play = math.degrees(0.05 / half)
    assert numbers["key_play_stl_deg"] == pytest.approx(play, rel=0.02)
    steepest = float(np.max(np.abs(made.program(np.linspace(0, 7, 5000), 1))))
    wanted = math.radians(play) * steepest / 2
    assert numbers["follower_by_key_play_stl_mm"] == pytest.approx(wanted, rel=0.02)
    assert failing(list(outcome.findings)) == set()


@pytest.mark.long
def test_a_build_has_both_pieces_and_their_steps(tmp_path: Path) -> None:
    settings = [f"accuracy.chord_tolerance={TOLERANCE}"]
    report = pipeline.build(SPEC, tmp_path, frozenset({"stl", "3mf"}), settings)
    assert [each for each in report.findings if not each.ok] == []
    told = json.loads((tmp_path / "cylinder-cam" / "report.json").read_text())
    assert [part["name"] for part in told["parts"]] == ["drum", "ring"]
    assert told["numbers"]["supports_mm2"] == 0
    steps = next(each for each in told["tables"] if each["title"] == "Assembly of the drum")
    assert [row[1] for row in steps["rows"] if row[1]][:2] == [
        "drum",
        "ring",
    ]  # then what is bought
    assert not list((tmp_path / "cylinder-cam").rglob("*developed*"))
    again = pipeline.read_mechanism(tmp_path / "cylinder-cam" / "spec.toml")
    assert isinstance(again, CylinderCam)
    assert again.track.length == pytest.approx(told["numbers"]["drum_length_mm"], abs=1e-9)
    assert pipeline.check(tmp_path / "cylinder-cam").ok


@pytest.mark.parametrize(
    "settings, count",
    [
        ([], 2),
        (["geometry.track=end"], 1),
        (["geometry.track=rib", "geometry.distance=16"], 1),
        (["material.name=42CrMo4"], 1),
        (["files.cutter_radius=4"], 1),
        (["geometry.roller.end_clearance=0.05"], 1),
        (["parts.pieces=1"], 1),
    ],
)
def test_a_printed_groove_is_in_two_pieces_unless_the_spec_says_one(
    settings: list[str], count: int
) -> None:
    """A support in the groove stands where the roller runs; a cutter leaves a metal drum whole; the rest has no upper wall."""
    made = pipeline.read_mechanism(SPEC, settings)
    assert len(made.assembly.parts) == count
    assert made.resolved().making.pieces == count  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    "tables, told",
    [
        ({"geometry": {"track": "end"}}, 'parts.pieces: 2 - expected 1: a track = "end"'),
        ({"files": {"cutter_radius": 3.0}}, "a drum in two pieces is printed"),
        ({"print": {"slide_clearance": 1.2}}, "geometry.roller.end_clearance"),
        ({"parts": {"pieces": 3}}, "parts.pieces"),
    ],
)
def test_what_cannot_be_in_two_pieces_is_told(tables: dict[str, Any], told: str) -> None:
    with pytest.raises(SpecError) as error:
        drum(**tables)
    assert told in str(error.value)


@pytest.mark.parametrize(
    "sizes", [{"radius": 21.0}, {"length": 31.0, "follower": {"height": 10.6}}]
)
def test_a_drum_without_room_for_the_key_is_told(sizes: dict[str, Any]) -> None:
    made = drum(geometry=sizes, parts={"wall": 6.0}, limits={"pressure_angle_deg": 60.0})
    with pytest.raises(DesignError, match=rf"geometry\.{next(iter(sizes))}.*no room for the key"):
        made.assembly  # noqa: B018


def test_a_roller_that_passes_beside_its_drum_is_told() -> None:
    """Half way along it is hypot(25, 12) = 27.7 from the axis of a drum of 26."""
    sizes = {"radius": 26.0, "follower": {"offset": 12.0}}
    sizes["roller"] = {"radius": 5.0, "length": 1.0}
    with pytest.raises(DesignError, match="the middle of the roller lies beside the drum"):
        drum(1, geometry=sizes, limits={"pressure_angle_deg": 60.0}).assembly  # noqa: B018


def test_an_arm_that_leaves_a_cone_no_contact_is_no_drum() -> None:
    """Its roller is farther beside the drum than the cone's normals reach: told without a warning of numbers."""
    follower = {**ARM, "arm": 131.4, "start_deg": 65.56}
    roller = {"radius": 8.7, "length": 0.32, "cone_deg": -43.9, "end_clearance": 5.76}
    sizes = {"track": "end", "roller": roller, "follower": follower}
    made = drum(1, geometry=sizes, limits={"pressure_angle_deg": 33.8})
    with pytest.raises(DesignError):
        made.assembly  # noqa: B018
