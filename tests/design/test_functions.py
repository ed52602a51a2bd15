"""Four-bars for a function: the pairs are met as the lengths themselves say, and what cannot be had is told."""

from __future__ import annotations

import cmath
import csv
import math
import re
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from camgen.design.functions import Generator, machine, search
from camgen.design.run import design
from camgen.design.wanted import FunctionWish, PathWish
from camgen.errors import DesignError, SpecError
from camgen.machine.run import solve
from camgen.machines.linkage.mechanism import Linkage
from camgen.spec import validate

TABLES = {"mechanism": "linkage", "name": "found"}
LOG = tuple(
    (60 * (x - 1), 60 * math.log(x) / math.log(2)) for x in (1.067, 1.5, 1.933)
)  # Chebyshev's spacing of 1..2


def missed(made: Generator, pairs: Any) -> float:
    """How much shorter or longer than it is the coupler would have to be at the pairs, as a share of the frame."""
    points = made.places(60.0)
    o, a, b, c = (points[name] for name in "OABC")
    (x0, y0), lengths = pairs[0], []
    for x, y in pairs:
        crank, rocker = (cmath.rect(1, math.radians(turn)) for turn in (x - x0, y - y0))
        lengths.append(abs(c + rocker * (b - c) - (o + crank * (a - o))))
    return (max(lengths) - min(lengths)) / abs(c - o)


@pytest.fixture(scope="module")
def logarithm() -> list[Generator]:
    return search(FunctionWish(function=LOG))


def test_three_pairs_are_met_exactly(logarithm: list[Generator]) -> None:
    for made in logarithm[:3]:
        assert (
            missed(made, LOG) < 1e-7 and made.error < 1e-9 and made.transmission >= math.radians(30)
        )


def test_a_linkage_s_own_function_is_found_again_and_judged_by_the_kernel() -> None:
    points = {"O": [0, 0], "C": [60, 0], "A": [12, 16], "B": [50, 45]}
    links = {"ground": ["O", "C"], "crank": ["O", "A"], "coupler": ["A", "B"], "rocker": ["C", "B"]}
    output = [{"name": "turn", "link": "rocker"}]
    own = validate(
        Linkage,
        {**TABLES, "points": points, "links": links, "drive": {"link": "crank"}, "output": output},
    )
    turns = np.radians([0, 15, 30, 45, 60, 75, 90])
    made = np.degrees(solve(own.chain, turns, 0)["turn"].real)
    pairs = tuple(zip(np.degrees(turns).tolist(), (made - made[0]).tolist(), strict=True))
    wish = FunctionWish(function=pairs)
    best = search(wish)[0]
    assert math.degrees(best.error) < 1e-3 and missed(best, pairs) < 1e-4
    within = FunctionWish(function=pairs, tolerance=0.01)
    data = machine(within, TABLES, best).data()
    found = validate(Linkage, data)
    (finding,) = (each for each in found.limits() if each.code == "FUNCTION_ERROR")
    assert finding.ok and finding.measured == pytest.approx(math.degrees(best.error), abs=1e-5)
    wrong = machine(within, TABLES, best).data()
    wrong["output"][0]["function"]["at"][3][1] += 1.0
    (finding,) = (
        each for each in validate(Linkage, wrong).limits() if each.code == "FUNCTION_ERROR"
    )
    assert (
        not finding.ok
        and finding.measured == pytest.approx(1.0, abs=0.01)
        and "theta 45 deg" in finding.message
    )


def test_a_front_trades_error_for_transmission() -> None:
    bent = tuple((x, 60 * (x / 90) ** 2) for x in range(0, 91, 10))
    front = search(FunctionWish(function=bent))
    errors, angles = [each.error for each in front], [each.transmission for each in front]
    assert len(front) > 1 and errors == sorted(errors) and angles == sorted(angles)


