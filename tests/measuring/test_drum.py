"""`camgen motion DRUM.stl --roller`: drums as files, sound and damaged, and what is typed wrong."""

from __future__ import annotations

import csv
import json
import math
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st

sys.path.insert(0, str(Path(__file__).parents[1] / "geometry"))
from drums import ARM, END, PIVOT, REFERENCE, RIB, A, B, mesh_of  # noqa: E402

import camgen  # noqa: E402
from camgen.cli import cli  # noqa: E402
from camgen.errors import SpecError  # noqa: E402
from camgen.files.stl import write_stl  # noqa: E402
from camgen.geometry.drum_walls import slide_path  # noqa: E402
from camgen.geometry.mesh import Mesh  # noqa: E402
from camgen.judge.rolled_drum import roll  # noqa: E402
from camgen.measuring.drum import read_roller  # noqa: E402
from camgen.motion.segments import SegmentTable, program  # noqa: E402

TOLERANCE = 0.01
ROLLER = f"radius=5,length=7.3,inner=22,tolerance={TOLERANCE}"


@pytest.fixture(scope="module")
def groove() -> Mesh:
    """The reference's drum."""
    return mesh_of(A, TOLERANCE)


def call(file: Path, roller: str, *options: str) -> tuple[int, str]:
    """Exit code and what is printed."""
    words = ["motion", str(file), "--roller", roller, "-o", str(file.parent / "out"), *options]
    result = CliRunner().invoke(cli, words)
    assert result.exception is None or isinstance(result.exception, SystemExit)
    return result.exit_code, result.output


def report(file: Path) -> dict[str, Any]:
    """What was written."""
    path = file.parent / "out" / f"{file.stem}-motion" / "report.json"
    content: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return content


def rows(file: Path) -> dict[str, np.ndarray]:
    """The columns of motion.csv."""
    path = file.parent / "out" / f"{file.stem}-motion" / "motion.csv"
    with open(path, encoding="utf-8", newline="") as text:
        table = list(csv.DictReader(text))
    return {key: np.array([float(row[key]) for row in table]) for key in table[0]}


@pytest.mark.long
def test_a_groove_of_anyone_is_followed(groove: Mesh, tmp_path: Path) -> None:
    """On an axis along x, beside the origin: the frame of the file is the maker's."""
    moved = Mesh(groove.vertices[:, [2, 0, 1]] + [0, 7, -3], groove.faces)
    file = tmp_path / "drum.stl"
    write_stl(file, moved, "drum")
    code, text = call(file, f"{ROLLER},axis=x,centre=7/-3")
    assert code == 0, text
    columns = rows(file)
    assert list(columns)[:5] == [
        "theta_deg",
        "follower_mm",
        "follower_low_mm",
        "follower_high_mm",
        "play_mm",
    ]
    theta = columns["theta_deg"]
    assert theta == pytest.approx(np.arange(1441) / 4)
    wanted = A.path.height(-np.radians(theta), 0)
    assert np.max(np.abs(columns["follower_mm"] - wanted)) < TOLERANCE
    assert columns["follower_low_mm"] + columns["play_mm"] == pytest.approx(
        columns["follower_high_mm"], abs=1e-9
    )
    numbers = report(file)["numbers"]
    assert numbers["stroke_mm"] == pytest.approx(15, abs=TOLERANCE)
    steepest = float(REFERENCE["a"]["pressure_angle_deg"][0])
    assert numbers["pressure_angle_deg"] == pytest.approx(steepest, abs=0.2)
    assert numbers["peak_speed_mm_rad"] == pytest.approx(
        float(REFERENCE["a"]["peak_slope"]), abs=0.1
    )
    assert [each["code"] for each in report(file)["findings"]] == [
        "WATERTIGHT",
        "CONTACT",
        "GROOVE_FIT",
        "INTERFERENCE",
    ]
    assert (file.parent / "out" / "drum-motion" / "report.html").exists()


def test_a_groove_that_is_too_narrow_fails_at_its_place(tmp_path: Path) -> None:
    narrow = mesh_of(replace(A, roller=replace(A.roller, radius=4.97)), TOLERANCE)
    file = tmp_path / "drum.stl"
    write_stl(file, narrow, "drum")
    code, text = call(file, ROLLER)
    assert code == 1
    assert "GROOVE_FIT" in text
    (fit,) = (each for each in report(file)["findings"] if each["code"] == "GROOVE_FIT")
    # both walls by 0.03, along the axis that over cos(33 deg) at most
    assert -0.06 / 0.838 - 2 * TOLERANCE < fit["measured"] < -0.06
    assert fit["limit"] == pytest.approx(-2 * TOLERANCE)


