"""Arcs stay within the tolerance of the exact curve, with common tangents, and few of them."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from test_facets import blunt_cam, ellipse, knife_cam, sine, spiral

from camgen.geometry.arcs import as_circle, bulges, fit_arcs, theoretical_arcs, with_arcs
from camgen.geometry.outlines import (
    Arc,
    Contour,
    Line,
    Piece,
    Smooth,
    circle,
    end_point,
    kidney,
    polygon,
    start_point,
)
from camgen.geometry.rings import Ring


def closed(piece: Smooth) -> Contour:
    """The piece and a line home."""
    return Contour((piece, Line(end_point(piece), start_point(piece))))


def distance_to_pieces(z: np.ndarray, pieces: tuple[Piece, ...]) -> np.ndarray:
    """Distance of each point from the nearest line or arc, by elementary geometry."""
    best = np.full(z.shape, math.inf)
    for p in pieces:
        a, b = start_point(p), end_point(p)
        d = np.minimum(np.abs(z - a), np.abs(z - b))
        if isinstance(p, Line):
            along = np.real((z - a) * np.conj(b - a)) / abs(b - a) ** 2
            d = np.where((along >= 0) & (along <= 1), np.abs(z - a - along * (b - a)), d)
        else:
            swept = np.mod(np.sign(p.sweep) * (np.angle(z - p.centre) - p.start), 2 * math.pi)
            d = np.where(swept <= abs(p.sweep), np.abs(np.abs(z - p.centre) - p.radius), d)
        best = np.minimum(best, d)
    return best


def distance_to_curve(z: np.ndarray, piece: Smooth, samples: int = 20_001) -> np.ndarray:
    """Distance of each point from a smooth piece: nearest of dense points, then its foot by Newton."""
    from scipy.spatial import cKDTree

    grid = np.linspace(piece.t0, piece.t1, samples)
    q = piece.at(grid)
    _, nearest = cKDTree(np.column_stack([q.real, q.imag])).query(np.column_stack([z.real, z.imag]))
    t = grid[nearest]
    for _ in range(3):
        w, d1, d2 = piece.at(t) - z, piece.at(t, 1), piece.at(t, 2)
        slope = np.real(np.conj(w) * d2) + np.abs(d1) ** 2
        t = np.clip(t - np.real(np.conj(w) * d1) / slope, piece.t0, piece.t1)
    return np.minimum(np.abs(piece.at(t) - z), np.abs(q[nearest] - z))


def tangent_turns(contour: Contour) -> np.ndarray:
    """Turn of the tangent at each joint but the one that closes the contour, rad."""
    ends = [(p, math.copysign(1.0, p.t1 - p.t0)) for p in contour.pieces]
    return np.array(
        [
            abs(np.angle(complex(q.at(q.t0, 1)) * sq / (complex(p.at(p.t1, 1)) * sp)))
            for (p, sp), (q, sq) in zip(ends[:-1], ends[1:], strict=True)
        ]
    )


@pytest.mark.parametrize(
    ("tolerance", "theory", "published"),
    [(1e-3, 42.6, 48), (1e-4, 91.7, 98), (1e-5, 197.5, 204), (1e-6, 425.5, 432)],
)
def test_cam_takes_the_published_number(tolerance: float, theory: float, published: int) -> None:
    """Theory and reached number for the knife-edge cam, at most 1.2 times the theory."""
    cam = knife_cam()
    assert theoretical_arcs(cam, tolerance) == pytest.approx(theory, abs=0.06)
    assert len(fit_arcs(cam, tolerance).pieces) <= min(published, 1.2 * theory)
    assert len(fit_arcs(blunt_cam(), tolerance).pieces) <= published + 1  # the corner's own arc


@pytest.mark.long
@pytest.mark.parametrize("tolerance", [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6])
def test_cam_within_tolerance_both_ways(tolerance: float) -> None:
    """No point of the exact cam is off the arcs, none of the arcs off the cam."""
    cam = blunt_cam()
    fit = fit_arcs(cam, tolerance)
    dense = np.concatenate([p.at(np.linspace(p.t0, p.t1, 20_001)) for p in cam.pieces])
    there = distance_to_pieces(dense, fit.pieces).max()
    assert 0.5 * tolerance < there <= tolerance
    on_arcs = np.concatenate([p.at(np.linspace(p.t0, p.t1, 50)) for p in fit.pieces[:-1]])
    back = np.minimum(*(distance_to_curve(on_arcs, p) for p in cam.pieces[:2])).max()
    assert 0.5 * tolerance < back <= tolerance
    turns = tangent_turns(fit)
    assert np.sum(turns > 1e-9) == 1  # the sharp reversal; the corner's arc runs on smoothly


@pytest.mark.long
@settings(max_examples=40)
@given(
    piece=st.one_of(
        st.builds(ellipse, st.floats(1, 100), st.floats(1, 100), st.just(0.0), st.floats(0.5, 6)),
        st.builds(sine, st.floats(1e-9, 3), st.floats(0.1, 12)),
        st.builds(spiral, st.floats(0.1, 10), st.floats(0.02, 0.4), st.floats(0.1, 9)),
    ),
    exponent=st.floats(-5, -0.5),
    backwards=st.booleans(),
)
def test_any_curve(piece: Smooth, exponent: float, backwards: bool) -> None:
    """Within the tolerance, joined, smooth, every bulge below one; ends exactly where the piece has them."""
    tolerance = 10**exponent
    contour = closed(piece.reversed() if backwards else piece)
    fit = fit_arcs(contour, tolerance)
    dense = piece.at(np.linspace(piece.t0, piece.t1, 4001))
    assert distance_to_pieces(dense, fit.pieces).max() <= tolerance * (1 + 1e-9) + 1e-11
    on_arcs = np.concatenate([p.at(np.linspace(p.t0, p.t1, 20)) for p in fit.pieces[:-1]])
    assert distance_to_curve(on_arcs, piece).max() <= tolerance * (1 + 1e-9) + 1e-11
    assert np.all(np.abs(bulges(fit)[1]) < 1)
    if not any(isinstance(p, Line) for p in fit.pieces[:-1]):
        assert tangent_turns(fit)[:-1].max(initial=0) < 1e-7
    radius = max([1.0] + [p.radius for p in fit.pieces if isinstance(p, Arc)])
    for p, q in zip(fit.pieces, fit.pieces[1:] + fit.pieces[:1], strict=True):
        assert abs(end_point(p) - start_point(q)) <= 1e-12 * max(radius, np.abs(dense).max())


@pytest.mark.long
def test_coarser_arcs_fail() -> None:
    """Seen to fail: an arc taken out, its neighbour's end moved to the gap's other side, is out of tolerance."""
    cam, tolerance = knife_cam(), 1e-3
    pieces = fit_arcs(cam, tolerance).pieces
    dense = np.concatenate([p.at(np.linspace(p.t0, p.t1, 20_001)) for p in cam.pieces])
    assert distance_to_pieces(dense, pieces).max() <= tolerance
    for i in range(0, len(pieces), 5):
        damaged = (
            pieces[:i] + (Line(start_point(pieces[i]), end_point(pieces[i])),) + pieces[i + 1 :]
        )
        assert distance_to_pieces(dense, damaged).max() > 10 * tolerance
    assert distance_to_pieces(dense, fit_arcs(cam, 2 * tolerance).pieces).max() > tolerance


def test_bulges_describe_the_same_arcs() -> None:
    """The middle of an edge with bulge b is off its chord by b half chords, to the right of the edge when b > 0."""
    for contour in (fit_arcs(blunt_cam(), 1e-3), kidney(1j, 20.0, 2.0, 0.5, 4.0)):
        z, bulge = bulges(contour)
        assert np.all(np.abs(bulge) < 1)
        chord = np.roll(z, -1) - z
        middle = (z + np.roll(z, -1)) / 2 - 1j * bulge * chord / 2
        assert distance_to_pieces(middle, contour.pieces).max() < 1e-10
        assert distance_to_pieces(z, contour.pieces).max() < 1e-10
        half = 2 * np.arctan(bulge)
        radius = np.divide(
            np.abs(chord) / 2, np.sin(half), out=np.zeros_like(half), where=half != 0
        )
        area = 0.5 * np.sum(np.imag(np.conj(z) * np.roll(z, -1))) + np.sum(
            radius**2 / 2 * (2 * half - np.sin(2 * half))
        )
        assert area == pytest.approx(contour.area, rel=1e-10)


def test_half_circles_are_divided_and_lines_kept() -> None:
    """A slot's ends sweep exactly pi: two arcs each. Polygons pass unchanged."""
    slot = fit_arcs(kidney(0j, 20.0, 2.0, 0.0, 1.0), 1e-3)
    assert [abs(p.sweep) < 3.1 for p in slot.pieces] == [True] * 6
    square = polygon([0, 1, 1 + 1j, 1j])
    assert fit_arcs(square, 1e-3) == square
    assert bulges(square)[1].tolist() == [0.0] * 4


