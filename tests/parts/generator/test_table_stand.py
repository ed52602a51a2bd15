"""What a machine stands on: its tabs fit their slots, nothing of the machine meets it or the table, and it does not tip."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from camgen import load
from camgen.errors import SpecError
from camgen.files.threemf import write_3mf
from camgen.findings import Finding
from camgen.geometry.facets import facet_contour
from camgen.geometry.mesh import Mesh
from camgen.judge.assembly import sweep
from camgen.judge.tipping import Standing, judge_tipping
from camgen.machines.loads.assess import assess
from camgen.machines.mechanism import Mechanism
from camgen.machines.sources import read_mechanism
from camgen.parts.assembly import Assembly, bodies_in_motion, order_of_assembly
from camgen.parts.generator.table_stand import sweeps
from camgen.parts.solids import solid
from camgen.pipeline import build as pipeline
from camgen.pipeline.making import assembly_copies

SPECS = Path(__file__).resolve().parents[3] / "specs"
KINDS = (
    ("board", "parts.hand_crank=25"),
    ("box", "parts.hand_crank=0", "parts.motor='nema-17'", "motor.model='17HS19-2004S1'"),
)


@cache
def machine(*keys: str) -> Mechanism:
    """The four-bar of the gallery."""
    stand, *rest = keys
    more = [f"parts.stand='{stand}'", "accuracy.chord_tolerance=0.01", *rest]
    return pipeline.read_mechanism(SPECS / "gallery/four-bar.toml", more)


@cache
def solids(*keys: str) -> Mapping[str, Mesh]:
    made = machine(*keys).assembly
    return {part.name: solid(part, 0.01) for part in made.parts}


def moved(mesh: Mesh, *shift: float) -> Mesh:
    return Mesh(mesh.vertices + np.array(shift), mesh.faces)


def judged(path: Path, keys: Sequence[str], **changed: Mesh) -> list[Finding]:
    """Sweep and tipping of the written assembly, in which some solids are others."""
    found = machine(*keys)
    own = {name.replace("_", "-"): mesh for name, mesh in changed.items()}
    write_3mf(path, {**solids(*keys), **own}, assembly_copies(found), "key")
    made = found.assembly
    densities = dict.fromkeys(made.by_name, 1.2e-3)
    assert made.support is not None
    machine_in_motion = bodies_in_motion(made)
    tips = judge_tipping(path, machine_in_motion, Standing(made.support.down, densities))
    return [*sweep(path, machine_in_motion)[0], tips]


def failing(found: Sequence[Finding]) -> dict[str, list[str]]:
    fails: dict[str, list[str]] = {}
    for each in found:
        if not each.ok:
            fails.setdefault(each.code, []).append(str(each.where))
    return fails


@pytest.mark.long
@pytest.mark.parametrize("keys", KINDS, ids=lambda keys: keys[0])
def test_it_stands_free_of_all_that_moves(keys: Sequence[str], tmp_path: Path) -> None:
    found = judged(tmp_path / "a.3mf", keys)
    assert failing(found) == {}
    assert [each.code for each in found][-1] == "TIPPING"


@pytest.mark.long
def test_a_slot_out_of_its_place_is_found(tmp_path: Path) -> None:
    """The foot 1 mm to the side: its slots meet the tabs of panel and gussets."""
    foot = solids(*KINDS[0])["stand-foot"]
    fails = failing(judged(tmp_path / "a.3mf", KINDS[0], stand_foot=moved(foot, 1.0, 0, 0)))
    assert set(fails) == {"INTERFERENCE"}
    assert any("stand-panel-1" in where for where in fails["INTERFERENCE"])
    assert any("stand-gusset-1" in where for where in fails["INTERFERENCE"])


def test_fingers_out_of_their_places_are_found(tmp_path: Path) -> None:
    end = solids(*KINDS[1])["stand-end"]
    fails = failing(judged(tmp_path / "a.3mf", KINDS[1], stand_end=moved(end, 0, 1.0, 0)))
    assert any("stand-side" in where for where in fails["INTERFERENCE"])


@pytest.mark.long
def test_a_board_that_is_too_low_is_found(tmp_path: Path) -> None:
    """The foot 45 mm higher: the hand crank meets it. Its own z points down."""
    foot = solids(*KINDS[0])["stand-foot"]
    fails = failing(judged(tmp_path / "a.3mf", KINDS[0], stand_foot=moved(foot, 0, 0, -45)))
    assert any("crank" in where and "stand-foot" in where for where in fails["INTERFERENCE"])


@pytest.mark.long
def test_a_foot_that_is_too_short_tips(tmp_path: Path) -> None:
    foot = solids(*KINDS[0])["stand-foot"]
    short = Mesh(foot.vertices * np.array([1, 0.05, 1]), foot.faces)
    fails = failing(judged(tmp_path / "a.3mf", KINDS[0], stand_foot=short))
    assert "TIPPING" in fails


def test_a_brick_tips_at_the_angle_of_its_edge(tmp_path: Path) -> None:
    """Of the foot alone: about the edge that is nearer to its centroid, which slots and windows shift, at atan(distance / half its
    thickness)."""
    found = machine(*KINDS[0])
    made = found.assembly
    densities = {name: float(name == "stand-foot") for name in made.by_name}
    path = tmp_path / "a.3mf"
    write_3mf(path, solids(*KINDS[0]), assembly_copies(found), "key")
    assert made.support is not None
    finding = judge_tipping(path, bodies_in_motion(made), Standing(made.support.down, densities))
    foot = made.by_name["stand-foot"]
    rim, *holes = (
        [(z.real, z.imag) for z in facet_contour(each, 0.01).tolist()]
        for each in (foot.region.outer, *foot.region.holes)
    )
    area = shapely.Polygon(rim, holes)
    _, low, _, high = area.bounds
    edge = min(area.centroid.y - low, high - area.centroid.y)
    expected = math.degrees(math.atan2(edge, foot.thickness / 2))
    assert finding.measured == pytest.approx(expected, abs=0.02)


def _rings(made: Assembly, part: str) -> list[np.ndarray]:
    return [
        np.array([complex(piece.at(piece.t0)) for piece in hole.pieces])
        for hole in made.by_name[part].region.holes
        if len(hole.pieces) == 4
    ]


@settings(max_examples=8, deadline=None)
@given(
    slide=st.floats(0.1, 0.5),
    thickness=st.floats(3.0, 6.0),
    reach=st.floats(60.0, 140.0),
    gravity=st.sampled_from([-90.0, 180.0, 37.0]),
)
def test_tabs_fit_their_slots_whatever_the_machine(
    slide: float, thickness: float, reach: float, gravity: float
) -> None:
    """A slot is wider and longer than its tab by what slides; all that moves stays over the foot, whichever way is down."""
    keys = {
        "print.slide_clearance": slide,
        "parts.thickness": thickness,
        "lengths.A-P": reach,
        "lengths.B-P": reach - 37.5,
        "limits.lash": 50,
        "load.gravity_deg": gravity,
    }
    found = machine("board", "parts.hand_crank=30", *(f"{k}={v!r}" for k, v in keys.items()))
    made = found.assembly
    slots = [z for z in _rings(made, "stand-foot") if min(np.ptp(z.real), np.ptp(z.imag)) < 9.9]
    tabs = made.by_name["stand-panel"].region.outer
    low = min(complex(piece.at(piece.t0)).imag for piece in tabs.pieces)
    ends = sorted(
        complex(piece.at(piece.t0)).real
        for piece in tabs.pieces
        if abs(complex(piece.at(piece.t0)).imag - low) < 1e-6
    )
    wide = sorted((z.real.min(), z.real.max()) for z in slots if np.ptp(z.real) > 2 * thickness)
    for (a, b), tab in zip(wide, (ends[:2], ends[2:]), strict=True):
        assert (b - a) - (tab[1] - tab[0]) == pytest.approx(slide, abs=1e-6)
        assert (a + b) / 2 == pytest.approx(sum(tab) / 2, abs=1e-6)
    across = [min(np.ptp(z.real), np.ptp(z.imag)) for z in slots]
    assert across == pytest.approx([thickness + slide] * 4, abs=1e-6)
    (foot,) = (each for each in made.mounts if each.part == "stand-foot")
    down = np.exp(1j * math.radians(gravity))
    assert foot.upright and abs(np.exp(1j * foot.angle) - 1j * down) < 1e-9
    floor = (foot.at / -down).real
    own = replace(
        made,
        mounts=[each for each in made.mounts if not each.part.startswith("stand")],
        stand_ins=[each for each in made.stand_ins if each.name != "table"],
    )
    lowest = min(each.box[0].imag for each in sweeps(own, complex(-down / 1j)))
    assert lowest - floor >= 2.0 - 1e-6


def test_the_last_step_is_a_machine_on_the_table() -> None:
    table = order_of_assembly(machine(*KINDS[0]).assembly)
    rows = [(row[1], row[2]) for row in table.rows]
    name, said = rows[-1]
    assert name == "table" and said.startswith("Stand it on the table. The hand crank turns it")
    names = [name for name, _ in rows]
    assert names.index("stand-panel") < names.index("ground")
    assert names[-3:] == ["stand-gusset", "stand-foot", "table"]
    place = names.index("ground")
    assert "screw of the plate, through the stand" in str(table.rows[place][3])
    assert names[place - 1] == names[place + 1] == "stand-panel", "both go on the shaft together"
    assert not any("of yours" in str(cell) for row in table.rows for cell in row)


def test_no_hand_turns_a_crank_in_a_box() -> None:
    with pytest.raises(SpecError, match="a hand cannot reach into a box"):
        machine("box", "parts.hand_crank=25")


def test_cams_alone_have_no_stand() -> None:
    with pytest.raises(SpecError, match="cams alone have no plate"):
        pipeline.read_mechanism(SPECS / "disc-cam.toml", ["parts.make='cams'", "parts.stand='box'"])


def test_a_machine_of_two_sides_has_no_stand() -> None:
    with pytest.raises(SpecError, match="stands by itself"):
        machine("board", "parts.sides=2")


@pytest.mark.long
def test_a_machine_on_a_stand_bears_its_weight_downwards_unless_the_spec_says_another_way() -> None:
    """Torque by weight alone: with the spec's own gravity_deg = -90 the same, with none of it less."""
    spec = SPECS / "gallery" / "four-bar.toml"
    stands = pipeline.read_mechanism(spec)
    flat = pipeline.read_mechanism(spec, ["parts.stand="])
    told = pipeline.read_mechanism(spec, ["load={gravity_deg=-90}"])
    sideways = pipeline.read_mechanism(spec, ["load={gravity_deg=0}"])
    torque = [
        assess(each).study.numbers["drive_torque_n_m"] for each in (stands, flat, told, sideways)
    ]
    assert torque[0] == torque[2] > 2 * torque[1]
    assert torque[3] != torque[0]
    lies = pipeline.read_mechanism(spec, ["parts.stand='box'", "parts.hand_crank="])
    assert "load" not in lies.resolved().model_dump(exclude_none=True)


