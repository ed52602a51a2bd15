"""What the report says of a linkage, against closed forms and published figures."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from camgen.machine.closed_form import transmission_extremes
from camgen.machine.reach import transmission
from camgen.machines.linkage.mechanism import Linkage
from camgen.reading import read
from camgen.spec import validate
from camgen.study import Study

BAR = 70.0, 20.0, 60.0, 50.0  # ground, crank, coupler, rocker of the starter


@pytest.fixture
def data(root: Path) -> dict[str, Any]:
    return read(root / "specs" / "linkage.toml")


@pytest.fixture
def published(root: Path) -> dict[str, Any]:
    return tomllib.loads(
        (root / "tests" / "reference" / "linkages.toml").read_text(encoding="utf-8")
    )


def study(data: dict[str, Any]) -> Study:
    return validate(Linkage, data).study()


def table(found: Study, title: str) -> list[tuple[Any, ...]]:
    return [tuple(row) for each in found.tables if each.title == title for row in each.rows]


def test_transmission_angle_of_a_four_bar(data: dict[str, Any]) -> None:
    """Extremes where crank and ground are in line; an obtuse angle counts by its supplement."""
    machine = validate(Linkage, data)
    (angle,) = transmission(machine.chain, np.array([0.0, math.pi])).values()
    expected = [math.degrees(each) for each in transmission_extremes(*BAR)]
    assert angle == pytest.approx([min(each, 180 - each) for each in expected], abs=1e-9)
    assert "Transmission angle" in [plot.title for plot in machine.study().plots]


def test_extreme_positions_are_where_crank_and_coupler_are_in_line(data: dict[str, Any]) -> None:
    ground, crank, coupler, rocker = BAR
    far, near = coupler + crank, coupler - crank
    stretched = math.degrees(math.acos((ground**2 + far**2 - rocker**2) / (2 * ground * far)))
    folded = 180 + math.degrees(math.acos((ground**2 + near**2 - rocker**2) / (2 * ground * near)))
    found = study(data)
    assert sorted(row[3] for row in table(found, "Extreme positions")) == pytest.approx(
        [stretched, folded], abs=1e-3
    )
    assert found.numbers["swing_time_ratio"] == pytest.approx(
        (folded - stretched) / (360 - folded + stretched), abs=1e-5
    )


def test_quick_return_as_published(published: dict[str, Any]) -> None:
    crank, distance = published["quick_return"]["crank"], published["quick_return"]["distance"]
    alpha = 2 * math.degrees(math.asin(crank / distance))
    arm = {
        "mechanism": "linkage",
        "name": "own",
        "drive": {"link": "crank"},
        "points": {"O": [0, 0], "A": [0, crank], "D": [0, -distance], "E": [0, 60]},
        "links": {"ground": ["O", "D"], "crank": ["O", "A"], "arm": ["D", "E"]},
        "slot": [{"pin": "A", "link": "arm", "along": ["D", "E"]}],
        "output": [{"name": "arm", "link": "arm"}],
    }
    assert study(arm).numbers["arm_time_ratio"] == pytest.approx(
        (180 + alpha) / (180 - alpha), abs=1e-5
    )


def test_a_circle_has_its_radius_and_length(data: dict[str, Any]) -> None:
    data["output"] = [{"name": "pin", "point": "A"}]
    (row,) = table(study(data), "Paths")
    assert row[1:3] == pytest.approx((math.tau * 20, 20)) and row[4:] == ("", "", "")


@pytest.mark.parametrize("at", [40.0, 200.0])
def test_a_point_on_the_moving_centrode_has_a_cusp(data: dict[str, Any], at: float) -> None:
    """The coupler's point that is the instant centre at this angle stands still there: where crank and rocker meet."""
    machine = validate(Linkage, data)
    theta = np.array([math.radians(at)])
    run = machine.solve(theta)
    a, b = run.point("crank", "A")[0, 0], run.point("rocker", "B")[0, 0]
    u, v = a, b - 70  # from O and from C
    s = ((70 * np.conj(v)).imag) / (u * np.conj(v)).imag
    centre = s * u
    start = machine.solve(np.zeros(1))
    a0, b0 = start.point("crank", "A")[0, 0], start.point("rocker", "B")[0, 0]
    place = a0 + (centre - a) / (b - a) * (b0 - a0)
    data["points"]["P"] = [float(place.real), float(place.imag)]
    data["points"]["B"] = [float(b0.real), float(b0.imag)]
    data["parts"] = {"pen_diameter": 0}  # no hole there: it may lie anywhere
    (row,) = table(study(data), "Paths")
    assert [float(t) for t in row[5].split(", ")] == pytest.approx([at], abs=0.01) and row[2] == 0


def test_a_path_that_crosses_itself(data: dict[str, Any]) -> None:
    """Both angles give one place of the path."""
    data["points"]["P"] = [75, -5]
    data["parts"] = {"pen_diameter": 0}
    machine = validate(Linkage, data)
    crossings = table(machine.study(), "Paths")[0][6]
    for pair in filter(None, crossings.split("; ")):
        one, other = (machine.solve(np.radians([float(t)]))["pen"][0] for t in pair.split(" and "))
        assert abs(one - other) < 0.3
    assert crossings