@pytest.mark.long
def test_a_groove_with_clearance_has_the_reference_s_play() -> None:
    """A groove for 5.02 with a roller of 5: 0.04 to 0.04 / cos(alpha) and what facets add."""
    wide = mesh_of(replace(A, roller=replace(A.roller, radius=5.02)), 1e-3)
    rolled = roll(wide, read_roller("radius=5,length=7.3,inner=22"), 36, 720)
    assert rolled.play.min() == pytest.approx(0.0397, abs=1e-3)
    assert rolled.play.max() == pytest.approx(0.0440, abs=1e-3)


def test_python_gives_what_is_free(tmp_path: Path, groove: Mesh) -> None:
    file = tmp_path / "drum.stl"
    write_stl(file, groove, "drum")
    rolled = camgen.rolls(file, {"radius": 5.0, "length": 7.3, "inner": 22.0})
    assert np.abs(rolled.motion - A.path.height(-rolled.theta, 0)).max() < TOLERANCE
    with pytest.raises(SpecError, match="inner"):
        camgen.rolls(file, {"radius": 5.0, "length": 7.3})


def test_an_arm_an_end_cam_and_a_rib_are_told_by_the_table() -> None:
    arm = read_roller(f"{ROLLER},arm={ARM},pivot={PIVOT}/27")
    rolled = roll(mesh_of(B, TOLERANCE), arm, 36, 360)
    wanted = np.arcsin((B.path.height(-rolled.theta, 0) - 27) / ARM)
    assert np.max(np.abs(rolled.motion - wanted)) < TOLERANCE / ARM
    steepest = float(REFERENCE["b"]["pressure_angle_deg"][0])
    assert np.degrees(np.max(np.abs(rolled.pressure_angle))) == pytest.approx(steepest, abs=0.3)
    end = roll(mesh_of(END, TOLERANCE), read_roller(f"{ROLLER},track=end"), 36, 360)
    assert np.isnan(end.high).all()
    assert end.motion == pytest.approx(A.path.height(-end.theta, 0), abs=1.3 * TOLERANCE)
    rib = roll(mesh_of(RIB, TOLERANCE), read_roller(f"{ROLLER},track=rib,distance=16"), 36, 360)
    assert rib.motion == pytest.approx(A.path.height(-rib.theta, 0), abs=1.3 * TOLERANCE)
    wider = roll(mesh_of(RIB, TOLERANCE), read_roller(f"{ROLLER},track=rib,distance=16.1"), 36, 360)
    assert wider.play.min() - rib.play.min() == pytest.approx(0.1, abs=1e-6)


@pytest.mark.parametrize(("inner", "length", "share"), [(21.7, 8, 0), (21, 8, 1), (12, 17, 1)])
def test_a_roller_that_reaches_into_the_floor_is_told(
    groove: Mesh, inner: float, length: float, share: float
) -> None:
    table = read_roller(f"radius=5,length={length},inner={inner},tolerance={TOLERANCE}")
    assert roll(groove, table, 36, 72).cut.mean() == share


def test_a_pin_in_the_way_of_the_roller_is_told_where_it_stands(groove: Mesh) -> None:
    """A cube of 1 mm in the groove at 90 deg, which no wall is."""
    square = np.array([[x, y, z] for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))])
    faces = np.array([[0, 1, 5], [0, 5, 4], [1, 2, 6], [1, 6, 5], [2, 3, 7], [2, 7, 6]])
    wall = square * 1.0 + [-0.5, 25.5, A.path.height(np.array([math.pi / 2]), 0)[0]]
    mesh = Mesh(
        np.concatenate([groove.vertices, wall]),
        np.concatenate([groove.faces, faces + len(groove.vertices)]),
    )
    rolled = roll(mesh, read_roller(ROLLER), 36, 360)
    near = np.degrees(rolled.theta[rolled.cut])
    assert len(near) and np.all(np.abs(near - 270) < 15)


def test_where_the_roller_stands_shifts_the_motion(groove: Mesh) -> None:
    still = roll(groove, read_roller(ROLLER), 36, 360)
    turned = roll(groove, read_roller(f"{ROLLER},at_deg=90"), 36, 360)
    # a drum that has turned by 90 deg shows the roller at 90 deg what it showed the one at 0
    assert np.roll(turned.motion, -90) == pytest.approx(still.motion, abs=1e-9)


