"""Shafts of cams alone, and the rings that hold a bore along them."""

from __future__ import annotations

import numpy as np
import pytest

from camgen.parts.shafts import Seat, shaft_and_bearings


@pytest.mark.parametrize(
    ("bore", "ring", "groove"),
    [
        (8.0, "8 x 0.8", (7.6, "h10", 0.9, 41.9)),
        (12.0, "12 x 1", (11.5, "h11", 1.1, 42.3)),
        (20.0, "20 x 1.2", (19.0, "h11", 1.3, 42.7)),
        (25.0, "25 x 1.2", (23.9, "h12", 1.3, 42.7)),
        (30.0, "30 x 1.5", (28.6, "h12", 1.6, 43.3)),
        (40.0, "40 x 1.75", (37.5, "h12", 1.85, 43.8)),
    ],
)
def test_rings_and_their_grooves_are_those_of_din_471(
    bore: float, ring: str, groove: tuple[float, str, float, float]
) -> None:
    """[DIN 471: d1, s, d2, m as tabled at capitalbolts.in/din-471; 20 in scribd.com/document/416335815; from 25 on d2 with 0/-0.21
    and 0/-0.25, the h12 of 18 to 50 mm (ISO 286-2), at fixawell.com/retaining-ring-din-983.htm] Over the outer walls a
    bore of 40, two rings and 0.3 for shims."""
    shaft, rings, *_ = shaft_and_bearings(Seat(bore, [40.0], ringed=True))
    assert (rings.size, rings.count, rings.standard) == (ring, 2, "DIN 471")
    assert shaft.shaft is not None
    (made,) = (each for each in shaft.shaft.grooves if each.ring == rings.name)
    assert (made.diameter, made.fit, made.width, made.wider) == (*groove[:3], 0.2)
    assert made.apart == pytest.approx(groove[3])
    bare = shaft_and_bearings(Seat(bore, [40.0]))
    assert bare[0].shaft is not None
    assert all(each.ring != rings.name for each in bare[0].shaft.grooves)
    assert bare[1].name == "retaining ring of a bearing"
    assert [each.name for each in shaft_and_bearings(Seat(bore + 0.5, [40.0], ringed=True))] == [
        "shaft"
    ]


def test_a_keyway_lies_in_the_middle_of_its_bore() -> None:
    """A 6004 of 12, 5 before it and half a shaft of 20 free: the bore begins at 27. The longest key 6 x 6 in a bore of 24 is 22, in one of 20 it
    is 20; t1 is 3.5 +0.1 [DIN 6885], N9 is light and P9 tight [berger-tools.co.uk, page 2078]."""

    def keyways(*lengths: float, fit: str = "N9") -> list[tuple[str, float, float, float]]:
        made = shaft_and_bearings(Seat(20.0, lengths, 6.0, fit))[0].shaft
        assert made is not None
        assert all(
            (each.width, each.depth, each.deeper) == (6.0, 3.5, 0.1) for each in made.keyways
        )
        return [(each.fit, each.length, each.start, each.end) for each in made.keyways]

    assert keyways(24.0) == [("N9", 22.0, 28.0, 50.0)]
    (longer,) = keyways(25.0)  # and not 25: the groove of a ring begins beside the bore
    assert longer == ("N9", 22.0, 28.5, 50.5)
    two = [("P9", 20.0, 27.0, 47.0), ("P9", 20.0, 47.0, 67.0)]
    assert keyways(20.0, 20.0, fit="P9") == two
    bare = shaft_and_bearings(Seat(20.0, [24.0]))[0].shaft
    assert bare is not None and not bare.keyways


def test_the_row_of_a_shaft_with_a_sheet_is_short() -> None:
    """What the sheet shows is not said twice."""
    shaft = shaft_and_bearings(Seat(20.0, [24.0], 6.0, ringed=True))[0]
    assert shaft.listing == "20 h6 x 105, C45, see its drawing"


def test_a_shaft_whose_bearings_are_not_known_says_how_much_is_in_the_bore() -> None:
    (shaft,) = shaft_and_bearings(Seat(9.0, [31.5], 3.0))
    assert shaft.size.startswith("9 h6, C45, 31.5 in the bore")
    assert "between 3.25 and 28.25 from where the bore begins" in shaft.details  # a key 3 x 3 x 25


def test_rings_on_either_side_of_each_bearing_keep_it_on_the_shaft() -> None:
    """6004 is 12 wide [ISO 15], rings for 20 are 1.2 thick [DIN 471]: from 3.8 on, 14.4 and 0.1 more over the grooves' outer walls,
    the first bearing between 5 and 17, the other one between 61 and 73; 14 mm shafts have rings but no such bearing, 5 mm ones a bearing but no ring in the table."""
    shaft, held, shims, bearing = shaft_and_bearings(Seat(20.0, [24.0]))
    assert (shims.standard, shims.count, shims.role) == ("DIN 988", 2, "aside")
    assert (held.standard, held.count, held.size) == ("DIN 471", 4, "20 x 1.2")
    assert "two of them now" in held.how and "second retaining ring" in bearing.how
    assert "collar" not in bearing.how
    made = shaft.shaft
    assert made is not None
    walls = [wall for grooves in made.grooves for wall in grooves.walls]
    assert np.ravel(walls) == pytest.approx([3.8, 5.1, 17.0, 18.3, 59.8, 61.1, 73.0, 74.3])
    assert made.bearings is not None and made.bearings.seats == (5.0, 61.0)
    assert made.bores == ((27.0, 24.0),) and made.length == 105.0
    assert [(each.apart, each.wider) for each in made.grooves] == [(pytest.approx(14.5), 0.1)] * 2
    thin, bearing = shaft_and_bearings(Seat(5.0, [24.0], ringed=True))
    assert thin.shaft is not None and not thin.shaft.grooves
    assert "a collar or a shoulder of yours" in bearing.how
    (alone,) = shaft_and_bearings(Seat(14.0, [24.0]))
    assert alone.shaft is None
