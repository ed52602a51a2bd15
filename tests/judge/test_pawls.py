"""Wheel and pawl by their outlines alone, in both senses: one that loses most of a tooth holds, and a low tip is where it is."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Literal

import pytest

from camgen.findings import Finding, Where
from camgen.geometry.arcs import bulges
from camgen.geometry.rings import Ring
from camgen.judge.pawls import PawlMotion, judge_pawl
from camgen.machine.features import Edge, Eye, PawlPair
from camgen.parts.wheels.ratchet import PawlLaw, RatchetWheel, pawl_of

TEETH = 40
WHEEL = RatchetWheel(TEETH, 26.0, 22.75)
PAWL = pawl_of(WHEEL, 50.0, 0.5, math.radians(60))
LOW = 0.03  # mm


def judged(passes: Literal[1, -1], low_tip: int | None = None) -> Iterator[Finding]:
    """Findings, one after the other; low_tip: the corner of the wheel that is nearer to its axis, in its sense."""
    points, straight = bulges(WHEEL.outline())
    if low_tip is not None:
        points[low_tip] *= 1 - LOW / abs(points[low_tip])
    mirrored = passes < 0
    wheel = Ring(points, straight).moved(mirror=mirrored)
    pawl = Ring(*bulges(PAWL.outline(4.5))).moved(mirror=mirrored)
    line = PAWL.pivot.conjugate() if mirrored else PAWL.pivot
    a, b = (Edge(part, Eye(part, 0j, 5.0)) for part in ("wheel", "pawl"))
    feature = PawlPair(
        "stop",
        (a,),
        (b,),
        "O",
        "B",
        passes=passes,
        teeth=TEETH,
        first=0.0,
        end=PAWL.end,
        friction=0.7,
        lost=PAWL.dropping,
    )
    motion = PawlMotion(feature, wheel, pawl, line, PawlLaw(PAWL, passes), 0.0)
    return judge_pawl(motion, 1e-3, Where("drawn"))


@pytest.mark.long
@pytest.mark.parametrize("passes", [1, -1])
def test_a_pawl_that_loses_more_than_half_a_tooth_holds(passes: Literal[1, -1]) -> None:
    assert 0.8 < PAWL.dropping / WHEEL.pitch < 1
    found = {each.code: each for each in judged(passes)}
    assert all(each.ok for each in found.values())
    assert found["PAWL_HOLDS"].measured == pytest.approx(math.tan(math.radians(60)), rel=1e-4)


def test_a_low_tip_is_told_at_the_same_way_on_in_both_senses() -> None:
    first, second = (next(judged(passes, low_tip=6)) for passes in (1, -1))
    for error in (first, second):
        assert error.code == "MOTION_ERROR" and not error.ok
        assert error.measured == pytest.approx(LOW, rel=0.2)
        # the wheel comes to its first tip, then to those behind: the fourth is three ahead
        assert f"at tooth {TEETH + 1 - 3}" in error.message
    assert first.where.theta == pytest.approx(second.where.theta)
    assert 0 < first.where.theta < math.tau
