"""The stitch's figures against the source's own and against the re-computed ones."""

from __future__ import annotations

import math
import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import differential_evolution

from camgen.errors import DesignError
from camgen.machines.chain_stitch_looper.design import Room, best_clearance, clearances, limits_of
from camgen.machines.chain_stitch_looper.ratio import (
    Condition,
    linear,
    ratio_conditions,
    ratio_range,
)
from camgen.machines.chain_stitch_looper.stitch import Design, Stitch, thread_per_stitch, to_and_fro
from camgen.machines.chain_stitch_looper.study import study
from camgen.motion.laws import LAWS

FACTS = Path(__file__).resolve().parents[1] / "reference" / "chain-stitch-looper.toml"
REFERENCE = tomllib.loads(FACTS.read_text(encoding="utf-8"))
BOUNDS = {
    "nose_over_eye": (1.5, 4.0),
    "loop_rise": (1.5, 4.5),
    "protrusion": (1.0, 2.0),
    "plate_to_spreader": (3.0, 8.0),
}


def example(**changes: Any) -> Stitch:
    e = REFERENCE["example"]
    data = {
        key: tuple(value) if isinstance(value, list) else value
        for key, value in e.items()
        if key != "feed_deg"
    }
    return Stitch(**{**data, "feed": math.radians(e["feed_deg"]), **changes})


def figures(d: Design) -> dict[str, Any]:
    found = {
        name: getattr(d, name)
        for name in (
            "l1",
            "l2",
            "opening",
            "in_fabric",
            "needle_stroke",
            "spreader_stroke",
            "rises",
            "behind",
            "needed",
        )
    }
    found |= {
        f"{name}_deg": np.degrees(getattr(d, name))
        for name in ("capture", "pierce", "pierce_angles")
    }
    found |= {"b": d.given.height, "H": d.given.pitch, "A": d.nose}
    return found | dict(zip(("l1_first", "l2_first", "A_first"), d.first, strict=True))


@pytest.mark.parametrize("name", REFERENCE["printed"])
def test_published_mode_prints_the_source(name: str) -> None:
    found, printed = (
        np.atleast_1d(figures(example().design(True))[name]),
        np.atleast_2d(REFERENCE["printed"][name]),
    )
    assert len(found) == len(printed)
    for value, (wanted, half_digit) in zip(found, printed, strict=True):
        assert abs(value - wanted) <= half_digit + 1e-12


def test_corrected_figures() -> None:
    right, d = REFERENCE["corrected"], example().design()
    assert d.in_fabric == pytest.approx(right["in_fabric"], abs=1e-12)
    assert d.needle_stroke == pytest.approx(right["needle_stroke"], abs=1e-12)
    assert d.rises == pytest.approx(right["rises"], abs=1e-12)
    assert math.degrees(d.slope) == pytest.approx(right["alpha_deg"], abs=1e-12)
    assert (d.l1, d.l2, d.nose) == pytest.approx(right["held"], abs=1e-12)
    assert d.opening == pytest.approx(right["opening"], abs=1e-12)
    assert example(side_gap=0.1).design().opening == pytest.approx(
        right["opening_with_gap"], abs=1e-12
    )
    assert example().between == right["between"]
    # both loops lean alike where l_H = (h2 - h1)/2 and e = z/r, at the angle whose tangent is r
    assert d.pierce_angles == pytest.approx([math.atan(0.8)] * 2, abs=1e-14)
    other = example(protrusion=1.3).design().pierce_angles
    assert abs(other[0] - other[1]) > 1e-3


def test_angles_by_another_route() -> None:
    d = example().design()
    with mpmath.workdps(40):
        s_x = 2 * mpmath.mpf("29.5") / (1 - mpmath.cos(mpmath.pi * 2 / 3))
        capture = [mpmath.acos(1 - 2 * mpmath.mpf(s) / s_x) for s in ("2", "4.5")]
        pierce = [2 * mpmath.pi - mpmath.acos(1 - 2 * mpmath.mpf(s) / s_x) for s in ("16.5", "18")]
    assert d.capture == pytest.approx([float(x) for x in capture], abs=1e-12)
    assert d.pierce == pytest.approx([float(x) for x in pierce], abs=1e-12)
    phi = np.array(d.pierce)
    assert d.risen(phi) == pytest.approx(d.rises, abs=1e-10)
    assert np.all(d.risen(phi, 1) < 0), "the needles come down at the pierce"


