"""What contours of a section say against those that were meant: plates whose damage is known to the last digit."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapes import polygon

from camgen import tolerances
from camgen.findings import Finding, Where
from camgen.geometry.mesh import Mesh
from camgen.geometry.outlines import Region, circle
from camgen.geometry.outlines import polygon as contour
from camgen.geometry.rings import Ring, Shape
from camgen.judge.round_trip import (
    NominalPart,
    PrintChange,
    Section,
    _misdrawn,
    judge_cut,
    judge_dimensioned,
    judge_solid,
    pieces_of,
    strange,
)
from camgen.parts.part import Layer, Part
from camgen.parts.solids import solid

TOLERANCE = 0.002
EYES = ((-15 + 0j, 4.0), (15 + 0j, 6.0), (0j, 5.0))


def hole(at: complex, diameter: float) -> Ring:
    return Ring(at + diameter / 2 * np.array([1, -1 + 0j]), np.ones(2))


def plate(width: float = 60.0, height: float = 30.0) -> Ring:
    corner = complex(width, height) / 2
    return polygon(np.array([-corner, corner.conjugate(), corner, -corner.conjugate()]))


def expected(*shapes: Shape, **keys: object) -> NominalPart:
    whole = NominalPart("x", (Section((1.0,), shapes),), 0, 100.0, (0.0, 3.0), 0.0, 1.0, TOLERANCE)
    return replace(whole, **keys)  # type: ignore[arg-type]


def judged(meant: NominalPart, rings: Sequence[Ring]) -> dict[str, Finding]:
    return {finding.code: finding for finding in judge_cut(rings, meant, Where("x")).findings}


PLATE = Shape(plate(), tuple(hole(*eye) for eye in EYES))


def moved(*shifts: complex, turn: complex = 1) -> list[Ring]:
    """The plate, whose eyes are turned together about the middle one and shifted one by one."""
    return [
        PLATE.outer,
        *(hole(turn * at + by, size) for (at, size), by in zip(EYES, shifts, strict=True)),
    ]


SHIFT = st.complex_numbers(min_magnitude=0.1, max_magnitude=0.8)


@settings(max_examples=20)
@given(by=SHIFT)
def test_a_hole_elsewhere_is_off_by_its_way(by: complex) -> None:
    """One that is no joint's; one that is, where it moved alone, along the line of all, is judged by the motion."""
    lone = judged(expected(PLATE), moved(0j, by, 0j))["ROUND_TRIP"]
    assert lone.measured == pytest.approx(abs(by), abs=1e-3) and not lone.ok
    assert (
        judged(expected(PLATE, eyes=EYES), moved(0j, complex(abs(by)), 0j))["ROUND_TRIP"].measured
        < 1e-6
    )


@settings(max_examples=20)
@given(by=SHIFT, degrees=st.floats(-3, 3))
def test_eyes_that_moved_together_are_off_in_their_outline(by: complex, degrees: float) -> None:
    """By the largest way of one, however they turned; not where a follower runs on the outline; and not where each moved
    for itself by more than half of that."""
    turn = cmath.exp(1j * math.radians(degrees))
    rings = moved(by, by, by, turn=turn)
    far = max(abs((turn - 1) * at + by) for at, _ in EYES)
    meant = expected(PLATE, eyes=EYES)
    finding = judged(meant, rings)["ROUND_TRIP"]
    assert (
        finding.measured == pytest.approx(far, abs=1e-6)
        and "moved or turned together" in finding.message
    )
    assert judged(replace(meant, rolls=True), rings)["ROUND_TRIP"].ok
    assert judged(meant, moved(complex(abs(by)), complex(-abs(by)), 0j))["ROUND_TRIP"].ok
    round_plate = Shape(hole(0j, 60), PLATE.holes)
    rim = (*EYES, (0j, 60.0))
    assert judged(expected(round_plate, eyes=rim), [round_plate.outer, *rings[1:]])[
        "ROUND_TRIP"
    ].ok  # its rim is an eye itself


@pytest.mark.parametrize(
    "near, wide, eye",
    [
        (0.9, 0.0, True),
        (1.1, 0.0, False),
        (0.0, 0.9, True),
        (0.0, 1.1, False),
        (0.0, -0.9, True),
        (0.0, -1.1, False),
    ],
)
def test_an_eye_is_told_by_its_place_and_its_size(near: float, wide: float, eye: bool) -> None:
    """Both within two tolerances of the joint's; what is no eye is judged where it lies."""
    joint = (15 + 2j * TOLERANCE * near, 6 + 2 * TOLERANCE * wide)
    rings = moved(0j, 0.3 + 0j, 0j)
    finding = judged(expected(PLATE, eyes=(joint,), rolls=True), rings)["ROUND_TRIP"]
    assert finding.ok is eye and finding.measured == pytest.approx(0.0 if eye else 0.3, abs=1e-3)


