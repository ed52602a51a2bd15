"""Gears with teeth on a part of the driver's circle, through the contact engine: the wheel goes on by whole pitches.

Which tooth is pushed first follows from two triangles of the axes and the tip circles alone. That the wheel stands still while it
is pushed no more, and how far it has come, is found by the engine.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from camgen.geometry.arcs import bulges, fit_arcs
from camgen.geometry.outlines import Arc, Contour
from camgen.geometry.rings import Floats, Ring
from camgen.judge.pairs import Body, OutlinePair, pivots_apart
from camgen.parts.wheels.involute import BasicRack
from camgen.parts.wheels.mesh import Mesh, Sizes


def meshing(teeth: tuple[int, int]) -> Mesh:
    return Sizes(BasicRack(2.0), *teeth, backlash=0.08).mesh()


def ring(contour: Contour) -> Ring:
    return Ring(*bulges(fit_arcs(contour, 2e-4)))


def sector(mesh: Mesh, kept: int) -> Ring:
    """The driver with so many teeth; its root circle closes it."""
    pieces = mesh.a.outline().pieces
    teeth = pieces[: kept * len(pieces) // mesh.a.teeth]
    begin = float(np.angle(complex(teeth[0].at(teeth[0].t0))))
    end = float(np.angle(complex(teeth[-1].at(teeth[-1].t1))))
    return ring(Contour((*teeth, Arc(0j, mesh.a.root, end, (begin - end) % math.tau))))


def beside(mesh: Mesh) -> float:
    """Angle about the wheel's axis from the line of both axes to where the tip circles cross, rad."""
    a, b, far = mesh.a.tip, mesh.b.tip, mesh.distance
    return math.acos((far**2 + b**2 - a**2) / (2 * far * b))


def pushed(mesh: Mesh, driver: Ring, kept: int) -> tuple[Floats, Floats, bool]:
    """Driver's and wheel's angles over a turn, rad: the wheel, loose, moves only where it is pushed; and whether that is proven."""
    stop = math.pi - beside(mesh) - mesh.b.half_angle(mesh.b.tip)
    theta = np.linspace(0, math.tau, 1441) - kept * mesh.a.pitch - 1
    pair = OutlinePair(Body([driver]), Body([ring(mesh.b.outline())]), pivots_apart(mesh.distance))
    samples = pair.follow(theta, stop).samples
    assert samples.free.all()
    high = np.where(np.isnan(samples.high), np.inf, samples.high)
    wheel = np.minimum.accumulate(np.minimum(high, stop))
    return theta, wheel, bool(samples.proven[1:].all())


@pytest.mark.parametrize(
    ("teeth", "kept", "pitches"),
    [((20, 20), 1, 2), ((20, 20), 3, 4), ((16, 24), 2, 3), ((24, 30), 4, 6), ((40, 20), 4, 6)],
)
def test_a_turn_moves_the_wheel_by_whole_pitches(
    teeth: tuple[int, int], kept: int, pitches: int
) -> None:
    mesh = meshing(teeth)
    assert kept - 1 + math.floor(2 * beside(mesh) / mesh.b.pitch) == pitches
    _, wheel, proven = pushed(mesh, sector(mesh, kept), kept)
    assert proven
    assert wheel[0] - wheel[-1] == pytest.approx(pitches * mesh.b.pitch, abs=1e-6)


def test_a_tip_that_is_lower_leaves_the_wheel_behind() -> None:
    """All tips by 50 um: the corner ends where the lower circle crosses the wheel's, by the triangle."""
    mesh = meshing((20, 20))
    whole = sector(mesh, 3)
    points = whole.points.copy()
    high = np.abs(points) > mesh.a.tip - 1e-6
    assert high.sum() >= 6
    points[high] *= (mesh.a.tip - 0.05) / mesh.a.tip
    _, wheel, _ = pushed(mesh, Ring(points, whole.bulges), 3)
    behind = 4 * mesh.b.pitch - (wheel[0] - wheel[-1])
    low = mesh.a.tip - 0.05
    b, far = mesh.b.tip, mesh.distance
    expected = beside(mesh) - math.acos((far**2 + b**2 - low**2) / (2 * far * b))
    assert expected > 2e-3
    assert behind == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize(
    ("teeth", "least", "most"), [((20, 20), 1.0, 1.001), ((24, 30), 1.9, 2.1), ((30, 20), 2.5, 3.0)]
)
def test_a_first_tooth_that_grazes_throws_the_wheel_on(
    teeth: tuple[int, int], least: float, most: float
) -> None:
    """The greatest speed over that in mesh, from sample to sample."""
    mesh = meshing(teeth)
    theta, wheel, _ = pushed(mesh, sector(mesh, 3), 3)
    speed = -np.diff(wheel) / np.diff(theta)
    assert least <= speed.max() * teeth[1] / teeth[0] < most
