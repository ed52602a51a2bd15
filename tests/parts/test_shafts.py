"""Shafts of cams alone, and the rings that hold a bore along them."""

from __future__ import annotations

import pytest

from camgen.parts.shafts import retaining_rings, shaft_and_bearings


@pytest.mark.parametrize(
    ("bore", "said"),
    [
        (8.0, "8 x 0.8, in grooves Ø7.6 h10 of the shaft, 0.9 H13 wide"),
        (12.0, "12 x 1, in grooves Ø11.5 h11 of the shaft, 1.1 H13 wide"),
        (20.0, "20 x 1.2, in grooves Ø19 h11 of the shaft, 1.3 H13 wide"),
    ],
)
def test_rings_are_those_of_din_471(bore: float, said: str) -> None:
    """[DIN 471: d1, s, d2, m as tabled at capitalbolts.in/din-471; 20 in scribd.com/document/416335815]"""
    (rings,) = retaining_rings(bore)
    assert (rings.size, rings.count, rings.standard) == (said, 2, "DIN 471")
    assert not retaining_rings(bore + 0.5)


def test_a_shaft_whose_bearings_are_not_known_says_how_much_is_in_the_bore() -> None:
    (shaft,) = shaft_and_bearings(9.0, 31.5)
    assert shaft.size.startswith("9 h6, C45, 31.5 in the bore")
