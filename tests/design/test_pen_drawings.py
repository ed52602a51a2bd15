"""A machine that draws a line: the pen's motion against closed forms and another program, the line as it is read, the pen from files."""

from __future__ import annotations

import math
import re
import tomllib
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

import camgen
from camgen.design.drawings import Plotter
from camgen.errors import DesignError, FileError, SpecError
from camgen.machines.spec_files import stroke_of, strokes_of
from camgen.motion.pen import (
    Lifting,
    closed_line,
    peak_acceleration,
    pen_motion,
    strokes_in_order,
    strokes_motion,
)

REFERENCE = tomllib.loads(
    (Path(__file__).resolve().parents[1] / "reference" / "motion_tasks.toml").read_text()
)["pen"]


def square(side: float) -> np.ndarray:
    return side * np.array([0, 1, 1 + 1j, 1j])


def signature() -> np.ndarray:
    """170 points of seven loops, and 30 back under them."""
    t = np.linspace(0, 1, 170)
    x = 60 * t + 4.5 * np.sin(14 * np.pi * t) * (1 - 0.3 * t)
    y = 8 * np.cos(14 * np.pi * t) * (0.6 + 0.4 * np.sin(9 * t)) + 3 * np.sin(4.6 * np.pi * t)
    there = x + 1j * y
    u = np.arange(1, 31) / 31
    return np.concatenate([there, there[-1] + (there[0] - there[-1]) * u - 12j * np.sin(np.pi * u)])


LINES = {"square": square(30), "signature": signature()}


def apart(places: np.ndarray, line: np.ndarray) -> float:
    """How far closed polylines are apart at most, either way, by another library."""
    share = np.linspace(0, 1, 12, endpoint=False)[:, None]
    dense = (line + (np.roll(line, -1) - line) * share).ravel()

    def off(points: np.ndarray, ring: np.ndarray) -> float:
        rings = shapely.LinearRing(np.column_stack([ring.real, ring.imag]))
        return float(np.max(shapely.distance(shapely.points(points.real, points.imag), rings)))

    return max(off(places[::4], line), off(dense, places[::2]))


@pytest.mark.long
@pytest.mark.parametrize("name, tolerance, peak", REFERENCE["peaks"])
def test_least_acceleration_within_the_tolerance(name: str, tolerance: float, peak: float) -> None:
    """No worse than the other program, nor out of its reach; the whole tolerance is spent."""
    pen = pen_motion(LINES[name], tolerance)
    assert 0.8 * peak < peak_acceleration(pen) < 1.05 * peak
    assert 0.97 * tolerance < apart(pen, LINES[name]) < 1.01 * tolerance


@pytest.mark.long
def test_a_square_is_met_where_the_pen_stops() -> None:
    """At rest in every corner, straight between them; four runs from rest to rest of 30 mm in what the rests leave of a turn."""
    side = 30
    pen = pen_motion(square(side), 0.1, "stop")
    assert max(float(np.min(np.abs(pen - corner))) for corner in square(side)) < 1e-9
    assert apart(pen, square(side)) < 1e-9
    from_rest_to_rest = 4 * side / (math.tau / 4) ** 2
    assert from_rest_to_rest < peak_acceleration(pen) < 1.4 * from_rest_to_rest
    assert np.sum(np.abs(pen - np.roll(pen, 1)) < 1e-9) > 4


@pytest.mark.long
def test_only_bends_are_rounded_where_the_pen_stops() -> None:
    """A half round and its chord: sharp where they meet, within the tolerance between."""
    half = 10 * np.exp(1j * np.linspace(0, math.pi, 60))
    pen = pen_motion(half, 0.1, "stop")
    assert max(float(np.min(np.abs(pen - end))) for end in (half[0], half[-1])) < 1e-9
    assert 0.01 < apart(pen, half) < 0.101


