"""What is said of specs of linkages that cannot be: by the keys and words of the spec, each fault once, with what would do."""

from __future__ import annotations

import math
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from camgen.cli import main
from camgen.errors import DesignError, SpecError
from camgen.findings import Where
from camgen.geometry.rings import Ring
from camgen.judge.contours import contour_error
from camgen.machine.targets import Course, Straight
from camgen.machines.linkage.mechanism import Linkage
from camgen.parts.gears import GearWish, pair
from camgen.pipeline.build import long_run
from camgen.reading import read
from camgen.report.terminal import Bar
from camgen.spec import validate


@pytest.fixture
def four_bar(root: Path) -> dict[str, Any]:
    return read(root / "specs" / "linkage.toml")


@pytest.mark.parametrize(
    ("place", "right"),
    [
        ([20, 5, 0], "write [20, 5], or with decimal points [20.5, 0] or [20, 5.0]"),
        ([-20, 5, 0], "write [-20, 5], or with decimal points [-20.5, 0] or [-20, 5.0]"),
        ([1, 2, 3, 4], "a list of 2, each a number >= -1000000 and <= 1000000"),
        ([1.5, 2, 3], "a list of 2, each a number"),
    ],
)
def test_a_decimal_comma_in_a_point_is_told_with_both_readings(
    place: list[float], right: str
) -> None:
    tables = {"mechanism": "linkage", "name": "a", "points": {"O": [0, 0], "A": place}}
    with pytest.raises(SpecError) as caught:
        validate(Linkage, tables, "spec")
    (fault,) = [each for each in caught.value.faults if tuple(each.path)[:2] == ("points", "A")]
    assert right in fault.expected


def cam_machine(**changes: Any) -> dict[str, Any]:
    """A disc on O, a rocker on C with a roller at T."""
    rise, back = (
        {"kind": kind, "span_deg": 180, "law": "cycloidal"} for kind in ("rise", "return")
    )
    segments = [{**rise, "lift_deg": 20}, {**back, "to_deg": 0}]
    cam = {"cam": "disc", "follower": "rocker", "at": "T", "radius": 5, "segment": segments}
    return {
        "mechanism": "linkage",
        "name": "own",
        "drive": {"link": "disc", "speed_rpm": 30},
        "points": {"O": [0, 0], "C": [60, 0], "T": [30, 35]},
        "cam": [{**cam, **changes}],
        "links": {"ground": ["O", "C"], "disc": ["O"], "rocker": ["C", "T"]},
        "output": [{"name": "a", "link": "rocker"}],
    }


def faults(data: dict[str, Any]) -> list[str]:
    with pytest.raises(SpecError) as caught:
        validate(Linkage, data)
    return [str(fault) for fault in caught.value.faults]


# ---- cams and gears --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("spans", [[360], [100, 260]])
def test_a_cam_that_moves_nothing_is_told_by_its_key(spans: list[float]) -> None:
    data = cam_machine(segment=[{"kind": "dwell", "span_deg": span} for span in spans])
    said = f"cam.0.segment: {len(spans)} of them, all dwells - expected at least one rise and one return"
    assert faults(data) == [said]


def test_a_roller_too_large_is_told_by_its_key() -> None:
    with pytest.raises(
        DesignError,
        match=r"^tip_radius is 80 mm at cam disc on rocker.* use a smaller tip or a smaller lift$",
    ):
        _ = validate(Linkage, cam_machine(radius=80.0)).assembly


@pytest.mark.parametrize("at", ["T", "O"])
def test_a_cam_that_follows_itself(at: str) -> None:
    assert faults(cam_machine(follower="disc", at=at)) == [
        "cam.0.follower: 'disc' - expected another link: a cam does not move itself"
    ]


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        (
            {"closure": "groove", "spring": {}},
            ['cam.0.spring - no table here: only closure "force" has a spring'],
        ),
        (
            {"face_offset": 2.0},
            [
                "cam.0.face_offset: 2 - expected no value here: only the flat face of a follower that swings has it"
            ],
        ),
        (
            {"polydyne": True},
            [
                "load.stiffness - missing: a cam with polydyne corrects for it",
                "masses.rocker - mass_g of what slides, or inertia_kg_m2 of what swings: what moves behind the stiffness of cam "
                "disc on rocker",
                "cam.0.segment.0.law: 'cycloidal' - expected a polynomial whose first three derivatives are 0 at both ends: 4-5-6-7, or "
                "one by conditions",
                "cam.0.segment.1.law: 'cycloidal' - expected a polynomial whose first three derivatives are 0 at both ends: 4-5-6-7, or "
                "one by conditions",
            ],
        ),
    ],
)
def test_what_does_not_go_with_a_follower_is_told_by_its_key(
    changes: dict[str, Any], said: list[str]
) -> None:
    assert faults(cam_machine(**changes)) == said


