"""Parts drawn apart: against lines of sight through their prisms, and against areas and lengths by hand."""

from __future__ import annotations

import itertools
import math
import tomllib
from collections import Counter
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
import shapely
from balloons_read import balloons_on
from shapely.affinity import translate

from camgen.files.arrangement import Arrangement, Copy
from camgen.files.assembly_list import Item
from camgen.files.exploded_sheet import _towers, exploded_sheet
from camgen.files.exploded_view import Body, Coming, Prism, apart, axes, isometric
from camgen.files.sheet import Stroke, Text
from camgen.files.title_block import Facts
from camgen.geometry.mesh import Mesh
from camgen.machines.sources import read_mechanism
from camgen.pipeline.arrangement import arrangement_of
from camgen.pipeline.comings import after_what_is_nearer
from camgen.pipeline.making import parts_table
from camgen.starters import in_metal

SPECS = Path(__file__).resolve().parents[2] / "specs"
COS = math.sqrt(3) / 2
MACHINES = (
    "two-leg-walker",
    "gallery/flapping-bird",
    "metal geneva-table",
    "metal disc-cam",
    "metal cylinder-cam",
)
ON_PAPER = np.array([[COS, COS, 0.0], [-0.5, 0.5, 1.0], [1.0, -1.0, 1.0]])  # and towards the eye
STILL = np.zeros(3)
UP = (0.0, 0.0, 1.0)


def machine(name: str) -> Arrangement:
    """A shipped machine, or a starter in metal."""
    starter = name.removeprefix("metal ")
    spec = SPECS / f"{name}.toml" if starter == name else tomllib.loads(in_metal(starter))
    mechanism = read_mechanism(spec)
    return arrangement_of(mechanism, parts_table(mechanism))


def bodies_of(arrangement: Arrangement) -> list[Body]:
    (bodies,) = _towers(arrangement).values()
    return bodies


def met_by(solid: Mesh, by: np.ndarray, paper: complex) -> float:
    """Height at which the line of sight meets a solid first, mm: of the facets there the one nearest to the eye."""
    corners = ((solid.vertices + by) @ ON_PAPER.T)[solid.faces]
    flat = corners[:, :, :2] - [paper.real, paper.imag]
    a, b, c = flat[:, 0], flat[:, 1], flat[:, 2]
    weights = np.stack([p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0] for p, q in ((b, c), (c, a), (a, b))])
    held = (weights > 0).all(axis=0) | (weights < 0).all(axis=0)
    share = weights[:, held] / weights[:, held].sum(axis=0)
    depths = np.sum(share.T * corners[held, :, 2], axis=1)  # x - y + z, where y - x = 2 (up - z)
    return float((depths.max() + 2 * paper.imag) / 3) if len(depths) else -math.inf


