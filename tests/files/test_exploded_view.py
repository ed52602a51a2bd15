"""Parts drawn apart: against lines of sight through their prisms, and against areas and lengths by hand."""

from __future__ import annotations

import math
import tomllib
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
import shapely
from balloons_read import balloons_on

from camgen.files.arrangement import Arrangement
from camgen.files.exploded_sheet import exploded_sheet
from camgen.files.exploded_view import Body, Prism, apart, axes, isometric
from camgen.files.sheet import Stroke, Text
from camgen.files.title_block import Facts
from camgen.machines.sources import read_mechanism
from camgen.pipeline.arrangement import arrangement_of
from camgen.pipeline.making import parts_table
from camgen.starters import in_metal

SPECS = Path(__file__).resolve().parents[2] / "specs"
COS = math.sqrt(3) / 2
MACHINES = ("two-leg-walker", "gallery/flapping-bird", "metal geneva-table", "metal disc-cam")


def machine(name: str) -> Arrangement:
    """A shipped machine, or a starter in metal."""
    starter = name.removeprefix("metal ")
    spec = SPECS / f"{name}.toml" if starter == name else tomllib.loads(in_metal(starter))
    mechanism = read_mechanism(spec)
    return arrangement_of(mechanism, parts_table(mechanism))


def bodies_of(arrangement: Arrangement) -> list[Body]:
    return [Body(copy.number, copy.prisms) for copy in arrangement.copies if copy.prisms]


def first_met(bodies: list[Body], lifts: list[float], paper: complex) -> int | None:
    """The number of the body that the line of sight through a place on paper meets first, in steps of 0.05 mm from above."""
    prisms: list[tuple[int, Prism]] = [
        (body.number, (shape, low + by, high + by))
        for body, by in zip(bodies, lifts, strict=True)
        for shape, low, high in body.prisms
    ]
    heights = np.arange(
        max(high for _, (*_, high) in prisms), min(low for _, (_, low, _) in prisms), -0.05
    )
    total = paper.real / COS  # x + y
    apart_by = 2 * (paper.imag - heights)  # y - x
    x, y = (total - apart_by) / 2, (total + apart_by) / 2
    best = -math.inf
    met = None
    for number, (shape, low, high) in prisms:
        held = (heights > low) & (heights < high) & shapely.contains_xy(shape, x, y)
        if held.any() and heights[held].max() > best:
            best, met = heights[held].max(), number
    return met


def test_a_cube_shows_three_faces_and_nine_edges() -> None:
    """Of 10: each face is 10 cos 30 deg x 10 on paper, and of its 12 edges, all 10 long there, three meet behind it."""
    (seen,), lines = isometric([Body(1, [(shapely.box(0, 0, 10, 10), 0.0, 10.0)])], [0.0])
    assert seen.face.area == pytest.approx(3 * 100 * COS)
    assert seen.edges.length == pytest.approx(90.0, abs=0.01)
    assert not lines


def test_flush_prisms_have_no_edge_between_them() -> None:
    """Two slabs of 5 that make a cube of 10: its nine edges and no more; on a broader one the upper has its foot's two front edges."""
    square = shapely.box(0, 0, 10, 10)
    seen, _ = isometric([Body(1, [(square, 0.0, 5.0), (square, 5.0, 10.0)])], [0.0])
    edges = shapely.union_all([each.edges for each in seen])
    assert edges.length == pytest.approx(90.0, abs=0.3)
    broad = shapely.box(-20, -20, 30, 30)
    seen, _ = isometric([Body(1, [(broad, 0.0, 5.0), (square, 5.0, 10.0)])], [0.0])
    edges = shapely.union_all([each.edges for each in seen])
    # the broad one's top loses what is behind the cube, none of its edges; the upper: 4 at its top, 3 upright, 2 at its foot
    assert edges.length == pytest.approx(4 * 50 + 2 * 50 + 3 * 5 + 4 * 10 + 3 * 5 + 2 * 10, abs=0.3)


