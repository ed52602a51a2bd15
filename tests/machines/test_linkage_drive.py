"""What drives a linkage: a program in place of an even turn, both senses, a rocker as the input."""

from __future__ import annotations

import copy
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w

from camgen.errors import DesignError, SpecError
from camgen.machines.linkage.mechanism import Linkage
from camgen.pipeline.build import build
from camgen.reading import read
from camgen.spec import validate

STEPPED = [
    {"kind": "rise", "span_deg": 270.0, "lift_deg": 360.0, "law": "cycloidal"},
    {"kind": "dwell", "span_deg": 90.0},
]


def there_and_back(lift: float) -> list[dict[str, Any]]:
    law = {"law": "cycloidal"}
    return [
        {"kind": "rise", "span_deg": 100.0, "lift_deg": lift, **law},
        {"kind": "dwell", "span_deg": 90.0},
        {"kind": "return", "span_deg": 170.0, "lift_deg": lift, **law},
    ]


@pytest.fixture
def four_bar(root: Path) -> dict[str, Any]:
    return read(root / "specs" / "linkage.toml")


def driven(data: dict[str, Any], **drive: Any) -> Linkage:
    changed = copy.deepcopy(data)
    changed["drive"] |= drive
    return validate(Linkage, changed)


def test_a_stepped_crank_passes_the_places_of_an_even_one(four_bar: dict[str, Any]) -> None:
    """A cycloidal rise of a turn over 270 deg of the period, then a rest; a second period goes on."""
    theta = np.linspace(0, 2 * math.tau, 1441)
    u = np.minimum(np.mod(theta, math.tau) / math.radians(270), 1)
    turned = math.tau * (u - np.sin(math.tau * u) / math.tau + np.floor(theta / math.tau))
    stepped, even = driven(four_bar, segment=STEPPED).solve(theta), driven(four_bar).solve(turned)
    assert np.max(np.abs(stepped["pen"] - even["pen"])) < 1e-9
    rate = np.where(u < 1, math.tau / math.radians(270) * (1 - np.cos(math.tau * u)), 0.0)
    assert np.max(np.abs(stepped.velocity["pen"] - rate * even.velocity["pen"])) < 1e-6


def test_a_dwell_of_the_drive_is_one_of_the_output(four_bar: dict[str, Any]) -> None:
    four_bar["output"] = [
        {"name": "swing", "link": "rocker", "dwell": {"span_deg": 90.0, "band": 0.001}}
    ]
    assert next(f for f in driven(four_bar, segment=STEPPED).limits() if f.code == "DWELL").ok
    assert not next(f for f in driven(four_bar).limits() if f.code == "DWELL").ok


@pytest.mark.long
def test_a_stepped_crank_from_its_files(four_bar: dict[str, Any], tmp_path: Path) -> None:
    four_bar["drive"]["segment"] = STEPPED
    four_bar["drive"]["speed_rpm"] = 30  # in the middle: where the crank steps a hand still follows
    file = tmp_path / "stepped.toml"
    file.write_text(tomli_w.dumps(four_bar), encoding="utf-8")
    report = build(file, tmp_path, frozenset({"dxf", "3mf"}))
    assert report.ok, [finding for finding in report.findings if not finding.ok]
    assert any(
        "drive angle" in str(finding.where)
        for finding in report.findings
        if finding.code == "INTERFERENCE"
    )
    rows = np.loadtxt(tmp_path / "linkage" / "motion.csv", delimiter=",", skiprows=1)
    assert np.ptp(rows[1081:, 1]) < 1e-9  # rests from 270 deg on
    again = build(tmp_path / "linkage" / "spec.toml", tmp_path / "again", frozenset({"dxf"}))
    assert again.ok


def test_a_rocker_by_a_program_keeps_to_what_the_chain_has(four_bar: dict[str, Any]) -> None:
    """Crank 20 and coupler 60 in line, 80 or 40 from C, end the rocker's swing: from -9.14 to 38.6 deg of the drawn place."""
    assert all(
        finding.ok
        for finding in driven(four_bar, link="rocker", segment=there_and_back(30.0)).limits()
    )
    with pytest.raises(
        DesignError,
        match=r"drive.segment goes from 0 to 60 deg.*closes from -9.14081 to 38.5982 deg",
    ):
        driven(four_bar, link="rocker", segment=there_and_back(60.0)).limits()
    with pytest.raises(
        DesignError, match=r"cannot turn fully.*\(with a transmission angle of 30 deg\)"
    ) as caught:
        driven(four_bar, link="rocker").limits()
    low, high = map(
        float, str(caught.value).partition("range_deg = [")[2].partition("]")[0].split(", ")
    )
    for wider, holds in (
        (0.0, True),
        (1.0, False),
    ):  # what it advises keeps to the limits, a degree more does not
        found = driven(four_bar, link="rocker", range_deg=[low - wider, high + wider]).limits()
        assert all(each.ok for each in found if each.code == "TRANSMISSION_ANGLE") is holds
    with pytest.raises(
        DesignError,
        match=r"by Grashof's rule only the shortest link turns fully, and that is crank \(20 mm\), not rocker",
    ):
        driven(four_bar, link="rocker").limits()