def test_circle() -> None:
    """A full circle stays one; anything else is none; its bulges would still be below one."""
    assert as_circle(circle(1 + 2j, 3.0)) == (1 + 2j, 3.0)
    assert as_circle(circle(1 + 2j, 3.0).reversed()) == (1 + 2j, 3.0)
    assert fit_arcs(circle(0j, 3.0), 1e-3) == circle(0j, 3.0)
    assert as_circle(kidney(0j, 20.0, 2.0, 0.0, 1.0)) is None
    assert as_circle(polygon([0, 1, 1j])) is None
    assert np.all(np.abs(bulges(circle(0j, 3.0))[1]) < 1)


def test_smooth_circle_and_straight_curve() -> None:
    """A circle given as a smooth curve is exact with a handful of arcs; a straight one is one line."""
    fit = fit_arcs(Contour((ellipse(30, 30),)), 1e-6)
    assert len(fit.pieces) <= 8
    assert fit.area == pytest.approx(900 * math.pi, rel=1e-12)
    line = Smooth(lambda t, k: (t * (3 + 4j), 3 + 4j + 0 * t, 0j * t)[k], 0.0, 1.0)
    contour = Contour((line, Line(3 + 4j, 3 + 0j), Line(3 + 0j, 0j)))
    assert fit_arcs(contour, 1e-6).pieces[0] == Line(0j, 3 + 4j)
    assert len(fit_arcs(contour, 1e-6).pieces) == 3