@pytest.mark.parametrize("bore, off", [(5.0, 0.0), (None, 0.4), (0.0, 0.4)])
def test_the_bore_of_what_turns_lies_where_the_motion_says(bore: float | None, off: float) -> None:
    """The hole at the datum, wherever it is found; a part that turns on none has its hole where it is meant."""
    finding = judged(expected(PLATE, bore=bore), moved(0j, 0j, 0.4 + 0j))["ROUND_TRIP"]
    assert finding.measured == pytest.approx(off, abs=1e-3)


def test_a_hole_beside_the_bore_is_none() -> None:
    """Its middle is 4 mm from the axle, farther than the bore's rim at 2.5 mm: moved with the bore it is off all the same."""
    beside = (4j, 2.0)
    wide = Shape(PLATE.outer, (*PLATE.holes, hole(*beside)))
    for by in (0.0, 0.4):
        rings = [*moved(0j, 0j, 0.4 + 0j), hole(beside[0] + by, beside[1])]
        finding = judged(expected(wide, bore=5.0), rings)["ROUND_TRIP"]
        assert finding.measured == pytest.approx(by, abs=1e-3)


def test_a_bore_is_as_far_off_at_all_heights() -> None:
    """Two heights whose bores do not lie over each other: of the second the error is what it is off the first."""
    rim, others = contour(list(PLATE.outer.points)), (circle(-15, 2), circle(15, 3))
    layers = [
        Layer(Region(rim, (circle(at, 2.5), *others)), 1.5 * k, 1.5 * k + 1.5)
        for k, at in enumerate((0.4, 0.5))
    ]
    part = Part("x", "", tuple(layers))
    sections = Section((1.0,), (PLATE,)), Section((2.0,), (PLATE,))
    meant = expected(
        sections=sections, bore=5.0, levels=(0.0, 1.5, 3.0), volume=part.volume, facets=9.0
    )
    found = {
        f.code: f for f in judge_solid(solid(part, TOLERANCE / 2), meant, Where("x"), 0.0).findings
    }
    assert found["ROUND_TRIP"].measured == pytest.approx(0.1, abs=2e-3)


@pytest.mark.parametrize("off", [0.0, 0.4])
def test_a_bore_above_a_floor_is_where_it_is_meant(off: float) -> None:
    """Below it there is none, by which it could be told how far it is off."""
    rim, others = contour(list(PLATE.outer.points)), (circle(-15, 2), circle(15, 3))
    layers = (
        Layer(Region(rim, others), 0.0, 1.5),
        Layer(Region(rim, (circle(off, 2.5), *others)), 1.5, 3.0),
    )
    part = Part("x", "", layers)
    floor = Shape(PLATE.outer, PLATE.holes[:2])
    meant = expected(
        sections=(Section((1.0,), (floor,)), Section((2.0,), (PLATE,))),
        bore=5.0,
        levels=(0.0, 1.5, 3.0),
        volume=part.volume,
        facets=9.0,
    )
    found = {
        f.code: f for f in judge_solid(solid(part, TOLERANCE / 2), meant, Where("x"), 0.0).findings
    }
    assert found["ROUND_TRIP"].measured == pytest.approx(off, abs=2e-3)


def test_contours_too_many_or_of_another_piece_are_told() -> None:
    finding = judged(expected(PLATE), moved(0j, 0j, 0j)[:-1])["ROUND_TRIP"]
    assert not finding.ok and finding.message == "3 contours instead of 4"
    left, right = (Shape(plate(20, 20).moved(shift=at), (hole(at, 4.0),)) for at in (-20, 20))
    two = [left.outer, right.outer, hole(20, 4.0), hole(15, 4.0)]
    finding = judged(expected(left, right), two)["ROUND_TRIP"]
    assert not finding.ok and finding.message == "a piece has the holes of another one"
    assert judged(expected(left, right), [right.outer, *right.holes, *left.holes, left.outer])[
        "ROUND_TRIP"
    ].ok