def drop() -> np.ndarray:
    """From a corner at 0 round an arc that its two straight sides touch, and back."""
    lean = math.acos(8 / 20)
    return np.append(0j, 20 + 8 * np.exp(1j * np.linspace(lean - math.pi, math.pi - lean, 200)))


@pytest.mark.long
@pytest.mark.parametrize("line", [drop(), np.concatenate([drop(), -0.6 * drop()])])
def test_a_loop_comes_back_to_the_corner_where_it_began(line: np.ndarray) -> None:
    """One loop, and two of unlike sizes through one place."""
    pen = pen_motion(line, 0.1, "stop")
    assert np.min(np.abs(pen)) < 1e-9
    assert 0.01 < apart(pen, line) < 0.101


@pytest.mark.long
def test_a_line_without_corners_has_no_stops() -> None:
    line = 10 * np.exp(2j * math.pi * np.arange(90) / 90)
    assert np.array_equal(pen_motion(line, 0.05, "stop"), pen_motion(line, 0.05))


@pytest.mark.long
def test_an_open_line_is_drawn_there_and_back() -> None:
    """All of its corners are reached, also where it turns back and its curvature has no bound."""
    line = closed_line(np.array([18j, -10 - 14j, 17 + 5j]))
    assert line is not None and line.tolist() == [18j, -10 - 14j, 17 + 5j, -10 - 14j]
    pen = pen_motion(line, 0.05)
    assert max(float(np.min(np.abs(pen - corner))) for corner in line) < 0.0505
    assert peak_acceleration(pen) < 2e3


@pytest.mark.long
def test_a_circle_is_drawn_evenly() -> None:
    """Its acceleration is r, mm/rad^2, everywhere: the least there is."""
    circle = 10 * np.exp(2j * math.pi * np.arange(720) / 720)
    pen = pen_motion(circle, 0.05)
    assert peak_acceleration(pen) == pytest.approx(10, rel=0.01)


def ring(centre: complex, radius: float) -> np.ndarray:
    return np.append(centre + radius * np.exp(2j * math.pi * np.arange(8) / 8), centre + radius)


def test_lines_are_drawn_with_short_ways_between() -> None:
    """Two uprights and a ring beyond: up one, down the other, and the ring from its corner that is nearest, at 26."""
    tour = strokes_in_order([ring(30, 4), np.array([10, 10 + 20j]), np.array([0, 20j])])
    ways = [abs(b[0] - a[-1]) for a, b in zip(tour, [*tour[1:], tour[0]], strict=True)]
    assert sorted(ways) == pytest.approx([10, 16, 26])


def test_a_line_goes_on_where_another_ends() -> None:
    (tour,) = strokes_in_order([np.array([0, 10]), np.array([10 + 8j, 10])])
    assert tour.tolist() == [0, 10, 10 + 8j] or tour.tolist() == [10 + 8j, 10, 0]


LIFTING = Lifting(0.02, 0.06, 0.03)
UPRIGHTS = [np.array([0, 20j]), np.array([10 + 20j, 10])]


def still(places: np.ndarray, at: complex) -> float:
    """Longest time for which the pen stands there, share of a turn."""
    there = np.abs(np.tile(places, 2) - at) < 1e-9
    edges = np.flatnonzero(np.diff(np.concatenate([[False], there, [False]]))).reshape(-1, 2)
    return float(np.ptp(edges, axis=1).max()) / len(places)


@pytest.mark.long
def test_the_pen_rests_where_lines_begin_and_end() -> None:
    """For as long as it is asked to, in the ends themselves; the middles of the rests are told."""
    motion = strokes_motion(UPRIGHTS, 0.1, "round", LIFTING)
    for line, ends in zip(UPRIGHTS, motion.ends, strict=True):
        for place, middle in zip((line[0], line[-1]), ends, strict=True):
            assert LIFTING.rest - 1e-3 < still(motion.places, place) < LIFTING.rest + 0.02
            number = round(middle / math.tau * len(motion.places)) % len(motion.places)
            assert motion.places[number] == pytest.approx(place, abs=1e-9)
    assert motion.ends[0, 0] < 0 < motion.ends[0, 1] < motion.ends[1, 0] < motion.ends[1, 1]
    assert -motion.ends[0, 0] == pytest.approx(motion.ends[0, 1], abs=1e-3)


