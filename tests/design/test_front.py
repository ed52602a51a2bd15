"""The front of a search: which designs are weighed, what is tried before one is refused, how they stand."""

from __future__ import annotations

import csv
import math
import tomllib
from collections.abc import Container, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from camgen.design import paths
from camgen.design.chains import chains
from camgen.design.found import Found
from camgen.design.front import Front
from camgen.design.linkages import Tracing, machines
from camgen.design.offers import Aim, rank
from camgen.design.paths import ChainDesign, Task, solve_task
from camgen.design.polish import Goal
from camgen.design.prototype import Prototype, prototype, tally
from camgen.design.run import design
from camgen.design.target import Target
from camgen.design.weighing import Designs
from camgen.errors import DesignError
from camgen.findings import Finding, Where
from camgen.machines.linkage.mechanism import Linkage
from camgen.spec import validate
from camgen.workers import Workers

FOUR_BAR = chains(2, 1)[0]
DRAWN = np.array([[0, 20, 70, 45 + 40j, 20 + 60j]], complex)  # O, A, C, B, P
PATH = FOUR_BAR.trace(DRAWN, 240)[0][:, 0]
SIZES = {"thickness": 3, "pin_diameter": 3, "wall": 1.6}
TABLES: dict[str, Any] = {"mechanism": "linkage", "name": "found", "parts": SIZES}
# a drag link: its crank passes the pivot of the rocker, and the rocker the shaft
DRAG_LINK: dict[str, Any] = {
    "mechanism": "linkage",
    "name": "drag",
    "points": {"O": [0, 0], "A": [50, 0], "C": [20, 0], "B": [40, 45]},
    "links": {"ground": ["O", "C"], "crank": ["O", "A"], "bar": ["A", "B"], "rocker": ["C", "B"]},
    "drive": {"link": "crank"},
    "output": [{"name": "way", "link": "rocker"}],
    "parts": SIZES,
}


def tracing(allowance: float = 1.0) -> Tracing:
    return Tracing(np.append(PATH, PATH[:1]), TABLES, allowance)


def machine() -> Found:
    return tracing().found(ChainDesign(FOUR_BAR, tuple(DRAWN[0].tolist()), 0.0, 1.0))


@pytest.fixture(scope="module")
def found() -> list[ChainDesign]:
    target = Target(PATH)
    goal = Goal(target, 0.2 * target.chord, 10 * target.chord, 6.2, 0.4)
    return solve_task(goal, Task(FOUR_BAR, (1,)))


@pytest.mark.long
def test_a_second_plate_is_tried_before_a_design_is_refused() -> None:
    machine, change = validate(Linkage, DRAG_LINK).on_a_frame()
    assert change.sizes["plates"] == machine.making.plates == 2
    made = prototype(DRAG_LINK, "")
    assert made.verdict == "holds" and made.sizes == change.sizes and made.lash > 0
    assert made.row["parts"].startswith("parts.plates = 2")


def test_a_machine_that_stands_as_it_is_stays_so() -> None:
    data = machine().data()
    _, change = validate(Linkage, data).on_a_frame()
    assert not change.sizes
    assert prototype(data, "").row["parts"] == ""


@pytest.mark.long
def test_plates_that_the_spec_says_are_kept_and_the_refusal_says_what_was_tried() -> None:
    typed = {**DRAG_LINK, "parts": {**SIZES, "plates": 1}}
    with pytest.raises(DesignError, match="cannot pass") as refused:
        validate(Linkage, typed).on_a_frame()
    assert "plates" not in str(refused.value) and "bows" in refused.value.remedy
    made = prototype(typed, "")
    assert (
        made.verdict == "refused"
        and "tried without success: all orders of the levels" in made.obstacle
    )
    assert math.isnan(made.lash)
    points = {**DRAG_LINK["points"], "A": [5, 0], "B": [25, 20]}  # its shaft meets the crank's pin
    short = prototype({**DRAG_LINK, "points": points, "parts": {**SIZES, "shaft": "through"}}, "")
    assert short.verdict == "refused" and short.obstacle.endswith("bows, parts.plates = 2")


@pytest.mark.long
def test_the_front_is_the_same_on_several_cores(found: list[ChainDesign]) -> None:
    designs = machines(found, tracing())
    alone = designs.weighed(map, lambda text: None)
    with Workers(2) as workers:
        together = designs.weighed(workers.map, lambda text: None)
    assert [each.row(1) for each in alone] == [each.row(1) for each in together]
    assert alone and all(not each.miss for each in alone)


@pytest.mark.long
def test_parts_of_what_misses_the_path_are_made_only_where_nothing_else_can_be_built(
    found: list[ChainDesign],
) -> None:
    def weighed(allowance: float) -> tuple[list[Found], list[Found]]:
        drawn: list[Found] = []
        designs = machines(found, tracing(allowance))

        def of(number: int) -> Found:
            drawn.append(designs.of(number))
            return drawn[-1]

        return replace(designs, of=of).weighed(map, lambda text: None), drawn

    worst = sorted(tracing().found(each).share for each in paths.apart(found))  # of 1 mm
    front, drawn = weighed(1.01 * worst[1])
    missed = [each for each in drawn if each.miss]
    assert missed and not any("prototype" in vars(each) for each in missed)
    assert front and all(each.prototype.of_use for each in front)
    front, drawn = weighed(0.5 * worst[0])
    assert front and {each.prototype.verdict for each in front} <= {"fails", "refused"}
    assert min(each.share for each in front) == min(each.share for each in drawn)


