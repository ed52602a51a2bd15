"""Parallel contours against Steiner's formulas and brute force; print fits undone again keep the motion; seen to fail."""

from __future__ import annotations

import math
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import ellipe

from camgen.errors import DesignError
from camgen.geometry.distances import point_to_ring
from camgen.geometry.facets import facet_contour
from camgen.geometry.mesh import slice_mesh
from camgen.geometry.outlines import Arc, Contour, Line, Region, Smooth, circle, kidney, polygon
from camgen.geometry.rings import Ring, Shape, bore_circle, fit_circle, hole_circles, shape_of
from camgen.judge.as_printed import grown, printed
from camgen.judge.contact import contact
from camgen.judge.contact_tips import ArmTip
from camgen.machines.uniform_swing.mechanism import UniformSwing
from camgen.parts.fits import Compensation, compensated, offset, parallel_curve
from camgen.parts.part import Layer, Part
from camgen.parts.solids import solid

L_SHAPE = [0, 6, 6 + 2j, 2 + 2j, 2 + 5j, 5j]


def ellipse(a: float, b: float) -> Contour:
    def at(t: np.ndarray, order: int) -> np.ndarray:
        u = t + order * math.pi / 2
        return np.asarray(a * np.cos(u) + 1j * b * np.sin(u))

    return Contour((Smooth(at, 0.0, 2 * math.pi),))


def test_circles_and_slots_stay_what_they_are() -> None:
    moved = offset(circle(3 + 1j, 5), -0.7)
    assert moved.pieces == circle(3 + 1j, 4.3).pieces
    for hole in (circle(0j, 5), circle(0j, 5).reversed()):
        assert math.copysign(1, offset(hole, 1).area) == math.copysign(1, hole.area)
        assert abs(offset(hole, 1).area) == pytest.approx(36 * math.pi)
    slot = offset(kidney(0j, 30, 2, 0.3, 0.9), 0.4)
    assert slot.area == pytest.approx(kidney(0j, 30, 2.4, 0.3, 0.9).area, rel=1e-12)
    assert all(isinstance(piece, Arc) for piece in slot.pieces)


@pytest.mark.parametrize("d", [0.05, 0.3, 0.9])
def test_corners_by_steiner(d: float) -> None:
    """Strips along the sides; at a right angle a quarter disc where they part, a square counted twice where they overlap."""
    shape, area, length = polygon([complex(z) for z in L_SHAPE]), 18.0, 22.0
    assert (shape.area, shape.length) == pytest.approx((area, length), rel=1e-14)
    assert offset(shape, d).area == pytest.approx(
        area + length * d + 5 * math.pi * d**2 / 4 - d**2, rel=1e-12
    )
    assert offset(shape, -d).area == pytest.approx(
        area - length * d + 5 * d**2 - math.pi * d**2 / 4, rel=1e-12
    )


@given(
    st.lists(st.tuples(st.floats(0, 2 * math.pi), st.just(0)), min_size=5, max_size=12),
    st.floats(0.05, 3),
)
@settings(max_examples=30)
def test_convex_polygons_by_steiner(angles: list[tuple[float, int]], d: float) -> None:
    t = np.array(sorted({round(a, 1) % 6.2 for a, _ in angles} | {0.0, 2.0, 4.0}))
    shape = polygon((20 * np.exp(1j * t)).tolist())
    assert offset(shape, d).area == pytest.approx(
        shape.area + shape.length * d + math.pi * d**2, rel=1e-9
    )


@pytest.mark.parametrize("d", [2.0, -0.9])
def test_ellipse_by_steiner(d: float) -> None:
    a, b = 10.0, 5.0
    length = 4 * a * ellipe(1 - (b / a) ** 2)
    assert offset(ellipse(a, b), d).area == pytest.approx(
        math.pi * a * b + length * d + math.pi * d * d, rel=1e-9
    )


def test_swallowtails_are_cut_off() -> None:
    """Beyond the smallest radius of curvature (2.5 mm) every point that is left is 3.5 mm from the ellipse, none nearer."""
    made = offset(ellipse(10, 5), -3.5)
    points = facet_contour(made, 1e-4)
    dense = facet_contour(ellipse(10, 5), 1e-7)
    distance = np.array([np.min(np.abs(dense - z)) for z in points])
    assert np.max(np.abs(distance - 3.5)) < 1e-5
    assert made.area < 0.5 * math.pi * 6.5 * 1.5 * 2


