"""Facets stay within the tolerance of the exact curve, with hardly a vertex more than the theory asks."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgen.geometry.facets import facet, facet_circle, facet_contour, theoretical_vertices
from camgen.geometry.outlines import Arc, Contour, Line, Smooth, circle, kidney, polygon

SWING = math.radians(15)
L = 60.0
H = 30.0
R = math.hypot(L, H)


def half_turn(start: float, slope: float, tip: float = 0.0) -> Callable[..., np.ndarray]:
    """Knife-edge profile P = L e^{-i phi} - R e^{i start} e^{i (slope - 1) phi}, or its parallel inwards by tip."""
    factor, rate = -R * np.exp(1j * start), 1j * (slope - 1)

    def knife(phi: np.ndarray, order: int) -> np.ndarray:
        return L * (-1j) ** order * np.exp(-1j * phi) + factor * rate**order * np.exp(rate * phi)

    def parallel(phi: np.ndarray, order: int) -> np.ndarray:
        p1, p2, p3 = (knife(phi, k) for k in (1, 2, 3))
        tangent, speed2 = p1 / np.abs(p1), np.abs(p1) ** 2
        turning = (np.conj(p1) * p2).imag / speed2
        bend = (np.conj(p1) * p3).imag / speed2 - 2 * turning * (np.conj(p1) * p2).real / speed2
        inward = (-1j, turning, bend + 1j * turning**2)[
            order
        ] * tangent  # P runs clockwise: inside is on the right
        return knife(phi, order) + tip * inward

    return parallel if tip else knife


MID = math.atan2(H, L)
FIRST = (MID - SWING, 2 * SWING / math.pi)
SECOND = (MID + SWING + 2 * SWING, -2 * SWING / math.pi)


def knife_cam() -> Contour:
    return Contour(
        (Smooth(half_turn(*FIRST), 0, math.pi), Smooth(half_turn(*SECOND), math.pi, 2 * math.pi))
    )


def blunt_pieces() -> tuple[Smooth, Smooth]:
    """The two smooth pieces of the cam for a tip of radius 3, trimmed where they meet at the reversal."""
    f, g = half_turn(*FIRST, 3.0), half_turn(*SECOND, 3.0)
    x = np.radians([179.02636116, 180.7732225])
    for _ in range(3):
        a, b, gap = f(x[0], 1), -g(x[1], 1), f(x[0], 0) - g(x[1], 0)
        x = x - np.linalg.solve([[a.real, b.real], [a.imag, b.imag]], [gap.real, gap.imag])
    return Smooth(f, 0, x[0]), Smooth(g, x[1], 2 * math.pi)


def blunt_cam() -> Contour:
    """The whole cam for a tip of radius 3, with the tip's own arc in the concave corner."""
    first, second = blunt_pieces()
    corner = complex(half_turn(*FIRST)(np.array(0.0), 0))
    spoke, following = complex(second.at(second.t1)) - corner, complex(first.at(0.0)) - corner
    return Contour(
        (
            first,
            second,
            Arc(corner, 3.0, float(np.angle(spoke)), float(np.angle(following / spoke))),
        )
    )


def ellipse(a: float, b: float, t0: float = 0.0, t1: float = 2 * math.pi) -> Smooth:
    return Smooth(
        lambda t, k: a * np.cos(t + k * math.pi / 2) + 1j * b * np.sin(t + k * math.pi / 2), t0, t1
    )


def sine(height: float, length: float) -> Smooth:
    return Smooth(lambda t, k: (t, 1, 0)[k] + 1j * height * np.sin(t + k * math.pi / 2), 0, length)


def spiral(radius: float, growth: float, turn: float) -> Smooth:
    rate = growth + 1j
    return Smooth(lambda t, k: radius * rate**k * np.exp(rate * t), 0, turn)


def largest_distance(piece: Smooth, t: np.ndarray, samples: int = 40) -> float:
    """By brute force: dense points of the curve between each two vertices against the segment between them."""
    q = piece.at(np.linspace(t[:-1], t[1:], samples, axis=1))
    a = piece.at(t[:-1])[:, None]
    v = piece.at(t[1:])[:, None] - a
    along = np.real((q - a) * np.conj(v)) / np.maximum(np.abs(v) ** 2, 1e-300)
    return float(np.abs(q - a - np.clip(along, 0, 1) * v).max())