def numbers(losses: Sequence[tuple[float, float]], refused: Container[int] = ()) -> list[int]:
    """Of the designs that are weighed, in their order; refused: those that cannot be built."""
    each = [weighed(0.5, 1.0, "no levels" if k in refused else "") for k in range(len(losses))]
    looked = Designs(np.array(losses, float), each.__getitem__).weighed(map, lambda text: None)
    return [next(k for k, one in enumerate(each) if one is design) for design in looked]


@pytest.mark.long
def test_a_design_that_cannot_be_built_hides_none_behind_it() -> None:
    """The first one beats all; the second and third one beat each other in one thing each; the fourth is beaten by both."""
    losses = [(1, 1), (2, 3), (3, 2), (4, 4)]
    assert numbers(losses) == [0]
    assert numbers(losses, {0}) == [0, 1, 2]
    assert numbers(losses, {0, 1, 2}) == [0, 1, 2, 3]


@pytest.mark.long
def test_both_ends_of_a_front_are_weighed_and_neighbours_once() -> None:
    """Of 1,001 on one line six, then six more, which are enough. The twin of what was weighed, within a hundredth, never is."""
    line = [(k, 1000 - k) for k in range(1001)]
    assert numbers(line)[:6] == [0, 200, 400, 600, 800, 1000]
    assert len(numbers(line)) == 12
    others = [(0, 100), (20, 80), (40, 60), (60, 40), (80, 20), (99.5, 0.5), (100, 0)]
    assert numbers(others) == [0, 1, 2, 3, 4, 6]


@pytest.mark.long
def test_with_enough_of_use_only_nearer_ones_are_weighed() -> None:
    """Of 21 on a line the first four cannot be built: what is left between them is tried, and nothing else."""
    line = [(5 * k, 100 - 5 * k) for k in range(21)]
    looked = numbers(line, {0, 1, 2, 3})
    assert len(looked) == 13 and looked[-1] == 2 and {0, 1, 2, 3} < set(looked)


drawn_machine = cache(machine)  # for those that replace what is judged of it


def weighed(
    worst: float, lash: float, obstacle: str = "", failures: Sequence[Finding] = ()
) -> Found:
    drawn = drawn_machine()
    each = replace(drawn, judged=[replace(drawn.judged[0], error=worst)])
    miss = "far" if worst > 1 else ""
    vars(each).update(prototype=Prototype(miss, obstacle, failures, lash, {}))
    return each


def test_the_nearest_of_those_with_useful_play_stands_first() -> None:
    order = [
        weighed(0.4, 2.0),
        weighed(0.6, 0.5),  # less play, but less near
        weighed(0.2, 6.0),  # nearest of all, its play is of no use
        weighed(0.1, 7.0),
        weighed(3.0, 1.0),  # can be built, but misses the path
        weighed(0.05, math.nan, "no levels"),
    ]
    aim = Aim(None, 5.0, "mm", True, "", "")
    assert sorted(reversed(order), key=lambda each: rank(aim, each)) == order


def test_what_is_not_of_use_is_counted_by_its_reason() -> None:
    lash = Finding("LASH", False, 6.0, 5.0, "mm", Where(), "")
    force = Finding("CONTACT_FORCE", False, -1.0, 0.0, "N", Where(), "")
    designs = [
        weighed(0.4, 2.0),
        weighed(0.4, math.nan, "no levels"),
        weighed(3.0, math.nan, "no levels"),
        weighed(3.0, 1.0),
        weighed(0.4, 6.0, failures=[lash, lash, force]),
        weighed(0.4, 6.0, failures=[lash]),
    ]
    assert tally([each.prototype for each in designs], far=4) == (
        "10 designs judged, 1 of use; 5 too far from what is wanted, 2 with parts that cannot be made, 2 beyond LASH, "
        "1 beyond CONTACT_FORCE"
    )
    assert tally([designs[0].prototype]) == "1 design judged, 1 of use"


@pytest.mark.long
def test_the_page_draws_the_wanted_path_and_what_can_be_built_first(tmp_path: Path) -> None:
    cloud = [[round(z.real, 3), round(z.imag, 3)] for z in PATH[::3].tolist()]
    fronts: list[Front] = []
    said: list[str] = []
    text = design(
        {**TABLES, "wanted": {"path": cloud, "joined": False, "bars": 4, "effort": 0}},
        say=said.append,
        keep=fronts.append,
    )
    (front,) = fronts
    front.write(tmp_path / "front")
    with open(tmp_path / "front" / "front.csv", encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    holding = [row["verdict"] == "holds" for row in rows]
    assert holding[0] and holding == sorted(holding, reverse=True)
    useful = [
        float(row["worst_distance_mm"]) for row, holds in zip(rows, holding, strict=True) if holds
    ]
    assert useful == sorted(useful)
    page = (tmp_path / "front" / "front.html").read_text(encoding="utf-8")
    assert page.count('<path class="wanted"') == len(rows)
    assert page.index("<h2>Can be built</h2>") < page.index("design 1: at most")
    assert "play " in page and "<h2>Cannot be built</h2>" not in page
    # what is written is the first, and the words say its error and its play
    first = tomllib.loads((tmp_path / "front" / "01.toml").read_text(encoding="utf-8"))
    assert tomllib.loads(text)["points"] == first["points"]
    assert any(
        " to choose from; design 1: at most" in line and " play of " in line for line in said
    )
    least = min(rows, key=lambda row: float(row["bars_mm"]) if row["verdict"] == "holds" else 1e9)
    assert any(
        line.startswith(f"has the shortest bars: design {least['design']}:") for line in said
    )