@pytest.mark.long
def test_ways_take_the_times_of_the_least_acceleration() -> None:
    """From rest to rest by the square root of the way, whether drawn or lifted: 20 and 10 mm."""
    ends = strokes_motion(UPRIGHTS, 0.1, "round", LIFTING).ends / math.tau
    line = ends[0, 1] - ends[0, 0]
    way = ends[1, 0] - ends[0, 1]
    assert 2 * (line + way) == pytest.approx(1)
    rest = (way * math.sqrt(2) - line) / (math.sqrt(2) - 1)
    assert LIFTING.rest < rest < LIFTING.rest + 0.04


@pytest.mark.long
def test_a_lift_that_takes_long_makes_the_way_slow() -> None:
    motion = strokes_motion(UPRIGHTS, 0.1, "round", Lifting(0.02, 0.25, 0.1))
    ends = motion.ends / math.tau
    assert 0.25 + 0.02 < ends[1, 0] - ends[0, 1] < 0.25 + 0.02 + 0.04
    assert apart(motion.places, np.concatenate(UPRIGHTS)) < 0.1


@pytest.mark.long
def test_corners_of_lines_are_met_where_the_pen_stops() -> None:
    bent = [np.array([0, 20j, 5 + 20j]), np.array([20, 20 + 20j])]
    motion = strokes_motion(bent, 0.1, "stop", LIFTING)
    assert np.min(np.abs(motion.places - 20j)) < 1e-9
    rounded = strokes_motion(bent, 0.1, "round", LIFTING).places
    assert 0.01 < np.min(np.abs(rounded - 20j)) < 0.101


@given(st.floats(-0.3, 0.3), st.floats(-10, 10), st.floats(-10, 10))
def test_links_keep_their_lengths(turn: float, x: float, y: float) -> None:
    made = Plotter(np.zeros(2, complex), 60.0, 50.0, 30.0, 5.0)
    pen = np.array([complex(x, y) + made.middle])
    at = {key: complex(z[0]) for key, z in made.places(pen).items()}
    left, right = made.pivots
    for a, b, length in (
        (left, at["A"], 60.0),
        (right, at["B"], 60.0),
        (at["A"], at["P"], made.rod),
        (at["B"], at["P"], made.rod),
    ):
        assert abs(a - b) == pytest.approx(length)
    assert abs(at["B"] - at["Q"]) == pytest.approx(abs(at["B"] - at["P"]) + abs(at["P"] - at["Q"]))
    for k, pivot in enumerate(made.pivots):
        rollers = made.rollers(k, np.array([0.0, turn]))
        assert abs(rollers[1] - pivot) == pytest.approx(50)
        assert abs(rollers[0]) == pytest.approx(30)  # square to the way to the shaft


