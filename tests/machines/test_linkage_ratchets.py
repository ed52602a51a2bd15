"""[[ratchet]] in a linkage: what its spec says, where the pawl falls, what is made, and what is refused by which key."""

from __future__ import annotations

import cmath
import copy
import math
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

import camgen
from camgen import load
from camgen.errors import DesignError, SpecError
from camgen.numerics import Points
from camgen.parts.wheels.ratchet import PawlLaw, RatchetWheel, pawl_of
from camgen.pipeline.scope import not_judged, of_parts

SPEC: dict[str, Any] = {
    "mechanism": "linkage",
    "name": "winch",
    "points": {"O": [0, 0], "B": [50, 0], "H": [64, 16], "S": [40, 46]},
    "links": {"ground": ["O", "B", "S"], "wheel": ["O"], "pawl": ["B", "H"]},
    "drive": {"link": "wheel", "speed_rpm": 20},
    "ratchet": [{"a": "wheel", "b": "pawl", "teeth": 12, "radius": 26, "name": "stop"}],
    "spring": [{"between": ["H", "S"], "rate": 0.1, "preload": 1}],
    "output": [{"name": "wheel", "link": "wheel"}],
}
WHEEL = RatchetWheel(12, 26.0, 22.75)
PAWL = pawl_of(WHEEL, 50.0, 1.2, math.radians(38))


def spec(**changes: Any) -> dict[str, Any]:
    """The tables with other keys of their ratchet."""
    tables = copy.deepcopy(SPEC)
    tables["ratchet"][0] |= changes
    return tables


@pytest.fixture(scope="module")
def machine() -> camgen.Mechanism:
    return load(SPEC)


def saw(turn: float) -> Any:
    """The wheel by its corners, by the test's own hand."""
    z = []
    for k in range(12):
        z += [cmath.rect(26.0, k * math.tau / 12), cmath.rect(22.75, (k + 1) * math.tau / 12)]
    corners = np.array(z) * cmath.exp(1j * turn)
    return shapely.Polygon(np.column_stack([corners.real, corners.imag]))


def laid(turn: float) -> float:
    """How far the pawl turns in until its round end lies on the corners, from outside, by halving."""
    teeth = saw(turn)

    def apart(lift: float) -> float:
        z = PAWL.pivot + PAWL.arm * cmath.exp(1j * lift)
        return float(teeth.distance(shapely.Point(z.real, z.imag))) - 1.2

    steps = np.linspace(-0.3, 0.2, 4001)
    first = next(k for k, lift in enumerate(steps) if apart(float(lift)) < 0)
    low, high = float(steps[first - 1]), float(steps[first])
    for _ in range(40):
        middle = (low + high) / 2
        low, high = (middle, high) if apart(middle) > 0 else (low, middle)
    return low


def test_a_pawl_lies_where_a_circle_laid_on_the_teeth_does() -> None:
    turns = PAWL.dropping + math.tau / 12 * np.array([0.01, 0.2, 0.5, 0.8, 0.97])
    found = PAWL.lift(turns)
    assert found == pytest.approx([laid(float(turn)) for turn in turns], abs=1e-8)


def test_it_falls_where_tip_end_and_pivot_are_on_one_line_by_as_much_as_is_laid() -> None:
    tip = cmath.rect(26.0, PAWL.dropping)
    assert abs(tip - PAWL.pivot) == pytest.approx(abs(PAWL.arm) + 1.2, abs=1e-9)
    beside = 1e-5
    by = laid(PAWL.dropping + beside) - laid(PAWL.dropping - beside)
    assert PAWL.drop == pytest.approx(by, abs=2e-3)  # steep before: sqrt(2 * 1e-5)
    assert math.degrees(PAWL.drop) == pytest.approx(5.94, abs=0.01)


def test_a_tooth_draws_it_in_by_the_angle_asked_for_at_the_face() -> None:
    assert PAWL.draw == pytest.approx(math.radians(38))
    assert abs(PAWL.pivot) == pytest.approx(50)
    foot = PAWL.seat + 1.2j  # on the face along Ox, since the end lies before it
    line = PAWL.pivot - foot
    assert cmath.phase(line / -1j) == pytest.approx(math.radians(38))


@pytest.mark.parametrize("way", [1, -1])
def test_derivatives_are_those_of_the_law(way: Any) -> None:
    law = PawlLaw(PAWL, way)
    theta = way * (PAWL.dropping + math.tau / 12 * np.linspace(0.03, 0.85, 60))
    h = 1e-6
    for order in (0, 1):
        slope = (law(theta + h, order) - law(theta - h, order)) / (2 * h)
        off = np.abs(slope - law(theta, order + 1))
        assert np.sort(off)[:-4].max() < 1e-6  # but where it comes to a tip
    assert law(np.array([way * PAWL.dropping - way * 1e-4]), 1)[0] == 0.0  # it falls freely


def test_the_arm_keeps_off_the_tips_and_the_end_touches(machine: camgen.Mechanism) -> None:
    arm = PAWL.outline(6.0)

    def corners(turn: complex) -> Points:
        pieces = [np.atleast_1d(p.at(np.linspace(p.t0, p.t1, 60))) for p in arm.pieces]
        return np.concatenate(pieces) * turn + PAWL.pivot

    for turn in PAWL.dropping + math.tau / 12 * np.linspace(0.01, 0.99, 30):
        z = corners(cmath.exp(1j * float(PAWL.lift(turn))))
        body = shapely.Polygon(np.column_stack([z.real, z.imag]))
        assert body.distance(saw(float(turn))) < 1e-3
        assert body.intersection(saw(float(turn))).area < 1e-6