def test_hoekens_path_is_symmetric(published: dict[str, Any]) -> None:
    """About the perpendicular to the ground through the crank's pivot turned to lie along it: theta and -theta mirror."""
    crank, ground, coupler, rocker, tracer = (
        20 * share for share in published["hoeken"]["proportions"]
    )
    data = {
        "mechanism": "linkage",
        "name": "own",
        "drive": {"link": "crank"},
        "points": {"O": [0, 0], "C": [ground, 0], "A": [-crank, 0], "B": [10, 40], "P": [40, 80]},
        "links": {
            "ground": ["O", "C"],
            "crank": ["O", "A"],
            "coupler": ["A", "B", "P"],
            "rocker": ["C", "B"],
        },
        "lengths": {
            "O-C": ground,
            "O-A": crank,
            "A-B": coupler,
            "C-B": rocker,
            "B-P": tracer - coupler,
            "A-P": tracer,
        },
        "output": [
            {
                "name": "pen",
                "point": "P",
                "straightness": {"range_deg": [-90, 90], "tolerance": 1.0},
            }
        ],
    }
    machine = validate(Linkage, data)
    theta = np.linspace(0.05, 3.0, 60)
    one, other = machine.solve(theta)["pen"], machine.solve(-theta)["pen"]
    assert (
        np.max(np.abs((one + other).real - 2 * ground)) < 1e-9
        and np.max(np.abs((one - other).imag)) < 1e-9
    )


def test_jansens_foot_as_published(root: Path, published: dict[str, Any]) -> None:
    found = validate(Linkage, read(root / "specs" / "walking-leg.toml")).study().numbers
    wide, high = published["jansen"]["foot_path"]
    assert found["foot_x_stroke_mm"] == pytest.approx(wide, abs=0.5)
    assert found["foot_x_stroke_mm"] < found["foot_stroke_mm"] < wide + 0.5
    assert found["foot_y_stroke_mm"] == pytest.approx(high, abs=0.25)
    spec = read(root / "specs" / "walking-leg.toml")
    assert set(published["jansen"]["lengths"].values()) - {38, 7.8} <= set(spec["lengths"].values())


def test_a_slot_that_is_made_longer_than_drawn_is_said() -> None:
    """Of a yoke the pin goes 20 mm to either side."""
    tables = {
        "mechanism": "linkage",
        "name": "own",
        "drive": {"link": "crank"},
        "points": {"O": [0, 0], "R": [50, 0], "A": [20, 0], "D": [20, -30], "E": [20, 30]},
        "links": {"ground": ["O", "R"], "crank": ["O", "A"], "yoke": ["D", "E"]},
        "slide": [{"link": "yoke", "along": ["O", "R"]}],
        "slot": [{"pin": "A", "link": "yoke", "along": ["D", "E"]}],
        "output": [{"name": "out", "link": "yoke"}],
    }

    def said(**points: list[float]) -> list[str]:
        own = validate(Linkage, {**tables, "points": {**tables["points"], **points}})  # type: ignore[dict-item]
        return [note for note in own.study().notes if note.startswith("Slot")]

    assert said() == []
    assert said(E=[20, 15]) == [
        "Slot of yoke: pin A passes its drawn end E by 5 mm; camgen made the slot longer."
    ]
    assert said(D=[20, -8.5])[0].startswith("Slot of yoke: pin A passes its drawn end D by 11.5 mm")


def test_the_places_that_a_path_shall_pass_stand_under_it(data: dict[str, Any]) -> None:
    """The crank's pin goes round a circle of 20 mm: (30, 0) is missed by 10 mm, at (20, 0), and (0, 18) by 2, at (0, 20)."""
    points = {"at": [[30, 0], [0, 18]], "tolerance": 4}
    data["output"] = [{"name": "pin", "point": "A", "points": points}]
    found = study(data)
    (plot,) = [each for each in found.plots if each.title == "Path of pin"]
    curves = {label: np.asarray(x) + 1j * np.asarray(y) for label, x, y in plot.series}
    assert list(curves) == ["path", "every 15 deg", "wanted", "within 4 mm", "missed by"]
    assert curves["wanted"].tolist() == [30, 18j]
    ways = curves["missed by"].reshape(2, 3)
    assert (
        ways[:, :2] == pytest.approx(np.array([[30, 20], [18j, 20j]]), abs=1e-5)
        and np.isnan(ways[:, 2]).all()
    )
    away = np.abs(curves["within 4 mm"][:, None] - np.array([30, 18j])).min(axis=1)
    assert np.nanmax(away) == pytest.approx(4) and np.nanmin(away) == pytest.approx(4, abs=1e-6)
    drawn = {sketch.name: sketch for sketch in found.sketches}
    assert [z for z, _ in drawn["pin: wanted"].circles] == [30, 18j] and len(
        drawn["pin: wanted"].strokes
    ) == 2
