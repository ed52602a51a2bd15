"""Wanted values of a linkage's outputs: on the model against closed forms, from files, and what is refused."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w
from judged import wrong

from camgen.errors import DesignError, SpecError
from camgen.findings import Finding, Where, at_most
from camgen.machine import targets
from camgen.machine.targets import extent
from camgen.machines import free_play
from camgen.machines.linkage.mechanism import Linkage
from camgen.pipeline.build import build
from camgen.reading import read
from camgen.spec import validate

SHAPER = {
    "points": {"O": [0, 0], "A": [0, 20], "D": [0, -50], "E": [0, 60]},
    "links": {"ground": ["O", "D"], "crank": ["O", "A"], "arm": ["D", "E"]},
    "slot": [{"pin": "A", "link": "arm", "along": ["D", "E"]}],
}
# Hoeken's straight-line chain, ten times its published proportions 1 : 2 : 2.5 : 2.5, tracing point at 5 on the coupler.
HOEKEN = {
    "points": {"O": [0, 0], "C": [20, 0], "A": [-10, 0], "B": [5, 20], "P": [20, 40]},
    "links": {
        "ground": ["O", "C"],
        "crank": ["O", "A"],
        "coupler": ["A", "B", "P"],
        "rocker": ["C", "B"],
    },
    "lengths": {"O-C": 20, "O-A": 10, "A-B": 25, "C-B": 25, "B-P": 25, "A-P": 50},
}


def spec(**tables: Any) -> dict[str, Any]:
    return {
        "mechanism": "linkage",
        "name": "own",
        "drive": {"link": "crank", "speed_rpm": 60},
        **tables,
    }


def found(output: dict[str, Any], **tables: Any) -> dict[str, Finding]:
    machine = validate(Linkage, spec(**tables, output=[output]))
    return {finding.code: finding for finding in machine.limits()}


def test_time_ratio_of_the_crank_shaper() -> None:
    """(180 + alpha) / (180 - alpha), alpha the arm's swing."""
    alpha = 2 * math.degrees(math.asin(20 / 50))
    ratio = (180 + alpha) / (180 - alpha)
    arm = {"name": "arm", "link": "arm"}
    asked = {
        "time_ratio": {"value": ratio, "tolerance": 1e-4},
        "stroke": {"value": alpha, "tolerance": 1e-5},
    }
    good = found({**arm, **asked}, **SHAPER)
    assert good["TIME_RATIO"].ok and good["STROKE_ERROR"].ok and good["STROKE_ERROR"].unit == "deg"
    assert not found({**arm, "time_ratio": {"value": ratio + 0.01, "tolerance": 1e-3}}, **SHAPER)[
        "TIME_RATIO"
    ].ok


def test_an_output_that_turns_round_has_no_time_ratio() -> None:
    """The crank itself: it has no two strokes."""
    wanted = {"name": "in", "link": "crank", "time_ratio": {"value": 1.5, "tolerance": 0.02}}
    with pytest.raises(DesignError, match="output in turns all round.*no two strokes") as caught:
        found(wanted, **SHAPER)
    assert "time_ratio" in caught.value.remedy


def test_hoekens_line_is_nearly_straight_over_half_a_turn() -> None:
    """Half a turn of the crank about the place away from the rocker's pivot, the least of its published uses."""
    pen = {"name": "pen", "point": "P"}
    straight = found({**pen, "straightness": {"range_deg": [-90, 90], "tolerance": 1.0}}, **HOEKEN)[
        "STRAIGHTNESS"
    ]
    curved = found({**pen, "straightness": {"range_deg": [0, 360], "tolerance": 1.0}}, **HOEKEN)[
        "STRAIGHTNESS"
    ]
    assert straight.ok and not curved.ok and curved.measured > 5


