"""Every contour of every section is judged: damages of holes, rims, tips, chamfers, pockets, slits and spikes are told.

A damaged part is written by the tool's own writers, and judged as the sound one.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import get_args

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapes import polygon as polygon_ring

from camgen.files.dxf import write_dxf
from camgen.files.formats import Curves
from camgen.files.stl import write_stl
from camgen.findings import Where
from camgen.geometry.facets import facet_contour
from camgen.geometry.mesh import Mesh
from camgen.geometry.outlines import Region, polygon
from camgen.geometry.rings import Ring, Shape
from camgen.judge.cams import judged_angles
from camgen.judge.contours import contour_error
from camgen.judge.joints import Nominal
from camgen.judge.measured import Files
from camgen.judge.motion import judge_machine
from camgen.judge.round_trip import judge_drawing, judge_mesh
from camgen.machine.features import CamOutline
from camgen.machines.mechanism import Mechanism
from camgen.parts.fits import compensated
from camgen.parts.part import Layer, Part
from camgen.parts.solids import solid
from camgen.pipeline.build import read_mechanism
from camgen.pipeline.expectation import nominal_part
from camgen.pipeline.making import compensation

SPECS = Path(__file__).resolve().parents[2] / "specs"
MACHINES = {
    "take-up": ("thread-take-up", ()),
    "eccentric": ("eccentric-drive", ()),
    "groove": ("disc-cam", ('geometry.closure="groove"', "parts.hub_height=0")),
    "swing": ("uniform-swing", ("frame.tip='plate'",)),
    "foot": (
        "disc-cam",
        (
            "print.elephant_foot=0.3",
            "print.hole_compensation=0.1",
            "print.profile_compensation=0.12",
        ),
    ),
    "grown holes": (
        "uniform-swing",
        ("parts.make='cams'", "print.hole_compensation=0.1", "print.shrinkage=0.004"),
    ),
    "looper": ("chain-stitch-looper", ()),
    "knife": ("disc-cam", ('geometry.follower={motion="translating",shape="knife"}',)),
}
Face = shapely.Polygon
Damage = Callable[[Face], Face]


@cache
def machine(name: str) -> Mechanism:
    spec, settings = MACHINES[name]
    return read_mechanism(SPECS / f"{spec}.toml", settings)


def part_of(name: str, part: str) -> Part:
    return next(one for one in machine(name).assembly.parts if one.name == part)


def corners(points: np.ndarray) -> np.ndarray:
    return np.column_stack([points.real, points.imag])


def face_of(region: Region) -> Face:
    outer, *holes = (corners(facet_contour(c, 0.0005)) for c in (region.outer, *region.holes))
    return shapely.Polygon(outer, holes)


def region_of(face: Face) -> Region:
    rings = [
        polygon([complex(*z) for z in ring.coords[:-1]])
        for ring in (face.exterior, *face.interiors)
    ]
    return Region(rings[0], tuple(rings[1:]))


def damaged(part: Part, damage: Damage, at: Callable[[Layer], bool] = lambda layer: True) -> Part:
    """The part with the regions of those layers changed."""
    layers = [
        replace(x, region=region_of(damage(face_of(x.region)))) if at(x) else x for x in part.layers
    ]
    return replace(part, layers=tuple(layers))


def failing(name: str, part: str, kind: str, made: Part, folder: Path) -> set[str]:
    """Codes that fail where the file of a part holds another one; with fits the one that was sent."""
    mechanism, path = machine(name), folder / f"x.{kind}"
    tolerance = mechanism.accuracy.chord_tolerance
    if kind == "dxf":
        write_dxf(path, made.region, (), tolerance, "lines")
    else:
        write_stl(path, solid(made, tolerance), "x")
    fit = compensation(mechanism) if kind != "dxf" else None
    meant = nominal_part(part_of(name, part), tolerance, mechanism.assembly.features, fit)
    judged = (judge_drawing if kind == "dxf" else judge_mesh)(path, meant)
    return {finding.code for finding in judged.findings if not finding.ok}


def sent(name: str, part: str) -> Part:
    fit = compensation(machine(name))
    return compensated(part_of(name, part), fit) if fit is not None else part_of(name, part)


def disc(at: complex, radius: float) -> Face:
    return shapely.Point(at.real, at.imag).buffer(radius, quad_segs=180)


def widened(at: complex, radius: float) -> Damage:
    """A hole drilled larger."""
    return lambda face: face.difference(disc(at, radius))


def dented(at: complex, by: complex) -> Damage:
    """The corner nearest to a place moved; of the outline or of a hole."""

    def damage(face: Face) -> Face:
        points = shapely.get_coordinates(face)
        nearest = points[np.argmin(np.hypot(*(points - [at.real, at.imag]).T))]

        def shifted(z: np.ndarray) -> np.ndarray:
            return np.where((z == nearest).all(axis=1)[:, None], z + [by.real, by.imag], z)

        return shapely.transform(face, shifted)

    return damage


def slit(begin: complex, end: complex, width: float, void: float = 0.0) -> Damage:
    """A cut between two places, square at its ends, and a round void at its end."""

    def damage(face: Face) -> Face:
        line = shapely.LineString(corners(np.array([begin, end]))).buffer(
            width / 2, cap_style="flat"
        )
        return face.difference(shapely.union_all([line, disc(end, void)]) if void else line)

    return damage


@pytest.mark.long
@pytest.mark.parametrize("kind", ["dxf", "stl"])
@pytest.mark.parametrize(
    ("name", "part"),
    [
        ("take-up", "ground"),
        ("eccentric", "disc"),
        ("groove", "outer"),
        ("groove", "inner"),
        ("swing", "frame"),
        ("foot", "cam"),
        ("grown holes", "cam"),
        ("looper", "upper-spreader"),
    ],
)
def test_sound_parts_pass(name: str, part: str, kind: str, tmp_path: Path) -> None:
    assert (
        failing(
            name, part, kind, part_of(name, part) if kind == "dxf" else sent(name, part), tmp_path
        )
        == set()
    )


@pytest.mark.long
@pytest.mark.parametrize("kind", ["dxf", "stl"])
@pytest.mark.parametrize(
    ("name", "part", "damage"),
    [
        pytest.param("take-up", "ground", widened(-80 + 160j, 1.2), id="a thread guide too wide"),
        pytest.param(
            "take-up", "ground", dented(40 + 14j, -0.3j), id="a corner of a hole outwards"
        ),
        pytest.param("take-up", "ground", dented(40 + 14j, 0.3j), id="a corner of a hole inwards"),
        pytest.param("take-up", "output", dented(30 + 1.75j, 0.1j), id="a dent in a joint"),
        pytest.param(
            "groove", "outer", lambda face: larger(face), id="a groove plate 5 mm too wide"
        ),
        pytest.param("groove", "outer", slit(-80 + 1j, -47 + 1j, 0.12), id="a slit"),
        pytest.param(
            "groove",
            "outer",
            slit(-80 + 1j, -47 + 1j, 0.12, 3.0),
            id="a slit that opens into a void",
        ),
        pytest.param(
            "groove", "inner", slit(40 + 2j, 20 + 2j, 0.12), id="a slit in the groove's inner wall"
        ),
        pytest.param(
            "groove",
            "inner",
            slit(-60 + 5j, -14 + 5j, 0.12, 2.0),
            id="a slit in a rolled part that opens into a void",
        ),
        pytest.param("swing", "frame", lambda face: gouged(face), id="a gouge in the rolling tip"),
    ],
)
def test_a_damaged_contour_is_told(
    name: str, part: str, damage: Damage, kind: str, tmp_path: Path
) -> None:
    made = damaged(part_of(name, part), damage)
    assert (
        abs(made.region.area - damaged(part_of(name, part), lambda face: face).region.area) > 1e-3
    )
    assert "ROUND_TRIP" in failing(name, part, kind, made, tmp_path)


def larger(face: Face) -> Face:
    """5 mm more all round, the holes as they are."""
    return shapely.Polygon(shapely.Polygon(face.exterior).buffer(5).exterior, face.interiors)


def gouged(face: Face) -> Face:
    """1 mm deep in the middle of the frame's tip, which still touches the cam beside it."""
    tip = next(
        c.own.tip
        for c in machine("swing").assembly.features
        if isinstance(c, CamOutline) and c.own is not None
    )
    return face.difference(disc(tip.at + 0.5j * tip.diameter, 1.0))