def test_an_open_wall_is_told_as_contact(groove: Mesh, tmp_path: Path) -> None:
    """A quarter of the lower wall is missing."""
    middle = groove.vertices[groove.faces].mean(axis=1)
    gone = (groove.across[:, 2] > 0) & (middle[:, 2] < 40) & (middle[:, :2] > 0).all(axis=1)
    file = tmp_path / "open.stl"
    write_stl(file, Mesh(groove.vertices, groove.faces[~gone]), "open")
    code, text = call(file, ROLLER)
    assert code == 1
    assert "WATERTIGHT" in text and "CONTACT" in text


def test_several_tracks_ask_which(groove: Mesh, tmp_path: Path) -> None:
    """Two drums one above the other: the gap between them is too narrow to be a track."""
    above = Mesh(groove.vertices + [0, 0, 60.0], groove.faces)
    both = Mesh(
        np.concatenate([groove.vertices, above.vertices]),
        np.concatenate([groove.faces, above.faces + len(groove.vertices)]),
    )
    file = tmp_path / "two.stl"
    write_stl(file, both, "two")
    code, text = call(file, ROLLER)
    assert code == 2
    assert "height" in text and "2 tracks, at 27.5, 87.5 mm" in text
    rolled = roll(both, read_roller(f"{ROLLER},height=80"), 36, 360)
    assert rolled.motion.min() == pytest.approx(80, abs=TOLERANCE)


def test_a_drum_without_a_track_is_refused(groove: Mesh, tmp_path: Path) -> None:
    file = tmp_path / "drum.stl"
    write_stl(file, groove, "drum")
    code, text = call(file, f"{ROLLER},axis=y")
    assert code == 3
    assert "axis" in text