@pytest.mark.long
def test_targets_from_files_and_their_damage(root: Path, tmp_path: Path) -> None:
    """The swing's 47.7 deg follow from the lengths; the rocker's hole 0.3 mm nearer makes it wider."""
    from tests.machines.test_linkage import shifted_hole

    data = read(root / "specs" / "linkage.toml")
    least, most = (
        math.degrees(math.acos((70**2 + 50**2 - way**2) / (2 * 70 * 50))) for way in (40, 80)
    )
    data["output"][1] |= {"stroke": {"value": most - least, "tolerance": 0.1}}
    machine = validate(Linkage, data)
    course = np.asarray(machine.run(np.linspace(0, math.tau, 361), 0)["pen"])
    data["output"][0] |= {"points": {"at": [[22, 52]], "tolerance": 1.0}}
    data["output"][0] |= {
        "path": {"at": np.stack([course.real, course.imag], 1).tolist(), "tolerance": 0.05}
    }
    file = tmp_path / "own.toml"
    file.write_text(tomli_w.dumps(data), encoding="utf-8")
    report = build(file, tmp_path, frozenset({"dxf"}))
    assert report.ok, [finding for finding in report.findings if not finding.ok]
    places = {
        code: [str(f.where) for f in report.findings if f.code == code]
        for code in ("STROKE_ERROR", "PATH_ERROR")
    }
    assert (
        places["STROKE_ERROR"] == ["swing as designed", "linkage-*.dxf, swing"]
        and len(places["PATH_ERROR"]) == 4
    )
    shifted_hole(tmp_path / "linkage" / "linkage-rocker.dxf", 50 + 0j, -0.3)
    failed = {(f.code, str(f.where)) for f in wrong(tmp_path / "linkage", "dxf")}
    assert ("STROKE_ERROR", "linkage-*.dxf, swing") in failed and (
        "STROKE_ERROR",
        "swing as designed",
    ) not in failed
    assert ("PATH_ERROR", "linkage-*.dxf, pen") in failed and (
        "PATH_ERROR",
        "pen as designed",
    ) not in failed


@pytest.mark.long
def test_a_path_as_a_whole_from_the_model() -> None:
    """Its own course but for one corner that is 0.3 mm off."""
    run = validate(Linkage, spec(**HOEKEN, output=[{"name": "pen", "point": "P"}])).run(
        np.linspace(0, math.tau, 721), 0
    )
    course = [[z.real, z.imag] for z in np.asarray(run["pen"]).tolist()]
    pen = {"name": "pen", "point": "P"}
    assert found({**pen, "path": {"at": course, "tolerance": 0.01}}, **HOEKEN)["PATH_ERROR"].ok
    low = min(range(721), key=lambda k: course[k][1])
    course[low][1] -= 0.3
    off = found({**pen, "path": {"at": course, "tolerance": 0.01}}, **HOEKEN)["PATH_ERROR"]
    assert not off.ok and off.measured == pytest.approx(0.3, abs=1e-3)


@pytest.mark.parametrize(
    "path, breadth",
    [
        (50 * np.exp(1j * np.cos(np.linspace(0, math.tau, 721))), 0.0),  # an arc, there and back
        (50 * np.exp(1j * np.linspace(0, 1, 100)), 0.0),  # once
        (np.linspace(0, 30, 9) * np.exp(0.3j), 0.0),
        (20 * np.exp(1j * np.linspace(0, math.tau, 721)), math.pi / 4 * 40),  # area over length
        (
            30 * np.cos(np.linspace(0, math.tau, 2001))
            + 6j
            * np.sin(2 * np.linspace(0, math.tau, 2001)),  # a figure of eight: both loops count
            12 * 2 / 3,
        ),
    ],
    ids=["arc", "once", "line", "circle", "eight"],
)
def test_the_breadth_of_a_path_is_its_area_over_its_length(path: Any, breadth: float) -> None:
    """In closed form: of the circle pi/4 of its diameter; of x = a cos t, y = b sin 2t the area is 8 a b / 3, the length 2 a."""
    length, _ = extent(np.asarray(path, complex))
    for turn in (0.0, 0.7, 2.0):
        found_breadth = targets.breadth(np.asarray(path * np.exp(1j * turn), complex))
        assert found_breadth == pytest.approx(breadth, abs=0.02 * length)