def test_a_contour_about_a_joint_is_told(tmp_path: Path) -> None:
    """The flange of the eccentric's disc, centred on the joint as its pin is, with a corner 0.3 mm out."""
    whole = part_of("eccentric", "disc")
    made = damaged(whole, dented(1.5 + 6.6j, 0.3j), lambda layer: layer.z0 == 0)
    assert failing("eccentric", "disc", "stl", made, tmp_path) == {"ROUND_TRIP"}


@pytest.mark.long
def test_a_bore_that_is_aside_in_the_hub_alone_is_told(tmp_path: Path) -> None:
    """A follower runs on the plate below, whose bore is where it belongs."""
    whole = sent("foot", "cam")

    def shifted(face: Face) -> Face:
        holes = [shapely.transform(hole, lambda z: z + 0.1) for hole in face.interiors]
        return shapely.Polygon(face.exterior, holes)

    top = max(layer.z1 for layer in whole.layers)
    made = damaged(whole, shifted, lambda layer: layer.z1 == top)
    assert failing("foot", "cam", "stl", made, tmp_path) == {"ROUND_TRIP"}


@pytest.mark.long
@pytest.mark.parametrize(
    "damage", [lambda f: f.buffer(2.6), lambda f: f.buffer(0.2), widened(0j, 9)]
)
def test_a_wrong_chamfer_is_told(damage: Damage, tmp_path: Path) -> None:
    """An edge far beyond the outline, hardly a chamfer, and a bore that is chamfered too far, below the chamfer's top alone."""
    whole = sent("foot", "cam")
    made = damaged(whole, damage, lambda layer: layer.z1 < 0.31)
    assert made.volume != whole.volume
    assert "ROUND_TRIP" in failing("foot", "cam", "stl", made, tmp_path)