@pytest.mark.parametrize("wider, units, ok", [(0.0, 4, True), (0.01, 4, False), (0.0, 1, False)])
def test_contours_of_a_dimensioned_drawing(
    tmp_path: Path, wider: float, units: int, ok: bool
) -> None:
    """As another library draws them; other lines say nothing."""
    drawing = ezdxf.new(units=units)
    space, cut = drawing.modelspace(), {"layer": "CUT"}
    corners = [(z.real, z.imag) for z in PLATE.outer.points]
    space.add_lwpolyline(corners, close=True, dxfattribs=cut)
    for at, size in EYES:
        space.add_circle((at.real, at.imag), size / 2 + wider, dxfattribs=cut)
    space.add_line((-40, 0), (40, 0), dxfattribs={"layer": "DIM"})
    path = tmp_path / "x-drawing.dxf"
    drawing.saveas(path)
    found = judge_dimensioned(path, expected(PLATE))
    assert found.code == "ROUND_TRIP" and found.ok is ok
    if units == 4:
        assert found.measured == pytest.approx(wider, rel=0.01)  # the areas tell it too
    else:
        assert "$INSUNITS is 1" in found.message


def test_pieces_are_what_lies_in_no_other_ring() -> None:
    """However they are ordered: two plates, one of them with two holes."""
    left, right = plate(20, 20).moved(shift=-20), plate(24, 20).moved(shift=20)
    holes = [hole(15, 4.0), hole(24, 5.0)]
    rings = [holes[0], left, holes[1], right]
    for order in ((0, 1, 2, 3), (3, 2, 1, 0), (1, 0, 3, 2)):
        larger, smaller = pieces_of([rings[k] for k in order])
        assert (larger.outer, set(map(id, larger.holes))) == (right, set(map(id, holes)))
        assert (smaller.outer, smaller.holes) == (left, ())


@pytest.mark.parametrize("across, ok", [(3.0, True), (0.999, True), (0.99, False)])
def test_the_thinnest_wall_is_between_holes_or_at_the_rim(across: float, ok: bool) -> None:
    """1 mm is wanted, and facets on both sides may take 4 um of it."""
    at_rim = Shape(plate(), (hole(complex(0, 15 - 4 - across), 8.0),))
    between = Shape(plate(), (hole(-4 - across / 2, 8.0), hole(4 + across / 2, 8.0)))
    for shape in (at_rim, between):
        wall = judged(expected(shape), [shape.outer, *shape.holes])["MIN_WALL"]
        assert wall.ok is ok and wall.measured == pytest.approx(across, abs=2e-3)
    assert "MIN_WALL" not in judged(expected(Shape(plate(), ())), [plate()])


@pytest.mark.parametrize("off", [0.0, 0.05])
@pytest.mark.parametrize("which", ["levels", "there"])
def test_flat_faces_off_their_height_are_told(off: float, which: str) -> None:
    """Each of the file is near one that is meant, and each that is meant near one of the file."""
    layers = [
        Layer(Region(contour(list(PLATE.outer.points))), 0, 1),
        Layer(Region(contour([-9, 9, 9 + 9j])), 1, 3 + off),
    ]
    part = Part("x", "", tuple(layers if which == "there" else layers[:1]))
    levels = (0.0, 1.0, 3.0) if which == "there" else (0.0, 1 + off)
    sections = (Section((0.5,), (Shape(plate(), ()),)),)
    meant = expected(sections=sections, levels=levels, volume=part.volume)
    found = {
        f.code: f for f in judge_solid(solid(part, TOLERANCE), meant, Where("x"), 0.0).findings
    }
    assert found["ROUND_TRIP"].measured == pytest.approx(off, abs=1e-6) and found[
        "ROUND_TRIP"
    ].ok is (off == 0)
    # of what is not stacked only the lowest and the highest place count
    loose = replace(meant, levels_complete=False, levels=(levels[0], levels[-1]))
    found = {
        f.code: f for f in judge_solid(solid(part, TOLERANCE), loose, Where("x"), 0.0).findings
    }
    assert found["ROUND_TRIP"].measured == pytest.approx(off, abs=1e-6)


@pytest.mark.parametrize("off, ok", [(0.9, True), (1.1, False), (-0.9, True), (-1.1, False)])
def test_a_volume_may_be_off_by_a_share_and_what_facets_take(off: float, ok: bool) -> None:
    part = Part("x", "", (Layer(Region(contour([0, 10, 10 + 10j, 10j])), 0, 3),))
    limit = tolerances.VOLUME_SHARE * 300 + 0.5
    meant = expected(
        sections=(), volume=300 / (1 + off * tolerances.VOLUME_SHARE) - off * 0.5, facets=0.5
    )
    mesh = solid(part, TOLERANCE)
    assert float(np.ptp(mesh.vertices[:, 2])) == 3
    meant = replace(
        meant, sections=(Section((1.0,), (Shape(polygon(np.array([0, 10, 10 + 10j, 10j])), ()),)),)
    )
    volume = {f.code: f for f in judge_solid(mesh, meant, Where("x"), 0.0).findings}["VOLUME"]
    assert volume.ok is ok and volume.measured == pytest.approx(abs(off) * limit, rel=0.02)


