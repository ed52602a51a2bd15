"""Crossed extrusions against closed forms, shapely and the solid's own mesh; rounded corners against their conditions."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from camgen.errors import DesignError
from camgen.geometry.crossing import Edge, chord, crossed_at, rounded, spread, volume
from camgen.geometry.facets import facet_contour
from camgen.geometry.mesh import Mesh, mesh_faults, slice_mesh
from camgen.geometry.outlines import Arc, Line, Region, circle, kidney, polygon
from camgen.geometry.rings import Ring, Shape
from camgen.parts.part import Layer, Part
from camgen.parts.solids import solid

PLATE = Region(polygon([-4, 4, 4 + 3j, -4 + 3j]), (circle(1 + 1.5j, 1),))
PILL = Region(kidney(0j, 3.0, 1.0, 0.2, 2.5))


def test_two_cylinders_cross_in_steinmetz_solid() -> None:
    disc = Region(circle(0j, 2.0))
    assert volume(disc, disc, -2, 2) == pytest.approx(16 / 3 * 8, rel=1e-12)
    assert volume(disc, disc, 0, 2) == pytest.approx(8 / 3 * 8, rel=1e-12)


def test_a_box_crossed_with_all_of_space_is_itself() -> None:
    wide = Region(polygon([-9 - 9j, 9 - 9j, 9 + 9j, -9 + 9j]))
    assert volume(PLATE, wide, 0, 2) == pytest.approx(2 * PLATE.area, rel=1e-12)
    (found,) = crossed_at(facetted(PLATE), facetted(wide), 0.7)
    assert area(found) == pytest.approx(PLATE.area, abs=1e-5) and len(found.holes) == 1


@pytest.mark.parametrize("region", [PLATE, PILL, Region(circle(1 + 1j, 2.0))])
def test_chords_by_shapely(region: Region) -> None:
    outer, *holes = [facet_contour(c, 1e-6) for c in (region.outer, *region.holes)]
    shape = shapely.Polygon(
        np.column_stack([outer.real, outer.imag]),
        [np.column_stack([h.real, h.imag]) for h in holes],
    )
    left, low, right, high = shape.bounds
    assert spread(region) == pytest.approx((low, high), abs=1e-5)
    for x in np.linspace(left + 0.011, right - 0.013, 37):
        line = shapely.LineString([(x, -50), (x, 50)])
        assert chord(region, np.array([x]))[0] == pytest.approx(
            shape.intersection(line).length, abs=5e-3
        )
        part = shape.intersection(shapely.box(x - 1, 0.5, x + 1, 1.7)).intersection(line).length
        assert chord(region, np.array([x]), 0.5, 1.7)[0] == pytest.approx(part, abs=5e-3)


def facetted(region: Region) -> Shape:
    outer, *holes = (
        Ring(z, np.zeros(len(z)))
        for z in (facet_contour(c, 1e-6) for c in (region.outer, *region.holes))
    )
    return Shape(outer, tuple(holes))


def area(shape: Shape) -> float:
    return abs(shape.outer.area) - sum(abs(hole.area) for hole in shape.holes)


def test_cut_has_a_piece_for_each_span() -> None:
    ring = Region(circle(0j, 4.0), (circle(0j, 1.0),))
    found = crossed_at(
        facetted(PLATE), facetted(ring), 0.0
    )  # where the ring's chords run, from -4 to -1 and from 1 to 4
    assert [area(shape) for shape in found] == pytest.approx([9.0, 9.0 - math.pi / 2], abs=1e-5)
    assert all(shape.holes == () for shape in found)


@pytest.mark.parametrize(
    "crossed", [Region(circle(2j, 2.0)), PILL, Region(polygon([-3, 3.5 + 1j, 2 + 3j, -2 + 4j]))]
)
def test_mesh_is_closed_and_as_large(crossed: Region) -> None:
    taller = Region(polygon([-4, 2, 2 + 4j, -4 + 3j]))
    part = Part("x", "X", (Layer(PLATE, 0, 1.3), Layer(taller, 1.3, 4)), side_profile=crossed)
    made = solid(part, 1e-4)
    faults = mesh_faults(made)
    assert faults.count == 0 and faults.bodies == 1
    assert np.array_equal(made.vertices, made.vertices.astype(np.float32))
    assert faults.volume == pytest.approx(part.volume, abs=part.walls * 1e-4)
    for z in (0.4, 0.9, 1.8, 2.6):
        region = PLATE if z < 1.3 else taller
        areas = [area(shape) for shape in crossed_at(facetted(region), facetted(crossed), z)]
        rings = slice_mesh(made, z)
        assert sum(r.area for r in rings) == pytest.approx(sum(areas), abs=0.05)
    again = solid(part, 1e-4)
    assert (
        made.vertices.tobytes() == again.vertices.tobytes()
        and made.faces.tobytes() == again.faces.tobytes()
    )


def test_crossed_that_misses_is_refused() -> None:
    part = Part("x", "X", (Layer(PLATE, 0, 1),), side_profile=Region(circle(20 + 0.5j, 1.0)))
    with pytest.raises(DesignError):
        solid(part, 1e-3)


@settings(max_examples=60)
@given(
    st.lists(st.floats(0.3, 1.0), min_size=3, max_size=7),
    st.floats(0.001, 0.08) | st.just(0.0),
    st.floats(0, 6),
)
def test_rounded_corners_are_tangent_to_their_edges(radii, radius, turn):  # type: ignore[no-untyped-def]
    n = len(radii)
    points = [3 * r * cmath.exp(1j * (turn + math.tau * k / n)) for k, r in enumerate(radii)]
    try:
        found = rounded(points, [radius] * n)
    except ValueError:
        return
    pieces = found.pieces
    for here, following in zip(pieces, pieces[1:] + pieces[:1], strict=True):
        if isinstance(here, Arc) or isinstance(following, Arc):
            into, out = complex(here.at(here.t1, 1)), complex(following.at(following.t0, 1))
            into *= math.copysign(1, here.t1 - here.t0)
            out *= math.copysign(1, following.t1 - following.t0)
            assert abs((into.conjugate() * out).imag) <= 1e-9 * abs(into) * abs(out)
            assert (into.conjugate() * out).real > 0
    for k in range(n if radius else 0):  # each edge's line is at the radius from the arc's centre
        arc = [p for p in pieces if isinstance(p, Arc)][k]
        for a, b in ((points[k - 1], points[k]), (points[k], points[(k + 1) % n])):
            way = (b - a) / abs(b - a)
            assert abs((way.conjugate() * (arc.centre - a)).imag) == pytest.approx(
                radius, abs=1e-12
            )
    assert all(isinstance(p, Line | Arc) for p in pieces)


def test_arc_that_does_not_fit_names_its_corner() -> None:
    with pytest.raises(ValueError) as caught:
        rounded([0, 1, 1 + 1j, 1j], [0, 0.6, 0.6, 0])
    corner, share = caught.value.args
    assert corner == 1 and share == pytest.approx(0.5 / 0.6)
    rounded([0, 1, 1 + 1j, 1j], [0, 0.5, 0.5, 0])


# ---- rounded edges ---------------------------------------------------------------------------------------------------

WAY = ((1.0, 2.0, 1.5, 0.2), (3.0, 2.0, 1.5, 0.5), (6.0, 2.0, 1.5, 0.5), (7.0, 2.0, 1.5, 0.1))


@pytest.mark.parametrize(("up", "out"), [(1, 1), (1, -1), (-1, 1), (-1, -1)])
@pytest.mark.parametrize("mirror", [False, True])
def test_edge_of_a_box_is_an_arc_in_every_plane_across(up: int, out: int, mirror: bool) -> None:
    """A box with one rounded edge: cut across x, its corner is a quarter disc tangent to both sides; volume by its formula."""
    edge = Edge(tuple((x, up * y, out * z, r) for x, y, z, r in WAY), up, out)
    low, high, side = (
        (0.0, 1.5, -1 if mirror else 1) if out > 0 else (-1.5, 0.0, -1 if mirror else 1)
    )
    box = Region(polygon([0 - 2j, 8 - 2j, 8 + 2j, 0 + 2j]).moved(side, mirror=mirror))
    wide = Region(polygon([-9 - 9j, 9 - 9j, 9 + 9j, -9 + 9j]))
    part = Part(
        "x",
        "X",
        (Layer(box, low, high),),
        side_profile=wide,
        edges=(edge.mirrored if mirror else edge,),
    )
    mesh = solid(part, 1e-4)
    assert mesh_faults(mesh).count == 0
    assert part.volume == pytest.approx(
        48 - (1 - math.pi / 4) * (2 * 0.13 + 3 * 0.25 + 0.31 / 3), abs=1e-12
    )
    assert mesh_faults(mesh).volume == pytest.approx(part.volume, abs=2e-3)
    turned = Mesh(mesh.vertices[:, [1, 2, 0]], mesh.faces)
    for x, r in ((2.0, 0.35), (4.5, 0.5), (6.5, 0.3)):
        (ring,) = slice_mesh(turned, side * x)
        found = shapely.Polygon(np.column_stack([ring.points.real, ring.points.imag]))
        corner = shapely.Point(up * (2 - r), out * (1.5 - r)).buffer(r, quad_segs=300)
        square = shapely.box(
            min(up * (2 - r), up * 2),
            min(out * (1.5 - r), out * 1.5),
            max(up * (2 - r), up * 2),
            max(out * (1.5 - r), out * 1.5),
        )
        wanted = shapely.box(-2, low, 2, high).difference(square).union(corner.intersection(square))
        assert found.exterior.hausdorff_distance(wanted.exterior) <= 2e-4
