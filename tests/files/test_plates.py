"""Plates judged from the written files; parts list by hand; each check seen to fail."""

from __future__ import annotations

import math
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgen import tolerances
from camgen.files.parts_list import parts_list
from camgen.files.plates import (
    Layout,
    Spot,
    bed_fit,
    footprint,
    laid_out,
    lying_side,
    side,
    write_plates,
)
from camgen.files.threemf import PartCopy, read_3mf, write_3mf
from camgen.geometry.mesh import Mesh
from camgen.geometry.outlines import Region, circle, polygon
from camgen.judge.copies import judge_copies
from camgen.judge.slabs import judge_plate
from camgen.parts.part import Layer, Part, hull
from camgen.parts.solids import solid

BED = (120.0, 90.0)


def block(
    name: str, width: float, height: float, count: int, tilt: float = 0.0, z0: float = 0.0
) -> Part:
    turn = complex(math.cos(tilt), math.sin(tilt))
    corners = [turn * z + 3 - 2j for z in (0, width, complex(width, height), 1j * height)]
    return Part(name, name.title(), (Layer(Region(polygon(corners)), z0, z0 + 3),), count)


def meshes_of(parts: list[Part]) -> dict[str, Mesh]:
    return {part.name: solid(part, 0.01) for part in parts}


def machine() -> list[Part]:
    bell = Part("bell", "", (Layer(Region(hull([(0j, 8), (50 + 0j, 6), (20 + 40j, 6)])), 0, 4),), 2)
    disc = Part("disc", "", (Layer(Region(circle(5, 20), (circle(0j, 4),)), 0, 6),), 3)
    return [bell, disc, block("bar", 100, 8, 4, 0.3), block("peg", 6, 6, 9)]


def test_plates_as_written(tmp_path: Path) -> None:
    parts = machine()
    meshes = meshes_of(parts)
    layout = laid_out(parts, meshes, BED, 2.0)
    assert all(f.ok for f in layout.findings) and len(layout.findings) == 4
    paths = write_plates(tmp_path, "m", layout, meshes, "key")
    assert [p.name for p in paths] == ["m-plate.3mf"] + [
        f"m-plate-{k}.3mf" for k in range(2, len(paths) + 1)
    ]
    assert all(f.ok for path in paths for f in judge_plate(path, BED, 2.0))
    copies = Counter(item.name for path in paths for item in read_3mf(path).items)
    assert copies == {part.name: part.count for part in parts}
    again = [p.read_bytes() for p in paths]
    write_plates(tmp_path, "m", laid_out(parts, meshes, BED, 2.0), meshes, "key")
    assert [p.read_bytes() for p in paths] == again


def test_a_margin_of_the_bed_stays_free(tmp_path: Path) -> None:
    parts = machine()
    meshes = meshes_of(parts)
    layout = laid_out(parts, meshes, BED, 2.0, margin=7.0)
    assert all(f.ok for f in layout.findings)
    for path in write_plates(tmp_path, "m", layout, meshes, "key"):
        assert all(f.ok for f in judge_plate(path, BED, 2.0, 7.0))
        boxes = [item.placed.vertices for item in read_3mf(path).items]
        assert min(v[:, :2].min() for v in boxes) >= 7.0 - 1e-4
    (whole,) = laid_out(
        [block("whole", 110, 80, 1)], meshes_of([block("whole", 110, 80, 1)]), BED, 2.0, margin=7.0
    ).findings
    assert not whole.ok and whole.measured == pytest.approx(4.0)  # 80 mm on 76
    spot = laid_out([block("bar", 100, 8, 1)], meshes_of([block("bar", 100, 8, 1)]), BED, 2.0)
    (path,) = write_plates(tmp_path, "w", spot, meshes_of([block("bar", 100, 8, 1)]), "key")
    found = judge_plate(path, BED, 2.0, 12.0)[0]
    assert (
        not found.ok
        and found.measured == pytest.approx(2.0, abs=1e-3)
        and "12 mm of its rim" in found.message
    )


def test_one_part_just_fits_and_stands_in_the_middle() -> None:
    parts = [block("whole", 120, 90, 1)]
    layout = laid_out(parts, meshes_of(parts), BED, 2.0)
    ((spot,),) = layout.plates
    assert layout.findings[0].ok
    assert spot.position * np.exp(0j) + np.exp(1j * spot.angle) * complex(
        3 + 60, -2 + 45
    ) == pytest.approx(60 + 45j)
    turned = [block("whole", 90, 120, 2)]
    assert [len(spots) for spots in laid_out(turned, meshes_of(turned), BED, 2.0).plates] == [1, 1]


