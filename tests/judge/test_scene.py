"""The judge of an animation: copies of parts held against turns and shifts written out by hand, and seen to fail."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgen.files.gltf import SECONDS, Shape, Track, glb
from camgen.geometry.mesh import Mesh, placing
from camgen.judge.scene import Flight, judge_scene

THETA = np.linspace(0, math.tau, 91)
CORNERS = np.array([[0, 0, 0], [12, 0, 0], [0, 5, 0], [0, 0, 4.0]])
WEDGE = Mesh(CORNERS, np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]))
STILL = np.zeros(91)
SPIN, CAST = np.exp(1j * THETA), 40 + 5 * np.exp(2j * THETA)
FLIGHTS = {
    "base-1": Flight("base", STILL, STILL + 0j, -3.0, False, 4.0, 13.0),
    "arm-1": Flight("arm", THETA + 0.5, (3 + 2j) * SPIN, 7.0, False, 4.0, 13.0),
    "arm-2": Flight("arm", THETA + 0.2, 1j * SPIN, 1.0, True, 4.0, 13.0),
    "base-2": Flight("base", STILL, CAST, 10.0, False, 4.0, 13.0),
    "swing-1": Flight("arm", THETA + 0.3, CAST + 2 * SPIN, -7.0, False, 4.0, 13.0, standing=True),
}


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    bodies = [
        Track("ground", STILL[:-1], STILL[:-1] + 0j, [("base-1", 0, placing(0, 0j, -3.0, 4.0))]),
        Track(
            "crank",
            THETA[:-1],
            STILL[:-1] + 0j,
            [
                ("arm-1", 1, placing(0.5, 3 + 2j, 7.0, 4.0)),
                ("arm-2", 1, placing(0.2, 1j, 1.0, 4.0, True)),
            ],
        ),
        Track("slider", STILL[:-1], CAST[:-1], [("base-2", 0, placing(0.0, 0j, 10.0, 4.0))]),
        Track("swing", THETA[:-1], CAST[:-1], [("swing-1", 1, placing(0.3, 2, -7.0, 4.0))], True),
    ]
    found = tmp_path_factory.mktemp("scene") / "a.glb"
    found.write_bytes(
        glb("demo", [Shape("base", WEDGE, "#000000"), Shape("arm", WEDGE, "#ffffff")], bodies)
    )
    return found


@settings(max_examples=20)
@given(
    angle=st.floats(-9, 9),
    x=st.floats(-50, 50),
    y=st.floats(-50, 50),
    z=st.floats(-20, 20),
    flipped=st.booleans(),
    point=st.tuples(*[st.floats(-30, 30)] * 3),
)
def test_a_copy_turned_over_lies_within_its_thickness(
    angle: float, x: float, y: float, z: float, flipped: bool, point: tuple[float, float, float]
) -> None:
    u, v, w = point
    if flipped:  # about its y axis, then up by its thickness
        u, w = -u, 4.0 - w
    turned = complex(u, v) * np.exp(1j * angle) + complex(x, y)
    flight = Flight("arm", np.array([angle]), np.array([complex(x, y)]), z, flipped, 4.0, 50.0)
    assert flight.transforms[0] @ (*point, 1) == pytest.approx(
        (turned.real, turned.imag, z + w), abs=1e-9
    )


def test_a_plane_that_stands_has_its_x_along_minus_y_and_its_y_along_z() -> None:
    """A point (1, 2) of it, 3 over it, turned by a right angle to (-2, 1) and shifted by (10, 20)."""
    angle = np.array([math.pi / 2])
    flight = Flight("arm", angle, np.array([10 + 20j]), 0.0, False, 4.0, 9.0, standing=True)
    assert flight.transforms[0] @ (1, 2, 3, 1) == pytest.approx((-3, -8, 21))


def test_every_copy_is_where_it_is_to_be(path: Path) -> None:
    found = judge_scene(path, FLIGHTS, SECONDS)
    assert found.ok and found.limit < 1e-4 and found.message.startswith("5 copies")


@pytest.mark.parametrize("copy", FLIGHTS)
@pytest.mark.parametrize("by", [1e-3, 0.5])
def test_a_copy_that_is_off_is_told_by_how_much(path: Path, copy: str, by: float) -> None:
    """At one frame alone, too; of a turn the farthest point counts."""
    there, late = FLIGHTS[copy], np.arange(91) == 70
    for other in (
        replace(there, z=there.z - by),
        replace(there, place=there.place + by),
        replace(there, place=there.place - 1j * by),
        replace(there, place=there.place + by * late),
        replace(there, place=there.place - 1j * by * late),
    ):
        found = judge_scene(path, {**FLIGHTS, copy: other}, SECONDS)
        assert not found.ok and str(found.where) == f"a.glb, {copy}"
        assert found.measured == pytest.approx(by, abs=1e-4)
    for turned in (there.angle + by, there.angle - by * late):
        found = judge_scene(path, {**FLIGHTS, copy: replace(there, angle=turned)}, SECONDS)
        assert not found.ok and str(found.where) == f"a.glb, {copy}"
        assert (
            13 * math.sin(by) / math.sqrt(2) - 1e-4
            < found.measured
            <= 2 * 13 * math.sin(by / 2) + 1e-4
        )
    assert not judge_scene(
        path, {**FLIGHTS, copy: replace(there, flipped=not there.flipped)}, SECONDS
    ).ok


def test_a_turned_over_copy_stands_out_by_what_it_is_too_thick(path: Path) -> None:
    thick = replace(FLIGHTS["arm-2"], thickness=4.25)
    assert judge_scene(path, {**FLIGHTS, "arm-2": thick}, SECONDS).measured == pytest.approx(
        0.25, abs=1e-4
    )
    upright = replace(FLIGHTS["arm-1"], thickness=4.25)
    assert judge_scene(path, {**FLIGHTS, "arm-1": upright}, SECONDS).ok


def test_other_copies_or_times_are_told(path: Path) -> None:
    for other in (
        {name: each for name, each in FLIGHTS.items() if name != "arm-2"},
        {**FLIGHTS, "arm-3": FLIGHTS["arm-1"]},
        {**FLIGHTS, "arm-1": replace(FLIGHTS["arm-1"], part="base")},
    ):
        found = judge_scene(path, other, SECONDS)
        assert not found.ok and f"5 copies, which are not the {len(other)}" in found.message
        assert math.isnan(found.measured) and found.limit == 0
    assert judge_scene(path, FLIGHTS, 1.01 * SECONDS).measured == math.inf
    every_other = {
        name: replace(each, angle=each.angle[::2], place=each.place[::2])
        for name, each in FLIGHTS.items()
    }
    assert judge_scene(path, every_other, SECONDS).measured == math.inf


def test_where_the_machine_cannot_go_nothing_is_wanted(path: Path) -> None:
    gone = np.where(np.arange(91) > 60, math.nan, 0.0)
    lost = replace(FLIGHTS["base-2"], angle=gone, place=FLIGHTS["base-2"].place + gone)
    assert judge_scene(path, {**FLIGHTS, "base-2": lost}, SECONDS).ok
    off = replace(lost, place=lost.place + 0.5)
    assert judge_scene(path, {**FLIGHTS, "base-2": off}, SECONDS).measured == pytest.approx(
        0.5, abs=1e-4
    )


def test_places_far_away_are_as_exact_as_float32(tmp_path: Path) -> None:
    """A body 3 m away: its places are rounded to 1.2e-4 mm, and no more than a few of those are granted."""
    far = np.full(90, 3000.1 + 2000.7j)
    body = Track("far", THETA[:-1], far, [("arm-1", 0, placing(0.3, 5j, 0, 4.0))])
    (tmp_path / "a.glb").write_bytes(glb("demo", [Shape("arm", WEDGE, "#ffffff")], [body]))
    flight = Flight("arm", THETA + 0.3, np.append(far, far[0]) + 5j * SPIN, 0.0, False, 4.0, 13.0)
    found = judge_scene(tmp_path / "a.glb", {"arm-1": flight}, SECONDS)
    assert found.ok and 1e-4 < found.limit < 0.01
    assert not judge_scene(tmp_path / "a.glb", {"arm-1": replace(flight, z=0.01)}, SECONDS).ok
