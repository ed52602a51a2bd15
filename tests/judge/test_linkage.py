"""The judge of linkages: chains closed on measured holes, against circles that meet and closed forms."""

from __future__ import annotations

import cmath
import math
from collections.abc import Mapping, Sequence

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from camgen.geometry.rings import Ring, Shape
from camgen.judge.linkage import Chain, Guide, judge_linkage, measure, measure_faces
from camgen.machine.contacts import Eye, Pin, Pose, Slide, Traced

THETA = np.linspace(0.1, 6.3, 97)
Z = np.zeros(len(THETA))


def along_x(path: np.ndarray) -> np.ndarray:
    return path.real


def unit(path: np.ndarray) -> np.ndarray:
    return np.ones(path.shape, complex)


Parts = tuple[list[Pin | Slide], Traced, dict[Eye, complex], dict[str, Guide]]


def slider_crank(e: float, rod: float, offset: float = 0.0) -> Parts:
    """Crank, rod and slider whose poses are only roughly where they will be."""
    slider = Eye("slider", 0j, 3)
    joints: list[Pin | Slide] = [
        Pin("O", Eye("crank", 0j, 2), Eye(None, 0j, 2, True), 0),
        Pin("E", Eye("crank", complex(e), 8, True), Eye("rod", 0j, 8), 0.1),
        Pin("P", Eye("rod", complex(rod), 3), slider, 0.2),
        Slide("guide", slider, 1j * offset, 0.0, 8, 0.1, "body"),
    ]
    eyes = {eye: eye.at for j in joints for eye in ([j.eye] if isinstance(j, Slide) else [j.a, j.b])}
    guides = {"guide": Guide(1j * offset, 0.0, 0.0, 0.0, 0.1)}
    return joints, Traced("way", "crank", ("body",), slider, along_x, unit), eyes, guides


def rough(rod: float, error: complex = 0.4 + 0.3j) -> object:
    def poses(theta: np.ndarray) -> Mapping[str, Sequence[Pose]]:
        still = np.full(theta.shape, error)
        zero = np.zeros(theta.shape)
        return {
            "crank": [Pose(theta, still)], "rod": [Pose(zero + 0.02, still)], "slider": [Pose(zero, still + rod)],
            "body": [Pose(zero, 0 * still)],
        }  # fmt: skip

    return poses


def place(theta: np.ndarray, e: float, rod: float, offset: float = 0.0) -> np.ndarray:
    return e * np.cos(theta) + np.sqrt(rod**2 - (e * np.sin(theta) - offset) ** 2)


@settings(max_examples=40)
@given(st.floats(0.1, 5), st.floats(12, 100), st.floats(-4, 4))
def test_a_slider_crank_closes_from_rough_poses(e: float, rod: float, offset: float) -> None:
    joints, traced, eyes, guides = slider_crank(e, rod, offset)
    closed = Chain(joints, traced, rough(rod), eyes, guides).close(THETA)
    np.testing.assert_allclose(closed.output, place(THETA, e, rod, offset), atol=1e-12 * rod)
    h = 1e-5
    slope = (place(THETA + h, e, rod, offset) - place(THETA - h, e, rod, offset)) / (2 * h)
    np.testing.assert_allclose(closed.slope, slope, atol=1e-8)


def test_convergence_is_quadratic(monkeypatch: pytest.MonkeyPatch) -> None:
    """Exact derivatives double the digits with each step: 5 steps from 0.5 mm off."""
    joints, traced, eyes, guides = slider_crank(1.5, 48)
    chain = Chain(joints, traced, rough(48), eyes, guides)
    monkeypatch.setattr("camgen.judge.linkage._STEPS", 5)
    np.testing.assert_allclose(chain.close(THETA).output, place(THETA, 1.5, 48), atol=1e-12)


def test_no_answer_where_the_rod_is_too_short() -> None:
    joints, traced, eyes, guides = slider_crank(10, 8)
    closed = Chain(joints, traced, rough(8), eyes, guides).close(THETA)
    reaches = np.abs(10 * np.sin(THETA)) < 8
    assert np.array_equal(np.isfinite(closed.output) & reaches, np.isfinite(closed.output))
    assert 0 < np.count_nonzero(np.isfinite(closed.output)) < len(THETA)


def test_a_singular_chain_is_nan_not_an_exception() -> None:
    joints, traced, eyes, guides = slider_crank(1.5, 0.0)  # both eyes of the rod in one place
    with np.errstate(all="ignore"):
        closed = Chain(joints, traced, rough(0.0), eyes, guides).close(THETA)
    assert np.isnan(closed.output).all()


def test_too_few_joints_are_told() -> None:
    joints, traced, eyes, guides = slider_crank(1.5, 48)
    with pytest.raises(ValueError, match="7 conditions for 3 bodies"):
        Chain(joints[:3], traced, rough(48), eyes, guides)


