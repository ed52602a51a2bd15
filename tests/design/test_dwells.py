"""Six-bars that rest: a machine of another program, the search, the written machine by the kernel's motion."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from camgen.design.dwells import SixBars
from camgen.design.run import Front, design
from camgen.errors import DesignError, SpecError
from camgen.machines.linkage.mechanism import Linkage
from camgen.spec import validate

FOLDER = Path(__file__).resolve().parents[1] / "reference"
REFERENCE: dict[str, Any] = tomllib.loads((FOLDER / "points.toml").read_text())["dwell"]
SIZES = {"thickness": 3, "pin_diameter": 3, "wall": 1.6}
TABLES: dict[str, Any] = {"mechanism": "linkage", "name": "rests", "parts": SIZES}


def test_a_dwell_of_another_program_rests_as_it_says() -> None:
    r = REFERENCE
    lengths = [math.log(r[key]) for key in ("crank", "coupler", "rocker")]
    last = [math.log(r["arm"]), math.log(r["radius"])]
    x = [*lengths, *r["point"], math.radians(r["first_deg"]), *r["pivot"], *last]
    bars = SixBars(np.array([x]), np.array([[-1.0], [1.0]]))
    span = math.radians(r["span_deg"])
    _, _, p, d = bars.at(np.linspace(0, span, 721))
    assert np.max(np.abs(np.abs(p - complex(*r["centre"])) - r["radius"])) < 1e-4
    assert math.degrees(np.ptp(bars.angle(d))) == pytest.approx(r["rest_deg"], abs=2e-4)
    assert math.degrees(bars.swing()[0]) == pytest.approx(r["swing_deg"], abs=0.01)
    assert bars.rest(span)[0] > np.ptp(bars.angle(d))  # over a little more than the span


@pytest.fixture(scope="module")
def found() -> tuple[dict[str, Any], Front]:
    wish = {"dwell": {"span_deg": 80, "swing_deg": 40}, "tolerance": 0.4}
    fronts: list[Front] = []
    text = design({**TABLES, "wanted": wish}, keep=fronts.append)
    return tomllib.loads(text), fronts[0]


@pytest.mark.long
def test_the_written_output_rests_and_swings(found: tuple[dict[str, Any], Front]) -> None:
    data, front = found
    (output,) = data["output"]
    assert output["dwell"] == {"span_deg": 80, "band": 0.4} and output["stroke"]["value"] == 40
    findings = {each.code: each for each in validate(Linkage, data).limits()}
    assert findings["DWELL"].ok and findings["STROKE_ERROR"].ok
    assert front.rows[0]["verdict"] == "holds" and front.rows[0]["rest_deg"] < 0.4
    # what it is said to rest within is what the kernel finds, and a band of half of that is too narrow
    for share, holds in ((1.01, True), (0.5, False)):
        band = {"span_deg": 80, "band": share * front.rows[0]["rest_deg"]}
        changed = {**data, "output": [{**output, "dwell": band}]}
        (dwell,) = (each for each in validate(Linkage, changed).limits() if each.code == "DWELL")
        assert dwell.ok == holds


@pytest.mark.long
def test_what_no_six_bar_does_is_told() -> None:
    wish = {"dwell": {"span_deg": 240, "swing_deg": 150}, "longest": 50}
    with pytest.raises(DesignError, match="none of .* six-bars for a dwell of 240 deg") as told:
        design({**TABLES, "wanted": wish})
    assert "out of bounds; a greater wanted.longest" in str(told.value)


def test_faults_of_a_dwell_are_told_at_once() -> None:
    wish = {"dwell": {"span_deg": 5}, "turns": False}
    with pytest.raises(SpecError) as told:
        design({**TABLES, "wanted": wish})
    assert [fault.key for fault in told.value.faults] == [
        "wanted.dwell.span_deg",
        "wanted.dwell.swing_deg",
    ]
    with pytest.raises(SpecError, match=r"wanted.turns: false"):
        design({**TABLES, "wanted": {"dwell": {"span_deg": 90, "swing_deg": 40}, "turns": False}})