def test_errata() -> None:
    right, printed = REFERENCE["corrected"], example().design(True)
    short = example(stroke=34.0).design()
    assert np.degrees(short.out_of_fabric) == pytest.approx(
        right["out_of_fabric_at_34_deg"], abs=0.5
    )
    rows = {row[0]: row for row in study(example(), printed, 3.0, [], {}, 3000.0).tables[2].rows}
    assert list(rows) == [1, 2, 3, 4, 5, 6, 7]

    def told(k: int, column: int) -> list[float]:
        return [float(word) for word in str(rows[k][column]).split(" and ")]

    assert told(1, 3) == pytest.approx([*right["in_fabric"], right["needle_stroke"]], rel=1e-5)
    assert told(2, 3) == pytest.approx(right["pierce_at_34_deg"], abs=1e-3)
    assert told(3, 2) == [23.5] and told(3, 3) == [18.0]
    assert told(4, 3) == pytest.approx(right["needed_at_34"], abs=1e-4)
    assert told(5, 3) == pytest.approx(right["turned"], abs=1e-4)
    assert told(6, 2) == pytest.approx([43.4783]) and told(6, 3) == pytest.approx(
        [right["saved_percent"]], abs=0.05
    )
    assert told(7, 3) == pytest.approx([right["slides_above"][1]], abs=1e-6)


def test_side_by_side_has_both_columns() -> None:
    table = study(example(), example().design(), 3.0, [], {}, 3000.0).tables[1]
    found = {row[0]: row[1:] for row in table.rows}
    assert found["S_m1, mm"] == pytest.approx((24, 28)) and found["S_B2, mm"] == pytest.approx(
        (23.5, 18)
    )
    assert found["l1, mm"] == pytest.approx((8.1, 8.0))


@pytest.mark.parametrize(
    "changes", [{"ratio": 0.9}, {"plate": 7.0}, {"thickness": 3.0}, {"stroke": 40.0}, {"lag": 0.05}]
)
def test_own_figures_are_not_called_published(changes: dict[str, Any]) -> None:
    """The source's figures and errors belong to its own inputs; side_gap is none of them."""
    printed = {"Published and corrected", "Errata of the source"}
    for inputs, wanted in (({"side_gap": 0.1}, printed), (changes, set())):
        given = example(**inputs)
        found = study(given, given.design(), 3.0, [], {}, 3000.0)
        assert {table.title for table in found.tables} & printed == wanted
        assert any("published" in table.columns for table in found.tables) is bool(wanted)
    (own,) = [table for table in found.tables if table.title == "Figures of the design"]
    assert dict(own.rows)["needle stroke S_X, mm"] == given.design().needle_stroke


def test_thread() -> None:
    right, found = REFERENCE["thread"], thread_per_stitch(2.5, 3.0, 4.0)
    assert (found["new"], found["406"]) == (right["new"], right["type_406"])
    assert round(100 * (found["406"] - found["new"]) / found["406"], 1) == 2.1


# ---- loops and the ratio ---------------------------------------------------------------------------------------------


def test_loops_slide_only_above_the_bounds() -> None:
    one, two = REFERENCE["corrected"]["slides_above"]
    for r, first, second in (
        (one - 1e-4, False, False),
        (one + 1e-4, True, False),
        (two + 1e-4, True, True),
    ):
        margins = example(ratio=r).design().margins
        assert (margins[0] > 0, margins[1] > 0) == (first, second)


@settings(max_examples=60)
@given(
    st.tuples(st.floats(2, 8), st.floats(0, 4)),
    st.tuples(st.floats(1.5, 4), st.floats(0.01, 2.5)),
    st.tuples(st.floats(1.5, 4.5), st.floats(1.5, 4.5)),
    st.floats(1, 2),
    st.floats(0.3, 2.0),
    st.floats(3, 8),
)
def test_loops_held_at_the_root_are_never_both_pierced(point, over, rise, protrusion, ratio, plate):  # type: ignore[no-untyped-def]
    given = example(
        point=(point[0], point[0] + point[1]),
        over_eye=(over[0], over[0] + over[1]),
        rise=rise,
        protrusion=protrusion,
        ratio=ratio,
        plate=plate,
    )
    try:
        d = given.design()
    except DesignError:
        return
    assert not min(d.seat_margins) > 0


def test_range_of_the_ratio_is_where_findings_turn() -> None:
    given, blade = example(plate=7.0), 34.0
    found = ratio_range(ratio_conditions(given.design(), blade), 0.9)
    assert found is not None
    (low, why), (high, why_high) = found
    assert low == pytest.approx(6.4 / 7.5, abs=1e-14) and "nose 2" in why
    assert high == pytest.approx(34 / (38 - 2), abs=1e-14) and "blade" in why_high

    def works(r: float) -> bool:
        d = replace(given, ratio=r).design()
        return (
            min(d.margins) > 0
            and blade >= d.spreader_stroke - min(d.before)
            and min(d.offsets().values()) > -1e-9
        )

    assert [works(r) for r in (low - 1e-6, low + 1e-6, high - 1e-6, high + 1e-6)] == [
        False,
        True,
        True,
        False,
    ]


def test_no_ratio_works_where_bounds_cross() -> None:
    assert ratio_range(ratio_conditions(example().design(), 20.0), 0.8) is None