def test_lines_of_files(tmp_path: Path) -> None:
    svg = tmp_path / "a.svg"
    head = '<svg xmlns="http://www.w3.org/2000/svg" width="30mm" height="30mm" viewBox="0 0 30 30">'
    svg.write_text(f'{head}<path d="M0 0 L 20 0 L 20 10"/></svg>')
    line, closed = stroke_of(svg)
    assert not closed and np.abs(np.diff(line)).tolist() == pytest.approx([20, 10])
    svg.write_text(f'{head}<circle cx="15" cy="15" r="10"/></svg>')
    line, closed = stroke_of(svg)
    middle = (line.real.max() + line.real.min()) / 2 + 15j * np.sign(line.imag.mean())
    assert closed and np.abs(line - middle) == pytest.approx(10, abs=1e-6)
    svg.write_text(
        f'{head}<path d="M0 0 L 20 0"/><path d="M0 5 L 20 5 L 20 9"/><circle cx="9" cy="9" r="2"/></svg>'
    )
    with pytest.raises(FileError, match="3 lines apart"):
        stroke_of(svg)
    found = strokes_of(svg)
    ways = sorted(float(np.abs(np.diff(line)).sum()) for line in found)
    assert ways == pytest.approx([4 * math.pi, 20, 24], rel=1e-3)
    assert [abs(line[-1] - line[0]) < 1e-9 for line in found] == [True, False, False]
    svg.write_text(f"{head}</svg>")
    with pytest.raises(FileError, match="no line"):
        strokes_of(svg)
    drawing = ezdxf.new(units=4)
    drawing.modelspace().add_line((0, 0), (20, 0))
    drawing.modelspace().add_arc((20, 5), 5, -90, 90)
    drawing.saveas(tmp_path / "a.dxf")
    line, closed = stroke_of(tmp_path / "a.dxf")
    assert not closed and np.abs(np.diff(line)).sum() == pytest.approx(20 + 5 * math.pi, rel=1e-3)
    around = line[np.abs(line.real) > 20.001]
    assert np.abs(around - (20 + 5j)) == pytest.approx(5, abs=1e-9)


BASE = {"mechanism": "linkage", "name": "draws", "limits": {"lash": 3}}
TRIANGLE = [[0, 0], [24, 0], [12, 20], [0, 0]]


@pytest.mark.parametrize(
    "wanted, says",
    [
        ({"drawing": [[0, 0], [5, 5]]}, "at least 3 different points"),
        ({"drawing": TRIANGLE, "tolerance": 0.001}, "wanted.tolerance"),
        ({"drawing": "gone.svg"}, "gone.svg"),
        ({"drawing": TRIANGLE, "bars": 4}, "bars"),
        ({"drawing": [TRIANGLE, [[30, 0], [30.5, 0]]]}, "line 2, 0.5 mm from (30, 0)"),
        ({"drawing": [TRIANGLE, [[30, 0]]]}, "wanted.drawing"),
        ({"drawing": [[[9 * k, 0], [9 * k, 9]] for k in range(13)]}, "13 lines"),
    ],
)
def test_no_line(wanted: dict[str, Any], says: str) -> None:
    with pytest.raises((SpecError, FileError), match=re.escape(says)):
        camgen.design({**BASE, "wanted": wanted})


@pytest.mark.long
def test_too_large() -> None:
    with pytest.raises(DesignError, match="draw a line of"):
        camgen.design({**BASE, "wanted": {"drawing": TRIANGLE, "width": 300}})


@pytest.fixture(scope="module")
def found() -> Any:
    return camgen.design({**BASE, "wanted": {"drawing": TRIANGLE}})


@pytest.mark.long
def test_the_pen_from_the_files(found: Any, tmp_path: Path) -> None:
    report = camgen.build(found.machine, tmp_path, only="dxf")
    assert report.ok
    errors = [each for each in report.findings if each.code == "PATH_ERROR"]
    assert {each.where.kind for each in errors} == {"", "dxf"}
    assert all(each.limit == 0.1 and 0.05 < each.measured < 0.1 for each in errors)


def lash(report: Any) -> float:
    return max(each.measured for each in report.findings if each.code == "LASH")


@pytest.mark.long
def test_slides_in_place_of_arms(found: Any, tmp_path: Path) -> None:
    """From the files, with all bodies apart over the turn; the pen is on the axes of both slides at every angle, with less play."""
    slid = camgen.design({**BASE, "wanted": {"drawing": TRIANGLE, "follower": "slides"}})
    report = camgen.build(slid.machine, tmp_path, only="dxf,3mf")
    assert report.ok
    errors = path_errors(report)
    assert set(errors) == {"", "dxf", "3mf"}
    assert all(each.limit == 0.1 and 0.05 < each.measured < 0.1 for each in errors.values())
    run = slid.machine.solve(np.linspace(0, math.tau, 50))
    rise = run["pen"].imag - run["height"].imag
    assert np.ptp(rise) < 1e-9 and np.ptp(run["height"].imag) > 19
    assert 1.5 * lash(report) < lash(camgen.build(found.machine, tmp_path, only="dxf"))