def test_a_follower_that_carries_more_has_no_constant_inertia() -> None:
    data = cam_machine(polydyne=True, spring={})
    law = {"law": "4-5-6-7"}
    data["cam"][0]["segment"] = [{**row, **law} for row in data["cam"][0]["segment"]]
    data |= {
        "load": {"stiffness": 300.0},
        "masses": {"rocker": {"mass_g": 0, "inertia_kg_m2": 1e-4}},
    }
    data["points"]["D"], data["points"]["E"] = [70, 60], [120, 60]
    data["links"] |= {"rod": ["T", "D"], "lever": ["D", "E"]}
    data["links"]["ground"] = ["O", "C", "E"]
    assert faults(data) == [
        "cam.0.spring.rate: 0 - expected above 0 with polydyne: it corrects for the spring, which otherwise follows from the cam",
        "cam.0.polydyne: true - expected false: more than rocker moves with this cam, so its inertia is not constant",
    ]


def test_a_base_circle_that_no_follower_reaches_is_refused() -> None:
    with pytest.raises(DesignError, match="cam disc on rocker: pivot, arm and pitch circle make"):
        _ = validate(Linkage, cam_machine(base_radius=200.0)).chain


def test_a_cam_of_a_wheel_runs_in_its_own_sense() -> None:
    """Geared 1 : -1 to the drive, its program goes the other way round against the drive's angle."""
    data = cam_machine()
    segments = data["cam"][0]["segment"]
    segments[0]["span_deg"], segments[1]["span_deg"] = 120, 240
    data["points"] |= {"W": [-40, 0]}
    data["links"] |= {"ground": ["O", "C", "W"], "wheel": ["W"]}
    data["gear"] = [{"a": "wheel", "b": "disc", "ratio": -1}]
    theta = np.radians([0, 30, 60, 120, 200])
    straight = validate(Linkage, data).motion(theta)
    data["drive"]["link"] = "wheel"
    geared = validate(Linkage, data).motion(theta)
    data["drive"]["speed_rpm"] = -30
    back = validate(Linkage, data).motion(-theta)
    assert geared == pytest.approx(straight, abs=1e-9)
    assert back == pytest.approx(straight, abs=1e-9)


def test_a_segment_is_told_by_the_keys_that_it_has(four_bar: dict[str, Any]) -> None:
    rise = {"kind": "rise", "span_deg": 180, "law": "cycloidal"}
    both = [{**rise, "lift_deg": 20}, {**rise, "kind": "return"}]
    said = "segment.1.lift_deg - missing: either lift_deg or to_deg; to_deg = 0 goes back to where the turn begins"
    assert faults(cam_machine(segment=both)) == [f"cam.0.{said}"]
    four_bar["drive"]["segment"] = both
    assert faults(four_bar) == [f"drive.{said}"]


@pytest.mark.parametrize(
    ("ratio", "near"), [(-1.2345, -1.2345), (-0.001, -1 / 400), (-0.71234, -0.71234)]
)
def test_a_ratio_of_no_wheels_is_told_with_one_that_can_be(ratio: float, near: float) -> None:
    with pytest.raises(
        DesignError, match="of at most 400 teeth; take one of whole teeth, such as "
    ) as caught:
        pair(40, ratio, 0.1, 0.0, GearWish(), "gears")
    shown, value = caught.value.remedy.split("such as ")[1].split(" = ")
    a, b = (abs(int(part)) for part in shown.split("/"))
    assert (
        0 < a <= 400
        and 0 < b <= 400
        and float(value) == pytest.approx(-a / b)
        and -a / b == pytest.approx(near, abs=5e-5)
    )


def test_gears_by_name_are_named_once(root: Path) -> None:
    data = {
        "mechanism": "linkage",
        "name": "own",
        "drive": {"link": "crank", "speed_rpm": 30},
        "points": {"O": [0, 0], "C": [4, 0], "A": [10, 5], "B": [50, 5]},
        "output": [{"name": "a", "link": "drum"}],
        "links": {"ground": ["O", "C"], "crank": ["O", "A"], "drum": ["C", "B"]},
        "gear": [{"a": "crank", "b": "drum", "ratio": -2, "name": "gears"}],
    }
    with pytest.raises(DesignError, match="^module is .* mm at gears, limit"):
        _ = validate(Linkage, data).assembly


# ---- faults once, and where they are ---------------------------------------------------------------------------------


def test_a_wrong_output_is_no_missing_one(four_bar: dict[str, Any]) -> None:
    four_bar["output"] = [{"name": "pen", "piont": "P"}]
    (told,) = faults(four_bar)
    assert told.startswith("output.0.piont: unknown key; did you mean 'point'")
    four_bar["output"] = []
    (told,) = faults(four_bar)
    assert told.startswith("output - missing: [[output]] with a name and a point or link")
    del four_bar["output"]
    four_bar["drive"]["rpm"] = 60
    assert {each.partition(":")[0].split(" ")[0] for each in faults(four_bar)} == {
        "output",
        "drive.rpm",
    }


