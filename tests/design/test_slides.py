"""Slider-cranks for pairs of crank angle and place: closed form, least squares, the written machine, faults in words."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgen.design.fourbars import Room
from camgen.design.run import design
from camgen.design.sliders import SliderCranks, slider_cranks
from camgen.errors import DesignError, SpecError
from camgen.machines.linkage.mechanism import Linkage
from camgen.spec import validate

FOLDER = Path(__file__).resolve().parents[1] / "reference"
REFERENCE: dict[str, Any] = tomllib.loads((FOLDER / "points.toml").read_text())["slide"]
SIZES = {"thickness": 3, "pin_diameter": 3, "wall": 1.6}
TABLES: dict[str, Any] = {"mechanism": "linkage", "name": "ram", "parts": SIZES}


def room(longest: float) -> Room:
    return Room(0j, 0j, 5.0, longest, math.radians(45), None)


def one(*numbers: float, turned: Any = (0.0, 1.0)) -> SliderCranks:
    return SliderCranks(*(np.array([each]) for each in numbers), np.array(turned))


def test_three_pairs_give_the_lengths_of_another_program() -> None:
    crank, places = np.array(REFERENCE["pairs"], float).T
    # with this bound the grid of first angles and places has 30 deg and 100 mm
    bars = slider_cranks(np.radians(crank - 30), places - 100, room(100.0), 1.0)
    first = np.flatnonzero(
        (np.abs(bars.first - math.radians(30)) < 1e-9)
        & (np.abs(bars.slider(np.zeros(1))[0] - 100) < 1e-6)
    )
    lengths = [[each[k] for each in (bars.crank, bars.offset, bars.rod)] for k in first]
    wanted = [REFERENCE[key] for key in ("crank", "offset", "rod")]
    np.testing.assert_allclose(lengths, [wanted], atol=1e-6)


def test_a_hidden_slider_crank_is_found_again() -> None:
    hidden = one(0.4, 22, 70, 8, 1, turned=np.radians([0, 40, 100, 150, 200, 260]))
    bars = slider_cranks(hidden.turned, hidden.way[:, 0], room(120.0), 1.0)
    off = np.max(np.abs(bars.way - hidden.way), axis=0)
    best = int(np.argmin(off))
    assert off[best] < 1e-7
    found = [bars.crank[best], bars.rod[best], bars.offset[best]]
    np.testing.assert_allclose(found, [22, 70, 8], atol=1e-4)


@given(
    st.floats(0, math.tau),
    st.floats(5, 30),
    st.floats(31, 99),
    st.floats(-30, 30),
    st.floats(0.1, 6),
)
def test_the_transmission_angle_is_the_least_on_the_way(
    first: float, crank: float, rod: float, offset: float, turn: float
) -> None:
    bars = one(first, crank, rod, offset, 1, turned=(0.0, turn))
    for all_round in (False, True):
        way = np.linspace(*bars.ends(all_round), 4001)
        share = np.max(np.abs(bars.pin(way).imag - offset)) / rod
        actual = float(bars.transmission(all_round)[0])
        if share < 0.999:
            assert math.cos(actual) == pytest.approx(share, abs=1e-5)
            gap = np.abs(bars.pin(way) - (bars.slider(way) + 1j * offset))
            np.testing.assert_allclose(gap, rod, rtol=1e-9)
        elif share > 1.001:
            assert actual == -1


@pytest.fixture(scope="module")
def found() -> dict[str, Any]:
    pairs = [[30, 100], [60, 90], [90, 75], [120, 60], [150, 48], [180, 45]]
    return tomllib.loads(design({**TABLES, "wanted": {"slide": pairs, "tolerance": 1}}))


def test_the_written_slider_keeps_the_pairs(found: dict[str, Any]) -> None:
    (slide,) = found["output"]
    assert slide["function"]["tolerance"] == 1
    codes = {each.code: each for each in validate(Linkage, found).limits()}
    assert codes["FUNCTION_ERROR"].ok and codes["FUNCTION_ERROR"].measured < 1
    at = [list(pair) for pair in slide["function"]["at"]]
    at[3][1] -= 2
    damaged = {**found, "output": [{**slide, "function": {**slide["function"], "at": at}}]}
    codes = {each.code: each for each in validate(Linkage, damaged).limits()}
    assert not codes["FUNCTION_ERROR"].ok


def test_what_stops_all_slider_cranks_is_counted() -> None:
    wish = {"slide": [[0, 0], [10, 60], [20, 0]], "transmission_deg": 60, "longest": 50}
    with pytest.raises(
        DesignError, match="slider-cranks? for 3 pairs is free of defects: "
    ) as told:
        design({**TABLES, "wanted": wish})
    assert "wanted.longest" in str(told.value)


def test_crank_angles_of_a_slide_differ() -> None:
    with pytest.raises(SpecError, match="different crank angles within one turn"):
        design({**TABLES, "wanted": {"slide": [[0, 0], [0, 60], [20, 0]]}})
