"""Keys of a spec that vary until every limit holds."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from camgen.design import keys
from camgen.design.run import design
from camgen.design.wanted import wish
from camgen.edits import edited, with_tables
from camgen.errors import DesignError, FileError, SpecError

CAM = """# a cam
mechanism = "disc-cam"
name = "found"

[geometry]
base_radius = 40 # is found

[geometry.follower]
motion = "translating"
shape = "roller"
radius = 5

[[segment]]
kind = "rise"
span_deg = 90
lift = 10
law = "cycloidal"

[[segment]]
kind = "return"
span_deg = 90
to = 0
law = "cycloidal"

[[segment]]
kind = "dwell"
span_deg = 180

[motor]
speed_rpm = 60

[wanted]
vary = { "geometry.base_radius" = [10, 80] }
least = "geometry.base_radius"
figures = { pressure_angle_deg = [0, 20] }
"""


def prime_radius(angle: float, offset: float = 0.0) -> float:
    """Of the least cam of a cycloidal rise of 10 mm over 90 deg by the textbook's tan = s' / (r0 + s), by bisection."""
    beta = math.pi / 2
    u = np.linspace(0, 1, 200_001)
    s = 10 * (u - np.sin(2 * math.pi * u) / (2 * math.pi))
    slope = 10 / beta * (1 - np.cos(2 * math.pi * u))
    return float(np.max(slope / math.tan(angle) - s))


@pytest.fixture(autouse=True)
def few(monkeypatch: pytest.MonkeyPatch) -> None:
    """Forty designs where sixty are usual."""
    monkeypatch.setattr(keys, "_EACH", 40)


def test_the_least_cam_has_the_pressure_angle_that_is_allowed(tmp_path: Path) -> None:
    spec = tmp_path / "cam.toml"
    spec.write_text(CAM, encoding="utf-8")
    text = design(spec)
    assert "# a cam" in text and "# is found" in text and "wanted" not in text
    found = tomllib.loads(text)["geometry"]["base_radius"]
    least = prime_radius(math.radians(20)) - 5  # of the pitch curve, less the roller
    assert (
        least - 1e-3 < found < least + 0.05
    )  # 60 designs over 70 mm: what a simplex of so few steps reaches


def test_the_least_cam_holds_its_hub() -> None:
    """By what a build would refuse, though no limit of the exact profile fails: the hub, 90 mm wide, leaves a lesser cam."""
    found = tomllib.loads(
        design(tomllib.loads(CAM) | {"parts": {"hub_diameter": 90.0, "hub_height": 6.0}})
    )
    assert 45 < found["geometry"]["base_radius"] < 46


LINKAGE = Path(__file__).resolve().parents[2] / "specs" / "linkage.toml"


def test_play_that_a_wish_bears_is_a_limit_of_the_spec() -> None:
    """limits.lash is the wish's: what has more play fails, and what is found says it."""
    cam = tomllib.loads(CAM)
    cam["geometry"]["closure"] = "groove"
    cam["wanted"] = {"vary": {"geometry.base_radius": [40, 41]}, "least": "geometry.base_radius"}
    cam["wanted"]["lash"] = 0.25
    assert tomllib.loads(design(cam))["limits"]["lash"] == 0.25
    cam["wanted"]["lash"] = 0.05
    with pytest.raises(DesignError, match="LASH"):
        design(cam)


def test_a_wish_s_transmission_angle_and_tolerance_are_those_of_the_spec() -> None:
    crank = tomllib.loads(LINKAGE.read_text(encoding="utf-8"))
    crank["output"] = [
        {"name": "swing", "link": "rocker", "stroke": {"value": 90, "tolerance": 0.1}}
    ]
    crank["wanted"] = {"vary": {"lengths.A-B": [60, 60.01]}, "least": "lengths.A-B"}
    crank["wanted"] |= {"tolerance": 170.0, "transmission_deg": 5.0}
    found = tomllib.loads(design(crank))
    assert found["limits"]["transmission_angle_deg"] == 5.0
    assert found["output"][0]["stroke"]["tolerance"] == 170.0


def test_what_cannot_be_is_told_with_the_nearest() -> None:
    with pytest.raises(
        DesignError, match=r"none of \d+ designs keeps every limit; the nearest one"
    ):
        design(
            tomllib.loads(CAM)
            | {
                "wanted": {
                    "vary": {"geometry.base_radius": [10.0, 20.0]},
                    "least": "geometry.base_radius",
                    "figures": {"pressure_angle_deg": [0.0, 3.0]},
                }
            }
        )