def test_a_fault_that_is_found_late_names_the_file(
    root: Path, four_bar: dict[str, Any], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = (root / "specs" / "linkage.toml").read_text(
        "utf-8"
    ) + '[[include]]\nspec = "other.toml"\nride = { foo = "crank" }\n'
    (tmp_path / "host.toml").write_text(text, "utf-8")
    (tmp_path / "other.toml").write_text(
        (root / "specs" / "thread-take-up.toml").read_text("utf-8"), "utf-8"
    )
    with pytest.raises(SystemExit):
        main(
            ["build", str(tmp_path / "host.toml"), "--out", str(tmp_path / "out"), "--only", "dxf"]
        )
    told = capsys.readouterr().err
    assert told.startswith(
        f"error: {tmp_path / 'host.toml'}: 1 fault\n  include.0.ride.foo: 'foo' - expected one of "
    )


def test_a_straight_stretch_longer_than_the_path_has_its_reason() -> None:
    theta = np.linspace(0, math.tau, 721)
    circle_of_30 = Course(theta, 30 * np.exp(1j * theta), 30j * np.exp(1j * theta), "mm", True)
    found = Straight(tolerance=1.0, length=61.0).finding(circle_of_30, Where())
    assert not found.ok
    assert (
        found.message
        == "the path has no stretch of 61 mm, its places are at most 60 mm apart: ask for less"
    )


# ---- large machines --------------------------------------------------------------------------------------------------


def square(size: float, notch: float) -> Ring:
    """A square, its upper edge notched by so much in the middle; mm."""
    corners = size * np.array([0, 1, 1 + 1j, 0.6 + 1j, 0.5 + 1j, 0.4 + 1j, 1j])
    corners[4] -= 1j * notch
    return Ring(corners, np.zeros(len(corners)))


def test_contours_of_a_machine_of_a_hundred_metres_are_compared_in_bounded_time() -> None:
    """What is off is found all the same; a point every quarter millimetre would take 1.6 million of them."""
    begin = time.process_time()
    assert contour_error(square(1e5, 0.5), square(1e5, 0.0), 1e-3) == pytest.approx(0.5, abs=1e-9)
    assert time.process_time() - begin < 4.0


def test_a_long_run_is_told_beforehand(
    four_bar: dict[str, Any], capsys: pytest.CaptureFixture[str]
) -> None:
    """Twenty four-bars in a row, each driven by the one before; the starter's is made at once."""
    points, links = {"O": [0, 0], "A": [10, 0]}, {"ground": ["O"], "crank": ["O", "A"]}
    for k, before in enumerate(["A", *(f"B{k}" for k in range(19))]):
        points |= {f"C{k}": [60 * (k + 1), 0], f"B{k}": [60 * (k + 1), 45]}
        links["ground"].append(f"C{k}")
        links |= {f"c{k}": [before, f"B{k}"], f"r{k}": [f"C{k}", f"B{k}"]}
    last = {"name": "a", "link": "r19"}
    row = validate(
        Linkage, {**four_bar, "points": points, "links": links, "lengths": {}, "output": [last]}
    )
    links = row.remarks().links
    assert long_run(links, 3) == "42 links: making and judging them takes about 38 s"
    assert long_run(links, 1) == "" == long_run(validate(Linkage, four_bar).remarks().links, 3)
    with Bar() as progress:
        progress(f"note: {long_run(links, 3)}")
    assert capsys.readouterr().err == "note: 42 links: making and judging them takes about 38 s\n"


def test_a_base_radius_that_is_found_is_filled_into_the_rows_as_they_are_typed() -> None:
    chart = [{"at_deg": 180, "to_deg": 20}, {"at_deg": 360, "to_deg": 0}]
    data = cam_machine(segment=chart, base_radius="least")
    machine = validate(Linkage, data)
    vars(machine)["source_tables"] = data
    (row,) = machine.settled_tables()["cam"]
    base_radius = row["base_radius"]
    assert base_radius > 0 and {**row, "base_radius": "least"} == data["cam"][0]
    (filled,) = machine.resolved().model_dump(by_alias=True)["cam"]
    assert filled["base_radius"] == base_radius


def test_a_linkage_without_its_tables_is_told_what_to_write() -> None:
    told = faults({"mechanism": "linkage", "name": "bare"})
    assert [each.partition(" ")[0] for each in told] == ["points", "links", "drive"]
    assert "such as A = [20, 0]" in told[0] and 'crank = ["O", "A"]' in told[1]
    assert "[drive] with the link that turns" in told[2]