ZEROS = st.sampled_from([0.0, -0.0, 1.0])
PLACES = st.builds(complex, ZEROS, ZEROS)
WAVE = sine(1.0, 2.0)
LIKE = {
    Line: (PLACES, PLACES),
    Arc: (PLACES, st.just(2.6), ZEROS, st.just(1.0)),
    Smooth: (st.just(WAVE.function), ZEROS, st.sampled_from([0.0, -0.0, 2.0])),
}


@given(st.data(), st.sampled_from([*LIKE]))
def test_equal_pieces_are_the_same_to_the_bit(data: st.DataObject, kind: type) -> None:
    """What is kept of one outline is given for all that equal it: 0 and -0 are equal."""
    one, other = (kind(*(data.draw(values) for values in LIKE[kind])) for _ in range(2))
    assert one != other or repr(one) == repr(other)


def test_a_fit_is_that_of_its_own_contour() -> None:
    fits = [fit_arcs(circle(complex(x, y), 2.6), 0.01) for x in (-0.0, 0.0) for y in (-0.0, 0.0)]
    assert {repr(fit) for fit in fits} == {
        "Contour(pieces=(Arc(centre=0j, radius=2.6, start=0.0, sweep=6.283185307179586),))"
    }


@pytest.mark.long
def test_waves_finer_than_the_arcs() -> None:
    """A circle of 40 mm with 171 waves of half a tolerance each way: arcs that skip waves hold, and no number of even ones does."""

    def waves(t: np.ndarray, order: int) -> np.ndarray:
        amplitudes = ((1, 40), (172, 2.5e-4), (-170, 2.5e-4))
        terms = [c * (1j * k) ** order * np.exp(1j * k * np.asarray(t)) for k, c in amplitudes]
        return np.asarray(sum(terms))

    piece = Smooth(waves, 0.0, math.tau)
    fitted = fit_arcs(Contour((piece,)), 1e-3)
    places = np.concatenate([p.at(np.linspace(p.t0, p.t1, 9)) for p in fitted.pieces])
    assert np.max(distance_to_curve(places, piece)) <= 1.001e-3
    assert np.max(distance_to_pieces(piece.at(piece.spread(2001)), fitted.pieces)) <= 1.001e-3


def test_refused() -> None:
    """No tolerance, no length, no arcs."""
    for tolerance in (0.0, -1.0, math.nan, math.inf):
        with pytest.raises(ValueError, match="tolerance"):
            fit_arcs(knife_cam(), tolerance)
    with pytest.raises(ValueError, match="length"):
        fit_arcs(Contour((ellipse(1, 1, 2.0, 2.0),)), 1e-3)
    with pytest.raises(ValueError, match="arcs"):
        bulges(knife_cam())


@given(
    st.lists(st.tuples(st.floats(5, 9), st.integers(1, 40)), min_size=3, max_size=9),
    st.sampled_from([1e-4, 2e-3, 0.05]),
    st.integers(0, 400),
)
@settings(max_examples=25, deadline=None)
def test_arcs_in_place_of_edges_keep_to_corners_and_middles(
    rows: list[tuple[float, int]], tolerance: float, first: int
) -> None:
    """Rounds of any fineness between corners, begun anywhere: no corner and no middle of an edge is farther off than the tolerance."""
    corners = []
    for k, (radius, edges) in enumerate(rows):
        ends = math.tau * k / len(rows), math.tau * (k + 1) / len(rows)
        corners.append(radius * np.exp(1j * np.linspace(*ends, edges + 1)))
    polygon = Ring(np.roll(np.concatenate(corners), first), np.zeros(sum(map(len, corners))))
    made = with_arcs(polygon, tolerance)
    assert len(made.points) <= len(polygon.points)
    assert np.isin(made.points, polygon.points).all()
    z = made.facetted(1e-5)
    edge = shapely.LinearRing(np.column_stack([z.real, z.imag]))
    for places in (polygon.points, (polygon.points + polygon.ends) / 2):
        off = shapely.distance(edge, shapely.points(places.real, places.imag))
        assert off.max() <= tolerance + 2e-5


def test_a_fine_circle_is_few_arcs_and_edges_that_turn_sharply_stay() -> None:
    circle = Ring(10 * np.exp(1j * np.linspace(0, math.tau, 500, endpoint=False)), np.zeros(500))
    few = with_arcs(circle, 1e-3)
    assert len(few.points) < 12 and few.area == pytest.approx(math.pi * 100, rel=1e-4)
    square = Ring(np.array([0, 1, 1 + 1j, 1j]), np.zeros(4))
    assert np.array_equal(with_arcs(square, 1e-3).points, square.points)
