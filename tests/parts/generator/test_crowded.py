"""Links that find no levels: what is named, against a closed form, and cures that are told do mend."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w
from test_slots import DISC, mends, with_change

from camgen import load
from camgen.errors import DesignError
from camgen.machines.linkage.mechanism import Linkage
from camgen.parts.generator import trials
from camgen.pipeline.build import build
from camgen.spec import validate

CROSSED = {  # the rocker's middle comes within 6.1 mm of the pin at G, and is to lie on level 1
    "points": {
        "O": [0, 0],
        "C": [70, 0],
        "A": [20, 0],
        "B": [55, 48],
        "G": [72.4, 25.6],
        "Q": [100, 60],
    },
    "links": {
        "ground": ["O", "C", "G"],
        "crank": ["O", "A"],
        "coupler": ["A", "B"],
        "rocker": ["C", "B"],
        "rod": ["B", "Q"],
        "arm": ["G", "Q"],
    },
    "lengths": {"O-C": 70, "O-A": 20, "A-B": 60, "C-B": 50},
    "output": [{"name": "out", "link": "arm"}],
    "layers": {"rocker": 1},
    "limits": {"transmission_angle_deg": 5},
    "parts": {"rocker": {"bow": 0.0}},
}
DRAGGED = {  # both cranks turn over each other's pivot
    "points": {"O": [0, 0], "C": [10, 0], "A": [30, 0], "B": [10, 40]},
    "links": {
        "ground": ["O", "C"],
        "crank": ["O", "A"],
        "coupler": ["A", "B"],
        "rocker": ["C", "B"],
    },
    "lengths": {"A-B": 35},
    "output": [{"name": "out", "link": "rocker"}],
    "limits": {"transmission_angle_deg": 5},
}
CAM = {
    "points": {"O": [0, 0], "C": [60, 0], "T": [30, 25], "G": [0, -45], "Q": [40, -40]},
    "links": {
        "ground": ["O", "C", "G"],
        "crank": ["O"],
        "rocker": ["C", "T"],
        "rod": ["T", "Q"],
        "arm": ["G", "Q"],
    },
    "cam": [
        {
            "cam": "crank",
            "follower": "rocker",
            "at": "T",
            "radius": 6,
            "segment": [
                {"kind": "rise", "span_deg": 180, "lift_deg": 15, "law": "cycloidal"},
                {"kind": "return", "span_deg": 180, "to_deg": 0, "law": "cycloidal"},
            ],
        }
    ],
    "output": [{"name": "out", "link": "arm"}],
    "layers": {"arm": 3, "crank_on_rocker": 2},
}


DRAG = {
    **DRAGGED,
    "points": {"O": [0, 0], "C": [15, 0], "A": [40, 0], "B": [30, 48]},
    "lengths": {"O-A": 40, "A-B": 45, "C-B": 50},
}
WHITWORTH = {
    "points": {"O": [0, 0], "C": [15, 0], "A": [40, 0], "D": [-45, 0], "E": [65, 0]},
    "links": {"ground": ["O", "C"], "crank": ["O", "A"], "arm": ["C", "D", "E"]},
    "slot": [{"pin": "A", "link": "arm", "along": ["C", "E"]}],
    "output": [{"name": "out", "link": "arm"}],
}
GROOVE = {  # a groove cam, as wide as its follower's pin is far off, and a four-bar on the same crank
    "points": {
        "O": [0, 0],
        "A": [15, 0],
        "B": [60, 40],
        "D": [70, 0],
        "C": [-60, 0],
        "T": [-30, 25],
    },
    "links": {
        "ground": ["O", "C", "D"],
        "crank": ["O", "A"],
        "rod": ["A", "B"],
        "rocker": ["D", "B"],
        "follower": ["C", "T"],
    },
    "cam": [{**CAM["cam"][0], "follower": "follower", "closure": "groove"}],
    "output": [{"name": "out", "link": "rocker"}],
}
SCARCE = {  # on one plate the crank passes the pin of D, on two the head of its pin does: both a second plate and smaller heads
    "points": {"O": [0, 0], "A": [19.1, 0], "D": [-17.1, 20.3], "F": [55.4, -20.3]},
    "links": {"ground": ["O", "D"], "crank": ["O", "A"], "arm": ["D", "F"]},
    "slot": [{"pin": "A", "link": "arm", "along": ["D", "F"]}],
    "output": [{"name": "out", "link": "arm"}],
    "limits": {"transmission_angle_deg": 1},
}
BOUGHT = {  # no such long shoulder screws are sold
    **DRAGGED,
    "points": {"O": [0, 0], "C": [70, 0], "A": [20, 0], "B": [55, 48]},
    "lengths": {"A-B": 60, "C-B": 50},
    "parts": {"pin": "shoulder", "base_thickness": 40, "thickness": 2, "head": 1},
}


def spec(tables: dict[str, Any], **more: Any) -> dict[str, Any]:
    return {"mechanism": "linkage", "name": "own", "drive": {"link": "crank"}, **tables, **more}


def refusal(tables: dict[str, Any]) -> DesignError:
    with pytest.raises(DesignError, match="cannot pass on any level") as caught:
        _ = validate(Linkage, spec(tables)).assembly
    return caught.value


def test_pin_link_distance_and_angle_are_those_of_the_closed_form() -> None:
    """Of the four-bar: B by two circles, and the distance of G from the line C-B."""
    error, theta = refusal(CROSSED), np.radians(np.arange(0, 360, 0.1))
    a, c, g = 20 * np.exp(1j * theta), 70 + 0j, 72.4 + 25.6j
    far = np.abs(c - a)
    along = (60**2 - 50**2 + far**2) / (2 * far)
    b = a + (c - a) / far * (along + 1j * np.sqrt(60**2 - along**2))
    off = np.abs(((g - c) * (b - c).conj()).imag) / 50
    assert error.where.startswith("link rocker and pin G, ")
    assert (
        off.min() - 0.1 < error.value <= off.min()
    )  # on the safe side by half a step of the samples
    angle = float(re.findall(r"([\d.]+) deg", error.where)[0])
    assert abs(angle - math.degrees(theta[np.argmin(off)])) < 1
    assert error.limit == pytest.approx((5.2 / 2 + 2) + (5 / 2 + 1.5) + 0.2)  # hub, pin's head, air


@pytest.mark.long
def test_a_link_that_may_is_bent_where_straight_ones_find_no_levels() -> None:
    """By as little of what is tried as lets its middle pass: the resolved spec says how far, and makes the same parts."""
    machine = validate(
        Linkage, spec({key: table for key, table in CROSSED.items() if key != "parts"})
    )
    found = machine.resolved()
    bow, short = found.making.shape("rocker").bow, refusal(CROSSED)
    assert found.layers["rocker"] == 1 and set(found.making.shapes) == {"rocker"}
    assert bow is not None and abs(bow) >= short.limit - short.value
    again = validate(Linkage, found.model_dump(by_alias=True, exclude_none=True))
    assert (
        again.assembly.parts == machine.assembly.parts
        and again.study().notes == machine.study().notes
    )
    assert any(
        note.startswith(f"Link rocker is bent by {abs(bow):g} mm, to the left")
        for note in machine.study().notes
    )


@pytest.mark.long
@pytest.mark.parametrize(
    ("tables", "told"),
    [
        (DRAG, "parts.plates = 2"),
        (WHITWORTH, "parts.plates = 2"),
        (GROOVE, "parts.plates = 2"),
        (
            {**DRAG, "points": {**DRAG["points"], "C": [6, 0]}},
            "parts.plates = 2",
        ),  # both pivots under one head
        ({**DRAG, "parts": {"plates": 2, "shaft": "interrupted"}}, 'parts.shaft = "through"'),
        (SCARCE, "parts.plates = 2 and parts.head = 1"),
        (BOUGHT, 'parts.pin = "printed"'),
        (
            {**WHITWORTH, "layers": {"arm": 1, "crank": 2}},
            "leaving [layers] out and parts.plates = 2",
        ),
    ],
)
def test_no_cure_leads_in_circles(tables: dict[str, Any], told: str) -> None:
    """Each that is named makes all parts; the first is as expected of the machine."""
    with pytest.raises(DesignError) as caught:
        _ = validate(Linkage, spec(tables)).assembly
    cures = mends(caught.value)
    assert told in cures, caught.value.remedy
    for words in cures:
        assert load(with_change(spec(tables), words)).assembly.parts, words


def test_what_was_not_tried_is_called_a_guess() -> None:
    """Two cranks on two plates whose pins do not clear each other: nothing mends them but other points."""
    tables = {**SCARCE, "points": {**SCARCE["points"], "D": [-13, 14]}}
    error = refusal(tables)
    assert error.remedy.startswith("a guess: make ") and "mended by" not in error.remedy
    assert (
        error.remedy.endswith("two plates")
        and "tried without success: all orders of the levels" in error.remedy
    )


def test_what_was_tried_in_vain_is_no_guess(monkeypatch: pytest.MonkeyPatch) -> None:
    """A shaft and a pin that lack less than half of their room, where nothing that is tried mends it."""
    tables = {**DISC, "points": {**DISC["points"], "K": [-92, 0]}}
    assert "mended by" in refusal(tables).remedy
    monkeypatch.setattr(trials, "has_levels", lambda layout, run: False)
    guess, _, vain = refusal(tables).remedy.partition("tried without success: ")
    assert "smaller parts" in vain
    assert guess.startswith("a guess: make ") and "another place for points.G" in guess
    assert "smaller" not in guess


@pytest.mark.long
def test_a_drag_link_stands_between_posts_beyond_all_that_turns(tmp_path: Path) -> None:
    """On the shafts of both cranks none of the four bars passes; from the files: all findings hold, no body meets another."""
    tables = spec(DRAG, parts={"plates": 2})
    (tmp_path / "own.toml").write_text(tomli_w.dumps(tables), encoding="utf-8")
    report = build(tmp_path / "own.toml", tmp_path, frozenset({"3mf"}))
    assert report.ok and "INTERFERENCE" in {finding.code for finding in report.findings}
    second = validate(Linkage, tables).bodies.layout.second
    assert second is not None and second.cuts == {
        "O": 1,
        "C": 0,
    }  # the crank on the lower plate, the rocker under the upper one
    reach = max(40.0, 50.0 + 15.0)  # of either crank about its pivot, from O
    for post in second.columns:
        inside = min(40 + 4.6 - abs(post), 50 + 4.6 - abs(post - 15)) + 2.5 / 2 + 2 + 1.5
        assert inside < 0 and abs(post) < 2 * reach, (
            "beyond both circles, and no further out than need be"
        )


@pytest.mark.long
def test_cures_that_are_told_mend(tmp_path: Path) -> None:
    told = refusal(CROSSED).remedy.partition(";")[0].removeprefix("mended by ").split(", or by ")
    assert told[0] == "leaving [layers] out" and told[1].startswith("parts.rocker.bow = ")
    for k, cure in enumerate(told):
        (tmp_path / f"{k}").mkdir()
        tables = spec({key: value for key, value in CROSSED.items() if key != "layers" or k > 0})
        (tmp_path / f"{k}" / "own.toml").write_text(tomli_w.dumps(tables), encoding="utf-8")
        sets = cure.replace(" = ", "=").split(" and ") if k > 0 else []
        report = build(tmp_path / f"{k}" / "own.toml", tmp_path / f"{k}", frozenset({"3mf"}), sets)
        assert not [finding for finding in report.findings if not finding.ok], cure
        assert "INTERFERENCE" in {finding.code for finding in report.findings}


@pytest.mark.long
def test_what_passes_right_over_a_shaft_is_told_to_be_elsewhere() -> None:
    error = refusal(DRAGGED)
    assert error.where.startswith("link rocker and shaft O") and error.value < 0.1
    assert "another place for points.O" in error.remedy and "lengths of link rocker" in error.remedy
    assert (
        error.remedy.startswith("mended by parts.plates = 2; else a guess: make ")
        and "smaller parts." not in error.remedy
    )


def test_a_cams_disc_in_the_way_is_named_with_what_makes_it_smaller() -> None:
    """Its greatest radius is the roller's centre, 15 deg out, less the roller."""
    error, hinge, tip = refusal(CAM), 60 + 0j, 30 + 25j
    out = hinge + (tip - hinge) * complex(math.cos(math.radians(15)), -math.sin(math.radians(15)))
    assert error.where.startswith("cam crank on rocker and pin G")
    assert error.value == pytest.approx(45) and error.limit == pytest.approx(
        abs(out) - 6 + 4 + 0.2, abs=1e-3
    )
    assert (
        error.remedy.startswith("mended by leaving [layers] out")
        and "; else a guess: make 2.4" in error.remedy
    )
    keys = (
        "points.T nearer to its shaft",
        "smaller parts.pin_diameter or parts.head",
        "another place for points.O",
        "another place for points.G",
    )
    assert all(said in error.remedy for said in keys)
    assert "parts.wall" not in error.remedy and "hub_diameter" not in error.remedy
