"""Steps as a person at the bench takes them, against the order one part after the other: nothing is lost, nothing comes earlier."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import pytest

from camgen import load, starters
from camgen.machines.mechanism import Mechanism
from camgen.parts.assembly import order_of_assembly
from camgen.parts.bench_steps import at_bench
from camgen.pipeline.shopping import steps_of_assembly
from camgen.study import Doing, Mate, Step, Table, sentences


@cache
def made(name: str) -> Mechanism:
    return load(next(starters.folder().rglob(f"{name}.toml")))


def table(steps: Sequence[Step]) -> Table:
    """An order of steps, one row each."""
    return Table(
        "order", ("step", "part"), [(k, f"row {k}") for k in range(1, 1 + len(steps))], steps
    )


def step(verb: str, *copies: str, what: str = "", **more: object) -> Step:
    return replace(Step([Doing(f"{verb} ", what or copies[0])], copies), **more)


def test_sentences_that_differ_in_what_is_handled_are_one() -> None:
    said = [
        Doing("glue ", "cap-1 on pin-1", ", flush with its end"),
        Doing("glue ", "cap-2 on pin-2", ", flush with its end"),
        Doing("glue ", "cap-2 on pin-2", ", flush with its end"),
        Doing("glue ", "cap-3 on pin-3"),
        Doing("then stop"),
    ]
    whole = "Glue cap-1 on pin-1 and cap-2 on pin-2, each flush with its end."
    assert sentences(said) == f"{whole} Glue cap-3 on pin-3. Then stop."


def test_a_step_of_many_things_is_a_list_to_tick_off_on_the_page() -> None:
    """Four sentences are read at once, five are not; a step that is a list is that alone."""
    doings = [Doing(f"do thing {k}") for k in range(1, 6)]
    few = Step(doings[:4])
    assert few.text == few.title == "Do thing 1. Do thing 2. Do thing 3. Do thing 4."
    many = Step(doings)
    assert many.text.splitlines() == [f"☐ Do thing {k}." for k in range(1, 6)]
    assert many.title == f"{few.title} Do thing 5."
    lists = [each for each in steps_of_assembly(made("walker")).steps if "☐" in each.title]
    assert all(each.text == each.title for each in lists)


def test_a_sub_assembly_is_built_and_put_in_in_one_step() -> None:
    inner = Mate("glue", "B", (0.0, 0.0, 0.0), 2.0, 2.0)
    outer = Mate("free", "A", (9.0, 0.0, 0.0), 2.0, 2.0)
    bench = Step([Doing("lay ", "link", " on the bench")], ["link-1"], group="link")
    pin = step("glue", "pin-1", group="link", mates=[inner])
    put = Step([Doing("set ", "link on axle")], group="link", mates=[outer])
    found = at_bench(table([step("lay", "axle-1"), bench, pin, put, step("glue", "cap-1")]))
    assert [row[0] for row in found.rows] == [1, 2, 2, 2, 3]
    built = found.steps[1]
    assert built.title == "Glue pin-1. Then set link on axle." and not built.group
    assert built.copies == ["link-1", "pin-1"]
    assert built.mates == [replace(inner, within=True), outer]


def test_spacers_and_caps_are_put_on_a_few_at_a_time_and_nothing_else() -> None:
    caps = [step("glue", f"cap-{k}", small=True) for k in range(1, 8)]
    found = at_bench(table([*caps[:3], step("set", "link-1"), *caps[3:]]))
    assert [row[0] for row in found.rows] == [1, 1, 1, 2, 3, 3, 3, 3]
    assert len(at_bench(table(caps)).steps) == 2, "five, then the rest"
    other = [caps[0], replace(caps[1], way=1), replace(caps[2], way=1, apart="far")]
    assert len(at_bench(table(other)).steps) == 3


def test_steps_of_a_far_side_say_so_and_are_said_in_full() -> None:
    near = [step("lay", "base-1", what="base"), step("set", "link-1", what="link")]
    far = [replace(each, apart="far side", copies=["far-" + each.copies[0]]) for each in near]
    found = at_bench(table([*near, *far])).steps
    assert [each.title for each in found] == [
        "Lay base.",
        "Set link.",
        "Far side: lay base.",
        "Far side: set link.",
    ]


def test_a_loose_part_has_the_number_of_the_step_that_holds_it() -> None:
    loose = Step([Doing("stand pin", "", "; loose until cap holds it in {cap-1}")], ["pin-1"])
    found = at_bench(table([loose, step("set", "link-1"), step("glue", "cap-1")])).steps
    assert found[0].title == "Stand pin; loose until cap holds it in step 3."


def test_a_machine_of_many_steps_has_its_pins_pressed_first_and_a_few_links_to_a_step() -> None:
    """Eight links with a pin each, four of them alike, each with a cap; a screw between: 21 steps, not 32."""
    rest = [step("glue", f"base-{k}", way=1) for k in range(1, 17)]
    links = []
    for k in range(1, 9):
        kind = "arm" if k < 5 else f"link{k}"
        link = f"{kind}-{k}"
        bench = Step([Doing("lay ", kind, " on the bench")], [link], group=kind)
        mate = Mate("glue", "A", (10.0 * k, 0.0, 0.0), 2.0, 2.0)
        pin = step("press and glue", f"pin-{k}", what=f"pin into A of {kind}", group=kind)
        pin = replace(pin, mates=[mate])
        put = Step([Doing("set ", f"{kind} on axle {k}")], group=kind)
        links += [bench, pin, put, step("glue", f"cap-{k}", small=True)]
    found = at_bench(table([*rest, *links])).steps
    first = next(each for each in found if each.laid)
    pressed = "Put these together on the bench, with a vice. They go into the machine later."
    lines = ["pin into A of arm (make 4)", *(f"pin into A of link{k}" for k in range(5, 9))]
    ticks = "".join(f"\n☐ {line}" for line in lines)
    hard = "Let all this get hard before you use it."
    assert first.title == f"{pressed}\nPress and glue:{ticks}\n{hard}"
    far = [replace(each, apart="far side") for each in links[:4]]
    sides = next(each for each in at_bench(table([*rest, *links, *far])).steps if each.laid)
    assert "\n☐ pin into A of arm (make 5, 1 of them mirrored: F)\n" in sides.title
    said = replace(links[0], doings=[*links[0].doings, Doing("it has two pins")])
    noted = next(each for each in at_bench(table([*rest, said, *links[1:]])).steps if each.laid)
    assert "\n☐ pin into A of arm. It has two pins\n" in noted.title, "what is handled comes first"
    assert [name for name, *_ in first.laid] == ["arm", "link5", "link6", "link7", "link8"]
    assert [len(mates) for *_, mates in first.laid] == [1] * 5 and not first.copies
    levels = [each for each in found if each.title.startswith("Put these on in this order")]
    assert [each.title.count("☐") for each in levels] == [4] * 4, "two links and their caps each"
    assert not any(mate.within for each in levels for mate in each.mates)
    assert sum(len(each.copies) for each in found) == 16 + 3 * 8
    few = at_bench(table(links)).steps
    assert len(few) == 16 and not any(each.laid for each in few), "of so few each is a step"


def test_links_that_only_go_on_are_one_step_where_there_are_more_than_a_few() -> None:
    """Of 18 steps those that set a link one after the other are one; what is glued stands alone, and nothing is pressed before."""
    links = [step("set", f"link-{k}") for k in range(1, 4)]
    glued = [step("glue", f"part-{k}", what=f"part {k}") for k in range(1, 15)]
    bench = [
        Step([Doing("lay ", "arm", " on the bench")], ["arm-1"], group="arm"),
        step("press and glue", "pin-1", what="pin into A of arm", group="arm"),
        Step([Doing("set ", "arm on axle")], group="arm"),
    ]
    found = [each.title for each in at_bench(table([*links, *glued, *bench])).steps]
    ticks = "".join(f"\n☐ Set link-{k}." for k in range(1, 4))
    assert found[0].startswith(f"Put these on in this order:{ticks}") and len(found) == 16
    assert found[-1] == "Press and glue pin into A of arm. Then set arm on axle."
    assert len(at_bench(table([*links, *glued[:13]])).steps) == 16, "of few each is one"


@pytest.mark.parametrize(
    ("name", "most"),
    [("walking-leg", 13), ("stitch-head", 35), ("drum-feeder", 16), ("uniform-swing", 16)],
)
def test_every_copy_comes_as_it_does_one_by_one(name: str, most: int) -> None:
    check(made(name), most)


@pytest.mark.long
def test_a_walker_of_two_sides_has_steps_that_a_person_can_count() -> None:
    """169 when each part is a step of its own."""
    check(made("walker"), 37)
    levels = [
        each
        for each in steps_of_assembly(made("walker")).steps
        if "ut these on in this order" in each.title
    ]
    assert max(len(each.copies) for each in levels) <= 12, "in one picture"
    ticks = [line for each in levels for line in each.title.split("\n")]
    assert not any(re.search(r"\. (Put|Glue|Move|Set|Lay) ", line) for line in ticks), "one each"
    sides = [Counter[str](), Counter[str]()]  # how often each side sets each kind of link
    for each in steps_of_assembly(made("walker")).steps:
        sides[each.title.startswith("Far side")].update(
            re.findall(r"[Ss]et (\w+\d) with", each.title)
        )
    assert sides[0] == sides[1] and sides[0].total() == 15, (
        "each in full, but for two legs that are laid"
    )


def check(machine: Mechanism, most: int) -> None:
    """The same copies in the same order, in no more steps; each row has the number of the step in which its copies come."""
    one_by_one = order_of_assembly(machine.assembly)
    whole = at_bench(one_by_one)
    wanted = [copy for each in one_by_one.steps for copy in each.copies]
    assert [copy for each in whole.steps for copy in each.copies] == wanted
    numbers = [int(str(row[0])) for row in whole.rows]
    assert sorted({*numbers}) == [*range(1, len(whole.steps) + 1)] and numbers == sorted(numbers)
    numbers = [k for k in numbers if not whole.steps[k - 1].laid]  # what is pressed comes later
    assert len(whole.steps) <= most and len(numbers) == len(one_by_one.rows)
    for number, alone in zip(numbers, one_by_one.steps, strict=True):
        assert {*alone.copies} <= {*whole.steps[number - 1].copies}