def test_too_large_for_slides() -> None:
    wanted = {"drawing": TRIANGLE, "width": 100, "follower": "slides"}
    with pytest.raises(DesignError, match='wanted.follower = "arm"'):
        camgen.design({**BASE, "wanted": wanted})


def path_errors(report: Any) -> dict[str, Any]:
    return {each.where.kind: each for each in report.findings if each.code == "PATH_ERROR"}


@pytest.mark.long
def test_a_wrong_cam_is_seen(found: Any) -> None:
    """One row of a cam's table off by half a degree."""
    wrong = tomllib.loads(found.text)
    rows = wrong["cam"][0]["segment"][0]["law"]["points"]
    rows[20][1] += 0.5
    failing = {each.code for each in camgen.load(wrong).limits() if not each.ok}
    assert "PATH_ERROR" in failing


@pytest.fixture(scope="module")
def lifted() -> Any:
    return camgen.design({**BASE, "wanted": {"drawing": [[[0, 0], [0, 16]], [[9, 2], [9, 16]]]}})


@pytest.mark.long
def test_a_third_cam_lifts_the_pen(lifted: Any, tmp_path: Path) -> None:
    """From the files: the lines alone are drawn, though the pen goes 9 mm from one to the other."""
    report = camgen.build(lifted.machine, tmp_path, only="dxf")
    assert report.ok
    errors = path_errors(report)
    assert set(errors) == {"", "dxf"} and max(each.measured for each in errors.values()) < 0.01
    bought = {each.name: each.size for each in lifted.machine.assembly.bought}
    assert "slack by 0.5 mm" in bought["thread"] and "by 2.5 mm" in bought["pen with a spring"]
    drawn = next(plot for plot in report.plots if plot.title == "Pen over the wanted lines")
    x = dict((label, x) for label, x, _ in drawn.series)["from DXF"]
    assert np.count_nonzero(np.isnan(x)) >= 2 and np.nanmax(np.abs(x[np.isfinite(x)])) < 20
    between = (x > np.nanmin(x) + 0.1) & (x < np.nanmax(x) - 0.1)
    assert not between.any()


def out_of_phase(text: str, late_deg: float) -> dict[str, Any]:
    """The spec with all lifts later."""
    wrong = tomllib.loads(text)
    segments = wrong["cam"][2]["segment"]
    segments[0]["span_deg"] += late_deg
    segments[-1]["span_deg"] -= late_deg
    return wrong


@pytest.mark.long
@pytest.mark.parametrize("late_deg", [-15.0, 15.0])
def test_a_lift_out_of_phase_is_seen(lifted: Any, late_deg: float) -> None:
    limits = camgen.load(out_of_phase(lifted.text, late_deg)).limits()
    assert [each.ok for each in limits if each.code == "PATH_ERROR"] == [False]


@pytest.mark.long
def test_files_with_a_lift_out_of_phase_are_seen(lifted: Any, tmp_path: Path) -> None:
    """The cam is 15 deg late in its drawings, the spec beside them is right."""
    report = camgen.build(camgen.load(out_of_phase(lifted.text, 15)), tmp_path, only="dxf")
    (report.folder / "spec.toml").write_text(lifted.text)
    errors = path_errors(camgen.check(report.folder))
    assert errors[""].ok and not errors["dxf"].ok


@pytest.mark.long
@pytest.mark.parametrize(
    "key, value, says",
    [("lift", "pen", "output.0.lines.lift"), ("up", 25.5, "output.0.lines.up")],
)
def test_no_lift(lifted: Any, key: str, value: Any, says: str) -> None:
    spec = tomllib.loads(lifted.text)
    spec["output"][0]["lines"][key] = value
    with pytest.raises(SpecError, match=says):
        camgen.load(spec)