def test_the_play_of_an_arc_is_borne_to_a_quarter_of_its_length() -> None:
    """The rocker's pin of a four-bar goes to and fro on a circle: its sagitta says nothing of its play."""
    bar = {
        "points": {"O": [0, 0], "A": [20, 0], "B": [60, 50], "C": [70, 0]},
        "links": {
            "ground": ["O", "C"],
            "crank": ["O", "A"],
            "rod": ["A", "B"],
            "rocker": ["C", "B"],
        },
        "drive": {"link": "crank", "speed_rpm": 25},
        "output": [{"name": "pin", "point": "B"}],
    }
    machine = validate(Linkage, spec(**bar))
    arc = np.asarray(machine.run(np.linspace(0, math.tau, 721), 0)["pin"])
    (asked,) = machine.assembly.demands
    chord = max(np.abs(arc - arc[k]).max() for k in range(0, 721, 5))
    assert asked.lash == pytest.approx(chord / 4, rel=1e-2) and "length" in asked.lash_of


def test_what_stands_still_has_no_stroke_that_bounds_its_play() -> None:
    """Unless the spec says how much is borne nothing is; of what moves by 2 mm half of that at most."""
    still = np.zeros(9)
    assert free_play.limit_of(0.2, still)[0] == 0.2
    assert free_play.limit_of(math.inf, still)[0] == math.inf
    assert free_play.limit_of(math.inf, np.linspace(0, 2, 9))[0] == 1.0
    course = targets.Course(np.linspace(0, math.tau, 9), still, still, "deg", True)
    lash, said = free_play.accepted(course, None, None)
    assert lash == math.inf and "limits.lash_deg" in said
    assert free_play.accepted(course, None, 3.0)[0] == math.radians(3)


def test_the_play_of_a_path_is_borne_to_a_quarter_of_its_smaller_side() -> None:
    machine = validate(Linkage, spec(**HOEKEN, output=[{"name": "pen", "point": "P"}]))
    course = np.asarray(machine.run(np.linspace(0, math.tau, 721), 0)["pen"])
    widths = [np.ptp((course * np.exp(1j * turn)).imag) for turn in np.linspace(0, math.pi, 2001)]
    (asked,) = machine.assembly.demands
    assert (
        asked.lash == pytest.approx(min(widths) / 4, rel=1e-3) and "smaller side" in asked.lash_of
    )
    (asked,) = validate(
        Linkage, spec(**HOEKEN, output=[{"name": "pen", "point": "P"}], limits={"lash": 3.0})
    ).assembly.demands
    assert (asked.lash, asked.lash_of) == (3.0, "limits.lash")
    slider = {
        "points": {"O": [0, 0], "A": [10, 0], "B": [50, 0], "K": [20, 0], "R": [80, 0]},
        "links": {"ground": ["O", "K", "R"], "crank": ["O", "A"], "rod": ["A", "B"], "ram": ["B"]},
        "slide": [{"link": "ram", "along": ["K", "R"]}],
    }
    (asked,) = validate(
        Linkage, spec(**slider, output=[{"name": "end", "point": "B"}])
    ).assembly.demands
    assert (
        asked.lash == pytest.approx(20 / 4, rel=1e-6) and "length" in asked.lash_of
    )  # a line has one side: twice the crank