@pytest.mark.long
def test_a_chamfer_that_is_hardly_one_is_told(tmp_path: Path) -> None:
    """Its steps stand at the right heights, and no check but that of contours sees them."""
    whole = sent("foot", "cam")
    full = face_of(next(layer.region for layer in whole.layers if layer.z0 > 0.29))
    steps = [
        replace(x, region=region_of(full.buffer(-0.02 + 0.01 * k)))
        for k, x in enumerate(whole.layers)
        if x.z1 < 0.31
    ]
    made = replace(whole, layers=(*steps, *whole.layers[len(steps) :]))
    assert len(steps) == 2 and failing("foot", "cam", "stl", made, tmp_path) >= {"ROUND_TRIP"}


def test_a_pocket_beside_grown_holes_is_told(tmp_path: Path) -> None:
    """As deep as the engraved arrow, so that no face lies at another height."""
    whole = sent("grown holes", "cam")
    (arrow,) = whole.engraved
    pocket = region_of(disc(arrow.region.outer.centroid, 3.5).difference(disc(0j, 4)))
    made = replace(whole, engraved=(replace(arrow, region=pocket),))
    assert "ROUND_TRIP" in failing("grown holes", "cam", "stl", made, tmp_path)


@pytest.mark.parametrize("by", [0.02, -0.02])
def test_a_top_face_at_another_height_is_told(by: float, tmp_path: Path) -> None:
    """A crossed body, some of whose faces lean, so that only its lowest and its highest place are known."""
    mechanism, whole = machine("looper"), part_of("looper", "upper-spreader")
    tolerance = mechanism.accuracy.chord_tolerance
    mesh = solid(whole, tolerance)
    vertices = mesh.vertices.copy()
    vertices[np.isclose(vertices[:, 2], vertices[:, 2].max()), 2] += by
    write_stl(tmp_path / "x.stl", Mesh(vertices, mesh.faces), "x")
    judged = judge_mesh(
        tmp_path / "x.stl", nominal_part(whole, tolerance, mechanism.assembly.features)
    )
    assert {finding.code for finding in judged.findings if not finding.ok} == {"ROUND_TRIP"}