@pytest.mark.parametrize(
    ("wanted", "said"),
    [
        ({"vary": {"geometry.base_radius": [20.0, 10.0]}, "least": "x"}, "the least value first"),
        ({"vary": {"geometry.base_radius": [10.0, 20.0]}}, "one of wanted.least and wanted.most"),
        (
            {"vary": {"geometry.base_radius": [10.0, 20.0]}, "least": "presure_angle_deg"},
            "did you mean 'pressure_angle_deg'",
        ),
        (
            {"vary": {"geometry.bse_radius": [10.0, 20.0]}, "least": "pressure_angle_deg"},
            "geometry.bse_radius",
        ),
        ({"vary": {}, "least": "x"}, "wanted.vary"),
        (
            {"vary": {"geometry.base_radius": [-20.0, 20.0]}, "least": "x"},
            'wanted.vary."geometry.base_radius": -20',
        ),
        ({"vary": {"a b=3 #": [10.0, 20.0]}, "least": "stroke_mm"}, "a key of the spec"),
        ({"path": [[0, 0], [1, 1], [2, 0]]}, '"linkage", for a path'),
        ({"path": "none.csv", "bars": 5}, "wanted.bars"),
        ({}, "wanted"),
        (
            {"vary": {"geometry.base_radius": [20, 30]}, "least": "stroke_mm", "tolerance": 1},
            "wanted.tolerance: 1 - expected nothing: the spec has no target in [[output]]",
        ),
        (
            {
                "vary": {"geometry.base_radius": [20, 30]},
                "least": "stroke_mm",
                "transmission_deg": 9,
            },
            "the spec has no limits.transmission_angle_deg",
        ),
    ],
)
def test_faults_of_a_wish_are_told(wanted: dict[str, Any], said: str) -> None:
    with pytest.raises(SpecError) as error:
        design(tomllib.loads(CAM) | {"wanted": wanted})
    assert said in str(error.value)


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ("x,y\n1,2\n", "1 different points"),
        ("1,2\na,b\n", "line 2.*two numbers: x and y"),
        ("1,2\n3,1e9\n", "within"),
        ("1,2\n1,nan\n", "line 2"),
        ("", "rows of two numbers: x and y"),
        (
            "\n".join(f"{(k * 7919) % 97},{(k * 31) % 89}" for k in range(60)),
            "a line of .* through all points",
        ),
    ],
)
def test_tables_that_are_no_path_are_told(table: str, said: str, tmp_path: Path) -> None:
    (tmp_path / "path.csv").write_text(table, encoding="utf-8")
    asked = wish({"wanted": {"path": "path.csv"}}, "spec")
    with pytest.raises((SpecError, FileError), match=said):
        asked.line(tmp_path)  # type: ignore[union-attr]


def test_faults_of_the_rest_of_the_spec_come_before_a_search() -> None:
    spec = {
        "mechanism": "linkage",
        "name": "Bad Name",
        "foo": 1,
        "parts": {"thickness": -2.0, "pin_diameter": "x"},
        "wanted": {"path": [[0, 0], [20, 12], [45, 20], [20, 4]], "bars": 8},
    }
    with pytest.raises(SpecError) as error:
        design(spec)
    assert [fault.key for fault in error.value.faults] == [
        "name",
        "parts.thickness",
        "parts.pin_diameter",
        "foo",
    ]


def test_texts_keep_their_comments() -> None:
    text = "# head\n[a]\nx = 1 # one\n\n[wanted]\ny = 2\n"
    assert edited(text, ["a.x=2", "b.c=3"]).startswith("# head\n[a]\nx = 2 # one\n")
    changed = with_tables(text, {"a": {"z": 1}, "rows": [{"n": 1}]}, ["wanted"])
    assert (
        tomllib.loads(changed) == {"a": {"x": 1, "z": 1}, "rows": [{"n": 1}]} and "# one" in changed
    )


def test_words_are_chosen_among() -> None:
    """Of the named laws the one whose peak acceleration, C_a of the VDI 2143, is least: parabolic 4, modified trapezoid 4.89."""
    laws = {"cycloidal": 2 * math.pi, "modified-trapezoid": 4.888, "3-4-5": 5.7735}
    wanted = {
        "vary": {"segment.0.law": list(laws), "geometry.base_radius": [30, 50]},
        "least": "peak_acceleration_mm_s2",
    }
    data = {**tomllib.loads(CAM), "wanted": wanted}
    found = tomllib.loads(design(data))
    assert found["segment"][0]["law"] == {"name": min(laws, key=laws.__getitem__)} or found[
        "segment"
    ][0]["law"] == min(laws, key=laws.__getitem__)
    data["wanted"] = {**wanted, "vary": {"segment.0.law": ["cycloidal", "cycloid"]}}
    with pytest.raises(SpecError, match='wanted.vary."segment.0.law".*cycloid.*expected one of'):
        design(data)
    data["wanted"] = {**wanted, "vary": {"segment.0.law": ["cycloidal", "cycloidal"]}}
    with pytest.raises(SpecError, match="each word once"):
        design(data)