def test_part_larger_than_the_bed_fails_with_its_size() -> None:
    parts = [block("long", 150, 10, 1), block("peg", 6, 6, 1)]
    layout = laid_out(parts, meshes_of(parts), (100.0, 90.0), 2.0)
    assert [f.ok for f in layout.findings] == [False, True]
    assert layout.findings[0].code == "BED_FIT" and layout.findings[0].measured == pytest.approx(50)
    assert "150.0 x 10.0" in layout.findings[0].message and [s.part for s in layout.plates[0]] == [
        "peg"
    ]


def test_bar_that_only_fits_across_the_corners(tmp_path: Path) -> None:
    parts = [block("bar", 130, 4, 1)]
    meshes = meshes_of(parts)
    layout = laid_out(parts, meshes, (100.0, 100.0), 2.0)
    assert layout.findings[0].ok
    assert all(
        f.ok
        for path in write_plates(tmp_path, "b", layout, meshes, "k")
        for f in judge_plate(path, (100, 100), 2.0)
    )


def test_layouts_that_are_wrong_are_seen(tmp_path: Path) -> None:
    parts = [block("peg", 6, 6, 2)]
    meshes = meshes_of(parts)
    crowded = Layout(
        ((Spot("peg", 1, 0.0, 10 + 10j, 0.0), Spot("peg", 2, 0.0, 17.5 + 10j, 0.0)),), ()
    )
    assert [
        f.ok for f in judge_plate(write_plates(tmp_path, "c", crowded, meshes, "k")[0], BED, 2.0)
    ] == [True, True, False]


@given(st.floats(2, 60), st.floats(2, 60), st.floats(0, math.pi))
@settings(max_examples=40)
def test_footprint_of_a_tilted_block(width: float, height: float, tilt: float) -> None:
    corners = np.array([0, width, complex(width, height), 1j * height]) * np.exp(1j * tilt) + 7
    f = footprint(corners, BED)
    assert sorted([f.width, f.height]) == pytest.approx(sorted([width, height]), rel=1e-9)
    assert np.abs(corners * np.exp(1j * f.angle) - f.centre).max() == pytest.approx(
        abs(complex(width, height)) / 2
    )


@given(
    st.lists(
        st.tuples(st.floats(3, 80), st.floats(3, 80), st.integers(1, 4)), min_size=1, max_size=6
    )
)
@settings(max_examples=20)
def test_no_two_cells_meet(sizes: list[tuple[float, float, int]]) -> None:
    parts = [block(f"p{k}", *size) for k, size in enumerate(sizes)]
    meshes = meshes_of(parts)
    for spots in laid_out(parts, meshes, BED, 1.5).plates:
        boxes = []
        for s in spots:
            v = meshes[s.part].vertices
            z = (v[:, 0] + 1j * v[:, 1]) * np.exp(1j * s.angle) + s.position
            boxes.append((z.real.min(), z.real.max(), z.imag.min(), z.imag.max()))
        for k, (x0, x1, y0, y1) in enumerate(boxes):
            assert min(x0, y0) > -1e-4 and x1 < BED[0] + 1e-4 and y1 < BED[1] + 1e-4
            assert all(
                max(a0 - x1, x0 - a1, b0 - y1, y0 - b1) > 1.5 - 1e-4
                for a0, a1, b0, b1 in boxes[k + 1 :]
            )


def ledge() -> Part:
    """A plate of 40 x 10 x 2 mm that stands on a foot of 40 x 2 mm, 8 mm high: upside down nothing overhangs."""
    foot, top = (Region(polygon([0j, 40 + 0j, complex(40, w), complex(0, w)])) for w in (2.0, 10.0))
    return Part("ledge", "Ledge", (Layer(foot, 0.0, 8.0), Layer(top, 8.0, 10.0)), 2)


def test_a_part_lies_on_the_side_with_least_overhang(tmp_path: Path) -> None:
    """As drawn 80 mm^2 carry it and 320 overhang; turned over 400 carry; on its back, where foot and plate are flush, 400 too."""
    parts = [ledge(), *machine()]
    meshes = meshes_of(parts)
    own, best = side(meshes["ledge"], np.array([0, 0, -1.0])), lying_side(meshes["ledge"])
    assert (own.contact, own.overhang, own.height) == pytest.approx((80, 320, 10))
    assert (best.contact, best.overhang, best.height) == pytest.approx((400, 0, 10))
    sides = {name: lying_side(mesh) for name, mesh in meshes.items()}
    assert {name for name, each in sides.items() if each.name != "as drawn"} == {"ledge"}
    layout = laid_out(parts, meshes, BED, 2.0, sides)
    for path in write_plates(tmp_path, "m", layout, meshes, "key"):
        assert all(f.ok for f in judge_plate(path, BED, 2.0)) and judge_copies(path, meshes).ok
        package = read_3mf(path)
        for item in package.items:
            placed = package.meshes[item.name].moved(item.transform)
            lying = side(placed, np.array([0, 0, -1.0]))
            assert lying.overhang == pytest.approx(0, abs=1e-3) or item.name != "ledge"