@pytest.mark.parametrize(
    ("tolerance", "knife", "blunt"),
    [
        (1e-1, 41.5, 38.9),
        (1e-2, 131.3, 122.9),
        (1e-3, 415.3, 388.7),
        (1e-4, 1313.4, 1229.2),
        (1e-5, 4153.5, 3887.1),
    ],
)
def test_cam_takes_the_least_vertices(tolerance: float, knife: float, blunt: float) -> None:
    """Published theory for the uniform-swing cam; reached with at most two vertices more a piece."""
    cam = knife_cam()
    assert theoretical_vertices(cam, tolerance) == pytest.approx(knife, abs=0.06)
    assert len(facet_contour(cam, tolerance)) <= knife + 4
    pieces = blunt_pieces()
    counts = [facet(piece, tolerance).size - 1 for piece in pieces]
    assert blunt - 1 < sum(counts) <= blunt + 4


def test_default_cam_needs_390() -> None:
    """The figure to reach for tip 3 at 0.001 mm, without and with the corner's arc (71.8 deg of radius 3)."""
    assert sum(facet(piece, 1e-3).size - 1 for piece in blunt_pieces()) == 390
    arc = math.ceil(abs(blunt_cam().pieces[2].sweep) / (2 * math.acos(1 - 1e-3 / 3)))
    assert len(facet_contour(blunt_cam(), 1e-3)) == 390 + arc


@pytest.mark.parametrize("tolerance", [1e-1, 1e-2, 1e-3])
def test_shapely_agrees(tolerance: float) -> None:
    """Hausdorff distance of a dense polygon of the cam from the facets, by another library."""
    import shapely

    ring = facet_contour(blunt_cam(), tolerance)
    ring = np.append(ring, ring[0])
    dense = np.concatenate([p.at(np.linspace(p.t0, p.t1, 20001)) for p in blunt_cam().pieces])
    polygon_edge = shapely.LineString(np.column_stack([ring.real, ring.imag]))
    distance = shapely.distance(shapely.points(dense.real, dense.imag), polygon_edge).max()
    assert 0.9 * tolerance < distance <= tolerance


@pytest.mark.long
@settings(max_examples=60)
@given(
    piece=st.one_of(
        st.builds(ellipse, st.floats(1, 100), st.floats(1e-3, 100)),
        st.builds(sine, st.floats(1e-9, 10), st.floats(0.1, 20)),
        st.builds(spiral, st.floats(1e-3, 10), st.floats(-0.5, 0.5), st.floats(0.1, 10)),
    ),
    exponent=st.floats(-5, -0.5),
    scale=st.sampled_from([1e-3, 1.0, 1e3]),
    backwards=st.booleans(),
)
def test_bound_holds(piece: Smooth, exponent: float, scale: float, backwards: bool) -> None:
    """Within the tolerance at any size, either way round; at most the theory plus two, plus one for each inflection.

    An inflection parts the piece into two of one bend each, and either has a last facet that is not a whole one.
    """
    piece = piece.moved(scale)
    tolerance = scale * 10**exponent
    t = facet(piece.reversed() if backwards else piece, tolerance)
    assert (t[0], t[-1]) == ((piece.t1, piece.t0) if backwards else (piece.t0, piece.t1))
    assert np.all(np.diff(t) < 0 if backwards else np.diff(t) > 0)
    assert largest_distance(piece, t) <= tolerance
    dz, ddz = (piece.at(np.linspace(piece.t0, piece.t1, 200_001), k) for k in (1, 2))
    bend = np.abs(np.imag(np.conj(dz) * ddz) / np.abs(dz))
    least = np.trapezoid(np.sqrt(bend / (8 * tolerance)), dx=(piece.t1 - piece.t0) / 200_000)
    inflections = np.count_nonzero(np.diff(np.sign(np.imag(np.conj(dz) * ddz))))
    assert t.size - 1 <= least * (1 + 1e-4) + 2 + inflections


def test_a_vertex_less_fails() -> None:
    """Seen to fail: without any one of its vertices the polygon is out of tolerance."""
    piece, tolerance = blunt_pieces()[0], 1e-3
    t = facet(piece, tolerance)
    assert largest_distance(piece, t) <= tolerance
    for i in range(1, t.size - 1, 7):
        assert largest_distance(piece, np.delete(t, i)) > 3 * tolerance