def test_a_panel_is_a_frame_where_nothing_is_screwed_on() -> None:
    """The four-bar's panel was 29.3 cm^3; its windows leave 4 mm and more, twice a wall, to every side and to all other holes."""
    spec = Path(__file__).parents[3] / "specs" / "gallery" / "four-bar.toml"
    panel = read_mechanism(spec).assembly.by_name["stand-panel"]
    (layer,) = panel.layers
    assert layer.region.area * (layer.z1 - layer.z0) < 0.5 * 29.3e3
    shapes = [
        shapely.Polygon([(z.real, z.imag) for z in facet_contour(each, 0.01).tolist()])
        for each in layer.region.holes
    ]
    window, *others = sorted(shapes, key=lambda each: each.bounds[1])
    outer = facet_contour(layer.region.outer, 0.01)
    rim = shapely.LinearRing([(z.real, z.imag) for z in outer.tolist()])
    assert window.area > 400 and window.distance(rim) > 3.99
    assert min(window.distance(each) for each in others) > 3.95


def test_a_panel_has_a_window_between_holes_that_are_far_apart() -> None:
    """The bird's plate is screwed on under its shaft and over it: the window lies between the shaft and the upper screw."""
    spec = Path(__file__).parents[3] / "specs" / "gallery" / "flapping-bird.toml"
    (layer,) = read_mechanism(spec).assembly.by_name["stand-panel"].layers
    shapes = [
        shapely.Polygon([(z.real, z.imag) for z in facet_contour(each, 0.01).tolist()])
        for each in layer.region.holes
    ]
    *others, window = sorted(shapes, key=lambda each: each.area)
    heights = sorted(
        each.centroid.y for each in others if each.bounds[0] > -50 < 50 > each.bounds[2]
    )
    windows = [each for each in others if each.area > 500]
    heights = sorted({*heights} - {each.centroid.y for each in windows})
    assert len(heights) == 3 and heights[1] < window.centroid.y < heights[2]
    assert len(windows) == 2 and window.area > 1500
    assert min(window.distance(each) for each in others) > 3.95


