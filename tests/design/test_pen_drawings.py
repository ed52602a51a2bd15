"""A machine that draws a line: the pen's motion against closed forms and another program, the line as it is read, the pen from files."""

from __future__ import annotations

import math
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
from camgen.machines.spec_files import stroke_of
from camgen.motion.pen import closed_line, peak_acceleration, pen_motion

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


@pytest.mark.parametrize("name, tolerance, peak", REFERENCE["peaks"])
def test_least_acceleration_within_the_tolerance(name: str, tolerance: float, peak: float) -> None:
    """No worse than the other program, nor out of its reach; the whole tolerance is spent."""
    pen = pen_motion(LINES[name], tolerance)
    assert 0.8 * peak < peak_acceleration(pen) < 1.05 * peak
    assert 0.97 * tolerance < apart(pen, LINES[name]) < 1.01 * tolerance


def test_a_square_is_met_where_the_pen_stops() -> None:
    """At rest in every corner, straight between them; four runs from rest to rest of 30 mm in what the rests leave of a turn."""
    side = 30
    pen = pen_motion(square(side), 0.1, "stop")
    assert max(float(np.min(np.abs(pen - corner))) for corner in square(side)) < 1e-9
    assert apart(pen, square(side)) < 1e-9
    from_rest_to_rest = 4 * side / (math.tau / 4) ** 2
    assert from_rest_to_rest < peak_acceleration(pen) < 1.4 * from_rest_to_rest
    assert np.sum(np.abs(pen - np.roll(pen, 1)) < 1e-9) > 4


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


@pytest.mark.parametrize("line", [drop(), np.concatenate([drop(), -0.6 * drop()])])
def test_a_loop_comes_back_to_the_corner_where_it_began(line: np.ndarray) -> None:
    """One loop, and two of unlike sizes through one place."""
    pen = pen_motion(line, 0.1, "stop")
    assert np.min(np.abs(pen)) < 1e-9
    assert 0.01 < apart(pen, line) < 0.101


def test_a_line_without_corners_has_no_stops() -> None:
    line = 10 * np.exp(2j * math.pi * np.arange(90) / 90)
    assert np.array_equal(pen_motion(line, 0.05, "stop"), pen_motion(line, 0.05))


def test_an_open_line_is_drawn_there_and_back() -> None:
    """All of its corners are reached, also where it turns back and its curvature has no bound."""
    line = closed_line(np.array([18j, -10 - 14j, 17 + 5j]))
    assert line is not None and line.tolist() == [18j, -10 - 14j, 17 + 5j, -10 - 14j]
    pen = pen_motion(line, 0.05)
    assert max(float(np.min(np.abs(pen - corner))) for corner in line) < 0.0505
    assert peak_acceleration(pen) < 2e3


def test_a_circle_is_drawn_evenly() -> None:
    """Its acceleration is r, mm/rad^2, everywhere: the least there is."""
    circle = 10 * np.exp(2j * math.pi * np.arange(720) / 720)
    pen = pen_motion(circle, 0.05)
    assert peak_acceleration(pen) == pytest.approx(10, rel=0.01)


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
    svg.write_text(f'{head}<path d="M0 0 L 20 0"/><path d="M0 5 L 20 5"/></svg>')
    with pytest.raises(FileError, match="2 lines apart"):
        stroke_of(svg)
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
    ],
)
def test_no_line(wanted: dict[str, Any], says: str) -> None:
    with pytest.raises((SpecError, FileError), match=says):
        camgen.design({**BASE, "wanted": wanted})


def test_too_large() -> None:
    with pytest.raises(DesignError, match="draw a line of"):
        camgen.design({**BASE, "wanted": {"drawing": TRIANGLE, "width": 300}})


@pytest.fixture(scope="module")
def found() -> Any:
    return camgen.design({**BASE, "wanted": {"drawing": TRIANGLE}})


def test_the_pen_from_the_files(found: Any, tmp_path: Path) -> None:
    report = camgen.build(found.machine, tmp_path, only="dxf")
    assert report.ok
    errors = [each for each in report.findings if each.code == "PATH_ERROR"]
    assert {each.where.kind for each in errors} == {"", "dxf"}
    assert all(each.limit == 0.1 and 0.05 < each.measured < 0.1 for each in errors)


def test_a_wrong_cam_is_seen(found: Any) -> None:
    """One row of a cam's table off by half a degree."""
    wrong = tomllib.loads(found.text)
    rows = wrong["cam"][0]["segment"][0]["law"]["points"]
    rows[20][1] += 0.5
    failing = {each.code for each in camgen.load(wrong).limits() if not each.ok}
    assert "PATH_ERROR" in failing
