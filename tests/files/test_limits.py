"""What standards allow of sizes, against tables of others."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path

import pytest

from camgen.files.limits import decimals, deviations, general, in_limits
from camgen.parts.keyways import keyway, parallel_key

ROOT = Path(__file__).resolve().parents[2]
FACTS = tomllib.loads((ROOT / "tests" / "reference" / "fits.toml").read_text(encoding="utf-8"))


@pytest.mark.parametrize("fit", ["H7", "H8"])
def test_holes_begin_at_their_size(fit: str) -> None:
    for size, upper in FACTS[fit].items():
        assert deviations(float(size), fit) == pytest.approx((0.0, upper / 1000))


def test_shafts_that_turn_in_bushes() -> None:
    """f7 in thousandths [nodeshk.com/skf/art/20021.html, limits of shafts]."""
    published = {6.0: (-22, -10), 10.0: (-28, -13), 14.0: (-34, -16), 24.0: (-41, -20)}
    for size, limits in published.items():
        assert deviations(size, "f7") == pytest.approx(tuple(each / 1000 for each in limits))


def test_shafts_that_go_in_by_hand() -> None:
    """g6 in thousandths [insbearing.com/product9.htm, shaft tolerances]."""
    published = {6.0: (-12, -4), 10.0: (-14, -5), 14.0: (-17, -6), 24.0: (-20, -7), 40.0: (-25, -9)}
    for size, limits in published.items():
        assert deviations(size, "g6") == pytest.approx(tuple(each / 1000 for each in limits))


@pytest.mark.parametrize(
    ("fit", "published"),
    [
        ("E9", {3.0: (14, 39), 6.0: (20, 50), 10.0: (25, 61), 18.0: (32, 75), 30.0: (40, 92)}),
        ("D10", {3.0: (20, 60), 6.0: (30, 78), 10.0: (40, 98), 18.0: (50, 120), 30.0: (65, 149)}),
        ("C11", {3.0: (60, 120), 6.0: (70, 145), 10.0: (80, 170), 18.0: (95, 205)}),
    ],
)
def test_holes_that_run_loose(fit: str, published: dict[float, tuple[int, int]]) -> None:
    """In thousandths, as tables of ISO 286-2 have them; the steps of C beyond 30 are no rows of these."""
    for size, limits in published.items():
        assert deviations(size, fit) == pytest.approx(tuple(each / 1000 for each in limits))
    assert (deviations(40.0, fit) is None) == (fit == "C11")


@pytest.mark.parametrize(
    ("fit", "published"),
    [
        ("j6", {6.0: (-2, 6), 10.0: (-2, 7), 14.0: (-3, 8), 24.0: (-4, 9), 40.0: (-5, 11)}),
        ("k6", {6.0: (1, 9), 10.0: (1, 10), 14.0: (1, 12), 24.0: (2, 15), 40.0: (2, 18)}),
    ],
)
def test_shafts_under_bearings(fit: str, published: dict[float, tuple[int, int]]) -> None:
    """In thousandths [insbearing.com/product9.htm, shaft tolerances]; 80 to 100 is no row of these."""
    for size, limits in published.items():
        assert deviations(size, fit) == pytest.approx(tuple(each / 1000 for each in limits))
    assert deviations(90.0, fit) is None


def test_keyways_light_and_tight() -> None:
    for size, half in FACTS["JS9"].items():
        assert deviations(float(size), "JS9") == pytest.approx((-half / 1000, half / 1000))
    for size, nearest in FACTS["p"].items():
        limits = (-(nearest + FACTS["IT9"][size]) / 1000, -nearest / 1000)
        assert deviations(float(size), "P9") == pytest.approx(limits)


def test_a_step_ends_with_its_size() -> None:
    assert deviations(6.0, "H7") == (0.0, 0.012) and deviations(6.01, "H7") == (0.0, 0.015)
    assert deviations(200.0, "H7") is None
    assert in_limits("H7", 200.0) == "H7" and in_limits("H7", 10.0) == "H7 (+0.015/0)"
    assert in_limits("JS9", 2.0) == "JS9 (±0.0125)" and in_limits("N9", 8.0) == "N9 (0/-0.036)"
    fits = ("H6", "H7", "H8", "H9", "H11", "G6", "G7", "F7", "F8", "JS9", "N9", "P9")
    assert all(deviations(20.0, fit) for fit in fits)


@pytest.mark.parametrize("row", FACTS["keyways"], ids=lambda row: f"bore {row[0]}")
def test_keyways_of_hubs(row: list[float]) -> None:
    bore, *sizes = row
    assert keyway(bore) == tuple(sizes)


def test_bores_without_a_keyway() -> None:
    assert keyway(5.0) is None and keyway(231.0) is None


@pytest.mark.parametrize("kind", "fmcv")
def test_general_tolerances(kind: str) -> None:
    for size, allowed in FACTS["general"][kind].items():
        assert general(float(size), f"ISO 2768-{kind}") == allowed
        assert general(float(size), f"ISO 2768-{kind}K") == allowed


def test_what_no_class_says() -> None:
    assert (
        general(2.0, "ISO 2768-v") == general(3000.0, "ISO 2768-f") == general(9.0, "") == math.inf
    )


def test_decimals_keep_three_quarters_of_a_tolerance() -> None:
    """Rounding to n digits moves a size by at most half of the last one."""
    for allowed in (0.01, 0.05, 0.1, 0.15, 0.2, 0.3, 0.5, 0.8, 2.0):
        digits = decimals(allowed)
        assert 0.5 * 10**-digits <= allowed / 4
        assert digits == 0 or 0.5 * 10 ** (1 - digits) > allowed / 4
    assert decimals(math.inf) == decimals(0.0) == 3


@pytest.mark.parametrize("row", FACTS["keys"], ids=lambda row: f"bore {row[0]}")
def test_keys_and_keyways_of_large_bores_too(row: list[float]) -> None:
    bore, width, height, depth = row
    for size in (bore, bore - 0.5):
        found = keyway(size)
        assert found is not None and found[:2] == (width, depth)
    key = parallel_key(bore, width, depth, 1e3, 3)
    assert key.size.startswith(f"{width:g} x {height:g} x ")
    assert (key.standard, key.count) == ("DIN 6885 form A", 3)


def test_a_key_is_one_that_is_sold() -> None:
    """6 x 6 is sold 14 to 70 long, in steps of R20 [DIN 6885, engineeringhardware.com]; in a bore of 20 to 30 it ends 1 mm inside."""
    sizes = {length: parallel_key(20.0, 6.0, 2.8, length, 1).size for length in (12, 14, 21, 90)}
    shortened = "6 x 6 x 14, shortened to 12, as its bore: shorter ones are not sold"
    assert sizes == {12: shortened, 14: "6 x 6 x 14", 21: "6 x 6 x 18", 90: "6 x 6 x 70"}


def test_a_key_for_another_keyway_has_no_standard() -> None:
    key = parallel_key(20.0, 5.0, 2.8, 12.0, 1)
    assert key.standard == "" and key.size.startswith("5 wide, for a keyway 2.8 deep")