def test_a_stand_takes_less_than_half_of_the_bird_s_printing() -> None:
    """By volumes: time grows with them, and every part of the stand is as thick as a link; a gusset is a frame too."""
    bird = read_mechanism(Path(__file__).parents[3] / "specs" / "gallery" / "flapping-bird.toml")
    support = bird.assembly.support
    assert support is not None
    volumes = {part.name: part.count * part.volume for part in bird.assembly.parts}
    stand = sum(volumes[name] for name in support.parts)
    assert stand < 0.62 * sum(volumes.values()), "3.3 of 5.6 hours were 72 percent of the volume"
    (layer,) = bird.assembly.by_name["stand-gusset"].layers
    (hole,) = layer.region.holes
    rim = shapely.LinearRing([(z.real, z.imag) for z in facet_contour(layer.region.outer, 0.01)])
    inner = shapely.LinearRing([(z.real, z.imag) for z in facet_contour(hole, 0.01)])
    assert rim.distance(inner) > 3.99


def test_high_walls_of_a_box_have_windows_and_shallow_ones_have_none() -> None:
    """Round a motor: 10 mm are left to the fingers' ends and to the lid, through whose notches the tabs go; 20 mm leave no room."""
    walls = machine(*KINDS[1]).assembly.by_name
    for name in ("stand-side", "stand-end"):
        (layer,) = walls[name].layers
        (window,) = layer.region.holes
        rim = facet_contour(layer.region.outer, 0.01)
        hole = facet_contour(window, 0.01)
        top = max(hole.imag)
        assert top == pytest.approx(-4 - 10) and min(hole.imag) - min(rim.imag) > 9.99
        edge = shapely.LinearRing([(z.real, z.imag) for z in rim.tolist()])
        inner = shapely.LinearRing([(z.real, z.imag) for z in hole.tolist()])
        assert 5.99 < inner.distance(edge), "a finger is 4 deep"
        assert abs(window.area) > 400
    low = machine("box", "parts.hand_crank=0").assembly.by_name
    assert all(len(low[name].region.holes) == 0 for name in ("stand-side", "stand-end"))


def test_what_a_laser_cuts_has_slots_by_the_press_fit() -> None:
    """The kerf decides how sheets go together: the gallery's four-bar of sheet of 3 mm, its slots 0.07 wider."""
    spec = tomllib.loads((SPECS / "gallery/four-bar.toml").read_text(encoding="utf-8"))
    spec["parts"] = {"make": "laser", "stand": "board"}
    spec["laser"] = {"thickness": 3.0}
    spec["print"] = {"press_clearance": 0.07, "slide_clearance": 0.2}
    made = load(spec).assembly
    slots = [z for z in _rings(made, "stand-foot") if min(np.ptp(z.real), np.ptp(z.imag)) < 9.9]
    across = [min(np.ptp(z.real), np.ptp(z.imag)) for z in slots]
    assert across == pytest.approx([3.07] * 4, abs=1e-6)
