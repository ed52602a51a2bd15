"""The largest distance of a contour from a ring, against closed forms and brute force."""

from __future__ import annotations

import math

import numpy as np
import pytest
from test_facets import blunt_cam

from camgen.geometry.arcs import bulges, fit_arcs
from camgen.geometry.deviation import outline_error
from camgen.geometry.facets import facet_contour
from camgen.geometry.outlines import Arc, Contour, Smooth, circle, kidney
from camgen.geometry.rings import Ring


def straight(points: np.ndarray) -> Ring:
    return Ring(points, np.zeros(len(points)))


@pytest.mark.parametrize("n", [3, 7, 100, 5000])
@pytest.mark.parametrize("begin", [0.0, 0.1, -1e-9])
def test_regular_polygon_in_a_circle(n: int, begin: float) -> None:
    """R (1 - cos(pi / n)), wherever the polygon begins and where the circle's seam lies."""
    ring = straight(3j + 20 * np.exp(1j * (begin + np.arange(n) * math.tau / n)))
    assert outline_error(circle(3j, 20.0), ring) == pytest.approx(
        20 * (1 - math.cos(math.pi / n)), rel=1e-7
    )


def test_circle_beside_a_circle() -> None:
    """Two circles of one radius whose centres are d apart are d apart at the most."""
    for d in (1e-9, 1e-3, 0.5):
        shifted = Ring(np.array([20 + 0j, -20]) + d * np.exp(0.7j), np.ones(2))
        assert outline_error(circle(0j, 20.0), shifted) == pytest.approx(d, rel=1e-6)


def test_extreme_between_samples() -> None:
    """A chord across an ellipse: farthest where the tangent is parallel to it, at the eccentric angle half way."""
    a, b = 30.0, 4.0
    ellipse = Smooth(
        lambda t, k: a * np.cos(t + k * math.pi / 2) + 1j * b * np.sin(t + k * math.pi / 2),
        0.0,
        math.tau,
    )
    t = np.array([0.2, 0.9, 1.7, 2.6, 3.3, 4.1, 5.2])
    z = ellipse.at(t)
    sagitta = 0.0
    for u, v in zip(t, [*t[1:], t[0] + math.tau], strict=True):
        p, q, top = ellipse.at(u), ellipse.at(v), ellipse.at((u + v) / 2)
        sagitta = max(sagitta, abs((np.conj(q - p) * (top - p)).imag) / abs(q - p))
    assert outline_error(Contour((ellipse,)), straight(z)) == pytest.approx(sagitta, rel=1e-9)


@pytest.mark.long
@pytest.mark.parametrize("tolerance", [1e-1, 1e-3])
def test_brute_force_agrees(tolerance: float) -> None:
    """Dense points of the cam against the facets, by another library; and against the arcs made of short chords."""
    import shapely

    cam = blunt_cam().counter_clockwise()
    dense = np.concatenate([p.at(np.linspace(p.t0, p.t1, 8001)) for p in cam.pieces])
    facets = straight(facet_contour(cam, tolerance))
    arcs = Ring(*bulges(fit_arcs(cam, tolerance)))
    for ring, points in ((facets, facets.points), (arcs, arcs.facetted(1e-3 * tolerance))):
        line = shapely.LinearRing(np.column_stack([points.real, points.imag]))
        brute = float(shapely.distance(shapely.points(dense.real, dense.imag), line).max())
        found = outline_error(cam, ring)
        assert found == pytest.approx(brute, abs=2e-3 * tolerance)
        assert found <= tolerance * (1 + 1e-6)


def test_a_moved_vertex_is_seen_and_the_seam_is_not() -> None:
    """One vertex pushed out by 0.01 shows as about that, its edges pass a little nearer; where the ring begins is all one."""
    cam = blunt_cam().counter_clockwise()
    ring = facet_contour(cam, 1e-3)
    sound = outline_error(cam, straight(ring))
    assert outline_error(cam, straight(np.roll(ring, 211))) == pytest.approx(sound, rel=1e-9)
    k = 200
    outwards = -1j * (ring[k + 1] - ring[k - 1]) / abs(ring[k + 1] - ring[k - 1])
    ring[k] += 0.01 * outwards
    assert outline_error(cam, straight(ring)) == pytest.approx(0.01, rel=0.2)


def test_corners_and_arcs_of_a_slot() -> None:
    """A slot of four arcs is itself, and a bulge that is a hundredth too flat is off by the difference of the sagittas."""
    slot = kidney(0j, 20.0, 2.0, 0.3, 1.0).counter_clockwise()
    exact = Ring(*bulges(slot))
    assert outline_error(slot, exact) < 1e-12
    outer = next(
        i for i, piece in enumerate(slot.pieces) if isinstance(piece, Arc) and piece.radius == 22.0
    )
    start = complex(slot.pieces[outer].at(slot.pieces[outer].t0))
    edge = int(np.argmin(np.abs(exact.points - start)))
    flat = exact.bulges.copy()
    flat[edge] *= 0.99
    half = abs(exact.ends[edge] - exact.points[edge]) / 2
    assert outline_error(slot, Ring(exact.points, flat)) == pytest.approx(
        0.01 * half * abs(exact.bulges[edge]), rel=1e-6
    )