@pytest.mark.parametrize(
    "rounding, stacked, undo",
    [(0.0, True, 0.0), (1e-5, True, 0.0), (1e-5, False, 0.0), (0.0, True, 0.2)],
)
def test_the_limit_is_two_tolerances_and_what_the_format_rounds(
    rounding: float, stacked: bool, undo: float
) -> None:
    """Of a share of the largest coordinate four steps, of merged corners their steps more; and what a way back may cost."""
    part = Part("x", "", (Layer(Region(contour([0, 40, 40 + 10j, 10j])), 0, 3),))
    shape = Shape(polygon(np.array([0, 40, 40 + 10j, 10j])), ())
    back = PrintChange(-undo, undo / 2, 0.0) if undo else None
    sections = Section((1.0,), (shape,), sent=True), Section((1.0,), (shape,))
    meant = expected(sections=sections, volume=1200.0, levels_complete=stacked, print_change=back)
    found = {
        f.code: f for f in judge_solid(solid(part, TOLERANCE), meant, Where("x"), rounding).findings
    }["ROUND_TRIP"]
    steps = 4 + (0 if stacked else math.sqrt(2) * tolerances.MERGED_STEPS)
    assert found.limit == pytest.approx(
        2 * TOLERANCE + steps * rounding * 40 + tolerances.WAY_BACK * undo
    )
    assert found.measured == pytest.approx(
        undo * math.sqrt(0.5) if undo else 0.0, abs=undo * 0.3 + 1e-9
    )


def test_faults_of_a_mesh_are_counted_before_all_else() -> None:
    """A hole in the wall, two bodies, and triangles that look inwards."""
    part = Part("x", "", (Layer(Region(contour([0, 10, 10 + 10j, 10j])), 0, 3),))
    sound = solid(part, TOLERANCE)
    meant = expected(
        sections=(Section((1.0,), (Shape(polygon(np.array([0, 10, 10 + 10j, 10j])), ()),)),),
        volume=300.0,
    )
    torn = Mesh(sound.vertices, sound.faces[1:])
    second = sound.vertices + [50.0, 0, 0]
    two = Mesh(
        np.concatenate([sound.vertices, second]),
        np.concatenate([sound.faces, sound.faces + len(sound.vertices)]),
    )
    for mesh, codes in (
        (sound, ["WATERTIGHT", "VOLUME", "ROUND_TRIP"]),
        (torn, ["WATERTIGHT"]),
        (two, ["WATERTIGHT"]),
    ):
        judged_ = judge_solid(mesh, meant, Where("x"), 0.0)
        assert [f.code for f in judged_.findings] == codes and judged_.findings[0].ok is (
            mesh is sound
        )
        assert bool(judged_.sections) is (mesh is sound)
    assert judge_solid(two, meant, Where("x"), 0.0).findings[0].measured == 1


def test_what_a_way_back_leaves_nothing_of_is_told() -> None:
    thin = Shape(plate(20, 0.2), ())
    undone = expected(thin, print_change=PrintChange(0.0, -0.3, 0.0))
    finding = judged(undone, [thin.outer])["ROUND_TRIP"]
    assert math.isnan(finding.measured) and "nothing is left" in finding.message


def test_of_many_remarks_on_a_file_the_first_are_told() -> None:
    found = strange(Path("x.dxf"), [f"line {k} is open" for k in range(5)])
    assert not found.ok and math.isnan(found.measured)
    assert found.message == "line 0 is open; line 1 is open; line 2 is open; and 2 more"
    assert strange(Path("x.dxf"), ["a", "b", "c"]).message == "a; b; c"


@pytest.mark.parametrize("by, ok", [(1.9, True), (2.1, False)])
def test_an_engraved_contour_may_be_off_by_two_tolerances(by: float, ok: bool) -> None:
    """The file's and the outline's own; the worst of all contours counts."""
    nominal = [hole(0j, 10.0), hole(20 + 0j, 6.0)]
    found = [hole(by * TOLERANCE + 0j, 10.0), nominal[1]]
    said = [] if ok else [f"an engraved contour is {by * TOLERANCE:.4g} mm off"]
    assert _misdrawn(found, nominal, TOLERANCE) == said
    (few,) = _misdrawn(found[:1], nominal, TOLERANCE)
    assert few == "1 engraved contour instead of 2 (files.engrave)"
