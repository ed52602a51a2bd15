"""Rows of pins: when each meets its tooth and lets it go, of squares, whose corners are four pins beyond a circle."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from camgen.findings import Finding, Where
from camgen.geometry.rings import Ring, Shape
from camgen.judge.pin_rows import found_pins, judge_row
from camgen.machine.features import Eye, PinRow

TIP, CORNER = 20.0, 23.0  # mm: radius at which the teeth end, and of the square's corners
QUARTER = math.pi / 2
OUT = math.acos(TIP / CORNER)  # rad, by which a corner goes on along the tooth's line
# from a corner to where its edge goes into the circle: the edge's foot is an eighth of a turn on
IN = math.pi / 4 - math.acos(CORNER / math.sqrt(2) / TIP)


def square(turned: float = 0.0) -> Ring:
    return Ring(CORNER * np.exp(1j * (turned + QUARTER * np.arange(4))), np.zeros(4))


def row(tip: complex = TIP + 0j, sense: int = 1, **keys: object) -> PinRow:
    releases = tuple(OUT + QUARTER * k for k in range(4))
    made = PinRow(
        "comb", "star", (0, 1), tip, sense, releases, np.sin, Eye("star", 0j, 4.0), 0.1, 2.0, 0.5
    )
    return replace(made, **keys)  # type: ignore[arg-type]


@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize("tip", [0.0, 2.0])
def test_a_corner_meets_its_tooth_on_the_circle_and_lets_it_go_at_its_end(
    sense: int, tip: float
) -> None:
    """Corners 0.1 rad beyond the teeth in the sense of turning, and so that much sooner."""
    pins = found_pins(square(tip + 0.1 * sense), row(TIP * np.exp(1j * tip), sense))
    releases = [OUT - 0.1 + QUARTER * k for k in range(4)]
    assert [pin.releases for pin in pins] == pytest.approx(releases, abs=1e-9)
    meets = [QUARTER * k - 0.1 - IN for k in range(4)]
    assert [pin.meets for pin in pins] == pytest.approx(meets, abs=1e-9)


def judged(ring: Ring, **keys: object) -> dict[str, Finding]:
    found = judge_row(row(**keys), [[Shape(ring, ())]], Where("x"), 0.05)  # type: ignore[arg-type]
    return {each.code: each for each in found}


def test_a_pin_that_lets_go_late_is_told_with_its_time() -> None:
    """The third corner, 0.02 rad behind: at 2 rad/s 10 ms; what its tooth had before the next pin is shorter by that."""
    points = square().points.copy()
    points[2] *= np.exp(
        -0.02j
    )  # a corner at b lets go at -b: the third one from 0 is at half a turn
    found = judged(Ring(points, np.zeros(4)))
    release = found["RELEASE_ANGLE"]
    assert release.measured == pytest.approx(math.degrees(0.02), abs=1e-6)
    assert release.limit == pytest.approx(math.degrees(0.05 * 0.1)) and not release.ok
    at = math.degrees(OUT + math.pi + 0.02)
    assert f"row comb, pin 3: lets its tooth go at {at:.3f} deg, 10 ms late" in release.message
    early = judged(square(0.004))["RELEASE_ANGLE"]
    assert early.ok and "2 ms early; the worst of 4" in early.message


def test_a_tooth_is_free_from_one_pin_to_the_next() -> None:
    """A quarter less the way on the tooth's line and that from the circle to the corner, and comes to rest in 0.25 s."""
    free = QUARTER - OUT - IN
    spacing = judged(square())["PIN_SPACING"]
    assert spacing.measured == pytest.approx(math.degrees(free), abs=1e-6)
    assert f"is free for {500 * free:.4g} ms; it comes to rest in 250 ms" in spacing.message
    slack = 2 * 0.05 * 0.1  # rad, both corners off
    for back, ok in ((free + 0.9 * slack, True), (free + 1.1 * slack, False)):
        assert judged(square(), back=back)["PIN_SPACING"].ok is ok


def test_pins_that_are_missing_or_not_alone_are_told() -> None:
    points = square().points
    cut = Ring(points[:3], np.zeros(3))  # the corner that lets go second is the fourth
    (missing,) = judged(cut).values()
    assert math.isnan(missing.measured)
    assert missing.message.startswith(f"row comb: pin 2, at {math.degrees(OUT + QUARTER):g} deg,")
    assert missing.message.endswith("is missing")
    twice = judged(square(), releases=row().releases[:3])["RELEASE_ANGLE"]
    assert not twice.ok and "is not alone: 2 let go near there" in twice.message