def test_a_notch_between_the_usual_heights_is_told(tmp_path: Path) -> None:
    """0.2 mm high and 2 mm deep, into the far end of a crossed body whose walls need not be upright; its volume is as meant."""
    mechanism, part = machine("looper"), part_of("looper", "upper-spreader")
    tolerance, whole = mechanism.accuracy.chord_tolerance, replace(part, edges=())
    assert whole.side_profile is not None
    face = shapely.Polygon(
        [(z.real, z.imag) for z in facet_contour(whole.side_profile.outer, tolerance)]
    )
    for notched in (
        face,
        face.difference(shapely.box(face.bounds[2] - 2, 3.95, face.bounds[2] + 1, 4.15)),
    ):
        made = replace(whole, side_profile=region_of(notched))
        write_stl(tmp_path / "x.stl", solid(made, tolerance), "x")
        judged = judge_mesh(
            tmp_path / "x.stl",
            replace(
                nominal_part(whole, tolerance, mechanism.assembly.features), volume=made.volume
            ),
        )
        told = {finding.code for finding in judged.findings if not finding.ok}
        assert told == ({"ROUND_TRIP"} if notched is not face else set())


def test_a_slit_whose_corners_all_lie_on_the_outline_is_told(tmp_path: Path) -> None:
    """1 um wide, from side to side but for 1 um at its end: each of its corners is on the outline, and its area is nothing."""
    square = shapely.box(-5, -5, 5, 5)
    plate = replace(
        part_of("groove", "back"),
        layers=(Layer(region_of(square), 0.0, 3.0),),
        bore=None,
        min_wall=0.0,
    )
    path = tmp_path / "x.dxf"
    for face, codes in (
        (square, set()),
        (square.difference(shapely.box(-6, -1, 4.999, -0.999)), {"ROUND_TRIP"}),
    ):
        write_dxf(path, region_of(face), (), 0.001, "lines")
        judged = judge_drawing(path, nominal_part(plate, 0.001))
        assert {finding.code for finding in judged.findings if not finding.ok} == codes


@pytest.mark.parametrize("asked", ["bulge", "lines", "arcs", "spline"])
def test_a_drawing_is_of_the_curves_that_the_spec_asks_for(tmp_path: Path, asked: Curves) -> None:
    """Polylines and circles are closed entities whatever else is asked for; lines and arcs, or splines, only where they are."""
    part = part_of("knife", "cam")
    path = tmp_path / "cam.dxf"
    meant = replace(nominal_part(part, 0.001), curves=asked)
    others = {"arcs", "spline"} - {asked}
    for curves in get_args(Curves):
        write_dxf(path, part.region, (), 0.001, curves)
        failing = {each.code for each in judge_drawing(path, meant).findings if not each.ok}
        assert failing == ({"DXF_CLOSED"} if curves in others else set())


# ---- knife edges -----------------------------------------------------------------------------------------------------


def test_a_spike_between_the_judged_angles_is_told() -> None:
    """1 mm high and 0.03 deg wide, in the widest gap between the fixed angles, where a knife edge stands on it."""
    mechanism = machine("knife")
    tolerance = mechanism.accuracy.chord_tolerance
    ring = facet_contour(mechanism.assembly.parts[0].region.outer, tolerance)
    theta = judged_angles()
    gap = int(np.argmax(np.diff(theta)))
    assert math.degrees(theta[gap + 1] - theta[gap]) > 0.04
    where = (
        math.pi / 2 - (theta[gap] + theta[gap + 1]) / 2
    )  # the follower slides along Oy, its line through the shaft
    half, ray = math.radians(0.015), np.exp(1j * np.angle(ring))

    def at(angle: float) -> complex:
        near = np.argsort(np.abs(np.angle(ray * np.exp(-1j * angle))))[:2]
        a, b = ring[near]
        away = np.exp(1j * angle)
        share = (np.conj(away) * a).imag / (np.conj(away) * (a - b)).imag
        return complex(a + share * (b - a))

    turned = np.angle(ring * np.exp(-1j * where))
    kept = ring[np.abs(turned) > half]
    order = np.argsort(np.angle(kept * np.exp(-1j * (where + math.pi))))
    top = at(where)
    spiked = np.concatenate(
        [kept[order], [at(where - half), top * (1 + 1 / abs(top)), at(where + half)]]
    )
    spiked = spiked[np.argsort(np.angle(spiked * np.exp(-1j * where)) % math.tau)]
    for points, told in ((kept[order], False), (spiked, True)):
        shape = Shape(Ring(points, np.zeros(len(points))).counter_clockwise(), ())
        features = [
            replace(each, bore=None)
            for each in mechanism.assembly.features
            if isinstance(each, CamOutline)
        ]
        findings = judge_machine(
            Nominal(mechanism.model, features, mechanism.assembly.mounts),
            Files("dxf", Where(file="x.dxf"), {"cam": [[shape]]}),
            theta,
            tolerance,
        ).findings
        assert (not findings[0].ok) is told and findings[0].code == "MOTION_ERROR"
    assert findings[0].measured == pytest.approx(1.0, abs=0.01)