@pytest.mark.parametrize("tolerance", [1e-2, 1e-4, 1e-6])
def test_near_cusp(tolerance: float) -> None:
    """Curvature 1e6 at the ends of a needle of an ellipse."""
    needle = ellipse(1.0, 1e-3)
    assert (
        abs(np.imag(np.conj(needle.at(0.0, 1)) * needle.at(0.0, 2)) / abs(needle.at(0.0, 1)) ** 3)
        > 0.99e6
    )
    t = facet(needle, tolerance)
    assert largest_distance(needle, t, 400) <= tolerance
    assert t.size - 1 <= theoretical_vertices(Contour((needle,)), tolerance) + 2


def test_narrow_spike_of_curvature_is_seen() -> None:
    """A bend of 1 rad within 1e-6 of the parameter's range."""
    piece = Smooth(
        lambda t, k: (
            t + 1j * np.hypot(t - 0.3337, 1e-6),
            1 + 1j * (t - 0.3337) / np.hypot(t - 0.3337, 1e-6),
            1j * 1e-12 / np.hypot(t - 0.3337, 1e-6) ** 3,
        )[k],
        0.0,
        1.0,
    )
    t = facet(piece, 1e-4)
    assert np.abs(t - 0.3337).min() < 2e-4
    dense = np.linspace(0, 1, 100_001)
    inside = np.interp(dense, t, piece.at(t).imag)
    assert np.abs(piece.at(dense).imag - inside).max() <= 1e-4 * math.sqrt(2)


def test_lines_and_arcs() -> None:
    """A line takes one facet, an arc the closed form, evenly; a small circle still encloses something."""
    assert facet(Line(0j, 5 + 0j), 1e-3).tolist() == [0.0, 1.0]
    t = facet(Arc(1j, 10.0, 0.3, -2.0), 1e-3)
    assert t.size - 1 == math.ceil(2.0 / (2 * math.acos(1 - 1e-4)))
    assert np.ptp(np.diff(t)) < 1e-14
    assert len(facet_contour(circle(0j, 1e-3), 1.0)) == 3
    assert len(facet_contour(Contour((ellipse(1e-3, 1e-3),)), 1.0)) >= 3
    assert len(facet_contour(polygon([0, 1, 1j]), 1e-3)) == 3
    slot = facet_contour(kidney(0j, 20.0, 2.0, 0.0, 1.0), 1e-3)
    assert len(set(slot.tolist())) == slot.size


@pytest.mark.long
@given(radius=st.floats(1e-3, 1e4), tolerance=st.floats(1e-4, 1e-1))
def test_circle_from_within_and_from_outside(radius: float, tolerance: float) -> None:
    """Inscribed: vertices on the circle; circumscribed: edges touch it. Either way within the tolerance."""
    for outside in (False, True):
        ring = facet_circle(3 - 4j, radius, tolerance, outside) - (3 - 4j)
        middle, corner = np.abs(ring + np.roll(ring, 1)) / 2, np.abs(ring)
        touching, away = (middle, corner) if outside else (corner, middle)
        assert touching == pytest.approx(radius, rel=1e-9)
        assert np.abs(away - radius).max() <= tolerance * (1 + 1e-6) + 1e-11 or ring.size == 3
        assert np.sum(np.imag(np.conj(ring) * np.roll(ring, -1))) > 0


def test_refused() -> None:
    """Pieces without length, and tolerances that are none."""
    still = Smooth(lambda t, k: np.zeros(np.shape(t), complex), 0, 1)
    for piece in (
        Line(1j, 1j),
        Arc(0j, 0.0, 0.0, 1.0),
        Arc(0j, 1.0, 0.0, 0.0),
        still,
        ellipse(1, 1, 2.0, 2.0),
    ):
        with pytest.raises(ValueError, match="length"):
            facet(piece, 1e-3)
    for tolerance in (0.0, -1.0, math.nan, math.inf):
        with pytest.raises(ValueError, match="tolerance"):
            facet(ellipse(2, 1), tolerance)
    with pytest.raises(ValueError, match="positive"):
        facet_circle(0j, 0.0, 1e-3)
