"""Bodies, layers and copies of sliced plates: stacks of walls whose every height and place is known."""

from __future__ import annotations

import cmath
import math
from collections import Counter
from collections.abc import Sequence

import numpy as np
import pytest
import shapely
from shapes import polygon

from camgen.files.gcode import Wall
from camgen.findings import Where
from camgen.geometry.mesh import Mesh
from camgen.geometry.outlines import Region, circle
from camgen.geometry.outlines import polygon as contour
from camgen.geometry.registration import Registration
from camgen.geometry.rings import Ring, Shape
from camgen.judge.sliced import (
    Copy,
    Layer,
    PrintModel,
    bodies,
    copy_of,
    envelope,
    interchangeable,
    outwards,
    shapes_of,
)
from camgen.judge.sliced_copies import judge_sliced_copies
from camgen.parts.part import Layer as Solid
from camgen.parts.part import Part
from camgen.parts.solids import solid

WIDTH = 0.4  # mm, of a bead
PLAN = np.array([0, 24, 24 + 6j, 9 + 6j, 9 + 15j, 15j])  # an L with no symmetry
HOLES = ((4 + 10j, 2.0), (18 + 3j, 1.5))  # centre and radius


def disc(at: complex, radius: float) -> Ring:
    return polygon(at + radius * np.exp(2j * np.pi * np.arange(60) / 60))


def wall(ring: Ring, z: float, height: float = math.inf, width: float = WIDTH) -> Wall:
    return Wall(z, ring, np.full(len(ring.points), width), height)


def tower(tops: Sequence[float], at: complex = 0j, height: float = math.inf) -> list[Wall]:
    """A square of 10 mm with a square hole of 4, in layers that end at these heights."""
    square = np.array([0, 10, 10 + 10j, 10j])
    return [
        wall(polygon(at + z), top, height) for top in tops for z in (square, 3 + 3j + 0.4 * square)
    ]


def heights(body: Sequence[Layer]) -> list[tuple[float, float]]:
    return [(round(layer.low, 6), round(layer.top, 6)) for layer in body]


# ---- bodies --------------------------------------------------------------------------------------------------------------


def test_walls_over_each_other_are_a_body() -> None:
    """Two towers, their walls mixed up; of each layer the outline and the hole."""
    walls = tower([0.2, 0.4, 0.6]) + tower([0.3, 0.6], at=20)
    first, second = bodies([walls[k] for k in np.random.default_rng(1).permutation(len(walls))])
    if len(first) == 2:
        first, second = second, first
    assert (heights(first), heights(second)) == (
        [(0, 0.2), (0.2, 0.4), (0.4, 0.6)],
        [(0, 0.3), (0.3, 0.6)],
    )
    for layer in (*first, *second):
        sizes = {
            hole: abs(each.ring.area) for each, hole in zip(layer.walls, layer.holes, strict=True)
        }
        assert sizes == {False: pytest.approx(100), True: pytest.approx(16)}
        assert layer.middle == (layer.low + layer.top) / 2


def test_a_wall_in_a_hole_is_material_again() -> None:
    """By how many others it lies within: an island in the hole of a ring."""
    walls = tower([0.2]) + [wall(polygon(np.array([4 + 4j, 6 + 4j, 6 + 6j, 4 + 6j])), 0.2)]
    link = wall(
        polygon(np.array([-1 - 1j, 11 - 1j, 11 + 11j, -1 + 11j])), 0.4
    )  # over all of them, so that they are one body
    (body,) = bodies([*walls, link])
    holes = {
        round(abs(each.ring.area)): hole
        for each, hole in zip(body[0].walls, body[0].holes, strict=True)
    }
    assert holes == {100: False, 16: True, 4: False}


@pytest.mark.parametrize(
    "tops, layers",
    [
        ([0.2, 0.4, 0.6], [(0, 0.2), (0.2, 0.4), (0.4, 0.6)]),
        (
            [0.35, 0.55, 0.75],
            [(0, 0.35), (0.35, 0.55), (0.55, 0.75)],
        ),  # a first layer that is higher
        (
            [2.0, 2.2, 2.4],
            [(0, 0.2), (0.2, 0.4), (0.4, 0.6)],
        ),  # on a raft: its height is none of the body's own
        ([0.9, 1.1], [(0, 0.9), (0.9, 1.1)]),
        ([0.3], [(0, 0.3)]),
        ([1.2], [(0, 1.2)]),
    ],
)
def test_layers_begin_where_the_one_below_ends(
    tops: list[float], layers: list[tuple[float, float]]
) -> None:
    (body,) = bodies(tower(tops))
    assert heights(body) == layers