# ---- how far a contour is from another one -------------------------------------------------------------------------------


@settings(max_examples=30)
@given(
    steps=st.lists(st.floats(0.3, 1.2), min_size=4, max_size=9),
    by=st.complex_numbers(max_magnitude=0.3),
    dent=st.complex_numbers(max_magnitude=3),
    start=st.integers(0, 9),
)
def test_contours_are_apart_by_the_largest_distance(
    steps: list[float], by: complex, dent: complex, start: int
) -> None:
    """A polygon shifted, one corner dented, and begun elsewhere: as far as shapely's Hausdorff distance tells, from points a
    quarter of a millimetre apart."""
    phi = 2 * math.pi * np.cumsum(steps) / sum(steps)
    meant = polygon_ring(20 * np.exp(1j * phi))
    z = meant.points + by
    z[1] += dent
    z = np.roll(z, start % len(z))
    apart = float(
        shapely.hausdorff_distance(
            *(shapely.LinearRing(corners(np.append(p, p[0]))) for p in (z, meant.points)), 0.01
        )
    )
    found = contour_error(polygon_ring(z), meant, 1e-3)
    assert apart - 0.15 <= found <= apart + 1e-9


@pytest.mark.parametrize("size, off", [(1e-9, 1e-9), (1e-3, 1e-3)])
def test_contours_of_the_same_vertices_are_apart_by_them(size: float, off: float) -> None:
    """Arcs too: a disc that is larger by a hair, and one whose area alone tells."""
    arcs = Ring(np.array([9, -9 + 0j]), np.ones(2))
    assert contour_error(
        Ring(arcs.points * (1 + size / 9), arcs.bulges), arcs, 1e-3
    ) == pytest.approx(off, rel=0.01)
    wider = Ring(arcs.points, arcs.bulges * (1 + size))
    grown = abs(wider.area - arcs.area) / arcs.length
    assert contour_error(wider, arcs, 1e-3) >= grown * (1 - 1e-9) > 0


def test_a_contour_turned_by_half_a_turn_is_another_one() -> None:
    """About the origin, vertex by vertex: the corner of an L is as far from the other's edges as its notch is deep."""
    shape = np.array([-10 - 10j, 10 - 10j, 10 + 0j, 4 + 0j, 4 + 10j, -10 + 10j])
    assert contour_error(polygon_ring(-shape), polygon_ring(shape), 1e-3) == pytest.approx(
        6.0, abs=1e-9
    )


def test_a_slit_between_vertices_is_found() -> None:
    """0.3 mm wide and 8 mm deep, in the middle of a side of 400 mm that has no other vertex: one way only its ends tell."""
    meant = polygon_ring(np.array([0, 400, 400 + 60j, 60j]))
    slit = np.array(
        [0, 200 - 0.15, 200 - 0.15 + 8j, 200 + 0.15 + 8j, 200 + 0.15, 400, 400 + 60j, 60j]
    )
    for one, other in ((polygon_ring(slit), meant), (meant, polygon_ring(slit))):
        assert contour_error(one, other, 1e-3) == pytest.approx(8.0, abs=0.02)
    thin = np.array(
        [0, 400, 400 + 60j, 300 + 60j, 300 + 60.2j, 100 + 60.2j, 100 + 60j, 60j]
    )  # a step of 0.2 mm along a side
    assert contour_error(polygon_ring(thin), meant, 1e-3) == pytest.approx(0.2, abs=1e-9)