def test_shares_foretell_what_a_moved_hole_does() -> None:
    """A hole moved by d moves the output by at most share * d, and by that in the worst direction."""
    joints, traced, eyes, guides = slider_crank(4, 20, 2)
    closed, d, largest = Chain(joints, traced, rough(20), eyes, guides).close(THETA), 1e-6, Z
    rod_end = joints[2].a  # type: ignore[union-attr]
    for direction in np.exp(1j * np.linspace(0, math.pi, 60)):
        moved = Chain(joints, traced, rough(20), eyes | {rod_end: 20 + d * direction}, guides).close(THETA)
        largest = np.maximum(largest, np.abs(moved.output - closed.output))
    assert np.all(largest <= closed.shares["P"] * d * 1.001)
    assert np.all(largest >= closed.shares["P"] * d * 0.998)
    # a displacement along the rod shifts the slider by 1 / cos(tilt), one of the guide by tan(tilt)
    tilt = np.arcsin((4 * np.sin(THETA) - 2) / 20)
    np.testing.assert_allclose(closed.shares["P"], 1 / np.cos(tilt), rtol=1e-12)
    np.testing.assert_allclose(closed.shares["guide"], np.abs(np.tan(tilt)), atol=1e-12)


def test_a_link_that_is_turned_over_has_its_holes_mirrored() -> None:
    joints, traced, eyes, guides = slider_crank(4, 20)
    mirrored = {eye: -at.conjugate() if eye.part == "rod" else at for eye, at in eyes.items()}

    def poses(theta: np.ndarray) -> Mapping[str, Sequence[Pose]]:
        found = dict(rough(20)(theta))  # type: ignore[operator]
        return found | {"rod": [Pose(found["rod"][0].angle, found["rod"][0].position, flipped=True)]}

    closed = Chain(joints, traced, poses, mirrored, guides).close(THETA)
    np.testing.assert_allclose(closed.output, place(THETA, 4, 20), atol=1e-12)


@settings(max_examples=40)
@given(st.floats(1, 8), st.floats(25, 40), st.floats(20, 30), st.floats(15, 22))
def test_a_four_bar_against_circles_that_meet(crank: float, coupler: float, output: float, frame: float) -> None:
    longest = max(frame, coupler, output)
    assume(crank + longest < frame + coupler + output - longest - 2)  # turns fully, and well off its folds
    joints = [
        Pin("O", Eye("crank", 0j, 3), Eye("base", 0j, 3), 0.1),
        Pin("A", Eye("crank", complex(crank), 3), Eye("coupler", 0j, 3), 0.1),
        Pin("B", Eye("coupler", complex(coupler), 3), Eye("output", complex(output), 3), 0.1),
        Pin("C", Eye("output", 0j, 3), Eye("base", complex(frame), 3), 0.1),
    ]
    a = crank * np.exp(1j * THETA)
    d = frame - a
    u = (np.abs(d) ** 2 + coupler**2 - output**2) / (2 * np.abs(d))
    b = a + d / np.abs(d) * (u + 1j * np.sqrt(coupler**2 - u**2))

    def poses(theta: np.ndarray) -> Mapping[str, Sequence[Pose]]:
        still = np.zeros(theta.shape, complex)
        return {
            "crank": [Pose(theta, still)], "coupler": [Pose(np.angle(b - a) + 0.02, a)],
            "output": [Pose(np.angle(b - frame) - 0.02, still + frame)], "base": [Pose(np.zeros(theta.shape), still)],
        }  # fmt: skip

    eyes = {eye: eye.at for joint in joints for eye in (joint.a, joint.b)}
    traced = Traced("b", "crank", ("base",), joints[2].a, along_x, unit)
    np.testing.assert_allclose(Chain(joints, traced, poses, eyes, {}).close(THETA).output, b.real, atol=1e-11)


# ---- what is measured ------------------------------------------------------------------------------------------------


def disc(centre: complex, radius: float, n: int = 200) -> Ring:
    return Ring(centre + radius * np.exp(2j * np.pi * np.arange(n) / n), np.zeros(n))


def bar(x: float, y0: float, y1: float, lean: float = 0.0) -> Shape:
    corners = np.array([complex(0, y0), complex(x, y0), complex(x, y1), complex(0, y1)]) * cmath.exp(1j * lean)
    return Shape(Ring(corners, np.zeros(4)), ())


