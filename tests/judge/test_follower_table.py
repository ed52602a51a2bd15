"""A follower as a user tells it: the places that its keys mean, by sentences of the guide; what is wrong, by the key."""

from __future__ import annotations

import cmath
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from shapes import polygon

from camgen.errors import SpecError
from camgen.judge.contact_faces import ArmFace, SlideFace
from camgen.judge.contact_tips import ArmTip, SlideTip
from camgen.judge.follower_table import FollowerTable, pair_faults, read_follower

DEGREES = st.floats(-170, 170)


def table(**keys: Any) -> FollowerTable:
    return read_follower(keys)


@settings(max_examples=40)
@given(bearing=DEGREES, offset=st.floats(-9, 9), at=st.floats(10, 60), inside=st.booleans())
def test_a_slide_goes_out_along_its_direction(
    bearing: float, offset: float, at: float, inside: bool
) -> None:
    """s = 0 lies `at` from the shaft along the way out, its line `offset` to the right of it; a face is square to it."""
    out = cmath.exp(1j * math.radians(bearing))
    place = out * at - 1j * out * offset
    tip = table(
        motion="translating", radius=4, direction_deg=bearing, offset=offset, at=at, inside=inside
    )
    assert (tip.sense, tip.unit, tip.anchored, tip.axle) == (1, ("mm", 1.0), True, 0j)
    assert isinstance(tip.form, SlideTip) and (
        tip.form.tip_radius,
        tip.form.leaves,
        tip.form.inside,
    ) == (4, 1, inside)
    assert (tip.form.start, tip.form.along) == (pytest.approx(place), pytest.approx(out))
    knife = table(motion="translating", shape="knife", direction_deg=bearing)
    assert isinstance(knife.form, SlideTip) and (
        knife.form.tip_radius,
        knife.form.start,
        knife.anchored,
    ) == (0.0, 0j, False)
    face = table(motion="translating", shape="flat", direction_deg=bearing, at=at)
    assert isinstance(face.form, SlideFace) and face.form.leaves == 1
    assert (face.form.start, face.form.along) == (pytest.approx(out * at), pytest.approx(out))
    assert table(motion="translating", shape="flat").direction == pytest.approx(
        1j
    )  # upwards unless given


@settings(max_examples=40)
@given(
    bearing=DEGREES,
    far=st.floats(20, 90),
    arm=st.floats(5, 90),
    swing=st.floats(5, 175),
    side=st.sampled_from([1, -1]),
)
def test_an_arm_lies_on_one_side_of_its_axle(
    bearing: float, far: float, arm: float, swing: float, side: int
) -> None:
    """`swing` from the line of the shafts, to its left or right: it leaves the cam by turning back; a face faces that way."""
    axle = far * cmath.exp(1j * math.radians(bearing))
    pivot = (axle.real, axle.imag)
    degrees = bearing + side * swing
    at = math.remainder(degrees, 360)
    unit = cmath.exp(1j * math.radians(at))
    tip = table(motion="oscillating", radius=4, pivot=pivot, arm=arm, at_deg=at)
    assert (tip.sense, tip.unit, tip.anchored, tip.axle) == (
        -side,
        ("deg", math.degrees(1)),
        True,
        axle,
    )
    assert isinstance(tip.form, ArmTip) and (tip.form.tip_radius, tip.form.leaves) == (4, -side)
    assert (tip.form.pivot, tip.form.arm) == (axle, pytest.approx(arm * unit))
    assert tip == table(
        motion="oscillating", radius=4, pivot=pivot, arm=arm, at_deg=at, leaves=-side
    ).model_copy(update={"leaves": None})
    with pytest.raises(SpecError) as refused:
        table(motion="oscillating", radius=4, pivot=pivot, arm=arm, at_deg=at, leaves=side)
    assert [(fault.key, fault.value) for fault in refused.value.faults] == [
        ("leaves", f"{side:+d}")
    ]
    face = table(motion="oscillating", shape="flat", pivot=pivot, at_deg=at, face_offset=-2.5)
    assert isinstance(face.form, ArmFace) and (
        face.form.pivot,
        face.form.ahead,
        face.form.leaves,
    ) == (axle, -2.5, -side)
    assert face.form.facing == pytest.approx(unit)
    square = table(motion="oscillating", radius=4, pivot=pivot, arm=arm, leaves=-side)
    assert not square.anchored and square.reference == pytest.approx(1j * side * arm * axle / far)
    own = table(motion="oscillating", shape="flat", pivot=pivot, leaves=-side).form
    assert isinstance(own, ArmFace) and (own.facing, own.ahead) == (
        pytest.approx(1j * side * axle / far),
        0.0,
    )


