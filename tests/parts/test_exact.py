"""Exact solids: closed, with the volume of Green's theorem, the outlines of the layers; refused where there is none."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from test_solids import cam, hub

from camgen.errors import DesignError
from camgen.geometry.brep import Brep, Face
from camgen.geometry.outlines import Arc, Contour, Line, Region, circle, kidney, polygon, rectangle
from camgen.geometry.rings import Shape, shape_of
from camgen.parts.exact import exact
from camgen.parts.part import Layer, Part, hull

TOLERANCE = 1e-4


def stack(*layers, engraved=()):
    return Part("stack", "Stack", layers, engraved=engraved)


def euler(body):
    """Euler's characteristic with a hole in a face counted as a cut: 2 less twice the number of handles."""
    return len(body.corners) - len(body.edges) + sum(2 - len(face.loops) for face in body.faces)


def sound(body):
    assert body.faults == 0 and body.bodies == 1
    slabs = zip(body.heights, body.heights[1:], strict=False)
    volume = sum((b - a) * ring.area for a, b in slabs for ring in body.section((a + b) / 2))
    assert body.volume == pytest.approx(volume, rel=1e-12)
    return body


@pytest.mark.parametrize("part", [cam(), hub()], ids=lambda part: part.name)
def test_machine_parts(part):
    body = sound(exact(part, TOLERANCE))
    assert abs(body.volume - part.volume) < part.walls * TOLERANCE
    assert body.heights.tolist() == sorted(
        {z for layer in (*part.layers, *part.engraved) for z in (layer.z0, layer.z1)}
    )


def test_a_box_and_a_tube():
    box = sound(exact(stack(Layer(Region(rectangle(0, 3 + 2j)), 1, 5)), TOLERANCE))
    assert (len(box.corners), len(box.edges), len(box.faces)) == (
        8,
        12,
        6,
    ) and box.volume == pytest.approx(24, rel=1e-15)
    tube = sound(exact(stack(Layer(Region(circle(1j, 5), (circle(1j, 2),)), 0, 3)), TOLERANCE))
    assert tube.volume == pytest.approx(3 * math.pi * 21, rel=1e-14) and euler(tube) == 0
    assert {round(edge.radius, 12) for edge in tube.edges if edge.radius} == {5.0, 2.0}


def test_a_wall_through_equal_layers_is_one_face():
    ring = Region(circle(0, 5), (circle(0, 2),))
    one, two = (
        exact(stack(Layer(ring, 0, 4)), TOLERANCE),
        exact(stack(Layer(ring, 0, 1), Layer(ring, 1, 4)), TOLERANCE),
    )
    assert len(one.faces) == len(two.faces) and two.volume == pytest.approx(one.volume, rel=1e-14)


def level_faces(body: Brep, looks: int, height: float) -> list[Shape]:
    """Those at a height that look up (+1) or down (-1)."""
    return [
        shape_of([body.ring(loop) for loop in face.loops])
        for face in body.faces
        if face.looks == looks and body.corners[body.first(face.loops[0][0]), 2] == height
    ]


def test_a_boss_on_a_bar_touches_its_edge_along_an_arc():
    bar = hull([(0j, 5.0), (20 + 0j, 4.0)])
    part = stack(
        Layer(Region(bar, (circle(0, 2),)), 0, 4),
        Layer(Region(circle(0, 5), (circle(0, 2),)), 4, 9),
    )
    body = sound(exact(part, TOLERANCE))
    assert body.volume == pytest.approx(part.volume, rel=1e-12)
    (shoulder,) = [shape for shape in level_faces(body, 1, 4.0)]
    assert shoulder.area == pytest.approx(
        bar.area - math.pi * 25, rel=1e-12
    )  # the boss leaves it without a rim beyond its own


