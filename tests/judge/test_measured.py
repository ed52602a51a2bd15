"""What is measured of the sections of files: against the numbers from which outlines were drawn."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgen.geometry.rings import Ring, Shape
from camgen.judge.measured import measure_teeth, read
from camgen.machine.features import Eye, Keyed, Teeth

# ---- teeth -----------------------------------------------------------------------------------------------------------


def wheel(radius: float, flanks: Sequence[tuple[float, float]], slant: complex, start: int = 0) -> Ring:
    """A wheel whose teeth cross its pitch circle at the angles (begin, end) of each, by straight flanks that lean as they like.

    slant: from a flank's foot to its tip, of a tooth that stands on Ox; its other flank is the mirror image. start: the vertex
    with which the ring begins.
    """
    points = []
    for begin, end in flanks:
        up, down = slant * cmath.exp(1j * begin), slant.conjugate() * cmath.exp(1j * end)
        one, other = radius * cmath.exp(1j * begin), radius * cmath.exp(1j * end)
        points += [one - 0.4 * up, one + 0.6 * up, other + 0.6 * down, other - 0.4 * down]
    z = np.roll(np.array(points), -start)
    return Ring(z, np.zeros(len(z)))


@settings(max_examples=40)
@given(
    count=st.integers(6, 40),
    tooth=st.floats(-3, 3),
    off=st.floats(-0.3, 0.3),
    thick=st.floats(0.3, 0.7),
    lean=st.floats(-0.3, 0.3),
    start=st.integers(0, 30),
)
def test_teeth_are_where_their_flanks_cross_the_pitch_circle(
    count: int, tooth: float, off: float, thick: float, lean: float, start: int
) -> None:
    """Off by a share of the pitch, and as thick as a share of it; the outline begins on a tooth or in a gap."""
    radius, pitch = 2.0 * count, math.tau / count
    middles = tooth + (off + np.arange(count)) * pitch
    flanks = [(m - thick * pitch / 2, m + thick * pitch / 2) for m in middles]
    ring = wheel(radius, flanks, complex(2, lean), start % (4 * count))
    found = measure_teeth(Teeth("wheel", count, radius, 1.0, tooth), [[Shape(ring, ())]])
    assert found is not None
    assert found.tooth == pytest.approx(tooth + off * pitch, abs=1e-9)
    assert found.thickness == pytest.approx(thick * pitch * radius, abs=1e-9)


def test_teeth_that_differ_count_with_their_means() -> None:
    """One tooth of ten turned by 0.05 rad and 0.1 rad thicker; a second height turned by 0.02 rad: the mean of all."""
    middles = np.arange(10) * math.tau / 10
    halves = np.full(10, 0.15)
    middles[3] += 0.05
    halves[3] += 0.05
    teeth = Teeth("wheel", 10, 20.0, 6.0, 0.0)
    flanks = [np.column_stack([middles + by - halves, middles + by + halves]).tolist() for by in (0, 0.02)]
    heights = [[Shape(wheel(20.0, each, 2 + 0.3j), ())] for each in flanks]
    found = measure_teeth(teeth, heights)
    assert found is not None
    lone = np.angle(9 + cmath.exp(0.5j)) / 10  # the mean direction, modulo the pitch
    assert found.tooth == pytest.approx(lone + 0.01, abs=1e-9)
    assert found.thickness == pytest.approx(20 * (9 * 0.3 + 0.4) / 10, abs=1e-9)
    hub = Shape(Ring(5 * np.exp(1j * np.arange(7)), np.zeros(7)), ())
    assert measure_teeth(teeth, [[hub, heights[0][0]]]) == measure_teeth(teeth, heights[:1])  # the wheel, not what is on it
    assert measure_teeth(Teeth("wheel", 11, 20.0, 6.0, 0.0), heights) is None
    assert measure_teeth(teeth, [[]]) is None


# ---- flats of holes ----------------------------------------------------------------------------------------------------


def hole_with_flat(centre: complex, radius: float, facing: float, depth: float, onward: bool) -> Ring:
    """A round hole whose flat lies `depth` from the centre; facing: the direction from the centre to it, or from it."""
    half = math.acos(depth / radius)
    corners = centre + radius * np.exp(1j * (facing + np.array([half, -half])))
    ring = Ring(corners, np.array([math.tan((math.tau - 2 * half) / 4), 0.0]))
    return ring if onward else ring.reversed()


@settings(max_examples=40)
@given(
    at=st.complex_numbers(max_magnitude=30),
    facing=st.floats(-3, 3),
    off=st.tuples(st.floats(-0.4, 0.4), st.floats(-0.4, 0.4)),
    depth=st.floats(1.0, 2.2),
    onward=st.booleans(),
)
def test_a_flat_is_told_by_the_direction_in_which_it_faces(
    at: complex, facing: float, off: tuple[float, float], depth: float, onward: bool
) -> None:
    """At two heights, in two parts: the mean of all heights, on whichever side of the hole the flat is."""
    a, b = Eye("a", at, 5.0), Eye("b", 0j, 5.0)
    rim = Ring(60 * np.exp(1j * np.arange(0, 6.2, 0.1)), np.zeros(62))
    other = Ring(at + 12 * np.array([1, 1j, -1, -1j]), np.zeros(4))  # beside it, with straight sides
    heights = [[Shape(rim, (hole_with_flat(at, 2.5, facing + by, depth, onward), other.moved(shift=20)))] for by in off]
    opposite = [[Shape(rim, (hole_with_flat(0.1j, 2.5, facing + math.pi, depth, onward),))]]
    found = read([Keyed(a, b, facing)], {"a": heights, "b": opposite}, drawing=False)
    (seen,) = found.facing.values()
    assert seen == pytest.approx((facing + sum(off) / 2, facing), abs=1e-9)


@pytest.mark.parametrize("lost, wide", [("a", 0.34), ("b", 0.34), ("a", 0.1), ("", 0.36)])
def test_a_hole_without_its_flat_is_lost(lost: str, wide: float) -> None:
    """A flat is wider than 0.35 of the diameter; the part without one is named, and where its hole is."""
    rim = Ring(60 * np.exp(1j * np.arange(0, 6.2, 0.1)), np.zeros(62))
    eyes = Eye("a", 3 + 0j, 5.0), Eye("b", -4 + 0j, 5.0)
    depths = {"a": 2.0, "b": 2.0, lost: 2.5 * math.cos(math.asin(wide))}
    files = {each.part: [[Shape(rim, (hole_with_flat(each.at, 2.5, 0.0, depths[each.part], True),))]] for each in eyes}
    found = read([Keyed(*eyes, 0.0)], files, drawing=False)
    place = {"a": "3.000+0.000j", "b": "-4.000+0.000j"}
    flats = [line for line in found.lost if "flat" in line]
    assert flats == ([f"no flat in {lost} near {place[lost]}"] if lost else [])