@pytest.mark.parametrize("at, bearing", [(30.0, 30), (-150.0, 30), (0.0, 0), (180.0, 0)])
def test_an_arm_on_the_line_of_the_shafts_has_no_side(at: float, bearing: float) -> None:
    pivot = (40 * math.cos(math.radians(bearing)), 40 * math.sin(math.radians(bearing)))
    with pytest.raises(SpecError, match="does not lie on the line"):
        table(motion="oscillating", radius=4, pivot=pivot, arm=30, at_deg=at)


@pytest.mark.parametrize(
    "keys, paths",
    [
        ({"motion": "oscillating", "radius": 4, "arm": 30, "leaves": 1}, ["pivot"]),
        ({"motion": "oscillating", "radius": 4, "pivot": (40, 0), "leaves": 1}, ["arm"]),
        ({"motion": "oscillating", "radius": 4, "pivot": (40, 0), "arm": 30}, ["leaves"]),
        (
            {"motion": "oscillating", "radius": 4, "pivot": (0, 0), "arm": 30, "leaves": 1},
            ["pivot"],
        ),
        (
            {"motion": "oscillating", "shape": "flat", "pivot": (40, 0), "arm": 30, "leaves": 1},
            ["arm"],
        ),
        (
            {
                "motion": "oscillating",
                "shape": "flat",
                "pivot": (40, 0),
                "leaves": 1,
                "inside": True,
            },
            ["inside"],
        ),
        ({"motion": "translating"}, ["radius"]),
        ({"motion": "translating", "shape": "knife", "radius": 2}, ["radius"]),
        ({"motion": "translating", "shape": "flat", "offset": 2}, ["offset"]),
        (
            {"motion": "translating", "radius": 2, "pivot": (40, 0), "leaves": 1, "face_offset": 1},
            ["face_offset", "leaves", "pivot"],
        ),
        (
            {"motion": "translating", "shape": "flat", "radius": 2, "inside": True},
            ["radius", "inside"],
        ),
    ],
)
def test_keys_that_do_not_go_together_are_named(keys: dict[str, Any], paths: list[str]) -> None:
    with pytest.raises(SpecError) as refused:
        read_follower(keys)
    assert [fault.key for fault in refused.value.faults] == paths


@settings(max_examples=30)
@given(
    centre=st.tuples(st.floats(-30, 30), st.floats(-30, 30)),
    turned=DEGREES,
    flipped=st.booleans(),
    inside=st.booleans(),
)
@example(
    centre=(4.5, 4.5), turned=1.125, flipped=False, inside=False
)  # two vertices as far from the shaft as each other
def test_an_outline_is_mounted_by_its_shaft(
    centre: tuple[float, float], turned: float, flipped: bool, inside: bool
) -> None:
    """The shaft to the origin, over about Oy through it, then turned; material on the left of the rim, or of a wall."""
    ring = polygon(np.array([0, 9, 5 + 7j]))
    made = table(
        motion="translating",
        radius=1,
        centre=centre,
        turned_deg=turned,
        flipped=flipped,
        inside=inside,
    ).mounted(ring)
    z = ring.points - complex(*centre)
    z = (-z.conj() if flipped else z) * np.exp(1j * math.radians(turned))
    apart = np.abs(made.points[:, None] - z)
    assert (
        len(made.points) == 3
        and np.max(np.min(apart, axis=0)) < 1e-9
        and np.max(np.min(apart, axis=1)) < 1e-9
    )
    assert made.area == pytest.approx(-ring.area if inside else ring.area)