def test_a_layer_over_a_gap_is_as_high_as_its_bead() -> None:
    """Over a missing layer: what the file says of the bead, or what is usual; half as much again is no gap."""
    for told in (0.2, math.inf):
        (body,) = bodies(tower([0.2, 0.4, 0.8, 1.0], height=told))
        assert heights(body) == [(0, 0.2), (0.2, 0.4), (0.6, 0.8), (0.8, 1.0)]
    (body,) = bodies(tower([0.2, 0.4, 0.69, 0.89], height=0.2))
    assert heights(body) == [(0, 0.2), (0.2, 0.4), (0.4, 0.69), (0.69, 0.89)]
    (body,) = bodies(tower([0.6, 0.8], height=0.2))
    assert heights(body) == [(0.4, 0.6), (0.6, 0.8)]  # the first ones are missing
    (body,) = bodies(tower([0.2, 0.6]))
    assert heights(body) == [(0, 0.2), (0.2, 0.6)]  # of two nobody knows


# ---- copies ---------------------------------------------------------------------------------------------------------------


def part(height: float = 3.0) -> Mesh:
    region = Region(contour(PLAN.tolist()), tuple(circle(at, radius) for at, radius in HOLES))
    return solid(Part("x", "", (Solid(region, 0, height),)), 0.01)


def printed(
    turn: float, shift: complex, over: bool = False, layers: int = 15, rise: float = 0.2
) -> tuple[Layer, ...]:
    """Centre lines half a bead within the part as it lies on the bed."""
    spin = cmath.exp(1j * turn)

    def lying(z: np.ndarray) -> np.ndarray:
        return spin * (-z.conj() if over else z) + shift

    outline = polygon(lying(PLAN)).counter_clockwise()
    inner = shapely.Polygon(np.column_stack([outline.points.real, outline.points.imag])).buffer(
        -WIDTH / 2, join_style="mitre"
    )
    centre = polygon(shapely.get_coordinates(inner.exterior)[:-1] @ np.array([1, 1j]))
    rings = [
        centre,
        *(disc(complex(lying(np.array([at]))[0]), radius + WIDTH / 2) for at, radius in HOLES),
    ]
    flags = (False, True, True)
    return tuple(
        Layer(k * rise, (k + 1) * rise, tuple(wall(ring, (k + 1) * rise) for ring in rings), flags)
        for k in range(layers)
    )


LYING, OVER = np.eye(3), np.diag([-1.0, 1.0, -1.0])


@pytest.mark.parametrize("turn, shift, over", [(0.7, 40 - 25j, False), (-2.2, 5 + 60j, True)])
def test_a_print_is_known_wherever_it_lies(turn: float, shift: complex, over: bool) -> None:
    """Its part, turn and place; in the part's frame it is the part again, and so are its heights."""
    found = copy_of(
        printed(turn, shift, over),
        [PrintModel("y", part(9.0), LYING), PrintModel("x", part(), OVER if over else LYING)],
    )
    assert found is not None and found.known.part == "x" and found.known.over is over
    z = np.array([0, 10, 3 + 4j])
    on_bed = np.exp(1j * turn) * (-z.conj() if over else z) + shift
    inside = found.inside(polygon(on_bed)).points
    assert [np.min(np.abs(inside - each)) < 0.03 for each in z] == [True] * 3
    layer = found.layers[2]
    assert found.height(layer) == pytest.approx(2.5 if over else 0.5, abs=1e-9)
    (shape,) = shapes_of(found, layer)
    assert shape.area == pytest.approx(24 * 6 + 9 * 9 - math.pi * (4 + 2.25), rel=3e-3)
    (larger,) = shapes_of(found, layer, hole=0.1, profile=0.2)
    assert larger.outer.area == pytest.approx(
        shape.outer.area + 0.2 * shape.outer.length + 0.04 * 4, rel=1e-3
    )
    assert sorted(abs(h.area) for h in larger.holes) == pytest.approx(
        [math.pi * 1.4**2, math.pi * 1.9**2], rel=0.01
    )
    (small,) = shapes_of(found, layer, shrinkage=0.02, profile=0.2)
    assert small.outer.area == pytest.approx(
        0.98**2 * shape.outer.area + 0.2 * 0.98 * shape.outer.length, rel=3e-3
    )