def test_clockwise_passes_the_same_places_with_speeds_turned_round(
    four_bar: dict[str, Any],
) -> None:
    theta = np.linspace(0, 6, 50)
    one, other = (
        driven(four_bar, speed_rpm=60.0).solve(theta),
        driven(four_bar, speed_rpm=-60.0).solve(theta),
    )
    assert np.array_equal(one["pen"], other["pen"])
    assert np.allclose(one.velocity["swing"], -np.asarray(other.velocity["swing"]), rtol=1e-12)


@pytest.mark.parametrize(
    ("drive", "path"),
    [
        ({"segment": STEPPED, "range_deg": [0, 20]}, "drive.range_deg"),
        ({"segment": STEPPED, "speed_rpm": -60.0}, "drive.speed_rpm"),
        ({"segment": STEPPED[:1]}, "drive.segment"),
        ({"segment": [{**STEPPED[0], "lift_deg": 300.0}, STEPPED[1]]}, "drive.segment.1"),
        ({"segment": [{**STEPPED[0], "law": "cycloid"}, STEPPED[1]]}, "drive.segment.0.law"),
    ],
)
def test_programs_that_are_none(four_bar: dict[str, Any], drive: dict[str, Any], path: str) -> None:
    with pytest.raises(SpecError) as caught:
        driven(four_bar, **drive)
    assert path in [fault.key for fault in caught.value.faults]


@pytest.mark.long
def test_a_program_from_a_file_of_points(four_bar: dict[str, Any], tmp_path: Path) -> None:
    """Read from beside the spec; the resolved spec needs it no more."""
    (tmp_path / "rise.csv").write_text(
        "angle,turned\n0,0\n30,40\n60,200\n90,360\n", encoding="utf-8"
    )
    four_bar["drive"]["segment"] = [
        {**STEPPED[0], "law": {"name": "table", "file": "rise.csv"}},
        STEPPED[1],
    ]
    file = tmp_path / "stepped.toml"
    file.write_text(tomli_w.dumps(four_bar), encoding="utf-8")
    report = build(file, tmp_path, frozenset({"dxf"}))
    assert report.ok, [finding for finding in report.findings if not finding.ok]
    rows = np.loadtxt(tmp_path / "linkage" / "motion.csv", delimiter=",", skiprows=1)
    even = driven({**four_bar, "drive": {"link": "crank"}}).solve(np.radians([40.0, 200.0]))["pen"]
    assert rows[[360, 720], 1] == pytest.approx(
        even.real, abs=1e-6
    )  # 30 and 60 of 90 are 90 and 180 of 270 deg
    (tmp_path / "rise.csv").unlink()
    assert build(tmp_path / "linkage" / "spec.toml", tmp_path / "again", frozenset({"dxf"})).ok


def test_a_program_and_an_included_machine_do_not_share_a_shaft(four_bar: dict[str, Any]) -> None:
    four_bar["include"] = [{"spec": "other.toml"}]
    with pytest.raises(SpecError, match="turns evenly with the shaft"):
        driven(four_bar, segment=STEPPED)


def test_the_range_advised_holds_no_change_point(root: Path) -> None:
    """The crank is as long as the rod and A is drawn on its shaft: at 90 deg, where A stands there for either branch, they meet."""
    tables = read(root / "specs" / "gallery" / "elliptic-trammel.toml")
    tables["points"]["A"] = [-80, 0]
    with pytest.raises(DesignError, match="cannot turn fully") as caught:
        validate(Linkage, tables).limits()
    low, high = map(
        float, str(caught.value).partition("range_deg = [")[2].partition("]")[0].split(", ")
    )
    assert -90 < low < -85 and 85 < high < 90
    followed = validate(Linkage, tables | {"drive": tables["drive"] | {"range_deg": [low, high]}})
    assert followed.chain.joints  # built, without a word on folds
    wider = validate(Linkage, tables | {"drive": tables["drive"] | {"range_deg": [low, 91.0]}})
    with pytest.raises(DesignError, match="change point at 9"):
        wider.limits()


def test_no_range_is_advised_beside_a_change_point(root: Path) -> None:
    """Drawn half a degree before it, the beam's other slot so near that the chain opens on the way back."""
    tables = read(root / "specs" / "gallery" / "elliptic-trammel.toml")
    lean = math.sin(math.radians(0.5))
    tables["points"] |= {
        "A": [-80 + 64 * lean, 0],
        "K": [-80 + 32 * lean, 32 * math.cos(math.asin(lean))],
        "B": [-100, 24],
        "Y1": [-100, 20],
        "Y2": [-100, 43],
    }
    with pytest.raises(DesignError, match="turn fully.*; change the lengths of") as caught:
        validate(Linkage, tables).limits()
    assert "range_deg" not in caught.value.remedy