def test_range_is_the_one_round_the_ratio() -> None:
    """A condition may be broken in between: the range is the part that holds the ratio, or else the nearest."""
    between = Condition("not between 1 and 2", lambda r: (r - 1) * (r - 2), (1.0, 2.0))
    touched = Condition("touched at 3", lambda r: abs(r - 3), (3.0,))
    for ratio, wanted in (
        (0.5, (0, 1)),
        (1.2, (0, 1)),
        (1.9, (2, 5)),
        (4.0, (2, 5)),
        (9.0, (2, 5)),
    ):
        found = ratio_range([between, touched, linear("at most 5", 5, -1)], ratio)
        assert found is not None and (found[0][0], found[1][0]) == wanted


def test_other_laws_and_a_lag_give_the_same_events_where_they_should() -> None:
    law = to_and_fro(LAWS["cycloidal"])
    d = example(needle_program=law, spreader_program=law).design()
    assert d.before == pytest.approx(
        [0.8 * s for s in d.given.rise], abs=1e-9
    )  # in step: position follows position
    late = example(lag=math.radians(10)).design()
    assert late.before[0] < 0.8 * 2.0  # the spreader has moved less at the capture
    assert late.risen(np.array([late.capture[0]])) == pytest.approx([2.0], abs=1e-9)


# ---- no such mechanism -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("changes", "published", "quantity", "limit"),
    [
        ({"over_eye": (4.0, 3.0)}, False, "b", 0.0),  # b = -1 + 1 = 0
        ({"over_eye": (4.0, 1.5), "point": (6.0, 4.0)}, False, "b", 0.0),
        ({"needle": 9.0, "spacing": 20.0}, False, "l3", 0.0),
        ({"needle": 6.4}, False, "needle_spacing", 6.4),
        ({"stroke": 16.5}, False, "S_B1", 16.5),  # S_B = S_X
        ({"stroke": 17.0}, False, "S_B2", 17.0),
        ({"stroke": 23.0}, True, "S_B2", 23.0),
        ({"stroke": 19.0, "lag": -math.pi / 2}, False, "f2(phi42) - f2(phi31)", 1e-9),
    ],
)
def test_refused(changes: dict[str, Any], published: bool, quantity: str, limit: float) -> None:
    with pytest.raises(DesignError) as caught:
        example(**changes).design(published)
    assert caught.value.quantity == quantity and caught.value.limit == pytest.approx(limit)


def test_a_rise_of_nothing_is_refused() -> None:
    with pytest.raises(DesignError, match="S01"):
        example(rise=(0.0, 4.5)).design()


def test_published_difference_that_vanishes_is_refused() -> None:
    # a long point lifts the pierce of needle 2 as high as the capture: cos phi31 = cos phi42
    given = example(stroke=47.0 + 1e-9, rise=(23.5, 4.5))
    with pytest.raises(DesignError, match="f2"):
        given.design(True)


def test_equal_points_need_no_compromise() -> None:
    given = example(point=(5.0, 5.0))
    assert given.height == pytest.approx(2.5)  # both conditions say a2 - a1


# ---- search ----------------------------------------------------------------------------------------------------------


ROOM = Room(40.0, 16.0, 4.0)


@pytest.mark.long
def test_search_beats_chance_and_another_search() -> None:
    best = best_clearance(example(), BOUNDS, ROOM)
    worst = min(clearances(best))
    assert all(value <= limit for value, limit in limits_of(best, ROOM).values())
    assert best.design().spreader_stroke <= 40 and best.design().nose <= 16
    assert clearances(best)[:4] == pytest.approx(
        [gap / math.hypot(1, best.ratio) for gap in best.design().offsets().values()], abs=1e-12
    )
    low, high = np.array(
        [(1.5, 4), (1.5, 4), (1.5, 4.5), (1.5, 4.5), (1, 2), (3, 8), (0, 8), (0.5, 2)]
    ).T

    def cost(x: np.ndarray) -> float:
        v = [float(value) for value in x]
        g = replace(
            example(),
            over_eye=(v[0], v[1]),
            rise=(v[2], v[3]),
            protrusion=v[4],
            plate=v[5],
            setback=v[6],
            ratio=v[7],
        )
        lack = sum(max(value - limit, 0.0) for value, limit in limits_of(g, ROOM).values())
        return -min(clearances(g)) + 50 * lack

    chance = np.random.default_rng(6)
    assert min(cost(x) for x in chance.uniform(low, high, (3000, 8))) > -worst
    found = differential_evolution(
        cost, list(zip(low, high, strict=True)), seed=2, maxiter=60, popsize=8, tol=1e-8
    )
    assert worst > -found.fun - 0.01


@pytest.mark.long
@pytest.mark.parametrize(
    ("room", "quantity"),
    [(Room(10.0, 16.0, 4.0), "spreader_stroke"), (Room(40.0, 16.0, 4.0, 3.0), "clear")],
)
def test_search_tells_when_there_is_nothing(room: Room, quantity: str) -> None:
    with pytest.raises(DesignError, match=quantity):
        best_clearance(example(), BOUNDS, room)
