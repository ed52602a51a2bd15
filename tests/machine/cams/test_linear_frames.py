"""A plate's edge in any frame: against envelopes of the test's own, for plates and followers that stand anyhow."""

from __future__ import annotations

import cmath
import math
from dataclasses import replace

import numpy as np
import pytest

from camgen.errors import DesignError
from camgen.geometry.rings import Ring
from camgen.judge.edge_runs import GroundTip
from camgen.machine.cams.linear import WAY, LinearCam, PlateArm, PlateSlide, seen_from_left
from camgen.machine.programs import CamLaw
from camgen.motion.stroke import Stroke, StrokeSegment, stroke

ROWS = [
    StrokeSegment(kind="rise", span=40.0, lift=8.0, law="cycloidal"),
    StrokeSegment(kind="dwell", span=10.0),
    StrokeSegment(kind="return", span=30.0, to=3.0, law="3-4-5"),
]
WAYS = [
    (1, 0.0),
    (-1, 0.0),
    (1, 0.7),
    (-1, -2.1),
]  # side of the follower, direction of the plate's way


def sampled(cam: LinearCam) -> np.ndarray:
    return np.concatenate([piece.at(np.linspace(piece.t0, piece.t1, 4001)) for piece in cam.edge])


def centres(cam: LinearCam, way: np.ndarray) -> np.ndarray:
    """The tip's centre in the plate's frame, by the ground: where it is, less how far the plate has gone."""
    s = cam.program(way / WAY)
    tip = cam.follower
    if isinstance(tip, PlateSlide):
        return tip.start + tip.along * s - tip.travel * way
    return tip.pivot + tip.arm * np.exp(1j * s) - tip.travel * way


def plate(side: int, direction: float, tilt: float = 0.0) -> LinearCam:
    """A slide across a plate, tilted by an angle."""
    travel = cmath.rect(1, direction)
    along = travel * side * 1j * cmath.exp(1j * tilt)
    tip = PlateSlide(3 - 2j, along, 4.0, 1, travel)
    return LinearCam(stroke(ROWS, 1.0, 1 / WAY), tip)


def armed(side: int, direction: float, ahead: int) -> LinearCam:
    """An arm of 50, its axle ahead of the tip along the plate's way or behind."""
    travel = cmath.rect(1, direction)
    arm = -50 * ahead * travel * cmath.exp(0.1j)
    leaves = side * (-ahead)
    program = CamLaw(stroke(ROWS, math.radians(1), 1 / WAY), leaves).signed
    assert isinstance(program, Stroke)
    return LinearCam(program, PlateArm(1 + 7j, arm, 4.0, leaves, travel))


@pytest.mark.parametrize(("side", "direction"), WAYS)
@pytest.mark.parametrize("tilt", [0.0, 0.3])
def test_a_slide_at_any_place_is_r_off_its_edge(side: int, direction: float, tilt: float) -> None:
    cam = plate(side, direction, tilt)
    way = np.linspace(0, 80, 33)[1:-1]
    away = np.abs(sampled(seen_from_left(cam))[None] - centres(cam, way)[:, None]).min(axis=1)
    assert away == pytest.approx(np.full(31, 4.0), abs=2e-5)


@pytest.mark.parametrize(("side", "direction"), WAYS)
@pytest.mark.parametrize("ahead", [1, -1])
def test_an_arm_at_any_place_is_r_off_its_edge(side: int, direction: float, ahead: int) -> None:
    cam = armed(side, direction, ahead)
    way = np.linspace(0, 80, 33)[1:-1]
    edge = sampled(seen_from_left(cam))
    centre = centres(cam, way)
    away = np.abs(edge[None] - centre[:, None]).min(axis=1)
    assert away == pytest.approx(np.full(31, 4.0), abs=2e-5)
    # the edge lies on the plate's side: towards it the tip comes back
    nearest = edge[np.abs(edge[None] - centre[:, None]).argmin(axis=1)]
    off = 1j * (centre + cam.follower.travel * way - cam.follower.pivot) * cam.follower.leaves
    assert ((centre - nearest) * np.conj(off)).real.min() > 0