def test_an_eye_is_found_at_every_height() -> None:
    plate = disc(0, 20)
    holes = [disc(5 + 0.01j * k, 1.5 + 0.02 * k) for k in range(3)]
    found = measure(Eye("x", 5 + 0j, 3.0), [[Shape(plate, (hole, disc(-5, 1.5)))] for hole in holes])
    assert found is not None
    assert found.centre == pytest.approx(5 + 0.01j, abs=1e-9)
    assert found.diameter == pytest.approx(3.0 * math.cos(math.pi / 200), abs=1e-9)  # the narrowest, between its flats
    assert found.spread == pytest.approx(0.02, abs=1e-9)
    shaft = measure(Eye("x", 0j, 40.0, shaft=True), [[Shape(plate, ())]])
    assert shaft is not None and shaft.diameter == pytest.approx(40, abs=1e-9)
    assert measure(Eye("x", 9j, 3.0), [[Shape(plate, (holes[0],))]]) is None
    assert measure(Eye("x", 5 + 0j, 6.0), [[Shape(plate, (holes[0],))]]) is None


def test_faces_are_found_with_their_lean() -> None:
    faces = measure_faces(0j, 0.0, 8.0, [[bar(20, 4.1, 9), bar(20, -9, -4.0)]])
    assert faces is not None and (faces.offset, faces.lean, faces.width) == pytest.approx((0.05, 0.0, 8.1), abs=1e-12)
    leaning = measure_faces(0j, 0.0, 8.0, [[bar(20, -4, 4, 0.002)]])
    assert leaning is not None
    assert (leaning.offset, leaning.lean) == pytest.approx((0.0, 0.002), abs=1e-9)
    assert measure_faces(0j, 0.0, 8.0, [[bar(20, 4, 9)]]) is None
    across = [[bar(20, 4, 9), bar(20, -9, -7)]]  # edges square to the line begin 4 mm from it, and are no faces
    assert measure_faces(-5j, 0.0, 8.0, across) is None


# ---- findings --------------------------------------------------------------------------------------------------------


def files(**changed: object) -> dict[str, list[list[Shape]]]:
    at = {"bore": 0j, "strap": 0j, "eye": 48 + 0j, "block": 0j, "strap_r": 4.1, "eye_r": 1.6} | changed
    rim = disc(1.5, 4)
    return {
        "crank": [[Shape(rim, (disc(at["bore"], 1),))]],
        "rod": [[Shape(disc(24, 40), (disc(at["strap"], at["strap_r"]), disc(at["eye"], at["eye_r"])))]],
        "slider": [[Shape(Ring(np.array([-4 - 4j, 9 - 4j, 9 + 4j, -4 + 4j]), np.zeros(4)), (disc(at["block"], 1.5),))]],
        "body": [[bar(90, 4.1, 9), bar(90, -9, -4.1)]],
    }


def verdict(**changed: object) -> set[str]:
    slider, datum = Eye("slider", 0j, 3), Eye("slider", 0j, 0)
    contacts = [
        Pin("O", Eye("crank", 0j, 2), Eye(None, 0j, 2, True), 0),
        Pin("E", Eye("crank", 1.5 + 0j, 8, True), Eye("rod", 0j, 8.2), 0.2),
        Pin("P", Eye("rod", 48 + 0j, 3.2), slider, 0.2, Eye(None, 0j, 3, True)),
        Slide("guide", slider, 0j, 0.0, 8, 0.2, "body"),
        Traced("way", "crank", ("body",), datum, along_x, unit),
    ]

    def motion(theta: np.ndarray, order: int) -> np.ndarray:
        root = np.sqrt(48**2 - (1.5 * np.sin(theta)) ** 2)
        return 1.5 * np.cos(theta) + root if order == 0 else -1.5 * np.sin(theta) * (1 + 1.5 * np.cos(theta) / root)

    found = judge_linkage("dxf", "file", files(**changed), contacts, rough(48), motion, THETA, 0.002)
    return {f.code for f in found.findings if not f.ok}


@pytest.mark.parametrize(
    ("changed", "codes"),
    [
        ({}, set()),
        ({"eye": 48.02 + 0j}, {"MOTION_ERROR"}),
        ({"bore": 0.02 + 0j}, {"MOTION_ERROR", "STROKE_ERROR"}),
        ({"bore": 0.0015 + 0j}, {"STROKE_ERROR"}),
        ({"eye_r": 1.62}, {"PIN_GAP"}),
        ({"strap_r": 4.08}, {"PIN_GAP"}),
        ({"block": 0.02 + 0j}, {"MOTION_ERROR"}),
        ({"block": 0.2j}, {"MOTION_ERROR"}),
        ({"eye": 20 + 0j}, {"PIN_GAP"}),  # not found at all
        ({"strap": 0.5j, "eye": 48.5 + 0.5j}, {"MOTION_ERROR"}),
    ],
)
def test_each_damage_trips_its_finding(changed: dict[str, object], codes: set[str]) -> None:
    assert verdict(**changed) == codes