@settings(max_examples=25)
@given(st.floats(-9, 9), st.floats(-9, 9), st.floats(1, 6), st.floats(0, 3))
def test_outlines_that_cross_anywhere(x, y, radius, turn):
    """Volumes add up, whether the outlines cross, one holds the other or they are apart, which is then refused."""
    square = Region(rectangle(-5 - 5j, 5 + 5j))
    other = Region(
        polygon([complex(x, y) + radius * np.exp(1j * (turn + math.tau * k / 5)) for k in range(5)])
    )
    disc = Region(circle(complex(y, x), radius))
    part = stack(Layer(square, 0, 2), Layer(other, 2, 3), Layer(disc, -1, 0))
    try:
        body = exact(part, TOLERANCE)
    except DesignError as error:
        assert "bodies" in error.quantity or "edges" in error.quantity
        far = max(abs(x), abs(y)) > 5 - radius  # apart, or touching
        assert far
        return
    assert sound(body).volume == pytest.approx(part.volume, rel=1e-9)


def test_letters_are_cut_in():
    plate = Layer(Region(rectangle(0, 30 + 10j), (circle(25 + 5j, 2),)), 0, 4)
    ring = Layer(Region(circle(8 + 5j, 3), (circle(8 + 5j, 1.5),)), 3.5, 4)
    slot = Layer(Region(kidney(16 + 0j, 5, 1, 1.2, 0.8)), 3.5, 4.5)  # reaches over the top
    part = stack(plate, engraved=(ring, slot))
    body = sound(exact(part, TOLERANCE))
    taken = 0.5 * (ring.region.area + slot.region.area)
    assert body.volume == pytest.approx(plate.volume - taken, rel=1e-12)
    assert (
        len(level_faces(body, 1, 4.0)) == 2 and len(level_faces(body, 1, 3.5)) == 2
    )  # the letter's island; two floors


def test_nearly_equal_outlines_are_one():
    """Circles that different routes give 5.6e-7 mm apart leave no sliver."""
    part = stack(Layer(Region(circle(0, 5)), 0, 2), Layer(Region(circle(3e-7, 5 + 2.6e-7)), 2, 4))
    body = sound(exact(part, TOLERANCE))
    assert body.volume == pytest.approx(part.volume, rel=1e-6)
    assert not level_faces(body, 1, 2.0) and not level_faces(body, -1, 2.0)


def test_what_is_refused():
    crossed = Part(
        "x", "X", (Layer(Region(rectangle(0, 1 + 1j)), 0, 1),), side_profile=Region(circle(0, 1))
    )
    with pytest.raises(DesignError, match="crosswise.*take its STL"):
        exact(crossed, TOLERANCE)
    apart = stack(Layer(Region(circle(0, 1)), 0, 1), Layer(Region(circle(5, 1)), 1, 2))
    with pytest.raises(DesignError, match="bodies and cavities of stack is 2"):
        exact(apart, TOLERANCE)
    hollow = stack(
        *(
            Layer(Region(circle(0, 5), (circle(0, 2),) if k == 1 else ()), k, k + 1)
            for k in range(3)
        )
    )
    with pytest.raises(DesignError, match="cavities"):
        exact(hollow, TOLERANCE)
    edge_to_edge = stack(
        Layer(Region(rectangle(0, 1 + 1j)), 0, 1), Layer(Region(rectangle(1, 2 + 1j)), 1, 2)
    )
    with pytest.raises(DesignError, match="more than two faces"):
        exact(edge_to_edge, TOLERANCE)


def test_faults_are_counted():
    body = exact(stack(Layer(Region(circle(0, 5)), 0, 2)), TOLERANCE)
    assert Brep(body.corners, body.edges, body.faces[1:]).faults > 0
    turned = Face(
        0, (tuple((edge, not forward) for edge, forward in reversed(body.faces[-1].loops[0])),)
    )
    assert Brep(body.corners, body.edges, [*body.faces[:-1], turned]).faults > 0
    split = Contour((Arc(0j, 5, 0, math.pi), Line(-5 + 0j, 5 + 0j)))
    assert exact(stack(Layer(Region(split), 0, 2)), TOLERANCE).volume == pytest.approx(25 * math.pi)