def first_met(bodies: list[Body], moves: list[np.ndarray], paper: complex) -> int | None:
    """The number of the body that the line of sight through a place on paper meets first, in steps of 0.05 mm from above."""
    prisms: list[tuple[int, Prism]] = [
        (body.number, (translate(shape, by[0], by[1]), low + by[2], high + by[2]))
        for body, by in zip(bodies, moves, strict=True)
        if body.solid is None
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
    for body, by in zip(bodies, moves, strict=True):
        if body.solid is not None and (height := met_by(body.solid, by, paper)) > best:
            best, met = height, body.number
    return met


def test_a_cube_shows_three_faces_and_nine_edges() -> None:
    """Of 10: each face is 10 cos 30 deg x 10 on paper, and of its 12 edges, all 10 long there, three meet behind it."""
    (seen,), lines = isometric([Body(1, [(shapely.box(0, 0, 10, 10), 0.0, 10.0)])], [STILL])
    assert seen.face.area == pytest.approx(3 * 100 * COS)
    assert seen.edges.length == pytest.approx(90.0, abs=0.01)
    assert not lines


def test_flush_prisms_have_no_edge_between_them() -> None:
    """Two slabs of 5 that make a cube of 10: its nine edges and no more; on a broader one the upper has its foot's two front edges."""
    square = shapely.box(0, 0, 10, 10)
    seen, _ = isometric([Body(1, [(square, 0.0, 5.0), (square, 5.0, 10.0)])], [STILL])
    edges = shapely.union_all([each.edges for each in seen])
    assert edges.length == pytest.approx(90.0, abs=0.3)
    broad = shapely.box(-20, -20, 30, 30)
    seen, _ = isometric([Body(1, [(broad, 0.0, 5.0), (square, 5.0, 10.0)])], [STILL])
    edges = shapely.union_all([each.edges for each in seen])
    # the broad one's top loses what is behind the cube, none of its edges; the upper: 4 at its top, 3 upright, 2 at its foot
    assert edges.length == pytest.approx(4 * 50 + 2 * 50 + 3 * 5 + 4 * 10 + 3 * 5 + 2 * 10, abs=0.3)


@pytest.mark.parametrize("name", MACHINES)
def test_what_is_seen_is_what_a_line_of_sight_meets_first(name: str) -> None:
    """Random places on paper, off the edges."""
    bodies = bodies_of(machine(name))
    moves = apart(bodies, 12.0)
    seen, _ = isometric(bodies, moves)
    edges = shapely.union_all([each.face.boundary for each in seen])
    x0, y0, x1, y1 = edges.bounds
    looked = 0
    for x, y in np.random.default_rng(8).uniform((x0, y0), (x1, y1), (400, 2)):
        point = shapely.Point(x, y)
        if edges.distance(point) < 0.15:
            continue
        met = first_met(bodies, moves, complex(x, y))
        held = {each.number for each in seen if each.face.contains(point)}
        assert held == ({met} if met else set()), (x, y)
        looked += met is not None
    assert looked > 60


@pytest.mark.parametrize("name", MACHINES)
def test_parts_that_cover_each_other_stand_apart(name: str) -> None:
    """Of any two that come from above or below and whose outlines, holes filled, lie over each other, one is wholly over the other by
    the gap."""
    bodies = [body for body in bodies_of(machine(name)) if not body.coming.aside]
    ends = [
        (body.low + by[2], body.high + by[2])
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
        Body(4, [(disc.buffer(1.5), 0.0, 8.0), (disc.buffer(3), -2.0, 0.0)], Coming(1.0, UP)),
    ]
    moves = apart(bodies, 10.0)
    assert np.array(moves) == pytest.approx(np.outer([0.0, 15.0, 25.0, -18.0], UP))
    lines = [np.concatenate(ends) for ends in axes(bodies, moves)]
    assert np.array(lines) == pytest.approx(
        np.array([[0, 0, a, 0, 0, b] for a, b in ((-10.0, 0.0), (5.0, 15.0), (20.0, 30.0))]),
        abs=1e-9,
    )


def test_parts_go_back_the_way_they_come_step_by_step() -> None:
    """A rod of 4 x 30 that stands, a plate of 5 that is lowered over it, a foot of 2 that is pushed along y against the plate's edge and
    reaches 1 under it, by hand: the plate over the rod by the gap of 10, the foot as high as the plate and 10 before it."""
    rod = shapely.Point(0, 0).buffer(2)
    plate = shapely.box(-20, -20, 20, 20)
    bodies = [
        Body(1, [(plate.difference(rod.buffer(0.1)), 20.0, 25.0)], Coming(1.0)),
        Body(2, [(rod, 0.0, 30.0)]),
        Body(3, [(shapely.box(-20, -22, 20, -19), 10.0, 30.0)], Coming(2.0, (0.0, 1.0, 0.0))),
    ]
    moves = apart(bodies, 10.0)
    assert np.array(moves) == pytest.approx(np.array([[0, 0, 20], [0, 0, 0], [0, -11, 20]]))


def test_what_stands_on_nothing_rises_to_what_comes_over_it() -> None:
    """Two slabs of 10 on each other, beside them a rod of 20, and a plate over both, with gaps of 5, by hand: the upper slab ends at
    25, the plate begins at 30, the rod ends 5 under that."""
    left, right = shapely.box(0, 0, 5, 5), shapely.box(10, 0, 15, 5)
    bodies = [
        Body(1, [(left, 0.0, 10.0)]),
        Body(2, [(left, 10.0, 20.0)], Coming(1.0)),
        Body(3, [(right, 0.0, 20.0)], Coming(2.0)),
        Body(4, [(shapely.box(0, 0, 15, 5), 20.0, 22.0)], Coming(3.0)),
    ]
    assert [by[2] for by in apart(bodies, 5.0)] == pytest.approx([0.0, 5.0, 5.0, 10.0])


def test_a_solid_is_drawn_as_its_prism_is() -> None:
    """The cube of 10 again, from its facets. A hole of 4 x 4 through it along y adds its rim, 16, and the edge between its floor and its
    left wall as far as the rim does not hide it: at a depth d a line of sight leaves d farther to the right, so up to 4."""
    from manifold3d import Manifold

    cube = Manifold.cube((10, 10, 10))
    bored = cube - Manifold.cube((4, 12, 4)).translate((3, -1, 3))
    for body, length in ((cube, 90.0), (bored, 110.0)):
        made = body.to_mesh64()
        solid = Mesh(np.array(made.vert_properties)[:, :3], np.array(made.tri_verts, int))
        plan = [(shapely.box(0, 0, 10, 10), 0.0, 10.0)]
        (seen,), _ = isometric([Body(1, plan, solid=solid)], [STILL])
        assert seen.face.area == pytest.approx(3 * 100 * COS)
        assert seen.edges.length == pytest.approx(length, abs=0.02)


def test_a_roller_that_lies_is_round() -> None:
    """Of 16 x 10, square to the drum's axis: it covers what an ellipse and its side do, each seen at cos = 1/sqrt(3) to the eye, where
    paper is sqrt(3/2) times as large as what is square to that: 1.5 (64 pi / sqrt(3) + 160 sqrt(2/3)) mm^2."""
    from camgen.pipeline.arrangement import _rods

    lying = [(shapely.Polygon([(30, -8), (40, -8), (40, 8), (30, 8)]), 12.0, 28.0)]
    (seen,), _ = isometric([Body(1, lying, solid=_rods(lying))], [STILL])
    area = 1.5 * (64 * math.pi / math.sqrt(3) + 160 * math.sqrt(2 / 3))
    assert seen.face.area == pytest.approx(area, rel=0.01)


def test_a_key_has_round_ends_and_a_screw_from_behind_its_head() -> None:
    """Of a linkage of metal: keys 3 x 3 x 6 of form A, 1.8 deep in the shaft and 1.4 in the hub, (3 x 3 + 1.5^2 pi) (1.8 + 1.4) mm^3 [DIN
    6885]; M5 in the plate from 0 to 10 and through a board of 10, its head of 5 under that [ISO 4762]."""
    arrangement = machine("metal linkage")
    numbers = {item.what: item.number for item in arrangement.items}
    solids = {
        what: [
            copy.solid for copy in arrangement.copies if copy.number == numbers[what] and copy.solid
        ]
        for what in ("parallel key", "screw of the plate, from behind")
    }
    keys = solids["parallel key"]
    assert len(keys) == 2
    for key in keys:
        assert key.volume == pytest.approx((9 + 2.25 * math.pi) * 3.2, rel=0.01)
        assert np.ptp(key.vertices[:, 2]) == pytest.approx(6.0)
    for screw in solids["screw of the plate, from behind"]:
        ends = screw.vertices[:, 2]
        assert (ends.min(), ends.max()) == pytest.approx((-15.0, 10.0))


def test_washer_and_nut_of_a_lying_cam_follower_come_after_it() -> None:
    """M6 on a stud of 6: a washer of 12 x 1.6 is 1.6 pi (36 - 9) mm^3 [ISO 7089]. From the drum outwards the follower, the washer and
    the nut, each clear of the one before, all on the axis of the stud."""
    arrangement = machine("metal cylinder-cam")
    numbers = {item.what: item.number for item in arrangement.items}
    bodies = bodies_of(arrangement)
    moves = apart(bodies, 4.0)
    names = ("Drum of a cylinder cam", "cam follower", "washer of the cam follower")
    names += ("nut of the cam follower",)
    found = [
        next((body, by) for body, by in zip(bodies, moves, strict=True) if body.number == number)
        for number in (numbers[name] for name in names)
    ]
    ends = [(body.plan.bounds[0] + by[0], body.plan.bounds[2] + by[0]) for body, by in found]
    assert all(inner[1] + 3.9 < outer[0] for inner, outer in itertools.pairwise(ends))
    washer = found[2][0].solid
    assert washer is not None
    assert washer.volume == pytest.approx(1.6 * math.pi * (36 - 9), rel=0.01)
    levels = {
        round(float(np.mean(body.solid.vertices[:, 2].reshape(-1))) + by[2], 1)
        for body, by in found[1:]
        if body.solid is not None
    }
    assert len(levels) == 1


def test_what_is_half_hidden_is_taken_farther_too() -> None:
    """The set screw of a disc cam's hub stands clear of the cam follower: its outline is whole on the sheet."""
    arrangement = machine("metal disc-cam")
    number = next(item.number for item in arrangement.items if item.what == "set screw of the hub")
    bodies = bodies_of(arrangement)
    across = abs(arrangement.box[1] - arrangement.box[0])

    def share(far: tuple[int, ...]) -> float:
        seen, _ = isometric(bodies, apart(bodies, 0.05 * across, far))
        (own,) = [each for each in seen if each.number == number]
        return float(own.face.area / own.whole.area)

    assert share(()) < 0.5
    assert share((number,)) == pytest.approx(1.0)
    sheet = exploded_sheet(arrangement, "cam", Facts())
    (dot,) = [dot for each, _, dot in balloons_on(sheet) if each == number]
    (other,) = [
        dot
        for each, _, dot in balloons_on(sheet)
        if arrangement.items[each - 1].what == "cam follower"
    ]
    assert (dot - other).real > 12.0, "to the right of the follower, whose lower end it was behind"


def heights_of(name: str) -> dict[str, list[tuple[float, float]]]:
    """From where to where copies reach that are drawn apart, from the lowest up, by what the list calls them."""
    arrangement = machine(name)
    bodies = bodies_of(arrangement)
    names = {item.number: item.what for item in arrangement.items}
    ends: dict[str, list[tuple[float, float]]] = {}
    for body, by in zip(bodies, apart(bodies, 12.0), strict=True):
        ends.setdefault(names[body.number], []).append((body.low + by[2], body.high + by[2]))
    return {name: sorted(own) for name, own in ends.items()}


def test_the_order_apart_is_that_of_the_steps() -> None:
    """Of a linkage of metal, by its steps: the shaft stands in the hand crank, its key between them; the plate is put on that shaft, the
    crank's key pressed into it before the crank comes; a link with its bearing is put on a sleeve; screws come from behind."""
    at = heights_of("metal linkage")
    order = [
        "Pin of the knob",
        "Knob",
        "Hand crank",
        "Shaft",
        "Shaft collar",
        "Ground plate",
        "Crank",
    ]
    for below, above in itertools.pairwise(order):
        assert at[below][0][1] < at[above][0][0], (below, above)
    keys = at["parallel key"]
    assert at["Hand crank"][0][1] < keys[0][0] and keys[0][1] < at["Shaft"][0][0]
    assert at["Shaft"][0][1] < keys[1][0] and keys[1][1] < at["Crank"][0][0]
    assert (
        at["Sleeve 1"][0][1] < at["Rocker"][0][0] and at["Rocker"][0][1] < at["Ball bearing"][0][0]
    )
    assert at["screw of the plate, from behind"][1][1] < at["Ground plate"][0][0]


def test_a_side_that_is_built_by_itself_stands_beside_the_other() -> None:
    """Of a walker: as many copies of its links on either side, the shaft of both on the first; each hangs under its own plate, which
    comes first. What is built by itself in the midst of a machine, as a drum with its ring, is drawn in that."""
    near, far = _towers(machine("gallery/walker")).values()
    names = {item.number: item.what for item in machine("gallery/walker").items}
    counts = [Counter(names[body.number] for body in side) for side in (near, far)]
    for link in ("Crank", "Leg1", "Conn4", "Second plate"):
        assert [count[link] for count in counts] == [1, 1]
    assert [count["Shaft of both sides"] for count in counts] == [1, 0]
    assert [count["screw of a spacer"] for count in counts] == [4, 4]
    for side, plate, above in (
        (near, "Ground plate", False),
        (far, "Ground plate, far side", True),
    ):
        ends = {
            names[b.number]: b.middle + by[2] for b, by in zip(side, apart(side, 9.0), strict=True)
        }
        assert (ends[plate] > ends["Leg3"] > ends["Second plate"]) == above
    assert [*_towers(machine("gallery/drum-feeder"))] == [""]


@pytest.mark.parametrize("name", MACHINES)
def test_the_sheet_names_all_that_is_drawn(name: str) -> None:
    """By the numbers of the list, whose rows stand beside the picture; nothing is drawn outside of the frame."""
    arrangement = machine(name)
    sheet = exploded_sheet(arrangement, name, Facts())
    numbers = {body.number for body in bodies_of(arrangement)}
    named = {number: dot for number, _, dot in balloons_on(sheet)}
    assert named.keys() == numbers
    texts = [each.text for each in sheet.things if isinstance(each, Text)]
    assert "A3, 2 of 2" in texts
    assert all(texts.count(str(number)) >= 2 for number in named)
    for each in sheet.primitives:
        for piece in each.pieces if isinstance(each, Stroke) else ():
            z = complex(piece.at(piece.t0)[()])
            assert 20 - 1e-6 <= z.real <= 410 + 1e-6 and 10 - 1e-6 <= z.imag <= 287 + 1e-6


def test_what_others_would_hide_is_taken_four_gaps_away() -> None:
    """A nut that comes from below, of a plate that it touches."""
    plate = Body(1, [(shapely.box(0, 0, 60, 60), 0.0, 5.0)])
    nut = Body(2, [(shapely.box(28, 28, 31, 31), -2.0, 0.0)], Coming(9.0, UP))
    for far, down in (((), 3.0), ((2,), 12.0)):
        assert [by[2] for by in apart([plate, nut], 3.0, far)] == [0.0, -down]


def test_a_ring_beyond_a_bearing_comes_after_it() -> None:
    """Two rings of one row on either side of a bearing of a later one, from above; beside it, or from below, neither waits."""
    ring, aside = shapely.Point(0, 0).buffer(10), shapely.Point(50, 0).buffer(10)
    down, up = Coming(1.0), Coming(1.0, UP)
    bearing = ([(ring, 5.0, 17.0)], Coming(3.0))
    for shape, low, coming, order in (
        (ring, 4.0, down, 1.0),
        (ring, 17.0, down, 3.25),
        (aside, 17.0, down, 1.0),
        (ring, 17.0, up, 1.0),
    ):
        found = after_what_is_nearer([([(shape, low, low + 1.0)], coming), bearing])
        assert [each.order for each in found] == [order, 3.0]


def test_what_is_hidden_is_said() -> None:
    """Two plates of 60 and, under them, a speck too small to point at: it has a row, no balloon, and a word; without it nothing is
    said."""
    plate, nut = shapely.box(0, 0, 60, 60), shapely.box(28, 28, 28.1, 28.1)
    copies = [
        Copy(k, [(plate, z + 5.0)], plate, True, prisms=[(plate, z, z + 5.0)])
        for k, z in ((1, 0.0), (2, 10.0))
    ]
    under = Copy(3, [(nut, 0.0)], nut, True, prisms=[(nut, -0.2, 0.0)], coming=Coming(9.0, UP))
    items = [Item(k, 1, "thing", "") for k in (1, 2, 3)]
    for made, said in ((copies, False), ([*copies, under], True)):
        sheet = exploded_sheet(Arrangement(made, items, (0j, 1), [], []), "two", Facts())
        texts = [each.text for each in sheet.things if isinstance(each, Text)]
        assert any(text.endswith("Hidden by others, or too small: 3.") for text in texts) == said
        assert {number for number, *_ in balloons_on(sheet)} == {1, 2}
