"""Rings of lines and arcs, shapes and bores: closed forms of circles and polygons."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgen.geometry.rings import Ring, bore_circle, fit_circle, hole_circles, shape_of

SQUARE = np.array([0, 10, 10 + 10j, 10j], complex)


def straight(points: np.ndarray) -> Ring:
    return Ring(np.asarray(points, complex), np.zeros(len(points)))


def regular(count: int, radius: float = 10.0, centre: complex = 0j) -> np.ndarray:
    return centre + radius * np.exp(2j * np.pi * (np.arange(count) + 0.3) / count)


@given(
    st.floats(0.01, 1e3),
    st.complex_numbers(max_magnitude=1e3),
    st.lists(st.floats(0.05, 6), min_size=2, max_size=40),
)
def test_a_circle_in_any_arcs(radius: float, centre: complex, steps: list[float]) -> None:
    """Area, length, box and facets of a circle cut into arcs of any sizes below a full turn, either way round."""
    sweep = np.array(steps) / sum(steps) * 2 * np.pi
    start = np.cumsum(sweep) - sweep
    ring = Ring(centre + radius * np.exp(1j * start), np.tan(sweep / 4))
    for one, sign in ((ring, 1), (ring.reversed(), -1), (ring.moved(1j, 3, mirror=True), 1)):
        assert one.area == pytest.approx(sign * np.pi * radius**2, rel=1e-9)
        assert one.length == pytest.approx(2 * np.pi * radius, rel=1e-9)
    size = radius + abs(centre)
    expected = [
        centre.real - radius,
        centre.imag - radius,
        centre.real + radius,
        centre.imag + radius,
    ]
    np.testing.assert_allclose(ring.box, expected, atol=1e-9 * size)
    for tolerance in (0.1 * radius, 1e-3 * radius):
        z = ring.facetted(tolerance)
        middles = np.abs((z + np.roll(z, -1)) / 2 - centre)
        assert np.max(np.abs(np.abs(z - centre) - radius)) < 1e-9 * size
        assert radius - middles.min() < tolerance * (1 + 1e-6) + 1e-9 * size
    assert ring.encloses(centre + 0.9 * radius) and not ring.encloses(centre + 1.2 * radius)


def test_nearly_straight_arcs_keep_their_area() -> None:
    """Bulges from 1e-12 to 0.05: the area between arc and chord, against its series 2 b c^2 / 6 (1 + b^2 / 5)."""
    for bulge in (1e-12, 1e-6, 1e-3, 0.0099, 0.0101, 0.05):
        lens = Ring(np.array([0, 1 + 0j]), np.array([bulge, bulge]))
        assert lens.area == pytest.approx(
            2 * (bulge / 3 + bulge**3 / 15 - bulge**5 / 105), rel=1e-9
        )


def test_flip_keeps_the_sense_and_moves_the_points() -> None:
    ring = Ring(SQUARE, np.array([0.2, 0, -0.3, 0]))
    flipped = ring.moved(-1, 0, mirror=True)
    assert flipped.area == pytest.approx(ring.area, rel=1e-14) and ring.area > 0
    np.testing.assert_array_equal(flipped.points, -np.conj(SQUARE)[::-1])
    expected = np.sort(-np.conj(ring.samples()))
    np.testing.assert_allclose(np.sort(flipped.samples()), expected, atol=1e-14)


def test_shape_sorts_outside_from_holes() -> None:
    hole, far = straight(2 + 2j + SQUARE / 10), straight(SQUARE + 50)
    shape = shape_of([hole, straight(SQUARE[::-1])])
    assert shape.outer.area == 100 and shape.area == 99 and shape.holes == (hole,)
    assert shape.moved(1j, 2, mirror=True).area == pytest.approx(99)
    with pytest.raises(ValueError, match="1 contour"):
        shape_of([straight(SQUARE), straight(far.points / 2 + 50)])
    with pytest.raises(ValueError, match="no closed contour"):
        shape_of([])


# ---- circles ----


@given(
    st.floats(0.5, 500),
    st.complex_numbers(max_magnitude=1e3),
    st.floats(0.8, 6.28),
    st.integers(4, 50),
)
def test_circle_through_points_of_an_arc(
    radius: float, centre: complex, span: float, count: int
) -> None:
    z = centre + radius * np.exp(1j * np.linspace(0.1, 0.1 + span, count))
    found, r, deviation = fit_circle(z)
    size = radius + abs(centre)
    assert (
        abs(found - centre) < 1e-11 * size
        and abs(r - radius) < 1e-11 * size
        and deviation < 1e-12 * size
    )


def test_circle_fit_reports_a_point_that_is_off() -> None:
    z = regular(40)
    z[3] *= 1.001
    assert 0.009 < fit_circle(z)[2] < 0.01
    assert np.isnan(fit_circle(z[:2])[1])


def test_holes_of_a_shape() -> None:
    """A DXF circle is exact; a facetted hole with its vertices on the circle lets a smaller pin through."""
    drilled = Ring(4 + 4j + 1.5 * np.array([1, -1 + 0j]), np.ones(2))
    facetted = straight(regular(12, 1.0, 7 + 7j)[::-1])
    exact, flat = hole_circles(shape_of([straight(SQUARE), drilled, facetted]))
    assert exact.centre == pytest.approx(4 + 4j, abs=1e-14) and exact.diameter == pytest.approx(
        3, abs=1e-14
    )
    assert exact.deviation < 1e-14 and exact.clear_diameter == pytest.approx(3, abs=1e-14)
    assert flat.diameter == pytest.approx(2, abs=1e-14)
    assert flat.clear_diameter == pytest.approx(2 * np.cos(np.pi / 12), abs=1e-14)


@pytest.mark.parametrize("facets", [0, 48, 200])
@pytest.mark.parametrize("kind", ["keyway", "flat", "plain"])
def test_bores(kind: str, facets: int) -> None:
    """An 8 mm bore with keyway, flat or neither, off the origin by (0.3, -0.2): found to 1e-9 mm, DXF and facets."""
    start = {"keyway": np.arcsin(1.5 / 4), "flat": np.arccos(3.4 / 4), "plain": 0.0}[kind]
    sweep = 2 * np.pi - 2 * start
    corner = {"keyway": [5.5 - 1.5j, 5.5 + 1.5j], "flat": [], "plain": []}[kind]
    if facets:
        arc = 4 * np.exp(1j * (start + sweep * np.arange(facets + (kind != "plain")) / facets))
        ring = straight(np.concatenate([arc, corner]) + 0.3 - 0.2j)
    else:
        arc = 4 * np.exp(
            1j * (start + sweep * np.array([0, 0.5, 1])[: 2 if kind == "plain" else 3])
        )
        bulges = [np.tan(sweep / 8)] * 2 + [0.0] * (len(arc) - 2 + len(corner))
        ring = Ring(np.concatenate([arc, corner]) + 0.3 - 0.2j, np.array(bulges))
    for one in (ring, ring.reversed()):
        found = bore_circle(one, 8.0)
        assert found.centre == pytest.approx(0.3 - 0.2j, abs=1e-9)
        assert found.diameter == pytest.approx(8, abs=1e-9)
        assert found.deviation < 1e-9


def test_a_bore_whose_keyway_has_rounded_corners():
    """A nozzle rounds the corners with a radius of 0.225 mm, in many short edges that touch the circle: they draw it nowhere."""
    import shapely

    bore = shapely.Point(0, 0).buffer(6.0, quad_segs=64).union(shapely.box(-2, 0, 2, 8))
    edge = shapely.get_coordinates(bore.buffer(0.225).buffer(-0.225, quad_segs=64).exterior)[
        :-1
    ] @ np.array([1, 1j])
    found = bore_circle(Ring(edge, np.zeros(len(edge))), 12.0)
    assert abs(found.centre) < 5e-4 and found.diameter == pytest.approx(12.0, abs=1e-3)