@pytest.mark.parametrize("name", MACHINES)
def test_what_is_seen_is_what_a_line_of_sight_meets_first(name: str) -> None:
    """Random places on paper, off the edges."""
    bodies = bodies_of(machine(name))
    lifts = apart(bodies, 12.0)
    seen, _ = isometric(bodies, lifts)
    edges = shapely.union_all([each.face.boundary for each in seen])
    x0, y0, x1, y1 = edges.bounds
    looked = 0
    for x, y in np.random.default_rng(8).uniform((x0, y0), (x1, y1), (400, 2)):
        point = shapely.Point(x, y)
        if edges.distance(point) < 0.15:
            continue
        met = first_met(bodies, lifts, complex(x, y))
        held = {each.number for each in seen if each.face.contains(point)}
        assert held == ({met} if met else set()), (x, y)
        looked += met is not None
    assert looked > 60


@pytest.mark.parametrize("name", MACHINES)
def test_parts_that_cover_each_other_stand_apart(name: str) -> None:
    """Of any two whose outlines, holes filled, lie over each other, one is wholly over the other by the gap."""
    bodies = bodies_of(machine(name))
    ends = [
        (body.low + by, body.high + by)
        for body, by in zip(bodies, apart(bodies, 12.0), strict=True)
    ]
    for a, b in combinations(range(len(bodies)), 2):
        if bodies[a].plan.intersection(bodies[b].plan).area > 0.01:
            upper, lower = max(ends[a], ends[b]), min(ends[a], ends[b])
            assert upper[0] - lower[1] > 12.0 - 1e-6, (bodies[a].number, bodies[b].number)


def test_a_screw_from_below_goes_down_and_a_bush_goes_over_its_plate() -> None:
    """A plate of 5 with a hole, a bush in it, a link over it, a screw of 3 with its head of 6 under the plate, by hand: gaps of 10."""
    disc = shapely.Point(0, 0)
    hole = disc.buffer(4)
    bodies = [
        Body(1, [(shapely.box(-20, -20, 20, 20).difference(hole), 0.0, 5.0)]),
        Body(2, [(hole.difference(disc.buffer(2)), 0.0, 5.0)]),
        Body(3, [(shapely.box(-5, -5, 30, 5).difference(disc.buffer(2)), 5.0, 8.0)]),
        Body(4, [(disc.buffer(1.5), 0.0, 8.0), (disc.buffer(3), -2.0, 0.0)]),
    ]
    assert apart(bodies, 10.0) == pytest.approx([0.0, 15.0, 25.0, -18.0])
    assert [(z, low, high) for z, low, high in axes(bodies, [0.0, 15.0, 25.0, -18.0])] == [
        (pytest.approx(0j, abs=1e-9), -10.0, 0.0),
        (pytest.approx(0j, abs=1e-9), 5.0, 15.0),
        (pytest.approx(0j, abs=1e-9), 20.0, 30.0),
    ]


@pytest.mark.parametrize("name", MACHINES)
def test_the_sheet_names_nearly_all_that_is_drawn(name: str) -> None:
    """By the numbers of the list, whose rows stand beside the picture; nothing is drawn outside of the frame."""
    arrangement = machine(name)
    sheet = exploded_sheet(arrangement, name, Facts())
    numbers = {body.number for body in bodies_of(arrangement)}
    named = {number: dot for number, _, dot in balloons_on(sheet)}
    assert named.keys() <= numbers and len(named) >= len(numbers) - 1
    texts = [each.text for each in sheet.things if isinstance(each, Text)]
    assert "A3, 2 of 2" in texts
    assert all(texts.count(str(number)) >= 2 for number in named)
    for each in sheet.primitives:
        for piece in each.pieces if isinstance(each, Stroke) else ():
            z = complex(piece.at(piece.t0)[()])
            assert 20 - 1e-6 <= z.real <= 410 + 1e-6 and 10 - 1e-6 <= z.imag <= 287 + 1e-6