SLIDE = {"motion": "translating", "radius": 3, "at": 30}
ARM = {"motion": "oscillating", "radius": 3, "pivot": (60, 0), "arm": 50, "at_deg": 140}


@pytest.mark.parametrize(
    "first, second, paths",
    [
        ({}, {"direction_deg": -90}, []),
        ({"inside": True}, {"direction_deg": 90}, []),
        ({}, {"direction_deg": 90}, ["--second-follower direction_deg"]),
        ({}, {"direction_deg": -91}, ["--second-follower direction_deg"]),
        ({"inside": True}, {"direction_deg": -90}, ["--second-follower direction_deg"]),
        (
            {"inside": True},
            {"direction_deg": 90, "inside": True},
            ["--second-follower inside", "--second-follower direction_deg"],
        ),
        ({"at": None}, {"direction_deg": -90}, ["--follower at"]),
        (
            {"at": None},
            {"direction_deg": -90, "at": None},
            ["--follower at", "--second-follower at"],
        ),
    ],
)
def test_two_tips_of_one_slide_look_at_each_other(
    first: dict[str, Any], second: dict[str, Any], paths: list[str]
) -> None:
    """Opposite ways, or one way in a groove, where the other one rides inside; both say where they are."""
    pair = [
        {key: value for key, value in (SLIDE | keys).items() if value is not None}
        for keys in (first, second)
    ]
    assert [fault.key for fault in pair_faults(*map(read_follower, pair))] == paths


@pytest.mark.parametrize(
    "second, paths",
    [
        ({"at_deg": -140}, []),
        ({"at_deg": -140, "inside": True}, ["--second-follower leaves"]),
        ({"at_deg": 140, "inside": True}, []),
        ({}, ["--second-follower leaves"]),
        ({"pivot": (61, 0), "at_deg": -140}, ["--second-follower pivot"]),
        ({"at_deg": None, "leaves": 1}, ["--second-follower at_deg"]),
    ],
)
def test_two_tips_of_one_arm_swing_against_each_other(
    second: dict[str, Any], paths: list[str]
) -> None:
    keys = {key: value for key, value in (ARM | second).items() if value is not None}
    assert [fault.key for fault in pair_faults(read_follower(ARM), read_follower(keys))] == paths
    assert [fault.key for fault in pair_faults(read_follower(ARM), read_follower(SLIDE))] == [
        "--second-follower motion"
    ]


@pytest.mark.parametrize(
    "text, keys",
    [
        ("translating,radius=3", {"motion": "translating", "radius": 3}),
        ("radius=3,motion=translating", {"motion": "translating", "radius": 3}),
        (
            " oscillating , pivot = 60/-1.5 , arm=50, leaves=+1, radius=1e0",
            {"motion": "oscillating", "pivot": (60, -1.5), "arm": 50, "leaves": 1, "radius": 1},
        ),
        (
            "translating,shape=flat,flipped=true",
            {"motion": "translating", "shape": "flat", "flipped": True},
        ),
    ],
)
def test_one_line_is_the_same_as_its_table(text: str, keys: dict[str, Any]) -> None:
    assert read_follower(text) == read_follower(keys)


@pytest.mark.parametrize(
    "text, paths",
    [
        ("translating,radius=", ["--follower"]),
        ("translating,=3", ["--follower"]),
        ("translating,radius", ["--follower"]),
        ("translating,radius=3,radius=4", ["--follower radius"]),
        ("translating,motion=oscillating", ["--follower motion"]),
    ],
)
def test_a_line_that_is_none_is_told(text: str, paths: list[str]) -> None:
    with pytest.raises(SpecError) as refused:
        read_follower(text)
    assert [fault.key for fault in refused.value.faults] == paths