@pytest.mark.long
def test_the_search_goes_along_the_bounds_to_the_tolerance_and_the_transmission_angle() -> None:
    # another route, least squares on all lengths from many starts, ends at a coupler of twice the frame as well
    square = tuple((x, x**2 / 90) for x in (0, 22.5, 45, 67.5, 90))
    front = search(FunctionWish(function=square, tolerance=0.125))
    assert any(
        math.degrees(each.error) < 0.1197 and math.degrees(each.transmission) > 61.1
        for each in front
    )
    assert all(
        math.degrees(each.error) <= 0.125 and max(each.lengths) <= 2 + 1e-9 for each in front
    )
    sine = ((6.02885683, 6.3019), (45, 42.4264), (83.97114317, 59.6682))
    steep = search(FunctionWish(function=sine, transmission_deg=80))[0]
    assert steep.transmission > math.radians(81.40) and missed(steep, sine) < 1e-7
    np.testing.assert_allclose(60 * np.array(steep.lengths), [73.618, 120, 43.509], atol=0.02)


def test_the_keys_that_a_remedy_names_are_there() -> None:
    for wish in (FunctionWish(function=LOG), PathWish(path=((0, 0), (9, 0), (0, 9)))):
        named = re.findall(r"wanted\.(\w+)", wish.further)
        assert named and set(named) <= set(type(wish).model_fields)


@pytest.mark.long
def test_what_no_four_bar_transmits_is_told() -> None:
    with pytest.raises(
        DesignError,
        match=r"least transmission angle is [1-7]\d\..* limit: at least 80 deg.*wanted.transmission_deg",
    ):
        search(FunctionWish(function=((0, 0), (20, 100), (40, 0)), transmission_deg=80))


@pytest.mark.long
def test_without_a_tolerance_a_useless_four_bar_is_none() -> None:
    hardly: dict[str, Any] = {
        "function": [[0, 0], [20, 100], [40, 0]],
        "transmission_deg": 20,
        "lash": 60,
    }  # a swing of 100 deg
    with pytest.raises(
        DesignError, match=r"nearest buildable design is [12]\d\.\d+ deg off; .*twentieth .*, 5 deg"
    ):
        design({**TABLES, "wanted": hardly})
    assert FunctionWish(function=LOG).allowance == pytest.approx((LOG[2][1] - LOG[0][1]) / 20)


def test_all_faults_of_wish_and_spec_at_once(tmp_path: Path) -> None:
    (spec := tmp_path / "wish.toml").write_text(
        'mechanism = "disc-cam"\nname = "a b"\n[wanted]\nfunction = [[0, 0], [0, 5], [400, 5]]\nlongest = 5\n'
        "[parts]\nthickness = -1\n[points]\nA = [0, 0]\n",
        encoding="utf-8",
    )
    with pytest.raises(SpecError) as told:
        design(spec)
    paths = [fault.key for fault in told.value.faults]
    assert paths == [
        "points",
        "mechanism",
        "name",
        "parts.thickness",
        "wanted.function",
        "wanted.function",
        "wanted.longest",
    ]


@pytest.mark.long
def test_the_spec_keeps_its_comments_and_line_ends_and_the_front_its_pictures(
    tmp_path: Path,
) -> None:
    pairs = [[round(x, 3), round(y, 3)] for x, y in LOG]
    text = f'# mine\r\nmechanism = "linkage" # kept\r\nname = "log"\r\n[wanted]\r\nfunction = {pairs}\r\nlash = 5\r\n'
    (spec := tmp_path / "wish.toml").write_bytes(text.encode())
    found = design(spec, keep=lambda front: front.write(tmp_path / "front"))
    assert found.count("\r\n") == found.count("\n") > 10 and "# mine" in found and "# kept" in found
    assert tomllib.loads(found)["limits"]["lash_deg"] == 5 and "wanted" not in tomllib.loads(found)
    with open(tmp_path / "front" / "front.csv", encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert all(0 < float(row["lash"]) <= 5 for row in rows if row["verdict"] == "holds")
    page = (tmp_path / "front" / "front.html").read_text(encoding="utf-8")
    assert page.count("<figure><svg") == len(rows) and page.count('class="still"') == 2 * len(rows)
    with pytest.raises(DesignError, match="wanted.lash"):
        design(spec, ["wanted.lash=0.001"])