def test_derivatives_of_a_parallel_curve() -> None:
    import mpmath as mp

    curve = parallel_curve(ellipse(10, 5).pieces[0], 0.8)  # type: ignore[arg-type]

    def exact(t: float) -> mp.mpc:
        z, d = mp.mpc(10 * mp.cos(t), 5 * mp.sin(t)), mp.mpc(-10 * mp.sin(t), 5 * mp.cos(t))
        return z - 0.8j * d / abs(d)

    for t in (0.3, 2.0, 5.5):
        for order, tolerance in ((0, 1e-13), (1, 1e-11), (2, 1e-6)):
            assert (
                abs(complex(curve.at(t, order)) - complex(mp.diff(exact, t, order)))
                < tolerance * 20
            )
        q1, q2 = complex(curve.at(t, 1)), complex(curve.at(t, 2))
        bend = (
            mp.diff(exact, t, 1).conjugate() * mp.diff(exact, t, 2)
        ).imag  # what curvature needs is exact
        assert (q1.conjugate() * q2).imag == pytest.approx(float(bend), rel=1e-10)


@pytest.mark.parametrize(
    "contour, distance, quantity, value, limit",
    [
        (circle(0j, 1), -1.2, "compensation of the bore", 1.2, 1.0),
        (polygon([0, 4, 4 + 1j, 1j]), -0.6, "compensation of the bore", 0.6, 0.5),
        (
            polygon(
                [0, 4, 4 + 1.5j, 6 + 1.5j, 6, 10, 10 + 4j, 6 + 4j, 6 + 2.5j, 4 + 2.5j, 4 + 4j, 4j]
            ),
            -0.6,
            "pieces",
            2,
            1,
        ),
    ],
)
def test_what_leaves_nothing_is_refused(
    contour: Contour, distance: float, quantity: str, value: float, limit: float
) -> None:
    with pytest.raises(DesignError) as error:
        offset(contour, distance, "bore")
    assert error.value.quantity.startswith(quantity)
    assert (error.value.value, error.value.limit) == (
        pytest.approx(value),
        pytest.approx(limit, rel=0.06),
    )


def bush(thickness: float = 5.0) -> Part:
    region = Region(circle(0j, 10), (circle(0j, 4), circle(7 + 0j, 1)))
    return Part("bush", "", (Layer(region, 0, thickness),), centres=(7 + 0j,), bore=8.0)


def test_compensated_part() -> None:
    part = compensated(
        bush(), Compensation(hole=0.1, profile=0.15, shrinkage=0.02, foot=0.4, layer=0.2)
    )
    assert [(round(x.z0, 9), round(x.z1, 9)) for x in part.layers] == [
        (0, 0.2),
        (0.2, 0.4),
        (0.4, 5),
    ]
    assert (
        part.drawn_layer == 2
        and part.bore == pytest.approx(8.2 / 0.98)
        and part.centres == (pytest.approx(7 / 0.98),)
    )
    for layer, inset in zip(part.layers, (0.4, 0.2, 0.0), strict=True):
        area = (9.85 - inset) ** 2 - (4.1 + inset) ** 2 - (1.1 + inset) ** 2
        assert layer.region.area == pytest.approx(math.pi * area / 0.98**2)
    assert solid(part, 0.01).volume == pytest.approx(part.volume, rel=5e-3)


@pytest.mark.parametrize(
    "fit, quantity",
    [
        (Compensation(hole=1.1), "wall"),
        (Compensation(profile=11), "compensation of the outline of bush"),
        (Compensation(foot=11), "elephant-foot"),
        (Compensation(hole=-1), "compensation of the hole of bush"),
        (Compensation(shrinkage=0.9), "shrinkage"),
    ],
)
def test_fits_that_leave_no_material(fit: Compensation, quantity: str) -> None:
    with pytest.raises(DesignError, match=quantity):
        compensated(bush(), fit)


def test_a_crossed_part_has_no_fits() -> None:
    crossed = replace(bush(), side_profile=Region(circle(2.5j, 2.5)))
    with pytest.raises(DesignError, match="bush is made of two crossed outlines"):
        compensated(crossed, Compensation(hole=0.1))


def test_undone_bush_is_the_bush() -> None:
    fit = Compensation(hole=0.1, profile=0.15, shrinkage=0.02)
    made = solid(compensated(bush(), fit), 0.001)
    file = shape_of(slice_mesh(made, 2.5))
    shape = printed(file, fit.hole, fit.profile, fit.shrinkage)
    assert fit_circle(shape.outer.points)[1] == pytest.approx(10, abs=1e-3)
    assert sorted(fit_circle(h.points)[1] for h in shape.holes) == pytest.approx([1, 4], abs=2e-3)
    assert fit_circle(file.outer.points)[1] != pytest.approx(10, abs=0.05)