@pytest.mark.parametrize(
    "known, there",
    [
        (PrintModel("x", part(), LYING), True),
        (PrintModel("x", part(2.7), LYING), False),  # lower by more than a layer
        (PrintModel("x", part(), OVER), False),  # its mirror image
        (
            PrintModel(
                "x",
                solid(Part("x", "", (Solid(Region(contour((PLAN * 1.08).tolist())), 0, 3),)), 0.01),
                LYING,
            ),
            False,
        ),
    ],
)
def test_what_is_like_no_part_is_none(known: PrintModel, there: bool) -> None:
    assert (copy_of(printed(0.3, 5j), [known]) is not None) is there
    assert copy_of(printed(0.3, 5j), []) is None


def with_hole(at: complex) -> Mesh:
    """The part, its second hole elsewhere."""
    region = Region(contour(PLAN.tolist()), (circle(*HOLES[0]), circle(at, HOLES[1][1])))
    return solid(Part("x", "", (Solid(region, 0, 3),)), 0.01)


def with_pocket(at: complex) -> Mesh:
    """The part with a pocket in its top face."""
    rings = [circle(*hole) for hole in HOLES]
    whole = Region(contour(PLAN.tolist()), tuple(rings))
    cut = Region(contour(PLAN.tolist()), (*rings, circle(at, 1.0)))
    return solid(Part("x", "", (Solid(whole, 0, 2.5), Solid(cut, 2.5, 3))), 0.01)


def turned_over(mesh: Mesh) -> Mesh:
    return Mesh(mesh.vertices @ OVER.T + 7, mesh.faces)


@pytest.mark.parametrize(
    "other, turns, alike",
    [
        (part(), [LYING], True),
        (turned_over(part()), [LYING, OVER], True),
        (turned_over(part()), [LYING], False),  # its mirror image on the bed
        (with_hole(17.8 + 3j), [LYING], False),
        (with_pocket(10 + 3j), [LYING], False),
        (part(3.1), [LYING], False),
    ],
)
def test_parts_whose_prints_are_the_same(other: Mesh, turns: list[np.ndarray], alike: bool) -> None:
    """Turned about, shifted or turned over it is the same; with a hole 0.2 mm beside, a pocket, or 0.1 mm higher it is not."""
    spun = Mesh(other.vertices @ np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 1.0]]) + 3, other.faces)
    for mesh in (other, spun):
        known = [PrintModel("a", part(), LYING), *(PrintModel("b", mesh, turn) for turn in turns)]
        groups = {"a": ["a", "b"], "b": ["a", "b"]} if alike else {"a": ["a"], "b": ["b"]}
        assert interchangeable(known) == groups


def test_parts_that_differ_at_one_height_alone_are_two() -> None:
    """The same volume and the same outline half way up, the pocket elsewhere."""
    one, other = (PrintModel(str(x), with_pocket(x + 3j), LYING) for x in (10, 14))
    assert interchangeable([one, other]) == {"10": ["10"], "14": ["14"]}


def copy(layers: Sequence[Layer]) -> Copy:
    return Copy(PrintModel("x", part(), LYING), Registration(0.0, 0j, 0.0), tuple(layers))


def test_layers_that_are_missing_are_told_where_most_are() -> None:
    """None, one in the middle, two more below; at the top half a layer may be lacking."""
    whole = printed(0.0, 0j)
    gap, height = copy(whole).complete(Where(file="w"))
    assert gap.ok and gap.measured == 0 and gap.message == "no layer is missing" and height.ok
    assert (str(gap.where), str(height.where)) == ("w, x, gap between layers", "w, x, height")
    gap, height = copy([*whole[:3], *whole[5:9], *whole[10:]]).complete(Where(file="w"))
    assert not gap.ok and gap.measured == pytest.approx(0.4)
    assert "in 2 places, the most over z = 0.600 mm" in gap.message and height.ok
    for left, off in ((14, 0.2), (13, 0.4)):
        gap, height = copy(whole[:left]).complete(Where(file="w"))
        assert (
            gap.ok
            and not height.ok
            and height.measured == pytest.approx(off)
            and height.limit == pytest.approx(0.101)
        )
        assert height.message.startswith(
            f"its last layer ends at {3 - off:.3f} mm, its top lies at 3.000;"
        )
    assert (
        copy(printed(0.0, 0j, layers=14, rise=0.21)).complete(Where(file="w"))[1].ok
    )  # 2.94 mm of 3


