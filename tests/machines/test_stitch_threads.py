"""Threads of the chain stitch in the moving picture: their lengths are those of the source's formulas, and they never jump."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from camgen.machines.chain_stitch_looper.stitch import SOURCE, Design, thread_per_stitch
from camgen.machines.chain_stitch_looper.threads import (
    course,
    lengths,
    loop,
    loop_shift,
    moments,
    seam,
)

TURN = np.linspace(0, 2 * math.pi - 1e-9, 3601)
GOOD = replace(SOURCE, plate=5.0, ratio=1.1, setback=2.0)
LAGGING = replace(GOOD, lag=math.radians(2))


@pytest.fixture(scope="module")
def design() -> Design:
    return GOOD.design()


@pytest.mark.parametrize("given", [GOOD, LAGGING, SOURCE])
def test_a_thread_never_jumps_and_ends_as_it_began(given: object) -> None:
    d = given.design()  # type: ignore[attr-defined]
    fastest = max(
        float(np.abs(d.moved(TURN, 1)).max()),
        float(np.abs(d.risen(TURN, 1)).max()),
        d.given.spacing,
    )
    for k in (0, 1):
        way = course(d, k, TURN)
        assert np.isfinite(way).all()
        step = np.abs(np.diff(way, axis=0)).max(axis=0) / (TURN[1] - TURN[0])
        assert (step < 3 * fastest + 60).all(), step  # mm a radian
        # after a turn the needle's loop is the one that is made, and that one the finished one
        assert way[-1][[3, 6]] == pytest.approx(way[0][[5, 8]], abs=1e-6)


def test_a_loop_that_is_held_at_the_root_has_the_angle_of_the_table(design: Design) -> None:
    """gamma' is that at a nose l1 + l2 + z + L_C past its needle; fig. 4, b."""
    d = design
    for k, (angle, level, behind) in enumerate(zip(d.pierce_angles, (1, 0), d.behind, strict=True)):
        past = d.given.spacing + d.l1 + d.l2 + behind  # the source's needed way of the nose
        assert math.atan2(past - d.l1, d.given.levels[level]) == pytest.approx(angle)
        rising = np.linspace(d.capture[k], math.pi, 2001)
        nose = d.noses(rising)[k]
        assert loop_shift(d, k, rising) == pytest.approx(np.maximum(nose - d.l1, 0.0), abs=1e-9)


def test_a_loop_is_where_its_nose_and_needles_are(design: Design) -> None:
    d = design
    for k in (0, 1):
        out, deep = loop(
            d, k, np.array([d.capture[k], d.entries[k], d.shed[k] - 1e-9, 2 * math.pi - 1e-9])
        )
        assert out[0] == 0 and deep[0] == pytest.approx(d.given.levels[k])
        # pierced: beyond the other needle, on the nose; shed: at that needle, then pulled up to the fabric
        assert d.given.spacing <= out[1] <= d.noses(np.array([d.entries[k]]))[k][0] + 1e-9
        assert out[2:] == pytest.approx(d.given.spacing, abs=1e-6) and deep[3] == pytest.approx(
            0, abs=1e-6
        )
        assert math.degrees(d.shed_angles[k]) == pytest.approx(
            math.degrees(math.atan2(out[2], deep[2])), abs=1e-6
        )
    numbers, table = lengths(d)
    assert len(table.rows) == 6 == len(numbers)
    assert numbers["loop_length_capture_2_mm"] == pytest.approx(2 * d.given.levels[1])
    assert numbers["loop_length_shedding_1_mm"] == pytest.approx(
        2 * math.hypot(d.given.spacing, d.given.levels[0]), abs=1e-5
    )


def test_the_seam_that_is_drawn_takes_the_thread_of_the_source(design: Design) -> None:
    """2t + 4q of 8m + 2t + 4q, per stitch; the legs are drawn a little apart."""
    plot = seam(design, 3.0)
    z = np.concatenate(
        [np.append(x + 1j * y, complex(math.nan, math.nan)) for _, x, y in plot.series]
    )
    drawn = float(np.nansum(np.abs(np.diff(z)))) / 3
    q = math.hypot(6.4, 3.0)
    assert drawn == pytest.approx(2 * 3 + 4 * q, rel=2e-3)
    assert thread_per_stitch(3.5, 3.0, 6.4)["new"] == pytest.approx(8 * 3.5 + 2 * 3 + 4 * q)
    assert drawn != pytest.approx(thread_per_stitch(0.0, 3.3, 6.4)["new"], rel=2e-3)


def test_figure_4_shows_both_moments(design: Design) -> None:
    capture, pierce = moments(design)
    named = [{name: complex(x, y) for name, x, y in plot.points} for plot in (capture, pierce)]
    eye = named[0]["N1"] + 1j * design.given.point[0]
    assert named[0]["P1"].imag - eye.imag == pytest.approx(
        design.given.over_eye[0]
    )  # the nose so far over the eye
    assert named[0]["P1"].real == pytest.approx(0, abs=1e-6)
    assert named[1]["N2"].imag == pytest.approx(
        named[1]["P1"].imag, abs=1e-6
    )  # the other needle's tip at nose level