@pytest.mark.parametrize(
    ("wish", "code", "play", "told"),
    [
        ({"straightness": {"length": 10, "tolerance": 0.5}}, "STRAIGHTNESS", 3.0, True),
        ({"straightness": {"length": 10, "tolerance": 0.5}}, "STRAIGHTNESS", 0.9, False),
        ({"points": {"at": [[20, 40]], "tolerance": 0.1}}, "PATH_ERROR", 0.3, True),
        ({"stroke": {"value": 40, "tolerance": 0.5}}, "", 3.0, False),
        ({}, "", 3.0, False),
    ],
)
def test_play_that_is_more_than_a_target_is_told(
    wish: dict[str, Any], code: str, play: float, told: bool
) -> None:
    """Unless the spec says what play is accepted; a stroke is a difference, in which play counts otherwise."""
    output = [{"name": "pen", "point": "P", **wish}]
    demands = validate(Linkage, spec(**HOEKEN, output=output)).assembly.demands
    lash = at_most("LASH", play, 5.0, "mm", Where(kind="dxf"), "")
    said = free_play.beyond_targets([lash], demands)
    assert bool(said) == told and all(
        text.startswith(f"pen: {code} is judged")
        and f"{play / 2:g} mm either way" in text
        and "limits.lash" in text
        for text in said
    )
    accepting = validate(Linkage, spec(**HOEKEN, output=output, limits={"lash": 5.0}))
    assert not free_play.beyond_targets([lash], accepting.assembly.demands)


@pytest.mark.long
def test_a_four_bar_with_much_play_tells_it_beside_its_straightness(tmp_path: Path) -> None:
    wish = {"straightness": {"length": 10, "tolerance": 0.1}}
    tables = spec(**HOEKEN, output=[{"name": "pen", "point": "P", **wish}])
    report = build(tables, tmp_path, frozenset({"dxf"}))
    assert any("pen: STRAIGHTNESS is judged in the middle" in text for text in report.warnings)


@pytest.mark.parametrize(
    ("output", "path"),
    [
        ({"link": "rocker", "path": {"at": [[1, 2], [3, 4]], "tolerance": 1}}, "output.0.path"),
        ({"point": "P", "path": {"at": [[1, 2]], "tolerance": 1}}, "output.0.path.at"),
        ({"link": "rocker", "points": {"at": [[1, 2]], "tolerance": 1}}, "output.0.points"),
        (
            {"link": "rocker", "straightness": {"length": 3, "tolerance": 1}},
            "output.0.straightness",
        ),
        ({"point": "P", "dwell": {"span_deg": 3, "band": 1}}, "output.0.dwell"),
        ({"point": "P", "time_ratio": {"value": 2, "tolerance": 1}}, "output.0.time_ratio"),
        ({"point": "P", "straightness": {"tolerance": 1}}, "output.0.straightness"),
        (
            {"point": "P", "straightness": {"tolerance": 1, "range_deg": [50, 20]}},
            "output.0.straightness.range_deg",
        ),
        (
            {"point": "P", "points": {"at": [[1, 2]], "tolerance": 1, "theta_deg": [1, 2]}},
            "output.0.points.theta_deg",
        ),
        ({"link": "rocker", "stroke": {"value": 0, "tolerance": 1}}, "output.0.stroke.value"),
        ({"link": "rocker", "stroke": {"value": 3}}, "output.0.stroke.tolerance"),
    ],
)
def test_targets_that_cannot_be_asked(output: dict[str, Any], path: str) -> None:
    with pytest.raises(SpecError) as caught:
        validate(Linkage, spec(**HOEKEN, output=[{"name": "o", **output}]))
    assert path in [fault.key for fault in caught.value.faults]


def test_angles_out_of_the_range_of_the_drive() -> None:
    tables = {**HOEKEN, "drive": {"link": "crank", "range_deg": [-90, 90]}}
    output = {"name": "o", "point": "P", "straightness": {"tolerance": 1, "range_deg": [50, 100]}}
    with pytest.raises(SpecError, match="within drive.range_deg, -90 to 90"):
        validate(Linkage, {"mechanism": "linkage", "name": "own", **tables, "output": [output]})