def test_layers_of_one_outline_fill_together_what_any_of_them_does() -> None:
    """Two squares that are shifted: their union; a hole is where all have one, and slivers that facets leave are none."""
    square = polygon(np.array([0, 10, 10 + 10j, 10j]))
    one = Shape(square, (disc(3 + 5j, 1.0), disc(7 + 5j, 1.0)))
    other = Shape(square.moved(shift=0.5), (disc(3 + 5j, 0.8), disc(7.5 + 5j, 1.0)))
    (whole,) = envelope([[one], [other]])
    assert whole.outer.area == pytest.approx(105)
    lens = 2 * math.acos(0.25) - 0.5 * math.sqrt(
        1 - 0.0625
    )  # of two discs of 1 mm, half a millimetre apart
    assert sorted(abs(hole.area) for hole in whole.holes) == pytest.approx(
        sorted([lens, 0.64 * math.pi]), rel=5e-3
    )
    assert [len(part.holes) for part in envelope([[Shape(square, (disc(3 + 5j, 0.005),))]])] == [0]
    assert len(envelope([[one], [Shape(square.moved(shift=50), ())]])) == 2


def test_how_far_a_print_stands_out_of_what_is_meant() -> None:
    """Outlines to the outside, holes into the hole; each against the one that is most like it."""
    meant = Shape(
        polygon(np.array([0, 20, 20 + 10j, 10j])), (disc(4 + 5j, 2.0), disc(14 + 5j, 3.0))
    )
    rim = polygon(np.array([-0.2 - 0.2j, 20.2 - 0.2j, 20.2 + 10.2j, -0.2 + 10.2j]))
    larger = Shape(rim, (disc(14 + 5j, 2.9), disc(4 + 5j, 1.85)))
    outside, inside = outwards([larger], [meant])
    assert np.median(outside) == pytest.approx(0.2, abs=1e-3) and np.max(outside) == pytest.approx(
        0.2 * math.sqrt(2), abs=2e-3
    )
    assert set(np.round(inside, 2)) == {0.1, 0.15}
    assert [len(each) for each in outwards([], [meant])] == [0, 0]
    assert [len(each) for each in outwards([Shape(larger.outer, ())], [meant])][1] == 0


# ---- the parts list ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "laid, wrong, said, absent",
    [
        ({"a": 2, "b": 1, "c": 4}, 0, "7 copies on the plates that are sliced", ""),
        ({"a": 2, "b": 1}, 0, "3 copies on the plates that are sliced", "4 of c"),
        ({"a": 2}, 1, "too few for the parts list: 1 of b", "4 of c"),
        ({"a": 4, "b": 2, "c": 4}, 3, "too many, as if sliced twice: 2 of a, 1 of b", ""),
        (
            {"a": 3, "c": 3},
            3,
            "too few for the parts list: 1 of b, 1 of c; too many, as if sliced twice: 1 of a",
            "",
        ),
        (
            {"a": 1},
            0,
            "1 copies on the plates that are sliced",
            "1 of a, 1 of b, 4 of c",
        ),  # a part that is printed anew
    ],
)
def test_copies_against_the_plates_of_the_folder(
    laid: dict[str, int], wrong: int, said: str, absent: str
) -> None:
    """Two plates: one holds two of a and one of b, the other four of c. One of which more than half is laid is sliced."""
    plates = {"p-1": Counter(a=2, b=1), "p-2": Counter(c=4)}
    finding, left = judge_sliced_copies(
        Counter(laid), Counter(a=2, b=1, c=4), plates, Where(file="w")
    )
    assert (finding.measured, finding.ok, finding.message) == (wrong, wrong == 0, said)
    assert [each.why for each in left] == (
        [f"copies that lie on none of these plates: {absent}"] if absent else []
    )
    if absent:
        lacking = [name for name, part_ in (("p-1", "b"), ("p-2", "c")) if part_ in absent]
        assert left[0].needs == f"the G-code of {', '.join(lacking)}"


def test_a_copy_counts_for_the_plate_that_is_laid_the_most() -> None:
    """Three of a lie: all of the small plate, and not half of the large one that holds some as well."""
    plates = {"large": Counter(a=3, b=4), "small": Counter(a=3)}
    finding, (left,) = judge_sliced_copies(Counter(a=3), Counter(a=6, b=4), plates, Where(file="w"))
    assert finding.ok and left.needs == "the G-code of large"