@given(st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda v: sum(x * x for x in v) > 0.01))
@settings(max_examples=40, deadline=None)
def test_a_side_is_brought_down_by_a_rotation(v: tuple[float, float, float]) -> None:
    down = np.array(v) / np.linalg.norm(v)
    turn = side(meshes_of([ledge()])["ledge"], down).turn
    assert turn @ down == pytest.approx([0, 0, -1], abs=1e-9) and np.linalg.det(
        turn
    ) == pytest.approx(1)
    assert turn @ turn.T == pytest.approx(np.eye(3), abs=1e-9)


def test_a_mirrored_copy_on_a_plate_is_told(tmp_path: Path) -> None:
    meshes = meshes_of([ledge()])
    write_3mf(
        tmp_path / "x.3mf",
        meshes,
        [PartCopy("ledge", "ledge 1", np.diag([1.0, 1.0, -1.0, 0])[:3])],
        "key",
    )
    assert judge_copies(tmp_path / "x.3mf", meshes).message == "a copy of ledge is mirrored or flat"


@pytest.mark.parametrize(
    "damage, said",
    [
        ({"squeezed": np.array([1.0, 1, 0])}, "peg is not as in its own file"),
        ({"transform": np.diag([1.0, 1.002, 1.0])}, "a copy of peg is deformed"),
        ({"shift": 0.3}, "a copy of peg is out of its place"),
        ({"faces": np.array([2, 1, 0])}, "the triangles of peg are not those of its own file"),
    ],
)
def test_a_damaged_copy_is_named(tmp_path: Path, damage: dict[str, np.ndarray], said: str) -> None:
    """Of two parts one: flat, longer in y, out of its place, inside out."""
    meshes = meshes_of([block("rib", 9, 5, 1), block("peg", 6, 6, 1)])
    at = np.column_stack([np.eye(3), [20.0, 0, 0]])
    made = Mesh(
        meshes["peg"].vertices * damage.get("squeezed", 1),
        meshes["peg"].faces[:, damage.get("faces", slice(None))],
    )
    stands = np.column_stack(
        [damage.get("transform", np.eye(3)), at[:, 3] + damage.get("shift", 0)]
    )
    for peg, where in ((meshes["peg"], at), (made, stands)):
        write_3mf(
            tmp_path / "x.3mf",
            {**meshes, "peg": peg},
            [PartCopy("rib", "rib"), PartCopy("peg", "peg 1", where)],
            "key",
        )
        found = judge_copies(tmp_path / "x.3mf", meshes, [("rib", np.eye(3, 4)), ("peg", at)])
        assert found.ok is (peg is meshes["peg"])
        measurable = peg is meshes["peg"] or "triangles" not in said
        assert math.isfinite(found.measured) is measurable
    assert found.message == said


@pytest.mark.parametrize("far", [0.0, 5e4])
def test_copies_are_as_exact_as_the_digits_of_the_furthest_place(
    tmp_path: Path, far: float
) -> None:
    """One at the origin, one 50 m away: what rounding leaves of a place grows with it."""
    meshes = meshes_of([block("peg", 6, 8, 1)])
    places = [np.eye(3, 4), np.column_stack([np.eye(3), [far, 0, 0]])]
    placed = [PartCopy("peg", f"peg {k}", at) for k, at in enumerate(places, 1)]
    write_3mf(tmp_path / "x.3mf", meshes, placed, "key")
    found = judge_copies(tmp_path / "x.3mf", meshes, [("peg", at) for at in places])
    reach = np.max(np.abs(meshes["peg"].vertices))
    assert found.ok and found.limit == pytest.approx(
        tolerances.TRANSFORM_ROUNDING * (reach + max(far, 1.0))
    )


def test_what_is_collapsed_to_a_point_lies_on_nothing() -> None:
    assert bed_fit("peg", 1, np.zeros((4, 3)), BED)[0].width == 0


def test_parts_list_by_hand() -> None:
    (row,) = parts_list([block("cube", 10, 20, 3)], 1.24)
    assert (row.count, row.material_mm3, row.mass_g) == (
        3,
        pytest.approx(1800),
        pytest.approx(2.232),
    )
    assert row.print_min == pytest.approx(
        3 * (600 / (0.4 * 0.2 * 60) + 15 * 6) / 60
    )  # 4.8 mm^3/s, 15 layers of 6 s
    (half,) = parts_list([block("cube", 10, 20, 3)], 1.27, 0.5)
    assert half.material_mm3 == row.material_mm3  # of the part
    assert half.mass_g / row.mass_g == pytest.approx(0.5 * 1.27 / 1.24)
    assert half.print_min == pytest.approx(3 * (300 / 4.8 + 15 * 6) / 60)