def test_a_mesh_that_is_inside_out_or_torn_is_told_as_such(groove: Mesh, tmp_path: Path) -> None:
    file = tmp_path / "drum.stl"
    write_stl(file, Mesh(groove.vertices, groove.faces[:, ::-1]), "drum")
    code, text = call(file, ROLLER)
    assert code == 3 and "inside out" in text
    write_stl(file, Mesh(groove.vertices, groove.faces[: len(groove.faces) // 2]), "drum")
    code, text = call(file, ROLLER)
    assert code == 3 and "open edges" in text and "mend" in text


@pytest.mark.parametrize(
    ("roller", "key"),
    [
        ("radius=5,length=8", "inner"),
        ("radius=5,length=8,inner=22,arm=40", "pivot"),
        ("radius=5,length=8,inner=22,arm=40,pivot=39/27,offset=1", "offset"),
        ("radius=5,length=8,inner=22,track=rib", "distance"),
        ("radius=5,length=8,inner=22,distance=3", "distance"),
        ("radius=5,length=30,inner=22,cone_deg=40", "cone_deg"),
        ("radius=5,length=8,inner=22,track=rib,distance=16,arm=40,pivot=39/27", "arm"),
        ("radius=5,length=8,iner=22", "inner"),
    ],
)
def test_what_is_typed_wrong_is_named(roller: str, key: str) -> None:
    with pytest.raises(SpecError, match=key):
        read_roller(roller)


def test_options_of_outlines_do_not_go_with_a_roller(tmp_path: Path) -> None:
    code, text = call(tmp_path / "drum.stl", ROLLER, "--height", "5")
    assert code == 2 and "--height does not go with --roller" in text
    code, text = call(tmp_path / "drum.stl", ROLLER, "--follower", "translating,radius=6")
    assert code == 2 and "give --follower, --roller or --drives" in text
    code, text = call(tmp_path / "drum.dxf", ROLLER)
    assert code == 4 and "needs a mesh" in text
    result = CliRunner().invoke(cli, ["motion", str(tmp_path / "drum.dxf")])
    said = "give --follower, --roller or --drives: drum.dxf is an outline"
    assert result.exit_code == 2 and said in result.output


def test_a_table_in_a_file_is_read(tmp_path: Path) -> None:
    file = tmp_path / "roller.toml"
    file.write_text(
        "[roller]\nradius = 5\nlength = 8\ninner = 22\ntrack = 'end'\n", encoding="utf-8"
    )
    assert read_roller(str(file)).track == "end"


def in_a_section(
    corners: np.ndarray, turn: float, delta: float, aside: float, level: float
) -> tuple[float, float]:
    """Of a plane through the drum's axis, delta off the roller's: the highest of the roller's places on what lies under a level,
    and the lowest on what lies over it; the roller of 5 mm reaches from 22 to 29.3 mm.
    """
    out = np.array([math.cos(turn + delta), math.sin(turn + delta)])
    off = corners[..., 1] * out[0] - corners[..., 0] * out[1]
    cut = np.flatnonzero((off.min(axis=1) < 0) & (off.max(axis=1) > 0))
    lone = np.argmax((off[cut] > 0) == ((off[cut] > 0).sum(axis=1) == 1)[:, None], axis=1)
    ends = []
    for k in (1, 2):
        a = corners[cut, lone]
        b = corners[cut, (lone + k) % 3]
        first = off[cut, lone]
        second = off[cut, (lone + k) % 3]
        ends.append(a + (b - a) * (first / (first - second))[:, None])
    x = np.array([each[:, :2] @ out for each in ends]) * math.cos(delta)
    z = np.array([each[:, 2] for each in ends])
    beyond = x.max(axis=0) > 22
    within = beyond & (x.min(axis=0) < 29.3) & (x[0] != x[1])
    x = x[:, within]
    z = z[:, within]
    # what of each piece lies between both ends of the roller
    shares = np.sort((np.array([[22.0], [29.3]]) - x[0]) / (x[1] - x[0]), axis=0)
    low, high = np.clip(shares, 0, 1)
    share = low + (high - low) * np.linspace(0, 1, 33)[:, None]
    along = x[0] + (x[1] - x[0]) * share
    place = z[0] + (z[1] - z[0]) * share
    room = 25 - (along * math.tan(delta) - aside) ** 2
    rise = np.sqrt(np.maximum(room, 0.0))
    under = np.where((room >= 0) & (place < level), place + rise, -math.inf)
    over = np.where((room >= 0) & (place > level), place - rise, math.inf)
    return float(under.max(initial=-math.inf)), float(over.min(initial=math.inf))


def free_by_sections(mesh: Mesh, turn: float, aside: float, level: float) -> list[float]:
    """Lowest and highest place of the roller at an angle, its axis so far beside the radial line, by planes nearer and nearer
    to those that bound it.
    """
    corners = mesh.vertices[mesh.faces]
    corners = corners[
        np.abs(np.angle(np.exp(-1j * turn) * (corners[..., 0] + 1j * corners[..., 1]))).min(axis=1)
        < 1
    ]
    found = []
    for side in (0, 1):
        middle = 0.0
        width = math.asin((5 + abs(aside)) / 22)
        sense = 1 - 2 * side
        best = -math.inf
        for count in (301, 41, 41, 41):
            planes = np.linspace(middle - width, middle + width, count)
            places = [
                sense * in_a_section(corners, turn, each, aside, level)[side] for each in planes
            ]
            best = max(best, max(places))
            middle = float(planes[int(np.argmax(places))])
            width *= 2.0 / count * 2
        found.append(sense * best)
    return found


LAWS = st.sampled_from(["cycloidal", "3-4-5", "modified-sine", "modified-trapezoid"])


@pytest.mark.long
@settings(max_examples=4)
@given(
    spans=st.tuples(st.integers(85, 140), st.integers(10, 50), st.integers(85, 140)),
    lift=st.floats(3, 14),
    laws=st.tuples(LAWS, LAWS),
    aside=st.floats(-3, 3),
    turns=st.lists(st.floats(0, 359), min_size=3, max_size=3),
)
def test_random_drums_are_rolled_as_sections_through_the_axis_say(
    spans: tuple[int, int, int],
    lift: float,
    laws: tuple[str, str],
    aside: float,
    turns: list[float],
) -> None:
    rise, dwell, back = spans
    table = [
        SegmentTable(kind="rise", span_deg=rise, lift=lift, law=laws[0]),
        SegmentTable(kind="dwell", span_deg=dwell),
        SegmentTable(kind="return", span_deg=back, lift=lift, law=laws[1]),
        SegmentTable(kind="dwell"),
    ]
    motion = program(table)
    mesh = mesh_of(replace(A, path=slide_path(motion, 20, aside)), 0.05)
    found = roll(mesh, read_roller(f"{ROLLER},offset={aside!r}"), 60, 720)
    for turn in turns:
        k = round(2 * turn)
        theta = found.theta[k]
        level = 20 + float(motion(np.array([theta]), 0)[0])
        low, high = free_by_sections(mesh, -theta, aside, level)
        # sections miss the highest place by a little, and never exceed it
        assert low - 1e-9 <= found.low[k] <= low + 2e-5
        assert high - 2e-5 <= found.high[k] <= high + 1e-9