@pytest.mark.parametrize(("side", "direction"), WAYS)
def test_a_constant_slope_is_a_straight_edge(side: int, direction: float) -> None:
    """s = x / 4 of a slide square to the way: a line with that slope, R off the line of the centres."""
    row = StrokeSegment(kind="rise", span=80.0, lift=20.0, law="uniform")
    cam = replace(plate(side, direction), program=stroke([row], 1.0, 1 / WAY))
    edge = sampled(seen_from_left(cam))
    travel = cam.follower.travel
    slope = (side * 0.25j - 1) * travel
    slope /= abs(slope)
    normal = slope * -1j * side
    across = ((edge - cam.follower.start) * np.conj(normal)).real
    assert across == pytest.approx(np.full(edge.shape, -4.0), abs=1e-12)
    assert seen_from_left(cam).steepest == pytest.approx(math.degrees(math.atan(0.25)), abs=1e-9)


def test_a_follower_along_the_plate_is_refused() -> None:
    cam = plate(1, 0.0)
    with pytest.raises(DesignError, match="across the plate's travel"):
        seen_from_left(replace(cam, follower=replace(cam.follower, along=1 + 0j)))


def ground_tip(cam: LinearCam) -> GroundTip:
    tip = cam.follower
    if isinstance(tip, PlateSlide):
        return GroundTip(4.0, tip.start, tip.along, False, tip.leaves, tip.travel)
    return GroundTip(4.0, tip.pivot, tip.arm, True, tip.leaves, tip.travel)


def closed(cam: LinearCam) -> Ring:
    """The edge, and a bottom 30 below it, square to the plate's way; facets of 0.02 lie within 3e-6 of the curve."""
    seen = seen_from_left(cam)
    edge = sampled(seen)
    below = edge[[-1, 0]] + 30j * seen.follower.travel
    ends = np.array([-seen.follower.travel, seen.follower.travel]) * 6
    points = np.concatenate([edge[:1] + ends[1:], edge, edge[-1:] + ends[:1], below + ends])
    return Ring(points, np.zeros(len(points)))


CASES = [
    *(plate(side, direction, tilt) for side, direction in WAYS for tilt in (0.0, 0.3)),
    *(armed(side, direction, ahead) for side, direction in WAYS for ahead in (1, -1)),
]


@pytest.mark.long
@pytest.mark.parametrize("cam", CASES)
def test_the_judge_runs_the_tip_in_any_frame(cam: LinearCam) -> None:
    way = np.linspace(0, 80, 161)
    ran = ground_tip(cam).run(closed(cam), way, 1e-6)
    off = np.abs(ran - cam.program(way / WAY)) * abs(ground_tip(cam).way)
    assert off.max() < 2e-5


@pytest.mark.parametrize("cam", CASES)
def test_a_damage_of_20_um_is_seen_as_such(cam: LinearCam) -> None:
    """A stretch of the edge raised by 20 um towards the tip, in the middle of the dwell: the tip is off by that over its cosine."""
    ring = closed(cam)
    tip = ground_tip(cam)
    way = np.array([45.0])
    centre = centres(cam, way)
    near = np.abs(np.abs(ring.points - centre) - 4.0) < 5e-3
    assert near.sum() > 3
    normal = centre - ring.points[near]
    raised = ring.points.copy()
    raised[near] += 0.02 * normal / np.abs(normal)
    moved = tip.run(Ring(raised, ring.bulges), way, 1e-6) - tip.run(ring, way, 1e-6)
    velocity = tip.way * (1j * np.exp(1j * cam.program(way / WAY)) if tip.swings else 1.0)
    across = abs((velocity * np.conj(1j * cam.follower.travel)).real).item()
    assert tip.leaves * moved.item() * across == pytest.approx(0.02, abs=2e-4)
