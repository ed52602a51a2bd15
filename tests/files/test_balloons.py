"""Balloons of a view: short lines that cross neither each other nor another number."""

from __future__ import annotations

from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
import shapely
from balloons_read import balloons_on

from camgen.files.arrangement_sheet import _Page
from camgen.files.balloons import balloons
from camgen.files.sheet import Sheet
from camgen.files.title_block import Facts
from camgen.machines.sources import read_mechanism
from camgen.pipeline.arrangement import arrangement_of
from camgen.pipeline.making import parts_table

SPECS = Path(__file__).resolve().parents[2] / "specs"
AREA = (0j, 300 + 300j)


def leaders(sheet: Sheet) -> dict[int, tuple[complex, complex]]:
    """Of each number the middle of its balloon and its dot."""
    return {number: (middle, dot) for number, middle, dot in balloons_on(sheet)}


def segment(ends: tuple[complex, complex]) -> shapely.LineString:
    return shapely.LineString([(z.real, z.imag) for z in ends])


def crossings(found: dict[int, tuple[complex, complex]]) -> int:
    """How many pairs of lines cross."""
    lines = [segment(ends) for ends in found.values()]
    return sum(a.intersects(b) for a, b in combinations(lines, 2))


def test_a_balloon_stands_beside_its_part_and_its_dot_lies_two_inside() -> None:
    """A plate of 40 x 40: rows of sites begin 7 beside it, so that a line from middle to dot is 9 long; by hand."""
    sheet = Sheet(300, 300, "plate")
    plate = shapely.box(100, 100, 140, 140)
    balloons(sheet, {7: plate}, plate, AREA)
    ((middle, dot),) = leaders(sheet).values()
    assert abs(dot - middle) == pytest.approx(9.0, abs=0.01)
    assert plate.contains(shapely.Point(dot.real, dot.imag))


def test_lines_of_many_parts_cross_nowhere() -> None:
    """40 discs by chance in a square, nearly as many as one row round it can name: no crossing, no line through another number."""
    rng = np.random.default_rng(5)
    places = rng.uniform(100, 200, (40, 2))
    parts = {k: shapely.Point(*place).buffer(1.0) for k, place in enumerate(places, 1)}
    sheet = Sheet(300, 300, "discs")
    balloons(sheet, parts, shapely.box(100, 100, 200, 200), AREA)
    found = leaders(sheet)
    assert len(found) == 40 and crossings(found) == 0
    for k, ends in found.items():
        others = (shapely.Point(z.real, z.imag) for n, (z, _) in found.items() if n != k)
        assert min(segment(ends).distance(other) for other in others) >= 4.0


def test_no_balloon_stands_on_what_is_drawn() -> None:
    """A word on one side of a small part, an edge on another, the paper's end below: it stands above."""
    sheet = Sheet(300, 300, "part")
    part = shapely.box(100, 100, 108, 108)
    sheet.text(72 + 100j, "a long word", 5.0)
    for x in (112.0, 116.0, 120.0, 124.0, 128.0, 132.0):
        sheet.line(x + 60j, x + 140j, layer="VIEW")
    balloons(sheet, {1: part}, part, (98j, 300 + 300j))
    ((middle, _),) = leaders(sheet).values()
    assert middle.imag > 108 + 4


def test_parts_without_a_site_have_no_balloon() -> None:
    """Of two parts on paper with room for one balloon, over the left one, this has it; on paper without any none has."""
    parts = {1: shapely.box(100, 100, 108, 108), 2: shapely.box(200, 100, 208, 108)}
    view = shapely.box(100, 100, 208, 108)
    sheet = Sheet(300, 300, "parts")
    balloons(sheet, parts, view, (95 + 109j, 108 + 121j))
    assert list(leaders(sheet)) == [1]
    sheet = Sheet(300, 300, "parts")
    balloons(sheet, parts, view, (100 + 100j, 101 + 101j))
    assert not leaders(sheet)


@pytest.mark.parametrize(
    "name",
    ["two-leg-walker", "four-leg-walker", "stitch-head", "gallery/walker", "gallery/heart"],
)
def test_leaders_of_machines_cross_nowhere_and_are_short(name: str) -> None:
    """Their lines crossed 40 times, and were 57 mm of paper long, when balloons stood in rows over and under a view."""
    mechanism = read_mechanism(SPECS / f"{name}.toml")
    sheet = _Page(arrangement_of(mechanism, parts_table(mechanism))).draw(name, Facts())
    found = leaders(sheet)
    assert len(found) >= 25 and crossings(found) == 0
    assert np.mean([abs(dot - middle) for middle, dot in found.values()]) < 25