def test_arcs_are_undone_exactly_and_fillets_close() -> None:
    half = Ring(np.array([5 + 0j, -5 + 0j]), np.array([1.0, 1.0]))
    assert grown(half, 0.5).points.tolist() == pytest.approx([5.5, -5.5])
    concave = Contour(
        (
            Line(0j, 6 + 0j),
            Line(6 + 0j, 6 + 6j),
            Line(6 + 6j, 3 + 2j),
            Line(3 + 2j, 6j),
            Line(6j, 0j),
        )
    )
    for tolerance in (1e-2, 1e-4):
        z = facet_contour(offset(concave, -0.3), tolerance)  # the notch at 3 + 2j comes out round
        back = grown(Ring(z, np.zeros(len(z))), 0.3)
        assert back.area == pytest.approx(concave.area, abs=4 * tolerance)
        assert np.min(np.abs(back.points - (3 + 2j))) < 2 * tolerance and len(back.points) < 8
    with pytest.raises(ValueError, match="nothing is left"):
        grown(Ring(np.array([0, 4, 4 + 1j, 1j]), np.zeros(4)), -3)


def test_motion_survives_the_fits(root: Path) -> None:
    """The tip on the printed cam follows the wanted motion; on the compensated file itself it is far off."""
    spec = UniformSwing.model_validate(
        tomllib.loads((root / "specs" / "uniform-swing.toml").read_text(encoding="utf-8"))
    )
    part, tip = next(p for p in spec.assembly.parts if p.name == "cam"), spec.cam.follower
    fit = Compensation(hole=0.1, profile=0.12, shrinkage=0.004)
    made = compensated(part, fit)
    tolerance = 1e-3
    z = facet_contour(made.layers[made.drawn_layer].region.outer.counter_clockwise(), tolerance)
    file = Shape(Ring(z, np.zeros(len(z))), ())
    theta = np.random.default_rng(5).random(2000) * 2 * math.pi
    limit = tolerance / (abs(tip.arm) * math.cos(np.max(spec.cam.pressure_angle(theta)))) * 1.05

    def error(shape: Shape) -> float:
        rolled = contact(shape.outer, ArmTip(tip.pivot, tip.arm, tip.tip_radius, tip.leaves))
        return float(np.max(np.abs(rolled.angle(theta) - spec.cam.reachable(theta))))

    assert error(printed(file, fit.hole, fit.profile, fit.shrinkage)) <= limit
    assert error(printed(file, fit.hole, fit.profile + 0.003, fit.shrinkage)) > limit
    assert error(file) > 20 * limit


@pytest.mark.parametrize("distance", [-0.3, -0.1, 0.1, 0.3])
def test_a_facetted_arc_comes_back_to_its_corner(distance: float) -> None:
    """A shaft's outline with a flat: arc and line meet at corners, which facets alone would misplace by distance^2 / 2 R."""
    lean, radius = 0.6, 3.0
    flat = radius * math.sin(lean)
    arc = Arc(0j, radius, math.pi - lean, math.pi + 2 * lean)
    half = radius * math.cos(lean)
    shaft = Contour((arc, Line(complex(half, flat), complex(-half, flat))))
    points = facet_contour(offset(shaft, -distance), 0.001)
    limit = (0.02 if distance > 0 else 0.05) * abs(
        distance
    )  # moved outwards the corner opens into an arc, which closes again
    back = grown(Ring(points, np.zeros(len(points))), distance)
    exact = facet_contour(shaft, 0.001)
    far = max(
        float(np.max(point_to_ring(back.points, exact))),
        float(np.max(point_to_ring(exact, back.points))),
    )
    assert far < limit


@pytest.mark.parametrize("hole", [0.05, 0.115, 0.2])
@pytest.mark.parametrize("kind", ["flat", "keyway"])
def test_a_bore_keeps_its_centre(kind: str, hole: float) -> None:
    """What flat or keyway does to the hole's corners, enlarged and printed, draws the bore's circle nowhere."""
    radius, half = 3.0, 1.0 if kind == "keyway" else 2.0
    corner = complex(math.sqrt(radius**2 - half**2), half)
    top = [] if kind == "flat" else [4 - 1j, 4 + 1j]
    around = [corner.conjugate(), *top, corner]
    start = math.asin(half / radius)
    contour = Contour(
        (Arc(0j, radius, start, 2 * (math.pi - start)), *map(Line, around, around[1:]))
    )
    z = facet_contour(offset(contour, hole), 0.001)
    back = grown(Ring(z, np.zeros(len(z))), -hole)
    for found in (
        bore_circle(back, 2 * radius),
        *hole_circles(Shape(back, (back,)))[: kind == "flat"],
    ):
        assert abs(found.centre) < 5e-5 and found.diameter == pytest.approx(2 * radius, abs=1e-4)


def test_a_thin_part_has_a_lower_chamfer() -> None:
    washer = bush(0.4)
    fit = Compensation(foot=0.4)
    assert fit.foot_of(washer) == pytest.approx(0.2)
    assert min(layer.z1 for layer in compensated(washer, fit).layers) < 0.4
    assert fit.foot_of(bush(5.0)) == 0.4