def test_without_files_nothing_is_said_to_hold(machine: camgen.Mechanism) -> None:
    codes = {each.code for each in not_judged(of_parts(machine), [], [])}
    assert {"PAWL_HOLDS", "CONTACT", "MOTION_ERROR"} <= codes


def test_parts_lie_on_one_level(machine: camgen.Mechanism) -> None:
    heights = {mount.part: mount.z for mount in machine.assembly.mounts}
    assert heights["ratchet-stop"] == heights["pawl-stop"] > heights["pawl"]


@pytest.mark.parametrize(
    ("changes", "path", "words"),
    [
        ({"a": "weel"}, ("ratchet", 0, "a"), "wheel"),
        ({"b": "wheel"}, ("ratchet", 0, "b"), "another link"),
        ({"b": "ground"}, ("ratchet", 0, "b"), "moves"),
        ({"a": "pawl", "b": "wheel"}, ("ratchet", 0, "a"), "turns one way"),
        ({"teeth": 0}, ("ratchet", 0, "teeth"), "3"),
        ({"depth": 26}, ("ratchet", 0, "depth"), "below radius"),
        ({"name": "drive"}, ("ratchet", 0, "name"), "drive already has this one"),
        ({"name": "wheel"}, ("links", "wheel"), "a ratchet already has this one"),
    ],
)
def test_faults_say_where_and_what(
    changes: dict[str, Any], path: tuple[str | int, ...], words: str
) -> None:
    with pytest.raises(SpecError) as caught:
        load(spec(**changes))
    found = [each for each in caught.value.faults if tuple(each.path) == path]
    assert any(words in f"{each.expected} {each.nearest}" for each in found), caught.value


@pytest.mark.parametrize(
    ("changes", "path", "words"),
    [
        ({"spring": []}, ("ratchet", 0, "b"), r"add \[\[spring\]\]"),
        ({"output": [{"name": "p", "link": "pawl"}]}, ("output", 0, "link"), "falls behind"),
        ({"output": [{"name": "p", "point": "H"}]}, ("output", 0, "point"), "falls behind"),
        (
            {"drive": {"link": "wheel", "range_deg": [0, 90]}},
            ("ratchet", 0, "a"),
            "turns one way",
        ),
    ],
)
def test_what_is_missing_beside_it_is_told_by_key(
    changes: dict[str, Any], path: tuple[str | int, ...], words: str
) -> None:
    with pytest.raises(SpecError, match=words) as caught:
        load(copy.deepcopy(SPEC) | changes)
    assert path in [tuple(each.path) for each in caught.value.faults]


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"radius": 80}, "distance of the pawl's pivot.*draw the pivot further off"),
        ({"end_radius": 4}, "smaller end_radius"),
        ({"depth": 6}, "smaller depth"),
        ({"draw_deg": 15}, "greater draw_deg"),
        ({"radius": 42}, "pivot further off"),
    ],
)
def test_ratchets_that_cannot_be_are_refused_by_what_to_change(
    changes: dict[str, Any], words: str
) -> None:
    with pytest.raises(DesignError, match=words):
        assert load(spec(**changes)).assembly


@pytest.mark.parametrize(
    ("wheel", "distance", "end", "draw_deg", "words"),
    [
        (
            RatchetWheel(12, 10.0, 1.0),
            3.0,
            0.1,
            0.5,
            "distance of the pawl's pivot.*smaller radius",
        ),
        (WHEEL, 20.0, 1.2, 38, "distance of the pawl's pivot.*smaller radius"),
        (WHEEL, 28.0, 3.0, 20, "reach of the pawl"),
        # the chords of few teeth dip below their roots, and the end passes over them
        (RatchetWheel(3, 30.0, 24.0), 75.0, 4.0, 50, "swings through .*more teeth"),
        (RatchetWheel(6, 30.0, 29.1), 33.0, 0.6, 38, "swings through .*more teeth"),
        # the end falls off the tip before there is room for it beside the face
        (RatchetWheel(3, 10.0, 5.0), 20.0, 2.5, 1, "lock to the drop .*greater draw_deg"),
        # the pawl reaches over the tip of the tooth before
        (RatchetWheel(100, 30.0, 28.2), 48.0, 0.3, 60, "lost .*smaller draw_deg"),
    ],
)
def test_pawls_that_cannot_hold_a_tooth_are_none(
    wheel: RatchetWheel, distance: float, end: float, draw_deg: float, words: str
) -> None:
    with pytest.raises(DesignError, match=words):
        pawl_of(wheel, distance, end, math.radians(draw_deg))


@given(
    st.integers(3, 60),
    st.floats(0.03, 0.9),
    st.floats(0.2, 5),
    st.floats(0.002, 0.3),
    st.floats(1, 79),
)
def test_a_pawl_is_refused_or_lies_on_the_wheel_all_round(
    teeth: int, deep: float, far: float, end: float, draw_deg: float
) -> None:
    """Of a wheel of 10 mm; sizes in its radius. It is drawn in as asked, and rests within a tooth of each drop."""
    wheel = RatchetWheel(teeth, 10.0, 10.0 * (1 - deep))
    try:
        pawl = pawl_of(wheel, 10 * far, 10 * end, math.radians(draw_deg))
    except DesignError:
        return
    assert pawl.draw == pytest.approx(math.radians(draw_deg), abs=1e-9)
    assert np.isfinite(pawl.lift(np.linspace(0, wheel.pitch, 50))).all()
    assert 0 < pawl.dropping < wheel.pitch
